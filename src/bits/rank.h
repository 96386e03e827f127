/* rank.h - the number of set bits before a bit, in constant time. Not installed.
 *
 * Source: Jacobson. Space-efficient static trees and graphs. 1989. One 32-bit prefix every four words (a
 * 64-byte line holds two blocks): a look-up adds at most four popcounts and never scans a row. */
#ifndef BVXI_RANK_H
#define BVXI_RANK_H

#include "bits/bits.h"

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

#endif
