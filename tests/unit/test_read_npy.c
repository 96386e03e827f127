/* test_read_npy.c - .npy files of ours and of NumPy's other forms. */
#include "dense_file_support.h"

static hand_file made;

/* A head of a version, its dictionary and padding as NumPy makes them. */
static void start_npy(int version, const char *dict)
{
    size_t const prefix = version == 1 ? 10 : 12;
    size_t const length = (prefix + strlen(dict) + 1 + 63) / 64 * 64 - prefix;

    made.size = 0;
    hand_text(&made, "\x93NUMPY");
    hand_number(&made, (uint64_t)version, 1, 0);
    hand_number(&made, 0, 1, 0);
    hand_number(&made, length, version == 1 ? 2 : 4, 0);
    hand_text(&made, "%s", dict);
    while (made.size < prefix + length - 1) hand_text(&made, " ");
    hand_text(&made, "\n");
}

static void test_npy_rounds(void)
{
    check_grid_rounds(BVX_FORMAT_NPY, 0);
}

/* Every type, byte order and order of axes, against numbers put one by one. */
static void check_npy_type(const char *descr, int size, uint64_t negative_zero, int fortran, int version)
{
    enum { NX = 67, NY = 3, NZ = 5 };
    static uint8_t set[NX * NY * NZ];
    uint64_t state = (uint64_t)size * 31 + (uint64_t)fortran;
    int const big = descr[0] == '>';
    char dict[100];
    bvx_grid g;
    sprintf(dict, "{'descr': '%s', 'fortran_order': %s, 'shape': (%d, %d, %d), }", descr,
            fortran ? "True" : "False", NX, NY, NZ);
    start_npy(version, dict);
    for (int i = 0; i < NX * NY * NZ; i++) {
        uint64_t const r = next_random(&state) >> 20;
        uint64_t const bits = r % 3 == 0   ? 0
                              : r % 3 == 1 ? negative_zero
                                           : UINT64_C(1) << (r >> 8) % (uint64_t)(8 * size);
        set[i] = bits != 0 && bits != negative_zero;
        hand_number(&made, bits, size, big);
    }
    read_good_grid(made.bytes, made.size, BVX_FORMAT_NPY, NULL, &g);
    check_file_box(&g, 0, 0, 0, 1, 1, 1, NX, NY, NZ);
    for (int z = 0; z < NZ; z++)
        for (int y = 0; y < NY; y++)
            for (int x = 0; x < NX; x++)
                TEST_ASSERT_EQUAL_INT(set[fortran ? x + NX * (y + NY * z) : z + NZ * (y + NY * x)],
                                      bvx_grid_get(&g, x, y, z));
    check_windows(made.bytes, made.size, BVX_FORMAT_NPY, &g, 3);
    check_same_everywhere(made.bytes, made.size, BVX_FORMAT_NPY, &g);
    bvx_grid_free(ctx, &g);
}

static void test_npy_types(void)
{
    static const struct {
        char name[3];
        int size, is_float;
    } types[] = {{"b1", 1, 0}, {"u1", 1, 0}, {"i1", 1, 0}, {"u2", 2, 0}, {"i2", 2, 0}, {"u4", 4, 0},
                 {"i4", 4, 0}, {"u8", 8, 0}, {"i8", 8, 0}, {"f2", 2, 1}, {"f4", 4, 1}, {"f8", 8, 1}};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        for (int order = 0; order < 4; order++)
            for (int fortran = 0; fortran < 2; fortran++) {
                char descr[5] = {"<>|="[order], types[i].name[0], types[i].name[1], 0, 0};
                if (types[i].size > 4) continue;
                check_npy_type(descr, types[i].size,
                               types[i].is_float ? UINT64_C(1) << (8 * types[i].size - 1) : 0, fortran,
                               1 + (int)(i % 3));
            }
}

/* Wider numbers in a smaller array. */
static void test_npy_wide_types(void)
{
    static const char *const names[] = {"<f8", ">f8", "<i8", ">u8"};

    for (int i = 0; i < 4; i++) {
        char dict[100];
        bvx_grid g;
        int const big = names[i][0] == '>', is_float = names[i][1] == 'f';
        sprintf(dict, "{'descr': '%s', 'fortran_order': %s, 'shape': (66, 2, 3), }", names[i],
                i & 1 ? "True" : "False");
        start_npy(1, dict);
        for (int k = 0; k < 66 * 2 * 3; k++)
            hand_number(&made,
                        k % 3 == 0   ? 0
                        : k % 3 == 1 ? UINT64_C(1) << 63
                                     : UINT64_C(1) << k % 63,
                        8, big);
        read_good_grid(made.bytes, made.size, BVX_FORMAT_NPY, NULL, &g);
        for (int k = 0; k < 66 * 2 * 3; k++) {
            int const set = k % 3 == 2 || (k % 3 == 1 && !is_float);
            TEST_ASSERT_EQUAL_INT(set, i & 1 ? bvx_grid_get(&g, k % 66, k / 66 % 2, k / 132)
                                             : bvx_grid_get(&g, k / 6, k / 3 % 2, k % 3));
        }
        check_windows(made.bytes, made.size, BVX_FORMAT_NPY, &g, 3);
        bvx_grid_free(ctx, &g);
    }
}

static void test_npy_nan_and_denormals_are_set(void)
{
    static const uint32_t bits[8] = {0,           0x80000000u, 0x7fc00000u, 1,
                                     0x80000001u, 0xffc00000u, 0x7f800000u, 0x3f800000u};
    bvx_grid g;
    start_npy(1, "{'descr': '<f4', 'fortran_order': True, 'shape': (8, 1, 1), }");
    for (int i = 0; i < 8; i++) hand_number(&made, bits[i], 4, 0);
    read_good_grid(made.bytes, made.size, BVX_FORMAT_NPY, NULL, &g);
    TEST_ASSERT_EQUAL_HEX64(0xfc, g.words[0]);
    bvx_grid_free(ctx, &g);
}

/* Tiles of 512 by 512 with rests on all sides, z fastest, in the file's own order. */
static void test_npy_large_c_order(void)
{
    enum { NX = 577, NY = 2, NZ = 1091 };
    static const char dict[] = "{'descr': '|b1', 'fortran_order': False, 'shape': (577, 2, 1091), }";
    size_t const head = 128, size = head + (size_t)NX * NY * NZ;
    char *const file = calloc(size, 1);
    bvx_grid g = {0};
    uint64_t state = 4;
    memcpy(file, "\x93NUMPY\1\0\x76\0", 10);
    memset(file + 10, ' ', head - 10);
    memcpy(file + 10, dict, sizeof dict - 1);
    for (size_t i = head; i < size; i++) file[i] = next_random(&state) % 5 == 0;
    read_good_grid(file, size, BVX_FORMAT_NPY, NULL, &g);
    for (int x = 0; x < NX; x++)
        for (int y = 0; y < NY; y++)
            for (int z = 0; z < NZ; z++)
                if (file[head + ((size_t)x * NY + (size_t)y) * NZ + (size_t)z] != bvx_grid_get(&g, x, y, z))
                    TEST_FAIL_MESSAGE("a bit is wrong");
    check_windows(file, size, BVX_FORMAT_NPY, &g, 3);
    check_same_everywhere(file, size, BVX_FORMAT_NPY, &g);
    bvx_grid_free(ctx, &g);
    free(file);
}

static void check_npy_dict(const char *dict, size_t data, bvx_status status, const char *words)
{
    bvx_grid g;

    start_npy(1, dict);
    for (size_t i = 0; i < data; i++) hand_number(&made, 1, 1, 0);
    if (status == BVX_OK) {
        read_good_grid(made.bytes, made.size, BVX_FORMAT_NPY, NULL, &g);
        bvx_grid_free(ctx, &g);
    } else {
        check_grid_refused(made.bytes, made.size, BVX_FORMAT_NPY, status, words);
    }
}

static void test_npy_dictionaries(void)
{
    check_npy_dict("{\"shape\":(2,3,4),\"descr\":\"|u1\",\"fortran_order\":False}", 24, BVX_OK, "");
    check_npy_dict("{ 'fortran_order' : True , 'shape' : ( 2L , 3L , 4L , ) , 'descr' : '|b1' , }", 24,
                   BVX_OK, "");
    check_npy_dict("\t{\n'descr':'|i1','fortran_order':False,'shape':(2,3,4)}\n", 24, BVX_OK, "");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, 'shape': (2, 3, 4), }", 23, BVX_ERR_FORMAT,
                   "2 x 3 x 4 elements of 1 bytes");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, 'shape': (2, 3, 4), }", 25, BVX_ERR_FORMAT,
                   "25 bytes follow");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, 'shape': (2, 12), }", 24, BVX_ERR_UNSUPPORTED,
                   "2 axes");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, 'shape': (2, 3, 4, 1), }", 24,
                   BVX_ERR_UNSUPPORTED, "4 axes");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, 'shape': (), }", 24, BVX_ERR_UNSUPPORTED,
                   "0 axes");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, 'shape': (2, 0, 4), }", 0, BVX_ERR_FORMAT,
                   "no voxels along y");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, 'shape': (2, -3, 4), }", 24, BVX_ERR_FORMAT,
                   "expected a whole number, found '-'");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, 'shape': (33554433, 1, 1), }", 24, BVX_ERR_RANGE,
                   "33554433 voxels along x");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, 'shape': (4194304, 4194304, 4194304), }", 24,
                   BVX_ERR_FORMAT, "24 bytes");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, 'shape': (99999999999999999999999, 1, 1), }", 24,
                   BVX_ERR_RANGE, "along x");
    check_npy_dict("{'descr': '<c8', 'fortran_order': True, 'shape': (2, 3, 4), }", 192, BVX_ERR_UNSUPPORTED,
                   "'<c8'");
    check_npy_dict("{'descr': '|O', 'fortran_order': True, 'shape': (2, 3, 4), }", 24, BVX_ERR_UNSUPPORTED,
                   "'|O'");
    check_npy_dict("{'descr': [('a', '<f4')], 'fortran_order': True, 'shape': (2, 3, 4), }", 96,
                   BVX_ERR_UNSUPPORTED, "records");
    check_npy_dict("{'descr': '|b1', 'fortran_order': 1, 'shape': (2, 3, 4), }", 24, BVX_ERR_FORMAT,
                   "True or False");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, }", 24, BVX_ERR_FORMAT, "lacks");
    check_npy_dict("{'descr': '|b1', 'descr': '|b1', 'fortran_order': True, 'shape': (2, 3, 4), }", 24,
                   BVX_ERR_FORMAT, "once each");
    check_npy_dict("{'descr': '|b1', 'x': 1, 'fortran_order': True, 'shape': (2, 3, 4), }", 24,
                   BVX_ERR_FORMAT, "once each");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, 'shape': (2, 3, 4), } x", 24, BVX_ERR_FORMAT,
                   "the end of the head");
    check_npy_dict("{'descr': '|b\\x31', 'fortran_order': True, 'shape': (2, 3, 4), }", 24, BVX_ERR_FORMAT,
                   "the string's end");
    check_npy_dict("{'descr': '|b1' 'fortran_order': True, 'shape': (2, 3, 4), }", 24, BVX_ERR_FORMAT,
                   "',' or '}'");
    check_npy_dict("{'descr': '|b1', 'fortran_order': True, 'shape': (2 3 4), }", 24, BVX_ERR_FORMAT,
                   "',' or ')'");
    check_npy_dict("", 24, BVX_ERR_FORMAT, "the head ends");
}

static void test_npy_versions(void)
{
    start_npy(1, "{'descr': '|b1', 'fortran_order': True, 'shape': (1, 1, 1), }");
    hand_number(&made, 1, 1, 0);
    made.bytes[6] = 4;
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_NPY, BVX_ERR_UNSUPPORTED, "version 4.0");
    made.bytes[6] = 2; /* four bytes of length, of which two are text */
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_NPY, BVX_ERR_FORMAT, "in a file of");
    made.bytes[6] = 1;
    made.bytes[0] = 'X';
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_NPY, BVX_ERR_FORMAT, "does not begin");
}

static void test_npy_damage(void)
{
    start_npy(2, "{'descr': '<i2', 'fortran_order': False, 'shape': (5, 4, 3), }");
    for (int i = 0; i < 60; i++) hand_number(&made, (uint64_t)i % 2, 2, 0);
    check_every_cut(made.bytes, made.size, BVX_FORMAT_NPY, 0);
    check_every_number(made.bytes, made.size, 128, BVX_FORMAT_NPY);
    check_random_damage(made.bytes, made.size, BVX_FORMAT_NPY, 5000);
}

static void test_read_grid_arguments(void)
{
    bvx_grid g = {0};
    bvx_window w = {{0, 0, 0}, {3, 1, 1}};

    start_npy(1, "{'descr': '|b1', 'fortran_order': True, 'shape': (2, 1, 1), }");
    hand_number(&made, 0x0101, 2, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_read_grid(NULL, made.bytes, made.size, BVX_FORMAT_NPY, NULL, &g));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_grid(ctx, NULL, made.size, BVX_FORMAT_NPY, NULL, &g));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_read_grid(ctx, made.bytes, made.size, BVX_FORMAT_NPY, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_read_grid(ctx, made.bytes, made.size, BVX_FORMAT_STL, NULL, &g));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_read_grid(ctx, made.bytes, UINT64_MAX, BVX_FORMAT_NPY, NULL, &g));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, bvx_read_grid(ctx, made.bytes, 0, BVX_FORMAT_NPY, NULL, &g));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_read_grid(ctx, made.bytes, made.size, BVX_FORMAT_NPY, &w, &g));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "voxels 0 to 2 along x"));
    w.size[0] = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_read_grid(ctx, made.bytes, made.size, BVX_FORMAT_NPY, &w, &g));
    w.size[0] = INT32_MAX;
    w.low[0] = INT32_MAX;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_read_grid(ctx, made.bytes, made.size, BVX_FORMAT_NPY, &w, &g));
    w.low[0] = -1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_read_grid(ctx, made.bytes, made.size, BVX_FORMAT_NPY, &w, &g));
    TEST_ASSERT_NULL(g.words);
    memset(&w, 0, sizeof w); /* stands for all of it */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_grid(ctx, made.bytes, made.size, BVX_FORMAT_NPY, &w, &g));
    TEST_ASSERT_EQUAL_HEX64(3, g.words[0]);
    bvx_grid const before = g;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT,
                            bvx_read_grid(ctx, made.bytes, made.size - 1, BVX_FORMAT_NPY, NULL, &g));
    TEST_ASSERT_EQUAL_MEMORY(&before, &g, sizeof g); /* words of an earlier call stay */
    bvx_grid_free(ctx, &g);
}

static void test_npy_budget(void)
{
    bvx_context *const plain = ctx;
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};

    o.memory_limit = 39;
    start_npy(1, "{'descr': '|b1', 'fortran_order': True, 'shape': (1, 5, 1), }");
    hand_number(&made, 0x0101010101, 5, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_BUDGET, read_grid_file(made.bytes, made.size, BVX_FORMAT_NPY, NULL, &g));
    bvx_context_destroy(ctx);
    ctx = plain;
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_npy_rounds);
    RUN_TEST(test_npy_types);
    RUN_TEST(test_npy_wide_types);
    RUN_TEST(test_npy_nan_and_denormals_are_set);
    RUN_TEST(test_npy_large_c_order);
    RUN_TEST(test_npy_dictionaries);
    RUN_TEST(test_npy_versions);
    RUN_TEST(test_npy_damage);
    RUN_TEST(test_read_grid_arguments);
    RUN_TEST(test_npy_budget);
    return UNITY_END();
}
