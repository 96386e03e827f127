/* nearest_leaf.c - triangles in frames of their own, eight at a time.
 *
 * Source: Jones. 3D Distance from a Point to a Triangle. 1995: turn the triangle into a plane, so that a
 * distance is one in two dimensions and a height. Here the frame stands on the longest edge, at the foot of
 * the altitude: the nearest point to one with x < 0 then lies in the left part, a right triangle (going along
 * x to the altitude never leaves the triangle), so one edge is asked beside the base instead of two.
 * Guarantee: the triangle with the corners foot - p e1, foot + q e1, foot + h e2 lies within 2^-21 of the
 * leaf's extent of the one given, for every triangle: e2 gets a trace of a direction across e1, so there is
 * one where the height is 0, and is made orthogonal a second time, so a needle turns about its own axis by no
 * more than its corner's rounding. */
#include "nearest/nearest_tree.h"
#include "core/simd.h"

#define NEAR_LEAST 0x1p-120f /* below it lengths and squares are 0 */
#define NEAR_TRACE 0x1p-30f

#define BVXI_SIMD_LEVEL _base
#include "nearest/nearest_leaf_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "nearest/nearest_leaf_body.h"
#undef BVXI_SIMD_LEVEL
#endif

void bvxi_near_make_leaf(const uint32_t number[BVXI_NEAR_WIDTH], const float corner[9][BVXI_NEAR_WIDTH],
                         const float low[3], int32_t fast, bvxi_near_leaf *leaf)
{
#if BVXI_HAVE_AVX2
    if (fast) frame_near_leaf_avx2(corner, low, leaf);
    else frame_near_leaf_base(corner, low, leaf);
#else
    (void)fast;
    frame_near_leaf_base(corner, low, leaf);
#endif
    for (int k = 0; k < BVXI_NEAR_WIDTH; k++) leaf->frame[k].triangle = number[k];
}
