/* test_distance.c - closest points against looking at every triangle, distances of shapes that are known. */
#include "nearest/closest.h"
#include "mesh/view.h"
#include "tools/fault.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

static maker_mesh a, b;
static uint64_t seed;
static bvx_context_options one_thread;

void setUp(void)
{
    one_thread = suite_options(1, BVX_CPU_BEST);
    suite_open_with(&one_thread);
    seed = 9;
    maker_clear(&a);
    maker_clear(&b);
}

void tearDown(void)
{
    maker_free(&a);
    maker_free(&b);
    suite_close();
}

/* ---- The closest point of one triangle ---- */

static double distance_between(const double p[3], const double q[3])
{
    double s = 0.0;
    for (int k = 0; k < 3; k++) s += (p[k] - q[k]) * (p[k] - q[k]);
    return sqrt(s);
}

/* Least distance by halving: distance to a + x (b - a) + y (c - a) is convex in (x, y). */
static double search_triangle(const double p[3], const double t[3][3])
{
    double best = HUGE_VAL, centre[2] = {0.5, 0.5}, width = 0.5;

    while (width > 1e-9) {
        double next[2] = {centre[0], centre[1]};
        for (int i = -4; i <= 4; i++)
            for (int j = -4; j <= 4; j++) {
                double x = centre[0] + width * i / 4, y = centre[1] + width * j / 4, q[3], d;
                x = x < 0.0 ? 0.0 : x > 1.0 ? 1.0 : x;
                y = y < 0.0 ? 0.0 : y > 1.0 - x ? 1.0 - x : y;
                for (int k = 0; k < 3; k++)
                    q[k] = t[0][k] + x * (t[1][k] - t[0][k]) + y * (t[2][k] - t[0][k]);
                d = distance_between(p, q);
                if (d < best) {
                    best = d;
                    next[0] = x;
                    next[1] = y;
                }
            }
        centre[0] = next[0];
        centre[1] = next[1];
        width *= 0.6;
    }
    return best;
}

static void test_closest_on_triangle_equals_a_search(void)
{
    for (int round = 0; round < 300; round++) {
        double t[3][3], p[3], q[3], d;
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) t[i][k] = maker_between(&seed, -1.0, 1.0, round % 2 ? 1000 : 1);
        for (int k = 0; k < 3; k++) p[k] = maker_between(&seed, -2.0, 2.0, round % 2 ? 1000 : 2);
        if (round % 10 == 3) memcpy(t[1], t[0], sizeof t[0]); /* a segment */
        if (round % 20 == 3) memcpy(t[2], t[0], sizeof t[0]); /* a point */
        if (round % 10 == 5)                                  /* three points of a line */
            for (int k = 0; k < 3; k++) t[2][k] = t[0][k] + 0.25 * (t[1][k] - t[0][k]);
        d = sqrt(bvxi_closest_on_triangle(p, (const double(*)[3])t, q));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, search_triangle(p, (const double(*)[3])t), d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, distance_between(p, q), d);
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, search_triangle(q, (const double(*)[3])t));
    }
}

/* One point for each region, all distances whole numbers. */
static void test_closest_on_triangle_in_every_region(void)
{
    static const double t[3][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}};
    static const double cases[7][7] = {
        /* point, closest, squared distance */
        {-1, -2, 2, 0, 0, 0, 9}, {6, -1, 2, 4, 0, 0, 9}, {-1, 6, 2, 0, 4, 0, 9},  {2, -3, 4, 2, 0, 0, 25},
        {-3, 1, 4, 0, 1, 0, 25}, {4, 4, 0, 2, 2, 0, 8},  {1, 2, -5, 1, 2, 0, 25},
    };

    for (int i = 0; i < 7; i++) {
        double q[3];
        TEST_ASSERT_TRUE(bvxi_closest_on_triangle(cases[i], t, q) == cases[i][6]);
        for (int k = 0; k < 3; k++) TEST_ASSERT_TRUE(q[k] == cases[i][3 + k]);
    }
}

/* ---- The tree ---- */

static void expect_closest(const maker_mesh *m, uint32_t type, const double *points, int count)
{
    bvx_mesh_view v = maker_view(m);
    float *const floats = malloc(m->vertices * 12);
    bvxi_closest_tree tree;
    double low[3], high[3], scale;

    TEST_ASSERT_NOT_NULL(floats);
    for (size_t i = 0; i < 3 * m->vertices; i++) floats[i] = (float)m->p[i];
    if (type == BVX_F32) v.positions = floats;
    v.position_type = type;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_bounds(ctx, "test", &v, low, high));
    scale = bvxi_unit_scale(low, high);
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK, bvxi_closest_build(bvxi_call_of(ctx, NULL, "test", 0, 1), &v, low, high, scale, &tree));
    for (int i = 0; i < count; i++) {
        double p[3], best = HUGE_VAL, best_point[3] = {0, 0, 0};
        uint32_t best_triangle = UINT32_MAX;
        bvxi_closest found;
        for (int k = 0; k < 3; k++) p[k] = points[3 * i + k] * scale;
        for (uint32_t t = 0; t < m->triangles; t++) {
            double c[3][3], q[3], d;
            for (int k = 0; k < 3; k++) {
                bvxi_view_position(&v, m->t[3 * t + (uint32_t)k], c[k]);
                for (int x = 0; x < 3; x++) c[k][x] *= scale;
            }
            d = bvxi_closest_on_triangle(p, (const double(*)[3])c, q);
            if (d < best) {
                best = d;
                best_triangle = t;
                memcpy(best_point, q, sizeof q);
            }
        }
        bvxi_closest_find(&tree, p, (uint32_t)maker_random(&seed), &found);
        TEST_ASSERT_EQUAL_UINT32(best_triangle, found.triangle);
        TEST_ASSERT_EQUAL_MEMORY(&best, &found.distance2, sizeof best);
        TEST_ASSERT_EQUAL_MEMORY(best_point, found.point, sizeof best_point);
        TEST_ASSERT_EQUAL_UINT32(best_triangle, tree.order[found.place]);
    }
    bvxi_closest_free(ctx, &tree);
    free(floats);
}

enum { POINTS = 24 };

static void make_points(double points[POINTS * 3], double centre, double reach, int32_t steps)
{
    for (int i = 0; i < POINTS * 3; i++) points[i] = centre + maker_between(&seed, -reach, reach, steps);
}

/* Exactly the least distance and, among equals, the least number: soups of every size, many ties on whole
 * numbers, with triangles without area, near and far. */
static void test_the_tree_finds_what_a_loop_over_all_triangles_finds(void)
{
    double points[POINTS * 3];

    for (int round = 0; round < 60; round++) {
        int32_t const n = round < 24 ? 1 + round : 1 + maker_below(&seed, 400);
        int32_t const steps = round % 3 == 0 ? 1 : 256;
        double const offset = round % 4 == 1 ? 5e6 : 0.0;
        double const low[3] = {offset - 3, offset - 3, offset - 3};
        double const high[3] = {offset + 3, offset + 3, offset + 3};
        maker_clear(&a);
        maker_soup(&a, &seed, n, low, high, steps);
        if (round % 5 == 0) maker_degenerate(&a, &seed, 10, low, high, steps);
        if (round % 5 == 1) maker_needles(&a, &seed, 10, low, high, 256);
        make_points(points, offset, 5.0, steps);
        expect_closest(&a, BVX_F64, points, POINTS);
        expect_closest(&a, BVX_F32, points, POINTS);
        make_points(points, offset, round % 2 == 0 ? 1000.0 : 1e9, 1);
        expect_closest(&a, BVX_F64, points, 4);
    }
}

/* Points at corners, on edges and on faces, where several triangles are
 * nearest and all distances are rounding. */
static void test_the_tree_finds_the_least_number_on_the_surface_itself(void)
{
    for (int round = 0; round < 20; round++) {
        double const centre[3] = {1.0 / 3, round % 2 == 0 ? 0.1 : 77777.7, -0.7}, radius[3] = {1.1, 2.3, 0.9};
        double points[POINTS * 3];
        maker_clear(&a);
        maker_star(&a, &seed, centre, radius, 0.3, 12, 11, 1000);
        for (int i = 0; i < POINTS; i++) {
            const uint32_t *const t = &a.t[3 * maker_below(&seed, (int32_t)a.triangles)];
            double const x = maker_between(&seed, 0.0, 1.0, 1000);
            double const y = maker_between(&seed, 0.0, 1.0 - x, 1000);
            double const w[3] = {i % 3 == 0   ? 1.0
                                 : i % 3 == 1 ? 1.0 - x
                                              : 1.0 - x - y,
                                 i % 3 == 0 ? 0.0 : x, i % 3 == 2 ? y : 0.0};
            for (int k = 0; k < 3; k++)
                points[3 * i + k] = w[0] * a.p[3 * t[0] + (uint32_t)k] + w[1] * a.p[3 * t[1] + (uint32_t)k] +
                                    w[2] * a.p[3 * t[2] + (uint32_t)k];
        }
        expect_closest(&a, BVX_F64, points, POINTS);
        expect_closest(&a, BVX_F32, points, POINTS);
    }
}

/* Above the vertices of a flat net, six triangles are nearest by the same distance, which no float holds: a
 * box dropped too early would give another number than the least. */
static void test_the_tree_keeps_boxes_at_exactly_the_best_distance(void)
{
    enum { SIDE = 12 };
    for (int round = 0; round < 12; round++) {
        double const reach = round % 2 == 0 ? 4.0 : 400.0; /* distinguished in floats, in doubles */
        double points[POINTS * 3];
        maker_clear(&a);
        for (uint32_t y = 0; y < SIDE; y++)
            for (uint32_t x = 0; x < SIDE; x++) maker_vertex(&a, (double)x / 10, (double)y / 10, 0.0);
        for (uint32_t y = 0; y + 1 < SIDE; y++)
            for (uint32_t x = 0; x + 1 < SIDE; x++) {
                uint32_t const v = y * SIDE + x;
                maker_quad(&a, v, v + 1, v + SIDE + 1, v + SIDE, 0);
            }
        maker_shuffle_triangles(&a, &seed);
        for (int i = 0; i < POINTS; i++) {
            uint32_t const v = (uint32_t)maker_below(&seed, SIDE * SIDE);
            points[3 * i] = a.p[3 * v];
            points[3 * i + 1] = a.p[3 * v + 1];
            points[3 * i + 2] = reach * maker_between(&seed, 0.5, 1.0, 1000003);
        }
        expect_closest(&a, BVX_F64, points, POINTS);
    }
}

static void test_the_tree_holds_at_the_ends_of_doubles(void)
{
    static const double sizes[4] = {1e200, 1e-200, 1e306, 1e-306};
    double points[POINTS * 3];

    for (int i = 0; i < 4; i++) {
        double const low[3] = {-1, -1, -1}, high[3] = {1, 1, 1};
        maker_clear(&a);
        maker_soup(&a, &seed, 50, low, high, 1000);
        for (size_t k = 0; k < 3 * a.vertices; k++) a.p[k] *= sizes[i];
        make_points(points, 0.0, 2.0, 1000);
        for (int k = 0; k < POINTS * 3; k++) points[k] *= sizes[i];
        expect_closest(&a, BVX_F64, points, POINTS);
    }
}

/* ---- Distances ---- */

static bvx_distance_report measure_in(bvx_context *context, uint64_t samples, uint64_t from_seed)
{
    bvx_mesh_view const va = maker_view(&a), vb = maker_view(&b);
    bvx_distance_report r;

    memset(&r, 0xff, sizeof r);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_distance(context, &va, &vb, samples, from_seed, &r),
                                    bvx_last_message(context));
    TEST_ASSERT_EQUAL_UINT64(samples, r.samples);
    TEST_ASSERT_EQUAL_UINT64(from_seed, r.seed);
    TEST_ASSERT_TRUE(r.mean == (r.mean_a_to_b + r.mean_b_to_a) / 2);
    TEST_ASSERT_TRUE(r.max == (r.max_a_to_b > r.max_b_to_a ? r.max_a_to_b : r.max_b_to_a));
    return r;
}

static bvx_distance_report measure(uint64_t samples, uint64_t from_seed)
{
    return measure_in(ctx, samples, from_seed);
}

/* A rectangle in z = height + slope x, cut into two triangles of different size and one without area. */
static void make_square(maker_mesh *m, double side, double height, double slope, int turned)
{
    uint32_t const v = maker_vertex(m, 0, 0, height);

    maker_vertex(m, side, 0, height + slope * side);
    maker_vertex(m, side, side, height + slope * side);
    maker_vertex(m, 0, side, height);
    maker_vertex(m, side / 8, 0, height + slope * side / 8);
    maker_triangle(m, v, v + 4, v + 3);
    maker_triangle(m, v + 4, v + 2, v + 3);
    maker_triangle(m, v + 4, v + 1, v + 2);
    maker_triangle(m, v, v + 4, v + 1);
    if (turned) maker_flip(m, m->triangles - 4, m->triangles);
}

static void test_distance_of_parallel_squares_is_their_gap(void)
{
    bvx_distance_report r;

    make_square(&a, 2.0, 0.0, 0.0, 0);
    make_square(&b, 2.0, 0.75, 0.0, 0);
    r = measure(1000, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.75, r.max_a_to_b);
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 0.75, r.max_b_to_a);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 0.75, r.mean);
    TEST_ASSERT_TRUE(r.normal_a_to_b == 0.0 && r.normal_b_to_a == 0.0);
    maker_clear(&b);
    make_square(&b, 2.0, 0.75, 0.0, 1); /* turned over: the normals are opposite */
    r = measure(1000, 1);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 2.0, r.normal_a_to_b);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 2.0, r.normal_b_to_a);
}

/* The mean height of a slope is known only to points that are spread evenly over triangles of all sizes. */
static void test_samples_are_spread_by_area(void)
{
    double error = 0.0;

    for (uint64_t s = 0; s < 20; s++) {
        bvx_distance_report r;
        maker_clear(&a);
        maker_clear(&b);
        make_square(&a, 1.0, 0.0, 1.0, 0);
        make_square(&b, 8.0, 0.0, 0.0, 0);
        maker_shift(&b, 0, -4.0, -4.0, 0.0);
        r = measure(4000, s);
        TEST_ASSERT_DOUBLE_WITHIN(0.02, 0.5, r.mean_a_to_b); /* 4 deviations of 4000 independent points */
        TEST_ASSERT_TRUE(r.max_a_to_b > 0.97 && r.max_a_to_b <= 1.0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0 - sqrt(0.5), r.normal_a_to_b);
        error += r.mean_a_to_b - 0.5;
    }
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 0.0, error / 20);
}

/* The mean of a coordinate over this triangle is a third, for points spread evenly inside it. */
static void test_places_inside_a_triangle_are_uniform(void)
{
    bvx_distance_report r;

    maker_vertex(&a, 0, 0, 0);
    maker_vertex(&a, 1, 0, 0);
    maker_vertex(&a, 0, 1, 0);
    maker_triangle(&a, 0, 1, 2);
    maker_vertex(&b, 0, 0, 0); /* in the plane x = 0, below in y = 0 */
    maker_vertex(&b, 0, 9, 9);
    maker_vertex(&b, 0, -9, 9);
    maker_vertex(&b, 0, 0, -20);
    maker_triangle(&b, 1, 2, 3);
    r = measure(20000, 5);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 1.0 / 3, r.mean_a_to_b);
    for (size_t v = 0; v < b.vertices; v++) {
        double const y = b.p[3 * v + 1];
        b.p[3 * v + 1] = b.p[3 * v];
        b.p[3 * v] = y;
    }
    r = measure(20000, 5);
    TEST_ASSERT_DOUBLE_WITHIN(0.005, 1.0 / 3, r.mean_a_to_b);
}

static void test_distance_of_nested_boxes_differs_by_direction(void)
{
    double const low[3] = {-1, -1, -1}, high[3] = {1, 1, 1}, low2[3] = {-3, -3, -3}, high2[3] = {3, 3, 3};
    bvx_distance_report r;

    maker_box(&a, low, high);
    maker_box(&b, low2, high2);
    r = measure(20000, 3);
    TEST_ASSERT_DOUBLE_WITHIN(1e-14, 2.0, r.max_a_to_b);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2.0, r.mean_a_to_b);
    TEST_ASSERT_TRUE(r.max_b_to_a > 3.3 && r.max_b_to_a <= sqrt(12.0));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, r.normal_a_to_b);
}

static void test_a_mesh_has_no_distance_to_itself(void)
{
    double const centre[3] = {100, 200, 300}, radius[3] = {5, 6, 7};
    bvx_distance_report r;

    maker_star(&a, &seed, centre, radius, 0.2, 8, 9, 64);
    maker_star(&b, &seed, centre, radius, 0.0, 2, 3, 64);
    maker_clear(&b);
    for (size_t v = 0; v < a.vertices; v++) maker_vertex(&b, a.p[3 * v], a.p[3 * v + 1], a.p[3 * v + 2]);
    for (size_t t = 0; t < a.triangles; t++) maker_triangle(&b, a.t[3 * t], a.t[3 * t + 1], a.t[3 * t + 2]);
    maker_shuffle_triangles(&b, &seed);
    r = measure(5000, 8);
    TEST_ASSERT_TRUE(r.max < 1e-12);
    TEST_ASSERT_TRUE(r.normal_a_to_b < 1e-12 && r.normal_b_to_a < 1e-12);
}

/* The same shape far larger and far smaller: all numbers follow, none overflows. */
static void test_distances_scale_by_powers_of_two(void)
{
    double const centre[3] = {0, 0, 0}, radius[3] = {1, 2, 1}, wide[3] = {1.5, 2, 1};
    bvx_distance_report want, got;

    maker_star(&a, &seed, centre, radius, 0.1, 6, 7, 4096);
    maker_star(&b, &seed, centre, wide, 0.1, 5, 8, 4096);
    want = measure(500, 2);
    for (int e = -800; e <= 800; e += 400) {
        double const s = ldexp(1.0, e);
        for (size_t i = 0; i < 3 * a.vertices; i++) a.p[i] *= s;
        for (size_t i = 0; i < 3 * b.vertices; i++) b.p[i] *= s;
        got = measure(500, 2);
        for (size_t i = 0; i < 3 * a.vertices; i++) a.p[i] /= s;
        for (size_t i = 0; i < 3 * b.vertices; i++) b.p[i] /= s;
        TEST_ASSERT_TRUE(got.mean_a_to_b == want.mean_a_to_b * s && got.max_b_to_a == want.max_b_to_a * s);
        TEST_ASSERT_TRUE(got.normal_a_to_b == want.normal_a_to_b);
    }
}

static void backwards(void *user, int32_t count, bvx_task_fn *task, void *task_user)
{
    (void)user;
    for (int32_t i = count - 1; i >= 0; i--) task(task_user, i, i % 3);
}

static void make_stars(void)
{
    double const centre[3] = {1, 2, 3}, radius[3] = {5, 6, 7};
    maker_star(&a, &seed, centre, radius, 0.2, 70, 80, 1024);
    maker_star(&b, &seed, centre, radius, 0.1, 20, 30, 1024);
}

static void test_threads_and_the_order_of_tasks_do_not_show(void)
{
    bvx_distance_report want, got;
    bvx_context_options o = one_thread;
    bvx_context *other;

    make_stars();
    /* Then each triangle twice: pairs of one place on the curve, also where a task's share of them ends. */
    for (int doubled = 0; doubled < 2; doubled++) {
        size_t const triangles = a.triangles;

        for (size_t t = 0; doubled && t < triangles; t++) maker_duplicate(&a, t);
        want = measure(3000, 4);
        for (int32_t threads = 2; threads <= 5; threads++) {
            o.threads = threads;
            o.parallel.call = threads == 3 ? backwards : NULL;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &other));
            got = measure_in(other, 3000, 4);
            bvx_context_destroy(other);
            TEST_ASSERT_EQUAL_MEMORY(&want, &got, sizeof got);
        }
    }
    got = measure(3000, 5);
    TEST_ASSERT_TRUE(got.mean_a_to_b != want.mean_a_to_b); /* another seed, other points */
}

/* Triangles, their corners and vertices in any order: also among many in
 * one place of the curve, some twice, turned or without area. */
static void test_order_does_not_show(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {5, 5, 5}, far_away[3] = {4e5, 4e5, 4e5};
    bvx_distance_report want, got;

    for (int way = 0; way < 4; way++) {
        make_stars();
        if (way != 0) {
            maker_clear(&a);
            maker_soup(&a, &seed, 300, low, high, 1);
            maker_degenerate(&a, &seed, 100, low, high, 1);
            for (size_t t = 0; t < 60; t++) maker_duplicate(&a, 3 * t);
            maker_flip(&a, 20, 60);
        }
        if (way == 2) /* all in one place of the curve, beside one that is far off */
            for (int i = 0; i < 3; i++) maker_vertex(&a, far_away[0] + i, far_away[1] + i * i, far_away[2]);
        if (way == 2)
            maker_triangle(&a, (uint32_t)a.vertices - 3, (uint32_t)a.vertices - 2, (uint32_t)a.vertices - 1);
        want = measure(3000, 4);
        TEST_ASSERT_TRUE(want.mean > 0);
        for (int trial = 0; trial < 5; trial++) {
            maker_shuffle_triangles(&a, &seed);
            maker_shuffle_vertices(&a, &seed);
            maker_shuffle_triangles(&b, &seed);
            got = measure(3000, 4);
            TEST_ASSERT_EQUAL_MEMORY(&want, &got, sizeof got);
        }
    }
}

static void test_distance_golden(void) /* two numbers, the same for every compiler and processor */
{
    bvx_distance_report r;
    uint64_t bits[2];

    make_stars();
    r = measure(2000, 7);
    memcpy(&bits[0], &r.mean, 8);
    memcpy(&bits[1], &r.normal_b_to_a, 8);
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x3FCBBD4DA855AFA2), bits[0]);
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x3FE9C8BACD31D367), bits[1]);
}

/* ---- Refusals and failures ---- */

static void refuse(const bvx_mesh_view *va, const bvx_mesh_view *vb, uint64_t samples, bvx_status status,
                   const char *word)
{
    bvx_distance_report r, zero;
    memset(&zero, 0, sizeof zero);
    memset(&r, 0xff, sizeof r);
    TEST_ASSERT_EQUAL_INT32(status, bvx_mesh_distance(ctx, va, vb, samples, 0, &r));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_MEMORY(&zero, &r, sizeof r);
}

static void test_distance_refuses_bad_meshes_and_samples(void)
{
    bvx_mesh_view va, vb, v;
    bvx_distance_report r;

    make_square(&a, 1.0, 0.0, 0.0, 0);
    make_square(&b, 1.0, 1.0, 0.0, 0);
    va = maker_view(&a);
    vb = maker_view(&b);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_distance(NULL, &va, &vb, 1, 0, &r));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_distance(ctx, &va, &vb, 1, 0, NULL));
    refuse(NULL, &vb, 1, BVX_ERR_ARGUMENT, "mesh a");
    refuse(&va, NULL, 1, BVX_ERR_ARGUMENT, "mesh b");
    refuse(&va, &vb, 0, BVX_ERR_ARGUMENT, "samples is 0");
    refuse(&va, &vb, UINT64_C(1) << 31, BVX_ERR_ARGUMENT, "samples is 2147483648");
    v = vb, v.triangle_count = 0, refuse(&va, &v, 1, BVX_ERR_EMPTY, "mesh b");
    v = va, v.vertex_count = 4, refuse(&v, &vb, 1, BVX_ERR_RANGE, "vertex index 4");
    v = vb, v.position_type = 9, refuse(&va, &v, 1, BVX_ERR_ARGUMENT, "position_type");
    b.p[4] = HUGE_VAL;
    refuse(&va, &vb, 1, BVX_ERR_RANGE, "vertex 1 has y");
    b.p[4] = 0.0;
    for (size_t i = 0; i < b.vertices; i++) b.p[3 * i] = 0.0; /* no area is left */
    refuse(&va, &vb, 1, BVX_ERR_EMPTY, "mesh b");
    refuse(&vb, &va, 1, BVX_ERR_EMPTY, "mesh a");
}

static bvx_status measure_some(void *user, bvx_context *context)
{
    bvx_mesh_view const va = maker_view(&a), vb = maker_view(&b);
    bvx_distance_report r;
    (void)user;
    return bvx_mesh_distance(context, &va, &vb, 300, 1, &r);
}

static void test_every_allocation_may_fail_and_every_progress_call_may_cancel(void)
{
    double const centre[3] = {1, 2, 3}, radius[3] = {5, 6, 7};
    uint64_t allocations = 0, calls = 0;

    maker_star(&a, &seed, centre, radius, 0.2, 10, 10, 1024);
    maker_star(&b, &seed, centre, radius, 0.1, 5, 8, 1024);
    TEST_ASSERT_NULL(fault_every_allocation(measure_some, NULL, &one_thread, &allocations));
    TEST_ASSERT_EQUAL_UINT64(14, allocations);
    TEST_ASSERT_NULL(fault_every_cancel(measure_some, NULL, &one_thread, &calls));
    TEST_ASSERT_TRUE(calls >= 6);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_closest_on_triangle_equals_a_search);
    RUN_TEST(test_closest_on_triangle_in_every_region);
    RUN_TEST(test_the_tree_finds_what_a_loop_over_all_triangles_finds);
    RUN_TEST(test_the_tree_finds_the_least_number_on_the_surface_itself);
    RUN_TEST(test_the_tree_keeps_boxes_at_exactly_the_best_distance);
    RUN_TEST(test_the_tree_holds_at_the_ends_of_doubles);
    RUN_TEST(test_distance_of_parallel_squares_is_their_gap);
    RUN_TEST(test_samples_are_spread_by_area);
    RUN_TEST(test_places_inside_a_triangle_are_uniform);
    RUN_TEST(test_distance_of_nested_boxes_differs_by_direction);
    RUN_TEST(test_a_mesh_has_no_distance_to_itself);
    RUN_TEST(test_distances_scale_by_powers_of_two);
    RUN_TEST(test_threads_and_the_order_of_tasks_do_not_show);
    RUN_TEST(test_order_does_not_show);
    RUN_TEST(test_distance_golden);
    RUN_TEST(test_distance_refuses_bad_meshes_and_samples);
    RUN_TEST(test_every_allocation_may_fail_and_every_progress_call_may_cancel);
    return UNITY_END();
}
