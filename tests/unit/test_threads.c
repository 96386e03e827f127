/* test_threads.c - helpers of a context: every task once, none where they would not help, none left behind;
 * and the processors that a process may use. */
#if defined(__linux__)
#define _GNU_SOURCE
#endif
#include "unity.h"

#include "core/context.h"

#include <stdio.h>
#include <stdlib.h>
#if defined(__unix__) || defined(__APPLE__)
#define HAVE_UNIX 1
#include <dirent.h>
#include <signal.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>
#if defined(__linux__)
#include <sched.h>
#endif
#endif

void setUp(void)
{
}
void tearDown(void)
{
}

#if defined(HAVE_UNIX) && defined(__GNUC__)

enum { WORKERS = 5, TASKS = 300 };

static bvx_context *context_of(int32_t threads)
{
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_context *ctx = NULL;

    o.threads = threads;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
    return ctx;
}

/* The same with helpers that come at once; NULL where no threads are built in. */
static bvx_context *eager_context(int32_t threads, int32_t how)
{
    bvx_context *const ctx = context_of(threads);

    if (bvxi_pool_size(2) == 0) {
        bvx_context_destroy(ctx);
        TEST_IGNORE_MESSAGE("no threads are built in");
    }
    bvxi_pool_be_eager(ctx->pool, how);
    return ctx;
}

/* Threads of this process; 0 where it cannot be told. */
static int threads_now(void)
{
    DIR *const folder = opendir("/proc/self/task");
    int n = 0;

    if (folder == NULL) return 0;
    for (struct dirent *e = readdir(folder); e != NULL; e = readdir(folder)) n += e->d_name[0] != '.';
    closedir(folder);
    return n;
}

/* OpenMP keeps its threads for the one that called. */
#if defined(_OPENMP)
#define KEPT(n) (n)
#else
#define KEPT(n) 0
#endif

/* 1 when no more threads are there than at first; one that was joined may be seen a moment longer. */
static int are_gone(int at_first)
{
    struct timespec const nap = {0, 1000000};

    for (int i = 0; i < 2000 && threads_now() > at_first; i++) nanosleep(&nap, NULL);
    return threads_now() <= at_first;
}

static void work_for(double seconds, clockid_t clock)
{
    struct timespec from, now;

    clock_gettime(clock, &from);
    do clock_gettime(clock, &now);
    while ((double)(now.tv_sec - from.tv_sec) + 1e-9 * (double)(now.tv_nsec - from.tv_nsec) < seconds);
}

typedef struct work_record {
    int32_t runs[TASKS], busy[WORKERS], seen[WORKERS], clashes;
    int32_t together; /* tasks that wait until this many workers were seen */
    double seconds;   /* of each task */
} work_record;

static int32_t workers_seen(work_record *r)
{
    int32_t n = 0;

    for (int i = 0; i < WORKERS; i++) n += __atomic_load_n(&r->seen[i], __ATOMIC_RELAXED);
    return n;
}

static void record_work(void *user, int32_t index, int32_t worker)
{
    work_record *const r = user;
    struct timespec const nap = {0, 1000000};

    if (worker < 0 || worker >= WORKERS || __atomic_exchange_n(&r->busy[worker], 1, __ATOMIC_RELAXED) != 0) {
        __atomic_fetch_add(&r->clashes, 1, __ATOMIC_RELAXED);
        return;
    }
    r->runs[index]++;
    __atomic_store_n(&r->seen[worker], 1, __ATOMIC_RELAXED);
    for (int i = 0; i < 20000 && workers_seen(r) < r->together; i++) nanosleep(&nap, NULL);
    if (r->seconds > 0) work_for(r->seconds, CLOCK_MONOTONIC);
    __atomic_store_n(&r->busy[worker], 0, __ATOMIC_RELAXED);
}

static void check_work(const work_record *r, int32_t count)
{
    TEST_ASSERT_EQUAL_INT32(0, r->clashes);
    for (int32_t i = 0; i < count; i++) TEST_ASSERT_EQUAL_INT32(1, r->runs[i]);
    for (int32_t i = count; i < TASKS; i++) TEST_ASSERT_EQUAL_INT32(0, r->runs[i]);
}

static void test_helpers_take_tasks_and_each_runs_once(void)
{
    int const at_first = threads_now();
    bvx_context *const ctx = eager_context(WORKERS, 2);

    for (int32_t step = 0; step < 400; step++) {
        int32_t const count = step < 3 ? TASKS : step % (TASKS + 1);
        work_record r = {.together = step < 3 ? WORKERS : 1};

        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_parallel(ctx, "tasks", 0, 1, count, record_work, &r));
        check_work(&r, count);
        if (step < 3) TEST_ASSERT_EQUAL_INT32(WORKERS, workers_seen(&r)); /* all of them came */
    }
    bvx_context_destroy(ctx);
    TEST_ASSERT_TRUE(are_gone(at_first + KEPT(WORKERS - 1)));
}

/* Less than a fifth of a millisecond in all: nobody is started for it. A
 * machine that stops between makes it look longer. */
/* Tasks have scratch for as many workers as there are tasks, where these are fewer than threads. */
static void record_highest(void *user, int32_t index, int32_t worker)
{
    struct timespec const nap = {0, 200000};
    int32_t *const highest = user;

    (void)index;
    nanosleep(&nap, NULL);
    if (worker > __atomic_load_n(highest, __ATOMIC_RELAXED))
        __atomic_store_n(highest, worker, __ATOMIC_RELAXED);
}

static void test_workers_are_fewer_than_tasks(void)
{
    bvx_context *const ctx = eager_context(7, 2);

    for (int32_t step = 0; step < 40; step++) {
        int32_t const count = 2 + step % 5;
        int32_t highest = 0;

        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_parallel(ctx, "tasks", 0, 1, count, record_highest, &highest));
        TEST_ASSERT_LESS_THAN_INT32(count, highest);
    }
    bvx_context_destroy(ctx);
}

static void test_small_work_starts_no_helper(void)
{
    int const at_first = threads_now();
    int started = 0;

    if (at_first == 0 || bvxi_pool_size(2) == 0)
        TEST_IGNORE_MESSAGE("threads cannot be counted, or there are none");
    for (int i = 0; i < 40; i++) {
        bvx_context *const ctx = context_of(4);
        work_record r = {.seconds = 0};

        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_parallel(ctx, "tasks", 0, 1, 40, record_work, &r));
        check_work(&r, 40);
        started += threads_now() > at_first;
        bvx_context_destroy(ctx);
        TEST_ASSERT_TRUE(are_gone(at_first));
    }
    TEST_ASSERT_LESS_THAN_INT(10, started);
}

static void test_no_helper_on_busy_processors(void)
{
    int32_t const loops = 2 * bvxi_online_processors();
    pid_t *const pid = malloc((size_t)loops * sizeof *pid);
    work_record r = {.seconds = 0.0001};
    bvx_context *ctx;
    int32_t busy;

    if (bvxi_running_threads() == 0 || loops > 256 || bvxi_pool_size(2) == 0) {
        free(pid);
        TEST_IGNORE_MESSAGE("the machine does not tell its load, or is too large, or there are no threads");
    }
    for (int32_t i = 0; i < loops; i++) {
        pid[i] = fork();
        if (pid[i] == 0)
            for (;;) work_for(1, CLOCK_MONOTONIC);
    }
    for (int i = 0; i < 100 && bvxi_running_threads() < loops; i++) work_for(0.01, CLOCK_MONOTONIC);
    busy = bvxi_running_threads();

    ctx = context_of(WORKERS);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_parallel(ctx, "tasks", 0, 1, TASKS, record_work, &r));
    busy = busy < bvxi_running_threads() ? busy : bvxi_running_threads();
    bvx_context_destroy(ctx);
    for (int32_t i = 0; i < loops; i++) kill(pid[i], SIGKILL);
    for (int32_t i = 0; i < loops; i++) waitpid(pid[i], NULL, 0);
    free(pid);

    check_work(&r, TASKS);
    if (busy < bvxi_online_processors()) TEST_IGNORE_MESSAGE("the loops were not seen to run");
    TEST_ASSERT_EQUAL_INT32(1, workers_seen(&r));
}

/* A helper sleeps inside a task, which to the caller is as if it had lost its processor. */
static void sleep_as_helper(void *user, int32_t index, int32_t worker)
{
    work_record *const r = user;
    struct timespec const nap = {0, worker == 0 ? 1000000 : 30000000};

    (void)index;
    __atomic_store_n(&r->seen[worker], 1, __ATOMIC_RELAXED);
    for (int i = 0; i < 20000 && workers_seen(r) < 2; i++) nanosleep(&nap, NULL);
    if (worker > 0) nanosleep(&nap, NULL);
}

static void test_helpers_that_keep_the_caller_waiting_rest(void)
{
    bvx_context *const ctx = eager_context(2, 1);
    work_record slow = {.seconds = 0}, next = {.seconds = 0.0001}, later = {.together = 2};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_parallel(ctx, "tasks", 0, 1, 2, sleep_as_helper, &slow));
    TEST_ASSERT_EQUAL_INT32(2, workers_seen(&slow));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_parallel(ctx, "tasks", 0, 1, TASKS, record_work, &next));
    check_work(&next, TASKS);
    TEST_ASSERT_EQUAL_INT32(1, workers_seen(&next));

    bvxi_pool_be_eager(ctx->pool, 2);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_parallel(ctx, "tasks", 0, 1, TASKS, record_work, &later));
    check_work(&later, TASKS);
    TEST_ASSERT_EQUAL_INT32(2, workers_seen(&later));
    bvx_context_destroy(ctx);
}

static void test_forked_child_works_alone(void)
{
    bvx_context *const ctx = eager_context(3, 2);
    work_record before = {.together = 3};
    int status = -1;
    pid_t child;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_parallel(ctx, "tasks", 0, 1, TASKS, record_work, &before));
    child = fork();
    if (child == 0) {
        work_record in_child = {.together = 1};
        int ok;

        alarm(60);
        ok = bvxi_parallel(ctx, "tasks", 0, 1, TASKS, record_work, &in_child) == BVX_OK &&
             workers_seen(&in_child) == 1;
        for (int i = 0; i < TASKS; i++) ok = ok && in_child.runs[i] == 1;
        bvx_context_destroy(ctx);
        _exit(ok ? 0 : 3);
    }
    TEST_ASSERT_EQUAL_INT(child, waitpid(child, &status, 0));
    TEST_ASSERT_EQUAL_INT(0, status);
    bvx_context_destroy(ctx);
}

/* A signal to the process is for its own threads: blocked there, it waits. */
static void test_helpers_take_no_signals(void)
{
    bvx_context *const ctx = eager_context(3, 2);
    work_record r = {.together = 3};
    sigset_t wanted, pending;
    int taken = 0;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_parallel(ctx, "tasks", 0, 1, TASKS, record_work, &r));
    sigemptyset(&wanted);
    sigaddset(&wanted, SIGUSR1);
    sigprocmask(SIG_BLOCK, &wanted, NULL);
    kill(getpid(), SIGUSR1);
    sigpending(&pending);
    TEST_ASSERT_EQUAL_INT(1, sigismember(&pending, SIGUSR1));
    sigwait(&wanted, &taken);
    sigprocmask(SIG_UNBLOCK, &wanted, NULL);
    bvx_context_destroy(ctx);
}

static void test_helpers_end_with_an_arenas_context(void)
{
    static uint64_t memory[8192];
    int const at_first = threads_now();
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_context *ctx = NULL;
    work_record r = {.together = WORKERS};

    if (bvxi_pool_size(2) == 0) TEST_IGNORE_MESSAGE("no threads are built in");
    o.arena.memory = memory;
    o.arena.size = sizeof memory;
    o.threads = WORKERS;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
    bvxi_pool_be_eager(ctx->pool, 2);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_parallel(ctx, "tasks", 0, 1, TASKS, record_work, &r));
    check_work(&r, TASKS);
    bvx_context_destroy(ctx);
    TEST_ASSERT_TRUE(are_gone(at_first + KEPT(WORKERS - 1)));
    memset(memory, 0xA5, sizeof memory);
}

/* ---- processors ---- */

static char place[256];

static void make_folders(const char *path)
{
    char part[512];

    for (size_t i = 1; path[i - 1] != 0; i++)
        if (path[i] == '/' || path[i] == 0) {
            memcpy(part, path, i);
            part[i] = 0;
            mkdir(part, 0700);
        }
}

static void put_file(const char *folder, const char *name, const char *text)
{
    char path[512];
    FILE *file;

    snprintf(path, sizeof path, "%s/%s", place, folder);
    make_folders(path);
    snprintf(path, sizeof path, "%s/%s/%s", place, folder, name);
    file = fopen(path, "w");
    TEST_ASSERT_NOT_NULL(file);
    fputs(text, file);
    fclose(file);
}

static int32_t quota_of(const char *groups)
{
    char list[300], mounted[300];

    put_file("proc", "cgroup", groups);
    snprintf(list, sizeof list, "%s/proc/cgroup", place);
    snprintf(mounted, sizeof mounted, "%s/groups", place);
    return bvxi_processor_quota(list, mounted);
}

static void test_quota_of_control_groups(void)
{
    char command[300];
    char deep[900] = "0::/";

    if (bvxi_pool_size(2) == 0) TEST_IGNORE_MESSAGE("no threads are built in");
    snprintf(place, sizeof place, "%s/bitvox-threads-%ld",
             getenv("TMPDIR") != NULL ? getenv("TMPDIR") : "/tmp", (long)getpid());
    put_file("groups", "other", "");
    TEST_ASSERT_EQUAL_INT32(0, quota_of(""));
    TEST_ASSERT_EQUAL_INT32(0, quota_of("0::/\n"));
    TEST_ASSERT_EQUAL_INT32(0, quota_of("no colons here\n::\n0:\n3:cpu,cpuacct:/x\n"));

    /* The group itself, and those above it. */
    put_file("groups/a/b", "cpu.max", "max 100000\n");
    TEST_ASSERT_EQUAL_INT32(0, quota_of("0::/a/b\n"));
    put_file("groups/a/b", "cpu.max", "300000 100000\n");
    TEST_ASSERT_EQUAL_INT32(3, quota_of("0::/a/b\n"));
    put_file("groups/a", "cpu.max", "150000 100000\n");
    TEST_ASSERT_EQUAL_INT32(2, quota_of("0::/a/b\n"));
    put_file("groups/a", "cpu.max", "20000 100000\n");
    TEST_ASSERT_EQUAL_INT32(1, quota_of("0::/a/b\n"));
    TEST_ASSERT_EQUAL_INT32(0, quota_of("0::/c\n"));

    /* A container's own group is the mounted folder, whatever the path outside. */
    put_file("groups", "cpu.max", "400000 100000\n");
    TEST_ASSERT_EQUAL_INT32(4, quota_of("0::/docker/0123456789abcdef\n"));
    put_file("groups", "cpu.max", "99999999999999999999 1\n");
    TEST_ASSERT_EQUAL_INT32(0, quota_of("0::/docker/0123456789abcdef\n"));
    put_file("groups", "cpu.max", "");
    TEST_ASSERT_EQUAL_INT32(0, quota_of("0::/\n"));

    /* A path that is too long for us limits nothing. */
    memset(deep + 4, 'd', sizeof deep - 5);
    deep[sizeof deep - 1] = 0;
    TEST_ASSERT_EQUAL_INT32(0, quota_of(deep));
    snprintf(command, sizeof command, "rm -rf '%s'", place);
    TEST_ASSERT_EQUAL_INT(0, system(command));
}

static void test_threads_follow_affinity_and_variables(void)
{
    int32_t const all = bvxi_processors();

    if (bvxi_pool_size(2) == 0) TEST_IGNORE_MESSAGE("no threads are built in");
    TEST_ASSERT_GREATER_OR_EQUAL_INT32(1, all);
    setenv("OMP_NUM_THREADS", "7,2", 1);
    TEST_ASSERT_EQUAL_INT32(7, bvxi_processors());
    setenv("OMP_THREAD_LIMIT", "3", 1);
    TEST_ASSERT_EQUAL_INT32(3, bvxi_processors());
    setenv("OMP_NUM_THREADS", "none", 1);
    TEST_ASSERT_LESS_OR_EQUAL_INT32(3, bvxi_processors());
    unsetenv("OMP_NUM_THREADS");
    unsetenv("OMP_THREAD_LIMIT");

#if defined(__linux__) && defined(CPU_COUNT)
    {
        cpu_set_t before, one;
        bvx_context *ctx;
        size_t first = 0;

        TEST_ASSERT_EQUAL_INT(0, sched_getaffinity(0, sizeof before, &before));
        while (!CPU_ISSET(first, &before)) first++;
        CPU_ZERO(&one);
        CPU_SET(first, &one);
        TEST_ASSERT_EQUAL_INT(0, sched_setaffinity(0, sizeof one, &one));
        ctx = context_of(0);
        TEST_ASSERT_EQUAL_INT32(1, bvx_context_threads(ctx));
        bvx_context_destroy(ctx);
        TEST_ASSERT_EQUAL_INT(0, sched_setaffinity(0, sizeof before, &before));
    }
#endif
}

#endif

int main(void)
{
    UNITY_BEGIN();
#if defined(HAVE_UNIX) && defined(__GNUC__)
    RUN_TEST(test_helpers_take_tasks_and_each_runs_once);
    RUN_TEST(test_workers_are_fewer_than_tasks);
    RUN_TEST(test_small_work_starts_no_helper);
    RUN_TEST(test_no_helper_on_busy_processors);
    RUN_TEST(test_helpers_that_keep_the_caller_waiting_rest);
    RUN_TEST(test_forked_child_works_alone);
    RUN_TEST(test_helpers_take_no_signals);
    RUN_TEST(test_helpers_end_with_an_arenas_context);
    RUN_TEST(test_quota_of_control_groups);
    RUN_TEST(test_threads_follow_affinity_and_variables);
#endif
    return UNITY_END();
}
