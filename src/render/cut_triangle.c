/* cut_triangle.c - a triangle clipped against a box, plane after plane.
 *
 * Source: Sutherland, Hodgman. Reentrant Polygon Clipping. 1974.
 * A point where an edge crosses a plane is computed from the edge's lesser end (by x, then y, then z),
 * whichever way the polygon goes round, and lies on the plane exactly. Both triangles of an edge are clipped
 * by the same planes in the same order, so they keep the same piece of it. */
#include "render/raster.h"

/* 1 when a comes before b. */
static int cut_is_before(const double a[3], const double b[3])
{
    for (int k = 0; k < 3; k++)
        if (a[k] != b[k]) return a[k] < b[k];
    return 0;
}

static void cut_crossing(const double a[3], const double b[3], int axis, double plane, double p[3])
{
    const double *const from = cut_is_before(b, a) ? b : a, *const to = from == a ? b : a;
    double const share = (plane - from[axis]) / (to[axis] - from[axis]);
    for (int k = 0; k < 3; k++) p[k] = from[k] + share * (to[k] - from[k]);
    p[axis] = plane;
}

/* What lies on one side of a plane; sign 1: at or above it, -1: at or below. */
static int32_t cut_by_plane(const double (*in)[3], int32_t n, int axis, double plane, double sign,
                            double (*out)[3])
{
    int32_t count = 0;

    /* Points on the plane count as inside, so a triangle that only touches it keeps its corner. */
    for (int32_t i = 0; i < n; i++) {
        const double *const p = in[i], *const q = in[i + 1 == n ? 0 : i + 1];
        double const here = sign * (p[axis] - plane), there = sign * (q[axis] - plane);
        if (here >= 0.0) memcpy(out[count++], p, 3 * sizeof *p);
        if ((here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0))
            cut_crossing(p, q, axis, plane, out[count++]);
    }
    return count < 3 ? 0 : count;
}

int32_t bvxi_cut_triangle(const bvxi_cut *cut, const double triangle[3][3], double corner[BVXI_CUT_MOST][3])
{
    double other[BVXI_CUT_MOST][3];
    double(*from)[3] = corner, (*to)[3] = other;
    int32_t n = 3;

    memcpy(corner, triangle, 3 * sizeof *corner);

    /* Two arrays take turns; a plane that cuts nothing off
     * is skipped, so most triangles stay where they are. */
    for (int a = 0; a < 3; a++)
        for (int high = 0; high < 2 && n > 0; high++) {
            double const plane = high ? cut->high[a] : cut->low[a], sign = high ? -1.0 : 1.0;
            double(*const last)[3] = from;
            int32_t inside = 0;
            for (int32_t i = 0; i < n; i++) inside += sign * (from[i][a] - plane) >= 0.0;
            if (inside == n) continue;
            n = cut_by_plane((const double(*)[3])from, n, a, plane, sign, to);
            from = to;
            to = last;
        }
    if (n > 0 && from != corner) memcpy(corner, from, (size_t)n * sizeof *corner);
    return n;
}
