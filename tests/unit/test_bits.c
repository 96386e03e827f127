/* test_bits.c - words and runs of bits, rank and short sorts against counting one by one. */
#include "bits/bits.h"
#include "bits/sort.h"
#include "tools/mesh_maker.h"

#include "unity.h"

static uint64_t seed;

void setUp(void)
{
    seed = 20240607;
}
void tearDown(void)
{
}

static uint64_t word_value(int n)
{
    uint64_t const w = maker_random(&seed);
    if (n < 64) return UINT64_C(1) << n;
    if (n < 128) return ~UINT64_C(0) << (n - 64);
    if (n == 128) return 0;
    return n % 3 == 0   ? w
           : n % 3 == 1 ? w & maker_random(&seed) & maker_random(&seed)
                        : w | maker_random(&seed);
}

static void test_words_counted_bit_by_bit(void)
{
    for (int n = 0; n < 3000; n++) {
        uint64_t const w = word_value(n);
        uint64_t parity = 0;
        uint32_t count = 0;
        int32_t lowest = -1;
        for (int i = 0; i < 64; i++) {
            if (w >> i & 1) {
                count++;
                if (lowest < 0) lowest = i;
            }
            parity |= (uint64_t)(count & 1) << i;
        }
        TEST_ASSERT_EQUAL_UINT32(count, bvxi_popcount(w));
        TEST_ASSERT_EQUAL_HEX64(parity, bvxi_prefix_parity(w));
        if (w != 0) TEST_ASSERT_EQUAL_INT32(lowest, bvxi_lowest(w));
    }
}

static void test_row_words_and_tail_mask(void)
{
    for (int32_t nx = 1; nx <= 1000; nx++) {
        int32_t const last = (nx - 1) % 64;
        TEST_ASSERT_EQUAL_INT32((nx + 63) / 64, bvxi_row_words(nx));
        for (int32_t i = 0; i < 64; i++) TEST_ASSERT_EQUAL_INT(i <= last, (int)(bvxi_tail_mask(nx) >> i & 1));
    }
    TEST_ASSERT_EQUAL_INT32(33554432, bvxi_row_words(INT32_MAX));
}

static void test_set_run_sets_just_the_run(void)
{
    enum { WORDS = 4, BITS = 64 * WORDS };
    for (int32_t begin = 0; begin <= BITS; begin++)
        for (int32_t end = begin == 0 ? 0 : begin - 1; end <= BITS; end += (begin % 3) + 1) {
            uint64_t row[WORDS + 1], want[WORDS + 1];
            for (int k = 0; k <= WORDS; k++)
                row[k] = want[k] = (begin + end) % 2 ? UINT64_C(0x8000000000000001) : 0;
            for (int32_t i = begin; i < end; i++) want[i / 64] |= UINT64_C(1) << i % 64;
            bvxi_set_run(row, begin, end);
            TEST_ASSERT_EQUAL_MEMORY(want, row, sizeof row);
        }
}

/* ---- Rank ---- */

static void test_rank_counts_the_bits_before(void)
{
    enum { MOST = 41 };
    for (int n = 0; n < 60; n++) {
        uint64_t const count = n <= MOST ? (uint64_t)n : (uint64_t)maker_below(&seed, MOST + 1);
        uint64_t words[MOST + 1], total = 0;
        uint32_t prefix[MOST / BVXI_RANK_WORDS + 4];
        bvxi_rank rank;
        for (uint64_t i = 0; i < count; i++) words[i] = word_value(129 + n);
        memset(prefix, 0xEE, sizeof prefix);
        TEST_ASSERT_EQUAL_UINT64(((count + 3) / 4 + 1) * 4, bvxi_rank_bytes(count));
        for (uint64_t i = 0; i < count; i++) total += bvxi_popcount(words[i]);
        TEST_ASSERT_EQUAL_UINT64(total, bvxi_rank_build(&rank, words, count, prefix));
        TEST_ASSERT_EQUAL_HEX32(0xEEEEEEEE, prefix[bvxi_rank_bytes(count) / 4]);
        total = 0;
        for (uint64_t bit = 0; bit < 64 * count; bit++) {
            TEST_ASSERT_EQUAL_UINT32(total, bvxi_rank_before(&rank, bit));
            total += words[bit / 64] >> bit % 64 & 1;
        }
        TEST_ASSERT_EQUAL_UINT32(total, bvxi_rank_before(&rank, 64 * count)); /* the end is a place too */
    }
}

/* ---- Sorting ---- */

static void test_sort_any_length_and_order(void)
{
    enum { MOST = 300 };
    for (uint32_t n = 0; n <= MOST; n++)
        for (int kind = 0; kind < 5; kind++) {
            int32_t v[MOST + 1], want[MOST + 1];
            for (uint32_t i = 0; i < n; i++)
                v[i] = kind == 0   ? (int32_t)i
                       : kind == 1 ? -(int32_t)i
                       : kind == 2 ? maker_below(&seed, 4)
                       : kind == 3 ? (int32_t)(maker_random(&seed) >> 32)
                       : i % 2     ? INT32_MAX
                                   : INT32_MIN;
            v[n] = want[n] = 12345;
            for (uint32_t i = 0; i < n; i++) { /* selection: count what is less, and equals before */
                uint32_t place = 0;
                for (uint32_t k = 0; k < n; k++) place += v[k] < v[i] || (v[k] == v[i] && k < i);
                want[place] = v[i];
            }
            bvxi_sort_i32(v, n);
            TEST_ASSERT_EQUAL_MEMORY(want, v, (n + 1) * sizeof v[0]);
        }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_words_counted_bit_by_bit);
    RUN_TEST(test_row_words_and_tail_mask);
    RUN_TEST(test_set_run_sets_just_the_run);
    RUN_TEST(test_rank_counts_the_bits_before);
    RUN_TEST(test_sort_any_length_and_order);
    return UNITY_END();
}
