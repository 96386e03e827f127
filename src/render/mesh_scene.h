/* mesh_scene.h - a mesh set up for a picture, between drawing and shading. Not installed. */
#ifndef BVXI_MESH_SCENE_H
#define BVXI_MESH_SCENE_H

#include "mesh/view.h"
#include "render/cut_triangle.h"
#include "render/picture.h"
#include "render/triangle_bins.h"

/* A vertex in the frame. */
typedef struct bvxi_scene_vertex {
    int32_t x, y; /* right and down [Units: samples * 2^fraction_bits] */
    float z;      /* towards the eye [Units: samples] */
} bvxi_scene_vertex;

typedef struct bvxi_mesh_scene {
    const bvx_mesh_view *view;
    bvxi_picture picture;
    bvxi_cut cut;               /* [Units: world * unit] */
    int32_t pieces;             /* of the work being done */
    bvxi_camera_extent *extent; /* of each piece */
    bvxi_scene_vertex *vertex;  /* [Size: view.vertex_count]; NULL: the mesh is cut */
    float *normal;              /* three for each vertex, length 1 or 0; NULL: flat */
    bvxi_triangle_bins bins;
} bvxi_mesh_scene;

/* Corners of a triangle: vertex indices, and places in the camera's axes:
 * right, up, towards the eye [Units: samples]. */
void bvxi_mesh_scene_corners(const bvxi_mesh_scene *scene, uint32_t t, uint32_t c[3], double p[3][3]);

/* Make what smooth pictures need; the caller frees scene.normal, 12 bytes a vertex. */
bvx_status bvxi_mesh_scene_normals(bvx_context *ctx, bvxi_mesh_scene *scene);

/* What a sample shows; user is the scene. */
void bvxi_mesh_scene_see(const void *user, const bvxi_raster *raster, uint32_t id, int32_t x, int32_t y,
                         bvxi_seen *seen);

#endif
