/* collapse.h - fewer triangles by collapsing edges. Not installed. */
#ifndef BVXI_COLLAPSE_H
#define BVXI_COLLAPSE_H

#include "core/core.h"

/* Collapse edges of a closed, manifold, oriented mesh until at most target triangles are left or nothing more can go;
 * positions and triangles are compacted in place and the counts set (after a failure both are unspecified).
 * Scratch: about 240 bytes a vertex. Cost: O(triangles log triangles). */
bvx_status bvxi_collapse_edges(bvx_context *ctx, double *positions, uint64_t *vertex_count, uint32_t *triangles,
                         uint64_t *triangle_count, uint64_t target);

#endif
