/* collapse_mesh.c - a mesh made ready to be collapsed, run to a target, and given back. Source and method:
 * collapse.c.
 *
 * Vertices and triangles are put in an order of space first: neighbours lie near each other in memory, and
 * levels do not depend on the order in which the mesh comes. */
#include "bits/sort.h"
#include "core/vec3.h"
#include "mesh/mesh.h"
#include "mesh/view.h"
#include "simplify/collapse_state.h"

#include <math.h>

enum {
    COLLAPSE_CURVE_BITS = 21, /* of the order in space along each axis */
    COLLAPSE_BUCKET = 32,     /* triangles that are ordered by insertion */
    COLLAPSE_GRAIN = 4096,    /* vertices of a task */
    COLLAPSE_AHEAD = 16,      /* vertices or triangles */
    COLLAPSE_IDLE = 8,        /* sweeps without a collapse until all edges are looked at anew */
    COLLAPSE_JUDGED = 4,      /* crossings are looked for after so many triangles have become one, */
    COLLAPSE_MANY = 1 << 16,  /* and in closed meshes of so many, where few cross, after twice as many, as in
                                 levels that enclose, whose tests cost more */
    COLLAPSE_SETTLED = 2,     /* times, of levels that enclose */
};

/* Mean edges that a vertex may lie from the planes that it stands for: up to 0.1 in levels that look like their
 * source, 0.7 to 2.4 where parts that are thinner than the triangles are long crumple. */
#define CRUMPLED_LITTLE 0.1
#define CRUMPLED_STEP   1.6
#define CRUMPLED_ANY    1e6
#define EVEN_LITTLE     1e-3

/* Spans within which squares of normals of small triangles are numbers: beyond them every collapse would count
 * as one that turns or flattens something. */
#define COLLAPSE_NARROWEST 1e-30
#define COLLAPSE_WIDEST    1e31

/* The plane at a border edge weighs as much as that of a triangle whose doubled area is the edge's square. */
#define BORDER_WEIGHT 1.0

/* ---- The run to a target ---- */

/* Sweeps until the target is met or none makes a collapse. */
static bvx_status collapse_within(bvxi_collapse *c, uint64_t target, double from, double to)
{
    uint64_t const begun = c->mesh.left;
    uint64_t since = 0; /* collapses since all edges were looked at */
    int idle = 0;

    while (c->mesh.left > target) {
        uint64_t done;

        BVXI_TRY(
            bvxi_progress(c->ctx, "collapse",
                          from + (to - from) * (double)(begun - c->mesh.left) / (double)(begun - target)));
        BVXI_TRY(bvxi_collapse_sweep(c, target, idle, &done));
        since += done;
        idle = done == 0 ? idle + 1 : 0;
        if (idle < COLLAPSE_IDLE) continue;

        /* Refused edges may be safe now that others have gone. */
        if (since == 0) break;
        BVXI_TRY(bvxi_collapse_evaluate(c));
        since = 0;
        idle = 0;
    }
    return BVX_OK;
}

/* 1: vertices may lie further from their planes than in levels that look like their source. Of a closed mesh no fewer
 * triangles than its Euler characteristic and four vertices have are possible. A strong pull towards even triangles
 * would be measured as a distance, too. */
static int may_crumple(const bvxi_collapse *c, uint64_t target)
{
    return c->options.even <= EVEN_LITTLE &&
           (c->mesh.ghosts != 0 || target + 2 * c->alive >= c->mesh.left + 8);
}

/* From so many mean edges on little by little to the most. A shape that cannot have so few triangles is not crumpled
 * to come nearer: what was done is undone. */
static bvx_status collapse_crumpling(bvxi_collapse *c, uint64_t target, double first, double from, double to)
{
    float const reached = c->reached;
    uint32_t const order = c->order;

    for (c->crumpled = first;; c->crumpled *= CRUMPLED_STEP) {
        if (c->crumpled > CRUMPLED_MOST) c->crumpled = CRUMPLED_MOST;
        if (bvxi_any_marked(c->stale, c->mesh.vertices)) BVXI_TRY(bvxi_collapse_evaluate(c));
        BVXI_TRY(collapse_within(c, target, from, to));
        if (c->mesh.left <= target) return BVX_OK;
        if (c->crumpled == CRUMPLED_MOST) break;
    }
    /* Closed meshes have an even number of triangles. */
    if (c->mesh.left == target + target % 2) return BVX_OK;
    bvxi_collapse_undo_since(c, order);
    memset(c->stale, 1, (size_t)c->mesh.vertices);
    c->reached = reached;
    return bvxi_collapse_evaluate(c);
}

static bvx_status collapse_edges(bvxi_collapse *c, uint64_t target, int last, double from, double to)
{
    /* Strips between seams meet before they crumple: what looks like the source goes first there. */
    int const seams = c->attributes.row != NULL;
    if (last && !seams && may_crumple(c, target))
        BVXI_TRY(collapse_crumpling(c, target, CRUMPLED_MOST, from, to));
    c->crumpled = c->options.even <= EVEN_LITTLE ? CRUMPLED_LITTLE : CRUMPLED_ANY;
    BVXI_TRY(collapse_within(c, target, from, to));
    return last && seams && c->mesh.left > target && may_crumple(c, target)
               ? collapse_crumpling(c, target, CRUMPLED_LITTLE * CRUMPLED_STEP, to, to)
               : BVX_OK;
}

/* No edge comes apart after this: what crosses goes back, and has another try where the rest has moved. */
static bvx_status settle(bvxi_collapse *c, double at)
{
    uint64_t undone, escaped = 0;

    c->judged = !bvxi_any_marked(c->fresh, c->mesh.vertices);
    for (int left = c->options.enclosed != NULL ? COLLAPSE_SETTLED : 1; left > 0 && escaped == 0; left--) {
        memset(c->fresh, 0, (size_t)c->mesh.vertices);
        BVXI_TRY(bvxi_collapse_pack(c));
        BVXI_TRY(bvxi_collapse_settle(c));
        if (bvxi_any_marked(c->settled, c->mesh.vertices)) BVXI_TRY(bvxi_collapse_judge(c, at, at, &undone));
        bvxi_collapse_end_careful(c);

        if (c->options.enclosed != NULL) {
            /* All vertices that settled go back where one of the steps let a piece out. */
            BVXI_TRY(BVXI_SCOPE(c->ctx, bvxi_collapse_escaped(c, &escaped)));
            for (uint32_t v = 0; v < c->mesh.vertices && escaped != 0; v++)
                if (!bvxi_collapse_is_gone(c, v)) bvxi_collapse_move_quadric(c, v, c->undo[v].p);
        }
    }
    return BVX_OK;
}

/* Down to the target without crossings. What crosses is undone by name; other edges go in its place, looked at
 * one by one, unless all were refused before. */
static bvx_status collapse_judged(bvxi_collapse *c, uint64_t target, int last, double from, double to)
{
    double const middle = from + 0.8 * (to - from);
    uint64_t undone;

    memset(c->fresh, 0, (size_t)c->mesh.vertices);
    BVXI_TRY(bvxi_collapse_pack(c));
    uint32_t const order = c->order;
    BVXI_TRY(collapse_edges(c, target, last, from, middle));
    int const met = c->mesh.left <= target + target % 2;
    BVXI_TRY(bvxi_collapse_judge(c, middle, to, &undone));
    if (undone != 0 && met) BVXI_TRY(collapse_edges(c, target, last, to, to));

    if (c->options.given.topology != BVX_TOPOLOGY_KEEP) {
        /* Cut and fill what is small beside the triangles of a level, and go on to it without. In the last
         * one only where it is needed, so that no triangles are missing. */
        double const longest = 3 * sqrt(EDGE_SQUARE * c->area / (double)target) / c->scale;
        uint64_t closed = 1;
        while (closed != 0 && (!last || c->mesh.left > target)) {
            BVXI_TRY(BVXI_SCOPE(c->ctx, bvxi_collapse_close_small(c, longest, &closed)));
            if (closed != 0) BVXI_TRY(collapse_edges(c, target, last, to, to));
            if (!last) break;
        }
    }
    bvxi_collapse_end_careful(c);

    uint64_t escaped = 0;
    if (c->options.enclosed != NULL) BVXI_TRY(BVXI_SCOPE(c->ctx, bvxi_collapse_escaped(c, &escaped)));
    if (escaped != 0) {
        /* What let a piece out goes back, with all that came after order: the level is larger then. */
        memset(c->fresh, 0, (size_t)c->mesh.vertices);
        bvxi_collapse_undo_since(c, order);
        BVXI_TRY(bvxi_collapse_judge(c, to, to, &undone));
        bvxi_collapse_end_careful(c);
    }
    return last ? settle(c, to) : BVX_OK;
}

/* Where crossings are looked for next on the way to the last level. */
static uint64_t judged_next(const bvxi_collapse *c, uint64_t triangles, uint64_t last)
{
    int const seldom = c->options.enclosed != NULL || (triangles >= COLLAPSE_MANY && c->mesh.ghosts == 0);
    uint64_t const next = triangles / (seldom ? 2 * COLLAPSE_JUDGED : COLLAPSE_JUDGED);
    return next > (seldom ? 2 * last : last) ? next : last;
}

bvx_status bvxi_collapse_to(bvxi_collapse *c, uint64_t target, double from, double to)
{
    uint64_t const begun = c->mesh.left;
    /* What is small is closed before the target, so that other triangles need not make up for those that go. */
    uint64_t const near = c->options.given.topology != BVX_TOPOLOGY_KEEP ? target + target / 4 : target;
    uint64_t const last = near < begun ? near : begun;
    uint64_t next = judged_next(c, begun, last);

    /* Judged on the way, what crosses has little built on it. */
    while (next > target) {
        double const at = from + (to - from) * (double)(begun - c->mesh.left) / (double)(begun - target);
        double const end = from + (to - from) * (double)(begun - next) / (double)(begun - target);

        BVXI_TRY(collapse_judged(c, next, 0, at, end > at ? end : at));
        if (next == last || c->mesh.left > next) break;
        next = judged_next(c, next, last);
    }
    if (c->mesh.left <= target) return BVX_OK;
    return collapse_judged(
        c, target, 1, from + (to - from) * (double)(begun - c->mesh.left) / (double)(begun - target), to);
}

/* ---- The mesh in an order of space ---- */

typedef struct collapse_order {
    bvxi_collapse *c;
    const bvx_mesh_view *view;
    const uint32_t *packed; /* its indices where sheets have them, or NULL */
    uint64_t *key;          /* of vertices, then of triangles */
    uint32_t *index;
    /* of each vertex of the view: UINT32_MAX where no triangle uses it, else 0 until take_mesh writes its
     * number in the new order */
    uint32_t *rank;
    uint32_t *begin; /* of each vertex's triangles: where the next one goes [Size: vertices] */
    double low[3], scale;
    uint64_t used[BVXI_MOST_PIECES]; /* vertices of the view in each piece; then where their keys begin */
} collapse_order;

static void keys_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const collapse_order *const o = user;
    uint64_t n = o->used[piece];

    for (uint64_t v = begin; v < end; v++) {
        double p[3];
        uint64_t key = 0;

        /* Vertices that no triangle uses are left out. */
        if (o->rank[v] == UINT32_MAX) continue;
        bvxi_view_position(o->view, v, p);

        /* Bits of the three coordinates by turns: neighbours in the order are neighbours in space. */
        for (int a = 0; a < 3; a++) key |= bvxi_curve_spread((uint64_t)((p[a] - o->low[a]) * o->scale)) << a;
        o->key[n] = key;
        o->index[n++] = (uint32_t)v;
    }
}

/* Each vertex's triangles end where its next one would go, which is where those of the vertex before end. */
static void buckets_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const collapse_order *const o = user;
    (void)piece;
    for (uint64_t i = begin; i < end; i++) {
        uint64_t const from = i == 0 ? 0 : o->begin[i - 1];
        bvxi_corner_triangle *const t = o->c->mesh.triangle;

        if (o->begin[i] - from > COLLAPSE_BUCKET) continue;
        for (uint64_t k = from + 1; k < o->begin[i]; k++) {
            bvxi_corner_triangle const moving = t[k];
            uint64_t j = k;

            for (; j > from &&
                   (t[j - 1].vertex[1] > moving.vertex[1] ||
                    (t[j - 1].vertex[1] == moving.vertex[1] && t[j - 1].vertex[2] > moving.vertex[2]));
                 j--)
                t[j] = t[j - 1];
            t[j] = moving;
        }
    }
}

/* The corners of some triangles, and where these come from. */
static void ranks_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const collapse_order *const o = user;
    (void)piece;

    for (uint64_t t = begin; t < end; t++) {
        /* The corners in the new order of vertices, the least one first, which keeps the sense. */
        uint32_t v[5]; /* the first two again after the third */
        if (o->packed != NULL) memcpy(v, o->packed + 3 * t, 12);
        else bvxi_view_triangle(o->view, t, v);
        for (int k = 0; k < 3; k++) v[k] = o->rank[v[k]];
        memcpy(v + 3, v, 8);
        int const first = ((v[1] < v[0]) & (v[1] < v[2])) + 2 * ((v[2] < v[0]) & (v[2] <= v[1]));
        memcpy(o->c->origin + 3 * t, v + first, 12);

        o->index[t] = (uint32_t)(t << 2) | (uint32_t)first;
    }
}

/* Triangles whose first vertex is one from first on go side by side, each vertex's in their order. */
static void scatter_piece(void *user, int32_t piece, uint64_t first, uint64_t end)
{
    const collapse_order *const o = user;
    const uint32_t *const origin = o->c->origin;
    uint64_t const n = o->view->triangle_count, size = end - first;
    uint32_t sum = 0; /* triangles of the vertices before */

    (void)piece;
    memset(o->begin + first, 0, (size_t)size * sizeof *o->begin);
    for (uint64_t t = 0; t < n; t++) {
        sum += origin[3 * t] < first;
        if (origin[3 * t] - first < size) o->begin[origin[3 * t]]++;
    }
    for (uint64_t v = first; v < end; v++) {
        uint32_t const own = o->begin[v];

        o->begin[v] = sum;
        sum += own;
    }
    for (uint64_t t = 0; t < n; t++) {
        bvxi_corner_triangle *to;

        if (origin[3 * t] - first >= size) continue;
        to = &o->c->mesh.triangle[o->begin[origin[3 * t]]++];
        memcpy(to->vertex, origin + 3 * t, sizeof to->vertex);
        /* Where it comes from waits in a field that is not set yet. */
        to->left[0] = (int32_t)o->index[t];
    }
}

/* Triangles by their least vertex, which comes first, and the ones after it: the order depends on the mesh
 * alone. */
static bvx_status order_triangles(bvxi_collapse *c, collapse_order *o)
{
    uint64_t const n = o->view->triangle_count;
    uint64_t const vertices = c->mesh.vertices;

    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, vertices * 4, "the triangles' vertices", &o->begin));
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, n * 12, "the mesh's corners", &c->origin));
    bvxi_ranges(c->ctx, bvxi_piece_count(n, COLLAPSE_GRAIN), n, ranks_piece, o);
    bvxi_ranges(c->ctx, bvxi_looking_pieces(c->ctx), vertices, scatter_piece, o);
    bvxi_ranges(c->ctx, bvxi_piece_count(vertices, COLLAPSE_GRAIN), vertices, buckets_piece, o);
    for (uint64_t i = 0; i < vertices; i++) {
        uint64_t const from = i == 0 ? 0 : o->begin[i - 1];

        if (o->begin[i] - from > COLLAPSE_BUCKET) {
            /* Triangles that begin with one vertex by the one after it, where a vertex has very many. */
            bvxi_corner_triangle *const t = o->c->mesh.triangle;

            for (uint64_t j = from; j < o->begin[i]; j++) {
                o->key[j - from] = (uint64_t)t[j].vertex[1] << 32 | t[j].vertex[2];
                o->index[j - from] = (uint32_t)t[j].left[0];
            }
            BVXI_TRY(bvxi_radix_sort(o->c->ctx, o->key, o->index, o->begin[i] - from));
            for (uint64_t j = from; j < o->begin[i]; j++) {
                t[j].vertex[1] = (uint32_t)(o->key[j - from] >> 32);
                t[j].vertex[2] = (uint32_t)o->key[j - from];
                t[j].left[0] = (int32_t)o->index[j - from];
            }
        }
    }
    bvxi_drop(c->ctx, o->begin);
    if (!bvxi_collapse_needs_sources(c->given, &c->options)) return BVX_OK;
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, n * 4, "the triangles' sources", &c->from));
    for (uint64_t t = 0; t < n; t++) c->from[t] = (uint32_t)c->mesh.triangle[t].left[0];
    return BVX_OK;
}

static void positions_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const collapse_order *const o = user;
    bvxi_corners *const m = &o->c->mesh;

    (void)piece;
    for (uint64_t i = begin; i < end; i++) {
        bvxi_corner_vertex at = {.q = {.c = 0}};

        if (i + COLLAPSE_AHEAD < end)
            BVXI_PREFETCH(bvxi_view_position_at(o->view, o->index[i + COLLAPSE_AHEAD]));
        bvxi_view_position(o->view, o->index[i], at.p);
        /* Rounded to the type of the result from the start, so that what is judged is what is given. */
        for (int a = 0; a < 3; a++) at.p[a] = bvxi_collapse_rounded(o->c, at.p[a]);
        m->at[i] = at;
        m->source[i] = o->index[i];
        o->rank[o->index[i]] = (uint32_t)i;
    }
}

/* The mesh in an order of space, and its positions as the result will have them. */
static bvx_status take_mesh(bvxi_collapse *c, collapse_order *o)
{
    uint64_t const used = c->mesh.vertices;

    bvxi_ranges(c->ctx, bvxi_looking_pieces(c->ctx), o->view->vertex_count, keys_piece, o);
    BVXI_TRY(bvxi_radix_sort(c->ctx, o->key, o->index, used));

    /* Vertices of one key by their positions: there are hardly any. */
    for (uint64_t i = 1; i < used; i++)
        for (uint64_t j = i; j > 0 && o->key[j] == o->key[j - 1]; j--) {
            double p[3], q[3];
            uint32_t const swap = o->index[j];

            bvxi_view_position(o->view, o->index[j], p);
            bvxi_view_position(o->view, o->index[j - 1], q);
            if (!(p[2] != q[2] ? p[2] < q[2] : p[1] != q[1] ? p[1] < q[1] : p[0] < q[0])) break;
            o->index[j] = o->index[j - 1];
            o->index[j - 1] = swap;
        }

    bvxi_ranges(c->ctx, bvxi_piece_count(used, COLLAPSE_GRAIN), used, positions_piece, o);
    return order_triangles(c, o);
}

/* Mark the vertices that triangles use by a rank of 0, and count them. */
static void used_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    collapse_order *const o = user;
    uint64_t used = 0;

    memset(o->rank + begin, 0xff, (size_t)(end - begin) * sizeof *o->rank);
    for (uint64_t t = 0; t < o->view->triangle_count; t++) {
        uint32_t v[3];

        bvxi_view_triangle(o->view, t, v);
        for (int k = 0; k < 3; k++) {
            if (v[k] - begin >= end - begin) continue;
            /* Counted once: after the first triangle the mark is 0. */
            used += o->rank[v[k]] != 0;
            o->rank[v[k]] = 0;
        }
    }
    o->used[piece] = used;
}

static bvx_status order_mesh(bvxi_collapse *c, const bvx_mesh_view *mesh, const double low[3], double size)
{
    uint64_t const items = mesh->vertex_count > mesh->triangle_count ? mesh->vertex_count
                                                                     : mesh->triangle_count;
    uint64_t const bytes = items * 12 + mesh->vertex_count * 4; /* a bucket may have all triangles */
    int32_t const pieces = bvxi_looking_pieces(c->ctx);
    collapse_order o = {.c = c,
                        .view = mesh,
                        .packed = c->sheets->corner,
                        .scale = size > 0 ? ((1 << COLLAPSE_CURVE_BITS) - 1) / size : 0};
    unsigned char *block;

    memcpy(o.low, low, sizeof o.low);
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, bytes, "the order of the triangles", &block));

    /* One block, the widest type first, so that each part is aligned. */
    o.key = (uint64_t *)(void *)block;
    o.index = (uint32_t *)(void *)(o.key + items);
    o.rank = o.index + items;

    bvxi_ranges(c->ctx, pieces, mesh->vertex_count, used_piece, &o);
    c->mesh.vertices = c->mesh.vertex_room = bvxi_place_counts(o.used, (uint64_t)pieces);
    BVXI_TRY(BVXI_ARRAY(c->ctx, c->mesh.vertex_room, "the vertices", c->mesh.at));
    BVXI_TRY(BVXI_ARRAY(c->ctx, c->mesh.vertex_room, "the vertices' sources", c->mesh.source));
    BVXI_TRY(take_mesh(c, &o));
    bvxi_drop(c->ctx, block);
    return BVX_OK;
}

/* ---- Quadrics ---- */

/* A plane through the vertex, n of unit length. Quadrics are stored about their own vertex (corners.h), so
 * only a grows: the plane's offset from there, and with it b and c, is 0. */
static void add_plane(bvxi_corner_vertex *at, const double n[3], double weight)
{
    int index = 0;
    /* The upper half of n n', row by row. */
    for (int i = 0; i < 3; i++)
        for (int j = i; j < 3; j++) at->q.a[index++] += weight * n[i] * n[j];
}

/* Each triangle's plane to those of its corners from begin to end, by area; b, 0 once lines are added, sums
 * the triangles' area normals. Its doubled area waits in a field that is not set yet. */
BVXI_VECTOR_INLINE void add_planes(bvxi_collapse *c, uint64_t begin, uint64_t end)
{
    const bvxi_corners *const m = &c->mesh;

    for (uint64_t t = 0; t < m->triangles; t++) {
        const uint32_t *const v = m->triangle[t].vertex;
        int const own[3] = {v[0] - begin < end - begin, v[1] - begin < end - begin,
                            v[2] - begin < end - begin};
        double n[3], a[6], length, inverse, weight;
        int index = 0;

        /* Memory that a later one needs is requested before its turn. */
        for (int k = 0; k < 3 && t + COLLAPSE_AHEAD < m->triangles; k++)
            BVXI_PREFETCH(m->at[m->triangle[t + COLLAPSE_AHEAD].vertex[k]].q.a);
        if (!(own[0] | own[1] | own[2])) continue;
        bvxi_area_normal(m->at[v[0]].p, m->at[v[1]].p, m->at[v[2]].p, n);
        length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);

        /* A triangle without an area has no plane. */
        if (!(length > 0)) length = 0;
        if (own[0]) memcpy(m->triangle[t].cost, &length, sizeof length);
        if (!(length > 0)) continue;

        inverse = 1 / length;
        weight = inverse * c->scale * c->scale;
        for (int i = 0; i < 3; i++)
            for (int k = i; k < 3; k++) a[index++] = n[i] * n[k] * weight;

        /* Weighed by area, so that cutting a triangle in two changes nothing. */
        for (int i = 0; i < 3; i++) {
            if (!own[i]) continue;
            for (int k = 0; k < 6; k++) m->at[v[i]].q.a[k] += a[k];
            for (int k = 0; k < 3; k++) m->at[v[i]].q.b[k] += n[k];
        }
    }
}

BVXI_AVX2_COPY(add_planes_avx2, (bvxi_collapse * c, uint64_t begin, uint64_t end), add_planes(c, begin, end))

/* The quadrics of some vertices, whose sums go in the order of triangles. */
static void quadrics_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    bvxi_collapse *const c = user;

    (void)piece;
    BVXI_PATH(c->fast, add_planes(c, begin, end), add_planes_avx2(c, begin, end));

    /* After it: the weight of lines is a share of that of planes. The squared distance to the line through
     * each vertex along its normal, b: to the vertex, less that along the normal. */
    for (uint64_t v = begin; v < end; v++) {
        bvxi_corner_vertex *const at = &c->mesh.at[v];
        double const length = bvxi_vec_length(at->q.b);
        double const weight = c->options.even * (at->q.a[0] + at->q.a[3] + at->q.a[5]);
        double n[3];
        int index = 0;

        /* Normals of a fold may cancel out: then there is no line. */
        for (int k = 0; k < 3; k++) {
            n[k] = at->q.b[k] / (length > 0 ? length : 1);
            at->q.b[k] = 0;
        }
        for (int i = 0; i < 3 && length > 0; i++)
            for (int j = i; j < 3; j++) at->q.a[index++] += weight * ((i == j) - n[i] * n[j]);
    }
}

/* A plane upright on a triangle along one of its edges, to both ends of it. */
static void add_upright(bvxi_collapse *c, int32_t corner)
{
    const bvxi_corners *const m = &c->mesh;
    uint32_t const u = bvxi_corner_vertex_of(m, bvxi_corner_next(corner));
    uint32_t const v = bvxi_corner_vertex_of(m, bvxi_corner_previous(corner));
    const double *const a = m->at[u].p, *const b = m->at[v].p;
    double const edge[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double const square = edge[0] * edge[0] + edge[1] * edge[1] + edge[2] * edge[2];
    double n[3], plane[3], length;

    bvxi_area_normal(m->at[bvxi_corner_vertex_of(m, corner)].p, a, b, n);
    for (int k = 0; k < 3; k++)
        plane[k] = edge[(k + 1) % 3] * n[(k + 2) % 3] - edge[(k + 2) % 3] * n[(k + 1) % 3];
    length = sqrt(plane[0] * plane[0] + plane[1] * plane[1] + plane[2] * plane[2]);

    /* Nor has an edge without a length, or beside a triangle without an area. */
    if (!(length > 0)) return;
    for (int k = 0; k < 3; k++) plane[k] /= length;
    add_plane(&m->at[u], plane, BORDER_WEIGHT * square * c->scale * c->scale);
    add_plane(&m->at[v], plane, BORDER_WEIGHT * square * c->scale * c->scale);
}

/* An edge of a line; count: it is the first of its two sides, so that its ends count it once. */
static void mark_line(bvxi_collapse *c, int32_t corner, int count)
{
    uint32_t const ends[2] = {bvxi_corner_vertex_of(&c->mesh, bvxi_corner_next(corner)),
                              bvxi_corner_vertex_of(&c->mesh, bvxi_corner_previous(corner))};
    add_upright(c, corner);
    for (int k = 0; k < 2 && count; k++)
        c->kind[ends[k]] = (uint8_t)(c->kind[ends[k]] + (c->kind[ends[k]] < 3));
}

/* Vertices on one line of borders and seams move along it, those where lines meet or end do not; and planes keep
 * lines where they are. */
static void mark_lines(bvxi_collapse *c)
{
    /* By the lines that end at a vertex, and of locked ones. */
    static const uint8_t kinds[5] = {0, VERTEX_JUNCTION, VERTEX_LINE, VERTEX_JUNCTION, VERTEX_LOCKED};
    const bvxi_corners *const m = &c->mesh;
    int const parted = c->attributes.row != NULL || c->attributes.material != NULL;
    int32_t const end = (int32_t)(4 * m->triangles);

    for (int32_t corner = 0; corner < end && parted; corner += (corner & 3) == 2 ? 2 : 1)
        if (!bvxi_corner_is_ghost(m, bvxi_corner_opposite(m, corner)) && bvxi_attributes_part(c, corner))
            mark_line(c, corner, corner < bvxi_corner_opposite(m, corner));
    /* Where a leaf with two sides ends, its planes alone would let the fold shrink. */
    for (int32_t corner = 0; corner < end && c->options.borders == BVXI_BORDERS_CUT;
         corner += (corner & 3) == 2 ? 2 : 1) {
        uint32_t const own = bvxi_corner_vertex_of(m, corner);
        uint32_t const other = bvxi_corner_vertex_of(m, bvxi_corner_opposite(m, corner));

        /* The triangle at the other side of the edge lies on this one. */
        if (own != BVXI_VERTEX_GHOST && other != BVXI_VERTEX_GHOST &&
            memcmp(m->at[own].p, m->at[other].p, sizeof m->at[own].p) == 0)
            add_upright(c, corner);
    }
    for (int32_t ghost = end; ghost < end + (int32_t)(4 * m->ghosts); ghost += 4) {
        mark_line(c, bvxi_corner_opposite(m, ghost), 1);
        for (int k = 1; k < 3 && c->options.given.lock_border; k++)
            c->kind[m->triangle[ghost >> 2].vertex[k]] = 4;
    }
    for (uint64_t v = 0; v < m->vertices; v++) c->kind[v] = kinds[c->kind[v]];

    for (int32_t corner = 0; corner < end && c->options.given.locked != NULL;
         corner += (corner & 3) == 2 ? 2 : 1)
        if (c->options.given.locked[bvxi_given_vertex(c, corner)] != 0)
            c->kind[bvxi_corner_vertex_of(m, corner)] = VERTEX_LOCKED;
}

/* ---- Opening, results ---- */

/* Corners as they are opened, costs that are not known yet, and the area of some triangles. */
typedef struct collapse_costs {
    bvxi_collapse *c;
    double area[BVXI_MOST_PIECES];
} collapse_costs;

static void costs_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    collapse_costs *const s = user;
    bvxi_collapse *const c = s->c;

    s->area[piece] = 0;
    for (uint64_t t = begin; t < end; t++) {
        bvxi_corner_triangle *const at = &c->mesh.triangle[t];
        double length = 0;

        if (t < c->mesh.triangles) {
            memcpy(c->origin + 3 * t, at->vertex, sizeof at->vertex);
            memcpy(&length, at->cost, sizeof length);
        }
        s->area[piece] += 0.5 * length * c->scale * c->scale;
        for (int k = 0; k < 3; k++) at->cost[k] = COLLAPSE_NEVER;
    }
}

static bvx_status open_arrays(bvxi_collapse *c)
{
    bvxi_corners *const m = &c->mesh;
    uint64_t const n = m->vertices, all = m->triangles + m->ghosts;
    int32_t const pieces = bvxi_piece_count(all, COLLAPSE_GRAIN);
    collapse_costs s = {.c = c};

    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, n * sizeof *c->undo, "what undoes collapses", &c->undo));
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, n * 16, "the vertices' edges", &c->least));
    BVXI_TRY(bvxi_alloc_zero(c->ctx, BVXI_SCRATCH, 4 * n, "the vertices' kinds", &c->kind));
    BVXI_TRY(BVXI_ARRAY(c->ctx, bvxi_collapse_cost_pieces(c) * COST_BUCKETS, "counts of costs", c->costs));
    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, n * 4, "the mesh's vertices", &c->first_source));
    c->first_triangles = m->triangles;
    c->first_vertices = n;
    memcpy(c->first_source, m->source, (size_t)n * 4);
    c->edge = (int32_t *)(void *)(c->least + n);
    c->any = c->edge + n;
    c->last = (uint32_t *)(void *)(c->any + n);
    c->settled = c->kind + n;
    c->fresh = c->settled + n;
    c->stale = c->fresh + n;

    memset(c->last, 0xff, (size_t)n * sizeof *c->last);
    memset(c->stale, 1, (size_t)n);
    bvxi_ranges(c->ctx, pieces, all, costs_piece, &s);
    for (int32_t i = 0; i < pieces; i++) c->area += s.area[i];
    bvxi_collapse_index(c);
    c->alive = n;
    c->crumpled = CRUMPLED_MOST;
    c->reached = COST_NOTHING;
    BVXI_TRY(bvxi_attributes_open(c));
    mark_lines(c);
    return bvxi_collapse_evaluate(c);
}

int bvxi_collapse_needs_sources(const bvx_mesh_view *mesh, const bvxi_collapse_options *options)
{
    return mesh->uvs != NULL || mesh->uvs2 != NULL || mesh->normals != NULL || mesh->colours != NULL ||
           mesh->materials != NULL || options->given.locked != NULL ||
           options->given.vertices == BVX_VERTICES_KEPT;
}

bvx_status bvxi_collapse_open(bvx_context *ctx, const char *function, const bvx_mesh_view *mesh,
                              const bvxi_sheets *sheets, const bvxi_collapse_options *options,
                              bvxi_collapse **collapse)
{
    bvxi_collapse *c;

    if (mesh->triangle_count > INT32_MAX / 4)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: %u triangles are too many; %u are possible", function, mesh->triangle_count,
                             (uint64_t)INT32_MAX / 4);
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, sizeof *c, "the collapse", &c));
    c->ctx = ctx;
    c->function = function;
    c->options = *options;
    c->given = mesh;
    c->view = &sheets->view;
    c->sheets = sheets;
    c->source = sheets->source;
    c->fast = bvxi_cpu(ctx) == BVX_CPU_AVX2;
    double low[3], high[3], size = 0;

    BVXI_TRY(bvxi_view_bounds(c->ctx, c->function, &sheets->view, low, high));
    for (int a = 0; a < 3; a++) {
        c->low[a] = low[a];
        if (high[a] - low[a] > size) size = high[a] - low[a];
    }

    if (size > 0 && !(size >= COLLAPSE_NARROWEST && size <= COLLAPSE_WIDEST))
        return bvxi_fail_for(c->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                             "%s: the mesh spans %g; edges collapse between spans of %g and %g: scale it",
                             c->function, size, COLLAPSE_NARROWEST, COLLAPSE_WIDEST);

    /* The longest side decides: steps are the same along all axes. */
    c->scale = size > 0 ? 1 / size : 1;

    c->mesh.triangle_room = c->mesh.triangles = sheets->view.triangle_count;
    BVXI_TRY(BVXI_ARRAY(c->ctx, c->mesh.triangle_room, "the triangles", c->mesh.triangle));

    /* Ordered before it is connected, so that neighbours are written close to each other. */
    BVXI_TRY(order_mesh(c, &sheets->view, low, size));
    BVXI_TRY(bvxi_progress(c->ctx, "collapse", 0.03));
    BVXI_TRY(bvxi_corners_connect(c->ctx, c->function, &c->mesh, c->options.borders));
    c->counts.split = c->mesh.split;
    BVXI_TRY(bvxi_progress(c->ctx, "collapse", 0.07));
    bvxi_ranges(c->ctx, bvxi_looking_pieces(c->ctx), c->mesh.vertices, quadrics_piece, c);
    BVXI_TRY(open_arrays(c));
    *collapse = c;
    return BVX_OK;
}
