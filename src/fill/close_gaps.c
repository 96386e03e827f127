/* close_gaps.c - a surface whose gaps are closed: what a cube cannot reach that moves through empty voxels.
 *
 * Source: Serra. Image Analysis and Mathematical Morphology. 1982 (closing); van Herk's separation of a box
 * into lines, by doubling: an OR over m voxels takes about log2 m steps of whole words.
 *
 * With m = gap + 1 an empty voxel stays empty when some cube of m voxels a side that holds it is empty, where
 * all beyond the window is empty. D(p): the cube at p .. p + m - 1 holds a set voxel; voxel v closes when D
 * holds for all p of v - m + 1 .. v. p begins at 1 - m, so D is kept in a grid of m - 1 more voxels a side:
 * D(p) stands at p + m - 1. There D is an OR over m voxels down from each place, the answer an AND over m
 * voxels up.
 * A body: between the two, places of the cube that no way from outside leads to count as holding a set voxel
 * too, so what remains empty is what the cube reaches from outside. (Closing first and flooding by single
 * voxels then would leak: where a surface runs slanting, the corners of two cubes meet in a hole of one
 * voxel.)
 * Guarantee: exact. A gap of up to `gap` voxels between set voxels along an axis, or a hole of that width in
 * a wall, closes. */
#include "components/room.h"
#include "fill/fills.h"

enum { GAP_GRAIN = 4096 };

typedef struct gap_job {
    uint64_t *words;
    int32_t size[3], row_words; /* of the grid with room for D */
    int32_t axis, m, both, pieces;
} gap_job;

/* The same for rows `stride` words apart, n of them: each joined with the
 * one `by` before (OR) or behind it (AND). */
static void join_rows(uint64_t *first, size_t stride, int32_t n, int32_t words, int32_t by, int both)
{
    for (int32_t i = 0; i < n; i++) {
        int32_t const at = both ? i : n - 1 - i, from = both ? at + by : at - by;
        uint64_t *const row = first + (size_t)at * stride;
        if (from >= 0 && from < n) {
            const uint64_t *const other = first + (size_t)from * stride;
            for (int32_t k = 0; k < words; k++) row[k] = both ? row[k] & other[k] : row[k] | other[k];
        } else if (both) {
            memset(row, 0, (size_t)words * 8);
        }
    }
}

/* One line of rows (or one row) over m voxels: stretches of 1, 2, 4, ... and the rest. */
static void join_line(const gap_job *job, uint64_t *first, size_t stride, int32_t n)
{
    /* Doubling: a stretch of 2 n is two of n, and overlapping stretches do no harm to OR and AND. */
    for (int32_t length = 1; length < job->m;) {
        int32_t const by = length < job->m - length ? length : job->m - length;
        int32_t const far = by >> 6, bits = by & 63;

        if (job->axis == 0 && job->both) {
            /* Bits x and x + by; 0 where that lies above. */
            for (int32_t k = 0; k < job->row_words; k++) {
                uint64_t w = k + far < job->row_words ? first[k + far] >> bits : 0;
                if (bits != 0 && k + far + 1 < job->row_words) w |= first[k + far + 1] << (64 - bits);
                first[k] &= w;
            }
        } else if (job->axis == 0) {
            /* Bits x or x - by. From the top down: words below are read before they are written. */
            for (int32_t k = job->row_words - 1; k >= far; k--) {
                uint64_t w = first[k - far] << bits;
                if (bits != 0 && k > far) w |= first[k - far - 1] >> (64 - bits);
                first[k] |= w;
            }
        } else join_rows(first, stride, n, job->row_words, by, job->both);
        length += by;
    }
}

static int32_t gap_lines(const gap_job *job)
{
    return job->axis == 2 ? job->size[1] : job->size[2];
}

/* A piece of the slices (x, y), or of the rows of a slice (z). */
static void join_gap_piece(void *user, int32_t index)
{
    const gap_job *const job = user;
    size_t const row = (size_t)job->row_words, slice = row * (size_t)job->size[1];
    uint64_t begin, end;

    bvxi_piece((uint64_t)gap_lines(job), job->pieces, index, &begin, &end);
    for (uint64_t i = begin; i < end; i++) {
        if (job->axis == 2) join_line(job, job->words + (size_t)i * row, slice, job->size[2]);
        else if (job->axis == 1) join_line(job, job->words + (size_t)i * slice, row, job->size[1]);
        else
            for (int32_t y = 0; y < job->size[1]; y++)
                join_line(job, job->words + (size_t)i * slice + (size_t)y * row, 0, 1);
    }
}

static bvx_status run_gap_passes(bvx_context *ctx, gap_job *job, int32_t first, int32_t end)
{
    uint64_t const words = (uint64_t)job->row_words * (uint64_t)job->size[1] * (uint64_t)job->size[2];

    for (int32_t pass = first; pass < end; pass++) {
        /* Three axes of OR make D of the whole cube, then three of AND undo its size. */
        job->both = pass >= 3;
        job->axis = pass % 3;
        job->pieces = bvxi_piece_count(words, GAP_GRAIN);
        if (job->pieces > gap_lines(job)) job->pieces = gap_lines(job);
        BVXI_TRY(bvxi_each(ctx, "gaps", pass / 6.0, (pass + 1) / 6.0, job->pieces, join_gap_piece, job));
    }
    return BVX_OK;
}

static void copy_gap_rows(const bvx_grid *grid, const gap_job *job, uint64_t *back)
{
    size_t const row_words = (size_t)grid->words_per_row;
    uint64_t const tail = bvxi_tail_mask(grid->size[0]);

    for (int32_t z = 0; z < grid->size[2]; z++)
        for (int32_t y = 0; y < grid->size[1]; y++) {
            size_t const at = ((size_t)z * (size_t)grid->size[1] + (size_t)y) * row_words;
            uint64_t *const roomy = job->words +
                                    ((size_t)z * (size_t)job->size[1] + (size_t)y) * (size_t)job->row_words;
            if (back == NULL) {
                memcpy(roomy, grid->words + at, row_words * 8);
            } else {
                memcpy(back + at, roomy, row_words * 8);
                /* Bits past the row's end stay 0. */
                back[at + row_words - 1] &= tail;
            }
        }
}

bvx_status bvxi_close_gaps(bvx_context *ctx, const char *function, bvx_grid *grid, int32_t gap,
                           uint64_t *pockets)
{
    gap_job job = {0};
    uint64_t bytes = 8;
    int ok = 1;

    for (int32_t a = 0; a < 3; a++) job.size[a] = grid->size[a] + gap;
    job.row_words = bvxi_row_words(job.size[0]);
    job.m = gap + 1;
    bytes = bvxi_mul(bytes, (uint64_t)job.row_words, &ok);
    bytes = bvxi_mul(bytes, (uint64_t)job.size[1], &ok);
    bytes = bvxi_mul(bytes, (uint64_t)job.size[2], &ok);
    if (!ok || bytes > SIZE_MAX)
        return bvxi_fail(ctx, BVX_ERR_BUDGET,
                         "closing gaps of %d voxels takes a grid beyond this machine's addresses",
                         (int64_t)gap);
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the grid for closing gaps", &job.words));
    copy_gap_rows(grid, &job, NULL);
    BVXI_TRY(run_gap_passes(ctx, &job, 0, 3));

    /* Set where the cube is locked in. */
    if (pockets != NULL) {
        bvx_grid places = {.words = job.words, .words_per_row = job.row_words};
        bvxi_pockets locked;

        memcpy(places.size, job.size, sizeof places.size);
        BVXI_TRY(bvxi_fill_pockets(ctx, function, &places, BVXI_CONNECT_6, 0, job.words, &locked));
        *pockets = locked.count;
    }
    BVXI_TRY(run_gap_passes(ctx, &job, 3, 6));
    copy_gap_rows(grid, &job, grid->words);
    bvxi_drop(ctx, job.words);
    return BVX_OK;
}
