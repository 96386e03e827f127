/* test_field_surface_faults.c - surfaces of fields, plain and sharp: every allocation
 * failing once, cancelled at every progress call, under every memory limit. After
 * each failure there is no mesh, nothing is held, and the same context does the work. */
#include "fault/rows.h"
#include "tools/field_maker.h"

static maker_mesh box;
static bvx_mesh_view view;
static bvx_field field;
static bvx_grid changed;
static bvx_context *maker;

static int make_inputs(void **state)
{
    double const low[3] = {-5, -4, -3}, high[3] = {5, 4, 3}, origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t const dims[3] = {18, 18, 14};
    bvx_context_options o = default_options();
    bvx_lattice lattice;

    (void)state;
    o.threads = 1;
    maker = context_with(&o);
    maker_box(&box, low, high);
    for (size_t i = 0; i < box.vertices; i++) {
        double *const p = box.p + 3 * i;
        double const x = 0.8 * p[0] - 0.6 * p[1], y = 0.6 * p[0] + 0.8 * p[1];
        p[0] = x + 9.1;
        p[1] = y + 8.9;
        p[2] += 7.3;
    }
    view = maker_view(&box);
    assert_int_equal(bvx_lattice_make(maker, origin, spacing, dims, &lattice), BVX_OK);
    field_maker_measure(maker, &box, &lattice, 2.0, BVX_F32, &field);
    assert_int_equal(bvx_grid_create(maker, &lattice, NULL, &changed), BVX_OK);
    assert_int_equal(bvx_grid_combine(maker, &field.inside, &field.inside, BVX_BOOLEAN_UNION, &changed),
                     BVX_OK);
    for (int32_t x = 0; x < dims[0]; x++) bvx_grid_set(&changed, x, 9, 7, 0);
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    bvx_grid_free(maker, &changed);
    field_maker_free(maker, &field);
    bvx_context_destroy(maker);
    maker_free(&box);
    return 0;
}

static bvx_status make_surface(bvx_context *ctx, int32_t sharp, const bvx_mesh_view *mesh,
                               const bvx_grid *grid)
{
    bvx_field_surface_options o = {.struct_size = sizeof o};
    bvx_mesh m;
    bvx_status status;

    memset(&m, 0, sizeof m);
    o.placing.sharp = BVX_SHARP_NEVER + sharp;
    o.grid = grid;
    o.offset = grid != NULL ? -1.5 : 0.0;
    status = bvx_extract_field_surface(ctx, &field, mesh, &o, &m);
    if (status != BVX_OK) {
        left_behind |= m.positions != NULL || m.triangles != NULL || m.vertex_count != 0 ||
                       m.triangle_count != 0;
        return status;
    }
    assert_int_equal(bvx_mesh_hash(ctx, &m, &mark), BVX_OK);
    bvx_mesh_free(ctx, &m);
    return status;
}

static bvx_status run_plain(void *user, bvx_context *ctx)
{
    (void)user;
    return make_surface(ctx, 0, NULL, NULL);
}

static bvx_status run_sharp(void *user, bvx_context *ctx)
{
    (void)user;
    return make_surface(ctx, 1, &view, NULL);
}

static bvx_status run_sharp_by_vectors(void *user, bvx_context *ctx)
{
    (void)user;
    return make_surface(ctx, 1, NULL, NULL);
}

/* Sharp because the box is; of voxels that lack one row. */
static bvx_status run_changed(void *user, bvx_context *ctx)
{
    (void)user;
    return make_surface(ctx, -1, &view, &changed);
}

static fault_row surfaces[] = {
    {"plain", run_plain, 7, 3, 0},
    {"sharp", run_sharp, 13, 7, 0},
    {"sharp, by vectors", run_sharp_by_vectors, 13, 7, 0},
    {"changed", run_changed, 13, 7, 0},
};

static void test_every_allocation_of_a_field_surface_fails_once(void **state)
{
    (void)state;
    fail_every_allocation(FAULT_ROWS(surfaces));
}

static void test_cancel_at_every_progress_call_of_a_field_surface(void **state)
{
    (void)state;
    cancel_at_every_call(FAULT_ROWS(surfaces));
}

/* Limits from 1 byte to what the surface needs. */
static void test_every_memory_limit_of_a_field_surface(void **state)
{
    (void)state;
    limit_memory(FAULT_ROWS(surfaces), 60);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_a_field_surface_fails_once),
        cmocka_unit_test(test_cancel_at_every_progress_call_of_a_field_surface),
        cmocka_unit_test(test_every_memory_limit_of_a_field_surface),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
