/* pool.c - the program's own threads behind the library's parallel-for.
 *
 * They sleep while they wait. OpenMP's threads spin at the end of every step, which on a machine that is busy with other
 * work takes the processor from the very thread that they wait for. Task numbers are handed out under a lock: a step has
 * some dozens of tasks, each of tens of microseconds and more. */
#define _POSIX_C_SOURCE 200809L
#include "cli.h"

#if defined(_WIN32)

void cli_pool_offer(bvx_context_options *options)
{
    (void)options; /* OpenMP where it is built in */
}

#else

#include <pthread.h>
#include <unistd.h>

enum { POOL_MAX = 256 };

static struct pool {
    pthread_mutex_t lock;
    pthread_cond_t work, done;
    bvx_task_fn *task;
    void *user;
    int32_t next, count; /* tasks handed out, tasks of this step */
    int32_t busy;        /* workers inside tasks, the caller not counted */
    int32_t workers;     /* threads beside the caller */
} pool = {PTHREAD_MUTEX_INITIALIZER, PTHREAD_COND_INITIALIZER, PTHREAD_COND_INITIALIZER, NULL, NULL, 0, 0, 0, 0};

/* Called and left with the lock held. */
static void take_tasks(int32_t worker)
{
    while (pool.next < pool.count) {
        int32_t const index = pool.next++;
        pthread_mutex_unlock(&pool.lock);
        pool.task(pool.user, index, worker);
        pthread_mutex_lock(&pool.lock);
    }
}

static void *work(void *number)
{
    int32_t const worker = (int32_t)(intptr_t)number;
    pthread_mutex_lock(&pool.lock);
    for (;;) {
        while (pool.next >= pool.count) pthread_cond_wait(&pool.work, &pool.lock);
        pool.busy++;
        take_tasks(worker);
        if (--pool.busy == 0) pthread_cond_signal(&pool.done);
    }
    return NULL;
}

static void run_step(void *user, int32_t count, bvx_task_fn *task, void *task_user)
{
    (void)user;
    pthread_mutex_lock(&pool.lock);
    pool.task = task;
    pool.user = task_user;
    pool.next = 0;
    pool.count = count;
    pthread_cond_broadcast(&pool.work);
    take_tasks(0);
    while (pool.busy > 0) pthread_cond_wait(&pool.done, &pool.lock);
    pthread_mutex_unlock(&pool.lock);
}

/* Threads live until the program ends; those that cannot be started are done without. */
void cli_pool_offer(bvx_context_options *options)
{
    long const machine = sysconf(_SC_NPROCESSORS_ONLN);
    int32_t wanted = options->threads != 0 ? options->threads : machine > 0 ? (int32_t)machine : 1;
    if (wanted > POOL_MAX) wanted = POOL_MAX;
    while (pool.workers + 1 < wanted) {
        pthread_t thread;
        if (pthread_create(&thread, NULL, work, (void *)(intptr_t)(pool.workers + 1)) != 0) break;
        pthread_detach(thread);
        pool.workers++;
    }
    options->threads = wanted < pool.workers + 1 ? wanted : pool.workers + 1;
    if (options->threads > 1) options->parallel = run_step;
}

#endif
