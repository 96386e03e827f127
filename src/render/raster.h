/* raster.h - the raster of a picture: polygons, bands, clipping, lines along edges, and which way the
 * surface of voxels faces. Corners are fixed-point numbers with a bit budget. Not installed. */
#ifndef BVXI_RASTER_H
#define BVXI_RASTER_H

#include "core/core.h"

#include <math.h>

/* ---- Convex polygons into samples with a depth each ---- */

/* Bit budget. Corners are fixed-point numbers below 2^30 in magnitude (a picture of 2^16 samples has 13 bits
 * below a sample), so products of their differences stay below 2^62. */

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

/* ---- Which triangles reach into which band of rows ---- */

/* First and last band that triangle t reaches; 0 when it reaches none. */
typedef int bvxi_bands_fn(const void *user, uint32_t t, int32_t *first, int32_t *last);

typedef struct bvxi_triangle_bins {
    int32_t bands;
    uint64_t *begin; /* triangle[begin[b]] .. triangle[begin[b + 1] - 1] reach band b, in their order */
    uint32_t *triangle;
    uint64_t total;
} bvxi_triangle_bins;

bvx_status bvxi_triangle_bins_open(bvx_context *ctx, uint64_t triangle_count, int32_t bands,
                                   bvxi_bands_fn *reach, const void *user, bvxi_triangle_bins *bins);

/* ---- What a box leaves of a triangle ---- */

enum { BVXI_CUT_MOST = 28 /* corners: a plane turns n into at most n + n/2, and there are six */ };

typedef struct bvxi_cut {
    int32_t on; /* 0: takes nothing away */
    double low[3], high[3];
} bvxi_cut;

/* The polygon of a triangle that lies in the closed box; returns its corners,
 * 0 where at most an edge is left. Corners of the triangle that stay are its
 * own numbers; triangles that share an edge get the same points on it. */
int32_t bvxi_cut_triangle(const bvxi_cut *cut, const double triangle[3][3], double corner[BVXI_CUT_MOST][3]);

/* ---- Lines along edges: how dark a sample beside one is ---- */

/* A line is one pixel wide, half of it on each side of its edge, with a slope of one sample at its border.
 * Where lines come closer than a few pixels they fade, so a dense mesh stays a shaded surface in place of
 * turning black. */

#define BVXI_WIRE_INK  0.78 /* share of the light that a line takes away */
#define BVXI_WIRE_GONE 2.5  /* distance of lines at which nothing of them is left [Units: pixels] */
#define BVXI_WIRE_FULL 6.5  /* and from which on they are whole */

/* Share of the light that an edge takes from a sample at this distance; spacing is to the next line, or the
 * edge's own length where that is shorter [Units: samples], side samples a pixel and side. */
static inline double bvxi_wire_ink(double distance, double spacing, double side)
{
    double const cover = side * 0.5 + 0.5 - distance;
    double const fade = (spacing / side - BVXI_WIRE_GONE) / (BVXI_WIRE_FULL - BVXI_WIRE_GONE);
    if (cover <= 0.0 || fade <= 0.0) return 0.0;
    return BVXI_WIRE_INK * (cover < 1.0 ? cover : 1.0) * (fade < 1.0 ? fade : 1.0);
}

static inline double bvxi_wire_lesser(double a, double b)
{
    return a < b ? a : b;
}

/* ---- Which way the surface of a voxel set faces ---- */

/* From the voxels set in a grid or in also (words of the same window; the grid's own where there is one set
 * only) in a ball of three voxels around (i, j, k), which lies in the window: n points from their middle to
 * the voxel, steps along each axis as long as spacing says; all zero where they balance. */
void bvxi_voxel_normal(const bvx_grid *grid, const uint64_t *also, const double spacing[3], int32_t i,
                       int32_t j, int32_t k, double n[3]);

#endif
