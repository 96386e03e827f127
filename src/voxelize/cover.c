/* cover.c - the exact crossing of a row with a triangle's plane.
 *
 * Guarantee: the sign of a 128-bit sum decides; no rounding takes part. */
#include "voxelize/cover.h"

int32_t bvxi_cross_exact(const bvxi_triangle *t, int32_t fraction_bits, int32_t j, int32_t k)
{
    int32_t least = t->p[0][0], most = t->p[0][0];
    int32_t low, high;

    for (int32_t i = 1; i < 3; i++) {
        if (t->p[i][0] < least) least = t->p[i][0];
        if (t->p[i][0] > most) most = t->p[i][0];
    }

    /* The displaced row meets the plane inside the triangle, so the crossing lies between its ends along x; a
     * centre at the far end is beyond then, as the plane falls off from there to where the row is. */
    low = bvxi_centres_below(least, fraction_bits);
    high = bvxi_centres_below(most, fraction_bits);
    while (low < high) {
        int32_t const middle = low + (high - low) / 2;
        if (bvxi_beyond_plane(t, fraction_bits, middle, j, k)) high = middle;
        else low = middle + 1;
    }
    return low;
}
