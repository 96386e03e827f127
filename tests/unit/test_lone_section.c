/* test_lone_section.c - bodies of one section alone: slabs and lenses of a thickness, whatever stands beside them
 * in the stack, and what is refused. */
#include "unit/section_support.h"

#include <math.h>

/* A ring around a hole, with an island in it, at a height. */
static double add_ring(double position)
{
    uint32_t const s = stack_section(&stack, position);

    stack_round(&stack, s, 1, 2, 4, 3, 64, 0, 0, 0);
    stack_round(&stack, s, 1, 2, 2, 2, 40, 0, 0, 1);
    stack_round(&stack, s, 1, 2, 0.5, 0.75, 24, 0.2, 0, 0);
    return position;
}

/* Twice the area of a loop, by its own direction. */
static double loop_area(uint64_t loop)
{
    const bvx_section_loop *const l = &stack.s.loops[loop];
    double sum = 0.0;

    for (uint32_t i = 0; i < l->point_count; i++) {
        const double *const a = stack.s.points + 3 * (l->first_point + i);
        const double *const b = stack.s.points + 3 * (l->first_point + (i + 1) % l->point_count);
        sum += a[0] * b[1] - a[1] * b[0];
    }
    return 0.5 * fabs(sum);
}

static void test_a_slab_is_as_thick_as_asked(void)
{
    double area;

    add_ring(5.0);
    area = loop_area(0) - loop_area(1) + loop_area(2);
    o.thickness = 0.75;
    build_good();
    assert_points_kept();
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * area, 0.75 * area, certificate.volume);
    TEST_ASSERT_EQUAL_DOUBLE(5.0 - 0.375, certificate.box.low[2]);
    TEST_ASSERT_EQUAL_DOUBLE(5.0 + 0.375, certificate.box.high[2]);
    TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
    TEST_ASSERT_EQUAL_UINT64(1, report.sections);
    TEST_ASSERT_EQUAL_UINT64(3, report.loops);
    TEST_ASSERT_EQUAL_UINT64(1, report.holes);
    TEST_ASSERT_EQUAL_UINT64(stack.s.point_count, report.points);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * area, 0.75 * area, report.prismoid_volume);
}

/* Ridges half a thickness away: a cone of a convex part has a third of the slab's volume. */
static void test_a_lens_ends_at_half_its_thickness(void)
{
    uint32_t const s = stack_section(&stack, -1.0);

    stack_round(&stack, s, 0, 0, 2, 2, 96, 0, 0, 0);
    o.thickness = 1.0;
    o.caps = BVX_CAPS_TAPER;
    o.slabs.grid[0] = o.slabs.grid[1] = 64;
    build_good();
    assert_points_kept();
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
    TEST_ASSERT_TRUE(certificate.box.low[2] >= -1.5 && certificate.box.low[2] < -1.45);
    TEST_ASSERT_TRUE(certificate.box.high[2] <= -0.5 && certificate.box.high[2] > -0.55);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * loop_area(0), loop_area(0) / 3.0, certificate.volume);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, loop_area(0) / 3.0, report.prismoid_volume);

    stack_clear(&stack);
    add_ring(0.0);
    build_good();
    assert_points_kept();
    TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
}

/* Open: the wall of the slab, with two borders for each loop. */
static void test_an_open_slab_is_its_wall(void)
{
    add_ring(0.0);
    o.thickness = 0.5;
    o.caps = BVX_CAPS_OPEN;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, build());
    certify(0);
    TEST_ASSERT_TRUE(!certificate.closed && certificate.edge_manifold && certificate.oriented);
    TEST_ASSERT_EQUAL_UINT64(3, certificate.components);
}

/* Empty sections and other bodies beside it, and planes of other directions, change nothing. */
static void test_what_stands_beside_it_changes_nothing(void)
{
    for (int32_t caps = BVX_CAPS_FLAT; caps <= BVX_CAPS_TAPER; caps++) {
        uint64_t alone, beside;

        stack_clear(&stack);
        o.label = 0;
        o.thickness = 0.25;
        o.caps = caps;
        add_ring(0.0);
        build_good();
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &mesh, &alone));

        stack_oblique(&stack);
        stack_plane(&stack, 1, 0, 0, 0.5);
        stack.normal[3] = stack.normal[4] = 0.0;
        stack.normal[5] = 1.0;
        add_ring(0.0);
        for (int i = 0; i < 3; i++) stack.loop[i].label = 7;
        stack_ball_cut(&stack, stack_plane(&stack, 0, 1, 0, 1.0), 0, 0, 0, 2.0, 16);
        o.label = 7;
        build_good();
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &mesh, &beside));
        TEST_ASSERT_EQUAL_HEX64(alone, beside);
    }
}

/* Loops of no area beside it are dropped when they are mended: the slab is that of the section that is left. */
static void test_mending_may_leave_one_section(void)
{
    for (int32_t caps = BVX_CAPS_FLAT; caps <= BVX_CAPS_OPEN; caps++) {
        double volume;

        stack_clear(&stack);
        o.thickness = 0.5;
        o.caps = caps;
        o.mend = 1;
        add_ring(2.0);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, build());
        certify(0);
        volume = certificate.volume;

        stack_round(&stack, stack_section(&stack, 1.0), 0, 0, 0, 0, 1, 0, 0, 0);
        stack_round(&stack, stack_section(&stack, 4.0), 0, 0, 1, 0, 2, 0, 0, 0);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, build(), bvx_last_message(ctx));
        certify(0);
        TEST_ASSERT_EQUAL_INT32(caps != BVX_CAPS_OPEN, certificate.closed);
        TEST_ASSERT_DOUBLE_WITHIN(0.05 * volume, volume, certificate.volume);
        TEST_ASSERT_EQUAL_UINT64(caps == BVX_CAPS_OPEN ? 3 : 2, certificate.components);
    }
    o.thickness = 0.0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, build());
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "loops in only one section"));
}

/* The normal's length and direction: a slab across any of them. */
static void test_slabs_across_any_normal(void)
{
    static const double normal[3][3] = {{0, 0, 2.5}, {3, 0, 0}, {1, 2, -2}};
    double volume = 0.0;

    for (int i = 0; i < 3; i++) {
        stack_oblique(&stack);
        stack_ball_cut(&stack, stack_plane(&stack, normal[i][0], normal[i][1], normal[i][2], 0.3), 0, 0, 0,
                       1.0, 50);
        o.thickness = 0.125;
        build_good();
        assert_points_kept();
        if (i == 0) volume = certificate.volume;
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, volume, certificate.volume);
    }
}

static void test_a_bow_tie_is_mended_first(void)
{
    static const double bow[8] = {0, 0, 4, 3, 4, 0, 0, 3};

    stack_loop(&stack, stack_section(&stack, 0.0));
    for (int i = 0; i < 8; i += 2) stack_point(&stack, bow[i], bow[i + 1]);
    o.thickness = 1.0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, build());
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), "loop 0 of section 0 (position 0) crosses"),
                                 bvx_last_message(ctx));
    o.mend = 1;
    build_good();
    TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
    TEST_ASSERT_DOUBLE_WITHIN(1e-4, 6.0, certificate.volume); /* points are moved apart by a hair */
    TEST_ASSERT_EQUAL_UINT64(1, report.mended_loops);
}

/* Without a thickness one section is too few; several sections take no notice of one. */
static void test_thickness_is_for_one_section_alone(void)
{
    uint64_t hash[2];

    add_ring(0.0);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, build());
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "it needs two, or a thickness"));
    o.thickness = -1.0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, build());
    o.thickness = NAN;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, build());
    add_ring(1.0);
    for (int i = 0; i < 2; i++) {
        o.thickness = i;
        build_good();
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &mesh, &hash[i]));
    }
    TEST_ASSERT_EQUAL_HEX64(hash[0], hash[1]);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_slab_is_as_thick_as_asked);
    RUN_TEST(test_a_lens_ends_at_half_its_thickness);
    RUN_TEST(test_an_open_slab_is_its_wall);
    RUN_TEST(test_what_stands_beside_it_changes_nothing);
    RUN_TEST(test_mending_may_leave_one_section);
    RUN_TEST(test_slabs_across_any_normal);
    RUN_TEST(test_a_bow_tie_is_mended_first);
    RUN_TEST(test_thickness_is_for_one_section_alone);
    return UNITY_END();
}
