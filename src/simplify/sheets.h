/* sheets.h - a mesh as files have it made ready for a collapse. Inside the room only. */
#ifndef BVXI_SHEETS_H
#define BVXI_SHEETS_H

#include "simplify/room.h"

/* A mesh by indices of its own. */
typedef struct bvxi_sheets {
    bvx_mesh_view view;
    uint32_t *corner; /* its indices [Size: triangle_count * 3] */
    uint32_t *source; /* the corner of the mesh, 3 t + k, of each of them, or NULL */
    void *positions;  /* or NULL: those of the mesh */
} bvxi_sheets;

/* Weld a checked view by position, and drop triangles with equal corners. sources 1: with their corners' own.
 * report: zero before. Scratch: that of bvxi_weld; then 12 bytes a triangle, 24 with sources. */
bvx_status bvxi_sheets_open(bvx_context *ctx, const bvx_mesh_view *mesh, int sources, bvxi_sheets *sheets,
                            bvxi_sheets_report *report);
/* Drop exact copies; turn triangles so that patches are consistent; part edges of three triangles and more by
 * sides; give each fan a vertex of its own. A mesh that needs none of that keeps the order of its triangles.
 * Scratch: 85 bytes a triangle while it works; then positions anew where vertices were split. */
bvx_status bvxi_sheets_part(bvx_context *ctx, bvxi_sheets *sheets, bvxi_sheets_report *report);

#endif
