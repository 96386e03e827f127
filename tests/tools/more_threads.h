/* more_threads.h - included before all by the thread sanitizer's build: a test's context of one thread gets
 * four that take the pieces of every parallel step by turns, so that pieces that race are seen to race
 * however busy the machine is (the library may give all of them to one thread). Contexts that ask for more
 * threads keep its own, or their parallel-for; those with a progress callback stay as they are, for tests
 * that count its calls. */
#ifndef MORE_THREADS_H
#define MORE_THREADS_H

#include "../../include/bitvox.h"

#include <pthread.h>

enum { TURNS = 4 };

typedef struct turn_share {
    bvx_task_fn *task;
    void *user;
    int32_t count, worker;
} turn_share;

static inline void *take_turns(void *given)
{
    const turn_share *const t = given;
    for (int32_t i = t->worker; i < t->count; i += TURNS) t->task(t->user, i, t->worker);
    return NULL;
}

static inline void run_by_turns(void *user, int32_t count, bvx_task_fn *task, void *task_user)
{
    turn_share all[TURNS];
    pthread_t threads[TURNS];
    int started[TURNS] = {0};

    (void)user;
    for (int32_t i = 0; i < TURNS; i++) {
        all[i] = (turn_share){task, task_user, count, i};
        started[i] = i > 0 && i < count && pthread_create(&threads[i], NULL, take_turns, &all[i]) == 0;
    }
    for (int32_t i = 0; i < TURNS; i++)
        if (!started[i]) take_turns(&all[i]);
    for (int32_t i = 0; i < TURNS; i++)
        if (started[i]) pthread_join(threads[i], NULL);
}

static inline bvx_status create_with_more_threads(const bvx_context_options *options, bvx_context **context)
{
    bvx_context_options o = {.struct_size = sizeof o};

    if (options != NULL) {
        if (options->struct_size != sizeof o || options->parallel.call != NULL ||
            options->progress.call != NULL || options->threads < 0 || options->threads > 1)
            return bvx_context_create(options, context);
        o = *options;
    }
    o.threads = TURNS;
    o.parallel.call = run_by_turns;
    return bvx_context_create(&o, context);
}
#define bvx_context_create create_with_more_threads

#endif
