/* collapse.h - a mesh whose edges collapse to one target after the other. Inside the room only. */
#ifndef BVXI_COLLAPSE_H
#define BVXI_COLLAPSE_H

#include "simplify/sheets.h"

typedef struct bvxi_collapse bvxi_collapse;

/* What became of the edges that were tried. */
typedef struct bvxi_collapse_counts {
    uint64_t collapsed, refused;
    uint64_t split; /* vertices of several fans, when it was opened */
} bvxi_collapse_counts;

/* 1: a collapse of the mesh must know where its corners come from. */
int bvxi_collapse_needs_sources(const bvx_mesh_view *mesh, const bvxi_collapse_options *options);
/* Take the sheets of a checked mesh, or the mesh itself as a view; BVX_ERR_ARGUMENT: what options->borders does
 * not allow. The order of vertices and triangles does not matter where no two vertices are at one position. Both
 * must live as long as the collapse, which is scratch: 190 bytes a triangle; of n channels of attributes 200 + 32 n a vertex. */
bvx_status bvxi_collapse_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                              const bvxi_sheets *sheets, const bvxi_collapse_options *options,
                              bvxi_collapse **collapse);
/* Collapse the cheapest edges until at most target triangles are left or none can go. from, to: share of
 * progress. */
bvx_status bvxi_collapse_to(bvxi_collapse *collapse, uint64_t target, double from, double to);
/* The mesh as it is now, opened as by bvxi_mesh_open, with its attributes where the library owns its arrays; plain:
 * without them, so that what hangs together does so by its indices. */
bvx_status bvxi_collapse_give(bvxi_collapse *collapse, bvx_mesh *level);
bvx_status bvxi_collapse_give_plain(bvxi_collapse *collapse, bvx_mesh *level);
/* Pairs of triangles that cross; cheap where the collapse has counted them already. */
bvx_status bvxi_collapse_crossings(bvxi_collapse *collapse, uint64_t *count);
/* Triangles for the next try. Errors grow about as triangles become fewer, so n * part of them would take up
 * all of it; a collapse cannot be undone, so half of that way is gone, by ratios, and at least a twentieth. */
uint64_t bvxi_collapse_next_try(uint64_t triangles, double part);

#endif
