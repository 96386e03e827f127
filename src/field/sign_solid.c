/* sign_solid.c - inside by the rules that fill solids, at the same centres: so a field and a solid of one rule never disagree. */
#include "field/signs.h"

bvx_status bvxi_sign_solid(bvx_context *ctx, const bvx_mesh_view *mesh, int32_t sign, bvx_grid *inside)
{
    bvx_voxelize_options o;
    bvx_voxelize_options_init(&o, sizeof o);
    o.fill = sign == BVX_SIGN_EXACT ? BVX_FILL_PARITY : sign == BVX_SIGN_WINDING ? BVX_FILL_WINDING : BVX_FILL_VOTE;
    memcpy(o.window.low, inside->low, sizeof o.window.low);
    memcpy(o.window.size, inside->size, sizeof o.window.size);
    return bvx_voxelize_solid(ctx, mesh, &inside->lattice, &o, inside);
}
