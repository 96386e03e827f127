/* sharp.h - sharp edges and corners of a field's surface: vertices inside cells. Not installed. */
#ifndef BVXI_SHARP_H
#define BVXI_SHARP_H

#include "surface/field_surface.h"

enum { BVXI_CELL_LOOPS = 4, BVXI_LOOP_CORNERS = 12 };

/* One closed loop in which the surface leaves a cell, in the direction of its triangles. */
typedef struct bvxi_cell_loop {
    int32_t corners;
    uint8_t edge[BVXI_LOOP_CORNERS];    /* of the cell, numbered as in tables.h */
    uint32_t vertex[BVXI_LOOP_CORNERS]; /* of the mesh */
    uint32_t first, triangles;          /* of the cell's triangles */
} bvxi_cell_loop;

typedef struct bvxi_cell_loops {
    int32_t count;
    bvxi_cell_loop loop[BVXI_CELL_LOOPS];
} bvxi_cell_loops;

/* ---- cell_loops.c ---- */

/* The loops of a cell by its case; triangles are the cell's, in the table's order. */
void bvxi_trace_cell(int32_t face_rule, uint32_t cell_case, const uint32_t *triangles,
                     bvxi_cell_loops *loops);
/* The cell's face, 2 axis + side, that holds both edges. */
int32_t bvxi_face_of_edges(uint8_t one, uint8_t two);
/* 1 when all four edges of the face are cut. */
int bvxi_face_is_cut_twice(uint32_t cell_case, int32_t face);

/* ---- nearest_to_planes.c ---- */

typedef struct bvxi_apex_plane {
    double n[3], d; /* n.x = d, n of unit length */
} bvxi_apex_plane;

/* The point of the box [-half, half] with the least sum of squared
 * distances to the planes; where they leave it free, next to middle. */
void bvxi_apex(const bvxi_apex_plane *planes, int32_t count, const double middle[3], const double half[3],
               double apex[3]);

/* ---- disjoint_triangles.c ---- */

/* 1 only when the triangles surely have no common point. */
int bvxi_triangles_apart(const double one[3][3], const double two[3][3]);

/* ---- sharp.c ---- */

/* From the surface by cuts, which is left as it is, to one with sharp edges and corners, opened by this.
 * report: the three counts of sharp are filled. */
bvx_status bvxi_sharpen(bvx_context *ctx, const bvxi_march *march, const bvxi_cuts *cuts, double least_cosine,
                        bvx_mesh *surface, bvx_field_surface_report *report);

#endif
