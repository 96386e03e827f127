/* turns.h - by how many whole turns the sheet over holes changes what rows say, for all centres of a grid:
 * columns of blocks, bricks of a block, and trees for very many holes. Not installed. */
#ifndef BVXI_TURNS_H
#define BVXI_TURNS_H

#include "winding/sheet.h"

/* ---- By how many whole turns the sheet over holes moves what rows say ---- */

/* With a sheet over its holes a mesh is closed, and rows along x give the turns N of both. The mesh alone has
 * N + w, w the sheet's solid angle in turns, and whole(N + w) = (N of the mesh) - (N of the sheet) +
 * whole(w): see winding.c, vote.c. */

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
    /* where the sheet has a tree: cells that bricks are too near to, and triangles, numbered behind all cells [Size:
     * BVXI_TURNS_LEVELS * pendings] */
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

/* ---- Bricks of a block of turns: cut into eight, settled as wholes, or centre by centre ---- */

typedef struct turns_brick {
    int32_t at[3], size[3]; /* within the block */
    int32_t side;
} turns_brick;

static inline uint32_t brick_bits(const turns_brick *b)
{
    return (b->size[0] == 32 ? UINT32_MAX : ((uint32_t)1 << b->size[0]) - 1) << b->at[0];
}

static inline int brick_is_open(const bvxi_turns_block *block, const turns_brick *b)
{
    uint32_t const bits = brick_bits(b);
    for (int32_t z = b->at[2]; z < b->at[2] + b->size[2]; z++)
        for (int32_t y = b->at[1]; y < b->at[1] + b->size[1]; y++)
            if ((block->open[bvxi_turns_row(y, z)] & bits) != 0) return 1;
    return 0;
}

static inline void set_turns(bvxi_turns_block *block, uint32_t row, int32_t x, int32_t whole, int clear)
{
    block->turns[row * BVXI_TURNS_SIDE + (uint32_t)x] = 2 * whole;
    if (whole != 0) block->dirty = 1;
    if (clear) block->clear[row] |= (uint32_t)1 << x;
}

static inline void settle_brick(bvxi_turns_block *block, const turns_brick *b, int32_t whole, int clear)
{
    uint32_t const bits = brick_bits(b);

    /* Blocks begin with turns of 0. */
    if (whole == 0 && !clear) return;
    for (int32_t z = b->at[2]; z < b->at[2] + b->size[2]; z++)
        for (int32_t y = b->at[1]; y < b->at[1] + b->size[1]; y++) {
            uint32_t const row = bvxi_turns_row(y, z);
            if (clear) block->clear[row] |= bits & block->open[row];
            for (int32_t x = b->at[0]; x < b->at[0] + b->size[0] && whole != 0; x++)
                set_turns(block, row, x, whole, 0);
        }
}

/* A tie is kept as one more or less than the doubled number: the rule decides which way it falls. */
static inline void put_answer(bvxi_turns_block *block, const bvxi_sheet_answer *a, int32_t x, int32_t y,
                              int32_t z)
{
    uint32_t const row = bvxi_turns_row(y, z);
    set_turns(block, row, x, a->whole, block->want_clear && a->clear);
    if (block->ties && a->tie != 0) {
        block->turns[row * BVXI_TURNS_SIDE + (uint32_t)x] = 2 * a->whole + a->tie;
        block->dirty = 1;
    }
}

/* What a centre says by itself. */
static inline void ask_centre(bvxi_turns_block *block, int32_t x, int32_t y, int32_t z)
{
    int64_t const step = (int64_t)1 << block->sheet->fraction_bits;
    int64_t const p[3] = {(block->low[0] + x) * step + step / 2, (block->low[1] + y) * step + step / 2,
                          (block->low[2] + z) * step + step / 2};
    bvxi_sheet_answer const a = bvxi_sheet_turns(block->sheet, p, block->want_clear);
    put_answer(block, &a, x, y, z);
}

/* Is the whole number nearest to turns, and on which side of a quarter they are, certain to rest? */
static inline int is_certain(const bvxi_turns_block *block, double turns, double rest, double *whole,
                             int *clear)
{
    double const n = floor(turns + 0.5), off = turns < n ? n - turns : turns - n;
    /* Certain means: the same whole number, and the same side of a quarter where that matters. */
    *whole = n;
    *clear = off < 0.25;
    return off + rest < 0.5 && (!block->want_clear || off + rest < 0.25 || off - rest > 0.25);
}

/* sheet_near.c: the middle of a brick, and how far its centres lie from it. */
double bvxi_turns_middle(const bvxi_turns_block *block, const turns_brick *b, int64_t p[3]);
/* 1 when all of the brick's centres have one whole number, and are clear or not, as its middle. */
int bvxi_turns_settled(const bvxi_turns_block *block, const turns_brick *b, const bvxi_sheet_look *look,
                       int32_t *whole, int *clear);
/* What the brick's middle says about the centre that lies h from it; 0 when that is not enough. */
int bvxi_turns_of_centre(const bvxi_turns_block *block, const bvxi_sheet_look *look, double reach2,
                         const double h[3], int32_t *whole, int *clear);

/* The eighths that have centres go to the stack. */
static inline void cut_brick(const turns_brick *b, turns_brick *stack, int32_t *count)
{
    int32_t const half = b->side / 2;

    for (int32_t i = 0; i < 8; i++) {
        turns_brick *const c = &stack[*count];
        int full = 1;
        c->side = half;
        for (int32_t a = 0; a < 3; a++) {
            /* At the block's end an eighth may be smaller, or have no centre at all. */
            int32_t const from = (i >> a & 1) * half, left = b->size[a] - from;
            c->at[a] = b->at[a] + from;
            c->size[a] = left < half ? left : half;
            full &= left > 0;
        }
        *count += full;
    }
}

/* ---- The triangles of a sheet over very many holes, in cells within cells ---- */

typedef struct bvxi_sheet_cell {
    double centre[3], radius; /* a ball that holds it [Units: the largest spacing] */
    double area;              /* of its triangles, each by itself */
    uint32_t first, end;      /* its triangles */
    /* the later half's number; the earlier half comes behind the cell. 0: no halves */
    uint32_t second;
    double moment[BVXI_SERIES_TERMS];
} bvxi_sheet_cell;

/* A triangle lies within width of its longest side, which runs from that corner to the next. */
typedef struct bvxi_sheet_shape {
    double area, width;
    uint32_t side;
} bvxi_sheet_shape;

struct bvxi_sheet_tree {
    bvxi_series_table table;
    bvxi_sheet_cell *cell;               /* the whole first */
    uint32_t *corner;                    /* points of the loops [Size: triangles * 3] */
    bvxi_sheet_shape *shape;             /* [Size: triangles] */
    uint64_t cells, triangles, pendings; /* entries of a brick's list at most */
};

/* *tree stays NULL where the sheet has few loops, or wide ones: sheet_turns.c is for these. Scratch: about
 * 250 bytes a triangle, and 24 meanwhile; a cell has 8 triangles at most and half a KiB. */
bvx_status bvxi_sheet_tree_open(bvx_context *ctx, const bvxi_sheet *sheet, bvxi_sheet_tree **tree);
void bvxi_sheet_tree_close(bvx_context *ctx, bvxi_sheet_tree *tree);

/* The sheet's angle at p, as bvxi_sheet_angle has it, to *error. Cells are
 * taken as wholes where they look smaller than q. */
double bvxi_sheet_tree_angle(const bvxi_sheet *sheet, const int64_t p[3], double q, double *error);

/* sheet.c: the angle of the triangles of some cells only, right to 1e-8. */
double bvxi_sheet_cells_angle(const bvxi_sheet *sheet, const int64_t p[3], const uint32_t *cells,
                              uint64_t count);
/* The same for four places. Places may repeat. */
void bvxi_sheet_cells_angles_four(const bvxi_sheet *sheet, const int64_t p[4][3], const uint32_t *cells,
                                  uint64_t count, double turns[4]);

/* The same around the place, as bvxi_sheet_around. */
void bvxi_sheet_cells_around(const bvxi_sheet *sheet, const int64_t p[3], const uint32_t *cells,
                             uint64_t count, double reach, double edge_rest, bvxi_sheet_look *look);

/* sheet_tree_turns.c: bvxi_sheet_block by the tree. */
void bvxi_sheet_tree_block(bvxi_turns_block *block);

#endif
