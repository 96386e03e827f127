/* bits.h - words of 64 voxels: counting, masks, prefix parity. Not installed.
 *
 * The plain forms are the specification; where the compiler is told of an instruction it gives the same
 * bits. */
#ifndef BVXI_BITS_H
#define BVXI_BITS_H

#include "core/core.h"

enum { BVXI_WORD_BITS = 64 };

static inline int32_t bvxi_row_words(int32_t nx)
{
    return (int32_t)(((int64_t)nx + BVXI_WORD_BITS - 1) / BVXI_WORD_BITS);
}

/* Bits of a row's last word that are real voxels. */
static inline uint64_t bvxi_tail_mask(int32_t nx)
{
    unsigned const used = (unsigned)nx % BVXI_WORD_BITS;
    return used ? (UINT64_C(1) << used) - 1 : ~UINT64_C(0);
}

static inline uint32_t bvxi_popcount(uint64_t w)
{
#if defined(__GNUC__) && defined(__POPCNT__)
    return (uint32_t)__builtin_popcountll(w);
#else
    /* Counts of pairs, of fours, of bytes; the multiplication adds the bytes up in the highest. */
    w -= w >> 1 & UINT64_C(0x5555555555555555);
    w = (w & UINT64_C(0x3333333333333333)) + (w >> 2 & UINT64_C(0x3333333333333333));
    w = (w + (w >> 4)) & UINT64_C(0x0f0f0f0f0f0f0f0f);
    return (uint32_t)(w * UINT64_C(0x0101010101010101) >> 56);
#endif
}

/* Index of the lowest set bit; w is not 0. */
static inline int32_t bvxi_lowest(uint64_t w)
{
#if defined(__GNUC__)
    return __builtin_ctzll(w);
#else
    return (int32_t)bvxi_popcount((w & (0 - w)) - 1);
#endif
}

/* Bit i of the result is the parity of bits 0..i. */
static inline uint64_t bvxi_prefix_parity(uint64_t w)
{
    w ^= w << 1;
    w ^= w << 2;
    w ^= w << 4;
    w ^= w << 8;
    w ^= w << 16;
    w ^= w << 32;
    return w;
}

/* Set bits [begin, end) of a row; the range lies inside it. */
static inline void bvxi_set_run(uint64_t *row, int32_t begin, int32_t end)
{
    if (begin >= end) return;
    int32_t const first = begin >> 6, last = (end - 1) >> 6;
    /* One word at the beginning, one at the end, whole ones between. */
    uint64_t const head = ~UINT64_C(0) << (begin & 63), tail = bvxi_tail_mask(end);
    if (first == last) {
        row[first] |= head & tail;
        return;
    }
    row[first] |= head;
    for (int32_t k = first + 1; k < last; k++) row[k] = ~UINT64_C(0);
    row[last] |= tail;
}

/* Index of the highest set bit; w is not 0. */
static inline int32_t bvxi_highest(uint64_t w)
{
#if defined(__GNUC__)
    return 63 - __builtin_clzll(w);
#else
    w |= w >> 1;
    w |= w >> 2;
    w |= w >> 4;
    w |= w >> 8;
    w |= w >> 16;
    w |= w >> 32;
    return (int32_t)bvxi_popcount(w) - 1;
#endif
}

/* ---- Runs of a word: bits where membership changes; *last is the bit before the word, then the word's last
 * one. ---- Over a row from *last = 0 the changes are begin, end, begin, end, ...; a run that the row's end
 * closes has no end. */
static inline uint64_t bvxi_run_changes(uint64_t w, uint64_t *last)
{
    uint64_t const changes = w ^ (w << 1 | *last);
    *last = w >> 63;
    return changes;
}

#endif
