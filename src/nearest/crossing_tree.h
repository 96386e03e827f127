/* crossing_tree.h - boxes over triangles, which pairs of them cross, and what crosses one of them. Not installed. */
#ifndef BVXI_CROSSING_TREE_H
#define BVXI_CROSSING_TREE_H

#include "core/core.h"

#define BVXI_VERTEX_NONE UINT32_MAX

enum { CROSSING_WIDTH = 8, CROSSING_LEVELS = 12, CROSSING_SLANTS = 4 };

/* Boxes along the axes: of each the lowest coordinate, then the highest one with the other sign, so that a larger
 * box has smaller numbers. */
typedef struct crossing_node {
    int16_t bound[6][CROSSING_WIDTH];
} crossing_node;

/* Along the four diagonals of a cube. */
typedef struct crossing_slant {
    int16_t bound[2 * CROSSING_SLANTS][CROSSING_WIDTH];
} crossing_slant;

/* Boxes over triangles in an order of space; those that are gone have none. */
typedef struct crossing_tree {
    /* Positions, and triangles' vertices, each so many numbers after the one before. */
    const double *at;
    const uint32_t *vertex;
    uint64_t at_step, vertex_step;
    const uint8_t
        *graph; /* of each vertex, 1: its triangles lie side by side, seen along some direction; or NULL */
    const uint8_t *fresh; /* of each vertex; pairs without such a one are left out; NULL: none are */
    const uint32_t *live; /* triangles in an order of space; NULL: all, as they are [Size: triangles] */
    uint64_t triangles;
    double low[3], scale; /* (position - low) * scale is within 0 and 1 */

    /* node[0][i]: triangles 8i .. 8i + 7; node[l][i]: nodes 8i .. 8i + 7 of level l - 1 */
    crossing_node *node[CROSSING_LEVELS];
    uint64_t nodes[CROSSING_LEVELS];
    int32_t levels, slanted; /* slanted 1: with */
    int32_t touching;        /* 1: a common corner is crossing too, and so are triangles without an area */
    crossing_slant *slant;   /* of each node of level 0 */
} crossing_tree;

/* Set the boxes of a tree whose fields before node are set. Scratch: 14 bytes a triangle, slanted 30, at node[0]. */
bvx_status bvxi_crossing_tree_open(bvx_context *ctx, crossing_tree *tree);
/* Triangle t has moved or come back: its box is its own again, those above grow. */
void bvxi_crossing_tree_move(crossing_tree *tree, uint32_t t);

/* Find pairs of triangles that cross. *pairs becomes a block of scratch [Size: *count * 2], in rising order, each with
 * its lower index first, or NULL where there are none, or more than most. */
bvx_status bvxi_crossings_find(bvx_context *ctx, const crossing_tree *tree, double from, double to,
                               uint64_t most, uint32_t **pairs, uint64_t *count);

/* Call visit for each triangle that crosses the one with corners p, but those with a vertex u or v, or one that skip
 * marks, or with vertices that all have BVXI_VERTEX_NONE in still (NULL: none), until it returns 1; returns what it
 * returned last, or 0. visit NULL: 1 where there is any. */
typedef int crossing_visit(void *user, uint32_t t);
int bvxi_crossing_tree_visit(const crossing_tree *tree, const double *const p[3], uint32_t u, uint32_t v,
                             const uint8_t *skip, const uint32_t *still, crossing_visit *visit, void *user);

/* 1 when both triangles cross. */
int bvxi_crossing_pair(const crossing_tree *tree, uint32_t s, uint32_t t);

#endif
