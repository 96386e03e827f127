/* nearest_brick.h - the nearest triangles of bricks of 4 x 4 x 4 centres. Not installed. */
#ifndef BVXI_NEAREST_BRICK_H
#define BVXI_NEAREST_BRICK_H

#include "nearest/nearest_eight.h"
#include "nearest/nearest_pairs.h"

enum { BVXI_NEAR_SLOTS = 64, BVXI_NEAR_CUBE = 16 }; /* slot x + 4 y + 16 z of a brick */
#define BVXI_NEAR_NONE UINT32_MAX

/* What one task works with. */
typedef struct bvxi_near_worker {
    bvxi_near_sieve sieve; /* what vectors walk through stands first, aligned */
    bvxi_near_list list;
    bvxi_near_eight eight;
    bvxi_near_pairs pairs;
    bvxi_near_winner winners[BVXI_NEAR_MEASURED * 8];
    bvxi_near_cell cell;
    int32_t fast;
    int32_t known;        /* the question's point is one of the mesh */
    int32_t started;      /* the caller's: start is that of the cube */
    int32_t few_reached;  /* the caller's: bricks without a centre within the width are expected */
    double started_width; /* the caller's: within this */
    bvxi_near_question question;
    bvxi_near_start start; /* where the searches of the cube's bricks begin */
    /* the brick */
    double centre[3][BVXI_NEAR_SIDE]; /* coordinates of its centres [Units: evaluation] */
    double middle[3];                 /* [Units: box] */
    float offset[3][BVXI_NEAR_SIDE];  /* of the centres from middle [Units: box] */
    bvxi_near_places places;          /* of the centres, for the list */
    uint64_t evaluated;               /* slots whose best is from the evaluation in doubles */
    uint32_t triangle[BVXI_NEAR_SLOTS];
    double distance2[BVXI_NEAR_SLOTS];
    double height2[BVXI_NEAR_SLOTS]; /* by_planes, of the evaluated: to the triangle's plane */
} bvxi_near_worker;

/* 0 when no centre of a cube of 16 x 16 x 16 lies within the width; its
 * first centre has these lattice indices. */
int32_t bvxi_near_cube_reaches(const bvxi_nearest *n, const int32_t first[3], double width,
                               bvxi_near_worker *w);

/* Begin a cube of 16 x 16 x 16 centres, whose first one has these lattice indices: bricks in it follow. */
void bvxi_near_cube_begin(const bvxi_nearest *n, const int32_t first[3], double width, bvxi_near_worker *w);

/* Centres of the brick whose first one has these lattice indices. */
void bvxi_near_brick_begin(const bvxi_nearest *n, const int32_t first[3], bvxi_near_worker *w);

/* Find the nearest triangle for each slot in wanted that is no further than width [Units: world, or
 * infinity]; BVXI_NEAR_NONE for others. Returns the slots that have one. */
uint64_t bvxi_near_brick_find(const bvxi_nearest *n, uint64_t wanted, double width, bvxi_near_worker *w);

#endif
