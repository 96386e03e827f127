/* threshold.c - the voxels whose sample lies in a range: bvx_threshold.
 *
 * The range's ends are moved inwards to the nearest numbers of the samples' own type, once; then each sample
 * is compared as what it is, 64 at a time (threshold_runs.c), along the axis that runs fastest. Guarantee:
 * exactly low <= sample <= high, for all types; NaN and infinite samples are not set. Counts are sums and
 * extremes over pieces, so no thread shows in them. */
#include "volume/room.h"

#include <math.h>

#define THRESHOLD_F32_MAX 3.4028234663852886e38 /* (2 - 2^-23) * 2^127 */
#define THRESHOLD_F64_MAX 1.7976931348623157e308

/* ---- ranges of a type ---- */

/* The float beside f towards greater ones (up 1) or lesser ones; f is
 * finite and the step does not leave the finite ones. */
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
    /* Empty where no number of the type is in it. */
    r->empty = low >= end || high < (double)least;
    if (r->empty) return;
    /* To whole numbers within the range. */
    low = -floor(-low);
    high = floor(high);
    /* Beyond the type's own ends there is nothing to compare. */
    r->low.i = low <= (double)least ? least : low >= end ? most : (int64_t)low;
    r->high.i = high >= end ? most : (int64_t)high;
    r->empty = r->low.i > r->high.i || low >= end;
}

static void range_of_unsigned(double low, double high, uint64_t most, double end, bvxi_range *r)
{
    /* As with signed ones, from 0 on. */
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

/* ---- counts ---- */

static void report_range(const bvxi_range_tally *tally, int32_t pieces, bvx_volume_report *report)
{
    double least = THRESHOLD_F64_MAX, greatest = -THRESHOLD_F64_MAX;

    memset(report, 0, sizeof *report);

    /* Sums and extremes: in any order the same. */
    for (int32_t p = 0; p < pieces; p++) {
        report->nan += tally[p].nan;
        report->infinite += tally[p].infinite;
        report->inside += tally[p].inside;
        if (tally[p].least < least) least = tally[p].least;
        if (tally[p].greatest > greatest) greatest = tally[p].greatest;
    }
    /* No finite sample at all. */
    if (least > greatest) return;
    report->least = least + 0.0; /* -0 and 0 are found in any order */
    report->greatest = greatest + 0.0;
}

bvx_status bvxi_threshold(bvxi_call call, const bvx_volume_view *volume, const int64_t stride[3],
                          const bvxi_range *range, bvx_volume_report *report, bvx_grid *grid)
{
    bvxi_sample_walk walk = {0};
    bvxi_range_tally *tally = NULL;
    bvx_status status = BVX_OK;

    walk.first = volume->samples;
    memcpy(walk.stride, stride, sizeof walk.stride);
    walk.run = bvxi_range_run_for(call.ctx, volume->sample_type);
    walk.rule = range;
    walk.grid = grid;
    bvxi_sample_walk_plan(&walk);
    /* One count a piece, as no two threads may write one. */
    uint64_t const bytes = report != NULL ? (uint64_t)walk.pieces * sizeof *tally : 0;
    if (report != NULL)
        status = bvxi_alloc_zero(call.ctx, BVXI_SCRATCH, bytes, "the counts of samples", &tally);
    /* Extremes begin at the opposite ends. */
    for (int32_t p = 0; p < walk.pieces && tally != NULL; p++) {
        tally[p].least = THRESHOLD_F64_MAX;
        tally[p].greatest = -THRESHOLD_F64_MAX;
    }
    walk.tallies = tally;
    walk.tally_size = sizeof *tally;
    if (status == BVX_OK) status = bvxi_samples_to_bits(call.ctx, call.stage, call.from, call.to, &walk);
    if (status == BVX_OK && report != NULL) report_range(tally, walk.pieces, report);
    bvxi_drop(call.ctx, tally);
    return status;
}

/* ---- public ---- */

static bvx_status run_threshold(bvx_context *context, const bvx_volume_view *volume, double low, double high,
                                bvx_volume_report *report, bvx_grid *grid)
{
    static const char name[] = "bvx_threshold";
    bvxi_range range;
    bvx_volume_report counts;
    bvx_window window;
    bvx_grid made;
    int64_t stride[3];
    bvx_status status;

    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (grid == NULL) return bvxi_fail_null(context, name, "grid");
    BVXI_TRY(bvxi_volume_check(context, name, volume, stride));

    /* NaN compares with nothing, so such a range would be neither empty nor full. */
    if (low != low || high != high)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_NOT_FINITE,
                             "%s: an end of the range is NaN", name);
    bvxi_range_make(volume->sample_type, low, high, &range);
    memcpy(window.low, volume->low, sizeof window.low);
    memcpy(window.size, volume->size, sizeof window.size);
    bvxi_grid_renew(context, &volume->lattice, &window, grid);
    made = *grid;
    BVXI_TRY(bvxi_grid_open(context, name, &volume->lattice, &window, &made));
    status = bvxi_threshold(bvxi_call_of(context, NULL, "threshold", 0, 1), volume, stride, &range,
                            report != NULL ? &counts : NULL, &made);
    if (status != BVX_OK) {
        /* The caller's own array stays the caller's. */
        if (made.words != grid->words) bvx_grid_free(context, &made);
        return status;
    }
    if (report != NULL) *report = counts;
    *grid = made;
    return BVX_OK;
}

bvx_status bvx_threshold(bvx_context *context, const bvx_volume_view *volume, double low, double high,
                         bvx_volume_report *report, bvx_grid *grid)
{
    return BVXI_CALL(context, run_threshold(context, volume, low, high, report, grid));
}
