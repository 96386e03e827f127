/* field.c - distance fields freed, checked and read.
 *
 * The index of a value is that of its row's first one plus the set bits before it in the row, so no index of
 * the values is kept. Guarantee: what bvxi_field_check has passed can be read without further checks. */
#include "field/room.h"
#include "grid/sparse.h"
#include "mesh/view.h"

void bvx_field_free(bvx_context *context, bvx_field *field)
{
    if (context == NULL || field == NULL) return;
    /* Sizes follow from the counts, so arrays go before the grids that hold them. */
    uint64_t const number_bytes = field->value_type == BVX_F64 ? 8 : 4;
    bvxi_free(context, field->features, field->value_count);
    bvxi_free(context, field->triangles, field->value_count * 4);
    bvxi_free(context, field->vectors, field->value_count * 3 * number_bytes);
    bvxi_free(context, field->distances, field->value_count * number_bytes);
    uint64_t const rows = field->band.words != NULL ? bvxi_grid_rows(&field->band) : 0;
    bvxi_free(context, field->row_values, (rows + 1) * 8);
    bvx_grid_free(context, &field->inside);
    bvx_grid_free(context, &field->band);
    memset(field, 0, sizeof *field);
}

static bvx_status check_field_inside(bvx_context *ctx, const char *function, const bvx_field *field)
{
    /* Without signs no grid of inside centres is needed. */
    if (field->inside.words == NULL) {
        if (field->sign == BVX_FILL_NONE) return BVX_OK;
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                             "%s: field.inside has no words, but field.sign is %d", function,
                             (int64_t)field->sign);
    }
    BVXI_TRY(bvxi_grid_check(ctx, function, &field->inside));
    BVXI_TRY(bvxi_grid_check_past(ctx, function, &field->inside));
    /* Bits are looked up by the same place in both grids. */
    if (!bvxi_lattice_equal(&field->band.lattice, &field->inside.lattice) ||
        memcmp(field->band.low, field->inside.low, sizeof field->band.low) != 0 ||
        memcmp(field->band.size, field->inside.size, sizeof field->band.size) != 0)
        return bvxi_fail(ctx, BVX_ERR_LATTICE,
                         "%s: field.band and field.inside are not of one lattice and window", function);
    return BVX_OK;
}

bvx_status bvxi_field_check(bvx_context *ctx, const char *function, const bvx_field *field)
{
    if (field == NULL) return bvxi_fail_null(ctx, function, "field");
    for (uint64_t i = 0; i < 4; i++)
        if (field->reserved[i] != 0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RESERVED,
                                 "%s: field.reserved[%u] must be 0", function, i);

    /* Emptiness first, so that the message names the cause and not what follows from it. */
    if (field->row_values == NULL || field->distances == NULL)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL, "%s: the field is empty: it has no %s",
                             function, field->row_values == NULL ? "row_values" : "distances");
    if (field->value_type != BVX_F32 && field->value_type != BVX_F64)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: field.value_type is %d, not BVX_F32 (1) or BVX_F64 (2)", function,
                             (int64_t)field->value_type);
    if (field->sign < BVX_FILL_PARITY || field->sign > BVX_FILL_NONE)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: field.sign is %d; BVX_FILL_PARITY (1) to BVX_FILL_NONE (9) are possible",
                             function, (int64_t)field->sign);
    if (!(field->half_width > 0.0))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                             "%s: field.half_width is %g; it must be above 0", function, field->half_width);

    /* Grids before rows: rows are counted in the band's words. */
    BVXI_TRY(bvxi_grid_check(ctx, function, &field->band));
    BVXI_TRY(bvxi_grid_check_past(ctx, function, &field->band));
    BVXI_TRY(check_field_inside(ctx, function, field));
    return bvxi_sparse_check(ctx, function, field);
}

bvx_status bvxi_field_check_vectors(bvx_context *ctx, const char *function, const bvx_field *field,
                                    int32_t vectors)
{
    if (vectors != 0 && vectors != 1)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: vectors is %d, not 0 or 1",
                             function, (int64_t)vectors);
    if (vectors == 1 && field->vectors == NULL)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: the field has no vectors (it was measured with no_vectors)", function);
    return BVX_OK;
}

uint64_t bvx_field_value(const bvx_field *field, int32_t x, int32_t y, int32_t z)
{
    /* The field may be any, so that a wrong place is no value, and no fault. */
    if (field == NULL || field->row_values == NULL || field->band.words == NULL) return UINT64_MAX;
    const bvx_grid *const g = &field->band;
    if (x < 0 || y < 0 || z < 0 || x >= g->size[0] || y >= g->size[1] || z >= g->size[2]) return UINT64_MAX;
    uint64_t const row = (uint64_t)z * (uint64_t)g->size[1] + (uint64_t)y;
    /* A grid that contradicts itself holds no row to be read. */
    if (g->words_per_row != bvxi_row_words(g->size[0]) ||
        row >= g->word_capacity / (uint64_t)g->words_per_row)
        return UINT64_MAX;
    const uint64_t *const words = g->words + row * (uint64_t)g->words_per_row;
    uint64_t n = field->row_values[row];
    if ((words[x >> 6] >> (x & 63) & 1) == 0) return UINT64_MAX;
    /* Its number: the row's first one, and the bits before it. */
    for (int32_t k = 0; k < x >> 6; k++) n += bvxi_popcount(words[k]);
    return n + bvxi_popcount(words[x >> 6] & ((UINT64_C(1) << (x & 63)) - 1));
}

double bvxi_field_scale(const bvx_grid *g, const double low[3], const double high[3])
{
    double first[3], last[3], least[3], most[3];
    bvxi_field_centre(g, 0, 0, 0, first);
    bvxi_field_centre(g, g->size[0] - 1, g->size[1] - 1, g->size[2] - 1, last);
    /* Centres may lie outside the mesh's bounds. */
    for (int a = 0; a < 3; a++) {
        least[a] = first[a] < low[a] ? first[a] : low[a];
        most[a] = last[a] > high[a] ? last[a] : high[a];
    }
    return bvxi_unit_scale(least, most);
}

void bvxi_field_word(const bvx_field *field, uint64_t row, int32_t word, int32_t vectors, uint64_t *next,
                     double *numbers)
{
    const bvx_grid *const g = &field->band;
    uint64_t const at = row * (uint64_t)g->words_per_row + (uint64_t)word;
    uint64_t const band = g->words[at], inside = field->inside.words != NULL ? field->inside.words[at] : 0;
    int32_t const left = g->size[0] - word * BVXI_WORD_BITS;
    int32_t const n = left < BVXI_WORD_BITS ? left : BVXI_WORD_BITS;

    for (int32_t i = 0; i < n; i++) {
        int const valued = (int)(band >> i & 1);
        if (vectors) {
            for (uint64_t a = 0; a < 3; a++)
                numbers[3 * (size_t)i + a] = valued ? bvxi_field_number(field, field->vectors, 3 * *next + a)
                                                    : 0.0;
        } else if (valued) {
            /* Beyond the band the half-width stands, with the sign alone. */
            numbers[i] = bvxi_field_number(field, field->distances, *next);
        } else {
            numbers[i] = inside >> i & 1 ? -field->half_width : field->half_width;
        }
        *next += (uint64_t)valued;
    }
}
