/* test_repair_thin.c - walls thinner than voxels: they stay whole, about as
 * thick as they are, and are told of. */
#include "solid_support.h"

#include <math.h>

static bvx_repair_report report;

static bvx_mesh repaired_at(bvx_context *c, int32_t resolution, int32_t thin)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_repair_options o = {.struct_size = sizeof o};
    bvx_mesh out;

    memset(&out, 0, sizeof out);
    memset(&report, 0, sizeof report);
    o.fit.resolution = resolution;
    o.thin = thin;
    o.report = &report;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_repair(c, &view, &o, &out), bvx_last_message(c));
    return out;
}

/* Closed, manifold, oriented, nothing crosses. */
static void assert_sound(const bvx_mesh *m)
{
    uint64_t crossings;
    bvx_certificate c;
    bvx_mesh_view v;

    bvx_mesh_view_of(m, &v);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &v, 1, &c));
    TEST_ASSERT_TRUE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented);
    TEST_ASSERT_EQUAL_UINT64(0, c.degenerate + c.duplicates + c.collapsed);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &v, &crossings, NULL, 0));
    TEST_ASSERT_EQUAL_UINT64(0, crossings);
}

static void repair_thin(int32_t resolution, int32_t thin)
{
    bvx_mesh out = repaired_at(ctx, resolution, thin);

    assert_sound(&out);
    bvx_mesh_free(ctx, &out);
}

/* A ball of radius 1 with a cavity, wall thick. [Units: of the voxels at a resolution] */
static void make_shell(double voxels, int32_t resolution)
{
    static const double centre[3] = {0, 0, 0};
    double const inner = 1.0 - voxels * 2.0 / resolution;
    double const r[2][3] = {{1, 1, 1}, {inner, inner, inner}};
    size_t outer;

    maker_clear(&mesh);
    seed = 1;
    maker_star(&mesh, &seed, centre, r[0], 0, 48, 72, 65536);
    outer = mesh.triangles;
    seed = 1;
    maker_star(&mesh, &seed, centre, r[1], 0, 48, 72, 65536);
    maker_flip(&mesh, outer, mesh.triangles);
}

/* A box between two corners, turned by cosine c and sine s about z, then about x. */
static void make_turned_box(const double low[3], const double high[3], double c, double s)
{
    static const uint32_t face[12][3] = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {0, 1, 5}, {0, 5, 4},
                                         {2, 6, 7}, {2, 7, 3}, {0, 4, 6}, {0, 6, 2}, {1, 3, 7}, {1, 7, 5}};
    uint32_t v[8];

    for (int i = 0; i < 8; i++) {
        double const x = i & 1 ? high[0] : low[0], y = i & 2 ? high[1] : low[1], z = i & 4 ? high[2] : low[2];
        double const y2 = x * s + y * c;

        v[i] = maker_vertex(&mesh, x * c - y * s, y2 * c - z * s, y2 * s + z * c);
    }
    for (int f = 0; f < 12; f++) maker_triangle(&mesh, v[face[f][0]], v[face[f][1]], v[face[f][2]]);
}

static void test_shells_of_any_wall_stay_two_surfaces(void)
{
    static const double walls[] = {0.26, 0.45, 0.64, 0.9, 1.28, 1.6};
    int32_t const resolution = quick ? 32 : 64;

    for (size_t w = 0; w < sizeof walls / sizeof walls[0]; w++) {
        make_shell(walls[w], resolution);
        repair_thin(resolution, BVX_THIN_KEEP);
        TEST_ASSERT_EQUAL_UINT64(2, report.after.components);
        TEST_ASSERT_EQUAL_INT64(4, report.after.euler);
        TEST_ASSERT_EQUAL_UINT64(0, report.shelled_triangles);
        TEST_ASSERT_TRUE(fabs(report.after.volume / report.before.volume - 1.0) < 0.04);
        TEST_ASSERT_EQUAL_INT32(walls[w] < 1.5, report.thin_kept);
        if (!report.thin_kept) continue;
        TEST_ASSERT_TRUE(fabs(report.thin_resolution / (resolution * 1.5 / walls[w]) - 1.0) < 0.3);
    }
}

static void test_thin_plates_keep_their_volume(void)
{
    static const double low[3] = {-1, -1, -0.001}, high[3] = {1, 1, 0.001};

    for (int turned = 0; turned < 2; turned++) {
        maker_clear(&mesh);
        make_turned_box(low, high, turned ? 0.96 : 1.0, turned ? 0.28 : 0.0);
        repair_thin(64, BVX_THIN_KEEP);
        TEST_ASSERT_EQUAL_UINT64(1, report.after.components);
        TEST_ASSERT_EQUAL_INT64(2, report.after.euler);
        TEST_ASSERT_TRUE(report.after.volume > 0.0075 && report.after.volume < 0.0090);
    }
}

static void test_thin_box_with_a_cavity(void)
{
    static const double low[3] = {-1, -0.7, -0.3}, high[3] = {1, 0.7, 0.3};
    double in[2][3];
    size_t outer;

    for (int a = 0; a < 3; a++) in[0][a] = low[a] + 0.02, in[1][a] = high[a] - 0.02;
    maker_clear(&mesh);
    make_turned_box(low, high, 0.96, 0.28);
    outer = mesh.triangles;
    make_turned_box(in[0], in[1], 0.96, 0.28);
    maker_flip(&mesh, outer, mesh.triangles);
    repair_thin(64, BVX_THIN_KEEP);
    TEST_ASSERT_EQUAL_UINT64(2, report.after.components);
    TEST_ASSERT_EQUAL_INT64(4, report.after.euler);
    TEST_ASSERT_TRUE(fabs(report.after.volume / report.before.volume - 1.0) < 0.05);
}

/* A seat, four legs and a back of slats of two thirds of a voxel, all in each other. */
static void test_slats_of_a_chair_hold(void)
{
    static const double part[][2][3] = {{{-0.5, -0.5, 0}, {0.5, 0.5, 0.03}},
                                        {{-0.5, 0.455, 0.97}, {0.5, 0.475, 1.03}}};

    maker_clear(&mesh);
    for (size_t p = 0; p < 2; p++) make_turned_box(part[p][0], part[p][1], 1, 0);
    for (int i = 0; i < 9; i++) {
        double const x = -0.47 + i * 0.115, low[3] = {x, 0.46, 0.02}, high[3] = {x + 0.03, 0.47, 1};

        make_turned_box(low, high, 1, 0);
    }
    repair_thin(80, BVX_THIN_KEEP);
    TEST_ASSERT_EQUAL_UINT64(1, report.after.components);
    TEST_ASSERT_EQUAL_INT64(-14, report.after.euler); /* eight windows between nine slats */
    TEST_ASSERT_TRUE(report.thin_kept == 1 && report.shelled_triangles == 0);
    TEST_ASSERT_TRUE(fabs(report.after.volume / report.before.volume - 1.0) < 0.03);
}

/* A wedge of ten degrees: no crumbs before its edge. */
/* A spine, and nine slats that stand on it and go into it. [Units: of voxels, at a resolution of its size] */
static double make_comb(double slat, int32_t resolution, double into, double c, double s)
{
    double const t = slat / resolution;
    double const spine_low[3] = {-1, -1, -1}, spine_high[3] = {1, -0.8, 1};

    maker_clear(&mesh);
    make_turned_box(spine_low, spine_high, c, s);
    for (int i = 0; i < 9; i++) {
        double const x = -0.9 + 0.225 * i;
        double const low[3] = {x - t, -0.8 - into, -1}, high[3] = {x + t, 1, 1};

        make_turned_box(low, high, c, s);
    }
    return 2 * 0.2 * 2 + 9 * 2 * t * 1.8 * 2;
}

/* Next to the spine its face is nearer than a slat's, which hid them: up to five of nine came off. */
static void test_slats_hold_to_what_they_stand_on(void)
{
    static const double turned[2][2] = {{1, 0}, {0.8, 0.6}};

    for (int slat = 3; slat <= 13; slat += long_run ? 2 : 5)
        for (int into = 0; into < 2; into++)
            for (int turn = 0; turn < 2; turn++) {
                int32_t const resolution = 64;
                double const volume = make_comb(0.1 * slat, resolution, 0.1 * into, turned[turn][0],
                                                turned[turn][1]);

                repair_thin(resolution, BVX_THIN_KEEP);
                TEST_ASSERT_EQUAL_UINT64(1, report.after.components);
                TEST_ASSERT_DOUBLE_WITHIN(0.05 * volume, volume, report.after.volume);
            }
}

/* Slats of which some have a centre of the lattice in a face: they came out flat. */
static void test_slats_with_centres_in_their_faces_keep_their_volume(void)
{
    double const volume = make_comb(0.3, 64, 0.1, 1, 0);

    repair_thin(128, BVX_THIN_KEEP);
    TEST_ASSERT_EQUAL_UINT64(1, report.after.components);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * volume, volume, report.after.volume);
}

/* Beside a hole faces may be seen from behind; where all face inward, all were, and no wall was thin. Of two
 * triangles that face either way the first one is taken, whichever it is. */
static void test_walls_of_open_bodies_hold_whichever_way_they_face(void)
{
    int32_t const resolution = quick ? 32 : 64;
    double volume;

    make_shell(0.64, resolution);
    repair_thin(resolution, BVX_THIN_KEEP);
    volume = report.after.volume;
    maker_remove(&mesh, 0);
    repair_thin(resolution, BVX_THIN_KEEP);
    TEST_ASSERT_EQUAL_INT32(1, report.thin_kept);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * volume, volume, report.after.volume);

    maker_flip(&mesh, 0, mesh.triangles);
    repair_thin(resolution, BVX_THIN_KEEP);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * volume, volume, report.after.volume);

    for (size_t t = 0, count = mesh.triangles; t < count; t++) maker_duplicate(&mesh, t);
    maker_flip(&mesh, mesh.triangles / 2, mesh.triangles);
    maker_flip(&mesh, 0, mesh.triangles / 4);
    maker_flip(&mesh, mesh.triangles / 2, 3 * (mesh.triangles / 4));
    repair_thin(resolution, BVX_THIN_KEEP);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * volume, volume, report.after.volume);
}

static void test_acute_edges_hold(void)
{
    static const double p[6][3] = {{0, -1, 0},    {0, 1, 0},       {2, -1, 0.175},
                                   {2, 1, 0.175}, {2, -1, -0.175}, {2, 1, -0.175}};
    static const uint32_t t[8][3] = {{0, 2, 1}, {1, 2, 3}, {0, 1, 4}, {1, 5, 4},
                                     {0, 4, 2}, {1, 3, 5}, {2, 4, 3}, {3, 4, 5}};

    maker_clear(&mesh);
    for (int v = 0; v < 6; v++)
        maker_vertex(&mesh, 0.96 * p[v][0] - 0.28 * p[v][1], 0.96 * p[v][1] + 0.28 * p[v][0],
                     p[v][2] + 0.1 * p[v][0]);
    for (int f = 0; f < 8; f++) maker_triangle(&mesh, t[f][0], t[f][1], t[f][2]);
    repair_thin(64, BVX_THIN_KEEP);
    TEST_ASSERT_EQUAL_UINT64(1, report.after.components);
    TEST_ASSERT_TRUE(report.thin_voxels > 0);
    TEST_ASSERT_TRUE(fabs(report.after.volume / report.before.volume - 1.0) < 0.01);
}

static void test_rods_become_shells(void)
{
    static const double low[3] = {-1, -0.004, -0.004}, high[3] = {1, 0.004, 0.004};

    maker_clear(&mesh);
    make_turned_box(low, high, 0.8, 0.6);
    repair_thin(64, BVX_THIN_KEEP);
    TEST_ASSERT_EQUAL_UINT64(12, report.shelled_triangles);
    TEST_ASSERT_EQUAL_UINT64(1, report.after.components);

    /* Voxels smaller than it make a body of it. */
    repair_thin(512, BVX_THIN_KEEP);
    TEST_ASSERT_EQUAL_UINT64(0, report.shelled_triangles);
}

/* A rod of 24 sides along an axis, its middle line at u, v of the next two axes. */
static double add_rod(int axis, double u, double v, double length, double radius)
{
    static const double quarter[7] = {
        1, 0.9659258262890683, 0.8660254037844386, 0.7071067811865476, 0.5, 0.25881904510252074, 0};
    uint32_t const first = (uint32_t)mesh.vertices;

    for (uint32_t i = 0; i < 50; i++) {
        int const k = (int)(i % 24), q = k % 6;
        double const c = quarter[q], s = quarter[6 - q], r = i < 48 ? radius : 0;
        double const x[4] = {c, -s, -c, s}, y[4] = {s, c, -s, -c};
        double p[3];

        p[axis] = i < 24 || i == 48 ? 0 : length;
        p[(axis + 1) % 3] = u + r * x[k / 6];
        p[(axis + 2) % 3] = v + r * y[k / 6];
        maker_vertex(&mesh, p[0], p[1], p[2]);
    }
    for (uint32_t k = 0; k < 24; k++) {
        uint32_t const a = first + k, b = first + (k + 1) % 24;

        maker_triangle(&mesh, a, b, b + 24);
        maker_triangle(&mesh, a, b + 24, a + 24);
        maker_triangle(&mesh, first + 48, b, a);
        maker_triangle(&mesh, first + 49, a + 24, b + 24);
    }
    return 12 * quarter[5] * radius * radius * length;
}

static void turn_all(double c, double s, int a, int b)
{
    for (size_t v = 0; v < mesh.vertices; v++) {
        double *const p = mesh.p + 3 * v, x = p[a];

        p[a] = c * x - s * p[b];
        p[b] = s * x + c * p[b];
    }
}

/* The surface through points of a round bar is inscribed: 15 % of 2 voxels were lost, 8 of 3, 4 of 4. */
static void test_round_bars_keep_their_volume(void)
{
    static const int32_t thick[4] = {2, 3, 4, 6};

    for (int n = 0; n < 4; n++) {
        double volume = 0, longest = 0;
        bvx_mesh out;

        /* 12 rods along three axes, 8 voxels from each other's middle lines; turned. */
        maker_clear(&mesh);
        for (int i = 0; i < 12; i++)
            volume += add_rod(i % 3, 16.0 * (i / 3 % 2) + (i % 3 == 0 ? 0 : 8),
                              16.0 * (i / 6) + (i % 3 == 2 ? 8 : 0), 32, 0.5 * thick[n]);
        turn_all(0.8, 0.6, 0, 1);
        turn_all(12.0 / 13, 5.0 / 13, 1, 2);
        for (int a = 0; a < 3; a++) {
            double low = mesh.p[a], high = low;

            for (size_t v = 0; v < mesh.vertices; v++) {
                low = fmin(low, mesh.p[3 * v + (size_t)a]);
                high = fmax(high, mesh.p[3 * v + (size_t)a]);
            }
            longest = fmax(longest, high - low);
        }
        out = repaired_at(ctx, (int32_t)(longest + 0.5), BVX_THIN_KEEP);
        assert_sound(&out);
        bvx_mesh_free(ctx, &out);
        TEST_ASSERT_EQUAL_UINT64(12, report.after.components);
        TEST_ASSERT_TRUE(fabs(report.after.volume / volume - 1.0) < 0.03);
    }
}

/* Of equally near triangles the one with the lowest hash counts, which no unit shows in. */
static void test_any_unit_gives_the_same_body(void)
{
    static const double unit[5] = {1, 2, 0.5, 1024, 1099511627776.0};
    bvx_mesh first;

    memset(&first, 0, sizeof first);
    for (int i = 0; i < 5; i++) {
        const float *p, *q;
        bvx_mesh out;

        make_shell(0.7, 40);
        for (size_t k = 0; k < 3 * mesh.vertices; k++) mesh.p[k] *= unit[i];
        out = repaired_at(ctx, 40, BVX_THIN_KEEP);
        TEST_ASSERT_TRUE(report.thin_kept);
        if (i == 0) {
            first = out;
            continue;
        }
        TEST_ASSERT_EQUAL_UINT64(first.vertex_count, out.vertex_count);
        TEST_ASSERT_EQUAL_UINT64(first.triangle_count, out.triangle_count);
        TEST_ASSERT_EQUAL_MEMORY(first.triangles, out.triangles, first.triangle_count * 12);
        p = first.positions;
        q = out.positions;
        for (uint64_t k = 0; k < 3 * first.vertex_count; k++)
            TEST_ASSERT_TRUE((double)p[k] * unit[i] == (double)q[k]);
        bvx_mesh_free(ctx, &out);
    }
    bvx_mesh_free(ctx, &first);
}

static void test_dropped_walls_are_told(void)
{
    uint64_t found;

    make_shell(0.64, 48);
    repair_thin(48, BVX_THIN_KEEP);
    found = report.thin_voxels;
    TEST_ASSERT_TRUE(found > 1000);
    repair_thin(48, BVX_THIN_DROP);
    TEST_ASSERT_EQUAL_UINT64(found, report.thin_voxels);
    TEST_ASSERT_EQUAL_INT32(0, report.thin_kept);
    TEST_ASSERT_TRUE(report.after.components + report.crumbs > 100); /* most of what remains are crumbs */
}

static uint64_t hash_of(bvx_context *c, int32_t resolution, int32_t thin)
{
    bvx_mesh out = repaired_at(c, resolution, thin);
    uint64_t hash;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &out, &hash));
    bvx_mesh_free(c, &out);
    return hash;
}

static void test_thick_bodies_are_left_alone(void)
{
    static const double centre[3] = {0, 0, 0}, r[3] = {1, 0.8, 0.6};
    static const double low[3] = {-1, -0.7, -0.3}, high[3] = {1, 0.7, 0.3};
    bvx_context *const threads = suite_context(3, BVX_CPU_BEST);

    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, r, 0, 24, 36, 65536);
    TEST_ASSERT_EQUAL_HEX64(hash_of(ctx, 48, BVX_THIN_DROP), hash_of(ctx, 48, BVX_THIN_KEEP));
    TEST_ASSERT_EQUAL_UINT64(0, report.thin_voxels);
    TEST_ASSERT_TRUE(report.thin_resolution == 0 && report.thin_kept == 0);
    maker_clear(&mesh);
    make_turned_box(low, high, 0.96, 0.28);
    TEST_ASSERT_EQUAL_HEX64(hash_of(ctx, 48, BVX_THIN_DROP), hash_of(ctx, 48, BVX_THIN_KEEP));
    TEST_ASSERT_EQUAL_UINT64(0, report.thin_voxels);

    make_shell(0.7, 40);
    TEST_ASSERT_EQUAL_HEX64(hash_of(ctx, 40, BVX_THIN_KEEP), hash_of(threads, 40, BVX_THIN_KEEP));
    bvx_context_destroy(threads);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_shells_of_any_wall_stay_two_surfaces);
    RUN_TEST(test_thin_plates_keep_their_volume);
    RUN_TEST(test_thin_box_with_a_cavity);
    RUN_TEST(test_slats_of_a_chair_hold);
    RUN_TEST(test_slats_hold_to_what_they_stand_on);
    RUN_TEST(test_slats_with_centres_in_their_faces_keep_their_volume);
    RUN_TEST(test_walls_of_open_bodies_hold_whichever_way_they_face);
    RUN_TEST(test_acute_edges_hold);
    RUN_TEST(test_rods_become_shells);
    RUN_TEST(test_round_bars_keep_their_volume);
    RUN_TEST(test_any_unit_gives_the_same_body);
    RUN_TEST(test_dropped_walls_are_told);
    RUN_TEST(test_thick_bodies_are_left_alone);
    return UNITY_END();
}
