/* sample_bits.h - arrays of numbers to rows of bits by any rule, whatever axis runs fastest. Not
 * installed. */
#ifndef BVXI_SAMPLE_BITS_H
#define BVXI_SAMPLE_BITS_H

#include "grid/grid.h"

/* n numbers, stride bytes apart, to (n + 63) / 64 words; bits behind the
 * last are 0. tally is the piece's own. */
typedef void bvxi_bits_fn(const void *rule, void *tally, const uint8_t *p, int64_t stride, int32_t n,
                          uint64_t *words);

typedef struct bvxi_sample_walk {
    const uint8_t *first; /* sample of the grid's voxel (0,0,0) */
    int64_t stride[3];    /* [Units: bytes] */
    bvxi_bits_fn *run;
    const void *rule;
    void *tallies;        /* one for each piece, or NULL */
    size_t tally_size;    /* [Units: bytes] */
    bvx_grid *grid;       /* opened; all its words are written */
    int32_t axis, pieces; /* that runs fastest; set by bvxi_sample_walk_plan */
} bvxi_sample_walk;

/* Choose axis and pieces from strides and grid; then tallies may be made. */
void bvxi_sample_walk_plan(bvxi_sample_walk *walk);
/* Every number of the grid's window goes through the rule once. */
bvx_status bvxi_samples_to_bits(bvx_context *ctx, const char *stage, double from, double to,
                                bvxi_sample_walk *walk);

/* Bit i of the result is byte i of eight, each 0 or 1; the lowest byte is the first. */
static inline uint64_t bvxi_gather_bits(uint64_t bytes)
{
    return bytes * UINT64_C(0x0102040810204080) >> 56;
}

/* Bit i is byte i of p, each 0 or 1. */
static inline uint64_t bvxi_flags_to_word(const uint8_t p[64])
{
    uint64_t w = 0;

    for (int32_t i = 0; i < 8; i++) {
        const uint8_t *const q = p + 8 * i;
        uint64_t const v = (uint64_t)q[0] | (uint64_t)q[1] << 8 | (uint64_t)q[2] << 16 |
                           (uint64_t)q[3] << 24 | (uint64_t)q[4] << 32 | (uint64_t)q[5] << 40 |
                           (uint64_t)q[6] << 48 | (uint64_t)q[7] << 56;
        w |= bvxi_gather_bits(v) << 8 * i;
    }
    return w;
}

#endif
