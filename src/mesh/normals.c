/* normals.c - smooth normals of vertices.
 *
 * Source: Gouraud. Continuous Shading of Curved Surfaces. 1971; each facet counts by its area, which the
 * cross product of its edges gives without a division, so facets without area need no care. */
#include "mesh/facet.h"
#include "mesh/view.h"

void bvxi_triangle_normal(const bvx_mesh_view *view, double scale, const uint32_t corner[3], double normal[3])
{
    double p[3][3];
    for (int k = 0; k < 3; k++) {
        bvxi_view_position(view, corner[k], p[k]);
        for (int a = 0; a < 3; a++) p[k][a] *= scale;
    }
    bvxi_facet_normal((const double(*)[3])p, normal);
}

void bvxi_add_normals(const bvx_mesh_view *view, double scale, double *sum)
{
    double n[3];
    uint32_t c[3];

    for (uint64_t t = 0; t < view->triangle_count; t++) {
        bvxi_view_triangle(view, t, c);
        bvxi_triangle_normal(view, scale, c, n);
        for (int k = 0; k < 3; k++)
            for (size_t a = 0; a < 3; a++) sum[(size_t)c[k] * 3 + a] += n[a];
    }
}

void bvxi_unit_normal(const double sum[3], float normal[3])
{
    /* The largest component first, which is 0 only where all are. */
    double most = 0.0, u[3], length;

    for (int a = 0; a < 3; a++) {
        double const size = sum[a] < 0.0 ? -sum[a] : sum[a];
        most = size > most ? size : most;
    }

    /* Without facets, or where they cancel out, up is as good as any direction. */
    if (!(most > 0.0)) {
        normal[0] = normal[1] = 0.0f;
        normal[2] = 1.0f;
        return;
    }
    /* squares of tiny and of huge sums would leave the range */
    for (int a = 0; a < 3; a++) u[a] = sum[a] / most;
    length = sqrt(u[0] * u[0] + u[1] * u[1] + u[2] * u[2]);
    for (int a = 0; a < 3; a++) normal[a] = (float)(u[a] / length);
}

bvx_status bvxi_sum_normals(bvx_context *ctx, const bvx_mesh_view *view, double scale, double **sum)
{
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, view->vertex_count * BVXI_NORMAL_SUM, "the normals", sum));
    bvxi_add_normals(view, scale, *sum);
    return BVX_OK;
}
