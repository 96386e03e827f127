/* test_check_written.c - far coordinates: what is written is what is
 * certified, and what floats would spoil is refused. */
#include "write_support.h"

#include <math.h>

enum {
    RINGS = 16,
    AROUND = 32,
    BALL_VERTICES = 2 + (RINGS - 1) * AROUND,
    BALL_TRIANGLES = 2 * AROUND * (RINGS - 1)
};

static double ball_positions[BALL_VERTICES * 3];
static float ball_floats[BALL_VERTICES * 3];
static uint32_t ball_triangles[BALL_TRIANGLES * 3];

static void put_triangle(uint32_t **at, uint32_t a, uint32_t b, uint32_t c)
{
    (*at)[0] = a;
    (*at)[1] = b;
    (*at)[2] = c;
    *at += 3;
}

/* A ball of radius 10 about a centre: closed, manifold, oriented, edges about 2 long. */
static bvx_mesh ball_at(double x, double y, double z)
{
    double const centre[3] = {x, y, z};
    uint32_t *t = ball_triangles;
    bvx_mesh m = {0};

    for (int i = 0; i < BALL_VERTICES; i++) {
        int const ring = i == 0 ? 0 : i == BALL_VERTICES - 1 ? RINGS : 1 + (i - 1) / AROUND;
        double const polar = 3.14159265358979 * ring / RINGS;
        double const turn = 6.28318530717959 * ((i - 1) % AROUND) / AROUND;
        double const p[3] = {sin(polar) * cos(turn), sin(polar) * sin(turn), cos(polar)};
        for (int a = 0; a < 3; a++) ball_positions[i * 3 + a] = 10.0 * p[a] + centre[a];
    }
    for (uint32_t j = 0; j < AROUND; j++) put_triangle(&t, 0, 1 + j, 1 + (j + 1) % AROUND);
    for (uint32_t r = 0; r + 2 < RINGS; r++)
        for (uint32_t j = 0; j < AROUND; j++) {
            uint32_t const a = 1 + r * AROUND + j, b = 1 + r * AROUND + (j + 1) % AROUND;
            put_triangle(&t, a, a + AROUND, b + AROUND);
            put_triangle(&t, a, b + AROUND, b);
        }
    for (uint32_t j = 0; j < AROUND; j++)
        put_triangle(&t, BALL_VERTICES - 1, 1 + (RINGS - 2) * AROUND + (j + 1) % AROUND,
                     1 + (RINGS - 2) * AROUND + j);

    m.positions = ball_positions;
    m.position_type = BVX_F64;
    m.triangles = ball_triangles;
    m.vertex_count = m.vertex_capacity = BALL_VERTICES;
    m.triangle_count = m.triangle_capacity = BALL_TRIANGLES;
    return m;
}

static bvx_certificate certificate_of(const bvx_mesh *m, int32_t weld)
{
    bvx_mesh_view view;
    bvx_certificate c;
    bvx_mesh_view_of(m, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, weld, &c));
    return c;
}

static bvx_status check_written(bvx_context *context, const bvx_mesh *meshes, uint64_t count,
                                const bvx_write_options *options, int32_t format, bvx_write_report *reports)
{
    bvx_write_options o = {.struct_size = sizeof o};

    if (options != NULL) o = *options;
    o.reports = reports;
    return bvx_write_mesh(context, meshes, count, &o, format, NULL);
}

static bvx_write_report report_of(const bvx_mesh *m, int32_t format)
{
    bvx_write_report r;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, check_written(ctx, m, 1, NULL, format, &r),
                                    bvx_last_message(ctx));
    return r;
}

/* The report is the certificate of the bytes: what reading them back gives. */
static void check_report_is_of_the_file(const bvx_mesh *m, int32_t format)
{
    bvx_write_report const r = report_of(m, format);
    bvx_buffer b = write_rounded(m, format);
    bvx_mesh back = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_mesh(ctx, b.bytes, b.size, format, NULL, &back));
    bvx_certificate const c = certificate_of(&back, format == BVX_FORMAT_STL);
    TEST_ASSERT_EQUAL_MEMORY(&c, &r.file, sizeof c);
    bvx_mesh_free(ctx, &back);
    bvx_buffer_free(ctx, &b);
}

/* ---- refused ---- */

static void check_not_fit(const bvx_mesh *m, int32_t format, const char *words)
{
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_mesh(ctx, m, 1, NULL, format, &b));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), words), bvx_last_message(ctx));
    TEST_ASSERT_NULL(b.bytes);
}

static void test_stl_far_from_the_origin_is_refused(void)
{
    bvx_mesh m = ball_at(600000, 5000000, 0);
    check_not_fit(&m, BVX_FORMAT_STL, "take PLY, OBJ, OFF or GLB, or bring the mesh near the origin");
    m = ball_at(1e8, 1e8, 1e8);
    check_not_fit(&m, BVX_FORMAT_STL, "912 of 960 triangles would lose their area");
    TEST_ASSERT_EQUAL_INT32(0, report_of(&m, BVX_FORMAT_STL).fits);
    TEST_ASSERT_TRUE(report_of(&m, BVX_FORMAT_STL).file.collapsed > 800);
}

static void test_other_formats_keep_what_is_far(void)
{
    static const int32_t formats[] = {BVX_FORMAT_PLY, BVX_FORMAT_OBJ, BVX_FORMAT_OFF, BVX_FORMAT_GLB};
    bvx_mesh const m = ball_at(600000, 5000000, 0);

    for (int i = 0; i < 4; i++) {
        bvx_buffer b = {0};
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, NULL, formats[i], &b));
        bvx_buffer_free(ctx, &b);
        bvx_write_report const r = report_of(&m, formats[i]);
        TEST_ASSERT_TRUE(r.fits && r.file.closed && r.file.edge_manifold && r.file.vertex_manifold &&
                         r.file.oriented);
        TEST_ASSERT_EQUAL_UINT64(0, r.merged + r.spoilt);
    }
}

static void test_a_frame_brings_it_near(void)
{
    bvx_mesh m = ball_at(600000, 5000000, 0);

    m.frame[0] = -600000;
    m.frame[1] = -5000000;
    bvx_write_report const r = report_of(&m, BVX_FORMAT_STL);
    TEST_ASSERT_TRUE(r.fits && r.file.closed && r.file.vertex_manifold);
    TEST_ASSERT_EQUAL_UINT64(BALL_VERTICES, r.file.vertices);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, -10.0, r.file.box.low[1]);
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, NULL, BVX_FORMAT_STL, &b));
    bvx_buffer_free(ctx, &b);
    m.frame[1] = 5000000; /* and takes it away */
    check_not_fit(&m, BVX_FORMAT_STL, "bvx_write_mesh: ");
}

/* Floats that the mesh has are written as they are. */
static void test_floats_are_never_refused(void)
{
    bvx_mesh m = ball_at(600000, 5000000, 0);
    for (int i = 0; i < BALL_VERTICES * 3; i++) ball_floats[i] = (float)ball_positions[i];
    m.positions = ball_floats;
    m.position_type = BVX_F32;
    bvx_write_report const r = report_of(&m, BVX_FORMAT_STL);
    TEST_ASSERT_TRUE(r.fits && r.largest_move == 0.0 && r.merged == 0);
    check_report_is_of_the_file(&m, BVX_FORMAT_STL);
}

static void test_levels_far_apart_are_refused(void)
{
    static double far_positions[BALL_VERTICES * 3];
    bvx_mesh level[2];
    bvx_write_report r[2];
    bvx_buffer b = {0};

    level[0] = ball_at(1e8, 0, 0);
    memcpy(far_positions, ball_positions, sizeof far_positions);
    level[1] = ball_at(-1e8, 0, 0);
    level[0].positions = far_positions;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_mesh(ctx, level, 2, NULL, BVX_FORMAT_GLB, &b));
    TEST_ASSERT_NOT_NULL(
        strstr(bvx_last_message(ctx), "bvx_write_mesh: level 0: the format's 32-bit floats move"));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, check_written(ctx, level, 2, NULL, BVX_FORMAT_GLB, r));
    TEST_ASSERT_FALSE(r[0].fits || r[1].fits);
    TEST_ASSERT_TRUE(report_of(&level[0], BVX_FORMAT_GLB).fits); /* alone it lies about its own middle */
}

/* ---- the bytes ---- */

static void test_the_report_is_of_the_file(void)
{
    static const int32_t formats[] = {BVX_FORMAT_STL, BVX_FORMAT_PLY, BVX_FORMAT_OBJ, BVX_FORMAT_OFF};
    static const double at[] = {0, 1.5, 1e4, 3e6, 1e8};

    for (int f = 0; f < 4; f++)
        for (int i = 0; i < 5; i++) {
            bvx_mesh m = ball_at(at[i], -at[i], at[i] / 3);
            check_report_is_of_the_file(&m, formats[f]);
            m.frame[2] = at[i] / 7 + 0.1;
            check_report_is_of_the_file(&m, formats[f]);
        }
}

/* Equal positions are one vertex in STL only. */
static void test_stl_joins_equal_positions(void)
{
    bvx_mesh m = ball_at(0, 0, 0);
    static uint32_t apart[BALL_TRIANGLES * 3];
    static double corners[BALL_TRIANGLES * 9];

    for (uint32_t i = 0; i < BALL_TRIANGLES * 3; i++) {
        memcpy(&corners[i * 3], &ball_positions[ball_triangles[i] * 3], 3 * sizeof(double));
        apart[i] = i;
    }
    m.positions = corners;
    m.triangles = apart;
    m.vertex_count = BALL_TRIANGLES * 3;
    TEST_ASSERT_TRUE(report_of(&m, BVX_FORMAT_STL).file.closed);
    TEST_ASSERT_FALSE(report_of(&m, BVX_FORMAT_PLY).file.closed);
    TEST_ASSERT_EQUAL_UINT64(0, report_of(&m, BVX_FORMAT_STL).merged);
}

/* One sliver among many triangles is told of, and written. */
static void test_a_sliver_is_counted(void)
{
    bvx_mesh m = ball_at(0, 0, 0);

    memcpy(&ball_positions[3 * 40], &ball_positions[3 * 41], 3 * sizeof(double));
    ball_positions[3 * 40 + 2] += 1e-9;
    bvx_write_report const r = report_of(&m, BVX_FORMAT_STL);
    TEST_ASSERT_TRUE(r.fits);
    TEST_ASSERT_EQUAL_UINT64(1, r.merged);
    TEST_ASSERT_EQUAL_UINT64(2, r.spoilt);
    TEST_ASSERT_EQUAL_UINT64(2, r.file.collapsed);
    check_report_is_of_the_file(&m, BVX_FORMAT_STL);
}

static void test_wrong_calls(void)
{
    bvx_mesh m = ball_at(0, 0, 0);
    bvx_write_report r;

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, check_written(NULL, &m, 1, NULL, BVX_FORMAT_STL, &r));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, check_written(ctx, NULL, 1, NULL, BVX_FORMAT_STL, &r));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, check_written(ctx, &m, 1, NULL, BVX_FORMAT_STL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, check_written(ctx, &m, 0, NULL, BVX_FORMAT_STL, &r));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, check_written(ctx, &m, 1, NULL, BVX_FORMAT_NPY, &r));
    ball_positions[4] = 1e300;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, check_written(ctx, &m, 1, NULL, BVX_FORMAT_STL, &r));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "too large for the format's 32-bit floats"));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, check_written(ctx, &m, 1, NULL, BVX_FORMAT_OBJ, &r));
    bvx_write_options o = {.struct_size = sizeof o};
    bvx_buffer b = {0};
    o.rounding = 2;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(ctx, &m, 1, &o, BVX_FORMAT_PLY, &b));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_stl_far_from_the_origin_is_refused);
    RUN_TEST(test_other_formats_keep_what_is_far);
    RUN_TEST(test_a_frame_brings_it_near);
    RUN_TEST(test_floats_are_never_refused);
    RUN_TEST(test_levels_far_apart_are_refused);
    RUN_TEST(test_the_report_is_of_the_file);
    RUN_TEST(test_stl_joins_equal_positions);
    RUN_TEST(test_a_sliver_is_counted);
    RUN_TEST(test_wrong_calls);
    return UNITY_END();
}
