/* simd_avx2.h - the operations of simd.h in AVX2, for functions marked BVXI_AVX2. Each gives the bits of
 * simd_base.h. Not installed; simd.h includes it. */
#ifndef BVXI_SIMD_AVX2_H
#define BVXI_SIMD_AVX2_H

#include "core/core.h"

#include <immintrin.h>

typedef __m256d bvxi_four_avx2, bvxi_four_mask_avx2;
typedef __m256 bvxi_eight_avx2, bvxi_eight_mask_avx2;
typedef __m256i bvxi_bytes_avx2;

#define BVXI_AVX2_IS(name, type, parameters, expression) \
    BVXI_AVX2 BVXI_VECTOR_INLINE type name parameters    \
    {                                                    \
        return expression;                               \
    }

/* What differs between the two widths is a suffix; maximum takes its second
 * operand for two zeros and where one is no number. */
#define BVXI_AVX2_OPERATIONS(width, vector, lane, suffix)                                                 \
    BVXI_AVX2_IS(width##_all_avx2, vector, (lane x), _mm256_set1_##suffix(x))                             \
    BVXI_AVX2_IS(width##_load_avx2, vector, (const lane *from), _mm256_loadu_##suffix(from))              \
    BVXI_AVX2 BVXI_VECTOR_INLINE void width##_store_avx2(lane *to, vector x)                              \
    {                                                                                                     \
        _mm256_storeu_##suffix(to, x);                                                                    \
    }                                                                                                     \
    BVXI_AVX2_IS(width##_add_avx2, vector, (vector x, vector y), _mm256_add_##suffix(x, y))               \
    BVXI_AVX2_IS(width##_sub_avx2, vector, (vector x, vector y), _mm256_sub_##suffix(x, y))               \
    BVXI_AVX2_IS(width##_mul_avx2, vector, (vector x, vector y), _mm256_mul_##suffix(x, y))               \
    BVXI_AVX2_IS(width##_div_avx2, vector, (vector x, vector y), _mm256_div_##suffix(x, y))               \
    BVXI_AVX2_IS(width##_max_avx2, vector, (vector x, vector y), _mm256_max_##suffix(x, y))               \
    BVXI_AVX2_IS(width##_sqrt_avx2, vector, (vector x), _mm256_sqrt_##suffix(x))                          \
    BVXI_AVX2_IS(width##_less_avx2, vector, (vector x, vector y), _mm256_cmp_##suffix(x, y, _CMP_LT_OQ))  \
    BVXI_AVX2_IS(width##_less_equal_avx2, vector, (vector x, vector y),                                   \
                 _mm256_cmp_##suffix(x, y, _CMP_LE_OQ))                                                   \
    BVXI_AVX2_IS(width##_equal_avx2, vector, (vector x, vector y), _mm256_cmp_##suffix(x, y, _CMP_EQ_OQ)) \
    BVXI_AVX2_IS(width##_and_avx2, vector, (vector m, vector n), _mm256_and_##suffix(m, n))               \
    BVXI_AVX2_IS(width##_or_avx2, vector, (vector m, vector n), _mm256_or_##suffix(m, n))                 \
    BVXI_AVX2_IS(width##_but_avx2, vector, (vector m, vector n), _mm256_andnot_##suffix(n, m))            \
    BVXI_AVX2_IS(width##_choose_avx2, vector, (vector m, vector yes, vector no),                          \
                 _mm256_blendv_##suffix(no, yes, m))                                                      \
    BVXI_AVX2_IS(width##_keep_avx2, vector, (vector m, vector x), _mm256_and_##suffix(m, x))              \
    BVXI_AVX2_IS(width##_drop_avx2, vector, (vector m, vector x), _mm256_andnot_##suffix(m, x))           \
    BVXI_AVX2_IS(width##_bits_avx2, uint32_t, (vector m), (uint32_t)_mm256_movemask_##suffix(m))

BVXI_AVX2_OPERATIONS(bvxi_four, __m256d, double, pd)
BVXI_AVX2_OPERATIONS(bvxi_eight, __m256, float, ps)
BVXI_AVX2_IS(bvxi_four_first_avx2, double, (__m256d x), _mm256_cvtsd_f64(x))
BVXI_AVX2_IS(bvxi_four_size_avx2, __m256d, (__m256d x), _mm256_andnot_pd(_mm256_set1_pd(-0.0), x))
BVXI_AVX2_IS(bvxi_four_choose_mask_avx2, __m256d, (__m256d m, __m256d yes, __m256d no),
             _mm256_blendv_pd(no, yes, m))
BVXI_AVX2_IS(bvxi_eight_min_avx2, __m256, (__m256 x, __m256 y), _mm256_min_ps(x, y))
BVXI_AVX2_IS(bvxi_eight_size_avx2, __m256, (__m256 x), _mm256_andnot_ps(_mm256_set1_ps(-0.0f), x))

BVXI_AVX2 BVXI_VECTOR_INLINE float bvxi_eight_least_avx2(__m256 x)
{
    __m128 y = _mm_min_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps(x, 1));
    y = _mm_min_ps(y, _mm_movehl_ps(y, y));
    return _mm_cvtss_f32(_mm_min_ss(y, _mm_shuffle_ps(y, y, 1)));
}

BVXI_AVX2 BVXI_VECTOR_INLINE __m256 bvxi_eight_lanes_avx2(uint32_t bits)
{
    __m256i const lane = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    __m256i const own = _mm256_and_si256(_mm256_set1_epi32((int)bits), lane);
    return _mm256_castsi256_ps(_mm256_cmpeq_epi32(own, lane));
}

BVXI_AVX2_IS(bvxi_eight_load_bytes_avx2, __m256, (const uint8_t *from),
             _mm256_loadu_ps((const float *)(const void *)from))
BVXI_AVX2_IS(bvxi_eight_load_two_avx2, __m256, (const float *low, const float *high),
             _mm256_insertf128_ps(_mm256_castps128_ps256(_mm_loadu_ps(low)), _mm_loadu_ps(high), 1))

BVXI_AVX2 BVXI_VECTOR_INLINE void bvxi_four_columns_f32_avx2(const float *a, const float *b, const float *c,
                                                             const float *d, __m256d to[4])
{
    __m128 const ra = _mm_loadu_ps(a), rb = _mm_loadu_ps(b), rc = _mm_loadu_ps(c), rd = _mm_loadu_ps(d);
    __m128 const low_ab = _mm_unpacklo_ps(ra, rb), high_ab = _mm_unpackhi_ps(ra, rb);
    __m128 const low_cd = _mm_unpacklo_ps(rc, rd), high_cd = _mm_unpackhi_ps(rc, rd);
    to[0] = _mm256_cvtps_pd(_mm_movelh_ps(low_ab, low_cd));
    to[1] = _mm256_cvtps_pd(_mm_movehl_ps(low_cd, low_ab));
    to[2] = _mm256_cvtps_pd(_mm_movelh_ps(high_ab, high_cd));
    to[3] = _mm256_cvtps_pd(_mm_movehl_ps(high_cd, high_ab));
}

BVXI_AVX2 BVXI_VECTOR_INLINE void bvxi_four_columns_f64_avx2(const double *a, const double *b,
                                                             const double *c, const double *d, __m256d to[4])
{
    __m256d const ra = _mm256_loadu_pd(a);
    __m256d const rb = _mm256_loadu_pd(b);
    __m256d const rc = _mm256_loadu_pd(c);
    __m256d const rd = _mm256_loadu_pd(d);
    __m256d const even_ab = _mm256_unpacklo_pd(ra, rb), odd_ab = _mm256_unpackhi_pd(ra, rb);
    __m256d const even_cd = _mm256_unpacklo_pd(rc, rd), odd_cd = _mm256_unpackhi_pd(rc, rd);

    to[0] = _mm256_permute2f128_pd(even_ab, even_cd, 0x20);
    to[1] = _mm256_permute2f128_pd(odd_ab, odd_cd, 0x20);
    to[2] = _mm256_permute2f128_pd(even_ab, even_cd, 0x31);
    to[3] = _mm256_permute2f128_pd(odd_ab, odd_cd, 0x31);
}

BVXI_AVX2 BVXI_VECTOR_INLINE void bvxi_eight_columns_avx2(const __m256 row[8], void *to, size_t stride)
{
    __m256 half[2][4];

    for (int i = 0; i < 2; i++) {
        const __m256 *const r = row + 4 * i;
        __m256 const low01 = _mm256_unpacklo_ps(r[0], r[1]), high01 = _mm256_unpackhi_ps(r[0], r[1]);
        __m256 const low23 = _mm256_unpacklo_ps(r[2], r[3]), high23 = _mm256_unpackhi_ps(r[2], r[3]);

        half[i][0] = _mm256_shuffle_ps(low01, low23, 0x44);
        half[i][1] = _mm256_shuffle_ps(low01, low23, 0xee);
        half[i][2] = _mm256_shuffle_ps(high01, high23, 0x44);
        half[i][3] = _mm256_shuffle_ps(high01, high23, 0xee);
    }

    for (size_t k = 0; k < 4; k++) {
        char *const column = (char *)to + k * stride;

        _mm256_storeu_ps((float *)(void *)column, _mm256_permute2f128_ps(half[0][k], half[1][k], 0x20));
        _mm256_storeu_ps((float *)(void *)(column + 4 * stride),
                         _mm256_permute2f128_ps(half[0][k], half[1][k], 0x31));
    }
}

/* ---- Bytes ---- */

BVXI_AVX2_IS(bvxi_bytes_all_avx2, __m256i, (uint8_t x), _mm256_set1_epi8((char)x))
BVXI_AVX2_IS(bvxi_bytes_load_avx2, __m256i, (const uint8_t *from),
             _mm256_loadu_si256((const __m256i *)(const void *)from))
BVXI_AVX2_IS(bvxi_bytes_add_avx2, __m256i, (__m256i x, __m256i y), _mm256_add_epi8(x, y))
BVXI_AVX2_IS(bvxi_bytes_sub_avx2, __m256i, (__m256i x, __m256i y), _mm256_sub_epi8(x, y))
BVXI_AVX2_IS(bvxi_bytes_and_avx2, __m256i, (__m256i x, __m256i y), _mm256_and_si256(x, y))
BVXI_AVX2_IS(bvxi_bytes_or_avx2, __m256i, (__m256i x, __m256i y), _mm256_or_si256(x, y))
BVXI_AVX2_IS(bvxi_bytes_at_most_avx2, __m256i, (__m256i x, __m256i y),
             _mm256_cmpeq_epi8(_mm256_min_epu8(x, y), x))

BVXI_AVX2 BVXI_VECTOR_INLINE void bvxi_bytes_words_avx2(const __m256i row[8], uint64_t *to)
{
    __m256i pair[8], four[8];

    /* Bytes of two rows side by side, then of four, then of eight: a word. */
    for (int32_t i = 0; i < 4; i++) {
        pair[2 * i] = _mm256_unpacklo_epi8(row[2 * i], row[2 * i + 1]);
        pair[2 * i + 1] = _mm256_unpackhi_epi8(row[2 * i], row[2 * i + 1]);
    }
    for (int32_t i = 0; i < 2; i++)
        for (int32_t h = 0; h < 2; h++) {
            four[4 * i + 2 * h] = _mm256_unpacklo_epi16(pair[4 * i + h], pair[4 * i + 2 + h]);
            four[4 * i + 2 * h + 1] = _mm256_unpackhi_epi16(pair[4 * i + h], pair[4 * i + 2 + h]);
        }
    for (int32_t i = 0; i < 4; i++) {
        __m256i const low = _mm256_unpacklo_epi32(four[i], four[4 + i]);
        __m256i const high = _mm256_unpackhi_epi32(four[i], four[4 + i]);

        /* Each half of a vector was unpacked by itself: the upper ones hold words 16 further. */
        _mm_storeu_si128((__m128i *)(void *)(to + 4 * i), _mm256_castsi256_si128(low));
        _mm_storeu_si128((__m128i *)(void *)(to + 4 * i + 2), _mm256_castsi256_si128(high));
        _mm_storeu_si128((__m128i *)(void *)(to + 16 + 4 * i), _mm256_extracti128_si256(low, 1));
        _mm_storeu_si128((__m128i *)(void *)(to + 16 + 4 * i + 2), _mm256_extracti128_si256(high, 1));
    }
}

#endif
