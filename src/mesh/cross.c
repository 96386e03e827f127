/* cross.c - two triangles cross: what the filters of cross.h leave open.
 *
 * Nothing in common: two convex sets of which neither lies strictly inside a side of the other's plane meet
 * where an edge of one meets the other.
 * A common corner: from that corner through another common point both triangles go on until one of them ends,
 * and there the ray is on the edge of one opposite to the corner, and in the other. So the opposite edges are
 * what to look at. A degenerate triangle ends at one of its other corners.
 * A common edge: planes that differ meet in the edge's line, so what remains is a fold that lies flat: both
 * other corners on one side of the edge in one plane.
 * Three common corners: the same triangle, with points off its edges when it has an area.
 *
 * Everything here is a sign of orient.h, so it is exact; the order of the tests changes the time only. */
#include "mesh/cross.h"

/* The corners of q that are no corners of p: bit k for q[k]. */
static unsigned cross_own(const double *const p[3], const double *const q[3])
{
    unsigned own = 0;
    for (unsigned k = 0; k < 3; k++) own |= (unsigned)((q[k] != p[0]) & (q[k] != p[1]) & (q[k] != p[2])) << k;
    return own;
}

/* ---- Triangles and segments in a plane or on a line ---- */

/* A coordinate axis along which the triangle has an area when seen from there, or -1. */
static int cross_axis(const double *const t[3])
{
    for (int axis = 0; axis < 3; axis++)
        if (bvxi_orient_flat(t[0], t[1], t[2], axis) != 0) return axis;
    return -1;
}

int bvxi_has_area(const double *const t[3])
{
    return cross_axis(t) >= 0;
}

/* 1 when, seen along axis, the line of an edge of p has p on one side and q's
 * own corners strictly on the other, for certain, and what corners of p are
 * in q are ends of that edge. Then the triangles meet in these corners only. */
static int cross_beside(const double *const p[3], const double *const q[3], int axis)
{
    unsigned const own = cross_own(p, q), not_in_q = cross_own(q, p);

    for (unsigned i = 0; i < 3; i++) {
        /* the edge from i to k, opposite to l */
        unsigned const k = i == 2 ? 0 : i + 1, l = i == 0 ? 2 : i - 1;
        int apart = own != 0 && (not_in_q >> l & 1) != 0, side;
        if (!apart) continue;
        side = bvxi_orient_flat_side(p[i], p[k], p[l], axis);
        apart = side != 0;
        for (unsigned j = 0; j < 3 && apart; j++)
            if ((own >> j & 1) != 0) apart = bvxi_orient_flat_side(p[i], p[k], q[j], axis) == -side;
        if (apart) return 1;
    }
    return 0;
}

/* 1 when p is in the box of a and b, the coordinate along axis left out (3:
 * none is). On the line of a and b: between them. */
static int cross_in_box(const double p[3], const double a[3], const double b[3], int axis)
{
    for (int k = 0; k < 3; k++)
        if (k != axis && ((p[k] < a[k] && p[k] < b[k]) || (p[k] > a[k] && p[k] > b[k]))) return 0;
    return 1;
}

/* 1 when p, in the plane of t, is in t. */
static int cross_flat_inside(const double p[3], const double *const t[3], int axis)
{
    int const a = bvxi_orient_flat(t[0], t[1], p, axis);
    int const b = bvxi_orient_flat(t[1], t[2], p, axis);
    int const c = bvxi_orient_flat(t[2], t[0], p, axis);
    return !((a > 0 || b > 0 || c > 0) && (a < 0 || b < 0 || c < 0));
}

/* 1 when the closed segments p q and a b meet, seen along axis. A segment may be one point. */
static int cross_flat_segments(const double p[3], const double q[3], const double a[3], const double b[3],
                               int axis)
{
    int const to_a = bvxi_orient_flat(p, q, a, axis), to_b = bvxi_orient_flat(p, q, b, axis);
    int const to_p = bvxi_orient_flat(a, b, p, axis), to_q = bvxi_orient_flat(a, b, q, axis);
    /* Both cross each other's line properly, or an end of one lies on the other. */
    if (to_a * to_b < 0 && to_p * to_q < 0) return 1;
    return (to_a == 0 && cross_in_box(a, p, q, axis)) || (to_b == 0 && cross_in_box(b, p, q, axis)) ||
           (to_p == 0 && cross_in_box(p, a, b, axis)) || (to_q == 0 && cross_in_box(q, a, b, axis));
}

/* 1 when the closed segments p q and a b meet in space. */
static int cross_segments(const double p[3], const double q[3], const double a[3], const double b[3])
{
    if (bvxi_orient(p, q, a, b) != 0) return 0;
    /* Four points of a plane: along an axis that shows an area of three, nothing is lost. */
    for (int axis = 0; axis < 3; axis++)
        if (bvxi_orient_flat(p, q, a, axis) != 0 || bvxi_orient_flat(p, q, b, axis) != 0 ||
            bvxi_orient_flat(a, b, p, axis) != 0 || bvxi_orient_flat(a, b, q, axis) != 0)
            return cross_flat_segments(p, q, a, b, axis);
    /* Four points of a line: one segment has an end in the other. */
    return cross_in_box(a, p, q, 3) || cross_in_box(b, p, q, 3) || cross_in_box(p, a, b, 3) ||
           cross_in_box(q, a, b, 3);
}

/* ---- Triangles in space ---- */

typedef struct cross_triangle {
    const double *corner[3];
    int side[3]; /* of each corner, as bvxi_orient has it of the other triangle */
    int has_area;
} cross_triangle;

/* Corners, and sides of those that are own. */
static void cross_open_sides(const double *const p[3], unsigned own, const double *const q[3],
                             cross_triangle *a)
{
    bvxi_orient_plane plane;
    bvxi_orient_plane_of(q, &plane);
    for (unsigned k = 0; k < 3; k++) {
        int const side = bvxi_orient_side(&plane, p[k]);
        a->corner[k] = p[k];
        a->side[k] = (own >> k & 1) == 0 ? 0 : side != 0 ? -side : bvxi_orient_exact(q[0], q[1], q[2], p[k]);
    }
}

/* 1 when the closed segment from corner i to corner k of a meets b. i may be k: that point only. */
static int cross_edge(const cross_triangle *a, int i, int k, const cross_triangle *b)
{
    const double *const *const t = b->corner, *const p = a->corner[i], *const q = a->corner[k];
    int side[3];

    if (!b->has_area)
        return cross_segments(p, q, t[0], t[1]) || cross_segments(p, q, t[1], t[2]) ||
               cross_segments(p, q, t[2], t[0]);

    /* Both ends strictly on one side: the segment does not reach the plane. */
    if (a->side[i] * a->side[k] > 0) return 0;

    /* In the plane: an end may be inside, or the segment may cross an edge. */
    if (a->side[i] == 0 && a->side[k] == 0) {
        int const axis = cross_axis(t);
        if (cross_flat_inside(p, t, axis) || cross_flat_inside(q, t, axis)) return 1;
        return cross_flat_segments(p, q, t[0], t[1], axis) || cross_flat_segments(p, q, t[1], t[2], axis) ||
               cross_flat_segments(p, q, t[2], t[0], axis);
    }

    /* The line meets the plane in one point, which the segment has; in b if all edges lie on one side. */
    side[0] = bvxi_orient(p, q, t[0], t[1]);
    side[1] = bvxi_orient(p, q, t[1], t[2]);
    if (side[0] * side[1] < 0) return 0;
    side[2] = bvxi_orient(p, q, t[2], t[0]);
    return side[0] * side[2] >= 0 && side[1] * side[2] >= 0;
}

/* 1 when an edge of a meets b. */
static int cross_any_edge(const cross_triangle *a, const cross_triangle *b)
{
    return cross_edge(a, 0, 1, b) || cross_edge(a, 1, 2, b) || cross_edge(a, 2, 0, b);
}

/* 1 when a meets b where a ray from their common corner leaves a. */
static int cross_opposite(const cross_triangle *a, const double *common, const cross_triangle *b)
{
    int own[2] = {0, 0}, count = 0;
    for (int k = 0; k < 3; k++)
        if (a->corner[k] != common) own[count++] = k;
    /* Without an area the ray ends at one of the other corners. */
    if (a->has_area) return cross_edge(a, own[0], own[1], b);
    for (int k = 0; k < count; k++)
        if (cross_edge(a, own[k], own[k], b)) return 1;
    return 0;
}

/* Of c on the line of a and b: 1 beyond b, -1 beyond a, 0 between. */
static int cross_beyond(const double a[3], const double b[3], const double c[3])
{
    if (cross_in_box(c, a, b, 3)) return 0;
    return cross_in_box(b, a, c, 3) ? 1 : -1;
}

/* The triangles a b c and a b d, with different corners each. */
static int cross_fold(const double *a, const double *b, const double *c, const double *d)
{
    const double *const p[3] = {a, b, c}, *const q[3] = {a, b, d};
    if (bvxi_orient(a, b, c, d) != 0) return 0;
    /* One plane, unless a triangle has no area: then it is on the line of the common edge. */
    int const axis = cross_axis(p);
    int const other = cross_axis(q);
    if (axis >= 0 && other >= 0) return bvxi_orient_flat(a, b, c, axis) == bvxi_orient_flat(a, b, d, axis);
    if (axis >= 0 || other >= 0) return 0;
    return cross_beyond(a, b, c) != 0 && cross_beyond(a, b, c) == cross_beyond(a, b, d);
}

/* What p and q have in common, each once, and what each has only; double corners count once. */
typedef struct cross_corners {
    const double *common[3], *own_p, *own_q;
    int count;
} cross_corners;

int bvxi_triangles_cross_rest(const bvxi_orient_plane *plane, const double *const p[3],
                              const double *const q[3])
{
    double size[3];

    /* The axis along which a triangle shows most of its area, nearly. */
    for (int k = 0; k < 3; k++) size[k] = bvxi_absolute(plane->normal[k]);
    int const axis = size[0] > size[1] ? (size[0] > size[2] ? 0 : 2) : size[1] > size[2] ? 1 : 2;

    /* Most that reach this point are neighbours in one plane, or nearly. */
    if (cross_beside(p, q, axis) || cross_beside(q, p, axis)) return 0;
    return bvxi_triangles_cross_exact(p, q);
}

int bvxi_triangles_cross_exact(const double *const p[3], const double *const q[3])
{
    cross_corners c;
    cross_triangle a, b;
    c.count = 0;
    c.own_p = c.own_q = NULL;
    for (int i = 0; i < 3; i++) {
        int const again = (i > 0 && p[i] == p[0]) || (i > 1 && p[i] == p[1]);
        if (p[i] != q[0] && p[i] != q[1] && p[i] != q[2]) c.own_p = p[i];
        else if (!again) c.common[c.count++] = p[i];
        if (q[i] != p[0] && q[i] != p[1] && q[i] != p[2]) c.own_q = q[i];
    }

    /* The same triangle: it overlaps itself where it has an area. */
    if (c.count == 3) return bvxi_has_area(p);
    if (c.count == 2)
        return c.own_p != NULL && c.own_q != NULL && cross_fold(c.common[0], c.common[1], c.own_p, c.own_q);

    /* Sides are only needed where one corner or none is common. A common corner lies in both planes, so its
     * side is 0 without being computed. */
    unsigned const own_p = cross_own(q, p), own_q = cross_own(p, q);
    cross_open_sides(p, own_p, q, &a);
    cross_open_sides(q, own_q, p, &b);
    /* An area is looked for only where all corners lie in the other's plane. */
    a.has_area = b.side[0] != 0 || b.side[1] != 0 || b.side[2] != 0 || bvxi_has_area(p);
    b.has_area = a.side[0] != 0 || a.side[1] != 0 || a.side[2] != 0 || bvxi_has_area(q);

    if (c.count == 1) return cross_opposite(&a, c.common[0], &b) || cross_opposite(&b, c.common[0], &a);
    return cross_any_edge(&a, &b) || cross_any_edge(&b, &a);
}
