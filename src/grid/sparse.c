/* sparse.c - values on the set voxels of a grid: opened, ranked, given columns, closed.
 *
 * A row's first value and the set bits before one in its row say where that one's value stands, so neither
 * hash tables nor pointers between voxels are needed, and the order of values follows from the bits alone. */
#include "grid/sparse.h"

uint64_t bvxi_sparse_number(const bvx_grid *where, uint64_t *first)
{
    uint64_t const rows = bvxi_grid_rows(where), words = (uint64_t)where->words_per_row;
    uint64_t count = 0;
    for (uint64_t r = 0; r < rows; r++) {
        first[r] = count;
        for (uint64_t k = 0; k < words; k++) count += bvxi_popcount(where->words[r * words + k]);
    }
    first[rows] = count;
    return count;
}

bvx_status bvxi_sparse_open(bvx_context *ctx, const bvx_grid *like, bvxi_sparse *s)
{
    memset(s, 0, sizeof *s);
    s->where = *like;
    s->where.words = NULL;
    return BVXI_ARRAY(ctx, bvxi_grid_words(like), "the voxels with values", s->where.words);
}

bvx_status bvxi_sparse_rank(bvx_context *ctx, bvxi_sparse *s)
{
    uint64_t const rows = bvxi_grid_rows(&s->where);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, (rows + 1) * 8, "the rows of values", &s->first));
    s->count = bvxi_sparse_number(&s->where, s->first);
    return BVX_OK;
}

bvx_status bvxi_sparse_columns(bvx_context *ctx, bvxi_sparse *s, int32_t value_type, uint32_t columns)
{
    uint64_t const n = s->count, bytes = value_type == BVX_F32 ? 4 : 8;
    s->value_type = value_type;
    if ((columns & BVXI_VECTORS) != 0)
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 3 * bytes, "the vectors of voxels", &s->vectors));
    if ((columns & BVXI_DISTANCES) != 0)
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * bytes, "the distances of voxels", &s->distances));
    if ((columns & BVXI_TRIANGLES) != 0)
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 4, "the triangles of voxels", &s->triangles));
    return BVX_OK;
}

void bvxi_sparse_close(bvx_context *ctx, bvxi_sparse *s)
{
    bvxi_drop(ctx, s->triangles);
    bvxi_drop(ctx, s->distances);
    bvxi_drop(ctx, s->vectors);
    bvxi_drop(ctx, s->first);
    bvxi_drop(ctx, s->where.words);
    memset(s, 0, sizeof *s);
}

bvxi_sparse bvxi_sparse_of_field(const bvx_field *field)
{
    bvxi_sparse const s = {.where = field->band,
                           .first = field->row_values,
                           .count = field->value_count,
                           .value_type = field->value_type,
                           .vectors = field->vectors,
                           .distances = field->distances,
                           .triangles = field->triangles,
                           .features = field->features};
    return s;
}

bvx_status bvxi_sparse_check(bvx_context *ctx, const char *function, const bvx_field *field)
{
    uint64_t const rows = bvxi_grid_rows(&field->band), words = (uint64_t)field->band.words_per_row;
    uint64_t next = 0;

    for (uint64_t r = 0; r < rows; r++) {
        if (field->row_values[r] != next)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_INDEX,
                                 "%s: field.row_values[%i] is %u, but the rows before hold %u values",
                                 function, r, field->row_values[r], next);
        for (uint64_t w = 0; w < words; w++) next += bvxi_popcount(field->band.words[r * words + w]);
    }
    if (field->row_values[rows] != next || field->value_count != next)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT,
                         "%s: field.value_count is %u and row_values ends at %u, but the band has %u voxels",
                         function, field->value_count, field->row_values[rows], next);
    return BVX_OK;
}
