/* level_maker.h - closed, manifold, oriented meshes that do not cross themselves, for tests of levels of
 * detail.
 *
 * All lie within [1, 16), so that crossing_oracle.h takes any doubles of their levels at a scale of 2^52.
 * Where a shape is made of planes its corners are whole sixteenths or the like and all its vertices lie in
 * these planes exactly, so that the fewest triangles that have its corners are known. */
#ifndef LEVEL_MAKER_H
#define LEVEL_MAKER_H

#include "tools/mesh_maker.h"

typedef struct level_shape {
    const char *name;
    void (*make)(maker_mesh *m, uint64_t *seed);
    int64_t euler;
    uint64_t components;
    uint64_t fewest; /* triangles that have all corners of a shape of planes; 0: a round one */
} level_shape;

/* ---- Boxes of cubes ---- */

enum { LEVEL_CUBES = 24 };

/* Of the maker's cubes only the vertices that a triangle has. */
static inline void level_drop_unused(maker_mesh *m)
{
    uint32_t *const to = maker_grow(NULL, (m->vertices + 1) * sizeof *to);
    size_t kept = 0;

    for (size_t v = 0; v < m->vertices; v++) to[v] = 0;
    for (size_t i = 0; i < 3 * m->triangles; i++) to[m->t[i]] = 1;
    for (size_t v = 0; v < m->vertices; v++) {
        if (to[v] == 0) continue;
        memmove(m->p + 3 * kept, m->p + 3 * v, 3 * sizeof *m->p);
        to[v] = (uint32_t)kept++;
    }
    for (size_t i = 0; i < 3 * m->triangles; i++) m->t[i] = to[m->t[i]];
    m->vertices = kept;
    free(to);
}

typedef int level_inside(int32_t x, int32_t y, int32_t z);

/* The cubes of a box that are inside, from (4, 4, 4) on, each of one unit,
 * divided into part along every axis. */
static inline void level_cubes(maker_mesh *m, uint64_t *seed, int32_t x, int32_t y, int32_t z, int32_t part,
                               level_inside *inside)
{
    static const double at[3] = {0, 0, 0};
    static uint8_t solid[LEVEL_CUBES * LEVEL_CUBES * LEVEL_CUBES];
    int32_t const n[3] = {x * part, y * part, z * part};
    size_t const first = m->vertices;
    uint8_t *to = solid;

    for (int32_t k = 0; k < n[2]; k++)
        for (int32_t j = 0; j < n[1]; j++)
            for (int32_t i = 0; i < n[0]; i++) *to++ = (uint8_t)inside(i / part, j / part, k / part);
    maker_cubes(m, seed, solid, n, at);
    for (size_t i = 3 * first; i < 3 * m->vertices; i++) m->p[i] = 4 + m->p[i] / part;
    level_drop_unused(m);
}

static inline int level_all(int32_t x, int32_t y, int32_t z)
{
    (void)x;
    (void)y;
    (void)z;
    return 1;
}
static inline int level_in_l(int32_t x, int32_t y, int32_t z)
{
    (void)z;
    return x < 3 || y < 3;
}
static inline int level_in_frame(int32_t x, int32_t y, int32_t z)
{
    (void)z;
    return x < 2 || x > 3 || y < 2 || y > 3;
}
static inline int level_in_shell(int32_t x, int32_t y, int32_t z)
{
    return x == 0 || x == 5 || y == 0 || y == 5 || z == 0 || z == 5;
}
static inline int level_in_pair(int32_t x, int32_t y, int32_t z)
{
    (void)x;
    (void)y;
    return z != 1;
}

static inline void level_cube(maker_mesh *m, uint64_t *seed)
{
    level_cubes(m, seed, 8, 8, 8, 1, level_all);
}
static inline void level_l_shape(maker_mesh *m, uint64_t *seed)
{
    level_cubes(m, seed, 7, 6, 4, 2, level_in_l);
}
static inline void level_frame(maker_mesh *m, uint64_t *seed)
{
    level_cubes(m, seed, 6, 6, 2, 2, level_in_frame);
}
static inline void level_shells(maker_mesh *m, uint64_t *seed)
{
    level_cubes(m, seed, 6, 6, 6, 2, level_in_shell);
}

/* Layers of vertices get other heights. */
static inline void level_set_heights(maker_mesh *m, const double *height)
{
    for (size_t v = 0; v < m->vertices; v++) m->p[3 * v + 2] = height[(int)(m->p[3 * v + 2] - 4)];
}

/* Two plates a thousandth of a unit apart. */
static inline void level_plates(maker_mesh *m, uint64_t *seed)
{
    static const double height[4] = {6, 6.5, 6.5 + 0.0009765625, 7};
    level_cubes(m, seed, 10, 9, 3, 1, level_in_pair);
    level_set_heights(m, height);
}

/* A wave along x and a bend along y, the same for all heights: nothing gets nearer than it was, as z
 * tells. */
static inline void level_bend(maker_mesh *m)
{
    for (size_t v = 0; v < m->vertices; v++) {
        double const x = m->p[3 * v], y = m->p[3 * v + 1];
        m->p[3 * v + 2] += 1.25 * maker_wave(x / 7 + 0.1) + (y - 8) * (y - 8) / 16;
    }
}

static inline void level_bent_plates(maker_mesh *m, uint64_t *seed)
{
    static const double height[4] = {6, 6.5, 6.501, 7};
    level_cubes(m, seed, 11, 11, 3, 1, level_in_pair);
    for (size_t v = 0; v < m->vertices; v++) m->p[3 * v + 2] = height[(int)(m->p[3 * v + 2] - 4)];
    level_bend(m);
}

static inline void level_bent_sheet(maker_mesh *m, uint64_t *seed)
{
    static const double height[2] = {6, 6.0078125};
    level_cubes(m, seed, 11, 11, 1, 1, level_all);
    level_set_heights(m, height);
    level_bend(m);
}

static inline void level_thin_plate(maker_mesh *m, uint64_t *seed)
{
    static const double height[2] = {6, 6.0078125};
    level_cubes(m, seed, 11, 10, 1, 1, level_all);
    level_set_heights(m, height);
}

/* ---- Prisms: outlines that a point within sees, caps of fans around that point ---- */

enum { LEVEL_OUTLINE = 256 };

static inline void level_prism(maker_mesh *m, double (*outline)[2], int32_t points, const double centre[2],
                               double low, double high, int32_t layers)
{
    uint32_t const first = (uint32_t)m->vertices, n = (uint32_t)points;
    uint32_t bottom, top;

    for (int32_t k = 0; k <= layers; k++)
        for (int32_t i = 0; i < points; i++)
            maker_vertex(m, outline[i][0], outline[i][1], low + (high - low) * k / layers);
    bottom = maker_vertex(m, centre[0], centre[1], low);
    top = maker_vertex(m, centre[0], centre[1], high);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t const j = (i + 1) % n, last = first + (uint32_t)layers * n;
        for (uint32_t k = 0; k < (uint32_t)layers; k++) {
            uint32_t const at = first + k * n;
            maker_quad(m, at + i, at + j, at + n + j, at + n + i, (int)(i + k) % 2);
        }
        maker_triangle(m, bottom, first + j, first + i);
        maker_triangle(m, top, last + i, last + j);
    }
}

/* Sides of a polygon, each divided into part. */
static inline int32_t level_outline(double (*outline)[2], const double (*corner)[2], int32_t corners,
                                    int32_t part)
{
    for (int32_t i = 0; i < corners * part; i++)
        for (int k = 0; k < 2; k++) {
            double const a = corner[i / part][k], b = corner[(i / part + 1) % corners][k];
            outline[i][k] = a + (b - a) * (i % part) / part;
        }
    return corners * part;
}

static inline void level_octagon(maker_mesh *m, uint64_t *seed)
{
    static const double corner[8][2] = {{12, 7}, {12, 9}, {9, 12}, {7, 12}, {4, 9}, {4, 7}, {7, 4}, {9, 4}};
    static const double centre[2] = {8, 8};
    double outline[LEVEL_OUTLINE][2];
    int32_t const points = level_outline(outline, corner, 8, 8);
    (void)seed;
    level_prism(m, outline, points, centre, 5, 9, 8);
}

/* An edge of 10 degrees. */
static inline void level_wedge(maker_mesh *m, uint64_t *seed)
{
    static const double corner[3][2] = {{4, 7}, {12, 7}, {12, 8.40625}}, centre[2] = {10, 7.5};
    double outline[LEVEL_OUTLINE][2];
    int32_t const points = level_outline(outline, corner, 3, 16);
    (void)seed;
    level_prism(m, outline, points, centre, 5, 9, 8);
}

/* Point i of n around the unit circle: quarters of the rational parametrization. */
static inline void level_circle(int32_t i, int32_t n, double *x, double *y)
{
    int32_t const quarter = 4 * i / n;
    double const u = 4.0 * i / n - quarter, d = 1.0 + u * u, a = (1.0 - u * u) / d, b = 2.0 * u / d;
    *x = quarter == 0 ? a : quarter == 1 ? -b : quarter == 2 ? -a : b;
    *y = quarter == 0 ? b : quarter == 1 ? a : quarter == 2 ? -b : -a;
}

static inline void level_cylinder(maker_mesh *m, uint64_t *seed)
{
    static const double centre[2] = {8, 8};
    double outline[LEVEL_OUTLINE][2];

    (void)seed;
    for (int32_t i = 0; i < 100; i++) {
        level_circle(i, 100, &outline[i][0], &outline[i][1]);
        for (int k = 0; k < 2; k++) outline[i][k] = 8 + 4 * outline[i][k];
    }
    level_prism(m, outline, 100, centre, 4, 11, 12);
}

/* ---- Round ones ---- */

static inline void level_round(maker_mesh *m, uint64_t *seed, double radius, double jitter, int32_t rings)
{
    static const double centre[3] = {8, 8, 8};
    double const r[3] = {radius, radius, radius};
    maker_star(m, seed, centre, r, jitter, rings, rings + rings / 2, 65536);
}

static inline void level_sphere(maker_mesh *m, uint64_t *seed)
{
    level_round(m, seed, 5, 0, 24);
}
static inline void level_spikes(maker_mesh *m, uint64_t *seed)
{
    level_round(m, seed, 3.5, 0.75, 18);
}

/* Two spheres a hundredth of a unit apart, the inner one turned: the wall of a balloon. */
static inline void level_balloon(maker_mesh *m, uint64_t *seed)
{
    size_t first;
    level_round(m, seed, 5, 0, 20);
    first = m->triangles;
    level_round(m, seed, 4.9, 0, 20);
    maker_flip(m, first, m->triangles);
}

/* n times k vertices; the tube swells and shrinks at random by up to half of dent. */
static inline void level_tube(maker_mesh *m, uint64_t *seed, int32_t n, int32_t k, double dent)
{
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j < k; j++) {
            double const r = 1.5 * (1 + dent * (maker_below(seed, 2001) / 2000.0 - 0.5));
            double x, y, c, z;
            level_circle(i, n, &x, &y);
            level_circle(j, k, &c, &z);
            maker_vertex(m, 8 + x * (4 + r * c), 8 + y * (4 + r * c), 8 + r * z + 0.5 * x * y);
        }
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j < k; j++) {
            uint32_t const a = (uint32_t)(i * k);
            uint32_t const b = (uint32_t)((i + 1) % n * k);
            uint32_t const c = (uint32_t)j;
            uint32_t const d = (uint32_t)((j + 1) % k);
            maker_quad(m, a + c, b + c, b + d, a + d, 0);
        }
}

static inline void level_torus(maker_mesh *m, uint64_t *seed)
{
    level_tube(m, seed, 60, 28, 0);
}
static inline void level_dented_torus(maker_mesh *m, uint64_t *seed)
{
    level_tube(m, seed, 48, 24, 0.35);
}

static const level_shape level_shapes[] = {
    {"cube", level_cube, 2, 1, 12},
    {"L-shape", level_l_shape, 2, 1, 20},
    {"frame", level_frame, 0, 1, 32},
    {"shell of a cube", level_shells, 4, 2, 24},
    {"octagonal prism", level_octagon, 2, 1, 28},
    {"wedge of 10 degrees", level_wedge, 2, 1, 8},
    {"two plates", level_plates, 4, 2, 24},
    {"thin plate", level_thin_plate, 2, 1, 12},
    {"bent plates", level_bent_plates, 4, 2, 0},
    {"bent sheet", level_bent_sheet, 2, 1, 0},
    {"cylinder", level_cylinder, 2, 1, 0},
    {"sphere", level_sphere, 2, 1, 0},
    {"spikes", level_spikes, 2, 1, 0},
    {"balloon", level_balloon, 4, 2, 0},
    {"torus", level_torus, 0, 1, 0},
    {"dented torus", level_dented_torus, 0, 1, 0},
};

enum { LEVEL_SHAPES = sizeof level_shapes / sizeof *level_shapes };

#endif
