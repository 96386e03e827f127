/* snap.h - a mesh's vertices on the fixed-point lattice, and for each how many rows of centres lie below it,
 * so that most triangles are known to cross none. Not installed. */
#ifndef BVXI_SNAP_H
#define BVXI_SNAP_H

#include "lattice/lattice.h"
#include "mesh/view.h"

enum { BVXI_MAX_CELL_SIDE = 65535 };

/* A block of rows of a lattice: [y0, y0 + ny) x [z0, z0 + nz), each side at most BVXI_MAX_CELL_SIDE. */
typedef struct bvxi_row_block {
    int32_t y0, ny, z0, nz;
} bvxi_row_block;

/* Vertices after snapping. cell: how many row centres of the block lie below the vertex, z << 16 | y. A
 * triangle covers no row centre of the block when its three cells agree in y or in z. */
typedef struct bvxi_snapped {
    int32_t *xyz;   /* [Size: vertex_count * 3 + 1] [Units: lattice fixed point] */
    uint32_t *cell; /* [Size: vertex_count] */
    uint64_t vertex_count;
    /* coordinates stand in the order x y z (0), y x z (1) or z x y (2): first the axis that rows run along */
    int32_t axis;
} bvxi_snapped;

/* Snap all vertices. A vertex that cannot be snapped is an error when a
 * triangle uses it. Scratch: 16 bytes a vertex. */
bvx_status bvxi_snap(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                     const bvx_lattice *lattice, bvxi_snapped *out);
/* (Re)compute the cells for a block. */
bvx_status bvxi_snap_cells(bvx_context *ctx, const bvx_lattice *lattice, const bvxi_row_block *block,
                           double progress, bvxi_snapped *s);
/* Bring the coordinates into the order for rows along an axis; cells are out of date then. */
bvx_status bvxi_snap_turn(bvx_context *ctx, int32_t axis, double progress, bvxi_snapped *s);
void bvxi_snap_free(bvx_context *ctx, bvxi_snapped *s);

/* Fixed-point steps a unit of the world, along each axis. */
bvx_status bvxi_snap_scale(bvx_context *ctx, const char *function, const bvx_lattice *lattice,
                           double scale[3]);

/* 1 when the vertex fits; a NaN fails both comparisons. */
static inline int bvxi_snap_vertex(const double p[3], const double origin[3], const double scale[3],
                                   int32_t q[3])
{
    int fits = 1;

    for (int32_t a = 0; a < 3; a++) {
        double const v = (p[a] - origin[a]) * scale[a];
        int const inside = v > 0.5 - BVXI_FIXED_LIMIT && v < BVXI_FIXED_LIMIT - 0.5;
        q[a] = bvxi_round_half_up(inside ? v : 0.0);
        fits &= inside;
    }
    return fits;
}

#endif
