/* touch_oracle.h - which voxels a triangle touches, voxel by voxel and from the definitions only, for tests.
 *
 * Coordinates are whole numbers of 2^-F voxels, all sums are exact (exact.h). Conservative: the thirteen
 * separating axes of box and triangle. Thin: two ends of a segment lie on different sides of the plane and
 * the segment's line passes inside the three edges, everything moved by (e_x, e_y, e_z), e_x >> e_y >> e_z >
 * 0, by the sign of the first coefficient that is not zero. Sampled: all points of the subdivision, one by
 * one. */
#ifndef TOUCH_ORACLE_H
#define TOUCH_ORACLE_H

#include "bitvox_io.h"
#include "tools/exact.h"
#include "tools/solid_oracle.h"

typedef struct touch_oracle {
    int64_t p[3][3]; /* corners */
    int32_t f;
} touch_oracle;

static inline int64_t touch_low_corner(int64_t index, int32_t f)
{
    return index * (INT64_C(1) << f);
}

static inline void touch_cross(const int64_t u[3], const int64_t v[3], int64_t n[3])
{
    for (int a = 0; a < 3; a++) n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
}

static inline void touch_normal(const touch_oracle *o, int64_t n[3])
{
    int64_t u[3], v[3];
    for (int a = 0; a < 3; a++) {
        u[a] = o->p[1][a] - o->p[0][a];
        v[a] = o->p[2][a] - o->p[0][a];
    }
    touch_cross(u, v, n);
}

/* ---- conservative ---- */

/* 1 when all corners lie beyond the box's far side along the axis n, or all before its near side. */
static inline int touch_separated(const touch_oracle *o, const int64_t n[3], const int64_t low[3],
                                  int64_t side)
{
    int beyond = 0, before = 0;
    int64_t far[3], near[3];

    for (int a = 0; a < 3; a++) {
        far[a] = low[a] + (n[a] > 0 ? side : 0);
        near[a] = low[a] + (n[a] > 0 ? 0 : side);
    }
    for (int i = 0; i < 3; i++) {
        const int64_t *const p = o->p[i];
        beyond += exact_sign_of_sum(n[0], p[0] - far[0], n[1], p[1] - far[1], n[2], p[2] - far[2]) > 0;
        before += exact_sign_of_sum(n[0], p[0] - near[0], n[1], p[1] - near[1], n[2], p[2] - near[2]) < 0;
    }
    return beyond == 3 || before == 3;
}

static inline int touch_meets_box(const touch_oracle *o, const int64_t voxel[3])
{
    int64_t const side = INT64_C(1) << o->f;
    int64_t const low[3] = {touch_low_corner(voxel[0], o->f), touch_low_corner(voxel[1], o->f),
                            touch_low_corner(voxel[2], o->f)};
    int64_t n[3];

    for (int a = 0; a < 3; a++) {
        int64_t const unit[3] = {a == 0, a == 1, a == 2};
        if (touch_separated(o, unit, low, side)) return 0;
    }
    for (int a = 0; a < 3; a++)
        for (int i = 0; i < 3; i++) {
            int64_t const unit[3] = {a == 0, a == 1, a == 2};
            int64_t edge[3];
            for (int b = 0; b < 3; b++) edge[b] = o->p[(i + 1) % 3][b] - o->p[i][b];
            touch_cross(edge, unit, n);
            if (touch_separated(o, n, low, side)) return 0;
        }
    touch_normal(o, n);
    return !touch_separated(o, n, low, side);
}

/* ---- thin ---- */

/* Which side of the plane the moved point lies on. */
static inline int touch_side_of_plane(const touch_oracle *o, const int64_t point[3])
{
    int64_t n[3];
    int sign[4];
    touch_normal(o, n);
    sign[0] = exact_sign_of_sum(n[0], point[0] - o->p[0][0], n[1], point[1] - o->p[0][1], n[2],
                                point[2] - o->p[0][2]);
    for (int a = 0; a < 3; a++) sign[1 + a] = (n[a] > 0) - (n[a] < 0);
    return oracle_first_sign(sign, 4);
}

/* Which side of an edge the moved point lies on, seen along an axis; u comes before v in the order x, y, z,
 * so e_u >> e_v: du (point_v + e_v - p_v) - dv (point_u + e_u - p_u). */
static inline int touch_side_of_edge(const touch_oracle *o, int i, int u, int v, const int64_t point[3])
{
    const int64_t *const p = o->p[i], *const q = o->p[(i + 1) % 3];
    int64_t const du = q[u] - p[u], dv = q[v] - p[v];
    int sign[3];
    sign[0] = exact_sign_of_sum(du, point[v] - p[v], -dv, point[u] - p[u], 0, 0);
    sign[1] = (dv < 0) - (dv > 0);
    sign[2] = (du > 0) - (du < 0);
    return oracle_first_sign(sign, 3);
}

static inline int touch_meets_cross(const touch_oracle *o, const int64_t voxel[3])
{
    for (int axis = 0; axis < 3; axis++) {
        int const u = axis == 0 ? 1 : 0, v = axis == 2 ? 1 : 2;
        int64_t ends[2][3];
        int side[3];
        for (int a = 0; a < 3; a++) ends[0][a] = ends[1][a] = oracle_centre(voxel[a], o->f);
        ends[0][axis] = touch_low_corner(voxel[axis], o->f);
        ends[1][axis] = touch_low_corner(voxel[axis] + 1, o->f);
        for (int i = 0; i < 3; i++) side[i] = touch_side_of_edge(o, i, u, v, ends[0]);
        if (side[0] == 0 || side[0] != side[1] || side[1] != side[2]) continue;
        if (touch_side_of_plane(o, ends[0]) * touch_side_of_plane(o, ends[1]) < 0) return 1;
    }
    return 0;
}

/* ---- sampled ---- */

/* The least k with k * 2^F above the longest edge. */
static inline int64_t touch_parts(const touch_oracle *o)
{
    uint64_t longest = 0, k = 1;

    for (int i = 0; i < 3; i++) {
        uint64_t sum = 0;
        for (int a = 0; a < 3; a++) {
            int64_t const d = o->p[(i + 1) % 3][a] - o->p[i][a];
            sum += (uint64_t)(d * d);
        }
        if (sum > longest) longest = sum;
    }
    while (k * k <= longest >> 2 * o->f) k++; /* k^2 4^F > l^2 as k^2 is whole */
    return (int64_t)k;
}

static inline int64_t touch_floor(int64_t a, int64_t b)
{
    return a >= 0 ? a / b : -((-a + b - 1) / b);
}

/* ---- marks ---- */

/* Mark, in bytes of a window (x fastest), the voxels that a triangle
 * touches. Voxels farther from its box than one are not looked at. */
static inline void touch_mark(const touch_oracle *o, int32_t mode, const bvx_window *w, uint8_t *bytes)
{
    int64_t from[3], to[3];

    if (mode == BVX_SURFACE_SAMPLED) {
        int64_t const k = touch_parts(o), part = touch_low_corner(k, o->f);
        for (int64_t i = 0; i <= k; i++)
            for (int64_t j = 0; i + j <= k; j++) {
                int64_t at[3];
                int inside = 1;
                for (int a = 0; a < 3; a++) {
                    int64_t const sum = o->p[0][a] * k + (o->p[1][a] - o->p[0][a]) * i +
                                        (o->p[2][a] - o->p[0][a]) * j;
                    at[a] = touch_floor(sum, part) - w->low[a];
                    inside &= at[a] >= 0 && at[a] < w->size[a];
                }
                if (inside) bytes[(size_t)((at[2] * w->size[1] + at[1]) * w->size[0] + at[0])] = 1;
            }
        return;
    }
    for (int a = 0; a < 3; a++) {
        int64_t low = o->p[0][a], high = o->p[0][a];
        for (int i = 1; i < 3; i++) {
            low = o->p[i][a] < low ? o->p[i][a] : low;
            high = o->p[i][a] > high ? o->p[i][a] : high;
        }
        from[a] = touch_floor(low, INT64_C(1) << o->f) - 2 - w->low[a];
        to[a] = touch_floor(high, INT64_C(1) << o->f) + 2 - w->low[a];
        if (from[a] < 0) from[a] = 0;
        if (to[a] > w->size[a] - 1) to[a] = w->size[a] - 1;
    }
    for (int64_t z = from[2]; z <= to[2]; z++)
        for (int64_t y = from[1]; y <= to[1]; y++)
            for (int64_t x = from[0]; x <= to[0]; x++) {
                int64_t const voxel[3] = {x + w->low[0], y + w->low[1], z + w->low[2]};
                uint8_t *const byte = &bytes[(size_t)((z * w->size[1] + y) * w->size[0] + x)];
                if (mode == BVX_SURFACE_CONSERVATIVE ? touch_meets_box(o, voxel)
                                                     : touch_meets_cross(o, voxel))
                    *byte = 1;
            }
}

#endif
