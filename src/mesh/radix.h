/* radix.h - sort 64-bit keys that carry a 32-bit number each. Not installed. */
#ifndef BVXI_RADIX_H
#define BVXI_RADIX_H

#include "core/core.h"

/* Sort keys and numbers by key, ascending; equal keys keep their order. Bytes that all keys share cost
 * nothing. count is below 2^32. Scratch: 12 bytes an element. */
bvx_status bvxi_radix_sort(bvx_context *ctx, uint64_t *keys, uint32_t *numbers, uint64_t count);

#endif
