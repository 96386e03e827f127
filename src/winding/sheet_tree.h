/* sheet_tree.h - the triangles of a sheet over very many holes, in cells within cells. Not installed. */
#ifndef BVXI_SHEET_TREE_H
#define BVXI_SHEET_TREE_H

#include "winding/turns.h"
#include "winding/sheet_series.h"

typedef struct bvxi_sheet_cell {
    double centre[3], radius; /* a ball that holds it [Units: the largest spacing] */
    double area;              /* of its triangles, each by itself */
    uint32_t first, end;      /* its triangles */
    /* the later half's number; the earlier half comes behind the cell. 0: no halves */
    uint32_t second;
    double moment[BVXI_SERIES_TERMS];
} bvxi_sheet_cell;

struct bvxi_sheet_tree {
    bvxi_series_table table;
    bvxi_sheet_cell *cell; /* the whole first */
    uint32_t *corner;      /* points of the loops [Size: triangles * 3] */
    uint64_t cells, leaves, triangles;
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

/* sheet_tree_turns.c: bvxi_sheet_block by the tree. */
void bvxi_sheet_tree_block(bvxi_turns_block *block);

#endif
