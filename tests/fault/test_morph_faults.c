/* test_morph_faults.c - morphology and distances with every allocation failing once, cancelled at every
 * progress call, under every memory limit. */
#include "fault/rows.h"
#include "tools/mesh_maker.h"

static bvx_grid cubic, stretched;
static bvx_context *maker;

static void make_grid(double dz, bvx_grid *g)
{
    double const origin[3] = {0, 0, 0}, spacing[3] = {1, 1, dz};
    int32_t const dims[3] = {70, 14, 12};
    uint64_t seed = 5;
    bvx_lattice l;

    assert_int_equal(bvx_lattice_make(maker, origin, spacing, dims, &l), BVX_OK);
    assert_int_equal(bvx_grid_create(maker, &l, NULL, g), BVX_OK);
    for (int32_t z = 0; z < 12; z++)
        for (int32_t y = 0; y < 14; y++)
            for (int32_t x = 0; x < 70; x++) bvx_grid_set(g, x, y, z, maker_below(&seed, 60) != 0);
}

static int make_inputs(void **state)
{
    bvx_context_options o = default_options();
    (void)state;
    o.threads = 1;
    maker = context_with(&o);
    make_grid(1.0, &cubic);
    make_grid(1.5, &stretched);
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    bvx_grid_free(maker, &cubic);
    bvx_grid_free(maker, &stretched);
    assert_int_equal(bvx_memory_used(maker), 0);
    bvx_context_destroy(maker);
    return 0;
}

/* ---- Calls: each frees what it got and leaves its mark ---- */

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

static bvx_status close_by_steps(void *user, bvx_context *ctx)
{
    bvx_morph_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};
    (void)user;
    o.neighbourhood = 18;
    o.steps = 9;
    return keep_grid(ctx, bvx_grid_morph(ctx, &cubic, BVX_MORPH_CLOSE, &o, &g), &g);
}

static bvx_status dilate_by_steps(void *user, bvx_context *ctx)
{
    bvx_morph_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};
    (void)user;
    o.neighbourhood = 26;
    o.steps = 3;
    return keep_grid(ctx, bvx_grid_morph(ctx, &stretched, BVX_MORPH_DILATE, &o, &g), &g);
}

static bvx_status open_by_steps(void *user, bvx_context *ctx)
{
    bvx_morph_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};
    (void)user;
    o.steps = 17;
    return keep_grid(ctx, bvx_grid_morph(ctx, &cubic, BVX_MORPH_OPEN, &o, &g), &g);
}

static bvx_status open_by_a_ball(void *user, bvx_context *ctx)
{
    bvx_morph_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};

    (void)user;
    o.neighbourhood = BVX_BALL;
    o.radius = 2.5;
    o.beyond = 1;
    return keep_grid(ctx, bvx_grid_morph(ctx, &stretched, BVX_MORPH_OPEN, &o, &g), &g);
}

static bvx_status erode_by_a_large_ball(void *user, bvx_context *ctx)
{
    bvx_morph_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};
    (void)user;
    o.neighbourhood = BVX_BALL;
    o.radius = 60.0;
    return keep_grid(ctx, bvx_grid_morph(ctx, &cubic, BVX_MORPH_ERODE, &o, &g), &g);
}

static bvx_status hollow(void *user, bvx_context *ctx)
{
    static const bvx_hollow_report untouched = {0, 0, {0, 0, 0}, {0}};
    bvx_hollow_report report = untouched;
    bvx_hollow_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};
    bvx_status status;

    (void)user;
    o.thickness = 1.0;
    o.drain_radius = 1.5;
    o.report = &report;
    status = bvx_grid_hollow(ctx, &cubic, &o, &g);
    left_behind |= status != BVX_OK && memcmp(&report, &untouched, sizeof report) != 0;
    return keep_grid(ctx, status, &g);
}

static bvx_status measure(bvx_context *ctx, const bvx_grid *g, int32_t side)
{
    enum { VOXELS = 70 * 14 * 12 };
    static float values[VOXELS];
    static uint64_t nearest[VOXELS];
    bvx_distance_options o = {.struct_size = sizeof o};
    bvx_status status;
    o.side = side;
    o.nearest = nearest;
    status = bvx_grid_distance(ctx, g, &o, BVX_F32, values, VOXELS);
    if (status == BVX_OK) mark = bvx_hash(values, sizeof values, bvx_hash(nearest, sizeof nearest, 0));
    return status;
}

static bvx_status distances(void *user, bvx_context *ctx)
{
    (void)user;
    return measure(ctx, &cubic, BVX_DISTANCE_INSIDE);
}

static bvx_status stretched_distances(void *user, bvx_context *ctx)
{
    (void)user;
    return measure(ctx, &stretched, BVX_DISTANCE_SIGNED);
}

static bvx_status squares(void *user, bvx_context *ctx)
{
    enum { VOXELS = 70 * 14 * 12 };
    static uint32_t made[VOXELS];
    bvx_status status;
    (void)user;
    status = bvx_grid_distance(ctx, &cubic, NULL, BVX_SQUARES, made, VOXELS);
    if (status == BVX_OK) mark = bvx_hash(made, sizeof made, 0);
    return status;
}

static fault_row kinds[] = {
    {"close", close_by_steps, 4, 1, 0},
    {"open", open_by_steps, 4, 1, 0},
    {"ball", open_by_a_ball, 4, 1, 0},
    {"large", erode_by_a_large_ball, 4, 1, 0},
    {"hollow", hollow, 4, 1, 0},
    {"distance", distances, 4, 1, 0},
    {"stretched", stretched_distances, 4, 1, 0},
    {"squares", squares, 4, 1, 0},
    {"dilate", dilate_by_steps, 4, 1, 0},
};

/* ---- Tests ---- */

static void test_every_allocation_fails_once(void **state)
{
    (void)state;
    fail_every_allocation(FAULT_ROWS(kinds));
}

static void test_cancel_at_every_progress_call(void **state)
{
    (void)state;
    cancel_at_every_call(FAULT_ROWS(kinds));
}

static void test_under_every_memory_limit(void **state)
{
    (void)state;
    limit_memory(FAULT_ROWS(kinds), 40);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_fails_once),
        cmocka_unit_test(test_cancel_at_every_progress_call),
        cmocka_unit_test(test_under_every_memory_limit),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
