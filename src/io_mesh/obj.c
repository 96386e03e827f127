/* obj.c - Wavefront OBJ, to meshes and from them.
 *
 * Reading takes two passes over pieces of whole lines: the first counts, so that arrays have their exact
 * size and each piece knows its position in them. Guarantee: pieces follow from the file's size only, so
 * threads do not show. Nothing that a file names is opened. */
#include "io_mesh/obj_text.h"

/* ---- The first pass over a file: pieces of whole lines, and how much of everything stands in each ---- */

static const char *obj_count_corners(const obj_file *f, const char *p, uint64_t *corners)
{
    *corners = 0;
    for (p = obj_skip_blank(f, p); !obj_statement_ends(f, p); p = obj_skip_blank(f, p)) {
        /* most words are no more than this */
        while (p < f->end && (unsigned)(unsigned char)*p - '-' <= '9' - '-') p++;
        while (!obj_word_ends(f, p)) p++;
        ++*corners;
    }
    return p;
}

static void obj_count_piece(void *user, int32_t index)
{
    const obj_file *const f = user;
    obj_piece *const piece = &f->pieces[index];

    for (const char *p = piece->begin; p < piece->end;) {
        uint64_t corners;
        p = obj_skip_blank(f, p);
        switch (p < f->end ? obj_take_keyword(f, &p) : OBJ_OTHER) {
        case OBJ_VERTEX:
            if (piece->vertices++ == 0) piece->vertex = p;
            p = obj_next_statement(f, p);
            break;
        case OBJ_TEXTURE:
            piece->uvs++;
            p = obj_next_statement(f, p);
            break;
        case OBJ_FACE:
            if (piece->face == NULL) piece->face = p;
            p = obj_next_line(f, obj_count_corners(f, p, &corners));
            /* A fan has two triangles fewer than its polygon has corners. */
            piece->triangles += corners < 3 ? 0 : corners - 2; /* fewer are refused later, with their line */
            piece->polygons += corners > 3;
            break;
        default:
            piece->painted |= f->end - p > 6 && memcmp(p, "usemtl", 6) == 0;
            p = obj_next_line(f, p);
            break;
        }
    }
}

static uint64_t obj_count_before(uint64_t *here, uint64_t before)
{
    uint64_t const counted = *here;
    *here = before;
    return before + counted;
}

/* Cut the file into pieces and count what they hold; totals come to stand in the file, for each
 * piece the counts of all pieces before it. The pieces are freed by the caller, also after a failure. */
static bvx_status obj_count(obj_file *f)
{
    bvx_context *const ctx = f->source->ctx;

    /* Pieces end where a line ends that is not continued. */
    const bvxi_source *const s = f->source;
    uint64_t const size = bvxi_source_byte(s, s->end), count = size / BVXI_PIECE_BYTES + 1;
    const char *p = bvxi_skip_mark(s->begin, s->end);

    if (count > INT32_MAX)
        return BVXI_FILE_FAIL_FOR(s, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                  "the file has %u bytes, more than 2^50", size);
    f->piece_count = (int32_t)count;
    BVXI_TRY(BVXI_ZEROS(s->ctx, count, "the pieces of the file", f->pieces));
    for (uint64_t i = 0; i < count; i++) {
        /* A line that crosses the aim belongs to the piece before it, so each line is read once and whole. */
        const char *const aim = i + 1 < count ? s->begin + (size_t)(size / count * (i + 1)) : s->end;
        f->pieces[i].begin = p;
        while (p < s->end && (p < aim || obj_is_continued_end(f, p - 1)))
            p = obj_next_line(f, p < aim ? aim - 1 : p);
        f->pieces[i].end = p;
    }
    BVXI_TRY(bvxi_source_pieces(f->source, 0, 0.25, f->piece_count, obj_count_piece, f));

    for (int32_t i = 0; i < f->piece_count; i++) {
        obj_piece *const piece = &f->pieces[i];
        f->painted |= piece->painted;
        f->vertices = obj_count_before(&piece->vertices, f->vertices);
        f->uvs = obj_count_before(&piece->uvs, f->uvs);
        f->triangles = obj_count_before(&piece->triangles, f->triangles);
        f->polygons = obj_count_before(&piece->polygons, f->polygons);
    }

    /* Indices are 32 bits wide. */
    if (f->vertices > UINT32_MAX || f->uvs > UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "OBJ: the file has %u vertices and %u texture coordinates, the limit is below "
                             "2^32",
                             f->vertices, f->uvs);
    if (f->triangles > INT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "OBJ: the file has %u triangles, the limit is below 2^31", f->triangles);
    return BVX_OK;
}

/* ---- Wavefront OBJ to an indexed mesh: vertices, colours, texture coordinates and polygonal faces ---- */

/* Faces may name vertices that stand after them; negative numbers count back from the last vertex before them.
 * Polygons are cut into triangles at the end, when all vertices are known.
 * Behind three coordinates stand nothing, a weight, three colours, or a weight and three colours. Texture
 * coordinates are looked up when the first corner of the file has one, and dropped when another has none.
 * Normals must be numbers but are not looked up. Every statement but v, vt and f is left out: nothing that a
 * file names (mtllib, call, csh) is opened, and materials (usemtl) are reported as lost. A backslash before a line's end continues v, vt and f. In other
 * lines it is ignored, as comments and file names end in backslashes too, and what follows is no v, vt or f.
 * Memory: the mesh, 12 bytes a coloured vertex, 8 bytes a polygon. Cost: O(bytes). */

/* Where reading of a piece stands; source has no context when pieces are read at the same time. */
typedef struct obj_reader {
    const obj_file *file;
    obj_piece *piece;
    bvxi_source source;
    uint64_t vertices, uvs, triangles, polygons; /* found so far, with those of the pieces before */
} obj_reader;

static int obj_take_numbers(const obj_file *f, const char **p, int most, double *out)
{
    int n = 0;
    /* A number that a slash or a letter follows is no number here, and stays at *p. */
    for (; n < most; n++) {
        const char *const at = obj_skip_blank(f, *p);
        size_t const used = obj_statement_ends(f, at) ? 0 : bvxi_parse_double(at, f->end, &out[n]);
        if (used == 0 || !obj_word_ends(f, at + used)) break;
        *p = at + used;
    }
    return n;
}

/* The colour after the coordinates: the last three of three or four numbers. */
static bvx_status obj_take_colour(obj_reader *r, const char *p)
{
    const obj_file *const f = r->file;
    const char *const at = p;
    double number[5];
    int const n = obj_take_numbers(f, &p, 5, number);
    float *const out = f->colours + (size_t)r->vertices * 3;

    /* One vertex without a colour is enough to drop them all: this piece says so, and the end decides. */
    if ((n != 3 && n != 4) || !obj_statement_ends(f, obj_skip_blank(f, p))) {
        r->piece->pale = 1;
        return BVX_OK;
    }
    for (int c = 0; c < 3; c++) {
        double const v = number[n - 3 + c];
        if (!(v - v == 0.0))
            return BVXI_LINE_FAIL(&r->source, at, BVX_ERR_RANGE, "vertex %u has a colour that is not finite",
                                  r->vertices + 1);

        /* Whether 1 or 255 is the whole is known at the end, so the number itself is kept for now. */
        out[c] = v < 0.0 ? 0.0f : v < 255.0 ? (float)v : 255.0f;
    }
    return BVX_OK;
}

static bvx_status obj_take_vertex(obj_reader *r, const char *p)
{
    const obj_file *const f = r->file;
    double *const out = (double *)f->mesh->positions + (size_t)r->vertices * 3;

    for (int a = 0; a < 3; a++) {
        /* Nothing is a coordinate after the end of the statement,
         * even when the next line begins with a number. */
        const char *const at = obj_skip_blank(f, p);
        size_t const used = obj_statement_ends(f, at) ? 0 : bvxi_parse_double(at, f->end, &out[a]);
        p = at + used;
        if (used == 0 || !obj_word_ends(f, p)) return bvxi_fail_expected(&r->source, at, "a coordinate");
        if (!(out[a] - out[a] == 0.0) && !r->source.takes_any)
            return BVXI_LINE_FAIL(&r->source, at, BVX_ERR_RANGE,
                                  "vertex %u has a coordinate that is not finite", r->vertices + 1);
    }
    if (f->colours != NULL) BVXI_TRY(obj_take_colour(r, p));
    r->vertices++;
    return BVX_OK;
}

/* u, v and what follows; v is 0 where it is missing. */
static bvx_status obj_take_uv(obj_reader *r, const char *p)
{
    const obj_file *const f = r->file;

    /* Coordinates that no corner uses are counted only: the count is what negative indices refer to. */
    if (f->mesh->uvs != NULL) {
        float *const out = f->mesh->uvs + (size_t)r->uvs * 2;
        const char *const at = obj_skip_blank(f, p);
        double number[2] = {0, 0};
        if (obj_take_numbers(f, &p, 2, number) == 0)
            return bvxi_fail_expected(&r->source, at, "a texture coordinate");
        out[0] = (float)number[0];
        out[1] = (float)number[1];
        if (!(out[0] - out[0] == 0.0f && out[1] - out[1] == 0.0f))
            return BVXI_LINE_FAIL(&r->source, at, BVX_ERR_RANGE,
                                  "texture coordinate %u is not a finite float", r->uvs + 1);
    }
    r->uvs++;
    return BVX_OK;
}

/* The index that a number stands for: counted from 1, or back from the last one before it. */
static bvx_status obj_find_index(const obj_reader *r, const char *at, const char *what, int64_t number,
                                 uint64_t before, uint64_t total, uint32_t *index)
{
    /* Counting back needs what stands before this line in the
     * whole file, which the first pass counted for each piece. */
    int64_t const i = number < 0 ? (int64_t)before + number : number - 1;
    if (i < 0 || (uint64_t)i >= total)
        return BVXI_LINE_FAIL(&r->source, at, BVX_ERR_RANGE,
                              "the face names %s %d; there are %u, %u of them "
                              "before it",
                              what, number, total, before);
    *index = (uint32_t)i;
    return BVX_OK;
}

/* v, v/t, v//n or v/t/n; the numbers after a slash may be missing. index: of vertex and texture
 * coordinate. */
static bvx_status obj_take_corner(obj_reader *r, const char **p, uint32_t index[2])
{
    const obj_file *const f = r->file;
    const char *const at = *p;
    int64_t number, other[2];
    int have[2] = {0, 0};
    int const good = bvxi_take_integer(p, f->end, &number);

    /* v//n has nothing between its slashes: then have stays 0 for the texture coordinate. */
    for (int slash = 0; good && slash < 2 && *p < f->end && **p == '/'; slash++) {
        ++*p;
        have[slash] = bvxi_take_integer(p, f->end, &other[slash]);
    }
    if (!good || !obj_word_ends(f, *p))
        return bvxi_fail_expected(&r->source, at, "a face's corner (v, v/t, v//n or v/t/n)");
    BVXI_TRY(obj_find_index(r, at, "vertex", number, r->vertices, f->vertices, &index[0]));

    /* Without texture coordinates both halves are the vertex, so the fan copies them without a question. */
    index[1] = index[0];
    if (f->mesh->uvs == NULL) return BVX_OK;
    if (have[0]) BVXI_TRY(obj_find_index(r, at, "texture coordinate", other[0], r->uvs, f->uvs, &index[1]));
    else r->piece->bare = 1;
    r->piece->differs |= index[0] != index[1];
    return BVX_OK;
}

static bvx_status obj_take_face(obj_reader *r, const char **p)
{
    const obj_file *const f = r->file;
    const bvx_mesh *const mesh = f->mesh;
    const char *const at = *p;
    uint64_t const triangle = r->triangles;
    uint32_t first[2] = {0, 0}, previous[2] = {0, 0}, corner[2];
    uint64_t corners = 0;

    for (*p = obj_skip_blank(f, *p); !obj_statement_ends(f, *p); *p = obj_skip_blank(f, *p), corners++) {
        BVXI_TRY(obj_take_corner(r, p, corner));
        if (corners == 0) memcpy(first, corner, sizeof first);
        /* A triangle of the fan, for vertices (0) and texture coordinates (1). */
        for (int k = 0; corners >= 2 && k < (mesh->uv_triangles != NULL ? 2 : 1); k++) {
            uint32_t *const t = (k == 0 ? mesh->triangles : mesh->uv_triangles) + (size_t)r->triangles * 3;
            t[0] = first[k];
            t[1] = previous[k];
            t[2] = corner[k];
        }
        r->triangles += corners >= 2;
        memcpy(previous, corner, sizeof previous);
    }
    if (corners < 3)
        return BVXI_LINE_FAIL(&r->source, at, BVX_ERR_FORMAT, "a face of %u corners; it needs three",
                              corners);

    /* The fan is right for a triangle only: larger faces are
     * remembered, to be cut when all vertices are known. */
    if (corners > 3) {
        bvxi_polygon_fan *const fan = &f->fans[r->polygons++];
        fan->triangle = (uint32_t)triangle;
        fan->corners = (uint32_t)corners;
    }
    return BVX_OK;
}

/* Read a piece; a NULL context makes it silent. */
static bvx_status obj_read_piece(const obj_file *f, int32_t index, bvx_context *ctx)
{
    obj_piece *const piece = &f->pieces[index];

    obj_reader r = {.file = f, .piece = piece, .source = *f->source};
    r.source.ctx = ctx;

    /* The first pass counted what comes before this piece,
     * so its arrays begin there whoever reads the others. */
    r.vertices = piece->vertices;
    r.uvs = piece->uvs;
    r.triangles = piece->triangles;
    r.polygons = piece->polygons;
    for (const char *p = piece->begin; p < piece->end;) {
        /* The next statement is found before this one is read:
         * a bad number must not move the reader's place. */
        const char *next;
        p = obj_skip_blank(f, p);
        switch (p < f->end ? obj_take_keyword(f, &p) : OBJ_OTHER) {
        case OBJ_VERTEX:
            next = obj_next_statement(f, p);
            BVXI_TRY(obj_take_vertex(&r, p));
            p = next;
            break;
        case OBJ_TEXTURE:
            next = obj_next_statement(f, p);
            BVXI_TRY(obj_take_uv(&r, p));
            p = next;
            break;
        case OBJ_FACE:
            BVXI_TRY(obj_take_face(&r, &p));
            p = obj_next_line(f, p);
            break;
        default: p = obj_next_line(f, p); break;
        }
    }
    return BVX_OK;
}

static void obj_fill_piece(void *user, int32_t index)
{
    const obj_file *const f = user;
    f->pieces[index].status = obj_read_piece(f, index, NULL);
}

/* ---- what is left to do ---- */

static int obj_first_has_uv(const obj_file *f)
{
    int64_t number;

    for (int32_t i = 0; i < f->piece_count && f->uvs > 0; i++) {
        const char *p = f->pieces[i].face;

        /* Only v/t counts: v//n has a normal in the third place and no texture coordinate. */
        if (p == NULL) continue;
        p = obj_skip_blank(f, p);
        return bvxi_take_integer(&p, f->end, &number) && p < f->end && *p++ == '/' &&
               bvxi_take_integer(&p, f->end, &number);
    }
    return 0;
}

/* Bytes from shares of 1, or from shares of 255 when one is above 1. */
static bvx_status obj_finish_colours(obj_file *f)
{
    bvx_mesh *const mesh = f->mesh;
    double whole = 1;

    /* A file with a vertex that has no colour has none at all: there is nothing to put in its place. */
    for (int32_t i = 0; i < f->piece_count; i++)
        if (f->pieces[i].pale) return BVX_OK;
    BVXI_TRY(bvxi_make_array(f->source->ctx, mesh, BVXI_MESH_COLOURS));

    /* One number above 1 shows that the file counts to 255; below, both readings are shares of 1. */
    for (uint64_t i = 0; i < f->vertices * 3; i++)
        if (f->colours[i] > 1.0f) whole = 255;
    for (size_t v = 0; v < (size_t)f->vertices; v++) {
        for (size_t c = 0; c < 3; c++)
            mesh->colours[v * 4 + c] = bvxi_colour_byte((double)f->colours[v * 3 + c] / whole);
        mesh->colours[v * 4 + 3] = 255;
    }
    return BVX_OK;
}

/* Texture coordinates stay when all corners have one; without numbers when these are the vertices'. */
static void obj_finish_uvs(obj_file *f)
{
    bvx_context *const ctx = f->source->ctx;
    int bare = 0, differs = f->uvs != f->vertices;

    for (int32_t i = 0; i < f->piece_count; i++) {
        bare |= f->pieces[i].bare;
        differs |= f->pieces[i].differs;
    }

    /* Equal indices everywhere mean that the vertices' own
     * coordinates say it all, and the list is not needed. */
    if (bare) {
        bvxi_drop_uvs(ctx, f->mesh);
    } else if (!differs) {
        bvxi_mesh_release(ctx, f->mesh, BVXI_MESH_UV_TRIANGLES);
    }
}

bvx_status bvxi_read_obj(bvxi_source *source, uint32_t *lost, bvx_mesh *mesh)
{
    obj_file f = {.source = source, .mesh = mesh};

    /* A file without a newline has lines that end with a carriage return, as older machines wrote them. */
    f.end = source->end;
    f.line_end = bvxi_find_byte(source->begin, source->end, '\n') == source->end &&
                         bvxi_find_byte(source->begin, source->end, '\r') != source->end
                     ? '\r'
                     : '\n';

    BVXI_TRY(obj_count(&f));

    bvx_context *const ctx = f.source->ctx;

    BVXI_TRY(bvxi_make_positions(ctx, f.mesh, BVX_F64, f.vertices));
    BVXI_TRY(bvxi_make_triangles(ctx, f.mesh, f.triangles));

    if (obj_first_has_uv(&f)) {
        BVXI_TRY(bvxi_make_uvs(ctx, f.mesh, f.uvs));
        BVXI_TRY(bvxi_make_array(ctx, f.mesh, BVXI_MESH_UV_TRIANGLES));
    }
    for (int32_t i = 0; i < f.piece_count; i++) {
        const char *p = f.pieces[i].vertex;
        double number[3 + 5];
        if (p == NULL) continue;
        /* The first vertex decides for all. */
        int const n = obj_take_numbers(&f, &p, 8, number);
        if (n == 6 || n == 7)
            BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, f.vertices * 12, "the colours of the file", &f.colours));
        break;
    }
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, f.polygons * sizeof *f.fans, "the polygons of the file", &f.fans));

    BVXI_TRY(bvxi_source_pieces(f.source, 0.25, 1, f.piece_count, obj_fill_piece, &f));
    for (int32_t i = 0; i < f.piece_count; i++) /* again, for its message */
        if (f.pieces[i].status != BVX_OK) BVXI_TRY(obj_read_piece(&f, i, f.source->ctx));

    if (f.triangles == 0) return BVXI_FILE_FAIL(f.source, BVX_ERR_EMPTY, "the file has no face");
    obj_finish_uvs(&f);
    if (f.colours != NULL) BVXI_TRY(obj_finish_colours(&f));
    *lost = f.painted ? BVX_LOST_MATERIALS : 0;
    return bvxi_cut_fans(f.source, f.mesh, f.fans, f.polygons);
}

/* ---- Written ---- */

/* Numbers are the shortest decimals that read back to the same floats, or doubles where the mesh has doubles
 * or a frame. Colours follow the coordinates as fractions of 1, without alpha, which the format does not
 * know. Normals, where requested, are one a vertex, with its index. */

/* Three places, rounded up: programs that cut off and programs that round get the same byte back. */
static uint8_t *obj_put_colour(uint8_t *at, uint8_t value)
{
    uint32_t const thousandths = ((uint32_t)value * 1000 + 254) / 255;
    *at++ = ' ';
    if (thousandths == 0 || thousandths == 1000) return bvxi_put_number(at, thousandths / 1000);
    *at++ = '0';
    *at++ = '.';
    *at++ = (uint8_t)('0' + thousandths / 100);
    if (thousandths % 100 != 0) *at++ = (uint8_t)('0' + thousandths / 10 % 10);
    if (thousandths % 10 != 0) *at++ = (uint8_t)('0' + thousandths % 10);
    return at;
}

static uint8_t *obj_put_vertices(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvx_mesh *const mesh = ((const bvxi_written *)user)->mesh;
    for (uint64_t v = begin; v < end; v++) {
        at = bvxi_put_vertex(mesh, v, bvxi_put_char(bvxi_put_char(at, 'v'), ' '));
        if (mesh->colours != NULL)
            for (size_t c = 0; c < 3; c++) at = obj_put_colour(at, mesh->colours[(size_t)v * 4 + c]);
        *at++ = '\n';
    }
    return at;
}

static uint8_t *obj_put_uvs(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvx_mesh *const mesh = ((const bvxi_written *)user)->mesh;
    for (uint64_t i = begin; i < end; i++) {
        *at++ = 'v';
        *at++ = 't';
        for (size_t a = 0; a < 2; a++)
            at = bvxi_put_float(bvxi_put_char(at, ' '), mesh->uvs[(size_t)i * 2 + a]);
        *at++ = '\n';
    }
    return at;
}

static uint8_t *obj_put_normals(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_written *const what = user;
    float n[3];

    for (uint64_t v = begin; v < end; v++) {
        *at++ = 'v';
        *at++ = 'n';
        bvxi_written_normal(what->mesh, what->sum, v, n);
        for (int a = 0; a < 3; a++) at = bvxi_put_float(bvxi_put_char(at, ' '), n[a]);
        *at++ = '\n';
    }
    return at;
}

/* A corner is v, v/vt, v//vn or v/vt/vn. */
static uint8_t *obj_put_faces(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_written *const what = user;
    const bvx_mesh *const mesh = what->mesh;
    const uint32_t *const uv = mesh->uv_triangles != NULL ? mesh->uv_triangles : mesh->triangles;

    for (uint64_t t = begin; t < end; t++) {
        *at++ = 'f';
        for (size_t i = (size_t)t * 3; i < (size_t)t * 3 + 3; i++) {
            at = bvxi_put_number(bvxi_put_char(at, ' '), (uint64_t)mesh->triangles[i] + 1);
            if (mesh->uvs != NULL) at = bvxi_put_number(bvxi_put_char(at, '/'), (uint64_t)uv[i] + 1);
            if (!what->normals) continue;
            if (mesh->uvs == NULL) *at++ = '/';
            at = bvxi_put_number(bvxi_put_char(at, '/'), (uint64_t)mesh->triangles[i] + 1);
        }
        *at++ = '\n';
    }
    return at;
}

bvx_status bvxi_write_obj(bvx_context *ctx, const bvxi_written *what, bvx_buffer *file)
{
    static const char title[] = "# OBJ written by bitvox\n";
    const bvx_mesh *const mesh = what->mesh;
    uint64_t const number = bvxi_writes_f32(mesh) ? BVXI_FLOAT_MOST : BVXI_DOUBLE_MOST;
    uint64_t const vertex_digits = bvxi_digits(mesh->vertex_count);
    double const from = what->normals ? BVXI_NORMALS_SHARE : 0.0;
    bvxi_file_part part[4] = {{.put = obj_put_vertices, .user = what},
                              {.put = obj_put_uvs, .user = what},
                              {.put = obj_put_normals, .user = what},
                              {.put = obj_put_faces, .user = what}};

    part[0].count = mesh->vertex_count;
    part[0].most = 2 + 3 * (1 + number) + (mesh->colours != NULL ? 3 * 6 : 0);
    part[1].count = bvxi_written_uvs(mesh);
    part[1].most = 3 + 2 * (1 + BVXI_FLOAT_MOST);
    part[2].count = what->normals ? mesh->vertex_count : 0;
    part[2].most = 3 + 3 * (1 + BVXI_FLOAT_MOST);
    part[3].count = mesh->triangle_count;
    part[3].most = 2 + 3 * (1 + vertex_digits);
    if (mesh->uvs != NULL) part[3].most += 3 * (1 + bvxi_digits(part[1].count));
    if (what->normals) part[3].most += 3 * (2 + vertex_digits); /* two slashes without a texture */

    BVXI_TRY(bvxi_make_file(ctx, "the OBJ file", from, sizeof title - 1, part, 4, file));
    memcpy(file->bytes, title, sizeof title - 1);
    return BVX_OK;
}
