/* coverage.c - the fraction of set voxels in each sample's box.
 *
 * A box is [i n/r, (i+1) n/r) along each axis; voxels that it cuts count with the part inside, in whole units
 * of 1/r, so fractions are exact at any ratio. Rows of boxes are first seen through the OR and the AND of
 * their voxel rows: only boxes that the surface passes are counted, by popcount.
 * Guarantee: bits are exact; positions are linear in the fractions kept to 32 bits. */
#include "grid/downsample.h"

enum { COVERAGE_MAX_WORDS = 64 }; /* words of a row seen at a time by OR and AND */

/* Bits [begin, begin + n) of a row of `words` words, n <= 64; beyond the row they are 0. */
BVXI_VECTOR_INLINE uint64_t cut_bits(const uint64_t *row, int32_t words, int32_t begin, int32_t n)
{
    int32_t const w = begin >> 6, shift = begin & 63;
    uint64_t bits = w < words ? row[w] >> shift : 0;
    if (shift != 0 && w + 1 < words) bits |= row[w + 1] << (64 - shift);
    return n < 64 ? bits & ((UINT64_C(1) << n) - 1) : bits;
}

/* Covered length of one row inside box i, in 1/r voxels. */
BVXI_VECTOR_INLINE int64_t cover_row(const bvxi_sample_axis *x, const uint64_t *row, int32_t words, int32_t i,
                                     int fast)
{
    int32_t const begin = x->begin[i], n = x->end[i] - begin;
    int64_t sum = 0;
    for (int32_t from = 0; from < n; from += 64) {
        int32_t const part = n - from < 64 ? n - from : 64;
        uint64_t const bits = cut_bits(row, words, begin + from, part);
        /* Whole voxels first; the two at the ends lose the part that lies outside the box. */
        sum += (int64_t)bvxi_count_bits(bits, fast) * x->r;
        if (from == 0) sum -= (int64_t)(bits & 1) * (x->r - x->first[i]);
        if (from + part == n && n > 1) sum -= (int64_t)(bits >> (part - 1) & 1) * (x->r - x->last[i]);
    }
    return sum;
}

/* The same over neighbouring rows, for boxes of at most 64 voxels; cut voxels are counted apart. */
BVXI_VECTOR_INLINE int64_t cover_rows(const bvxi_sample_axis *x, const uint64_t *row, int32_t words,
                                      int32_t rows, int32_t i, int fast)
{
    int32_t const begin = x->begin[i], n = x->end[i] - begin, shift = begin & 63;
    uint64_t const mask = n < 64 ? (UINT64_C(1) << n) - 1 : ~UINT64_C(0);
    uint64_t whole = 0, first = 0, last = 0; /* set voxels: all, the first of each row, the last */

    if (n > 64) {
        int64_t sum = 0;
        for (int32_t a = 0; a < rows; a++, row += words) sum += cover_row(x, row, words, i, fast);
        return sum;
    }
    row += begin >> 6;
    /* Two loops, as the question whether the bits cross a word has one answer for all rows. */
    if (shift + n > 64 && (begin >> 6) + 1 < words) {
        for (int32_t a = 0; a < rows; a++, row += words) {
            uint64_t const bits = (row[0] >> shift | row[1] << (64 - shift)) & mask;
            whole += bvxi_count_bits(bits, fast);
            first += bits & 1;
            last += bits >> (n - 1);
        }
    } else {
        for (int32_t a = 0; a < rows; a++, row += words) {
            uint64_t const bits = row[0] >> shift & mask;
            whole += bvxi_count_bits(bits, fast);
            first += bits & 1;
            last += bits >> (n - 1);
        }
    }
    return (int64_t)whole * x->r - (int64_t)first * (x->r - x->first[i]) -
           (int64_t)last * (x->r - x->last[i]);
}

/* Covered volume of box (i, j, k): of each slice the first row, the rows between, the last row. */
BVXI_VECTOR_INLINE int64_t cover_box(const bvxi_downsample *d, int32_t i, int32_t j, int32_t k, int fast)
{
    const bvxi_sample_axis *const x = &d->axis[0], *const y = &d->axis[1], *const z = &d->axis[2];
    int32_t const words = d->fine->words_per_row, begin = y->begin[j], rows = y->end[j] - begin;
    int32_t const inside = y->voxels - begin < rows ? y->voxels - begin : rows;
    int32_t const between = (inside < rows ? inside : rows - 1) - 1;
    int64_t sum = 0;

    for (int32_t b = z->begin[k]; b < z->end[k] && b < z->voxels; b++) {
        int64_t const wz = b == z->begin[k] ? z->first[k] : b == z->end[k] - 1 ? z->last[k] : z->r;
        const uint64_t *const row = bvxi_fine_row(d, begin, b);
        int64_t slice = cover_rows(x, row, words, 1, i, fast) * y->first[j];
        if (between > 0) slice += cover_rows(x, row + words, words, between, i, fast) * y->r;
        if (rows > 1 && inside == rows)
            slice += cover_rows(x, row + (int64_t)words * (rows - 1), words, 1, i, fast) * y->last[j];
        sum += slice * wz;
    }
    return sum;
}

/* OR and AND of the voxel rows of a row of boxes, words [first, first + n). Beyond the grid: 0. */
static void blend_rows(const bvxi_downsample *d, int32_t j, int32_t k, int32_t first, int32_t n,
                       uint64_t *any, uint64_t *all)
{
    const bvxi_sample_axis *const y = &d->axis[1], *const z = &d->axis[2];

    for (int32_t w = 0; w < n; w++) {
        any[w] = 0;
        /* A box that reaches beyond the grid is never full: what is missing there is empty. */
        all[w] = y->end[j] <= y->voxels && z->end[k] <= z->voxels ? ~UINT64_C(0) : 0;
    }
    for (int32_t b = z->begin[k]; b < z->end[k] && b < z->voxels; b++) {
        for (int32_t a = y->begin[j]; a < y->end[j] && a < y->voxels; a++) {
            const uint64_t *const row = bvxi_fine_row(d, a, b) + first;
            for (int32_t w = 0; w < n; w++) {
                any[w] |= row[w];
                all[w] &= row[w];
            }
        }
    }
}

/* Whether bits [begin, end) of a blended row, relative to it, are all 0 (of any) or all 1 (of all). */
BVXI_VECTOR_INLINE int range_is(const uint64_t *row, int32_t words, int32_t begin, int32_t end, int ones)
{
    for (; begin < end; begin += 64) {
        int32_t const n = end - begin < 64 ? end - begin : 64;
        uint64_t const bits = cut_bits(row, words, begin, n);
        if (ones ? bits != (n < 64 ? (UINT64_C(1) << n) - 1 : ~UINT64_C(0)) : bits != 0) return 0;
    }
    return 1;
}

/* floor(sum * 2^32 / total) for 0 <= sum <= total < 2^62, at most 2^32 - 1, in whole numbers. */
static uint32_t fraction_32(int64_t sum, int64_t total)
{
    uint32_t value = 0;
    uint64_t left = (uint64_t)sum;

    /* The full box would be 2^32, which is one too many for the type. */
    if (sum >= total) return UINT32_MAX;
    if (total <= UINT32_MAX) return (uint32_t)((left << 32) / (uint64_t)total);
    /* The product with 2^32 would not fit in 64 bits. */
    for (int32_t bit = 0; bit < 32; bit++) { /* a binary digit at a time */
        left <<= 1;
        value <<= 1;
        if (left >= (uint64_t)total) {
            left -= (uint64_t)total;
            value |= 1;
        }
    }
    return value;
}

BVXI_VECTOR_INLINE void cover_sample_row(const bvxi_downsample *d, int32_t j, int32_t k, int fast)
{
    const bvxi_sample_axis *const x = &d->axis[0];
    uint64_t const row = (uint64_t)k * (uint64_t)d->axis[1].count + (uint64_t)j;
    uint64_t *const out = d->coarse.words + row * (uint64_t)d->coarse.words_per_row;
    uint32_t *const value = d->value != NULL ? d->value + row * (uint64_t)x->count : NULL;
    uint64_t any[COVERAGE_MAX_WORDS], all[COVERAGE_MAX_WORDS];
    int32_t first = 0, n = 0; /* words in any and all */

    for (int32_t i = 0; i < x->count; i++) {
        int32_t const begin = x->begin[i], end = x->end[i];
        int64_t sum;
        /* blend the next words; very wide boxes go without */
        if ((end - 1) >> 6 >= first + n || begin >> 6 < first || n == 0) {
            first = begin >> 6;
            n = d->fine->words_per_row - first < COVERAGE_MAX_WORDS ? d->fine->words_per_row - first
                                                                    : COVERAGE_MAX_WORDS;
            if (n < 0) n = 0;
            blend_rows(d, j, k, first, n, any, all);
        }
        if (end > (first + n) * 64 && first + n < d->fine->words_per_row) sum = cover_box(d, i, j, k, fast);
        else if (range_is(any, n, begin - first * 64, end - first * 64, 0)) sum = 0;
        else if (end <= x->voxels && range_is(all, n, begin - first * 64, end - first * 64, 1))
            sum = d->total;
        else sum = cover_box(d, i, j, k, fast);
        /* A comparison of integers, so that equal fractions give equal bits. */
        out[i >> 6] |= (uint64_t)(sum > d->limit) << (i & 63);
        if (value != NULL) value[i] = sum == 0 ? 0 : fraction_32(sum, d->total);
    }
}

BVXI_VECTOR_INLINE void cover_piece(const bvxi_downsample *d, int32_t piece, int fast)
{
    uint64_t begin, end;
    bvxi_piece((uint64_t)d->axis[1].count * (uint64_t)d->axis[2].count, d->pieces, piece, &begin, &end);
    for (uint64_t row = begin; row < end; row++)
        cover_sample_row(d, (int32_t)(row % (uint64_t)d->axis[1].count),
                         (int32_t)(row / (uint64_t)d->axis[1].count), fast);
}

BVXI_AVX2_COPY(cover_piece_avx2, (const bvxi_downsample *d, int32_t piece), cover_piece(d, piece, 1))

static void cover_piece_task(void *user, int32_t piece)
{
    const bvxi_downsample *const d = user;
    BVXI_PATH(d->cpu == BVX_CPU_AVX2, cover_piece(d, piece, 0), cover_piece_avx2(d, piece));
}

bvx_status bvxi_coverage_sample(bvx_context *ctx, bvxi_downsample *d, int keep_values)
{
    uint64_t const samples = (uint64_t)d->axis[0].count * (uint64_t)d->axis[1].count *
                             (uint64_t)d->axis[2].count;
    /* 20 bits an axis: the volume in units of 1/(r r r) has at most 60. */
    d->total = (int64_t)d->axis[0].n * d->axis[1].n * d->axis[2].n; /* each at most 2^20 */
    d->limit = bvxi_weight_limit(d->total, d->threshold);
    if (keep_values) BVXI_TRY(BVXI_ARRAY(ctx, samples, "the samples' coverage", d->value));
    return bvxi_each(ctx, "lod", 0.0, 0.5, d->pieces, cover_piece_task, d);
}

static double coverage_at(const bvxi_downsample *d, int32_t i, int32_t j, int32_t k)
{
    if (i < 0 || j < 0 || k < 0 || i >= d->axis[0].count || j >= d->axis[1].count || k >= d->axis[2].count)
        return 0.0;
    return (double)d
               ->value[((uint64_t)k * (uint64_t)d->axis[1].count + (uint64_t)j) * (uint64_t)d->axis[0].count +
                       (uint64_t)i] *
           (1.0 / 4294967296.0);
}

double bvxi_coverage_ratio(const void *downsample, int32_t axis, int32_t i, int32_t j, int32_t k)
{
    const bvxi_downsample *const d = downsample;
    double const low = coverage_at(d, i, j, k);
    double const high = coverage_at(d, i + (axis == 0), j + (axis == 1), k + (axis == 2));
    double const threshold = (double)d->threshold / 65536.0;
    /* Where both ends are equal there is no crossing to place; the middle is as good as any. */
    return low == high ? 0.5 : (threshold - low) / (high - low);
}
