/* formats.h - the readers and writers behind bvx_read_mesh and bvx_write_mesh, and what they share. Not installed. */
#ifndef BVXI_FORMATS_H
#define BVXI_FORMATS_H

#include "core/core.h"
#include "io/bytes.h"

/* ---- readers: arguments are checked, mesh is all zero and freed by the caller on failure ---- */

/* The bytes of a file, and where reading asks for progress next. */
typedef struct bvxi_source {
    bvx_context *ctx;
    const char *format;     /* "STL", for messages */
    const char *begin, *end;
    const char *ask;        /* progress is asked when reading comes here */
    double from, to;        /* share of this pass over the bytes */
    double reached;         /* the greatest fraction reported: it never falls when bytes are read again */
} bvxi_source;

bvx_status bvxi_read_stl(bvxi_source *source, bvx_mesh *mesh);
bvx_status bvxi_read_obj(bvxi_source *source, bvx_mesh *mesh);
bvx_status bvxi_read_ply(bvxi_source *source, bvx_mesh *mesh);

/* Start a pass over the bytes that is the part [from, to] of the work. */
void bvxi_source_pass(bvxi_source *source, double from, double to);
bvx_status bvxi_source_ask(bvxi_source *source, const char *at);

/* Report progress once a megabyte; BVX_CANCELLED when the caller wants to stop. */
static inline bvx_status bvxi_source_at(bvxi_source *source, const char *at)
{
    return BVXI_LIKELY(at < source->ask) ? BVX_OK : bvxi_source_ask(source, at);
}

/* "STL: line 7: expected ..., found '...'": what stands at a place of a text file. */
BVXI_COLD bvx_status bvxi_fail_expected(const bvxi_source *source, const char *at, const char *expected);
/* Lines are counted from 1. */
BVXI_COLD uint64_t bvxi_source_line(const bvxi_source *source, const char *at);
static inline uint64_t bvxi_source_byte(const bvxi_source *source, const void *at)
{
    return (uint64_t)((const char *)at - source->begin);
}

/* The arrays of a mesh that is read, in exact sizes. */
bvx_status bvxi_make_positions(bvx_context *ctx, bvx_mesh *mesh, int32_t type, uint64_t count);
bvx_status bvxi_make_triangles(bvx_context *ctx, bvx_mesh *mesh, uint64_t count);

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

/* A byte order mark is no part of the text. */
static inline const char *bvxi_skip_mark(const char *p, const char *end)
{
    return end - p >= 3 && memcmp(p, "\xef\xbb\xbf", 3) == 0 ? p + 3 : p;
}

/* ---- writers: arguments are checked, positions with frame are finite, indices are in range ---- */

bvx_status bvxi_write_stl(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file);
bvx_status bvxi_write_obj(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file);
bvx_status bvxi_write_ply(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file);

/* A buffer of exactly size bytes. */
bvx_status bvxi_make_buffer(bvx_context *ctx, uint64_t size, const char *what, bvx_buffer *file);

/* 1 when positions are written as floats: those that the mesh has, with no frame to add. */
static inline int bvxi_writes_f32(const bvx_mesh *mesh)
{
    return mesh->position_type == BVX_F32 && mesh->frame[0] == 0.0 && mesh->frame[1] == 0.0 && mesh->frame[2] == 0.0;
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

#endif
