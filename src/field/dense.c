/* dense.c - a sparse field as an array with a number, or three, for every centre: bvx_field_dense.
 *
 * Beyond the band stands the half-width, a lower bound of the distance. Rows are written by themselves, so
 * threads do not show. */
#include "field/room.h"

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

static bvx_status run_field_dense(bvx_context *context, const bvx_field *field, int32_t vectors,
                                  float *values)
{
    static const char function[] = "bvx_field_dense";
    dense_job job = {.field = field, .values = values, .vectors = vectors};

    if (values == NULL) return bvxi_fail_null(context, function, "values");
    BVXI_TRY(bvxi_field_check(context, function, field));
    BVXI_TRY(bvxi_field_check_vectors(context, function, field, vectors));
    double const centres = (double)bvxi_grid_rows(&field->band) * (double)field->band.size[0];
    job.pieces = bvxi_piece_count(bvxi_grid_rows(&field->band),
                                  1 + DENSE_GRAIN / (uint64_t)field->band.size[0]);
    return bvxi_each_long(context, "dense field", 0.0, 1.0, job.pieces,
                          DENSE_TIME * centres / (double)job.pieces, write_dense_rows, &job);
}

bvx_status bvx_field_dense(bvx_context *context, const bvx_field *field, int32_t vectors, float *values)
{
    return BVXI_CALL(context, run_field_dense(context, field, vectors, values));
}
