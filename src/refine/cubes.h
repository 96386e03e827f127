/* cubes.h - 4 x 4 x 4 voxels as bits of a word, an octet and the octets of its children, in which states.c
 * floods; and which children a triangle touches, as the level's steps call it. Not installed. */
#ifndef BVXI_CUBES_H
#define BVXI_CUBES_H

#include "lattice/lattice.h"

/* ---- 4 x 4 x 4 voxels in a word: an octet and the octets of its children ---- */

/* Voxel (x, y, z) is bit x + 4 y + 16 z. Child p of the octet is the 2 x 2 x 2 voxels from (2 p_x, 2 p_y, 2
 * p_z) on; a child that is not split has all of them alike. */

#define BVXI_CUBE_X0    UINT64_C(0x1111111111111111)
#define BVXI_CUBE_X3    UINT64_C(0x8888888888888888)
#define BVXI_CUBE_Y0    UINT64_C(0x000f000f000f000f)
#define BVXI_CUBE_Y3    UINT64_C(0xf000f000f000f000)
#define BVXI_CUBE_Z0    UINT64_C(0x000000000000ffff)
#define BVXI_CUBE_Z3    UINT64_C(0xffff000000000000)
#define BVXI_CUBE_CHILD UINT64_C(0x0000000000330033) /* voxels of child 0 */

/* Voxels on the side towards direction d (room.h). */
static inline uint64_t bvxi_cube_side(int d)
{
    static const uint64_t side[6] = {BVXI_CUBE_X0, BVXI_CUBE_Y0, BVXI_CUBE_Z0,
                                     BVXI_CUBE_X3, BVXI_CUBE_Y3, BVXI_CUBE_Z3};
    return side[d];
}

/* The voxels beyond side d, in the next cube, beside voxels on that side. */
static inline uint64_t bvxi_cube_beyond(uint64_t side, int d)
{
    static const uint8_t step[3] = {3, 12, 48};
    return d >= 3 ? side >> step[d - 3] : side << step[d];
}

/* First bit of child p. */
static inline unsigned bvxi_cube_shift(uint32_t p)
{
    return (p & 1) * 2 + (p >> 1 & 1) * 8 + (p >> 2) * 32;
}

/* The children of a child's octet as voxels of child 0, and back. */
static inline uint64_t bvxi_cube_spread(uint32_t mask)
{
    return (uint64_t)((mask & 3) | (mask & 12) << 2 | (mask & 48) << 12 | (mask & 192) << 14);
}

static inline uint32_t bvxi_cube_gather(uint64_t child)
{
    uint32_t const w = (uint32_t)child;
    return (w & 3) | (w >> 2 & 12) | (w >> 12 & 48) | (w >> 14 & 192);
}

/* All of `open` that is connected with g through faces; g lies in open. */
static inline uint64_t bvxi_cube_flood(uint64_t g, uint64_t open)
{
    for (uint64_t before = 0; before != g;) {
        before = g;
        g |= ((g & ~BVXI_CUBE_X3) << 1 | (g & ~BVXI_CUBE_X0) >> 1) & open;
        g |= ((g & ~BVXI_CUBE_Y3) << 4 | (g & ~BVXI_CUBE_Y0) >> 4) & open;
        g |= (g << 16 | g >> 16) & open;
    }
    return g;
}

/* ---- Which children of a voxel a triangle touches ---- */

/* The octants of a cube that a triangle touches, closed sets: bit x + 2 y + 4
 * z. p: the triangle's corners relative to the cube's centre, half: the side
 * of an octant [Units: fixed-point steps]. The triangle must touch the cube. */
uint32_t bvxi_children_touched(const int32_t (*p)[3], int32_t half);

/* ---- children.c: the same for many triangles at once ---- */

enum { BVXI_CHILDREN_BATCH = 128 };

typedef struct bvxi_children_batch {
    int32_t p[3][3][BVXI_CHILDREN_BATCH]; /* corner, axis */
    uint8_t touched[BVXI_CHILDREN_BATCH]; /* the answers */
    uint16_t open[BVXI_CHILDREN_BATCH];   /* triangles that their boxes do not decide */
    double q[9][BVXI_CHILDREN_BATCH];     /* corners of these */
    int64_t missed[BVXI_CHILDREN_BATCH], unsure[BVXI_CHILDREN_BATCH];
} bvxi_children_batch;

/* cpu: BVX_CPU_... */
void bvxi_children_of_batch(bvxi_children_batch *batch, uint32_t count, int32_t half, int32_t cpu);

/* Octants that two neighbours of a cube are, by bits: 1 when a mask, which is not 0, is such a pair. */
static inline int bvxi_children_are_pair(uint32_t mask)
{
    uint32_t const low = mask & (0 - mask), high = mask ^ low;
    return (high & (high - 1)) == 0 && ((high == low << 1 && (low & 0x55) != 0) ||
                                        (high == low << 2 && (low & 0x33) != 0) || high == low << 4);
}

#endif
