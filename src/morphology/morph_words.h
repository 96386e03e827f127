/* morph_words.h - a word and its neighbours along x, in slices whose rows
 * lie one after the other. Not installed. */
#ifndef BVXI_MORPH_WORDS_H
#define BVXI_MORPH_WORDS_H

#include "morphology/morph.h"

#define BVXI_TOP_BIT (UINT64_C(1) << 63)

/* For each word of a slice: what may come in from the word before (its lowest bit, or none in a row's first
 * word) and from the one behind (the highest, or none in a row's last). */
typedef struct bvxi_row_ends {
    uint64_t *before, *behind;
    uint64_t bytes;
} bvxi_row_ends;

bvx_status bvxi_row_ends_open(bvx_context *ctx, const bvxi_bit_box *box, bvxi_row_ends *ends);
void bvxi_row_ends_free(bvx_context *ctx, bvxi_row_ends *ends);

/* Word k of a slice joined with itself one voxel on and back; around comes
 * in at the ends of rows. w[-1] and w[1] are looked at. */
static inline uint64_t bvxi_with_sides(const uint64_t *w, const bvxi_row_ends *ends, size_t k,
                                       uint64_t around)
{
    uint64_t const before = (w[-1] >> 63 & ends->before[k]) | ((around & 1) & ~ends->before[k]);
    uint64_t const behind = (w[1] << 63 & ends->behind[k]) | ((around & BVXI_TOP_BIT) & ~ends->behind[k]);
    return w[0] | w[0] << 1 | w[0] >> 1 | before | behind;
}

#endif
