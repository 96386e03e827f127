/* test_boolean.c - booleans of meshes: the solid of the result against the combined solids bit for bit, its
 * vertices against the surfaces of the operands, volumes against whole numbers. */
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

static maker_mesh first, second;
static bvx_mesh_view a, b;
static bvx_mesh made;
static bvx_boolean_report report;
static uint64_t seed;

void setUp(void)
{
    suite_open(1);
    seed = 9;
    memset(&first, 0, sizeof first);
    memset(&second, 0, sizeof second);
    memset(&report, 0, sizeof report);
}

void tearDown(void)
{
    bvx_mesh_free(ctx, &made);
    maker_free(&first);
    maker_free(&second);
    suite_close();
}

static bvx_boolean_options with(int32_t resolution)
{
    bvx_boolean_options o = {.struct_size = sizeof o};
    o.fit.resolution = resolution;
    o.parts.keep_crumbs = 1; /* the solids are compared to the bit */
    o.thin = BVX_THIN_DROP;
    o.report = &report;
    return o;
}

static void run(int32_t operation, const bvx_boolean_options *o)
{
    bvx_mesh_free(ctx, &made);
    bvx_status const status = bvx_boolean(ctx, &a, &b, operation, o, &made);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(ctx));
}

static bvx_certificate check(void)
{
    bvx_certificate c;
    bvx_mesh_view v;
    bvx_mesh_view_of(&made, &v);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &v, 0, &c));
    TEST_ASSERT_TRUE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented);
    TEST_ASSERT_EQUAL_UINT64(0, c.degenerate + c.collapsed + c.duplicates + c.unused_vertices);
    return c;
}

static void make_stars(void)
{
    static const double centre[2][3] = {{20, 21, 19}, {31, 24, 22}};
    static const double radius[2][3] = {{16, 15, 13}, {14, 17, 12}};

    maker_clear(&first);
    maker_clear(&second);
    maker_star(&first, &seed, centre[0], radius[0], 0.3, 11, 17, 65536);
    maker_star(&second, &seed, centre[1], radius[1], 0.3, 12, 15, 65536);
    a = maker_view(&first);
    b = maker_view(&second);
}

static void make_boxes(const double low_a[3], const double high_a[3], const double low_b[3],
                       const double high_b[3])
{
    maker_clear(&first);
    maker_clear(&second);
    maker_box(&first, low_a, high_a);
    maker_box(&second, low_b, high_b);
    a = maker_view(&first);
    b = maker_view(&second);
}

static void solid_of(const bvx_mesh_view *mesh, const bvx_lattice *l, bvx_grid *grid)
{
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, mesh, l, NULL, grid));
}

/* ---- Fills and lattices ---- */

/* A box without one side, united with itself: each is closed by its winding number. */
static void test_open_meshes_are_filled_by_winding(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {10, 12, 14};
    bvx_boolean_options const o = with(64);

    make_boxes(low, high, low, high);
    first.triangles -= 2; /* across z */
    second.triangles -= 2;
    a = maker_view(&first);
    b = maker_view(&second);
    run(BVX_BOOLEAN_UNION, &o);
    TEST_ASSERT_TRUE(check().volume > 0.75 * 10 * 12 * 14);
    TEST_ASSERT_EQUAL_INT32(BVX_FILL_WINDING, report.solid_a.fill);
    TEST_ASSERT_EQUAL_INT32(BVX_FILL_REASON_OPEN, report.solid_b.fill_reason);
    TEST_ASSERT_EQUAL_UINT64(report.solid_a.unbalanced_rows, report.solid_b.unbalanced_rows);
    first.triangles = second.triangles = 10; /* the last two stand across z: rows along x balance */
    for (int i = 0; i < 2; i++) {
        maker_remove(&first, 0); /* across x: they do not */
        maker_remove(&second, 0);
    }
    a = maker_view(&first);
    b = maker_view(&second);
    run(BVX_BOOLEAN_UNION, &o);
    TEST_ASSERT_TRUE(report.solid_a.unbalanced_rows > 0);
}

/* Two bars that overlap in one mesh, one of their triangles flipped, less a box. */
static void test_overlapping_parts_are_one_body(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {8, 8, 8}, low_c[3] = {4, 2, 2}, high_c[3] = {12, 6, 6};
    static const double low_b[3] = {2, 2, 2}, high_b[3] = {6, 6, 20};
    bvx_boolean_options o = with(96);

    make_boxes(low, high, low_b, high_b);
    maker_box(&first, low_c, high_c);
    maker_flip(&first, 17, 18);
    a = maker_view(&first);
    run(BVX_BOOLEAN_DIFFERENCE, &o);
    TEST_ASSERT_EQUAL_INT32(BVX_FILL_NONZERO, report.solid_a.fill);
    TEST_ASSERT_EQUAL_UINT64(1, report.solid_a.turned);
    TEST_ASSERT_DOUBLE_WITHIN(4, 512 + 64 - 96, check().volume);
}

/* A half-space that cuts a part is a far larger box. */
static void test_lattices_fit_what_can_be_left(void)
{
    static const double low[3] = {0, 0, 0};
    static const double high[3] = {8, 6, 4};
    static const double far_low[3] = {3, -5000, -5000};
    static const double far_high[3] = {10000, 5000, 5000};
    bvx_boolean_options o = with(64);
    make_boxes(low, high, far_low, far_high);
    run(BVX_BOOLEAN_DIFFERENCE, &o);
    TEST_ASSERT_DOUBLE_WITHIN(1, 3 * 6 * 4, check().volume);
    TEST_ASSERT_EQUAL_INT32(66, report.lattice.dims[0]);
    TEST_ASSERT_EQUAL_INT32(0, report.few);
    run(BVX_BOOLEAN_INTERSECTION, &o);
    TEST_ASSERT_DOUBLE_WITHIN(1, 5 * 6 * 4, check().volume);
    TEST_ASSERT_EQUAL_INT32(66, report.lattice.dims[1]); /* 6 is the longest */
    TEST_ASSERT_EQUAL_INT32(0, report.few);

    /* together the part is less than a voxel: refused, and no resolution above 4,096 is advised */
    bvx_mesh_free(ctx, &made);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_boolean(ctx, &a, &b, BVX_BOOLEAN_UNION, &o, &made));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "mesh a"));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "at any resolution of up to 4096"));
}

static void test_few_voxels_are_told_with_the_resolution_to_take(void)
{
    static const double low[3] = {0, 0, 0};
    static const double high[3] = {100, 100, 100};
    static const double low_b[3] = {20, 20, 20};
    static const double high_b[3] = {24, 23, 23};
    static const double plate_low[3] = {-10, -10, 30.01}, plate_high[3] = {110, 110, 30.2};
    bvx_boolean_options o = with(100);
    make_boxes(low, high, low_b, high_b);
    run(BVX_BOOLEAN_DIFFERENCE, &o);
    TEST_ASSERT_EQUAL_INT32(BVX_FEW_B, report.few);
    TEST_ASSERT_EQUAL_INT32(1600, report.advised_resolution);
    o.fit.resolution = report.advised_resolution / 4;
    run(BVX_BOOLEAN_DIFFERENCE, &o);
    TEST_ASSERT_EQUAL_INT32(0, report.few);

    make_boxes(low_b, high_b, low, high);
    o.fit.resolution = 3;
    run(BVX_BOOLEAN_DIFFERENCE, &o); /* nothing is left: no mesh to warn of but a */
    TEST_ASSERT_EQUAL_INT32(BVX_FEW_A | BVX_FEW_B, report.few);

    /* a plate thinner than a voxel that sticks out: told, no error */
    make_boxes(low, high, plate_low, plate_high);
    o.fit.resolution = 100;
    run(BVX_BOOLEAN_DIFFERENCE, &o);
    TEST_ASSERT_EQUAL_UINT64(0, report.voxels_b);
    TEST_ASSERT_EQUAL_INT32(BVX_FEW_B, report.few);
    TEST_ASSERT_TRUE(report.advised_resolution >= 1000 && report.advised_resolution < 1200);
}

/* ---- Tests ---- */

/* The surface passes between inside and outside centres, so the solid of the result is the combined solid. */
static void test_solid_of_the_result_is_the_combined_solid(void)
{
    for (int sharp = 0; sharp < 2; sharp++)
        for (int32_t op = 0; op < 4; op++) {
            bvx_boolean_options o = with(40);
            bvx_grid of_a = {0}, of_b = {0}, want = {0}, got = {0};
            bvx_mesh_view view;
            uint64_t count;
            make_stars();
            o.placing.sharp = BVX_SHARP_NEVER + sharp;
            o.placing.position_type = BVX_F64;
            run(op, &o);
            check();
            bvx_mesh_view_of(&made, &view);
            solid_of(&a, &report.lattice, &of_a);
            solid_of(&b, &report.lattice, &of_b);
            solid_of(&view, &report.lattice, &got);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_combine(ctx, &of_a, &of_b, op, &want));
            if (!sharp)
                TEST_ASSERT_EQUAL_HEX64_ARRAY(want.words, got.words,
                                              (size_t)want.words_per_row *
                                                  (size_t)(want.size[1] * want.size[2]));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &want, &count));
            TEST_ASSERT_EQUAL_UINT64(count, report.voxels);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &of_a, &count));
            TEST_ASSERT_EQUAL_UINT64(count, report.voxels_a);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &of_b, &count));
            TEST_ASSERT_EQUAL_UINT64(count, report.voxels_b);
            if (!sharp) TEST_ASSERT_EQUAL_UINT64(made.vertex_count, report.surface.edges);
            else TEST_ASSERT_TRUE(report.surface.edges < made.vertex_count);
            TEST_ASSERT_EQUAL_UINT64(0, report.surface.middle);
            bvx_grid_free(ctx, &of_a);
            bvx_grid_free(ctx, &of_b);
            bvx_grid_free(ctx, &want);
            bvx_grid_free(ctx, &got);
        }
}

/* Largest and mean distance of the result's vertices to the nearer of the operands. */
static double distance_to_operands(double *mean)
{
    bvx_closest *to[2];
    double most = 0;

    *mean = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, &a, &to[0]));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, &b, &to[1]));
    for (uint64_t v = 0; v < made.vertex_count; v++) {
        bvx_closest_point p[2];
        double d;
        for (int i = 0; i < 2; i++)
            TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                    bvx_closest_find(ctx, to[i], (double *)made.positions + 3 * v, 1, &p[i]));
        d = p[0].distance < p[1].distance ? p[0].distance : p[1].distance;
        most = d > most ? d : most;
        *mean += d / (double)made.vertex_count;
    }
    bvx_closest_free(ctx, to[0]);
    bvx_closest_free(ctx, to[1]);
    return most;
}

static void test_vertices_lie_on_the_operands(void)
{
    make_stars();
    for (int32_t op = 0; op < 4; op++) {
        bvx_boolean_options o = with(48);
        double mean, middle, most;
        o.placing.position_type = BVX_F64;
        o.placing.sharp = BVX_SHARP_NEVER; /* vertices within cells need not lie on one of the faces */
        run(op, &o);
        most = distance_to_operands(&mean);
        TEST_ASSERT_TRUE(most < 0.6 * report.lattice.spacing[0]);
        TEST_ASSERT_TRUE(mean < 0.02 * report.lattice.spacing[0]);
        o.placing.interpolation = BVX_EDGE_MIDDLE;
        run(op, &o);
        distance_to_operands(&middle);
        TEST_ASSERT_TRUE(middle > 5 * mean);
    }
}

/* Where only flat faces are, each vertex lies on a face of the body whose
 * side changes there, not between the two. */
static void test_vertices_of_boxes_lie_on_their_faces(void)
{
    static const double low_a[3] = {0, 0, 0};
    static const double high_a[3] = {10, 9, 8};
    static const double low_b[3] = {4.03, 3.07, 2.11};
    static const double high_b[3] = {12.05, 11.01, 7.13};

    make_boxes(low_a, high_a, low_b, high_b);
    for (int32_t op = 0; op < 4; op++) {
        bvx_boolean_options o = with(37);
        uint64_t off = 0;
        o.placing.position_type = BVX_F64;
        run(op, &o);
        check();
        for (uint64_t v = 0; v < made.vertex_count; v++) {
            const double *const p = (const double *)made.positions + 3 * v;
            double best = 1e9;
            for (int axis = 0; axis < 3; axis++) {
                double const planes[4] = {low_a[axis], high_a[axis], low_b[axis], high_b[axis]};
                for (int i = 0; i < 4; i++)
                    best = fabs(p[axis] - planes[i]) < best ? fabs(p[axis] - planes[i]) : best;
            }
            off += best > 1e-9;
        }
        TEST_ASSERT_EQUAL_UINT64(0, off);
    }
}

/* Sharp, boxes come out whole: volumes are those of the exact bodies. */
static void test_sharp_volumes_of_boxes(void)
{
    static const double low_a[3] = {0, 0, 0};
    static const double high_a[3] = {10, 9, 8};
    static const double low_b[3] = {4.03, 3.07, 2.11};
    static const double high_b[3] = {12.05, 11.01, 7.13};
    double const of_a = 10 * 9 * 8, of_b = 8.02 * 7.94 * 5.02, both = 5.97 * 5.93 * 5.02;
    double const want[4] = {of_a + of_b - both, both, of_a - both, of_a + of_b - 2 * both};

    make_boxes(low_a, high_a, low_b, high_b);
    for (int32_t op = 0; op < 4; op++) {
        bvx_boolean_options o = with(48);
        double plain;
        o.placing.sharp = BVX_SHARP_NEVER;
        run(op, &o);
        plain = check().volume;
        o.placing.sharp = BVX_SHARP_ALWAYS;
        run(op, &o);
        TEST_ASSERT_DOUBLE_WITHIN(op == 3 ? 0.02 * want[op] : 2e-3 * want[op], want[op], check().volume);
        TEST_ASSERT_TRUE(op == 3 || fabs(check().volume - want[op]) < fabs(plain - want[op]));
        TEST_ASSERT_TRUE(report.surface.sharp_cells > 100);
    }
}

static void test_identities(void)
{
    bvx_boolean_options o = with(32);
    uint64_t one, other;

    make_stars();
    for (int32_t op = 0; op < 4; op++) { /* a op b is b op a */
        bvx_mesh_view const swap = a;
        if (op == BVX_BOOLEAN_DIFFERENCE) continue;
        run(op, &o);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &made, &one));
        a = b;
        b = swap;
        run(op, &o);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &made, &other));
        TEST_ASSERT_EQUAL_HEX64(one, other);
    }
    b = a;
    run(BVX_BOOLEAN_UNION, &o); /* a or a is a and a */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &made, &one));
    run(BVX_BOOLEAN_INTERSECTION, &o);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &made, &other));
    TEST_ASSERT_EQUAL_HEX64(one, other);
    run(BVX_BOOLEAN_DIFFERENCE, &o); /* nothing is left: an empty mesh */
    TEST_ASSERT_EQUAL_UINT64(0, made.triangle_count);
    TEST_ASSERT_EQUAL_UINT64(0, report.voxels);
    run(BVX_BOOLEAN_XOR, &o);
    TEST_ASSERT_EQUAL_UINT64(0, made.triangle_count);
}

static void test_a_body_within_another(void)
{
    static const double low_a[3] = {0, 0, 0};
    static const double high_a[3] = {10, 10, 10};
    static const double low_b[3] = {3, 3, 3};
    static const double high_b[3] = {6, 7, 8};
    bvx_boolean_options o = with(40);
    bvx_certificate c;

    make_boxes(low_a, high_a, low_b, high_b);
    run(BVX_BOOLEAN_DIFFERENCE, &o); /* a cavity: its surface looks inwards */
    c = check();
    TEST_ASSERT_EQUAL_UINT64(2, c.components);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * 940, 940, c.volume);
    run(BVX_BOOLEAN_UNION, &o);
    c = check();
    TEST_ASSERT_EQUAL_UINT64(1, c.components);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * 1000, 1000, c.volume);
}

/* A slot through a box leaves two parts; of them so many of the largest stay. */
static void test_the_largest_parts_are_kept(void)
{
    static const double low_a[3] = {0, 0, 0}, high_a[3] = {10, 10, 10};
    static const double low_b[3] = {3, -1, -1}, high_b[3] = {4, 11, 11};
    static const double volume[4] = {900, 600, 900, 900};
    bvx_boolean_options o = with(60);

    make_boxes(low_a, high_a, low_b, high_b);
    for (uint64_t n = 0; n < 4; n++) {
        o.parts.keep_largest = n;
        run(BVX_BOOLEAN_DIFFERENCE, &o);
        TEST_ASSERT_DOUBLE_WITHIN(0.01 * volume[n], volume[n], check().volume);
        TEST_ASSERT_EQUAL_UINT64(n == 1 ? 1 : 0, report.parts_dropped);
        TEST_ASSERT_EQUAL_UINT64(n == 1 ? 36 * 60 * 60 : 54 * 60 * 60, report.voxels);
    }
}

static void test_given_lattice_cuts_the_bodies(void)
{
    static const double low_a[3] = {0, 0, 0};
    static const double high_a[3] = {10, 10, 10};
    static const double low_b[3] = {3, 3, 3};
    static const double high_b[3] = {16, 7, 8};
    double const origin[3] = {2, 2, 2}, spacing[3] = {0.5, 0.25, 0.4};
    int32_t const dims[3] = {20, 30, 20};
    bvx_boolean_options o = with(0);
    bvx_lattice l;

    make_boxes(low_a, high_a, low_b, high_b);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    o.fit.lattice = &l;
    run(BVX_BOOLEAN_UNION, &o);
    check();
    TEST_ASSERT_EQUAL_MEMORY(&l, &report.lattice, sizeof l);
    TEST_ASSERT_TRUE(report.surface.middle > 0); /* crossings with the lattice's sides */
}

static void test_threads_and_code_paths_are_not_seen(void)
{
    make_stars();
    for (int sharp = 0; sharp < 2; sharp++) {
        uint64_t want = 0;
        for (int way = 0; way < 3; way++) {
            bvx_context_options c = {.struct_size = sizeof c};
            bvx_boolean_options o = with(long_run ? 64 : 40);
            bvx_context *other;
            bvx_mesh m = {0};
            uint64_t hash;
            c.threads = way == 1 ? 3 : 1;
            c.cpu = way == 2 ? BVX_CPU_PORTABLE : BVX_CPU_BEST;
            o.placing.sharp = BVX_SHARP_NEVER + sharp;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &other));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_boolean(other, &a, &b, BVX_BOOLEAN_DIFFERENCE, &o, &m));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(other, &m, &hash));
            if (way == 0) want = hash;
            TEST_ASSERT_EQUAL_HEX64(want, hash);
            bvx_mesh_free(other, &m);
            bvx_context_destroy(other);
        }
    }
}

/* One number each, the same on every compiler and processor. */
static void test_golden(void)
{
    static const uint64_t want[2] = {UINT64_C(0xF03AA3FD0640CDD5), UINT64_C(0xC696D128BDE5E2F9)};

    make_stars();
    for (int sharp = 0; sharp < 2; sharp++) {
        bvx_boolean_options o = with(40);
        uint64_t hash;
        o.placing.sharp = BVX_SHARP_NEVER + sharp;
        run(BVX_BOOLEAN_DIFFERENCE, &o);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &made, &hash));
        TEST_ASSERT_EQUAL_HEX64(want[sharp], hash);
    }
}

static void refuse(int32_t operation, const bvx_boolean_options *o, bvx_status status, const char *word)
{
    TEST_ASSERT_EQUAL_INT32(status, bvx_boolean(ctx, &a, &b, operation, o, &made));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx));
    TEST_ASSERT_NULL(made.positions);
}

static void test_refusals(void)
{
    bvx_boolean_options o = with(16);
    bvx_lattice none;

    make_stars();
    refuse(4, &o, BVX_ERR_ARGUMENT, "operation 4");
    refuse(-1, &o, BVX_ERR_ARGUMENT, "operation -1");
    o.fit.resolution = -1;
    refuse(0, &o, BVX_ERR_ARGUMENT, "resolution");
    o = with(16), o.fill = BVX_FILL_FLOOD;
    refuse(0, &o, BVX_ERR_ARGUMENT, "fill");
    o = with(16), o.placing.interpolation = 5;
    refuse(0, &o, BVX_ERR_ARGUMENT, "interpolation");
    o = with(16), o.placing.face_rule = 2;
    refuse(0, &o, BVX_ERR_ARGUMENT, "face_rule");
    o = with(16), o.placing.position_type = 3;
    refuse(0, &o, BVX_ERR_ARGUMENT, "position_type");
    o = with(16), o.placing.sharp = 3;
    refuse(0, &o, BVX_ERR_ARGUMENT, "sharp");
    o = with(16), o.placing.reserved = 1;
    refuse(0, &o, BVX_ERR_ARGUMENT, "reserved");
    memset(&none, 0, sizeof none);
    o = with(16), o.fit.lattice = &none;
    refuse(0, &o, BVX_ERR_ARGUMENT, "spacing");
    o = with(16);
    second.p[4] = NAN;
    refuse(0, &o, BVX_ERR_RANGE, "mesh b");
    first.t[5] = 1000000;
    refuse(0, &o, BVX_ERR_RANGE, "mesh a");
    make_stars();
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_boolean(ctx, NULL, &b, 0, &o, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_boolean(ctx, &a, NULL, 0, &o, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_boolean(ctx, &a, &b, 0, &o, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_boolean(NULL, &a, &b, 0, &o, &made));
}

/* Boxes that doubles hold in a lattice that reaches beyond them. */
static void test_lattice_beyond_doubles(void)
{
    for (int32_t resolution = 4; resolution < 30; resolution += 5)
        for (int sharp = 0; sharp < 2; sharp++) {
            static const double low[3] = {-8.5e307, -8.5e307, -8.5e307};
            static const double high[3] = {8.5e307, 8.5e307, 8.5e307};
            bvx_boolean_options o = with(resolution);
            bvx_status status;
            o.placing.sharp = BVX_SHARP_NEVER + sharp;
            o.placing.position_type = BVX_F64;
            make_boxes(low, high, low, high);
            status = bvx_boolean(ctx, &a, &b, BVX_BOOLEAN_UNION, &o, &made);
            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_ERR_RANGE, status, bvx_last_message(ctx));
            TEST_ASSERT_NULL(made.positions);
        }
}

/* The operands are read while the result is written. */
static void test_arrays_of_the_operands_are_not_taken(void)
{
    static double positions[3 * 20000];
    static uint32_t triangles[3 * 40000];

    for (int operand = 0; operand < 2; operand++)
        for (int array = 0; array < 2; array++) {
            bvx_boolean_options const o = with(16);
            bvx_mesh into = {0};
            bvx_mesh_view *const view = operand == 0 ? &a : &b;
            make_stars();
            memcpy(positions, view->positions, (size_t)view->vertex_count * 24);
            memcpy(triangles, view->indices, (size_t)view->triangle_count * 12);
            if (array == 0) view->positions = positions;
            else view->indices = triangles;
            into.positions = positions;
            into.triangles = triangles;
            into.position_type = BVX_F32;
            into.vertex_capacity = 20000;
            into.triangle_capacity = 40000;
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_boolean(ctx, &a, &b, 0, &o, &into));
            TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx),
                                        operand == 0 ? "mesh a: the result's" : "mesh b: the result's"));
            if (array == 0)
                TEST_ASSERT_EQUAL_MEMORY(operand == 0 ? first.p : second.p, positions,
                                         (size_t)view->vertex_count * 24);
            else
                TEST_ASSERT_EQUAL_MEMORY(operand == 0 ? first.t : second.t, triangles,
                                         (size_t)view->triangle_count * 12);
        }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_solid_of_the_result_is_the_combined_solid);
    RUN_TEST(test_vertices_lie_on_the_operands);
    RUN_TEST(test_vertices_of_boxes_lie_on_their_faces);
    RUN_TEST(test_sharp_volumes_of_boxes);
    RUN_TEST(test_identities);
    RUN_TEST(test_a_body_within_another);
    RUN_TEST(test_the_largest_parts_are_kept);
    RUN_TEST(test_given_lattice_cuts_the_bodies);
    RUN_TEST(test_threads_and_code_paths_are_not_seen);
    RUN_TEST(test_open_meshes_are_filled_by_winding);
    RUN_TEST(test_overlapping_parts_are_one_body);
    RUN_TEST(test_lattices_fit_what_can_be_left);
    RUN_TEST(test_few_voxels_are_told_with_the_resolution_to_take);
    RUN_TEST(test_golden);
    RUN_TEST(test_refusals);
    RUN_TEST(test_lattice_beyond_doubles);
    RUN_TEST(test_arrays_of_the_operands_are_not_taken);
    return UNITY_END();
}
