/* test_repair_faults.c - repair with every allocation failing once,
 * cancelled at every progress call, under memory limits and in arenas. */
#include "fault/context.h"
#include "tools/mesh_maker.h"

static maker_mesh spoilt; /* holes, flipped and doubled triangles, a sheet, thin walls */
static bvx_mesh_view spoilt_view;
static uint64_t want;   /* hash of a good run's mesh */
static int left_behind; /* a failed call left something, or a good one another result */

static bvx_status repair_once(void *user, bvx_context *ctx)
{
    static const bvx_mesh empty = {0};
    bvx_repair_report report;
    bvx_repair_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = empty;
    bvx_status status;
    uint64_t hash;

    (void)user;
    o.fit.resolution = 14;
    o.parts.least_part = 5;
    o.parts.keep_largest = 1;
    o.parts.least_cavity = 5;
    o.placing.sharp = BVX_SHARP_ALWAYS;
    o.samples = 50;
    o.report = &report;
    status = bvx_repair(ctx, &spoilt_view, &o, &mesh);
    if (status != BVX_OK) {
        left_behind |= memcmp(&mesh, &empty, sizeof mesh) != 0;
        return status;
    }
    assert_int_equal(bvx_mesh_hash(ctx, &mesh, &hash), BVX_OK);
    if (want == 0) want = hash;
    left_behind |= 2 * (hash != want);
    bvx_mesh_free(ctx, &mesh);
    return BVX_OK;
}

static int make_spoilt(void **state)
{
    static const double centre[3] = {0, 0, 0}, radius[3] = {4, 4, 3};
    static const double plate[3] = {0, 9, 0}, thin[3] = {4, 3, 0.2}; /* its walls are thinner than voxels */
    uint64_t seed = 99;
    uint32_t a, b, c;

    (void)state;
    maker_star(&spoilt, &seed, centre, radius, 0.1, 7, 11, 65536);
    for (int i = 0; i < 5; i++) maker_remove(&spoilt, (size_t)maker_below(&seed, (int32_t)spoilt.triangles));
    maker_flip(&spoilt, 20, 30);
    maker_duplicate(&spoilt, 3);
    a = maker_vertex(&spoilt, 6, 0, 0);
    b = maker_vertex(&spoilt, 9, 0, 1);
    c = maker_vertex(&spoilt, 6, 4, 1);
    maker_triangle(&spoilt, a, b, c);
    maker_star(&spoilt, &seed, plate, thin, 0, 7, 11, 65536);
    spoilt_view = maker_view(&spoilt);
    return 0;
}

static int free_spoilt(void **state)
{
    (void)state;
    maker_free(&spoilt);
    return 0;
}

static void assert_well(const char *wrong)
{
    if (wrong != NULL) fail_msg("%s", wrong);
    if (left_behind & 1) fail_msg("a failed call left something in its result");
    if (left_behind & 2) fail_msg("another result than usual");
}

static void test_every_allocation_of_repair_fails_once(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2) {
        bvx_context_options o = default_options();
        uint64_t allocations = 0;
        o.threads = threads;
        assert_well(fault_every_allocation(repair_once, NULL, &o, &allocations));
        assert_true(allocations > 20);
    }
}

static void test_repair_cancels_at_every_progress_call(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2) {
        bvx_context_options o = default_options();
        uint64_t calls = 0;
        o.threads = threads;
        assert_well(fault_every_cancel(repair_once, NULL, &o, &calls));
        assert_true(calls > 10);
    }
}

static void test_repair_under_memory_limits(void **state)
{
    bvx_context_options o = default_options();
    (void)state;
    o.threads = 1;
    assert_well(fault_every_limit(repair_once, NULL, &o, 60));
}

static void test_repair_lives_in_an_arena(void **state)
{
    static uint8_t memory[8 << 20];
    bvx_context_options o = default_options();
    bvx_context *ctx;

    (void)state;
    o.arena.memory = memory;
    o.arena.size = sizeof memory;
    ctx = context_with(&o);
    for (int i = 0; i < 3; i++) {
        assert_int_equal(repair_once(NULL, ctx), BVX_OK);
        assert_int_equal(bvx_memory_used(ctx), 0);
    }
    assert_well(NULL);
    bvx_context_destroy(ctx);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_repair_fails_once),
        cmocka_unit_test(test_repair_cancels_at_every_progress_call),
        cmocka_unit_test(test_repair_under_memory_limits),
        cmocka_unit_test(test_repair_lives_in_an_arena),
    };
    return cmocka_run_group_tests_name("repair_faults", tests, make_spoilt, free_spoilt);
}
