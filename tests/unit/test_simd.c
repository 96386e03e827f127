/* test_simd.c - the vectors of core/simd.h: every operation against plain
 * C, lane by lane and bit by bit, at each level, and those of
 * core/simd_shorts.h. */
#include "core/simd_shorts.h"
#include "tools/mesh_maker.h"
#include "unity.h"

#include <math.h>

enum { ROUNDS = 2000 };

static uint64_t seed;

void setUp(void)
{
    seed = 3;
}

void tearDown(void)
{
}

/* Numbers of all kinds: zeros of both signs, infinities, no number, tiny ones, and pairs that are equal. */
static double any_number(void)
{
    static const double odd[] = {0.0,       -0.0,      1.0,       -1.0,   HUGE_VAL,
                                 -HUGE_VAL, 0x1p-1022, 0x1p-1074, 0x1p60, 0.5};
    uint64_t const r = maker_random(&seed);

    if (r % 16 == 0) return nan("");
    if (r % 3 == 0) return odd[r / 16 % (sizeof odd / sizeof *odd)];
    return ((double)(r >> 20) - 0x1p43) * (r % 2 == 0 ? 0x1p-40 : 0x1p-30);
}

static float any_float(void)
{
    double const x = any_number();
    if (x != x) return (float)nan("");
    return x > 3e38 ? (float)HUGE_VAL : x < -3e38 ? -(float)HUGE_VAL : (float)x;
}

/* No number has many bits; which of them come out is nowhere requested. */
static void expect_same(double wanted, double got, const char *what)
{
    if (wanted != wanted) TEST_ASSERT_TRUE_MESSAGE(got != got, what);
    else TEST_ASSERT_TRUE_MESSAGE(memcmp(&wanted, &got, sizeof got) == 0, what);
}

#define BVXI_SIMD_LEVEL _base
#include "unit/simd_checks.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "unit/simd_checks.h"
#undef BVXI_SIMD_LEVEL
#endif

static int avx2_may_run(void)
{
    bvx_context *ctx;
    int may;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(NULL, &ctx));
    may = bvxi_cpu(ctx) == BVX_CPU_AVX2;
    bvx_context_destroy(ctx);
    return may;
}

static void test_doubles_are_those_of_plain_c(void)
{
    for (int i = 0; i < ROUNDS; i++) check_doubles_base();
#if BVXI_HAVE_AVX2
    for (int i = 0; avx2_may_run() && i < ROUNDS; i++) check_doubles_avx2();
#else
    (void)avx2_may_run;
#endif
}

static void test_floats_are_those_of_plain_c(void)
{
    for (int i = 0; i < ROUNDS; i++) check_floats_base();
#if BVXI_HAVE_AVX2
    for (int i = 0; avx2_may_run() && i < ROUNDS; i++) check_floats_avx2();
#endif
}

static void test_bytes_are_those_of_plain_c(void)
{
    for (int i = 0; i < ROUNDS; i++) check_bytes_base();
#if BVXI_HAVE_AVX2
    for (int i = 0; avx2_may_run() && i < ROUNDS; i++) check_bytes_avx2();
#endif
}

static void test_columns_are_rows_turned(void)
{
    check_columns_base();
#if BVXI_HAVE_AVX2
    if (avx2_may_run()) check_columns_avx2();
#endif
}

/* Every lane, as whole numbers of 16 bits. */
static void expect_shorts(const int32_t wanted[8], bvxi_shorts got, const char *what)
{
    int16_t lane[8];

    memcpy(lane, &got, sizeof lane);
    for (int i = 0; i < 8; i++)
        TEST_ASSERT_EQUAL_HEX16_MESSAGE((uint16_t)(uint32_t)wanted[i], (uint16_t)lane[i], what);
}

static void check_shorts(const int16_t x[8], const int16_t y[8])
{
    bvxi_shorts const a = bvxi_shorts_load(x), b = bvxi_shorts_load(y);
    int32_t all[8], either[8], more[8];
    uint32_t bits = 0;

    for (int i = 0; i < 8; i++) {
        all[i] = x[3];
        either[i] = x[i] | y[i];
        more[i] = x[i] > y[i] ? -1 : 0;
        bits |= (uint32_t)(x[i] > y[i]) << i;
    }
    expect_shorts(all, bvxi_shorts_all(x[3]), "all");
    expect_shorts(either, bvxi_shorts_or(a, b), "or");
    expect_shorts(more, bvxi_shorts_more(a, b), "more");
    TEST_ASSERT_EQUAL_HEX32(bits, bvxi_shorts_bits(bvxi_shorts_more(a, b)));
}

static void test_shorts_are_those_of_plain_c(void)
{
    for (int round = 0; round < ROUNDS; round++) {
        int16_t x[8], y[8];

        for (int i = 0; i < 8; i++) {
            uint64_t const r = maker_random(&seed);
            x[i] = (int16_t)((int32_t)(r & 0xffff) - 0x8000);
            y[i] = r >> 60 == 0 ? x[i] : (int16_t)((int32_t)(r >> 16 & 0xffff) - 0x8000);
        }
        check_shorts(x, y);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_doubles_are_those_of_plain_c);
    RUN_TEST(test_floats_are_those_of_plain_c);
    RUN_TEST(test_bytes_are_those_of_plain_c);
    RUN_TEST(test_columns_are_rows_turned);
    RUN_TEST(test_shorts_are_those_of_plain_c);
    return UNITY_END();
}
