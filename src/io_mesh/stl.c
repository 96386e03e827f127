/* stl.c - STL, to meshes and from them. */
#include "io_mesh/weld_triangles.h"
#include "io/file_parts.h"
#include "io_mesh/mesh_formats.h"

#include <math.h>

/* ---- Read ---- */

/* STL, ASCII and binary, to an indexed mesh.
 *
 * Which kind a file is, is not told by the word solid, which many binary headers hold too: it is binary when
 * its size is the one that its count of triangles requires; else ASCII when its first kilobyte has no control
 * characters. STL repeats each vertex in every triangle. They are welded where their coordinates are equal,
 * -0 being 0, as they are read (weld_triangles.c), and numbered by their first occurrence. Normals and
 * attributes are not looked at.
 * Memory: that of the welding. Cost: O(bytes). */

enum {
    STL_HEADER = 84,       /* 80 bytes of anything, and the count */
    STL_TRIANGLE = 50,     /* a normal, three corners, two bytes of attributes */
    STL_SEEN_BYTES = 1024, /* of these, none may be a control character in a text */
    STL_NORMAL_WORDS = 8   /* most words between facet and outer: normal x y z, with room for the unusual */
};

/* ---- binary ---- */

static BVXI_COLD bvx_status stl_fail_coordinate(const bvxi_source *s, const uint8_t *at, uint64_t triangle,
                                                size_t corner)
{
    return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                         "STL: triangle %i, corner %u (byte %u): a coordinate is not finite", triangle,
                         (uint64_t)corner, bvxi_source_byte(s, at));
}

/* The coordinates of n triangles at p, the first of this number, into the batch. */
static bvx_status stl_take_batch(bvxi_soup *soup, const uint8_t *p, uint64_t first, uint32_t n)
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

    /* Only now, when one is known to be bad, is the first of them looked for. */
    while (bits[i] << 1 < 0xff000000u) i++;
    return stl_fail_coordinate(soup->source, p + i / 9 * STL_TRIANGLE + 12 + i / 3 % 3 * 12, first + i / 9,
                               i / 3 % 3);
}

static bvx_status stl_read_binary(bvxi_soup *soup, uint64_t count)
{
    const uint8_t *const data = (const uint8_t *)soup->source->begin + STL_HEADER;

    for (uint64_t t = 0; t < count; t += BVXI_SOUP_BATCH) {
        const uint8_t *const p = data + t * STL_TRIANGLE;
        uint32_t const n = count - t < BVXI_SOUP_BATCH ? (uint32_t)(count - t) : BVXI_SOUP_BATCH;
        /* Batch by batch, so that memory stays small and progress is called. */
        BVXI_TRY(bvxi_source_at(soup->source, (const char *)p));
        BVXI_TRY(stl_take_batch(soup, p, t, n));
        BVXI_TRY(bvxi_soup_weld(soup));
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

static const char *stl_skip_line(const char *p, const char *end)
{
    while (p < end && *p != '\n' && *p != '\r') p++;
    return p;
}

/* Three coordinates after the word vertex. */
static bvx_status stl_take_corner(const bvxi_source *s, const char **p, uint32_t bits[3])
{
    for (int a = 0; a < 3; a++) {
        float v;
        const char *const at = bvxi_skip_space(*p, s->end);
        size_t const used = bvxi_parse_float(at, s->end, &v);
        *p = at + used;
        if (used == 0 || (*p < s->end && !bvxi_is_space(**p)))
            return bvxi_fail_expected(s, at, "a coordinate");
        if (!(v - v == 0.0f) && !s->takes_any)
            return bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                 "STL: line %u: a coordinate is not a finite 32-bit float",
                                 bvxi_source_line(s, at));
        bits[a] = bvxi_soup_bits(v);
    }
    return BVX_OK;
}

/* What some programs write after endfacet, up to the end of the line or what may follow there. */
static const char *stl_skip_notes(const char *p, const char *end)
{
    for (;;) {
        const char *next;
        while (p < end && bvxi_is_blank(*p)) p++;
        next = p;
        if (p == end || *p == '\n' || *p == '\r' || stl_take(&next, end, "facet") ||
            stl_take(&next, end, "endsolid"))
            return p;
        p = bvxi_skip_word(p, end);
    }
}

/* The rest of a facet, after that word; loops of more than three corners become fans. */
static bvx_status stl_take_facet(bvxi_soup *soup, const char **p)
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
        BVXI_TRY(stl_take_corner(s, p, corner[corners < 2 ? corners : 2]));
        if (corners < 2) continue;
        memcpy(soup->bits[3 * soup->waiting], corner, sizeof corner);
        if (++soup->waiting == BVXI_SOUP_BATCH) BVXI_TRY(bvxi_soup_weld(soup));
    }
    if (corners < 3)
        return bvxi_fail_expected(s, bvxi_skip_space(*p, s->end), "three or more times 'vertex'");
    BVXI_TRY(stl_expect(s, p, "endloop", "'vertex' or 'endloop'"));
    BVXI_TRY(stl_expect(s, p, "endfacet", "'endfacet'"));
    *p = stl_skip_notes(*p, s->end);
    return BVX_OK;
}

static bvx_status stl_read_text(bvxi_soup *soup)
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
            p = stl_skip_line(p, s->end);
            inside = 0;
        } else if (!inside && stl_take(&p, s->end, "solid")) {
            p = stl_skip_line(p, s->end);
            inside = 1;
        } else {
            p = bvxi_skip_space(p, s->end);
            if (p == s->end && !inside) return bvxi_soup_weld(soup);
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

    /* The size decides before the text does: a binary header may hold any word, also 'solid'. */
    *count = size < STL_HEADER ? 0 : bvxi_load_u32((const uint8_t *)s->begin + STL_HEADER - 4, 0);
    *binary = size >= STL_HEADER && STL_HEADER + STL_TRIANGLE * *count == size;
    if (*binary || stl_is_text(s->begin, s->end)) return BVX_OK;

    /* Neither: a binary file that is cut off or has bytes
     * after its end. A cut is refused, more bytes are not. */
    *binary = 1;
    if (size < STL_HEADER)
        return bvxi_fail(s->ctx, BVX_ERR_FORMAT, "STL: %u bytes, no text, and a binary header has 84", size);
    if (STL_HEADER + STL_TRIANGLE * *count > size)
        return bvxi_fail(
            s->ctx, BVX_ERR_FORMAT,
            "STL: the header (byte 80) says %u triangles, which take %u bytes, but the file has %u", *count,
            STL_HEADER + STL_TRIANGLE * *count, size);
    return BVX_OK;
}

static bvx_status stl_read(bvxi_soup *soup, bvxi_source *source, int binary, uint64_t count, bvx_mesh *mesh)
{
    BVXI_TRY(bvxi_soup_begin(soup, source, binary ? count : 0));
    BVXI_TRY(binary ? stl_read_binary(soup, count) : stl_read_text(soup));
    if (soup->triangle_count == 0)
        return bvxi_fail(source->ctx, BVX_ERR_EMPTY, "STL: the file has no triangle");
    return bvxi_soup_finish(soup, mesh);
}

bvx_status bvxi_read_stl(bvxi_source *source, bvx_mesh *mesh)
{
    bvxi_soup soup = {0};
    uint64_t count;
    int binary;
    bvx_status status;

    BVXI_TRY(stl_tell_apart(source, &binary, &count));
    if (binary && count == 0)
        return bvxi_fail(source->ctx, BVX_ERR_EMPTY, "STL: the header (byte 80) says 0 triangles");
    if (count > INT32_MAX && binary)
        return bvxi_fail_for(source->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "STL: the file has %u triangles, the limit is below 2^31", count);
    status = stl_read(&soup, source, binary, count, mesh);
    bvxi_soup_free(&soup);
    return status;
}

/* ---- Written ---- */

/* A mesh to binary STL, with the normals of its facets.
 *
 * Coordinates become floats; a normal is that of the rounded corners, computed in doubles, and zero for a
 * triangle without area. The header does not begin with the word solid, which some readers take for ASCII. */

enum { STL_WRITTEN_HEADER = 80, STL_WRITTEN_TRIANGLE = 50 };

static void stl_facet_normal(const float c[3][3], float normal[3])
{
    double u[3], v[3], n[3], length;

    /* In doubles of the rounded corners: the normal is that of the triangle that readers get. */
    for (int a = 0; a < 3; a++) {
        u[a] = (double)c[1][a] - (double)c[0][a];
        v[a] = (double)c[2][a] - (double)c[0][a];
    }
    for (int a = 0; a < 3; a++) n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
    length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    /* A triangle without area has no direction; zero is what readers expect then. */
    for (int a = 0; a < 3; a++) normal[a] = length > 0 ? (float)(n[a] / length) : 0.0f;
}

static void stl_corner(const bvx_mesh *mesh, int f32, size_t vertex, float corner[3])
{
    double world[3];
    if (f32) {
        memcpy(corner, (const uint8_t *)mesh->positions + 12 * vertex, 12);
        return;
    }
    bvxi_world_position(mesh, vertex, world);
    for (int a = 0; a < 3; a++) corner[a] = (float)world[a];
}

static void stl_put_triangle(const bvx_mesh *mesh, int f32, uint64_t t, uint8_t *p)
{
    float corner[3][3], normal[3];
    for (size_t k = 0; k < 3; k++) stl_corner(mesh, f32, mesh->triangles[(size_t)t * 3 + k], corner[k]);
    /* Normal, three corners, and two bytes of attributes, which are 0. */
    stl_facet_normal((const float(*)[3])corner, normal);
    for (int a = 0; a < 3; a++) bvxi_store_f32(p + 4 * a, normal[a]);
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) bvxi_store_f32(p + 12 + 12 * k + 4 * a, corner[k][a]);
    bvxi_store_u16(p + 48, 0);
}

static bvx_status stl_check_floats(bvx_context *ctx, const bvx_mesh *mesh)
{
    double p[3];

    /* Floats as they are need no check; others are compared once with the frame added. */
    if (bvxi_writes_f32(mesh)) return BVX_OK;
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        bvxi_world_position(mesh, v, p);
        for (int a = 0; a < 3; a++)
            if (p[a] >= BVXI_FLOAT_LIMIT || p[a] <= -BVXI_FLOAT_LIMIT)
                return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                     "STL: vertex %i has the coordinate %g, too large for the format's "
                                     "32-bit floats; take PLY or OBJ",
                                     v, p[a]);
    }
    return BVX_OK;
}

static uint8_t *stl_put_triangles(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    int const f32 = bvxi_writes_f32(user);
    for (uint64_t t = begin; t < end; t++, at += STL_WRITTEN_TRIANGLE) stl_put_triangle(user, f32, t, at);
    return at;
}

bvx_status bvxi_write_stl(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file)
{
    static const char title[] = "binary STL written by bitvox";
    bvxi_file_part const part = {
        .count = mesh->triangle_count, .most = STL_WRITTEN_TRIANGLE, .put = stl_put_triangles, .user = mesh};

    BVXI_TRY(stl_check_floats(ctx, mesh));
    /* Checked before memory is made: the message names a vertex rather than a broken file. */
    BVXI_TRY(bvxi_make_file(ctx, "the STL file", 0.0, STL_WRITTEN_HEADER + 4, &part, 1, file));
    memset(file->bytes, 0, STL_WRITTEN_HEADER);
    memcpy(file->bytes, title, sizeof title - 1);
    bvxi_store_u32(file->bytes + STL_WRITTEN_HEADER, (uint32_t)mesh->triangle_count);
    return BVX_OK;
}
