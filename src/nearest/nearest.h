/* nearest.h - the closest points of a mesh for many centres of voxels at once, for other rooms: a mesh made
 * ready, bands, values. Not installed. */
#ifndef BVXI_NEAREST_H
#define BVXI_NEAREST_H

#include "core/core.h"
#include "grid/sparse.h"

/* A mesh made ready for questions from the centres of one lattice. It keeps the
 * view: its arrays must stay. One thread at a time asks (each question runs on
 * all workers). Memory: about 100 bytes a triangle, 120 while it is made. */
typedef struct bvxi_nearest bvxi_nearest;

/* Check the view (finite, indices in range, at least one triangle of area) and that doubles hold all centres
 * and distances (BVX_ERR_RANGE), and make it ready. */
bvx_status bvxi_nearest_open(bvxi_call call, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                             bvxi_nearest **nearest);
/* Only whether doubles hold all centres and distances. */
bvx_status bvxi_nearest_check(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                              const bvx_lattice *lattice);
void bvxi_nearest_close(bvx_context *ctx, bvxi_nearest *nearest);

/* From here on the answers do not depend on how triangles and corners are numbered or turned: of equally near
 * triangles the one whose plane is farthest from the centre is taken, where they share an edge or corner the
 * one that the centre sees most of; then the first by closest point and corners. Features are not requested
 * afterwards, as corners are put in an order of their own. */
void bvxi_nearest_prefer_planes(bvxi_nearest *nearest);

/* Set the words of band (a grid of the lattice or of a window, zeroed) where the centre lies no further than
 * width [Units: world] from the mesh, and count each row's: first[row] becomes the number of values before
 * the row [Size: rows + 1]. What was found is remembered, so filling in the values of centres of the band
 * costs no second search. Memory: 16 KiB for each 16 x 16 x 16 centres that the band reaches into, until
 * bvxi_nearest_close or the next band. */
bvx_status bvxi_nearest_band(bvxi_call call, const bvxi_nearest *nearest, double width, bvx_grid *band,
                             uint64_t *first);

/* The closest points of the set voxels of values, any set, in those of its columns that are there: vectors
 * from the centre to the point and distances, not negative [Units: world]. It is the least (distance squared,
 * triangle index) of the evaluation that bvx_closest_find makes at the centre. guess: most centres lie no
 * further than it from the mesh [Units: world]; infinity where nothing is known. It changes the time only.
 * Memory: 110 KiB a worker. */
bvx_status bvxi_nearest_fill(bvxi_call call, const bvxi_nearest *nearest, double guess,
                             const bvxi_sparse *values);

#endif
