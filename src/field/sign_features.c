/* sign_features.c - inside by what is closest, in the band and beyond it.
 *
 * In the band a centre's own closest feature decides. Beyond it signs are carried on (carry_signs.c), which
 * depends on all of the lattice; so where a window has centres beyond the band, the band of the whole lattice
 * is made, and the window holds its bits. A band of less than a voxel may have the surface at its very end,
 * so one of a voxel is made for the signs too. A lattice without any band lies on one side of the mesh, that
 * of its first centre. */
#include "field/signs.h"

#include <math.h>

static bvx_status sign_band(bvxi_call call, const bvxi_sides *sides, int32_t sign, bvx_grid *inside)
{
    return sign == BVX_SIGN_NORMAL ? bvxi_sign_normal(call, sides, inside)
                                   : bvxi_sign_pseudonormal(call, sides, inside);
}

static uint64_t grid_voxels(const bvx_grid *grid)
{
    return bvxi_grid_rows(grid) * (uint64_t)grid->size[0];
}

/* ---- a lattice without a band ---- */

static void set_every_voxel(bvx_grid *grid)
{
    uint64_t const rows = bvxi_grid_rows(grid);
    for (uint64_t r = 0; r < rows; r++)
        bvxi_set_run(grid->words + r * (uint64_t)grid->words_per_row, 0, grid->size[0]);
}

/* All of inside's window as the first centre of the lattice. */
static bvx_status sign_by_first_centre(bvxi_call call, const bvxi_nearest *nearest, const bvxi_sides *sides,
                                       int32_t sign, bvx_grid *inside)
{
    uint64_t word = 1, set = 0, first[2] = {0, 1};
    uint32_t triangle = 0;
    uint8_t feature = 0;
    bvx_grid one = {0}, its_side;
    bvxi_nearest_values values = {BVX_F32, NULL, NULL, NULL, NULL};
    bvxi_sides of_one;

    values.triangles = &triangle;
    values.features = &feature;
    one.lattice = inside->lattice;
    one.words = &word;
    one.word_capacity = 1;
    one.words_per_row = one.size[0] = one.size[1] = one.size[2] = 1;
    its_side = one;
    its_side.words = &set;
    of_one.mesh = sides->mesh;
    of_one.band = &one;
    of_one.first = first;
    of_one.triangles = &triangle;
    of_one.features = &feature;
    BVXI_TRY(bvxi_nearest_fill(bvxi_call_part(call, call.from, call.from), nearest, HUGE_VAL, &one, first,
                               &values));
    BVXI_TRY(sign_band(bvxi_call_part(call, call.from, call.from), &of_one, sign, &its_side));
    memset(inside->words, 0, (size_t)bvxi_grid_words(inside) * 8);
    if (set != 0) set_every_voxel(inside);
    return BVX_OK;
}

/* ---- a band over all of the lattice ---- */

/* The band of the whole lattice with its features, made for the signs only. */
typedef struct whole_band {
    bvx_grid band, inside; /* words in one block, one after the other */
    uint64_t *first;
    uint32_t *triangles;
    uint8_t *features;
    uint64_t values;
} whole_band;

static void whole_band_free(bvx_context *ctx, whole_band *w)
{
    bvxi_drop(ctx, w->features);
    bvxi_drop(ctx, w->triangles);
    bvxi_drop(ctx, w->first);
    bvxi_drop(ctx, w->band.words);
}

static bvx_status whole_band_measure(bvxi_call call, const bvxi_nearest *nearest, double width, whole_band *w)
{
    double const middle = call.from + (call.to - call.from) * 0.4;
    uint64_t const rows = bvxi_grid_rows(&w->band);
    bvxi_nearest_values values = {BVX_F32, NULL, NULL, NULL, NULL};

    BVXI_TRY(bvxi_alloc_zero(call.ctx, BVXI_SCRATCH, bvxi_grid_words(&w->band) * 16, "the lattice's band",
                             &w->band.words));
    w->inside.words = w->band.words + bvxi_grid_words(&w->band);
    BVXI_TRY(bvxi_alloc(call.ctx, BVXI_SCRATCH, (rows + 1) * 8, "the band's rows", &w->first));
    BVXI_TRY(bvxi_nearest_band(bvxi_call_part(call, call.from, middle), nearest, width, &w->band, w->first));
    w->values = w->first[rows];
    BVXI_TRY(bvxi_alloc(call.ctx, BVXI_SCRATCH, w->values * 4, "the band's triangles", &w->triangles));
    BVXI_TRY(bvxi_alloc(call.ctx, BVXI_SCRATCH, w->values, "the band's features", &w->features));
    values.triangles = w->triangles;
    values.features = w->features;
    return bvxi_nearest_fill(bvxi_call_part(call, middle, call.to), nearest, HUGE_VAL, &w->band, w->first,
                             &values);
}

/* The bits of whole in the window of part. */
static void cut_window(const bvx_grid *whole, bvx_grid *part)
{
    int32_t const shift = part->low[0] & 63, column = part->low[0] >> 6;

    for (int32_t z = 0; z < part->size[2]; z++)
        for (int32_t y = 0; y < part->size[1]; y++) {
            uint64_t const row = (uint64_t)(z + part->low[2]) * (uint64_t)whole->size[1] +
                                 (uint64_t)(y + part->low[1]);
            const uint64_t *const from = whole->words + row * (uint64_t)whole->words_per_row;
            uint64_t *const to = part->words + ((uint64_t)z * (uint64_t)part->size[1] + (uint64_t)y) *
                                                   (uint64_t)part->words_per_row;
            for (int32_t k = 0; k < part->words_per_row; k++) {
                uint64_t w = from[column + k] >> shift;
                if (shift != 0 && column + k + 1 < whole->words_per_row)
                    w |= from[column + k + 1] << (64 - shift);
                to[k] = k + 1 == part->words_per_row ? w & bvxi_tail_mask(part->size[0]) : w;
            }
        }
}

static bvx_status sign_whole_band(bvxi_call call, const bvxi_nearest *nearest, const bvxi_sides *part,
                                  int32_t sign, whole_band *w, bvx_grid *inside)
{
    bvxi_sides sides;

    sides.mesh = part->mesh;
    sides.band = &w->band;
    sides.first = w->first;
    sides.triangles = w->triangles;
    sides.features = w->features;
    if (w->values == 0)
        return sign_by_first_centre(bvxi_call_part(call, call.from, call.from), nearest, part, sign, inside);
    BVXI_TRY(sign_band(call, &sides, sign, &w->inside));
    BVXI_TRY(bvxi_carry_signs(bvxi_call_part(call, call.to, call.to), &w->band, &w->inside));
    cut_window(&w->inside, inside);
    return BVX_OK;
}

static bvx_status sign_as_whole(bvxi_call call, const bvxi_nearest *nearest, double width,
                                const bvxi_sides *part, int32_t sign, bvx_grid *inside)
{
    double const middle = call.from + (call.to - call.from) * 0.7;
    whole_band w = {0};
    bvx_status status;

    w.band.lattice = inside->lattice;
    memcpy(w.band.size, inside->lattice.dims, sizeof w.band.size);
    w.band.words_per_row = bvxi_row_words(w.band.size[0]);
    w.band.word_capacity = bvxi_grid_words(&w.band);
    w.inside = w.band;
    status = whole_band_measure(bvxi_call_part(call, call.from, middle), nearest, width, &w);
    if (status == BVX_OK)
        status = sign_whole_band(bvxi_call_part(call, middle, call.to), nearest, part, sign, &w, inside);
    whole_band_free(call.ctx, &w);
    return status;
}

bvx_status bvxi_sign_features(bvxi_call call, const bvxi_nearest *nearest, double width,
                              const bvxi_sides *sides, int32_t sign, bvx_grid *inside)
{
    uint64_t const values = sides->first[bvxi_grid_rows(sides->band)];
    int const whole = memcmp(inside->size, inside->lattice.dims, sizeof inside->size) == 0;
    double const voxel = bvxi_largest_spacing(&inside->lattice), enough = width < voxel ? voxel : width;

    if (values == grid_voxels(inside)) return sign_band(call, sides, sign, inside);
    if (!whole || width < voxel) return sign_as_whole(call, nearest, enough, sides, sign, inside);
    if (values == 0)
        return sign_by_first_centre(bvxi_call_part(call, call.from, call.from), nearest, sides, sign, inside);
    BVXI_TRY(sign_band(call, sides, sign, inside));
    return bvxi_carry_signs(bvxi_call_part(call, call.to, call.to), sides->band, inside);
}
