/* topology.c - closed, manifold, oriented, how many pieces: from vertex indices only.
 *
 * Half-edges are put into buckets by their lower vertex and sorted by their higher vertex there (a radix sort
 * whose first digit is the vertex), so the half-edges of an edge lie side by side. Each gets a link to the
 * next half-edge of its edge, in a ring. Along the rings: pieces by union-find over triangles, fans by
 * walking round vertices. Ranges of vertices are tasks: a bucket is of one range, and so is a triangle, by
 * its least vertex; pairs of triangles of two ranges are joined at the end.
 * Guarantee: the counts are exact for any triangles, also for soups. Cost: O(triangles), the largest fan's
 * logarithm on top where fans are large.
 *
 * Numbers: half-edge h = 3 t + k runs from corner k to corner k + 1 of triangle t and stands for corner k
 * too. */
#include "mesh/topology.h"
#include "bits/sort.h"
#include "mesh/view.h"

enum {
    TOPOLOGY_ASKS = 1 << 20, /* corners between asking progress */
    TOPOLOGY_GRAIN = 8192,   /* vertices in a range, at least */
    TOPOLOGY_RANGES = 64,
    BUCKET_RANGES = 4 /* more would read more than they share */
};
#define TOPOLOGY_NONE UINT32_MAX /* no corner */

/* What a range of vertices has. */
typedef struct topology_counts {
    uint64_t edges, boundary, flipped, nonmanifold, duplicates;
    uint64_t joined;            /* triangles of the range, to others of it */
    uint64_t waiting;           /* entries, from the range's first on: pairs of triangles yet to be joined */
    uint64_t vertices, corners; /* that triangles use; in their first fans */
    int against;                /* 1: two half-edges run along an edge in the same direction */
} topology_counts;

typedef struct topology {
    bvx_context *ctx;
    const uint32_t *corners;
    uint64_t triangle_count, vertex_count;
    uint32_t *bucket_end; /* [Size: vertex_count] */
    uint32_t *corner_of;  /* one of the vertex, or TOPOLOGY_NONE [Size: vertex_count] */
    /* half-edges in buckets: higher vertex << 32 | half-edge [Size: triangle_count * 3] */
    uint64_t *entries;
    uint32_t *ring;   /* next half-edge of the same edge [Size: triangle_count * 3] */
    uint32_t *parent; /* union-find over triangles [Size: triangle_count] */
    uint64_t *broken; /* bit v: no fan, as an edge at v has three triangles or v has two fans */
    uint64_t *seen;   /* bit v: a fan at v was walked, or v is known to be broken; v is counted */
    uint64_t *walked; /* bit h: the fan of this corner was walked */
    int edges_alone;  /* 1: no pieces, no fans */
    bvx_certificate *result;
    int32_t ranges; /* of the vertices */
    topology_counts counts[TOPOLOGY_RANGES];
} topology;

static uint64_t topology_bit_words(uint64_t bits)
{
    return (bits + 63) / 64;
}

static int topology_bit_is_set(const uint64_t *bits, uint64_t i)
{
    return (int)(bits[i >> 6] >> (i & 63) & 1);
}

static void topology_bit_set(uint64_t *bits, uint64_t i)
{
    bits[i >> 6] |= UINT64_C(1) << (i & 63);
}

static uint32_t half_edge_before(uint32_t h)
{
    return h % 3 == 0 ? h + 2 : h - 1;
}

/* ---- edges ---- */

/* Counting sort of the half-edges by their lower vertex. A task reads all triangles and takes what belongs to
 * its range of vertices, so that each bucket is filled in the order of the half-edges. That costs a read for
 * each task: there are as many as threads, which show nowhere. */
typedef struct bucket_ranges {
    topology *topology;
    int32_t count;
} bucket_ranges;

static void count_buckets(void *user, int32_t range)
{
    const bucket_ranges *const r = user;
    const topology *const c = r->topology;
    uint64_t from, to;

    bvxi_piece(c->vertex_count, r->count, range, &from, &to);
    memset(c->bucket_end + from, 0, (size_t)(to - from) * sizeof *c->bucket_end);
    if (!c->edges_alone) memset(c->corner_of + from, 255, (size_t)(to - from) * 4); /* TOPOLOGY_NONE */
    uint64_t const size = to - from;
    for (const uint32_t *t = c->corners, *const end = t + 3 * c->triangle_count; t < end; t += 3) {
        uint32_t const ab = t[0] < t[1] ? t[0] : t[1];
        uint32_t const bc = t[1] < t[2] ? t[1] : t[2];
        uint32_t const ca = t[2] < t[0] ? t[2] : t[0];
        if (ab - from < size) c->bucket_end[ab]++;
        if (bc - from < size) c->bucket_end[bc]++;
        if (ca - from < size) c->bucket_end[ca]++;
    }
}

static void fill_buckets(void *user, int32_t range)
{
    const bucket_ranges *const r = user;
    const topology *const c = r->topology;
    const uint32_t *t = c->corners;
    uint64_t from, to;

    bvxi_piece(c->vertex_count, r->count, range, &from, &to);
    uint64_t const size = to - from;
    for (uint64_t h = 0; h < 3 * c->triangle_count; h += 3, t += 3)
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t const a = t[k], b = t[k == 2 ? 0 : k + 1];
            uint32_t const lower = a < b ? a : b, higher = a < b ? b : a;
            if (lower - from < size) c->entries[c->bucket_end[lower]++] = (uint64_t)higher << 32 | (h + k);
            if (a - from < size && !c->edges_alone) c->corner_of[a] = (uint32_t)h + k;
        }
}

/* The n >= 1 half-edges of one edge, sorted. */
static void check_edge(const topology *c, uint64_t *e, size_t n, uint32_t lower, topology_counts *counts)
{
    uint32_t const higher = (uint32_t)(e[0] >> 32), first = (uint32_t)e[0];
    uint64_t upwards = 0;

    counts->edges++;
    if (n == 1) {
        c->ring[first] = first;
        counts->boundary++;
        return;
    }

    /* A ring over all half-edges of the edge: each links to the next, the last to the first. */
    for (size_t i = 0; i < n; i++) {
        uint32_t const h = (uint32_t)e[i];
        c->ring[h] = (uint32_t)e[i + 1 == n ? 0 : i + 1];
        upwards += c->corners[h] == lower;
    }

    /* More than one half-edge in the same direction contradicts an orientation. */
    if (upwards > 1 || n - upwards > 1) counts->against = 1;
    if (n == 2 && upwards != 1) counts->flipped++;
    if (n > 2) counts->nonmanifold++;

    /* Triangles of the edge whose three vertices an earlier one has too. Each triangle is looked at once: on the
     * edge of its two least vertices. The entries' lower halves are reordered. */
    size_t kept = 0;
    for (size_t i = 0; i < n; i++) {
        uint32_t const opposite = c->corners[half_edge_before((uint32_t)e[i])];
        if (opposite > higher) e[kept++] = (uint64_t)opposite << 32 | (e[i] & UINT32_MAX);
    }
    if (kept > 1) bvxi_sort_u64(e, kept);
    for (size_t i = 1; i < kept; i++) counts->duplicates += e[i] >> 32 == e[i - 1] >> 32;
}

/* Is the least vertex of the triangle in the range from here on? The edge's own vertices are. */
static int is_of_range(const topology *c, uint32_t h, uint64_t from)
{
    return c->corners[half_edge_before(h)] >= from;
}

/* The triangles of an edge, along its ring; pairs with others take the place of entries already read. */
static void join_around_edge(const topology *c, uint32_t first, uint64_t from, uint64_t *waiting,
                             topology_counts *counts)
{
    int const own = is_of_range(c, first, from);
    for (uint32_t h = c->ring[first]; h != first; h = c->ring[h]) {
        if (BVXI_LIKELY(own && is_of_range(c, h, from)))
            counts->joined += (uint64_t)bvxi_join(c->parent, first / 3, h / 3);
        else waiting[counts->waiting++] = (uint64_t)(first / 3) << 32 | h / 3;
    }
}

static uint64_t first_entry(const topology *c, uint64_t vertex)
{
    return vertex == 0 ? 0 : c->bucket_end[vertex - 1];
}

static void check_range_of_edges(void *user, int32_t range, uint64_t from, uint64_t to)
{
    topology *const c = user;
    topology_counts counts = {0};

    uint64_t begin = first_entry(c, from);
    uint64_t *const waiting = c->entries + begin;
    for (uint64_t v = from; v < to; v++) {
        uint64_t const end = c->bucket_end[v];
        bvxi_sort_u64(c->entries + begin, (size_t)(end - begin));
        while (begin < end) {
            uint32_t const first = (uint32_t)c->entries[begin];
            uint64_t stop = begin + 1;
            while (stop < end && c->entries[stop] >> 32 == c->entries[begin] >> 32) stop++;
            check_edge(c, c->entries + begin, (size_t)(stop - begin), (uint32_t)v, &counts);
            if (!c->edges_alone) join_around_edge(c, first, from, waiting, &counts);
            begin = stop;
        }
    }
    c->counts[range] = counts;
}

static bvx_status check_edges(topology *c)
{
    bvx_certificate *const r = c->result;

    c->ranges = bvxi_piece_count(c->vertex_count, TOPOLOGY_GRAIN);
    if (c->ranges > TOPOLOGY_RANGES) c->ranges = TOPOLOGY_RANGES;
    /* Every triangle is a piece at first, and each join takes one away. */
    for (uint64_t t = 0; t < c->triangle_count && !c->edges_alone; t++) c->parent[t] = (uint32_t)t;
    BVXI_TRY(bvxi_for_pieces(c->ctx, "check", 0.4, 0.7, c->ranges, c->vertex_count, check_range_of_edges, c));

    r->components = c->edges_alone ? 0 : c->triangle_count;
    r->oriented = 1;
    for (int32_t i = 0; i < c->ranges; i++) {
        const topology_counts *const counts = &c->counts[i];
        r->edges += counts->edges;
        r->boundary_edges += counts->boundary;
        r->flipped_edges += counts->flipped;
        r->nonmanifold_edges += counts->nonmanifold;
        r->duplicates += counts->duplicates;
        r->components -= counts->joined;
        if (counts->against) r->oriented = 0;
    }
    return BVX_OK;
}

/* The pairs that waited, of two ranges each. */
static void join_ranges(topology *c)
{
    for (int32_t i = 0; i < c->ranges; i++) {
        uint64_t from, to;
        bvxi_piece(c->vertex_count, c->ranges, i, &from, &to);
        const uint64_t *pair = c->entries + first_entry(c, from);
        for (uint64_t n = 0; n < c->counts[i].waiting; n++)
            c->result->components -= (uint64_t)bvxi_join(c->parent, (uint32_t)(pair[n] >> 32),
                                                         (uint32_t)pair[n]);
    }
}

/* ---- vertices ---- */

/* Walk round vertex v away over half-edge h (one of the two at v in its
 * triangle), counting corners, and marking them where walked is not NULL, until the fan ends or comes back to
 * the corner from. Edges at v have at most two triangles. Returns 1 when it came back. */
static int walk_fan(const topology *c, uint32_t v, uint32_t h, uint32_t from, uint64_t *corners)
{
    for (;;) {
        uint32_t const over = c->ring[h];
        uint32_t corner;
        if (over == h) return 0;
        if (c->corners[over] == v) { /* the neighbour leaves v over this edge: its other edge at v comes in */
            corner = over;
            h = half_edge_before(over);
        } else {
            corner = bvxi_corner_after(over);
            h = corner;
        }
        if (corner == from) return 1;
        (*corners)++;
        if (c->walked != NULL) topology_bit_set(c->walked, corner);
    }
}

/* The fan that holds the corner; with a border both ways from its middle. Returns its corners. */
static uint64_t walk_whole_fan(const topology *c, uint32_t corner)
{
    uint32_t const v = c->corners[corner];
    uint64_t corners = 1;
    if (!walk_fan(c, v, corner, corner, &corners)) walk_fan(c, v, half_edge_before(corner), corner, &corners);
    return corners;
}

/* One fan of each vertex, where edges have at most two triangles. These have all corners of the mesh only if
 * no vertex has a second one. corner_of becomes how many it has. */
static void walk_range_of_fans(void *user, int32_t range)
{
    topology *const c = user;
    topology_counts *const counts = &c->counts[range];
    uint64_t from, to;

    /* One more task than there are ranges: beside the fans, what waited for all edges. */
    if (range == c->ranges) {
        join_ranges(c);
        return;
    }
    bvxi_piece(c->vertex_count, c->ranges, range, &from, &to);
    for (uint64_t v = from; v < to; v++) {
        if (c->corner_of[v] == TOPOLOGY_NONE) continue;
        c->corner_of[v] = (uint32_t)walk_whole_fan(c, c->corner_of[v]);
        counts->vertices++;
        counts->corners += c->corner_of[v];
    }
}

/* Where edges have more triangles. A vertex of several broken edges or fans counts once. */
static bvx_status search_broken_fans(topology *c)
{
    bvx_certificate *const r = c->result;
    uint64_t const half_edges = 3 * c->triangle_count;
    uint64_t const vertex_bits = topology_bit_words(c->vertex_count) * 8;

    BVXI_TRY(bvxi_alloc_zero(c->ctx, BVXI_SCRATCH, vertex_bits, "the check's marks", &c->broken));
    BVXI_TRY(bvxi_alloc_zero(c->ctx, BVXI_SCRATCH, vertex_bits, "the check's marks", &c->seen));
    BVXI_TRY(BVXI_ZEROS(c->ctx, topology_bit_words(half_edges), "the check's marks", c->walked));

    /* Both ends of edges with three or more triangles, whose rings take more than two steps. */
    for (uint64_t h = 0; h < 3 * c->triangle_count; h++) {
        if (c->ring[c->ring[h]] == h) continue;
        topology_bit_set(c->broken, c->corners[h]);
        topology_bit_set(c->broken, c->corners[bvxi_corner_after((uint32_t)h)]);
    }

    for (uint64_t h = 0; h < half_edges; h++) {
        uint32_t const v = c->corners[h];
        if (h % TOPOLOGY_ASKS == 0)
            BVXI_TRY(bvxi_progress(c->ctx, "check", 0.8 + 0.2 * (double)h / (double)half_edges));
        if (topology_bit_is_set(c->broken, v)) { /* known already, or counted now */
            if (!topology_bit_is_set(c->seen, v)) {
                topology_bit_set(c->seen, v);
                r->nonmanifold_vertices++;
            }
            continue;
        }
        if (topology_bit_is_set(c->walked, h)) continue;
        if (topology_bit_is_set(c->seen, v)) { /* a second fan */
            topology_bit_set(c->broken, v);
            r->nonmanifold_vertices++;
            continue;
        }
        topology_bit_set(c->seen, v);
        topology_bit_set(c->walked, h);
        walk_whole_fan(c, (uint32_t)h);
    }
    return BVX_OK;
}

static bvx_status check_vertices(topology *c)
{
    bvx_certificate *const r = c->result;
    uint64_t corners = 0;

    /* Round edges of three triangles a walk need not end: then all that is known is who has triangles. */
    if (r->nonmanifold_edges != 0) {
        join_ranges(c);
        for (uint64_t v = 0; v < c->vertex_count; v++) r->vertices += c->corner_of[v] != TOPOLOGY_NONE;
        return BVXI_SCOPE(c->ctx, search_broken_fans(c));
    }
    BVXI_TRY(bvxi_each(c->ctx, "check", 0.7, 0.8, c->ranges + 1, walk_range_of_fans, c));
    for (int32_t i = 0; i < c->ranges; i++) {
        r->vertices += c->counts[i].vertices;
        corners += c->counts[i].corners;
    }

    if (corners != 3 * c->triangle_count) {
        /* Vertices with more corners than their first fan has; the buckets are needed no more. */
        uint32_t *const around = c->bucket_end;
        memset(around, 0, (size_t)c->vertex_count * 4);
        for (uint64_t h = 0; h < 3 * c->triangle_count; h++) around[c->corners[h]]++;
        for (uint64_t v = 0; v < c->vertex_count; v++)
            c->result->nonmanifold_vertices += around[v] != 0 && around[v] != c->corner_of[v];
    }
    return BVX_OK;
}

/* ---- the whole ---- */

bvx_status bvxi_topology(bvx_context *ctx, const uint32_t *corners, uint64_t triangle_count,
                         uint64_t vertex_count, int edges_alone, bvx_certificate *certificate)
{
    uint64_t const mark = bvxi_scratch_begin(ctx);
    topology c = {.ctx = ctx,
                  .corners = corners,
                  .triangle_count = triangle_count,
                  .vertex_count = vertex_count,
                  .result = certificate,
                  .edges_alone = edges_alone};

    uint64_t const half_edges = 3 * c.triangle_count;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, c.vertex_count * 4, "the check's buckets", &c.bucket_end));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, c.vertex_count * 4, "the check's corners", &c.corner_of));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, half_edges * 4, "the check's edge rings", &c.ring));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, c.triangle_count * 4, "the check's components", &c.parent));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, half_edges * 8, "the check's half-edges", &c.entries));
    /* Edges first: what they break decides which vertices have fans at all. */
    bucket_ranges ranges = {&c, bvxi_piece_count(c.vertex_count, TOPOLOGY_GRAIN)};
    if (ranges.count > bvxi_threads(c.ctx)) ranges.count = bvxi_threads(c.ctx);
    if (ranges.count > BUCKET_RANGES) ranges.count = BUCKET_RANGES;
    bvxi_tasks(c.ctx, ranges.count, count_buckets, &ranges);
    /* ends as they are before anything is filled in: the starts */
    bvxi_place_counts32(c.bucket_end, c.vertex_count);
    bvxi_tasks(c.ctx, ranges.count, fill_buckets, &ranges);
    BVXI_TRY(check_edges(&c));
    if (!edges_alone) BVXI_TRY(check_vertices(&c));
    if (!edges_alone) {
        bvx_certificate *const r = c.result;
        r->unused_vertices = c.vertex_count - r->vertices;
        r->closed = r->boundary_edges == 0;
        r->edge_manifold = r->nonmanifold_edges == 0;
        r->vertex_manifold = r->nonmanifold_vertices == 0;
        r->euler = (int64_t)r->vertices - (int64_t)r->edges + (int64_t)c.triangle_count;
    }
    return bvxi_scratch_end(ctx, mark, BVX_OK);
}
