/* test_points.c - clouds of points: lattices around them, voxels by counting one point after the other,
 * bodies by moving a cube, and files of points. */
#include "core/core.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>
#include <stdlib.h>

enum { MOST_POINTS = 4000 };

static uint64_t seed;
static double cloud[MOST_POINTS][3];
static bvx_mesh_view view;

void setUp(void)
{
    suite_open(0);
    seed = 99;
    memset(&view, 0, sizeof view);
    view.positions = cloud;
    view.position_type = BVX_F64;
}

void tearDown(void)
{
    suite_close();
}

/* Coordinates on a coarse grid, so that many points share a voxel or lie on its faces. */
static void scatter(uint64_t count, int32_t steps, double step)
{
    view.vertex_count = count;
    for (uint64_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++) cloud[i][a] = 1.5 + step * (double)maker_below(&seed, steps);
}

static void expect_refused(bvx_status want, bvx_status got, const char *word)
{
    TEST_ASSERT_EQUAL_INT32(want, got);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx));
}

/* ---- Voxels ---- */

/* The voxel of a coordinate by the header's words; dims at the lattice's high side is its last voxel. */
static int32_t slow_voxel(const bvx_lattice *l, int a, double p)
{
    double const steps = (double)(1 << l->fraction_bits);
    double const q = floor((p - l->origin[a]) * (steps / l->spacing[a]) + 0.5);
    double const v = floor(q / steps);
    return q == steps * l->dims[a] ? l->dims[a] - 1 : v < -1 ? -1 : v > l->dims[a] ? l->dims[a] : (int32_t)v;
}

static void expect_counted(const bvx_lattice *l, const bvx_window *w, int32_t minimum)
{
    size_t const n = (size_t)w->size[0] * (size_t)w->size[1] * (size_t)w->size[2];
    uint32_t *const count = calloc(n, sizeof *count);
    bvx_points_options o = {.struct_size = sizeof o};
    bvx_points_report report, want = {0};
    bvx_grid g = {0};

    TEST_ASSERT_NOT_NULL(count);
    for (uint64_t i = 0; i < view.vertex_count; i++) {
        int32_t v[3];
        int inside = 1;
        for (int a = 0; a < 3; a++) {
            v[a] = slow_voxel(l, a, cloud[i][a]) - w->low[a];
            inside &= v[a] >= 0 && v[a] < w->size[a];
        }
        *(inside ? &want.inside : &want.outside) += 1;
        if (inside)
            count[((size_t)v[2] * (size_t)w->size[1] + (size_t)v[1]) * (size_t)w->size[0] + (size_t)v[0]]++;
    }
    for (size_t i = 0; i < n; i++) want.occupied += count[i] >= (uint32_t)minimum;
    o.minimum = minimum;
    o.window = *w;
    o.report = &report;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_points(ctx, &view, l, &o, &g));
    TEST_ASSERT_EQUAL_MEMORY(&want, &report, sizeof want);
    for (size_t i = 0; i < n; i++) {
        int32_t const x = (int32_t)(i % (size_t)w->size[0]);
        int32_t const y = (int32_t)(i / (size_t)w->size[0] % (size_t)w->size[1]);
        TEST_ASSERT_EQUAL_INT(count[i] >= (uint32_t)minimum,
                              bvx_grid_get(&g, x, y, (int32_t)(i / (size_t)w->size[0] / (size_t)w->size[1])));
    }
    bvx_grid_free(ctx, &g);
    free(count);
}

static void test_points_are_counted_in_their_voxels(void)
{
    static const int32_t dims[6] = {1, 63, 64, 65, 128, 129};

    for (int d = 0; d < 6; d++)
        for (int32_t minimum = 1; minimum <= 9; minimum += 1 + minimum / 3) {
            double const origin[3] = {1.5, 1.25, 2}, spacing[3] = {0.5, 0.75, 1};
            int32_t const sides[3] = {dims[d], 5, 4};
            bvx_window const whole = {{0, 0, 0}, {dims[d], 5, 4}};
            bvx_window const part = {{dims[d] / 3, 1, 1}, {dims[d] - dims[d] / 3, 3, 2}};
            bvx_lattice l;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, sides, &l));
            scatter(d < 3 ? 700 : MOST_POINTS, d == 0 ? 12 : 4 * dims[d] < 60 ? 4 * dims[d] : 60, 0.125);
            expect_counted(&l, &whole, minimum);
            expect_counted(&l, &part, minimum);
        }
}

/* A lattice fitted to a cloud holds all of its points, also those at its high ends. */
static void test_a_fitted_lattice_holds_the_cloud(void)
{
    for (int round = 0; round < 40; round++) {
        bvx_lattice_options o = {.struct_size = sizeof o};
        bvx_lattice l;
        bvx_points_options p = {.struct_size = sizeof p};
        bvx_points_report report;
        bvx_grid g = {0};
        scatter(2 + (uint64_t)maker_below(&seed, 500), 1000, 0.001 * (1 + maker_below(&seed, 50)));
        if (round % 3 == 0) o.resolution = 1 + maker_below(&seed, 70);
        if (round % 3 == 1)
            o.spacing[0] = o.spacing[1] = o.spacing[2] = 0.07 + 0.01 * maker_below(&seed, 100);
        if (round % 3 == 2)
            for (int a = 0; a < 3; a++) o.axis_resolution[a] = 1 + maker_below(&seed, 40);
        o.padding = round % 2;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit_with(ctx, &view, &o, &l));
        p.report = &report;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_points(ctx, &view, &l, &p, &g));
        TEST_ASSERT_EQUAL_UINT64(0, report.outside);
        TEST_ASSERT_TRUE(report.occupied >= 1);
        bvx_grid_free(ctx, &g);
    }
}

/* Single precision, a stride, and triangles that are no triangles. */
static void test_points_of_any_view(void)
{
    static float packed[40][5];
    static const uint32_t wild[3] = {7, 1000000, 3};
    bvx_grid a = {0}, b = {0};
    bvx_mesh_view strided;
    bvx_lattice_options o = {.struct_size = sizeof o};
    bvx_lattice l, m;
    uint64_t first = 0, second = 1;

    scatter(40, 30, 0.25);
    for (int i = 0; i < 40; i++)
        for (int k = 0; k < 3; k++) packed[i][k] = (float)cloud[i][k];
    memset(&strided, 0, sizeof strided);
    strided.positions = packed;
    strided.position_type = BVX_F32;
    strided.position_stride = 20;
    strided.vertex_count = 40;
    o.resolution = 9;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit_with(ctx, &view, &o, &l));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit_with(ctx, &strided, &o, &m));
    TEST_ASSERT_EQUAL_MEMORY(&l, &m, sizeof l);
    strided.indices = wild;
    strided.index_type = BVX_U32;
    strided.triangle_count = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_points(ctx, &view, &l, NULL, &a));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_points(ctx, &strided, &l, NULL, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(ctx, &a, &first));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(ctx, &b, &second));
    TEST_ASSERT_EQUAL_HEX64(first, second);
    bvx_grid_free(ctx, &a);
    bvx_grid_free(ctx, &b);
}

/* ---- Bodies ---- */

/* 0 beyond the lattice. */
static int set_in(const bvx_grid *g, int32_t x, int32_t y, int32_t z)
{
    if (x < 0 || y < 0 || z < 0 || x >= g->size[0] || y >= g->size[1] || z >= g->size[2]) return 0;
    return bvx_grid_get(g, x, y, z);
}

static int cube_is_empty(const bvx_grid *g, const int32_t low[3], int32_t side)
{
    for (int32_t i = 0; i < side * side * side; i++)
        if (set_in(g, low[0] + i % side, low[1] + i / side % side, low[2] + i / side / side)) return 0;
    return 1;
}

/* The body by its definition: a cube goes step by step from where it
 * touches no voxel of the lattice; what it covers is outside. */
static void slow_body(const bvx_grid *shell, int32_t side, bvx_grid *body, uint64_t *pockets)
{
    /* places from -side on */
    int32_t const n[3] = {shell->size[0] + side + 1, shell->size[1] + side + 1, shell->size[2] + side + 1};
    size_t const places = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    uint8_t *const state = calloc(places, 1); /* 1: free, 2: reached from outside, 3: in a pocket */
    size_t *const stack = malloc((places + 1) * sizeof *stack);

    TEST_ASSERT_NOT_NULL(state);
    TEST_ASSERT_NOT_NULL(stack);
    for (size_t i = 0; i < places; i++) {
        int32_t const low[3] = {(int32_t)(i % (size_t)n[0]) - side,
                                (int32_t)(i / (size_t)n[0] % (size_t)n[1]) - side,
                                (int32_t)(i / (size_t)n[0] / (size_t)n[1]) - side};
        state[i] = (uint8_t)cube_is_empty(shell, low, side);
    }
    *pockets = 0;
    for (size_t first = 0; first < places; first++) {
        size_t used = 0;
        uint8_t const mark = first == 0 ? 2 : 3;
        if (state[first] != 1) continue;
        *pockets += mark == 3;
        state[first] = mark;
        stack[used++] = first;
        while (used > 0) {
            size_t const i = stack[--used], step[3] = {1, (size_t)n[0], (size_t)n[0] * (size_t)n[1]};
            int32_t const v[3] = {(int32_t)(i % (size_t)n[0]), (int32_t)(i / (size_t)n[0] % (size_t)n[1]),
                                  (int32_t)(i / (size_t)n[0] / (size_t)n[1])};
            for (int way = 0; way < 6; way++) {
                int const a = way / 2, up = way % 2;
                size_t const j = up ? i + step[a] : i - step[a];
                if (up ? v[a] + 1 == n[a] : v[a] == 0) continue;
                if (state[j] != 1) continue;
                state[j] = mark;
                stack[used++] = j;
            }
        }
    }
    for (int32_t z = 0; z < body->size[2]; z++)
        for (int32_t y = 0; y < body->size[1]; y++)
            for (int32_t x = 0; x < body->size[0]; x++) {
                int outside = 0;
                for (int32_t i = 0; i < side * side * side; i++) {
                    size_t const u = (size_t)(x + side - i % side);
                    size_t const v = (size_t)(y + side - i / side % side);
                    size_t const w = (size_t)(z + side - i / side / side);
                    outside |= state[(w * (size_t)n[1] + v) * (size_t)n[0] + u] == 2;
                }
                bvx_grid_set(body, x, y, z, !outside);
            }
    free(state);
    free(stack);
}

/* Points on a ball, none at its top: the larger the cube, the less it gets in. */
static void test_a_body_is_closed_and_filled(void)
{
    double const origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t const dims[3] = {26, 22, 23};
    bvx_grid shell = {0}, body = {0}, want = {0};
    bvx_points_report report;
    bvx_points_options o = {.struct_size = sizeof o};
    bvx_lattice l;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, NULL, &want));
    view.vertex_count = 700;
    for (uint64_t i = 0; i < view.vertex_count; i++) { /* a spiral from pole to pole */
        double const z = 1 - 2 * ((double)i + 0.5) / 700;
        double const r = sqrt(1 - z * z);
        double const turn = 2.399963229728653 * (double)i;
        cloud[i][0] = 11 + 9 * r * cos(turn);
        cloud[i][1] = 11 + 9 * r * sin(turn);
        cloud[i][2] = z > 0.97 ? 3 : 12.5 + 9 * z;
    }
    o.report = &report;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_points(ctx, &view, &l, &o, &shell));
    TEST_ASSERT_EQUAL_UINT64(0, report.pockets + report.filled);
    o.body = 1;
    for (int32_t gap = 0; gap < (quick ? 3 : 7); gap++) {
        uint64_t pockets = 0, set = 0;
        o.close_gaps = gap;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_points(ctx, &view, &l, &o, &body));
        slow_body(&shell, gap + 1, &want, &pockets);
        TEST_ASSERT_EQUAL_MEMORY(want.words, body.words, (size_t)bvx_grid_bound(&l, NULL) * 8);
        TEST_ASSERT_EQUAL_UINT64(pockets, report.pockets);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &body, &set));
        TEST_ASSERT_EQUAL_UINT64(set, report.occupied + report.filled);
        if (gap == 0) TEST_ASSERT_EQUAL_INT(0, bvx_grid_get(&body, 11, 11, 12));
        if (gap == 6) TEST_ASSERT_EQUAL_INT(1, bvx_grid_get(&body, 11, 11, 12));
        bvx_grid_free(ctx, &body);
    }
    bvx_grid_free(ctx, &shell);
    bvx_grid_free(ctx, &want);
}

static void test_points_refuse(void)
{
    bvx_window const part = {{0, 0, 0}, {1, 1, 1}};
    bvx_points_options o;
    bvx_lattice_options fit = {.struct_size = sizeof fit};
    bvx_lattice l;
    bvx_grid g = {0};

    scatter(20, 30, 0.25);
    fit.resolution = 4;
    expect_refused(BVX_ERR_ARGUMENT, bvx_lattice_fit_with(ctx, NULL, &fit, &l), "mesh is NULL");
    expect_refused(BVX_ERR_ARGUMENT, bvx_lattice_fit_with(ctx, &view, NULL, &l), "exactly one of");
    expect_refused(BVX_ERR_ARGUMENT, bvx_lattice_fit_with(ctx, &view, &fit, NULL), "lattice is NULL");
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit_with(ctx, &view, &fit, &l));
    for (int which = 0; which < 6; which++) {
        static const char *const words[6] = {"minimum is -1", "body is 2", "close_gaps is -1",
                                             "requires body", "reserved",  "whole lattice"};
        o = (bvx_points_options){.struct_size = sizeof o};
        if (which == 0) o.minimum = -1;
        if (which == 1) o.body = 2;
        if (which == 2) o.close_gaps = -1;
        if (which == 3) o.close_gaps = 1;
        if (which == 4) o.reserved = 1;
        if (which == 5) o.body = 1;
        if (which == 5) o.window = part;
        expect_refused(BVX_ERR_ARGUMENT, bvx_voxelize_points(ctx, &view, &l, &o, &g), words[which]);
    }
    expect_refused(BVX_ERR_ARGUMENT, bvx_voxelize_points(ctx, &view, &l, NULL, NULL), "grid is NULL");
    expect_refused(BVX_ERR_ARGUMENT, bvx_voxelize_points(ctx, NULL, &l, NULL, &g), "points is NULL");
    expect_refused(BVX_ERR_ARGUMENT, bvx_voxelize_points(ctx, &view, NULL, NULL, &g), "lattice is NULL");
    cloud[13][1] = (double)NAN;
    expect_refused(BVX_ERR_RANGE, bvx_voxelize_points(ctx, &view, &l, NULL, &g), "vertex 13");
    expect_refused(BVX_ERR_RANGE, bvx_lattice_fit_with(ctx, &view, &fit, &l), "vertex 13");
    view.vertex_count = 0;
    expect_refused(BVX_ERR_EMPTY, bvx_voxelize_points(ctx, &view, &l, NULL, &g), "no points");
    expect_refused(BVX_ERR_EMPTY, bvx_lattice_fit_with(ctx, &view, &fit, &l), "no points");
    TEST_ASSERT_NULL(g.words);
    scatter(3, 1, 1);
    expect_refused(BVX_ERR_EMPTY, bvx_lattice_fit_with(ctx, &view, &fit, &l), "one point");
}

/* ---- Files ---- */

static void expect_xyz(const char *text, uint64_t count, const double *want)
{
    bvx_mesh m = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_read_points(ctx, text, strlen(text), BVX_FORMAT_XYZ, &m),
                                    text);
    TEST_ASSERT_EQUAL_UINT64(count, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(0, m.triangle_count);
    TEST_ASSERT_EQUAL_INT32(BVX_F64, m.position_type);
    TEST_ASSERT_EQUAL_MEMORY(want, m.positions, (size_t)count * 24);
    bvx_mesh_free(ctx, &m);
}

static void test_xyz_is_read(void)
{
    static const double two[6] = {1, -2.5, 3, 4e-1, 5, 6};

    expect_xyz("1 -2.5 3\n4e-1 5 6\n", 2, two);
    expect_xyz("1 -2.5 3\r\n4e-1 5 6", 2, two);
    expect_xyz("  1\t-2.5,3 0.1 0.2 word\n\n.4;5; 6 ; 7\n \n", 2, two);
    expect_xyz("# a cloud\n// x y z\n1 -2.5 3 # end\n% more\n0.4 5 6", 2, two);
    expect_xyz("X Y Z R G B\n1 -2.5 3 255 0 0\n0.4 5 6 1 2 3\n", 2, two);
    expect_xyz("\xef\xbb\xbf"
               "2\n1 -2.5 3\r0.4 5 6\r",
               2, two);
    expect_xyz("x,y,z\n1,-2.5,3\n0.4,5,6\n", 2, two);
}

static void test_xyz_refuses(void)
{
    bvx_mesh m = {0};

#define READ(text) bvx_read_points(ctx, text, sizeof text - 1, BVX_FORMAT_XYZ, &m)
    expect_refused(BVX_ERR_EMPTY, READ(""), "no bytes");
    expect_refused(BVX_ERR_EMPTY, READ("# nothing\n\n"), "no points");
    expect_refused(BVX_ERR_EMPTY, READ("hello\n"), "no points");
    expect_refused(BVX_ERR_FORMAT, READ("1 2 3\n4 5\n"), "line 2: the line ends where a coordinate");
    expect_refused(BVX_ERR_FORMAT, READ("1 2 3\n4 five 6\n"), "found 'five'");
    expect_refused(BVX_ERR_FORMAT, READ("1 2 3\n4 5 6x\n"), "line 2: expected a coordinate, found '6x'");
    expect_refused(BVX_ERR_RANGE, READ("1 2 3\n\n4 nan 6\n"), "line 3: point 1");
    expect_refused(BVX_ERR_RANGE, READ("1 2 1e999\n"), "line 1: point 0");
    expect_refused(BVX_ERR_ARGUMENT, bvx_read_points(ctx, "1 2 3", 5, BVX_FORMAT_STL, &m), "take .ply .xyz");
    expect_refused(BVX_ERR_ARGUMENT, bvx_read_points(ctx, NULL, 5, BVX_FORMAT_XYZ, &m), "bytes is NULL");
    expect_refused(BVX_ERR_ARGUMENT, bvx_read_points(ctx, "1 2 3", 5, BVX_FORMAT_XYZ, NULL),
                   "points is NULL");
    TEST_ASSERT_NULL(m.positions);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, READ("1 2 3"));
    m.owned = 0; /* as if they were the caller's */
    expect_refused(BVX_ERR_ARGUMENT, READ("1 2 3"), "brings arrays");
    m.owned = 1;
#undef READ
    bvx_mesh_free(ctx, &m);
}

static void test_ply_points_are_read(void)
{
    static const char alone[] =
        "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nend_header\n1 2 3 255 0 9\n4 5 6 0 1 2\n";
    static const char faced[] =
        "ply\nformat ascii 1.0\nelement vertex 3\nproperty double x\nproperty double y\nproperty double z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n1 2 3\n4 5 6\n7 8 9\n3 0 1 2\n";
    static const char none[] =
        "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
    static const float floats[6] = {1, 2, 3, 4, 5, 6};
    static const double doubles[9] = {1, 2, 3, 4, 5, 6, 7, 8, 9};
    static const uint8_t colours[8] = {255, 0, 9, 255, 0, 1, 2, 255};
    bvx_mesh m = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_points(ctx, alone, sizeof alone - 1, BVX_FORMAT_PLY, &m));
    TEST_ASSERT_EQUAL_UINT64(2, m.vertex_count);
    TEST_ASSERT_EQUAL_INT32(BVX_F32, m.position_type);
    TEST_ASSERT_EQUAL_MEMORY(floats, m.positions, sizeof floats);
    TEST_ASSERT_EQUAL_MEMORY(colours, m.colours, sizeof colours);
    bvx_mesh_free(ctx, &m);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_points(ctx, faced, sizeof faced - 1, BVX_FORMAT_PLY, &m));
    TEST_ASSERT_EQUAL_UINT64(3, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(0, m.triangle_count);
    TEST_ASSERT_EQUAL_MEMORY(doubles, m.positions, sizeof doubles);
    bvx_mesh_free(ctx, &m);
    expect_refused(BVX_ERR_EMPTY, bvx_read_points(ctx, none, sizeof none - 1, BVX_FORMAT_PLY, &m),
                   "no vertices");
    expect_refused(BVX_ERR_FORMAT, bvx_read_points(ctx, alone, sizeof alone - 8, BVX_FORMAT_PLY, &m), "PLY");
    expect_refused(BVX_ERR_EMPTY, bvx_read_mesh(ctx, alone, sizeof alone - 1, BVX_FORMAT_PLY, NULL, &m),
                   "no faces");
}

static void test_xyz_has_a_format(void)
{
    TEST_ASSERT_EQUAL_INT32(BVX_FORMAT_XYZ, bvx_format_of_name("a.xyz"));
    TEST_ASSERT_EQUAL_INT32(BVX_FORMAT_XYZ, bvx_format_of_name("b/A.XYZ.gz"));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_points_are_counted_in_their_voxels);
    RUN_TEST(test_a_fitted_lattice_holds_the_cloud);
    RUN_TEST(test_points_of_any_view);
    RUN_TEST(test_a_body_is_closed_and_filled);
    RUN_TEST(test_points_refuse);
    RUN_TEST(test_xyz_is_read);
    RUN_TEST(test_xyz_refuses);
    RUN_TEST(test_ply_points_are_read);
    RUN_TEST(test_xyz_has_a_format);
    return UNITY_END();
}
