/* children.h - which children of a voxel a triangle touches. Not installed. */
#ifndef BVXI_CHILDREN_H
#define BVXI_CHILDREN_H

#include "lattice/lattice.h"

/* The octants of a cube that a triangle touches, closed sets: bit x + 2 y + 4
 * z. p: the triangle's corners relative to the cube's centre, half: the side
 * of an octant [Units: fixed-point steps]. The triangle must touch the cube. */
uint32_t bvxi_children_touched(const int32_t (*p)[3], int32_t half);

/* ---- children_batch.c: the same for many triangles at once ---- */

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
