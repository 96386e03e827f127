/* parallel.c - tasks in batches, with progress and cancellation asked on the calling thread between them.
 *
 * What a task computes depends on its index only; the number of tasks follows from the work's shape. So
 * neither the threads nor the batches show in any result. */
#include "context.h"

enum { BATCHES = 8, TASKS_PER_WORKER = 16 };

typedef struct shifted {
    bvx_task_fn *task;
    void *user;
    int32_t first;
} shifted;

static void run_shifted(void *user, int32_t index, int32_t worker)
{
    const shifted *const s = user;
    s->task(s->user, s->first + index, worker);
}

static void run(bvx_context *ctx, int32_t first, int32_t count, bvx_task_fn *task, void *user)
{
    shifted s = {task, user, first};

    /* On the calling thread where nothing is gained by others. */
    if (ctx->threads == 1 || count == 1 || (ctx->parallel == NULL && ctx->pool == NULL)) {
        for (int32_t i = 0; i < count; i++) task(user, first + i, 0);
    } else if (ctx->parallel != NULL) {
        ctx->parallel(ctx->parallel_user, count, run_shifted, &s);
    } else {
        bvxi_pool_run(ctx->pool, count, run_shifted, &s);
    }
}

bvx_status bvxi_parallel(bvx_context *ctx, const char *stage, double from, double to, int32_t count,
                         bvx_task_fn *task, void *user)
{
    int32_t batch = count;

    if (ctx->progress != NULL) { /* few enough batches to cost nothing, large enough to feed every worker */
        int32_t const least = ctx->threads * TASKS_PER_WORKER;
        batch = (count + BATCHES - 1) / BATCHES;
        if (batch < least) batch = ctx->threads == 1 ? batch : least;
    }
    /* Progress and cancellation between batches only, so tasks need not know of them. */
    for (int32_t first = 0; first < count; first += batch) {
        int32_t const n = count - first < batch ? count - first : batch;
        BVXI_TRY(bvxi_progress(ctx, stage, from + (to - from) * ((double)first / (double)count)));
        run(ctx, first, n, task, user);
    }
    return BVX_OK;
}

int32_t bvxi_threads(const bvx_context *ctx)
{
    return ctx->threads;
}

int32_t bvxi_cpu(const bvx_context *ctx)
{
    return ctx->cpu;
}
