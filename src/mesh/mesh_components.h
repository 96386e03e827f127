/* mesh_components.h - the parts of a mesh that hang together, and triangles that are there twice. Not
 * installed. */
#ifndef BVXI_MESH_COMPONENTS_H
#define BVXI_MESH_COMPONENTS_H

#include "core/core.h"

/* Join vertices by triangles: piece[v] becomes the least vertex that v
 * hangs together with. representative: vertices at one place (weld.h). The
 * view is checked, its indices too. piece [Size: vertex_count]. No memory. */
void bvxi_pieces(const bvx_mesh_view *view, const uint32_t *representative, uint32_t *piece);

/* List the corners of all triangles but those with two corners at one
 * place; returns how many. corner [Size: triangle_count * 3]. */
uint64_t bvxi_drop_collapsed(const bvx_mesh_view *view, const uint32_t *representative, uint32_t *corner);

/* List the corners of all triangles but those whose three places an earlier one has, in any order, and those
 * with two corners at one place. corner [Size: triangle_count * 3]; *kept is how many. Scratch: 6 bytes a
 * triangle, 8 where hashes collide on purpose. */
bvx_status bvxi_drop_duplicates(bvx_context *ctx, const bvx_mesh_view *view, const uint32_t *representative,
                                uint32_t *corner, uint64_t *kept);

#endif
