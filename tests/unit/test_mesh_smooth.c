/* test_mesh_smooth.c - smoothing against its definition by a plain loop, what it keeps: slow waves, volumes, borders, sharp edges,
 * seams, freedom of crossings; threads, types of positions, refusals. */
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

enum { MOST = 4000, AROUND = 48, TUBE = 24 };

static maker_mesh mesh;
static uint64_t seed;
static double out[3 * MOST], other[3 * MOST];
static float floats[3 * MOST];

void setUp(void)
{
    suite_open(0);
    maker_clear(&mesh);
    seed = 5;
}

void tearDown(void)
{
    maker_free(&mesh);
    suite_close();
}

static void smooth(const bvx_smooth_options *o)
{
    bvx_mesh_view const view = maker_view(&mesh);
    TEST_ASSERT_TRUE(mesh.vertices <= MOST);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_smooth(ctx, &view, o, out), bvx_last_message(ctx));
}

/* A torus, or one of its strips, whose vertices lie up to noise off along the axis of each tube. */
static void make_torus(double noise, int open)
{
    double const turn = 8.0 * atan(1.0);
    int const rows = open ? AROUND - 1 : AROUND;

    for (int i = 0; i < AROUND; i++)
        for (int k = 0; k < TUBE; k++) {
            double const a = turn * i / AROUND, b = turn * k / TUBE,
                         r = 1.0 + maker_between(&seed, -noise, noise, 1000);
            maker_vertex(&mesh, (3 + r * cos(b)) * cos(a), (3 + r * cos(b)) * sin(a), r * sin(b));
        }
    for (int i = 0; i < rows; i++)
        for (int k = 0; k < TUBE; k++) {
            int const j = (i + 1) % AROUND, l = (k + 1) % TUBE;
            maker_quad(&mesh, (uint32_t)(i * TUBE + k), (uint32_t)(j * TUBE + k), (uint32_t)(j * TUBE + l),
                       (uint32_t)(i * TUBE + l), 0);
        }
}

/* Mean distance of positions from the torus. */
static double roughness(const double *p)
{
    double sum = 0.0;
    for (size_t v = 0; v < mesh.vertices; v++, p += 3) {
        double const x = sqrt(p[0] * p[0] + p[1] * p[1]) - 3.0;
        sum += fabs(sqrt(x * x + p[2] * p[2]) - 1.0);
    }
    return sum / (double)mesh.vertices;
}

/* One step towards the mean of all neighbours, by looking at every triangle for every vertex. */
static void plain_step(double *p, double factor)
{
    static double next[3 * MOST];
    static uint8_t seen[MOST];

    for (uint32_t v = 0; v < mesh.vertices; v++) {
        double sum[3] = {0, 0, 0};
        int count = 0;
        memset(seen, 0, sizeof seen);
        for (size_t t = 0; t < mesh.triangles; t++) {
            const uint32_t *const c = mesh.t + 3 * t;
            for (int k = 0; k < 3; k++)
                for (int l = 0; l < 3 && c[k] == v; l++)
                    if (c[l] != v && !seen[c[l]]++) {
                        count++;
                        for (uint32_t a = 0; a < 3; a++) sum[a] += p[3 * c[l] + a];
                    }
        }
        for (uint32_t a = 0; a < 3; a++)
            next[3 * v + a] = p[3 * v + a] + factor * (sum[a] / count - p[3 * v + a]);
    }
    memcpy(p, next, sizeof next);
}

static void test_smooth_taubin_is_what_it_says(void)
{
    bvx_smooth_options const o = {
        .struct_size = sizeof o, .method = BVX_SMOOTH_TAUBIN, .iterations = 3, .pass_band = 0.2};

    make_torus(0.1, 0);
    memcpy(other, mesh.p, 24 * mesh.vertices);
    for (int i = 0; i < 3; i++) {
        plain_step(other, 0.5);
        plain_step(other, 1.0 / (0.2 - 2.0));
    }
    smooth(&o);
    for (size_t i = 0; i < 3 * mesh.vertices; i++) TEST_ASSERT_DOUBLE_WITHIN(1e-12, other[i], out[i]);
}

/* T_n(I - K / 2) by its recurrence on whole meshes, weights by the C library's functions. */
static void test_smooth_sinc_is_what_it_says(void)
{
    enum { STEPS = 7 };
    static double now[3 * MOST], before[3 * MOST], keep[3 * MOST];
    double const pi = 4.0 * atan(1.0), band = 0.3, cut = acos(1.0 - band / 2);
    double const angle = cut + fmin(3.3 * pi / (2 * STEPS + 1), 0.5 * (pi - cut));
    bvx_smooth_options const o = {.struct_size = sizeof o, .iterations = STEPS, .pass_band = band};
    double total = angle;

    make_torus(0.1, 0);
    size_t const n = 3 * mesh.vertices;
    memcpy(before, mesh.p, n * 8);
    memcpy(now, mesh.p, n * 8);
    plain_step(now, 0.5);
    for (size_t i = 0; i < n; i++) other[i] = angle * before[i];
    for (int k = 1; k <= STEPS; k++) {
        double const weight = 2 * sin(k * angle) / k * (0.54 + 0.46 * cos(k * pi / (STEPS + 1)));
        total += weight;
        for (size_t i = 0; i < n; i++) other[i] += weight * now[i];
        memcpy(keep, now, n * 8);
        plain_step(now, 0.5);
        for (size_t i = 0; i < n; i++) {
            now[i] = 2 * now[i] - before[i];
            before[i] = keep[i];
        }
    }
    smooth(&o);
    for (size_t i = 0; i < n; i++) TEST_ASSERT_DOUBLE_WITHIN(1e-9, other[i] / total, out[i]);
}

static void test_smooth_takes_noise_and_keeps_volume(void)
{
    for (int32_t method = 0; method < 2; method++) {
        bvx_smooth_report r;
        bvx_smooth_options const o = {.struct_size = sizeof o, .method = method, .report = &r};
        tearDown();
        setUp();
        make_torus(0.06, 0);
        smooth(&o);
        TEST_ASSERT_TRUE(roughness(out) < (method == BVX_SMOOTH_SINC ? 0.35 : 0.5) * roughness(mesh.p));
        TEST_ASSERT_TRUE(fabs(r.volume_after / r.volume_before - 1.0) <
                         (method == BVX_SMOOTH_SINC ? 0.01 : 0.03));
        TEST_ASSERT_TRUE(r.largest_move > 0.01 && r.largest_move < 0.2 && r.held == 0 && r.undone == 0);

        /* Without noise there is nothing to do. */
        tearDown();
        setUp();
        make_torus(0.0, 0);
        smooth(&o);
        TEST_ASSERT_TRUE(fabs(r.volume_after / r.volume_before - 1.0) <
                         (method == BVX_SMOOTH_SINC ? 0.01 : 0.03));
    }
}

static void test_smooth_holds_borders_or_moves_along_them(void)
{
    bvx_smooth_report r;
    bvx_smooth_options o = {.struct_size = sizeof o, .hold_border = 1, .report = &r};
    size_t const last = 3 * (size_t)(AROUND - 1) * TUBE;

    make_torus(0.06, 1);
    smooth(&o);
    TEST_ASSERT_EQUAL_MEMORY(mesh.p, out, 24 * TUBE);
    TEST_ASSERT_EQUAL_MEMORY(mesh.p + last, out + last, 24 * TUBE);
    TEST_ASSERT_EQUAL_UINT64(2 * TUBE, r.held);
    o.hold_border = 0;
    smooth(&o);
    TEST_ASSERT_EQUAL_UINT64(0, r.held);
    for (int k = 0; k < TUBE;
         k++) { /* the first ring is in the plane y = 0, so are its neighbours along it */
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, out[3 * k + 1]);
        TEST_ASSERT_TRUE(out[3 * k] != mesh.p[3 * k]);
    }
}

static void test_smooth_holds_sharp_edges(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    bvx_smooth_report r;
    bvx_smooth_options o = {.struct_size = sizeof o, .sharp_angle = 89.0, .report = &r};

    maker_box(&mesh, low, high);
    smooth(&o);
    TEST_ASSERT_EQUAL_MEMORY(mesh.p, out, 24 * mesh.vertices);
    TEST_ASSERT_EQUAL_UINT64(8, r.held);
    TEST_ASSERT_TRUE(r.volume_after == r.volume_before && r.largest_move == 0.0);
    o.sharp_angle = 91.0;
    smooth(&o);
    TEST_ASSERT_EQUAL_UINT64(0, r.held);
    TEST_ASSERT_TRUE(r.volume_after < 0.99 * r.volume_before);

    /* A triangle that faces the other way turns by nothing. */
    uint32_t const swapped = mesh.t[1];
    mesh.t[1] = mesh.t[2];
    mesh.t[2] = swapped;
    o.sharp_angle = 91.0;
    smooth(&o);
    TEST_ASSERT_EQUAL_UINT64(0, r.held);
}

/* Three sheets that meet along a bent line: its inner vertices follow the line's, its ends stay. */
static void test_smooth_along_seams_of_sheets(void)
{
    bvx_smooth_options const o = {.struct_size = sizeof o, .iterations = 1, .method = BVX_SMOOTH_TAUBIN};

    for (int i = 0; i < 5; i++) maker_vertex(&mesh, i, 0, i == 2);
    for (int s = 0; s < 3; s++)
        for (int i = 0; i < 5; i++) maker_vertex(&mesh, i, s - 1.0, s == 1 ? 2 : 0);
    for (uint32_t s = 1; s < 4; s++)
        for (uint32_t i = 0; i < 4; i++) maker_quad(&mesh, i, i + 1, 5 * s + i + 1, 5 * s + i, 0);
    smooth(&o);
    for (uint32_t v = 1; v < 4; v++) {
        TEST_ASSERT_TRUE(out[3 * v + 1] == 0.0);
        TEST_ASSERT_TRUE(out[3 * v + 2] != mesh.p[3 * v + 2]);
    }
    TEST_ASSERT_EQUAL_MEMORY(mesh.p, out, 24);
    TEST_ASSERT_EQUAL_MEMORY(mesh.p + 12, out + 12, 24);
}

enum { PAIRS = 40000 };

/* Pairs of triangles that cross in out and not in the mesh. */
static int fresh_crossings(void)
{
    static uint32_t own[2 * PAIRS], found[2 * PAIRS];
    bvx_mesh_view view = maker_view(&mesh);
    uint64_t owns, count, k = 0;
    int fresh = 0;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &view, &owns, own, PAIRS));
    view.positions = out;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &view, &count, found, PAIRS));
    TEST_ASSERT_TRUE(owns > 0);
    for (uint64_t i = 0; i < count; i++) {
        while (k < owns && (own[2 * k] < found[2 * i] ||
                            (own[2 * k] == found[2 * i] && own[2 * k + 1] < found[2 * i + 1])))
            k++;
        fresh += k == owns || own[2 * k] != found[2 * i] || own[2 * k + 1] != found[2 * i + 1];
    }
    return fresh;
}

/* A coarse box close around a torus would shrink into it; triangles that cross everything already may go on to. */
static void test_smooth_adds_no_crossings(void)
{
    bvx_smooth_report r;
    bvx_smooth_options o = {.struct_size = sizeof o, .pass_band = 0.01, .iterations = 2, .report = &r};
    static const double low[3] = {-4.3, -4.3, -1.3}, high[3] = {4.3, 4.3, 1.3};

    make_torus(0.05, 0);
    maker_box(&mesh, low, high);
    maker_soup(&mesh, &seed, 30, low, high, 1000);
    smooth(&o);
    TEST_ASSERT_TRUE(fresh_crossings() > 0);
    o.no_crossings = 1;
    smooth(&o);
    TEST_ASSERT_EQUAL_INT(0, fresh_crossings());
    TEST_ASSERT_TRUE(r.undone > 0 && r.largest_move > 0.01);
}

/* Triangles with vertices of their own stay together, and unused vertices stay. */
static void test_smooth_keeps_seams_closed(void)
{
    bvx_smooth_options const o = {.struct_size = sizeof o, .pass_band = 0.3, .iterations = 5};
    static double corners[9 * MOST], smoothed[9 * MOST];

    make_torus(0.05, 0);
    maker_vertex(&mesh, 9, 9, -0.0);
    smooth(&o);
    TEST_ASSERT_EQUAL_MEMORY(mesh.p + 3 * (mesh.vertices - 1), out + 3 * (mesh.vertices - 1), 24);
    TEST_ASSERT_TRUE(mesh.triangles <= MOST);
    for (size_t i = 0; i < 3 * mesh.triangles; i++) memcpy(corners + 3 * i, mesh.p + 3 * mesh.t[i], 24);
    bvx_mesh_view const soup = {.positions = corners,
                                .position_type = BVX_F64,
                                .vertex_count = 3 * mesh.triangles,
                                .triangle_count = mesh.triangles};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_smooth(ctx, &soup, &o, smoothed), bvx_last_message(ctx));
    for (size_t i = 0; i < 3 * mesh.triangles; i++)
        for (uint32_t a = 0; a < 3; a++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, out[3 * mesh.t[i] + a], smoothed[3 * i + a]);
}

static void test_smooth_threads_and_types(void)
{
    static const double moved[12] = {2, 0, 0, 10, 0, 2, 0, 20, 0, 0, 2, 30};
    bvx_smooth_options const o = {.struct_size = sizeof o, .no_crossings = 1};
    bvx_context *const three = suite_context(3, 0);

    make_torus(0.05, 0);
    smooth(&o);
    bvx_mesh_view view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_smooth(three, &view, &o, other));
    TEST_ASSERT_EQUAL_MEMORY(out, other, 24 * mesh.vertices);
    bvx_context_destroy(three);

    view.transform = moved;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_smooth(ctx, &view, &o, other));
    for (size_t i = 0; i < 3 * mesh.vertices; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, 2 * out[i] + 10.0 * (double)(i % 3 + 1), other[i]);

    static float given[3 * MOST];
    for (size_t i = 0; i < 3 * mesh.vertices; i++) given[i] = (float)mesh.p[i];
    view = maker_view(&mesh);
    view.positions = given;
    view.position_type = BVX_F32;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_smooth(ctx, &view, &o, floats));
    for (size_t i = 0; i < 3 * mesh.vertices; i++) TEST_ASSERT_FLOAT_WITHIN(1e-6f, (float)out[i], floats[i]);
}

static void test_smooth_refuses(void)
{
    bvx_smooth_options o = {.struct_size = sizeof o};
    bvx_mesh_view view;

    make_torus(0.0, 0);
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_smooth(NULL, &view, &o, out));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_smooth(ctx, NULL, &o, out));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_smooth(ctx, &view, &o, NULL));
    o.pass_band = 1.5;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_mesh_smooth(ctx, &view, &o, out));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "pass_band"));
    view.triangle_count = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_mesh_smooth(ctx, &view, NULL, out));
    mesh.p[4] = NAN;
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_mesh_smooth(ctx, &view, NULL, out));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_smooth_taubin_is_what_it_says);
    RUN_TEST(test_smooth_sinc_is_what_it_says);
    RUN_TEST(test_smooth_takes_noise_and_keeps_volume);
    RUN_TEST(test_smooth_holds_borders_or_moves_along_them);
    RUN_TEST(test_smooth_holds_sharp_edges);
    RUN_TEST(test_smooth_along_seams_of_sheets);
    RUN_TEST(test_smooth_adds_no_crossings);
    RUN_TEST(test_smooth_keeps_seams_closed);
    RUN_TEST(test_smooth_threads_and_types);
    RUN_TEST(test_smooth_refuses);
    return UNITY_END();
}
