/* threshold_columns.c - columns of bytes to rows of bits: in range or not, and turned at the same time.
 *
 * NumPy's C order has z fastest and bits run along x. Comparing 64 bytes of each of eight columns and keeping
 * another bit of each comparison gives eight bits of x for 64 z; eight such sets of bytes are turned as
 * bytes, by unpacking, instead of 64 by 64 bits. Guarantee: the bits of the runs of threshold.c, turned; only
 * bytes of the columns are read. */
#include "core/simd.h"
#include "volume/room.h"

enum { COLUMN_BYTES = 64 }; /* of a column at a time: a line of the cache */

/* Arrays are slower than runs that are turned: only vectors, and arrays where they are wanted. */
#if BVXI_SIMD_BASE
#define BVXI_SIMD_LEVEL _base
#include "volume/threshold_columns_body.h"
#undef BVXI_SIMD_LEVEL
#endif

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "volume/threshold_columns_body.h"
#undef BVXI_SIMD_LEVEL
#endif

bvxi_columns_fn *bvxi_range_columns_for(const bvx_context *ctx, int32_t type)
{
    if (bvxi_type_size(type) != 1) return NULL;
#if BVXI_HAVE_AVX2
    if (bvxi_cpu(ctx) == BVX_CPU_AVX2) return range_columns_avx2;
#else
    (void)ctx;
#endif
#if BVXI_SIMD_BASE
    return range_columns_base;
#else
    return NULL;
#endif
}
