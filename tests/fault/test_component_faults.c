/* test_component_faults.c - parts of grids and clouds of points with every allocation failing once, cancelled
 * at every progress call, and under every memory limit. */
#include "fault/rows.h"
#include "tools/mesh_maker.h"

enum { CLOUD = 900, TEXT = CLOUD * 12 };

static bvx_context *maker; /* what made the inputs */
static bvx_lattice lattice;
static bvx_grid noise;
static double cloud[CLOUD][3];
static bvx_mesh_view cloud_view;
static char text[TEXT];
static size_t text_size;

static int make_inputs(void **state)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {70, 14, 12};
    uint64_t seed = 31;
    bvx_context_options o = default_options();

    (void)state;
    o.threads = 1;
    maker = context_with(&o);
    assert_int_equal(bvx_lattice_make(maker, origin, spacing, dims, &lattice), BVX_OK);
    assert_int_equal(bvx_grid_create(maker, &lattice, NULL, &noise), BVX_OK);
    for (int32_t z = 0; z < 12; z++)
        for (int32_t y = 0; y < 14; y++)
            for (int32_t x = 0; x < 70; x++) bvx_grid_set(&noise, x, y, z, maker_below(&seed, 3) != 0);
    for (int i = 0; i < CLOUD; i++) {
        for (int a = 0; a < 3; a++) cloud[i][a] = maker_below(&seed, dims[a]);
        text_size += (size_t)snprintf(text + text_size, TEXT - text_size, "%d %d %d\n", (int)cloud[i][0],
                                      (int)cloud[i][1], (int)cloud[i][2]);
    }
    cloud_view.positions = cloud;
    cloud_view.position_type = BVX_F64;
    cloud_view.vertex_count = CLOUD;
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    bvx_grid_free(maker, &noise);
    assert_int_equal(bvx_memory_used(maker), 0);
    bvx_context_destroy(maker);
    return 0;
}

/* ---- Calls: each frees what it got, leaves its mark, and says on failure whether its results are empty - */

static bvx_status keep_grid(bvx_context *ctx, bvx_status status, bvx_grid *g)
{
    static const bvx_grid empty = {0};

    if (status != BVX_OK) {
        left_behind |= memcmp(g, &empty, sizeof *g) != 0;
        return status;
    }
    assert_int_equal(bvx_grid_hash(ctx, g, &mark), BVX_OK);
    bvx_grid_free(ctx, g);
    return BVX_OK;
}

static bvx_status list(void *user, bvx_context *ctx)
{
    static bvx_component parts[4096];
    uint64_t count = 0;
    bvx_status const status = bvx_grid_components(ctx, &noise, 6, parts, 4096, &count);
    (void)user;
    if (status == BVX_OK) mark = bvx_hash(parts, (size_t)count * sizeof *parts, count);
    return status;
}

static bvx_status label(void *user, bvx_context *ctx)
{
    static uint32_t labels[70 * 14 * 12];
    uint64_t count = 0;
    bvx_status const status = bvx_grid_label(ctx, &noise, 18, labels, 70 * 14 * 12, &count);
    (void)user;
    if (status == BVX_OK) mark = bvx_hash(labels, sizeof labels, count);
    return status;
}

static bvx_status keep(void *user, bvx_context *ctx)
{
    static const int32_t seeds[6] = {1, 2, 3, 60, 12, 11};
    bvx_keep_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};

    (void)user;
    o.largest = 3;
    o.seeds = seeds;
    o.seed_count = 2;
    return keep_grid(ctx, bvx_grid_keep(ctx, &noise, &o, &g), &g);
}

static bvx_status cavities(void *user, bvx_context *ctx)
{
    uint64_t filled = 0;
    bvx_grid g = {0};
    (void)user;
    return keep_grid(ctx, bvx_grid_fill_cavities(ctx, &noise, 6, 0, &g, &filled), &g);
}

static bvx_status topology(void *user, bvx_context *ctx)
{
    bvx_topology t;
    bvx_status const status = bvx_grid_topology(ctx, &noise, 26, &t);
    (void)user;
    if (status == BVX_OK) mark = bvx_hash(&t, sizeof t, 0);
    return status;
}

static bvx_status points(void *user, bvx_context *ctx)
{
    bvx_points_options o = {.struct_size = sizeof o};
    bvx_lattice_options fit = {.struct_size = sizeof fit};
    bvx_lattice l;
    bvx_grid g = {0};

    (void)user;
    fit.resolution = 30;
    assert_int_equal(bvx_lattice_fit_with(ctx, &cloud_view, &fit, &l), BVX_OK);
    o.minimum = 2;
    o.body = 1;
    o.close_gaps = 1;
    return keep_grid(ctx, bvx_voxelize_points(ctx, &cloud_view, &l, &o, &g), &g);
}

static bvx_status read(void *user, bvx_context *ctx)
{
    static const bvx_mesh empty = {0};
    bvx_mesh m = {0};
    bvx_status const status = bvx_read_points(ctx, text, text_size, BVX_FORMAT_XYZ, &m);

    (void)user;
    if (status != BVX_OK) {
        left_behind |= memcmp(&m, &empty, sizeof m) != 0;
        return status;
    }
    mark = bvx_hash(m.positions, (size_t)m.vertex_count * 24, 0);
    bvx_mesh_free(ctx, &m);
    return BVX_OK;
}

static fault_row calls[] = {
    {"components", list, 3, 1, 0},   {"label", label, 3, 1, 0},       {"keep", keep, 6, 1, 0},
    {"cavities", cavities, 6, 1, 0}, {"topology", topology, 6, 1, 0}, {"points", points, 6, 1, 0},
    {"read", read, 1, 1, 0},
};

/* ---- Tests ---- */

static void test_every_allocation_of_parts_fails_once(void **state)
{
    (void)state;
    fail_every_allocation(FAULT_ROWS(calls));
}

static void test_parts_cancel_at_every_progress_call(void **state)
{
    (void)state;
    cancel_at_every_call(FAULT_ROWS(calls));
}

static void test_parts_under_every_memory_limit(void **state)
{
    (void)state;
    limit_memory(FAULT_ROWS(calls), 40);
}

/* A grid kept or filled in place is as before when the call fails. */
static void test_a_failed_call_in_place_changes_nothing(void **state)
{
    uint64_t before = 0, after = 0;

    (void)state;
    assert_int_equal(bvx_grid_hash(maker, &noise, &before), BVX_OK);
    for (uint64_t fail_at = 1; fail_at <= 5; fail_at++)
        for (int which = 0; which < 2; which++) {
            fault_heap heap = {0};
            bvx_context_options const base = default_options();
            bvx_context_options o = fault_options(&base, &heap);
            bvx_keep_options keep_options = {.struct_size = sizeof keep_options};
            bvx_context *const ctx = context_with(&o);
            bvx_status status;
            keep_options.largest = 1;
            heap.fail_at = heap.asked + fail_at;
            if (which == 0) status = bvx_grid_keep(ctx, &noise, &keep_options, &noise);
            else status = bvx_grid_fill_cavities(ctx, &noise, 6, 0, &noise, NULL);
            assert_int_equal(status, BVX_ERR_MEMORY);
            bvx_context_destroy(ctx);
            assert_null(fault_end(&heap));
            assert_int_equal(bvx_grid_hash(maker, &noise, &after), BVX_OK);
            assert_true(before == after);
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_parts_fails_once),
        cmocka_unit_test(test_parts_cancel_at_every_progress_call),
        cmocka_unit_test(test_parts_under_every_memory_limit),
        cmocka_unit_test(test_a_failed_call_in_place_changes_nothing),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
