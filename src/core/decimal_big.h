/* decimal_big.h - d * 10^k against c * 2^q in whole numbers of a fixed size. Only decimal*.c include this.
 *
 * Powers of two that both sides share cancel, the rest go to the side where they are not fractions. The
 * numbers stay below 2^3700: d has at most 771 digits (2562 bits) and k is at least -1116 (see
 * decimal_decide), so c * 5^-k has at most 2592 + 55 bits. The other powers of two keep the sides about
 * equal, unless c * 2^q is half of the smallest float, where they add less than 1116 - 150 bits. */
#ifndef BVXI_DECIMAL_BIG_H
#define BVXI_DECIMAL_BIG_H

#include "core/core.h"

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
