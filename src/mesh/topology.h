/* topology.h - edges, fans and pieces of indexed triangles. Not installed. */
#ifndef BVXI_TOPOLOGY_H
#define BVXI_TOPOLOGY_H

#include "mesh/weld.h"

/* Fill the counts and flags of a certificate that do not require positions, zero before: all but triangles,
 * collapsed, degenerate, area, volume and bounds, which stay as they are.
 * corners [Size: triangle_count * 3], numbers below vertex_count, three different ones a triangle,
 * triangle_count below 2^32 / 3. edges_alone: 1: vertices, pieces and what follows from them are left out.
 * Progress is reported every so many vertices and corners, from 0.4 of "check" on.
 * Scratch: 40.4 bytes a triangle and 4.3 a vertex. */
bvx_status bvxi_topology(bvx_context *ctx, const uint32_t *corners, uint64_t triangle_count,
                         uint64_t vertex_count, int edges_alone, bvx_certificate *certificate);

/* check.c: what bvx_mesh_check tells of a welded mesh; edges_alone as above. */
bvx_status bvxi_check_welded(bvx_context *ctx, const char *function, const bvxi_welded *mesh, int edges_alone,
                             bvx_certificate *certificate);

#endif
