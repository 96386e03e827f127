/* test_write_normals.c - meshes written with the normals of their vertices: bytes worked by hand, every
 * attribute beside them, the same numbers as bvx_mesh_normals, and formats without. */
#include "write_support.h"

#include <stddef.h>

static bvx_buffer write_normals(const bvx_mesh *m, int32_t format)
{
    bvx_write_options o = {.struct_size = sizeof o};
    bvx_buffer b = {0};

    TEST_ASSERT_TRUE(o.struct_size == sizeof o && o.normals == 0 && o.rounding == BVX_ROUNDING_REFUSE);
    o.normals = 1;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_mesh(ctx, m, 1, &o, format, &b), bvx_last_message(ctx));
    TEST_ASSERT_TRUE(b.size > 0 && b.size <= b.capacity);
    return b;
}

/* A square in the plane of y, seen from -y, and a vertex without triangles. */
static bvx_mesh square(void)
{
    static float xyz[15] = {0, 0, 0, 2, 0, 0, 2, 0, 0.5f, 0, 0, 0.5f, 9, 9, 9};
    static uint32_t corner[6] = {0, 1, 2, 2, 3, 0};
    bvx_mesh m = {0};

    m.positions = xyz;
    m.triangles = corner;
    m.vertex_count = m.vertex_capacity = 5;
    m.triangle_count = m.triangle_capacity = 2;
    m.position_type = BVX_F32;
    return m;
}

static float square_uvs[10] = {0, 0, 1, 0, 1, 0.5f, 0, 1, -3, 2};
static uint8_t square_colours[20] = {255, 0, 0, 255, 0, 255, 0, 255};

static void check_text(const bvx_mesh *m, const char *want)
{
    bvx_buffer b = write_normals(m, BVX_FORMAT_OBJ);
    TEST_ASSERT_EQUAL_UINT64(strlen(want), b.size);
    TEST_ASSERT_EQUAL_MEMORY(want, b.bytes, strlen(want));
    bvx_buffer_free(ctx, &b);
}

#define VERTICES_TEXT "# OBJ written by bitvox\nv 0 0 0\nv 2 0 0\nv 2 0 0.5\nv 0 0 0.5\nv 9 9 9\n"
#define NORMALS_TEXT  "vn 0 -1 0\nvn 0 -1 0\nvn 0 -1 0\nvn 0 -1 0\nvn 0 0 1\n"

static void test_write_normals_obj_bytes(void)
{
    static uint32_t corner_uvs[6] = {4, 1, 2, 2, 3, 0};
    bvx_mesh m = square();

    check_text(&m, VERTICES_TEXT NORMALS_TEXT "f 1//1 2//2 3//3\nf 3//3 4//4 1//1\n");
    m.uvs = square_uvs;
    m.uv_count = 5;
    check_text(&m, VERTICES_TEXT "vt 0 0\nvt 1 0\nvt 1 0.5\nvt 0 1\nvt -3 2\n" NORMALS_TEXT
                                 "f 1/1/1 2/2/2 3/3/3\nf 3/3/3 4/4/4 1/1/1\n");
    m.uv_triangles = corner_uvs;
    check_text(&m, VERTICES_TEXT "vt 0 0\nvt 1 0\nvt 1 0.5\nvt 0 1\nvt -3 2\n" NORMALS_TEXT
                                 "f 1/5/1 2/2/2 3/3/3\nf 3/3/3 4/4/4 1/1/1\n");
}

static void test_write_normals_ply_bytes(void)
{
    static const char header[] =
        "ply\nformat binary_little_endian 1.0\ncomment written by bitvox\nelement vertex 5\n"
        "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
        "property float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
        "property uchar alpha\nproperty float s\nproperty float t\nelement face 2\n"
        "property list uchar int vertex_indices\nend_header\n";
    bvx_mesh m = square();
    size_t const n = strlen(header);

    m.uvs = square_uvs;
    m.uv_count = 5;
    m.colours = square_colours;
    bvx_buffer b = write_normals(&m, BVX_FORMAT_PLY);
    TEST_ASSERT_EQUAL_UINT64(n + 5 * 36 + 26, b.size);
    TEST_ASSERT_EQUAL_MEMORY(header, b.bytes, n);
    for (size_t v = 0; v < 5; v++) {
        const uint8_t *const at = b.bytes + n + 36 * v;
        for (size_t a = 0; a < 3; a++) {
            uint8_t want[8];
            put_f32(want, ((float *)m.positions)[3 * v + a], 0);
            put_f32(want + 4, v < 4 ? a == 1 ? -1.0f : 0.0f : a == 2 ? 1.0f : 0.0f, 0);
            TEST_ASSERT_EQUAL_MEMORY(want, at + 4 * a, 4);
            /* -0 */
            TEST_ASSERT_TRUE(memcmp(want + 4, at + 12 + 4 * a, 4) == 0 ||
                             (want[7] == 0 && at[15 + 4 * a] == 0x80));
        }
        TEST_ASSERT_EQUAL_MEMORY(square_colours + 4 * v, at + 24, 4);
    }
    bvx_buffer_free(ctx, &b);
}

/* What is read back is what was written without normals too; the readers leave them out. */
static void test_write_normals_keep_the_rest(void)
{
    for (int with = 0; with < 8; with++)
        for (int32_t type = BVX_F32; type <= BVX_F64; type++)
            for (int32_t format = BVX_FORMAT_OBJ; format <= BVX_FORMAT_PLY; format++) {
                bvx_mesh const m = random_mesh(type, with, 5);
                bvx_buffer b = write_normals(&m, format);
                bvx_mesh back = {0}, plain = write_and_read(&m, format);
                uint64_t hash = 1, want = 2;
                TEST_ASSERT_EQUAL_INT32_MESSAGE(
                    BVX_OK, bvx_read_mesh(ctx, b.bytes, b.size, format, NULL, &back), bvx_last_message(ctx));
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &back, &hash));
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &plain, &want));
                TEST_ASSERT_EQUAL_HEX64(want, hash);
                check_same_attributes(&m, &back, format == BVX_FORMAT_PLY);
                bvx_mesh_free(ctx, &back);
                bvx_mesh_free(ctx, &plain);
                bvx_buffer_free(ctx, &b);
            }
}

/* The numbers in the file, whatever the size of the coordinates is. */
static void test_write_normals_are_those_of_mesh_normals(void)
{
    static const double sizes[] = {1e-200, 1e-3, 1, 1e30, 1e200};
    static float want[VERTICES * 3];
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++) {
        uint64_t state = 4;
        bvx_mesh m = random_mesh(BVX_F64, 0, 1);
        bvx_mesh_view view;
        for (int i = 0; i < VERTICES * 3; i++)
            xyz64[i] = ((double)(next_random(&state) >> 40) - 8e6) * 1e-7 * sizes[s];
        bvx_mesh_view_of(&m, &view);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_normals(ctx, &view, 0, want, NULL));
        bvx_buffer b = write_normals(&m, BVX_FORMAT_PLY);
        const uint8_t *const at = b.bytes + b.size - 500 * 13 - VERTICES * 36;
        for (size_t v = 0; v < VERTICES; v++)
            for (size_t a = 0; a < 3; a++) {
                uint8_t bytes[4];
                put_f32(bytes, want[3 * v + a], 0);
                TEST_ASSERT_EQUAL_MEMORY(bytes, at + 36 * v + 24 + 4 * a, 4);
            }
        bvx_buffer_free(ctx, &b);

        /* the same floats as text */
        b = write_normals(&m, BVX_FORMAT_OBJ);
        char *const text = calloc((size_t)b.size + 1, 1);
        memcpy(text, b.bytes, (size_t)b.size);
        const char *p = text;
        for (size_t v = 0; v < VERTICES; v++) {
            char *next;
            p = strstr(p, "\nvn ");
            TEST_ASSERT_NOT_NULL(p);
            p += 4;
            for (size_t a = 0; a < 3; a++, p = next) TEST_ASSERT_TRUE(strtof(p, &next) == want[3 * v + a]);
        }
        TEST_ASSERT_NULL(strstr(p, "\nvn "));
        free(text);
        bvx_buffer_free(ctx, &b);
    }
}

static void test_write_normals_workers(void)
{
    bvx_mesh m = make_strip(9999);
    bvx_context *const plain = ctx;

    for (int32_t format = BVX_FORMAT_OBJ; format <= BVX_FORMAT_PLY; format++) {
        bvx_buffer one = write_normals(&m, format);
        bvx_context_options o = {.struct_size = sizeof o};
        o.threads = 3;
        o.parallel.call = run_backwards;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
        bvx_buffer other = write_normals(&m, format);
        TEST_ASSERT_EQUAL_UINT64(one.size, other.size);
        TEST_ASSERT_EQUAL_MEMORY(one.bytes, other.bytes, (size_t)one.size);
        bvx_buffer_free(ctx, &other);
        bvx_context_destroy(ctx);
        ctx = plain;
        bvx_buffer_free(ctx, &one);
    }
    free_strip(&m);
}

/* NULL options, and options as they are filled, are no other file; GLB has its normals always. */
static void test_write_normals_change_no_other_file(void)
{
    bvx_mesh const m = square();
    bvx_write_options o = {.struct_size = sizeof o};

    for (int32_t format = BVX_FORMAT_STL; format <= BVX_FORMAT_GLB; format++) {
        if (bvx_format_of_name("a.npy") == format || bvx_format_of_name("a.png") == format) continue;
        bvx_buffer const plain = write_file(&m, format);
        for (int way = 0; way < 3; way++) {
            bvx_buffer b = {0};
            o.normals = way == 2;
            if (way == 2 && format != BVX_FORMAT_GLB) continue;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, way == 0 ? NULL : &o, format, &b));
            TEST_ASSERT_EQUAL_UINT64(plain.size, b.size);
            TEST_ASSERT_EQUAL_MEMORY(plain.bytes, b.bytes, (size_t)b.size);
            bvx_buffer_free(ctx, &b);
        }
        bvx_buffer_free(ctx, (bvx_buffer *)&plain);
    }
}

static void check_not_written_with(const bvx_mesh *m, const bvx_write_options *o, int32_t format,
                                   bvx_status status, const char *words)
{
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(status, bvx_write_mesh(ctx, m, 1, o, format, &b), words);
    TEST_ASSERT_TRUE(b.bytes == NULL && b.size == 0 && b.capacity == 0);
    if (strstr(bvx_last_message(ctx), words) == NULL) TEST_ASSERT_EQUAL_STRING(words, bvx_last_message(ctx));
}

static void test_write_normals_refuses(void)
{
    bvx_mesh m = square();
    bvx_write_options o = {.struct_size = sizeof o};
    uint8_t byte = 0;
    bvx_buffer none = {0}, full = {&byte, 1, 0};
    struct {
        bvx_write_options known;
        int64_t later;
    } newer;

    o.normals = 1;
    check_not_written_with(&m, &o, BVX_FORMAT_STL, BVX_ERR_UNSUPPORTED,
                           "bvx_write_mesh: STL holds normals of triangles only");
    check_not_written_with(&m, &o, BVX_FORMAT_OFF, BVX_ERR_UNSUPPORTED,
                           "bvx_write_mesh: OFF is written without normals");
    check_not_written_with(&m, &o, BVX_FORMAT_NPY, BVX_ERR_UNSUPPORTED, "format 4 holds no mesh");
    check_not_written_with(NULL, &o, BVX_FORMAT_PLY, BVX_ERR_ARGUMENT, "levels is NULL");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(ctx, &m, 1, &o, BVX_FORMAT_PLY, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(NULL, &m, 1, &o, BVX_FORMAT_PLY, &none));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(ctx, &m, 1, &o, BVX_FORMAT_PLY, &full));

    o.normals = 2;
    check_not_written_with(&m, &o, BVX_FORMAT_PLY, BVX_ERR_ARGUMENT, "normals is 2");
    o.normals = 1;
    o.rounding = 3;
    check_not_written_with(&m, &o, BVX_FORMAT_PLY, BVX_ERR_ARGUMENT, "rounding 3 is unknown");
    o.rounding = 0;
    o.struct_size = 3;
    check_not_written_with(&m, &o, BVX_FORMAT_PLY, BVX_ERR_ARGUMENT, "struct_size of the options is 3");
    memset(&newer, 0, sizeof newer);
    newer.known.struct_size = sizeof newer;
    newer.later = 1;
    check_not_written_with(&m, &newer.known, BVX_FORMAT_PLY, BVX_ERR_VERSION, "does not know");

    m.triangle_count = 0;
    o = (bvx_write_options){.struct_size = sizeof o};
    check_not_written_with(&m, &o, BVX_FORMAT_PLY, BVX_ERR_EMPTY, "bvx_write_mesh");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_write_normals_obj_bytes);
    RUN_TEST(test_write_normals_ply_bytes);
    RUN_TEST(test_write_normals_keep_the_rest);
    RUN_TEST(test_write_normals_are_those_of_mesh_normals);
    RUN_TEST(test_write_normals_workers);
    RUN_TEST(test_write_normals_change_no_other_file);
    RUN_TEST(test_write_normals_refuses);
    return UNITY_END();
}
