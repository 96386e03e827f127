/* raster.h - convex polygons into samples with a depth each. Not installed.
 *
 * Bit budget. Corners are fixed-point numbers below 2^30 in magnitude (a picture of 2^16 samples has 13 bits
 * below a sample), so products of their differences stay below 2^62. */
#ifndef BVXI_RASTER_H
#define BVXI_RASTER_H

#include "core/core.h"

enum { BVXI_RASTER_BAND = 64 /* most rows of samples drawn at once */, BVXI_RASTER_EMPTY = 0 };

#define BVXI_RASTER_FAR (-1e30f) /* depth where nothing is */

/* Samples, top row first; sample (x, y) stands at (x + 1/2, y + 1/2). */
typedef struct bvxi_raster {
    int32_t width, height; /* [Units: samples] */
    int32_t fraction_bits; /* of corners */
    float *depth;          /* greater is nearer to the eye [Units: samples] */
    uint32_t *id;          /* what is seen; BVXI_RASTER_EMPTY: nothing */
} bvxi_raster;

/* Depth over a polygon: z at (x, y), its slopes, and the range of its corners. */
typedef struct bvxi_raster_plane {
    double x, y, z;   /* [Units: samples] */
    double dx, dy;    /* change of z from sample to sample */
    double low, high; /* z stays within these, however steep the slopes */
} bvxi_raster_plane;

typedef struct bvxi_raster_rows {
    int32_t begin, end; /* at most BVXI_RASTER_BAND */
} bvxi_raster_rows;

/* Fraction bits that keep the budget for a picture of this longest side. */
int32_t bvxi_raster_fraction_bits(int32_t side);

/* Make rows empty. */
void bvxi_raster_clear(const bvxi_raster *raster, bvxi_raster_rows rows);

/* Draw a convex polygon (x, y of each corner) into rows: where it is nearer than
 * what is there, or there is nothing. A sample on an edge belongs to the polygon
 * right of it or below it, so neighbours neither overlap nor leave gaps. */
void bvxi_raster_polygon(const bvxi_raster *raster, bvxi_raster_rows rows, const int32_t (*corner)[2],
                         int32_t count, const bvxi_raster_plane *plane, uint32_t id);

#endif
