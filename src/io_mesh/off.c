/* off.c - Object File Format (OFF, COFF, NOFF, STOFF and what they combine to), to meshes and from them. */
#include "io_mesh/mesh_formats.h"

/* ---- Read ---- */

/* The keyword may be missing, and the counts may follow it at once. All space is equal, line ends too, with
 * two exceptions: what follows a face's corners on their line is its colour, which is left out; and where the
 * file has a line for each vertex and face, what follows a vertex on its line are its own words: a colour of
 * three or four numbers, texture coordinates, or something that nobody knows. So vertices of a plain OFF file
 * may have colours: they are taken when all of them do. Colours are numbers from 0 to 255, or from 0 to 1
 * when one is written with a point or an exponent and none is greater than 1.
 *
 * Counts that the bytes cannot hold are refused before anything is made of their size. Faces are read once
 * where all are triangles, and a second time where that has shown polygons. Memory: the mesh, 8 bytes a
 * polygon. Cost: O(bytes). */

enum { OFF_LINE_WORDS = 6, OFF_LEAST_VERTEX = 6, OFF_LEAST_FACE = 8 };

typedef struct off_file {
    bvxi_source *source;
    bvx_mesh *mesh;
    const char *p;
    int has_uvs, has_colours, has_normals; /* by the keyword */
    /* 1: words after a vertex on its line are its own; -1: not known yet */
    int by_lines;
    const char *first; /* vertex */
    uint64_t vertex_count, face_count;
    uint64_t triangle_count, polygon_count; /* found so far */
    uint64_t room, fan_room;                /* that there are arrays for */
    bvxi_polygon_fan *fans;
} off_file;

typedef struct off_words {
    double value[OFF_LINE_WORDS];
    int has_point[OFF_LINE_WORDS];
    int count, good; /* good 0: one was no number, or there were more */
} off_words;

/* ---- words ---- */

static inline const char *off_skip(const char *p, const char *end)
{
    for (;;) {
        p = bvxi_skip_space(p, end);
        if (p == end || *p != '#') return p;
        p = bvxi_line_end(p, end);
    }
}

static inline int off_word_ends(const char *p, const char *end)
{
    return p == end || bvxi_is_space(*p) || *p == '#';
}

static inline const char *off_skip_blank(const char *p, const char *end)
{
    while (p < end && bvxi_is_blank(*p) && *p != '\r') p++;
    return p < end && *p == '#' ? bvxi_line_end(p, end) : p;
}

static bvx_status off_take_integer(off_file *f, const char *expected, int64_t *value)
{
    const char *const end = f->source->end, *const at = off_skip(f->p, end);
    const char *p = at;
    if (!bvxi_take_integer(&p, end, value) || !off_word_ends(p, end))
        return bvxi_fail_expected(f->source, at, expected);
    f->p = p;
    return BVX_OK;
}

static bvx_status off_take_number(off_file *f, const char *expected, double *value)
{
    const char *const end = f->source->end, *const at = off_skip(f->p, end);
    size_t const used = bvxi_parse_double(at, end, value);
    if (used == 0 || !off_word_ends(at + used, end)) return bvxi_fail_expected(f->source, at, expected);
    f->p = at + used;
    return BVX_OK;
}

/* One of the words after a vertex, which starts at p; returns its end. */
static const char *off_add_word(off_words *words, const char *p, const char *end)
{
    const char *stop = p;
    double value = 0.0;

    /* Every word is stepped over, also one that cannot be a colour: the line must end where it does. */
    while (!off_word_ends(stop, end)) stop++;
    if (words->count == OFF_LINE_WORDS || bvxi_parse_double(p, end, &value) != (size_t)(stop - p)) {
        words->good = 0;
        return stop;
    }
    words->has_point[words->count] = 0;
    for (; p < stop; p++) words->has_point[words->count] |= *p == '.' || *p == 'e' || *p == 'E';
    words->value[words->count++] = value;
    return stop;
}

/* ---- head ---- */

static bvx_status off_take_keyword(off_file *f)
{
    bvxi_source *const s = f->source;
    const char *const at = off_skip(bvxi_skip_mark(s->begin, s->end), s->end);
    const char *const end = s->end, *p = at;
    int dimensions;

    /* The letters have one order; one of another order is
     * no keyword, and so the file does not begin with one. */
    if ((f->has_uvs = end - p >= 2 && p[0] == 'S' && p[1] == 'T') != 0) p += 2;
    if ((f->has_colours = p < end && *p == 'C') != 0) p++;
    if ((f->has_normals = p < end && *p == 'N') != 0) p++;
    if ((dimensions = p < end && *p == '4') != 0) p++;
    if (p < end && *p == 'n') {
        dimensions = 1;
        p++;
    }
    p = end - p >= 3 && memcmp(p, "OFF", 3) == 0 ? p + 3 : NULL;

    /* The keyword may be missing: a number is the first count then, and the letters found mean nothing. */
    f->p = at;
    if (p == NULL && at < s->end && ((*at >= '0' && *at <= '9') || *at == '-' || *at == '+')) {
        f->has_uvs = f->has_colours = f->has_normals = 0;
        return BVX_OK;
    }
    if (p == NULL || !(off_word_ends(p, s->end) || (*p >= '0' && *p <= '9')))
        return bvxi_fail_expected(s, at, "OFF or the number of vertices");

    /* Vertices of another dimension and the binary form have other lines: better refused than misread. */
    if (dimensions)
        return BVXI_LINE_FAIL(s, at, BVX_ERR_UNSUPPORTED, "vertices of four or any dimensions are not read");
    f->p = off_skip_blank(p, s->end);
    if (s->end - f->p >= 6 && memcmp(f->p, "BINARY", 6) == 0)
        return BVXI_LINE_FAIL(s, f->p, BVX_ERR_UNSUPPORTED, "the binary form is not read; write it as text");
    return BVX_OK;
}

static bvx_status off_take_counts(off_file *f)
{
    const bvxi_source *const s = f->source;
    const char *const at = off_skip(f->p, s->end);
    int64_t vertices, faces, edges;

    BVXI_TRY(off_take_integer(f, "the number of vertices", &vertices));
    BVXI_TRY(off_take_integer(f, "the number of faces", &faces));
    BVXI_TRY(off_take_integer(f, "the number of edges", &edges)); /* which nobody counts: any will do */

    /* Each count is held against the bytes that are left,
     * so a number alone cannot make the reader allocate. */
    uint64_t const line = bvxi_source_line(s, at), left = (uint64_t)(s->end - f->p);
    if (vertices < 0 || faces < 0)
        return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT, "line %u: %d vertices and %d faces are not counts", line,
                              vertices, faces);
    if (vertices == 0 || faces == 0)
        return BVXI_FILE_FAIL(s, BVX_ERR_EMPTY, "line %u: %d vertices and %d faces are not a mesh", line,
                              vertices, faces);
    if ((uint64_t)vertices > left / OFF_LEAST_VERTEX ||
        (uint64_t)faces > (left - (uint64_t)vertices * OFF_LEAST_VERTEX) / OFF_LEAST_FACE)
        return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT,
                              "line %u: %d vertices and %d faces do not fit the %u bytes that follow", line,
                              vertices, faces, left);
    if (vertices > (int64_t)UINT32_MAX)
        return BVXI_FILE_FAIL_FOR(s, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                  "line %u: %d vertices, the limit is below 2^32", line, vertices);
    f->vertex_count = (uint64_t)vertices;
    f->face_count = (uint64_t)faces;
    return BVX_OK;
}

/* ---- vertices ---- */

/* Behind a vertex: when words follow on its line, is there a line for each vertex and face? */
static bvx_status off_learn_lines(off_file *f, uint64_t vertex)
{
    const char *const end = f->source->end;
    uint64_t lines;
    int const promised = f->has_colours || f->has_uvs;

    /* The first vertex with words after it decides, by a count of all lines that is made once. */
    if (bvxi_line_ends(off_skip_blank(f->p, end), end)) {
        if (promised) f->by_lines = 0; /* and here they stand elsewhere */
        return BVX_OK;
    }
    /* Lines that hold a word, from the first vertex on. */
    bvxi_source *const s = f->source;

    lines = 0;
    bvxi_source_pass(s, 0, 0.1);
    for (const char *p = off_skip(f->first, s->end); p < s->end;
         p = off_skip(bvxi_line_end(p, s->end), s->end)) {
        BVXI_TRY(bvxi_source_at(s, p));
        ++lines;
    }
    bvxi_source_pass(s, 0, 1);
    f->by_lines = lines >= f->vertex_count + f->face_count;
    /* Colours that the keyword does not promise may begin at
     * the first vertex only: all vertices have them or none. */
    return f->by_lines && vertex == 0 && !promised
               ? bvxi_make_array(f->source->ctx, f->mesh, BVXI_MESH_COLOURS)
               : BVX_OK;
}

static bvx_status off_take_position(off_file *f, uint64_t vertex)
{
    double *const out = (double *)f->mesh->positions + (size_t)vertex * 3;
    double normal;

    for (int a = 0; a < 3; a++) {
        BVXI_TRY(off_take_number(f, "a coordinate", &out[a]));
        if (!(out[a] - out[a] == 0.0) && !f->source->takes_any)
            return BVXI_LINE_FAIL_FOR(f->source, f->p, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                      "vertex %i has a coordinate that is not finite", vertex);
    }

    /* Normals are read to step over them: they stand between
     * the coordinates and what else the keyword promises. */
    for (int a = 0; a < 3 && f->has_normals; a++) BVXI_TRY(off_take_number(f, "a normal", &normal));
    return BVX_OK;
}

/* The words after a vertex: as many as its line has, or as the keyword says. */
static bvx_status off_take_words(off_file *f, off_words *words)
{
    const char *const end = f->source->end;
    int const wanted = (f->has_colours ? 4 : 0) + (f->has_uvs ? 2 : 0);

    words->count = 0;
    words->good = 1;

    /* By lines, the line's end closes the words; else the keyword's count does, over lines' ends. */
    if (f->by_lines == 1)
        for (f->p = off_skip_blank(f->p, end); !bvxi_line_ends(f->p, end); f->p = off_skip_blank(f->p, end))
            f->p = off_add_word(words, f->p, end);
    else
        for (int i = 0; i < wanted; i++) {
            const char *const at = off_skip(f->p, end);
            f->p = off_add_word(words, at, end);
            if (words->count == i) return bvxi_fail_expected(f->source, at, "a colour or texture coordinate");
        }
    return BVX_OK;
}

/* 1 when all are from 0 to 255. */
static int off_put_colour(const off_words *words, int count, uint8_t *out)
{
    int has_point = 0, within = 1;
    double greatest = 0.0;
    for (int i = 0; i < count; i++) {
        double const v = words->value[i];
        has_point |= words->has_point[i];
        within &= v >= 0.0 && v <= 255.0;
        if (v > greatest) greatest = v;
    }

    /* As shares only where a point was written and none is above 1: 1 1 1 without a point is nearly black. */
    out[3] = 255;
    for (int i = 0; i < count; i++)
        out[i] = bvxi_colour_byte(has_point && greatest <= 1.0 ? words->value[i] : words->value[i] / 255.0);
    return within;
}

/* What the keyword promises must be there; other colours count as none when one vertex lacks its own. */
static bvx_status off_put_words(off_file *f, uint64_t vertex, const off_words *words)
{
    const bvxi_source *const s = f->source;
    /* Texture coordinates come last on the line; what is
     * before them is the colour, of which four numbers count. */
    int const uvs = f->has_uvs ? 2 : 0, colours = words->count - uvs < 4 ? words->count - uvs : 4;

    if ((f->has_colours && colours < 3) || colours < 0)
        return BVXI_LINE_FAIL(s, f->p, BVX_ERR_FORMAT, "vertex %i has %d numbers after it; its %s", vertex,
                              (int64_t)words->count,
                              f->has_colours ? "colour needs three" : "texture coordinates are two");
    for (int i = 0; i < uvs; i++) {
        double const v = words->value[colours + i];
        if (!(v > -3.4e38 && v < 3.4e38))
            return BVXI_LINE_FAIL_FOR(s, f->p, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                      "vertex %i has a texture coordinate that is not finite", vertex);
        f->mesh->uvs[(size_t)vertex * 2 + (size_t)i] = (float)v;
    }

    /* A vertex with a wrong colour drops those of all, unless the keyword promised them. */
    if (f->mesh->colours == NULL) return BVX_OK;
    if (colours >= 3 && off_put_colour(words, colours, f->mesh->colours + (size_t)vertex * 4) && words->good)
        return BVX_OK;
    if (!f->has_colours) bvxi_mesh_release(s->ctx, f->mesh, BVXI_MESH_COLOURS);
    return BVX_OK;
}

/* ---- faces ---- */

static bvx_status off_take_corner(off_file *f, uint64_t face, uint32_t *vertex)
{
    int64_t v;
    BVXI_TRY(off_take_integer(f, "a vertex index", &v));
    if (v < 0 || (uint64_t)v >= f->vertex_count)
        return BVXI_LINE_FAIL_FOR(f->source, f->p, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                  "face %i names vertex %d, but there are %u", face, v, f->vertex_count);
    *vertex = (uint32_t)v;
    return BVX_OK;
}

static bvx_status off_take_all_faces(off_file *f)
{
    f->triangle_count = f->polygon_count = 0;
    bvxi_source_pass(f->source, 0, 1);
    for (uint64_t face = 0; face < f->face_count; face++) {
        BVXI_TRY(bvxi_source_at(f->source, f->p));

        /* Where there is room, a face's triangles become a fan, and one of more than three corners is kept
         * in mind. */
        uint32_t t[3] = {0, 0, 0};
        int64_t n;

        BVXI_TRY(off_take_integer(f, "a face's number of corners", &n));
        if (n < 3)
            return BVXI_LINE_FAIL(f->source, f->p, BVX_ERR_FORMAT, "face %i has %d corners; it needs three",
                                  face, n);
        /* A corner takes a digit and a space at least: a longer list cannot be in the file. */
        uint64_t const corners = (uint64_t)n;
        if (corners > (uint64_t)(f->source->end - f->p) / 2)
            return BVXI_LINE_FAIL(f->source, f->p, BVX_ERR_FORMAT,
                                  "face %i has %d corners, more than the file holds", face, n);
        if (corners > 3) {
            if (f->polygon_count < f->fan_room) {
                f->fans[f->polygon_count].triangle = (uint32_t)f->triangle_count;
                f->fans[f->polygon_count].corners = (uint32_t)corners;
            }
            f->polygon_count++;
        }

        BVXI_TRY(off_take_corner(f, face, &t[0]));
        BVXI_TRY(off_take_corner(f, face, &t[1]));
        for (uint64_t i = 2; i < corners; i++, t[1] = t[2], f->triangle_count++) {
            BVXI_TRY(off_take_corner(f, face, &t[2]));
            if (f->triangle_count < f->room)
                memcpy(f->mesh->triangles + (size_t)f->triangle_count * 3, t, sizeof t);
        }

        f->p = bvxi_line_end(f->p, f->source->end);
    }
    return BVX_OK;
}

static bvx_status off_make_room(off_file *f, uint64_t triangles, uint64_t polygons)
{
    bvx_context *const ctx = f->source->ctx;

    if (triangles > INT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "OFF: the file has %u triangles, the limit is below 2^31", triangles);

    bvxi_mesh_release(ctx, f->mesh, BVXI_MESH_TRIANGLES);
    f->mesh->triangle_count = f->mesh->triangle_capacity = 0;
    BVXI_TRY(bvxi_make_triangles(ctx, f->mesh, triangles));
    f->room = triangles;
    if (polygons == 0) return BVX_OK;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, polygons * sizeof *f->fans, "the polygons of the file", &f->fans));
    f->fan_room = polygons;
    return BVX_OK;
}

bvx_status bvxi_read_off(bvxi_source *source, bvx_mesh *mesh)
{
    off_file f = {.source = source, .mesh = mesh};
    BVXI_TRY(off_take_keyword(&f));
    BVXI_TRY(off_take_counts(&f));

    bvx_context *const ctx = f.source->ctx;
    off_words words;

    BVXI_TRY(bvxi_make_positions(ctx, f.mesh, BVX_F64, f.vertex_count));
    if (f.has_colours) BVXI_TRY(bvxi_make_array(ctx, f.mesh, BVXI_MESH_COLOURS));
    if (f.has_uvs) BVXI_TRY(bvxi_make_uvs(ctx, f.mesh, f.vertex_count));
    f.first = f.p;
    /* Not known yet: the first vertex that has words after it says what a line is. */
    f.by_lines = -1;
    for (uint64_t v = 0; v < f.vertex_count; v++) {
        BVXI_TRY(bvxi_source_at(f.source, f.p));
        BVXI_TRY(off_take_position(&f, v));
        if (f.by_lines < 0) BVXI_TRY(off_learn_lines(&f, v));
        if (f.by_lines != 1 && !f.has_colours && !f.has_uvs) continue;
        BVXI_TRY(off_take_words(&f, &words));
        BVXI_TRY(off_put_words(&f, v, &words));
    }

    const char *const start = f.p;

    /* A guess that is right for files of triangles: then one reading is enough. */
    BVXI_TRY(off_make_room(&f, f.face_count, 0));
    BVXI_TRY(off_take_all_faces(&f));
    if (f.polygon_count == 0) return BVX_OK;
    BVXI_TRY(off_make_room(&f, f.triangle_count, f.polygon_count));
    f.p = start;
    BVXI_TRY(off_take_all_faces(&f));
    return bvxi_cut_fans(f.source, f.mesh, f.fans, f.polygon_count);
}

/* ---- Written ---- */

/* COFF where vertices have colours: red, green, blue, alpha from 0 to 255. Coordinates are the shortest decimals that read back to the same floats, or doubles where the mesh has
 * doubles or a frame. Texture coordinates are left out: few programs read those of STOFF, and corners cannot
 * have their own. */

static uint8_t *off_put_vertices(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvx_mesh *const mesh = user;
    for (uint64_t v = begin; v < end; v++) {
        at = bvxi_put_vertex(mesh, v, at);
        if (mesh->colours != NULL)
            for (size_t c = 0; c < 4; c++)
                at = bvxi_put_number(bvxi_put_char(at, ' '), mesh->colours[(size_t)v * 4 + c]);
        *at++ = '\n';
    }
    return at;
}

static uint8_t *off_put_faces(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvx_mesh *const mesh = user;
    for (uint64_t t = begin; t < end; t++) {
        *at++ = '3';
        for (size_t k = 0; k < 3; k++)
            at = bvxi_put_number(bvxi_put_char(at, ' '), mesh->triangles[(size_t)t * 3 + k]);
        *at++ = '\n';
    }
    return at;
}

static void off_put_head(const bvx_mesh *mesh, bvxi_output *out)
{
    bvxi_output_print(out, "%s\n%u %u 0\n", mesh->colours != NULL ? "COFF" : "OFF", mesh->vertex_count,
                      mesh->triangle_count);
}

bvx_status bvxi_write_off(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file)
{
    uint64_t const number = bvxi_writes_f32(mesh) ? BVXI_FLOAT_MOST : BVXI_DOUBLE_MOST;
    bvxi_file_part part[2] = {{.put = off_put_vertices, .user = mesh}, {.put = off_put_faces, .user = mesh}};
    bvxi_output head = {0};

    off_put_head(mesh, &head);
    part[0].count = mesh->vertex_count;
    part[0].most = 3 * (number + 1) + (mesh->colours != NULL ? 4 * 4 : 0);
    part[1].count = mesh->triangle_count;
    part[1].most = 2 + 3 * (1 + bvxi_digits(mesh->vertex_count - 1));
    BVXI_TRY(bvxi_make_file(ctx, "the OFF file", 0.0, head.size, part, 2, file));
    head.bytes = file->bytes;
    head.size = 0;
    off_put_head(mesh, &head);
    return BVX_OK;
}
