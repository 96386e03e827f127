/* test_sharp.c - sharp features of a field's surface: corners and edges are
 * met, and no field makes triangles cross. */
#include "unit/field_surface_support.h"

/* The oracle that all below rests on: a mesh without crossings, then one
 * vertex pulled through, then a doubled triangle. */
static void test_the_oracle_sees_crossings(void)
{
    double const origin[3] = {2, 2, 2}, spacing[3] = {1, 1, 1};
    bvx_lattice const l = lattice_at(origin, spacing, 8, 8, 8);
    bvx_field_surface_options o = surface_options(0);
    const char *wrong;
    bvx_mesh m;
    float *p;

    o.placing.interpolation = BVX_EDGE_MIDDLE;
    field_maker_noise(ctx, &seed, &l, 8, 16, 1, 0, BVX_F32, &field);
    m = surface_of(ctx, NULL, &o);
    p = m.positions;
    TEST_ASSERT_EQUAL_UINT64(0, crossing_count(&m, 4503599627370496.0, &wrong));
    for (int n = 0; n < trial_count(25, 25, 100); n++) {
        size_t const v = (size_t)maker_below(&seed, (int32_t)m.vertex_count);
        float const old = p[3 * v];
        p[3 * v] = old < 6 ? old + 5 : old - 5;
        TEST_ASSERT_TRUE(crossing_count(&m, 4503599627370496.0, &wrong) > 0);
        p[3 * v] = old;
    }
    memcpy(m.triangles, m.triangles + 3, 12);
    TEST_ASSERT_EQUAL_UINT64(1, crossing_count(&m, 4503599627370496.0, &wrong));
    TEST_ASSERT_NULL(wrong);
    p[0] = 1e-12f;
    crossing_count(&m, 4503599627370496.0, &wrong);
    TEST_ASSERT_NOT_NULL(wrong);
    bvx_mesh_free(ctx, &m);
}

/* ---- shapes ---- */

/* A box turned by whole-number rotations about two axes, so that no face is square to the lattice. */
static void turned_box(double cx, double cy, double cz, double hx, double hy, double hz)
{
    double const low[3] = {-hx, -hy, -hz}, high[3] = {hx, hy, hz};

    maker_box(&mesh, low, high);
    for (size_t i = 0; i < mesh.vertices; i++) {
        double *const p = mesh.p + 3 * i;
        double const x = 0.8 * p[0] - 0.6 * p[1], y = 0.6 * p[0] + 0.8 * p[1], z = p[2];
        p[0] = cx + x;
        p[1] = cy + (12.0 * y - 5.0 * z) / 13.0;
        p[2] = cz + (5.0 * y + 12.0 * z) / 13.0;
    }
}

/* From p to the nearest vertex of a mesh. */
static double nearest_vertex(const bvx_mesh *m, const double *p)
{
    double best = INFINITY;

    for (uint64_t i = 0; i < m->vertex_count; i++) {
        double d = 0;
        for (uint64_t a = 0; a < 3; a++) {
            double const x = m->position_type == BVX_F32 ? (double)((const float *)m->positions)[3 * i + a]
                                                         : ((const double *)m->positions)[3 * i + a];
            d += (x - p[a]) * (x - p[a]);
        }
        best = d < best ? d : best;
    }
    return sqrt(best);
}

static void compare_with_mesh(const bvx_mesh *m, bvx_distance_report *d)
{
    bvx_mesh_view const a = maker_view(&mesh);
    bvx_mesh_view b;
    bvx_mesh_view_of(m, &b);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, &a, &b, 100000, 1, d));
}

static void check_turned_box(int with_triangles)
{
    double const origin[3] = {2, 2, 2}, spacing[3] = {0.5, 0.5, 0.5};
    bvx_lattice const l = lattice_at(origin, spacing, 26, 26, 26);
    bvx_field_surface_report report, plain_report;
    bvx_field_surface_options o = surface_options(1);
    bvx_distance_report with, without;
    bvx_mesh sharp, plain;
    bvx_mesh_view view;
    double worst = 0;
    int met = 0;

    turned_box(8.5, 8.51, 8.52, 4, 3, 3.5);
    view = maker_view(&mesh);
    field_maker_measure(ctx, &mesh, &l, 1.5, BVX_F32, &field);
    o.report = &report;
    sharp = surface_of(ctx, with_triangles ? &view : NULL, &o);
    o.placing.sharp = BVX_SHARP_NEVER;
    o.report = &plain_report;
    plain = surface_of(ctx, NULL, &o);
    assert_certificate(&sharp);
    assert_certificate(&plain);
    TEST_ASSERT_EQUAL_UINT64(plain.vertex_count + report.sharp_cells, sharp.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(plain.triangle_count + 2 * report.sharp_cells, sharp.triangle_count);
    TEST_ASSERT_EQUAL_UINT64(plain_report.edges, report.edges);
    TEST_ASSERT_TRUE(report.sharp_cells > 100 && report.flipped_edges > 80);
    compare_with_mesh(&sharp, &with);
    compare_with_mesh(&plain, &without);
    for (size_t i = 0; i < mesh.vertices; i++) {
        double const d = nearest_vertex(&sharp, mesh.p + 3 * i);
        worst = d > worst ? d : worst;
        met += d < 1e-4;
    }
    printf(
        "box%s: mean %.5f -> %.5f, max %.4f -> %.4f, %d corners met, all within %.4f; %d cells, %d taken back, %d turned\n",
        with_triangles ? "" : " (vectors)", without.mean, with.mean, without.max, with.max, met, worst,
        (int)report.sharp_cells, (int)report.sharp_taken_back, (int)report.flipped_edges);
    TEST_ASSERT_TRUE(with.mean < (with_triangles ? 0.1 : 0.3) * without.mean && with.max < 0.6 * without.max);
    /* some corners stick out into cells with no centre inside */
    TEST_ASSERT_TRUE(met >= 3 && worst < 0.25 * l.spacing[0]);
    bvx_mesh_free(ctx, &sharp);
    bvx_mesh_free(ctx, &plain);
}

static void test_sharp_meets_corners_and_edges_of_a_box(void)
{
    check_turned_box(1);
}

static void test_sharp_from_vectors_alone(void)
{
    check_turned_box(0);
}

static void test_sharp_leaves_a_smooth_surface_alone(void)
{
    double const origin[3] = {2, 2, 2};
    double const spacing[3] = {0.5, 0.5, 0.5};
    double const centre[3] = {8, 8, 8};
    double const radius[3] = {5, 5, 5};
    bvx_lattice const l = lattice_at(origin, spacing, 24, 24, 24);
    bvx_field_surface_options o = surface_options(1);
    bvx_field_surface_report report;
    bvx_mesh_view view;
    bvx_mesh sharp, plain;

    maker_star(&mesh, &seed, centre, radius, 0.0, 16, 32, 1 << 20);
    view = maker_view(&mesh);
    field_maker_measure(ctx, &mesh, &l, 1.5, BVX_F32, &field);
    o.sharp_angle = 0.5;
    o.report = &report;
    sharp = surface_of(ctx, &view, &o);
    TEST_ASSERT_EQUAL_UINT64(0, report.sharp_cells + report.sharp_taken_back + report.flipped_edges);
    o.placing.sharp = BVX_SHARP_NEVER;
    plain = surface_of(ctx, NULL, &o);
    TEST_ASSERT_EQUAL_UINT64(plain.vertex_count, sharp.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(plain.triangle_count, sharp.triangle_count);
    TEST_ASSERT_EQUAL_INT(0, memcmp(plain.triangles, sharp.triangles, (size_t)plain.triangle_count * 12));
    bvx_mesh_free(ctx, &sharp);
    bvx_mesh_free(ctx, &plain);
}

/* ---- every field ---- */

typedef struct tally {
    uint64_t surfaces, triangles, cells, taken_back, turned;
} tally;

static void check_any(const bvx_mesh_view *view, tally *t)
{
    bvx_field_surface_report report;
    bvx_field_surface_options o = surface_options(1);
    bvx_mesh m;

    o.placing.interpolation = maker_below(&seed, 5);
    o.placing.face_rule = maker_below(&seed, 2);
    o.placing.position_type = maker_below(&seed, 2) ? BVX_F32 : BVX_F64;
    o.sharp_angle = 0.99 - 0.2 * maker_below(&seed, 5);
    o.report = &report;
    m = surface_of(ctx, view, &o);
    assert_certificate(&m);
    t->surfaces++;
    t->triangles += m.triangle_count;
    t->cells += report.sharp_cells;
    t->taken_back += report.sharp_taken_back;
    t->turned += report.flipped_edges;
    bvx_mesh_free(ctx, &m);
}

static void end_tally(const char *what, const tally *t)
{
    printf(
        "%s: %lu surfaces, %lu triangles, %lu sharp cells, %lu taken back, %lu turned edges: none crosses\n",
        what, (unsigned long)t->surfaces, (unsigned long)t->triangles, (unsigned long)t->cells,
        (unsigned long)t->taken_back, (unsigned long)t->turned);
    TEST_ASSERT_TRUE(t->cells > t->surfaces && t->taken_back > t->surfaces / 2 &&
                     t->turned > t->surfaces / 4);
}

static void test_noise_never_crosses(void)
{
    tally t = {0, 0, 0, 0, 0};

    for (int n = 0; n < trial_count(50, 500, 2000); n++) {
        bvx_lattice const l = random_lattice();
        field_maker_free(ctx, &field);
        field_maker_noise(ctx, &seed, &l, 2 + maker_below(&seed, 13), 12 + maker_below(&seed, 5),
                          1 + maker_below(&seed, 3), 0, maker_below(&seed, 2) ? BVX_F32 : BVX_F64, &field);
        check_any(NULL, &t);
    }
    end_tally("noise", &t);
}

/* Noise inside, but planes that come from the triangles of a soup. */
static void test_noise_with_triangles_never_crosses(void)
{
    double const low[3] = {1, 1, 1}, high[3] = {15, 15, 15};
    tally t = {0, 0, 0, 0, 0};

    for (int n = 0; n < trial_count(50, 500, 2000); n++) {
        bvx_lattice const l = random_lattice();
        bvx_mesh_view view;
        field_maker_free(ctx, &field);
        maker_clear(&mesh);
        maker_soup(&mesh, &seed, 1 + maker_below(&seed, 20), low, high, 16);
        view = maker_view(&mesh);
        field_maker_noise(ctx, &seed, &l, 2 + maker_below(&seed, 13), 14 + maker_below(&seed, 3), 1,
                          (uint32_t)mesh.triangles, BVX_F32, &field);
        check_any(&view, &t);
    }
    end_tally("noise with triangles", &t);
}

/* Fields of solids that are hardly larger than voxels. */
static void test_jagged_solids_never_cross(void)
{
    tally t = {0, 0, 0, 0, 0};

    for (int n = 0; n < trial_count(20, 150, 500); n++) {
        bvx_lattice const l = random_lattice();
        bvx_mesh_view view;
        field_maker_free(ctx, &field);
        maker_clear(&mesh);
        for (int k = 1 + maker_below(&seed, 3); k > 0; k--) {
            double centre[3], radius[3];
            for (int a = 0; a < 3; a++) {
                double const side = l.dims[a] * l.spacing[a];
                centre[a] = l.origin[a] + side * 0.01 * (double)(25 + maker_below(&seed, 51));
                radius[a] = side * 0.01 * (double)(15 + maker_below(&seed, 40));
            }
            if (maker_below(&seed, 3) == 0) {
                double box[2][3];
                for (int a = 0; a < 3; a++) {
                    box[0][a] = centre[a] - radius[a];
                    box[1][a] = centre[a] + radius[a];
                }
                maker_box(&mesh, box[0], box[1]);
            } else
                maker_star(&mesh, &seed, centre, radius, 0.6, 3 + maker_below(&seed, 3),
                           3 + maker_below(&seed, 4), 65536);
        }
        if (maker_below(&seed, 2)) maker_flip(&mesh, 0, mesh.triangles / 2);
        view = maker_view(&mesh);
        field_maker_measure(ctx, &mesh, &l, INFINITY, maker_below(&seed, 2) ? BVX_F32 : BVX_F64, &field);
        check_any(maker_below(&seed, 2) ? &view : NULL, &t);
    }
    end_tally("jagged solids", &t);
}

/* ---- the same everywhere ---- */

static void test_threads_and_code_paths_do_not_show(void)
{
    double const origin[3] = {2, 2, 2}, spacing[3] = {0.5, 0.25, 0.4};
    bvx_lattice const l = lattice_at(origin, spacing, 26, 52, 32);
    bvx_field_surface_options o = surface_options(1);
    bvx_mesh_view view;
    bvx_mesh first;

    turned_box(8.5, 8.51, 8.52, 4, 3, 3.5);
    view = maker_view(&mesh);
    field_maker_measure(ctx, &mesh, &l, 1.5, BVX_F32, &field);
    first = surface_of(ctx, &view, &o);
    for (int32_t threads = 1; threads <= 8; threads += 3)
        for (int32_t cpu = BVX_CPU_PORTABLE; cpu >= 0; cpu -= BVX_CPU_PORTABLE) {
            bvx_context *const other = suite_context(threads, cpu);
            bvx_mesh m = surface_of(other, &view, &o);
            assert_same_surface(&first, &m);
            bvx_mesh_free(other, &m);
            bvx_context_destroy(other);
        }
    bvx_mesh_free(ctx, &first);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_oracle_sees_crossings);
    RUN_TEST(test_sharp_meets_corners_and_edges_of_a_box);
    RUN_TEST(test_sharp_from_vectors_alone);
    RUN_TEST(test_sharp_leaves_a_smooth_surface_alone);
    RUN_TEST(test_noise_never_crosses);
    RUN_TEST(test_noise_with_triangles_never_crosses);
    RUN_TEST(test_jagged_solids_never_cross);
    RUN_TEST(test_threads_and_code_paths_do_not_show);
    return UNITY_END();
}
