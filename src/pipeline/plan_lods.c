/* plan_lods.c - how fine the solid must be that levels by samples are made from: bvx_plan_lods.
 *
 * Source: Lian. LOD by voxelization and downsampling (docs/papers.md, 3): levels are good where each sample
 * stands for 5 to 15 voxels along an axis. Eight are taken, or as many as memory allows.
 * Guarantee: the plan follows from mesh, options and memory limit, not from the machine. */
#include "mesh/view.h"

#include <math.h>

enum { PLAN_VOXELS_A_SAMPLE = 8, PLAN_FINEST_GRID = 1 << 20 };

/* Bytes of the finest solid that is planned. */
#define PLAN_MOST_BYTES (UINT64_C(1) << 30)

/* A square of the surface as large as a sample becomes about three triangles. */
#define PLAN_TRIANGLES_A_SQUARE 3.0

static const char plan_lods_name[] = "bvx_plan_lods";

typedef struct lods_plan {
    const bvx_mesh_view *mesh;
    const bvx_lod_options *options;
    uint64_t level_count;
    int32_t padding;
    double corners[2][3];
} lods_plan;

/* Samples along the longest axis of the level that has most. */
static double finest_samples(const lods_plan *p)
{
    const bvx_lod_options *const o = p->options;
    double finest = 1, longest = 0, area, triangles = 0;

    if (o->target_triangles == NULL) {
        uint64_t const n = o->resolutions != NULL ? p->level_count : 3 * p->level_count;
        const int32_t *const given = o->resolutions != NULL ? o->resolutions : o->axis_resolutions;

        for (uint64_t i = 0; i < n; i++) finest = given[i] > finest ? given[i] : finest;
        return finest;
    }

    for (uint64_t i = 0; i < p->level_count; i++)
        if ((double)o->target_triangles[i] > triangles) triangles = (double)o->target_triangles[i];
    for (int a = 0; a < 3; a++) {
        double const side = p->corners[1][a] - p->corners[0][a];
        longest = side > longest ? side : longest;
    }
    area = bvxi_view_area(p->mesh);
    if (!(area > 0)) return finest;

    /* More triangles are made where edges collapse afterwards. */
    triangles *= o->collapse != 0 ? o->collapse : 1;

    /* samples = longest * sqrt(triangles / (3 * area)), as triangles = 3 * area / sample^2 and samples =
     * longest / sample. longest is not squared first: of a long and narrow mesh the square may leave a
     * double's range where what is wanted does not. */
    finest = floor(sqrt(triangles / PLAN_TRIANGLES_A_SQUARE * longest / area * longest) + 0.5);
    return finest > 1 ? finest : 1;
}

static bvx_status search_planned(bvx_context *ctx, const lods_plan *p, int32_t *resolution, int32_t *limited)
{
    double const finest = finest_samples(p), wanted = finest * PLAN_VOXELS_A_SAMPLE;
    int32_t low = finest < PLAN_FINEST_GRID ? (int32_t)finest : PLAN_FINEST_GRID;
    int32_t high = wanted < PLAN_FINEST_GRID ? (int32_t)wanted : PLAN_FINEST_GRID;

    /* Half of what the limit leaves beside the mesh's snapped copy: the other half is for rows in work and for
     * the levels. A snapped vertex takes 16 bytes (bvxi_snapped); 4 a triangle are an allowance, as the buffers
     * of crossings stop growing. */
    uint64_t const limit = bvxi_memory_limit(ctx);
    uint64_t const beside = bvx_memory_used(ctx) + 16 * p->mesh->vertex_count + 4 * p->mesh->triangle_count;
    uint64_t const half = limit > beside ? (limit - beside) / 2 : 0;
    uint64_t const room = limit != 0 && half < PLAN_MOST_BYTES ? half : PLAN_MOST_BYTES;

    /* By bisection from what is wanted; limited says that memory decided. low is not tried: one voxel a
     * sample is returned even where it does not fit. */
    *limited = 0;
    for (int32_t next = high; low < high; next = low + (high - low + 1) / 2) {
        /* Does a solid of this resolution have room? A lattice that cannot be is too large. */
        bvx_lattice_options const o = {.struct_size = sizeof o, .resolution = next, .padding = p->padding};
        bvx_mesh_view const box = {.positions = p->corners, .vertex_count = 2, .position_type = BVX_F64};
        bvx_lattice lattice;
        bvx_status const status = bvx_lattice_fit_with(ctx, &box, &o, &lattice);
        /* The bound is in words, room in bytes. */
        int const fits = status == BVX_OK && bvx_grid_bound(&lattice, NULL) <= room / 8;
        /* Too large a lattice is an answer here, not an error. */
        BVXI_TRY(status == BVX_ERR_RANGE ? BVX_OK : status);
        if (fits) {
            low = next;
        } else {
            high = next - 1;
            *limited = 1;
        }
    }
    *resolution = low;
    return BVX_OK;
}

static bvx_status run_plan_lods(bvx_context *context, const bvx_mesh_view *mesh,
                                const bvx_lod_options *options, uint64_t level_count, int32_t padding,
                                int32_t *resolution, int32_t *limited)
{
    bvx_lod_options o;
    lods_plan p = {mesh, &o, level_count, padding, {{0}}};
    int32_t planned, by_memory;

    if (options == NULL) return bvxi_fail_null(context, plan_lods_name, "options");
    if (resolution == NULL) return bvxi_fail_null(context, plan_lods_name, "resolution");
    BVXI_TRY(bvxi_take_options(context, plan_lods_name, options, &o, sizeof o));

    /* Checked here, as a plan needs only these options. */
    if ((o.resolutions != NULL) + (o.axis_resolutions != NULL) + (o.target_triangles != NULL) != 1)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: give exactly one of resolutions, axis_resolutions and target_triangles",
                             plan_lods_name);
    if (!(o.collapse == 0 || (o.collapse >= 1 && o.collapse <= 64)))
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: collapse %g is neither 0 nor from 1 to 64", plan_lods_name, o.collapse);
    if (level_count == 0)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_RANGE, "%s: level_count is 0",
                             plan_lods_name);

    if (padding < 0 || padding > 65536)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: padding %d is not from 0 to 65536", plan_lods_name, (int64_t)padding);

    BVXI_TRY(bvxi_view_check(context, plan_lods_name, mesh));
    BVXI_TRY(bvxi_view_bounds(context, plan_lods_name, mesh, p.corners[0], p.corners[1]));
    if (p.corners[0][0] == p.corners[1][0] && p.corners[0][1] == p.corners[1][1] &&
        p.corners[0][2] == p.corners[1][2])
        return bvxi_fail(context, BVX_ERR_EMPTY,
                         "%s: all vertices lie at one point, so a resolution gives no spacing",
                         plan_lods_name);
    BVXI_TRY(search_planned(context, &p, &planned, &by_memory));
    *resolution = planned;
    if (limited != NULL) *limited = by_memory;
    return BVX_OK;
}

bvx_status bvx_plan_lods(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lod_options *options,
                         uint64_t level_count, int32_t padding, int32_t *resolution, int32_t *limited)
{
    return BVXI_CALL(context,
                     run_plan_lods(context, mesh, options, level_count, padding, resolution, limited));
}
