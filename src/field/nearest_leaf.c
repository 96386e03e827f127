/* nearest_leaf.c - triangles in frames of their own, eight at a time.
 *
 * Source: Jones. 3D Distance from a Point to a Triangle. 1995: turn the triangle into a plane, so that a distance is one in
 * two dimensions and a height. Here the frame stands on the longest edge, at the foot of the altitude: the nearest point to
 * one with x < 0 then lies in the left part, a right triangle (going along x to the altitude never leaves the triangle), so
 * one edge is asked beside the base instead of two.
 * Guarantee: the triangle with the corners foot - p e1, foot + q e1, foot + h e2 lies within 2^-21 of the leaf's extent of the
 * one given, for every triangle: e2 gets a trace of a direction across e1, so there is one where the height is 0, and is made
 * orthogonal a second time, so a needle turns about its own axis by no more than its corner's rounding. */
#include "field/nearest_tree.h"

#include <math.h>
#if BVXI_HAVE_AVX2
#include <immintrin.h>
#endif

#define NEAR_DOT(u, v) ((u##x) * (v##x) + (u##y) * (v##y) + (u##z) * (v##z))
#define NEAR_LEAST 0x1p-120f /* below it lengths and squares are 0 */
#define NEAR_TRACE 0x1p-30f

static inline float near_inverse(float x)
{
    return x > NEAR_LEAST ? 1.0f / x : 0.0f;
}

static inline float near_root(float x)
{
    return (float)sqrt((double)x);
}

static void frame_near_lane(const float corner[9][BVXI_NEAR_WIDTH], const float low[3], int k, bvxi_near_leaf *leaf)
{
    float *const f = leaf->frame[k].f;
    float const ax = corner[0][k], ay = corner[1][k], az = corner[2][k];
    float const bx = corner[3][k], by = corner[4][k], bz = corner[5][k];
    float const cx = corner[6][k], cy = corner[7][k], cz = corner[8][k];
    float const lx = bx - ax, ly = by - ay, lz = bz - az;
    float const mx = cx - bx, my = cy - by, mz = cz - bz;
    float const nx = ax - cx, ny = ay - cy, nz = az - cz;
    float const l2 = NEAR_DOT(l, l), m2 = NEAR_DOT(m, m), n2 = NEAR_DOT(n, n);
    /* the longest edge begins at o and runs along u; v goes from o to the corner across */
    int const at_b = m2 > l2, at_c = n2 > (at_b ? m2 : l2);
    float const ox = at_c ? cx : at_b ? bx : ax, oy = at_c ? cy : at_b ? by : ay, oz = at_c ? cz : at_b ? bz : az;
    float const ux = at_c ? nx : at_b ? mx : lx, uy = at_c ? ny : at_b ? my : ly, uz = at_c ? nz : at_b ? mz : lz;
    float const vx = at_c ? -mx : at_b ? -lx : -nx, vy = at_c ? -my : at_b ? -ly : -ny, vz = at_c ? -mz : at_b ? -lz : -nz;
    float const length = near_root(NEAR_DOT(u, u)), inverse = near_inverse(length);
    float const ex = length > NEAR_LEAST ? ux * inverse : 1.0f, ey = uy * inverse, ez = uz * inverse;
    float const along = NEAR_DOT(v, e);
    float const wx = vx - along * ex, wy = vy - along * ey, wz = vz - along * ez;
    float const again = NEAR_DOT(w, e);
    float const px = wx - again * ex, py = wy - again * ey, pz = wz - again * ez;
    float const h = near_root(NEAR_DOT(p, p)), trace = length * NEAR_TRACE + 0x1p-60f;
    int const steep = ex * ex > 0.5f;
    float const gx = px + trace * (steep ? -ez : 0.0f), gy = py + trace * (steep ? 0.0f : ez), gz = pz + trace * (steep ? ex : -ey);
    float const slant = NEAR_DOT(g, e);
    float const hx = gx - slant * ex, hy = gy - slant * ey, hz = gz - slant * ez;
    float const h1 = near_inverse(near_root(NEAR_DOT(h, h)));
    float const jx = hx * h1, jy = hy * h1, jz = hz * h1, lean = NEAR_DOT(j, e);
    float const ix = jx - lean * ex, iy = jy - lean * ey, iz = jz - lean * ez;
    float const foot = along < 0.0f ? 0.0f : along < length ? along : length, rest = length - foot;
    f[BVXI_NEAR_FOOT] = low[0] + (ox + foot * ex);
    f[BVXI_NEAR_FOOT + 1] = low[1] + (oy + foot * ey);
    f[BVXI_NEAR_FOOT + 2] = low[2] + (oz + foot * ez);
    f[BVXI_NEAR_E1] = ex;
    f[BVXI_NEAR_E1 + 1] = ey;
    f[BVXI_NEAR_E1 + 2] = ez;
    f[BVXI_NEAR_E2] = ix;
    f[BVXI_NEAR_E2 + 1] = iy;
    f[BVXI_NEAR_E2 + 2] = iz;
    f[BVXI_NEAR_E3] = ey * iz - ez * iy;
    f[BVXI_NEAR_E3 + 1] = ez * ix - ex * iz;
    f[BVXI_NEAR_E3 + 2] = ex * iy - ey * ix;
    f[BVXI_NEAR_P] = foot;
    f[BVXI_NEAR_Q] = rest;
    f[BVXI_NEAR_H] = h;
    for (int i = 0; i < 3; i++) {
        float const x = corner[i][k], y = corner[3 + i][k], z = corner[6 + i][k];
        float const least = x < y ? x : y, most = x < y ? y : x;
        leaf->low[i][k] = least < z ? least : z;
        leaf->high[i][k] = most > z ? most : z;
    }
}

#if BVXI_HAVE_AVX2
/* The same in vectors: comments stand above. */
#define NEAR_EITHER(mask, yes, no) _mm256_blendv_ps(no, yes, mask)
#define NEAR_ABOVE(x, y) _mm256_cmp_ps(x, y, _CMP_GT_OQ)
#define NEAR_SET(x) _mm256_set1_ps(x)

BVXI_AVX2 static inline __m256 near_inverse_8(__m256 x)
{
    return _mm256_and_ps(_mm256_div_ps(NEAR_SET(1.0f), x), NEAR_ABOVE(x, NEAR_SET(NEAR_LEAST)));
}

BVXI_AVX2 static inline void near_put_3(float (*f)[BVXI_NEAR_WIDTH], __m256 x, __m256 y, __m256 z)
{
    _mm256_storeu_ps(f[0], x);
    _mm256_storeu_ps(f[1], y);
    _mm256_storeu_ps(f[2], z);
}

/* Rows become columns: number k of each goes to triangle k, eight numbers from number i on; the last
 * of 16 is where the triangle's number comes. */
BVXI_AVX2 static inline void near_turn_8(__m256 a, __m256 b, __m256 c, __m256 d, __m256 e, __m256 f, __m256 g, __m256 h, bvxi_near_frame *to,
                                          size_t i)
{
    __m256 const ab = _mm256_unpacklo_ps(a, b), AB = _mm256_unpackhi_ps(a, b), cd = _mm256_unpacklo_ps(c, d), CD = _mm256_unpackhi_ps(c, d);
    __m256 const ef = _mm256_unpacklo_ps(e, f), EF = _mm256_unpackhi_ps(e, f), gh = _mm256_unpacklo_ps(g, h), GH = _mm256_unpackhi_ps(g, h);
    __m256 const left[4] = {_mm256_shuffle_ps(ab, cd, 0x44), _mm256_shuffle_ps(ab, cd, 0xee), _mm256_shuffle_ps(AB, CD, 0x44), _mm256_shuffle_ps(AB, CD, 0xee)};
    __m256 const right[4] = {_mm256_shuffle_ps(ef, gh, 0x44), _mm256_shuffle_ps(ef, gh, 0xee), _mm256_shuffle_ps(EF, GH, 0x44), _mm256_shuffle_ps(EF, GH, 0xee)};
    for (int k = 0; k < 4; k++) {
        _mm256_storeu_ps((float *)(void *)(to + k) + i, _mm256_permute2f128_ps(left[k], right[k], 0x20));
        _mm256_storeu_ps((float *)(void *)(to + k + 4) + i, _mm256_permute2f128_ps(left[k], right[k], 0x31));
    }
}

BVXI_AVX2 static inline __m256 near_third(__m256 at_b, __m256 at_c, __m256 a, __m256 b, __m256 c)
{
    return NEAR_EITHER(at_c, c, NEAR_EITHER(at_b, b, a));
}

BVXI_AVX2 static void frame_near_lanes(const float corner[9][BVXI_NEAR_WIDTH], const float low[3], bvxi_near_leaf *leaf)
{
    __m256 const zero = _mm256_setzero_ps();
    __m256 const ax = _mm256_loadu_ps(corner[0]), ay = _mm256_loadu_ps(corner[1]), az = _mm256_loadu_ps(corner[2]);
    __m256 const bx = _mm256_loadu_ps(corner[3]), by = _mm256_loadu_ps(corner[4]), bz = _mm256_loadu_ps(corner[5]);
    __m256 const cx = _mm256_loadu_ps(corner[6]), cy = _mm256_loadu_ps(corner[7]), cz = _mm256_loadu_ps(corner[8]);
    __m256 const lx = bx - ax, ly = by - ay, lz = bz - az;
    __m256 const mx = cx - bx, my = cy - by, mz = cz - bz;
    __m256 const nx = ax - cx, ny = ay - cy, nz = az - cz;
    __m256 const l2 = NEAR_DOT(l, l), m2 = NEAR_DOT(m, m), n2 = NEAR_DOT(n, n);
    __m256 const at_b = NEAR_ABOVE(m2, l2), at_c = NEAR_ABOVE(n2, _mm256_max_ps(m2, l2));
    __m256 const ox = near_third(at_b, at_c, ax, bx, cx), oy = near_third(at_b, at_c, ay, by, cy), oz = near_third(at_b, at_c, az, bz, cz);
    __m256 const ux = near_third(at_b, at_c, lx, mx, nx), uy = near_third(at_b, at_c, ly, my, ny), uz = near_third(at_b, at_c, lz, mz, nz);
    __m256 const vx = zero - near_third(at_b, at_c, nx, lx, mx), vy = zero - near_third(at_b, at_c, ny, ly, my);
    __m256 const vz = zero - near_third(at_b, at_c, nz, lz, mz);
    __m256 const length = _mm256_sqrt_ps(NEAR_DOT(u, u)), inverse = near_inverse_8(length);
    __m256 const ex = NEAR_EITHER(NEAR_ABOVE(length, NEAR_SET(NEAR_LEAST)), ux * inverse, NEAR_SET(1.0f));
    __m256 const ey = uy * inverse, ez = uz * inverse;
    __m256 const along = NEAR_DOT(v, e);
    __m256 const wx = vx - along * ex, wy = vy - along * ey, wz = vz - along * ez;
    __m256 const again = NEAR_DOT(w, e);
    __m256 const px = wx - again * ex, py = wy - again * ey, pz = wz - again * ez;
    __m256 const h = _mm256_sqrt_ps(NEAR_DOT(p, p)), trace = length * NEAR_SET(NEAR_TRACE) + NEAR_SET(0x1p-60f);
    __m256 const steep = NEAR_ABOVE(ex * ex, NEAR_SET(0.5f));
    __m256 const gx = px - trace * _mm256_and_ps(steep, ez), gy = py + trace * _mm256_andnot_ps(steep, ez);
    __m256 const gz = pz + trace * NEAR_EITHER(steep, ex, zero - ey);
    __m256 const slant = NEAR_DOT(g, e);
    __m256 const hx = gx - slant * ex, hy = gy - slant * ey, hz = gz - slant * ez;
    __m256 const h1 = near_inverse_8(_mm256_sqrt_ps(NEAR_DOT(h, h)));
    __m256 const jx = hx * h1, jy = hy * h1, jz = hz * h1, lean = NEAR_DOT(j, e);
    __m256 const ix = jx - lean * ex, iy = jy - lean * ey, iz = jz - lean * ez;
    __m256 const foot = _mm256_min_ps(_mm256_max_ps(along, zero), length), rest = length - foot;
    near_turn_8(_mm256_broadcast_ss(&low[0]) + (ox + foot * ex), _mm256_broadcast_ss(&low[1]) + (oy + foot * ey),
                _mm256_broadcast_ss(&low[2]) + (oz + foot * ez), ex, ey, ez, ix, iy, leaf->frame, 0);
    near_turn_8(iz, ey * iz - ez * iy, ez * ix - ex * iz, ex * iy - ey * ix, foot, rest, h, zero, leaf->frame, 8);
    near_put_3(leaf->low, _mm256_min_ps(_mm256_min_ps(ax, bx), cx), _mm256_min_ps(_mm256_min_ps(ay, by), cy),
               _mm256_min_ps(_mm256_min_ps(az, bz), cz));
    near_put_3(leaf->high, _mm256_max_ps(_mm256_max_ps(ax, bx), cx), _mm256_max_ps(_mm256_max_ps(ay, by), cy),
               _mm256_max_ps(_mm256_max_ps(az, bz), cz));
}
#endif

void bvxi_near_make_leaf(const uint32_t number[BVXI_NEAR_WIDTH], const float corner[9][BVXI_NEAR_WIDTH], const float low[3],
                         int32_t fast, bvxi_near_leaf *leaf)
{
#if BVXI_HAVE_AVX2
    if (fast) frame_near_lanes(corner, low, leaf);
#endif
    if (!BVXI_HAVE_AVX2 || !fast)
        for (int k = 0; k < BVXI_NEAR_WIDTH; k++) frame_near_lane(corner, low, k, leaf);
    for (int k = 0; k < BVXI_NEAR_WIDTH; k++) leaf->frame[k].triangle = number[k];
}
