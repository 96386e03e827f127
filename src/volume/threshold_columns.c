/* threshold_columns.c - columns of bytes to rows of bits: in range or not, and turned at the same time.
 *
 * NumPy's C order has z fastest and bits run along x. Comparing 64 bytes of each of eight columns and keeping another bit
 * of each comparison gives eight bits of x for 64 z; eight such sets of bytes are turned as bytes, by unpacking, instead
 * of 64 by 64 bits. Guarantee: the bits of the runs of threshold.c, turned; only bytes of the columns are read. */
#include "volume/room.h"

#if BVXI_HAVE_AVX2
#include <immintrin.h>

enum { COLUMN_BYTES = 64 }; /* of a column at a time: a line of the cache */

/* v lies in the range just when v - low, modulo 256, is at most high - low: of signed bytes too. */
typedef struct column_range {
    __m256i low, width;
} column_range;

BVXI_AVX2 static inline __m256i column_flags(const uint8_t *p, const column_range *r, __m256i bit)
{
    __m256i const v = _mm256_sub_epi8(_mm256_loadu_si256((const __m256i *)(const void *)p), r->low);

    return _mm256_and_si256(_mm256_cmpeq_epi8(_mm256_min_epu8(v, r->width), v), bit);
}

/* Word i of 32 is byte i of each of eight vectors. */
BVXI_AVX2 static inline void column_words(const __m256i byte[8], uint64_t *rows)
{
    __m256i pair[8], four[8];

    /* Bytes of two columns' sets side by side, then of four, then of eight: a word. */
    for (int32_t i = 0; i < 4; i++) {
        pair[2 * i] = _mm256_unpacklo_epi8(byte[2 * i], byte[2 * i + 1]);
        pair[2 * i + 1] = _mm256_unpackhi_epi8(byte[2 * i], byte[2 * i + 1]);
    }
    for (int32_t i = 0; i < 2; i++)
        for (int32_t h = 0; h < 2; h++) {
            four[4 * i + 2 * h] = _mm256_unpacklo_epi16(pair[4 * i + h], pair[4 * i + 2 + h]);
            four[4 * i + 2 * h + 1] = _mm256_unpackhi_epi16(pair[4 * i + h], pair[4 * i + 2 + h]);
        }
    for (int32_t i = 0; i < 4; i++) {
        __m256i const low = _mm256_unpacklo_epi32(four[i], four[4 + i]);
        __m256i const high = _mm256_unpackhi_epi32(four[i], four[4 + i]);

        /* Each half of a vector was unpacked alone: the upper ones hold words 16 further. */
        _mm_storeu_si128((__m128i *)(void *)(rows + 4 * i), _mm256_castsi256_si128(low));
        _mm_storeu_si128((__m128i *)(void *)(rows + 4 * i + 2), _mm256_castsi256_si128(high));
        _mm_storeu_si128((__m128i *)(void *)(rows + 16 + 4 * i), _mm256_extracti128_si256(low, 1));
        _mm_storeu_si128((__m128i *)(void *)(rows + 16 + 4 * i + 2), _mm256_extracti128_si256(high, 1));
    }
}

/* 64 bytes of each column. */
BVXI_AVX2 static void column_square(const column_range *r, const uint8_t *p, int64_t stride, int32_t columns,
                                    int64_t ahead, uint64_t *rows)
{
    __m256i first[8], second[8];

    for (int32_t g = 0; g < 8; g++) {
        __m256i bit = _mm256_set1_epi8(1);

        first[g] = second[g] = _mm256_setzero_si256();
        for (int32_t c = 8 * g; c < 8 * g + 8 && c < columns; c++, p += (ptrdiff_t)stride) {
            first[g] = _mm256_or_si256(first[g], column_flags(p, r, bit));
            second[g] = _mm256_or_si256(second[g], column_flags(p + 32, r, bit));
            bit = _mm256_add_epi8(bit, bit);
            if (ahead != 0) BVXI_PREFETCH(p + (ptrdiff_t)ahead);
        }
    }
    column_words(first, rows);
    column_words(second, rows + 32);
}

BVXI_AVX2 static void range_columns_avx2(const void *rule, const uint8_t *p, int64_t stride, int32_t columns,
                                         int32_t n, int64_t ahead, uint64_t *rows)
{
    const bvxi_range *const range = rule;
    uint8_t few[64 * COLUMN_BYTES];
    uint64_t square[COLUMN_BYTES];
    column_range r;

    if (range->empty) {
        memset(rows, 0, (size_t)n * sizeof rows[0]);
        return;
    }
    /* The low byte of a signed end is that of the unsigned one, whichever member of the union it is. */
    r.low = _mm256_set1_epi8((char)(uint8_t)range->low.u);
    r.width = _mm256_set1_epi8((char)(uint8_t)(range->high.u - range->low.u));

    if (n >= COLUMN_BYTES) {
        int32_t i = 0;

        for (; i + COLUMN_BYTES <= n; i += COLUMN_BYTES)
            column_square(&r, p + i, stride, columns, ahead, rows + i);
        /* The last 64 once more where fewer remain: what was done before is done again. */
        if (i < n) column_square(&r, p + n - COLUMN_BYTES, stride, columns, ahead, rows + n - COLUMN_BYTES);
        return;
    }
    /* Short columns are brought together first. */
    memset(few, 0, sizeof few);
    for (int32_t c = 0; c < columns; c++)
        memcpy(few + COLUMN_BYTES * c, p + (ptrdiff_t)(stride * c), (size_t)n);
    column_square(&r, few, COLUMN_BYTES, columns, 0, square);
    memcpy(rows, square, (size_t)n * sizeof rows[0]);
}
#endif

bvxi_columns_fn *bvxi_range_columns_for(const bvx_context *ctx, int32_t type)
{
#if BVXI_HAVE_AVX2
    if (bvxi_cpu(ctx) == BVX_CPU_AVX2 && bvxi_type_size(type) == 1) return range_columns_avx2;
#else
    (void)ctx;
    (void)type;
#endif
    return NULL;
}
