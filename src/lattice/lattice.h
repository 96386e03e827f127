/* lattice.h - the fixed-point lattice and its exact predicates. Not installed.
 *
 * Bit budgets. |q| < 2^30 for every snapped coordinate (DESIGN: exactness contract), so
 *   differences d of coordinates         |d| < 2^31
 *   2x2 determinants of differences      |.| < 2^63   (edge functions, components of normals)
 *   normal . difference, three terms     |.| < 3 * 2^94 < 2^96: 128 bits
 * A centre's coordinate i * 2^F + 2^(F-1) inside a triangle's box obeys the same bounds as the triangle. */
#ifndef BVXI_LATTICE_H
#define BVXI_LATTICE_H

#include "lattice/wide.h"

#define BVXI_FIXED_LIMIT 1073741824.0 /* 2^30 */

enum { BVXI_MAX_SIDE = 1 << 25, BVXI_MAX_FRACTION = 16, BVXI_MIN_FRACTION = 4 };

/* Refuse an invalid lattice, naming the field. */
bvx_status bvxi_lattice_check(bvx_context *ctx, const char *function, const bvx_lattice *lattice);
/* Resolve NULL or an all-zero window to the whole lattice; refuse one that is not inside. */
bvx_status bvxi_window_take(bvx_context *ctx, const char *function, const bvx_lattice *lattice,
                            const bvx_window *given, bvx_window *window);
/* bvx_lattice_make for other functions. */
bvx_status bvxi_lattice_build(bvx_context *ctx, const char *function, const double origin[3],
                              const double spacing[3], const int32_t dims[3], bvx_lattice *lattice);
int bvxi_lattice_equal(const bvx_lattice *a, const bvx_lattice *b);
/* The longest edge of a voxel. */
static inline double bvxi_largest_spacing(const bvx_lattice *l)
{
    double const s = l->spacing[0] > l->spacing[1] ? l->spacing[0] : l->spacing[1];
    return s > l->spacing[2] ? s : l->spacing[2];
}

/* Fraction bits for an extent of n voxels: min(16, 29 - ceil(log2 n)). */
int32_t bvxi_fraction_bits(int32_t n);

/* floor(v + 1/2) for |v| < 2^30, by truncation: no call of floor in the loop over vertices. */
static inline int32_t bvxi_round_half_up(double v)
{
    double const u = v + 0.5;
    int32_t const t = (int32_t)u;
    return t - (u < (double)t);
}

/* floor(v / 2^shift), also for negative v, on any compiler. */
static inline int32_t bvxi_floor_shift(int32_t v, int32_t shift)
{
    return v < 0 ? ~(int32_t)((uint32_t)~v >> shift) : (int32_t)((uint32_t)v >> shift);
}

/* Floor of a / b for b > 0. */
static inline int64_t bvxi_floor_div(int64_t a, int64_t b)
{
    return a / b - (a % b < 0);
}

static inline int32_t bvxi_least_of_three(int32_t a, int32_t b, int32_t c)
{
    int32_t const m = a < b ? a : b;
    return m < c ? m : c;
}

static inline int32_t bvxi_most_of_three(int32_t a, int32_t b, int32_t c)
{
    int32_t const m = a > b ? a : b;
    return m > c ? m : c;
}

/* Centres of lattice cells with coordinate below q: the lowest index i with i * 2^F + 2^(F-1) >= q.
 * It is also the first index whose displaced centre lies beyond q, as the displacement is positive. */
static inline int32_t bvxi_centres_below(int32_t q, int32_t fraction_bits)
{
    return bvxi_floor_shift(q + (1 << (fraction_bits - 1)) - 1, fraction_bits);
}

#endif
