/* faces.h - the mesh of exposed voxel faces: what single faces and merged ones share. Not installed.
 *
 * Vertices are corners of voxels, (i, j, k) from 0 to the window's size. A row of corners (j, k) has one bit
 * for each, a set one is used; vertices are numbered by (z, y, x). */
#ifndef BVXI_SURFACE_FACES_H
#define BVXI_SURFACE_FACES_H

#include "bits/bits.h"
#include "grid/grid.h"
#include "mesh/mesh.h"

/* First numbers of a row of corners (counts before the prefix sum): its
 * vertices, and the faces whose low corner lies in it. */
typedef struct bvxi_face_row {
    uint32_t vertex, face;
} bvxi_face_row;

typedef struct bvxi_faces {
    const bvx_grid *grid;
    const bvx_grid *own; /* without voxels whose faces are a neighbour's; grid where there are none */
    const char *function;
    bvx_faces_options options;
    double origin[3], spacing[3];
    int32_t words;                     /* of a row of corners */
    const uint64_t *empty_row;         /* of voxels */
    bvxi_face_row *rows;               /* [Size: row_count + 1] */
    uint64_t *used;                    /* corners of rows of one word; NULL: of longer ones, not kept */
    uint64_t row_count;                /* rows of corners */
    int32_t pieces;                    /* of these */
    uint64_t vertex_count, face_count; /* a face is two triangles */
    bvx_mesh *mesh;
} bvxi_faces;

/* face_rectangles.c: merged faces, counted; then the mesh, unless it is NULL. */
bvx_status bvxi_faces_merge(bvx_context *ctx, bvxi_faces *f, bvx_mesh *mesh);
/* Refuse more than 2^32 - 1 vertices or triangles. */
bvx_status bvxi_faces_check_counts(bvx_context *ctx, const bvxi_faces *f);
/* Make the mesh ready for the counts. */
bvx_status bvxi_faces_open_mesh(bvx_context *ctx, bvxi_faces *f, bvx_mesh *mesh);

/* The words of voxel row (j, k) of grid or own; an empty row outside the window. */
static inline const uint64_t *bvxi_face_voxels(const bvxi_faces *f, const bvx_grid *g, int32_t j, int32_t k)
{
    if (j < 0 || k < 0 || j >= g->size[1] || k >= g->size[2]) return f->empty_row;
    return bvxi_grid_row(g, j, k);
}

/* Word w of a row of voxels as seen from corners: bit i is the voxel behind
 * corner i; before: the one before it. */
static inline uint64_t bvxi_face_word(const bvxi_faces *f, const uint64_t *row, int32_t w, uint64_t *before)
{
    uint64_t const here = w < f->grid->words_per_row ? row[w] : 0;
    *before = here << 1 | (w > 0 ? row[w - 1] >> 63 : 0);
    return here;
}

/* World coordinate of corners along an axis. */
static inline double bvxi_corner_along(const bvxi_faces *f, int32_t axis, int32_t index)
{
    return f->origin[axis] + (double)(f->grid->low[axis] + index) * f->spacing[axis];
}

/* Vertices of the corners in one word of a row, from number `vertex` on. */
static inline void bvxi_put_corners(const bvxi_faces *f, uint64_t corners, int32_t w, uint64_t vertex,
                                    double y, double z)
{
    for (; corners != 0; corners &= corners - 1)
        bvxi_put_position(f->mesh, f->options.position_type, vertex++,
                          bvxi_corner_along(f, 0, w * BVXI_WORD_BITS + bvxi_lowest(corners)), y, z);
}

/* A face as two triangles. Its corners, seen from the positive side of its axis, turn counter-clockwise a, b,
 * c, d; outwards is the positive side or the negative one. The diagonal runs from a to c either way. */
static inline void bvxi_put_face(uint32_t *out, uint32_t a, uint32_t b, uint32_t c, uint32_t d, int positive)
{
    out[0] = a;
    out[1] = positive ? b : c;
    out[2] = positive ? c : b;
    out[3] = a;
    out[4] = positive ? c : d;
    out[5] = positive ? d : c;
}

#endif
