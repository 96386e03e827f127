/* crossing_pairs.h - all pairs of triangles that cross, for callers who have the mesh welded. Not
 * installed. */
#ifndef BVXI_CROSSING_PAIRS_H
#define BVXI_CROSSING_PAIRS_H

#include "core/core.h"

/* As bvx_mesh_crossings, of a checked mesh with triangles that lie within bounds and whose vertices are
 * welded (weld.h). Vertices that no triangle uses may be anything. */
bvx_status bvxi_mesh_crossings(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                               const double low[3], const double high[3], const uint32_t *representative,
                               uint64_t *count, uint32_t *pairs, uint64_t capacity);

#endif
