/* simd.h - vectors of 4 doubles, 8 floats and 32 bytes with one set of names, over whatever the machine has.
 * Not installed.
 *
 * A kernel is written once, in a file named ..._body.h, with the names at the end of this file. Its source
 * includes the body once for each set of instructions:
 *
 *     #define BVXI_SIMD_LEVEL _base       SSE2, NEON, WebAssembly's simd128, or arrays
 *     #include of the body
 *     #undef BVXI_SIMD_LEVEL
 *     #if BVXI_HAVE_AVX2
 *     #define BVXI_SIMD_LEVEL _avx2       chosen at run time
 *     ...
 *
 * Functions of a body are named BVXI_SIMD(name), which appends the level, and begin with BVXI_SIMD_CODE,
 * which lets the compiler use the level's instructions.
 * Guarantee: each operation gives the same bits in all of them, also for zeros, infinities and no number, so
 * what the arrays do is the specification. -DBVX_SIMD_ARRAYS takes the arrays in any case. */
#ifndef BVXI_SIMD_H
#define BVXI_SIMD_H

#include "core/core.h"

#include <math.h>

#define BVXI_SIMD_PASTE(name, level) name##level
#define BVXI_SIMD_JOIN(name, level)  BVXI_SIMD_PASTE(name, level)
#define BVXI_SIMD(name)              BVXI_SIMD_JOIN(name, BVXI_SIMD_LEVEL)
#define BVXI_SIMD_CODE               BVXI_SIMD_JOIN(BVXI_SIMD_CODE, BVXI_SIMD_LEVEL)
#define BVXI_SIMD_CODE_base
#define BVXI_SIMD_CODE_avx2 BVXI_AVX2

/* 1: the base is made of vectors of 16 bytes, two for each of these. */
#if defined(BVX_SIMD_ARRAYS) || !defined(__GNUC__)
#define BVXI_SIMD_HALVES 0
#elif (defined(__aarch64__) && defined(__ARM_NEON) && !defined(__AARCH64EB__)) || \
    defined(__wasm_simd128__) || defined(__SSE2__)
#define BVXI_SIMD_HALVES 1
#else
#define BVXI_SIMD_HALVES 0
#endif

#include "core/simd_base.h"

/* Of the base, whichever it is: four vectors across four arrays. */
#define BVXI_SIMD_COLUMNS(name, type)                                                        \
    BVXI_VECTOR_INLINE void name(const type *a, const type *b, const type *c, const type *d, \
                                 bvxi_four_base to[4])                                       \
    {                                                                                        \
        for (size_t i = 0; i < 4; i++) {                                                     \
            double const lane[4] = {(double)a[i], (double)b[i], (double)c[i], (double)d[i]}; \
            to[i] = bvxi_four_load_base(lane);                                               \
        }                                                                                    \
    }
BVXI_SIMD_COLUMNS(bvxi_four_columns_f32_base, float)
BVXI_SIMD_COLUMNS(bvxi_four_columns_f64_base, double)

#if BVXI_HAVE_AVX2
#include "core/simd_avx2.h"
#endif

/* One lane in place of four doubles: at the level _one a body serves a single element. */
typedef double bvxi_four_one;
typedef int bvxi_four_mask_one; /* 1 or 0 */
#define BVXI_SIMD_CODE_one
#define BVXI_ONE(name, type, parameters, expression)          \
    BVXI_VECTOR_INLINE type bvxi_four_##name##_one parameters \
    {                                                         \
        return expression;                                    \
    }
BVXI_ONE(all, double, (double x), x)
BVXI_ONE(load, double, (const double *from), *from)
BVXI_ONE(store, double, (double *to, double x), *to = x)
BVXI_ONE(first, double, (double x), x)
BVXI_ONE(add, double, (double x, double y), x + y)
BVXI_ONE(sub, double, (double x, double y), x - y)
BVXI_ONE(mul, double, (double x, double y), x *y)
BVXI_ONE(div, double, (double x, double y), x / y)
BVXI_ONE(max, double, (double x, double y), x > y ? x : y)
BVXI_ONE(sqrt, double, (double x), sqrt(x))
BVXI_ONE(size, double, (double x), bvxi_absolute(x))
BVXI_ONE(less, int, (double x, double y), x < y)
BVXI_ONE(less_equal, int, (double x, double y), x <= y)
BVXI_ONE(equal, int, (double x, double y), x == y)
BVXI_ONE(and, int, (int m, int n), m &n)
BVXI_ONE(but, int, (int m, int n), m & ~n)
BVXI_ONE(choose, double, (int m, double yes, double no), m ? yes : no)
BVXI_ONE(keep, double, (int m, double x), m ? x : 0.0)
BVXI_ONE(drop, double, (int m, double x), m ? 0.0 : x)
BVXI_ONE(bits, uint32_t, (int m), (uint32_t)m)

/* ---- Names: x, y, yes and no are vectors, m and n are masks, which are set or not in each lane ---- */

#define doubles4  BVXI_SIMD(bvxi_four)
#define four_mask BVXI_SIMD(bvxi_four_mask)
#define four_all  BVXI_SIMD(bvxi_four_all)  /* (double): in each lane */
#define four_load BVXI_SIMD(bvxi_four_load) /* (const double *), any alignment */
#define four_columns_f32 \
    BVXI_SIMD(           \
        bvxi_four_columns_f32) /* (const float *a, *b, *c, *d, doubles4 to[4]): to[i] is a[i] b[i] c[i]
                                  d[i] */
#define four_columns_f64 BVXI_SIMD(bvxi_four_columns_f64) /* the same from doubles */
#define four_store       BVXI_SIMD(bvxi_four_store)       /* (double *, x) */
#define four_first       BVXI_SIMD(bvxi_four_first)       /* (x): the double of lane 0 */
#define four_add         BVXI_SIMD(bvxi_four_add)         /* (x, y) */
#define four_sub         BVXI_SIMD(bvxi_four_sub)
#define four_mul         BVXI_SIMD(bvxi_four_mul)
#define four_div         BVXI_SIMD(bvxi_four_div)
#define four_max         BVXI_SIMD(bvxi_four_max)  /* x > y ? x : y */
#define four_sqrt        BVXI_SIMD(bvxi_four_sqrt) /* (x) */
#define four_size        BVXI_SIMD(bvxi_four_size) /* (x): without its sign */
#define four_less        BVXI_SIMD(bvxi_four_less) /* (x, y): a mask; not set for no number */
#define four_less_equal  BVXI_SIMD(bvxi_four_less_equal)
#define four_equal       BVXI_SIMD(bvxi_four_equal)
#define four_and         BVXI_SIMD(bvxi_four_and) /* (m, n): a mask */
#define four_or          BVXI_SIMD(bvxi_four_or)
#define four_but         BVXI_SIMD(bvxi_four_but)         /* (m, n): m where n is not set */
#define four_choose      BVXI_SIMD(bvxi_four_choose)      /* (m, yes, no) */
#define four_choose_mask BVXI_SIMD(bvxi_four_choose_mask) /* the same for masks */
#define four_keep        BVXI_SIMD(bvxi_four_keep)        /* (m, x): x where m is set, 0 elsewhere */
#define four_drop        BVXI_SIMD(bvxi_four_drop)        /* (m, x): 0 where m is set, x elsewhere */
#define four_bits        BVXI_SIMD(bvxi_four_bits)        /* (m): bit i is lane i */

#define floats8          BVXI_SIMD(bvxi_eight) /* the names below mean the same */
#define eight_mask       BVXI_SIMD(bvxi_eight_mask)
#define eight_all        BVXI_SIMD(bvxi_eight_all)
#define eight_load       BVXI_SIMD(bvxi_eight_load)
#define eight_load_bytes BVXI_SIMD(bvxi_eight_load_bytes) /* (const uint8_t *): floats at any address */
#define eight_load_two   BVXI_SIMD(bvxi_eight_load_two)   /* (const float *, const float *): four of each */
#define eight_store      BVXI_SIMD(bvxi_eight_store)
#define eight_add        BVXI_SIMD(bvxi_eight_add)
#define eight_sub        BVXI_SIMD(bvxi_eight_sub)
#define eight_mul        BVXI_SIMD(bvxi_eight_mul)
#define eight_div        BVXI_SIMD(bvxi_eight_div)
#define eight_min        BVXI_SIMD(bvxi_eight_min) /* x < y ? x : y */
#define eight_max        BVXI_SIMD(bvxi_eight_max)
#define eight_sqrt       BVXI_SIMD(bvxi_eight_sqrt)
#define eight_size       BVXI_SIMD(bvxi_eight_size)
#define eight_least      BVXI_SIMD(bvxi_eight_least) /* (x): the least lane, by eight_min of halves */
#define eight_lanes      BVXI_SIMD(bvxi_eight_lanes) /* (uint32_t): the mask whose bits these are */
#define eight_less       BVXI_SIMD(bvxi_eight_less)
#define eight_less_equal BVXI_SIMD(bvxi_eight_less_equal)
#define eight_equal      BVXI_SIMD(bvxi_eight_equal)
#define eight_and        BVXI_SIMD(bvxi_eight_and)
#define eight_or         BVXI_SIMD(bvxi_eight_or)
#define eight_choose     BVXI_SIMD(bvxi_eight_choose)
#define eight_keep       BVXI_SIMD(bvxi_eight_keep)
#define eight_drop       BVXI_SIMD(bvxi_eight_drop)
#define eight_bits       BVXI_SIMD(bvxi_eight_bits)
#define eight_columns \
    BVXI_SIMD(        \
        bvxi_eight_columns) /* (const floats8 row[8], void *to, size_t stride): lane k of the rows, in their
                                                       order, as eight floats k * stride bytes after to */

#define bytes32       BVXI_SIMD(bvxi_bytes) /* without signs */
#define bytes_all     BVXI_SIMD(bvxi_bytes_all)
#define bytes_load    BVXI_SIMD(bvxi_bytes_load)
#define bytes_add     BVXI_SIMD(bvxi_bytes_add) /* modulo 256 */
#define bytes_sub     BVXI_SIMD(bvxi_bytes_sub)
#define bytes_and     BVXI_SIMD(bvxi_bytes_and)
#define bytes_or      BVXI_SIMD(bvxi_bytes_or)
#define bytes_at_most BVXI_SIMD(bvxi_bytes_at_most) /* (x, y): 255 where x <= y, else 0 */
#define bytes_words \
    BVXI_SIMD(      \
        bvxi_bytes_words) /* (const bytes32 row[8], uint64_t to[32]): byte r of word i is byte i of row r */

/* ---- Coordinates: a, b and n are arrays of three vectors, n not one of the others ---- */

#define four_dot(a, b) \
    four_add(four_add(four_mul((a)[0], (b)[0]), four_mul((a)[1], (b)[1])), four_mul((a)[2], (b)[2]))
#define eight_dot(a, b) \
    eight_add(eight_add(eight_mul((a)[0], (b)[0]), eight_mul((a)[1], (b)[1])), eight_mul((a)[2], (b)[2]))

#define four_cross(a, b, n)                                                    \
    do {                                                                       \
        (n)[0] = four_sub(four_mul((a)[1], (b)[2]), four_mul((a)[2], (b)[1])); \
        (n)[1] = four_sub(four_mul((a)[2], (b)[0]), four_mul((a)[0], (b)[2])); \
        (n)[2] = four_sub(four_mul((a)[0], (b)[1]), four_mul((a)[1], (b)[0])); \
    } while (0)
#define eight_cross(a, b, n)                                                      \
    do {                                                                          \
        (n)[0] = eight_sub(eight_mul((a)[1], (b)[2]), eight_mul((a)[2], (b)[1])); \
        (n)[1] = eight_sub(eight_mul((a)[2], (b)[0]), eight_mul((a)[0], (b)[2])); \
        (n)[2] = eight_sub(eight_mul((a)[0], (b)[1]), eight_mul((a)[1], (b)[0])); \
    } while (0)

#define four_minus(a, b, n) \
    ((n)[0] = four_sub((a)[0], (b)[0]), (n)[1] = four_sub((a)[1], (b)[1]), (n)[2] = four_sub((a)[2], (b)[2]))
#define eight_minus(a, b, n)                                                 \
    ((n)[0] = eight_sub((a)[0], (b)[0]), (n)[1] = eight_sub((a)[1], (b)[1]), \
     (n)[2] = eight_sub((a)[2], (b)[2]))
/* n = a + s b and a - s b, s one vector */
#define eight_along(a, s, b, n)                                                                          \
    ((n)[0] = eight_add((a)[0], eight_mul(s, (b)[0])), (n)[1] = eight_add((a)[1], eight_mul(s, (b)[1])), \
     (n)[2] = eight_add((a)[2], eight_mul(s, (b)[2])))
#define eight_without(a, s, b, n)                                                                        \
    ((n)[0] = eight_sub((a)[0], eight_mul(s, (b)[0])), (n)[1] = eight_sub((a)[1], eight_mul(s, (b)[1])), \
     (n)[2] = eight_sub((a)[2], eight_mul(s, (b)[2])))

#endif
