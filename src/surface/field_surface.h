/* field_surface.h - surfaces with vertices where a field has them, for other rooms: what places a cut of a
 * lattice edge, and the call that runs marching cubes with it. Not installed. */
#ifndef BVXI_FIELD_SURFACE_H
#define BVXI_FIELD_SURFACE_H

#include "grid/sparse.h"
#include "surface/march.h"

#define BVXI_SHARP_ANGLE 0.8 /* by default */

/* ---- Where a lattice edge is cut, from the vectors to the closest points of both its ends ---- */

/* What placed a cut. */
enum {
    BVXI_CUT_VECTOR = 0, /* the line through the closest points, or their common projection */
    BVXI_CUT_SCALAR = 1, /* the distances' ratio; BVX_EDGE_PAPER: a clamp */
    BVXI_CUT_MIDDLE = 2, /* nothing else was there */
    BVXI_CUT_LID = 3,    /* no surface is near, so another rule was asked (field_surface.h: missing) */
    BVXI_CUT_KINDS = 4
};

/* An edge from its low end along an axis; one end is inside. */
typedef struct bvxi_cut_edge {
    int32_t axis;
    int32_t high_inside; /* 1: the high end is inside, 0: the low end */
    double length;       /* > 0 */
    /* from the low and from the high end to their closest points, in the length's units */
    double low[3], high[3];
    double low_distance, high_distance; /* not negative */
    uint64_t value[2];                  /* where the low and the high end's stand among others */
} bvxi_cut_edge;

/* The ratio from the low end, in [0, 1] for any numbers in the edge, and
 * what placed it. interpolation: BVX_EDGE_... */
int32_t bvxi_find_cut(const bvxi_cut_edge *edge, int32_t interpolation, double *ratio);

/* ---- Surfaces with vertices where a field of closest points has them, for other rooms ---- */

/* The edge from centre (i, j, k) of the window along axis; -1 is a centre before the window. */
typedef struct bvxi_missing_edge {
    int32_t axis, at[3];
} bvxi_missing_edge;

enum { BVXI_MISSING_MOST = 16 };

/* Ratios of at most BVXI_MISSING_MOST edges. Called from workers. */
typedef void bvxi_missing_fn(const void *user, int32_t count, const bvxi_missing_edge *edge, double *ratio);

/* By what edges are cut. */
typedef struct bvxi_cut_rule {
    /* At centres of the lattice and window of the inside; only those at ends of crossing edges are looked at,
     * so they need not be a band. Vectors go to the closest point, and are there but for BVX_EDGE_SCALAR and
     * MIDDLE; distances are of either sign, without them the vectors' lengths count [Units: world];
     * triangles, each below the mesh's count, are looked at where there is a mesh. */
    const bvxi_sparse *values;
    const bvx_mesh_view *mesh; /* sharp: checked, indices too; else NULL */
    /* crossings with an end that has no value (NULL: the middle), and those that no surface makes: the
     * distances of both ends are together more than the edge (NULL: as others) */
    bvxi_missing_fn *missing;
    const void *missing_user;
    /* what these values bound: only edges whose ends differ in it are theirs; NULL: the surface's own */
    const bvx_grid *inside;
    /* another body's values, or NULL */
    const struct bvxi_cut_rule *second;
    /* an edge of both is cut by 1: the one further from the inside, 0: the nearer one */
    int32_t outer;
    /* one body with an inside: edges that are not its own are cut where its distance, negative inside, is
     * this; 0: in the middle */
    double offset;
} bvxi_cut_rule;

/* The surface of inside with cuts by values; options are checked, surface is opened as by bvxi_mesh_open.
 * report may be NULL. stage, from, to: for progress. Steps of bvx_extract_field_surface. */
bvx_status bvxi_field_surface(bvx_context *ctx, const char *function, const bvx_grid *inside,
                              const bvxi_cut_rule *values, const bvx_field_surface_options *options,
                              bvx_mesh *surface);

/* ---- between the files of the stage ---- */

/* The plane of the facet at a vertex v: n.(x - v) = offset; n is outward, 0 where none is known. */
typedef struct bvxi_facet_plane {
    float n[3];
    float offset; /* [Units: the largest spacing] */
} bvxi_facet_plane;

typedef struct bvxi_cuts {
    const bvxi_march *march;     /* filled */
    const bvxi_cut_rule *values; /* and its second */
    int32_t interpolation;
    double unit;              /* the largest spacing */
    bvxi_facet_plane *planes; /* two of each vertex, or NULL where none are requested */
    uint64_t *piece_counts;   /* by what placed them, and those that are not the body's
                               [Size: march->pieces * (BVXI_CUT_KINDS + 1)] */
} bvxi_cuts;

/* field_cuts.c: place the vertices of the slots of a piece. */
void bvxi_cuts_piece(void *cuts, int32_t piece, uint64_t begin, uint64_t end);

struct bvxi_cut_edge;
/* edge_cut.c: the cut of an edge both of whose ends have values, from the ratio that their vectors
 * gave it; centre is the low end [Units: world]. planes[0] is that of the facet nearer to the cut, planes[1]
 * that of the other end's; both are zero before. */
double bvxi_facet_cut(const bvxi_cuts *cuts, const bvxi_cut_rule *values, const struct bvxi_cut_edge *edge,
                      const double centre[3], double ratio, bvxi_facet_plane planes[2]);

#endif
