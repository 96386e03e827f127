/* joint.h - the bodies of several labels at once, such that where two touch their faces are the same. Not
 * installed.
 *
 * A joint bvxi_oblique has all bodies' contours on its planes and each body by itself in `body`; the kind of
 * a place is 0 outside of all, else which of the bodies it is in, from 1. Vertices of its tetrahedra have
 * their kind as value; a sign of 0 says that they lie between kinds. */
#ifndef BVXI_JOINT_H
#define BVXI_JOINT_H

#include "section/oblique.h"

enum {
    BVXI_JOINT_BODIES = 63, /* a bit each, and one for the outside */
    BVXI_JOINT_BEYOND = 3   /* the sign of vertices beyond the planes that all bodies end on */
};

/* What is made of a joint bvxi_oblique. */
typedef struct bvxi_joint_cut {
    uint64_t *among; /* [vertices] a bit for each kind that a vertex lies between */
    uint8_t *kind;   /* [tetrahedra] */
    uint64_t among_room, kind_room;
} bvxi_joint_cut;

/* joint_fields.c: the bodies' own numbers, then all contours on one set of planes. */
bvx_status bvxi_joint_open(bvxi_oblique *o, const int32_t *labels, uint32_t count);
/* 1: beyond a plane that all bodies end on; what lies on it, as plane says, is not. Planes that end all are
 * parallel, so that one plane is enough. */
int bvxi_joint_is_beyond(const bvxi_oblique *o, uint32_t plane, const double at[3]);
/* The kind at a place; plane: on which it lies, or BVXI_NONE; heard: the planes with a say there, NULL:
 * all. */
int bvxi_joint_kind(const bvxi_oblique *o, uint32_t plane, const double at[3], const uint32_t *heard,
                    uint32_t count);
/* The same of some kinds only. */
int bvxi_joint_kind_among(const bvxi_oblique *o, const double at[3], uint64_t kinds);
/* How much more a place is of some bodies than of other kinds. */
double bvxi_joint_lead(const bvxi_oblique *o, uint32_t plane, const double at[3], uint64_t bodies,
                       uint64_t others);

/* joint_cut.c: every tetrahedron gets a kind. */
bvx_status bvxi_joint_cut_all(bvxi_oblique *o, bvxi_joint_cut *cut);
/* What is beyond a face without a neighbour: cells of one kind. */
int bvxi_joint_border_kind(const bvxi_oblique *o, const bvxi_tetra *t, int corner);

/* joint_surface.c: each body's faces as a mesh, in the order of the bodies. */
bvx_status bvxi_joint_surfaces(bvxi_oblique *o, bvxi_joint_cut *cut, bvx_mesh *meshes);

#endif
