/* shift.h - rows of bits read from any bit on. Not installed. */
#ifndef BVXI_SHIFT_H
#define BVXI_SHIFT_H

#include "bits/bits.h"

static inline uint64_t bvxi_word_or_none(const uint64_t *row, int64_t words, int64_t k)
{
    return k >= 0 && k < words ? row[k] : 0;
}

/* Word k of to: 64 bits of the row from bit `from` + 64 k on, 0 before the
 * row and after it. to may be row when from >= 0. */
static inline void bvxi_shift_row(const uint64_t *row, int32_t words, int64_t from, uint64_t *to,
                                  int32_t count)
{
    int64_t const first = from >= 0 ? from / 64 : -((63 - from) / 64);
    unsigned const shift = (unsigned)(from - first * 64);
    int64_t const head = first < 0 ? -first : 0, end = (int64_t)words - 1 - first;
    int64_t k = 0;

    for (; k < count && k < head; k++)
        to[k] = shift == 0 ? bvxi_word_or_none(row, words, first + k)
                           : bvxi_word_or_none(row, words, first + k) >> shift |
                                 bvxi_word_or_none(row, words, first + k + 1) << (64 - shift);
    if (shift == 0)
        for (; k < count && k < end; k++) to[k] = row[first + k];
    else
        for (; k < count && k < end; k++)
            to[k] = row[first + k] >> shift | row[first + k + 1] << (64 - shift);
    /* the row's last word, then nothing */
    for (; k < count; k++) to[k] = bvxi_word_or_none(row, words, first + k) >> shift;
}

#endif
