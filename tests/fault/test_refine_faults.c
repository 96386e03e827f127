/* test_refine_faults.c - refinement and what octrees are asked, with every allocation failing once, cancelled
 * at every question, under every memory limit and in an arena. */
#include "context.h"
#include "tools/mesh_maker.h"

static bvx_context *maker;
static maker_mesh star;
static bvx_mesh_view view;
static bvx_lattice base;

static int make_inputs(void **state)
{
    static const double origin[3] = {0, 0, 0};
    static const double spacing[3] = {1, 1, 1};
    static const double centre[3] = {2, 2, 2};
    static const double radius[3] = {1.8, 1.5, 1.6};
    static const int32_t dims[3] = {4, 4, 4};
    bvx_context_options const o = default_options();
    uint64_t seed = 7;

    (void)state;
    maker = context_with(&o);
    maker_star(&star, &seed, centre, radius, 0.05, 7, 9, 1024);
    view = maker_view(&star);
    assert_int_equal(bvx_lattice_make(maker, origin, spacing, dims, &base), BVX_OK);
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

/* ---- one run: a tree from some start level, and all that can be made of it ---- */

enum { WITH_WINDOW = 10, WITH_TOLERANCE = 11 };

typedef struct refine_run {
    int32_t start; /* a start level, or one of the above */
    uint64_t mark; /* of a good run */
    int wrong;
} refine_run;

static bvx_status extract_tree(bvx_context *ctx, const bvx_octree *tree, uint64_t *mark)
{
    bvx_mesh mesh = {0};
    bvx_status const status = bvx_extract_octree(ctx, tree, 0, NULL, &mesh);
    uint64_t hash = 0;
    if (status == BVX_OK) assert_int_equal(bvx_mesh_hash(ctx, &mesh, &hash), BVX_OK);
    bvx_mesh_free(ctx, &mesh);
    *mark ^= hash;
    return status;
}

/* As a file and back: the tree's other file is the mark's again. */
static bvx_status store_tree(bvx_context *ctx, const bvx_octree *tree, uint64_t *mark)
{
    bvx_buffer file = {0}, again = {0};
    bvx_octree *back = NULL;
    bvx_status status = bvx_write_octree(ctx, tree, 0, BVX_FORMAT_BVX, &file);

    if (status == BVX_OK) status = bvx_read_octree(ctx, file.bytes, file.size, &back);
    if (status == BVX_OK) status = bvx_write_octree(ctx, back, 0, BVX_FORMAT_BVX, &again);
    if (status == BVX_OK) {
        assert_int_equal(again.size, file.size);
        assert_memory_equal(again.bytes, file.bytes, (size_t)file.size);
        *mark = bvx_hash(file.bytes, (size_t)file.size, *mark);
    }
    bvx_octree_free(ctx, back);
    bvx_buffer_free(ctx, &again);
    bvx_buffer_free(ctx, &file);
    return status;
}

/* Everything that can be asked of a tree: these allocate nothing, but they report progress. */
static bvx_status ask_tree(bvx_context *ctx, const bvx_octree *tree, uint64_t *mark)
{
    static const double rays[12] = {-9, 0.1, 0.2, 1, 0.01, 0.02, 0.3, 9, 0.1, 0.02, -1, 0.03};
    static const int32_t voxels[6] = {0, 0, 0, 5, 6, 7};
    int32_t const levels = bvx_octree_levels(tree);
    bvx_octree_leaf leaf[2];
    bvx_octree_hit hit[2];
    bvx_octree_level level[8];
    bvx_lattice lattice;
    uint64_t leaves = 0, beside = 0;
    bvx_status status = bvx_octree_at(ctx, tree, voxels, 2, leaf);

    if (status == BVX_OK) status = bvx_octree_neighbours(ctx, tree, &leaf[0], 3, NULL, 0, &beside);
    if (status == BVX_OK) status = bvx_octree_find(ctx, tree, rays, 2, leaf);
    if (status == BVX_OK) status = bvx_octree_cast(ctx, tree, 0, rays, 2, 1e9, hit);
    if (status == BVX_OK) status = bvx_octree_leaves(ctx, tree, 0, NULL, 0, &leaves);
    if (status == BVX_OK) status = bvx_octree_count(ctx, tree, level, 8);
    if (status == BVX_OK) status = bvx_octree_lattice(ctx, tree, levels, &lattice);
    if (status == BVX_OK)
        *mark += leaves + 3 * beside + 5 * (uint64_t)hit[0].hit + 7 * level[levels].surface +
                 (uint64_t)lattice.dims[0];
    return status;
}

static bvx_status use_tree(bvx_context *ctx, const bvx_octree *tree, uint64_t *mark)
{
    bvx_grid grid = {0};
    bvx_buffer file = {0};
    bvx_window const window = {{3, 5, 1}, {20, 9, 25}};
    bvx_status status = bvx_octree_expand(ctx, tree, 4, 0, &window, &grid);

    if (status == BVX_OK) status = bvx_grid_hash(ctx, &grid, mark);
    if (status == BVX_OK) {
        uint64_t set = 0;
        status = bvx_grid_count(ctx, &grid, &set);
        *mark += set;
    }
    bvx_grid_free(ctx, &grid);
    if (status != BVX_OK) return status;
    status = bvx_write_octree(ctx, tree, 0, BVX_FORMAT_VTU, &file);
    if (status == BVX_OK) *mark = bvx_hash(file.bytes, (size_t)file.size, *mark);
    bvx_buffer_free(ctx, &file);
    if (status == BVX_OK) status = store_tree(ctx, tree, mark);
    if (status == BVX_OK) status = ask_tree(ctx, tree, mark);
    return status != BVX_OK ? status : extract_tree(ctx, tree, mark);
}

static bvx_status run_refine(void *user, bvx_context *ctx)
{
    refine_run *const run = user;
    bvx_octree *tree = NULL;
    bvx_refine_options o = {.struct_size = sizeof o};
    uint64_t mark = 0;

    o.levels = 4;
    if (run->start < WITH_WINDOW) o.start_level = run->start > 0 ? run->start : BVX_NONE;
    if (run->start == WITH_TOLERANCE) o.tolerance = 0.05;
    if (run->start == WITH_WINDOW) {
        bvx_window const window = {{10, 20, 30}, {17, 9, 20}};
        o.window = window;
        o.outer_levels = 2;
    }
    bvx_refine_options chosen = o;
    bvx_lattice lattice;
    bvx_status status = bvx_refine_choose(ctx, &view, 64, &chosen, &lattice);
    if (status == BVX_OK) status = bvx_refine(ctx, &view, &base, &o, &tree);
    if (status != BVX_OK) {
        run->wrong |= tree != NULL;
        return status;
    }
    status = use_tree(ctx, tree, &mark);
    bvx_octree_free(ctx, tree);
    if (status == BVX_OK && run->mark != 0 && run->mark != mark) run->wrong |= 2;
    if (status == BVX_OK && run->mark == 0) run->mark = mark;
    return status;
}

static refine_run run_of(int32_t start)
{
    refine_run run = {start, 0, 0};
    assert_int_equal(run_refine(&run, maker), BVX_OK);
    return run;
}

static void assert_run(const refine_run *run, const char *wrong)
{
    if (wrong != NULL) fail_msg("start %d: %s", (int)run->start, wrong);
    if (run->wrong & 1) fail_msg("start %d: a failed call left a tree", (int)run->start);
    if (run->wrong & 2) fail_msg("start %d: another tree than usual", (int)run->start);
}

/* One start stands for the others on several threads; two do where tests are to be quick. */
static int is_left_out(int32_t threads, int32_t start)
{
    return threads > 1 ? start != 2 : getenv("BVX_QUICK") != NULL && start != 2 && start != WITH_WINDOW;
}

/* ---- tests ---- */

static void test_every_allocation_of_refinement_fails_once(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2)
        for (int32_t start = 0; start <= WITH_TOLERANCE; start += start == 4             ? 6
                                                                  : start == WITH_WINDOW ? 1
                                                                                         : 2) {
            bvx_context_options o = default_options();
            if (is_left_out(threads, start)) continue;
            refine_run run = run_of(start);
            uint64_t allocations = 0;
            o.threads = threads;
            assert_run(&run, fault_every_allocation(run_refine, &run, &o, &allocations));
            assert_true(allocations > 20);
        }
}

static void test_refinement_cancels_at_every_progress_call(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2)
        for (int32_t start = 0; start <= WITH_TOLERANCE; start += start == 4             ? 6
                                                                  : start == WITH_WINDOW ? 1
                                                                                         : 2) {
            bvx_context_options o = default_options();
            if (is_left_out(threads, start)) continue;
            refine_run run = run_of(start);
            uint64_t calls = 0;
            o.threads = threads;
            assert_run(&run, fault_every_cancel(run_refine, &run, &o, &calls));
            assert_true(calls > 5);
        }
}

static void test_refinement_under_every_memory_limit(void **state)
{
    enum { STEPS = 60 };
    (void)state;
    for (int32_t start = -1; start <= 2; start++) {
        refine_run run = run_of(start);
        uint64_t need;
        bvx_memory_reset_peak(maker);
        assert_int_equal(run_refine(&run, maker), BVX_OK);
        need = bvx_memory_peak(maker);
        for (uint64_t n = 0; n <= STEPS; n++) {
            fault_heap heap = {0};
            bvx_context_options const plain = default_options();
            bvx_context_options o = fault_options(&plain, &heap);
            bvx_context *ctx;
            o.memory_limit = n == STEPS ? need : 1 + (need - 2) * n / (STEPS - 1);
            o.threads = bvx_context_threads(maker);
            ctx = context_with(&o);
            bvx_status const status = run_refine(&run, ctx);
            if (n == STEPS) assert_int_equal(status, BVX_OK);
            else
                assert_true(status == BVX_ERR_BUDGET ||
                            (status == BVX_OK && start == -1)); /* -1 can do with less */
            assert_int_equal(bvx_memory_used(ctx), 0);
            assert_true(bvx_memory_peak(ctx) <= o.memory_limit);
            bvx_context_destroy(ctx);
            assert_run(&run, fault_end(&heap));
        }
    }
}

static void test_refinement_lives_in_an_arena(void **state)
{
    bvx_context_options o = default_options();
    (void)state;
    o.threads = 1;
    for (int32_t start = 0; start <= 4; start += 2) {
        refine_run run = run_of(start);
        assert_run(&run, fault_every_arena(run_refine, &run, &o, 1 << 23, 30));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_refinement_fails_once),
        cmocka_unit_test(test_refinement_cancels_at_every_progress_call),
        cmocka_unit_test(test_refinement_under_every_memory_limit),
        cmocka_unit_test(test_refinement_lives_in_an_arena),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
