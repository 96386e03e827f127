/* sign_solid.c - inside by the rules that fill solids, at the same centres:
 * so a field and a solid of one rule never disagree. */
#include "field/signs.h"

static int32_t fill_of_sign(int32_t sign)
{
    if (sign == BVX_SIGN_AUTO) return BVX_FILL_AUTO;
    return sign == BVX_SIGN_EXACT     ? BVX_FILL_PARITY
           : sign == BVX_SIGN_WINDING ? BVX_FILL_WINDING
                                      : BVX_FILL_VOTE;
}

/* Of a closed mesh NONZERO is its winding number. */
static int32_t sign_of_fill(int32_t fill)
{
    return fill == BVX_FILL_PARITY ? BVX_SIGN_EXACT
           : fill == BVX_FILL_VOTE ? BVX_SIGN_VOTE
                                   : BVX_SIGN_WINDING;
}

bvx_status bvxi_sign_solid(bvx_context *ctx, const bvx_mesh_view *mesh, int32_t *sign, bvx_grid *inside)
{
    bvx_solid_report report;
    bvx_voxelize_options o;

    bvx_voxelize_options_init(&o, sizeof o);
    /* A field's sign and a solid's fill are one decision, made once. Only the choice is of interest: what
     * voxels lose of the mesh's walls and volume costs a third of a narrow field, and a field says
     * neither. */
    o.fill = fill_of_sign(*sign);
    o.report = *sign == BVX_SIGN_AUTO ? &report : NULL;
    o.check_thin = 0;
    memcpy(o.window.low, inside->low, sizeof o.window.low);
    memcpy(o.window.size, inside->size, sizeof o.window.size);
    BVXI_TRY(bvx_voxelize_solid(ctx, mesh, &inside->lattice, &o, inside));

    if (*sign == BVX_SIGN_AUTO) *sign = sign_of_fill(report.fill);
    return BVX_OK;
}
