/* simd_halves.h - the operations of simd.h as two vectors of 16 bytes: NEON and WebAssembly's simd128. Not
 * installed; simd.h includes it.
 *
 * NEON's own maximum orders zeros and gives no number where there is one, so a comparison and a choice stand
 * in its place; simd128 has a maximum of the wanted kind, whose operands are turned. */
#ifndef BVXI_SIMD_HALVES_H
#define BVXI_SIMD_HALVES_H

#include "core/core.h"

#if defined(__wasm_simd128__)
#include <wasm_simd128.h>

typedef v128_t bvxi_half_f64, bvxi_half_f32, bvxi_half_m64, bvxi_half_m32, bvxi_half_u8;

/* Names of one operation on two doubles and on four floats. */
#define BVXI_HALF_all_f64       wasm_f64x2_splat
#define BVXI_HALF_all_f32       wasm_f32x4_splat
#define BVXI_HALF_load_f64      wasm_v128_load
#define BVXI_HALF_load_f32      wasm_v128_load
#define BVXI_HALF_store_f64     wasm_v128_store
#define BVXI_HALF_store_f32     wasm_v128_store
#define BVXI_HALF_add_f64       wasm_f64x2_add
#define BVXI_HALF_add_f32       wasm_f32x4_add
#define BVXI_HALF_sub_f64       wasm_f64x2_sub
#define BVXI_HALF_sub_f32       wasm_f32x4_sub
#define BVXI_HALF_mul_f64       wasm_f64x2_mul
#define BVXI_HALF_mul_f32       wasm_f32x4_mul
#define BVXI_HALF_div_f64       wasm_f64x2_div
#define BVXI_HALF_div_f32       wasm_f32x4_div
#define BVXI_HALF_max_f64(x, y) wasm_f64x2_pmax(y, x)
#define BVXI_HALF_max_f32(x, y) wasm_f32x4_pmax(y, x)
#define BVXI_HALF_min_f32(x, y) wasm_f32x4_pmin(y, x)
#define BVXI_HALF_sqrt_f64      wasm_f64x2_sqrt
#define BVXI_HALF_sqrt_f32      wasm_f32x4_sqrt
#define BVXI_HALF_size_f64      wasm_f64x2_abs
#define BVXI_HALF_size_f32      wasm_f32x4_abs
#define BVXI_HALF_lanes(bits, a, b, c, d)                                                        \
    wasm_i32x4_ne(wasm_v128_and(wasm_i32x4_splat((int32_t)(bits)), wasm_i32x4_make(a, b, c, d)), \
                  wasm_i32x4_splat(0))
#define BVXI_HALF_less_f64               wasm_f64x2_lt
#define BVXI_HALF_less_f32               wasm_f32x4_lt
#define BVXI_HALF_less_equal_f64         wasm_f64x2_le
#define BVXI_HALF_less_equal_f32         wasm_f32x4_le
#define BVXI_HALF_equal_f64              wasm_f64x2_eq
#define BVXI_HALF_equal_f32              wasm_f32x4_eq
#define BVXI_HALF_and_f64                wasm_v128_and
#define BVXI_HALF_and_f32                wasm_v128_and
#define BVXI_HALF_or_f64                 wasm_v128_or
#define BVXI_HALF_or_f32                 wasm_v128_or
#define BVXI_HALF_but_f64                wasm_v128_andnot
#define BVXI_HALF_but_f32                wasm_v128_andnot
#define BVXI_HALF_choose_f64(m, yes, no) wasm_v128_bitselect(yes, no, m)
#define BVXI_HALF_choose_m64(m, yes, no) wasm_v128_bitselect(yes, no, m)
#define BVXI_HALF_choose_f32(m, yes, no) wasm_v128_bitselect(yes, no, m)
#define BVXI_HALF_keep_f64(m, x)         wasm_v128_and(x, m)
#define BVXI_HALF_keep_f32(m, x)         wasm_v128_and(x, m)
#define BVXI_HALF_drop_f64(m, x)         wasm_v128_andnot(x, m)
#define BVXI_HALF_drop_f32(m, x)         wasm_v128_andnot(x, m)
#define BVXI_HALF_bits_f64(m)            ((uint32_t)wasm_i64x2_bitmask(m))
#define BVXI_HALF_bits_f32(m)            ((uint32_t)wasm_i32x4_bitmask(m))
#define BVXI_HALF_first_f64(x)           wasm_f64x2_extract_lane(x, 0)
#define BVXI_HALF_load_bytes             wasm_v128_load

/* Bytes; of two vectors by turns: bytes, pairs and fours of the low and of the high half. */
#define BVXI_HALF_all_u8(x)   wasm_i8x16_splat((int8_t)(x))
#define BVXI_HALF_load_u8     wasm_v128_load
#define BVXI_HALF_store_u64   wasm_v128_store
#define BVXI_HALF_add_u8      wasm_i8x16_add
#define BVXI_HALF_sub_u8      wasm_i8x16_sub
#define BVXI_HALF_and_u8      wasm_v128_and
#define BVXI_HALF_or_u8       wasm_v128_or
#define BVXI_HALF_at_most_u8  wasm_u8x16_le
#define BVXI_HALF_low_8(x, y) wasm_i8x16_shuffle(x, y, 0, 16, 1, 17, 2, 18, 3, 19, 4, 20, 5, 21, 6, 22, 7, 23)
#define BVXI_HALF_high_8(x, y) \
    wasm_i8x16_shuffle(x, y, 8, 24, 9, 25, 10, 26, 11, 27, 12, 28, 13, 29, 14, 30, 15, 31)
#define BVXI_HALF_low_16(x, y)  wasm_i16x8_shuffle(x, y, 0, 8, 1, 9, 2, 10, 3, 11)
#define BVXI_HALF_high_16(x, y) wasm_i16x8_shuffle(x, y, 4, 12, 5, 13, 6, 14, 7, 15)
#define BVXI_HALF_low_32(x, y)  wasm_i32x4_shuffle(x, y, 0, 4, 1, 5)
#define BVXI_HALF_high_32(x, y) wasm_i32x4_shuffle(x, y, 2, 6, 3, 7)

#else
#include <arm_neon.h>

typedef float64x2_t bvxi_half_f64;
typedef float32x4_t bvxi_half_f32;
typedef uint64x2_t bvxi_half_m64;
typedef uint32x4_t bvxi_half_m32;
typedef uint8x16_t bvxi_half_u8;

#define BVXI_HALF_all_f64                 vdupq_n_f64
#define BVXI_HALF_all_f32                 vdupq_n_f32
#define BVXI_HALF_load_f64                vld1q_f64
#define BVXI_HALF_load_f32                vld1q_f32
#define BVXI_HALF_store_f64               vst1q_f64
#define BVXI_HALF_store_f32               vst1q_f32
#define BVXI_HALF_add_f64                 vaddq_f64
#define BVXI_HALF_add_f32                 vaddq_f32
#define BVXI_HALF_sub_f64                 vsubq_f64
#define BVXI_HALF_sub_f32                 vsubq_f32
#define BVXI_HALF_mul_f64                 vmulq_f64
#define BVXI_HALF_mul_f32                 vmulq_f32
#define BVXI_HALF_div_f64                 vdivq_f64
#define BVXI_HALF_div_f32                 vdivq_f32
#define BVXI_HALF_max_f64(x, y)           vbslq_f64(vcgtq_f64(x, y), x, y)
#define BVXI_HALF_max_f32(x, y)           vbslq_f32(vcgtq_f32(x, y), x, y)
#define BVXI_HALF_min_f32(x, y)           vbslq_f32(vcltq_f32(x, y), x, y)
#define BVXI_HALF_sqrt_f64                vsqrtq_f64
#define BVXI_HALF_sqrt_f32                vsqrtq_f32
#define BVXI_HALF_size_f64                vabsq_f64
#define BVXI_HALF_size_f32                vabsq_f32
#define BVXI_HALF_lanes(bits, a, b, c, d) vtstq_u32(vdupq_n_u32(bits), (uint32x4_t){a, b, c, d})
#define BVXI_HALF_less_f64                vcltq_f64
#define BVXI_HALF_less_f32                vcltq_f32
#define BVXI_HALF_less_equal_f64          vcleq_f64
#define BVXI_HALF_less_equal_f32          vcleq_f32
#define BVXI_HALF_equal_f64               vceqq_f64
#define BVXI_HALF_equal_f32               vceqq_f32
#define BVXI_HALF_and_f64                 vandq_u64
#define BVXI_HALF_and_f32                 vandq_u32
#define BVXI_HALF_or_f64                  vorrq_u64
#define BVXI_HALF_or_f32                  vorrq_u32
#define BVXI_HALF_but_f64                 vbicq_u64
#define BVXI_HALF_but_f32                 vbicq_u32
#define BVXI_HALF_choose_f64              vbslq_f64
#define BVXI_HALF_choose_m64              vbslq_u64
#define BVXI_HALF_choose_f32              vbslq_f32
#define BVXI_HALF_keep_f64(m, x)          vreinterpretq_f64_u64(vandq_u64(m, vreinterpretq_u64_f64(x)))
#define BVXI_HALF_keep_f32(m, x)          vreinterpretq_f32_u32(vandq_u32(m, vreinterpretq_u32_f32(x)))
#define BVXI_HALF_drop_f64(m, x)          vreinterpretq_f64_u64(vbicq_u64(vreinterpretq_u64_f64(x), m))
#define BVXI_HALF_drop_f32(m, x)          vreinterpretq_f32_u32(vbicq_u32(vreinterpretq_u32_f32(x), m))
#define BVXI_HALF_bits_f64(m)             ((uint32_t)((vgetq_lane_u64(m, 0) & 1) | (vgetq_lane_u64(m, 1) & 2)))
#define BVXI_HALF_bits_f32(m)             bvxi_half_bits(m)
#define BVXI_HALF_first_f64(x)            vgetq_lane_f64(x, 0)
#define BVXI_HALF_load_bytes(from)        vreinterpretq_f32_u8(vld1q_u8(from))

#define BVXI_HALF_all_u8           vdupq_n_u8
#define BVXI_HALF_load_u8          vld1q_u8
#define BVXI_HALF_store_u64(to, x) vst1q_u64(to, vreinterpretq_u64_u8(x))
#define BVXI_HALF_add_u8           vaddq_u8
#define BVXI_HALF_sub_u8           vsubq_u8
#define BVXI_HALF_and_u8           vandq_u8
#define BVXI_HALF_or_u8            vorrq_u8
#define BVXI_HALF_at_most_u8       vcleq_u8
#define BVXI_HALF_low_8            vzip1q_u8
#define BVXI_HALF_high_8           vzip2q_u8
#define BVXI_HALF_low_16(x, y) \
    vreinterpretq_u8_u16(vzip1q_u16(vreinterpretq_u16_u8(x), vreinterpretq_u16_u8(y)))
#define BVXI_HALF_high_16(x, y) \
    vreinterpretq_u8_u16(vzip2q_u16(vreinterpretq_u16_u8(x), vreinterpretq_u16_u8(y)))
#define BVXI_HALF_low_32(x, y) \
    vreinterpretq_u8_u32(vzip1q_u32(vreinterpretq_u32_u8(x), vreinterpretq_u32_u8(y)))
#define BVXI_HALF_high_32(x, y) \
    vreinterpretq_u8_u32(vzip2q_u32(vreinterpretq_u32_u8(x), vreinterpretq_u32_u8(y)))

BVXI_VECTOR_INLINE uint32_t bvxi_half_bits(uint32x4_t m)
{
    static const uint32_t lane[4] = {1, 2, 4, 8};
    return vaddvq_u32(vandq_u32(m, vld1q_u32(lane)));
}
#endif

/* ---- Two of them ---- */

typedef struct bvxi_four_base {
    bvxi_half_f64 low, high;
} bvxi_four_base;

typedef struct bvxi_four_mask_base {
    bvxi_half_m64 low, high;
} bvxi_four_mask_base;

typedef struct bvxi_eight_base {
    bvxi_half_f32 low, high;
} bvxi_eight_base;

typedef struct bvxi_eight_mask_base {
    bvxi_half_m32 low, high;
} bvxi_eight_mask_base;

/* Operations of one and of two operands, half by half. */
#define BVXI_HALVES_ONE(result, name, type, operation)          \
    BVXI_VECTOR_INLINE result name##_base(type x)               \
    {                                                           \
        result const r = {operation(x.low), operation(x.high)}; \
        return r;                                               \
    }
#define BVXI_HALVES_TWO(result, name, first, second, operation)                \
    BVXI_VECTOR_INLINE result name##_base(first x, second y)                   \
    {                                                                          \
        result const r = {operation(x.low, y.low), operation(x.high, y.high)}; \
        return r;                                                              \
    }

#define BVXI_HALVES(width, vector, mask, lane, half, kind)                                    \
    BVXI_VECTOR_INLINE vector width##_all_base(lane x)                                        \
    {                                                                                         \
        vector const r = {BVXI_HALF_all_##kind(x), BVXI_HALF_all_##kind(x)};                  \
        return r;                                                                             \
    }                                                                                         \
    BVXI_VECTOR_INLINE vector width##_load_base(const lane *from)                             \
    {                                                                                         \
        vector const r = {BVXI_HALF_load_##kind(from), BVXI_HALF_load_##kind(from + (half))}; \
        return r;                                                                             \
    }                                                                                         \
    BVXI_VECTOR_INLINE void width##_store_base(lane *to, vector x)                            \
    {                                                                                         \
        BVXI_HALF_store_##kind(to, x.low);                                                    \
        BVXI_HALF_store_##kind(to + (half), x.high);                                          \
    }                                                                                         \
    BVXI_VECTOR_INLINE vector width##_choose_base(mask m, vector yes, vector no)              \
    {                                                                                         \
        vector const r = {BVXI_HALF_choose_##kind(m.low, yes.low, no.low),                    \
                          BVXI_HALF_choose_##kind(m.high, yes.high, no.high)};                \
        return r;                                                                             \
    }                                                                                         \
    BVXI_VECTOR_INLINE uint32_t width##_bits_base(mask m)                                     \
    {                                                                                         \
        return BVXI_HALF_bits_##kind(m.low) | BVXI_HALF_bits_##kind(m.high) << (half);        \
    }                                                                                         \
    BVXI_HALVES_ONE(vector, width##_sqrt, vector, BVXI_HALF_sqrt_##kind)                      \
    BVXI_HALVES_TWO(vector, width##_add, vector, vector, BVXI_HALF_add_##kind)                \
    BVXI_HALVES_TWO(vector, width##_sub, vector, vector, BVXI_HALF_sub_##kind)                \
    BVXI_HALVES_TWO(vector, width##_mul, vector, vector, BVXI_HALF_mul_##kind)                \
    BVXI_HALVES_TWO(vector, width##_div, vector, vector, BVXI_HALF_div_##kind)                \
    BVXI_HALVES_TWO(vector, width##_max, vector, vector, BVXI_HALF_max_##kind)                \
    BVXI_HALVES_TWO(mask, width##_less, vector, vector, BVXI_HALF_less_##kind)                \
    BVXI_HALVES_TWO(mask, width##_less_equal, vector, vector, BVXI_HALF_less_equal_##kind)    \
    BVXI_HALVES_TWO(mask, width##_equal, vector, vector, BVXI_HALF_equal_##kind)              \
    BVXI_HALVES_TWO(mask, width##_and, mask, mask, BVXI_HALF_and_##kind)                      \
    BVXI_HALVES_TWO(mask, width##_or, mask, mask, BVXI_HALF_or_##kind)                        \
    BVXI_HALVES_TWO(mask, width##_but, mask, mask, BVXI_HALF_but_##kind)                      \
    BVXI_HALVES_TWO(vector, width##_keep, mask, vector, BVXI_HALF_keep_##kind)                \
    BVXI_HALVES_TWO(vector, width##_drop, mask, vector, BVXI_HALF_drop_##kind)

BVXI_HALVES(bvxi_four, bvxi_four_base, bvxi_four_mask_base, double, 2, f64)
BVXI_HALVES(bvxi_eight, bvxi_eight_base, bvxi_eight_mask_base, float, 4, f32)
BVXI_HALVES_ONE(bvxi_four_base, bvxi_four_size, bvxi_four_base, BVXI_HALF_size_f64)
BVXI_HALVES_TWO(bvxi_eight_base, bvxi_eight_min, bvxi_eight_base, bvxi_eight_base, BVXI_HALF_min_f32)
BVXI_HALVES_ONE(bvxi_eight_base, bvxi_eight_size, bvxi_eight_base, BVXI_HALF_size_f32)

BVXI_VECTOR_INLINE float bvxi_eight_least_base(bvxi_eight_base x)
{
    float y[4];
    BVXI_HALF_store_f32(y, BVXI_HALF_min_f32(x.low, x.high));
    for (int i = 0; i < 2; i++) y[i] = y[i] < y[i + 2] ? y[i] : y[i + 2];
    return y[0] < y[1] ? y[0] : y[1];
}

BVXI_VECTOR_INLINE bvxi_eight_mask_base bvxi_eight_lanes_base(uint32_t bits)
{
    bvxi_eight_mask_base const r = {BVXI_HALF_lanes(bits, 1, 2, 4, 8),
                                    BVXI_HALF_lanes(bits, 16, 32, 64, 128)};
    return r;
}

BVXI_VECTOR_INLINE bvxi_four_mask_base bvxi_four_choose_mask_base(bvxi_four_mask_base m,
                                                                  bvxi_four_mask_base yes,
                                                                  bvxi_four_mask_base no)
{
    bvxi_four_mask_base const r = {BVXI_HALF_choose_m64(m.low, yes.low, no.low),
                                   BVXI_HALF_choose_m64(m.high, yes.high, no.high)};
    return r;
}

BVXI_VECTOR_INLINE double bvxi_four_first_base(bvxi_four_base x)
{
    return BVXI_HALF_first_f64(x.low);
}

BVXI_VECTOR_INLINE bvxi_eight_base bvxi_eight_load_bytes_base(const uint8_t *from)
{
    bvxi_eight_base const r = {BVXI_HALF_load_bytes(from), BVXI_HALF_load_bytes(from + 16)};
    return r;
}

BVXI_VECTOR_INLINE bvxi_eight_base bvxi_eight_load_two_base(const float *low, const float *high)
{
    bvxi_eight_base const r = {BVXI_HALF_load_f32(low), BVXI_HALF_load_f32(high)};
    return r;
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
    bvxi_half_u8 low, high;
} bvxi_bytes_base;

BVXI_HALVES_TWO(bvxi_bytes_base, bvxi_bytes_add, bvxi_bytes_base, bvxi_bytes_base, BVXI_HALF_add_u8)
BVXI_HALVES_TWO(bvxi_bytes_base, bvxi_bytes_sub, bvxi_bytes_base, bvxi_bytes_base, BVXI_HALF_sub_u8)
BVXI_HALVES_TWO(bvxi_bytes_base, bvxi_bytes_and, bvxi_bytes_base, bvxi_bytes_base, BVXI_HALF_and_u8)
BVXI_HALVES_TWO(bvxi_bytes_base, bvxi_bytes_or, bvxi_bytes_base, bvxi_bytes_base, BVXI_HALF_or_u8)
BVXI_HALVES_TWO(bvxi_bytes_base, bvxi_bytes_at_most, bvxi_bytes_base, bvxi_bytes_base, BVXI_HALF_at_most_u8)

BVXI_VECTOR_INLINE bvxi_bytes_base bvxi_bytes_all_base(uint8_t x)
{
    bvxi_bytes_base const r = {BVXI_HALF_all_u8(x), BVXI_HALF_all_u8(x)};
    return r;
}

BVXI_VECTOR_INLINE bvxi_bytes_base bvxi_bytes_load_base(const uint8_t *from)
{
    bvxi_bytes_base const r = {BVXI_HALF_load_u8(from), BVXI_HALF_load_u8(from + 16)};
    return r;
}

/* Word i of 16 is byte i of each of eight rows. */
BVXI_VECTOR_INLINE void bvxi_half_words(const bvxi_half_u8 row[8], uint64_t *to)
{
    bvxi_half_u8 pair[8], four[8];

    /* Bytes of two rows side by side, then of four, then of eight: a word. */
    for (int i = 0; i < 4; i++) {
        pair[2 * i] = BVXI_HALF_low_8(row[2 * i], row[2 * i + 1]);
        pair[2 * i + 1] = BVXI_HALF_high_8(row[2 * i], row[2 * i + 1]);
    }
    for (int i = 0; i < 2; i++)
        for (int h = 0; h < 2; h++) {
            four[4 * i + 2 * h] = BVXI_HALF_low_16(pair[4 * i + h], pair[4 * i + 2 + h]);
            four[4 * i + 2 * h + 1] = BVXI_HALF_high_16(pair[4 * i + h], pair[4 * i + 2 + h]);
        }
    for (int i = 0; i < 4; i++) {
        BVXI_HALF_store_u64(to + 4 * i, BVXI_HALF_low_32(four[i], four[4 + i]));
        BVXI_HALF_store_u64(to + 4 * i + 2, BVXI_HALF_high_32(four[i], four[4 + i]));
    }
}

BVXI_VECTOR_INLINE void bvxi_bytes_words_base(const bvxi_bytes_base row[8], uint64_t *to)
{
    bvxi_half_u8 half[8];

    for (int i = 0; i < 8; i++) half[i] = row[i].low;
    bvxi_half_words(half, to);
    for (int i = 0; i < 8; i++) half[i] = row[i].high;
    bvxi_half_words(half, to + 16);
}

#endif
