/* boolean_lattice.h - the lattice that fits an operation on two boxes, and
 * whether it is fine enough for them. Not installed. */
#ifndef BVXI_BOOLEAN_LATTICE_H
#define BVXI_BOOLEAN_LATTICE_H

#include "core/core.h"

typedef struct bvxi_body_box {
    double low[3], high[3];
} bvxi_body_box;

/* Around what can be left: of a difference the box of a, of an intersection what both have in common, else
 * both. An empty voxel on every side. Boxes that stick out take fraction bits, down to 4. */
bvx_status bvxi_boolean_lattice(bvx_context *ctx, int32_t operation, int32_t resolution,
                                const bvxi_body_box box[2], bvx_lattice *lattice);

/* Of the part of a box that lies on the lattice: its longest and its
 * shortest side, 0 when there is none. [Units: voxels] */
typedef struct bvxi_box_sides {
    double longest, shortest;
    int32_t whole; /* 1: all of the box lies on the lattice */
} bvxi_box_sides;

bvxi_box_sides bvxi_sides_on_lattice(const bvxi_body_box *box, const bvx_lattice *lattice);

/* Seen in fewer voxels than FEW along its longest side a body is coarse: FEW_WANTED would show it. */
enum { BVXI_BOOLEAN_FEW = 16, BVXI_BOOLEAN_WANTED = 64 };

/* The resolution at which so many voxels become wanted, at most 2^24. */
int32_t bvxi_advised_resolution(const bvx_lattice *lattice, double voxels, double wanted);

#endif
