/* facet.h - the normal of a flat triangle, the same to the bit however its corners are numbered; and smooth
 * normals of vertices. Not installed. */
#ifndef BVXI_FACET_H
#define BVXI_FACET_H

#include "core/core.h"
#include "core/vec3.h"

/* n becomes the normal by the right hand, as long as twice the area. */
static inline void bvxi_facet_cross(const double t[3][3], double n[3])
{
    bvxi_area_normal(t[0], t[1], t[2], n);
}

/* The same; returns that length. */
static inline double bvxi_facet_normal(const double t[3][3], double n[3])
{
    bvxi_facet_cross(t, n);
    return bvxi_vec_length(n);
}

/* 1 when corner a comes before b, by their places only. */
static inline int bvxi_corner_before(const double a[3], const double b[3])
{
    for (int k = 0; k < 2; k++)
        if (a[k] < b[k] || a[k] > b[k]) return a[k] < b[k];
    return a[2] < b[2];
}

/* The corners in an order that does not depend on how they are numbered: what is computed from them is then
 * the same to the bit for any numbering and either orientation. */
static inline void bvxi_order_corners(double t[3][3])
{
    static const int pair[3][2] = {{0, 1}, {1, 2}, {0, 1}};

    for (int i = 0; i < 3; i++) {
        double *const a = t[pair[i][0]], *const b = t[pair[i][1]];

        if (!bvxi_corner_before(b, a)) continue;
        for (int k = 0; k < 3; k++) {
            double const x = a[k];
            a[k] = b[k];
            b[k] = x;
        }
    }
}

/* ---- Smooth normals of vertices, weighted by area ---- */

/* For each vertex the sum of its triangles' normals, as long as twice their areas: the direction of a smooth normal.
 * Coordinates are taken times scale, a power of two that keeps their products within doubles. Indices are in range.
 * Scratch: BVXI_NORMAL_SUM bytes a vertex. */
enum { BVXI_NORMAL_SUM = 24 };
bvx_status bvxi_sum_normals(bvx_context *ctx, const bvx_mesh_view *view, double scale, double **sum);

/* The sum at length 1; 0, 0, 1 where it is zero. */
void bvxi_unit_normal(const double sum[3], float normal[3]);

#endif
