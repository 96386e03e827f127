/* repair_input.c - a mesh made ready for repair: what it is, its triangles once each, the pieces that hang together.
 *
 * Triangles that are there twice would count as two turns of the surface, so all but the first go. */
#include "mesh/pieces.h"
#include "mesh/topology.h"
#include "mesh/view.h"
#include "mesh/weld.h"
#include "pipeline/repair.h"

/* Flips that only show once triangles are there once each do not count: which of two opposite ones is first is chance. */
static void choose_sign(bvxi_repair_job *job)
{
    int32_t sign = job->options->sign;
    if (sign == BVX_SIGN_AUTO) sign = job->report.before.flipped_edges != 0 ? BVX_SIGN_VOTE : BVX_SIGN_WINDING;
    job->report.sign = sign;
    job->fill = sign == BVX_SIGN_EXACT ? BVX_FILL_PARITY : sign == BVX_SIGN_VOTE ? BVX_FILL_VOTE : BVX_FILL_WINDING;
}

void bvxi_repair_view(const bvxi_repair_job *job, const uint32_t *corner, uint64_t count, bvx_mesh_view *view)
{
    *view = *job->given;
    view->indices = corner;
    view->index_type = BVX_U32;
    view->index_stride = 0;
    view->triangle_count = count;
}

static bvx_status drop_duplicates(bvxi_repair_job *job, const uint32_t *representative)
{
    uint64_t kept;
    if (job->report.before.duplicates + job->report.before.collapsed == 0) return BVX_OK;
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->given->triangle_count * 12, "the triangles once each", &job->corner));
    BVXI_TRY(bvxi_drop_duplicates(job->ctx, job->given, representative, job->corner, &kept));
    bvxi_repair_view(job, job->corner, kept, &job->mesh);
    return BVX_OK;
}

/* What the mesh is; vertices and pieces are counted for the report alone. */
static bvx_status check_given(bvxi_repair_job *job, const double low[3], const double high[3], uint32_t *representative)
{
    bvx_certificate *const r = &job->report.before;
    int const edges_alone = job->options->report == NULL;
    uint64_t different;
    BVXI_TRY(bvxi_weld(job->ctx, job->given, representative, &different));
    BVXI_TRY(bvxi_check_welded(job->ctx, bvxi_repair_name, job->given, low, high, representative, different, edges_alone, r));
    if (r->triangles == r->degenerate)
        return bvxi_fail(job->ctx, BVX_ERR_EMPTY, "%s: none of the mesh's %u triangles has an area", bvxi_repair_name,
                         job->given->triangle_count);
    return BVX_OK;
}

bvx_status bvxi_repair_take(bvxi_repair_job *job)
{
    bvx_context *const ctx = job->ctx;
    uint64_t const bytes = job->given->vertex_count * 4;
    double low[3], high[3];
    uint32_t *representative;
    bvx_status status;
    if (job->given->triangle_count == 0) return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the mesh has no triangles", bvxi_repair_name);
    BVXI_TRY(bvxi_view_bounds(ctx, bvxi_repair_name, job->given, low, high));
    job->mesh = *job->given;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices' places", &representative));
    status = check_given(job, low, high, representative);
    if (status == BVX_OK) choose_sign(job);
    if (status == BVX_OK) status = drop_duplicates(job, representative);
    if (status == BVX_OK && job->options->shell != 0) {
        status = bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the vertices' pieces", &job->piece);
        if (status == BVX_OK) bvxi_pieces(&job->mesh, representative, job->piece);
    }
    bvxi_free(ctx, representative, bytes);
    return status;
}

void bvxi_repair_let_go(bvxi_repair_job *job)
{
    bvxi_holes_close(job->ctx, &job->holes);
    bvxi_free(job->ctx, job->inside.words, job->grid_bytes);
    bvxi_free(job->ctx, job->solid.words, job->grid_bytes);
    bvxi_free(job->ctx, job->parted, job->mesh.triangle_count * 12);
    bvxi_free(job->ctx, job->piece, job->given->vertex_count * 4);
    bvxi_free(job->ctx, job->corner, job->given->triangle_count * 12);
}
