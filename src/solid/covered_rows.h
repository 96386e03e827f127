/* covered_rows.h - the rows of centres that a triangle covers, and where it crosses them. Not installed.
 *
 * Projected along x, a triangle covers the row (j, k) when the displaced centre (y_j + e_y, z_k + e_z), e_y
 * >> e_z > 0, lies strictly inside its projection; it crosses the row at the first centre x_i + e_x, e_x >>
 * e_y, beyond its plane. With E the edge function of an edge (dy, dz), positive inside, a zero is decided by
 * the displacement: inside when dz < 0, or dz = 0 and dy > 0. A centre on the plane is beyond it, since e_x
 * outweighs the others and n_x > 0.
 *
 * To walk along another axis the coordinates change places: (y, x, z) along y, (z, x, y) along z. The two
 * across stay in the order of their displacements, so the edge rule stays; for a centre on the plane see
 * bvxi_triangle_walk.
 *
 * Budgets (lattice.h): differences < 2^31, edge functions and normals < 2^63 in int64_t; the plane at a
 * centre < 2^96 in 128 bits.
 * Crossings are divided in doubles first: with t = |n_y| D_y + |n_z| D_z (D: extents; the numerator's terms
 * are no larger) the quotient is off by less than 8 * 2^-53 t / n_x + 2^-20 fixed-point steps: two roundings
 * of n, two of products, one of the sum, two of the division, and the last addition on numbers below 2^32.
 * When an integer lies that near, 128-bit bisection decides; so the answer is always the exact one. */
#ifndef BVXI_COVERED_ROWS_H
#define BVXI_COVERED_ROWS_H

#include "solid/snap.h"

typedef struct bvxi_triangle {
    int32_t p[3][3]; /* counter-clockwise in (y, z); for other axes read: in the two across */
    int64_t n[3];    /* (b-a) x (c-a), n[0] > 0 */
    int32_t beyond;  /* 1: a centre on the plane counts as beyond it */
    int32_t leaving; /* 1: outwards is towards +x, so a walk along +x leaves the solid here */
} bvxi_triangle;

/* 1 when the centre (i, j, k) of the lattice lies beyond the plane or on it. */
static inline int bvxi_beyond_plane(const bvxi_triangle *t, int32_t fraction_bits, int64_t i, int64_t j,
                                    int64_t k)
{
    int64_t const half = (int64_t)1 << (fraction_bits - 1), step = (int64_t)1 << fraction_bits;
    bvxi_wide s = bvxi_wide_mul(t->n[0], i * step + half - t->p[0][0]);
    s = bvxi_wide_add(s, bvxi_wide_mul(t->n[1], j * step + half - t->p[0][1]));
    s = bvxi_wide_add(s, bvxi_wide_mul(t->n[2], k * step + half - t->p[0][2]));
    return bvxi_wide_sign(s) + t->beyond > 0;
}

/* First centre of row (j, k) beyond the plane, by bisection between the triangle's own ends. */
int32_t bvxi_cross_exact(const bvxi_triangle *t, int32_t fraction_bits, int32_t j, int32_t k);

/* Ceiling of a / b for b > 0. */
static inline int64_t bvxi_ceil_div(int64_t a, int64_t b)
{
    int64_t const q = a / b;
    return q + (a % b > 0);
}

/* Order a triangle and make its normal. 0 when its projection has no area: it covers nothing. */
static inline int bvxi_triangle_setup(const int32_t *a, const int32_t *b, const int32_t *c, bvxi_triangle *t)
{
    int64_t const uy = (int64_t)b[1] - a[1], uz = (int64_t)b[2] - a[2];
    int64_t const vy = (int64_t)c[1] - a[1], vz = (int64_t)c[2] - a[2];
    int64_t const area = uy * vz - uz * vy;

    if (area == 0) return 0;
    t->leaving = area > 0;
    t->beyond = 1;
    memcpy(t->p[0], a, 12);
    memcpy(t->p[1], area > 0 ? b : c, 12);
    memcpy(t->p[2], area > 0 ? c : b, 12);
    int64_t const ux = (int64_t)b[0] - a[0];
    int64_t const vx = (int64_t)c[0] - a[0];
    t->n[0] = area > 0 ? area : -area;
    t->n[1] = area > 0 ? uz * vx - ux * vz : ux * vz - uz * vx;
    t->n[2] = area > 0 ? ux * vy - uy * vx : uy * vx - ux * vy;
    return 1;
}

/* The triangle's coordinates are those for a walk along an axis: is the displaced centre on its plane beyond
 * it? The first component of the normal in the order x, y, z that is not 0 decides, as its displacement
 * outweighs the others; the normal is positive along the walk. */
static inline void bvxi_triangle_walk(bvxi_triangle *t, int32_t axis)
{
    if (axis >= 1 && t->n[1] != 0) t->beyond = t->n[1] > 0;      /* x, across the walk */
    else if (axis == 2 && t->n[2] != 0) t->beyond = t->n[2] > 0; /* y, across it too */
    else t->beyond = 1;
}

/* Narrow [*first, *last] to the lines n (at y0 + n step, in the slice z) whose displaced centres lie inside
 * all three edges. The slice is one of the triangle's box: least z <= z < greatest z. */
static inline void bvxi_cover_span(const bvxi_triangle *t, int64_t y0, int64_t z, int64_t step,
                                   int64_t *first, int64_t *last)
{
    for (int32_t i = 0; i < 3; i++) {
        const int32_t *const u = t->p[i], *const v = t->p[i == 2 ? 0 : i + 1];
        int64_t const dy = (int64_t)v[1] - u[1], dz = (int64_t)v[2] - u[2];
        /* need e - n dz step >= 0 for line n */
        int64_t const e = dy * (z - u[2]) - dz * (y0 - u[1]) - (dz > 0);
        if (dz > 0) {
            int64_t const most = bvxi_floor_div(e, dz * step);
            if (most < *last) *last = most;
        } else if (dz < 0) {
            int64_t const least = bvxi_ceil_div(-e, -dz * step);
            if (least > *first) *first = least;
        } /* else: the box's lower or upper side; a slice from the lower one on and below the upper one is
             inside */
    }
}

/* One edge (u, v) at the four centres of a block, the first, the next along y, along z and along both: e is its
 * function u_y v_z - v_y u_z at the first, and least becomes its least value with the area's sign. A zero
 * has the sign that the displacement gives it: + when dz < 0, or dz = 0 and dy > 0, which is when
 * 2^32 dz - dy < 0. Half a unit stands for that: it decides where the function is 0, and cannot reach the
 * next integer. */
BVXI_VECTOR_INLINE void bvxi_judge_edge(double e, double dy, double dz, double turn, double step,
                                        double least[4])
{
    double const first = turn * (e + (dz * 4294967296.0 - dy < 0 ? 0.5 : -0.5));
    double const along_y = turn * step * dz, along_z = turn * step * dy;
    double const at[4] = {first, first - along_y, first + along_z, first - along_y + along_z};
    for (int c = 0; c < 4; c++) least[c] = at[c] < least[c] ? at[c] : least[c];
}

/* Bits of the four centres of a block that lie inside a triangle, where the three signs are that of the area; corners
 * are relative to the first. Each edge function comes from both of its ends: triangles that share an edge compute it
 * from the same numbers, so they agree on its sign. *area: twice, positive when counter-clockwise. */
BVXI_VECTOR_INLINE int64_t bvxi_judge_block(double ay, double az, double by, double bz, double cy, double cz,
                                            double step, double *area)
{
    double const bc = by * cz - cy * bz, ca = cy * az - ay * cz, ab = ay * bz - by * az;
    double const sum = bc + ca + ab, turn = sum < 0 ? -1.0 : 1.0;
    double least[4] = {1.0, 1.0, 1.0, 1.0};

    bvxi_judge_edge(bc, cy - by, cz - bz, turn, step, least);
    bvxi_judge_edge(ca, ay - cy, az - cz, turn, step, least);
    bvxi_judge_edge(ab, by - ay, bz - az, turn, step, least);
    *area = sum;
    return (least[0] > 0 ? (int64_t)1 : 0) | (least[1] > 0 ? 2 : 0) | (least[2] > 0 ? 4 : 0) |
           (least[3] > 0 ? 8 : 0);
}

/* The centres of a block that are inside, by their bits, and how many. */
static const uint16_t bvxi_inside_centres[16][4] = {
    {0}, {0},    {1},    {0, 1},    {2},    {0, 2},    {1, 2},    {0, 1, 2},
    {3}, {0, 3}, {1, 3}, {0, 1, 3}, {2, 3}, {0, 2, 3}, {1, 2, 3}, {0, 1, 2, 3}};
static const uint8_t bvxi_inside_count[16] = {0, 1, 1, 2, 1, 2, 2, 3, 1, 2, 2, 3, 2, 3, 3, 4};

/* What the double division needs of a triangle. */
typedef struct bvxi_divider {
    double ny, nz, inverse; /* of the normal; 1 / n_x */
    double ax, ay, az;      /* first corner, ax less half a voxel */
    double scale, error;    /* 2^-F; bound on the result's error [Units: voxels] */
} bvxi_divider;

static inline void bvxi_divider_setup(const bvxi_triangle *t, int32_t fraction_bits, double extent_y,
                                      double extent_z, bvxi_divider *d)
{
    double const ny = (double)t->n[1], nz = (double)t->n[2];

    d->ny = ny;
    d->nz = nz;
    d->inverse = 1.0 / (double)t->n[0];
    d->ax = (double)t->p[0][0] - (double)(1 << (fraction_bits - 1));
    d->ay = (double)t->p[0][1];
    d->az = (double)t->p[0][2];
    d->scale = 1.0 / (double)(1 << fraction_bits);
    d->error = (((ny < 0 ? -ny : ny) * extent_y + (nz < 0 ? -nz : nz) * extent_z) * d->inverse *
                    (1.0 / 1125899906842624.0) +
                1.0 / 1048576.0) *
               d->scale;
}

/* Where the row whose centre is (y, z) in fixed point crosses the plane, to the divider's error [Units:
 * centres]. */
static inline double bvxi_cross_place(const bvxi_divider *d, double y, double z)
{
    double const s = d->ny * (y - d->ay) + d->nz * (z - d->az);

    return (d->ax - s * d->inverse) * d->scale;
}

/* First centre of row (j, k) beyond the plane, (y, z) being the row's centre in fixed point. */
static inline int32_t bvxi_cross(const bvxi_triangle *t, const bvxi_divider *d, int32_t fraction_bits,
                                 double y, double z, int32_t j, int32_t k)
{
    double const v = bvxi_cross_place(d, y, z);

    /* v is off by no more, and the row crosses the plane in the triangle: it is below 2^30 */
    if (BVXI_LIKELY(d->error < 0.25)) {
        int32_t const down = (int32_t)v - (v < (double)(int32_t)v); /* floor */
        double const part = v - (double)down;
        if (BVXI_LIKELY(part > d->error) && BVXI_LIKELY(part < 1.0 - d->error)) return down + 1;
    }
    return bvxi_cross_exact(t, fraction_bits, j, k);
}

#endif
