/* test_fans.c - what is found broken round vertices: a closed body, and ways in which one may not be. */
#include "oblique/oblique.h"

#include "bitvox_io.h"
#include "suite.h"

void setUp(void)
{
    suite_open(0);
}

void tearDown(void)
{
    suite_close();
}

static uint64_t broken_of(const uint32_t *triangle, uint64_t triangles, uint64_t vertices, int asked)
{
    uint8_t ask[16];
    uint64_t broken = 99;

    memset(ask, asked, sizeof ask);
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK, BVXI_SCOPE(ctx, bvxi_fans_check(ctx, triangle, triangles, vertices, ask, &broken)));
    return broken;
}

static void test_a_closed_body_has_one_fan_a_vertex(void)
{
    static const uint32_t one[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};

    TEST_ASSERT_EQUAL_UINT64(0, broken_of(one, 4, 4, 1));
}

static void test_a_missing_and_a_turned_triangle_are_found(void)
{
    static const uint32_t open[] = {0, 2, 1, 0, 1, 3, 1, 2, 3};
    static const uint32_t turned[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 0, 2, 3};

    TEST_ASSERT_EQUAL_UINT64(3, broken_of(open, 3, 4, 1)); /* vertex 1 has all of its own */
    TEST_ASSERT_EQUAL_UINT64(3, broken_of(turned, 4, 4, 1));
    TEST_ASSERT_EQUAL_UINT64(0, broken_of(turned, 4, 4, 0)); /* what is not requested is not looked at */
}

static void test_bodies_that_share_a_vertex_or_an_edge_are_found(void)
{
    static const uint32_t vertex[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 5, 4, 0, 4, 6, 4, 5, 6, 5, 0, 6};
    static const uint32_t edge[] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3, 0, 4, 1, 0, 1, 5, 1, 4, 5, 4, 0, 5};

    TEST_ASSERT_EQUAL_UINT64(1, broken_of(vertex, 8, 7, 1));
    TEST_ASSERT_EQUAL_UINT64(2, broken_of(edge, 8, 6, 1));
}

static void test_two_triangles_on_each_other_are_found(void)
{
    static const uint32_t sheet[] = {0, 1, 2, 0, 2, 1};

    TEST_ASSERT_EQUAL_UINT64(3, broken_of(sheet, 2, 3, 1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_closed_body_has_one_fan_a_vertex);
    RUN_TEST(test_a_missing_and_a_turned_triangle_are_found);
    RUN_TEST(test_bodies_that_share_a_vertex_or_an_edge_are_found);
    RUN_TEST(test_two_triangles_on_each_other_are_found);
    return UNITY_END();
}
