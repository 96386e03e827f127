/* test_plan_lods.c - bvx_plan_lods: the resolution of the solid against
 * what its rule says, on boxes whose area is known. */
#include "core/core.h"
#include "tools/mesh_maker.h"
#include "suite.h"

static maker_mesh mesh;
static bvx_mesh_view view;
static bvx_lod_options options;

static void make_box(double x, double y, double z)
{
    double const low[3] = {0, 0, 0}, high[3] = {x, y, z};
    maker_clear(&mesh);
    maker_box(&mesh, low, high);
    view = maker_view(&mesh);
}

/* The suite's context anew, with a memory limit; 0: none. */
static void open_again(uint64_t limit)
{
    bvx_context_options o = suite_options(1, BVX_CPU_BEST);
    o.memory_limit = limit;
    suite_close();
    suite_open_with(&o);
}

void setUp(void)
{
    suite_open(1);
    memset(&mesh, 0, sizeof mesh);
    options = (bvx_lod_options){.struct_size = sizeof options};
}

void tearDown(void)
{
    maker_free(&mesh);
    suite_close();
}

static int32_t planned(uint64_t count, int32_t padding, int32_t *limited)
{
    int32_t resolution = -1;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK,
                                    bvx_plan_lods(ctx, &view, &options, count, padding, &resolution, limited),
                                    bvx_last_message(ctx));
    return resolution;
}

static void test_eight_voxels_a_sample_of_the_finest_level(void)
{
    int32_t const sides[3] = {20, 48, 7}, axes[6] = {4, 9, 30, 2, 2, 2};
    int32_t limited = -1;

    make_box(3, 2, 1);
    options.resolutions = sides;
    TEST_ASSERT_EQUAL_INT32(8 * 48, planned(3, 0, &limited));
    TEST_ASSERT_EQUAL_INT32(0, limited);
    TEST_ASSERT_EQUAL_INT32(8 * 20, planned(1, 5, NULL));

    options.resolutions = NULL;
    options.axis_resolutions = axes;
    TEST_ASSERT_EQUAL_INT32(8 * 30, planned(2, 0, NULL));
}

/* A cube of side 2 has an area of 24: n samples along it see 6 n n squares, which become 18 n n triangles. */
static void test_triangles_are_judged_by_area(void)
{
    uint64_t const targets[2] = {100, 18 * 25 * 25};

    make_box(2, 2, 2);
    options.target_triangles = targets;
    TEST_ASSERT_EQUAL_INT32(8 * 25, planned(2, 0, NULL));
    options.collapse = 4;
    TEST_ASSERT_EQUAL_INT32(8 * 50, planned(2, 0, NULL));
}

/* The largest resolution whose solid has room, told by brute force. */
static void test_memory_decides_where_it_is_short(void)
{
    uint64_t const room = (UINT64_C(3) << 20) / 2;
    int32_t const finest = 100;
    int32_t expected = finest, limited = -1;

    make_box(5, 4, 3);
    open_again(0);
    uint64_t const beside = bvx_memory_used(ctx) + 16 * view.vertex_count + 4 * view.triangle_count;
    open_again(2 * room + beside);

    options.resolutions = &finest;
    for (int32_t n = finest; n <= 8 * finest; n++) {
        bvx_lattice_options o = {.struct_size = sizeof o};
        bvx_lattice lattice;
        o.resolution = n;
        o.padding = 2;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit_with(ctx, &view, &o, &lattice));
        if (8 * bvx_grid_bound(&lattice, NULL) <= room) expected = n;
    }
    TEST_ASSERT_TRUE(expected > finest && expected < 8 * finest);
    TEST_ASSERT_EQUAL_INT32(expected, planned(1, 2, &limited));
    TEST_ASSERT_EQUAL_INT32(1, limited);
}

static void test_never_below_the_finest_level_and_never_beyond_what_levels_take(void)
{
    int32_t const few = 900, many = 1 << 20;
    int32_t limited = -1;

    make_box(1, 1, 1);
    open_again(1 << 20);
    options.resolutions = &few;
    TEST_ASSERT_EQUAL_INT32(few, planned(1, 0, &limited));
    TEST_ASSERT_EQUAL_INT32(1, limited);

    options.resolutions = &many;
    TEST_ASSERT_EQUAL_INT32(many, planned(1, 0, NULL));
}

/* Without a limit a gigabyte is enough: 2048 voxels a side are exactly that. */
static void test_a_gigabyte_is_the_most(void)
{
    int32_t const fine = 1024;
    int32_t limited = -1;

    make_box(1, 1, 1);
    options.resolutions = &fine;
    TEST_ASSERT_EQUAL_INT32(2048, planned(1, 0, &limited));
    TEST_ASSERT_EQUAL_INT32(1, limited);
}

static void refused(bvx_status status, const bvx_mesh_view *v, uint64_t count, int32_t padding)
{
    int32_t resolution = -7, limited = -7;
    TEST_ASSERT_EQUAL_INT32(status, bvx_plan_lods(ctx, v, &options, count, padding, &resolution, &limited));
    TEST_ASSERT_EQUAL_INT32(-7, resolution);
    TEST_ASSERT_EQUAL_INT32(-7, limited);
}

static void test_what_cannot_be_planned_is_refused(void)
{
    int32_t const side = 8;
    uint64_t const target = 100;
    int32_t resolution = 0;
    bvx_mesh_view none;

    make_box(1, 1, 1);
    none = view;
    none.triangle_count = 0;
    refused(BVX_ERR_ARGUMENT, &view, 1, 0); /* neither resolutions nor targets */
    options.resolutions = &side;
    refused(BVX_ERR_EMPTY, &none, 1, 0);
    refused(BVX_ERR_ARGUMENT, NULL, 1, 0);
    refused(BVX_ERR_ARGUMENT, &view, 0, 0);
    refused(BVX_ERR_ARGUMENT, &view, 1, -1);
    refused(BVX_ERR_ARGUMENT, &view, 1, 65537);
    options.target_triangles = &target;
    refused(BVX_ERR_ARGUMENT, &view, 1, 0); /* both */
    options.resolutions = NULL;
    options.collapse = 0.5;
    refused(BVX_ERR_ARGUMENT, &view, 1, 0);
    options.collapse = 0;

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_plan_lods(NULL, &view, &options, 1, 0, &resolution, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_plan_lods(ctx, &view, NULL, 1, 0, &resolution, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_plan_lods(ctx, &view, &options, 1, 0, NULL, NULL));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_eight_voxels_a_sample_of_the_finest_level);
    RUN_TEST(test_triangles_are_judged_by_area);
    RUN_TEST(test_memory_decides_where_it_is_short);
    RUN_TEST(test_never_below_the_finest_level_and_never_beyond_what_levels_take);
    RUN_TEST(test_a_gigabyte_is_the_most);
    RUN_TEST(test_what_cannot_be_planned_is_refused);
    return UNITY_END();
}
