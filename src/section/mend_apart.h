/* mend_apart.h - paths along the edges of loops that touched or crossed, and their stops. Not installed. */
#ifndef BVXI_SECTION_MEND_APART_H
#define BVXI_SECTION_MEND_APART_H

#include "section/mend.h"

/* A stop of a path: the node, and the ends of edges by which it came and went. */
typedef struct bvxi_mend_stop {
    uint32_t node, in, out;
} bvxi_mend_stop;

/* All paths of a plane: loops that come to no node twice. */
typedef struct bvxi_mend_paths {
    const bvxi_mend_work *w;
    const uint32_t *edge; /* kept ones; ends are numbered 2 * edge, 2 * edge + 1 */
    const uint32_t *rank; /* of each end: where it stands in its node's turn, counter-clockwise */
    const bvxi_mend_stop *stop;
    const uint32_t *loop; /* where each loop's stops begin */
    uint32_t stop_count, loop_count;
} bvxi_mend_paths;

/* From an end of a kept edge to its other one. */
void bvxi_mend_direction(const bvxi_mend_work *work, const uint32_t *edge, uint32_t end, int64_t d[2]);
/* The middle of the angle from one end counter-clockwise to another, of length 1 or 0; returns
 * the cosine of half of it. */
double bvxi_mend_middle(const bvxi_mend_paths *paths, uint32_t from, uint32_t to, double middle[2]);

/* By how many steps each stop moves. stays: of each node, the stop that does not. */
bvx_status bvxi_mend_apart(const bvxi_mend_paths *paths, const uint32_t *stays, int16_t (*nudge)[2]);

#endif
