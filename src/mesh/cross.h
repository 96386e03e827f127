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

/* The answer after the filters below, with p's plane, and without any filter of triangles. */
int bvxi_triangles_cross_rest(const bvxi_orient_plane *plane, const double *const p[3],
                              const double *const q[3]);
int bvxi_triangles_cross_exact(const double *const p[3], const double *const q[3]);

/* 1 when the triangle has an area, exactly. */
int bvxi_has_area(const double *const t[3]);

enum { BVXI_CROSS_OPEN, BVXI_CROSS_APART, BVXI_CROSS_FLAT };

/* How q lies to p's plane. Apart: its own corners lie strictly on one side, for certain, so that it meets the plane in
 * no more than what both have in common. Flat: of no corner that is certain, so that q's plane tells no more. */
static inline int bvxi_cross_sides(const bvxi_orient_plane *plane, const double *const p[3],
                                   const double *const q[3])
{
    int side = 0, unsure = 0;
    for (int k = 0; k < 3; k++) {
        int const s = bvxi_orient_side(plane, q[k]);
        if (s == 0) unsure |= (q[k] != p[0]) & (q[k] != p[1]) & (q[k] != p[2]);
        else if (s == -side) return BVXI_CROSS_OPEN;
        else side = s;
    }
    return side == 0 ? BVXI_CROSS_FLAT : unsure ? BVXI_CROSS_OPEN : BVXI_CROSS_APART;
}

/* As bvxi_triangles_cross, with how q lies to the plane of p. */
static inline int bvxi_triangles_cross_beside(int sides, const bvxi_orient_plane *plane,
                                              const double *const p[3], const double *const q[3])
{
    if (BVXI_LIKELY(sides == BVXI_CROSS_APART)) return 0;
    if (sides == BVXI_CROSS_OPEN) {
        bvxi_orient_plane other;
        bvxi_orient_plane_of(q, &other);
        if (bvxi_cross_sides(&other, q, p) == BVXI_CROSS_APART) return 0;
    }
    return bvxi_triangles_cross_rest(plane, p, q);
}

/* As bvxi_triangles_cross, with the plane of p, for one that is held against many. */
static inline int bvxi_triangles_cross_at(const bvxi_orient_plane *plane, const double *const p[3],
                                          const double *const q[3])
{
    return bvxi_triangles_cross_beside(bvxi_cross_sides(plane, p, q), plane, p, q);
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
