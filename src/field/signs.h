/* signs.h - the rules that decide which centres of a field are inside, one call each. Not installed. */
#ifndef BVXI_SIGNS_H
#define BVXI_SIGNS_H

#include "nearest/nearest.h"

/* sign_features.c: NORMAL, PSEUDONORMAL: the words of inside are set by the closest
 * features in the band, which it has columns of, and beyond it by carry_signs.c. In a window whose band
 * leaves centres out all of the lattice is looked at; width is the band's [Units: world]. */
bvx_status bvxi_sign_features(bvxi_call call, const bvxi_nearest *nearest, double width,
                              const bvx_mesh_view *mesh, const bvxi_sparse *band, int32_t sign,
                              bvx_grid *inside);

/* sign_pseudonormal.c: the centres of a band that lie behind what is closest to them.
 * outwards gives the direction, of any length, that is outwards at a feature;
 * called from workers. inside's words are written: outside the band all are 0. */
typedef void bvxi_outwards_fn(const void *rule, uint32_t triangle, int32_t feature, double outwards[3]);

/* The same file: the band by these rules. */
bvx_status bvxi_sign_normal(bvxi_call call, const bvx_mesh_view *mesh, const bvxi_sparse *band,
                            bvx_grid *inside);
bvx_status bvxi_sign_pseudonormal(bvxi_call call, const bvx_mesh_view *mesh, const bvxi_sparse *band,
                                  bvx_grid *inside);

/* carry_signs.c: set the centres beyond the band, where inside is 0, that
 * lie inside as the band does. The band is not empty. */
bvx_status bvxi_carry_signs(bvxi_call call, const bvx_grid *band, bvx_grid *inside);

#endif
