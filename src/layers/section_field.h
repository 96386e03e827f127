/* section_field.h - what a signed distance is between two sections, from it on these and on the ones
 * beyond; the field over one slab: distances at grid points of both planes, the surface's crossings of the
 * lines between them. Not installed. */
#ifndef BVXI_SECTION_FIELD_H
#define BVXI_SECTION_FIELD_H

#include "bits/bits.h"
#include "layers/slab.h"

/* Sections that a blend looks at: the two it lies between, and those beyond them. */
enum { BVXI_BLEND_BELOW, BVXI_BLEND_ABOVE, BVXI_BLEND_FAR_BELOW, BVXI_BLEND_FAR_ABOVE, BVXI_BLEND_SECTIONS };

/* Ways from section to section; 0: there is none beyond. */
typedef struct bvxi_blend {
    double height, below, above;
} bvxi_blend;

/* Between the sections: t 0 is the one below, 1 the one above. */
double bvxi_blend_value(const bvxi_blend *blend, const double value[BVXI_BLEND_SECTIONS], double t);
/* Where it is 0, when the values on the two sections are of different signs. */
double bvxi_blend_zero(const bvxi_blend *blend, const double value[BVXI_BLEND_SECTIONS]);

/* ---- The field over one slab ---- */

/* The segment that was nearest to the last place in a column; row -1: none yet. */
typedef struct bvxi_column_hint {
    uint32_t segment;
    int32_t row;
} bvxi_column_hint;

/* Distances of one plane's grid points, computed when requested. */
typedef struct bvxi_plane_field {
    const bvxi_plane *plane;
    double *distance;         /* where they may be requested again: field levels; else none */
    uint64_t *known;          /* a bit a grid point */
    bvxi_column_hint *column; /* of each column of grid points, with one more on either side */
    uint32_t hint;
} bvxi_plane_field;

typedef struct bvxi_field {
    bvxi_stack *s;
    bvxi_slab *slab;
    int cubic; /* 1: the blend looks at planes beyond the slab's; else it is linear */
    bvxi_blend blend;
    bvxi_plane_field plane[4]; /* below, above, beyond below, beyond above */
    /* grid points whose line to the plane above is crossed; crossings are numbered in their order */
    uint64_t *crossed;
    uint32_t *before; /* a word of them each: crossings before it */
    uint32_t first;   /* the vertex of the first */
    uint32_t lines;
    double *line[4]; /* crossings each: distances on both planes, and with signs on those beyond */
    /* the slab's first hanging corner in each row of the grid or behind, and one more */
    uint32_t *hanging_row;
    uint32_t *hanging_column; /* the same by column, in the order of by_u */
} bvxi_field;

/* lines: the most crossings of a slab. */
bvx_status bvxi_field_open(bvxi_stack *s, bvxi_field *f, uint32_t lines);
/* Go to a slab: crossings of its lines become vertices. */
bvx_status bvxi_field_set(bvxi_field *f, bvxi_slab *slab);
/* The blended field at a place: t 0 is the plane below, 1 the one above. */
double bvxi_field_at(bvxi_field *f, double u, double v, double t);
/* Signed distances at a point of the grid or a corner of a cell on plane k, its side given. */
double bvxi_field_corner(bvxi_field *f, const int32_t at[2], int k, int inside);
/* The number of a grid point's crossing among all of the slab. */
static inline uint32_t bvxi_line_number(const bvxi_field *f, int32_t i, int32_t j)
{
    size_t const word = (size_t)j * (size_t)f->s->words + (size_t)(i >> 6);
    return f->before[word] + bvxi_popcount(f->crossed[word] & ((UINT64_C(1) << (i & 63)) - 1));
}

#endif
