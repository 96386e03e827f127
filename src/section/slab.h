/* slab.h - what lies between two planes: cells of the grid, those that were
 * subdivided, grid points inside the grid's own edges. */
#ifndef BVXI_SLAB_H
#define BVXI_SLAB_H

#include "section/section.h"

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
    uint8_t layer;
    uint32_t vertex; /* where the surface crosses the line over it */
} bvxi_hanging;

struct bvxi_slab {
    bvxi_plane *plane[2]; /* below, above; one of them may be an empty one */
    double w[2];
    const bvxi_plane *far[2]; /* the planes beyond, below and above, that a cubic blend looks at, or NULL */
    bvxi_split *split;
    uint32_t split_count, split_room;
    bvxi_leaf *leaf;
    uint32_t leaf_count, leaf_room;
    bvxi_arc *arc;
    uint32_t arc_count, arc_room;
    bvxi_hanging *hanging; /* by v, then u */
    uint32_t *by_u;        /* numbers of them by u, then v */
    uint32_t hanging_count, hanging_room;
    unsigned char *block; /* of all these arrays */
    uint64_t block_size;
    /* the surface between the planes, when each slab has its own: vertices
     * behind those of the rings, numbered from there */
    bvxi_section_mesh mesh;
    uint32_t lines; /* grid points whose line is crossed */
    uint64_t distances, ambiguous_faces, inner_vertices, crossed_cells;
    int owns_mesh; /* 1: arrays of its own, else stretches of all slabs' */
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

/* An array with room for one more. */
bvx_status bvxi_slab_enlarge(bvxi_stack *s, void *block, uint32_t *room, uint64_t item, const char *what);

static inline bvx_status bvxi_slab_grow(bvxi_stack *s, void *block, uint32_t count, uint32_t *room,
                                        uint64_t item, const char *what)
{
    return BVXI_LIKELY(count < *room) ? BVX_OK : bvxi_slab_enlarge(s, block, room, item, what);
}

#endif
