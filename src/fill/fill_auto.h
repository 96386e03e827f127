/* fill_auto.h - the rule that fills a mesh where nobody names one. Not installed. */
#ifndef BVXI_FILL_AUTO_H
#define BVXI_FILL_AUTO_H

#include "solid/solid.h"

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
