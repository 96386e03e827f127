/* test_simplify_cells.c - meshes that are large enough for cells of space to
 * collapse on their own: the same bytes for every number of threads and every
 * order of the cells, the guarantee, and thin walls that cells share with others. */
#include "levels_support.h"

enum { MOST_THREADS = 7 };

/* A closed body of rings * segments * 2 triangles, nearly. */
static void make_star(int32_t rings, int32_t segments, double jitter)
{
    static const double centre[3] = {1, 2, 3}, radius[3] = {4, 3, 2};
    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, radius, jitter, rings, segments, 1 << 20);
}

/* A hollow body with a wall much thinner than the levels' triangles are long. */
static void make_hollow(int32_t rings, int32_t segments)
{
    static const double centre[3] = {1, 2, 3}, outer[3] = {4, 3, 2}, inner[3] = {3.98, 2.98, 1.98};
    size_t first;
    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, outer, 0, rings, segments, 1 << 20);
    first = mesh.triangles;
    maker_star(&mesh, &seed, centre, inner, 0, rings, segments, 1 << 20);
    maker_flip(&mesh, first, mesh.triangles);
}

static bvx_simplify_options options_for(const uint64_t *targets)
{
    bvx_simplify_options o = {.struct_size = sizeof o};
    o.targets.triangles = targets;
    o.reports = report;
    return o;
}

static void simplify(bvx_context *context, const bvx_simplify_options *o, uint64_t count, bvx_mesh *levels)
{
    bvx_mesh_view const view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_simplify(context, &view, o, count, levels),
                                    bvx_last_message(context));
}

static void check_levels(const uint64_t *targets, uint64_t count, uint64_t pieces)
{
    for (uint64_t i = 0; i < count; i++) {
        const bvx_certificate *const c = &report[i].certificate;
        snprintf(where, sizeof where, "level %d of %d triangles", (int)i, (int)level[i].triangle_count);
        TEST_ASSERT_TRUE_MESSAGE(c->closed && c->edge_manifold && c->vertex_manifold && c->oriented, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(pieces, c->components, where);
        TEST_ASSERT_EQUAL_INT64_MESSAGE(2 * (int64_t)pieces, c->euler, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, report[i].crossings, where);
        TEST_ASSERT_TRUE_MESSAGE(report[i].met && level[i].triangle_count <= targets[i], where);
    }
}

static void test_cells_keep_the_guarantee(void)
{
    static const uint64_t targets[3] = {9000, 2000, 500};
    bvx_simplify_options const o = options_for(targets);

    for (int k = 0; k < (quick ? 1 : 3); k++) {
        make_star(100 + 20 * k, 160 + 10 * k, 0.002 * k);
        drop_levels();
        simplify(ctx, &o, 3, level);
        check_levels(targets, 3, 1);
    }
}

static void test_thin_walls_do_not_cross(void)
{
    static const uint64_t targets[2] = {8000, 3000};
    bvx_simplify_options const o = options_for(targets);
    make_hollow(100, 130);
    simplify(ctx, &o, 2, level);
    check_levels(targets, 2, 2);
}

/* The same level from meshes whose triangles and vertices come in any order. */
static void test_cells_do_not_see_the_order_of_the_input(void)
{
    static const uint64_t target = 6000;
    bvx_simplify_options const o = options_for(&target);

    make_star(110, 140, 0.002);
    simplify(ctx, &o, 1, &level[0]);
    maker_shuffle_triangles(&mesh, &seed);
    simplify(ctx, &o, 1, &level[1]);
    snprintf(where, sizeof where, "shuffled");
    assert_same_bytes(&level[0], &level[1]);
}

/* ---- Borders ---- */

/* Without the triangles near many points of a star: borders in every cell,
 * some of one triangle's length, some of many. */
static void make_open(int32_t rings, int32_t segments)
{
    size_t kept = 0;

    make_star(rings, segments, 0.002);
    for (size_t t = 0; t < mesh.triangles; t++) {
        const double *const p = mesh.p + 3 * mesh.t[3 * t];
        double const x = p[0] * 2 - floor(p[0] * 2), y = p[1] * 2 - floor(p[1] * 2);
        if (x * x + y * y < 0.1 || t % 977 == 0) continue;
        memmove(mesh.t + 3 * kept++, mesh.t + 3 * t, 3 * sizeof *mesh.t);
    }
    mesh.triangles = kept;
}

/* Borders, pieces and handles stay as they are in the mesh whose triangles all stay. */
static void test_open_meshes_keep_borders_in_cells(void)
{
    static const uint64_t targets[3] = {UINT64_MAX / 3 + 1, 8000, 4000};
    bvx_simplify_options const o = options_for(targets);
    const bvx_certificate *const before = &report[0].certificate;

    make_open(120, 160);
    simplify(ctx, &o, 3, level);
    TEST_ASSERT_TRUE(before->triangles > 24000 && before->boundary_edges > 1000);
    for (int i = 0; i < 3; i++) {
        const bvx_certificate *const c = &report[i].certificate;
        snprintf(where, sizeof where, "level %d of %d triangles, %d border edges", i,
                 (int)level[i].triangle_count, (int)c->boundary_edges);
        TEST_ASSERT_TRUE_MESSAGE(c->edge_manifold && c->vertex_manifold && c->oriented && report[i].met,
                                 where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(before->components, c->components, where);
        TEST_ASSERT_EQUAL_INT64_MESSAGE(before->euler, c->euler, where);
        TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, report[i].crossings, where);
    }
    TEST_ASSERT_TRUE_MESSAGE(report[2].certificate.boundary_edges < before->boundary_edges / 2, where);
}

/* ---- Threads ---- */

typedef struct backwards {
    int32_t threads;
    int64_t tasks;
} backwards;

/* Runs the last task first, each with another worker's memory. */
static void run_backwards(void *user, int32_t count, bvx_task_fn *task, void *task_user)
{
    backwards *const b = user;
    for (int32_t i = count; i-- > 0;) task(task_user, i, i % b->threads);
    b->tasks += count;
}

/* One level on a context of its own, which must be the same as another; returns how many tasks ran
 * backwards. */
static int64_t simplify_on(int32_t threads, int backward, uint64_t target, const bvx_mesh *same)
{
    backwards b = {threads, 0};
    bvx_mesh made = {0};
    bvx_context_options c = {.struct_size = sizeof c};
    bvx_context *other;
    bvx_simplify_options o = {.struct_size = sizeof o};

    c.threads = threads;
    if (backward) {
        c.parallel.call = run_backwards;
        c.parallel.user = &b;
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &other));
    o.targets.triangles = &target;
    simplify(other, &o, 1, &made);
    if (same != NULL) assert_same_bytes(same, &made);
    bvx_mesh_free(other, &made);
    bvx_context_destroy(other);
    return b.tasks;
}

static void test_threads_and_the_order_of_cells_do_not_matter(void)
{
    static const uint64_t target = 6000;
    bvx_simplify_options const o = options_for(&target);

    for (int open = 0; open < 2; open++) {
        if (open) make_open(100, 150);
        else make_hollow(100, 120);
        drop_levels();
        simplify(ctx, &o, 1, &level[0]);
        for (int32_t threads = 2; threads <= MOST_THREADS; threads += threads == 2 ? 1 : 4)
            for (int backward = 0; backward < 2; backward++) {
                snprintf(where, sizeof where, "%d threads, backwards %d, open %d", (int)threads, backward,
                         open);
                simplify_on(threads, backward, target, &level[0]);
            }
    }
}

/* Errors are kept by levels that cells lead to, and no larger level keeps
 * less: the same for every number of threads. */
static void test_levels_by_error_run_cells(void)
{
    static const double errors[2] = {0.02, 0.1};
    bvx_mesh one[2] = {{0}};
    bvx_mesh_view view;

    make_star(130, 160, 0);
    view = maker_view(&mesh);
    for (int32_t threads = 1; threads <= 8; threads += threads < 3 ? 1 : 5) {
        backwards b = {threads, 0};
        bvx_context_options c = {.struct_size = sizeof c};
        bvx_context *other;
        bvx_simplify_options o = {.struct_size = sizeof o};
        c.threads = threads;
        if (threads > 1) {
            c.parallel.call = run_backwards;
            c.parallel.user = &b;
        }
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &other));
        o.targets.errors = errors;
        o.targets.samples = 2000;
        o.reports = report;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(other, &view, &o, 2, one));
        for (int i = 0; i < 2; i++) {
            snprintf(where, sizeof where, "%d threads, level %d of %d triangles, error %g", (int)threads, i,
                     (int)one[i].triangle_count, report[i].distance.mean);
            TEST_ASSERT_TRUE_MESSAGE(report[i].met && report[i].distance.mean <= errors[i] &&
                                         report[i].distance.mean > 0.5 * errors[i],
                                     where);
            TEST_ASSERT_TRUE_MESSAGE(report[i].crossings == 0 && report[i].certificate.closed &&
                                         one[i].triangle_count < 3000,
                                     where);
            if (threads == 1 && i == 0)
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_simplify(ctx, &view, &o, 2, level));
            assert_same_bytes(&level[i], &one[i]);
            bvx_mesh_free(other, &one[i]);
        }
        bvx_context_destroy(other);
    }
}

/* Without this the tests above would hold for a collapse that has no cells. */
static void test_large_meshes_run_cells_and_small_ones_do_not(void)
{
    int64_t small, large;

    make_star(80, 110, 0);
    small = simplify_on(2, 1, 2000, NULL);
    make_star(120, 150, 0);
    large = simplify_on(2, 1, 2000, NULL);
    TEST_ASSERT_TRUE(large >= small + 8);
    make_open(120, 150);
    large = simplify_on(2, 1, 2000, NULL);
    TEST_ASSERT_TRUE(large >= small + 8);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_cells_keep_the_guarantee);
    RUN_TEST(test_thin_walls_do_not_cross);
    RUN_TEST(test_cells_do_not_see_the_order_of_the_input);
    RUN_TEST(test_open_meshes_keep_borders_in_cells);
    RUN_TEST(test_threads_and_the_order_of_cells_do_not_matter);
    RUN_TEST(test_levels_by_error_run_cells);
    RUN_TEST(test_large_meshes_run_cells_and_small_ones_do_not);
    return UNITY_END();
}
