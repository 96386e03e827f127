/* points.c - the voxels that hold points of a cloud, and the body behind them: bvx_voxelize_points.
 *
 * Points are snapped as vertices are (snap.h), and a shift gives the voxel. Where a voxel needs several
 * points it has a counter in planes of bits that begins so that the last one needed runs over: no lists, no
 * sorting. The body is what a cube that comes from outside cannot reach (close_gaps.c).
 * Guarantee: exact; the order of points plays no part. */
#include "fill/fills.h"

enum { POINTS_ASKED = 1 << 20 /* points between two questions for progress */ };

static const char points_name[] = "bvx_voxelize_points";

typedef struct points_work {
    bvx_mesh_view view;
    bvx_grid *grid;
    uint64_t *planes; /* counters: plane_count grids of words, the lowest digit first */
    uint64_t words;
    int32_t plane_count;
    double scale[3];
    bvx_points_report report;
} points_work;

static inline void take_point(points_work *w, const double p[3])
{
    const bvx_grid *const g = w->grid;
    int32_t const f = g->lattice.fraction_bits;
    int32_t q[3], v[3];
    int inside = bvxi_snap_vertex(p, g->lattice.origin, w->scale, q);

    /* As vertices are snapped, so a mesh's own points fall into voxels that it passes. */
    for (int32_t a = 0; a < 3; a++) {
        v[a] = bvxi_floor_shift(q[a], f);
        v[a] -= q[a] == g->lattice.dims[a] << f; /* the lattice's high side belongs to its last voxel */
        v[a] -= g->low[a];
        inside &= v[a] >= 0 && v[a] < g->size[a];
    }
    w->report.inside += (uint64_t)inside;
    w->report.outside += !inside;
    if (!inside) return;
    size_t const word = ((size_t)v[2] * (size_t)g->size[1] + (size_t)v[1]) * (size_t)g->words_per_row +
                        (size_t)(v[0] >> 6);
    uint64_t const bit = UINT64_C(1) << (v[0] & 63);
    if ((g->words[word] & bit) != 0) return; /* Full already: no counter is changed any more. */
    for (int32_t d = 0; d < w->plane_count; d++) {
        uint64_t *const digit = &w->planes[(size_t)w->words * (size_t)d + word];
        *digit ^= bit;
        if ((*digit & bit) != 0) return; /* 0 became 1: nothing to carry */
    }
    g->words[word] |= bit;
}

static const bvxi_option points_rows[] = {
    BVXI_OR(bvx_points_options, minimum, WHOLE, 1, 1, INT32_MAX),
    BVXI_SWITCH(bvx_points_options, body),
    BVXI_WHOLE(bvx_points_options, close_gaps, 0, BVXI_MOST_GAP),
    BVXI_RESERVED(bvx_points_options, reserved),
};

static bvx_status voxelize_cloud(bvx_context *ctx, const bvx_points_options *o, points_work *w)
{
    w->words = bvxi_grid_words(w->grid);
    int32_t n = 0;
    while (((int64_t)1 << n) < o->minimum) n++;
    w->plane_count = n;
    memset(w->grid->words, 0, (size_t)w->words * 8);
    if (w->plane_count != 0) {
        /* All counters begin at 2^plane_count - minimum. */
        uint64_t const begin = ((uint64_t)1 << w->plane_count) - (uint64_t)o->minimum;
        int ok = 1;

        /* Several grids of counters: their size may pass 64 bits. */
        uint64_t const bytes = bvxi_mul(w->words * 8, (uint64_t)w->plane_count, &ok);

        if (!ok)
            return bvxi_fail(ctx, BVX_ERR_BUDGET, "%s: counters of %d grids are beyond 64 bits", points_name,
                             (int64_t)w->plane_count);
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the counters of points", &w->planes));
        /* All counters at once: each digit is a whole grid of zeros or ones. */
        for (int32_t p = 0; p < w->plane_count; p++)
            memset(w->planes + (size_t)w->words * (size_t)p, (begin >> p & 1) != 0 ? 0xff : 0,
                   (size_t)w->words * 8);
    }
    for (uint64_t i = 0; i < w->view.vertex_count; i++) {
        double p[3];
        /* Rarely, so that the question costs nothing. */
        if (i % POINTS_ASKED == 0)
            BVXI_TRY(bvxi_progress(ctx, "points", (double)i / (double)w->view.vertex_count));
        bvxi_view_position(&w->view, i, p);
        if (!bvxi_view_finite(p)) return bvxi_view_fail_finite(ctx, points_name, &w->view, i);
        take_point(w, p);
    }
    BVXI_TRY(bvx_grid_count(ctx, w->grid, &w->report.occupied));
    if (o->body) {
        uint64_t set = 0;
        BVXI_TRY(bvxi_close_gaps(ctx, points_name, w->grid, o->close_gaps, &w->report.pockets));
        BVXI_TRY(bvx_grid_count(ctx, w->grid, &set));
        w->report.filled = set - w->report.occupied;
    }
    return BVX_OK;
}

static bvx_status run_voxelize_points(bvx_context *context, const bvx_mesh_view *points,
                                      const bvx_lattice *lattice, const bvx_points_options *options,
                                      bvx_grid *grid)
{
    bvx_points_options o;
    points_work work = {0};
    bvx_window window;

    if (grid == NULL) return bvxi_fail_null(context, points_name, "grid");
    BVXI_TRY(bvxi_take_options(context, points_name, options, &o, sizeof o));
    BVXI_TRY(bvxi_view_take_points(context, points_name, points, &work.view));
    if (work.view.vertex_count == 0)
        return bvxi_fail(context, BVX_ERR_EMPTY, "%s: there are no points", points_name);

    BVXI_TRY(bvxi_check_options(context, points_name, &o, BVXI_OPTIONS(points_rows)));
    if (o.close_gaps != 0 && !o.body)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: close_gaps requires body", points_name);
    BVXI_TRY(bvxi_lattice_check(context, points_name, lattice));
    BVXI_TRY(bvxi_window_take(context, points_name, lattice, &o.window, &window));
    for (int32_t a = 0; a < 3 && o.body; a++)
        if (window.size[a] != lattice->dims[a])
            return bvxi_fail_for(
                context, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                "%s: body needs the whole lattice, as what lies in the window depends on what lies outside",
                points_name);

    BVXI_TRY(bvxi_snap_scale(context, points_name, lattice, work.scale));
    bvxi_grid_renew(context, lattice, &window, grid);
    bvx_grid made = *grid;
    BVXI_TRY(bvxi_grid_open(context, points_name, lattice, &window, &made));
    work.grid = &made;
    BVXI_TRY(bvxi_grid_put(context, voxelize_cloud(context, &o, &work), &made, grid));
    if (o.report != NULL) *o.report = work.report;
    return BVX_OK;
}

bvx_status bvx_voxelize_points(bvx_context *context, const bvx_mesh_view *points, const bvx_lattice *lattice,
                               const bvx_points_options *options, bvx_grid *grid)
{
    return BVXI_CALL(context, run_voxelize_points(context, points, lattice, options, grid));
}
