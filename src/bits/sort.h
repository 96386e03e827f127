/* sort.h - orders of numbers. Crossings of a row or edges of a vertex are few, so insertion sorts them; a heap
 * takes over where there are many, so that no input makes it quadratic, in place and without recursion.
 * Positions in space are ordered along a curve. Not installed.
 *
 * Source of the curve: Morton. A computer oriented geodetic data base. 1966. */
#ifndef BVXI_SORT_H
#define BVXI_SORT_H

#include "core/core.h"

#include <stdint.h>

/* ---- Short rows of crossings in order ---- */

static inline void bvxi_sift_down(int32_t *v, uint32_t root, uint32_t n)
{
    int32_t const x = v[root];
    for (uint32_t child; (child = 2 * root + 1) < n; root = child) {
        if (child + 1 < n && v[child + 1] > v[child]) child++;
        if (v[child] <= x) break;
        v[root] = v[child];
    }
    v[root] = x;
}

static inline void bvxi_sort_i32(int32_t *v, uint32_t n)
{
    /* Rows made to be crowded must not cost their square. */
    if (n > 48) {
        for (uint32_t i = n / 2; i-- > 0;) bvxi_sift_down(v, i, n);
        for (uint32_t i = n; i-- > 1;) {
            int32_t const top = v[0];
            v[0] = v[i];
            v[i] = top;
            bvxi_sift_down(v, 0, i);
        }
        return;
    }

    /* Of a few numbers insertion is the shortest way. */
    for (uint32_t i = 1; i < n; i++) {
        int32_t const x = v[i];
        uint32_t j = i;
        for (; j > 0 && v[j - 1] > x; j--) v[j] = v[j - 1];
        v[j] = x;
    }
}

static inline void bvxi_sort_u64(uint64_t *v, uint64_t n)
{
    if (n <= 32) {
        for (uint64_t i = 1; i < n; i++) {
            uint64_t const x = v[i];
            uint64_t j = i;
            for (; j > 0 && v[j - 1] > x; j--) v[j] = v[j - 1];
            v[j] = x;
        }
        return;
    }
    /* First each item from the middle down is sifted into its heap; then the largest go to the end in turn. */
    for (uint64_t i = n / 2, end = n; end > 1;) {
        uint64_t const x = i > 0 ? v[--i] : v[--end];
        uint64_t at = i;
        if (end < n) v[end] = v[0];
        for (uint64_t child; (child = 2 * at + 1) < end; at = child) {
            if (child + 1 < end && v[child + 1] > v[child]) child++;
            if (v[child] <= x) break;
            v[at] = v[child];
        }
        v[at] = x;
    }
}

/* Items by an order of their own: before(of, a, b) is whether item a comes before item b. */
static inline void bvxi_sort_items(uint32_t *v, uint64_t n, int (*before)(const void *, uint32_t, uint32_t),
                                   const void *of)
{
    for (uint64_t i = n / 2, end = n; end > 1;) {
        uint32_t const x = i > 0 ? v[--i] : v[--end];
        uint64_t at = i;
        if (end < n) v[end] = v[0];
        for (uint64_t child; (child = 2 * at + 1) < end; at = child) {
            if (child + 1 < end && before(of, v[child], v[child + 1])) child++;
            if (!before(of, x, v[child])) break;
            v[at] = v[child];
        }
        v[at] = x;
    }
}

/* ---- Places on a curve through space ---- */

/* Bit i of the low 21 goes to bit 3 i; those of three axes side by side are a place on the curve. */
static inline uint64_t bvxi_curve_spread(uint64_t x)
{
    x = (x | x << 32) & UINT64_C(0x001f00000000ffff);
    x = (x | x << 16) & UINT64_C(0x001f0000ff0000ff);
    x = (x | x << 8) & UINT64_C(0x100f00f00f00f00f);
    x = (x | x << 4) & UINT64_C(0x10c30c30c30c30c3);
    x = (x | x << 2) & UINT64_C(0x1249249249249249);
    return x;
}

#endif
