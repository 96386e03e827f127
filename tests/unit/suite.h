/* suite.h - what a suite of unit tests stands on: a context whose blocks lie between guards, and after each test
 * the check that all of them came back.
 *
 *   void setUp(void)
 *   {
 *       suite_open(1);
 *       seed = 12;
 *   }
 *
 *   void tearDown(void)
 *   {
 *       bvx_grid_free(ctx, &grid);
 *       suite_close();
 *   }
 *
 * A suite that opens contexts of its own kinds (test_memory.c, test_threads.c, test_progress.c) or none does
 * without. */
#ifndef SUITE_H
#define SUITE_H

#include "core/core.h" /* before the names below, which its functions have too */
#include "tools/fault.h"
#include "unity.h"

static bvx_context *ctx; /* the suite's, opened before each test */
static fault_heap suite_heap;
static int quick;    /* on emulated machines: fewer trials */
static int long_run; /* with BITVOX_LARGE: all trials, also those that take minutes */

/* Trials of random inputs: few on emulated machines, as many as take every branch several times, or all. */
static inline int32_t trial_count(int32_t few, int32_t usual, int32_t all)
{
    return quick ? few : long_run ? all : usual;
}

/* Defaults but for threads (0: as many as the machine has processors) and the code for vectors. */
static inline bvx_context_options suite_options(int32_t threads, int32_t cpu)
{
    bvx_context_options o = {.struct_size = sizeof o};
    o.threads = threads;
    o.cpu = cpu;
    return o;
}

/* A context beside the suite's, over the same heap, so that what one made the other may free; the test destroys
 * it. */
static inline bvx_context *suite_context(int32_t threads, int32_t cpu)
{
    bvx_context_options const plain = suite_options(threads, cpu), o = fault_options(&plain, &suite_heap);
    bvx_context *made = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &made));
    return made;
}

/* The suite's context by other options, over the watched heap. */
static inline void suite_open_with(const bvx_context_options *options)
{
    bvx_context_options const o = fault_options(options, &suite_heap);
    quick = getenv("BVX_QUICK") != NULL;
    long_run = getenv("BITVOX_LARGE") != NULL;
    ctx = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
}

static inline void suite_open(int32_t threads)
{
    bvx_context_options const o = suite_options(threads, BVX_CPU_BEST);
    suite_open_with(&o);
}

/* The last step of tearDown: nothing is held, and no block leaked, was freed twice or written beside. */
static inline void suite_close(void)
{
    uint64_t const held = bvx_memory_used(ctx);
    const char *wrong;

    bvx_context_destroy(ctx);
    ctx = NULL;
    wrong = fault_end(&suite_heap);
    fflush(stdout); /* a leak detector ends the program without */
    TEST_ASSERT_NULL_MESSAGE(wrong, wrong);
    TEST_ASSERT_EQUAL_UINT64(0, held);
}

#endif
