/* glb.h - what the files that make a GLB share. Not installed. */
#ifndef BVXI_GLB_H
#define BVXI_GLB_H

#include "io/formats.h"

/* Vertices repeated, so that each has one texture coordinate. */
typedef struct bvxi_seams {
    uint32_t *triangles;     /* vertices as written [Size: triangle_count * 3] */
    uint32_t *vertex, *uv;   /* of the mesh, for each as written [Size: count] */
    uint64_t count;
} bvxi_seams;

/* Vertices as written are the pairs of vertex and texture coordinate that corners have, in the order of their first use.
 * The mesh has uv_triangles and fewer than 2^32 corners. On failure nothing is held. Scratch: 28 bytes a corner. */
bvx_status bvxi_split_seams(bvx_context *ctx, const bvx_mesh *mesh, bvxi_seams *seams);
void bvxi_free_seams(bvx_context *ctx, const bvx_mesh *mesh, bvxi_seams *seams);

enum { BVXI_GLB_POSITION, BVXI_GLB_NORMAL, BVXI_GLB_COLOUR, BVXI_GLB_UV, BVXI_GLB_INDEX, BVXI_GLB_ARRAYS };

/* What a file holds and where. */
typedef struct bvxi_glb {
    const bvx_mesh *mesh;
    const double *normal;            /* sums of bvxi_add_normals */
    bvxi_seams seams;                /* zero: vertices are those of the mesh */
    double centre[3];                /* of the bounds in the world: positions are relative to it */
    float low[3], high[3];           /* of the positions */
    uint64_t vertices;               /* as written */
    uint64_t count[BVXI_GLB_ARRAYS]; /* elements of each array, 0 where the mesh has none */
    uint64_t size[BVXI_GLB_ARRAYS];  /* bytes of an element */
    uint64_t at[BVXI_GLB_ARRAYS];    /* place in the binary chunk */
    uint64_t binary;                 /* bytes of all arrays */
} bvxi_glb;

/* Fill count, size, at and binary from mesh and vertices. */
void bvxi_glb_layout(bvxi_glb *glb);
/* BVX_ERR_RANGE when a file of that many bytes would be larger than the format allows. */
bvx_status bvxi_glb_check_size(bvx_context *ctx, uint64_t size);
/* The description of the file, without padding. */
void bvxi_glb_put_json(const bvxi_glb *glb, bvxi_output *out);

#endif
