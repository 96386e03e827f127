/* ply_header.c - the header of a PLY file: elements, their counts and properties.
 *
 * Source: Turk. The PLY Polygon File Format. 1994, and the type names int8..float64 that others added.
 * Guarantee: every count is held against the bytes that are there before anything of its size is
 * allocated. */
#include "io_mesh/ply_file.h"

typedef struct ply_line {
    const char *p, *end;
    const char *next; /* the line after it */
    int returns;      /* lines end with a carriage return alone: a newline after the last one is data */
} ply_line;

/* Go to the next line; 0 when there is none that ends. */
static int ply_next_line(const bvxi_source *s, ply_line *line)
{
    const char *p = line->next;
    line->p = p;
    while (p < s->end && *p != '\n' && *p != '\r') p++;
    line->end = p;
    if (p == s->end) return 0;
    line->next = p + 1 < s->end && *p == '\r' && p[1] == '\n' && !line->returns ? p + 2 : p + 1;
    return 1;
}

/* The line 'ply', which shows how lines end. */
static int ply_first_line(const bvxi_source *s, ply_line *line)
{
    line->next = bvxi_skip_mark(s->begin, s->end);
    line->returns = 0;
    if (!ply_next_line(s, line)) return 0;
    line->returns = line->next[-1] == '\r';
    if (line->end - line->p < 3 || memcmp(line->p, "ply", 3) != 0) return 0;
    return line->end - line->p == 3 || bvxi_is_blank(line->p[3]);
}

/* The next word of a line, empty at its end. */
static size_t ply_word(ply_line *line, const char **word)
{
    while (line->p < line->end && bvxi_is_blank(*line->p)) line->p++;
    *word = line->p;
    while (line->p < line->end && !bvxi_is_blank(*line->p)) line->p++;
    return (size_t)(line->p - *word);
}

static BVXI_COLD bvx_status ply_fail_line(const bvxi_source *s, const char *at, const char *why)
{
    return BVXI_LINE_FAIL(s, at, BVX_ERR_FORMAT, "%s", why);
}

static int ply_is(const char *word, size_t n, const char *name)
{
    return n == bvxi_text_length(name) && memcmp(word, name, n) == 0;
}

static bvx_status ply_expect_end(const bvxi_source *s, ply_line *line)
{
    const char *word;
    return ply_word(line, &word) == 0 ? BVX_OK : bvxi_fail_expected(s, word, "the end of the line");
}

static bvx_status ply_take_type(const bvxi_source *s, ply_line *line, int only_integer, int8_t *type)
{
    static const char *const names[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                           {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                           {"float", "float32"}, {"double", "float64"}};
    const char *word;
    size_t const n = ply_word(line, &word);
    int32_t t = PLY_NONE;
    for (int32_t i = 0; i < 8; i++)
        if (ply_is(word, n, names[i][0]) || ply_is(word, n, names[i][1])) t = PLY_I8 + i;
    if (t == PLY_NONE) return bvxi_fail_expected(s, word, "a type (char to double, int8 to float64)");
    if (only_integer && t >= PLY_F32) return bvxi_fail_expected(s, word, "an integer type");
    *type = (int8_t)t;
    return BVX_OK;
}

/* ---- the statements of a header ---- */

static bvx_status ply_take_element(const bvxi_source *s, ply_line *line, ply_header *h)
{
    ply_element *const e = &h->elements[h->element_count];
    const char *word;
    memset(e, 0, sizeof *e);
    e->name_size = ply_word(line, &e->name);
    if (e->name_size == 0) return bvxi_fail_expected(s, e->name, "an element's name");
    size_t n = ply_word(line, &word);
    /* A count of too many digits stops growing while it is large: the bytes refuse it later. */
    for (size_t i = 0; i < n; i++) {
        if (word[i] < '0' || word[i] > '9') n = 0;
        else if (e->count < UINT64_MAX / 16) e->count = e->count * 10 + (uint64_t)(word[i] - '0');
    }
    if (n == 0) return bvxi_fail_expected(s, word, "a count of rows");
    /* The three elements with a meaning are remembered by kind;
     * a second one of the same name would hide the first. */
    ply_element **const places[] = {NULL, &h->vertex, &h->face, &h->strips};
    e->kind = ply_is(e->name, e->name_size, "vertex")      ? PLY_VERTEX
              : ply_is(e->name, e->name_size, "face")      ? PLY_FACE
              : ply_is(e->name, e->name_size, "tristrips") ? PLY_STRIPS
                                                           : PLY_OTHER;
    if (e->kind != PLY_OTHER) {
        if (*places[e->kind] != NULL) return ply_fail_line(s, word, "a second element of this name");
        *places[e->kind] = e;
    }

    e->first = e->end = h->property_count;
    h->element_count++;
    return ply_expect_end(s, line);
}

/* What a property is for, by the names that programs give it. */
static void ply_find_role(const ply_element *e, int is_list, const char *word, size_t n,
                          ply_property *property)
{
    static const struct {
        const char *name;
        int8_t kind, is_list, role, set;
    } known[] = {
        {"x", PLY_VERTEX, 0, PLY_ROLE_X, 0},
        {"y", PLY_VERTEX, 0, PLY_ROLE_Y, 0},
        {"z", PLY_VERTEX, 0, PLY_ROLE_Z, 0},
        {"red", PLY_VERTEX, 0, PLY_ROLE_RED, 0},
        {"green", PLY_VERTEX, 0, PLY_ROLE_GREEN, 0},
        {"blue", PLY_VERTEX, 0, PLY_ROLE_BLUE, 0},
        {"alpha", PLY_VERTEX, 0, PLY_ROLE_ALPHA, 0},
        {"diffuse_red", PLY_VERTEX, 0, PLY_ROLE_RED, 1},
        {"diffuse_green", PLY_VERTEX, 0, PLY_ROLE_GREEN, 1},
        {"diffuse_blue", PLY_VERTEX, 0, PLY_ROLE_BLUE, 1},
        {"diffuse_alpha", PLY_VERTEX, 0, PLY_ROLE_ALPHA, 1},
        {"r", PLY_VERTEX, 0, PLY_ROLE_RED, 2},
        {"g", PLY_VERTEX, 0, PLY_ROLE_GREEN, 2},
        {"b", PLY_VERTEX, 0, PLY_ROLE_BLUE, 2},
        {"a", PLY_VERTEX, 0, PLY_ROLE_ALPHA, 2},
        {"s", PLY_VERTEX, 0, PLY_ROLE_U, 0},
        {"t", PLY_VERTEX, 0, PLY_ROLE_V, 0},
        {"u", PLY_VERTEX, 0, PLY_ROLE_U, 1},
        {"v", PLY_VERTEX, 0, PLY_ROLE_V, 1},
        {"texture_u", PLY_VERTEX, 0, PLY_ROLE_U, 2},
        {"texture_v", PLY_VERTEX, 0, PLY_ROLE_V, 2},
        {"texture_s", PLY_VERTEX, 0, PLY_ROLE_U, 3},
        {"texture_t", PLY_VERTEX, 0, PLY_ROLE_V, 3},
        {"vertex_indices", PLY_FACE, 1, PLY_ROLE_CORNERS, 0},
        {"vertex_index", PLY_FACE, 1, PLY_ROLE_CORNERS, 0},
        {"texcoord", PLY_FACE, 1, PLY_ROLE_UVS, 0},
        {"vertex_indices", PLY_STRIPS, 1, PLY_ROLE_STRIP, 0},
        {"vertex_index", PLY_STRIPS, 1, PLY_ROLE_STRIP, 0},
    };

    /* Several names have one meaning; which set a name is of decides later, when all of them are known. */
    property->role = PLY_ROLE_NONE;
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (known[i].kind == e->kind && ply_is(word, n, known[i].name) &&
            /* coordinates in lists are refused */
            (known[i].is_list == is_list || known[i].role <= PLY_ROLE_Z)) {
            property->role = known[i].role;
            property->set = known[i].set;
        }
}

static bvx_status ply_take_property(const bvxi_source *s, ply_line *line, ply_header *h)
{
    ply_property *const property = &h->properties[h->property_count];
    const char *const start = line->p, *word;
    if (h->element_count == 0) return ply_fail_line(s, start, "a property before any element");
    ply_element *const e = &h->elements[h->element_count - 1];
    memset(property, 0, sizeof *property);
    size_t n = ply_word(line, &word);
    int const is_list = ply_is(word, n, "list");
    if (is_list) BVXI_TRY(ply_take_type(s, line, 1, &property->count_type));
    else line->p = start;
    BVXI_TRY(ply_take_type(s, line, 0, &property->type));
    n = ply_word(line, &word);
    if (n == 0) return bvxi_fail_expected(s, word, "a property's name");
    ply_find_role(e, is_list, word, n, property);

    /* Two columns of one meaning would write over each other, and a wrong type would fail in every row. */
    if (property->role != PLY_ROLE_NONE) {
        for (uint32_t i = e->first; i < e->end; i++)
            if (h->properties[i].role == property->role && h->properties[i].set == property->set)
                return ply_fail_line(s, word, "a second property of this meaning");
        if (property->role <= PLY_ROLE_Z && is_list)
            return ply_fail_line(s, word, "a coordinate cannot be a list");
        if ((property->role == PLY_ROLE_CORNERS || property->role == PLY_ROLE_STRIP) &&
            property->type >= PLY_F32)
            return ply_fail_line(s, word, "vertex indices must be integers");
    }
    h->property_count++;
    e->end++;
    e->lists += is_list;
    return ply_expect_end(s, line);
}

static bvx_status ply_take_line(const bvxi_source *s, ply_line *line, ply_header *h, int *done)
{
    const char *word;
    size_t n = ply_word(line, &word);

    if (ply_is(word, n, "element")) return ply_take_element(s, line, h);
    if (ply_is(word, n, "property")) return ply_take_property(s, line, h);
    if (ply_is(word, n, "format") && h->encoding == 0) {
        n = ply_word(line, &word);
        h->encoding = ply_is(word, n, "ascii")                  ? PLY_ASCII
                      : ply_is(word, n, "binary_little_endian") ? PLY_LITTLE
                      : ply_is(word, n, "binary_big_endian")    ? PLY_BIG
                                                                : 0;
        if (h->encoding == 0)
            return bvxi_fail_expected(s, word, "ascii, binary_little_endian or binary_big_endian");
        n = ply_word(line, &word);
        return ply_is(word, n, "1.0") ? ply_expect_end(s, line) : bvxi_fail_expected(s, word, "version 1.0");
    }
    if (ply_is(word, n, "comment") || ply_is(word, n, "obj_info")) return BVX_OK;
    /* Blender's old comment without the word */
    if (ply_is(word, n, "Created") && h->element_count == 0) return BVX_OK;
    if (!ply_is(word, n, "end_header"))
        return bvxi_fail_expected(s, word, "format, element, property, comment or end_header");
    *done = 1;
    return ply_expect_end(s, line);
}

/* ---- what the header promises against what is there ---- */

static int ply_has_role(const ply_header *h, const ply_element *e, int32_t role)
{
    for (uint32_t i = e->first; i < e->end; i++)
        if (h->properties[i].role == role) return 1;
    return 0;
}

/* Of the properties with the roles first to last keep those of the first set that has all roles up to
 * needed. */
static int32_t ply_keep_set(ply_header *h, int32_t first, int32_t needed, int32_t last)
{
    /* Bits of the roles first..needed, as a role is the bit of its value. */
    uint32_t const all = (2u << needed) - (1u << first);
    uint32_t roles[4] = {0, 0, 0, 0};
    int32_t set = 0;

    for (uint32_t i = h->vertex->first; i < h->vertex->end; i++)
        if (h->properties[i].role >= 0) roles[h->properties[i].set] |= 1u << h->properties[i].role;
    /* Programs write several sets beside each other (red and diffuse_red): taking from two would mix them. */
    while (set < 4 && (roles[set] & all) != all) set++;
    for (uint32_t i = h->vertex->first; i < h->vertex->end; i++) {
        ply_property *const p = &h->properties[i];
        if (p->role >= first && p->role <= last && p->set != set) p->role = PLY_ROLE_NONE;
    }
    return set < 4;
}

static bvx_status ply_check_meaning(const bvxi_source *s, ply_header *h)
{
    static const char *const names[] = {"x", "y", "z"};
    int const has_faces = h->face != NULL && h->face->count > 0;
    int const has_strips = h->strips != NULL && h->strips->count > 0;
    int floats = 0;

    if (!h->points && !has_faces && !has_strips)
        return BVXI_FILE_FAIL(s, BVX_ERR_EMPTY, "the file has no faces");
    if (h->vertex == NULL) return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT, "the header names no element vertex");
    for (int32_t a = 0; a < 3; a++)
        if (!ply_has_role(h, h->vertex, a))
            return BVXI_LINE_FAIL(s, h->vertex->name, BVX_ERR_FORMAT, "element vertex has no property %s",
                                  names[a]);

    /* Positions are floats only where all three coordinates are: one double would lose its digits. */
    for (uint32_t i = h->vertex->first; i < h->vertex->end; i++)
        floats += h->properties[i].role >= PLY_ROLE_X && h->properties[i].role <= PLY_ROLE_Z &&
                  h->properties[i].type == PLY_F32;
    if (!h->points && has_faces && !ply_has_role(h, h->face, PLY_ROLE_CORNERS))
        return ply_fail_line(s, h->face->name, "element face has no list vertex_indices or vertex_index");
    if (!h->points && has_strips && !ply_has_role(h, h->strips, PLY_ROLE_STRIP))
        return ply_fail_line(s, h->strips->name,
                             "element tristrips has no list vertex_indices or vertex_index");
    if (h->vertex->count > UINT32_MAX)
        return BVXI_FILE_FAIL_FOR(s, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                  "%u vertices, the limit is below 2^32", h->vertex->count);
    h->position_type = floats == 3 ? BVX_F32 : BVX_F64;
    /* Elements without rows, and faces where only points are wanted, are as if they were not named. */
    if (!has_faces || h->points) h->face = NULL;
    if (!has_strips || h->points) h->strips = NULL;
    h->colours = ply_keep_set(h, PLY_ROLE_RED, PLY_ROLE_BLUE, PLY_ROLE_ALPHA);
    h->alpha = ply_has_role(h, h->vertex, PLY_ROLE_ALPHA);
    h->uvs = ply_keep_set(h, PLY_ROLE_U, PLY_ROLE_V, PLY_ROLE_V);
    if (h->uvs == 0 && h->strips == NULL && h->face != NULL && ply_has_role(h, h->face, PLY_ROLE_UVS))
        h->uvs = 2;
    /* Coordinates of corners are not used, so the rows need not keep them. */
    for (uint32_t i = 0; i < h->property_count && h->uvs != 2; i++)
        if (h->properties[i].role == PLY_ROLE_UVS) h->properties[i].role = PLY_ROLE_NONE;
    return BVX_OK;
}

static bvx_status ply_count_names(const bvxi_source *s, uint64_t *names)
{
    const char *word;
    ply_line line;

    if (!ply_first_line(s, &line))
        return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT, "the file does not begin with a line 'ply'");
    for (*names = 0; ply_next_line(s, &line);) {
        size_t const n = ply_word(&line, &word);
        if (ply_is(word, n, "end_header")) return BVX_OK;
        *names += ply_is(word, n, "element") || ply_is(word, n, "property");
    }
    return BVXI_LINE_FAIL(s, line.p, BVX_ERR_FORMAT, "the file ends before end_header");
}

bvx_status bvxi_ply_header_read(bvxi_source *source, ply_header *header)
{
    ply_header *const h = header;
    ply_line line;
    int done = 0;

    BVXI_TRY(ply_count_names(source, &h->name_count));
    BVXI_TRY(BVXI_ARRAY(source->ctx, h->name_count, "the header's elements", h->elements));
    BVXI_TRY(BVXI_ARRAY(source->ctx, h->name_count, "the header's properties", h->properties));
    ply_first_line(source, &line);
    while (!done && ply_next_line(source, &line)) BVXI_TRY(ply_take_line(source, &line, h, &done));
    if (h->encoding == 0) return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "the header has no line 'format'");
    h->data = line.next;

    /* the last value needs no space */
    uint64_t left = (uint64_t)(source->end - h->data) + (h->encoding == PLY_ASCII);

    /* Elements share what is there: each takes at least its fewest bytes from the next one's. */
    for (uint32_t i = 0; i < h->element_count; i++) {
        ply_element *const e = &h->elements[i];
        e->least_bytes = 0;
        for (uint32_t k = e->first; k < e->end; k++) {
            const ply_property *const p = &h->properties[k];
            uint64_t const items = p->count_type == PLY_NONE ? 1 : p->role == PLY_ROLE_CORNERS ? 3 : 0;
            /* In a text a digit and a space for each value, and even an empty list has its length; in bytes the
             * sizes are those of the types. A face has three corners or more. */
            e->least_bytes += h->encoding == PLY_ASCII
                                  ? 2 * (items + (p->count_type != PLY_NONE))
                                  : items * ply_type_size(p->type) + ply_type_size(p->count_type);
        }
        if (e->least_bytes != 0 && e->count > left / e->least_bytes)
            return BVXI_LINE_FAIL(source, e->name, BVX_ERR_FORMAT,
                                  "%u rows of at least %u bytes, but the file has only %u bytes for them",
                                  e->count, e->least_bytes, left - (h->encoding == PLY_ASCII));
        left -= e->count * e->least_bytes;
    }

    return ply_check_meaning(source, h);
}
