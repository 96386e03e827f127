/* test_algebra_faults.c - set algebra, blocks, windows, booleans and hulls of meshes with every allocation failing
 * once, cancelled at every progress call, under every memory limit and in arenas of every size. */
#include "fault/rows.h"
#include "tools/mesh_maker.h"

/* ---- Inputs, made once ---- */

static maker_mesh star[3]; /* the last is a lens thinner than a voxel */
static bvx_mesh_view view[3];
static bvx_grid a, b;
static bvx_lattice finer;
static bvx_context *maker; /* what made them */

static int make_inputs(void **state)
{
    static const double centre[2][3] = {{17, 16, 15}, {24, 18, 16}};
    static const double radius[3] = {14, 13, 12};
    static const double lens[3] = {22, 20, 0.2};
    uint64_t seed = 81;
    bvx_context_options o = default_options();

    (void)state;
    o.threads = 1;
    maker = context_with(&o);
    for (int i = 0; i < 2; i++) {
        maker_star(&star[i], &seed, centre[i], radius, 0.3, 9, 15, 65536);
        view[i] = maker_view(&star[i]);
    }
    maker_star(&star[2], &seed, centre[0], lens, 0, 9, 15, 65536);
    view[2] = maker_view(&star[2]);
    assert_int_equal(bvx_lattice_fit(maker, &view[0], 100, &finer), BVX_OK);
    assert_int_equal(bvx_grid_create(maker, &finer, NULL, &a), BVX_OK);
    assert_int_equal(bvx_grid_create(maker, &finer, NULL, &b), BVX_OK);
    for (int32_t z = 0; z < finer.dims[2]; z++)
        for (int32_t y = 0; y < finer.dims[1]; y++)
            for (int32_t x = 0; x < finer.dims[0]; x++) {
                bvx_grid_set(&a, x, y, z, maker_below(&seed, 3) == 0);
                bvx_grid_set(&b, x, y, z, maker_below(&seed, 2) == 0);
            }
    for (int i = 0; i < 3; i++) finer.spacing[i] *= 0.7;
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    bvx_grid_free(maker, &a);
    bvx_grid_free(maker, &b);
    assert_int_equal(bvx_memory_used(maker), 0);
    bvx_context_destroy(maker);
    maker_free(&star[0]);
    maker_free(&star[1]);
    maker_free(&star[2]);
    return 0;
}

/* ---- Operations: each frees what it got, leaves its mark, and says on failure whether its results are empty  */

static bvx_status end_grid(bvx_context *ctx, bvx_status status, bvx_grid *grid)
{
    if (status == BVX_OK) status = bvx_grid_hash(ctx, grid, &mark);
    else left_behind |= grid->words != NULL || grid->size[0] != 0 || grid->owned != 0;
    bvx_grid_free(ctx, grid);
    return status;
}

static bvx_status unite(void *user, bvx_context *ctx)
{
    bvx_grid g = {0};
    (void)user;
    return end_grid(ctx, bvx_grid_combine(ctx, &a, &b, BVX_BOOLEAN_UNION, &g), &g);
}

static bvx_status intersect(void *user, bvx_context *ctx)
{
    bvx_grid g = {0};
    (void)user;
    return end_grid(ctx, bvx_grid_combine(ctx, &a, &b, BVX_BOOLEAN_INTERSECTION, &g), &g);
}

static bvx_status take_away(void *user, bvx_context *ctx)
{
    bvx_grid g = {0};
    (void)user;
    return end_grid(ctx, bvx_grid_combine(ctx, &a, &b, BVX_BOOLEAN_DIFFERENCE, &g), &g);
}

static bvx_status differ(void *user, bvx_context *ctx)
{
    bvx_grid g = {0};
    (void)user;
    return end_grid(ctx, bvx_grid_combine(ctx, &a, &b, BVX_BOOLEAN_XOR, &g), &g);
}

static bvx_status invert(void *user, bvx_context *ctx)
{
    bvx_grid g = {0};
    (void)user;
    return end_grid(ctx, bvx_grid_complement(ctx, &a, &g), &g);
}

static bvx_status reduce(void *user, bvx_context *ctx)
{
    static const int32_t factor[3] = {3, 2, 4};
    bvx_grid g = {0};
    (void)user;
    return end_grid(ctx, bvx_grid_downsample(ctx, &a, factor, BVX_REDUCE_MAJORITY, &g), &g);
}

static bvx_status cover(void *user, bvx_context *ctx)
{
    static const int32_t factor[3] = {4, 4, 4};
    static uint32_t counts[20000];
    uint64_t n;
    bvx_status status;

    (void)user;
    memset(counts, 0, sizeof counts);
    status = bvx_grid_coverage(ctx, &a, factor, counts, sizeof counts / sizeof *counts, &n);
    if (status == BVX_OK) mark = bvx_hash(counts, sizeof counts, n);
    return status;
}

static bvx_status crop(void *user, bvx_context *ctx)
{
    bvx_window const w = {{5, 6, 7}, {70, 60, 50}};
    bvx_grid g = {0};
    (void)user;
    return end_grid(ctx, bvx_grid_crop(ctx, &a, &w, &g), &g);
}

static bvx_status pad(void *user, bvx_context *ctx)
{
    static const int32_t low[3] = {5, 6, 7}, high[3] = {1, 2, 3};
    bvx_grid g = {0};
    (void)user;
    return end_grid(ctx, bvx_grid_pad(ctx, &a, low, high, &g), &g);
}

static bvx_status permute(void *user, bvx_context *ctx)
{
    static const int32_t axes[3] = {2, 0, 1}, flips[3] = {1, 0, 1};
    bvx_grid g = {0};
    (void)user;
    return end_grid(ctx, bvx_grid_permute(ctx, &a, axes, flips, &g), &g);
}

static bvx_status resample(void *user, bvx_context *ctx)
{
    bvx_grid g = {0};
    (void)user;
    return end_grid(ctx, bvx_grid_resample(ctx, &a, &finer, NULL, &g), &g);
}

static bvx_status boolean_with(bvx_context *ctx, int other, int32_t operation, int32_t sharp)
{
    bvx_boolean_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = {0};
    bvx_status status;

    o.fit.resolution = 20;
    o.placing.sharp = BVX_SHARP_NEVER + sharp;
    status = bvx_boolean(ctx, &view[0], &view[other], operation, &o, &mesh);
    if (status == BVX_OK) status = bvx_mesh_hash(ctx, &mesh, &mark);
    else left_behind |= mesh.positions != NULL || mesh.triangles != NULL || mesh.vertex_count != 0;
    bvx_mesh_free(ctx, &mesh);
    return status;
}

static bvx_status join_meshes(void *user, bvx_context *ctx)
{
    (void)user;
    return boolean_with(ctx, 1, BVX_BOOLEAN_UNION, 0);
}

static bvx_status cut_meshes(void *user, bvx_context *ctx)
{
    (void)user;
    return boolean_with(ctx, 1, BVX_BOOLEAN_DIFFERENCE, 1);
}

static bvx_status join_lens(void *user, bvx_context *ctx)
{
    (void)user;
    return boolean_with(ctx, 2, BVX_BOOLEAN_UNION, 0);
}

/* A mesh of one piece, and the lens, which is thinner than a voxel: a shell. */
static bvx_status hull_of(bvx_context *ctx, int n, double enclose)
{
    uint64_t const target = enclose > 0 ? 40 : 300;
    bvx_hull_options o = {.struct_size = sizeof o, .targets = {.triangles = &target}, .enclose = enclose};
    bvx_hull_report report;
    bvx_mesh mesh = {0};
    bvx_status status;

    o.fit.resolution = enclose > 0 ? 0 : 20;
    o.close_gaps = enclose > 0 ? 0 : 1;
    o.report = &report;
    status = bvx_hull(ctx, &view[n], &o, 1, &mesh);
    if (status == BVX_OK) status = bvx_mesh_hash(ctx, &mesh, &mark);
    else left_behind |= mesh.positions != NULL || mesh.triangles != NULL || mesh.vertex_count != 0;
    bvx_mesh_free(ctx, &mesh);
    return status;
}

static bvx_status hull_mesh(void *user, bvx_context *ctx)
{
    (void)user;
    return hull_of(ctx, 0, 0);
}

static bvx_status enclosed_mesh(void *user, bvx_context *ctx)
{
    (void)user;
    return hull_of(ctx, 0, 8);
}

static bvx_status hull_lens(void *user, bvx_context *ctx)
{
    (void)user;
    return hull_of(ctx, 2, 0);
}

static fault_row cases[] = {
    {"union", unite, 1, 1, 0},
    {"intersection", intersect, 1, 1, 0},
    {"difference", take_away, 1, 1, 0},
    {"xor", differ, 1, 1, 0},
    {"complement", invert, 1, 1, 0},
    {"downsample", reduce, 1, 1, 0},
    {"coverage", cover, 1, 1, 0},
    {"crop", crop, 1, 1, 0},
    {"pad", pad, 1, 1, 0},
    {"permute", permute, 1, 1, 0},
    {"resample", resample, 1, 1, 0},
    {"boolean union", join_meshes, 1, 1, 0},
    {"boolean difference, sharp", cut_meshes, 1, 1, 0},
    {"boolean union, thin", join_lens, 1, 1, 0},
    {"hull", hull_mesh, 1, 1, 0},
    {"hull of a sheet", hull_lens, 1, 1, 0},
    {"hull that encloses", enclosed_mesh, 1, 1, 0},
};

/* ---- Tests ---- */

static void test_every_allocation_of_set_algebra_fails_once(void **state)
{
    (void)state;
    fail_every_allocation(FAULT_ROWS(cases));
}

static void test_set_algebra_cancels_at_every_progress_call(void **state)
{
    (void)state;
    cancel_at_every_call(FAULT_ROWS(cases));
}

static void test_set_algebra_under_every_memory_limit(void **state)
{
    (void)state;
    limit_memory(FAULT_ROWS(cases), 40);
}

static void test_set_algebra_lives_in_an_arena(void **state)
{
    (void)state;
    live_in_arenas(FAULT_ROWS(cases), 1 << 21, 30);
}

/* A result of the caller's words stays his, also when the call is cancelled. */
static int32_t stop(void *user, const char *stage, double fraction)
{
    (void)user, (void)stage, (void)fraction;
    return 1;
}

static void test_cancelled_in_place_keeps_the_words(void **state)
{
    bvx_context_options o = default_options();
    bvx_grid own = a;
    bvx_context *ctx;
    size_t const words = (size_t)a.words_per_row * (size_t)a.size[1] * (size_t)a.size[2];
    uint64_t *const copy = malloc(words * 8);

    (void)state;
    assert_non_null(copy);
    memcpy(copy, a.words, words * 8);
    own.words = copy;
    own.owned = 0;
    o.progress.call = stop;
    o.threads = 1;
    ctx = context_with(&o);
    assert_int_equal(bvx_grid_combine(ctx, &own, &b, BVX_BOOLEAN_UNION, &own), BVX_CANCELLED);
    assert_ptr_equal(own.words, copy);
    assert_int_equal(own.size[0], a.size[0]);
    bvx_context_destroy(ctx);
    free(copy);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_set_algebra_fails_once),
        cmocka_unit_test(test_set_algebra_cancels_at_every_progress_call),
        cmocka_unit_test(test_set_algebra_under_every_memory_limit),
        cmocka_unit_test(test_set_algebra_lives_in_an_arena),
        cmocka_unit_test(test_cancelled_in_place_keeps_the_words),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
