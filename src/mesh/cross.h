/* cross.h - do two triangles cross? Not installed.
 *
 * Triangles are closed and may be degenerate: what their three corners span. Corners are common when their
 * pointers are equal; the caller gives one pointer a position. Two triangles cross when they have a common
 * point that is neither a common corner nor on a common edge (one between two common corners). So touching is
 * crossing: a corner that lies on the other triangle, an overlap in one plane, a fold that lies flat on its
 * neighbour, a triangle that is there twice. */
#ifndef BVXI_CROSS_H
#define BVXI_CROSS_H

#include "mesh/orient.h"

/* The answer after the filters below, and without any filter of triangles. */
int bvxi_triangles_cross_rest(const double *const p[3], const double *const q[3]);
int bvxi_triangles_cross_exact(const double *const p[3], const double *const q[3]);

/* 1 when the triangle has an area, exactly. */
int bvxi_has_area(const double *const t[3]);

/* The corners of q that are no corners of p: bit k for q[k]. */
static inline unsigned bvxi_cross_own(const double *const p[3], const double *const q[3])
{
    unsigned own = 0;

    for (unsigned k = 0; k < 3; k++) own |= (unsigned)((q[k] != p[0]) & (q[k] != p[1]) & (q[k] != p[2])) << k;

    return own;
}

/* 1 when all of q's own corners lie strictly on one side of p's plane, for certain: then q meets that plane
 * in no more than what both have in common. 0 without own corners. */
static inline int bvxi_cross_apart(const bvxi_orient_plane *plane, const double *const q[3], unsigned own)
{
    int side = 0;

    /* A side that is not certain, or one on either side, ends the test: the exact answer decides. */
    for (unsigned k = 0; k < 3; k++) {
        int s;

        if ((own >> k & 1) == 0) continue;
        s = bvxi_orient_side(plane, q[k]);
        if (s == 0 || s == -side) return 0;
        side = s;
    }

    return side != 0;
}

/* As bvxi_triangles_cross, with the plane of p, for one that is held against many. */
static inline int bvxi_triangles_cross_at(const bvxi_orient_plane *plane, const double *const p[3],
                                          const double *const q[3])
{
    bvxi_orient_plane other;

    if (BVXI_LIKELY(bvxi_cross_apart(plane, q, bvxi_cross_own(p, q)))) return 0;

    bvxi_orient_plane_of(q, &other);
    if (bvxi_cross_apart(&other, p, bvxi_cross_own(q, p))) return 0;

    return bvxi_triangles_cross_rest(p, q);
}

/* 1 when the triangles cross, 0 when not: exact for all finite doubles (orient.h says what flushed subnormals
 * change), the same for both orders of the triangles and all orders of their corners. */
static inline int bvxi_triangles_cross(const double *const p[3], const double *const q[3])
{
    bvxi_orient_plane plane;

    bvxi_orient_plane_of(p, &plane);
    return bvxi_triangles_cross_at(&plane, p, q);
}

#endif
