/* render_mesh.c - a shaded picture of a triangle mesh: bvx_render_mesh.
 *
 * Vertices are placed in the frame and snapped once, so triangles that share an edge share it in the picture
 * too. Triangles are sorted into bands of rows, bands are drawn apart with a depth buffer, and what each
 * sample sees (the number of its triangle) is shaded afterwards, once.
 * A cut clips triangles before they are snapped, anew wherever one is drawn: what is left of each fits on the
 * stack. Normals and colours of the corners are blended by areas in the frame, which is exact as rays are
 * parallel. */
#include "mesh/facet.h"
#include "mesh/view.h"
#include "render/picture.h"

#define SCENE_SHARP \
    0.9 /* cosine between a facet and the mean at its corner below which the edge is meant to be one */

enum { SCENE_GRAIN = 8192 /* vertices or triangles a piece, at least */ };

typedef struct scene_vertex {
    int32_t x, y; /* right and down [Units: samples * 2^fraction_bits] */
    float z;      /* towards the eye [Units: samples] */
} scene_vertex;

typedef struct mesh_scene {
    const bvx_mesh_view *view;
    bvxi_picture picture;
    bvxi_cut cut;               /* [Units: world * unit] */
    int32_t pieces;             /* of the work being done */
    bvxi_camera_extent *extent; /* of each piece */
    scene_vertex *vertex;       /* [Size: view.vertex_count]; NULL: the mesh is cut */
    float *normal;              /* three for each vertex, length 1 or 0; NULL: flat */
    bvxi_triangle_bins bins;
} mesh_scene;

/* ---- the cut ---- */

/* What the cut leaves of a triangle, turned; the number of its corners. */
static int32_t cut_corners(const mesh_scene *s, uint64_t t, double q[BVXI_CUT_MOST][3])
{
    double p[3][3];

    /* Corners of a triangle [Units: world * unit]. */
    uint32_t c[3];
    bvxi_view_triangle(s->view, t, c);
    for (int k = 0; k < 3; k++) {
        bvxi_view_position(s->view, c[k], p[k]);
        for (int a = 0; a < 3; a++) p[k][a] *= s->picture.camera.unit;
    }

    int32_t const n = bvxi_cut_triangle(&s->cut, (const double(*)[3])p, q);
    for (int32_t k = 0; k < n; k++) {
        double const at[3] = {q[k][0], q[k][1], q[k][2]};
        bvxi_camera_turn_scaled(&s->picture.camera, at, q[k]);
    }
    return n;
}

/* ---- where the mesh lies in the view ---- */

static void extent_of_piece(void *user, int32_t index, uint64_t begin, uint64_t end)
{
    const mesh_scene *const s = user;
    bvxi_camera_extent e = bvxi_camera_nothing;
    uint32_t c[3];
    double p[3], q[3];

    for (uint64_t t = begin; t < end; t++) {
        if (s->cut.on) {
            double left[BVXI_CUT_MOST][3];
            int32_t const n = cut_corners(s, t, left);
            for (int32_t k = 0; k < n; k++) bvxi_camera_extent_add(&e, left[k]);
            continue;
        }
        bvxi_view_triangle(s->view, t, c);
        for (int k = 0; k < 3; k++) {
            bvxi_view_position(s->view, c[k], p);
            bvxi_camera_turn(&s->picture.camera, p, q);
            bvxi_camera_extent_add(&e, q);
        }
    }
    s->extent[index] = e;
}

/* ---- vertices ---- */

/* Vertices that no triangle uses may lie anywhere; the range keeps them harmless. */
static int32_t snap_in_frame(double v, int32_t side, int32_t bits)
{
    double const limit = (double)side;
    double const in = v > 0.0 ? v < limit ? v : limit : 0.0;
    return (int32_t)(in * (double)((int64_t)1 << bits) + 0.5);
}

static void place_piece(void *user, uint64_t begin, uint64_t end)
{
    const mesh_scene *const s = user;
    const bvxi_raster *const r = &s->picture.raster;
    double p[3], q[3], at[3];
    for (uint64_t v = begin; v < end; v++) {
        bvxi_view_position(s->view, v, p);
        bvxi_camera_turn(&s->picture.camera, p, q);
        bvxi_camera_place(&s->picture.camera, q, at);
        s->vertex[v].x = snap_in_frame(at[0], r->width, r->fraction_bits);
        s->vertex[v].y = snap_in_frame(at[1], r->height, r->fraction_bits);
        /* Far outside the frame a depth may be any number; 0 does no harm to what is not drawn. */
        s->vertex[v].z = at[2] > -1e29 && at[2] < 1e29 ? (float)at[2] : 0.0f;
    }
}

/* ---- triangles ---- */

/* What the cut leaves of a triangle, in the frame: corners for the raster, the plane but for its slopes. */
static int32_t place_cut_triangle(const mesh_scene *s, uint32_t t, int32_t corner[BVXI_CUT_MOST][2],
                                  bvxi_raster_plane *plane)
{
    const bvxi_raster *const r = &s->picture.raster;
    double q[BVXI_CUT_MOST][3], at[3];
    int32_t const n = cut_corners(s, t, q);

    for (int32_t k = 0; k < n; k++) {
        bvxi_camera_place(&s->picture.camera, q[k], at);
        corner[k][0] = snap_in_frame(at[0], r->width, r->fraction_bits);
        corner[k][1] = snap_in_frame(at[1], r->height, r->fraction_bits);
        if (k == 0) {
            plane->x = at[0];
            plane->y = at[1];
            plane->z = at[2];
        }
        plane->low = k == 0 || at[2] < plane->low ? at[2] : plane->low;
        plane->high = k == 0 || at[2] > plane->high ? at[2] : plane->high;
    }
    return n;
}

/* Corners in the camera's axes: right, up and towards the eye [Units: samples]. */
static void scene_corners(const mesh_scene *s, uint32_t t, uint32_t c[3], double p[3][3])
{
    double const part = 1.0 / (double)((int64_t)1 << s->picture.raster.fraction_bits);

    bvxi_view_triangle(s->view, t, c);
    for (int k = 0; k < 3 && s->cut.on; k++) { /* corners that are cut off have no place in the frame */
        double at[3], q[3];
        bvxi_view_position(s->view, c[k], at);
        bvxi_camera_turn(&s->picture.camera, at, q);
        bvxi_camera_place(&s->picture.camera, q, p[k]);
        p[k][1] = -p[k][1];
    }
    for (int k = 0; k < 3 && !s->cut.on; k++) {
        const scene_vertex *const v = &s->vertex[c[k]];
        p[k][0] = (double)v->x * part;
        p[k][1] = (double)v->y * -part;
        p[k][2] = (double)v->z;
    }
}

static int bands_of_triangle(const void *user, uint32_t t, int32_t *first, int32_t *last)
{
    const mesh_scene *const s = user;
    int32_t const bits = s->picture.raster.fraction_bits;
    int32_t const rows = BVXI_PICTURE_BAND * s->picture.options.samples;
    int32_t const bottom = s->picture.raster.height - 1;
    uint32_t c[3];
    int32_t low = INT32_MAX, high = 0;

    if (s->cut.on) {
        int32_t corner[BVXI_CUT_MOST][2];
        bvxi_raster_plane plane;
        int32_t const n = place_cut_triangle(s, t, corner, &plane);
        if (n == 0) return 0;
        for (int32_t k = 0; k < n; k++) {
            low = corner[k][1] < low ? corner[k][1] : low;
            high = corner[k][1] > high ? corner[k][1] : high;
        }
    } else {
        bvxi_view_triangle(s->view, t, c);
        for (int k = 0; k < 3; k++) {
            int32_t const y = s->vertex[c[k]].y;
            low = y < low ? y : low;
            high = y > high ? y : high;
        }
    }
    /* Between two rows of samples there is nothing to draw. */
    if (low == high) return 0;
    high >>= bits;
    *first = (low >> bits) / rows;
    *last = (high < bottom ? high : bottom) / rows;
    return 1;
}

static void draw_scene_triangle(const mesh_scene *s, const bvxi_raster *raster, bvxi_raster_rows rows,
                                uint32_t t)
{
    uint32_t c[3];
    double p[3][3], n[3];
    int32_t corner[BVXI_CUT_MOST][2];
    bvxi_raster_plane plane;

    scene_corners(s, t, c, p);
    bvxi_facet_normal((const double(*)[3])p, n);
    if (n[2] == 0.0) return; /* seen along its edge: covers no sample */

    /* The slopes are those of the whole triangle, so that a cut changes no depth. */
    plane.dx = -n[0] / n[2];
    plane.dy = n[1] / n[2];
    if (s->cut.on) {
        int32_t const left = place_cut_triangle(s, t, corner, &plane);
        if (left > 0) bvxi_raster_polygon(raster, rows, (const int32_t(*)[2])corner, left, &plane, t + 1);
        return;
    }
    for (int k = 0; k < 3; k++) {
        corner[k][0] = s->vertex[c[k]].x;
        corner[k][1] = s->vertex[c[k]].y;
    }

    /* Depths stay within the corners', which keeps rounding from piercing a neighbour. */
    plane.x = p[0][0];
    plane.y = -p[0][1];
    plane.z = p[0][2];
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

/* ---- what a sample shows ---- */

static double scene_unit(double n[3])
{
    double const length = bvxi_vec_length(n);
    if (length > 0.0)
        for (int a = 0; a < 3; a++) n[a] /= length;
    return length;
}

/* Twice the area of a sample with the edge across from corner k; its sign is the whole's inside. */
static double area_across(const double p[3][3], int k, double x, double y)
{
    const double *const a = p[(k + 1) % 3], *const b = p[(k + 2) % 3];
    return (a[0] - x) * (b[1] - y) - (b[0] - x) * (a[1] - y);
}

/* Blend the corners' normals by the areas across from them into n. flat is the facet's own, which stands in
 * where a corner's mean is far from it, so sharp edges stay sharp. */
static void blend_vertex_normals(const mesh_scene *s, const uint32_t c[3], const double p[3][3], double x,
                                 double y, const double flat[3], double n[3])
{
    double blend[3] = {0.0, 0.0, 0.0}, whole = 0.0;

    for (int k = 0; k < 3; k++) {
        double const area = area_across(p, k, x, y);
        double m[3];
        for (int i = 0; i < 3; i++) m[i] = (double)s->normal[(size_t)c[k] * 3 + (size_t)i];
        /* A corner whose mean is far from the facet is a sharp edge's: its own normal keeps it sharp. */
        int const sharp = scene_unit(m) == 0.0 || bvxi_vec_dot(m, flat) < SCENE_SHARP;
        for (int i = 0; i < 3; i++) blend[i] += area * (sharp ? flat[i] : m[i]);
        whole += area; /* negative where the facet is seen from behind: so are all three */
    }
    if (whole < 0.0)
        for (int i = 0; i < 3; i++) blend[i] = -blend[i];
    if (scene_unit(blend) > 0.0) memcpy(n, blend, sizeof blend);
}

/* Blend the corners' colours like their normals. Samples on the border may lie outside by the snapping. */
static void blend_vertex_colours(const mesh_scene *s, const uint32_t c[3], const double p[3][3], double x,
                                 double y, double colour[3])
{
    double share[3], whole = 0.0, sum = 0.0;

    for (int k = 0; k < 3; k++) {
        share[k] = area_across(p, k, x, y);
        whole += share[k];
    }
    /* Shares below 0 come from snapping at the border; without them the rest sums up to less than 1. */
    for (int k = 0; k < 3; k++) {
        share[k] = whole == 0.0 ? 1.0 : share[k] / whole > 0.0 ? share[k] / whole : 0.0;
        sum += share[k];
    }
    for (int a = 0; a < 3; a++) {
        colour[a] = 0.0;
        for (int k = 0; k < 3; k++)
            colour[a] += s->view->colours[(size_t)c[k] * 4 + (size_t)a] * (share[k] / sum);
    }
}

static double light_of_wires(const mesh_scene *s, const double p[3][3], double x, double y)
{
    double const side = s->picture.options.samples;
    double whole = 0.0, area[3], ink = 0.0;

    for (int k = 0; k < 3; k++) {
        area[k] = area_across(p, k, x, y);
        whole += area[k];
    }
    /* A share of the area is a share of the height over that edge, which is the distance from it. */
    for (int k = 0; k < 3; k++) {
        const double *const a = p[(k + 1) % 3], *const b = p[(k + 2) % 3];
        double const length = sqrt((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
        if (length == 0.0 || whole == 0.0) continue;
        double const height = (whole < 0.0 ? -whole : whole) / length;
        double const edge = bvxi_wire_ink(area[k] / whole * height, bvxi_wire_lesser(height, length), side);
        ink = edge > ink ? edge : ink;
    }
    return 1.0 - ink;
}

static void see_mesh(const void *user, const bvxi_raster *raster, uint32_t id, int32_t x, int32_t y,
                     bvxi_seen *seen)
{
    const mesh_scene *const s = user;
    uint32_t c[3];
    double p[3][3], n[3];

    (void)raster;

    /* One colour and one normal for the whole facet: what the last sample saw holds here too. */
    if (s->normal == NULL && s->view->colours == NULL && !s->picture.options.wireframe && seen->key == id)
        return;
    seen->key = id;
    scene_corners(s, id - 1, c, p);
    bvxi_facet_normal((const double(*)[3])p, n);
    scene_unit(n);
    memcpy(seen->normal, n, sizeof n);
    if (s->normal != NULL)
        blend_vertex_normals(s, c, (const double(*)[3])p, x + 0.5, -(y + 0.5), n, seen->normal);
    for (int a = 0; a < 3; a++) seen->colour[a] = s->picture.options.colour[a];
    if (s->view->colours != NULL)
        blend_vertex_colours(s, c, (const double(*)[3])p, x + 0.5, -(y + 0.5), seen->colour);
    seen->light = s->picture.options.wireframe ? light_of_wires(s, (const double(*)[3])p, x + 0.5, -(y + 0.5))
                                               : 1.0;

    /* Seen from behind, all normals are turned to the eye. */
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

/* ---- the picture ---- */

static bvx_status make_scene(bvx_context *ctx, mesh_scene *s)
{
    int32_t const bands = (s->picture.options.height + BVXI_PICTURE_BAND - 1) / BVXI_PICTURE_BAND;

    bvxi_camera_extent all = bvxi_camera_nothing;

    /* Extents of pieces are joined afterwards: neither their number nor their order shows. */
    s->pieces = bvxi_piece_count(s->view->triangle_count, SCENE_GRAIN);
    uint64_t const size = (uint64_t)s->pieces * sizeof *s->extent;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, size, "the picture's extents", &s->extent));
    BVXI_TRY(
        bvxi_for_pieces(ctx, "render", 0.0, 0.05, s->pieces, s->view->triangle_count, extent_of_piece, s));
    for (int32_t i = 0; i < s->pieces; i++) bvxi_camera_extent_join(&all, &s->extent[i]);
    bvxi_drop(ctx, s->extent);
    if (all.low[0] > all.high[0])
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the cut leaves nothing", s->picture.function);
    bvxi_camera_show(&s->picture.camera, s->picture.options.camera.show, &all);
    bvxi_camera_fit(&s->picture.camera, &all, s->picture.raster.width, s->picture.raster.height);

    if (!s->cut.on) {
        BVXI_TRY(BVXI_ARRAY(ctx, s->view->vertex_count, "the picture's vertices", s->vertex));
        BVXI_TRY(BVXI_SHARE(ctx, 0.05, 0.1,
                            bvxi_for(ctx, "render", s->view->vertex_count, SCENE_GRAIN, place_piece, s)));
    }
    BVXI_TRY(bvxi_triangle_bins_open(ctx, s->view->triangle_count, bands, bands_of_triangle, s, &s->bins));
    if (s->picture.options.smooth) {
        /* The mean of the facets around, each counting by its area; in the order of triangles, so on one thread. */
        double p[3][3], n[3];
        uint32_t c[3];
        BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, s->view->vertex_count * 12, "the picture's normals",
                                 &s->normal));
        /* As long as twice the area, so larger facets count for more. */
        for (uint64_t t = 0; t < s->view->triangle_count; t++) {
            scene_corners(s, (uint32_t)t, c, p);
            bvxi_facet_normal((const double(*)[3])p, n);
            for (int k = 0; k < 3; k++)
                for (int a = 0; a < 3; a++) s->normal[(size_t)c[k] * 3 + (size_t)a] += (float)n[a];
        }
    }
    s->picture.draw = draw_scene_rows;
    s->picture.see = see_mesh;
    s->picture.model = s;
    return bvxi_picture_make(ctx, &s->picture);
}

static bvx_status run_render_mesh(bvx_context *context, const bvx_mesh_view *mesh,
                                  const bvx_render_options *options, bvx_image *image)
{
    static const char *const function = "bvx_render_mesh";
    double low[3], high[3];
    mesh_scene s = {.view = mesh};
    BVXI_TRY(bvxi_picture_open(context, function, options, image, &s.picture));
    BVXI_TRY(bvxi_view_check(context, function, mesh));
    BVXI_TRY(bvxi_view_bounds(context, function, mesh, low, high));
    if (low[0] == high[0] && low[1] == high[1] && low[2] == high[2])
        return bvxi_fail(context, BVX_ERR_EMPTY, "%s: all vertices lie at one point", function);
    /* The direction of view is that of the whole mesh; the cut only moves what is looked at. */
    bvxi_camera_look(&s.picture.camera, low, high, s.picture.options.camera.direction,
                     s.picture.options.camera.up);

    /* A box around the whole mesh is no cut; else the camera turns about what is left of the bounds. */
    const bvx_render_options *const o = &s.picture.options;
    for (int a = 0; a < 3; a++) {
        s.cut.low[a] = o->cut.low[a] * s.picture.camera.unit;
        s.cut.high[a] = o->cut.high[a] * s.picture.camera.unit;
        s.cut.on |= o->cut.low[a] > low[a] || o->cut.high[a] < high[a];
        if (o->cut.low[a] > low[a] && o->cut.low[a] < high[a]) low[a] = o->cut.low[a];
        if (o->cut.high[a] < high[a] && o->cut.high[a] > low[a]) high[a] = o->cut.high[a];
    }
    if (s.cut.on) bvxi_camera_move(&s.picture.camera, low, high);

    BVXI_TRY(make_scene(context, &s));
    bvx_image_free(context, image);
    *image = s.picture.image;
    return BVX_OK;
}

bvx_status bvx_render_mesh(bvx_context *context, const bvx_mesh_view *mesh, const bvx_render_options *options,
                           bvx_image *image)
{
    return BVXI_CALL(context, run_render_mesh(context, mesh, options, image));
}
