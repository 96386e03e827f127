/* turned_rows.h - grids whose bits run along y or z, and their way back to rows along x. Not installed.
 *
 * A turned grid has its window's sides in another order: (y, x, z) for axis 1, (z, x, y) for axis 2. Its
 * lattice stays as it is and tells fraction bits only. For axis 0 nothing changes. */
#ifndef BVXI_TURNED_ROWS_H
#define BVXI_TURNED_ROWS_H

#include "grid/grid.h"

/* The three axes in a turned grid's order. */
static inline void bvxi_turn_axes(int32_t axis, int32_t order[3])
{
    order[0] = axis;
    order[1] = axis == 0 ? 1 : 0;
    order[2] = axis == 2 ? 1 : 2;
}

/* The turned shape of a grid's window, without words. */
static inline void bvxi_turn_shape(const bvx_grid *grid, int32_t axis, bvx_grid *turned)
{
    int32_t order[3];

    bvxi_turn_axes(axis, order);

    /* Only the shape is turned: whoever makes the words needs no more. */
    memset(turned, 0, sizeof *turned);
    turned->lattice = grid->lattice;
    for (int32_t i = 0; i < 3; i++) {
        turned->low[i] = grid->low[order[i]];
        turned->size[i] = grid->size[order[i]];
    }
    turned->words_per_row = bvxi_row_words(turned->size[0]);
}

/* Turn the bits of a turned grid (axis 1 or 2) and put them to the words of grid; with second, words of its shape,
 * grid stays, and second becomes where it, grid and the turned bits agree. A stage of progress that says nothing of
 * its own: work is called at `progress`. */
bvx_status bvxi_turn_back(bvx_context *ctx, const bvx_grid *turned, int32_t axis, double progress,
                          bvx_grid *grid, uint64_t *second);

#endif
