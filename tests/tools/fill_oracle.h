/* fill_oracle.h - parities along any axis, solid angles and floods, voxel by voxel, for tests of fills.
 *
 * A line along an axis runs through the centre moved by (e_x, e_y, e_z), e_x >> e_y >> e_z > 0. Each triangle
 * is asked by itself, in whole numbers (exact.h). */
#ifndef FILL_ORACLE_H
#define FILL_ORACLE_H

#include "tools/solid_oracle.h"

/* The axis and the two across it, in the order of their displacements. */
static const int fill_axes[3][3] = {{0, 1, 2}, {1, 0, 2}, {2, 0, 1}};

/* Does the line pass beside the triangle's box? Displacements are less than a step of the coordinates, which are whole. */
static inline int fill_passes(const int64_t *const p[3], const int64_t c[3], int axis)
{
    for (int k = 1; k < 3; k++) {
        int const a = fill_axes[axis][k];
        if ((p[0][a] < c[a] && p[1][a] < c[a] && p[2][a] < c[a]) ||
            (p[0][a] > c[a] && p[1][a] > c[a] && p[2][a] > c[a]))
            return 1;
    }
    return 0;
}

/* 1 when the line along an axis through the moved centre c crosses triangle
 * p before it; 2 when behind it; 0 not at all. */
static inline int fill_crosses(const int64_t *const p[3], const int64_t c[3], int axis)
{
    int64_t q[3][3], u[3], v[3], n[3];
    const int64_t *turned[3];
    int sign[4];

    if (fill_passes(p, c, axis)) return 0;
    for (int i = 0; i < 3; i++) {
        for (int a = 0; a < 3; a++) q[i][a] = p[i][fill_axes[axis][a]];
        turned[i] = q[i];
    }
    if (oracle_covers(turned, c[fill_axes[axis][1]], c[fill_axes[axis][2]]) == 0) return 0;
    for (int a = 0; a < 3; a++) {
        u[a] = p[1][a] - p[0][a];
        v[a] = p[2][a] - p[0][a];
    }
    for (int a = 0; a < 3; a++) n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
    if (n[axis] < 0)
        for (int a = 0; a < 3; a++) n[a] = -n[a];
    sign[0] = exact_sign_of_sum(c[0] - p[0][0], n[0], c[1] - p[0][1], n[1], c[2] - p[0][2], n[2]);
    for (int a = 0; a < 3; a++) sign[1 + a] = (n[a] > 0) - (n[a] < 0);
    return oracle_first_sign(sign, 4) > 0 ? 1 : 2;
}

/* Parity along an axis at a centre; *balanced 0 when the whole line has an odd number. */
static inline int fill_parity_at(const int64_t *q, const uint32_t *t, size_t count, const int64_t c[3],
                                 int axis, int *balanced)
{
    int before = 0, all = 0;

    for (size_t i = 0; i < count; i++) {
        const int64_t *p[3];
        int where;
        for (int k = 0; k < 3; k++) p[k] = q + 3 * (size_t)t[3 * i + (size_t)k];
        where = fill_crosses(p, c, axis);
        before += where == 1;
        all += where != 0;
    }
    *balanced = all % 2 == 0;
    return before % 2;
}

/* How far a centre is really moved, in fixed-point steps: little against a half voxel, much against rounding.
 * Angles are then right to about 1 / 1000 where corners lie half voxels apart. */
static const double fill_moved[3] = {1.0 / 64, 1.0 / 65536, 1.0 / 67108864}, fill_unmoved[3] = {0, 0, 0};

/* Solid angle of all triangles in turns at a centre, by libm; *clear 0 when
 * the centre lies in or near one of them. */
static inline double fill_turns_at(const int64_t *q, const uint32_t *t, size_t count, const int64_t c[3],
                                   const double moved[3], const double scale[3], int *clear)
{
    double turns = 0;

    *clear = 1;
    for (size_t i = 0; i < count; i++) {
        double v[3][3], l[3], det, den, dot[3];
        for (int k = 0; k < 3; k++) {
            for (int a = 0; a < 3; a++)
                v[k][a] = ((double)(q[3 * (size_t)t[3 * i + (size_t)k] + (size_t)a] - c[a]) - moved[a]) *
                          scale[a];
            l[k] = sqrt(v[k][0] * v[k][0] + v[k][1] * v[k][1] + v[k][2] * v[k][2]);
        }
        for (int k = 0; k < 3; k++) {
            const double *const x = v[k], *const y = v[(k + 1) % 3];
            dot[k] = x[0] * y[0] + x[1] * y[1] + x[2] * y[2];
        }
        det = v[0][0] * (v[1][1] * v[2][2] - v[1][2] * v[2][1]) +
              v[0][1] * (v[1][2] * v[2][0] - v[1][0] * v[2][2]) +
              v[0][2] * (v[1][0] * v[2][1] - v[1][1] * v[2][0]);
        den = l[0] * l[1] * l[2] + dot[0] * l[2] + dot[1] * l[0] + dot[2] * l[1];
        if (fabs(det) <= 1e-9 * l[0] * l[1] * l[2] && den <= 1e-6 * l[0] * l[1] * l[2]) *clear = 0;
        turns += atan2(det, den) / 6.283185307179586477;
    }
    return turns;
}

/* 1 when the triangles of every edge, corners at equal places taken as one, cancel out but for one: the solid
 * angle of all is then that of a mesh closed by a sheet. */
static inline int fill_runs_one_way(const int64_t *q, const uint32_t *t, size_t count)
{
    size_t const edges = 3 * count;

    for (size_t i = 0; i < edges; i++) {
        const int64_t *const a = q + 3 * (size_t)t[i];
        const int64_t *const b = q + 3 * (size_t)t[i % 3 == 2 ? i - 2 : i + 1];
        int all = 0, net = 0;
        for (size_t k = 0; k < edges; k++) {
            const int64_t *const c = q + 3 * (size_t)t[k];
            const int64_t *const d = q + 3 * (size_t)t[k % 3 == 2 ? k - 2 : k + 1];
            int const along = memcmp(a, c, 24) == 0 && memcmp(b, d, 24) == 0;
            int const against = memcmp(a, d, 24) == 0 && memcmp(b, c, 24) == 0;
            all += along || against;
            net += along - against;
        }
        if (net != (all % 2 == 0 ? 0 : net < 0 ? -1 : 1)) return 0;
    }
    return 1;
}

/* ---- Floods voxel by voxel ---- */

static inline size_t fill_place(const int32_t n[3], int32_t x, int32_t y, int32_t z)
{
    return ((size_t)z * (size_t)n[1] + (size_t)y) * (size_t)n[0] + (size_t)x;
}

/* Number the connected sets of voxels with open != 0 from 0, in the order
 * of their least voxels; -1 elsewhere. */
static inline int32_t fill_label(const uint8_t *open, const int32_t n[3], int connectivity, int32_t *label)
{
    size_t const count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    size_t *const queue = maker_grow(NULL, (count + 1) * sizeof *queue);
    int32_t labels = 0;

    for (size_t i = 0; i < count; i++) label[i] = -1;
    for (size_t i = 0; i < count; i++) {
        size_t head = 0, tail = 0;
        if (!open[i] || label[i] >= 0) continue;
        label[i] = labels;
        queue[tail++] = i;
        while (head < tail) {
            size_t const at = queue[head++];
            int32_t const x = (int32_t)(at % (size_t)n[0]), y = (int32_t)(at / (size_t)n[0] % (size_t)n[1]);
            int32_t const z = (int32_t)(at / (size_t)n[0] / (size_t)n[1]);
            for (int32_t d = 0; d < 27; d++) {
                int32_t const dx = d % 3 - 1;
                int32_t const dy = d / 3 % 3 - 1;
                int32_t const dz = d / 9 - 1;
                int32_t const far = dx * dx + dy * dy + dz * dz;
                int32_t const u = x + dx, v = y + dy, w = z + dz;
                size_t next;
                if (far == 0 || far > (connectivity == 6 ? 1 : connectivity == 18 ? 2 : 3)) continue;
                if (u < 0 || v < 0 || w < 0 || u >= n[0] || v >= n[1] || w >= n[2]) continue;
                next = fill_place(n, u, v, w);
                if (!open[next] || label[next] >= 0) continue;
                label[next] = labels;
                queue[tail++] = next;
            }
        }
        labels++;
    }
    free(queue);
    return labels;
}

/* Steps to any voxel around, by voxels with open != 0, from those that are
 * seeds (1 step) to each; INT32_MAX where none leads. */
static inline int32_t *fill_steps(const uint8_t *open, const uint8_t *seeds, const int32_t n[3])
{
    size_t const count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    int32_t *const steps = maker_grow(NULL, count * sizeof *steps);
    int changed = 1;

    for (size_t i = 0; i < count; i++) steps[i] = open[i] && seeds[i] ? 1 : INT32_MAX;
    while (changed) {
        changed = 0;
        for (size_t i = 0; i < count; i++) {
            int32_t const v[3] = {(int32_t)(i % (size_t)n[0]), (int32_t)(i / (size_t)n[0] % (size_t)n[1]),
                                  (int32_t)(i / (size_t)n[0] / (size_t)n[1])};
            for (int32_t d = 0; d < 27 && open[i]; d++) {
                int32_t const u[3] = {v[0] + d % 3 - 1, v[1] + d / 3 % 3 - 1, v[2] + d / 9 - 1};
                size_t from;
                if (u[0] < 0 || u[1] < 0 || u[2] < 0 || u[0] >= n[0] || u[1] >= n[1] || u[2] >= n[2])
                    continue;
                from = fill_place(n, u[0], u[1], u[2]);
                if (steps[from] == INT32_MAX || steps[from] + 1 >= steps[i]) continue;
                steps[i] = steps[from] + 1;
                changed = 1;
            }
        }
    }
    return steps;
}

static inline uint8_t *fill_bytes(const bvx_grid *g, int empty)
{
    uint8_t *const bytes = maker_grow(NULL, (size_t)g->size[0] * (size_t)g->size[1] * (size_t)g->size[2]);
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->size[0]; x++)
                bytes[fill_place(g->size, x, y, z)] = (uint8_t)(bvx_grid_get(g, x, y, z) != empty);
    return bytes;
}

#endif
