/* rows.h - one runner for tables of calls: each row with every allocation failing, cancelled at every progress
 * call, under memory limits and in arenas. A row leaves in `mark` a hash of what it made and in `left_behind` 1
 * where a call that failed left something in its result; a good run must leave the mark that it leaves when
 * nothing is in its way. */
#ifndef FAULT_ROWS_H
#define FAULT_ROWS_H

#include "fault/context.h"

typedef struct fault_row {
    const char *name;
    fault_operation_fn *run; /* its first argument is not used */
    uint64_t allocations;    /* at least; 0: it takes no memory */
    uint64_t calls;          /* of progress, at least */
    uint64_t want;           /* the mark of a good run, which the runner sets */
} fault_row;

#define FAULT_ROWS(table) table, (int)(sizeof table / sizeof *table)

static uint64_t mark;   /* a hash of what the last good run made */
static int left_behind; /* 1: a failed call left something in a result, 2: a good one made something else */

static inline bvx_status run_row(void *user, bvx_context *ctx)
{
    const fault_row *const row = user;
    bvx_status const status = row->run(NULL, ctx);
    if (status == BVX_OK && mark != row->want) left_behind = 2;
    return status;
}

/* What the row makes when nothing is in its way. */
static inline void begin_row(fault_row *row)
{
    bvx_context_options o = default_options();
    bvx_context *ctx;

    o.threads = 1;
    ctx = context_with(&o);
    left_behind = 0;
    assert_int_equal(row->run(NULL, ctx), BVX_OK);
    row->want = mark;
    bvx_context_destroy(ctx);
}

static inline void end_row(const fault_row *row, const char *wrong)
{
    if (wrong != NULL) fail_msg("%s: %s", row->name, wrong);
    if (left_behind == 1) fail_msg("%s: a failed call left something in its result", row->name);
    if (left_behind != 0) fail_msg("%s: another result than usual", row->name);
}

/* ---- The loops: one thread and three where threads could matter ---- */

static inline void fail_every_allocation(fault_row *rows, int count)
{
    for (int32_t threads = 1; threads <= 3; threads += 2)
        for (int i = 0; i < count; i++) {
            bvx_context_options o = default_options();
            uint64_t allocations = 0;
            o.threads = threads;
            begin_row(&rows[i]);
            end_row(&rows[i], fault_every_allocation(run_row, &rows[i], &o, &allocations));
            assert_true(allocations >= rows[i].allocations);
            if (rows[i].allocations == 0) assert_int_equal(allocations, 0);
        }
}

static inline void cancel_at_every_call(fault_row *rows, int count)
{
    for (int32_t threads = 1; threads <= 3; threads += 2)
        for (int i = 0; i < count; i++) {
            bvx_context_options o = default_options();
            uint64_t calls = 0;
            o.threads = threads;
            begin_row(&rows[i]);
            end_row(&rows[i], fault_every_cancel(run_row, &rows[i], &o, &calls));
            if (calls < rows[i].calls)
                fail_msg("%s: %lu calls of progress", rows[i].name, (unsigned long)calls);
        }
}

static inline void limit_memory(fault_row *rows, int count, uint64_t steps)
{
    bvx_context_options o = default_options();

    o.threads = 1;
    for (int i = 0; i < count; i++) {
        if (rows[i].allocations == 0) continue;
        begin_row(&rows[i]);
        end_row(&rows[i], fault_every_limit(run_row, &rows[i], &o, steps));
    }
}

static inline void live_in_arenas(fault_row *rows, int count, uint64_t most, uint64_t steps)
{
    bvx_context_options o = default_options();

    o.threads = 1;
    for (int i = 0; i < count; i++) {
        begin_row(&rows[i]);
        end_row(&rows[i], fault_every_arena(run_row, &rows[i], &o, most, steps));
    }
}

#endif
