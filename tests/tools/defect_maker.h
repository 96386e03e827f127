/* defect_maker.h - good shapes, spoilt in one way or several, and between which bounds the volume of what
 * repairs them must lie.
 *
 * low and high say what the defect leaves open. The hole of a patch P: inside is then wrong only where P
 * fills more than half of all directions, which nowhere beyond its convex hull can be; the hull is kept in a
 * disc over its plane. A vertex moved by d beside a side of a triangle: the tetrahedron between. Triangles
 * torn apart or lying double by d: area times d. Shells: thickness times area and half a pipe along the rim.
 * The lattice takes its share besides, defect_share: marching cubes cut the edge of two planes that meet at
 * an angle t by a chord of at most sqrt(2) h, so by h^2 / 2 tan(t / 2) times its length at most; a fiftieth
 * of a voxel of the area is left for the rest. */
#ifndef DEFECT_MAKER_H
#define DEFECT_MAKER_H

#include "tools/mesh_maker.h"

#include <math.h>

#define DEFECT_PI 3.14159265358979323846

typedef struct defect_shape {
    maker_mesh mesh;
    double volume;     /* of the good shape */
    double low, high;  /* the right volume lies between */
    double area;       /* of all surfaces that are to be found */
    double edges;      /* sum of length times tan(t / 2) */
    double shell, rim; /* area and rim of sheets that become shells */
    /* 1: nothing else is there, so the shell's volume is no more than that and no less */
    int32_t only_shell;
    double voxel; /* about what will be used, for defects that are smaller */
} defect_shape;

/* ---- Good shapes ---- */

enum { DEFECT_BALL, DEFECT_RING, DEFECT_SHAPES };
static const char *const defect_shape_names[DEFECT_SHAPES] = {"ball", "ring"};

static inline const double *defect_corner(const maker_mesh *m, size_t t, int k)
{
    return m->p + 3 * (size_t)m->t[3 * t + (size_t)k];
}

/* Twice a triangle's area times its direction. */
static inline void defect_normal(const double *a, const double *b, const double *c, double n[3])
{
    for (int k = 0; k < 3; k++) {
        int const l = (k + 1) % 3, m = (k + 2) % 3;
        n[k] = (b[l] - a[l]) * (c[m] - a[m]) - (b[m] - a[m]) * (c[l] - a[l]);
    }
}

static inline double defect_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline double defect_length(const double a[3])
{
    return sqrt(defect_dot(a, a));
}

static inline double defect_distance(const double a[3], const double b[3])
{
    double const v[3] = {a[0] - b[0], a[1] - b[1], a[2] - b[2]};
    return defect_length(v);
}

/* Volume, area and edges of the triangles from first on, which are closed and share their vertices. */
static inline void defect_measure(const maker_mesh *m, size_t first, double *volume, double *area,
                                  double *edges)
{
    static const double origin[3] = {8, 8, 8};

    for (size_t t = first; t < m->triangles; t++) {
        const double *const a = defect_corner(m, t, 0);
        const double *const b = defect_corner(m, t, 1);
        const double *const c = defect_corner(m, t, 2);
        double const from[3] = {a[0] - origin[0], a[1] - origin[1], a[2] - origin[2]};
        double n[3], o[3];
        defect_normal(a, b, c, n);
        *volume += defect_dot(n, from) / 6;
        *area += defect_length(n) / 2;
        for (size_t u = t + 1; u < m->triangles; u++)
            for (size_t i = 0; i < 9; i++) {
                uint32_t const p = m->t[3 * t + i / 3], q = m->t[3 * t + (i / 3 + 1) % 3];
                double cross[3], along;
                if (m->t[3 * u + i % 3] != q || m->t[3 * u + (i + 1) % 3] != p) continue;
                defect_normal(defect_corner(m, u, 0), defect_corner(m, u, 1), defect_corner(m, u, 2), o);
                for (int k = 0; k < 3; k++)
                    cross[k] = n[(k + 1) % 3] * o[(k + 2) % 3] - n[(k + 2) % 3] * o[(k + 1) % 3];
                along = defect_length(n) * defect_length(o) + defect_dot(n, o);
                *edges += defect_distance(m->p + 3 * (size_t)p, m->p + 3 * (size_t)q) * defect_length(cross) /
                          along;
            }
    }
}

/* Of 6 x 6 x 3 cubes, with a hole of 2 x 2 through it. */
static inline void defect_add_ring(maker_mesh *m, uint64_t *seed, const double at[3])
{
    static const int32_t n[3] = {6, 6, 3};
    uint8_t solid[108];
    for (int i = 0; i < 108; i++) solid[i] = (uint8_t) !(i % 6 / 2 == 1 && i / 6 % 6 / 2 == 1);
    maker_cubes(m, seed, solid, n, at);
}

static inline void defect_add_ball(maker_mesh *m, uint64_t *seed, double radius)
{
    double const centre[3] = {8.02, 7.97, 8.05}, r[3] = {radius, radius, radius};
    maker_star(m, seed, centre, r, 0, 16, 24, 65536);
}

/* The shape fills about the middle 8 units of [0, 16]. */
static inline void defect_begin(defect_shape *s, int32_t shape, uint64_t *seed, int32_t resolution)
{
    static const double at[3] = {5.03125, 4.9375, 6.40625};
    maker_mesh const memory = s->mesh;

    memset(s, 0, sizeof *s);
    s->mesh = memory;
    maker_clear(&s->mesh);
    if (shape == DEFECT_BALL) defect_add_ball(&s->mesh, seed, 4);
    else defect_add_ring(&s->mesh, seed, at);
    defect_measure(&s->mesh, 0, &s->volume, &s->area, &s->edges);
    s->low = s->high = s->volume;
    s->voxel = (shape == DEFECT_BALL ? 8.0 : 6.0) / resolution;
}

static inline void defect_end(defect_shape *s)
{
    maker_free(&s->mesh);
}

static inline double defect_shell_volume(const defect_shape *s, double h)
{
    return 2 * h * s->shell + DEFECT_PI / 2 * h * h * s->rim;
}

static inline double defect_share(const defect_shape *s, double h)
{
    return h / 50 * (s->area + 2 * s->shell) + h * h / 2 * (s->edges + s->rim);
}

static inline double defect_low(const defect_shape *s, double h)
{
    return s->low + (s->only_shell ? defect_shell_volume(s, h) : 0) - defect_share(s, h);
}

static inline double defect_high(const defect_shape *s, double h)
{
    return s->high + defect_shell_volume(s, h) + defect_share(s, h);
}

/* ---- Defects ---- */

static inline double defect_jitter(uint64_t *seed, double most)
{
    return most * (maker_below(seed, 2001) - 1000) / 1000.0;
}

static inline size_t defect_any(const maker_mesh *m, uint64_t *seed)
{
    return (size_t)maker_below(seed, (int32_t)m->triangles);
}

/* At most what the hull of the triangles around a vertex has: a disc of
 * their reach, as high as they are over their mean plane. */
static inline double defect_patch(const maker_mesh *m, uint32_t v, double *reach)
{
    double sum[3] = {0, 0, 0}, low = 0, high = 0;

    *reach = 0;
    for (int pass = 0; pass < 2; pass++)
        for (size_t t = 0; t < m->triangles; t++) {
            const double *const p = m->p + 3 * (size_t)v;
            double n[3];
            if (m->t[3 * t] != v && m->t[3 * t + 1] != v && m->t[3 * t + 2] != v) continue;
            defect_normal(defect_corner(m, t, 0), defect_corner(m, t, 1), defect_corner(m, t, 2), n);
            for (int k = 0; k < 3; k++) {
                const double *const q = defect_corner(m, t, k);
                double const u[3] = {q[0] - p[0], q[1] - p[1], q[2] - p[2]}, high_at = defect_dot(u, sum);
                if (pass == 0) sum[k] += n[k];
                if (pass == 0) continue;
                if (defect_length(u) > *reach) *reach = defect_length(u);
                if (high_at < low) low = high_at;
                if (high_at > high) high = high_at;
            }
        }
    return defect_length(sum) > 0 ? DEFECT_PI * *reach * *reach * (high - low) / defect_length(sum) : 1e300;
}

/* Patches round vertices far from each other, and a few single triangles between. */
static inline void defect_holes(defect_shape *s, uint64_t *seed)
{
    maker_mesh *const m = &s->mesh;
    uint32_t taken[6];
    double reach[6];
    int32_t count = 0;

    for (int tries = 0; tries < 60 && count < 6; tries++) {
        uint32_t const v = m->t[3 * defect_any(m, seed)];
        double const most = defect_patch(m, v, &reach[count]);
        int free = most < 0.02 * s->volume;
        for (int32_t i = 0; i < count; i++)
            free &= defect_distance(m->p + 3 * (size_t)v, m->p + 3 * (size_t)taken[i]) >
                    1.5 * (reach[i] + reach[count]);
        if (!free) continue;
        taken[count++] = v;
        s->low -= most;
        s->high += most;
    }
    for (int32_t i = 0; i < count; i++)
        for (size_t t = m->triangles; t-- > 0;)
            if (m->t[3 * t] == taken[i] || m->t[3 * t + 1] == taken[i] || m->t[3 * t + 2] == taken[i])
                maker_remove(m, t);
}

static inline void defect_flips(defect_shape *s, uint64_t *seed)
{
    for (size_t t = 0; t < s->mesh.triangles; t++)
        if (maker_below(seed, 4) == 0) maker_flip(&s->mesh, t, t + 1);
}

static inline void defect_duplicates(defect_shape *s, uint64_t *seed)
{
    for (size_t t = 0, n = s->mesh.triangles; t < n; t++)
        for (int k = maker_below(seed, 3); k > 0; k--) maker_duplicate(&s->mesh, t);
}

/* The same, but some lie the other way round. */
static inline void defect_turned_duplicates(defect_shape *s, uint64_t *seed)
{
    size_t const n = s->mesh.triangles;
    defect_duplicates(s, seed);
    for (size_t t = n; t < s->mesh.triangles; t++)
        if (maker_below(seed, 2)) maker_flip(&s->mesh, t, t + 1);
}

/* Triangle t becomes two with a new vertex on its first side, off it by as much as off in every direction. */
static inline void defect_split(maker_mesh *m, size_t t, double part, const double off[3])
{
    uint32_t const a = m->t[3 * t], b = m->t[3 * t + 1], c = m->t[3 * t + 2];
    const double *const p = m->p + 3 * (size_t)a, *const q = m->p + 3 * (size_t)b;
    double const x = p[0] + (q[0] - p[0]) * part + off[0], y = p[1] + (q[1] - p[1]) * part + off[1];
    uint32_t const v = maker_vertex(m, x, y, p[2] + (q[2] - p[2]) * part + off[2]); /* moves p and q */
    m->t[3 * t + 1] = v;
    maker_triangle(m, v, b, c);
}

static inline void defect_junctions_off(defect_shape *s, uint64_t *seed, double most)
{
    for (int i = 0; i < 60; i++) {
        size_t const t = defect_any(&s->mesh, seed);
        double const off[3] = {defect_jitter(seed, most), defect_jitter(seed, most),
                               defect_jitter(seed, most)};
        double n[3];
        defect_normal(defect_corner(&s->mesh, t, 0), defect_corner(&s->mesh, t, 1),
                      defect_corner(&s->mesh, t, 2), n);
        s->low -= defect_length(n) * defect_length(off) / 6;
        s->high += defect_length(n) * defect_length(off) / 6;
        defect_split(&s->mesh, t, 0.25 + 0.125 * maker_below(seed, 5), off);
    }
}

/* A side of one triangle is two, of its neighbour one. */
static inline void defect_junctions(defect_shape *s, uint64_t *seed)
{
    defect_junctions_off(s, seed, 0);
}

static inline void defect_loose_junctions(defect_shape *s, uint64_t *seed)
{
    defect_junctions_off(s, seed, 0.3 * s->voxel);
}

static inline double defect_common(double a, double b)
{
    double const d = a < b ? b - a : a - b;
    return d < 1 ? 1 - d : 0;
}

/* The volume that two rings share, the second moved by (x, y, z): cube by cube. */
static inline double defect_common_rings(double x, double y, double z)
{
    double sum = 0;
    for (int i = 0; i < 108; i++)
        for (int k = 0; k < 108; k++) {
            if ((i % 6 / 2 == 1 && i / 6 % 6 / 2 == 1) || (k % 6 / 2 == 1 && k / 6 % 6 / 2 == 1)) continue;
            sum += defect_common(i % 6, k % 6 + x) * defect_common(i / 6 % 6, k / 6 % 6 + y) *
                   defect_common(i / 36, k / 36 + z);
        }
    return sum;
}

/* The volume that two round balls share whose centres lie d apart, and what
 * the makers' balls may differ from it. */
static inline double defect_common_balls(double radius, double d)
{
    return d < 2 * radius ? DEFECT_PI / 12 * (4 * radius + d) * (2 * radius - d) * (2 * radius - d) : 0;
}

/* Surfaces of the same way that lie a fraction of a voxel apart: the inner one draws the cut, so far at
 * most. */
static inline double defect_draw(double voxel, double apart)
{
    return apart < voxel ? apart : 0;
}

/* A second one in the same mesh, moved by some voxels or by a fraction of
 * one. They cross in creases: as many as they have edges. */
static inline void defect_copy(defect_shape *s, uint64_t *seed, double most)
{
    double const x = defect_jitter(seed, most), y = defect_jitter(seed, most), z = defect_jitter(seed, most);
    maker_mesh *const m = &s->mesh;
    size_t const triangles = m->triangles, vertices = m->vertices;
    int const ring = m->vertices == 7 * 7 * 4;
    double const round = 4 * DEFECT_PI / 3 * 64, off = ring ? 0 : s->volume / round;
    double const both = ring ? defect_common_rings(x, y, z)
                             : off * defect_common_balls(4, sqrt(x * x + y * y + z * z));

    for (size_t i = 0; i < vertices; i++)
        maker_vertex(m, m->p[3 * i] + x, m->p[3 * i + 1] + y, m->p[3 * i + 2] + z);
    for (size_t t = 0; t < triangles; t++)
        maker_triangle(m, m->t[3 * t] + (uint32_t)vertices, m->t[3 * t + 1] + (uint32_t)vertices,
                       m->t[3 * t + 2] + (uint32_t)vertices);
    s->low = s->high = 2 * s->volume - both;
    if (!ring) { /* not quite round: what they share lies between two lenses */
        double const shift = sqrt(x * x + y * y + z * z), thin = 0.06 * (shift < 4 ? shift / 4 : 1);
        s->low -= thin * both;
        s->high += thin * both;
    }
    s->low -= s->area * defect_draw(s->voxel, sqrt(x * x + y * y + z * z));
    s->area *= 2;
    s->edges = 3 * s->edges + (ring ? 0 : 8 * DEFECT_PI);
}

static inline void defect_self_union(defect_shape *s, uint64_t *seed)
{
    defect_copy(s, seed, 2.0);
}

static inline void defect_near_copy(defect_shape *s, uint64_t *seed)
{
    defect_copy(s, seed, 0.4 * s->voxel);
}

/* Each triangle on its own, its corners moved. */
static inline void defect_torn(defect_shape *s, uint64_t *seed)
{
    maker_mesh *const m = &s->mesh;
    double const most = 0.2 * s->voxel;

    for (size_t i = 0; i < 3 * m->triangles; i++) {
        double const p[3] = {m->p[3 * m->t[i]], m->p[3 * m->t[i] + 1], m->p[3 * m->t[i] + 2]};
        double const x = p[0] + defect_jitter(seed, most), y = p[1] + defect_jitter(seed, most);
        m->t[i] = maker_vertex(m, x, y, p[2] + defect_jitter(seed, most));
    }
    s->low -= s->area * most * sqrt(3);
    s->high += s->area * most * sqrt(3);
}

static inline int defect_is_right(const maker_mesh *m, size_t t, double at)
{
    return defect_corner(m, t, 0)[0] + defect_corner(m, t, 1)[0] + defect_corner(m, t, 2)[0] > 3 * at;
}

/* Triangle t gets vertices of its own, moved by (x, y, y). */
static inline void defect_loosen(maker_mesh *m, size_t t, double x, double y)
{
    for (size_t i = 3 * t; i < 3 * t + 3; i++) {
        const double *const p = m->p + 3 * (size_t)m->t[i];
        m->t[i] = maker_vertex(m, p[0] + x, p[1] + y, p[2] + y);
    }
}

/* The part right of x = at gets vertices of its own, moved along x. */
static inline void defect_move_right(defect_shape *s, double at, double by)
{
    maker_mesh *const m = &s->mesh;
    for (size_t t = 0; t < m->triangles; t++)
        if (defect_is_right(m, t, at)) defect_loosen(m, t, by, 0);
    s->low -= s->area * (by < 0 ? -by : by);
    s->high += s->area * (by < 0 ? -by : by);
}

/* Two parts with a gap between, each a sheet of triangles that share nothing but places. */
static inline void defect_gap(defect_shape *s, uint64_t *seed)
{
    (void)seed;
    defect_move_right(s, 8, 0.7 * s->voxel);
}

/* Two shells, open towards each other, one over the other. */
static inline void defect_overlap(defect_shape *s, uint64_t *seed)
{
    maker_mesh *const m = &s->mesh;
    size_t const n = m->triangles;
    double const by = 0.3 * s->voxel;

    (void)seed;
    for (size_t t = 0; t < n; t++) {
        int const second = defect_is_right(m, t, 7);
        if (!second && defect_is_right(m, t, 5.5)) maker_duplicate(m, t);
        if (second) defect_loosen(m, t, -by, by);
    }
    for (size_t t = n; t < m->triangles; t++) defect_loosen(m, t, -by, by);
    s->low -= s->area * by * sqrt(3);
    s->high += s->area * by * sqrt(3);
}

/* A square that goes through the shape and beyond. */
static inline void defect_sheet(defect_shape *s, uint64_t *seed)
{
    maker_mesh *const m = &s->mesh;
    double const tilt = defect_jitter(seed, 1);
    uint32_t const a = maker_vertex(m, 7, 6, 8 + tilt), b = maker_vertex(m, 13.5, 6, 8),
                   c = maker_vertex(m, 13.5, 10, 8), d = maker_vertex(m, 7, 10, 8 + tilt);

    maker_triangle(m, a, b, c);
    maker_triangle(m, a, c, d);
    s->shell = 4 * sqrt(6.5 * 6.5 + tilt * tilt);
    s->rim = 8 + s->shell / 2;
}

/* An open band of half a turn instead of the shape: no side of it is inside. */
static inline void defect_moebius(defect_shape *s, uint64_t *seed)
{
    enum { PARTS = 48 };
    maker_mesh *const m = &s->mesh;
    double n[3];
    (void)seed;
    maker_clear(m);
    for (int i = 0; i < PARTS; i++) {
        double const turn = (double)i / PARTS;
        double const c = maker_wave(turn);
        double const d = maker_wave(turn + 0.75);
        double const e = maker_wave(turn / 2);
        double const f = maker_wave(turn / 2 + 0.75);
        for (int side = -1; side <= 1; side += 2)
            maker_vertex(m, 8 + (4 + side * 1.5 * e) * c, 8 + (4 + side * 1.5 * e) * d, 8 + side * 1.5 * f);
    }
    for (uint32_t i = 0; i < PARTS; i++) {
        int const last = i == PARTS - 1;
        uint32_t const a = 2 * i, b = 2 * i + 1, c = last ? 1 : 2 * i + 2, d = last ? 0 : 2 * i + 3;
        maker_triangle(m, a, b, d);
        maker_triangle(m, a, d, c);
        s->rim += defect_distance(m->p + 3 * (size_t)a, m->p + 3 * (size_t)c) +
                  defect_distance(m->p + 3 * (size_t)b, m->p + 3 * (size_t)d);
    }
    for (size_t t = 0; t < m->triangles; t++) {
        defect_normal(defect_corner(m, t, 0), defect_corner(m, t, 1), defect_corner(m, t, 2), n);
        s->shell += defect_length(n) / 2;
    }
    s->low = s->high = s->volume = s->area = s->edges = 0;
    s->only_shell = 1;
}

/* Three balls in each other, each turned against the next; then all turned. */
static inline void defect_nest_turned(defect_shape *s, uint64_t *seed, int32_t turned)
{
    static const double radius[2] = {2.75, 1.5};
    maker_mesh *const m = &s->mesh;
    double volume = 0;

    maker_clear(m);
    s->area = s->edges = 0;
    defect_add_ball(m, seed, 4);
    defect_measure(m, 0, &volume, &s->area, &s->edges);
    s->volume = s->low = volume;
    for (int i = 0; i < 2; i++) {
        size_t const first = m->triangles;
        volume = 0;
        defect_add_ball(m, seed, radius[i]);
        defect_measure(m, first, &volume, &s->area, &s->edges);
        if (i == 0) maker_flip(m, first, m->triangles);
        s->low += i == 0 ? -volume : volume;
    }
    s->high = s->volume = s->low;
    if (turned) maker_flip(m, 0, m->triangles);
}

static inline void defect_nest(defect_shape *s, uint64_t *seed)
{
    defect_nest_turned(s, seed, 0);
}

static inline void defect_inside_out_nest(defect_shape *s, uint64_t *seed)
{
    defect_nest_turned(s, seed, 1);
}

static inline void defect_inside_out(defect_shape *s, uint64_t *seed)
{
    (void)seed;
    maker_flip(&s->mesh, 0, s->mesh.triangles);
}

/* A vertex a hair off a side makes three of a triangle, one of them a needle. */
static inline void defect_needles(defect_shape *s, uint64_t *seed)
{
    maker_mesh *const m = &s->mesh;

    for (int i = 0; i < 100; i++) {
        size_t const t = defect_any(m, seed);
        uint32_t const a = m->t[3 * t], b = m->t[3 * t + 1], c = m->t[3 * t + 2];
        double q[3];
        uint32_t v;
        for (int k = 0; k < 3; k++)
            q[k] = 0.5 * (m->p[3 * (size_t)a + (size_t)k] + m->p[3 * (size_t)b + (size_t)k]) * (1 - 1e-7) +
                   m->p[3 * (size_t)c + (size_t)k] * 1e-7;
        v = maker_vertex(m, q[0], q[1], q[2]);
        m->t[3 * t + 2] = v;
        maker_triangle(m, b, c, v);
        maker_triangle(m, c, a, v);
    }
}

/* Triangles that are a point or a segment: of new vertices, also at one place, and of the shape's. */
static inline void defect_degenerate(defect_shape *s, uint64_t *seed)
{
    maker_mesh *const m = &s->mesh;

    for (int i = 0; i < 40; i++) {
        double const x = maker_between(seed, 5.5, 10, 1024);
        double const y = maker_between(seed, 5.5, 10, 1024);
        double const step = maker_below(seed, 4) / 16.0;
        size_t const t = defect_any(m, seed);
        uint32_t const u = maker_vertex(m, x, y, 7), v = maker_vertex(m, x + step, y + step, 7 + step);
        maker_triangle(m, u, maker_vertex(m, x + 2 * step, y + 2 * step, 7 + 2 * step), v);
        maker_triangle(m, m->t[3 * t], m->t[3 * t + 1], maker_below(seed, 2) ? m->t[3 * t] : u);
        if (m->t[3 * m->triangles - 1] == u) m->t[3 * m->triangles - 2] = m->t[3 * t];
    }
}

static inline void defect_holes_and_flips(defect_shape *s, uint64_t *seed)
{
    defect_holes(s, seed);
    defect_flips(s, seed);
}

static inline void defect_all_small(defect_shape *s, uint64_t *seed)
{
    defect_holes(s, seed);
    defect_duplicates(s, seed);
    defect_needles(s, seed);
    defect_degenerate(s, seed);
    defect_loose_junctions(s, seed);
    defect_sheet(s, seed);
}

typedef struct defect_kind {
    const char *name;
    void (*make)(defect_shape *, uint64_t *);
    int32_t any_shape; /* 0: makes its own */
} defect_kind;

static const defect_kind defect_kinds[] = {
    {"holes", defect_holes, 1},
    {"flipped", defect_flips, 1},
    {"doubled", defect_duplicates, 1},
    {"doubled, turned", defect_turned_duplicates, 1},
    {"T-junctions", defect_junctions, 1},
    {"T-junctions 0.3 voxels off", defect_loose_junctions, 1},
    {"two overlapping copies", defect_self_union, 1},
    {"a copy 0.4 voxels off", defect_near_copy, 1},
    {"triangles torn apart by 0.2 voxels", defect_torn, 1},
    {"a gap of 0.7 voxels", defect_gap, 1},
    {"shells that overlap in part", defect_overlap, 1},
    {"inside out", defect_inside_out, 1},
    {"nested, each inside out", defect_nest, 0},
    {"nested, all turned", defect_inside_out_nest, 0},
    {"needles", defect_needles, 1},
    {"triangles without area", defect_degenerate, 1},
    {"a sheet through it", defect_sheet, 1},
    {"Moebius strip", defect_moebius, 0},
    {"holes and flipped", defect_holes_and_flips, 1},
    {"holes, doubled, T-junctions, needles, sheet", defect_all_small, 1},
};

enum { DEFECT_KINDS = sizeof defect_kinds / sizeof *defect_kinds };

#endif
