/* test_weld.c - which vertices share a position, against comparing all pairs. */
#include "mesh/weld.h"
#include "tools/fault.h"
#include "tools/mesh_maker.h"
#include "unity.h"

enum { MOST = 600 };

static bvx_context *ctx;
static double positions[MOST][3];
static float floats[MOST][3];
static uint32_t representative[MOST];

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(NULL, &ctx));
}

void tearDown(void)
{
    bvx_context_destroy(ctx);
}

static bvx_mesh_view view_of(uint64_t n, uint32_t type)
{
    bvx_mesh_view v;
    memset(&v, 0, sizeof v);
    for (uint64_t i = 0; i < n; i++)
        for (int a = 0; a < 3; a++) floats[i][a] = (float)positions[i][a];
    v.positions = type == BVX_F32 ? (const void *)floats : (const void *)positions;
    v.vertex_count = n;
    v.position_type = type;
    return v;
}

static void expect_weld(uint64_t n, uint32_t type)
{
    bvx_mesh_view const v = view_of(n, type);
    uint64_t different = 0, want_different = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_weld(ctx, &v, representative, &different));
    for (uint64_t i = 0; i < n; i++) {
        uint64_t k = 0;
        while (positions[k][0] != positions[i][0] || positions[k][1] != positions[i][1] ||
               positions[k][2] != positions[i][2])
            k++;
        TEST_ASSERT_EQUAL_UINT32(k, representative[i]);
        want_different += k == i;
    }
    TEST_ASSERT_EQUAL_UINT64(want_different, different);
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
}

static void test_weld_finds_the_least_vertex_at_each_position(void)
{
    uint64_t seed = 3;
    for (int round = 0; round < 60; round++) {
        int32_t const sides = 1 + maker_below(&seed, 9);
        uint64_t const n = round < 4 ? (uint64_t)round : (uint64_t)maker_below(&seed, MOST);
        for (uint64_t i = 0; i < n; i++)
            for (int a = 0; a < 3; a++) { /* minus zero now and then */
                double const x = (double)(maker_below(&seed, sides) - sides / 2) * 0.25;
                positions[i][a] = x == 0.0 && maker_below(&seed, 2) ? -0.0 : x;
            }
        expect_weld(n, BVX_F32);
        expect_weld(n, BVX_F64);
    }
}

/* Positions that differ in their last bit alone stay apart. */
static void test_weld_joins_nothing_that_differs(void)
{
    double x = 1.0;
    for (int i = 0; i < MOST; i++) {
        positions[i][0] = x;
        positions[i][1] = 1.0 - x;
        positions[i][2] = 5e-324 * i;
        x += 1.1102230246251565e-16 * 2;
    }
    expect_weld(MOST, BVX_F64);
    TEST_ASSERT_EQUAL_UINT32(MOST - 1, representative[MOST - 1]);
}

static bvx_status weld_some(void *user, bvx_context *context)
{
    bvx_mesh_view const v = view_of(MOST, BVX_F64);
    uint64_t different;
    (void)user;
    return bvxi_weld(context, &v, representative, &different);
}

static void test_every_allocation_may_fail(void)
{
    uint64_t allocations = 0;
    TEST_ASSERT_NULL(fault_every_allocation(weld_some, NULL, NULL, &allocations));
    TEST_ASSERT_EQUAL_UINT64(1, allocations);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_weld_finds_the_least_vertex_at_each_position);
    RUN_TEST(test_weld_joins_nothing_that_differs);
    RUN_TEST(test_every_allocation_may_fail);
    return UNITY_END();
}
