/* surface_oracle.h - marching cubes cell by cell, with a number for every lattice edge, for tests.
 *
 * The case tables are proven elsewhere (test_tables.c); here each cell reads its eight corners one by one,
 * each vertex is found under its edge, and edges are numbered by walking them all in the order (z, y, axis,
 * x). */
#ifndef SURFACE_ORACLE_H
#define SURFACE_ORACLE_H

#include "bitvox_io.h"
#include "cell_tables.h"
#include "tools/mesh_maker.h"

typedef struct oracle_surface {
    double *positions; /* before any rounding to float */
    uint32_t *triangles;
    int32_t (*edge)[4]; /* of each vertex: lattice indices of its low end, axis */
    uint64_t vertices, triangle_count;
} oracle_surface;

typedef struct oracle_cells {
    const bvx_grid *grid;
    int32_t size[3];  /* places along each axis, from -1 to the window's size */
    uint32_t *number; /* of the edge at [z][y][axis][x] */
} oracle_cells;

static inline int oracle_voxel(const bvx_grid *g, int32_t x, int32_t y, int32_t z)
{
    if (x < 0 || y < 0 || z < 0 || x >= g->size[0] || y >= g->size[1] || z >= g->size[2]) return 0;
    return bvx_grid_get(g, x, y, z);
}

static inline size_t oracle_edge_place(const oracle_cells *c, const int32_t at[3], int32_t axis)
{
    size_t const row = (size_t)(at[2] + 1) * (size_t)c->size[1] + (size_t)(at[1] + 1);
    return (row * 3 + (size_t)axis) * (size_t)c->size[0] + (size_t)(at[0] + 1);
}

/* The low end of edge e of the cell at (x, y, z): x-edges 0..3 by (y, z),
 * y-edges by (x, z), z-edges by (x, y). */
static inline void oracle_edge_of_cell(const int32_t cell[3], int32_t e, int32_t at[3], int32_t *axis)
{
    int32_t const first = e % 4 % 2, second = e % 4 / 2;
    *axis = e / 4;
    at[0] = cell[0] + (*axis == 0 ? 0 : first);
    at[1] = cell[1] + (*axis == 0 ? first : *axis == 1 ? 0 : second);
    at[2] = cell[2] + (*axis == 2 ? 0 : second);
}

static inline int oracle_case(const bvx_grid *g, const int32_t cell[3])
{
    int n = 0;
    for (int c = 0; c < 8; c++)
        n |= oracle_voxel(g, cell[0] + (c & 1), cell[1] + (c >> 1 & 1), cell[2] + (c >> 2)) << c;
    return n;
}

/* Walk the visited cells in order; with numbers unset mark the edges they use, later write the triangles. */
static inline void oracle_walk(oracle_cells *c, const bvx_extract_options *o, oracle_surface *s)
{
    int32_t low[3], high[3], cell[3], at[3], axis;

    for (int a = 0; a < 3; a++) {
        low[a] = o->open_sides >> 2 * a & 1 ? 0 : -1;
        high[a] = c->grid->size[a] - (o->open_sides >> (2 * a + 1) & 1 ? 2 : 1);
    }
    s->triangle_count = 0;
    for (cell[2] = low[2]; cell[2] <= high[2]; cell[2]++)
        for (cell[1] = low[1]; cell[1] <= high[1]; cell[1]++)
            for (cell[0] = low[0]; cell[0] <= high[0]; cell[0]++) {
                int const n = oracle_case(c->grid, cell);
                for (int i = 0; i < 3 * bvxi_cell_triangle_count[o->face_rule][n]; i++) {
                    oracle_edge_of_cell(cell, bvxi_cell_triangle_vertex[o->face_rule][n][i], at, &axis);
                    if (s->triangles == NULL) c->number[oracle_edge_place(c, at, axis)] = 1;
                    else
                        s->triangles[3 * s->triangle_count + (uint64_t)i] =
                            c->number[oracle_edge_place(c, at, axis)];
                }
                s->triangle_count += bvxi_cell_triangle_count[o->face_rule][n];
            }
}

static inline oracle_surface oracle_extract(const bvx_grid *grid, const bvx_extract_options *o)
{
    oracle_cells c;
    oracle_surface s;
    size_t edges;
    int32_t at[3];

    memset(&s, 0, sizeof s);
    c.grid = grid;
    for (int a = 0; a < 3; a++) c.size[a] = grid->size[a] + 2;
    edges = (size_t)c.size[0] * (size_t)c.size[1] * (size_t)c.size[2] * 3;
    c.number = maker_grow(NULL, edges * sizeof *c.number);
    memset(c.number, 0, edges * sizeof *c.number);
    oracle_walk(&c, o, &s);
    for (size_t i = 0; i < edges; i++) s.vertices += c.number[i];
    s.positions = maker_grow(NULL, (size_t)(s.vertices + 1) * 3 * sizeof *s.positions);
    s.edge = maker_grow(NULL, (size_t)(s.vertices + 1) * sizeof *s.edge);
    s.triangles = maker_grow(NULL, (size_t)(s.triangle_count + 1) * 3 * sizeof *s.triangles);
    s.vertices = 0;
    for (at[2] = -1; at[2] <= grid->size[2]; at[2]++)
        for (at[1] = -1; at[1] <= grid->size[1]; at[1]++)
            for (int32_t axis = 0; axis < 3; axis++)
                for (at[0] = -1; at[0] <= grid->size[0]; at[0]++) {
                    uint32_t *const number = &c.number[oracle_edge_place(&c, at, axis)];
                    if (*number == 0) continue;
                    for (int a = 0; a < 3; a++) {
                        double const origin = o->local_frame ? 0.0 : grid->lattice.origin[a];
                        double const centre = (double)(grid->low[a] + at[a]) + 0.5;
                        s.positions[3 * s.vertices + (uint64_t)a] = origin +
                                                                    (centre + (a == axis ? 0.5 : 0.0)) *
                                                                        grid->lattice.spacing[a];
                        s.edge[s.vertices][a] = grid->low[a] + at[a];
                    }
                    s.edge[s.vertices][3] = axis;
                    *number = (uint32_t)s.vertices++;
                }
    oracle_walk(&c, o, &s);
    free(c.number);
    return s;
}

static inline void oracle_surface_free(oracle_surface *s)
{
    free(s->positions);
    free(s->triangles);
    free(s->edge);
    memset(s, 0, sizeof *s);
}

#endif
