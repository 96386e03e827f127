/* slab.h - what lies between two planes: cells of the grid, those that were
 * subdivided, grid points inside the grid's own edges. */
#ifndef BVXI_SLAB_H
#define BVXI_SLAB_H

#include "contours/section.h"

/* Corners of a cell as bits: 1 low u low v, 2 high u low v, 4 low u high v, 8 both high. */
typedef struct bvxi_leaf {
    int32_t low[2], size;          /* fixed point */
    uint8_t inside[2];             /* corners inside on the plane below, above */
    uint32_t arc[2], arc_count[2]; /* in the slab's arcs */
} bvxi_leaf;

typedef struct bvxi_split {
    uint32_t cell, leaf, leaf_count; /* the cell by its key */
} bvxi_split;

/* A corner of a leaf that is not a grid point. */
typedef struct bvxi_hanging {
    int32_t at[2];
    uint8_t inside[2];
    uint32_t vertex; /* where the surface crosses the line over it */
} bvxi_hanging;

struct bvxi_slab {
    bvxi_plane *plane[2]; /* below, above; one of them may be an empty one */
    double w[2];
    const bvxi_plane *far[2]; /* the planes beyond, below and above, that a cubic blend looks at, or NULL */
    bvxi_split *split;
    uint32_t split_count;
    bvxi_leaf *leaf;
    uint32_t leaf_count;
    bvxi_arc *arc;
    uint32_t arc_count;
    bvxi_hanging *hanging; /* by v, then u */
    uint32_t *by_u;        /* numbers of them by u, then v */
    uint32_t hanging_count;
    uint64_t split_room, leaf_room, arc_room, hanging_room;
    /* the surface between the planes, when each slab has its own: vertices
     * behind those of the rings, numbered from there */
    bvxi_section_mesh mesh;
    uint32_t lines; /* grid points whose line is crossed */
    /* number of the plane below that has loops, or none; which nesting level it holds */
    uint32_t below, level;
};

/* Which side of a cell a cut lies on: 0 low v, 1 high u, 2 high v, 3 low u: counter-clockwise. */
static inline int bvxi_side_of(const bvxi_line_cut *c, const int32_t low[2])
{
    if (c->axis == 0) return c->line == low[0] ? 3 : 1;
    return c->line == low[1] ? 0 : 2;
}

static inline int bvxi_grid_bit(const bvxi_stack *s, const bvxi_plane *p, int32_t i, int32_t j)
{
    return (int)(p->inside[(size_t)j * (size_t)s->words + (size_t)(i >> 6)] >> (i & 63) & 1);
}

/* ---- slab.c: cells as they are subdivided ---- */

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
    uint64_t sorted_room; /* of these three */
    bvxi_arc *pool;
    uint32_t pool_count, piece_count;
    uint64_t pool_room, piece_room;
    bvxi_split_piece *piece;
    /* of the cell being split, on one plane */
    int32_t middle[2];
    /* crossings of the low and high half of the line of the middle u, of the middle v */
    uint32_t odd_u[2], odd_v[2];
} bvxi_split_work;

/* ---- nesting.c: loops that lie in others, blended level by level ---- */

bvx_status bvxi_nesting_open(bvxi_stack *stack);

/* Which loops of neighbouring planes belong to which level: all but stack->nesting.plane. */
bvx_status bvxi_nesting_find(bvxi_stack *stack);

/* Each level as a plane of its own. */
bvx_status bvxi_nesting_make(bvxi_stack *stack);
/* What has changed in the section since: crossings, or the ring. */
void bvxi_nesting_refresh(bvxi_plane *level);

/* Find levels of one slab that cross, and mark it to be blended as a whole: *found such slabs. */
bvx_status bvxi_nesting_crossed(bvxi_stack *stack, const bvxi_slab *slabs, uint32_t count, uint32_t *found);

#endif
