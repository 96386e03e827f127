/* joint_fields.h - where the bodies of several labels are. Not installed. */
#ifndef BVXI_JOINT_FIELDS_H
#define BVXI_JOINT_FIELDS_H

#include "oblique/oblique.h"

enum {
    BVXI_JOINT_BODIES = 63, /* a bit each, and one for the outside */
    BVXI_JOINT_BEYOND = 3   /* the sign of vertices beyond the planes that all bodies end on */
};

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

#endif
