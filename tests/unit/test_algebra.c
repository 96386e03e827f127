/* test_algebra.c - union, intersection, difference, xor and complement, against looking at each voxel. */
#include "algebra_support.h"

static bvx_grid a, b, made, slow;

void setUp(void)
{
    suite_open(1);
    seed = 77;
}

void tearDown(void)
{
    bvx_grid_free(ctx, &a);
    bvx_grid_free(ctx, &b);
    bvx_grid_free(ctx, &made);
    bvx_grid_free(ctx, &slow);
    suite_close();
}

static void make_operands(int32_t x, int32_t y, int32_t z)
{
    static const int32_t low[3] = {3, 1, 2}, more[3] = {4, 0, 1};
    int32_t const size[3] = {x, y, z};

    bvx_grid_free(ctx, &a);
    bvx_grid_free(ctx, &b);
    bvx_grid_free(ctx, &slow);
    a = algebra_grid(size, low, more);
    b = algebra_grid(size, low, more);
    slow = algebra_grid(size, low, more);
    algebra_scatter(&a, 40);
    algebra_scatter(&b, 60);
}

static int of_voxel(int op, int p, int q)
{
    return op == 0 ? p || q : op == 1 ? p && q : op == 2 ? p && !q : op == 3 ? p != q : !p;
}

static void combine_slowly(int op)
{
    for (int32_t z = 0; z < a.size[2]; z++)
        for (int32_t y = 0; y < a.size[1]; y++)
            for (int32_t x = 0; x < a.size[0]; x++)
                bvx_grid_set(&slow, x, y, z,
                             of_voxel(op, bvx_grid_get(&a, x, y, z), bvx_grid_get(&b, x, y, z)));
}

static bvx_status combine(bvx_context *context, int op, const bvx_grid *p, const bvx_grid *q,
                          bvx_grid *result)
{
    return op < 4 ? bvx_grid_combine(context, p, q, op, result) : bvx_grid_complement(context, p, result);
}

static void test_algebra_equals_each_voxel(void)
{
    for (int s = 0; s < ALGEBRA_SIZES; s++)
        for (int op = 0; op < 5; op++) {
            make_operands(algebra_sizes[s], 5, 3);
            combine_slowly(op);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, combine(ctx, op, &a, &b, &made));
            algebra_expect_equal(&slow, &made);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, combine(ctx, op, &a, &b, &made)); /* into its own words again */
            algebra_expect_equal(&slow, &made);
            bvx_grid_free(ctx, &made);
        }
}

static void test_algebra_in_place(void)
{
    for (int s = 0; s < ALGEBRA_SIZES; s++)
        for (int op = 0; op < 5; op++)
            for (int second = 0; second < (op < 4 ? 2 : 1); second++) {
                make_operands(algebra_sizes[s], 5, 3);
                combine_slowly(op);
                TEST_ASSERT_EQUAL_INT32(BVX_OK, combine(ctx, op, &a, &b, second ? &b : &a));
                algebra_expect_equal(&slow, second ? &b : &a);
            }
    make_operands(65, 2, 2);
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            bvx_grid_combine(ctx, &a, &a, BVX_BOOLEAN_XOR, &a)); /* all three are one */
    TEST_ASSERT_EACH_EQUAL_HEX64(0, a.words, 8);
}

static void test_algebra_identities(void)
{
    bvx_grid not_a = {0}, not_b = {0}, left = {0};

    make_operands(129, 4, 4);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_complement(ctx, &a, &not_a));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_complement(ctx, &b, &not_b));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_combine(ctx, &a, &b, BVX_BOOLEAN_UNION, &left)); /* De Morgan */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_complement(ctx, &left, &left));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_combine(ctx, &not_a, &not_b, BVX_BOOLEAN_INTERSECTION, &made));
    algebra_expect_equal(&made, &left);
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK, bvx_grid_combine(ctx, &a, &b, BVX_BOOLEAN_DIFFERENCE, &left)); /* a - b is a and not b */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_combine(ctx, &a, &not_b, BVX_BOOLEAN_INTERSECTION, &made));
    algebra_expect_equal(&made, &left);
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            bvx_grid_combine(ctx, &a, &b, BVX_BOOLEAN_XOR, &made)); /* a ^ b ^ b is a */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_combine(ctx, &made, &b, BVX_BOOLEAN_XOR, &made));
    algebra_expect_equal(&a, &made);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_complement(ctx, &not_a, &not_a));
    algebra_expect_equal(&a, &not_a);
    bvx_grid_free(ctx, &not_a);
    bvx_grid_free(ctx, &not_b);
    bvx_grid_free(ctx, &left);
}

static void test_algebra_is_the_same_for_any_threads_and_processor(void)
{
    make_operands(200, 150, 90); /* several pieces */
    for (int op = 0; op < 5; op++) {
        combine_slowly(op);
        for (int way = 0; way < 3; way++) {
            bvx_context *const other = suite_context(way == 1 ? 3 : 1,
                                                     way == 2 ? BVX_CPU_PORTABLE : BVX_CPU_BEST);
            bvx_grid g = {0};
            TEST_ASSERT_EQUAL_INT32(BVX_OK, combine(other, op, &a, &b, &g));
            algebra_expect_equal(&slow, &g);
            bvx_grid_free(other, &g);
            bvx_context_destroy(other);
        }
    }
}

static void test_algebra_takes_words_of_the_callers(void)
{
    static uint64_t words[24];

    make_operands(65, 4, 3);
    combine_slowly(0);
    for (size_t capacity = 0; capacity <= 24; capacity++) {
        bvx_grid own = algebra_own(words, 24);
        own.word_capacity = capacity;
        TEST_ASSERT_EQUAL_INT32(capacity < 24 ? BVX_ERR_CAPACITY : BVX_OK,
                                bvx_grid_combine(ctx, &a, &b, BVX_BOOLEAN_UNION, &own));
        if (capacity < 24) TEST_ASSERT_EACH_EQUAL_HEX64(UINT64_C(0xdbdbdbdbdbdbdbdb), words, 24);
        else algebra_expect_equal(&slow, &own);
    }
}

/* A result too small for the operands has nothing of what lies after its words: the heap may put an operand
 * there. */
static void test_algebra_tells_a_small_result_from_one_that_overlaps(void)
{
    static const int32_t size[3] = {64, 4, 4}, none[3] = {0, 0, 0};
    uint64_t words[8 + 16] = {0};
    bvx_grid operand = algebra_grid(size, none, none), r = {0};
    uint64_t *const own = operand.words;

    operand.words = words + 8;
    r.words = words;
    r.word_capacity = 8;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY,
                            bvx_grid_combine(ctx, &operand, &operand, BVX_BOOLEAN_UNION, &r));
    r.word_capacity = 9;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_grid_combine(ctx, &operand, &operand, BVX_BOOLEAN_UNION, &r));

    operand.words = own;
    bvx_grid_free(ctx, &operand);
}

static void test_algebra_names_what_differs(void)
{
    bvx_grid c;

    make_operands(65, 4, 3);
    c = b;
    c.low[1]--;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_LATTICE, bvx_grid_combine(ctx, &a, &c, BVX_BOOLEAN_UNION, &made));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "window's low along y"));
    c = b;
    c.lattice.spacing[2] = 2.5;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_LATTICE, bvx_grid_combine(ctx, &c, &b, BVX_BOOLEAN_DIFFERENCE, &made));
    TEST_ASSERT_NOT_NULL(
        strstr(bvx_last_message(ctx), "bvx_grid_combine: the grids differ in the lattice's spacing along z"));
    TEST_ASSERT_NULL(made.words);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_combine(ctx, &a, NULL, BVX_BOOLEAN_XOR, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_combine(ctx, NULL, &a, BVX_BOOLEAN_XOR, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_combine(ctx, &a, &b, BVX_BOOLEAN_INTERSECTION, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_complement(ctx, NULL, &made));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_complement(NULL, &a, &made));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_algebra_equals_each_voxel);
    RUN_TEST(test_algebra_in_place);
    RUN_TEST(test_algebra_identities);
    RUN_TEST(test_algebra_is_the_same_for_any_threads_and_processor);
    RUN_TEST(test_algebra_takes_words_of_the_callers);
    RUN_TEST(test_algebra_tells_a_small_result_from_one_that_overlaps);
    RUN_TEST(test_algebra_names_what_differs);
    return UNITY_END();
}
