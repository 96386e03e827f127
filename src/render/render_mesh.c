/* render_mesh.c - a shaded picture of a triangle mesh: bvx_render_mesh.
 *
 * Vertices are placed in the frame and snapped once, so triangles that share an edge share it in the picture too.
 * Triangles are sorted into bands of rows, bands are drawn apart with a depth buffer, and what each sample sees (the
 * number of its triangle) is shaded afterwards, once. */
#include "mesh/facet.h"
#include "mesh/view.h"
#include "render/picture.h"
#include "render/triangle_bins.h"

enum { SCENE_GRAIN = 8192 /* vertices or triangles a piece, at least */ };

#define SCENE_SHARP 0.9 /* cosine between a facet and the mean at its corner below which the edge is meant to be one */

/* A vertex in the frame. */
typedef struct scene_vertex {
    int32_t x, y; /* right and down [Units: samples * 2^fraction_bits] */
    float z;      /* towards the eye [Units: samples] */
} scene_vertex;

typedef struct mesh_scene {
    const bvx_mesh_view *view;
    bvxi_picture picture;
    int32_t pieces;              /* of the work being done */
    bvxi_camera_extent *extent;  /* of each piece */
    scene_vertex *vertex;        /* [Size: view.vertex_count] */
    float *normal;               /* three for each vertex, length 1 or 0; NULL: flat */
    bvxi_triangle_bins bins;
} mesh_scene;

/* ---- where the mesh lies in the view ---- */

static void extent_of_piece(void *user, int32_t index, int32_t worker)
{
    const mesh_scene *const s = user;
    bvxi_camera_extent e = bvxi_camera_nothing;
    uint64_t begin, end;
    uint32_t c[3];
    double p[3], q[3];
    (void)worker;
    bvxi_piece(s->view->triangle_count, s->pieces, index, &begin, &end);
    for (uint64_t t = begin; t < end; t++) {
        bvxi_view_triangle(s->view, t, c);
        for (int k = 0; k < 3; k++) {
            bvxi_view_position(s->view, c[k], p);
            bvxi_camera_turn(&s->picture.camera, p, q);
            bvxi_camera_extent_add(&e, q);
        }
    }
    s->extent[index] = e;
}

static bvx_status fit_scene(bvx_context *ctx, mesh_scene *s)
{
    bvxi_camera_extent all = bvxi_camera_nothing;
    uint64_t size;
    bvx_status status;
    s->pieces = bvxi_piece_count(s->view->triangle_count, SCENE_GRAIN);
    size = (uint64_t)s->pieces * sizeof *s->extent;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, size, "the picture's extents", &s->extent));
    status = bvxi_parallel(ctx, "render", 0.0, 0.05, s->pieces, extent_of_piece, s);
    for (int32_t i = 0; i < s->pieces && status == BVX_OK; i++) bvxi_camera_extent_join(&all, &s->extent[i]);
    bvxi_free(ctx, s->extent, size);
    BVXI_TRY(status);
    bvxi_camera_fit(&s->picture.camera, &all, s->picture.raster.width, s->picture.raster.height);
    return BVX_OK;
}

/* ---- vertices ---- */

/* Vertices that no triangle uses may lie anywhere; the range keeps them harmless. */
static int32_t snap_in_frame(double v, int32_t side, int32_t bits)
{
    double const limit = (double)side;
    double const in = v > 0.0 ? v < limit ? v : limit : 0.0;
    return (int32_t)(in * (double)((int64_t)1 << bits) + 0.5);
}

static void place_piece(void *user, int32_t index, int32_t worker)
{
    const mesh_scene *const s = user;
    const bvxi_raster *const r = &s->picture.raster;
    uint64_t begin, end;
    double p[3], q[3], at[3];
    (void)worker;
    bvxi_piece(s->view->vertex_count, s->pieces, index, &begin, &end);
    for (uint64_t v = begin; v < end; v++) {
        bvxi_view_position(s->view, v, p);
        bvxi_camera_turn(&s->picture.camera, p, q);
        bvxi_camera_place(&s->picture.camera, q, at);
        s->vertex[v].x = snap_in_frame(at[0], r->width, r->fraction_bits);
        s->vertex[v].y = snap_in_frame(at[1], r->height, r->fraction_bits);
        s->vertex[v].z = at[2] > -1e29 && at[2] < 1e29 ? (float)at[2] : 0.0f;
    }
}

static bvx_status place_vertices(bvx_context *ctx, mesh_scene *s)
{
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, s->view->vertex_count * sizeof *s->vertex, "the picture's vertices", &s->vertex));
    s->pieces = bvxi_piece_count(s->view->vertex_count, SCENE_GRAIN);
    return bvxi_parallel(ctx, "render", 0.05, 0.1, s->pieces, place_piece, s);
}

/* ---- triangles ---- */

/* Corners in the camera's axes: right, up and towards the eye [Units: samples]. */
static void scene_corners(const mesh_scene *s, uint32_t t, uint32_t c[3], double p[3][3])
{
    double const part = 1.0 / (double)((int64_t)1 << s->picture.raster.fraction_bits);
    bvxi_view_triangle(s->view, t, c);
    for (int k = 0; k < 3; k++) {
        const scene_vertex *const v = &s->vertex[c[k]];
        p[k][0] = (double)v->x * part;
        p[k][1] = (double)v->y * -part;
        p[k][2] = (double)v->z;
    }
}

static int bands_of_triangle(const void *user, uint32_t t, int32_t *first, int32_t *last)
{
    const mesh_scene *const s = user;
    int32_t const bits = s->picture.raster.fraction_bits, rows = BVXI_PICTURE_BAND * s->picture.options.samples;
    int32_t const bottom = s->picture.raster.height - 1;
    uint32_t c[3];
    int32_t low = INT32_MAX, high = 0;
    bvxi_view_triangle(s->view, t, c);
    for (int k = 0; k < 3; k++) {
        int32_t const y = s->vertex[c[k]].y;
        low = y < low ? y : low;
        high = y > high ? y : high;
    }
    if (low == high) return 0;
    high >>= bits;
    *first = (low >> bits) / rows;
    *last = (high < bottom ? high : bottom) / rows;
    return 1;
}

static void draw_scene_triangle(const mesh_scene *s, const bvxi_raster *raster, bvxi_raster_rows rows, uint32_t t)
{
    uint32_t c[3];
    double p[3][3], n[3];
    int32_t corner[3][2];
    bvxi_raster_plane plane;
    scene_corners(s, t, c, p);
    bvxi_facet_normal((const double(*)[3])p, n);
    if (n[2] == 0.0) return; /* seen along its edge: covers no sample */
    for (int k = 0; k < 3; k++) {
        corner[k][0] = s->vertex[c[k]].x;
        corner[k][1] = s->vertex[c[k]].y;
    }
    plane.x = p[0][0];
    plane.y = -p[0][1];
    plane.z = p[0][2];
    plane.dx = -n[0] / n[2];
    plane.dy = n[1] / n[2];
    plane.low = p[0][2];
    plane.high = p[0][2];
    for (int k = 1; k < 3; k++) {
        plane.low = p[k][2] < plane.low ? p[k][2] : plane.low;
        plane.high = p[k][2] > plane.high ? p[k][2] : plane.high;
    }
    bvxi_raster_polygon(raster, rows, (const int32_t(*)[2])corner, 3, &plane, t + 1);
}

static void draw_scene_rows(const void *user, const bvxi_raster *raster, bvxi_raster_rows rows)
{
    const mesh_scene *const s = user;
    int32_t const band = rows.begin / (BVXI_PICTURE_BAND * s->picture.options.samples);
    for (uint64_t i = s->bins.begin[band]; i < s->bins.begin[band + 1]; i++)
        draw_scene_triangle(s, raster, rows, s->bins.triangle[i]);
}

/* ---- normals ---- */

static double scene_unit(double n[3])
{
    double const length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    if (length > 0.0)
        for (int a = 0; a < 3; a++) n[a] /= length;
    return length;
}

/* The mean of the facets around, each counting by its area; in the order of triangles, so on one thread. */
static bvx_status average_normals(bvx_context *ctx, mesh_scene *s)
{
    double p[3][3], n[3];
    uint32_t c[3];
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, s->view->vertex_count * 12, "the picture's normals", &s->normal));
    for (uint64_t t = 0; t < s->view->triangle_count; t++) {
        scene_corners(s, (uint32_t)t, c, p);
        bvxi_facet_normal((const double(*)[3])p, n);
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) s->normal[(size_t)c[k] * 3 + (size_t)a] += (float)n[a];
    }
    return BVX_OK;
}

/* Blend the corners' normals by the areas across from them into n. flat is the facet's own, which stands in where a
 * corner's mean is far from it, so sharp edges stay sharp. */
static void blend_normals(const mesh_scene *s, const uint32_t c[3], const double p[3][3], double x, double y,
                          const double flat[3], double n[3])
{
    double blend[3] = {0.0, 0.0, 0.0}, whole = 0.0;
    for (int k = 0; k < 3; k++) {
        const double *const a = p[(k + 1) % 3], *const b = p[(k + 2) % 3];
        double const area = (a[0] - x) * (b[1] - y) - (b[0] - x) * (a[1] - y);
        double m[3];
        for (int i = 0; i < 3; i++) m[i] = (double)s->normal[(size_t)c[k] * 3 + (size_t)i];
        int const sharp = scene_unit(m) == 0.0 || bvxi_camera_dot(m, flat) < SCENE_SHARP;
        for (int i = 0; i < 3; i++) blend[i] += area * (sharp ? flat[i] : m[i]);
        whole += area; /* negative where the facet is seen from behind: so are all three */
    }
    if (whole < 0.0)
        for (int i = 0; i < 3; i++) blend[i] = -blend[i];
    if (scene_unit(blend) > 0.0) memcpy(n, blend, sizeof blend);
}

static void see_triangle(const void *user, const bvxi_raster *raster, uint32_t id, int32_t x, int32_t y, bvxi_seen *seen)
{
    const mesh_scene *const s = user;
    uint32_t c[3];
    double p[3][3], n[3];
    (void)raster;
    if (s->normal == NULL && seen->key == id) return;
    seen->key = id;
    scene_corners(s, id - 1, c, p);
    bvxi_facet_normal((const double(*)[3])p, n);
    scene_unit(n);
    memcpy(seen->normal, n, sizeof n);
    if (s->normal != NULL) blend_normals(s, c, (const double(*)[3])p, x + 0.5, -(y + 0.5), n, seen->normal);
    seen->inside = n[2] < 0.0;
    for (int a = 0; a < 3; a++) {
        seen->tangent[a] = seen->inside ? -n[a] : n[a];
        seen->normal[a] = seen->inside ? -seen->normal[a] : seen->normal[a];
    }
    if (seen->normal[2] < 0.0) { /* turned away from the eye though the facet is not */
        seen->normal[2] = 0.0;
        scene_unit(seen->normal);
    }
}

/* ---- the whole ---- */

static bvx_status make_scene(bvx_context *ctx, mesh_scene *s)
{
    int32_t const bands = (s->picture.options.height + BVXI_PICTURE_BAND - 1) / BVXI_PICTURE_BAND;
    BVXI_TRY(fit_scene(ctx, s));
    BVXI_TRY(place_vertices(ctx, s));
    BVXI_TRY(bvxi_triangle_bins_open(ctx, s->view->triangle_count, bands, bands_of_triangle, s, &s->bins));
    if (s->picture.options.smooth) BVXI_TRY(average_normals(ctx, s));
    s->picture.draw = draw_scene_rows;
    s->picture.see = see_triangle;
    s->picture.model = s;
    return bvxi_picture_make(ctx, &s->picture);
}

bvx_status bvx_render_mesh(bvx_context *context, const bvx_mesh_view *mesh, const bvx_render_options *options,
                           bvx_image *image)
{
    static const char *const function = "bvx_render_mesh";
    mesh_scene s;
    double low[3], high[3];
    bvx_status status;
    if (context == NULL) return BVX_ERR_ARGUMENT;
    memset(&s, 0, sizeof s);
    s.view = mesh;
    BVXI_TRY(bvxi_picture_open(context, function, options, image, &s.picture));
    BVXI_TRY(bvxi_view_check(context, function, mesh));
    BVXI_TRY(bvxi_view_bounds(context, function, mesh, low, high));
    if (low[0] == high[0] && low[1] == high[1] && low[2] == high[2])
        return bvxi_fail(context, BVX_ERR_EMPTY, "%s: all vertices lie at one point", function);
    bvxi_camera_look(&s.picture.camera, low, high, s.picture.options.direction, s.picture.options.up);
    status = make_scene(context, &s);
    bvxi_free(context, s.normal, mesh->vertex_count * 12);
    bvxi_triangle_bins_close(context, &s.bins);
    bvxi_free(context, s.vertex, mesh->vertex_count * sizeof *s.vertex);
    if (status == BVX_OK) *image = s.picture.image;
    return status;
}
