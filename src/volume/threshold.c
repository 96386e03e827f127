/* threshold.c - the voxels whose sample lies in a range: bvx_threshold. Runs of 64 samples become words, by
 * loops without a branch on a sample.
 *
 * Guarantee: exact for all types, no sample is rounded; the portable loops say what the vector ones must
 * give. */
#include "volume/room.h"
#include "core/simd.h"

#include <math.h>

/* ---- Columns of bytes to rows of bits: in range or not, and turned at the same time ---- */

/* NumPy's C order has z fastest and bits run along x. Comparing 64 bytes of each of eight columns and
 * keeping another bit of each comparison gives eight bits of x for 64 z; eight such sets of bytes are
 * turned as bytes, by unpacking, instead of 64 by 64 bits. The bits are those of the runs below, turned;
 * only bytes of the columns are read. */

enum { COLUMN_BYTES = 64 }; /* of a column at a time: a line of the cache */

#define BVXI_SIMD_LEVEL _base
#include "volume/threshold_columns_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "volume/threshold_columns_body.h"
#undef BVXI_SIMD_LEVEL
#endif

/* ---- Runs of samples to words of bits: in range or not, and what there is to count ---- */

/* Compilers make vectors of the loops; samples that lie apart, and those of a row's end, are brought together first. Infinite samples need no comparison
 * of their own, as the range has finite ends. Counts are taken while the samples are at hand: a block without
 * NaN and infinity, the usual one, by the extremes of all of it, any other sample by sample. */

#if BVXI_HAVE_AVX2
#include <immintrin.h>
#endif

enum { RANGE_LANES = 8 };

/* 1 where some of 64 floats has all exponent bits set: joined integers without an exit, so it vectorizes. */
#define ANY_ODD(name, word, exponent)                         \
    BVXI_VECTOR_INLINE int name(const uint8_t *p)             \
    {                                                         \
        word odd = 0;                                         \
        for (size_t i = 0; i < 64; i++) {                     \
            word bits;                                        \
            memcpy(&bits, p + sizeof bits * i, sizeof bits);  \
            odd |= (word)((bits & (exponent)) == (exponent)); \
        }                                                     \
        return odd != 0;                                      \
    }
ANY_ODD(any_odd_f32, uint32_t, UINT32_C(0x7f800000))
ANY_ODD(any_odd_f64, uint64_t, UINT64_C(0x7ff0000000000000))

static void count_each(const uint8_t *p, int32_t type, int32_t n, bvxi_range_tally *tally)
{
    uint32_t const size = bvxi_type_size(type);

    for (int32_t i = 0; i < n; i++) {
        double const v = bvxi_sample_value(p + (size_t)i * size, type);

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

#define BVXI_SIMD_LEVEL    _base
#define range_run_f32_base range_run_f32
#include "volume/threshold_runs_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "volume/threshold_runs_body.h"
#undef BVXI_SIMD_LEVEL
#endif

/* The rule (a bvxi_range) for runs of samples; with tally
 * (bvxi_range_tally) where one is given. */
static bvxi_bits_fn *range_run_for(const bvx_context *ctx, int32_t type)
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

/* ---- The voxels whose sample lies in a range: bvx_threshold ---- */

/* The range's ends are moved inwards to the nearest numbers of the samples' own type, once; then each sample
 * is compared as what it is, 64 at a time (threshold.c), along the axis that runs fastest. Guarantee:
 * exactly low <= sample <= high, for all types; NaN and infinite samples are not set. Counts are sums and
 * extremes over pieces, so no thread shows in them. */

#define THRESHOLD_F32_MAX 3.4028234663852886e38 /* (2 - 2^-23) * 2^127 */
#define THRESHOLD_F64_MAX 1.7976931348623157e308

/* The float beside f greater (up 1) or lesser; both are finite. */
static float step_float(float f, int up)
{
    uint32_t bits;
    memcpy(&bits, &f, sizeof bits);
    if (f == 0.0f) bits = up ? 1 : UINT32_C(0x80000001);
    else if ((f > 0.0f) == up) bits++;
    else bits--;
    memcpy(&f, &bits, sizeof f);
    return f;
}

static void range_of_floats(double low, double high, bvxi_range *r)
{
    /* Only finite floats: an infinite one is set by no range. */
    if (low < -THRESHOLD_F32_MAX) low = -THRESHOLD_F32_MAX;
    if (high > THRESHOLD_F32_MAX) high = THRESHOLD_F32_MAX;
    r->empty = low > high;
    if (r->empty) return;
    r->low.f = (float)low;
    r->high.f = (float)high;
    /* The cast rounds to the nearest; one that fell outside is moved in. */
    if ((double)r->low.f < low) r->low.f = step_float(r->low.f, 1);
    if ((double)r->high.f > high) r->high.f = step_float(r->high.f, 0);
    r->empty = r->low.f > r->high.f;
}

/* least and most are those of the type; end is the first double beyond most. */
static void range_of_signed(double low, double high, int64_t least, int64_t most, double end, bvxi_range *r)
{
    r->empty = low >= end || high < (double)least;
    if (r->empty) return;
    low = -floor(-low);
    high = floor(high);
    /* Beyond the type's own ends there is nothing to compare. */
    r->low.i = low <= (double)least ? least : low >= end ? most : (int64_t)low;
    r->high.i = high >= end ? most : (int64_t)high;
    r->empty = r->low.i > r->high.i || low >= end;
}

static void range_of_unsigned(double low, double high, uint64_t most, double end, bvxi_range *r)
{
    r->empty = low >= end || high < 0.0;
    if (r->empty) return;
    low = -floor(-low);
    high = floor(high);
    r->low.u = low <= 0.0 ? 0 : low >= end ? most : (uint64_t)low;
    r->high.u = high >= end ? most : (uint64_t)high;
    r->empty = r->low.u > r->high.u || low >= end;
}

void bvxi_range_make(int32_t type, double low, double high, bvxi_range *range)
{
    memset(range, 0, sizeof *range);
    range->type = type;
    switch (type) {
    case BVX_SAMPLE_U8: range_of_unsigned(low, high, UINT8_MAX, 256.0, range); break;
    case BVX_SAMPLE_U16: range_of_unsigned(low, high, UINT16_MAX, 65536.0, range); break;
    case BVX_SAMPLE_U32: range_of_unsigned(low, high, UINT32_MAX, 4294967296.0, range); break;
    case BVX_SAMPLE_U64: range_of_unsigned(low, high, UINT64_MAX, 18446744073709551616.0, range); break;
    case BVX_SAMPLE_I8: range_of_signed(low, high, INT8_MIN, INT8_MAX, 128.0, range); break;
    case BVX_SAMPLE_I16: range_of_signed(low, high, INT16_MIN, INT16_MAX, 32768.0, range); break;
    case BVX_SAMPLE_I32: range_of_signed(low, high, INT32_MIN, INT32_MAX, 2147483648.0, range); break;
    case BVX_SAMPLE_I64:
        range_of_signed(low, high, INT64_MIN, INT64_MAX, 9223372036854775808.0, range);
        break;
    case BVX_SAMPLE_F32: range_of_floats(low, high, range); break;
    default:
        /* NaN fails both comparisons, and infinite numbers lie beyond the finite ends. */
        range->low.d = low < -THRESHOLD_F64_MAX ? -THRESHOLD_F64_MAX : low;
        range->high.d = high > THRESHOLD_F64_MAX ? THRESHOLD_F64_MAX : high;
        range->empty = range->low.d > range->high.d;
        break;
    }
}

bvx_status bvxi_threshold(bvxi_call call, const bvx_volume_view *volume, const int64_t stride[3],
                          const bvxi_range *range, bvx_volume_report *report, bvx_grid *grid)
{
    bvxi_range_tally *tally = NULL;

    bvxi_sample_walk walk = {.first = volume->samples};
    memcpy(walk.stride, stride, sizeof walk.stride);
    walk.run = range_run_for(call.ctx, volume->sample_type);
    /* Bytes have something better than runs. */
    if (report == NULL && bvxi_type_size(volume->sample_type) == 1)
        walk.columns = BVXI_PATH(bvxi_cpu(call.ctx) == BVX_CPU_AVX2, range_columns_base, range_columns_avx2);
    walk.rule = range;
    walk.grid = grid;
    bvxi_sample_walk_plan(&walk);
    /* One count a piece, as no two threads may write one. */
    uint64_t const bytes = report != NULL ? (uint64_t)walk.pieces * sizeof *tally : 0;
    if (report != NULL)
        BVXI_TRY(bvxi_alloc_zero(call.ctx, BVXI_SCRATCH, bytes, "the counts of samples", &tally));
    for (int32_t p = 0; p < walk.pieces && tally != NULL; p++) {
        tally[p].least = THRESHOLD_F64_MAX;
        tally[p].greatest = -THRESHOLD_F64_MAX;
    }
    walk.tallies = tally;
    walk.tally_size = sizeof *tally;
    BVXI_TRY(bvxi_samples_to_bits(call.ctx, call.stage, call.from, call.to, &walk));
    if (report == NULL) return BVX_OK;

    double least = THRESHOLD_F64_MAX, greatest = -THRESHOLD_F64_MAX;
    memset(report, 0, sizeof *report);
    for (int32_t p = 0; p < walk.pieces; p++) {
        report->nan += tally[p].nan;
        report->infinite += tally[p].infinite;
        report->inside += tally[p].inside;
        if (tally[p].least < least) least = tally[p].least;
        if (tally[p].greatest > greatest) greatest = tally[p].greatest;
    }
    if (least > greatest) return BVX_OK;
    report->least = least + 0.0; /* -0 and 0 are found in any order */
    report->greatest = greatest + 0.0;
    return BVX_OK;
}

/* From real[0] to real[1], or where that is NULL from whole[0] to whole[1]. */
static bvx_status run_threshold(bvx_context *context, const char *name, const bvx_volume_view *volume,
                                const double *real, const int64_t *whole, bvx_volume_report *report,
                                bvx_grid *grid)
{
    bvxi_range range;
    bvx_volume_report counts;
    bvx_window window;
    int64_t stride[3];

    if (grid == NULL) return bvxi_fail_null(context, name, "grid");
    BVXI_TRY(bvxi_volume_check(context, name, volume, stride));

    /* NaN compares with nothing, so such a range would be neither empty nor full. */
    if (real != NULL && (real[0] != real[0] || real[1] != real[1]))
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_NOT_FINITE,
                             "%s: an end of the range is NaN", name);
    if (real == NULL && volume->sample_type >= BVX_SAMPLE_F32)
        return bvxi_fail(context, BVX_ERR_UNSUPPORTED, "%s: the samples are floats", name);
    if (real != NULL) bvxi_range_make(volume->sample_type, real[0], real[1], &range);
    else {
        /* From the type's own ends inwards: those of a u64 are its bits, of lesser unsigned types signed numbers. */
        int const bits = volume->sample_type == BVX_SAMPLE_U64;
        bvxi_range_make(volume->sample_type, -THRESHOLD_F64_MAX, THRESHOLD_F64_MAX, &range);
        if (bits || whole[0] > range.low.i) range.low.i = whole[0];
        if (bits || whole[1] < range.high.i) range.high.i = whole[1];
        range.empty = bits ? range.low.u > range.high.u : range.low.i > range.high.i;
    }
    memcpy(window.low, volume->low, sizeof window.low);
    memcpy(window.size, volume->size, sizeof window.size);
    bvxi_grid_renew(context, &volume->lattice, &window, grid);
    bvx_grid made = *grid;
    BVXI_TRY(bvxi_grid_open(context, name, &volume->lattice, &window, &made));
    bvx_status const status = bvxi_threshold(bvxi_call_of(context, NULL, "threshold", 0, 1), volume, stride,
                                             &range, report != NULL ? &counts : NULL, &made);
    BVXI_TRY(bvxi_grid_put(context, status, &made, grid));
    if (report != NULL) *report = counts;
    return BVX_OK;
}

bvx_status bvx_threshold(bvx_context *context, const bvx_volume_view *volume, double low, double high,
                         bvx_volume_report *report, bvx_grid *grid)
{
    double const ends[2] = {low, high};
    return BVXI_CALL(context, run_threshold(context, "bvx_threshold", volume, ends, NULL, report, grid));
}

bvx_status bvx_threshold_whole(bvx_context *context, const bvx_volume_view *volume, int64_t low, int64_t high,
                               bvx_volume_report *report, bvx_grid *grid)
{
    int64_t const ends[2] = {low, high};
    return BVXI_CALL(context,
                     run_threshold(context, "bvx_threshold_whole", volume, NULL, ends, report, grid));
}
