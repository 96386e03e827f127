/* scale.h - a power of two that keeps products of coordinates within doubles. Not installed. */
#ifndef BVXI_SCALE_H
#define BVXI_SCALE_H

/* The power of two that brings the largest coordinate of a box into [0.5,
 * 1), or as near as 1000 doublings come. Multiplying by it is exact, so it
 * changes no result but those that would overflow or vanish on the way. */
static inline double bvxi_unit_scale(const double low[3], const double high[3])
{
    double largest = 0.0, s = 1.0;

    /* The larger of both ends counts, whatever its sign. */
    for (int a = 0; a < 3; a++) {
        largest = high[a] > largest ? high[a] : largest;
        largest = -low[a] > largest ? -low[a] : largest;
    }
    for (int i = 0; i < 1000 && largest * s >= 1.0; i++) s *= 0.5;
    for (int i = 0; i < 1000 && largest > 0.0 && largest * s < 0.5; i++) s *= 2.0;
    return s;
}

#endif
