/* simd_base.h - the operations of simd.h for every processor. Not installed; simd.h includes it.
 *
 * A vector is an array of elements. In plain C an element is one lane: that says what each operation is, and runs
 * where there are no vectors. With SSE2, NEON or WebAssembly's simd128 an element is one of the
 * compiler's own vectors of 16 bytes, on which the same operators act lane by lane. */
#ifndef BVXI_SIMD_BASE_H
#define BVXI_SIMD_BASE_H

#include "core/core.h"

#include <math.h>

#if BVXI_SIMD_HALVES

#define BVXI_ELEMENT(name, lane) typedef lane name __attribute__((vector_size(16)));
enum { BVXI_IN_FOUR = 2, BVXI_IN_EIGHT = 2, BVXI_IN_BYTES = 2 };

/* result.v[i] = expression for both elements, i a constant, so that no loop is left to be unrolled. */
#define BVXI_EACH(elements, expression) \
    {                                   \
        enum { i = 0 };                 \
        result.v[i] = (expression);     \
    }                                   \
    {                                   \
        enum { i = 1 };                 \
        result.v[i] = (expression);     \
    }

/* Lanes of a mask are all ones or all zeros. */
#define BVXI_CHOOSE(type, mask, m, yes, no) ((type)(((mask)(m) & (mask)(yes)) | (~(mask)(m) & (mask)(no))))
#define BVXI_KEEP(type, mask, m, x)         ((type)((m) & (mask)(x)))
#define BVXI_DROP(type, mask, m, x)         ((type)(~(m) & (mask)(x)))
#define BVXI_ALL_ONES(m)                    (m)
#define BVXI_ALL(type, x)                   ((x) - (type){0})
#define BVXI_LANES(bits, i)                 ((bvxi_m32)(((int32_t)(bits) & (bvxi_m32){1, 2, 4, 8} << 4 * (i)) != 0))
#define BVXI_SIZE_f64(x)                    ((bvxi_f64)((bvxi_m64)(x)&INT64_MAX))
#define BVXI_SIZE_f32(x)                    ((bvxi_f32)((bvxi_m32)(x)&INT32_MAX))

#else

#define BVXI_ELEMENT(name, lane) typedef lane name;
enum { BVXI_IN_FOUR = 4, BVXI_IN_EIGHT = 8, BVXI_IN_BYTES = 32 };
#define BVXI_EACH(elements, expression) \
    for (int i = 0; i < (elements); i++) result.v[i] = (expression);

/* Lanes of a mask are 1 or 0. */
#define BVXI_CHOOSE(type, mask, m, yes, no) ((m) ? (yes) : (no))
#define BVXI_KEEP(type, mask, m, x)         ((m) ? (x) : 0)
#define BVXI_DROP(type, mask, m, x)         ((m) ? 0 : (x))
#define BVXI_ALL_ONES(m)                    -(m)
#define BVXI_ALL(type, x)                   (x)
#define BVXI_LANES(bits, i)                 (int32_t)((bits) >> (i)&1)
#define BVXI_SIZE_f64(x)                    bvxi_absolute(x)
#define BVXI_SIZE_f32(x)                    ((float)bvxi_absolute((double)(x)))
#define BVXI_SQRT_f64(x)                    sqrt(x)
#define BVXI_SQRT_f32(x)                    ((float)sqrt((double)(x)))
#define BVXI_BITS_f64(m)                    (uint32_t)(m)
#define BVXI_BITS_f32(m)                    (uint32_t)(m)

#endif

BVXI_ELEMENT(bvxi_f64, double)
BVXI_ELEMENT(bvxi_f32, float)
BVXI_ELEMENT(bvxi_m64, int64_t)
BVXI_ELEMENT(bvxi_m32, int32_t)
BVXI_ELEMENT(bvxi_u8, uint8_t)

/* What has no operator: roots, and the bits of a mask. */
#if BVXI_SIMD_HALVES && defined(__wasm_simd128__)
#include <wasm_simd128.h>
#define BVXI_SQRT_f64(x) (bvxi_f64) wasm_f64x2_sqrt((v128_t)(x))
#define BVXI_SQRT_f32(x) (bvxi_f32) wasm_f32x4_sqrt((v128_t)(x))
#define BVXI_BITS_f64(m) (uint32_t) wasm_i64x2_bitmask((v128_t)(m))
#define BVXI_BITS_f32(m) (uint32_t) wasm_i32x4_bitmask((v128_t)(m))
#elif BVXI_SIMD_HALVES && defined(__SSE2__)
#include <immintrin.h>
#define BVXI_SQRT_f64(x) (bvxi_f64) _mm_sqrt_pd((__m128d)(x))
#define BVXI_SQRT_f32(x) (bvxi_f32) _mm_sqrt_ps((__m128)(x))
#define BVXI_BITS_f64(m) (uint32_t) _mm_movemask_pd((__m128d)(m))
#define BVXI_BITS_f32(m) (uint32_t) _mm_movemask_ps((__m128)(m))
#elif BVXI_SIMD_HALVES
#include <arm_neon.h>
#define BVXI_SQRT_f64(x) (bvxi_f64) vsqrtq_f64((float64x2_t)(x))
#define BVXI_SQRT_f32(x) (bvxi_f32) vsqrtq_f32((float32x4_t)(x))
#define BVXI_BITS_f64(m) ((uint32_t)((m)[0] & 1) | (uint32_t)((m)[1] & 2))
#define BVXI_BITS_f32(m) vaddvq_u32(vandq_u32((uint32x4_t)(m), (uint32x4_t){1, 2, 4, 8}))
#endif

#define BVXI_BASE(name, type, elements, parameters, expression) \
    BVXI_VECTOR_INLINE type name parameters                     \
    {                                                           \
        type result;                                            \
        BVXI_EACH(elements, expression)                         \
        return result;                                          \
    }

/* Operations that read alike for both widths; n elements of that many lanes. */
#define BVXI_BASE_OPERATIONS(width, n, lane, kind, mkind)                                           \
    typedef struct width##_base {                                                                   \
        bvxi_##kind v[n];                                                                           \
    } width##_base;                                                                                 \
    typedef struct width##_mask_base {                                                              \
        bvxi_##mkind v[n];                                                                          \
    } width##_mask_base;                                                                            \
    BVXI_BASE(width##_all_base, width##_base, n, (lane x), BVXI_ALL(bvxi_##kind, x))                \
    BVXI_VECTOR_INLINE bvxi_##kind width##_element(const lane *from)                                \
    {                                                                                               \
        bvxi_##kind x;                                                                              \
        memcpy(&x, from, sizeof x);                                                                 \
        return x;                                                                                   \
    }                                                                                               \
    BVXI_BASE(width##_load_base, width##_base, n, (const lane *from),                               \
              width##_element(from + (size_t)i * (sizeof(bvxi_##kind) / sizeof(lane))))             \
    BVXI_VECTOR_INLINE void width##_store_base(lane *to, width##_base x)                            \
    {                                                                                               \
        memcpy(to, &x, sizeof x);                                                                   \
    }                                                                                               \
    BVXI_BASE(width##_add_base, width##_base, n, (width##_base x, width##_base y), x.v[i] + y.v[i]) \
    BVXI_BASE(width##_sub_base, width##_base, n, (width##_base x, width##_base y), x.v[i] - y.v[i]) \
    BVXI_BASE(width##_mul_base, width##_base, n, (width##_base x, width##_base y), x.v[i] * y.v[i]) \
    BVXI_BASE(width##_div_base, width##_base, n, (width##_base x, width##_base y), x.v[i] / y.v[i]) \
    BVXI_BASE(width##_max_base, width##_base, n, (width##_base x, width##_base y),                  \
              BVXI_CHOOSE(bvxi_##kind, bvxi_##mkind, x.v[i] > y.v[i], x.v[i], y.v[i]))              \
    BVXI_BASE(width##_sqrt_base, width##_base, n, (width##_base x), BVXI_SQRT_##kind(x.v[i]))       \
    BVXI_BASE(width##_size_base, width##_base, n, (width##_base x), BVXI_SIZE_##kind(x.v[i]))       \
    BVXI_BASE(width##_less_base, width##_mask_base, n, (width##_base x, width##_base y),            \
              (bvxi_##mkind)(x.v[i] < y.v[i]))                                                      \
    BVXI_BASE(width##_less_equal_base, width##_mask_base, n, (width##_base x, width##_base y),      \
              (bvxi_##mkind)(x.v[i] <= y.v[i]))                                                     \
    BVXI_BASE(width##_equal_base, width##_mask_base, n, (width##_base x, width##_base y),           \
              (bvxi_##mkind)(x.v[i] == y.v[i]))                                                     \
    BVXI_BASE(width##_and_base, width##_mask_base, n, (width##_mask_base m, width##_mask_base k),   \
              m.v[i] & k.v[i])                                                                      \
    BVXI_BASE(width##_or_base, width##_mask_base, n, (width##_mask_base m, width##_mask_base k),    \
              m.v[i] | k.v[i])                                                                      \
    BVXI_BASE(width##_but_base, width##_mask_base, n, (width##_mask_base m, width##_mask_base k),   \
              m.v[i] & ~k.v[i])                                                                     \
    BVXI_BASE(width##_choose_base, width##_base, n,                                                 \
              (width##_mask_base m, width##_base yes, width##_base no),                             \
              BVXI_CHOOSE(bvxi_##kind, bvxi_##mkind, m.v[i], yes.v[i], no.v[i]))                    \
    BVXI_BASE(width##_keep_base, width##_base, n, (width##_mask_base m, width##_base x),            \
              BVXI_KEEP(bvxi_##kind, bvxi_##mkind, m.v[i], x.v[i]))                                 \
    BVXI_BASE(width##_drop_base, width##_base, n, (width##_mask_base m, width##_base x),            \
              BVXI_DROP(bvxi_##kind, bvxi_##mkind, m.v[i], x.v[i]))                                 \
    BVXI_VECTOR_INLINE uint32_t width##_bits_base(width##_mask_base m)                              \
    {                                                                                               \
        uint32_t bits = 0;                                                                          \
        for (int i = 0; i < (n); i++)                                                               \
            bits |= BVXI_BITS_##kind(m.v[i]) << i * (int)(sizeof m.v[0] / sizeof(lane));            \
        return bits;                                                                                \
    }

BVXI_BASE_OPERATIONS(bvxi_four, BVXI_IN_FOUR, double, f64, m64)
BVXI_BASE_OPERATIONS(bvxi_eight, BVXI_IN_EIGHT, float, f32, m32)
BVXI_BASE(bvxi_four_choose_mask_base, bvxi_four_mask_base, BVXI_IN_FOUR,
          (bvxi_four_mask_base m, bvxi_four_mask_base yes, bvxi_four_mask_base no),
          BVXI_CHOOSE(bvxi_m64, bvxi_m64, m.v[i], yes.v[i], no.v[i]))
BVXI_BASE(bvxi_eight_min_base, bvxi_eight_base, BVXI_IN_EIGHT, (bvxi_eight_base x, bvxi_eight_base y),
          BVXI_CHOOSE(bvxi_f32, bvxi_m32, x.v[i] < y.v[i], x.v[i], y.v[i]))

BVXI_VECTOR_INLINE float bvxi_eight_least_base(bvxi_eight_base x)
{
    float y[8];
    bvxi_eight_store_base(y, x);
    for (int half = 4; half > 0; half /= 2)
        for (int i = 0; i < half; i++) y[i] = y[i] < y[i + half] ? y[i] : y[i + half];
    return y[0];
}

BVXI_VECTOR_INLINE bvxi_eight_mask_base bvxi_eight_lanes_base(uint32_t bits)
{
    bvxi_eight_mask_base result;
    BVXI_EACH(BVXI_IN_EIGHT, BVXI_LANES(bits, i))
    return result;
}

BVXI_VECTOR_INLINE double bvxi_four_first_base(bvxi_four_base x)
{
    double first;
    memcpy(&first, &x, sizeof first);
    return first;
}

BVXI_VECTOR_INLINE bvxi_eight_base bvxi_eight_load_bytes_base(const uint8_t *from)
{
    bvxi_eight_base x;
    memcpy(&x, from, sizeof x);
    return x;
}

BVXI_VECTOR_INLINE bvxi_eight_base bvxi_eight_load_two_base(const float *low, const float *high)
{
    bvxi_eight_base x;
    memcpy(&x, low, 4 * sizeof *low);
    memcpy((char *)&x + 4 * sizeof *low, high, 4 * sizeof *high);
    return x;
}

BVXI_VECTOR_INLINE void bvxi_eight_columns_base(const bvxi_eight_base row[8], void *to, size_t stride)
{
    float lane[8][8];
    for (size_t i = 0; i < 8; i++) bvxi_eight_store_base(lane[i], row[i]);
    for (size_t k = 0; k < 8; k++) {
        float column[8];
        for (size_t i = 0; i < 8; i++) column[i] = lane[i][k];
        memcpy((char *)to + k * stride, column, sizeof column);
    }
}

/* ---- Bytes ---- */

typedef struct bvxi_bytes_base {
    bvxi_u8 v[BVXI_IN_BYTES];
} bvxi_bytes_base;

#define BVXI_BYTES(name, parameters, expression) \
    BVXI_BASE(bvxi_bytes_##name##_base, bvxi_bytes_base, BVXI_IN_BYTES, parameters, (bvxi_u8)(expression))

BVXI_BYTES(all, (uint8_t x), BVXI_ALL(bvxi_u8, x))
BVXI_BYTES(add, (bvxi_bytes_base x, bvxi_bytes_base y), x.v[i] + y.v[i])
BVXI_BYTES(sub, (bvxi_bytes_base x, bvxi_bytes_base y), x.v[i] - y.v[i])
BVXI_BYTES(and, (bvxi_bytes_base x, bvxi_bytes_base y), x.v[i] & y.v[i])
BVXI_BYTES(or, (bvxi_bytes_base x, bvxi_bytes_base y), x.v[i] | y.v[i])
BVXI_BYTES(at_most, (bvxi_bytes_base x, bvxi_bytes_base y), BVXI_ALL_ONES(x.v[i] <= y.v[i]))

BVXI_VECTOR_INLINE bvxi_bytes_base bvxi_bytes_load_base(const uint8_t *from)
{
    bvxi_bytes_base x;
    memcpy(&x, from, sizeof x);
    return x;
}

/* Word i of 32 is byte i of each of eight rows. */
#if BVXI_SIMD_HALVES
typedef int16_t bvxi_m16 __attribute__((vector_size(16)));
#if defined(__clang__)
#define BVXI_SHUFFLE(type, x, y, ...) ((bvxi_u8)__builtin_shufflevector((type)(x), (type)(y), __VA_ARGS__))
#else
#define BVXI_SHUFFLE(type, x, y, ...) ((bvxi_u8)__builtin_shuffle((type)(x), (type)(y), (type){__VA_ARGS__}))
#endif
#define BVXI_LOW_8(x, y) BVXI_SHUFFLE(bvxi_u8, x, y, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23)
#define BVXI_HIGH_8(x, y) \
    BVXI_SHUFFLE(bvxi_u8, x, y, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31)
#define BVXI_LOW_16(x, y)  BVXI_SHUFFLE(bvxi_m16, x, y, 0, 8, 1, 9, 2, 10, 3, 11)
#define BVXI_HIGH_16(x, y) BVXI_SHUFFLE(bvxi_m16, x, y, 4, 12, 5, 13, 6, 14, 7, 15)
#define BVXI_LOW_32(x, y)  BVXI_SHUFFLE(bvxi_m32, x, y, 0, 4, 1, 5)
#define BVXI_HIGH_32(x, y) BVXI_SHUFFLE(bvxi_m32, x, y, 2, 6, 3, 7)

BVXI_VECTOR_INLINE void bvxi_bytes_words_base(const bvxi_bytes_base row[8], uint64_t *to)
{
    for (int half = 0; half < 2; half++, to += 16) {
        bvxi_u8 pair[8], four[8];

        /* Bytes of two rows side by side, then of four, then of eight: a word. */
        for (int i = 0; i < 4; i++) {
            pair[2 * i] = BVXI_LOW_8(row[2 * i].v[half], row[2 * i + 1].v[half]);
            pair[2 * i + 1] = BVXI_HIGH_8(row[2 * i].v[half], row[2 * i + 1].v[half]);
        }
        for (int i = 0; i < 2; i++)
            for (int h = 0; h < 2; h++) {
                four[4 * i + 2 * h] = BVXI_LOW_16(pair[4 * i + h], pair[4 * i + 2 + h]);
                four[4 * i + 2 * h + 1] = BVXI_HIGH_16(pair[4 * i + h], pair[4 * i + 2 + h]);
            }
        for (int i = 0; i < 4; i++) {
            bvxi_u8 const words[2] = {BVXI_LOW_32(four[i], four[4 + i]), BVXI_HIGH_32(four[i], four[4 + i])};
            memcpy(to + 4 * i, words, sizeof words);
        }
    }
}
#else
BVXI_VECTOR_INLINE void bvxi_bytes_words_base(const bvxi_bytes_base row[8], uint64_t *to)
{
    for (int i = 0; i < 32; i++) {
        to[i] = 0;
        for (int r = 0; r < 8; r++) to[i] |= (uint64_t)row[r].v[i] << 8 * r;
    }
}
#endif

#endif
