/* turns_brick.h - bricks of a block of turns: cut into eight, settled as
 * wholes, or centre by centre. Not installed. */
#ifndef BVXI_TURNS_BRICK_H
#define BVXI_TURNS_BRICK_H

#include "winding/turns.h"

typedef struct turns_brick {
    int32_t at[3], size[3]; /* within the block */
    int32_t side;
} turns_brick;

static inline uint32_t brick_bits(const turns_brick *b)
{
    return (b->size[0] == 32 ? UINT32_MAX : ((uint32_t)1 << b->size[0]) - 1) << b->at[0];
}

static inline int brick_is_open(const bvxi_turns_block *block, const turns_brick *b)
{
    uint32_t const bits = brick_bits(b);
    for (int32_t z = b->at[2]; z < b->at[2] + b->size[2]; z++)
        for (int32_t y = b->at[1]; y < b->at[1] + b->size[1]; y++)
            if ((block->open[bvxi_turns_row(y, z)] & bits) != 0) return 1;
    return 0;
}

static inline void set_turns(bvxi_turns_block *block, uint32_t row, int32_t x, int32_t whole, int clear)
{
    block->turns[row * BVXI_TURNS_SIDE + (uint32_t)x] = 2 * whole;
    if (whole != 0) block->dirty = 1;
    if (clear) block->clear[row] |= (uint32_t)1 << x;
}

static inline void settle_brick(bvxi_turns_block *block, const turns_brick *b, int32_t whole, int clear)
{
    uint32_t const bits = brick_bits(b);

    /* Blocks begin with turns of 0. */
    if (whole == 0 && !clear) return;
    for (int32_t z = b->at[2]; z < b->at[2] + b->size[2]; z++)
        for (int32_t y = b->at[1]; y < b->at[1] + b->size[1]; y++) {
            uint32_t const row = bvxi_turns_row(y, z);
            if (clear) block->clear[row] |= bits & block->open[row];
            for (int32_t x = b->at[0]; x < b->at[0] + b->size[0] && whole != 0; x++)
                set_turns(block, row, x, whole, 0);
        }
}

/* What a centre says by itself. */
static inline void ask_centre(bvxi_turns_block *block, int32_t x, int32_t y, int32_t z)
{
    int64_t const step = (int64_t)1 << block->sheet->fraction_bits;
    int64_t const p[3] = {(block->low[0] + x) * step + step / 2, (block->low[1] + y) * step + step / 2,
                          (block->low[2] + z) * step + step / 2};
    bvxi_sheet_answer const a = bvxi_sheet_turns(block->sheet, p, block->want_clear);
    uint32_t const row = bvxi_turns_row(y, z);

    /* A tie is kept as one more or less than the doubled number, for the rule to settle. */
    set_turns(block, row, x, a.whole, block->want_clear && a.clear);
    if (block->ties && a.tie != 0) {
        block->turns[row * BVXI_TURNS_SIDE + (uint32_t)x] = 2 * a.whole + a.tie;
        block->dirty = 1;
    }
}

/* Is the whole number nearest to turns, and on which side of a quarter they are, certain to rest? */
static inline int is_certain(const bvxi_turns_block *block, double turns, double rest, double *whole,
                             int *clear)
{
    double const n = floor(turns + 0.5), off = turns < n ? n - turns : turns - n;
    /* Certain means: the same whole number, and the same side of a quarter where that matters. */
    *whole = n;
    *clear = off < 0.25;
    return off + rest < 0.5 && (!block->want_clear || off + rest < 0.25 || off - rest > 0.25);
}

/* The eighths that have centres go to the stack. */
static inline void cut_brick(const turns_brick *b, turns_brick *stack, int32_t *count)
{
    int32_t const half = b->side / 2;

    for (int32_t i = 0; i < 8; i++) {
        turns_brick *const c = &stack[*count];
        int full = 1;
        c->side = half;
        for (int32_t a = 0; a < 3; a++) {
            /* At the block's end an eighth may be smaller, or have no centre at all. */
            int32_t const from = (i >> a & 1) * half, left = b->size[a] - from;
            c->at[a] = b->at[a] + from;
            c->size[a] = left < half ? left : half;
            full &= left > 0;
        }
        *count += full;
    }
}

#endif
