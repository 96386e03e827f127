/* sheets.c - triangles as files have them made ready to be simplified as sheets: each once, and those of a
 * patch turned one way. What is oriented already is left alone. */
#include "mesh/topology.h"
#include "mesh/view.h"
#include "simplify/room.h"

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
    bvxi_view_position(welded, corner[0], centre);
    BVXI_TRY(bvxi_patches_open(ctx, welded, own, centre, &patches));

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
    bvx_status status;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the triangles without doubles", &kept));
    status = bvxi_drop_duplicates(ctx, welded, own, kept, &count);
    if (status == BVX_OK) {
        memcpy(corner, kept, (size_t)count * 12);
        welded->triangle_count = count;
    }
    bvxi_drop(ctx, kept);
    return status;
}

bvx_status bvxi_sheets_prepare(bvx_context *ctx, bvx_mesh_view *welded, uint32_t *corner,
                               bvxi_sheets_report *report)
{
    uint64_t const triangles = welded->triangle_count, bytes = welded->vertex_count * 4;
    bvx_status status;
    uint32_t *own; /* the mesh is welded: each vertex stands for itself */

    memset(report, 0, sizeof *report);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices of triangles without doubles", &own));
    for (uint64_t v = 0; v < welded->vertex_count; v++) own[v] = (uint32_t)v;

    status = drop_doubles(ctx, welded, corner, own);
    report->doubles = triangles - welded->triangle_count;
    if (status == BVX_OK) status = orient_sheets(ctx, welded, corner, own, report);
    bvxi_drop(ctx, own);
    return status;
}
