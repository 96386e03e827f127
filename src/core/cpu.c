/* cpu.c - which of the faster paths this processor can run.
 *
 * -DBVX_NO_CPU_DETECTION leaves the question out, for linkers without the compiler's runtime (__cpu_model),
 * as zig cc for musl and Windows has them: the portable paths run, or with -mavx2 -mbmi -mbmi2 -mpopcnt what
 * these promise. Either way results have the same bits. */
#include "context.h"

#if defined(BVX_NO_CPU_DETECTION) && defined(__AVX2__) && defined(__BMI__) && defined(__BMI2__) && \
    defined(__POPCNT__)

int32_t bvxi_cpu_detect(void)
{
    return BVX_CPU_AVX2;
}

#elif defined(__GNUC__) && defined(__x86_64__) && !defined(BVX_NO_CPU_DETECTION)

int32_t bvxi_cpu_detect(void)
{
    __builtin_cpu_init();
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") &&
                   __builtin_cpu_supports("bmi2") && __builtin_cpu_supports("popcnt")
               ? BVX_CPU_AVX2
               : BVX_CPU_PORTABLE;
}

#else

int32_t bvxi_cpu_detect(void)
{
    return BVX_CPU_PORTABLE;
}

#endif
