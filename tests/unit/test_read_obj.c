/* test_read_obj.c - OBJ files right and wrong. */
#include "read_support.h"

enum { OBJ = BVX_FORMAT_OBJ };

/* The file's triangles are these, counted from 0 and ended by -1. */
static void check_triangles(const char *text, size_t size, uint64_t vertices, const int *want)
{
    bvx_mesh m;
    uint64_t n = 0;

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(text, size, OBJ, &m), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32(BVX_F64, m.position_type);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(vertices, m.vertex_count, text);
    for (; want[n] >= 0; n++)
        if (n < 3 * m.triangle_count)
            TEST_ASSERT_EQUAL_UINT32_MESSAGE((uint32_t)want[n], m.triangles[n], text);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(n, 3 * m.triangle_count, text);
    bvx_mesh_free(ctx, &m);
}

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
static const int square_fan[] = {0, 1, 2, 0, 2, 3, -1};

static void test_read_obj_faces(void)
{
    static const char *const same[] = {
        SQUARE "f 1 2 3 4\n",
        SQUARE "f 1 2 3 4",
        SQUARE "f 1 2 3\nf 1 3 4",
        SQUARE "f -4 -3 -2 -1\n",
        SQUARE "f 1/1 2/2 3/3 4/4\n",
        SQUARE "f 1//9 2//9 3//9 4//9\n",
        SQUARE "f 1/7/9 2/-7/-9 3/7/9 4/7/9\n",
        SQUARE "f 1/ 2// 3/1/ 4\n",
        SQUARE "f +1 +2 +3 +4\n",
        SQUARE "f\t1 \t2\v3\f4 \t\n",
        SQUARE "  f 1 2 3 4 # comment\n",
        SQUARE "f 1 2 \\\n3 4\n",
        SQUARE "f 1 2 \\\r\n3 4\r\n",
        SQUARE "f \\\n\\\n1 2 3 \\\n 4\\\n\n",
        SQUARE "f\\\n1 2 3 4",
        SQUARE "f 1 2 3 4\\",
        SQUARE "f 0001 2 3 4\n",
        "f 1 2 3 4\n" SQUARE,
        "v 0 0 0\nv 1 0 0\nf -2 -1 3 4\nv 1 1 0\nv 0 1 0\n",
        "\xef\xbb\xbf" SQUARE "f 1 2 3 4\n",
        "#f 1 2 3\n" SQUARE "g a\no b\ns off\nusemtl f\nvt 0 0\nvn 0 0 1\nvp 1 1\nf 1 2 3 4\n",
        SQUARE
        "mtllib /dev/random\ncall /dev/random\ncsh touch never\nunknown f 1 2 3\nl 1 2 3\np 1\nf 1 2 3 4\n",
        SQUARE "# a path ends in \\\nf 1 2 3 4\n",
        SQUARE "mtllib C:\\a\\\nf 1 2 3 4\n",
        SQUARE "fo 1 2 3\nF 1 2 3\nf 1 2 3 4\n",
        "\r\n\n\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\n\r\nf 1 2 3 4\r\n\r\n",
        "v 0 0 0\rv 1 0 0\rv 1 1 0\rv 0 1 0\r# no newline at all\rf 1 2 \\\r3 4\r",
        "v 0 0 \\\n0\nv \\\n1 0 0\nv 1 1 0\nv 0 1 0 \\\n 0.5 0.5 0.5\nf 1 2 3 4\n",
        "v 0 0 0 1.0\nv 1 0 0 0.1 0.2 0.3\nv 1 1 0 red\nv 0 1 0#x\nf 1 2 3 4\n",
    };

    for (size_t i = 0; i + 1 < sizeof same / sizeof same[0]; i++)
        check_triangles(same[i], strlen(same[i]), 4, square_fan);
    check_refused_text(same[sizeof same / sizeof same[0] - 1], OBJ, BVX_ERR_FORMAT,
                       "line 4: expected a coordinate, found '0#x'");
    static const char with_zero[] = SQUARE "#\0 \0\nx\0\nf 1 2 3 4\n";
    check_triangles(with_zero, sizeof with_zero - 1, 4, square_fan);
    static const int twice[] = {0, 1, 2, 0, 1, 2, 0, 0, 0, -1}; /* duplicate and degenerate ones are legal */
    static const char odd[] = SQUARE "f 1 2 3\nf 1 2 3\nf 1 1 1\n";
    check_triangles(odd, strlen(odd), 4, twice);
}

static void test_read_obj_positions(void)
{
    static const char text[] =
        "v 0.1 -1.5e3 .25\nv -0 1e-320 123456789.123456789\nv +1. 9007199254740993 1E+2\nf 1 2 3\n";
    static const double want[9] = {0.1, -1500, 0.25, -0.0, 1e-320, 123456789.123456789, 1, 9007199254740992.0,
                                   100};
    bvx_mesh m;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_file(text, strlen(text), OBJ, &m));
    TEST_ASSERT_EQUAL_MEMORY(want, m.positions, sizeof want);
    bvx_mesh_free(ctx, &m);
}

static void test_read_obj_large_polygon(void)
{
    enum { CORNERS = 5000 };
    char *const text = malloc(CORNERS * 40), *t = text;
    /* convex: a fan */
    for (int i = 0; i < CORNERS; i++) t += sprintf(t, "v %d 0 %d\n", i, i * (i - CORNERS));
    *t++ = 'f';
    for (int i = 0; i < CORNERS; i++)
        t += sprintf(t, i % 2 == 0 ? " %d//1" : " %d\\\n", i % 3 == 0 ? i + 1 : i - CORNERS);
    bvx_mesh m;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_file(text, (size_t)(t - text), OBJ, &m));
    TEST_ASSERT_EQUAL_UINT64(CORNERS - 2, m.triangle_count);
    for (uint32_t i = 0; i < CORNERS - 2; i++) {
        uint32_t const want[3] = {0, i + 1, i + 2};
        TEST_ASSERT_EQUAL_UINT32_ARRAY(want, m.triangles + 3 * i, 3);
    }
    bvx_mesh_free(ctx, &m);
    check_every_limit(text, (size_t)(t - text), OBJ);
    free(text);
}

/* Random files of vertices and faces in every form, against what the
 * generator meant. Returns the file's size. */
static size_t put_random(uint64_t *state, int total, int least_numbers, char *text, int *want)
{
    static const char *const gaps[] = {" ", "  ", "\t", " \\\n ", " \\\r\n"};
    static const char *const ends[] = {"\n", "\r\n", " \n", " # f 1 2 3\n"};
    static const char *const noise[] = {
        "", "", "# v 1 2 3\n", "vn 0 0 1\n", "vt 1 1\n", "g f 1 2 3\n", "\n", "s 1\r\n"};
    char *t = text;
    int vertices = 0, n = 0;

    while (vertices < total || n < least_numbers) {
        t += sprintf(t, "%s", noise[next_random(state) % 8]);
        if (vertices < total && next_random(state) % 2 == 0) {
            vertices++;
            t += sprintf(t, "v%s%d%s%d.5%s-%de-1%s", gaps[next_random(state) % 5], vertices,
                         gaps[next_random(state) % 5], vertices * vertices % 101,
                         gaps[next_random(state) % 5], vertices * 7 % 31, ends[next_random(state) % 4]);
            continue;
        }
        int const corners = 3 + (int)(next_random(state) % 4);
        double xyz[6][3];
        uint32_t cut[12];
        int corner[6];
        t += sprintf(t, "f");
        for (int k = 0; k < corners; k++) {
            int const vertex = corner[k] = (int)(next_random(state) % (uint64_t)total);
            uint64_t const form = next_random(state) % 4;
            t += sprintf(t, "%s%d", gaps[next_random(state) % 5],
                         next_random(state) % 2 == 0 && vertex < vertices ? vertex - vertices : vertex + 1);
            t += sprintf(t, "%s", form == 0 ? "" : form == 1 ? "/1" : form == 2 ? "//-3" : "/1/1");
            xyz[k][0] = vertex + 1;
            xyz[k][1] = (vertex + 1) * (vertex + 1) % 101 + 0.5;
            xyz[k][2] = -((vertex + 1) * 7 % 31) / 10.0;
        }
        t += sprintf(t, "%s", ends[next_random(state) % 4]);
        cut_polygon((const double(*)[3])xyz, (uint64_t)corners, cut);
        for (int i = 0; i < 3 * (corners - 2); i++) want[n++] = corner[cut[i]];
    }
    want[n] = -1;
    return (size_t)(t - text);
}

static void test_read_obj_random(void)
{
    char *const text = malloc(60000);
    int *const want = malloc(20000 * sizeof *want);
    uint64_t state = 3;

    for (int round = 0; round < 60; round++) {
        int const total = 3 + (int)(next_random(&state) % 100);
        check_triangles(text, put_random(&state, total, 30, text, want), (uint64_t)total, want);
    }
    free(text);
    free(want);
}

/* of half a megabyte: statements at their ends, errors in several of them */
static void test_read_obj_in_pieces(void)
{
    enum { TOTAL = 30000 }; /* squares of vertex indices fit 31 bits */
    char *const text = malloc(6 << 20);
    int *const want = malloc(1000000 * sizeof *want);
    uint64_t state = 5;
    for (int round = 0; round < (quick ? 1 : 3); round++) {
        size_t const size = put_random(&state, TOTAL, 300000 + round * 1000, text, want);
        TEST_ASSERT_TRUE(size > 3 << 19 && size < 6 << 20);
        check_triangles(text, size, TOTAL, want);
        check_same_with_threads(text, size, OBJ);
        for (size_t i = 1; i < 5; i++) { /* damage: a word in every fifth of the file */
            char *const at = strstr(text + size / 5 * i, "\nf ");
            if (at != NULL) at[3] = 'x';
        }
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, read_file(text, size, OBJ, &(bvx_mesh){0}));
        check_same_with_threads(text, size, OBJ);
    }
    memset(text, '\\', 3 << 20); /* continued lines all the way: one statement, one piece */
    for (size_t i = 1; i < 3 << 20; i += 2) text[i] = '\n';
    memcpy(text, "v 0 0 0 \\\n", 10);
    memcpy(text + (3 << 20) - 30, "\nv 1 0 0\nv 0 1 0\nf 1 2 3\n     ", 30);
    check_triangles(text, 3 << 20, 3, (const int[]){0, 1, 2, -1});
    check_same_with_threads(text, 3 << 20, OBJ);
    free(text);
    free(want);
}

/* ---- colours and texture coordinates ---- */

static void check_colours(const char *text, const char *want) /* "" for none, else 6 digits a vertex */
{
    bvx_mesh m;

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(text, strlen(text), OBJ, &m), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT_MESSAGE(*want != 0, m.colours != NULL, text);
    for (size_t v = 0; v < m.vertex_count && m.colours != NULL; v++) {
        char got[8];
        sprintf(got, "%02x%02x%02x", m.colours[4 * v], m.colours[4 * v + 1], m.colours[4 * v + 2]);
        TEST_ASSERT_EQUAL_STRING_LEN_MESSAGE(want + 6 * v, got, 6, text);
        TEST_ASSERT_EQUAL_UINT8(255, m.colours[4 * v + 3]);
    }
    bvx_mesh_free(ctx, &m);
}

static void test_read_obj_colours(void)
{
    check_colours("v 0 0 0 1 0 0.5\nv 1 0 0 0 0.2 1.0\nv 0 1 0 .001 0.002 0.998\nf 1 2 3\n", "ff0080"
                                                                                             "0033ff"
                                                                                             "0001fe");
    check_colours("v 0 0 0 255 0 128\nv 1 0 0 1 0.4 0.5\nv 0 1 0 300 -5 254.5\nf 1 2 3\n", "ff0080"
                                                                                           "010001"
                                                                                           "ff00ff");
    /* weights */
    check_colours("v 0 0 0 9 1 0 0.5\nv 1 0 0 0 1 0\nv 0 1 0 2 0 0 1\nf 1 2 3\n", "ff0080"
                                                                                  "00ff00"
                                                                                  "0000ff");
    check_colours("v 0 0 0 1 \\\n 0 0\nv 1 0 0 0 1 0 # 7\nv 0 1 0 0 0 1\t\r\nf 1 2 3\n", "ff0000"
                                                                                         "00ff00"
                                                                                         "0000ff");
    check_colours("f 1 2 3\nv 0 0 0 -1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1", "000000"
                                                                           "00ff00"
                                                                           "0000ff");
    static const char *const none[] = {"0.5",     "0.5 0.5",     "",       "1 2 3 4 5", "a b c", "1 2 c",
                                       "1 2 3 c", "0.5 0.5#1 0", "1 2 # 3"};
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++)
        for (int at = 0; at < 3; at++) {
            char text[200];
            sprintf(text, "v 0 0 0 %s\nv 1 0 0 %s\nv 0 1 0 %s\nf 1 2 3\n", at == 0 ? none[i] : "1 1 1",
                    at == 1 ? none[i] : "1 1 1", at == 2 ? none[i] : "1 1 1");
            check_colours(text, "");
        }
    check_refused_text("v 0 0 0 1 1 1\nv 1 0 0 1 nan 1\nv 0 1 0 1 1 1\nf 1 2 3\n", OBJ, BVX_ERR_RANGE,
                       "line 2: vertex 2 has a colour that is not finite");
}

/* The texture coordinate at corner k of triangle t is (x, y) of its vertex when same is 1, else (x + 10,
 * y). */
static void check_uvs(const char *text, uint64_t triangles, int has_numbers, int same)
{
    bvx_mesh m;

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(text, strlen(text), OBJ, &m), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(triangles, m.triangle_count);
    TEST_ASSERT_NOT_NULL_MESSAGE(m.uvs, text);
    TEST_ASSERT_EQUAL_INT_MESSAGE(has_numbers, m.uv_triangles != NULL, text);
    for (uint64_t t = 0; t < m.triangle_count; t++)
        for (int k = 0; k < 3; k++) {
            uint32_t const i = (has_numbers ? m.uv_triangles : m.triangles)[3 * t + (uint64_t)k];
            double p[3];
            corner_of(&m, t, k, p);
            TEST_ASSERT_TRUE_MESSAGE(
                (double)m.uvs[2 * i] == p[0] + (same ? 0 : 10) && (double)m.uvs[2 * i + 1] == p[1], text);
        }
    bvx_mesh_free(ctx, &m);
}

static void test_read_obj_texture_coordinates(void)
{
#define UV "vt 0 0\nvt 1 0 7\nvt 1 1\nvt 0 1 0.5 text\n"
    check_uvs(SQUARE UV "f 1/1 2/2 3/3 4/4\n", 2, 0, 1); /* the numbers of the vertices: none of their own */
    check_uvs(SQUARE UV "f 1/1 2/-3/7 3/3/ -1/-1/-9\n", 2, 0, 1);
    check_uvs("f 1/1 2/2 3/3 4/4\n" UV SQUARE "f -1/-1 -2/-2 -3/-3\n", 3, 0, 1);
    check_uvs(SQUARE UV "vt 9 9\nf 1/1 2/2 3/3 4/4\n", 2, 1, 1); /* counts differ */
    check_uvs(SQUARE "v 9 9 9\n" UV "f 1/1 2/2 3/3 4/4\n", 2, 1, 1);
    check_uvs(SQUARE "vt 0 1\nvt 1 1 \\\n 4\nvt 1 \\\n\nvt 0\n"
                     "f 1/4 2/3 3/2 4/1\n",
              2, 1, 1);
    check_uvs(SQUARE "vt 10 1\nvt 11 1\nvt 11 0\nf 4/1 3/2 -3/-1\nf 1/4 2/-1 3/2\nvt 10 0\n", 2, 1, 0);
    static const char *const bad[] = {"", "vt x 0\n", "vt 1 inf\n", "vt 1e39 0\n"};
    static const char *const none[] = {"f 1 2/2 3/3 4/4\n",    "f 1/1 2/2 3/3 4\n",
                                       "f 1/1 2/2 3/3 4//4\n", "f 1/1 2/2 3/3\nf 1 3 4\n",
                                       "f 1/ 2/2 3/3 4/4\n",   "f 1//1 2/2 3/3 4/4\n"};
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) /* not all corners have one */
        for (size_t k = 0; k < sizeof bad / sizeof bad[0]; k++) {
            char text[300];
            bvx_mesh m;
            sprintf(text, "%s%s", SQUARE UV, none[i]);
            /* the first corner has none: what vt says is not looked at */
            if (i % 4 == 0) strcat(text, bad[k]);
            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(text, strlen(text), OBJ, &m),
                                            bvx_last_message(ctx));
            TEST_ASSERT_NULL(m.uvs);
            bvx_mesh_free(ctx, &m);
        }
    check_refused_text(SQUARE UV "f 1/1 2/2 3/5\n", OBJ, BVX_ERR_RANGE,
                       "line 9: the face names texture coordinate 5; there are 4");
    check_refused_text(SQUARE UV "f 1/1 2/2 3/0\n", OBJ, BVX_ERR_RANGE, "names texture coordinate 0");
    check_refused_text(SQUARE UV "f 1/1 2/2 3/-5\n", OBJ, BVX_ERR_RANGE, "names texture coordinate -5");
    check_refused_text(SQUARE UV "f 1/1 2/2 3/4294967297\n", OBJ, BVX_ERR_RANGE, "line 9");
    check_refused_text(SQUARE UV "f 1/1 2/2 3/3\nvt x\n", OBJ, BVX_ERR_FORMAT,
                       "line 10: expected a texture coordinate, found 'x'");
    check_refused_text(SQUARE UV "f 1/1 2/2 3/3\nvt \n", OBJ, BVX_ERR_FORMAT, "line 10: the line ends");
    check_refused_text(SQUARE UV "f 1/1 2/2 3/3\nvt 0 nan\n", OBJ, BVX_ERR_RANGE,
                       "line 10: texture coordinate 5 is not");
}

/* A concave polygon: triangles of its own sense and area in all, texture coordinates go with their
 * corners. */
static void test_read_obj_tells_of_materials(void)
{
    static const char *const none[] = {"", "mtllib a.mtl\n", "# usemtl a\n", "g usemtl\n"};
    bvx_read_report report;
    bvx_read_options const options = {.struct_size = sizeof options, .report = &report};
    bvx_mesh m = {0};
    char text[256];

    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        int const n = snprintf(text, sizeof text, "%s" SQUARE "f 1 2 3 4\n", none[i]);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_mesh(ctx, text, (uint64_t)n, OBJ, &options, &m));
        TEST_ASSERT_EQUAL_UINT32(0, report.lost);
    }
    int const n = snprintf(text, sizeof text, SQUARE "f 1 2 3\n \tusemtl red\nf 1 3 4\n");
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_mesh(ctx, text, (uint64_t)n, OBJ, &options, &m));
    TEST_ASSERT_EQUAL_UINT32(BVX_LOST_MATERIALS, report.lost);
    bvx_mesh_free(ctx, &m);
}

static void test_read_obj_concave_polygon(void)
{
    /* a U of area 10 */
    static const int xy[8][2] = {{0, 0}, {4, 0}, {4, 4}, {3, 4}, {3, 1}, {1, 1}, {1, 4}, {0, 4}};

    for (int turn = 0; turn < 8; turn++)
        for (int before = 0; before < 2; before++) { /* the face before or behind its vertices */
            char text[800], *t = text;
            bvx_mesh m;
            double area = 0;
            for (int part = 0; part < 2; part++) {
                if (part == before) {
                    t += sprintf(t, "f");
                    for (int k = 0; k < 8; k++)
                        t += sprintf(t, " %d/%d", (k + turn) % 8 + 1, 8 - (k + turn) % 8);
                    t += sprintf(t, "\n");
                    continue;
                }
                for (int k = 0; k < 8; k++)
                    t += sprintf(t, "v %d %d 5\nvt %d %d\n", xy[k][0], xy[k][1], xy[7 - k][0], xy[7 - k][1]);
            }
            check_uvs(text, 6, 1, 1);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, read_file(text, strlen(text), OBJ, &m));
            for (uint64_t i = 0; i < 6; i++) {
                double p[3][3];
                for (int k = 0; k < 3; k++) corner_of(&m, i, k, p[k]);
                double const twice = (p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) -
                                     (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]);
                TEST_ASSERT_TRUE(twice >= 0);
                area += twice / 2;
            }
            TEST_ASSERT_TRUE(area == 10);
            bvx_mesh_free(ctx, &m);
        }
}

/* ---- refusals ---- */

static void test_read_obj_refuses(void)
{
    static const struct {
        const char *text;
        bvx_status status;
        const char *words;
    } bad[] = {
        {"", BVX_ERR_EMPTY, "OBJ: the file has no bytes"},
        {"\n", BVX_ERR_EMPTY, "no face"},
        {SQUARE, BVX_ERR_EMPTY, "no face"},
        {"not an OBJ file", BVX_ERR_EMPTY, "no face"},
        {SQUARE "f\n", BVX_ERR_EMPTY, "no face"}, /* 'f' without a space behind it is another word */
        {SQUARE "f \n", BVX_ERR_FORMAT, "line 5: a face of 0 corners"},
        {SQUARE "f 1 2\n", BVX_ERR_FORMAT, "line 5: a face of 2 corners"},
        {SQUARE "f 1 2 # 3\n", BVX_ERR_FORMAT, "a face of 2 corners"},
        {SQUARE "f 1 2 3 5\n", BVX_ERR_RANGE, "line 5: the face names vertex 5; there are 4"},
        {SQUARE "f 1 2 0\n", BVX_ERR_RANGE, "names vertex 0"},
        {SQUARE "f 1 2 -5\n", BVX_ERR_RANGE, "names vertex -5"},
        {"v 0 0 0\nf -2 1 1\nv 0 0 0\n", BVX_ERR_RANGE,
         "line 2: the face names vertex -2; there are 2, 1 of them before it"},
        {SQUARE "f 1 2 99999999999999999999999999\n", BVX_ERR_RANGE, "line 5"},
        {SQUARE "f 1 2 -99999999999999999999999999\n", BVX_ERR_RANGE, "line 5"},
        {SQUARE "f 1 2 4294967297\n", BVX_ERR_RANGE, "names vertex 4294967297"},
        {SQUARE "f 1 2 2147483648\n", BVX_ERR_RANGE, "names vertex 2147483648"},
        {SQUARE "f 1 2 x\n", BVX_ERR_FORMAT, "line 5: expected a face's corner"},
        {SQUARE "f 1 2 3x\n", BVX_ERR_FORMAT, "found '3x'"},
        {SQUARE "f 1 2 3.0\n", BVX_ERR_FORMAT, "found '3.0'"},
        {SQUARE "f 1 2 /1\n", BVX_ERR_FORMAT, "found '/1'"},
        {SQUARE "f 1 2 3/x\n", BVX_ERR_FORMAT, "found '3/x'"},
        {SQUARE "f 1 2 3/1/1/1\n", BVX_ERR_FORMAT, "found '3/1/1/1'"},
        {SQUARE "f 1 2 -\n", BVX_ERR_FORMAT, "found '-'"},
        {SQUARE "f 1 2 3\\x\n", BVX_ERR_FORMAT, "found '3\\x'"},
        {"v 0 0\nf 1 1 1\n", BVX_ERR_FORMAT, "line 1: the line ends where a coordinate"},
        {"f 1 1 1\nv 0 0", BVX_ERR_FORMAT, "line 2: the file ends where a coordinate"},
        {"f 1 1 1\nv 0 0 1x", BVX_ERR_FORMAT, "found '1x'"},
        {"f 1 1 1\nv 0 0,5 1", BVX_ERR_FORMAT, "found '0,5'"},
        {"f 1 1 1\nv 0 0 0x1p3", BVX_ERR_FORMAT, "found '0x1p3'"},
        {"f 1 1 1\nv ", BVX_ERR_FORMAT, "line 2: the file ends"},
        {"f 1 1 1\nf ", BVX_ERR_RANGE, "line 1"},
        {"v 0 0 0\nf ", BVX_ERR_FORMAT, "line 2: a face of 0 corners"},
        {"f 1 1 1\nv 0 0 # 1\n", BVX_ERR_FORMAT, "line 2"},
        {"f 1 1 1\nv 0 \\\nnan 0\n", BVX_ERR_RANGE, "line 3: vertex 1"},
        {"f 1 1 1\nv 0 inf 0\n", BVX_ERR_RANGE, "line 2"},
        {"f 1 1 1\nv 0 0 1e309\n", BVX_ERR_RANGE, "line 2: vertex 1 has a coordinate that is not finite"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        check_refused_text(bad[i].text, OBJ, bad[i].status, bad[i].words);
}

/* Every number of a face replaced by the usual bad ones, and every byte by others. */
static void test_read_obj_every_number(void)
{
    static const char *const numbers[] = {
        "0", "1", "-1", "2147483648", "4294967295", "9223372036854775808", "-9223372036854775809"};
    static const uint8_t values[] = {0, '\n', ' ', '9', '-', '/', '\\', '#', 0xff};
    static const char head[] = SQUARE "vt 0 0\nvt 1 1\n", face[] = "f 1/1 2/2 3/1 4/2\n";
    char text[300];
    bvx_mesh m;

    for (size_t at = 2; face[at] != 0; at++)
        for (size_t i = 0; face[at] >= '0' && i < sizeof numbers / sizeof numbers[0]; i++) {
            sprintf(text, "%s%.*s%s%s", head, (int)at, face, numbers[i], face + at + 1);
            bvx_status const status = read_file(text, strlen(text), OBJ, &m);
            TEST_ASSERT_EQUAL_INT32_MESSAGE(i == 1 || i == 2 ? BVX_OK : BVX_ERR_RANGE, status, text);
            bvx_mesh_free(ctx, &m);
        }
    sprintf(text, "%s%s", head, face);
    for (size_t at = 0; text[at] != 0; at++)
        for (size_t i = 0; i < sizeof values; i++) {
            char const old = text[at];
            text[at] = (char)values[i];
            if (read_file(text, sizeof head + sizeof face - 2, OBJ, &m) == BVX_OK) bvx_mesh_free(ctx, &m);
            text[at] = old;
        }
}

static void test_read_obj_every_prefix(void)
{
    static const char text[] =
        "# x\r\nv 0 0 \\\n0\nv 1e0 -0.5 +1\nvn 1 2 3\nv 1 1 0 0.5 0.5\nf 1//2 2//3 -1//1 1\nf 1 2 \\\n3\n";
    static const char rich[] =
        "v 0 0 0 1 1 1\nv 1 0 0 1 1 0.5\nv 1 1 0 1 0 0\nv 0 1 0 0.25 0 0\nvt 0 0\nvt 1 \\\n1\n"
        "f 1/1 2/2 3/1 4/2\nf 1/-1 2/-2 \\\r\n3/1\n";
    TEST_ASSERT_TRUE(check_every_prefix(text, strlen(text), OBJ, 3) > 5);
    TEST_ASSERT_TRUE(check_every_prefix(rich, strlen(rich), OBJ, 3) > 5);
    check_every_limit(rich, strlen(rich), OBJ);
}

static void test_read_obj_cancels(void)
{
    size_t const n = 3 << 20;
    char *const text = malloc(n + 100);
    memset(text, '\n', n);
    strcpy(text + n, SQUARE "f 1 2 3 4\n");
    TEST_ASSERT_TRUE(check_every_cancel(text, strlen(text), OBJ) >= 7); /* two passes, and the polygons */
    free(text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_read_obj_faces);
    RUN_TEST(test_read_obj_positions);
    RUN_TEST(test_read_obj_large_polygon);
    RUN_TEST(test_read_obj_random);
    RUN_TEST(test_read_obj_in_pieces);
    RUN_TEST(test_read_obj_colours);
    RUN_TEST(test_read_obj_texture_coordinates);
    RUN_TEST(test_read_obj_tells_of_materials);
    RUN_TEST(test_read_obj_concave_polygon);
    RUN_TEST(test_read_obj_refuses);
    RUN_TEST(test_read_obj_every_number);
    RUN_TEST(test_read_obj_every_prefix);
    RUN_TEST(test_read_obj_cancels);
    return UNITY_END();
}
