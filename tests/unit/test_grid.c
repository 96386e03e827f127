/* test_grid.c - grids made, filled, counted, hashed and refused. */
#include "tools/mesh_maker.h"

#include <math.h>

#include "suite.h"

static bvx_lattice lattice;
static uint64_t seed;

void setUp(void)
{
    suite_open(0);
    seed = 20240607;
}

void tearDown(void)
{
    suite_close();
}

static bvx_lattice lattice_of(int32_t x, int32_t y, int32_t z)
{
    double const origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t const dims[3] = {x, y, z};
    bvx_lattice l;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    return l;
}

static void test_grid_bound_counts_words(void)
{
    static const int32_t sizes[7] = {1, 63, 64, 65, 127, 128, 129}, words[7] = {1, 1, 1, 2, 2, 2, 3};

    for (int i = 0; i < 7; i++) {
        bvx_lattice const l = lattice_of(sizes[i], 3, 5);
        bvx_window w = {{0, 0, 0}, {0, 0, 0}};
        TEST_ASSERT_EQUAL_UINT64(15 * words[i], bvx_grid_bound(&l, NULL));
        TEST_ASSERT_EQUAL_UINT64(15 * words[i], bvx_grid_bound(&l, &w));
        w.size[0] = sizes[i];
        w.size[1] = w.size[2] = 2;
        w.low[1] = 1;
        w.low[2] = 3;
        TEST_ASSERT_EQUAL_UINT64(4 * words[i], bvx_grid_bound(&l, &w));
        w.low[2] = 4;
        TEST_ASSERT_EQUAL_UINT64(0, bvx_grid_bound(&l, &w));
        w.low[2] = -1;
        TEST_ASSERT_EQUAL_UINT64(0, bvx_grid_bound(&l, &w));
        w.low[2] = 0;
        w.size[0] = sizes[i] + 1;
        TEST_ASSERT_EQUAL_UINT64(0, bvx_grid_bound(&l, &w));
        w.size[0] = 0;
        TEST_ASSERT_EQUAL_UINT64(0, bvx_grid_bound(&l, &w));
        w.size[0] = INT32_MIN;
        TEST_ASSERT_EQUAL_UINT64(0, bvx_grid_bound(&l, &w));
        w.size[0] = INT32_MAX;
        w.low[0] = INT32_MAX;
        TEST_ASSERT_EQUAL_UINT64(0, bvx_grid_bound(&l, &w));
    }
    TEST_ASSERT_EQUAL_UINT64(0, bvx_grid_bound(NULL, NULL));
    {
        bvx_lattice const l = lattice_of(1 << 25, 1 << 25, 8);
        TEST_ASSERT_EQUAL_UINT64(UINT64_C(1) << 47, bvx_grid_bound(&l, NULL));
    }
    {
        bvx_lattice const l = lattice_of(1 << 25, 1 << 25, 1 << 25); /* 2^69 words */
        bvx_grid grid = {0};
        TEST_ASSERT_EQUAL_UINT64(0, bvx_grid_bound(&l, NULL));
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_grid_create(ctx, &l, NULL, &grid));
        TEST_ASSERT_NULL(grid.words);
    }
}

static void test_grid_create_set_get_count(void)
{
    static const int32_t sizes[7] = {1, 63, 64, 65, 127, 128, 129};

    for (int i = 0; i < 7; i++) {
        bvx_lattice const l = lattice_of(sizes[i] + 3, 4, 5);
        bvx_window const w = {{3, 1, 2}, {sizes[i], 3, 2}};
        bvx_grid grid = {0};
        uint64_t count, expected = 0;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, &w, &grid));
        TEST_ASSERT_EQUAL_UINT64(0, (uintptr_t)grid.words % 64);
        TEST_ASSERT_EQUAL_INT32(1, grid.owned);
        TEST_ASSERT_EQUAL_MEMORY(w.low, grid.low, sizeof w.low);
        TEST_ASSERT_EQUAL_MEMORY(w.size, grid.size, sizeof w.size);
        TEST_ASSERT_EQUAL_INT32((sizes[i] + 63) / 64, grid.words_per_row);
        for (uint64_t n = 0; n < bvx_grid_bound(&l, &w); n++) TEST_ASSERT_EQUAL_HEX64(0, grid.words[n]);
        for (int32_t z = 0; z < 2; z++)
            for (int32_t y = 0; y < 3; y++)
                for (int32_t x = 0; x < sizes[i]; x++)
                    if ((x * 7 + y * 3 + z) % 5 < 2) {
                        bvx_grid_set(&grid, x, y, z, 1);
                        expected++;
                    }
        for (int32_t z = 0; z < 2; z++)
            for (int32_t y = 0; y < 3; y++)
                for (int32_t x = 0; x < sizes[i]; x++) {
                    int const is = (x * 7 + y * 3 + z) % 5 < 2;
                    TEST_ASSERT_EQUAL_INT(is, bvx_grid_get(&grid, x, y, z));
                    TEST_ASSERT_EQUAL_INT(
                        is, (int)(grid.words[(z * 3 + y) * grid.words_per_row + x / 64] >> x % 64 & 1));
                }
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &grid, &count));
        TEST_ASSERT_EQUAL_UINT64(expected, count);
        bvx_grid_set(&grid, 0, 0, 0, 0);
        TEST_ASSERT_EQUAL_INT(0, bvx_grid_get(&grid, 0, 0, 0));
        bvx_grid_free(ctx, &grid);
        TEST_ASSERT_NULL(grid.words);
    }
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
}

/* The recipe of the hash, once more. */
static uint64_t plain_hash(const unsigned char *bytes, size_t size, uint64_t start)
{
    uint64_t h = start ^ UINT64_C(0xcbf29ce484222325);

    for (size_t i = 0; i < size; i += 8) {
        uint64_t word = 0;
        for (size_t k = 0; k < 8 && i + k < size; k++) word |= (uint64_t)bytes[i + k] << 8 * k;
        h = (h ^ word) * UINT64_C(0x100000001b3);
        h ^= h >> 32;
    }
    h = (h ^ size) * UINT64_C(0x100000001b3);
    return h ^ h >> 32;
}

static void append(unsigned char *bytes, size_t *at, uint64_t value, size_t size)
{
    for (size_t i = 0; i < size; i++) bytes[(*at)++] = (unsigned char)(value >> 8 * i);
}

static void append_doubles(unsigned char *bytes, size_t *at, const double v[3])
{
    for (int a = 0; a < 3; a++) {
        uint64_t u;
        memcpy(&u, &v[a], sizeof u);
        append(bytes, at, u, 8);
    }
}

static void test_grid_hash_follows_its_recipe(void)
{
    double const origin[3] = {-1.5, 2.25, 1e6}, spacing[3] = {0.1, 0.2, 0.3};
    int32_t const dims[3] = {70, 3, 4};
    bvx_window const w = {{1, 1, 1}, {66, 2, 2}};
    unsigned char bytes[512];
    size_t at = 0;
    uint64_t hash, expected;
    bvx_grid grid = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, &w, &grid));
    for (int n = 0; n < 50; n++)
        bvx_grid_set(&grid, maker_below(&seed, 66), maker_below(&seed, 2), maker_below(&seed, 2), 1);
    for (int a = 0; a < 3; a++) append(bytes, &at, (uint64_t)w.low[a], 4);
    for (int a = 0; a < 3; a++) append(bytes, &at, (uint64_t)w.size[a], 4);
    for (int a = 0; a < 3; a++) append(bytes, &at, (uint64_t)dims[a], 4);
    append(bytes, &at, (uint64_t)lattice.fraction_bits, 4);
    append_doubles(bytes, &at, origin);
    append_doubles(bytes, &at, spacing);
    TEST_ASSERT_EQUAL_UINT64(88, at);
    expected = plain_hash(bytes, at, 0);
    for (at = 0; at < 64;) append(bytes, &at, grid.words[at / 8], 8);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(ctx, &grid, &hash));
    TEST_ASSERT_EQUAL_HEX64(plain_hash(bytes, 64, expected), hash);
    TEST_ASSERT_EQUAL_HEX64(hash, bvx_hash(bytes, 64, expected));
    bvx_grid_free(ctx, &grid);
}

static void test_grid_in_the_callers_array(void)
{
    bvx_lattice const l = lattice_of(70, 3, 4);
    uint64_t words[30];
    bvx_grid grid = {0};

    memset(words, 0xEE, sizeof words);
    grid.words = words;
    grid.word_capacity = 23;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_grid_create(ctx, &l, NULL, &grid));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "24 words"));
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xEEEEEEEEEEEEEEEE), words[0]);
    grid.word_capacity = 24;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, NULL, &grid));
    TEST_ASSERT_EQUAL_PTR(words, grid.words);
    TEST_ASSERT_EQUAL_INT32(0, grid.owned);
    for (int i = 0; i < 30; i++) TEST_ASSERT_EQUAL_HEX64(i < 24 ? 0 : UINT64_C(0xEEEEEEEEEEEEEEEE), words[i]);
    bvx_grid_free(ctx, &grid);
    TEST_ASSERT_NULL(grid.words);
}

#define ASSERT_GRID_REFUSED(status)                                          \
    do {                                                                     \
        TEST_ASSERT_EQUAL_INT32(status, bvx_grid_count(ctx, &bad, &number)); \
        TEST_ASSERT_EQUAL_INT32(status, bvx_grid_hash(ctx, &bad, &number));  \
        TEST_ASSERT_EQUAL_UINT64(77, number);                                \
        bad = grid;                                                          \
    } while (0)

static void test_grid_refuses_what_is_no_grid(void)
{
    bvx_lattice const l = lattice_of(70, 3, 4);
    bvx_window const outside[3] = {
        {{0, 0, 0}, {71, 3, 4}}, {{0, -1, 0}, {70, 3, 4}}, {{0, 0, 1}, {70, 3, 4}}};
    bvx_grid grid = {0}, bad;
    uint64_t number = 77;

    for (int i = 0; i < 3; i++) {
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_grid_create(ctx, &l, &outside[i], &grid));
        TEST_ASSERT_NULL(grid.words);
    }
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_create(ctx, NULL, NULL, &grid));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_create(ctx, &l, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_create(NULL, &l, NULL, &grid));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, NULL, &grid));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_count(NULL, &grid, &number));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_count(ctx, NULL, &number));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_count(ctx, &grid, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_hash(NULL, &grid, &number));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_hash(ctx, NULL, &number));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_hash(ctx, &grid, NULL));
    bad = grid;
    bad.words = NULL;
    ASSERT_GRID_REFUSED(BVX_ERR_ARGUMENT);
    bad.words_per_row = 3;
    ASSERT_GRID_REFUSED(BVX_ERR_ARGUMENT);
    bad.word_capacity = 23;
    ASSERT_GRID_REFUSED(BVX_ERR_CAPACITY);
    bad.low[1] = 1;
    ASSERT_GRID_REFUSED(BVX_ERR_RANGE);
    bad.size[2] = 5;
    ASSERT_GRID_REFUSED(BVX_ERR_RANGE);
    bad.lattice.spacing[0] = 0;
    ASSERT_GRID_REFUSED(BVX_ERR_ARGUMENT);
    bad.lattice.origin[0] = nan("");
    ASSERT_GRID_REFUSED(BVX_ERR_RANGE);
    bad.lattice.dims[0] = 0;
    ASSERT_GRID_REFUSED(BVX_ERR_RANGE);
    bad.lattice.fraction_bits = 3;
    ASSERT_GRID_REFUSED(BVX_ERR_ARGUMENT);
    bad.lattice.fraction_bits = 17;
    ASSERT_GRID_REFUSED(BVX_ERR_ARGUMENT);
    bad.lattice.dims[0] = 8193; /* needs 15 bits, has 16 */
    ASSERT_GRID_REFUSED(BVX_ERR_RANGE);
    bvx_grid_free(ctx, &grid);
}

/* A struct whose size was never set is not a grid, even where its array is large enough for the lattice. */
static void test_grid_without_a_size_is_refused(void)
{
    bvx_lattice const l = lattice_of(70, 3, 4);
    bvx_grid grid = {0}, bad;
    uint64_t number = 77;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, NULL, &grid));
    bad = grid;
    memset(bad.size, 0, sizeof bad.size);
    bad.words_per_row = 0;
    TEST_ASSERT_TRUE(bvx_grid_count(ctx, &bad, &number) != BVX_OK);
    TEST_ASSERT_TRUE(bvx_grid_hash(ctx, &bad, &number) != BVX_OK);
    bvx_grid_free(ctx, &grid);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_grid_bound_counts_words);
    RUN_TEST(test_grid_create_set_get_count);
    RUN_TEST(test_grid_hash_follows_its_recipe);
    RUN_TEST(test_grid_in_the_callers_array);
    RUN_TEST(test_grid_refuses_what_is_no_grid);
    RUN_TEST(test_grid_without_a_size_is_refused);
    return UNITY_END();
}
