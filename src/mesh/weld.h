/* weld.h - vertices at equal positions. Not installed. */
#ifndef BVXI_WELD_H
#define BVXI_WELD_H

#include "core/core.h"

/* representative[v] becomes the least number of a vertex at the position of v; -0 equals 0. *different counts
 * the positions. Progress is reported every so many vertices. The view is checked and its coordinates are
 * finite. representative [Size: vertex_count]. Scratch: 6 bytes a vertex, 8 where hashes collide on
 * purpose. */
bvx_status bvxi_weld(bvx_context *ctx, const bvx_mesh_view *view, uint32_t *representative,
                     uint64_t *different);

/* A checked mesh of which this is known. */
typedef struct bvxi_welded {
    const bvx_mesh_view *view;
    double low[3], high[3]; /* bounds of its triangles */
    const uint32_t *representative;
    uint64_t different;
} bvxi_welded;

#endif
