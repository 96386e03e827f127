/* sample.c - trilinear samples of a grid and their gradients.
 *
 * A point has x = (point - origin) / spacing - 1/2 along each axis, in which voxel i of the lattice has its
 * centre at i. With i = floor(x) and f = x - i the eight voxels around it are blended a + f (b - a), first
 * along x, then y, then z, in doubles. So the value lies in [0, 1] and is the voxel's own where f is 0 along
 * all axes. The gradient is that of the same blend within its eight voxels; on the planes through centres,
 * where it jumps, it is the one of the upper side. Positions count from the lattice's origin, so a window
 * changes nothing but what lies beyond it, which is 0. */
#include "grid/grid.h"

#include <math.h>

enum { SAMPLE_GRAIN = 512 /* least points a piece */ };

typedef struct sample_work {
    const bvx_grid *grid;
    const double *points;
    double *values, *gradients;
    uint64_t count;
    int32_t pieces;
} sample_work;

/* The voxel below along an axis, from -1 to size - 1, and the fraction
 * after it; 0 when the sample is 0 whatever is set. */
static int sample_cell(const bvx_grid *g, int32_t axis, double point, int32_t *cell, double *fraction)
{
    double const x = (point - g->lattice.origin[axis]) / g->lattice.spacing[axis] - 0.5;
    double const whole = floor(x), i = whole - (double)g->low[axis];
    /* Written so that NaN fails too: a point far away gives no cell. */
    if (!(i >= -1.0 && i < (double)g->size[axis])) return 0;
    *cell = (int32_t)i;
    *fraction = x - whole;
    return 1;
}

/* Voxels x and x + 1 of a row, 0 beyond the window. */
static void sample_pair(const bvx_grid *g, int32_t x, int32_t y, int32_t z, double pair[2])
{
    pair[0] = pair[1] = 0.0;
    if (y < 0 || y >= g->size[1] || z < 0 || z >= g->size[2]) return;
    if (x >= 0) pair[0] = (double)bvx_grid_get(g, x, y, z);
    if (x + 1 < g->size[0]) pair[1] = (double)bvx_grid_get(g, x + 1, y, z);
}

static double sample_point(const bvx_grid *g, const double point[3], double gradient[3])
{
    int32_t c[3];
    double f[3], row[2][2], slope[2][2], slice[2], slope_x[2], slope_y[2];

    gradient[0] = gradient[1] = gradient[2] = 0.0;
    /* One voxel beyond the window on each side still blends with what is inside. */
    for (int32_t a = 0; a < 3; a++)
        if (!sample_cell(g, a, point[a], &c[a], &f[a])) return 0.0;

    /* Along x first, then y, then z; each slope is blended
     * like the values, as the gradient of the same blend. */
    for (int32_t k = 0; k < 2; k++) {
        for (int32_t j = 0; j < 2; j++) {
            double pair[2];
            sample_pair(g, c[0], c[1] + j, c[2] + k, pair);
            slope[k][j] = pair[1] - pair[0];
            row[k][j] = pair[0] + f[0] * slope[k][j];
        }
        slope_y[k] = row[k][1] - row[k][0];
        slope_x[k] = slope[k][0] + f[1] * (slope[k][1] - slope[k][0]);
        slice[k] = row[k][0] + f[1] * slope_y[k];
    }

    /* Slopes are per voxel, gradients per unit of the world. */
    gradient[0] = (slope_x[0] + f[2] * (slope_x[1] - slope_x[0])) / g->lattice.spacing[0];
    gradient[1] = (slope_y[0] + f[2] * (slope_y[1] - slope_y[0])) / g->lattice.spacing[1];
    gradient[2] = (slice[1] - slice[0]) / g->lattice.spacing[2];
    return slice[0] + f[2] * (slice[1] - slice[0]);
}

static void sample_points_piece(void *user, int32_t index, int32_t worker)
{
    const sample_work *const w = user;
    double unused[3];
    uint64_t begin, end;
    (void)worker;
    bvxi_piece(w->count, w->pieces, index, &begin, &end);
    for (uint64_t i = begin; i < end; i++)
        w->values[i] = sample_point(w->grid, w->points + 3 * i,
                                    w->gradients != NULL ? w->gradients + 3 * i : unused);
}

static bvx_status check_sample_points(bvx_context *ctx, const char *function, const double *points,
                                      uint64_t count)
{
    static const char axis_name[3][2] = {"x", "y", "z"};
    for (uint64_t i = 0; i < count; i++)
        for (int a = 0; a < 3; a++)
            if (points[3 * i + (uint64_t)a] - points[3 * i + (uint64_t)a] != 0.0)
                return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                     "%s: point %i has %s = %g, which is not finite", function, i,
                                     axis_name[a], points[3 * i + (uint64_t)a]);
    return BVX_OK;
}

static bvx_status run_grid_sample(bvx_context *context, const bvx_grid *grid, const double *points,
                                  uint64_t count, double *values, double *gradients)
{
    static const char *const function = "bvx_grid_sample";
    sample_work w = {grid, points, values, gradients, count, bvxi_piece_count(count, SAMPLE_GRAIN)};

    if (context == NULL) return BVX_ERR_ARGUMENT;
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    /* Arrays are only needed where there are points. */
    if (points == NULL && count != 0) return bvxi_fail_null(context, function, "points");
    if (values == NULL && count != 0) return bvxi_fail_null(context, function, "values");
    if (count > SIZE_MAX / 24)
        return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: %u points are beyond this machine's addresses", function, count);
    BVXI_TRY(check_sample_points(context, function, points, count));
    return bvxi_parallel(context, "sample", 0.0, 1.0, w.pieces, sample_points_piece, &w);
}

bvx_status bvx_grid_sample(bvx_context *context, const bvx_grid *grid, const double *points, uint64_t count,
                           double *values, double *gradients)
{
    return BVXI_CALL(context, run_grid_sample(context, grid, points, count, values, gradients));
}
