/* vec3.h - three coordinates in doubles, and an angle by + - * / only, since the C library's functions
 * differ between machines. The order of operations is fixed: results depend on it. Not installed. */
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

/* a by the cross product of b and c: six times the volume that they span with 0. */
static inline double bvxi_vec_volume6(const double a[3], const double b[3], const double c[3])
{
    return a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
           a[2] * (b[0] * c[1] - b[1] * c[0]);
}

/* Bounds widened by a place of n coordinates. */
static inline void bvxi_widen(double *low, double *high, const double *at, int n)
{
    for (int k = 0; k < n; k++) {
        low[k] = at[k] < low[k] ? at[k] : low[k];
        high[k] = at[k] > high[k] ? at[k] : high[k];
    }
}

static inline int bvxi_vec_is_same(const double a[3], const double b[3])
{
    return a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
}

static inline int bvxi_vec_is_zero(const double v[3])
{
    return v[0] == 0.0 && v[1] == 0.0 && v[2] == 0.0;
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

/* ---- An angle by + - * / only, the same on every machine ---- */

#define BVXI_PI 3.14159265358979323846

/* The angle of (x, y) for y >= 0, in [0, pi], to about 1e-10; pi / 2 for (0, 0). By three reductions, each
 * exact in the reals: to the first octant, then by tan(pi / 8), then the series, |t| < 0.4143. */
static inline double bvxi_angle(double x, double y)
{
    double const far = x < 0 ? -x : x;
    double const large = far > y ? far : y, small = far > y ? y : far;
    double t, base = 0, t2, sum;

    if (large == 0) return 0.5 * BVXI_PI;
    t = small / large;
    if (t > 0.41421356237309503) { /* tan(pi / 8) */
        t = (t - 1) / (t + 1);
        base = 0.25 * BVXI_PI;
    }
    t2 = t * t;
    sum = 1.0 / 21;
    for (int k = 19; k > 0; k -= 2) sum = 1.0 / k - t2 * sum;
    sum = base + t * sum;
    if (far < y) sum = 0.5 * BVXI_PI - sum;
    return x < 0 ? BVXI_PI - sum : sum;
}

/* ---- Bounds in floats ---- */

/* Floats outside by one to three units in the last place, without a look back
 * at what rounding did: some compilers (gcc 12) take a rounding to float away
 * when its result is widened again. For x far from a float's ends. */
static inline float bvxi_float_below(double x)
{
    float const f = (float)x;
    return f - (f < 0.0f ? -f : f) * 0x1p-23f - 0x1p-120f;
}

static inline float bvxi_float_above(double x)
{
    return -bvxi_float_below(-x);
}

/* (b - a) x (c - a): twice the triangle's area along its normal. */
static inline void bvxi_area_normal(const double *a, const double *b, const double *c, double n[3])
{
    double const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double const v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    bvxi_vec_cross(u, v, n);
}

#endif
