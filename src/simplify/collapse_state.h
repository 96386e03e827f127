/* collapse_state.h - a mesh while its edges collapse, all of it or a cell only. Not installed. */
#ifndef BVXI_COLLAPSE_STATE_H
#define BVXI_COLLAPSE_STATE_H

#include "simplify/colours.h"
#include "simplify/corners.h"
#include "simplify/queue.h"
#include "simplify/room.h"
#include "simplify/star.h"

enum {
    /* While more than so many times the level are left, more triangles than are worth the trouble, and a
     * quarter more than the target, cells collapse on their own. */
    COLLAPSE_FAR = 3,
    COLLAPSE_NEAR = 20000
};

struct bvxi_collapse {
    bvx_context *ctx;
    const char *function;
    bvxi_collapse_options options;
    bvxi_corners mesh;
    bvxi_box_tree boxes;
    bvxi_queue queue;
    bvxi_colour_quadric *colour; /* of each vertex, or NULL */
    uint32_t *version;           /* of each vertex: grows when it moves */
    double scale;                /* quadrics measure lengths in units of 1 / scale, the mesh's size */
    double area;                 /* of the mesh as it was opened, in the same units */
    bvxi_collapse_counts counts;
    uint64_t packed; /* triangles when the mesh was packed last */
    uint64_t begun_vertices;
    unsigned char *nodes, *chunks;
    uint64_t node_bytes, chunk_bytes;
    const unsigned char *locked; /* of each vertex, not 0: its edges stay; NULL: none */
    bvxi_box bounds;             /* where some are locked: new positions stay within */
    int32_t dearest;             /* bucket; edges that cost more do not wait */
    bvxi_star star;              /* of the edge that is tried */
};

/* Nearest value of the type that positions have in the result. */
static inline double bvxi_collapse_rounded(const bvxi_collapse *c, double x)
{
    return c->options.position_type == BVX_F32 ? bvxi_nearest_float(x) : x;
}

/* Evaluate the edge opposite to a corner and let it wait. */
void bvxi_collapse_put(bvxi_collapse *c, int32_t corner);
/* The bucket of its cost. */
int32_t bvxi_collapse_bucket(const bvxi_collapse *c, int32_t corner);
/* Collapse an edge where that is safe, else put it back among those that cost four times as much. */
void bvxi_collapse_try(bvxi_collapse *c, bvxi_queue_entry *entry);

/* 1 while cells collapse on their own. */
int bvxi_collapse_is_far(const bvxi_collapse *c, uint64_t target, uint64_t level);
/* cell_collapse.c: collapse cheap edges within cells of space until the mesh is near a level or a target, or
 * hardly any is cheap. The mesh is packed then; boxes and queue are not set. */
bvx_status bvxi_collapse_cells(bvxi_collapse *c, uint64_t target, uint64_t level, double from, double to);

#endif
