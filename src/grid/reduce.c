/* reduce.c - blocks of voxels become voxels, or counts: bvx_grid_downsample, bvx_grid_coverage.
 *
 * Rows of blocks come as bit planes (block_rows.c). ALL is what has no empty voxel; MAJORITY compares 64
 * counts at a time with half of the block's voxels, and looks at the first and the last block of a row apart,
 * as the window may cut them; counts are the planes turned over (bits/bits.h). */
#include "grid/blocks.h"

enum { BLOCKS_GRAIN = 4096 /* least words of the grid a piece */ };

/* Warren, Hacker's Delight, 7-4: which bits move by 1, 2, 4, ... places as the mask is compressed. */
static void lay_moves(bvxi_block_starts *s)
{
    uint64_t m = s->mask, behind = ~s->mask << 1;
    /* At each step the parity of the gaps below a bit says whether it moves by this power of two. */
    for (int32_t i = 0; i < 6; i++) {
        uint64_t parity = behind;
        parity = bvxi_prefix_parity(parity);
        s->move[i] = parity & m;
        m = (m ^ s->move[i]) | s->move[i] >> (1 << i);
        behind &= ~parity;
    }
    s->count = (int32_t)bvxi_popcount(s->mask);
}

static bvx_status lay_planes(bvx_context *ctx, const char *function, bvxi_blocks *b)
{
    uint64_t const voxels = (uint64_t)b->factor[0] * (uint64_t)b->factor[1];

    /* A count of a block must fit in 32 bits, as callers get it. */
    if (voxels > UINT32_MAX || voxels * (uint64_t)b->factor[2] > UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: blocks of %d x %d x %d voxels; fewer than 2^32 are possible", function,
                             (int64_t)b->factor[0], (int64_t)b->factor[1], (int64_t)b->factor[2]);
    b->plane_count = 1;
    /* As many digits as the largest count has; the other rules need one. */
    if (b->what == BVXI_BLOCKS_COUNT)
        while (voxels * (uint64_t)b->factor[2] >> b->plane_count != 0) b->plane_count++;
    b->workers = bvxi_threads(ctx);

    /* Two sets for the row and its copy, one for the result: each worker has its own. */
    b->worker_words = (2 * (uint64_t)b->words + (uint64_t)b->count_words) * (uint64_t)b->plane_count;
    uint64_t const bytes = b->worker_words * (uint64_t)b->workers * 8;
    return bvxi_alloc(ctx, BVXI_SCRATCH, bytes, "the blocks' planes", &b->planes);
}

static bvx_status blocks_open(bvx_context *ctx, const char *function, const bvx_grid *grid,
                              const int32_t factor[3], int32_t what, bvxi_blocks *b)
{
    double spacing[3];
    int32_t dims[3];

    memset(b, 0, sizeof *b);
    if (factor == NULL) return bvxi_fail_null(ctx, function, "factor");
    BVXI_TRY(bvxi_grid_check(ctx, function, grid));
    b->grid = grid;
    b->what = what;
    b->cpu = bvxi_cpu(ctx);
    for (int32_t a = 0; a < 3; a++) {
        int32_t const n = grid->lattice.dims[a];
        if (factor[a] < 1 || factor[a] > BVXI_MAX_SIDE)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                                 "%s: factor[%d] is %d; 1 to %d are possible", function, (int64_t)a,
                                 (int64_t)factor[a], (int64_t)BVXI_MAX_SIDE);
        /* The spacing grows by the factor that was requested, also where it is cut to the lattice's side. */
        spacing[a] = grid->lattice.spacing[a] * (double)factor[a];
        b->factor[a] = factor[a] < n ? factor[a] : n;

        /* Blocks count from the lattice's origin, so a window gives the blocks that the whole grid would. */
        int64_t const first = grid->low[a] / b->factor[a];
        int64_t const last = (grid->low[a] + grid->size[a] - 1) / b->factor[a];
        dims[a] = (n - 1) / b->factor[a] + 1;
        b->window.low[a] = (int32_t)first;
        b->window.size[a] = (int32_t)(last - first) + 1;
    }
    BVXI_TRY(bvxi_lattice_build(ctx, function, grid->lattice.origin, spacing, dims, &b->lattice));

    /* The voxels of the first block before the window are empty ones put in front of the row. */
    b->phase = grid->low[0] % b->factor[0];
    b->words = bvxi_row_words(b->phase + grid->size[0]);
    b->count_words = bvxi_row_words(b->window.size[0]);
    BVXI_TRY(lay_planes(ctx, function, b));
    BVXI_TRY(BVXI_ZEROS(ctx, b->words, "the blocks' first voxels", b->starts));
    /* Blocks begin every factor voxels, with the voxels that the window cuts off the first one counted in. */
    for (int32_t n = 0; n < b->window.size[0]; n++) {
        int64_t const x = (int64_t)n * b->factor[0];
        b->starts[x >> 6].mask |= UINT64_C(1) << (x & 63);
    }
    for (int32_t k = 0; k < b->words; k++) lay_moves(&b->starts[k]);
    return BVX_OK;
}

static uint64_t block_rows(const bvxi_blocks *b)
{
    return (uint64_t)b->window.size[1] * (uint64_t)b->window.size[2];
}

static int32_t block_pieces(const bvxi_blocks *b)
{
    int32_t const pieces = bvxi_piece_count(bvxi_grid_words(b->grid), BLOCKS_GRAIN);
    return (uint64_t)pieces > block_rows(b) ? (int32_t)block_rows(b) : pieces;
}

typedef struct reduce_job {
    bvxi_blocks blocks;
    bvx_grid *result;
    int32_t rule, pieces;
} reduce_job;

/* Bits of word k whose counts are above a limit, digit by digit from the highest. */
static uint64_t counts_above(const bvxi_blocks *b, const uint64_t *planes, int32_t digits, int32_t k,
                             uint64_t limit)
{
    uint64_t above = 0, equal = ~UINT64_C(0);

    /* A limit of more digits than the counts have is above all of them. */
    if (digits < BVXI_BLOCK_PLANES && limit >> digits != 0) return 0;
    for (int32_t p = digits - 1; p >= 0; p--) {
        uint64_t const plane = planes[(size_t)p * (size_t)b->count_words + (size_t)k];
        if ((limit >> p & 1) != 0) {
            equal &= plane;
        } else {
            above |= equal & plane;
            equal &= ~plane;
        }
    }
    return above;
}

static void reduce_piece(void *user, int32_t index, int32_t worker)
{
    const reduce_job *const job = user;
    const bvxi_blocks *const b = &job->blocks;
    uint64_t const rows = (uint64_t)b->window.size[1];
    uint64_t begin, end;
    bvxi_piece(block_rows(b), job->pieces, index, &begin, &end);
    for (uint64_t r = begin; r < end; r++) {
        size_t const words = (size_t)b->count_words;
        int32_t const j = (int32_t)(r % rows), k = (int32_t)(r / rows);
        int32_t digits, y[2], z[2];
        const uint64_t *const planes = bvxi_blocks_row(b, worker, j, k, &digits);
        uint64_t *const row = job->result->words + (size_t)r * words;

        /* No digits: all counts are 0, so ALL has no empty voxel and the other rules have no set one. */
        if (digits == 0) {
            memset(row, job->rule == BVX_REDUCE_ALL ? 0xff : 0, words * 8);
        } else if (job->rule == BVX_REDUCE_MAJORITY) {
            bvxi_block_range(b, 1, j, &y[0], &y[1]);
            bvxi_block_range(b, 2, k, &z[0], &z[1]);
            uint64_t const across = (uint64_t)(y[1] - y[0]) * (uint64_t)(z[1] - z[0]);
            int32_t const last = b->window.size[0] - 1, ends[2] = {0, last};
            for (int32_t x = 0; x < b->count_words; x++)
                row[x] = counts_above(b, planes, digits, x, across * (uint64_t)b->factor[0] / 2);
            /* The first and the last block may be cut by the window: their half is smaller. */
            for (int32_t e = 0; e < 2; e++) {
                uint64_t const bit = UINT64_C(1) << (ends[e] & 63);
                int32_t from, to;
                bvxi_block_range(b, 0, ends[e], &from, &to);
                row[ends[e] >> 6] &= ~bit;
                row[ends[e] >> 6] |= bit & counts_above(b, planes, digits, ends[e] >> 6,
                                                        across * (uint64_t)(to - from) / 2);
            }
        } else {
            for (size_t w = 0; w < words; w++) row[w] = job->rule == BVX_REDUCE_ALL ? ~planes[w] : planes[w];
        }
        row[words - 1] &= bvxi_tail_mask(b->window.size[0]);
    }
}

static bvx_status run_grid_downsample(bvx_context *context, const bvx_grid *grid, const int32_t factor[3],
                                      int32_t rule, bvx_grid *result)
{
    static const char *const function = "bvx_grid_downsample";
    /* ALL looks for empty voxels, since one is enough to refuse a block. */
    static const int32_t what[3] = {BVXI_BLOCKS_ANY, BVXI_BLOCKS_NONE, BVXI_BLOCKS_COUNT};
    reduce_job job;

    BVXI_TRY(bvxi_grid_apart(context, function, grid, result));
    if (rule < BVX_REDUCE_ANY || rule > BVX_REDUCE_MAJORITY)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: rule %d is unknown", function,
                             (int64_t)rule);
    job.rule = rule;

    /* After the check of the rule, as it is the index of the table. */
    BVXI_TRY(blocks_open(context, function, grid, factor, what[rule], &job.blocks));
    bvxi_grid_renew(context, &job.blocks.lattice, &job.blocks.window, result);
    int const mine = result->words == NULL;
    BVXI_TRY(bvxi_grid_open(context, function, &job.blocks.lattice, &job.blocks.window, result));
    job.result = result;
    job.pieces = block_pieces(&job.blocks);
    return bvxi_grid_made(context,
                          bvxi_parallel(context, "downsample", 0.0, 1.0, job.pieces, reduce_piece, &job),
                          mine, result);
}

bvx_status bvx_grid_downsample(bvx_context *context, const bvx_grid *grid, const int32_t factor[3],
                               int32_t rule, bvx_grid *result)
{
    return BVXI_CALL(context, run_grid_downsample(context, grid, factor, rule, result));
}

typedef struct coverage_job {
    bvxi_blocks blocks;
    uint32_t *counts;
    int32_t pieces;
} coverage_job;

static void put_counts(const bvxi_blocks *b, const uint64_t *planes, int32_t digits, uint32_t *to)
{
    for (int32_t k = 0; k < b->count_words; k++) {
        /* Digit p of 64 counts is a word: turned over, word i has the digits of count i. */
        int32_t const left = b->window.size[0] - k * BVXI_WORD_BITS;
        int32_t const n = left < BVXI_WORD_BITS ? left : BVXI_WORD_BITS;
        uint64_t square[64], seen = 0;
        for (int32_t p = 0; p < digits; p++) {
            square[p] = planes[(size_t)p * (size_t)b->count_words + (size_t)k];
            seen |= square[p];
        }
        if (seen == 0) {
            memset(to, 0, (size_t)n * sizeof *to);
        } else {
            for (int32_t p = digits; p < 64; p++) square[p] = 0;
            bvxi_transpose_64(square);
            for (int32_t i = 0; i < n; i++) to[i] = (uint32_t)square[i];
        }
        to += n;
    }
}

static void coverage_piece(void *user, int32_t index, int32_t worker)
{
    const coverage_job *const job = user;
    const bvxi_blocks *const b = &job->blocks;
    uint64_t const rows = (uint64_t)b->window.size[1];
    size_t const row = (size_t)b->window.size[0];
    uint64_t begin, end;

    /* Counts of a row are written by one task only. */
    bvxi_piece(block_rows(b), job->pieces, index, &begin, &end);
    for (uint64_t r = begin; r < end; r++) {
        int32_t digits;
        const uint64_t *const planes = bvxi_blocks_row(b, worker, (int32_t)(r % rows), (int32_t)(r / rows),
                                                       &digits);
        if (digits == 0) memset(job->counts + (size_t)r * row, 0, row * sizeof *job->counts);
        else put_counts(b, planes, digits, job->counts + (size_t)r * row);
    }
}

static bvx_status run_grid_coverage(bvx_context *context, const bvx_grid *grid, const int32_t factor[3],
                                    uint32_t *counts, uint64_t capacity, uint64_t *count)
{
    static const char *const function = "bvx_grid_coverage";
    coverage_job job;

    if (count == NULL) return bvxi_fail_null(context, function, "count");
    /* The count is there after a failure too, 0 unless it is known. */
    *count = 0;
    BVXI_TRY(blocks_open(context, function, grid, factor, BVXI_BLOCKS_COUNT, &job.blocks));
    *count = block_rows(&job.blocks) * (uint64_t)job.blocks.window.size[0];
    job.counts = counts;
    job.pieces = block_pieces(&job.blocks);
    if (counts != NULL && capacity < *count)
        return bvxi_fail(context, BVX_ERR_CAPACITY, "%s: there are %u blocks, the array given holds %u",
                         function, *count, capacity);
    else if (counts != NULL)
        BVXI_TRY(bvxi_parallel(context, "downsample", 0.0, 1.0, job.pieces, coverage_piece, &job));
    return BVX_OK;
}

bvx_status bvx_grid_coverage(bvx_context *context, const bvx_grid *grid, const int32_t factor[3],
                             uint32_t *counts, uint64_t capacity, uint64_t *count)
{
    return BVXI_CALL(context, run_grid_coverage(context, grid, factor, counts, capacity, count));
}
