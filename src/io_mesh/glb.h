/* glb.h - what the files that make a GLB share. Not installed. */
#ifndef BVXI_GLB_H
#define BVXI_GLB_H

#include "io_mesh/mesh_formats.h"

/* Vertices repeated, so that each has one texture coordinate. */
typedef struct bvxi_seams {
    uint32_t *triangles;   /* vertices as written [Size: triangle_count * 3] */
    uint32_t *vertex, *uv; /* of the mesh, for each as written [Size: count] */
    uint64_t count;
} bvxi_seams;

/* Vertices as written are the pairs of vertex and texture coordinate that corners
 * have, in the order of their first use. The mesh has uv_triangles and fewer than
 * 2^32 corners. On failure nothing is held. Scratch: 28 bytes a corner. */
bvx_status bvxi_split_seams(bvx_context *ctx, const bvx_mesh *mesh, bvxi_seams *seams);
void bvxi_free_seams(bvx_context *ctx, bvxi_seams *seams);

enum { BVXI_GLB_POSITION, BVXI_GLB_NORMAL, BVXI_GLB_COLOUR, BVXI_GLB_UV, BVXI_GLB_INDEX, BVXI_GLB_ARRAYS };

/* One mesh of a file and where its arrays lie. */
typedef struct bvxi_glb {
    const bvx_mesh *mesh;
    double *normal;   /* sums of bvxi_add_normals */
    bvxi_seams seams; /* zero: vertices are those of the mesh */
    /* of the bounds of all levels in the world: positions are relative to it */
    double centre[3];
    float low[3], high[3];           /* of the positions */
    uint64_t vertices;               /* as written */
    uint64_t count[BVXI_GLB_ARRAYS]; /* elements of each array, 0 where the mesh has none */
    uint64_t size[BVXI_GLB_ARRAYS];  /* bytes of an element */
    uint64_t at[BVXI_GLB_ARRAYS];    /* place in the binary chunk */
    uint64_t end;                    /* of the last array */
} bvxi_glb;

/* What a file holds: levels of detail, the finest first; a mesh alone is the case of one. */
typedef struct bvxi_glb_file {
    bvxi_glb *level;
    uint64_t levels;
} bvxi_glb_file;

/* Chunks and levels begin at multiples of four bytes. */
static inline uint64_t bvxi_glb_padded(uint64_t size)
{
    return (size + 3) / 4 * 4;
}

/* Fill count, size, at and end from mesh and vertices; the arrays begin at a place of the binary chunk. */
void bvxi_glb_layout(bvxi_glb *glb, uint64_t begin);
/* BVX_ERR_RANGE when a file of that many bytes would be larger than the format allows. */
bvx_status bvxi_glb_check_size(bvx_context *ctx, uint64_t size, uint64_t levels);
/* The description of the file, without padding. */
void bvxi_glb_put_json(const bvxi_glb_file *file, bvxi_output *out);

#endif
