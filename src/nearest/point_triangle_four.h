/* point_triangle_four.h - closest points on triangles, four pairs of a point and a triangle at a time. Not
 * installed.
 *
 * The evaluation is that of point_triangle.c with the same operations in the same order, its cases chosen by
 * masks: corners and edges divide the product that the case has asked already, so one division serves all of
 * them. */
#ifndef BVXI_POINT_TRIANGLE_FOUR_H
#define BVXI_POINT_TRIANGLE_FOUR_H

#include "core/simd.h"

#define BVXI_SIMD_LEVEL _base
#include "nearest/point_triangle_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "nearest/point_triangle_body.h"
#undef BVXI_SIMD_LEVEL
#endif

#endif
