/* choose.c - a base and a number of levels for a finest resolution: bvx_refine_choose.
 *
 * Source: the observation of Liu, Jing, Zhang, Zhao. Refinement of surface voxels by boundary states
 * (docs/papers.md, 4) that for one finest resolution there is a best pair of base and levels. On meshes of
 * 13,000 to 100,000 triangles at 256 to 4096 the largest base of at most 256 voxels is the best, or within a
 * sixth of it. So the pair follows from the resolution alone:
 *   the whole lattice: at least the last two levels, which are one word of 64 voxels, and a base of at most 256
 *   a window: a base of at most 63, as nearly all of it is not halved
 *   a tolerance: a base of at most 15, so that flat places keep large voxels
 * Guarantee: the same choice for any mesh, machine and threads. */
#include "refine/refine.h"

static const char choose_name[] = "bvx_refine_choose";

enum { WHOLE_LEVELS = 2, WHOLE_BASE = 256, WINDOW_BASE = 63, TOLERANCE_BASE = 15 };

/* Voxels of the base, so that the last level has at least `resolution`. */
static int32_t base_for(int32_t resolution, int32_t levels)
{
    return (int32_t)(((int64_t)resolution + ((int64_t)1 << levels) - 1) >> levels);
}

static bvx_status run_refine_choose(bvx_context *context, const bvx_mesh_view *mesh, int32_t resolution,
                                    bvx_refine_options *options, bvx_lattice *base)
{
    bvx_refine_options o;
    bvx_lattice made;

    if (base == NULL) return bvxi_fail_null(context, choose_name, "base");

    if (options == NULL) return bvxi_fail_null(context, choose_name, "options");
    BVXI_TRY(bvxi_take_options(context, choose_name, options, &o, sizeof o));

    /* The answer is written into the caller's struct, which an older header may have made shorter. */
    if (options->struct_size < offsetof(bvx_refine_options, start_level))
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_OPTIONS,
                             "%s: options have no room for levels", choose_name);
    for (int a = 0; a < 3; a++)
        if (o.window.size[a] < 0 || (o.window.size[a] == 0) != (o.window.size[0] == 0))
            return bvxi_fail(context, BVX_ERR_ARGUMENT, "%s: the window's sides are %d, %d, %d", choose_name,
                             (int64_t)o.window.size[0], (int64_t)o.window.size[1], (int64_t)o.window.size[2]);
    if (!(o.tolerance >= 0) || !(o.tolerance - o.tolerance == 0))
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: tolerance is %g; it must be 0 or more and finite", choose_name,
                             o.tolerance);

    if (mesh != NULL && mesh->triangle_count == 0)
        return bvxi_fail(context, BVX_ERR_EMPTY, "%s: the mesh has no triangles", choose_name);
    /* Refuses meshes and resolutions that have no lattice. */
    BVXI_TRY(bvx_lattice_fit(context, mesh, resolution, &made));
    int const whole = o.tolerance == 0 && o.window.size[0] == 0;
    int32_t const most = whole ? WHOLE_BASE : o.tolerance > 0 ? TOLERANCE_BASE : WINDOW_BASE;
    int32_t levels = 0;
    while (resolution >> (levels + 1) > 0 &&
           (base_for(resolution, levels) > most || (whole && levels < WHOLE_LEVELS)))
        levels++;
    BVXI_TRY(bvx_lattice_fit(context, mesh, base_for(resolution, levels), &made));

    /* Both results at once, when nothing can fail any more. */
    *base = made;
    options->levels = levels != 0 ? levels : BVX_NONE;
    return BVX_OK;
}

bvx_status bvx_refine_choose(bvx_context *context, const bvx_mesh_view *mesh, int32_t resolution,
                             bvx_refine_options *options, bvx_lattice *base)
{
    return BVXI_CALL(context, run_refine_choose(context, mesh, resolution, options, base));
}
