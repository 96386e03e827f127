/* measure.c - a band of distances around a mesh: bvx_measure_field.
 *
 * Source: Wang, Wu. Mesh model repair based on vector field distance function. 2013 (the vector to the
 * closest point, kept for the cells near the surface).
 *
 * Everything is checked first. Then the centres near the mesh are found and counted (nearest.h), so the
 * arrays have their exact sizes; then values are filled in by rank, the sign rule sets the grid of inside
 * centres (signs.h), and distances of centres inside become negative. */
#include "field/signs.h"
#include "mesh/view.h"

#include <math.h>

static const char measure_name[] = "bvx_measure_field";
static const char measure_stage[] = "field";

enum { MEASURE_GRAIN = 1 << 14 /* values of the smallest task, about */ };

typedef struct measure_job {
    const bvx_mesh_view *mesh;
    bvx_field_options o;
    bvx_window window;
    bvxi_nearest *nearest;
    bvx_field field;
    uint32_t *triangles; /* the field's, or made for the sign only */
} measure_job;

static const bvxi_option measure_rows[] = {
    BVXI_OR(bvx_field_options, half_width, ABOVE, 3.0, 0.0, 0.0),
    BVXI_AMONG(bvx_field_options, sign, BVX_FILLS_OF_FIELD),
    BVXI_OR(bvx_field_options, value_type, CHOICE, BVX_F32, BVX_F32, BVX_F64),
    BVXI_SWITCH(bvx_field_options, no_vectors),
    BVXI_SWITCH(bvx_field_options, features),
    BVXI_RESERVED(bvx_field_options, reserved),
};

/* The half-width in the world; infinity where doubles do not hold it. */
static double measure_width(const bvx_lattice *l, double half_width)
{
    return half_width * bvxi_largest_spacing(l);
}

/* The field's numbers hold the distances. That centres are finite is asked where the search tree is made. */
static bvx_status check_measure_range(bvx_context *ctx, const measure_job *job, const bvx_lattice *l)
{
    static const char axis_name[3][2] = {"x", "y", "z"};
    double const width = measure_width(l, job->o.half_width);

    for (int a = 0; a < 3; a++) {
        /* Squares of floats' distances neither overflow nor vanish. */
        if (job->o.value_type == BVX_F32 && (l->spacing[a] > 0x1p100 || l->spacing[a] < 0x1p-100))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                 "%s: floats do not hold distances of voxels of %g along %s: take BVX_F64",
                                 measure_name, l->spacing[a], axis_name[a]);
    }
    /* A product with the spacing may round to 0. */
    if (!(width > 0.0))
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_RANGE,
                             "%s: half_width is %g voxels, which is nothing in the world's unit",
                             measure_name, job->o.half_width);

    /* No distance within width, from a finite centre to the mesh, is beyond what numbers of the field
     * hold. */
    double const most = job->o.value_type == BVX_F32 ? 0x1p125 : 0x1p1000;
    double low[3], high[3];

    /* Nothing in a band is further than its width, so only unbounded fields have to look at the mesh. */
    if (width < most) return BVX_OK;
    BVXI_TRY(bvxi_view_bounds(ctx, measure_name, job->mesh, low, high));
    for (int a = 0; a < 3; a++) {
        double const first = l->origin[a], last = first + (double)l->dims[a] * l->spacing[a];
        double const below = first < low[a] ? first : low[a], above = last > high[a] ? last : high[a];
        if (!(above - below < most))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                 "%s: distances of up to %g do not fit the field's numbers%s", measure_name,
                                 above - below, job->o.value_type == BVX_F32 ? ": take BVX_F64" : "");
    }
    return BVX_OK;
}

static bvx_status make_band(bvx_context *ctx, const bvx_lattice *lattice, measure_job *job)
{
    bvx_field *const f = &job->field;
    BVXI_TRY(bvx_grid_create(ctx, lattice, &job->window, &f->band));
    uint64_t const rows = bvxi_grid_rows(&f->band);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, (rows + 1) * 8, "the field's rows", &f->row_values));
    /* Infinity less itself is NaN: the test for a finite width without a library call. */
    if (f->half_width - f->half_width == 0.0)
        return bvxi_nearest_band(bvxi_call_of(ctx, NULL, measure_stage, 0.15, 0.8), job->nearest,
                                 f->half_width, &f->band, f->row_values);
    /* Every centre. */
    for (uint64_t r = 0; r < rows; r++)
        bvxi_set_run(f->band.words + r * (uint64_t)f->band.words_per_row, 0, f->band.size[0]);
    for (uint64_t r = 0; r <= rows; r++) f->row_values[r] = r * (uint64_t)f->band.size[0];
    return BVX_OK;
}

/* The field's values with triangles, which may be the job's alone. */
static bvxi_sparse measured_values(const measure_job *job)
{
    bvxi_sparse values = bvxi_sparse_of_field(&job->field);
    values.triangles = job->triangles;
    return values;
}

static bvx_status make_inside(bvx_context *ctx, const bvx_lattice *lattice, measure_job *job)
{
    bvx_field *const f = &job->field;
    bvxi_sparse const values = measured_values(job);
    if (f->sign == BVX_FILL_NONE) return BVX_OK;
    BVXI_TRY(bvxi_grid_open(ctx, measure_name, lattice, &job->window, &f->inside));
    if (f->sign == BVX_FILL_NORMAL)
        return bvxi_sign_normal(bvxi_call_of(ctx, measure_name, measure_stage, 0.9, 0.97), job->nearest,
                                f->half_width, job->mesh, &values, &f->inside);

    /* AUTO, PARITY, NONZERO, WINDING, VOTE: the solid by that rule, at the same centres, so a field and a solid of
     * one rule never disagree. Only the choice is of interest: what voxels lose of the mesh's walls and volume
     * costs a third of a narrow field, and a field says neither. */
    bvx_solid_report report = {.fill = f->sign};
    bvx_voxelize_options o = {.struct_size = sizeof o,
                              .fill = f->sign,
                              .report = f->sign == BVX_FILL_AUTO ? &report : NULL,
                              .check_thin = BVX_CHECK_NEVER};
    memcpy(o.window.low, f->inside.low, sizeof o.window.low);
    memcpy(o.window.size, f->inside.size, sizeof o.window.size);
    BVXI_TRY(bvx_voxelize_solid(ctx, job->mesh, &f->inside.lattice, &o, &f->inside));
    f->sign = report.fill;
    return BVX_OK;
}

static void negate_rows(void *user, uint64_t row, uint64_t end)
{
    const bvx_field *const f = user;
    uint64_t const words = (uint64_t)f->band.words_per_row;

    /* Bits and values in the same order, so the rank is just counted along. */
    for (; row < end; row++) {
        uint64_t n = f->row_values[row];
        for (uint64_t at = row * words; at < (row + 1) * words; at++)
            for (uint64_t left = f->band.words[at]; left != 0; left &= left - 1, n++) {
                if ((f->inside.words[at] & left & (0 - left)) == 0) continue;
                if (f->value_type == BVX_F32) ((float *)f->distances)[n] = -((float *)f->distances)[n];
                else ((double *)f->distances)[n] = -((double *)f->distances)[n];
            }
    }
}

static bvx_status measure_distances_of(bvx_context *ctx, const bvx_lattice *lattice, measure_job *job)
{
    BVXI_TRY(bvxi_nearest_open(bvxi_call_of(ctx, measure_name, measure_stage, 0.0, 0.15), job->mesh, lattice,
                               &job->nearest));
    BVXI_TRY(make_band(ctx, lattice, job));

    bvx_field *const f = &job->field;
    uint64_t const n = f->row_values[bvxi_grid_rows(&f->band)];
    uint64_t const number_bytes = f->value_type == BVX_F32 ? 4 : 8;

    /* Before any array is made: a failure on the way frees them by this count. */
    f->value_count = n;
    /* Sizes of arrays of three doubles for each value have to fit. */
    if (n > UINT64_MAX / 24)
        return bvxi_fail(ctx, BVX_ERR_BUDGET, "%s: %u values are beyond 64 bits", measure_name, n);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, n * number_bytes, "the field's distances", &f->distances));
    if (!job->o.no_vectors)
        BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, n * 3 * number_bytes, "the field's vectors", &f->vectors));
    /* Signs by normals need triangles even when the caller does not: then they are scratch. */
    if (job->o.features) {
        BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, n * 4, "the field's triangles", &f->triangles));
        job->triangles = f->triangles;
        BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, n, "the field's features", &f->features));
    } else if (f->sign == BVX_FILL_NORMAL) {
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 4, "the field's triangles", &job->triangles));
    }
    bvxi_sparse const values = measured_values(job);
    return bvxi_nearest_fill(bvxi_call_of(ctx, NULL, measure_stage, 0.8, 0.9), job->nearest, HUGE_VAL,
                             &values);
}

static bvx_status measure_steps(bvx_context *ctx, const bvx_lattice *lattice, measure_job *job)
{
    bvx_field *const f = &job->field;
    f->value_type = job->o.value_type;
    f->sign = job->o.sign;
    f->half_width = measure_width(lattice, job->o.half_width);
    /* A solid takes next to nothing of a sound mesh, and most of the time of one with holes. */
    int const solid = f->sign != BVX_FILL_NONE && f->sign != BVX_FILL_NORMAL;
    BVXI_TRY(bvxi_nearest_check(ctx, measure_name, job->mesh, lattice));
    if (solid) BVXI_TRY(BVXI_SHARE(ctx, 0.0, 0.2, make_inside(ctx, lattice, job)));
    BVXI_TRY(BVXI_SHARE(ctx, solid ? 0.2 : 0.0, 1.0, measure_distances_of(ctx, lattice, job)));
    if (!solid) BVXI_TRY(make_inside(ctx, lattice, job));
    if (f->inside.words == NULL) return BVX_OK;
    uint64_t const rows = bvxi_grid_rows(&f->band), grain = 1 + MEASURE_GRAIN / (1 + f->value_count / rows);
    return BVXI_SHARE(ctx, 0.97, 1.0, bvxi_for(ctx, measure_stage, rows, grain, negate_rows, f));
}

static bvx_status run_measure_field(bvx_context *context, const bvx_mesh_view *mesh,
                                    const bvx_lattice *lattice, const bvx_field_options *options,
                                    bvx_field *field)
{
    measure_job job = {0};

    if (field == NULL) return bvxi_fail_null(context, measure_name, "field");
    /* The library's own arrays go when another one is made. */
    if (field->band.owned != 1 &&
        (field->band.words != NULL || field->inside.words != NULL || field->row_values != NULL ||
         field->vectors != NULL || field->distances != NULL || field->triangles != NULL ||
         field->features != NULL))
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_NOT_EMPTY,
                             "%s: field brings arrays, which are not used; zero it first", measure_name);
    BVXI_TRY(bvxi_take_options(context, measure_name, options, &job.o, sizeof job.o));
    BVXI_TRY(bvxi_check_options(context, measure_name, &job.o, BVXI_OPTIONS(measure_rows)));
    BVXI_TRY(bvxi_view_check(context, measure_name, mesh));
    if (mesh->triangle_count == 0)
        return bvxi_fail(context, BVX_ERR_EMPTY, "%s: the mesh has no triangles", measure_name);
    BVXI_TRY(bvxi_lattice_check(context, measure_name, lattice));
    BVXI_TRY(bvxi_window_take(context, measure_name, lattice, &job.o.window, &job.window));
    job.mesh = mesh;
    BVXI_TRY(check_measure_range(context, &job, lattice));

    bvx_status const status = measure_steps(context, lattice, &job);
    if (status != BVX_OK) {
        bvx_field_free(context, &job.field);
        return status;
    }
    bvx_field_free(context, field);
    *field = job.field;
    return BVX_OK;
}

bvx_status bvx_measure_field(bvx_context *context, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                             const bvx_field_options *options, bvx_field *field)
{
    return BVXI_CALL(context, run_measure_field(context, mesh, lattice, options, field));
}
