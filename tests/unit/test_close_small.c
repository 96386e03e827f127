/* test_close_small.c - levels whose small handles are cut and small holes filled: what goes, what stays, and that the
 * rest is as sound as it was. */
#include "levels_support.h"

/* ---- Shapes ---- */

/* Two slabs, nine thin columns between them, and on the upper one a small ring on a thin foot. */
static int in_slabs(int32_t x, int32_t y, int32_t z)
{
    if (z < 2 || (z > 4 && z < 7)) return 1;
    if (z < 7) return x % 8 == 4 && y % 8 == 4;
    if (z == 7) return x == 10 && y == 10;
    return (x > 7 && x < 11 && y > 7 && y < 11) && !(x == 9 && y == 9);
}

static void make_slabs(void)
{
    maker_clear(&mesh);
    level_cubes(&mesh, &seed, 24, 24, 9, 1, in_slabs);
    for (size_t i = 0; i < 3 * mesh.vertices; i++) mesh.p[i] = mesh.p[i] / 2;
}

/* A ball without some triangles that do not touch each other; returns how many. */
static size_t make_holes(void)
{
    static const double centre[3] = {8, 8, 8}, radius[3] = {4, 3, 2};
    size_t holes = 0;

    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, radius, 0.002, 20, 30, 1 << 20);
    for (size_t t = 100; t < mesh.triangles - 100; t += 97, holes++) maker_remove(&mesh, t);
    return holes;
}

static void simplify_to(uint64_t target, int32_t topology, int32_t vertices)
{
    bvx_simplify_options o = {.struct_size = sizeof o};
    bvx_mesh_view const view = maker_view(&mesh);

    drop_levels();
    o.targets.triangles = &target;
    o.collapse.topology = topology;
    o.collapse.vertices = vertices;
    o.reports = report;
    snprintf(where, sizeof where, "%d triangles, topology %d, vertices %d", (int)target, (int)topology,
             (int)vertices);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_simplify(ctx, &view, &o, 1, level), where);
}

/* ---- Handles ---- */

static void test_handles_are_cut_on_request(void)
{
    int64_t const euler = 2 - 2 * 9; /* eight between nine columns, and the ring's */

    make_slabs();
    simplify_to(60, BVX_TOPOLOGY_KEEP, BVX_VERTICES_PLACED);
    assert_whole(&level[0], euler, 1);
    TEST_ASSERT_EQUAL_UINT64(0, report[0].handles_cut);
    TEST_ASSERT_EQUAL_INT32(0, report[0].met);

    simplify_to(60, BVX_TOPOLOGY_SIMPLIFY, BVX_VERTICES_PLACED);
    assert_whole(&level[0], 2, 1);
    assert_no_crossings(&level[0]);
    assert_report(&report[0], &level[0]);
    TEST_ASSERT_EQUAL_UINT64(9, report[0].handles_cut);
    TEST_ASSERT_EQUAL_UINT64(0, report[0].holes_filled);
    /* Three mean edges of the level at most. */
    TEST_ASSERT_TRUE(report[0].longest_closed > 0.5);
    TEST_ASSERT_TRUE(report[0].longest_closed < 3 * sqrt(2.31 * report[0].certificate.area / 60));
    TEST_ASSERT_EQUAL_INT32(1, report[0].met);
}

static void test_handles_that_are_cut_are_counted(void)
{
    /* Whatever goes at a target: the handles that are left tell it. */
    for (uint64_t target = 1200; target > 20; target = target * 2 / 3)
        for (int32_t vertices = BVX_VERTICES_PLACED; vertices <= BVX_VERTICES_KEPT; vertices++) {
            make_slabs();
            simplify_to(target, BVX_TOPOLOGY_SIMPLIFY, vertices);
            TEST_ASSERT_EQUAL_INT64_MESSAGE(2 - 18 + 2 * (int64_t)report[0].handles_cut,
                                            report[0].certificate.euler, where);
            TEST_ASSERT_EQUAL_UINT64_MESSAGE(1, report[0].certificate.components, where);
            TEST_ASSERT_TRUE_MESSAGE(report[0].certificate.closed && report[0].certificate.edge_manifold &&
                                         report[0].certificate.vertex_manifold &&
                                         report[0].certificate.oriented,
                                     where);
            TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, report[0].crossings, where);
        }
}

static void test_a_large_handle_stays(void)
{
    make_shape(shape_named("frame"));
    simplify_to(64, BVX_TOPOLOGY_SIMPLIFY, BVX_VERTICES_PLACED);
    assert_whole(&level[0], 0, 1);
    TEST_ASSERT_EQUAL_UINT64(0, report[0].handles_cut);
}

/* ---- Holes ---- */

static void test_holes_are_filled_on_request(void)
{
    size_t const holes = make_holes();

    simplify_to(300, BVX_TOPOLOGY_KEEP, BVX_VERTICES_PLACED);
    TEST_ASSERT_EQUAL_UINT64(3 * holes, report[0].certificate.boundary_edges);
    TEST_ASSERT_EQUAL_UINT64(0, report[0].holes_filled);

    simplify_to(300, BVX_TOPOLOGY_SIMPLIFY, BVX_VERTICES_PLACED);
    assert_whole(&level[0], 2, 1);
    assert_no_crossings(&level[0]);
    TEST_ASSERT_EQUAL_UINT64(holes, report[0].holes_filled);
    TEST_ASSERT_EQUAL_UINT64(0, report[0].handles_cut);
}

static void test_no_triangle_alone_is_filled(void)
{
    static const double at[9] = {4, 4, 4, 5, 4, 4, 4, 5, 4};

    make_slabs();
    for (size_t i = 0; i < 3; i++) maker_vertex(&mesh, at[3 * i] - 2, at[3 * i + 1], at[3 * i + 2]);
    maker_triangle(&mesh, (uint32_t)mesh.vertices - 3, (uint32_t)mesh.vertices - 2,
                   (uint32_t)mesh.vertices - 1);
    simplify_to(100, BVX_TOPOLOGY_SIMPLIFY, BVX_VERTICES_PLACED);
    TEST_ASSERT_EQUAL_UINT64(3, report[0].certificate.boundary_edges);
    TEST_ASSERT_EQUAL_UINT64(2, report[0].certificate.components);
    TEST_ASSERT_EQUAL_UINT64(0, report[0].holes_filled);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_handles_are_cut_on_request);
    RUN_TEST(test_handles_that_are_cut_are_counted);
    RUN_TEST(test_a_large_handle_stays);
    RUN_TEST(test_holes_are_filled_on_request);
    RUN_TEST(test_no_triangle_alone_is_filled);
    return UNITY_END();
}
