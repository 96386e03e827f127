/* simplify_mesh.c - levels of a mesh as it is, with its borders where it has some: bvx_mesh_simplify. First
 * its triangles are made ready: each once, and those of a patch turned one way.
 *
 * Guarantee: a mesh that is oriented already is left as it is, so the order of its triangles changes
 * nothing. */
#include "simplify/room.h"
#include "mesh/topology.h"
#include "mesh/view.h"
#include "mesh/mesh.h"

/* ---- Triangles as files have them made ready to be simplified as sheets: each once, and those of a patch
 * turned one way ---- */

/* What is oriented already is left alone. */

/* ---- Patches ---- */

/* Turn the fewer triangles of each patch; what has one side only stays as
 * it is, and an edge of it is refused. */
static bvx_status orient_sheets(bvx_context *ctx, const bvx_mesh_view *welded, uint32_t *corner,
                                const uint32_t *own, bvxi_sheets_report *report)
{
    bvxi_patches patches;
    bvx_mesh_view turned;
    double centre[3];

    if (welded->triangle_count == 0) return BVX_OK;

    /* Volumes of patches are sums around a corner of the mesh: near it digits are not lost. */
    bvxi_view_position(welded, corner[0], centre);
    BVXI_TRY(bvxi_patches_open(ctx, welded, own, centre, 0, &patches));

    bvxi_patches_turn(welded, &patches, corner, &turned);
    report->turned = patches.turned;
    report->refused = patches.refused_edges;
    memcpy(report->edge, patches.refused, sizeof report->edge);
    bvxi_patches_close(ctx, &patches);
    return BVX_OK;
}

/* ---- Doubles ---- */

/* Triangles that are there twice, as sheets with two sides have them, count once. */
static bvx_status drop_doubles(bvx_context *ctx, bvx_mesh_view *welded, uint32_t *corner, const uint32_t *own)
{
    uint64_t const bytes = welded->triangle_count * 12;
    uint32_t *kept;
    uint64_t count = 0;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the triangles without doubles", &kept));
    BVXI_TRY(bvxi_drop_duplicates(ctx, welded, own, kept, &count));
    /* Back into the caller's array, which the view reads. */
    memcpy(corner, kept, (size_t)count * 12);
    welded->triangle_count = count;
    bvxi_drop(ctx, kept);
    return BVX_OK;
}

bvx_status bvxi_sheets_prepare(bvx_context *ctx, bvx_mesh_view *welded, uint32_t *corner,
                               bvxi_sheets_report *report)
{
    uint64_t const triangles = welded->triangle_count, bytes = welded->vertex_count * 4;
    uint32_t *own; /* the mesh is welded: each vertex stands for itself */

    memset(report, 0, sizeof *report);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices of triangles without doubles", &own));
    for (uint64_t v = 0; v < welded->vertex_count; v++) own[v] = (uint32_t)v;

    BVXI_TRY(drop_doubles(ctx, welded, corner, own));
    report->doubles = triangles - welded->triangle_count;
    BVXI_TRY(orient_sheets(ctx, welded, corner, own, report));
    bvxi_drop(ctx, own);
    return BVX_OK;
}

/* ---- Levels of a mesh as it is, with its borders where it has some: bvx_mesh_simplify ---- */

static const char simplify_name[] = "bvx_mesh_simplify";

static const bvx_simplify_options simplify_defaults = {
    .error_kind = BVX_ERROR_MEAN, .even = 1e-9, .open = BVX_OPEN_KEEP};

void bvx_simplify_options_init(bvx_simplify_options *options, size_t size)
{
    bvxi_give_options(options, size, &simplify_defaults, sizeof simplify_defaults);
}

bvx_status bvxi_welded_view(bvx_context *ctx, const bvx_mesh_view *mesh, bvx_mesh_view *view,
                            uint32_t **corner)
{
    uint64_t const bytes = mesh->vertex_count * 4;
    uint64_t different, kept = 0;
    uint32_t *representative = NULL, *to;

    *view = *mesh;
    *corner = NULL;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, mesh->triangle_count * 12, "the welded triangles", corner));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices' positions", &representative));
    BVXI_TRY(bvxi_weld(ctx, mesh, representative, &different));

    to = *corner;
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        uint32_t v[3];

        bvxi_view_triangle(mesh, t, v);
        for (int k = 0; k < 3; k++) v[k] = representative[v[k]];

        /* Welding may leave triangles without three different corners. */
        if (v[0] == v[1] || v[1] == v[2] || v[2] == v[0]) continue;
        memcpy(to + 3 * kept++, v, sizeof v);
    }
    bvxi_drop(ctx, representative);

    /* The view keeps the mesh's own positions, by other indices. */
    view->indices = *corner;
    view->index_type = BVX_U32;
    view->index_stride = 0;
    view->triangle_count = kept;
    return BVX_OK;
}

static const bvxi_option simplify_rows[] = {
    BVXI_CHOICE(bvx_simplify_options, error_kind, BVX_ERROR_MEAN, BVX_ERROR_MAX),
    BVXI_CHOICE(bvx_simplify_options, position_type, BVX_POSITION_AUTO, BVX_F64),
    BVXI_REAL(bvx_simplify_options, even, 0.0, 1.0),
    BVXI_COUNT(bvx_simplify_options, measure_samples, 0, INT32_MAX),
    BVXI_SWITCH(bvx_simplify_options, strict),
    BVXI_CHOICE(bvx_simplify_options, open, BVX_OPEN_SHELL, BVX_OPEN_CUT),
    BVXI_REAL(bvx_simplify_options, colour_weight, 0.0, 1.0),
    BVXI_RESERVED(bvx_simplify_options, reserved),
};

static bvx_status check_simplify_options(bvx_context *ctx, const bvx_simplify_options *o)
{
    return bvxi_check_options(ctx, simplify_name, o, BVXI_OPTIONS(simplify_rows));
}

/* What is refused as it is may have doubles and flipped triangles alone:
 * edges are cut where nothing else helps. */
static bvx_status simplify_welded(bvx_context *ctx, bvxi_level_chain *chain, bvx_mesh_view *welded,
                                  uint32_t *corner, int32_t open)
{
    bvxi_sheets_report sheets;
    uint64_t mark;
    bvx_status status;

    chain->collapse.borders = open == BVX_OPEN_SHELL ? BVXI_BORDERS_REFUSED : BVXI_BORDERS_KEPT;
    mark = bvxi_scratch_begin(ctx);
    status = bvxi_scratch_keep(ctx, mark, bvxi_levels_make(ctx, chain, welded));
    if (status != BVX_ERR_ARGUMENT || open == BVX_OPEN_SHELL) return status;

    chain->collapse.borders = open == BVX_OPEN_CUT ? BVXI_BORDERS_CUT : BVXI_BORDERS_KEPT;
    BVXI_TRY(bvxi_sheets_prepare(ctx, welded, corner, &sheets));
    return bvxi_levels_make(ctx, chain, welded);
}

static bvx_status run_mesh_simplify(bvx_context *context, const bvx_mesh_view *mesh,
                                    const bvx_simplify_options *options, uint64_t level_count,
                                    bvx_mesh *levels)
{
    bvx_simplify_options o = simplify_defaults;
    bvxi_level_chain chain = {.function = simplify_name};
    double low[3], high[3];
    bvx_mesh_view welded;
    uint32_t *corner = NULL;

    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (levels == NULL) return bvxi_fail_null(context, simplify_name, "levels");
    BVXI_TRY(bvxi_take_options(context, simplify_name, options, &o, sizeof o));
    BVXI_TRY(check_simplify_options(context, &o));
    BVXI_TRY(bvxi_view_check(context, simplify_name, mesh));
    for (uint64_t i = 0; i < level_count; i++)
        BVXI_TRY(bvxi_view_apart(context, simplify_name, mesh, &levels[i]));

    /* Errors are measured against the mesh as it was given, not as it was welded. */
    chain.original = mesh;
    chain.target_triangles = o.target_triangles;
    chain.target_errors = o.target_errors;
    chain.halve_from = mesh->triangle_count;
    chain.error_kind = o.error_kind;
    chain.strict = o.strict;
    chain.measure_samples = o.measure_samples;
    chain.collapse.position_type = o.position_type != BVX_POSITION_AUTO ? o.position_type
                                                                        : (int32_t)mesh->position_type;
    chain.collapse.even = o.even;
    chain.collapse.colour_weight = o.colour_weight;

    /* A mesh of any quality is taken: what crosses already may cross on, but no more. */
    chain.collapse.lenient = 1;
    chain.count = level_count;
    chain.levels = levels;
    chain.reports = o.reports;
    BVXI_TRY(bvxi_levels_check(context, &chain));

    BVXI_TRY(bvxi_view_bounds(context, simplify_name, mesh, low, high));
    BVXI_TRY(bvxi_welded_view(context, mesh, &welded, &corner));
    BVXI_TRY(bvxi_progress(context, "collapse", 0.01));
    BVXI_TRY(simplify_welded(context, &chain, &welded, corner, o.open));
    bvxi_drop(context, corner);
    return BVX_OK;
}

bvx_status bvx_mesh_simplify(bvx_context *context, const bvx_mesh_view *mesh,
                             const bvx_simplify_options *options, uint64_t level_count, bvx_mesh *levels)
{
    return BVXI_CALL(context, run_mesh_simplify(context, mesh, options, level_count, levels));
}
bvx_status bvxi_nearest_colours(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_mesh_view *surface, uint8_t *colours)
{ (void)ctx;(void)mesh;(void)surface;(void)colours; return BVX_OK; }
