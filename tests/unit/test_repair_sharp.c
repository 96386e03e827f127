/* test_repair_sharp.c - sharp edges are kept where a mesh has them, and parts are those of the input. */
#include "solid_support.h"

#include <math.h>

static bvx_repair_report report;

static bvx_repair_options sharp_options(int32_t resolution, int32_t sharp)
{
    bvx_repair_options o = {.struct_size = sizeof o};
    o.fit.resolution = resolution;
    o.placing.sharp = BVX_SHARP_NEVER + sharp;
    o.report = &report;
    return o;
}

static bvx_mesh repaired(const bvx_repair_options *o)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_mesh out = {0};
    uint64_t crossings;
    bvx_mesh_view made;

    memset(&report, 0, sizeof report);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_repair(ctx, &view, o, &out), bvx_last_message(ctx));
    TEST_ASSERT_TRUE(report.after.closed && report.after.edge_manifold && report.after.vertex_manifold &&
                     report.after.oriented);
    bvx_mesh_view_of(&out, &made);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &made, &crossings, NULL, 0));
    TEST_ASSERT_EQUAL_UINT64(0, crossings);
    return out;
}

static void make_turned_box(void)
{
    double const low[3] = {0, 0, 0}, high[3] = {3, 4, 5};
    maker_clear(&mesh);
    maker_box(&mesh, low, high);
    maker_turn(&mesh);
}

static void make_smooth_star(void)
{
    double const at[3] = {0, 0, 0}, radius[3] = {2, 2, 2};
    uint64_t same = 77;
    maker_clear(&mesh);
    maker_star(&mesh, &same, at, radius, 0, 24, 36, 65536);
}

/* The mean distance, the greater of both ways. So many samples give a mean within a percent, where bounds are a factor of three. */
static double mean_distance(const bvx_mesh *out)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_mesh_view made;
    bvx_distance_report d;
    bvx_mesh_view_of(out, &made);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, &view, &made, 60000, 1, &d));
    return d.mean_a_to_b > d.mean_b_to_a ? d.mean_a_to_b : d.mean_b_to_a;
}

static int32_t thin = BVX_THIN_KEEP;

static double distance_with(int32_t resolution, int32_t sharp)
{
    bvx_repair_options o = sharp_options(resolution, sharp);
    bvx_mesh out;
    double d;

    o.thin = thin;
    out = repaired(&o);
    d = mean_distance(&out);
    bvx_mesh_free(ctx, &out);
    return d;
}

/* ---- Sharp where the mesh is ---- */

static void test_default_keeps_a_boxs_edges(void)
{
    double plain, by_default;

    make_turned_box();
    plain = distance_with(40, 0);
    TEST_ASSERT_EQUAL_INT32(0, report.sharp);
    by_default = distance_with(40, -1);
    TEST_ASSERT_EQUAL_INT32(1, report.sharp);
    TEST_ASSERT_TRUE(by_default < plain / 3);
}

static void test_default_leaves_a_ball_smooth(void)
{
    bvx_repair_options o = sharp_options(24, -1);
    bvx_mesh by_default, plain;

    make_smooth_star();
    by_default = repaired(&o);
    TEST_ASSERT_EQUAL_INT32(0, report.sharp);
    o.placing.sharp = BVX_SHARP_NEVER;
    plain = repaired(&o);
    TEST_ASSERT_EQUAL_UINT64(plain.vertex_count, by_default.vertex_count);
    TEST_ASSERT_EQUAL_MEMORY(plain.positions, by_default.positions, plain.vertex_count * 12);
    bvx_mesh_free(ctx, &plain);
    bvx_mesh_free(ctx, &by_default);
}

/* Three vertices a triangle, as .stl has them: edges are found by place. */
static void test_loose_triangles_have_edges_too(void)
{
    maker_mesh soup = {0};

    make_turned_box();
    for (size_t i = 0; i < 3 * mesh.triangles; i++) {
        const double *const p = mesh.p + 3 * (size_t)mesh.t[i];
        maker_vertex(&soup, p[0], p[1], p[2]);
    }
    for (uint32_t t = 0; t < (uint32_t)mesh.triangles; t++)
        maker_triangle(&soup, 3 * t, 3 * t + 1, 3 * t + 2);
    maker_free(&mesh);
    mesh = soup;
    distance_with(24, -1);
    TEST_ASSERT_EQUAL_INT32(1, report.sharp);
}

static void test_boolean_is_sharp_where_one_body_is(void)
{
    /* its corners stick out of the ball */
    static const double low[3] = {-1.5, -1.5, -1.5}, high[3] = {1.5, 1.5, 1.5};
    bvx_boolean_report r;
    bvx_boolean_options o;
    maker_mesh box = {0};

    for (int smooth = 0; smooth < 2; smooth++) {
        bvx_mesh_view view[2];
        bvx_mesh out = {0};
        make_smooth_star();
        maker_clear(&box);
        maker_box(&box, low, high);
        view[0] = maker_view(&mesh);
        view[1] = smooth ? view[0] : maker_view(&box);
        o = (bvx_boolean_options){.struct_size = sizeof o};
        o.fit.resolution = 24;
        o.report = &r;
        TEST_ASSERT_EQUAL_INT32(BVX_SHARP_AUTO, o.placing.sharp);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_boolean(ctx, &view[0], &view[1], BVX_BOOLEAN_UNION, &o, &out));
        TEST_ASSERT_EQUAL_INT32(!smooth, r.sharp);
        TEST_ASSERT_EQUAL(!smooth, r.surface.sharp_cells != 0);
        bvx_mesh_free(ctx, &out);
    }
    maker_free(&box);
}

/* ---- Acute edges ---- */

/* A prism over an outline of corners that are seen from its middle. */
static void add_prism(const double (*outline)[2], uint32_t n, double low, double high)
{
    uint32_t const first = (uint32_t)mesh.vertices;
    double middle[2] = {0, 0};
    uint32_t bottom, top;

    for (uint32_t k = 0; k < 2; k++)
        for (uint32_t i = 0; i < n; i++)
            maker_vertex(&mesh, outline[i][0], outline[i][1], k == 0 ? low : high);
    for (uint32_t i = 0; i < n; i++)
        for (int a = 0; a < 2; a++) middle[a] += outline[i][a] / n;
    bottom = maker_vertex(&mesh, middle[0], middle[1], low);
    top = maker_vertex(&mesh, middle[0], middle[1], high);
    for (uint32_t i = 0; i < n; i++) {
        uint32_t const j = (i + 1) % n;
        maker_quad(&mesh, first + i, first + j, first + n + j, first + n + i, 0);
        maker_triangle(&mesh, bottom, first + j, first + i);
        maker_triangle(&mesh, top, first + n + i, first + n + j);
    }
}

/* Half the tangent of the edge: 10, 15, 20, 30, 40, 50, 60 degrees. */
static const double half_tangent[7] = {0.0874887, 0.1316525, 0.1763270, 0.2679492,
                                       0.3639702, 0.4663077, 0.5773503};

static void make_wedge(int k)
{
    double const outline[3][2] = {{0, 0}, {8, -8 * half_tangent[k]}, {8, 8 * half_tangent[k]}};
    maker_clear(&mesh);
    add_prism(outline, 3, 0, 6);
    maker_turn(&mesh);
}

/* A star of n points in a plane, as thick as wide: acute edges up and down. */
static void make_star_prism(uint32_t n)
{
    static const double circle[12][2] = {
        {1, 0},  {0.8660254, 0.5},   {0.5, 0.8660254},   {0, 1},  {-0.5, 0.8660254}, {-0.8660254, 0.5},
        {-1, 0}, {-0.8660254, -0.5}, {-0.5, -0.8660254}, {0, -1}, {0.5, -0.8660254}, {0.8660254, -0.5}};
    double outline[12][2];

    maker_clear(&mesh);
    for (uint32_t i = 0; i < 2 * n; i++)
        for (int a = 0; a < 2; a++) outline[i][a] = circle[i * (12 / (2 * n))][a] * (i % 2 == 0 ? 5 : 1.5);
    add_prism((const double(*)[2])outline, 2 * n, 0, 2);
    maker_turn(&mesh);
}

/* A needle of a pyramid. */
static void make_pyramid(double height)
{
    maker_clear(&mesh);
    maker_vertex(&mesh, -1, -1, 0);
    maker_vertex(&mesh, 1, -1, 0);
    maker_vertex(&mesh, 1, 1, 0);
    maker_vertex(&mesh, -1, 1, 0);
    maker_vertex(&mesh, 0.1, 0.2, height);
    maker_quad(&mesh, 3, 2, 1, 0, 0);
    for (uint32_t i = 0; i < 4; i++) maker_triangle(&mesh, i, (i + 1) % 4, 4);
    maker_turn(&mesh);
}

/* Frames of bars with acute edges within each other: rings of a rhombic section around a square. */
static void make_frame(void)
{
    static const double round[4][2] = {{-4, -4}, {4, -4}, {4, 4}, {-4, 4}};
    /* outward, up: 25 degrees */
    static const double section[4][2] = {{1, 0}, {0, 0.22}, {-1, 0}, {0, -0.22}};

    maker_clear(&mesh);
    for (int k = 0; k < 4; k++)
        for (int s = 0; s < 4; s++) {
            double const f = 1 + section[s][0] / 4;
            maker_vertex(&mesh, round[k][0] * f, round[k][1] * f, section[s][1]);
        }
    for (uint32_t k = 0; k < 4; k++)
        for (uint32_t s = 0; s < 4; s++) {
            uint32_t const next = (k + 1) % 4, up = (s + 1) % 4;
            maker_quad(&mesh, 4 * k + s, 4 * next + s, 4 * next + up, 4 * k + up, 0);
        }
    maker_turn(&mesh);
}

/* Parts in are parts out, cavities too; and the default is about three times as near as the surface
 * without sharp edges and without its thin walls. The finest lattice, which takes most of the time, is for some
 * bodies of each kind. */
static void assert_parts_stay(int finest)
{
    static const int32_t resolutions[3] = {24, 61, 96};
    int const end = quick || !(finest || getenv("BITVOX_LARGE") != NULL) ? 2 : 3;
    for (int i = quick ? 1 : 0; i < end; i++) {
        double plain, sharp;

        thin = BVX_THIN_SHELL;
        plain = distance_with(resolutions[i], 0);
        thin = BVX_THIN_KEEP;
        sharp = distance_with(resolutions[i], -1);
        TEST_ASSERT_EQUAL_INT32(1, report.sharp);
        TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_NOTHING, report.needs);
        TEST_ASSERT_EQUAL_UINT64(1, report.before.components);
        TEST_ASSERT_EQUAL_UINT64(1, report.after.components);
        TEST_ASSERT_TRUE(sharp < 0.34 * plain);
    }
}

static void test_wedges_stay_whole(void)
{
    for (int k = 0; k < 7; k++) {
        make_wedge(k);
        assert_parts_stay(k % 3 == 0);
        TEST_ASSERT_EQUAL_UINT64(0, report.crumbs);
    }
}

static void test_stars_and_pyramids_stay_whole(void)
{
    make_star_prism(3);
    assert_parts_stay(1);
    make_star_prism(6);
    assert_parts_stay(0);
    for (int k = 0; k < 3; k++) {
        make_pyramid(4 << k);
        assert_parts_stay(k == 2);
    }
}

static void test_frame_stays_whole(void)
{
    make_frame();
    assert_parts_stay(1);
}

/* Without its thin walls a wedge leaves crumbs, which are there when they are kept. */
static void test_crumbs_are_counted_and_kept_when_asked(void)
{
    bvx_repair_options o = sharp_options(61, -1);
    uint64_t crumbs;
    bvx_mesh out;

    make_wedge(1);
    o.thin = BVX_THIN_SHELL;
    out = repaired(&o);
    crumbs = report.crumbs;
    TEST_ASSERT_TRUE(crumbs > 3 && report.parts_dropped + report.cavities_dropped == crumbs);
    bvx_mesh_free(ctx, &out);
    o.parts.keep_crumbs = 1;
    out = repaired(&o);
    TEST_ASSERT_EQUAL_UINT64(0, report.crumbs);
    TEST_ASSERT_EQUAL_UINT64(0, report.parts_dropped + report.cavities_dropped);
    TEST_ASSERT_TRUE(report.after.components > 1);
    bvx_mesh_free(ctx, &out);
}

/* Small parts that the mesh has stay, beside a body and only; so do small cavities. */
static void test_small_parts_of_the_mesh_stay(void)
{
    bvx_repair_options const o = sharp_options(40, -1);
    double const low[3] = {0, 0, 0}, high[3] = {4, 4, 4};
    bvx_mesh out;
    size_t hole;

    maker_clear(&mesh);
    maker_box(&mesh, low, high);
    for (int i = 0; i < 5; i++) { /* of 1.4 voxels, a voxel and a half and more beside the box */
        double const a[3] = {4.16 + 0.04 * i, 0.5 * i, 0.7 * i};
        double const b[3] = {a[0] + 0.14, a[1] + 0.14, a[2] + 0.14};
        maker_box(&mesh, a, b);
    }
    hole = mesh.triangles;
    {
        double const a[3] = {2, 2, 2}, b[3] = {2.2, 2.2, 2.2};
        maker_box(&mesh, a, b);
        maker_flip(&mesh, hole, mesh.triangles);
    }
    out = repaired(&o);
    TEST_ASSERT_EQUAL_UINT64(0, report.crumbs);
    TEST_ASSERT_EQUAL_UINT64(7, report.after.components);
    bvx_mesh_free(ctx, &out);
}

/* What a wedge cuts off a box runs out in acute edges. */
static void test_boolean_drops_crumbs(void)
{
    double const low[3] = {-2, -3, -3}, high[3] = {3, 3, 9};
    uint64_t crumbs = 0;
    maker_mesh box = {0};
    maker_box(&box, low, high);
    for (int k = 1; k < 5; k++) {
        bvx_boolean_report r;
        bvx_boolean_options o = {.struct_size = sizeof o};
        bvx_mesh_view view[2], made;
        bvx_certificate c;
        bvx_mesh out = {0};
        make_wedge(k);
        view[0] = maker_view(&mesh);
        view[1] = maker_view(&box);
        o.fit.resolution = 70;
        o.report = &r;

        /* A wedge's edge comes apart into crumbs where its walls are lost,
         * and hangs together where they are kept. */
        for (o.thin = BVX_THIN_DROP;; o.thin = BVX_THIN_KEEP) {
            TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                    bvx_boolean(ctx, &view[0], &view[1], BVX_BOOLEAN_INTERSECTION, &o, &out));
            bvx_mesh_view_of(&out, &made);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &made, 0, &c));
            TEST_ASSERT_EQUAL_UINT64(1, c.components);
            bvx_mesh_free(ctx, &out);
            if (o.thin == BVX_THIN_KEEP) break;
            crumbs += r.crumbs;
        }

        o.parts.least_part = 1000000;
        TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                bvx_boolean(ctx, &view[0], &view[1], BVX_BOOLEAN_INTERSECTION, &o, &out));
        TEST_ASSERT_TRUE(out.triangle_count == 0 && r.voxels == 0 && r.parts_dropped == 1);
        bvx_mesh_free(ctx, &out);
    }
    TEST_ASSERT_TRUE(crumbs > 0);
    maker_free(&box);
}

/* ---- What needs nothing ---- */

static int32_t needs_of_mesh(void)
{
    bvx_repair_options const o = sharp_options(20, -1);
    bvx_mesh out = repaired(&o);
    bvx_mesh_free(ctx, &out);
    TEST_ASSERT_EQUAL_INT32(0, report.copied);
    return report.needs;
}

static void test_needs_are_named(void)
{
    double const low[3] = {1, 1, 1}, high[3] = {2, 2, 2}, beside[3] = {1.5, 1.5, 1.5}, beyond[3] = {3, 3, 3};
    make_turned_box();
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_NOTHING, needs_of_mesh());
    maker_flip(&mesh, 0, mesh.triangles);
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_OUTSIDE_IN, needs_of_mesh());
    maker_flip(&mesh, 0, 5);
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_TURNS, needs_of_mesh());
    maker_remove(&mesh, 3);
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_LIDS, needs_of_mesh());

    make_turned_box();
    maker_duplicate(&mesh, 2);
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_MANIFOLD, needs_of_mesh());

    maker_clear(&mesh);
    maker_box(&mesh, low, high);
    maker_box(&mesh, beside, beyond);
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_OUTSIDE_IN, needs_of_mesh()); /* both rules fill other voxels */
    maker_shift(&mesh, 8, 0.6, 0, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_NOTHING, needs_of_mesh());
}

/* A part within a part, outward and as a cavity, and one turned inward only. */
static void test_parts_within_parts(void)
{
    double const low[3] = {0, 0, 0}, high[3] = {4, 4, 4}, in[3] = {1, 1, 1}, to[3] = {3, 3, 3};
    size_t first;

    maker_clear(&mesh);
    maker_box(&mesh, low, high);
    first = mesh.triangles;
    maker_box(&mesh, in, to);
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_OUTSIDE_IN, needs_of_mesh());
    maker_flip(&mesh, first, mesh.triangles);
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_NOTHING, needs_of_mesh());
    maker_shift(&mesh, 8, 5, 0, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_OUTSIDE_IN, needs_of_mesh());
}

static void test_crossings_are_a_need(void)
{
    /* a side goes through another */
    static const double outline[6][2] = {{0, 0}, {4, 0}, {4, 4}, {3, 4}, {3, -1}, {0, 4}};
    maker_clear(&mesh);
    add_prism(outline, 6, 0, 2);
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_UNCROSSING, needs_of_mesh());
    TEST_ASSERT_TRUE(report.crossings > 0);
}

/* Copied to the bit; what needs a repair gets one. */
static void test_if_needed_copies(void)
{
    bvx_repair_options o = sharp_options(20, -1);
    bvx_mesh out;
    o.if_needed = 1;
    make_turned_box();
    out = repaired(&o);
    TEST_ASSERT_EQUAL_INT32(1, report.copied);
    TEST_ASSERT_EQUAL_INT32(BVX_F64, out.position_type);
    TEST_ASSERT_EQUAL_UINT64(mesh.vertices, out.vertex_count);
    TEST_ASSERT_EQUAL_MEMORY(mesh.p, out.positions, mesh.vertices * 24);
    TEST_ASSERT_EQUAL_UINT64(mesh.triangles, out.triangle_count);
    TEST_ASSERT_EQUAL_MEMORY(mesh.t, out.triangles, mesh.triangles * 12);
    bvx_mesh_free(ctx, &out);

    maker_remove(&mesh, 3);
    out = repaired(&o);
    TEST_ASSERT_EQUAL_INT32(0, report.copied);
    TEST_ASSERT_TRUE(out.vertex_count > 100);
    bvx_mesh_free(ctx, &out);
}

/* Without a report the same is found out. */
static void test_if_needed_without_a_report(void)
{
    bvx_repair_options o = sharp_options(20, -1);
    bvx_mesh_view view;
    bvx_mesh out = {0};

    o.if_needed = 1;
    o.report = NULL;
    make_turned_box();
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_repair(ctx, &view, &o, &out));
    TEST_ASSERT_EQUAL_UINT64(8, out.vertex_count);
    bvx_mesh_free(ctx, &out);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_wedges_stay_whole);
    RUN_TEST(test_stars_and_pyramids_stay_whole);
    RUN_TEST(test_frame_stays_whole);
    RUN_TEST(test_crumbs_are_counted_and_kept_when_asked);
    RUN_TEST(test_small_parts_of_the_mesh_stay);
    RUN_TEST(test_boolean_drops_crumbs);
    RUN_TEST(test_needs_are_named);
    RUN_TEST(test_parts_within_parts);
    RUN_TEST(test_crossings_are_a_need);
    RUN_TEST(test_if_needed_copies);
    RUN_TEST(test_if_needed_without_a_report);
    RUN_TEST(test_default_keeps_a_boxs_edges);
    RUN_TEST(test_default_leaves_a_ball_smooth);
    RUN_TEST(test_loose_triangles_have_edges_too);
    RUN_TEST(test_boolean_is_sharp_where_one_body_is);
    return UNITY_END();
}
