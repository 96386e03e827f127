/* test_read_off.c - OFF files right and wrong. */
#include "comma_locale.h"
#include "read_support.h"
#include "tools/fault.h"

enum { OFF = BVX_FORMAT_OFF };

static bvx_mesh read_good(const char *text)
{
    bvx_mesh m;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(text, strlen(text), OFF, &m), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32(BVX_F64, m.position_type);
    return m;
}

/* ---- good files ---- */

#define SQUARE "0 0 0\n1 0 0\n1 1 0\n0 1 0\n"

/* Four vertices of a square, and two triangles. */
static void check_square(const char *text)
{
    static const double corners[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
    static const uint32_t fan[6] = {0, 1, 2, 0, 2, 3};
    bvx_mesh m = read_good(text);

    TEST_ASSERT_EQUAL_UINT64_MESSAGE(4, m.vertex_count, text);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(2, m.triangle_count, text);
    for (int i = 0; i < 12; i++) TEST_ASSERT_TRUE_MESSAGE(((double *)m.positions)[i] == corners[i], text);
    TEST_ASSERT_EQUAL_UINT32_ARRAY_MESSAGE(fan, m.triangles, 6, text);
    bvx_mesh_free(ctx, &m);
}

static void test_read_off_forms(void)
{
    static const char *const same[] = {
        "OFF\n4 1 0\n" SQUARE "4 0 1 2 3\n",
        "OFF\n4 1 0\n" SQUARE "4 0 1 2 3",
        "OFF 4 1 0\n" SQUARE "4 0 1 2 3\n",
        "OFF4 1 0\n" SQUARE "4 0 1 2 3\n",
        "4 1 0\n" SQUARE "4 0 1 2 3\n",
        "+4 1 4\n" SQUARE "4 0 1 2 3\n",
        "OFF\n4 2 5\n" SQUARE "3 0 1 2\n3 0 2 3\n",
        "OFF\n4\n1\n0\n" SQUARE "4 0 1 2 3\n",
        "OFF\n4 1 -1\n" SQUARE "4 0 1 2 3\n",
        "\xef\xbb\xbfOFF\n4 1 0\n" SQUARE "4 0 1 2 3\n",
        "\n # a comment\n\nOFF # 1 2 3\n#\n4 1 0 # counts\n\n" SQUARE "#x\n\n4 0 1 2 3#y",
        "OFF\r\n4 1 0\r\n0 0 0\r\n1 0 0\r\n1 1 0\r\n0 1 0\r\n4 0 1 2 3\r\n",
        "OFF\r4 1 0\r0 0 0\r1 0 0\r1 1 0\r0 1 0\r4 0 1 2 3\r",
        "OFF\n4 1 0\n0 0 0 1 0 0\n1 1 0 0 1 0\n4 0 1 2 3\n",
        "OFF\n4 1 0 0 0 0 1 0 0 1 1 0 0 1 0 4 0 1 2 3\n",
        "OFF\n4 1 0\n0\n0\n0\n1\n0\n0\n1\n1\n0\n0\n1\n0\n4\n0\n1\n2\n3\n",
        "OFF\n4 1 0\n0 0 0 # x\n1 0 0\t\n1\f1 0\v\n0 1 0#4 4 4\n4 0 1 2 3\n",
        "OFF\n4 2 0\n" SQUARE "3 0 1 2 255 0 0\n3 0 2 3 0.5 0.5 0.5 1 # red\n",
        "OFF\n4 2 0\n" SQUARE "3 0 1 2 7\n3 0 2 3 x y z\n",
        "OFF\n4 2 0\n" SQUARE "3 0 1\n2 9 9 9\n3 0 2 3",
        "OFF\n4 1 0\n" SQUARE "4 0 1 2 3\n2 0 1\nanything\n",
        "NOFF\n4 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 -1\n4 0 1 2 3\n",
        "NOFF\n4 1 0\n0 0 0\n0 0 1\n1 0 0 0 0 1 1 1 0 0 0 1 0 1 0 nan inf 0\n4 0 1 2 3\n",
        "OFF\n4 1 0\n0.0 -0 0e5\n1. 0 0\n.1e1 10e-1 0\n0 +1 0\n4 +0 1 02 3\n",
        /* words behind vertices that are no colours */
        "OFF\n4 1 0\n0 0 0 7\n1 0 0 7\n1 1 0 7\n0 1 0 7\n4 0 1 2 3\n",
        "OFF\n4 1 0\n0 0 0 a\n1 0 0 b c d e f g h\n1 1 0\n0 1 0 7\n4 0 1 2 3\n",
    };
    for (size_t i = 0; i < sizeof same / sizeof same[0]; i++) check_square(same[i]);
}

static void check_positions(int comma)
{
    static const char text[] =
        "OFF 3 1 0\n0.1 -1.5e3 .25\n-0 1e-320 123456789.123456789\n+1. 9007199254740993 1E+2\n3 0 1 2\n";
    static const double want[9] = {0.1, -1500, 0.25, -0.0, 1e-320, 123456789.123456789, 1, 9007199254740992.0,
                                   100};

    if (comma && !set_comma_locale()) TEST_IGNORE_MESSAGE("no locale with a decimal comma");
    bvx_mesh m = read_good(text);
    setlocale(LC_ALL, "C");
    TEST_ASSERT_EQUAL_MEMORY(want, m.positions, sizeof want);
    TEST_ASSERT_NULL(m.colours);
    TEST_ASSERT_NULL(m.uvs);
    bvx_mesh_free(ctx, &m);
}

static void test_read_off_positions(void)
{
    check_positions(0);
}

static void test_read_off_in_a_comma_locale(void)
{
    check_positions(1);
}

/* The colours of a file's three vertices; NULL for none. */
static void check_colours(const char *text, const uint8_t *want)
{
    bvx_mesh m = read_good(text);
    TEST_ASSERT_EQUAL_UINT64(3, m.vertex_count);
    TEST_ASSERT_TRUE_MESSAGE((m.colours != NULL) == (want != NULL), text);
    if (want != NULL) TEST_ASSERT_EQUAL_UINT8_ARRAY_MESSAGE(want, m.colours, 12, text);
    bvx_mesh_free(ctx, &m);
}

static void test_read_off_colours(void)
{
    static const uint8_t rgb[12] = {255, 0, 0, 255, 0, 255, 0, 255, 0, 0, 128, 255};
    static const uint8_t rgba[12] = {255, 0, 0, 9, 0, 255, 0, 0, 1, 1, 1, 255};
    static const char *const with_rgb[] = {
        "COFF\n3 1 0\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 128\n3 0 1 2\n",
        "COFF\n3 1 0\n0 0 0 1.0 0 0\n1 0 0 0 1.0 0\n0 1 0 0 0 0.5\n3 0 1 2\n",
        "COFF\n3 1 0\n0 0 0 1.0 0 0 1\n1 0 0 0 1.0 0 1.0\n0 1 0 0 0 5e-1 1.0\n3 0 1 2\n",
        "COFF\n3 1 0\n0 0 0 255.0 0.0 0.0\n1 0 0 0 255.0 0\n0 1 0 0 0 128.4\n3 0 1 2\n",
        /* brought back into the range */
        "COFF\n3 1 0\n0 0 0 300 -5 0\n1 0 0 -0.1 1.0 0\n0 1 0 nan 0 128\n3 0 1 2\n",
        "CNOFF 3 1 0\n0 0 0 0 0 1 255 0 0\n1 0 0 0 0 1 0 255 0\n0 1 0 0 0 1 0 0 128\n3 0 1 2\n",
        "OFF\n3 1 0\n0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 128\n3 0 1 2\n",
        "OFF\n3 1 0\n0 0 0 255 0 0 # red\n1 0 0 0 255 0 255\n\n0 1 0 0 0 128\n3 0 1 2 5 5 5\n",
        "NOFF\n3 1 0\n0 0 0 0 0 1 255 0 0\n1 0 0 0 0 1 0 255 0\n0 1 0 0 0 1 0 0 128\n3 0 1 2\n",
        /* all space is equal */
        "COFF\n3 1 0\n0 0 0 255 0 0 255\n1 0 0 0 255 0 255 0 1 0 0 0 128 255\n3 0 1 2\n",
        "COFF\n3 1 0\n0 0\n0\n255 0 0 255\n1 0 0\n0 255 0 255 0 1 0 0 0\n128 255\n3 0 1 2\n",
    };
    static const char *const without[] = {
        "OFF\n3 1 0\n0 0 0 255 0 0\n1 0 0\n0 1 0 0 0 128\n3 0 1 2\n",
        "OFF\n3 1 0\n0 0 0 0 0 -1\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n",
        "OFF\n3 1 0\n0 0 0 0 0 256\n1 0 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2\n",
        "OFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 x\n0 1 0 0 0 1\n3 0 1 2\n",
        "OFF\n3 1 0\n0 0 0 0 0 1\n1 0 0 0 0 nan\n0 1 0 0 0 1\n3 0 1 2\n",
        "OFF\n3 1 0\n0 0 0\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n",
    };

    for (size_t i = 0; i < sizeof with_rgb / sizeof with_rgb[0]; i++) check_colours(with_rgb[i], rgb);
    check_colours("COFF\n3 1 0\n0 0 0 255 0 0 9\n1 0 0 0 255 0 0\n0 1 0 1 1 1\n3 0 1 2\n", rgba);
    for (size_t i = 0; i < sizeof without / sizeof without[0]; i++) check_colours(without[i], NULL);
}

static void test_read_off_texture_coordinates(void)
{
    static const char *const same[] = {
        "STOFF\n3 1 0\n0 0 0 0.5 0\n1 0 0 -1 2\n0 1 0 1e3 0.25\n3 0 1 2\n",
        "STOFF 3 1 0 0 0 0 0.5 0 1 0 0 -1 2 0 1 0 1e3 0.25\n3 0 1 2\n",
        "STNOFF\n3 1 0\n0 0 0 0 0 1 0.5 0\n1 0 0 0 0 1 -1 2\n0 1 0 0 0 1 1e3 0.25\n3 0 1 2\n",
        "STCOFF\n3 1 0\n0 0 0 1 2 3 0.5 0\n1 0 0 1 2 3 -1 2\n0 1 0 1 2 3 1e3 0.25\n3 0 1 2\n",
        "STCNOFF\n3 1 0\n0 0 0 0 0 1 1 2 3 255 0.5 0\n1 0 0 0 0 1 1 2 3 255 -1 2\n0 1 0 0 0 1 1 2 3 255 1e3 0.25\n3 0 1 2\n",
    };
    static const float want[6] = {0.5f, 0, -1, 2, 1000, 0.25f};
    static const uint8_t colours[12] = {1, 2, 3, 255, 1, 2, 3, 255, 1, 2, 3, 255};

    for (size_t i = 0; i < sizeof same / sizeof same[0]; i++) {
        bvx_mesh m = read_good(same[i]);
        TEST_ASSERT_EQUAL_UINT64(3, m.uv_count);
        TEST_ASSERT_NULL(m.uv_triangles);
        TEST_ASSERT_EQUAL_MEMORY(want, m.uvs, sizeof want);
        TEST_ASSERT_TRUE((m.colours != NULL) == (i >= 3));
        if (m.colours != NULL) TEST_ASSERT_EQUAL_UINT8_ARRAY(colours, m.colours, 12);
        bvx_mesh_free(ctx, &m);
    }
}

/* Polygons between triangles: cut as the polygon file cuts them, in their places. */
static void test_read_off_polygons(void)
{
    static const char text[] = "OFF\n8 4 0\n0 0 0\n4 2 0\n0 4 0\n1 2 0\n5 5 5\n6 5 5\n6 6 5\n5 6 5\n"
                               "3 0 1 2 9 9 9\n4 0 1 2 3 0.1 0.2 0.3\n3 4 5 6\n4 4 5 6 7\n";
    static const double dart[4][3] = {{0, 0, 0}, {4, 2, 0}, {0, 4, 0}, {1, 2, 0}};
    uint32_t want[18] = {0, 1, 2, 0, 0, 0, 0, 0, 0, 4, 5, 6, 4, 5, 6, 4, 6, 7};

    cut_polygon(dart, 4, want + 3);
    TEST_ASSERT_TRUE(want[3] == 3 || want[4] == 3 || want[5] == 3); /* both triangles meet the inner corner */
    bvx_mesh m = read_good(text);
    TEST_ASSERT_EQUAL_UINT64(6, m.triangle_count);
    TEST_ASSERT_EQUAL_UINT32_ARRAY(want, m.triangles, 18);
    bvx_mesh_free(ctx, &m);
    check_every_limit(text, strlen(text), OFF);
    check_same_with_threads(text, strlen(text), OFF);
}

static void test_read_off_large_polygon(void)
{
    enum { CORNERS = 6000 };
    char *const text = malloc(CORNERS * 40), *t = text;
    double(*const corner)[3] = malloc(CORNERS * sizeof *corner);
    uint32_t *const want = malloc(CORNERS * 12);
    t += sprintf(t, "OFF\n%d 1 0\n", CORNERS);
    for (int i = 0; i < CORNERS; i++) { /* a comb */
        corner[i][0] = i;
        corner[i][1] = i == 0 || i == CORNERS - 1 ? -1 : i % 2 * (i % 7 + 1);
        corner[i][2] = 2 * corner[i][0];
        t += sprintf(t, "%g %g %g\n", corner[i][0], corner[i][1], corner[i][2]);
    }
    t += sprintf(t, "%d", CORNERS);
    for (int i = 0; i < CORNERS; i++) t += sprintf(t, i % 10 == 9 ? "\n%d" : " %d", i);
    cut_polygon((const double(*)[3])corner, CORNERS, want);
    bvx_mesh m;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(text, (size_t)(t - text), OFF, &m),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(CORNERS - 2, m.triangle_count);
    TEST_ASSERT_EQUAL_UINT32_ARRAY(want, m.triangles, 3 * (CORNERS - 2));
    bvx_mesh_free(ctx, &m);
    check_every_limit(text, (size_t)(t - text), OFF);
    free(text);
    free(corner);
    free(want);
}

/* What is written is read back to the same bytes, with and without colours. */
static void test_read_off_reads_what_is_written(void)
{
    uint64_t state = 5;

    for (int round = 0; round < 40; round++) {
        uint32_t const n = 3 + (uint32_t)(next_random(&state) % 50);
        uint32_t const triangles = 1 + (uint32_t)(next_random(&state) % 90);
        double positions[53 * 3];
        uint32_t numbers[90 * 3];
        uint8_t colours[53 * 4];
        bvx_mesh m = {0}, back;
        bvx_buffer file = {0};
        for (uint32_t i = 0; i < n * 3; i++)
            positions[i] = ((double)(next_random(&state) >> 11) - 4503599627370496.0) /
                           (double)(1 + next_random(&state) % 1000);
        for (uint32_t i = 0; i < triangles * 3; i++) numbers[i] = (uint32_t)(next_random(&state) % n);
        for (uint32_t i = 0; i < n * 4; i++)
            colours[i] = (uint8_t)(next_random(&state) & (round % 4 == 1 ? 1 : 255));
        m.positions = positions;
        m.triangles = numbers;
        m.colours = round % 2 == 0 ? NULL : colours;
        m.vertex_count = m.vertex_capacity = n;
        m.triangle_count = m.triangle_capacity = triangles;
        m.position_type = BVX_F64;
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_mesh(ctx, &m, 1, NULL, OFF, &file),
                                        bvx_last_message(ctx));
        char *const text = malloc((size_t)file.size);
        size_t const size = (size_t)file.size;
        memcpy(text, file.bytes, size);
        bvx_buffer_free(ctx, &file);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(text, size, OFF, &back), bvx_last_message(ctx));
        free(text);
        TEST_ASSERT_EQUAL_UINT64(n, back.vertex_count);
        TEST_ASSERT_EQUAL_UINT64(triangles, back.triangle_count);
        TEST_ASSERT_EQUAL_MEMORY(positions, back.positions, n * 24);
        TEST_ASSERT_EQUAL_MEMORY(numbers, back.triangles, triangles * 12);
        TEST_ASSERT_TRUE((back.colours != NULL) == (m.colours != NULL));
        if (m.colours != NULL) TEST_ASSERT_EQUAL_MEMORY(colours, back.colours, n * 4);
        bvx_mesh_free(ctx, &back);
    }
}

/* ---- bad files ---- */

static void test_read_off_refuses(void)
{
    static const struct {
        const char *text;
        bvx_status status;
        const char *words;
    } bad[] = {
        {"", BVX_ERR_EMPTY, "OFF: the file has no bytes"},
        {"\n\n# OFF\n", BVX_ERR_FORMAT, "the file ends where OFF or the number of vertices"},
        {"solid x\n", BVX_ERR_FORMAT, "OFF: line 1: expected OFF or the number of vertices, found 'solid'"},
        {"\nOFFx 1 2 3\n", BVX_ERR_FORMAT, "line 2: expected OFF or the number of vertices, found 'OFFx'"},
        {"OF 3 1 0\n", BVX_ERR_FORMAT, "found 'OF'"},
        {"NCOFF\n3 1 0\n", BVX_ERR_FORMAT, "found 'NCOFF'"},
        {"4OFF\n3 1 0\n", BVX_ERR_UNSUPPORTED, "line 1: vertices of four or any dimensions"},
        {"#\nSTCN4nOFF\n5 3 1 0\n", BVX_ERR_UNSUPPORTED, "line 2: vertices of four or any dimensions"},
        {"nOFF\n3\n3 1 0\n", BVX_ERR_UNSUPPORTED, "dimensions"},
        {"OFF BINARY\n\1\2\3", BVX_ERR_UNSUPPORTED, "line 1: the binary form"},
        {"COFF  BINARY\n", BVX_ERR_UNSUPPORTED, "the binary form"},
        {"OFF", BVX_ERR_FORMAT, "the file ends where the number of vertices"},
        {"OFF\nBINARY\n", BVX_ERR_FORMAT, "line 2: expected the number of vertices, found 'BINARY'"},
        {"OFF\n4 x 0\n", BVX_ERR_FORMAT, "line 2: expected the number of faces, found 'x'"},
        {"OFF\n4 1\n", BVX_ERR_FORMAT, "the number of edges"},
        {"OFF\n4.5 1 0\n", BVX_ERR_FORMAT, "found '4.5'"},
        {"OFF\n0 0 0\n", BVX_ERR_EMPTY, "line 2: 0 vertices and 0 faces are not a mesh"},
        {"OFF\n4 0 0\n" SQUARE, BVX_ERR_EMPTY, "not a mesh"},
        {"OFF\n-1 1 0\n" SQUARE, BVX_ERR_FORMAT, "line 2: -1 vertices and 1 faces are not counts"},
        {"OFF\n4 2147483648 0\n" SQUARE "3 0 1 2\n", BVX_ERR_FORMAT,
         "4 vertices and 2147483648 faces do not fit the 33 bytes that follow"},
        {"OFF\n4 1 0\n0 0\n", BVX_ERR_FORMAT, "do not fit"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 x\n3 0 1 2\n", BVX_ERR_FORMAT,
         "line 5: expected a coordinate, found 'x'"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0,5\n3 0 1 2\n", BVX_ERR_FORMAT, "found '0,5'"},
        {"OFF\n3 1 0\n0 0 0\n1 nan 0\n0 1 0\n3 0 1 2\n", BVX_ERR_RANGE,
         "line 4: vertex 1 has a coordinate that is not finite"},
        {"OFF\n3 1 0\n0 0 0\n1 0 1e309\n0 1 0\n3 0 1 2\n", BVX_ERR_RANGE, "line 4: vertex 1"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 3\n", BVX_ERR_RANGE,
         "line 6: face 0 names vertex 3, but there are 3"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 -1 2\n", BVX_ERR_RANGE, "names vertex -1"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 4294967296\n", BVX_ERR_RANGE, "names vertex 4294967296"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n2 0 1 2\n", BVX_ERR_FORMAT,
         "line 6: face 0 has 2 corners; it needs three"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1 2\n", BVX_ERR_FORMAT, "has 0 corners"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n-3 1 2 0", BVX_ERR_FORMAT, "has -3 corners"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4294967295 0 1 2\n", BVX_ERR_FORMAT,
         "line 6: face 0 has 4294967295 corners, more than the file holds"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n4 0 1 2 \n", BVX_ERR_FORMAT,
         "line 7: the file ends where a vertex index"},
        {"OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2.5\n", BVX_ERR_FORMAT,
         "line 6: expected a vertex index, found '2.5'"},
        {"OFF\n3 2 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2 3 0 1 2\n", BVX_ERR_FORMAT,
         "line 7: the file ends where a face's number of corners"},
        {"COFF\n3 1 0\n0 0 0 1 2 3\n1 0 0 1 2\n0 1 0 1 2 3\n3 0 1 2\n", BVX_ERR_FORMAT,
         "line 4: vertex 1 has 2 numbers after it; its colour needs three"},
        {"COFF\n3 1 0\n0 0 0 1 2 3\n1 0 0 1 2 x\n0 1 0 1 2 3\n3 0 1 2\n", BVX_ERR_FORMAT, "line 4: vertex 1"},
        {"STOFF\n3 1 0\n0 0 0 1 2\n1 0 0 1\n0 1 0 1 2\n3 0 1 2\n", BVX_ERR_FORMAT,
         "line 4: vertex 1 has 1 numbers after it; its texture coordinates are two"},
        {"STOFF\n3 1 0\n0 0 0 1 2\n1 0 0 1 inf\n0 1 0 1 2\n3 0 1 2\n", BVX_ERR_RANGE,
         "line 4: vertex 1 has a texture coordinate that is not finite"},
        {"COFF\n3 1 0\n0 0 0\n1 2 3 x\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n", BVX_ERR_FORMAT,
         "line 4: expected a colour or texture coordinate, found 'x'"},
        {"NOFF\n3 1 0\n0 0 0 0 0 x\n1 0 0 1 2 3\n0 1 0 1 2 3\n3 0 1 2\n", BVX_ERR_FORMAT,
         "line 3: expected a normal, found 'x'"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        check_refused_text(bad[i].text, OFF, bad[i].status, bad[i].words);
}

static const char *const samples[] = {
    "# x\r\nOFF # y\n4 3 6\n0 0 0\n1e0 -0.5 +1\n1 1 0\n0 1 0\n3 0 1 2 255 0 0\n4 0 1 2 3\n3 1 2 3\n",
    "STCNOFF\n3 1 0\n0 0 0 0 0 1 1 2 3 255 0.5 0\n1 0 0 0 0 1 1 2 3 255 -1 2\n0 1 0 0 0 1 1 2 3 255 1e3 0.25\n3 0 1 2\n",
    "3 1 0\n0 0 0 0.5 0.5 0.5\n1 0 0 1 0 0\n0 1 0 1.0 0 0 1.0\n3 0 1 2\n",
    "COFF 3 2 0 0 0 0 1 2 3 4 1 0 0 1 2 3 4 0 1 0 1 2 3 4 3 0 1 2\n3 2 1 0\n",
};

static bvx_status read_sample(void *user, bvx_context *own_ctx)
{
    const char *const text = user;
    bvx_mesh m = {0};
    bvx_status const status = bvx_read_mesh(own_ctx, text, strlen(text), OFF, NULL, &m);
    bvx_mesh_free(own_ctx, &m);
    return status;
}

static void test_read_off_every_allocation_may_fail(void)
{
    for (size_t i = 0; i < 4; i++) {
        uint64_t allocations = 0;
        char text[400];
        strcpy(text, samples[i]);
        TEST_ASSERT_NULL(fault_every_allocation(read_sample, text, NULL, &allocations));
        TEST_ASSERT_TRUE(allocations >= 2);
    }
}

static void test_read_off_every_prefix(void)
{
    static const uint64_t triangles[] = {4, 1, 1, 2};
    for (size_t i = 0; i < 4; i++)
        TEST_ASSERT_TRUE(check_every_prefix(samples[i], strlen(samples[i]), OFF, triangles[i]) >= 2);
}

/* Every word of a file replaced by numbers that are too small or too large:
 * an error or a valid mesh, and little memory. */
static void test_read_off_every_number(void)
{
    static const char *const numbers[] = {
        "0", "1", "-1", "2147483648", "4294967295", "18446744073709551617", "1e999", "", "#"};
    int good = 0, bad = 0;

    for (size_t k = 0; k < 4; k++)
        for (const char *p = samples[k]; *p != 0;) {
            const char *const stop = p + strcspn(p, " \r\n");
            for (size_t i = 0; i < sizeof numbers / sizeof numbers[0] && stop > p; i++) {
                char text[400];
                bvx_mesh m;
                sprintf(text, "%.*s%s%s", (int)(p - samples[k]), samples[k], numbers[i], stop);
                if (read_file(text, strlen(text), OFF, &m) == BVX_OK) {
                    bvx_mesh_free(ctx, &m);
                    good++;
                } else bad++;
            }
            p = stop + strspn(stop, " \r\n");
        }
    TEST_ASSERT_TRUE(good > 200 && bad > 200);
}

/* Bytes changed at random. */
static void test_read_off_damaged(void)
{
    static const char marks[] = "0123456789.-+eE #\n\r\tOFNCST4n";
    uint64_t state = 9;
    int good = 0;

    for (int round = 0; round < 40000; round++) {
        char text[400];
        bvx_mesh m;
        strcpy(text, samples[round % 4]);
        for (uint64_t changes = 1 + next_random(&state) % 4; changes > 0; changes--)
            text[next_random(&state) % strlen(text)] = marks[next_random(&state) % (sizeof marks - 1)];
        if (read_file(text, strlen(text), OFF, &m) != BVX_OK) continue;
        bvx_mesh_free(ctx, &m);
        good++;
    }
    TEST_ASSERT_TRUE(good > 4000);
}

static void test_read_off_cancels(void)
{
    size_t const n = 3 << 20;
    char *const text = malloc(n + 200);

    for (int polygons = 0; polygons < 2; polygons++) {
        strcpy(text, "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n");
        size_t const head = strlen(text);
        memset(text + head, '\n', n);
        strcpy(text + head + n, polygons ? "4 0 1 2 3\n" : "3 0 1 2\n");
        TEST_ASSERT_TRUE(check_every_cancel(text, strlen(text), OFF) >= (polygons ? 3 : 1));
    }
    strcpy(text, "OFF\n5 2 0\n0 0 0 1 1 1\n"); /* the lines are counted */
    size_t const head = strlen(text);
    memset(text + head, '\n', n);
    strcpy(text + head + n, SQUARE "3 0 1 2\n3 0 1 2");
    TEST_ASSERT_TRUE(check_every_cancel(text, strlen(text), OFF) >= 2);
    free(text);
}

static void test_read_off_cube_of_the_format(void)
{
    static const char text[] =
        "OFF\n8 6 12\n1 1 1\n1 1 -1\n1 -1 1\n1 -1 -1\n-1 1 1\n-1 1 -1\n-1 -1 1\n-1 -1 -1\n"
        "4 0 2 3 1 255 0 0\n4 4 5 7 6 0 255 0\n4 0 1 5 4\n4 2 6 7 3\n4 0 4 6 2\n4 1 3 7 5\n";
    bvx_certificate c;
    bvx_mesh_view view;
    bvx_mesh m = read_good(text);

    bvx_mesh_view_of(&m, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
    TEST_ASSERT_TRUE(c.closed && c.oriented && c.triangles == 12 && c.volume == 8.0);
    bvx_mesh_free(ctx, &m);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_read_off_forms);
    RUN_TEST(test_read_off_positions);
    RUN_TEST(test_read_off_in_a_comma_locale);
    RUN_TEST(test_read_off_colours);
    RUN_TEST(test_read_off_texture_coordinates);
    RUN_TEST(test_read_off_polygons);
    RUN_TEST(test_read_off_large_polygon);
    RUN_TEST(test_read_off_reads_what_is_written);
    RUN_TEST(test_read_off_refuses);
    RUN_TEST(test_read_off_every_allocation_may_fail);
    RUN_TEST(test_read_off_every_prefix);
    RUN_TEST(test_read_off_every_number);
    RUN_TEST(test_read_off_damaged);
    RUN_TEST(test_read_off_cancels);
    RUN_TEST(test_read_off_cube_of_the_format);
    return UNITY_END();
}
