/* hull.c - what can be reached from outside as a closed mesh, from any mesh: bvx_hull.
 *
 * Centres that no way from outside leads to are the body (outside.c), so inner walls, shells and parts are in it and
 * gone. Of the triangles only those count that a lattice edge into the body meets first: the outer of two walls, also
 * where both lie between the same two centres. Walls that no centre lies in, with outside on both sides, become
 * shells. Then the surface is measured from these triangles as in repair, and its edges collapse.
 * Guarantee: that of bvx_repair and of the levels of its surface, whatever the input. */
#include "fill/fills.h"
#include "mesh/mesh.h"
#include "pipeline/enclose.h"
#include "pipeline/repair.h"
#include "simplify/room.h"

#include <math.h>

static const char hull_name[] = "bvx_hull";

/* What a triangle is for. */
enum { HULL_BODY = 1, HULL_SHEET = 2 };

typedef struct hull_job {
    bvxi_repair_job repair; /* mesh is given; body and sheets are what counts of it */
    const bvx_hull_options *options;
    bvx_repair_options as_repair; /* what of the options repair's steps take */
    bvx_grid outside, ends, sheets;
    bvx_hull_report report;
} hull_job;

static const bvxi_option hull_rows[] = {
    BVXI_RESERVED(bvx_hull_options, fit.reserved),
    BVXI_PLACING(bvx_hull_options),
    BVXI_TARGETS(bvx_hull_options),
    BVXI_PARTS(bvx_hull_options),
    BVXI_OR(bvx_hull_options, shell, ZERO_OR, 2.0, 1.5, 1e6),
    BVXI_WHOLE(bvx_hull_options, close_gaps, 0, BVXI_MOST_GAP),
    BVXI_REAL(bvx_hull_options, enclose, 0.0, BVXI_FINITE),
    BVXI_RESERVED(bvx_hull_options, reserved),
};

/* ---- The body ---- */

static bvx_status open_hull_grid(hull_job *job, bvx_grid *grid)
{
    uint64_t const words = bvx_grid_bound(&job->repair.lattice, NULL);

    memset(grid, 0, sizeof *grid);
    BVXI_TRY(BVXI_ARRAY(job->repair.ctx, words, "a grid of the hull", grid->words));
    grid->word_capacity = words;
    return bvx_grid_create(job->repair.ctx, &job->repair.lattice, NULL, grid);
}

/* The body is all that is not outside; its neighbours outside are the ends. */
static bvx_status find_body(hull_job *job)
{
    bvxi_repair_job *const r = &job->repair;
    bvx_grid *const grid[4] = {&r->solid, &job->outside, &job->ends, &job->sheets};

    for (int i = 0; i < 4; i++) BVXI_TRY(open_hull_grid(job, grid[i]));
    uint64_t words = bvxi_grid_words(&r->solid);
    r->grid_bytes = words * 8;
    BVXI_TRY(BVXI_SHARE(r->ctx, 0.0, 0.95,
                        BVXI_SCOPE(r->ctx, bvxi_outside(r->ctx, hull_name, &r->mesh, job->options->close_gaps,
                                                        &job->outside, &job->sheets))));
    BVXI_TRY(bvx_grid_complement(r->ctx, &job->outside, &r->solid));
    BVXI_TRY(BVXI_SHARE(r->ctx, 0.95, 1.0, bvxi_ends_mark(r->ctx, &r->solid, NULL, &job->ends)));
    for (uint64_t i = 0; i < words; i++) job->ends.words[i] &= job->outside.words[i];
    return BVX_OK;
}

/* ---- The triangles that count ---- */

/* Where a triangle crosses the edge of a length from a centre along an axis, or -1. */
static double crossing_on_edge(const double p[3][3], const double centre[3], int axis, double length)
{
    int const u = (axis + 1) % 3, v = (axis + 2) % 3;
    double part[3], sum, place = 0;

    for (int k = 0; k < 3; k++) {
        const double *const a = p[(k + 1) % 3], *const b = p[(k + 2) % 3];
        part[k] = (a[u] - centre[u]) * (b[v] - centre[v]) - (a[v] - centre[v]) * (b[u] - centre[u]);
    }
    if (!((part[0] >= 0 && part[1] >= 0 && part[2] >= 0) || (part[0] <= 0 && part[1] <= 0 && part[2] <= 0)))
        return -1;
    sum = part[0] + part[1] + part[2];
    if (sum == 0) return -1;
    for (int k = 0; k < 3; k++) place += part[k] / sum * (p[k][axis] - centre[axis]);
    return place <= length ? place : -1;
}

/* The edge before a voxel along an axis: its ends, and the triangles that cross it. */
typedef struct hull_edge {
    const bvxi_sparse *thin;
    const bvx_attached *listed; /* by the voxels that the crossings lie in */
    int32_t voxel[2][3], axis;
    int outside[2];
    uint64_t crossings;
    double best;
    uint32_t first; /* the first triangle seen from outside, or UINT32_MAX */
} hull_edge;

/* Count its crossings; mark, unless NULL: all of its triangles are a sheet's. */
static void walk_edge(const hull_job *job, hull_edge *e, uint8_t *mark)
{
    const bvx_lattice *const l = &job->repair.lattice;
    double const length = l->spacing[e->axis];
    uint64_t next[2] = {0, 0}, last[2] = {0, 0};
    double centre[3], p[3][3];

    for (int a = 0; a < 3; a++) centre[a] = l->origin[a] + ((double)e->voxel[0][a] + 0.5) * l->spacing[a];
    for (int end = 0; end < 2; end++) {
        const int32_t *const v = e->voxel[end];

        if (!bvx_grid_get(&e->thin->where, v[0], v[1], v[2])) continue;
        uint64_t n = bvxi_sparse_index(e->thin, v[0], v[1], v[2]);
        next[end] = e->listed->offsets[n];
        last[end] = e->listed->offsets[n + 1];
    }
    while (next[0] < last[0] || next[1] < last[1]) {
        uint32_t const of[2] = {next[0] < last[0] ? e->listed->triangles[next[0]] : UINT32_MAX,
                                next[1] < last[1] ? e->listed->triangles[next[1]] : UINT32_MAX};
        uint32_t const t = of[0] < of[1] ? of[0] : of[1];

        /* Both voxels may list a triangle, in the same order. */
        next[0] += of[0] == t;
        next[1] += of[1] == t;
        bvxi_view_corners(&job->repair.mesh, t, p);
        double place = crossing_on_edge((const double(*)[3])p, centre, e->axis, length);
        if (place < 0) continue;
        if (mark != NULL) mark[t] |= HULL_SHEET;
        if (!e->outside[0]) place = length - place;
        e->crossings++;
        if (place >= e->best) continue;
        e->best = place;
        e->first = t;
    }
}

/* Mark the triangles of an edge: the first one seen from outside is the body's. With both ends outside all are a
 * sheet's, but for where the edge only clips the body's surface: it leaves it again, beside the body. */
static void mark_edge(const hull_job *job, hull_edge *e, uint8_t *mark)
{
    int beside = 0;

    e->best = HUGE_VAL;
    e->first = UINT32_MAX;
    e->crossings = 0;
    for (int end = 0; end < 2; end++) {
        const int32_t *const v = e->voxel[end];
        e->outside[end] = bvx_grid_get(&job->outside, v[0], v[1], v[2]);
        beside |= bvx_grid_get(&job->ends, v[0], v[1], v[2]);
    }
    walk_edge(job, e, NULL);
    if (e->first == UINT32_MAX) return;
    if (e->outside[0] != e->outside[1]) mark[e->first] |= HULL_BODY;
    else if (job->options->shell != 0.0 && (e->crossings % 2 == 1 || !beside)) walk_edge(job, e, mark);
}

/* All edges with an end outside beside the body or a sheet. */
static void mark_triangles(const hull_job *job, const bvxi_sparse *thin, const bvx_attached *listed,
                           uint8_t *mark)
{
    const bvx_grid *const g = &job->outside;
    uint64_t const ny = (uint64_t)g->size[1];
    hull_edge e = {.thin = thin, .listed = listed};

    for (uint64_t row = 0; row < bvxi_grid_rows(g); row++)
        for (int32_t k = 0; k < g->words_per_row; k++) {
            uint64_t const at = row * (uint64_t)g->words_per_row + (uint64_t)k;

            for (uint64_t bits = job->ends.words[at] | job->sheets.words[at]; bits != 0; bits &= bits - 1) {
                int32_t const v[3] = {k * BVXI_WORD_BITS + bvxi_lowest(bits), (int32_t)(row % ny),
                                      (int32_t)(row / ny)};

                for (int way = 0; way < 6; way++) {
                    e.axis = way >> 1;
                    for (int end = 0; end < 2; end++) memcpy(e.voxel[end], v, sizeof v);
                    if ((way & 1) == 0 && e.voxel[0][e.axis]-- > 0) mark_edge(job, &e, mark);
                    if ((way & 1) == 1 && ++e.voxel[1][e.axis] < g->size[e.axis]) mark_edge(job, &e, mark);
                }
            }
        }
}

/* The triangles with a mark, in their order. */
static bvx_status list_marked(hull_job *job, const uint8_t *mark, int kind, bvx_mesh_view *view)
{
    bvxi_repair_job *const r = &job->repair;
    uint64_t count = 0, n = 0;
    uint32_t *corner;

    for (uint64_t t = 0; t < r->mesh.triangle_count; t++) count += (mark[t] & kind) != 0;
    BVXI_TRY(BVXI_ARRAY(r->ctx, 3 * count, "the triangles of the hull", corner));
    for (uint64_t t = 0; t < r->mesh.triangle_count; t++)
        if ((mark[t] & kind) != 0) bvxi_view_triangle(&r->mesh, t, corner + 3 * n++);
    bvxi_repair_view(r, corner, count, view);
    return BVX_OK;
}

static bvx_status list_outer(hull_job *job, bvx_attached *listed)
{
    bvxi_repair_job *const r = &job->repair;
    bvx_surface_options const o = {.struct_size = sizeof o, .mode = BVX_SURFACE_THIN, .attached = listed};
    bvx_grid thin;
    uint8_t *mark, *at;

    BVXI_TRY(open_hull_grid(job, &thin));
    BVXI_TRY(BVXI_SHARE(r->ctx, 0.0, 0.8, bvx_voxelize_surface(r->ctx, &r->mesh, &r->lattice, &o, &thin)));
    bvxi_sparse s = {.where = thin};
    BVXI_TRY(bvxi_sparse_rank(r->ctx, &s));
    BVXI_TRY(BVXI_ZEROS(r->ctx, r->mesh.triangle_count, "what triangles are for", mark));
    BVXI_TRY(BVXI_ZEROS(r->ctx, r->mesh.vertex_count, "what vertices are for", at));
    mark_triangles(job, &s, listed, mark);

    /* Small triangles pass between all edges: those between marked ones are marked too. */
    uint32_t v[3];

    for (uint64_t t = 0; t < r->mesh.triangle_count; t++) {
        if (mark[t] == 0) continue;
        bvxi_view_triangle(&r->mesh, t, v);
        for (int k = 0; k < 3; k++) at[v[k]] |= mark[t];
    }
    for (uint64_t t = 0; t < r->mesh.triangle_count; t++) {
        bvxi_view_triangle(&r->mesh, t, v);
        mark[t] |= at[v[0]] & at[v[1]] & at[v[2]];
    }
    bvxi_drop(r->ctx, at);
    BVXI_TRY(list_marked(job, mark, HULL_BODY, &r->body));
    BVXI_TRY(list_marked(job, mark, HULL_SHEET, &r->sheets));
    bvxi_drop(r->ctx, mark);
    return BVX_OK;
}

static bvx_status find_outer(hull_job *job)
{
    bvx_attached listed = {0};
    bvx_status const status = list_outer(job, &listed);
    bvx_attached_free(job->repair.ctx, &listed);
    return status;
}

/* ---- The surface ---- */

static bvx_status join_shells(hull_job *job)
{
    bvxi_repair_job *const r = &job->repair;
    uint64_t voxels;

    BVXI_TRY(open_hull_grid(job, &r->inside));
    memcpy(r->inside.words, r->solid.words, (size_t)r->grid_bytes);
    if (r->sheets.triangle_count != 0) BVXI_TRY(BVXI_SCOPE(r->ctx, bvxi_repair_lay_shells(r)));
    BVXI_TRY(bvxi_repair_clean(r));
    BVXI_TRY(bvx_grid_count(r->ctx, &r->inside, &voxels));
    if (voxels != 0) return BVX_OK;
    return bvxi_fail(r->ctx, BVX_ERR_EMPTY, "%s: nothing remains at %d x %d x %d voxels: %s", hull_name,
                     (int64_t)r->lattice.dims[0], (int64_t)r->lattice.dims[1], (int64_t)r->lattice.dims[2],
                     r->report.parts_dropped != 0 ? "every part is below least_part"
                                                  : "the mesh encloses no centre; allow shells");
}

static bvx_status measure_hull(hull_job *job, bvx_mesh *surface)
{
    bvxi_repair_job *const r = &job->repair;

    BVXI_TRY(BVXI_SHARE(r->ctx, 0.0, 0.02, bvxi_repair_lattice(r, job->options->fit.resolution)));
    BVXI_TRY(BVXI_SHARE(r->ctx, 0.02, 0.3, find_body(job)));
    BVXI_TRY(BVXI_SHARE(r->ctx, 0.3, 0.6, find_outer(job)));
    BVXI_TRY(BVXI_SHARE(r->ctx, 0.6, 0.7, join_shells(job)));
    r->report.sharp = job->options->placing.sharp == BVX_SHARP_ALWAYS;
    if (job->options->placing.sharp == BVX_SHARP_AUTO)
        BVXI_TRY(BVXI_SHARE(r->ctx, 0.7, 0.75,
                            BVXI_SCOPE(r->ctx, bvxi_sharp_edges(r->ctx, &r->mesh, NULL, &r->report.sharp))));
    BVXI_TRY(BVXI_SHARE(r->ctx, 0.75, 1.0, BVXI_SCOPE(r->ctx, bvxi_repair_surface(r, surface))));

    job->report.lattice = r->lattice;
    job->report.triangles = surface->triangle_count;
    job->report.outer_triangles = r->body.triangle_count;
    job->report.shelled_triangles = r->sheets.triangle_count;
    job->report.lids = r->facts.sheet_edges;
    job->report.parts_dropped = r->report.parts_dropped;
    return BVX_OK;
}

/* Of what can be reached from outside, or around all of the mesh. */
static bvx_status simplify_hull(hull_job *job, bvx_mesh *surface, bvxi_enclosed *enclosed,
                                bvxi_level_chain *chain)
{
    bvx_context *const ctx = job->repair.ctx;
    const bvx_mesh_view *const mesh = &job->repair.mesh;
    double const farthest = enclosed->farthest;
    bvx_mesh_view view;

    if (farthest > 0) {
        BVXI_TRY(BVXI_SHARE(
            ctx, 0.0, 0.4,
            BVXI_SCOPE(ctx, bvxi_enclose(ctx, hull_name, mesh, farthest, &job->report.lattice, surface))));
        BVXI_TRY(BVXI_SHARE(ctx, 0.4, 0.5, bvxi_enclosed_open(ctx, hull_name, mesh, farthest, enclosed)));
        job->report.triangles = surface->triangle_count;
        job->report.outer_triangles = mesh->triangle_count;
        chain->collapse.enclosed = enclosed;
    } else BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.7, measure_hull(job, surface)));

    /* Errors are measured against the surface, as the mesh has inner walls. */
    bvx_mesh_view_of(surface, &view);
    chain->original = &view;
    chain->collapse.given.position_type = surface->position_type;
    chain->collapse.simple = 1;
    /* Without targets the first level is the surface, and each one after it has half the triangles. */
    chain->halve_from = 2 * view.triangle_count;
    BVXI_TRY(BVXI_SHARE(ctx, farthest > 0 ? 0.5 : 0.7, 1.0, bvxi_levels_make(ctx, chain, &view, NULL)));
    for (uint64_t i = 0; i < chain->count; i++)
        memcpy(chain->levels[i].frame, surface->frame, sizeof surface->frame);
    return BVX_OK;
}

static bvx_status make_hull_levels(hull_job *job, bvxi_level_chain *chain)
{
    bvxi_enclosed enclosed = {.farthest = job->options->enclose};
    bvx_mesh surface = {0};
    bvx_status const status = simplify_hull(job, &surface, &enclosed, chain);
    bvxi_closest_shut(job->repair.ctx, &enclosed.closest);
    bvx_mesh_free(job->repair.ctx, &surface);
    return status;
}

/* ---- The call ---- */

static void warn_of_hull(hull_job *job, const bvxi_level_chain *chain)
{
    bvxi_repair_job *const r = &job->repair;
    bvx_certificate from = {0};

    if (r->sheets.triangle_count != 0)
        BVXI_WARN(r->ctx, BVX_WARN_SHELLS, (double)r->sheets.triangle_count, bvxi_view_area(&r->sheets),
                  bvxi_view_area(&r->mesh));
    bvxi_levels_warn(r->ctx, chain, &from, NULL);
    job->report.warnings = bvxi_warned(r->ctx);
}

static bvx_status run_hull(bvx_context *context, const bvx_mesh_view *mesh, const bvx_hull_options *options,
                           uint64_t level_count, bvx_mesh *levels)
{
    bvx_collapse const collapse = {0};
    bvxi_level_chain chain = {.function = hull_name, .count = level_count, .levels = levels};
    hull_job job = {.report = {.lids = 0}};
    bvx_hull_options o;
    double low[3], high[3];

    if (levels == NULL) return bvxi_fail_null(context, hull_name, "levels");
    BVXI_TRY(bvxi_take_options(context, hull_name, options, &o, sizeof o));
    BVXI_TRY(bvxi_check_options(context, hull_name, &o, BVXI_OPTIONS(hull_rows)));
    if (o.enclose > 0 && (o.fit.lattice != NULL || o.fit.resolution != 0 || o.close_gaps != 0 ||
                          o.parts.least_part != 0 || o.parts.keep_largest != 0))
        return bvxi_fail_for(
            context, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
            "%s: fit, parts and close_gaps exclude enclose, which follows from the mesh alone", hull_name);
    BVXI_TRY(bvxi_check_fit(context, hull_name, &o.fit));
    BVXI_TRY(bvxi_view_check(context, hull_name, mesh));
    for (uint64_t i = 0; i < level_count; i++)
        BVXI_TRY(bvxi_view_apart(context, hull_name, mesh, &levels[i]));
    bvxi_chain_take(&chain, mesh, &o.targets, &collapse);
    chain.reports = o.reports;
    BVXI_TRY(bvxi_levels_check(context, &chain));
    if (mesh->triangle_count == 0)
        return bvxi_fail(context, BVX_ERR_EMPTY, "%s: the mesh has no triangles", hull_name);
    BVXI_TRY(bvxi_view_bounds(context, hull_name, mesh, low, high));

    job.options = &o;
    job.as_repair.shell = o.shell;
    job.as_repair.placing = o.placing;
    job.as_repair.fit = o.fit;
    /* No cavity can be seen, and what is small was reached from outside. */
    job.as_repair.parts = o.parts;
    job.as_repair.parts.least_cavity = UINT64_MAX;
    job.as_repair.parts.keep_crumbs = 1;
    job.repair.ctx = context;
    job.repair.options = &job.as_repair;
    job.repair.given = mesh;
    job.repair.mesh = *mesh;
    job.repair.fill = BVX_FILL_PARITY; /* lids over openings are cut in the middle */
    bvx_status status = make_hull_levels(&job, &chain);
    if (status != BVX_OK) bvxi_levels_drop(context, levels, level_count);
    if (status != BVX_OK || o.report == NULL) return status;
    warn_of_hull(&job, &chain);
    *o.report = job.report;
    return BVX_OK;
}

bvx_status bvx_hull(bvx_context *context, const bvx_mesh_view *mesh, const bvx_hull_options *options,
                    uint64_t level_count, bvx_mesh *levels)
{
    return BVXI_CALL(context, run_hull(context, mesh, options, level_count, levels));
}
