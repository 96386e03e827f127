/* context.h - the context's own fields; only core/ includes this. */
#ifndef BVXI_CONTEXT_H
#define BVXI_CONTEXT_H

#include "core.h"

/* Two-ended arena: blocks with a header each, popped when the block at the end is free. */
typedef struct bvxi_arena {
    unsigned char *memory;
    size_t size, low, high; /* results are [0, low), scratch is [high, size) */
} bvxi_arena;

struct bvx_context {
    bvx_alloc_fn *alloc;
    bvx_free_fn *free;
    void *alloc_user;
    bvxi_arena arena;
    uint64_t memory_limit, memory_used, memory_peak;
    bvx_parallel_fn *parallel;
    void *parallel_user;
    bvx_progress_fn *progress;
    void *progress_user;
    int32_t threads, cpu;
    char message[BVXI_MESSAGE_SIZE];
};

void *bvxi_arena_alloc(bvxi_arena *arena, int kind, size_t size);
void bvxi_arena_free(bvxi_arena *arena, void *block);

/* heap.c, left out of freestanding builds: the C library's heap with alignment. */
void *bvxi_heap_alloc(void *user, size_t size, size_t align);
void bvxi_heap_free(void *user, void *block, size_t size, size_t align);

/* openmp.c: threads that OpenMP offers (0: not built in, or in a forked child), and its parallel-for. */
int32_t bvxi_openmp_threads(void);
void bvxi_openmp_run(int32_t threads, int32_t count, bvx_task_fn *task, void *user);

/* cpu.c: the fastest path of this processor. */
int32_t bvxi_cpu_detect(void);

#endif
