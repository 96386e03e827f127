/* cells.h - the corners of 64 cells from the words of four rows: which cells the surface passes, and their
 * cases. Not installed. */
#ifndef BVXI_CELLS_H
#define BVXI_CELLS_H

#include "surface/march.h"
#include "surface/tables.h"

#if BVXI_HAVE_AVX2
#include <immintrin.h>
#endif

/* Corners of 64 cells: rows (y,z) = (0,0) (1,0) (0,1) (1,1), low-x and high-x corner of each cell. */
typedef struct bvxi_cell_words {
    uint64_t low[4], high[4];
} bvxi_cell_words;

/* The four rows of a slot's cells. */
static inline void bvxi_cell_rows(const bvxi_march *m, int32_t j, int32_t k, const uint64_t *row[4])
{
    for (int32_t r = 0; r < 4; r++) row[r] = bvxi_march_row(m, j + (r & 1), k + (r >> 1));
}

/* Corners of the cells of word n; n may be one past the rows' words. */
BVXI_VECTOR_INLINE void bvxi_load_cells(const uint64_t *const row[4], int32_t n, int32_t words,
                                        bvxi_cell_words *c)
{
    for (int32_t r = 0; r < 4; r++) {
        c->high[r] = n < words ? row[r][n] : 0;
        c->low[r] = c->high[r] << 1 | (n > 0 ? row[r][n - 1] >> 63 : 0);
    }
}

/* Words of a block, from `first` on, that can hold active cells: those whose four rows are not all empty and
 * not all set, and those beside a word of another kind, as a word's first cell begins with the centre before
 * it. count is at most BVXI_CELL_BLOCK; words beyond the rows are empty. */
BVXI_VECTOR_INLINE uint32_t bvxi_busy_words(const uint64_t *const row[4], int32_t first, int32_t count,
                                            int32_t words)
{
    uint32_t mixed = 0, full = 0; /* bit n + 1: word first + n; bit 0: the word before */
    int32_t const begin = first > 0 ? -1 : 0, end = count < words - first ? count : words - first;

    for (int32_t n = begin; n < end; n++) {
        uint64_t const a = row[0][first + n];
        uint64_t const b = row[1][first + n];
        uint64_t const c = row[2][first + n];
        uint64_t const d = row[3][first + n];
        uint64_t const any = a | b | c | d, all = a & b & c & d;
        uint32_t const is_full = all == ~UINT64_C(0), is_empty = any == 0;
        full |= is_full << (n + 1);
        mixed |= (1 - is_full - is_empty) << (n + 1);
    }
    return (mixed | mixed << 1 | (full ^ full << 1)) >> 1 & ((UINT32_C(1) << count) - 1);
}

static inline uint64_t bvxi_active_cells(const bvxi_cell_words *c)
{
    uint64_t const first = c->low[0];
    return (first ^ c->high[0]) | (first ^ c->low[1]) | (first ^ c->high[1]) | (first ^ c->low[2]) |
           (first ^ c->high[2]) | (first ^ c->low[3]) | (first ^ c->high[3]);
}

/* Case of cell i: bit x + 2y + 4z. */
static inline uint32_t bvxi_cell_case(const bvxi_cell_words *c, int32_t i)
{
    uint32_t n = 0;
    for (uint32_t r = 0; r < 4; r++)
        n |= (uint32_t)((c->low[r] >> i & 1) | (c->high[r] >> i & 1) << 1) << 2 * r;
    return n;
}

/* Words looked at together: what they hold is laid out in lists first, so that loops run over lists of known
 * length and not over the bits of each word. */
enum { BVXI_CELL_BLOCK = 16, BVXI_CELL_BLOCK_CELLS = BVXI_CELL_BLOCK * 64 };

typedef struct bvxi_cell_list {
    uint32_t count;
    /* bit numbers within the block; room for one group of eight beyond */
    uint16_t at[BVXI_CELL_BLOCK * 64 + 8];
} bvxi_cell_list;

/* Append the set bits of word n of the block, `group` at a time whether there are so many or not: most words
 * then cost no misprediction. group is a constant up to 8. */
BVXI_VECTOR_INLINE void bvxi_list_bits(bvxi_cell_list *list, uint64_t mask, int32_t n, uint32_t group,
                                       int fast)
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

/* Case numbers of active cells, one after the other. */
typedef struct bvxi_case_list {
    uint32_t count;
    uint8_t number[BVXI_CELL_BLOCK_CELLS + 8]; /* room for one group of eight beyond */
} bvxi_case_list;

BVXI_VECTOR_INLINE void bvxi_list_cases(bvxi_case_list *list, const bvxi_cell_words *c, uint64_t active)
{
    for (; active != 0; active &= active - 1)
        list->number[list->count++] = (uint8_t)bvxi_cell_case(c, bvxi_lowest(active));
}

#if BVXI_HAVE_AVX2
/* The same, eight cells at a time: each corner's bits are spread to one bit
 * of eight bytes, and the bytes of inactive cells are squeezed out. */
BVXI_AVX2 static inline void bvxi_list_cases_bmi2(bvxi_case_list *list, const bvxi_cell_words *c,
                                                  uint64_t active)
{
    uint64_t const ones = UINT64_C(0x0101010101010101);

    while (active != 0) {
        int32_t const shift = __builtin_ctzll(active) & ~7;
        /* the deposit takes the lowest eight bits only */
        uint64_t const keep = _pdep_u64(active >> shift, ones) * 255;
        uint64_t cases = 0, packed;
        for (int32_t r = 0; r < 4; r++)
            cases |= _pdep_u64(c->low[r] >> shift, ones << 2 * r) |
                     _pdep_u64(c->high[r] >> shift, ones << (2 * r + 1));
        packed = _pext_u64(cases, keep);
        memcpy(list->number + list->count, &packed, 8); /* AVX2 machines are little-endian */
        list->count += (uint32_t)__builtin_popcountll(keep) / 8;
        active &= ~(UINT64_C(0xff) << shift);
    }
}
#endif

#endif
