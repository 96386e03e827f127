/* threshold.h - a range of values as the bits of a grid, for other rooms. Not installed. */
#ifndef BVXI_THRESHOLD_H
#define BVXI_THRESHOLD_H

#include "volume/sample_bits.h"
#include "volume/volume.h"

/* The least and the greatest sample of a type that lie in a range: doubles
 * are no sample's type but one, so the ends are moved inwards to numbers
 * that the type has. Exact: v is in the range just when low <= v <= high. */
typedef struct bvxi_range {
    int32_t type, empty;
    union {
        uint64_t u;
        int64_t i;
        float f;
        double d;
    } low, high;
} bvxi_range;

void bvxi_range_make(int32_t type, double low, double high, bvxi_range *range);

/* Counts of one piece of samples; least and greatest start at the greatest double and its negative. */
typedef struct bvxi_range_tally {
    uint64_t nan, infinite, inside;
    double least, greatest;
} bvxi_range_tally;

/* threshold_runs.c: the rule (a bvxi_range) for runs of samples; with tally
 * (bvxi_range_tally) where one is given. */
bvxi_bits_fn *bvxi_range_run_for(const bvx_context *ctx, int32_t type);

/* Threshold a checked view into an open grid; report may be NULL. */
bvx_status bvxi_threshold(bvx_context *ctx, const char *stage, double from, double to,
                          const bvx_volume_view *volume, const int64_t stride[3], const bvxi_range *range,
                          bvx_volume_report *report, bvx_grid *grid);

#endif
