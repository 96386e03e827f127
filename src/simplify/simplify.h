/* simplify.h - fewer triangles by collapsing edges: what other rooms may use. Not installed. */
#ifndef BVXI_SIMPLIFY_H
#define BVXI_SIMPLIFY_H

#include "core/core.h"

typedef struct bvxi_collapse bvxi_collapse;

/* What becomes of edges that have no two triangles running along them in opposite directions. */
enum {
    BVXI_BORDERS_REFUSED = 0,
    BVXI_BORDERS_KEPT = 1, /* edges with one triangle are borders; others are refused */
    BVXI_BORDERS_CUT = 2   /* all sides of such an edge are borders */
};

typedef struct bvxi_collapse_options {
    int32_t position_type; /* of the levels: new positions are rounded to it */
    double even; /* pull of every vertex towards the line along its normal: even triangles where it is flat */
    int32_t lenient; /* 1: the mesh may cross itself; no triangle crosses that none crossed before */
    int32_t simple;  /* 1: the mesh is known not to cross itself, which spares tests */
    int32_t borders; /* BVXI_BORDERS_...: what becomes of a mesh that is not closed */
    /* of the view's colours: what a difference of 255 stands for, to the mesh's longest side */
    double colour_weight;
} bvxi_collapse_options;

/* What became of the edges that were tried. */
typedef struct bvxi_collapse_counts {
    uint64_t collapsed, link, turned, needle, crossed, crumpled;
} bvxi_collapse_counts;

/* Take a checked view of a closed, manifold, oriented mesh, or of one with borders (BVX_ERR_ARGUMENT
 * otherwise). The order of its vertices and triangles does not matter where no two vertices are at one
 * position. Scratch: 160 bytes a triangle, 190 a vertex where colours have a weight, and 300 KB, until
 * bvxi_collapse_close. */
bvx_status bvxi_collapse_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                              const bvxi_collapse_options *options, bvxi_collapse **collapse);
/* Collapse the cheapest edges until at most target triangles are left or none can go. level: how many the
 * level will have, about, that this leads to; of a large mesh that is far from it edges go in parallel, with
 * about 1.3 MB of scratch a thread, which may leave fewer than target. from, to: share of progress. */
bvx_status bvxi_collapse_to(bvxi_collapse *collapse, uint64_t target, uint64_t level, double from, double to);
/* The mesh as it is now, opened as by bvxi_mesh_open. */
bvx_status bvxi_collapse_give(bvxi_collapse *collapse, bvx_mesh *level);
uint64_t bvxi_collapse_triangles(const bvxi_collapse *collapse);
const bvxi_collapse_counts *bvxi_collapse_tried(const bvxi_collapse *collapse);
void bvxi_collapse_close(bvxi_collapse *collapse);

#endif
