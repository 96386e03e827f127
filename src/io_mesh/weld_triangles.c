/* weld_triangles.c - triangles that bring their own corners to an indexed mesh, welded as they come.
 *
 * An open table finds the vertex at equal coordinates, so raw corners are never stored, and vertices are
 * numbered by their first occurrence whatever the table looks like. Some hundred triangles are welded at a
 * time: first all their places in the table, then all the vertices found there are asked from memory, which
 * may lie anywhere, so that they are near when they are compared.
 * Where the table searches too long, as for files that were made against the hash, a tree takes its place
 * (core/key_tree.h).
 * Memory: 12 bytes a triangle, 8 to 16 for the table, 6 for the vertices to begin with; at most 60 bytes a
 * vertex on the way. Cost: O(corners). */
#include "io_mesh/weld_triangles.h"

enum { SOUP_LEAST = 1024 }; /* triangles to begin with, and places of the table */

#if defined(__GNUC__)
#define SOUP_PREFETCH(address) __builtin_prefetch(address)
#else
#define SOUP_PREFETCH(address) ((void)(address))
#endif

static inline uint64_t soup_hash(const uint32_t bits[3])
{
    uint64_t h = (bits[0] | (uint64_t)bits[1] << 32) * UINT64_C(0x9e3779b97f4a7c15);
    h = ((h ^ h >> 32) + bits[2]) * UINT64_C(0xbf58476d1ce4e5b9);
    return h ^ h >> 32;
}

static inline int soup_same(const bvxi_soup *s, uint32_t vertex, const uint32_t bits[3])
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
static bvx_status soup_make_table(bvxi_soup *s, uint64_t size)
{
    bvx_context *const ctx = s->source->ctx;
    uint32_t *table, bits[3];

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, size * sizeof *table, "the table of vertices", &table));
    /* The order is that of the vertices, so the table looks the same however often it grew. */
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

bvx_status bvxi_soup_begin(bvxi_soup *soup, bvxi_source *source, uint64_t count)
{
    bvxi_soup *const s = soup;
    uint64_t size = SOUP_LEAST;

    /* With a known count the array of triangles is made once, and becomes the result itself. */
    s->source = source;
    s->triangle_kind = count > 0 ? BVXI_RESULT : BVXI_SCRATCH;
    s->triangle_room = count > 0 ? count : SOUP_LEAST;
    BVXI_TRY(bvxi_alloc(source->ctx, s->triangle_kind, s->triangle_room * 12, "the triangles of the file",
                        &s->triangles));
    s->vertex_room = count / 2 + count / 32 + 64; /* a closed mesh has half as many vertices as triangles */
    BVXI_TRY(bvxi_alloc(source->ctx, BVXI_SCRATCH, s->vertex_room * 12, "the vertices of the file",
                        &s->positions));
    while (size < 2 * count) size *= 2; /* twice what it must be: fewer vertices share a place */
    return soup_make_table(s, size);
}

/* Vertices that arrays and table hold. */
static uint64_t soup_limit(const bvxi_soup *s)
{
    uint64_t const limit = s->table == NULL || s->vertex_room < s->table_size / 2 ? s->vertex_room
                                                                                  : s->table_size / 2;
    return limit < UINT32_MAX ? limit : UINT32_MAX;
}

static bvx_status soup_grow(bvxi_soup *s)
{
    /* Entries of the table are one more than the vertex, 0 being empty: so the last index stays unused. */
    if (s->vertex_count == UINT32_MAX)
        return bvxi_fail_for(s->source->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the file has 2^32 different vertices or more", s->source->format);

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
static inline int soup_find(bvxi_soup *s, size_t k, uint64_t limit, uint32_t *vertex, uint64_t *probes)
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

    /* A new vertex takes the empty place at once: its next use finds it here. */
    memcpy(s->positions + (size_t)s->vertex_count * 3, bits, 12);
    *vertex = (uint32_t)s->vertex_count++;
    s->table[slot] = *vertex + 1;
    return 1;
}

static bvx_status soup_make_triangles(bvxi_soup *s)
{
    uint64_t const room = s->triangle_room * 2;

    /* Checked once a batch, so that the loop over corners has no check for room. */
    if (s->triangle_count + s->waiting <= s->triangle_room) return BVX_OK;
    if (s->triangle_count + s->waiting > INT32_MAX)
        return bvxi_fail_for(s->source->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the file has 2^31 triangles or more", s->source->format);
    BVXI_TRY(bvxi_resize(s->source->ctx, s->triangle_kind, &s->triangles, s->triangle_room * 12, room * 12,
                         "the triangles of the file"));
    s->triangle_room = room; /* twice SOUP_LEAST or more: a batch fits in */
    return BVX_OK;
}

static bvx_status soup_weld_by_table(bvxi_soup *s, uint32_t *out)
{
    size_t const count = (size_t)s->waiting * 3, mask = (size_t)(s->table_size - 1);
    uint64_t limit = soup_limit(s), probes = 0;

    /* Three walks over the batch: hashes, entries, vertices. Each asks memory for what the next one reads. */
    for (size_t k = 0; k < count; k++) {
        s->hash[k] = soup_hash(s->bits[k]);
        SOUP_PREFETCH(&s->table[(size_t)s->hash[k] & mask]);
    }
    for (size_t k = 0; k < count; k++) {
        uint32_t const entry = s->table[(size_t)s->hash[k] & mask];
        SOUP_PREFETCH(s->positions + (size_t)(entry - (entry != 0)) * 3);
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
    const bvxi_soup *const s = user;
    memcpy(key, s->positions + (size_t)vertex * 3, 12);
}

static bvx_status soup_plant_tree(bvxi_soup *s)
{
    bvx_context *const ctx = s->source->ctx;
    bvxi_drop(ctx, s->table);
    s->table = NULL;
    BVXI_TRY(bvxi_key_tree_open(ctx, &s->tree, soup_key, s, s->vertex_room));

    /* The tree is filled in the order of vertices, so that their numbers stay what they are. */
    for (uint64_t v = 0; v < s->vertex_count; v++) bvxi_key_tree_find(&s->tree, v);
    return BVX_OK;
}

static bvx_status soup_weld_by_tree(bvxi_soup *s, uint32_t *out)
{
    for (size_t k = 0; k < (size_t)s->waiting * 3; k++) {
        /* A candidate is written after the last vertex; it becomes one only where the tree has no equal. */
        if (s->vertex_count == soup_limit(s)) BVXI_TRY(soup_grow(s));
        memcpy(s->positions + (size_t)s->vertex_count * 3, s->bits[k], 12);
        out[k] = (uint32_t)bvxi_key_tree_find(&s->tree, s->vertex_count);
        s->vertex_count += out[k] == s->vertex_count;
    }
    return BVX_OK;
}

bvx_status bvxi_soup_weld(bvxi_soup *soup)
{
    bvxi_soup *const s = soup;
    BVXI_TRY(soup_make_triangles(s));
    uint32_t *const out = s->triangles + (size_t)s->triangle_count * 3;
    BVXI_TRY(s->table != NULL ? soup_weld_by_table(s, out) : soup_weld_by_tree(s, out));
    s->triangle_count += s->waiting;
    s->waiting = 0;

    /* Long searches are the sign of a table that was attacked
     * or is unlucky; the limit grows with the corners. */
    return s->table != NULL && s->probes > bvxi_probe_limit(3 * s->triangle_count) ? soup_plant_tree(s)
                                                                                   : BVX_OK;
}

bvx_status bvxi_soup_finish(bvxi_soup *soup, bvx_mesh *mesh)
{
    bvxi_soup *const s = soup;
    bvx_context *const ctx = s->source->ctx;

    /* The search is over: its memory is freed before the result's is made. */
    bvxi_drop(ctx, s->table);
    s->table = NULL;
    bvxi_key_tree_close(ctx, &s->tree);
    BVXI_TRY(bvxi_make_positions(ctx, mesh, BVX_F32, s->vertex_count));
    memcpy(mesh->positions, s->positions, (size_t)s->vertex_count * 12);

    /* Where the count was known, the array is the result already; a growing one was scratch and is copied. */
    if (s->triangle_kind == BVXI_RESULT) {
        mesh->triangles = s->triangles;
        mesh->triangle_count = mesh->triangle_capacity = s->triangle_count;
        s->triangles = NULL;
        return BVX_OK;
    }
    BVXI_TRY(bvxi_make_triangles(ctx, mesh, s->triangle_count));
    memcpy(mesh->triangles, s->triangles, (size_t)s->triangle_count * 12);
    return BVX_OK;
}

void bvxi_soup_free(bvxi_soup *soup)
{
    bvx_context *const ctx = soup->source->ctx;
    bvxi_drop(ctx, soup->table);
    bvxi_key_tree_close(ctx, &soup->tree);
    bvxi_drop(ctx, soup->positions);
    bvxi_free(ctx, soup->triangles, soup->triangle_room * 12);
}
