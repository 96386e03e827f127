/* children.c - the octants of a cube that a triangle touches, all eight at once.
 *
 * Source: as conservative.c: an octant is missed when the boxes, the projections onto a coordinate plane, or
 * the plane's two sides have a gap. About the cube's centre the octants differ by one step of `half` along
 * each axis, so an edge takes four values in a projection, the plane eight on each side: the value at the
 * centre plus one step for each axis along which the octant lies on the growing side.
 *
 * Bit budget (lattice.h). Corners relative to the centre lie within 1.5 * 2^30, half <= 2^28, slopes are
 * differences of corners below 2^31. Edges: 4.5 * 2^60 + 2 * 2^59 < 2^63. The plane: components of the normal
 * below 2^63, three products with corners and three steps below 2^97 in 128 bits; in 64 bits when the
 * triangle is small enough for its distance.
 * Guarantee: exact for every triangle that touches the cube, also without area, also far larger than it. */
#include "refine/cubes.h"

/* Octants with s = 0 and with s = 1 along each axis. */
static const uint8_t child_half[3][2] = {{0x55, 0xaa}, {0x33, 0xcc}, {0x0f, 0xf0}};

/* Octants whose box the triangle's box meets: its box meets the cube, so the cube's middle planes alone part
 * them. *held becomes 1 when the cube holds all of the triangle. */
static inline uint32_t children_of_box(const int32_t (*p)[3], int32_t half, int *held, int64_t *spread,
                                       int64_t *reach)
{
    uint32_t mask = 255;
    int inside = 1;

    *spread = 0;
    *reach = half;
    for (int a = 0; a < 3; a++) {
        int32_t const u = p[0][a], v = p[1][a], w = p[2][a];
        int32_t const uv = u < v ? u : v, UV = u < v ? v : u;
        int32_t const least = uv < w ? uv : w, most = UV > w ? UV : w;
        int64_t const far = (int64_t)most > -(int64_t)least ? (int64_t)most : -(int64_t)least;
        mask &= (least <= 0 ? (uint32_t)child_half[a][0] : 0) | (most >= 0 ? (uint32_t)child_half[a][1] : 0);
        inside &= least >= -half && most <= half;
        if ((int64_t)most - least > *spread) *spread = (int64_t)most - least;
        if (far > *reach) *reach = far;
    }
    *held = inside;
    return mask;
}

/* Octants that the edge a -> b leaves outside; turn is +1 or -1, the sign of the area. Those on both growing
 * sides hold the cube's best corner, which is not outside since the triangle touches the cube. */
static inline uint32_t child_edge_misses(const int64_t a[2], const int64_t b[2], int64_t turn, int64_t half,
                                         const uint8_t *hu, const uint8_t *hv)
{
    int64_t const at = (a[0] * b[1] - a[1] * b[0]) * turn;

    if (at >= 0) return 0;
    int64_t const du = (a[1] - b[1]) * turn, dv = (b[0] - a[0]) * turn;
    int64_t const su = (du < 0 ? -du : du) * half, sv = (dv < 0 ? -dv : dv) * half;
    uint32_t const u = hu[du > 0], v = hv[dv > 0]; /* octants on the growing side */
    uint32_t missed = 255 & ~u & ~v;
    if (at + su < 0) missed |= u & ~v;
    if (at + sv < 0) missed |= v & ~u;
    return missed;
}

static inline uint32_t child_projection_misses(const int32_t (*p)[3], int u, int v, int64_t half)
{
    int64_t const a[2] = {p[0][u], p[0][v]}, b[2] = {p[1][u], p[1][v]}, c[2] = {p[2][u], p[2][v]};
    int64_t const area = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
    const uint8_t *const hu = child_half[u], *const hv = child_half[v];
    uint32_t missed = 0;

    if (area >= 0)
        missed |= child_edge_misses(a, b, 1, half, hu, hv) | child_edge_misses(b, c, 1, half, hu, hv) |
                  child_edge_misses(c, a, 1, half, hu, hv);
    if (area <= 0)
        missed |= child_edge_misses(a, b, -1, half, hu, hv) | child_edge_misses(b, c, -1, half, hu, hv) |
                  child_edge_misses(c, a, -1, half, hu, hv);
    return missed;
}

/* Octants on one side of the plane. at: its value at the centre; step: what it gains along each axis within
 * half, not negative; grows: bit a where it grows towards + along axis a. */
static inline uint32_t child_plane_misses(int64_t at, const int64_t step[3], uint32_t grows)
{
    int64_t sum[8];
    uint32_t missed = 0;

    sum[0] = 0;
    for (uint32_t k = 1; k < 8; k++)
        sum[k] = (k & 1 ? step[0] : 0) + (k & 2 ? step[1] : 0) + (k & 4 ? step[2] : 0);
    for (uint32_t o = 0; o < 8; o++) {
        uint32_t const with = ~(o ^ grows) & 7;
        missed |= (uint32_t)((at + sum[with] < 0) | (at - sum[7 ^ with] > 0)) << o;
    }
    return missed;
}

static uint32_t child_plane_misses_wide(const int64_t n[3], const int32_t p[3], int64_t half)
{
    bvxi_wide at = bvxi_wide_mul(-n[0], p[0]);
    uint32_t missed = 0;

    at = bvxi_wide_add(at, bvxi_wide_mul(-n[1], p[1]));
    at = bvxi_wide_add(at, bvxi_wide_mul(-n[2], p[2]));
    for (uint32_t o = 0; o < 8; o++) {
        bvxi_wide most = at, least = at;
        for (int a = 0; a < 3; a++) {
            int64_t const slope = o >> a & 1 ? n[a] : -n[a]; /* towards the octant */
            if (slope > 0) most = bvxi_wide_add(most, bvxi_wide_mul(slope, half));
            else least = bvxi_wide_add(least, bvxi_wide_mul(slope, half));
        }
        missed |= (uint32_t)(bvxi_wide_sign(most) < 0 || bvxi_wide_sign(least) > 0) << o;
    }
    return missed;
}

static uint32_t children_beside_plane(const int32_t (*p)[3], int64_t half, int64_t spread, int64_t reach)
{
    int64_t u[3], v[3], n[3];

    for (int a = 0; a < 3; a++) {
        u[a] = (int64_t)p[1][a] - p[0][a];
        v[a] = (int64_t)p[2][a] - p[0][a];
    }
    for (int a = 0; a < 3; a++) n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];

    /* |n| <= 2 spread^2, so all sums stay below 6 spread^2 (reach + half) */
    if ((double)spread * (double)spread * (double)(reach + half) < 1.5e18) {
        int64_t const at = -(n[0] * p[0][0] + n[1] * p[0][1] + n[2] * p[0][2]);
        int64_t step[3];
        for (int a = 0; a < 3; a++) step[a] = (n[a] < 0 ? -n[a] : n[a]) * half;
        return child_plane_misses(
            at, step, (uint32_t)(n[0] > 0) | (uint32_t)(n[1] > 0) << 1 | (uint32_t)(n[2] > 0) << 2);
    }
    return child_plane_misses_wide(n, p[0], half);
}

uint32_t bvxi_children_touched(const int32_t (*p)[3], int32_t half)
{
    int64_t spread, reach;
    int held;
    uint32_t mask = children_of_box(p, half, &held, &spread, &reach);

    if ((mask & (mask - 1)) == 0) return mask; /* the only octant left, and the cube is touched */
    /* it reaches over one middle plane and lies in the two octants */
    if (held && bvxi_children_are_pair(mask)) return mask;
    mask &= ~child_projection_misses(p, 0, 1, half);
    mask &= ~child_projection_misses(p, 0, 2, half);
    mask &= ~child_projection_misses(p, 1, 2, half);
    if ((mask & (mask - 1)) == 0) return mask;
    return mask & ~children_beside_plane(p, half, spread, reach);
}
