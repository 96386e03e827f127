/* runs.h - the runs of equal bits in rows of words, all rows taken as one long line. Not installed.
 *
 * Whole words are passed in one step; inside a word a run ends at the lowest bit that differs. Bits past a
 * row's end are not looked at. */
#ifndef BVXI_RUNS_H
#define BVXI_RUNS_H

#include "bits/bits.h"

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

#endif
