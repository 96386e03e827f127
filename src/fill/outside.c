/* outside.c - the centres that a way from outside leads to, whatever the mesh is: open, doubled, flipped, in parts.
 *
 * Source: Serra. Image Analysis and Mathematical Morphology. 1982 (closing). Centres are joined along lattice edges;
 * an edge that a triangle crosses is blocked, by the solid's exact crossings with its rule of ties.
 *
 * A cube of gap + 1 voxels moves from outside through voxels that no triangle touches (close_gaps.c); what it covers is
 * outside. Beside walls and in corners it leaves out centres that lie outside too, so edges that are not blocked lead
 * on from there, for a few steps. Where more steps would follow, the way goes through an opening that the cube does not
 * pass: all centres on such a way are given up, so the opening ends where the cube does.
 * Guarantee: exact; no centre that is outside has an edge which is not blocked to one behind a closed opening that
 * is deeper than these steps. */
#include "fill/fills.h"
#include "grid/turned_rows.h"
#include "touch/surface_voxels.h"

enum { OUTSIDE_GRAIN = 4096, OUTSIDE_PLANES = 4, OUTSIDE_MOST = (1 << OUTSIDE_PLANES) - 1 };

typedef struct outside_job {
    bvx_grid *outside;
    uint64_t *blocked[3]; /* bit x, y, z of axis a: the edge from the voxel before along a is crossed */
    uint64_t *from, *to;  /* of a step: the centres of the last one, and those that it reaches */
    uint64_t *plane[OUTSIDE_PLANES]; /* steps to a centre, in binary; 0: no step */
    int32_t level;                   /* to: of the centres with so many steps; 0: of those not reached yet */
} outside_job;

/* ---- Blocked edges ---- */

/* A row's codes are the first centres beyond its crossings: bits of edges. */
static void block_crossed_rows(void *user, uint64_t begin, uint64_t end)
{
    const bvxi_solid_job *const job = user;
    const bvxi_row_lists *const lists = job->user;
    const bvx_grid *const g = job->grid;

    for (uint64_t row = begin; row < end; row++) {
        uint64_t const ny = (uint64_t)job->block.ny;
        uint64_t *const words = bvxi_block_words(job, (int32_t)(row % ny), (int32_t)(row / ny));

        memset(words, 0, (size_t)g->words_per_row * 8);
        for (uint64_t i = row == 0 ? 0 : lists->row_end[row - 1]; i < lists->row_end[row]; i++) {
            int32_t const x = bvxi_floor_shift(lists->crossing[i], 1) - g->low[0];
            if (x >= 0 && x < g->size[0]) words[x >> 6] |= UINT64_C(1) << (x & 63);
        }
    }
}

static bvx_status block_edges(bvx_context *ctx, bvxi_solid_job *job, const bvxi_row_lists *lists, double from,
                              double to)
{
    bvxi_row_lists of = *lists;
    (void)from;
    job->user = &of;
    return BVXI_SHARE(ctx, bvxi_solid_progress(job, to), bvxi_solid_progress(job, to),
                      bvxi_for(ctx, "outside", lists->rows, OUTSIDE_GRAIN, block_crossed_rows, job));
}

static bvx_status find_blocked(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                               outside_job *w)
{
    uint64_t const words = bvxi_grid_words(w->outside);
    uint64_t most = 0, *turned_words;
    bvx_solid_report unused = {0};
    bvxi_solid_job job;

    BVXI_TRY(bvxi_solid_open(ctx, function, mesh, &w->outside->lattice, &job));
    job.take_lists = block_edges;
    for (int32_t axis = 1; axis < 3; axis++) {
        bvx_grid turned;
        bvxi_turn_shape(w->outside, axis, &turned);
        if (bvxi_grid_words(&turned) > most) most = bvxi_grid_words(&turned);
    }
    BVXI_TRY(BVXI_ARRAY(ctx, most, "the edges along another axis", turned_words));

    for (int32_t axis = 0; axis < 3; axis++) {
        bvx_grid turned, own = *w->outside;

        BVXI_TRY(BVXI_ARRAY(ctx, words, "the blocked edges", w->blocked[axis]));
        own.words = w->blocked[axis];
        bvxi_turn_shape(w->outside, axis, &turned);
        turned.words = axis == 0 ? own.words : turned_words;
        BVXI_TRY(bvxi_solid_fill(bvxi_solid_step(ctx, &job, axis / 3.0, (axis + 1) / 3.0), &job, &turned,
                                 axis, BVX_FILL_PARITY, &unused));
        if (axis != 0) BVXI_TRY(bvxi_turn_back(ctx, &turned, axis, (axis + 1) / 3.0, &own, NULL));
    }
    bvxi_drop(ctx, turned_words);
    bvxi_solid_close(ctx, &job);
    return BVX_OK;
}

/* ---- Steps ---- */

/* The word of a row one before or after along y or z, as far as edges between both rows let it through. */
static inline uint64_t pass_open_edges(const outside_job *w, size_t at, size_t by, int32_t axis, int below,
                                       int above)
{
    uint64_t found = 0;
    if (below) found |= w->from[at - by] & ~w->blocked[axis][at];
    if (above) found |= w->from[at + by] & ~w->blocked[axis][at + by];
    return found;
}

/* All centres one step from those of `from`. */
static void step_outside_rows(void *user, uint64_t begin, uint64_t end)
{
    const outside_job *const w = user;
    const bvx_grid *const g = w->outside;
    size_t const row = (size_t)g->words_per_row, slice = row * (size_t)g->size[1];
    uint64_t const ny = (uint64_t)g->size[1];

    for (uint64_t r = begin; r < end; r++) {
        int32_t const y = (int32_t)(r % ny), z = (int32_t)(r / ny);

        for (size_t k = 0; k < row; k++) {
            size_t const at = (size_t)r * row + k;
            uint64_t const own = w->from[at], open = own & ~w->blocked[0][at];
            uint64_t const before = k > 0 ? w->from[at - 1] >> 63 : 0;
            uint64_t const after = k + 1 < row ? w->from[at + 1] & ~w->blocked[0][at + 1] & 1 : 0;
            uint64_t found = ((own << 1 | before) & ~w->blocked[0][at]) | open >> 1 | after << 63;
            uint64_t of = w->level == 0 ? ~g->words[at] : ~UINT64_C(0);

            found |= pass_open_edges(w, at, row, 1, y > 0, y + 1 < g->size[1]);
            found |= pass_open_edges(w, at, slice, 2, z > 0, z + 1 < g->size[2]);
            if (k + 1 == row) of &= bvxi_tail_mask(g->size[0]);
            for (int32_t p = 0; p < OUTSIDE_PLANES && w->level != 0; p++)
                of &= (w->level >> p & 1) != 0 ? w->plane[p][at] : ~w->plane[p][at];
            w->to[at] = found & of;
        }
    }
}

/* 1 in *some where the step reached any. */
static bvx_status step_outside(bvx_context *ctx, outside_job *w, int32_t level, int *some)
{
    uint64_t const words = bvxi_grid_words(w->outside);
    uint64_t any = 0;
    w->level = level;
    BVXI_TRY(bvxi_for(ctx, "outside", bvxi_grid_rows(w->outside),
                      1 + OUTSIDE_GRAIN / (uint64_t)w->outside->words_per_row, step_outside_rows, w));
    for (uint64_t i = 0; i < words; i++) any |= w->to[i];
    *some = any != 0;
    return BVX_OK;
}

/* From what the cube covers, along edges that are not blocked, and back from what lies too deep. */
static bvx_status follow_open_edges(bvx_context *ctx, outside_job *w, int32_t most)
{
    uint64_t const words = bvxi_grid_words(w->outside);
    int some = 1;
    int32_t steps = 0;

    while (steps < most) {
        uint64_t *const last = w->from;

        BVXI_TRY(step_outside(ctx, w, 0, &some));
        if (!some) return BVX_OK;
        /* The centres of the last step become those that the next one starts from; outside gains them. */
        w->from = w->to;
        w->to = last;
        steps++;
        for (uint64_t i = 0; i < words; i++) {
            w->outside->words[i] ^= w->from[i];
            for (int32_t p = 0; p < OUTSIDE_PLANES; p++)
                if ((steps >> p & 1) != 0) w->plane[p][i] |= w->from[i];
        }
    }
    BVXI_TRY(step_outside(ctx, w, 0, &some));
    while (some && steps > 0) {
        uint64_t *const last = w->from;

        w->from = w->to;
        w->to = last;
        BVXI_TRY(step_outside(ctx, w, steps, &some));
        for (uint64_t i = 0; i < words; i++) w->outside->words[i] &= ~w->to[i];
        steps--;
    }
    return BVX_OK;
}

bvx_status bvxi_outside(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh, int32_t gap,
                        bvx_grid *outside, bvx_grid *sheets)
{
    uint64_t const words = bvxi_grid_words(outside);
    outside_job w = {.outside = outside};
    bvx_grid shell;
    uint64_t pockets;

    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.3, bvxi_shell_open(ctx, mesh, outside, &shell)));
    BVXI_TRY(BVXI_SHARE(ctx, 0.3, 0.4, bvxi_close_gaps(ctx, function, &shell, gap, &pockets)));
    for (uint64_t i = 0; i < words; i++) outside->words[i] = ~shell.words[i];
    for (uint64_t i = (uint64_t)outside->words_per_row; i <= words; i += (uint64_t)outside->words_per_row)
        outside->words[i - 1] &= bvxi_tail_mask(outside->size[0]);

    BVXI_TRY(BVXI_SHARE(ctx, 0.4, 0.8, find_blocked(ctx, function, mesh, &w)));
    w.from = shell.words;
    memcpy(w.from, outside->words, (size_t)words * 8);
    BVXI_TRY(BVXI_ARRAY(ctx, words, "the centres of a step", w.to));
    for (int32_t p = 0; p < OUTSIDE_PLANES; p++)
        BVXI_TRY(BVXI_ZEROS(ctx, words, "the steps to centres", w.plane[p]));
    BVXI_TRY(BVXI_SHARE(ctx, 0.8, 1.0,
                        follow_open_edges(ctx, &w, gap + 2 < OUTSIDE_MOST ? gap + 2 : OUTSIDE_MOST)));

    /* A blocked edge between two centres outside crosses a wall without a centre in it: mark both. */
    const bvx_grid *const g = outside;
    size_t const row = (size_t)g->words_per_row, step[3] = {0, row, row * (size_t)g->size[1]};

    memset(sheets->words, 0, (size_t)words * 8);
    for (uint64_t i = 0; i < words; i++) {
        size_t const at = (size_t)i;
        uint64_t const first = at % row == 0 ? 0 : g->words[at - 1] >> 63;
        uint64_t both = g->words[at] & (g->words[at] << 1 | first) & w.blocked[0][at];

        sheets->words[at] |= both | both >> 1;
        if ((both & 1) != 0 && at % row != 0) sheets->words[at - 1] |= UINT64_C(1) << 63;
        for (int32_t axis = 1; axis < 3; axis++) {
            if (axis == 1 ? at / row % (size_t)g->size[1] == 0 : at < step[2]) continue;
            both = g->words[at] & g->words[at - step[axis]] & w.blocked[axis][at];
            sheets->words[at] |= both;
            sheets->words[at - step[axis]] |= both;
        }
    }
    return BVX_OK;
}
