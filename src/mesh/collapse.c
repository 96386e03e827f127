/* collapse.c - fewer triangles where the surface is flat, at equal count nearer to it.
 *
 * Source: Garland, Heckbert. Surface Simplification Using Quadric Error Metrics. 1997; corner table after Rossignac.
 * Edgebreaker. 1999; link condition after Dey et al. Topology preserving edge contraction. 1999.
 *
 * The cheapest edge goes first, equals by the number of their corner. An edge goes only when its ends share exactly two
 * neighbours, these keep three, and no triangle turns over or becomes a needle; so a closed manifold stays one, with the
 * same handles and components. Guarantee: sequential, doubles with + - x / sqrt alone: the same mesh everywhere. */
#include "mesh/collapse.h"
#include "mesh/quadric.h"
#include "mesh/radix.h"

#include <math.h>

enum { COLLAPSE_NONE = -1, EDGES_REPORT = 1024 };

/* Corner c belongs to triangle c / 3; the edge opposite to it runs between its two fellows. */
typedef struct collapse_work {
    double *position;
    uint32_t *vertex;      /* of each corner */
    int32_t *opposite;     /* the corner across the edge opposite to each */
    int32_t *star;         /* a corner of each vertex, COLLAPSE_NONE once it is gone */
    bvxi_quadric *quadric;
    double *cost;          /* of the edge opposite to each corner, where it stands for the edge */
    int32_t *heap, *place; /* corners by rising cost; place of each in the heap, or COLLAPSE_NONE */
    int32_t heap_count;
    uint64_t vertices, triangles, left;
    uint8_t *gone;         /* triangles */
} collapse_work;

static inline int32_t corner_next(int32_t c)
{
    return c % 3 == 2 ? c - 2 : c + 1;
}

static inline int32_t corner_previous(int32_t c)
{
    return c % 3 == 0 ? c + 2 : c - 1;
}

/* The next corner of the same vertex, one way round its star. */
static inline int32_t corner_swing(const collapse_work *w, int32_t c)
{
    return corner_next(w->opposite[corner_next(c)]);
}

/* The corner that stands for the edge opposite to c. */
static inline int32_t edge_of(const collapse_work *w, int32_t c)
{
    return c < w->opposite[c] ? c : w->opposite[c];
}

/* ---- heap ---- */

static inline int cheaper(const collapse_work *w, int32_t a, int32_t b)
{
    return w->cost[a] < w->cost[b] || (w->cost[a] == w->cost[b] && a < b);
}

static void heap_put(collapse_work *w, int32_t at, int32_t c)
{
    w->heap[at] = c;
    w->place[c] = at;
}

static void heap_settle(collapse_work *w, int32_t at)
{
    int32_t const c = w->heap[at];
    for (; at > 0 && cheaper(w, c, w->heap[(at - 1) / 2]); at = (at - 1) / 2) heap_put(w, at, w->heap[(at - 1) / 2]);
    for (int32_t child; (child = 2 * at + 1) < w->heap_count; at = child) {
        if (child + 1 < w->heap_count && cheaper(w, w->heap[child + 1], w->heap[child])) child++;
        if (!cheaper(w, w->heap[child], c)) break;
        heap_put(w, at, w->heap[child]);
    }
    heap_put(w, at, c);
}

static void heap_remove(collapse_work *w, int32_t c)
{
    int32_t const at = w->place[c];
    if (at == COLLAPSE_NONE) return;
    w->place[c] = COLLAPSE_NONE;
    w->heap_count--;
    if (at == w->heap_count) return;
    heap_put(w, at, w->heap[w->heap_count]);
    heap_settle(w, at);
}

static void heap_update(collapse_work *w, int32_t c, double cost)
{
    w->cost[c] = cost;
    if (w->place[c] == COLLAPSE_NONE) heap_put(w, w->heap_count++, c);
    heap_settle(w, w->place[c]);
}

/* ---- cost ---- */

/* Where an edge's ends would meet, and what it costs. */
static double cheapest_point(const collapse_work *w, uint32_t u, uint32_t v, double p[3])
{
    const double *const a = w->position + 3 * (size_t)u, *const b = w->position + 3 * (size_t)v;
    bvxi_quadric q = w->quadric[u];
    double length = 0, away = 0, best;
    bvxi_quadric_add(&q, &w->quadric[v]);
    for (int32_t i = 0; i < 3; i++) length += (b[i] - a[i]) * (b[i] - a[i]);
    if (bvxi_quadric_least(&q, p)) {
        for (int32_t i = 0; i < 3; i++) away += (p[i] - 0.5 * (a[i] + b[i])) * (p[i] - 0.5 * (a[i] + b[i]));
        if (away <= 4 * length) return bvxi_quadric_at(&q, p);
    }
    for (int32_t i = 0; i < 3; i++) p[i] = 0.5 * (a[i] + b[i]);
    best = bvxi_quadric_at(&q, p);
    for (int32_t end = 0; end < 2; end++) {
        double const value = bvxi_quadric_at(&q, end == 0 ? a : b);
        if (value < best) {
            best = value;
            memcpy(p, end == 0 ? a : b, 3 * sizeof *p);
        }
    }
    return best;
}

static double edge_cost(const collapse_work *w, int32_t c)
{
    double p[3];
    return cheapest_point(w, w->vertex[corner_next(c)], w->vertex[corner_previous(c)], p);
}

/* ---- may an edge go? ---- */

static void triangle_normal(const double *a, const double *b, const double *c, double n[3])
{
    double const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, v[3] = {c[0] - a[0], c[1] - a[1], c[2] - a[2]};
    n[0] = u[1] * v[2] - u[2] * v[1];
    n[1] = u[2] * v[0] - u[0] * v[2];
    n[2] = u[0] * v[1] - u[1] * v[0];
}

static double dot3(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static double squared_gap(const double *a, const double *b)
{
    return (a[0] - b[0]) * (a[0] - b[0]) + (a[1] - b[1]) * (a[1] - b[1]) + (a[2] - b[2]) * (a[2] - b[2]);
}

/* Triangles round corner `start` keep their side and some height when its vertex moves to p; those with vertex `other`
 * will be gone. */
static int star_survives(const collapse_work *w, int32_t start, uint32_t other, const double p[3])
{
    int32_t c = start;
    do {
        uint32_t const u = w->vertex[corner_next(c)], v = w->vertex[corner_previous(c)];
        if (u != other && v != other) {
            const double *const a = w->position + 3 * (size_t)w->vertex[c];
            const double *const b = w->position + 3 * (size_t)u, *const d = w->position + 3 * (size_t)v;
            double before[3], after[3], sides;
            triangle_normal(a, b, d, before);
            triangle_normal(p, b, d, after);
            sides = squared_gap(p, b) + squared_gap(b, d) + squared_gap(d, p);
            if (!(dot3(before, after) > 0.3 * sqrt(dot3(before, before) * dot3(after, after)))) return 0;
            if (!(dot3(after, after) > 1e-4 * sides * sides)) return 0;
        }
        c = corner_swing(w, c);
    } while (c != start);
    return 1;
}

static int32_t valence(const collapse_work *w, int32_t start)
{
    int32_t n = 0, c = start;
    do {
        n++;
        c = corner_swing(w, c);
    } while (c != start);
    return n;
}

/* The ends share exactly the two vertices opposite to their edge, and these keep three neighbours. */
static int link_allows(const collapse_work *w, int32_t c)
{
    int32_t const start = corner_next(c), far = corner_previous(c);
    int32_t shared = 0, u = start, v;
    do {
        uint32_t const neighbour = w->vertex[corner_next(u)];
        v = far;
        do {
            shared += w->vertex[corner_next(v)] == neighbour;
            v = corner_swing(w, v);
        } while (v != far);
        u = corner_swing(w, u);
    } while (u != start);
    return shared == 2 && valence(w, c) > 3 && valence(w, w->opposite[c]) > 3;
}

/* ---- collapse ---- */

static void join_corners(collapse_work *w, int32_t a, int32_t b)
{
    w->opposite[a] = b;
    w->opposite[b] = a;
}

/* Take a triangle out from between its two edges that become one; c is its corner opposite to the collapsing edge. */
static void close_triangle(collapse_work *w, int32_t c, uint32_t keep)
{
    int32_t const n = corner_next(c), p = corner_previous(c), a = w->opposite[n], b = w->opposite[p];
    heap_remove(w, edge_of(w, n));
    heap_remove(w, edge_of(w, p));
    join_corners(w, a, b);
    /* the vertex of c, and the kept end, stand now at corners of the triangle across */
    w->star[w->vertex[c]] = w->vertex[corner_next(a)] == w->vertex[c] ? corner_next(a) : corner_previous(a);
    w->star[keep] = w->vertex[corner_next(a)] == keep ? corner_next(a) : corner_previous(a);
    w->gone[c / 3] = 1;
    w->left--;
}

static void collapse_edge(collapse_work *w, int32_t c, const double p[3])
{
    int32_t const other = w->opposite[c];
    uint32_t const keep = w->vertex[corner_next(c)], lost = w->vertex[corner_previous(c)];
    int32_t s = corner_previous(c), start = s;
    heap_remove(w, edge_of(w, c));
    do { /* the lost vertex's corners become the kept one's */
        w->vertex[s] = keep;
        s = corner_swing(w, s);
    } while (s != start);
    memcpy(w->position + 3 * (size_t)keep, p, 3 * sizeof *p);
    bvxi_quadric_add(&w->quadric[keep], &w->quadric[lost]);
    w->star[lost] = COLLAPSE_NONE;
    close_triangle(w, c, keep);
    close_triangle(w, other, keep);
    s = start = w->star[keep];
    do { /* both edges of each triangle at the vertex: each edge comes up twice, once is enough */
        int32_t const e = edge_of(w, corner_next(s));
        heap_update(w, e, edge_cost(w, e));
        s = corner_swing(w, s);
    } while (s != start);
}

static bvx_status collapse_all(bvx_context *ctx, collapse_work *w, uint64_t target)
{
    for (uint64_t tried = 0; w->left > target && w->heap_count > 0; tried++) {
        int32_t const c = w->heap[0];
        uint32_t const u = w->vertex[corner_next(c)], v = w->vertex[corner_previous(c)];
        double p[3];
        if (tried % EDGES_REPORT == 0)
            BVXI_TRY(bvxi_progress(ctx, "collapse", (double)(w->triangles - w->left) / (double)(w->triangles - target)));
        cheapest_point(w, u, v, p);
        if (link_allows(w, c) && star_survives(w, corner_next(c), v, p) && star_survives(w, corner_previous(c), u, p))
            collapse_edge(w, c, p);
        else
            heap_remove(w, c); /* comes back when its surroundings change */
    }
    return BVX_OK;
}

/* ---- set up, pack ---- */

/* Corners that face each other across an edge: sort the edges by their ends, neighbours in order are the two sides. */
static bvx_status face_corners(bvx_context *ctx, collapse_work *w, uint64_t *keys, uint32_t *corner)
{
    uint64_t const n = 3 * w->triangles;
    for (uint64_t c = 0; c < n; c++) {
        uint64_t const u = w->vertex[corner_next((int32_t)c)], v = w->vertex[corner_previous((int32_t)c)];
        keys[c] = u < v ? u << 32 | v : v << 32 | u;
        corner[c] = (uint32_t)c;
    }
    BVXI_TRY(bvxi_radix_sort(ctx, keys, corner, n));
    for (uint64_t i = 0; i < n; i += 2) {
        if (i + 1 == n || keys[i] != keys[i + 1] || (i + 2 < n && keys[i] == keys[i + 2]))
            return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "collapse: the mesh is not closed and edge-manifold");
        join_corners(w, (int32_t)corner[i], (int32_t)corner[i + 1]);
    }
    return BVX_OK;
}

static void sum_quadrics(collapse_work *w)
{
    memset(w->quadric, 0, (size_t)w->vertices * sizeof *w->quadric);
    for (uint64_t t = 0; t < w->triangles; t++) {
        const uint32_t *const v = w->vertex + 3 * t;
        const double *const a = w->position + 3 * (size_t)v[0];
        double n[3], length;
        triangle_normal(a, w->position + 3 * (size_t)v[1], w->position + 3 * (size_t)v[2], n);
        length = sqrt(dot3(n, n));
        for (int32_t i = 0; i < 3; i++) w->star[v[i]] = (int32_t)(3 * t) + i;
        if (!(length > 0)) continue;
        for (int32_t i = 0; i < 3; i++) n[i] /= length;
        for (int32_t i = 0; i < 3; i++) bvxi_quadric_plane(&w->quadric[v[i]], n, -dot3(n, a), length);
    }
}

static void start_heap(collapse_work *w)
{
    int32_t const corners = (int32_t)(3 * w->triangles);
    w->heap_count = 0;
    for (int32_t c = 0; c < corners; c++) {
        w->place[c] = COLLAPSE_NONE;
        if (c != edge_of(w, c)) continue;
        w->cost[c] = edge_cost(w, c);
        heap_put(w, w->heap_count++, c);
    }
    for (int32_t at = w->heap_count / 2; at-- > 0;) heap_settle(w, at);
}

/* Close the gaps: vertices and triangles keep their order. star becomes the new numbers. */
static void pack_mesh(collapse_work *w, uint64_t *vertex_count, uint64_t *triangle_count)
{
    uint64_t vertices = 0, triangles = 0;
    for (uint64_t v = 0; v < w->vertices; v++) {
        if (w->star[v] == COLLAPSE_NONE) continue;
        memmove(w->position + 3 * vertices, w->position + 3 * v, 3 * sizeof *w->position);
        w->star[v] = (int32_t)vertices++;
    }
    for (uint64_t t = 0; t < w->triangles; t++) {
        if (w->gone[t]) continue;
        for (uint64_t i = 0; i < 3; i++) w->vertex[3 * triangles + i] = (uint32_t)w->star[w->vertex[3 * t + i]];
        triangles++;
    }
    *vertex_count = vertices;
    *triangle_count = triangles;
}

static uint64_t collapse_bytes(const collapse_work *w)
{
    uint64_t const corners = 3 * w->triangles;
    return corners * (sizeof(double) + 3 * sizeof(int32_t)) + w->vertices * (sizeof(bvxi_quadric) + sizeof(int32_t)) + w->triangles;
}

/* One block: doubles first, then 32-bit numbers, then bytes. */
static void lay_out(collapse_work *w, unsigned char *memory)
{
    uint64_t const corners = 3 * w->triangles;
    w->quadric = (bvxi_quadric *)(void *)memory;
    w->cost = (double *)(void *)(w->quadric + w->vertices);
    w->opposite = (int32_t *)(void *)(w->cost + corners);
    w->heap = w->opposite + corners;
    w->place = w->heap + corners;
    w->star = w->place + corners;
    w->gone = (uint8_t *)(void *)(w->star + w->vertices);
    memset(w->gone, 0, (size_t)w->triangles);
    for (uint64_t v = 0; v < w->vertices; v++) w->star[v] = COLLAPSE_NONE;
}

bvx_status bvxi_collapse_edges(bvx_context *ctx, double *positions, uint64_t *vertex_count, uint32_t *triangles,
                         uint64_t *triangle_count, uint64_t target)
{
    collapse_work w = {0};
    unsigned char *memory = NULL, *sorting = NULL;
    uint64_t const corners = 3 * *triangle_count;
    bvx_status status;
    if (*triangle_count <= target) return BVX_OK;
    if (corners > INT32_MAX)
        return bvxi_fail(ctx, BVX_ERR_RANGE, "collapse: %u triangles are too many, %u are possible", *triangle_count,
                         (uint64_t)INT32_MAX / 3);
    w.position = positions;
    w.vertex = triangles;
    w.vertices = *vertex_count;
    w.triangles = w.left = *triangle_count;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, collapse_bytes(&w), "the collapsing mesh", &memory));
    lay_out(&w, memory);
    status = bvxi_alloc(ctx, BVXI_SCRATCH, corners * 12, "the edges", &sorting);
    if (status == BVX_OK)
        status = face_corners(ctx, &w, (uint64_t *)(void *)sorting, (uint32_t *)(void *)(sorting + corners * 8));
    bvxi_free(ctx, sorting, corners * 12);
    if (status == BVX_OK) {
        sum_quadrics(&w);
        start_heap(&w);
        status = collapse_all(ctx, &w, target);
        if (status == BVX_OK) pack_mesh(&w, vertex_count, triangle_count);
    }
    bvxi_free(ctx, memory, collapse_bytes(&w));
    return status;
}
