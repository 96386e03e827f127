/* polygon.h - polygons cut into triangles, as mesh readers need it. Not installed. */
#ifndef BVXI_POLYGON_H
#define BVXI_POLYGON_H

#include "core/core.h"

/* Scratch that grows with the largest polygon seen; zeroed it is ready. */
typedef struct bvxi_polygon {
    bvx_context *ctx;
    void *block;
    uint64_t block_size;
} bvxi_polygon;

/* Cut a polygon of count corners (3 or more, finite) into count - 2 triangles, three numbers below count
 * each, written to triangles. A planar and simple polygon gets triangles of its own sense that do not
 * overlap, decided exactly. A convex one is a fan from its first corner. Any other input (crossing, repeated
 * or collinear corners, corners off the plane) gets count - 2 triangles all the same; one that touches itself
 * without crossing (holes joined to the rim by bridges) still gets triangles of its own sense, up to about a
 * thousand corners. The result depends on the corners only. Fails only for want of memory or when cancelled:
 * long cuts report progress as "cut polygon".
 * Cost: O(count) for convex polygons, O(count log count) otherwise. Scratch: 20 bytes a corner that is not
 * certainly convex, and 50 more where it is swept. */
bvx_status bvxi_polygon_cut(bvxi_polygon *work, const double (*corner)[3], uint64_t count,
                            uint32_t *triangles);

void bvxi_polygon_free(bvxi_polygon *work);

#endif
