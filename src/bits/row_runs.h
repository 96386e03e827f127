/* row_runs.h - the runs of one row of voxels, one after the other. Not installed. */
#ifndef BVXI_ROW_RUNS_H
#define BVXI_ROW_RUNS_H

#include "bits/bits.h"

typedef struct bvxi_row_runs {
    const uint64_t *row;
    uint64_t flip;    /* all ones: runs of empty voxels */
    uint64_t changes; /* of the word at column - 1: bits where membership changes */
    uint64_t last;    /* that word's highest bit */
    int32_t column, words, size;
} bvxi_row_runs;

/* Runs of set voxels of a row of size voxels, or of empty ones. */
static inline void bvxi_row_runs_start(bvxi_row_runs *r, const uint64_t *row, int32_t size, int empty)
{
    r->row = row;
    r->flip = empty ? ~UINT64_C(0) : 0;
    r->changes = r->last = 0;
    r->column = 0;
    r->words = bvxi_row_words(size);
    r->size = size;
}

/* The next voxel where membership changes, or the row's size. */
static inline int32_t bvxi_row_runs_change(bvxi_row_runs *r)
{
    int32_t x;

    /* A word without a change is passed in one step. */
    while (r->changes == 0) {
        uint64_t w;
        if (r->column == r->words) return r->size;
        w = r->row[r->column++] ^ r->flip;
        /* Bits past the row are 0, so that a run of empty voxels ends there. */
        if (r->column == r->words) w &= bvxi_tail_mask(r->size);
        r->changes = w ^ (w << 1 | r->last);
        r->last = w >> 63;
    }
    x = (r->column - 1) * BVXI_WORD_BITS + bvxi_lowest(r->changes);
    r->changes &= r->changes - 1;
    return x;
}

/* The next run [*begin, *end); 0 when there is none. */
static inline int bvxi_row_runs_next(bvxi_row_runs *r, int32_t *begin, int32_t *end)
{
    *begin = bvxi_row_runs_change(r);
    if (*begin == r->size) return 0;
    *end = bvxi_row_runs_change(r);
    return 1;
}

/* Bits of [begin, end) in word k of a row, for a run that meets this word. */
static inline uint64_t bvxi_run_mask(int32_t begin, int32_t end, int32_t k)
{
    int32_t const low = begin - k * BVXI_WORD_BITS, high = end - k * BVXI_WORD_BITS;
    uint64_t const head = low > 0 ? ~UINT64_C(0) << low : ~UINT64_C(0);
    return high < BVXI_WORD_BITS ? head & ((UINT64_C(1) << high) - 1) : head;
}

#endif
