/* crossing_pairs.c - pairs of triangles that cross: bvx_mesh_crossings.
 *
 * Triangles in the order of a curve through space, and boxes over them (crossing_tree.c). Boxes are rounded by functions
 * that never fall, so two that are apart hold points that are apart; the test itself reads the caller's coordinates,
 * which are scaled nowhere. */
#include "nearest/closest.h"
#include "nearest/crossing_tree.h"
#include "mesh/mesh.h"

enum { PAIRS_GRAIN = 4096 /* vertices or triangles a task */ };

/* Mesh sizes between which steps along diagonals are finite. */
#define PAIRS_NARROWEST 1e-290
#define PAIRS_WIDEST    1e290

static const char crossings_name[] = "bvx_mesh_crossings";

typedef struct pairs_job {
    const bvxi_welded *mesh;
    bvxi_curve curve;
    double *at;       /* coordinates as the caller gave them [Size: vertices * 3] */
    uint32_t *vertex; /* representatives [Size: triangles * 3] */
    crossing_tree tree;
} pairs_job;

static void pairs_positions(void *user, uint64_t begin, uint64_t end)
{
    const pairs_job *const job = user;
    for (uint64_t v = begin; v < end; v++) bvxi_view_position(job->mesh->view, v, job->at + 3 * v);
}

static void pairs_corners(void *user, uint64_t begin, uint64_t end)
{
    const pairs_job *const job = user;
    for (uint64_t t = begin; t < end; t++) {
        uint32_t *const v = job->vertex + 3 * t;
        bvxi_view_triangle(job->mesh->view, t, v);
        for (int k = 0; k < 3; k++) v[k] = job->mesh->representative[v[k]];
    }
}

static bvx_status open_pairs(bvx_context *ctx, pairs_job *job)
{
    const bvx_mesh_view *const view = job->mesh->view;
    double half[3], minus[3], size = 0;

    job->curve.view = view;
    job->curve.bits = BVXI_CURVE_BITS;
    job->curve.fast = bvxi_cpu(ctx) == BVX_CPU_AVX2;
    job->curve.scale = bvxi_unit_scale(job->mesh->low, job->mesh->high);
    for (int a = 0; a < 3; a++) {
        double const low = job->mesh->low[a], high = job->mesh->high[a];

        job->curve.centre[a] = (low * job->curve.scale + high * job->curve.scale) * 0.5;
        half[a] = (high * job->curve.scale - low * job->curve.scale) * 0.5;
        minus[a] = -half[a];
        size = high - low > size ? high - low : size;
    }
    job->curve.units = bvxi_unit_scale(minus, half);
    uint64_t const n = job->mesh->view->triangle_count;

    BVXI_TRY(BVXI_ARRAY(ctx, n, "the crossings' order", job->curve.order));
    BVXI_TRY(BVXI_ARRAY(ctx, n, "the crossings' keys", job->curve.keys));
    BVXI_TRY(bvxi_curve_sort(bvxi_call_of(ctx, NULL, "crossings", 0.0, 0.2), &job->curve));
    bvxi_drop(ctx, job->curve.keys);
    BVXI_TRY(BVXI_ARRAY(ctx, 3 * view->vertex_count, "the crossings' positions", job->at));
    BVXI_TRY(BVXI_ARRAY(ctx, 3 * view->triangle_count, "the crossings' corners", job->vertex));
    BVXI_TRY(BVXI_SHARE(ctx, 0.2, 0.25,
                        bvxi_for(ctx, "crossings", view->vertex_count, PAIRS_GRAIN, pairs_positions, job)));
    BVXI_TRY(BVXI_SHARE(ctx, 0.25, 0.3,
                        bvxi_for(ctx, "crossings", view->triangle_count, PAIRS_GRAIN, pairs_corners, job)));

    job->tree = (crossing_tree){.at = job->at,
                                .vertex = job->vertex,
                                .at_step = 3,
                                .vertex_step = 3,
                                .live = job->curve.order,
                                .triangles = view->triangle_count,
                                .scale = size > 0 ? 1 / size : 1,
                                .slanted = size > PAIRS_NARROWEST && size < PAIRS_WIDEST};
    memcpy(job->tree.low, job->mesh->low, sizeof job->tree.low);
    return bvxi_crossing_tree_open(ctx, &job->tree);
}

bvx_status bvxi_mesh_crossings(bvx_context *ctx, const bvxi_welded *mesh, uint64_t most, uint32_t **pairs,
                               uint64_t *count)
{
    pairs_job job = {.mesh = mesh};
    BVXI_TRY(open_pairs(ctx, &job));
    BVXI_TRY(bvxi_crossings_find(ctx, &job.tree, 0.3, 1.0, most, pairs, count));
    bvxi_drop(ctx, job.tree.node[0]);
    bvxi_drop(ctx, job.vertex);
    bvxi_drop(ctx, job.at);
    bvxi_drop(ctx, job.curve.order);
    return BVX_OK;
}

bvx_status bvxi_crossing_pairs(bvx_context *ctx, const bvx_mesh_view *mesh, uint64_t most, uint32_t **pairs,
                               uint64_t *count)
{
    uint32_t *representative;
    bvxi_welded welded = {.view = mesh};

    *count = 0;
    *pairs = NULL;
    BVXI_TRY(bvxi_view_check(ctx, crossings_name, mesh));
    if (mesh->triangle_count == 0) return BVX_OK;
    BVXI_TRY(bvxi_view_bounds(ctx, crossings_name, mesh, welded.low, welded.high));

    /* Triangles that share a position share a corner, whatever their vertices' indices. */
    BVXI_TRY(BVXI_ARRAY(ctx, mesh->vertex_count, "the crossings' welding", representative));
    welded.representative = representative;
    BVXI_TRY(bvxi_weld(ctx, mesh, representative, &welded.different));
    BVXI_TRY(bvxi_mesh_crossings(ctx, &welded, most, pairs, count));
    bvxi_drop(ctx, representative);
    return BVX_OK;
}

static bvx_status run_mesh_crossings(bvx_context *context, const bvx_mesh_view *mesh, uint64_t *count,
                                     uint32_t *pairs, uint64_t capacity)
{
    uint64_t const most = pairs == NULL ? 0 : capacity < UINT32_MAX ? capacity : UINT32_MAX;
    uint64_t found;
    uint32_t *listed;

    if (count == NULL) return bvxi_fail_null(context, crossings_name, "count");
    *count = 0;
    BVXI_TRY(bvxi_crossing_pairs(context, mesh, most, &listed, &found));
    if (pairs != NULL && found > most && found <= capacity)
        return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: there are %u pairs, the limit of a list is %u", crossings_name, found,
                             most);

    /* The count is right also where the array is too small: the caller learns what would be enough. */
    *count = found;
    if (pairs != NULL && found > capacity)
        return bvxi_fail(context, BVX_ERR_CAPACITY, "%s: there are %u pairs, the array given holds %u",
                         crossings_name, found, capacity);
    if (pairs != NULL && found != 0) memcpy(pairs, listed, (size_t)found * 8);
    return BVX_OK;
}

bvx_status bvx_mesh_crossings(bvx_context *context, const bvx_mesh_view *mesh, uint64_t *count,
                              uint32_t *pairs, uint64_t capacity)
{
    return BVXI_CALL(context, run_mesh_crossings(context, mesh, count, pairs, capacity));
}
