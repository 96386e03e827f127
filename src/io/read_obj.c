/* read_obj.c - Wavefront OBJ to an indexed mesh: vertices and polygonal faces.
 *
 * Two passes: the first counts vertices and triangles, so that the arrays are made once in their exact size; the second
 * fills them. A face may name vertices that stand behind it; negative numbers count back from the last vertex before
 * it. Texture and normal numbers must be numbers but are not looked up. What follows three coordinates (a weight,
 * colours) is left out, like every statement but v and f: nothing that a file names (mtllib, call, csh) is opened.
 * A backslash before a line's end continues v and f. In other lines it is ignored, as comments and file names end in
 * backslashes too, and what follows is no v or f.
 * Memory: the mesh alone. Cost: O(bytes). */
#include "io/formats.h"

/* The file, and what stands between lines: newline, or carriage return in files that have no newline. */
typedef struct obj_file {
    bvxi_source *source;
    char line_end;
    uint64_t vertex_total, vertex_count, triangle_total, triangle_count; /* counted first, then found so far */
    double *positions;
    uint32_t *triangles;
} obj_file;

/* Bytes of a continued line's end at p, 0 when there is none. */
static size_t obj_continued(const obj_file *f, const char *p)
{
    const char *const end = f->source->end;
    if (*p != '\\') return 0;
    if (p + 1 == end) return 1;
    if (p[1] == f->line_end) return 2;
    return end - p >= 3 && p[1] == '\r' && p[2] == f->line_end ? 3 : 0;
}

static int obj_is_blank(const obj_file *f, char c)
{
    return bvxi_is_blank(c) && c != f->line_end;
}

/* The next word of a statement, or its end. */
static const char *obj_skip_blank(const obj_file *f, const char *p)
{
    const char *const end = f->source->end;
    while (p < end) {
        size_t n;
        if (BVXI_LIKELY((unsigned char)*p > ' ' && *p != '\\')) break;
        if (obj_is_blank(f, *p)) p++;
        else if ((n = obj_continued(f, p)) != 0) p += n;
        else break;
    }
    return p;
}

static int obj_statement_ends(const obj_file *f, const char *p)
{
    return p == f->source->end || *p == f->line_end || *p == '#';
}

/* 1 behind a word. Characters above a space are inside it, but for a backslash perhaps. */
static inline int obj_word_ends(const obj_file *f, const char *p)
{
    if (p == f->source->end) return 1;
    if (BVXI_LIKELY((unsigned char)*p > ' ' && *p != '\\')) return 0;
    return *p == f->line_end || bvxi_is_blank(*p) || obj_continued(f, p) != 0;
}

static const char *obj_next_line(const obj_file *f, const char *p)
{
    const char *const end = f->source->end;
    const char *const at = bvxi_find_byte(p, end, f->line_end);
    return at == end ? end : at + 1;
}

/* The statement at p: 'v' or 'f', or 0 for any other. */
static char obj_keyword(const obj_file *f, const char *p)
{
    if (f->source->end - p < 2 || (*p != 'v' && *p != 'f')) return 0;
    return obj_is_blank(f, p[1]) || obj_continued(f, p + 1) != 0 ? *p : 0;
}

/* ---- first pass ---- */

static const char *obj_count_corners(const obj_file *f, const char *p, uint64_t *corners)
{
    *corners = 0;
    for (p = obj_skip_blank(f, p); !obj_statement_ends(f, p); p = obj_skip_blank(f, p)) {
        while (!obj_word_ends(f, p)) p++;
        ++*corners;
    }
    return p;
}

static bvx_status obj_count(obj_file *f)
{
    bvxi_source *const s = f->source;
    for (const char *p = bvxi_skip_mark(s->begin, s->end); p < s->end; p = obj_next_line(f, p)) {
        BVXI_TRY(bvxi_source_at(s, p));
        p = obj_skip_blank(f, p);
        if (p == s->end) break;
        switch (obj_keyword(f, p)) {
        case 'v': f->vertex_total++; break;
        case 'f': {
            uint64_t corners;
            p = obj_count_corners(f, p + 1, &corners);
            f->triangle_total += corners < 3 ? 0 : corners - 2; /* fewer are refused later, with their line */
            break;
        }
        default: break;
        }
    }
    return BVX_OK;
}

/* ---- second pass ---- */

static bvx_status obj_take_vertex(obj_file *f, const char **p)
{
    const bvxi_source *const s = f->source;
    double *const out = f->positions + (size_t)f->vertex_count * 3;
    for (int a = 0; a < 3; a++) {
        const char *const at = obj_skip_blank(f, *p);
        size_t const used = obj_statement_ends(f, at) ? 0 : bvxi_parse_double(at, s->end, &out[a]);
        *p = at + used;
        if (used == 0 || !obj_word_ends(f, *p)) return bvxi_fail_expected(s, at, "a coordinate");
        if (!(out[a] - out[a] == 0.0))
            return bvxi_fail(s->ctx, BVX_ERR_RANGE, "OBJ: line %u: vertex %u has a coordinate that is not finite",
                             bvxi_source_line(s, at), f->vertex_count + 1);
    }
    f->vertex_count++;
    return BVX_OK;
}

/* A whole number at *p with an optional sign; very large ones stay very large. 0 when there is none. */
static int obj_take_integer(const char **p, const char *end, int64_t *value)
{
    const char *t = *p;
    int negative = 0;
    int64_t v = 0;
    if (t < end && (*t == '-' || *t == '+')) negative = *t++ == '-';
    if (t == end || *t < '0' || *t > '9') return 0;
    for (; t < end && *t >= '0' && *t <= '9'; t++)
        if (v < INT64_C(100000000000000000)) v = v * 10 + (*t - '0');
    *value = negative ? -v : v;
    *p = t;
    return 1;
}

/* v, v/t, v//n or v/t/n; the numbers behind a slash may be missing. */
static bvx_status obj_take_corner(const obj_file *f, const char **p, uint32_t *vertex)
{
    const bvxi_source *const s = f->source;
    const char *const at = *p;
    int64_t number, other, index;
    int good = obj_take_integer(p, s->end, &number);
    for (int slash = 0; good && slash < 2 && *p < s->end && **p == '/'; slash++) {
        ++*p;
        obj_take_integer(p, s->end, &other);
    }
    if (!good || !obj_word_ends(f, *p)) return bvxi_fail_expected(s, at, "a face's corner (v, v/t, v//n or v/t/n)");
    index = number < 0 ? (int64_t)f->vertex_count + number : number - 1;
    if (index < 0 || (uint64_t)index >= f->vertex_total)
        return bvxi_fail(s->ctx, BVX_ERR_RANGE,
                         "OBJ: line %u: the face names vertex %d; there are %u, %u of them before it",
                         bvxi_source_line(s, at), number, f->vertex_total, f->vertex_count);
    *vertex = (uint32_t)index;
    return BVX_OK;
}

static void obj_add_triangle(obj_file *f, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t *const t = f->triangles + (size_t)f->triangle_count++ * 3;
    t[0] = a;
    t[1] = b;
    t[2] = c;
}

/* A face becomes a fan from its first corner. */
static bvx_status obj_take_face(obj_file *f, const char **p)
{
    const char *const at = *p;
    uint32_t first = 0, previous = 0, vertex = 0;
    uint64_t corners = 0;
    for (*p = obj_skip_blank(f, *p); !obj_statement_ends(f, *p); *p = obj_skip_blank(f, *p), corners++) {
        BVXI_TRY(obj_take_corner(f, p, &vertex));
        if (corners == 0) first = vertex;
        if (corners >= 2) obj_add_triangle(f, first, previous, vertex);
        previous = vertex;
    }
    if (corners < 3)
        return bvxi_fail(f->source->ctx, BVX_ERR_FORMAT, "OBJ: line %u: a face of %u corners; it needs three",
                         bvxi_source_line(f->source, at), corners);
    return BVX_OK;
}

static bvx_status obj_fill(obj_file *f)
{
    bvxi_source *const s = f->source;
    for (const char *p = bvxi_skip_mark(s->begin, s->end); p < s->end; p = obj_next_line(f, p)) {
        BVXI_TRY(bvxi_source_at(s, p));
        p = obj_skip_blank(f, p);
        if (p == s->end) break;
        char const keyword = obj_keyword(f, p);
        if (keyword == 0) continue;
        p++;
        BVXI_TRY(keyword == 'v' ? obj_take_vertex(f, &p) : obj_take_face(f, &p));
    }
    return BVX_OK;
}

static bvx_status obj_check_counts(const obj_file *f)
{
    bvx_context *const ctx = f->source->ctx;
    if (f->vertex_total > UINT32_MAX)
        return bvxi_fail(ctx, BVX_ERR_RANGE, "OBJ: the file has %u vertices, the limit is below 2^32", f->vertex_total);
    if (f->triangle_total > INT32_MAX)
        return bvxi_fail(ctx, BVX_ERR_RANGE, "OBJ: the file has %u triangles, the limit is below 2^31",
                         f->triangle_total);
    return BVX_OK;
}

bvx_status bvxi_read_obj(bvxi_source *source, bvx_mesh *mesh)
{
    obj_file f = {0};
    f.source = source;
    f.line_end = bvxi_find_byte(source->begin, source->end, '\n') == source->end &&
                         bvxi_find_byte(source->begin, source->end, '\r') != source->end
                     ? '\r'
                     : '\n';
    bvxi_source_pass(source, 0, 0.25);
    BVXI_TRY(obj_count(&f));
    BVXI_TRY(obj_check_counts(&f));
    BVXI_TRY(bvxi_make_positions(source->ctx, mesh, BVX_F64, f.vertex_total));
    BVXI_TRY(bvxi_make_triangles(source->ctx, mesh, f.triangle_total));
    f.positions = mesh->positions;
    f.triangles = mesh->triangles;
    bvxi_source_pass(source, 0.25, 1);
    BVXI_TRY(obj_fill(&f));
    if (f.triangle_count == 0) return bvxi_fail(source->ctx, BVX_ERR_EMPTY, "OBJ: the file has no face");
    return BVX_OK;
}
