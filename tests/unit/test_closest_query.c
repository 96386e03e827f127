/* test_closest_query.c - nearest points against looking at every triangle; features against exact
 * integers. */
#include "nearest/closest.h"
#include "mesh/view.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

static maker_mesh m;
static uint64_t seed;

void setUp(void)
{
    suite_open(0);
    seed = 5;
    maker_clear(&m);
}

void tearDown(void)
{
    maker_free(&m);
    suite_close();
}

static bvx_closest_point ask(const bvx_mesh_view *view, const double p[3])
{
    bvx_closest *closest = NULL;
    bvx_closest_point found;
    memset(&found, 0x55, sizeof found);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, view, &closest));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(ctx, closest, p, 1, &found));
    bvx_closest_free(ctx, closest);
    return found;
}

/* ---- Every triangle ---- */

static void corners_of(const bvx_mesh_view *v, uint64_t t, double c[3][3])
{
    uint32_t n[3];
    TEST_ASSERT_TRUE(bvxi_view_triangle(v, t, n));
    for (int k = 0; k < 3; k++) bvxi_view_position(v, n[k], c[k]);
}

/* The least (distance, number) over all triangles, each by itself, in the units of the mesh's power of
 * two. */
static void nearest_of_all(const bvx_mesh_view *v, double scale, const double point[3],
                           bvx_closest_point *best)
{
    double const p[3] = {point[0] * scale, point[1] * scale, point[2] * scale};
    double least = HUGE_VAL, c[3][3], q[3];

    for (uint64_t t = 0; t < v->triangle_count; t++) {
        corners_of(v, t, c);
        for (int k = 0; k < 9; k++) c[k / 3][k % 3] *= scale;
        double const d = bvxi_closest_on_triangle(p, (const double(*)[3])c, q);
        if (!(d < least)) continue;
        least = d;
        best->triangle = (uint32_t)t;
        best->distance = sqrt(d) / scale;
        for (int a = 0; a < 3; a++) best->position[a] = q[a] / scale;
    }
}

/* Weights, feature and position say the same. */
static void expect_place(const bvx_mesh_view *v, double scale, const bvx_closest_point *f)
{
    double c[3][3], sum = 0.0;
    int zeros = 0;

    TEST_ASSERT_TRUE(f->feature >= 0 && f->feature <= 6);
    corners_of(v, f->triangle, c);
    for (int k = 0; k < 3; k++) {
        TEST_ASSERT_TRUE(f->weight[k] >= 0.0 && f->weight[k] <= 1.0);
        sum += f->weight[k];
        zeros += f->weight[k] == 0.0;
    }
    TEST_ASSERT_DOUBLE_WITHIN(4e-16, 1.0, sum);
    TEST_ASSERT_EQUAL_INT(f->feature == 0 ? 0 : f->feature < 4 ? 1 : 2, zeros);
    if (f->feature >= 4) {
        TEST_ASSERT_TRUE(f->weight[f->feature - 4] == 1.0);
        for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(f->position[a] == c[f->feature - 4][a]);
    } else if (f->feature > 0)
        TEST_ASSERT_TRUE(f->weight[(f->feature + 1) % 3] == 0.0); /* the corner opposite the edge */
    for (int a = 0; a < 3; a++) {
        double const blend = f->weight[0] * c[0][a] + f->weight[1] * c[1][a] + f->weight[2] * c[2][a];
        TEST_ASSERT_DOUBLE_WITHIN(1e-14 / scale, f->position[a], blend);
    }
}

static int features_seen[7];

static void expect_nearest(const bvx_mesh_view *v, const double *points, int count)
{
    bvx_closest_point *const found = malloc((size_t)count * sizeof *found);
    double low[3], high[3], scale;
    bvx_closest *closest;

    TEST_ASSERT_NOT_NULL(found);
    memset(found, 0x55, (size_t)count * sizeof *found);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_bounds(ctx, "test", v, low, high));
    scale = bvxi_unit_scale(low, high);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, v, &closest));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(ctx, closest, points, (uint64_t)count, found));
    for (int i = 0; i < count; i++) {
        bvx_closest_point want;
        nearest_of_all(v, scale, points + 3 * i, &want);
        TEST_ASSERT_EQUAL_UINT32(want.triangle, found[i].triangle);
        TEST_ASSERT_TRUE(want.distance == found[i].distance);
        for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(want.position[a] == found[i].position[a]);
        expect_place(v, scale, &found[i]);
        features_seen[found[i].feature]++;
    }
    bvx_closest_free(ctx, closest);
    free(found);
}

static void make_mesh(int kind)
{
    static const double low[3] = {-9, -8, -7};
    static const double high[3] = {9, 8, 7};
    static const double centre[3] = {1, 2, 3};
    static const double radius[3] = {7, 6, 5};

    maker_clear(&m);
    if (kind == 0) maker_soup(&m, &seed, 60, low, high, 1000);
    if (kind == 1) maker_needles(&m, &seed, 60, low, high, 65536);
    if (kind == 2) maker_degenerate(&m, &seed, 60, low, high, 1);
    if (kind == 3) maker_star(&m, &seed, centre, radius, 0.2, 9, 14, 16);
    if (kind == 4) maker_box(&m, low, high);
    if (kind == 5) maker_soup(&m, &seed, 60, low, high, 1); /* many ties */
}

static void test_closest_equals_every_triangle(void)
{
    enum { POINTS = 150 };
    memset(features_seen, 0, sizeof features_seen);
    for (int kind = 0; kind < 6; kind++)
        for (int type = BVX_F32; type <= BVX_F64; type++) {
            double points[3 * POINTS];
            make_mesh(kind);
            bvx_mesh_view v = maker_view(&m);
            float *const floats = malloc(m.vertices * 12);
            TEST_ASSERT_NOT_NULL(floats);
            for (size_t i = 0; i < 3 * m.vertices; i++) floats[i] = (float)m.p[i];
            if (type == BVX_F32) v.positions = floats;
            v.position_type = (uint32_t)type;
            for (int i = 0; i < POINTS; i++) {
                const double *const corner = m.p + 3 * (size_t)maker_below(&seed, (int32_t)m.vertices);
                for (int a = 0; a < 3; a++)
                    points[3 * i + a] = i % 5 == 0   ? corner[a]
                                        : i % 5 == 1 ? maker_between(&seed, -12, 12, 1)
                                        : i % 5 == 2 ? maker_between(&seed, -12, 12, 9999)
                                        : i % 5 == 3 ? corner[a] + maker_between(&seed, -0.01, 0.01, 100000)
                                                     : maker_between(&seed, -400, 400, 7);
            }
            expect_nearest(&v, points, POINTS);
            free(floats);
        }
    for (int k = 0; k < 7; k++) TEST_ASSERT_TRUE(features_seen[k] > 20);
}

/* ---- Features, exactly ---- */

typedef struct ints {
    int64_t v[3];
} ints;

static ints minus(ints a, ints b)
{
    ints const d = {{a.v[0] - b.v[0], a.v[1] - b.v[1], a.v[2] - b.v[2]}};
    return d;
}

static int64_t dot(ints a, ints b)
{
    return a.v[0] * b.v[0] + a.v[1] * b.v[1] + a.v[2] * b.v[2];
}

static ints cross(ints a, ints b)
{
    ints const n = {{a.v[1] * b.v[2] - a.v[2] * b.v[1], a.v[2] * b.v[0] - a.v[0] * b.v[2],
                     a.v[0] * b.v[1] - a.v[1] * b.v[0]}};
    return n;
}

/* The feature of a triangle with area: the corner whose both edges lead away from p; the edge beside which p
 * lies, and between its ends; else the face. */
static int32_t exact_feature(ints p, const ints t[3])
{
    ints const n = cross(minus(t[1], t[0]), minus(t[2], t[0]));

    for (int32_t k = 0; k < 3; k++)
        if (dot(minus(p, t[k]), minus(t[(k + 1) % 3], t[k])) <= 0 &&
            dot(minus(p, t[k]), minus(t[(k + 2) % 3], t[k])) <= 0)
            return 4 + k;
    for (int32_t k = 0; k < 3; k++) {
        ints const a = t[k], b = t[(k + 1) % 3], e = minus(b, a);
        if (dot(cross(e, minus(p, a)), n) <= 0 && dot(minus(p, a), e) > 0 && dot(minus(p, b), e) < 0)
            return 1 + k;
    }
    return 0;
}

static void test_closest_reports_the_exact_feature(void)
{
    memset(features_seen, 0, sizeof features_seen);
    for (int round = 0; round < 4000; round++) {
        ints t[3], p;
        double q[3];
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) t[k].v[a] = maker_below(&seed, 13) - 6;
        for (int a = 0; a < 3; a++) p.v[a] = maker_below(&seed, 13) - 6, q[a] = (double)p.v[a];
        ints const n = cross(minus(t[1], t[0]), minus(t[2], t[0]));
        if (dot(n, n) == 0) continue;
        maker_clear(&m);
        for (int k = 0; k < 3; k++) maker_vertex(&m, (double)t[k].v[0], (double)t[k].v[1], (double)t[k].v[2]);
        maker_triangle(&m, 0, 1, 2);
        bvx_mesh_view const v = maker_view(&m);
        bvx_closest_point const f = ask(&v, q);
        TEST_ASSERT_EQUAL_INT32(exact_feature(p, t), f.feature);
        expect_place(&v, 0.125, &f);
        if (f.feature == 0) { /* exact weights are quotients of whole numbers */
            ints const ap = minus(p, t[0]), ab = minus(t[1], t[0]), ac = minus(t[2], t[0]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, (double)dot(cross(ap, ac), n) / (double)dot(n, n), f.weight[1]);
            TEST_ASSERT_DOUBLE_WITHIN(1e-14, (double)dot(cross(ab, ap), n) / (double)dot(n, n), f.weight[2]);
        }
        features_seen[f.feature]++;
    }
    for (int k = 0; k < 7; k++) TEST_ASSERT_TRUE(features_seen[k] > 50);
}

/* Points and segments written as triangles. */
static void test_closest_takes_triangles_without_area_as_segments_and_points(void)
{
    static const uint32_t corners[4][3] = {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}};
    static const double beside[3] = {1, 3, 0}, before[3] = {-2, 1, 0};
    static const double shares[4] = {1, 0.75, 0.75, 0.75}; /* of vertex 0 at the point beside */

    for (int i = 0; i < 4; i++) {
        double at_0 = 0.0;
        bvx_mesh_view v;
        bvx_closest_point f;
        maker_clear(&m);
        maker_vertex(&m, 0, 0, 0);
        maker_vertex(&m, 4, 0, 0);
        maker_triangle(&m, corners[i][0], corners[i][1], corners[i][2]);
        v = maker_view(&m);
        f = ask(&v, beside);
        for (int k = 0; k < 3; k++) at_0 += corners[i][k] == 0 ? f.weight[k] : 0.0;
        TEST_ASSERT_TRUE(at_0 == shares[i]);
        TEST_ASSERT_TRUE(f.distance == (i == 0 ? sqrt(10.0) : 3.0));
        TEST_ASSERT_TRUE(i == 0 ? f.feature == 4 : f.feature >= 1 && f.feature <= 3);
        expect_place(&v, 0.125, &f);
        f = ask(&v, before);
        TEST_ASSERT_TRUE(f.distance == sqrt(5.0) && f.position[0] == 0.0);
        TEST_ASSERT_EQUAL_INT32(i == 3 ? 5 : 4, f.feature); /* the first corner that lies there */
        expect_place(&v, 0.125, &f);
    }
}

/* ---- Ends of the range ---- */

static void test_closest_holds_for_points_far_away(void)
{
    static const double reaches[8] = {1e3, 1e9, 1e16, 1e40, 1e150, 1e200, 1e300, 1.7e308};

    make_mesh(3);
    bvx_mesh_view const v = maker_view(&m);
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 6; k++) {
            double p[3] = {1, 2, 3};
            p[k % 3] += k < 3 ? reaches[i] : -reaches[i];
            bvx_closest_point const f = ask(&v, p);
            double const along = fabs(p[k % 3] - f.position[k % 3]); /* across it is less than 20 */
            TEST_ASSERT_TRUE(f.distance >= along * (1 - 1e-15));
            TEST_ASSERT_TRUE(f.distance <= along * (1 + 1e-15) + 200 / along);
            TEST_ASSERT_TRUE(f.triangle < m.triangles);
            TEST_ASSERT_TRUE(fabs(f.position[0]) < 12 && fabs(f.position[1]) < 12 &&
                             fabs(f.position[2]) < 12);
            expect_place(&v, 0.0625, &f);
            if (i >= 3) TEST_ASSERT_EQUAL_UINT32(0, f.triangle); /* all tie */
        }
    double const beyond[3] = {1.7e308, 1.7e308, -1.7e308};
    TEST_ASSERT_TRUE(ask(&v, beyond).distance > 1.7e308); /* more than a double holds */
}

static void test_closest_scales_by_powers_of_two(void)
{
    static const double factors[4] = {0x1p1000, 0x1p-1000, 0x1p-300, 0x1p300};
    double points[30], whole[3 * 30];

    make_mesh(3);
    bvx_mesh_view v = maker_view(&m);
    size_t const n = 3 * m.vertices;
    double *const kept = malloc(n * sizeof *kept);
    TEST_ASSERT_NOT_NULL(kept);
    memcpy(kept, m.p, n * sizeof *kept);
    for (int i = 0; i < 30; i++) whole[i] = maker_between(&seed, -12, 12, 64);
    for (int f = 0; f < 4; f++) { /* a power of two changes nothing but the power of two */
        for (size_t i = 0; i < n; i++) m.p[i] = kept[i];
        bvx_closest_point want[10], got[10];
        bvx_closest *closest;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, &v, &closest));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(ctx, closest, whole, 10, want));
        bvx_closest_free(ctx, closest);
        for (size_t i = 0; i < n; i++) m.p[i] = kept[i] * factors[f];
        for (int i = 0; i < 30; i++) points[i] = whole[i] * factors[f];
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, &v, &closest));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(ctx, closest, points, 10, got));
        bvx_closest_free(ctx, closest);
        for (int i = 0; i < 10; i++) {
            TEST_ASSERT_EQUAL_UINT32(want[i].triangle, got[i].triangle);
            TEST_ASSERT_EQUAL_INT32(want[i].feature, got[i].feature);
            TEST_ASSERT_TRUE(want[i].distance * factors[f] == got[i].distance);
            TEST_ASSERT_EQUAL_MEMORY(want[i].weight, got[i].weight, sizeof want[i].weight);
            for (int a = 0; a < 3; a++)
                TEST_ASSERT_TRUE(want[i].position[a] * factors[f] == got[i].position[a]);
        }
    }
    double const p[3] = {3, 4, 0}; /* from a point of the usual size to a tiny mesh, last of all */
    for (size_t i = 0; i < n; i++) m.p[i] = kept[i] * 0x1p-1000;
    TEST_ASSERT_DOUBLE_WITHIN(1e-15, 5.0, ask(&v, p).distance);
    free(kept);
}

/* ---- Threads, life, refusals ---- */

static void test_closest_is_the_same_for_any_threads(void)
{
    enum { POINTS = 4000 };
    static double points[3 * POINTS];
    static bvx_closest_point one[POINTS], many[POINTS];
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_mesh_view v;
    make_mesh(3);
    v = maker_view(&m);
    for (int i = 0; i < 3 * POINTS; i++) points[i] = maker_between(&seed, -12, 12, 10);
    for (o.threads = 1; o.threads <= 8; o.threads++) {
        bvx_closest_point *const to = o.threads == 1 ? one : many;
        bvx_context *other;
        bvx_closest *closest;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &other));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(other, &v, &closest));
        memset(to, 0, sizeof one);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(other, closest, points, POINTS, to));
        if (o.threads > 1) TEST_ASSERT_EQUAL_MEMORY(one, many, sizeof one);
        bvx_closest_free(other, closest);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(other));
        bvx_context_destroy(other);
    }
    for (int i = 0; i < POINTS; i += 97) { /* and the same alone as in company */
        bvx_closest_point const f = ask(&v, points + 3 * i);
        TEST_ASSERT_EQUAL_MEMORY(&one[i], &f, sizeof f);
    }
}

/* Many points are put in order, in more than one batch: each answer is the
 * one that its point has only, with vectors and without. */
static void test_closest_does_not_depend_on_the_other_points(void)
{
    enum { POINTS = (1 << 16) + 500 };
    static double points[3 * POINTS];
    static bvx_closest_point found[2][POINTS];
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_mesh_view v;

    make_mesh(3);
    v = maker_view(&m);
    for (int i = 0; i < POINTS; i++)
        for (int a = 0; a < 3; a++)
            points[3 * i + a] = maker_between(&seed, -12, 12, 10) * (i % 7 == 0 ? 40.0 : 1.0);
    for (int a = 0; a < 3; a++) points[a] = 0x1p900; /* a box in which the others share a cell */

    for (int portable = 0; portable < 2; portable++) {
        bvx_context *other;
        bvx_closest *closest;

        o.cpu = portable ? BVX_CPU_PORTABLE : BVX_CPU_BEST;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &other));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(other, &v, &closest));
        memset(found, 0, portable ? 0 : sizeof found);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(other, closest, points, POINTS, found[portable]));
        for (int i = 0; i < POINTS; i += 9) {
            bvx_closest_point alone;

            memset(&alone, 0, sizeof alone);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(other, closest, points + 3 * i, 1, &alone));
            TEST_ASSERT_EQUAL_MEMORY(&alone, &found[portable][i], sizeof alone);
        }
        bvx_closest_free(other, closest);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(other));
        bvx_context_destroy(other);
    }
    TEST_ASSERT_EQUAL_MEMORY(found[0], found[1], sizeof found[0]);
}

static void test_closest_keeps_what_it_needs(void)
{
    static const double p[3] = {20, 0.5, 0.25};
    bvx_closest *closest;
    bvx_closest_point want, got;
    uint64_t used;

    make_mesh(3);
    bvx_mesh_view const v = maker_view(&m);
    want = ask(&v, p);
    memset(&got, 0x55, sizeof got);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, &v, &closest));
    memset(m.p, 0, m.vertices * 24);
    memset(m.t, 0xff, m.triangles * 12);
    used = bvx_memory_used(ctx);
    TEST_ASSERT_TRUE(used <= 108 * m.triangles + 1024); /* the head, and boxes of whole nodes */
    bvx_memory_reset_peak(ctx);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(ctx, closest, p, 1, &got));
    TEST_ASSERT_EQUAL_UINT64(used, bvx_memory_peak(ctx));
    TEST_ASSERT_TRUE(want.distance == got.distance && want.triangle == got.triangle);
    TEST_ASSERT_EQUAL_MEMORY(want.position, got.position, sizeof got.position);
    bvx_closest_free(ctx, closest);
    bvx_closest_free(ctx, NULL);
    bvx_closest_free(NULL, NULL);
}

static void expect_no_tree(const bvx_mesh_view *v, bvx_status status, const char *word)
{
    bvx_closest *closest = NULL;
    memset(&closest, 0x55, sizeof closest);
    TEST_ASSERT_EQUAL_INT32(status, bvx_closest_create(ctx, v, &closest));
    TEST_ASSERT_NULL(closest);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
}

static void test_closest_refuses_bad_meshes_and_points(void)
{
    double points[6] = {0, 0, 0, 1, 2, 3};
    bvx_closest_point found[2];
    bvx_closest *closest;
    bvx_mesh_view good, v;
    make_mesh(4);
    good = maker_view(&m);
    v = good, v.triangle_count = 0, expect_no_tree(&v, BVX_ERR_EMPTY, "no triangles");
    v = good, v.vertex_count = 7, expect_no_tree(&v, BVX_ERR_RANGE, "vertex index 7");
    v = good, v.reserved = 1, expect_no_tree(&v, BVX_ERR_ARGUMENT, "reserved");
    m.p[4] = nan("");
    expect_no_tree(&good, BVX_ERR_RANGE, "vertex 1 has y = nan");
    m.p[4] = -8;
    expect_no_tree(NULL, BVX_ERR_ARGUMENT, "mesh is NULL");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_create(NULL, &good, &closest));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_create(ctx, &good, NULL));

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, &good, &closest));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(ctx, closest, NULL, 0, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_find(NULL, closest, points, 2, found));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_find(ctx, NULL, points, 2, found));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "closest is NULL"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_find(ctx, closest, NULL, 2, found));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "points is NULL"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_find(ctx, closest, points, 2, NULL));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "found is NULL"));
    points[5] = HUGE_VAL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_closest_find(ctx, closest, points, 2, found));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "point 1 has z = inf"));
    points[1] = nan("");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_closest_find(ctx, closest, points, 2, found));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "point 0 has y = nan"));
    bvx_closest_free(ctx, closest);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_closest_equals_every_triangle);
    RUN_TEST(test_closest_reports_the_exact_feature);
    RUN_TEST(test_closest_takes_triangles_without_area_as_segments_and_points);
    RUN_TEST(test_closest_holds_for_points_far_away);
    RUN_TEST(test_closest_scales_by_powers_of_two);
    RUN_TEST(test_closest_is_the_same_for_any_threads);
    RUN_TEST(test_closest_does_not_depend_on_the_other_points);
    RUN_TEST(test_closest_keeps_what_it_needs);
    RUN_TEST(test_closest_refuses_bad_meshes_and_points);
    return UNITY_END();
}
