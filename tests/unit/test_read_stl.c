/* test_read_stl.c - STL files right and wrong. */
#include "read_support.h"

enum { STL = BVX_FORMAT_STL };

static uint8_t file[400000];

/* A binary file of count triangles; returns its size. xyz [Size: count * 9] */
static size_t put_binary(const char *header, uint32_t count, const float *xyz)
{
    memset(file, 0, 84);
    memcpy(file, header, strlen(header));
    put_u32(file + 80, count, 0);
    for (uint32_t t = 0; t < count; t++) {
        uint8_t *const p = file + 84 + 50 * t;
        memset(p, 0xff, 50); /* normals that are NaN and attributes must not matter */
        for (int i = 0; i < 9; i++) put_f32(p + 12 + 4 * i, xyz[9 * t + (uint32_t)i], 0);
    }
    return 84 + 50 * (size_t)count;
}

static const float two[18] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 0, 0, 1, 1, 0, 0, 1, -0.0f};

static const char text_two[] =
    "solid a facet of words\n"
    "  facet normal 0 0 1\n    outer loop\n      vertex 0 0 0\n      vertex 1 0 0\n"
    "      vertex 0 1 0\n    endloop\n  endfacet\n"
    "  facet normal nan -inf 1e999\n    outer loop\n      vertex 1 0 0\n      vertex 1 1 0\n"
    "      vertex 0 1 -0\n    endloop\n  endfacet\n"
    "endsolid a facet of words\n";

static void check_two(const bvx_mesh *m)
{
    static const uint32_t want[6] = {0, 1, 2, 1, 3, 2};
    static const float xyz[12] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0};
    TEST_ASSERT_EQUAL_UINT64(2, m->triangle_count);
    TEST_ASSERT_EQUAL_UINT64(4, m->vertex_count); /* -0 is 0 */
    TEST_ASSERT_EQUAL_INT32(BVX_F32, m->position_type);
    TEST_ASSERT_EQUAL_UINT32_ARRAY(want, m->triangles, 6);
    TEST_ASSERT_EQUAL_MEMORY(xyz, m->positions, sizeof xyz);
}

static void check_reads_two(const void *bytes, size_t size)
{
    bvx_mesh m;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(bytes, size, STL, &m), bvx_last_message(ctx));
    check_two(&m);
    bvx_mesh_free(ctx, &m);
}

static void test_read_stl_binary(void)
{
    check_reads_two(file, put_binary("made by hand", 2, two));
    check_reads_two(file, put_binary("solid but binary\n", 2, two));
    check_reads_two(file, put_binary("solid but binary\n", 2, two) + 1); /* a trailing byte */
    check_reads_two(file, put_binary("", 2, two) + 1000);
    memset(file, ' ', 80); /* a header without control characters: the size tells */
    check_reads_two(file, 184);
}

static void test_read_stl_ascii(void)
{
    static char other[2000];

    check_reads_two(text_two, strlen(text_two));
    char *o = other;
    for (const char *p = text_two; *p != 0; p++) { /* CRLF, tabs, capitals */
        if (*p == '\n') *o++ = '\r';
        *o++ = *p == ' ' ? '\t' : *p >= 'a' && *p <= 'z' ? (char)(*p - 32) : *p;
    }
    check_reads_two(other, (size_t)(o - other));
    sprintf(other, "\xef\xbb\xbf\n\n%s", text_two);
    check_reads_two(other, strlen(other));
    sprintf(other, "%.*s", (int)(strlen(text_two) - 1), text_two); /* no newline at the end */
    check_reads_two(other, strlen(other));
    static const char several[] =
        "solid\nfacet normal 0 0 0 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 endloop endfacet "
        "endsolid\nSOLID two\nfacet outer loop vertex 1 0 0 vertex 1 1 0 vertex 0 1 0 endloop\n"
        "endfacet endsolid";
    check_reads_two(several, strlen(several));
    static const char quad[] =
        "facet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 1 1 0 vertex 0 1 0 endloop endfacet";
    static const uint32_t fan[6] = {0, 1, 2, 0, 2, 3};
    bvx_mesh m;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_file(quad, strlen(quad), STL, &m));
    TEST_ASSERT_EQUAL_UINT32_ARRAY(fan, m.triangles, 6);
    bvx_mesh_free(ctx, &m);
}

static void test_read_stl_ascii_rounds_to_float(void)
{
    static const char text[] =
        "solid\nfacet outer loop vertex 0.1 16777217 1e-45 vertex 3.4028235e38 -0.0 1e-50\n"
        "vertex 1.00000017881393432617187500 1 1 endloop endfacet\nendsolid";
    static const uint32_t bits[9] = {0x3dcccccdu, 0x4b800000u, 1,           0x7f7fffffu, 0,
                                     0,           0x3f800002u, 0x3f800000u, 0x3f800000u};
    bvx_mesh m;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_file(text, strlen(text), STL, &m));
    TEST_ASSERT_EQUAL_MEMORY(bits, m.positions, sizeof bits);
    bvx_mesh_free(ctx, &m);
}

/* A sheet of side x side squares: known vertices, more than the first room of every array. */
static size_t put_sheet_text(int side, char *text)
{
    char *t = text + sprintf(text, "solid sheet\n");
    for (int i = 0; i < side * side; i++) {
        int const x = i % side, y = i / side;
        t += sprintf(
            t,
            "facet normal 0 0 1\nouter loop\nvertex %d %d 0\nvertex %d %d 0\nvertex %d %d 0\nvertex %d %d 0\n"
            "endloop\nendfacet\n",
            x, y, x + 1, y, x + 1, y + 1, x, y + 1);
    }
    return (size_t)(t + sprintf(t, "endsolid\n") - text);
}

static size_t put_sheet_binary(int side)
{
    float *const xyz = malloc(sizeof(float) * 18 * (size_t)(side * side));

    for (int i = 0; i < side * side; i++) {
        float const x = (float)(i % side), y = (float)(i / side);
        float const p[18] = {x, y, 0, x + 1, y, 0, x + 1, y + 1, 0, x, y, 0, x + 1, y + 1, 0, x, y + 1, 0};
        memcpy(xyz + 18 * i, p, sizeof p);
    }
    size_t const size = put_binary("sheet", (uint32_t)(2 * side * side), xyz);
    free(xyz);
    return size;
}

static void check_sheet(const void *bytes, size_t size, int side)
{
    bvx_mesh m;

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(bytes, size, STL, &m), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64((uint64_t)(2 * side * side), m.triangle_count);
    TEST_ASSERT_EQUAL_UINT64((uint64_t)((side + 1) * (side + 1)), m.vertex_count);
    uint32_t next = 0; /* vertices are numbered as they are met */
    for (uint64_t t = 0; t < m.triangle_count; t++) {
        int const x = (int)(t / 2) % side, y = (int)(t / 2) / side;
        int const dx[2][3] = {{0, 1, 1}, {0, 1, 0}}, dy[2][3] = {{0, 0, 1}, {0, 1, 1}};
        for (int k = 0; k < 3; k++) {
            double p[3];
            corner_of(&m, t, k, p);
            TEST_ASSERT_TRUE(p[0] == x + dx[t % 2][k] && p[1] == y + dy[t % 2][k] && p[2] == 0);
            TEST_ASSERT_TRUE(m.triangles[3 * t + (uint64_t)k] <= next);
            next += m.triangles[3 * t + (uint64_t)k] == next;
        }
    }
    bvx_mesh_free(ctx, &m);
}

static void test_read_stl_welds_many(void)
{
    char *const text = malloc(1 << 20);
    check_sheet(file, put_sheet_binary(50), 50);
    check_sheet(text, put_sheet_text(50, text), 50);
    size_t const size = put_sheet_text(12, text);
    check_every_limit(text, size, STL);
    check_every_limit(file, put_sheet_binary(12), STL);
    free(text);
}

static void test_read_stl_all_vertices_different(void) /* the most vertices that a file can have */
{
    enum { COUNT = 3000 };
    float *const xyz = malloc(COUNT * 9 * sizeof(float));
    uint64_t state = 5;
    for (int i = 0; i < COUNT * 9; i++) xyz[i] = (float)(int64_t)(next_random(&state) >> 30);
    bvx_mesh m;
    size_t const size = put_binary("random", COUNT, xyz);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_file(file, size, STL, &m));
    TEST_ASSERT_EQUAL_UINT64(3 * COUNT, m.vertex_count);
    TEST_ASSERT_EQUAL_MEMORY(xyz, m.positions, COUNT * 9 * sizeof(float));
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) < 4 * size);
    bvx_mesh_free(ctx, &m);
    free(xyz);
}

static void test_read_stl_refuses_counts(void)
{
    size_t const size = put_binary("two", 2, two);
    static const uint32_t counts[] = {3, 0x7fffffffu, 0x80000000u, 0xffffffffu, 0xfffffffeu, 85899346u};

    /* the last: 50 * count is 4 beyond 2^32 */
    for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
        put_u32(file + 80, counts[i], 0);
        check_refused(file, size, STL, BVX_ERR_FORMAT, "byte 80");
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_peak(ctx)); /* before anything was allocated */
    }
    put_u32(file + 80, 0, 0);
    check_refused(file, size, STL, BVX_ERR_EMPTY, "0 triangles");
    check_refused(file, 84, STL, BVX_ERR_EMPTY, "0 triangles");
    put_u32(file + 80, 1, 0);
    bvx_mesh m;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_file(file, size, STL, &m));
    TEST_ASSERT_EQUAL_UINT64(1, m.triangle_count);
    bvx_mesh_free(ctx, &m);
}

/* Every byte of small files replaced: no crash, no leak, a valid mesh or an error. */
static void test_read_stl_every_byte_changed(void)
{
    static const uint8_t values[] = {0, 1, 0x7f, 0x80, 0xff, '\n', ' ', '9', '-'};

    for (int is_text = 0; is_text < 2; is_text++) {
        size_t const size = is_text ? strlen(text_two) : put_binary("two", 2, two);
        if (is_text) memcpy(file, text_two, size);
        for (size_t i = 0; i < size; i++)
            for (size_t k = 0; k < sizeof values; k++) {
                bvx_mesh m;
                uint8_t const old = file[i];
                file[i] = values[k];
                if (read_file(file, size, STL, &m) == BVX_OK) bvx_mesh_free(ctx, &m);
                file[i] = old;
            }
    }
}

static void test_read_stl_refuses_numbers(void)
{
    static const uint32_t bad[] = {0x7f800000u, 0xff800000u, 0x7fc00000u, 0x7f800001u, 0xffffffffu};

    for (int at = 0; at < 18; at++)
        for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
            char words[40];
            size_t const size = put_binary("two", 2, two);
            put_u32(file + 84 + 50 * (at / 9) + 12 + 4 * (at % 9), bad[i], 0);
            sprintf(words, "triangle %d, corner %d (byte %d)", at / 9, at % 9 / 3,
                    84 + 50 * (at / 9) + 12 + 12 * (at % 9 / 3));
            check_refused(file, size, STL, BVX_ERR_RANGE, words);
        }
}

static void test_read_stl_refuses_text(void)
{
    static const struct {
        const char *text;
        bvx_status status;
        const char *words;
    } bad[] = {
        {"", BVX_ERR_EMPTY, "STL: the file has no bytes"},
        {" \n", BVX_ERR_EMPTY, "no triangle"},
        {"solid nothing\nendsolid nothing\n", BVX_ERR_EMPTY, "no triangle"},
        {"solid cut\n", BVX_ERR_FORMAT, "line 2: the file ends where 'facet' or 'endsolid'"},
        {"hello world\n", BVX_ERR_FORMAT, "line 1: expected 'solid' or 'facet', found 'hello'"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0\nvertex", BVX_ERR_FORMAT,
         "line 5: expected a coordinate"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1x\n", BVX_ERR_FORMAT,
         "line 4: expected a coordinate, found '1x'"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0,5 1\n", BVX_ERR_FORMAT, "found '0,5'"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 nan 1\n", BVX_ERR_RANGE, "line 4"},
        {"solid\nfacet normal 0 0 1\nouter loop\r\nvertex 0 1 -1e39\n", BVX_ERR_RANGE, "line 4"},
        {"solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 1\nvertex 1 1 1\nendloop\n", BVX_ERR_FORMAT,
         "line 6: expected three"},
        {"solid\nfacet normal 0 0 1\nvertex 0 0 1\n", BVX_ERR_FORMAT, "'outer loop'"},
        {"solid\nfacet normal 0 0 1\nouter vertex 0 0 1\n", BVX_ERR_FORMAT, "line 3: expected 'outer loop'"},
        {"solid\nfacet outer loop vertex 0 0 1 vertex 1 0 0 vertex 0 1 0 endfacet\n", BVX_ERR_FORMAT,
         "'endloop'"},
        {"solid\nfacet outer loop vertex 0 0 1 vertex 1 0 0 vertex 0 1 0 endloop facet\n", BVX_ERR_FORMAT,
         "'endfacet'"},
        {"solid\nsolid\n", BVX_ERR_FORMAT, "line 2"},
        {"solid\nfacet outer loop vertex 0 0 1 vertex 1 0 0 vertex 0 1 0 endloop endfacet endsolid\nmore",
         BVX_ERR_FORMAT, "line 3"},
        {"abc\001", BVX_ERR_FORMAT, "4 bytes"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++)
        check_refused_text(bad[i].text, STL, bad[i].status, bad[i].words);
    char one_line[200]; /* a message stays one line, whatever stands in the file */
    memset(one_line, 'a', sizeof one_line);
    one_line[5] = (char)0xfe;
    check_refused(one_line, sizeof one_line, STL, BVX_ERR_FORMAT, "...'");
    TEST_ASSERT_NULL(strchr(bvx_last_message(ctx), '\n'));
}

static void test_read_stl_every_prefix(void)
{
    /* only the whole is right */
    TEST_ASSERT_EQUAL_INT(1, check_every_prefix(file, put_binary("two", 2, two), STL, 2));
    /* text: all of "endsolid" must be there, what follows it does not matter */
    TEST_ASSERT_EQUAL_INT((int)strlen(" a facet of words\n") + 1,
                          check_every_prefix(text_two, strlen(text_two), STL, 2));
}

static void test_read_stl_cancels(void)
{
    size_t const n = 100000 * 50;
    uint8_t *const large = calloc(1, 84 + n);
    put_u32(large + 80, 100000, 0);
    TEST_ASSERT_TRUE(check_every_cancel(large, 84 + n, STL) >= 4); /* about one a megabyte */
    free(large);
    TEST_ASSERT_EQUAL_INT(1, check_every_cancel(text_two, strlen(text_two), STL));
}

static uint64_t inverse_of(uint64_t odd)
{
    uint64_t x = odd;
    for (int i = 0; i < 6; i++) x *= 2 - odd * x;
    return x;
}

/* A file whose corners x, y, 0 have hashes (of stl.c) with 24 equal bits at their end, all
 * different, n triangles and then the same n again; to be freed. */
static uint8_t *make_flood(uint32_t n, size_t *size)
{
    uint64_t const first = inverse_of(UINT64_C(0x9e3779b97f4a7c15));
    uint64_t const last = inverse_of(UINT64_C(0xbf58476d1ce4e5b9));
    uint32_t corners = 0;
    uint8_t *const bytes = calloc(1, *size = 84 + (size_t)100 * n);

    TEST_ASSERT_NOT_NULL(bytes);
    put_u32(bytes + 80, 2 * n, 0);
    for (uint64_t i = 1; corners < 3 * n; i++) {
        uint64_t const hash = i << 24, mixed = (hash ^ hash >> 32) * last, xy = (mixed ^ mixed >> 32) * first;
        uint32_t const x = (uint32_t)xy, y = (uint32_t)(xy >> 32);
        uint8_t *const p = bytes + 96 + (size_t)(corners / 3) * 50 + corners % 3 * 12;
        if (x << 1 >= UINT32_C(0xff000000) || y << 1 >= UINT32_C(0xff000000) || x << 1 == 0 || y << 1 == 0)
            continue;
        put_u32(p, x, 0);
        put_u32(p + 4, y, 0);
        corners++;
    }
    memcpy(bytes + 84 + (size_t)50 * n, bytes + 84, (size_t)50 * n);
    return bytes;
}

/* Searched to its end the table would take 10^10 steps. */
static void test_read_stl_made_against_the_hash(void)
{
    uint32_t const n = 40000;
    size_t size;
    uint8_t *const bytes = make_flood(n, &size);
    bvx_mesh m = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_mesh(ctx, bytes, size, STL, NULL, &m));
    TEST_ASSERT_EQUAL_UINT64(2 * n, m.triangle_count);
    TEST_ASSERT_EQUAL_UINT64(3 * n, m.vertex_count);
    for (uint32_t k = 0; k < 6 * n; k++) TEST_ASSERT_EQUAL_UINT32(k % (3 * n), m.triangles[k]);
    for (uint32_t k = 0; k < 9 * n; k++) {
        const uint8_t *const p = bytes + 96 + (size_t)(k / 9) * 50 + k % 9 * 4;
        uint32_t bits;
        memcpy(&bits, (const float *)m.positions + k, sizeof bits);
        TEST_ASSERT_EQUAL_HEX32(
            (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24, bits);
    }
    bvx_mesh_free(ctx, &m);
    free(bytes);
}

static void test_read_mesh_arguments(void)
{
    bvx_mesh m = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_mesh(NULL, "x", 1, STL, NULL, &m));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_mesh(ctx, NULL, 1, STL, NULL, &m));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_mesh(ctx, "x", 1, STL, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_mesh(ctx, "x", UINT64_MAX, STL, NULL, &m));
    for (int32_t format = -1; format < 14; format++)
        if (format < 0 || (BVX_MESHES_READ >> format & 1) == 0)
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_mesh(ctx, "x", 1, format, NULL, &m));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_mesh(ctx, text_two, strlen(text_two), STL, NULL, &m));
    /* its own arrays: used again */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_mesh(ctx, text_two, strlen(text_two), STL, NULL, &m));
    check_two(&m);
    bvx_mesh_free(ctx, &m);
    for (int i = 0; i < 7; i++) { /* one array is enough */
        bvx_mesh one = {0};
        uint64_t array[3] = {0};
        if (i == 0) one.positions = array;
        if (i == 1) one.triangles = (uint32_t *)array;
        if (i == 2) one.vertex_keys = array;
        if (i == 3) one.triangle_keys = array;
        if (i == 4) one.colours = (uint8_t *)array;
        if (i == 5) one.uvs = (float *)array;
        if (i == 6) one.uv_triangles = (uint32_t *)array;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                                bvx_read_mesh(ctx, text_two, strlen(text_two), STL, NULL, &one));
    }
}

static void test_format_of_name(void)
{
    static const struct {
        const char *name;
        int32_t format;
    } names[] = {{"a.stl", BVX_FORMAT_STL},         {"A.STL", BVX_FORMAT_STL},
                 {"dir.obj/a.Ply", BVX_FORMAT_PLY}, {".obj", BVX_FORMAT_OBJ},
                 {"a.obj.gz", BVX_FORMAT_OBJ},      {"a.OBJ.GZ", BVX_FORMAT_OBJ},
                 {"a.npy", BVX_FORMAT_NPY},         {"a.png", BVX_FORMAT_PNG},
                 {"", BVX_FORMAT_UNKNOWN},          {"stl", BVX_FORMAT_UNKNOWN},
                 {"a.gz", BVX_FORMAT_UNKNOWN},      {".gz", BVX_FORMAT_UNKNOWN},
                 {"a.stl.txt", BVX_FORMAT_UNKNOWN}, {"a.stl.gz.gz", BVX_FORMAT_UNKNOWN},
                 {"a.stl/", BVX_FORMAT_UNKNOWN}};
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++)
        TEST_ASSERT_EQUAL_INT32_MESSAGE(names[i].format, bvx_format_of_name(names[i].name), names[i].name);
    TEST_ASSERT_EQUAL_INT32(BVX_FORMAT_UNKNOWN, bvx_format_of_name(NULL));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_read_stl_binary);
    RUN_TEST(test_read_stl_ascii);
    RUN_TEST(test_read_stl_ascii_rounds_to_float);
    RUN_TEST(test_read_stl_welds_many);
    RUN_TEST(test_read_stl_all_vertices_different);
    RUN_TEST(test_read_stl_refuses_counts);
    RUN_TEST(test_read_stl_every_byte_changed);
    RUN_TEST(test_read_stl_refuses_numbers);
    RUN_TEST(test_read_stl_refuses_text);
    RUN_TEST(test_read_stl_every_prefix);
    RUN_TEST(test_read_stl_cancels);
    RUN_TEST(test_read_stl_made_against_the_hash);
    RUN_TEST(test_read_mesh_arguments);
    RUN_TEST(test_format_of_name);
    return UNITY_END();
}
