/* area.c - the area of a mesh's triangles: sums of doubles in the triangles' order, the same everywhere. */
#include "mesh/facet.h"
#include "mesh/view.h"

double bvxi_view_area(const bvx_mesh_view *view)
{
    double sum = 0;

    for (uint64_t t = 0; t < view->triangle_count; t++) {
        double p[3][3], n[3];
        uint32_t c[3];

        bvxi_view_triangle(view, t, c);
        for (int k = 0; k < 3; k++) bvxi_view_position(view, c[k], p[k]);
        /* The cross product is as long as twice the area. */
        sum += 0.5 * bvxi_facet_normal((const double(*)[3])p, n);
    }
    return sum;
}
