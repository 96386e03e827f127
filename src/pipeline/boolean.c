/* boolean.c - union, intersection, difference and xor of two meshes: bvx_boolean. The lattice first, then
 * two solids, a word operation, and a surface whose vertices lie on the mesh that bounds the result there.
 *
 * Guarantee: closed, manifold and free of crossings, whatever the meshes are (surface/field_surface.c). */
#include "mesh/mesh.h"
#include "mesh/topology.h"
#include "mesh/view.h"
#include "fill/fills.h"
#include "pipeline/steps.h"
#include "pipeline/thicken.h"
#include "surface/field_surface.h"
#include "lattice/lattice.h"

#include <math.h>

/* ---- The lattice ---- */

/* Where an operation on two bodies needs voxels, and how many it needs.
 *
 * A half-space that cuts a part is a box a hundred times as large; a lattice around both would leave a few
 * voxels to the part. What is left of a difference lies within a, of an intersection within both boxes: only
 * there the lattice has to be. */

typedef struct body_box {
    double low[3], high[3];
} body_box;

/* Of the part of a box that lies on the lattice: its longest and its shortest side, 0 when there is none.
 * [Units: voxels] */
typedef struct box_sides {
    double longest, shortest;
    int32_t whole; /* 1: all of the box lies on the lattice */
} box_sides;

/* Seen in fewer voxels than FEW along its longest side a body is coarse: WANTED would show it. */
enum { BOOLEAN_FEW = 6, BOOLEAN_WANTED = 64 };

/* What both boxes are in, or what they have in common. Boxes that have no space in common leave nothing; the first one
 * is then as good as any. */
static body_box box_of_both(const body_box box[2], int common)
{
    body_box r = box[0];

    for (int a = 0; a < 3; a++) {
        if ((box[1].low[a] < r.low[a]) != common) r.low[a] = box[1].low[a];
        if ((box[1].high[a] > r.high[a]) != common) r.high[a] = box[1].high[a];
        if (common && !(r.low[a] < r.high[a])) return box[0];
    }
    return r;
}

bvx_status bvxi_check_fit(bvx_context *ctx, const char *function, bvx_fit *fit)
{
    if (fit->lattice != NULL) return bvxi_lattice_check(ctx, function, fit->lattice);
    if (fit->resolution == 0) fit->resolution = 256;
    if (fit->resolution >= 1 && fit->resolution <= 1 << 24) return BVX_OK;
    return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                         "%s: fit.resolution is %d; 1 to 2^24 are possible", function,
                         (int64_t)fit->resolution);
}

/* Around what can be left: of a difference the box of a, of an intersection what both have in common, else both. An
 * empty voxel on every side. Boxes that stick out take fraction bits, down to 4. */
static bvx_status fit_boolean(bvx_context *ctx, int32_t operation, int32_t resolution, const body_box box[2],
                              bvx_lattice *lattice)
{
    body_box const fit = operation == BVX_BOOLEAN_DIFFERENCE
                             ? box[0]
                             : box_of_both(box, operation == BVX_BOOLEAN_INTERSECTION);
    /* A layer around, so that the surface closes within the lattice. */
    bvx_lattice_options const o = {.struct_size = sizeof o, .resolution = resolution, .padding = 1};
    bvx_mesh_view const corners = {.positions = &fit, .vertex_count = 2, .position_type = BVX_F64};

    BVXI_TRY(bvx_lattice_fit_with(ctx, &corners, &o, lattice));

    /* Farther vertices need fewer fraction bits for their places to fit 2^30. */
    double farthest = 0.0;

    for (int i = 0; i < 2; i++)
        for (int a = 0; a < 3; a++) {
            /* How far the farther ends of both boxes lie, in voxels. */
            double const below = (lattice->origin[a] - box[i].low[a]) / lattice->spacing[a];
            double const above = (box[i].high[a] - lattice->origin[a]) / lattice->spacing[a];
            farthest = below > farthest ? below : farthest;
            farthest = above > farthest ? above : farthest;
        }
    while (lattice->fraction_bits > BVXI_MIN_FRACTION &&
           farthest * (double)((int64_t)1 << lattice->fraction_bits) > 0.5 * BVXI_FIXED_LIMIT)
        lattice->fraction_bits--;
    return BVX_OK;
}

static box_sides sides_on_lattice(const body_box *box, const bvx_lattice *lattice)
{
    static box_sides const none = {0.0, 0.0, 0};
    box_sides r = {0.0, 1e300, 1};

    for (int a = 0; a < 3; a++) {
        double const h = lattice->spacing[a], far_end = lattice->origin[a] + lattice->dims[a] * h;
        double const low = box->low[a] > lattice->origin[a] ? box->low[a] : lattice->origin[a];
        double const high = box->high[a] < far_end ? box->high[a] : far_end, n = (high - low) / h;

        /* Beside the lattice: nothing of the body is there. */
        if (n < 0.0) return none;
        r.whole &= low == box->low[a] && high == box->high[a];
        r.longest = n > r.longest ? n : r.longest;
        r.shortest = n < r.shortest ? n : r.shortest;
    }
    return r;
}

/* The resolution that makes `wanted` of so many voxels, at most 2^24. */
static int32_t advise_resolution(const bvx_lattice *lattice, double voxels, double wanted)
{
    int32_t longest = 1;

    /* The padding's voxels hold nothing. */
    for (int a = 0; a < 3; a++) longest = lattice->dims[a] - 2 > longest ? lattice->dims[a] - 2 : longest;
    double const n = voxels > 0.0 ? longest * (wanted / voxels) : 1e300;
    return n < (double)(1 << 24) ? (int32_t)-floor(-n) : 1 << 24;
}

/* ---- The operation ---- */

/* Union, intersection, difference and xor of two meshes: bvx_boolean.
 *
 * Two exact solids on one lattice, a word operation, marching cubes. A crossed edge of the result is crossed
 * by a, by b or by both, and only the ends of edges that a body crosses are measured to it: its own surface,
 * nowhere mixed with the other's. Where both cross, a union has the outer of the two cuts, the others the
 * inner one (of xor no edge is crossed by both). Walls of a body that the lattice loses are widened in its
 * solid (thicken.c) and put back to its mesh in the result (flatten.c). */

static const char boolean_name[] = "bvx_boolean";

/* One of the meshes: its solid, and what is measured at the ends of the result's edges that it crosses. */
typedef struct boolean_body {
    const bvx_mesh_view *mesh;
    bvx_solid_report *report;
    bvxi_near_cells cells;
    bvx_grid solid;
    bvxi_thin thin;
    bvxi_sparse values; /* in doubles; triangles where edges are sharp */
    bvxi_lids lids;
} boolean_body;

typedef struct boolean_job {
    bvx_context *ctx;
    const bvx_boolean_options *options;
    int32_t operation;
    bvx_lattice lattice;
    boolean_body body[2];
    body_box box[2];
    bvxi_crumb_source source[2]; /* pieces once they are known */
    bvx_grid inside;
    uint64_t grid_bytes;
    bvx_boolean_report report;
    uint64_t between; /* edges that both bodies cross and the result does not */
    uint64_t holes;   /* of both meshes */
    bvxi_rim longest_rim;
} boolean_job;

/* ---- Checks ---- */

static const bvxi_option boolean_rows[] = {
    BVXI_AMONG(bvx_boolean_options, fill, BVX_FILLS_OF_BOOLEAN),
    BVXI_RESERVED(bvx_boolean_options, fit.reserved),
    BVXI_PLACING(bvx_boolean_options),
    BVXI_PARTS(bvx_boolean_options),
    BVXI_COUNT(bvx_boolean_options, parts.least_cavity, 0, 0),
    BVXI_CHOICE(bvx_boolean_options, thin, BVX_THIN_KEEP, BVX_THIN_DROP),
};

/* ---- Lattice and solids ---- */

static const char *const boolean_mesh[2] = {"bvx_boolean, mesh a", "bvx_boolean, mesh b"};

static bvx_status open_boolean_grid(boolean_job *job, const char *what, bvx_grid *grid)
{
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->grid_bytes, what, &grid->words));
    grid->word_capacity = job->grid_bytes / 8;
    return bvx_grid_create(job->ctx, &job->lattice, NULL, grid);
}

/* A body, or the result, of few voxels: which, and what would show it. */
static void advise_boolean(boolean_job *job, int32_t what, double voxels, double wanted)
{
    /* The finest advice counts: it shows all that was too small. */
    int32_t const advised = advise_resolution(&job->lattice, voxels, wanted);

    job->report.few |= what;
    if (advised > job->report.advised_resolution) job->report.advised_resolution = advised;
}

/* ---- Thin walls ---- */

/* Walls of a body that its solid has lost: told, and by BVX_THIN_KEEP put back into the solid. */
static bvx_status keep_thin_walls(boolean_job *job, int32_t i)
{
    boolean_body *const b = &job->body[i];
    bvx_solid_report *const r = b->report;
    int const keep = job->options->thin == BVX_THIN_KEEP;
    bvxi_walls walls;

    /* The walls' search goes by the mesh and the solid as they are. */
    bvxi_walls_of_solid(job->ctx, boolean_name, b->mesh, &b->solid, r, &walls);
    walls.parts = keep;
    walls.cells = &b->cells;
    walls.unsummed = job->options->report == NULL;
    BVXI_TRY(bvxi_walls_open(&walls));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.5, 0.7, bvxi_walls_gather(&walls)));
    if (walls.count != 0) BVXI_TRY(BVXI_SHARE(job->ctx, 0.7, 0.8, bvxi_walls_ask(&walls, 1.0)));
    bvxi_tell_walls(&walls, r);
    if (r->thin_voxels != 0 && keep) {
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.8, 1.0, bvxi_thicken(&walls, &b->solid, &b->thin)));
        job->report.thin_kept |= i == 0 ? BVX_KEPT_A : BVX_KEPT_B;
    }
    bvxi_walls_close(&walls);
    return BVX_OK;
}

/* A body without a voxel: as many as show its thin walls, and the thinnest
 * side of its box in any case; 0 where it encloses nothing. */
static int32_t resolution_of_lost_body(const boolean_job *job, int32_t i, double shortest)
{
    const bvx_solid_report *const r = job->body[i].report;
    int32_t const of_box = advise_resolution(&job->lattice, shortest, 2.0);

    /* Walls were found, but no resolution holds them. */
    if (r->thin_voxels != 0 && r->thin_resolution == 0) return 0;
    return r->thin_resolution > of_box ? r->thin_resolution : of_box;
}

/* A body that lies on the lattice and has none of its voxels is lost, and so would be what is requested. */
static bvx_status judge_body(boolean_job *job, int32_t i, uint64_t voxels)
{
    box_sides const sides = sides_on_lattice(&job->box[i], &job->lattice);
    const bvx_solid_report *const r = job->body[i].report;
    const int32_t *const n = job->lattice.dims;

    if (voxels == 0 && sides.whole) {
        int32_t advised;

        /* they were not requested; what would show them is */
        if (!r->thin_checked) BVXI_TRY(keep_thin_walls(job, i));
        advised = resolution_of_lost_body(job, i, sides.shortest);
        if (bvxi_advised(advised) == 0.0)
            return bvxi_fail(
                job->ctx, BVX_ERR_EMPTY,
                "%s: none of %d x %d x %d voxels has its centre inside: the body is thinner than they are "
                "at any resolution of up to 4096, or encloses nothing; repair it first",
                boolean_mesh[i], (int64_t)n[0], (int64_t)n[1], (int64_t)n[2]);
        return bvxi_fail(
            job->ctx, BVX_ERR_EMPTY,
            "%s: none of %d x %d x %d voxels has its centre inside: the body is thinner than they are, or "
            "encloses nothing; "
            "take a resolution of %d or more, or repair it first",
            boolean_mesh[i], (int64_t)n[0], (int64_t)n[1], (int64_t)n[2], (int64_t)advised);
    }

    if (voxels == 0 && sides.longest > 0.0) {
        int32_t const advised = resolution_of_lost_body(job, i, sides.shortest);

        /* A body that lies on the lattice in part only: few voxels of it are no error. */
        advise_boolean(job, i == 0 ? BVX_FEW_A : BVX_FEW_B, sides.shortest, 2.0);
        if (advised > job->report.advised_resolution) job->report.advised_resolution = advised;
    } else if (sides.longest > 0.0 && sides.longest < BOOLEAN_FEW) {
        advise_boolean(job, i == 0 ? BVX_FEW_A : BVX_FEW_B, sides.longest, BOOLEAN_WANTED);
    }
    return BVX_OK;
}

static bvx_status judge_result(boolean_job *job)
{
    int32_t longest = 0;
    bvx_window box;

    /* An empty intersection is an answer, not an error. */
    if (job->report.voxels == 0) return BVX_OK;
    bvxi_grid_content(&job->inside, &box);
    for (int a = 0; a < 3; a++) longest = box.size[a] > longest ? box.size[a] : longest;
    if (longest < BOOLEAN_FEW) advise_boolean(job, BVX_FEW_RESULT, longest, BOOLEAN_WANTED);
    return BVX_OK;
}

static bvx_status fill_body(boolean_job *job, int32_t i)
{
    boolean_body *const b = &job->body[i];
    bvx_voxelize_options o = {.struct_size = sizeof o,
                              .fill = job->options->fill,
                              .check_thin = BVX_CHECK_NEVER,
                              .report = b->report};

    /* The exact solid first: walls are what it has lost. */
    BVXI_TRY(
        BVXI_SHARE(job->ctx, 0.0, 0.5, bvx_voxelize_solid(job->ctx, b->mesh, &job->lattice, &o, &b->solid)));

    if (job->options->thin != BVX_THIN_KEEP && job->options->report == NULL) return BVX_OK;
    return keep_thin_walls(job, i);
}

static bvx_status fill_boolean(boolean_job *job)
{
    bvx_grid *const a = &job->body[0].solid, *const b = &job->body[1].solid;

    for (int32_t i = 0; i < 2; i++)
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.45 * i, 0.45 * (i + 1), fill_body(job, i)));

    /* Both solids are kept: the surface needs to know which body changes its side on each edge. */
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.9, 0.95, bvx_grid_combine(job->ctx, a, b, job->operation, &job->inside)));
    BVXI_TRY(bvx_grid_count(job->ctx, a, &job->report.voxels_a));
    BVXI_TRY(bvx_grid_count(job->ctx, b, &job->report.voxels_b));
    BVXI_TRY(bvx_grid_count(job->ctx, &job->inside, &job->report.voxels));

    if (job->options->report != NULL) {
        /* Edges between centres that both bodies cross and the result does not: there a wall or a gap between
         * the bodies may be lost, of a voxel at most. */
        const bvx_grid *const g = &job->inside;
        const uint64_t *const in[3] = {job->body[0].solid.words, job->body[1].solid.words, g->words};
        uint64_t const row = (uint64_t)g->words_per_row, slice = row * (uint64_t)g->size[1];
        uint64_t const words = bvxi_grid_words(g);
        uint64_t count = 0;

        for (uint64_t i = 0; i < words; i++) {
            uint64_t x[3], y[3], z[3];

            for (int k = 0; k < 3; k++) {
                uint64_t const w = in[k][i];
                /* The last bit of a row stands beside none; beyond the last row and slice there is nothing. */
                x[k] = w ^ (w >> 1 | ((i + 1) % row != 0 ? in[k][i + 1] << 63 : 0));
                y[k] = i % slice + row < slice ? w ^ in[k][i + row] : 0;
                z[k] = i + slice < words ? w ^ in[k][i + slice] : 0;
            }
            count += bvxi_popcount(x[0] & x[1] & ~x[2]) + bvxi_popcount(y[0] & y[1] & ~y[2]) +
                     bvxi_popcount(z[0] & z[1] & ~z[2]);
        }
        job->between = count;
    }

    /* After the counts, so that a body that was lost is named before an empty result could be taken for an
     * answer. */
    BVXI_TRY(judge_body(job, 0, job->report.voxels_a));
    BVXI_TRY(judge_body(job, 1, job->report.voxels_b));
    return BVXI_SHARE(job->ctx, 0.95, 1.0, judge_result(job));
}

/* ---- Small parts ---- */

/* By crumbs and by size. */
static bvx_status drop_boolean_parts(boolean_job *job)
{
    const bvx_boolean_options *const o = job->options;

    if (job->report.voxels == 0) return BVX_OK;
    /* Crumbs first: they are sorted out by shape, parts by size alone. */
    if (!o->parts.keep_crumbs) {
        for (int32_t i = 0; i < 2; i++)
            BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, job->source[i].mesh->vertex_count * 4,
                                "a mesh's pieces", &job->source[i].piece));

        /* Parts first, then pockets: a crumb that goes may have had a pocket of its own. */
        for (int32_t empty = 0; empty < 2; empty++) {
            uint64_t crumbs = 0;
            BVXI_TRY(BVXI_SHARE(job->ctx, 0.5 * empty, 0.5 + 0.5 * empty,
                                BVXI_SCOPE(job->ctx, bvxi_drop_crumbs(job->ctx, boolean_name, &job->inside,
                                                                      empty, job->source, 2, &crumbs))));
            job->report.crumbs += crumbs;
        }
    }
    BVXI_TRY(bvxi_keep_large_parts(job->ctx, &o->parts, &job->inside, &job->report.parts_dropped));
    return bvx_grid_count(job->ctx, &job->inside, &job->report.voxels);
}

/* ---- Closest points ---- */

/* How far from a centre its body is looked for among nearby triangles at first [Units: largest spacings] */
#define BOOLEAN_REACH 2.0

/* Among the triangles near what is measured, where they are few: what lies within reach of a centre is nearer than all
 * that is not among them. *all becomes 1 where that holds for each centre. */
static bvx_status measure_nearby(boolean_job *job, boolean_body *b, int *all)
{
    double const reach = BOOLEAN_REACH * bvxi_largest_spacing(&job->lattice);
    const double *const distances = b->values.distances;
    bvx_mesh_view near;
    uint32_t *corner;
    bvx_status status = BVX_OK;

    *all = 0;
    BVXI_TRY(bvxi_triangles_near(job->ctx, b->mesh, &b->cells, &b->values.where, reach, 0, &near, &corner));
    bvxi_near_cells_close(job->ctx, &b->cells);
    if (near.triangle_count != 0 && near.triangle_count <= b->mesh->triangle_count / 2) {
        *all = 1;
        status = bvxi_measure_ends(job->ctx, boolean_name, &near, 0, &b->values);
        for (uint64_t i = 0; i < b->values.count && status == BVX_OK; i++) *all &= distances[i] <= reach;
    }
    bvxi_drop(job->ctx, corner);
    if (status != BVX_ERR_EMPTY) return status;
    *all = 0; /* none of them has an area */
    return BVX_OK;
}

static bvx_status measure_body(boolean_job *job, boolean_body *b)
{
    bvx_context *const ctx = job->ctx;
    uint32_t const triangles = job->report.sharp ? BVXI_TRIANGLES : 0;
    /* Only a part of the body bounds the result. Indices of triangles are those of the whole mesh. */
    int const partly = triangles == 0 && (job->operation == BVX_BOOLEAN_INTERSECTION ||
                                          (job->operation == BVX_BOOLEAN_DIFFERENCE && b == &job->body[1]));
    int measured = 0;

    /* Only ends of edges on which the result and this body both change: all other centres would be measured
     * for nothing. */
    BVXI_TRY(bvxi_sparse_open(ctx, &job->inside, &b->values));
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.05, bvxi_ends_mark(ctx, &job->inside, &b->solid, &b->values.where)));
    BVXI_TRY(bvxi_sparse_rank(ctx, &b->values));
    BVXI_TRY(bvxi_sparse_columns(ctx, &b->values, BVX_F64, BVXI_VECTORS | BVXI_DISTANCES | triangles));

    /* A body that does not bound the result anywhere needs no search tree. */
    if (b->values.count == 0) return BVX_OK;
    if (partly) BVXI_TRY(BVXI_SHARE(ctx, 0.05, 0.5, measure_nearby(job, b, &measured)));
    else bvxi_near_cells_close(ctx, &b->cells);
    if (!measured)
        BVXI_TRY(BVXI_SHARE(ctx, partly ? 0.5 : 0.05, 1.0,
                            bvxi_measure_ends(ctx, boolean_name, b->mesh, 0, &b->values)));
    bvxi_thin_values(&b->thin, &b->values);
    return BVX_OK;
}

/* ---- The surface ---- */

static bvx_status extract_boolean(boolean_job *job, bvx_mesh *result)
{
    bvxi_holes holes[2];
    bvx_field_surface_options o = {
        .placing = job->options->placing, .sharp_angle = BVXI_SHARP_ANGLE, .report = &job->report.surface};
    bvxi_cut_rule rule[2] = {{.values = NULL}};

    o.placing.sharp = job->report.sharp ? BVX_SHARP_ALWAYS : BVX_SHARP_NEVER;
    for (int32_t i = 0; i < 2; i++) {
        boolean_body *const b = &job->body[i];
        int32_t const fill = b->report->fill;
        bvxi_winding *winding;

        rule[i].values = &b->values;
        rule[i].mesh = b->mesh;
        rule[i].inside = &b->solid;
        rule[i].missing_user = &b->lids;
        b->lids.lattice = &job->lattice;
        if ((fill != BVX_FILL_WINDING && fill != BVX_FILL_VOTE) || b->report->turned != 0) continue;
        BVXI_TRY(bvxi_holes_open_rule(job->ctx, boolean_name, b->mesh, &job->lattice, fill, &holes[i]));
        BVXI_TRY(
            bvxi_winding_open(job->ctx, boolean_name, b->mesh, &job->lattice, fill, &holes[i], &winding));
        b->lids.winding = winding;
        rule[i].missing = bvxi_lid_ratios;
        bvxi_longest_rim(b->mesh, &holes[i], &job->longest_rim);
        job->holes += holes[i].loops;
    }

    /* Where both bodies cross an edge, a union takes the outer cut, the others the inner one. */
    rule[0].second = &rule[1];
    rule[0].outer = job->operation == BVX_BOOLEAN_UNION;
    return bvxi_field_surface(job->ctx, boolean_name, &job->inside, rule, &o, result);
}

/* Sharp edges: as requested, or where one of the meshes has them. */
static bvx_status choose_boolean_sharp(boolean_job *job)
{
    job->report.sharp = job->options->placing.sharp == BVX_SHARP_ALWAYS;
    for (int32_t i = 0; i < 2 && job->options->placing.sharp == BVX_SHARP_AUTO && !job->report.sharp; i++)
        BVXI_TRY(
            BVXI_SCOPE(job->ctx, bvxi_sharp_edges(job->ctx, job->body[i].mesh, NULL, &job->report.sharp)));
    return BVX_OK;
}

static bvx_status boolean_steps(boolean_job *job, bvx_mesh *result)
{
    bvxi_flat_body const bodies[BVXI_FLAT_BODIES] = {{&job->body[0].thin, &job->body[0].solid},
                                                     {&job->body[1].thin, &job->body[1].solid}};
    const bvx_fit *const fit = &job->options->fit;

    /* The meshes are checked before they are measured. */
    for (int32_t i = 0; i < 2; i++) {
        BVXI_TRY(bvxi_view_check(job->ctx, boolean_mesh[i], job->body[i].mesh));
        BVXI_TRY(bvxi_view_bounds(job->ctx, boolean_mesh[i], job->body[i].mesh, job->box[i].low,
                                  job->box[i].high));
        BVXI_TRY(bvxi_view_apart(job->ctx, boolean_mesh[i], job->body[i].mesh, result));
    }
    if (fit->lattice != NULL) job->lattice = *fit->lattice;
    else BVXI_TRY(fit_boolean(job->ctx, job->operation, fit->resolution, job->box, &job->lattice));
    job->report.lattice = job->lattice;

    uint64_t const words = bvx_grid_bound(&job->lattice, NULL);

    /* A size that no memory could hold is reported as that, before anything is taken. */
    if (words == 0 || words > SIZE_MAX / 8)
        return bvxi_fail(job->ctx, BVX_ERR_BUDGET,
                         "%s: a grid of %d x %d x %d voxels is beyond this machine's addresses", boolean_name,
                         (int64_t)job->lattice.dims[0], (int64_t)job->lattice.dims[1],
                         (int64_t)job->lattice.dims[2]);
    job->grid_bytes = words * 8;
    for (int32_t i = 0; i < 2; i++) BVXI_TRY(open_boolean_grid(job, "a mesh's solid", &job->body[i].solid));
    BVXI_TRY(open_boolean_grid(job, "the result's solid", &job->inside));
    for (int32_t i = 0; i < 2; i++) {
        BVXI_TRY(
            BVXI_SHARE(job->ctx, 0.0, 0.0,
                       bvxi_near_cells_open(job->ctx, job->body[i].mesh, &job->inside, &job->body[i].cells)));
        job->source[i].cells = &job->body[i].cells;
    }

    BVXI_TRY(BVXI_SHARE(job->ctx, 0.0, 0.5, fill_boolean(job)));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.5, 0.55, drop_boolean_parts(job)));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.55, 0.6, choose_boolean_sharp(job)));

    for (int i = 0; i < 2; i++)
        BVXI_TRY(BVXI_SHARE(job->ctx, 0.6 + 0.08 * i, 0.68 + 0.08 * i, measure_body(job, &job->body[i])));
    BVXI_TRY(BVXI_SHARE(job->ctx, 0.76, 0.86, BVXI_SCOPE(job->ctx, extract_boolean(job, result))));
    return BVXI_SHARE(
        job->ctx, 0.86, 1.0,
        BVXI_SCOPE(job->ctx, bvxi_flatten(job->ctx, boolean_name, bodies, BVXI_FLAT_BODIES, result)));
}

/* ---- Warnings ---- */

#define BOOLEAN_OFF    0.02 /* of a volume */
#define BOOLEAN_LIDDED 0.05 /* where lines of centres see it, which miss lids by half a voxel */
#define BOOLEAN_CRUMBS 3    /* from which on a wall has broken */
#define BOOLEAN_SHARED 1.25 /* the factor by which a shared volume counted in voxels may be off */

/* The volume of the result beside those of the meshes, these seen nearer where it matters. */
static bvx_status warn_of_operands_volume(boolean_job *job, double volume, double finer)
{
    bvx_boolean_report *const r = &job->report;
    bvx_solid_report *const of[2] = {&r->solid_a, &r->solid_b};
    int const count = job->operation == BVX_BOOLEAN_DIFFERENCE ? 1 : 2;
    double const off = job->holes != 0 ? BOOLEAN_LIDDED : BOOLEAN_OFF;
    double shared, wanted = 0.0;

    for (int i = 0; i < count; i++)
        if (!(bvxi_known_volume(of[i]) > 0.0)) return BVX_OK;
    if (r->few != 0 || r->parts_dropped != 0) return BVX_OK;

    /* The volume that both bodies share: the part of their voxels, of the smaller one of both volumes. */
    uint64_t const of_voxels[2] = {r->voxels_a, r->voxels_b};
    uint64_t const all = of_voxels[0] + (job->operation == BVX_BOOLEAN_DIFFERENCE ? 0 : of_voxels[1]);
    uint64_t const twice = job->operation == BVX_BOOLEAN_XOR ? 2 : 1;
    double const voxels = all > r->voxels ? (double)((all - r->voxels) / twice) : 0.0;
    double part[2] = {0.0, 1e300};

    for (int i = 0; i < 2; i++)
        if (of_voxels[i] != 0 && job->body[i].report->crossing_volume > 0.0)
            part[i] = job->body[i].report->crossing_volume * voxels / (double)of_voxels[i];
    shared = (part[0] < part[1] ? part[0] : part[1]) * (job->operation == BVX_BOOLEAN_XOR ? 2.0 : 1.0);
    for (int i = 0; i < count; i++) wanted += bvxi_known_volume(of[i]);
    for (int i = 0; i < count; i++)
        if (bvxi_known_volume(of[i]) == of[i]->crossing_volume && bvxi_solid_is_closed(of[i]))
            BVXI_TRY(bvxi_see_volume(job->ctx, boolean_name, job->body[i].mesh, &job->lattice,
                                     job->options->fill, of[i]->crossing_volume + volume + shared - wanted,
                                     &of[i]->crossing_volume));
    wanted = 0.0;
    for (int i = 0; i < count; i++) wanted += bvxi_known_volume(of[i]);
    if (volume < (1.0 - off) * (wanted - shared * BOOLEAN_SHARED) ||
        volume > (1.0 + off) * (wanted - shared / BOOLEAN_SHARED))
        BVXI_WARN(job->ctx, BVX_WARN_VOLUME, volume, wanted - shared, volume / (wanted - shared) - 1.0,
                  finer);
    return BVX_OK;
}

/* The bodies that a union of closed meshes has; 0: not known, or no more than parts. */
static bvx_status count_apart(boolean_job *job, uint64_t parts, uint64_t *bodies)
{
    const bvx_boolean_report *const r = &job->report;
    uint64_t pieces = 0;
    bvx_mesh_view both;

    *bodies = 0;
    for (int i = 0; i < 2; i++) {
        BVXI_TRY(bvxi_know_pieces(job->ctx, &job->source[i]));
        for (uint64_t v = 0; v < job->body[i].mesh->vertex_count; v++) pieces += job->source[i].piece[v] == v;
    }
    /* Two that have voxels in common are one, but for those that were put to thin walls. */
    if (parts >= pieces ||
        (pieces == 2 && r->voxels + job->body[0].thin.near.count + job->body[1].thin.near.count <
                            r->voxels_a + r->voxels_b) ||
        job->body[0].mesh->vertex_count + job->body[1].mesh->vertex_count > UINT32_MAX)
        return BVX_OK;

    /* Both meshes as one. */
    const bvx_mesh_view *const a = job->body[0].mesh, *const b = job->body[1].mesh;
    uint64_t const vertices = a->vertex_count + b->vertex_count;
    uint64_t const triangles = a->triangle_count + b->triangle_count;
    uint32_t *index;
    double *position;

    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, vertices * 24, "both meshes' places", &position));
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, triangles * 12, "both meshes' triangles", &index));
    both = (bvx_mesh_view){.positions = position,
                           .indices = index,
                           .vertex_count = vertices,
                           .triangle_count = triangles,
                           .position_type = BVX_F64,
                           .index_type = BVX_U32};
    for (uint64_t v = 0; v < vertices; v++)
        if (v < a->vertex_count) bvxi_view_position(a, v, position + 3 * v);
        else bvxi_view_position(b, v - a->vertex_count, position + 3 * v);
    for (uint64_t t = 0; t < triangles; t++) {
        uint64_t const first = t < a->triangle_count ? 0 : a->vertex_count;

        bvxi_view_triangle(first == 0 ? a : b, first == 0 ? t : t - a->triangle_count, index + 3 * t);
        for (int k = 0; k < 3; k++) index[3 * t + (uint64_t)k] += (uint32_t)first;
    }
    return bvxi_bodies_apart(job->ctx, &both, bodies);
}

/* A union has no more parts than its meshes have together, which are counted only where that is in question; and no
 * fewer than lie apart. */
static bvx_status warn_of_operands_parts(boolean_job *job, uint64_t parts, double finer)
{
    const bvx_boolean_report *const r = &job->report;
    uint64_t own = 0, apart = 0;

    if (job->operation != BVX_BOOLEAN_UNION) return BVX_OK;
    for (int i = 0; i < 2 && parts > 2; i++) {
        bvx_certificate c;

        BVXI_TRY(bvx_mesh_check(job->ctx, job->body[i].mesh, 1, &c));
        own += c.components;
    }
    if (parts > 2 && parts > own) BVXI_WARN(job->ctx, BVX_WARN_PARTS, (double)parts, (double)own, finer);
    if (r->parts_dropped != 0 || !bvxi_solid_is_closed(&r->solid_a) || !bvxi_solid_is_closed(&r->solid_b))
        return BVX_OK;
    /* Of bodies beyond the lattice pieces are missing, whatever its resolution is. */
    for (int i = 0; i < 2; i++)
        if (!sides_on_lattice(&job->box[i], &job->lattice).whole) return BVX_OK;
    BVXI_TRY(BVXI_SCOPE(job->ctx, count_apart(job, parts, &apart)));
    if (parts < apart) BVXI_WARN(job->ctx, BVX_WARN_JOINED, (double)parts, (double)apart, finer);
    return BVX_OK;
}

/* What is compared: the volume about the middle, how many parts and handles there are, and crumbs that went. */
typedef struct boolean_shape {
    double volume;
    uint64_t parts, handles, crumbs;
} boolean_shape;

/* All vertices of a result are of triangles, those of a part hang together through edges, and each edge has two
 * triangles. */
static bvx_status measure_result(boolean_job *job, const bvx_mesh *mesh, boolean_shape *shape)
{
    double low[3], high[3], centre[3];
    bvx_mesh_view result;
    uint32_t *part;

    *shape = (boolean_shape){.parts = mesh->vertex_count, .crumbs = job->report.crumbs};
    if (mesh->triangle_count == 0) return BVX_OK;
    bvx_mesh_view_of(mesh, &result);
    BVXI_TRY(bvxi_alloc(job->ctx, BVXI_SCRATCH, result.vertex_count * 4, "the result's parts", &part));
    bvxi_view_used_bounds(&result, low, high);
    for (int a = 0; a < 3; a++) centre[a] = 0.5 * low[a] + 0.5 * high[a];
    for (uint64_t v = 0; v < result.vertex_count; v++) part[v] = (uint32_t)v;
    for (uint64_t t = 0; t < result.triangle_count; t++) {
        uint32_t c[3];

        bvxi_view_triangle(&result, t, c);
        shape->parts -= (uint64_t)(bvxi_join(part, c[0], c[1]) + bvxi_join(part, c[0], c[2]));
        shape->volume += bvxi_patches_volume(&result, t, centre) / 6.0;
    }
    bvxi_drop(job->ctx, part);
    shape->handles = (2 * shape->parts + result.triangle_count / 2 - result.vertex_count) / 2;
    return BVX_OK;
}

/* ---- A finer look ---- */

#define FINER_SMALL (UINT64_C(1) << 14) /* words of a lattice that is always looked at */
#define FINER_LARGE (UINT64_C(1) << 19) /* where the volume is in question */
#define FINER_AGREE 0.005

static int is_same_shape(const boolean_shape *a, const boolean_shape *b)
{
    return a->parts == b->parts && a->handles == b->handles &&
           bvxi_absolute(a->volume - b->volume) <= FINER_AGREE * b->volume;
}

/* The same operation on a lattice of half the spacing, on which meshes are snapped as on this one; *seen becomes 0
 * where that has no result. */
static bvx_status look_closer(const boolean_job *job, bvx_lattice *lattice, boolean_shape *shape, int *seen)
{
    bvx_boolean_options o = *job->options;
    boolean_job closer = {.ctx = job->ctx, .options = &o, .operation = job->operation};
    bvx_mesh result = {0};

    for (int a = 0; a < 3; a++) {
        lattice->spacing[a] *= 0.5;
        lattice->dims[a] *= 2;
    }
    lattice->fraction_bits--;
    o.fit.lattice = lattice;
    o.report = NULL;
    for (int i = 0; i < 2; i++) closer.body[i].mesh = closer.source[i].mesh = job->body[i].mesh;
    closer.body[0].report = &closer.report.solid_a;
    closer.body[1].report = &closer.report.solid_b;
    bvx_status status = boolean_steps(&closer, &result);
    if (status == BVX_OK) status = measure_result(&closer, &result, shape);
    bvx_mesh_free(job->ctx, &result);
    *seen = status == BVX_OK;

    /* The result is there, whatever a look that nobody requested would need. */
    return status == BVX_ERR_BUDGET || status == BVX_ERR_EMPTY || status == BVX_ERR_RANGE ? BVX_OK : status;
}

/* What finer lattices have. *looks is how many there were: two, and one more for a shape that still changes; *settled
 * becomes 1 where the last two agree and no wall broke in the last. */
static bvx_status look_finer(const boolean_job *job, boolean_shape *shape, int *looks, int *settled)
{
    uint64_t const words = bvxi_grid_words(&job->inside);
    bvx_lattice lattice = job->lattice;
    int more = 1, seen = 1;

    *settled = 0;
    for (*looks = 0; more; ++*looks) {
        boolean_shape closer = *shape;

        if ((*looks != 0 && words << 3 * *looks > FINER_LARGE) || lattice.fraction_bits <= BVXI_MIN_FRACTION)
            return BVX_OK;
        for (int a = 0; a < 3; a++)
            if (lattice.dims[a] > BVXI_MAX_SIDE / 2) return BVX_OK;
        BVXI_TRY(BVXI_SCOPE(job->ctx, look_closer(job, &lattice, &closer, &seen)));
        if (!seen) return BVX_OK;
        *settled = is_same_shape(shape, &closer) && closer.crumbs < BOOLEAN_CRUMBS;
        more = !*settled && (*looks == 0 || (*looks == 1 && !is_same_shape(shape, &closer)));
        *shape = closer;
    }
    return BVX_OK;
}

/* Is the result what finer lattices have? *same becomes 1 where it is. */
static bvx_status compare_finer(boolean_job *job, const boolean_shape *shape, double finer, int *same)
{
    uint64_t const words = bvxi_grid_words(&job->inside), warned = bvxi_warned(job->ctx);
    boolean_shape seen = *shape;
    int looks, settled;

    *same = 0;
    if (job->options->parts.least_part > 1 || words > FINER_LARGE ||
        (words > FINER_SMALL && (double)job->between <= BOOLEAN_OFF * (double)job->report.voxels))
        return BVX_OK;
    BVXI_TRY(look_finer(job, &seen, &looks, &settled));
    if (looks == 0 || !(seen.volume > 0.0)) return BVX_OK;
    *same = settled && is_same_shape(shape, &seen);

    /* The last look but one was as good. */
    if (looks > 2) finer = bvxi_advised(2.0 * finer);
    if (shape->parts == 0) {
        if ((warned >> BVX_WARN_FEW_RESULT & 1) == 0) BVXI_WARN(job->ctx, BVX_WARN_FEW_RESULT, finer);
        return BVX_OK;
    }
    if (bvxi_absolute(shape->volume - seen.volume) > BOOLEAN_OFF * seen.volume &&
        (warned >> BVX_WARN_VOLUME & 1) == 0)
        BVXI_WARN(job->ctx, BVX_WARN_VOLUME, shape->volume, seen.volume, shape->volume / seen.volume - 1.0,
                  finer);

    /* Counts that change from look to look are not known. */
    if (!settled) return BVX_OK;
    if (seen.parts != shape->parts && (warned & (1 << BVX_WARN_PARTS | 1 << BVX_WARN_JOINED)) == 0)
        BVXI_WARN(job->ctx, seen.parts < shape->parts ? BVX_WARN_PARTS : BVX_WARN_JOINED,
                  (double)shape->parts, (double)seen.parts, finer);
    if (seen.handles != shape->handles)
        BVXI_WARN(job->ctx, BVX_WARN_HANDLES, (double)shape->handles, (double)seen.handles, finer);
    return BVX_OK;
}

static bvx_status warn_of_boolean(boolean_job *job, const bvx_mesh *result)
{
    bvx_boolean_report *const r = &job->report;
    const int32_t *const n = job->lattice.dims;
    double const longest = n[0] > n[1] ? (n[0] > n[2] ? n[0] : n[2]) : (n[1] > n[2] ? n[1] : n[2]);
    double const finer = bvxi_advised(2.0 * (longest - 2.0));
    boolean_shape shape;
    int same;

    for (int32_t i = 0; i < 2; i++) {
        const bvx_solid_report *const solid = job->body[i].report;

        bvxi_warn_of_fill(job->ctx, solid, i);
        if ((job->report.thin_kept & (i == 0 ? BVX_KEPT_A : BVX_KEPT_B)) == 0)
            bvxi_warn_of_walls(job->ctx, &job->lattice, solid, i);
        /* A body of so few voxels has lost its shape; the resolution that keeps it follows from its size. */
        if ((job->report.few >> i & 1) != 0)
            BVXI_WARN(job->ctx, BVX_WARN_FEW, bvxi_advised(job->report.advised_resolution))->input = i;
    }
    /* Often wrong units or a wrong place. */
    if (job->operation == BVX_BOOLEAN_DIFFERENCE && r->voxels_b == 0 && (r->few & BVX_FEW_B) == 0)
        bvxi_warn(job->ctx, BVX_WARN_APART, 0, NULL)->input = 1;
    if ((r->few & BVX_FEW_RESULT) != 0)
        BVXI_WARN(job->ctx, BVX_WARN_FEW_RESULT, bvxi_advised(r->advised_resolution));
    /* Their room is what the check needs. */
    for (int32_t i = 0; i < 2; i++) bvxi_sparse_close(job->ctx, &job->body[i].values);
    BVXI_TRY(measure_result(job, result, &shape));
    if (result->triangle_count != 0 && job->operation != BVX_BOOLEAN_INTERSECTION) {
        BVXI_TRY(warn_of_operands_parts(job, shape.parts, finer));
        BVXI_TRY(warn_of_operands_volume(job, shape.volume, finer));
    }
    BVXI_TRY(compare_finer(job, &shape, finer, &same));
    /* Of walls that arise between both bodies: one or two come off acute edges. */
    if (job->operation != BVX_BOOLEAN_UNION && r->crumbs >= BOOLEAN_CRUMBS && !same)
        BVXI_WARN(job->ctx, BVX_WARN_CRUMBS, (double)r->crumbs, finer);
    /* A vertex for each crossed edge. */
    if (result->triangle_count != 0)
        bvxi_warn_of_lids(job->ctx, (double)r->surface.lids / (double)result->vertex_count, job->holes,
                          &job->longest_rim);
    r->warnings = bvxi_warned(job->ctx);
    return BVX_OK;
}

static bvx_status run_boolean(bvx_context *context, const bvx_mesh_view *a, const bvx_mesh_view *b,
                              int32_t operation, const bvx_boolean_options *options, bvx_mesh *result)
{
    bvx_boolean_options o;
    boolean_job job = {0};

    if (result == NULL) return bvxi_fail_null(context, boolean_name, "result");
    BVXI_TRY(bvxi_take_options(context, boolean_name, options, &o, sizeof o));
    if (operation < BVX_BOOLEAN_UNION || operation > BVX_BOOLEAN_XOR)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: operation %d is unknown",
                             boolean_name, (int64_t)operation);

    /* What the rows cannot say follows them. */
    BVXI_TRY(bvxi_check_options(context, boolean_name, &o, BVXI_OPTIONS(boolean_rows)));
    BVXI_TRY(bvxi_check_fit(context, boolean_name, &o.fit));
    job.ctx = context;
    job.options = &o;
    job.operation = operation;

    int const mine = result->positions == NULL;
    job.body[0].mesh = job.source[0].mesh = a;
    job.body[0].report = &job.report.solid_a;
    job.body[1].mesh = job.source[1].mesh = b;
    job.body[1].report = &job.report.solid_b;
    bvx_status status = BVXI_SHARE(context, 0.0, 0.97, boolean_steps(&job, result));
    if (status == BVX_OK && o.report != NULL)
        status = BVXI_SHARE(context, 0.97, 1.0, warn_of_boolean(&job, result));
    /* Only what the library made is freed. */
    if (status != BVX_OK && mine) bvx_mesh_free(context, result); /* made, but not put back */
    if (status == BVX_OK && o.report != NULL) *o.report = job.report;
    return status;
}

bvx_status bvx_boolean(bvx_context *context, const bvx_mesh_view *a, const bvx_mesh_view *b,
                       int32_t operation, const bvx_boolean_options *options, bvx_mesh *result)
{
    return BVXI_CALL(context, run_boolean(context, a, b, operation, options, result));
}
