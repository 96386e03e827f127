/* test_crossings.c - pairs of triangles that cross, against looking at all pairs in whole numbers. */
#include "tools/crossing_oracle.h"
#include "tools/fault.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

enum { PAIRS = 20000, CORNERS = 4096 };

static maker_mesh mesh;
static uint64_t seed;
static uint32_t pairs[2 * PAIRS], wanted[2 * PAIRS];

void setUp(void)
{
    suite_open(0);
    seed = 12;
    maker_clear(&mesh);
}

void tearDown(void)
{
    maker_free(&mesh);
    suite_close();
}

static uint64_t crossings_of(const bvx_mesh_view *v)
{
    uint64_t count = 99, again = 99;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_crossings(ctx, v, &count, NULL, 0),
                                    bvx_last_message(ctx));
    TEST_ASSERT_TRUE(count <= PAIRS);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_crossings(ctx, v, &again, pairs, PAIRS),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(count, again);
    return count;
}

/* ---- The oracle ---- */

static int boxes_apart(const int64_t *const s[3], const int64_t *const t[3])
{
    for (int a = 0; a < 3; a++) {
        int above = 1, below = 1;
        for (int i = 0; i < 9; i++) {
            above = above && s[i / 3][a] > t[i % 3][a];
            below = below && s[i / 3][a] < t[i % 3][a];
        }
        if (above || below) return 1;
    }
    return 0;
}

/* All pairs of triangles with area, vertices at equal positions being the
 * first of them; positions are multiples of 1/scale. */
static uint64_t list_all(const maker_mesh *m, double scale)
{
    static int64_t whole[3 * CORNERS];
    static uint32_t first[CORNERS];
    uint64_t count = 0;

    TEST_ASSERT_TRUE(m->vertices <= CORNERS);
    for (size_t i = 0; i < 3 * m->vertices; i++) whole[i] = (int64_t)(m->p[i] * scale);
    for (size_t i = 0; i < m->vertices; i++)
        for (first[i] = 0; memcmp(whole + 3 * first[i], whole + 3 * i, 3 * sizeof *whole) != 0;) first[i]++;
    for (size_t i = 0; i < m->triangles; i++)
        for (size_t k = i + 1; k < m->triangles; k++) {
            const int64_t *s[3], *t[3];
            for (int a = 0; a < 3; a++) {
                s[a] = whole + 3 * first[m->t[3 * i + (size_t)a]];
                t[a] = whole + 3 * first[m->t[3 * k + (size_t)a]];
            }
            if (boxes_apart(s, t) || crossing_axis(s) < 0 || crossing_axis(t) < 0 || !crossing_pair(s, t))
                continue;
            TEST_ASSERT_TRUE(count < PAIRS);
            wanted[2 * count] = (uint32_t)i;
            wanted[2 * count++ + 1] = (uint32_t)k;
        }
    return count;
}

static uint64_t expect_all(double scale)
{
    bvx_mesh_view const v = maker_view(&mesh);
    uint64_t const want = list_all(&mesh, scale);
    TEST_ASSERT_EQUAL_UINT64(want, crossings_of(&v));
    if (want != 0) TEST_ASSERT_EQUAL_UINT32_ARRAY(wanted, pairs, 2 * want);
    return want;
}

/* ---- By hand ---- */

static void test_boxes_beside_and_in_each_other(void)
{
    double const low[3] = {0, 0, 0};
    double const high[3] = {4, 4, 4};
    double const inner[3] = {1, 1, 1};
    double const outer[3] = {2, 2, 2};
    double const far[3] = {9, 9, 9};
    double const on[3] = {4, 4, 4}, beyond[3] = {6, 6, 6};

    maker_box(&mesh, low, high);
    TEST_ASSERT_EQUAL_UINT64(0, expect_all(1));
    maker_box(&mesh, inner, outer); /* inside, apart */
    TEST_ASSERT_EQUAL_UINT64(0, expect_all(1));
    maker_box(&mesh, on, beyond); /* corner to corner, which is a common vertex */
    TEST_ASSERT_EQUAL_UINT64(0, expect_all(1));
    maker_box(&mesh, outer, far);
    TEST_ASSERT_TRUE(expect_all(1) > 10);
}

static void test_what_counts_and_what_does_not(void)
{
    uint32_t v[6];
    bvx_mesh_view view;

    v[0] = maker_vertex(&mesh, 0, 0, 0);
    v[1] = maker_vertex(&mesh, 4, 0, 0);
    v[2] = maker_vertex(&mesh, 0, 4, 0);
    v[3] = maker_vertex(&mesh, 1, 1, 0);
    v[4] = maker_vertex(&mesh, 8, 0, 0);
    v[5] = maker_vertex(&mesh, 4, 0, -0.0);
    maker_triangle(&mesh, v[0], v[1], v[2]);
    maker_triangle(&mesh, v[2], v[0], v[5]); /* there twice */
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_UINT64(1, crossings_of(&view));
    TEST_ASSERT_EQUAL_UINT32(0, pairs[0]);
    TEST_ASSERT_EQUAL_UINT32(1, pairs[1]);
    mesh.triangles = 1;
    maker_triangle(&mesh, v[0], v[1], v[4]); /* no area */
    maker_triangle(&mesh, v[3], v[3], v[0]); /* one vertex twice */
    maker_triangle(&mesh, v[1], v[5], v[3]); /* one position twice */
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_UINT64(0, crossings_of(&view));
    maker_triangle(&mesh, v[0], v[3], v[1]); /* folded onto the first */
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_UINT64(1, crossings_of(&view));
    TEST_ASSERT_EQUAL_UINT32(4, pairs[1]);
    mesh.triangles = 0;
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_UINT64(0, crossings_of(&view));
}

/* ---- Against all pairs ---- */

static void test_soups_equal_the_oracle(void)
{
    double const low[3] = {-3, -3, -3}, high[3] = {3, 3, 3};
    uint64_t found = 0;

    for (int n = 0; n < 60; n++) {
        maker_clear(&mesh);
        maker_soup(&mesh, &seed, 1 + maker_below(&seed, 60), low, high,
                   n % 3 == 0   ? 1
                   : n % 3 == 1 ? 8
                                : 1 << 20);
        maker_degenerate(&mesh, &seed, 3, low, high, 1);
        found += expect_all(1 << 20);
    }
    TEST_ASSERT_TRUE(found > 1000);
}

static void test_spoiled_solids_equal_the_oracle(void)
{
    double const centre[3] = {0, 0, 0}, radius[3] = {5, 6, 4};
    uint64_t found = 0;

    for (int n = 0; n < 20; n++) {
        maker_clear(&mesh);
        maker_star(&mesh, &seed, centre, radius, 0.6, 9, 12, 64);
        if (n % 2 != 0) {
            maker_star(&mesh, &seed, centre, radius, 0.1, 7, 9, 64);
            maker_shift(&mesh, 100, 0.5, 0.25, 0.125);
            maker_duplicate(&mesh, 5);
            maker_flip(&mesh, 0, 20);
        }
        maker_shuffle_triangles(&mesh, &seed);
        found += expect_all(64 * 64);
    }
    TEST_ASSERT_TRUE(found > 100);
}

/* A sheet of equal squares in a plane that no axis shows, some of them turned over: exact zeros
 * everywhere. */
static void test_a_flat_sheet_has_none_until_it_is_folded(void)
{
    enum { SIDE = 20 };
    for (uint32_t y = 0; y <= SIDE; y++)
        for (uint32_t x = 0; x <= SIDE; x++) maker_vertex(&mesh, x * 0.25, y * 0.5, x * 0.75 - y);
    for (uint32_t y = 0; y < SIDE; y++)
        for (uint32_t x = 0; x < SIDE; x++) {
            uint32_t const v = y * (SIDE + 1) + x;
            maker_quad(&mesh, v, v + 1, v + SIDE + 2, v + SIDE + 1, (int)(x + y) % 2);
        }
    TEST_ASSERT_EQUAL_UINT64(0, expect_all(4));
    mesh.p[3 * 200] += 0.5; /* along the plane, beyond the next vertex */
    mesh.p[3 * 200 + 2] += 1.5;
    TEST_ASSERT_TRUE(expect_all(4) > 3);
}

/* ---- Types, threads, arrays ---- */

/* Two bodies that reach into each other. */
static void make_spoiled(int rows)
{
    double const centre[3] = {1, 2, 3}, radius[3] = {5, 6, 4};
    size_t first;
    maker_star(&mesh, &seed, centre, radius, 0.6, rows, rows + 3, 16);
    first = mesh.vertices;
    maker_star(&mesh, &seed, centre, radius, 0.2, rows, rows + 3, 16);
    maker_shift(&mesh, first, 3, 0.5, 0.25);
}

static void test_all_types_give_the_same(void)
{
    static float f[3 * CORNERS];
    static double soup[9 * CORNERS];
    static uint16_t u16[3 * CORNERS];
    static uint64_t u64[3 * CORNERS];
    bvx_mesh_view v;
    uint64_t want;

    make_spoiled(12);
    TEST_ASSERT_TRUE(mesh.vertices <= CORNERS && mesh.triangles <= CORNERS);
    want = expect_all(16);
    TEST_ASSERT_TRUE(want > 10);
    for (size_t i = 0; i < 3 * mesh.vertices; i++) f[i] = (float)mesh.p[i];
    for (size_t i = 0; i < 3 * mesh.triangles; i++) {
        u16[i] = (uint16_t)mesh.t[i];
        u64[i] = mesh.t[i];
        memcpy(soup + 3 * i, mesh.p + 3 * mesh.t[i], 3 * sizeof *soup);
    }
    for (int way = 0; way < 4; way++) {
        v = maker_view(&mesh);
        if (way == 0) v.positions = f, v.position_type = BVX_F32;
        if (way == 1) v.indices = u16, v.index_type = BVX_U16;
        if (way == 2) v.indices = u64, v.index_type = BVX_U64;
        if (way == 3) v.indices = NULL, v.positions = soup, v.vertex_count = 3 * v.triangle_count;
        TEST_ASSERT_EQUAL_UINT64(want, crossings_of(&v));
        TEST_ASSERT_EQUAL_UINT32_ARRAY(wanted, pairs, 2 * want);
    }
}

/* Any power of two, and as far as coordinates that are nearly the smallest and nearly the largest. */
static void test_sizes_at_the_ends_of_doubles(void)
{
    static int const power[] = {-1070, -1000, -500, 500, 1000, 1020};
    bvx_mesh_view v;
    uint64_t want;

    make_spoiled(10);
    want = expect_all(16);
    for (size_t n = 0; n < sizeof power / sizeof *power; n++) {
        maker_clear(&mesh);
        seed = 12;
        make_spoiled(10);
        for (size_t i = 0; i < 3 * mesh.vertices; i++) mesh.p[i] = ldexp(mesh.p[i], power[n]);
        v = maker_view(&mesh);
        TEST_ASSERT_EQUAL_UINT64(want, crossings_of(&v));
        TEST_ASSERT_EQUAL_UINT32_ARRAY(wanted, pairs, 2 * want);
    }
}

/* Enough for many pieces; the array may be any size. */
static void test_threads_and_capacities(void)
{
    enum { FEW = 40 };
    static uint32_t few[2 * FEW + 2];
    bvx_context_options o;
    bvx_context *other;
    bvx_mesh_view v;
    uint64_t want, count;
    make_spoiled(40);
    maker_shuffle_triangles(&mesh, &seed);
    v = maker_view(&mesh);
    want = crossings_of(&v);
    TEST_ASSERT_TRUE(want > FEW);
    memcpy(wanted, pairs, sizeof pairs);
    for (int32_t threads = 1; threads <= 5; threads += 2) {
        o = (bvx_context_options){.struct_size = sizeof o};
        o.threads = threads;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &other));
        memset(pairs, 0, sizeof pairs);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(other, &v, &count, pairs, want));
        TEST_ASSERT_EQUAL_UINT64(want, count);
        TEST_ASSERT_EQUAL_UINT32_ARRAY(wanted, pairs, 2 * want);
        bvx_context_destroy(other);
    }
    for (uint64_t capacity = 0; capacity <= FEW; capacity++) {
        memset(few, 0xEE, sizeof few);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_mesh_crossings(ctx, &v, &count, few, capacity));
        TEST_ASSERT_EQUAL_UINT64(want, count);
        for (uint64_t i = 2 * capacity; i < 2 * FEW + 2; i++) TEST_ASSERT_EQUAL_HEX32(0xEEEEEEEE, few[i]);
    }
}

static void refuse(const bvx_mesh_view *v, bvx_status status, const char *text)
{
    uint64_t count = 77;
    TEST_ASSERT_EQUAL_INT32(status, bvx_mesh_crossings(ctx, v, &count, NULL, 0));
    TEST_ASSERT_EQUAL_UINT64(0, count);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), text), bvx_last_message(ctx));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "bvx_mesh_crossings"));
}

static void test_refusals(void)
{
    bvx_mesh_view v;
    uint64_t count;

    make_spoiled(8);
    v = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_crossings(NULL, &v, &count, NULL, 0));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_crossings(ctx, &v, NULL, NULL, 0));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_crossings(ctx, NULL, &count, NULL, 0));
    v.position_type = 9;
    refuse(&v, BVX_ERR_ARGUMENT, "position_type");
    v = maker_view(&mesh);
    v.vertex_count = 7;
    refuse(&v, BVX_ERR_RANGE, "vertex index");
    v = maker_view(&mesh);
    mesh.p[3 * 5 + 1] = NAN;
    refuse(&v, BVX_ERR_RANGE, "vertex 5 has y");
}

static bvx_status list_some(void *user, bvx_context *context)
{
    bvx_mesh_view const v = maker_view(&mesh);
    uint64_t count;
    (void)user;
    return bvx_mesh_crossings(context, &v, &count, pairs, PAIRS);
}

static void test_memory_is_as_told(void)
{
    uint64_t const used = bvx_memory_used(ctx);
    uint64_t count;
    bvx_mesh_view v;

    make_spoiled(24);
    v = maker_view(&mesh);
    bvx_memory_reset_peak(ctx);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &v, &count, pairs, PAIRS));
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - used <=
                     56 * v.triangle_count + 28 * v.vertex_count + 32 * count + 4096);
}

static void test_every_allocation_may_fail_and_every_progress_call_may_cancel(void)
{
    uint64_t allocations = 0, calls = 0;
    bvx_context_options one_thread = {.struct_size = sizeof one_thread};

    one_thread.threads = 1;
    make_spoiled(12);
    TEST_ASSERT_NULL(fault_every_allocation(list_some, NULL, &one_thread, &allocations));
    TEST_ASSERT_EQUAL_UINT64(15, allocations);
    TEST_ASSERT_NULL(fault_every_cancel(list_some, NULL, &one_thread, &calls));
    TEST_ASSERT_TRUE(calls >= 5);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_boxes_beside_and_in_each_other);
    RUN_TEST(test_what_counts_and_what_does_not);
    RUN_TEST(test_soups_equal_the_oracle);
    RUN_TEST(test_spoiled_solids_equal_the_oracle);
    RUN_TEST(test_a_flat_sheet_has_none_until_it_is_folded);
    RUN_TEST(test_all_types_give_the_same);
    RUN_TEST(test_sizes_at_the_ends_of_doubles);
    RUN_TEST(test_threads_and_capacities);
    RUN_TEST(test_refusals);
    RUN_TEST(test_memory_is_as_told);
    RUN_TEST(test_every_allocation_may_fail_and_every_progress_call_may_cancel);
    return UNITY_END();
}
