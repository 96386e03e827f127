/* collapse_support.h - a collapse opened by a test, and every invariant of it checked against plain loops. */
#ifndef COLLAPSE_SUPPORT_H
#define COLLAPSE_SUPPORT_H

#include "levels_support.h"

#include "mesh/cross.h"
#include "mesh/view.h"
#include "simplify/collapse_state.h"

static bvx_mesh_view opened_view;
static bvxi_sheets opened_sheets;
static bvxi_collapse *collapse;
static uint64_t opened_mark;

static inline bvxi_collapse_options collapse_options(void)
{
    bvxi_collapse_options o;

    memset(&o, 0, sizeof o);
    o.given.position_type = BVX_F64;
    o.even = 1e-9;
    o.given.attribute_weight = 1;
    o.borders = BVXI_BORDERS_KEPT;
    return o;
}

static inline void open_view(const bvx_mesh_view *view, const bvxi_collapse_options *o)
{
    bvxi_sheets_report unused;

    opened_mark = bvxi_scratch_begin(ctx);
    opened_view = *view;
    memset(&unused, 0, sizeof unused);
    memset(&opened_sheets, 0, sizeof opened_sheets);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(
        BVX_OK,
        bvxi_sheets_open(ctx, &opened_view, bvxi_collapse_needs_sources(view, o), &opened_sheets, &unused),
        where);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(
        BVX_OK, bvxi_collapse_open(ctx, "test", &opened_view, &opened_sheets, o, &collapse),
        bvx_last_message(ctx));
}

static inline void close_view(void)
{
    bvxi_scratch_end(ctx, opened_mark, BVX_OK);
    collapse = NULL;
}

/* ---- Invariants ---- */

static inline void require(int holds, const char *what)
{
    if (holds) return;
    snprintf(where + strlen(where), sizeof where - strlen(where), ": %s", what);
    TEST_FAIL_MESSAGE(where);
}

/* Neighbours are mutual, run along their edge in opposite directions, and none is gone. */
static inline void check_neighbours(const bvxi_corners *m)
{
    uint64_t left = 0;

    for (uint64_t t = 0; t < m->triangles + m->ghosts; t++) {
        const uint32_t *const v = m->triangle[t].vertex;

        if (bvxi_corner_gone(m, (int32_t)(4 * t))) continue;
        left += t < m->triangles;
        require(v[0] != v[1] && v[1] != v[2] && v[2] != v[0], "a triangle has a vertex twice");
        require((v[0] == BVXI_VERTEX_GHOST) == (t >= m->triangles), "a ghost without a ghost vertex");
        for (int32_t c = (int32_t)(4 * t); c < (int32_t)(4 * t) + 3; c++) {
            int32_t const o = bvxi_corner_opposite(m, c);

            require(o >= 0 && bvxi_corner_opposite(m, o) == c, "opposites are not mutual");
            require(!bvxi_corner_gone(m, o), "a neighbour is gone");
            require(bvxi_corner_vertex_of(m, bvxi_corner_next(c)) ==
                            bvxi_corner_vertex_of(m, bvxi_corner_previous(o)) &&
                        bvxi_corner_vertex_of(m, bvxi_corner_previous(c)) ==
                            bvxi_corner_vertex_of(m, bvxi_corner_next(o)),
                    "neighbours do not share their edge");
            require(bvxi_corner_turn_left(m, c) != c, "a vertex has one triangle");
        }
    }
    require(left == m->left, "the count of triangles is wrong");
}

/* All triangles of a vertex are one fan, which any of it reaches. */
static inline void check_fans(const bvxi_collapse *c)
{
    const bvxi_corners *const m = &c->mesh;
    uint32_t *const around = maker_grow(NULL, (size_t)m->vertices * 4);
    uint64_t alive = 0;

    memset(around, 0, (size_t)m->vertices * 4);
    for (uint64_t t = 0; t < m->triangles + m->ghosts; t++)
        for (int k = 0; k < 3 && !bvxi_corner_gone(m, (int32_t)(4 * t)); k++)
            if (m->triangle[t].vertex[k] != BVXI_VERTEX_GHOST) around[m->triangle[t].vertex[k]]++;
    for (uint32_t v = 0; v < m->vertices; v++) {
        int32_t at = c->any[v];
        uint32_t walked = 0;

        if (bvxi_collapse_is_gone(c, v)) {
            require(around[v] == 0, "a vertex is gone and has triangles");
            continue;
        }
        alive++;
        require(at >= 0 && !bvxi_corner_gone(m, at) && bvxi_corner_vertex_of(m, at) == v,
                "any is not the vertex's");
        do {
            walked++;
            at = bvxi_corner_turn_left(m, at);
        } while (at != c->any[v] && walked <= around[v]);
        require(walked == around[v], "a fan is not all of a vertex");
    }
    require(alive == c->alive, "the count of vertices is wrong");
    free(around);
}

/* Both sides of an edge have its cost, and each vertex its cheapest. */
static inline void check_costs(const bvxi_collapse *c)
{
    const bvxi_corners *const m = &c->mesh;

    for (uint32_t v = 0; v < m->vertices; v++) {
        int32_t at = c->any[v];
        float least = COLLAPSE_NEVER;
        int found = 0;

        if (bvxi_collapse_is_gone(c, v)) continue;
        do {
            int32_t const back = bvxi_corner_turn_left(m, bvxi_corner_next(at));
            float const cost = m->triangle[at >> 2].cost[at & 3];
            uint32_t const w = bvxi_corner_vertex_of(m, bvxi_corner_next(at));

            require(cost >= 0 && cost == m->triangle[back >> 2].cost[back & 3], "an edge has two costs");
            require(w != BVXI_VERTEX_GHOST || !(cost < COLLAPSE_NEVER), "an edge to the ghost has a cost");
            if (cost < least) least = cost;
            found |= at == c->edge[v] || back == c->edge[v];
            at = bvxi_corner_turn_left(m, at);
        } while (at != c->any[v]);
        require(least == c->least[v], "the least cost is not the least");
        require(found || (c->edge[v] == -1 && !(least < COLLAPSE_NEVER)),
                "the cheapest edge is not the vertex's");
        if (found)
            require(m->triangle[c->edge[v] >> 2].cost[c->edge[v] & 3] == least,
                    "the cheapest edge costs more");
    }
}

/* Costs that are kept are those found anew, but for edges that were refused, which cost more. */
static inline void check_costs_anew(bvxi_collapse *c)
{
    bvxi_corners *const m = &c->mesh;
    size_t const bytes = (size_t)(m->triangles + m->ghosts) * sizeof *m->triangle;
    bvxi_corner_triangle *const kept = maker_grow(NULL, bytes);
    float *const least = maker_grow(NULL, (size_t)m->vertices * 8);

    memcpy(kept, m->triangle, bytes);
    memcpy(least, c->least, (size_t)m->vertices * 8); /* and edges, which come after */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_collapse_evaluate(c));
    for (uint64_t t = 0; t < m->triangles; t++)
        for (int k = 0; k < 3 && !bvxi_corner_gone(m, (int32_t)(4 * t)); k++) {
            float const is = kept[t].cost[k], wanted = m->triangle[t].cost[k];

            require(is >= wanted * 0.999f - 1e-14f, "an edge costs less than it should");
        }
    memcpy(m->triangle, kept, bytes);
    memcpy(c->least, least, (size_t)m->vertices * 8);
    free(kept);
    free(least);
}

/* Vertices that went into others: a chain of each, the last first. */
static inline void check_undo(const bvxi_collapse *c)
{
    uint64_t gone = 0, listed = 0;

    for (uint32_t v = 0; v < c->mesh.vertices; v++) {
        uint32_t steps = 0, order = UINT32_MAX;

        gone += (uint64_t)bvxi_collapse_is_gone(c, v);
        for (uint32_t w = c->last[v]; w != BVXI_VERTEX_NONE; w = c->undo[w].before) {
            require(bvxi_collapse_is_gone(c, w) && c->undo[w].stayed == v, "a vertex went elsewhere");
            require(c->undo[w].order < order && ++steps <= c->mesh.vertices, "collapses are out of order");
            order = c->undo[w].order;
            listed++;
        }
    }
    require(gone == listed, "a vertex that is gone is in no list");
}

/* Rows are those of their vertex, and vertices without a kind lie on no line. */
static inline void check_rows(const bvxi_collapse *c)
{
    const bvxi_corners *const m = &c->mesh;
    const bvxi_attributes *const s = &c->attributes;

    for (int32_t t = 0; t < (int32_t)(m->triangles + m->ghosts) && s->row != NULL; t++)
        for (int32_t at = 4 * t; at < 4 * t + 3 && !bvxi_corner_gone(m, at); at++) {
            require((s->row[at] == BVXI_VERTEX_NONE) == bvxi_corner_is_ghost(m, at),
                    "a corner without a row");
            if (bvxi_corner_is_ghost(m, at)) continue;
            require(s->row[at] < s->rows, "a row that is not there");
        }
    for (uint32_t v = 0; v < m->vertices; v++) {
        int32_t at = c->any[v];
        int lines = 0;

        if (bvxi_collapse_is_gone(c, v)) continue;
        do {
            uint32_t const w = bvxi_corner_vertex_of(m, bvxi_corner_next(at));

            lines += w != BVXI_VERTEX_GHOST && bvxi_collapse_is_feature(c, bvxi_corner_previous(at));
            at = bvxi_corner_turn_left(m, at);
        } while (at != c->any[v]);
        require(lines == 0 || c->kind[v] != 0, "a vertex on a line has no kind");
        require(lines <= 2 || (c->kind[v] & (VERTEX_JUNCTION | VERTEX_LOCKED)) != 0,
                "lines meet at a vertex that moves");
    }
}

static inline void check_collapse(bvxi_collapse *c)
{
    check_neighbours(&c->mesh);
    check_fans(c);
    check_costs(c);
    check_undo(c);
    check_rows(c);
    check_costs_anew(c);
}

/* ---- Crossings, by all pairs ---- */

/* The corners of a triangle, equal positions by one pointer. */
static inline void plain_corners(const bvxi_corners *m, uint64_t s, uint64_t t, const double *p[3],
                                 const double *q[3])
{
    for (int k = 0; k < 3; k++) {
        p[k] = m->at[m->triangle[s].vertex[k]].p;
        q[k] = m->at[m->triangle[t].vertex[k]].p;
        for (int i = 0; i < k; i++)
            if (memcmp(p[i], p[k], 24) == 0) p[k] = p[i];
    }
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            if (q[k][0] == p[i][0] && q[k][1] == p[i][1] && q[k][2] == p[i][2]) q[k] = p[i];
}

static inline int plain_cross(const bvxi_corners *m, uint64_t s, uint64_t t)
{
    const double *p[3], *q[3];

    plain_corners(m, s, t, p, q);
    for (int a = 0; a < 3; a++) {
        if (fmax(p[0][a], fmax(p[1][a], p[2][a])) < fmin(q[0][a], fmin(q[1][a], q[2][a]))) return 0;
        if (fmax(q[0][a], fmax(q[1][a], q[2][a])) < fmin(p[0][a], fmin(p[1][a], p[2][a]))) return 0;
    }
    return bvxi_has_area(p) && bvxi_has_area(q) && bvxi_triangles_cross_exact(p, q);
}

/* Pairs that cross, each lower index first, in order; *pairs is for free(). */
static inline uint64_t plain_pairs(const bvxi_corners *m, uint32_t **pairs)
{
    uint64_t found = 0, capacity = 0;

    *pairs = NULL;
    for (uint64_t s = 0; s < m->triangles; s++)
        for (uint64_t t = s + 1; t < m->triangles; t++) {
            if (bvxi_corner_gone(m, (int32_t)(4 * s)) || bvxi_corner_gone(m, (int32_t)(4 * t))) continue;
            if (!plain_cross(m, s, t)) continue;
            if (found == capacity) *pairs = maker_grow(*pairs, (size_t)((capacity += capacity + 64) * 8));
            (*pairs)[2 * found] = (uint32_t)s;
            (*pairs)[2 * found++ + 1] = (uint32_t)t;
        }
    return found;
}

#endif
