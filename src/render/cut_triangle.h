/* cut_triangle.h - what a box leaves of a triangle. Not installed. */
#ifndef BVXI_CUT_TRIANGLE_H
#define BVXI_CUT_TRIANGLE_H

#include "core/core.h"

enum { BVXI_CUT_MOST = 28 /* corners: a plane turns n into at most n + n/2, and there are six */ };

typedef struct bvxi_cut {
    int32_t on; /* 0: takes nothing away */
    double low[3], high[3];
} bvxi_cut;

/* The polygon of a triangle that lies in the closed box; returns its corners,
 * 0 where at most an edge is left. Corners of the triangle that stay are its
 * own numbers; triangles that share an edge get the same points on it. */
int32_t bvxi_cut_triangle(const bvxi_cut *cut, const double triangle[3][3], double corner[BVXI_CUT_MOST][3]);

#endif
