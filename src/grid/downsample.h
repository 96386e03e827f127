/* downsample.h - a grid seen at a lower resolution: samples, their bits, and crossings between them. Not
 * installed.
 *
 * Along each axis n voxels go to r samples, n >= r; sample i stands in the middle of its stretch [i n/r,
 * (i+1) n/r) of voxels. Beyond the grid everything is empty. */
#ifndef BVXI_DOWNSAMPLE_H
#define BVXI_DOWNSAMPLE_H

#include "grid/grid.h"

enum { BVXI_DOWNSAMPLE_SIDE = 1 << 20 }; /* so that products of three sides fit 62 bits */

/* One axis. Extended function: voxels at and at + 1 around the sample; high_weight: of the second in 1/(2r).
 * Coverage: voxels begin .. end - 1 in the sample's stretch, weights of the first and last in 1/r. */
typedef struct bvxi_sample_axis {
    int32_t n, r, count; /* ratio n/r; samples */
    int32_t voxels;      /* of the grid along this axis */
    int32_t *at, *high_weight;
    int32_t *begin, *end, *first, *last;
} bvxi_sample_axis;

typedef struct bvxi_downsample {
    const bvx_grid *fine;
    bvxi_sample_axis axis[3];
    int32_t *tables; /* after the axes' arrays */
    uint64_t table_bytes;
    int32_t threshold;    /* in 1/65536 */
    int64_t limit;        /* a weighted sum above it is inside */
    int64_t total;        /* weight of everything */
    int32_t edge_samples; /* steps along an edge; 0: the ratio rounded up */
    int32_t cpu;
    bvx_grid coarse; /* one bit a sample */
    uint32_t *value; /* coverage of each sample in 2^-32, rounded down; NULL: not kept */
    int32_t pieces;
} bvxi_downsample;

/* How much smaller, and what counts as inside. */
typedef struct bvxi_downsample_by {
    int32_t n[3], r[3]; /* ratio of each axis */
    double threshold;
    int32_t edge_samples;
} bvxi_downsample_by;
/* Lay out the axes and a coarse grid of cleared bits. */
bvx_status bvxi_downsample_open(bvx_context *ctx, const char *function, const bvx_grid *fine,
                                const bvxi_downsample_by *by, bvxi_downsample *d);

/* extended_function.c: bits of the extended voxel function, and the ratio of its
 * first change along an edge of samples. */
bvx_status bvxi_extended_sample(bvx_context *ctx, bvxi_downsample *d);
double bvxi_extended_ratio(const void *downsample, int32_t axis, int32_t i, int32_t j, int32_t k);

/* coverage.c: bits of the covered fraction (and values, when keep_values),
 * and the ratio by linear interpolation. */
bvx_status bvxi_coverage_sample(bvx_context *ctx, bvxi_downsample *d, int keep_values);
double bvxi_coverage_ratio(const void *downsample, int32_t axis, int32_t i, int32_t j, int32_t k);

/* Words of the fine row (j, k), NULL beyond the grid. */
static inline const uint64_t *bvxi_fine_row(const bvxi_downsample *d, int32_t j, int32_t k)
{
    const bvx_grid *const g = d->fine;
    if (j < 0 || k < 0 || j >= g->size[1] || k >= g->size[2]) return NULL;
    return bvxi_grid_row(g, j, k);
}

/* floor(threshold * total / 65536): a whole weight is above the threshold when it is above this. */
static inline int64_t bvxi_weight_limit(int64_t total, int32_t threshold)
{
    return (total >> 16) * threshold + ((total & 0xffff) * threshold >> 16);
}

#endif
