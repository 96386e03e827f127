/* fault.h - an allocator that fails where it is told to and watches what comes back, and loops over every
 * place where a call can fail. A place is a chain of calls: it fails the 1st, 2nd, 4th, 8th ... and the last
 * time that it is reached, with BITVOX_LARGE each time. For tests of any framework: a check returns NULL when
 * all is well, else what was wrong in a line.
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

/* Machines whose compilers write down how to unwind each function. */
#if defined(__GNUC__) && (defined(__x86_64__) || defined(__i386__) || defined(__s390x__)) && !defined(_WIN32)
#include <unwind.h>
#define FAULT_CHAINS 1
#endif

enum { FAULT_GUARD = 64, FAULT_FRESH = 0xCD, FAULT_GUARD_BYTE = 0xA5, FAULT_STALE = 0xDD };

/* ---- Places ---- */

/* The places of a run in the order in which they were reached, each by a hash of its chain of calls. */
typedef struct fault_places {
    uint64_t *chain;
    uint64_t count;
} fault_places;

#ifdef FAULT_CHAINS
static inline _Unwind_Reason_Code fault_frame(struct _Unwind_Context *frame, void *hash)
{
    *(uint64_t *)hash = (*(uint64_t *)hash ^ (uint64_t)_Unwind_GetIP(frame)) * 0x100000001B3u;
    return _URC_NO_REASON;
}
#endif

/* Without chains each time is a place of its own. */
static inline void fault_reach(fault_places *places)
{
    uint64_t const n = places->count++;
    int const is_full = (n & (n - 1)) == 0; /* rooms are doubled: 2, 2, 4, 8 ... */
    size_t const room = (size_t)(n == 0 ? 2 : 2 * n);
    uint64_t *const chain = is_full ? realloc(places->chain, room * sizeof *chain) : places->chain;

    if (chain == NULL) abort();
    places->chain = chain;
    chain[n] = 0;
#ifdef FAULT_CHAINS
    (void)_Unwind_Backtrace(fault_frame, &chain[n]);
#else
    chain[n] = n;
#endif
}

/* Is time n of the run, 1 being the first, to fail? Where a run reaches more than was seen each one is. */
static inline int fault_is_due(const fault_places *places, uint64_t n)
{
    uint64_t times = 0, later = 0;

    if (n > places->count || getenv("BITVOX_LARGE") != NULL) return 1;
    for (uint64_t i = 0; i < n; i++) times += places->chain[i] == places->chain[n - 1];
    for (uint64_t i = n; i < places->count && later == 0; i++)
        later = places->chain[i] == places->chain[n - 1];
    return later == 0 || (times & (times - 1)) == 0;
}

/* ---- The allocator ---- */

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
    fault_block *blocks;  /* the live ones, youngest first */
    fault_places *places; /* NULL, or where each allocation is written down */
    char error[160];      /* the first wrong thing seen, or "" */
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
    if (heap->places != NULL) fault_reach(heap->places);
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

/* Is the context to do its work once more after failing run n? What a failure leaves in a context does not depend
 * on what failed, so it does after the first few and then after each 16th, with BVX_QUICK, which is for rows that
 * are several times slower, after each 64th, and with BITVOX_LARGE after each. */
static inline int fault_works_again(uint64_t n)
{
    uint64_t const every = getenv("BVX_QUICK") != NULL ? 64 : getenv("BITVOX_LARGE") != NULL ? 1 : 16;
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

/* The next time to fail after n. With BVX_QUICK, where a loop over all takes minutes, they lie ever farther
 * apart. */
static inline uint64_t fault_next(const fault_places *places, uint64_t n)
{
    n += 1 + (getenv("BVX_QUICK") != NULL ? n / 2 : 0);
    while (!fault_is_due(places, n)) n++;
    return n;
}

typedef struct fault_progress {
    /* calls that can cancel; the report of 1 ends a public call and is not one of them */
    uint64_t calls, cancel_at;
    uint64_t ends; /* reports of 1 */
    double last;   /* fraction of the report before; 0 after an end */
    const char *wrong;
    fault_places *places; /* NULL, or where each such call is written down */
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
    if (fraction < 1.0 && p->places != NULL) fault_reach(p->places);
    return fraction < 1.0 && ++p->calls == p->cancel_at;
}

/* The allocations of a run with nothing in its way, or with cancels its progress calls. What the run comes to
 * does not matter here: the loops end with such a run, and look at it. */
static inline fault_places fault_look(fault_operation_fn *operation, void *user,
                                      const bvx_context_options *base, int cancels)
{
    fault_places places = {0};
    fault_heap heap = {0};
    fault_progress progress = {0};
    bvx_context_options o = fault_options(base, &heap);
    bvx_context *context = NULL;

    if (cancels) {
        o.progress.call = fault_on_progress;
        o.progress.user = &progress;
        progress.places = &places;
    }
    if (bvx_context_create(&o, &context) == BVX_OK) {
        if (!cancels) heap.places = &places;
        (void)operation(user, context);
        heap.places = NULL;
    }
    bvx_context_destroy(context);
    (void)fault_end(&heap);
    return places;
}

/* One context with allocation n and all that follow failing, then with it only; where none followed that would
 * be the same again. again: then it does its work. *asked: allocations of the run; *failed: there is an n. */
static inline const char *fault_one_allocation(fault_operation_fn *operation, void *user,
                                               const bvx_context_options *base, uint64_t n, int again,
                                               uint64_t *asked, int *failed)
{
    fault_heap heap = {0};
    bvx_context_options const o = fault_options(base, &heap);
    bvx_context *context = NULL;
    const char *wrong, *left;
    int worked = 0;

    *failed = 0;
    if (bvx_context_create(&o, &context) != BVX_OK) return fault_at(n, "allocation", 0, "no context");
    wrong = fault_allocation(operation, user, context, &heap, n, 1, failed);
    if (wrong == NULL && heap.failed > 1) {
        wrong = fault_allocation(operation, user, context, &heap, n, 0, failed);
        if (wrong == NULL && !*failed) wrong = "a second run in the same context asks for fewer";
    }
    if (wrong == NULL && *failed && again) {
        wrong = fault_after(context, operation(user, context), BVX_OK);
        worked = 1;
    }

    *asked = heap.asked;
    bvx_context_destroy(context);
    left = fault_end(&heap);
    if (wrong == NULL) wrong = left;
    return wrong != NULL ? fault_at(n, "allocation", worked, wrong) : NULL;
}

/* For each n that is due, until a run asks for fewer. Each failure gives BVX_ERR_MEMORY with a message, leaks
 * nothing, and the same context does the work afterwards. *allocations: how many there are. */
static inline const char *fault_every_allocation(fault_operation_fn *operation, void *user,
                                                 const bvx_context_options *base, uint64_t *allocations)
{
    fault_places places = fault_look(operation, user, base, 0);
    const char *wrong = NULL;
    uint64_t n = 0, asked = 0;
    int failed = 1;

    for (uint64_t run = 1; wrong == NULL && failed; run++) {
        n = fault_next(&places, n);
        wrong = fault_one_allocation(operation, user, base, n, fault_works_again(run), &asked, &failed);
    }
    free(places.chain);
    if (wrong == NULL && allocations != NULL) *allocations = asked;
    return wrong;
}

/* One context with progress call n asking to stop. again: then it does its work. *calls: those of the run;
 * *cancelled: there is an n. */
static inline const char *fault_one_cancel(fault_operation_fn *operation, void *user,
                                           const bvx_context_options *base, uint64_t n, int again,
                                           uint64_t *calls, int *cancelled)
{
    fault_heap heap = {0};
    fault_progress progress = {.cancel_at = n};
    bvx_context_options o = fault_options(base, &heap);
    bvx_context *context = NULL;
    const char *wrong, *left;
    bvx_status status;
    int worked = 0;

    o.progress.call = fault_on_progress;
    o.progress.user = &progress;
    if (bvx_context_create(&o, &context) != BVX_OK) return fault_at(n, "progress call", 0, "no context");
    status = operation(user, context);
    *calls = progress.calls;
    *cancelled = progress.calls >= n;
    wrong = fault_after(context, status, *cancelled ? BVX_CANCELLED : BVX_OK);
    if (wrong == NULL) wrong = progress.wrong;
    if (wrong == NULL && *cancelled && again) {
        memset(&progress, 0, sizeof progress);
        wrong = fault_after(context, operation(user, context), BVX_OK);
        worked = 1;
    }

    bvx_context_destroy(context);
    left = fault_end(&heap);
    if (wrong == NULL) wrong = left;
    return wrong != NULL ? fault_at(n, "progress call", worked, wrong) : NULL;
}

/* For each n that is due, until a run makes fewer. Each gives BVX_CANCELLED, leaks nothing, and the same
 * context does the work afterwards. *calls: how many progress calls there are. */
static inline const char *fault_every_cancel(fault_operation_fn *operation, void *user,
                                             const bvx_context_options *base, uint64_t *calls)
{
    fault_places places = fault_look(operation, user, base, 1);
    const char *wrong = NULL;
    uint64_t n = 0, made = 0;
    int cancelled = 1;

    for (uint64_t run = 1; wrong == NULL && cancelled; run++) {
        n = fault_next(&places, n);
        wrong = fault_one_cancel(operation, user, base, n, fault_works_again(run), &made, &cancelled);
    }
    free(places.chain);
    if (wrong == NULL && calls != NULL) *calls = made;
    return wrong;
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

/* With BVX_QUICK a third of the memory limits and arenas: their sizes lie farther apart. */
static inline uint64_t fault_steps(uint64_t steps)
{
    return getenv("BVX_QUICK") != NULL ? 2 + steps / 3 : steps;
}

/* Run under steps memory limits spread over 1 .. peak - 1, each of which gives BVX_ERR_BUDGET and is kept,
 * and under the peak itself, which is enough. */
static inline const char *fault_every_limit(fault_operation_fn *operation, void *user,
                                            const bvx_context_options *base, uint64_t steps)
{
    uint64_t need = 0;
    const char *const first = fault_peak(operation, user, base, &need);

    steps = fault_steps(steps);
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

    steps = fault_steps(steps);
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
