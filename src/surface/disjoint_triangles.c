/* disjoint_triangles.c - two triangles proven to have no common point.
 *
 * Any direction in which their shadows do not overlap proves it, however it was found, so only the shadows'
 * rounding counts: three products and two sums of doubles err by less than 2^-50 times the sum of the
 * products' sizes. Tried are the normals and the products of sides, which suffice where rounding is nothing
 * (separating axes). 0 may be wrong. */
#include "surface/sharp.h"

static void cross_sides(const double a[3], const double b[3], const double c[3], const double d[3],
                        double n[3])
{
    double const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double const v[3] = {d[0] - c[0], d[1] - c[1], d[2] - c[2]};
    bvxi_vec_cross(u, v, n);
}

/* The shadow of a triangle along n, widened by its rounding. */
static void cast_shadow(const double t[3][3], const double n[3], double *low, double *high)
{
    for (int k = 0; k < 3; k++) {
        double const x = n[0] * t[k][0], y = n[1] * t[k][1], z = n[2] * t[k][2], at = x + y + z;
        double const size = (x < 0 ? -x : x) + (y < 0 ? -y : y) + (z < 0 ? -z : z);
        /* the last for products below the normal range */
        double const wide = size * (1.0 / 1125899906842624.0) + 1e-290;
        if (k == 0 || at - wide < *low) *low = at - wide;
        if (k == 0 || at + wide > *high) *high = at + wide;
    }
}

static int are_apart_along(const double one[3][3], const double two[3][3], const double n[3])
{
    double low[2], high[2];
    cast_shadow(one, n, &low[0], &high[0]);
    cast_shadow(two, n, &low[1], &high[1]);
    return high[0] < low[1] || high[1] < low[0];
}

int bvxi_triangles_apart(const double one[3][3], const double two[3][3])
{
    static const double axes[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    double n[3];

    for (int a = 0; a < 3; a++)
        if (are_apart_along(one, two, axes[a])) return 1;

    /* Normals first, then products of sides: most triangles that are apart are so along an axis. */
    cross_sides(one[0], one[1], one[0], one[2], n);
    if (are_apart_along(one, two, n)) return 1;
    cross_sides(two[0], two[1], two[0], two[2], n);
    if (are_apart_along(one, two, n)) return 1;
    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++) {
            cross_sides(one[i], one[(i + 1) % 3], two[k], two[(k + 1) % 3], n);
            if (are_apart_along(one, two, n)) return 1;
        }
    return 0;
}
