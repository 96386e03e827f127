/* tree_file.h - the .bvx file of an octree: level by level, each with a checksum. Not installed.
 *
 * All numbers are little-endian; f64 is an IEEE double. hash(bytes, seed) is bvx_hash, whose recipe stands in
 * bitvox.h. A .bvx file of a grid (bvx_file.h) differs in its fourth byte.
 *
 *   Head, 128 bytes
 *     0   u8[8]   89 42 56 4f 0d 0a 1a 0a: a high byte and line ends show a transfer that took it for text
 *     8   u32     version of the format: 1
 *    12   u32     bytes of the head: 128
 *    16   f64[3]  origin of the lattice
 *    40   f64[3]  spacing of the last level
 *    64   i32[3]  voxels of level 0 along x, y, z: the base
 *    76   i32     fraction_bits of the last level
 *    80   i32     levels: the number of the last one
 *    84   u8[36]  reserved: 0
 *   120   u64     hash(bytes 0 to 119, 0)
 *   Then the levels 0 .. levels, each
 *     0   u64     hash(bytes 8 to the level's end, frame), frame being hash(bytes 16 to 119 of the head, 0)
 *     8   u32     level
 *    12   u32     split: 0 none of its voxels (the last level), 1 all that triangles touch, 2 some of them
 *    16   u64     n, words in each of the arrays that follow
 *    24   u64[n]  touched: voxels that a triangle touches
 *         u64[n]  outside: voxels that none touches and that are outside; what has neither bit is inside
 *         u64[n]  split, where some are: those of the touched ones that the next level has in eight
 *   Nothing follows the last level.
 *
 *   Level 0 has rows of bits as a grid has: word (z * base y + y) * w + (x >> 6), bit x & 63, w words a row;
 *   bits past a row are 0.
 *   Level l + 1 has one byte for each split voxel of level l, in the order of their bits; byte i is bits 8 (i
 *   & 7) and on of word i >> 3, bit p = x + 2 y + 4 z of it the child (x, y, z). Bits past the last byte are
 *   0.
 *
 * So every length follows from what stands before it, and no file stands for more than its bytes. The same
 * tree always gives the same bytes. */
#ifndef BVXI_TREE_FILE_H
#define BVXI_TREE_FILE_H

#include "io_grid/bvx_file.h"
#include "refine/room.h"

enum { BVXI_TREE_LEVEL_HEAD = 24 };

/* Places in the head that a grid's file has not (bvx_file.h). */
enum { BVXI_TREE_AT_LEVELS = 80, BVXI_TREE_AT_RESERVED = 84 };

/* The seed of the levels' checksums. */
static inline uint64_t bvxi_tree_frame(const uint8_t *head)
{
    return bvx_hash(head + BVXI_BVX_AT_ORIGIN, BVXI_BVX_AT_CHECK - BVXI_BVX_AT_ORIGIN, 0);
}

/* How a level splits its voxels: as the tree keeps it, and how many arrays its file has. */
static inline int32_t bvxi_tree_split_kind(const bvxi_octets *o)
{
    return o->split == NULL ? BVXI_SPLIT_NONE : o->split == o->touched ? BVXI_SPLIT_ALL : BVXI_SPLIT_SOME;
}

static inline uint64_t bvxi_tree_arrays(uint32_t kind)
{
    return kind == BVXI_SPLIT_SOME ? 3 : 2;
}

/* ---- tree_file.c, written ---- */

bvx_status bvxi_write_tree(bvx_context *ctx, const bvx_octree *tree, bvx_buffer *file);

#endif
