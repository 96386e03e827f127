/* cpu.c - which of the faster paths this processor can run. */
#include "context.h"

#if defined(__GNUC__) && defined(__x86_64__)

int32_t bvxi_cpu_detect(void)
{
    __builtin_cpu_init();
    return __builtin_cpu_supports("avx2") && __builtin_cpu_supports("bmi") && __builtin_cpu_supports("bmi2") &&
                   __builtin_cpu_supports("popcnt")
               ? BVX_CPU_AVX2
               : BVX_CPU_PORTABLE;
}

#else

int32_t bvxi_cpu_detect(void)
{
    return BVX_CPU_PORTABLE;
}

#endif
