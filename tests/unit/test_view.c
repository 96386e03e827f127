/* test_view.c - reading meshes of any type, stride and alignment; bounds; refusals. */
#include "core/core.h"
#include "mesh/view.h"
#include "suite.h"

#include <math.h>
#include <stdlib.h>

enum { MAX_VERTICES = 6000, MAX_TRIANGLES = 6000 };

static uint64_t random_state;
static double positions[MAX_VERTICES][3]; /* the truth; all numbers are floats too */
static uint32_t triangles[MAX_TRIANGLES][3];
static unsigned char position_bytes_of[MAX_VERTICES * 40 + 8], index_bytes_of[MAX_TRIANGLES * 40 + 8];

void setUp(void)
{
    suite_open(0);
    random_state = 1;
}

void tearDown(void)
{
    suite_close();
}

static uint32_t random_below(uint32_t n)
{
    random_state = random_state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
    return (uint32_t)(random_state >> 33) % n;
}

static void make_random(uint64_t vertex_count, uint64_t triangle_count)
{
    for (uint64_t v = 0; v < vertex_count; v++)
        for (int a = 0; a < 3; a++) positions[v][a] = (double)random_below(2097153) / 1048576 - 1.0;
    for (uint64_t t = 0; t < triangle_count; t++)
        for (int k = 0; k < 3; k++) triangles[t][k] = random_below((uint32_t)vertex_count);
}

/* A view of the truth with the given types, strides (0 packed) and bytes off alignment. */
static bvx_mesh_view make_view(uint64_t vertex_count, uint64_t triangle_count, uint32_t position_type,
                               uint32_t position_stride, uint32_t index_type, uint32_t index_stride,
                               size_t shift)
{
    bvx_mesh_view v;
    unsigned char *p = position_bytes_of + shift, *q = index_bytes_of + shift;

    memset(&v, 0, sizeof v);
    memset(position_bytes_of, 0xee, sizeof position_bytes_of);
    memset(index_bytes_of, 0xee, sizeof index_bytes_of);
    v.vertex_count = vertex_count;
    v.triangle_count = triangle_count;
    v.position_type = position_type;
    v.position_stride = position_stride;
    v.index_type = index_type;
    v.index_stride = index_stride;
    v.positions = p;
    for (uint64_t i = 0; i < vertex_count; i++) {
        float const f[3] = {(float)positions[i][0], (float)positions[i][1], (float)positions[i][2]};
        size_t const own = position_type == BVX_F32 ? 12 : 24;
        memcpy(p, position_type == BVX_F32 ? (const void *)f : (const void *)positions[i], own);
        p += position_stride != 0 ? position_stride : own;
    }
    if (index_type == 0) return v;
    v.indices = q;
    for (uint64_t t = 0; t < triangle_count; t++) {
        uint16_t s[3];
        uint64_t w[3];
        size_t const own = (size_t)6 << (index_type - BVX_U16);
        for (int k = 0; k < 3; k++) {
            s[k] = (uint16_t)triangles[t][k];
            w[k] = triangles[t][k];
        }
        const void *const wide = index_type == BVX_U32 ? (const void *)triangles[t] : (const void *)w;
        memcpy(q, index_type == BVX_U16 ? s : wide, own);
        q += index_stride != 0 ? index_stride : own;
    }
    return v;
}

static void expect_bounds(const bvx_mesh_view *view, int indexed)
{
    double low[3], high[3], want_low[3], want_high[3];

    for (int a = 0; a < 3; a++) {
        want_low[a] = HUGE_VAL;
        want_high[a] = -HUGE_VAL;
    }
    for (uint64_t t = 0; t < view->triangle_count; t++) {
        for (int k = 0; k < 3; k++) {
            const double *const p = positions[indexed ? triangles[t][k] : 3 * t + (uint64_t)k];
            for (int a = 0; a < 3; a++) {
                if (p[a] < want_low[a]) want_low[a] = p[a];
                if (p[a] > want_high[a]) want_high[a] = p[a];
            }
        }
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_check(ctx, "test", view));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_bounds(ctx, "test", view, low, high));
    for (int a = 0; a < 3; a++) {
        TEST_ASSERT_TRUE(low[a] == want_low[a]);
        TEST_ASSERT_TRUE(high[a] == want_high[a]);
    }
}

static void test_getters_read_every_type_stride_and_alignment(void)
{
    static const uint32_t index_types[4] = {0, BVX_U16, BVX_U32, BVX_U64};
    uint64_t const n = 60, m = 20;

    make_random(n, m);
    for (uint32_t p = BVX_F32; p <= BVX_F64; p++)
        for (int i = 0; i < 4; i++)
            for (uint32_t extra = 0; extra < 14; extra += 3)
                for (size_t shift = 0; shift < 8; shift++) {
                    uint32_t const ps = extra == 0 ? 0 : 12 * p + extra, is = extra == 0 ? 0 : 24 + extra;
                    bvx_mesh_view const v = make_view(n, m, p, ps, index_types[i], is, shift);
                    uint32_t c[3];
                    double x[3];
                    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_check(ctx, "test", &v));
                    for (uint64_t t = 0; t < m; t++) {
                        TEST_ASSERT_TRUE(bvxi_view_triangle(&v, t, c));
                        for (int k = 0; k < 3; k++)
                            TEST_ASSERT_EQUAL_UINT32(i == 0 ? 3 * t + (uint64_t)k : triangles[t][k], c[k]);
                    }
                    for (uint64_t k = 0; k < n; k++) {
                        bvxi_view_position(&v, k, x);
                        TEST_ASSERT_EQUAL_MEMORY(positions[k], x, sizeof x);
                    }
                    expect_bounds(&v, i != 0);
                }
}

static void test_an_index_beyond_the_vertices_is_not_accepted(void)
{
    uint32_t c[3];

    make_random(10, 3);
    for (uint32_t type = BVX_U16; type <= BVX_U64; type++)
        for (int k = 0; k < 3; k++) {
            bvx_mesh_view v;
            uint32_t const kept = triangles[1][k];
            triangles[1][k] = 10;
            v = make_view(10, 3, BVX_F32, 0, type, 0, 0);
            TEST_ASSERT_TRUE(bvxi_view_triangle(&v, 0, c));
            TEST_ASSERT_FALSE(bvxi_view_triangle(&v, 1, c));
            TEST_ASSERT_TRUE(bvxi_view_triangle(&v, 2, c));
            triangles[1][k] = kept;
        }
}

static void test_a_64_bit_index_is_not_cut_short(void)
{
    static const float p[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint64_t const t[3] = {0, 1, UINT64_C(0x100000002)};
    bvx_mesh_view v;
    double low[3], high[3];
    uint32_t c[3];

    memset(&v, 0, sizeof v);
    v.positions = p;
    v.indices = t;
    v.vertex_count = 3;
    v.triangle_count = 1;
    v.position_type = BVX_F32;
    v.index_type = BVX_U64;
    TEST_ASSERT_FALSE(bvxi_view_triangle(&v, 0, c));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvxi_view_bounds(ctx, "test", &v, low, high));
    TEST_ASSERT_EQUAL_STRING("test: triangle 0 has vertex index 4294967298, but there are 3 vertices",
                             bvx_last_message(ctx));
}

/* The quick way (packed floats and 32-bit numbers) at sizes around its blocks and rows of lanes. */
static void test_bounds_equal_a_plain_loop_at_every_size(void)
{
    for (int round = 0; round < 400; round++) {
        uint64_t const n = round < 140 ? (uint64_t)round + 3 : 3 + random_below(MAX_VERTICES - 3);
        uint64_t const m = round < 140 ? 1 + random_below(200) : 1 + random_below(MAX_TRIANGLES - 1);
        bvx_mesh_view v;
        make_random(n, m);
        if (round % 3 == 0) /* one corner of the bounds lies alone at the first, the last or any vertex */
            positions[round % 2 == 0 ? n - 1 : random_below((uint32_t)n)][round % 3] = round % 5 == 0 ? 7.0
                                                                                                      : -7.0;
        v = make_view(n, m, BVX_F32, 0, BVX_U32, 0, (size_t)round % 8);
        expect_bounds(&v, 1);
    }
}

static void test_bounds_leave_out_unused_vertices(void)
{
    double low[3], high[3];

    for (uint32_t type = BVX_F32; type <= BVX_F64; type++) {
        bvx_mesh_view v;
        make_random(1000, 500);
        for (uint64_t t = 0; t < 500; t++)
            for (int k = 0; k < 3; k++) triangles[t][k] = triangles[t][k] % 900;
        positions[950][0] = 100.0;
        positions[999][2] = -100.0;
        v = make_view(1000, 500, type, 0, BVX_U32, 0, 0);
        expect_bounds(&v, 1);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_bounds(ctx, "test", &v, low, high));
        TEST_ASSERT_TRUE(high[0] < 2.0 && low[2] > -2.0);
    }
}

static void test_bounds_give_zero_for_minus_zero(void)
{
    double low[3], high[3], zero = 0.0;

    for (uint32_t type = BVX_F32; type <= BVX_F64; type++) {
        bvx_mesh_view v;
        memset(positions, 0, sizeof positions);
        positions[0][0] = positions[1][1] = positions[2][2] = -0.0;
        triangles[0][0] = 0;
        triangles[0][1] = 1;
        triangles[0][2] = 2;
        v = make_view(3, 1, type, 0, BVX_U32, 0, 0);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_bounds(ctx, "test", &v, low, high));
        for (int a = 0; a < 3; a++) {
            TEST_ASSERT_EQUAL_MEMORY(&zero, &low[a], sizeof zero);
            TEST_ASSERT_EQUAL_MEMORY(&zero, &high[a], sizeof zero);
        }
    }
}

static void test_bounds_name_a_vertex_that_is_not_finite(void)
{
    static const double bad[3] = {HUGE_VAL, -HUGE_VAL, NAN};
    double low[3], high[3];

    for (int round = 0; round < 120; round++) {
        uint32_t const n = 3 + random_below(1500), at = round < 3 ? (uint32_t)round : random_below(n);
        uint32_t const type = round % 2 == 0 ? BVX_F32 : BVX_F64;
        char want[64];
        bvx_mesh_view v;
        make_random(n, 40);
        if (at + 1 < n) positions[n - 1][0] = NAN; /* the first one is named */
        positions[at][round / 2 % 3] = bad[round % 3];
        v = make_view(n, 40, type, 0, BVX_U32, 0, 0);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvxi_view_bounds(ctx, "test", &v, low, high));
        snprintf(want, sizeof want, "test: vertex %lu has %c = ", (unsigned long)at, "xyz"[round / 2 % 3]);
        TEST_ASSERT_EQUAL_STRING_LEN(want, bvx_last_message(ctx), strlen(want));
    }
}

static void test_bounds_name_the_first_triangle_with_a_bad_index(void)
{
    double low[3], high[3];

    for (int round = 0; round < 60; round++) {
        uint32_t const m = 1 + random_below(MAX_TRIANGLES - 1), at = random_below(m);
        char want[96];
        bvx_mesh_view v;
        make_random(77, m);
        triangles[m - 1][0] = 78;
        triangles[at][round % 3] = at == m - 1 && round % 3 != 0 ? 500 : 77 + (uint32_t)(at == m - 1);
        if (at == m - 1 && round % 3 != 0) triangles[m - 1][0] = 0;
        v = make_view(77, m, round % 2 == 0 ? BVX_F32 : BVX_F64, 0, BVX_U32, 0, 0);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvxi_view_bounds(ctx, "test", &v, low, high));
        snprintf(want, sizeof want, "test: triangle %lu has vertex index %lu, but there are 77 vertices",
                 (unsigned long)at, (unsigned long)triangles[at][round % 3]);
        TEST_ASSERT_EQUAL_STRING(want, bvx_last_message(ctx));
    }
}

static void test_bounds_of_nothing_are_refused(void)
{
    double low[3], high[3];
    bvx_mesh_view v;

    memset(&v, 0, sizeof v);
    v.position_type = BVX_F64;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_check(ctx, "test", &v));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvxi_view_bounds(ctx, "test", &v, low, high));
    make_random(3, 1);
    v = make_view(0, 1, BVX_F32, 0, BVX_U32, 0, 0); /* a triangle without any vertex */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvxi_view_bounds(ctx, "test", &v, low, high));
}

static void expect_refusal(const bvx_mesh_view *v, bvx_status status, const char *word)
{
    TEST_ASSERT_EQUAL_INT32(status, bvxi_view_check(ctx, "test", v));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), word));
}

static void test_check_names_the_field_that_is_wrong(void)
{
    bvx_mesh_view good, v;

    make_random(30, 10);
    good = make_view(30, 10, BVX_F64, 0, BVX_U32, 0, 0);
    expect_refusal(NULL, BVX_ERR_ARGUMENT, "mesh is NULL");
    v = good, v.position_type = 0, expect_refusal(&v, BVX_ERR_ARGUMENT, "position_type");
    v = good, v.position_type = 3, expect_refusal(&v, BVX_ERR_ARGUMENT, "position_type");
    v = good, v.position_stride = 23, expect_refusal(&v, BVX_ERR_ARGUMENT, "position_stride");
    v = good, v.position_type = BVX_F32, v.position_stride = 11;
    expect_refusal(&v, BVX_ERR_ARGUMENT, "position_stride");
    v = good, v.positions = NULL, expect_refusal(&v, BVX_ERR_ARGUMENT, "positions is NULL");
    v = good, v.vertex_count = UINT64_C(1) << 32, expect_refusal(&v, BVX_ERR_RANGE, "vertex_count");
    v = good, v.vertex_count = UINT64_MAX, expect_refusal(&v, BVX_ERR_RANGE, "vertex_count");
    v = good, v.triangle_count = UINT64_C(1) << 31, expect_refusal(&v, BVX_ERR_RANGE, "triangle_count");
    v = good, v.triangle_count = UINT64_MAX, expect_refusal(&v, BVX_ERR_RANGE, "triangle_count");
    v = good, v.index_type = 0, expect_refusal(&v, BVX_ERR_ARGUMENT, "index_type");
    v = good, v.index_type = 4, expect_refusal(&v, BVX_ERR_ARGUMENT, "index_type");
    v = good, v.index_stride = 11, expect_refusal(&v, BVX_ERR_ARGUMENT, "index_stride");
    v = good, v.index_type = BVX_U16, v.index_stride = 5,
    expect_refusal(&v, BVX_ERR_ARGUMENT, "index_stride");
    v = good, v.index_type = BVX_U64, v.index_stride = 23,
    expect_refusal(&v, BVX_ERR_ARGUMENT, "index_stride");
    v = good, v.reserved = 1, expect_refusal(&v, BVX_ERR_ARGUMENT, "reserved");
    v = good, v.indices = NULL, v.triangle_count = 11, expect_refusal(&v, BVX_ERR_RANGE, "indices is NULL");
}

static void test_check_accepts_the_least_strides_and_ignores_the_index_type_without_indices(void)
{
    bvx_mesh_view v;

    make_random(30, 10);
    v = make_view(30, 10, BVX_F32, 12, BVX_U16, 6, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_check(ctx, "test", &v));
    v = make_view(30, 10, BVX_F64, 24, BVX_U64, 24, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_check(ctx, "test", &v));
    v.indices = NULL;
    v.index_type = 99;
    v.index_stride = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_check(ctx, "test", &v));
}

static void test_view_of_a_mesh_shows_its_arrays(void)
{
    static const double p[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static uint32_t t[3] = {0, 1, 2};
    double q[9];
    bvx_mesh mesh;
    bvx_mesh_view v;
    uint32_t c[3];

    memcpy(q, p, sizeof q);
    memset(&mesh, 0, sizeof mesh);
    bvx_mesh_view_of(&mesh, &v);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_check(ctx, "test", &v));
    mesh.positions = q;
    mesh.triangles = t;
    mesh.vertex_count = 3;
    mesh.triangle_count = 1;
    mesh.position_type = BVX_F64;
    bvx_mesh_view_of(&mesh, &v);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_check(ctx, "test", &v));
    TEST_ASSERT_EQUAL_UINT64(3, v.vertex_count);
    TEST_ASSERT_TRUE(bvxi_view_triangle(&v, 0, c));
    TEST_ASSERT_EQUAL_MEMORY(t, c, sizeof c);
    TEST_ASSERT_EQUAL_PTR(q, v.positions);
    bvx_mesh_free(ctx, &mesh); /* not owned: the arrays stay, the struct is empty */
    TEST_ASSERT_NULL(mesh.positions);
    TEST_ASSERT_EQUAL_MEMORY(p, q, sizeof q);
}

static void test_packed_view_is_the_one_written_out(void)
{
    static const float xyz[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1};
    static const uint32_t corners[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    bvx_mesh_view const expected = {.positions = xyz,
                                    .indices = corners,
                                    .vertex_count = 4,
                                    .triangle_count = 4,
                                    .position_type = BVX_F32,
                                    .index_type = BVX_U32};
    bvx_mesh_view const view = bvx_mesh_view_packed(xyz, 4, corners, 4);
    bvx_lattice lattice;

    TEST_ASSERT_EQUAL_PTR(expected.positions, view.positions);
    TEST_ASSERT_EQUAL_PTR(expected.indices, view.indices);
    TEST_ASSERT_EQUAL_UINT64(expected.vertex_count, view.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(expected.triangle_count, view.triangle_count);
    TEST_ASSERT_EQUAL_UINT32(expected.position_type, view.position_type);
    TEST_ASSERT_EQUAL_UINT32(expected.position_stride, view.position_stride);
    TEST_ASSERT_EQUAL_UINT32(expected.index_type, view.index_type);
    TEST_ASSERT_EQUAL_UINT32(expected.index_stride, view.index_stride);
    TEST_ASSERT_NULL(view.colours);
    TEST_ASSERT_EQUAL_UINT64(0, view.reserved);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, &view, 8, &lattice));
}

static void test_mesh_free_returns_all_that_is_owned(void)
{
    for (int32_t type = BVX_F32; type <= BVX_F64; type++) {
        bvx_mesh mesh;
        uint64_t const before = bvx_memory_used(ctx), bytes = type == BVX_F32 ? 84 : 168;
        memset(&mesh, 0, sizeof mesh);
        mesh.position_type = type;
        mesh.vertex_capacity = 7;
        mesh.triangle_capacity = 5;
        mesh.owned = 1;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_alloc(ctx, BVXI_RESULT, bytes, "test", &mesh.positions));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_alloc(ctx, BVXI_RESULT, 60, "test", &mesh.triangles));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_alloc(ctx, BVXI_RESULT, 56, "test", &mesh.vertex_keys));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_alloc(ctx, BVXI_RESULT, 40, "test", &mesh.triangle_keys));
        bvx_mesh_free(ctx, &mesh);
        TEST_ASSERT_EQUAL_UINT64(before, bvx_memory_used(ctx));
        TEST_ASSERT_NULL(mesh.positions);
        TEST_ASSERT_EQUAL_INT32(0, mesh.owned);
        bvx_mesh_free(ctx, &mesh); /* an empty mesh is nothing to free */
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_getters_read_every_type_stride_and_alignment);
    RUN_TEST(test_an_index_beyond_the_vertices_is_not_accepted);
    RUN_TEST(test_a_64_bit_index_is_not_cut_short);
    RUN_TEST(test_bounds_equal_a_plain_loop_at_every_size);
    RUN_TEST(test_bounds_leave_out_unused_vertices);
    RUN_TEST(test_bounds_give_zero_for_minus_zero);
    RUN_TEST(test_bounds_name_a_vertex_that_is_not_finite);
    RUN_TEST(test_bounds_name_the_first_triangle_with_a_bad_index);
    RUN_TEST(test_bounds_of_nothing_are_refused);
    RUN_TEST(test_check_names_the_field_that_is_wrong);
    RUN_TEST(test_check_accepts_the_least_strides_and_ignores_the_index_type_without_indices);
    RUN_TEST(test_view_of_a_mesh_shows_its_arrays);
    RUN_TEST(test_packed_view_is_the_one_written_out);
    RUN_TEST(test_mesh_free_returns_all_that_is_owned);
    return UNITY_END();
}
