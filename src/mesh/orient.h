/* orient.h - on which side of a plane or a line a point lies, exactly. Not installed.
 *
 * Source of the filter's bound: Shewchuk. Adaptive Precision Floating-Point Arithmetic and Fast Robust
 * Geometric Predicates. 1997.
 *
 * Exact for all finite doubles, subnormal ones too. On a thread that flushes subnormal numbers (FTZ, DAZ)
 * exact for coordinates that are 0 or at least 2^-960 in size. No call overflows into a wrong answer: an
 * infinity or NaN in a filter compares as "not certain", and the exact answer (orient.c) takes no double
 * arithmetic. */
#ifndef BVXI_ORIENT_H
#define BVXI_ORIENT_H

#include "core/core.h"

/* Error bounds, with e = 2^-53 the relative error of a rounding and t = BVXI_ORIENT_TINY against what
 * underflows.
 *
 * Three coordinates: each product of three differences is rounded in three subtractions, a product, a
 * subtraction, a product and two additions, of which the last cannot change a sign: an error below (7 e + 28
 * e^2) P, P the exact sum of the products' sizes. P as computed is at least (1 - e)^8 P, so 8 e = 2^-50 times
 * P as computed covers it. Two coordinates: two subtractions, a product, a last subtraction: (3 e + 3 e^2) P,
 * and 4 e = 2^-51 covers it.
 *
 * Underflow: a difference of doubles has none. A product of two is off by up to 2^-1022 where subnormals are
 * flushed, and then meets a third factor f: t in each bracket of the bound gives 2^-50 t f = 2^-1010 f for
 * two such errors. What follows the third factor is off by 2^-1022 again, and the t at the end of the bound
 * is far above a dozen of these. */
#define BVXI_ORIENT_TINY       0x1p-960
#define BVXI_ORIENT_ERROR      0x1p-50
#define BVXI_ORIENT_FLAT_ERROR 0x1p-51

/* The same answers as the functions below without their filters; axis-parallel planes are quick here too. */
int bvxi_orient_exact(const double a[3], const double b[3], const double c[3], const double d[3]);
int bvxi_orient_flat_exact(const double a[3], const double b[3], const double c[3], int axis);

/* A plane through three points, as the filter needs it. */
typedef struct bvxi_orient_plane {
    const double *origin;
    double normal[3], error[3]; /* error: sizes of the products in normal, plus t */
} bvxi_orient_plane;

static inline void bvxi_orient_plane_of(const double *const t[3], bvxi_orient_plane *plane)
{
    double u[3], v[3];

    /* The edges from the first corner; each has a rounding in it, which the bound counts. */
    for (int k = 0; k < 3; k++) {
        u[k] = t[1][k] - t[0][k];
        v[k] = t[2][k] - t[0][k];
    }

    plane->origin = t[0];
    for (int k = 0; k < 3; k++) {
        int const l = k == 2 ? 0 : k + 1, m = k == 0 ? 2 : k - 1;
        /* Each component keeps the sizes of its products beside it: they bound its error. */
        double const x = u[l] * v[m], y = u[m] * v[l];

        plane->normal[k] = x - y;
        plane->error[k] = bvxi_absolute(x) + bvxi_absolute(y) + BVXI_ORIENT_TINY;
    }
}

/* 1: d lies on the side that the normal points to, -1: on the other, 0: not certain. */
static inline int bvxi_orient_side(const bvxi_orient_plane *plane, const double d[3])
{
    double const x = d[0] - plane->origin[0], y = d[1] - plane->origin[1], z = d[2] - plane->origin[2];
    double const height = plane->normal[0] * x + plane->normal[1] * y + plane->normal[2] * z;
    double const size = plane->error[0] * bvxi_absolute(x) + plane->error[1] * bvxi_absolute(y) +
                        plane->error[2] * bvxi_absolute(z);
    /* A height within the bound may have either sign. */
    double const bound = BVXI_ORIENT_ERROR * size + BVXI_ORIENT_TINY;
    return (height > bound) - (height < -bound);
}

/* Sign of det(a - d, b - d, c - d). 1: d lies on the side that the normal of a, b, c by the right hand points
 * away from, as the inside of a solid does; -1: on the other side; 0: the four lie in one plane. */
static inline int bvxi_orient(const double a[3], const double b[3], const double c[3], const double d[3])
{
    const double *const t[3] = {a, b, c};
    bvxi_orient_plane plane;
    /* The filter says on which side of the normal, the determinant the opposite. */
    bvxi_orient_plane_of(t, &plane);
    int const side = bvxi_orient_side(&plane, d);
    return BVXI_LIKELY(side != 0) ? -side : bvxi_orient_exact(a, b, c, d);
}

/* As bvxi_orient_flat where that is certain, else 0. */
static inline int bvxi_orient_flat_side(const double a[3], const double b[3], const double c[3], int axis)
{
    int const k = axis == 2 ? 0 : axis + 1, l = axis == 0 ? 2 : axis - 1;
    double const x = (a[k] - c[k]) * (b[l] - c[l]), y = (a[l] - c[l]) * (b[k] - c[k]);
    double const bound = BVXI_ORIENT_FLAT_ERROR * (bvxi_absolute(x) + bvxi_absolute(y)) + BVXI_ORIENT_TINY;
    return (x - y > bound) - (x - y < -bound);
}

/* Sign of det(a - c, b - c) of what remains without the coordinate axis, the next one first. 1: a, b, c turn
 * left, seen from where that axis points to; -1: right; 0: seen from there they lie on a line. */
static inline int bvxi_orient_flat(const double a[3], const double b[3], const double c[3], int axis)
{
    int const side = bvxi_orient_flat_side(a, b, c, axis);
    return BVXI_LIKELY(side != 0) ? side : bvxi_orient_flat_exact(a, b, c, axis);
}

#endif
