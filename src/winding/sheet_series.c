/* sheet_series.c - polynomials for sums over many far parts of a sheet: powers, shifted sums, and
 * derivatives of 1 / distance by a recurrence.
 *
 * Source: Greengard, Rokhlin. A Fast Algorithm for Particle Simulations. 1987; here in Cartesian
 * coordinates. */
#include "core/simd.h"
#include "winding/sheet.h"

#include <math.h>

void bvxi_series_open(int32_t fast, bvxi_series_table *t)
{
    uint8_t number[BVXI_SERIES_ORDER + 1][BVXI_SERIES_ORDER + 1][BVXI_SERIES_ORDER + 1] = {{{0}}};
    uint8_t n = 0;

    memset(t, 0, sizeof *t);
    t->fast = fast;
    /* By degree, so that the terms up to a degree are the first so many. */
    for (int degree = 0; degree <= BVXI_SERIES_ORDER; degree++) {
        for (int x = degree; x >= 0; x--)
            for (int y = degree - x; y >= 0; y--) {
                int const z = degree - x - y;
                t->power[n][0] = (uint8_t)x;
                t->power[n][1] = (uint8_t)y;
                t->power[n][2] = (uint8_t)z;
                /* A term is a term of one degree less times a coordinate; less says which, for each axis. */
                t->axis[n] = (uint8_t)(x > 0 ? 0 : y > 0 ? 1 : 2);
                if (x > 0) t->less[n][0] = number[x - 1][y][z];
                if (y > 0) t->less[n][1] = number[x][y - 1][z];
                if (z > 0) t->less[n][2] = number[x][y][z - 1];
                number[x][y][z] = n++;
            }
        t->end[degree] = n;
    }
    /* The product of two terms, where it is not of too high a degree. */
    for (int i = 0; i < n; i++)
        for (int k = 0; k < n; k++) {
            int const x = t->power[i][0] + t->power[k][0];
            int const y = t->power[i][1] + t->power[k][1];
            int const z = t->power[i][2] + t->power[k][2];
            if (x + y + z <= BVXI_SERIES_ORDER) t->sum[i][k] = number[x][y][z];
        }
}

static int series_degree(const bvxi_series_table *t, int i)
{
    return t->power[i][0] + t->power[i][1] + t->power[i][2];
}

void bvxi_series_powers(const bvxi_series_table *t, const double v[3], int32_t terms, double *value)
{
    static const double part[BVXI_SERIES_ORDER + 1] = {0, 1, 1.0 / 2, 1.0 / 3, 1.0 / 4, 1.0 / 5};
    /* Each power is one that is known times a coordinate; the factors 1/n make them Taylor's. */
    value[0] = 1;
    for (int i = 1; i < terms; i++)
        value[i] = value[t->less[i][t->axis[i]]] * v[t->axis[i]] * part[t->power[i][t->axis[i]]];
}

void bvxi_series_move_moments(const bvxi_series_table *t, const double *m, const double v[3], double *sum)
{
    double power[BVXI_SERIES_LOCAL];
    bvxi_series_powers(t, v, BVXI_SERIES_LOCAL, power);
    /* Taylor's series about the new centre: each moment is a sum of those of lower degree. */
    for (int k = 0; k < BVXI_SERIES_LOCAL; k++) {
        int const end = t->end[BVXI_SERIES_ORDER - series_degree(t, k)];
        for (int i = 1; i < end; i++) sum[t->sum[k][i]] += power[k] * m[i];
    }
}

void bvxi_series_move_local(const bvxi_series_table *t, const double *c, const double v[3], double *moved)
{
    double power[BVXI_SERIES_LOCAL];
    bvxi_series_powers(t, v, BVXI_SERIES_LOCAL, power);
    /* Terms above the order are left out, as everywhere. */
    for (int k = 0; k < BVXI_SERIES_LOCAL; k++) {
        int const end = t->end[BVXI_SERIES_ORDER - 1 - series_degree(t, k)];
        double sum = 0;
        for (int i = 0; i < end; i++) sum += power[i] * c[t->sum[k][i]];
        moved[k] = sum;
    }
}

#define BVXI_SIMD_LEVEL _base
#include "winding/sheet_series_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "winding/sheet_series_body.h"
#undef BVXI_SIMD_LEVEL
#endif

void bvxi_series_add(const bvxi_series_table *t, bvxi_series_parts *parts, int32_t locals, double *c)
{
    if (parts->count == 0) return;
    /* Lanes without a part do what the first does, and count for nothing. */
    for (int32_t i = parts->count; i < 4; i++) {
        parts->moment[i] = parts->moment[0];
        for (int a = 0; a < 3; a++) parts->way[a][i] = parts->way[a][0];
    }
    BVXI_PATH(t->fast, series_add_base(t, parts, locals, c), series_add_avx2(t, parts, locals, c));
    parts->count = 0;
}
