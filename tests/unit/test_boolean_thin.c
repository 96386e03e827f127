/* test_boolean_thin.c - walls of the operands thinner than voxels: they are
 * in the result, about as thick as they are, or told as lost. */
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

static maker_mesh first, second;
static bvx_mesh made;
static bvx_boolean_report report;
static bvx_certificate result;

void setUp(void)
{
    suite_open(1);
    memset(&first, 0, sizeof first);
    memset(&second, 0, sizeof second);
}

void tearDown(void)
{
    bvx_mesh_free(ctx, &made);
    maker_free(&first);
    maker_free(&second);
    suite_close();
}

static void box(maker_mesh *m, double x0, double y0, double z0, double x1, double y1, double z1)
{
    double const low[3] = {x0, y0, z0}, high[3] = {x1, y1, z1};

    maker_box(m, low, high);
}

/* The result is sound and crosses nothing; what it is like goes to result. */
static void combine_on(int32_t operation, int32_t resolution, int32_t thin, int32_t sharp,
                       const bvx_lattice *lattice)
{
    bvx_mesh_view const a = maker_view(&first), b = maker_view(&second);
    bvx_boolean_options o = {.struct_size = sizeof o};
    uint64_t crossings;
    bvx_mesh_view v;

    bvx_mesh_free(ctx, &made);
    memset(&report, 0, sizeof report);
    TEST_ASSERT_EQUAL_INT32(BVX_THIN_KEEP, o.thin);
    o.fit.resolution = resolution;
    o.fit.lattice = lattice;
    o.thin = thin;
    o.placing.sharp = BVX_SHARP_NEVER + sharp;
    o.report = &report;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_boolean(ctx, &a, &b, operation, &o, &made),
                                    bvx_last_message(ctx));
    bvx_mesh_view_of(&made, &v);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &v, 1, &result));
    TEST_ASSERT_TRUE(result.closed && result.edge_manifold && result.vertex_manifold && result.oriented);
    TEST_ASSERT_EQUAL_UINT64(0, result.degenerate + result.duplicates + result.collapsed);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &v, &crossings, NULL, 0));
    TEST_ASSERT_EQUAL_UINT64(0, crossings);
}

static void combine(int32_t operation, int32_t resolution, int32_t thin, int32_t sharp)
{
    combine_on(operation, resolution, thin, sharp, NULL);
}

static void assert_volume(double expected, double share)
{
    char text[80];

    snprintf(text, sizeof text, "volume %.6g, expected %.6g", result.volume, expected);
    TEST_ASSERT_TRUE_MESSAGE(fabs(result.volume / expected - 1.0) < share, text);
}

/* A plate of half a voxel, where its lattice has centres in it and where it has none, less a bar through
 * it. */
static void test_a_plate_with_a_hole(void)
{
    for (int32_t sharp = 0; sharp < 2; sharp++)
        for (int i = 0; i < 4; i++) {
            double const h = 0.25 / 32, z = 0.1 * i / 32;

            maker_clear(&first);
            maker_clear(&second);
            box(&first, -1, -1, z - h, 1, 1, z + h);
            box(&second, -0.41, -0.33, -0.5, 0.37, 0.29, 0.5);
            combine(BVX_BOOLEAN_DIFFERENCE, 64, BVX_THIN_KEEP, sharp);
            TEST_ASSERT_EQUAL_UINT64(1, result.components);
            TEST_ASSERT_EQUAL_INT64(0, result.euler);
            assert_volume((4 - 0.78 * 0.62) * 2 * h, 0.1);
            TEST_ASSERT_EQUAL_INT32(report.solid_a.thin_voxels != 0 ? BVX_KEPT_A : 0, report.thin_kept);
        }
}

/* A seat and a back of slats of two thirds of a voxel, all in each other. [Units: of the slats, 1/80] */
static void make_chair(maker_mesh *m)
{
    box(m, -0.5, -0.5, 0, 0.5, 0.5, 0.03);
    box(m, -0.5, 0.455, 0.97, 0.5, 0.485, 1.03);
    for (int i = 0; i < 9; i++) box(m, -0.47 + i * 0.115, 0.469, 0.02, -0.44 + i * 0.115, 0.479, 1);
}

static void test_a_chair_and_a_box(void)
{
    make_chair(&first);
    box(&second, -0.4, -0.4, -0.5, 0.4, 0.3, 0.01);
    combine(BVX_BOOLEAN_UNION, 80, BVX_THIN_DROP, -1);
    TEST_ASSERT_TRUE(report.solid_a.thin_voxels > 100);
    TEST_ASSERT_EQUAL_UINT64(0, report.solid_b.thin_voxels);
    TEST_ASSERT_EQUAL_INT32(0, report.thin_kept);
    TEST_ASSERT_EQUAL_INT32(1, report.solid_a.thin_checked);
    TEST_ASSERT_TRUE(result.euler != 2 - 2 * 8); /* they are lost */

    combine(BVX_BOOLEAN_UNION, 80, BVX_THIN_KEEP, -1);
    TEST_ASSERT_TRUE(report.solid_a.thin_voxels > 100);
    TEST_ASSERT_EQUAL_INT32(BVX_KEPT_A, report.thin_kept);
    TEST_ASSERT_EQUAL_UINT64(1, result.components);
    TEST_ASSERT_EQUAL_INT64(2 - 2 * 8, result.euler);
    assert_volume(0.03 + 0.03 * 0.06 + 9 * 0.03 * 0.01 * 0.94 + 0.8 * 0.7 * 0.5, 0.02);
}

/* Bodies that touch are one: a plate on a block, both of them operands. */
static void test_two_plates_that_cross(void)
{
    double const h = 0.2 / 32;

    box(&first, -1, -1, -h, 1, 1, h);
    box(&second, -1, -h, -1, 1, h, 1);
    combine(BVX_BOOLEAN_UNION, 64, BVX_THIN_KEEP, -1);
    TEST_ASSERT_EQUAL_UINT64(1, result.components);
    TEST_ASSERT_EQUAL_INT64(2, result.euler);
    TEST_ASSERT_TRUE(result.volume > 0 && result.volume < 1.2 * (2 * 4 * 2 * h - 2 * 4 * h * h));
    TEST_ASSERT_TRUE(result.volume > 0.9 * (2 * 4 * 2 * h - 2 * 4 * h * h));
}

/* A thin wall of b is a slot in a: two halves. */
static void test_a_slot(void)
{
    double const at = 0.003, h = 0.2 / 32; /* no centre in it */

    box(&first, -1, -1, -1, 1, 1, 1);
    box(&second, at - h, -2, -2, at + h, 2, 2);
    combine(BVX_BOOLEAN_DIFFERENCE, 64, BVX_THIN_KEEP, -1);
    TEST_ASSERT_EQUAL_INT32(BVX_KEPT_B, report.thin_kept);
    TEST_ASSERT_EQUAL_UINT64(2, result.components);
    assert_volume(8 - 4 * 2 * h, 0.002);
}

/* What both have in common is a piece of the plate. */
static void test_a_piece_of_a_plate(void)
{
    double const at = 0.003, h = 0.2 / 32;
    bvx_lattice lattice;

    memset(&lattice, 0, sizeof lattice);
    box(&first, -0.7, -0.6, -0.5, 0.7, 0.6, 0.5);
    box(&second, at - h, -2, -2, at + h, 2, 2);
    lattice.fraction_bits = 8;
    for (int a = 0; a < 3; a++) {
        lattice.origin[a] = -1;
        lattice.spacing[a] = 1.0 / 32;
        lattice.dims[a] = 64;
    }
    combine_on(BVX_BOOLEAN_INTERSECTION, 64, BVX_THIN_KEEP, -1, &lattice);
    TEST_ASSERT_EQUAL_INT32(BVX_KEPT_B, report.thin_kept);
    TEST_ASSERT_EQUAL_UINT64(1, result.components);
    TEST_ASSERT_EQUAL_INT64(2, result.euler);
    assert_volume(1.2 * 1.0 * 2 * h, 0.1);
}

/* Nothing thin: nothing is reported, and the option does nothing. */
static void test_thick_bodies_are_as_without(void)
{
    uint64_t vertices;

    box(&first, -1, -1, -1, 1, 1, 1);
    box(&second, -0.3, -0.3, -2, 0.3, 0.3, 2);
    combine(BVX_BOOLEAN_DIFFERENCE, 32, BVX_THIN_DROP, -1);
    vertices = made.vertex_count;
    combine(BVX_BOOLEAN_DIFFERENCE, 32, BVX_THIN_KEEP, -1);
    TEST_ASSERT_EQUAL_UINT64(vertices, made.vertex_count);
    TEST_ASSERT_EQUAL_INT32(0, report.thin_kept);
    TEST_ASSERT_EQUAL_UINT64(0, report.solid_a.thin_voxels + report.solid_b.thin_voxels);
}

/* A tray of thin walls, whose box is thick: the resolution that the refusal names does. */
static void test_the_resolution_that_a_refusal_names_helps(void)
{
    bvx_boolean_options o = {.struct_size = sizeof o};
    bvx_mesh_view a, b;
    const char *number;

    box(&first, 0.003, 0.003, 0.003, 0.012, 1, 1);
    box(&first, 0.003, 0.003, 0.003, 1, 0.012, 1);
    box(&second, 0, 0, 0, 1, 1, 1);
    a = maker_view(&first);
    b = maker_view(&second);
    o.fit.resolution = 30;
    o.thin = BVX_THIN_DROP;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_boolean(ctx, &a, &b, BVX_BOOLEAN_UNION, &o, &made));
    number = strstr(bvx_last_message(ctx), "a resolution of ");
    TEST_ASSERT_NOT_NULL_MESSAGE(number, bvx_last_message(ctx));
    o.fit.resolution = (int32_t)strtol(number + 16, NULL, 10);
    TEST_ASSERT_TRUE(o.fit.resolution > 60 && o.fit.resolution < 400);
    o.report = &report;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_boolean(ctx, &a, &b, BVX_BOOLEAN_UNION, &o, &made),
                                    bvx_last_message(ctx));
    TEST_ASSERT_TRUE(report.voxels_a > 0);
}

static void test_refusals(void)
{
    bvx_boolean_options o = {.struct_size = sizeof o};
    bvx_mesh_view a;

    box(&first, -1, -1, -1, 1, 1, 1);
    a = maker_view(&first);
    o.thin = BVX_THIN_SHELL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_boolean(ctx, &a, &a, BVX_BOOLEAN_UNION, &o, &made));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "thin 2"));
    o.thin = BVX_THIN_KEEP;
    o.fit.reserved = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_boolean(ctx, &a, &a, BVX_BOOLEAN_UNION, &o, &made));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_plate_with_a_hole);
    RUN_TEST(test_a_chair_and_a_box);
    RUN_TEST(test_two_plates_that_cross);
    RUN_TEST(test_a_slot);
    RUN_TEST(test_a_piece_of_a_plate);
    RUN_TEST(test_thick_bodies_are_as_without);
    RUN_TEST(test_the_resolution_that_a_refusal_names_helps);
    RUN_TEST(test_refusals);
    return UNITY_END();
}
