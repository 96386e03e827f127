/* test_blocks.c - downsampling by any, all and majority, and coverage
 * counts, against looking at each voxel of each block. */
#include "algebra_support.h"
#include "grid/grid.h"

static bvx_grid fine, coarse;

void setUp(void)
{
    suite_open(1);
    seed = 31;
}

void tearDown(void)
{
    bvx_grid_free(ctx, &fine);
    bvx_grid_free(ctx, &coarse);
    suite_close();
}

/* Voxels that a block has in the window, and those of them that are set. */
static void look_at_block(const bvx_grid *g, const int32_t f[3], const int32_t block[3], uint64_t *voxels,
                          uint64_t *set)
{
    *voxels = *set = 0;
    for (int32_t z = 0; z < g->size[2]; z++) {
        if ((z + g->low[2]) / f[2] != block[2]) continue;
        for (int32_t y = 0; y < g->size[1]; y++) {
            if ((y + g->low[1]) / f[1] != block[1]) continue;
            for (int32_t x = 0; x < g->size[0]; x++) {
                if ((x + g->low[0]) / f[0] != block[0]) continue;
                *voxels += 1;
                *set += (uint64_t)bvx_grid_get(g, x, y, z);
            }
        }
    }
}

static void expect_blocks(bvx_context *context, const bvx_grid *g, const int32_t f[3])
{
    static uint32_t counts[40000];
    bvx_grid reduced[3] = {{0}, {0}, {0}};
    uint64_t n = 0, seen = 0;

    for (int32_t rule = 0; rule < 3; rule++)
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_downsample(context, g, f, rule, &reduced[rule]));
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            bvx_grid_coverage(context, g, f, counts, sizeof counts / sizeof *counts, &n));
    for (int a = 0; a < 3; a++) {
        int32_t const first = g->low[a] / f[a], last = (g->low[a] + g->size[a] - 1) / f[a];
        TEST_ASSERT_EQUAL_INT32(first, reduced[0].low[a]);
        TEST_ASSERT_EQUAL_INT32(last - first + 1, reduced[0].size[a]);
        TEST_ASSERT_EQUAL_INT32((g->lattice.dims[a] + f[a] - 1) / f[a], reduced[0].lattice.dims[a]);
        TEST_ASSERT_EQUAL_DOUBLE(g->lattice.spacing[a] * f[a], reduced[0].lattice.spacing[a]);
        TEST_ASSERT_EQUAL_DOUBLE(g->lattice.origin[a], reduced[0].lattice.origin[a]);
    }
    TEST_ASSERT_EQUAL_UINT64(
        (uint64_t)reduced[0].size[0] * (uint64_t)reduced[0].size[1] * (uint64_t)reduced[0].size[2], n);
    for (int32_t z = 0; z < reduced[0].size[2]; z++)
        for (int32_t y = 0; y < reduced[0].size[1]; y++)
            for (int32_t x = 0; x < reduced[0].size[0]; x++) {
                int32_t const block[3] = {x + reduced[0].low[0], y + reduced[0].low[1],
                                          z + reduced[0].low[2]};
                uint64_t voxels, set;
                look_at_block(g, f, block, &voxels, &set);
                TEST_ASSERT_EQUAL_UINT32(set, counts[seen++]);
                TEST_ASSERT_EQUAL_INT(set != 0, bvx_grid_get(&reduced[BVX_REDUCE_ANY], x, y, z));
                TEST_ASSERT_EQUAL_INT(set == voxels, bvx_grid_get(&reduced[BVX_REDUCE_ALL], x, y, z));
                TEST_ASSERT_EQUAL_INT(2 * set > voxels, bvx_grid_get(&reduced[BVX_REDUCE_MAJORITY], x, y, z));
            }
    for (int32_t rule = 0; rule < 3; rule++) { /* nothing beyond the last voxel of a row */
        bvx_grid const *const r = &reduced[rule];
        for (int32_t row = 0; row < r->size[1] * r->size[2]; row++)
            if (r->size[0] % 64 != 0)
                TEST_ASSERT_EQUAL_HEX64(0, r->words[(size_t)(row + 1) * (size_t)r->words_per_row - 1] >>
                                               (r->size[0] % 64));
        bvx_grid_free(context, &reduced[rule]);
    }
}

static void make_fine(const int32_t size[3], const int32_t low[3], int32_t percent)
{
    static const int32_t more[3] = {3, 2, 1};
    bvx_grid_free(ctx, &fine);
    fine = algebra_grid(size, low, more);
    algebra_scatter(&fine, percent);
}

static void test_blocks_equal_each_voxel(void)
{
    static const int32_t factor[][3] = {{1, 1, 1}, {2, 2, 2},  {4, 4, 4},  {3, 1, 2},   {5, 3, 1},
                                        {7, 2, 5}, {64, 1, 1}, {65, 2, 2}, {127, 3, 3}, {200, 9, 9}};
    static const int32_t low[][3] = {{0, 0, 0}, {3, 1, 2}, {63, 4, 0}, {1, 2, 3}};

    for (int s = 0; s < ALGEBRA_SIZES; s++)
        for (size_t f = 0; f < sizeof factor / sizeof *factor; f++)
            for (int l = 0; l < (quick ? 2 : 4); l++) {
                int32_t const size[3] = {algebra_sizes[s], 5, 4};
                make_fine(size, low[l], l == 1 ? 97 : l == 2 ? 10 : 50);
                expect_blocks(ctx, &fine, factor[f]);
            }
}

/* Columns that are full, empty and half full, so that ALL and MAJORITY have something to find. */
static void test_blocks_of_stripes(void)
{
    static const int32_t size[3] = {129, 9, 9}, low[3] = {2, 0, 1}, factor[3] = {4, 3, 2};
    make_fine(size, low, 0);
    for (int32_t z = 0; z < 9; z++)
        for (int32_t y = 0; y < 9; y++)
            for (int32_t x = 0; x < 129; x++)
                bvx_grid_set(&fine, x, y, z, x / 12 % 2 == 0 || (y + z) % 4 == 0);
    expect_blocks(ctx, &fine, factor);
}

static void test_blocks_is_the_same_for_any_threads_and_processor(void)
{
    static const int32_t size[3] = {300, 40, 30}, low[3] = {5, 3, 0}, factor[3] = {3, 4, 5};
    make_fine(size, low, 50);
    for (int way = 0; way < 3; way++) {
        bvx_context *const other = suite_context(way == 1 ? 3 : 1,
                                                 way == 2 ? BVX_CPU_PORTABLE : BVX_CPU_BEST);
        expect_blocks(other, &fine, factor);
        bvx_context_destroy(other);
    }
}

/* A window between blocks has the whole's bits. */
static void test_blocks_of_a_window_are_the_wholes(void)
{
    static const int32_t size[3] = {140, 12, 8}, none[3] = {0, 0, 0}, factor[3] = {4, 3, 2};
    bvx_window const window = {{8, 3, 2}, {128, 6, 4}}, coarse_window = {{2, 1, 1}, {32, 2, 2}};
    bvx_grid part = {0}, of_part = {0}, cut = {0};

    make_fine(size, none, 50);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_crop(ctx, &fine, &window, &part));
    for (int32_t rule = 0; rule < 3; rule++) {
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_downsample(ctx, &fine, factor, rule, &coarse));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_crop(ctx, &coarse, &coarse_window, &cut));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_downsample(ctx, &part, factor, rule, &of_part));
        algebra_expect_equal(&cut, &of_part);
        bvx_grid_free(ctx, &cut);
        bvx_grid_free(ctx, &of_part);
    }
    bvx_grid_free(ctx, &part);
}

/* One block of nearly 2^20 voxels: many digits. */
static void test_blocks_of_everything(void)
{
    static const int32_t size[3] = {129, 90, 90}, low[3] = {1, 0, 0}, factor[3] = {1 << 25, 1000, 500};
    uint32_t total;
    uint64_t n, want;

    make_fine(size, low, 70);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &fine, &want));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_coverage(ctx, &fine, factor, &total, 1, &n));
    TEST_ASSERT_EQUAL_UINT64(1, n);
    TEST_ASSERT_EQUAL_UINT64(want, total);
}

/* KiB that the system would give without trouble; 0 where it does not say. */
static unsigned long available_memory(void)
{
    FILE *const file = fopen("/proc/meminfo", "r");
    unsigned long found = 0;
    char line[128];

    if (file == NULL) return 0;
    while (found == 0 && fgets(line, sizeof line, file) != NULL)
        if (sscanf(line, "MemAvailable: %lu", &found) != 1) found = 0;
    fclose(file);
    return found;
}

/* Words, voxels and bits are counted beyond 32 bits: set voxels behind the
 * 2^32nd are found, counted and kept. */
static void test_more_than_2_to_32_voxels(void)
{
    static const int32_t size[3] = {2048, 2048, 1025}, none[3] = {0, 0, 0}, factor[3] = {512, 512, 512};
    static uint32_t counts[48];
    bvx_window content;
    uint64_t n;

    if (quick || sizeof(size_t) < 8 || available_memory() < 2097152ul)
        TEST_IGNORE_MESSAGE("needs 0.5 GiB of memory, and 2 that are free");
    fine = algebra_grid(size, none, none);
    bvx_grid_set(&fine, 2047, 2047, 1024, 1); /* bit 2^32 + 2^22 - 1 */
    bvx_grid_set(&fine, 1000, 2000, 1024, 1);
    bvx_grid_set(&fine, 5, 1500, 1000, 1);
    bvxi_grid_content(&fine, &content);
    TEST_ASSERT_EQUAL_INT32(5, content.low[0]);
    TEST_ASSERT_EQUAL_INT32(1000, content.low[2]);
    TEST_ASSERT_EQUAL_INT32(25, content.size[2]);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_coverage(ctx, &fine, factor, counts, 48, &n));
    TEST_ASSERT_EQUAL_UINT64(48, n);
    for (uint32_t i = 0; i < 48; i++) TEST_ASSERT_EQUAL_UINT32(i == 47 || i == 45 || i == 24, counts[i]);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_crop(ctx, &fine, &content, &coarse));
    TEST_ASSERT_EQUAL_INT(1, bvx_grid_get(&coarse, 2042, 547, 24));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_complement(ctx, &fine, &fine));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &fine, &n));
    TEST_ASSERT_EQUAL_UINT64((UINT64_C(1025) << 22) - 3, n);
}

static void test_blocks_capacities_and_refusals(void)
{
    static const int32_t size[3] = {65, 3, 3};
    static const int32_t low[3] = {0, 0, 0};
    static const int32_t factor[3] = {4, 2, 2};
    static const int32_t zero[3] = {4, 0, 2};
    static const int32_t large[3] = {4, (1 << 25) + 1, 1};
    static const int32_t one[3] = {1, 1, 1};
    static uint32_t counts[80];
    uint64_t n = 7;

    make_fine(size, low, 50);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_coverage(ctx, &fine, factor, NULL, 0, &n));
    TEST_ASSERT_EQUAL_UINT64(68, n);
    for (uint64_t capacity = 0; capacity <= 68; capacity++) {
        memset(counts, 0x77, sizeof counts);
        n = 0;
        TEST_ASSERT_EQUAL_INT32(capacity < 68 ? BVX_ERR_CAPACITY : BVX_OK,
                                bvx_grid_coverage(ctx, &fine, factor, counts, capacity, &n));
        TEST_ASSERT_EQUAL_UINT64(68, n);
        TEST_ASSERT_EACH_EQUAL_HEX32(0x77777777, counts + (capacity < 68 ? 0 : 68), capacity < 68 ? 80 : 12);
    }
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_coverage(ctx, &fine, zero, counts, 80, &n));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "factor[1] is 0"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_downsample(ctx, &fine, large, 0, &coarse));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_downsample(ctx, &fine, factor, 3, &coarse));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_downsample(ctx, &fine, factor, -1, &coarse));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_downsample(ctx, &fine, NULL, 0, &coarse));
    /* not in place */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_downsample(ctx, &fine, one, 0, &fine));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_downsample(ctx, NULL, factor, 0, &coarse));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_coverage(ctx, &fine, factor, counts, 80, NULL));
    fine.lattice.spacing[1] = 1e308;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_downsample(ctx, &fine, one, 0, &coarse));
    bvx_grid_free(ctx, &coarse);
    /* spacing beyond doubles */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_downsample(ctx, &fine, factor, 0, &coarse));
    TEST_ASSERT_NULL(coarse.words);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_blocks_equal_each_voxel);
    RUN_TEST(test_blocks_of_stripes);
    RUN_TEST(test_blocks_is_the_same_for_any_threads_and_processor);
    RUN_TEST(test_blocks_of_a_window_are_the_wholes);
    RUN_TEST(test_blocks_of_everything);
    RUN_TEST(test_more_than_2_to_32_voxels);
    RUN_TEST(test_blocks_capacities_and_refusals);
    return UNITY_END();
}
