/* edge_vector.h - where a lattice edge is cut, from the vectors to the
 * closest points of both its ends. Not installed. */
#ifndef BVXI_EDGE_VECTOR_H
#define BVXI_EDGE_VECTOR_H

#include "core/core.h"

/* What placed a cut. */
enum {
    BVXI_CUT_VECTOR = 0, /* the line through the closest points, or their common projection */
    BVXI_CUT_SCALAR = 1, /* the distances' ratio; BVX_EDGE_PAPER: a clamp */
    BVXI_CUT_MIDDLE = 2, /* nothing else was there */
    BVXI_CUT_LID = 3,    /* no surface is near, so another rule was asked (field_surface.h: missing) */
    BVXI_CUT_KINDS = 4
};

/* An edge from its low end along an axis; one end is inside. */
typedef struct bvxi_cut_edge {
    int32_t axis;
    int32_t high_inside; /* 1: the high end is inside, 0: the low end */
    double length;       /* > 0 */
    /* from the low and from the high end to their closest points, in the length's units */
    double low[3], high[3];
    double low_distance, high_distance; /* not negative */
    uint64_t value[2];                  /* where the low and the high end's stand among others */
} bvxi_cut_edge;

/* The ratio from the low end, in [0, 1] for any numbers in the edge, and
 * what placed it. interpolation: BVX_EDGE_... */
int32_t bvxi_find_cut(const bvxi_cut_edge *edge, int32_t interpolation, double *ratio);

#endif
