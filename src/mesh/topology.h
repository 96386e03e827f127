/* topology.h - edges, fans and pieces of indexed triangles. Not installed. */
#ifndef BVXI_TOPOLOGY_H
#define BVXI_TOPOLOGY_H

#include "core/core.h"

/* Fill the counts and flags of a certificate that do not ask for positions, zero before: all but triangles, collapsed,
 * degenerate, area, volume and bounds, which stay as they are.
 * corners [Size: triangle_count * 3], numbers below vertex_count, three different ones a triangle, triangle_count
 * below 2^32 / 3. Scratch: 40.4 bytes a triangle and 4.3 a vertex. */
bvx_status bvxi_topology(bvx_context *ctx, const uint32_t *corners, uint64_t triangle_count, uint64_t vertex_count,
                         bvx_certificate *certificate);

#endif
