/* test_write_off.c - meshes written to OFF and COFF, byte by byte and read back. */
#include "comma_locale.h"
#include "write_support.h"

#include <math.h>

static float box_xyz[12] = {0, 0, 0, 2, 0, 0, 2, 0.1f, 0, 0, 1e-7f, -0.0f};
static uint32_t box_triangles[6] = {0, 1, 2, 2, 3, 0};
static uint8_t box_colours[16] = {255, 0, 1, 255, 128, 51, 254, 7, 0, 0, 0, 0, 2, 200, 100, 50};
static float box_uvs[8] = {0, 0, 1, 0, 1, 1, 0, 1};

static bvx_mesh flat(void)
{
    bvx_mesh m = {0};
    m.positions = box_xyz;
    m.triangles = box_triangles;
    m.vertex_count = m.vertex_capacity = 4;
    m.triangle_count = m.triangle_capacity = 2;
    m.position_type = BVX_F32;
    return m;
}

static void check_off(const bvx_mesh *m, const char *want)
{
    bvx_buffer b = write_file(m, BVX_FORMAT_OFF);
    TEST_ASSERT_EQUAL_UINT64(strlen(want), b.size);
    TEST_ASSERT_EQUAL_MEMORY(want, b.bytes, strlen(want));
    bvx_buffer_free(ctx, &b);
}

static void test_write_off_bytes(void)
{
    bvx_mesh m = flat();

    check_off(&m, "OFF\n4 2 0\n0 0 0\n2 0 0\n2 0.1 0\n0 1e-7 -0\n3 0 1 2\n3 2 3 0\n");
    m.uvs = box_uvs; /* no place for them */
    m.uv_count = 4;
    check_off(&m, "OFF\n4 2 0\n0 0 0\n2 0 0\n2 0.1 0\n0 1e-7 -0\n3 0 1 2\n3 2 3 0\n");
    m.colours = box_colours;
    check_off(&m,
              "COFF\n4 2 0\n0 0 0 255 0 1 255\n2 0 0 128 51 254 7\n2 0.1 0 0 0 0 0\n0 1e-7 -0 2 200 100 50\n"
              "3 0 1 2\n3 2 3 0\n");
    m.colours = NULL;
    m.frame[0] = 0.25; /* doubles from here on, of what the floats are */
    check_off(&m,
              "OFF\n4 2 0\n0.25 0 0\n2.25 0 0\n2.25 0.10000000149011612 0\n0.25 1.0000000116860974e-7 -0\n"
              "3 0 1 2\n3 2 3 0\n");
}

static void test_write_off_reads_back(void)
{
    for (uint64_t seed = 1; seed < 12; seed++)
        for (int32_t type = BVX_F32; type <= BVX_F64; type++)
            for (int with = 0; with <= WITH_COLOURS; with++) {
                bvx_mesh const m = random_mesh(type, with, seed);
                bvx_mesh back = write_and_read(&m, BVX_FORMAT_OFF);
                TEST_ASSERT_EQUAL_UINT64(VERTICES, back.vertex_count);
                TEST_ASSERT_EQUAL_MEMORY(triangles, back.triangles, sizeof triangles);
                for (uint64_t t = 0; t < TRIANGLES; t++)
                    for (int k = 0; k < 3; k++) {
                        double p[3], q[3];
                        corner_of(&m, t, k, p);
                        corner_of(&back, t, k, q);
                        for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(p[a] == as_written(&m, q[a]));
                    }
                check_same_attributes(&m, &back, 1);
                bvx_mesh_free(ctx, &back);
            }
}

static void test_write_off_adds_the_frame(void)
{
    bvx_mesh m = flat();

    m.frame[0] = 500000.125;
    m.frame[1] = -4649776.0625;
    bvx_mesh back = write_and_read(&m, BVX_FORMAT_OFF);
    for (uint64_t t = 0; t < 2; t++)
        for (int k = 0; k < 3; k++) {
            double p[3], q[3];
            corner_of(&m, t, k, p);
            corner_of(&back, t, k, q);
            for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(q[a] == p[a] + m.frame[a]);
        }
    bvx_mesh_free(ctx, &back);
}

/* The longest numbers there are fit the room that is made for them. */
static void test_write_off_longest_numbers(void)
{
    static const double longest[] = {-1.2345678901234567e-6, -2.2250738585072014e-308,
                                     -123456789012345680000.0, -1.7976931348623157e308,
                                     -0.0000099999999999999991};
    double p[9];
    float f[9];
    uint8_t white[12];
    uint32_t t[3] = {0, 1, 2};
    bvx_mesh m = flat();

    memset(white, 254, sizeof white); /* in OBJ 255 would be short */
    m.triangles = t;
    m.vertex_count = 3;
    m.triangle_count = 1;
    m.colours = white;
    for (size_t i = 0; i < sizeof longest / sizeof longest[0]; i++) {
        for (int k = 0; k < 9; k++) {
            p[k] = longest[i];
            f[k] = i == 3 ? -100000002004087730000.0f : (float)longest[i];
        }
        for (int32_t type = BVX_F32; type <= BVX_F64; type++) {
            m.position_type = type;
            m.positions = type == BVX_F32 ? (void *)f : (void *)p;
            bvx_buffer b = write_file(&m, BVX_FORMAT_OFF);
            TEST_ASSERT_TRUE(b.size <= b.capacity);
            bvx_buffer_free(ctx, &b);
            b = write_file(&m, BVX_FORMAT_OBJ);
            TEST_ASSERT_TRUE(b.size <= b.capacity);
            bvx_buffer_free(ctx, &b);
        }
    }
}

static void test_a_locale_with_comma_changes_no_off(void)
{
    bvx_mesh m = random_mesh(BVX_F64, WITH_COLOURS, 3);
    bvx_buffer plain = write_file(&m, BVX_FORMAT_OFF), other = {0};

    if (!set_comma_locale()) {
        bvx_buffer_free(ctx, &plain);
        TEST_IGNORE_MESSAGE("no locale with a comma on this machine");
    }
    bvx_status const written = bvx_write_mesh(ctx, &m, 1, NULL, BVX_FORMAT_OFF, &other);
    setlocale(LC_ALL, "C");
    TEST_ASSERT_EQUAL_INT32(BVX_OK, written);
    TEST_ASSERT_EQUAL_UINT64(plain.size, other.size);
    TEST_ASSERT_EQUAL_MEMORY(plain.bytes, other.bytes, (size_t)plain.size);
    bvx_buffer_free(ctx, &plain);
    bvx_buffer_free(ctx, &other);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_write_off_bytes);
    RUN_TEST(test_write_off_reads_back);
    RUN_TEST(test_write_off_adds_the_frame);
    RUN_TEST(test_write_off_longest_numbers);
    RUN_TEST(test_a_locale_with_comma_changes_no_off);
    return UNITY_END();
}
