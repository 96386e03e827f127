/* read_stl.c - STL, ASCII and binary, to an indexed mesh.
 *
 * Which kind a file is, is not told by the word solid, which many binary headers hold too: it is binary when its size
 * is the one that its count of triangles asks for; else ASCII when its first kilobyte has no control characters.
 * STL repeats each vertex in every triangle. They are welded where their coordinates are equal, -0 being 0, as they
 * are read: an open table finds the vertex, so raw corners are never stored, and vertices are numbered by their first
 * occurrence whatever the table looks like. Normals and attributes are not looked at.
 * Memory: 12 bytes a triangle, at most 40 bytes a vertex on the way. Cost: O(bytes). */
#include "io/formats.h"

enum {
    STL_HEADER = 84,         /* 80 bytes of anything, and the count */
    STL_TRIANGLE = 50,       /* a normal, three corners, two bytes of attributes */
    STL_SEEN_BYTES = 1024,   /* of these, none may be a control character in a text */
    STL_NORMAL_WORDS = 8,    /* most words between facet and outer: normal x y z, with room for the unusual */
    STL_FIRST_TABLE = 1024,
    STL_BATCH = 32           /* triangles */
};

#if defined(__GNUC__)
#define STL_PREFETCH(address) __builtin_prefetch(address)
#else
#define STL_PREFETCH(address) (void)0
#endif

/* The mesh as it grows. */
typedef struct stl_mesh {
    bvxi_source *source;
    float *positions;        /* scratch */
    uint32_t *triangles;     /* scratch, or the result when the count is known */
    uint32_t *table;         /* vertex number plus 1, or 0; scratch, size a power of two, at most half full */
    uint64_t vertex_count, vertex_room, triangle_count, triangle_room, table_size;
    int32_t triangle_kind;   /* BVXI_RESULT or BVXI_SCRATCH */
} stl_mesh;

/* ---- welding ---- */

static uint32_t stl_bits(float v)
{
    uint32_t bits;
    memcpy(&bits, &v, sizeof bits);
    return bits == 0x80000000u ? 0 : bits;
}

static uint64_t stl_hash(const uint32_t bits[3])
{
    uint64_t h = bits[0] * UINT64_C(0x9e3779b97f4a7c15);
    h = ((h ^ h >> 32) + bits[1]) * UINT64_C(0xbf58476d1ce4e5b9);
    h = ((h ^ h >> 32) + bits[2]) * UINT64_C(0x94d049bb133111eb);
    return h ^ h >> 31;
}

static int stl_same(const stl_mesh *m, uint32_t vertex, const uint32_t bits[3])
{
    return memcmp(m->positions + (size_t)vertex * 3, bits, 12) == 0;
}

static bvx_status stl_grow_table(stl_mesh *m, uint64_t size)
{
    uint32_t *table, bits[3];
    BVXI_TRY(bvxi_alloc_zero(m->source->ctx, BVXI_SCRATCH, size * sizeof *table, "the table of vertices", &table));
    for (uint64_t v = 0; v < m->vertex_count; v++) {
        memcpy(bits, m->positions + v * 3, sizeof bits);
        size_t slot = (size_t)(stl_hash(bits) & (size - 1));
        while (table[slot] != 0) slot = (slot + 1) & (size_t)(size - 1);
        table[slot] = (uint32_t)(v + 1);
    }
    bvxi_free(m->source->ctx, m->table, m->table_size * sizeof *table);
    m->table = table;
    m->table_size = size;
    return BVX_OK;
}

static bvx_status stl_grow_positions(stl_mesh *m)
{
    uint64_t const room = m->vertex_room * 2;
    BVXI_TRY(bvxi_resize(m->source->ctx, BVXI_SCRATCH, &m->positions, m->vertex_room * 12, room * 12,
                         "the vertices of the file"));
    m->vertex_room = room;
    return BVX_OK;
}

/* The number of the vertex with these coordinates and their hash; bits have no -0. */
static bvx_status stl_weld(stl_mesh *m, const uint32_t bits[3], uint64_t hash, uint32_t *vertex)
{
    size_t slot = (size_t)(hash & (m->table_size - 1));
    for (; m->table[slot] != 0; slot = (slot + 1) & (size_t)(m->table_size - 1))
        if (stl_same(m, m->table[slot] - 1, bits)) {
            *vertex = m->table[slot] - 1;
            return BVX_OK;
        }
    if (m->vertex_count == UINT32_MAX)
        return bvxi_fail(m->source->ctx, BVX_ERR_RANGE, "STL: the file has 2^32 different vertices or more");
    if (m->vertex_count == m->vertex_room) BVXI_TRY(stl_grow_positions(m));
    memcpy(m->positions + m->vertex_count * 3, bits, 12);
    *vertex = (uint32_t)m->vertex_count++;
    m->table[slot] = *vertex + 1;
    return 2 * m->vertex_count > m->table_size ? stl_grow_table(m, 2 * m->table_size) : BVX_OK;
}

static bvx_status stl_add_triangle(stl_mesh *m, uint32_t a, uint32_t b, uint32_t c)
{
    if (m->triangle_count == m->triangle_room) {
        uint64_t const room = m->triangle_room * 2;
        if (m->triangle_count == INT32_MAX)
            return bvxi_fail(m->source->ctx, BVX_ERR_RANGE, "STL: the file has 2^31 triangles or more");
        BVXI_TRY(bvxi_resize(m->source->ctx, m->triangle_kind, &m->triangles, m->triangle_room * 12, room * 12,
                             "the triangles of the file"));
        m->triangle_room = room;
    }
    uint32_t *const t = m->triangles + m->triangle_count++ * 3;
    t[0] = a;
    t[1] = b;
    t[2] = c;
    return BVX_OK;
}

/* ---- binary ---- */

static bvx_status stl_fail_coordinate(const bvxi_source *s, const uint8_t *at, uint64_t triangle, int corner)
{
    return bvxi_fail(s->ctx, BVX_ERR_RANGE, "STL: triangle %u, corner %d (byte %u): a coordinate is not finite",
                     triangle, (int64_t)corner, bvxi_source_byte(s, at));
}

/* Corners of some triangles, welded at a time: their hashes come first, so that the places in the table, which may lie
 * anywhere, are on their way from memory when they are asked for. */
typedef struct stl_corners {
    uint32_t bits[STL_BATCH * 3][3];
    uint64_t hash[STL_BATCH * 3];
} stl_corners;

static bvx_status stl_take_batch(stl_mesh *m, const uint8_t *p, uint64_t first, uint64_t n, stl_corners *c)
{
    for (uint64_t k = 0; k < 3 * n; k++) {
        const uint8_t *const at = p + k / 3 * STL_TRIANGLE + 12 + k % 3 * 12;
        uint32_t *const bits = c->bits[k];
        for (int a = 0; a < 3; a++) {
            bits[a] = bvxi_load_u32(at + 4 * a, 0);
            if ((bits[a] & 0x7f800000u) == 0x7f800000u)
                return stl_fail_coordinate(m->source, at, first + k / 3, (int)(k % 3));
            if (bits[a] == 0x80000000u) bits[a] = 0;
        }
        c->hash[k] = stl_hash(bits);
        STL_PREFETCH(&m->table[c->hash[k] & (m->table_size - 1)]);
    }
    for (uint64_t t = 0; t < n; t++) {
        uint32_t v[3];
        for (uint64_t k = 0; k < 3; k++) BVXI_TRY(stl_weld(m, c->bits[3 * t + k], c->hash[3 * t + k], &v[k]));
        BVXI_TRY(stl_add_triangle(m, v[0], v[1], v[2]));
    }
    return BVX_OK;
}

static bvx_status stl_read_binary(stl_mesh *m, uint64_t count)
{
    const uint8_t *const data = (const uint8_t *)m->source->begin + STL_HEADER;
    stl_corners corners;
    for (uint64_t t = 0; t < count; t += STL_BATCH) {
        const uint8_t *const p = data + t * STL_TRIANGLE;
        BVXI_TRY(bvxi_source_at(m->source, (const char *)p));
        BVXI_TRY(stl_take_batch(m, p, t, count - t < STL_BATCH ? count - t : STL_BATCH, &corners));
    }
    return BVX_OK;
}

/* ---- ASCII ---- */

/* Step over the word at *p, in any case of letters; 0 when another one stands there. */
static int stl_take(const char **p, const char *end, const char *word)
{
    const char *const start = bvxi_skip_space(*p, end);
    const char *t = start;
    for (; *word != 0; word++, t++)
        if (t == end || (*t | 32) != *word) return 0;
    if (t < end && !bvxi_is_space(*t)) return 0;
    *p = t;
    return 1;
}

static bvx_status stl_expect(const bvxi_source *s, const char **p, const char *word, const char *expected)
{
    return stl_take(p, s->end, word) ? BVX_OK
                                     : bvxi_fail_expected(s, bvxi_skip_space(*p, s->end), expected);
}

static const char *stl_skip_line(const char *p, const char *end)
{
    while (p < end && *p != '\n' && *p != '\r') p++;
    return p;
}

/* Three coordinates behind the word vertex. */
static bvx_status stl_take_corner(stl_mesh *m, const char **p, uint32_t *vertex)
{
    const bvxi_source *const s = m->source;
    uint32_t bits[3];
    for (int a = 0; a < 3; a++) {
        float v;
        const char *const at = bvxi_skip_space(*p, s->end);
        size_t const used = bvxi_parse_float(at, s->end, &v);
        *p = at + used;
        if (used == 0 || (*p < s->end && !bvxi_is_space(**p))) return bvxi_fail_expected(s, at, "a coordinate");
        bits[a] = stl_bits(v);
        if ((bits[a] & 0x7f800000u) == 0x7f800000u)
            return bvxi_fail(s->ctx, BVX_ERR_RANGE, "STL: line %u: a coordinate is not a finite 32-bit float",
                             bvxi_source_line(s, at));
    }
    return stl_weld(m, bits, stl_hash(bits), vertex);
}

/* The rest of a facet, behind that word; loops of more than three corners become fans. */
static bvx_status stl_take_facet(stl_mesh *m, const char **p)
{
    const bvxi_source *const s = m->source;
    uint32_t first = 0, previous = 0, vertex = 0;
    uint64_t corners = 0;
    for (int n = 0; n < STL_NORMAL_WORDS && !stl_take(p, s->end, "outer"); n++)
        *p = bvxi_skip_word(bvxi_skip_space(*p, s->end), s->end);
    BVXI_TRY(stl_expect(s, p, "loop", "'outer loop' after a facet's normal"));
    for (; stl_take(p, s->end, "vertex"); corners++) {
        BVXI_TRY(stl_take_corner(m, p, &vertex));
        if (corners >= 2) BVXI_TRY(stl_add_triangle(m, first, previous, vertex));
        if (corners == 0) first = vertex;
        previous = vertex;
    }
    if (corners < 3) return bvxi_fail_expected(s, bvxi_skip_space(*p, s->end), "three or more times 'vertex'");
    BVXI_TRY(stl_expect(s, p, "endloop", "'vertex' or 'endloop'"));
    return stl_expect(s, p, "endfacet", "'endfacet'");
}

static bvx_status stl_read_text(stl_mesh *m)
{
    bvxi_source *const s = m->source;
    const char *p = bvxi_skip_mark(s->begin, s->end);
    int inside = 0; /* between solid and endsolid */
    for (;;) {
        BVXI_TRY(bvxi_source_at(s, p));
        if (stl_take(&p, s->end, "facet")) {
            BVXI_TRY(stl_take_facet(m, &p));
        } else if (stl_take(&p, s->end, "endsolid")) {
            p = stl_skip_line(p, s->end);
            inside = 0;
        } else if (!inside && stl_take(&p, s->end, "solid")) {
            p = stl_skip_line(p, s->end);
            inside = 1;
        } else {
            p = bvxi_skip_space(p, s->end);
            if (p == s->end && !inside) return BVX_OK;
            return bvxi_fail_expected(s, p, inside ? "'facet' or 'endsolid'" : "'solid' or 'facet'");
        }
    }
}

/* ---- both ---- */

/* No control characters but those that move about a page. */
static int stl_is_text(const char *p, const char *end)
{
    if (end - p > STL_SEEN_BYTES) end = p + STL_SEEN_BYTES;
    for (; p < end; p++)
        if (((unsigned char)*p < 32 && !bvxi_is_space(*p)) || *p == 127) return 0;
    return 1;
}

/* Set *binary and its count of triangles. */
static bvx_status stl_tell_apart(const bvxi_source *s, int *binary, uint64_t *count)
{
    uint64_t const size = bvxi_source_byte(s, s->end);
    *count = size < STL_HEADER ? 0 : bvxi_load_u32((const uint8_t *)s->begin + STL_HEADER - 4, 0);
    *binary = size >= STL_HEADER && STL_HEADER + STL_TRIANGLE * *count == size;
    if (*binary || stl_is_text(s->begin, s->end)) return BVX_OK;
    *binary = 1;
    if (size < STL_HEADER)
        return bvxi_fail(s->ctx, BVX_ERR_FORMAT, "STL: %u bytes, no text, and a binary header has 84", size);
    if (STL_HEADER + STL_TRIANGLE * *count > size)
        return bvxi_fail(s->ctx, BVX_ERR_FORMAT,
                         "STL: the header (byte 80) says %u triangles, which take %u bytes, but the file has %u",
                         *count, STL_HEADER + STL_TRIANGLE * *count, size);
    return BVX_OK;
}

/* Room to begin with: a closed mesh has half as many vertices as triangles. */
static bvx_status stl_begin(stl_mesh *m, uint64_t count)
{
    bvx_context *const ctx = m->source->ctx;
    uint64_t size = STL_FIRST_TABLE;
    m->triangle_kind = count > 0 ? BVXI_RESULT : BVXI_SCRATCH;
    m->triangle_room = count > 0 ? count : STL_FIRST_TABLE;
    BVXI_TRY(bvxi_alloc(ctx, m->triangle_kind, m->triangle_room * 12, "the triangles of the file", &m->triangles));
    m->vertex_room = count / 2 + count / 32 + 64;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, m->vertex_room * 12, "the vertices of the file", &m->positions));
    while (size < count + 1) size *= 2;
    return stl_grow_table(m, size);
}

/* Hand over arrays of exact size. */
static bvx_status stl_finish(stl_mesh *m, bvx_mesh *mesh)
{
    bvx_context *const ctx = m->source->ctx;
    if (m->triangle_count == 0) return bvxi_fail(ctx, BVX_ERR_EMPTY, "STL: the file has no triangle");
    bvxi_free(ctx, m->table, m->table_size * sizeof *m->table);
    m->table = NULL;
    BVXI_TRY(bvxi_make_positions(ctx, mesh, BVX_F32, m->vertex_count));
    memcpy(mesh->positions, m->positions, (size_t)m->vertex_count * 12);
    if (m->triangle_kind == BVXI_RESULT) {
        mesh->triangles = m->triangles;
        mesh->triangle_count = mesh->triangle_capacity = m->triangle_count;
        m->triangles = NULL;
        return BVX_OK;
    }
    BVXI_TRY(bvxi_make_triangles(ctx, mesh, m->triangle_count));
    memcpy(mesh->triangles, m->triangles, (size_t)m->triangle_count * 12);
    return BVX_OK;
}

bvx_status bvxi_read_stl(bvxi_source *source, bvx_mesh *mesh)
{
    stl_mesh m = {0};
    uint64_t count;
    int binary;
    bvx_status status;
    m.source = source;
    BVXI_TRY(stl_tell_apart(source, &binary, &count));
    if (binary && count == 0)
        return bvxi_fail(source->ctx, BVX_ERR_EMPTY, "STL: the header (byte 80) says 0 triangles");
    if (count > INT32_MAX && binary)
        return bvxi_fail(source->ctx, BVX_ERR_RANGE, "STL: the file has %u triangles, the limit is below 2^31", count);
    status = stl_begin(&m, binary ? count : 0);
    if (status == BVX_OK) status = binary ? stl_read_binary(&m, count) : stl_read_text(&m);
    if (status == BVX_OK) status = stl_finish(&m, mesh);
    bvxi_free(source->ctx, m.table, m.table_size * sizeof *m.table);
    bvxi_free(source->ctx, m.positions, m.vertex_room * 12);
    bvxi_free(source->ctx, m.triangles, m.triangle_room * 12);
    return status;
}
