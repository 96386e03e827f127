/* shapes.h - meshes for golden values, from integers, sums, products, quotients and square roots only. */
#ifndef GOLDEN_SHAPES_H
#define GOLDEN_SHAPES_H

#include "bitvox_io.h"

#include <math.h>
#include <stdint.h>

#ifndef SHAPE_MAX
#define SHAPE_MAX 20000 /* vertices, triangles */
#endif

typedef struct shape {
    double v[SHAPE_MAX][3];
    uint32_t t[SHAPE_MAX][3];
    uint32_t vertices, triangles;
} shape;

static inline uint64_t shape_random(uint64_t *state)
{
    *state ^= *state << 13;
    *state ^= *state >> 7;
    *state ^= *state << 17;
    return *state;
}

static inline void shape_triangle(shape *s, uint32_t a, uint32_t b, uint32_t c)
{
    s->t[s->triangles][0] = a;
    s->t[s->triangles][1] = b;
    s->t[s->triangles][2] = c;
    s->triangles++;
}

/* Point number i of n around the unit circle: four quarters of the rational parametrization, no sine. */
static inline void shape_circle(int32_t i, int32_t n, double *x, double *y)
{
    int32_t const quarter = 4 * i / n;
    double const u = 4.0 * i / n - quarter, d = 1.0 + u * u, a = (1.0 - u * u) / d, b = 2.0 * u / d;
    *x = quarter == 0 ? a : quarter == 1 ? -b : quarter == 2 ? -a : b;
    *y = quarter == 0 ? b : quarter == 1 ? a : quarter == 2 ? -b : -a;
}

/* A torus whose tube swells and is dented by a fixed generator: closed, one handle. */
static inline void shape_torus(shape *s, int32_t n, int32_t m, double dent, uint64_t seed)
{
    s->vertices = s->triangles = 0;
    for (int32_t i = 0; i < n; i++) {
        double x, y;
        shape_circle(i, n, &x, &y);
        for (int32_t j = 0; j < m; j++) {
            double const wobble = 1.0 + dent * ((double)(shape_random(&seed) >> 40) / 16777216.0 - 0.5);
            double c, z;
            shape_circle(j, m, &c, &z);
            s->v[s->vertices][0] = x * (2.0 + 0.75 * c * wobble);
            s->v[s->vertices][1] = y * (2.0 + 0.75 * c * wobble);
            s->v[s->vertices][2] = 0.75 * z * wobble + 0.25 * x * y;
            s->vertices++;
        }
    }
    for (int32_t i = 0; i < n; i++) {
        for (int32_t j = 0; j < m; j++) {
            uint32_t const i1 = (uint32_t)((i + 1) % n * m);
            uint32_t const j1 = (uint32_t)((j + 1) % m);
            uint32_t const i0 = (uint32_t)(i * m);
            uint32_t const j0 = (uint32_t)j;
            shape_triangle(s, i0 + j0, i1 + j0, i1 + j1);
            shape_triangle(s, i0 + j0, i1 + j1, i0 + j1);
        }
    }
}

/* A ball of an octahedron's faces cut n times, pushed out to the unit sphere. */
static inline void shape_ball(shape *s, int32_t n)
{
    s->vertices = s->triangles = 0;
    for (int32_t face = 0; face < 8; face++) {
        double const sx = (face & 1) != 0 ? -1 : 1;
        double const sy = (face & 2) != 0 ? -1 : 1;
        double const sz = (face & 4) != 0 ? -1 : 1;
        int const flip = ((face & 1) + (face >> 1 & 1) + (face >> 2 & 1)) % 2;
        uint32_t const first = s->vertices;
        for (int32_t i = 0; i <= n; i++) {
            for (int32_t j = 0; j <= n - i; j++) {
                double const x = i, y = j, z = n - i - j, r = sqrt(x * x + y * y + z * z);
                s->v[s->vertices][0] = sx * (x / r);
                s->v[s->vertices][1] = sy * (y / r);
                s->v[s->vertices][2] = sz * (z / r);
                s->vertices++;
            }
        }
        for (int32_t i = 0, row = 0; i < n; row += n - i + 1, i++) {
            for (int32_t j = 0; j < n - i; j++) {
                uint32_t const a = first + (uint32_t)(row + j);
                uint32_t const b = a + (uint32_t)(n - i + 1);
                uint32_t const c = a + 1;
                uint32_t const d = b + 1;
                shape_triangle(s, a, flip ? c : b, flip ? b : c);
                if (j + 1 < n - i) shape_triangle(s, b, flip ? c : d, flip ? d : c);
            }
        }
    }
}

/* A soup: triangles of all sizes, many of them through each other. */
static inline void shape_soup(shape *s, int32_t n, uint64_t seed)
{
    s->vertices = s->triangles = 0;
    for (int32_t i = 0; i < n; i++) {
        double const size = i % 5 == 0 ? 2.0 : 0.25;
        double at[3];
        for (int32_t a = 0; a < 3; a++) at[a] = (double)(shape_random(&seed) >> 40) / 16777216.0;
        for (int32_t c = 0; c < 3; c++)
            for (int32_t a = 0; a < 3; a++)
                s->v[3 * i + c][a] = at[a] + size * ((double)(shape_random(&seed) >> 40) / 16777216.0 - 0.5);
        shape_triangle(s, (uint32_t)(3 * i), (uint32_t)(3 * i + 1), (uint32_t)(3 * i + 2));
        s->vertices += 3;
    }
}

static inline void shape_view(const shape *s, bvx_mesh_view *view)
{
    bvx_mesh_view const empty = {0};

    *view = empty;
    view->positions = s->v;
    view->indices = s->t;
    view->vertex_count = s->vertices;
    view->triangle_count = s->triangles;
    view->position_type = BVX_F64;
    view->index_type = BVX_U32;
}

#endif
