/* sheet_series.h - polynomials in x, y, z and the derivatives of 1 / distance, for parts of a sheet that are
 * far off. Not installed.
 *
 * Source: Greengard, Rokhlin. A Fast Algorithm for Particle Simulations. 1987, with Taylor's series in place
 * of spherical harmonics as in Duan, Krasny. An Adaptive Treecode for Computing Nonbonded Potential Energy in
 * Classical Molecular Systems. 2001.
 *
 * A part of area vectors a at c + s has at p + h, R = c - p, the turns -1/(4 pi) sum a . grad 1/|R + s - h|.
 * With moments m[i] = sum a . grad s^i / i! and D[i] the i-th derivative of 1/|R| (i of three numbers, i!
 * their factorials' product) that is sum c[k] h^k / k!, c[k] = -(-1)^|k| / (4 pi) sum m[i] D[i + k]. What
 * lies beyond degree n of both together is below A / (4 pi d^2) q^n (n + 1 - n q) / (1 - q)^2 for area A
 * within r of c, |h| <= t, q = (r + t) / d < 1: the term of degree n is n! (v . grad)^n / |R| with |v| <= r +
 * t, at most |v|^n / d^(n + 1), and the same bound holds for each of its polar forms. */
#ifndef BVXI_SHEET_SERIES_H
#define BVXI_SHEET_SERIES_H

#include "core/core.h"

/* terms to the order; to one less */
enum { BVXI_SERIES_ORDER = 5, BVXI_SERIES_TERMS = 56, BVXI_SERIES_LOCAL = 35 };

/* The terms' numbers: by degree, then as they come. */
typedef struct bvxi_series_table {
    uint8_t power[BVXI_SERIES_TERMS][3];
    uint8_t sum[BVXI_SERIES_TERMS][BVXI_SERIES_TERMS]; /* where the degrees' sum is at most the order */
    uint8_t axis[BVXI_SERIES_TERMS];                   /* the first that the term has */
    uint8_t less[BVXI_SERIES_TERMS][3];                /* the term with one less of each axis, if it has it */
    uint8_t end[BVXI_SERIES_ORDER + 1];                /* by degree: behind its last term */
} bvxi_series_table;

void bvxi_series_open(bvxi_series_table *t);

/* value[i] = v^i / i!, terms of them. */
void bvxi_series_powers(const bvxi_series_table *t, const double v[3], int32_t terms, double *value);

/* Moments about c of the part that has m about c + v are added to sum. */
void bvxi_series_move_moments(const bvxi_series_table *t, const double *m, const double v[3], double *sum);

/* The local series about p + v of what has c about p. */
void bvxi_series_move_local(const bvxi_series_table *t, const double *c, const double v[3], double *moved);

/* Add to local series c (or to its first term only) what the part with the moments does that is r away. */
void bvxi_series_add(const bvxi_series_table *t, const double *m, const double r[3], int32_t first_only,
                     double *c);

/* The bound above but for the area, A = 1. */
static inline double bvxi_series_rest(double d2, double q)
{
    double power = 1;
    for (int i = 0; i < BVXI_SERIES_ORDER; i++) power *= q;
    return power * (BVXI_SERIES_ORDER + 1 - BVXI_SERIES_ORDER * q) /
           (12.566370614359172 * d2 * (1 - q) * (1 - q));
}

#endif
