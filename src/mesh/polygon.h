/* polygon.h - polygons cut into triangles, for readers of meshes (bvxi_polygon_cut); and the ring in a plane
 * that only polygon.c and polygon_sweep.c know. Not installed. */
#ifndef BVXI_POLYGON_H
#define BVXI_POLYGON_H

#include "core/core.h"

/* ---- Polygons cut into triangles, as mesh readers need it ---- */

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

/* ---- A polygon laid into a plane ---- */

/* Corners in the order of the polygon, counter-clockwise, no two neighbours at one
 * place. Places are scaled so that all are below 2^500 and multiples of 2^-500: no
 * product of two of them, nor its rounding error, leaves the range of doubles. */
typedef struct bvxi_ring {
    bvx_context *ctx;
    double (*xy)[2];
    uint32_t *corner;    /* numbers in the polygon */
    uint32_t count;      /* [Limit: 3..2^30] */
    uint32_t *triangles; /* [Size: 3 * (count - 2)] */
    uint32_t made;
} bvxi_ring;

enum { BVXI_RING_ASKS = 1 << 16 }; /* corners from which on progress is reported */

/* ---- polygon.c ---- */

/* Twice the area of the triangle when its sign is certain, 0 when it is not. No underflow matters: a sum that
 * is not well above what small numbers lose is not certain. */
static inline double bvxi_side_quick(double ax, double ay, double bx, double by, double cx, double cy)
{
    double const left = (ax - cx) * (by - cy), right = (ay - cy) * (bx - cx);
    double const det = left - right;
    double const bound = 0x1p-51 * ((left < 0.0 ? -left : left) + (right < 0.0 ? -right : right)) + 0x1p-960;
    return det > bound || -det > bound ? det : 0.0;
}

/* The sign without any rounding, for places of a ring. */
int32_t bvxi_side_exact(const double a[2], const double b[2], const double c[2]);

/* 1 when c lies left of the line from a to b, -1 right of it, 0 on it. */
static inline int32_t bvxi_ring_side(const bvxi_ring *ring, uint32_t a, uint32_t b, uint32_t c)
{
    const double *const p = ring->xy[a], *const q = ring->xy[b], *const r = ring->xy[c];
    double const quick = bvxi_side_quick(p[0], p[1], q[0], q[1], r[0], r[1]);
    if (BVXI_LIKELY(quick != 0.0)) return quick > 0.0 ? 1 : -1;
    return bvxi_side_exact(p, q, r);
}

/* ---- shared ---- */

static inline uint32_t bvxi_ring_next(const bvxi_ring *ring, uint32_t i)
{
    return i + 1 == ring->count ? 0 : i + 1;
}

static inline uint32_t bvxi_ring_previous(const bvxi_ring *ring, uint32_t i)
{
    return i == 0 ? ring->count - 1 : i - 1;
}

/* By x, then y: -1, 0 or 1. A plane turned by next to nothing has no two corners at one x. */
static inline int32_t bvxi_place_order(const double a[2], const double b[2])
{
    if (a[0] != b[0]) return a[0] < b[0] ? -1 : 1;
    return a[1] < b[1] ? -1 : a[1] > b[1];
}

/* There is room for count - 2. */
static inline void bvxi_ring_triangle(bvxi_ring *ring, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *const t = ring->triangles + (size_t)ring->made++ * 3;
    t[0] = ring->corner[a];
    t[1] = ring->corner[b];
    t[2] = ring->corner[c];
}

static inline bvx_status bvxi_ring_ask(const bvxi_ring *ring, double fraction)
{
    return ring->count < BVXI_RING_ASKS ? BVX_OK : bvxi_progress(ring->ctx, "cut polygon", fraction);
}

/* ---- polygon_sweep.c ---- */

/* order becomes the ring's corners by place; *touches 1 when two lie at one. other: as large as order. */
bvx_status bvxi_polygon_order(const bvxi_ring *ring, uint32_t *order, uint32_t *other, int *touches);

/* Scratch behind the order, aligned to 4. */
uint64_t bvxi_polygon_sweep_size(uint32_t count);
/* Cut a ring whose corners lie at different places; *good 0 when that showed it not to be simple. */
bvx_status bvxi_polygon_sweep(bvxi_ring *ring, const uint32_t *order, void *scratch, int *good);

/* ---- polygon.c ---- */

uint64_t bvxi_polygon_ears_size(uint32_t count);
/* Cut any ring. */
bvx_status bvxi_polygon_ears(bvxi_ring *ring, void *scratch);

#endif
