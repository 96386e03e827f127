/* edge_costs.c - where an edge would collapse to, and what that costs: the squared distance to the planes that both of
 * its ends stand for, and what moving their attributes costs.
 *
 * Source: Garland, Heckbert. Surface Simplification Using Quadric Error Metrics. 1997. */
#include "simplify/edge_costs.h"
#include "core/simd.h"
#include "core/vec3.h"

enum { COSTS_GRAIN = 4096 }; /* vertices of a task */

/* ---- Cost ---- */

int bvxi_collapse_is_feature(const bvxi_collapse *c, int32_t edge)
{
    return bvxi_corner_is_ghost(&c->mesh, edge) ||
           bvxi_corner_is_ghost(&c->mesh, bvxi_corner_opposite(&c->mesh, edge)) ||
           bvxi_attributes_part(c, edge);
}

enum { FREE_NOWHERE, FREE_JUNCTION, FREE_LINE, FREE_ALL };

static int freedom(const bvxi_collapse *c, uint32_t v)
{
    uint8_t const kind = c->kind[v];
    if (kind == 0) return FREE_ALL;
    if (kind == VERTEX_LINE) return FREE_LINE;
    /* A junction takes attributes along that no vertex has which was given. */
    return kind == VERTEX_JUNCTION && c->options.given.vertices != BVX_VERTICES_KEPT ? FREE_JUNCTION
                                                                                     : FREE_NOWHERE;
}

/* Where an edge's ends may meet at all; 0: nowhere. */
static int plan_ends(const bvxi_collapse *c, int32_t edge, bvxi_edge_planned *plan)
{
    const bvxi_corners *const m = &c->mesh;
    uint32_t const u = bvxi_corner_vertex_of(m, bvxi_corner_next(edge));
    uint32_t const v = bvxi_corner_vertex_of(m, bvxi_corner_previous(edge));
    int free_u, free_v;

    if (u == BVXI_VERTEX_GHOST || v == BVXI_VERTEX_GHOST) return 0;
    plan->edge = edge;
    plan->u = u;
    plan->v = v;
    plan->still = plan->pinches = 0;
    if ((c->kind[u] | c->kind[v]) == 0) return 1;

    free_u = freedom(c, u);
    free_v = freedom(c, v);
    if (free_u + free_v == FREE_NOWHERE) return 0;
    if (free_u != FREE_ALL && free_v != FREE_ALL) {
        if (!bvxi_collapse_is_feature(c, edge)) {
            /* Lines meet across the strip between them, which is a junction from then on. Vertices that were given
             * have no attributes of the other side. */
            if (c->attributes.row == NULL || c->options.given.vertices == BVX_VERTICES_KEPT) return 0;
            plan->pinches = free_u == free_v && free_u == FREE_LINE;
        }
        if (c->attributes.row != NULL && !bvxi_attributes_match(c, edge)) return 0;
    }

    /* The end that is less free stays, where it is. */
    if (free_v < free_u) {
        plan->edge = bvxi_corner_opposite(m, edge);
        plan->u = v;
        plan->v = u;
    }
    plan->still = plan->pinches || free_u != free_v || free_u == FREE_JUNCTION;
    return 1;
}

/* Everything is about u, near the edge: the same sums about the origin would cancel most of their digits. */
static void join_ends(const bvxi_collapse *c, bvxi_edge_planned *plan)
{
    for (int k = 0; k < 3; k++)
        plan->offset[k] = (c->mesh.at[plan->v].p[k] - c->mesh.at[plan->u].p[k]) * c->scale;
    bvxi_quadrics_join(&c->mesh.at[plan->u].q, &c->mesh.at[plan->v].q, plan->offset, &plan->q);
    plan->all = plan->q;
    if (c->attributes.channels > 0 && c->options.given.attribute_weight > 0)
        bvxi_attributes_add(c, plan->edge, plan->offset, plan->all.a, plan->all.b, &plan->all.c);
    memset(plan->d, 0, sizeof plan->d);
    plan->cost = plan->all.c > 0 ? plan->all.c : 0;
}

int bvxi_edge_plan(const bvxi_collapse *c, int32_t edge, bvxi_edge_planned *plan)
{
    int const kept = c->options.given.vertices == BVX_VERTICES_KEPT;

    if (!plan_ends(c, edge, plan)) return 0;
    join_ends(c, plan);
    if (plan->still && freedom(c, plan->u) != freedom(c, plan->v)) return 1;

    /* Nearly parallel planes meet far away, exactly but uselessly: a vertex there would be a spike. */
    if (!kept && !plan->still && bvxi_quadric_solve(plan->all.a, plan->all.b, plan->d)) {
        double reach = 0, length = 0;

        for (int k = 0; k < 3; k++) {
            double const way = plan->d[k] - 0.5 * plan->offset[k];

            length += plan->offset[k] * plan->offset[k];
            reach += way * way;
        }
        if (reach <= 4 * length) {
            double const cost = plan->all.c + bvxi_vec_dot(plan->all.b, plan->d);

            plan->cost = cost > 0 ? cost : 0;
            return 1;
        }
        memset(plan->d, 0, sizeof plan->d);
    }

    /* Where the planes leave it open: the better end, which stays on the surface. */
    double const at_v = bvxi_quadric_at(&plan->all, plan->offset);
    if (!(at_v < plan->cost)) return 1;
    plan->cost = at_v;
    if (kept || plan->still) {
        uint32_t const u = plan->u;

        plan->edge = bvxi_corner_opposite(&c->mesh, plan->edge);
        plan->u = plan->v;
        plan->v = u;
        join_ends(c, plan);
    } else {
        memcpy(plan->d, plan->offset, sizeof plan->d);
    }
    return 1;
}

/* ---- Costs beside the edges ---- */

/* A new triangle keeps its side when its normal turns by less than about 78 degrees. */
#define SIDE_COSINE 0.2
/* Twice the area over the sum of squared sides, of a triangle that is no needle (equal sides: 0.577). */
#define NEEDLE_SHAPE 0.002

#define BVXI_SIMD_LEVEL _base
#include "simplify/edge_costs_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "simplify/edge_costs_body.h"
#undef BVXI_SIMD_LEVEL
#endif

#if BVXI_HAVE_AVX2
#define EDGES_BY(fast, name, ...) ((fast) ? name##_avx2(__VA_ARGS__) : name##_base(__VA_ARGS__))
#else
#define EDGES_BY(fast, name, ...) ((void)(fast), name##_base(__VA_ARGS__))
#endif

void bvxi_edges_evaluate(bvxi_collapse *c, uint32_t u, const uint32_t *w, const int32_t *from, int32_t count)
{
    bvxi_corners *const m = &c->mesh;

    for (int32_t i = 0; i < count; i += 4) {
        const bvxi_corner_vertex *v[4];
        int32_t const n = count - i < 4 ? count - i : 4;
        int bound = c->kind[u] | (c->attributes.row != NULL);
        double cost[4];

        for (int32_t k = 0; k < 4; k++) {
            uint32_t const x = w[k < n ? i + k : i];

            v[k] = &m->at[x == BVXI_VERTEX_GHOST ? u : x];
            bound |= x == BVXI_VERTEX_GHOST || c->kind[x];
        }
        if (!bound) EDGES_BY(c->fast, costs_of_four, &m->at[u], v, c->scale, cost);
        for (int32_t k = 0; k < n; k++) {
            bvxi_edge_planned plan;

            if (bound)
                cost[k] = bvxi_edge_plan(c, bvxi_corner_previous(from[i + k]), &plan)
                              ? plan.cost
                              : (double)COLLAPSE_NEVER;
            /* No more than the type holds, and nothing that compares with nothing. */
            float const rounded = (float)cost[k];
            bvxi_edge_put_cost(m, from[i + k], rounded < COLLAPSE_NEVER ? rounded : COLLAPSE_NEVER);
        }
    }
}

int bvxi_edge_judge_shapes(const bvxi_collapse *c, const bvxi_edge_planned *plan, const collapse_star *star,
                           const double *p, int needles)
{
    const bvxi_corners *const m = &c->mesh;
    const double *const end[2] = {m->at[plan->u].p, m->at[plan->v].p};
    const double *from[4], *a[4], *b[4];
    int32_t n = 0;

    for (int32_t i = 0; i < star->count; i++) {
        uint32_t const x = star->link[i], y = star->link[i + 1];

        if (x != BVXI_VERTEX_GHOST && y != BVXI_VERTEX_GHOST) {
            from[n] = end[i < star->of_v];
            a[n] = m->at[x].p;
            b[n++] = m->at[y].p;
        }
        if (n == 0 || (n < 4 && i + 1 < star->count)) continue;
        for (; n < 4; n++) {
            from[n] = from[0];
            a[n] = a[0];
            b[n] = b[0];
        }
        if (!EDGES_BY(c->fast, judge_four, from, a, b, p, needles)) return 0;
        n = 0;
    }
    return 1;
}

void bvxi_edges_around(bvxi_collapse *c, uint32_t u, int stale)
{
    const bvxi_corners *const m = &c->mesh;
    uint32_t w[4];
    int32_t from[4], at = c->any[u], n = 0;

    do {
        uint32_t const x = bvxi_corner_vertex_of(m, bvxi_corner_next(at));

        w[n] = x;
        from[n] = at;
        n += !stale || (x > u && x != BVXI_VERTEX_GHOST && c->stale[x] != 0);
        at = bvxi_corner_turn_left(m, at);
        if (n < 4 && at != c->any[u]) continue;
        bvxi_edges_evaluate(c, u, w, from, n);
        n = 0;
    } while (at != c->any[u]);
}

void bvxi_edge_find_least(bvxi_collapse *c, uint32_t v)
{
    const bvxi_corners *const m = &c->mesh;
    int32_t const start = c->any[v];
    int32_t at = start, best = -1;
    float least = COLLAPSE_NEVER;

    do {
        float const cost = bvxi_edge_cost(m, at);

        if (cost < least) {
            least = cost;
            best = at;
        }
        at = bvxi_corner_turn_left(m, at);
    } while (at != start);
    c->least[v] = least;
    c->edge[v] = best;
}

static void evaluate_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    bvxi_collapse *const c = user;
    (void)piece;
    for (uint64_t v = begin; v < end; v++)
        if (!bvxi_collapse_is_gone(c, (uint32_t)v) && c->stale[v] != 0) bvxi_edges_around(c, (uint32_t)v, 1);
}

static void least_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    bvxi_collapse *const c = user;
    (void)piece;
    for (uint64_t v = begin; v < end; v++)
        if (!bvxi_collapse_is_gone(c, (uint32_t)v) && (c->stale[v] != 0 || c->edge[v] < 0))
            bvxi_edge_find_least(c, (uint32_t)v);
}

static void index_piece(void *user, int32_t piece, uint64_t begin, uint64_t end)
{
    const bvxi_collapse *const c = user;
    const bvxi_corners *const m = &c->mesh;
    (void)piece;
    memset(c->edge + begin, 0xff, (size_t)(end - begin) * sizeof *c->edge); /* -1 */
    bvxi_corners_any(m, begin, end, c->any);
}

void bvxi_collapse_index(bvxi_collapse *c)
{
    bvxi_ranges(c->ctx, bvxi_looking_pieces(c->ctx), c->mesh.vertices, index_piece, c);
}

void bvxi_collapse_find_least(bvxi_collapse *c)
{
    bvxi_ranges(c->ctx, bvxi_piece_count(c->mesh.vertices, COSTS_GRAIN), c->mesh.vertices, least_piece, c);
}

bvx_status bvxi_collapse_evaluate(bvxi_collapse *c)
{
    bvxi_ranges(c->ctx, bvxi_piece_count(c->mesh.vertices, COSTS_GRAIN), c->mesh.vertices, evaluate_piece, c);
    bvxi_collapse_find_least(c);
    memset(c->stale, 0, (size_t)c->mesh.vertices);
    return BVX_OK;
}

void bvxi_edge_settle(bvxi_collapse *c, const bvxi_edge_planned *plan, const double *p)
{
    bvxi_corner_vertex *const at = &c->mesh.at[plan->u];
    double d[3];

    /* The quadric is kept about its own vertex, so it moves with it: A stays, b becomes half the gradient
     * there. */
    for (int k = 0; k < 3; k++) {
        d[k] = (p[k] - at->p[k]) * c->scale;
        at->p[k] = p[k];
    }
    at->q = plan->q;
    bvxi_half_gradient(&plan->q, d, at->q.b);
    at->q.c = bvxi_quadric_at(&plan->q, d);
}
