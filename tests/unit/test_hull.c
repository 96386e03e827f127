/* test_hull.c - what can be reached from outside: the outer of double walls, as the unsigned distance of a surface
 * makes them, also where holes weld both; inner parts go; openings close up to a width; walls seen from both sides
 * become shells; levels that go around all triangles; refusals, threads. */
#include "mesh/cross.h"
#include "mesh/view.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

enum { SIDE = 40 };
#define MIDDLE 20.0
#define RADIUS 13.0 /* of the ball; its walls are 1 further in and out */

static maker_mesh given;
static bvx_mesh made[3];
static bvx_hull_report report;
static bvx_level_report level[3];
static uint64_t seed;

void setUp(void)
{
    suite_open(1);
    memset(&given, 0, sizeof given);
    seed = 41;
}

void tearDown(void)
{
    for (int i = 0; i < 3; i++) bvx_mesh_free(ctx, &made[i]);
    maker_free(&given);
    suite_close();
}

static double radius_of(double x, double y, double z)
{
    x -= MIDDLE;
    y -= MIDDLE;
    z -= MIDDLE;
    return sqrt(x * x + y * y + z * z);
}

/* The surface at distance 1 of a sphere whose sides are not known: an outer and an inner wall. pinholes: lines of
 * samples through both that lie far from the sphere, so that the walls are welded around tunnels. */
static void make_double_walls(int pinholes)
{
    static float samples[SIDE * SIDE * SIDE];
    double const origin[3] = {-0.5, -0.5, -0.5}, spacing[3] = {1, 1, 1};
    int32_t const dims[3] = {SIDE, SIDE, SIDE};
    bvx_volume_view volume = {.samples = samples, .sample_type = BVX_SAMPLE_F32, .size = {SIDE, SIDE, SIDE}};
    bvx_scalar_options const o = {.struct_size = sizeof o, .level = 1, .below = 1};
    bvx_mesh walls = {0};

    for (int n = 0; n < SIDE * SIDE * SIDE; n++)
        samples[n] = (float)fabs(radius_of(n % SIDE, n / SIDE % SIDE, n / SIDE / SIDE) - RADIUS);
    for (int n = 0; n < pinholes; n++) {
        int const u = (int)maker_below(&seed, 17) + 12, v = (int)maker_below(&seed, 17) + 12, axis = n % 3;
        for (int w = SIDE / 2; w < SIDE; w++) {
            int const at[3] = {axis == 0 ? w : u, axis == 1 ? w : axis == 0 ? u : v, axis == 2 ? w : v};
            samples[(at[2] * SIDE + at[1]) * SIDE + at[0]] = 3;
        }
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &volume.lattice));
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_extract_scalar(ctx, &volume, &o, &walls),
                                    bvx_last_message(ctx));
    for (uint64_t v = 0; v < walls.vertex_count; v++) {
        const float *const p = (const float *)walls.positions + 3 * v;
        maker_vertex(&given, (double)p[0], (double)p[1], (double)p[2]);
    }
    for (uint64_t t = 0; t < walls.triangle_count; t++)
        maker_triangle(&given, walls.triangles[3 * t], walls.triangles[3 * t + 1],
                       walls.triangles[3 * t + 2]);
    bvx_mesh_free(ctx, &walls);
}

static void hull_with(bvx_hull_options *o, uint64_t levels)
{
    bvx_mesh_view const view = maker_view(&given);

    o->struct_size = sizeof *o;
    o->report = &report;
    o->reports = level;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_hull(ctx, &view, o, levels, made), bvx_last_message(ctx));
    for (uint64_t i = 0; i < levels; i++) {
        const bvx_certificate *const c = &level[i].certificate;
        TEST_ASSERT_TRUE(c->closed && c->edge_manifold && c->vertex_manifold && c->oriented && c->volume > 0);
        TEST_ASSERT_EQUAL_UINT64(0, level[i].crossings);
        TEST_ASSERT_EQUAL_UINT64(c->triangles, made[i].triangle_count);
    }
}

/* How far vertices lie from the outer wall: the largest, and those further than some. */
static double off_outer_wall(const bvx_mesh *mesh, double some, uint64_t *further)
{
    double most = 0;

    *further = 0;
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        const float *const p = (const float *)mesh->positions + 3 * v;
        double const off = fabs(radius_of((double)p[0], (double)p[1], (double)p[2]) - (RADIUS + 1));
        if (off > most) most = off;
        *further += off > some;
    }
    return most;
}

static void test_the_outer_of_two_walls(void)
{
    uint64_t further;
    bvx_hull_options o = {.fit = {.resolution = 20}, .placing = {.sharp = BVX_SHARP_NEVER}};

    /* Voxels of 1.4: the walls are closer than two of them. */
    make_double_walls(0);
    hull_with(&o, 1);
    TEST_ASSERT_EQUAL_UINT64(1, level[0].certificate.components);
    TEST_ASSERT_EQUAL_INT64(2, level[0].certificate.euler);
    TEST_ASSERT_TRUE(off_outer_wall(&made[0], 0.1, &further) < 0.2);
    TEST_ASSERT_EQUAL_UINT64(0, report.lids + report.shelled_triangles);
    TEST_ASSERT_TRUE(report.outer_triangles * 5 < given.triangles * 4);
    TEST_ASSERT_EQUAL_UINT64(report.triangles, made[0].triangle_count);
}

static void test_welded_flipped_and_with_parts_inside(void)
{
    double const radius[3] = {2, 2, 2};
    uint64_t further;
    bvx_hull_options o = {.fit = {.resolution = 24}, .placing = {.sharp = BVX_SHARP_NEVER}, .close_gaps = 2};

    make_double_walls(6);
    for (int i = 0; i < 5; i++) {
        double const at[3] = {MIDDLE + 2 * i - 4, MIDDLE + i, MIDDLE - 2 * i};
        maker_star(&given, &seed, at, radius, 0.2, 5, 7, 65536);
    }
    for (size_t t = 0; t + 1 < given.triangles; t += 5) maker_flip(&given, t, t + 1);
    maker_shuffle_triangles(&given, &seed);
    hull_with(&o, 1);
    TEST_ASSERT_EQUAL_UINT64(1, level[0].certificate.components);
    TEST_ASSERT_EQUAL_INT64(2, level[0].certificate.euler);

    /* Lids dip into the holes by a few voxels, and nothing else leaves the outer wall. */
    TEST_ASSERT_TRUE(off_outer_wall(&made[0], 0.2, &further) < 3);
    TEST_ASSERT_TRUE(further * 12 < made[0].vertex_count);
    TEST_ASSERT_TRUE(level[0].certificate.volume > 0.95 * 4.18879 * 14 * 14 * 14);
}

/* A box of walls without thickness, with a square hole of a width in its top. */
static void make_open_box(double hole)
{
    double const l = -0.5 * hole, h = 0.5 * hole, at[4] = {-8, l, h, 8};
    double const low[3] = {-8, -8, -8}, high[3] = {8, 8, 8};
    uint32_t corner[4][4];

    maker_box(&given, low, high);
    for (size_t t = given.triangles; t-- > 0;) {
        int top = 1;
        for (int k = 0; k < 3; k++) top &= given.p[3 * given.t[3 * t + (size_t)k] + 2] > 7.9;
        if (top) maker_remove(&given, t);
    }
    for (int i = 0; i < 4; i++)
        for (int j = 0; j < 4; j++) corner[i][j] = maker_vertex(&given, at[i], at[j], 8);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            if (i != 1 || j != 1)
                maker_quad(&given, corner[i][j], corner[i + 1][j], corner[i + 1][j + 1], corner[i][j + 1], 0);
}

static void test_openings_close_up_to_a_width(void)
{
    bvx_hull_options o = {.fit = {.resolution = 32}, .placing = {.sharp = BVX_SHARP_NEVER}};

    /* Voxels of a half: the hole is four of them wide, or five by where it lies. */
    make_open_box(2.1);
    o.close_gaps = 5;
    hull_with(&o, 1);
    TEST_ASSERT_TRUE(report.lids != 0);
    TEST_ASSERT_EQUAL_INT64(2, level[0].certificate.euler);
    TEST_ASSERT_DOUBLE_WITHIN(0.05 * 4096, 4096, level[0].certificate.volume);

    /* A larger one stays: the walls, seen from both sides, are shells of two voxels. */
    o.close_gaps = 2;
    hull_with(&o, 1);
    TEST_ASSERT_TRUE(report.shelled_triangles != 0);
    TEST_ASSERT_TRUE(level[0].certificate.volume < 0.5 * 4096);
    TEST_ASSERT_DOUBLE_WITHIN(0.15 * 6 * 256, 6 * 256, level[0].certificate.volume);

    o.shell = BVX_NONE;
    {
        bvx_mesh_view const view = maker_view(&given);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_hull(ctx, &view, &o, 1, made));
    }
}

static void test_levels_and_threads(void)
{
    uint64_t const target[2] = {900, 200};
    bvx_hull_options o = {.fit = {.resolution = 20}, .targets = {.triangles = target}};
    bvx_context *const more = suite_context(3, BVX_CPU_BEST);
    bvx_mesh_view view;
    bvx_mesh other[2] = {{0}, {0}};
    uint64_t hash[2];

    make_double_walls(3);
    hull_with(&o, 2);
    TEST_ASSERT_TRUE(made[0].triangle_count <= 900 && made[1].triangle_count <= 200);
    view = maker_view(&given);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_hull(more, &view, &o, 2, other));
    for (int i = 0; i < 2; i++) {
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &made[i], &hash[0]));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &other[i], &hash[1]));
        TEST_ASSERT_EQUAL_HEX64(hash[0], hash[1]);
        bvx_mesh_free(more, &other[i]);
    }
    bvx_context_destroy(more);

    /* Without targets: the hull itself, then halves. */
    o.targets.triangles = NULL;
    hull_with(&o, 3);
    TEST_ASSERT_EQUAL_UINT64(report.triangles, made[0].triangle_count);
    TEST_ASSERT_TRUE(made[1].triangle_count <= report.triangles / 2 &&
                     made[2].triangle_count <= report.triangles / 4);
}

/* A small tetrahedron without two of its sides. */
static void put_bead(double x, double y, double z)
{
    uint32_t const first = (uint32_t)given.vertices;

    maker_vertex(&given, x, y, z);
    maker_vertex(&given, x + 0.03, y, z);
    maker_vertex(&given, x, y + 0.03, z);
    maker_vertex(&given, x, y, z + 0.03);
    maker_triangle(&given, first, first + 2, first + 1);
    maker_triangle(&given, first, first + 1, first + 3);
}

static void corners_of(const bvx_mesh_view *view, uint64_t t, double at[3][3], const double *corner[3])
{
    bvxi_view_corners(view, t, at);
    for (int k = 0; k < 3; k++) corner[k] = at[k];
}

/* The level goes around every vertex once, no triangle meets one of it, and points of it are near. */
static void assert_encloses(const bvx_mesh *mesh, const bvx_mesh_view *inner, double farthest)
{
    bvx_closest *own, *of_inner;
    bvx_closest_point found;
    bvx_mesh_view view;
    int64_t turns;

    bvx_mesh_view_of(mesh, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, &view, &own));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, inner, &of_inner));
    /* All of the beads, which come last. */
    for (uint64_t t = 0;
         t<inner->triangle_count; t += inner->triangle_count> 5000 && t + 100 < inner->triangle_count ? 7
                                                                                                      : 1) {
        const double *p[3], *q[3];
        double a[3][3], b[3][3];

        corners_of(inner, t, a, p);
        for (int k = 0; k < 3; k++) {
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_winding(ctx, own, p[k], 1, &turns));
            TEST_ASSERT_EQUAL_INT64(1, turns);
        }
        for (uint64_t s = 0; s < view.triangle_count; s++) {
            corners_of(&view, s, b, q);
            TEST_ASSERT_FALSE(bvxi_triangles_cross(p, q));
        }
    }
    for (uint64_t s = 0; s < view.triangle_count; s++)
        for (int i = 0; i <= 8; i++)
            for (int k = 0; k + i <= 8; k++) {
                const double *q[3];
                double b[3][3], at[3];

                corners_of(&view, s, b, q);
                for (int a = 0; a < 3; a++) at[a] = (i * b[0][a] + k * b[1][a] + (8 - i - k) * b[2][a]) / 8;
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(ctx, of_inner, at, 1, &found));
                TEST_ASSERT_TRUE(found.distance > 0 && found.distance <= farthest);
            }
    bvx_closest_free(ctx, own);
    bvx_closest_free(ctx, of_inner);
}

/* Double walls, flipped here and there; beads in a row that leads away, which a small level would leave outside;
 * one far away; a triangle without an area. */
static void test_levels_go_around_all_triangles(void)
{
    uint64_t targets[3] = {1200, 300, 60};
    bvx_mesh_view view;

    make_double_walls(6);
    for (size_t t = 0; t < given.triangles; t++)
        if (maker_below(&seed, 5) == 0) {
            uint32_t const second = given.t[3 * t + 1];

            given.t[3 * t + 1] = given.t[3 * t + 2];
            given.t[3 * t + 2] = second;
        }
    for (int i = 0; i < 24; i++) put_bead(MIDDLE + RADIUS + 1.5 + 0.7 * i, MIDDLE + 0.02 * i * i, MIDDLE);
    put_bead(-30, -20, 60);
    maker_triangle(&given, 0, 1, 1);
    view = maker_view(&given);
    for (int n = 0; n < 3; n++) {
        double const farthest = n == 0 ? 1.5 : n == 1 ? 3 : 8;
        bvx_hull_options o = {.enclose = farthest, .targets = {.triangles = targets}};

        hull_with(&o, 3);
        for (int i = 0; i < 3; i++) assert_encloses(&made[i], &view, farthest);
        TEST_ASSERT_TRUE(made[0].triangle_count <= 1200 && made[1].triangle_count <= made[0].triangle_count);
        TEST_ASSERT_EQUAL_UINT64(given.triangles, report.outer_triangles);
        bvx_context *const many = suite_context(4, BVX_CPU_PORTABLE);
        bvx_mesh again[3] = {{0}};

        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_hull(many, &view, &o, 3, again));
        for (int i = 0; i < 3; i++) {
            TEST_ASSERT_EQUAL_UINT64(made[i].triangle_count, again[i].triangle_count);
            TEST_ASSERT_EQUAL_MEMORY(made[i].triangles, again[i].triangles, 12 * made[i].triangle_count);
            TEST_ASSERT_EQUAL_MEMORY(made[i].positions, again[i].positions,
                                     (made[i].position_type == BVX_F64 ? 24 : 12) * made[i].vertex_count);
            bvx_mesh_free(many, &again[i]);
        }
        bvx_context_destroy(many);
    }
}

/* Bumps between which edges that collapse one by one would cut. */
static void test_levels_go_around_bumps(void)
{
    enum { AROUND = 48, UP = 24 };
    uint64_t targets[2] = {400, 150};
    bvx_hull_options o = {.enclose = 1, .targets = {.triangles = targets}};
    bvx_mesh_view view;

    for (int i = 0; i <= UP; i++)
        for (int k = 0; k < AROUND; k++) {
            double const up = 3.14159 * i / UP, around = 6.28318 * k / AROUND;
            double const r = 10 + 2.5 * sin(5 * up) * sin(6 * around);

            maker_vertex(&given, r * sin(up) * cos(around), r * sin(up) * sin(around), r * cos(up));
        }
    for (uint32_t i = 0; i < UP; i++)
        for (uint32_t k = 0; k < AROUND; k++)
            maker_quad(&given, AROUND * i + k, AROUND * (i + 1) + k, AROUND * (i + 1) + (k + 1) % AROUND,
                       AROUND * i + (k + 1) % AROUND, 0);
    view = maker_view(&given);
    hull_with(&o, 2);
    for (int i = 0; i < 2; i++) assert_encloses(&made[i], &view, o.enclose);
}

static void test_refusals_of_enclose(void)
{
    bvx_hull_options o = {.struct_size = sizeof o, .enclose = -1};
    bvx_mesh_view view;

    make_double_walls(0);
    view = maker_view(&given);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_hull(ctx, &view, &o, 1, made));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "enclose"));
    o.enclose = 1;
    o.close_gaps = 2;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_hull(ctx, &view, &o, 1, made));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "close_gaps"));
    o.close_gaps = 0;
    o.enclose = 1e-5;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_hull(ctx, &view, &o, 1, made));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "too small"));
    TEST_ASSERT_NULL(made[0].positions);
}

static void test_refusals(void)
{
    bvx_hull_options o = {.struct_size = sizeof o, .close_gaps = -1};
    bvx_mesh_view view;

    make_double_walls(0);
    view = maker_view(&given);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_hull(ctx, &view, &o, 1, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_hull(ctx, &view, &o, 1, made));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "close_gaps"));
    o.close_gaps = 0;
    o.shell = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_hull(ctx, &view, &o, 1, made));
    o.shell = 0;
    o.fit.resolution = -3;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_hull(ctx, &view, &o, 1, made));
    view.triangle_count = 0;
    o.fit.resolution = 8;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_hull(ctx, &view, &o, 1, made));
    TEST_ASSERT_NULL(made[0].positions);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_outer_of_two_walls);
    RUN_TEST(test_welded_flipped_and_with_parts_inside);
    RUN_TEST(test_openings_close_up_to_a_width);
    RUN_TEST(test_levels_and_threads);
    RUN_TEST(test_levels_go_around_all_triangles);
    RUN_TEST(test_levels_go_around_bumps);
    RUN_TEST(test_refusals_of_enclose);
    RUN_TEST(test_refusals);
    return UNITY_END();
}
