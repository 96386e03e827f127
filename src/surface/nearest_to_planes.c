/* nearest_to_planes.c - the point of a box that lies nearest to given planes.
 *
 * Source: Kobbelt et al. Feature Sensitive Surface Extraction from Volume Data. 2001; Ju et al. Dual
 * Contouring of Hermite Data. 2002: the least sum of squared distances; directions in which the planes hardly
 * differ are left at the middle. Where the point lies outside the box, the coordinate that is furthest out is
 * put on its side and the others are found anew. Eigenvectors by Jacobi's rotations, a fixed number, so that
 * the result is the same everywhere. */
#include "surface/sharp.h"

#include <math.h>

enum { ROTATION_SWEEPS = 8 }; /* three sweeps reach doubles' precision in practice */

/* Directions whose eigenvalue is below this part of the largest are left free. */
#define LEAST_EIGENVALUE 0.02

/* One rotation that makes a[p][q] zero. */
static void rotate_symmetric(double a[3][3], double v[3][3], int p, int q)
{
    int const r = 3 - p - q;
    double const theta = (a[q][q] - a[p][p]) / (2.0 * a[p][q]);
    double const size = theta < 0 ? -theta : theta;
    double const t = (theta < 0 ? -1.0 : 1.0) / (size + sqrt(theta * theta + 1.0));
    double const c = 1.0 / sqrt(t * t + 1.0), s = t * c;
    double const apq = a[p][q], arp = a[r][p], arq = a[r][q];

    /* A rotation of rows and columns p and q; the third is carried along. */
    a[p][p] -= t * apq;
    a[q][q] += t * apq;
    a[p][q] = a[q][p] = 0.0;
    a[r][p] = a[p][r] = c * arp - s * arq;
    a[r][q] = a[q][r] = s * arp + c * arq;
    for (int k = 0; k < 3; k++) {
        double const vp = v[k][p], vq = v[k][q];
        v[k][p] = c * vp - s * vq;
        v[k][q] = s * vp + c * vq;
    }
}

/* The least place with the coordinates of fixed held where x has them. */
static void find_free_coordinates(const bvxi_apex_plane *planes, int32_t count, const double middle[3],
                                  const int fixed[3], double x[3])
{
    double a[3][3] = {{0}}, b[3] = {0};

    /* Those that were put on a side stay there. */
    for (int k = 0; k < 3; k++) x[k] = fixed[k] ? x[k] : middle[k];
    for (int32_t i = 0; i < count; i++) {
        const double *const n = planes[i].n;
        double const left = planes[i].d - (n[0] * x[0] + n[1] * x[1] + n[2] * x[2]);
        for (int k = 0; k < 3; k++) {
            if (fixed[k]) continue;
            b[k] += n[k] * left;
            for (int l = 0; l < 3; l++)
                if (!fixed[l]) a[k][l] += n[k] * n[l];
        }
    }

    /* x += the least solution of a x = b in the span of a's larger eigenvalues. */
    double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, largest = 0.0;

    /* A fixed number of sweeps, whatever the numbers are. */
    for (int n = 0; n < ROTATION_SWEEPS; n++)
        for (int p = 0; p < 2; p++)
            for (int q = p + 1; q < 3; q++)
                if (a[p][q] != 0.0) rotate_symmetric(a, v, p, q);
    for (int i = 0; i < 3; i++) largest = a[i][i] > largest ? a[i][i] : largest;
    for (int i = 0; i < 3; i++) {
        /* Directions that planes hardly decide stay at the middle. */
        if (!(a[i][i] > LEAST_EIGENVALUE * largest)) continue;
        double const along = (v[0][i] * b[0] + v[1][i] * b[1] + v[2][i] * b[2]) / a[i][i];
        for (int k = 0; k < 3; k++) x[k] += along * v[k][i];
    }
}

void bvxi_apex(const bvxi_apex_plane *planes, int32_t count, const double middle[3], const double half[3],
               double apex[3])
{
    int fixed[3] = {0, 0, 0};

    for (int turn = 0; turn < 4; turn++) {
        double most = 1.0;
        int worst = -1;
        find_free_coordinates(planes, count, middle, fixed, apex);

        for (int k = 0; k < 3; k++) {
            double const out = (apex[k] < 0 ? -apex[k] : apex[k]) / half[k];
            if (fixed[k] || !(out > most)) continue;
            most = out;
            worst = k;
        }
        if (worst < 0) return;
        apex[worst] = apex[worst] < 0 ? -half[worst] : half[worst];
        fixed[worst] = 1;
    }
}
