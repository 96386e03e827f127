/* exact.h - signs of sums of products in whole numbers of 192 bits, by
 * schoolbook arithmetic, for oracles in tests. */
#ifndef EXACT_H
#define EXACT_H

#include <stdint.h>
#include <string.h>

enum { EXACT_DIGITS = 6 };

/* Two's complement, lowest 32 bits first. */
typedef struct exact_number {
    uint32_t digit[EXACT_DIGITS];
} exact_number;

static inline exact_number exact_of(int64_t v)
{
    exact_number r;
    for (int i = 0; i < EXACT_DIGITS; i++)
        r.digit[i] = i < 2 ? (uint32_t)((uint64_t)v >> 32 * i) : v < 0 ? UINT32_MAX : 0;
    return r;
}

static inline exact_number exact_add(exact_number a, exact_number b)
{
    exact_number r;
    uint64_t carry = 0;

    for (int i = 0; i < EXACT_DIGITS; i++) {
        carry += (uint64_t)a.digit[i] + b.digit[i];
        r.digit[i] = (uint32_t)carry;
        carry >>= 32;
    }
    return r;
}

/* Modulo 2^192, which is right for two's complement numbers of any sign. */
static inline exact_number exact_mul(exact_number a, exact_number b)
{
    exact_number r = {{0}};

    for (int i = 0; i < EXACT_DIGITS; i++) {
        uint64_t carry = 0;
        for (int k = 0; i + k < EXACT_DIGITS; k++) {
            carry += (uint64_t)a.digit[i] * b.digit[k] + r.digit[i + k];
            r.digit[i + k] = (uint32_t)carry;
            carry >>= 32;
        }
    }
    return r;
}

static inline int exact_sign(exact_number a)
{
    if (a.digit[EXACT_DIGITS - 1] >> 31) return -1;
    for (int i = 0; i < EXACT_DIGITS; i++)
        if (a.digit[i] != 0) return 1;
    return 0;
}

/* Sign of a0 b0 + a1 b1 + a2 b2. */
static inline int exact_sign_of_sum(int64_t a0, int64_t b0, int64_t a1, int64_t b1, int64_t a2, int64_t b2)
{
    int64_t const few = INT64_C(1) << 30;

    if (a0 < few && a0 > -few && a1 < few && a1 > -few && a2 < few && a2 > -few && b0 < few && b0 > -few &&
        b1 < few && b1 > -few && b2 < few && b2 > -few) { /* products below 2^60, 2^62 in sum */
        int64_t const s = a0 * b0 + a1 * b1 + a2 * b2;
        return (s > 0) - (s < 0);
    }
#if defined(__SIZEOF_INT128__) && !defined(EXACT_PLAIN)
    int64_t const most = INT64_C(1) << 60; /* products below 2^123, 2^125 in sum */
    if (a0 < most && a0 > -most && a1 < most && a1 > -most && a2 < most && a2 > -most) {
        __extension__ typedef __int128 exact_wide;
        exact_wide const s = (exact_wide)a0 * b0 + (exact_wide)a1 * b1 + (exact_wide)a2 * b2;
        return (s > 0) - (s < 0);
    }
#endif
    return exact_sign(
        exact_add(exact_add(exact_mul(exact_of(a0), exact_of(b0)), exact_mul(exact_of(a1), exact_of(b1))),
                  exact_mul(exact_of(a2), exact_of(b2))));
}

#endif
