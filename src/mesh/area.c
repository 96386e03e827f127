/* area.c - the area of a mesh's triangles: sums of doubles in the triangles' order, the same everywhere. */
#include "mesh/view.h"

#include <math.h>

double bvxi_view_area(const bvx_mesh_view *view)
{
    double sum = 0;

    for (uint64_t t = 0; t < view->triangle_count; t++) {
        double p[3][3], u[3], v[3], n[3];
        uint32_t c[3];

        bvxi_view_triangle(view, t, c);
        for (int k = 0; k < 3; k++) bvxi_view_position(view, c[k], p[k]);
        for (int a = 0; a < 3; a++) {
            u[a] = p[1][a] - p[0][a];
            v[a] = p[2][a] - p[0][a];
        }
        for (int a = 0; a < 3; a++) n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
        sum += 0.5 * sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    }
    return sum;
}
