/* field_support.h - what the tests of distance fields share: contexts,
 * shapes whose distances are known, and a slow reference. */
#ifndef FIELD_SUPPORT_H
#define FIELD_SUPPORT_H

#include "nearest/closest.h"
#include "tools/mesh_maker.h"

#include "suite.h"

#include <math.h>

static maker_mesh mesh;
static uint64_t seed;

void setUp(void)
{
    suite_open(1);
    seed = UINT64_C(0x5eedf1e1d);
}

void tearDown(void)
{
    maker_free(&mesh);
    suite_close();
}

static inline bvx_lattice lattice_with(double ox, double oy, double oz, double sx, double sy, double sz,
                                       int32_t x, int32_t y, int32_t z)
{
    double const origin[3] = {ox, oy, oz}, spacing[3] = {sx, sy, sz};
    int32_t const dims[3] = {x, y, z};
    bvx_lattice l;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    return l;
}

static inline bvx_field_options field_options(double half_width, int32_t sign)
{
    bvx_field_options o = {.struct_size = sizeof o};
    o.half_width = half_width;
    o.sign = sign;
    o.features = 1;
    return o;
}

static inline bvx_field field_by(bvx_context *c, const bvx_lattice *l, const bvx_field_options *o)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_field f = {0};
    bvx_status const status = bvx_measure_field(c, &view, l, o, &f);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(c));
    return f;
}

static inline bvx_field field_of(const bvx_lattice *l, double half_width, int32_t sign)
{
    bvx_field_options const o = field_options(half_width, sign);
    return field_by(ctx, l, &o);
}

static inline void centre_of(const bvx_grid *g, int32_t x, int32_t y, int32_t z, double c[3])
{
    int32_t const at[3] = {x, y, z};
    for (int a = 0; a < 3; a++)
        c[a] = g->lattice.origin[a] + ((double)g->low[a] + (double)at[a] + 0.5) * g->lattice.spacing[a];
}

static inline double number_at(const bvx_field *f, const void *array, uint64_t i)
{
    return f->value_type == BVX_F32 ? (double)((const float *)array)[i] : ((const double *)array)[i];
}

static inline double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static inline void corners_of(size_t triangle, double t[3][3])
{
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++)
            t[k][a] = mesh.p[3 * (size_t)mesh.t[3 * triangle + (size_t)k] + (size_t)a];
}

/* Distance to the mesh, to every triangle in turn; *triangle the first at it. */
static inline double slow_distance(const double p[3], uint32_t *triangle)
{
    double best = HUGE_VAL, t[3][3], q[3];

    for (size_t i = 0; i < mesh.triangles; i++) {
        double d;
        corners_of(i, t);
        d = bvxi_closest_on_triangle(p, (const double(*)[3])t, q);
        if (d < best) {
            best = d;
            *triangle = (uint32_t)i;
        }
    }
    return sqrt(best);
}

static inline double distance_to(size_t triangle, const double p[3])
{
    double t[3][3], q[3];
    corners_of(triangle, t);
    return sqrt(bvxi_closest_on_triangle(p, (const double(*)[3])t, q));
}

/* ---- shapes ---- */

/* A tube of radius r around a circle of radius R in the plane z = centre[2], stretched along z. */
static inline void add_torus(const double centre[3], double R, double r, double stretch, int32_t around,
                             int32_t across)
{
    uint32_t const first = (uint32_t)mesh.vertices;

    for (int32_t i = 0; i < around; i++)
        for (int32_t j = 0; j < across; j++) {
            double const u = 6.283185307179586 * i / around, v = 6.283185307179586 * j / across;
            maker_vertex(&mesh, centre[0] + (R + r * cos(v)) * cos(u), centre[1] + (R + r * cos(v)) * sin(u),
                         centre[2] + stretch * r * sin(v));
        }
    for (int32_t i = 0; i < around; i++)
        for (int32_t j = 0; j < across; j++) {
            uint32_t const a = first + (uint32_t)(i * across + j);
            uint32_t const b = first + (uint32_t)((i + 1) % around * across + j);
            uint32_t const c = first + (uint32_t)((i + 1) % around * across + (j + 1) % across);
            uint32_t const d = first + (uint32_t)(i * across + (j + 1) % across);
            maker_quad(&mesh, a, b, c, d, (i + j) & 1);
        }
}

/* Rings of points at exact angles, so that the radius is known. */
static inline void add_sphere(const double centre[3], double r, int32_t rings, int32_t segments)
{
    uint32_t const top = maker_vertex(&mesh, centre[0], centre[1], centre[2] + r);
    uint32_t const bottom = maker_vertex(&mesh, centre[0], centre[1], centre[2] - r);
    uint32_t const first = (uint32_t)mesh.vertices;

    for (int32_t i = 1; i < rings; i++)
        for (int32_t s = 0; s < segments; s++) {
            double const a = 3.141592653589793 * i / rings, b = 6.283185307179586 * s / segments;
            maker_vertex(&mesh, centre[0] + r * sin(a) * cos(b), centre[1] + r * sin(a) * sin(b),
                         centre[2] + r * cos(a));
        }
    for (int32_t s = 0; s < segments; s++) {
        uint32_t const a = first + (uint32_t)s;
        uint32_t const b = first + (uint32_t)((s + 1) % segments);
        uint32_t const n = (uint32_t)segments;
        maker_triangle(&mesh, top, a, b);
        for (uint32_t i = 0; i + 2 < (uint32_t)rings; i++)
            maker_quad(&mesh, a + i * n, a + (i + 1) * n, b + (i + 1) * n, b + i * n, (int)(i & 1));
        maker_triangle(&mesh, bottom, b + n * (uint32_t)(rings - 2), a + n * (uint32_t)(rings - 2));
    }
}

/* An outline in x, y, counter-clockwise, its triangles by `cut` (three numbers each), drawn from z0 to z1. */
static inline void add_prism(const double (*outline)[2], uint32_t n, const uint32_t (*cut)[3], size_t cuts,
                             double z0, double z1)
{
    uint32_t const first = (uint32_t)mesh.vertices;

    for (uint32_t i = 0; i < n; i++) maker_vertex(&mesh, outline[i][0], outline[i][1], z0);
    for (uint32_t i = 0; i < n; i++) maker_vertex(&mesh, outline[i][0], outline[i][1], z1);
    for (size_t i = 0; i < cuts; i++) {
        maker_triangle(&mesh, first + cut[i][0], first + cut[i][2], first + cut[i][1]);
        maker_triangle(&mesh, first + n + cut[i][0], first + n + cut[i][1], first + n + cut[i][2]);
    }
    for (uint32_t i = 0; i < n; i++) {
        uint32_t const j = (i + 1) % n;
        maker_quad(&mesh, first + i, first + j, first + n + j, first + n + i, (int)(i & 1));
    }
}

/* Every triangle with three vertices of its own. */
static inline void take_apart(void)
{
    maker_mesh apart = {0};

    for (size_t i = 0; i < 3 * mesh.triangles; i += 3) {
        uint32_t v[3];
        for (size_t k = 0; k < 3; k++) {
            const double *const p = mesh.p + 3 * (size_t)mesh.t[i + k];
            v[k] = maker_vertex(&apart, p[0], p[1], p[2]);
        }
        maker_triangle(&apart, v[0], v[1], v[2]);
    }
    maker_free(&mesh);
    mesh = apart;
}

static inline int same_bits(const bvx_grid *a, const bvx_grid *b)
{
    size_t const words = (size_t)a->words_per_row * (size_t)a->size[1] * (size_t)a->size[2];
    return memcmp(a->size, b->size, sizeof a->size) == 0 && memcmp(a->words, b->words, words * 8) == 0;
}

static inline uint64_t set_in(const bvx_grid *g)
{
    uint64_t n;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, g, &n));
    return n;
}

#endif
