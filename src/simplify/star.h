/* star.h - what one collapse changes: the triangles around an edge, before and after. Not installed.
 *
 * Source: link condition after Dey, Edelsbrunner, Guha, Nekhayev. Topology preserving edge contraction. 1999.
 */
#ifndef BVXI_STAR_H
#define BVXI_STAR_H

#include "simplify/box_tree.h"
#include "simplify/corners.h"

enum {
    BVXI_STAR_MOST =
        512 /* triangles around the new vertex, or around one of its neighbours; an edge with more stays */
};

/* The triangles around a vertex, counter-clockwise: triangle i faces along normal[i]
 * and runs from around[i] to around[i + 1]. Around a vertex of a border they begin
 * and end at the border; while a fan is gathered, around is NULL where the ghost is. */
typedef struct bvxi_fan {
    int32_t count;
    int32_t open;                         /* 1: from border to border */
    double normal[BVXI_STAR_MOST + 2][3]; /* twice the triangle's area long */
    const double *around[BVXI_STAR_MOST + 3];
    int32_t triangle[BVXI_STAR_MOST + 2]; /* of the mesh; those that are new have none */
} bvxi_fan;

/* Two planes of a new triangle: its own, and through its outer edge upright
 * on it. Positions are seen from the new vertex. */
typedef struct bvxi_star_planes {
    double normal[3], out[3];
    double normal_size, out_size; /* sums of sizes */
    double limit;                 /* the triangle's corners are at most so far along out, within rounding */
} bvxi_star_planes;

/* The edge opposite to corner `edge` from vertex u to v becomes one vertex at p. Triangle i of the new star
 * runs from p to link[i] and link[i + 1] and takes the place of the old triangle that corner[i] is in. */
typedef struct bvxi_star {
    int32_t edge;
    uint32_t u, v;
    int32_t count;
    int32_t needles; /* 1: new triangles may be needles */
    int32_t lenient; /* 1: what an old triangle crosses, a new one may */
    double p[3];
    uint32_t link[BVXI_STAR_MOST + 12];    /* the first one again at the end, then anything */
    int32_t corner[BVXI_STAR_MOST];        /* of u or v, opposite to the edge from link[i] to link[i + 1] */
    double normal[BVXI_STAR_MOST][3];      /* of the new triangles, twice their area long */
    bvxi_box box[BVXI_STAR_MOST];          /* of the new triangles */
    bvxi_box_facing faces[BVXI_STAR_MOST]; /* what they face, where the tree says what triangles face */
    bvxi_star_planes planes[BVXI_STAR_MOST];
    double reach; /* no point of the star is further from its new vertex, axes summed */
    bvxi_facing facing[BVXI_STAR_MOST],
        own_facing; /* of the link's vertices and the new one, after the collapse */
    bvxi_box_node node[BVXI_STAR_MOST / BVXI_BOX_WIDTH]; /* the boxes again, eight to a node */
    bvxi_fan fan;                                        /* while one is judged */
    int32_t ghost; /* link[ghost] is the ghost, -1: the new vertex is on no border */
} bvxi_star;

/* Why an edge stays. */
enum {
    BVXI_STAR_SAFE = 0,
    BVXI_STAR_LINK = 1,
    BVXI_STAR_TURNS = 2,
    BVXI_STAR_NEEDLE = 3,
    BVXI_STAR_CROSSES = 4,
    BVXI_STAR_CRUMPLES = 5 /* judged by who collapses */
};

/* Gather the triangles around the edge opposite to a corner; 0 when they are too many, or the ends have more
 * than two neighbours in common: the collapse would join what is apart. */
int bvxi_star_gather(const bvxi_corners *mesh, int32_t edge, bvxi_star *star);

/* BVXI_STAR_SAFE when the new triangles around star->p keep their side, are no needles and cross nothing.
 * Fills what the star says about the new triangles. */
int bvxi_star_judge(const bvxi_corners *mesh, const bvxi_box_tree *boxes, bvxi_star *star);

/* one_sheet.c: 1 when all triangles that meet the box of the new triangles and u and v, and these themselves,
 * face one way: then the collapse is safe in one closed surface that does not cross itself. Fills what the
 * new triangles and the vertices around them face. */
int bvxi_star_is_one_sheet(const bvxi_corners *mesh, const bvxi_box_tree *boxes, bvxi_star *star,
                           const bvxi_box *box);

#endif
