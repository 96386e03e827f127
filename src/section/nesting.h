/* nesting.h - loops that lie in others, blended level by level. Not installed. */
#ifndef BVXI_SECTION_NESTING_H
#define BVXI_SECTION_NESTING_H

#include "section/slab.h"

/* Scratch of a stack; close it also after a failure. */
bvx_status bvxi_nesting_open(bvxi_stack *stack);
void bvxi_nesting_close(bvxi_stack *stack);

/* Which loops of neighbouring planes belong to which level: all but stack->nesting.plane. */
bvx_status bvxi_nesting_find(bvxi_stack *stack);

/* ---- nesting_planes.c: each level as a plane of its own, which shares its section's points, crossings and ring  */

/* The levels of all slabs. */
bvx_status bvxi_nesting_make(bvxi_stack *stack);
/* What has changed in the section since: crossings, or the ring. */
void bvxi_nesting_refresh(bvxi_plane *level);
/* Return the levels' arrays. */
void bvxi_nesting_drop(bvxi_stack *stack);

/* ---- nesting_cross.c ---- */

/* Find levels of one slab that cross, and mark it to be blended as a whole: *found such slabs. */
bvx_status bvxi_nesting_crossed(bvxi_stack *stack, const bvxi_slab *slabs, uint32_t count, uint32_t *found);

#endif
