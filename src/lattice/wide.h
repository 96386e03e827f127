/* wide.h - signed sums of products in 128 bits, by the compiler's own type or by two limbs. Tests hold each
 * against the other. Not installed. */
#ifndef BVXI_WIDE_H
#define BVXI_WIDE_H

#include "core/core.h"

/* Two's complement, high limb first in value. */
typedef struct bvxi_limbs {
    uint64_t low;
    uint64_t high;
} bvxi_limbs;

static inline bvxi_limbs bvxi_limbs_negate(bvxi_limbs a)
{
    bvxi_limbs r;
    r.low = ~a.low + 1;
    r.high = ~a.high + (r.low == 0);
    return r;
}

static inline bvxi_limbs bvxi_limbs_add(bvxi_limbs a, bvxi_limbs b)
{
    bvxi_limbs r;
    r.low = a.low + b.low;
    r.high = a.high + b.high + (r.low < a.low);
    return r;
}

static inline bvxi_limbs bvxi_limbs_mul(int64_t a, int64_t b)
{
    uint64_t const ua = a < 0 ? 0 - (uint64_t)a : (uint64_t)a;
    uint64_t const ub = b < 0 ? 0 - (uint64_t)b : (uint64_t)b;
    uint64_t const a0 = ua & 0xffffffffu, a1 = ua >> 32, b0 = ub & 0xffffffffu, b1 = ub >> 32;
    uint64_t const p00 = a0 * b0, p01 = a0 * b1, p10 = a1 * b0, p11 = a1 * b1;
    uint64_t const middle = (p00 >> 32) + (p01 & 0xffffffffu) + (p10 & 0xffffffffu);
    bvxi_limbs r;
    r.low = (p00 & 0xffffffffu) | middle << 32;
    r.high = p11 + (p01 >> 32) + (p10 >> 32) + (middle >> 32);
    return (a < 0) != (b < 0) ? bvxi_limbs_negate(r) : r;
}

static inline int32_t bvxi_limbs_sign(bvxi_limbs a)
{
    return (a.high >> 63) != 0 ? -1 : (a.low | a.high) != 0;
}

static inline double bvxi_limbs_double(bvxi_limbs a)
{
    bvxi_limbs const m = (a.high >> 63) != 0 ? bvxi_limbs_negate(a) : a;
    double const v = (double)m.high * 18446744073709551616.0 + (double)m.low;
    return (a.high >> 63) != 0 ? -v : v;
}

#if defined(__SIZEOF_INT128__) && !defined(BVX_NO_INT128)

__extension__ typedef __int128 bvxi_wide;

static inline bvxi_wide bvxi_wide_mul(int64_t a, int64_t b)
{
    return (bvxi_wide)a * b;
}

static inline bvxi_wide bvxi_wide_add(bvxi_wide a, bvxi_wide b)
{
    return a + b;
}

static inline int32_t bvxi_wide_sign(bvxi_wide a)
{
    return (a > 0) - (a < 0);
}

static inline double bvxi_wide_double(bvxi_wide a)
{
    return (double)a;
}

#else

typedef bvxi_limbs bvxi_wide;

static inline bvxi_wide bvxi_wide_mul(int64_t a, int64_t b)
{
    return bvxi_limbs_mul(a, b);
}

static inline bvxi_wide bvxi_wide_add(bvxi_wide a, bvxi_wide b)
{
    return bvxi_limbs_add(a, b);
}

static inline int32_t bvxi_wide_sign(bvxi_wide a)
{
    return bvxi_limbs_sign(a);
}

static inline double bvxi_wide_double(bvxi_wide a)
{
    return bvxi_limbs_double(a);
}

#endif

/* floor(a / (b * c)) for b > 0 and c = 2^n, or -limit or limit when it lies beyond
 * them; limit <= 2^40, c * limit <= 2^62. A double comes within a few units of it,
 * exact steps decide: b c q = b (c q) is a product of two 64-bit numbers. */
static inline int64_t bvxi_wide_floor_div_scaled(bvxi_wide a, int64_t b, int64_t c, int64_t limit)
{
    double const estimate = bvxi_wide_double(a) / ((double)b * (double)c);
    if (estimate > (double)limit) return limit;
    if (estimate < -(double)limit) return -limit;
    int64_t q = (int64_t)estimate;
    while (bvxi_wide_sign(bvxi_wide_add(a, bvxi_wide_mul(-b, c * q))) < 0) q--;
    while (bvxi_wide_sign(bvxi_wide_add(a, bvxi_wide_mul(-b, c * (q + 1)))) >= 0) q++;
    return q;
}

#endif
