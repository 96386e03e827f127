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
#include "grid/grid.h"

/* ---- Components of voxels that come row by row ---- */

/* In this order:
 *
 *   bvxi_components_open(ctx, function, BVXI_CONNECT_6, size, run_count, &c);
 *   for each row of the box, in the order of z and y: fill bvxi_components_row(&c, y, z);
 *   bvxi_components_add(&c, y, z);
 *   bvxi_components_number(&c);
 *   c.label[i] is now the component of the i-th run along x; the runs are made again to colour or to measure
 *   them.
 *   bvxi_components_free(&c); */

/* Voxels are neighbours across faces; across faces and edges; across faces, edges and corners. */
enum { BVXI_CONNECT_6 = 6, BVXI_CONNECT_18 = 18, BVXI_CONNECT_26 = 26 };

typedef struct bvxi_components {
    bvx_context *ctx;
    /* a run of the same component, no later one; in the end the component [Size: run_count] */
    uint32_t *label;
    uint64_t added;
    uint64_t component_count; /* after bvxi_components_number */
    /* two slices with empty rows and words around them: slice z at (z & 1) * slice */
    uint64_t *words;
    uint32_t *before;       /* runs that begin before each of these words */
    uint64_t stride, slice; /* words from row to row, and of a slice */
    int32_t row_words, connectivity;
} bvxi_components;

/* Ready for exactly run_count runs of a box of size voxels. Refuses 2^32 - 1 runs and more with
 * BVX_ERR_RANGE.
 * Memory (scratch): 4 bytes a run, and until they are numbered 24 for each word of a slice. */
bvx_status bvxi_components_open(bvx_context *ctx, const char *function, int32_t connectivity,
                                const int32_t size[3], uint64_t run_count, bvxi_components *c);
/* Where the words of the next row go, all of them; bits past the row's end must be 0. */
uint64_t *bvxi_components_row(bvxi_components *c, int32_t y, int32_t z);
/* Take that row. No row of the box may be left out. */
void bvxi_components_add(bvxi_components *c, int32_t y, int32_t z);
/* Number the components by their least linear index (z, y, x), from 0. */
void bvxi_components_number(bvxi_components *c);
void bvxi_components_free(bvxi_components *c);

typedef struct bvxi_spaces {
    bvxi_components parts;
    const bvx_grid *grid; /* must not change while the spaces are open */
    const char *stage;
    uint64_t count;
    int32_t empty;
} bvxi_spaces;

/* Number the spaces of empty voxels (empty 1) or of set ones (0). Memory (scratch): that of
 * bvxi_components. */
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

/* Refuses a seed outside the grid's window; index names it. */
bvx_status bvxi_seed_check(bvx_context *context, const char *function, const bvx_grid *grid,
                           const int32_t *seed, uint64_t index);

#endif
