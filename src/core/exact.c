/* exact.c - a look at the arithmetic that this library was compiled to, before it is trusted.
 *
 * Rounding other than to nearest, intermediate results wider than their type (x87) and contracted products (a * b + c
 * rounded once) would change results silently. Each shows in a sum of volatile operands; a build or a thread that shows
 * one is refused when its context is created. Flushing of subnormal numbers is not asked: it changes no result of numbers
 * that are not subnormal themselves. */
#include "context.h"

const char *bvx_arithmetic_fault(void)
{
    volatile double const one = 1.0, minus = -1.0, half = 1.0 / 9007199254740992.0; /* half a step above 1 */
    volatile double const above = 1.0 + 1.0 / 1073741824.0, below = 1.0 - 1.0 / 1073741824.0;
    volatile float const one_f = 1.0f, half_f = 1.0f / 16777216.0f;
    volatile double up, down, most;
    up = one + half;
    down = minus - half;
    most = one + 1.5 * half;
    if (up != 1.0 || down != -1.0 || most == 1.0) return "numbers are not rounded to nearest";
    if ((one + half) + half != 1.0 || (one_f + half_f) + half_f != 1.0f)
        return "intermediate results are wider than their type; compile for SSE2, or with -fexcess-precision=fast";
    if (above * below + minus != 0.0) /* 1 - 2^-60 rounds to 1 */
        return "products and sums are contracted; compile with -ffp-contract=off";
    return NULL;
}
