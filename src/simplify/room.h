/* room.h - fewer triangles, for other rooms: a mesh whose edges collapse to a target, and chains of levels.
 * Not installed. */
#ifndef BVXI_SIMPLIFY_ROOM_H
#define BVXI_SIMPLIFY_ROOM_H

#include "nearest/closest.h"
#include "nearest/crossing_tree.h"
#include "mesh/view.h"

/* What becomes of edges that have no two triangles running along them in opposite directions. */
enum {
    BVXI_BORDERS_REFUSED = 0,
    BVXI_BORDERS_KEPT = 1, /* edges with one triangle are borders; others are refused */
    BVXI_BORDERS_CUT = 2   /* all sides of such an edge are borders */
};

#define BVXI_EVEN 1e-9 /* by default */
#define BVXI_TARGETS(type)                                                                                   \
    BVXI_CHOICE(type, targets.error_kind, BVX_ERROR_MEAN, BVX_ERROR_MAX), BVXI_SWITCH(type, targets.strict), \
        BVXI_COUNT(type, targets.samples, 0, INT32_MAX),                                                     \
        BVXI_OR(type, targets.even, REAL, BVXI_EVEN, 0.0, 1.0)

#define BVXI_COLLAPSE(type)                                                           \
    BVXI_CHOICE(type, collapse.position_type, BVX_POSITION_AUTO, BVX_F64),            \
        BVXI_SWITCH(type, collapse.lock_border),                                      \
        BVXI_OR(type, collapse.attribute_weight, REAL, BVXI_WEIGHT, 0.0, 1000.0),     \
        BVXI_CHOICE(type, collapse.vertices, BVX_VERTICES_PLACED, BVX_VERTICES_KEPT), \
        BVXI_CHOICE(type, collapse.topology, BVX_TOPOLOGY_KEEP, BVX_TOPOLOGY_SIMPLIFY)
#define BVXI_WEIGHT 1.0 /* by default */

/* A mesh that levels go around: none of their triangles meets it, or has a point further from it than farthest. */
typedef struct bvxi_enclosed {
    bvx_closest closest;
    crossing_tree tree;
    double farthest, *point; /* of each piece that triangles join [Size: pieces * 3] */
    uint64_t pieces;
} bvxi_enclosed;

typedef struct bvxi_collapse_options {
    /* The caller's; the type is that of the levels, to which new positions are rounded, never AUTO; locked [Size:
     * vertex_count of the mesh that bvxi_levels_make takes]. */
    bvx_collapse given;
    double even; /* pull of every vertex towards the line along its normal: even triangles where it is flat */
    int32_t simple;    /* 1: the mesh is known to be welded, closed, manifold and oriented */
    int32_t borders;   /* BVXI_BORDERS_...: what becomes of a mesh that is not closed */
    int32_t counted;   /* 1: crossings are, those that were there before too */
    int32_t farthest;  /* 1: the farthest distance decides, so none is made longer for the mean's sake */
    const double *box; /* NULL, or low and high along x, y, z, beyond which no vertex goes */
    const bvxi_enclosed *enclosed; /* or NULL */
    int32_t sheets; /* 1: no edge comes to be that joins two locked vertices, and no triangle of three */
} bvxi_collapse_options;

/* Handles that were cut and holes that were filled, and the way around the longest of them. */
typedef struct bvxi_closed {
    uint64_t handles, holes;
    double longest;
} bvxi_closed;

/* What the levels of a chain are to be: options of bvx_mesh_simplify and bvx_build_levels, checked. */
typedef struct bvxi_level_chain {
    const char *function;
    const bvx_mesh_view *original; /* that errors are measured against */
    bvx_targets targets;
    uint64_t halve_from; /* the original's triangles: no level has more; halved where neither is given */
    bvxi_collapse_options collapse;
    uint64_t count;
    bvx_distance_report last; /* of the level made last, where errors are targets */
    bvxi_closed closed;       /* in the level made last */
    bvx_mesh *levels;
    bvx_level_report *reports; /* or NULL */
    bvxi_distance_tree kept;   /* the original's, from the first measure to the last level */
} bvxi_level_chain;

/* The targets and the collapse of a chain's options. Errors are measured against the mesh as it was given, not as it
 * was welded. */
static inline void bvxi_chain_take(bvxi_level_chain *chain, const bvx_mesh_view *original,
                                   const bvx_targets *targets, const bvx_collapse *collapse)
{
    chain->original = original;
    chain->targets = *targets;
    chain->halve_from = original->triangle_count;
    chain->collapse.even = targets->even;
    chain->collapse.given = *collapse;
    chain->collapse.farthest = targets->errors != NULL && targets->error_kind == BVX_ERROR_MAX;
    if (collapse->position_type == BVX_POSITION_AUTO)
        chain->collapse.given.position_type = (int32_t)bvxi_view_type(original);
}

/* What was done to a mesh before its edges collapse; cut_edge: the ends of the first edge that was cut. */
typedef struct bvxi_sheets_report {
    uint64_t collapsed, doubles, turned; /* triangles */
    uint64_t split;                      /* vertices */
    uint64_t parted, cut;                /* edges */
    double cut_edge[2][3];
    uint64_t triangles; /* before edges collapse */
} bvxi_sheets_report;

/* enclosed.c: of a checked view with triangles; closest is the caller's to shut, also after a failure. Scratch: 130 bytes
 * a triangle. */
bvx_status bvxi_enclosed_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                              double farthest, bvxi_enclosed *enclosed);
/* Refuse options that say too much, or nothing that can be. */
bvx_status bvxi_levels_check(bvx_context *ctx, const bvxi_level_chain *chain);
/* Make all levels of any checked view: it is welded by position and made ready here (bvxi_sheets_report), and
 * stays as it is otherwise. No level has more triangles than the mesh. sheets: NULL, or what was done. After a
 * failure no level is left. */
bvx_status bvxi_levels_make(bvx_context *ctx, bvxi_level_chain *chain, const bvx_mesh_view *mesh,
                            bvxi_sheets_report *sheets);
/* Warn of what the reports of levels say, each fact once; from: of what they were made; sheets: NULL, or as above. */
void bvxi_levels_warn(bvx_context *ctx, const bvxi_level_chain *chain, const bvx_certificate *from,
                      const bvxi_sheets_report *sheets);
/* Fewer triangles in a smoothed complex: so many, or with error above 0 as few as keep that mean distance. From then
 * on each face is one triangle (bvx_complex.single); lists of faces are made anew. Scratch: 190 bytes a triangle.
 * Vertices ON_SEAM stay, and none goes beyond the box, if there is one. */
bvx_status bvxi_complex_simplify(bvx_context *ctx, const char *function, bvx_complex *complex,
                                 uint64_t triangles, double error, const double *box);
/* Free what the library made of levels, and empty those in arrays of the caller's. */
void bvxi_levels_drop(bvx_context *ctx, bvx_mesh *levels, uint64_t count);

#endif
