/* context.h - the fields of a context. Only core/ includes this: other rooms use the calls of core.h, so
 * what a context holds can change in one room. Not installed. */
#ifndef BVXI_CONTEXT_H
#define BVXI_CONTEXT_H

#include "core.h"

/* Two-ended arena: blocks with a header each, popped when the block at the end is free. */
typedef struct bvxi_arena {
    unsigned char *memory;
    size_t size, low, high; /* results are [0, low), scratch is [high, size) */
    size_t least;           /* bytes between them when there were fewest */
} bvxi_arena;

/* Scratch that is in use, in the order in which it was taken. An arena has that in its own headers. */
typedef struct bvxi_scratch {
    void *block;
    uint64_t size, serial;
} bvxi_scratch;

enum { BVXI_SCRATCH_ROOM = 64 }; /* of the table behind the context */

typedef struct bvxi_pool bvxi_pool;

/* The part of a public call, from 0 to 1, in which a work reports. */
typedef struct bvxi_share {
    double low, high;
} bvxi_share;

enum { BVXI_WARNINGS = 12 }; /* of one call; further ones are dropped */

enum { BVXI_SHARES = 12, BVXI_SCOPES = 32 }; /* more works in each other than calls have */

struct bvx_context {
    bvx_alloc_fn *alloc;
    bvx_free_fn *free;
    void *alloc_user;
    bvxi_arena arena;
    uint64_t memory_limit, memory_used, memory_peak;
    uint64_t serial;             /* of the scratch block taken last */
    uint64_t scope[BVXI_SCOPES]; /* what it was when each scope began */
    int32_t scopes;
    bvxi_scratch *scratch;       /* by serial [Size: scratch_count, of scratch_room]; NULL in an arena */
    bvxi_scratch *scratch_first; /* the table behind the context, which does for nearly all calls */
    uint32_t scratch_count, scratch_room;
    bvx_parallel_fn *parallel;
    void *parallel_user;
    bvx_progress_fn *progress;
    void *progress_user;
    int32_t threads, cpu;
    size_t size;                   /* of the context and the pool after it */
    bvxi_pool *pool;               /* helpers of the calling thread; NULL: none */
    bvxi_share share[BVXI_SHARES]; /* the first is the call's */
    const char *stage;             /* reported last; the function's name before */
    double reached;                /* reported last */
    int32_t calls, shares;         /* public calls in each other; shares in the call's */
    const char *function;          /* the outermost public one */
    bvx_error error;               /* the last failure; its text points into message */
    char message[BVXI_MESSAGE_SIZE];
    bvx_warning warning[BVXI_WARNINGS + 1]; /* of the last call; the last one is for those that are dropped */
    int32_t warnings, warnings_read;
    char warning_text[BVXI_MESSAGE_SIZE]; /* of the one read last */
};

/* heap.c, left out of freestanding builds: the C library's heap with alignment. */
void *bvxi_heap_alloc(void *user, size_t size, size_t align);
void bvxi_heap_free(void *user, void *block, size_t size, size_t align);

/* openmp.c or threads.c: room that the helpers of so many threads need (0: none are
 * built in). begin returns 0 when it cannot; run calls task once for every
 * index of [0, count), worker below threads and 0 on the calling thread. */
size_t bvxi_pool_size(int32_t threads);
int bvxi_pool_begin(bvxi_pool *pool, int32_t threads);
void bvxi_pool_end(bvxi_pool *pool);
void bvxi_pool_run(bvxi_pool *pool, int32_t count, bvx_task_fn *task, void *user);

/* When helpers are worth their wake; what each kind of pool begins with. Times are of bvxi_now. */
typedef struct bvxi_worth {
    int32_t most, online, idle; /* helpers; processors of the machine; helpers that there are some for */
    int32_t rest;               /* how many times a wait the next rest lasts */
    int32_t eager;              /* as bvxi_pool_be_eager has it */
    int64_t alone;              /* time of steps before the first helper */
    int64_t look_at;            /* when to look for idle processors again */
    int64_t rest_until;         /* no helpers before */
} bvxi_worth;

/* processors.c: threads that this process should use, 1..BVXI_MAX_THREADS; the machine's processors, and the
 * threads of all its processes that run or want to (0: it does not say); what control groups grant, by a
 * file like /proc/self/cgroup and the folder where they are mounted (0: all). */
int32_t bvxi_processors(void);
int32_t bvxi_online_processors(void);
int32_t bvxi_running_threads(void);
int32_t bvxi_processor_quota(const char *groups, const char *mounted);
/* A clock, and the time that the calling thread had a processor [Units: ns]. */
int64_t bvxi_now(void);
int64_t bvxi_processor_time(void);
void bvxi_worth_begin(bvxi_worth *w, int32_t threads);
/* Runs tasks on the calling thread until helpers are worth their wake; returns the first that is left. */
int32_t bvxi_begin_alone(bvxi_worth *w, int32_t count, bvx_task_fn *task, void *user);
/* The caller had no tasks left at start and waited until now for helpers, which meanwhile had no processor for
 * the time lost. */
void bvxi_worth_waited(bvxi_worth *w, int64_t start, int64_t lost);
/* For tests: 1 calls helpers at once whatever a step takes and the machine
 * does, 2 also when they should rest; 0 as always. */
void bvxi_pool_be_eager(bvxi_pool *pool, int32_t how);

/* exact.c: how this build or thread would change results, for people; NULL when it would not. */
const char *bvxi_arithmetic_fault(void);

/* cpu.c: the fastest path of this processor. */
int32_t bvxi_cpu_detect(void);

#endif
