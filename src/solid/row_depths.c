/* row_depths.c - how many times over the rows of a lattice lie inside a mesh: entering crossings less leaving
 * ones.
 *
 * A voxel that is one deep everywhere, or minus one everywhere, is inside by any rule. Deeper ones, and both
 * together, are what overlaps, nested shells and shells inside out look like.
 * Guarantee: follows from the snapped triangles and the lattice only. */
#include "bits/sort.h"
#include "solid/solid.h"

enum { DEPTH_PIECES = 64, DEPTH_GRAIN = 1024 };

typedef struct depth_work {
    const bvxi_row_lists *lists;
    int32_t low, size, pieces;
    int32_t depths[DEPTH_PIECES];
} depth_work;

/* Depths that some voxel of the row has: crossings at one voxel come together. */
static int32_t depths_of_row(const depth_work *w, int32_t *c, uint32_t n)
{
    int32_t depth = 0, depths = 0;

    bvxi_sort_i32(c, n);
    for (uint32_t i = 0; i < n; i++) {
        int32_t const x = bvxi_floor_shift(c[i], 1) - w->low;

        depth += (c[i] & 1) != 0 ? -1 : 1;
        if (x >= w->size) break;
        /* The last crossing at a voxel decides, and of those before the window the last one. */
        if (i + 1 < n && (bvxi_floor_shift(c[i + 1], 1) == bvxi_floor_shift(c[i], 1) ||
                          bvxi_floor_shift(c[i + 1], 1) - w->low <= 0))
            continue;
        if (depth == 1) depths |= BVXI_DEPTH_UP;
        else if (depth == -1) depths |= BVXI_DEPTH_DOWN;
        else if (depth != 0) depths |= BVXI_DEPTH_DEEP;
    }
    return depths;
}

static void look_at_depths(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    depth_work *const w = user;
    for (uint64_t row = begin; row < end; row++) {
        uint64_t const first = row == 0 ? 0 : w->lists->row_end[row - 1], n = w->lists->row_end[row] - first;
        if (n != 0) w->depths[piece] |= depths_of_row(w, w->lists->crossing + first, (uint32_t)n);
    }
}

static bvx_status look_at_depth_block(bvx_context *ctx, bvxi_solid_job *job, const bvxi_row_lists *lists,
                                      double from, double to)
{
    int32_t *const depths = job->user;
    depth_work w = {lists, job->grid->low[0], job->grid->size[0], 0, {0}};

    w.pieces = bvxi_piece_count(lists->rows, DEPTH_GRAIN);
    if (w.pieces > DEPTH_PIECES) w.pieces = DEPTH_PIECES;
    BVXI_TRY(bvxi_for_pieces(ctx, "solid", bvxi_solid_progress(job, from), bvxi_solid_progress(job, to),
                             w.pieces, w.lists->rows, look_at_depths, &w));
    for (int32_t i = 0; i < w.pieces; i++) *depths |= w.depths[i];
    return BVX_OK;
}

bvx_status bvxi_row_depths(bvx_context *ctx, bvxi_solid_job *job, const bvx_lattice *lattice, double from,
                           double to, int32_t *depths)
{
    bvx_solid_report unused = {0};
    bvx_grid rows = {0}; /* a shape without words: nothing is filled */

    rows.lattice = *lattice;
    for (int32_t a = 0; a < 3; a++) rows.size[a] = lattice->dims[a];
    *depths = 0;

    job->user = depths;
    job->take_lists = look_at_depth_block;
    bvx_status status = bvxi_solid_fill(bvxi_solid_step(ctx, job, from, to), job, &rows, 0, BVX_FILL_NONZERO,
                                        &unused);
    job->take_lists = NULL;
    job->user = NULL;
    return status;
}
