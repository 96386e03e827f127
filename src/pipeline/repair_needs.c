/* repair_needs.c - what is wrong with a mesh, and a copy of one with which nothing is.
 *
 * The certificate says most. A mesh of several pieces is asked more: a piece that is turned inward must be
 * the cavity of another, and no piece may lie within another without being its cavity; the rules parity and
 * nonzero then fill the same voxels. Crossings are looked for last, as that takes longest. */
#include "mesh/mesh.h"
#include "pipeline/repair.h"

/* ---- Several pieces ---- */

/* Do parity and nonzero fill the same voxels? Then no piece hides another. */
static bvx_status judge_nesting(bvxi_repair_job *job, int *right)
{
    static const int32_t rule[2] = {BVX_FILL_PARITY, BVX_FILL_NONZERO};
    uint64_t *words[2];
    BVXI_TRY(bvxi_repair_lattice(job, job->options->fit.resolution));
    BVXI_TRY(bvxi_fill_twice(job->ctx, &job->mesh, &job->lattice, rule, words));
    *right = memcmp(words[0], words[1], (size_t)bvx_grid_bound(&job->lattice, NULL) * 8) == 0;
    return BVX_OK;
}

bvx_status bvxi_repair_needs(bvxi_repair_job *job)
{
    bvx_repair_report *const r = &job->report;
    int const several = r->before.components > 1;
    int right = 1;

    const bvx_certificate *const c = &r->before;
    r->needs = !c->closed                                          ? BVX_NEEDS_LIDS
               : !c->edge_manifold || !c->vertex_manifold          ? BVX_NEEDS_MANIFOLD
               : !c->oriented                                      ? BVX_NEEDS_TURNS
               : c->degenerate + c->duplicates + c->collapsed != 0 ? BVX_NEEDS_AREA
               : c->volume > 0                                     ? BVX_NEEDS_NOTHING
                                                                   : BVX_NEEDS_OUTSIDE_IN;
    if (r->needs != BVX_NEEDS_NOTHING || (job->options->report == NULL && !job->options->if_needed))
        return BVX_OK;

    /* Cheapest first: volumes, then two fills, then crossings, which several pieces may not come to. */
    right = r->turned == 0;
    if (several && right) {
        bvxi_piece_marks by = {0};
        bvxi_mesh_piece *pieces = NULL;
        uint64_t count;

        by.piece = job->piece;
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.1,
                            bvxi_mesh_pieces_open(job->ctx, &job->mesh, &by, &r->before, &pieces, &count)));
        right = bvxi_cavities_lie_within(pieces, count);
        bvxi_drop(job->ctx, pieces);
    }
    if (several && right)
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.1, 0.2, BVXI_SCOPE(job->ctx, judge_nesting(job, &right))));
    if (!right) {
        r->needs = BVX_NEEDS_OUTSIDE_IN;
        return BVX_OK;
    }

    BVXI_TRY(
        BVXI_SHARE(job->ctx, 0.2, 1.0, bvx_mesh_crossings(job->ctx, job->given, &r->crossings, NULL, 0)));
    if (r->crossings != 0) r->needs = BVX_NEEDS_UNCROSSING;
    return BVX_OK;
}

/* ---- The copy ---- */

/* number: zeros, by welded vertex; first 1 where a triangle has the vertex, then its index in the copy. */
static bvx_status write_copy(bvxi_repair_job *job, const uint32_t *representative, uint32_t *number,
                             bvx_mesh *copy)
{
    const bvx_mesh_view *const from = job->given;
    uint64_t vertices = 0;

    for (uint64_t t = 0; t < from->triangle_count; t++) {
        uint32_t v[3];
        bvxi_view_triangle(from, t, v);
        for (int k = 0; k < 3; k++) number[representative[v[k]]] = 1;
    }
    for (uint64_t v = 0; v < from->vertex_count; v++)
        if (number[v] != 0) number[v] = (uint32_t)vertices++;
    BVXI_TRY(bvxi_mesh_open(job->ctx, bvxi_repair_name, (int32_t)bvxi_view_type(from), 0, vertices,
                            from->triangle_count, copy));

    for (uint64_t t = 0; t < from->triangle_count; t++) {
        uint32_t v[3];
        bvxi_view_triangle(from, t, v);
        for (size_t k = 0; k < 3; k++) {
            uint32_t const old = representative[v[k]], to = number[old];
            double p[3];
            copy->triangles[3 * t + k] = to;
            bvxi_view_position(from, old, p);
            for (size_t a = 0; a < 3; a++)
                if (bvxi_view_type(from) == BVX_F32)
                    ((float *)copy->positions)[3 * (size_t)to + a] = (float)p[a];
                else ((double *)copy->positions)[3 * (size_t)to + a] = p[a];
        }
    }
    return BVX_OK;
}

bvx_status bvxi_repair_copy(bvxi_repair_job *job, bvx_mesh *copy)
{
    uint64_t const bytes = job->given->vertex_count * 4;
    uint32_t *representative = NULL, *number = NULL;
    uint64_t different;
    bvx_mesh_view view;

    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, bytes, "the vertices' places", &representative));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.1, bvxi_weld(job->ctx, job->given, representative, &different)));
    BVXI_TRY(bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, bytes, "the copy's vertices", &number));
    BVXI_TRY(write_copy(job, representative, number, copy));
    bvxi_drop(job->ctx, number);
    bvxi_drop(job->ctx, representative);

    /* Nothing was made sharp: the copy has the edges that the mesh has. */
    job->report.copied = 1;
    job->report.sharp = 0;
    if (job->options->report == NULL) return BVX_OK;
    bvx_mesh_view_of(copy, &view);
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.1, job->options->samples != 0 ? 0.3 : 1.0,
                        bvx_mesh_check(job->ctx, &view, 0, &job->report.after)));
    if (job->options->samples == 0) return BVX_OK;
    return BVXI_SHARE(
        job->ctx, 0.3, 1.0,
        bvx_mesh_distance(job->ctx, job->given, &view, job->options->samples, 1, &job->report.distance));
}
