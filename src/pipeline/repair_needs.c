/* repair_needs.c - what is wrong with a mesh, and a copy of one with which nothing is.
 *
 * The certificate says most. A mesh of several parts is asked more: a part that is turned inward must be the
 * cavity of another, and no part may lie within another without being its cavity; the rules parity and
 * nonzero then fill the same voxels. Crossings are looked for last, as that takes longest. */
#include "mesh/mesh.h"
#include "mesh/topology.h"
#include "mesh/view.h"
#include "pipeline/repair.h"

/* A piece, by its least vertex: six times its volume, and its box. */
typedef struct needs_piece {
    double volume6, low[3], high[3];
    uint64_t triangles;
} needs_piece;

static int32_t need_of_certificate(const bvx_certificate *c)
{
    if (!c->closed) return BVX_NEEDS_LIDS;
    if (!c->edge_manifold || !c->vertex_manifold) return BVX_NEEDS_MANIFOLD;
    if (!c->oriented) return BVX_NEEDS_TURNS;
    if (c->degenerate + c->duplicates + c->collapsed != 0) return BVX_NEEDS_AREA;
    return c->volume > 0 ? BVX_NEEDS_NOTHING : BVX_NEEDS_OUTSIDE_IN;
}

/* ---- Several parts ---- */

static void add_to_piece(needs_piece *s, const double p[3][3])
{
    double const *const a = p[0], *const b = p[1], *const c = p[2];

    s->volume6 += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
                  a[2] * (b[0] * c[1] - b[1] * c[0]);
    /* Its box begins with its first corner. */
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) {
            if ((s->triangles == 0 && k == 0) || p[k][i] < s->low[i]) s->low[i] = p[k][i];
            if ((s->triangles == 0 && k == 0) || p[k][i] > s->high[i]) s->high[i] = p[k][i];
        }
    s->triangles++;
}

static int is_within_box(const needs_piece *in, const needs_piece *out)
{
    for (int a = 0; a < 3; a++)
        if (!(in->low[a] > out->low[a] && in->high[a] < out->high[a])) return 0;
    return 1;
}

/* Has each piece that is turned inward one around it? */
static int cavities_lie_within(const needs_piece *pieces, uint64_t count)
{
    for (uint64_t n = 0; n < count; n++) {
        int within = 0;
        /* No piece, or one that faces outwards. */
        if (pieces[n].triangles == 0 || pieces[n].volume6 > 0) continue;
        for (uint64_t m = 0; m < count && !within; m++)
            within = pieces[m].triangles != 0 && pieces[m].volume6 > 0 &&
                     is_within_box(&pieces[n], &pieces[m]);
        if (!within) return 0;
    }
    return 1;
}

/* The pieces' sums: sums from coordinates around the middle of the mesh, so that far ones keep their
 * digits. */
static bvx_status judge_pieces(bvxi_repair_job *job, int *right)
{
    uint64_t const count = job->given->vertex_count, bytes = count * sizeof(needs_piece);
    const double *const low = job->report.before.low, *const high = job->report.before.high;
    needs_piece *pieces;

    BVXI_TRY(bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, bytes, "the pieces' volumes", &pieces));
    for (uint64_t t = 0; t < job->mesh.triangle_count; t++) {
        double p[3][3];
        uint32_t v[3];
        bvxi_view_triangle(&job->mesh, t, v);
        for (int k = 0; k < 3; k++) {
            bvxi_view_position(&job->mesh, v[k], p[k]);
            /* Around the middle, so that far coordinates keep their digits. */
            for (int a = 0; a < 3; a++) p[k][a] -= 0.5 * low[a] + 0.5 * high[a];
        }
        add_to_piece(&pieces[job->piece[v[0]]], (const double(*)[3])p);
    }
    *right = cavities_lie_within(pieces, count);
    bvxi_drop(job->ctx, pieces);
    return BVX_OK;
}

/* Do parity and nonzero fill the same voxels? */
static bvx_status judge_nesting(bvxi_repair_job *job, int *right)
{
    static const int32_t rule[2] = {BVX_FILL_PARITY, BVX_FILL_NONZERO};
    bvx_voxelize_options o;
    bvx_grid grid[2];
    uint64_t bytes = 0;
    bvx_status status = bvxi_repair_lattice(job, job->options->resolution);

    /* Both rules on one lattice; equal bits say that neither part hides another. */
    memset(grid, 0, sizeof grid);
    bvx_voxelize_options_init(&o, sizeof o);
    if (status == BVX_OK) bytes = bvx_grid_bound(&job->lattice, NULL) * 8;
    for (int i = 0; i < 2 && status == BVX_OK; i++) {
        status = bvxi_alloc(job->ctx, BVXI_SCRATCH, bytes, "the parts' solids", &grid[i].words);
        grid[i].word_capacity = bytes / 8;
        o.fill = rule[i];
        if (status == BVX_OK) status = bvx_voxelize_solid(job->ctx, &job->mesh, &job->lattice, &o, &grid[i]);
    }
    if (status == BVX_OK) *right = memcmp(grid[0].words, grid[1].words, (size_t)bytes) == 0;
    for (int i = 2; i-- > 0;) bvxi_drop(job->ctx, grid[i].words);
    return status;
}

bvx_status bvxi_repair_needs(bvxi_repair_job *job)
{
    bvx_repair_report *const r = &job->report;
    int right = 1;

    r->needs = need_of_certificate(&r->before);
    if (r->needs != BVX_NEEDS_NOTHING || (job->options->report == NULL && !job->options->if_needed))
        return BVX_OK;

    /* Cheapest first: volumes, then two fills, then crossings. */
    if (r->before.components > 1) BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.1, judge_pieces(job, &right)));
    if (r->before.components > 1 && right)
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.1, 0.3, judge_nesting(job, &right)));
    if (!right) {
        r->needs = BVX_NEEDS_OUTSIDE_IN;
        return BVX_OK;
    }
    BVXI_TRY(
        BVXI_SHARE(job->ctx, 0.3, 1.0, bvx_mesh_crossings(job->ctx, job->given, &r->crossings, NULL, 0)));
    if (r->crossings != 0) r->needs = BVX_NEEDS_UNCROSSING;
    return BVX_OK;
}

/* ---- The copy ---- */

static bvx_status write_copy(bvxi_repair_job *job, const uint32_t *representative, uint32_t *number,
                             bvx_mesh *copy)
{
    const bvx_mesh_view *const from = job->given;
    uint64_t vertices = 0;

    /* Vertices that triangles have, in their order. */
    for (uint64_t t = 0; t < from->triangle_count; t++) {
        uint32_t v[3];
        bvxi_view_triangle(from, t, v);
        for (int k = 0; k < 3; k++) number[representative[v[k]]] = 1;
    }
    for (uint64_t v = 0; v < from->vertex_count; v++)
        if (number[v] != 0) number[v] = (uint32_t)vertices++;
    BVXI_TRY(bvxi_mesh_open(job->ctx, bvxi_repair_name, (int32_t)from->position_type, 0, vertices,
                            from->triangle_count, copy));

    /* Corners by their new numbers, positions once for each. */
    for (uint64_t t = 0; t < from->triangle_count; t++) {
        uint32_t v[3];
        bvxi_view_triangle(from, t, v);
        for (size_t k = 0; k < 3; k++) {
            uint32_t const old = representative[v[k]], to = number[old];
            double p[3];
            copy->triangles[3 * t + k] = to;
            bvxi_view_position(from, old, p);
            for (size_t a = 0; a < 3; a++)
                if (from->position_type == BVX_F32)
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
    bvx_status status = bvxi_alloc(job->ctx, BVXI_SCRATCH, bytes, "the vertices' places", &representative);

    if (status == BVX_OK)
        status = BVXI_SHARE(job->ctx, 0.0, 0.1, bvxi_weld(job->ctx, job->given, representative, &different));
    if (status == BVX_OK)
        status = bvxi_alloc_zero(job->ctx, BVXI_SCRATCH, bytes, "the copy's vertices", &number);
    if (status == BVX_OK) status = write_copy(job, representative, number, copy);
    bvxi_drop(job->ctx, number);
    bvxi_drop(job->ctx, representative);
    if (status != BVX_OK) return status;

    /* Nothing was made sharp: the copy has the edges that the mesh has. */
    job->report.copied = 1;
    job->report.sharp = 0;
    if (job->options->report == NULL) return BVX_OK;
    bvx_mesh_view_of(copy, &view);
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.1, job->options->measure ? 0.3 : 1.0,
                        bvx_mesh_check(job->ctx, &view, 0, &job->report.after)));
    if (!job->options->measure) return BVX_OK;
    return BVXI_SHARE(job->ctx, 0.3, 1.0,
                      bvx_mesh_distance(job->ctx, job->given, &view, job->options->measure_samples, 1,
                                        &job->report.distance));
}
