/* winding.h - generalized winding numbers between centres, for surfaces over holes. Not installed. */
#ifndef BVXI_WINDING_H
#define BVXI_WINDING_H

#include "core/core.h"

/* What the holes of a mesh look like from any centre of a lattice. */
typedef struct bvxi_winding bvxi_winding;

/* *winding stays NULL for a mesh without open edges, as the rule sees them: BVX_FILL_WINDING or BVX_FILL_VOTE. Scratch: 16 bytes a
 * vertex (and 40 while the edges are looked for), about 200 an open edge. mesh is not looked at later. */
bvx_status bvxi_winding_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                             int32_t rule, bvxi_winding **winding);
void bvxi_winding_close(bvx_context *ctx, bvxi_winding *winding);

/* Where between centre v and its neighbour along axis (lattice indices) the winding number passes the rule's half, taken as linear:
 * a ratio in [0.001, 0.999]. For edges that no triangle crosses and whose ends the rule has on either side; 0.5 where the angle
 * has both on one side (VOTE, rows decided). Called from workers. Cost: two angles, to about 1e-3 turns. */
double bvxi_winding_ratio(const bvxi_winding *winding, const int32_t v[3], int32_t axis);

/* How far the winding number at a place of the lattice (fixed point) is from a whole number, 0 to 0.5. Called from workers. */
double bvxi_winding_off(const bvxi_winding *winding, const int64_t p[3]);

#endif
