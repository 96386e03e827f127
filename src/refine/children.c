/* children.c - which of a voxel's eight children a triangle touches, all eight at once: exactly in integers,
 * or for many triangles in doubles where these are sure.
 *
 * Source: as touch/conservative.c. Guarantee: the same answer by both ways. */
#include "refine/cubes.h"

/* ---- The octants of a cube that a triangle touches, all eight at once ---- */

/* Source: as conservative.c: an octant is missed when the boxes, the projections onto a coordinate plane, or
 * the plane's two sides have a gap. About the cube's centre the octants differ by one step of `half` along
 * each axis, so an edge takes four values in a projection, the plane eight on each side: the value at the
 * centre plus one step for each axis along which the octant lies on the growing side.
 *
 * Bit budget (lattice.h). Corners relative to the centre lie within 1.5 * 2^30, half <= 2^28, slopes are
 * differences of corners below 2^31. Edges: 4.5 * 2^60 + 2 * 2^59 < 2^63. The plane: components of the normal
 * below 2^63, three products with corners and three steps below 2^97 in 128 bits.
 * Guarantee: exact for every triangle that touches the cube, also without area, also far larger than it. */

/* Octants with s = 0 and with s = 1 along each axis. */
static const uint8_t child_half[3][2] = {{0x55, 0xaa}, {0x33, 0xcc}, {0x0f, 0xf0}};

/* Octants that the edge a -> b leaves outside; turn is +1 or -1, the sign of the area. Those on both growing
 * sides hold the cube's best corner, which is not outside since the triangle touches the cube. */
static inline uint32_t child_edge_misses(const int64_t a[2], const int64_t b[2], int64_t turn, int64_t half,
                                         const uint8_t *hu, const uint8_t *hv)
{
    /* The edge function at the centre, turned so that the triangle is where it is not negative. */
    int64_t const at = (a[0] * b[1] - a[1] * b[0]) * turn;
    /* The centre is a corner of all eight octants, so none lies outside of an edge that has it inside. */
    if (at >= 0) return 0;
    int64_t const du = (a[1] - b[1]) * turn, dv = (b[0] - a[0]) * turn;
    int64_t const su = (du < 0 ? -du : du) * half, sv = (dv < 0 ? -dv : dv) * half;
    uint32_t const u = hu[du > 0], v = hv[dv > 0]; /* octants on the growing side */
    /* Octants that grow along neither axis keep the value at the centre, which is negative here. */
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
    /* Without an area both turns are asked: outside by either is missed: right for a segment. */
    if (area >= 0)
        missed |= child_edge_misses(a, b, 1, half, hu, hv) | child_edge_misses(b, c, 1, half, hu, hv) |
                  child_edge_misses(c, a, 1, half, hu, hv);
    if (area <= 0)
        missed |= child_edge_misses(a, b, -1, half, hu, hv) | child_edge_misses(b, c, -1, half, hu, hv) |
                  child_edge_misses(c, a, -1, half, hu, hv);
    return missed;
}

/* In 128 bits, as few triangles come here. */
static uint32_t children_beside_plane(const int32_t (*p)[3], int64_t half)
{
    int64_t u[3], v[3], n[3];
    bvxi_wide at = {0};
    uint32_t missed = 0;

    for (int a = 0; a < 3; a++) {
        u[a] = (int64_t)p[1][a] - p[0][a];
        v[a] = (int64_t)p[2][a] - p[0][a];
    }
    for (int a = 0; a < 3; a++) n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
    for (int a = 0; a < 3; a++) at = bvxi_wide_add(at, bvxi_wide_mul(-n[a], p[0][a]));
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

uint32_t bvxi_children_touched(const int32_t (*p)[3], int32_t half)
{
    uint32_t mask = 255;
    int held = 1; /* the cube holds all of the triangle */

    /* Octants whose box the triangle's box meets: its box meets the cube, so the cube's middle planes alone part
     * them. */
    for (int a = 0; a < 3; a++) {
        int32_t const u = p[0][a], v = p[1][a], w = p[2][a];
        int32_t const uv = u < v ? u : v, UV = u < v ? v : u;
        int32_t const least = uv < w ? uv : w, most = UV > w ? UV : w;

        /* A box that touches the middle plane meets the octants on both sides: boxes are closed. */
        mask &= (least <= 0 ? (uint32_t)child_half[a][0] : 0) | (most >= 0 ? (uint32_t)child_half[a][1] : 0);
        held &= least >= -half && most <= half;
    }

    /* Most triangles end here: of a voxel's list few reach over more than one middle plane. */
    if ((mask & (mask - 1)) == 0) return mask; /* the only octant left, and the cube is touched */
    /* it reaches over one middle plane and lies in the two octants */
    if (held && bvxi_children_are_pair(mask)) return mask;

    /* Projections first: they are cheaper than the plane, and often leave one octant. */
    mask &= ~child_projection_misses(p, 0, 1, half);
    mask &= ~child_projection_misses(p, 0, 2, half);
    mask &= ~child_projection_misses(p, 1, 2, half);
    if ((mask & (mask - 1)) == 0) return mask;
    return mask & ~children_beside_plane(p, half);
}

/* ---- The octants that each of many triangles touches, in doubles where these are sure ---- */

/* The tests of children.c in loops without branches. Corners and their differences are exact in doubles. With
 * M the greatest of all coordinates and the octants' side, an edge's values are below 6 M^2 and the plane's
 * below 48 M^3, so they are exact up to M = 2^25 and M = 2^15; above, their roundings add up to less than
 * 2^-47 M^2 and 2^-44 M^3: values nearer to 0 than that leave the triangle to whole numbers, as do
 * projections whose area may be 0.
 * Guarantee: the answers of bvxi_children_touched. */

#define EDGE_EXACT 33554432.0                /* 2^25 */
#define EDGE_SLACK (1.0 / 140737488355328.0) /* 2^-47 */
#define SIDE_EXACT 32768.0                   /* 2^15 */
#define SIDE_SLACK (1.0 / 17592186044416.0)  /* 2^-44 */

/* As children_of_box in children.c, from the batch's arrays; *decided: no more than the box is needed. */
static inline uint32_t batch_box_children(const bvxi_children_batch *b, uint32_t i, int32_t half,
                                          int *decided)
{
    uint32_t mask = 255;
    int held = 1;
    for (int a = 0; a < 3; a++) {
        int32_t const u = b->p[0][a][i], v = b->p[1][a][i], w = b->p[2][a][i];
        int32_t const uv = u < v ? u : v, UV = u < v ? v : u;
        int32_t const least = uv < w ? uv : w, most = UV > w ? UV : w;
        uint32_t const low = a == 0 ? 0x55 : a == 1 ? 0x33 : 0x0f;
        mask &= (least <= 0 ? low : 0) | (most >= 0 ? 255 ^ low : 0);
        held &= least >= -half && most <= half;
    }
    *decided = (mask & (mask - 1)) == 0 || (held && bvxi_children_are_pair(mask));
    return mask;
}

/* Octants that an edge leaves outside, by its values at three positions of a projection; near: 1 when one may be
 * 0. The fourth, the best corner, is not outside, as in children.c. */
BVXI_VECTOR_INLINE int64_t batch_edge_misses(double au, double av, double bu, double bv, double turn,
                                             double half, double slack, int64_t u1, int64_t v1, int64_t *near)
{
    double const at = (au * bv - av * bu) * turn, du = (av - bv) * turn, dv = (bu - au) * turn;
    double const su = (du < 0 ? -du : du) * half, sv = (dv < 0 ? -dv : dv) * half;
    double const atu = at + su, atv = at + sv;
    int64_t const u = du > 0 ? u1 : 255 ^ u1, v = dv > 0 ? v1 : 255 ^ v1; /* octants on the growing side */
    int64_t const missed = (at < 0 ? 255 ^ (u | v) : 0) | (atu < 0 ? u & ~v : 0) | (atv < 0 ? v & ~u : 0);
    *near |= (at < slack ? (at > -slack ? 1 : 0) : 0) | (atu < slack ? (atu > -slack ? 1 : 0) : 0) |
             (atv < slack ? (atv > -slack ? 1 : 0) : 0);
    return missed;
}

BVXI_VECTOR_INLINE void judge_batch_projection(bvxi_children_batch *b, uint32_t n, int u, int v, int64_t u1,
                                               int64_t v1, double half)
{
    const double *BVXI_RESTRICT const qau = b->q[u], *BVXI_RESTRICT const qav = b->q[v],
                                      *BVXI_RESTRICT const qbu = b->q[3 + u];
    const double *BVXI_RESTRICT const qbv = b->q[3 + v], *BVXI_RESTRICT const qcu = b->q[6 + u],
                                      *BVXI_RESTRICT const qcv = b->q[6 + v];
    int64_t *BVXI_RESTRICT const missed = b->missed, *BVXI_RESTRICT const unsure = b->unsure;
    for (uint32_t i = 0; i < n; i++) {
        double const au = qau[i], av = qav[i], bu = qbu[i], bv = qbv[i], cu = qcu[i], cv = qcv[i];

        /* The greatest coordinate decides how far the rounding of a product may reach. */
        double const m0 = (au < 0 ? -au : au) > (av < 0 ? -av : av) ? (au < 0 ? -au : au)
                                                                    : (av < 0 ? -av : av);
        double const m1 = (bu < 0 ? -bu : bu) > (bv < 0 ? -bv : bv) ? (bu < 0 ? -bu : bu)
                                                                    : (bv < 0 ? -bv : bv);
        double const m2 = (cu < 0 ? -cu : cu) > (cv < 0 ? -cv : cv) ? (cu < 0 ? -cu : cu)
                                                                    : (cv < 0 ? -cv : cv);
        double const m01 = m0 > m1 ? m0 : m1, m2h = m2 > half ? m2 : half, m = m01 > m2h ? m01 : m2h;
        double const slack = m > EDGE_EXACT ? m * m * EDGE_SLACK : 0.0;
        double const area = (bu - au) * (cv - av) - (bv - av) * (cu - au), turn = area < 0 ? -1.0 : 1.0;

        /* An area that may be 0 has no turn that is sure. */
        int64_t near = (area <= slack ? (area >= -slack ? 1 : 0) : 0), outside;
        outside = batch_edge_misses(au, av, bu, bv, turn, half, slack, u1, v1, &near);
        outside |= batch_edge_misses(bu, bv, cu, cv, turn, half, slack, u1, v1, &near);
        outside |= batch_edge_misses(cu, cv, au, av, turn, half, slack, u1, v1, &near);
        missed[i] |= outside;
        unsure[i] |= near;
    }
}

/* Octants below the plane, by its value at each one's best corner. The best
 * corner of all is the cube's, which is not below it. */
BVXI_VECTOR_INLINE int64_t batch_plane_side(double at, double sx, double sy, double sz, double slack,
                                            int64_t x, int64_t y, int64_t z, int64_t *near)
{
    /* x, y, z: octants that lie on the growing side of an axis; those gain its step, on all three the most */
    double const a0 = at;
    double const ax = at + sx;
    double const ay = at + sy;
    double const az = at + sz;
    double const axy = ax + sy;
    double const axz = ax + sz;
    double const ayz = ay + sz;
    int64_t const X = 255 ^ x, Y = 255 ^ y, Z = 255 ^ z;

    *near |= (a0 < slack ? (a0 > -slack ? 1 : 0) : 0) | (ax < slack ? (ax > -slack ? 1 : 0) : 0) |
             (ay < slack ? (ay > -slack ? 1 : 0) : 0) | (az < slack ? (az > -slack ? 1 : 0) : 0) |
             (axy < slack ? (axy > -slack ? 1 : 0) : 0) | (axz < slack ? (axz > -slack ? 1 : 0) : 0) |
             (ayz < slack ? (ayz > -slack ? 1 : 0) : 0);
    return (a0 < 0 ? X & Y & Z : 0) | (ax < 0 ? x & Y & Z : 0) | (ay < 0 ? X & y & Z : 0) |
           (az < 0 ? X & Y & z : 0) | (axy < 0 ? x & y & Z : 0) | (axz < 0 ? x & Y & z : 0) |
           (ayz < 0 ? X & y & z : 0);
}

BVXI_VECTOR_INLINE void judge_batch_plane(bvxi_children_batch *b, uint32_t n, double half)
{
    int64_t *BVXI_RESTRICT const missed = b->missed, *BVXI_RESTRICT const unsure = b->unsure;
    for (uint32_t i = 0; i < n; i++) {
        double const ax = b->q[0][i];
        double const ay = b->q[1][i];
        double const az = b->q[2][i];
        double const bx = b->q[3][i];
        double const by = b->q[4][i];
        double const bz = b->q[5][i];
        double const cx = b->q[6][i], cy = b->q[7][i], cz = b->q[8][i];

        /* As for edges, by the cube of the greatest coordinate: the plane's value is a product of three. */
        double m = half, slack;
        for (int k = 0; k < 9; k++) {
            double const c = b->q[k][i] < 0 ? -b->q[k][i] : b->q[k][i];
            m = c > m ? c : m;
        }
        slack = m > SIDE_EXACT ? m * m * m * SIDE_SLACK : 0.0;
        double const nx = (by - ay) * (cz - az) - (bz - az) * (cy - ay);
        double const ny = (bz - az) * (cx - ax) - (bx - ax) * (cz - az);
        double const nz = (bx - ax) * (cy - ay) - (by - ay) * (cx - ax), at = -(nx * ax + ny * ay + nz * az);

        /* What half a side along each axis adds, whichever way the normal points. */
        double const sx = (nx < 0 ? -nx : nx) * half;
        double const sy = (ny < 0 ? -ny : ny) * half;
        double const sz = (nz < 0 ? -nz : nz) * half;
        int64_t const x = nx > 0 ? 0xaa : 0x55, y = ny > 0 ? 0xcc : 0x33, z = nz > 0 ? 0xf0 : 0x0f;
        int64_t near = 0, beside;
        beside = batch_plane_side(at, sx, sy, sz, slack, x, y, z, &near);
        /* seen from the other side */
        beside |= batch_plane_side(-at, sx, sy, sz, slack, 255 ^ x, 255 ^ y, 255 ^ z, &near);
        missed[i] |= beside;
        unsure[i] |= near;
    }
}

BVXI_VECTOR_INLINE void touch_batch_children(bvxi_children_batch *b, uint32_t count, int32_t half)
{
    uint32_t n = 0;

    for (uint32_t i = 0; i < count; i++) {
        int decided;
        b->touched[i] = (uint8_t)batch_box_children(b, i, half, &decided);
        b->open[n] = (uint16_t)i;
        n += decided ? 0 : 1;
    }

    /* Only those that boxes do not decide, packed, so that the loops below have no gaps. */
    for (int k = 0; k < 9; k++)
        for (uint32_t i = 0; i < n; i++) b->q[k][i] = (double)b->p[k / 3][k % 3][b->open[i]];
    memset(b->missed, 0, n * sizeof *b->missed);
    memset(b->unsure, 0, n * sizeof *b->unsure);
    judge_batch_projection(b, n, 0, 1, 0xaa, 0xcc, (double)half);
    judge_batch_projection(b, n, 0, 2, 0xaa, 0xf0, (double)half);
    judge_batch_projection(b, n, 1, 2, 0xcc, 0xf0, (double)half);
    judge_batch_plane(b, n, (double)half);

    /* Where doubles were not sure whole numbers answer: rare, so the branch costs little. */
    for (uint32_t i = 0; i < n; i++) {
        uint32_t const m = b->open[i];
        if (BVXI_UNLIKELY(b->unsure[i] != 0)) {
            int32_t p[3][3];
            for (int k = 0; k < 9; k++) p[k / 3][k % 3] = b->p[k / 3][k % 3][m];
            b->touched[m] = (uint8_t)bvxi_children_touched((const int32_t(*)[3])p, half);
        } else {
            b->touched[m] = (uint8_t)(b->touched[m] & ~(uint32_t)b->missed[i]);
        }
    }
}

BVXI_AVX2_COPY(touch_batch_children_avx2, (bvxi_children_batch * b, uint32_t count, int32_t half),
               touch_batch_children(b, count, half))

void bvxi_children_of_batch(bvxi_children_batch *batch, uint32_t count, int32_t half, int32_t cpu)
{
    BVXI_PATH(cpu == BVX_CPU_AVX2, touch_batch_children(batch, count, half),
              touch_batch_children_avx2(batch, count, half));
}
