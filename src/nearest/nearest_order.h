/* nearest_order.h - triangles along a curve through space. Not installed. */
#ifndef BVXI_NEAREST_ORDER_H
#define BVXI_NEAREST_ORDER_H

#include "nearest/nearest_tree.h"

/* With more triangles no run is cut: eight times a leaf's number stays below 2^32. */
#define BVXI_NEAR_CUT_BELOW (UINT64_C(1) << 29)

typedef struct bvxi_near_order {
    double grid_low[3], grid_side; /* where the curve's grid lies, set by the caller [Units: box] */
    uint64_t count;
    uint64_t *keys, *spare; /* [Size: count] */
    uint32_t *numbers;      /* in the order of sorted; NULL: a key's low 32 bits [Size: count] */
    const uint64_t *sorted; /* keys or spare */
} bvxi_near_order;

/* The rest of *o is zero before. It is to be freed also after a failure. */
bvx_status bvxi_near_order_make(bvx_context *ctx, const char *stage, double from, double to,
                                const bvxi_nearest *n, bvxi_near_order *o);
void bvxi_near_order_free(bvx_context *ctx, bvxi_near_order *o);

/* How many of the triangles first .. end - 1, at most eight, make a leaf. */
uint32_t bvxi_near_order_run(const bvxi_near_order *o, uint64_t first, uint64_t end);

/* Number of the triangle at a place of the curve. */
static inline uint32_t bvxi_near_order_number(const bvxi_near_order *o, uint64_t i)
{
    return o->numbers != NULL ? o->numbers[i] : (uint32_t)o->sorted[i];
}

#endif
