/* hole_edges.c - the open edges of a snapped mesh.
 *
 * An edge waits until a triangle that runs along it the other way has come: the first few beside their lower
 * corner, others in a table. What waits at the end is open, as often as it is or, where directions are not to
 * matter, an odd rest once. This is done for corners by their numbers first, which leaves little of most
 * meshes, then for that by their places, which a tree finds (core/key_tree.h). Where the table of edges searches
 * too long, as for input that was made against its hash, a tree takes its place, too.
 * Guarantee: the same edges for any order of triangles, in any order. */
#include "core/key_tree.h"
#include "winding/holes.h"

enum { HOLE_TABLE = 1 << 12, HOLE_BESIDE = 4 };
#define HOLE_EMPTY UINT64_MAX

/* lower << 32 | higher in the next free slot; net: how many more triangles run upwards than downwards, never
 * 0. With a tree: in the order of their first appearance, where net may become 0. */
typedef struct edge_table {
    uint64_t *key;
    int64_t *net;
    uint64_t size, used;   /* size: a power of two, at least twice used */
    uint64_t puts, probes; /* edges put since it was made, steps from slot to slot */
    bvxi_key_tree tree;    /* its child is NULL: the table is hashed */
    uint64_t listed;       /* with a tree: edges that key and net hold */
} edge_table;

static inline uint64_t slot_of_edge(const edge_table *t, uint64_t key)
{
    uint64_t const h = key * UINT64_C(0x9e3779b97f4a7c15);
    return (h ^ h >> 32) & (t->size - 1);
}

static void close_edge_table(bvx_context *ctx, edge_table *t)
{
    bvxi_key_tree_close(ctx, &t->tree);
    bvxi_drop(ctx, t->net);
    bvxi_drop(ctx, t->key);
    memset(t, 0, sizeof *t);
}

static bvx_status open_edge_table(bvx_context *ctx, uint64_t size, edge_table *t)
{
    memset(t, 0, sizeof *t);
    t->size = size;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, size * 8, "the edges that wait", &t->key));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, size * 8, "the edges' directions", &t->net));
    for (uint64_t i = 0; i < size; i++) t->key[i] = HOLE_EMPTY;
    return BVX_OK;
}

/* Edges stand at most twice as far from their places, all together, as they did in the smaller table. */
static bvx_status grow_edge_table(bvx_context *ctx, edge_table *t)
{
    /* Twice the size: half of it is used at most, so that searches stay short. */
    edge_table larger;

    BVXI_TRY(open_edge_table(ctx, 2 * t->size, &larger));
    for (uint64_t i = 0; i < t->size; i++) {
        if (t->key[i] == HOLE_EMPTY) continue;
        uint64_t slot = slot_of_edge(&larger, t->key[i]);
        for (; larger.key[slot] != HOLE_EMPTY; larger.probes++) slot = (slot + 1) & (larger.size - 1);
        larger.key[slot] = t->key[i];
        larger.net[slot] = t->net[i];
    }

    /* Steps count over the table's whole life, or growing would hide a long search. */
    larger.used = t->used;
    larger.puts = t->puts;
    larger.probes += t->probes;
    close_edge_table(ctx, t);
    *t = larger;
    return BVX_OK;
}

/* ---- edges in a tree ---- */

/* A bvxi_key_fn; user: the keys. */
static void waiting_edge_key(const void *user, uint64_t number, uint32_t key[BVXI_KEY_WORDS])
{
    const uint64_t *const keys = user;
    key[0] = (uint32_t)keys[number];
    key[1] = (uint32_t)(keys[number] >> 32);
}

static bvx_status plant_edge_tree(bvx_context *ctx, edge_table *t)
{
    BVXI_TRY(bvxi_key_tree_open(ctx, &t->tree, waiting_edge_key, t->key, t->size));
    for (uint64_t i = 0; i < t->size; i++) { /* what is listed lies before i */
        uint64_t const key = t->key[i];
        /* Keys move down to the front of the same array, never over one that is still to come. */
        if (key == HOLE_EMPTY) continue;
        t->key[t->listed] = key;
        t->net[t->listed] = t->net[i];
        bvxi_key_tree_find(&t->tree, t->listed++);
    }
    for (uint64_t i = t->listed; i < t->size; i++) t->key[i] = HOLE_EMPTY;
    return BVX_OK;
}

/* A new table of those that still wait, and its tree. */
static bvx_status grow_edge_tree(bvx_context *ctx, edge_table *t)
{
    edge_table larger;

    /* A size of its own: as large only as the edges that still wait require. */
    BVXI_TRY(open_edge_table(ctx, 2 * (t->used + 3) > t->size ? 2 * t->size : t->size, &larger));
    for (uint64_t i = 0; i < t->listed; i++) {
        if (t->net[i] == 0) continue;
        larger.key[larger.used] = t->key[i];
        larger.net[larger.used++] = t->net[i];
    }
    close_edge_table(ctx, t);
    bvx_status status = larger.size > UINT32_MAX
                            ? bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                            "more than 2^31 edges of one triangle wait for another")
                            : plant_edge_tree(ctx, &larger);
    *t = larger;
    return status;
}

/* Room for three edges more, however they are to be found. */
static inline bvx_status make_room_for_edges(bvx_context *ctx, edge_table *t)
{
    if (BVXI_UNLIKELY(t->tree.child != NULL))
        return t->listed + 3 > t->size ? grow_edge_tree(ctx, t) : BVX_OK;
    /* The steps of all searches against what honest edges would take: above it, the tree answers for good. */
    if (BVXI_UNLIKELY(t->probes > bvxi_probe_limit(t->puts))) {
        BVXI_TRY(plant_edge_tree(ctx, t));
        return BVX_OK; /* at most half of it is used */
    }
    return BVXI_UNLIKELY(2 * (t->used + 3) > t->size) ? grow_edge_table(ctx, t) : BVX_OK;
}

/* ---- edges in a table ---- */

static inline void put_hole_edge(edge_table *t, uint32_t from, uint32_t to)
{
    /* The lower corner first, so that both directions of an edge meet in one slot. */
    uint64_t const key = from < to ? (uint64_t)from << 32 | to : (uint64_t)to << 32 | from;
    int64_t const direction = from < to ? 1 : -1;
    uint64_t slot = slot_of_edge(t, key);

    if (from == to) return;
    if (BVXI_UNLIKELY(t->tree.child != NULL)) {
        /* Written at the end first, as the tree compares keys of the list; kept only when new. */
        t->key[t->listed] = key;
        t->net[t->listed] = 0;
        uint64_t const at = bvxi_key_tree_find(&t->tree, t->listed);
        t->listed += at == t->listed;
        /* used counts the edges that still wait, whatever remains in the list. */
        t->used -= t->net[at] != 0;
        t->net[at] += direction;
        t->used += t->net[at] != 0;
        return;
    }
    t->puts++;
    for (; t->key[slot] != key && t->key[slot] != HOLE_EMPTY; t->probes++) slot = (slot + 1) & (t->size - 1);

    /* The first of its kind waits; later ones cancel it or wait with it, and at 0 the slot is free again. */
    if (t->key[slot] == HOLE_EMPTY) {
        t->key[slot] = key;
        t->net[slot] = direction;
        t->used++;
        return;
    }
    t->net[slot] += direction;
    if (t->net[slot] != 0) return;

    /* Later ones move up into the free slot, so that no search ends too early. */
    uint64_t const mask = t->size - 1;
    for (uint64_t i = (slot + 1) & mask; t->key[i] != HOLE_EMPTY; i = (i + 1) & mask, t->probes++) {
        /* An entry whose own slot lies after the free one stays: it could not be found from there. */
        if (((i - slot_of_edge(t, t->key[i])) & mask) < ((i - slot) & mask)) continue;
        t->key[slot] = t->key[i];
        t->net[slot] = t->net[i];
        slot = i;
    }
    t->key[slot] = HOLE_EMPTY;
    t->used--;
}

/* What waits in the end, each as often as it is, or with odd_once once where that is odd; from << 32 | to. */
static bvx_status list_open_edges(bvx_context *ctx, const edge_table *t, int odd_once, uint64_t **edges,
                                  uint64_t *count)
{
    *edges = NULL;
    *count = 0;
    /* Counted first, then listed: the list has its exact size. */
    for (int fill = 0; fill < 2; fill++) {
        uint64_t n = 0;
        for (uint64_t i = 0; i < t->size && t->used > 0; i++) {
            uint64_t const key = t->key[i];
            int64_t const net = key == HOLE_EMPTY ? 0 : t->net[i];
            uint64_t copies = (uint64_t)(net < 0 ? -net : net);
            /* Where directions are not to matter, pairs cancel whichever way they run. */
            if (odd_once) copies &= 1;
            for (uint64_t k = 0; k < copies && fill; k++)
                (*edges)[n + k] = net > 0 ? key : key << 32 | key >> 32;
            n += copies;
        }
        if (!fill) BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, n * 8, "the open edges", edges));
        *count = n;
    }
    return BVX_OK;
}

/* The first few edges wait beside their lower corner: (higher << 1 | runs downwards) + 1, or 0. */
static inline int put_beside(uint32_t *beside, uint32_t from, uint32_t to)
{
    uint32_t *const slot = beside + (size_t)HOLE_BESIDE * (from < to ? from : to);
    /* The partner of a value differs in its lowest bit only. */
    uint32_t const value = ((from < to ? to << 1 : from << 1 | 1)) + 1, other = ((value - 1) ^ 1) + 1;
    int free = -1;

    for (int i = 0; i < HOLE_BESIDE; i++) {
        if (slot[i] == other) {
            slot[i] = 0;
            return 1;
        }
        if (slot[i] == 0) free = i;
    }
    if (free >= 0) slot[free] = value;
    return free >= 0;
}

static bvx_status put_triangles(bvx_context *ctx, const bvx_mesh_view *view, const uint32_t *same,
                                uint64_t limit, uint32_t *beside, edge_table *t)
{
    int const narrow = view->vertex_count < UINT32_MAX / 2; /* corners fit 31 bits */
    uint32_t c[3];

    /* Beside the corners first, which needs no hash; what does not fit there goes to the table. */
    for (uint64_t i = 0; i < view->triangle_count && t->used <= limit; i++) {
        bvxi_view_triangle(view, i, c);
        for (int k = 0; k < 3 && same != NULL; k++) c[k] = same[c[k]];
        for (int k = 0; k < 3; k++) {
            uint32_t const from = c[k], to = c[k == 2 ? 0 : k + 1];
            if (from != to && !(narrow && put_beside(beside, from, to))) put_hole_edge(t, from, to);
        }
        BVXI_TRY(make_room_for_edges(ctx, t));
    }
    uint64_t const vertices = view->vertex_count;
    for (uint64_t v = 0; v < vertices; v++)
        for (int i = 0; i < HOLE_BESIDE; i++) {
            uint32_t const value = beside[HOLE_BESIDE * v + (uint64_t)i] - 1;
            if (value == UINT32_MAX) continue;
            /* Of two directions the lowest bit says which. */
            if ((value & 1) == 0) put_hole_edge(t, (uint32_t)v, value >> 1);
            else put_hole_edge(t, value >> 1, (uint32_t)v);
            BVXI_TRY(make_room_for_edges(ctx, t));
            if (t->used > limit) return BVX_OK; /* So many that nothing of this will be used. */
        }
    return BVX_OK;
}

/* Edges of triangles; same: NULL, or which vertex stands for each. More than limit left: of no use. */
static bvx_status cancel_triangles(bvx_context *ctx, const bvx_mesh_view *view, const uint32_t *same,
                                   uint64_t limit, edge_table *t)
{
    uint64_t const bytes = view->vertex_count * HOLE_BESIDE * 4;
    uint32_t *beside;
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, bytes, "the vertices' edges", &beside));
    bvx_status const status = put_triangles(ctx, view, same, limit, beside, t);
    bvxi_drop(ctx, beside);
    return status;
}

/* ---- Corners at one place ---- */

/* A bvxi_key_fn. */
static void place_key(const void *user, uint64_t vertex, uint32_t key[BVXI_KEY_WORDS])
{
    const bvxi_snapped *const s = user;
    memcpy(key, s->xyz + 3 * vertex, 12);
}

/* By numbers, then the rest by places; where numbers cancel too little, all by places. Last by lines. */
bvx_status bvxi_open_edges(bvx_context *ctx, const bvx_mesh_view *view, const bvxi_snapped *s, int odd_once,
                           uint64_t **edges, uint64_t *count)
{
    uint64_t *list = NULL, left = 0;
    uint64_t const limit = HOLE_TABLE + view->triangle_count / 2;
    edge_table t;

    *edges = NULL;
    *count = 0;
    BVXI_TRY(open_edge_table(ctx, HOLE_TABLE, &t));

    /* By numbers first: in a welded mesh that is all, without a look at a place. */
    BVXI_TRY(cancel_triangles(ctx, view, NULL, limit, &t));
    int const full = t.used > limit;
    if (!full) BVXI_TRY(list_open_edges(ctx, &t, 0, &list, &left));
    close_edge_table(ctx, &t);
    BVXI_TRY(open_edge_table(ctx, HOLE_TABLE, &t));
    /* Too many were left for numbers to be of use: all of it again, by places. */
    uint32_t *same = NULL;
    bvxi_key_tree places;

    BVXI_TRY(bvxi_key_tree_open(ctx, &places, place_key, s, s->vertex_count));
    /* Edges that did not meet by number may meet by place, where vertices are not welded. */
    for (uint64_t i = 0; i < left; i++) {
        uint64_t const from = bvxi_key_tree_find(&places, list[i] >> 32);
        put_hole_edge(&t, (uint32_t)from, (uint32_t)bvxi_key_tree_find(&places, (uint32_t)list[i]));
        BVXI_TRY(make_room_for_edges(ctx, &t));
    }
    /* Every vertex gets the one that stands for its place; then triangles cancel as they do by number. */
    if (list == NULL)
        BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, s->vertex_count * 4, "the vertices at one place", &same));
    for (uint64_t v = 0; v < s->vertex_count && list == NULL; v++)
        same[v] = (uint32_t)bvxi_key_tree_find(&places, v);
    bvxi_key_tree_close(ctx, &places);
    if (list == NULL) BVXI_TRY(cancel_triangles(ctx, view, same, UINT64_MAX, &t));
    bvxi_drop(ctx, same);
    bvxi_drop(ctx, list);
    BVXI_TRY(list_open_edges(ctx, &t, odd_once, edges, count));
    close_edge_table(ctx, &t);
    /* What is left may still cancel along lines, where vertices lie on the middle of edges. */
    return bvxi_cancel_lines(ctx, s, odd_once, edges, count);
}
