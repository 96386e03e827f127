/* triangle_bins.h - which triangles reach into which band of rows. Not installed. */
#ifndef BVXI_TRIANGLE_BINS_H
#define BVXI_TRIANGLE_BINS_H

#include "core/core.h"

/* First and last band that triangle t reaches; 0 when it reaches none. */
typedef int bvxi_bands_fn(const void *user, uint32_t t, int32_t *first, int32_t *last);

typedef struct bvxi_triangle_bins {
    int32_t bands;
    uint64_t *begin; /* triangle[begin[b]] .. triangle[begin[b + 1] - 1] reach band b, in their order */
    uint32_t *triangle;
    uint64_t total;
} bvxi_triangle_bins;

bvx_status bvxi_triangle_bins_open(bvx_context *ctx, uint64_t triangle_count, int32_t bands,
                                   bvxi_bands_fn *reach, const void *user, bvxi_triangle_bins *bins);
void bvxi_triangle_bins_close(bvx_context *ctx, bvxi_triangle_bins *bins);

#endif
