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
        if (n < 3 * m.triangle_count) TEST_ASSERT_EQUAL_UINT32_MESSAGE((uint32_t)want[n], m.triangles[n], text);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(n, 3 * m.triangle_count, text);
    bvx_mesh_free(ctx, &m);
}

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
static const int square_fan[] = {0, 1, 2, 0, 2, 3, -1};

static void test_read_obj_faces(void)
{
    static const char *const same[] = {
        SQUARE "f 1 2 3 4\n", SQUARE "f 1 2 3 4", SQUARE "f 1 2 3\nf 1 3 4", SQUARE "f -4 -3 -2 -1\n",
        SQUARE "f 1/1 2/2 3/3 4/4\n", SQUARE "f 1//9 2//9 3//9 4//9\n", SQUARE "f 1/7/9 2/-7/-9 3/7/9 4/7/9\n",
        SQUARE "f 1/ 2// 3/1/ 4\n", SQUARE "f +1 +2 +3 +4\n", SQUARE "f\t1 \t2\v3\f4 \t\n", SQUARE "  f 1 2 3 4 # comment\n",
        SQUARE "f 1 2 \\\n3 4\n", SQUARE "f 1 2 \\\r\n3 4\r\n", SQUARE "f \\\n\\\n1 2 3 \\\n 4\\\n\n", SQUARE "f\\\n1 2 3 4",
        SQUARE "f 1 2 3 4\\", SQUARE "f 0001 2 3 4\n", "f 1 2 3 4\n" SQUARE, "v 0 0 0\nv 1 0 0\nf -2 -1 3 4\nv 1 1 0\nv 0 1 0\n",
        "\xef\xbb\xbf" SQUARE "f 1 2 3 4\n", "#f 1 2 3\n" SQUARE "g a\no b\ns off\nusemtl f\nvt 0 0\nvn 0 0 1\nvp 1 1\nf 1 2 3 4\n",
        SQUARE "mtllib /dev/random\ncall /dev/random\ncsh touch never\nunknown f 1 2 3\nl 1 2 3\np 1\nf 1 2 3 4\n",
        SQUARE "# a path ends in \\\nf 1 2 3 4\n", SQUARE "mtllib C:\\a\\\nf 1 2 3 4\n", SQUARE "fo 1 2 3\nF 1 2 3\nf 1 2 3 4\n",
        "\r\n\n\r\nv 0 0 0\r\nv 1 0 0\r\nv 1 1 0\r\nv 0 1 0\r\n\r\nf 1 2 3 4\r\n\r\n",
        "v 0 0 0\rv 1 0 0\rv 1 1 0\rv 0 1 0\r# no newline at all\rf 1 2 \\\r3 4\r",
        "v 0 0 \\\n0\nv \\\n1 0 0\nv 1 1 0\nv 0 1 0 \\\n 0.5 0.5 0.5\nf 1 2 3 4\n",
        "v 0 0 0 1.0\nv 1 0 0 0.1 0.2 0.3\nv 1 1 0 red\nv 0 1 0#x\nf 1 2 3 4\n",
    };
    for (size_t i = 0; i + 1 < sizeof same / sizeof same[0]; i++) check_triangles(same[i], strlen(same[i]), 4, square_fan);
    check_refused_text(same[sizeof same / sizeof same[0] - 1], OBJ, BVX_ERR_FORMAT, "line 4: expected a coordinate, found '0#x'");
    static const char with_zero[] = SQUARE "#\0 \0\nx\0\nf 1 2 3 4\n";
    check_triangles(with_zero, sizeof with_zero - 1, 4, square_fan);
    static const int twice[] = {0, 1, 2, 0, 1, 2, 0, 0, 0, -1}; /* duplicate and degenerate ones are legal */
    static const char odd[] = SQUARE "f 1 2 3\nf 1 2 3\nf 1 1 1\n";
    check_triangles(odd, strlen(odd), 4, twice);
}

static void test_read_obj_positions(void)
{
    static const char text[] = "v 0.1 -1.5e3 .25\nv -0 1e-320 123456789.123456789\nv +1. 9007199254740993 1E+2\nf 1 2 3\n";
    static const double want[9] = {0.1, -1500, 0.25, -0.0, 1e-320, 123456789.123456789, 1, 9007199254740992.0, 100};
    bvx_mesh m;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_file(text, strlen(text), OBJ, &m));
    TEST_ASSERT_EQUAL_MEMORY(want, m.positions, sizeof want);
    bvx_mesh_free(ctx, &m);
}

static void test_read_obj_large_polygon(void)
{
    enum { CORNERS = 5000 };
    char *const text = malloc(CORNERS * 40), *t = text;
    for (int i = 0; i < CORNERS; i++) t += sprintf(t, "v %d 0 %d\n", i, i % 7);
    *t++ = 'f';
    for (int i = 0; i < CORNERS; i++) t += sprintf(t, i % 2 == 0 ? " %d//1" : " %d\\\n", i % 3 == 0 ? i + 1 : i - CORNERS);
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

/* Random files of vertices and faces in every form, against what the generator meant. */
static void test_read_obj_random(void)
{
    static const char *const gaps[] = {" ", "  ", "\t", " \\\n ", " \\\r\n"};
    static const char *const ends[] = {"\n", "\r\n", " \n", " # f 1 2 3\n"};
    static const char *const noise[] = {"", "", "# v 1 2 3\n", "vn 0 0 1\n", "vt 1 1\n", "g f 1 2 3\n", "\n", "s 1\r\n"};
    static char text[60000];
    static int want[20000];
    uint64_t state = 3;
    for (int round = 0; round < 60; round++) {
        char *t = text;
        int vertices = 0, n = 0;
        int const total = 3 + (int)(next_random(&state) % 100);
        while (vertices < total || n < 30) {
            t += sprintf(t, "%s", noise[next_random(&state) % 8]);
            if (vertices < total && next_random(&state) % 2 == 0) {
                vertices++;
                t += sprintf(t, "v%s%d%s%d.5%s-%de-1%s", gaps[next_random(&state) % 5], vertices, gaps[next_random(&state) % 5],
                             vertices, gaps[next_random(&state) % 5], vertices, ends[next_random(&state) % 4]);
            } else {
                int const corners = 3 + (int)(next_random(&state) % 4);
                int first = 0, previous = 0;
                t += sprintf(t, "f");
                for (int k = 0; k < corners; k++) {
                    int const vertex = (int)(next_random(&state) % (uint64_t)total);
                    uint64_t const form = next_random(&state) % 4;
                    t += sprintf(t, "%s%d", gaps[next_random(&state) % 5],
                                 next_random(&state) % 2 == 0 && vertex < vertices ? vertex - vertices : vertex + 1);
                    t += sprintf(t, "%s", form == 0 ? "" : form == 1 ? "/1" : form == 2 ? "//-3" : "/1/1");
                    if (k == 0) first = vertex;
                    if (k >= 2) {
                        want[n++] = first;
                        want[n++] = previous;
                        want[n++] = vertex;
                    }
                    previous = vertex;
                }
                t += sprintf(t, "%s", ends[next_random(&state) % 4]);
            }
        }
        want[n] = -1;
        check_triangles(text, (size_t)(t - text), (uint64_t)total, want);
    }
}

static void test_read_obj_refuses(void)
{
    static const struct {
        const char *text;
        bvx_status status;
        const char *words;
    } bad[] = {
        {"", BVX_ERR_EMPTY, "OBJ: the file has no bytes"}, {"\n", BVX_ERR_EMPTY, "no face"}, {SQUARE, BVX_ERR_EMPTY, "no face"},
        {"not an OBJ file", BVX_ERR_EMPTY, "no face"},
        {SQUARE "f\n", BVX_ERR_EMPTY, "no face"}, /* 'f' without a space behind it is another word */
        {SQUARE "f \n", BVX_ERR_FORMAT, "line 5: a face of 0 corners"},
        {SQUARE "f 1 2\n", BVX_ERR_FORMAT, "line 5: a face of 2 corners"},
        {SQUARE "f 1 2 # 3\n", BVX_ERR_FORMAT, "a face of 2 corners"},
        {SQUARE "f 1 2 3 5\n", BVX_ERR_RANGE, "line 5: the face names vertex 5; there are 4"},
        {SQUARE "f 1 2 0\n", BVX_ERR_RANGE, "names vertex 0"},
        {SQUARE "f 1 2 -5\n", BVX_ERR_RANGE, "names vertex -5"},
        {"v 0 0 0\nf -2 1 1\nv 0 0 0\n", BVX_ERR_RANGE, "line 2: the face names vertex -2; there are 2, 1 of them before it"},
        {SQUARE "f 1 2 99999999999999999999999999\n", BVX_ERR_RANGE, "line 5"},
        {SQUARE "f 1 2 -99999999999999999999999999\n", BVX_ERR_RANGE, "line 5"},
        {SQUARE "f 1 2 4294967297\n", BVX_ERR_RANGE, "names vertex 4294967297"},
        {SQUARE "f 1 2 2147483648\n", BVX_ERR_RANGE, "names vertex 2147483648"},
        {SQUARE "f 1 2 x\n", BVX_ERR_FORMAT, "line 5: expected a face's corner"},
        {SQUARE "f 1 2 3x\n", BVX_ERR_FORMAT, "found '3x'"}, {SQUARE "f 1 2 3.0\n", BVX_ERR_FORMAT, "found '3.0'"},
        {SQUARE "f 1 2 /1\n", BVX_ERR_FORMAT, "found '/1'"}, {SQUARE "f 1 2 3/x\n", BVX_ERR_FORMAT, "found '3/x'"},
        {SQUARE "f 1 2 3/1/1/1\n", BVX_ERR_FORMAT, "found '3/1/1/1'"}, {SQUARE "f 1 2 -\n", BVX_ERR_FORMAT, "found '-'"},
        {SQUARE "f 1 2 3\\x\n", BVX_ERR_FORMAT, "found '3\\x'"},
        {"v 0 0\nf 1 1 1\n", BVX_ERR_FORMAT, "line 1: the line ends where a coordinate"},
        {"f 1 1 1\nv 0 0", BVX_ERR_FORMAT, "line 2: the file ends where a coordinate"},
        {"f 1 1 1\nv 0 0 1x", BVX_ERR_FORMAT, "found '1x'"}, {"f 1 1 1\nv 0 0,5 1", BVX_ERR_FORMAT, "found '0,5'"},
        {"f 1 1 1\nv 0 0 0x1p3", BVX_ERR_FORMAT, "found '0x1p3'"},
        {"f 1 1 1\nv ", BVX_ERR_FORMAT, "line 2: the file ends"}, {"f 1 1 1\nf ", BVX_ERR_RANGE, "line 1"},
        {"v 0 0 0\nf ", BVX_ERR_FORMAT, "line 2: a face of 0 corners"},
        {"f 1 1 1\nv 0 0 # 1\n", BVX_ERR_FORMAT, "line 2"},
        {"f 1 1 1\nv 0 \\\nnan 0\n", BVX_ERR_RANGE, "line 3: vertex 1"}, {"f 1 1 1\nv 0 inf 0\n", BVX_ERR_RANGE, "line 2"},
        {"f 1 1 1\nv 0 0 1e309\n", BVX_ERR_RANGE, "line 2: vertex 1 has a coordinate that is not finite"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        check_refused_text(bad[i].text, OBJ, bad[i].status, bad[i].words);
}

static void test_read_obj_every_prefix(void)
{
    static const char text[] = "# x\r\nv 0 0 \\\n0\nv 1e0 -0.5 +1\nvn 1 2 3\nv 1 1 0 0.5 0.5\nf 1//2 2//3 -1//1 1\nf 1 2 \\\n3\n";
    TEST_ASSERT_TRUE(check_every_prefix(text, strlen(text), OBJ, 3) > 5);
}

static void test_read_obj_cancels(void)
{
    size_t const n = 3 << 20;
    char *const text = malloc(n + 100);
    memset(text, '\n', n);
    strcpy(text + n, SQUARE "f 1 2 3\n");
    TEST_ASSERT_TRUE(check_every_cancel(text, strlen(text), OBJ) >= 6); /* two passes */
    free(text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_read_obj_faces);
    RUN_TEST(test_read_obj_positions);
    RUN_TEST(test_read_obj_large_polygon);
    RUN_TEST(test_read_obj_random);
    RUN_TEST(test_read_obj_refuses);
    RUN_TEST(test_read_obj_every_prefix);
    RUN_TEST(test_read_obj_cancels);
    return UNITY_END();
}
