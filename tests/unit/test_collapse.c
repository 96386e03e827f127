/* test_collapse.c - levels with collapsed edges: still closed manifolds of
 * the same shape, nearer at equal count. */
#include "../golden/shapes.h"

#include <stdlib.h>
#include "simplify/collapse_state.h"
#include "suite.h"

static shape source;

void setUp(void)
{
    suite_open(0);
}

void tearDown(void)
{
    suite_close();
}

static void solid_of_source(int32_t resolution, bvx_grid *solid)
{
    bvx_mesh_view view;
    bvx_lattice lattice;
    shape_view(&source, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, &view, resolution, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &lattice, NULL, solid));
}

static bvx_status level(const bvx_grid *solid, uint64_t target, double collapse, int32_t type, bvx_mesh *mesh)
{
    bvx_lod_options options = {.struct_size = sizeof options};
    options.target_triangles = &target;
    options.collapse = collapse;
    options.position_type = type;
    return bvx_build_lods(ctx, solid, &options, 1, mesh);
}

static bvx_certificate certify(const bvx_mesh *mesh)
{
    bvx_certificate c;
    bvx_mesh_view view;
    bvx_mesh_view_of(mesh, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
    return c;
}

static void simplify_to(const bvx_mesh *mesh, uint64_t target, bvx_mesh *fewer)
{
    bvx_simplify_options options = {.struct_size = sizeof options};
    bvx_mesh_view view;

    options.targets.triangles = &target;
    bvx_mesh_view_of(mesh, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(ctx, &view, &options, 1, fewer));
}

static double distance_to_source(const bvx_mesh *mesh)
{
    bvx_distance_report r;
    bvx_mesh_view a, b;
    bvx_mesh_view_of(mesh, &a);
    shape_view(&source, &b);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, &a, &b, 4000, 1, &r));
    return r.mean;
}

static void check_manifold(const bvx_certificate *c, int64_t euler, uint64_t components)
{
    TEST_ASSERT_TRUE(c->closed && c->edge_manifold && c->vertex_manifold && c->oriented);
    TEST_ASSERT_EQUAL_INT64(euler, c->euler);
    TEST_ASSERT_EQUAL_UINT64(components, c->components);
    TEST_ASSERT_EQUAL_UINT64(0, c->degenerate);
    TEST_ASSERT_EQUAL_UINT64(0, c->duplicates);
    TEST_ASSERT_EQUAL_UINT64(0, c->unused_vertices);
}

static void test_torus_keeps_its_handle_and_comes_nearer(void)
{
    static const uint64_t targets[] = {3000, 1000, 400};
    bvx_grid solid = {0};

    shape_torus(&source, 96, 40, 0.0, 1);
    solid_of_source(200, &solid);
    for (size_t t = 0; t < sizeof targets / sizeof targets[0]; t++) {
        bvx_mesh even = {0}, collapsed = {0};
        bvx_certificate c;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, level(&solid, targets[t], 0, BVX_F32, &even));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, level(&solid, targets[t], 3, BVX_F32, &collapsed));
        c = certify(&collapsed);
        check_manifold(&c, 0, 1);
        TEST_ASSERT_LESS_OR_EQUAL_UINT64(targets[t], collapsed.triangle_count);
        TEST_ASSERT_GREATER_THAN_UINT64(targets[t] - 3, collapsed.triangle_count); /* a collapse takes two */
        TEST_ASSERT_TRUE(distance_to_source(&collapsed) < 0.75 * distance_to_source(&even));
        bvx_mesh_free(ctx, &even);
        bvx_mesh_free(ctx, &collapsed);
    }
    bvx_grid_free(ctx, &solid);
}

static void test_collapse_keeps_noise_manifold(void)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {40, 37, 33};
    bvx_lattice lattice;
    uint64_t seed = 99;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    for (uint64_t every = 2; every < 12; every += 3) {
        bvx_grid noise = {0};
        bvx_mesh mesh = {0}, fewer = {0};
        bvx_certificate before, after;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, NULL, &noise));
        for (int32_t z = 0; z < dims[2]; z++)
            for (int32_t y = 0; y < dims[1]; y++)
                for (int32_t x = 0; x < dims[0]; x++)
                    bvx_grid_set(&noise, x, y, z, (shape_random(&seed) >> 33) % every == 0);
        bvx_extract_options options = {.struct_size = sizeof options};
        options.position_type = BVX_F64;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_surface(ctx, &noise, &options, &mesh));
        before = certify(&mesh);
        /* to nothing: goes on until no edge may go */
        simplify_to(&mesh, 4, &fewer);
        after = certify(&fewer);
        check_manifold(&after, before.euler, before.components);
        TEST_ASSERT_TRUE(after.triangles < before.triangles);
        bvx_mesh_free(ctx, &fewer);
        bvx_mesh_free(ctx, &mesh);
        bvx_grid_free(ctx, &noise);
    }
}

/* Faces of a block of voxels are flat but for the cut edges: nothing may be lost of its volume. */
static void test_flat_faces_cost_nothing(void)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {12, 11, 10};
    bvx_lattice lattice;
    bvx_grid block = {0};
    bvx_mesh mesh = {0}, fewer = {0};
    bvx_extract_options options = {.struct_size = sizeof options};
    bvx_certificate before, after;

    options.position_type = BVX_F64;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, NULL, &block));
    for (int32_t z = 2; z < 8; z++)
        for (int32_t y = 1; y < 9; y++)
            for (int32_t x = 1; x < 11; x++) bvx_grid_set(&block, x, y, z, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_surface(ctx, &block, &options, &mesh));
    before = certify(&mesh);
    simplify_to(&mesh, 120, &fewer);
    after = certify(&fewer);
    check_manifold(&after, 2, 1);
    TEST_ASSERT_LESS_OR_EQUAL_UINT64(120, after.triangles);
    TEST_ASSERT_DOUBLE_WITHIN(0.01 * before.volume, before.volume, after.volume);
    bvx_mesh_free(ctx, &fewer);
    bvx_mesh_free(ctx, &mesh);
    bvx_grid_free(ctx, &block);
}

static void test_open_mesh_is_refused(void)
{
    double positions[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    bvx_mesh_view const view = {
        .positions = positions, .vertex_count = 3, .triangle_count = 1, .position_type = BVX_F64};
    bvxi_sheets const sheets = {.view = view};
    bvxi_collapse_options const options = {.given.position_type = BVX_F64};
    bvxi_collapse *collapse = NULL;

    /* Within a call, whose end frees what a failure leaves behind. */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, BVXI_CALL(ctx, bvxi_collapse_open(ctx, "test", &view, &sheets,
                                                                                &options, &collapse)));
    TEST_ASSERT_NULL(collapse);
}

static void test_bad_options_are_named(void)
{
    bvx_grid solid = {0};
    bvx_mesh mesh = {0};
    bvx_lod_options options = {.struct_size = sizeof options};
    int32_t const resolution = 8;

    shape_ball(&source, 4);
    solid_of_source(16, &solid);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, level(&solid, 100, 0.5, BVX_F32, &mesh));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, level(&solid, 100, 65, BVX_F32, &mesh));
    options.resolutions = &resolution;
    options.collapse = 2;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_build_lods(ctx, &solid, &options, 1, &mesh));
    TEST_ASSERT_NULL(mesh.positions);
    bvx_grid_free(ctx, &solid);
}

/* Floats are rounded before an edge is judged, so that no rounding comes after the guarantee: other edges may
 * go, but the surfaces are as near to each other as to the ball. */
static void test_f64_and_f32_are_the_same_surface(void)
{
    bvx_grid solid = {0};
    bvx_mesh f32 = {0}, f64 = {0};
    bvx_distance_report r;
    bvx_certificate c32, c64;
    bvx_mesh_view a, b;

    shape_ball(&source, 12);
    solid_of_source(90, &solid);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, level(&solid, 900, 2, BVX_F32, &f32));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, level(&solid, 900, 2, BVX_F64, &f64));
    c32 = certify(&f32);
    c64 = certify(&f64);
    check_manifold(&c32, 2, 1);
    check_manifold(&c64, 2, 1);
    TEST_ASSERT_EQUAL_UINT64(f64.triangle_count, f32.triangle_count);

    bvx_mesh_view_of(&f32, &a);
    bvx_mesh_view_of(&f64, &b);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_distance(ctx, &a, &b, 4000, 1, &r));
    TEST_ASSERT_TRUE(r.mean < distance_to_source(&f32));
    TEST_ASSERT_DOUBLE_WITHIN(1e-3 * c64.volume, c64.volume, c32.volume);

    bvx_mesh_free(ctx, &f32);
    bvx_mesh_free(ctx, &f64);
    bvx_grid_free(ctx, &solid);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_torus_keeps_its_handle_and_comes_nearer);
    RUN_TEST(test_collapse_keeps_noise_manifold);
    RUN_TEST(test_flat_faces_cost_nothing);
    RUN_TEST(test_open_mesh_is_refused);
    RUN_TEST(test_bad_options_are_named);
    RUN_TEST(test_f64_and_f32_are_the_same_surface);
    return UNITY_END();
}
