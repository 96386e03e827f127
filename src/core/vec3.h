/* vec3.h - three coordinates in doubles. Not installed.
 *
 * The order of operations is part of what results depend on: from x to z. */
#ifndef BVXI_VEC3_H
#define BVXI_VEC3_H

#include <math.h>

static inline double bvxi_vec_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* n is neither a nor b. */
static inline void bvxi_vec_cross(const double a[3], const double b[3], double n[3])
{
    n[0] = a[1] * b[2] - a[2] * b[1];
    n[1] = a[2] * b[0] - a[0] * b[2];
    n[2] = a[0] * b[1] - a[1] * b[0];
}

static inline double bvxi_vec_length(const double v[3])
{
    return sqrt(bvxi_vec_dot(v, v));
}

/* Square of the distance between two points. */
static inline double bvxi_vec_distance2(const double a[3], const double b[3])
{
    double const d[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return bvxi_vec_dot(d, d);
}

#endif
