/* distance.h - how far meshes are apart, where several are compared with the same one. Not installed. */
#ifndef BVXI_DISTANCE_H
#define BVXI_DISTANCE_H

#include "nearest/closest.h"

/* The search tree of a mesh, kept from one comparison to the next. Zeroed: not built yet. */
typedef struct bvxi_distance_tree {
    bvxi_closest_tree tree;
    int32_t built;
} bvxi_distance_tree;

/* bvx_mesh_distance, the same bits. kept: a's tree, which is built where it is not, or where b needs another
 * scale. Memory beside it: as there, without a's tree. */
bvx_status bvxi_mesh_distance(bvx_context *ctx, const bvx_mesh_view *a, bvxi_distance_tree *kept,
                              const bvx_mesh_view *b, uint64_t samples, uint64_t seed,
                              bvx_distance_report *report);
void bvxi_distance_forget(bvx_context *ctx, bvxi_distance_tree *kept);

#endif
