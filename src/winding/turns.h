/* turns.h - by how many whole turns the sheet over holes moves what rows say, at all centres of a grid. Not
 * installed.
 *
 * With a sheet over its holes a mesh is closed, and rows along x give the turns N of both. The mesh alone has
 * N + w, w the sheet's solid angle in turns, and whole(N + w) = (N of the mesh) - (N of the sheet) +
 * whole(w): see winding.c, vote.c. */
#ifndef BVXI_TURNS_H
#define BVXI_TURNS_H

#include "winding/sheet.h"

/* Blocks of at most 32 voxels a side. */
enum { BVXI_TURNS_SIDE = 32, BVXI_TURNS_ROWS = BVXI_TURNS_SIDE * BVXI_TURNS_SIDE, BVXI_TURNS_LEVELS = 6 };

/* The crossings of one row, sorted: codes as in bvxi_crossing. */
typedef struct bvxi_row_codes {
    const int32_t *code;
    uint32_t count;
} bvxi_row_codes;

/* One worker's. Rows are numbered z * BVXI_TURNS_SIDE + y, voxels from the block's low corner. */
typedef struct bvxi_turns_block {
    const bvxi_sheet *sheet;
    bvxi_row_codes crossed[BVXI_TURNS_ROWS]; /* by the sheet */
    int32_t low[3], size[3];                 /* [Units: lattice voxels] */
    int32_t ties;                            /* 1: an angle of a half to 1e-8 is reported as such */
    int32_t want_clear;
    int32_t all_open;
    uint32_t open[BVXI_TURNS_ROWS]; /* centres that are requested, as bits along x */
    /* want_clear: of these, those nearer than a quarter to a whole number */
    uint32_t clear[BVXI_TURNS_ROWS];
    int32_t dirty; /* 0: turns are 0 everywhere */
    /* where the sheet has a tree: cells that bricks are too near to [Size: BVXI_TURNS_LEVELS * leaves] */
    uint32_t *pending;
    int32_t turns[BVXI_TURNS_ROWS * BVXI_TURNS_SIDE]; /* twice whole(w); odd for ties */
} bvxi_turns_block;

/* Number of a row of the block. */
static inline uint32_t bvxi_turns_row(int32_t y, int32_t z)
{
    return (uint32_t)(z * BVXI_TURNS_SIDE + y);
}

/* sheet_turns.c: turns, clear and dirty from the rest. Before: turns is all 0, and clear. */
void bvxi_sheet_block(bvxi_turns_block *block);

/* ---- sheet_rows.c: columns of blocks ---- */

typedef struct bvxi_turns_job bvxi_turns_job;

/* The rows of the block's column, voxels [x0, x1) of the window, are filled by a rule, stretch by stretch.
 * Turns of the block are theirs; where it is not dirty they may be several blocks without turns. With known
 * each stretch is one block, whose open is theirs too. mesh: crossings of the column's rows with the mesh,
 * where there are lists of it. */
typedef void bvxi_turns_rule_fn(const bvxi_turns_job *job, const bvxi_turns_block *block,
                                const bvxi_row_codes *mesh, int32_t x0, int32_t x1);

struct bvxi_turns_job {
    const bvxi_sheet *sheet;              /* with open edges */
    const bvx_grid *grid;                 /* rows along x: a block of rows of it is filled */
    const uint64_t *known;                /* where not NULL: centres that are not requested, words as grid */
    uint64_t *clear;                      /* where not NULL: gets those that are clear, words as grid */
    const bvxi_solid_job *solid;          /* the block of rows */
    const bvxi_row_lists *mesh, *crossed; /* mesh may be NULL */
    bvxi_turns_rule_fn *rule;
    int32_t ties;
    /* by column: rows that the mesh does not enter as often as leave; NULL without mesh */
    uint64_t *odd_rows;
    int32_t columns_y, columns;
    struct bvxi_turns_worker *worker; /* one a thread */
};

/* The first word of the grid's row at row (y, z) of the block. */
static inline uint64_t bvxi_turns_word(const bvxi_turns_job *job, const bvxi_turns_block *block, int32_t y,
                                       int32_t z)
{
    const bvx_grid *const g = job->grid;
    uint64_t const row = (uint64_t)(block->low[2] + z - g->low[2]) * (uint64_t)g->size[1] +
                         (uint64_t)(block->low[1] + y - g->low[1]);
    return row * (uint64_t)g->words_per_row;
}

/* Scratch: 170 KiB a worker, 8 bytes for 1024 rows. *odd: sum of odd_rows. */
bvx_status bvxi_turns_run(bvx_context *ctx, bvxi_turns_job *job, double from, double to, uint64_t *odd);

/* The sheet's triangles as a mesh over the vertices of view; 12 bytes a point of the loops. */
bvx_status bvxi_sheet_mesh_open(bvx_context *ctx, const bvx_mesh_view *view, const bvxi_holes *holes,
                                bvx_mesh_view *sheet);
void bvxi_sheet_mesh_close(bvx_context *ctx, bvx_mesh_view *sheet);

#endif
