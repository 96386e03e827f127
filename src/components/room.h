/* room.h - the connected sets of empty voxels that a grid leaves, or of its set ones. Not
 * installed.
 *
 *   bvxi_spaces_open(ctx, function, stage, grid, 1, BVXI_CONNECT_6, &s);
 *   bvxi_spaces_each(&s, take, user);   every run in order, with its space's number, from 0 by least voxel
 *   bvxi_spaces_free(&s);
 */
#ifndef BVXI_COMPONENTS_ROOM_H
#define BVXI_COMPONENTS_ROOM_H

#include "bits/runs.h"
#include "components/components.h"
#include "grid/grid.h"

typedef struct bvxi_spaces {
    bvxi_components parts;
    const bvx_grid *grid; /* must not change while the spaces are open */
    const char *stage;
    uint64_t count;
    int32_t empty;
} bvxi_spaces;

/* Number the spaces of empty voxels (empty 1) or of set ones (0). Memory (scratch): that of components.h. */
bvx_status bvxi_spaces_open(bvx_context *ctx, const char *function, const char *stage, const bvx_grid *grid,
                            int32_t empty, int32_t connectivity, bvxi_spaces *spaces);
typedef void bvxi_spaces_fn(void *user, uint32_t space, int32_t begin, int32_t end, int32_t y, int32_t z);
void bvxi_spaces_each(const bvxi_spaces *spaces, bvxi_spaces_fn *take, void *user);
void bvxi_spaces_free(bvxi_spaces *spaces);

/* Voxels of each space; at_side, when not NULL: 1 for those that touch a
 * side of the window. Both [Size: count], zeroed. */
void bvxi_spaces_measure(const bvxi_spaces *spaces, uint64_t *voxels, uint8_t *at_side);
/* Change the voxels of the spaces that are marked, in words of the grid's shape. They may be the grid's own:
 * a run's words have all been read when it is handed out. Then the spaces must not be used any more. */
void bvxi_spaces_flip(const bvxi_spaces *spaces, const uint8_t *marked, uint64_t *words);
/* keep_components.c: set the spaces of empty voxels that touch no side of the window and have at_most voxels
 * (0: of any size), in words of the grid's shape, its own or a copy. *filled: what was set. */
typedef struct bvxi_pockets {
    uint64_t count, voxels;
} bvxi_pockets;
bvx_status bvxi_fill_pockets(bvx_context *ctx, const char *function, const bvx_grid *grid,
                             int32_t connectivity, uint64_t at_most, uint64_t *words, bvxi_pockets *filled);
/* Refuse a connectivity other than 6, 18 and 26. */
bvx_status bvxi_check_connectivity(bvx_context *ctx, const char *function, int32_t connectivity);

/* 1 when a run touches a side of the grid's window. */
static inline int bvxi_spaces_at_side(const bvx_grid *grid, int32_t begin, int32_t end, int32_t y, int32_t z)
{
    return begin == 0 || end == grid->size[0] || y == 0 || y == grid->size[1] - 1 || z == 0 ||
           z == grid->size[2] - 1;
}

#endif
