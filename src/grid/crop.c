/* crop.c - the box of what is set, other windows of a lattice, and lattices with a rim around.
 *
 * A row of the result is a row of the grid read from another bit on (bits/bits.h): two shifts a word. */
#include "grid/grid.h"

enum { CROP_GRAIN = 4096 /* least words a piece */ };

typedef struct content_box {
    int32_t low[3], high[3]; /* low above high when nothing is set */
} content_box;

void bvxi_grid_content(const bvx_grid *grid, bvx_window *window)
{
    content_box box = {{INT32_MAX, INT32_MAX, INT32_MAX}, {-1, -1, -1}};
    for (int32_t z = 0; z < grid->size[2]; z++)
        for (int32_t y = 0; y < grid->size[1]; y++) {
            const uint64_t *const row = bvxi_grid_row(grid, y, z);
            int32_t first = 0, last = grid->words_per_row - 1;

            /* The row's words are walked from both ends up to the first one that holds a bit: only the outermost
             * bits count. */
            while (first <= last && row[first] == 0) first++;
            if (first > last) continue;
            while (row[last] == 0) last--;
            int32_t const low[3] = {first * BVXI_WORD_BITS + bvxi_lowest(row[first]), y, z};
            int32_t const high[3] = {last * BVXI_WORD_BITS + bvxi_highest(row[last]), y, z};
            for (int32_t a = 0; a < 3; a++) {
                box.low[a] = low[a] < box.low[a] ? low[a] : box.low[a];
                box.high[a] = high[a] > box.high[a] ? high[a] : box.high[a];
            }
        }
    memset(window, 0, sizeof *window);
    for (int32_t a = 0; a < 3 && box.high[0] >= 0; a++) {
        window->low[a] = grid->low[a] + box.low[a];
        window->size[a] = box.high[a] - box.low[a] + 1;
    }
}

typedef struct crop_job {
    const bvx_grid *grid;
    bvx_grid *result;
    int32_t from[3]; /* the grid's voxel at the result's first one; may lie outside */
} crop_job;

static void crop_piece(void *user, uint64_t begin, uint64_t end)
{
    const crop_job *const job = user;
    const bvx_grid *const g = job->grid;
    bvx_grid *const to = job->result;
    uint64_t const rows = (uint64_t)to->size[1], tail = bvxi_tail_mask(to->size[0]);

    for (uint64_t r = begin; r < end; r++) {
        /* A row of the result may lie beside the grid; then it is empty. */
        int64_t const y = (int64_t)(r % rows) + job->from[1], z = (int64_t)(r / rows) + job->from[2];
        uint64_t *const row = to->words + (size_t)r * (size_t)to->words_per_row;
        if (y < 0 || z < 0 || y >= g->size[1] || z >= g->size[2]) {
            memset(row, 0, (size_t)to->words_per_row * 8);
            continue;
        }
        bvxi_shift_row(bvxi_grid_row(g, (int32_t)y, (int32_t)z), g->words_per_row, job->from[0], row,
                       to->words_per_row);
        row[to->words_per_row - 1] &= tail; /* The shift brings bits past the result's row. */
    }
}

/* Copy the grid, read from voxel `from` on, into a window of a lattice. */
static bvx_status move_grid(bvx_context *ctx, const char *function, const bvx_grid *grid,
                            const bvx_lattice *lattice, const bvx_window *window, const int32_t from[3],
                            bvx_grid *result)
{
    bvxi_grid_renew(ctx, lattice, window, result);
    /* Whose words the result has decides who frees them after a failure. */
    int const made_here = result->words == NULL;
    BVXI_TRY(bvxi_grid_open(ctx, function, lattice, window, result));
    crop_job job = {.grid = grid, .result = result};
    memcpy(job.from, from, sizeof job.from);
    return bvxi_grid_made(ctx,
                          bvxi_for(ctx, "crop", bvxi_grid_rows(result),
                                   1 + CROP_GRAIN / (uint64_t)result->words_per_row, crop_piece, &job),
                          made_here, result);
}

static bvx_status run_grid_crop(bvx_context *context, const bvx_grid *grid, const bvx_window *window,
                                bvx_grid *result)
{
    static const char *const function = "bvx_grid_crop";
    int32_t from[3];
    bvx_window w;
    BVXI_TRY(bvxi_grid_apart(context, function, grid, result));
    BVXI_TRY(bvxi_window_take(context, function, &grid->lattice, window, &w));
    for (int32_t a = 0; a < 3; a++) from[a] = w.low[a] - grid->low[a];
    return move_grid(context, function, grid, &grid->lattice, &w, from, result);
}

bvx_status bvx_grid_crop(bvx_context *context, const bvx_grid *grid, const bvx_window *window,
                         bvx_grid *result)
{
    return BVXI_CALL(context, run_grid_crop(context, grid, window, result));
}

static bvx_status run_grid_pad(bvx_context *context, const bvx_grid *grid, const int32_t low[3],
                               const int32_t high[3], bvx_grid *result)
{
    static const char *const function = "bvx_grid_pad";
    int32_t dims[3], from[3];
    double origin[3];
    bvx_lattice lattice;
    bvx_window w;

    if (low == NULL || high == NULL) return bvxi_fail_null(context, function, low == NULL ? "low" : "high");
    BVXI_TRY(bvxi_grid_apart(context, function, grid, result));
    for (int32_t a = 0; a < 3; a++) {
        /* Compared by what is left up to the longest side, so that no sum overflows. */
        int32_t const room = BVXI_MAX_SIDE - grid->lattice.dims[a];
        if (low[a] < 0 || high[a] < 0)
            return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_RANGE,
                                 "%s: low[%d] is %d and high[%d] is %d; 0 and more are possible", function,
                                 (int64_t)a, (int64_t)low[a], (int64_t)a, (int64_t)high[a]);
        if (low[a] > room || high[a] > room - low[a])
            return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                 "%s: the lattice would have %d voxels along axis %d; %d are possible",
                                 function, (int64_t)grid->lattice.dims[a] + low[a] + high[a], (int64_t)a,
                                 (int64_t)BVXI_MAX_SIDE);

        /* The voxels stay where they are in space: the origin moves by the rim, the window grows. */
        dims[a] = grid->lattice.dims[a] + low[a] + high[a];
        origin[a] = grid->lattice.origin[a] - (double)low[a] * grid->lattice.spacing[a];
        from[a] = -low[a];
        w.low[a] = grid->low[a];
        w.size[a] = grid->size[a] + low[a] + high[a];
    }
    BVXI_TRY(bvxi_lattice_build(context, function, origin, grid->lattice.spacing, dims, &lattice));
    return move_grid(context, function, grid, &lattice, &w, from, result);
}

bvx_status bvx_grid_pad(bvx_context *context, const bvx_grid *grid, const int32_t low[3],
                        const int32_t high[3], bvx_grid *result)
{
    return BVXI_CALL(context, run_grid_pad(context, grid, low, high, result));
}
