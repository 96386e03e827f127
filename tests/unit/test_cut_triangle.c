/* test_cut_triangle.c - what a box leaves of a triangle: cases worked by hand, points on the plane to the
 * bit, and the same points on an edge for both its triangles. */
#include "render_support.h"

#include "render/raster.h"

static const double inf = (double)INFINITY;

static void cross_of(const double a[3], const double b[3], double c[3])
{
    c[0] = a[1] * b[2] - a[2] * b[1];
    c[1] = a[2] * b[0] - a[0] * b[2];
    c[2] = a[0] * b[1] - a[1] * b[0];
}

static double dot_of(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static int32_t cut_of(const double t[3][3], double low_x, double high_x, double corner[BVXI_CUT_MOST][3])
{
    bvxi_cut cut = {1, {-inf, -inf, -inf}, {inf, inf, inf}};
    cut.low[0] = low_x;
    cut.high[0] = high_x;
    return bvxi_cut_triangle(&cut, t, corner);
}

static void has_corners(const double (*got)[3], int32_t n, const double (*want)[3], int32_t count)
{
    TEST_ASSERT_EQUAL_INT32(count, n);
    for (int32_t i = 0; i < n; i++)
        for (int a = 0; a < 3; a++) TEST_ASSERT_EQUAL_DOUBLE(want[i][a], got[i][a]);
}

static void test_cut_triangle_by_hand(void)
{
    static const double t[3][3] = {{0, 0, 0}, {4, 0, 8}, {2, 6, 4}};
    static const double left[3][3] = {{0, 0, 0}, {1, 0, 2}, {1, 3, 2}};
    static const double right[4][3] = {{1, 0, 2}, {4, 0, 8}, {2, 6, 4}, {1, 3, 2}};
    static const double half[3][3] = {{0, 0, 0}, {2, 0, 4}, {2, 6, 4}}; /* a corner on the plane */
    static const double band[5][3] = {{1, 0, 2}, {3, 0, 6}, {3, 3, 6}, {2, 6, 4}, {1, 3, 2}};
    double got[BVXI_CUT_MOST][3];

    has_corners((const double(*)[3])got, cut_of(t, -inf, 1, got), left, 3);
    has_corners((const double(*)[3])got, cut_of(t, 1, inf, got), right, 4);
    has_corners((const double(*)[3])got, cut_of(t, -inf, 2, got), half, 3);
    has_corners((const double(*)[3])got, cut_of(t, 1, 3, got), band, 5);
    has_corners((const double(*)[3])got, cut_of(t, 0, 4, got), t, 3);
    has_corners((const double(*)[3])got, cut_of(t, -1, 5, got), t, 3);
    TEST_ASSERT_EQUAL_INT32(0, cut_of(t, 4, inf, got)); /* a tip */
    TEST_ASSERT_EQUAL_INT32(0, cut_of(t, 5, inf, got));
    TEST_ASSERT_EQUAL_INT32(0, cut_of(t, 1, 1, got)); /* a line */
}

/* All six planes: the middle of a large triangle is a hexagon or the like, with corners inside the box. */
static void test_cut_triangle_has_many_corners(void)
{
    static const double t[3][3] = {{30, -15, -15}, {-15, 30, -15}, {-15, -15, 30}}; /* x + y + z = 0 */
    bvxi_cut cut = {1, {-1, -1, -1}, {1, 1, 1}};
    double got[BVXI_CUT_MOST][3];
    int32_t const n = bvxi_cut_triangle(&cut, t, got);

    TEST_ASSERT_EQUAL_INT32(6, n);
    for (int32_t i = 0; i < n; i++) {
        double product = 1;
        for (int a = 0; a < 3; a++) product *= got[i][a];
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, product); /* (1, -1, 0) in some order */
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2, dot_of(got[i], got[i]));
    }
}

/* One plane: what is cut lies on it to the last bit, whatever the slope; what is not cut is untouched. */
static void test_cut_points_lie_on_the_plane(void)
{
    int cut_points = 0;

    random_state = 14;
    for (int round = 0; round < 20000; round++) {
        double t[3][3], got[BVXI_CUT_MOST][3];
        double const plane = draw_unit() * 0.9 + 0.05;
        int32_t n;
        for (int k = 0; k < 3; k++) draw_point(t[k], 1.0 / 3.0 + draw_unit());
        n = cut_of((const double(*)[3])t, plane, inf, got);
        for (int32_t i = 0; i < n; i++) {
            int own = 0;
            for (int k = 0; k < 3; k++) own |= memcmp(got[i], t[k], sizeof t[k]) == 0;
            TEST_ASSERT_TRUE(own || got[i][0] == plane);
            TEST_ASSERT_TRUE(got[i][0] >= plane);
            cut_points += !own;
        }
    }
    TEST_ASSERT_TRUE(cut_points > 10000);
}

/* Two triangles with an edge in common keep the same points of it, to the last bit, whatever lies around. */
static void test_cut_triangles_share_points_on_their_edge(void)
{
    int shared = 0;

    random_state = 9;
    for (int round = 0; round < 20000; round++) {
        double p[4][3], first[3][3], second[3][3], a[BVXI_CUT_MOST][3], b[BVXI_CUT_MOST][3], edge[3];
        bvxi_cut cut = {1, {0, 0, 0}, {0, 0, 0}};
        int32_t n, m;
        for (int k = 0; k < 4; k++) draw_point(p[k], k < 2 ? 10 : 1);
        for (int k = 0; k < 3; k++) {
            cut.low[k] = draw_unit() * 5;
            cut.high[k] = cut.low[k] + draw_unit() * 5;
            edge[k] = p[1][k] - p[0][k];
        }
        p[2][0] += 20; /* so that nothing but the edge is near the edge */
        p[3][1] -= 20;
        memcpy(first, p, sizeof first);
        memcpy(second[0], p[1], sizeof p[0]);
        memcpy(second[1], p[0], sizeof p[0]);
        memcpy(second[2], p[3], sizeof p[0]);
        n = bvxi_cut_triangle(&cut, (const double(*)[3])first, a);
        m = bvxi_cut_triangle(&cut, (const double(*)[3])second, b);
        for (int32_t i = 0; i < n; i++) {
            double to[3], square[3], found = 0;
            for (int k = 0; k < 3; k++) {
                to[k] = a[i][k] - p[0][k];
                TEST_ASSERT_TRUE(a[i][k] >= cut.low[k] - 1e-12 && a[i][k] <= cut.high[k] + 1e-12);
            }
            cross_of(edge, to, square);
            if (dot_of(square, square) > 1e-20 * dot_of(edge, edge)) continue; /* not on the edge */
            for (int32_t j = 0; j < m; j++) found += memcmp(a[i], b[j], sizeof a[i]) == 0;
            shared++;
            TEST_ASSERT_TRUE(found > 0);
        }
    }
    TEST_ASSERT_TRUE(shared > 2000);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_cut_triangle_by_hand);
    RUN_TEST(test_cut_triangle_has_many_corners);
    RUN_TEST(test_cut_points_lie_on_the_plane);
    RUN_TEST(test_cut_triangles_share_points_on_their_edge);
    return UNITY_END();
}
