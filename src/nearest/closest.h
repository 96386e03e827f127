/* closest.h - the point of a mesh that is closest to a given point; what stands behind the public
 * bvx_closest, for other rooms that require nearest points; how far meshes are apart, where several are
 * compared with the same one; all pairs of triangles that cross, for callers who have the mesh welded. Not
 * installed.
 *
 * Why there is a tree beside that of nearest_tree.h, whose answers are the same: this one has copies of the
 * corners, so the mesh may go, in 72 bytes a triangle, where that one needs about 100 and the mesh; points
 * lie anywhere, not in a lattice; and samples of distances are taken in the order of this one's curve. Bricks
 * of 64 centres are what the other is for: there a centre takes a fifth to a seventh of the time, and one by
 * one about as much as here. */
#ifndef BVXI_CLOSEST_H
#define BVXI_CLOSEST_H

#include "core/core.h"
#include "mesh/topology.h"
#include "mesh/view.h"

/* ---- nearest_order.c: triangles along a curve through space, of which both trees are built ---- */

enum { BVXI_CURVE_BITS = 16 };

typedef struct bvxi_curve {
    const bvx_mesh_view *view;
    double scale;            /* of coordinates, a power of two */
    double centre[3], units; /* scaled -> [-1, 1]; what lies beyond is moved onto the sides */
    uint64_t *keys;          /* of the middles of triangles' boxes, ascending [Size: triangles] */
    uint32_t *order;         /* triangles; equal keys in the order of their numbers [Size: triangles] */
    int32_t bits;            /* of a place along each axis, at most BVXI_CURVE_BITS */
    int32_t fast;            /* 1: AVX2 may run */
} bvxi_curve;

/* Fill keys and order, whose arrays are the caller's, as that part of its work. */
bvx_status bvxi_curve_sort(bvxi_call call, bvxi_curve *curve);

enum { BVXI_CURVE_LANES = 8 };

/* The corners of some triangles, coordinate by coordinate, so that those of all are one vector. */
static inline void bvxi_curve_gather(const bvx_mesh_view *view, const uint32_t triangle[BVXI_CURVE_LANES],
                                     double corner[9][BVXI_CURVE_LANES])
{
    int const packed = bvxi_view_packed_u32(view) && bvxi_view_packed_f32(view);

    for (int i = 0; i < BVXI_CURVE_LANES; i++) {
        double p[3][3];

        if (packed) {
            const unsigned char *const index = (const unsigned char *)view->indices +
                                               (size_t)triangle[i] * 12;
            for (size_t k = 0; k < 9; k++) {
                uint32_t c;
                float f;
                memcpy(&c, index + k / 3 * 4, sizeof c);
                memcpy(&f, (const unsigned char *)view->positions + (size_t)c * 12 + k % 3 * 4, sizeof f);
                corner[k][i] = (double)f;
            }
            continue;
        }
        bvxi_view_corners(view, triangle[i], p);
        for (int k = 0; k < 9; k++) corner[k][i] = p[k / 3][k % 3];
    }
}

/* The box of a triangle, whose corners are scaled, in the curve's units. */
static inline void bvxi_curve_box(const bvxi_curve *curve, const double t[3][3], double low[3],
                                  double high[3])
{
    for (int a = 0; a < 3; a++) {
        double lo = t[0][a], hi = t[0][a];
        for (int k = 1; k < 3; k++) {
            lo = t[k][a] < lo ? t[k][a] : lo;
            hi = t[k][a] > hi ? t[k][a] : hi;
        }
        low[a] = (lo - curve->centre[a]) * curve->units;
        high[a] = (hi - curve->centre[a]) * curve->units;
    }
}

enum { BVXI_CLOSEST_WIDTH = 4, BVXI_CLOSEST_LEVELS = 16 }; /* 4^16 = 2^32 triangles */

/* Boxes of four children side by side, in the tree's own units. */
typedef struct bvxi_closest_node {
    float low[3][BVXI_CLOSEST_WIDTH], high[3][BVXI_CLOSEST_WIDTH];
} bvxi_closest_node;

/* A full tree with four children a node over triangles in the order of a curve through space, each with a
 * copy of its corners. Read-only once built, so many threads may ask at the same time. */
typedef struct bvxi_closest_tree {
    uint64_t triangle_count;
    uint32_t *order; /* place on the curve -> triangle index [Size: triangle_count] */
    /* of the triangle at each place, typed as in the mesh [Size: triangle_count * 9] */
    void *corners;
    bvxi_closest_node *nodes; /* levels one after the other, the lowest (children are triangles) first */
    uint64_t node_count;
    uint64_t level_first[BVXI_CLOSEST_LEVELS], level_nodes[BVXI_CLOSEST_LEVELS];
    int32_t level_count;
    int32_t position_type;
    int32_t fast;     /* 1: AVX2 may run */
    double scale;     /* exact power of two by which all coordinates are multiplied */
    double centre[3]; /* of the bounds, scaled */
    double box_scale; /* scaled and centred -> box units, in which the mesh lies within [-1, 1] */
} bvxi_closest_tree;

typedef struct bvxi_closest {
    double point[3];   /* the closest point [Units: world times scale] */
    double distance2;  /* square of the distance [Units: (world times scale)^2] */
    uint32_t triangle; /* the least number among the triangles at that distance */
    uint32_t place;    /* of that triangle on the curve */
} bvxi_closest;

/* Build over a checked view with at least one triangle; low and high are its bounds, scale is the power of
 * two by which coordinates are multiplied (see bvxi_unit_scale), stage, from and to are for progress.
 * Memory: 72 bytes a triangle of floats, 108 of doubles, no more while it is built. */
bvx_status bvxi_closest_build(bvxi_call call, const bvx_mesh_view *view, const double low[3],
                              const double high[3], double scale, bvxi_closest_tree *tree);
/* The same, but from the triangles' positions alone: their order, their corners' and the vertices' numbers do
 * not show in a bit. Triangles are numbered along the curve. */
bvx_status bvxi_closest_build_unnumbered(bvxi_call call, const bvx_mesh_view *view, const double low[3],
                                         const double high[3], double scale, bvxi_closest_tree *tree);
void bvxi_closest_free(bvx_context *ctx, bvxi_closest_tree *tree);

/* The least (distance2, triangle) over all triangles, as bvxi_closest_on_triangle
 * computes them: the tree never shows. point is finite [Units: world times
 * scale]; hint is any place on the curve, best one that is near. */
void bvxi_closest_find(const bvxi_closest_tree *tree, const double point[3], uint32_t hint,
                       bvxi_closest *found);

/* Square of the distance from p to triangle t, and the closest point q. Any triangle, also without area. */
double bvxi_closest_on_triangle(const double p[3], const double t[3][3], double q[3]);

/* How many of the slots of a node that begin at first are among count. */
static inline int bvxi_closest_children(uint64_t count, uint64_t first)
{
    return count - first < BVXI_CLOSEST_WIDTH ? (int)(count - first) : BVXI_CLOSEST_WIDTH;
}

/* Corners of the triangle at a place of the curve, scaled. */
static inline void bvxi_closest_corners(const bvxi_closest_tree *tree, uint64_t place, double t[3][3])
{
    for (size_t k = 0; k < 9; k++)
        t[k / 3][k % 3] = tree->scale * (tree->position_type == BVX_F32
                                             ? (double)((const float *)tree->corners)[9 * (size_t)place + k]
                                             : ((const double *)tree->corners)[9 * (size_t)place + k]);
}

struct bvx_closest {
    bvxi_closest_tree tree;
};

/* Check a mesh and build its search tree, in place; stage, from and to are
 * for progress. The view may go afterwards. On failure nothing is held. */
bvx_status bvxi_closest_open(bvxi_call call, const bvx_mesh_view *mesh, bvx_closest *closest);
void bvxi_closest_shut(bvx_context *ctx, bvx_closest *closest);

/* The nearest point of a finite point. *hint is any number at first and then best left alone from point to
 * point: it makes the search faster and changes nothing. */
void bvxi_closest_ask(const bvx_closest *closest, const double point[3], uint32_t *hint,
                      bvx_closest_point *found);

/* How far three points, and with them all between, are from the triangle of a hint that an answer left: a bound above
 * their distances from the mesh. */
double bvxi_closest_bound(const bvx_closest *closest, const double *const point[3], uint32_t hint);

/* carry.c: refuse the fields of a mesh that no view of it shows. */
bvx_status bvxi_check_carried_mesh(bvx_context *ctx, const char *function, const bvx_mesh *mesh);

/* Where on triangle t its closest point q to p lies: feature and weights, no more. */
void bvxi_closest_place(const double p[3], const double t[3][3], const double q[3], bvx_closest_point *found);

/* The search tree of a mesh, kept from one comparison to the next. Zeroed: not built yet. */
typedef struct bvxi_distance_tree {
    bvxi_closest_tree tree;
    int32_t built;
} bvxi_distance_tree;

/* bvx_mesh_distance, the same bits. kept: a's tree, which is built where it is not, or where b needs another
 * scale. Memory beside it: as there, without a's tree. */
bvx_status bvxi_mesh_distance(bvx_context *ctx, const bvx_mesh_view *a, bvxi_distance_tree *kept,
                              const bvx_mesh_view *b, uint64_t samples, uint64_t seed,
                              bvx_distance_report *report);
void bvxi_distance_forget(bvx_context *ctx, bvxi_distance_tree *kept);

/* As bvx_mesh_crossings, of a welded mesh with triangles. Vertices that no triangle uses may be anything. *pairs
 * becomes a block of scratch [Size: *count * 2], NULL where there are none, or more than most. */
bvx_status bvxi_mesh_crossings(bvx_context *ctx, const bvxi_welded *mesh, uint64_t most, uint32_t **pairs,
                               uint64_t *count);
/* The same of any view, which is checked. Its vertices at equal positions are one. */
bvx_status bvxi_crossing_pairs(bvx_context *ctx, const bvx_mesh_view *mesh, uint64_t most, uint32_t **pairs,
                               uint64_t *count);

#endif
