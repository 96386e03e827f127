/* test_parallel.c - parallel work, the caller's own parallel-for, progress and cancellation. */
#include "fault/context.h"

enum { TASKS = 1000 };

typedef struct task_record {
    int32_t runs[TASKS];
    int32_t worker[TASKS];
    int32_t started; /* counted on one thread only */
} task_record;

static void record_task(void *user, int32_t index, int32_t worker)
{
    task_record *const r = user;
    r->runs[index]++;
    r->worker[index] = worker;
}

static void assert_each_ran_once(const task_record *r, int32_t count, int32_t workers)
{
    for (int32_t i = 0; i < TASKS; i++) {
        assert_int_equal(r->runs[i], i < count);
        if (i < count) assert_in_range(r->worker[i], 0, workers - 1);
    }
}

static void test_parallel_runs_each_task_once(void **state)
{
    static const int32_t counts[] = {0, 1, 2, 3, 31, 32, 33, 64, 257, TASKS};

    (void)state;
    for (int32_t threads = 1; threads <= 8; threads++) {
        for (size_t i = 0; i < sizeof counts / sizeof counts[0]; i++) {
            static task_record r;
            bvx_context_options o = default_options();
            bvx_context *ctx;
            memset(&r, 0, sizeof r);
            o.threads = threads;
            ctx = context_with(&o);
            assert_int_equal(bvxi_threads(ctx), bvx_context_threads(ctx));
            assert_in_range(bvxi_threads(ctx), 1, threads); /* one where no threads are built in */
            assert_int_equal(bvxi_parallel(ctx, "tasks", 0, 1, counts[i], record_task, &r), BVX_OK);
            assert_each_ran_once(&r, counts[i], bvxi_threads(ctx));
            bvx_context_destroy(ctx);
        }
    }
}

/* A caller's parallel-for: backwards, and each index to a worker of its choice. */
typedef struct own_parallel {
    int32_t calls, indices, workers;
} own_parallel;

static void run_backwards(void *user, int32_t count, bvx_task_fn *task, void *task_user)
{
    own_parallel *const p = user;
    p->calls++;
    p->indices += count;
    for (int32_t i = count; i-- > 0;) task(task_user, i, i % p->workers);
}

static void test_the_callers_parallel_for_is_used(void **state)
{
    (void)state;
    for (int32_t workers = 2; workers <= 5; workers++) {
        static task_record r;
        own_parallel own = {0, 0, workers};
        bvx_context_options o = default_options();
        bvx_context *ctx;
        memset(&r, 0, sizeof r);
        o.parallel.call = run_backwards;
        o.parallel.user = &own;
        o.threads = workers;
        ctx = context_with(&o);
        assert_int_equal(bvx_context_threads(ctx), workers);
        assert_int_equal(bvxi_parallel(ctx, "tasks", 0, 1, TASKS, record_task, &r), BVX_OK);
        assert_each_ran_once(&r, TASKS, workers);
        assert_true(own.calls > 0);
        assert_int_equal(own.indices, TASKS);
        for (int32_t i = 0; i < TASKS; i++) assert_int_equal(r.worker[i], i % workers);
        bvx_context_destroy(ctx);
    }
}

static void test_a_parallel_for_without_threads_means_one(void **state)
{
    own_parallel own = {0, 0, 1};
    bvx_context_options o = default_options();
    bvx_context *ctx;

    (void)state;
    o.parallel.call = run_backwards;
    o.parallel.user = &own;
    ctx = context_with(&o);
    assert_int_equal(bvx_context_threads(ctx), 1);
    bvx_context_destroy(ctx);
}

static void start_task(void *user, int32_t index, int32_t worker)
{
    task_record *const r = user;
    (void)worker;
    assert_int_equal(r->runs[index], 0);
    r->runs[index]++;
    r->started++;
}

typedef struct watched {
    task_record *record;
    uint64_t calls, cancel_at;
    double from, to, last;
} watched;

static int32_t watch(void *user, const char *stage, double fraction)
{
    watched *const w = user;
    assert_string_equal(stage, "tasks");
    assert_true(fraction >= w->from && fraction <= w->to && fraction >= w->last);
    w->last = fraction;
    return ++w->calls == w->cancel_at;
}

static void test_progress_grows_and_cancels_at_every_call(void **state)
{
    uint64_t n = 0;
    int32_t before = -1;

    (void)state;
    for (;;) {
        static task_record r;
        own_parallel own = {0, 0, 2};
        watched w = {&r, 0, 0, 0.25, 0.5, 0};
        bvx_context_options o = default_options();
        bvx_context *ctx;
        bvx_status status;
        memset(&r, 0, sizeof r);
        w.cancel_at = ++n;
        o.parallel.call = run_backwards; /* one thread in truth, so that started may be counted */
        o.parallel.user = &own;
        o.threads = 2;
        o.progress.call = watch;
        o.progress.user = &w;
        ctx = context_with(&o);
        status = bvxi_parallel(ctx, "tasks", 0.25, 0.5, TASKS, start_task, &r);
        if (w.calls < n) {
            assert_int_equal(status, BVX_OK);
            assert_int_equal(r.started, TASKS);
            bvx_context_destroy(ctx);
            break;
        }
        assert_int_equal(status, BVX_CANCELLED);
        assert_string_equal(bvx_last_message(ctx), "tasks: cancelled by the progress callback");
        assert_int_equal(w.calls, n);    /* not asked again */
        assert_true(r.started > before); /* each call lets more through than the one before */
        assert_true((r.started < TASKS) == (w.last < 0.5)); /* the last report follows the last task */
        before = r.started;
        bvx_context_destroy(ctx);
    }
    assert_true(n > 8); /* a large step asks at least eight times */
}

static void test_two_contexts_share_nothing(void **state)
{
    bvx_context_options o = default_options();
    bvx_context *a, *b;
    void *block;

    (void)state;
    o.memory_limit = 100;
    a = context_with(&o);
    b = context_with(NULL);
    assert_int_equal(bvxi_alloc(a, BVXI_RESULT, 101, "a block", &block), BVX_ERR_BUDGET);
    assert_string_equal(bvx_last_message(b), "");
    block = get(b, BVXI_RESULT, 5000);
    assert_int_equal(bvx_memory_used(a), 0);
    bvxi_free(b, block, 5000);
    bvx_context_destroy(a);
    bvx_context_destroy(b);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_parallel_runs_each_task_once),
        cmocka_unit_test(test_the_callers_parallel_for_is_used),
        cmocka_unit_test(test_a_parallel_for_without_threads_means_one),
        cmocka_unit_test(test_progress_grows_and_cancels_at_every_call),
        cmocka_unit_test(test_two_contexts_share_nothing),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
