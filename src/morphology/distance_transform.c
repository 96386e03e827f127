/* distance_transform.c - distances from the centres of a grid's voxels to set or empty ones, as squares or
 * as lengths.
 *
 * Source: Meijster, Roerdink, Hesselink. A General Algorithm for Computing Distance Transforms in Linear
 * Time. 2000, by tiles (transform.c). Cubic voxels: whole numbers of steps, so the spacing enters once,
 * behind the root; where the window's diagonal is too long for 32 bits the same whole numbers are carried
 * as doubles. SIGNED is two transforms, of which the second writes on set voxels only. */
#include "grid/grid.h"
#include "morphology/transform.h"

#include <math.h>

enum { DISTANCE_GROUPS = 4 };

#define DISTANCE_LEAST_SPACING 0x1p-400
#define DISTANCE_MOST_SPACING  0x1p400
#define DISTANCE_LEAST_FLOAT   0x1p-100
#define DISTANCE_MOST_FLOAT    0x1p100

typedef struct distance_job {
    const bvx_grid *grid;
    bvx_distance_options o;
    void *values;
    int32_t value_type, whole, inside, cpu;
    double factor; /* of a root */
} distance_job;

BVXI_VECTOR_INLINE void make_lengths(const distance_job *job, const void *squares,
                                     double *BVXI_RESTRICT lengths)
{
    /* Inside a body signed distances are negative. */
    double const factor = job->inside && job->o.side == BVX_DISTANCE_SIGNED ? -job->factor : job->factor;
    if (job->whole) {
        const uint32_t *const s = squares;
        /* A square of no target stands for an infinite one; the number itself is only large. */
        for (int i = 0; i < BVXI_LANES; i++)
            lengths[i] = s[i] == BVXI_FAR ? factor * (double)INFINITY : factor * sqrt((double)s[i]);
    } else {
        const double *const s = squares;
        for (int i = 0; i < BVXI_LANES; i++) lengths[i] = factor * sqrt(s[i]);
    }
}

BVXI_VECTOR_INLINE void store_floats(float *BVXI_RESTRICT to, const double *BVXI_RESTRICT lengths)
{
    for (int i = 0; i < BVXI_LANES; i++) to[i] = (float)lengths[i];
}

BVXI_VECTOR_INLINE void take_lengths(const distance_job *job, size_t at, int32_t count, uint32_t wanted,
                                     const void *squares)
{
    double lengths[BVXI_LANES];
    make_lengths(job, squares, lengths);
    /* The usual case has no branch, so compilers make vectors of it. */
    if (job->value_type == BVX_F32 && count == BVXI_LANES && wanted == 0xffffu)
        store_floats((float *)job->values + at, lengths);
    else {
        for (int32_t i = 0; i < count; i++) {
            if ((wanted >> i & 1) == 0) continue;
            if (job->value_type == BVX_F32) ((float *)job->values)[at + (size_t)i] = (float)lengths[i];
            else ((double *)job->values)[at + (size_t)i] = lengths[i];
        }
    }
}

BVXI_AVX2_COPY(take_lengths_avx2,
               (const distance_job *job, size_t at, int32_t count, uint32_t wanted, const void *squares),
               take_lengths(job, at, count, wanted, squares))

static void take_squares(void *user, int32_t x, int32_t y, int32_t z, int32_t count, const void *squares,
                         const uint64_t *nearest)
{
    const distance_job *const job = user;
    const bvx_grid *const g = job->grid;
    size_t const row = (size_t)z * (size_t)g->size[1] + (size_t)y, at = row * (size_t)g->size[0] + (size_t)x;
    uint32_t wanted = 0xffffu;

    if (job->inside && job->o.side == BVX_DISTANCE_SIGNED)
        wanted = (uint32_t)(g->words[row * (size_t)g->words_per_row + (size_t)(x >> 6)] >> (x & 63)) &
                 0xffffu;
    if (wanted == 0) return;
    for (int32_t i = 0; i < count && nearest != NULL; i++)
        if (wanted >> i & 1) job->o.nearest[at + (size_t)i] = nearest[i];
    if (job->value_type == BVX_SQUARES) {
        memcpy((uint32_t *)job->values + at, squares, (size_t)count * sizeof(uint32_t));
        return;
    }
    BVXI_PATH(job->cpu == BVX_CPU_AVX2, take_lengths(job, at, count, wanted, squares),
              take_lengths_avx2(job, at, count, wanted, squares));
}

static bvx_status measure_side(bvx_context *ctx, distance_job *job, int32_t inside, double from, double to)
{
    const bvx_grid *const g = job->grid;
    const double *const s = g->lattice.spacing;
    int const cubic = s[0] == s[1] && s[0] == s[2];
    bvxi_transform t = {.ctx = ctx, .from = from, .to = to};

    /* Cubic voxels are measured in steps; the spacing comes in with the root, by one product. */
    job->inside = inside;
    job->factor = cubic ? s[0] : 1.0;
    t.stage = "distance";
    t.box.words = g->words;
    memcpy(t.box.size, g->size, sizeof t.box.size);
    t.box.row_words = g->words_per_row;
    /* Inside, the empty voxels are the targets, so all bits are turned. */
    t.flip = inside;
    t.beyond = job->o.beyond == (inside ? BVX_BEYOND_EMPTY : BVX_BEYOND_SET);
    t.whole = job->whole;
    t.nearest = job->o.nearest != NULL;
    t.groups = DISTANCE_GROUPS;
    /* Others are measured in the world's unit, by squares of their sides. */
    for (int a = 0; a < 3; a++) t.weight[a] = cubic ? 1.0 : s[a] * s[a];
    t.limit = (double)INFINITY;
    t.sink = take_squares;
    t.user = job;
    return bvxi_transform_run(&t);
}

static const bvxi_option distance_rows[] = {
    BVXI_CHOICE(bvx_distance_options, side, BVX_DISTANCE_OUTSIDE, BVX_DISTANCE_SIGNED),
    BVXI_CHOICE(bvx_distance_options, beyond, BVX_BEYOND_NOTHING, BVX_BEYOND_SET),
    BVXI_RESERVED(bvx_distance_options, reserved),
};

static bvx_status check_distance(bvx_context *ctx, const char *function, const bvx_grid *grid,
                                 const bvx_distance_options *options, uint64_t capacity, distance_job *job)
{
    memset(job, 0, sizeof *job);
    BVXI_TRY(bvxi_grid_check(ctx, function, grid));
    BVXI_TRY(bvxi_take_options(ctx, function, options, &job->o, sizeof job->o));
    BVXI_TRY(bvxi_check_options(ctx, function, &job->o, BVXI_OPTIONS(distance_rows)));
    /* Squares of such spacings neither overflow nor lose digits near 0. */
    for (int32_t a = 0; a < 3; a++)
        if (grid->lattice.spacing[a] < DISTANCE_LEAST_SPACING ||
            grid->lattice.spacing[a] > DISTANCE_MOST_SPACING)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                 "%s: squares of a spacing of %g are beyond what doubles hold well", function,
                                 grid->lattice.spacing[a]);
    /* sides of at most 2^25, words that fit memory */
    uint64_t const voxels = bvxi_grid_rows(grid) * (uint64_t)grid->size[0];
    if (capacity < voxels)
        return bvxi_fail(ctx, BVX_ERR_CAPACITY, "%s: the array holds %u numbers, the window has %u voxels",
                         function, capacity, voxels);
    job->grid = grid;
    return BVX_OK;
}

static bvx_status check_squares(bvx_context *ctx, const char *function, const distance_job *job)
{
    const double *const s = job->grid->lattice.spacing;
    const int32_t *const n = job->grid->size;

    if (job->o.side == BVX_DISTANCE_SIGNED)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: squares have no sign; take BVX_DISTANCE_OUTSIDE or BVX_DISTANCE_INSIDE",
                             function);
    if (s[0] != s[1] || s[0] != s[2])
        return bvxi_fail_for(
            ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
            "%s: voxels of %g x %g x %g are not cubic, so their squares are not whole; take BVX_F64",
            function, s[0], s[1], s[2]);
    if (!bvxi_transform_fits_whole(n))
        return bvxi_fail_for(
            ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
            "%s: squares in a window of %d x %d x %d voxels do not fit 32 bits; take BVX_F64", function,
            (int64_t)n[0], (int64_t)n[1], (int64_t)n[2]);
    return BVX_OK;
}

static bvx_status run_grid_distance(bvx_context *context, const bvx_grid *grid,
                                    const bvx_distance_options *options, int32_t value_type, void *values,
                                    uint64_t capacity)
{
    static const char *const function = "bvx_grid_distance";
    distance_job job;

    if (values == NULL) return bvxi_fail_null(context, function, "values");
    BVXI_TRY(check_distance(context, function, grid, options, capacity, &job));
    if (value_type < BVX_F32 || value_type > BVX_SQUARES)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: value_type is %d; it must be BVX_F32, BVX_F64 or BVX_SQUARES", function,
                             (int64_t)value_type);
    /* Floats have less room, for the distances themselves. */
    if (value_type == BVX_F32) {
        for (int32_t a = 0; a < 3; a++)
            if (grid->lattice.spacing[a] < DISTANCE_LEAST_FLOAT ||
                grid->lattice.spacing[a] > DISTANCE_MOST_FLOAT)
                return bvxi_fail_for(
                    context, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                    "%s: floats do not hold distances of voxels with a spacing of %g; take BVX_F64", function,
                    grid->lattice.spacing[a]);
    }
    if (value_type == BVX_SQUARES) BVXI_TRY(check_squares(context, function, &job));
    job.values = values;
    job.value_type = value_type;

    int32_t const side = job.o.side;
    const double *const s = job.grid->lattice.spacing;
    /* Whole numbers are exact and half as large; doubles where squares outgrow 32 bits. */
    job.whole = s[0] == s[1] && s[0] == s[2] && bvxi_transform_fits_whole(job.grid->size);
    job.cpu = bvxi_cpu(context);
    if (side != BVX_DISTANCE_SIGNED)
        return measure_side(context, &job, side == BVX_DISTANCE_INSIDE, 0.0, 1.0);
    BVXI_TRY(measure_side(context, &job, 0, 0.0, 0.5));
    return measure_side(context, &job, 1, 0.5, 1.0);
}

bvx_status bvx_grid_distance(bvx_context *context, const bvx_grid *grid, const bvx_distance_options *options,
                             int32_t value_type, void *values, uint64_t capacity)
{
    return BVXI_CALL(context, run_grid_distance(context, grid, options, value_type, values, capacity));
}
