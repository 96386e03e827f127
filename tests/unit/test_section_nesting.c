/* test_section_nesting.c - loops that lie in others are blended level by level: walls that lean, branch and
 * lie in each other keep no windows and all of their volume, and nothing crosses; holes that end and stacks
 * without holes are as ever; levels that would cross are blended as a whole. */
#include "section_support.h"

/* ---- help ---- */

static uint64_t crossings(void)
{
    uint64_t count = 0;
    bvx_mesh_view view;

    bvx_mesh_view_of(&mesh, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &view, &count, NULL, 0));
    return count;
}

static uint64_t hash(void)
{
    uint64_t mark = 0;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &mesh, &mark));
    return mark;
}

/* A wall without windows: what it is, all of its volume, and nothing that crosses. */
static void assert_sound(int64_t euler, uint64_t components, double share)
{
    build_good();
    TEST_ASSERT_EQUAL_INT64(euler, certificate.euler);
    TEST_ASSERT_EQUAL_UINT64(components, certificate.components);
    TEST_ASSERT_EQUAL_UINT64(0, report.joined_slabs);
    TEST_ASSERT_TRUE(certificate.volume > (1.0 - share) * report.prismoid_volume &&
                     certificate.volume < (1.0 + share) * report.prismoid_volume);
    TEST_ASSERT_EQUAL_UINT64(0, crossings());
    assert_points_kept();
}

/* Rounds in each other, each smaller by the wall, moved by so much from section to section. */
static void make_tube(int sections, int rounds, double wall, double shift)
{
    stack_clear(&stack);
    for (int k = 0; k < sections; k++) {
        uint32_t const s = stack_section(&stack, k);
        for (int i = 0; i < rounds; i++)
            stack_round(&stack, s, k * shift, 0.3 * k * shift, 4.0 - wall * i, 4.0 - wall * i, 64, 0, 0,
                        (i + k) & 1);
    }
}

static void add_box(uint32_t section, double x, double y, double half)
{
    stack_loop(&stack, section);
    stack_point(&stack, x - half, y - half);
    stack_point(&stack, x + half, y - half);
    stack_point(&stack, x + half, y + half);
    stack_point(&stack, x - half, y + half);
}

/* ---- walls ---- */

static void test_a_tube_that_leans(void)
{
    static const double wall[] = {1.0, 0.3, 0.1};

    for (int i = 0; i < 3; i++) {
        make_tube(6, 2, wall[i], 1.5);
        assert_sound(0, 1, 0.01);
    }
}

static void test_a_box_with_a_thin_wall(void)
{
    for (int k = 0; k < 5; k++) {
        uint32_t const s = stack_section(&stack, 0.5 * k);
        add_box(s, 0.7 * k, 0.1 * k * k, 3.0);
        add_box(s, 0.7 * k, 0.1 * k * k, 2.8);
    }
    o.slabs.grid[0] = 40;
    o.slabs.grid[1] = 36;
    assert_sound(0, 1, 0.01);
}

/* Outline, hole, island, hole in it: two walls in each other. */
static void test_walls_in_each_other(void)
{
    make_tube(5, 4, 0.3, 0.8);
    assert_sound(0, 2, 0.01);
}

/* A tube that becomes two, which lean apart: a surface like a pair of trousers' cloth, of genus two. */
static void test_a_tube_that_branches(void)
{
    for (int k = 0; k < 6; k++) {
        uint32_t const s = stack_section(&stack, k);
        if (k < 3) {
            stack_round(&stack, s, 0, 0.6 * k, 3.0, 2.0, 60, 0, 0, 0);
            stack_round(&stack, s, 0, 0.6 * k, 2.8, 1.8, 56, 0, 0, 0);
        } else {
            for (int side = -1; side < 2; side += 2) {
                stack_round(&stack, s, side * (1.4 + 0.6 * (k - 3)), 0.6 * k, 1.3, 1.5, 44, 0, 0, 0);
                stack_round(&stack, s, side * (1.4 + 0.6 * (k - 3)), 0.6 * k, 1.1, 1.3, 40, 0, 0, 1);
            }
        }
    }
    assert_sound(-2, 1, 0.05);
}

static void test_ends_of_a_tube(void)
{
    make_tube(4, 3, 0.5, 0.9);
    for (int32_t caps = BVX_CAPS_FLAT; caps <= BVX_CAPS_TAPER; caps++) {
        o.caps = caps;
        build_good();
        TEST_ASSERT_EQUAL_UINT64(0, crossings());
        TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
        TEST_ASSERT_EQUAL_INT64(2, certificate.euler); /* a wall and a rod in it */
        assert_points_kept();
    }
}

/* ---- where levels change nothing ---- */

/* A ring that is open on one side in the next section: its hole opens there, and no wall closes it. */
static void test_a_hole_that_opens(void)
{
    uint32_t s = stack_section(&stack, 0);

    add_box(s, 0, 0, 3);
    add_box(s, 0, 0, 2);
    s = stack_section(&stack, 1);
    stack_loop(&stack, s);
    stack_point(&stack, -3, -3);
    stack_point(&stack, 3, -3);
    stack_point(&stack, 3, -2);
    stack_point(&stack, -2, -2);
    stack_point(&stack, -2, 2);
    stack_point(&stack, 3, 2);
    stack_point(&stack, 3, 3);
    stack_point(&stack, -3, 3);
    o.slabs.grid[0] = o.slabs.grid[1] = 24;
    build_good();
    TEST_ASSERT_EQUAL_UINT64(0, report.joined_slabs);
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
}

/* Holes beside each other, which have nothing in common. */
static void test_holes_that_do_not_overlap(void)
{
    for (int k = 0; k < 2; k++) {
        uint32_t const s = stack_section(&stack, k);
        add_box(s, 0, 0, 3);
        add_box(s, k == 0 ? -1.5 : 1.5, 0, 1);
    }
    o.slabs.grid[0] = o.slabs.grid[1] = 24;
    build_good();
    TEST_ASSERT_EQUAL_UINT64(0, report.joined_slabs);
}

/* Holes that cross, with no corner of one in the other. */
static void test_holes_that_cross(void)
{
    for (int k = 0; k < 2; k++) {
        uint32_t const s = stack_section(&stack, k);
        double const x = k == 0 ? 2.5 : 0.5, y = k == 0 ? 0.5 : 2.5;
        add_box(s, 0, 0, 3);
        stack_loop(&stack, s);
        stack_point(&stack, -x, -y);
        stack_point(&stack, x, -y);
        stack_point(&stack, x, y);
        stack_point(&stack, -x, y);
    }
    o.slabs.grid[0] = o.slabs.grid[1] = 24;
    assert_sound(0, 1, 0.1);
}

/* A cup: its floor is a section without a hole, so the hole ends between that and the next one. */
static void test_a_cup(void)
{
    for (int k = 0; k < 4; k++) {
        uint32_t const s = stack_section(&stack, k);
        stack_round(&stack, s, 0.15 * k, 0, 3, 3, 48, 0, 0, 0);
        if (k > 0) stack_round(&stack, s, 0.15 * k, 0, 2.8, 2.8, 48, 0, 0, 0);
    }
    assert_sound(2, 1, 0.2);
}

/* An island that only one of the sections has stays in the hole's level. */
static void test_an_island_in_one_section(void)
{
    for (int k = 0; k < 2; k++) {
        uint32_t const s = stack_section(&stack, k);
        stack_round(&stack, s, k, 0, 4, 4, 48, 0, 0, 0);
        stack_round(&stack, s, k, 0, 3.5, 3.5, 48, 0, 0, 0);
        if (k == 0) stack_round(&stack, s, k, 0, 1, 1, 24, 0, 0, 0);
    }
    assert_sound(2, 2, 0.1); /* the wall, and the island by itself */
}

/* ---- levels that would cross ---- */

static void test_walls_much_thinner_than_a_cell(void)
{
    make_tube(4, 2, 0.01, 2.0);
    o.slabs.grid[0] = o.slabs.grid[1] = 9;
    build_good();
    TEST_ASSERT_EQUAL_UINT64(3, report.joined_slabs);
    assert_points_kept();
}

static void test_only_slabs_whose_levels_cross_are_blended_whole(void)
{
    uint32_t s;

    make_tube(4, 2, 0.01, 0.0);
    s = stack_section(&stack, 4);
    stack_round(&stack, s, 1, 0.3, 4, 4, 64, 0, 0, 0);
    stack_round(&stack, s, 1, 0.3, 3.99, 3.99, 64, 0, 0, 0);
    o.slabs.grid[0] = o.slabs.grid[1] = 9;
    build_good();
    TEST_ASSERT_EQUAL_UINT64(1, report.joined_slabs);
    assert_points_kept();
}

/* ---- many of them ---- */

/* Up to three rounds in each other that are not quite round, moved at
 * random; hardly any crosses. */
static void random_walls(uint64_t *seed)
{
    int const sections = 2 + maker_below(seed, 4), rounds = 2 + maker_below(seed, 3);
    double const wall = maker_between(seed, 0.05, 0.6, 1000);

    stack_clear(&stack);
    for (int k = 0; k < sections; k++) {
        double const x = maker_between(seed, 0.0, 1.5, 1000);
        double const y = maker_between(seed, 0.0, 1.5, 1000);
        double const phase = maker_between(seed, 0.0, 1.0, 1000);
        uint32_t const s = stack_section(&stack, 0.8 * k);
        for (int i = 0; i < rounds; i++) {
            double const r = 3.0 - wall * i;
            stack_round(&stack, s, x, y, r, 0.9 * r, 20 + maker_below(seed, 60), 0.01, phase, i & 1);
        }
    }
}

static void test_random_walls(void)
{
    uint64_t seed = 4, joined = 0, good = 0, crossed = 0;
    int const all = trial_count(15, 100, 300);

    for (int i = 0; i < all; i++) {
        random_walls(&seed);
        o.slabs.grid[0] = 3 + maker_below(&seed, 40);
        o.slabs.grid[1] = 3 + maker_below(&seed, 40);
        o.caps = maker_below(&seed, 2);
        bvx_mesh_free(ctx, &mesh);
        if (bvx_build_sections(ctx, &stack.s, &o, &mesh) == BVX_ERR_FORMAT) continue; /* loops that cross */
        build_good();
        assert_points_kept();
        joined += report.joined_slabs;
        good++;
        if (report.unkept_edges + report.unkept_loops == 0) crossed += crossings() != 0;
    }
    TEST_ASSERT_TRUE(good * 2 > (uint64_t)all && crossed * 30 <= good);
    if (!quick) TEST_ASSERT_TRUE(joined * 15 > (uint64_t)all);
}

static void test_threads_change_nothing(void)
{
    bvx_context *const first = ctx;
    uint64_t one;

    make_tube(40, 4, 0.2, 0.3);
    build_good();
    one = hash();
    bvx_mesh_free(ctx, &mesh);
    for (int32_t threads = 1; threads < 6; threads += 2) {
        bvx_context_options c = {.struct_size = sizeof c};
        c.threads = threads;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &ctx));
        build_good();
        TEST_ASSERT_EQUAL_HEX64(one, hash());
        bvx_mesh_free(ctx, &mesh);
        bvx_context_destroy(ctx);
        ctx = first;
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_tube_that_leans);
    RUN_TEST(test_a_box_with_a_thin_wall);
    RUN_TEST(test_walls_in_each_other);
    RUN_TEST(test_a_tube_that_branches);
    RUN_TEST(test_ends_of_a_tube);
    RUN_TEST(test_a_hole_that_opens);
    RUN_TEST(test_holes_that_do_not_overlap);
    RUN_TEST(test_holes_that_cross);
    RUN_TEST(test_a_cup);
    RUN_TEST(test_an_island_in_one_section);
    RUN_TEST(test_walls_much_thinner_than_a_cell);
    RUN_TEST(test_only_slabs_whose_levels_cross_are_blended_whole);
    RUN_TEST(test_random_walls);
    RUN_TEST(test_threads_change_nothing);
    return UNITY_END();
}
