/* field_surface_support.h - what the tests of bvx_extract_field_surface
 * share: contexts, lattices, the certificate. */
#ifndef FIELD_SURFACE_SUPPORT_H
#define FIELD_SURFACE_SUPPORT_H

#include "tools/crossing_oracle.h"
#include "tools/field_maker.h"

#include "suite.h"

static uint64_t seed;
static bvx_field field;
static maker_mesh mesh;

void setUp(void)
{
    suite_open(1);
    seed = UINT64_C(0xf1e1d);
}

void tearDown(void)
{
    field_maker_free(ctx, &field);
    maker_free(&mesh);
    suite_close();
}

static inline bvx_field_surface_options surface_options(int32_t sharp)
{
    bvx_field_surface_options o = {.struct_size = sizeof o};
    o.placing.interpolation = BVX_EDGE_VECTOR;
    o.placing.sharp = BVX_SHARP_NEVER + sharp;
    return o;
}

static inline bvx_lattice lattice_at(const double origin[3], const double spacing[3], int32_t x, int32_t y,
                                     int32_t z)
{
    int32_t const dims[3] = {x, y, z};
    bvx_lattice l;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l),
                                    bvx_last_message(ctx));
    return l;
}

/* Of any spacings and sizes; all positions of surfaces on it lie in [1, 16). */
static inline bvx_lattice random_lattice(void)
{
    double origin[3], spacing[3];
    int32_t dims[3];

    for (int a = 0; a < 3; a++) {
        spacing[a] = maker_below(&seed, 2) ? 1.0 : 0.7 + 0.001 * maker_below(&seed, 900);
        origin[a] = 2.0 + 0.001 * maker_below(&seed, 300);
        dims[a] = 1 + maker_below(&seed, 8);
    }
    return lattice_at(origin, spacing, dims[0], dims[1], dims[2]);
}

static inline void assert_same_surface(const bvx_mesh *a, const bvx_mesh *b)
{
    TEST_ASSERT_EQUAL_UINT64(a->vertex_count, b->vertex_count);
    TEST_ASSERT_EQUAL_UINT64(a->triangle_count, b->triangle_count);
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->positions, b->positions,
                                    (size_t)a->vertex_count * (a->position_type == BVX_F32 ? 12 : 24)));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->triangles, b->triangles, (size_t)a->triangle_count * 12));
}

/* Closed, oriented, manifold, no triangle without area, none crossing, outwards. */
static inline void assert_certificate(const bvx_mesh *m)
{
    bvx_mesh_view v;
    bvx_certificate c;
    const char *wrong;
    char text[200];
    uint64_t crossings;

    if (m->triangle_count == 0) return;
    bvx_mesh_view_of(m, &v);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &v, 0, &c));
    snprintf(
        text, sizeof text,
        "boundary %d, nonmanifold edges %d, vertices %d, flipped %d, duplicates %d, collapsed %d, degenerate %d",
        (int)c.boundary_edges, (int)c.nonmanifold_edges, (int)c.nonmanifold_vertices, (int)c.flipped_edges,
        (int)c.duplicates, (int)c.collapsed, (int)c.degenerate);
    TEST_ASSERT_TRUE_MESSAGE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented &&
                                 c.duplicates == 0 && c.collapsed == 0 && c.degenerate == 0 &&
                                 c.unused_vertices == 0 && c.volume > 0,
                             text);
    crossings = crossing_count(m, 4503599627370496.0, &wrong); /* 2^52 */
    TEST_ASSERT_NULL_MESSAGE(wrong, wrong);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, crossings, "triangles cross");
}

static inline bvx_mesh surface_of(bvx_context *c, const bvx_mesh_view *of, const bvx_field_surface_options *o)
{
    bvx_mesh m = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_extract_field_surface(c, &field, of, o, &m),
                                    bvx_last_message(c));
    return m;
}

#endif
