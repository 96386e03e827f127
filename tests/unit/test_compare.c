/* test_compare.c - two grids compared, against counting voxel by voxel and flooding what differs. */
#include "tools/mesh_maker.h"
#include "suite.h"

static uint64_t seed;
static bvx_grid a, b;

void setUp(void)
{
    suite_open(0);
    seed = 4242;
}

void tearDown(void)
{
    bvx_grid_free(ctx, &a);
    bvx_grid_free(ctx, &b);
    suite_close();
}

static void make_grids(int32_t x, int32_t y, int32_t z)
{
    double const origin[3] = {-3, 0.5, 1e3}, spacing[3] = {0.5, 1, 2};
    int32_t const dims[3] = {x + 5, y + 4, z + 3};
    bvx_window const window = {{2, 3, 1}, {x, y, z}};
    bvx_lattice l;

    bvx_grid_free(ctx, &a);
    bvx_grid_free(ctx, &b);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, &window, &a));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, &window, &b));
}

/* ---- The slow way ---- */

/* Pieces of what one has and the other has not, by spreading numbers until nothing changes. */
static void slow_components(const bvx_grid *one, const bvx_grid *other, uint64_t *count, uint64_t *largest)
{
    const int32_t *const n = one->size;
    size_t const slice = (size_t)n[0] * (size_t)n[1], all = slice * (size_t)n[2];
    size_t *const label = calloc(all, sizeof *label), *const size = calloc(all + 1, sizeof *size);
    int changed = 1;

    TEST_ASSERT_NOT_NULL(label);
    TEST_ASSERT_NOT_NULL(size);
    for (size_t i = 0; i < all; i++) {
        int32_t const x = (int32_t)(i % (size_t)n[0]);
        int32_t const y = (int32_t)(i / (size_t)n[0] % (size_t)n[1]);
        int32_t const z = (int32_t)(i / slice);
        if (bvx_grid_get(one, x, y, z) && !bvx_grid_get(other, x, y, z)) label[i] = i + 1;
    }
    while (changed) {
        changed = 0;
        for (size_t i = 0; i < all; i++) {
            size_t const step[3] = {1, (size_t)n[0], slice};
            size_t const place[3] = {i % step[1], i / step[1] % (size_t)n[1], i / slice};
            for (int k = 0; k < 3; k++) {
                if (label[i] == 0 || place[k] == 0 || label[i - step[k]] == 0 ||
                    label[i] == label[i - step[k]])
                    continue;
                if (label[i] < label[i - step[k]]) label[i - step[k]] = label[i];
                else label[i] = label[i - step[k]];
                changed = 1;
            }
        }
    }
    *count = *largest = 0;
    for (size_t i = 0; i < all; i++) {
        if (label[i] == 0) continue;
        *count += label[i] == i + 1;
        if (++size[label[i]] > *largest) *largest = size[label[i]];
    }
    free(label);
    free(size);
}

static void expect_slow_comparison(void)
{
    bvx_grid_difference want, got;
    int32_t high[3] = {-1, -1, -1};

    memset(&want, 0, sizeof want);
    memset(&got, 0x55, sizeof got);
    for (int i = 0; i < 3; i++) want.low[i] = a.size[i];
    for (int32_t z = 0; z < a.size[2]; z++)
        for (int32_t y = 0; y < a.size[1]; y++)
            for (int32_t x = 0; x < a.size[0]; x++) {
                int const in_a = bvx_grid_get(&a, x, y, z), in_b = bvx_grid_get(&b, x, y, z);
                int32_t const at[3] = {x, y, z};
                want.set_a += (uint64_t)in_a;
                want.set_b += (uint64_t)in_b;
                want.both += in_a && in_b;
                want.only_a += in_a && !in_b;
                want.only_b += in_b && !in_a;
                for (int i = 0; i < 3 && in_a != in_b; i++) {
                    want.low[i] = at[i] < want.low[i] ? at[i] : want.low[i];
                    high[i] = at[i] > high[i] ? at[i] : high[i];
                }
            }
    for (int i = 0; i < 3; i++) {
        want.size[i] = high[0] < 0 ? 0 : high[i] - want.low[i] + 1;
        want.low[i] = high[0] < 0 ? 0 : want.low[i];
    }
    slow_components(&a, &b, &want.components_only_a, &want.largest_only_a);
    slow_components(&b, &a, &want.components_only_b, &want.largest_only_b);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_compare(ctx, &a, &b, &got));
    TEST_ASSERT_EQUAL_UINT64(want.set_a, got.set_a);
    TEST_ASSERT_EQUAL_UINT64(want.only_b, got.only_b);
    TEST_ASSERT_EQUAL_UINT64(want.components_only_a, got.components_only_a);
    TEST_ASSERT_EQUAL_UINT64(want.components_only_b, got.components_only_b);
    TEST_ASSERT_EQUAL_UINT64(want.largest_only_a, got.largest_only_a);
    TEST_ASSERT_EQUAL_INT32_ARRAY(want.low, got.low, 3);
    TEST_ASSERT_EQUAL_INT32_ARRAY(want.size, got.size, 3);
    TEST_ASSERT_EQUAL_MEMORY(&want, &got, sizeof want);
}

static void scatter(bvx_grid *g, int32_t percent)
{
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->size[0]; x++)
                bvx_grid_set(g, x, y, z, maker_below(&seed, 100) < percent);
}

/* ---- Tests ---- */

static void test_compare_equals_the_slow_way(void)
{
    static const int32_t sides[7] = {1, 63, 64, 65, 127, 128, 129};

    for (int s = 0; s < 7; s++)
        for (int round = 0; round < 8; round++) {
            make_grids(sides[s], 1 + maker_below(&seed, 6), 1 + maker_below(&seed, 6));
            scatter(&a, 50);
            scatter(&b, round < 4 ? 50 : 4);
            if (round % 4 == 1)
                memcpy(b.words, a.words, (size_t)(a.size[1] * a.size[2] * a.words_per_row) * 8);
            if (round % 4 == 2) scatter(&a, 0);
            if (round % 4 == 3) scatter(&b, 100);
            expect_slow_comparison();
        }
}

static void test_compare_of_one_voxel_everywhere(void)
{
    static const int32_t places[6] = {0, 1, 63, 64, 127, 128};

    make_grids(129, 3, 3);
    for (int i = 0; i < 6; i++)
        for (int32_t row = 0; row < 9; row++) {
            bvx_grid *const g = (i + row) % 2 ? &a : &b;
            bvx_grid_set(g, places[i], row % 3, row / 3, 1);
            expect_slow_comparison();
            bvx_grid_set(g, places[i], row % 3, row / 3, 0);
        }
}

/* Runs of what differs that end in the middle of what both have, at a word's edge, and at the row's end. */
static void test_compare_by_hand(void)
{
    bvx_grid_difference d;

    make_grids(128, 2, 2);
    for (int32_t x = 60; x < 128; x++) bvx_grid_set(&a, x, 1, 0, 1);
    for (int32_t x = 64; x < 70; x++) bvx_grid_set(&b, x, 1, 0, 1);
    bvx_grid_set(&b, 5, 0, 1, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_compare(ctx, &a, &b, &d));
    TEST_ASSERT_EQUAL_UINT64(68, d.set_a);
    TEST_ASSERT_EQUAL_UINT64(7, d.set_b);
    TEST_ASSERT_EQUAL_UINT64(6, d.both);
    TEST_ASSERT_EQUAL_UINT64(62, d.only_a);
    TEST_ASSERT_EQUAL_UINT64(1, d.only_b);
    TEST_ASSERT_EQUAL_UINT64(2, d.components_only_a); /* 60..63 and 70..127 */
    TEST_ASSERT_EQUAL_UINT64(1, d.components_only_b);
    TEST_ASSERT_EQUAL_UINT64(58, d.largest_only_a);
    TEST_ASSERT_EQUAL_INT32(5, d.low[0]);
    TEST_ASSERT_EQUAL_INT32(123, d.size[0]);
    TEST_ASSERT_EQUAL_INT32(2, d.size[1]);
    TEST_ASSERT_EQUAL_INT32(2, d.size[2]);
}

/* A run to the end of a word, a word that both share, and a run from the first bit of the next one. */
static void test_compare_over_a_shared_word(void)
{
    bvx_grid_difference d;

    make_grids(200, 1, 1);
    for (int32_t x = 0; x < 200; x++) bvx_grid_set(&a, x, 0, 0, 1);
    for (int32_t x = 64; x < 128; x++) bvx_grid_set(&b, x, 0, 0, 1);
    expect_slow_comparison();
    for (int32_t x = 64; x < 128; x++) bvx_grid_set(&a, x, 0, 0, 0), bvx_grid_set(&b, x, 0, 0, 0);
    expect_slow_comparison();
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_compare(ctx, &b, &a, &d));
    TEST_ASSERT_EQUAL_UINT64(2, d.components_only_b);
    TEST_ASSERT_EQUAL_UINT64(72, d.largest_only_b);
}

static void test_compare_is_the_same_for_any_threads(void)
{
    bvx_grid_difference one, many;
    bvx_context_options o = {.struct_size = sizeof o};

    make_grids(200, 60, 50);
    scatter(&a, 20);
    scatter(&b, 20);
    for (o.threads = 1; o.threads <= 8; o.threads++) {
        bvx_context *other;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &other));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_compare(other, &a, &b, o.threads == 1 ? &one : &many));
        if (o.threads > 1) TEST_ASSERT_EQUAL_MEMORY(&one, &many, sizeof one);
        bvx_context_destroy(other);
    }
    TEST_ASSERT_TRUE(one.components_only_a > 1000);
}

static void test_compare_takes_what_it_says(void)
{
    bvx_grid_difference d;
    uint64_t held, runs;

    make_grids(64, 40, 40);
    for (int32_t z = 0; z < 40; z++) /* the most runs, none of them connected, and then all of them */
        for (int32_t y = 0; y < 40; y++) a.words[z * 40 + y] = UINT64_C(0x5555555555555555) << ((y + z) & 1);
    runs = 40 * 40 * 32;
    held = bvx_memory_used(ctx);
    for (int round = 0; round < 2; round++) {
        bvx_memory_reset_peak(ctx);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_compare(ctx, &a, &b, &d));
        TEST_ASSERT_EQUAL_UINT64(round == 0 ? runs : 32, d.components_only_a);
        TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - held <= 24 * runs);
        for (int32_t i = 0; i < 40 * 40; i++) a.words[i] = UINT64_C(0x5555555555555555);
    }
    a.words[0] = a.words[1] = 7;
    memcpy(b.words, a.words, 40 * 40 * 8);
    bvx_memory_reset_peak(ctx);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_compare(ctx, &a, &b, &d));
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - held < 1024); /* nothing differs */
}

static void expect_refusal(bvx_status status, const char *word)
{
    static const bvx_grid_difference empty = {0};
    bvx_grid_difference d;
    memset(&d, 0x55, sizeof d);
    TEST_ASSERT_EQUAL_INT32(status, bvx_grid_compare(ctx, &a, &b, &d));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_MEMORY(&empty, &d, sizeof d);
}

static void test_compare_names_what_differs(void)
{
    bvx_grid good;

    make_grids(20, 10, 10);
    good = b;
    b.lattice.origin[1] = 0.25, expect_refusal(BVX_ERR_LATTICE, "origin along y, 0.5 in a and 0.25 in b"),
    b = good;
    b.lattice.spacing[2] = 3, expect_refusal(BVX_ERR_LATTICE, "spacing along z, 2 in a and 3 in b"), b = good;
    b.lattice.dims[0] = 99, expect_refusal(BVX_ERR_LATTICE, "dims along x, 25 in a and 99 in b"), b = good;
    b.lattice.fraction_bits = 9, expect_refusal(BVX_ERR_LATTICE, "fraction_bits, 16 in a and 9 in b"),
    b = good;
    b.low[0] = 4, expect_refusal(BVX_ERR_LATTICE, "low along x, 2 in a and 4 in b"), b = good;
    b.size[1] = 9, expect_refusal(BVX_ERR_LATTICE, "size along y, 10 in a and 9 in b"), b = good;
}

static void test_compare_refuses_what_is_no_grid(void)
{
    bvx_grid_difference d;
    bvx_grid good;

    make_grids(20, 10, 10);
    good = a;
    a.words = NULL, expect_refusal(BVX_ERR_ARGUMENT, "grid a: the grid has no words"), a = good;
    a.reserved[2] = 1, expect_refusal(BVX_ERR_ARGUMENT, "grid a: grid.reserved[2]"), a = good;
    good = b;
    b.words_per_row = 3, expect_refusal(BVX_ERR_ARGUMENT, "grid b"), b = good;
    b.reserved[0] = -1, expect_refusal(BVX_ERR_ARGUMENT, "grid b: grid.reserved[0]"), b = good;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_compare(NULL, &a, &b, &d));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_compare(ctx, NULL, &b, &d));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "grid a"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_compare(ctx, &a, NULL, &d));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "grid b"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_compare(ctx, &a, &b, NULL));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "difference"));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_compare(ctx, &a, &a, &d)); /* one grid with itself */
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_compare_equals_the_slow_way);
    RUN_TEST(test_compare_of_one_voxel_everywhere);
    RUN_TEST(test_compare_by_hand);
    RUN_TEST(test_compare_over_a_shared_word);
    RUN_TEST(test_compare_is_the_same_for_any_threads);
    RUN_TEST(test_compare_takes_what_it_says);
    RUN_TEST(test_compare_names_what_differs);
    RUN_TEST(test_compare_refuses_what_is_no_grid);
    return UNITY_END();
}
