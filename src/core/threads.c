/* threads.c - the helpers of a context as POSIX threads, and the parallel-for that they serve: what builds
 * without OpenMP (openmp.c) take. When helpers are worth their wake says processors.c.
 *
 *   - The caller wakes one; each that comes wakes two more while tasks are left.
 *   - Tasks are claimed from a counter, and a step ends when all tasks did. A helper that got no processor
 *     meanwhile holds no task, so nobody waits for it. Who waits looks again and again for SPIN_TIME, then
 *     sleeps.
 *
 * They are there where the compiler was told to use them (-pthread defines _REENTRANT), else none. A forked
 * child has no helpers: it works alone in contexts of its parent. */
#if defined(__linux__) && !defined(_GNU_SOURCE)
#define _GNU_SOURCE /* what -std=c99 hides: clocks */
#endif

#include "core/context.h"

#if defined(_REENTRANT) && !defined(_OPENMP) && (defined(__unix__) || defined(__APPLE__)) && \
    !defined(BVX_FREESTANDING)
#include <pthread.h>
#include <signal.h>
#include <time.h>
#include <unistd.h>

enum { SPIN_TIME = 100000 /* [Units: ns] */, HELPER_STACK = 1 << 20 };

struct bvxi_pool {
    bvxi_worth worth;
    pthread_mutex_t lock;       /* of all below but next */
    pthread_cond_t work, ended; /* helpers sleep on the first, the caller on the second */
    pid_t owner;                /* the process that the helpers are in */

    bvx_task_fn *task;
    void *user;
    int32_t count, next; /* tasks of this step; the next one to claim, changed by all at once */
    int32_t open;        /* 1 while helpers may enter the step */
    int32_t inside;      /* helpers that did and have not left */
    int32_t entered;     /* helpers that did; each is the worker of the number that it came as */
    int32_t watching;    /* helpers that look for the next step without sleeping */
    int64_t lost;        /* time that helpers were inside this step without a processor [Units: ns] */

    int32_t most, started, asleep, quit; /* helpers: wanted, running, of those waiting for work */
    int32_t called;                      /* helpers of this step */

    pthread_t helper[]; /* [Size: most] */
};

/* Numbers that a thread reads while another, which may have the lock, changes them. The lock orders what
 * tasks read and write, so these need no order of their own. */
#if defined(__GNUC__)
static int32_t look_at(const int32_t *number)
{
    return __atomic_load_n(number, __ATOMIC_RELAXED);
}

static void change(int32_t *number, int32_t value)
{
    __atomic_store_n(number, value, __ATOMIC_RELAXED);
}

static int32_t claim_task(bvxi_pool *pool)
{
    return __atomic_fetch_add(&pool->next, 1, __ATOMIC_RELAXED);
}

/* Until the number is what is wanted, for SPIN_TIME at most. */
static void watch(const int32_t *number, int32_t wanted)
{
    int64_t const until = bvxi_now() + SPIN_TIME;
    /* Many looks for each look at the clock. */
    while (look_at(number) != wanted && bvxi_now() < until)
        for (int i = 0; i < 16 && look_at(number) != wanted; i++) {
#if defined(__x86_64__) || defined(__i386__)
            __builtin_ia32_pause();
#endif
        }
}
#else
static int32_t look_at(const int32_t *number)
{
    return *number; /* with the lock held */
}

static void change(int32_t *number, int32_t value)
{
    *number = value;
}

static int32_t claim_task(bvxi_pool *pool)
{
    pthread_mutex_lock(&pool->lock);
    int32_t const claimed = pool->next++;
    pthread_mutex_unlock(&pool->lock);
    return claimed;
}

static void watch(const int32_t *number, int32_t wanted)
{
    (void)number, (void)wanted;
}
#endif

static void take_tasks(bvxi_pool *pool, int32_t worker)
{
    for (int32_t i = claim_task(pool); i < pool->count; i = claim_task(pool))
        pool->task(pool->user, i, worker);
}

static void *help(void *given);

/* With the lock held: one more helper for the step, if tasks are left and there is one. */
static void call_helper(bvxi_pool *pool)
{
    pthread_attr_t attributes;
    sigset_t all, before;

    if (pool->called == pool->worth.idle || look_at(&pool->next) >= pool->count) return;
    if (pool->called++ < pool->watching) return; /* it comes by itself */
    if (pool->asleep > 0) {
        pthread_cond_signal(&pool->work);
        return;
    }
    if (pool->started == pool->most) return;

    /* Signals are for the program's own threads. A helper that cannot be
     * started is done without, from now on. */
    sigfillset(&all);
    pthread_sigmask(SIG_SETMASK, &all, &before);
    pthread_attr_init(&attributes);
    pthread_attr_setstacksize(&attributes, HELPER_STACK);
    if (pthread_create(&pool->helper[pool->started], &attributes, help, pool) == 0) pool->started++;
    else pool->most = pool->started;
    pthread_attr_destroy(&attributes);
    pthread_sigmask(SIG_SETMASK, &before, NULL);
}

static void work_on_step(bvxi_pool *pool)
{
    /* below the number of tasks, as tasks have scratch for no more workers */
    int32_t const worker = ++pool->entered;

    /* Each helper calls two more, so that many are awake after few rounds. */
    change(&pool->inside, pool->inside + 1);
    call_helper(pool);
    call_helper(pool);
    pthread_mutex_unlock(&pool->lock);

    /* Time that passed without a processor shows whether others need it. */
    int64_t time = bvxi_now();
    int64_t processor_time = bvxi_processor_time();
    take_tasks(pool, worker);
    processor_time = bvxi_processor_time() - processor_time;
    time = bvxi_now() - time;

    pthread_mutex_lock(&pool->lock);
    /* Measured, as a helper without a processor makes all wait. */
    pool->lost += time > processor_time ? time - processor_time : 0;
    change(&pool->inside, pool->inside - 1);
    if (pool->inside == 0) pthread_cond_signal(&pool->ended);
}

static void *help(void *given)
{
    bvxi_pool *const pool = given;

    pthread_mutex_lock(&pool->lock);
    while (!pool->quit) {
        if (pool->open && pool->inside < pool->worth.idle && pool->entered + 1 < pool->count &&
            look_at(&pool->next) < pool->count) {
            work_on_step(pool);
            /* With the lock held, which is given back meanwhile. */
            pool->watching++;
            pthread_mutex_unlock(&pool->lock);
            watch(&pool->open, 1);
            pthread_mutex_lock(&pool->lock);
            pool->watching--;
            continue;
        }
        pool->asleep++;
        pthread_cond_wait(&pool->work, &pool->lock);
        pool->asleep--;
    }
    pthread_mutex_unlock(&pool->lock);
    return NULL;
}

size_t bvxi_pool_size(int32_t threads)
{
    return threads < 2 ? 0 : sizeof(bvxi_pool) + (size_t)(threads - 1) * sizeof(pthread_t);
}

int bvxi_pool_begin(bvxi_pool *pool, int32_t threads)
{
    memset(pool, 0, sizeof *pool);
    pool->most = threads - 1;
    bvxi_worth_begin(&pool->worth, threads);
    pool->owner = getpid();
    if (pthread_mutex_init(&pool->lock, NULL) != 0) return 0;
    if (pthread_cond_init(&pool->work, NULL) != 0) goto no_work;
    if (pthread_cond_init(&pool->ended, NULL) != 0) goto no_ended;
    return 1;

no_ended:
    pthread_cond_destroy(&pool->work);
no_work:
    pthread_mutex_destroy(&pool->lock);
    return 0;
}

void bvxi_pool_end(bvxi_pool *pool)
{
    /* In a forked child there are no helpers to be waited for. */
    if (pool->owner != getpid()) return;
    pthread_mutex_lock(&pool->lock);
    pool->quit = 1;
    change(&pool->open, 1); /* those that watch see it too */
    pthread_cond_broadcast(&pool->work);
    pthread_mutex_unlock(&pool->lock);

    for (int32_t i = 0; i < pool->started; i++) pthread_join(pool->helper[i], NULL);
    pthread_cond_destroy(&pool->ended);
    pthread_cond_destroy(&pool->work);
    pthread_mutex_destroy(&pool->lock);
}

/* With the lock held: the last helpers leave. */
static void wait_for_helpers(bvxi_pool *pool)
{
    if (pool->inside == 0) return;
    int64_t const start = bvxi_now();
    pthread_mutex_unlock(&pool->lock);
    watch(&pool->inside, 0);
    pthread_mutex_lock(&pool->lock);
    while (pool->inside > 0) pthread_cond_wait(&pool->ended, &pool->lock);
    bvxi_worth_waited(&pool->worth, start, pool->lost);
}

void bvxi_pool_run(bvxi_pool *pool, int32_t count, bvx_task_fn *task, void *user)
{
    int32_t const first = bvxi_begin_alone(&pool->worth, count, task, user);

    /* a lone task is the caller's, and so is all in a forked child */
    if (count - first < 2 || pool->owner != getpid()) {
        for (int32_t i = first; i < count; i++) task(user, i, 0);
        return;
    }

    pthread_mutex_lock(&pool->lock);

    /* Set while no helper is inside; opening the step lets them in. */
    pool->task = task;
    pool->user = user;
    pool->count = count;
    change(&pool->next, first);
    pool->lost = 0;
    pool->called = 0;
    pool->entered = 0;
    change(&pool->open, 1);
    call_helper(pool);
    pthread_mutex_unlock(&pool->lock);

    take_tasks(pool, 0);

    pthread_mutex_lock(&pool->lock);
    change(&pool->open, 0);
    wait_for_helpers(pool);
    pthread_mutex_unlock(&pool->lock);
}

#elif !defined(_OPENMP) || defined(BVX_FREESTANDING)

size_t bvxi_pool_size(int32_t threads)
{
    (void)threads;
    return 0;
}

int bvxi_pool_begin(bvxi_pool *pool, int32_t threads)
{
    (void)pool, (void)threads;
    return 0;
}

void bvxi_pool_end(bvxi_pool *pool)
{
    (void)pool;
}

void bvxi_pool_run(bvxi_pool *pool, int32_t count, bvx_task_fn *task, void *user)
{
    (void)pool;
    for (int32_t i = 0; i < count; i++) task(user, i, 0);
}

#endif
