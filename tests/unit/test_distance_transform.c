/* test_distance_transform.c - squared distances and nearest voxels against
 * all pairs of voxels; BVX_QUICK makes it shorter. */
#include "morph_support.h"

static bvx_distance_options options_of(int32_t side, int32_t beyond, uint64_t *nearest)
{
    bvx_distance_options o = {.struct_size = sizeof o};
    o.side = side;
    o.beyond = beyond;
    o.nearest = nearest;
    return o;
}

/* ---- The oracle: every voxel against every target ---- */

typedef struct target {
    int32_t v[3];
} target;

static size_t list_targets(int set, target *list)
{
    size_t n = 0;

    for (int32_t z = 0; z < grid.size[2]; z++)
        for (int32_t y = 0; y < grid.size[1]; y++)
            for (int32_t x = 0; x < grid.size[0]; x++)
                if (bvx_grid_get(&grid, x, y, z) == set) {
                    target const t = {{x, y, z}};
                    list[n++] = t;
                }
    return n;
}

static double squared(const int32_t a[3], const int32_t b[3], const double w[3])
{
    double d[3];
    for (int i = 0; i < 3; i++) d[i] = (double)(a[i] - b[i]) * (double)(a[i] - b[i]);
    return (w[0] * d[0] + w[1] * d[1]) + w[2] * d[2];
}

/* The least square and the lowest index that has it; beyond: everything around the window is a target too. */
static double all_pairs(const int32_t v[3], const target *list, size_t count, const double w[3], int beyond,
                        uint64_t *nearest)
{
    double best = (double)INFINITY;

    *nearest = UINT64_MAX;
    for (size_t i = 0; i < count; i++) {
        const int32_t *const t = list[i].v;
        double const d = squared(v, t, w);
        if (d < best) {
            best = d;
            *nearest = (uint64_t)t[0] +
                       (uint64_t)grid.size[0] * ((uint64_t)t[1] + (uint64_t)grid.size[1] * (uint64_t)t[2]);
        }
    }
    for (int a = 0; a < 3 && beyond; a++)
        for (int side = 0; side < 2; side++) {
            double const k = side ? (double)(grid.size[a] - v[a]) : (double)(v[a] + 1), d = w[a] * (k * k);
            if (d < best) {
                best = d;
                *nearest = UINT64_MAX;
            }
        }
    return best;
}

/* Whole squares, floats, doubles and nearest voxels of one side. */
static void expect_pairs(int32_t side, int32_t beyond)
{
    size_t const n = voxels_of(&grid);
    const double *const s = grid.lattice.spacing;
    int const cubic = s[0] == s[1] && s[0] == s[2];
    int const also = beyond == (side == BVX_DISTANCE_INSIDE ? BVX_BEYOND_EMPTY : BVX_BEYOND_SET);
    double const w[3] = {cubic ? 1.0 : s[0] * s[0], cubic ? 1.0 : s[1] * s[1], cubic ? 1.0 : s[2] * s[2]};
    target *const list = room_for(n, sizeof *list);
    uint32_t *const squares = room_for(n, sizeof *squares), *const again = room_for(n, sizeof *again);
    uint64_t *const nearest = room_for(n, sizeof *nearest);
    double *const real = room_for(n, sizeof *real);
    float *const single = room_for(n, sizeof *single);
    size_t const count = list_targets(side != BVX_DISTANCE_INSIDE, list);
    bvx_distance_options o = options_of(side, beyond, NULL);

    if (cubic) TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, &o, BVX_SQUARES, squares, n));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, &o, BVX_F32, single, n));
    o.nearest = nearest;
    if (cubic) TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, &o, BVX_SQUARES, again, n));
    if (cubic) TEST_ASSERT_EQUAL_INT(0, memcmp(squares, again, n * sizeof *squares));
    memset(nearest, 0x55, n * sizeof *nearest);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, &o, BVX_F64, real, n));
    for (size_t i = 0; i < n; i++) {
        int32_t const v[3] = {(int32_t)(i % (size_t)grid.size[0]),
                              (int32_t)(i / (size_t)grid.size[0] % (size_t)grid.size[1]),
                              (int32_t)(i / (size_t)grid.size[0] / (size_t)grid.size[1])};
        uint64_t where;
        double const best = all_pairs(v, list, count, w, also, &where);
        double const length = cubic ? s[0] * sqrt(best) : sqrt(best);
        if (cubic) TEST_ASSERT_EQUAL_UINT32(best < 4e9 ? (uint32_t)best : UINT32_MAX, squares[i]);
        TEST_ASSERT_EQUAL_HEX64(where, nearest[i]);
        TEST_ASSERT_EQUAL_INT(0, memcmp(&length, &real[i], sizeof length));
        TEST_ASSERT_TRUE((float)length == single[i]);
    }
    free(list);
    free(squares);
    free(again);
    free(nearest);
    free(real);
    free(single);
}

/* ---- Tests ---- */

static void test_distances_by_hand(void)
{
    uint32_t squares[5];
    double lengths[5];
    bvx_distance_options o = options_of(BVX_DISTANCE_SIGNED, BVX_BEYOND_EMPTY, NULL);

    open_grid(5, 1, 1, 2.0, 2.0, 2.0);
    bvx_grid_set(&grid, 3, 0, 0, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, NULL, BVX_SQUARES, squares, 5));
    TEST_ASSERT_EQUAL_UINT32(9, squares[0]);
    TEST_ASSERT_EQUAL_UINT32(0, squares[3]);
    TEST_ASSERT_EQUAL_UINT32(1, squares[4]);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, &o, BVX_F64, lengths, 5));
    TEST_ASSERT_EQUAL_DOUBLE(6.0, lengths[0]);
    TEST_ASSERT_EQUAL_DOUBLE(-2.0, lengths[3]);
    TEST_ASSERT_EQUAL_DOUBLE(2.0, lengths[4]);
}

static void test_distances_equal_all_pairs_at_word_edges(void)
{
    static const int32_t parts[4] = {2, 20, 300, 980};

    for (int e = 0; e < 7; e++)
        for (int p = 0; p < 4; p++) {
            if (quick && (e + p) % 4 != 0) continue;
            open_grid(word_edges[e], 1 + maker_below(&seed, 7), 1 + maker_below(&seed, 6), 0.75, 0.75, 0.75);
            scatter(parts[p]);
            expect_pairs(p % 2, e % 3);
        }
}

static void test_distances_equal_all_pairs_in_deep_boxes(void)
{
    for (int i = 0; i < (quick ? 4 : 24); i++) {
        open_grid(1 + maker_below(&seed, 20), 1 + maker_below(&seed, 24), 1 + maker_below(&seed, 24), 1.0,
                  1.0, 1.0);
        if (i % 3 == 0) scatter(1 + maker_below(&seed, 8));
        else scatter_balls(1 + maker_below(&seed, 6), 9);
        expect_pairs(i % 2, i / 2 % 3);
    }
}

/* Spacings whose squares are exact, so that equally near voxels are equal in doubles too. */
static void test_distances_of_stretched_voxels_equal_all_pairs(void)
{
    static const double spacings[5][3] = {{1, 2, 0.5}, {1.5, 1, 1}, {0.75, 1.25, 3}, {1, 1, 8}, {4, 0.25, 1}};
    for (int i = 0; i < (quick ? 4 : 20); i++) {
        const double *const s = spacings[i % 5];
        open_grid(1 + maker_below(&seed, 40), 1 + maker_below(&seed, 20), 1 + maker_below(&seed, 20), s[0],
                  s[1], s[2]);
        scatter(i % 2 ? 5 : 100);
        expect_pairs(i % 2, i % 3);
    }
}

/* Any spacings: the least of all pairs to a few roundings, and the nearest voxel is one at that distance. */
static void test_distances_of_any_voxels_are_least_to_rounding(void)
{
    for (int i = 0; i < (quick ? 2 : 10); i++) {
        open_grid(1 + maker_below(&seed, 70), 1 + maker_below(&seed, 16), 1 + maker_below(&seed, 16),
                  maker_between(&seed, 0.1, 3, 999), maker_between(&seed, 0.1, 3, 999),
                  maker_between(&seed, 0.1, 3, 999));
        scatter(10);
        bvx_grid_set(&grid, 0, 0, 0, 1);
        size_t const n = voxels_of(&grid);
        const double *const s = grid.lattice.spacing;
        double const w[3] = {s[0] * s[0], s[1] * s[1], s[2] * s[2]};
        target *const list = room_for(n, sizeof *list);
        double *const real = room_for(n, sizeof *real);
        uint64_t *const nearest = room_for(n, sizeof *nearest), unused;
        size_t const count = list_targets(1, list);
        bvx_distance_options const o = options_of(BVX_DISTANCE_OUTSIDE, BVX_BEYOND_NOTHING, nearest);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, &o, BVX_F64, real, n));
        for (size_t k = 0; k < n; k++) {
            size_t const nx = (size_t)grid.size[0], ny = (size_t)grid.size[1];
            int32_t const v[3] = {(int32_t)(k % nx), (int32_t)(k / nx % ny), (int32_t)(k / nx / ny)};
            int32_t const t[3] = {(int32_t)(nearest[k] % nx), (int32_t)(nearest[k] / nx % ny),
                                  (int32_t)(nearest[k] / nx / ny)};
            double const best = sqrt(all_pairs(v, list, count, w, 0, &unused));
            double const taken = sqrt(squared(v, t, w));
            TEST_ASSERT_TRUE(bvx_grid_get(&grid, t[0], t[1], t[2]));
            TEST_ASSERT_TRUE(taken == real[k]);
            TEST_ASSERT_TRUE(real[k] >= best && real[k] <= best * (1.0 + 4e-16));
        }
        free(list);
        free(real);
        free(nearest);
    }
}

static void test_signed_is_outside_less_inside(void)
{
    open_grid(70, 20, 20, 1.0, 1.0, 1.5);
    scatter_balls(9, 9);
    size_t const n = voxels_of(&grid);
    double *const out = room_for(n, sizeof *out);
    double *const in = room_for(n, sizeof *in);
    double *const both = room_for(n, sizeof *both);
    uint64_t *const near_out = room_for(n, 8);
    uint64_t *const near_in = room_for(n, 8);
    uint64_t *const near_both = room_for(n, 8);
    bvx_distance_options o = options_of(BVX_DISTANCE_OUTSIDE, BVX_BEYOND_EMPTY, near_out);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, &o, BVX_F64, out, n));
    o = options_of(BVX_DISTANCE_INSIDE, BVX_BEYOND_EMPTY, near_in);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, &o, BVX_F64, in, n));
    o = options_of(BVX_DISTANCE_SIGNED, BVX_BEYOND_EMPTY, near_both);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, &o, BVX_F64, both, n));
    for (size_t i = 0; i < n; i++) {
        TEST_ASSERT_TRUE(both[i] == out[i] - in[i] && both[i] != 0.0);
        TEST_ASSERT_EQUAL_HEX64(both[i] < 0.0 ? near_in[i] : near_out[i], near_both[i]);
    }
    free(out);
    free(in);
    free(both);
    free(near_out);
    free(near_in);
    free(near_both);
}

static void test_empty_and_full_grids_are_far(void)
{
    float values[70];
    uint32_t squares[70];
    uint64_t nearest[70];
    bvx_distance_options o = options_of(BVX_DISTANCE_SIGNED, BVX_BEYOND_NOTHING, nearest);

    open_grid(70, 1, 1, 1.0, 1.0, 1.0);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, &o, BVX_F32, values, 70));
    for (int i = 0; i < 70; i++) TEST_ASSERT_TRUE(values[i] == (float)INFINITY && nearest[i] == UINT64_MAX);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, NULL, BVX_SQUARES, squares, 70));
    for (int i = 0; i < 70; i++) TEST_ASSERT_EQUAL_UINT32(UINT32_MAX, squares[i]);
    for (int32_t i = 0; i < 70; i++) bvx_grid_set(&grid, i, 0, 0, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, &o, BVX_F32, values, 70));
    for (int i = 0; i < 70; i++) TEST_ASSERT_TRUE(values[i] == -(float)INFINITY && nearest[i] == UINT64_MAX);
}

static uint64_t hash_of_distances(int32_t threads, int32_t cpu)
{
    size_t const n = voxels_of(&grid);
    bvx_context *const other = suite_context(threads, cpu);
    double *const values = room_for(n, sizeof *values);
    uint64_t *const nearest = room_for(n, 8);
    bvx_distance_options const o = options_of(BVX_DISTANCE_SIGNED, BVX_BEYOND_EMPTY, nearest);

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(other, &grid, &o, BVX_F64, values, n));
    uint64_t hash = 0;
    for (size_t i = 0; i < n; i++)
        hash = hash * 31 + (uint64_t)(int64_t)(values[i] * 4096.0) * 7 + nearest[i];
    bvx_distance_options const plain = options_of(BVX_DISTANCE_SIGNED, BVX_BEYOND_EMPTY, NULL);
    double *const same = room_for(n, sizeof *same);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(other, &grid, &plain, BVX_F64, same, n));
    /* without nearest columns may be searched */
    TEST_ASSERT_EQUAL_INT(0, memcmp(values, same, n * sizeof *same));
    free(values);
    free(same);
    free(nearest);
    bvx_context_destroy(other);
    return hash;
}

static void test_threads_and_processors_do_not_show(void)
{
    static const int32_t threads[4] = {1, 2, 3, 8};

    for (int kind = 0; kind < 3; kind++) {
        open_grid(quick ? 65 : 129, 40, 48, 1.0, 1.0, kind == 2 ? 0.7 : 1.0);
        if (kind == 1) scatter_balls(12, 12);
        else scatter(150);
        uint64_t const want = hash_of_distances(1, BVX_CPU_PORTABLE);
        for (int i = 0; i < 4; i++)
            TEST_ASSERT_EQUAL_HEX64(want, hash_of_distances(threads[i], BVX_CPU_BEST));
    }
}

/* A halo as wide as the distances makes a window's values those of the whole. */
static void test_windows_with_a_halo_equal_the_whole(void)
{
    enum { HALO = 9 };
    open_grid(100, 30, 30, 1.1, 0.9, 1.0);
    scatter(20);
    size_t const n = voxels_of(&grid);
    double *const whole = room_for(n, sizeof *whole), *const part = room_for(n, sizeof *part);
    int32_t compared = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, NULL, BVX_F64, whole, n));
    for (int i = 0; i < 8; i++) {
        bvx_window w;
        bvx_grid cut = {0};
        for (int a = 0; a < 3; a++) {
            w.size[a] = 1 + maker_below(&seed, grid.size[a]);
            w.low[a] = maker_below(&seed, grid.size[a] - w.size[a] + 1);
        }
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &grid.lattice, &w, &cut));
        for (int32_t z = 0; z < w.size[2]; z++)
            for (int32_t y = 0; y < w.size[1]; y++)
                for (int32_t x = 0; x < w.size[0]; x++)
                    bvx_grid_set(&cut, x, y, z,
                                 bvx_grid_get(&grid, x + w.low[0], y + w.low[1], z + w.low[2]));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &cut, NULL, BVX_F64, part, n));
        for (int32_t z = 0; z < w.size[2]; z++)
            for (int32_t y = 0; y < w.size[1]; y++)
                for (int32_t x = 0; x < w.size[0]; x++) {
                    int32_t const v[3] = {x, y, z};
                    size_t const at = (size_t)x +
                                      (size_t)w.size[0] * ((size_t)y + (size_t)w.size[1] * (size_t)z);
                    size_t const of = (size_t)(x + w.low[0]) +
                                      (size_t)grid.size[0] * ((size_t)(y + w.low[1]) +
                                                              (size_t)grid.size[1] * (size_t)(z + w.low[2]));
                    double reach = (double)INFINITY;
                    for (int a = 0; a < 3; a++) {
                        double const s = grid.lattice.spacing[a];
                        if (w.low[a] > 0 && (double)(v[a] + 1) * s < reach) reach = (double)(v[a] + 1) * s;
                        if (w.low[a] + w.size[a] < grid.size[a] && (double)(w.size[a] - v[a]) * s < reach)
                            reach = (double)(w.size[a] - v[a]) * s;
                    }
                    if (whole[of] >= reach) continue;
                    compared++;
                    TEST_ASSERT_TRUE(part[at] == whole[of]);
                }
        bvx_grid_free(ctx, &cut);
    }
    TEST_ASSERT_TRUE(compared > 1000);
    free(whole);
    free(part);
}

/* Sides at which 32-bit squares end: whole numbers go on as doubles. */
static void test_long_rows_and_columns(void)
{
    static const int32_t sizes[3][3] = {{100000, 1, 2}, {2, 70000, 1}, {1, 2, 70000}};

    for (int k = 0; k < (quick ? 1 : 3); k++) {
        const int32_t *const s = sizes[k];
        open_grid(s[0], s[1], s[2], 0.5, 0.5, 0.5);
        size_t const n = voxels_of(&grid);
        double *const values = room_for(n, sizeof *values);
        bvx_grid_set(&grid, 0, 0, 0, 1);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_grid_distance(ctx, &grid, NULL, BVX_SQUARES, values, n));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_distance(ctx, &grid, NULL, BVX_F64, values, n));
        for (size_t i = 0; i < n; i++) {
            double const x = (double)(i % (size_t)s[0]);
            double const y = (double)(i / (size_t)s[0] % (size_t)s[1]);
            double const z = (double)(i / (size_t)s[0] / (size_t)s[1]);
            TEST_ASSERT_TRUE(values[i] == 0.5 * sqrt(x * x + y * y + z * z));
        }
        free(values);
    }
}

static void test_what_distances_refuse(void)
{
    float values[8];
    uint32_t squares[8];
    bvx_distance_options o = options_of(3, 0, NULL);

    open_grid(2, 2, 2, 1.0, 1.0, 1.0);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_distance(NULL, &grid, NULL, BVX_F32, values, 8));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_distance(ctx, NULL, NULL, BVX_F32, values, 8));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_distance(ctx, &grid, NULL, BVX_F32, NULL, 8));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_distance(ctx, &grid, NULL, 4, values, 8));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_grid_distance(ctx, &grid, NULL, BVX_F32, values, 7));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_distance(ctx, &grid, &o, BVX_F32, values, 8));
    o = options_of(0, 3, NULL);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_distance(ctx, &grid, &o, BVX_F32, values, 8));
    o = options_of(0, 0, NULL);
    o.reserved[1] = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_distance(ctx, &grid, &o, BVX_F32, values, 8));
    o = options_of(BVX_DISTANCE_SIGNED, 0, NULL);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_distance(ctx, &grid, &o, BVX_SQUARES, squares, 8));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_distance(ctx, &grid, NULL, BVX_SQUARES, NULL, 8));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_distance(NULL, &grid, NULL, BVX_SQUARES, squares, 8));
    open_grid(2, 2, 2, 1.0, 1.0, 2.0);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_distance(ctx, &grid, NULL, BVX_SQUARES, squares, 8));
    open_grid(2, 2, 2, 1e35, 1e35, 1e35);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_grid_distance(ctx, &grid, NULL, BVX_F32, values, 8));
    open_grid(2, 2, 2, 1e-200, 1e-200, 1e-200);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_grid_distance(ctx, &grid, NULL, BVX_F64, values, 8));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_distances_by_hand);
    RUN_TEST(test_distances_equal_all_pairs_at_word_edges);
    RUN_TEST(test_distances_equal_all_pairs_in_deep_boxes);
    RUN_TEST(test_distances_of_stretched_voxels_equal_all_pairs);
    RUN_TEST(test_distances_of_any_voxels_are_least_to_rounding);
    RUN_TEST(test_signed_is_outside_less_inside);
    RUN_TEST(test_empty_and_full_grids_are_far);
    RUN_TEST(test_threads_and_processors_do_not_show);
    RUN_TEST(test_windows_with_a_halo_equal_the_whole);
    RUN_TEST(test_long_rows_and_columns);
    RUN_TEST(test_what_distances_refuse);
    return UNITY_END();
}
