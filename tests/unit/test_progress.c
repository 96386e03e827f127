/* test_progress.c - what a progress callback sees: for every public function one fraction that rises to 1,
 * reached by those that succeed only; works within each other share it. */
#include "unity.h"

#include "core/core.h"
#include "call_table.h"

#include <stdio.h>
#include <stdlib.h>
#include <math.h>

void setUp(void)
{
}
void tearDown(void)
{
}

/* What one call reported. */
typedef struct record {
    double last;
    int32_t calls, ends, falls, outside;
    int32_t stop_at; /* the call that asks to stop; 0: none */
    int32_t unnamed;
} record;

static int32_t note_progress(void *user, const char *stage, double fraction)
{
    record *const r = user;

    if (r->calls != 0 && fraction < r->last) r->falls++;
    if (!(fraction >= 0.0 && fraction <= 1.0)) r->outside++;
    if (stage == NULL || stage[0] == 0) r->unnamed++;
    if (fraction >= 1.0) r->ends++;
    r->last = fraction;
    r->calls++;
    return r->calls == r->stop_at;
}

static bvx_context *watched_context(record *r, int32_t threads)
{
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_context *ctx = NULL;

    o.threads = threads;
    o.progress.call = note_progress;
    o.progress.user = r;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
    return ctx;
}

/* NULL, or what is wrong with the reports of a call that succeeded. */
static const char *wrong_rise(const record *r)
{
    if (r->falls != 0) return "reports a fraction that falls";
    if (r->outside != 0) return "reports a fraction outside of 0 to 1";
    if (r->unnamed != 0) return "reports a stage without a name";
    if (r->ends != 1) return r->ends == 0 ? "does not report 1" : "reports 1 more than once";
    return r->last == 1.0 ? NULL : "reports something after 1";
}

/* ---- the functions that the table of wrong calls does not have ---- */

static bvx_buffer ply, packed_tree;
static bvx_closest *finder;
static bvx_rays *caster;

static bvx_status read_points(const world *w)
{
    return bvx_read_points(w->ctx, ply.bytes, ply.size, BVX_FORMAT_PLY, (bvx_mesh *)w->out);
}
static bvx_status read_octree(const world *w)
{
    return bvx_read_octree(w->ctx, packed_tree.bytes, packed_tree.size, (bvx_octree **)w->out);
}
static bvx_status closest_find(const world *w)
{
    return bvx_closest_find(w->ctx, finder, a_point, 1, (bvx_closest_point *)w->out);
}
static bvx_status rays_update(const world *w)
{
    return bvx_rays_update(w->ctx, caster, w->out != NULL ? w->grid : NULL, NULL);
}
static bvx_status rays_cast(const world *w)
{
    return bvx_rays_cast(w->ctx, caster, a_ray, 1, 100, (bvx_ray_hit *)w->out);
}

static const call more_calls[] = {
    CALL(read_points, 0, TO_MESH), CALL(read_octree, 0, TO_TREE), CALL(closest_find, 0, PLAIN),
    CALL(rays_update, 0, PLAIN),   CALL(rays_cast, 0, PLAIN),
};
enum { MORE_CALLS = sizeof more_calls / sizeof more_calls[0] };

static const call *call_at(int i)
{
    return i < CALLS ? &calls[i] : &more_calls[i - CALLS];
}

static int is_silent(const call *c)
{
    static const char *const silent[] = {"bvx_lattice_make", "bvx_grid_create", "bvx_octree_lattice",
                                         "bvx_octree_neighbours"};

    for (size_t i = 0; i < sizeof silent / sizeof silent[0]; i++)
        if (strcmp(c->name, silent[i]) == 0) return 1;
    return 0;
}

static void make_files(bvx_context *ctx)
{
    make_world(ctx);
    MADE(bvx_write_mesh(ctx, &body, 1, NULL, BVX_FORMAT_PLY, &ply));
    MADE(bvx_write_octree(ctx, tree, 0, BVX_FORMAT_BVX, &packed_tree));
    MADE(bvx_closest_create(ctx, &mesh, &finder));
    MADE(bvx_rays_create(ctx, &solid, &caster));
}

static void free_files(bvx_context *ctx)
{
    bvx_buffer_free(ctx, &ply);
    bvx_buffer_free(ctx, &packed_tree);
    bvx_closest_free(ctx, finder);
    bvx_rays_free(ctx, caster);
    free_world(ctx);
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
    bvx_context_destroy(ctx);
}

static bvx_status make_call(const call *c, bvx_context *ctx)
{
    world const w = right_world(ctx);
    bvx_status status;

    memset(&out, 0, sizeof out);
    memset(second, 0, sizeof second);
    status = c->make(&w);
    if (status == BVX_OK) free_result(ctx, c->to);
    return status;
}

/* One context for all calls, so that each begins where another has ended. */
static void test_every_call_rises_once_to_1(void)
{
    int wrong = 0;

    for (int32_t threads = 1; threads <= 3; threads += 2) {
        record r = {0};
        bvx_context *const ctx = watched_context(&r, threads);

        make_files(ctx);
        for (int i = 0; i < CALLS + MORE_CALLS; i++) {
            const call *const c = call_at(i);
            const char *what;

            memset(&r, 0, sizeof r);
            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, make_call(c, ctx), c->name);
            what = is_silent(c) ? (r.calls != 0 ? "reports" : NULL) : wrong_rise(&r);
            if (what == NULL) continue;
            printf("%s %s\n", c->name, what);
            wrong++;
        }
        free_files(ctx);
    }
    TEST_ASSERT_EQUAL_INT(0, wrong);
}

/* Stopped at each report in turn: no 1 then, nothing after the stop, and the next call begins anew; at the
 * report of 1 all is done, and the answer changes nothing. */
/* The first ones and the last, and with BITVOX_LARGE each. */
static int32_t next_stop(int32_t stop, int32_t reports)
{
    int32_t const next = stop + 1 + (getenv("BITVOX_LARGE") != NULL ? 0 : stop / 4);
    return stop < reports && next > reports ? reports : next;
}

static void test_a_cancelled_call_does_not_reach_1(void)
{
    record r = {0};
    bvx_context *const ctx = watched_context(&r, 1);
    int wrong = 0, stops = 0;

    make_files(ctx);
    for (int i = 0; i < CALLS + MORE_CALLS; i++) {
        const call *const c = call_at(i);
        int32_t reports;

        if (is_silent(c)) continue;
        memset(&r, 0, sizeof r);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, make_call(c, ctx));
        reports = r.calls;
        for (int32_t stop = 1; stop <= reports; stop = next_stop(stop, reports)) {
            int const last = stop == reports;
            bvx_status status;
            const char *what = NULL;

            memset(&r, 0, sizeof r);
            r.stop_at = stop;
            status = make_call(c, ctx);
            if (status != (last ? BVX_OK : BVX_CANCELLED)) what = "gives another status when it is stopped";
            else if (r.calls != stop) what = "reports after it was stopped";
            else if (r.ends != last) what = "reports 1 though it was stopped";
            if (what == NULL) {
                memset(&r, 0, sizeof r);
                status = make_call(c, ctx);
                if (status != BVX_OK || r.calls != reports) what = "does not begin anew after it was stopped";
                else what = wrong_rise(&r);
            }
            stops += !last;
            if (what == NULL) continue;
            printf("%s %s (at report %d of %d)\n", c->name, what, (int)stop, (int)reports);
            wrong++;
        }
    }
    free_files(ctx);
    TEST_ASSERT_EQUAL_INT(0, wrong);
    TEST_ASSERT_GREATER_THAN_INT(200, stops);
}

static void test_a_refused_call_does_not_reach_1(void)
{
    record r = {0};
    bvx_context *const ctx = watched_context(&r, 1);

    make_files(ctx);
    for (int i = 0; i < CALLS + MORE_CALLS; i++) {
        const call *const c = call_at(i);
        world w = right_world(ctx);

        if (c->takes & SLOT || c->make == read_sections) continue; /* may be without a result */
        memset(&out, 0, sizeof out);
        memset(&r, 0, sizeof r);
        w.out = NULL;
        TEST_ASSERT_TRUE_MESSAGE(c->make(&w) != BVX_OK, c->name);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(0, r.ends, c->name);
    }
    free_files(ctx);
}

/* ---- shares ---- */

static double seen[64];
static int seen_count;

static int32_t note_fraction(void *user, const char *stage, double fraction)
{
    (void)user, (void)stage;
    if (seen_count < 64) seen[seen_count++] = fraction;
    return 0;
}

static bvx_status report(bvx_context *ctx, double fraction)
{
    return bvxi_progress(ctx, "test", fraction);
}

static bvx_status whole_work(bvx_context *ctx)
{
    BVXI_TRY(report(ctx, 0.0));
    BVXI_TRY(report(ctx, 0.5));
    return report(ctx, 1.0);
}

static bvx_status inner_call(bvx_context *ctx)
{
    return BVXI_CALL(ctx, whole_work(ctx));
}

static bvx_status failed_share(bvx_context *ctx)
{
    return BVXI_SHARE(ctx, 0.0, 0.1, bvxi_fail(ctx, BVX_ERR_RANGE, "failed"));
}

static bvx_status shared_work(bvx_context *ctx)
{
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.25, whole_work(ctx)));
    if (failed_share(ctx) != BVX_ERR_RANGE) return BVX_ERR_ARGUMENT;
    BVXI_TRY(BVXI_SHARE(ctx, 0.25, 0.75, inner_call(ctx)));
    BVXI_TRY(whole_work(ctx)); /* begins again: it waits where the one before it has ended */
    return report(ctx, (double)NAN);
}

/* Deeper than the stack of shares: still rising, and every share is taken back. */
static bvx_status deep_work(bvx_context *ctx, int depth)
{
    if (depth == 0) return whole_work(ctx);
    BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.5, deep_work(ctx, depth - 1)));
    return report(ctx, 0.75);
}

static bvx_status all_works(bvx_context *ctx, int deep)
{
    return BVXI_CALL(ctx, deep ? deep_work(ctx, 20) : shared_work(ctx));
}

static void test_works_share_the_fraction(void)
{
    static const double want[] = {0, 0.125, 0.25, 0.25, 0.5, 0.75, 0.75, 0.75, 1.0, 1.0};
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_context *ctx = NULL;

    o.progress.call = note_fraction;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
    for (int again = 0; again < 2; again++) {
        seen_count = 0;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, all_works(ctx, 0));
        TEST_ASSERT_EQUAL_INT(11, seen_count);
        for (int i = 0; i < 10; i++) TEST_ASSERT_TRUE(bvxi_absolute(seen[i] - want[i]) < 0.002);
        TEST_ASSERT_TRUE(seen[9] < 1.0 && seen[10] == 1.0);

        seen_count = 0;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, all_works(ctx, 1));
        TEST_ASSERT_EQUAL_INT(24, seen_count);
        for (int i = 1; i < seen_count; i++)
            TEST_ASSERT_TRUE(seen[i] >= seen[i - 1] && seen[i] < 1.0 + (double)(i + 1 == seen_count));
        TEST_ASSERT_TRUE(bvxi_absolute(seen[22] - 0.75) < 0.002);
        TEST_ASSERT_TRUE(seen[23] == 1.0);
    }
    bvx_context_destroy(ctx);
}

/* ---- Tasks that take long ---- */

static void nothing_to_do(void *user, int32_t index, int32_t worker)
{
    (void)user, (void)index, (void)worker;
}

static int32_t reports_of(double each, int32_t count, int32_t threads)
{
    record r = {0};
    bvx_context *const ctx = watched_context(&r, threads);

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_parallel_long(ctx, "tasks", 0, 1, count, each, nothing_to_do, NULL));
    bvx_context_destroy(ctx);
    return r.calls;
}

/* A build without threads has one worker, whatever is requested. */
static int has_two_workers(void)
{
    record r = {0};
    bvx_context *const ctx = watched_context(&r, 2);
    int32_t const workers = bvxi_threads(ctx);

    bvx_context_destroy(ctx);
    return workers == 2;
}

/* One report before each batch and one at the end: batches of short tasks are those of bvxi_parallel, of
 * longer ones as many as fit 50 milliseconds, and of those that fit none one, or two for each thread. */
static void test_long_tasks_report_between_them(void)
{
    TEST_ASSERT_EQUAL_INT32(8 + 1, reports_of(0.0, 80, 1));
    TEST_ASSERT_EQUAL_INT32(8 + 1, reports_of(5e6, 80, 1));
    TEST_ASSERT_EQUAL_INT32(16 + 1, reports_of(1e7, 80, 1));
    TEST_ASSERT_EQUAL_INT32(80 + 1, reports_of(1e9, 80, 1));
    TEST_ASSERT_EQUAL_INT32(1, reports_of(1e9, 0, 2));
    if (!has_two_workers()) return;

    TEST_ASSERT_EQUAL_INT32(3 + 1, reports_of(0.0, 80, 2));
    TEST_ASSERT_EQUAL_INT32(20 + 1, reports_of(1e9, 80, 2));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_long_tasks_report_between_them);
    RUN_TEST(test_every_call_rises_once_to_1);
    RUN_TEST(test_a_cancelled_call_does_not_reach_1);
    RUN_TEST(test_a_refused_call_does_not_reach_1);
    RUN_TEST(test_works_share_the_fraction);
    return UNITY_END();
}
