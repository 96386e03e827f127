/* joint.h - the bodies of several labels at once, such that where two touch their faces are the same. Not
 * installed.
 *
 * A joint bvxi_oblique has all bodies' contours on its planes and each body by itself in `body`; the kind of
 * a place is 0 outside of all, else which of the bodies it is in, from 1. Vertices of its tetrahedra have
 * their kind as value; a sign of 0 says that they lie between kinds. */
#ifndef BVXI_JOINT_H
#define BVXI_JOINT_H

#include "oblique/oblique.h"

typedef struct bvxi_joint_cut {
    uint64_t *among; /* [vertices] a bit for each kind that a vertex lies between */
    uint8_t *kind;   /* [tetrahedra] */
    uint64_t among_room, kind_room;
} bvxi_joint_cut;

/* joint_cut.c: every tetrahedron gets a kind. */
bvx_status bvxi_joint_cut_all(bvxi_oblique *o, bvxi_joint_cut *cut);
/* What is beyond a face without a neighbour: cells of one kind. */
int bvxi_joint_border_kind(const bvxi_oblique *o, const bvxi_tetra *t, int corner);

/* joint_surface.c: each body's faces as a mesh, in the order of the bodies. */
bvx_status bvxi_joint_surfaces(bvxi_oblique *o, bvxi_joint_cut *cut, bvx_mesh *meshes);

#endif
