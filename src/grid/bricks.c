/* bricks.c - which bricks of 8 x 8 x 8 voxels hold a set one, as a grid 512 times smaller that rays and
 * searches look at first.
 *
 * Eight rows by eight are joined by OR, 64 voxels at a time; each byte of the result then becomes a bit. */
#include "grid/grid.h"

enum { BRICK_GRAIN = 64 /* least rows of bricks a piece */ };

typedef struct brick_work {
    bvxi_bricks *bricks;
    int32_t pieces;
} brick_work;

/* Bit i of the result says whether byte i of w is not 0. */
static uint64_t bytes_to_bits(uint64_t w)
{
    /* The lowest bit of each byte becomes the OR of its eight,
     * with some of the byte above mixed into the others. */
    w |= w >> 4;
    w |= w >> 2;
    w |= w >> 1;
    /* The multiplication brings the eight lowest bits together in the top byte. */
    return (w & UINT64_C(0x0101010101010101)) * UINT64_C(0x0102040810204080) >> 56;
}

static uint64_t join_brick_words(const bvx_grid *g, int32_t k, int32_t y, int32_t z)
{
    /* Bricks at the upper end are cut by the grid. */
    int32_t const y_end = g->size[1] - y < 8 ? g->size[1] : y + 8;
    int32_t const z_end = g->size[2] - z < 8 ? g->size[2] : z + 8;
    uint64_t w = 0;

    for (int32_t j = z; j < z_end; j++) {
        const uint64_t *at = g->words +
                             ((size_t)j * (size_t)g->size[1] + (size_t)y) * (size_t)g->words_per_row +
                             (size_t)k;
        for (int32_t i = y; i < y_end; i++, at += g->words_per_row) w |= *at;
    }
    return w;
}

static void make_brick_rows(void *user, int32_t index, int32_t worker)
{
    const brick_work *const work = user;
    bvxi_bricks *const b = work->bricks;
    uint64_t begin, end;

    (void)worker;
    bvxi_piece((uint64_t)b->size[1] * (uint64_t)b->size[2], work->pieces, index, &begin, &end);
    for (uint64_t r = begin; r < end; r++) {
        /* Rows of bricks are eight rows of voxels along y and eight slices. */
        int32_t const y = (int32_t)(r % (uint64_t)b->size[1]) * 8;
        int32_t const z = (int32_t)(r / (uint64_t)b->size[1]) * 8;
        uint64_t *const row = b->words + (size_t)r * (size_t)b->words_per_row;
        memset(row, 0, (size_t)b->words_per_row * 8);
        for (int32_t k = 0; k < b->grid->words_per_row; k++)
            row[k >> 3] |= bytes_to_bits(join_brick_words(b->grid, k, y, z)) << 8 * (k & 7);
    }
}

static uint64_t brick_bytes(const bvxi_bricks *b)
{
    return (uint64_t)b->size[1] * (uint64_t)b->size[2] * (uint64_t)b->words_per_row * 8;
}

bvx_status bvxi_bricks_make(bvx_context *ctx, const char *stage, double from, double to, const bvx_grid *grid,
                            bvxi_bricks *bricks)
{
    brick_work w = {bricks, 1};
    bvx_status status;

    memset(bricks, 0, sizeof *bricks);
    bricks->grid = grid;
    for (int32_t a = 0; a < 3; a++) bricks->size[a] = (grid->size[a] + 7) >> BVXI_BRICK_SHIFT;
    bricks->words_per_row = bvxi_row_words(bricks->size[0]);
    /* A piece writes rows of its own, so its bits do not depend on the others. */
    w.pieces = bvxi_piece_count((uint64_t)bricks->size[1] * (uint64_t)bricks->size[2], BRICK_GRAIN);
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, brick_bytes(bricks), "the grid's bricks", &bricks->words));
    status = bvxi_parallel(ctx, stage, from, to, w.pieces, make_brick_rows, &w);
    if (status != BVX_OK) bvxi_bricks_free(ctx, bricks);
    return status;
}

void bvxi_bricks_free(bvx_context *ctx, bvxi_bricks *bricks)
{
    bvxi_drop(ctx, bricks->words);
    memset(bricks, 0, sizeof *bricks);
}
