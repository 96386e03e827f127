/* winding.h - generalized winding numbers between centres, for surfaces over holes. Not installed. */
#ifndef BVXI_WINDING_H
#define BVXI_WINDING_H

#include "winding/holes.h"

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
