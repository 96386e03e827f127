/* fills.h - what the rules for inside share beyond filling rows: the vote of three axes, floods, regions,
 * terrain, and the choice of a rule for a mesh. Not installed. */
#ifndef BVXI_FILLS_H
#define BVXI_FILLS_H

#include "solid/solid.h"
#include "winding/holes.h"

/* ---- The rules that fill more than rows: votes of axes, floods, regions, terrain ---- */

enum { BVXI_MOST_GAP = 65535 };

/* voxelize_solid.c: fill a grid that is open by the rule parity, winding or vote; holes: what the rule looks
 * at, found before, or NULL. Everything has been checked. */
bvx_status bvxi_fill_known(bvx_context *ctx, const bvx_mesh_view *mesh, int32_t fill, const bvxi_holes *holes,
                           bvx_grid *solid);

/* vote.c: solid's words become the vote. sure: words of the same shape (scratch), left with the centres whose
 * rows along x, y and z balance and agree; with want_clear also those whose solid angle lies within a quarter
 * of a turn of a whole number. Local. Scratch: one turned grid, 3 bytes a row, and where there are holes
 * holes.h and sheet.h. */
bvx_status bvxi_vote(bvxi_call step, bvxi_solid_job *job, int32_t want_clear, bvx_grid *solid, uint64_t *sure,
                     bvx_solid_report *report);

/* flood.c: solid holds the vote and becomes the rule's; surface is the mesh's conservative one. Both cover the
 * whole lattice. What a flood runs into: closing gaps adds to surface. */
typedef struct bvxi_flood_walls {
    bvx_grid *surface;
    const uint64_t *sure;
    int32_t close_gaps; /* [Units: voxels] 0: none */
} bvxi_flood_walls;
/* *leaked: 1 when the flood reached every centre off the surface, though the vote has some of them surely
 * inside. */
bvx_status bvxi_flood(bvx_context *ctx, const char *function, const bvxi_flood_walls *walls, bvx_grid *solid,
                      bvx_solid_report *report, int32_t *leaked);

/* close_gaps.c: put to the words of grid what a cube of gap + 1 voxels a side cannot reach when it moves through
 * empty voxels, also beyond the window. pockets, unless NULL: for a cube that comes from outside, so that what
 * lies after walls that hold it is set too; how many places do. Scratch: one more grid, and for pockets that of
 * components/room.h over the grid of gap more voxels a side. */
bvx_status bvxi_close_gaps(bvx_context *ctx, const char *function, bvx_grid *grid, int32_t gap,
                           uint64_t *pockets);

/* outside.c: the centres of a whole lattice that a way from outside leads to; openings of up to gap voxels are closed.
 * outside and sheets are open, and their words are written; sheets: ends of edges that the mesh crosses although both
 * are outside. The caller frees scratch: 13 grids, and close_gaps.c. */
bvx_status bvxi_outside(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh, int32_t gap,
                        bvx_grid *outside, bvx_grid *sheets);

/* below.c. second_job: options->second made ready, or NULL. Local. */
bvx_status bvxi_below(bvx_context *ctx, bvxi_solid_job *job, bvxi_solid_job *second_job,
                      const bvx_voxelize_options *options, bvx_grid *solid, bvx_solid_report *report);

/* solid_losses.c: the report's volumes and thin walls of a solid that options have filled; the resolution at
 * which the volume is right. Scratch: thin_walls.h where walls are looked for. */
bvx_status bvxi_solid_losses(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                             const bvx_grid *solid, const bvx_voxelize_options *options,
                             bvx_solid_report *report);
bvx_status bvxi_advise_for_volume(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                                  bvx_solid_report *report);
/* Warn of what a solid's report says, as its owner's whole result; of how a mesh was filled and of the walls that
 * are lost, as one of several inputs (-1: the only one). */
void bvxi_warn_of_solid(bvx_context *ctx, const bvx_grid *solid, bvx_solid_report *report);
void bvxi_warn_of_fill(bvx_context *ctx, const bvx_solid_report *report, int32_t input);
void bvxi_warn_of_walls(bvx_context *ctx, const bvx_lattice *lattice, const bvx_solid_report *report,
                        int32_t input);

/* ---- The rule that fills a mesh where nobody names one ---- */

/* fill_auto.c: what fills the mesh, and the mesh to fill with it. */
typedef struct bvxi_auto {
    int32_t fill, reason; /* BVX_FILL_..., BVX_FILL_REASON_... */
    bvx_mesh_view view;   /* of the triangles as they are to be filled */
    /* its indices where triangles are turned or dropped, else NULL [Size: triangles * 3] */
    uint32_t *index;
    uint64_t turned;  /* triangles */
    uint64_t doubles; /* triangles left out */
} bvxi_auto;

/* Fill solid by the rule that suits the mesh, adding counts to the report. Whole lattices of sound closed
 * meshes are filled by parity on the way; for windows the rows of the whole lattice are looked at first, so
 * that they hold the bits of the whole (of more than 2^22 rows with longer voxels, whole or not).
 * fill: the rule that fills by name, for what remains. */
typedef bvx_status bvxi_fill_by_name_fn(bvx_context *ctx, const bvx_mesh_view *mesh, int32_t fill,
                                        bvx_grid *solid, bvx_solid_report *report);
bvx_status bvxi_fill_auto(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                          bvxi_fill_by_name_fn *by_name, bvx_grid *solid, bvx_solid_report *report);

#endif
