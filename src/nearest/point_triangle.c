/* point_triangle.c - the closest point on a triangle.
 *
 * Source: Ericson. Real-Time Collision Detection. 2005, 5.1.5: which of seven regions (three corners, three
 * edges, the face) the point projects into. The weights come from cross products: the book's differences of
 * products lose twice as many digits on needles. A needle whose height is below 2^-20 of its longest edge
 * takes the best of the three edges and, where the signs say so, the face.
 * The result is a point of the triangle up to rounding, never further than the closest one by more than 2^-26
 * of the longest edge (2 10^-9 was the worst of millions of random needles; 10^-15 without needles). */
#include "nearest/closest.h"
#include "core/vec3.h"

static double closest_at(const double p[3], const double corner[3], double q[3])
{
    memcpy(q, corner, 3 * sizeof q[0]);
    return bvxi_vec_distance2(p, q);
}

/* Closest point of the segment from a to b. */
static double closest_on_segment(const double p[3], const double a[3], const double b[3], double q[3])
{
    double const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double const w[3] = {p[0] - a[0], p[1] - a[1], p[2] - a[2]};
    double const along = bvxi_vec_dot(u, w), length2 = bvxi_vec_dot(u, u);
    /* Before, beyond, or between; NaN counts as before. */
    if (!(along > 0.0)) return closest_at(p, a, q);
    if (along >= length2) return closest_at(p, b, q);
    for (int k = 0; k < 3; k++) q[k] = a[k] + along / length2 * u[k];
    return bvxi_vec_distance2(p, q);
}

static double closest_on_edges(const double p[3], const double t[3][3], double q[3])
{
    double best = closest_on_segment(p, t[0], t[1], q), r[3];
    /* Of equally near edges the first one stays. */
    for (int k = 1; k < 3; k++) {
        double const d = closest_on_segment(p, t[k], t[k == 2 ? 0 : k + 1], r);
        if (d < best) {
            best = d;
            memcpy(q, r, sizeof r);
        }
    }
    return best;
}

/* q = a + v ab + w ac, the projection into the triangle. */
static double closest_on_face(const double p[3], const double a[3], const double ab[3], double v,
                              const double ac[3], double w, double q[3])
{
    for (int k = 0; k < 3; k++) q[k] = a[k] + v * ab[k] + w * ac[k];
    return bvxi_vec_distance2(p, q);
}

double bvxi_closest_on_triangle(const double p[3], const double t[3][3], double q[3])
{
    double ab[3], ac[3], bc[3], ap[3], n[3], nb[3], nc[3], longest2;

    for (int k = 0; k < 3; k++) {
        ab[k] = t[1][k] - t[0][k];
        ac[k] = t[2][k] - t[0][k];
        bc[k] = t[2][k] - t[1][k];
        ap[k] = p[k] - t[0][k];
    }

    /* Cross products keep the digits that differences of products lose on needles. */
    bvxi_vec_cross(ab, ac, n);
    bvxi_vec_cross(ap, ac, nb);
    bvxi_vec_cross(ab, ap, nc);
    double const ab2 = bvxi_vec_dot(ab, ab), ac2 = bvxi_vec_dot(ac, ac), bc2 = bvxi_vec_dot(bc, bc);
    double const abac = bvxi_vec_dot(ab, ac), area2 = bvxi_vec_dot(n, n);
    /* seen from a; then from b and from c */
    double const d1 = bvxi_vec_dot(ab, ap), d2 = bvxi_vec_dot(ac, ap);
    double const d3 = d1 - ab2, d4 = d2 - abac, d5 = d1 - abac, d6 = d2 - ac2;
    double const vb = bvxi_vec_dot(nb, n), vc = bvxi_vec_dot(nc, n), va = area2 - vb - vc;
    int const over_face = va > 0.0 && vb > 0.0 && vc > 0.0;
    longest2 = ab2 > ac2 ? ab2 : ac2;
    longest2 = bc2 > longest2 ? bc2 : longest2;
    if (!(area2 > longest2 * longest2 * 0x1p-40)) { /* a needle */
        double on_face, r[3];
        double const on_edges = closest_on_edges(p, t, q);
        if (!over_face) return on_edges;
        on_face = closest_on_face(p, t[0], ab, vb / area2, ac, vc / area2, r);
        if (!(on_face < on_edges)) return on_edges;
        memcpy(q, r, sizeof r);
        return on_face;
    }

    /* Corners, edges, face, as Ericson has them: in this order each test relies on those before. */
    if (d1 <= 0.0 && d2 <= 0.0) return closest_at(p, t[0], q);
    if (d3 >= 0.0 && d4 <= d3) return closest_at(p, t[1], q);
    if (d6 >= 0.0 && d5 <= d6) return closest_at(p, t[2], q);
    if (vc <= 0.0 && d1 >= 0.0 && d3 <= 0.0) return closest_on_segment(p, t[0], t[1], q);
    if (vb <= 0.0 && d2 >= 0.0 && d6 <= 0.0) return closest_on_segment(p, t[0], t[2], q);
    if (va <= 0.0 && d4 >= d3 && d5 >= d6) return closest_on_segment(p, t[1], t[2], q);
    if (!over_face) return closest_on_edges(p, t, q); /* rounding left no region */
    return closest_on_face(p, t[0], ab, vb / area2, ac, vc / area2, q);
}
