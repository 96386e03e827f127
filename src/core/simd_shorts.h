/* simd_shorts.h - vectors of 8 whole numbers of 16 bits: of SSE2, NEON or WebAssembly's simd128, or arrays. Not
 * installed.
 *
 * Nothing is chosen at run time, so there is one set of names. Of a comparison each lane is -1 or 0.
 * Guarantee: the same numbers in all of them. -DBVX_SIMD_ARRAYS takes the arrays. */
#ifndef BVXI_SIMD_SHORTS_H
#define BVXI_SIMD_SHORTS_H

#include "core/simd.h"

#if BVXI_SIMD_HALVES
/* The compiler's own vectors: operators act on each lane. */
typedef int16_t bvxi_shorts __attribute__((vector_size(16)));
#define BVXI_SHORTS_IS(name, parameters, lane, whole) \
    BVXI_VECTOR_INLINE bvxi_shorts name parameters    \
    {                                                 \
        return (bvxi_shorts)(whole);                  \
    }
#else
typedef struct bvxi_shorts {
    int16_t v[8];
} bvxi_shorts;
#define BVXI_SHORTS_IS(name, parameters, lane, whole)         \
    BVXI_VECTOR_INLINE bvxi_shorts name parameters            \
    {                                                         \
        bvxi_shorts r;                                        \
        for (int i = 0; i < 8; i++) r.v[i] = (int16_t)(lane); \
        return r;                                             \
    }
#endif

/* Each: in lane i, and of whole vectors. */
BVXI_SHORTS_IS(bvxi_shorts_all, (int16_t x), x, ((bvxi_shorts){x, x, x, x, x, x, x, x}))
BVXI_SHORTS_IS(bvxi_shorts_or, (bvxi_shorts x, bvxi_shorts y), x.v[i] | y.v[i], x | y)
BVXI_SHORTS_IS(bvxi_shorts_more, (bvxi_shorts x, bvxi_shorts y), -(x.v[i] > y.v[i]), x > y)

BVXI_VECTOR_INLINE bvxi_shorts bvxi_shorts_load(const int16_t *from)
{
    bvxi_shorts x;
    memcpy(&x, from, sizeof x);
    return x;
}

/* Bit i: lane i of a comparison is -1. */
BVXI_VECTOR_INLINE uint32_t bvxi_shorts_bits(bvxi_shorts m)
{
#if !BVXI_SIMD_HALVES
    uint32_t bits = 0;
    for (int i = 0; i < 8; i++) bits |= (uint32_t)(m.v[i] & 1) << i;
    return bits;
#elif defined(__SSE2__)
    return (uint32_t)_mm_movemask_epi8(_mm_packs_epi16((__m128i)m, (__m128i)m)) & 0xff;
#elif defined(__wasm_simd128__)
    return (uint32_t)wasm_i16x8_bitmask((v128_t)m);
#else
    static const uint16_t lane[8] = {1, 2, 4, 8, 16, 32, 64, 128};
    return vaddvq_u16(vandq_u16((uint16x8_t)m, vld1q_u16(lane)));
#endif
}

#endif
