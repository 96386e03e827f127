/* nearest_pairs.c - closest points on triangles, four pairs of a point and a triangle at a time.
 *
 * The evaluation is that of point_triangle.c with the same operations in the same order, its cases chosen by masks: corners and
 * edges divide the product that the case has asked already, so one division serves all of them. Pairs for which the masks are
 * not made (needles, and where rounding leaves no region) go to point_triangle.c itself.
 * Guarantee: the same bits as bvxi_closest_on_triangle, but for the sign of zeros. */
#include "field/nearest_pairs.h"
#include "mesh/closest.h"
#include "mesh/facet.h"

#if BVXI_HAVE_AVX2
#include <immintrin.h>
#endif

/* ---- Corners ---- */

static void order_near_corners(bvxi_near_pairs *p)
{
    for (int32_t i = 0; i < p->count; i++) {
        double t[3][3];

        for (int v = 0; v < 9; v++) t[v / 3][v % 3] = p->corner[v][i];
        bvxi_order_corners(t);
        for (int v = 0; v < 9; v++) p->corner[v][i] = t[v / 3][v % 3];
    }
}

/* Indices of all first, then positions: what is waited for is on its way together. */
static void gather_near_packed(const bvxi_nearest *n, bvxi_near_pairs *p)
{
    const unsigned char *const positions = n->view.positions, *const indices = n->view.indices;
    uint32_t c[BVXI_NEAR_PAIRS][3];
    for (int32_t i = 0; i < p->count; i++) {
        memcpy(c[i], indices + (size_t)p->triangle[i] * 12, sizeof c[i]);
        for (int v = 0; v < 3; v++) BVXI_PREFETCH(positions + (size_t)c[i][v] * 12);
    }
    for (int32_t i = 0; i < p->count; i++)
        for (int v = 0; v < 3; v++) {
            float f[3];
            memcpy(f, positions + (size_t)c[i][v] * 12, sizeof f);
            for (int a = 0; a < 3; a++) p->corner[3 * v + a][i] = (double)f[a] * n->scale;
        }
    if (n->by_planes) order_near_corners(p);
}

static void gather_near_any(const bvxi_nearest *n, bvxi_near_pairs *p)
{
    for (int32_t i = 0; i < p->count; i++) {
        double t[3][3];
        bvxi_near_corners(n, p->triangle[i], t);
        for (int v = 0; v < 9; v++) p->corner[v][i] = t[v / 3][v % 3];
    }
    if (n->by_planes) order_near_corners(p);
}

/* ---- One pair ---- */

static void evaluate_near_pair(bvxi_near_pairs *p, int32_t i)
{
    double const point[3] = {p->point[0][i], p->point[1][i], p->point[2][i]};
    double t[3][3], q[3];
    for (int v = 0; v < 9; v++) t[v / 3][v % 3] = p->corner[v][i];
    p->distance2[i] = bvxi_closest_on_triangle(point, (const double(*)[3])t, q);
    for (int a = 0; a < 3; a++) p->closest[a][i] = q[a];
}

#if BVXI_HAVE_AVX2

/* ---- Four pairs ---- */

#define NEAR_DOT4(u, v) ((u##x) * (v##x) + (u##y) * (v##y) + (u##z) * (v##z))
#define NEAR_LESS(x, y) _mm256_cmp_pd(x, y, _CMP_LT_OQ)
#define NEAR_LESS_EQUAL(x, y) _mm256_cmp_pd(x, y, _CMP_LE_OQ)
#define NEAR_BOTH(x, y) _mm256_and_pd(x, y)
#define NEAR_CHOOSE(mask, yes, no) _mm256_blendv_pd(no, yes, mask)

/* Evaluate pairs i to i + 3; returns the mask of those that need point_triangle.c. */
BVXI_AVX2 static inline uint32_t evaluate_near_four(bvxi_near_pairs *p, int32_t i)
{
    __m256d const zero = _mm256_setzero_pd();
    __m256d const px = _mm256_loadu_pd(p->point[0] + i), py = _mm256_loadu_pd(p->point[1] + i), pz = _mm256_loadu_pd(p->point[2] + i);
    __m256d const ax = _mm256_loadu_pd(p->corner[0] + i), ay = _mm256_loadu_pd(p->corner[1] + i), az = _mm256_loadu_pd(p->corner[2] + i);
    __m256d const bx = _mm256_loadu_pd(p->corner[3] + i), by = _mm256_loadu_pd(p->corner[4] + i), bz = _mm256_loadu_pd(p->corner[5] + i);
    __m256d const cx = _mm256_loadu_pd(p->corner[6] + i), cy = _mm256_loadu_pd(p->corner[7] + i), cz = _mm256_loadu_pd(p->corner[8] + i);
    __m256d const ux = bx - ax, uy = by - ay, uz = bz - az; /* ab */
    __m256d const vx = cx - ax, vy = cy - ay, vz = cz - az; /* ac */
    __m256d const ex = cx - bx, ey = cy - by, ez = cz - bz; /* bc */
    __m256d const wx = px - ax, wy = py - ay, wz = pz - az; /* ap */
    __m256d const fx = px - bx, fy = py - by, fz = pz - bz; /* bp */
    __m256d const nx = uy * vz - uz * vy, ny = uz * vx - ux * vz, nz = ux * vy - uy * vx;
    __m256d const gx = wy * vz - wz * vy, gy = wz * vx - wx * vz, gz = wx * vy - wy * vx;
    __m256d const hx = uy * wz - uz * wy, hy = uz * wx - ux * wz, hz = ux * wy - uy * wx;
    __m256d const ab2 = NEAR_DOT4(u, u), ac2 = NEAR_DOT4(v, v), bc2 = NEAR_DOT4(e, e), abac = NEAR_DOT4(u, v), area2 = NEAR_DOT4(n, n);
    __m256d const d1 = NEAR_DOT4(u, w), d2 = NEAR_DOT4(v, w), d3 = d1 - ab2, d4 = d2 - abac, d5 = d1 - abac, d6 = d2 - ac2;
    __m256d const vb = NEAR_DOT4(g, n), vc = NEAR_DOT4(h, n), va = area2 - vb - vc;
    __m256d const longest = _mm256_max_pd(_mm256_max_pd(ab2, ac2), bc2);
    __m256d const wide = NEAR_LESS(longest * longest * _mm256_set1_pd(0x1p-40), area2);
    /* the cases in their order; each mask is used only where none before it is set */
    __m256d const at_a = NEAR_BOTH(NEAR_LESS_EQUAL(d1, zero), NEAR_LESS_EQUAL(d2, zero));
    __m256d const at_b = NEAR_BOTH(NEAR_LESS_EQUAL(zero, d3), NEAR_LESS_EQUAL(d4, d3));
    __m256d const at_c = NEAR_BOTH(NEAR_LESS_EQUAL(zero, d6), NEAR_LESS_EQUAL(d5, d6));
    __m256d const on_ab = NEAR_BOTH(NEAR_LESS_EQUAL(vc, zero), NEAR_BOTH(NEAR_LESS_EQUAL(zero, d1), NEAR_LESS_EQUAL(d3, zero)));
    __m256d const on_ac = NEAR_BOTH(NEAR_LESS_EQUAL(vb, zero), NEAR_BOTH(NEAR_LESS_EQUAL(zero, d2), NEAR_LESS_EQUAL(d6, zero)));
    __m256d const on_bc = NEAR_BOTH(NEAR_LESS_EQUAL(va, zero), NEAR_BOTH(NEAR_LESS_EQUAL(d3, d4), NEAR_LESS_EQUAL(d6, d5)));
    __m256d const over = NEAR_BOTH(NEAR_LESS(zero, va), NEAR_BOTH(NEAR_LESS(zero, vb), NEAR_LESS(zero, vc)));
    __m256d const corner = _mm256_or_pd(at_a, _mm256_or_pd(at_b, at_c)), edge = _mm256_or_pd(on_ab, _mm256_or_pd(on_ac, on_bc));
    /* an edge: from its first corner along it, its ends as they are */
    __m256d const along = NEAR_CHOOSE(on_ab, d1, NEAR_CHOOSE(on_ac, d2, NEAR_DOT4(e, f)));
    __m256d const length2 = NEAR_CHOOSE(on_ab, ab2, NEAR_CHOOSE(on_ac, ac2, bc2));
    __m256d const first_b = _mm256_andnot_pd(_mm256_or_pd(on_ab, on_ac), edge); /* the edge bc begins at b */
    __m256d const begins = NEAR_LESS_EQUAL(along, zero), ends = NEAR_LESS_EQUAL(length2, along);
    __m256d const s = NEAR_CHOOSE(edge, along, vb) / NEAR_CHOOSE(edge, length2, area2), t = vc / area2;
    __m256d const kx = NEAR_CHOOSE(on_ab, ux, NEAR_CHOOSE(on_ac, vx, ex)), ky = NEAR_CHOOSE(on_ab, uy, NEAR_CHOOSE(on_ac, vy, ey));
    __m256d const kz = NEAR_CHOOSE(on_ab, uz, NEAR_CHOOSE(on_ac, vz, ez));
    __m256d const lx = NEAR_CHOOSE(edge, kx, ux), ly = NEAR_CHOOSE(edge, ky, uy), lz = NEAR_CHOOSE(edge, kz, uz);
    __m256d const ox = NEAR_CHOOSE(first_b, bx, ax), oy = NEAR_CHOOSE(first_b, by, ay), oz = NEAR_CHOOSE(first_b, bz, az);
    __m256d const share = _mm256_andnot_pd(edge, t);
    __m256d qx = ox + s * lx + share * vx, qy = oy + s * ly + share * vy, qz = oz + s * lz + share * vz;
    /* what ends up in a corner: a, b or c */
    __m256d const snap = _mm256_or_pd(corner, NEAR_BOTH(edge, _mm256_or_pd(begins, ends)));
    __m256d const to_b = NEAR_CHOOSE(corner, _mm256_andnot_pd(at_a, at_b),
                                     NEAR_CHOOSE(first_b, begins, NEAR_BOTH(on_ab, _mm256_andnot_pd(begins, ends))));
    __m256d const to_a = NEAR_CHOOSE(corner, at_a, _mm256_andnot_pd(first_b, begins));
    qx = NEAR_CHOOSE(snap, NEAR_CHOOSE(to_a, ax, NEAR_CHOOSE(to_b, bx, cx)), qx);
    qy = NEAR_CHOOSE(snap, NEAR_CHOOSE(to_a, ay, NEAR_CHOOSE(to_b, by, cy)), qy);
    qz = NEAR_CHOOSE(snap, NEAR_CHOOSE(to_a, az, NEAR_CHOOSE(to_b, bz, cz)), qz);
    __m256d const rx = px - qx, ry = py - qy, rz = pz - qz;
    _mm256_storeu_pd(p->closest[0] + i, qx);
    _mm256_storeu_pd(p->closest[1] + i, qy);
    _mm256_storeu_pd(p->closest[2] + i, qz);
    _mm256_storeu_pd(p->distance2 + i, NEAR_DOT4(r, r));
    return 15u ^ (uint32_t)_mm256_movemask_pd(NEAR_BOTH(wide, _mm256_or_pd(_mm256_or_pd(corner, edge), over)));
}

/* Places behind the last pair are filled with it. */
BVXI_AVX2 static void evaluate_near_fours(bvxi_near_pairs *p)
{
    for (int32_t i = p->count; i > 0 && i % 4 != 0; i++) {
        for (int a = 0; a < 3; a++) p->point[a][i] = p->point[a][p->count - 1];
        for (int v = 0; v < 9; v++) p->corner[v][i] = p->corner[v][p->count - 1];
    }
    for (int32_t i = 0; i < p->count; i += 4) {
        uint32_t left = evaluate_near_four(p, i);
        for (; left != 0; left &= left - 1) evaluate_near_pair(p, i + bvxi_lowest(left));
    }
}
#endif

void bvxi_near_evaluate(const bvxi_nearest *n, int32_t fast, bvxi_near_pairs *pairs)
{
    if (bvxi_view_packed_f32(&n->view) && bvxi_view_packed_u32(&n->view)) gather_near_packed(n, pairs);
    else gather_near_any(n, pairs);
#if BVXI_HAVE_AVX2
    if (fast) {
        evaluate_near_fours(pairs);
        return;
    }
#endif
    (void)fast;
    for (int32_t i = 0; i < pairs->count; i++) evaluate_near_pair(pairs, i);
}
