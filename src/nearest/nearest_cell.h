/* nearest_cell.h - what may hold the nearest point of some centre of a cell. Not installed. */
#ifndef BVXI_NEAREST_CELL_H
#define BVXI_NEAREST_CELL_H

#include "nearest/nearest_tree.h"

enum {
    BVXI_NEAR_BLOCKS = 64,
    BVXI_NEAR_STARTS = 24,
    BVXI_NEAR_STACK = (BVXI_NEAR_LEVELS + BVXI_NEAR_STARTS) * BVXI_NEAR_WIDTH
};

/* The leaves of one node, relative to the cell's origin [Units: box]. */
typedef struct bvxi_near_block {
    /* the leaf's box; its numbers are relative to low */
    float low[3][BVXI_NEAR_WIDTH], high[3][BVXI_NEAR_WIDTH];
    float point[3][BVXI_NEAR_WIDTH]; /* a point of its first triangle */
    uint32_t first;                  /* number of the first leaf */
    uint32_t listed;   /* bit k: leaf first + k may hold the nearest point of some centre of the cell */
    uint32_t spare[6]; /* for alignment */
} bvxi_near_block;

typedef struct bvxi_near_list {
    bvxi_near_block block[BVXI_NEAR_BLOCKS];
    int32_t count;     /* blocks */
    float error;       /* above the error of distances to the listed triangles from centres of the cell */
    int32_t spare[14]; /* so that what follows is aligned as the list is */
} bvxi_near_list;

typedef struct bvxi_near_visit {
    float distance2;
    int32_t level;
    uint32_t node; /* in its level */
} bvxi_near_visit;

/* A box of centres and a search for leaves around it. All is relative to origin, which floats hold
 * exactly. */
typedef struct bvxi_near_cell {
    float origin[3];         /* [Units: box] */
    float first[3], last[3]; /* the outermost centres */
    float limit2;            /* leaves beyond its root are left out */
    float rounding;          /* of the evaluation */
    float point[3];          /* the nearest known point of the mesh */
    float point_error;       /* its triangle is evaluated no further away than point by more than this */
    float point_distance2;   /* from the middle of the cell */
    /* squares of the ends' distances to point along each axis, with slack */
    float first_bound[3], last_bound[3];
    int32_t open; /* visits on the stack */
    bvxi_near_visit stack[BVXI_NEAR_STACK];
} bvxi_near_cell;

/* The centres of a cell and what is known of the mesh, in box units. */
typedef struct bvxi_near_question {
    double first[3], last[3]; /* the outermost centres */
    double limit;             /* leaves beyond it are left out, or infinity */
    double point[3];          /* a point of the mesh */
    double point_error;       /* its triangle is evaluated no further away by more than this */
} bvxi_near_question;

/* Nodes of the lowest level that may matter to cells within a larger one, where their searches begin. */
typedef struct bvxi_near_start {
    /* eight nodes' boxes each; those that there are not lie far off */
    bvxi_near_node box[BVXI_NEAR_STARTS];
    uint32_t node[BVXI_NEAR_STARTS * BVXI_NEAR_WIDTH];
    int32_t count; /* nodes; -1: too many, begin at the root */
} bvxi_near_start;

/* List the nodes for a cell. It is used up, but for the point that it knows. */
void bvxi_near_cell_start(const bvxi_nearest *n, bvxi_near_cell *cell, int32_t fast, bvxi_near_start *start);

/* Begin at the root, or with what was listed for a larger cell. */
void bvxi_near_cell_begin(const bvxi_nearest *n, const bvxi_near_question *q, const bvxi_near_start *start,
                          int32_t fast, bvxi_near_cell *cell);

/* What is further from a centre of the cell than the root of this cannot
 * win: the limit, and the known point of the mesh. */
float bvxi_near_cell_reach2(const bvxi_near_cell *cell);

/* Fill the list with leaves that may be nearest to a centre of the cell.
 * Returns 0 when it is full: more come with the next call. */
int32_t bvxi_near_cell_list(const bvxi_nearest *n, bvxi_near_cell *cell, int32_t fast, bvxi_near_list *list);

#endif
