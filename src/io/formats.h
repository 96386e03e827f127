/* formats.h - the readers and writers behind bvx_read_mesh and
 * bvx_write_mesh, and what they share. Not installed. */
#ifndef BVXI_FORMATS_H
#define BVXI_FORMATS_H

#include "core/core.h"
#include "io/bytes.h"

/* ---- readers: arguments are checked, mesh is all zero and freed by the caller on failure ---- */

/* The bytes of a file, and where reading asks for progress next. */
typedef struct bvxi_source {
    bvx_context *ctx;
    const char *format; /* "STL", for messages */
    const char *begin, *end;
    const char *ask;   /* progress is asked when reading comes here */
    double from, to;   /* share of this pass over the bytes */
    double reached;    /* the greatest fraction reported: it never falls when bytes are read again */
    int32_t takes_any; /* 1: coordinates that are not finite are taken, to be dropped later */
} bvxi_source;

bvx_status bvxi_read_stl(bvxi_source *source, bvx_mesh *mesh);
bvx_status bvxi_read_obj(bvxi_source *source, bvx_mesh *mesh);
bvx_status bvxi_read_ply(bvxi_source *source, bvx_mesh *mesh);
bvx_status bvxi_read_off(bvxi_source *source, bvx_mesh *mesh);
/* The vertices alone. */
bvx_status bvxi_read_ply_points(bvxi_source *source, bvx_mesh *points);

/* Start a pass over the bytes that is the part [from, to] of the work. */
void bvxi_source_pass(bvxi_source *source, double from, double to);
bvx_status bvxi_source_ask(bvxi_source *source, const char *at);

/* Report progress once a megabyte; BVX_CANCELLED when the caller wants to stop. */
static inline bvx_status bvxi_source_at(bvxi_source *source, const char *at)
{
    return BVXI_LIKELY(at < source->ask) ? BVX_OK : bvxi_source_ask(source, at);
}

/* Pieces of a file may be read at the same time. Each has a source of its own without context: there a
 * failure is a status alone, and the piece that failed first is read again with the context, for its
 * message. */
#define BVXI_SOURCE_FAIL(source, status, ...) \
    ((source)->ctx == NULL ? (status) : bvxi_fail((source)->ctx, (status), __VA_ARGS__))

/* Run count tasks, each for about BVXI_PIECE_BYTES of the file, as the part [from, to] of the work. */
enum { BVXI_PIECE_BYTES = 1 << 19 };
bvx_status bvxi_source_pieces(bvxi_source *source, double from, double to, int32_t count, bvx_task_fn *task,
                              void *user);

/* "STL: line 7: expected ..., found '...'": what stands at a place of a text file. */
BVXI_COLD bvx_status bvxi_fail_expected(const bvxi_source *source, const char *at, const char *expected);
/* Lines are counted from 1. */
BVXI_COLD uint64_t bvxi_source_line(const bvxi_source *source, const char *at);
static inline uint64_t bvxi_source_byte(const bvxi_source *source, const void *at)
{
    return (uint64_t)((const char *)at - source->begin);
}

/* 1 when a mesh holds no array. */
int bvxi_mesh_is_empty(const bvx_mesh *m);
/* The arrays of a mesh that is read, in exact sizes. */
bvx_status bvxi_make_positions(bvx_context *ctx, bvx_mesh *mesh, int32_t type, uint64_t count);
bvx_status bvxi_make_triangles(bvx_context *ctx, bvx_mesh *mesh, uint64_t count);
/* Behind positions and triangles: colours of the vertices, texture
 * coordinates, and numbers of these for the triangles. */
bvx_status bvxi_make_colours(bvx_context *ctx, bvx_mesh *mesh);
bvx_status bvxi_make_uvs(bvx_context *ctx, bvx_mesh *mesh, uint64_t count);
bvx_status bvxi_make_uv_triangles(bvx_context *ctx, bvx_mesh *mesh);
void bvxi_drop_colours(bvx_context *ctx, bvx_mesh *mesh);
void bvxi_drop_uvs(bvx_context *ctx, bvx_mesh *mesh);

/* A share of 1 as a byte, to the nearest; what is beyond 0 and 1 is taken back to them. */
static inline uint8_t bvxi_colour_byte(double share)
{
    double const bytes = share > 0.0 ? share < 1.0 ? share * 255.0 + 0.5 : 255.0 : 0.0;
    return (uint8_t)bytes;
}

/* ---- text ---- */

/* Space between words of one line; a carriage return is one, so that both kinds of line ends are read. */
static inline int bvxi_is_blank(char c)
{
    return c == ' ' || c == '\t' || c == '\r' || c == '\v' || c == '\f';
}

static inline int bvxi_is_space(char c)
{
    return c == ' ' || (c >= '\t' && c <= '\r');
}

static inline const char *bvxi_skip_space(const char *p, const char *end)
{
    while (p < end && bvxi_is_space(*p)) p++;
    return p;
}

static inline const char *bvxi_skip_word(const char *p, const char *end)
{
    while (p < end && !bvxi_is_space(*p)) p++;
    return p;
}

/* A whole number at *p with an optional sign; very large ones stay very large. 0 when there is none. */
static inline int bvxi_take_integer(const char **p, const char *end, int64_t *value)
{
    const char *t = *p;
    int const negative = t < end && *t == '-';
    int64_t v = 0;
    unsigned d;

    t += negative || (t < end && *t == '+');
    const char *const digits = t, *const safe = end - t > 18 ? t + 18 : end; /* 18 digits always fit */
    for (; t < safe && (d = (unsigned)(unsigned char)*t - '0') <= 9; t++) v = v * 10 + (int64_t)d;
    if (t == digits) return 0;
    if (BVXI_UNLIKELY(t == safe))
        for (; t < end && (d = (unsigned)(unsigned char)*t - '0') <= 9; t++)
            if (v < INT64_C(100000000000000000)) v = v * 10 + (int64_t)d;
    *value = negative ? -v : v;
    *p = t;
    return 1;
}

/* A byte order mark is no part of the text. */
static inline const char *bvxi_skip_mark(const char *p, const char *end)
{
    return end - p >= 3 && memcmp(p, "\xef\xbb\xbf", 3) == 0 ? p + 3 : p;
}

/* ---- writers: arguments are checked, positions with frame and uvs are finite, indices are in range ---- */

/* What is written of one mesh; normal: the sums of bvxi_sum_normals, or NULL for a file without normals. */
typedef struct bvxi_written {
    const bvx_mesh *mesh;
    const double *normal;
} bvxi_written;

bvx_status bvxi_write_stl(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file);
bvx_status bvxi_write_obj(bvx_context *ctx, const bvxi_written *what, bvx_buffer *file);
bvx_status bvxi_write_ply(bvx_context *ctx, const bvxi_written *what, bvx_buffer *file);
bvx_status bvxi_write_off(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file);
/* The meshes as levels of detail of one file, the finest first. */
bvx_status bvxi_write_glb(bvx_context *ctx, const bvx_mesh *levels, uint64_t level_count, bvx_buffer *file);

/* Sums of bvxi_add_normals as scratch: BVXI_NORMAL_SUM bytes a vertex, freed by the caller. */
enum { BVXI_NORMAL_SUM = 24 };
#define BVXI_NORMALS_SHARE 0.3 /* the part of a file's work that is done when its writer has them */
bvx_status bvxi_sum_normals(bvx_context *ctx, const bvx_mesh_view *view, double scale, double **sum);

/* "GLB: level 3": how messages about one of several levels begin.
 * before: below 40 bytes; text [Size: BVXI_LEVEL_NAME] */
enum { BVXI_LEVEL_NAME = 80 };
void bvxi_level_name(const char *before, uint64_t level, char *text);

/* The least double that rounds to an infinite float: (2 - 2^-24) * 2^127. */
#define BVXI_FLOAT_LIMIT 3.4028235677973366e38

/* A buffer of exactly size bytes. */
/* A file to be made: bytes that the library made for another one go; those of others are refused. */
bvx_status bvxi_renew_buffer(bvx_context *ctx, const char *function, bvx_buffer *file);
bvx_status bvxi_make_buffer(bvx_context *ctx, uint64_t size, const char *what, bvx_buffer *file);

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

/* format.c: refuse a format that is not one of a set of the header's
 * (BVX_MESHES_READ ...), with the endings of those. */
BVXI_COLD bvx_status bvxi_fail_format(bvx_context *ctx, bvx_status status, const char *function,
                                      const char *what, int32_t format, int32_t set);

#endif
