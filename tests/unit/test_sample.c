/* test_sample.c - trilinear samples against the formula of eight corners, gradients against differences. */
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

static uint64_t seed;
static bvx_grid grid;

void setUp(void)
{
    suite_open(0);
    seed = 31337;
}

void tearDown(void)
{
    bvx_grid_free(ctx, &grid);
    suite_close();
}

static void make_grid(const double origin[3], const double spacing[3], const int32_t low[3],
                      const int32_t size[3])
{
    int32_t const dims[3] = {low[0] + size[0] + 2, low[1] + size[1] + 1, low[2] + size[2]};
    bvx_window w;
    bvx_lattice l;

    memcpy(w.low, low, sizeof w.low);
    memcpy(w.size, size, sizeof w.size);
    bvx_grid_free(ctx, &grid);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, &w, &grid));
    for (int32_t z = 0; z < size[2]; z++)
        for (int32_t y = 0; y < size[1]; y++)
            for (int32_t x = 0; x < size[0]; x++) bvx_grid_set(&grid, x, y, z, maker_below(&seed, 2));
}

static int bit(int32_t x, int32_t y, int32_t z)
{
    int32_t const v[3] = {x - grid.low[0], y - grid.low[1], z - grid.low[2]};
    for (int a = 0; a < 3; a++)
        if (v[a] < 0 || v[a] >= grid.size[a]) return 0;
    return bvx_grid_get(&grid, v[0], v[1], v[2]);
}

/* Each voxel counts by the product of what is left to 1 of its distances along the axes. */
static double eight_corners(const double p[3], double gradient[3])
{
    double x[3], value = 0.0;
    int32_t first[3];

    for (int a = 0; a < 3; a++) {
        x[a] = (p[a] - grid.lattice.origin[a]) / grid.lattice.spacing[a] - 0.5;
        first[a] = (int32_t)floor(x[a]);
        gradient[a] = 0.0;
    }
    for (int32_t c = 0; c < 8; c++) {
        int32_t const v[3] = {first[0] + (c & 1), first[1] + (c >> 1 & 1), first[2] + (c >> 2)};
        double weight[3], slope[3];
        if (!bit(v[0], v[1], v[2])) continue;
        for (int a = 0; a < 3; a++) {
            weight[a] = 1.0 - fabs(x[a] - v[a]);
            slope[a] = (v[a] > first[a] ? 1.0 : -1.0) / grid.lattice.spacing[a];
        }
        value += weight[0] * weight[1] * weight[2];
        for (int a = 0; a < 3; a++) gradient[a] += slope[a] * weight[(a + 1) % 3] * weight[(a + 2) % 3];
    }
    return value;
}

static void random_grid(void)
{
    static const int32_t sides[7] = {1, 63, 64, 65, 127, 128, 129};
    double origin[3], spacing[3];
    int32_t low[3], size[3];

    for (int a = 0; a < 3; a++) {
        origin[a] = maker_between(&seed, -50, 50, 1000);
        spacing[a] = maker_between(&seed, 0.1, 3, 1000);
        low[a] = maker_below(&seed, 70);
        size[a] = a == 0 ? sides[maker_below(&seed, 7)] : 1 + maker_below(&seed, 9);
    }
    make_grid(origin, spacing, low, size);
}

static void test_sample_equals_eight_corners(void)
{
    int inside = 0;

    for (int round = 0; round < 60; round++) {
        random_grid();
        for (int i = 0; i < 200; i++) {
            double p[3], want_gradient[3], gradient[3], value, alone;
            for (int a = 0; a < 3; a++) {
                double const place = grid.low[a] + maker_between(&seed, -2, grid.size[a] + 2, 10000);
                p[a] = grid.lattice.origin[a] + grid.lattice.spacing[a] * place;
            }
            double const want = eight_corners(p, want_gradient);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_sample(ctx, &grid, p, 1, &value, gradient));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_sample(ctx, &grid, p, 1, &alone, NULL));
            TEST_ASSERT_EQUAL_MEMORY(&value, &alone, sizeof value);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, want, value);
            TEST_ASSERT_TRUE(value >= 0.0 && value <= 1.0);
            for (int a = 0; a < 3; a++) TEST_ASSERT_DOUBLE_WITHIN(1e-10, want_gradient[a], gradient[a]);
            inside += value > 0.0 && value < 1.0;
        }
    }
    TEST_ASSERT_TRUE(inside > 3000);
}

/* Half a voxel from the centres along one axis the value is the mean of
 * two, and the gradient the difference of both. */
static void test_sample_by_hand(void)
{
    static const double origin[3] = {10, 20, 30}, spacing[3] = {2, 4, 0.5};
    static const int32_t low[3] = {0, 0, 0}, size[3] = {3, 1, 1};
    static const double points[15] = {11,    22, 30.25, 12,    22, 30.25, 12.5, 22,
                                      30.25, 10, 22,    30.25, 11, 24,    30.25};
    static const double values[5] = {1, 0.5, 0.25, 0.5, 0.5}, slopes[5] = {-0.5, -0.5, -0.5, 0.5, -0.25};
    double got[5], gradient[15];

    make_grid(origin, spacing, low, size);
    bvx_grid_set(&grid, 0, 0, 0, 1);
    bvx_grid_set(&grid, 1, 0, 0, 0);
    bvx_grid_set(&grid, 2, 0, 0, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_sample(ctx, &grid, points, 5, got, gradient));
    for (int i = 0; i < 5; i++) {
        TEST_ASSERT_TRUE(got[i] == values[i]);
        TEST_ASSERT_TRUE(gradient[3 * i] == slopes[i]);
    }
    /* a centre: the slope of the upper side */
    TEST_ASSERT_TRUE(gradient[1] == -0.25 && gradient[2] == -2.0);
    TEST_ASSERT_TRUE(gradient[13] == -0.25 && gradient[14] == -1.0); /* at the window's upper side */
}

static void test_sample_is_exact_at_centres(void)
{
    static const double origin[3] = {-3.5, 8, 0.25}, spacing[3] = {0.5, 2, 0.125};
    static const int32_t low[3] = {70, 3, 5}, size[3] = {130, 6, 5};
    double value;

    make_grid(origin, spacing, low, size);
    for (int32_t z = -2; z < size[2] + 2; z++)
        for (int32_t y = -2; y < size[1] + 2; y++)
            for (int32_t x = -2; x < size[0] + 2; x++) {
                double const p[3] = {origin[0] + (low[0] + x + 0.5) * spacing[0],
                                     origin[1] + (low[1] + y + 0.5) * spacing[1],
                                     origin[2] + (low[2] + z + 0.5) * spacing[2]};
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_sample(ctx, &grid, p, 1, &value, NULL));
                TEST_ASSERT_TRUE(value == (double)bit(low[0] + x, low[1] + y, low[2] + z));
            }
}

static void test_sample_is_zero_far_away(void)
{
    static const double far[4] = {1e18, -1e18, 1.7e308, -1.7e308};

    random_grid();
    for (int i = 0; i < 12; i++) {
        double p[3] = {0, 0, 0}, value = 7, gradient[3] = {7, 7, 7};
        for (int a = 0; a < 3; a++)
            p[a] = grid.lattice.origin[a] + grid.lattice.spacing[a] * (grid.low[a] + 0.5);
        p[i % 3] = far[i / 3];
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_sample(ctx, &grid, p, 1, &value, gradient));
        TEST_ASSERT_TRUE(value == 0.0 && gradient[0] == 0.0 && gradient[1] == 0.0 && gradient[2] == 0.0);
    }
}

static void test_sample_is_the_same_for_any_threads(void)
{
    enum { POINTS = 5000 };
    static double points[3 * POINTS], one[4 * POINTS], many[4 * POINTS];
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t low[3] = {0, 0, 0}, size[3] = {40, 40, 40};
    bvx_context_options o = {.struct_size = sizeof o};
    make_grid(origin, spacing, low, size);
    for (int i = 0; i < 3 * POINTS; i++) points[i] = maker_between(&seed, -1, 41, 977);
    for (o.threads = 1; o.threads <= 8; o.threads++) {
        bvx_context *other;
        double *const to = o.threads == 1 ? one : many;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &other));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_sample(other, &grid, points, POINTS, to, to + POINTS));
        if (o.threads > 1) TEST_ASSERT_EQUAL_MEMORY(one, many, sizeof one);
        bvx_context_destroy(other);
    }
}

static void test_sample_refuses(void)
{
    double points[6] = {0, 0, 0, 1, 2, 3}, values[2];
    bvx_grid good;

    random_grid();
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_sample(ctx, &grid, NULL, 0, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_sample(NULL, &grid, points, 2, values, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_sample(ctx, NULL, points, 2, values, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_sample(ctx, &grid, NULL, 2, values, NULL));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "points is NULL"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_sample(ctx, &grid, points, 2, NULL, NULL));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "values is NULL"));
    points[4] = nan("");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_grid_sample(ctx, &grid, points, 2, values, NULL));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "point 1 has y = nan"));
    points[0] = -HUGE_VAL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_grid_sample(ctx, &grid, points, 2, values, NULL));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "point 0 has x = -inf"));
    good = grid;
    grid.words = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_sample(ctx, &grid, points + 3, 1, values, NULL));
    grid = good;
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_sample_equals_eight_corners);
    RUN_TEST(test_sample_by_hand);
    RUN_TEST(test_sample_is_exact_at_centres);
    RUN_TEST(test_sample_is_zero_far_away);
    RUN_TEST(test_sample_is_the_same_for_any_threads);
    RUN_TEST(test_sample_refuses);
    return UNITY_END();
}
