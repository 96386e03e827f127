/* test_watching.c - the watching allocator and its loops find what they are there to find. */
#include "fault/context.h"

static void test_alloc_aligns_to_no_more_than_asked(void **state)
{
    fault_heap heap = {0};

    (void)state;
    for (size_t align = 1; align <= 64; align *= 2) {
        void *const a = fault_alloc(&heap, 10, align);
        assert_int_equal((uintptr_t)a % (2 * align), align);
        fault_free(&heap, a, 10, align);
    }
    assert_null(fault_end(&heap));
}

static void test_end_sees_a_leak(void **state)
{
    fault_heap heap = {0};
    (void)state;
    assert_non_null(fault_alloc(&heap, 10, 64));
    assert_non_null(strstr(fault_end(&heap), "1 blocks leaked, the youngest of 10 bytes"));
    assert_null(fault_end(&heap));
}

static void test_free_sees_another_size_or_alignment(void **state)
{
    fault_heap heap = {0};
    (void)state;
    fault_free(&heap, fault_alloc(&heap, 10, 64), 11, 64);
    assert_non_null(strstr(fault_end(&heap), "another size (given, freed) (10, 11)"));
    fault_free(&heap, fault_alloc(&heap, 10, 64), 10, 32);
    assert_non_null(strstr(fault_end(&heap), "another alignment (given, freed) (64, 32)"));
}

static void test_free_sees_a_block_freed_twice(void **state)
{
    fault_heap heap = {0};
    void *const a = fault_alloc(&heap, 10, 64);
    (void)state;
    fault_free(&heap, a, 10, 64);
    fault_free(&heap, a, 10, 64);
    assert_non_null(strstr(fault_end(&heap), "freed twice"));
}

static void test_free_sees_writes_outside_the_block(void **state)
{
    fault_heap heap = {0};

    /* volatile: or a compiler sees it too, and warns */
    unsigned char *volatile a = fault_alloc(&heap, 10, 64);
    (void)state;
    a[10] = 0;
    fault_free(&heap, a, 10, 64);
    assert_non_null(strstr(fault_end(&heap), "written behind a block (its size, bytes behind) (10, 0)"));
    a = fault_alloc(&heap, 10, 64);
    a[-3] = 0;
    fault_free(&heap, a, 10, 64);
    assert_non_null(strstr(fault_end(&heap), "written before a block (its size, bytes before) (10, 3)"));
}

static bvx_status keep_a_block(void *user, bvx_context *ctx)
{
    void *block;
    (void)user;
    return bvxi_alloc(ctx, BVXI_RESULT, 10, "a block", &block);
}

static bvx_status swallow_the_failure(void *user, bvx_context *ctx)
{
    void *block = NULL;
    (void)user;
    if (bvxi_alloc(ctx, BVXI_RESULT, 10, "a block", &block) == BVX_OK) bvxi_free(ctx, block, 10);
    return BVX_OK;
}

/* Tidies up only where it gets a block to do so with. */
static bvx_status leak_when_all_fails(void *user, bvx_context *ctx)
{
    void *a, *b;
    bvx_status status = bvxi_alloc(ctx, BVXI_SCRATCH, 10, "a block", &a);

    (void)user;
    if (status != BVX_OK) return status;
    status = bvxi_alloc(ctx, BVXI_SCRATCH, 20, "a block", &b);
    if (status == BVX_OK) bvxi_free(ctx, b, 20);
    else if (bvxi_alloc(ctx, BVXI_SCRATCH, 5, "a spare block", &b) != BVX_OK) return status;
    else bvxi_free(ctx, b, 5);
    bvxi_free(ctx, a, 10);
    return status;
}

static bvx_status go_on_when_cancelled(void *user, bvx_context *ctx)
{
    (void)user;
    for (int i = 0; i < 4; i++) bvxi_progress(ctx, "stage", i / 4.0);
    return bvxi_progress(ctx, "stage", 1.0);
}

static bvx_status two_blocks(void *user, bvx_context *ctx)
{
    void *a, *b;
    bvx_status status = bvxi_alloc(ctx, BVXI_SCRATCH, 10, "a block", &a);

    (void)user;
    if (status != BVX_OK) return status;
    status = bvxi_progress(ctx, "stage", 0.0);
    if (status == BVX_OK) status = bvxi_alloc(ctx, BVXI_RESULT, 20, "a block", &b);
    if (status == BVX_OK) bvxi_free(ctx, b, 20);
    bvxi_free(ctx, a, 10);
    return status;
}

enum { ROUNDS = 100 };

/* A round for each of many times, with a step of its own before and after; runs: how often this was begun. */
static bvx_status go_round(void *user, bvx_context *ctx)
{
    void *a, *b;
    bvx_status status = bvxi_alloc(ctx, BVXI_SCRATCH, 10, "a block", &a);

    ++*(int *)user;
    if (status != BVX_OK) return status;
    for (int i = 0; i < ROUNDS && status == BVX_OK; i++) {
        status = bvxi_progress(ctx, "stage", i / (double)ROUNDS);
        if (status == BVX_OK) status = bvxi_alloc(ctx, BVXI_SCRATCH, 20, "a block", &b);
        if (status == BVX_OK) bvxi_free(ctx, b, 20);
    }
    if (status == BVX_OK) status = bvxi_alloc(ctx, BVXI_SCRATCH, 30, "a block", &b);
    if (status == BVX_OK) bvxi_free(ctx, b, 30);
    bvxi_free(ctx, a, 10);
    return status;
}

/* Of a hundred times at one place the 1st, 2nd, 4th ... 64th and last fail. */
static void test_the_loops_tell_places_apart(void **state)
{
#ifdef FAULT_CHAINS
    int const all = getenv("BITVOX_LARGE") != NULL;
#else
    int const all = 1;
#endif
    int const brief = getenv("BVX_QUICK") != NULL;
    uint64_t n = 0;
    int runs = 0;

    (void)state;
    assert_null(fault_every_allocation(go_round, &runs, NULL, &n));
    assert_int_equal(n, ROUNDS + 2);
    if (!brief) assert_in_range(runs, all ? 2 * n : 2 + 8 + 2, all ? 4 * n : 3 * (2 + 8 + 2));
    runs = 0;
    assert_null(fault_every_cancel(go_round, &runs, NULL, &n));
    assert_int_equal(n, ROUNDS);
    if (!brief) assert_in_range(runs, all ? n : 8 + 2, all ? 3 * n : 3 * (8 + 2));
}

static void test_the_loops_visit_every_place(void **state)
{
    uint64_t n = 99;
    (void)state;
    assert_null(fault_every_allocation(two_blocks, NULL, NULL, &n));
    assert_int_equal(n, 2);
    assert_null(fault_every_cancel(two_blocks, NULL, NULL, &n));
    assert_int_equal(n, 1);
}

static void test_the_loop_over_allocations_sees_what_is_wrong(void **state)
{
    (void)state;
    assert_non_null(
        strstr(fault_every_allocation(keep_a_block, NULL, NULL, NULL), "10 bytes still counted as used"));
    assert_non_null(strstr(fault_every_allocation(swallow_the_failure, NULL, NULL, NULL), "status 0"));
    assert_non_null(strstr(fault_every_allocation(leak_when_all_fails, NULL, NULL, NULL),
                           "allocation 2: 10 bytes still counted as used"));
}

static void test_the_loop_over_cancels_sees_what_is_wrong(void **state)
{
    (void)state;
    assert_non_null(
        strstr(fault_every_cancel(keep_a_block, NULL, NULL, NULL), "10 bytes still counted as used"));
    assert_non_null(strstr(fault_every_cancel(go_on_when_cancelled, NULL, NULL, NULL), "status 0"));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_alloc_aligns_to_no_more_than_asked),
        cmocka_unit_test(test_end_sees_a_leak),
        cmocka_unit_test(test_free_sees_another_size_or_alignment),
        cmocka_unit_test(test_free_sees_a_block_freed_twice),
        cmocka_unit_test(test_free_sees_writes_outside_the_block),
        cmocka_unit_test(test_the_loops_visit_every_place),
        cmocka_unit_test(test_the_loops_tell_places_apart),
        cmocka_unit_test(test_the_loop_over_allocations_sees_what_is_wrong),
        cmocka_unit_test(test_the_loop_over_cancels_sees_what_is_wrong),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
