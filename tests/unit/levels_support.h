/* levels_support.h - what the tests of levels of detail share: a context,
 * calls with targets, and what every level must keep. */
#ifndef LEVELS_SUPPORT_H
#define LEVELS_SUPPORT_H

#include "tools/crossing_oracle.h"
#include "tools/level_maker.h"

#include "suite.h"

#include <math.h>

enum { LEVELS_MOST = 6 };

static maker_mesh mesh;
static uint64_t seed;
static bvx_mesh level[LEVELS_MOST];
static bvx_level_report report[LEVELS_MOST];
static char where[300];

void setUp(void)
{
    suite_open(1);
    seed = UINT64_C(0x5eedc0de);
    memset(level, 0, sizeof level);
    maker_clear(&mesh);
}

void tearDown(void)
{
    for (int i = LEVELS_MOST; i-- > 0;) bvx_mesh_free(ctx, &level[i]);
    maker_free(&mesh);
    suite_close();
}

static inline void drop_levels(void)
{
    for (int i = LEVELS_MOST; i-- > 0;) bvx_mesh_free(ctx, &level[i]);
    memset(level, 0, sizeof level);
    memset(report, 0, sizeof report);
}

static inline void make_shape(const level_shape *s)
{
    maker_clear(&mesh);
    s->make(&mesh, &seed);
}

/* The shape of that name. */
static inline const level_shape *shape_named(const char *name)
{
    for (int i = 0; i < LEVEL_SHAPES; i++)
        if (strcmp(level_shapes[i].name, name) == 0) return &level_shapes[i];
    TEST_FAIL_MESSAGE(name);
    return NULL;
}

static inline bvx_certificate certificate_of(const bvx_mesh *m)
{
    bvx_mesh_view view;
    bvx_certificate c;
    bvx_mesh_view_of(m, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
    return c;
}

/* Closed, manifold, oriented, nothing remaining, and as many handles and pieces as were given. */
static inline void assert_whole(const bvx_mesh *m, int64_t euler, uint64_t components)
{
    bvx_certificate const c = certificate_of(m);
    TEST_ASSERT_TRUE_MESSAGE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, c.degenerate + c.duplicates + c.collapsed + c.unused_vertices, where);
    TEST_ASSERT_EQUAL_INT64_MESSAGE(euler, c.euler, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(components, c.components, where);
}

/* By all pairs in whole numbers, and by the library's own count. */
static inline void assert_no_crossings(const bvx_mesh *m)
{
    const char *wrong;
    bvx_mesh_view view;
    uint64_t count = 0, crossings = crossing_count(m, 4503599627370496.0, &wrong); /* 2^52 */

    TEST_ASSERT_NULL_MESSAGE(wrong, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, crossings, where);
    bvx_mesh_view_of(m, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &view, &count, NULL, 0));
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, count, where);
}

/* What the report says against the level itself. */
static inline void assert_report(const bvx_level_report *r, const bvx_mesh *m)
{
    bvx_certificate const c = certificate_of(m);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(m->vertex_count, r->vertices, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(m->triangle_count, r->triangles, where);
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(&c, &r->certificate, sizeof c, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, r->crossings, where);
    TEST_ASSERT_TRUE_MESSAGE(r->least_angle > 0 && r->least_angle <= 60.0000001, where);
}

static inline double position_of(const bvx_mesh *m, uint64_t i)
{
    return m->position_type == BVX_F64 ? ((const double *)m->positions)[i]
                                       : (double)((const float *)m->positions)[i];
}

static inline void assert_same_bytes(const bvx_mesh *a, const bvx_mesh *b)
{
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(a->vertex_count, b->vertex_count, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(a->triangle_count, b->triangle_count, where);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(a->position_type, b->position_type, where);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, memcmp(a->triangles, b->triangles, (size_t)a->triangle_count * 12),
                                  where);
    TEST_ASSERT_EQUAL_INT_MESSAGE(
        0,
        memcmp(a->positions, b->positions, (size_t)a->vertex_count * (a->position_type == BVX_F64 ? 24 : 12)),
        where);
}

static inline double diagonal_of(const maker_mesh *m)
{
    double sum = 0;

    for (size_t a = 0; a < 3; a++) {
        double low = m->p[a], high = m->p[a];
        for (size_t v = 1; v < m->vertices; v++) {
            if (m->p[3 * v + a] < low) low = m->p[3 * v + a];
            if (m->p[3 * v + a] > high) high = m->p[3 * v + a];
        }
        sum += (high - low) * (high - low);
    }
    return sqrt(sum);
}

#endif
