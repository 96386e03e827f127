/* test_radix.c - sorting keys with numbers, against insertion sort. */
#include "mesh/mesh.h"
#include "tools/fault.h"
#include "tools/mesh_maker.h"
#include "unity.h"

enum { MOST = 700 };

static uint64_t keys[MOST], sorted_keys[MOST];
static uint32_t numbers[MOST], sorted_numbers[MOST];

void setUp(void)
{
}
void tearDown(void)
{
}

static void insertion_sort(size_t n)
{
    for (size_t i = 0; i < n; i++) {
        size_t k = i;
        for (; k > 0 && sorted_keys[k - 1] > keys[i]; k--) {
            sorted_keys[k] = sorted_keys[k - 1];
            sorted_numbers[k] = sorted_numbers[k - 1];
        }
        sorted_keys[k] = keys[i];
        sorted_numbers[k] = numbers[i];
    }
}

static void test_sort_is_a_stable_sort(void)
{
    bvx_context *ctx;
    uint64_t seed = 11;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(NULL, &ctx));
    for (int round = 0; round < 300; round++) {
        size_t const n = round < 20 ? (size_t)round : (size_t)maker_below(&seed, MOST);
        uint64_t const thin = round % 3 == 0 ? maker_random(&seed) : UINT64_MAX;
        /* bits that differ between keys */
        uint64_t const mask = maker_random(&seed) & maker_random(&seed) & thin;
        uint64_t const rest = maker_random(&seed) & ~mask;
        for (size_t i = 0; i < n; i++) {
            keys[i] = (maker_random(&seed) & (round % 5 == 0 ? mask & 0xff00ff : mask)) | rest;
            numbers[i] = (uint32_t)i;
        }
        insertion_sort(n);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_radix_sort(ctx, keys, numbers, n));
        TEST_ASSERT_EQUAL_INT(0, memcmp(keys, sorted_keys, n * sizeof *keys));
        TEST_ASSERT_EQUAL_INT(0, memcmp(numbers, sorted_numbers, n * sizeof *numbers));
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
    }
    bvx_context_destroy(ctx);
}

/* Many elements in few and in many digits, sorted by pieces: as by one thread. */
static void test_sort_by_threads_is_that_of_one(void)
{
    enum { MANY = 300001 };
    static const uint64_t masks[] = {UINT64_MAX, 0xff, 0xff00000000000003, 0x0f0f0f000000, 0};
    uint64_t *const key = malloc(2 * MANY * sizeof *key), *const other_key = key + MANY;
    uint32_t *const number = malloc(2 * MANY * sizeof *number), *const other_number = number + MANY;
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_context *alone, *many;
    uint64_t seed = 5;

    o.threads = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &alone));
    o.threads = 4;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &many));
    for (size_t m = 0; m < sizeof masks / sizeof *masks; m++)
        for (size_t n = MANY; n > 100000; n -= 90001) {
            for (size_t i = 0; i < n; i++) {
                key[i] = other_key[i] = maker_random(&seed) & masks[m];
                number[i] = other_number[i] = (uint32_t)i;
            }
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_radix_sort(alone, key, number, n));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_radix_sort(many, other_key, other_number, n));
            TEST_ASSERT_EQUAL_INT(0, memcmp(key, other_key, n * sizeof *key));
            TEST_ASSERT_EQUAL_INT(0, memcmp(number, other_number, n * sizeof *number));
            for (size_t i = 1; i < n; i++)
                TEST_ASSERT_TRUE(key[i - 1] < key[i] || (key[i - 1] == key[i] && number[i - 1] < number[i]));
        }
    bvx_context_destroy(many);
    bvx_context_destroy(alone);
    free(number);
    free(key);
}

static bvx_status sort_some(void *user, bvx_context *ctx)
{
    (void)user;
    for (uint32_t i = 0; i < MOST; i++) {
        keys[i] = (MOST - i) * UINT64_C(0x10001);
        numbers[i] = i;
    }
    return BVXI_SCOPE(ctx, bvxi_radix_sort(ctx, keys, numbers, MOST));
}

static void test_every_allocation_may_fail(void)
{
    uint64_t allocations = 0;
    TEST_ASSERT_NULL(fault_every_allocation(sort_some, NULL, NULL, &allocations));
    TEST_ASSERT_EQUAL_UINT64(1, allocations);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_sort_is_a_stable_sort);
    RUN_TEST(test_sort_by_threads_is_that_of_one);
    RUN_TEST(test_every_allocation_may_fail);
    return UNITY_END();
}
