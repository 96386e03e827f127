/* lod_oracle.h - slow references for the LOD stage, straight from its contract: sample places, the extended
 * voxel function as a sum of tents, exact box fractions, first change along an edge, and every vertex in
 * canonical order.
 *
 * All whole numbers but the vertices' positions; grids small enough for 64 bits. Nothing of the library's
 * insides. */
#ifndef LOD_ORACLE_H
#define LOD_ORACLE_H

#include "bitvox_io.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct oracle {
    const bvx_grid *grid;
    int32_t method, edge_samples, threshold; /* threshold in 1/65536 */
    int64_t n[3], r[3];
    int32_t count[3];
    /* [Size: product of count + 2], a border of empty samples around */
    unsigned char *bit;
} oracle;

static inline int64_t oracle_set(const bvx_grid *g, int64_t x, int64_t y, int64_t z)
{
    if (x < 0 || y < 0 || z < 0 || x >= g->size[0] || y >= g->size[1] || z >= g->size[2]) return 0;
    return bvx_grid_get(g, (int32_t)x, (int32_t)y, (int32_t)z);
}

static inline int64_t oracle_floor(int64_t a, int64_t b) /* b > 0 */
{
    return a >= 0 ? a / b : -((b - 1 - a) / b);
}

/* The weight of voxel v along an axis for a place p, both from the first
 * voxel's centre in units of 1/d of a voxel. */
static inline int64_t oracle_tent(int64_t p, int64_t v, int64_t d)
{
    int64_t const away = p > v * d ? p - v * d : v * d - p;
    return away < d ? d - away : 0;
}

/* Extended voxel function at step s of `steps` from sample i along axis (s 0, steps 1: at the sample), less
 * the threshold, in units of 1 / (65536 * *unit). */
static inline int64_t oracle_excess(const oracle *o, const int32_t i[3], int axis, int64_t s, int64_t steps,
                                    int64_t *unit)
{
    int64_t p[3], d[3], sum = 0, total = 1;

    for (int a = 0; a < 3; a++) {
        int64_t const fine = a == axis ? steps : 1;
        d[a] = 2 * o->r[a] * fine;
        p[a] = ((2 * (int64_t)i[a] + 1) * o->n[a] - o->r[a]) * fine + (a == axis ? 2 * o->n[a] * s : 0);
        total *= d[a];
    }
    for (int64_t z = oracle_floor(p[2], d[2]) - 1; z <= oracle_floor(p[2], d[2]) + 2; z++)
        for (int64_t y = oracle_floor(p[1], d[1]) - 1; y <= oracle_floor(p[1], d[1]) + 2; y++)
            for (int64_t x = oracle_floor(p[0], d[0]) - 1; x <= oracle_floor(p[0], d[0]) + 2; x++)
                sum += oracle_set(o->grid, x, y, z) * oracle_tent(p[0], x, d[0]) *
                       oracle_tent(p[1], y, d[1]) * oracle_tent(p[2], z, d[2]);
    *unit = total;
    return sum * 65536 - o->threshold * total;
}

static inline int oracle_extended(const oracle *o, const int32_t i[3], int axis, int64_t s, int64_t steps)
{
    int64_t unit;
    return oracle_excess(o, i, axis, s, steps, &unit) > 0;
}

/* Length of voxel v inside box i along an axis, in 1/r of a voxel. */
static inline int64_t oracle_overlap(const oracle *o, int a, int64_t i, int64_t v)
{
    int64_t const low = i * o->n[a] > v * o->r[a] ? i * o->n[a] : v * o->r[a];
    int64_t const high = (i + 1) * o->n[a] < (v + 1) * o->r[a] ? (i + 1) * o->n[a] : (v + 1) * o->r[a];
    return high > low ? high - low : 0;
}

/* Covered volume of box i in units of 1 / (r r r); a whole box is n n n. */
static inline int64_t oracle_cover(const oracle *o, const int32_t i[3])
{
    int64_t sum = 0, low[3], high[3];

    for (int a = 0; a < 3; a++) {
        if (i[a] < 0 || i[a] >= o->count[a]) return 0;
        low[a] = i[a] * o->n[a] / o->r[a];
        high[a] = (i[a] + 1) * o->n[a] / o->r[a];
    }
    for (int64_t z = low[2]; z <= high[2]; z++)
        for (int64_t y = low[1]; y <= high[1]; y++) {
            int64_t const w = oracle_overlap(o, 1, i[1], y) * oracle_overlap(o, 2, i[2], z);
            for (int64_t x = low[0]; w != 0 && x <= high[0]; x++)
                if (oracle_set(o->grid, x, y, z)) sum += w * oracle_overlap(o, 0, i[0], x);
        }
    return sum;
}

static inline unsigned char *oracle_at(const oracle *o, const int32_t i[3])
{
    size_t const x = (size_t)(i[0] + 1), y = (size_t)(i[1] + 1), z = (size_t)(i[2] + 1);
    return &o->bit[(z * (size_t)(o->count[1] + 2) + y) * (size_t)(o->count[0] + 2) + x];
}

/* Every sample's bit; oracle_close gives them back. */
static inline void oracle_open(oracle *o, const bvx_grid *grid, const bvx_lod_options *options,
                               const int32_t n[3], const int32_t r[3])
{
    int32_t i[3];

    memset(o, 0, sizeof *o);
    o->grid = grid;
    o->method = options->sampling.method;
    o->edge_samples = options->sampling.edge_samples;
    o->threshold = (int32_t)floor(options->sampling.threshold * 65536.0 + 0.5);
    if (o->threshold < 1) o->threshold = 1;
    if (o->threshold > 65535) o->threshold = 65535;
    for (int a = 0; a < 3; a++) {
        o->n[a] = n[a];
        o->r[a] = r[a];
        /* the boxes reach over the whole grid */
        while (o->count[a] * o->n[a] < grid->size[a] * o->r[a]) o->count[a]++;
    }
    o->bit = calloc((size_t)(o->count[0] + 2) * (size_t)(o->count[1] + 2), (size_t)(o->count[2] + 2));
    if (o->bit == NULL) abort();
    for (i[2] = 0; i[2] < o->count[2]; i[2]++)
        for (i[1] = 0; i[1] < o->count[1]; i[1]++)
            for (i[0] = 0; i[0] < o->count[0]; i[0]++)
                *oracle_at(o, i) = o->method == BVX_LOD_EDGE_RATIO
                                       ? (unsigned char)oracle_extended(o, i, 0, 0, 1)
                                       : oracle_cover(o, i) * 65536 >
                                             o->threshold * o->n[0] * o->n[1] * o->n[2];
}

static inline void oracle_close(oracle *o)
{
    free(o->bit);
    memset(o, 0, sizeof *o);
}

/* Where the vertex sits between sample i and the next along axis. *slack: how far a position made from
 * fractions that are kept to 2^-32 may lie from it. */
static inline double oracle_ratio(const oracle *o, const int32_t i[3], int axis, double *slack)
{
    double t = 0.5;

    *slack = 1e-12;
    if (o->method == BVX_LOD_EDGE_RATIO) {
        int64_t const whole = (o->n[axis] + o->r[axis] - 1) / o->r[axis];
        int64_t const steps = o->edge_samples != 0 ? o->edge_samples : whole > 65536 ? 65536 : whole;
        int const start = oracle_extended(o, i, axis, 0, steps);
        for (int64_t s = steps; s >= 1; s--) /* the last one set is the first change */
            if (oracle_extended(o, i, axis, s, steps) != start) {
                int64_t unit;
                double const before = (double)oracle_excess(o, i, axis, s - 1, steps, &unit);
                double const after = (double)oracle_excess(o, i, axis, s, steps, &unit);
                t = ((double)(s - 1) + before / (before - after)) / (double)steps;
            }
    } else {
        int32_t const next[3] = {i[0] + (axis == 0), i[1] + (axis == 1), i[2] + (axis == 2)};
        double const total = (double)o->n[0] * (double)o->n[1] * (double)o->n[2];
        double const low = (double)oracle_cover(o, i) / total, high = (double)oracle_cover(o, next) / total;
        t = (o->threshold / 65536.0 - low) / (high - low);
        *slack = 1e-12 + ldexp(1.0, -31) / fabs(high - low);
    }
    return t < 1.0 / 128 ? 1.0 / 128 : t > 127.0 / 128 ? 127.0 / 128 : t;
}

/* World coordinate of a place given in samples from the first one's centre. */
static inline double oracle_place(const oracle *o, int axis, double samples)
{
    const bvx_grid *const g = o->grid;
    return g->lattice.origin[axis] +
           g->lattice.spacing[axis] *
               (g->low[axis] + (samples + 0.5) * (double)o->n[axis] / (double)o->r[axis]);
}

/* All vertices in order of (z, y, axis, x) of their edge, against a mesh of f64; the first difference, or -1
 * when all agree and none is missing. tolerance is in voxels. */
static inline int64_t oracle_compare(const oracle *o, const bvx_mesh *mesh, double tolerance)
{
    const double *const p = mesh->positions;
    int64_t v = 0;
    int32_t i[3];

    for (i[2] = -1; i[2] < o->count[2]; i[2]++)
        for (i[1] = -1; i[1] < o->count[1]; i[1]++)
            for (int axis = 0; axis < 3; axis++)
                for (i[0] = -1; i[0] < o->count[0]; i[0]++) {
                    int32_t const next[3] = {i[0] + (axis == 0), i[1] + (axis == 1), i[2] + (axis == 2)};
                    double slack, ratio;
                    if (*oracle_at(o, i) == *oracle_at(o, next)) continue;
                    if (v >= (int64_t)mesh->vertex_count) return v;
                    ratio = oracle_ratio(o, i, axis, &slack);
                    for (int a = 0; a < 3; a++) {
                        double const truth = oracle_place(o, a, i[a] + (a == axis ? ratio : 0.0));
                        double const width = (double)o->n[a] / (double)o->r[a];
                        double const allowed = (tolerance + (a == axis ? slack * width : 0.0)) *
                                               o->grid->lattice.spacing[a];
                        if (!(fabs(p[3 * v + a] - truth) <= allowed)) return v;
                    }
                    v++;
                }
    return v == (int64_t)mesh->vertex_count ? -1 : v;
}

#endif
