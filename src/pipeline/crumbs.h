/* crumbs.h - small parts of a solid that the meshes it was made from have no part for. Not installed. */
#ifndef BVXI_CRUMBS_H
#define BVXI_CRUMBS_H

#include "core/core.h"

/* A mesh that the solid was made from. piece: of each vertex, as bvxi_pieces fills it. */
typedef struct bvxi_crumb_source {
    const bvx_mesh_view *mesh;
    const uint32_t *piece;
} bvxi_crumb_source;

enum { BVXI_CRUMB_SOURCES = 2 };

/* Drop the crumbs of a solid (empty 0), or fill the pockets that are crumbs of what is empty (1); *dropped
 * becomes their number. A crumb is a small part without a voxel whose six neighbours are of the part too, and
 * not the one that a piece of a mesh has for itself. sources: checked meshes with triangles. Scratch: the
 * parts' runs, a grid, for small parts 12 bytes a vertex and, where the meshes have several pieces, what
 * bvx_closest_create needs. */
bvx_status bvxi_drop_crumbs(bvx_context *ctx, const char *function, bvx_grid *inside, int32_t empty,
                            const bvxi_crumb_source *source, int32_t sources, uint64_t *dropped);

#endif
