/* test_section_faults.c - bodies from sections, contour files and contours of meshes, with every allocation
 * failing once, cancelled at every question, and under every memory limit. */
#include "context.h"
#include "tools/section_maker.h"

static bvx_context *maker;
static section_maker stack, tall, walls, crossed, oblique, handled, lone, touching;
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
    stack_clear(&tall);
    for (int i = 0; i < 5; i++) /* from five sections on by the cubic */
        stack_round(&tall, stack_section(&tall, 0.5 * i), 0.1 * i * i, 0, 2, 1, 12, 0, 0, 0);
    stack_clear(&walls);
    for (int i = 0; i < 2; i++) { /* levels that cross in coarse cells */
        uint32_t const k = stack_section(&walls, 0.5 * i);
        stack_round(&walls, k, 0.4 * i, 0, 2, 2, 24, 0, 0, 0);
        stack_round(&walls, k, 0.4 * i, 0, 1.99, 1.99, 24, 0, 0, 0);
    }
    stack_clear(&crossed);
    for (int i = 0; i < 2; i++) { /* a keyhole, and two loops that cross */
        static const double keyhole[] = {0, 0, 4, 0, 4, 4, 0, 4, 0, 2, 1, 2,
                                         1, 3, 3, 3, 3, 1, 1, 1, 1, 2, 0, 2};
        uint32_t const k = stack_section(&crossed, 0.5 * i);
        stack_loop(&crossed, k);
        for (int p = 0; p < 24; p += 2) stack_point(&crossed, keyhole[p], keyhole[p + 1]);
        stack_round(&crossed, k, 7, 2, 1, 1, 12, 0, 0, 0);
        stack_round(&crossed, k, 8, 2, 1, 1, 12, 0, 0, 0);
    }
    stack_clear(&lone);
    stack_round(&lone, stack_section(&lone, 1.0), 0, 0, 2, 1, 16, 0.3, 0, 0);
    stack_round(&lone, 0, 0, 0, 0.5, 0.3, 8, 0, 0, 0);
    stack_clear(&touching);
    for (int i = 0; i < 2; i++) { /* half discs that touch */
        uint32_t const k = stack_section(&touching, 0.5 * i);
        for (int label = 1; label <= 2; label++) {
            stack_loop(&touching, k);
            touching.loop[touching.s.loop_count - 1].label = label;
            for (int p = 0; p < 5; p++) {
                double x, y;
                stack_circle(label == 2 ? 0.5 + p / 8.0 : p / 8.0, &x, &y);
                stack_point(&touching, x, y);
            }
        }
    }
    /* A ball with a handle between its planes, which is cut. */
    stack_oblique(&handled);
    seed = 6;
    for (int i = 0; i < 5; i++)
        stack_ball_cut(&handled, stack_any_plane(&handled, &seed, 0.85), 0, 0, 0, 1.0, 10);
    stack_oblique(&oblique);
    for (int i = 0; i < 3; i++)
        stack_ball_cut(&oblique, stack_plane(&oblique, i == 0, i == 1, 0.3 + 0.2 * i, 0.1 * i), 0, 0, 0, 1.0,
                       9);
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

enum {
    RUN_EXACT,
    RUN_TAPER,
    RUN_PAPER,
    RUN_CUBIC,
    RUN_JOINED,
    RUN_MENDED,
    RUN_OBLIQUE,
    RUN_HANDLED,
    RUN_SLAB,
    RUN_LENS,
    RUN_FILES,
    RUN_SLICE,
    RUN_BODIES,
    RUNS
};

typedef struct section_run {
    int kind;
    uint64_t mark; /* of a good run */
    int wrong;
} section_run;

static bvx_status run_body(section_run *run, bvx_context *ctx, uint64_t *mark)
{
    bvx_sections_options o = {.struct_size = sizeof o};
    bvx_sections_report report;
    bvx_mesh mesh = {0};

    o.slabs.grid[0] = 7;
    o.slabs.grid[1] = 5;
    o.cells = 8;
    o.agree = 0.5;
    if (run->kind == RUN_TAPER || run->kind == RUN_LENS) o.caps = BVX_CAPS_TAPER;
    if (run->kind == RUN_PAPER) o.slabs.crossings = BVX_CROSSINGS_PAPER;
    if (run->kind == RUN_SLAB || run->kind == RUN_LENS) o.thickness = 0.5;
    o.report = &report;
    o.mend = run->kind == RUN_MENDED;
    bvx_status status = bvx_build_sections(ctx,
                                           run->kind == RUN_JOINED    ? &walls.s
                                           : run->kind == RUN_CUBIC   ? &tall.s
                                           : run->kind == RUN_OBLIQUE ? &oblique.s
                                           : run->kind == RUN_HANDLED ? &handled.s
                                           : o.thickness > 0.0        ? &lone.s
                                           : o.mend                   ? &crossed.s
                                                                      : &stack.s,
                                           &o, &mesh);
    if (status == BVX_OK && report.mended_loops != (o.mend ? 6u : 0u)) run->wrong |= 4;
    if (status == BVX_OK && (report.joined_slabs == 1) != (run->kind == RUN_JOINED)) run->wrong |= 4;
    if (status != BVX_OK) run->wrong |= mesh.positions != NULL;
    else status = bvx_mesh_hash(ctx, &mesh, mark);
    bvx_mesh_free(ctx, &mesh);
    return status;
}

static bvx_status run_bodies(section_run *run, bvx_context *ctx, uint64_t *mark)
{
    static const int32_t labels[2] = {2, 1};
    bvx_sections_options o = {.struct_size = sizeof o};
    bvx_mesh made[2] = {0};

    o.cells = 8;
    bvx_status const built = bvx_build_bodies(ctx, &touching.s, &o, labels, 2, made);
    bvx_status status = built;
    for (int i = 0; i < 2; i++) {
        uint64_t hash = 0;
        if (built != BVX_OK) run->wrong |= made[i].positions != NULL;
        if (status == BVX_OK) status = bvx_mesh_hash(ctx, &made[i], &hash);
        *mark = *mark * 31 + hash;
    }
    for (int i = 0; i < 2; i++) bvx_mesh_free(ctx, &made[i]);
    return status;
}

static bvx_status run_files(section_run *run, bvx_context *ctx, uint64_t *mark)
{
    static const int32_t formats[] = {BVX_FORMAT_CSL, BVX_FORMAT_CSV, BVX_FORMAT_CSL, BVX_FORMAT_CSV};
    bvx_status status = BVX_OK;

    for (int i = 0; i < 4 && status == BVX_OK; i++) {
        bvx_buffer file = {0};
        bvx_sections read;
        memset(&read, 0, sizeof read);
        status = bvx_write_sections(ctx, i >= 2 ? &oblique.s : &stack.s, formats[i], &file);
        if (status == BVX_OK) *mark = bvx_hash(file.bytes, (size_t)file.size, *mark);
        bvx_read_sections_options o = {.struct_size = sizeof o};
        if (status == BVX_OK) status = bvx_read_sections(ctx, file.bytes, file.size, formats[i], &o, &read);
        if (status != BVX_OK) run->wrong |= read.points != NULL;
        bvx_sections_free(ctx, &read);
        bvx_buffer_free(ctx, &file);
    }
    return status;
}

static bvx_status run_slice(section_run *run, bvx_context *ctx, uint64_t *mark)
{
    bvx_slice_options o = {.struct_size = sizeof o};
    bvx_sections cut;

    memset(&cut, 0, sizeof cut);
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
    bvx_status const status = run->kind == RUN_FILES    ? run_files(run, ctx, &mark)
                              : run->kind == RUN_SLICE  ? run_slice(run, ctx, &mark)
                              : run->kind == RUN_BODIES ? run_bodies(run, ctx, &mark)
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
    if (run->wrong & 4) fail_msg("run %d: levels cross, or loops are mended, in another stack", run->kind);
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

/* Six times the volume inside. */
static double volume_of(const bvx_mesh *m)
{
    const double *const p = m->positions;
    double v = 0;

    for (uint64_t t = 0; t < m->triangle_count; t++) {
        const double *const a = p + 3 * (size_t)m->triangles[3 * t];
        const double *const b = p + 3 * (size_t)m->triangles[3 * t + 1];
        const double *const c = p + 3 * (size_t)m->triangles[3 * t + 2];
        v += a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) +
             a[2] * (b[0] * c[1] - b[1] * c[0]);
    }
    return v;
}

typedef struct close_points {
    section_maker stack;
    double volume; /* of the last run that went well */
} close_points;

static bvx_status run_close_points(void *user, bvx_context *ctx)
{
    close_points *const run = user;
    bvx_sections_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = {0};
    bvx_status status;

    o.slabs.grid[0] = 6;
    o.slabs.grid[1] = 5;
    status = bvx_build_sections(ctx, &run->stack.s, &o, &mesh);
    if (status == BVX_OK) {
        run->volume = volume_of(&mesh);
        bvx_mesh_free(ctx, &mesh);
    }
    return status;
}

/* A square whose corners are each count points that lie closer together than the fixed point tells apart;
 * from: which of a corner's points the loop begins with, so that the run of them goes over its end. */
static void put_close_square(section_maker *m, uint32_t section, int count, int from)
{
    static const double corner[4][2] = {{0, 0}, {3, 0}, {3, 2}, {0, 2}};
    stack_loop(m, section);
    for (int i = 0; i < 4 * count; i++) {
        int const k = (i + from) % (4 * count);
        double const away = (k % count) * 1e-13;
        stack_point(m, corner[k / count][0] + away, corner[k / count][1] + away);
    }
}

/* Three such squares, one above the other, are a box of 3 x 2 x 2, whichever points they begin with. */
static void test_points_that_snap_to_one_place(void **state)
{
    static close_points run;

    (void)state;
    for (int count = 1; count <= 3; count++)
        for (int from = 0; from < count; from++) {
            bvx_context_options const o = default_options();
            stack_clear(&run.stack);
            for (int i = 0; i < 3; i++)
                put_close_square(&run.stack, stack_section(&run.stack, i), count, from);
            assert_int_equal(run_close_points(&run, maker), BVX_OK);
            assert_true(run.volume > 72 - 1e-9 && run.volume < 72 + 1e-9);
            assert_null(fault_every_allocation(run_close_points, &run, &o, NULL));
        }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_sections_fails_once),
        cmocka_unit_test(test_sections_cancel_at_every_progress_call),
        cmocka_unit_test(test_sections_under_every_memory_limit),
        cmocka_unit_test(test_points_that_snap_to_one_place),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
