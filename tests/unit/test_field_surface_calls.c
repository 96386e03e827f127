/* test_field_surface_calls.c - bvx_extract_field_surface as it is called:
 * arrays of the caller's, every refusal, nothing inside. */
#include "unit/field_surface_support.h"

static void test_arrays_of_the_callers_are_filled(void)
{
    double const origin[3] = {2, 2, 2}, spacing[3] = {1, 1, 1};
    bvx_lattice const l = lattice_at(origin, spacing, 8, 8, 8);

    for (int32_t sharp = 0; sharp < 2; sharp++) {
        bvx_field_surface_options o = surface_options(sharp);
        bvx_mesh made, given = {0};
        float p[3 * 4000];
        uint32_t t[3 * 6000];
        field_maker_free(ctx, &field);
        field_maker_noise(ctx, &seed, &l, 8, 15, 1, 0, BVX_F32, &field);
        made = surface_of(ctx, NULL, &o);
        given.positions = p;
        given.triangles = t;
        given.position_type = BVX_F32;
        given.vertex_capacity = made.vertex_count;
        given.triangle_capacity = made.triangle_count;
        TEST_ASSERT_TRUE(made.vertex_count <= 4000 && made.triangle_count <= 6000);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_field_surface(ctx, &field, NULL, &o, &given));
        assert_same_surface(&made, &given);
        given.vertex_count = given.triangle_count = 0;
        given.triangle_capacity--;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_extract_field_surface(ctx, &field, NULL, &o, &given));
        bvx_mesh_free(ctx, &made);
    }
}

/* ---- refusals ---- */

static void assert_refused(bvx_status status, const bvx_mesh_view *of, const bvx_field_surface_options *o,
                           const char *part)
{
    bvx_mesh m = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(status, bvx_extract_field_surface(ctx, &field, of, o, &m), part);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), part), bvx_last_message(ctx));
    TEST_ASSERT_NULL(m.positions);
}

static void test_wrong_options_are_refused(void)
{
    double const origin[3] = {2, 2, 2}, spacing[3] = {1, 1, 1};
    bvx_lattice const l = lattice_at(origin, spacing, 4, 4, 4);
    bvx_field_surface_options o = surface_options(0), bad;
    bvx_mesh m = {0};

    field_maker_noise(ctx, &seed, &l, 8, 15, 1, 0, BVX_F32, &field);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_field_surface(NULL, &field, NULL, &o, &m));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_field_surface(ctx, NULL, NULL, &o, &m));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_field_surface(ctx, &field, NULL, &o, NULL));
    bad = o, bad.placing.interpolation = 5, assert_refused(BVX_ERR_ARGUMENT, NULL, &bad, "interpolation");
    bad = o, bad.placing.interpolation = -1, assert_refused(BVX_ERR_ARGUMENT, NULL, &bad, "interpolation");
    bad = o, bad.placing.face_rule = 2, assert_refused(BVX_ERR_ARGUMENT, NULL, &bad, "face_rule");
    bad = o, bad.placing.position_type = 3, assert_refused(BVX_ERR_ARGUMENT, NULL, &bad, "position_type");
    bad = o, bad.placing.local_frame = 2, assert_refused(BVX_ERR_ARGUMENT, NULL, &bad, "local_frame");
    bad = o, bad.placing.sharp = -1, assert_refused(BVX_ERR_ARGUMENT, NULL, &bad, "sharp");
    bad = o, bad.placing.reserved = 1, assert_refused(BVX_ERR_ARGUMENT, NULL, &bad, "reserved");
    bad = o, bad.sharp_angle = 1.5, assert_refused(BVX_ERR_ARGUMENT, NULL, &bad, "sharp_angle");
    bad = o, bad.sharp_angle = NAN, assert_refused(BVX_ERR_ARGUMENT, NULL, &bad, "sharp_angle");
}

static void test_wrong_fields_are_refused(void)
{
    double const origin[3] = {2, 2, 2};
    double const far[3] = {1e9, 2, 2};
    double const beyond[3] = {1e15, 2, 2};
    double const spacing[3] = {1, 1, 1};
    bvx_lattice const l = lattice_at(origin, spacing, 4, 5, 6);
    bvx_field_surface_options const o = surface_options(0);
    bvx_field_surface_options scalar = o, sharp = o, doubles = o, floats = o;
    bvx_field good;
    bvx_mesh_view view;
    double const low[3] = {3, 3, 3}, high[3] = {5, 5, 5};

    scalar.placing.interpolation = BVX_EDGE_SCALAR;
    sharp.placing.sharp = BVX_SHARP_ALWAYS;
    doubles.placing.position_type = BVX_F64;
    maker_box(&mesh, low, high);
    view = maker_view(&mesh);
    field_maker_noise(ctx, &seed, &l, 8, 15, 1, 12, BVX_F32, &field);
    good = field;
    field.sign = BVX_FILL_NONE, assert_refused(BVX_ERR_ARGUMENT, NULL, &o, "inside"), field = good;
    field.inside.words = NULL, assert_refused(BVX_ERR_ARGUMENT, NULL, &o, "inside"), field = good;
    field.band.words = NULL, assert_refused(BVX_ERR_ARGUMENT, NULL, &o, "words"), field = good;
    field.value_type = 0, assert_refused(BVX_ERR_ARGUMENT, NULL, &o, "value_type"), field = good;
    field.reserved[3] = 1, assert_refused(BVX_ERR_ARGUMENT, NULL, &o, "reserved"), field = good;
    field.row_values = NULL, assert_refused(BVX_ERR_ARGUMENT, NULL, &o, "row_values"), field = good;
    field.inside.words[7] |= 16, assert_refused(BVX_ERR_ARGUMENT, NULL, &o, "past the 4 voxels"),
        field.inside.words[7] &= 15;
    field.value_count++, assert_refused(BVX_ERR_ARGUMENT, NULL, &o, "values"), field = good;
    field.row_values[3]++, assert_refused(BVX_ERR_ARGUMENT, NULL, &o, "row_values[3]"), field.row_values[3]--;
    field.vectors = NULL, assert_refused(BVX_ERR_ARGUMENT, NULL, &o, "vectors"), field = good;
    field.distances = field.vectors = NULL, assert_refused(BVX_ERR_ARGUMENT, NULL, &scalar, "distances"),
    field = good;
    field.inside.lattice.spacing[1] = 2, assert_refused(BVX_ERR_LATTICE, NULL, &o, "lattices"), field = good;
    field.triangles[2] = 12, assert_refused(BVX_ERR_RANGE, &view, &sharp, "triangles[2]"),
    field.triangles[2] = 0;
    mesh.t[4] = 99, assert_refused(BVX_ERR_RANGE, &view, &sharp, "triangle 1"), mesh.t[4] = 0;
    view.position_type = 7, assert_refused(BVX_ERR_ARGUMENT, &view, &sharp, "position_type");
    memcpy(field.inside.lattice.origin, far, sizeof far), memcpy(field.band.lattice.origin, far, sizeof far);
    floats.placing.position_type = BVX_F32, assert_refused(BVX_ERR_RANGE, NULL, &floats, "f32");
    memcpy(field.inside.lattice.origin, beyond, sizeof far),
        memcpy(field.band.lattice.origin, beyond, sizeof far);
    assert_refused(BVX_ERR_RANGE, NULL, &doubles, "doubles");
    field = good;
    { /* what is not needed may be missing */
        bvx_mesh m = {0};
        bvx_field_surface_options middle = o;
        middle.placing.interpolation = BVX_EDGE_MIDDLE;
        field.vectors = NULL;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_field_surface(ctx, &field, NULL, &scalar, &m));
        bvx_mesh_free(ctx, &m);
        field.distances = NULL;
        field.row_values = NULL;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_field_surface(ctx, &field, NULL, &middle, &m));
        bvx_mesh_free(ctx, &m);
        field = good;
        field.distances = NULL;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_field_surface(ctx, &field, NULL, &scalar, &m));
        bvx_mesh_free(ctx, &m);
        field = good;
    }
}

static void test_an_empty_inside_gives_an_empty_mesh(void)
{
    double const origin[3] = {2, 2, 2}, spacing[3] = {1, 1, 1};
    bvx_lattice const l = lattice_at(origin, spacing, 4, 5, 6);

    for (int32_t sharp = 0; sharp < 2; sharp++) {
        bvx_field_surface_options const o = surface_options(sharp);
        bvx_mesh m;
        field_maker_free(ctx, &field);
        field_maker_noise(ctx, &seed, &l, 0, 15, 1, 0, BVX_F32, &field);
        m = surface_of(ctx, NULL, &o);
        TEST_ASSERT_EQUAL_UINT64(0, m.vertex_count + m.triangle_count);
        bvx_mesh_free(ctx, &m);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_arrays_of_the_callers_are_filled);
    RUN_TEST(test_wrong_options_are_refused);
    RUN_TEST(test_wrong_fields_are_refused);
    RUN_TEST(test_an_empty_inside_gives_an_empty_mesh);
    return UNITY_END();
}
