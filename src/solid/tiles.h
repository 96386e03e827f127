/* tiles.h - a block of rows cut into rectangles, one task each. The cut follows from the block's shape only,
 * never from the number of threads. Not installed. */
#ifndef BVXI_TILES_H
#define BVXI_TILES_H

#include "core/core.h"

/* Tiles of 2^y_shift rows by 2^z_shift slices over ny x nz rows. Thick
 * slabs of slices first; flat blocks are cut along y too. */
typedef struct bvxi_tiles {
    int32_t ny, nz;
    int32_t y_shift, z_shift;
    int32_t tiles_y, tiles_z, count;
} bvxi_tiles;

/* Rows [j0, j1) x [k0, k1). */
typedef struct bvxi_rows {
    int32_t j0, j1, k0, k1;
} bvxi_rows;

/* Pieces of n items in steps of 2^shift. */
static inline int32_t bvxi_shifted_pieces(int32_t n, int32_t shift)
{
    return ((n - 1) >> shift) + 1;
}

static inline void bvxi_tiles_choose(bvxi_tiles *t, int32_t ny, int32_t nz, int32_t most)
{
    t->ny = ny;
    t->nz = nz;
    t->y_shift = t->z_shift = 0;
    while (bvxi_shifted_pieces(ny, t->y_shift) > 1) t->y_shift++;
    while (bvxi_shifted_pieces(nz, t->z_shift) > most) t->z_shift++;
    t->tiles_z = bvxi_shifted_pieces(nz, t->z_shift);
    while (t->y_shift > 0 && t->tiles_z * bvxi_shifted_pieces(ny, t->y_shift - 1) <= most) t->y_shift--;
    t->tiles_y = bvxi_shifted_pieces(ny, t->y_shift);
    t->count = t->tiles_y * t->tiles_z;
}

static inline bvxi_rows bvxi_tiles_rows(const bvxi_tiles *t, int32_t tile)
{
    int32_t const ty = tile % t->tiles_y, tz = tile / t->tiles_y;
    bvxi_rows r;
    r.j0 = ty << t->y_shift;
    r.j1 = t->ny - r.j0 < 1 << t->y_shift ? t->ny : r.j0 + (1 << t->y_shift);
    r.k0 = tz << t->z_shift;
    r.k1 = t->nz - r.k0 < 1 << t->z_shift ? t->nz : r.k0 + (1 << t->z_shift);
    return r;
}

#endif
