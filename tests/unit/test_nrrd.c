/* test_nrrd.c - NRRD files of ours and of others, written out by hand. */
#include "dense_file_support.h"

static hand_file made;

/* A file of 3 x 2 x 2 samples of one byte, 1 0 1 0 ..., with these lines in its head. */
static void make_nrrd(const char *lines)
{
    made.size = 0;
    hand_text(&made, "NRRD0004\ndimension: 3\nsizes: 3 2 2\n%s\n", lines);
    for (int i = 0; i < 12; i++) hand_number(&made, (uint64_t)(i % 2 == 0), 1, 0);
}

static void read_nrrd(const char *lines, bvx_grid *g)
{
    make_nrrd(lines);
    read_good_grid(made.bytes, made.size, BVX_FORMAT_NRRD, NULL, g);
    for (int i = 0; i < 12; i++) TEST_ASSERT_EQUAL_INT(i % 2 == 0, bvx_grid_get(g, i % 3, i / 3 % 2, i / 6));
}

static void check_nrrd_place(const char *lines, double x, double y, double z, double sx, double sy, double sz)
{
    char all[600];
    bvx_grid g;
    sprintf(all, "type: uint8\nencoding: raw\n%s", lines);
    read_nrrd(all, &g);
    check_file_box(&g, x, y, z, sx, sy, sz, 3, 2, 2);
    bvx_grid_free(ctx, &g);
}

static void check_nrrd_refused(const char *lines, bvx_status status, const char *words)
{
    make_nrrd(lines);
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_NRRD, status, words);
}

static void test_nrrd_rounds(void)
{
    check_grid_rounds(BVX_FORMAT_NRRD, 1);
}

static void test_nrrd_writes_centres(void)
{
    static const double origin[3] = {10, 20, 30}, spacing[3] = {1, 2, 0.5};
    static const int32_t dims[3] = {5, 4, 3};
    static const bvx_window window = {{1, 2, 2}, {3, 2, 1}};
    static const char want[] = "NRRD0004\ntype: uint8\ndimension: 3\nspace dimension: 3\nsizes: 3 2 1\n"
                               "space directions: (1,0,0) (0,2,0) (0,0,0.5)\nspace origin: (11.5,25,31.25)\n"
                               "centerings: cell cell cell\nkinds: domain domain domain\nencoding: raw\n"
                               "bitvox low corner:=(11,24,31)\n\n";
    bvx_buffer b = {0};
    bvx_grid g = random_grid(origin, spacing, dims, &window, 3);

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_NRRD, &b));
    TEST_ASSERT_EQUAL_UINT64(sizeof want - 1 + 6, b.size);
    TEST_ASSERT_EQUAL_MEMORY(want, b.bytes, sizeof want - 1);
    for (int i = 0; i < 6; i++)
        TEST_ASSERT_EQUAL_UINT8(bvx_grid_get(&g, i % 3, i / 3, 0), b.bytes[sizeof want - 1 + (size_t)i]);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

static void test_nrrd_places(void)
{
    /* Without an origin the first sample's centre is at 0. */
    check_nrrd_place("", -0.5, -0.5, -0.5, 1, 1, 1);
    check_nrrd_place("spacings: 0.5 2 4\n", -0.25, -1, -2, 0.5, 2, 4);
    check_nrrd_place("spacings: nan 2 NaN\n", -0.5, -1, -0.5, 1, 2, 1);
    check_nrrd_place(
        "space: left-posterior-superior\nspace directions: (0.5,0,0) (0,2,0) (0,0,4)\nspace origin: (10,20,30)\n",
        9.75, 19, 28, 0.5, 2, 4);
    check_nrrd_place(
        "space dimension: 3\nspace directions: ( 0.5 , -0 , 0 )  (0,2,1e-12) (0,0,4)\nkinds: domain domain domain\n"
        "space origin: (10,20,30)\ncenterings: node cell ???\n",
        9.75, 19, 28, 0.5, 2, 4);
    check_nrrd_place("space dimension: 3\nspacings: 0.5 2 4\nspace origin: (10,20,30)\n", 9.75, 19, 28, 0.5,
                     2, 4);
    check_nrrd_place("axis mins: 1 2 3\nspacings: 0.5 2 4\n", 1, 2, 3, 0.5, 2, 4); /* open: cells */
    check_nrrd_place("axis mins: 1 2 3\nspacings: 0.5 2 4\ncenters: cell node cell\n", 1, 1, 3, 0.5, 2, 4);
    check_nrrd_place("axismins: 1 2 3\naxismaxs: 4 6 7\ncenters: cell node cell\n", 1, 0, 3, 1, 4, 2);
    check_nrrd_place("Axis Mins: 1 nan 3\nCenterings: Cell Node Cell\n", 1, -0.5, 3, 1, 1, 1);
}

/* The corner that our writer keeps counts where it leads to the file's first sample, else not. */
static void test_nrrd_corner_key(void)
{
    check_nrrd_place(
        "space dimension: 3\nspace directions: (0.3,0,0) (0,1,0) (0,0,1)\nspace origin: (0.25,0.5,0.5)\n"
        "bitvox low corner:=(0.1,0,0)\n",
        0.1, 0, 0, 0.3, 1, 1);
    check_nrrd_place(
        "space dimension: 3\nspace directions: (2,0,0) (0,1,0) (0,0,1)\nspace origin: (7,0.5,0.5)\n"
        "bitvox low corner:=(5,0,0)\n",
        6, 0, 0, 2, 1, 1);
    check_nrrd_place("bitvox low corner:=(5,0,0)\n", -0.5, -0.5, -0.5, 1, 1, 1);
    check_nrrd_place("bitvox low corner:=(5,0\n", -0.5, -0.5, -0.5, 1, 1, 1);
}

static void test_nrrd_heads(void)
{
    static const char *const types[] = {"uchar",       "unsigned char", "uint8",  "uint8_t",
                                        "signed char", "int8",          "int8_t", "UChar"};
    bvx_grid g;
    char lines[200];

    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++) {
        sprintf(
            lines,
            "# a comment: here\ntype: %s\nkey:=value: with := more\nencoding:RAW\n#\ncontent: anything : at all\n",
            types[i]);
        read_nrrd(lines, &g);
        bvx_grid_free(ctx, &g);
    }
    for (char version = '1'; version <= '5'; version++) {
        make_nrrd("type: uint8\nencoding: raw\n");
        made.bytes[7] = (uint8_t)version;
        read_good_grid(made.bytes, made.size, BVX_FORMAT_NRRD, NULL, &g);
        bvx_grid_free(ctx, &g);
    }
    made.size = 0; /* lines that end with carriage return and newline */
    hand_text(&made, "NRRD0001\r\ntype: uint8\r\ndimension: 3\r\nsizes: 2 1 1\r\nencoding: raw\r\n\r\n");
    hand_number(&made, 0x0d0a, 2, 0);
    read_good_grid(made.bytes, made.size, BVX_FORMAT_NRRD, NULL, &g);
    TEST_ASSERT_EQUAL_HEX64(3, g.words[0]);
    bvx_grid_free(ctx, &g);
}

/* Every type of several bytes in both byte orders. */
static void test_nrrd_types(void)
{
    static const struct {
        const char *name;
        int size, is_float;
    } types[] = {{"short", 2, 0},
                 {"short int", 2, 0},
                 {"signed short", 2, 0},
                 {"signed short int", 2, 0},
                 {"int16", 2, 0},
                 {"int16_t", 2, 0},
                 {"ushort", 2, 0},
                 {"unsigned short", 2, 0},
                 {"unsigned short int", 2, 0},
                 {"uint16", 2, 0},
                 {"uint16_t", 2, 0},
                 {"int", 4, 0},
                 {"signed int", 4, 0},
                 {"int32", 4, 0},
                 {"int32_t", 4, 0},
                 {"uint", 4, 0},
                 {"unsigned int", 4, 0},
                 {"uint32", 4, 0},
                 {"uint32_t", 4, 0},
                 {"longlong", 8, 0},
                 {"long long", 8, 0},
                 {"long long int", 8, 0},
                 {"signed long long", 8, 0},
                 {"signed long long int", 8, 0},
                 {"int64", 8, 0},
                 {"int64_t", 8, 0},
                 {"ulonglong", 8, 0},
                 {"unsigned long long", 8, 0},
                 {"unsigned long long int", 8, 0},
                 {"uint64", 8, 0},
                 {"uint64_t", 8, 0},
                 {"float", 4, 1},
                 {"double", 8, 1}};
    for (size_t i = 0; i < sizeof types / sizeof types[0]; i++)
        for (int big = 0; big < 2; big++) {
            int const size = types[i].size;
            bvx_grid g;
            made.size = 0;
            hand_text(&made, "NRRD0005\ntype: %s\ndimension: 3\nsizes: 66 2 2\nendian: %s\nencoding: raw\n\n",
                      types[i].name, big ? "big" : "little");
            for (int k = 0; k < 66 * 4; k++)
                hand_number(&made,
                            k % 3 == 0   ? 0
                            : k % 3 == 1 ? UINT64_C(1) << (8 * size - 1)
                                         : UINT64_C(1) << k % (8 * size - 1),
                            size, big);
            read_good_grid(made.bytes, made.size, BVX_FORMAT_NRRD, NULL, &g);
            for (int k = 0; k < 66 * 4; k++)
                TEST_ASSERT_EQUAL_INT(k % 3 == 2 || (k % 3 == 1 && !types[i].is_float),
                                      bvx_grid_get(&g, k % 66, k / 66 % 2, k / 132));
            bvx_grid_free(ctx, &g);
        }
}

static void make_nrrd_text(const char *type, const char *encoding, const char *samples)
{
    made.size = 0;
    hand_text(&made, "NRRD0002\ntype: %s\ndimension: 3\nsizes: 2 2 2\nencoding: %s\n\n%s", type, encoding,
              samples);
}

static void test_nrrd_text(void)
{
    static const bvx_window window = {{1, 0, 1}, {1, 2, 1}};
    static const char *const names[3] = {"ascii", "text", "txt"};
    bvx_grid g;

    for (int i = 0; i < 3; i++) {
        make_nrrd_text("float", names[i], "0 1 -0.0 nan\n 1e-400 0.5\t-3\r\n0e9");
        read_good_grid(made.bytes, made.size, BVX_FORMAT_NRRD, NULL, &g);
        for (int k = 0; k < 8; k++)
            TEST_ASSERT_EQUAL_INT(0x6a >> k & 1, bvx_grid_get(&g, k & 1, k >> 1 & 1, k >> 2));
        bvx_grid_free(ctx, &g);
        read_good_grid(made.bytes, made.size, BVX_FORMAT_NRRD, &window, &g);
        TEST_ASSERT_TRUE(bvx_grid_get(&g, 0, 0, 0) == 1 && bvx_grid_get(&g, 0, 1, 0) == 0);
        bvx_grid_free(ctx, &g);
    }
    make_nrrd_text("uint8", "ascii", "0 1 0 1 0 1 0\n\n   ");
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_NRRD, BVX_ERR_FORMAT,
                       "line 9: the samples end after 7 of 2 x 2 x 2");
    make_nrrd_text("uint8", "ascii", "0 1 0 1 0 1 0 1 1");
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_NRRD, BVX_ERR_FORMAT,
                       "line 7: expected the end of the file");
    make_nrrd_text("uint8", "ascii", "0 1 0 1\n0 x 0 1 1");
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_NRRD, BVX_ERR_FORMAT,
                       "line 8: expected a number, found 'x'");
    make_nrrd_text("uint8", "ascii", "0 1 0 1\n0 1x 0 1");
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_NRRD, BVX_ERR_FORMAT, "found '1x'");
    make_nrrd_text("uint8", "ascii", "0 1");
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_NRRD, BVX_ERR_FORMAT,
                       "at least 15 bytes, but the file has 3");
}

static void test_nrrd_skips(void)
{
    bvx_grid g;

    made.size = 0;
    hand_text(
        &made,
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 1 1\nencoding: raw\nline skip: 2\nbyte skip: 3\n\none\ntwo\nabc");
    hand_number(&made, 0x0100, 2, 0);
    read_good_grid(made.bytes, made.size, BVX_FORMAT_NRRD, NULL, &g);
    TEST_ASSERT_EQUAL_HEX64(2, g.words[0]);
    bvx_grid_free(ctx, &g);
    check_grid_refused(made.bytes, made.size - 1, BVX_FORMAT_NRRD, BVX_ERR_FORMAT,
                       "2 bytes, but the file has 1");
    check_grid_refused(made.bytes, made.size - 6, BVX_FORMAT_NRRD, BVX_ERR_FORMAT, "fewer than 2 lines");
    made.size = 0;
    hand_text(&made,
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 1 1\nencoding: raw\nbyteskip: -1\n\nanything");
    hand_number(&made, 0x0100, 2, 0);
    read_good_grid(made.bytes, made.size, BVX_FORMAT_NRRD, NULL, &g);
    TEST_ASSERT_EQUAL_HEX64(2, g.words[0]);
    bvx_grid_free(ctx, &g);
    check_nrrd_refused("type: uint8\nencoding: ascii\nbyte skip: -1\n", BVX_ERR_FORMAT,
                       "requires encoding raw");
    check_nrrd_refused("type: uint8\nencoding: raw\nbyte skip: -2\n", BVX_ERR_FORMAT, "0 bytes or more");
    check_nrrd_refused("type: uint8\nencoding: raw\nbyte skip: 13\n", BVX_ERR_FORMAT,
                       "13 bytes to skip, but 12");
    check_nrrd_refused("type: uint8\nencoding: raw\nbyte skip: 99999999999999999999\n", BVX_ERR_FORMAT,
                       "bytes to skip");
    check_nrrd_refused("type: uint8\nencoding: raw\nline skip: -1\n", BVX_ERR_FORMAT, "0 lines or more");
}

static void test_nrrd_refuses(void)
{
    check_nrrd_refused("type: uint8\nencoding: raw\nspacing: 1 1 1\n", BVX_ERR_FORMAT,
                       "line 6: expected a field of the NRRD format, found 'spacing:'");
    check_nrrd_refused("type: uint8\nencoding: raw\ntype: uint8\n", BVX_ERR_FORMAT, "each field once");
    check_nrrd_refused("type: uint8\nencoding: raw\nno field\n", BVX_ERR_FORMAT, "a field and a colon");
    check_nrrd_refused("type: char\nencoding: raw\n", BVX_ERR_FORMAT, "a type of samples");
    check_nrrd_refused("type: block\nblock size: 3\nencoding: raw\n", BVX_ERR_UNSUPPORTED, "type block");
    check_nrrd_refused("type: uint8\nencoding: gzip\n", BVX_ERR_UNSUPPORTED, "save them with encoding raw");
    check_nrrd_refused("type: uint8\nencoding: bz2\n", BVX_ERR_UNSUPPORTED, "save them with encoding raw");
    check_nrrd_refused("type: uint8\nencoding: lzma\n", BVX_ERR_FORMAT, "an encoding");
    check_nrrd_refused("type: uint8\nencoding: raw\ndata file: other.raw\n", BVX_ERR_UNSUPPORTED,
                       "another file");
    check_nrrd_refused("type: uint8\n", BVX_ERR_FORMAT, "no field 'encoding'");
    check_nrrd_refused("encoding: raw\n", BVX_ERR_FORMAT, "no field 'type'");
    check_nrrd_refused("type: short\nencoding: raw\n", BVX_ERR_FORMAT, "no field 'endian'");
    check_nrrd_refused("type: short\nencoding: raw\nendian: middle\n", BVX_ERR_FORMAT, "little or big");
    check_nrrd_refused("type: short\nencoding: raw\nendian: little\n", BVX_ERR_FORMAT,
                       "3 x 2 x 2 samples are 24 bytes, but the file has 12");
    check_nrrd_refused("type: uint8\nencoding: raw\nspacings: 1 1\n", BVX_ERR_FORMAT, "a number");
    check_nrrd_refused("type: uint8\nencoding: raw\nspacings: 1 1 1 1\n", BVX_ERR_FORMAT,
                       "the end of the line");
    check_nrrd_refused("type: uint8\nencoding: raw\nspacings: 1 1mm 1\n", BVX_ERR_FORMAT, "a number");
    check_nrrd_refused("type: uint8\nencoding: raw\nspacings: 1 -1 1\n", BVX_ERR_FORMAT,
                       "spacing along y is -1");
    check_nrrd_refused("type: uint8\nencoding: raw\nspacings: 1 0 1\n", BVX_ERR_FORMAT,
                       "spacing along y is 0");
    check_nrrd_refused("type: uint8\nencoding: raw\nspace dimension: 4\n", BVX_ERR_UNSUPPORTED,
                       "space dimension is not 3");
    check_nrrd_refused("type: uint8\nencoding: raw\nspace directions: none (0,1,0) (0,0,1)\n",
                       BVX_ERR_UNSUPPORTED, "no space direction");
    check_nrrd_refused("type: uint8\nencoding: raw\nspace directions: (0,1,0) (1,0,0) (0,0,1)\n",
                       BVX_ERR_UNSUPPORTED, "turned or mirrored");
    check_nrrd_refused("type: uint8\nencoding: raw\nspace directions: (1,0,0) (0,-1,0) (0,0,1)\n",
                       BVX_ERR_UNSUPPORTED, "turned or mirrored");
    check_nrrd_refused("type: uint8\nencoding: raw\nspace directions: (1,0,0) (0,1,1e-3) (0,0,1)\n",
                       BVX_ERR_UNSUPPORTED, "turned or mirrored");
    check_nrrd_refused("type: uint8\nencoding: raw\nspace directions: (0,0,0) (0,1,0) (0,0,1)\n",
                       BVX_ERR_FORMAT, "spacing along x is 0");
    check_nrrd_refused("type: uint8\nencoding: raw\nspace directions: (1,0,0) (0,1,0) (0,0)\n",
                       BVX_ERR_FORMAT, "a vector of three");
    check_nrrd_refused("type: uint8\nencoding: raw\nspace origin: (inf,0,0)\n", BVX_ERR_FORMAT,
                       "origin is not finite along x");
    check_nrrd_refused("type: uint8\nencoding: raw\ncenters: cell cell\n", BVX_ERR_FORMAT,
                       "cell, node, none or ???");
    check_nrrd_refused("type: uint8\nencoding: raw\nkinds: RGB-color domain domain\n", BVX_ERR_UNSUPPORTED,
                       "not a position in space");
    check_nrrd_refused("type: uint8\nencoding: raw\nkinds: domain domain\n", BVX_ERR_FORMAT,
                       "a kind for each axis");
    made.size = 0;
    hand_text(&made, "NRRD0004\ntype: uint8\ndimension: 4\nsizes: 1 1 1 1\nencoding: raw\n\n1");
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_NRRD, BVX_ERR_UNSUPPORTED,
                       "line 3: the dimension is not 3");
    made.size = 0;
    hand_text(&made,
              "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 4194304 4194304 4194304\nencoding: raw\n\n1");
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_NRRD, BVX_ERR_FORMAT, "more than any file holds");
    made.size = 0;
    hand_text(&made, "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 1 1 1\nencoding: raw\n\n11");
    check_grid_refused(made.bytes, made.size, BVX_FORMAT_NRRD, BVX_ERR_FORMAT,
                       "1 x 1 x 1 samples are 1 bytes, but the file has 2");
    check_grid_refused("NRRD0006\n\n", 10, BVX_FORMAT_NRRD, BVX_ERR_UNSUPPORTED, "a version other");
    check_grid_refused("NRRD00011\n\n", 11, BVX_FORMAT_NRRD, BVX_ERR_FORMAT, "does not begin");
    check_grid_refused("NRRD0001", 8, BVX_FORMAT_NRRD, BVX_ERR_FORMAT, "ends in its head");
}

static void test_nrrd_damage(void)
{
    make_nrrd(
        "type: uint8\nspace dimension: 3\nspace directions: (0.5,0,0) (0,2,0) (0,0,4)\nspace origin: (10,20,30)\nencoding: raw\n");
    check_every_cut(made.bytes, made.size, BVX_FORMAT_NRRD, 0);
    TEST_ASSERT_TRUE(check_every_number(made.bytes, made.size, made.size - 12, BVX_FORMAT_NRRD) > 10);
    check_random_damage(made.bytes, made.size, BVX_FORMAT_NRRD, 5000);
    make_nrrd_text("int", "ascii", "0 1 0 1\n1 0 1 0\n");
    check_every_cut(made.bytes, made.size, BVX_FORMAT_NRRD, 1);
    check_every_number(made.bytes, made.size, made.size, BVX_FORMAT_NRRD);
    check_random_damage(made.bytes, made.size, BVX_FORMAT_NRRD, 5000);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_nrrd_rounds);
    RUN_TEST(test_nrrd_writes_centres);
    RUN_TEST(test_nrrd_places);
    RUN_TEST(test_nrrd_corner_key);
    RUN_TEST(test_nrrd_heads);
    RUN_TEST(test_nrrd_types);
    RUN_TEST(test_nrrd_text);
    RUN_TEST(test_nrrd_skips);
    RUN_TEST(test_nrrd_refuses);
    RUN_TEST(test_nrrd_damage);
    return UNITY_END();
}
