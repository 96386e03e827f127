/* test_lattice_json.c - the side-car of a lattice. */
#include "dense_file_support.h"

static const double side_origin[3] = {0.1, -17.3, 1e6 / 3}, side_spacing[3] = {0.3, 1.0 / 3, 7e-3};
static const int32_t side_dims[3] = {150, 40, 30};
static const bvx_window side_window = {{61, 3, 11}, {70, 9, 5}};

static bvx_status read_side_car(const void *text, size_t size, bvx_grid *g)
{
    bvx_grid const before = *g;
    char *const copy = malloc(size + 1);

    memcpy(copy, text, size);
    bvx_status const status = bvx_read_lattice(ctx, copy, size, g);
    free(copy);
    if (status != BVX_OK) {
        TEST_ASSERT_EQUAL_MEMORY(&before, g, sizeof before);
        TEST_ASSERT_TRUE(strlen(bvx_last_message(ctx)) > 10 && strchr(bvx_last_message(ctx), '\n') == NULL);
    }
    return status;
}

static void test_lattice_text(void)
{
    static const double origin[3] = {1, -2.5, 1e21}, spacing[3] = {0.1, 2, 1e6};
    static const int32_t dims[3] = {5, 4, 3};
    static const bvx_window window = {{1, 2, 0}, {3, 2, 1}};
    static const char want[] =
        "{\n  \"format\": \"bitvox lattice\",\n  \"version\": 1,\n  \"origin\": [1, -2.5, 1e21],\n"
        "  \"spacing\": [0.1, 2, 1000000],\n  \"dims\": [5, 4, 3],\n  \"fraction_bits\": 16,\n"
        "  \"window\": {\"low\": [1, 2, 0], \"size\": [3, 2, 1]},\n  \"center0\": [1.15, 2.5, 1.0000000000000005e21],\n"
        "  \"axes\": \"xyz\"\n}\n";
    bvx_buffer b = {0};
    bvx_grid g = random_grid(origin, spacing, dims, &window, 3);

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_lattice(ctx, &g, &b));
    char *const text = calloc((size_t)b.size + 1, 1);
    memcpy(text, b.bytes, (size_t)b.size);
    TEST_ASSERT_EQUAL_STRING(want, text);
    free(text);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

/* A grid through .npy and its side-car is the grid that was. */
static void test_lattice_rounds(void)
{
    bvx_buffer b = {0}, car = {0};
    uint64_t want, got;
    bvx_grid g = random_grid(side_origin, side_spacing, side_dims, &side_window, 3), back = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_NPY, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_lattice(ctx, &g, &car));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_grid(ctx, b.bytes, b.size, BVX_FORMAT_NPY, NULL, &back));
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_side_car(car.bytes, (size_t)car.size, &back),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_MEMORY(&g.lattice, &back.lattice, sizeof g.lattice);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(ctx, &g, &want));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(ctx, &back, &got));
    TEST_ASSERT_EQUAL_HEX64(want, got);
    bvx_buffer_free(ctx, &car);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &back);
    bvx_grid_free(ctx, &g);
}

/* Numbers of all sizes come back bit for bit. */
static void test_lattice_numbers(void)
{
    uint64_t state = 11;

    for (int i = 0; i < 300; i++) {
        static const int32_t dims[3] = {3, 1, 2};
        double v[6];
        bvx_buffer car = {0};
        bvx_grid back = {0};
        for (int a = 0; a < 6; a++) {
            uint64_t const exponent = (uint64_t)(a < 3 ? 1 + next_random(&state) % 2000
                                                       : 900 + next_random(&state) % 900);
            uint64_t const bits = (next_random(&state) & UINT64_C(0x800fffffffffffff)) | exponent << 52;
            memcpy(&v[a], &bits, sizeof v[a]);
            if (a >= 3 && v[a] < 0) v[a] = -v[a];
        }
        bvx_grid g = random_grid(v, v + 3, dims, NULL, 1);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_lattice(ctx, &g, &car));
        back = random_grid(side_origin, side_spacing, dims, NULL, 1);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_side_car(car.bytes, (size_t)car.size, &back),
                                        bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_MEMORY(&g.lattice, &back.lattice, sizeof g.lattice);
        bvx_buffer_free(ctx, &car);
        bvx_grid_free(ctx, &back);
        bvx_grid_free(ctx, &g);
    }
}

/* ---- other writers ---- */

#define SIDE_HEAD   "{\"format\":\"bitvox lattice\",\"version\":1,"
#define SIDE_PLACE  "\"origin\":[1,2,3],\"spacing\":[0.5,1,2],"
#define SIDE_DIMS   "\"dims\":[9,8,7],\"fraction_bits\":16,"
#define SIDE_WINDOW "\"window\":{\"low\":[1,2,3],\"size\":[2,1,3]},"
#define SIDE_TAIL   "\"center0\":[1.75,4.5,10],\"axes\":\"xyz\"}"
#define SIDE_GOOD   SIDE_HEAD SIDE_PLACE SIDE_DIMS SIDE_WINDOW SIDE_TAIL

static void check_side_car(const char *text, bvx_status status, const char *words)
{
    static const int32_t dims[3] = {2, 1, 3};
    bvx_grid g = random_grid(side_origin, side_spacing, dims, NULL, 1);
    bvx_status const got = read_side_car(text, strlen(text), &g);

    TEST_ASSERT_EQUAL_INT32_MESSAGE(status, got, got == BVX_OK ? text : bvx_last_message(ctx));
    if (status == BVX_OK) {
        static const int32_t low[3] = {1, 2, 3};
        TEST_ASSERT_TRUE(g.lattice.origin[0] == 1 && g.lattice.origin[1] == 2 && g.lattice.origin[2] == 3);
        TEST_ASSERT_TRUE(g.lattice.spacing[0] == 0.5 && g.lattice.spacing[1] == 1 &&
                         g.lattice.spacing[2] == 2);
        TEST_ASSERT_TRUE(g.lattice.dims[0] == 9 && g.lattice.dims[1] == 8 && g.lattice.dims[2] == 7 &&
                         g.lattice.fraction_bits == 16);
        TEST_ASSERT_EQUAL_INT32_ARRAY(low, g.low, 3);
    } else if (strstr(bvx_last_message(ctx), words) == NULL) {
        TEST_ASSERT_EQUAL_STRING_MESSAGE(words, bvx_last_message(ctx), "the message lacks these words");
    }
    bvx_grid_free(ctx, &g);
}

static void test_lattice_forms(void)
{
    check_side_car(SIDE_GOOD, BVX_OK, "");
    check_side_car("\xef\xbb\xbf \t\r\n" SIDE_GOOD "\n", BVX_OK, "");
    check_side_car(
        "{\"axes\" : \"xyz\" , \"center0\":[ 17.5e-1 , 4.5000001,1E1],\n" SIDE_WINDOW SIDE_PLACE SIDE_DIMS
        "\"version\":1.0,\"format\":\"bitvox lattice\"}",
        BVX_OK, "");
    check_side_car(
        SIDE_HEAD
        "\"note\":\"a \\\" b\\\\\",\"x\":[],\"y\":{},\"z\":[1,[2,{\"a\":[true,false,null,-1.5e+3,\"\"]}],{\"b\":{},\"c\":1}]," SIDE_PLACE
            SIDE_DIMS "\"window\":{\"low\":[1,2,3],\"more\":[[[{}]]],\"size\":[2,1,3]}," SIDE_TAIL,
        BVX_OK, "");
}

static void test_lattice_refuses(void)
{
    check_side_car("", BVX_ERR_FORMAT, "a value was expected");
    check_side_car("[]", BVX_ERR_FORMAT, "'{'");
    check_side_car("{}", BVX_ERR_FORMAT, "\"format\" is missing");
    check_side_car(SIDE_HEAD SIDE_PLACE SIDE_DIMS SIDE_TAIL, BVX_ERR_FORMAT, "\"window\" is missing");
    check_side_car(SIDE_HEAD SIDE_PLACE SIDE_DIMS "\"window\":{\"low\":[1,2,3]}," SIDE_TAIL, BVX_ERR_FORMAT,
                   "\"size\" is missing");
    check_side_car(SIDE_HEAD SIDE_PLACE SIDE_PLACE SIDE_DIMS SIDE_WINDOW SIDE_TAIL, BVX_ERR_FORMAT,
                   "each key once");
    check_side_car("{\"format\":\"other\",\"version\":1," SIDE_PLACE SIDE_DIMS SIDE_WINDOW SIDE_TAIL,
                   BVX_ERR_FORMAT, "\"bitvox lattice\"");
    check_side_car("{\"format\":\"bitvox lattice\",\"version\":2," SIDE_PLACE SIDE_DIMS SIDE_WINDOW SIDE_TAIL,
                   BVX_ERR_FORMAT, "version 2");
    check_side_car(SIDE_HEAD SIDE_PLACE SIDE_DIMS SIDE_WINDOW "\"center0\":[1.75,4.5,10],\"axes\":\"zyx\"}",
                   BVX_ERR_FORMAT, "\"xyz\"");
    check_side_car(SIDE_HEAD SIDE_PLACE SIDE_DIMS SIDE_WINDOW "\"center0\":[1.75,4.5,9],\"axes\":\"xyz\"}",
                   BVX_ERR_FORMAT, "center0 is 9 along z, but origin, spacing and window give 10");
    check_side_car(SIDE_HEAD SIDE_PLACE SIDE_DIMS "\"window\":{\"low\":[1,2,3],\"size\":[2,1,4]}," SIDE_TAIL,
                   BVX_ERR_LATTICE, "4 voxels along z, the grid 3");
    check_side_car(SIDE_HEAD SIDE_PLACE SIDE_DIMS "\"window\":{\"low\":[8,2,3],\"size\":[2,1,3]}," SIDE_TAIL,
                   BVX_ERR_FORMAT, "not inside");
    check_side_car(SIDE_HEAD SIDE_PLACE SIDE_DIMS
                   "\"window\":{\"low\":[2147483647,2,3],\"size\":[2,1,3]}," SIDE_TAIL,
                   BVX_ERR_FORMAT, "not inside");
    check_side_car(SIDE_HEAD "\"origin\":[1,2,3],\"spacing\":[0.5,0,2]," SIDE_DIMS SIDE_WINDOW SIDE_TAIL,
                   BVX_ERR_FORMAT, "spacing along y is 0");
    check_side_car(SIDE_HEAD "\"origin\":[1,2,1e999],\"spacing\":[0.5,1,2]," SIDE_DIMS SIDE_WINDOW SIDE_TAIL,
                   BVX_ERR_FORMAT, "not finite along z");
    check_side_car(SIDE_HEAD SIDE_PLACE "\"dims\":[9,8,7],\"fraction_bits\":17," SIDE_WINDOW SIDE_TAIL,
                   BVX_ERR_FORMAT, "17 fraction bits");
    check_side_car(SIDE_HEAD SIDE_PLACE "\"dims\":[9,8,33554433],\"fraction_bits\":4," SIDE_WINDOW SIDE_TAIL,
                   BVX_ERR_FORMAT, "33554433 voxels along z");
    check_side_car(SIDE_HEAD SIDE_PLACE "\"dims\":[9,8,7.5],\"fraction_bits\":4," SIDE_WINDOW SIDE_TAIL,
                   BVX_ERR_FORMAT, "a whole number");
    check_side_car(SIDE_HEAD SIDE_PLACE "\"dims\":[9,8,-7],\"fraction_bits\":4," SIDE_WINDOW SIDE_TAIL,
                   BVX_ERR_FORMAT, "a whole number");
    check_side_car(SIDE_HEAD SIDE_PLACE
                   "\"dims\":[9,8,4294967296],\"fraction_bits\":4," SIDE_WINDOW SIDE_TAIL,
                   BVX_ERR_FORMAT, "a whole number");
    check_side_car(SIDE_HEAD "\"origin\":[1,2],\"spacing\":[0.5,1,2]," SIDE_DIMS SIDE_WINDOW SIDE_TAIL,
                   BVX_ERR_FORMAT, "three numbers between brackets");
    check_side_car(SIDE_HEAD "\"origin\":[1,2,3,4],\"spacing\":[0.5,1,2]," SIDE_DIMS SIDE_WINDOW SIDE_TAIL,
                   BVX_ERR_FORMAT, "three numbers between brackets");
    check_side_car(SIDE_GOOD "x", BVX_ERR_FORMAT, "nothing after the value");
    check_side_car(SIDE_GOOD "{}", BVX_ERR_FORMAT, "nothing after the value");
}

/* Numbers that JSON does not have, and values passed over that are none. */
static void test_lattice_refuses_bad_json(void)
{
    static const char *const numbers[] = {"+1", ".5",  "1.",       "01",  "1e",    "1e+",
                                          "-",  "NaN", "Infinity", "0x1", "\"1\"", "null"};
    static const char *const values[] = {"[1,]", "{\"a\"}",   "{\"a\":}", "{\"a\":1,}", "[1 2]",
                                         "[1}",  "{\"a\":1]", "{1:2}",    "tru",        "\"\n\"",
                                         "[",    "\"abc",     "",         "nul"};
    char text[600];

    for (size_t i = 0; i < sizeof numbers / sizeof numbers[0]; i++) {
        sprintf(text, SIDE_HEAD "\"origin\":[%s,2,3],\"spacing\":[0.5,1,2]," SIDE_DIMS SIDE_WINDOW SIDE_TAIL,
                numbers[i]);
        check_side_car(text, BVX_ERR_FORMAT, "expected");
    }
    for (size_t i = 0; i < sizeof values / sizeof values[0]; i++) {
        sprintf(text, SIDE_HEAD "\"other\":%s," SIDE_PLACE SIDE_DIMS SIDE_WINDOW SIDE_TAIL, values[i]);
        check_side_car(text, BVX_ERR_FORMAT, "expected");
    }
}

static void test_lattice_depth(void)
{
    for (int depth = 62; depth <= 65; depth++) {
        char text[1200] = SIDE_HEAD "\"deep\":";
        for (int i = 0; i < depth; i++) strcat(text, i % 3 == 0 ? "{\"a\":" : "[");
        strcat(text, "0");
        for (int i = depth; i-- > 0;) strcat(text, i % 3 == 0 ? "}" : "]");
        strcat(text, "," SIDE_PLACE SIDE_DIMS SIDE_WINDOW SIDE_TAIL);
        check_side_car(text, depth <= 63 ? BVX_OK : BVX_ERR_FORMAT, "in each other");
    }
}

static void test_lattice_damage(void)
{
    static const char good[] = SIDE_HEAD
        "\"other\":[1,{\"a\":\"\\\"\"}]," SIDE_PLACE SIDE_DIMS SIDE_WINDOW SIDE_TAIL;
    static const char *const with[] = {"0", "1", "-1", "2147483648", "4294967295", "1e400", ""};
    static const int32_t dims[3] = {2, 1, 3};
    uint64_t state = 77;
    char changed[sizeof good + 20];
    bvx_grid g = random_grid(side_origin, side_spacing, dims, NULL, 1);
    uint64_t const used = bvx_memory_used(ctx);

    bvx_memory_reset_peak(ctx);
    for (size_t n = 0; n < sizeof good - 1; n++)
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, read_side_car(good, n, &g));
    for (size_t i = 0; i + 1 < sizeof good; i++)
        for (size_t k = 0; good[i] >= '0' && good[i] <= '9' && k < sizeof with / sizeof with[0]; k++) {
            size_t const n = strlen(with[k]);
            memcpy(changed, good, i);
            memcpy(changed + i, with[k], n);
            memcpy(changed + i + n, good + i + 1, sizeof good - 2 - i);
            read_side_car(changed, sizeof good - 2 + n, &g);
        }
    for (int i = 0; i < 20000; i++) {
        memcpy(changed, good, sizeof good);
        for (uint64_t k = next_random(&state) % 3 + 1; k > 0; k--)
            changed[(next_random(&state) >> 16) % (sizeof good - 1)] = (char)(next_random(&state) >> 24 &
                                                                              0x7f);
        read_side_car(changed, sizeof good - 1, &g);
    }
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) <= used + 8 * sizeof good + 1024);
    TEST_ASSERT_EQUAL_UINT64(used, bvx_memory_used(ctx));
    bvx_grid_free(ctx, &g);
}

static void test_lattice_arguments(void)
{
    bvx_buffer b = {0};
    bvx_grid none = {0};
    bvx_grid g = random_grid(side_origin, side_spacing, side_dims, &side_window, 3);

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_lattice(NULL, &g, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_lattice(ctx, NULL, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_lattice(ctx, &none, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_lattice(ctx, &g, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_lattice(NULL, "{}", 2, &g));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_lattice(ctx, NULL, 2, &g));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_lattice(ctx, "{}", 2, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_lattice(ctx, "{}", UINT64_MAX, &g));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_lattice(ctx, "{}", 2, &none));
    TEST_ASSERT_NULL(b.bytes);
    g.lattice.origin[0] = 1.7e308; /* the window's centre is beyond doubles */
    g.lattice.spacing[0] = 1e307;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_lattice(ctx, &g, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_grid(ctx, &g, BVX_FORMAT_NRRD, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_grid(ctx, &g, BVX_FORMAT_VTI, &b));
    TEST_ASSERT_NULL(b.bytes);
    bvx_grid_free(ctx, &g);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_lattice_text);
    RUN_TEST(test_lattice_rounds);
    RUN_TEST(test_lattice_numbers);
    RUN_TEST(test_lattice_forms);
    RUN_TEST(test_lattice_refuses);
    RUN_TEST(test_lattice_refuses_bad_json);
    RUN_TEST(test_lattice_depth);
    RUN_TEST(test_lattice_damage);
    RUN_TEST(test_lattice_arguments);
    return UNITY_END();
}
