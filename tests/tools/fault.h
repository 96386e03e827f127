/* fault.h - an allocator that fails where it is told to and watches what comes back, and loops over every
 * place where a call can fail. For tests of any framework: a check returns NULL when all is well, else what
 * was wrong in a line.
 *
 *   static bvx_status fill(void *user, bvx_context *ctx) { ... call, free the results, return the call's
 *   status ... }
 *   assert_null(fault_every_allocation(fill, &data, NULL, &allocations));
 *   assert_null(fault_every_cancel(fill, &data, NULL, &calls));
 *
 * The operation is run again and again, so it must leave its inputs only. It frees what it got on success
 * only: what a failed call left behind counts as a leak, as it should. */
#ifndef FAULT_H
#define FAULT_H

#include "bitvox_io.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FAULT_GUARD = 64, FAULT_FRESH = 0xCD, FAULT_GUARD_BYTE = 0xA5, FAULT_STALE = 0xDD };

/* One live block; the payload lies between two guards in raw. */
typedef struct fault_block {
    struct fault_block *next;
    unsigned char *raw, *payload;
    size_t size, align;
} fault_block;

/* Zeroed, it is an allocator that never fails. */
typedef struct fault_heap {
    uint64_t fail_at; /* this allocation returns NULL, 1 being the first; 0: none */
    int for_ever;     /* and so does each one after it */
    uint64_t asked;   /* allocations requested */
    uint64_t failed;  /* allocations refused */
    uint64_t live_blocks, live_bytes, peak_bytes;
    fault_block *blocks; /* the live ones, youngest first */
    char error[160];     /* the first wrong thing seen, or "" */
} fault_heap;

static inline void fault_note(fault_heap *heap, const char *what, size_t a, size_t b)
{
    if (heap->error[0] != 0) return;
    snprintf(heap->error, sizeof heap->error, "%s (%lu, %lu)", what, (unsigned long)a, (unsigned long)b);
}

/* A block is aligned to align and to no more, so that a caller who relies on more is found out. */
static inline void *fault_alloc(void *user, size_t size, size_t align)
{
    fault_heap *const heap = user;
    fault_block *block;

    heap->asked++;
    if (align == 0 || align > 64 || (align & (align - 1)) != 0)
        fault_note(heap, "an alignment that is none (align, size)", align, size);
    if (size == 0) fault_note(heap, "an allocation of nothing (align, size)", align, size);
    if (heap->asked == heap->fail_at ||
        (heap->for_ever && heap->fail_at != 0 && heap->asked > heap->fail_at)) {
        heap->failed++;
        return NULL;
    }
    if (size > SIZE_MAX - 2 * align - 2 * FAULT_GUARD) return NULL;
    block = malloc(sizeof *block);
    if (block == NULL) return NULL;
    block->raw = malloc(size + 2 * align + 2 * FAULT_GUARD);
    if (block->raw == NULL) {
        free(block);
        return NULL;
    }
    block->payload = block->raw + FAULT_GUARD;
    while ((uintptr_t)block->payload % (2 * align) != align) block->payload++;
    block->size = size;
    block->align = align;
    block->next = heap->blocks;
    heap->blocks = block;
    memset(block->payload - FAULT_GUARD, FAULT_GUARD_BYTE, FAULT_GUARD);
    memset(block->payload, FAULT_FRESH, size);
    memset(block->payload + size, FAULT_GUARD_BYTE, FAULT_GUARD);
    heap->live_blocks++;
    heap->live_bytes += size;
    if (heap->live_bytes > heap->peak_bytes) heap->peak_bytes = heap->live_bytes;
    return block->payload;
}

static inline void fault_check_guards(fault_heap *heap, const fault_block *block)
{
    for (size_t i = 0; i < FAULT_GUARD; i++) {
        if (block->payload[block->size + i] != FAULT_GUARD_BYTE) {
            fault_note(heap, "written behind a block (its size, bytes behind)", block->size, i);
            return;
        }
        if (block->payload[-1 - (ptrdiff_t)i] != FAULT_GUARD_BYTE) {
            fault_note(heap, "written before a block (its size, bytes before)", block->size, i + 1);
            return;
        }
    }
}

static inline void fault_free(void *user, void *memory, size_t size, size_t align)
{
    fault_heap *const heap = user;
    fault_block **link = &heap->blocks;
    fault_block *block;

    if (memory == NULL) {
        fault_note(heap, "NULL was freed (size, align)", size, align);
        return;
    }
    while (*link != NULL && (*link)->payload != memory) link = &(*link)->next;
    block = *link;
    if (block == NULL) {
        fault_note(heap, "freed twice, or never given (size, align)", size, align);
        return;
    }
    if (block->size != size) fault_note(heap, "freed with another size (given, freed)", block->size, size);
    if (block->align != align)
        fault_note(heap, "freed with another alignment (given, freed)", block->align, align);
    fault_check_guards(heap, block);
    *link = block->next;
    heap->live_blocks--;
    heap->live_bytes -= block->size;
    memset(block->payload, FAULT_STALE, block->size);
    free(block->raw);
    free(block);
}

/* Everything came back and nothing wrong was seen: NULL, else what. Takes
 * back what leaked, ready for the next run. */
static inline const char *fault_end(fault_heap *heap)
{
    static char text[200];
    uint64_t const leaked = heap->live_blocks;
    size_t const first = heap->blocks != NULL ? heap->blocks->size : 0;

    while (heap->blocks != NULL)
        fault_free(heap, heap->blocks->payload, heap->blocks->size, heap->blocks->align);
    snprintf(text, sizeof text, "%s", heap->error);
    if (text[0] == 0 && leaked != 0)
        snprintf(text, sizeof text, "%lu blocks leaked, the youngest of %lu bytes", (unsigned long)leaked,
                 (unsigned long)first);
    memset(heap, 0, sizeof *heap);
    return text[0] != 0 ? text : NULL;
}

/* Options (a copy of base, or the defaults) that take memory from heap. */
static inline bvx_context_options fault_options(const bvx_context_options *base, fault_heap *heap)
{
    bvx_context_options o = {.struct_size = sizeof o};
    if (base != NULL) o = *base;
    o.allocator.alloc = fault_alloc;
    o.allocator.free = fault_free;
    o.allocator.user = heap;
    return o;
}

/* ---- Loops over every place where a call can fail ---- */

typedef bvx_status fault_operation_fn(void *user, bvx_context *context);

/* After a failed or finished run: message, counters and memory as they must be. */
static inline const char *fault_after(bvx_context *context, bvx_status status, bvx_status expected)
{
    static char text[700];
    const char *const message = bvx_last_message(context);

    if (status != expected) {
        snprintf(text, sizeof text, "status %d (%s: %s) in place of %d", (int)status, bvx_status_text(status),
                 message, (int)expected);
        return text;
    }
    if (status != BVX_OK && message[0] == 0) return "a failure without a message";
    if (status != BVX_OK && bvx_last_error(context)->reason <= BVX_REASON_UNSPECIFIED)
        return "a failure without a reason";
    if (strchr(message, '\n') != NULL) return "a message of several lines";
    if (bvx_memory_used(context) != 0) {
        snprintf(text, sizeof text, "%lu bytes still counted as used",
                 (unsigned long)bvx_memory_used(context));
        return text;
    }
    return NULL;
}

/* again: the run was the second one, with nothing failing any more. */
static inline const char *fault_at(uint64_t n, const char *place, int again, const char *what)
{
    static char text[1000];
    snprintf(text, sizeof text, "%s%s %lu: %.700s", again ? "a good run after " : "", place, (unsigned long)n,
             what);
    return text;
}

/* Is the context to do its work once more after failure n? It is after the first few and then after each
 * fourth, with BVX_QUICK, which is for rows that are several times slower, after each 32nd, and with
 * BITVOX_LARGE after each. */
static inline int fault_works_again(uint64_t n)
{
    uint64_t const every = getenv("BVX_QUICK") != NULL ? 32 : getenv("BITVOX_LARGE") != NULL ? 1 : 4;
    return n <= 8 || n % every == 0;
}

/* One run with allocation n failing, alone or with all that follow. *failed: there is such an allocation. */
static inline const char *fault_allocation(fault_operation_fn *operation, void *user, bvx_context *context,
                                           fault_heap *heap, uint64_t n, int for_ever, int *failed)
{
    bvx_status status;

    heap->asked = heap->failed = 0;
    heap->fail_at = n;
    heap->for_ever = for_ever;
    status = operation(user, context);
    heap->fail_at = 0;
    *failed = heap->failed != 0;
    return fault_after(context, status, *failed ? BVX_ERR_MEMORY : BVX_OK);
}

/* The place after n: each one, but with BVX_QUICK, where a loop over all takes minutes, further ones lie ever
 * farther apart. */
static inline uint64_t fault_next(uint64_t n)
{
    return n + 1 + (getenv("BVX_QUICK") != NULL ? n / 16 : 0);
}

/* Run with allocation n and all that follow failing, then with it only, n = 1, 2, ... until a run asks for
 * fewer. Each failure gives BVX_ERR_MEMORY with a message, leaks nothing, and the same context does the work
 * afterwards. *allocations: how many places there are. */
static inline const char *fault_every_allocation(fault_operation_fn *operation, void *user,
                                                 const bvx_context_options *base, uint64_t *allocations)
{
    for (uint64_t n = 1;; n = fault_next(n)) {
        fault_heap heap = {0};
        bvx_context_options const o = fault_options(base, &heap);
        bvx_context *context = NULL;
        const char *wrong, *left;
        uint64_t asked;
        int failed = 0, again = 0;
        if (bvx_context_create(&o, &context) != BVX_OK) return fault_at(n, "allocation", 0, "no context");
        wrong = fault_allocation(operation, user, context, &heap, n, 1, &failed);
        if (wrong == NULL && failed) {
            wrong = fault_allocation(operation, user, context, &heap, n, 0, &failed);
            if (wrong == NULL && !failed) wrong = "a second run in the same context asks for fewer";
        }
        if (wrong == NULL && failed && fault_works_again(n)) {
            wrong = fault_after(context, operation(user, context), BVX_OK);
            again = 1;
        }
        asked = heap.asked;
        bvx_context_destroy(context);
        left = fault_end(&heap);
        if (wrong == NULL) wrong = left;
        if (wrong != NULL) return fault_at(n, "allocation", again, wrong);
        if (!failed) {
            if (allocations != NULL) *allocations = asked;
            return NULL;
        }
    }
}

typedef struct fault_progress {
    /* calls that can cancel; the report of 1 ends a public call and is not one of them */
    uint64_t calls, cancel_at;
    uint64_t ends; /* reports of 1 */
    double last;   /* fraction of the report before; 0 after an end */
    const char *wrong;
} fault_progress;

/* Fractions of a public call rise; those of works that a test calls by themselves may begin again. */
static inline int32_t fault_on_progress(void *user, const char *stage, double fraction)
{
    fault_progress *const p = user;

    if (stage == NULL || stage[0] == 0) p->wrong = "a stage without a name";
    if (!(fraction >= 0.0 && fraction <= 1.0)) p->wrong = "a fraction outside 0..1";
    if (fraction < p->last) p->wrong = "a fraction that falls";
    if (p->cancel_at != 0 && p->calls >= p->cancel_at) p->wrong = "called again after it asked to stop";
    p->last = fraction < 1.0 ? fraction : 0.0;
    if (fraction >= 1.0) p->ends++;
    return fraction < 1.0 && ++p->calls == p->cancel_at;
}

/* Run with progress call n asking to stop, n = 1, 2, ... until a run makes fewer. Each gives BVX_CANCELLED,
 * leaks nothing, and the same context does the work afterwards. *calls: how many progress calls there are. */
static inline const char *fault_every_cancel(fault_operation_fn *operation, void *user,
                                             const bvx_context_options *base, uint64_t *calls)
{
    for (uint64_t n = 1;; n = fault_next(n)) {
        fault_heap heap = {0};
        fault_progress progress = {0};
        bvx_context_options o = fault_options(base, &heap);
        bvx_context *context = NULL;
        const char *wrong = NULL, *left;
        int cancelled, again = 0;
        o.progress.call = fault_on_progress;
        o.progress.user = &progress;
        progress.cancel_at = n;
        if (bvx_context_create(&o, &context) != BVX_OK) return fault_at(n, "progress call", 0, "no context");
        {
            bvx_status const status = operation(user, context);
            cancelled = progress.calls >= n;
            wrong = fault_after(context, status, cancelled ? BVX_CANCELLED : BVX_OK);
        }
        if (wrong == NULL) wrong = progress.wrong;
        if (wrong == NULL && cancelled && fault_works_again(n)) {
            memset(&progress, 0, sizeof progress);
            wrong = fault_after(context, operation(user, context), BVX_OK);
            again = 1;
        }
        bvx_context_destroy(context);
        left = fault_end(&heap);
        if (wrong == NULL) wrong = left;
        if (wrong != NULL) return fault_at(n, "progress call", again, wrong);
        if (!cancelled) {
            if (calls != NULL) *calls = progress.calls;
            return NULL;
        }
    }
}

/* What the operation takes at most when nothing is in its way; NULL and *need, else what was wrong. */
static inline const char *fault_peak(fault_operation_fn *operation, void *user,
                                     const bvx_context_options *base, uint64_t *need)
{
    fault_heap heap = {0};
    bvx_context_options const o = fault_options(base, &heap);
    bvx_context *context = NULL;
    const char *wrong, *left;

    if (bvx_context_create(&o, &context) != BVX_OK) return "no context";
    bvx_memory_reset_peak(context);
    wrong = fault_after(context, operation(user, context), BVX_OK);
    *need = bvx_memory_peak(context);
    bvx_context_destroy(context);
    left = fault_end(&heap);
    return wrong != NULL ? wrong : left;
}

/* Run under steps memory limits spread over 1 .. peak - 1, each of which gives BVX_ERR_BUDGET and is kept,
 * and under the peak itself, which is enough. */
static inline const char *fault_every_limit(fault_operation_fn *operation, void *user,
                                            const bvx_context_options *base, uint64_t steps)
{
    uint64_t need = 0;
    const char *const first = fault_peak(operation, user, base, &need);

    if (first != NULL) return first;
    if (need < 2) return "an operation that takes no memory";
    for (uint64_t n = 0; n <= steps; n++) {
        fault_heap heap = {0};
        bvx_context_options o = fault_options(base, &heap);
        bvx_context *context = NULL;
        const char *wrong, *left;
        o.memory_limit = n == steps ? need : 1 + (need - 2) * n / (steps - 1);
        if (bvx_context_create(&o, &context) != BVX_OK)
            return fault_at(o.memory_limit, "limit", 0, "no context");
        wrong = fault_after(context, operation(user, context), n == steps ? BVX_OK : BVX_ERR_BUDGET);
        if (wrong == NULL && n < steps && strstr(bvx_last_message(context), "limit") == NULL)
            wrong = "a message that names no limit";
        if (wrong == NULL && bvx_memory_peak(context) > o.memory_limit) wrong = "more memory than the limit";
        bvx_context_destroy(context);
        left = fault_end(&heap);
        if (wrong == NULL) wrong = left;
        if (wrong != NULL) return fault_at(o.memory_limit, "limit", 0, wrong);
    }
    return NULL;
}

/* Run twice in each of steps arenas of up to most bytes, small ones closer together: both times the same,
 * BVX_OK or BVX_ERR_MEMORY, and the largest arena is enough. */
static inline const char *fault_every_arena(fault_operation_fn *operation, void *user,
                                            const bvx_context_options *base, uint64_t most, uint64_t steps)
{
    unsigned char *const memory = malloc((size_t)most);
    const char *wrong = memory == NULL ? "no memory for the arena" : NULL;

    for (uint64_t n = 1; n <= steps && wrong == NULL; n++) {
        bvx_context_options o = {.struct_size = sizeof o};
        bvx_context *context = NULL;
        if (base != NULL) o = *base;
        o.arena.memory = memory;
        o.arena.size = 4096 + (most - 4096) * n * n / steps / steps;
        if (bvx_context_create(&o, &context) != BVX_OK) {
            wrong = "no context";
        } else {
            bvx_status const first = operation(user, context);
            wrong = fault_after(context, first,
                                first == BVX_ERR_MEMORY && n < steps ? BVX_ERR_MEMORY : BVX_OK);
            /* all of it came back */
            if (wrong == NULL) wrong = fault_after(context, operation(user, context), first);
        }
        bvx_context_destroy(context);
        if (wrong != NULL) wrong = fault_at(o.arena.size, "arena", 0, wrong);
    }
    free(memory);
    return wrong;
}

#endif
