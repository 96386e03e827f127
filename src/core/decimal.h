/* decimal.h - what reading and printing of decimal numbers share: powers of ten in 128 bits, and integers of
 * a fixed size that compare d * 10^k with c * 2^q exactly. Only decimal.c includes this. Not installed. */
#ifndef BVXI_DECIMAL_H
#define BVXI_DECIMAL_H

#include "core/core.h"

/* 10^k is the product of two table entries; the test proves the bound on its error for every k. */

/* Significand bits with the leading one; exponents q of the smallest and largest finite numbers c * 2^q. */
typedef struct decimal_kind {
    int32_t precision, low_exponent, high_exponent;
} decimal_kind;

static const decimal_kind decimal_f64 = {53, -1074, 971};
static const decimal_kind decimal_f32 = {24, -149, 104};

enum { DECIMAL_STEP = 28, DECIMAL_FIRST = -13, DECIMAL_LEAST = -364, DECIMAL_MOST = 335, DECIMAL_ERROR = 3 };

/* The first 128 bits of 5^(28 i), i from DECIMAL_FIRST on; exact for i = 0 and 1. */
static const uint64_t decimal_large_powers[25][2] = {
    {UINT64_C(0xe1afa13afbd14d6d), UINT64_C(0x82189c09a3a1ec21)},
    {UINT64_C(0xe3e27a444d8d98b7), UINT64_C(0xfd1b1b2308169b25)},
    {UINT64_C(0xe61acf033d1a45df), UINT64_C(0x6fb92487298e33bd)},
    {UINT64_C(0xe858ad248f5c22c9), UINT64_C(0xd1b3400f8f9cff68)},
    {UINT64_C(0xea9c227723ee8bcb), UINT64_C(0x465e15a979c1cadc)},
    {UINT64_C(0xece53cec4a314ebd), UINT64_C(0xa4f8bf5635246428)},
    {UINT64_C(0xef340a98172aace4), UINT64_C(0x86fb897116c87c34)},
    {UINT64_C(0xf18899b1bc3f8ca1), UINT64_C(0xdc44e6c3cb279ac1)},
    {UINT64_C(0xf3e2f893dec3f126), UINT64_C(0x5a89dba3c3efccfa)},
    {UINT64_C(0xf64335bcf065d37d), UINT64_C(0x4d4617b5ff4a16d5)},
    {UINT64_C(0xf8a95fcf88747d94), UINT64_C(0x75a44c6397ce912a)},
    {UINT64_C(0xfb158592be068d2e), UINT64_C(0xeed6e2f0f0d56712)},
    {UINT64_C(0xfd87b5f28300ca0d), UINT64_C(0x8bca9d6e188853fc)},
    {UINT64_C(0x8000000000000000), UINT64_C(0x0000000000000000)},
    {UINT64_C(0x813f3978f8940984), UINT64_C(0x4000000000000000)},
    {UINT64_C(0x82818f1281ed449f), UINT64_C(0xbff8f10e7a8921a4)},
    {UINT64_C(0x83c7088e1aab65db), UINT64_C(0x792667c6da79e0fa)},
    {UINT64_C(0x850fadc09923329e), UINT64_C(0x03e2cf6bc604ddb0)},
    {UINT64_C(0x865b86925b9bc5c2), UINT64_C(0x0b8a2392ba45a9b2)},
    {UINT64_C(0x87aa9aff79042286), UINT64_C(0x90fb44d2f05d0842)},
    {UINT64_C(0x88fcf317f22241e2), UINT64_C(0x441fece3bdf81f03)},
    {UINT64_C(0x8a5296ffe33cc92f), UINT64_C(0x82bd6b70d99aaa6f)},
    {UINT64_C(0x8bab8eefb6409c1a), UINT64_C(0x1ad089b6c2f7548e)},
    {UINT64_C(0x8d07e33455637eb2), UINT64_C(0xdb0b487b6423e1e8)},
    {UINT64_C(0x8e679c2f5e44ff8f), UINT64_C(0x570f09eaa7ea7648)},
};

/* 5^0 .. 5^27, the last below 2^63. */
static const uint64_t decimal_small_powers[DECIMAL_STEP] = {UINT64_C(1),
                                                            UINT64_C(5),
                                                            UINT64_C(25),
                                                            UINT64_C(125),
                                                            UINT64_C(625),
                                                            UINT64_C(3125),
                                                            UINT64_C(15625),
                                                            UINT64_C(78125),
                                                            UINT64_C(390625),
                                                            UINT64_C(1953125),
                                                            UINT64_C(9765625),
                                                            UINT64_C(48828125),
                                                            UINT64_C(244140625),
                                                            UINT64_C(1220703125),
                                                            UINT64_C(6103515625),
                                                            UINT64_C(30517578125),
                                                            UINT64_C(152587890625),
                                                            UINT64_C(762939453125),
                                                            UINT64_C(3814697265625),
                                                            UINT64_C(19073486328125),
                                                            UINT64_C(95367431640625),
                                                            UINT64_C(476837158203125),
                                                            UINT64_C(2384185791015625),
                                                            UINT64_C(11920928955078125),
                                                            UINT64_C(59604644775390625),
                                                            UINT64_C(298023223876953125),
                                                            UINT64_C(1490116119384765625),
                                                            UINT64_C(7450580596923828125)};

/* ---- arithmetic ---- */

/* x / 2^bits rounded down, above -4096; shifting a negative x would not be portable. */
static inline int32_t decimal_floor_shift(int64_t x, int32_t bits)
{
    return (int32_t)(((uint64_t)(x + (INT64_C(4096) << bits))) >> bits) - 4096;
}

/* floor(log2(10^k)), |k| <= 364; floor(log10(2^q)) and floor(log10(3/4 2^q)), |q| <= 1080. */
static inline int32_t decimal_log2_of_power(int32_t k)
{
    return decimal_floor_shift((int64_t)k * 1741647, 19);
}

static inline int32_t decimal_log10_of_two(int32_t q)
{
    return decimal_floor_shift((int64_t)q * 1262611, 22);
}

static inline int32_t decimal_log10_of_less(int32_t q)
{
    return decimal_floor_shift((int64_t)q * 1262611 - 524031, 22);
}

static inline uint64_t decimal_mul(uint64_t a, uint64_t b, uint64_t *low)
{
#if defined(__SIZEOF_INT128__) && !defined(BVX_NO_INT128)
    __extension__ typedef unsigned __int128 decimal_wide;
    decimal_wide const p = (decimal_wide)a * b;
    *low = (uint64_t)p;
    return (uint64_t)(p >> 64);
#else
    uint64_t const a0 = a & 0xffffffffu, a1 = a >> 32, b0 = b & 0xffffffffu, b1 = b >> 32;
    uint64_t const p00 = a0 * b0, p01 = a0 * b1, p10 = a1 * b0, p11 = a1 * b1;
    uint64_t const middle = (p00 >> 32) + (p01 & 0xffffffffu) + (p10 & 0xffffffffu);
    *low = (p00 & 0xffffffffu) | middle << 32;
    return p11 + (p01 >> 32) + (p10 >> 32) + (middle >> 32);
#endif
}

/* p[2]:p[1]:p[0] = (high:low) * w */
static inline void decimal_mul_wide(uint64_t high, uint64_t low, uint64_t w, uint64_t p[3])
{
    uint64_t const carry = decimal_mul(low, w, &p[0]);
    p[2] = decimal_mul(high, w, &p[1]);
    p[1] += carry;
    p[2] += p[1] < carry;
}

/* Zero bits above the highest set one; w is not 0. */
static inline int32_t decimal_leading_zeros(uint64_t w)
{
#if defined(__GNUC__)
    return __builtin_clzll(w);
#else
    int32_t n = 0;
    for (int32_t step = 32; step > 0; step /= 2)
        if (w >> (64 - step) == 0) {
            n += step;
            w <<= step;
        }
    return n;
#endif
}

typedef struct decimal_power {
    uint64_t high, low; /* P, its highest bit set */
    int32_t exponent;
    int32_t exact; /* 10^k = P * 2^exponent; else P < 10^k / 2^exponent < P + DECIMAL_ERROR */
} decimal_power;

/* 10^k from two factors. The large one is short of the truth by less than 1,
 * the small one is exact and below 2^63, so their product before normalizing
 * is short by less than the small one; that and the bits cut off stay below 3. */
static inline decimal_power decimal_power_of_ten(int32_t k)
{
    int32_t const i = (k - DECIMAL_STEP * DECIMAL_FIRST) / DECIMAL_STEP;
    uint64_t const *const large = decimal_large_powers[i];
    uint64_t const small = decimal_small_powers[k - DECIMAL_STEP * (i + DECIMAL_FIRST)];
    decimal_power r;
    uint64_t p[3];
    int32_t const up = decimal_leading_zeros(small);

    decimal_mul_wide(large[0], large[1], small << up, p);
    if (p[2] >> 63 == 0) {
        p[2] = p[2] << 1 | p[1] >> 63;
        p[1] = p[1] << 1 | p[0] >> 63;
    }
    r.high = p[2];
    r.low = p[1];
    r.exponent = decimal_log2_of_power(k) - 127;
    r.exact = k >= 0 && k <= 55; /* 5^55 < 2^128 */
    return r;
}

/* ---- binary numbers ---- */

static inline uint64_t decimal_infinity(const decimal_kind *kind)
{
    return (uint64_t)(kind->high_exponent - kind->low_exponent + 2) << (kind->precision - 1);
}

static inline void decimal_take_apart(uint64_t bits, const decimal_kind *kind, uint64_t *c, int32_t *q)
{
    uint64_t const one = UINT64_C(1) << (kind->precision - 1);
    int32_t const field = (int32_t)(bits >> (kind->precision - 1));
    *c = field == 0 ? bits : (bits & (one - 1)) | one;
    *q = kind->low_exponent + (field == 0 ? 0 : field - 1);
}

/* ---- D * 10^k against c * 2^q in whole numbers of a fixed size. Only decimal*.c include this ---- */

/* Powers of two that both sides share cancel, the rest go to the side where they are not fractions. The
 * numbers stay below 2^3700: d has at most 771 digits (2562 bits) and k is at least -1116 (see
 * decimal_decide), so c * 5^-k has at most 2592 + 55 bits. The other powers of two keep the sides about
 * equal, unless c * 2^q is half of the smallest float, where they add less than 1116 - 150 bits. */

enum { DECIMAL_LIMBS = 128 };

typedef struct decimal_big {
    uint32_t limb[DECIMAL_LIMBS]; /* lowest first */
    int32_t count;                /* the highest limb in use is not 0 */
} decimal_big;

static inline void decimal_big_push(decimal_big *a, uint64_t carry)
{
    if (carry != 0 && a->count < DECIMAL_LIMBS) a->limb[a->count++] = (uint32_t)carry;
}

static inline void decimal_big_set(decimal_big *a, uint64_t v)
{
    a->count = 0;
    if (v != 0) a->limb[a->count++] = (uint32_t)(v & 0xffffffffu);
    decimal_big_push(a, v >> 32);
}

/* a = a * factor + addend */
static inline void decimal_big_mul_add(decimal_big *a, uint32_t factor, uint32_t addend)
{
    uint64_t carry = addend;
    for (int32_t i = 0; i < a->count; i++) {
        carry += (uint64_t)a->limb[i] * factor;
        a->limb[i] = (uint32_t)(carry & 0xffffffffu);
        carry >>= 32;
    }
    decimal_big_push(a, carry);
}

static inline void decimal_big_mul_five(decimal_big *a, int32_t power)
{
    for (; power >= 13; power -= 13) decimal_big_mul_add(a, 1220703125u, 0);
    for (; power > 0; power--) decimal_big_mul_add(a, 5, 0);
}

static inline void decimal_big_shift(decimal_big *a, int32_t bits)
{
    int32_t const whole = bits / 32;
    if (bits % 32 != 0) decimal_big_mul_add(a, UINT32_C(1) << (bits % 32), 0);
    if (whole == 0 || a->count == 0 || a->count + whole > DECIMAL_LIMBS) return;
    memmove(a->limb + whole, a->limb, (size_t)a->count * sizeof a->limb[0]);
    memset(a->limb, 0, (size_t)whole * sizeof a->limb[0]);
    a->count += whole;
}

static inline int32_t decimal_big_order(const decimal_big *a, const decimal_big *b)
{
    if (a->count != b->count) return a->count > b->count ? 1 : -1;
    for (int32_t i = a->count - 1; i >= 0; i--)
        if (a->limb[i] != b->limb[i]) return a->limb[i] > b->limb[i] ? 1 : -1;
    return 0;
}

/* The sign of d * 10^k - c * 2^q; changes both. */
static inline int32_t decimal_big_compare(decimal_big *d, int32_t k, decimal_big *c, int32_t q)
{
    if (k >= 0) decimal_big_mul_five(d, k);
    else decimal_big_mul_five(c, -k);
    if (k >= q) decimal_big_shift(d, k - q);
    else decimal_big_shift(c, q - k);
    return decimal_big_order(d, c);
}

#endif
