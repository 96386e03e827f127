/* patches.h - which triangles of a mesh run the other way round than those beside them. Not installed. */
#ifndef BVXI_PATCHES_H
#define BVXI_PATCHES_H

#include "core/core.h"

/* A patch hangs together through edges of two triangles, a part through edges of any number. Triangles with
 * two corners at one position belong to none, and are patches and parts of their own here. */
typedef struct bvxi_patches {
    uint32_t *part; /* of each triangle: the least one of its part [Size: triangles] */
    uint8_t *turn;  /* by triangle, 1: it is turned round [Size: triangles] */
    uint64_t triangles;
    uint64_t turned;       /* triangles that are */
    uint64_t unorientable; /* patches whose triangles no turning makes run the same way round */
    uint64_t odd_edges;    /* edges with an odd number of triangles */
    /* after turning: by how many more triangles run along edges one way than the other */
    uint64_t open_edges;
    /* after turning: those of three triangles or more, or of two that run along them the same way */
    uint64_t refused_edges;
    uint32_t refused[2]; /* the first one's corners */
} bvxi_patches;

/* Find what to turn so that the triangles of each patch run the same way round, as most of them do. Where no
 * side has five eighths of them, the volume that they enclose about centre becomes positive. representative:
 * weld.h. The view's indices have been checked. Scratch: beside the result 84 bytes a triangle, while it
 * works.
 * Cost: O(triangles). Guarantee: what is turned follows from the triangles; for a patch of halves that
 * encloses nothing from sums in their order. */
bvx_status bvxi_patches_open(bvx_context *ctx, const bvx_mesh_view *view, const uint32_t *representative,
                             const double centre[3], bvxi_patches *patches);
void bvxi_patches_close(bvx_context *ctx, bvxi_patches *patches);

/* The triangles, those of patches->turn turned round. index [Size: triangles * 3] */
void bvxi_patches_turn(const bvx_mesh_view *view, const bvxi_patches *patches, uint32_t *index,
                       bvx_mesh_view *turned);

/* Six times the volume of triangle t about centre, positive where it is
 * seen from outside, as it stands in the view. */
double bvxi_patches_volume(const bvx_mesh_view *view, uint64_t t, const double centre[3]);

#endif
