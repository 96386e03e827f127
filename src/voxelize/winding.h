/* winding.h - generalized winding numbers between centres, for surfaces over holes. Not installed. */
#ifndef BVXI_WINDING_H
#define BVXI_WINDING_H

#include "core/core.h"

/* What the holes of a mesh look like from any centre of a lattice. */
typedef struct bvxi_winding bvxi_winding;

/* *winding stays NULL for a mesh without open edges. rule: BVX_FILL_WINDING or BVX_FILL_VOTE. */
bvx_status bvxi_winding_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                             int32_t rule, bvxi_winding **winding);
void bvxi_winding_close(bvx_context *ctx, bvxi_winding *winding);

/* Where between centre v and its neighbour along axis (lattice indices) the winding number passes the rule's half: a ratio in
 * (0,1), taken as linear; 0.5 where it cannot be told. For edges that no triangle crosses. Called from workers. */
double bvxi_winding_ratio(const bvxi_winding *winding, const int32_t v[3], int32_t axis);

#endif
