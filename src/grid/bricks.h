/* bricks.h - which bricks of 8 x 8 x 8 voxels hold a set one: a grid 512 times smaller. Not installed. */
#ifndef BVXI_BRICKS_H
#define BVXI_BRICKS_H

#include "grid/grid.h"

enum { BVXI_BRICK_SHIFT = 3 };

/* Bit i of a row is the brick of voxels 8 i .. 8 i + 7 of the window; rows of bricks as in a grid. */
typedef struct bvxi_bricks {
    const bvx_grid *grid;
    uint64_t *words; /* NULL when there are none */
    int32_t size[3], words_per_row;
} bvxi_bricks;

/* Memory (scratch): 1/512 of the grid's, rounded up to whole words a row. */
bvx_status bvxi_bricks_make(bvx_context *ctx, const char *stage, double from, double to, const bvx_grid *grid,
                            bvxi_bricks *bricks);
void bvxi_bricks_free(bvx_context *ctx, bvxi_bricks *bricks);

#endif
