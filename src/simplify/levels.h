/* levels.h - a chain of levels of one closed surface: what other rooms may use. Not installed. */
#ifndef BVXI_LEVELS_H
#define BVXI_LEVELS_H

#include "nearest/distance.h"
#include "simplify/simplify.h"

/* What the levels of a chain are to be: options of bvx_mesh_simplify and bvx_build_levels, checked. */
typedef struct bvxi_level_chain {
    const char *function;
    const bvx_mesh_view *original; /* that errors are measured against */
    const uint64_t *target_triangles;
    const double *target_errors;
    uint64_t halve_from; /* triangles that are halved where neither is given */
    int32_t error_kind, strict;
    uint64_t measure_samples;
    bvxi_collapse_options collapse;
    uint64_t count;
    bvx_mesh *levels;
    bvx_level_report *reports; /* or NULL */
    bvxi_distance_tree kept;   /* the original's, from the first measure to the last level */
} bvxi_level_chain;

/* Refuse options that say too much, or nothing that can be. */
bvx_status bvxi_levels_check(bvx_context *ctx, const bvxi_level_chain *chain);
/* Make all levels of a surface that is closed, manifold and oriented. After a failure none is left. */
bvx_status bvxi_levels_make(bvx_context *ctx, bvxi_level_chain *chain, const bvx_mesh_view *surface);
/* Free what the library made of levels, and empty those in arrays of the caller's. */
void bvxi_levels_drop(bvx_context *ctx, bvx_mesh *levels, uint64_t count);

/* simplify_mesh.c: view with one vertex a position and no triangle of two equal corners; *corner is its array
 * or NULL [Size: view->triangle_count * 3]. */
bvx_status bvxi_welded_view(bvx_context *ctx, const bvx_mesh_view *mesh, bvx_mesh_view *view,
                            uint32_t **corner);

/* What was done to make sheets of triangles, and the first edge by its vertices that is in no sheet's way but
 * cut: of three triangles or more, or between two that cannot agree. */
typedef struct bvxi_sheets_report {
    uint64_t doubles, turned, refused; /* triangles, triangles, edges */
    uint32_t edge[2];
} bvxi_sheets_report;

/* sheets.c: drop triangles of a welded view that are there twice, and turn triangles
 * so that those that share an edge with each other alone agree, where they can.
 * corner: the view's indices. Scratch: 89 bytes a triangle and 4 a vertex. */
bvx_status bvxi_sheets_prepare(bvx_context *ctx, bvx_mesh_view *welded, uint32_t *corner,
                               bvxi_sheets_report *report);

#endif
