/* mesh_maker.h - meshes for tests: soups, needles, boxes, closed solids of several kinds, and ways to spoil
 * them.
 *
 * Positions are doubles in units of voxels, multiples of 1/steps where a maker has that argument, so that a
 * test can place them exactly on the fixed-point lattice. All randomness comes from the seed. */
#ifndef MESH_MAKER_H
#define MESH_MAKER_H

#include "bitvox_io.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct maker_mesh {
    double *p;   /* [Size: vertices * 3] */
    uint32_t *t; /* [Size: triangles * 3] */
    size_t vertices, triangles, vertex_room, triangle_room;
} maker_mesh;

/* ---- Randomness: xorshift64*, the same everywhere ---- */

static inline uint64_t maker_random(uint64_t *state)
{
    uint64_t x = *state != 0 ? *state : UINT64_C(0x9E3779B97F4A7C15);
    x ^= x >> 12;
    x ^= x << 25;
    x ^= x >> 27;
    *state = x;
    return x * UINT64_C(0x2545F4914F6CDD1D);
}

/* 0 .. n-1 */
static inline int32_t maker_below(uint64_t *state, int32_t n)
{
    return (int32_t)((maker_random(state) >> 33) % (uint64_t)n);
}

/* low .. high, a multiple of 1/steps */
static inline double maker_between(uint64_t *state, double low, double high, int32_t steps)
{
    double const n = (high - low) * steps;
    return low +
           (double)(int64_t)((double)(maker_random(state) >> 11) / 9007199254740992.0 * (n + 1)) / steps;
}

/* ---- A mesh and its parts ---- */

static inline void *maker_grow(void *memory, size_t size)
{
    void *const grown = realloc(memory, size);
    if (grown == NULL) {
        fprintf(stderr, "mesh_maker: no memory\n");
        exit(1);
    }
    return grown;
}

static inline uint32_t maker_vertex(maker_mesh *m, double x, double y, double z)
{
    if (m->vertices == m->vertex_room) {
        m->vertex_room = m->vertex_room * 2 + 64;
        m->p = maker_grow(m->p, m->vertex_room * 3 * sizeof *m->p);
    }
    m->p[3 * m->vertices] = x;
    m->p[3 * m->vertices + 1] = y;
    m->p[3 * m->vertices + 2] = z;
    return (uint32_t)m->vertices++;
}

static inline void maker_triangle(maker_mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    if (m->triangles == m->triangle_room) {
        m->triangle_room = m->triangle_room * 2 + 64;
        m->t = maker_grow(m->t, m->triangle_room * 3 * sizeof *m->t);
    }
    m->t[3 * m->triangles] = a;
    m->t[3 * m->triangles + 1] = b;
    m->t[3 * m->triangles + 2] = c;
    m->triangles++;
}

static inline void maker_clear(maker_mesh *m)
{
    m->vertices = m->triangles = 0;
}

static inline void maker_free(maker_mesh *m)
{
    free(m->p);
    free(m->t);
    memset(m, 0, sizeof *m);
}

static inline bvx_mesh_view maker_view(const maker_mesh *m)
{
    bvx_mesh_view v;

    memset(&v, 0, sizeof v);
    v.positions = m->p;
    v.indices = m->t;
    v.vertex_count = m->vertices;
    v.triangle_count = m->triangles;
    v.position_type = BVX_F64;
    v.index_type = BVX_U32;
    return v;
}

/* ---- Open things ---- */

/* Triangles that have nothing to do with each other. */
static inline void maker_soup(maker_mesh *m, uint64_t *seed, int32_t count, const double low[3],
                              const double high[3], int32_t steps)
{
    for (int32_t i = 0; i < count; i++) {
        uint32_t v[3];
        for (int32_t k = 0; k < 3; k++) {
            double const x = maker_between(seed, low[0], high[0], steps);
            double const y = maker_between(seed, low[1], high[1], steps);
            v[k] = maker_vertex(m, x, y, maker_between(seed, low[2], high[2], steps));
        }
        maker_triangle(m, v[0], v[1], v[2]);
    }
}

/* Long triangles a few steps wide. */
static inline void maker_needles(maker_mesh *m, uint64_t *seed, int32_t count, const double low[3],
                                 const double high[3], int32_t steps)
{
    for (int32_t i = 0; i < count; i++) {
        double a[3], b[3];
        uint32_t v[3];
        for (int32_t k = 0; k < 3; k++) {
            a[k] = maker_between(seed, low[k], high[k], steps);
            b[k] = maker_between(seed, low[k], high[k], steps);
        }
        v[0] = maker_vertex(m, a[0], a[1], a[2]);
        v[1] = maker_vertex(m, b[0], b[1], b[2]);
        for (int32_t k = 0; k < 3; k++) b[k] += (double)(maker_below(seed, 7) - 3) / steps;
        v[2] = maker_vertex(m, b[0], b[1], b[2]);
        if (maker_below(seed, 2)) maker_triangle(m, v[0], v[1], v[2]);
        else maker_triangle(m, v[2], v[1], v[0]);
    }
}

/* Points and segments written as triangles, and repeated corners. */
static inline void maker_degenerate(maker_mesh *m, uint64_t *seed, int32_t count, const double low[3],
                                    const double high[3], int32_t steps)
{
    for (int32_t i = 0; i < count; i++) {
        double a[3], b[3];
        uint32_t u, v, w;
        for (int32_t k = 0; k < 3; k++) {
            a[k] = maker_between(seed, low[k], high[k], steps);
            b[k] = maker_between(seed, low[k], high[k], steps);
        }
        u = maker_vertex(m, a[0], a[1], a[2]);
        v = maker_vertex(m, b[0], b[1], b[2]);
        switch (i % 5) {
        case 0: maker_triangle(m, u, u, u); break;
        case 1: maker_triangle(m, u, v, u); break;
        case 2: /* three points in line */
            w = maker_vertex(m, 2 * b[0] - a[0], 2 * b[1] - a[1], 2 * b[2] - a[2]);
            maker_triangle(m, u, v, w);
            break;
        case 3: /* no area along x, but an area in space */
            w = maker_vertex(m, b[0] + 1, b[1], b[2]);
            maker_triangle(m, u, v, w);
            break;
        default: /* another vertex at the same place */
            w = maker_vertex(m, a[0], a[1], a[2]);
            maker_triangle(m, u, v, w);
        }
    }
}

/* ---- Closed things, outwards ---- */

static inline void maker_quad(maker_mesh *m, uint32_t a, uint32_t b, uint32_t c, uint32_t d,
                              int other_diagonal)
{
    if (other_diagonal) {
        maker_triangle(m, a, b, d);
        maker_triangle(m, b, c, d);
    } else {
        maker_triangle(m, a, b, c);
        maker_triangle(m, a, c, d);
    }
}

static inline void maker_box(maker_mesh *m, const double low[3], const double high[3])
{
    uint32_t v[8];

    for (int32_t c = 0; c < 8; c++)
        v[c] = maker_vertex(m, c & 1 ? high[0] : low[0], c & 2 ? high[1] : low[1], c & 4 ? high[2] : low[2]);
    maker_quad(m, v[0], v[4], v[6], v[2], 0);
    maker_quad(m, v[1], v[3], v[7], v[5], 1);
    maker_quad(m, v[0], v[1], v[5], v[4], 0);
    maker_quad(m, v[2], v[6], v[7], v[3], 1);
    maker_quad(m, v[0], v[2], v[3], v[1], 0);
    maker_quad(m, v[4], v[5], v[7], v[6], 1);
}

static inline double maker_volume6(const double *a, const double *b, const double *c, const double *d)
{
    double const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double const v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    double const w[3] = {d[0] - a[0], d[1] - a[1], d[2] - a[2]};
    return u[0] * (v[1] * w[2] - v[2] * w[1]) + u[1] * (v[2] * w[0] - v[0] * w[2]) +
           u[2] * (v[0] * w[1] - v[1] * w[0]);
}

/* A tetrahedron over four vertices, outwards whatever their order. */
static inline void maker_tetrahedron(maker_mesh *m, uint32_t a, uint32_t b, uint32_t c, uint32_t d)
{
    const double *const p = m->p;

    if (maker_volume6(p + 3 * (size_t)a, p + 3 * (size_t)b, p + 3 * (size_t)c, p + 3 * (size_t)d) < 0) {
        uint32_t const e = c;
        c = d;
        d = e;
    }
    maker_triangle(m, a, c, b);
    maker_triangle(m, a, b, d);
    maker_triangle(m, b, c, d);
    maker_triangle(m, c, a, d);
}

/* A sphere of rings and segments; every vertex is moved along its ray, so the solid stays star-shaped about
 * its centre (but for the rounding to 1/steps). Cosines come from a parabola: roundness does not matter
 * here. */
static inline double maker_wave(double turn) /* about cos(2 pi turn), period 1 */
{
    double u = turn - (double)(int64_t)turn;
    u = u < 0.5 ? u : 1.0 - u;      /* 0 .. 0.5 */
    u = 1.0 - 4.0 * u;              /* 1 .. -1 */
    return u * (1.5 - 0.5 * u * u); /* smooth at both ends */
}

static inline double maker_step(double value, int32_t steps)
{
    double const v = value * steps + 0.5;
    int64_t const t = (int64_t)v;
    return (double)(t - (v < (double)t)) / steps;
}

static inline uint32_t maker_on_ray(maker_mesh *m, uint64_t *seed, const double centre[3],
                                    const double radius[3], double jitter, const double ray[3], int32_t steps)
{
    double const r = 1.0 + jitter * ((double)maker_below(seed, 2001) / 1000.0 - 1.0);
    double p[3];
    for (int32_t k = 0; k < 3; k++) p[k] = maker_step(centre[k] + radius[k] * ray[k] * r, steps);
    return maker_vertex(m, p[0], p[1], p[2]);
}

static inline void maker_star(maker_mesh *m, uint64_t *seed, const double centre[3], const double radius[3],
                              double jitter, int32_t rings, int32_t segments, int32_t steps)
{
    static const double up[3] = {0, 0, 1}, down[3] = {0, 0, -1};
    uint32_t const top = maker_on_ray(m, seed, centre, radius, jitter, up, steps);
    uint32_t const bottom = maker_on_ray(m, seed, centre, radius, jitter, down, steps);
    uint32_t const first = (uint32_t)m->vertices;

    for (int32_t r = 1; r < rings; r++)
        for (int32_t s = 0; s < segments; s++) {
            double const a = (double)r / (2 * rings), b = (double)s / segments;
            double const ring = maker_wave(a + 0.75);
            double const ray[3] = {ring * maker_wave(b), ring * maker_wave(b + 0.75), maker_wave(a)};
            maker_on_ray(m, seed, centre, radius, jitter, ray, steps);
        }
    for (int32_t s = 0; s < segments; s++) {
        uint32_t const a = first + (uint32_t)s, b = first + (uint32_t)((s + 1) % segments);
        uint32_t const last = (uint32_t)((rings - 2) * segments);
        maker_triangle(m, top, a, b);
        for (int32_t r = 0; r + 2 < rings; r++) {
            uint32_t const o = (uint32_t)(r * segments), n = (uint32_t)segments;
            maker_quad(m, a + o, a + o + n, b + o + n, b + o, maker_below(seed, 2));
        }
        maker_triangle(m, bottom, b + last, a + last);
    }
}

/* The boundary faces of a set of unit cubes: solid [Size: n[0] * n[1] * n[2]], x fastest; low corner at (x,
 * y, z).
 * Vertices are shared, diagonals at random. */
static inline int maker_solid_at(const uint8_t *solid, const int32_t n[3], int32_t x, int32_t y, int32_t z)
{
    if (x < 0 || y < 0 || z < 0 || x >= n[0] || y >= n[1] || z >= n[2]) return 0;
    return solid[((size_t)z * (size_t)n[1] + (size_t)y) * (size_t)n[0] + (size_t)x] != 0;
}

static inline void maker_cubes(maker_mesh *m, uint64_t *seed, const uint8_t *solid, const int32_t n[3],
                               const double at[3])
{
    uint32_t const first = (uint32_t)m->vertices;
    uint32_t const sx = 1, sy = (uint32_t)n[0] + 1, sz = sy * ((uint32_t)n[1] + 1);

    for (int32_t z = 0; z <= n[2]; z++)
        for (int32_t y = 0; y <= n[1]; y++)
            for (int32_t x = 0; x <= n[0]; x++) maker_vertex(m, at[0] + x, at[1] + y, at[2] + z);
    for (int32_t z = 0; z < n[2]; z++)
        for (int32_t y = 0; y < n[1]; y++)
            for (int32_t x = 0; x < n[0]; x++) {
                uint32_t const o = first + (uint32_t)x * sx + (uint32_t)y * sy + (uint32_t)z * sz;
                if (!maker_solid_at(solid, n, x, y, z)) continue;
                if (!maker_solid_at(solid, n, x - 1, y, z))
                    maker_quad(m, o, o + sz, o + sz + sy, o + sy, maker_below(seed, 2));
                if (!maker_solid_at(solid, n, x + 1, y, z))
                    maker_quad(m, o + sx, o + sx + sy, o + sx + sy + sz, o + sx + sz, maker_below(seed, 2));
                if (!maker_solid_at(solid, n, x, y - 1, z))
                    maker_quad(m, o, o + sx, o + sx + sz, o + sz, maker_below(seed, 2));
                if (!maker_solid_at(solid, n, x, y + 1, z))
                    maker_quad(m, o + sy, o + sy + sz, o + sy + sz + sx, o + sy + sx, maker_below(seed, 2));
                if (!maker_solid_at(solid, n, x, y, z - 1))
                    maker_quad(m, o, o + sy, o + sy + sx, o + sx, maker_below(seed, 2));
                if (!maker_solid_at(solid, n, x, y, z + 1))
                    maker_quad(m, o + sz, o + sz + sx, o + sz + sx + sy, o + sz + sy, maker_below(seed, 2));
            }
}

/* ---- Spoiling and rearranging ---- */

/* Turn triangles [first, last) round. */
static inline void maker_flip(maker_mesh *m, size_t first, size_t last)
{
    for (size_t i = first; i < last; i++) {
        uint32_t const a = m->t[3 * i];
        m->t[3 * i] = m->t[3 * i + 1];
        m->t[3 * i + 1] = a;
    }
}

static inline void maker_duplicate(maker_mesh *m, size_t i)
{
    uint32_t const c[3] = {m->t[3 * i], m->t[3 * i + 1], m->t[3 * i + 2]};
    maker_triangle(m, c[0], c[1], c[2]);
}

static inline void maker_remove(maker_mesh *m, size_t i)
{
    m->triangles--;
    memmove(m->t + 3 * i, m->t + 3 * m->triangles, 3 * sizeof *m->t);
}

static inline void maker_shift(maker_mesh *m, size_t first, double x, double y, double z)
{
    for (size_t i = first; i < m->vertices; i++) {
        m->p[3 * i] += x;
        m->p[3 * i + 1] += y;
        m->p[3 * i + 2] += z;
    }
}

/* Turned off the axes, so that edges lie anyhow between the centres of a lattice. */
static inline void maker_turn(maker_mesh *m)
{
    static const double c = 0.8, s = 0.6;

    for (size_t v = 0; v < m->vertices; v++) {
        double *const p = m->p + 3 * v;
        double const x = c * p[0] - s * p[1], y = s * p[0] + c * p[1], z = p[2];

        p[0] = x;
        p[1] = c * y - s * z;
        p[2] = s * y + c * z;
    }
}

/* Triangles in another order, each turned so that it begins at another corner; orientations stay. */
static inline void maker_shuffle_triangles(maker_mesh *m, uint64_t *seed)
{
    for (size_t i = m->triangles; i-- > 0;) {
        size_t const k = (size_t)maker_below(seed, (int32_t)i + 1);
        int32_t const turn = maker_below(seed, 3);
        uint32_t c[3];
        for (int32_t n = 0; n < 3; n++) c[n] = m->t[3 * k + (size_t)((n + turn) % 3)];
        memcpy(m->t + 3 * k, m->t + 3 * i, sizeof c);
        memcpy(m->t + 3 * i, c, sizeof c);
    }
}

/* Vertices in another order. */
static inline void maker_shuffle_vertices(maker_mesh *m, uint64_t *seed)
{
    uint32_t *const to = maker_grow(NULL, (m->vertices + 1) * sizeof *to);
    double *const p = maker_grow(NULL, (m->vertices + 1) * 3 * sizeof *p);

    for (size_t i = 0; i < m->vertices; i++) to[i] = (uint32_t)i;
    for (size_t i = m->vertices; i-- > 1;) {
        size_t const k = (size_t)maker_below(seed, (int32_t)i + 1);
        uint32_t const a = to[i];
        to[i] = to[k];
        to[k] = a;
    }
    for (size_t i = 0; i < m->vertices; i++) memcpy(p + 3 * (size_t)to[i], m->p + 3 * i, 3 * sizeof *p);
    for (size_t i = 0; i < 3 * m->triangles; i++) m->t[i] = to[m->t[i]];
    memcpy(m->p, p, m->vertices * 3 * sizeof *p);
    free(p);
    free(to);
}

#endif
