/* mend.h - loops that touch or cross, split so that none do; paths along the edges of loops that touched
 * or crossed, and their stops. Not installed. */
#ifndef BVXI_MEND_H
#define BVXI_MEND_H

#include "contours/section.h"

/* ---- Loops that touch or cross, split so that none do ---- */

/* A stack whose loops neither cross nor touch, once its points are moved
 * apart in fixed point by their nudges. */
typedef struct bvxi_mended {
    bvx_context *ctx;
    const char *function;
    bvx_sections sections; /* arrays of its own, but for the positions */
    int16_t (*nudge)[2];   /* of each point, in steps of its fixed point */
    uint64_t nudge_room;
    uint64_t loops;         /* that were changed or left out */
    bvxi_section_grid grid; /* whose fixed point decided */
} bvxi_mended;

/* least: how long steps of fixed point are at least. */
bvx_status bvxi_mend(bvx_context *ctx, const char *function, const bvx_sections *given,
                     const bvx_sections_options *options, double least, bvxi_mended *mended);
/* The same for planes that each have a normal. Points are moved themselves; other labels stay as they are. */
bvx_status bvxi_mend_planes(bvx_context *ctx, const char *function, const bvx_sections *given,
                            const bvx_sections_options *options, bvxi_mended *mended);

/* ---- mend_split.c: a section's segments, split until they meet at their ends alone ---- */

typedef struct bvxi_mend_node {
    int32_t q[2];
    double at[3];
    uint32_t loop, visits; /* the first loop that comes here, and how often loops do */
} bvxi_mend_node;

typedef struct bvxi_mend_edge {
    uint32_t node[2];
    uint32_t loop;
} bvxi_mend_edge;

typedef struct bvxi_mend_edges {
    bvxi_mend_edge *at;
    uint32_t count;
    uint64_t room;
} bvxi_mend_edges;

typedef struct bvxi_mend_split {
    uint32_t edge, node;
} bvxi_mend_split;

typedef struct bvxi_mend_work {
    bvxi_stack *s;
    const bvxi_plane *plane;
    uint8_t *changed; /* of each loop */
    bvxi_mend_node *node;
    bvxi_mend_edges edge, split_edge;
    bvxi_mend_split *split;
    uint32_t node_count, split_count;
    uint64_t node_room, split_room;
    uint32_t crossings; /* pairs that cross, in the last look */
    int cross;          /* 1: they are split there, 0: only counted */
    uint64_t *key;
    uint32_t *order;
    bvxi_segment_box *box;
    uint64_t order_room, box_room; /* order_room: of key too */
    bvxi_map *map;                 /* nodes by their places */
} bvxi_mend_work;

/* ---- mend_trace.c: loops along the edges that are left ---- */

/* Edges of changed loops that lie on each other an even number of times go;
 * what remains becomes loops of the stack. */
bvx_status bvxi_mend_trace(bvxi_mend_work *work, bvxi_mended *mended);
bvx_status bvxi_mended_add_loop(bvxi_mended *mended, uint32_t section, int32_t label);
bvx_status bvxi_mended_add_point(bvxi_mended *mended, const double at[3], int32_t u, int32_t v);

#endif
