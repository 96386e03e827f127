/* repair_surface.c - the surface of a repaired body: closest points at the ends of crossed edges, marching
 * cubes between them.
 *
 * Only centres with a neighbour on the other side are measured. Where there are shells, a centre takes what
 * is nearer of the body's surface and the shell's: the union of both. Edges that no triangle comes near are
 * crossed by a lid over a hole, and the winding number says where. */
#include "nearest/nearest.h"
#include "pipeline/crossed_edges.h"
#include "pipeline/repair.h"
#include "surface/field_surface.h"

#include <math.h>

/* What is measured, in doubles. */
typedef struct repair_values {
    bvx_grid where;
    uint64_t *first; /* [Size: rows + 1] */
    double *vectors; /* [Size: count * 3] */
    double *distances;
    uint32_t *triangles; /* sharp: of job->given's order of job->body */
    uint64_t rows, count;
} repair_values;

/* ---- Closest points ---- */

/* off: how far the surface between the centres lies off the mesh. Where it
 * is no lid, its edges' ends are nearer than an edge. */
static bvx_status measure_mesh(bvxi_repair_job *job, const repair_values *v, const bvx_mesh_view *mesh,
                               double off, bvxi_nearest_values *out, double from, double to)
{
    double const guess = (off + bvxi_largest_spacing(&job->lattice)) * (1 + 1e-6);
    double const part = from + (to - from) * 0.3;
    bvxi_nearest *nearest = NULL;
    bvx_status status;

    BVXI_TRY(bvxi_nearest_open(bvxi_call_of(job->ctx, bvxi_repair_name, "measure", from, part), mesh,
                               &job->lattice, &nearest));
    bvxi_nearest_prefer_planes(nearest);
    status = bvxi_nearest_fill(bvxi_call_of(job->ctx, NULL, "measure", part, to), nearest, guess, &v->where,
                               v->first, out);
    bvxi_nearest_close(job->ctx, nearest);
    return status;
}

/* The union of body and shell: signed distances, the lesser one's value. */
static void join_values(const bvxi_repair_job *job, repair_values *v, double thick, const double *vectors,
                        const double *distances)
{
    size_t const words = (size_t)v->where.words_per_row;
    uint64_t n = 0;

    for (size_t i = 0; i < words * (size_t)v->rows; i++)
        for (uint64_t bits = v->where.words[i]; bits != 0; bits &= bits - 1, n++) {
            int const inside = (int)(job->solid.words[i] >> bvxi_lowest(bits) & 1);
            double const body = job->body.triangle_count == 0 ? 1e300
                                : inside                      ? -v->distances[n]
                                                              : v->distances[n];
            double shell[3], distance = distances[n];
            memcpy(shell, vectors + 3 * n, sizeof shell);
            bvxi_thin_value(thick, shell, &distance); /* half its thickness off the sheet */
            if (body <= distance) continue;
            memcpy(v->vectors + 3 * n, shell, sizeof shell);
            v->distances[n] = distance;
        }
}

static bvx_status measure_with_shells(bvxi_repair_job *job, repair_values *v)
{
    bvxi_nearest_values out = {.value_type = BVX_F64};
    double *vectors = NULL, *distances = NULL;
    double const thick = 0.5 * job->options->shell * bvxi_largest_spacing(&job->lattice);
    bvx_status status = bvxi_alloc(job->ctx, BVXI_SCRATCH, v->count * 24, "the vectors to sheets", &vectors);

    if (status == BVX_OK)
        status = bvxi_alloc(job->ctx, BVXI_SCRATCH, v->count * 8, "the distances to sheets", &distances);
    out.vectors = vectors;
    out.distances = distances;
    if (status == BVX_OK) status = measure_mesh(job, v, &job->sheets, thick, &out, 0.5, 1.0);
    if (status == BVX_OK) join_values(job, v, thick, vectors, distances);
    bvxi_drop(job->ctx, distances);
    bvxi_drop(job->ctx, vectors);
    return status;
}

static void close_values(bvxi_repair_job *job, repair_values *v)
{
    bvxi_drop(job->ctx, v->triangles);
    bvxi_drop(job->ctx, v->distances);
    bvxi_drop(job->ctx, v->vectors);
    bvxi_drop(job->ctx, v->first);
    bvxi_drop(job->ctx, v->where.words);
}

static bvx_status open_values(bvxi_repair_job *job, repair_values *v)
{
    bvx_context *const ctx = job->ctx;
    bvxi_nearest_values out = {.value_type = BVX_F64};
    int const shells = job->sheets.triangle_count != 0;

    memset(v, 0, sizeof *v);
    v->where = job->inside;
    v->where.words = NULL;
    v->rows = bvxi_grid_rows(&job->inside);
    BVXI_TRY(
        bvxi_alloc(ctx, BVXI_SCRATCH, job->grid_bytes, "the centres that are measured", &v->where.words));
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.03, bvxi_ends_mark(ctx, &job->inside, NULL, &v->where)));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, (v->rows + 1) * 8, "the rows of centres beside the surface",
                        &v->first));
    v->count = bvxi_ends_number(&v->where, v->first);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, v->count * 24, "the vectors of centres beside the surface",
                        &v->vectors));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, v->count * 8, "the distances of centres beside the surface",
                        &v->distances));
    if (job->report.sharp && !shells)
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, v->count * 4, "the triangles of centres beside the surface",
                            &v->triangles));
    out.vectors = v->vectors;
    out.distances = v->distances;
    out.triangles = v->triangles;
    if (job->body.triangle_count != 0)
        BVXI_TRY(measure_mesh(job, v, &job->body, 0, &out, 0.03, shells ? 0.5 : 1.0));
    bvxi_thin_values(&job->thin, &v->where, v->first, v->vectors, v->distances);
    return shells ? measure_with_shells(job, v) : BVX_OK;
}

/* ---- The surface ---- */

static void lid_ratios(const void *user, int32_t count, const bvxi_missing_edge *edge, double *ratio)
{
    const bvxi_repair_job *const job = user;
    bvxi_winding_edge asked[BVXI_MISSING_MOST];
    double told[BVXI_MISSING_MOST];
    int32_t number[BVXI_MISSING_MOST], n = 0;

    for (int32_t e = 0; e < count; e++) {
        const int32_t *const v = edge[e].at;
        int32_t const axis = edge[e].axis;
        ratio[e] = 0.5;
        if (job->winding == NULL || v[0] < 0 || v[1] < 0 || v[2] < 0 ||
            v[axis] + 1 >= job->lattice.dims[axis])
            continue;
        memcpy(asked[n].v, v, sizeof asked[n].v);
        asked[n].axis = axis;
        number[n++] = e;
    }
    if (n > 0) bvxi_winding_ratios(job->winding, n, asked, told);
    for (int32_t e = 0; e < n; e++) ratio[number[e]] = told[e];
}

static bvx_status extract_repaired(bvxi_repair_job *job, const repair_values *v, bvx_mesh *repaired)
{
    const bvx_repair_options *const from = job->options;
    bvx_field_surface_report report;
    bvx_field_surface_options o;
    bvxi_edge_values values;

    memset(&values, 0, sizeof values);
    values.where = &v->where;
    values.row_values = v->first;
    values.value_type = BVX_F64;
    values.vectors = v->vectors;
    values.distances = v->distances;
    values.triangles = v->triangles;
    values.mesh = &job->body;
    values.missing = lid_ratios;
    values.missing_user = job;
    bvx_field_surface_options_init(&o, sizeof o);
    o.interpolation = from->interpolation;
    o.face_rule = from->face_rule;
    o.position_type = from->position_type;
    o.local_frame = from->local_frame;
    o.sharp = job->report.sharp;
    memset(&report, 0, sizeof report);
    o.report = &report;
    BVXI_TRY(bvxi_field_surface(job->ctx, bvxi_repair_name, &job->inside, &values, &o, repaired));
    job->report.sheet_edges = report.lids + report.middle;
    return BVX_OK;
}

bvx_status bvxi_repair_surface(bvxi_repair_job *job, bvx_mesh *repaired)
{
    repair_values v;
    bvx_status status = BVXI_SHARE(job->ctx, 0.0, 0.65, open_values(job, &v));

    if (status == BVX_OK && job->fill != BVX_FILL_PARITY && job->body.triangle_count != 0)
        status = bvxi_winding_open(job->ctx, bvxi_repair_name, &job->body, &job->lattice, job->fill,
                                   &job->holes, &job->winding);
    if (status == BVX_OK) status = BVXI_SHARE(job->ctx, 0.65, 1.0, extract_repaired(job, &v, repaired));
    bvxi_winding_close(job->ctx, job->winding);
    job->winding = NULL;
    close_values(job, &v);
    return status;
}
