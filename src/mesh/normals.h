/* normals.h - smooth normals of vertices, weighted by area. Not installed. */
#ifndef BVXI_NORMALS_H
#define BVXI_NORMALS_H

#include "core/core.h"

/* Add to each vertex the normals of its triangles, as long as twice their areas: the direction of a smooth
 * normal. Coordinates are taken times scale, a power of two that keeps their products within doubles.
 * sum [Size: vertex_count * 3], zeroed. Indices are in range. In the order of triangles, so the same on every
 * machine. */
void bvxi_add_normals(const bvx_mesh_view *view, double scale, double *sum);

/* The same as scratch: BVXI_NORMAL_SUM bytes a vertex, freed by the caller. */
enum { BVXI_NORMAL_SUM = 24 };
bvx_status bvxi_sum_normals(bvx_context *ctx, const bvx_mesh_view *view, double scale, double **sum);

/* The normal of a triangle as bvxi_add_normals adds it. corner: vertex indices */
void bvxi_triangle_normal(const bvx_mesh_view *view, double scale, const uint32_t corner[3],
                          double normal[3]);

/* The sum at length 1; 0, 0, 1 where it is zero. */
void bvxi_unit_normal(const double sum[3], float normal[3]);

#endif
