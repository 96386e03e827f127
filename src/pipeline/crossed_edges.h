/* crossed_edges.h - the ends of lattice edges that a surface crosses: the only
 * centres that need a distance. Not installed. */
#ifndef BVXI_CROSSED_EDGES_H
#define BVXI_CROSSED_EDGES_H

#include "grid/grid.h"

/* Set the words of where, of inside's window: centres with a neighbour (across a
 * face, in the window) that differs from them in inside, and in body too when
 * that is not NULL. Beyond the window all is outside along x; y and z stop there. */
bvx_status bvxi_ends_mark(bvx_context *ctx, const bvx_grid *inside, const bvx_grid *body, bvx_grid *where);

#endif
