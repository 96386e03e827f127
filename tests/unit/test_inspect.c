/* test_inspect.c - thickness, gaps, cavities and islands of analytic bodies at three resolutions; whether they are
 * sound; places, the worst first; layers along each axis; threads, spoilt bodies and refusals. */
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

enum { MOST = 6, RESOLUTIONS = 3, VERTICES = 4096 };
static const int32_t resolutions[RESOLUTIONS] = {24, 50, 96};

static maker_mesh body;
static bvx_finding found[BVX_FINDING_COUNT][MOST];
static double thickness[VERTICES];
static bvx_inspect_options options;
static uint64_t seed;

void setUp(void)
{
    bvx_inspect_options const plain = {.struct_size = sizeof plain, .most = MOST};

    suite_open(1);
    memset(&body, 0, sizeof body);
    options = plain;
    options.findings = &found[0][0];
    options.thickness = thickness;
    seed = 41;
}

void tearDown(void)
{
    maker_free(&body);
    suite_close();
}

static bvx_inspect_report inspect(int32_t resolution)
{
    bvx_mesh_view const view = maker_view(&body);
    bvx_inspect_report report;

    TEST_ASSERT_TRUE(body.vertices <= VERTICES);
    options.fit.resolution = resolution;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_inspect(ctx, &view, &options, &report),
                                    bvx_last_message(ctx));
    return report;
}

static void box(double x, double y, double z, double dx, double dy, double dz)
{
    double const low[3] = {x, y, z}, high[3] = {x + dx, y + dy, z + dz};
    maker_box(&body, low, high);
}

static void assert_near(double want, double got, double off)
{
    char text[96];

    snprintf(text, sizeof text, "%.9g is not %.9g to %.3g", got, want, off);
    TEST_ASSERT_TRUE_MESSAGE(fabs(want - got) <= off, text);
}

/* ---- Walls ---- */

/* Eight vertices, so that vertices' own normals would say nothing. */
static void test_a_plate_is_as_thick_as_it_is(void)
{
    box(1, 2, 3, 10, 8, 0.5);
    options.walls = 0.6;
    options.density = 3;
    for (int i = 0; i < RESOLUTIONS; i++) {
        bvx_inspect_report const r = inspect(resolutions[i]);

        TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_NOTHING, r.needs);
        assert_near(0.5, r.least_thickness, 1e-9);
        assert_near(0.5, fabs(r.thin_ends[0][2] - r.thin_ends[1][2]), 1e-9);
        for (int k = 0; k < 3; k++) assert_near(0.5, r.thickness[k], 0.004);
        assert_near(160, r.thin_area, 1e-6); /* both sides, and none of its rim */
        for (size_t v = 0; v < body.vertices; v++) assert_near(0.5, thickness[v], 1e-9);
        TEST_ASSERT_EQUAL_UINT64(1, r.found[BVX_FINDING_WALL]);
        TEST_ASSERT_EQUAL_UINT64(0, r.found[BVX_FINDING_GAP] + r.found[BVX_FINDING_CAVITY] +
                                        r.found[BVX_FINDING_ISLAND]);
        assert_near(0.5, found[BVX_FINDING_WALL][0].size, 1e-9);
        assert_near(3.25, found[BVX_FINDING_WALL][0].position[2], 12.0 / resolutions[i]);
        assert_near(10, found[BVX_FINDING_WALL][0].high[0] - found[BVX_FINDING_WALL][0].low[0],
                    22.0 / resolutions[i]);
        TEST_ASSERT_TRUE(isinf(r.least_gap));
        assert_near(40, r.volume, 1e-9);
        assert_near(120, r.mass, 1e-9);
    }
}

/* Balls that touch an edge would have no size: rays know no thin walls of a cube, nor of a regular tetrahedron. */
static void test_edges_are_no_walls(void)
{
    box(0, 0, 0, 2, 2, 2);
    options.walls = 1.9;
    bvx_inspect_report r = inspect(40);
    assert_near(2, r.least_thickness, 1e-9);
    TEST_ASSERT_EQUAL_UINT64(0, r.found[BVX_FINDING_WALL]);
    maker_clear(&body);
    for (int i = 0; i < 4; i++) maker_vertex(&body, i & 1, i >> 1, (i & 1) ^ (i >> 1));
    maker_tetrahedron(&body, 0, 1, 2, 3);
    r = inspect(40);
    TEST_ASSERT_TRUE(isinf(r.least_thickness) && isinf(r.thickness[0]) && isinf(thickness[0]));
    TEST_ASSERT_EQUAL_UINT64(0, r.found[BVX_FINDING_WALL]);
}

/* A ball within one: a wall of 1 with a facet's error, and a cavity. */
static void test_a_hollow_ball(void)
{
    static const double centre[3] = {5, 5, 5}, outer[3] = {4, 4, 4}, inner[3] = {3, 3, 3};
    double hollow = 0;
    bvx_finding const *const cavity = found[BVX_FINDING_CAVITY];

    maker_star(&body, &seed, centre, outer, 0, 30, 40, 1 << 20);
    size_t const first = body.triangles;
    maker_star(&body, &seed, centre, inner, 0, 30, 40, 1 << 20);
    maker_flip(&body, first, body.triangles);
    for (size_t t = first; t < body.triangles; t++)
        hollow += fabs(maker_volume6(centre, body.p + 3 * body.t[3 * t], body.p + 3 * body.t[3 * t + 1],
                                     body.p + 3 * body.t[3 * t + 2])) /
                  6;
    for (int i = 0; i < RESOLUTIONS; i++) {
        bvx_inspect_report const r = inspect(resolutions[i]);

        TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_NOTHING, r.needs);
        assert_near(1, r.least_thickness, 0.06); /* facets of 12 degrees */
        assert_near(1, r.thickness[2], 0.06);
        assert_near(6, r.least_gap, 0.3); /* through the cavity, as facets have it */
        TEST_ASSERT_EQUAL_UINT64(1, r.found[BVX_FINDING_CAVITY]);
        assert_near(hollow, r.cavity_volume, hollow * 0.025);
        assert_near(cavity->size, r.cavity_volume, 1e-9);
        for (int a = 0; a < 3; a++) {
            assert_near(5, cavity->position[a], 0.5);
            assert_near(2, cavity->low[a], 8.5 / resolutions[i]);
            assert_near(8, cavity->high[a], 8.5 / resolutions[i]);
        }
    }
}

/* ---- Gaps, and the order of what is found ---- */

static void test_gaps_and_walls_worst_first(void)
{
    static const double wall[4] = {0.5, 0.3, 0.4, 0.6}, gap[3] = {0.7, 0.5, 0.6};
    double x = 0;

    for (int i = 0; i < 4; i++) {
        box(x, 0, 0, wall[i], 4, 3);
        x += wall[i] + (i < 3 ? gap[i] : 0);
    }
    options.walls = 0.55;
    options.gaps = 0.65;
    options.most = 2;
    bvx_inspect_report const r = inspect(96);
    TEST_ASSERT_EQUAL_UINT64(3, r.found[BVX_FINDING_WALL]);
    assert_near(0.3, found[0][0].size, 1e-9);
    assert_near(0.4, found[0][1].size, 1e-9);
    assert_near(0.3, r.least_thickness, 1e-9);
    TEST_ASSERT_EQUAL_UINT64(2, r.found[BVX_FINDING_GAP]);
    assert_near(0.5, found[0][2].size, 1e-9);
    assert_near(0.6, found[0][3].size, 1e-9);
    assert_near(0.5, r.least_gap, 1e-9);
    assert_near(72, r.thin_area, 1e-6); /* three walls of two sides of 12 */
    /* Those that are not listed are counted, and without an array all are. */
    options.findings = NULL;
    TEST_ASSERT_EQUAL_UINT64(3, inspect(96).found[BVX_FINDING_WALL]);
}

/* ---- Layers ---- */

/* A table on one leg, whose plate hangs down at its far end: the part of it that does is an island, along any axis. */
static void make_table(int up)
{
    int const u = (up + 1) % 3, v = (up + 2) % 3;
    static const int32_t n[3] = {5, 2, 4};
    uint8_t solid[3 * 40];

    /* Cubes of a grid, so that there are no faces between parts: u is long, up high. */
    int32_t size[3];
    static const double at[3] = {0, 0, 0};
    size[u] = n[0];
    size[v] = n[1];
    size[up] = n[2];
    memset(solid, 0, sizeof solid);
    for (int z = 0; z < n[2]; z++)
        for (int y = 0; y < n[1]; y++)
            for (int x = 0; x < n[0]; x++) {
                int32_t p[3];
                p[u] = x;
                p[v] = y;
                p[up] = z;
                int const set = z == 3 || x == 0 || (x == 4 && z == 2);
                solid[(p[2] * size[1] + p[1]) * size[0] + p[0]] = (uint8_t)set;
            }
    maker_cubes(&body, &seed, solid, size, at);
}

static void test_islands_along_each_axis(void)
{
    static const int32_t up_of[3] = {BVX_UP_X, BVX_UP_Y, BVX_UP_Z};
    bvx_finding const *const island = found[BVX_FINDING_ISLAND];

    for (int up = 0; up < 3; up++)
        for (int i = 0; i < RESOLUTIONS; i++) {
            int const u = (up + 1) % 3;

            maker_clear(&body);
            make_table(up);
            options.up = up_of[up];
            bvx_inspect_report const r = inspect(resolutions[i]);
            double const voxel = r.lattice.spacing[0];

            TEST_ASSERT_EQUAL_UINT64(1, r.found[BVX_FINDING_ISLAND]);
            assert_near(2, island->size, 6 * voxel);
            assert_near(4, island->low[u], 1.01 * voxel);
            assert_near(2, island->low[up], 1.01 * voxel);
            assert_near(voxel, island->high[up] - island->low[up], 1e-9);
        }
    /* The other way up it stands on its plate. */
    maker_clear(&body);
    make_table(2);
    for (size_t v = 0; v < body.vertices; v++) body.p[3 * v + 2] = 4 - body.p[3 * v + 2];
    maker_flip(&body, 0, body.triangles);
    options.up = BVX_UP_Z;
    TEST_ASSERT_EQUAL_UINT64(0, inspect(50).found[BVX_FINDING_ISLAND]);
}

/* ---- What is not sound; threads; the caller's lattice ---- */

static void test_what_is_not_sound(void)
{
    box(0, 0, 0, 4, 4, 4);
    box(3, 1, 1, 4, 2, 2);
    bvx_inspect_report r = inspect(40);

    /* A part of one lies in the other, whatever crosses. */
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_OUTSIDE_IN, r.needs);
    TEST_ASSERT_TRUE(r.crossings > 0);
    TEST_ASSERT_EQUAL_UINT64(2, r.certificate.components);
    assert_near(64 + 12, r.volume, r.volume_error);
    /* Crossings are counted where something else is wrong, too. */
    maker_remove(&body, 0);
    r = inspect(40);
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_LIDS, r.needs);
    TEST_ASSERT_TRUE(r.crossings > 0);
}

static void test_threads_and_lattices_change_nothing(void)
{
    static const double centre[3] = {5, 5, 5}, radius[3] = {4, 3, 2};
    bvx_context *const other = suite_context(3, BVX_CPU_BEST);
    static double again[VERTICES];
    bvx_inspect_report more;
    bvx_finding all[BVX_FINDING_COUNT][MOST];

    maker_star(&body, &seed, centre, radius, 0.3, 16, 24, 65536);
    options.walls = 3;
    options.gaps = 3;
    bvx_inspect_report const r = inspect(50);
    bvx_lattice const lattice = r.lattice;
    bvx_mesh_view const view = maker_view(&body);

    memcpy(all, found, sizeof all);
    options.fit.resolution = 0;
    options.fit.lattice = &lattice;
    options.thickness = again;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_inspect(other, &view, &options, &more));
    TEST_ASSERT_EQUAL_MEMORY(&r, &more, sizeof r);
    TEST_ASSERT_EQUAL_MEMORY(all, found, sizeof all);
    TEST_ASSERT_EQUAL_MEMORY(thickness, again, body.vertices * sizeof *again);
    bvx_context_destroy(other);
}

static void test_refusals(void)
{
    bvx_inspect_report r;
    bvx_mesh_view view;

    box(0, 0, 0, 1, 1, 1);
    view = maker_view(&body);
    options.walls = -1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_inspect(ctx, &view, &options, &r));
    options.walls = (double)NAN;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_inspect(ctx, &view, &options, &r));
    options.walls = 0;
    options.most = (1 << 20) + 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_inspect(ctx, &view, &options, &r));
    options.most = 0;
    options.findings = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_inspect(ctx, &view, &options, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_inspect(ctx, &view, &options, &r));
    view.triangle_count = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_inspect(ctx, &view, &options, &r));
    maker_clear(&body);
    for (int i = 0; i < 3; i++) maker_vertex(&body, i, i, i);
    maker_triangle(&body, 0, 1, 2);
    view = maker_view(&body);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_inspect(ctx, &view, &options, &r));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "bvx_inspect"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_plate_is_as_thick_as_it_is);
    RUN_TEST(test_edges_are_no_walls);
    RUN_TEST(test_a_hollow_ball);
    RUN_TEST(test_gaps_and_walls_worst_first);
    RUN_TEST(test_islands_along_each_axis);
    RUN_TEST(test_what_is_not_sound);
    RUN_TEST(test_threads_and_lattices_change_nothing);
    RUN_TEST(test_refusals);
    return UNITY_END();
}
