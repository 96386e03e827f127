/* test_winding_faults.c - the rule winding, and ratios between centres, with every allocation failing once,
 * cancelled at every progress call and under every memory limit. */
#include "fault/rows.h"
#include "tools/mesh_maker.h"
#include "winding/holes.h"

/* holes: triangles missing, turned and twice there; loose: each with corners of its own */
static maker_mesh closed, holes, loose;
static bvx_mesh_view closed_view, holes_view, loose_view;
static bvx_lattice lattice, coarse;
static bvx_context *maker;

static int make_inputs(void **state)
{
    static const double centre[3] = {11, 10, 9}, radius[3] = {9, 8, 7};
    uint64_t seed = 815;
    bvx_context_options o = default_options();

    (void)state;
    o.threads = 1;
    maker = context_with(&o);
    maker_star(&closed, &seed, centre, radius, 0.2, 7, 11, 65536);
    maker_star(&holes, &seed, centre, radius, 0.2, 7, 11, 65536);
    for (int i = 0; i < 7; i++) maker_remove(&holes, (size_t)maker_below(&seed, (int32_t)holes.triangles));
    maker_flip(&holes, 20, 40);
    for (size_t i = 50; i < 60; i++) maker_duplicate(&holes, i);
    maker_star(&loose, &seed, centre, radius, 0.2, 12, 15, 65536);
    for (size_t i = 0, n = 3 * loose.triangles; i < n; i++) {
        double const *const p = loose.p + 3 * (size_t)loose.t[i];
        loose.t[i] = maker_vertex(&loose, p[0] + 0.01 * maker_below(&seed, 30),
                                  p[1] + 0.01 * maker_below(&seed, 30), p[2]);
    }
    closed_view = maker_view(&closed);
    loose_view = maker_view(&loose);
    holes_view = maker_view(&holes);
    assert_int_equal(bvx_lattice_fit(maker, &closed_view, 40, &lattice), BVX_OK);
    assert_int_equal(bvx_lattice_fit(maker, &loose_view, 10, &coarse), BVX_OK);
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    assert_int_equal(bvx_memory_used(maker), 0);
    bvx_context_destroy(maker);
    maker_free(&closed);
    maker_free(&holes);
    maker_free(&loose);
    return 0;
}

static bvx_status fill_view(bvx_context *ctx, const bvx_mesh_view *view, const bvx_lattice *on)
{
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_solid_report report = {0};
    bvx_grid g = {0};
    bvx_status status;

    o.fill = BVX_FILL_WINDING;
    o.report = &report;
    status = bvx_voxelize_solid(ctx, view, on, &o, &g);
    left_behind |= status != BVX_OK && (g.words != NULL || report.crossings != 0);
    if (status == BVX_OK) assert_int_equal(bvx_grid_hash(ctx, &g, &mark), BVX_OK);
    bvx_grid_free(ctx, &g);
    return status;
}

static bvx_status fill_holes(void *user, bvx_context *ctx)
{
    (void)user;
    return fill_view(ctx, &holes_view, &lattice);
}

static bvx_status fill_loose(void *user, bvx_context *ctx)
{
    (void)user;
    return fill_view(ctx, &loose_view, &coarse);
}

static bvx_status fill_closed(void *user, bvx_context *ctx)
{
    (void)user;
    return fill_view(ctx, &closed_view, &lattice);
}

static bvx_status ratios_of_holes(bvx_context *ctx)
{
    bvxi_winding *w = (bvxi_winding *)&mark;
    bvxi_holes loops;
    bvx_status status = bvxi_holes_open_rule(ctx, "test", &holes_view, &lattice, BVX_FILL_WINDING, &loops);
    double sum = 0;

    if (status != BVX_OK) return status;
    status = bvxi_winding_open(ctx, "test", &holes_view, &lattice, BVX_FILL_WINDING, &loops, &w);
    left_behind |= status != BVX_OK && w != NULL;
    if (status != BVX_OK) bvxi_holes_close(ctx, &loops);
    if (status != BVX_OK) return status;
    for (int32_t x = 0; x < 30; x++) {
        bvxi_winding_edge const edge = {{x, x % 7 + 8, x % 5 + 10}, x % 3};
        double ratio;
        bvxi_winding_ratios(w, 1, &edge, &ratio);
        sum += ratio;
    }
    bvxi_winding_close(ctx, w);
    bvxi_holes_close(ctx, &loops);
    mark = bvx_hash(&sum, sizeof sum, 0);
    return BVX_OK;
}

/* Two works, which rise once together as those of a public function do. */
static bvx_status ratios(void *user, bvx_context *ctx)
{
    (void)user;
    return BVXI_CALL(ctx, ratios_of_holes(ctx));
}

static fault_row kinds[] = {
    {"holes", fill_holes, 4, 1, 0},
    {"loose", fill_loose, 4, 1, 0},
    {"closed", fill_closed, 4, 1, 0},
    {"ratios", ratios, 4, 1, 0},
};

static void test_every_allocation_fails_once(void **state)
{
    (void)state;
    fail_every_allocation(FAULT_ROWS(kinds));
}

static void test_cancelled_at_every_progress_call(void **state)
{
    (void)state;
    cancel_at_every_call(FAULT_ROWS(kinds));
}

static void test_every_memory_limit(void **state)
{
    (void)state;
    limit_memory(FAULT_ROWS(kinds), 60);
}

static void test_corners_beyond_the_vertices_are_named(void **state)
{
    bvx_mesh_view bad = holes_view;
    bvxi_holes loops;

    (void)state;
    bad.vertex_count--;
    left_behind = 0;
    assert_int_equal(fill_view(maker, &bad, &lattice), BVX_ERR_RANGE);
    assert_non_null(strstr(bvx_last_message(maker), "triangle"));
    assert_int_equal(bvxi_holes_open_rule(maker, "test", &bad, &lattice, BVX_FILL_VOTE, &loops),
                     BVX_ERR_RANGE);
    assert_int_equal(loops.loops, 0);
    assert_int_equal(left_behind, 0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_fails_once),
        cmocka_unit_test(test_cancelled_at_every_progress_call),
        cmocka_unit_test(test_every_memory_limit),
        cmocka_unit_test(test_corners_beyond_the_vertices_are_named),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
