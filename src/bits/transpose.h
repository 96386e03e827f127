/* transpose.h - a block of 64 x 64 bits turned over its diagonal. Not installed.
 *
 * Source: Warren. Hacker's Delight, 7-3: halves that lie off the diagonal change places, then their halves,
 * six times. Bit 0 is the lowest: afterwards bit i of word k is what bit k of word i was. */
#ifndef BVXI_TRANSPOSE_H
#define BVXI_TRANSPOSE_H

#include "core/core.h"

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

#endif
