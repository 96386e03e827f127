/* slab_fill.h - the surface of one slab as it is made, cell by cell. Not installed. */
#ifndef BVXI_SECTION_SLAB_FILL_H
#define BVXI_SECTION_SLAB_FILL_H

#include "section/trace.h"

typedef struct bvxi_slab_work {
    bvxi_stack *s; /* the stack, or a view of it */
    bvxi_field field;
    bvxi_trace trace;
    bvxi_vertex_map map[2];
    uint64_t *row;       /* cells of one row of the grid that the surface may cross */
    uint64_t *split_bit; /* the subdivided cells, in rows of words */
    uint32_t split;      /* the next subdivided cell */
    uint32_t map_top;    /* the map of the level above */
    uint32_t arc[2];     /* the next arc of either plane */
    uint32_t line[2];    /* the next crossing of a line on the low side of the row and on the high one */
    int plain;           /* 1: cells of this slab may be plain */
    int only_traced;     /* 1: no cell is taken as plain; what comes of it is the same */
} bvxi_slab_work;

/* lines: the most crossings of lines of a slab; loop: vertices of the
 * longest loop that is likely. Close it also after a failure. */
bvx_status bvxi_slab_work_open(bvxi_slab_work *work, bvxi_stack *stack, uint32_t lines, uint32_t loop);
void bvxi_slab_work_close(bvxi_slab_work *work);
/* The surface between two planes, into the mesh of the work's stack. */
bvx_status bvxi_slab_fill(bvxi_slab_work *work, bvxi_slab *slab);

/* A cell that no contour crosses twice on one side, alone with itself: see
 * plain_cell.c. arc: how many on either plane; line: the vertices over its corners,
 * counter-clockwise. *done is 0, and nothing was made, where the cell is not plain. */
bvx_status bvxi_slab_plain_cell(bvxi_slab_work *work, const uint32_t arcs[2], const uint32_t inside[2],
                                const uint32_t line[4], int *done);

/* ---- all_slabs.c: all of them ---- */

#endif
