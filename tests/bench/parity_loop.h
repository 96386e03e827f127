/* parity_loop.h - the baseline: a solid by the plainest good loop. */
#ifndef PARITY_LOOP_H
#define PARITY_LOOP_H

#include "bitvox_io.h"

/* Fill the grid (its words are there) with what lies inside a packed f32,
 * u32 mesh. One thread, no memory of its own. */
void parity_loop(const float *positions, const uint32_t *triangles, uint64_t triangle_count, bvx_grid *grid);

#endif
