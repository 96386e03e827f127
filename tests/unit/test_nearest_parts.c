/* test_nearest_parts.c - the parts of the search for closest points: frames in floats against exact
 * distances, four pairs at a time against one, the evaluation against a finer one. */
#include "nearest/nearest_brick.h"
#include "nearest/closest.h"
#include "tools/mesh_maker.h"
#include "unity.h"

#include <math.h>

static uint64_t seed;

void setUp(void)
{
    seed = 5;
}

void tearDown(void)
{
}

/* ---- Exact distances ---- */

/* Coordinates are whole numbers of 2^-24 below 4, so all products below are whole numbers of less than 127
 * bits: which part of the triangle is nearest is exact, and the distance is rounded in the last steps
 * only. */
#define GRID 16777216.0
typedef long double fine;
#if defined(__SIZEOF_INT128__)
__extension__ typedef __int128 whole;
#define EXACT() ((void)0)
#else
typedef int64_t whole; /* too small */
#define EXACT() TEST_IGNORE_MESSAGE("the compiler has no numbers of 128 bits")
#endif

static void whole_cross(const whole a[3], const whole b[3], whole n[3])
{
    for (int k = 0; k < 3; k++) n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static whole whole_dot(const whole a[3], const whole b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static fine fine_to_segment(const whole p[3], const whole a[3], const whole b[3])
{
    whole u[3], w[3], n[3];

    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        w[k] = p[k] - a[k];
    }
    whole const along = whole_dot(u, w), length2 = whole_dot(u, u);
    if (along <= 0) return sqrtl((fine)whole_dot(w, w));
    if (along >= length2) {
        for (int k = 0; k < 3; k++) w[k] = p[k] - b[k];
        return sqrtl((fine)whole_dot(w, w));
    }
    whole_cross(u, w, n);
    return sqrtl((fine)whole_dot(n, n) / (fine)length2);
}

/* Least of the edges, and of the plane where the projection lies inside. */
static fine fine_distance(const double point[3], const double t[3][3])
{
    whole p[3], c[3][3], u[3], v[3], w[3], n[3], a[3], b[3];
    fine best = HUGE_VALL;

    for (int k = 0; k < 3; k++) {
        p[k] = (whole)(point[k] * GRID);
        for (int i = 0; i < 3; i++) c[i][k] = (whole)(t[i][k] * GRID);
    }
    for (int i = 0; i < 3; i++) {
        fine const d = fine_to_segment(p, (const whole *)c[i], (const whole *)c[(i + 1) % 3]);
        best = d < best ? d : best;
    }
    for (int k = 0; k < 3; k++) {
        u[k] = c[1][k] - c[0][k];
        v[k] = c[2][k] - c[0][k];
        w[k] = p[k] - c[0][k];
    }
    whole_cross((const whole *)u, (const whole *)v, n);
    whole_cross((const whole *)w, (const whole *)v, a);
    whole_cross((const whole *)u, (const whole *)w, b);
    whole const area2 = whole_dot(n, n), vb = whole_dot(a, n), vc = whole_dot(b, n), va = area2 - vb - vc;
    if (area2 > 0 && va >= 0 && vb >= 0 && vc >= 0) {
        fine const over = (fine)whole_dot(w, n), d = (over < 0 ? -over : over) / sqrtl((fine)area2);
        best = d < best ? d : best;
    }
    return best / (fine)GRID;
}

/* ---- Triangles of all shapes ---- */

static double between(double low, double high)
{
    return maker_between(&seed, low, high, 1 << 20);
}

static void to_grid(double *x, int count)
{
    for (int i = 0; i < count; i++) x[i] = floor(x[i] * GRID) / GRID;
}

/* Size 2^-20 to 1; even, thin by 1 to 2^-40, flat, a point. */
static void make_triangle(double t[3][3])
{
    double const size = ldexp(1.0, -maker_below(&seed, 20)), thin = ldexp(1.0, -maker_below(&seed, 40));
    int const kind = maker_below(&seed, 8);

    for (int k = 0; k < 3; k++) {
        t[0][k] = between(-1, 1);
        t[1][k] = t[0][k] + size * between(-1, 1);
        t[2][k] = t[0][k] + size * between(-1, 1);
    }
    if (kind < 4)
        for (int k = 0; k < 3; k++) {
            double const s = kind == 0 ? 0.0 : kind == 1 ? 1.0 : between(0, 1);
            t[2][k] = t[0][k] + s * (t[1][k] - t[0][k]) + size * thin * between(-1, 1);
        }
    if (kind == 4) memcpy(t[2], t[maker_below(&seed, 2)], sizeof t[2]);
    if (kind == 5 && maker_below(&seed, 4) == 0)
        for (int i = 1; i < 3; i++) memcpy(t[i], t[0], sizeof t[0]);
    if (kind == 6)
        for (int i = 0; i < 3; i++) /* right angles, equal coordinates */
            for (int k = 0; k < 3; k++) t[i][k] = floor(t[i][k] * 8) / 8;
    to_grid(t[0], 9);
}

/* Near the triangle, in its plane, on its corners, far away. */
static void make_point(const double t[3][3], double p[3])
{
    double const reach = ldexp(1.0, -maker_below(&seed, 22));
    int const kind = maker_below(&seed, 6);
    double const a = between(-0.5, 1.5), b = between(-0.5, 1.5);

    for (int k = 0; k < 3; k++) {
        p[k] = t[0][k] + a * (t[1][k] - t[0][k]) + b * (t[2][k] - t[0][k]);
        if (kind < 3) p[k] += reach * between(-1, 1);
        if (kind == 3) p[k] = t[maker_below(&seed, 3)][k];
        if (kind == 4) p[k] = between(-2, 2);
        if (kind == 5) p[k] = floor(p[k] * 8) / 8;
    }
    to_grid(p, 3);
}

/* ---- Tests ---- */

/* Floats may err by BVXI_NEAR_ERROR of where the leaf's far corner and the centre are, and a foot's half
 * unit; less than half of that is what they do. */
static void test_nearest_frames_are_near_the_truth(void)
{
    float worst = 0.0f;

    EXACT();
    for (int i = 0; i < 200000; i++) {
        double t[3][3], p[3];
        float corner[9][BVXI_NEAR_WIDTH], low[3], high[3];
        static const uint32_t number[BVXI_NEAR_WIDTH] = {9, 8, 7, 6, 5, 4, 3, 2};
        bvxi_near_leaf leaf, same;
        int const slot = maker_below(&seed, BVXI_NEAR_WIDTH);
        make_triangle(t);
        make_point((const double(*)[3])t, p);
        float reach = 0.0f;
        for (int a = 0; a < 3; a++) {
            float const origin = (float)p[a]; /* of the list: the centre itself, and a bit */
            low[a] = (float)(fmin(t[0][a], fmin(t[1][a], t[2][a])) - between(0, 0.01)) - 0x1p-22f;
            high[a] = (float)fmax(t[0][a], fmax(t[1][a], t[2][a])) + 0x1p-22f;
            for (int k = 0; k < BVXI_NEAR_WIDTH; k++)
                for (int v = 0; v < 3; v++)
                    corner[3 * v + a][k] = k == slot ? (float)(t[v][a] - (double)low[a])
                                                     : (float)between(0, (double)(high[a] - low[a]));
            reach += fmaxf(origin - low[a], high[a] - origin) + (high[a] - low[a]) +
                     fabsf((float)(p[a] - (double)origin));
        }
        bvxi_near_make_leaf(number, (const float(*)[BVXI_NEAR_WIDTH])corner, low, 0, &leaf);
        bvxi_near_make_leaf(number, (const float(*)[BVXI_NEAR_WIDTH])corner, low, 1, &same);
        for (int k = 0; k < BVXI_NEAR_WIDTH; k++)
            for (int f = 0; f < BVXI_NEAR_NUMBERS; f++)
                TEST_ASSERT_TRUE(leaf.frame[k].f[f] == same.frame[k].f[f]);
        for (int k = 0; k < BVXI_NEAR_WIDTH; k++)
            TEST_ASSERT_TRUE(leaf.frame[k].triangle == number[k] && same.frame[k].triangle == number[k]);
        TEST_ASSERT_EQUAL_INT(0, memcmp(leaf.low, same.low, sizeof leaf.low));
        TEST_ASSERT_EQUAL_INT(0, memcmp(leaf.high, same.high, sizeof leaf.high));
        const float *const f = leaf.frame[slot].f;
        float at[3];
        for (int a = 0; a < 3; a++) at[a] = (float)(p[a] - (double)(float)p[a]) + ((float)p[a] - f[a]);
        double const got = sqrt((double)bvxi_near_distance2(f, at[0], at[1], at[2]));
        double const error = fabs(got - (double)fine_distance(p, (const double(*)[3])t));
        float const allowed = reach * BVXI_NEAR_ERROR + 0x1p-23f;
        TEST_ASSERT_TRUE(f[BVXI_NEAR_P] >= 0.0f && f[BVXI_NEAR_Q] >= 0.0f && f[BVXI_NEAR_H] >= 0.0f);
        worst = fmaxf(worst, (float)error / allowed);
    }
    TEST_ASSERT_TRUE_MESSAGE(worst <= 0.5f, "floats err by more than is known of them");
    TEST_ASSERT_TRUE_MESSAGE(worst > 0.01f, "the test looks at nothing");
}

/* A search object that has what the evaluation looks at. */
static void test_nearest_pairs_equal_the_single_evaluation(void)
{
    enum { TRIANGLES = BVXI_NEAR_PAIRS };
    static double corner[TRIANGLES * 9];
    static bvxi_near_pairs pairs;
    bvxi_nearest n;
    memset(&n, 0, sizeof n);
    n.view.positions = corner;
    n.view.vertex_count = TRIANGLES * 3;
    n.view.triangle_count = TRIANGLES;
    n.view.position_type = BVX_F64;
    n.scale = 0.5;
    for (int round = 0; round < 2000; round++) {
        pairs.count = 0;
        for (int i = 0; i < TRIANGLES; i++) {
            double t[3][3], p[3];
            make_triangle(t);
            make_point((const double(*)[3])t, p);
            memcpy(corner + 9 * i, t, sizeof t);
            for (int a = 0; a < 3; a++) p[a] *= n.scale;
            bvxi_near_take_pair(&n, &pairs, p, (uint32_t)i, i);
        }
        pairs.count -= round % 7;
        bvxi_near_evaluate(&n, 1, &pairs);
        for (int i = 0; i < pairs.count; i++) {
            double t[3][3], q[3];
            double const p[3] = {pairs.point[0][i], pairs.point[1][i], pairs.point[2][i]};
            for (int k = 0; k < 9; k++) t[k / 3][k % 3] = corner[9 * i + k] * n.scale;
            double const d = bvxi_closest_on_triangle(p, (const double(*)[3])t, q);
            TEST_ASSERT_EQUAL_UINT32((uint32_t)i, pairs.triangle[i]);
            TEST_ASSERT_TRUE(d == pairs.distance2[i]);
            for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(q[a] == pairs.closest[a][i]);
        }
    }
}

/* What nearest.c says of the evaluation: never below the truth but for rounding, and above it by no more than
 * 2^-26 of the longest edge. Coordinates are of size 1 here. */
static void test_nearest_evaluation_is_near_the_truth(void)
{
    EXACT();
    for (int i = 0; i < 1000000; i++) {
        double t[3][3], p[3], q[3], longest = 0.0;
        make_triangle(t);
        make_point((const double(*)[3])t, p);
        for (int k = 0; k < 3; k++) {
            double const *const a = t[k], *const b = t[(k + 1) % 3];
            double const e = sqrt((a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) +
                                  (a[2] - b[2]) * (a[2] - b[2]));
            longest = fmax(longest, e);
        }
        double const d = sqrt(bvxi_closest_on_triangle(p, (const double(*)[3])t, q));
        double const truth = (double)fine_distance(p, (const double(*)[3])t);
        TEST_ASSERT_TRUE(d >= truth - 4e-15);
        TEST_ASSERT_TRUE(d <= truth + 4e-15 + longest * 0x1p-26);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_nearest_frames_are_near_the_truth);
    RUN_TEST(test_nearest_pairs_equal_the_single_evaluation);
    RUN_TEST(test_nearest_evaluation_is_near_the_truth);
    return UNITY_END();
}
