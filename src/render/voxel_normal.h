/* voxel_normal.h - which way the surface of a voxel set faces. Not installed. */
#ifndef BVXI_VOXEL_NORMAL_H
#define BVXI_VOXEL_NORMAL_H

#include "core/core.h"

/* From the voxels set in a grid or in also (words of the same window; the grid's own where there is one set
 * only) in a ball of three voxels around (i, j, k), which lies in the window: n points from their middle to
 * the voxel, steps along each axis as long as spacing says; all zero where they balance. */
void bvxi_voxel_normal(const bvx_grid *grid, const uint64_t *also, const double spacing[3], int32_t i,
                       int32_t j, int32_t k, double n[3]);

#endif
