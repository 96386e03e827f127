/* grid.h - what operations on grids share: checks, words of results, rows. Not installed. */
#ifndef BVXI_GRID_H
#define BVXI_GRID_H

#include "bits/bits.h"
#include "lattice/lattice.h"

/* ---- Grids checked and walked ---- */

/* Refuse an invalid grid, naming the field. */
bvx_status bvxi_grid_check(bvx_context *ctx, const char *function, const bvx_grid *grid);
/* Refuse a checked grid with bits at or past size[0] that are set; the second is that refusal only. */
bvx_status bvxi_grid_check_past(bvx_context *ctx, const char *function, const bvx_grid *grid);
BVXI_COLD bvx_status bvxi_grid_fail_past(bvx_context *ctx, const char *function, const bvx_grid *grid);
/* Refuse words of a result that overlap those of a checked grid of the same size without being the same. */
bvx_status bvxi_grid_check_shift(bvx_context *ctx, const char *function, const bvx_grid *grid,
                                 const bvx_grid *result);
/* Before bvxi_grid_open of a result or of a copy of it: words of the
 * library's that do not suffice go, so that open makes others. */
void bvxi_grid_renew(bvx_context *ctx, const bvx_lattice *lattice, const bvx_window *window, bvx_grid *grid);
/* Set up a grid's struct over new or the caller's words, contents
 * unspecified; *grid is changed only on success. */
bvx_status bvxi_grid_open(bvx_context *ctx, const char *function, const bvx_lattice *lattice,
                          const bvx_window *window, bvx_grid *grid);

/* Refuse two checked grids of different lattices or windows, naming the first field that differs. */
bvx_status bvxi_grid_same(bvx_context *ctx, const char *function, const bvx_grid *a, const bvx_grid *b);
/* Refuse an invalid grid, and a result that is NULL or has words of the grid that it is made from. */
bvx_status bvxi_grid_apart(bvx_context *ctx, const char *function, const bvx_grid *grid,
                           const bvx_grid *result);
/* How a result was filled after bvxi_grid_open; mine: its words are the
 * library's, so after a failure they go back to it. */
bvx_status bvxi_grid_made(bvx_context *ctx, bvx_status status, int mine, bvx_grid *result);

/* The same where a copy of the result's struct was opened and filled: on success it becomes the result. */
bvx_status bvxi_grid_put(bvx_context *ctx, bvx_status status, bvx_grid *made, bvx_grid *result);

/* The smallest window that holds all set voxels of a valid grid; all zero when none is set. */
void bvxi_grid_content(const bvx_grid *grid, bvx_window *window);

static inline uint64_t bvxi_grid_rows(const bvx_grid *grid)
{
    return (uint64_t)grid->size[1] * (uint64_t)grid->size[2];
}

static inline uint64_t bvxi_grid_words(const bvx_grid *grid)
{
    return bvxi_grid_rows(grid) * (uint64_t)grid->words_per_row;
}

/* The words of row (y, z), which the window has. */
static inline uint64_t *bvxi_grid_row(const bvx_grid *grid, int32_t y, int32_t z)
{
    return grid->words +
           ((uint64_t)z * (uint64_t)grid->size[1] + (uint64_t)y) * (uint64_t)grid->words_per_row;
}

/* 1 when the window is the whole lattice. */
static inline int bvxi_grid_is_whole(const bvx_grid *grid)
{
    return memcmp(grid->size, grid->lattice.dims, sizeof grid->size) == 0;
}

/* 1 when the voxel that holds a place is set; beyond the window none is. at: [Units: voxels of the window] */
static inline int bvxi_grid_at(const bvx_grid *grid, const double at[3])
{
    for (int a = 0; a < 3; a++)
        if (!(at[a] >= 0 && at[a] < (double)grid->size[a])) return 0;
    return bvx_grid_get(grid, (int32_t)at[0], (int32_t)at[1], (int32_t)at[2]);
}

/* Bits of each row's last word at or past size[0]: nothing of the library's sets them. */
static inline uint64_t bvxi_grid_past(const bvx_grid *grid)
{
    return ~bvxi_tail_mask(grid->size[0]);
}

#endif
