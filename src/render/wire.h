/* wire.h - lines along edges: how dark a sample beside one is. Not installed.
 *
 * A line is one pixel wide, half of it on each side of its edge, with a slope of one sample at its border.
 * Where lines come closer than a few pixels they fade, so a dense mesh stays a shaded surface in place of
 * turning black. */
#ifndef BVXI_WIRE_H
#define BVXI_WIRE_H

#include <math.h>

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

#endif
