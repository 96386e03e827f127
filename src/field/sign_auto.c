/* sign_auto.c - the sign rule that suits a mesh.
 *
 * Vertices at equal positions are taken as one. A closed mesh whose triangles all run the same way round has an inside that rows
 * tell exactly. Where it is open, or more than two triangles meet at an edge, winding numbers close it; they need triangles that
 * run the same way round, so a mesh with flipped ones is left to the vote, which asks for none. */
#include "field/signs.h"

bvx_status bvxi_sign_auto(bvx_context *ctx, const bvx_mesh_view *mesh, int32_t *sign)
{
    bvx_certificate c;
    BVXI_TRY(bvx_mesh_check(ctx, mesh, 1, &c));
    *sign = c.closed && c.oriented ? BVX_SIGN_EXACT : c.flipped_edges == 0 ? BVX_SIGN_WINDING : BVX_SIGN_VOTE;
    return BVX_OK;
}
