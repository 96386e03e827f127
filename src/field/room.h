/* room.h - distance fields for other rooms: checked, read a word of centres at a time, continued beyond
 * their band. Not installed. */
#ifndef BVXI_FIELD_ROOM_H
#define BVXI_FIELD_ROOM_H

#include "grid/grid.h"

#include <math.h>

/* field.c: refuse an invalid field, naming the field of the struct: band, numbers of rows against its
 * bits, arrays that any reader needs, inside on the band's window. Cost: O(words). */
bvx_status bvxi_field_check(bvx_context *ctx, const char *function, const bvx_field *field);
/* Refuse what cannot be read from it: vectors not 0 or 1, or vectors of a field that has none. */
bvx_status bvxi_field_check_vectors(bvx_context *ctx, const char *function, const bvx_field *field,
                                    int32_t vectors);

/* Up to 64 centres of a row, 64 * word on, as numbers: signed distances, or with
 * vectors 1 three numbers each; outside the band half_width, negative inside, or
 * 0 0 0. *next is the number of the row's next value, at first row_values[row]. */
void bvxi_field_word(const bvx_field *field, uint64_t row, int32_t word, int32_t vectors, uint64_t *next,
                     double *numbers);

static inline double bvxi_field_number(const bvx_field *field, const void *array, uint64_t i)
{
    return field->value_type == BVX_F32 ? (double)((const float *)array)[i] : ((const double *)array)[i];
}

/* The centre of voxel (x, y, z) of a window [Units: world]. */
static inline void bvxi_field_centre(const bvx_grid *grid, int32_t x, int32_t y, int32_t z, double centre[3])
{
    int32_t const at[3] = {x, y, z};
    for (int a = 0; a < 3; a++)
        centre[a] = grid->lattice.origin[a] +
                    ((double)grid->low[a] + (double)at[a] + 0.5) * grid->lattice.spacing[a];
}

/* The power of two that brings a window's centres and bounds, as of a mesh, into [-1, 1]. */
double bvxi_field_scale(const bvx_grid *grid, const double low[3], const double high[3]);

/* The nearest float; infinity beyond the largest one. */
static inline float bvxi_field_float(double v)
{
    double const most = 0x1.fffffep127;
    return v > most ? (float)INFINITY : v < -most ? -(float)INFINITY : (float)v;
}

#endif
