/* sample.c - values of a grid away from its own centres: trilinear samples with gradients (bvx_grid_sample),
 * and the same set on another lattice (bvx_grid_resample).
 *
 * Guarantee: one stated evaluation in doubles each, so the bits are the same everywhere. */
#include "grid/grid.h"
#include "bits/runs.h"

#include <math.h>

/* ---- Trilinear samples of a grid and their gradients ---- */

/* A point has x = (point - origin) / spacing - 1/2 along each axis, in which voxel i of the lattice has its
 * centre at i. With i = floor(x) and f = x - i the eight voxels around it are blended a + f (b - a), first
 * along x, then y, then z, in doubles. So the value lies in [0, 1] and is the voxel's own where f is 0 along
 * all axes. The gradient is that of the same blend within its eight voxels; on the planes through centres,
 * where it jumps, it is the one of the upper side. Positions count from the lattice's origin, so a window
 * changes nothing but what lies beyond it, which is 0. */

enum { SAMPLE_GRAIN = 512 /* least points a piece */ };

typedef struct sample_work {
    const bvx_grid *grid;
    const double *points;
    double *values, *gradients;
} sample_work;

static double sample_point(const bvx_grid *g, const double point[3], double gradient[3])
{
    int32_t c[3];
    double f[3], row[2][2], slope[2][2], slice[2], slope_x[2], slope_y[2];

    gradient[0] = gradient[1] = gradient[2] = 0.0;
    /* One voxel beyond the window on each side still blends with what is inside. */
    for (int32_t a = 0; a < 3; a++) {
        double const x = (point[a] - g->lattice.origin[a]) / g->lattice.spacing[a] - 0.5;
        double const whole = floor(x), i = whole - (double)g->low[a];
        /* Written so that NaN fails too: a point far away gives no cell. */
        if (!(i >= -1.0 && i < (double)g->size[a])) return 0.0;
        c[a] = (int32_t)i;
        f[a] = x - whole;
    }

    for (int32_t k = 0; k < 2; k++) {
        for (int32_t j = 0; j < 2; j++) {
            double pair[2] = {0.0, 0.0};
            int32_t const y = c[1] + j, z = c[2] + k;
            int const within = y >= 0 && y < g->size[1] && z >= 0 && z < g->size[2];

            /* 0 beyond the window. */
            if (within && c[0] >= 0) pair[0] = (double)bvx_grid_get(g, c[0], y, z);
            if (within && c[0] + 1 < g->size[0]) pair[1] = (double)bvx_grid_get(g, c[0] + 1, y, z);
            slope[k][j] = pair[1] - pair[0];
            row[k][j] = pair[0] + f[0] * slope[k][j];
        }
        slope_y[k] = row[k][1] - row[k][0];
        slope_x[k] = slope[k][0] + f[1] * (slope[k][1] - slope[k][0]);
        slice[k] = row[k][0] + f[1] * slope_y[k];
    }

    gradient[0] = (slope_x[0] + f[2] * (slope_x[1] - slope_x[0])) / g->lattice.spacing[0];
    gradient[1] = (slope_y[0] + f[2] * (slope_y[1] - slope_y[0])) / g->lattice.spacing[1];
    gradient[2] = (slice[1] - slice[0]) / g->lattice.spacing[2];
    return slice[0] + f[2] * (slice[1] - slice[0]);
}

static void sample_points_piece(void *user, uint64_t begin, uint64_t end)
{
    const sample_work *const w = user;
    double unused[3];
    for (uint64_t i = begin; i < end; i++)
        w->values[i] = sample_point(w->grid, w->points + 3 * i,
                                    w->gradients != NULL ? w->gradients + 3 * i : unused);
}

static bvx_status run_grid_sample(bvx_context *context, const bvx_grid *grid, const double *points,
                                  uint64_t count, double *values, double *gradients)
{
    static const char *const function = "bvx_grid_sample";
    sample_work w = {grid, points, values, gradients};
    BVXI_TRY(bvxi_grid_check(context, function, grid));
    if (values == NULL && count != 0) return bvxi_fail_null(context, function, "values");
    BVXI_TRY(bvxi_check_points(context, function, points, count, 3 * sizeof *points));
    return bvxi_for(context, "sample", count, SAMPLE_GRAIN, sample_points_piece, &w);
}

bvx_status bvx_grid_sample(bvx_context *context, const bvx_grid *grid, const double *points, uint64_t count,
                           double *values, double *gradients)
{
    return BVXI_CALL(context, run_grid_sample(context, grid, points, count, values, gradients));
}

/* ---- A grid seen at the centres of another lattice ---- */

/* The old voxel of a new one is a table along each axis, and the tables do not fall. So a run of set voxels
 * along x becomes a run, whose ends a second table has: rows are written by runs, and rows that come from one
 * row are copies of each other. */

enum { RESAMPLE_GRAIN = 2048 /* least words a piece */ };

typedef struct resample_job {
    const bvx_grid *grid;
    bvx_grid *result;
    /* the grid's voxel under each of the result's along y and z; -1 outside [Size: result's size] */
    int32_t *source[2];
    /* the result's first voxel along x at or after each of the grid's [Size: grid's size + 1] */
    int32_t *first;
    uint64_t bytes; /* of all three, in one block */
} resample_job;

/* The voxel that a centre of the result lies in, -1 before the window and its size after it. */
static int32_t source_voxel(const resample_job *job, int32_t axis, int32_t index)
{
    const bvx_grid *const g = job->grid, *const to = job->result;
    /* Divided rather than stepped, so that no error adds up from voxel to voxel. */
    double const centre = to->lattice.origin[axis] +
                          ((double)to->low[axis] + (double)index + 0.5) * to->lattice.spacing[axis];
    double const v = floor((centre - g->lattice.origin[axis]) / g->lattice.spacing[axis]) -
                     (double)g->low[axis];
    return v < 0.0 ? -1 : v >= (double)g->size[axis] ? g->size[axis] : (int32_t)v;
}

static bvx_status lay_resample_tables(bvx_context *ctx, resample_job *job)
{
    const bvx_grid *const g = job->grid, *const to = job->result;
    int32_t next = 0;

    job->bytes = ((uint64_t)to->size[1] + (uint64_t)to->size[2] + (uint64_t)g->size[0] + 1) * sizeof(int32_t);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, job->bytes, "the tables of voxels", &job->source[0]));
    job->source[1] = job->source[0] + to->size[1];
    job->first = job->source[1] + to->size[2];
    for (int32_t a = 1; a < 3; a++)
        for (int32_t i = 0; i < to->size[a]; i++) {
            int32_t const v = source_voxel(job, a, i);
            job->source[a - 1][i] = v < g->size[a] ? v : -1;
        }

    for (int32_t i = 0; i < to->size[0]; i++)
        for (int32_t const v = source_voxel(job, 0, i); next <= v; next++) job->first[next] = i;
    for (; next <= g->size[0]; next++) job->first[next] = to->size[0];
    return BVX_OK;
}

static void resample_piece(void *user, uint64_t begin, uint64_t end)
{
    const resample_job *const job = user;
    bvx_grid *const to = job->result;
    size_t const words = (size_t)to->words_per_row;
    uint64_t const rows = (uint64_t)to->size[1];
    int32_t last_y = -1, last_z = -1;

    for (uint64_t r = begin; r < end; r++) {
        int32_t const y = job->source[0][r % rows], z = job->source[1][r / rows];
        uint64_t *const row = to->words + (size_t)r * words;
        /* Where the row comes from the same row of the grid again, it is a copy of the one just written. */
        if (y >= 0 && z >= 0 && y == last_y && z == last_z) memcpy(row, row - words, words * 8);
        else memset(row, 0, words * 8);
        if (y >= 0 && z >= 0 && (y != last_y || z != last_z)) {
            const bvx_grid *const g = job->grid;
            int32_t first, last;
            bvxi_row_runs runs;
            bvxi_row_runs_start(&runs, bvxi_grid_row(g, y, z), g->size[0], 0);
            /* A run of the grid becomes a run of the result: its ends are looked up, not its voxels. */
            while (bvxi_row_runs_next(&runs, &first, &last))
                bvxi_set_run(row, job->first[first], job->first[last]);
        }
        last_y = y;
        last_z = z;
    }
}

static bvx_status run_grid_resample(bvx_context *context, const bvx_grid *grid, const bvx_lattice *lattice,
                                    const bvx_window *window, bvx_grid *result)
{
    static const char *const function = "bvx_grid_resample";
    resample_job job;
    bvx_window w;

    BVXI_TRY(bvxi_grid_apart(context, function, grid, result));
    BVXI_TRY(bvxi_lattice_check(context, function, lattice));
    BVXI_TRY(bvxi_window_take(context, function, lattice, window, &w));
    bvxi_grid_renew(context, lattice, &w, result);
    int const mine = result->words == NULL;
    BVXI_TRY(bvxi_grid_open(context, function, lattice, &w, result));
    job.grid = grid;
    job.result = result;

    /* The grid was checked before memory for the tables is made, and its words are freed if that fails. */
    bvx_status const status = lay_resample_tables(context, &job);
    if (status != BVX_OK && mine) bvx_grid_free(context, result);
    if (status != BVX_OK) return status;
    return bvxi_grid_made(context,
                          bvxi_for(context, "resample", bvxi_grid_rows(result),
                                   1 + RESAMPLE_GRAIN / (uint64_t)result->words_per_row, resample_piece,
                                   &job),
                          mine, result);
}

bvx_status bvx_grid_resample(bvx_context *context, const bvx_grid *grid, const bvx_lattice *lattice,
                             const bvx_window *window, bvx_grid *result)
{
    return BVXI_CALL(context, run_grid_resample(context, grid, lattice, window, result));
}
