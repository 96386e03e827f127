/* morphology.c - dilate, erode, open and close a grid, as in unbounded space, cut to its window.
 *
 * Source: Serra. Image Analysis and Mathematical Morphology. 1982.
 *
 * One operation never needs more than the window: from a voxel inside to one inside the steps can stay
 * inside, and what is beyond counts the same before and after. Of two the first may leave something beyond
 * the window that the second sees: where closing grows into emptiness, or opening shrinks out of what is set.
 * Then both are done in a box that is wider by the reach on each side, along x by whole words, so that rows
 * are copied and not shifted. */
#include "morphology/morph.h"

enum { MORPH_MOST_STEPS = 65536, MORPH_MOST_SIDE = 1 << 26 };

static bvx_status alloc_box(bvx_context *ctx, const char *stage, bvxi_bit_box *box)
{
    int ok = 1;
    /* Sizes up to 2^26 along each axis may pass 64 bits together. */
    uint64_t const bytes = bvxi_mul(bvxi_mul(bvxi_mul((uint64_t)box->row_words, (uint64_t)box->size[1], &ok),
                                             (uint64_t)box->size[2], &ok),
                                    8, &ok);
    box->words = NULL;
    if (!ok || bytes > SIZE_MAX)
        return bvxi_fail(ctx, BVX_ERR_BUDGET,
                         "%s: a grid of %d x %d x %d voxels is beyond this machine's addresses", stage,
                         (int64_t)box->size[0], (int64_t)box->size[1], (int64_t)box->size[2]);
    return bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "a grid between two steps", &box->words);
}

static void copy_into_wide(const bvx_grid *grid, const int32_t room[3], int32_t beyond,
                           const bvxi_bit_box *wide)
{
    size_t const words = (size_t)grid->words_per_row;
    uint64_t const outside = beyond ? ~bvxi_tail_mask(grid->size[0]) : 0;
    /* All is as beyond the window first; then the window's rows are copied in. */
    memset(wide->words, beyond ? 0xff : 0, (size_t)bvxi_box_words(wide) * 8);
    for (size_t z = 0; z < (size_t)grid->size[2]; z++)
        for (size_t y = 0; y < (size_t)grid->size[1]; y++) {
            size_t const at = (z + (size_t)room[2]) * (size_t)wide->size[1] + y + (size_t)room[1];
            uint64_t *const row = wide->words + at * (size_t)wide->row_words + (size_t)room[0];
            memcpy(row, bvxi_grid_row(grid, (int32_t)y, (int32_t)z), words * 8);
            row[words - 1] |= outside; /* Bits past the row's end belong to what lies beyond. */
        }
}

/* source -> first -> second, as many times as it takes; *last becomes the box that holds the result. */
static bvx_status run_between(bvx_context *ctx, const bvxi_morph *morph, const bvxi_bit_box *source,
                              const bvxi_bit_box *first, const bvxi_bit_box *second,
                              const bvxi_bit_box **last)
{
    if (morph->neighbourhood != 0) {
        /* The last sweep's box follows from their number. */
        *last = bvxi_step_sweeps(morph, source) % 2 == 1 ? first : second;
        return BVXI_SCOPE(ctx, bvxi_morph_steps(ctx, morph, source, first, second));
    }
    *last = morph->operations == 2 ? second : first;
    BVXI_TRY(bvxi_morph_ball(ctx, morph, morph->operation[0], 0.0, 1.0 / morph->operations, source, first));
    return morph->operations == 2 ? bvxi_morph_ball(ctx, morph, morph->operation[1], 0.5, 1.0, first, second)
                                  : BVX_OK;
}

static bvx_status run_in_wide_box(bvx_context *ctx, const bvxi_morph *morph, const bvx_grid *grid,
                                  bvx_grid *result)
{
    int32_t room[3];
    const bvxi_bit_box *last = NULL;
    bvxi_bit_box wide = {NULL, {0, 0, 0}, 0}, other;

    /* A box around the grid's with room for the reach; *words are those along x. */
    for (int a = 0; a < 3; a++) {
        /* A reach may be larger than any grid: sides are counted with more bits before they are kept. */
        int64_t const reach = morph->neighbourhood != 0 ? morph->steps : bvxi_ball_reach(morph, a),
                      side = grid->size[a] + 2 * reach + 3 * BVXI_WORD_BITS;
        if (side > MORPH_MOST_SIDE)
            return bvxi_fail(ctx, BVX_ERR_BUDGET,
                             "%s: a reach of %d voxels around the window is more than can be held",
                             morph->stage, reach);
        room[a] = (int32_t)reach;
        wide.size[a] = grid->size[a] + 2 * (int32_t)reach;
    }
    /* Whole words along x: rows are copied, never shifted. */
    room[0] = bvxi_row_words(room[0]);
    wide.row_words = grid->words_per_row + 2 * room[0];
    wide.size[0] = wide.row_words * BVXI_WORD_BITS;
    BVXI_TRY(alloc_box(ctx, morph->stage, &wide));

    other = wide;
    BVXI_TRY(alloc_box(ctx, morph->stage, &other));
    copy_into_wide(grid, room, morph->beyond, &wide);
    BVXI_TRY(run_between(ctx, morph, &wide, &other, &wide, &last));

    size_t const words = (size_t)result->words_per_row;
    uint64_t const tail = bvxi_tail_mask(result->size[0]);
    for (size_t z = 0; z < (size_t)result->size[2]; z++)
        for (size_t y = 0; y < (size_t)result->size[1]; y++) {
            size_t const at = (z + (size_t)room[2]) * (size_t)last->size[1] + y + (size_t)room[1];
            uint64_t *const row = bvxi_grid_row(result, (int32_t)y, (int32_t)z);
            memcpy(row, last->words + at * (size_t)last->row_words + (size_t)room[0], words * 8);
            row[words - 1] &= tail;
        }
    return BVX_OK;
}

bvx_status bvxi_morph_run(bvx_context *ctx, const bvxi_morph *morph, const bvx_grid *grid, bvx_grid *result)
{
    /* Only where the first operation leaves something beyond the window that the second one sees. */
    int const leaves_window = morph->operations == 2 &&
                              morph->operation[0] == (morph->beyond ? BVXI_ERODE : BVXI_DILATE);
    if (leaves_window) return run_in_wide_box(ctx, morph, grid, result);

    bvxi_bit_box const source = bvxi_box_of_grid(grid), target = bvxi_box_of_grid(result);
    int32_t const runs = morph->neighbourhood != 0 ? bvxi_step_sweeps(morph, &source) : morph->operations;
    const bvxi_bit_box *last;
    bvxi_bit_box between = source;

    /* The last run writes to the result, whatever their number is; a single one needs no box between. */
    if (runs == 1) return run_between(ctx, morph, &source, &target, &target, &last);
    BVXI_TRY(alloc_box(ctx, morph->stage, &between));
    return runs % 2 == 1 ? run_between(ctx, morph, &source, &target, &between, &last)
                         : run_between(ctx, morph, &source, &between, &target, &last);
}

static const bvxi_option morph_rows[] = {
    BVXI_OR(bvx_morph_options, neighbourhood, AMONG, 6, 1 << BVX_BALL | 1 << 6 | 1 << 18 | 1 << 26, 0),
    BVXI_OR(bvx_morph_options, steps, WHOLE, 1, 1, MORPH_MOST_STEPS),
    BVXI_REAL(bvx_morph_options, radius, 0.0, BVXI_FINITE),
    BVXI_SWITCH(bvx_morph_options, beyond),
    BVXI_RESERVED(bvx_morph_options, reserved),
};

/* What each operation is made of, by BVX_MORPH_... */
static const bvxi_morph morphs[] = {
    {.stage = "dilate", .operation = {BVXI_DILATE, BVXI_DILATE}, .operations = 1},
    {.stage = "erode", .operation = {BVXI_ERODE, BVXI_ERODE}, .operations = 1},
    {.stage = "open", .operation = {BVXI_ERODE, BVXI_DILATE}, .operations = 2},
    {.stage = "close", .operation = {BVXI_DILATE, BVXI_ERODE}, .operations = 2},
};

static bvx_status change_grid(bvx_context *ctx, const bvx_grid *grid, int32_t operation,
                              const bvx_morph_options *options, bvx_grid *result)
{
    static const char function[] = "bvx_grid_morph";
    bvx_window window;

    BVXI_TRY(bvxi_grid_apart(ctx, function, grid, result));
    if (operation < BVX_MORPH_DILATE || operation > BVX_MORPH_CLOSE)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: operation is %d; it must be BVX_MORPH_...", function, (int64_t)operation);
    bvxi_morph morph = morphs[operation];
    bvx_morph_options o;

    BVXI_TRY(bvxi_take_options(ctx, function, options, &o, sizeof o));
    BVXI_TRY(bvxi_check_options(ctx, function, &o, BVXI_OPTIONS(morph_rows)));

    /* A ball has a radius, neighbourhoods have steps; the other one has to be left out. */
    if (o.neighbourhood == BVX_BALL && o.steps != 1)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: steps is %d; a ball takes 1", function, (int64_t)o.steps);
    if (o.neighbourhood != BVX_BALL && o.radius != 0.0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: radius is %g; it must be 0 unless neighbourhood is BVX_BALL", function,
                             o.radius);
    morph.neighbourhood = o.neighbourhood == BVX_BALL ? 0 : o.neighbourhood;
    morph.steps = o.steps;
    morph.beyond = o.beyond;
    BVXI_TRY(o.neighbourhood == BVX_BALL ? bvxi_ball_set(ctx, function, &grid->lattice, o.radius, &morph)
                                         : BVX_OK);
    memcpy(window.low, grid->low, sizeof window.low);
    memcpy(window.size, grid->size, sizeof window.size);
    bvxi_grid_renew(ctx, &grid->lattice, &window, result);
    bvx_grid made = *result;
    BVXI_TRY(bvxi_grid_open(ctx, function, &grid->lattice, &window, &made));
    return bvxi_grid_put(ctx, bvxi_morph_run(ctx, &morph, grid, &made), &made, result);
}

bvx_status bvx_grid_morph(bvx_context *context, const bvx_grid *grid, int32_t operation,
                          const bvx_morph_options *options, bvx_grid *result)
{
    return BVXI_CALL(context, change_grid(context, grid, operation, options, result));
}
