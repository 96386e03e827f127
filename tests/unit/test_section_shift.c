/* test_section_shift.c - slanted parts joined by shifting: bars and pipes whose sections share no area, which
 * part goes to which, and what does not change. */
#include "section_support.h"

/* A square of side 4 whose low corner is at x, y. */
static void add_square(uint32_t section, double x, double y)
{
    stack_loop(&stack, section);
    stack_point(&stack, x, y);
    stack_point(&stack, x + 4, y);
    stack_point(&stack, x + 4, y + 4);
    stack_point(&stack, x, y + 4);
}

static void four_squares(double shift)
{
    stack_clear(&stack);
    for (int k = 0; k < 4; k++) add_square(stack_section(&stack, k), shift * k, 0);
}

static uint64_t mesh_bits(void)
{
    return bvx_hash(mesh.positions, (size_t)mesh.vertex_count * 24, 0) ^
           bvx_hash(mesh.triangles, (size_t)mesh.triangle_count * 12, 1);
}

static void test_four_squares_become_one_slanted_bar(void)
{
    four_squares(10);
    build_good();
    TEST_ASSERT_EQUAL_UINT64(4, certificate.components);
    TEST_ASSERT_TRUE(certificate.volume < 5.0);

    o.slabs.join = 10;
    build_good();
    assert_points_kept();
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
    TEST_ASSERT_EQUAL_INT64(2, certificate.euler);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * 48, 48, certificate.volume);
    TEST_ASSERT_EQUAL_DOUBLE(48, report.prismoid_volume);
    TEST_ASSERT_EQUAL_UINT64(3, report.shifted_parts);
    /* What was given is counted as it was given. */
    TEST_ASSERT_EQUAL_UINT64(4, report.sections);
    TEST_ASSERT_EQUAL_UINT64(4, report.loops);
    TEST_ASSERT_EQUAL_UINT64(16, report.points);
}

/* Half way between two sections the bar's border is half way between their squares. */
static void test_the_bar_is_straight(void)
{
    double low = 1e9, high = -1e9, most = 0.0;

    four_squares(10);
    o.slabs.join = 10;
    build_good();
    for (uint64_t i = 0; i < mesh.vertex_count; i++) {
        const double *const p = (const double *)mesh.positions + 3 * i;
        double const off = p[0] - 10.0 * p[2];
        /* Along the middle of both slanted sides. */
        if (p[1] < 1.5 || p[1] > 2.5) continue;
        if (off > 2.0 && off - 4.0 > most) most = off - 4.0;
        if (off < 2.0 && -off > most) most = -off;
        if (off < low) low = off;
        if (off > high) high = off;
    }
    TEST_ASSERT_TRUE(most < 0.3 && low < 0.3 && high > 3.7);
}

static void test_a_slanted_pipe_stays_hollow(void)
{
    for (int k = 0; k < 3; k++) {
        uint32_t const s = stack_section(&stack, 2.0 * k);
        stack_round(&stack, s, 5.0 * k, 3.0 * k, 2, 2, 40, 0, 0, 0);
        stack_round(&stack, s, 5.0 * k, 3.0 * k, 1, 1, 30, 0, 0, 1);
    }
    o.slabs.join = 6;
    build_good();
    assert_points_kept();
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
    TEST_ASSERT_EQUAL_INT64(0, certificate.euler);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * report.prismoid_volume, report.prismoid_volume, certificate.volume);
    TEST_ASSERT_EQUAL_UINT64(4, report.shifted_parts);
}

/* Each of two vessels goes to the nearer end, though both are within reach of either. */
static void test_nearest_centroids_are_joined(void)
{
    stack_clear(&stack);
    for (int k = 0; k < 2; k++) {
        uint32_t const s = stack_section(&stack, 4.0 * k);
        /* The order of the loops is turned around: nearness decides, not the numbers. */
        add_square(s, k == 0 ? 0 : 20, 0);
        add_square(s, k == 0 ? 14 : 6, 0);
    }
    o.slabs.join = 100;
    build_good();
    assert_points_kept();
    TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * 128, 128, certificate.volume);
    TEST_ASSERT_EQUAL_UINT64(2, report.shifted_parts);
}

/* One square between two that are equally near: the first of them is its other end; the last one ends alone. */
static void test_ties_go_to_the_lowest_index(void)
{
    for (int turned = 0; turned < 2; turned++) {
        double left = 0.0, right = 0.0;
        stack_clear(&stack);
        add_square(stack_section(&stack, 0), 0, 0);
        uint32_t const s = stack_section(&stack, 2);
        add_square(s, turned ? 8 : -8, 0);
        add_square(s, turned ? -8 : 8, 0);
        o.slabs.join = 8;
        build_good();
        assert_points_kept();
        TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
        TEST_ASSERT_EQUAL_UINT64(1, report.shifted_parts);

        /* The bar has vertices below the middle on its side; the other square ended above it. */
        for (uint64_t i = 0; i < mesh.vertex_count; i++) {
            const double *const p = (const double *)mesh.positions + 3 * i;
            if (p[2] <= 0.0 || p[2] > 0.9) continue;
            if (p[0] < 0.0 && -p[0] > left) left = -p[0];
            if (p[0] > 4.0 && p[0] - 4.0 > right) right = p[0] - 4.0;
        }
        TEST_ASSERT_TRUE(turned ? right > 2.0 && left == 0.0 : left > 2.0 && right == 0.0);
    }
}

static void test_parts_beyond_reach_stay_as_they_are(void)
{
    uint64_t bits;

    four_squares(10);
    build_good();
    bits = mesh_bits();
    o.slabs.join = 9.99;
    build_good();
    TEST_ASSERT_EQUAL_HEX64(bits, mesh_bits());
    TEST_ASSERT_EQUAL_UINT64(0, report.shifted_parts);
}

static void test_upright_bodies_stay_as_they_are(void)
{
    uint64_t bits;

    for (int k = 0; k < 4; k++) {
        uint32_t const s = stack_section(&stack, k);
        stack_round(&stack, s, 0.1 * k, 0, 3 + 0.2 * k, 2, 50, 0.1, 0, 0);
        stack_round(&stack, s, 0.1 * k, 0, 1, 1, 20, 0.1, 0, 1);
    }
    build_good();
    bits = mesh_bits();
    o.slabs.join = 1;
    build_good();
    TEST_ASSERT_EQUAL_HEX64(bits, mesh_bits());
    TEST_ASSERT_EQUAL_UINT64(0, report.shifted_parts);
}

/* A part that splits is not shifted; what lies beside it is. */
static void test_a_branch_stays_a_branch(void)
{
    for (int k = 0; k < 4; k++) {
        uint32_t const s = stack_section(&stack, k);
        if (k < 2) stack_round(&stack, s, 0, 0, 3, 2, 40, 0, 0, 0);
        else {
            stack_round(&stack, s, -1.6, 0, 1.2, 1.2, 30, 0, 0, 0);
            stack_round(&stack, s, 1.6, 0, 1.2, 1.2, 30, 0, 0, 0);
        }
        stack_round(&stack, s, 6.0 * k, 10, 1, 1, 24, 0, 0, 0);
    }
    o.slabs.join = 7;
    build_good();
    assert_points_kept();
    TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
    TEST_ASSERT_EQUAL_INT64(4, certificate.euler);
}

static void test_ends_reach_as_far_as_without(void)
{
    double low = 1e9, high = -1e9;

    four_squares(10);
    o.slabs.join = 10;
    o.caps = BVX_CAPS_TAPER;
    build_good();
    for (uint64_t i = 0; i < mesh.vertex_count; i++) {
        double const z = ((const double *)mesh.positions)[3 * i + 2];
        if (z < low) low = z;
        if (z > high) high = z;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.1, -0.5, low);
    TEST_ASSERT_DOUBLE_WITHIN(0.1, 3.5, high);
}

/* Points a quarter of the way off their plane would not lie near one of many: fewer are put in, and none that
 * makes them be refused. */
static void test_points_off_their_plane(void)
{
    four_squares(10);
    for (uint64_t i = 0; i < stack.s.point_count; i += 3) stack.point[3 * i + 2] += 0.03;
    o.slabs.join = 10;
    build_good();
    assert_points_kept();
    TEST_ASSERT_EQUAL_UINT64(3, report.shifted_parts);
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
}

static void test_mended_loops_are_joined_too(void)
{
    static const double keyhole[] = {0, 0, 4, 0, 4, 4, 0, 4, 0, 2, 1, 2, 1, 3, 3, 3, 3, 1, 1, 1, 1, 2, 0, 2};

    for (int k = 0; k < 3; k++) {
        stack_loop(&stack, stack_section(&stack, k));
        for (size_t i = 0; i < sizeof keyhole / sizeof *keyhole; i += 2)
            stack_point(&stack, 10.0 * k + keyhole[i], keyhole[i + 1]);
    }
    o.slabs.join = 12;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, build());
    o.mend = 1;
    build_good();
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
    TEST_ASSERT_EQUAL_INT64(0, certificate.euler);
    TEST_ASSERT_DOUBLE_WITHIN(0.06 * 24, 24, certificate.volume);
}

/* Bodies of any loops: sound, through all points, in all ways on the planes, and always the same. */
static void test_random_stacks(void)
{
    uint64_t seed = 2027, joined = 0;

    for (int i = 0; i < 30; i++) {
        uint64_t bits;
        stack_random(&stack, &seed);
        o.slabs.join = i % 4 == 0 ? 1.0 : 10.0;
        o.caps = i % 3 == 0 ? BVX_CAPS_TAPER : BVX_CAPS_FLAT;
        o.slabs.blend = i % 5 == 0 ? BVX_BLEND_CUBIC : BVX_BLEND_LINEAR;
        o.slabs.layers = 1 + i % 2;
        o.slabs.crossings = i % 7 == 0 ? BVX_CROSSINGS_PAPER : BVX_CROSSINGS_EXACT;
        build_good();
        if (o.slabs.crossings == BVX_CROSSINGS_EXACT) assert_points_kept();
        joined += report.shifted_parts != 0;
        bits = mesh_bits();
        build_good();
        TEST_ASSERT_EQUAL_HEX64(bits, mesh_bits());
    }
    TEST_ASSERT_TRUE(joined > 15);
}

static void test_reach_must_be_a_length(void)
{
    four_squares(10);
    o.slabs.join = -1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, build());
    o.slabs.join = NAN;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, build());
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_four_squares_become_one_slanted_bar);
    RUN_TEST(test_the_bar_is_straight);
    RUN_TEST(test_a_slanted_pipe_stays_hollow);
    RUN_TEST(test_nearest_centroids_are_joined);
    RUN_TEST(test_ties_go_to_the_lowest_index);
    RUN_TEST(test_parts_beyond_reach_stay_as_they_are);
    RUN_TEST(test_upright_bodies_stay_as_they_are);
    RUN_TEST(test_a_branch_stays_a_branch);
    RUN_TEST(test_ends_reach_as_far_as_without);
    RUN_TEST(test_points_off_their_plane);
    RUN_TEST(test_mended_loops_are_joined_too);
    RUN_TEST(test_random_stacks);
    RUN_TEST(test_reach_must_be_a_length);
    return UNITY_END();
}
