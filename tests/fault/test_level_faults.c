/* test_level_faults.c - levels of detail with every allocation failing once, cancelled at every progress
 * call, under memory limits and in arenas: of the mesh as it is by count and by error, of its measured
 * surface, and of sheets that are cut. The plan takes no memory and cannot be cancelled. */
#include "fault/context.h"
#include "tools/mesh_maker.h"

enum { LEVELS = 2 };

static maker_mesh sound, spoilt, large; /* the second with holes, flipped and doubled triangles, a sheet */
static uint8_t tint[4 * 2000];          /* of vertices of the first two */
static bvx_mesh_view sound_view, spoilt_view, large_view;

/* One way to make levels; by_error 2: by count, of sheets; 3: by count, with a weight of attributes; measured 3:
 * of sheets. want is the hash of a good run's. */
typedef struct job {
    const char *name;
    int32_t measured, by_error; /* measured -1: a mesh whose cells collapse on their own */
    uint64_t want;
    int32_t left_behind; /* 1: a failed call left something, 2: a good one gave another result */
} job;

static job jobs[] = {
    {"simplify by count", 0, 0, 0, 0},
    {"simplify by error", 0, 1, 0, 0},
    {"levels of the mesh", 1, 0, 0, 0},
    {"levels by error", 1, 1, 0, 0},
    {"measured levels", 2, 0, 0, 0},
    {"simplify a large mesh", -1, 0, 0, 0},
    {"sheets", 0, 2, 0, 0},
    {"levels of sheets", 3, 0, 0, 0},
    {"simplify with colours", 0, 3, 0, 0},
    {"levels of sheets with colours", 3, 3, 0, 0},
};
enum { JOBS = sizeof jobs / sizeof *jobs };

static const uint64_t targets[LEVELS] = {120, 40};
static const double errors[LEVELS] = {0.2, 0.6};

static bvx_status simplify(const job *j, bvx_context *ctx, bvx_mesh *level, bvx_level_report *reports)
{
    bvx_simplify_options o = {.struct_size = sizeof o};

    if (j->by_error == 1) o.targets.errors = errors;
    else o.targets.triangles = targets;
    if (j->by_error == 3) o.collapse.attribute_weight = 10;
    o.targets.samples = 20;
    o.reports = reports;
    return bvx_mesh_simplify(ctx,
                             j->measured < 0    ? &large_view
                             : j->by_error == 2 ? &spoilt_view
                                                : &sound_view,
                             &o, LEVELS, level);
}

static bvx_status build(const job *j, bvx_context *ctx, bvx_mesh *level, bvx_level_report *reports,
                        bvx_levels_report *report)
{
    bvx_levels_options o = {.struct_size = sizeof o};

    if (j->by_error == 1) o.targets.errors = errors;
    else o.targets.triangles = targets;
    if (j->by_error == 3) o.collapse.attribute_weight = 10;
    o.targets.samples = 20;
    o.reports = reports;
    o.report = report;
    if (j->measured == 2) o.fit.resolution = 10;
    return bvx_build_levels(ctx, j->measured >= 2 ? &spoilt_view : &sound_view, &o, LEVELS, level);
}

static bvx_status make_levels(void *user, bvx_context *ctx)
{
    static const bvx_mesh empty[LEVELS] = {{0}};
    static const bvx_levels_report no_report = {0};
    job *const j = user;
    bvx_mesh level[LEVELS];
    bvx_level_report reports[LEVELS];
    bvx_levels_report report = no_report;
    bvx_status status;
    uint64_t all = 0;

    memset(level, 0, sizeof level);
    memset(reports, 0, sizeof reports);
    status = j->measured > 0 ? build(j, ctx, level, reports, &report) : simplify(j, ctx, level, reports);
    if (status != BVX_OK) {
        if (memcmp(level, empty, sizeof level) != 0 || memcmp(&report, &no_report, sizeof report) != 0)
            j->left_behind |= 1;
        return status;
    }
    for (int i = 0; i < LEVELS; i++) {
        uint64_t hash;
        assert_int_equal(bvx_mesh_hash(ctx, &level[i], &hash), BVX_OK);
        assert_int_equal(reports[i].certificate.closed, j->by_error != 2 && j->measured != 3);
        all = all * 31 + hash + bvx_hash(&reports[i], sizeof reports[i], 0);
    }
    if (j->measured > 0) assert_int_equal(report.solid, j->measured == 2);
    for (int i = LEVELS; i-- > 0;) bvx_mesh_free(ctx, &level[i]);
    if (j->want == 0) j->want = all;
    if (all != j->want) j->left_behind |= 2;
    return BVX_OK;
}

static int make_inputs(void **state)
{
    static const double centre[3] = {0, 0, 0}, radius[3] = {4, 4, 3};
    uint64_t seed = 99;
    uint32_t a, b, c;

    (void)state;
    maker_star(&sound, &seed, centre, radius, 0.1, 8, 12, 65536);
    maker_star(&spoilt, &seed, centre, radius, 0.1, 7, 11, 65536);
    maker_star(&large, &seed, centre, radius, 0, 85, 125, 1 << 20);
    for (int i = 0; i < 5; i++) maker_remove(&spoilt, (size_t)maker_below(&seed, (int32_t)spoilt.triangles));
    maker_flip(&spoilt, 20, 30);
    maker_duplicate(&spoilt, 3);
    a = maker_vertex(&spoilt, 6, 0, 0);
    b = maker_vertex(&spoilt, 9, 0, 1);
    c = maker_vertex(&spoilt, 6, 4, 1);
    maker_triangle(&spoilt, a, b, c);
    sound_view = maker_view(&sound);
    spoilt_view = maker_view(&spoilt);
    large_view = maker_view(&large);
    assert_true(4 * sound.vertices <= sizeof tint && 4 * spoilt.vertices <= sizeof tint);
    for (size_t i = 0; i < sizeof tint; i++) tint[i] = (uint8_t)maker_below(&seed, 256);
    sound_view.colours = spoilt_view.colours = tint;
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    maker_free(&sound);
    maker_free(&spoilt);
    maker_free(&large);
    return 0;
}

static void assert_well(const job *j, const char *wrong)
{
    if (wrong != NULL) fail_msg("%s: %s", j->name, wrong);
    if (j->left_behind & 1) fail_msg("%s: a failed call left something in its result", j->name);
    if (j->left_behind & 2) fail_msg("%s: another result than usual", j->name);
}

/* Sanitizers make these tests slow: with BVX_QUICK the job that joins two
 * others is left out, and several threads do one only. */
static int is_left_out(int i, int32_t threads)
{
    if (getenv("BVX_QUICK") == NULL) return 0;
    return i == JOBS - 1 || (threads > 1 && jobs[i].measured >= 0);
}

static void test_every_allocation_of_levels_fails_once(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2)
        for (int i = threads == 1 ? 0 : 3; i < JOBS; i++) {
            bvx_context_options o = default_options();
            uint64_t allocations = 0;

            if (is_left_out(i, threads)) continue;
            o.threads = threads;
            assert_well(&jobs[i], fault_every_allocation(make_levels, &jobs[i], &o, &allocations));
            assert_true(allocations > 15);
        }
}

static void test_levels_cancel_at_every_progress_call(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2)
        for (int i = threads == 1 ? 0 : 3; i < JOBS; i++) {
            bvx_context_options o = default_options();
            uint64_t calls = 0;

            if (is_left_out(i, threads)) continue;
            o.threads = threads;
            assert_well(&jobs[i], fault_every_cancel(make_levels, &jobs[i], &o, &calls));
            assert_true(calls > 5);
        }
}

static void test_levels_under_memory_limits(void **state)
{
    (void)state;
    for (int i = 0; i < JOBS; i++) {
        bvx_context_options o = default_options();

        if (is_left_out(i, 1)) continue;
        o.threads = 1;
        assert_well(&jobs[i], fault_every_limit(make_levels, &jobs[i], &o, 60));
    }
}

static void test_levels_live_in_an_arena(void **state)
{
    (void)state;
    for (int i = 0; i < JOBS; i++) {
        bvx_context_options o = default_options();
        o.threads = 1;
        if (is_left_out(i, 1)) continue;
        assert_well(&jobs[i], fault_every_arena(make_levels, &jobs[i], &o, 8 << 20, 40));
    }
}

/* Levels in arrays of the caller's: after a failure these are still there, and empty. */
static bvx_status make_in_arrays(void *user, bvx_context *ctx)
{
    static float positions[LEVELS][3 * 200];
    static uint32_t corners[LEVELS][3 * 200];
    job *const j = user;
    bvx_mesh level[LEVELS];
    bvx_level_report reports[LEVELS];
    bvx_levels_report report;
    bvx_status status;

    memset(level, 0, sizeof level);
    for (int i = 0; i < LEVELS; i++) {
        level[i].positions = positions[i];
        level[i].triangles = corners[i];
        level[i].vertex_capacity = level[i].triangle_capacity = 200;
        level[i].position_type = BVX_F32;
    }
    status = build(j, ctx, level, reports, &report);
    for (int i = 0; i < LEVELS; i++) {
        if (level[i].positions != (void *)positions[i] || level[i].triangles != corners[i] || level[i].owned)
            j->left_behind |= 1;
        if (status != BVX_OK && level[i].vertex_count + level[i].triangle_count != 0) j->left_behind |= 1;
    }
    return status;
}

static void test_arrays_of_the_callers_survive(void **state)
{
    bvx_context_options o = default_options();
    uint64_t count = 0;
    (void)state;
    o.threads = 1;
    assert_well(&jobs[4], fault_every_allocation(make_in_arrays, &jobs[4], &o, &count));
    assert_true(count > 15);
    assert_well(&jobs[4], fault_every_cancel(make_in_arrays, &jobs[4], &o, &count));
}

static bvx_status plan_samples(void *user, bvx_context *ctx)
{
    uint64_t const counts[2] = {500, 100};
    int32_t resolution = 0;
    bvx_lod_options o = {.struct_size = sizeof o};
    bvx_status status;
    (void)user;

    o.target_triangles = counts;
    status = bvx_plan_lods(ctx, &spoilt_view, &o, 2, 0, &resolution, NULL);
    if (status == BVX_OK) assert_true(resolution > 0);
    return status;
}

static void test_the_plan_takes_nothing(void **state)
{
    bvx_context_options const o = default_options();
    uint64_t count = 99, need = 99;
    (void)state;
    assert_null(fault_every_allocation(plan_samples, NULL, &o, &count));
    assert_int_equal(count, 0);
    assert_null(fault_every_cancel(plan_samples, NULL, &o, &count));
    assert_null(fault_peak(plan_samples, NULL, &o, &need));
    assert_int_equal(need, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_levels_fails_once),
        cmocka_unit_test(test_levels_cancel_at_every_progress_call),
        cmocka_unit_test(test_levels_under_memory_limits),
        cmocka_unit_test(test_levels_live_in_an_arena),
        cmocka_unit_test(test_arrays_of_the_callers_survive),
        cmocka_unit_test(test_the_plan_takes_nothing),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
