/* thicken.h - walls too thin for a lattice: widened until it holds them, then put back to the mesh. Not
 * installed. */
#ifndef BVXI_THICKEN_H
#define BVXI_THICKEN_H

#include "fill/thin_walls.h"
#include "grid/sparse.h"

/* Outside centres beside walls too thin for the lattice: where the wall ends when it is made thick enough. */
typedef struct bvxi_thin {
    /* The centres, before some were put inside; without words where no wall is thin. Distances, in floats:
     * how far off the mesh the thicker wall ends; below 0: of a sheet, as far as its size; 0: no wall is thin
     * [Units: largest spacings] */
    bvxi_sparse near;
    uint32_t *corner; /* of the body's triangles nearby, and a view of these */
    bvx_mesh_view mesh;
} bvxi_thin;

/* thicken.c: put centres to inside until the walls hold that bvxi_walls_ask
 * has found and listed there; walls->solid is inside. thin, all zero, takes
 * over what the surface needs. */
bvx_status bvxi_thicken(bvxi_walls *walls, bvx_grid *inside, bvxi_thin *thin);

/* Closest points that were measured, vectors and distances in doubles, become those of the thickened surface.
 * Nothing where no wall is thin. */
void bvxi_thin_values(const bvxi_thin *thin, const bvxi_sparse *values);
/* The same of one centre whose surface lies thick off the mesh, along the way to it. [Units: world] */
void bvxi_thin_value(double thick, double vector[3], double *distance);

/* A body of a surface: its thin walls, and what it fills. */
typedef struct bvxi_flat_body {
    const bvxi_thin *thin;
    const bvx_grid *solid; /* thickened; NULL: the surface is this body's, all of it */
} bvxi_flat_body;

enum { BVXI_FLAT_BODIES = 2 };

/* flatten.c: vertices of thickened walls go to where the meshes have them, as far as no triangles cross. A
 * vertex is of the bodies that differ at the ends of its edge. */
bvx_status bvxi_flatten(bvx_context *ctx, const char *function, const bvxi_flat_body *bodies, int32_t count,
                        bvx_mesh *mesh);
/* flatten.c: vertices go to places of their own as far as no triangles cross. number: of each vertex 0, or one
 * of 1 to count; to: of each [Size: vertices * 3]. window: around the mesh. The caller frees scratch. */
bvx_status bvxi_move_apart(bvx_context *ctx, const char *function, const bvx_grid *window, uint32_t *number,
                           uint64_t count, const double *to, bvx_mesh *mesh);

/* round_bars.c: bars of the solid inside, a few voxels thick, get the volume that body has there. The caller
 * frees scratch. */
bvx_status bvxi_round_bars(bvx_context *ctx, const char *function, const bvx_grid *inside,
                           const bvx_mesh_view *body, bvx_mesh *surface);

#endif
