/* nearest_tree.h - the tree of boxes over triangles that answers many centres at once. It is searched in
 * floats, which decide only what cannot win, so neither the tree nor a reordering shows in any result. Not
 * installed. */
#ifndef BVXI_NEAREST_TREE_H
#define BVXI_NEAREST_TREE_H

#include "bits/bits.h"
#include "mesh/view.h"
#include "nearest/nearest.h"

/* Everything that is searched is in floats, in box units: a power of two of the world in which the lattice
 * lies within
 * [-1, 1] around its middle. Floats decide only what cannot win; what can is evaluated in doubles
 * (point_triangle.c), so neither the tree nor a rounding shows in an answer. How far floats may err: let
 * reach be the sum over the axes of a leaf's farthest coordinate from the search's origin, the leaf's extent
 * and the centre's coordinate. Rounding a corner, making its frame and turning a centre into it is less than
 * 32 roundings of numbers below reach, so a distance errs by less than BVXI_NEAR_ERROR reach, and by half a
 * unit of a foot's place in box units. Of 20 million even, thin, flat and tiny triangles none came to half of
 * that (test_nearest_parts.c). */

enum { BVXI_NEAR_WIDTH = 8, BVXI_NEAR_LEVELS = 10 }; /* 8^10 > 2^29 leaves */

#define BVXI_NEAR_ERROR 0x1p-19f
#define BVXI_NEAR_SLACK 0x1p-12f /* relative slack of squared distances that are compared to drop boxes */

/* Boxes of eight children side by side [Units: box]. */
typedef struct bvxi_near_node {
    float low[3][BVXI_NEAR_WIDTH], high[3][BVXI_NEAR_WIDTH];
    float point[3][BVXI_NEAR_WIDTH]; /* lowest level: from low to a point of the leaf's first triangle */
    uint32_t first;                  /* number of the first child in the level below, or of the first leaf */
} bvxi_near_node;

/* What is kept of a triangle: its frame. e1 runs along its longest edge, the origin
 * is the foot of the altitude on it, so the corners are (-p, 0), (q, 0), (0, h)
 * with p, q, h >= 0. That holds for needles and points as well, without loss. */
enum {
    BVXI_NEAR_FOOT = 0,
    BVXI_NEAR_E1 = 3,
    BVXI_NEAR_E2 = 6,
    BVXI_NEAR_E3 = 9,
    BVXI_NEAR_P = 12,
    BVXI_NEAR_Q = 13,
    BVXI_NEAR_H = 14,
    BVXI_NEAR_NUMBERS = 15
};

/* A line of a cache. */
typedef struct bvxi_near_frame {
    float f[BVXI_NEAR_NUMBERS];
    uint32_t triangle;
} bvxi_near_frame;

/* Up to eight triangles; the last one again where there are less. */
typedef struct bvxi_near_leaf {
    /* boxes, relative to the low corner of the leaf's box */
    float low[3][BVXI_NEAR_WIDTH], high[3][BVXI_NEAR_WIDTH];
    bvxi_near_frame frame[BVXI_NEAR_WIDTH];
} bvxi_near_leaf;

/* Nearest triangles that were found on the way: cubes of 16 x 16 x 16 centres of one window. */
typedef struct bvxi_near_memo {
    int32_t low[3], size[3]; /* the window */
    uint32_t *cube_slot;     /* number of each cube's triangles, or UINT32_MAX [Size: cubes of the window] */
    /* in the order of bricks (nearest_walk.h), UINT32_MAX: not known [Size: slots * 4096] */
    uint32_t *triangle;
    uint64_t cubes, slots;
} bvxi_near_memo;

struct bvxi_nearest {
    bvx_mesh_view view;
    bvx_lattice lattice;
    uint64_t triangle_count, leaf_count;
    bvxi_near_leaf *leaves;
    /* the lowest first: its children are leaves; the last has one node */
    bvxi_near_node *level[BVXI_NEAR_LEVELS];
    int32_t level_count;
    double scale;         /* world -> the units of the evaluation, a power of two */
    double middle[3];     /* of the lattice [Units: evaluation] */
    double box_scale;     /* evaluation -> box units, a power of two */
    double rounding;      /* above all rounding of the evaluation in doubles [Units: box] */
    bvxi_near_memo *memo; /* filled by bvxi_nearest_band */
    int32_t by_planes;    /* 1: bvxi_nearest_prefer_planes */
};

/* Fill a leaf from its triangles' numbers and corners, coordinate by
 * coordinate, in box units relative to the low corner of its box. */
void bvxi_near_make_leaf(const uint32_t number[BVXI_NEAR_WIDTH], const float corner[9][BVXI_NEAR_WIDTH],
                         const float low[3], int32_t fast, bvxi_near_leaf *leaf);

bvx_status bvxi_near_build(bvxi_call call, const double low[3], const double high[3], bvxi_nearest *n);
void bvxi_near_free(bvx_context *ctx, bvxi_nearest *n);

/* Corners of a triangle in the units of the evaluation. */
static inline void bvxi_near_corners(const bvxi_nearest *n, uint32_t triangle, double t[3][3])
{
    uint32_t c[3];
    bvxi_view_triangle(&n->view, triangle, c);
    for (int k = 0; k < 3; k++) {
        bvxi_view_position(&n->view, c[k], t[k]);
        for (int a = 0; a < 3; a++) t[k][a] *= n->scale;
    }
}

/* nearest_order.c: how many of the triangles left, at most eight, make a leaf; keys: theirs along the curve. cut: runs
 * may be less than they could be, as they must not be where eight times a leaf's number passes 32 bits. */
uint32_t bvxi_near_cut(const uint64_t *keys, uint64_t left, int cut);
#define BVXI_NEAR_CUT_BELOW (UINT64_C(1) << 29) /* triangles */

#endif
