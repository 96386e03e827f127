/* test_write_mesh.c - meshes written and read back. */
#include "comma_locale.h"
#include "write_support.h"

#include <math.h>

static void test_write_ply_reads_back(void)
{
    for (uint64_t seed = 1; seed < 20; seed++)
        for (int32_t type = BVX_F32; type <= BVX_F64; type++) {
            bvx_mesh const m = random_mesh(type, 0, seed);
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
            bvx_mesh const m = random_mesh(type, 0, seed);
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
        bvx_mesh m = random_mesh(BVX_F32, 0, seed);
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
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_mesh(ctx, b.bytes, b.size, BVX_FORMAT_STL, NULL, &again));
        TEST_ASSERT_EQUAL_UINT64(back.vertex_count, again.vertex_count);
        TEST_ASSERT_EQUAL_MEMORY(back.positions, again.positions, (size_t)back.vertex_count * 12);
        TEST_ASSERT_EQUAL_MEMORY(back.triangles, again.triangles, sizeof triangles);
        bvx_mesh_free(ctx, &again);
        bvx_buffer_free(ctx, &b);
        bvx_mesh_free(ctx, &back);
    }
}

/* Colours and texture coordinates come back from the formats that keep them. */
static void check_attributes_read_back(int32_t format, int alpha)
{
    for (uint64_t seed = 1; seed < 6; seed++)
        for (int with = 0; with < 8; with++)
            for (int32_t type = BVX_F32; type <= BVX_F64; type++) {
                bvx_mesh const m = random_mesh(type, with, seed);
                bvx_mesh back = write_and_read(&m, format);
                TEST_ASSERT_EQUAL_UINT64(VERTICES, back.vertex_count);
                TEST_ASSERT_EQUAL_MEMORY(triangles, back.triangles, sizeof triangles);
                for (uint64_t t = 0; t < TRIANGLES; t++)
                    for (int k = 0; k < 3; k++) {
                        double p[3], q[3];
                        corner_of(&m, t, k, p);
                        corner_of(&back, t, k, q);
                        for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(p[a] == as_written(&m, q[a]));
                    }
                check_same_attributes(&m, &back, alpha);
                bvx_mesh_free(ctx, &back);
            }
}

static void test_write_ply_attributes_read_back(void)
{
    check_attributes_read_back(BVX_FORMAT_PLY, 1);
}
static void test_write_obj_attributes_read_back(void)
{
    check_attributes_read_back(BVX_FORMAT_OBJ, 0);
}

/* Every value of a colour is a fraction that gives it back, whether a program rounds or cuts off. */
static void test_write_obj_colours_are_exact(void)
{
    static float p[256 * 3];
    static uint8_t c[256 * 4];
    uint32_t t[3] = {0, 1, 2};
    bvx_mesh m = {0};
    char *text, *line;

    for (int i = 0; i < 256; i++) memset(c + 4 * i, i, 4);
    m.positions = p;
    m.triangles = t;
    m.vertex_count = 256;
    m.triangle_count = 1;
    m.position_type = BVX_F32;
    m.colours = c;
    bvx_buffer b = write_file(&m, BVX_FORMAT_OBJ);
    text = calloc((size_t)b.size + 1, 1);
    memcpy(text, b.bytes, (size_t)b.size);
    bvx_buffer_free(ctx, &b);
    line = strstr(text, "v 0 0 0 ");
    for (int i = 0; i < 256; i++, line = strchr(line, '\n') + 1) {
        double r[3];
        int used = 0;
        TEST_ASSERT_EQUAL_INT(3, sscanf(line, "v 0 0 0 %lf %lf %lf%n", &r[0], &r[1], &r[2], &used));
        TEST_ASSERT_EQUAL_INT('\n', line[used]);
        TEST_ASSERT_TRUE(used <= 7 + 3 * 6);
        for (int k = 0; k < 3; k++) {
            TEST_ASSERT_EQUAL_INT(i, (int)(r[k] * 255));
            TEST_ASSERT_EQUAL_INT(i, (int)(r[k] * 255 + 0.5));
            TEST_ASSERT_EQUAL_INT(i, (int)((float)r[k] * 255.0f));
        }
    }
    TEST_ASSERT_EQUAL_STRING("f 1 2 3\n", line);
    free(text);
}

static void test_write_stl_leaves_attributes_out(void)
{
    bvx_mesh m = random_mesh(BVX_F32, WITH_COLOURS | WITH_CORNER_UVS, 3);
    bvx_buffer with = write_file(&m, BVX_FORMAT_STL);

    m = random_mesh(BVX_F32, 0, 3);
    bvx_buffer without = write_file(&m, BVX_FORMAT_STL);
    TEST_ASSERT_EQUAL_UINT64(without.size, with.size);
    TEST_ASSERT_EQUAL_MEMORY(without.bytes, with.bytes, (size_t)with.size);
    bvx_buffer_free(ctx, &with);
    bvx_buffer_free(ctx, &without);
}

static void test_workers_change_no_file(void)
{
    static const int32_t formats[] = {BVX_FORMAT_PLY, BVX_FORMAT_OBJ, BVX_FORMAT_STL, BVX_FORMAT_OFF,
                                      BVX_FORMAT_GLB};
    bvx_mesh m = make_strip(12345);

    for (int i = 0; i < 5; i++) check_workers_change_nothing(&m, formats[i]);
    for (int i = 0; i < 2; i++) { /* nothing lost where pieces meet */
        bvx_mesh back = write_and_read(&m, formats[i]);
        TEST_ASSERT_EQUAL_UINT64(m.vertex_count, back.vertex_count);
        TEST_ASSERT_EQUAL_UINT64(m.triangle_count, back.triangle_count);
        TEST_ASSERT_EQUAL_MEMORY(m.triangles, back.triangles, (size_t)m.triangle_count * 12);
        for (size_t k = 0; k < m.vertex_count * 3; k++) {
            double const v = back.position_type == BVX_F32 ? (double)((float *)back.positions)[k]
                                                           : ((double *)back.positions)[k];
            TEST_ASSERT_TRUE((double)((float *)m.positions)[k] == as_written(&m, v));
        }
        bvx_mesh_free(ctx, &back);
    }
    free_strip(&m);
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
    static const char want[] =
        "# OBJ written by bitvox\nv 0 0 0\nv 2 0 0\nv 2 0.1 0\nv 0 0.1 -0\nf 1 2 3\nf 3 4 1\n";
    bvx_mesh const m = square();
    bvx_buffer b = write_file(&m, BVX_FORMAT_OBJ);
    TEST_ASSERT_EQUAL_UINT64(strlen(want), b.size);
    TEST_ASSERT_EQUAL_MEMORY(want, b.bytes, strlen(want));
    bvx_buffer_free(ctx, &b);
}

static void test_write_ply_bytes(void)
{
    static const char header[] =
        "ply\nformat binary_little_endian 1.0\ncomment written by bitvox\nelement vertex 4\n"
        "property float x\nproperty float y\nproperty float z\nelement face 2\n"
        "property list uchar int vertex_indices\nend_header\n";
    static const uint8_t faces[26] = {3, 0, 0, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0,
                                      3, 2, 0, 0, 0, 3, 0, 0, 0, 0, 0, 0, 0};
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

static uint8_t square_colours[16] = {255, 0, 1, 255, 128, 51, 254, 7, 0, 0, 0, 0, 2, 200, 100, 50};
static float square_uvs[10] = {0, 0, 1, 0, 1, 0.5f, 0, 1, -3, 1e-7f};
static uint32_t square_uv_triangles[6] = {0, 1, 2, 2, 3, 4};

static void check_text(const bvx_mesh *m, int32_t format, const char *want)
{
    bvx_buffer b = write_file(m, format);
    TEST_ASSERT_EQUAL_UINT64(strlen(want), b.size);
    TEST_ASSERT_EQUAL_MEMORY(want, b.bytes, strlen(want));
    bvx_buffer_free(ctx, &b);
}

static void test_write_obj_bytes_of_attributes(void)
{
    bvx_mesh m = square();

    m.uvs = square_uvs;
    m.uv_count = 5;
    check_text(&m, BVX_FORMAT_OBJ,
               "# OBJ written by bitvox\nv 0 0 0\nv 2 0 0\nv 2 0.1 0\nv 0 0.1 -0\nvt 0 0\nvt 1 0\n"
               "vt 1 0.5\nvt 0 1\nf 1/1 2/2 3/3\nf 3/3 4/4 1/1\n");
    m.uv_triangles = square_uv_triangles;
    m.colours = square_colours;
    check_text(&m, BVX_FORMAT_OBJ,
               "# OBJ written by bitvox\nv 0 0 0 1 0 0.004\nv 2 0 0 0.502 0.2 0.997\nv 2 0.1 0 0 0 0\n"
               "v 0 0.1 -0 0.008 0.785 0.393\nvt 0 0\nvt 1 0\nvt 1 0.5\nvt 0 1\nvt -3 1e-7\n"
               "f 1/1 2/2 3/3\nf 3/3 4/4 1/5\n");
}

static void test_write_ply_bytes_of_attributes(void)
{
    static const char vertex_uvs[] =
        "ply\nformat binary_little_endian 1.0\ncomment written by bitvox\nelement vertex 4\n"
        "property float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty uchar alpha\n"
        "property float s\nproperty float t\nelement face 2\n"
        "property list uchar int vertex_indices\nend_header\n";
    static const char corner_uvs[] =
        "ply\nformat binary_little_endian 1.0\ncomment written by bitvox\nelement vertex 4\n"
        "property float x\nproperty float y\nproperty float z\nelement face 2\n"
        "property list uchar int vertex_indices\nproperty list uchar float texcoord\nend_header\n";
    uint8_t want[4];
    bvx_mesh m = square();

    m.colours = square_colours;
    m.uvs = square_uvs;
    m.uv_count = 5;
    bvx_buffer b = write_file(&m, BVX_FORMAT_PLY);
    size_t n = strlen(vertex_uvs);
    TEST_ASSERT_EQUAL_UINT64(n + 4 * 24 + 26, b.size);
    TEST_ASSERT_EQUAL_MEMORY(vertex_uvs, b.bytes, n);
    for (size_t v = 0; v < 4; v++) {
        TEST_ASSERT_EQUAL_MEMORY(square_colours + 4 * v, b.bytes + n + 24 * v + 12, 4);
        for (size_t a = 0; a < 2; a++) {
            put_f32(want, square_uvs[2 * v + a], 0);
            TEST_ASSERT_EQUAL_MEMORY(want, b.bytes + n + 24 * v + 16 + 4 * a, 4);
        }
    }
    bvx_buffer_free(ctx, &b);
    m.colours = NULL;
    m.uv_triangles = square_uv_triangles;
    b = write_file(&m, BVX_FORMAT_PLY);
    n = strlen(corner_uvs);
    TEST_ASSERT_EQUAL_UINT64(n + 48 + 2 * 38, b.size);
    TEST_ASSERT_EQUAL_MEMORY(corner_uvs, b.bytes, n);
    for (size_t t = 0; t < 2; t++) {
        const uint8_t *const face = b.bytes + n + 48 + 38 * t;
        TEST_ASSERT_EQUAL_UINT8(3, face[0]);
        TEST_ASSERT_EQUAL_UINT8(6, face[13]);
        for (size_t i = 0; i < 6; i++) {
            put_f32(want, square_uvs[2 * square_uv_triangles[3 * t + i / 2] + i % 2], 0);
            TEST_ASSERT_EQUAL_MEMORY(want, face + 14 + 4 * i, 4);
        }
    }
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
    bvx_mesh const m = random_mesh(BVX_F32, 0, 7); /* sizes from 1e-45 to 1e38 */
    bvx_buffer b = write_file(&m, BVX_FORMAT_STL);

    for (int t = 0; t < TRIANGLES; t++) {
        double n[3], length;
        for (int a = 0; a < 3; a++) {
            uint8_t const *const p = b.bytes + 84 + 50 * t + 4 * a;
            uint32_t const bits = (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 |
                                  (uint32_t)p[3] << 24;
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
        bvx_buffer b = write_rounded(&m, formats[i]);
        bvx_mesh back = {0};
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_mesh(ctx, b.bytes, b.size, formats[i], NULL, &back));
        bvx_buffer_free(ctx, &b);
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

static void test_write_refuses(void)
{
    static const int32_t formats[] = {BVX_FORMAT_PLY, BVX_FORMAT_OBJ, BVX_FORMAT_STL, BVX_FORMAT_OFF,
                                      BVX_FORMAT_GLB};

    for (int i = 0; i < 5; i++) {
        bvx_mesh m = square();
        float *const p = m.positions;
        uint32_t bad[6] = {0, 1, 2, 2, 4, 0};
        m.triangles = bad;
        check_not_written(&m, formats[i], BVX_ERR_RANGE, "triangle 1 has vertex index 4");
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
        m = square();
        m.uv_count = 4;
        check_not_written(&m, formats[i], BVX_ERR_ARGUMENT, "uvs is NULL beside a uv_count");
        m.uv_triangles = square_uv_triangles;
        check_not_written(&m, formats[i], BVX_ERR_ARGUMENT, "uvs is NULL beside uv_triangles");
        m.uvs = square_uvs;
        check_not_written(&m, formats[i], BVX_ERR_RANGE,
                          "triangle 1 has texture coordinate number 4, there are 4");
        m.uv_triangles = NULL;
        m.uv_count = 3;
        check_not_written(&m, formats[i], BVX_ERR_ARGUMENT, "uv_count is 3 for 4 vertices");
        m.uv_count = UINT64_C(1) << 32;
        check_not_written(&m, formats[i], BVX_ERR_RANGE, "uv_count is 4294967296");
        m.uv_count = 5;
        float broken[10];
        memcpy(broken, square_uvs, sizeof broken);
        m.uvs = broken;
        broken[7] = HUGE_VALF - HUGE_VALF;
        check_not_written(&m, formats[i], BVX_ERR_RANGE, "texture coordinate 3 is not finite");
        broken[7] = 0;
        broken[8] = HUGE_VALF; /* beyond the vertices: no texture coordinate, unless corners have their own */
        bvx_buffer b = write_file(&m, formats[i]);
        bvx_buffer_free(ctx, &b);
        m.uv_triangles = square_uv_triangles;
        check_not_written(&m, formats[i], BVX_ERR_RANGE, "texture coordinate 4 is not finite");
    }
    bvx_mesh m = square();
    check_not_written(&m, BVX_FORMAT_NPY, BVX_ERR_UNSUPPORTED, "format 4");
    check_not_written(&m, BVX_FORMAT_UNKNOWN, BVX_ERR_UNSUPPORTED, "format 0");
    check_not_written(NULL, BVX_FORMAT_PLY, BVX_ERR_ARGUMENT, "levels is NULL");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(ctx, &m, 1, NULL, BVX_FORMAT_PLY, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_write_mesh(NULL, &m, 1, NULL, BVX_FORMAT_PLY, &(bvx_buffer){0}));
    uint8_t byte = 0;
    bvx_buffer full = {&byte, 1, 0};
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(ctx, &m, 1, NULL, BVX_FORMAT_PLY, &full));
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
    static const int32_t formats[] = {BVX_FORMAT_PLY, BVX_FORMAT_OBJ, BVX_FORMAT_STL, BVX_FORMAT_OFF,
                                      BVX_FORMAT_GLB};
    bvx_mesh const m = square();
    bvx_context *const plain = ctx;

    for (int i = 0; i < 5; i++)
        for (uint64_t limit = 1; limit < 400; limit++) {
            bvx_context_options o = {.struct_size = sizeof o};
            bvx_buffer b = {0};
            o.memory_limit = limit;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
            bvx_status const status = bvx_write_mesh(ctx, &m, 1, NULL, formats[i], &b);
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
    bvx_mesh m = random_mesh(BVX_F64, 0, 3);
    bvx_buffer plain = write_file(&m, BVX_FORMAT_OBJ);

    if (!set_comma_locale()) {
        bvx_buffer_free(ctx, &plain);
        TEST_IGNORE_MESSAGE("no locale with a comma on this machine");
    }
    bvx_buffer other = {0};
    bvx_mesh back = {0};
    bvx_status const written = bvx_write_mesh(ctx, &m, 1, NULL, BVX_FORMAT_OBJ, &other);
    bvx_status const read = bvx_read_mesh(ctx, plain.bytes, plain.size, BVX_FORMAT_OBJ, NULL, &back);
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
    bvx_context_options o = {.struct_size = sizeof o};
    size_t const size = 200000;
    void *const arena = malloc(size);

    o.arena.memory = arena;
    o.arena.size = size;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
    for (int i = 0; i < 60; i++) {
        bvx_mesh const m = random_mesh(i % 2 == 0 ? BVX_F32 : BVX_F64, 0, (uint64_t)i / 6 + 1);
        if (i % 2 == 1 && formats[i % 3] == BVX_FORMAT_STL) continue; /* beyond floats */
        bvx_buffer b = write_file(&m, formats[i % 3]);
        bvx_mesh back = {0};
        TEST_ASSERT_EQUAL_INT32_MESSAGE(
            BVX_OK, bvx_read_mesh(ctx, b.bytes, b.size, formats[i % 3], NULL, &back), bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_UINT64(TRIANGLES, back.triangle_count);
        TEST_ASSERT_TRUE((uint8_t *)back.positions >= (uint8_t *)arena &&
                         (uint8_t *)back.positions < (uint8_t *)arena + size);
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
    RUN_TEST(test_write_ply_attributes_read_back);
    RUN_TEST(test_write_obj_attributes_read_back);
    RUN_TEST(test_write_obj_colours_are_exact);
    RUN_TEST(test_write_stl_leaves_attributes_out);
    RUN_TEST(test_workers_change_no_file);
    RUN_TEST(test_write_obj_bytes);
    RUN_TEST(test_write_obj_bytes_of_attributes);
    RUN_TEST(test_write_ply_bytes_of_attributes);
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
