/* box_triangle_loop.h - the separating axis test in doubles, and the loop
 * over voxels that it is commonly used in. */
#ifndef BOX_TRIANGLE_LOOP_H
#define BOX_TRIANGLE_LOOP_H

#include "bitvox_io.h"

/* A triangle made ready for tests against many boxes. */
typedef struct box_triangle {
    double corner[3][3], edge[3][3], normal[3];
    double low[3], high[3];
} box_triangle;

void box_triangle_prepare(box_triangle *t, const double *a, const double *b, const double *c);

/* 1 when the closed cube around centre, of sides 2 half, meets the closed triangle. */
int box_triangle_meets(const box_triangle *t, const double centre[3], double half);

/* For each triangle, each voxel of its box. points: x, y, z of each vertex
 * [Units: world]. grid holds words for its lattice. */
void box_triangle_loop(const double *points, const uint32_t *triangles, uint64_t triangle_count,
                       bvx_grid *grid);

#endif
