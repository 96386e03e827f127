/* test_solid_losses.c - what a solid says of walls that its voxels lose, and of its volume. */
#include "solid_support.h"

#include <math.h>

static bvx_solid_report report;
static bvx_lattice lattice;

/* The mesh's voxels at a resolution, with the report; check: check_thin. */
static uint64_t voxels_at(bvx_context *c, int32_t resolution, int32_t check)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};
    uint64_t n;

    o.check_thin = BVX_CHECK_NEVER + check;
    o.report = &report;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(c, &view, resolution, &lattice));
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_voxelize_solid(c, &view, &lattice, &o, &g),
                                    bvx_last_message(c));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(c, &g, &n));
    bvx_grid_free(c, &g);
    return n;
}

static void make_ball(double radius)
{
    double const centre[3] = {0, 0, 0}, r[3] = {radius, radius, radius};

    seed = 1;
    maker_star(&mesh, &seed, centre, r, 0, 48, 72, 65536);
}

/* A ball of radius 1 with a cavity, its wall thick. [Units: voxels at a resolution] */
static void make_shell(double voxels, int32_t resolution)
{
    size_t outer;

    maker_clear(&mesh);
    make_ball(1.0);
    outer = mesh.triangles;
    make_ball(1.0 - voxels * 2.0 / resolution);
    maker_flip(&mesh, outer, mesh.triangles);
}

static void make_box(double x, double y, double z)
{
    double const low[3] = {0, 0, 0}, high[3] = {x, y, z};

    maker_box(&mesh, low, high);
}

/* A block with a plate across axis beside it, so that the lattice is not the plate's. */
static void make_block_and_plate(int32_t axis, double thick)
{
    double low[3] = {2.5, 2.5, 2.5}, high[3] = {5, 5, 5};

    maker_clear(&mesh);
    make_box(2, 2, 2);
    low[axis] = 3.06;
    high[axis] = 3.06 + thick;
    maker_box(&mesh, low, high);
}

static void test_shells_of_thin_walls_are_told(void)
{
    static const double walls[] = {0.3, 0.5, 0.9};

    for (size_t w = 0; w < sizeof walls / sizeof walls[0]; w++) {
        make_shell(walls[w], 48);
        voxels_at(ctx, 48, -1);
        TEST_ASSERT_EQUAL_INT32(1, report.thin_checked);
        TEST_ASSERT_TRUE(report.thin_voxels > 100);
        TEST_ASSERT_TRUE(fabs(report.thin_resolution / (48 * 1.5 / walls[w]) - 1.0) < 0.3);
    }
    make_shell(1.6, 48);
    voxels_at(ctx, 48, 1);
    TEST_ASSERT_EQUAL_INT32(1, report.thin_checked);
    TEST_ASSERT_EQUAL_UINT64(0, report.thin_voxels);
    TEST_ASSERT_TRUE(report.thin_resolution == 0);
}

static void test_plates_across_any_axis_are_told_with_their_place(void)
{
    for (int32_t axis = 0; axis < 3; axis++) {
        make_block_and_plate(axis, 0.04);
        TEST_ASSERT_TRUE(voxels_at(ctx, 50, -1) == 20 * 20 * 20); /* voxels of a tenth: the plate has none */
        TEST_ASSERT_TRUE(report.thin_checked == 1 && report.thin_voxels >= 25 * 25 - 2 * 25);
        for (int32_t a = 0; a < 3; a++) {
            int32_t const low = a == axis ? 30 : 25, high = a == axis ? 31 : 49;

            TEST_ASSERT_TRUE(report.thin_box[0][a] >= low - 1 && report.thin_box[0][a] <= low + 1);
            TEST_ASSERT_TRUE(report.thin_box[1][a] >= high - 1 && report.thin_box[1][a] <= high);
        }
        TEST_ASSERT_INT32_WITHIN(2, 188, report.thin_resolution);

        voxels_at(ctx, report.thin_resolution, 1);
        TEST_ASSERT_EQUAL_UINT64(0, report.thin_voxels);
        voxels_at(ctx, 50, 0);
        TEST_ASSERT_TRUE(report.thin_checked == 0 && report.thin_voxels == 0);
    }
}

/* A fin of a few voxels beside a block of many: a thousandth of the lines of centres that the mesh
 * crosses. */
static void test_small_losses_are_told_by_default(void)
{
    for (int32_t axis = 0; axis < 3; axis++) {
        double low[3] = {2.03, 2.03, 2.03}, high[3] = {2.45, 2.45, 2.45};

        maker_clear(&mesh);
        make_box(5, 5, 5);
        for (int a = 0; a < 3; a++) low[a] += 3, high[a] += 3; /* it touches nothing */
        high[axis] = low[axis] + 0.016; /* from 0.5.. of a voxel of 0.1: between two centres */
        maker_box(&mesh, low, high);
        voxels_at(ctx, 54, -1);
        TEST_ASSERT_TRUE(report.thin_checked == 1 && report.thin_voxels >= 8 && report.thin_voxels < 60);
    }
}

static void test_thick_bodies_lose_nothing_and_keep_their_volume(void)
{
    maker_clear(&mesh);
    make_ball(1.0);
    voxels_at(ctx, 48, -1);
    TEST_ASSERT_TRUE(report.thin_checked == 1 && report.thin_voxels == 0);
    TEST_ASSERT_TRUE(report.mesh_volume > 3.8 && report.mesh_volume < 4.0);
    TEST_ASSERT_TRUE(fabs(report.volume / report.mesh_volume - 1.0) < 0.01);
    voxels_at(ctx, 48, 1);
    TEST_ASSERT_TRUE(report.thin_checked == 1 && report.thin_voxels == 0);

    maker_clear(&mesh);
    make_box(3, 2, 1);
    TEST_ASSERT_EQUAL_UINT64(30 * 20 * 10, voxels_at(ctx, 30, 1));
    TEST_ASSERT_TRUE(fabs(report.volume - 6.0) < 1e-9 && fabs(report.mesh_volume - 6.0) < 1e-9);
    TEST_ASSERT_EQUAL_UINT64(0, report.thin_voxels);
}

/* Where the volumes say nothing of what was lost there is no volume to compare. */
static void test_volumes_are_compared_where_they_can_be(void)
{
    bvx_mesh_view view;
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_window const part = {{0, 0, 0}, {30, 20, 9}};
    bvx_grid g = {0};

    maker_clear(&mesh);
    make_box(3, 2, 1);
    view = maker_view(&mesh);
    voxels_at(ctx, 30, 1);
    o.report = &report;
    o.window = part;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &lattice, &o, &g));
    TEST_ASSERT_TRUE(report.mesh_volume == 0 && fabs(report.volume - 5.4) < 1e-9 && report.thin_checked == 0);
    bvx_grid_free(ctx, &g);

    memset(&o.window, 0, sizeof o.window);
    o.add_shell = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &lattice, &o, &g));
    TEST_ASSERT_TRUE(report.mesh_volume == 0 && report.crossing_volume == 0 && report.volume > 5.999);
    bvx_grid_free(ctx, &g);

    o.add_shell = 0;
    o.fill = BVX_FILL_VOTE;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &lattice, &o, &g));
    TEST_ASSERT_TRUE(report.mesh_volume == 0 && fabs(report.volume - 6.0) < 1e-9);
    bvx_grid_free(ctx, &g);

    maker_remove(&mesh, 3); /* open */
    voxels_at(ctx, 30, 1);
    TEST_ASSERT_TRUE(report.mesh_volume == 0 && report.volume > 5.0);
}

/* By how much a is more than b. */
static double part_more(double a, double b)
{
    return a / b - 1.0;
}

/* A box whose sides are no whole numbers of voxels is off by up to half a voxel a side; the crossings know by how
 * much, whatever way triangles run, and the resolution that is named is right. */
static void test_volumes_are_right_where_lines_of_centres_cross(void)
{
    static const double sides[4][3] = {
        {3.0, 2.06, 1.04}, {3.0, 2.05, 1.05}, {3.0, 0.949, 0.751}, {3.0, 0.31, 2.0}};

    for (int flipped = 0; flipped < 2; flipped++)
        for (int i = 0; i < 4; i++) {
            double const true_volume = sides[i][0] * sides[i][1] * sides[i][2];
            double off;

            maker_clear(&mesh);
            make_box(sides[i][0], sides[i][1], sides[i][2]);
            if (flipped) maker_flip(&mesh, 3, 4);
            voxels_at(ctx, 30, -1);
            off = part_more(report.volume, true_volume);
            TEST_ASSERT_TRUE(flipped == (report.mesh_volume == 0) && fabs(off) > 0.01);
            TEST_ASSERT_TRUE(fabs(part_more(report.crossing_volume, true_volume)) < 1e-4);
            TEST_ASSERT_TRUE(report.volume_resolution > 30 && report.volume_resolution < 1500);

            /* of the voxels' side alone, half a voxel on each face is a per cent there at most */
            voxels_at(ctx, report.volume_resolution, -1);
            TEST_ASSERT_TRUE(fabs(part_more(report.volume, true_volume)) <= 0.01);
            TEST_ASSERT_TRUE(fabs(part_more(report.crossing_volume, true_volume)) < 1e-4);
            TEST_ASSERT_EQUAL_INT32(0, report.volume_resolution);
        }
}

/* Overlaps and cavities, where the mesh's own sum says nothing. */
static void test_crossings_know_the_volume_of_overlapping_bodies(void)
{
    double const low[3] = {1.03, 0.52, 0.27}, high[3] = {4.51, 1.37, 3.02};
    double const joined = 3 * 2.06 * 1.04 + 3.48 * 0.85 * 2.75 - (3 - 1.03) * 0.85 * (1.04 - 0.27);

    maker_clear(&mesh);
    make_box(3, 2.06, 1.04);
    maker_box(&mesh, low, high);
    voxels_at(ctx, 33, -1);
    TEST_ASSERT_EQUAL_INT32(BVX_FILL_REASON_OVERLAP, report.fill_reason);
    TEST_ASSERT_TRUE(report.mesh_volume == 0 && fabs(part_more(report.volume, joined)) > 0.01);
    TEST_ASSERT_TRUE(fabs(part_more(report.crossing_volume, joined)) < 0.003);
    TEST_ASSERT_TRUE(report.volume_resolution > 33);

    maker_clear(&mesh);
    make_shell(3, 48);
    voxels_at(ctx, 48, -1);
    TEST_ASSERT_TRUE(fabs(part_more(report.crossing_volume, report.mesh_volume)) < 0.004);
}

/* Enough triangles and words for several pieces of each step. */
static void test_workers_in_turns_tell_the_same(void)
{
    int32_t workers = MANY_WORKERS;
    bvx_context *const turns = context_in_turns(&workers);
    bvx_solid_report first;

    for (int holes = 0; holes < 2; holes++) {
        make_shell(0.9, 160);
        if (holes) mesh.triangles -= 40;
        voxels_at(ctx, 160, 1);
        TEST_ASSERT_TRUE(report.thin_voxels > 1000);
        first = report;
        voxels_at(turns, 160, 1);
        TEST_ASSERT_EQUAL_MEMORY(&first, &report, sizeof report);
    }
    bvx_context_destroy(turns);
}

/* Also in a window, and whatever unused vertices are; threads, the fast
 * code and the order of triangles do not show. */
static void test_what_is_told_depends_on_mesh_and_lattice(void)
{
    bvx_context *const threads = suite_context(3, BVX_CPU_BEST);
    bvx_context *const portable = suite_context(1, BVX_CPU_PORTABLE);
    bvx_solid_report first;
    bvx_window const part = {{20, 20, 20}, {30, 30, 11}};
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_mesh_view view;
    bvx_grid g = {0};

    make_block_and_plate(2, 0.04);
    voxels_at(ctx, 50, 1);
    first = report;
    voxels_at(threads, 50, 1);
    TEST_ASSERT_EQUAL_MEMORY(&first, &report, sizeof report);
    TEST_ASSERT_TRUE(fabs(report.crossing_volume - 8.0) < 1e-3);
    voxels_at(portable, 50, 1);
    TEST_ASSERT_EQUAL_MEMORY(&first, &report, sizeof report);

    o.report = &report;
    o.check_thin = BVX_CHECK_ALWAYS;
    o.window = part;
    maker_shuffle_triangles(&mesh, &seed);
    maker_vertex(&mesh, (double)NAN, 0, (double)INFINITY);
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_voxelize_solid(ctx, &view, &lattice, &o, &g),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(first.thin_voxels, report.thin_voxels);
    TEST_ASSERT_TRUE(first.thin_resolution == report.thin_resolution);
    TEST_ASSERT_EQUAL_MEMORY(first.thin_box, report.thin_box, sizeof first.thin_box);
    bvx_grid_free(ctx, &g);
    bvx_context_destroy(portable);
    bvx_context_destroy(threads);
}

static void test_walls_are_not_looked_for_below_a_terrain(void)
{
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_mesh_view view;
    bvx_grid g = {0};

    maker_clear(&mesh);
    make_box(3, 2, 1);
    voxels_at(ctx, 30, 0);
    view = maker_view(&mesh);
    o.fill = BVX_FILL_BELOW;
    o.report = &report;
    o.check_thin = BVX_CHECK_ALWAYS;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &view, &lattice, &o, &g));
    o.check_thin = BVX_CHECK_AUTO;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &lattice, &o, &g));
    TEST_ASSERT_TRUE(report.thin_checked == 0 && report.mesh_volume == 0 && report.volume > 5.9);
    bvx_grid_free(ctx, &g);
}

/* A solid that the limit allows is made; nobody has requested the look that it does not. */
static void test_a_limit_leaves_the_look_out_unless_asked_for(void)
{
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_context *limited = NULL;
    bvx_voxelize_options v = {.struct_size = sizeof v};
    bvx_mesh_view view;
    bvx_grid g = {0};
    uint64_t without, voxels;

    make_shell(0.5, 48);
    bvx_memory_reset_peak(ctx);
    voxels = voxels_at(ctx, 48, 0);
    without = bvx_memory_peak(ctx);
    bvx_memory_reset_peak(ctx);
    voxels_at(ctx, 48, 1);
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) > without);

    o.threads = 1;
    o.memory_limit = without;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &limited));
    TEST_ASSERT_EQUAL_UINT64(voxels, voxels_at(limited, 48, -1));
    TEST_ASSERT_TRUE(report.thin_checked == 0 && report.thin_voxels == 0 && report.volume > 0);

    view = maker_view(&mesh);
    v.report = &report;
    v.check_thin = BVX_CHECK_ALWAYS;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_BUDGET, bvx_voxelize_solid(limited, &view, &lattice, &v, &g));
    TEST_ASSERT_NULL(g.words);
    bvx_context_destroy(limited);
}

/* Where every wall is thin, all triangles are near to one: what docs/rules.md says, but for small tables. */
static void test_walls_that_are_all_thin_take_the_memory_that_is_told(void)
{
    int32_t const resolution = 24;
    uint64_t const used = bvx_memory_used(ctx);
    uint64_t places, formula;
    bvx_mesh_view view;

    make_shell(0.02, resolution);
    view = maker_view(&mesh);
    bvx_memory_reset_peak(ctx);
    voxels_at(ctx, resolution, 1);
    places = report.thin_voxels;
    TEST_ASSERT_TRUE(places > 1000 && view.triangle_count > 1000);
    formula = 2 * 8 * bvx_grid_bound(&lattice, NULL) + 121 * view.triangle_count + 32 * places + 16384;
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - used <= formula);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_shells_of_thin_walls_are_told);
    RUN_TEST(test_plates_across_any_axis_are_told_with_their_place);
    RUN_TEST(test_small_losses_are_told_by_default);
    RUN_TEST(test_thick_bodies_lose_nothing_and_keep_their_volume);
    RUN_TEST(test_volumes_are_compared_where_they_can_be);
    RUN_TEST(test_volumes_are_right_where_lines_of_centres_cross);
    RUN_TEST(test_crossings_know_the_volume_of_overlapping_bodies);
    RUN_TEST(test_workers_in_turns_tell_the_same);
    RUN_TEST(test_what_is_told_depends_on_mesh_and_lattice);
    RUN_TEST(test_walls_are_not_looked_for_below_a_terrain);
    RUN_TEST(test_a_limit_leaves_the_look_out_unless_asked_for);
    RUN_TEST(test_walls_that_are_all_thin_take_the_memory_that_is_told);
    return UNITY_END();
}
