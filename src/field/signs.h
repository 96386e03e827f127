/* signs.h - the rules that decide which centres of a field are inside, one call each. Not installed. */
#ifndef BVXI_SIGNS_H
#define BVXI_SIGNS_H

#include "nearest/nearest.h"

/* sign_normal.c: the words of inside are set by the closest triangles in the band, which it has a column of,
 * and beyond it by carry_signs.c. In a window whose band leaves centres out all of the lattice is looked at;
 * width is the band's [Units: world]. */
bvx_status bvxi_sign_normal(bvxi_call call, const bvxi_nearest *nearest, double width,
                            const bvx_mesh_view *mesh, const bvxi_sparse *band, bvx_grid *inside);

/* carry_signs.c: set the centres beyond the band, where inside is 0, that
 * lie inside as the band does. The band is not empty. */
bvx_status bvxi_carry_signs(bvxi_call call, const bvx_grid *band, bvx_grid *inside);

#endif
