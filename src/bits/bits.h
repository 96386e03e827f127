/* bits.h - words of 64 voxels: counting, masks, prefix parity; rows of bits read from any bit on; a block of
 * 64 x 64 bits turned over its diagonal; the number of set bits before a bit, in constant time. Not
 * installed. */
#ifndef BVXI_BITS_H
#define BVXI_BITS_H

#include "core/core.h"

/* ---- Words of 64 voxels: counting, masks, prefix parity ---- */

/* The plain forms are the specification; where the compiler is told of an instruction it gives the same
 * bits. */

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

/* fast: in a loop of BVXI_AVX2, which has the instruction. */
BVXI_VECTOR_INLINE uint32_t bvxi_count_bits(uint64_t w, int fast)
{
#if BVXI_HAVE_AVX2
    if (fast) return (uint32_t)__builtin_popcountll(w);
#endif
    (void)fast;
    return bvxi_popcount(w);
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

/* ---- Rows of bits read from any bit on ---- */

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

/* ---- A block of 64 x 64 bits turned over its diagonal ---- */

/* Source: Warren. Hacker's Delight, 7-3: halves that lie off the diagonal change places, then their halves,
 * six times. Bit 0 is the lowest: afterwards bit i of word k is what bit k of word i was. */

static inline void bvxi_transpose_64(uint64_t block[64])
{
    uint64_t low = UINT64_C(0x00000000ffffffff); /* the lower half of every piece of 2 * half bits */
    for (int32_t half = 32; half != 0; half >>= 1, low ^= low << half)
        for (int32_t base = 0; base < 64; base += 2 * half)
            for (int32_t k = base; k < base + half; k++) {
                /* Bits that differ between both halves change places; three operations exchange them. */
                uint64_t const differ = (block[k] >> half ^ block[k + half]) & low;
                block[k] ^= differ << half;
                block[k + half] ^= differ;
            }
}

/* ---- The number of set bits before a bit, in constant time ---- */

/* Source: Jacobson. Space-efficient static trees and graphs. 1989. One 32-bit prefix every four words (a
 * 64-byte line holds two blocks): a look-up adds at most four popcounts and never scans a row. */

enum { BVXI_RANK_WORDS = 4 };

typedef struct bvxi_rank {
    const uint64_t *words;
    uint32_t *prefix; /* set bits before each block of four words; the last entry is the total */
    uint64_t word_count;
} bvxi_rank;

static inline uint64_t bvxi_rank_blocks(uint64_t word_count)
{
    return (word_count + BVXI_RANK_WORDS - 1) / BVXI_RANK_WORDS;
}

static inline uint64_t bvxi_rank_bytes(uint64_t word_count)
{
    return (bvxi_rank_blocks(word_count) + 1) * sizeof(uint32_t);
}

/* Fill the prefixes; prefix has bvxi_rank_bytes. Returns the total, which must stay below 2^32. */
static inline uint64_t bvxi_rank_build(bvxi_rank *rank, const uint64_t *words, uint64_t word_count,
                                       uint32_t *prefix)
{
    uint64_t total = 0;

    /* One prefix for four words: an eighth of their bytes. */
    for (uint64_t i = 0; i < word_count; i++) {
        if (i % BVXI_RANK_WORDS == 0) prefix[i / BVXI_RANK_WORDS] = (uint32_t)total;
        total += bvxi_popcount(words[i]);
    }
    prefix[bvxi_rank_blocks(word_count)] = (uint32_t)total;
    rank->words = words;
    rank->prefix = prefix;
    rank->word_count = word_count;
    return total;
}

/* Set bits before bit number `bit` (counted over all words). */
static inline uint32_t bvxi_rank_before(const bvxi_rank *rank, uint64_t bit)
{
    uint64_t const word = bit >> 6, block = word / BVXI_RANK_WORDS;
    uint32_t n = rank->prefix[block];
    for (uint64_t i = block * BVXI_RANK_WORDS; i < word; i++) n += bvxi_popcount(rank->words[i]);
    if ((bit & 63) != 0) n += bvxi_popcount(rank->words[word] & ((UINT64_C(1) << (bit & 63)) - 1));
    return n;
}

/* 1 where the highest byte of a number comes first. */
static inline int bvxi_machine_is_big(void)
{
    uint16_t const one = 1;
    uint8_t first;
    memcpy(&first, &one, 1);
    return first == 0;
}

#endif
