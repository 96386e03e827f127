/* corners.h - a triangle mesh whose edges can collapse: a corner table. Not installed.
 *
 * Source: Rossignac. Edgebreaker: Connectivity Compression for Triangle Meshes. 1999.
 *
 * Corner c belongs to triangle c / 4, whose corners c % 4 of 0, 1, 2 run counter-clockwise; the edge opposite
 * to c joins its two fellows. Every vertex has one fan of triangles, so all of it is reached from one corner.
 * Collapses walk around vertices most of the time: each corner has the next one of its vertex, and the cost of
 * the edge that leads to the next vertex, so that a step is one load.
 *
 * Borders are closed by ghosts: a triangle from each border edge to a ghost vertex that has no position. All
 * borders share that vertex, so the link condition that keeps a closed mesh manifold keeps borders from
 * meeting, too. Ghost triangles come after all others, and nothing but the walk from triangle to triangle
 * knows them: they have no area and no box, and edges to the ghost never collapse. */
#ifndef BVXI_CORNERS_H
#define BVXI_CORNERS_H

#include "core/vec3.h"
#include "simplify/room.h"

#define BVXI_VERTEX_GHOST (UINT32_MAX - 1)

/* A sum of squared distances: d'Ad + 2b'd + c at d; A is xx xy xz yy yz zz. */
typedef struct bvxi_quadric {
    double a[6], b[3], c;
} bvxi_quadric;

/* A position of the result's type, and its quadric, about it and in units of the mesh's size. */
typedef struct bvxi_corner_vertex {
    double p[3];
    bvxi_quadric q;
} bvxi_corner_vertex;

/* A triangle that is gone keeps its corners and neighbours, so that the collapse can be undone; the second of them is
 * inverted. That one is no ghost, and below 2^31, since triangles are below 2^29. */
typedef struct bvxi_corner_triangle {
    uint32_t vertex[3];
    int32_t left[3]; /* the next corner of the same vertex, counter-clockwise: across the previous edge */
    float cost[3];   /* of collapsing the edge from each to the next one */
} bvxi_corner_triangle;

typedef struct bvxi_corners {
    bvxi_corner_vertex *at;         /* [Size: vertices] */
    bvxi_corner_triangle *triangle; /* [Size: triangles + ghosts] */
    uint32_t *source;               /* vertex of the view at each position [Size: vertices] */
    uint64_t vertices, triangles;
    uint64_t ghosts; /* triangles between borders and the ghost vertex, after all others */
    uint64_t left;   /* triangles that are not gone, without ghosts */
    uint64_t split;  /* vertices that joined several fans */
    uint64_t vertex_room, triangle_room; /* of the arrays, which bvxi_corners_connect may replace */
} bvxi_corners;

/* 1 2 0 and 2 0 1. Compilers choose without a branch, which would be predicted badly. */
static inline int32_t bvxi_corner_next(int32_t c)
{
    return (c & 2) != 0 ? c - 2 : c + 1;
}

static inline int32_t bvxi_corner_previous(int32_t c)
{
    return (c & 3) != 0 ? c - 1 : c + 2;
}

static inline uint32_t bvxi_corner_vertex_of(const bvxi_corners *m, int32_t c)
{
    return m->triangle[(uint32_t)c >> 2].vertex[c & 3];
}

static inline int32_t bvxi_corner_turn_left(const bvxi_corners *m, int32_t c)
{
    return m->triangle[(uint32_t)c >> 2].left[c & 3];
}

/* The corner across the edge opposite to one. */
static inline int32_t bvxi_corner_opposite(const bvxi_corners *m, int32_t c)
{
    return bvxi_corner_previous(bvxi_corner_turn_left(m, bvxi_corner_previous(c)));
}

static inline int bvxi_triangle_gone(const bvxi_corner_triangle *t)
{
    return t->vertex[1] >> 31 != 0;
}

static inline int bvxi_corner_gone(const bvxi_corners *m, int32_t c)
{
    return bvxi_triangle_gone(&m->triangle[c >> 2]);
}

/* 1 when a corner belongs to a ghost triangle. */
static inline int bvxi_corner_is_ghost(const bvxi_corners *m, int32_t c)
{
    return (uint64_t)(c >> 2) >= m->triangles;
}

static inline void bvxi_corner_put_left(bvxi_corners *m, int32_t c, int32_t left)
{
    m->triangle[(uint32_t)c >> 2].left[c & 3] = left;
}

/* Make two corners opposite to each other. */
static inline void bvxi_corners_join(bvxi_corners *m, int32_t a, int32_t b)
{
    bvxi_corner_put_left(m, bvxi_corner_previous(a), bvxi_corner_next(b));
    bvxi_corner_put_left(m, bvxi_corner_previous(b), bvxi_corner_next(a));
}

/* The first corner of each vertex from begin to end, which has one. */
static inline void bvxi_corners_any(const bvxi_corners *m, uint64_t begin, uint64_t end, int32_t *any)
{
    for (uint64_t t = m->triangles + m->ghosts; t-- > 0;)
        for (int k = 0; k < 3; k++)
            if (m->triangle[t].vertex[k] - begin < end - begin)
                any[m->triangle[t].vertex[k]] = (int32_t)(4 * t) + k;
}

/* Join the corners of a mesh whose vertices and triangles' vertices are set; borders: BVXI_BORDERS_...
 * Refuses with BVX_ERR_ARGUMENT what is not edge-manifold and oriented and, where borders are refused, what
 * is not closed and vertex-manifold. Where they are not, arrays are replaced by larger ones for ghosts, and
 * for vertices that join several fans, of which each fan gets its own. Scratch: 16 bytes a triangle and 8 a
 * vertex; while an array is replaced, both. */
bvx_status bvxi_corners_connect(bvx_context *ctx, const char *function, bvxi_corners *mesh, int borders);

#endif
