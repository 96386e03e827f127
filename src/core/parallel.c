/* parallel.c - tasks in batches, and the one fraction from 0 to 1 that a public call reports.
 *
 * Guarantee: what a task computes depends on its index, and the number of tasks on the shape of the work, so
 * the number of threads shows in no result. */
#include "context.h"

/* ---- Progress ---- */

/* One fraction for a whole public call, which rises from 0 to 1, made of what its works report
 * of themselves.
 *
 * Works report fractions of their own, from 0 to 1, and know nothing of each other. The context holds the
 * share of the call that the present work has, as a stack: a call made of several works gives each its share,
 * which may be shared again. Whatever is reported is kept from falling, so a work without a share of its own,
 * or one that begins anew, costs only evenness. Public functions called by others change nothing but the
 * share that they report in; the outermost one reports 1 when it succeeds, and only then is it reached. */

#define BEFORE_END (1023.0 / 1024.0) /* what works report at most */

/* Shares deeper than the stack report as the last one that it holds. */
static const bvxi_share *present_share(const bvx_context *ctx)
{
    return &ctx->share[ctx->shares < BVXI_SHARES ? ctx->shares : BVXI_SHARES - 1];
}

/* Where a work's fraction lies in the call. */
static double place_in(const bvxi_share *s, double fraction)
{
    if (fraction > s->bend && s->bend < 1.0)
        return s->knee + (s->high - s->knee) * ((fraction - s->bend) / (1.0 - s->bend));
    if (fraction <= s->from) return s->low;
    return s->low + (s->knee - s->low) * ((fraction - s->from) / (s->bend - s->from));
}

void bvxi_call_begin(bvx_context *ctx, const char *function)
{
    if (ctx == NULL || ctx->calls++ != 0) return;

    ctx->mark = bvxi_scratch_begin(ctx);
    ctx->stage = ctx->function = function;
    /* Without a callback nobody looks at shares. */
    if (ctx->progress == NULL) return;
    ctx->shares = 0;
    ctx->share[0] = (bvxi_share){.knee = BEFORE_END, .high = BEFORE_END, .bend = 1.0, .to = 1.0};
    ctx->reached = ctx->bar_cost = 0.0;
}

bvx_status bvxi_call_end(bvx_context *ctx, bvx_status status)
{
    if (ctx == NULL || --ctx->calls != 0) return status;

    /* What fails leaves its scratch where it is. */
    (void)bvxi_scratch_end(ctx, ctx->mark, status);

    /* The results are there and stay: what the callback answers is not heard. */
    if (status == BVX_OK && ctx->progress != NULL) (void)ctx->progress(ctx->progress_user, ctx->stage, 1.0);
    return status;
}

void bvxi_share_begin(bvx_context *ctx, double from, double to)
{
    const bvxi_share *const outer = present_share(ctx);
    bvxi_share share = {.bend = 1.0, .to = to};

    if (ctx->progress == NULL) return;
    share.low = place_in(outer, from);
    share.knee = share.high = place_in(outer, to);
    if (++ctx->shares < BVXI_SHARES) ctx->share[ctx->shares] = share;
}

/* What the present work does from `from` to `to`, beginning now, takes `part` of the old bar. */
static void plan_anew(bvx_context *ctx, double from, double to, double part)
{
    int32_t const top = ctx->shares;
    double cost[BVXI_SHARES]; /* of what is left of each share, in shares of the call as planned before */
    double const now = place_in(&ctx->share[top], from), rest = ctx->share[0].high - now;
    double inner = part, old = place_in(&ctx->share[top], to) - now;

    /* Nothing is left that could be shared out. */
    if (!(rest > 0.0)) return;

    /* From the inside out: what takes longer within a share makes all of it take longer. */
    for (int32_t k = top; k >= 0; k--) {
        double const left = ctx->share[k].high - now;

        cost[k] = inner + (left - old);
        inner = cost[k];
        old = left;
    }

    /* From the outside in, as the call ends where it did: each gets its part of what is left, and what comes
     * after it the rest. */
    for (int32_t k = 0; k <= top; k++) {
        bvxi_share *const s = &ctx->share[k];

        inner = k < top ? cost[k + 1] : part;
        s->knee = cost[k] > 0.0 ? now + (s->high - now) * (inner / cost[k]) : now;
        s->bend = k < top ? ctx->share[k + 1].to : to;
        if (k < top) ctx->share[k + 1].high = s->knee;
    }
    ctx->share[top].low = now;
    ctx->share[top].from = from;
    /* What is left of the bar stands for more now, or for less. */
    ctx->bar_cost *= cost[0] / rest;
}

/* Without a callback there is no bar, and shares deeper than the stack are not known. */
static int is_planned(const bvx_context *ctx)
{
    return ctx->progress != NULL && ctx->shares < BVXI_SHARES;
}

void bvxi_share_costs(bvx_context *ctx, double from, double to, double times)
{
    const bvxi_share *const share = present_share(ctx);
    double bar;

    if (!is_planned(ctx)) return;
    bar = place_in(share, to) - place_in(share, from);
    if (bar > 0.0) plan_anew(ctx, from, to, times * bar);
}

void bvxi_share_cost(bvx_context *ctx, double from, double to, double cost)
{
    const bvxi_share *const share = present_share(ctx);
    double bar;

    if (!is_planned(ctx) || !(from < to) || !(cost > 0.0)) return;
    bar = place_in(share, to) - place_in(share, from);
    if (ctx->bar_cost > 0.0) plan_anew(ctx, from, to, cost / ctx->bar_cost);
    else if (bar > 0.0) ctx->bar_cost = cost / bar;
}

int bvxi_is_watched(const bvx_context *ctx)
{
    return ctx->progress != NULL;
}

void bvxi_share_spare(bvx_context *ctx, double from)
{
    const bvxi_share *const share = present_share(ctx);
    double const cost = ctx->bar_cost;

    /* Where the call ends with this work nothing comes after it: the bar waits for the end. */
    if (!is_planned(ctx) || !(place_in(share, 1.0) < ctx->share[0].high)) return;
    plan_anew(ctx, from, 1.0, 0.0);
    if (!(ctx->bar_cost > 0.0)) ctx->bar_cost = cost;
}

void bvxi_step_begin(bvxi_steps *steps, int32_t step)
{
    bvx_context *const ctx = steps->ctx;
    bvxi_share *const outer = ctx->shares < BVXI_SHARES ? &ctx->share[ctx->shares] : NULL;
    double const from = steps->at;
    double left = 0.0, part;

    if (ctx->progress == NULL) return;
    /* What comes after this work hears of all that is left of it. */
    for (int32_t i = step; i < steps->count; i++) left += steps->cost[i];
    bvxi_share_cost(ctx, from, 1.0, left);

    /* Half of the fractions do for the step, whatever its part of the bar: the others stay for steps that
     * turn out to cost something. */
    part = left > 0.0 ? steps->cost[step] / left : 0.0;
    steps->at = step + 1 == steps->count ? 1.0
                : outer != NULL          ? 0.5 * from + 0.5
                                         : from + (1.0 - from) * part;
    if (outer != NULL && step + 1 < steps->count) {
        outer->low = place_in(outer, from);
        outer->from = from;
        outer->knee = outer->low + (outer->high - outer->low) * part;
        outer->bend = steps->at;
    }
    bvxi_share_begin(ctx, from, steps->at);
    /* A step that has been taken costs nothing any more. */
    steps->cost[step] = 0.0;
}

bvx_status bvxi_share_end(bvx_context *ctx, bvx_status status)
{
    if (ctx->progress != NULL) ctx->shares--;
    return status;
}

bvx_status bvxi_progress(bvx_context *ctx, const char *stage, double fraction)
{
    const bvxi_share *const share = present_share(ctx);
    double at;

    if (ctx->progress == NULL) return BVX_OK;
    at = place_in(share, fraction);

    /* Tests call works without a public function around them; there is no whole then. */
    if (ctx->calls != 0) {
        if (!(at <= share->high)) at = share->high;
        if (!(at >= ctx->reached)) at = ctx->reached;
        ctx->reached = at;
        ctx->stage = stage;
    }
    if (ctx->progress(ctx->progress_user, stage, at) == 0) return BVX_OK;
    return bvxi_fail(ctx, BVX_CANCELLED, "%s: cancelled by the progress callback", stage);
}

/* ---- Tasks ---- */

/* Tasks in batches, with progress and cancellation asked on the calling thread between them.
 *
 * What a task computes depends on its index only; the number of tasks follows from the work's shape. So
 * neither the threads nor the batches show in any result. */

enum { BATCHES = 8, TASKS_PER_WORKER = 16, LONG_TASKS_PER_WORKER = 2 };

#define BETWEEN_REPORTS 5e7 /* what a batch of long tasks may take [Units: nanoseconds] */

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

void bvxi_tasks(bvx_context *ctx, int32_t count, bvx_task_fn *task, void *user)
{
    if (count > 0) run(ctx, 0, count, task, user);
}

/* Without a callback nobody is asked between batches, so there is one. */
static bvx_status run_all(bvx_context *ctx, int32_t count, bvx_task_fn *task, void *user)
{
    bvxi_tasks(ctx, count, task, user);
    return BVX_OK;
}

/* Few enough batches to cost nothing, large enough to feed every worker. */
static int32_t batch_of(const bvx_context *ctx, int32_t count)
{
    int32_t const least = ctx->threads * TASKS_PER_WORKER, batch = (count + BATCHES - 1) / BATCHES;

    return batch < least && ctx->threads != 1 ? least : batch;
}

/* Workers wait for the last of a batch, so it has some tasks for each; one thread waits for none. */
static int32_t batch_of_long(const bvx_context *ctx, int32_t count, double each)
{
    int32_t const most = batch_of(ctx, count),
                  least = ctx->threads == 1 ? 1 : ctx->threads * LONG_TASKS_PER_WORKER;
    double const fits = BETWEEN_REPORTS * (double)ctx->threads / (each > 1.0 ? each : 1.0);

    if (fits >= (double)most) return most;
    if (fits <= (double)least) return least < most ? least : most;
    return (int32_t)fits;
}

static bvx_status run_batches(bvx_context *ctx, const char *stage, double from, double to, int32_t count,
                              int32_t batch, bvx_task_fn *task, void *user)
{
    /* Progress and cancellation between batches only, so tasks need not know of them. */
    for (int32_t first = 0; first < count; first += batch) {
        int32_t const n = count - first < batch ? count - first : batch;
        BVXI_TRY(bvxi_progress(ctx, stage, from + (to - from) * ((double)first / (double)count)));
        run(ctx, first, n, task, user);
    }
    /* The end too: what follows may report under another name and later, or not at all. */
    return bvxi_progress(ctx, stage, to);
}

bvx_status bvxi_parallel(bvx_context *ctx, const char *stage, double from, double to, int32_t count,
                         bvx_task_fn *task, void *user)
{
    if (ctx->progress == NULL) return run_all(ctx, count, task, user);
    return run_batches(ctx, stage, from, to, count, batch_of(ctx, count), task, user);
}

bvx_status bvxi_parallel_long(bvx_context *ctx, const char *stage, double from, double to, int32_t count,
                              double each, bvx_task_fn *task, void *user)
{
    if (ctx->progress == NULL) return run_all(ctx, count, task, user);
    return run_batches(ctx, stage, from, to, count, batch_of_long(ctx, count, each), task, user);
}

int32_t bvxi_threads(const bvx_context *ctx)
{
    return ctx->threads;
}

int32_t bvxi_cpu(const bvx_context *ctx)
{
    return ctx->cpu;
}
