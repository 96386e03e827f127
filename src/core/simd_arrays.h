/* simd_arrays.h - the operations of simd.h in plain C: they define what each operation is, and run where
 * there are no vectors. Not installed; simd.h includes it. */
#ifndef BVXI_SIMD_ARRAYS_H
#define BVXI_SIMD_ARRAYS_H

#include "core/core.h"

#include <math.h>

typedef struct bvxi_four_base {
    double v[4];
} bvxi_four_base;

typedef struct bvxi_four_mask_base {
    int64_t set[4]; /* 1 or 0 */
} bvxi_four_mask_base;

typedef struct bvxi_eight_base {
    float v[8];
} bvxi_eight_base;

typedef struct bvxi_eight_mask_base {
    int32_t set[8];
} bvxi_eight_mask_base;

/* result.field[i] = expression, for each lane i. */
#define BVXI_SIMD_EACH(name, lanes, type, field, parameters, expression)  \
    BVXI_VECTOR_INLINE type name parameters                               \
    {                                                                     \
        type result;                                                      \
        for (int i = 0; i < (lanes); i++) result.field[i] = (expression); \
        return result;                                                    \
    }

/* Operations on vectors that read alike for both widths; root is a square root rounded to the lane's type. */
#define BVXI_SIMD_ARRAYS(width, lanes, lane, root)                                                           \
    BVXI_SIMD_EACH(width##_all_base, lanes, width##_base, v, (lane x), x)                                    \
    BVXI_SIMD_EACH(width##_load_base, lanes, width##_base, v, (const lane *from), from[i])                   \
    BVXI_SIMD_EACH(width##_add_base, lanes, width##_base, v, (width##_base x, width##_base y),               \
                   x.v[i] + y.v[i])                                                                          \
    BVXI_SIMD_EACH(width##_sub_base, lanes, width##_base, v, (width##_base x, width##_base y),               \
                   x.v[i] - y.v[i])                                                                          \
    BVXI_SIMD_EACH(width##_mul_base, lanes, width##_base, v, (width##_base x, width##_base y),               \
                   x.v[i] * y.v[i])                                                                          \
    BVXI_SIMD_EACH(width##_div_base, lanes, width##_base, v, (width##_base x, width##_base y),               \
                   x.v[i] / y.v[i])                                                                          \
    BVXI_SIMD_EACH(width##_max_base, lanes, width##_base, v, (width##_base x, width##_base y),               \
                   x.v[i] > y.v[i] ? x.v[i] : y.v[i])                                                        \
    BVXI_SIMD_EACH(width##_sqrt_base, lanes, width##_base, v, (width##_base x), root)                        \
    BVXI_SIMD_EACH(width##_less_base, lanes, width##_mask_base, set, (width##_base x, width##_base y),       \
                   x.v[i] < y.v[i])                                                                          \
    BVXI_SIMD_EACH(width##_less_equal_base, lanes, width##_mask_base, set, (width##_base x, width##_base y), \
                   x.v[i] <= y.v[i])                                                                         \
    BVXI_SIMD_EACH(width##_equal_base, lanes, width##_mask_base, set, (width##_base x, width##_base y),      \
                   x.v[i] == y.v[i])                                                                         \
    BVXI_SIMD_EACH(width##_and_base, lanes, width##_mask_base, set,                                          \
                   (width##_mask_base m, width##_mask_base n), m.set[i] & n.set[i])                          \
    BVXI_SIMD_EACH(width##_or_base, lanes, width##_mask_base, set,                                           \
                   (width##_mask_base m, width##_mask_base n), m.set[i] | n.set[i])                          \
    BVXI_SIMD_EACH(width##_but_base, lanes, width##_mask_base, set,                                          \
                   (width##_mask_base m, width##_mask_base n), m.set[i] & (n.set[i] ^ 1))                    \
    BVXI_SIMD_EACH(width##_choose_base, lanes, width##_base, v,                                              \
                   (width##_mask_base m, width##_base yes, width##_base no), m.set[i] ? yes.v[i] : no.v[i])  \
    BVXI_SIMD_EACH(width##_keep_base, lanes, width##_base, v, (width##_mask_base m, width##_base x),         \
                   m.set[i] ? x.v[i] : 0)                                                                    \
    BVXI_SIMD_EACH(width##_drop_base, lanes, width##_base, v, (width##_mask_base m, width##_base x),         \
                   m.set[i] ? 0 : x.v[i])                                                                    \
    BVXI_VECTOR_INLINE void width##_store_base(lane *to, width##_base x)                                     \
    {                                                                                                        \
        memcpy(to, x.v, sizeof x.v);                                                                         \
    }                                                                                                        \
    BVXI_VECTOR_INLINE uint32_t width##_bits_base(width##_mask_base m)                                       \
    {                                                                                                        \
        uint32_t bits = 0;                                                                                   \
        for (int i = 0; i < (lanes); i++) bits |= (uint32_t)m.set[i] << i;                                   \
        return bits;                                                                                         \
    }

BVXI_SIMD_ARRAYS(bvxi_four, 4, double, sqrt(x.v[i]))
BVXI_SIMD_ARRAYS(bvxi_eight, 8, float, (float)sqrt((double)x.v[i]))
BVXI_SIMD_EACH(bvxi_four_size_base, 4, bvxi_four_base, v, (bvxi_four_base x), bvxi_absolute(x.v[i]))
BVXI_SIMD_EACH(bvxi_four_choose_mask_base, 4, bvxi_four_mask_base, set,
               (bvxi_four_mask_base m, bvxi_four_mask_base yes, bvxi_four_mask_base no),
               m.set[i] ? yes.set[i] : no.set[i])
BVXI_SIMD_EACH(bvxi_eight_min_base, 8, bvxi_eight_base, v, (bvxi_eight_base x, bvxi_eight_base y),
               x.v[i] < y.v[i] ? x.v[i] : y.v[i])

BVXI_SIMD_EACH(bvxi_eight_size_base, 8, bvxi_eight_base, v, (bvxi_eight_base x),
               (float)bvxi_absolute((double)x.v[i]))
BVXI_SIMD_EACH(bvxi_eight_lanes_base, 8, bvxi_eight_mask_base, set, (uint32_t bits), (int32_t)(bits >> i & 1))

BVXI_VECTOR_INLINE float bvxi_eight_least_base(bvxi_eight_base x)
{
    for (int half = 4; half > 0; half /= 2)
        for (int i = 0; i < half; i++) x.v[i] = x.v[i] < x.v[i + half] ? x.v[i] : x.v[i + half];
    return x.v[0];
}

BVXI_VECTOR_INLINE double bvxi_four_first_base(bvxi_four_base x)
{
    return x.v[0];
}

BVXI_VECTOR_INLINE bvxi_eight_base bvxi_eight_load_bytes_base(const uint8_t *from)
{
    bvxi_eight_base x;
    memcpy(x.v, from, sizeof x.v);
    return x;
}

BVXI_VECTOR_INLINE bvxi_eight_base bvxi_eight_load_two_base(const float *low, const float *high)
{
    bvxi_eight_base x;
    memcpy(x.v, low, 4 * sizeof *low);
    memcpy(x.v + 4, high, 4 * sizeof *high);
    return x;
}

BVXI_VECTOR_INLINE void bvxi_eight_columns_base(const bvxi_eight_base row[8], void *to, size_t stride)
{
    for (size_t k = 0; k < 8; k++) {
        float column[8];

        for (size_t i = 0; i < 8; i++) column[i] = row[i].v[k];
        memcpy((char *)to + k * stride, column, sizeof column);
    }
}

/* ---- Bytes ---- */

typedef struct bvxi_bytes_base {
    uint8_t v[32];
} bvxi_bytes_base;

#define BVXI_BYTES_EACH(name, parameters, expression) \
    BVXI_SIMD_EACH(bvxi_bytes_##name##_base, 32, bvxi_bytes_base, v, parameters, (uint8_t)(expression))

BVXI_BYTES_EACH(all, (uint8_t x), x)
BVXI_BYTES_EACH(load, (const uint8_t *from), from[i])
BVXI_BYTES_EACH(add, (bvxi_bytes_base x, bvxi_bytes_base y), x.v[i] + y.v[i])
BVXI_BYTES_EACH(sub, (bvxi_bytes_base x, bvxi_bytes_base y), x.v[i] - y.v[i])
BVXI_BYTES_EACH(and, (bvxi_bytes_base x, bvxi_bytes_base y), x.v[i] & y.v[i])
BVXI_BYTES_EACH(or, (bvxi_bytes_base x, bvxi_bytes_base y), x.v[i] | y.v[i])
BVXI_BYTES_EACH(at_most, (bvxi_bytes_base x, bvxi_bytes_base y), x.v[i] <= y.v[i] ? 255 : 0)

BVXI_VECTOR_INLINE void bvxi_bytes_words_base(const bvxi_bytes_base row[8], uint64_t *to)
{
    for (int i = 0; i < 32; i++) {
        to[i] = 0;
        for (int r = 0; r < 8; r++) to[i] |= (uint64_t)row[r].v[i] << 8 * r;
    }
}

#endif
