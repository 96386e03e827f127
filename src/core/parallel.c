/* parallel.c - tasks in batches, and the one fraction from 0 to 1 that a public call reports.
 *
 * Guarantee: what a task computes depends on its index, and the number of tasks on the shape of the work, so
 * the number of threads shows in no result. */
#include "context.h"

/* ---- Progress ---- */

/* Works report fractions of their own, from 0 to 1, and know nothing of each other. The context holds the
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

static double place_in(const bvxi_share *s, double fraction)
{
    return s->low + (s->high - s->low) * fraction;
}

void bvxi_call_begin(bvx_context *ctx, const char *function)
{
    bvxi_scope_begin(ctx);
    if (ctx->calls++ != 0) return;
    ctx->stage = ctx->function = function;
    ctx->warnings = ctx->warnings_read = 0;
    /* Without a callback nobody looks at shares. */
    if (ctx->progress == NULL) return;
    ctx->shares = 0;
    ctx->share[0] = (bvxi_share){.low = 0.0, .high = BEFORE_END};
    ctx->reached = 0.0;
}

bvx_status bvxi_call_end(bvx_context *ctx, bvx_status status)
{
    (void)bvxi_scope_end(ctx, status);
    if (--ctx->calls != 0) return status;
    if (status != BVX_OK) ctx->warnings = 0;
    /* The results are there and stay: what the callback answers is not heard. */
    if (status == BVX_OK && ctx->progress != NULL) (void)ctx->progress(ctx->progress_user, ctx->stage, 1.0);
    return status;
}

void bvxi_share_begin(bvx_context *ctx, double from, double to)
{
    const bvxi_share *const outer = present_share(ctx);
    if (ctx->progress == NULL) return;
    bvxi_share share = {.low = place_in(outer, from), .high = place_in(outer, to)};
    if (++ctx->shares < BVXI_SHARES) ctx->share[ctx->shares] = share;
}

bvx_status bvxi_share_end(bvx_context *ctx, bvx_status status)
{
    if (ctx->progress != NULL) ctx->shares--;
    return status;
}

bvx_status bvxi_progress(bvx_context *ctx, const char *stage, double fraction)
{
    const bvxi_share *const share = present_share(ctx);

    if (ctx->progress == NULL) return BVX_OK;
    double at = place_in(share, fraction);

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
    if (ctx->threads == 1 || count == 1 || (ctx->parallel == NULL && ctx->pool == NULL)) {
        for (int32_t i = 0; i < count; i++) task(user, first + i, 0);
    } else if (ctx->parallel != NULL) {
        ctx->parallel(ctx->parallel_user, count, run_shifted, &s);
    } else {
        bvxi_pool_run(ctx->pool, count, run_shifted, &s);
    }
}

/* Without a callback nobody is asked between batches, so there is one. */
static bvx_status run_all(bvx_context *ctx, int32_t count, bvx_task_fn *task, void *user)
{
    if (count > 0) run(ctx, 0, count, task, user);
    return BVX_OK;
}

/* Few enough batches to cost nothing, large enough to feed every worker. */
static int32_t batch_of(const bvx_context *ctx, int32_t count)
{
    int32_t const least = ctx->threads * TASKS_PER_WORKER, batch = (count + BATCHES - 1) / BATCHES;
    return batch < least && ctx->threads != 1 ? least : batch;
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
    /* Workers wait for the last of a batch, so it has some tasks for each; one thread waits for none. */
    int32_t const most = batch_of(ctx, count),
                  few = ctx->threads == 1 ? 1 : ctx->threads * LONG_TASKS_PER_WORKER;
    double const fits = BETWEEN_REPORTS * (double)ctx->threads / (each > 1.0 ? each : 1.0);
    int32_t const least = few < most ? few : most;
    int32_t const batch = fits >= (double)most ? most : fits <= (double)least ? least : (int32_t)fits;
    return run_batches(ctx, stage, from, to, count, batch, task, user);
}

/* Items and ranges, which do not depend on who computes them. */
typedef struct plain_tasks {
    bvxi_item_fn *item; /* one of the three */
    bvxi_range_fn *range;
    bvxi_piece_fn *piece;
    void *user;
    uint64_t count;
    int32_t pieces;
} plain_tasks;

static void run_plain(void *user, int32_t index, int32_t worker)
{
    const plain_tasks *const p = user;
    uint64_t begin, end;

    (void)worker;
    if (p->item != NULL) {
        p->item(p->user, index);
        return;
    }
    bvxi_piece(p->count, p->pieces, index, &begin, &end);
    if (p->piece != NULL) p->piece(p->user, index, begin, end);
    else p->range(p->user, begin, end);
}

void bvxi_tasks(bvx_context *ctx, int32_t count, bvxi_item_fn *item, void *user)
{
    plain_tasks p = {.item = item, .user = user};
    (void)run_all(ctx, count, run_plain, &p);
}

void bvxi_ranges(bvx_context *ctx, int32_t pieces, uint64_t count, bvxi_piece_fn *body, void *user)
{
    plain_tasks p = {.piece = body, .user = user, .count = count, .pieces = pieces};
    (void)run_all(ctx, pieces, run_plain, &p);
}

bvx_status bvxi_each(bvx_context *ctx, const char *stage, double from, double to, int32_t count,
                     bvxi_item_fn *item, void *user)
{
    plain_tasks p = {.item = item, .user = user};
    return bvxi_parallel(ctx, stage, from, to, count, run_plain, &p);
}

bvx_status bvxi_each_long(bvx_context *ctx, const char *stage, double from, double to, int32_t count,
                          double each, bvxi_item_fn *item, void *user)
{
    plain_tasks p = {.item = item, .user = user};
    return bvxi_parallel_long(ctx, stage, from, to, count, each, run_plain, &p);
}

bvx_status bvxi_for(bvx_context *ctx, const char *stage, uint64_t count, uint64_t grain, bvxi_range_fn *body,
                    void *user)
{
    return bvxi_for_ranges(ctx, stage, 0.0, 1.0, bvxi_piece_count(count, grain), count, body, user);
}

bvx_status bvxi_for_ranges(bvx_context *ctx, const char *stage, double from, double to, int32_t pieces,
                           uint64_t count, bvxi_range_fn *body, void *user)
{
    plain_tasks p = {.range = body, .user = user, .count = count, .pieces = pieces};
    return bvxi_parallel(ctx, stage, from, to, pieces, run_plain, &p);
}

bvx_status bvxi_for_pieces(bvx_context *ctx, const char *stage, double from, double to, int32_t pieces,
                           uint64_t count, bvxi_piece_fn *body, void *user)
{
    plain_tasks p = {.piece = body, .user = user, .count = count, .pieces = pieces};
    return bvxi_parallel(ctx, stage, from, to, pieces, run_plain, &p);
}

int32_t bvxi_threads(const bvx_context *ctx)
{
    return ctx->threads;
}

int32_t bvxi_cpu(const bvx_context *ctx)
{
    return ctx->cpu;
}
