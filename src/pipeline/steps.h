/* steps.h - steps that repair and booleans share: centres beside a surface, crumbs, the lattice for two
 * bodies and whether it is fine enough. Not installed. */
#ifndef BVXI_STEPS_H
#define BVXI_STEPS_H

#include "fill/thin_walls.h"
#include "surface/field_surface.h"
#include "winding/holes.h"

/* Checks the lattice, or the resolution, which becomes 256 where it is 0. */
bvx_status bvxi_check_fit(bvx_context *ctx, const char *function, bvx_fit *fit);

/* ---- The ends of lattice edges that a surface crosses: the only centres that need a distance ---- */

/* Set the words of where, of inside's window: centres with a neighbour (across a
 * face, in the window) that differs from them in inside, and in body too when
 * that is not NULL. Beyond the window all is outside along x; y and z stop there. */
bvx_status bvxi_ends_mark(bvx_context *ctx, const bvx_grid *inside, const bvx_grid *body, bvx_grid *where);

/* Their closest points of a mesh, in the columns that values has, whatever the order of triangles. off: how far the
 * surface between the centres lies off the mesh. Where it is no lid, its edges' ends are nearer than an edge. */
bvx_status bvxi_measure_ends(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh, double off,
                             const bvxi_sparse *values);

/* repair_surface.c: a bvxi_missing_fn, user bvxi_lids: lids lie where the winding number passes a half. winding:
 * NULL where there is none. */
typedef struct bvxi_lids {
    const bvxi_winding *winding;
    const bvx_lattice *lattice;
} bvxi_lids;

void bvxi_lid_ratios(const void *user, int32_t count, const bvxi_missing_edge *edge, double *ratio);

/* piece_volumes.c: the bodies of a mesh without boundary: pieces that cross, touch or lie in one another are one; 0:
 * there are too many pieces. Scratch: 12 bytes a vertex, what welding
 * needs, and bvx_mesh_crossings of all pairs. */
bvx_status bvxi_bodies_apart(bvx_context *ctx, const bvx_mesh_view *mesh, uint64_t *bodies);

/* The edge around a hole: its length and its box. [Units: world] */
typedef struct bvxi_rim {
    double length, low[3], high[3];
} bvxi_rim;

/* repair_report.c: warn where lids are a large share of the surface. */
void bvxi_warn_of_lids(bvx_context *ctx, double share, uint64_t holes, const bvxi_rim *longest);
/* *longest becomes the longest rim of a mesh's holes, if that is longer. */
void bvxi_longest_rim(const bvx_mesh_view *mesh, const bvxi_holes *holes, bvxi_rim *longest);

/* ---- Small parts of a solid that the meshes it was made from have no part for ---- */

/* As parts says: small ones go, or all but the largest; *dropped grows by those that went. */
bvx_status bvxi_keep_large_parts(bvx_context *ctx, const bvx_parts *parts, bvx_grid *inside,
                                 uint64_t *dropped);

/* A mesh that the solid was made from. piece: of each vertex, as bvxi_pieces fills it, once they are known. */
typedef struct bvxi_crumb_source {
    const bvx_mesh_view *mesh;
    uint32_t *piece; /* [Size: mesh->vertex_count]; the caller's, or scratch where it has none */
    int32_t known;
    const bvxi_near_cells *cells; /* the mesh's, or NULL */
} bvxi_crumb_source;

/* Fill a source's pieces where they are not known: vertices count as one where they are equal. */
bvx_status bvxi_know_pieces(bvx_context *ctx, bvxi_crumb_source *source);

enum { BVXI_CRUMB_SOURCES = 2 };

/* Drop the crumbs of a solid (empty 0), or fill the pockets that are crumbs of what is empty (1); *dropped
 * becomes their number. A crumb is a small part without a voxel whose six neighbours are of the part too, and
 * not the one that a piece of a mesh has for itself. sources: checked meshes with triangles. Scratch: the
 * parts' runs, a grid, for small parts 12 bytes a vertex and, where the meshes have several pieces, what
 * bvx_closest_create needs. */
bvx_status bvxi_drop_crumbs(bvx_context *ctx, const char *function, bvx_grid *inside, int32_t empty,
                            bvxi_crumb_source *source, int32_t sources, uint64_t *dropped);

#endif
