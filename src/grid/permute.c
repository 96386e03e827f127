/* permute.c - axes of a grid exchanged and mirrored: bvx_grid_permute; and grids whose bits run along y or z
 * brought back to rows along x.
 *
 * Where bits turn, 64 rows and one word are a square that is turned over its diagonal (bits/bits.h). Each
 * word of the result is written by one square, so threads do not show. */
#include "grid/turned_rows.h"

/* ---- Axes of a grid changed and mirrored ---- */

enum { PERMUTE_GRAIN = 4096 /* least words a piece */ };

typedef struct permute_job {
    const bvx_grid *grid;
    bvx_grid *result;
    int32_t axes[3], flips[3];
    int32_t x_to; /* the result's axis that x becomes */
    int32_t slices;
    size_t step[3];    /* words of grid from voxel to voxel along the result's axes; 0 where that is x */
    size_t to_step[3]; /* words of result */
    uint64_t *second;  /* bvxi_turn_back's, or NULL */
} permute_job;

static int32_t flipped(const permute_job *job, int32_t axis, int32_t i)
{
    return job->flips[axis] ? job->result->size[axis] - 1 - i : i;
}

static uint64_t reverse_word(uint64_t w)
{
    /* Neighbouring bits change places, then pairs, then groups of four, up to the halves. */
    w = (w >> 1 & UINT64_C(0x5555555555555555)) | (w & UINT64_C(0x5555555555555555)) << 1;
    w = (w >> 2 & UINT64_C(0x3333333333333333)) | (w & UINT64_C(0x3333333333333333)) << 2;
    w = (w >> 4 & UINT64_C(0x0f0f0f0f0f0f0f0f)) | (w & UINT64_C(0x0f0f0f0f0f0f0f0f)) << 4;
    w = (w >> 8 & UINT64_C(0x00ff00ff00ff00ff)) | (w & UINT64_C(0x00ff00ff00ff00ff)) << 8;
    w = (w >> 16 & UINT64_C(0x0000ffff0000ffff)) | (w & UINT64_C(0x0000ffff0000ffff)) << 16;
    return w >> 32 | w << 32;
}

static void permute_rows(void *user, uint64_t begin, uint64_t end)
{
    const permute_job *const job = user;
    bvx_grid *const to = job->result;
    size_t const words = (size_t)to->words_per_row;
    for (uint64_t r = begin; r < end; r++) {
        int32_t const b = (int32_t)(r % (uint64_t)to->size[1]), c = (int32_t)(r / (uint64_t)to->size[1]);
        /* Steps of 0 along x leave the row's beginning; y and z may change places or turn over. */
        const uint64_t *const row = job->grid->words + (size_t)flipped(job, 1, b) * job->step[1] +
                                    (size_t)flipped(job, 2, c) * job->step[2];
        uint64_t *const out = to->words + (size_t)r * words;
        if (!job->flips[0]) {
            memcpy(out, row, words * 8);
            continue;
        }
        /* The row's last word has spare bits at its end: reversed they come first, and are shifted out. */
        int32_t const spare = (int32_t)words * BVXI_WORD_BITS - to->size[0];
        for (size_t k = 0; k < words; k++) {
            out[k] = reverse_word(row[words - 1 - k]) >> spare;
            if (spare != 0 && k + 1 < words)
                out[k] |= reverse_word(row[words - 2 - k]) << (BVXI_WORD_BITS - spare);
        }
    }
}

/* One word of the grid's rows and one of the result's, in a slice across the third axis. */
static void permute_square(const permute_job *job, int32_t third, int32_t slice, int32_t word, int32_t k)
{
    int32_t const first = word * BVXI_WORD_BITS, left = job->grid->size[0] - first, x_to = job->x_to;
    int32_t const n = left < BVXI_WORD_BITS ? left : BVXI_WORD_BITS;
    uint64_t *const to = job->result->words + (size_t)slice * job->to_step[third] + (size_t)k;
    /* Rows of the result's voxels 64 k .. along x: turned, bit i of word n is what bit n of row i was. */
    const uint64_t *const from = job->grid->words + (size_t)flipped(job, third, slice) * job->step[third] +
                                 (size_t)word;
    int32_t const begin = k * BVXI_WORD_BITS, columns = job->result->size[0] - begin;
    uint64_t const within = columns <= BVXI_WORD_BITS ? bvxi_tail_mask(job->result->size[0]) : ~UINT64_C(0);
    uint64_t square[64], any = 0;

    /* Rows past the result's end are empty, so their bits stay 0. */
    for (int32_t i = 0; i < BVXI_WORD_BITS; i++)
        any |= square[i] = i < columns ? from[(size_t)flipped(job, 0, begin + i) * job->step[0]] : 0;
    if (any != 0) bvxi_transpose_64(square);
    for (int32_t i = 0; i < n; i++) {
        size_t const at = (size_t)flipped(job, x_to, first + i) * job->to_step[x_to];
        if (job->second == NULL) {
            to[at] = square[i];
        } else {
            /* Where all three agree, the bit of second is set; bits past the row are cleared with it. */
            uint64_t *const second = &job->second[(size_t)(to - job->result->words) + at];
            *second = ~(to[at] ^ *second) & ~(to[at] ^ square[i]) & within;
        }
    }
}

static void permute_squares(void *user, uint64_t begin, uint64_t end)
{
    const permute_job *const job = user;
    /* The axis that is neither x nor where x goes keeps its place: its slices are independent. */
    int32_t const third = 3 - job->x_to; /* 1 and 2 change places */
    for (uint64_t s = begin; s < end; s++)
        for (int32_t k = 0; k < job->result->words_per_row; k++)
            for (int32_t word = 0; word < job->grid->words_per_row; word++)
                permute_square(job, third, (int32_t)s, word, k);
}

static bvx_status take_axes(bvx_context *ctx, const char *function, const int32_t axes[3],
                            const int32_t flips[3], permute_job *job)
{
    int32_t seen = 0;

    if (axes == NULL) return bvxi_fail_null(ctx, function, "axes");
    for (int32_t a = 0; a < 3; a++) {
        int32_t const flip = flips != NULL ? flips[a] : 0;
        if (axes[a] < 0 || axes[a] > 2 || (seen >> axes[a] & 1) != 0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                                 "%s: axes are %d, %d, %d; they must be 0, 1, 2 in any order", function,
                                 (int64_t)axes[0], (int64_t)axes[1], (int64_t)axes[2]);
        if ((flip & ~1) != 0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE, "%s: flips[%d] is %d, not 0 or 1",
                                 function, (int64_t)a, (int64_t)flip);
        seen |= 1 << axes[a];
        job->axes[a] = axes[a];
        job->flips[a] = flip;
        if (axes[a] == 0) job->x_to = a;
    }
    return BVX_OK;
}

static void lay_permute_steps(permute_job *job)
{
    const bvx_grid *const g = job->grid, *const to = job->result;
    size_t const row = (size_t)g->words_per_row, to_row = (size_t)to->words_per_row;
    size_t const step[3] = {0, row, row * (size_t)g->size[1]};
    size_t const to_step[3] = {0, to_row, to_row * (size_t)to->size[1]};
    /* x has no step in words: its voxels are bits. */
    for (int32_t a = 0; a < 3; a++) {
        job->step[a] = step[job->axes[a]];
        job->to_step[a] = to_step[a];
    }
}

bvx_status bvxi_turn_back(bvx_context *ctx, const bvx_grid *turned, int32_t axis, double progress,
                          bvx_grid *grid, uint64_t *second)
{
    /* The turned axis runs along the rows of turned, and x from row to row. */
    permute_job job = {.grid = turned, .result = grid, .axes = {1, 2, 2}, .x_to = axis, .second = second};
    uint64_t const slices = (uint64_t)turned->size[2];
    job.axes[axis] = 0;
    lay_permute_steps(&job);
    return BVXI_SHARE(ctx, progress, progress,
                      bvxi_for(ctx, "solid", slices, 1 + PERMUTE_GRAIN * slices / bvxi_grid_words(turned),
                               permute_squares, &job));
}

static bvx_status run_grid_permute(bvx_context *context, const bvx_grid *grid, const int32_t axes[3],
                                   const int32_t flips[3], bvx_grid *result)
{
    static const char *const function = "bvx_grid_permute";
    bvx_lattice lattice;
    permute_job job = {0};
    bvx_window window;

    BVXI_TRY(take_axes(context, function, axes, flips, &job));
    BVXI_TRY(bvxi_grid_apart(context, function, grid, result));
    job.grid = grid;

    job.result = result;
    /* A mirrored window counts from the lattice's other end. */
    lattice.fraction_bits = grid->lattice.fraction_bits;
    for (int32_t a = 0; a < 3; a++) {
        int32_t const from = job.axes[a];
        lattice.origin[a] = grid->lattice.origin[from];
        lattice.spacing[a] = grid->lattice.spacing[from];
        lattice.dims[a] = grid->lattice.dims[from];
        window.size[a] = grid->size[from];
        window.low[a] = job.flips[a] ? grid->lattice.dims[from] - grid->low[from] - grid->size[from]
                                     : grid->low[from];
    }
    bvxi_grid_renew(context, &lattice, &window, result);
    int const mine = result->words == NULL;
    BVXI_TRY(bvxi_grid_open(context, function, &lattice, &window, result));
    lay_permute_steps(&job);
    uint64_t const words = bvxi_grid_words(result);
    if (job.x_to == 0) {
        return bvxi_grid_made(context,
                              bvxi_for(context, "permute", bvxi_grid_rows(result),
                                       1 + PERMUTE_GRAIN / (uint64_t)result->words_per_row, permute_rows,
                                       &job),
                              mine, result);
    }

    /* Slices across the axis that does not take part in the turn: no two tasks write one word. */
    job.slices = result->size[3 - job.x_to];
    return bvxi_grid_made(context,
                          bvxi_for(context, "permute", (uint64_t)job.slices,
                                   1 + PERMUTE_GRAIN * (uint64_t)job.slices / words, permute_squares, &job),
                          mine, result);
}

bvx_status bvx_grid_permute(bvx_context *context, const bvx_grid *grid, const int32_t axes[3],
                            const int32_t flips[3], bvx_grid *result)
{
    return BVXI_CALL(context, run_grid_permute(context, grid, axes, flips, result));
}
