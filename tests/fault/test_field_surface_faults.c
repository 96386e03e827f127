/* test_field_surface_faults.c - surfaces of fields, plain and sharp: every allocation
 * failing once, cancelled at every progress call, under every memory limit. After
 * each failure there is no mesh, nothing is held, and the same context does the work. */
#include "fault/context.h"
#include "tools/field_maker.h"

static maker_mesh box;
static bvx_mesh_view view;
static bvx_field field;
static bvx_grid changed;
static bvx_context *maker;
static uint64_t mark;   /* a hash of what the last good run made */
static int left_behind; /* a failed call left something in its result */

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
    assert_int_equal(bvx_grid_union(maker, &field.inside, &field.inside, &changed), BVX_OK);
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
    bvx_field_surface_options o;
    bvx_mesh m;
    bvx_status status;

    memset(&m, 0, sizeof m);
    bvx_field_surface_options_init(&o, sizeof o);
    o.sharp = sharp;
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

enum { SURFACES = 4 };
static fault_operation_fn *const surfaces[SURFACES] = {run_plain, run_sharp, run_sharp_by_vectors,
                                                       run_changed};

typedef struct trial {
    fault_operation_fn *run;
    uint64_t want;
} trial;

static bvx_status run_trial(void *user, bvx_context *ctx)
{
    const trial *const t = user;
    bvx_status const status = t->run(NULL, ctx);
    if (status == BVX_OK && mark != t->want) left_behind = 2;
    return status;
}

static trial trial_of(int i)
{
    trial t = {surfaces[i], 0};
    left_behind = 0;
    assert_int_equal(t.run(NULL, maker), BVX_OK);
    t.want = mark;
    return t;
}

static void assert_well(int i, const char *wrong)
{
    if (wrong != NULL) fail_msg("surface %d: %s", i, wrong);
    if (left_behind == 1) fail_msg("surface %d: a failed call left something in its mesh", i);
    if (left_behind != 0) fail_msg("surface %d: another mesh than usual", i);
}

static void test_every_allocation_of_a_field_surface_fails_once(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2)
        for (int i = 0; i < SURFACES; i++) {
            bvx_context_options o = default_options();
            trial t = trial_of(i);
            uint64_t allocations = 0;
            o.threads = threads;
            assert_well(i, fault_every_allocation(run_trial, &t, &o, &allocations));
            assert_true(allocations >= (i == 0 ? 7u : 13u));
        }
}

static void test_cancel_at_every_progress_call_of_a_field_surface(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2)
        for (int i = 0; i < SURFACES; i++) {
            bvx_context_options o = default_options();
            trial t = trial_of(i);
            uint64_t calls = 0;
            o.threads = threads;
            assert_well(i, fault_every_cancel(run_trial, &t, &o, &calls));
            assert_true(calls >= (i == 0 ? 3u : 7u));
        }
}

/* Limits from 1 byte to what the surface needs. */
static void test_every_memory_limit_of_a_field_surface(void **state)
{
    bvx_context_options o = default_options();
    (void)state;
    o.threads = 1;
    for (int i = 0; i < SURFACES; i++) {
        trial t = trial_of(i);
        assert_well(i, fault_every_limit(run_trial, &t, &o, 60));
    }
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
