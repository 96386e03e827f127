/* sample_bits.c - arrays of numbers to rows of bits by any rule.
 *
 * Where x runs fastest, a row of samples is a row of bits. Where another axis does (NumPy's C order), tiles
 * of TILE_X by TILE_F voxels are packed along that axis, so that the array is read in runs, turned by
 * transposing 64 by 64 bits (Warren. Hacker's Delight. 2003, section 7-3), and written in rows. Guarantee: a
 * task writes rows or tiles of its own; which thread runs it shows nowhere. */
#include "volume/sample_bits.h"

enum {
    TILE_X_WORDS = 8,
    TILE_F_WORDS = 4,    /* 512 by 256 voxels: 16 KiB of turned rows, 2 KiB of runs */
    PACK_GRAIN = 1 << 16 /* samples of the smallest task */
};

static uint64_t stride_size(int64_t stride)
{
    return stride < 0 ? 0 - (uint64_t)stride : (uint64_t)stride;
}

/* Tiles along the fastest axis. */
static int32_t tiles_along(const bvxi_sample_walk *w)
{
    return (w->grid->size[w->axis] + 64 * TILE_F_WORDS - 1) / (64 * TILE_F_WORDS);
}

void bvxi_sample_walk_plan(bvxi_sample_walk *w)
{
    const int32_t *const n = w->grid->size;
    uint64_t run, runs;

    w->axis = 0;
    for (int32_t a = 1; a < 3; a++)
        if (n[a] > 1 && stride_size(w->stride[a]) < stride_size(w->stride[w->axis])) w->axis = a;
    if (n[0] == 1) w->axis = 0;
    run = (uint64_t)n[w->axis];
    runs = w->axis == 0 ? bvxi_grid_rows(w->grid) : (uint64_t)n[0] * (uint64_t)n[3 - w->axis];
    w->pieces = bvxi_piece_count(runs, 1 + PACK_GRAIN / run);
}

static void *piece_tally(const bvxi_sample_walk *w, int32_t piece)
{
    return w->tallies == NULL ? NULL : (uint8_t *)w->tallies + (size_t)piece * w->tally_size;
}

static const uint8_t *sample_at(const bvxi_sample_walk *w, int64_t x, int64_t y, int64_t z)
{
    return w->first + (ptrdiff_t)(x * w->stride[0] + y * w->stride[1] + z * w->stride[2]);
}

/* ---- x fastest: rows ---- */

static void walk_rows(void *user, int32_t piece, int32_t worker)
{
    const bvxi_sample_walk *const w = user;
    bvx_grid *const g = w->grid;
    void *const tally = piece_tally(w, piece);
    uint64_t row, end;

    (void)worker;
    bvxi_piece(bvxi_grid_rows(g), w->pieces, piece, &row, &end);
    for (; row < end; row++)
        w->run(w->rule, tally,
               sample_at(w, 0, (int64_t)(row % (uint64_t)g->size[1]), (int64_t)(row / (uint64_t)g->size[1])),
               w->stride[0], g->size[0], g->words + row * (uint64_t)g->words_per_row);
}

/* ---- another axis f fastest: tiles of x and f in a plane of the third ---- */

/* Bit j of a[i] changes places with bit i of a[j]. */
static void turn_square(uint64_t a[64])
{
    uint64_t mask = UINT64_C(0x00000000ffffffff);

    for (int32_t j = 32; j != 0; j >>= 1, mask ^= mask << j)
        for (int32_t block = 0; block < 64; block += 2 * j)
            for (int32_t k = block; k < block + j; k++) {
                uint64_t const t = (a[k] >> j ^ a[k + j]) & mask;
                a[k] ^= t << j;
                a[k + j] ^= t;
            }
}

/* Up to 64 TILE_X_WORDS by 64 TILE_F_WORDS voxels from x0 and f0 on. */
static void walk_tile(const bvxi_sample_walk *w, void *tally, int32_t x0, int32_t f0, int32_t third)
{
    bvx_grid *const g = w->grid;
    int32_t const f = w->axis;
    uint64_t run[64][TILE_F_WORDS], square[64], turned[64 * TILE_F_WORDS][TILE_X_WORDS];
    int32_t const nf = g->size[f] - f0 < 64 * TILE_F_WORDS ? g->size[f] - f0 : 64 * TILE_F_WORDS;
    int32_t const nx = g->size[0] - x0 < 64 * TILE_X_WORDS ? g->size[0] - x0 : 64 * TILE_X_WORDS;
    int32_t const words_x = bvxi_row_words(nx), words_f = bvxi_row_words(nf);

    for (int32_t kx = 0; kx < words_x; kx++) {
        int32_t const n = nx - 64 * kx < 64 ? nx - 64 * kx : 64;
        for (int32_t i = 0; i < n; i++) {
            int64_t const x = (int64_t)x0 + 64 * kx + i;
            w->run(w->rule, tally, f == 2 ? sample_at(w, x, third, f0) : sample_at(w, x, f0, third),
                   w->stride[f], nf, run[i]);
        }
        for (int32_t kf = 0; kf < words_f; kf++) {
            for (int32_t i = 0; i < 64; i++) square[i] = i < n ? run[i][kf] : 0;
            turn_square(square);
            for (int32_t i = 0; i < 64; i++) turned[64 * kf + i][kx] = square[i];
        }
    }
    for (int32_t i = 0; i < nf; i++) {
        uint64_t const y = (uint64_t)(f == 2 ? third : f0 + i), z = (uint64_t)(f == 2 ? f0 + i : third);
        memcpy(g->words + (z * (uint64_t)g->size[1] + y) * (uint64_t)g->words_per_row + (x0 >> 6), turned[i],
               (size_t)words_x * 8);
    }
}

static void walk_tiles(void *user, int32_t piece, int32_t worker)
{
    const bvxi_sample_walk *const w = user;
    const bvx_grid *const g = w->grid;
    void *const tally = piece_tally(w, piece);
    uint64_t const tiles = (uint64_t)tiles_along(w);
    uint64_t tile, end;

    (void)worker;
    bvxi_piece(tiles * (uint64_t)g->size[3 - w->axis], w->pieces, piece, &tile, &end);
    for (; tile < end; tile++)
        for (int32_t x = 0; x < g->size[0]; x += 64 * TILE_X_WORDS)
            walk_tile(w, tally, x, (int32_t)(tile % tiles) * 64 * TILE_F_WORDS, (int32_t)(tile / tiles));
}

bvx_status bvxi_samples_to_bits(bvx_context *ctx, const char *stage, double from, double to,
                                bvxi_sample_walk *walk)
{
    return bvxi_parallel(ctx, stage, from, to, walk->pieces, walk->axis == 0 ? walk_rows : walk_tiles, walk);
}
