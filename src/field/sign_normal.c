/* sign_normal.c - inside by the plane of the closest triangle.
 *
 * Source: Wang, Wu. Mesh model repair based on vector field distance function. 2013. Where an edge or a
 * corner is closest, several triangles are at one distance and the one of least number decides, whose plane
 * may have the centre on its wrong side: sign_pseudonormal.c mends that. It is here because it is the paper's
 * rule. A triangle without area has no side: what is closest to it is outside. */
#include "field/signs.h"
#include "mesh/facet.h"
#include "mesh/view.h"

typedef struct normal_rule {
    const bvx_mesh_view *mesh;
    double scale; /* power of two, so that products neither vanish nor overflow */
} normal_rule;

static void outwards_of_facet(const void *user, uint32_t triangle, int32_t feature, double outwards[3])
{
    const normal_rule *const rule = user;
    double t[3][3];
    uint32_t c[3];

    (void)feature;

    /* About the size of 1, as products of lengths are taken. */
    bvxi_view_triangle(rule->mesh, triangle, c);
    for (int k = 0; k < 3; k++) {
        bvxi_view_position(rule->mesh, c[k], t[k]);
        for (int a = 0; a < 3; a++) t[k][a] *= rule->scale;
    }
    bvxi_facet_normal((const double(*)[3])t, outwards);
}

bvx_status bvxi_sign_normal(bvxi_call call, const bvx_mesh_view *mesh, const bvxi_sparse *band,
                            bvx_grid *inside)
{
    normal_rule rule;
    double low[3], high[3];
    BVXI_TRY(bvxi_view_bounds(call.ctx, call.function, mesh, low, high));
    rule.mesh = mesh;
    rule.scale = bvxi_unit_scale(low, high);
    return bvxi_sign_side(call, mesh, band, outwards_of_facet, &rule, inside);
}
