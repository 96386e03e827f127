/* repair_surface.c - the surface of a repaired body: closest points at the ends of crossed edges, marching
 * cubes between them.
 *
 * Only centres with a neighbour on the other side are measured. Where there are shells, a centre takes what
 * is nearer of the body's surface and the shell's: the union of both. Edges that no triangle comes near are
 * crossed by a lid over a hole, and the winding number says where. */
#include "pipeline/repair.h"

#include <math.h>

/* ---- Closest points ---- */

static bvx_status measure_with_shells(bvxi_repair_job *job, const bvxi_sparse *v)
{
    double const thick = 0.5 * job->options->shell * bvxi_largest_spacing(&job->lattice);
    bvxi_sparse sheets = {.where = v->where, .first = v->first, .count = v->count}; /* at the same centres */

    BVXI_TRY(bvxi_sparse_columns(job->ctx, &sheets, BVX_F64, BVXI_VECTORS | BVXI_DISTANCES));

    BVXI_TRY(BVXI_SHARE(job->ctx, 0.5, 1.0,
                        bvxi_measure_ends(job->ctx, bvxi_repair_name, &job->sheets, thick, &sheets)));

    /* The union of body and shell: signed distances, the lesser one's value. */
    double *const vectors = v->vectors, *const distances = v->distances;
    uint64_t const words = bvxi_grid_words(&v->where);
    uint64_t n = 0;

    for (uint64_t i = 0; i < words; i++)
        for (uint64_t bits = v->where.words[i]; bits != 0; bits &= bits - 1, n++) {
            int const inside = (int)(job->solid.words[i] >> bvxi_lowest(bits) & 1);
            double const body = job->body.triangle_count == 0 ? 1e300 : inside ? -distances[n] : distances[n];
            double shell[3], distance = ((const double *)sheets.distances)[n];
            memcpy(shell, (const double *)sheets.vectors + 3 * n, sizeof shell);
            bvxi_thin_value(thick, shell, &distance); /* half its thickness off the sheet */
            if (body <= distance) continue;
            memcpy(vectors + 3 * n, shell, sizeof shell);
            distances[n] = distance;
        }
    return BVX_OK;
}

/* What is measured, in doubles; triangles where edges are sharp, in the order of job->body. */
static bvx_status open_values(bvxi_repair_job *job, bvxi_sparse *v)
{
    int const shells = job->sheets.triangle_count != 0;
    uint32_t const triangles = job->report.sharp && !shells ? BVXI_TRIANGLES : 0;
    BVXI_TRY(bvxi_sparse_columns(job->ctx, v, BVX_F64, BVXI_VECTORS | BVXI_DISTANCES | triangles));
    if (job->body.triangle_count != 0)
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, shells ? 0.5 : 1.0,
                            bvxi_measure_ends(job->ctx, bvxi_repair_name, &job->body, 0, v)));
    bvxi_thin_values(&job->thin, v);
    return shells ? BVXI_SCOPE(job->ctx, measure_with_shells(job, v)) : BVX_OK;
}

/* ---- The surface ---- */

void bvxi_lid_ratios(const void *user, int32_t count, const bvxi_missing_edge *edge, double *ratio)
{
    const bvxi_lids *const lids = user;
    bvxi_winding_edge asked[BVXI_MISSING_MOST];
    double told[BVXI_MISSING_MOST];
    int32_t number[BVXI_MISSING_MOST], n = 0;

    /* Edges at the window's side, or without winding numbers, are cut in the middle. */
    for (int32_t e = 0; e < count; e++) {
        const int32_t *const v = edge[e].at;
        int32_t const axis = edge[e].axis;
        ratio[e] = 0.5;
        if (lids->winding == NULL || v[0] < 0 || v[1] < 0 || v[2] < 0 ||
            v[axis] + 1 >= lids->lattice->dims[axis])
            continue;
        memcpy(asked[n].v, v, sizeof asked[n].v);
        asked[n].axis = axis;
        number[n++] = e;
    }
    if (n > 0) bvxi_winding_ratios(lids->winding, n, asked, told);
    for (int32_t e = 0; e < n; e++) ratio[number[e]] = told[e];
}

bvx_status bvxi_repair_surface(bvxi_repair_job *job, bvx_mesh *repaired)
{
    bvxi_sparse v = {.count = 0};

    BVXI_TRY(bvxi_sparse_open(job->ctx, &job->inside, &v));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.0, bvxi_ends_mark(job->ctx, &job->inside, NULL, &v.where)));
    BVXI_TRY(bvxi_sparse_rank(job->ctx, &v));

    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.5, open_values(job, &v)));

    /* Lids lie where the winding number is a half; parity has none. */
    if (job->fill != BVX_FILL_PARITY && job->body.triangle_count != 0)
        BVXI_TRY(bvxi_winding_open(job->ctx, bvxi_repair_name, &job->body, &job->lattice, job->fill,
                                   &job->holes, &job->winding));
    bvx_field_surface_report report = {0};
    bvx_field_surface_options o = {
        .placing = job->options->placing, .sharp_angle = BVXI_SHARP_ANGLE, .report = &report};
    bvxi_lids const lids = {job->winding, &job->lattice};
    bvxi_cut_rule rule = {0};

    o.placing.sharp = job->report.sharp ? BVX_SHARP_ALWAYS : BVX_SHARP_NEVER;
    rule.values = &v;
    rule.mesh = &job->body;
    rule.missing = bvxi_lid_ratios;
    rule.missing_user = &lids;
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.5, 1.0,
                        bvxi_field_surface(job->ctx, bvxi_repair_name, &job->inside, &rule, &o, repaired)));
    job->facts.sheet_edges = report.lids + report.middle;
    return BVX_OK;
}
