/* normals.h - smooth normals of vertices, weighted by area. Not installed. */
#ifndef BVXI_NORMALS_H
#define BVXI_NORMALS_H

#include "core/core.h"

/* Add to each vertex the normals of its triangles, as long as twice their areas: the direction of a smooth normal.
 * sum [Size: vertex_count * 3], zeroed. Indices are in range. In the order of triangles, so the same on every machine. */
void bvxi_add_normals(const bvx_mesh_view *view, double *sum);

/* The sum at length 1; 0, 0, 1 where it is zero. */
void bvxi_unit_normal(const double sum[3], float normal[3]);

#endif
