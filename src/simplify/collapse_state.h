/* collapse_state.h - a mesh while its edges collapse, all of it or a cell only: vertices, quadrics, queue,
 * tree of boxes; and the quadrics of colours. Only simplify/ includes this. Not installed. */
#ifndef BVXI_COLLAPSE_STATE_H
#define BVXI_COLLAPSE_STATE_H

#include "simplify/corners.h"
#include "simplify/queue.h"
#include "simplify/room.h"
#include "simplify/star.h"

/* ---- Quadrics of colours, for levels that keep the borders of colours ---- */

/* Of a vertex, about its position: sums over its triangles, by area w, of a
 * channel's value g x + d squared (a, b, c), and of gradients and values
 * themselves, by which the best colour of the vertex is taken out again. */
typedef struct bvxi_colour_quadric {
    double a[6], b[3], c;
    double g[3][3], d[3]; /* of each channel */
    double w;
} bvxi_colour_quadric;

/* Sums for all vertices, which are zeroed. colours: four bytes a vertex;
 * weight: length that a difference of 255 stands for, in units of 1 / scale. */
void bvxi_colours_start(const bvxi_corners *mesh, const uint8_t *colours, double weight, double scale,
                        bvxi_colour_quadric *at);
/* Both vertices' sums about u; offset leads from u to v. */
void bvxi_colours_join(const bvxi_colour_quadric *u, const bvxi_colour_quadric *v, const double offset[3],
                       bvxi_colour_quadric *both);
/* About a position that lies at an offset. */
void bvxi_colours_move(bvxi_colour_quadric *q, const double offset[3]);
/* Add what a vertex costs that has its best colour: a quadric of its position only. */
void bvxi_colours_add(const bvxi_colour_quadric *q, double a[6], double b[3], double *c);
/* Move the sums as bvxi_corners_pack moved vertices. */
void bvxi_colours_pack(bvxi_colour_quadric *at, uint64_t vertices, const uint32_t *moved);

/* ---- A mesh while its edges collapse, all of it or a cell only ---- */

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
