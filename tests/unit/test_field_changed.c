/* test_field_changed.c - surfaces of voxels that were changed after a field was measured: the field's where
 * they are its own, at a distance from the mesh or in the middle elsewhere. */
#include "unit/field_surface_support.h"

#include <math.h>

static const double box_low[3] = {3.4, 4.15, 5.45}, box_high[3] = {14.85, 13.25, 12.6};

/* Signed distance to the box. */
static double box_distance(const double p[3])
{
    double outside = 0.0, inside = -1e300;

    for (int a = 0; a < 3; a++) {
        double const d = fmax(box_low[a] - p[a], p[a] - box_high[a]);
        outside += d > 0.0 ? d * d : 0.0;
        inside = fmax(inside, d);
    }
    return outside > 0.0 ? sqrt(outside) : inside;
}

/* The box, measured: all centres have a value. */
static bvx_mesh_view measure_box(void)
{
    double const origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    bvx_lattice const l = lattice_at(origin, spacing, 20, 19, 18);
    bvx_field_options o = {.struct_size = sizeof o};
    bvx_mesh_view view;

    maker_box(&mesh, box_low, box_high);
    view = maker_view(&mesh);
    o.half_width = INFINITY;
    o.value_type = BVX_F64;
    o.features = 1;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_measure_field(ctx, &view, &l, &o, &field),
                                    bvx_last_message(ctx));
    return view;
}

/* The voxels whose distance is below a level and, with a floor, not below that. */
static bvx_grid voxels_between(double least, double level)
{
    bvx_grid g = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &field.inside.lattice, NULL, &g));
    for (int32_t z = 0; z < g.size[2]; z++)
        for (int32_t y = 0; y < g.size[1]; y++)
            for (int32_t x = 0; x < g.size[0]; x++) {
                double const p[3] = {x + 0.5, y + 0.5, z + 0.5}, d = box_distance(p);
                bvx_grid_set(&g, x, y, z, d >= least && d < level);
            }
    return g;
}

static bvx_mesh changed_surface(const bvx_grid *g, double offset, bvx_field_surface_report *report)
{
    bvx_field_surface_options o = {.struct_size = sizeof o};
    bvx_mesh m = {0};

    o.placing.position_type = BVX_F64;
    o.grid = g;
    o.offset = offset;
    o.report = report;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_extract_field_surface(ctx, &field, NULL, &o, &m),
                                    bvx_last_message(ctx));
    assert_certificate(&m);
    return m;
}

/* How many vertices lie at a distance from the box, within a tolerance. */
static uint64_t count_at(const bvx_mesh *m, double distance, double tolerance)
{
    uint64_t count = 0;

    for (uint64_t n = 0; n < m->vertex_count; n++)
        count += fabs(box_distance((const double *)m->positions + 3 * n) - distance) <= tolerance;
    return count;
}

static void test_a_body_that_was_not_changed_has_the_same_surface(void)
{
    bvx_field_surface_options o;
    bvx_field_surface_report plain, changed;
    bvx_mesh_view const view = measure_box();

    for (int32_t sharp = 0; sharp < 2; sharp++) {
        bvx_mesh a = {0}, b = {0};
        o = (bvx_field_surface_options){.struct_size = sizeof o};
        o.placing.sharp = BVX_SHARP_NEVER + sharp;
        o.report = &plain;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_field_surface(ctx, &field, &view, &o, &a));
        o.grid = &field.inside;
        o.offset = -2.0;
        o.report = &changed;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_field_surface(ctx, &field, &view, &o, &b));
        assert_same_surface(&a, &b);
        TEST_ASSERT_EQUAL_INT(0, memcmp(&plain, &changed, sizeof plain));
        TEST_ASSERT_EQUAL_UINT64(0, changed.own);
        bvx_mesh_free(ctx, &a);
        bvx_mesh_free(ctx, &b);
    }
    bvx_field_free(ctx, &field);
}

/* Half of the box is taken away: the cut is half way between centres, all else on the box. */
static void test_what_was_cut_off_ends_in_the_middle(void)
{
    bvx_field_surface_report report;
    bvx_grid g;
    bvx_mesh m;
    uint64_t middles = 0;

    measure_box();
    g = voxels_between(-1e9, 0.0);
    for (int32_t z = 0; z < g.size[2]; z++)
        for (int32_t y = 0; y < g.size[1]; y++)
            for (int32_t x = 8; x < g.size[0]; x++) bvx_grid_set(&g, x, y, z, 0);
    m = changed_surface(&g, 0.0, &report);

    for (uint64_t n = 0; n < m.vertex_count; n++) {
        const double *const p = (const double *)m.positions + 3 * n;
        if (p[0] == 8.0) middles++;
        else TEST_ASSERT_DOUBLE_WITHIN(1e-6, 0.0, box_distance(p));
    }
    TEST_ASSERT_EQUAL_UINT64(9 * 8, middles); /* centres of the box on the plane, y times z */
    TEST_ASSERT_EQUAL_UINT64(middles, report.own);
    TEST_ASSERT_EQUAL_UINT64(middles, report.middle);
    bvx_mesh_free(ctx, &m);
    bvx_grid_free(ctx, &g);
    bvx_field_free(ctx, &field);
}

/* A shell: two surfaces, the inner one at the thickness; without the offset it is stairs. */
static void test_a_hollow_body_has_an_even_wall(void)
{
    bvx_field_surface_report report;
    bvx_grid g;
    bvx_mesh m;
    uint64_t outer, inner;

    measure_box();
    g = voxels_between(-1.7, 0.0);
    m = changed_surface(&g, -1.7, &report);
    outer = count_at(&m, 0.0, 1e-6);
    inner = count_at(&m, -1.7, 1e-6);
    TEST_ASSERT_EQUAL_UINT64(m.vertex_count, outer + inner);
    TEST_ASSERT_EQUAL_UINT64(inner, report.own);
    TEST_ASSERT_TRUE(inner > 100 && outer > inner);
    bvx_mesh_free(ctx, &m);

    m = changed_surface(&g, 0.0, &report);
    TEST_ASSERT_EQUAL_UINT64(outer, count_at(&m, 0.0, 1e-6));
    TEST_ASSERT_EQUAL_UINT64(0, count_at(&m, -1.7, 1e-6));
    bvx_mesh_free(ctx, &m);
    bvx_grid_free(ctx, &g);
    bvx_field_free(ctx, &field);
}

/* A body that grew is round at the box's edges, where planes of the two ends meet; one that shrank is a box. */
static void test_bodies_grow_and_shrink_by_a_distance(void)
{
    bvx_grid g;
    bvx_mesh m;

    measure_box();
    g = voxels_between(-1e9, 2.4);
    m = changed_surface(&g, 2.4, NULL);
    TEST_ASSERT_EQUAL_UINT64(m.vertex_count, count_at(&m, 2.4, 0.06));
    TEST_ASSERT_TRUE(count_at(&m, 2.4, 1e-6) > m.vertex_count / 4);
    bvx_mesh_free(ctx, &m);
    bvx_grid_free(ctx, &g);

    g = voxels_between(-1e9, -0.8);
    m = changed_surface(&g, -0.8, NULL);
    TEST_ASSERT_EQUAL_UINT64(m.vertex_count, count_at(&m, -0.8, 1e-6));
    bvx_mesh_free(ctx, &m);
    bvx_grid_free(ctx, &g);
    bvx_field_free(ctx, &field);
}

/* An offset on the other side of the body, or one that no edge passes, moves nothing. */
static void test_an_offset_elsewhere_moves_nothing(void)
{
    bvx_field_surface_report report;
    bvx_grid g;

    measure_box();
    g = voxels_between(-1.7, 0.0);
    for (int i = 0; i < 2; i++) {
        bvx_mesh m = changed_surface(&g, i == 0 ? 1.7 : -7.5, &report);
        TEST_ASSERT_EQUAL_UINT64(0, count_at(&m, -1.7, 1e-6));
        TEST_ASSERT_EQUAL_UINT64(report.own, report.middle);
        bvx_mesh_free(ctx, &m);
    }
    bvx_grid_free(ctx, &g);
    bvx_field_free(ctx, &field);
}

static void test_sharp_is_chosen_by_the_mesh(void)
{
    bvx_field_surface_options o;
    bvx_field_surface_report report;
    bvx_mesh_view view = measure_box();

    for (int32_t asked = -1; asked < 2; asked++) {
        bvx_mesh m = {0};
        o = (bvx_field_surface_options){.struct_size = sizeof o};
        o.placing.sharp = BVX_SHARP_NEVER + asked;
        o.report = &report;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_field_surface(ctx, &field, &view, &o, &m));
        TEST_ASSERT_EQUAL_UINT64(asked != 0, report.sharp);
        TEST_ASSERT_EQUAL(asked != 0, report.sharp_cells != 0);
        bvx_mesh_free(ctx, &m);
    }
    bvx_field_free(ctx, &field);
}

static void refuse(bvx_status status, const bvx_mesh_view *view, const bvx_field_surface_options *o,
                   const char *part)
{
    bvx_mesh m = {0};

    TEST_ASSERT_EQUAL_INT32(status, bvx_extract_field_surface(ctx, &field, view, o, &m));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), part), bvx_last_message(ctx));
    TEST_ASSERT_NULL(m.positions);
}

static void test_grids_that_do_not_fit_are_refused(void)
{
    bvx_field_surface_options o, bad;
    bvx_mesh_view const view = measure_box();
    bvx_grid g = voxels_between(-1e9, 0.0), other = g;

    o = (bvx_field_surface_options){.struct_size = sizeof o};
    o.grid = &other;
    other.lattice.spacing[1] = 2.0, refuse(BVX_ERR_LATTICE, &view, &o, "grid"), other = g;
    other.low[0] = 1, other.size[0]--, refuse(BVX_ERR_LATTICE, &view, &o, "grid"), other = g;
    other.words = NULL, refuse(BVX_ERR_ARGUMENT, &view, &o, "words"), other = g;
    bad = o, bad.offset = NAN, refuse(BVX_ERR_ARGUMENT, &view, &bad, "offset");
    bad = o, bad.offset = INFINITY, refuse(BVX_ERR_ARGUMENT, &view, &bad, "offset");
    bad = o, bad.grid = NULL, bad.offset = 1.0, refuse(BVX_ERR_ARGUMENT, &view, &bad, "offset");
    bad = o, bad.placing.sharp = 3, refuse(BVX_ERR_ARGUMENT, &view, &bad, "sharp");
    bad = o, bad.placing.sharp = -1, refuse(BVX_ERR_ARGUMENT, &view, &bad, "sharp");
    bvx_grid_free(ctx, &g);
    bvx_field_free(ctx, &field);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_body_that_was_not_changed_has_the_same_surface);
    RUN_TEST(test_what_was_cut_off_ends_in_the_middle);
    RUN_TEST(test_a_hollow_body_has_an_even_wall);
    RUN_TEST(test_bodies_grow_and_shrink_by_a_distance);
    RUN_TEST(test_an_offset_elsewhere_moves_nothing);
    RUN_TEST(test_sharp_is_chosen_by_the_mesh);
    RUN_TEST(test_grids_that_do_not_fit_are_refused);
    return UNITY_END();
}
