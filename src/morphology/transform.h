/* transform.h - the exact Euclidean distance transform of bits, a tile of columns at a time. Not installed.
 *
 * For each voxel of a box the least square of the distance to a target: to a set voxel, or with flip to an
 * empty one.
 *   whole    squares of steps of voxels as uint32_t; the squared diagonal of the box must be below 2^32 - 1
 *   else     weight[0] * dx^2 + weight[1] * dy^2 + weight[2] * dz^2 in doubles, rounded after each product
 *            and sum from left to right; which target is nearest in a row, a slice and the box is decided
 *            exactly
 * Ties go to the target of least linear index (z, then y, then x). Each group of 16 squares along x is handed
 * to a sink, by tasks that run at the same time for different y. */
#ifndef BVXI_TRANSFORM_H
#define BVXI_TRANSFORM_H

#include "bits/bits.h"

enum { BVXI_LANES = 16 };
#define BVXI_FAR UINT32_MAX /* no target; in doubles infinity */

/* Bits without a lattice: bit x & 63 of words[(z * size[1] + y) * row_words + (x >> 6)], zeros past
 * size[0]. */
typedef struct bvxi_bit_box {
    uint64_t *words;
    int32_t size[3], row_words;
} bvxi_bit_box;

/* count squares (uint32_t or double) from voxel (x, y, z) on; nearest (or NULL) their targets' linear
 * indices, UINT64_MAX: none, or one beyond the box. */
typedef void bvxi_transform_sink(void *user, int32_t x, int32_t y, int32_t z, int32_t count,
                                 const void *squares, const uint64_t *nearest);

typedef struct bvxi_transform {
    bvx_context *ctx;
    const char *stage; /* for progress */
    double from, to;
    bvxi_bit_box box;
    int32_t flip;   /* 1: targets are the empty voxels */
    int32_t beyond; /* 1: all beyond the box are targets too */
    int32_t whole, nearest;
    int32_t groups; /* of 16 columns in a tile */
    double weight[3];
    double limit; /* squares above it may come out larger, or as none; infinity: all are wanted */
    bvxi_transform_sink *sink;
    void *user;
} bvxi_transform;

/* The squared diagonal fits whole squares. */
int bvxi_transform_fits_whole(const int32_t size[3]);
/* Memory (scratch): 16 * groups * 4 bytes a row (8 in doubles; nearest: 8 more), 8 a row, and what a worker
 * needs for a slice and a row of such columns. */
bvx_status bvxi_transform_run(const bvxi_transform *transform);

/* A row of bits; targets are the set ones, or with flip ~0 the others. */
typedef struct bvxi_target_row {
    const uint64_t *words;
    int32_t size; /* [Units: voxels] */
    uint64_t flip;
} bvxi_target_row;

/* For each row the targets nearest to the present 16 columns on both sides. */
typedef struct bvxi_row_carry {
    int32_t left, right; /* -1: none */
} bvxi_row_carry;

typedef struct bvxi_row_distances {
    uint8_t near[256][8]; /* in a byte: from bit i to the nearest set one; 127: there is none */
} bvxi_row_distances;

void bvxi_row_distances_start(bvxi_row_distances *table);
/* The carry of a row before its first 16 columns, and for those from x on when the ones before are done. */
void bvxi_row_carry_start(bvxi_row_carry *carry, const bvxi_target_row *row);
void bvxi_row_carry_next(bvxi_row_carry *carry, const bvxi_target_row *row, int32_t x);
/* Steps along x to the nearest target for 16 columns from x on, and (or
 * NULL) where that stands. 0: there is none within reach. */
int bvxi_row_steps(const bvxi_row_distances *table, const bvxi_row_carry *carry, const bvxi_target_row *row,
                   int32_t x, int32_t reach, int32_t steps[BVXI_LANES], int32_t *places);

/* 16 columns of n squares: square (place, lane) is in[place * 16 + lane] for the places that are listed,
 * ascending; the others have no target. out: for each place the least of in at another place plus the step
 * between them; from (or NULL): which place. */
typedef struct bvxi_columns {
    const void *in;
    void *out;
    int32_t *from;
    const int32_t *places;
    int32_t place_count, n, cpu;
    double weight;          /* of a squared step; doubles only */
    const double *inverse;  /* 1 / (2 i) [Size: n] */
    double *height, *start; /* [Size: n each] */
    int32_t *site;          /* [Size: n] */
} bvxi_columns;

void bvxi_whole_columns(const bvxi_columns *columns);
void bvxi_real_columns(const bvxi_columns *columns);

#endif
