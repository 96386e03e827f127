/* test_finite.c - meshes without triangles that have a corner at infinity or at what is not a number. */
#include "read_support.h"
#include "tools/fault.h"

#include <math.h>

/* A tetrahedron, and two triangles more with a vertex 1 (NaN) and 5 (infinite) between the others. */
static const uint32_t six[18] = {0, 3, 2, 0, 1, 2, 0, 2, 4, 0, 4, 3, 5, 2, 3, 2, 3, 4};
static const uint32_t four[12] = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};

/* Arrays of every kind over them. */
static struct {
    double f64[18];
    float f32[18];
    uint32_t triangles[18], uv_triangles[18];
    uint64_t vertex_keys[6], triangle_keys[6];
    uint8_t colours[24];
    float uvs[12];
} arrays;

static bvx_mesh make(int32_t type, int by_triangles)
{
    static const double at[18] = {0, 0, 0, NAN, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, INFINITY};
    bvx_mesh m = {0};

    for (int i = 0; i < 18; i++) {
        arrays.f64[i] = at[i];
        arrays.f32[i] = (float)at[i];
        arrays.triangles[i] = six[i];
        arrays.uv_triangles[i] = (uint32_t)(i % 6);
    }
    for (int i = 0; i < 6; i++) {
        arrays.vertex_keys[i] = (uint64_t)i;
        arrays.triangle_keys[i] = (uint64_t)i;
        memset(arrays.colours + 4 * i, i, 4);
        arrays.uvs[2 * i] = arrays.uvs[2 * i + 1] = (float)i;
    }
    m.positions = type == BVX_F32 ? (void *)arrays.f32 : (void *)arrays.f64;
    m.position_type = type;
    m.triangles = arrays.triangles;
    m.vertex_keys = arrays.vertex_keys;
    m.triangle_keys = arrays.triangle_keys;
    m.colours = arrays.colours;
    m.uvs = arrays.uvs;
    m.uv_count = 6;
    m.uv_triangles = by_triangles ? arrays.uv_triangles : NULL;
    m.vertex_count = m.vertex_capacity = 6;
    m.triangle_count = m.triangle_capacity = 6;
    return m;
}

static void check_dropped(int32_t type, int by_triangles)
{
    static const uint64_t vertex[4] = {0, 2, 3, 4}, triangle[4] = {0, 2, 3, 5};
    bvx_mesh m = make(type, by_triangles);
    uint64_t dropped = 99;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_drop_nonfinite(ctx, &m, &dropped));
    TEST_ASSERT_EQUAL_UINT64(2, dropped);
    TEST_ASSERT_EQUAL_UINT64(4, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(4, m.triangle_count);
    TEST_ASSERT_EQUAL_UINT64(6, m.vertex_capacity);
    TEST_ASSERT_EQUAL_UINT64(6, m.triangle_capacity);
    TEST_ASSERT_EQUAL_UINT32_ARRAY(four, m.triangles, 12);
    for (int i = 0; i < 4; i++) {
        double const x = type == BVX_F32 ? (double)arrays.f32[3 * i] : arrays.f64[3 * i];
        TEST_ASSERT_TRUE(x == (i == 1 ? 1.0 : 0.0));
        TEST_ASSERT_EQUAL_UINT64(vertex[i], m.vertex_keys[i]);
        TEST_ASSERT_EQUAL_UINT64(triangle[i], m.triangle_keys[i]);
        TEST_ASSERT_EQUAL_UINT8(vertex[i], m.colours[4 * i + 3]);
        if (by_triangles) TEST_ASSERT_EQUAL_UINT32(triangle[i] * 3 % 6, m.uv_triangles[3 * i]);
        TEST_ASSERT_TRUE(m.uvs[2 * i] == (float)(by_triangles ? (uint64_t)i : vertex[i]));
    }
}

static void test_drop_nonfinite_moves_all_that_belongs_to_vertices_and_triangles(void)
{
    check_dropped(BVX_F32, 0);
    check_dropped(BVX_F32, 1);
    check_dropped(BVX_F64, 0);
    check_dropped(BVX_F64, 1);
}

static void test_drop_nonfinite_leaves_what_is_finite(void)
{
    bvx_mesh m = make(BVX_F64, 1), empty = {0};
    uint64_t before, after, dropped = 99;
    arrays.f64[3] = arrays.f64[17] = 7.0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &m, &before));
    bvx_memory_reset_peak(ctx);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_drop_nonfinite(ctx, &m, &dropped));
    TEST_ASSERT_EQUAL_UINT64(0, dropped);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &m, &after));
    TEST_ASSERT_EQUAL_UINT64(before, after);
    dropped = 99;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_drop_nonfinite(ctx, &empty, &dropped));
    TEST_ASSERT_EQUAL_UINT64(0, dropped);

    /* A vertex that no triangle uses goes too, and all triangles may. */
    m = make(BVX_F64, 0);
    m.triangle_count = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_drop_nonfinite(ctx, &m, &dropped));
    TEST_ASSERT_EQUAL_UINT64(0, dropped);
    TEST_ASSERT_EQUAL_UINT64(4, m.vertex_count);
    m = make(BVX_F64, 0);
    for (int i = 0; i < 18; i++) arrays.f64[i] = -INFINITY;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_drop_nonfinite(ctx, &m, &dropped));
    TEST_ASSERT_EQUAL_UINT64(6, dropped);
    TEST_ASSERT_EQUAL_UINT64(0, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(0, m.triangle_count);
}

static void check_not_dropped(bvx_mesh *m, bvx_status status, const char *words)
{
    bvx_mesh const before = *m;
    uint64_t dropped;
    TEST_ASSERT_EQUAL_INT32(status, bvx_mesh_drop_nonfinite(ctx, m, &dropped));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), words), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_MEMORY(&before, m, sizeof before);
    TEST_ASSERT_EQUAL_UINT32(2, arrays.triangles[5]);
}

static void test_drop_nonfinite_refuses(void)
{
    bvx_mesh m = make(BVX_F64, 1);
    uint64_t dropped;

    arrays.triangles[16] = 6;
    check_not_dropped(&m, BVX_ERR_RANGE, "triangle 5 has vertex index 6");
    m = make(BVX_F64, 1);
    m.position_type = 3;
    check_not_dropped(&m, BVX_ERR_ARGUMENT, "position_type is 3");
    m = make(BVX_F64, 1);
    m.triangles = NULL;
    check_not_dropped(&m, BVX_ERR_ARGUMENT, "mesh.triangles is NULL");
    m = make(BVX_F64, 1);
    m.positions = NULL;
    check_not_dropped(&m, BVX_ERR_ARGUMENT, "mesh.positions is NULL");
    m = make(BVX_F64, 1);
    m.reserved[1] = 1;
    check_not_dropped(&m, BVX_ERR_ARGUMENT, "mesh.reserved[1]");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_drop_nonfinite(NULL, &m, &dropped));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_drop_nonfinite(ctx, NULL, &dropped));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_drop_nonfinite(ctx, &m, NULL));
}

/* ---- files ---- */

static bvx_status read_finite_of(bvx_context *context, const void *bytes, size_t size, int32_t format,
                                 uint64_t *dropped, bvx_mesh *m)
{
    bvx_read_report report = {0};
    bvx_read_options o = {.struct_size = sizeof o};
    bvx_status status;

    o.drop_nonfinite = 1;
    o.report = &report;
    status = bvx_read_mesh(context, bytes, size, format, &o, m);
    if (status == BVX_OK) *dropped = report.dropped;
    return status;
}

/* Four triangles remain of a file with as many bad ones, and bvx_read_mesh refuses it with these words. */
static void check_read(const void *bytes, size_t size, int32_t format, uint64_t bad, const char *words)
{
    bvx_mesh m = {0};
    uint64_t dropped = 99;
    bvx_status const status = read_finite_of(ctx, bytes, size, format, &dropped, &m);

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(bad, dropped);
    TEST_ASSERT_EQUAL_UINT64(4, m.triangle_count);
    TEST_ASSERT_EQUAL_UINT64(4, m.vertex_count);
    for (uint64_t i = 0; i < 12; i++) TEST_ASSERT_TRUE(m.triangles[i] < 4);
    for (uint64_t i = 0; i < 12; i++) {
        double const v = m.position_type == BVX_F32 ? (double)((float *)m.positions)[i]
                                                    : ((double *)m.positions)[i];
        TEST_ASSERT_TRUE(v == 0.0 || v == 1.0);
    }
    bvx_mesh_free(ctx, &m);
    check_refused(bytes, size, format, BVX_ERR_RANGE, words);
}

static void check_read_text(const char *text, int32_t format, uint64_t bad, const char *words)
{
    check_read(text, strlen(text), format, bad, words);
}

static void test_read_finite_of_text(void)
{
    check_read_text(
        "v 0 0 0\nv nan 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 1e999\nf 1 4 3\nf 1 2 3\nf 1 3 5\nf 1 5 4\nf 6 3 4\nf 3 4 5\n",
        BVX_FORMAT_OBJ, 2, "vertex 2 has a coordinate that is not finite");
    check_read_text(
        "OFF\n6 6 0\n0 0 0\n0 -inf 0\n1 0 0\n0 1 0\n0 0 1\n0 nan 1\n3 0 3 2\n3 0 1 2\n3 0 2 4\n3 0 4 3\n3 5 2 3\n3 2 3 4\n",
        BVX_FORMAT_OFF, 2, "vertex 1 has a coordinate that is not finite");
    check_read_text(
        "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\nelement face 5\n"
        "property list uchar int vertex_index\nend_header\n0 0 0\n0 0 inf\n1 0 0\n0 1 0\n0 0 1\n"
        "3 0 3 2\n3 0 1 2\n3 0 2 4\n3 0 4 3\n3 2 3 4\n",
        BVX_FORMAT_PLY, 1, "vertex 1 ");

    /* A polygon with a corner nowhere has no plane: all of it goes. */
    check_read_text(
        "OFF\n5 5 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\nnan 1 1\n4 1 4 2 0\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n",
        BVX_FORMAT_OFF, 2, "vertex 4 has a coordinate that is not finite");
}

/* Binary files: the same triangles, their first one again with NaN in place of its first coordinate. */
/* Four bytes of a value, the lowest first, as both files have them. */
static void put_little(void *to, const void *value)
{
    unsigned char *const bytes = to;
    uint32_t word;

    memcpy(&word, value, 4);
    for (int i = 0; i < 4; i++) bytes[i] = (unsigned char)(word >> 8 * i);
}

static void test_read_finite_of_binary(void)
{
    static const float corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    unsigned char stl[84 + 5 * 50] = {0};
    char ply[400];
    size_t n;
    float const bad = NAN;
    stl[80] = 5;
    for (int t = 0; t < 5; t++)
        for (int k = 0; k < 9; k++)
            put_little(stl + 84 + t * 50 + 12 + k * 4, &corner[four[t % 4 * 3 + k / 3]][k % 3]);
    put_little(stl + 84 + 4 * 50 + 12, &bad);
    check_read(stl, sizeof stl, BVX_FORMAT_STL, 1, "triangle 4, corner 0");

    n = (size_t)snprintf(
        ply, sizeof ply,
        "ply\nformat binary_little_endian 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
        "property float z\nelement face 5\nproperty list uchar int vertex_index\nend_header\n");
    for (int i = 0; i < 12; i++, n += 4) put_little(ply + n, &corner[i / 3][i % 3]);
    for (int a = 0; a < 3; a++, n += 4) put_little(ply + n, &bad);
    for (int t = 0; t < 5; t++) {
        int32_t number[3] = {t < 4 ? (int32_t)four[t * 3] : 4, (int32_t)four[t % 4 * 3 + 1],
                             (int32_t)four[t % 4 * 3 + 2]};
        ply[n++] = 3;
        for (int k = 0; k < 3; k++, n += 4) put_little(ply + n, &number[k]);
    }
    check_read(ply, n, BVX_FORMAT_PLY, 1, "vertex 4 ");
}

static void test_read_finite_refuses(void)
{
    static const char none[] = "v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    static const char good[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
    static const char colour[] = "v 0 0 0 nan 0 0\nv 1 0 0 0 0 0\nv 0 1 0 0 0 0\nf 1 2 3\n";
    static const bvx_mesh empty = {0};
    bvx_mesh m = {0};
    uint64_t dropped = 99;

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY,
                            read_finite_of(ctx, none, sizeof none - 1, BVX_FORMAT_OBJ, &dropped, &m));
    TEST_ASSERT_NOT_NULL(
        strstr(bvx_last_message(ctx), "each of the 1 triangles has a corner that is not finite"));
    TEST_ASSERT_EQUAL_UINT64(99, dropped);
    TEST_ASSERT_EQUAL_MEMORY(&empty, &m, sizeof m);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE,
                            read_finite_of(ctx, colour, sizeof colour - 1, BVX_FORMAT_OBJ, &dropped, &m));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "colour that is not finite"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_read_mesh(ctx, NULL, sizeof good - 1, BVX_FORMAT_OBJ, NULL, &m));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            read_finite_of(NULL, good, sizeof good - 1, BVX_FORMAT_OBJ, &dropped, &m));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_finite_of(ctx, good, sizeof good - 1, BVX_FORMAT_OBJ, &dropped, &m));
    TEST_ASSERT_EQUAL_UINT64(0, dropped);
    bvx_mesh_free(ctx, &m);
}

/* Whichever allocation fails, nothing is left and the mesh is whole. */
static bvx_status drop_with(void *user, bvx_context *context)
{
    static const char text[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nf 1 2 3\nf 1 2 4\n";
    bvx_mesh m = {0};
    uint64_t dropped = 0;
    bvx_status const status = read_finite_of(context, text, sizeof text - 1, BVX_FORMAT_OBJ, &dropped, &m);

    (void)user;
    if (status == BVX_OK) TEST_ASSERT_EQUAL_UINT64(1, dropped);
    else TEST_ASSERT_NULL(m.positions);
    bvx_mesh_free(context, &m);
    return status;
}

static void test_drop_nonfinite_without_memory(void)
{
    uint64_t allocations = 0;
    TEST_ASSERT_NULL(fault_every_allocation(drop_with, NULL, NULL, &allocations));
    TEST_ASSERT_TRUE(allocations > 3);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_drop_nonfinite_moves_all_that_belongs_to_vertices_and_triangles);
    RUN_TEST(test_drop_nonfinite_leaves_what_is_finite);
    RUN_TEST(test_drop_nonfinite_refuses);
    RUN_TEST(test_read_finite_of_text);
    RUN_TEST(test_read_finite_of_binary);
    RUN_TEST(test_read_finite_refuses);
    RUN_TEST(test_drop_nonfinite_without_memory);
    return UNITY_END();
}
