/* spaces.h - the connected sets of empty voxels that a grid leaves, or of its set ones. Not installed.
 *
 *   bvxi_spaces_open(ctx, function, stage, grid, 1, BVXI_CONNECT_6, &s);
 *   bvxi_spaces_each(&s, take, user);   every run in order, with its space's number, from 0 by least voxel
 *   bvxi_spaces_free(&s);
 */
#ifndef BVXI_SPACES_H
#define BVXI_SPACES_H

#include "bits/row_runs.h"
#include "grid/components.h"
#include "grid/grid.h"

typedef struct bvxi_spaces {
    bvxi_components parts;
    const bvx_grid *grid; /* must not change while the spaces are open */
    const char *stage;
    uint64_t count;
    int32_t empty;
} bvxi_spaces;

/* Number the spaces of empty voxels (empty 1) or of set ones (0). Memory (scratch): that of components.h. */
bvx_status bvxi_spaces_open(bvx_context *ctx, const char *function, const char *stage, const bvx_grid *grid, int32_t empty,
                            int32_t connectivity, bvxi_spaces *spaces);
typedef void bvxi_spaces_fn(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z);
void bvxi_spaces_each(const bvxi_spaces *spaces, bvxi_spaces_fn *take, void *user);
void bvxi_spaces_free(bvxi_spaces *spaces);

/* 1 when a run touches a side of the grid's window. */
static inline int bvxi_spaces_at_side(const bvx_grid *grid, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    return begin == 0 || end == grid->size[0] || y == 0 || y == grid->size[1] - 1 || z == 0 || z == grid->size[2] - 1;
}

#endif
