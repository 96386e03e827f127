/* stl.c - STL, ASCII and binary, to meshes and from them. Triangles bring their own corners, which are
 * welded as they come: raw corners are never stored.
 *
 * Guarantee: vertices are numbered by their first use, whatever the table looks like. */
#include "core/key_tree.h"
#include "io_mesh/mesh_formats.h"

#include <math.h>

/* ---- Welded ---- */

/* An open table finds the vertex at equal coordinates. Some hundred triangles are welded at a
 * time: first all their places in the table, then all the vertices found there are asked from memory, which
 * may lie anywhere, so that they are near when they are compared.
 * Where the table searches too long, as for files that were made against the hash, a tree takes its place
 * (core/key_tree.h).
 * Memory: 12 bytes a triangle, 8 to 16 for the table, 6 for the vertices to begin with; at most 60 bytes a
 * vertex on the way. Cost: O(corners). */

enum { SOUP_BATCH = 256 }; /* triangles */

/* The mesh as it grows, and the triangles that wait for their vertices' numbers. */
typedef struct stl_soup {
    bvxi_source *source;
    float *positions;    /* scratch */
    uint32_t *triangles; /* scratch, or the result when the count is known */
    /* vertex index plus 1, or 0; scratch, size a power of two, at most half full; NULL: the tree is used */
    uint32_t *table;
    bvxi_key_tree tree;
    uint64_t probes; /* steps from slot to slot of the table */
    uint64_t vertex_count, vertex_room, triangle_count, triangle_room, table_size;
    int32_t triangle_kind;            /* BVXI_RESULT or BVXI_SCRATCH */
    uint32_t waiting;                 /* triangles in the batch */
    uint32_t bits[SOUP_BATCH * 3][3]; /* coordinates as 32-bit floats without -0 */
    uint64_t hash[SOUP_BATCH * 3];
} stl_soup;

enum { SOUP_LEAST = 1024 }; /* triangles to begin with, and places of the table */

static inline uint64_t soup_hash(const uint32_t bits[3])
{
    uint64_t h = (bits[0] | (uint64_t)bits[1] << 32) * UINT64_C(0x9e3779b97f4a7c15);
    h = ((h ^ h >> 32) + bits[2]) * UINT64_C(0xbf58476d1ce4e5b9);
    return h ^ h >> 32;
}

static inline int soup_same(const stl_soup *s, uint32_t vertex, const uint32_t bits[3])
{
    uint64_t a, b;
    uint32_t c;
    memcpy(&a, s->positions + (size_t)vertex * 3, sizeof a);
    memcpy(&c, s->positions + (size_t)vertex * 3 + 2, sizeof c);
    memcpy(&b, bits, sizeof b);
    return ((a ^ b) | (c ^ bits[2])) == 0;
}

/* Vertices stand at most twice as far from their places, all together, as
 * they did in a table of half the size. */
static bvx_status soup_make_table(stl_soup *s, uint64_t size)
{
    bvx_context *const ctx = s->source->ctx;
    uint32_t *table, bits[3];

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, size * sizeof *table, "the table of vertices", &table));
    for (uint64_t v = 0; v < s->vertex_count; v++) {
        memcpy(bits, s->positions + v * 3, sizeof bits);
        size_t slot = (size_t)(soup_hash(bits) & (size - 1));
        for (; table[slot] != 0; s->probes++) slot = (slot + 1) & (size_t)(size - 1);
        table[slot] = (uint32_t)(v + 1);
    }
    bvxi_drop(ctx, s->table);
    s->table = table;
    s->table_size = size;
    return BVX_OK;
}

/* Vertices that arrays and table hold. */
static uint64_t soup_limit(const stl_soup *s)
{
    uint64_t const limit = s->table == NULL || s->vertex_room < s->table_size / 2 ? s->vertex_room
                                                                                  : s->table_size / 2;
    return limit < UINT32_MAX ? limit : UINT32_MAX;
}

static bvx_status soup_grow(stl_soup *s)
{
    /* Entries of the table are one more than the vertex, 0 being empty: so the last index stays unused. */
    if (s->vertex_count == UINT32_MAX)
        return BVXI_FILE_FAIL_FOR(s->source, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                  "the file has 2^32 different vertices or more");

    /* Arrays grow when they are full, the table when it is half full, so that its searches stay short. */
    if (s->vertex_count == s->vertex_room) {
        BVXI_TRY(bvxi_resize(s->source->ctx, BVXI_SCRATCH, &s->positions, s->vertex_room * 12,
                             s->vertex_room * 24, "the vertices of the file"));
        s->vertex_room *= 2;
        if (s->table == NULL) return bvxi_key_tree_grow(s->source->ctx, &s->tree, s->vertex_room);
    }
    return s->vertex_count == s->table_size / 2 ? soup_make_table(s, s->table_size * 2) : BVX_OK;
}

/* Number corner k of the batch; 0 when it is a new vertex and there is no room for it. */
static inline int soup_find(stl_soup *s, size_t k, uint64_t limit, uint32_t *vertex, uint64_t *probes)
{
    const uint32_t *const bits = s->bits[k];
    size_t const mask = (size_t)(s->table_size - 1);
    size_t slot = (size_t)s->hash[k] & mask;

    /* An entry of 0 is empty. The table is at most half full, so the search always ends. */
    for (uint32_t entry; (entry = s->table[slot]) != 0; slot = (slot + 1) & mask, ++*probes)
        if (soup_same(s, entry - 1, bits)) {
            *vertex = entry - 1;
            return 1;
        }
    if (BVXI_UNLIKELY(s->vertex_count == limit)) return 0;

    memcpy(s->positions + (size_t)s->vertex_count * 3, bits, 12);
    *vertex = (uint32_t)s->vertex_count++;
    s->table[slot] = *vertex + 1;
    return 1;
}

static bvx_status soup_weld_by_table(stl_soup *s, uint32_t *out)
{
    size_t const count = (size_t)s->waiting * 3, mask = (size_t)(s->table_size - 1);
    uint64_t limit = soup_limit(s), probes = 0;

    /* Three walks over the batch: hashes, entries, vertices. Each asks memory for what the next one reads. */
    for (size_t k = 0; k < count; k++) {
        s->hash[k] = soup_hash(s->bits[k]);
        BVXI_PREFETCH(&s->table[(size_t)s->hash[k] & mask]);
    }
    for (size_t k = 0; k < count; k++) {
        uint32_t const entry = s->table[(size_t)s->hash[k] & mask];
        BVXI_PREFETCH(s->positions + (size_t)(entry - (entry != 0)) * 3);
    }

    /* Growing moves the table, so the search for this corner begins again with a new limit. */
    for (size_t k = 0; k < count; k++)
        while (BVXI_UNLIKELY(!soup_find(s, k, limit, &out[k], &probes))) {
            BVXI_TRY(soup_grow(s));
            limit = soup_limit(s);
        }
    s->probes += probes;
    return BVX_OK;
}

/* A bvxi_key_fn. */
static void soup_key(const void *user, uint64_t vertex, uint32_t key[BVXI_KEY_WORDS])
{
    const stl_soup *const s = user;
    memcpy(key, s->positions + (size_t)vertex * 3, 12);
}

/* Number the vertices of the triangles that wait. Vertices at equal
 * coordinates are one, numbered by their first corner. */
static bvx_status soup_weld(stl_soup *s)
{
    uint64_t const room = s->triangle_room * 2;

    /* Checked once a batch, so that the loop over corners has no check for room. */
    if (s->triangle_count + s->waiting > s->triangle_room) {
        if (s->triangle_count + s->waiting > INT32_MAX)
            return BVXI_FILE_FAIL_FOR(s->source, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                      "the file has 2^31 triangles or more");
        BVXI_TRY(bvxi_resize(s->source->ctx, s->triangle_kind, &s->triangles, s->triangle_room * 12,
                             room * 12, "the triangles of the file"));
        s->triangle_room = room; /* twice SOUP_LEAST or more: a batch fits in */
    }
    uint32_t *const out = s->triangles + (size_t)s->triangle_count * 3;
    if (s->table != NULL) BVXI_TRY(soup_weld_by_table(s, out));
    for (size_t k = 0; s->table == NULL && k < (size_t)s->waiting * 3; k++) {
        /* A candidate is written after the last vertex; it becomes one only where the tree has no equal. */
        if (s->vertex_count == soup_limit(s)) BVXI_TRY(soup_grow(s));
        memcpy(s->positions + (size_t)s->vertex_count * 3, s->bits[k], 12);
        out[k] = (uint32_t)bvxi_key_tree_find(&s->tree, s->vertex_count);
        s->vertex_count += out[k] == s->vertex_count;
    }
    s->triangle_count += s->waiting;
    s->waiting = 0;
    /* Long searches are the sign of a table that was attacked
     * or is unlucky; the limit grows with the corners. */
    if (s->table == NULL || s->probes <= bvxi_probe_limit(3 * s->triangle_count)) return BVX_OK;
    bvxi_drop(s->source->ctx, s->table);
    s->table = NULL;
    BVXI_TRY(bvxi_key_tree_open(s->source->ctx, &s->tree, soup_key, s, s->vertex_room));
    /* The tree is filled in the order of vertices, so that their numbers stay what they are. */
    for (uint64_t v = 0; v < s->vertex_count; v++) bvxi_key_tree_find(&s->tree, v);
    return BVX_OK;
}

/* ---- Read ---- */

/* Which kind a file is, is not told by the word solid, which many binary headers hold too: it is binary when
 * its size is the one that its count of triangles requires; else ASCII when its first kilobyte has no control
 * characters. Vertices are welded where their coordinates are equal, -0 being 0. Normals and attributes
 * are not looked at.
 * Memory: that of the welding. Cost: O(bytes). */

enum {
    STL_HEADER = 84,       /* 80 bytes of anything, and the count */
    STL_TRIANGLE = 50,     /* a normal, three corners, two bytes of attributes */
    STL_SEEN_BYTES = 1024, /* of these, none may be a control character in a text */
    STL_NORMAL_WORDS = 8   /* most words between facet and outer: normal x y z, with room for the unusual */
};

/* ---- binary ---- */

/* The coordinates of n triangles at p, the first of this number, into the batch. */
static bvx_status stl_take_batch(stl_soup *soup, const uint8_t *p, uint64_t first, uint32_t n)
{
    uint32_t *const bits = soup->bits[0];
    uint32_t bad = 0;
    size_t i = 0;

    /* Copied as bits first: what follows is a plain loop over one array, without a jump in it. */
    for (size_t t = 0; t < n; t++)
        for (size_t k = 0; k < 9; k++) bits[9 * t + k] = bvxi_load_u32(p + t * STL_TRIANGLE + 12 + 4 * k, 0);
    for (size_t k = 0; k < 9 * (size_t)n; k++) {
        /* Shifting the sign out makes -0 and 0 the same, and
         * every infinity and NaN larger than all numbers. */
        uint32_t const twice = bits[k] << 1;
        bits[k] = twice == 0 ? 0 : bits[k];
        bad |= twice >= 0xff000000u;
    }
    soup->waiting = n;
    if (!bad || soup->source->takes_any) return BVX_OK;

    while (bits[i] << 1 < 0xff000000u) i++;
    const uint8_t *const at = p + i / 9 * STL_TRIANGLE + 12 + i / 3 % 3 * 12;
    return BVXI_FILE_FAIL_FOR(soup->source, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                              "triangle %i, corner %u (byte %u): a coordinate is not finite", first + i / 9,
                              (uint64_t)(i / 3 % 3), bvxi_source_byte(soup->source, at));
}

static bvx_status stl_read_binary(stl_soup *soup, uint64_t count)
{
    const uint8_t *const data = (const uint8_t *)soup->source->begin + STL_HEADER;
    for (uint64_t t = 0; t < count; t += SOUP_BATCH) {
        const uint8_t *const p = data + t * STL_TRIANGLE;
        uint32_t const n = count - t < SOUP_BATCH ? (uint32_t)(count - t) : SOUP_BATCH;
        BVXI_TRY(bvxi_source_at(soup->source, (const char *)p));
        BVXI_TRY(stl_take_batch(soup, p, t, n));
        BVXI_TRY(soup_weld(soup));
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
    return stl_take(p, s->end, word) ? BVX_OK : bvxi_fail_expected(s, bvxi_skip_space(*p, s->end), expected);
}

/* What some programs write after endfacet, up to the end of the line or what may follow there. */
static const char *stl_skip_notes(const char *p, const char *end)
{
    for (;;) {
        while (p < end && bvxi_is_blank(*p)) p++;
        const char *next = p;
        if (p == end || *p == '\n' || *p == '\r' || stl_take(&next, end, "facet") ||
            stl_take(&next, end, "endsolid"))
            return p;
        p = bvxi_skip_word(p, end);
    }
}

/* The rest of a facet, after that word; loops of more than three corners become fans. */
static bvx_status stl_take_facet(stl_soup *soup, const char **p)
{
    const bvxi_source *const s = soup->source;
    uint32_t corner[3][3]; /* the first, the last but one, the last */
    uint64_t corners = 0;

    /* The words of a normal may be missing or too many,
     * but not without limit: a text may never say 'outer'. */
    for (int n = 0; n < STL_NORMAL_WORDS && !stl_take(p, s->end, "outer"); n++)
        *p = bvxi_skip_word(bvxi_skip_space(*p, s->end), s->end);
    BVXI_TRY(stl_expect(s, p, "loop", "'outer loop' after a facet's normal"));
    for (; stl_take(p, s->end, "vertex"); corners++) {
        /* Beyond three corners the last two move on and the
         * first stays: a fan, without memory for the loop. */
        if (corners > 2) memcpy(corner[1], corner[2], sizeof corner[1]);
        for (int a = 0; a < 3; a++) {
            const char *const at = bvxi_skip_space(*p, s->end);
            uint32_t *const bits = &corner[corners < 2 ? corners : 2][a];
            float v;
            size_t const used = bvxi_parse_float(at, s->end, &v);
            *p = at + used;
            if (used == 0 || (*p < s->end && !bvxi_is_space(**p)))
                return bvxi_fail_expected(s, at, "a coordinate");
            if (!(v - v == 0.0f) && !s->takes_any)
                return BVXI_LINE_FAIL_FOR(s, at, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                          "a coordinate is not a finite 32-bit float");
            memcpy(bits, &v, sizeof v);
            if (*bits << 1 == 0) *bits = 0; /* also for -0 */
        }
        if (corners < 2) continue;
        memcpy(soup->bits[3 * soup->waiting], corner, sizeof corner);
        if (++soup->waiting == SOUP_BATCH) BVXI_TRY(soup_weld(soup));
    }
    if (corners < 3)
        return bvxi_fail_expected(s, bvxi_skip_space(*p, s->end), "three or more times 'vertex'");
    BVXI_TRY(stl_expect(s, p, "endloop", "'vertex' or 'endloop'"));
    BVXI_TRY(stl_expect(s, p, "endfacet", "'endfacet'"));
    *p = stl_skip_notes(*p, s->end);
    return BVX_OK;
}

static bvx_status stl_read_text(stl_soup *soup)
{
    bvxi_source *const s = soup->source;
    const char *p = bvxi_skip_mark(s->begin, s->end);
    int inside = 0; /* between solid and endsolid */

    for (;;) {
        BVXI_TRY(bvxi_source_at(s, p));
        /* facet may stand outside of solid, as some programs leave that line out. */
        if (stl_take(&p, s->end, "facet")) {
            BVXI_TRY(stl_take_facet(soup, &p));
        } else if (stl_take(&p, s->end, "endsolid")) {
            p = bvxi_line_end(p, s->end);
            inside = 0;
        } else if (!inside && stl_take(&p, s->end, "solid")) {
            p = bvxi_line_end(p, s->end);
            inside = 1;
        } else {
            p = bvxi_skip_space(p, s->end);
            if (p == s->end && !inside) return soup_weld(soup);
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

static bvx_status stl_read(stl_soup *soup, bvxi_source *source, int binary, uint64_t count, bvx_mesh *mesh)
{
    /* With a known count the array of triangles is made once, and becomes the result itself. */
    uint64_t const known = binary ? count : 0;
    uint64_t size = SOUP_LEAST;

    soup->source = source;
    soup->triangle_kind = known > 0 ? BVXI_RESULT : BVXI_SCRATCH;
    soup->triangle_room = known > 0 ? known : SOUP_LEAST;
    BVXI_TRY(bvxi_alloc(source->ctx, soup->triangle_kind, soup->triangle_room * 12,
                        "the triangles of the file", &soup->triangles));
    soup->vertex_room = known / 2 + known / 32 +
                        64; /* a closed mesh has half as many vertices as triangles */
    BVXI_TRY(bvxi_alloc(source->ctx, BVXI_SCRATCH, soup->vertex_room * 12, "the vertices of the file",
                        &soup->positions));
    while (size < 2 * known) size *= 2; /* twice what it must be: fewer vertices share a place */
    BVXI_TRY(soup_make_table(soup, size));
    BVXI_TRY(binary ? stl_read_binary(soup, count) : stl_read_text(soup));
    if (soup->triangle_count == 0) return BVXI_FILE_FAIL(source, BVX_ERR_EMPTY, "the file has no triangle");

    /* Hand over arrays of exact size when no triangle waits any more. The mesh has one triangle at least. */
    bvx_context *const ctx = soup->source->ctx;

    bvxi_drop(ctx, soup->table);
    soup->table = NULL;
    bvxi_key_tree_close(ctx, &soup->tree);
    BVXI_TRY(bvxi_make_positions(ctx, mesh, BVX_F32, soup->vertex_count));
    memcpy(mesh->positions, soup->positions, (size_t)soup->vertex_count * 12);

    /* Where the count was known, the array is the result already; a growing one was scratch and is copied. */
    if (soup->triangle_kind == BVXI_RESULT) {
        mesh->triangles = soup->triangles;
        mesh->triangle_count = mesh->triangle_capacity = soup->triangle_count;
        soup->triangles = NULL;
        return BVX_OK;
    }
    BVXI_TRY(bvxi_make_triangles(ctx, mesh, soup->triangle_count));
    memcpy(mesh->triangles, soup->triangles, (size_t)soup->triangle_count * 12);
    return BVX_OK;
}

bvx_status bvxi_read_stl(bvxi_source *source, bvx_mesh *mesh)
{
    stl_soup soup = {0};
    uint64_t const size = bvxi_source_byte(source, source->end);

    /* The size decides before the text does: a binary header may hold any word, also 'solid'. */
    uint64_t const count = size < STL_HEADER
                               ? 0
                               : bvxi_load_u32((const uint8_t *)source->begin + STL_HEADER - 4, 0);
    uint64_t const told = STL_HEADER + STL_TRIANGLE * count;
    int const whole = size >= STL_HEADER && told == size;
    int const binary = whole || !stl_is_text(source->begin, source->end);

    /* A binary file that is cut off is refused, more bytes after its end are not. */
    if (binary && size < STL_HEADER)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "%u bytes, no text, and a binary header has 84", size);
    if (binary && told > size)
        return BVXI_FILE_FAIL(
            source, BVX_ERR_FORMAT,
            "the header (byte 80) says %u triangles, which take %u bytes, but the file has %u", count, told,
            size);
    if (binary && count == 0)
        return BVXI_FILE_FAIL(source, BVX_ERR_EMPTY, "the header (byte 80) says 0 triangles");
    if (count > INT32_MAX && binary)
        return BVXI_FILE_FAIL_FOR(source, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                  "the file has %u triangles, the limit is below 2^31", count);
    bvx_status const status = stl_read(&soup, source, binary, count, mesh);
    bvxi_free(source->ctx, soup.triangles, soup.triangle_room * 12);
    return status;
}

/* ---- Written ---- */

/* Binary. Coordinates become floats; a normal is that of the rounded corners, computed in doubles, and zero for a
 * triangle without area. The header does not begin with the word solid, which some readers take for ASCII. */

enum { STL_WRITTEN_HEADER = 80, STL_WRITTEN_TRIANGLE = 50 };

static uint8_t *stl_put_triangles(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvx_mesh *const mesh = user;
    int const f32 = bvxi_writes_f32(mesh);
    for (uint64_t t = begin; t < end; t++, at += STL_WRITTEN_TRIANGLE) {
        double world[3], u[3], v[3], n[3];
        float corner[3][3];

        for (size_t k = 0; k < 3; k++) {
            size_t const vertex = mesh->triangles[(size_t)t * 3 + k];
            if (f32) {
                memcpy(corner[k], (const uint8_t *)mesh->positions + 12 * vertex, 12);
                continue;
            }
            bvxi_world_position(mesh, vertex, world);
            for (int a = 0; a < 3; a++) corner[k][a] = (float)world[a];
        }
        /* In doubles of the rounded corners: the normal is that of the triangle that readers get. */
        for (int a = 0; a < 3; a++) {
            u[a] = (double)corner[1][a] - (double)corner[0][a];
            v[a] = (double)corner[2][a] - (double)corner[0][a];
        }
        for (int a = 0; a < 3; a++) n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
        double const length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
        /* A triangle without area has no direction; zero is what readers expect then. */
        for (int a = 0; a < 3; a++) bvxi_store_f32(at + 4 * a, length > 0 ? (float)(n[a] / length) : 0.0f);
        for (int k = 0; k < 3; k++)
            for (int a = 0; a < 3; a++) bvxi_store_f32(at + 12 + 12 * k + 4 * a, corner[k][a]);
        bvxi_store_u16(at + 48, 0);
    }
    return at;
}

bvx_status bvxi_write_stl(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file)
{
    static const char title[] = "binary STL written by bitvox";
    bvxi_file_part const part = {
        .count = mesh->triangle_count, .most = STL_WRITTEN_TRIANGLE, .put = stl_put_triangles, .user = mesh};

    /* Checked before memory is made: the message names a vertex rather than a broken file. Floats as they are need
     * no check; others are compared once with the frame added. */
    for (uint64_t v = 0; v < (bvxi_writes_f32(mesh) ? 0 : mesh->vertex_count); v++) {
        double p[3];

        bvxi_world_position(mesh, v, p);
        for (int a = 0; a < 3; a++)
            if (p[a] >= BVXI_FLOAT_LIMIT || p[a] <= -BVXI_FLOAT_LIMIT)
                return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                     "STL: vertex %i has the coordinate %g, too large for the format's "
                                     "32-bit floats; take PLY or OBJ",
                                     v, p[a]);
    }
    BVXI_TRY(bvxi_make_file(ctx, "the STL file", 0.0, STL_WRITTEN_HEADER + 4, &part, 1, file));
    memset(file->bytes, 0, STL_WRITTEN_HEADER);
    memcpy(file->bytes, title, sizeof title - 1);
    bvxi_store_u32(file->bytes + STL_WRITTEN_HEADER, (uint32_t)mesh->triangle_count);
    return BVX_OK;
}
