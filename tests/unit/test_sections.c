/* test_sections.c - bodies from section contours: certificates of thousands of random stacks, contour points
 * in the mesh, analytic bodies, the ways of crossing, ends, labels, refusals, and one golden
 * hash. */
#include "section_support.h"

#include <math.h>

static const double pi = 3.14159265358979323846;

/* ---- help ---- */

static void refuse(bvx_status status, const char *words)
{
    TEST_ASSERT_EQUAL_INT32(status, build());
    if (strstr(bvx_last_message(ctx), words) == NULL) TEST_FAIL_MESSAGE(bvx_last_message(ctx));
    TEST_ASSERT_NULL(mesh.positions);
}

/* ---- random stacks ---- */

static void random_options(uint64_t *seed)
{
    o.slabs.grid[0] = 2 + maker_below(seed, 6) * maker_below(seed, 7);
    o.slabs.grid[1] = 2 + maker_below(seed, 6) * maker_below(seed, 7);
    o.slabs.depth = maker_below(seed, 7);
    if (o.slabs.depth == 0) o.slabs.depth = BVX_NONE;
    o.caps = maker_below(seed, 2);
}

/* Slow machines are requested less. */
static int rounds(int full)
{
    return quick ? full / 20 : full;
}

static void test_random_stacks_are_closed_and_keep_all_points(void)
{
    uint64_t seed = 1, unkept = 0, good = 0;
    int const all = rounds(2000);

    for (int i = 0; i < all; i++) {
        stack_random(&stack, &seed);
        random_options(&seed);
        bvx_status const status = build();
        if (status == BVX_ERR_FORMAT) continue; /* loops that cross */
        if (status != BVX_OK) TEST_FAIL_MESSAGE(bvx_last_message(ctx));
        certify(0);
        TEST_ASSERT_TRUE(certificate.closed && certificate.edge_manifold && certificate.vertex_manifold &&
                         certificate.oriented);
        TEST_ASSERT_EQUAL_UINT64(0, certificate.duplicates + certificate.collapsed +
                                        certificate.unused_vertices);
        TEST_ASSERT_TRUE(certificate.volume > 0.0);
        TEST_ASSERT_EQUAL_UINT64(0, report.unkept_points);
        if (i % 8 == 0) assert_points_kept();
        unkept += report.unkept_edges + report.unkept_loops;
        good++;
    }
    TEST_ASSERT_TRUE(good * 20 > (uint64_t)all * 19);

    /* the cases that matter did occur */
    if (all == 2000) TEST_ASSERT_TRUE(unkept > 1000);
}

static void test_random_stacks_in_the_fields_way_are_closed(void)
{
    uint64_t seed = 2, good = 0;
    int const all = rounds(600);

    for (int i = 0; i < all; i++) {
        stack_random(&stack, &seed);
        random_options(&seed);
        o.slabs.crossings = 1 + i % 2;
        bvx_status const status = build();
        if (status == BVX_ERR_FORMAT || status == BVX_ERR_EMPTY) continue; /* no grid point inside */
        if (status != BVX_OK) TEST_FAIL_MESSAGE(bvx_last_message(ctx));
        certify(0);
        TEST_ASSERT_TRUE(certificate.closed && certificate.edge_manifold && certificate.vertex_manifold &&
                         certificate.oriented);
        good++;
    }
    TEST_ASSERT_TRUE(good * 5 > (uint64_t)all);
}

static void test_points_on_round_numbers(void)
{
    uint64_t seed = 3, good = 0;
    int const all = rounds(600);

    for (int i = 0; i < all; i++) {
        stack_random(&stack, &seed);
        random_options(&seed);
        for (uint64_t k = 0; k < stack.s.point_count; k++)
            for (uint64_t c = 0; c < 2; c++)
                stack.point[3 * k + c] = floor(stack.point[3 * k + c] * 32.0 + 0.5) / 32.0;
        if (build() != BVX_OK) continue; /* rounding makes some loops touch */
        certify(0);
        TEST_ASSERT_TRUE(certificate.closed && certificate.edge_manifold && certificate.vertex_manifold &&
                         certificate.oriented);
        if (i % 8 == 0) assert_points_kept();
        good++;
    }
    TEST_ASSERT_TRUE(good * 2 > (uint64_t)all);
}

static void test_open_ends_have_the_contours_as_boundary(void)
{
    stack_round(&stack, stack_section(&stack, 0.0), 0, 0, 3, 2, 40, 0.2, 0.1, 0);
    stack_round(&stack, stack_section(&stack, 1.0), 0.5, 0, 2, 2, 32, 0.1, 0.7, 1);
    o.caps = BVX_CAPS_OPEN;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, build());
    certify(0);
    TEST_ASSERT_TRUE(!certificate.closed && certificate.edge_manifold && certificate.vertex_manifold &&
                     certificate.oriented);
    TEST_ASSERT_TRUE(certificate.boundary_edges > report.points);
}

/* ---- analytic bodies ---- */

static void make_sphere(int sections, int points)
{
    stack_clear(&stack);
    for (int i = 0; i < sections; i++) {
        double const z = -1.0 + (2.0 * i + 1.0) / sections, r = sqrt(1.0 - z * z);
        stack_round(&stack, stack_section(&stack, z), 0, 0, r, r, points, 0, 0, i & 1);
    }
}

static void test_sphere_converges(void)
{
    static const int counts[] = {3, 6, 12, 24, 48};
    double last = 1e9;

    o.caps = BVX_CAPS_TAPER;
    for (size_t i = 0; i < sizeof counts / sizeof *counts; i++) {
        double error, farthest = 0.0;
        make_sphere(counts[i], 96);
        build_good();
        TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
        TEST_ASSERT_EQUAL_INT64(2, certificate.euler);
        assert_points_kept();
        error = fabs(certificate.volume / (4.0 / 3.0 * pi) - 1.0);
        TEST_ASSERT_TRUE(error < 0.6 * last || error < 0.005);
        last = error;
        for (uint64_t v = 0; v < mesh.vertex_count; v++) {
            const double *const p = (const double *)mesh.positions + 3 * v;
            double const off = fabs(sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]) - 1.0);
            if (off > farthest) farthest = off;
        }
        TEST_ASSERT_TRUE(farthest < 0.75 / counts[i] + 0.01); /* of a step between sections */
    }
    TEST_ASSERT_TRUE(last < 0.005);
}

static void test_cone_has_its_volume(void)
{
    for (int i = 0; i <= 10; i++)
        stack_round(&stack, stack_section(&stack, 0.1 * i), 0, 0, 1.0 - 0.08 * i, 1.0 - 0.08 * i, 128, 0, 0,
                    0);
    build_good();
    double const frustum = pi / 3.0 * (1.0 + 0.2 + 0.04);
    TEST_ASSERT_DOUBLE_WITHIN(0.003 * frustum, frustum, certificate.volume);
    TEST_ASSERT_DOUBLE_WITHIN(0.002 * frustum, frustum, report.prismoid_volume);
}

/* A torus about the x axis: sections are one oval, two loops, one again;
 * near the tangent planes they are long and thin. */
static void test_torus_with_its_axis_in_the_plane(void)
{
    enum { RINGS = 64, SIDES = 32 };
    static maker_mesh torus;
    bvx_slice_options slice = {.struct_size = sizeof slice};
    bvx_sections cut;
    bvx_mesh_view view;
    double volume;
    for (int i = 0; i < RINGS; i++)
        for (int j = 0; j < SIDES; j++) {
            double c, s, a, b;
            stack_circle((double)i / RINGS, &c, &s);
            stack_circle((double)j / SIDES, &a, &b);
            maker_vertex(&torus, 0.4 * b, (1.0 + 0.4 * a) * c, (1.0 + 0.4 * a) * s);
        }
    for (uint32_t i = 0; i < RINGS; i++)
        for (uint32_t j = 0; j < SIDES; j++) {
            uint32_t const k = (i + 1) % RINGS, l = (j + 1) % SIDES;
            maker_triangle(&torus, i * SIDES + j, i * SIDES + l, k * SIDES + l);
            maker_triangle(&torus, i * SIDES + j, k * SIDES + l, k * SIDES + j);
        }
    view = maker_view(&torus);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &certificate));
    if (certificate.volume < 0.0) maker_flip(&torus, 0, torus.triangles);
    volume = fabs(certificate.volume);
    memset(&cut, 0, sizeof cut);
    slice.spacing = 2.8 / 40.0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_slice_mesh(ctx, &view, &slice, &cut));
    TEST_ASSERT_EQUAL_UINT64(40, cut.section_count);
    o.caps = BVX_CAPS_TAPER;
    bvx_status const status = bvx_build_sections(ctx, &cut, &o, &mesh);
    bvx_sections_free(ctx, &cut);
    maker_free(&torus);
    if (status != BVX_OK) TEST_FAIL_MESSAGE(bvx_last_message(ctx));
    certify(0);
    TEST_ASSERT_TRUE(certificate.closed && certificate.edge_manifold && certificate.vertex_manifold &&
                     certificate.oriented);
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
    TEST_ASSERT_EQUAL_INT64(0, certificate.euler); /* one hole */
    TEST_ASSERT_DOUBLE_WITHIN(0.02 * volume, volume, certificate.volume);
}

/* Needles beside a block, narrower on each turn: from some width on they
 * enclose no area for sections, so slices leave them out. */
static void test_slices_leave_out_what_encloses_no_area(void)
{
    static const double width[] = {1e-3, 1e-6, 1e-9, 1e-12, 1e-15};
    static maker_mesh block;
    uint64_t loops = 2;

    for (int turn = 0; turn < 5; turn++) {
        bvx_slice_options slice = {.struct_size = sizeof slice};
        bvx_sections cut;
        memset(&cut, 0, sizeof cut);
        for (uint32_t i = 0; i < 8; i++) maker_vertex(&block, 4.0 * (i & 1), 4.0 * (i >> 1 & 1), i >> 2);
        for (uint32_t i = 0; i < 4; i++) { /* a corner at the bottom, three at the top */
            double const x = 6.0 + width[turn] * (i == 2), y = 1.0 + width[turn] * (i == 3);
            maker_vertex(&block, x, y, i == 0 ? 0.0 : 1.0);
        }
        for (uint32_t i = 0; i < 3; i++) { /* pairs of opposite sides */
            uint32_t const a = UINT32_C(1) << i;
            uint32_t const b = UINT32_C(1) << (i + 1) % 3;
            uint32_t const c = UINT32_C(1) << (i + 2) % 3;
            maker_triangle(&block, 0, b, a + b);
            maker_triangle(&block, 0, a + b, a);
            maker_triangle(&block, c, c + a + b, c + b);
            maker_triangle(&block, c, c + a, c + a + b);
            maker_triangle(&block, 8, 9 + (i + 1) % 3, 9 + i);
        }
        maker_triangle(&block, 9, 10, 11);
        bvx_mesh_view const view = maker_view(&block);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &certificate));
        TEST_ASSERT_TRUE(certificate.closed && certificate.oriented);
        slice.spacing = 0.5;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_slice_mesh(ctx, &view, &slice, &cut));
        TEST_ASSERT_EQUAL_UINT64(2, cut.section_count);
        if (turn == 0) TEST_ASSERT_EQUAL_UINT64(4, cut.loop_count);
        if (turn >= 2) TEST_ASSERT_EQUAL_UINT64(2, cut.loop_count);
        TEST_ASSERT_TRUE(turn == 0 || cut.loop_count <= loops);
        loops = cut.loop_count;
        bvx_status const status = bvx_build_sections(ctx, &cut, &o, &mesh);
        bvx_sections_free(ctx, &cut);
        maker_free(&block);
        if (status != BVX_OK) TEST_FAIL_MESSAGE(bvx_last_message(ctx));
        bvx_mesh_free(ctx, &mesh);
    }
}

/* One loop below, two above: a Y. */
static void test_branching(void)
{
    for (int i = 0; i < 9; i++) {
        uint32_t const k = stack_section(&stack, 0.25 * i);
        if (i < 4) stack_round(&stack, k, 0, 0, 1.2, 0.6, 48, 0, 0, 0);
        else {
            stack_round(&stack, k, -0.65 - 0.1 * (i - 4), 0, 0.5, 0.5, 32, 0, 0, 0);
            stack_round(&stack, k, 0.65 + 0.1 * (i - 4), 0, 0.5, 0.5, 32, 0, 0, 1);
        }
    }
    build_good();
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
    TEST_ASSERT_EQUAL_INT64(2, certificate.euler);
}

static void test_nested_shells(void)
{
    for (int i = 0; i < 6; i++) {
        uint32_t const k = stack_section(&stack, 0.3 * i);
        stack_round(&stack, k, 0, 0, 2.0, 2.0, 64, 0, 0, 1);
        stack_round(&stack, k, 0, 0, 1.5, 1.5, 64, 0, 0, 1);
        stack_round(&stack, k, 0, 0, 0.8, 0.8, 32, 0, 0, 0);
    }
    build_good();
    TEST_ASSERT_EQUAL_UINT64(6, report.holes);
    TEST_ASSERT_EQUAL_UINT64(2, certificate.components); /* a tube, a rod in it */
    double const volume = 1.5 * pi * (4.0 - 2.25 + 0.64);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * volume, volume, certificate.volume);
}

/* A hole that is there on some sections and not on the next: it closes between them. */
static void test_a_hole_closes(void)
{
    for (int i = 0; i < 7; i++) {
        uint32_t const k = stack_section(&stack, 0.3 * i);
        stack_round(&stack, k, 0, 0, 1.5, 1.5, 64, 0, 0, 0);
        if (i >= 2 && i <= 4) stack_round(&stack, k, 0.1, 0, 0.6, 0.6, 32, 0, 0, 0);
    }
    build_good();
    TEST_ASSERT_EQUAL_UINT64(2, certificate.components); /* the outer surface, the bubble */
    TEST_ASSERT_EQUAL_INT64(4, certificate.euler);
    double const solid = 1.8 * pi * 2.25, cavity = 0.6 * pi * 0.36;
    TEST_ASSERT_TRUE(certificate.volume < solid - 0.9 * cavity && certificate.volume > solid - 2.5 * cavity);
}

/* A section without loops inside the stack: the body ends half way to it, on both sides. */
static void test_an_empty_section_parts_the_body(void)
{
    stack_round(&stack, stack_section(&stack, 0.0), 0, 0, 1, 1, 32, 0, 0, 0);
    stack_round(&stack, stack_section(&stack, 1.0), 0, 0, 1, 1, 32, 0, 0, 0);
    stack_section(&stack, 2.0);
    stack_round(&stack, stack_section(&stack, 3.0), 0, 0, 1, 1, 32, 0, 0, 0);
    stack_round(&stack, stack_section(&stack, 4.0), 0, 0, 1, 1, 32, 0, 0, 0);
    build_good();
    TEST_ASSERT_EQUAL_UINT64(4, report.sections);
    TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
    double const volume = 2.0 * (pi + 0.5 * pi / 3.0);
    TEST_ASSERT_DOUBLE_WITHIN(0.03 * volume, volume, certificate.volume);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * volume, volume, report.prismoid_volume);
    for (uint64_t v = 0; v < mesh.vertex_count; v++) {
        double const z = ((const double *)mesh.positions)[3 * v + 2];
        TEST_ASSERT_TRUE(z <= 1.5 || z >= 2.5);
    }
}

static void test_three_sections_behave(void)
{
    stack_round(&stack, stack_section(&stack, 0.0), 0, 0, 1, 1, 24, 0, 0, 0);
    /* far off: both end between */
    stack_round(&stack, stack_section(&stack, 5.0), 8, 0, 2, 1, 24, 0.1, 0, 0);
    stack_round(&stack, stack_section(&stack, 6.0), 8, 1, 1, 2, 24, 0.1, 0, 0);
    build_good();
    TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
    TEST_ASSERT_TRUE(certificate.box.low[2] == 0.0 && certificate.box.high[2] == 6.0);
    TEST_ASSERT_TRUE(certificate.box.low[0] > -1.01 && certificate.box.high[0] < 10.3);
}

static double highest_in(double low_x, double high_x)
{
    double most = -1e300;
    for (uint64_t v = 0; v < mesh.vertex_count; v++) {
        const double *const p = (const double *)mesh.positions + 3 * v;
        if (p[0] > low_x && p[0] < high_x && p[2] > most) most = p[2];
    }
    return most;
}

/* A part that the next section lacks narrows to a ridge half way to it, however far off that section's other
 * parts are; so does every part beyond the last section, whatever its width. */
static void test_each_part_tapers_by_itself(void)
{
    for (int far = 4; far <= 64; far *= 4) {
        stack_clear(&stack);
        for (int i = 0; i < 3; i++) {
            uint32_t const k = stack_section(&stack, i);
            if (i < 2) stack_round(&stack, k, 0, 0, 1, 1, 64, 0, 0, 0);
            stack_round(&stack, k, far, 0, 2, 2, 64, 0, 0, 0);
        }
        o.caps = BVX_CAPS_TAPER;
        o.spacing = 0.1;
        build_good();
        TEST_ASSERT_EQUAL_UINT64(2, certificate.components);
        TEST_ASSERT_DOUBLE_WITHIN(0.05, 1.5, highest_in(-1.5, 1.5)); /* 1 and half of 1 */
        TEST_ASSERT_DOUBLE_WITHIN(0.05, 2.5, highest_in(far - 2.5, far + 2.5));
        double const small = pi * (1.0 + 2 * 0.5 / 3.0), large = 4 * pi * (2.0 + 2 * 0.5 / 3.0);
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * (small + large), small + large, certificate.volume);
    }
    o.caps = BVX_CAPS_FLAT; /* by the blend: all the sooner the farther off the other part is */
    build_good();
    TEST_ASSERT_TRUE(highest_in(-1.5, 1.5) < 1.1);
}

/* A vein thinner than a cell that shifts from section to section stays one:
 * its parts meet, though no grid point lies in them. */
static void test_a_thin_vein_does_not_end(void)
{
    for (int i = 0; i < 4; i++) {
        stack_loop(&stack, stack_section(&stack, i));
        stack_point(&stack, 0.02 * i, 0);
        stack_point(&stack, 10 + 0.02 * i, 7);
        stack_point(&stack, 10 + 0.02 * i, 7.06);
        stack_point(&stack, 0.02 * i, 0.06);
    }
    o.caps = BVX_CAPS_TAPER;
    o.spacing = 0.9;
    build_good();
    TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
}

/* A round-edged plate with two holes through it, which widen towards both
 * faces: genus two from the first section to the last. */
static void test_double_torus(void)
{
    double volume[2];

    for (int pass = 0; pass < 2; pass++) {
        int const sections = pass ? 33 : 17;
        stack_clear(&stack);
        for (int i = 0; i < sections; i++) {
            /* edges are half circles */
            double const z = -0.48 + 0.96 * i / (sections - 1), half = sqrt(0.25 - z * z);
            uint32_t const k = stack_section(&stack, z);
            stack_round(&stack, k, 0, 0, 3.2 + half, 1.2 + half, 128, 0, 0, 0);
            stack_round(&stack, k, -1.6, 0, 1.2 - half, 1.2 - half, 64, 0, 0, 0);
            stack_round(&stack, k, 1.6, 0, 1.2 - half, 1.2 - half, 64, 0, 0, 0);
        }
        build_good();
        assert_points_kept();
        TEST_ASSERT_EQUAL_UINT64(1, certificate.components);
        TEST_ASSERT_EQUAL_INT64(-2, certificate.euler); /* two holes */
        volume[pass] = fabs(certificate.volume / report.prismoid_volume - 1.0);
    }
    TEST_ASSERT_TRUE(volume[0] < 0.02 && volume[1] < 0.02);
}

/* ---- the ways of crossing ---- */

static double farthest_contour_point(void)
{
    static bvx_closest_point found[STACK_POINTS];
    bvx_closest *closest;
    bvx_mesh_view view;
    double most = 0.0;

    bvx_mesh_view_of(&mesh, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, &view, &closest));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(ctx, closest, stack.point, stack.s.point_count, found));
    bvx_closest_free(ctx, closest);
    for (uint64_t i = 0; i < stack.s.point_count; i++)
        if (found[i].distance > most) most = found[i].distance;
    return most;
}

static void test_exact_keeps_what_paper_nearly_keeps_and_classic_cuts(void)
{
    double exact, paper, classic;

    for (int i = 0; i < 8; i++)
        stack_round(&stack, stack_section(&stack, 0.3 * i), 0, 0, 2, 1.5, 60, 0.25, 0.05 * i, 0);
    o.slabs.grid[0] = o.slabs.grid[1] = 12;
    build_good();
    exact = farthest_contour_point();
    TEST_ASSERT_EQUAL_UINT64(0, report.unkept_points);
    o.slabs.crossings = BVX_CROSSINGS_PAPER;
    build_good();
    paper = farthest_contour_point();
    o.slabs.crossings = BVX_CROSSINGS_CLASSIC;
    build_good();
    classic = farthest_contour_point();
    TEST_ASSERT_EQUAL_UINT64(stack.s.point_count, report.unkept_points);
    TEST_ASSERT_TRUE(exact < 1e-12);
    TEST_ASSERT_TRUE(paper > exact && paper < classic);
}

/* ---- frames, directions, order ---- */

static void test_any_axis_and_a_slanted_normal(void)
{
    double volume = 0.0;

    for (int turn = 0; turn < 5; turn++) {
        static const double normals[5][3] = {{0, 0, 1}, {1, 0, 0}, {0, -1, 0}, {0, 0, -2}, {0.6, 0, 0.8}};
        const double *const n = normals[turn];
        make_sphere(16, 40);
        for (uint64_t i = 0; i < stack.s.point_count; i++) {
            double *const p = stack.point + 3 * i, x = p[0], y = p[1], z = p[2];
            if (turn == 1) {
                p[0] = z;
                p[1] = x;
                p[2] = y;
            } else if (turn == 2) {
                p[1] = -z;
                p[2] = x;
                p[0] = -y;
            } else if (turn == 3) {
                p[2] = -z;
                p[1] = -y;
            } else if (turn == 4) {
                p[0] = 0.8 * x + 0.6 * z;
                p[2] = -0.6 * x + 0.8 * z;
                p[1] = y;
            }
        }
        memcpy(stack.s.normal, n, sizeof stack.s.normal);
        build_good();
        assert_points_kept();
        if (turn == 0) volume = certificate.volume;
        TEST_ASSERT_DOUBLE_WITHIN(0.02 * volume, volume, certificate.volume);
    }
}

static void reverse_points(bvx_section_loop *l)
{
    for (uint64_t i = 0, j = l->point_count - 1; i < j; i++, j--)
        for (uint64_t k = 0; k < 3; k++) {
            double const x = stack.point[3 * (l->first_point + i) + k];
            stack.point[3 * (l->first_point + i) + k] = stack.point[3 * (l->first_point + j) + k];
            stack.point[3 * (l->first_point + j) + k] = x;
        }
}

static void test_direction_of_loops_and_order_of_sections_change_nothing(void)
{
    uint64_t seed = 77;
    double volume, area;
    uint64_t triangles;

    stack_random(&stack, &seed);
    o.slabs.grid[0] = o.slabs.grid[1] = 20;
    build_good();
    volume = certificate.volume;
    area = certificate.area;
    triangles = certificate.triangles;
    for (uint64_t i = 0; i < stack.s.loop_count; i += 2) reverse_points(&stack.loop[i]);
    for (uint64_t i = 0; i < stack.s.loop_count; i++)
        stack.loop[i].section = (uint32_t)(stack.s.section_count - 1 - stack.loop[i].section);
    for (uint64_t i = 0, j = stack.s.section_count - 1; i < j; i++, j--) {
        double const x = stack.position[i];
        stack.position[i] = stack.position[j];
        stack.position[j] = x;
    }
    build_good();
    TEST_ASSERT_EQUAL_UINT64(triangles, certificate.triangles);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, volume, certificate.volume);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, area, certificate.area);
}

static void test_labels_are_bodies_by_themselves(void)
{
    for (int i = 0; i < 4; i++) {
        uint32_t const k = stack_section(&stack, 0.5 * i);
        stack_round(&stack, k, 0, 0, 1, 1, 32, 0, 0, 0);
        if (i == 3) continue;
        stack_round(&stack, k, 0, 0, 0.5, 0.5, 32, 0, 0, 0);
        stack.loop[stack.s.loop_count - 1].label = 7;
    }
    refuse(BVX_ERR_ARGUMENT, "several bodies (labels 1 and 7)");
    o.label = 1;
    build_good();
    TEST_ASSERT_EQUAL_UINT64(0, report.holes);
    TEST_ASSERT_DOUBLE_WITHIN(0.05, 1.5 * pi, certificate.volume);
    o.label = 7;
    build_good();
    TEST_ASSERT_DOUBLE_WITHIN(0.03, 0.25 * pi, certificate.volume);
    TEST_ASSERT_EQUAL_UINT64(3, report.sections);
    o.label = 3;
    refuse(BVX_ERR_EMPTY, "no loop has the label 3");
}

static void test_repeated_points_are_left_out(void)
{
    double volume;

    make_sphere(5, 16);
    build_good();
    volume = certificate.volume;
    stack_clear(&stack);
    for (int i = 0; i < 5; i++) {
        double const z = -1.0 + (2.0 * i + 1.0) / 5, r = sqrt(1.0 - z * z);
        stack_loop(&stack, stack_section(&stack, z));
        for (int j = 0; j <= 16; j++) { /* the first point again at the end, and each third one twice */
            double x, y;
            stack_circle((j % 16) / 16.0, &x, &y);
            for (int again = 0; again <= (j % 3 == 1); again++)
                stack_point(&stack, 0 + r * 1.0 * x, 0 + r * 1.0 * y);
        }
    }
    build_good();
    TEST_ASSERT_EQUAL_UINT64(5 * (1 + 6), report.repeated_points);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, volume, certificate.volume);
}

static void test_f32_is_rounded_f64(void)
{
    bvx_mesh wide;

    make_sphere(5, 16);
    build_good();
    wide = mesh;
    memset(&mesh, 0, sizeof mesh);
    o.position_type = BVX_F32;
    build_good();
    TEST_ASSERT_EQUAL_UINT64(wide.vertex_count, mesh.vertex_count);
    for (uint64_t i = 0; i < 3 * mesh.vertex_count; i++)
        TEST_ASSERT_TRUE(((const float *)mesh.positions)[i] == (float)((const double *)wide.positions)[i]);
    bvx_mesh_free(ctx, &wide);
}

/* ---- refusals ---- */

static void two_squares(void)
{
    stack_clear(&stack);
    for (int k = 0; k < 2; k++) {
        stack_loop(&stack, stack_section(&stack, k));
        stack_point(&stack, 0, 0);
        stack_point(&stack, 4, 0);
        stack_point(&stack, 4, 4);
        stack_point(&stack, 0, 4);
    }
}

static void test_bad_loops_are_refused(void)
{
    two_squares();
    stack.point[3 * 6] = 0.0; /* the second section's third and fourth corner change sides */
    stack.point[3 * 7] = 4.0;
    refuse(BVX_ERR_FORMAT, "loop 1 of section 1 (position 1) crosses or touches itself");
    two_squares();
    stack_loop(&stack, 1);
    stack_point(&stack, 4, 4); /* a corner in common */
    stack_point(&stack, 5, 4);
    stack_point(&stack, 5, 5);
    refuse(BVX_ERR_FORMAT, "of section 1 (position 1) cross or touch");
    two_squares();
    stack_loop(&stack, 1);
    stack_point(&stack, 1, 0); /* a side along a side */
    stack_point(&stack, 3, 0);
    stack_point(&stack, 2, 3);
    refuse(BVX_ERR_FORMAT, "cross or touch");
    two_squares();
    stack.point[3 * 6] = 2.0; /* out and back along one line */
    stack.point[3 * 6 + 1] = 0.0;
    refuse(BVX_ERR_FORMAT, "crosses or touches itself");
    two_squares();
    stack.loop[1].point_count = 2;
    refuse(BVX_ERR_EMPTY, "loop 1 of section 1 has 2 different points");
    two_squares();
    stack.loop[1].point_count = 0;
    refuse(BVX_ERR_EMPTY, "has 1 different point;");
    two_squares();
    for (int i = 4; i < 8; i++) { /* all on one line */
        stack.point[3 * i] = i;
        stack.point[3 * i + 1] = 2.0;
    }
    refuse(BVX_ERR_FORMAT, "touches itself");
}

/* At the limit sums are still numbers. */
static void test_volumes_of_far_contours_are_finite(void)
{
    two_squares();
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 2; a++) stack.point[3 * i + a] *= 0.25e75;
    stack.position[1] = 1e75;
    for (int i = 4; i < 8; i++) stack.point[3 * i + 2] = 1e75;
    build_good();
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, certificate.volume / 1e75 / 1e75 / 1e75);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, report.prismoid_volume / 1e75 / 1e75 / 1e75);
}

/* Two squares scaled, sections apart by themselves: either may be tiny. */
static void scaled_squares(double scale, double apart)
{
    two_squares();
    for (int i = 0; i < 8; i++)
        for (int a = 0; a < 2; a++) stack.point[3 * i + a] *= scale;
    stack.position[1] = apart;
    for (int i = 4; i < 8; i++) stack.point[3 * i + 2] = apart;
}

/* Areas of 1e-150 and less have products that are 0: volumes were 0 without a word. */
static void test_tiny_contours_have_volumes_or_are_refused(void)
{
    scaled_squares(0.25e-70, 1e-70);
    build_good();
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, certificate.volume / 1e-70 / 1e-70 / 1e-70);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, report.prismoid_volume / 1e-70 / 1e-70 / 1e-70);

    scaled_squares(0.25, 1e-160);
    build_good();
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, certificate.volume / 1e-160);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 1.0, report.prismoid_volume / 1e-160);

    scaled_squares(1e-160, 1.0);
    refuse(BVX_ERR_RANGE, "the widest loop spans 4e-160; below 1e-70 areas and volumes round to 0: scale");
    scaled_squares(1e-160, 1e-160);
    refuse(BVX_ERR_RANGE, "the widest loop spans 4e-160; below 1e-70");
}

static void test_bad_stacks_are_refused(void)
{
    refuse(BVX_ERR_EMPTY, "hold no loop");
    two_squares();
    stack.position[1] = 0.0;
    refuse(BVX_ERR_FORMAT, "sections 0 and 1 lie at one position, 0");
    two_squares();
    stack.loop[1].section = 0;
    refuse(BVX_ERR_EMPTY, "in only one section (index 0, at 0)");
    two_squares();
    stack.point[3 * 5 + 2] = 1.01;
    refuse(BVX_ERR_FORMAT, "point 5 of section 1 (position 1) lies 0.01");
    two_squares();
    stack.point[3 * 5] = NAN;
    refuse(BVX_ERR_RANGE, "point 5 is not finite");
    two_squares();
    stack.position[0] = -INFINITY;
    refuse(BVX_ERR_RANGE, "the position of section 0 is not finite");
    two_squares();
    stack.point[3 * 5 + 1] = -1.1e75; /* areas' products would overflow: volumes were infinite */
    refuse(BVX_ERR_RANGE, "point 5 has a coordinate of -1.1e75; the limit is 1e75");
    two_squares();
    stack.position[1] = 1e308;
    refuse(BVX_ERR_RANGE, "the position of section 1 is 1e308; the limit is 1e75");
    two_squares();
    stack.loop[1].section = 2;
    refuse(BVX_ERR_RANGE, "loop 1 is in section 2 of 2");
    two_squares();
    stack.loop[1].first_point = 5;
    refuse(BVX_ERR_RANGE, "loop 1 has points 5 to 9 of 8");
    two_squares();
    stack.loop[1].first_point = UINT64_MAX;
    refuse(BVX_ERR_RANGE, "loop 1 has points");
    two_squares();
    stack.s.normal[2] = 0.0;
    refuse(BVX_ERR_ARGUMENT, "the normal has no length");
    two_squares();
    stack.s.normal[0] = NAN;
    refuse(BVX_ERR_RANGE, "the normal is not finite");
    two_squares();
    stack.s.reserved2[1] = 1;
    refuse(BVX_ERR_ARGUMENT, "reserved2[1]");
    two_squares();
    stack.s.points = NULL;
    refuse(BVX_ERR_ARGUMENT, "is NULL");
    two_squares();
    for (int i = 0; i < 8; i++) stack.point[3 * i] += 1e17; /* the extent drowns in the coordinates */
    TEST_ASSERT_TRUE(build() != BVX_OK);
}

static void test_bad_options_are_refused(void)
{
    static const struct {
        size_t field;
        int32_t value;
        const char *words;
    } bad[] = {
        {offsetof(bvx_sections_options, caps), 3, "caps 3"},
        {offsetof(bvx_sections_options, slabs.crossings), -1, "crossings -1"},
        {offsetof(bvx_sections_options, slabs.depth), 9, "depth is 9"},
        {offsetof(bvx_sections_options, position_type), 3, "position_type 3"},
        {offsetof(bvx_sections_options, slabs.grid), 1, "grid[0] is 1"},
        {offsetof(bvx_sections_options, slabs.grid), 8193, "grid[0] is 8193"},
    };
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        two_squares();
        o = (bvx_sections_options){.struct_size = sizeof o};
        memcpy((char *)&o + bad[i].field, &bad[i].value, 4);
        refuse(BVX_ERR_ARGUMENT, bad[i].words);
    }
    o = (bvx_sections_options){.struct_size = sizeof o};
    o.spacing = -1.0;
    refuse(BVX_ERR_ARGUMENT, "spacing is -1");
    o.spacing = 1e-9;
    refuse(BVX_ERR_RANGE, "8192 is the limit");
    o.spacing = 1.0;
    o.slabs.grid[0] = o.slabs.grid[1] = 8;
    refuse(BVX_ERR_ARGUMENT, "grid and spacing are both given");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_build_sections(ctx, NULL, NULL, &mesh));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_build_sections(ctx, &stack.s, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_build_sections(NULL, &stack.s, NULL, &mesh));
}

/* ---- threads and memory ---- */

static bvx_context *context_of(int32_t threads, void *arena, size_t arena_size, uint64_t limit)
{
    bvx_context_options c = {.struct_size = sizeof c};
    bvx_context *made;

    c.threads = threads;
    c.arena.memory = arena;
    c.arena.size = arena_size;
    c.memory_limit = limit;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &made));
    return made;
}

/* A body that is worth several threads: holes, branches, small loops that ask for subdivision. */
static void make_long_stack(int sections)
{
    stack_clear(&stack);
    for (int i = 0; i < sections; i++) {
        uint32_t const k = stack_section(&stack, 0.1 * i);
        double const turn = 0.02 * i, side = i > sections / 2 ? 1.0 : 0.0;
        stack_round(&stack, k, 0.0, 0.0, 2.0, 1.0, 120, 0.3, turn, i & 1);
        if (i % 7 != 0) stack_round(&stack, k, 0.1, 0.0, 0.5, 0.3, 40, 0.1, turn, 0);
        stack_round(&stack, k, 3.6 + side, 1.0, 0.6, 0.4, 60, 0.2, turn, 0);
        stack_round(&stack, k, 3.6 - side, -1.4, 0.02, 0.01, 6, 0.0, turn, 1);
    }
}

/* The same mesh and the same report on any number of threads, from an
 * arena, under a limit that is just enough. */
static void test_threads_and_memory_change_nothing(void)
{
    static const int32_t threads[] = {1, 2, 3, 8, 1, 2};
    static unsigned char arena[1 << 25];
    uint64_t seed = 77, triangles = 0;

    make_long_stack(40);
    for (int i = 0; i < 6; i++) {
        bvx_sections_report first;
        uint64_t hash = 0, other, peak = 0;
        random_options(&seed);
        o.slabs.grid[0] = o.slabs.grid[1] = 20 + 30 * (i % 3);
        o.caps = i % 2;
        o.slabs.crossings = i == 5 ? BVX_CROSSINGS_PAPER : BVX_CROSSINGS_EXACT;
        for (int k = 0; k < 6; k++) {
            bvx_context *const c = context_of(threads[k], k == 5 ? arena : NULL, k == 5 ? sizeof arena : 0,
                                              k == 4 ? peak : 0);
            bvx_mesh m = {0};
            memset(&report, 0, sizeof report);
            if (bvx_build_sections(c, &stack.s, &o, &m) != BVX_OK) TEST_FAIL_MESSAGE(bvx_last_message(c));
            if (k == 0) peak = bvx_memory_peak(c);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &m, &other));
            triangles += m.triangle_count;
            bvx_mesh_free(c, &m);
            TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(c));
            bvx_context_destroy(c);
            if (k == 0) {
                hash = other;
                first = report;
            }
            TEST_ASSERT_EQUAL_HEX64(hash, other);
            TEST_ASSERT_EQUAL_INT(0, memcmp(&first, &report, sizeof first));
        }
        for (int part = 1; part < 4; part++) { /* with less there is no mesh, and nothing is left */
            bvx_context *const c = context_of(2, NULL, 0, peak * (uint64_t)part / 4);
            bvx_mesh m = {0};
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_BUDGET, bvx_build_sections(c, &stack.s, &o, &m));
            TEST_ASSERT_NULL(m.positions);
            TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(c));
            bvx_context_destroy(c);
        }
    }
    TEST_ASSERT_TRUE(triangles > 100000);
}

/* What is wrong with a section is said about the first one, whoever finds it. */
static void test_threads_refuse_alike(void)
{
    for (int32_t threads = 1; threads <= 8; threads += threads == 1 ? 1 : 3) {
        bvx_context *const c = context_of(threads, NULL, 0, 0);
        bvx_mesh m = {0};
        make_long_stack(40);
        /* two points change places: the loop crosses itself */
        for (uint32_t i = 0; i < stack.s.loop_count; i++)
            if (stack.loop[i].point_count == 120 &&
                (stack.loop[i].section == 17 || stack.loop[i].section == 31)) {
                double *const p = stack.point + 3 * (stack.loop[i].first_point + 50), kept[2] = {p[0], p[1]};
                memcpy(p, p + 6, sizeof kept);
                memcpy(p + 6, kept, sizeof kept);
            }
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, bvx_build_sections(c, &stack.s, &o, &m));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(c), "of section 17 (position 1.7"));
        bvx_context_destroy(c);
    }
}

/* ---- one number for all compilers and processors ---- */

static void test_sections_golden(void)
{
    uint64_t seed = 4242, hash, all = 0;

    for (int i = 0; i < 12; i++) {
        do stack_random(&stack, &seed);
        while (build() == BVX_ERR_FORMAT);
        random_options(&seed);
        o.slabs.crossings = i % 3;
        o.slabs.grid[0] += 6;
        o.slabs.grid[1] += 6;
        build_good();
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &mesh, &hash));
        all = bvx_hash(&hash, 0, all ^ hash);
    }
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x9A996D6DAC45DDA2), all);
}

/* A cylinder: its volume and its points do not depend on how often it is cut. */
static void test_stacks_of_few_and_many_sections(void)
{
    static const int count[] = {1, 2, 100, 1000};

    for (int i = 0; i < 4; i++) {
        double area = 0.0;
        stack_clear(&stack);
        for (int k = 0; k < count[i]; k++) {
            uint32_t const section = stack_section(&stack, count[i] == 1 ? 0.0 : 4.0 * k / (count[i] - 1));
            stack_round(&stack, section, 0, 0, 1, 1, 12, 0, 0, 0);
        }
        o.slabs.grid[0] = o.slabs.grid[1] = 6;
        if (count[i] == 1) {
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, build());
            continue;
        }
        build_good();
        assert_points_kept();
        TEST_ASSERT_EQUAL_UINT64((uint64_t)count[i], report.sections);
        TEST_ASSERT_EQUAL_INT64(2, certificate.euler);
        for (int k = 0; k < 12; k++) {
            const double *const a = stack.point + 3 * k, *const b = stack.point + 3 * ((k + 1) % 12);
            area += 0.5 * (a[0] * b[1] - a[1] * b[0]);
        }
        TEST_ASSERT_TRUE(fabs(certificate.volume - 4.0 * area) < 1e-9);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_stacks_of_few_and_many_sections);
    RUN_TEST(test_random_stacks_are_closed_and_keep_all_points);
    RUN_TEST(test_random_stacks_in_the_fields_way_are_closed);
    RUN_TEST(test_points_on_round_numbers);
    RUN_TEST(test_open_ends_have_the_contours_as_boundary);
    RUN_TEST(test_sphere_converges);
    RUN_TEST(test_cone_has_its_volume);
    RUN_TEST(test_torus_with_its_axis_in_the_plane);
    RUN_TEST(test_slices_leave_out_what_encloses_no_area);
    RUN_TEST(test_branching);
    RUN_TEST(test_nested_shells);
    RUN_TEST(test_a_hole_closes);
    RUN_TEST(test_an_empty_section_parts_the_body);
    RUN_TEST(test_three_sections_behave);
    RUN_TEST(test_each_part_tapers_by_itself);
    RUN_TEST(test_a_thin_vein_does_not_end);
    RUN_TEST(test_double_torus);
    RUN_TEST(test_exact_keeps_what_paper_nearly_keeps_and_classic_cuts);
    RUN_TEST(test_any_axis_and_a_slanted_normal);
    RUN_TEST(test_direction_of_loops_and_order_of_sections_change_nothing);
    RUN_TEST(test_labels_are_bodies_by_themselves);
    RUN_TEST(test_repeated_points_are_left_out);
    RUN_TEST(test_f32_is_rounded_f64);
    RUN_TEST(test_bad_loops_are_refused);
    RUN_TEST(test_volumes_of_far_contours_are_finite);
    RUN_TEST(test_tiny_contours_have_volumes_or_are_refused);
    RUN_TEST(test_bad_stacks_are_refused);
    RUN_TEST(test_bad_options_are_refused);
    RUN_TEST(test_threads_and_memory_change_nothing);
    RUN_TEST(test_threads_refuse_alike);
    RUN_TEST(test_sections_golden);
    return UNITY_END();
}
