/* turned_rows.c - rows along y or z brought back to rows along x, in blocks of 64 x 64 bits
 * (bits/bits.h).
 *
 * Both turned orders keep x as the row of their slices, so a block of 64 turned rows and one word holds a
 * square of x and the turned axis. One task is a stretch of slices; each word of the grid is written by one
 * block. */
#include "grid/turned_rows.h"
#include "bits/bits.h"

enum { TURN_GRAIN = 64 };

typedef struct turn_job {
    const bvx_grid *turned;
    bvx_grid *grid;
    uint64_t *second;
    int32_t use, pieces;
    /* words of grid from voxel to voxel along the turned axis, and from slice to slice */
    size_t step, across;
} turn_job;

/* Rows x .. x + 63 of slice s, word column k: bit i of word n becomes bit n of word i. */
static void load_turned_block(const bvx_grid *t, int32_t s, int32_t x, int32_t k, uint64_t block[64])
{
    int32_t const rows = t->size[1] - x < BVXI_WORD_BITS ? t->size[1] - x : BVXI_WORD_BITS;
    size_t const stride = (size_t)t->words_per_row;
    const uint64_t *const from = t->words + ((size_t)s * (size_t)t->size[1] + (size_t)x) * stride + (size_t)k;
    /* Rows past the end are empty, so the square is always whole. */
    for (int32_t i = 0; i < rows; i++) block[i] = from[(size_t)i * stride];
    for (int32_t i = rows; i < BVXI_WORD_BITS; i++) block[i] = 0;
    bvxi_transpose_64(block);
}

static void put_turned_block(const turn_job *job, size_t at, int32_t count, uint64_t tail,
                             const uint64_t block[64])
{
    uint64_t *const grid = job->grid->words;

    for (int32_t i = 0; i < count; i++, at += job->step) {
        uint64_t const w = block[i];
        if (job->use == BVXI_TURN_SET) {
            grid[at] = w;
        } else {
            /* Where all three agree, the bit of second is set; bits past the row are cleared with it. */
            uint64_t const a = grid[at], b = job->second[at];
            job->second[at] = ~(a ^ b) & ~(a ^ w) & tail;
        }
    }
}

static void turn_piece_back(void *user, int32_t index, int32_t worker)
{
    const turn_job *const job = user;
    const bvx_grid *const t = job->turned;
    int32_t const row_words = job->grid->words_per_row;
    uint64_t const tail = bvxi_tail_mask(job->grid->size[0]);
    uint64_t begin, end, block[64];

    (void)worker;
    bvxi_piece((uint64_t)t->size[2], job->pieces, index, &begin, &end);

    /* A word of the turned axis is 64 rows of the grid: one square at a time. */
    for (int32_t k = 0; k < t->words_per_row; k++) {
        int32_t const first = k * BVXI_WORD_BITS;
        int32_t const count = t->size[0] - first < BVXI_WORD_BITS ? t->size[0] - first : BVXI_WORD_BITS;
        for (uint64_t s = begin; s < end; s++)
            for (int32_t word = 0; word < row_words; word++) {
                size_t const at = (size_t)s * job->across + (size_t)first * job->step + (size_t)word;
                load_turned_block(t, (int32_t)s, word * BVXI_WORD_BITS, k, block);
                put_turned_block(job, at, count, word + 1 == row_words ? tail : ~UINT64_C(0), block);
            }
    }
}

bvx_status bvxi_turn_back(bvx_context *ctx, const bvx_grid *turned, int32_t axis, int32_t use,
                          double progress, bvx_grid *grid, uint64_t *second)
{
    size_t const row = (size_t)grid->words_per_row, slice = row * (size_t)grid->size[1];
    turn_job job;

    job.turned = turned;
    job.grid = grid;
    job.second = second;
    job.use = use;
    job.pieces = bvxi_piece_count(bvxi_grid_words(turned), TURN_GRAIN * BVXI_WORD_BITS);
    if (job.pieces > turned->size[2]) job.pieces = turned->size[2];
    /* Along y a step is a row and the slices are z; along z it is the other way round. */
    job.step = axis == 1 ? row : slice;
    job.across = axis == 1 ? slice : row;
    return bvxi_parallel(ctx, "solid", progress, progress, job.pieces, turn_piece_back, &job);
}
