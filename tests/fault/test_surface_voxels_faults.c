/* test_surface_voxels_faults.c - surface voxels, their attached triangles
 * and voxel faces with every allocation failing once, cancelled at every
 * progress call, under every memory limit and in arenas of every size. */
#include "fault/context.h"
#include "tools/mesh_maker.h"

static maker_mesh star;
static bvx_mesh_view star_view;
static bvx_lattice lattice;
static bvx_grid solid;     /* what faces are made of */
static bvx_context *maker; /* what made them */

static int make_inputs(void **state)
{
    static const double centre[3] = {17, 16, 15}, radius[3] = {14, 13, 12};
    uint64_t seed = 82;
    bvx_context_options o = default_options();

    (void)state;
    o.threads = 1;
    maker = context_with(&o);
    maker_star(&star, &seed, centre, radius, 0.3, 60, 80, 65536);
    star_view = maker_view(&star);
    assert_int_equal(bvx_lattice_fit(maker, &star_view, 70, &lattice), BVX_OK);
    assert_int_equal(bvx_voxelize_solid(maker, &star_view, &lattice, NULL, &solid), BVX_OK);
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    bvx_grid_free(maker, &solid);
    assert_int_equal(bvx_memory_used(maker), 0);
    bvx_context_destroy(maker);
    maker_free(&star);
    return 0;
}

/* ---- Calls: each frees what it got, leaves its mark, and says on failure whether its results are empty - */

static uint64_t mark;   /* a hash of what the last good run made */
static int left_behind; /* a failed call left something in a result */

static bvx_status surface(bvx_context *ctx, int32_t mode, int attach)
{
    static const bvx_surface_report untouched = {5, 5, 5, {5, 5, 5, 5}};
    bvx_surface_report report = untouched;
    bvx_attached attached = {0};
    bvx_surface_options o;
    bvx_grid grid = {0};
    bvx_status status;

    bvx_surface_options_init(&o, sizeof o);
    o.mode = mode;
    o.report = &report;
    o.attached = attach ? &attached : NULL;
    status = bvx_voxelize_surface(ctx, &star_view, &lattice, &o, &grid);
    if (status != BVX_OK) {
        left_behind |= grid.words != NULL || attached.offsets != NULL || attached.triangles != NULL;
        left_behind |= memcmp(&report, &untouched, sizeof report) != 0;
        return status;
    }
    assert_int_equal(bvx_grid_hash(ctx, &grid, &mark), BVX_OK);
    if (attach)
        mark = bvx_hash(attached.triangles, attached.triangle_count * 4,
                        bvx_hash(attached.offsets, (attached.voxel_count + 1) * 8, mark));
    bvx_attached_free(ctx, &attached);
    bvx_grid_free(ctx, &grid);
    return status;
}

static bvx_status conservative(void *user, bvx_context *ctx)
{
    (void)user;
    return surface(ctx, BVX_SURFACE_CONSERVATIVE, 0);
}

static bvx_status conservative_attached(void *user, bvx_context *ctx)
{
    (void)user;
    return surface(ctx, BVX_SURFACE_CONSERVATIVE, 1);
}

static bvx_status thin_attached(void *user, bvx_context *ctx)
{
    (void)user;
    return surface(ctx, BVX_SURFACE_THIN, 1);
}

static bvx_status sampled_attached(void *user, bvx_context *ctx)
{
    (void)user;
    return surface(ctx, BVX_SURFACE_SAMPLED, 1);
}

static bvx_status faces_of(bvx_context *ctx, int32_t merged)
{
    bvx_faces_options o;
    bvx_mesh mesh = {0};
    bvx_status status;

    bvx_faces_options_init(&o, sizeof o);
    o.merged = merged;
    uint64_t vertices = 0, triangles = 0;
    status = bvx_faces_count(ctx, &solid, &o, &vertices, &triangles);
    if (status == BVX_OK) status = bvx_extract_faces(ctx, &solid, &o, &mesh);
    if (status == BVX_OK) assert_true(mesh.vertex_count == vertices && mesh.triangle_count == triangles);
    if (status != BVX_OK) {
        left_behind |= mesh.positions != NULL || mesh.vertex_count != 0 || mesh.triangle_count != 0;
        return status;
    }
    assert_int_equal(bvx_mesh_hash(ctx, &mesh, &mark), BVX_OK);
    bvx_mesh_free(ctx, &mesh);
    return status;
}

static bvx_status faces(void *user, bvx_context *ctx)
{
    (void)user;
    return faces_of(ctx, 0);
}

static bvx_status faces_merged(void *user, bvx_context *ctx)
{
    (void)user;
    return faces_of(ctx, 1);
}

typedef struct surface_call {
    const char *name;
    fault_operation_fn *run;
    uint64_t want; /* the mark of a good run */
} surface_call;

static surface_call calls[] = {
    {"conservative", conservative, 0},
    {"conservative, attached", conservative_attached, 0},
    {"thin, attached", thin_attached, 0},
    {"sampled, attached", sampled_attached, 0},
    {"faces", faces, 0},
    {"faces, merged", faces_merged, 0},
};
enum { CALLS = sizeof calls / sizeof calls[0] };

/* A good run always makes the same. */
static bvx_status run_call(void *user, bvx_context *ctx)
{
    const surface_call *const c = user;
    bvx_status const status = c->run(NULL, ctx);
    if (status == BVX_OK && mark != c->want) left_behind = 2;
    return status;
}

static surface_call *take_call(int i)
{
    left_behind = 0;
    assert_int_equal(calls[i].run(NULL, maker), BVX_OK);
    calls[i].want = mark;
    return &calls[i];
}

static void assert_well(const surface_call *c, const char *wrong)
{
    if (wrong != NULL) fail_msg("%s: %s", c->name, wrong);
    if (left_behind == 1) fail_msg("%s: a failed call left something in its result", c->name);
    if (left_behind == 2) fail_msg("%s: another result than usual", c->name);
}

/* ---- Tests ---- */

static void test_every_allocation_fails_once(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2) {
        bvx_context_options o = default_options();
        o.threads = threads;
        for (int i = 0; i < CALLS; i++) {
            surface_call *const c = take_call(i);
            uint64_t allocations = 0;
            assert_well(c, fault_every_allocation(run_call, c, &o, &allocations));
            assert_true(allocations > 1);
        }
    }
}

static void test_cancel_at_every_progress_call(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2) {
        bvx_context_options o = default_options();
        o.threads = threads;
        for (int i = 0; i < CALLS; i++) {
            surface_call *const c = take_call(i);
            uint64_t progress_calls = 0;
            assert_well(c, fault_every_cancel(run_call, c, &o, &progress_calls));
            assert_true(progress_calls > 0);
        }
    }
}

static void test_under_every_memory_limit(void **state)
{
    bvx_context_options o = default_options();
    (void)state;
    o.threads = 1;
    for (int i = 0; i < CALLS; i++) {
        surface_call *const c = take_call(i);
        assert_well(c, fault_every_limit(run_call, c, &o, 40));
    }
}

static void test_in_an_arena(void **state)
{
    bvx_context_options o = default_options();
    (void)state;
    o.threads = 1;
    for (int i = 0; i < CALLS; i++) {
        surface_call *const c = take_call(i);
        assert_well(c, fault_every_arena(run_call, c, &o, 1 << 23, 30));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_fails_once),
        cmocka_unit_test(test_cancel_at_every_progress_call),
        cmocka_unit_test(test_under_every_memory_limit),
        cmocka_unit_test(test_in_an_arena),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
