/* mesh_formats.h - the readers and writers of meshes, one a format, and what they share: arrays in exact
 * sizes, polygons that are cut when all vertices are known, corners that are not finite. Not installed. */
#ifndef BVXI_MESH_FORMATS_H
#define BVXI_MESH_FORMATS_H

#include "io/file_parts.h"
#include "io/formats.h"
#include "mesh/mesh.h"

#include <math.h>

/* ---- The readers and writers behind bvx_read_mesh and bvx_write_mesh, and what they share ---- */

/* ---- readers: arguments are checked, mesh is all zero and freed by the caller on failure ---- */

bvx_status bvxi_read_stl(bvxi_source *source, bvx_mesh *mesh);
bvx_status bvxi_read_obj(bvxi_source *source, uint32_t *lost, bvx_mesh *mesh);
bvx_status bvxi_read_ply(bvxi_source *source, bvx_mesh *mesh);
bvx_status bvxi_read_off(bvxi_source *source, bvx_mesh *mesh);
/* GLB and glTF text, known by their first bytes; *lost gets bits of BVX_LOST_.... */
bvx_status bvxi_read_gltf(bvxi_source *source, const bvx_read_options *options, uint32_t *lost,
                          bvx_mesh *mesh);
bvx_status bvxi_read_3mf(bvxi_source *source, const bvx_read_options *options, uint32_t *lost,
                         bvx_mesh *mesh);
/* The vertices only. */
bvx_status bvxi_read_ply_points(bvxi_source *source, bvx_mesh *points);

/* 1 when a mesh holds no array. */
int bvxi_mesh_is_empty(const bvx_mesh *m);
/* The arrays of a mesh that is read, in exact sizes. */
bvx_status bvxi_make_positions(bvx_context *ctx, bvx_mesh *mesh, int32_t type, uint64_t count);
bvx_status bvxi_make_triangles(bvx_context *ctx, bvx_mesh *mesh, uint64_t count);
bvx_status bvxi_make_uvs(bvx_context *ctx, bvx_mesh *mesh, uint64_t count);
/* Behind positions and triangles: BVXI_MESH_COLOURS, _UV_TRIANGLES, _NORMALS, _UVS2 or _MATERIALS. */
bvx_status bvxi_make_array(bvx_context *ctx, bvx_mesh *mesh, uint32_t array);
void bvxi_drop_uvs(bvx_context *ctx, bvx_mesh *mesh);

/* A share of 1 as a byte, to the nearest; what is beyond 0 and 1 is taken back to them. */
static inline uint8_t bvxi_colour_byte(double share)
{
    double const bytes = share > 0.0 ? share < 1.0 ? share * 255.0 + 0.5 : 255.0 : 0.0;
    return (uint8_t)bytes;
}

/* ---- writers: arguments are checked, positions with frame and uvs are finite, indices are in range ---- */

/* What is written of one mesh. */
typedef struct bvxi_written {
    const bvx_mesh *mesh;
    int normals;       /* 1: with normals */
    const double *sum; /* of bvxi_sum_normals, where the mesh has no normals */
} bvxi_written;

/* The normal of a vertex: the mesh's own at length 1, or by these sums. */
void bvxi_written_normal(const bvx_mesh *mesh, const double *sum, uint64_t vertex, float normal[3]);
/* The meshes with turned axes, BVX_TURN_...: scratch, which bvxi_drop_turned frees; NULL when nothing turns. */
bvx_status bvxi_turn_meshes(bvx_context *ctx, const bvx_mesh *meshes, uint64_t count, int32_t turn,
                            bvx_mesh **turned);

bvx_status bvxi_write_stl(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file);
bvx_status bvxi_write_obj(bvx_context *ctx, const bvxi_written *what, bvx_buffer *file);
bvx_status bvxi_write_ply(bvx_context *ctx, const bvxi_written *what, bvx_buffer *file);
bvx_status bvxi_write_3mf(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file);
bvx_status bvxi_write_off(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file);
/* The meshes as levels of detail of one file, the finest first. */
bvx_status bvxi_write_glb(bvx_context *ctx, const bvx_mesh *levels, uint64_t level_count,
                          const bvx_write_options *options, bvx_buffer *file);
/* write_kept.c: 1 when a level has the vertices of a source whose file is kept; that file with its triangles. */
int bvxi_glb_keeps(const bvx_mesh *level, const bvx_write_options *options);
bvx_status bvxi_write_kept(bvx_context *ctx, const bvx_mesh *level, const bvx_assets *assets,
                           bvx_buffer *file);

#define BVXI_NORMALS_SHARE 0.3 /* the part of a file's work that is done when its writer has them */

/* "GLB: level 3": how messages about one of several levels begin.
 * before: below 40 bytes; text [Size: BVXI_LEVEL_NAME] */
enum { BVXI_LEVEL_NAME = 80 };
void bvxi_level_name(const char *before, uint64_t level, char *text);

/* The least double that rounds to an infinite float: (2 - 2^-24) * 2^127. */
#define BVXI_FLOAT_LIMIT 3.4028235677973366e38

/* 1 when positions are written as floats: those that the mesh has, with no frame to add. */
static inline int bvxi_writes_f32(const bvx_mesh *mesh)
{
    return mesh->position_type == BVX_F32 && mesh->frame[0] == 0.0 && mesh->frame[1] == 0.0 &&
           mesh->frame[2] == 0.0;
}

/* Texture coordinates that a mesh really has: uv_count follows the capacity where they go with vertices. */
static inline uint64_t bvxi_written_uvs(const bvx_mesh *mesh)
{
    return mesh->uvs == NULL ? 0 : mesh->uv_triangles != NULL ? mesh->uv_count : mesh->vertex_count;
}

/* A vertex in the world: with the frame. */
static inline void bvxi_world_position(const bvx_mesh *mesh, uint64_t vertex, double p[3])
{
    for (size_t a = 0; a < 3; a++) {
        size_t const i = (size_t)vertex * 3 + a;
        float f32;
        if (mesh->position_type == BVX_F64) {
            memcpy(&p[a], (const uint8_t *)mesh->positions + 8 * i, sizeof p[a]);
        } else {
            memcpy(&f32, (const uint8_t *)mesh->positions + 4 * i, sizeof f32);
            p[a] = (double)f32;
        }
        if (mesh->frame[a] != 0.0) p[a] += mesh->frame[a]; /* adding 0 would lose the sign of -0 */
    }
}

/* Its text: shortest decimals that read back to the same floats or doubles. */
static inline uint8_t *bvxi_put_vertex(const bvx_mesh *mesh, uint64_t vertex, uint8_t *at)
{
    int const f32 = bvxi_writes_f32(mesh);
    double p[3];
    bvxi_world_position(mesh, vertex, p);
    for (int a = 0; a < 3; a++) {
        if (a > 0) *at++ = ' ';
        at = f32 ? bvxi_put_float(at, (float)p[a]) : bvxi_put_double(at, p[a]);
    }
    return at;
}

/* ---- Polygons of a mesh that is read ---- */

/* A polygon of four corners or more. Its triangles stand in the mesh as a fan: (0, 1, 2), (0, 2, 3), (0, 3,
 * 4)... of its corners, in triangles and, where there are texture coordinates at corners, in uv_triangles. */
typedef struct bvxi_polygon_fan {
    uint32_t triangle; /* the first of its corners - 2 triangles */
    uint32_t corners;
} bvxi_polygon_fan;

/* Cut count polygons into triangles that neither overlap nor turn over. All
 * vertices of the mesh are there and finite. */
bvx_status bvxi_cut_fans(bvxi_source *source, bvx_mesh *mesh, const bvxi_polygon_fan *fans, uint64_t count);

/* ---- What the numbers of a file leave of a mesh ---- */

typedef struct bvxi_rounding {
    double largest_move; /* of a coordinate, by rounding [Units: world] */
    double mean_edge;    /* of triangles, before it [Units: world] */
    uint64_t spoilt;     /* triangles that had an area and have none or lie turned over */
    int finite;          /* 0: a coordinate is beyond the range of floats; the other members are not set */
} bvxi_rounding;

/* What a file's positions are relative to. */
typedef struct bvxi_file_frame {
    double origin[3];
    double step; /* positions are 0..65535 steps from it; 0: they are floats */
} bvxi_file_frame;

enum { BVXI_STEPS = 65535 };

/* The frame of one file with these levels. */
bvx_status bvxi_find_frame(bvx_context *ctx, const bvx_mesh *levels, uint64_t level_count, int32_t format,
                           int32_t quantize, bvxi_file_frame *frame);

/* 1 when the file's numbers are not exactly those of the mesh. */
int bvxi_is_rounded(const bvx_mesh *mesh, int32_t format, const bvxi_file_frame *frame);

/* Steps from the frame's origin along an axis, to the nearest; vertices without triangles may lie outside. */
static inline double bvxi_frame_steps(const bvxi_file_frame *frame, int axis, double p)
{
    double const steps = floor((p - frame->origin[axis]) / frame->step + 0.5);
    return steps > 0.0 ? steps < BVXI_STEPS ? steps : BVXI_STEPS : 0.0;
}

/* A position as readers of the file get it. */
static inline void bvxi_round_position(const bvxi_file_frame *frame, const double p[3], double rounded[3])
{
    for (int a = 0; a < 3; a++)
        rounded[a] = frame->step > 0.0 ? bvxi_frame_steps(frame, a, p[a]) * frame->step + frame->origin[a]
                                       : bvxi_nearest_float(p[a] - frame->origin[a]) + frame->origin[a];
}

/* The mesh is checked and not empty. */
void bvxi_measure_rounding(const bvx_mesh *mesh, const bvxi_file_frame *frame, bvxi_rounding *r);

/* 1 when the file is still the mesh: nothing moves far beside its edges, and few triangles are spoilt. */
int bvxi_rounding_fits(const bvxi_rounding *r, uint64_t triangles);

/* Measure, and refuse what does not fit. name: what messages begin with. */
bvx_status bvxi_refuse_rounding(bvx_context *ctx, const char *name, const bvx_mesh *mesh, int32_t format,
                                const bvxi_file_frame *frame);

#endif
