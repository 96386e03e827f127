/* touching_angle.c - the solid angle of a triangle from a displaced centre in its plane, on its edge or at
 * its corner.
 *
 * The displacement (e_x, e_y, e_z), e_x >> e_y >> e_z > 0, is small against all else, so the angle is the
 * limit: in the plane and inside half of all directions, outside none; on an edge those between the half
 * plane and the way back, a lune; at a corner the spherical triangle of the way back and the two edges. The
 * way back from the displacement is towards -x, but across an edge that runs along x towards -y.
 * Guarantee: which case it is, and the side, are decided in integers. */
#include "winding/sheet.h"

#include <math.h>

/* a x b for differences of snapped coordinates. */
static void exact_cross(const int64_t a[3], const int64_t b[3], int64_t n[3])
{
    for (int i = 0; i < 3; i++) n[i] = a[(i + 1) % 3] * b[(i + 2) % 3] - a[(i + 2) % 3] * b[(i + 1) % 3];
}

static int is_zero_vector(const int64_t v[3])
{
    return (v[0] | v[1] | v[2]) == 0;
}

static void to_unit(double v[3])
{
    double const length = bvxi_vec_length(v);
    for (int i = 0; i < 3 && length > 0; i++) v[i] /= length;
}

/* On the edge along `edge` of a triangle whose third corner lies towards c. */
static void lune_angle(const double edge[3], int along_x, const double c[3], double *re, double *im)
{
    double u[3] = {edge[0], edge[1], edge[2]}, across[3], back[3] = {0, 0, 0}, n[3];

    to_unit(u);
    back[along_x ? 1 : 0] = -1;
    double const cu = bvxi_vec_dot(c, u);
    double const bu = bvxi_vec_dot(back, u);
    for (int i = 0; i < 3; i++) {
        across[i] = c[i] - cu * u[i];
        back[i] -= bu * u[i];
    }
    to_unit(across);
    to_unit(back);
    *re = bvxi_vec_dot(back, across);
    bvxi_vec_cross(back, across, n);
    *im = bvxi_vec_length(n);
}

/* At the corner between edges towards b and c. */
static void corner_angle(const int64_t exact_b[3], const int64_t exact_c[3], const double b[3],
                         const double c[3], double *re, double *im)
{
    int const b_along = exact_b[1] == 0 && exact_b[2] == 0, c_along = exact_c[1] == 0 && exact_c[2] == 0;
    double u[3] = {b[0], b[1], b[2]}, v[3] = {c[0], c[1], c[2]};
    double const back[3] = {-1, 0, 0};

    *re = 1;
    *im = 0;
    if ((b_along && exact_b[0] < 0) || (c_along && exact_c[0] < 0)) return; /* moved off it */
    if (b_along || c_along) {                                               /* moved onto the edge */
        lune_angle(b_along ? b : c, 1, b_along ? c : b, re, im);
        return;
    }
    to_unit(u);
    to_unit(v);
    *re = 1 + bvxi_vec_dot(back, u) + bvxi_vec_dot(u, v) + bvxi_vec_dot(v, back);
    *im = u[1] * v[2] - u[2] * v[1];
    if (*im < 0) *im = -*im;
}

int bvxi_touching_angle(const int32_t *const q[3], const int64_t p[3], const double v[3][3], double det,
                        double *re, double *im)
{
    int64_t d[3][3], u[3], w[3], n[3], turn[3];
    int inside = 1, up, largest = 0;

    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++) d[i][a] = q[i][a] - p[a];
        u[i] = (int64_t)q[1][i] - q[0][i];
        w[i] = (int64_t)q[2][i] - q[0][i];
    }
    exact_cross(u, w, n);
    bvxi_wide const s = bvxi_wide_add(bvxi_wide_mul(n[0], d[0][0]), bvxi_wide_mul(n[1], d[0][1]));
    int32_t side = bvxi_wide_sign(bvxi_wide_add(s, bvxi_wide_mul(n[2], d[0][2])));
    if (side != 0) { /* not in its plane: doubles tell all but the side */
        *im = (det < 0 ? -det : det) * side;
        return side > 0;
    }
    for (int i = 0; i < 3 && side == 0; i++) side = (n[i] < 0) - (n[i] > 0); /* the displaced centre's */
    up = side > 0;
    *re = 1;
    *im = 0;
    if (side == 0) return up; /* no area */
    for (int i = 0; i < 3; i++)
        if (is_zero_vector(d[i])) {
            corner_angle(d[(i + 1) % 3], d[(i + 2) % 3], v[(i + 1) % 3], v[(i + 2) % 3], re, im);
            *im = up ? *im : -*im;
            return up;
        }
    while (n[largest] == 0) largest++;
    for (int i = 0; i < 3; i++) {
        const int64_t *const a = d[i], *const b = d[(i + 1) % 3];
        exact_cross(a, b, turn); /* along n, or against it, or zero on the edge's line */
        if (is_zero_vector(turn)) {
            int between = 1;
            for (int k = 0; k < 3; k++) between &= (a[k] <= 0 && b[k] >= 0) || (a[k] >= 0 && b[k] <= 0);
            if (!between) return up;
            double edge[3];
            for (int k = 0; k < 3; k++) edge[k] = v[(i + 1) % 3][k] - v[i][k];
            lune_angle(edge, b[1] == a[1] && b[2] == a[2], v[(i + 2) % 3], re, im);
            *im = up ? *im : -*im;
            return up;
        }
        inside &= (turn[largest] > 0) == (n[largest] > 0);
    }
    if (inside) *re = -1;
    return up;
}
