/* angle.h - an angle by + - * / only, the same on every machine. Not installed. */
#ifndef BVXI_ANGLE_H
#define BVXI_ANGLE_H

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

#endif
