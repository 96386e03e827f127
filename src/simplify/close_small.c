/* close_small.c - small handles are cut and small holes filled, so that a level needs fewer triangles.
 *
 * Source: Guskov, Wood. Topological Noise Removal. 2001 (a surface is cut along a short loop that does not separate it,
 * and both sides are closed).
 *
 * Collapses keep handles and holes, so three edges that are no triangle remain around each handle, and three border
 * edges around each hole. A loop that does not separate the surface is cut: its three vertices become one on either
 * side, and edges collapse on from there. What such a loop separates, a knob with handles of its own or none, becomes
 * a triangle where that lies near the planes of its vertices. A hole becomes a triangle.
 *
 * Guarantee: what is closed, manifold and oriented stays so; no triangles cross that did not before; no part goes,
 * and none becomes two. */
#include "core/vec3.h"
#include "mesh/cross.h"
#include "mesh/mesh.h"
#include "simplify/edge_costs.h"

enum {
    LOOP_REACH = 1 << 16 /* triangles within which both sides of a loop meet or one ends, or it is kept */
};

/* Three edges by their vertices; ghost: a triangle of the hole that they are around, or -1. */
typedef struct small_loop {
    uint32_t v[3];
    int32_t ghost;
} small_loop;

typedef struct loop_work {
    bvxi_collapse *c;
    double longest;   /* that loops may be */
    small_loop *loop; /* or NULL while they are counted */
    uint64_t *length; /* of each: the bits of a double */
    uint32_t *index;
    uint64_t count;
    uint32_t *mark, *mark_triangle, marks;
    uint32_t *queue, queued; /* triangles of both sides of a loop */
    uint32_t open[2];        /* of each side: those that were not passed yet */
    uint64_t slot;           /* no triangle before it is gone */
    uint64_t done;
    bvxi_closed closed;
} loop_work;

/* What lies to the left of a directed loop. */
typedef struct loop_side {
    uint32_t loop[3];
    int32_t corner[3];  /* at each vertex, of the triangle that has the edge to the next one */
    collapse_star star; /* the triangles with one vertex of the loop */
    uint32_t row;       /* of the first vertex, which stays */
    double p[3];
} loop_side;

/* ---- Finding loops ---- */

static void add_small_loop(loop_work *w, uint32_t a, uint32_t b, uint32_t c, int32_t ghost)
{
    const bvxi_corner_vertex *const at = w->c->mesh.at;
    double const length = sqrt(bvxi_vec_distance2(at[a].p, at[b].p)) +
                          sqrt(bvxi_vec_distance2(at[b].p, at[c].p)) +
                          sqrt(bvxi_vec_distance2(at[c].p, at[a].p));

    if (!(length <= w->longest)) return;
    if (w->loop != NULL) {
        w->loop[w->count] = (small_loop){{a, b, c}, ghost};
        memcpy(&w->length[w->count], &length, sizeof length);
    }
    w->count++;
}

/* Vertices on seams, borders and locked ones have no loops. */
static int may_loop(const bvxi_collapse *c, uint32_t v)
{
    return v != BVXI_VERTEX_GHOST && c->kind[v] == 0;
}

/* Loops through v and two later vertices: common neighbours of both ends of an edge beside its triangles. */
static void find_around(loop_work *w, uint32_t v)
{
    const bvxi_collapse *const c = w->c;
    const bvxi_corners *const m = &c->mesh;
    int32_t at = c->any[v];

    w->marks++;
    do {
        uint32_t const a = bvxi_corner_vertex_of(m, bvxi_corner_next(at));

        if (may_loop(c, a)) w->mark[a] = w->marks;
        at = bvxi_corner_turn_left(m, at);
    } while (at != c->any[v]);
    do {
        uint32_t const a = bvxi_corner_vertex_of(m, bvxi_corner_next(at));
        int32_t const apex = bvxi_corner_previous(at);
        int32_t other = a > v && may_loop(c, a) ? c->any[a] : -1;

        while (other >= 0) {
            uint32_t const b = bvxi_corner_vertex_of(m, bvxi_corner_next(other));

            if (b > a && b != BVXI_VERTEX_GHOST && w->mark[b] == w->marks &&
                b != bvxi_corner_vertex_of(m, apex) &&
                b != bvxi_corner_vertex_of(m, bvxi_corner_opposite(m, apex)))
                add_small_loop(w, v, a, b, -1);
            other = bvxi_corner_turn_left(m, other);
            if (other == c->any[a]) break;
        }
        at = bvxi_corner_turn_left(m, at);
    } while (at != c->any[v]);
}

/* The triangle of a hole before another one. */
static int32_t ghost_before(const bvxi_corners *m, int32_t ghost)
{
    return bvxi_corner_opposite(m, ghost + 2) & ~3;
}

static void find_loops(loop_work *w)
{
    const bvxi_corners *const m = &w->c->mesh;
    w->count = 0;
    for (uint32_t v = 0; v < m->vertices; v++)
        if (!bvxi_collapse_is_gone(w->c, v) && may_loop(w->c, v)) find_around(w, v);

    for (int32_t g = (int32_t)m->triangles; g < (int32_t)(m->triangles + m->ghosts); g++)
        if (!bvxi_corner_gone(m, 4 * g)) {
            /* A hole of three edges that no other line meets. */
            int32_t const ghost = 4 * g;
            const uint8_t *const kind = w->c->kind;
            const uint32_t *const v = m->triangle[ghost >> 2].vertex;
            int32_t const before = ghost_before(m, ghost), last = ghost_before(m, before);
            uint32_t const b = m->triangle[before >> 2].vertex[1];
            if (before > ghost && last > ghost && ghost_before(m, last) == ghost &&
                kind[v[1]] == VERTEX_LINE && kind[v[2]] == VERTEX_LINE && kind[b] == VERTEX_LINE)
                add_small_loop(w, v[1], v[2], b, ghost);
        }
}

/* ---- Changes ---- */

/* Triangles are gone, or back. */
static void toggle(bvxi_corners *m, uint32_t t)
{
    m->triangle[t].vertex[1] = ~m->triangle[t].vertex[1];
}

static void drop_vertex(bvxi_collapse *c, uint32_t v, uint32_t stayed)
{
    c->least[v] = COLLAPSE_NEVER;
    c->edge[v] = COLLAPSE_GONE;
    c->undo[v].stayed = stayed;
    c->undo[v].order = c->order;
    c->alive--;
}

/* 1: the triangle has an area and crosses none. */
static int may_put(const bvxi_collapse *c, const uint32_t v[3])
{
    const bvxi_corner_vertex *const at = c->mesh.at;
    const double *const p[3] = {at[v[0]].p, at[v[1]].p, at[v[2]].p};
    return bvxi_has_area(p) &&
           !bvxi_crossing_tree_visit(&c->tree, p, BVXI_VERTEX_NONE, BVXI_VERTEX_NONE, NULL, NULL, NULL, NULL);
}

/* Make one that is gone a triangle of v; beside: the corner across the edge from each to the next. */
static void put_triangle(bvxi_collapse *c, uint32_t t, const uint32_t v[3], const int32_t beside[3])
{
    for (int k = 0; k < 3; k++) {
        int32_t const corner = (int32_t)(4 * t) + k;

        c->mesh.triangle[t].vertex[k] = v[k];
        bvxi_corners_join(&c->mesh, (int32_t)(4 * t) + (k + 2) % 3, beside[k]);
        c->any[v[k]] = corner;
        c->fresh[v[k]] = 1;
        if (c->attributes.row != NULL)
            c->attributes.row[corner] = c->attributes.row[bvxi_corner_previous(beside[k])];
    }
    if (c->attributes.material != NULL) c->attributes.material[t] = c->attributes.material[beside[0] >> 2];
    bvxi_crossing_tree_move(&c->tree, t);
}

/* ---- Sides of a loop ---- */

/* 0: the loop is one no more. */
static int find_left(const bvxi_collapse *c, uint32_t a, uint32_t b, uint32_t last, loop_side *side)
{
    const bvxi_corners *const m = &c->mesh;
    uint32_t const v[3] = {a, b, last};

    memcpy(side->loop, v, sizeof v);
    for (int k = 0; k < 3; k++) {
        int32_t at = c->any[v[k]];

        if (bvxi_collapse_is_gone(c, v[k])) return 0;
        while (bvxi_corner_vertex_of(m, bvxi_corner_next(at)) != v[(k + 1) % 3])
            if ((at = bvxi_corner_turn_left(m, at)) == c->any[v[k]]) return 0;
        if (bvxi_corner_vertex_of(m, bvxi_corner_previous(at)) == v[(k + 2) % 3]) return 0;
        side->corner[k] = at;
    }
    return 1;
}

static int is_of(const uint32_t loop[3], uint32_t v)
{
    return (v == loop[0]) | (v == loop[1]) | (v == loop[2]);
}

/* 1: a way leads from one side of the loop to the other: both are followed by turns until they meet or one ends. */
static int sides_meet(loop_work *w, const loop_side side[2])
{
    const bvxi_corners *const m = &w->c->mesh;
    const uint32_t *const loop = side[0].loop;
    uint32_t *const mark = w->mark_triangle;

    w->marks += 2;
    for (uint32_t i = 0; i < 2; i++) {
        w->queue[i] = (uint32_t)side[i].corner[0] >> 2;
        mark[w->queue[i]] = w->marks - i;
        w->open[i] = 1;
    }
    w->queued = 2;
    for (uint32_t first = 0; w->open[0] != 0 && w->open[1] != 0 && w->queued < LOOP_REACH; first++) {
        const bvxi_corner_triangle *const t = &m->triangle[w->queue[first]];
        uint32_t const own = mark[w->queue[first]], other = 2 * w->marks - 1 - own;

        w->open[w->marks - own]--;
        for (int k = 0; k < 3; k++) {
            uint32_t const next = (uint32_t)t->left[(k + 2) % 3] >> 2;

            if (mark[next] == own ||
                (is_of(loop, t->vertex[(k + 1) % 3]) && is_of(loop, t->vertex[(k + 2) % 3])))
                continue;
            if (mark[next] == other) return 1;
            mark[next] = own;
            w->queue[w->queued++] = next;
            w->open[w->marks - own]++;
        }
    }
    return 0;
}

/* 1: a position is no further from the planes of a vertex than levels that crumple the most may lie. */
static int lies_near(const bvxi_collapse *c, uint32_t v, const double *p)
{
    const bvxi_corner_vertex *const at = &c->mesh.at[v];
    double d[3];
    for (int k = 0; k < 3; k++) d[k] = (p[k] - at->p[k]) * c->scale;
    return !bvxi_quadric_is_far(c, &at->q, d, c->mesh.left, CRUMPLED_MOST);
}

/* ---- Handles ---- */

static void toggle_side(bvxi_corners *m, const loop_side *side)
{
    for (int k = 0; k < 3; k++) toggle(m, (uint32_t)side->corner[k] >> 2);
    for (int32_t i = 0; i < side->star.count; i++) toggle(m, (uint32_t)side->star.corner[i] >> 2);
}

/* Put the vertex between the middles of the loop and of the side's link, or where one was given.
 * Returns 1 when no triangle turns over. */
static int place_side(const bvxi_collapse *c, loop_side *side)
{
    const bvxi_corner_vertex *const at = c->mesh.at;
    const collapse_star *const star = &side->star;
    const uint32_t *const v = side->loop;
    int const kept = c->options.given.vertices == BVX_VERTICES_KEPT;

    for (int k = 0; k < 3; k++) {
        double const middle = (at[v[0]].p[k] + at[v[1]].p[k] + at[v[2]].p[k]) / 3;
        double sum = 0;

        for (int32_t i = 0; i < star->count; i++) sum += at[star->link[i]].p[k] - middle;
        side->p[k] = kept ? at[v[0]].p[k] : bvxi_collapse_rounded(c, middle + 0.5 * sum / star->count);
    }
    for (int32_t i = 0; i < star->count; i++) {
        const double *const a = at[star->link[i]].p, *const b = at[star->link[i + 1]].p;
        double n[3], before[3];

        bvxi_area_normal(side->p, a, b, n);
        bvxi_area_normal(at[bvxi_corner_vertex_of(&c->mesh, star->corner[i])].p, a, b, before);
        if (!(bvxi_vec_dot(n, before) > 0)) return 0;
    }
    for (int k = 0; k < 3; k++)
        if (!lies_near(c, v[k], side->p)) return 0;
    return 1;
}

/* 1: triangles of a side cross others, or those of the second one. The triangles that they replace are hidden. */
static int side_crosses(const bvxi_collapse *c, const loop_side *side, const loop_side *second)
{
    const bvxi_corner_vertex *const at = c->mesh.at;
    const collapse_star *const s = &side->star, *const t = &second->star;
    int const third = c->came != NULL && c->came[side->loop[2]] != 0;

    if (bvxi_collapse_crosses(c, side->loop[third ? 2 : 0], side->loop[1], s->link, s->count, side->p))
        return 1;
    for (int32_t i = 0; i < s->count; i++)
        for (int32_t j = 0; j < t->count; j++) {
            const double *const p[3] = {side->p, at[s->link[i]].p, at[s->link[i + 1]].p};
            const double *const q[3] = {second->p, at[t->link[j]].p, at[t->link[j + 1]].p};

            if (bvxi_triangles_cross(p, q)) return 1;
        }
    return 0;
}

/* The three vertices become one on a side. */
static void close_side(bvxi_collapse *c, const loop_side *side)
{
    bvxi_corners *const m = &c->mesh;
    const collapse_star *const star = &side->star;
    uint32_t const v = side->loop[0];
    double way[3];

    for (int k = 0; k < 3; k++) {
        bvxi_collapse_drop_triangle(m, bvxi_corner_previous(side->corner[k]));
        way[k] = (side->p[k] - m->at[v].p[k]) * c->scale;
    }
    for (int32_t i = 0; i < star->count; i++) {
        m->triangle[star->corner[i] >> 2].vertex[star->corner[i] & 3] = v;
        c->any[star->link[i]] = bvxi_corner_next(star->corner[i]);
    }
    c->any[v] = star->corner[0];
    c->fresh[v] = 1;
    if (c->attributes.row != NULL) bvxi_attributes_move(c, side->row, way, star->corner, star->count);
    bvxi_collapse_move_quadric(c, v, side->p);
    for (int32_t i = 0; i < star->count; i++)
        bvxi_crossing_tree_move(&c->tree, (uint32_t)star->corner[i] >> 2);
}

static int cut_handle(loop_work *w, loop_side side[2])
{
    bvxi_collapse *const c = w->c;

    for (int i = 0; i < 2; i++) {
        collapse_star *const star = &side[i].star;

        /* Counter-clockwise around all three: from each to the one before it. */
        star->count = 0;
        for (int k = 2; k >= 0; k--)
            if (!bvxi_star_gather_side(&c->mesh, side[i].corner[k], side[i].loop[(k + 2) % 3],
                                       2 * COLLAPSE_STAR, star))
                return 0;
        if (!bvxi_star_close(star) || !place_side(c, &side[i])) return 0;
    }
    for (int i = 0; i < 2; i++) toggle_side(&c->mesh, &side[i]);
    int const crosses = side_crosses(c, &side[0], &side[1]) || side_crosses(c, &side[1], &side[0]);
    for (int i = 0; i < 2; i++) toggle_side(&c->mesh, &side[i]);
    if (crosses) return 0;

    for (int i = 0; i < 2; i++) {
        if (c->attributes.row != NULL) side[i].row = c->attributes.row[side[i].corner[0]];
        if (c->came != NULL) c->came[side[i].loop[0]] |= c->came[side[0].loop[2]];
    }
    for (int i = 0; i < 2; i++) close_side(c, &side[i]);
    drop_vertex(c, side[0].loop[2], side[0].loop[0]);
    c->mesh.left -= 6;
    w->closed.handles++;
    return 1;
}

/* ---- Knobs ---- */

/* The side that ended becomes a triangle. */
static int drop_knob(loop_work *w, const loop_side side[2])
{
    bvxi_collapse *const c = w->c;
    bvxi_corners *const m = &c->mesh;
    uint32_t const ended = w->open[0] == 0 ? 0 : 1, own = w->marks - ended;
    const loop_side *const s = &side[ended];
    uint32_t n = 0, within = 0;
    int32_t beside[3];

    for (uint32_t i = 0; i < w->queued; i++)
        if (w->mark_triangle[w->queue[i]] == own) w->queue[n++] = w->queue[i];
    w->marks++;
    for (uint32_t i = 0; i < 3 * n; i++) {
        uint32_t const v = m->triangle[w->queue[i / 3]].vertex[i % 3];

        if (!may_loop(c, v)) return 0;
        if (w->mark[v] == w->marks || is_of(s->loop, v)) continue;
        if (!lies_near(c, v, m->at[s->loop[0]].p)) return 0;
        w->mark[v] = w->marks;
        within++;
    }

    for (uint32_t i = 0; i < n; i++) toggle(m, w->queue[i]);
    int const put = may_put(c, s->loop);
    for (uint32_t i = 0; i < n; i++) toggle(m, w->queue[i]);
    if (!put) return 0;

    for (uint32_t i = 0; i < 3 * n; i++) {
        uint32_t const v = m->triangle[w->queue[i / 3]].vertex[i % 3];

        if (!is_of(s->loop, v) && !bvxi_collapse_is_gone(c, v)) drop_vertex(c, v, s->loop[0]);
    }
    for (uint32_t i = 0; i < n; i++) toggle(m, w->queue[i]);
    for (int k = 0; k < 3; k++) beside[k] = bvxi_corner_opposite(m, bvxi_corner_previous(s->corner[k]));
    put_triangle(c, w->queue[0], s->loop, beside);
    m->left -= n - 1;

    /* By Euler's formula: of n triangles with three border edges and so many vertices within. */
    w->closed.handles += ((n + 3) / 2 - within - 1) / 2;
    return 1;
}

static int cut_loop(loop_work *w, const uint32_t v[3])
{
    loop_side side[2];
    if (!find_left(w->c, v[0], v[1], v[2], &side[0]) || !find_left(w->c, v[1], v[0], v[2], &side[1]))
        return 0;
    if (sides_meet(w, side)) return cut_handle(w, side);
    return w->open[0] == 0 || w->open[1] == 0 ? drop_knob(w, side) : 0;
}

/* ---- Holes ---- */

static int fill_hole(loop_work *w, const small_loop *loop)
{
    bvxi_collapse *const c = w->c;
    bvxi_corners *const m = &c->mesh;
    int32_t const before = ghost_before(m, loop->ghost), last = ghost_before(m, before);
    int32_t const beside[3] = {bvxi_corner_opposite(m, loop->ghost), bvxi_corner_opposite(m, last),
                               bvxi_corner_opposite(m, before)};

    /* A triangle alone has no hole. */
    while (w->slot < m->triangles && !bvxi_corner_gone(m, (int32_t)(4 * w->slot))) w->slot++;
    if (w->slot == m->triangles || beside[0] >> 2 == beside[1] >> 2 || !may_put(c, loop->v)) return 0;
    toggle(m, (uint32_t)loop->ghost >> 2);
    toggle(m, (uint32_t)before >> 2);
    toggle(m, (uint32_t)last >> 2);
    put_triangle(c, (uint32_t)w->slot, loop->v, beside);
    for (int k = 0; k < 3; k++) c->kind[loop->v[k]] = 0;
    m->left++;
    w->closed.holes++;
    return 1;
}

/* ---- All ---- */

static bvx_status list_loops(loop_work *w)
{
    bvx_context *const ctx = w->c->ctx;
    const bvxi_corners *const m = &w->c->mesh;

    BVXI_TRY(
        BVXI_ZEROS(ctx, m->vertices + m->triangles + m->ghosts + LOOP_REACH + 3, "marks of loops", w->mark));
    w->mark_triangle = w->mark + m->vertices;
    w->queue = w->mark_triangle + m->triangles + m->ghosts;
    find_loops(w);
    if (w->count == 0) return BVX_OK;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w->count * sizeof *w->loop, "loops", &w->loop));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, w->count * 12, "the loops' lengths", &w->length));
    w->index = (uint32_t *)(void *)(w->length + w->count);
    find_loops(w);
    for (uint64_t i = 0; i < w->count; i++) w->index[i] = (uint32_t)i;
    return bvxi_radix_sort(ctx, w->length, w->index, w->count);
}

bvx_status bvxi_collapse_close_small(bvxi_collapse *c, double longest, uint64_t *done)
{
    loop_work w = {.c = c, .longest = longest, .closed = c->closed};

    BVXI_TRY(list_loops(&w));
    for (uint64_t i = 0; i < w.count; i++) {
        const small_loop *const loop = &w.loop[w.index[i]];
        uint64_t const before = w.closed.handles + w.closed.holes;
        double length;

        w.done += (uint64_t)(loop->ghost < 0 ? cut_loop(&w, loop->v) : fill_hole(&w, loop));
        memcpy(&length, &w.length[i], sizeof length);
        if (before != w.closed.handles + w.closed.holes && length > w.closed.longest)
            w.closed.longest = length;
    }
    *done = w.done;
    c->closed = w.closed;
    if (w.done != 0) {
        /* What was collapsed before has other triangles around it now: it can no more be undone. */
        memset(c->last, 0xff, (size_t)c->mesh.vertices * sizeof *c->last);
        memset(c->stale, 1, (size_t)c->mesh.vertices);
        c->order++;
        BVXI_TRY(bvxi_collapse_evaluate(c));
    }
    return BVX_OK;
}
