/* test_simd.c - the vectors of core/simd.h: every operation against plain
 * C, lane by lane and bit by bit, at each level. */
#include "core/simd.h"
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
    may = bvx_context_cpu(ctx) == BVX_CPU_AVX2;
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

static void test_columns_are_rows_turned(void)
{
    check_columns_base();
#if BVXI_HAVE_AVX2
    if (avx2_may_run()) check_columns_avx2();
#endif
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_doubles_are_those_of_plain_c);
    RUN_TEST(test_floats_are_those_of_plain_c);
    RUN_TEST(test_columns_are_rows_turned);
    return UNITY_END();
}
