/* facet.h - the normal of a flat triangle. Not installed. */
#ifndef BVXI_FACET_H
#define BVXI_FACET_H

#include <math.h>

/* n becomes the normal by the right hand, as long as twice the area; returns that length. */
static inline double bvxi_facet_normal(const double t[3][3], double n[3])
{
    double u[3], v[3];
    for (int a = 0; a < 3; a++) {
        u[a] = t[1][a] - t[0][a];
        v[a] = t[2][a] - t[0][a];
    }
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
    return sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
}

#endif
