/* crossing_pairs.h - all pairs of triangles that cross, for callers who have the mesh welded. Not
 * installed. */
#ifndef BVXI_CROSSING_PAIRS_H
#define BVXI_CROSSING_PAIRS_H

#include "mesh/weld.h"

/* As bvx_mesh_crossings, of a welded mesh with triangles. Vertices that no triangle uses may be anything. */
bvx_status bvxi_mesh_crossings(bvx_context *ctx, const char *function, const bvxi_welded *mesh,
                               uint64_t *count, uint32_t *pairs, uint64_t capacity);

#endif
