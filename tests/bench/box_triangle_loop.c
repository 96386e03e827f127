/* box_triangle_loop.c - the baseline for conservative surfaces: a separating axis test for every voxel of a
 * triangle's box.
 *
 * Source: Akenine-Moller. Fast 3D Triangle-Box Overlap Testing. 2001: the box's three axes, the triangle's
 * plane, the nine products of their edges. What a triangle has in common for all boxes is computed once; the
 * cheap axes come first. In doubles, so rounding decides where box and triangle only just touch. */
#include "box_triangle_loop.h"

#include <math.h>
#include <string.h>

void box_triangle_prepare(box_triangle *t, const double *a, const double *b, const double *c)
{
    memcpy(t->corner[0], a, sizeof t->corner[0]);
    memcpy(t->corner[1], b, sizeof t->corner[1]);
    memcpy(t->corner[2], c, sizeof t->corner[2]);
    for (int i = 0; i < 3; i++) {
        for (int k = 0; k < 3; k++) t->edge[k][i] = t->corner[(k + 1) % 3][i] - t->corner[k][i];
        t->low[i] = a[i] < b[i] ? a[i] : b[i];
        t->low[i] = t->low[i] < c[i] ? t->low[i] : c[i];
        t->high[i] = a[i] > b[i] ? a[i] : b[i];
        t->high[i] = t->high[i] > c[i] ? t->high[i] : c[i];
    }
    for (int i = 0; i < 3; i++) {
        int const j = (i + 1) % 3, k = (i + 2) % 3;
        t->normal[i] = t->edge[0][j] * t->edge[1][k] - t->edge[0][k] * t->edge[1][j];
    }
}

/* The axis across an edge and box axis i: both ends of the edge fall on one
 * place there, p; the third corner on q. */
static inline int axis_parts_them(double ej, double ek, const double *p, const double *q, int j, int k,
                                  double half)
{
    double const s = ej * p[k] - ek * p[j], u = ej * q[k] - ek * q[j];
    double const reach = half * (fabs(ej) + fabs(ek));
    return s < u ? s > reach || u < -reach : u > reach || s < -reach;
}

int box_triangle_meets(const box_triangle *t, const double centre[3], double half)
{
    double v[3][3], along = 0.0, reach = 0.0;

    for (int i = 0; i < 3; i++)
        if (t->low[i] - centre[i] > half || t->high[i] - centre[i] < -half) return 0;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++) v[k][i] = t->corner[k][i] - centre[i];
    for (int i = 0; i < 3; i++) {
        along += t->normal[i] * v[0][i];
        reach += half * fabs(t->normal[i]);
    }
    if (fabs(along) > reach) return 0;
    for (int n = 0; n < 3; n++) {
        const double *const e = t->edge[n], *const p = v[n], *const q = v[(n + 2) % 3];
        if (axis_parts_them(e[1], e[2], p, q, 1, 2, half) || axis_parts_them(e[2], e[0], p, q, 2, 0, half) ||
            axis_parts_them(e[0], e[1], p, q, 0, 1, half))
            return 0;
    }
    return 1;
}

/* Voxels along one axis whose closed boxes reach from low to high; none: first above last. */
static void box_range(double low, double high, int32_t size, int32_t *first, int32_t *last)
{
    double const a = ceil(low) - 1.0, b = floor(high);
    *first = a > 0.0 ? (a < size ? (int32_t)a : size) : 0;
    *last = b < size - 1 ? (b >= 0.0 ? (int32_t)b : -1) : size - 1;
}

static void take_box(bvx_grid *grid, const box_triangle *t)
{
    int32_t first[3], last[3];
    double centre[3];

    for (int i = 0; i < 3; i++) box_range(t->low[i], t->high[i], grid->size[i], &first[i], &last[i]);
    for (int32_t z = first[2]; z <= last[2]; z++) {
        centre[2] = z + 0.5;
        for (int32_t y = first[1]; y <= last[1]; y++) {
            centre[1] = y + 0.5;
            for (int32_t x = first[0]; x <= last[0]; x++) {
                centre[0] = x + 0.5;
                if (box_triangle_meets(t, centre, 0.5)) bvx_grid_set(grid, x, y, z, 1);
            }
        }
    }
}

void box_triangle_loop(const double *points, const uint32_t *triangles, uint64_t triangle_count,
                       bvx_grid *grid)
{
    const bvx_lattice *const l = &grid->lattice;
    double const scale[3] = {1.0 / l->spacing[0], 1.0 / l->spacing[1], 1.0 / l->spacing[2]};
    size_t const rows = (size_t)grid->size[1] * (size_t)grid->size[2];

    memset(grid->words, 0, rows * (size_t)grid->words_per_row * sizeof *grid->words);
    for (uint64_t n = 0; n < triangle_count; n++) {
        box_triangle t;
        double c[3][3];
        for (int k = 0; k < 3; k++)
            for (int i = 0; i < 3; i++)
                c[k][i] = (points[(size_t)3 * triangles[3 * n + (uint64_t)k] + (size_t)i] - l->origin[i]) *
                          scale[i];
        box_triangle_prepare(&t, c[0], c[1], c[2]);
        take_box(grid, &t);
    }
}
