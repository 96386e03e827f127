/* shift.h - parts of neighbouring sections joined by shifting: sections put in between, on which each part is
 * moved. Not installed. */
#ifndef BVXI_SHIFT_H
#define BVXI_SHIFT_H

#include "contours/mend.h"

/* What one loop encloses, holes in it filled. */
typedef struct bvxi_disc {
    bvxi_plane view; /* the segments of the loop alone */
    double box[4];   /* low u, low v, high u, high v */
    double centre[2];
    double area, width; /* width: four areas over the border, the diameter of a circle */
    uint32_t hint;      /* a segment near to the last place */
    uint32_t depth;     /* how many loops it lies in */
    uint32_t group;
    uint32_t next; /* disc of its group on its plane, or BVXI_NONE */
} bvxi_disc;

/* The discs of a plane. */
typedef struct bvxi_discs {
    const bvxi_plane *plane;
    bvxi_disc *disc;
    uint32_t count;
} bvxi_discs;

/* Discs of both planes that become each other; one plane may have none, where they end. */
typedef struct bvxi_disc_group {
    uint32_t first[2], count[2]; /* discs of either plane */
    uint32_t depth;
    double by[2]; /* from the centre below to that above; 0 where they are not shifted */
    double deep;  /* of a group that ends: how deep its inside is at most */
    double box[2][4];
} bvxi_disc_group;

typedef struct bvxi_disc_groups {
    bvxi_disc_group *group;
    uint32_t count, depths; /* depths: one more than the deepest */
    uint32_t steps;         /* stretches that the way between the planes is split into */
    uint32_t shifted;       /* groups that are moved */
    double width;           /* of the thinnest of these */
} bvxi_disc_groups;

/* ---- shift_discs.c ---- */

bvx_status bvxi_discs_open(const bvxi_stack *stack, const bvxi_plane *plane, bvxi_discs *discs);
/* Which discs of two planes become each other, and by how much they move. */
bvx_status bvxi_disc_groups_open(const bvxi_stack *stack, bvxi_discs on[2], bvxi_disc_groups *groups);
/* Signed distance of a group's discs on plane k, positive inside. */
double bvxi_disc_group_distance(bvxi_discs on[2], const bvxi_disc_group *group, int k, double u, double v);

/* ---- shift.c ---- */

/* ---- shift.c ---- */

/* A stack with sections put in where parts are shifted. */
typedef struct bvxi_shifted {
    bvxi_mended body; /* its positions are those below */
    double *positions;
    uint64_t position_room;
    uint64_t sections, parts; /* put in; pairs of parts that were moved */
} bvxi_shifted;

/* stack: ready; close the result also after a failure. */
bvx_status bvxi_shift_stack(const bvxi_stack *stack, bvxi_shifted *to);

#endif
