/* nearest_pairs.h - pairs of a centre and a triangle, evaluated together. Not installed. */
#ifndef BVXI_NEAREST_PAIRS_H
#define BVXI_NEAREST_PAIRS_H

#include "nearest/nearest_tree.h"

enum { BVXI_NEAR_PAIRS = 256 };

/* Coordinates in the units of the evaluation, one array each. */
typedef struct bvxi_near_pairs {
    double point[3][BVXI_NEAR_PAIRS], corner[9][BVXI_NEAR_PAIRS];
    double closest[3][BVXI_NEAR_PAIRS], distance2[BVXI_NEAR_PAIRS]; /* filled by bvxi_near_evaluate */
    uint32_t triangle[BVXI_NEAR_PAIRS];
    int32_t slot[BVXI_NEAR_PAIRS]; /* the caller's */
    int32_t count;
} bvxi_near_pairs;

/* Take one more pair; there must be room. Its corners' numbers are requested, as the evaluation comes
 * later. */
static inline void bvxi_near_take_pair(const bvxi_nearest *n, bvxi_near_pairs *p, const double point[3],
                                       uint32_t triangle, int32_t slot)
{
    int32_t const i = p->count++;
    if (n->view.indices != NULL) BVXI_PREFETCH(bvxi_view_index_at(&n->view, triangle));
    p->triangle[i] = triangle;
    p->slot[i] = slot;
    for (int a = 0; a < 3; a++) p->point[a][i] = point[a];
}

/* Closest points and squared distances of all pairs, to the bit those of
 * bvxi_closest_on_triangle (zeros may differ in sign). */
void bvxi_near_evaluate(const bvxi_nearest *n, int32_t fast, bvxi_near_pairs *pairs);

/* ---- nearest_ties.c ---- */

/* Square of the distance from pair i's point to the plane of its triangle; 0 without area. */
double bvxi_near_height2(const bvxi_near_pairs *pairs, int32_t i);

/* Two triangles are equally far from pair i's point, and so are their
 * planes: is pair i's, not the other, the one that is taken? */
int bvxi_near_is_first(const bvxi_nearest *n, const bvxi_near_pairs *pairs, int32_t i, uint32_t other);

#endif
