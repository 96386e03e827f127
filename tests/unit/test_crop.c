/* test_crop.c - content, crop, pad, permute and resample, against looking at each voxel. */
#include "algebra_support.h"
#include "grid/grid.h"

#include <math.h>

static bvx_grid grid, made;

void setUp(void)
{
    suite_open(1);
    seed = 5;
}

void tearDown(void)
{
    bvx_grid_free(ctx, &grid);
    bvx_grid_free(ctx, &made);
    suite_close();
}

static void make_grid(int32_t x, int32_t y, int32_t z, int32_t percent)
{
    static const int32_t low[3] = {70, 2, 3}, more[3] = {66, 3, 2};
    int32_t const size[3] = {x, y, z};
    bvx_grid_free(ctx, &grid);
    grid = algebra_grid(size, low, more);
    algebra_scatter(&grid, percent);
}

/* Every voxel of made is voxel + from of grid, and nothing lies beyond its rows. */
static void expect_moved(const int32_t from[3])
{
    uint64_t count, seen = 0;

    for (int32_t z = 0; z < made.size[2]; z++)
        for (int32_t y = 0; y < made.size[1]; y++)
            for (int32_t x = 0; x < made.size[0]; x++) {
                TEST_ASSERT_EQUAL_INT(algebra_get(&grid, x + from[0], y + from[1], z + from[2]),
                                      bvx_grid_get(&made, x, y, z));
                seen += (uint64_t)bvx_grid_get(&made, x, y, z);
            }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &made, &count));
    TEST_ASSERT_EQUAL_UINT64(seen, count);
}

static void test_crop_equals_each_voxel(void)
{
    static const int32_t moves[] = {-70, -65, -64, -63, -1, 0, 1, 30, 63, 64, 65};

    for (int s = 0; s < ALGEBRA_SIZES; s++)
        for (int t = 0; t < ALGEBRA_SIZES; t++)
            for (size_t m = 0; m < sizeof moves / sizeof *moves; m++) {
                bvx_window const w = {{70 + moves[m], 1, 4}, {algebra_sizes[t], 5, 3}};
                int32_t const from[3] = {moves[m], -1, 1};
                make_grid(algebra_sizes[s], 4, 4, 50);
                bvx_status const status = bvx_grid_crop(ctx, &grid, &w, &made);
                int const inside = w.low[0] + w.size[0] <= grid.lattice.dims[0];
                TEST_ASSERT_EQUAL_INT32(inside ? BVX_OK : BVX_ERR_RANGE, status);
                if (inside) {
                    TEST_ASSERT_EQUAL_INT32_ARRAY(w.low, made.low, 3);
                    TEST_ASSERT_EQUAL_INT32_ARRAY(w.size, made.size, 3);
                    expect_moved(from);
                }
                bvx_grid_free(ctx, &made);
            }
}

static void test_crop_to_the_whole_and_back(void)
{
    bvx_grid whole = {0};
    bvx_window window;

    make_grid(65, 4, 4, 50);
    memcpy(window.low, grid.low, sizeof window.low);
    memcpy(window.size, grid.size, sizeof window.size);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_crop(ctx, &grid, NULL, &whole));
    TEST_ASSERT_EQUAL_INT32_ARRAY(grid.lattice.dims, whole.size, 3);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_crop(ctx, &whole, &window, &made));
    algebra_expect_equal(&grid, &made);
    bvx_grid_free(ctx, &whole);
}

static void test_pad_moves_nothing_in_the_world(void)
{
    static const int32_t low[3] = {65, 1, 0}, high[3] = {3, 0, 2}, none[3] = {0, 0, 0};
    static const int32_t from[3] = {-65, -1, 0};

    for (int s = 0; s < ALGEBRA_SIZES; s++) {
        make_grid(algebra_sizes[s], 3, 2, 50);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_pad(ctx, &grid, low, high, &made));
        for (int a = 0; a < 3; a++) {
            TEST_ASSERT_EQUAL_INT32(grid.lattice.dims[a] + low[a] + high[a], made.lattice.dims[a]);
            TEST_ASSERT_EQUAL_INT32(grid.size[a] + low[a] + high[a], made.size[a]);
            TEST_ASSERT_EQUAL_DOUBLE(grid.lattice.origin[a] + grid.low[a] * grid.lattice.spacing[a],
                                     made.lattice.origin[a] +
                                         (made.low[a] + low[a]) * made.lattice.spacing[a]);
        }
        expect_moved(from);
        bvx_grid_free(ctx, &made);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_pad(ctx, &grid, none, none, &made));
        algebra_expect_equal(&grid, &made);
        bvx_grid_free(ctx, &made);
    }
}

static void expect_content(void)
{
    int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, high[3] = {-1, -1, -1};
    bvx_window w, want;

    memset(&want, 0, sizeof want);
    memset(&w, 0x55, sizeof w);
    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++) {
                int32_t const at[3] = {x, y, z};
                for (int a = 0; a < 3 && bvx_grid_get(&grid, x, y, z); a++) {
                    low[a] = at[a] < low[a] ? at[a] : low[a];
                    high[a] = at[a] > high[a] ? at[a] : high[a];
                }
            }
    for (int a = 0; a < 3 && high[0] >= 0; a++) {
        want.low[a] = grid.low[a] + low[a];
        want.size[a] = high[a] - low[a] + 1;
    }
    bvxi_grid_content(&grid, &w);
    TEST_ASSERT_EQUAL_MEMORY(&want, &w, sizeof w);
}

static void test_content_equals_each_voxel(void)
{
    for (int s = 0; s < ALGEBRA_SIZES; s++)
        for (int n = 0; n < 4; n++) {
            make_grid(algebra_sizes[s], 9, 8, 0);
            expect_content();
            for (int i = 0; i < n; i++)
                bvx_grid_set(&grid, maker_below(&seed, algebra_sizes[s]), maker_below(&seed, 9),
                             maker_below(&seed, 8), 1);
            expect_content();
        }
    make_grid(300, 60, 40, 0); /* several pieces */
    bvx_grid_set(&grid, 200, 59, 1, 1);
    bvx_grid_set(&grid, 3, 7, 39, 1);
    expect_content();
}

static void expect_permuted(const int32_t axes[3], const int32_t flips[3])
{
    int32_t at[3], from[3];
    uint64_t count, all;

    for (int a = 0; a < 3; a++) {
        int32_t const low = flips[a] ? grid.lattice.dims[axes[a]] - grid.low[axes[a]] - grid.size[axes[a]]
                                     : grid.low[axes[a]];
        TEST_ASSERT_EQUAL_INT32(grid.size[axes[a]], made.size[a]);
        TEST_ASSERT_EQUAL_INT32(grid.lattice.dims[axes[a]], made.lattice.dims[a]);
        TEST_ASSERT_EQUAL_DOUBLE(grid.lattice.spacing[axes[a]], made.lattice.spacing[a]);
        TEST_ASSERT_EQUAL_DOUBLE(grid.lattice.origin[axes[a]], made.lattice.origin[a]);
        TEST_ASSERT_EQUAL_INT32(low, made.low[a]);
    }
    for (at[2] = 0; at[2] < made.size[2]; at[2]++)
        for (at[1] = 0; at[1] < made.size[1]; at[1]++)
            for (at[0] = 0; at[0] < made.size[0]; at[0]++) {
                for (int a = 0; a < 3; a++) from[axes[a]] = flips[a] ? made.size[a] - 1 - at[a] : at[a];
                TEST_ASSERT_EQUAL_INT(bvx_grid_get(&grid, from[0], from[1], from[2]),
                                      bvx_grid_get(&made, at[0], at[1], at[2]));
            }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &grid, &all));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &made, &count));
    TEST_ASSERT_EQUAL_UINT64(all, count);
}

static void test_permute_equals_each_voxel(void)
{
    static const int32_t order[6][3] = {{0, 1, 2}, {0, 2, 1}, {1, 0, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}};
    static const int32_t shapes[][3] = {{1, 2, 3},    {63, 4, 65},  {64, 64, 2}, {65, 3, 5},
                                        {127, 66, 2}, {128, 2, 64}, {129, 5, 3}};

    for (int s = 0; s < (quick ? 4 : 7); s++)
        for (int o = 0; o < 6; o++)
            for (int f = 0; f < 8; f++) {
                int32_t const flips[3] = {f & 1, f >> 1 & 1, f >> 2};
                make_grid(shapes[s][0], shapes[s][1], shapes[s][2], 50);
                TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                        bvx_grid_permute(ctx, &grid, order[o], f != 0 ? flips : NULL, &made));
                expect_permuted(order[o], flips);
                bvx_grid_free(ctx, &made);
            }
}

static void test_resample_equals_each_voxel(void)
{
    static const double scales[] = {1.0, 0.5, 0.25, 1.0 / 3.0, 2.0, 3.0, 0.7, 1.9};

    for (int s = 0; s < ALGEBRA_SIZES; s++)
        for (size_t n = 0; n < sizeof scales / sizeof *scales; n++)
            for (int moved = 0; moved < 3; moved++) {
                int32_t const dims[3] = {130, 11, 9};
                bvx_window const window = {{moved, 0, 1}, {130 - 2 * moved, 10, 8}};
                double origin[3], spacing[3];
                bvx_lattice l;
                make_grid(algebra_sizes[s], 6, 5, 50);
                for (int a = 0; a < 3; a++) {
                    spacing[a] = grid.lattice.spacing[a] * scales[n];
                    origin[a] = grid.lattice.origin[a] + (grid.low[a] - moved) * grid.lattice.spacing[a];
                }
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_resample(ctx, &grid, &l, &window, &made));
                for (int32_t z = 0; z < made.size[2]; z++)
                    for (int32_t y = 0; y < made.size[1]; y++)
                        for (int32_t x = 0; x < made.size[0]; x++) {
                            int32_t const at[3] = {x, y, z};
                            double v[3];
                            for (int a = 0; a < 3; a++) {
                                double const centre = origin[a] +
                                                      ((double)(window.low[a] + at[a]) + 0.5) * spacing[a];
                                v[a] = floor((centre - grid.lattice.origin[a]) / grid.lattice.spacing[a]) -
                                       grid.low[a];
                            }
                            TEST_ASSERT_EQUAL_INT(
                                algebra_get(&grid, (int32_t)v[0], (int32_t)v[1], (int32_t)v[2]),
                                bvx_grid_get(&made, x, y, z));
                        }
                bvx_grid_free(ctx, &made);
            }
}

static void test_resample_of_far_lattices_is_empty(void)
{
    double const origin[3] = {1e300, -1e300, 0}, spacing[3] = {1e300, 1e-300, 5};
    int32_t const dims[3] = {70, 3, 3};
    uint64_t count;
    bvx_lattice l;

    make_grid(65, 3, 3, 100);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_resample(ctx, &grid, &l, NULL, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &made, &count));
    TEST_ASSERT_EQUAL_UINT64(0, count);
}

/* Rows are shared between pieces: the same for any threads. */
static void test_moves_are_the_same_for_any_threads(void)
{
    static const int32_t axes[3] = {2, 0, 1}, flips[3] = {1, 0, 1}, low[3] = {7, 1, 1}, high[3] = {1, 2, 3};
    bvx_context *const many = suite_context(3, BVX_CPU_BEST);
    bvx_lattice l;

    make_grid(300, 120, 100, 50);
    l = grid.lattice;
    l.spacing[1] = 0.7;
    for (int which = 0; which < 4; which++) {
        bvx_grid g[2] = {{0}, {0}};
        for (int t = 0; t < 2; t++) {
            bvx_context *const c = t == 0 ? ctx : many;
            if (which == 0) TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_permute(c, &grid, axes, flips, &g[t]));
            if (which == 1) TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_pad(c, &grid, low, high, &g[t]));
            if (which == 2) TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_crop(c, &grid, NULL, &g[t]));
            if (which == 3) TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_resample(c, &grid, &l, NULL, &g[t]));
        }
        algebra_expect_equal(&g[0], &g[1]);
        bvx_grid_free(ctx, &g[0]);
        bvx_grid_free(many, &g[1]);
    }
    bvx_context_destroy(many);
}

static void test_moves_take_words_of_the_callers(void)
{
    static const int32_t axes[3] = {1, 0, 2};
    static uint64_t words[195];

    make_grid(65, 4, 3, 50);
    for (size_t capacity = 0; capacity <= 195; capacity++) {
        bvx_grid own = algebra_own(words, 195);
        own.word_capacity = capacity;
        TEST_ASSERT_EQUAL_INT32(capacity < 195 ? BVX_ERR_CAPACITY : BVX_OK,
                                bvx_grid_permute(ctx, &grid, axes, NULL, &own));
        if (capacity < 195) TEST_ASSERT_EACH_EQUAL_HEX64(UINT64_C(0xdbdbdbdbdbdbdbdb), words, 195);
    }
}

static void test_moves_refuse(void)
{
    static const int32_t twice[3] = {1, 0, 1};
    static const int32_t beyond[3] = {0, 1, 3};
    static const int32_t id[3] = {0, 1, 2};
    static const int32_t two[3] = {0, 2, 0};
    static const int32_t minus[3] = {0, -1, 0};
    static const int32_t zero[3] = {0, 0, 0};
    static const int32_t far[3] = {1 << 25, 0, 0};
    bvx_window const outside = {{0, 0, 0}, {1000, 1, 1}};
    bvx_lattice l;

    make_grid(65, 3, 3, 50);
    l = grid.lattice;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_permute(ctx, &grid, twice, NULL, &made));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "axes are 1, 0, 1"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_permute(ctx, &grid, beyond, NULL, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_permute(ctx, &grid, id, two, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_permute(ctx, &grid, NULL, NULL, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_permute(ctx, &grid, id, NULL, &grid));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_grid_crop(ctx, &grid, &outside, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_crop(ctx, &grid, NULL, &grid));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_pad(ctx, &grid, minus, zero, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_grid_pad(ctx, &grid, zero, far, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_pad(ctx, &grid, NULL, zero, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_resample(ctx, &grid, NULL, NULL, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_resample(ctx, &grid, &l, NULL, &grid));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_grid_resample(ctx, &grid, &l, &outside, &made));
    l.spacing[0] = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_resample(ctx, &grid, &l, NULL, &made));
    TEST_ASSERT_NULL(made.words);
}

/* ---- words that overlap ---- */

static bvx_status crop_call(bvx_grid *result)
{
    bvx_window w;
    memcpy(w.low, grid.low, sizeof w.low);
    memcpy(w.size, grid.size, sizeof w.size);
    return bvx_grid_crop(ctx, &grid, &w, result);
}

static bvx_status dilate_call(bvx_grid *result)
{
    return bvx_grid_morph(ctx, &grid, BVX_MORPH_DILATE, NULL, result);
}
static bvx_status fill_call(bvx_grid *result)
{
    return bvx_grid_fill(ctx, &grid, NULL, 0, 6, result);
}
static bvx_status keep_call(bvx_grid *result)
{
    return bvx_grid_keep(ctx, &grid, NULL, result);
}
static bvx_status union_call(bvx_grid *result)
{
    return bvx_grid_combine(ctx, &grid, &grid, BVX_BOOLEAN_UNION, result);
}
static bvx_status hollow_call(bvx_grid *result)
{
    bvx_hollow_options o = {.struct_size = sizeof o};
    o.thickness = 2;
    return bvx_grid_hollow(ctx, &grid, &o, result);
}

/* A result may lie beside the grid, and for some calls be the grid; where
 * it holds some of its words it is refused. */
static void test_words_that_overlap_are_refused(void)
{
    static bvx_status (*const calls[6])(bvx_grid *) = {crop_call,   dilate_call, fill_call,
                                                       hollow_call, keep_call,   union_call};

    enum { WORDS = 2 * 6 * 5 };
    static uint64_t pool[3 * WORDS], before[3 * WORDS];
    bvx_grid own;
    make_grid(70, 6, 5, 50);
    own = grid;
    memset(pool, 0, sizeof pool);
    memcpy(pool + WORDS, own.words, sizeof *pool * WORDS);
    memcpy(before, pool, sizeof pool);
    for (int n = 0; n < 6; n++)
        for (int at = 0; at <= 2 * WORDS; at++) {
            int const apart = at == 0 || at == 2 * WORDS, same = at == WORDS;
            bvx_grid result = {0};
            bvx_status status;
            grid = own;
            grid.words = pool + WORDS;
            grid.owned = 0;
            result.words = pool + at;
            result.word_capacity = WORDS;
            status = calls[n](&result);
            if (!apart && !(same && n >= 4)) {
                TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, status);
                TEST_ASSERT_EQUAL_MEMORY(before, pool, sizeof pool);
            } else {
                TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(ctx));
            }
            memcpy(pool, before, sizeof pool);
        }
    grid = own;
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_crop_equals_each_voxel);
    RUN_TEST(test_crop_to_the_whole_and_back);
    RUN_TEST(test_pad_moves_nothing_in_the_world);
    RUN_TEST(test_content_equals_each_voxel);
    RUN_TEST(test_permute_equals_each_voxel);
    RUN_TEST(test_resample_equals_each_voxel);
    RUN_TEST(test_resample_of_far_lattices_is_empty);
    RUN_TEST(test_moves_are_the_same_for_any_threads);
    RUN_TEST(test_moves_take_words_of_the_callers);
    RUN_TEST(test_moves_refuse);
    RUN_TEST(test_words_that_overlap_are_refused);
    return UNITY_END();
}
