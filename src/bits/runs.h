/* runs.h - runs of equal bits: of all rows of a grid as one long line, or of one row of voxels, one after
 * the other. Whole words are passed in one step, so a run costs the words that it covers. Not installed. */
#ifndef BVXI_RUNS_H
#define BVXI_RUNS_H

#include "bits/bits.h"

/* ---- The runs of equal bits in rows of words, all rows taken as one long line ---- */

/* Whole words are passed in one step; inside a word a run ends at the lowest bit that differs. Bits past a
 * row's end are not looked at. */

typedef struct bvxi_runs {
    const uint64_t *next; /* the word after the open one */
    uint64_t words;       /* words from there on */
    uint64_t open;        /* what is left of the open word, its first bit lowest */
    uint64_t flip;        /* 0 before a run of zeros, all ones before a run of ones */
    int32_t left;         /* bits in open */
    int32_t column;       /* of next in its row */
    int32_t row_words;
    int32_t tail; /* bits in a row's last word */
} bvxi_runs;

/* rows rows of bits bits each, one after the other, (bits + 63) / 64 words a row. */
static inline void bvxi_runs_start(bvxi_runs *runs, const uint64_t *words, uint64_t rows, int32_t bits)
{
    runs->row_words = bvxi_row_words(bits);
    runs->next = words;
    runs->words = rows * (uint64_t)runs->row_words;
    runs->open = 0;
    runs->flip = 0;
    runs->left = 0;
    runs->column = 0;
    runs->tail = bits - (runs->row_words - 1) * BVXI_WORD_BITS;
}

/* The length of the next run: zeros first (0 long when the first bit is set), then ones, zeros and so on. Not
 * to be asked again when the lengths add up to all bits. */
static inline uint64_t bvxi_runs_next(bvxi_runs *runs)
{
    uint64_t length = 0;

    for (;;) {
        /* The run ends at the first bit that is not like it. */
        uint64_t const ends = (runs->open ^ runs->flip) & bvxi_tail_mask(runs->left);
        if (ends != 0 && runs->left != 0) {
            int32_t const n = bvxi_lowest(ends);
            runs->open >>= n;
            runs->left -= n;
            runs->flip = ~runs->flip;
            return length + (uint64_t)n;
        }

        /* The run reaches the end of the word and may go on in the next one. */
        length += (uint64_t)runs->left;
        runs->left = 0;
        /* Whole words like the run, but for the last of a row: it may have fewer bits. */
        while (runs->words > 0 && *runs->next == runs->flip && runs->column + 1 < runs->row_words) {
            length += BVXI_WORD_BITS;
            runs->next++;
            runs->words--;
            runs->column++;
        }
        if (runs->words == 0) return length;
        runs->open = *runs->next++;
        runs->words--;
        runs->column++;
        runs->left = BVXI_WORD_BITS;
        if (runs->column == runs->row_words) {
            runs->column = 0;
            runs->left = runs->tail;
        }
    }
}

/* ---- The runs of one row of voxels, one after the other ---- */

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
    /* A word without a change is passed in one step. */
    while (r->changes == 0) {
        if (r->column == r->words) return r->size;
        uint64_t w = r->row[r->column++] ^ r->flip;
        /* Bits past the row are 0, so that a run of empty voxels ends there. */
        if (r->column == r->words) w &= bvxi_tail_mask(r->size);
        r->changes = w ^ (w << 1 | r->last);
        r->last = w >> 63;
    }
    int32_t x = (r->column - 1) * BVXI_WORD_BITS + bvxi_lowest(r->changes);
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
