/* winding.c - the centres whose generalized winding number is above a half, either way; and where it passes a
 * half.
 *
 * Source: Jacobson, Kavan, Sorkine-Hornung. Robust Inside-Outside Segmentation using Generalized Winding
 * Numbers. 2013.
 *
 * The winding number is the mesh's solid angle in turns. With a sheet over its open edges the mesh is closed,
 * rows along x give the turns of both in whole numbers, and only the sheet's own angle has a fraction
 * (turns.h): near the holes bricks of centres are requested it, elsewhere it rounds to 0. An edge is open
 * when triangles run along it more often one way than the other.
 * Guarantee: local. A winding number within 1e-8 of a half counts as a half, which is outside; all others
 * fall as in the reals, crossings with the snapped triangles being exact. A mesh without open edges is filled
 * as by the rule nonzero, bit for bit. The bits follow from the snapped triangles only. */
#include "winding/turns.h"

typedef struct wind_work {
    const bvx_grid *solid;
    const bvx_mesh_view *sheet_view;
    const bvxi_sheet *sheet;
    bvx_solid_report *report;
} wind_work;

/* ---- The rule ---- */

/* Turns of the mesh and the turned sheet at the row's voxels, from x0 on, crossing by crossing. */
static void wind_row(const bvxi_turns_job *job, const bvxi_row_codes *mesh, const bvxi_row_codes *sheet,
                     const int32_t *turns, int32_t x0, int32_t x1, uint64_t *words)
{
    int32_t const low = job->grid->low[0];

    /* From crossing to crossing the depth is constant; between two of them runs are set. */
    uint32_t i = 0, j = 0;
    int32_t depth = 0;

    for (int32_t x = x0, next; x < x1; x = next) {
        for (; i < mesh->count && bvxi_floor_shift(mesh->code[i], 1) - low <= x; i++)
            depth += (mesh->code[i] & 1) != 0 ? -1 : 1;
        for (; j < sheet->count && bvxi_floor_shift(sheet->code[j], 1) - low <= x; j++)
            depth -= (sheet->code[j] & 1) != 0 ? -1 : 1;
        next = x1;
        if (i < mesh->count && bvxi_floor_shift(mesh->code[i], 1) - low < next)
            next = bvxi_floor_shift(mesh->code[i], 1) - low;
        if (j < sheet->count && bvxi_floor_shift(sheet->code[j], 1) - low < next)
            next = bvxi_floor_shift(sheet->code[j], 1) - low;
        if (turns == NULL) {
            if (depth != 0) bvxi_set_run(words, x, next);
            continue;
        }
        for (int32_t v = x; v < next; v++) {
            /* Twice the number, so that halves are whole: above a half, either way. */
            int32_t const twice = 2 * depth + turns[v - x0];
            if (twice > 1 || twice < -1) words[v >> 6] |= UINT64_C(1) << (v & 63);
        }
    }
}

static void wind_rows(const bvxi_turns_job *job, const bvxi_turns_block *b, const bvxi_row_codes *mesh,
                      int32_t x0, int32_t x1)
{
    for (int32_t z = 0; z < b->size[2]; z++)
        for (int32_t y = 0; y < b->size[1]; y++) {
            uint32_t const row = bvxi_turns_row(y, z);
            uint64_t *const words = job->grid->words + bvxi_turns_word(job, b, y, z);
            if (x0 == 0) memset(words, 0, (size_t)job->grid->words_per_row * 8);
            /* No turns, no crossings: the row stays empty. */
            if (!b->dirty && mesh[row].count == 0 && b->crossed[row].count == 0) continue;
            wind_row(job, &mesh[row], &b->crossed[row], b->dirty ? b->turns + row * BVXI_TURNS_SIDE : NULL,
                     x0, x1, words);
        }
}

/* lists: of the mesh. */
static bvx_status wind_block(bvx_context *ctx, bvxi_solid_job *job, const bvxi_row_lists *lists, double from,
                             double to)
{
    wind_work *const w = job->user;
    const bvx_mesh_view *const mesh = job->view;
    double const part = from + (to - from) / 8;
    bvxi_row_lists crossed;

    /* The same gathering, of the sheet's triangles: its crossings are taken off the mesh's. */
    job->view = w->sheet_view;
    bvx_status status = bvxi_solid_gather(ctx, job, from, part, &crossed);
    job->view = mesh;
    if (status != BVX_OK) return status;
    bvxi_turns_job turns = {.sheet = w->sheet,
                            .grid = w->solid,
                            .solid = job,
                            .mesh = lists,
                            .crossed = &crossed,
                            .rule = wind_rows,
                            .ties = 1};
    status = BVXI_SCOPE(ctx, bvxi_turns_run(ctx, &turns, bvxi_solid_progress(job, part),
                                            bvxi_solid_progress(job, to), &w->report->unbalanced_rows));
    bvxi_row_lists_free(ctx, &crossed);
    return status;
}

/* A vertex in voxels, moved to the lattice's side where it lies beyond. */
static void place_on_lattice(const bvx_mesh_view *mesh, uint64_t vertex, const bvx_lattice *l, double at[3])
{
    bvxi_view_position(mesh, vertex, at);
    for (int a = 0; a < 3; a++) {
        at[a] = (at[a] - l->origin[a]) / l->spacing[a];
        at[a] = at[a] < 0.0 ? 0.0 : at[a] > l->dims[a] ? l->dims[a] : at[a];
    }
}

/* Rows along y and z that pass through holes, by the loops' shadows. */
static uint64_t rows_through(const bvx_mesh_view *mesh, const bvxi_holes *holes, const bvx_lattice *lattice)
{
    uint64_t begin = 0, rows = 0;

    for (uint64_t l = 0; l < holes->loops; begin = holes->loop_end[l++]) {
        double from[3], p[3], q[3], shadow[3] = {0.0, 0.0, 0.0};

        place_on_lattice(mesh, holes->vertex[begin], lattice, from);
        memcpy(p, from, sizeof p);
        for (uint64_t i = begin + 1; i < holes->loop_end[l]; i++, memcpy(p, q, sizeof p)) {
            place_on_lattice(mesh, holes->vertex[i], lattice, q);
            for (int a = 1; a < 3; a++) {
                int const u = (a + 1) % 3, v = (a + 2) % 3;
                shadow[a] += (p[u] - from[u]) * (q[v] - from[v]) - (p[v] - from[v]) * (q[u] - from[u]);
            }
        }
        for (int a = 1; a < 3; a++) rows += (uint64_t)(0.5 * bvxi_absolute(shadow[a]));
    }
    return rows;
}

static bvx_status wind_with_holes(bvx_context *ctx, bvxi_solid_job *job, const bvxi_holes *holes,
                                  const bvx_grid *solid, double from, double to, bvx_solid_report *report)
{
    /* A mesh without open edges needs no angles: whole turns are the rule nonzero's. */
    if (holes->loops == 0)
        return bvxi_solid_fill(bvxi_solid_step(ctx, job, from, to), job, solid, 0, BVX_FILL_NONZERO, report);

    wind_work w = {solid, NULL, NULL, report};
    bvx_mesh_view view;
    bvxi_sheet sheet;

    BVXI_TRY(bvxi_sheet_open(ctx, holes, &job->snapped, &solid->lattice, &sheet));
    BVXI_TRY(bvxi_sheet_mesh_open(ctx, job->view, sheet.holes, &view));
    /* The sheet's rows are gathered block by block, with those of the mesh. */
    w.sheet = &sheet;
    w.sheet_view = &view;
    job->user = &w;
    job->take_lists = wind_block;
    BVXI_TRY(bvxi_solid_fill(bvxi_solid_step(ctx, job, from, to), job, solid, 0, BVX_FILL_NONZERO, report));
    job->take_lists = NULL;
    job->user = NULL;
    /* Windows have their own rows alone. */
    if (report->unbalanced_rows == 0 && bvxi_grid_is_whole(solid))
        report->unbalanced_rows = rows_through(job->view, holes, &solid->lattice);
    bvxi_sheet_close(ctx, &sheet);
    return BVX_OK;
}

bvx_status bvxi_wind(bvx_context *ctx, bvxi_solid_job *job, const bvx_grid *solid, double from, double to,
                     bvx_solid_report *report)
{
    double const part = from + (to - from) / 8;
    bvxi_holes holes;
    BVXI_TRY(bvxi_snap_turn(ctx, 0, from, &job->snapped));
    if (job->holes != NULL) return wind_with_holes(ctx, job, job->holes, solid, part, to, report);
    BVXI_TRY(bvxi_holes_check_corners(ctx, job->function, job->view));
    BVXI_TRY(BVXI_SHARE(ctx, from, part, bvxi_holes_open(ctx, job->view, &job->snapped, 0, &holes)));
    bvx_status const status = wind_with_holes(ctx, job, &holes, solid, part, to, report);
    bvxi_holes_close(ctx, &holes);
    return status;
}

/* ---- Between two centres ---- */

struct bvxi_winding {
    bvxi_snapped snapped;
    const bvxi_holes *holes;
    bvxi_sheet sheet;
    int32_t rule;
};

#define WINDING_NEAR   1e-3 /* parts of the sheet are opened until each is off by less */
#define WINDING_COARSE 1e-2
#define WINDING_AT_END 0.01  /* beyond what that may sum up to, mostly */
#define WINDING_LEAST  0.001 /* the crossing stays this far inside the edge */

void bvxi_winding_close(bvx_context *ctx, bvxi_winding *winding)
{
    if (winding == NULL) return;
    if (winding->sheet.holes != NULL) bvxi_sheet_close(ctx, &winding->sheet);
    bvxi_snap_free(ctx, &winding->snapped);
    bvxi_drop(ctx, winding);
}

bvx_status bvxi_winding_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                             const bvx_lattice *lattice, int32_t rule, const bvxi_holes *holes,
                             bvxi_winding **winding)
{
    bvxi_winding *w;
    *winding = NULL;
    if (holes->loops == 0) return BVX_OK;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, sizeof *w, "the winding number's holes", &w));
    w->rule = rule;
    w->holes = holes;
    BVXI_TRY(bvxi_snap(ctx, function, mesh, lattice, &w->snapped));
    BVXI_TRY(bvxi_sheet_open(ctx, holes, &w->snapped, lattice, &w->sheet));
    *winding = w;
    return BVX_OK;
}

/* The winding number's fraction is the sheet's. Without a triangle on the way
 * the number changes steadily, so of all numbers with the two fractions it
 * goes between those that lie nearest to each other on either side of a half. */
static double ratio_between(double from, double to, int32_t rule)
{
    /* Only the fractions count: whole turns are the mesh's, which does not change without a triangle. */
    from -= floor(from);
    to -= floor(to);
    /* not by way of the half: it is at an end, or the way is by the whole number to the next half */
    if ((from < 0.5) == (to < 0.5)) {
        double const near_from = from < 0.5 ? 0.5 - from : from - 0.5;
        double const near_to = to < 0.5 ? 0.5 - to : to - 0.5;
        if (near_from < WINDING_AT_END || near_to < WINDING_AT_END)
            return near_from < near_to ? WINDING_LEAST : 1 - WINDING_LEAST;
        if (rule == BVX_FILL_VOTE) return 0.5; /* or rows have decided */
        to += to > from ? -1 : 1;
    }
    /* The half that lies between both, and where the straight line meets it. */
    double const half = floor(from + 0.5) + (to > from ? 0.5 : -0.5);
    double const t = (half - from) / (to - from);
    return !(t > 0 && t < 1)       ? 0.5
           : t < WINDING_LEAST     ? WINDING_LEAST
           : t > 1 - WINDING_LEAST ? 1 - WINDING_LEAST
                                   : t;
}

void bvxi_winding_ratios(const bvxi_winding *winding, int32_t count, const bvxi_winding_edge *edge,
                         double *ratio)
{
    int64_t const step = (int64_t)1 << winding->sheet.fraction_bits;

    for (int32_t i = 0; i < count; i += 2) { /* two edges have four ends */
        double turns[4];
        int64_t p[4][3];
        for (int32_t k = 0; k < 4; k++) {
            /* The last lanes repeat an edge where the number is odd. */
            const bvxi_winding_edge *const e = &edge[i + k / 2 < count ? i + k / 2 : i];
            /* Centres in whole numbers: a voxel's place and half a step. */
            for (int32_t a = 0; a < 3; a++)
                p[k][a] = e->v[a] * step + step / 2 + (a == e->axis && k % 2 != 0 ? step : 0);
        }
        bvxi_sheet_angles_four(&winding->sheet, (const int64_t(*)[3])p, WINDING_NEAR, turns);
        ratio[i] = ratio_between(turns[0], turns[1], winding->rule);
        if (i + 1 < count) ratio[i + 1] = ratio_between(turns[2], turns[3], winding->rule);
    }
}

double bvxi_winding_off(const bvxi_winding *winding, const int64_t p[3])
{
    double const turns = bvxi_sheet_angle(&winding->sheet, p, WINDING_COARSE);
    double const off = turns - floor(turns + 0.5);
    return off < 0 ? -off : off;
}
