/* dense.c - a field as an array with a number, or three, for every centre.
 *
 * Rows are written by themselves, so threads do not show. Where the band has no value the field's own
 * half-width stands, which is a lower bound of the distance; propagate.c gives upper bounds instead. */
#include "field/room.h"

enum { DENSE_GRAIN = 1 << 15 /* centres of the smallest task */ };

typedef struct dense_job {
    const bvx_field *field;
    float *values;
    int32_t vectors, pieces;
} dense_job;

static void write_dense_rows(void *user, int32_t piece, int32_t worker)
{
    const dense_job *const job = user;
    const bvx_grid *const g = &job->field->band;
    uint64_t const each = job->vectors ? 3 : 1;
    double numbers[3 * BVXI_WORD_BITS];
    uint64_t row, end;

    (void)worker;
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

    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (values == NULL) return bvxi_fail_null(context, function, "values");
    BVXI_TRY(bvxi_field_check(context, function, field));
    BVXI_TRY(bvxi_field_check_vectors(context, function, field, vectors));
    BVXI_TRY(check_far(context, function, field, mesh, far_rule));
    job.field = field;
    job.values = values;
    job.vectors = vectors;
    job.pieces = bvxi_piece_count(bvxi_grid_rows(&field->band),
                                  1 + DENSE_GRAIN / (uint64_t)field->band.size[0]);
    BVXI_TRY(bvxi_parallel(context, "dense field", 0.0, far_rule == BVX_FAR_CONSTANT ? 1.0 : 0.1, job.pieces,
                           write_dense_rows, &job));
    return far_rule == BVX_FAR_CONSTANT
               ? BVX_OK
               : bvxi_field_propagate(context, function, field, mesh, vectors, values);
}

bvx_status bvx_field_dense(bvx_context *context, const bvx_field *field, const bvx_mesh_view *mesh,
                           int32_t far_rule, int32_t vectors, float *values)
{
    return BVXI_CALL(context, run_field_dense(context, field, mesh, far_rule, vectors, values));
}
