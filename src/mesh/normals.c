/* normals.c - normals of a mesh: bvx_mesh_normals; smooth ones are the sums of facets' normals by area,
 * which need no division, so facets without area need no care.
 *
 * Source: Gouraud. Continuous Shading of Curved Surfaces. 1971. */
#include "mesh/facet.h"
#include "mesh/view.h"

/* The normal of a triangle, as long as twice its area. corner: vertex indices */
static void triangle_normal(const bvx_mesh_view *view, double scale, const uint32_t corner[3],
                            double normal[3])
{
    double p[3][3];
    for (int k = 0; k < 3; k++) {
        bvxi_view_position(view, corner[k], p[k]);
        for (int a = 0; a < 3; a++) p[k][a] *= scale;
    }
    bvxi_facet_normal((const double(*)[3])p, normal);
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
    length = bvxi_vec_length(u);
    for (int a = 0; a < 3; a++) normal[a] = (float)(u[a] / length);
}

bvx_status bvxi_sum_normals(bvx_context *ctx, const bvx_mesh_view *view, double scale, double **sum)
{
    double n[3];
    uint32_t c[3];
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, view->vertex_count * BVXI_NORMAL_SUM, "the normals", sum));
    /* In the order of triangles, so the same on every machine. */
    for (uint64_t t = 0; t < view->triangle_count; t++) {
        bvxi_view_triangle(view, t, c);
        triangle_normal(view, scale, c, n);
        for (int k = 0; k < 3; k++)
            for (size_t a = 0; a < 3; a++) (*sum)[(size_t)c[k] * 3 + a] += n[a];
    }
    return BVX_OK;
}

/* Facets have their own normals or, as papers.md 5 shades them, the mean of their three vertices'. */
static const char normals_name[] = "bvx_mesh_normals";

static bvx_status run_mesh_normals(bvx_context *context, const bvx_mesh_view *mesh, int32_t averaged,
                                   float *vertex_normals, float *facet_normals)
{
    double low[3], high[3], scale, *sum = NULL;

    if (mesh == NULL) return bvxi_fail_null(context, normals_name, "mesh");
    if (vertex_normals == NULL && facet_normals == NULL)
        return bvxi_fail_null(context, normals_name, "vertex_normals and facet_normals");
    if (averaged != 0 && averaged != 1)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: averaged is %d, not 0 or 1",
                             normals_name, (int64_t)averaged);
    BVXI_TRY(bvxi_view_check(context, normals_name, mesh));
    BVXI_TRY(bvxi_view_bounds(context, normals_name, mesh, low, high));

    /* Sums are needed for vertices, and for facets only where these are averaged. */
    scale = bvxi_unit_scale(low, high);
    if (vertex_normals != NULL || averaged) BVXI_TRY(bvxi_sum_normals(context, mesh, scale, &sum));
    for (size_t v = 0; vertex_normals != NULL && v < (size_t)mesh->vertex_count; v++)
        bvxi_unit_normal(sum + 3 * v, vertex_normals + 3 * v);
    for (size_t t = 0; facet_normals != NULL && t < (size_t)mesh->triangle_count; t++) {
        float *const facet = facet_normals + 3 * t;
        double own[3], mean[3] = {0.0, 0.0, 0.0};
        uint32_t c[3];
        bvxi_view_triangle(mesh, t, c);
        triangle_normal(mesh, scale, c, own);
        /* The mean of three unit normals, as the paper shades facets. */
        for (int k = 0; k < 3 && averaged; k++) {
            float n[3];
            bvxi_unit_normal(sum + 3 * (size_t)c[k], n);
            for (int a = 0; a < 3; a++) mean[a] += (double)n[a];
        }
        /* opposite normals may cancel out */
        bvxi_unit_normal(mean[0] != 0.0 || mean[1] != 0.0 || mean[2] != 0.0 ? mean : own, facet);
    }
    return BVX_OK;
}

bvx_status bvx_mesh_normals(bvx_context *context, const bvx_mesh_view *mesh, int32_t averaged,
                            float *vertex_normals, float *facet_normals)
{
    return BVXI_CALL(context, run_mesh_normals(context, mesh, averaged, vertex_normals, facet_normals));
}
