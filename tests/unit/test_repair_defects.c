/* test_repair_defects.c - good shapes with every defect of defect_maker.h: what comes out is certified, and
 * its volume lies between the stated bounds. */
#include "tools/crossing_oracle.h"
#include "tools/defect_maker.h"

#include "solid_support.h"

static defect_shape shape;
static bvx_repair_report report;
static char where[200];

static void describe(const defect_kind *kind, int32_t which, int32_t resolution)
{
    double const h = report.lattice.spacing[0];
    snprintf(where, sizeof where, "%s with %s at %d: volume %.4f, allowed %.4f to %.4f",
             kind->any_shape ? defect_shape_names[which] : "", kind->name, (int)resolution,
             report.after.volume, defect_low(&shape, h), defect_high(&shape, h));
}

static bvx_mesh repaired_shape(int32_t resolution)
{
    bvx_mesh_view const view = maker_view(&shape.mesh);
    bvx_repair_options o = {.struct_size = sizeof o};
    bvx_mesh out;

    memset(&out, 0, sizeof out);
    o.fit.resolution = resolution;
    o.placing.position_type = BVX_F64;
    o.report = &report;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_repair(ctx, &view, &o, &out), bvx_last_message(ctx));
    return out;
}

static void assert_certified(const bvx_mesh *m)
{
    bvx_mesh_view view;
    bvx_certificate c;
    bvx_mesh_view_of(m, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
    TEST_ASSERT_TRUE_MESSAGE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, c.degenerate + c.duplicates + c.collapsed + c.unused_vertices, where);
}

static void assert_not_crossing(const bvx_mesh *m)
{
    const char *wrong;
    uint64_t const crossings = crossing_count(m, 4503599627370496.0, &wrong); /* 2^52 */
    TEST_ASSERT_NULL_MESSAGE(wrong, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, crossings, where);
}

static void one_defect(const defect_kind *kind, int32_t which, int32_t resolution, int crossing)
{
    double h;
    bvx_mesh out;

    defect_begin(&shape, which, &seed, resolution);
    kind->make(&shape, &seed);
    out = repaired_shape(resolution);
    describe(kind, which, resolution);
    h = report.lattice.spacing[0];
    assert_certified(&out);
    if (crossing) assert_not_crossing(&out);
    TEST_ASSERT_TRUE_MESSAGE(report.after.volume >= defect_low(&shape, h), where);
    TEST_ASSERT_TRUE_MESSAGE(report.after.volume <= defect_high(&shape, h), where);
    bvx_mesh_free(ctx, &out);
}

static void all_defects(int32_t resolution, int trials, int crossing)
{
    for (int i = 0; i < trials; i++)
        for (int kind = 0; kind < DEFECT_KINDS; kind++)
            for (int32_t which = 0; which < (defect_kinds[kind].any_shape ? DEFECT_SHAPES : 1); which++)
                one_defect(&defect_kinds[kind], which, resolution, crossing);
    defect_end(&shape);
}

static void test_coarse_ones_do_not_cross(void)
{
    all_defects(9, 1, 1);
    if (!quick) all_defects(12, 1, 1);
}

static void test_volumes_stay_within_their_bounds(void)
{
    if (!quick) all_defects(24, 1, 0);
    if (!quick) all_defects(33, 1, 0);
}

/* Whichever way its triangles face, the strip's signed volume is not that of its shell. */
static void test_a_strip_of_one_side_is_around_nothing(void)
{
    for (int flipped = 0; flipped < 2; flipped++) {
        bvx_mesh out;

        defect_begin(&shape, 0, &seed, 48);
        defect_moebius(&shape, &seed);
        if (flipped) maker_flip(&shape.mesh, 0, shape.mesh.triangles);
        out = repaired_shape(48);
        TEST_ASSERT_TRUE((report.warnings >> BVX_WARN_SHELLS & 1) != 0);
        TEST_ASSERT_EQUAL_UINT64(0, report.warnings >> BVX_WARN_TURNED & 1);
        bvx_mesh_free(ctx, &out);
    }
    defect_end(&shape);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_coarse_ones_do_not_cross);
    RUN_TEST(test_volumes_stay_within_their_bounds);
    RUN_TEST(test_a_strip_of_one_side_is_around_nothing);
    return UNITY_END();
}
