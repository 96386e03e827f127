/* simplify_mesh.c - levels of a mesh as it is: bvx_mesh_simplify. */
#include "simplify/room.h"
#include "mesh/mesh.h"
#include "mesh/view.h"

static const char simplify_name[] = "bvx_mesh_simplify";

static const bvxi_option simplify_rows[] = {
    BVXI_TARGETS(bvx_simplify_options),
    BVXI_COLLAPSE(bvx_simplify_options),
};

static bvx_status run_mesh_simplify(bvx_context *context, const bvx_mesh_view *mesh,
                                    const bvx_simplify_options *options, uint64_t level_count,
                                    bvx_mesh *levels)
{
    bvx_simplify_options o;
    bvxi_level_chain chain = {.function = simplify_name};
    bvxi_sheets_report sheets;
    bvx_certificate from;
    double low[3], high[3];

    if (levels == NULL) return bvxi_fail_null(context, simplify_name, "levels");
    BVXI_TRY(bvxi_take_options(context, simplify_name, options, &o, sizeof o));
    BVXI_TRY(bvxi_check_options(context, simplify_name, &o, BVXI_OPTIONS(simplify_rows)));
    BVXI_TRY(bvxi_view_check(context, simplify_name, mesh));
    BVXI_TRY(bvxi_view_check_uvs(context, simplify_name, mesh));
    for (uint64_t i = 0; i < level_count; i++)
        BVXI_TRY(bvxi_view_apart(context, simplify_name, mesh, &levels[i]));

    bvxi_chain_take(&chain, mesh, &o.targets, &o.collapse);
    chain.count = level_count;
    chain.levels = levels;
    chain.reports = o.reports;
    BVXI_TRY(bvxi_levels_check(context, &chain));

    BVXI_TRY(bvxi_view_bounds(context, simplify_name, mesh, low, high));
    if (o.reports != NULL) BVXI_TRY(BVXI_SHARE(context, 0.0, 0.05, bvx_mesh_check(context, mesh, 1, &from)));
    BVXI_TRY(BVXI_SHARE(context, o.reports != NULL ? 0.05 : 0.0, 1.0,
                        bvxi_levels_make(context, &chain, mesh, &sheets)));
    if (o.reports != NULL) bvxi_levels_warn(context, &chain, &from, &sheets);
    return BVX_OK;
}

bvx_status bvx_mesh_simplify(bvx_context *context, const bvx_mesh_view *mesh,
                             const bvx_simplify_options *options, uint64_t level_count, bvx_mesh *levels)
{
    return BVXI_CALL(context, run_mesh_simplify(context, mesh, options, level_count, levels));
}
