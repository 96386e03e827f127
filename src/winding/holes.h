/* holes.h - where a mesh is open: its boundary as closed loops, and a sheet over them. Not installed. */
#ifndef BVXI_HOLES_H
#define BVXI_HOLES_H

#include "solid/solid.h"

/* The loops, one after the other. A loop of points p[0] .. p[n - 1] has the
 * sheet of n - 2 triangles (i, m, j), m halfway between i and j, beginning
 * with (0, n - 1). What the sheet does over points i .. j is the node of m. */
typedef struct bvxi_holes {
    uint32_t *vertex;   /* of the mesh [Size: points] */
    uint64_t *loop_end; /* [Size: loops] */
    uint64_t points, loops;
    uint64_t room;    /* points that the arrays were made for */
    int32_t repeated; /* 1: the loops have some edge more than once */
} bvxi_holes;

/* Find the edges that an odd number of triangles have, corners at equal snapped places taken as one, and join
 * them to loops. Triangles without area among them cancel out. The loops depend on the snapped triangles
 * only, not on any order of theirs. No loop: every row of centres meets the mesh an even number of times.
 * snapped: of axis 0; corners are below its vertices. Scratch: 16 bytes a vertex; then 8 and about 150 an
 * open edge; where most corners have numbers of their own 30 a vertex. */
bvx_status bvxi_holes_open(bvx_context *ctx, const bvx_mesh_view *view, const bvxi_snapped *snapped,
                           bvxi_holes *holes);
/* The same, but for triangles' directions: an edge is open as many times as
 * more triangles run along it one way than the other, and the loops run
 * that way. No loop: every row meets the mesh as often entering as leaving. */
bvx_status bvxi_holes_open_signed(bvx_context *ctx, const bvx_mesh_view *view, const bvxi_snapped *snapped,
                                  bvxi_holes *holes);
/* The loops are looked for before rows have read the triangles: are all corners below the vertex count? */
bvx_status bvxi_holes_check_corners(bvx_context *ctx, const char *function, const bvx_mesh_view *view);
/* The loops that a rule looks at: signed for WINDING, else plain. The mesh is snapped for it; scratch 16
 * bytes a vertex more. Where nothing is repeated both kinds are the same. */
bvx_status bvxi_holes_open_rule(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                                const bvx_lattice *lattice, int32_t fill, bvxi_holes *holes);
/* hole_edges.c: the edges that triangles run along more often one way than the other, by vertices' numbers,
 * one for all at a place: from << 32 | to, that many times, or with odd_once once where that is odd. Edges
 * that cancel along a line are left out. The caller frees *edges, [Size: *count * 8] bytes. */
bvx_status bvxi_open_edges(bvx_context *ctx, const bvx_mesh_view *view, const bvxi_snapped *snapped,
                           int odd_once, uint64_t **edges, uint64_t *count);
/* hole_lines.c: what is left of such edges where those of one line lie on each other. Scratch: 100 bytes an
 * edge. */
bvx_status bvxi_cancel_lines(bvx_context *ctx, const bvxi_snapped *snapped, int odd_once, uint64_t **edges,
                             uint64_t *count);
void bvxi_holes_close(bvx_context *ctx, bvxi_holes *holes);

/* The nodes of a sheet over points i .. j, from large to small, without
 * recursion: push the whole, then take until 0. */
typedef struct bvxi_sheet_walk {
    uint64_t i[72], j[72]; /* two new ones for each taken, halved each time: below 2 * 33 */
    int32_t count;
} bvxi_sheet_walk;

static inline void bvxi_sheet_push(bvxi_sheet_walk *w, uint64_t i, uint64_t j)
{
    w->i[w->count] = i;
    w->j[w->count++] = j;
}

static inline int bvxi_sheet_take(bvxi_sheet_walk *w, uint64_t *i, uint64_t *j)
{
    if (w->count == 0) return 0;
    *i = w->i[--w->count];
    *j = w->j[w->count];
    return 1;
}

#endif
