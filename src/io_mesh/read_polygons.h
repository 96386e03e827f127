/* read_polygons.h - polygons of a mesh that is read: laid down as fans first, cut
 * when all vertices are known. Not installed. */
#ifndef BVXI_READ_POLYGONS_H
#define BVXI_READ_POLYGONS_H

#include "io_mesh/mesh_formats.h"

/* A polygon of four corners or more. Its triangles stand in the mesh as a fan: (0, 1, 2), (0, 2, 3), (0, 3,
 * 4)... of its corners, in triangles and, where there are texture coordinates at corners, in uv_triangles. */
typedef struct bvxi_polygon_fan {
    uint32_t triangle; /* the first of its corners - 2 triangles */
    uint32_t corners;
} bvxi_polygon_fan;

/* Cut count polygons into triangles that neither overlap nor turn over. All
 * vertices of the mesh are there and finite. */
bvx_status bvxi_cut_fans(bvxi_source *source, bvx_mesh *mesh, const bvxi_polygon_fan *fans, uint64_t count);

#endif
