/* nearest_order.c - triangles in the order of a curve through space, and where that jumps.
 *
 * Source: Morton. A computer oriented geodetic data base. 1966. The curve runs over the middles of the triangles'
 * boxes, up to 16 bits an axis. It jumps: eight neighbours may be two groups far apart, in a box that reaches through half
 * of the mesh. Such a run is cut in two where that makes the boxes smaller. */
#include "bits/sort.h"
#include "core/simd.h"
#include "mesh/mesh.h"
#include "nearest/closest.h"
#include "nearest/nearest_tree.h"

enum { CURVE_GRAIN = 4096 /* least triangles a task */ };

#define BVXI_SIMD_LEVEL _base
#include "nearest/nearest_order_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "nearest/nearest_order_body.h"
#undef BVXI_SIMD_LEVEL
#endif

static void make_curve_keys(void *user, uint64_t begin, uint64_t end)
{
    const bvxi_curve *const curve = user;
    double corner[9][BVXI_CURVE_LANES];
    uint64_t key[BVXI_CURVE_LANES];
    uint32_t triangle[BVXI_CURVE_LANES];

    for (uint64_t first = begin; first < end; first += BVXI_CURVE_LANES) {
        uint64_t const count = end - first < BVXI_CURVE_LANES ? end - first : BVXI_CURVE_LANES;

        /* Lanes after the last triangle have it again. */
        for (uint64_t i = 0; i < BVXI_CURVE_LANES; i++)
            triangle[i] = (uint32_t)(first + (i < count ? i : count - 1));
        bvxi_curve_gather(curve->view, triangle, corner);
        BVXI_PATH(curve->fast, key_some_base(curve, (const double(*)[BVXI_CURVE_LANES])corner, key),
                  key_some_avx2(curve, (const double(*)[BVXI_CURVE_LANES])corner, key));
        memcpy(curve->keys + first, key, (size_t)count * sizeof *key);
        memcpy(curve->order + first, triangle, (size_t)count * sizeof *triangle);
    }
}

bvx_status bvxi_curve_sort(bvxi_call call, bvxi_curve *curve)
{
    uint64_t const count = curve->view->triangle_count;
    BVXI_TRY(BVXI_SHARE(call.ctx, call.from, call.to,
                        bvxi_for(call.ctx, call.stage, count, CURVE_GRAIN, make_curve_keys, curve)));
    /* Stable, so equal keys stay in the order of their indices. */
    return bvxi_radix_sort(call.ctx, curve->keys, curve->order, count);
}

/* ---- Runs of triangles ---- */

/* Sum of the sides of the box around the cells of some keys. */
static uint64_t near_key_sides(const uint64_t *keys, uint32_t begin, uint32_t end)
{
    uint64_t sum = 0;
    /* In cells of the curve: sums of sides tell which box is small, and cost no square. */
    for (int a = 0; a < 3; a++) {
        uint32_t low = UINT32_MAX, high = 0;
        for (uint32_t i = begin; i < end; i++) {
            /* Every third bit of the low 63. */
            uint64_t bits = keys[i] >> a & UINT64_C(0x1249249249249249);
            bits = (bits | bits >> 2) & UINT64_C(0x10c30c30c30c30c3);
            bits = (bits | bits >> 4) & UINT64_C(0x100f00f00f00f00f);
            bits = (bits | bits >> 8) & UINT64_C(0x001f0000ff0000ff);
            bits = (bits | bits >> 16) & UINT64_C(0x001f00000000ffff);
            uint32_t const x = (uint32_t)((bits | bits >> 32) & 0x1fffff);
            low = x < low ? x : low;
            high = x > high ? x : high;
        }
        sum += high - low + 1;
    }
    return sum;
}

/* A jump is where two keys differ in a higher bit than any other neighbours do by two levels or more; it is
 * one if the boxes of both sides are small beside that of the whole. */
uint32_t bvxi_near_cut(const uint64_t *keys, uint64_t left, int cut)
{
    uint32_t count = left < BVXI_NEAR_WIDTH ? (uint32_t)left : BVXI_NEAR_WIDTH;

    while (cut) {
        uint64_t most = 0, second = 0;
        uint32_t at = 0;

        /* The highest bit in which neighbours differ is the size of the step between them. */
        for (uint32_t i = 1; i < count; i++) {
            uint64_t const x = keys[i] ^ keys[i - 1];
            second = x > most ? most : x > second ? x : second;
            at = x > most ? i : at;
            most = x > most ? x : most;
        }
        if (at == 0 || second > most >> 6) return count;
        if (4 * (near_key_sides(keys, 0, at) + near_key_sides(keys, at, count)) >=
            3 * near_key_sides(keys, 0, count))
            return count;
        count = at;
    }
    return count;
}
