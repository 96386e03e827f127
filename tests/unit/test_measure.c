/* test_measure.c - volume, centre of mass and inertia of analytic bodies, whole and spoilt, against the integrals
 * of what they were before; bounds that hold at three resolutions; order, threads, scale and refusals. */
#include "tools/defect_maker.h"
#include "suite.h"

#include <math.h>

static defect_shape shape;
static uint64_t seed;

typedef struct truth {
    double volume, center[3], inertia[6];
} truth;

void setUp(void)
{
    suite_open(1);
    memset(&shape, 0, sizeof shape);
    seed = 41;
}

void tearDown(void)
{
    defect_end(&shape);
    suite_close();
}

/* ---- Bodies ---- */

enum { BOX, BALL, TORUS, CYLINDER, BODIES };
static const char *const body_names[BODIES] = {"box", "ball", "torus", "cylinder"};

static uint32_t ring_vertex(int u, int v, int around, int across)
{
    return (uint32_t)(u % around * across + v % across);
}

static void add_torus(maker_mesh *m, double large, double small, int around, int across)
{
    for (int u = 0; u < around; u++)
        for (int v = 0; v < across; v++) {
            double const s = 2 * DEFECT_PI * u / around, t = 2 * DEFECT_PI * v / across;
            double const reach = large + small * cos(t);
            maker_vertex(m, 8 + reach * cos(s), 7 + reach * sin(s), 9 + small * sin(t));
        }
    for (int u = 0; u < around; u++)
        for (int v = 0; v < across; v++) {
            uint32_t const a = ring_vertex(u, v, around, across), b = ring_vertex(u + 1, v, around, across);
            uint32_t const c = ring_vertex(u, v + 1, around, across);
            uint32_t const d = ring_vertex(u + 1, v + 1, around, across);
            maker_triangle(m, a, b, d);
            maker_triangle(m, a, d, c);
        }
}

static void add_cylinder(maker_mesh *m, double radius, double height, int around, int rings)
{
    uint32_t low, high;

    for (int k = 0; k <= rings; k++)
        for (int u = 0; u < around; u++) {
            double const s = 2 * DEFECT_PI * u / around;
            maker_vertex(m, 5 + radius * cos(s), 6 + radius * sin(s), 2 + height * k / rings);
        }
    low = maker_vertex(m, 5, 6, 2);
    high = maker_vertex(m, 5, 6, 2 + height);
    for (int u = 0; u < around; u++) {
        uint32_t const next = (uint32_t)((u + 1) % around), top = (uint32_t)(rings * around);
        maker_triangle(m, low, next, (uint32_t)u);
        maker_triangle(m, high, top + (uint32_t)u, top + next);
        for (int k = 0; k < rings; k++) {
            uint32_t const row = (uint32_t)(k * around), a = row + (uint32_t)u, b = row + next;
            maker_triangle(m, a, b, b + (uint32_t)around);
            maker_triangle(m, a, b + (uint32_t)around, a + (uint32_t)around);
        }
    }
}

/* Faces of a box as squares of squares, so that a fifth of its triangles is a fifth of its surface. */
static void add_box(maker_mesh *m, const int32_t n[3], double side)
{
    static const double at[3] = {3.25, 4.5, 6.75};
    uint8_t solid[1000];

    memset(solid, 1, sizeof solid);
    maker_cubes(m, &seed, solid, n, at);
    for (size_t i = 0; i < 3 * m->vertices; i++) m->p[i] *= side;
}

static void make_body(int body)
{
    static const int32_t box[3] = {9, 7, 5};
    static const double centre[3] = {8.25, 7, 9}, radius[3] = {4, 4, 4};
    maker_mesh *const m = &shape.mesh;

    maker_clear(m);
    if (body == BOX) add_box(m, box, 0.75);
    if (body == BALL) maker_star(m, &seed, centre, radius, 0, 14, 20, 65536);
    if (body == TORUS) add_torus(m, 3, 1, 30, 14);
    if (body == CYLINDER) add_cylinder(m, 1.5, 7, 24, 12);
    shape.voxel = 8.0 / 128;
}

/* Tetrahedra from a far point to all triangles, by the formula of four corners. */
static truth integrate(const maker_mesh *m)
{
    static const double apex[3] = {-3, 11, 2};
    static const int axes[6][2] = {{0, 0}, {1, 1}, {2, 2}, {0, 1}, {0, 2}, {1, 2}};
    double volume = 0, first[3] = {0, 0, 0}, second[6] = {0, 0, 0, 0, 0, 0};
    truth t;

    for (size_t i = 0; i < m->triangles; i++) {
        const double *const p[4] = {apex, defect_corner(m, i, 0), defect_corner(m, i, 1),
                                    defect_corner(m, i, 2)};
        double const v = maker_volume6(p[0], p[1], p[2], p[3]) / 6;
        double sum[3];
        for (int a = 0; a < 3; a++) {
            sum[a] = p[0][a] + p[1][a] + p[2][a] + p[3][a];
            first[a] += v * sum[a] / 4;
        }
        for (int k = 0; k < 6; k++) {
            double own = sum[axes[k][0]] * sum[axes[k][1]];
            for (int c = 0; c < 4; c++) own += p[c][axes[k][0]] * p[c][axes[k][1]];
            second[k] += v * own / 20;
        }
        volume += v;
    }
    if (volume < 0) {
        volume = -volume;
        for (int k = 0; k < 6; k++) second[k] = -second[k], first[k % 3] *= k < 3 ? -1 : 1;
    }
    t.volume = volume;
    for (int a = 0; a < 3; a++) t.center[a] = first[a] / volume;
    for (int k = 0; k < 6; k++) second[k] -= volume * t.center[axes[k][0]] * t.center[axes[k][1]];
    for (int k = 0; k < 6; k++) t.inertia[k] = k < 3 ? second[(k + 1) % 3] + second[(k + 2) % 3] : -second[k];
    return t;
}

static bvx_measure_report measure(int32_t resolution)
{
    bvx_measure_options const o = {.struct_size = sizeof o, .resolution = resolution};
    bvx_mesh_view const view = maker_view(&shape.mesh);
    bvx_measure_report r;

    memset(&r, 0xff, sizeof r);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_measure(ctx, &view, &o, &r), bvx_last_message(ctx));
    return r;
}

/* Within the bounds, and these within share of the values themselves. */
static void assert_bounds(const truth *t, const bvx_measure_report *r, double share, const char *name)
{
    double size = 0, inertia = 0;

    TEST_ASSERT_TRUE_MESSAGE(fabs(r->volume - t->volume) <= r->volume_error, name);
    TEST_ASSERT_TRUE_MESSAGE(defect_distance(r->center, t->center) <= r->center_error, name);
    for (int k = 0; k < 6; k++) {
        TEST_ASSERT_TRUE_MESSAGE(fabs(r->inertia[k] - t->inertia[k]) <= r->inertia_error, name);
        inertia = fmax(inertia, fabs(t->inertia[k]));
    }
    size = cbrt(t->volume);
    TEST_ASSERT_TRUE_MESSAGE(r->volume_error <= share * t->volume, name);
    TEST_ASSERT_TRUE_MESSAGE(r->center_error <= share * size, name);
    TEST_ASSERT_TRUE_MESSAGE(r->inertia_error <= share * inertia * 10, name);
}

static void assert_near(const truth *t, const bvx_measure_report *r, double share, const char *name)
{
    double const inertia = t->inertia[0] + t->inertia[1] + t->inertia[2];

    TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(share * t->volume, t->volume, r->volume, name);
    TEST_ASSERT_TRUE_MESSAGE(defect_distance(r->center, t->center) <= share * cbrt(t->volume), name);
    for (int k = 0; k < 6; k++)
        TEST_ASSERT_DOUBLE_WITHIN_MESSAGE(share * inertia, t->inertia[k], r->inertia[k], name);
}

/* ---- Whole ---- */

static void test_measure_of_closed_bodies_is_their_integral(void)
{
    for (int body = 0; body < BODIES; body++) {
        truth t;
        bvx_measure_report r;
        make_body(body);
        t = integrate(&shape.mesh);
        r = measure(0);
        assert_bounds(&t, &r, 1e-9, body_names[body]);
        assert_near(&t, &r, 1e-12, body_names[body]);
        TEST_ASSERT_EQUAL_INT32(0, r.resolution);
        TEST_ASSERT_EQUAL_INT32(BVX_FILL_REASON_SOUND, r.fill_reason);

        maker_flip(&shape.mesh, 0, shape.mesh.triangles);
        r = measure(0);
        assert_bounds(&t, &r, 1e-9, body_names[body]);
    }
}

static void test_measure_knows_the_box_and_the_torus(void)
{
    double const x = 9 * 0.75, y = 7 * 0.75, z = 5 * 0.75, m = 2.5 * x * y * z;
    double const large = 3, small = 1, torus = 2 * DEFECT_PI * DEFECT_PI * large * small * small;
    bvx_measure_options const o = {.struct_size = sizeof o, .density = 2.5};
    bvx_measure_report r;
    bvx_mesh_view view;

    make_body(BOX);
    view = maker_view(&shape.mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_measure(ctx, &view, &o, &r));
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, x * y * z, r.volume);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 2 * (x * y + y * z + z * x), r.area);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, m, r.mass);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 3.25 * 0.75 + x / 2, r.center[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, m * (y * y + z * z) / 12, r.inertia[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, m * (x * x + z * z) / 12, r.inertia[1]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-10, m * (x * x + y * y) / 12, r.inertia[2]);
    for (int k = 3; k < 6; k++) TEST_ASSERT_DOUBLE_WITHIN(1e-10, 0, r.inertia[k]);

    maker_clear(&shape.mesh);
    add_torus(&shape.mesh, large, small, 480, 240);
    r = measure(0);
    TEST_ASSERT_DOUBLE_WITHIN(3e-4 * torus, torus, r.volume);
    TEST_ASSERT_DOUBLE_WITHIN(5e-4 * torus * 12, torus * (large * large + 0.75 * small * small),
                              r.inertia[2]);
}

/* ---- Spoilt ---- */

static void flip_fifth(void)
{
    for (size_t t = 0; t < shape.mesh.triangles; t++)
        if (maker_below(&seed, 5) == 0) maker_flip(&shape.mesh, t, t + 1);
}

static void drop_fifth(void)
{
    for (size_t t = shape.mesh.triangles; t-- > 0;)
        if (maker_below(&seed, 5) == 0) maker_remove(&shape.mesh, t);
}

static void tear_fifth(void)
{
    maker_mesh *const m = &shape.mesh;

    for (size_t t = 0; t < m->triangles; t++)
        if (maker_below(&seed, 5) == 0)
            defect_loosen(m, t, defect_jitter(&seed, 0.2 * shape.voxel),
                          defect_jitter(&seed, 0.2 * shape.voxel));
}

static void copy_all(void)
{
    defect_duplicates(&shape, &seed);
}

static const struct {
    const char *name;
    void (*spoil)(void);
    double near; /* share of the values */
} spoilt[] = {{"a fifth flipped", flip_fifth, 0.001},
              {"a fifth left out", drop_fifth, 0.005},
              {"a fifth torn", tear_fifth, 0.005},
              {"triangles twice", copy_all, 0.001}};

static void measure_spoilt(int body, size_t i, int32_t resolution)
{
    char name[80];
    truth t;
    bvx_measure_report r;

    snprintf(name, sizeof name, "%s, %s, %d", body_names[body], spoilt[i].name, (int)resolution);
    make_body(body);
    t = integrate(&shape.mesh);
    spoilt[i].spoil();
    r = measure(resolution);
    assert_bounds(&t, &r, 50.0 / resolution, name);
    assert_near(&t, &r, spoilt[i].near, name);
}

enum { SPOILT = sizeof spoilt / sizeof spoilt[0] };

static void test_measure_of_spoilt_bodies_is_near_and_its_bounds_hold(void)
{
    for (int body = 0; body < BODIES; body++)
        for (size_t i = 0; i < SPOILT; i++) {
            measure_spoilt(body, i, 32);
            if (!quick) measure_spoilt(body, i, 24);
        }
}

static void test_measure_of_spoilt_bodies_by_default(void)
{
    for (size_t i = 0; i < SPOILT; i++) measure_spoilt(CYLINDER, i, quick ? 64 : 128);
}

static void test_measure_turns_flipped_triangles_and_sums_them_up(void)
{
    truth t;
    bvx_measure_report r;

    make_body(TORUS);
    t = integrate(&shape.mesh);
    flip_fifth();
    r = measure(0);
    TEST_ASSERT_EQUAL_INT32(0, r.resolution);
    TEST_ASSERT_TRUE(r.turned > 50);
    assert_near(&t, &r, 1e-12, "flipped");
}

/* Two boxes that overlap, and one with a cavity that faces outwards: what lies in both counts once or not at all. */
static void test_measure_of_bodies_that_overlap_or_lie_within_each_other(void)
{
    static const double low[4][3] = {{0, 0, 0}, {1, 1, 1}, {0, 0, 0}, {0.5, 0.5, 0.5}};
    static const double high[4][3] = {{2, 2, 2}, {3, 3, 3}, {2, 2, 2}, {1.5, 1.5, 1.5}};
    static const double volume[2] = {15, 7}, middle[2] = {1.5, 1};
    static const int32_t reason[2] = {BVX_FILL_REASON_OVERLAP, BVX_FILL_REASON_NESTED};

    for (int i = 0; i < 2; i++) {
        bvx_measure_report r;
        maker_clear(&shape.mesh);
        maker_box(&shape.mesh, low[2 * i], high[2 * i]);
        maker_box(&shape.mesh, low[2 * i + 1], high[2 * i + 1]);
        r = measure(0);
        TEST_ASSERT_EQUAL_INT32(reason[i], r.fill_reason);
        TEST_ASSERT_EQUAL_INT32(128, r.resolution);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * volume[i], volume[i], r.volume);
        TEST_ASSERT_TRUE(fabs(r.volume - volume[i]) <= r.volume_error);
        for (int a = 0; a < 3; a++) TEST_ASSERT_DOUBLE_WITHIN(r.center_error, middle[i], r.center[a]);
    }
}

/* Boxes that overlap, or lie in each other, where no row of centres passes: sums would count that twice. */
static void test_measure_is_not_certain_of_what_rows_do_not_see(void)
{
    static const double low[6][3] = {{0, 0, 0},       {0.9, 0.98, 0.98}, {0, 0, 0},
                                     {0.6, 0.6, 0.6}, {0, 0, 0},         {0.1, 0.1, 0.995}};
    static const double high[6][3] = {{1, 1, 1},       {2, 2, 2}, {2, 2, 2},
                                      {0.9, 0.9, 0.9}, {2, 2, 2}, {1.9, 1.9, 1.005}};
    static const double volume[3] = {1 + 1.1 * 1.02 * 1.02 - 0.1 * 0.02 * 0.02, 8 - 0.027,
                                     8 - 1.8 * 1.8 * 0.01};
    static const int32_t resolution[3] = {2, 2, 128};

    for (int i = 0; i < 3; i++) {
        bvx_measure_report r;
        maker_clear(&shape.mesh);
        maker_box(&shape.mesh, low[2 * i], high[2 * i]);
        maker_box(&shape.mesh, low[2 * i + 1], high[2 * i + 1]);
        r = measure(resolution[i]);
        TEST_ASSERT_EQUAL_INT32(BVX_FILL_REASON_SOUND, r.fill_reason);
        TEST_ASSERT_EQUAL_INT32(resolution[i], r.resolution);
        TEST_ASSERT_TRUE(fabs(r.volume - volume[i]) <= r.volume_error);
    }
}

/* A sheet, a flat body and one far from the origin. */
static void test_measure_of_what_encloses_nothing_or_lies_far_away(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {4, 2, 0}, cube[3] = {1, 1, 1};
    bvx_measure_report r;

    maker_box(&shape.mesh, low, high);
    r = measure(16);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, r.volume);
    TEST_ASSERT_DOUBLE_WITHIN(0, 2, r.center[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0, 0, r.inertia[0]);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 16, r.area);

    maker_clear(&shape.mesh);
    maker_triangle(&shape.mesh, maker_vertex(&shape.mesh, 0, 0, 0), maker_vertex(&shape.mesh, 1, 0, 0),
                   maker_vertex(&shape.mesh, 0, 1, 1));
    r = measure(16);
    TEST_ASSERT_TRUE(r.volume <= r.volume_error);
    TEST_ASSERT_TRUE(r.volume_error < 0.3);

    maker_clear(&shape.mesh);
    maker_box(&shape.mesh, low, cube);
    maker_shift(&shape.mesh, 0, 1e9, -1e9, 1e9);
    r = measure(16);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1, r.volume);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 1.0 / 6, r.inertia[1]);
    TEST_ASSERT_DOUBLE_WITHIN(r.center_error, 1e9 + 0.5, r.center[0]);
    TEST_ASSERT_TRUE(r.center_error < 1e-5);
}

/* ---- The same everywhere ---- */

static void test_measure_scales_and_shows_no_threads(void)
{
    bvx_measure_options const o = {.struct_size = sizeof o, .resolution = 24};

    for (int spoil = 0; spoil < 2; spoil++) {
        bvx_context *const more = suite_context(4, 0);
        bvx_measure_report one, other;
        bvx_mesh_view view;

        make_body(TORUS);
        if (spoil) drop_fifth();
        one = measure(24);
        view = maker_view(&shape.mesh);
        memset(&other, 0, sizeof other);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_measure(more, &view, &o, &other));
        TEST_ASSERT_EQUAL_MEMORY(&one, &other, sizeof one);
        bvx_context_destroy(more);

        for (size_t i = 0; i < 3 * shape.mesh.vertices; i++) shape.mesh.p[i] *= 0x1p60;
        other = measure(24);
        TEST_ASSERT_DOUBLE_WITHIN(0, one.volume * 0x1p180, other.volume);
        TEST_ASSERT_DOUBLE_WITHIN(0, one.center[1] * 0x1p60, other.center[1]);
        TEST_ASSERT_DOUBLE_WITHIN(0, one.inertia_error * 0x1p300, other.inertia_error);
    }
}

static void test_measure_golden(void) /* numbers, the same for every compiler and processor */
{
    static const double box[3] = {0, 0, 0};
    static const double out[3] = {3, 1.75, 2.5}, over[3] = {1.1, 0.3, 0.7}, far[3] = {4.3, 1.5, 2.2};
    uint64_t h[2];

    for (int i = 0; i < 2; i++) {
        bvx_measure_report r;
        if (i == 1) maker_box(&shape.mesh, over, far);
        else maker_box(&shape.mesh, box, out);
        r = measure(32);
        h[i] = 0;
        for (size_t k = 0; k < offsetof(bvx_measure_report, resolution); k += 8) {
            uint64_t word;
            memcpy(&word, (const char *)&r + k, 8);
            h[i] = h[i] * UINT64_C(0x9E3779B97F4A7C15) + word;
        }
    }
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xD035F34D12EC3242), h[0]);
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xECEDF5001DE5EA18), h[1]);
}

/* ---- Refusals and failures ---- */

static void refuse(const bvx_mesh_view *view, const bvx_measure_options *o, bvx_status status,
                   const char *word)
{
    bvx_measure_report r, zero;

    memset(&zero, 0, sizeof zero);
    memset(&r, 0xff, sizeof r);
    TEST_ASSERT_EQUAL_INT32(status, bvx_measure(ctx, view, o, &r));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_MEMORY(&zero, &r, sizeof r);
}

static void test_measure_refuses_bad_meshes_and_options(void)
{
    bvx_measure_options o = {.struct_size = sizeof o};
    bvx_mesh_view view, v;

    make_body(BOX);
    view = maker_view(&shape.mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_measure(NULL, &view, &o, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_measure(ctx, &view, &o, NULL));
    refuse(NULL, &o, BVX_ERR_ARGUMENT, "mesh");
    o.density = -1, refuse(&view, &o, BVX_ERR_ARGUMENT, "density");
    o.density = HUGE_VAL, refuse(&view, &o, BVX_ERR_ARGUMENT, "density");
    o.density = 0, o.resolution = 2049, refuse(&view, &o, BVX_ERR_ARGUMENT, "resolution");
    o.resolution = -1, refuse(&view, &o, BVX_ERR_ARGUMENT, "resolution");
    v = view, v.triangle_count = 0, refuse(&v, NULL, BVX_ERR_EMPTY, "triangle");
    v = view, v.vertex_count = 4, refuse(&v, NULL, BVX_ERR_RANGE, "vertex");
    shape.mesh.p[4] = NAN;
    refuse(&view, NULL, BVX_ERR_RANGE, "vertex 1");
}

static bvx_status measure_some(void *user, bvx_context *context)
{
    bvx_measure_options const o = {.struct_size = sizeof o, .resolution = 16};
    bvx_mesh_view const view = maker_view(&shape.mesh);
    bvx_measure_report r;
    (void)user;
    return bvx_measure(context, &view, &o, &r);
}

static void test_measure_when_memory_fails_or_it_is_cancelled(void)
{
    bvx_context_options const one_thread = suite_options(1, 0);
    uint64_t allocations = 0, calls = 0;

    for (int spoil = 0; spoil < 2; spoil++) {
        make_body(CYLINDER);
        if (spoil) drop_fifth();
        TEST_ASSERT_NULL(fault_every_allocation(measure_some, NULL, &one_thread, &allocations));
        TEST_ASSERT_TRUE(allocations > 6);
        TEST_ASSERT_NULL(fault_every_cancel(measure_some, NULL, &one_thread, &calls));
        TEST_ASSERT_TRUE(calls >= 4);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_measure_of_closed_bodies_is_their_integral);
    RUN_TEST(test_measure_knows_the_box_and_the_torus);
    RUN_TEST(test_measure_of_spoilt_bodies_is_near_and_its_bounds_hold);
    RUN_TEST(test_measure_of_spoilt_bodies_by_default);
    RUN_TEST(test_measure_turns_flipped_triangles_and_sums_them_up);
    RUN_TEST(test_measure_of_bodies_that_overlap_or_lie_within_each_other);
    RUN_TEST(test_measure_is_not_certain_of_what_rows_do_not_see);
    RUN_TEST(test_measure_of_what_encloses_nothing_or_lies_far_away);
    RUN_TEST(test_measure_scales_and_shows_no_threads);
    RUN_TEST(test_measure_golden);
    RUN_TEST(test_measure_refuses_bad_meshes_and_options);
    RUN_TEST(test_measure_when_memory_fails_or_it_is_cancelled);
    return UNITY_END();
}
