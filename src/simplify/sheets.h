/* sheets.h - a mesh as files have it made ready for a collapse. Inside the room only. */
#ifndef BVXI_SHEETS_H
#define BVXI_SHEETS_H

#include "simplify/room.h"

/* A mesh that is edge-manifold by its indices where it can be, with its own arrays. */
typedef struct bvxi_sheets {
    bvx_mesh_view view;
    uint32_t *corner; /* its indices [Size: triangle_count * 3] */
    void *positions;  /* or NULL: those of the mesh */
} bvxi_sheets;

/* Weld a checked view by position; drop triangles with equal corners and exact copies; turn triangles so that
 * patches are consistent; part edges of three triangles and more by sides; give each fan a vertex of its own.
 * A mesh that needs none of that keeps the order of its triangles. report: zero before.
 * Scratch: 85 bytes a triangle and 12 a vertex while it works; then 12 a triangle, and positions anew where
 * vertices were split. */
bvx_status bvxi_sheets_open(bvx_context *ctx, const bvx_mesh_view *mesh, bvxi_sheets *sheets,
                            bvxi_sheets_report *report);
void bvxi_sheets_close(bvx_context *ctx, bvxi_sheets *sheets);

#endif
