/* nearest_pairs.c - closest points on triangles, four pairs of a point and a triangle at a time.
 *
 * nearest/point_triangle_four.h evaluates them. Pairs that it leaves go to point_triangle.c itself.
 * Guarantee: the same bits as bvxi_closest_on_triangle, but for the sign of zeros. */
#include "nearest/nearest_brick.h"
#include "nearest/closest.h"
#include "mesh/facet.h"
#include "nearest/point_triangle_four.h"

static void evaluate_near_pair(bvxi_near_pairs *p, int32_t i)
{
    double const point[3] = {p->point[0][i], p->point[1][i], p->point[2][i]};
    double t[3][3], q[3];
    for (int v = 0; v < 9; v++) t[v / 3][v % 3] = p->corner[v][i];
    /* Squares are compared and roots taken at the end, of those that are kept. */
    p->distance2[i] = bvxi_closest_on_triangle(point, (const double(*)[3])t, q);
    for (int a = 0; a < 3; a++) p->closest[a][i] = q[a];
}

#define BVXI_SIMD_LEVEL _base
#include "nearest/nearest_pairs_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "nearest/nearest_pairs_body.h"
#undef BVXI_SIMD_LEVEL
#endif

void bvxi_near_evaluate(const bvxi_nearest *n, int32_t fast, bvxi_near_pairs *pairs)
{
    for (int32_t i = 0; i < pairs->count; i++) {
        double t[3][3];
        bvxi_near_corners(n, pairs->triangle[i], t);
        for (int v = 0; v < 9; v++) pairs->corner[v][i] = t[v / 3][v % 3];
    }
    if (n->by_planes) {
        for (int32_t i = 0; i < pairs->count; i++) {
            double t[3][3];
            /* By position, so that results do not depend on which corner is the first. */
            for (int v = 0; v < 9; v++) t[v / 3][v % 3] = pairs->corner[v][i];
            bvxi_order_corners(t);
            for (int v = 0; v < 9; v++) pairs->corner[v][i] = t[v / 3][v % 3];
        }
    }

    BVXI_PATH(fast, evaluate_near_fours_base(pairs), evaluate_near_fours_avx2(pairs));
}
