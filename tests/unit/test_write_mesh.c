/* test_write_mesh.c - meshes written and read back. */
#include "comma_locale.h"
#include "read_support.h"

#include <math.h>

enum { VERTICES = 300, TRIANGLES = 500 };

static float xyz32[VERTICES * 3];
static double xyz64[VERTICES * 3];
static uint32_t triangles[TRIANGLES * 3];

/* A mesh over the arrays above, of random bits: every exponent, denormals, -0; double: scaled into floats' range too. */
static bvx_mesh random_mesh(int32_t type, uint64_t seed)
{
    bvx_mesh m = {0};
    uint64_t state = seed;
    for (int i = 0; i < VERTICES * 3; i++) {
        uint64_t const r = next_random(&state);
        uint32_t const bits = (uint32_t)r;
        memcpy(&xyz32[i], &bits, sizeof bits);
        if (!(xyz32[i] - xyz32[i] == 0.0f)) xyz32[i] = -0.0f;
        memcpy(&xyz64[i], &r, sizeof r);
        if (!(xyz64[i] - xyz64[i] == 0.0)) xyz64[i] = -0.0;
    }
    for (int i = 0; i < TRIANGLES * 3; i++) triangles[i] = (uint32_t)(next_random(&state) % VERTICES);
    m.positions = type == BVX_F32 ? (void *)xyz32 : (void *)xyz64;
    m.triangles = triangles;
    m.vertex_count = m.vertex_capacity = VERTICES;
    m.triangle_count = m.triangle_capacity = TRIANGLES;
    m.position_type = type;
    return m;
}

static bvx_buffer write_file(const bvx_mesh *m, int32_t format)
{
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_mesh(ctx, m, format, &b), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(b.size, b.capacity);
    return b;
}

/* Write, free the buffer, read what was written. */
static bvx_mesh write_and_read(const bvx_mesh *m, int32_t format)
{
    bvx_mesh back;
    bvx_buffer b = write_file(m, format);
    uint8_t *const bytes = malloc((size_t)b.size);
    size_t const size = (size_t)b.size;
    memcpy(bytes, b.bytes, size);
    bvx_buffer_free(ctx, &b);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(bytes, size, format, &back), bvx_last_message(ctx));
    free(bytes);
    return back;
}

static void test_write_ply_reads_back(void)
{
    for (uint64_t seed = 1; seed < 20; seed++)
        for (int32_t type = BVX_F32; type <= BVX_F64; type++) {
            bvx_mesh const m = random_mesh(type, seed);
            bvx_mesh back = write_and_read(&m, BVX_FORMAT_PLY);
            TEST_ASSERT_EQUAL_INT32(type, back.position_type);
            TEST_ASSERT_EQUAL_UINT64(VERTICES, back.vertex_count);
            TEST_ASSERT_EQUAL_UINT64(TRIANGLES, back.triangle_count);
            TEST_ASSERT_EQUAL_MEMORY(m.positions, back.positions, VERTICES * 3 * (type == BVX_F32 ? 4 : 8));
            TEST_ASSERT_EQUAL_MEMORY(triangles, back.triangles, sizeof triangles);
            bvx_mesh_free(ctx, &back);
        }
}

static void test_write_obj_reads_back(void)
{
    for (uint64_t seed = 1; seed < 20; seed++)
        for (int32_t type = BVX_F32; type <= BVX_F64; type++) {
            bvx_mesh const m = random_mesh(type, seed);
            bvx_mesh back = write_and_read(&m, BVX_FORMAT_OBJ);
            TEST_ASSERT_EQUAL_UINT64(VERTICES, back.vertex_count);
            TEST_ASSERT_EQUAL_MEMORY(triangles, back.triangles, sizeof triangles);
            const double *const p = back.positions;
            for (int i = 0; i < VERTICES * 3; i++) {
                float const f = (float)p[i];
                if (type == BVX_F32) TEST_ASSERT_EQUAL_MEMORY(&xyz32[i], &f, sizeof f);
                else TEST_ASSERT_EQUAL_MEMORY(&xyz64[i], &p[i], sizeof p[i]);
            }
            bvx_mesh_free(ctx, &back);
        }
}

static void test_write_stl_reads_back(void)
{
    for (uint64_t seed = 1; seed < 20; seed++) {
        bvx_mesh m = random_mesh(BVX_F32, seed);
        bvx_mesh back = write_and_read(&m, BVX_FORMAT_STL);
        TEST_ASSERT_EQUAL_UINT64(TRIANGLES, back.triangle_count);
        for (uint64_t t = 0; t < TRIANGLES; t++)
            for (int k = 0; k < 3; k++) {
                double p[3], q[3];
                corner_of(&m, t, k, p);
                corner_of(&back, t, k, q);
                TEST_ASSERT_TRUE(p[0] == q[0] && p[1] == q[1] && p[2] == q[2]);
            }
        /* written once more it is the same mesh again: vertices are in the order of their first use */
        bvx_mesh again = {0};
        bvx_buffer b = write_file(&back, BVX_FORMAT_STL);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_mesh(ctx, b.bytes, b.size, BVX_FORMAT_STL, &again));
        TEST_ASSERT_EQUAL_UINT64(back.vertex_count, again.vertex_count);
        TEST_ASSERT_EQUAL_MEMORY(back.positions, again.positions, (size_t)back.vertex_count * 12);
        TEST_ASSERT_EQUAL_MEMORY(back.triangles, again.triangles, sizeof triangles);
        bvx_mesh_free(ctx, &again);
        bvx_buffer_free(ctx, &b);
        bvx_mesh_free(ctx, &back);
    }
}

/* ---- bytes ---- */

static float const square_xyz[12] = {0, 0, 0, 2, 0, 0, 2, 0.1f, 0, 0, 0.1f, -0.0f};
static uint32_t square_triangles[6] = {0, 1, 2, 2, 3, 0};

static bvx_mesh square(void)
{
    static float copy[12];
    bvx_mesh m = {0};
    memcpy(copy, square_xyz, sizeof copy);
    m.positions = copy;
    m.triangles = square_triangles;
    m.vertex_count = m.vertex_capacity = 4;
    m.triangle_count = m.triangle_capacity = 2;
    m.position_type = BVX_F32;
    return m;
}

static void test_write_obj_bytes(void)
{
    static const char want[] = "# OBJ written by bitvox\nv 0 0 0\nv 2 0 0\nv 2 0.1 0\nv 0 0.1 -0\nf 1 2 3\nf 3 4 1\n";
    bvx_mesh const m = square();
    bvx_buffer b = write_file(&m, BVX_FORMAT_OBJ);
    TEST_ASSERT_EQUAL_UINT64(strlen(want), b.size);
    TEST_ASSERT_EQUAL_MEMORY(want, b.bytes, strlen(want));
    bvx_buffer_free(ctx, &b);
}

static void test_write_ply_bytes(void)
{
    static const char header[] = "ply\nformat binary_little_endian 1.0\ncomment written by bitvox\nelement vertex 4\n"
                                 "property float x\nproperty float y\nproperty float z\nelement face 2\n"
                                 "property list uchar int vertex_indices\nend_header\n";
    static const uint8_t faces[26] = {3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 2, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0};
    bvx_mesh const m = square();
    bvx_buffer b = write_file(&m, BVX_FORMAT_PLY);
    size_t const n = strlen(header);
    TEST_ASSERT_EQUAL_UINT64(n + 48 + 26, b.size);
    TEST_ASSERT_EQUAL_MEMORY(header, b.bytes, n);
    for (int i = 0; i < 12; i++) {
        uint8_t bytes[4];
        put_f32(bytes, square_xyz[i], 0);
        TEST_ASSERT_EQUAL_MEMORY(bytes, b.bytes + n + 4 * (size_t)i, 4);
    }
    TEST_ASSERT_EQUAL_MEMORY(faces, b.bytes + n + 48, 26);
    bvx_buffer_free(ctx, &b);
}

static void test_write_stl_bytes(void)
{
    bvx_mesh m = square();
    bvx_buffer b = write_file(&m, BVX_FORMAT_STL);
    uint8_t want[50] = {0};
    TEST_ASSERT_EQUAL_UINT64(84 + 100, b.size);
    TEST_ASSERT_TRUE(memcmp(b.bytes, "solid", 5) != 0);
    TEST_ASSERT_EQUAL_UINT8(2, b.bytes[80]);
    put_f32(want + 8, 1, 0); /* the normal is +z */
    put_f32(want + 24, 2, 0);
    put_f32(want + 36, 2, 0);
    put_f32(want + 40, 0.1f, 0);
    TEST_ASSERT_EQUAL_MEMORY(want, b.bytes + 84, 50);
    bvx_buffer_free(ctx, &b);
    m.triangle_count = 1;
    m.triangles = (uint32_t[3]){0, 1, 1}; /* no area: a normal of zeros, and no NaN */
    b = write_file(&m, BVX_FORMAT_STL);
    memset(want, 0, 12);
    TEST_ASSERT_EQUAL_MEMORY(want, b.bytes + 84, 12);
    bvx_buffer_free(ctx, &b);
}

static void test_write_stl_normals_are_unit(void)
{
    bvx_mesh const m = random_mesh(BVX_F32, 7); /* sizes from 1e-45 to 1e38 */
    bvx_buffer b = write_file(&m, BVX_FORMAT_STL);
    for (int t = 0; t < TRIANGLES; t++) {
        double n[3], length;
        for (int a = 0; a < 3; a++) {
            uint8_t const *const p = b.bytes + 84 + 50 * t + 4 * a;
            uint32_t const bits = (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
            float f;
            memcpy(&f, &bits, sizeof f);
            n[a] = (double)f;
        }
        length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        TEST_ASSERT_TRUE(length == 0 || (length > 0.999999 && length < 1.000001));
    }
    bvx_buffer_free(ctx, &b);
}

/* ---- frames ---- */

static void test_write_adds_the_frame(void)
{
    static const int32_t formats[] = {BVX_FORMAT_PLY, BVX_FORMAT_OBJ, BVX_FORMAT_STL};
    bvx_mesh m = square();
    m.frame[0] = 500000.125;
    m.frame[1] = -4649776.0625;
    for (int i = 0; i < 3; i++) {
        bvx_mesh back = write_and_read(&m, formats[i]);
        TEST_ASSERT_EQUAL_INT32(i == 2 ? BVX_F32 : BVX_F64, back.position_type);
        for (uint64_t t = 0; t < 2; t++)
            for (int k = 0; k < 3; k++) {
                double p[3], q[3];
                corner_of(&m, t, k, p);
                corner_of(&back, t, k, q);
                for (int a = 0; a < 3; a++) {
                    double const want = p[a] + m.frame[a];
                    TEST_ASSERT_TRUE(q[a] == (i == 2 ? (double)(float)want : want));
                }
            }
        TEST_ASSERT_TRUE(back.frame[0] == 0 && back.frame[1] == 0 && back.frame[2] == 0);
        bvx_mesh_free(ctx, &back);
    }
}

/* ---- refusals ---- */

static void check_not_written(const bvx_mesh *m, int32_t format, bvx_status status, const char *words)
{
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(status, bvx_write_mesh(ctx, m, format, &b), words);
    TEST_ASSERT_TRUE(b.bytes == NULL && b.size == 0 && b.capacity == 0);
    if (strstr(bvx_last_message(ctx), words) == NULL) TEST_ASSERT_EQUAL_STRING(words, bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
}

static void test_write_refuses(void)
{
    static const int32_t formats[] = {BVX_FORMAT_PLY, BVX_FORMAT_OBJ, BVX_FORMAT_STL};
    for (int i = 0; i < 3; i++) {
        bvx_mesh m = square();
        float *const p = m.positions;
        uint32_t bad[6] = {0, 1, 2, 2, 4, 0};
        m.triangles = bad;
        check_not_written(&m, formats[i], BVX_ERR_RANGE, "triangle 1 has vertex number 4");
        m = square();
        p[7] = HUGE_VALF;
        check_not_written(&m, formats[i], BVX_ERR_RANGE, "vertex 2");
        p[7] = 0;
        m.frame[1] = HUGE_VAL;
        check_not_written(&m, formats[i], BVX_ERR_RANGE, "vertex 0");
        m.frame[1] = 0;
        m.triangle_count = 0;
        check_not_written(&m, formats[i], BVX_ERR_EMPTY, "");
        m.triangle_count = 2;
        m.position_type = 3;
        check_not_written(&m, formats[i], BVX_ERR_ARGUMENT, "position_type");
        m = square();
        m.triangles = NULL;
        check_not_written(&m, formats[i], BVX_ERR_ARGUMENT, "triangles");
        m = square();
        m.positions = NULL;
        check_not_written(&m, formats[i], BVX_ERR_ARGUMENT, "positions");
    }
    bvx_mesh m = square();
    check_not_written(&m, BVX_FORMAT_NPY, BVX_ERR_UNSUPPORTED, "format 4");
    check_not_written(&m, BVX_FORMAT_UNKNOWN, BVX_ERR_UNSUPPORTED, "format 0");
    check_not_written(NULL, BVX_FORMAT_PLY, BVX_ERR_ARGUMENT, "mesh is NULL");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(ctx, &m, BVX_FORMAT_PLY, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(NULL, &m, BVX_FORMAT_PLY, &(bvx_buffer){0}));
    uint8_t byte = 0;
    bvx_buffer full = {&byte, 1, 1};
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(ctx, &m, BVX_FORMAT_PLY, &full));
    TEST_ASSERT_TRUE(full.bytes == &byte && full.size == 1);
}

static void test_write_stl_refuses_what_floats_cannot_hold(void)
{
    double p[9] = {0, 0, 0, 1, 0, 0, 0, 3.4028235677973366e38, 0}; /* the least that rounds to infinity */
    uint32_t t[3] = {0, 1, 2};
    bvx_mesh m = {0};
    m.positions = p;
    m.triangles = t;
    m.vertex_count = 3;
    m.triangle_count = 1;
    m.position_type = BVX_F64;
    check_not_written(&m, BVX_FORMAT_STL, BVX_ERR_RANGE, "vertex 2");
    p[7] = -p[7];
    check_not_written(&m, BVX_FORMAT_STL, BVX_ERR_RANGE, "vertex 2");
    p[7] = 3.4028235677973362e38; /* the greatest that does not */
    bvx_mesh back = write_and_read(&m, BVX_FORMAT_STL);
    TEST_ASSERT_TRUE((double)((float *)back.positions)[7] == 3.4028234663852886e38);
    bvx_mesh_free(ctx, &back);
}

static void test_write_keeps_to_the_limit(void)
{
    static const int32_t formats[] = {BVX_FORMAT_PLY, BVX_FORMAT_OBJ, BVX_FORMAT_STL};
    bvx_mesh const m = square();
    bvx_context *const plain = ctx;
    for (int i = 0; i < 3; i++)
        for (uint64_t limit = 1; limit < 400; limit++) {
            bvx_context_options o;
            bvx_buffer b = {0};
            bvx_context_options_init(&o, sizeof o);
            o.memory_limit = limit;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
            bvx_status const status = bvx_write_mesh(ctx, &m, formats[i], &b);
            TEST_ASSERT_EQUAL_INT32(status == BVX_OK ? BVX_OK : BVX_ERR_BUDGET, status);
            TEST_ASSERT_TRUE(status == BVX_OK ? b.size <= limit : b.bytes == NULL);
            bvx_buffer_free(ctx, &b);
            TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
            bvx_context_destroy(ctx);
            ctx = plain;
        }
}

/* ---- surroundings ---- */

static void test_a_locale_with_comma_changes_no_file(void)
{
    bvx_mesh m = random_mesh(BVX_F64, 3);
    bvx_buffer plain = write_file(&m, BVX_FORMAT_OBJ);
    if (!set_comma_locale()) {
        bvx_buffer_free(ctx, &plain);
        TEST_IGNORE_MESSAGE("no locale with a comma on this machine");
    }
    bvx_buffer other = {0};
    bvx_mesh back = {0};
    bvx_status const written = bvx_write_mesh(ctx, &m, BVX_FORMAT_OBJ, &other);
    bvx_status const read = bvx_read_mesh(ctx, plain.bytes, plain.size, BVX_FORMAT_OBJ, &back);
    setlocale(LC_ALL, "C");
    TEST_ASSERT_EQUAL_INT32(BVX_OK, written);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read);
    TEST_ASSERT_EQUAL_UINT64(plain.size, other.size);
    TEST_ASSERT_EQUAL_MEMORY(plain.bytes, other.bytes, (size_t)plain.size);
    TEST_ASSERT_EQUAL_MEMORY(xyz64, back.positions, sizeof xyz64);
    bvx_buffer_free(ctx, &plain);
    bvx_buffer_free(ctx, &other);
    bvx_mesh_free(ctx, &back);
}

/* In an arena that holds just a few of the files: what is freed is there again. */
static void test_files_live_in_an_arena(void)
{
    static const int32_t formats[] = {BVX_FORMAT_PLY, BVX_FORMAT_OBJ, BVX_FORMAT_STL};
    bvx_context *const plain = ctx;
    bvx_context_options o;
    size_t const size = 200000;
    void *const arena = malloc(size);
    bvx_context_options_init(&o, sizeof o);
    o.arena = arena;
    o.arena_size = size;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
    for (int i = 0; i < 60; i++) {
        bvx_mesh const m = random_mesh(i % 2 == 0 ? BVX_F32 : BVX_F64, (uint64_t)i / 6 + 1);
        if (i % 2 == 1 && formats[i % 3] == BVX_FORMAT_STL) continue; /* beyond floats */
        bvx_buffer b = write_file(&m, formats[i % 3]);
        bvx_mesh back = {0};
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_read_mesh(ctx, b.bytes, b.size, formats[i % 3], &back),
                                        bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_UINT64(TRIANGLES, back.triangle_count);
        TEST_ASSERT_TRUE((uint8_t *)back.positions >= (uint8_t *)arena && (uint8_t *)back.positions < (uint8_t *)arena + size);
        bvx_buffer_free(ctx, &b);
        bvx_mesh_free(ctx, &back);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
    }
    bvx_context_destroy(ctx);
    free(arena);
    ctx = plain;
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_write_ply_reads_back);
    RUN_TEST(test_write_obj_reads_back);
    RUN_TEST(test_write_stl_reads_back);
    RUN_TEST(test_write_obj_bytes);
    RUN_TEST(test_write_ply_bytes);
    RUN_TEST(test_write_stl_bytes);
    RUN_TEST(test_write_stl_normals_are_unit);
    RUN_TEST(test_write_adds_the_frame);
    RUN_TEST(test_write_refuses);
    RUN_TEST(test_write_stl_refuses_what_floats_cannot_hold);
    RUN_TEST(test_write_keeps_to_the_limit);
    RUN_TEST(test_a_locale_with_comma_changes_no_file);
    RUN_TEST(test_files_live_in_an_arena);
    return UNITY_END();
}
