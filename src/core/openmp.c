/* openmp.c - the parallel-for of a context by OpenMP, which default builds take; others have threads.c.
 * When helpers are worth their wake says processors.c.
 *
 * The threads are those that OpenMP keeps for the calling thread: they outlive the context, and look for the
 * next step as OMP_WAIT_POLICY says. A step ends when all of the team did, also a thread that got no
 * processor, so the team has no more threads than there are processors without work.
 *
 * A forked child has none of the threads, and GNU's OpenMP waits for them for ever: there a context of the
 * parent works alone. */
#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* what -std=c99 hides: masks of signals */
#endif

#include "core/context.h"

#if defined(_OPENMP) && !defined(BVX_FREESTANDING)
#include <omp.h>

#if defined(__unix__) || defined(__APPLE__)
#include <signal.h>
#include <unistd.h>

static int64_t this_process(void)
{
    return getpid();
}

/* Signals are for the program's own threads: those that start while all are blocked take none. */
static void block_signals(sigset_t *before)
{
    sigset_t all;
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, before);
}

static void restore_signals(const sigset_t *before)
{
    pthread_sigmask(SIG_SETMASK, before, NULL);
}
#else
typedef int sigset_t;

static int64_t this_process(void)
{
    return 0;
}

static void block_signals(sigset_t *before)
{
    *before = 0;
}

static void restore_signals(const sigset_t *before)
{
    (void)before;
}
#endif

struct bvxi_pool {
    bvxi_worth worth;
    int64_t owner; /* the process that it was made in */
};

size_t bvxi_pool_size(int32_t threads)
{
    return threads < 2 ? 0 : sizeof(bvxi_pool);
}

int bvxi_pool_begin(bvxi_pool *pool, int32_t threads)
{
    bvxi_worth_begin(&pool->worth, threads);
    pool->owner = this_process();
    return 1;
}

void bvxi_pool_end(bvxi_pool *pool)
{
    (void)pool;
}

void bvxi_pool_run(bvxi_pool *pool, int32_t count, bvx_task_fn *task, void *user)
{
    int32_t const first = bvxi_begin_alone(&pool->worth, count, task, user);
    int32_t const left = count - first, most = pool->worth.idle + 1;
    int const team = most < left ? most : left; /* tasks have scratch for no more workers */
    int64_t start, ended = 0, lost = 0;
    sigset_t before;

    /* A lone task is the caller's, and so is all in a forked child. */
    if (team < 2 || pool->owner != this_process()) {
        for (int32_t i = first; i < count; i++) task(user, i, 0);
        return;
    }

    start = bvxi_now();
    block_signals(&before);
#pragma omp parallel num_threads(team) reduction(+ : lost)
    {
        int const worker = omp_get_thread_num();
        int64_t const used = bvxi_processor_time();

        if (worker == 0) restore_signals(&before);
#pragma omp for schedule(dynamic, 1) nowait
        for (int32_t i = first; i < count; i++) task(user, i, worker);

        if (worker == 0) ended = bvxi_now();
        else lost += bvxi_now() - start - (bvxi_processor_time() - used);
    }
    bvxi_worth_waited(&pool->worth, ended, lost);
}

#endif
