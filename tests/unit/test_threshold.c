/* test_threshold.c - ranges of volumes to bits, held against a comparison
 * of every sample by itself; label lists. */
#include "core/simd.h"
#include "volume/room.h"
#include "volume_support.h"

/* The kernel for columns once more, at the level without choice: arrays where there are no vectors. */
enum { COLUMN_BYTES = 64 };
#define BVXI_SIMD_LEVEL _base
#include "volume/threshold_columns_body.h"
#undef BVXI_SIMD_LEVEL

static const int x_first[3] = {0, 1, 2}, z_first[3] = {2, 1, 0}, y_first[3] = {1, 2, 0};

/* Bits, counts and extremes sample by sample. */
static void check_threshold(const test_volume *t, double low, double high)
{
    const int32_t *const n = t->view.size;
    bvx_volume_report r, expected;
    bvx_grid grid = {0}, plain = {0};
    int any = 0;

    memset(&expected, 0, sizeof expected);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold(ctx, &t->view, low, high, &r, &grid));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold(ctx, &t->view, low, high, NULL, &plain));
    for (int32_t z = 0; z < n[2]; z++)
        for (int32_t y = 0; y < n[1]; y++)
            for (int32_t x = 0; x < n[0]; x++) {
                double const v = t->value[value_index(t, x, y, z)];
                int const finite = isfinite(v), in = finite && v >= low && v <= high;
                expected.nan += (uint64_t)(isnan(v) != 0);
                expected.infinite += (uint64_t)(isinf(v) != 0);
                expected.inside += (uint64_t)in;
                if (finite && (!any || v < expected.least)) expected.least = v;
                if (finite && (!any || v > expected.greatest)) expected.greatest = v;
                any |= finite;
                TEST_ASSERT_EQUAL_INT(in, bvx_grid_get(&grid, x, y, z));
            }
    expected.least += 0.0; /* -0 and 0 are one value */
    expected.greatest += 0.0;
    for (size_t w = 0; w < (size_t)n[1] * (size_t)n[2]; w++) /* nothing behind a row's end */
        if (n[0] % 64 != 0)
            TEST_ASSERT_EQUAL_UINT64(0, grid.words[(w + 1) * (size_t)grid.words_per_row - 1] >> (n[0] % 64));
    TEST_ASSERT_EQUAL_MEMORY(grid.words, plain.words, (size_t)grid.word_capacity * 8);
    TEST_ASSERT_EQUAL_MEMORY(&expected, &r, sizeof r);
    TEST_ASSERT_EQUAL_INT32_ARRAY(t->view.low, grid.low, 3);
    TEST_ASSERT_EQUAL_MEMORY(&t->view.lattice, &grid.lattice, sizeof grid.lattice);
    bvx_grid_free(ctx, &plain);
    bvx_grid_free(ctx, &grid);
}

static void check_type(int32_t type, double least, double most)
{
    static const int32_t sizes[7][3] = {{130, 3, 5},  {64, 2, 70}, {63, 66, 2},  {1, 7, 65},
                                        {66, 19, 67}, {2, 9, 390}, {150, 10, 71}};
    const int *const orders[3] = {x_first, z_first, y_first};
    double const middle = 0.5 * (least + most);

    for (int i = 0; i < 7; i++)
        for (int o = 0; o < 3; o++) {
            test_volume t;
            make_volume(&t, type, sizes[i], i, orders[o], o + i, i == 0 ? 0 : i);
            fill_noise(&t, least, most);
            check_threshold(&t, middle, most);
            check_threshold(&t, middle + 0.25, middle + 0.75);
            check_threshold(&t, least, least);
            check_threshold(&t, -INFINITY, middle);
            check_threshold(&t, most + 1, INFINITY);
            check_threshold(&t, 3, 2);
            free_volume(&t);
        }
}

static void test_threshold_of_every_type_order_and_direction(void)
{
    check_type(BVX_SAMPLE_U8, 0, 255);
    check_type(BVX_SAMPLE_I8, -128, 127);
    check_type(BVX_SAMPLE_U16, 0, 65535);
    check_type(BVX_SAMPLE_I16, -32768, 32767);
    check_type(BVX_SAMPLE_U32, 4294967000.0, 4294967295.0);
    check_type(BVX_SAMPLE_I32, -2147483648.0, -2147483600.0);
    check_type(BVX_SAMPLE_U64, 9007199254740000.0, 9007199254740992.0);
    check_type(BVX_SAMPLE_I64, -5, 5);
    check_type(BVX_SAMPLE_F32, -9, 9);
    check_type(BVX_SAMPLE_F64, -9, 9);
}

static void test_threshold_is_the_same_on_all_paths_and_threads(void)
{
    open_again(3, BVX_CPU_PORTABLE);
    check_type(BVX_SAMPLE_F32, -9, 9);
    check_type(BVX_SAMPLE_U16, 0, 65535);
    check_type(BVX_SAMPLE_I8, -128, 127);
}

/* Every length up to three times 64 and every number of columns, with bytes around them that must not matter. */
static void test_columns_of_every_length_are_rows(void)
{
    static uint8_t bytes[64 * 201];

    seed = 11;
    for (size_t i = 0; i < sizeof bytes; i++) bytes[i] = (uint8_t)(maker_random(&seed) >> 30);
    for (int32_t n = 1; n <= 200; n++) {
        int32_t const columns = n % 64 + 1;
        int const is_signed = n % 2, low = is_signed ? -n % 100 : n % 100, high = low + n;
        uint64_t rows[201];
        bvxi_range range;

        bvxi_range_make(is_signed ? BVX_SAMPLE_I8 : BVX_SAMPLE_U8, low, high, &range);
        rows[n] = 7;
        range_columns_base(&range, bytes, 201, columns, n, n % 3, rows);
        TEST_ASSERT_EQUAL_UINT64(7, rows[n]);
        for (int32_t i = 0; i < n; i++) {
            uint64_t wanted = 0;

            for (int32_t c = 0; c < columns; c++) {
                int const byte = bytes[201 * c + i], v = is_signed && byte > 127 ? byte - 256 : byte;
                wanted |= (uint64_t)(v >= low && v <= high) << c;
            }
            TEST_ASSERT_EQUAL_HEX64(wanted, rows[i]);
        }
    }
}

/* Ends that are no floats must not move to a neighbour that is outside. */
static void test_threshold_ends_between_floats(void)
{
    static const int32_t size[3] = {3, 1, 1};
    float const one = 1.0f, next = nextafterf(one, 2.0f), before = nextafterf(one, 0.0f);
    double const between = 0.5 * ((double)one + (double)next), under = 0.5 * ((double)one + (double)before);
    test_volume t;

    make_volume(&t, BVX_SAMPLE_F32, size, 0, x_first, 0, 0);
    set_value(&t, 0, 0, 0, (double)before);
    set_value(&t, 1, 0, 0, (double)one);
    set_value(&t, 2, 0, 0, (double)next);
    check_threshold(&t, between, INFINITY);
    check_threshold(&t, -INFINITY, between);
    check_threshold(&t, under, between);
    check_threshold(&t, nextafter(1.0, 2.0), between);
    check_threshold(&t, -under, under);
    set_value(&t, 0, 0, 0, -0.0);
    check_threshold(&t, 0.0, 0.0);
    check_threshold(&t, 1e-60, 1.0);
    check_threshold(&t, -1e-60, 1e-60);
    check_threshold(&t, -1e300, 1e300);
    check_threshold(&t, 1e39, 1e300);
    free_volume(&t);
}

/* What doubles cannot distinguish is reported all the same. */
static void test_threshold_of_64_bit_ends(void)
{
    uint64_t const u[4] = {UINT64_MAX, UINT64_MAX - 1, UINT64_C(1) << 63, (UINT64_C(1) << 63) - 1};
    int64_t const i[4] = {INT64_MAX, INT64_MIN, -1, 0};
    test_volume t;
    bvx_grid g = {0};
    static const int32_t size[3] = {4, 1, 1};

    make_volume(&t, BVX_SAMPLE_U64, size, 0, x_first, 0, 0);
    memcpy(t.memory + 1, u, sizeof u);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold(ctx, &t.view, 9223372036854775808.0, INFINITY, NULL, &g));
    TEST_ASSERT_EQUAL_HEX64(7, g.words[0]);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold(ctx, &t.view, 18446744073709551616.0, INFINITY, NULL, &g));
    TEST_ASSERT_EQUAL_HEX64(0, g.words[0]);
    t.view.sample_type = BVX_SAMPLE_I64;
    memcpy(t.memory + 1, i, sizeof i);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold(ctx, &t.view, -INFINITY, -0.5, NULL, &g));
    TEST_ASSERT_EQUAL_HEX64(6, g.words[0]);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold(ctx, &t.view, 9223372036854775808.0, INFINITY, NULL, &g));
    TEST_ASSERT_EQUAL_HEX64(0, g.words[0]);
    bvx_grid_free(ctx, &g);
    free_volume(&t);
}

/* Voxels of one value each, of neighbours that are one double. */
static void test_threshold_whole_tells_64_bit_integers_apart(void)
{
    int64_t const i[4] = {(INT64_C(1) << 53) + 1, (INT64_C(1) << 53) + 2, INT64_MIN, INT64_MIN + 1};
    static const int32_t size[3] = {4, 1, 1};
    test_volume t;
    bvx_grid g = {0};

    make_volume(&t, BVX_SAMPLE_I64, size, 0, x_first, 0, 0);
    memcpy(t.memory + 1, i, sizeof i);
    for (int k = 0; k < 8; k++) {
        /* Bits of a u64 order in another way, but each is itself. */
        t.view.sample_type = k < 4 ? BVX_SAMPLE_I64 : BVX_SAMPLE_U64;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold_whole(ctx, &t.view, i[k % 4], i[k % 4], NULL, &g));
        TEST_ASSERT_EQUAL_HEX64(UINT64_C(1) << k % 4, g.words[0]);
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold_whole(ctx, &t.view, i[1], i[2], NULL, &g));
    TEST_ASSERT_EQUAL_HEX64(6, g.words[0]);
    t.view.sample_type = BVX_SAMPLE_I64;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold_whole(ctx, &t.view, i[2], i[0], NULL, &g));
    TEST_ASSERT_EQUAL_HEX64(13, g.words[0]);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold_whole(ctx, &t.view, i[1], i[0], NULL, &g));
    TEST_ASSERT_EQUAL_HEX64(0, g.words[0]);

    /* Ends beyond the type's own; floats have no such ends. */
    t.view.sample_type = BVX_SAMPLE_I8;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold_whole(ctx, &t.view, INT64_MIN, INT64_MAX, NULL, &g));
    TEST_ASSERT_EQUAL_HEX64(15, g.words[0]);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold_whole(ctx, &t.view, 128, INT64_MAX, NULL, &g));
    TEST_ASSERT_EQUAL_HEX64(0, g.words[0]);
    t.view.sample_type = BVX_SAMPLE_F64;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_threshold_whole(ctx, &t.view, 0, 1, NULL, &g));
    bvx_grid_free(ctx, &g);
    free_volume(&t);
}

static void test_threshold_leaves_nan_and_infinity_out_and_counts_them(void)
{
    static const int32_t size[3] = {200, 3, 2};
    int32_t const types[2] = {BVX_SAMPLE_F32, BVX_SAMPLE_F64};

    for (int i = 0; i < 4; i++) {
        test_volume t;
        make_volume(&t, types[i & 1], size, 1, i < 2 ? x_first : z_first, i, 0);
        fill_noise(&t, -3, 3);
        for (int n = 0; n < 40; n++) {
            double const odd[3] = {NAN, INFINITY, -INFINITY};
            set_value(&t, (int32_t)maker_below(&seed, 200), (int32_t)maker_below(&seed, 3),
                      (int32_t)maker_below(&seed, 2), odd[n % 3]);
        }
        check_threshold(&t, -INFINITY, INFINITY);
        check_threshold(&t, 0, INFINITY);
        for (int32_t x = 0; x < size[0]; x++)
            for (int32_t y = 0; y < size[1]; y++)
                for (int32_t z = 0; z < size[2]; z++) set_value(&t, x, y, z, NAN);
        check_threshold(&t, -1, 1);
        free_volume(&t);
    }
}

static void test_threshold_refusals(void)
{
    static const int32_t size[3] = {70, 4, 2};
    uint64_t words[15];
    test_volume t;
    bvx_grid g = {0};

    make_volume(&t, BVX_SAMPLE_U8, size, 0, x_first, 0, 0);
    bvx_volume_view const good = t.view;
#define REFUSED(status)                                                           \
    TEST_ASSERT_EQUAL_INT32(status, bvx_threshold(ctx, &t.view, 0, 1, NULL, &g)); \
    t.view = good
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_threshold(ctx, NULL, 0, 1, NULL, &g));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_threshold(ctx, &t.view, 0, 1, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_threshold(NULL, &t.view, 0, 1, NULL, &g));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_threshold(ctx, &t.view, NAN, 1, NULL, &g));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_threshold(ctx, &t.view, 0, NAN, NULL, &g));
    t.view.samples = NULL;
    REFUSED(BVX_ERR_ARGUMENT);
    t.view.sample_type = 11;
    REFUSED(BVX_ERR_ARGUMENT);
    t.view.sample_type = 0;
    REFUSED(BVX_ERR_ARGUMENT);
    t.view.reserved0 = 1;
    REFUSED(BVX_ERR_ARGUMENT);
    t.view.reserved[3] = 1;
    REFUSED(BVX_ERR_ARGUMENT);
    t.view.size[0] = 0;
    REFUSED(BVX_ERR_ARGUMENT);
    t.view.size[1] = 5;
    REFUSED(BVX_ERR_RANGE);
    t.view.low[2] = -1;
    REFUSED(BVX_ERR_RANGE);
    t.view.lattice.spacing[1] = 0;
    REFUSED(BVX_ERR_ARGUMENT);
    t.view.strides[2] = INT64_MAX;
    REFUSED(BVX_ERR_ARGUMENT);
    t.view.strides[0] = INT64_MIN;
    REFUSED(BVX_ERR_ARGUMENT);
#undef REFUSED
    TEST_ASSERT_NULL(g.words);
    for (uint64_t capacity = 0; capacity < 16; capacity++) {
        g.words = words;
        g.word_capacity = capacity;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_threshold(ctx, &t.view, 0, 1, NULL, &g));
    }
    free_volume(&t);
}

/* ---- labels ---- */

static void test_labels_of_every_whole_type(void)
{
    static const int32_t size[3] = {67, 5, 4};

    for (int32_t type = BVX_SAMPLE_U8; type <= BVX_SAMPLE_I64; type++) {
        int const is_signed = type % 2 == 0;
        double const least = is_signed ? -100 : 0;
        test_volume t;
        bvx_label labels[256];
        uint64_t count = 0, wanted = 0, found = 0;
        make_volume(&t, type, size, 2, type % 3 == 0 ? z_first : x_first, type, 3);
        fill_noise(&t, least, 100);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_list_labels(ctx, &t.view, NULL, 0, &count));
        TEST_ASSERT_TRUE(count > 50 && count <= 200);
        if (count > 0)
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY,
                                    bvx_list_labels(ctx, &t.view, labels, count - 1, &found));
        TEST_ASSERT_EQUAL_UINT64(count, found);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_list_labels(ctx, &t.view, labels, 256, &found));
        for (double v = least; v <= 100; v++) {
            bvx_label e = {(int64_t)v, 0, {99, 99, 99}, {0, 0, 0}};
            int32_t high[3] = {-1, -1, -1};
            if (v == 0) continue;
            for (int32_t z = 0; z < size[2]; z++)
                for (int32_t y = 0; y < size[1]; y++)
                    for (int32_t x = 0; x < size[0]; x++) {
                        int32_t const at[3] = {x, y, z};
                        if (t.value[value_index(&t, x, y, z)] != v) continue;
                        e.voxels++;
                        for (int a = 0; a < 3; a++) {
                            if (at[a] < e.low[a]) e.low[a] = at[a];
                            if (at[a] > high[a]) high[a] = at[a];
                        }
                    }
            if (e.voxels == 0) continue;
            for (int a = 0; a < 3; a++) e.size[a] = high[a] - e.low[a] + 1;
            TEST_ASSERT_EQUAL_MEMORY(&e, &labels[wanted], sizeof e);
            wanted++;
        }
        TEST_ASSERT_EQUAL_UINT64(wanted, found);
        free_volume(&t);
    }
}

static void test_labels_of_many_large_values(void)
{
    static const int32_t size[3] = {40, 40, 7};
    test_volume t;
    bvx_label *labels = malloc(11200 * sizeof *labels);
    uint64_t count, all = 0;

    TEST_ASSERT_NOT_NULL(labels);
    make_volume(&t, BVX_SAMPLE_I64, size, 0, x_first, 0, 0);
    for (int32_t n = 0; n < 11200; n++)
        set_value(&t, n % 40, n / 40 % 40, n / 1600, (n & 1 ? -1.0 : 1.0) * (double)n * 1048576.0 * 64.0);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_list_labels(ctx, &t.view, labels, 11200, &count));
    TEST_ASSERT_EQUAL_UINT64(11199, count);
    for (uint64_t i = 0; i < count; i++) {
        all += labels[i].voxels;
        if (i > 0) TEST_ASSERT_TRUE(labels[i].value > labels[i - 1].value);
    }
    TEST_ASSERT_EQUAL_UINT64(11199, all);
    free(labels);
    t.view.sample_type = BVX_SAMPLE_F64;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_list_labels(ctx, &t.view, NULL, 0, &count));
    free_volume(&t);
}

/* Values that all want one place of the table, so that it would look at
 * every one before: one in seven stands twice. */
static void test_labels_made_against_the_hash(void)
{
    enum { SIDE = 400, VALUES = SIDE * SIDE };
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    uint64_t *const value = malloc(VALUES * sizeof *value), inverse = UINT64_C(0x9e3779b97f4a7c15), count;
    bvx_label *const labels = malloc(VALUES * sizeof *labels);
    bvx_volume_view view;
    uint64_t voxels = 0;
    TEST_ASSERT_TRUE(value != NULL && labels != NULL);
    /* Newton, modulo 2^64 */
    for (int i = 0; i < 5; i++) inverse *= 2 - UINT64_C(0x9e3779b97f4a7c15) * inverse;
    for (uint64_t n = 0; n < VALUES; n++) {
        /* the table's hash of it is below 2^29, so its place is 0 */
        uint64_t const mixed = (n % 7 == 6 ? n : n + 1) * inverse;
        value[n] = mixed ^ mixed >> 32;
    }
    memset(&view, 0, sizeof view);
    view.samples = value;
    view.sample_type = BVX_SAMPLE_U64;
    view.size[0] = view.size[1] = SIDE;
    view.size[2] = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, view.size, &view.lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_list_labels(ctx, &view, labels, VALUES, &count));
    for (uint64_t i = 0; i < count; i++) {
        voxels += labels[i].voxels;
        if (i > 0) TEST_ASSERT_TRUE((uint64_t)labels[i].value > (uint64_t)labels[i - 1].value);
    }
    TEST_ASSERT_EQUAL_UINT64(VALUES - VALUES / 7, count);
    TEST_ASSERT_EQUAL_UINT64(VALUES, voxels);
    free(labels);
    free(value);
}

static void test_labels_of_nothing(void)
{
    static const int32_t size[3] = {5, 5, 5};
    test_volume t;
    uint64_t count = 9;

    make_volume(&t, BVX_SAMPLE_U32, size, 0, x_first, 0, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_list_labels(ctx, &t.view, NULL, 0, &count));
    TEST_ASSERT_EQUAL_UINT64(0, count);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_list_labels(ctx, &t.view, NULL, 0, NULL));
    free_volume(&t);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_threshold_of_every_type_order_and_direction);
    RUN_TEST(test_columns_of_every_length_are_rows);
    RUN_TEST(test_threshold_is_the_same_on_all_paths_and_threads);
    RUN_TEST(test_threshold_ends_between_floats);
    RUN_TEST(test_threshold_of_64_bit_ends);
    RUN_TEST(test_threshold_whole_tells_64_bit_integers_apart);
    RUN_TEST(test_threshold_leaves_nan_and_infinity_out_and_counts_them);
    RUN_TEST(test_threshold_refusals);
    RUN_TEST(test_labels_of_every_whole_type);
    RUN_TEST(test_labels_of_many_large_values);
    RUN_TEST(test_labels_made_against_the_hash);
    RUN_TEST(test_labels_of_nothing);
    return UNITY_END();
}
