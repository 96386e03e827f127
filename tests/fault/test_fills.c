/* test_fills.c - votes, floods, regions, terrains, comparisons, seeds and fills with every allocation failing
 * once, cancelled at every progress call, under every memory limit and in arenas of every size. */
#include "fault/rows.h"
#include "tools/mesh_maker.h"

/* ---- Inputs, made once ---- */

/* hollow: a cavity; holes: triangles missing and turned; shell: half a voxel; halves: open, one inside out */
static maker_mesh closed, hollow, holes, overlapping, shell, halves;
static bvx_mesh_view closed_view, hollow_view, holes_view, overlap_view, shell_view, halves_view;
static bvx_lattice lattice;
static bvx_grid surface;
static bvx_context *maker; /* what made them */

static int make_inputs(void **state)
{
    static const double centre[3] = {11, 10, 9}, radius[3] = {9, 8, 7}, inner[3] = {5, 4.5, 4};
    uint64_t seed = 4713;
    bvx_context_options o = default_options();

    (void)state;
    o.threads = 1;
    maker = context_with(&o);
    maker_star(&closed, &seed, centre, radius, 0.2, 7, 11, 65536);
    maker_star(&holes, &seed, centre, radius, 0.2, 7, 11, 65536);
    maker_star(&hollow, &seed, centre, radius, 0.1, 7, 11, 65536);
    maker_star(&hollow, &seed, centre, inner, 0.1, 7, 11, 65536);
    for (int i = 0; i < 7; i++) maker_remove(&holes, (size_t)maker_below(&seed, (int32_t)holes.triangles));
    maker_flip(&holes, 20, 40);
    maker_star(&overlapping, &seed, centre, inner, 0.1, 7, 11, 65536);
    for (size_t first = overlapping.triangles; first != 0; first = 0) {
        static const double beside[3] = {15, 10, 9};
        maker_star(&overlapping, &seed, beside, inner, 0.1, 7, 11, 65536);
        maker_flip(&overlapping, first, overlapping.triangles);
        maker_flip(&overlapping, 3, 4);
    }
    for (int i = 0; i < 2; i++) {
        double const r[3] = {7 - 0.5 * i, 7 - 0.5 * i, 7 - 0.5 * i};
        uint64_t same = 3;
        maker_star(&shell, &same, centre, r, 0, 8, 12, 65536);
    }
    maker_flip(&shell, shell.triangles / 2, shell.triangles);
    for (int i = 0; i < 2; i++) {
        double const low[3] = {3.0 + 8 * i, 4, 4}, high[3] = {10.9 + 8 * i, 16, 15};
        size_t const first = halves.triangles;

        /* Without the side towards the other half. */
        maker_box(&halves, low, high);
        for (int k = 0; k < 2; k++) maker_remove(&halves, first + (i == 0 ? 2 : 0));
        if (i == 1) maker_flip(&halves, first, halves.triangles);
    }
    halves_view = maker_view(&halves);
    shell_view = maker_view(&shell);
    overlap_view = maker_view(&overlapping);
    closed_view = maker_view(&closed);
    hollow_view = maker_view(&hollow);
    holes_view = maker_view(&holes);
    assert_int_equal(bvx_lattice_fit(maker, &closed_view, 24, &lattice), BVX_OK);
    assert_int_equal(bvx_voxelize_surface(maker, &closed_view, &lattice, NULL, &surface), BVX_OK);
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    bvx_grid_free(maker, &surface);
    assert_int_equal(bvx_memory_used(maker), 0);
    bvx_context_destroy(maker);
    maker_free(&closed);
    maker_free(&hollow);
    maker_free(&holes);
    maker_free(&overlapping);
    maker_free(&shell);
    maker_free(&halves);
    return 0;
}

/* ---- Fills: each frees what it got, leaves its mark, and says on failure whether its results are empty - */

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

static bvx_status fill_by(bvx_context *ctx, const bvx_mesh_view *view, bvx_voxelize_options *o)
{
    bvx_grid g = {0};
    bvx_status const status = bvx_voxelize_solid(ctx, view, &lattice, o, &g);
    return keep_grid(ctx, status, &g);
}

static bvx_status vote(void *user, bvx_context *ctx)
{
    bvx_voxelize_options o = {.struct_size = sizeof o};
    (void)user;
    o.fill = BVX_FILL_VOTE;
    o.add_shell = 1;
    return fill_by(ctx, &holes_view, &o);
}

/* Overlapping parts, one of them inside out; then a window of a mesh with holes. */
static bvx_status overlap(void *user, bvx_context *ctx)
{
    (void)user;
    return fill_by(ctx, &overlap_view, NULL);
}

static bvx_status automatic(void *user, bvx_context *ctx)
{
    bvx_voxelize_options o = {.struct_size = sizeof o};
    (void)user;
    for (int a = 0; a < 3; a++) o.window.size[a] = 5 + a;
    return fill_by(ctx, &holes_view, &o);
}

/* A patch that is turned as a whole. */
static bvx_status sides(void *user, bvx_context *ctx)
{
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_solid_report report;

    (void)user;
    o.report = &report;
    bvx_status const status = fill_by(ctx, &halves_view, &o);
    if (status == BVX_OK) assert_int_equal(report.turned, 10);
    return status;
}

/* Walls that are lost: of a shell thinner than voxels. */
static bvx_status losses(void *user, bvx_context *ctx)
{
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_solid_report report;

    (void)user;
    o.report = &report;
    o.check_thin = BVX_CHECK_ALWAYS;
    bvx_status const status = fill_by(ctx, &shell_view, &o);
    if (status == BVX_OK) assert_true(report.thin_voxels > 0);
    return status;
}

static bvx_status regions(void *user, bvx_context *ctx)
{
    bvx_voxelize_options o = {.struct_size = sizeof o};
    (void)user;
    o.fill = BVX_FILL_REGIONS;
    return fill_by(ctx, &holes_view, &o);
}

static bvx_status flood(void *user, bvx_context *ctx)
{
    bvx_voxelize_options o = {.struct_size = sizeof o};
    (void)user;
    o.fill = BVX_FILL_FLOOD;
    o.close_gaps = 2;
    return fill_by(ctx, &hollow_view, &o);
}

static bvx_status below(void *user, bvx_context *ctx)
{
    bvx_voxelize_options o = {.struct_size = sizeof o};

    (void)user;
    o.fill = BVX_FILL_BELOW;
    o.up = BVX_UP_Y;
    o.base = 4;
    o.has_base = 1;
    o.second = &closed_view;
    return fill_by(ctx, &holes_view, &o);
}

static bvx_status seed(void *user, bvx_context *ctx)
{
    static const bvx_seed untouched = {{0, 0, 0}, 0, 0, 0, {0}, 0, 0, {0}};
    bvx_seed s = untouched;
    bvx_status const status = bvx_find_seed(ctx, &surface, &holes_view, 0, &s);
    (void)user;
    left_behind |= status != BVX_OK && memcmp(&s, &untouched, sizeof s) != 0;
    if (status == BVX_OK) mark = bvx_hash(&s, sizeof s, 0);
    return status;
}

static bvx_status pockets(void *user, bvx_context *ctx)
{
    int32_t seeds[3 * 64];
    uint64_t count = 0;
    bvx_status status;

    (void)user;
    memset(seeds, 0, sizeof seeds);
    status = bvx_find_pockets(ctx, &surface, &closed_view, seeds, 64, &count);
    if (status == BVX_OK) mark = bvx_hash(seeds, sizeof seeds, count);
    return status;
}

static bvx_status grid_fill(void *user, bvx_context *ctx)
{
    int32_t seeds[3 * 64];
    uint64_t count = 0;
    bvx_grid g = {0};
    bvx_status status = bvx_find_pockets(ctx, &surface, NULL, seeds, 64, &count);

    (void)user;
    if (status != BVX_OK) return status;
    status = bvx_grid_fill(ctx, &surface, seeds, count, 18, &g);
    return keep_grid(ctx, status, &g);
}

static fault_row fills[] = {
    {"vote", vote, 4, 1, 0},      {"regions", regions, 4, 1, 0}, {"flood", flood, 4, 1, 0},
    {"below", below, 4, 1, 0},    {"seed", seed, 4, 1, 0},       {"pockets", pockets, 4, 1, 0},
    {"fill", grid_fill, 4, 1, 0}, {"overlap", overlap, 4, 1, 0}, {"auto", automatic, 4, 1, 0},
    {"losses", losses, 4, 1, 0},  {"sides", sides, 4, 1, 0},
};

/* ---- Tests ---- */

static void test_every_allocation_of_fills_fails_once(void **state)
{
    (void)state;
    fail_every_allocation(FAULT_ROWS(fills));
}

static void test_fills_cancel_at_every_progress_call(void **state)
{
    (void)state;
    cancel_at_every_call(FAULT_ROWS(fills));
}

static void test_fills_under_every_memory_limit(void **state)
{
    (void)state;
    limit_memory(FAULT_ROWS(fills), 60);
}

static void test_fills_live_in_an_arena(void **state)
{
    (void)state;
    live_in_arenas(FAULT_ROWS(fills), 2 << 20, 40);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_fills_fails_once),
        cmocka_unit_test(test_fills_cancel_at_every_progress_call),
        cmocka_unit_test(test_fills_under_every_memory_limit),
        cmocka_unit_test(test_fills_live_in_an_arena),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
