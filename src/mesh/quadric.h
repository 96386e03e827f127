/* quadric.h - squared distances to planes, added up. Not installed.
 *
 * Source: Garland, Heckbert. Surface Simplification Using Quadric Error Metrics. 1997. */
#ifndef BVXI_QUADRIC_H
#define BVXI_QUADRIC_H

#include "core/core.h"

/* x'Ax + 2b'x + c, A symmetric: xx xy xz yy yz zz. */
typedef struct bvxi_quadric {
    double a[6], b[3], c;
} bvxi_quadric;

/* The plane n.x + d = 0, n of unit length, with a weight. */
static inline void bvxi_quadric_plane(bvxi_quadric *q, const double n[3], double d, double weight)
{
    q->a[0] += weight * n[0] * n[0];
    q->a[1] += weight * n[0] * n[1];
    q->a[2] += weight * n[0] * n[2];
    q->a[3] += weight * n[1] * n[1];
    q->a[4] += weight * n[1] * n[2];
    q->a[5] += weight * n[2] * n[2];
    for (int32_t i = 0; i < 3; i++) q->b[i] += weight * n[i] * d;
    q->c += weight * d * d;
}

static inline void bvxi_quadric_add(bvxi_quadric *q, const bvxi_quadric *other)
{
    for (int32_t i = 0; i < 6; i++) q->a[i] += other->a[i];
    for (int32_t i = 0; i < 3; i++) q->b[i] += other->b[i];
    q->c += other->c;
}

static inline double bvxi_quadric_at(const bvxi_quadric *q, const double p[3])
{
    double const x = q->a[0] * p[0] + q->a[1] * p[1] + q->a[2] * p[2] + 2 * q->b[0];
    double const y = q->a[1] * p[0] + q->a[3] * p[1] + q->a[4] * p[2] + 2 * q->b[1];
    double const z = q->a[2] * p[0] + q->a[4] * p[1] + q->a[5] * p[2] + 2 * q->b[2];
    double const value = x * p[0] + y * p[1] + z * p[2] + q->c;
    return value > 0 ? value : 0;
}

/* The place of least value; 0 where the planes do not fix one (Cramer's rule, refused when nearly singular). */
static inline int bvxi_quadric_least(const bvxi_quadric *q, double p[3])
{
    const double *const a = q->a;
    double const m00 = a[3] * a[5] - a[4] * a[4], m01 = a[2] * a[4] - a[1] * a[5], m02 = a[1] * a[4] - a[2] * a[3];
    double const m11 = a[0] * a[5] - a[2] * a[2], m12 = a[1] * a[2] - a[0] * a[4], m22 = a[0] * a[3] - a[1] * a[1];
    double const det = a[0] * m00 + a[1] * m01 + a[2] * m02, trace = a[0] + a[3] + a[5];
    if (!(det > 1e-4 * trace * trace * trace)) return 0;
    p[0] = -(m00 * q->b[0] + m01 * q->b[1] + m02 * q->b[2]) / det;
    p[1] = -(m01 * q->b[0] + m11 * q->b[1] + m12 * q->b[2]) / det;
    p[2] = -(m02 * q->b[0] + m12 * q->b[1] + m22 * q->b[2]) / det;
    return 1;
}

#endif
