/* bvx_file.h - the .bvx file: a bit grid with its lattice, slice by slice, each with a checksum. Not
 * installed.
 *
 * All numbers are little-endian; f64 is an IEEE double. hash(bytes, seed) is bvx_hash, whose recipe stands in
 * bitvox.h.
 *
 *   Head, 128 bytes
 *     0   u8[8]   89 42 56 58 0d 0a 1a 0a: like PNG's, a high byte and line ends show a transfer that took it
 *     for text
 *     8   u32     version of the format: 1
 *    12   u32     bytes of the head: 128
 *    16   f64[3]  lattice.origin
 *    40   f64[3]  lattice.spacing
 *    64   i32[3]  lattice.dims
 *    76   i32     lattice.fraction_bits
 *    80   i32[2]  window.low x, y: lattice index of the file's first voxel
 *    88   i32[2]  window.size x, y
 *    96   i32     window.low z
 *   100   i32     window.size z
 *   104   u64[2]  reserved: 0
 *   120   u64     hash(bytes 0 to 119, 0)
 *   Then window.size z slices, z rising by one, each
 *     0   u64     hash(bytes 8 to the slice's end, frame), frame being hash(bytes 16 to 95 of the head, 0): a
 *                 slice of another lattice or another window in x and y does not pass for one of this file
 *     8   u32     lattice index z
 *    12   u32     encoding: 0 or 1
 *    16   u64     n, bytes that follow
 *    24   u8[n]   the slice
 *   Nothing follows the last slice.
 *
 *   Encoding 0: the slice's rows, y rising; a row is (size x + 63) / 64 words of u64, voxel x is bit x & 63
 *   of word x >> 6, bits past the row are 0.
 *   Encoding 1: lengths of runs along the slice's size x * size y voxels, x fastest, by turns of empty and
 *   set voxels, the empty ones first. The first length may be 0, no other is; together they are all voxels of
 *   the slice. A length is written seven bits a byte, the lowest first, all bytes but its last with 128
 *   added, in as few bytes as it takes: at most 8, as a slice has at most 2^50 voxels.
 *
 * Our writer takes encoding 1 where it is the shorter one; a reader takes either. The same grid always gives
 * the same bytes, however it was cut into parts for bvx_write_slices.
 *
 * What runs allow: 25 bytes a slice are the least that a file can have, and they can stand for 2^50 voxels.
 * So a reader checks every slice that it wants before it allocates a grid, makes the grid only of the window
 * that is wanted, and leaves its size to the context's memory limit. The checksum is over the packed bytes,
 * not over the words, so that checking a file and taking a small window out of it cost no more than its
 * bytes, whatever they stand for. */
#ifndef BVXI_BVX_FILE_H
#define BVXI_BVX_FILE_H

#include "io_grid/grid_formats.h"

enum {
    BVXI_BVX_VERSION = 1,
    BVXI_BVX_HEAD = 128,
    BVXI_BVX_SLICE_HEAD = 24,
    BVXI_BVX_RAW = 0,
    BVXI_BVX_RUNS = 1
};

/* Places in the head. */
enum {
    BVXI_BVX_AT_VERSION = 8,
    BVXI_BVX_AT_HEAD_SIZE = 12,
    BVXI_BVX_AT_ORIGIN = 16,
    BVXI_BVX_AT_SPACING = 40,
    BVXI_BVX_AT_DIMS = 64,
    BVXI_BVX_AT_FRACTION = 76,
    BVXI_BVX_AT_LOW = 80,
    BVXI_BVX_AT_SIZE = 88,
    BVXI_BVX_AT_Z = 96,
    BVXI_BVX_AT_RESERVED = 104,
    BVXI_BVX_AT_CHECK = 120
};

/* What heads of files of grids and of octrees have in common; the sides are the lattice's dims, for a tree
 * those of its base. Taken, it is refused where it is not of a file of this kind, of another version or
 * damaged. */
enum { BVXI_BVX_GRID, BVXI_BVX_TREE };
bvx_status bvxi_bvx_take_start(const bvxi_grid_source *source, int kind, bvx_lattice *lattice);
void bvxi_bvx_put_start(uint8_t *head, int kind, const bvx_lattice *lattice, const int32_t sides[3]);

/* Numbers beyond int32 become -1, which no field allows. */
static inline int32_t bvxi_load_side(const uint8_t *p)
{
    uint32_t const v = bvxi_load_u32(p, 0);
    return v <= INT32_MAX ? (int32_t)v : -1;
}

/* The seed of the slices' checksums. */
static inline uint64_t bvxi_bvx_frame(const uint8_t *head)
{
    return bvx_hash(head + BVXI_BVX_AT_ORIGIN, BVXI_BVX_AT_Z - BVXI_BVX_AT_ORIGIN, 0);
}

/* The checksum of a slice that stands at p with n bytes after its head. */
static inline uint64_t bvxi_bvx_slice_check(const uint8_t *p, uint64_t n, uint64_t frame)
{
    return bvx_hash(p + 8, (size_t)(BVXI_BVX_SLICE_HEAD - 8 + n), frame);
}

#endif
