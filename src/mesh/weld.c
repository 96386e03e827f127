/* weld.c - which vertices are at the same position, and which triangles are there once.
 *
 * Vertices enter a table in their order, so the one that stands for a position is the first of it, whatever
 * the table looks like. Positions are compared, not only their hashes; for input made against the hash a
 * tree takes over. Cost: O(vertices). */
#include "mesh/topology.h"
#include "mesh/view.h"
#include "core/key_tree.h"

enum {
    WELD_ASKS = 1 << 20, /* vertices between asking progress */
    WELD_BATCH = 64,     /* vertices whose places are asked from memory before the first is looked at */
    WELD_GRAIN = 16384,  /* vertices to a part of the table, at least */
    WELD_PARTS = 4       /* more would read more than they share */
};

/* The table in parts, each of which a task has for itself: it looks at all vertices and takes those whose search begins
 * there. That costs a look for each task: there are as many as threads, which show nowhere. */
typedef struct weld_job {
    const bvx_mesh_view *view;
    uint32_t *table;            /* vertex index plus 1, or 0 [Size: size] */
    uint64_t size, first, last; /* of the table; vertices of this step */
    uint32_t *representative;
    int32_t parts;
    uint64_t found[WELD_PARTS], probes[WELD_PARTS];
} weld_job;

/* Vertices from *next on whose searches begin in a part of the table, and where. Both it and the vertices found there
 * may lie anywhere in memory, so that all of them are requested before the first is needed. */
static uint64_t weld_slots(const weld_job *w, uint64_t begin, uint64_t end, uint64_t *next, uint32_t *vertex,
                           uint64_t *slot)
{
    uint64_t n = 0;

    for (; *next < w->last && n < WELD_BATCH; ++*next) {
        double p[3];

        bvxi_view_position(w->view, *next, p);
        /* The high bits of the hash times the size spread over the table without a division. */
        /* Mixed well; adding 0 makes -0 the same as 0. */
        uint64_t h = 0, bits;
        /* Each coordinate is mixed in before the next, so that equal bits at other places give another hash. */
        for (int a = 0; a < 3; a++) {
            double x = p[a] + 0.0;
            memcpy(&bits, &x, sizeof bits);
            h = (h ^ bits) * UINT64_C(0x9e3779b97f4a7c15);
            h ^= h >> 29;
        }
        h *= UINT64_C(0xbf58476d1ce4e5b9);
        slot[n] = (h >> 33) * w->size >> 31; /* size < 2^33 */
        if (slot[n] - begin >= end - begin) continue;
        BVXI_PREFETCH(&w->table[slot[n]]);
        vertex[n++] = (uint32_t)*next;
    }
    for (uint64_t k = 0; k < n; k++) {
        uint32_t const other = w->table[slot[k]];
        BVXI_PREFETCH(bvxi_view_position_at(w->view, other - (other != 0)));
    }
    return n;
}

static void weld_part(void *user, int32_t part)
{
    weld_job *const w = user;
    uint64_t const limit = bvxi_probe_limit(w->view->vertex_count);
    uint64_t begin, end, next = w->first, found = 0, probes = w->probes[part], slots[WELD_BATCH], n;
    uint32_t vertex[WELD_BATCH];

    bvxi_piece(w->size, w->parts, part, &begin, &end);
    /* Too many steps so far: whatever was found is thrown away, and the tree begins anew. */
    while (probes <= limit && (n = weld_slots(w, begin, end, &next, vertex, slots)) != 0)
        for (uint64_t k = 0; k < n && probes <= limit; k++) {
            double p[3], q[3];

            bvxi_view_position(w->view, vertex[k], p);
            for (uint64_t slot = slots[k]; probes <= limit;
                 slot = slot + 1 == end ? begin : slot + 1, probes++) {
                uint32_t const other = w->table[slot];

                w->representative[vertex[k]] = other == 0 ? vertex[k] : other - 1;
                if (other == 0) {
                    w->table[slot] = vertex[k] + 1;
                    found++;
                    break;
                }
                bvxi_view_position(w->view, other - 1, q);
                if (p[0] == q[0] && p[1] == q[1] && p[2] == q[2]) break;
            }
        }
    w->found[part] += found;
    w->probes[part] = probes;
}

/* *different becomes 0 when it was searched too long. */
static bvx_status weld_into(bvx_context *ctx, weld_job *w, uint64_t *different)
{
    uint64_t const count = w->view->vertex_count;

    *different = 0;
    w->parts = bvxi_piece_count(count, WELD_GRAIN);
    if (w->parts > bvxi_threads(ctx)) w->parts = bvxi_threads(ctx);
    if (w->parts > WELD_PARTS) w->parts = WELD_PARTS;
    for (; w->first < count; w->first = w->last) {
        w->last = count - w->first < WELD_ASKS ? count : w->first + WELD_ASKS;
        if (w->first != 0) BVXI_TRY(bvxi_progress(ctx, "weld", (double)w->first / (double)count));
        bvxi_tasks(ctx, w->parts, weld_part, w);
    }
    for (int32_t i = 0; i < w->parts; i++) *different += w->found[i];
    for (int32_t i = 0; i < w->parts; i++)
        if (w->probes[i] > bvxi_probe_limit(count)) *different = 0;
    return BVX_OK;
}

/* A bvxi_key_fn: the bits of a position. */
static void weld_key(const void *user, uint64_t vertex, uint32_t key[BVXI_KEY_WORDS])
{
    double p[3];
    bvxi_view_position(user, vertex, p);
    for (int a = 0; a < 3; a++) p[a] += 0.0;
    memcpy(key, p, sizeof p);
}

bvx_status bvxi_weld(bvx_context *ctx, const bvx_mesh_view *view, uint32_t *representative,
                     uint64_t *different)
{
    uint64_t const size = view->vertex_count + view->vertex_count / 2 + 1;
    weld_job w = {.view = view, .size = size, .representative = representative};
    BVXI_TRY(BVXI_ZEROS(ctx, size, "the welding table", w.table));
    bvx_status const status = weld_into(ctx, &w, different);
    bvxi_drop(ctx, w.table);
    /* No vertex at all has been found different: the mark of a search that was given up. */
    if (status != BVX_OK || *different != 0 || view->vertex_count == 0) return status;

    bvxi_key_tree tree;
    BVXI_TRY(bvxi_key_tree_open(ctx, &tree, weld_key, view, view->vertex_count));
    for (uint64_t i = 0; i < view->vertex_count; i++) {
        if (BVXI_UNLIKELY(i % WELD_ASKS == WELD_ASKS - 1))
            BVXI_TRY(bvxi_progress(ctx, "weld", (double)i / (double)view->vertex_count));
        representative[i] = (uint32_t)bvxi_key_tree_find(&tree, i);
        *different += representative[i] == i; /* A vertex that finds itself is the first at its position. */
    }
    bvxi_key_tree_close(ctx, &tree);
    return BVX_OK;
}

/* ---- Triangles that are there once ---- */

/* The places of a triangle, least first. */
static void places_of_triangle(const uint32_t *representative, const uint32_t corner[3], uint32_t place[3])
{
    uint32_t const a = representative[corner[0]];
    uint32_t const b = representative[corner[1]];
    uint32_t const c = representative[corner[2]];
    uint32_t const low = a < b ? a : b, high = a < b ? b : a;
    /* The middle one is what is neither the least nor the greatest. */
    place[0] = low < c ? low : c;
    place[2] = high > c ? high : c;
    place[1] = c <= low ? low : c >= high ? high : c;
}

uint64_t bvxi_drop_collapsed(const bvx_mesh_view *view, const uint32_t *representative, uint32_t *corner)
{
    uint64_t kept = 0;
    for (uint64_t t = 0; t < view->triangle_count; t++) {
        uint32_t *const to = corner + 3 * kept;
        bvxi_view_triangle(view, t, to);
        kept += representative[to[0]] != representative[to[1]] &&
                representative[to[1]] != representative[to[2]] &&
                representative[to[2]] != representative[to[0]];
    }
    return kept;
}

/* Fill corner by a table [Size: size] of kept triangles plus 1, or 0. Returns 0 after too long a search. */
static int drop_by_table(const bvx_mesh_view *view, const uint32_t *representative, uint32_t *table,
                         uint64_t size, uint32_t *corner, uint64_t *kept)
{
    uint64_t const limit = bvxi_probe_limit(view->triangle_count);
    uint64_t count = 0, probes = 0;

    /* The triangle is written behind the kept ones first, and stays only when it is new. */
    for (uint64_t t = 0; t < view->triangle_count; t++) {
        uint32_t *const mine = corner + 3 * count;
        uint32_t place[3], other[3];
        uint64_t slot;
        bvxi_view_triangle(view, t, mine);
        places_of_triangle(representative, mine, place);
        if (place[0] == place[1] || place[1] == place[2]) continue;

        /* An open table, half as large again as the triangles: the searches stay short. */
        uint64_t h = ((uint64_t)place[0] << 32 | place[1]) * UINT64_C(0x9e3779b97f4a7c15);
        h = (h ^ h >> 32 ^ place[2]) * UINT64_C(0xbf58476d1ce4e5b9);
        for (slot = ((h ^ h >> 29) * UINT64_C(0x94d049bb133111eb) >> 33) * size >> 31; table[slot] != 0;
             slot = slot + 1 == size ? 0 : slot + 1, probes++) {
            places_of_triangle(representative, corner + 3 * ((uint64_t)table[slot] - 1), other);
            if (memcmp(place, other, sizeof place) == 0) break;
        }

        /* Too many steps are the sign of input that was made against the hash; a tree takes over. */
        if (BVXI_UNLIKELY(probes > limit)) return 0;
        if (table[slot] != 0) continue;
        table[slot] = (uint32_t)++count;
    }
    *kept = count;
    return 1;
}

typedef struct kept_triangles {
    const uint32_t *representative, *corner;
} kept_triangles;

/* A bvxi_key_fn. */
static void kept_key(const void *user, uint64_t number, uint32_t key[BVXI_KEY_WORDS])
{
    const kept_triangles *const k = user;
    places_of_triangle(k->representative, k->corner + 3 * number, key);
}

bvx_status bvxi_drop_duplicates(bvx_context *ctx, const bvx_mesh_view *view, const uint32_t *representative,
                                uint32_t *corner, uint64_t *kept)
{
    uint64_t const size = view->triangle_count + view->triangle_count / 2 + 1;
    uint32_t *table;
    BVXI_TRY(BVXI_ZEROS(ctx, size, "the triangles' table", table));
    int const done = drop_by_table(view, representative, table, size, corner, kept);
    bvxi_drop(ctx, table);
    if (done) return BVX_OK;

    kept_triangles const all = {representative, corner};
    uint32_t place[3];
    uint64_t count = 0;
    bvxi_key_tree tree;

    BVXI_TRY(bvxi_key_tree_open(ctx, &tree, kept_key, &all, view->triangle_count));
    /* As the table does it, and in the same order, so the first of several stays here too. */
    for (uint64_t t = 0; t < view->triangle_count; t++) {
        bvxi_view_triangle(view, t, corner + 3 * count);
        places_of_triangle(representative, corner + 3 * count, place);
        if (place[0] != place[1] && place[1] != place[2]) count += bvxi_key_tree_find(&tree, count) == count;
    }
    bvxi_key_tree_close(ctx, &tree);
    *kept = count;
    return BVX_OK;
}
