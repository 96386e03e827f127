/* dense.c - a sparse field as an array with a number, or three, for every centre: bvx_field_dense.
 *
 * Beyond the band stands the half-width, a lower bound of the distance, or what closest points give that
 * neighbours pass on, an upper bound. Rows are written by themselves, so threads do not show. */
#include "field/room.h"
#include "nearest/closest.h"

enum { DENSE_GRAIN = 1 << 15 /* centres of the smallest task */ };

#define DENSE_TIME 10.0 /* a centre where the array's memory is new; reports go by it [Units: nanoseconds] */

typedef struct dense_job {
    const bvx_field *field;
    float *values;
    int32_t vectors, pieces;
} dense_job;

static void write_dense_rows(void *user, int32_t piece)
{
    const dense_job *const job = user;
    const bvx_grid *const g = &job->field->band;
    uint64_t const each = job->vectors ? 3 : 1;
    double numbers[3 * BVXI_WORD_BITS];
    uint64_t row, end;

    bvxi_piece(bvxi_grid_rows(g), job->pieces, piece, &row, &end);
    for (; row < end; row++) {
        float *to = job->values + (size_t)(row * (uint64_t)g->size[0] * each);

        /* Values lie by rank: each row knows its first one's number. */
        uint64_t next = job->field->row_values[row];
        for (int32_t k = 0; k < g->words_per_row; k++) {
            int32_t const left = g->size[0] - k * BVXI_WORD_BITS;
            uint64_t const n = each * (uint64_t)(left < BVXI_WORD_BITS ? left : BVXI_WORD_BITS);
            bvxi_field_word(job->field, row, k, job->vectors, &next, numbers);
            for (uint64_t i = 0; i < n; i++) *to++ = bvxi_field_float(numbers[i]);
        }
    }
}

static bvx_status check_far(bvx_context *ctx, const char *function, const bvx_field *field,
                            const bvx_mesh_view *mesh, int32_t far_rule)
{
    if (far_rule != BVX_FAR_CONSTANT && far_rule != BVX_FAR_PROPAGATED)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: far_rule is %d, not BVX_FAR_CONSTANT (0) or BVX_FAR_PROPAGATED (1)",
                             function, (int64_t)far_rule);
    if (far_rule == BVX_FAR_CONSTANT) return BVX_OK;
    if (mesh == NULL) return bvxi_fail_null(ctx, function, "mesh");
    /* Propagation begins at triangles, which only such fields keep. */
    if (field->triangles == NULL)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: BVX_FAR_PROPAGATED needs the field's triangles: measure it with features 1",
                             function);
    if (field->value_count == 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the band has no value that could be propagated", function);
    return BVX_OK;
}

static bvx_status run_field_dense(bvx_context *context, const bvx_field *field, const bvx_mesh_view *mesh,
                                  int32_t far_rule, int32_t vectors, float *values)
{
    static const char function[] = "bvx_field_dense";
    dense_job job;

    if (values == NULL) return bvxi_fail_null(context, function, "values");
    BVXI_TRY(bvxi_field_check(context, function, field));
    BVXI_TRY(bvxi_field_check_vectors(context, function, field, vectors));
    BVXI_TRY(check_far(context, function, field, mesh, far_rule));
    job.field = field;
    job.values = values;
    job.vectors = vectors;
    double const centres = (double)bvxi_grid_rows(&field->band) * (double)field->band.size[0];
    job.pieces = bvxi_piece_count(bvxi_grid_rows(&field->band),
                                  1 + DENSE_GRAIN / (uint64_t)field->band.size[0]);
    BVXI_TRY(bvxi_each_long(context, "dense field", 0.0, far_rule == BVX_FAR_CONSTANT ? 1.0 : 0.1, job.pieces,
                            DENSE_TIME * centres / (double)job.pieces, write_dense_rows, &job));
    return far_rule == BVX_FAR_CONSTANT
               ? BVX_OK
               : bvxi_field_propagate(context, function, field, mesh, vectors, values);
}

bvx_status bvx_field_dense(bvx_context *context, const bvx_field *field, const bvx_mesh_view *mesh,
                           int32_t far_rule, int32_t vectors, float *values)
{
    return BVXI_CALL(context, run_field_dense(context, field, mesh, far_rule, vectors, values));
}

/* ---- Distances outside the band from closest points that neighbours pass on ---- */

/* Source: Danielsson. Euclidean Distance Mapping. 1980, and Satherley, Jones. Vector-City Vector Distance
 * Transform. 2001: a centre takes over what its neighbour found closest. Handed on are the closest points of
 * the band's centres; in the end each centre is measured to the triangle that its point came from. So what it
 * gets is the exact distance to some triangle: an upper bound, which never is below the true one.
 *
 * Six sweeps, along x up and down, along y, along z, are done three times. Within a sweep a centre depends on
 * the one before it along the axis alone, so lines are done side by side and threads do not show. Of two
 * points at one distance (as floats) that of the lesser value wins. A centre misses its closest triangle when
 * no point of it won on a way there; how far that puts it off is measured in tests/unit/test_field_dense.c
 * and stated at bvx_field_dense. */

enum { PROPAGATE_SWEEPS = 6, PROPAGATE_ROUNDS = 3, PROPAGATE_GRAIN = 1 << 12 };

/* What a centre takes, as measured on one processor; reports go by it [Units: nanoseconds] */
#define PROPAGATE_SWEEP_TIME   8.0
#define PROPAGATE_MEASURE_TIME 60.0

#define PROPAGATE_NONE UINT32_MAX

typedef struct propagate_job {
    const bvx_field *field;
    const bvx_mesh_view *mesh;
    uint32_t *source;         /* the value whose point is a centre's, or PROPAGATE_NONE [Size: voxels] */
    float *points;            /* closest points of the band, scaled [Size: value_count * 3] */
    float *values;            /* while it goes on, a centre's first number is the scaled distance squared */
    uint64_t each;            /* numbers a centre */
    double scale;             /* power of two that brings mesh and window into [-1, 1] */
    double first[3], step[3]; /* of the centres, scaled */
    int32_t axis, down;       /* of the sweep */
    int32_t pieces;
} propagate_job;

/* Distance from a centre to a triangle, and the vector to its closest point [Units: world]. */
static double propagate_measure(const propagate_job *job, int32_t x, int32_t y, int32_t z, uint32_t triangle,
                                double vector[3])
{
    double p[3], t[3][3], q[3];

    bvxi_field_centre(&job->field->band, x, y, z, p);
    for (int k = 0; k < 3; k++) p[k] *= job->scale;
    bvxi_view_scaled(job->mesh, triangle, job->scale, t);
    double const d2 = bvxi_closest_on_triangle(p, (const double(*)[3])t, q);
    for (int a = 0; a < 3; a++) vector[a] = (q[a] - p[a]) / job->scale;
    return sqrt(d2) / job->scale;
}

/* Rows of the band: its own values are the sources there. */
static void propagate_start(void *user, int32_t piece)
{
    const propagate_job *const job = user;
    const bvx_field *const f = job->field;
    const bvx_grid *const g = &f->band;
    uint64_t row, end;

    bvxi_piece(bvxi_grid_rows(g), job->pieces, piece, &row, &end);
    for (; row < end; row++) {
        int32_t const y = (int32_t)(row % (uint64_t)g->size[1]), z = (int32_t)(row / (uint64_t)g->size[1]);
        uint32_t *const source = job->source + row * (uint64_t)g->size[0];
        uint64_t n = f->row_values[row];

        for (int32_t x = 0; x < g->size[0]; x++) {
            double v[3], c[3];
            source[x] = PROPAGATE_NONE;
            if (!bvx_grid_get(g, x, y, z)) continue;
            propagate_measure(job, x, y, z, f->triangles[n], v);
            bvxi_field_centre(g, x, y, z, c);
            /* Kept as floats: only comparisons are made with them; results are measured anew. */
            for (uint64_t a = 0; a < 3; a++) job->points[3 * n + a] = (float)((c[a] + v[a]) * job->scale);
            source[x] = (uint32_t)n++;
        }
    }
}

/* The centre at takes over the point of the one before it when that is closer. The band keeps its own. */
static inline void propagate_offer(const propagate_job *job, const int32_t at[3], uint64_t to, uint64_t from)
{
    uint32_t const offered = job->source[from], has = job->source[to];
    float *const best = &job->values[to * job->each];
    float d, d2 = 0.0f;

    if (offered == has || offered == PROPAGATE_NONE) return;
    if (bvx_grid_get(&job->field->band, at[0], at[1], at[2])) return;
    const float *const q = job->points + 3 * (size_t)offered;
    for (int a = 0; a < 3; a++) {
        d = (float)(job->first[a] + (double)at[a] * job->step[a]) - q[a];
        d2 += d * d;
    }
    /* At one distance the lesser value wins, whatever order both came in. */
    if (has != PROPAGATE_NONE && (d2 > *best || (d2 == *best && offered > has))) return;
    *best = d2;
    job->source[to] = offered;
}

/* A piece of the lines along the axis: rows in slices for x and y, rows of all slices for z. */
static void propagate_sweep(void *user, int32_t piece)
{
    const propagate_job *const job = user;
    const int32_t *const size = job->field->band.size;
    uint64_t const row = (uint64_t)size[0], slice = row * (uint64_t)size[1];
    uint64_t const step = job->axis == 0 ? 1 : job->axis == 1 ? row : slice;
    int32_t const split = job->axis == 2 ? 1 : 2; /* the axis along which pieces are cut */
    uint64_t begin, end;
    int32_t low[3] = {0, 0, 0}, high[3] = {size[0], size[1], size[2]};

    bvxi_piece((uint64_t)size[split], job->pieces, piece, &begin, &end);
    /* Pieces are cut across the sweep's axis: no line is shared. */
    low[split] = (int32_t)begin;
    high[split] = (int32_t)end;
    low[job->axis] = 1; /* steps along the axis, counted from where the sweep starts */
    for (int32_t k = low[2]; k < high[2]; k++)
        for (int32_t j = low[1]; j < high[1]; j++)
            for (int32_t i = low[0]; i < high[0]; i++) {
                int32_t at[3] = {i, j, k};
                /* Downwards the same steps, counted from the other end. */
                if (job->down) at[job->axis] = size[job->axis] - 1 - at[job->axis];
                uint64_t to = (uint64_t)at[2] * slice + (uint64_t)at[1] * row + (uint64_t)at[0];
                propagate_offer(job, at, to, job->down ? to + step : to - step);
            }
}

static bvx_status propagate_all(bvx_context *ctx, propagate_job *job)
{
    const bvx_grid *const g = &job->field->band;
    double const centres = (double)bvxi_grid_rows(g) * (double)g->size[0];
    int32_t const sweeps = PROPAGATE_SWEEPS * PROPAGATE_ROUNDS;

    for (int32_t s = 0; s < sweeps; s++) {
        double const from = 0.2 + 0.5 * s / sweeps, to = 0.2 + 0.5 * (s + 1) / sweeps;

        job->axis = s / 2 % 3;
        job->down = s % 2;
        job->pieces = bvxi_piece_count((uint64_t)g->size[job->axis == 2 ? 1 : 2], 1);
        BVXI_TRY(bvxi_each_long(ctx, "dense field", from, to, job->pieces,
                                centres * PROPAGATE_SWEEP_TIME / (double)job->pieces, propagate_sweep, job));
    }
    return BVX_OK;
}

/* Distances with their sign, or vectors, outside the band. */
static void propagate_finish(void *user, int32_t piece)
{
    const propagate_job *const job = user;
    const bvx_field *const f = job->field;
    const bvx_grid *const g = &f->band;
    uint64_t row, end;

    bvxi_piece(bvxi_grid_rows(g), job->pieces, piece, &row, &end);
    for (; row < end; row++) {
        int32_t const y = (int32_t)(row % (uint64_t)g->size[1]), z = (int32_t)(row / (uint64_t)g->size[1]);
        for (int32_t x = 0; x < g->size[0]; x++) {
            uint64_t const at = row * (uint64_t)g->size[0] + (uint64_t)x;
            float *const to = job->values + at * job->each;
            double v[3], d;
            if (bvx_grid_get(g, x, y, z)) continue;
            d = propagate_measure(job, x, y, z, f->triangles[job->source[at]], v);
            if (f->inside.words != NULL && bvx_grid_get(&f->inside, x, y, z)) d = -d;
            if (job->each == 1) *to = bvxi_field_float(d);
            for (uint64_t a = 0; a < 3 && job->each == 3; a++) to[a] = bvxi_field_float(v[a]);
        }
    }
}

static bvx_status check_sources(bvx_context *ctx, const char *function, const bvx_field *field,
                                const bvx_mesh_view *mesh)
{
    if (field->value_count >= PROPAGATE_NONE)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the field has %u values; fewer than 2^32 - 1 can be propagated", function,
                             field->value_count);
    /* The mesh is given once more, and may be another one. */
    for (uint64_t n = 0; n < field->value_count; n++)
        if (field->triangles[n] >= mesh->triangle_count)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_INDEX,
                                 "%s: value %i has the closest triangle %u, but the mesh has %u", function, n,
                                 (uint64_t)field->triangles[n], mesh->triangle_count);
    return BVX_OK;
}

/* low and high are the mesh's bounds. */
static void place_centres(const double low[3], const double high[3], propagate_job *job)
{
    const bvx_grid *const g = &job->field->band;
    double first[3];

    bvxi_field_centre(g, 0, 0, 0, first);
    job->scale = bvxi_field_scale(g, low, high);
    for (int a = 0; a < 3; a++) {
        job->first[a] = first[a] * job->scale;
        job->step[a] = g->lattice.spacing[a] * job->scale;
    }
}

static bvx_status propagate_steps(bvx_context *ctx, uint64_t voxels, propagate_job *job)
{
    const bvx_grid *const g = &job->field->band;
    int32_t const pieces = bvxi_piece_count(bvxi_grid_rows(g), 1 + PROPAGATE_GRAIN / (uint64_t)g->size[0]);
    double const each = (double)voxels * PROPAGATE_MEASURE_TIME / (double)pieces;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, voxels * 4, "the points' numbers", &job->source));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, job->field->value_count * 12, "the points that are passed on",
                        &job->points));
    job->pieces = pieces;
    /* Points before sweeps, as any centre may pass on any of them. */
    BVXI_TRY(bvxi_each_long(ctx, "dense field", 0.1, 0.2, job->pieces, each, propagate_start, job));
    BVXI_TRY(propagate_all(ctx, job));
    job->pieces = pieces;
    return bvxi_each_long(ctx, "dense field", 0.7, 1.0, job->pieces, each, propagate_finish, job);
}

bvx_status bvxi_field_propagate(bvx_context *ctx, const char *function, const bvx_field *field,
                                const bvx_mesh_view *mesh, int32_t vectors, float *values)
{
    uint64_t const voxels = bvxi_grid_rows(&field->band) * (uint64_t)field->band.size[0];
    propagate_job job = {.mesh = mesh, .values = values};
    double low[3], high[3];
    BVXI_TRY(bvxi_view_check(ctx, function, mesh));
    BVXI_TRY(bvxi_view_bounds(ctx, function, mesh, low, high));
    BVXI_TRY(check_sources(ctx, function, field, mesh));
    job.field = field;
    job.each = vectors ? 3 : 1;
    place_centres(low, high, &job);
    return propagate_steps(ctx, voxels, &job);
}
