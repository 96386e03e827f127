/* render_mesh.c - a shaded picture of a triangle mesh: bvx_render_mesh.
 *
 * Vertices are placed in the frame and snapped once, so triangles that share an edge share it in the picture
 * too. Triangles are sorted into bands of rows, bands are drawn apart with a depth buffer, and what each
 * sample sees (the number of its triangle) is shaded afterwards, once.
 * A cut clips triangles before they are snapped, anew wherever one is drawn: what is left of each fits on the
 * stack. */
#include "mesh/facet.h"
#include "render/scenes.h"

enum { SCENE_GRAIN = 8192 /* vertices or triangles a piece, at least */ };

/* ---- the cut ---- */

/* Corners of a triangle [Units: world * unit]. */
static void scaled_corners(const bvxi_mesh_scene *s, uint64_t t, double p[3][3])
{
    uint32_t c[3];
    bvxi_view_triangle(s->view, t, c);
    for (int k = 0; k < 3; k++) {
        bvxi_view_position(s->view, c[k], p[k]);
        for (int a = 0; a < 3; a++) p[k][a] *= s->picture.camera.unit;
    }
}

/* What the cut leaves of a triangle, turned; the number of its corners. */
static int32_t cut_corners(const bvxi_mesh_scene *s, uint64_t t, double q[BVXI_CUT_MOST][3])
{
    double p[3][3];
    scaled_corners(s, t, p);
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
    const bvxi_mesh_scene *const s = user;
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

static bvx_status fit_scene(bvx_context *ctx, bvxi_mesh_scene *s)
{
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

static void place_piece(void *user, uint64_t begin, uint64_t end)
{
    const bvxi_mesh_scene *const s = user;
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

static bvx_status place_vertices(bvx_context *ctx, bvxi_mesh_scene *s)
{
    /* What is cut is placed triangle by triangle instead. */
    if (s->cut.on) return BVX_OK;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, s->view->vertex_count * sizeof *s->vertex,
                        "the picture's vertices", &s->vertex));
    return BVXI_SHARE(ctx, 0.05, 0.1,
                      bvxi_for(ctx, "render", s->view->vertex_count, SCENE_GRAIN, place_piece, s));
}

/* ---- triangles ---- */

/* What the cut leaves of a triangle, in the frame: corners for the raster, the plane but for its slopes. */
static int32_t place_cut_triangle(const bvxi_mesh_scene *s, uint32_t t, int32_t corner[BVXI_CUT_MOST][2],
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

static int bands_of_triangle(const void *user, uint32_t t, int32_t *first, int32_t *last)
{
    const bvxi_mesh_scene *const s = user;
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

static void draw_scene_triangle(const bvxi_mesh_scene *s, const bvxi_raster *raster, bvxi_raster_rows rows,
                                uint32_t t)
{
    uint32_t c[3];
    double p[3][3], n[3];
    int32_t corner[BVXI_CUT_MOST][2];
    bvxi_raster_plane plane;

    bvxi_mesh_scene_corners(s, t, c, p);
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
    const bvxi_mesh_scene *const s = user;
    int32_t const band = rows.begin / (BVXI_PICTURE_BAND * s->picture.options.samples);
    for (uint64_t i = s->bins.begin[band]; i < s->bins.begin[band + 1]; i++)
        draw_scene_triangle(s, raster, rows, s->bins.triangle[i]);
}

static bvx_status make_scene(bvx_context *ctx, bvxi_mesh_scene *s)
{
    int32_t const bands = (s->picture.options.height + BVXI_PICTURE_BAND - 1) / BVXI_PICTURE_BAND;
    BVXI_TRY(fit_scene(ctx, s));
    BVXI_TRY(place_vertices(ctx, s));
    BVXI_TRY(bvxi_triangle_bins_open(ctx, s->view->triangle_count, bands, bands_of_triangle, s, &s->bins));
    if (s->picture.options.smooth) BVXI_TRY(bvxi_mesh_scene_normals(ctx, s));
    s->picture.draw = draw_scene_rows;
    s->picture.see = bvxi_mesh_scene_see;
    s->picture.model = s;
    return bvxi_picture_make(ctx, &s->picture);
}

static bvx_status run_render_mesh(bvx_context *context, const bvx_mesh_view *mesh,
                                  const bvx_render_options *options, bvx_image *image)
{
    static const char *const function = "bvx_render_mesh";
    bvxi_mesh_scene s;
    double low[3], high[3];
    memset(&s, 0, sizeof s);
    s.view = mesh;
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
    /* Where the cut lies inside the bounds, it replaces them for the camera. */
    for (int a = 0; a < 3; a++) {
        s.cut.low[a] = o->cut.low[a] * s.picture.camera.unit;
        s.cut.high[a] = o->cut.high[a] * s.picture.camera.unit;
        s.cut.on |= o->cut.low[a] > low[a] || o->cut.high[a] < high[a];
        if (o->cut.low[a] > low[a] && o->cut.low[a] < high[a]) low[a] = o->cut.low[a];
        if (o->cut.high[a] < high[a] && o->cut.high[a] > low[a]) high[a] = o->cut.high[a];
    }
    if (s.cut.on) bvxi_camera_move(&s.picture.camera, low, high);

    bvx_status const status = make_scene(context, &s);
    if (status != BVX_OK) return status;

    bvx_image_free(context, image);
    *image = s.picture.image;
    return BVX_OK;
}

bvx_status bvx_render_mesh(bvx_context *context, const bvx_mesh_view *mesh, const bvx_render_options *options,
                           bvx_image *image)
{
    return BVXI_CALL(context, run_render_mesh(context, mesh, options, image));
}
