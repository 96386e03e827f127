/* split.h - cells between two planes as they are subdivided. Not installed. */
#ifndef BVXI_SECTION_SPLIT_H
#define BVXI_SECTION_SPLIT_H

#include "section/slab.h"

typedef struct bvxi_split_cell {
    int32_t low[2], size, depth;
    uint8_t inside[2];
    uint32_t arc[2], arc_count[2]; /* in the pool */
} bvxi_split_cell;

typedef struct bvxi_split_piece {
    bvxi_arc arc;
    uint32_t quadrant;
} bvxi_split_piece;

typedef struct bvxi_split_work {
    bvxi_stack *s;
    bvxi_slab *slab;
    bvxi_slab grown; /* what a slab's cells become, in arrays that the slabs have in turn */
    int is_last;     /* 1: in the last slab */
    uint64_t *key;   /* of its hanging corners */
    uint32_t *order;
    bvxi_hanging *sorted;
    uint32_t key_room, order_room, sorted_room;
    bvxi_arc *pool;
    uint32_t pool_count, pool_room;
    bvxi_split_piece *piece;
    uint32_t piece_count, piece_room;
    /* of the cell being split, on one plane */
    int32_t middle[2];
    /* crossings of the low and high half of the line of the middle u, of the middle v */
    uint32_t odd_u[2], odd_v[2];
} bvxi_split_work;

/* Subdivide a cell of the grid where its contours require it: leaves, arcs and corners go to the slab. */
bvx_status bvxi_split_grid_cell(bvxi_split_work *w, int32_t i, int32_t j);

#endif
