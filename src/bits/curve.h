/* curve.h - places on a curve through space. Not installed.
 *
 * Source: Morton. A computer oriented geodetic data base. 1966. */
#ifndef BVXI_CURVE_H
#define BVXI_CURVE_H

#include <stdint.h>

/* Bit i of the low 21 goes to bit 3 i; those of three axes side by side are a place on the curve. */
static inline uint64_t bvxi_curve_spread(uint64_t x)
{
    x = (x | x << 32) & UINT64_C(0x001f00000000ffff);
    x = (x | x << 16) & UINT64_C(0x001f0000ff0000ff);
    x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
    x = (x | x << 2) & UINT64_C(0x1249249249249249);
    return x;
}

#endif
