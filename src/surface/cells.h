/* cells.h - 64 cells between four rows: corners, which are active, their case numbers. Not installed. */
#ifndef BVXI_CELLS_H
#define BVXI_CELLS_H

#include "surface/march.h"
#include "surface/tables.h"

/* Corners of 64 cells: rows (y,z) = (0,0) (1,0) (0,1) (1,1), low-x and high-x corner of each cell. */
typedef struct bvxi_cell_words {
    uint64_t low[4], high[4];
} bvxi_cell_words;

/* Four rows of cells read word by word from the left. */
typedef struct bvxi_cell_walk {
    const uint64_t *row[4];
    uint64_t carry[4]; /* last centre of the word before: the low-x corner of a word's first cell */
    int32_t next, words;
} bvxi_cell_walk;

static inline void bvxi_walk_start(bvxi_cell_walk *walk, const bvxi_march *m, int32_t j, int32_t k)
{
    for (int32_t r = 0; r < 4; r++) {
        walk->row[r] = bvxi_march_row(m, j + (r & 1), k + (r >> 1));
        walk->carry[r] = 0;
    }
    walk->next = 0;
    walk->words = m->grid->words_per_row;
}

/* The next word's corners. 0 when no cell of it can be active: all corners are empty, or all are set. */
BVXI_VECTOR_INLINE int bvxi_walk_next(bvxi_cell_walk *walk, bvxi_cell_words *c)
{
    int32_t const n = walk->next++;
    uint64_t any = 0, all = ~UINT64_C(0);
    for (int32_t r = 0; r < 4; r++) {
        uint64_t const high = n < walk->words ? walk->row[r][n] : 0; /* one word more than voxels may be asked for */
        c->high[r] = high;
        c->low[r] = high << 1 | walk->carry[r];
        walk->carry[r] = high >> 63;
        any |= high | c->low[r];
        all &= high & c->low[r];
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

/* Words looked at together: what they hold is laid out in lists first, so that loops run over lists of known length
 * and not over the bits of each word. */
enum { BVXI_CELL_BLOCK = 16 };

typedef struct bvxi_cell_list {
    uint32_t count;
    uint16_t at[BVXI_CELL_BLOCK * 64 + 8]; /* bit numbers within the block; room for one group of eight beyond */
} bvxi_cell_list;

BVXI_VECTOR_INLINE uint32_t bvxi_count_bits(uint64_t w, int fast)
{
#if BVXI_HAVE_AVX2
    if (fast) return (uint32_t)__builtin_popcountll(w);
#endif
    (void)fast;
    return bvxi_popcount(w);
}

/* Append the set bits of word n of the block, `group` at a time whether there are so many or not: most words then cost no
 * misprediction. group is a constant up to 8. */
BVXI_VECTOR_INLINE void bvxi_list_bits(bvxi_cell_list *list, uint64_t mask, int32_t n, uint32_t group, int fast)
{
    uint32_t const base = (uint32_t)n * 64;
    uint32_t at = list->count;
    list->count += bvxi_count_bits(mask, fast);
    do {
        for (uint32_t i = 0; i < group; i++) {
            list->at[at + i] = (uint16_t)(base + (uint32_t)bvxi_lowest(mask | UINT64_C(1) << 63));
            mask &= mask - 1;
        }
        at += group;
    } while (mask != 0);
}

#endif
