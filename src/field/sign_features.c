/* sign_features.c - inside by what is closest, in the band and beyond it.
 *
 * In the band a centre's own closest feature decides. Beyond it signs are carried on (carry_signs.c), which
 * depends on all of the lattice; so where a window has centres beyond the band, the band of the whole lattice
 * is made, and the window holds its bits. A band of less than a voxel may have the surface at its very end,
 * so one of a voxel is made for the signs too. A lattice without any band lies on one side of the mesh, that
 * of its first centre. */
#include "field/signs.h"

#include <math.h>

static bvx_status sign_band(bvxi_call call, const bvx_mesh_view *mesh, const bvxi_sparse *band, int32_t sign,
                            bvx_grid *inside)
{
    return sign == BVX_FILL_NORMAL ? bvxi_sign_normal(call, mesh, band, inside)
                                   : bvxi_sign_pseudonormal(call, mesh, band, inside);
}

/* All of inside's window as the first centre of the lattice. */
static bvx_status sign_by_first_centre(bvxi_call call, const bvxi_nearest *nearest, const bvx_mesh_view *mesh,
                                       int32_t sign, bvx_grid *inside)
{
    bvxi_call const at_once = bvxi_call_part(call, call.from, call.from);
    uint64_t word = 1, set = 0, first[2] = {0, 1};
    uint32_t triangle = 0;
    uint8_t feature = 0;
    bvxi_sparse one = {
        .first = first, .count = 1, .value_type = BVX_F32, .triangles = &triangle, .features = &feature};

    one.where.lattice = inside->lattice;
    one.where.words = &word;
    one.where.word_capacity = 1;
    one.where.words_per_row = one.where.size[0] = one.where.size[1] = one.where.size[2] = 1;
    bvx_grid its_side = one.where;
    its_side.words = &set;
    BVXI_TRY(bvxi_nearest_fill(at_once, nearest, HUGE_VAL, &one));
    BVXI_TRY(sign_band(at_once, mesh, &one, sign, &its_side));
    memset(inside->words, 0, (size_t)bvxi_grid_words(inside) * 8);
    if (set != 0) {
        uint64_t const rows = bvxi_grid_rows(inside);
        for (uint64_t r = 0; r < rows; r++)
            bvxi_set_run(inside->words + r * (uint64_t)inside->words_per_row, 0, inside->size[0]);
    }
    return BVX_OK;
}

/* The band of the whole lattice with its features, made for the signs only; its words are zero before. */
static bvx_status measure_whole_band(bvxi_call call, const bvxi_nearest *nearest, double width,
                                     bvxi_sparse *band)
{
    double const middle = call.from + (call.to - call.from) * 0.4;
    uint64_t const rows = bvxi_grid_rows(&band->where);
    BVXI_TRY(bvxi_alloc(call.ctx, BVXI_SCRATCH, (rows + 1) * 8, "the band's rows", &band->first));
    BVXI_TRY(bvxi_nearest_band(bvxi_call_part(call, call.from, middle), nearest, width, &band->where,
                               band->first));
    band->count = band->first[rows];
    BVXI_TRY(bvxi_sparse_columns(call.ctx, band, BVX_F32, BVXI_TRIANGLES | BVXI_FEATURES));
    return bvxi_nearest_fill(bvxi_call_part(call, middle, call.to), nearest, HUGE_VAL, band);
}

static bvx_status sign_whole_band(bvxi_call call, const bvx_mesh_view *mesh, const bvxi_sparse *band,
                                  int32_t sign, bvx_grid *inside)
{
    bvx_grid whole = band->where;
    BVXI_TRY(bvxi_alloc_zero(call.ctx, BVXI_SCRATCH, bvxi_grid_words(&whole) * 8, "the lattice's inside",
                             &whole.words));
    BVXI_TRY(sign_band(call, mesh, band, sign, &whole));
    BVXI_TRY(bvxi_carry_signs(bvxi_call_part(call, call.to, call.to), &band->where, &whole));

    /* The bits of whole in the window of part. */
    int32_t const shift = inside->low[0] & 63, column = inside->low[0] >> 6;

    for (int32_t z = 0; z < inside->size[2]; z++)
        for (int32_t y = 0; y < inside->size[1]; y++) {
            const uint64_t *const from = bvxi_grid_row(&whole, y + inside->low[1], z + inside->low[2]);
            uint64_t *const to = bvxi_grid_row(inside, y, z);

            /* The window need not begin at a word: each of its words comes from two. */
            for (int32_t k = 0; k < inside->words_per_row; k++) {
                uint64_t w = from[column + k] >> shift;
                if (shift != 0 && column + k + 1 < whole.words_per_row)
                    w |= from[column + k + 1] << (64 - shift);
                to[k] = k + 1 == inside->words_per_row ? w & bvxi_tail_mask(inside->size[0]) : w;
            }
        }

    bvxi_drop(call.ctx, whole.words);
    return BVX_OK;
}

static bvx_status sign_as_whole(bvxi_call call, const bvxi_nearest *nearest, double width,
                                const bvx_mesh_view *mesh, int32_t sign, bvx_grid *inside)
{
    double const middle = call.from + (call.to - call.from) * 0.7;
    bvx_grid shape = {.lattice = inside->lattice};
    bvxi_sparse band;

    memcpy(shape.size, inside->lattice.dims, sizeof shape.size);
    shape.words_per_row = bvxi_row_words(shape.size[0]);
    shape.word_capacity = bvxi_grid_words(&shape);
    BVXI_TRY(bvxi_sparse_open(call.ctx, &shape, &band));
    memset(band.where.words, 0, (size_t)bvxi_grid_words(&shape) * 8);
    BVXI_TRY(measure_whole_band(bvxi_call_part(call, call.from, middle), nearest, width, &band));
    BVXI_TRY(band.count == 0
                 ? sign_by_first_centre(bvxi_call_part(call, middle, middle), nearest, mesh, sign, inside)
                 : sign_whole_band(bvxi_call_part(call, middle, call.to), mesh, &band, sign, inside));
    bvxi_sparse_close(call.ctx, &band);
    return BVX_OK;
}

bvx_status bvxi_sign_features(bvxi_call call, const bvxi_nearest *nearest, double width,
                              const bvx_mesh_view *mesh, const bvxi_sparse *band, int32_t sign,
                              bvx_grid *inside)
{
    int const whole = bvxi_grid_is_whole(inside);
    double const voxel = bvxi_largest_spacing(&inside->lattice), enough = width < voxel ? voxel : width;
    if (band->count == bvxi_grid_rows(inside) * (uint64_t)inside->size[0])
        return sign_band(call, mesh, band, sign, inside);
    if (!whole || width < voxel) return sign_as_whole(call, nearest, enough, mesh, sign, inside);
    if (band->count == 0)
        return sign_by_first_centre(bvxi_call_part(call, call.from, call.from), nearest, mesh, sign, inside);
    BVXI_TRY(sign_band(call, mesh, band, sign, inside));
    return bvxi_carry_signs(bvxi_call_part(call, call.to, call.to), &band->where, inside);
}
