/* topology.c - closed, manifold, oriented, how many pieces: from vertex indices only.
 *
 * Half-edges are put into buckets by their lower vertex and sorted by their higher vertex there (a radix sort
 * whose first digit is the vertex), so the half-edges of an edge lie side by side. Each gets a link to the
 * next half-edge of its edge, in a ring. Along the rings: pieces by union-find over triangles, fans by
 * walking round vertices.
 * Guarantee: the counts are exact for any triangles, also for soups. Cost: O(triangles), the largest fan's
 * logarithm on top where fans are large.
 *
 * Numbers: half-edge h = 3 t + k runs from corner k to corner k + 1 of triangle t and stands for corner k
 * too. */
#include "mesh/topology.h"

enum { TOPOLOGY_ASKS = 1 << 20 }; /* vertices or corners between asking progress */
/* larger buckets are heap-sorted: a fan of a million triangles is harmless */
enum { TOPOLOGY_INSERTION_LIMIT = 32 };

typedef struct topology {
    bvx_context *ctx;
    const uint32_t *corners;
    uint64_t triangle_count, vertex_count;
    uint32_t *bucket_end; /* [Size: vertex_count] */
    /* half-edges in buckets: higher vertex << 32 | half-edge [Size: triangle_count * 3] */
    uint64_t *entries;
    uint32_t *ring;   /* next half-edge of the same edge [Size: triangle_count * 3] */
    uint32_t *parent; /* union-find over triangles [Size: triangle_count] */
    uint64_t *broken; /* bit v: no fan, as an edge at v has three triangles or v has two fans */
    uint64_t *seen;   /* bit v: a fan at v was walked, or v is known to be broken; v is counted */
    uint64_t *walked; /* bit h: the fan of this corner was walked */
    int edges_alone;  /* 1: no pieces, no fans */
    bvx_certificate *result;
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

static uint32_t half_edge_after(uint32_t h)
{
    return h % 3 == 2 ? h - 2 : h + 1;
}

static uint32_t half_edge_before(uint32_t h)
{
    return h % 3 == 0 ? h + 2 : h - 1;
}

/* ---- edges ---- */

static void entries_sift(uint64_t *e, size_t at, size_t n)
{
    uint64_t const value = e[at];

    /* A hole moves down the heap; the value is stored once, where it stops. */
    for (size_t child = 2 * at + 1; child < n; child = 2 * at + 1) {
        if (child + 1 < n && e[child + 1] > e[child]) child++;
        if (e[child] <= value) break;
        e[at] = e[child];
        at = child;
    }
    e[at] = value;
}

static void entries_sort(uint64_t *e, size_t n)
{
    /* Buckets hold some three edges as a rule, for which insertion is the fastest. */
    if (n <= TOPOLOGY_INSERTION_LIMIT) {
        for (size_t i = 1; i < n; i++) {
            uint64_t const value = e[i];
            size_t k = i;
            for (; k > 0 && e[k - 1] > value; k--) e[k] = e[k - 1];
            e[k] = value;
        }
        return;
    }
    for (size_t i = n / 2; i-- > 0;) entries_sift(e, i, n);
    for (size_t end = n - 1; end > 0; end--) {
        uint64_t const top = e[0];
        e[0] = e[end];
        e[end] = top;
        entries_sift(e, 0, end);
    }
}

/* Counting sort of the half-edges by their lower vertex. */
static void fill_edge_buckets(topology *c)
{
    uint64_t const half_edges = 3 * c->triangle_count;
    uint32_t sum = 0;
    const uint32_t *t = c->corners;

    /* Counted by the lower vertex first, so that every bucket has its place. */
    memset(c->bucket_end, 0, (size_t)c->vertex_count * sizeof *c->bucket_end);
    for (uint64_t h = 0; h < half_edges; h += 3, t += 3) {
        c->bucket_end[t[0] < t[1] ? t[0] : t[1]]++;
        c->bucket_end[t[1] < t[2] ? t[1] : t[2]]++;
        c->bucket_end[t[2] < t[0] ? t[2] : t[0]]++;
    }
    /* ends as they are before anything is filled in: the starts */
    for (uint64_t v = 0; v < c->vertex_count; v++) {
        uint32_t const n = c->bucket_end[v];
        c->bucket_end[v] = sum;
        sum += n;
    }
    t = c->corners;
    for (uint64_t h = 0; h < half_edges; h += 3, t += 3) {
        for (uint32_t k = 0; k < 3; k++) {
            uint32_t const a = t[k], b = t[k == 2 ? 0 : k + 1];
            uint32_t const lower = a < b ? a : b, higher = a < b ? b : a;
            c->entries[c->bucket_end[lower]++] = (uint64_t)higher << 32 | (h + k);
        }
    }
}

static uint32_t root_of_triangle(uint32_t *parent, uint32_t t)
{
    while (parent[t] != t) {
        parent[t] = parent[parent[t]];
        t = parent[t];
    }
    return t;
}

static void join_triangles(topology *c, uint32_t s, uint32_t t)
{
    uint32_t const a = root_of_triangle(c->parent, s), b = root_of_triangle(c->parent, t);
    if (a == b) return;
    c->parent[a < b ? b : a] = a < b ? a : b;
    c->result->components--;
}

/* Triangles of one edge whose three vertices an earlier one has too. Each triangle is looked at once: on the
 * edge of its two least vertices. The entries' lower halves are reordered. */
static uint64_t count_edge_duplicates(const topology *c, uint64_t *e, size_t n, uint32_t higher)
{
    uint64_t count = 0;
    size_t kept = 0;

    for (size_t i = 0; i < n; i++) {
        /* Each triangle has three edges; this test leaves one of them, that of its two least vertices. */
        uint32_t const opposite = c->corners[half_edge_before((uint32_t)e[i])];
        if (opposite > higher) e[kept++] = (uint64_t)opposite << 32 | (e[i] & UINT32_MAX);
    }
    if (kept < 2) return 0;
    entries_sort(e, kept);
    for (size_t i = 1; i < kept; i++) count += e[i] >> 32 == e[i - 1] >> 32;
    return count;
}

/* The n >= 1 half-edges of one edge, sorted. */
static void check_edge(topology *c, uint64_t *e, size_t n, uint32_t lower)
{
    bvx_certificate *const r = c->result;
    uint32_t const higher = (uint32_t)(e[0] >> 32), first = (uint32_t)e[0];
    uint64_t upwards = 0;

    r->edges++;
    if (n == 1) {
        c->ring[first] = first;
        r->boundary_edges++;
        return;
    }

    /* A ring over all half-edges of the edge: each links to the next, the last to the first. */
    for (size_t i = 0; i < n; i++) {
        uint32_t const h = (uint32_t)e[i];
        c->ring[h] = (uint32_t)e[i + 1 == n ? 0 : i + 1];
        upwards += c->corners[h] == lower;
        if (i > 0 && !c->edges_alone) join_triangles(c, first / 3, h / 3);
    }

    /* More than one half-edge in the same direction contradicts an orientation. */
    if (upwards > 1 || n - upwards > 1) r->oriented = 0;
    if (n == 2 && upwards != 1) r->flipped_edges++;
    if (n > 2) {
        r->nonmanifold_edges++;
        topology_bit_set(c->broken, lower);
        topology_bit_set(c->broken, higher);
    }
    r->duplicates += count_edge_duplicates(c, e, n, higher);
}

static bvx_status check_edges(topology *c)
{
    /* Every triangle is a component at first, and each join takes one away. */
    uint64_t begin = 0;

    for (uint64_t t = 0; t < c->triangle_count; t++) c->parent[t] = (uint32_t)t;
    c->result->components = c->edges_alone ? 0 : c->triangle_count;
    c->result->oriented = 1;
    for (uint64_t v = 0; v < c->vertex_count; v++) {
        uint64_t const end = c->bucket_end[v];
        if (v % TOPOLOGY_ASKS == 0)
            BVXI_TRY(bvxi_progress(c->ctx, "check", 0.4 + 0.4 * (double)v / (double)c->vertex_count));
        /* In a bucket the lower vertex is the same, so sorting brings each edge's half-edges together. */
        entries_sort(c->entries + begin, (size_t)(end - begin));
        while (begin < end) {
            uint64_t stop = begin + 1;
            while (stop < end && c->entries[stop] >> 32 == c->entries[begin] >> 32) stop++;
            check_edge(c, c->entries + begin, (size_t)(stop - begin), (uint32_t)v);
            begin = stop;
        }
    }
    return BVX_OK;
}

/* ---- vertices ---- */

/* Walk round vertex v away over half-edge h (one of the two at v in its
 * triangle), marking corners, until the fan ends or comes back to the corner
 * from. Edges at v have at most two triangles. Returns 1 when it came back. */
static int walk_fan(topology *c, uint32_t v, uint32_t h, uint32_t from)
{
    for (;;) {
        uint32_t const over = c->ring[h];
        uint32_t corner;
        /* The edge has one triangle only: the fan ends here. */
        if (over == h) return 0;
        if (c->corners[over] == v) { /* the neighbour leaves v over this edge: its other edge at v comes in */
            corner = over;
            h = half_edge_before(over);
        } else {
            corner = half_edge_after(over);
            h = corner;
        }
        if (corner == from) return 1;
        topology_bit_set(c->walked, corner);
    }
}

/* A vertex of three broken edges is counted once, as is one of several fans. */
static bvx_status check_vertices(topology *c)
{
    bvx_certificate *const r = c->result;
    uint64_t const half_edges = 3 * c->triangle_count;

    for (uint64_t h = 0; h < half_edges; h++) {
        uint32_t const v = c->corners[h];
        if (h % TOPOLOGY_ASKS == 0)
            BVXI_TRY(bvxi_progress(c->ctx, "check", 0.8 + 0.2 * (double)h / (double)half_edges));
        if (topology_bit_is_set(c->broken, v)) { /* known already, or counted now */
            if (!topology_bit_is_set(c->seen, v)) {
                topology_bit_set(c->seen, v);
                r->vertices++;
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
        r->vertices++;
        topology_bit_set(c->walked, h);

        /* A fan with a border is walked from its middle to both ends. */
        if (!walk_fan(c, v, (uint32_t)h, (uint32_t)h))
            walk_fan(c, v, half_edge_before((uint32_t)h), (uint32_t)h);
    }
    return BVX_OK;
}

/* ---- the whole ---- */

static bvx_status allocate_topology(bvx_context *ctx, topology *c)
{
    uint64_t const half_edges = 3 * c->triangle_count;
    uint64_t const vertex_bits = topology_bit_words(c->vertex_count) * 8;
    uint64_t const corner_bits = topology_bit_words(half_edges) * 8;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, c->vertex_count * 4, "the check's buckets", &c->bucket_end));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, half_edges * 4, "the check's edge rings", &c->ring));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, vertex_bits, "the check's marks", &c->broken));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, vertex_bits, "the check's marks", &c->seen));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, corner_bits, "the check's marks", &c->walked));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, c->triangle_count * 4, "the check's components", &c->parent));
    return bvxi_alloc(ctx, BVXI_SCRATCH, half_edges * 8, "the check's half-edges", &c->entries);
}

static void free_topology(bvx_context *ctx, topology *c)
{
    bvxi_drop(ctx, c->entries);
    bvxi_drop(ctx, c->parent);
    bvxi_drop(ctx, c->walked);
    bvxi_drop(ctx, c->seen);
    bvxi_drop(ctx, c->broken);
    bvxi_drop(ctx, c->ring);
    bvxi_drop(ctx, c->bucket_end);
}

static void conclude_topology(topology *c)
{
    bvx_certificate *const r = c->result;
    r->unused_vertices = c->vertex_count - r->vertices;
    r->closed = r->boundary_edges == 0;
    r->edge_manifold = r->nonmanifold_edges == 0;
    r->vertex_manifold = r->nonmanifold_vertices == 0;
    r->euler = (int64_t)r->vertices - (int64_t)r->edges + (int64_t)c->triangle_count;
}

bvx_status bvxi_topology(bvx_context *ctx, const uint32_t *corners, uint64_t triangle_count,
                         uint64_t vertex_count, int edges_alone, bvx_certificate *certificate)
{
    topology c;

    memset(&c, 0, sizeof c);
    c.ctx = ctx;
    c.corners = corners;
    c.triangle_count = triangle_count;
    c.vertex_count = vertex_count;
    c.result = certificate;
    c.edges_alone = edges_alone;
    BVXI_TRY(allocate_topology(ctx, &c));
    /* Edges first: what they break decides which vertices have fans at all. */
    fill_edge_buckets(&c);
    BVXI_TRY(check_edges(&c));
    if (!edges_alone) BVXI_TRY(check_vertices(&c));
    if (!edges_alone) conclude_topology(&c);
    free_topology(ctx, &c);
    return BVX_OK;
}
