/* sample_bits.c - arrays of numbers to rows of bits by any rule.
 *
 * Where x runs fastest, a row of samples is a row of bits. Where another axis f does (NumPy's C order), runs
 * along f are packed, 64 columns of x at a time, turned by transposing 64 by 64 bits (Warren. Hacker's
 * Delight. 2003, section 7-3) and written as words of rows. TILE_THIRD planes of the third axis are taken
 * together: where z is fastest, their runs lie side by side in the array, and so do their words in the grid.
 * Guarantee: a task writes rows or tiles of its own; which thread runs it shows nowhere. */
#include "volume/room.h"
#include "bits/bits.h"

enum {
    TILE_F_WORDS = 8,
    TILE_THIRD = 8, /* 512 of f, eight planes: 32 KiB of runs of 64 columns */
    FETCH_BYTES = 4096,
    PACK_GRAIN = 1 << 16 /* samples of the smallest task */
};

static uint64_t stride_size(int64_t stride)
{
    return stride < 0 ? 0 - (uint64_t)stride : (uint64_t)stride;
}

static int32_t tiles_along(const bvxi_sample_walk *w)
{
    return (w->grid->size[w->axis] + 64 * TILE_F_WORDS - 1) / (64 * TILE_F_WORDS);
}

void bvxi_sample_walk_plan(bvxi_sample_walk *w)
{
    const int32_t *const n = w->grid->size;
    /* The axis with the shortest way between samples; those of one sample do not count. */
    w->axis = 0;
    for (int32_t a = 1; a < 3; a++)
        if (n[a] > 1 && stride_size(w->stride[a]) < stride_size(w->stride[w->axis])) w->axis = a;
    /* With one column of x there is nothing to turn. */
    if (n[0] == 1) w->axis = 0;
    uint64_t const run = (uint64_t)n[w->axis];
    uint64_t const runs = w->axis == 0 ? bvxi_grid_rows(w->grid) : (uint64_t)n[0] * (uint64_t)n[3 - w->axis];
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

/* The first of n numbers that are read next: processors look ahead along one run, not from run to run. */
static void fetch(const uint8_t *first, int64_t stride, int32_t n)
{
    int64_t const end = stride * n < FETCH_BYTES ? stride * n : FETCH_BYTES;
    for (int64_t at = 0; at < end; at += 64) BVXI_PREFETCH(first + at);
}

static const uint8_t *row_at(const bvxi_sample_walk *w, uint64_t row)
{
    uint64_t const ny = (uint64_t)w->grid->size[1];
    return sample_at(w, 0, (int64_t)(row % ny), (int64_t)(row / ny));
}

static void walk_rows(void *user, int32_t piece, uint64_t row, uint64_t end)
{
    const bvxi_sample_walk *const w = user;
    bvx_grid *const g = w->grid;
    void *const tally = piece_tally(w, piece);
    for (; row < end; row++) {
        const uint8_t *const first = row_at(w, row);
        if (row + 1 < end) fetch(row_at(w, row + 1), w->stride[0], g->size[0]);
        /* The next row is fetched while this one is worked on. */
        w->run(w->rule, tally, first, w->stride[0], g->size[0], g->words + row * (uint64_t)g->words_per_row);
    }
}

/* All of x, nf voxels of f and nt planes of the third axis. */
typedef struct sample_tile {
    int32_t f, third;
    int32_t nf, nt;
} sample_tile;

static int32_t at_most(int32_t n, int32_t most)
{
    return n < most ? n : most;
}

/* 64 columns of x: bits along f of n of them, for each plane of the tile, from run to run in memory. */
static void read_runs(const bvxi_sample_walk *w, void *tally, const sample_tile *t, int32_t x, int32_t n,
                      uint64_t run[TILE_THIRD][64][TILE_F_WORDS])
{
    for (int32_t i = 0; i < n; i++)
        for (int32_t k = 0; k < t->nt; k++) {
            int32_t const y = w->axis == 2 ? t->third + k : t->f;
            int32_t const z = w->axis == 2 ? t->f : t->third + k;
            /* The next column's run, as the processor does not expect it. */
            if (x + i + 1 < w->grid->size[0])
                fetch(sample_at(w, (int64_t)x + i + 1, y, z), w->stride[w->axis], t->nf);
            w->run(w->rule, tally, sample_at(w, (int64_t)x + i, y, z), w->stride[w->axis], t->nf, run[k][i]);
        }
}

/* Word x / 64 of 64 rows of f from 64 kf on, in each plane of the tile, as rows are written. */
static void write_squares(const bvxi_sample_walk *w, const sample_tile *t, int32_t x, int32_t n, int32_t kf,
                          uint64_t run[TILE_THIRD][64][TILE_F_WORDS])
{
    const bvx_grid *const g = w->grid;
    uint64_t const wide = (uint64_t)g->words_per_row, deep = (uint64_t)g->size[1] * wide;
    uint64_t const along = w->axis == 2 ? deep : wide, across = w->axis == 2 ? wide : deep;
    int32_t const rows = at_most(t->nf - 64 * kf, 64);
    uint64_t square[TILE_THIRD][64];
    uint64_t *to = g->words + (uint64_t)t->third * across + (uint64_t)(t->f + 64 * kf) * along + (x >> 6);

    for (int32_t k = 0; k < t->nt; k++) {
        /* Of each column the same word; then 64 by 64 bits are turned. */
        for (int32_t i = 0; i < n; i++) square[k][i] = run[k][i][kf];
        memset(square[k] + n, 0, (size_t)(64 - n) * sizeof square[k][0]);
        bvxi_transpose_64(square[k]);
    }
    for (int32_t i = 0; i < rows; i++, to += along)
        for (int32_t k = 0; k < t->nt; k++) to[(uint64_t)k * across] = square[k][i];
}

/* Bytes from the samples of a tile's last plane to those that are read next; 0 for none. */
static int64_t next_columns(const bvxi_sample_walk *w, const sample_tile *t, int32_t x)
{
    int64_t const plane = w->stride[3 - w->axis];
    /* The next columns, from the first plane on. */
    if (x + 64 < w->grid->size[0])
        return at_most(w->grid->size[0] - x - 64, 64) * w->stride[0] - (t->nt - 1) * plane;
    /* The first columns of the next tile. */
    if (t->third + t->nt < w->grid->size[3 - w->axis]) return plane - x * w->stride[0];
    return 0;
}

/* 64 columns of x by the rule for columns: words of rows at once, written as write_squares does. */
static void write_columns(const bvxi_sample_walk *w, const sample_tile *t, int32_t x, int32_t n,
                          uint64_t row[TILE_THIRD][64 * TILE_F_WORDS])
{
    const bvx_grid *const g = w->grid;
    uint64_t const wide = (uint64_t)g->words_per_row, deep = (uint64_t)g->size[1] * wide;
    uint64_t const along = w->axis == 2 ? deep : wide, across = w->axis == 2 ? wide : deep;
    uint64_t *to = g->words + (uint64_t)t->third * across + (uint64_t)t->f * along + (x >> 6);
    for (int32_t k = 0; k < t->nt; k++) {
        int32_t const y = w->axis == 2 ? t->third + k : t->f;
        int32_t const z = w->axis == 2 ? t->f : t->third + k;
        w->columns(w->rule, sample_at(w, x, y, z), w->stride[0], n, t->nf,
                   k + 1 < t->nt ? w->stride[3 - w->axis] : next_columns(w, t, x), row[k]);
    }
    for (int32_t i = 0; i < t->nf; i++, to += along)
        for (int32_t k = 0; k < t->nt; k++) to[(uint64_t)k * across] = row[k][i];
}

static void walk_tiles(void *user, int32_t piece, uint64_t tile, uint64_t end)
{
    const bvxi_sample_walk *const w = user;
    const int32_t *const size = w->grid->size;
    void *const tally = piece_tally(w, piece);
    int32_t const third = size[3 - w->axis];
    uint64_t const tiles = (uint64_t)tiles_along(w);
    for (; tile < end; tile++) {
        sample_tile t = {.f = (int32_t)(tile % tiles) * 64 * TILE_F_WORDS,
                         .third = (int32_t)(tile / tiles) * TILE_THIRD};
        t.nf = at_most(size[w->axis] - t.f, 64 * TILE_F_WORDS);
        t.nt = at_most(third - t.third, TILE_THIRD);
        union {
            uint64_t run[TILE_THIRD][64][TILE_F_WORDS];
            uint64_t row[TILE_THIRD][64 * TILE_F_WORDS];
        } at;
        int const columns = w->columns != NULL && tally == NULL && w->stride[w->axis] == 1;

        for (int32_t x = 0; x < w->grid->size[0]; x += 64) {
            int32_t const n = at_most(w->grid->size[0] - x, 64);
            if (columns) {
                write_columns(w, &t, x, n, at.row);
                continue;
            }
            read_runs(w, tally, &t, x, n, at.run);
            for (int32_t kf = 0; 64 * kf < t.nf; kf++) write_squares(w, &t, x, n, kf, at.run);
        }
    }
}

bvx_status bvxi_samples_to_bits(bvx_context *ctx, const char *stage, double from, double to,
                                bvxi_sample_walk *walk)
{
    uint64_t const third = (uint64_t)walk->grid->size[walk->axis == 0 ? 0 : 3 - walk->axis];
    if (walk->axis == 0)
        return bvxi_for_pieces(ctx, stage, from, to, walk->pieces, bvxi_grid_rows(walk->grid), walk_rows,
                               walk);
    return bvxi_for_pieces(ctx, stage, from, to, walk->pieces,
                           (uint64_t)tiles_along(walk) * ((third + TILE_THIRD - 1) / TILE_THIRD), walk_tiles,
                           walk);
}
