/* test_repair.c - whatever goes in, a closed, manifold, oriented mesh comes
 * out, and where the shape is known its volume is near. */
#include "solid_support.h"

#include <math.h>

static bvx_repair_report report;

static bvx_mesh repaired_by(bvx_context *c, const bvx_mesh_view *view, const bvx_repair_options *with)
{
    bvx_repair_options o = *with;
    bvx_mesh out;
    bvx_status status;

    memset(&out, 0, sizeof out);
    memset(&report, 0, sizeof report);
    o.report = &report;
    status = bvx_repair(c, view, &o, &out);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(c));
    return out;
}

static bvx_repair_options defaults(int32_t resolution)
{
    bvx_repair_options o = {.struct_size = sizeof o};
    o.fit.resolution = resolution;
    return o;
}

static void assert_certified(const bvx_mesh *m)
{
    bvx_certificate c;
    bvx_mesh_view v;

    bvx_mesh_view_of(m, &v);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &v, 0, &c));
    TEST_ASSERT_TRUE_MESSAGE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented,
                             "the result is not closed, manifold and oriented");
    TEST_ASSERT_EQUAL_UINT64(0, c.degenerate + c.duplicates + c.collapsed);
    TEST_ASSERT_TRUE(c.volume > 0);
    TEST_ASSERT_EQUAL_MEMORY(&c, &report.after, sizeof c);
}

/* The volume of what comes out, in voxels of the lattice it was made on. */
static double repair_volume(int32_t resolution, int32_t sign)
{
    bvx_repair_options o = defaults(resolution);
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_mesh out;

    o.sign = sign;
    o.placing.position_type = BVX_F64;
    out = repaired_by(ctx, &view, &o);
    assert_certified(&out);
    bvx_mesh_free(ctx, &out);
    return report.after.volume;
}

static void make_ball(const double centre[3], double radius)
{
    double const r[3] = {radius, radius, radius};
    maker_star(&mesh, &seed, centre, r, 0, 24, 36, 65536);
}

/* Of what make_ball makes: no quite round ball. */
static double ball_volume(double radius)
{
    static double unit;

    if (unit == 0) {
        static const double centre[3] = {0, 0, 0}, r[3] = {1, 1, 1};
        maker_mesh ball = {0};
        bvx_certificate c;
        bvx_mesh_view view;
        uint64_t any = 1;
        maker_star(&ball, &any, centre, r, 0, 24, 36, 65536);
        view = maker_view(&ball);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 1, &c));
        maker_free(&ball);
        unit = c.volume;
    }
    return unit * radius * radius * radius;
}

/* ---- Defects of known shapes ---- */

static void test_closed_mesh_keeps_its_volume(void)
{
    double const at[3] = {3, -2, 5};
    bvx_certificate c;
    bvx_mesh_view view;

    make_ball(at, 2);
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 1, &c));
    TEST_ASSERT_DOUBLE_WITHIN(0.003 * c.volume, c.volume, repair_volume(48, BVX_FILL_AUTO));
    TEST_ASSERT_EQUAL_INT32(BVX_FILL_WINDING, report.sign);
    TEST_ASSERT_EQUAL_UINT64(0, report.holes + report.shelled_triangles);
    TEST_ASSERT_EQUAL_UINT64(1, report.after.components);
}

static void test_holes_are_closed(void)
{
    double const at[3] = {0, 0, 0};

    for (int trial = 0; trial < (quick ? 4 : 20); trial++) {
        maker_clear(&mesh);
        make_ball(at, 2);
        for (int i = 0; i < 12; i++) maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
        TEST_ASSERT_DOUBLE_WITHIN(0.03 * ball_volume(2), ball_volume(2), repair_volume(40, BVX_FILL_AUTO));
        TEST_ASSERT_TRUE(report.holes > 0);
        TEST_ASSERT_EQUAL_UINT64(0, report.shelled_triangles);
    }
}

/* A third of the ball is missing: the lid over it is flat. */
/* Two balls that overlap stay one body whichever way a triangle faces. */
static void test_a_flipped_triangle_leaves_overlaps_whole(void)
{
    double const at[3] = {0, 0, 0}, beside[3] = {2, 0, 0};
    double right;

    make_ball(at, 2);
    make_ball(beside, 2);
    right = repair_volume(64, BVX_FILL_AUTO);
    TEST_ASSERT_EQUAL_UINT64(0, report.turned);
    maker_flip(&mesh, 7, 8);
    TEST_ASSERT_EQUAL_DOUBLE(right, repair_volume(64, BVX_FILL_AUTO));
    TEST_ASSERT_EQUAL_INT32(BVX_FILL_WINDING, report.sign);
    TEST_ASSERT_EQUAL_UINT64(1, report.turned);
    maker_remove(&mesh, 200);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * right, right, repair_volume(64, BVX_FILL_AUTO));
    TEST_ASSERT_EQUAL_UINT64(1, report.turned);
}

static void test_wide_hole_gets_a_lid(void)
{
    double const at[3] = {0, 0, 0};
    size_t i = 0;

    make_ball(at, 2);
    while (i < mesh.triangles) {
        double z = 0;
        for (int k = 0; k < 3; k++) z += mesh.p[3 * mesh.t[3 * i + (size_t)k] + 2] / 3;
        if (z > 1.0) maker_remove(&mesh, i);
        else i++;
    }

    /* less the cap above z = 1, of a round ball 5 / 32 */
    TEST_ASSERT_DOUBLE_WITHIN(0.04 * ball_volume(2), ball_volume(2) * 27 / 32,
                              repair_volume(48, BVX_FILL_AUTO));
    TEST_ASSERT_EQUAL_UINT64(1, report.holes);
}

static void test_flipped_triangles_do_not_matter(void)
{
    double const at[3] = {0, 0, 0};
    make_ball(at, 2);
    for (size_t i = 0; i < mesh.triangles; i++)
        if (maker_below(&seed, 3) == 0) maker_flip(&mesh, i, i + 1);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * ball_volume(2), ball_volume(2), repair_volume(48, BVX_FILL_AUTO));
    TEST_ASSERT_EQUAL_INT32(BVX_FILL_WINDING, report.sign);
    TEST_ASSERT_TRUE(report.turned > mesh.triangles / 4);
}

static void test_duplicates_count_once(void)
{
    double const at[3] = {0, 0, 0};
    make_ball(at, 2);
    for (size_t i = 0, n = mesh.triangles; i < n; i++)
        for (int k = maker_below(&seed, 3); k > 0; k--) maker_duplicate(&mesh, i);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * ball_volume(2), ball_volume(2), repair_volume(48, BVX_FILL_AUTO));
    TEST_ASSERT_TRUE(report.before.duplicates > 0);
}

static void test_inside_out_mesh(void)
{
    double const at[3] = {0, 0, 0};
    make_ball(at, 2);
    maker_flip(&mesh, 0, mesh.triangles);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * ball_volume(2), ball_volume(2), repair_volume(48, BVX_FILL_AUTO));
}

/* One of two balls is inside out: where it overlaps the other, both would cancel. */
static void test_a_part_inside_out_is_turned(void)
{
    double const a[3] = {0, 0, 0}, b[3] = {2, 0, 0};
    size_t first;

    make_ball(a, 2);
    first = mesh.triangles;
    make_ball(b, 2);
    maker_flip(&mesh, first, mesh.triangles);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * ball_volume(2), 27.0 / 16 * ball_volume(2),
                              repair_volume(64, BVX_FILL_AUTO));
    TEST_ASSERT_EQUAL_UINT64(mesh.triangles - first, report.turned);
    TEST_ASSERT_EQUAL_INT32(BVX_NEEDS_OUTSIDE_IN, report.needs);
    /* As it was given. */
    TEST_ASSERT_TRUE(repair_volume(64, BVX_FILL_WINDING) < 1.5 * ball_volume(2));
    TEST_ASSERT_EQUAL_UINT64(0, report.turned);
}

/* A small ball that sticks out of a large one, in whose box it lies: neither is a cavity of the other. */
static void test_a_part_inside_out_in_the_box_of_another_is_turned(void)
{
    double const at[3] = {0, 0, 0}, beside[3] = {1, 1, 1}, d = sqrt(3), r = 0.9, h = 2 + r - d;
    double const common = 3.14159265 * h * h * (d * d + 2 * d * (2 + r) - 3 * (2 - r) * (2 - r)) / (12 * d);
    double const both = ball_volume(2) + ball_volume(r) - common;

    for (int turned = 0; turned < 2; turned++) {
        size_t first;

        maker_clear(&mesh);
        make_ball(at, 2);
        first = mesh.triangles;
        make_ball(beside, r);
        maker_flip(&mesh, turned ? first : 0, turned ? mesh.triangles : first);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * both, both, repair_volume(64, BVX_FILL_AUTO));
        TEST_ASSERT_EQUAL_UINT64(turned ? mesh.triangles - first : first, report.turned);
    }
}

/* An open box far away changes nothing about two balls, nor does it make a body of a cavity. */
static void test_a_closed_part_inside_out_is_turned_beside_an_open_one(void)
{
    double const at[3] = {0, 0, 0}, beside[3] = {1.8, 0, 0}, within[3] = {0.5, 0, 0};
    double const low[3] = {11, -0.8, -0.6}, high[3] = {13, 1.2, 1.4};
    double const d = 1.8, r = 1.2, h = 2 + r - d;
    double const common = 3.14159265 * h * h * (d * d + 2 * d * (2 + r) - 3 * (2 - r) * (2 - r)) / (12 * d);

    for (int cavity = 0; cavity < 2; cavity++) {
        double const both = ball_volume(2) + (cavity ? -ball_volume(r) : ball_volume(r) - common) + 8;
        size_t first, last;

        maker_clear(&mesh);
        make_ball(at, 2);
        first = mesh.triangles;
        make_ball(cavity ? within : beside, r);
        last = mesh.triangles;
        maker_flip(&mesh, first, last);
        maker_box(&mesh, low, high);
        maker_remove(&mesh, mesh.triangles - 1);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * both, both, repair_volume(64, BVX_FILL_AUTO));
        TEST_ASSERT_EQUAL_UINT64(cavity ? 0 : last - first, report.turned);
    }
}

/* A lopsided octahedron and its mirror image, which share two corners; mirrored without turning, as modellers
 * do, the image is inside out. */
static void make_mirrored(int turned)
{
    static const double corner[6][3] = {{1, 0, 0},  {-3, 0, 0},   {0, 2, 0},
                                        {0, -2, 0}, {-0.5, 0, 2}, {-0.5, 0, -2}};
    static const uint32_t face[8][3] = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                                        {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};

    maker_clear(&mesh);
    for (int side = 0; side < 2; side++)
        for (int v = 0; v < 6; v++)
            maker_vertex(&mesh, side ? -corner[v][0] : corner[v][0], corner[v][1], corner[v][2]);
    for (uint32_t side = 0; side < 2; side++)
        for (int t = 0; t < 8; t++) {
            const uint32_t *const f = face[t];
            int const second = side && turned ? 2 : 1;

            maker_triangle(&mesh, 6 * side + f[0], 6 * side + f[second], 6 * side + f[3 - second]);
        }
}

/* By the corners that both have they are one piece, whose volume is 0: what both cover was empty. */
static void test_an_inside_out_part_that_touches_at_vertices_is_turned(void)
{
    double right;

    make_mirrored(1);
    right = repair_volume(64, BVX_FILL_AUTO);
    TEST_ASSERT_EQUAL_UINT64(0, report.turned);
    make_mirrored(0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, right, repair_volume(64, BVX_FILL_AUTO));
    TEST_ASSERT_EQUAL_UINT64(8, report.turned);
}

/* A cavity faces inward, and is none of those. */
static void test_cavities_are_not_turned(void)
{
    double const at[3] = {0, 0, 0};
    size_t first;

    make_ball(at, 2);
    first = mesh.triangles;
    make_ball(at, 1);
    maker_flip(&mesh, first, mesh.triangles);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * ball_volume(2), ball_volume(2) - ball_volume(1),
                              repair_volume(64, BVX_FILL_AUTO));
    TEST_ASSERT_EQUAL_UINT64(0, report.turned);
}

/* A bar three voxels thick and a ball that overlaps it, of which one triangle is turned, gone or there twice: its
 * volume is known all the same; so is a ring's. */
static void test_volume_is_known_whatever_is_wrong(void)
{
    double const low[3] = {-8.07, -0.41, -0.33}, high[3] = {8.11, 0.37, 0.42}, at[3] = {0.3, 0, 0};
    static const uint8_t ring[9] = {1, 1, 1, 1, 0, 1, 1, 1, 1};
    int32_t const n[3] = {3, 3, 1};

    for (int wrong = 0; wrong < 4; wrong++) {
        double both;

        maker_clear(&mesh);
        maker_box(&mesh, low, high);
        make_ball(at, 2);
        if (wrong == 1) maker_flip(&mesh, 20, 21);
        if (wrong == 2) maker_remove(&mesh, 20);
        if (wrong == 3) maker_duplicate(&mesh, 20);
        both = ball_volume(2) + (high[1] - low[1]) * (high[2] - low[2]) * (high[0] - low[0] - 3.9);
        repair_volume(64, BVX_FILL_AUTO);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * both, both, report.crossing_volume);

        maker_clear(&mesh);
        maker_cubes(&mesh, &seed, ring, n, at);
        if (wrong == 1) maker_flip(&mesh, 20, 21);
        if (wrong == 2) maker_remove(&mesh, 20);
        if (wrong == 3) maker_duplicate(&mesh, 20);
        repair_volume(32, BVX_FILL_AUTO);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * 8, 8, report.crossing_volume);
    }
}

/* Two balls whose centres lie a radius apart: the union has 27/16 of one's volume. */
static void test_overlapping_parts_are_one(void)
{
    double const a[3] = {0, 0, 0}, b[3] = {2, 0, 0};
    make_ball(a, 2);
    make_ball(b, 2);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * ball_volume(2), 27.0 / 16 * ball_volume(2),
                              repair_volume(64, BVX_FILL_AUTO));
    TEST_ASSERT_EQUAL_UINT64(1, report.after.components);
}

static void test_cavities_and_parts(void)
{
    double const a[3] = {0, 0, 0}, far[3] = {4, 0, 0};
    bvx_repair_options o = defaults(64);
    bvx_mesh_view view;
    bvx_mesh out;
    size_t first;

    make_ball(a, 2);
    first = mesh.triangles;
    make_ball(a, 0.8);
    maker_flip(&mesh, first, mesh.triangles);
    make_ball(far, 0.5);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * ball_volume(2), ball_volume(2) - ball_volume(0.8) + ball_volume(0.5),
                              repair_volume(64, BVX_FILL_AUTO));
    TEST_ASSERT_EQUAL_UINT64(0, report.parts_dropped + report.cavities_dropped);
    view = maker_view(&mesh);
    o.parts.least_part = 1000;
    o.parts.least_cavity = 10000;
    out = repaired_by(ctx, &view, &o);
    assert_certified(&out);
    TEST_ASSERT_EQUAL_UINT64(1, report.parts_dropped);
    TEST_ASSERT_EQUAL_UINT64(1, report.cavities_dropped);
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * ball_volume(2), ball_volume(2), report.after.volume);
    bvx_mesh_free(ctx, &out);
}

/* Three balls apart, the largest neither first nor last: so many of them stay, with a report and without. */
static void test_the_largest_parts_are_kept(void)
{
    static const double centre[3][3] = {{0, 0, 0}, {4, 0, 0}, {8, 0, 0}}, radius[3] = {0.9, 1.4, 0.5};
    double const first = ball_volume(0.9), largest = ball_volume(1.4),
                 all = first + largest + ball_volume(0.5);
    double const volume[5] = {all, largest, first + largest, all, all};
    bvx_repair_options o = defaults(80);
    bvx_repair_report *const wanted = o.report;
    bvx_mesh_view view;

    for (int i = 0; i < 3; i++) make_ball(centre[i], radius[i]);
    view = maker_view(&mesh);
    for (uint64_t n = 0; n < 5; n++)
        for (int told = 0; told < 2; told++) {
            uint64_t const kept = n == 0 || n > 3 ? 3 : n;
            bvx_mesh_view made;
            bvx_certificate c;
            bvx_mesh out;

            o.parts.keep_largest = n;
            o.report = told ? wanted : NULL;
            out = repaired_by(ctx, &view, &o);
            bvx_mesh_view_of(&out, &made);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &made, 0, &c));
            TEST_ASSERT_EQUAL_UINT64(kept, c.components);
            TEST_ASSERT_DOUBLE_WITHIN(0.03 * volume[n], volume[n], c.volume);
            if (told) TEST_ASSERT_EQUAL_UINT64(3 - kept, report.parts_dropped);
            bvx_mesh_free(ctx, &out);
        }

    /* Of what least_part leaves: the second largest is gone before the largest are counted. */
    o.report = wanted;
    o.parts.keep_largest = 2;
    o.parts.least_part = 2500;
    bvx_mesh out = repaired_by(ctx, &view, &o);
    TEST_ASSERT_EQUAL_UINT64(2, report.parts_dropped);
    bvx_mesh_free(ctx, &out);
}

/* A ball in the cavity of another goes, and the cavity that it had stays empty. */
static void test_a_part_in_a_cavity_is_not_the_largest(void)
{
    static const double a[3] = {0, 0, 0};
    bvx_repair_options o = defaults(64);
    bvx_mesh_view view;
    bvx_mesh out;

    make_ball(a, 2);
    size_t const first = mesh.triangles;
    make_ball(a, 1.5);
    maker_flip(&mesh, first, mesh.triangles);
    make_ball(a, 0.8);
    view = maker_view(&mesh);
    o.parts.keep_largest = 1;
    out = repaired_by(ctx, &view, &o);
    assert_certified(&out);
    TEST_ASSERT_EQUAL_UINT64(1, report.parts_dropped);
    TEST_ASSERT_EQUAL_UINT64(0, report.cavities_dropped);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * ball_volume(2), ball_volume(2) - ball_volume(1.5), report.after.volume);
    bvx_mesh_free(ctx, &out);
}

/* ---- Sheets ---- */

static void make_plate(double wide)
{
    uint32_t const a = maker_vertex(&mesh, 0, 0, 0), b = maker_vertex(&mesh, wide, 0, 0.1),
                   c = maker_vertex(&mesh, wide, wide, 0), d = maker_vertex(&mesh, 0, wide, 0.1);
    maker_triangle(&mesh, a, b, c);
    maker_triangle(&mesh, a, c, d);
}

static void test_sheet_becomes_a_shell(void)
{
    double const spacing = 4.0 / 40;
    make_plate(4);
    /* a plate of 4 x 4, two voxels thick, with half a pipe along its rim */
    TEST_ASSERT_DOUBLE_WITHIN(0.1 * 3.6, 16 * 2 * spacing + 16 * 3.14159 * spacing * spacing / 2,
                              repair_volume(40, BVX_FILL_AUTO));
    TEST_ASSERT_EQUAL_UINT64(2, report.shelled_triangles);
}

static void test_sheet_without_shells_is_an_error(void)
{
    bvx_repair_options o = defaults(40);
    bvx_mesh_view view;
    bvx_mesh out;

    memset(&out, 0, sizeof out);
    make_plate(4);
    view = maker_view(&mesh);
    o.shell = BVX_NONE;
    if (bvx_repair(ctx, &view, &o, &out) == BVX_OK) { /* the plate is bent, so a sliver may be left */
        TEST_ASSERT_TRUE(out.triangle_count > 0);
        bvx_mesh_free(ctx, &out);
        return;
    }
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "nothing remains"));
    TEST_ASSERT_NULL(out.positions);
}

/* A ball beside a sheet: each becomes what it is. */
static void test_bodies_and_sheets_together(void)
{
    double const at[3] = {-4, 0, 0};
    size_t ball;

    make_ball(at, 2);
    ball = mesh.triangles;
    make_plate(4);
    (void)repair_volume(64, BVX_FILL_AUTO);
    TEST_ASSERT_EQUAL_UINT64(mesh.triangles - ball, report.shelled_triangles);
    TEST_ASSERT_EQUAL_UINT64(2, report.after.components);
    TEST_ASSERT_TRUE(report.after.volume > ball_volume(2));
}

/* A pot of radius 1 and height 1 without its top, and a lid that lies on its rim: a cone of height 0.31, 0.02
 * wider than the pot, whose own lid would be nearly as large as itself. far: the lid lies so far above. */
static void make_pot_and_lid(double far)
{
    enum { STEPS = 48 };
    uint32_t const floor_middle = maker_vertex(&mesh, 0, 0, 0), tip = maker_vertex(&mesh, 0, 0, 1.3 + far);
    uint32_t low[STEPS + 1], high[STEPS + 1], rim[STEPS + 1];

    for (int k = 0; k < STEPS; k++) {
        double const x = cos(2 * 3.14159265358979 * k / STEPS), y = sin(2 * 3.14159265358979 * k / STEPS);

        low[k] = maker_vertex(&mesh, x, y, 0);
        high[k] = maker_vertex(&mesh, x, y, 1);
        rim[k] = maker_vertex(&mesh, 1.02 * x, 1.02 * y, 0.99 + far);
    }
    low[STEPS] = low[0];
    high[STEPS] = high[0];
    rim[STEPS] = rim[0];
    for (int k = 0; k < STEPS; k++) {
        maker_triangle(&mesh, low[k], low[k + 1], high[k + 1]);
        maker_triangle(&mesh, low[k], high[k + 1], high[k]);
        maker_triangle(&mesh, floor_middle, low[k + 1], low[k]);
        maker_triangle(&mesh, rim[k], rim[k + 1], tip);
    }
}

/* By itself a flat cone encloses nothing; on its pot it does. */
static void test_lid_of_a_pot_is_no_sheet(void)
{
    make_pot_and_lid(0);
    /* The pot to its rim, and the cone above: 1.02 squared by 0.31 by a third of pi, less its overlap. */
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * 3.44, 3.44, repair_volume(96, BVX_FILL_AUTO));
    TEST_ASSERT_EQUAL_UINT64(0, report.shelled_triangles);
    TEST_ASSERT_EQUAL_UINT64(1, report.after.components);
}

/* Far from the pot the same lid closes none of it. */
static void test_lid_beside_its_pot_is_a_sheet(void)
{
    make_pot_and_lid(2);
    (void)repair_volume(64, BVX_FILL_AUTO);
    TEST_ASSERT_EQUAL_UINT64(48, report.shelled_triangles);
    TEST_ASSERT_EQUAL_UINT64(2, report.after.components);
}

/* ---- Anything ---- */

static void make_anything(int kind)
{
    static const double low[3] = {0, 0, 0};
    static const double high[3] = {10, 9, 8};
    static const double centre[3] = {5, 5, 5};
    static const double radius[3] = {4, 4, 3};

    if (kind % 4 == 0) maker_soup(&mesh, &seed, 1 + maker_below(&seed, 30), low, high, 1000);
    if (kind % 4 == 1) maker_needles(&mesh, &seed, 1 + maker_below(&seed, 30), low, high, 1000);
    if (kind % 4 >= 2)
        maker_star(&mesh, &seed, centre, radius, 0.6, 3 + maker_below(&seed, 6), 3 + maker_below(&seed, 8),
                   1000);
    if (kind % 4 == 3) {
        maker_star(&mesh, &seed, centre, radius, 0.9, 3, 5, 1000);
        maker_degenerate(&mesh, &seed, 5, low, high, 1000);
    }
    for (int i = maker_below(&seed, 6); i > 0 && mesh.triangles > 2; i--)
        maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
    for (int i = maker_below(&seed, 4); i > 0; i--)
        maker_duplicate(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
    if (maker_below(&seed, 2)) maker_flip(&mesh, 0, mesh.triangles / 2);
}

static void test_anything_is_closed(void)
{
    static const int32_t signs[] = {BVX_FILL_AUTO, BVX_FILL_PARITY, BVX_FILL_WINDING, BVX_FILL_VOTE};

    for (int trial = 0; trial < trial_count(40, 500, 1500); trial++) {
        bvx_repair_options o = defaults(4 + maker_below(&seed, 24));
        bvx_mesh_view view;
        bvx_mesh out;
        maker_clear(&mesh);
        make_anything(trial);
        view = maker_view(&mesh);
        o.sign = signs[maker_below(&seed, 4)];
        o.placing.interpolation = maker_below(&seed, 5);
        o.placing.face_rule = maker_below(&seed, 2);
        o.placing.sharp = BVX_SHARP_NEVER + maker_below(&seed, 2);
        out = repaired_by(ctx, &view, &o);
        assert_certified(&out);
        bvx_mesh_free(ctx, &out);
    }
}

static void test_threads_and_code_paths_do_not_show(void)
{
    static const int32_t threads[] = {1, 2, 8}, cpu[] = {BVX_CPU_BEST, BVX_CPU_PORTABLE};

    for (int trial = 0; trial < (quick ? 4 : 24); trial++) {
        bvx_repair_options o = defaults(20);
        bvx_mesh_view view;
        uint64_t first = 0;
        maker_clear(&mesh);
        make_anything(trial);
        view = maker_view(&mesh);
        o.placing.sharp = BVX_SHARP_NEVER + (trial & 1);
        for (int i = 0; i < 6; i++) {
            bvx_context *const c = suite_context(threads[i % 3], cpu[i / 3]);
            bvx_mesh out = repaired_by(c, &view, &o);
            uint64_t hash;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(c, &out, &hash));
            if (i == 0) first = hash;
            TEST_ASSERT_EQUAL_HEX64(first, hash);
            bvx_mesh_free(c, &out);
            bvx_context_destroy(c);
        }
    }
}

/* ---- Options ---- */

static void test_measured_distances(void)
{
    double const at[3] = {1e3, 0, 0};
    bvx_repair_options o = defaults(48);
    bvx_mesh_view view;
    bvx_mesh out;

    make_ball(at, 2);
    view = maker_view(&mesh);
    o.samples = 5000;
    for (o.placing.local_frame = 0; o.placing.local_frame < 2; o.placing.local_frame++) {
        o.placing.position_type = o.placing.local_frame ? BVX_F32 : BVX_F64;
        out = repaired_by(ctx, &view, &o);
        assert_certified(&out);
        TEST_ASSERT_TRUE(report.distance.mean_b_to_a < 0.05 * 4 / 48 &&
                         report.distance.max_b_to_a < 4.0 / 48);
        bvx_mesh_free(ctx, &out);
    }
}

static void assert_refused(const bvx_repair_options *o, bvx_status status, const char *word)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_mesh out;
    memset(&out, 0, sizeof out);
    TEST_ASSERT_EQUAL_INT32(status, bvx_repair(ctx, &view, o, &out));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx));
    TEST_ASSERT_NULL(out.positions);
}

static void test_bad_options(void)
{
    double const at[3] = {0, 0, 0};
    bvx_repair_options o = defaults(16);

    make_ball(at, 2);
    o.sign = 99, assert_refused(&o, BVX_ERR_ARGUMENT, "sign"), o = defaults(16);
    o.sign = BVX_FILL_NORMAL, assert_refused(&o, BVX_ERR_ARGUMENT, "sign 8 is none of"), o = defaults(16);
    o.sign = BVX_FILL_NONE, assert_refused(&o, BVX_ERR_ARGUMENT, "sign"), o = defaults(16);
    o.placing.interpolation = -1, assert_refused(&o, BVX_ERR_ARGUMENT, "interpolation"), o = defaults(16);
    o.shell = 1.0, assert_refused(&o, BVX_ERR_ARGUMENT, "shell"), o = defaults(16);
    o.shell = NAN, assert_refused(&o, BVX_ERR_ARGUMENT, "shell"), o = defaults(16);
    o.placing.sharp = 3, assert_refused(&o, BVX_ERR_ARGUMENT, "sharp"), o = defaults(16);
    o.fit.resolution = -1, assert_refused(&o, BVX_ERR_ARGUMENT, "resolution"), o = defaults(16);
    o.samples = UINT64_C(1) << 31, assert_refused(&o, BVX_ERR_ARGUMENT, "samples"), o = defaults(16);
    o.fit.reserved = 1, assert_refused(&o, BVX_ERR_ARGUMENT, "reserved"), o = defaults(16);
    o.thin = 3, assert_refused(&o, BVX_ERR_ARGUMENT, "thin"), o = defaults(16);
    o.reserved0 = 1, assert_refused(&o, BVX_ERR_ARGUMENT, "reserved"), o = defaults(16);
    o.parts.least_part = 1000000, assert_refused(&o, BVX_ERR_EMPTY, "least_part");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_repair(ctx, NULL, NULL, NULL));
}

static void test_meshes_without_area(void)
{
    bvx_repair_options const o = defaults(16);
    uint32_t a, b;

    assert_refused(&o, BVX_ERR_EMPTY, "no triangles");
    a = maker_vertex(&mesh, 0, 0, 0);
    b = maker_vertex(&mesh, 1, 1, 1);
    maker_triangle(&mesh, a, b, b);
    maker_triangle(&mesh, a, b, maker_vertex(&mesh, 2, 2, 2));
    assert_refused(&o, BVX_ERR_EMPTY, "area");
    mesh.p[1] = NAN;
    assert_refused(&o, BVX_ERR_RANGE, "vertex 0");
}

static void test_arrays_of_the_mesh_are_not_taken(void)
{
    static double positions[3 * 20000];
    static uint32_t triangles[3 * 40000];
    double const low[3] = {0, 0, 0}, high[3] = {3, 4, 5};
    bvx_repair_options const o = defaults(16);
    bvx_mesh into = {0};
    bvx_mesh_view view;

    maker_box(&mesh, low, high);
    memcpy(positions + 9, mesh.p, mesh.vertices * 24);
    view = maker_view(&mesh);
    view.positions = positions + 9;
    into.positions = positions;
    into.triangles = triangles;
    into.position_type = BVX_F32;
    into.vertex_capacity = 20000;
    into.triangle_capacity = 40000;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_repair(ctx, &view, &o, &into));
    TEST_ASSERT_NOT_NULL(
        strstr(bvx_last_message(ctx), "the result's positions lie in the mesh's own arrays"));
    TEST_ASSERT_EQUAL_MEMORY(mesh.p, positions + 9, mesh.vertices * 24);
    into.vertex_capacity = 6; /* they end before the mesh's begin */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_repair(ctx, &view, &o, &into));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_closed_mesh_keeps_its_volume);
    RUN_TEST(test_holes_are_closed);
    RUN_TEST(test_a_flipped_triangle_leaves_overlaps_whole);
    RUN_TEST(test_wide_hole_gets_a_lid);
    RUN_TEST(test_flipped_triangles_do_not_matter);
    RUN_TEST(test_duplicates_count_once);
    RUN_TEST(test_inside_out_mesh);
    RUN_TEST(test_a_part_inside_out_is_turned);
    RUN_TEST(test_a_part_inside_out_in_the_box_of_another_is_turned);
    RUN_TEST(test_a_closed_part_inside_out_is_turned_beside_an_open_one);
    RUN_TEST(test_an_inside_out_part_that_touches_at_vertices_is_turned);
    RUN_TEST(test_cavities_are_not_turned);
    RUN_TEST(test_volume_is_known_whatever_is_wrong);
    RUN_TEST(test_overlapping_parts_are_one);
    RUN_TEST(test_cavities_and_parts);
    RUN_TEST(test_the_largest_parts_are_kept);
    RUN_TEST(test_a_part_in_a_cavity_is_not_the_largest);
    RUN_TEST(test_sheet_becomes_a_shell);
    RUN_TEST(test_sheet_without_shells_is_an_error);
    RUN_TEST(test_bodies_and_sheets_together);
    RUN_TEST(test_lid_of_a_pot_is_no_sheet);
    RUN_TEST(test_lid_beside_its_pot_is_a_sheet);
    RUN_TEST(test_anything_is_closed);
    RUN_TEST(test_threads_and_code_paths_do_not_show);
    RUN_TEST(test_measured_distances);
    RUN_TEST(test_bad_options);
    RUN_TEST(test_meshes_without_area);
    RUN_TEST(test_arrays_of_the_mesh_are_not_taken);
    return UNITY_END();
}
