/* obj_text.h - words, lines and statements of an OBJ file, and the pieces that it is read in. Both passes of
 * obj.c walk a file by these, so that their counts agree. Not installed. */
#ifndef BVXI_OBJ_TEXT_H
#define BVXI_OBJ_TEXT_H

#include "io_mesh/mesh_formats.h"

enum { OBJ_OTHER = 0, OBJ_VERTEX = 'v', OBJ_TEXTURE = 't', OBJ_FACE = 'f' };

/* Whole statements of the file. */
typedef struct obj_piece {
    const char *begin, *end;
    /* after the keyword of the first one; NULL when there is none */
    const char *vertex, *face;
    uint64_t vertices, uvs, triangles, polygons; /* in this piece, then in all before it */
    bvx_status status;
    int32_t pale;    /* 1: a vertex has no colour */
    int32_t bare;    /* 1: a corner has no texture coordinate */
    int32_t painted; /* 1: a statement names a material */
    int32_t differs; /* 1: a corner's vertex and texture coordinate have different numbers */
} obj_piece;

typedef struct obj_file {
    bvxi_source *source;
    const char *end;
    char line_end; /* newline, or carriage return in files that have no newline */
    obj_piece *pieces;
    int32_t piece_count, painted;
    uint64_t vertices, uvs, triangles, polygons;
    bvx_mesh *mesh;
    float *colours; /* red, green, blue as they stand in the file; NULL when they are not wanted */
    bvxi_polygon_fan *fans;
} obj_file;

/* ---- words and lines ---- */

/* bvxi_find_byte, eight bytes at a time. */
static inline const char *obj_find(const char *p, const char *end, char wanted)
{
    uint64_t const ones = UINT64_C(0x0101010101010101), pattern = ones * (unsigned char)wanted;
    for (uint64_t w; end - p >= 8; p += 8) {
        memcpy(&w, p, sizeof w);
        w ^= pattern;
        if (((w - ones) & ~w & ones << 7) != 0) break; /* a byte is zero */
    }
    return bvxi_find_byte(p, end, wanted);
}

/* Bytes of a continued line's end at p, 0 when there is none. */
static inline size_t obj_continued(const obj_file *f, const char *p)
{
    if (*p != '\\') return 0;
    if (p + 1 == f->end) return 1;
    if (p[1] == f->line_end) return 2;
    return f->end - p >= 3 && p[1] == '\r' && p[2] == f->line_end ? 3 : 0;
}

static inline int obj_is_blank(const obj_file *f, char c)
{
    return bvxi_is_blank(c) && c != f->line_end;
}

/* The next word of a statement, or its end. */
static inline const char *obj_skip_blank(const obj_file *f, const char *p)
{
    while (p < f->end) {
        size_t n;
        if (BVXI_LIKELY((unsigned char)*p > ' ' && *p != '\\')) break;
        if (obj_is_blank(f, *p)) p++;
        else if ((n = obj_continued(f, p)) != 0) p += n;
        else break;
    }
    return p;
}

static inline int obj_statement_ends(const obj_file *f, const char *p)
{
    return p == f->end || *p == f->line_end || *p == '#';
}

/* 1 after a word. Characters above a space are inside it, but for a backslash perhaps. */
static inline int obj_word_ends(const obj_file *f, const char *p)
{
    if (p == f->end) return 1;
    if (BVXI_LIKELY((unsigned char)*p > ' ' && *p != '\\')) return 0;
    return *p == f->line_end || bvxi_is_blank(*p) || obj_continued(f, p) != 0;
}

static inline const char *obj_next_line(const obj_file *f, const char *p)
{
    const char *const at = obj_find(p, f->end, f->line_end);
    return at == f->end ? at : at + 1;
}

/* 1 when a backslash stands before the line's end at p. */
static inline int obj_is_continued_end(const obj_file *f, const char *p)
{
    const char *const begin = f->source->begin;
    if (p > begin && p[-1] == '\r' && f->line_end != '\r') p--;
    return p > begin && p[-1] == '\\';
}

/* The line after a statement that goes on at p: after all its lines, unless a comment ends it before. */
static inline const char *obj_next_statement(const obj_file *f, const char *p)
{
    for (;;) {
        const char *const at = obj_find(p, f->end, f->line_end);
        if (at == f->end) return at;
        if (!obj_is_continued_end(f, at) || bvxi_find_byte(p, at, '#') != at) return at + 1;
        p = at + 1;
    }
}

/* The statement at *p; *p moves after its keyword unless it is another one. */
static inline int obj_take_keyword(const obj_file *f, const char **p)
{
    const char *t = *p;

    if (f->end - t < 2 || (*t != 'v' && *t != 'f')) return OBJ_OTHER;
    int keyword = *t++;
    if (keyword == OBJ_VERTEX && *t == 't' && f->end - t >= 2) {
        keyword = OBJ_TEXTURE;
        t++;
    }
    if (!obj_is_blank(f, *t) && obj_continued(f, t) == 0) return OBJ_OTHER;
    *p = t;
    return keyword;
}

#endif
