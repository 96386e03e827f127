/* exact.c - a look at the arithmetic that this library was compiled to, before it is trusted.
 *
 * Rounding other than to nearest, intermediate results wider than their type (x87) and contracted products (a
 * * b + c rounded once) would change results silently, and so would the parts of fast-math: numbers taken to
 * be finite, sums regrouped, quotients made products. Each shows in a sum of volatile operands, or in one of
 * a number that is read once, which such a compiler shortens to the answer that is wrong; a build or a thread
 * that shows one is refused when its context is created. Flushing of subnormal numbers is not asked: it
 * changes no result of numbers that are not subnormal themselves. Nothing here overflows, divides by zero or
 * is invalid: the thread may have such exceptions made signals. */
#include "context.h"

const char *bvxi_arithmetic_fault(void)
{
    volatile double const one = 1.0, minus = -1.0, half = 1.0 / 9007199254740992.0; /* half a step above 1 */
    volatile double const above = 1.0 + 1.0 / 1073741824.0, below = 1.0 - 1.0 / 1073741824.0;
    volatile float const one_f = 1.0f, half_f = 1.0f / 16777216.0f;

    volatile double const up = one + half;
    volatile double const down = minus - half;
    volatile double const most = one + 1.5 * half;
    /* To nearest rounds both halves back, and three quarters of a step up. */
    if (up != 1.0 || down != -1.0 || most == 1.0) return "numbers are not rounded to nearest";
    /* Wider registers would keep both halves, and then see a whole step. */
    if ((one + half) + half != 1.0 || (one_f + half_f) + half_f != 1.0f)
        return "intermediate results are wider than their type; compile for SSE2, or with "
               "-fexcess-precision=fast";
    if (above * below + minus != 0.0) /* 1 - 2^-60 rounds to 1 */
        return "products and sums are contracted; compile with -ffp-contract=off";

    /* The parts of fast-math that have no macro in every compiler. */
    volatile uint64_t const quiet_nan = UINT64_C(0x7ff8000000000000);
    volatile double const three = 3.0;
    uint64_t const bits = quiet_nan;
    double const large = one, small = half, tenth = three / 10.0;
    double none;

    memcpy(&none, &bits, sizeof none);
    /* Not a number compares unequal to itself, unless the compiler takes that away. */
    if (none == none) return "numbers are taken to be finite; compile without -ffinite-math-only";
    /* Half a step is lost in the first sum; regrouped, it would not be. */
    if ((large + small) - large != 0.0)
        return "sums are regrouped; compile without -fassociative-math and -funsafe-math-optimizations";
    /* Divided, 3 / 10 rounds to 0.3; multiplied by a rounded tenth it does not. */
    if (tenth != 0.3)
        return "quotients are made products; compile without -freciprocal-math and "
               "-funsafe-math-optimizations";
    return NULL;
}
