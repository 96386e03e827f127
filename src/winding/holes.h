/* holes.h - where a mesh is open: its boundary as closed loops, a sheet over them, and winding numbers
 * between centres where surfaces need them. Not installed. */
#ifndef BVXI_HOLES_H
#define BVXI_HOLES_H

#include "solid/solid.h"

/* ---- Where a mesh is open: its boundary as closed loops, and a sheet over them ---- */

/* The loops, one after the other. A loop of points p[0] .. p[n - 1] has the
 * sheet of n - 2 triangles (i, m, j), m halfway between i and j, beginning
 * with (0, n - 1). What the sheet does over points i .. j is the node of m. */
typedef struct bvxi_holes {
    uint32_t *vertex;   /* of the mesh [Size: points] */
    uint64_t *loop_end; /* [Size: loops] */
    uint64_t points, loops;
    int32_t repeated; /* 1: the loops have some edge more than once */
} bvxi_holes;

/* Find the open edges, corners at equal snapped places taken as one, and join them to loops. odd_once: those
 * that an odd number of triangles have; no loop: every row of centres meets the mesh an even number of times.
 * Else an edge is open as many times as more triangles run along it one way than the other, and the loops run
 * that way; no loop: every row meets the mesh as often entering as leaving. Triangles without area cancel out.
 * The loops depend on the snapped triangles only, not on any order of theirs. snapped: of axis 0; corners are
 * below its vertices. Scratch: 16 bytes a vertex; then 8 and about 150 an open edge; where most corners have
 * numbers of their own 30 a vertex. */
bvx_status bvxi_holes_open(bvx_context *ctx, const bvx_mesh_view *view, const bvxi_snapped *snapped,
                           int odd_once, bvxi_holes *holes);
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
/* Edges of which as many leave each place as arrive are joined to loops behind those of holes, whose arrays have
 * room for count points and loops more. edges: from << 32 | to; become numbers by place, sorted. */
bvx_status bvxi_holes_append(bvx_context *ctx, const bvxi_snapped *s, uint64_t *edges, uint64_t count,
                             bvxi_holes *holes);
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

/* The triangles of the sheet over the holes, by the points of their loops; returns how many. */
uint64_t bvxi_sheet_triangles(const bvxi_holes *holes, uint32_t *corner);

/* ---- Generalized winding numbers between centres, for surfaces over holes ---- */

/* What the holes of a mesh look like from any centre of a lattice. */
typedef struct bvxi_winding bvxi_winding;

/* holes: those of the mesh on the lattice that the rule sees, BVX_FILL_WINDING or BVX_FILL_VOTE
 * (bvxi_holes_open_rule); they must stay. *winding stays NULL without any. Scratch: 16 bytes a vertex, about
 * 100 an open edge. mesh is not looked at later. */
bvx_status bvxi_winding_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                             const bvx_lattice *lattice, int32_t rule, const bvxi_holes *holes,
                             bvxi_winding **winding);
void bvxi_winding_close(bvx_context *ctx, bvxi_winding *winding);

/* From centre v to its neighbour along axis. [Units: lattice indices] */
typedef struct bvxi_winding_edge {
    int32_t v[3], axis;
} bvxi_winding_edge;

/* Where on each edge the winding number passes the rule's half, taken as linear: a ratio in [0.001, 0.999].
 * For edges that no triangle crosses and whose ends the rule has on either side; 0.5 where the angle has both
 * on one side (VOTE, rows decided). Called from workers. Cost: two angles an edge, to about 1e-3 turns. */
void bvxi_winding_ratios(const bvxi_winding *winding, int32_t count, const bvxi_winding_edge *edge,
                         double *ratio);

/* How far the winding number at a place of the lattice (fixed point) is
 * from a whole number, 0 to 0.5. Called from workers. */
double bvxi_winding_off(const bvxi_winding *winding, const int64_t p[3]);

/* solid's words become the centres whose generalized winding number is beyond a half. Local.
 * Scratch: as for the rule nonzero, holes.h and, where there are holes, sheet.h and turns.h. */
bvx_status bvxi_wind(bvx_context *ctx, bvxi_solid_job *job, const bvx_grid *solid, double from, double to,
                     bvx_solid_report *report);

#endif
