/* vdb_tree.h - a grid or the distances of a field as the tree of OpenVDB and NanoVDB. Not installed.
 *
 * Leaves have 8 voxels a side, nodes above them 16 leaves, nodes above those 32 such nodes; bits and values run z
 * fastest. Blocks of one kind are tiles: active ones of a mask, or inactive ones that are inside or outside of a
 * field. Index 0,0,0 is the window's first voxel, at its centre. */
#ifndef BVXI_VDB_TREE_H
#define BVXI_VDB_TREE_H

#include "field/room.h"
#include "io_grid/grid_formats.h"

enum { BVXI_VDB_OUTSIDE, BVXI_VDB_INSIDE, BVXI_VDB_BELOW }; /* of a block: a tile, or a node below */

/* Blocks of one size; those beyond the ends are outside. */
typedef struct bvxi_vdb_blocks {
    uint8_t *kind;
    int32_t n[3];
} bvxi_vdb_blocks;

typedef struct bvxi_vdb_tree {
    const bvx_grid *active, *shape; /* of a mask both are the grid; shape without words: nothing is inside */
    const bvx_field *field;         /* NULL: a mask */
    uint64_t bytes;                 /* of a number; 1: a mask */
    double background, first[3];    /* the centre of the first voxel */
    bvxi_vdb_blocks level[3];       /* leaves, nodes of leaves, nodes of those */
} bvxi_vdb_tree;

/* Refuses a corner that is not finite. */
bvx_status bvxi_vdb_find_tree(bvx_context *ctx, const char *format, const bvx_grid *grid,
                              const bvx_field *field, bvxi_vdb_tree *tree);

/* How many blocks a node of level 1 or 2 holds, at most 64 * BVXI_VDB_WORDS, and where block i of one is. */
enum { BVXI_VDB_WORDS = 512 };
#define BVXI_VDB_TABLE(level) ((level) == 2 ? 32 * 32 * 32 : 16 * 16 * 16)
static inline void bvxi_vdb_below(int level, const int32_t at[3], int32_t i, int32_t below[3])
{
    int32_t const side = level == 2 ? 32 : 16;
    below[0] = at[0] * side + i / side / side;
    below[1] = at[1] * side + i / side % side;
    below[2] = at[2] * side + i % side;
}

int bvxi_vdb_kind(const bvxi_vdb_blocks *blocks, const int32_t at[3]);
/* What is set of a leaf: word x, bit 8 y + z. */
void bvxi_vdb_leaf_bits(const bvx_grid *grid, const int32_t at[3], uint64_t word[8]);
/* The distances of a leaf's active voxels; other values stay. */
void bvxi_vdb_leaf_values(const bvxi_vdb_tree *tree, const int32_t at[3], double value[512]);

#endif
