/* solid.h - one block of rows being filled; shared by the solid's files. Not installed.
 *
 * The work goes in rounds. In a round each chunk of triangles writes its crossings into a buffer of its own,
 * sorted by tile of rows, until its triangles or its buffer end; then each tile takes what the chunks have
 * for it. No two workers write to one place, nothing is atomic, and memory does not grow with the
 * crossings. */
#ifndef BVXI_SOLID_H
#define BVXI_SOLID_H

#include "bits/bits.h"
#include "grid/grid.h"
#include "solid/covered_rows.h"
#include "solid/tiles.h"

enum { BVXI_SOLID_TILES = 32, BVXI_SOLID_CHUNKS = 64, BVXI_SOLID_BUFFER = 12288, BVXI_SOLID_LARGE = 1024 };

/* A row of the block (k << 16 | j) and where it is crossed: lattice index << 1 | leaving. */
typedef struct bvxi_crossing {
    uint32_t row;
    int32_t code;
} bvxi_crossing;

typedef struct bvxi_chunk {
    uint64_t next, end;    /* triangles still to do */
    uint64_t bad;          /* first with an index out of range, or UINT64_MAX */
    bvxi_crossing *sorted; /* [Size: the job's buffer] by tile */
    /* [Size: BVXI_SOLID_LARGE] triangles of many rows, left to the tiles */
    uint32_t *large;
    uint32_t large_count;
    uint32_t tile_end[BVXI_SOLID_TILES + 1]; /* tile t has sorted[tile_end[t] .. tile_end[t + 1]) */
} bvxi_chunk;

/* Where the rows of a block are crossed: codes of row r from row_end[r - 1] (0 for the first) to
 * row_end[r]. */
typedef struct bvxi_row_lists {
    uint64_t *row_end; /* [Size: rows] */
    int32_t *crossing; /* codes [Size: total] */
    uint64_t rows, total;
} bvxi_row_lists;

/* A mesh being filled. Rows run along axis; for axes other than 0 grid is a turned one (grid/turned_rows.h),
 * and where this folder says x, y, z the axis and the two across it are meant. */
typedef struct bvxi_solid_job bvxi_solid_job;
typedef bvx_status bvxi_take_lists_fn(bvx_context *ctx, bvxi_solid_job *job, const bvxi_row_lists *lists,
                                      double from, double to);

struct bvxi_solid_job {
    const char *function; /* for messages */
    const bvx_mesh_view *view;
    const bvx_grid *grid; /* words are written */
    bvxi_snapped snapped;
    bvxi_row_block block; /* [Units: lattice rows] */
    int32_t fraction_bits, fill, cpu, mode;
    const struct bvxi_holes *holes;       /* where not NULL: the loops that the fill looks at, found before */
    double progress_from, progress_share; /* of this block in the stage's progress */
    bvxi_chunk *chunk;
    int32_t chunks, rounds;         /* rounds: that the last pass took */
    int32_t last_round;             /* 1: after this one no triangles are left */
    struct bvxi_cross_batch *batch; /* one a worker */
    /* crossings that a chunk finds in a round at most, and triangles that are looked at together */
    uint32_t buffer, at_once;

    bvxi_tiles tiles;

    /* by row of the window: the last crossing's index, or INT32_MIN (BVXI_HIGHEST) */
    int32_t *highest;
    uint8_t *odd_rows; /* by row of the window, where not NULL: 1 when it does not balance (parity) */
    int32_t keep_odd;  /* 1: such rows stay as they are, filled behind their last crossing (parity) */
    uint8_t *beyond;   /* by row: parity of the crossings behind the window's last voxel */
    uint64_t crossings[BVXI_SOLID_TILES], unbalanced[BVXI_SOLID_TILES];
    int32_t summed; /* 1: the sums below are made (parity) */
    /* of the turns that crossings make and of the bits set: equal or opposite where both are one */
    uint64_t signed_sum, parity_sum;
    uint64_t tile_sums[BVXI_SOLID_TILES][2];

    uint8_t *listed;                /* lists are made for rows with listed[row] != 0 only (NULL: all rows) */
    bvxi_row_lists lists;           /* being made: row_end holds counts, then begins that move to the ends */
    bvxi_take_lists_fn *take_lists; /* where not NULL: a block is filled by it, from the lists of its rows */
    void *user;                     /* its own */
};

/* What the tiles do with a crossing: job->mode. */
enum { BVXI_TOGGLE = 0, BVXI_COUNT_LIST = 1, BVXI_FILL_LIST = 2, BVXI_HIGHEST = 3, BVXI_TOGGLE_SUMMED = 4 };

/* A worker's batch of pairs of a triangle and two by two centres of its box (crossings.c); triangles leave it some. */
enum { BVXI_CROSS_BATCH = 256, BVXI_CROSS_LEFT = 16, BVXI_CROSS_FEW = 16, BVXI_CROSS_MANY = 2048 };

typedef struct bvxi_cross_batch {
    uint32_t corner[3 * BVXI_CROSS_BATCH]; /* of the batch's triangles */
    uint16_t kept[BVXI_CROSS_BATCH];       /* triangles that cover */
    int32_t x[3][BVXI_CROSS_BATCH];        /* of their corners; at first their cells */
    /* their boxes */
    int32_t j0[BVXI_CROSS_BATCH], k0[BVXI_CROSS_BATCH], tall[BVXI_CROSS_BATCH], deep[BVXI_CROSS_BATCH];

    /* pairs: one for each kept triangle, then further ones: kept triangle, row of the first centre, corners relative
     * to it */
    uint16_t triangle[BVXI_CROSS_BATCH];
    uint32_t row[BVXI_CROSS_BATCH];
    int32_t y[3][BVXI_CROSS_BATCH], z[3][BVXI_CROSS_BATCH];
    double area[BVXI_CROSS_BATCH]; /* twice, positive when counter-clockwise */
    /* bit 0 the first centre, 1 the next along y, 2 along z, 3 along both: those in the box, those inside */
    uint8_t centres[BVXI_CROSS_BATCH];
    int64_t inside[BVXI_CROSS_BATCH];
    int32_t spread[BVXI_CROSS_BATCH];       /* bits of the corners' distances */
    uint16_t hit[4 * BVXI_CROSS_BATCH + 4]; /* pair << 2 | centre */
    uint32_t count, found_count;
    int32_t full;         /* 1: a triangle did not fit into found */
    bvxi_crossing *found; /* [Size: the job's buffer] of the chunk, in the order found */
} bvxi_cross_batch;

/* Number of row (j, k) of the block among those of the grid. */
static inline uint64_t bvxi_window_row(const bvxi_solid_job *job, int32_t j, int32_t k)
{
    const bvx_grid *const g = job->grid;
    uint64_t const y = (uint64_t)(job->block.y0 - g->low[1] + j);
    uint64_t const z = (uint64_t)(job->block.z0 - g->low[2] + k);
    return z * (uint64_t)g->size[1] + y;
}

/* Words of row (j, k) of the block inside the grid. */
static inline uint64_t *bvxi_block_words(const bvxi_solid_job *job, int32_t j, int32_t k)
{
    return job->grid->words + bvxi_window_row(job, j, k) * (uint64_t)job->grid->words_per_row;
}

static inline uint64_t bvxi_block_row(const bvxi_solid_job *job, int32_t j, int32_t k)
{
    return (uint64_t)k * (uint64_t)job->block.ny + (uint64_t)j;
}

/* A step of 1 at a voxel of a row, in a sum over all rows. Two sets of steps with one sum are the same but
 * for chance: 2^-64, and 2^-32 where their moments are the same, as the first half of the mixing is
 * linear. */
static inline uint64_t bvxi_step_sum(uint64_t row, int32_t x)
{
    uint64_t const m = (row << 24 ^ (uint64_t)x) * UINT64_C(0x9e3779b97f4a7c15);
    return m ^ m >> 32;
}

/* Progress of the stage at a fraction of the block's work. */
static inline double bvxi_solid_progress(const bvxi_solid_job *job, double fraction)
{
    return job->progress_from + job->progress_share * fraction;
}

/* A part of the stage's progress, for what fills with a job. */
static inline bvxi_call bvxi_solid_step(bvx_context *context, const bvxi_solid_job *job, double from,
                                        double to)
{
    return bvxi_call_of(context, job->function, "solid", from, to);
}

/* solid.c: make a mesh ready (snapped), fill the rows of a window along an axis, let go. bvxi_solid_fill
 * writes grid's words by the rule parity or nonzero; by below it leaves them and writes job->highest, which
 * the caller has set to INT32_MIN; with take_lists that writes them, and the counts of crossings are the
 * mesh's.
 * Counts are added to the report. */
bvx_status bvxi_solid_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                           const bvx_lattice *lattice, bvxi_solid_job *job);
bvx_status bvxi_solid_fill(bvxi_call step, bvxi_solid_job *job, const bvx_grid *grid, int32_t axis,
                           int32_t fill, bvx_solid_report *report);
void bvxi_solid_close(bvx_context *ctx, bvxi_solid_job *job);
/* crossings.c: a chunk's share of a round. */
void bvxi_find_crossings(void *job, int32_t chunk, int32_t worker);
/* triangle_rows.c: all crossings of a triangle with rows of the block, handed over one by one. */
typedef void bvxi_crossing_fn(void *sink, uint32_t row, int32_t code);
void bvxi_cover_spans(const bvxi_solid_job *job, bvxi_rows rows, uint32_t triangle, bvxi_crossing_fn *take,
                      void *sink);
/* solid_rounds.c: run rounds until all triangles are done, the tiles doing what mode says. */
bvx_status bvxi_solid_rounds(bvx_context *ctx, bvxi_solid_job *job, int32_t mode, double from, double to);
/* The same triangles once more in another mode; where one round was enough
 * the chunks still hold all crossings. */
bvx_status bvxi_solid_again(bvx_context *ctx, bvxi_solid_job *job, int32_t mode, double from, double to);
/* solid_rows.c: make the lists of the rows of the block being filled, not sorted; let go of them. */
bvx_status bvxi_solid_gather(bvx_context *ctx, bvxi_solid_job *job, double from, double to,
                             bvxi_row_lists *lists);
void bvxi_row_lists_free(bvx_context *ctx, bvxi_row_lists *lists);
/* Fill listed rows from their lists by the job's rule; from: of the block's progress. */
bvx_status bvxi_solid_lists(bvx_context *ctx, bvxi_solid_job *job, double from);

/* ---- What a lattice shows of a mesh as a whole ---- */

/* edge_balance.c: do triangles run along each edge of the snapped mesh (axis 0) as often one way as the
 * other? Refuses indices beyond the vertices. Scratch: 4 bytes a vertex. */
bvx_status bvxi_edges_balance(bvx_context *ctx, const bvxi_solid_job *job, double at, int32_t *balanced);

/* row_depths.c: how often the rows of a whole lattice lie inside a mesh.
 * Scratch: 8 bytes a row, 4 a crossing. */
/* some voxel 1 deep; some -1; some beyond either */
enum { BVXI_DEPTH_UP = 1, BVXI_DEPTH_DOWN = 2, BVXI_DEPTH_DEEP = 4 };
bvx_status bvxi_row_depths(bvx_context *ctx, bvxi_solid_job *job, const bvx_lattice *lattice, double from,
                           double to, int32_t *depths);

#endif
