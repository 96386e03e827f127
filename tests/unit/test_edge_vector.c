/* test_edge_vector.c - where an edge is cut: the formula's special cases,
 * and the formula against lines in general place. */
#include "surface/field_surface.h"
#include "tools/mesh_maker.h"

#include <math.h>

#include "unity.h"

static uint64_t seed;

void setUp(void)
{
    seed = UINT64_C(0xed6e);
}

void tearDown(void)
{
}

/* An edge of unit length along x from 0, with closest points a and b. */
static bvxi_cut_edge unit_edge(const double a[3], const double b[3])
{
    bvxi_cut_edge e;

    memset(&e, 0, sizeof e);
    e.length = 1.0;
    for (int k = 0; k < 3; k++) {
        e.low[k] = a[k];
        e.high[k] = b[k] - (k == 0 ? 1.0 : 0.0);
    }
    e.low_distance = sqrt(a[0] * a[0] + a[1] * a[1] + a[2] * a[2]);
    e.high_distance = sqrt(e.high[0] * e.high[0] + e.high[1] * e.high[1] + e.high[2] * e.high[2]);
    e.high_inside = 1;
    return e;
}

static void assert_cut(const double a[3], const double b[3], int32_t interpolation, int32_t by, double ratio)
{
    bvxi_cut_edge const e = unit_edge(a, b);
    double t = -1.0;
    TEST_ASSERT_EQUAL_INT32(by, bvxi_find_cut(&e, interpolation, &t));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, ratio, t);
}

/* The example with which the printed formula gives -0.3. */
static void test_cut_has_the_right_sign(void)
{
    double const a[3] = {0.3, 1.0, 0.2}, b[3] = {0.3, -1.0, 0.2};
    assert_cut(a, b, BVX_EDGE_VECTOR, BVXI_CUT_VECTOR, 0.3);
    assert_cut(a, b, BVX_EDGE_PAPER, BVXI_CUT_VECTOR, 0.3);
}

static void test_cut_is_the_plane_of_a_flat_surface(void)
{
    for (int n = 0; n < 2000; n++) {
        double normal[3], a[3], b[3], t, length = 0, d;
        for (int k = 0; k < 3; k++) normal[k] = maker_between(&seed, -1, 1, 1 << 20);
        for (int k = 0; k < 3; k++) length += normal[k] * normal[k];
        length = sqrt(length);
        for (int k = 0; k < 3; k++) normal[k] /= length;
        t = maker_between(&seed, 0.01, 0.99, 1 << 20);
        if (normal[0] > -0.01 && normal[0] < 0.01) continue;
        for (int k = 0; k < 3; k++) {
            d = normal[0] * t;
            a[k] = normal[k] * d;
            b[k] = (k == 0 ? 1.0 : 0.0) - normal[k] * (normal[0] - d);
        }
        {
            bvxi_cut_edge const e = unit_edge(a, b);
            double got;
            TEST_ASSERT_EQUAL_INT32(BVXI_CUT_VECTOR, bvxi_find_cut(&e, BVX_EDGE_VECTOR, &got));
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, t, got);
            TEST_ASSERT_EQUAL_INT32(BVXI_CUT_SCALAR, bvxi_find_cut(&e, BVX_EDGE_SCALAR, &got));
            TEST_ASSERT_DOUBLE_WITHIN(1e-9, t, got);
        }
    }
}

/* Lines in any place: a step to either side along the edge is further from the line. */
static double distance_to_line(double x, const double a[3], const double b[3])
{
    double const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, w[3] = {x - a[0], -a[1], -a[2]};
    double const uu = u[0] * u[0] + u[1] * u[1] + u[2] * u[2];
    double const s = (u[0] * w[0] + u[1] * w[1] + u[2] * w[2]) / uu;
    double d = 0;
    for (int k = 0; k < 3; k++) d += (w[k] - s * u[k]) * (w[k] - s * u[k]);
    return d;
}

static void test_cut_is_nearest_to_the_line(void)
{
    int told = 0, beyond = 0;

    for (int n = 0; n < 20000; n++) {
        double a[3], b[3], t = -1;
        bvxi_cut_edge e;
        int32_t by;
        for (int k = 0; k < 3; k++) {
            a[k] = maker_between(&seed, -1, 1, 1000);
            b[k] = maker_between(&seed, -1, 1, 1000) + (k == 0);
        }
        e = unit_edge(a, b);
        by = bvxi_find_cut(&e, BVX_EDGE_VECTOR, &t);
        if (by == BVXI_CUT_VECTOR) {
            TEST_ASSERT_TRUE(t >= 0.0 && t <= 1.0);
            TEST_ASSERT_TRUE(distance_to_line(t, a, b) <= distance_to_line(t + 0.001, a, b) + 1e-12);
            TEST_ASSERT_TRUE(distance_to_line(t, a, b) <= distance_to_line(t - 0.001, a, b) + 1e-12);
            told++;
        } else {
            TEST_ASSERT_EQUAL_INT32(BVXI_CUT_SCALAR, by);
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, e.low_distance / (e.low_distance + e.high_distance), t);
            beyond++;
        }
    }
    TEST_ASSERT_TRUE(told > 1000 && beyond > 1000);
}

/* A flat face square to the edge, the commonest case, and a corner beside
 * it: one closest point for both ends. */
static void test_cut_projects_a_common_point(void)
{
    double const on[3] = {0.25, 0, 0};
    double const beside[3] = {0.75, 0.5, -2};
    double const near[3] = {0.75, 0.5 + 1e-8, -2 - 1e-8};
    double const behind[3] = {-0.5, 1, 0};
    bvxi_cut_edge const e = unit_edge(behind, behind);

    assert_cut(on, on, BVX_EDGE_VECTOR, BVXI_CUT_VECTOR, 0.25);
    assert_cut(beside, beside, BVX_EDGE_VECTOR, BVXI_CUT_VECTOR, 0.75);
    assert_cut(beside, beside, BVX_EDGE_PAPER, BVXI_CUT_VECTOR, 0.75);
    {
        /* as far apart as rounding to f32 would put them */
        bvxi_cut_edge const same = unit_edge(beside, near);
        double t;
        TEST_ASSERT_EQUAL_INT32(BVXI_CUT_VECTOR, bvxi_find_cut(&same, BVX_EDGE_VECTOR, &t));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.75, t);
    }
    assert_cut(behind, behind, BVX_EDGE_VECTOR, BVXI_CUT_SCALAR,
               e.low_distance / (e.low_distance + e.high_distance));
    assert_cut(behind, behind, BVX_EDGE_PAPER, BVXI_CUT_SCALAR, 0.0);
}

static void test_cut_along_the_edge_takes_the_distances_or_the_inner_end(void)
{
    double const a[3] = {0.1, 0.5, 0}, b[3] = {0.9, 0.5, 0};
    bvxi_cut_edge e = unit_edge(a, b);
    double t;

    assert_cut(a, b, BVX_EDGE_VECTOR, BVXI_CUT_SCALAR, 0.5);
    assert_cut(a, b, BVX_EDGE_PAPER, BVXI_CUT_SCALAR, 1.0);
    e.high_inside = 0;
    TEST_ASSERT_EQUAL_INT32(BVXI_CUT_SCALAR, bvxi_find_cut(&e, BVX_EDGE_PAPER, &t));
    TEST_ASSERT_TRUE(t == 0.0);
}

/* A wall with one end of the edge in its face: the other end's closest point is where the edge leaves it. */
static void test_cut_from_an_end_on_the_surface_is_the_far_face(void)
{
    double const on[3] = {0, 0, 0}, far[3] = {0.6, 0, 0}, other[3] = {1, 0, 0};

    assert_cut(on, far, BVX_EDGE_TANGENT, BVXI_CUT_VECTOR, 0.6);
    assert_cut(far, other, BVX_EDGE_TANGENT, BVXI_CUT_VECTOR, 0.6);
    assert_cut(on, far, BVX_EDGE_VECTOR, BVXI_CUT_SCALAR, 0.0);
}

static void test_cut_beyond_the_ends(void)
{
    double const a[3] = {2, 1, 0}, b[3] = {2, -1, 0}, c[3] = {-3, 1, 0}, d[3] = {-3, -1, 0};
    bvxi_cut_edge const e = unit_edge(a, b);
    assert_cut(a, b, BVX_EDGE_VECTOR, BVXI_CUT_SCALAR, e.low_distance / (e.low_distance + e.high_distance));
    assert_cut(a, b, BVX_EDGE_PAPER, BVXI_CUT_SCALAR, 1.0);
    assert_cut(c, d, BVX_EDGE_PAPER, BVXI_CUT_SCALAR, 0.0);
}

/* Two flat facets that meet in a ridge or a groove: cut exactly where the solid's border is. */
static void test_tangent_is_exact_at_ridges_and_grooves(void)
{
    int ridges = 0, grooves = 0, beside = 0;

    for (int trial = 0; trial < 200000; trial++) {
        double n[2][3], on[3], foot[2][3], d[2][2], a[3], b[3], where[2];
        int const ridge = maker_below(&seed, 2);
        int inside[2], of[2];
        bvxi_cut_edge e;
        double t, expected;
        for (int k = 0; k < 2; k++) {
            double length = 0;
            for (int i = 0; i < 3; i++) n[k][i] = maker_between(&seed, -1, 1, 1 << 16);
            for (int i = 0; i < 3; i++) length += n[k][i] * n[k][i];
            for (int i = 0; i < 3; i++) n[k][i] /= sqrt(length);
        }
        for (int i = 0; i < 3; i++) on[i] = maker_between(&seed, -0.7, 0.7, 1 << 16) + (i == 0 ? 0.5 : 0);
        /* distances to both planes; inside: behind both (ridge), behind one (groove) */
        for (int end = 0; end < 2; end++) {
            for (int k = 0; k < 2; k++)
                d[end][k] = n[k][0] * (end - on[0]) - n[k][1] * on[1] - n[k][2] * on[2];
            inside[end] = ridge ? d[end][0] < 0 && d[end][1] < 0 : d[end][0] < 0 || d[end][1] < 0;
        }
        if (inside[0] == inside[1]) continue;
        /* the nearer facet whose foot lies on the solid's border; else the place is another kind */
        for (int end = 0; end < 2; end++) {
            of[end] = -1;
            for (int k = 0; k < 2; k++) {
                double q[3], other;
                for (int i = 0; i < 3; i++) q[i] = (i == 0 ? end : 0) - d[end][k] * n[k][i];
                other = n[1 - k][0] * (q[0] - on[0]) + n[1 - k][1] * (q[1] - on[1]) +
                        n[1 - k][2] * (q[2] - on[2]);
                if (ridge ? other > 0 : other < 0) continue;
                if (of[end] >= 0 && fabs(d[end][k]) >= fabs(d[end][of[end]])) continue;
                of[end] = k;
                memcpy(foot[end], q, sizeof q);
            }
        }
        if (of[0] < 0 || of[1] < 0 || of[0] == of[1] || fabs(d[0][of[0]]) < 1e-3 || fabs(d[1][of[1]]) < 1e-3)
            continue;
        memcpy(a, foot[0], sizeof a);
        memcpy(b, foot[1], sizeof b);
        for (int k = 0; k < 2; k++) where[k] = d[0][k] / (d[0][k] - d[1][k]);
        { /* the only place in the edge where the solid's border is passed */
            double const first = where[0] < where[1] ? where[0] : where[1];
            double const last = where[0] < where[1] ? where[1] : where[0];
            int const enters_late = ridge == inside[1];
            if (!(first >= 0)) expected = last;
            else if (!(last <= 1)) expected = first;
            else expected = enters_late ? last : first;
            if (fabs(expected) < 1e-6 || fabs(expected - 1) < 1e-6) continue;
        }
        e = unit_edge(a, b);
        e.high_inside = inside[1];
        TEST_ASSERT_EQUAL_INT32(BVXI_CUT_VECTOR, bvxi_find_cut(&e, BVX_EDGE_TANGENT, &t));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, expected, t);
        bvxi_find_cut(&e, BVX_EDGE_VECTOR, &t);
        beside += fabs(t - expected) > 0.01;
        ridges += ridge;
        grooves += !ridge;
    }
    TEST_ASSERT_TRUE(ridges > 1000 && grooves > 1000 && beside > 1000); /* where the line misses it */
}

/* Turned to another axis and stretched, an edge is cut at the same place. */
static void test_cut_is_the_same_along_every_axis_and_at_every_scale(void)
{
    for (int n = 0; n < 1000; n++) {
        double a[3], b[3], t, u;
        bvxi_cut_edge e, turned;
        int32_t by;
        double const scale = ldexp(1.0, maker_below(&seed, 400) - 200);
        for (int k = 0; k < 3; k++) {
            a[k] = maker_between(&seed, -1, 1, 1000);
            b[k] = maker_between(&seed, -1, 1, 1000) + (k == 0);
        }
        e = unit_edge(a, b);
        by = bvxi_find_cut(&e, BVX_EDGE_VECTOR, &t);
        for (int32_t axis = 0; axis < 3; axis++) {
            memset(&turned, 0, sizeof turned);
            turned.axis = axis;
            turned.high_inside = 1;
            turned.length = scale;
            turned.low_distance = e.low_distance * scale;
            turned.high_distance = e.high_distance * scale;
            for (int k = 0; k < 3; k++) {
                turned.low[(k + axis) % 3] = e.low[k] * scale;
                turned.high[(k + axis) % 3] = e.high[k] * scale;
            }
            TEST_ASSERT_EQUAL_INT32(by, bvxi_find_cut(&turned, BVX_EDGE_VECTOR, &u));
            TEST_ASSERT_TRUE(t == u);
        }
    }
}

/* Whatever the numbers are, the ratio is one. */
static void test_cut_is_always_a_ratio(void)
{
    static const double odd[] = {0.0,   -0.0,   1.0,      -1.0,      1e-320, 1e-200, 1e200,
                                 1e308, -1e308, INFINITY, -INFINITY, NAN,    0.3};

    for (int n = 0; n < 200000; n++) {
        bvxi_cut_edge e;
        double t;
        e.axis = maker_below(&seed, 3);
        e.high_inside = maker_below(&seed, 2);
        e.length = maker_below(&seed, 4) != 0 ? 1.0 : 1e-300;
        for (int k = 0; k < 3; k++) {
            e.low[k] = odd[maker_below(&seed, 13)];
            e.high[k] = odd[maker_below(&seed, 13)];
        }
        e.low_distance = fabs(odd[maker_below(&seed, 13)]);
        e.high_distance = fabs(odd[maker_below(&seed, 13)]);
        for (int32_t i = BVX_EDGE_VECTOR; i <= BVX_EDGE_TANGENT; i++) {
            bvxi_find_cut(&e, i, &t);
            TEST_ASSERT_TRUE(t >= 0.0 && t <= 1.0);
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_cut_has_the_right_sign);
    RUN_TEST(test_cut_is_the_plane_of_a_flat_surface);
    RUN_TEST(test_cut_is_nearest_to_the_line);
    RUN_TEST(test_cut_projects_a_common_point);
    RUN_TEST(test_cut_along_the_edge_takes_the_distances_or_the_inner_end);
    RUN_TEST(test_cut_from_an_end_on_the_surface_is_the_far_face);
    RUN_TEST(test_cut_beyond_the_ends);
    RUN_TEST(test_tangent_is_exact_at_ridges_and_grooves);
    RUN_TEST(test_cut_is_the_same_along_every_axis_and_at_every_scale);
    RUN_TEST(test_cut_is_always_a_ratio);
    return UNITY_END();
}
