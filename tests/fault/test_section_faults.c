/* test_section_faults.c - bodies from sections, contour files and contours of meshes, with every allocation failing once, cancelled at
 * every question, and under every memory limit. */
#include "context.h"
#include "tools/section_maker.h"

static bvx_context *maker;
static section_maker stack;
static maker_mesh star;
static bvx_mesh_view view;

static int make_inputs(void **state)
{
    static const double centre[3] = {2, 2, 2}, radius[3] = {1.8, 1.5, 1.6};
    bvx_context_options const o = default_options();
    uint64_t seed = 7;
    (void)state;
    maker = context_with(&o);
    maker_star(&star, &seed, centre, radius, 0.05, 7, 9, 1024);
    view = maker_view(&star);
    stack_clear(&stack);
    for (int i = 0; i < 3; i++) { /* a hole, a branch, cells to subdivide */
        uint32_t const k = stack_section(&stack, 0.5 * i);
        stack_round(&stack, k, 0, 0, 2, 1, 24, 0.3, 0.1 * i, i & 1);
        if (i < 2) stack_round(&stack, k, 0, 0, 0.5, 0.3, 12, 0, 0, 0);
        stack_round(&stack, k, 2.6, 1.0, 0.2, 0.1, 8, 0, 0, 0);
    }
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    assert_int_equal(bvx_memory_used(maker), 0);
    bvx_context_destroy(maker);
    maker_free(&star);
    return 0;
}

enum { RUN_EXACT, RUN_TAPER, RUN_PAPER, RUN_LAYERS, RUN_FILES, RUN_SLICE, RUNS };

typedef struct section_run {
    int kind;
    uint64_t mark; /* of a good run */
    int wrong;
} section_run;

static bvx_status run_body(section_run *run, bvx_context *ctx, uint64_t *mark)
{
    bvx_sections_options o;
    bvx_mesh mesh = {0};
    bvx_sections_options_init(&o, sizeof o);
    o.grid[0] = 7;
    o.grid[1] = 5;
    if (run->kind == RUN_TAPER) o.caps = BVX_CAPS_TAPER;
    if (run->kind == RUN_PAPER) o.crossings = BVX_CROSSINGS_PAPER;
    if (run->kind == RUN_LAYERS) o.layers = 3;
    bvx_status status = bvx_build_sections(ctx, &stack.s, &o, &mesh);
    if (status != BVX_OK) run->wrong |= mesh.positions != NULL;
    else status = bvx_mesh_hash(ctx, &mesh, mark);
    bvx_mesh_free(ctx, &mesh);
    return status;
}

static bvx_status run_files(section_run *run, bvx_context *ctx, uint64_t *mark)
{
    static const int32_t formats[] = {BVX_FORMAT_CSL, BVX_FORMAT_CSV, BVX_FORMAT_SVG};
    bvx_status status = BVX_OK;
    for (int i = 0; i < 3 && status == BVX_OK; i++) {
        bvx_buffer file = {0};
        bvx_sections read;
        memset(&read, 0, sizeof read);
        status = bvx_write_sections(ctx, &stack.s, formats[i], &file);
        if (status == BVX_OK) *mark = bvx_hash(file.bytes, (size_t)file.size, *mark);
        bvx_read_sections_options o;
        bvx_read_sections_options_init(&o, sizeof o);
        if (status == BVX_OK && i < 2) status = bvx_read_sections(ctx, file.bytes, file.size, formats[i], &o, &read);
        if (status != BVX_OK) run->wrong |= read.points != NULL;
        bvx_sections_free(ctx, &read);
        bvx_buffer_free(ctx, &file);
    }
    return status;
}

static bvx_status run_slice(section_run *run, bvx_context *ctx, uint64_t *mark)
{
    bvx_slice_options o;
    bvx_sections cut;
    memset(&cut, 0, sizeof cut);
    bvx_slice_options_init(&o, sizeof o);
    o.spacing = 0.4;
    bvx_status const status = bvx_slice_mesh(ctx, &view, &o, &cut);
    if (status != BVX_OK) run->wrong |= cut.points != NULL;
    else *mark = bvx_hash(cut.points, (size_t)cut.point_count * 24, *mark);
    bvx_sections_free(ctx, &cut);
    return status;
}

static bvx_status run_sections(void *user, bvx_context *ctx)
{
    section_run *const run = user;
    uint64_t mark = 0;
    bvx_status const status = run->kind == RUN_FILES ? run_files(run, ctx, &mark) : run->kind == RUN_SLICE ? run_slice(run, ctx, &mark)
                                                                                                      : run_body(run, ctx, &mark);
    if (status == BVX_OK && run->mark != 0 && run->mark != mark) run->wrong |= 2;
    if (status == BVX_OK && run->mark == 0) run->mark = mark;
    return status;
}

static section_run run_of(int kind)
{
    section_run run = {kind, 0, 0};
    assert_int_equal(run_sections(&run, maker), BVX_OK);
    return run;
}

static void assert_run(const section_run *run, const char *wrong)
{
    if (wrong != NULL) fail_msg("run %d: %s", run->kind, wrong);
    if (run->wrong & 1) fail_msg("run %d: a failed call left a result", run->kind);
    if (run->wrong & 2) fail_msg("run %d: another result than usual", run->kind);
}

static void test_every_allocation_of_sections_fails_once(void **state)
{
    (void)state;
    for (int kind = 0; kind < RUNS; kind++) {
        bvx_context_options const o = default_options();
        section_run run = run_of(kind);
        uint64_t allocations = 0;
        assert_run(&run, fault_every_allocation(run_sections, &run, &o, &allocations));
        assert_true(allocations > 8);
    }
}

static void test_sections_cancel_at_every_progress_call(void **state)
{
    (void)state;
    for (int kind = 0; kind < RUNS; kind++) {
        bvx_context_options const o = default_options();
        section_run run = run_of(kind);
        uint64_t calls = 0;
        assert_run(&run, fault_every_cancel(run_sections, &run, &o, &calls));
        assert_true(calls >= 3);
    }
}

static void test_sections_under_every_memory_limit(void **state)
{
    bvx_context_options o = default_options();
    (void)state;
    o.threads = 1;
    for (int kind = 0; kind < RUNS; kind++) {
        section_run run = run_of(kind);
        assert_run(&run, fault_every_limit(run_sections, &run, &o, 60));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_sections_fails_once),
        cmocka_unit_test(test_sections_cancel_at_every_progress_call),
        cmocka_unit_test(test_sections_under_every_memory_limit),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
