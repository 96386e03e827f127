/* cells.h - 64 cells between four rows: corners, which are active, their case numbers. Not installed. */
#ifndef BVXI_CELLS_H
#define BVXI_CELLS_H

#include "surface/march.h"
#include "surface/tables.h"

/* Corners of 64 cells: rows (y,z) = (0,0) (1,0) (0,1) (1,1), low-x and high-x corner of each cell. */
typedef struct bvxi_cell_words {
    uint64_t low[4], high[4];
} bvxi_cell_words;

/* 0 when no cell of the word can be active: all corners are empty, or all are set. */
static inline int bvxi_load_cells(const uint64_t *const row[4], int32_t n, int32_t words, bvxi_cell_words *c)
{
    uint64_t any = 0, all = ~UINT64_C(0);
    for (int32_t r = 0; r < 4; r++) {
        c->low[r] = bvxi_low_word(row[r], n, words);
        c->high[r] = bvxi_high_word(row[r], n, words);
        any |= c->low[r] | c->high[r];
        all &= c->low[r] & c->high[r];
    }
    return any != 0 && all != ~UINT64_C(0);
}

static inline uint64_t bvxi_active_cells(const bvxi_cell_words *c)
{
    uint64_t const first = c->low[0];
    return (first ^ c->high[0]) | (first ^ c->low[1]) | (first ^ c->high[1]) | (first ^ c->low[2]) | (first ^ c->high[2]) |
           (first ^ c->low[3]) | (first ^ c->high[3]);
}

/* Case of cell i: bit x + 2y + 4z. */
static inline uint32_t bvxi_cell_case(const bvxi_cell_words *c, int32_t i)
{
    uint32_t n = 0;
    for (uint32_t r = 0; r < 4; r++)
        n |= (uint32_t)((c->low[r] >> i & 1) | (c->high[r] >> i & 1) << 1) << 2 * r;
    return n;
}

#endif
