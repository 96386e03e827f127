/* test_nearest_faults.c - closest points at centres of voxels with every allocation failing once, cancelled
 * at every progress call, and under every memory limit. */
#include "fault/context.h"
#include "nearest/nearest.h"
#include "tools/mesh_maker.h"

#include <math.h>

static maker_mesh star;
static bvx_mesh_view view;
static bvx_lattice lattice;

static int make_inputs(void **state)
{
    static const double centre[3] = {17, 16, 15};
    static const double radius[3] = {14, 13, 12};
    static const double origin[3] = {0, 0, 0};
    static const double spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {34, 32, 30};
    uint64_t seed = 81;
    bvx_context *const ctx = context_with(NULL);

    (void)state;
    maker_star(&star, &seed, centre, radius, 0.3, 19, 25, 65536);
    view = maker_view(&star);
    assert_int_equal(bvx_lattice_make(ctx, origin, spacing, dims, &lattice), BVX_OK);
    bvx_context_destroy(ctx);
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    maker_free(&star);
    return 0;
}

/* A band, its values, and the values of what is not in it. */
typedef struct found {
    uint64_t first[32 * 30 + 1], mark;
    float vectors[3 * 34 * 32 * 30];
    uint32_t triangles[34 * 32 * 30];
} found;

static bvx_status fill(bvx_context *ctx, double from, double to, const bvxi_nearest *nearest,
                       const bvx_grid *g, found *f)
{
    bvxi_sparse const v = {.where = *g,
                           .first = f->first,
                           .count = f->first[32 * 30],
                           .value_type = BVX_F32,
                           .vectors = f->vectors,
                           .triangles = f->triangles};
    bvx_status const status = bvxi_nearest_fill(bvxi_call_of(ctx, NULL, "test", from, to), nearest, HUGE_VAL,
                                                &v);
    uint64_t const n = f->first[32 * 30];
    if (status == BVX_OK) f->mark = bvx_hash(f->vectors, n * 12, bvx_hash(f->triangles, n * 4, f->mark));
    return status;
}

static bvx_status measure(bvx_context *ctx, const bvxi_nearest *nearest, found *f)
{
    bvx_grid band = {0};
    uint64_t n = 0;
    bvx_status status = bvx_grid_create(ctx, &lattice, NULL, &band);

    if (status == BVX_OK)
        status = bvxi_nearest_band(bvxi_call_of(ctx, NULL, "test", 0.25, 0.5), nearest, 2.0, &band, f->first);
    if (status == BVX_OK) status = fill(ctx, 0.5, 0.75, nearest, &band, f);
    if (status == BVX_OK) {
        for (uint64_t r = 0; r < 32 * 30; r++) {
            band.words[r] = ~band.words[r] & bvxi_tail_mask(34);
            f->first[r] = n;
            n += bvxi_popcount(band.words[r]);
        }
        f->first[32 * 30] = n;
        status = fill(ctx, 0.75, 1.0, nearest, &band, f);
    }
    bvx_grid_free(ctx, &band);
    return status;
}

static uint64_t usual;
static int differs;

static bvx_status run_nearest(bvx_context *ctx)
{
    static found f;
    bvxi_nearest *nearest = NULL;
    bvx_status status;

    f.mark = 0;
    status = bvxi_nearest_open(bvxi_call_of(ctx, "test", "test", 0.0, 0.25), &view, &lattice, &nearest);
    if (status == BVX_OK) status = measure(ctx, nearest, &f);
    else if (nearest != NULL) differs = 1;
    bvxi_nearest_close(ctx, nearest);
    if (status == BVX_OK && usual == 0) usual = f.mark;
    if (status == BVX_OK && usual != f.mark) differs = 1;
    return status;
}

/* As a public call does it, whose end takes back the scratch of what failed. */
static bvx_status run(void *user, bvx_context *ctx)
{
    (void)user;
    return BVXI_CALL(ctx, run_nearest(ctx));
}

static void test_every_allocation_of_nearest_fails_once(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2) {
        bvx_context_options o = default_options();
        uint64_t allocations = 0;
        o.threads = threads;
        assert_null(fault_every_allocation(run, NULL, &o, &allocations));
        assert_true(allocations > 10);
        assert_int_equal(differs, 0);
    }
}

static void test_nearest_cancels_at_every_progress_call(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2) {
        bvx_context_options o = default_options();
        uint64_t calls = 0;
        o.threads = threads;
        assert_null(fault_every_cancel(run, NULL, &o, &calls));
        assert_true(calls > 4);
        assert_int_equal(differs, 0);
    }
}

static void test_nearest_under_every_memory_limit(void **state)
{
    uint64_t peak, passed = 0;
    bvx_context_options o = default_options();
    bvx_context *ctx;

    (void)state;
    o.threads = 1;
    ctx = context_with(&o);
    assert_int_equal(run(NULL, ctx), BVX_OK);
    peak = bvx_memory_peak(ctx);
    bvx_context_destroy(ctx);
    for (uint64_t budget = peak / 40; budget <= peak + peak / 40; budget += peak / 40) {
        bvx_status status;
        o.memory_limit = budget;
        ctx = context_with(&o);
        status = run(NULL, ctx);
        assert_int_equal(status, budget >= peak ? BVX_OK : BVX_ERR_BUDGET);
        assert_int_equal(bvx_memory_used(ctx), 0);
        passed += status == BVX_OK;
        bvx_context_destroy(ctx);
    }
    assert_true(passed > 0);
    assert_int_equal(differs, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_nearest_fails_once),
        cmocka_unit_test(test_nearest_cancels_at_every_progress_call),
        cmocka_unit_test(test_nearest_under_every_memory_limit),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
