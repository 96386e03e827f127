/* math.h - the same for sqrt and floor. */
#ifndef CHECK_MSVC_MATH_H
#define CHECK_MSVC_MATH_H
double sqrt(double v);
double floor(double v);
#define HUGE_VAL (1e300 * 1e300)
#define INFINITY ((float)(1e300 * 1e300))
#endif
