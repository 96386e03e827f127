/* threshold_runs.c - runs of samples to words of bits: in range or not, and what there is to count.
 *
 * 64 samples make a word. The loops have no branch on a sample and are made vectors by compilers; samples
 * that lie apart, and those of a row's end, are brought together first. Infinite samples need no comparison
 * of their own, as the range has finite ends. Counts are taken while the samples are at hand: a block without
 * NaN and infinity, the usual one, by the extremes of all of it, any other sample by sample. The portable
 * path is the specification. */
#include "volume/room.h"
#include "core/simd.h"

#if BVXI_HAVE_AVX2
#include <immintrin.h>
#endif

enum { RANGE_LANES = 8 };

/* ---- counting what is no finite number ---- */

/* 1 where some of 64 floats has all bits of its exponent set. */
BVXI_VECTOR_INLINE int any_odd_f32(const uint8_t *p)
{
    /* Whole numbers joined, not a test that leaves: that is what makes it a vector. */
    uint32_t odd = 0;
    for (size_t i = 0; i < 64; i++) {
        uint32_t bits;
        memcpy(&bits, p + 4 * i, sizeof bits);
        odd |= (uint32_t)((bits & UINT32_C(0x7f800000)) == UINT32_C(0x7f800000));
    }
    return odd != 0;
}

BVXI_VECTOR_INLINE int any_odd_f64(const uint8_t *p)
{
    uint64_t odd = 0;
    for (size_t i = 0; i < 64; i++) {
        uint64_t bits;
        memcpy(&bits, p + 8 * i, sizeof bits);
        odd |= (uint64_t)((bits & UINT64_C(0x7ff0000000000000)) == UINT64_C(0x7ff0000000000000));
    }
    return odd != 0;
}

/* Sample by sample: any type, n of them. */
static void count_each(const uint8_t *p, int32_t type, int32_t n, bvxi_range_tally *tally)
{
    uint32_t const size = bvxi_type_size(type);

    for (int32_t i = 0; i < n; i++) {
        double const v = bvxi_sample_value(p + (size_t)i * size, type);

        /* Each sample is one of three: undefined, infinite, or one that extremes count. */
        if (v != v) {
            tally->nan++;
        } else if (v - v != 0.0) {
            tally->infinite++;
        } else {
            if (v < tally->least) tally->least = v;
            if (v > tally->greatest) tally->greatest = v;
        }
    }
}

/* ---- a type's run ---- */

#if BVXI_HAVE_AVX2
/* Bit i is byte i of p, each 0 or 1. */
BVXI_AVX2 static inline uint64_t flags_to_word_avx2(const uint8_t p[64])
{
    __m256i const low = _mm256_loadu_si256((const __m256i *)(const void *)p);
    __m256i const high = _mm256_loadu_si256((const __m256i *)(const void *)(p + 32));
    uint64_t const first = (uint32_t)_mm256_movemask_epi8(_mm256_slli_epi16(low, 7));
    return (uint64_t)(uint32_t)_mm256_movemask_epi8(_mm256_slli_epi16(high, 7)) << 32 | first;
}
#endif

/* low <= v <= high for 64 samples. */
#define RANGE_BLOCK(suffix, c_type)                                                                        \
    BVXI_VECTOR_INLINE void range_64_##suffix(const uint8_t *p, c_type low, c_type high, uint8_t flag[64]) \
    {                                                                                                      \
        for (size_t i = 0; i < 64; i++) {                                                                  \
            c_type v;                                                                                      \
            memcpy(&v, p + i * sizeof v, sizeof v);                                                        \
            flag[i] = (uint8_t)((v >= low) & (v <= high));                                                 \
        }                                                                                                  \
    }

/* The least and the greatest of 64 samples and of what is there: whole
 * numbers in any order, as compilers make vectors of it. */
#define WHOLE_EXTREMES(suffix, c_type)                                                              \
    BVXI_VECTOR_INLINE void extremes_64_##suffix(const uint8_t *p, c_type *least, c_type *greatest) \
    {                                                                                               \
        c_type low = *least, high = *greatest;                                                      \
        for (size_t i = 0; i < 64; i++) {                                                           \
            c_type v;                                                                               \
            memcpy(&v, p + i * sizeof v, sizeof v);                                                 \
            low = v < low ? v : low;                                                                \
            high = v > high ? v : high;                                                             \
        }                                                                                           \
        *least = low;                                                                               \
        *greatest = high;                                                                           \
    }

/* Floats in lanes, since their order is kept. */
#define FLOAT_EXTREMES(suffix, c_type)                                                              \
    BVXI_VECTOR_INLINE void extremes_64_##suffix(const uint8_t *p, c_type *least, c_type *greatest) \
    {                                                                                               \
        c_type low[RANGE_LANES], high[RANGE_LANES];                                                 \
        for (size_t l = 0; l < RANGE_LANES; l++) {                                                  \
            low[l] = *least;                                                                        \
            high[l] = *greatest;                                                                    \
        }                                                                                           \
        for (size_t i = 0; i < 64; i += RANGE_LANES)                                                \
            for (size_t l = 0; l < RANGE_LANES; l++) {                                              \
                c_type v;                                                                           \
                memcpy(&v, p + (i + l) * sizeof v, sizeof v);                                       \
                low[l] = v < low[l] ? v : low[l];                                                   \
                high[l] = v > high[l] ? v : high[l];                                                \
            }                                                                                       \
        for (size_t l = 0; l < RANGE_LANES; l++) {                                                  \
            *least = low[l] < *least ? low[l] : *least;                                             \
            *greatest = high[l] > *greatest ? high[l] : *greatest;                                  \
        }                                                                                           \
    }

/* The whole run. odd: whether a block of 64 holds what is no finite number; to_word: 64 flags to bits. */
#define RANGE_RUN(name, attributes, suffix, c_type, type, field, odd, to_word)                              \
    attributes static void name(const void *rule, void *tally, const uint8_t *p, int64_t stride, int32_t n, \
                                uint64_t *words)                                                            \
    {                                                                                                       \
        const bvxi_range *const r = rule;                                                                   \
        bvxi_range_tally *const t = tally;                                                                  \
        c_type const low = (c_type)r->low.field, high = (c_type)r->high.field;                              \
        c_type least = 0, greatest = 0;                                                                     \
        uint8_t flag[64], gathered[64 * sizeof(c_type)];                                                    \
        int any = 0;                                                                                        \
        uint64_t inside = 0;                                                                                \
        for (int32_t i = 0; i < n; i += 64) {                                                               \
            int32_t const count = n - i < 64 ? n - i : 64;                                                  \
            const uint8_t *q = p + (ptrdiff_t)((int64_t)i * stride);                                        \
            uint64_t w;                                                                                     \
            int32_t skipped = 0;                                                                            \
            if (count < 64 && n >= 64 && stride == (int64_t)sizeof(c_type)) {                               \
                skipped = 64 - count; /* the last 64: what was looked at before is shifted out */           \
                q -= (size_t)skipped * sizeof(c_type);                                                      \
            } else if (count < 64 || stride != (int64_t)sizeof(c_type)) {                                   \
                for (int32_t k = 0; k < count; k++)                                                         \
                    memcpy(gathered + (size_t)k * sizeof(c_type), q + (ptrdiff_t)((int64_t)k * stride),     \
                           sizeof(c_type));                                                                 \
                for (int32_t k = count; k < 64; k++)                                                        \
                    memcpy(gathered + (size_t)k * sizeof(c_type), gathered, sizeof(c_type));                \
                q = gathered;                                                                               \
            }                                                                                               \
            range_64_##suffix(q, low, high, flag);                                                          \
            w = r->empty ? 0 : to_word(flag) >> skipped & (~UINT64_C(0) >> (64 - count));                   \
            words[i >> 6] = w;                                                                              \
            if (t == NULL) continue;                                                                        \
            inside += bvxi_popcount(w);                                                                     \
            if (odd(q)) {                                                                                   \
                count_each(q + (size_t)skipped * sizeof(c_type), type, count, t);                           \
                continue;                                                                                   \
            }                                                                                               \
            if (!any) memcpy(&least, q, sizeof least);                                                      \
            if (!any) greatest = least;                                                                     \
            any = 1;                                                                                        \
            extremes_64_##suffix(q, &least, &greatest);                                                     \
        }                                                                                                   \
        if (t == NULL) return;                                                                              \
        t->inside += inside;                                                                                \
        if (any) count_each((const uint8_t *)&least, type, 1, t);                                           \
        if (any) count_each((const uint8_t *)&greatest, type, 1, t);                                        \
    }

#define NEVER_ODD(p) 0
#define RANGE_PORTABLE

#if BVXI_HAVE_AVX2
#define RANGE_TYPE(suffix, c_type, type, field, odd)                                                    \
    RANGE_BLOCK(suffix, c_type)                                                                         \
    RANGE_RUN(range_run_##suffix, RANGE_PORTABLE, suffix, c_type, type, field, odd, bvxi_flags_to_word) \
    RANGE_RUN(range_run_##suffix##_avx2, BVXI_AVX2, suffix, c_type, type, field, odd, flags_to_word_avx2)
#else
#define RANGE_TYPE(suffix, c_type, type, field, odd) \
    RANGE_BLOCK(suffix, c_type)                      \
    RANGE_RUN(range_run_##suffix, RANGE_PORTABLE, suffix, c_type, type, field, odd, bvxi_flags_to_word)
#endif

WHOLE_EXTREMES(u8, uint8_t)
RANGE_TYPE(u8, uint8_t, BVX_SAMPLE_U8, u, NEVER_ODD)
WHOLE_EXTREMES(i8, int8_t)
RANGE_TYPE(i8, int8_t, BVX_SAMPLE_I8, i, NEVER_ODD)
WHOLE_EXTREMES(u16, uint16_t)
RANGE_TYPE(u16, uint16_t, BVX_SAMPLE_U16, u, NEVER_ODD)
WHOLE_EXTREMES(i16, int16_t)
RANGE_TYPE(i16, int16_t, BVX_SAMPLE_I16, i, NEVER_ODD)
WHOLE_EXTREMES(u32, uint32_t)
RANGE_TYPE(u32, uint32_t, BVX_SAMPLE_U32, u, NEVER_ODD)
WHOLE_EXTREMES(i32, int32_t)
RANGE_TYPE(i32, int32_t, BVX_SAMPLE_I32, i, NEVER_ODD)
WHOLE_EXTREMES(u64, uint64_t)
RANGE_TYPE(u64, uint64_t, BVX_SAMPLE_U64, u, NEVER_ODD)
WHOLE_EXTREMES(i64, int64_t)
RANGE_TYPE(i64, int64_t, BVX_SAMPLE_I64, i, NEVER_ODD)
FLOAT_EXTREMES(f32, float)
RANGE_TYPE(f32, float, BVX_SAMPLE_F32, f, any_odd_f32)
FLOAT_EXTREMES(f64, double)
RANGE_TYPE(f64, double, BVX_SAMPLE_F64, d, any_odd_f64)

/* ---- floats, eight at a time ---- */

#if BVXI_SIMD_BASE
#define BVXI_SIMD_LEVEL    _base
#define range_run_f32_base range_run_f32
#include "volume/threshold_runs_body.h"
#undef BVXI_SIMD_LEVEL
#else
#define range_rows_f32_base range_run_f32
#endif

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "volume/threshold_runs_body.h"
#undef BVXI_SIMD_LEVEL
#endif

/* ---- the choice ---- */

bvxi_bits_fn *bvxi_range_run_for(const bvx_context *ctx, int32_t type)
{
    static bvxi_bits_fn *const portable[11] = {
        NULL,          range_run_u8,  range_run_i8,  range_run_u16,       range_run_i16, range_run_u32,
        range_run_i32, range_run_u64, range_run_i64, range_rows_f32_base, range_run_f64};

#if BVXI_HAVE_AVX2
    static bvxi_bits_fn *const fast[11] = {NULL,
                                           range_run_u8_avx2,
                                           range_run_i8_avx2,
                                           range_run_u16_avx2,
                                           range_run_i16_avx2,
                                           range_run_u32_avx2,
                                           range_run_i32_avx2,
                                           range_run_u64_avx2,
                                           range_run_i64_avx2,
                                           range_rows_f32_avx2,
                                           range_run_f64_avx2};
    if (bvxi_cpu(ctx) == BVX_CPU_AVX2) return fast[type];
#else
    (void)ctx;
#endif
    return portable[type];
}
