/* undo_collapse.c - a collapse undone by name: the vertex that went is back.
 *
 * Source: Hoppe. Progressive Meshes. 1996 (a vertex split undoes a collapse).
 *
 * A triangle that went keeps its corners and neighbours, and a vertex what it was. What came later and touches the
 * same triangles is undone first; then all is as it was, but for the quadric of the vertex that stayed, which keeps
 * the planes of both. */
#include "simplify/edge_costs.h"

uint32_t bvxi_collapse_now(const bvxi_collapse *c, uint32_t v)
{
    if (c->now != NULL) v = c->now[v];
    while (bvxi_collapse_is_gone(c, v)) v = c->undo[v].stayed;
    return v;
}

/* The collapse made last of those that touch a vertex: the vertex that went in it. */
static uint32_t latest_around(const bvxi_collapse *c, uint32_t u)
{
    const bvxi_corners *const m = &c->mesh;
    uint32_t latest = c->last[u];
    int32_t at = c->any[u];

    do {
        uint32_t const w = bvxi_corner_vertex_of(m, bvxi_corner_next(at));
        uint32_t const went = w != BVXI_VERTEX_GHOST ? c->last[w] : BVXI_VERTEX_NONE;

        if (went != BVXI_VERTEX_NONE &&
            (latest == BVXI_VERTEX_NONE || c->undo[went].order > c->undo[latest].order))
            latest = went;
        at = bvxi_corner_turn_left(m, at);
    } while (at != c->any[u]);
    return latest;
}

/* A triangle that went is back between its neighbours. */
static void restore_triangle(bvxi_collapse *c, int32_t corner)
{
    bvxi_corners *const m = &c->mesh;
    bvxi_corner_triangle *const t = &m->triangle[corner >> 2];
    t->vertex[1] = ~t->vertex[1];
    for (int k = 0; k < 3; k++) {
        t->cost[k] = COLLAPSE_NEVER;
        bvxi_corner_put_left(m, bvxi_corner_next(t->left[k]), (corner & ~3) + (k + 2) % 3);
    }
    m->left += !bvxi_corner_is_ghost(m, corner);
}

void bvxi_collapse_move_quadric(bvxi_collapse *c, uint32_t u, const double p[3])
{
    bvxi_edge_planned const plan = {.u = u, .q = c->mesh.at[u].q};
    bvxi_edge_settle(c, &plan, p);
}

/* The costs of all edges around a vertex, and the cheapest of it and its neighbours. */
static void renew_vertex(bvxi_collapse *c, uint32_t v)
{
    const bvxi_corners *const m = &c->mesh;
    int32_t at = c->any[v];

    bvxi_edges_around(c, v, 0);
    do {
        uint32_t const w = bvxi_corner_vertex_of(m, bvxi_corner_next(at));

        if (w != BVXI_VERTEX_GHOST) bvxi_edge_find_least(c, w);
        at = bvxi_corner_turn_left(m, at);
    } while (at != c->any[v]);
    bvxi_edge_find_least(c, v);
}

uint32_t bvxi_collapse_undo(bvxi_collapse *c, uint32_t v)
{
    uint32_t next;

    /* What it went into may be gone itself: that came later. */
    while (bvxi_collapse_is_gone(c, c->undo[v].stayed)) v = c->undo[v].stayed;

    /* The last one of those that touch it; their order rises, so that this ends. */
    while ((next = latest_around(c, c->undo[v].stayed)) != v) v = next;

    bvxi_corners *const m = &c->mesh;
    collapse_undo *const undo = &c->undo[v];
    int32_t const edge = undo->edge, across = bvxi_corner_opposite(m, edge);
    uint32_t const u = undo->stayed;

    restore_triangle(c, edge);
    restore_triangle(c, across);
    for (int32_t at = bvxi_corner_turn_left(m, bvxi_corner_next(across)); at >> 2 != edge >> 2;
         at = bvxi_corner_turn_left(m, at))
        m->triangle[at >> 2].vertex[at & 3] = v;

    if (c->attributes.row != NULL) {
        double back[3];

        for (int k = 0; k < 3; k++) back[k] = (undo->p[k] - m->at[u].p[k]) * c->scale;
        bvxi_attributes_restore(c, edge, back);
    }
    if ((c->kind[v] & VERTEX_PINCHED) != 0) c->kind[u] = c->kind[v] = VERTEX_LINE;
    bvxi_collapse_move_quadric(c, u, undo->p);
    c->any[u] = bvxi_corner_next(edge);
    c->any[v] = bvxi_corner_previous(edge);
    c->last[u] = undo->before;
    c->edge[v] = -1;
    c->fresh[u] = c->fresh[v] = 1;
    c->alive++;
    renew_vertex(c, u);
    renew_vertex(c, v);
    return v;
}

void bvxi_collapse_undo_since(bvxi_collapse *c, uint32_t order)
{
    for (uint32_t v = 0; v < c->mesh.vertices; v++)
        while (bvxi_collapse_is_gone(c, v) && c->undo[v].order >= order) bvxi_collapse_undo(c, v);
}
