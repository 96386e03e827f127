/* enclose.h - a surface around a mesh that touches none of it, for bvx_hull. Not installed. */
#ifndef BVXI_ENCLOSE_H
#define BVXI_ENCLOSE_H

#include "core/core.h"

/* Closed, manifold, oriented, without crossings; no point of it is as far as farthest, or on the mesh. The view is checked
 * and has triangles. Memory: a field 2.8 spacings wide to each side, of a fifth of farthest, and three grids. */
bvx_status bvxi_enclose(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh, double farthest,
                        bvx_lattice *lattice, bvx_mesh *surface);

#endif
