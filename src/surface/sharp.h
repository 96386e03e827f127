/* sharp.h - sharp edges and corners of a field's surface: loops of cells that get a vertex inside the cell,
 * and the passes that find, place and join these. Not installed. */
#ifndef BVXI_SHARP_H
#define BVXI_SHARP_H

#include "core/vec3.h"
#include "surface/cells.h"
#include "surface/field_surface.h"

#include <math.h>

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

/* The loops of a cell by its case; triangles are the cell's, in the table's order. */
void bvxi_trace_cell(int32_t face_rule, uint32_t cell_case, const uint32_t *triangles,
                     bvxi_cell_loops *loops);
/* The cell's face, 2 axis + side, that holds both edges. */
int32_t bvxi_face_of_edges(uint8_t one, uint8_t two);
/* 1 when all four edges of the face are cut. */
int bvxi_face_is_cut_twice(uint32_t cell_case, int32_t face);

typedef struct bvxi_apex_plane {
    double n[3], d; /* n.x = d, n of unit length */
} bvxi_apex_plane;

/* The point of the box [-half, half] with the least sum of squared
 * distances to the planes; where they leave it free, next to middle. */
void bvxi_apex(const bvxi_apex_plane *planes, int32_t count, const double middle[3], const double half[3],
               double apex[3]);

/* 1 only when the triangles surely have no common point. */
int bvxi_triangles_apart(const double one[3][3], const double two[3][3]);

/* From the surface by cuts, which is left as it is, to one with sharp edges and corners, opened by this.
 * report: the three counts of sharp are filled. */
bvx_status bvxi_sharpen(bvx_context *ctx, const bvxi_march *march, const bvxi_cuts *cuts, double least_cosine,
                        bvx_mesh *surface, bvx_field_surface_report *report);

/* ---- What the passes of sharp.c share: cells of a row with their loops, vertices, normals ---- */

/* A loop that is sharp. */
typedef struct bvxi_sharp_loop {
    double apex[3];  /* as written */
    uint32_t before; /* apexes kept before this one */
    int32_t x;       /* of the cell's low corner */
    uint8_t loop;    /* of the cell */
    uint8_t alone;   /* 1: the cell has one loop */
    uint8_t kept;
    uint8_t turned; /* bit a: the side on the face towards +a */
} bvxi_sharp_loop;

typedef struct bvxi_sharp_work {
    const bvxi_march *march;
    const bvxi_cuts *cuts;
    double least_cosine;
    uint32_t *first;        /* number of a slot's first loop [Size: slot_count + 1] */
    bvxi_sharp_loop *loops; /* in order of slots, cells, loops [Size: first[slot_count]] */
    uint64_t *counts;       /* [Size: pieces] turned sides */
    bvx_mesh *surface;
} bvxi_sharp_work;

/* sharp_cells.c: count each slot's sharp loops in first; then, first being numbers, fill them. */
void bvxi_sharp_count_piece(void *work, uint64_t begin, uint64_t end);
void bvxi_sharp_fill_piece(void *work, uint64_t begin, uint64_t end);
typedef struct bvxi_cell_walk {
    const bvxi_march *march;
    const uint64_t *row[4];
    bvxi_cell_words words;
    uint64_t active;
    uint32_t triangle, cell_case; /* of the current cell: first triangle, case */
    int32_t j, k, w, x;
} bvxi_cell_walk;

static inline void bvxi_start_cells(const bvxi_march *m, uint64_t slot, bvxi_cell_walk *c)
{
    memset(c, 0, sizeof *c);
    c->march = m;
    c->w = -1;
    c->triangle = m->slots[slot].triangle;
    bvxi_slot_row(m, slot, &c->j, &c->k);
    bvxi_cell_rows(m, c->j, c->k, c->row);
}

/* To the next cell with triangles; 0 after the last. */
static inline int bvxi_next_cell(bvxi_cell_walk *c)
{
    const bvxi_march *const m = c->march;

    if (c->w >= 0) c->triangle += bvxi_cell_triangle_count[m->options.face_rule][c->cell_case];
    if (!bvxi_slot_has(m, 3, c->j, c->k)) return 0;
    while (c->active == 0) {
        if (++c->w == m->edge_words) return 0;
        c->cell_case = 0;
        bvxi_load_cells(c->row, c->w, m->grid->words_per_row, &c->words);
        c->active = bvxi_active_cells(&c->words) & bvxi_visited(m, c->w);
    }
    c->x = c->w * 64 + bvxi_lowest(c->active) - 1;
    c->cell_case = bvxi_cell_case(&c->words, bvxi_lowest(c->active));
    c->active &= c->active - 1;
    return 1;
}

static inline void bvxi_trace_walked(const bvxi_cell_walk *c, bvxi_cell_loops *loops)
{
    bvxi_trace_cell(c->march->options.face_rule, c->cell_case,
                    c->march->mesh->triangles + 3 * (size_t)c->triangle, loops);
}

static inline void bvxi_sharp_vertex(const bvxi_march *m, uint32_t vertex, double p[3])
{
    for (size_t a = 0; a < 3; a++)
        p[a] = m->options.position_type == BVX_F32
                   ? (double)((const float *)m->mesh->positions)[3 * (size_t)vertex + a]
                   : ((const double *)m->mesh->positions)[3 * (size_t)vertex + a];
}

/* The outward normal of the facet at a vertex; 0 where none is known. */
static inline int bvxi_sharp_normal(const bvxi_sharp_work *w, uint32_t vertex, double n[3])
{
    const bvxi_facet_plane *const p = &w->cuts->planes[2 * (size_t)vertex];
    for (int32_t a = 0; a < 3; a++) n[a] = (double)p->n[a];
    return n[0] != 0.0 || n[1] != 0.0 || n[2] != 0.0;
}

/* The unit normal of a triangle; 0 without area. */
static inline int bvxi_normal_of(const double a[3], const double b[3], const double c[3], double unit,
                                 double n[3])
{
    double u[3], v[3], length;

    for (int k = 0; k < 3; k++) {
        u[k] = (b[k] - a[k]) / unit;
        v[k] = (c[k] - a[k]) / unit;
    }
    bvxi_vec_cross(u, v, n);
    length = bvxi_vec_length(n);
    if (!(length > 0.0)) return 0;
    for (int k = 0; k < 3; k++) n[k] /= length;
    return 1;
}

#endif
