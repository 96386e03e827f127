/* sharp_edges.h - has a mesh sharp edges, as machine parts have? Not installed. */
#ifndef BVXI_SHARP_EDGES_H
#define BVXI_SHARP_EDGES_H

#include "core/core.h"

/* *sharp becomes 1 where many edges are sharp, or some are and few are merely bent, *share the sharp edges'
 * part of the length of all. Large meshes are scans: 0 without a look. representative: vertices at one place
 * (weld.h), NULL: they are found first. The view is checked, its indices too. Scratch: 36 bytes a triangle
 * and 4 a vertex. */
bvx_status bvxi_sharp_edges(bvx_context *ctx, const bvx_mesh_view *view, const uint32_t *representative,
                            int32_t *sharp, double *share);

#endif
