/* collapse.c - edges that collapse by rising cost, all over the mesh at once.
 *
 * Source: Garland, Heckbert. Surface Simplification Using Quadric Error Metrics. 1997. Luebke. A Developer's
 * Survey of Polygonal Simplification Algorithms. 2001.
 *
 * Costs lie beside the edges and are brought up to date by each collapse, so that nothing waits in a queue. A
 * sweep takes the cheapest share of all vertices' edges, in the order of space, and of two edges with a common
 * end the cheaper one: the order of a queue, nearly, in the order of memory.
 *
 * Vertices are cut into ranges, whose number follows from the mesh. Each range collapses on its own, in
 * parallel, what lies in it with all of its neighbours; what reaches into others comes after, one by one. So
 * any number of threads gives the same bits.
 *
 * Guarantee: a mesh that is closed, manifold and oriented stays so, and keeps its handles and borders. Whether
 * triangles cross is judged afterwards (judge.c), which undoes what made them. */
#include "simplify/collapse_state.h"
#include "bits/bits.h"
#include "core/vec3.h"

/* Of mean edge's square to a triangle's area, where all sides are equal. */
#define EDGE_SQUARE 2.309401076758503
/* A new triangle keeps its side when its normal turns by less than about 78 degrees. */
#define SIDE_COSINE 0.2
/* Twice the area over the sum of squared sides, of a triangle that is no needle (equal sides: 0.577). */
#define NEEDLE_SHAPE 0.002
/* Of all vertices, those whose edges a sweep takes. */
#define SWEEP_SHARE 0.5
/* Times the cost that edges had so far. */
#define DEARER 64.0f

enum {
    RANGE_VERTICES = 4096,  /* of a range, at least */
    RANGE_MOST = 64,        /* ranges */
    RANGE_COLLAPSES = 4096, /* fewer are not worth ranges */
    SWEEP_AHEAD = 8,        /* vertices */
    THRESHOLD_WANTED = 16384,
    THRESHOLD_VERTICES = 8192, /* more are wanted: about so many are looked at */
    THRESHOLD_FEW = 64,        /* the share of those wanted that are the cheapest */
    COSTS_GRAIN = 4096         /* triangles or vertices of a task */
};

/* ---- Cost ---- */

/* A quadric while it is computed with. */
typedef struct quadric {
    double a[6], b[3], c;
} quadric;

/* A d + b: half the gradient at d. */
static void half_gradient(const quadric *q, const double d[3], double g[3])
{
    g[0] = q->a[0] * d[0] + q->a[1] * d[1] + q->a[2] * d[2] + q->b[0];
    g[1] = q->a[1] * d[0] + q->a[3] * d[1] + q->a[4] * d[2] + q->b[1];
    g[2] = q->a[2] * d[0] + q->a[4] * d[1] + q->a[5] * d[2] + q->b[2];
}

static double quadric_at(const quadric *q, const double d[3])
{
    double g[3], value;

    half_gradient(q, d, g);
    value = (g[0] + q->b[0]) * d[0] + (g[1] + q->b[1]) * d[1] + (g[2] + q->b[2]) * d[2] + q->c;
    return value > 0 ? value : 0;
}

/* The sum of both vertices' quadrics about u; offset leads from u to v. */
BVXI_VECTOR_INLINE void join_quadrics(const bvxi_corner_vertex *u, const bvxi_corner_vertex *v,
                                      const double offset[3], quadric *q)
{
    double const x = offset[0], y = offset[1], z = offset[2];
    double const way[3] = {v->a[0] * x + v->a[1] * y + v->a[2] * z, v->a[1] * x + v->a[3] * y + v->a[4] * z,
                           v->a[2] * x + v->a[4] * y + v->a[5] * z};

    /* About u the other one has b - A offset, and c - 2 b' offset + offset' A offset. */
    for (int i = 0; i < 6; i++) q->a[i] = u->a[i] + v->a[i];
    q->c = u->c + v->c;
    for (int i = 0; i < 3; i++) {
        q->b[i] = u->b[i] + (v->b[i] - way[i]);
        q->c += offset[i] * (way[i] - 2 * v->b[i]);
    }
}

/* Of A d = g, with the largest diagonal first: the upper half of A, and g. */
BVXI_VECTOR_INLINE int eliminate(double xx, double xy, double xz, double yy, double yz, double zz, double x,
                                 double y, double z, double least, double *dx, double *dy, double *dz)
{
    double const by_x = 1 / xx, to_y = xy * by_x, to_z = xz * by_x;
    double const a = yy - to_y * xy, b = yz - to_y * xz, c = zz - to_z * xz;
    double const g = y - to_y * x, h = z - to_z * x;
    double s, t;

    if (a > c) {
        double const by_a = 1 / a, share = b * by_a, last = c - share * b;

        if (!((xx > least) & (a > least) & (last > least))) return 0;
        t = (h - share * g) / last;
        s = g * by_a - share * t;
    } else {
        double const by_c = 1 / c, share = b * by_c, last = a - share * b;

        if (!((xx > least) & (c > least) & (last > least))) return 0;
        s = (g - share * h) / last;
        t = h * by_c - share * s;
    }
    *dx = (x - xy * s - xz * t) * by_x;
    *dy = s;
    *dz = t;
    return 1;
}

/* Solve A d = -b by elimination with the largest remaining diagonal first, which keeps small eigenvalues
 * apart from rounding; 0: A is singular within it. A is symmetric and not negative, so each pivot bounds its
 * row, and the rows need no pivoting of their own. A pivot within rounding of the trace is a direction that no
 * plane fixes: then the caller takes an end of the edge, which lies on the surface. NaN fails the comparison
 * too. */
BVXI_VECTOR_INLINE int solve_least(const double a[6], const double b[3], double d[3])
{
    double const least = (a[0] + a[3] + a[5]) * 1e-13;

    if (a[5] > a[0] && a[5] > a[3])
        return eliminate(a[5], a[4], a[2], a[3], a[1], a[0], -b[2], -b[1], -b[0], least, &d[2], &d[1], &d[0]);
    if (a[3] > a[0])
        return eliminate(a[3], a[1], a[4], a[0], a[2], a[5], -b[1], -b[0], -b[2], least, &d[1], &d[0], &d[2]);
    return eliminate(a[0], a[1], a[2], a[3], a[4], a[5], -b[0], -b[1], -b[2], least, &d[0], &d[1], &d[2]);
}

static void offset_between(const bvxi_collapse *c, uint32_t u, uint32_t v, double offset[3])
{
    for (int k = 0; k < 3; k++) offset[k] = (c->mesh.at[v].p[k] - c->mesh.at[u].p[k]) * c->scale;
}

/* How an edge would collapse. */
typedef struct edge_plan {
    int32_t edge;     /* corner opposite to it, with u next and v previous */
    uint32_t u, v;    /* the vertex that stays, and the one that goes */
    int32_t still;    /* 1: u stays where it is */
    quadric q;        /* of both, about u */
    quadric all;      /* and what their attributes cost */
    double offset[3]; /* from u to v */
    double d[3];      /* the new position from u, in units of 1 / scale */
    double cost;
} edge_plan;

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
    return kind == VERTEX_JUNCTION && c->options.vertices != BVX_VERTICES_KEPT ? FREE_JUNCTION : FREE_NOWHERE;
}

/* Where an edge's ends may meet at all; 0: nowhere. */
static int plan_ends(const bvxi_collapse *c, int32_t edge, edge_plan *plan)
{
    const bvxi_corners *const m = &c->mesh;
    uint32_t const u = bvxi_corner_vertex_of(m, bvxi_corner_next(edge));
    uint32_t const v = bvxi_corner_vertex_of(m, bvxi_corner_previous(edge));
    int free_u, free_v;

    if (u == BVXI_VERTEX_GHOST || v == BVXI_VERTEX_GHOST) return 0;
    plan->edge = edge;
    plan->u = u;
    plan->v = v;
    plan->still = 0;
    if ((c->kind[u] | c->kind[v]) == 0) return 1;

    free_u = freedom(c, u);
    free_v = freedom(c, v);
    if (free_u + free_v == FREE_NOWHERE) return 0;
    if (free_u != FREE_ALL && free_v != FREE_ALL) {
        if (!bvxi_collapse_is_feature(c, edge)) return 0;
        if (c->attributes.row != NULL && !bvxi_attributes_match(c, edge)) return 0;
    }

    /* The end that is less free stays, where it is. */
    if (free_v < free_u) {
        plan->edge = bvxi_corner_opposite(m, edge);
        plan->u = v;
        plan->v = u;
    }
    plan->still = free_u != free_v || free_u == FREE_JUNCTION;
    return 1;
}

/* Either end may stay. */
static int may_swap(const bvxi_collapse *c, const edge_plan *plan)
{
    return freedom(c, plan->u) == freedom(c, plan->v);
}

/* Everything is about u, near the edge: the same sums about the origin would cancel most of their digits. */
static void join_ends(const bvxi_collapse *c, edge_plan *plan)
{
    offset_between(c, plan->u, plan->v, plan->offset);
    join_quadrics(&c->mesh.at[plan->u], &c->mesh.at[plan->v], plan->offset, &plan->q);
    plan->all = plan->q;
    if (c->attributes.channels > 0 && c->options.attribute_weight > 0)
        bvxi_attributes_add(c, plan->edge, plan->offset, plan->all.a, plan->all.b, &plan->all.c);
    memset(plan->d, 0, sizeof plan->d);
    plan->cost = plan->all.c > 0 ? plan->all.c : 0;
}

/* Where an edge's ends would meet, and what it costs; 0: nowhere. */
static int plan_edge(const bvxi_collapse *c, int32_t edge, edge_plan *plan)
{
    int const kept = c->options.vertices == BVX_VERTICES_KEPT;
    double at_v;

    if (!plan_ends(c, edge, plan)) return 0;
    join_ends(c, plan);
    if (plan->still && !may_swap(c, plan)) return 1;

    /* Nearly parallel planes meet far away, exactly but uselessly: a vertex there would be a spike. */
    if (!kept && !plan->still && solve_least(plan->all.a, plan->all.b, plan->d)) {
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
    at_v = quadric_at(&plan->all, plan->offset);
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

/* The same as plan_edge finds, of two ends that may both move anywhere. */
static float free_cost(const bvxi_collapse *c, uint32_t u, uint32_t v)
{
    double offset[3], d[3], length = 0, reach = 0, cost, at_v;
    quadric q;

    offset_between(c, u, v, offset);
    join_quadrics(&c->mesh.at[u], &c->mesh.at[v], offset, &q);
    if (BVXI_LIKELY(solve_least(q.a, q.b, d))) {
        for (int k = 0; k < 3; k++) {
            double const way = d[k] - 0.5 * offset[k];

            length += offset[k] * offset[k];
            reach += way * way;
        }
        if (BVXI_LIKELY(reach <= 4 * length)) {
            cost = q.c + bvxi_vec_dot(q.b, d);
            return (float)(cost > 0 ? cost : 0);
        }
    }
    cost = q.c > 0 ? q.c : 0;
    at_v = quadric_at(&q, offset);
    return (float)(at_v < cost ? at_v : cost);
}

static float cost_of(const bvxi_collapse *c, int32_t edge)
{
    uint32_t const u = bvxi_corner_vertex_of(&c->mesh, bvxi_corner_next(edge));
    uint32_t const v = bvxi_corner_vertex_of(&c->mesh, bvxi_corner_previous(edge));
    edge_plan plan;
    float cost = COLLAPSE_NEVER;

    if (u == BVXI_VERTEX_GHOST || v == BVXI_VERTEX_GHOST) return COLLAPSE_NEVER;
    if ((c->kind[u] | c->kind[v]) == 0 && c->attributes.row == NULL) cost = free_cost(c, u, v);
    else if (plan_edge(c, edge, &plan)) cost = (float)plan.cost;

    /* No more than the type holds, and nothing that compares with nothing. */
    return cost < COLLAPSE_NEVER ? cost : COLLAPSE_NEVER;
}

static void put_cost(bvxi_corners *m, int32_t edge, float cost)
{
    int32_t const across = bvxi_corner_opposite(m, edge);

    m->triangle[edge >> 2].cost[edge & 3] = cost;
    m->triangle[across >> 2].cost[across & 3] = cost;
}

static float edge_cost(const bvxi_corners *m, int32_t edge)
{
    return m->triangle[edge >> 2].cost[edge & 3];
}

/* The cheapest edge of a vertex, by the costs beside them. */
static void find_least(bvxi_collapse *c, uint32_t v)
{
    const bvxi_corners *const m = &c->mesh;
    int32_t const start = c->any[v];
    int32_t at = start, best = -1;
    float least = COLLAPSE_NEVER;

    do {
        int32_t const edge = bvxi_corner_previous(at);
        float const cost = edge_cost(m, edge);

        if (cost < least) {
            least = cost;
            best = edge;
        }
        at = bvxi_corner_next(bvxi_corner_opposite(m, bvxi_corner_next(at)));
    } while (at != start);
    c->least[v] = least;
    c->edge[v] = best;
}

static void evaluate_piece(void *user, int32_t index, int32_t worker)
{
    bvxi_collapse *const c = user;
    bvxi_corners *const m = &c->mesh;
    uint64_t begin, end;
    (void)worker;

    bvxi_piece(m->triangles, bvxi_piece_count(m->triangles, COSTS_GRAIN), index, &begin, &end);
    for (int32_t t = (int32_t)begin; t < (int32_t)end; t++) {
        if (bvxi_corner_gone(m, 4 * t)) continue;
        /* Each edge once, from the smaller corner: ghosts have none. */
        for (int32_t edge = 4 * t; edge < 4 * t + 3; edge++)
            if (edge < bvxi_corner_opposite(m, edge)) put_cost(m, edge, cost_of(c, edge));
    }
}

static void least_piece(void *user, int32_t index, int32_t worker)
{
    bvxi_collapse *const c = user;
    uint64_t begin, end;
    (void)worker;

    bvxi_piece(c->mesh.vertices, bvxi_piece_count(c->mesh.vertices, COSTS_GRAIN), index, &begin, &end);
    for (uint64_t v = begin; v < end; v++)
        if (!bvxi_collapse_is_gone(c, (uint32_t)v)) find_least(c, (uint32_t)v);
}

void bvxi_collapse_index(bvxi_collapse *c)
{
    bvxi_corners *const m = &c->mesh;

    for (uint64_t v = 0; v < m->vertices; v++) c->edge[v] = -1;
    for (uint64_t t = m->triangles + m->ghosts; t-- > 0;)
        for (int k = 0; k < 3; k++)
            if (m->triangle[t].vertex[k] != BVXI_VERTEX_GHOST)
                c->any[m->triangle[t].vertex[k]] = (int32_t)(4 * t) + k;
}

void bvxi_collapse_find_least(bvxi_collapse *c)
{
    bvxi_tasks(c->ctx, bvxi_piece_count(c->mesh.vertices, COSTS_GRAIN), least_piece, c);
}

bvx_status bvxi_collapse_evaluate(bvxi_collapse *c)
{
    bvxi_tasks(c->ctx, bvxi_piece_count(c->mesh.triangles, COSTS_GRAIN), evaluate_piece, c);
    bvxi_collapse_find_least(c);
    return BVX_OK;
}

/* ---- The star of an edge ---- */

/* Triangle i of the star is at corner[i], which is its corner at v for the first of them and at u for the
 * others; link[i] and link[i + 1] are its other vertices, counter-clockwise around both. */
typedef struct collapse_star {
    int32_t of_v, count;
    int32_t corner[2 * COLLAPSE_STAR];
    uint32_t link[2 * COLLAPSE_STAR + 1];
} collapse_star;

/* Triangles around a vertex after that of `start`, until one has vertex `other`; 0: too many. */
static int gather_side(const bvxi_corners *m, int32_t start, uint32_t other, int32_t most,
                       collapse_star *star)
{
    for (int32_t c = bvxi_corner_turn_left(m, start);; c = bvxi_corner_turn_left(m, c)) {
        if (bvxi_corner_vertex_of(m, bvxi_corner_previous(c)) == other) return 1;
        if (star->count == most) return 0;
        star->link[star->count] = bvxi_corner_vertex_of(m, bvxi_corner_next(c));
        star->corner[star->count++] = c;
    }
}

/* 0: the collapse would change the topology, or the star is too large. */
static int gather_star(const bvxi_corners *m, const edge_plan *plan, collapse_star *star)
{
    int32_t const across = bvxi_corner_opposite(m, plan->edge);

    star->count = 0;
    if (!gather_side(m, bvxi_corner_next(across), plan->u, COLLAPSE_STAR, star)) return 0;
    star->of_v = star->count;
    if (!gather_side(m, bvxi_corner_next(plan->edge), plan->v, star->count + COLLAPSE_STAR, star)) return 0;

    /* Fewer would leave two triangles back to back on the same three vertices. */
    if (star->count < 3) return 0;
    star->link[star->count] = star->link[0];

    /* A vertex that is there twice is a neighbour of both ends beside the two that they may share; the ghost
     * is when both ends are on borders and the edge is not. */
    for (int32_t i = 1; i < star->count; i++)
        for (int32_t j = 0; j < i; j++)
            if (star->link[i] == star->link[j]) return 0;
    return 1;
}

/* The sum of squared sides. */
static double sides_of(const double *a, const double *b, const double *c)
{
    return bvxi_vec_distance2(a, b) + bvxi_vec_distance2(b, c) + bvxi_vec_distance2(c, a);
}

enum { STAR_SAFE, STAR_TURNS, STAR_NEEDLE, STAR_CROSSES };

/* Do the triangles of the star keep their sides when their vertex moves to p? */
static int judge_shapes(const bvxi_corners *m, const edge_plan *plan, const collapse_star *star,
                        const double *p, int needles)
{
    for (int32_t i = 0; i < star->count; i++) {
        uint32_t const at_a = star->link[i], at_b = star->link[i + 1];
        const double *const apex = bvxi_corner_position(m, i < star->of_v ? plan->v : plan->u);
        const double *a, *b;
        double n[3], before[3], cosine, n_square, before_square, sides, sides_before;

        if (at_a == BVXI_VERTEX_GHOST || at_b == BVXI_VERTEX_GHOST) continue;
        a = bvxi_corner_position(m, at_a);
        b = bvxi_corner_position(m, at_b);
        bvxi_area_normal(p, a, b, n);
        bvxi_area_normal(apex, a, b, before);
        n_square = bvxi_vec_dot(n, n);
        before_square = bvxi_vec_dot(before, before);

        /* No area, or NaN: nothing below could judge its side. */
        if (!(n_square > 0)) return STAR_NEEDLE;

        /* What had no area has no side to keep. */
        cosine = bvxi_vec_dot(n, before);
        if (!(cosine > 0 && cosine * cosine > SIDE_COSINE * SIDE_COSINE * n_square * before_square) &&
            before_square > 0)
            return STAR_TURNS;

        /* A needle may stay one where the collapse makes it no thinner. */
        if (needles) continue;
        sides = sides_of(p, a, b);
        if (BVXI_LIKELY(n_square >= NEEDLE_SHAPE * NEEDLE_SHAPE * sides * sides)) continue;
        sides_before = sides_of(apex, a, b);
        if (!(n_square * sides_before * sides_before > before_square * sides * sides)) return STAR_NEEDLE;
    }
    return STAR_SAFE;
}

/* ---- Collapsing ---- */

typedef struct collapse_sweep {
    bvxi_collapse *c;
    float threshold;
    uint64_t size;       /* vertices of a range; 0: one range has all */
    uint64_t left;       /* triangles as the sweep begins */
    uint64_t candidates; /* vertices with an edge that cheap */
    uint64_t needed;     /* collapses */
} collapse_sweep;

/* What one range has done. */
typedef struct collapse_range {
    collapse_star star;
    uint32_t order;
    uint64_t collapsed, triangles; /* that went */
    bvxi_collapse_counts counts;
} collapse_range;

/* Both ends' quadric, moved to the new position. */
static void settle_vertex(bvxi_collapse *c, const edge_plan *plan, const double *p)
{
    bvxi_corner_vertex *const at = &c->mesh.at[plan->u];
    double d[3], g[3];

    /* The quadric is kept about its own vertex, so it moves with it: A stays, b becomes half the gradient
     * there. */
    for (int k = 0; k < 3; k++) {
        d[k] = (p[k] - at->p[k]) * c->scale;
        at->p[k] = p[k];
    }
    half_gradient(&plan->q, d, g);
    for (int i = 0; i < 6; i++) at->a[i] = plan->q.a[i];
    for (int i = 0; i < 3; i++) at->b[i] = g[i];
    at->c = quadric_at(&plan->q, d);
}

/* Take a triangle out from between its two other edges, which become one; corner is opposite to the
 * collapsing edge. Returns 1 unless it is a ghost. */
static int drop_triangle(bvxi_corners *m, int32_t corner)
{
    bvxi_corners_join(m, bvxi_corner_opposite(m, bvxi_corner_next(corner)),
                      bvxi_corner_opposite(m, bvxi_corner_previous(corner)));
    m->triangle[corner >> 2].vertex[1] = ~m->triangle[corner >> 2].vertex[1];
    return !bvxi_corner_is_ghost(m, corner);
}

/* The edges of a vertex whose quadric or position is new, and the cheapest of each neighbour. */
static void renew_edges(bvxi_collapse *c, uint32_t u, const collapse_star *star)
{
    bvxi_corners *const m = &c->mesh;
    float least = COLLAPSE_NEVER;
    int32_t best = -1;

    for (int32_t i = 0; i < star->count; i++) {
        int32_t const edge = bvxi_corner_previous(star->corner[i]);
        float const cost = cost_of(c, edge);

        put_cost(m, edge, cost);
        if (cost < least) {
            least = cost;
            best = edge;
        }
    }
    c->least[u] = least;
    c->edge[u] = best;

    for (int32_t i = 0; i < star->count; i++) {
        uint32_t const w = star->link[i];
        int32_t const edge = bvxi_corner_previous(star->corner[i]);
        int32_t old;

        if (w == BVXI_VERTEX_GHOST) continue;
        old = c->edge[w];
        if (old < 0 || bvxi_corner_gone(m, old) || bvxi_corner_vertex_of(m, bvxi_corner_next(old)) == u ||
            bvxi_corner_vertex_of(m, bvxi_corner_previous(old)) == u) {
            find_least(c, w);
        } else if (edge_cost(m, edge) < c->least[w]) {
            c->least[w] = edge_cost(m, edge);
            c->edge[w] = edge;
        }
    }
}

static void apply(bvxi_collapse *c, const edge_plan *plan, const double *p, collapse_range *r)
{
    bvxi_corners *const m = &c->mesh;
    const collapse_star *const star = &r->star;
    uint32_t const u = plan->u, v = plan->v;
    int32_t const across = bvxi_corner_opposite(m, plan->edge);
    collapse_undo *const undo = &c->undo[v];

    memcpy(undo->p, m->at[u].p, sizeof undo->p);
    undo->edge = plan->edge;
    undo->stayed = u;
    undo->before = c->last[u];
    undo->order = r->order++;
    c->last[u] = v;
    c->fresh[u] = 1;

    if (c->attributes.row != NULL) {
        double d[3];

        for (int k = 0; k < 3; k++) d[k] = (p[k] - m->at[u].p[k]) * c->scale;
        bvxi_attributes_merge(c, plan->edge, plan->offset, d, star->corner, star->of_v);
    }
    settle_vertex(c, plan, p);
    r->triangles += (uint64_t)drop_triangle(m, plan->edge);
    r->triangles += (uint64_t)drop_triangle(m, across);
    for (int32_t i = 0; i < star->of_v; i++)
        m->triangle[star->corner[i] >> 2].vertex[star->corner[i] & 3] = u;

    /* The apexes of the triangles that went are the ends of both parts of the link. */
    c->any[u] = star->corner[0];
    for (int32_t i = 0; i <= star->of_v; i += star->of_v > 0 ? star->of_v : 1)
        if (star->link[i] != BVXI_VERTEX_GHOST) c->any[star->link[i]] = bvxi_corner_next(star->corner[i]);
    c->least[v] = COLLAPSE_NEVER;
    c->edge[v] = COLLAPSE_GONE;
    r->collapsed++;
    if (c->came != NULL) c->came[u] |= c->came[v];
    for (int32_t i = 0; i < star->count && c->tree.node[0] != NULL; i++)
        if (!bvxi_corner_is_ghost(m, star->corner[i]))
            bvxi_crossing_tree_move(&c->tree, (uint32_t)star->corner[i] >> 2);
    renew_edges(c, u, star);
}

/* 1 when the new vertex would be further from its planes, by the mean square over their area, than triangles
 * of the mesh can show as it is now. */
static int is_crumpled(const collapse_sweep *s, const edge_plan *plan, const double d[3])
{
    double const trace = plan->q.a[0] + plan->q.a[3] + plan->q.a[5];

    /* Both sides are multiplied by the count of triangles and the trace, so that nothing is divided by an
     * area of 0. */
    return quadric_at(&plan->q, d) * (double)s->left >
           s->c->crumpled * s->c->crumpled * EDGE_SQUARE * s->c->area * trace;
}

/* May the edge collapse to an offset from u? p becomes the position, rounded as the caller gets it. */
static int judge_at(const collapse_sweep *s, const edge_plan *plan, const collapse_star *star,
                    const double d[3], int needles, double p[3])
{
    const bvxi_collapse *const c = s->c;
    const double *const from = c->mesh.at[plan->u].p;
    int verdict;

    for (int k = 0; k < 3; k++) p[k] = bvxi_collapse_rounded(c, from[k] + d[k] / c->scale);
    if (d[0] == 0 && d[1] == 0 && d[2] == 0) memcpy(p, from, 3 * sizeof *p);
    verdict = judge_shapes(&c->mesh, plan, star, p, needles);
    if (verdict != STAR_SAFE || c->tree.node[0] == NULL) return verdict;
    return bvxi_collapse_crosses(c, plan->u, plan->v, star->link, star->count, p) ? STAR_CROSSES : STAR_SAFE;
}

/* Where the best position turns triangles over, the ends and the middle may not, at no more than twice the cost
 * that the edge has, which rises when it is refused. */
static int judge_elsewhere(const collapse_sweep *s, edge_plan *plan, const collapse_star *star, double cost,
                           int needles, double p[3])
{
    const double *const offset = plan->offset;

    if (plan->still || s->c->options.vertices == BVX_VERTICES_KEPT) return STAR_TURNS;
    for (int i = 0; i < 3; i++) {
        double const d[3] = {0.5 * i * offset[0], 0.5 * i * offset[1], 0.5 * i * offset[2]};

        if (quadric_at(&plan->all, d) > 2 * cost) continue;
        memcpy(plan->d, d, sizeof plan->d);
        if (judge_at(s, plan, star, d, needles, p) == STAR_SAFE) return STAR_SAFE;
    }
    return STAR_TURNS;
}

/* A refused edge may be safe after its neighbours have gone: it costs four times as much from now on. */
static void refuse(const collapse_sweep *s, int32_t edge, float cost)
{
    bvxi_collapse *const c = s->c;
    float const more = 4 * (cost > s->threshold ? cost : s->threshold) + 1e-37f;

    put_cost(&c->mesh, edge, more < COLLAPSE_NEVER ? more : COLLAPSE_NEVER);
    find_least(c, bvxi_corner_vertex_of(&c->mesh, bvxi_corner_next(edge)));
    find_least(c, bvxi_corner_vertex_of(&c->mesh, bvxi_corner_previous(edge)));
}

static int in_range(const collapse_sweep *s, uint64_t range, uint32_t v)
{
    return v == BVXI_VERTEX_GHOST || v / s->size == range;
}

/* 1: all that the collapse touches lies in the range. */
static int star_in_range(const collapse_sweep *s, uint64_t range, const collapse_star *star)
{
    int within = 1;

    for (int32_t i = 0; i < star->count; i++) within &= in_range(s, range, star->link[i]);
    return within;
}

enum { RANGE_ALL = -1 };

/* Collapse the cheapest edge of a vertex where that is safe, and it is its other end's cheapest too. */
static void try_vertex(const collapse_sweep *s, collapse_range *r, int64_t range, uint32_t v)
{
    bvxi_collapse *const c = s->c;
    bvxi_corners *const m = &c->mesh;
    int32_t const edge = c->edge[v];
    uint32_t const x = bvxi_corner_vertex_of(m, bvxi_corner_next(edge));
    uint32_t const y = bvxi_corner_vertex_of(m, bvxi_corner_previous(edge));
    edge_plan plan;
    double p[3];
    int verdict, needles;

    if (range != RANGE_ALL && (!in_range(s, (uint64_t)range, x) || !in_range(s, (uint64_t)range, y))) {
        c->waits[v] = 1;
        return;
    }
    if (c->least[x] < c->least[v] || c->least[y] < c->least[v]) return;
    if (!plan_edge(c, edge, &plan) || !gather_star(m, &plan, &r->star)) {
        r->counts.link++;
        refuse(s, edge, c->least[v]);
        return;
    }
    if (range != RANGE_ALL && !star_in_range(s, (uint64_t)range, &r->star)) {
        c->waits[v] = 1;
        return;
    }

    /* What was refused once may leave needles: thin plates cannot do without. */
    needles = plan.cost * 2 < (double)c->least[v];
    verdict = judge_at(s, &plan, &r->star, plan.d, needles, p);
    if (verdict != STAR_SAFE && judge_elsewhere(s, &plan, &r->star, (double)c->least[v], needles, p) == STAR_SAFE)
        verdict = STAR_SAFE;
    if (verdict == STAR_SAFE && !is_crumpled(s, &plan, plan.d)) {
        apply(c, &plan, p, r);
        return;
    }
    r->counts.turned += verdict == STAR_TURNS;
    r->counts.needle += verdict == STAR_NEEDLE;
    r->counts.crossed += verdict == STAR_CROSSES;
    r->counts.crumpled += verdict == STAR_SAFE;
    refuse(s, edge, c->least[v]);
}

/* ---- Sweeps ---- */

enum { COST_BUCKETS = 1 << 12 };

static uint32_t cost_bits(float cost)
{
    uint32_t bits;

    memcpy(&bits, &cost, sizeof bits);
    return bits;
}

/* Set the cost that about so many vertices have no cheaper edge than; bits of positive floats are in the order
 * of their values. candidates: how many have. Of many vertices some are looked at. */
static void choose_threshold(collapse_sweep *s, uint64_t wanted)
{
    const bvxi_collapse *const c = s->c;
    uint64_t const step = wanted > THRESHOLD_WANTED ? 1 + c->mesh.vertices / THRESHOLD_VERTICES : 1;
    uint32_t count[COST_BUCKETS], high = COST_BUCKETS - 1, low = COST_BUCKETS, bits;
    uint64_t const enough = (wanted + step - 1) / step, few = enough / THRESHOLD_FEW + 1;
    uint64_t before = 0;
    float most;

    /* The upper twelve bits first, then the next twelve of those that are in the same bucket. */
    memset(count, 0, sizeof count);
    for (uint64_t v = 0; v < c->mesh.vertices; v += step) count[cost_bits(c->least[v]) >> 20]++;
    for (uint32_t i = 0; i < COST_BUCKETS; i++) {
        if (before + count[i] >= few && low == COST_BUCKETS) low = i;
        if (before + count[i] >= enough) {
            high = i;
            break;
        }
        before += count[i];
    }

    /* Nothing that costs far more than the cheapest ones goes before all of these have been tried. */
    bits = (low + 1) << 20;
    memcpy(&most, &bits, sizeof bits);
    most = DEARER * (most > COST_NOTHING ? most : COST_NOTHING);
    if (low < COST_BUCKETS && most < COLLAPSE_NEVER && high > cost_bits(most) >> 20) {
        high = cost_bits(most) >> 20;
        before = 0;
        for (uint32_t i = 0; i < high; i++) before += count[i];
    }
    memset(count, 0, sizeof count);
    for (uint64_t v = 0; v < c->mesh.vertices; v += step) {
        bits = cost_bits(c->least[v]);
        if (bits >> 20 == high && c->least[v] < COLLAPSE_NEVER) count[bits >> 8 & (COST_BUCKETS - 1)]++;
    }
    bits = high << 20 | 0xfffff;
    for (uint32_t i = 0; i < COST_BUCKETS; i++) {
        before += count[i];
        if (before < enough) continue;
        bits = high << 20 | i << 8 | 0xff;
        break;
    }
    memcpy(&s->threshold, &bits, sizeof bits);
    if (!(s->threshold < COLLAPSE_NEVER)) s->threshold = 0.5f * COLLAPSE_NEVER;
    s->candidates = before * step;
}

typedef struct range_job {
    collapse_sweep *s;
    collapse_range *ranges;
} range_job;

static void range_piece(void *user, int32_t index, int32_t worker)
{
    const range_job *const job = user;
    const collapse_sweep *const s = job->s;
    collapse_range *const r = &job->ranges[index];
    const bvxi_collapse *const c = s->c;
    uint64_t const begin = (uint64_t)index * s->size;
    uint64_t const end = begin + s->size < c->mesh.vertices ? begin + s->size : c->mesh.vertices;
    uint64_t candidates = 0, quota;
    (void)worker;

    /* Each range has its part of what is needed, so that all of them together take no more. */
    for (uint64_t v = begin; v < end; v++) candidates += c->least[v] <= s->threshold;
    quota = (uint64_t)((double)s->needed * (double)candidates / (double)s->candidates);
    for (uint64_t v = begin; v < end && r->collapsed < quota; v++) {
        /* Memory that the next ones need is requested before its turn. */
        if (v + SWEEP_AHEAD < end && c->least[v + SWEEP_AHEAD] <= s->threshold) {
            BVXI_PREFETCH(&c->mesh.at[v + SWEEP_AHEAD]);
            BVXI_PREFETCH(&c->mesh.triangle[(uint32_t)c->edge[v + SWEEP_AHEAD] >> 2]);
        }
        if (c->least[v] <= s->threshold) try_vertex(s, r, index, (uint32_t)v);
    }
}

static void take_range(bvxi_collapse *c, const collapse_range *r)
{
    c->mesh.left -= r->triangles;
    c->alive -= r->collapsed;
    c->counts.collapsed += r->collapsed;
    c->counts.link += r->counts.link;
    c->counts.turned += r->counts.turned;
    c->counts.needle += r->counts.needle;
    c->counts.crossed += r->counts.crossed;
    c->counts.crumpled += r->counts.crumpled;
    c->refused += r->counts.link + r->counts.turned + r->counts.needle + r->counts.crossed +
                  r->counts.crumpled;
}

static bvx_status sweep_ranges(collapse_sweep *s)
{
    bvxi_collapse *const c = s->c;
    uint64_t ranges, bytes, collapsed = 0;
    range_job job = {s, NULL};

    s->size = (c->mesh.vertices + RANGE_MOST - 1) / RANGE_MOST;
    if (s->size < RANGE_VERTICES) s->size = RANGE_VERTICES;
    ranges = (c->mesh.vertices + s->size - 1) / s->size;
    bytes = ranges * sizeof *job.ranges;
    BVXI_TRY(bvxi_alloc_zero(c->ctx, BVXI_SCRATCH, bytes, "the ranges of collapses", &job.ranges));

    for (uint64_t i = 0; i < ranges; i++) job.ranges[i].order = c->order;
    bvxi_tasks(c->ctx, (int32_t)ranges, range_piece, &job);
    for (uint64_t i = 0; i < ranges; i++) {
        take_range(c, &job.ranges[i]);
        collapsed += job.ranges[i].collapsed;
    }
    c->order += (uint32_t)collapsed;
    bvxi_drop(c->ctx, job.ranges);
    return BVX_OK;
}

bvx_status bvxi_collapse_sweep(bvxi_collapse *c, uint64_t target, int idle, uint64_t *done)
{
    uint64_t const begun = c->counts.collapsed;
    uint64_t const share = idle > 1 ? c->alive : (uint64_t)((double)c->alive * SWEEP_SHARE) + 1;
    collapse_sweep s = {.c = c, .left = c->mesh.left, .needed = (c->mesh.left - target + 1) / 2};
    uint64_t const wanted = (2 * s.needed) << idle;
    collapse_range *r;
    int ranged;

    /* After sweeps in vain more edges are tried, in the end all, since the cheapest ones are refused. */
    choose_threshold(&s, wanted < share ? wanted : share);

    /* Before edges that cost far more those that were refused are looked at anew. */
    if (s.threshold > DEARER * c->reached && c->refused != 0) {
        BVXI_TRY(bvxi_collapse_evaluate(c));
        c->refused = 0;
        choose_threshold(&s, wanted < share ? wanted : share);
    }
    if (s.threshold > c->reached) c->reached = s.threshold;
    *done = 0;
    if (s.candidates == 0) return BVX_OK;
    ranged = c->tree.node[0] == NULL && s.needed >= RANGE_COLLAPSES && c->mesh.vertices >= 2 * RANGE_VERTICES;
    if (ranged) BVXI_TRY(sweep_ranges(&s));

    /* What reaches over the ranges' borders, or all. */
    BVXI_TRY(bvxi_alloc_zero(c->ctx, BVXI_SCRATCH, sizeof *r, "the range of collapses", &r));
    r->order = c->order;
    for (uint64_t v = 0; v < c->mesh.vertices && c->mesh.left > target + r->triangles; v++) {
        if (!(c->least[v] <= s.threshold) || (ranged && !c->waits[v])) continue;
        try_vertex(&s, r, RANGE_ALL, (uint32_t)v);
    }
    if (ranged) memset(c->waits, 0, (size_t)c->mesh.vertices);
    c->order = r->order;
    take_range(c, r);
    bvxi_drop(c->ctx, r);
    *done = c->counts.collapsed - begun;
    return BVX_OK;
}

/* ---- Undoing ---- */

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
        m->triangle[t->opposite[k] >> 2].opposite[t->opposite[k] & 3] = (corner & ~3) + k;
    }
    m->left += !bvxi_corner_is_ghost(m, corner);
}

static void move_quadric(bvxi_collapse *c, uint32_t u, const double p[3])
{
    bvxi_corner_vertex *const at = &c->mesh.at[u];
    edge_plan plan = {.u = u};

    memcpy(plan.q.a, at->a, sizeof at->a);
    memcpy(plan.q.b, at->b, sizeof at->b);
    plan.q.c = at->c;
    settle_vertex(c, &plan, p);
}

/* The costs of all edges around a vertex, and the cheapest of it and its neighbours. */
static void renew_vertex(bvxi_collapse *c, uint32_t v)
{
    bvxi_corners *const m = &c->mesh;
    int32_t at = c->any[v];

    do {
        int32_t const edge = bvxi_corner_previous(at);

        put_cost(m, edge, cost_of(c, edge));
        at = bvxi_corner_turn_left(m, at);
    } while (at != c->any[v]);
    do {
        uint32_t const w = bvxi_corner_vertex_of(m, bvxi_corner_next(at));

        if (w != BVXI_VERTEX_GHOST) find_least(c, w);
        at = bvxi_corner_turn_left(m, at);
    } while (at != c->any[v]);
    find_least(c, v);
}

static void undo_one(bvxi_collapse *c, uint32_t v)
{
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
    move_quadric(c, u, undo->p);
    c->any[u] = bvxi_corner_next(edge);
    c->any[v] = bvxi_corner_previous(edge);
    c->last[u] = undo->before;
    c->edge[v] = -1;
    c->fresh[u] = c->fresh[v] = 1;
    c->alive++;
    renew_vertex(c, u);
    renew_vertex(c, v);
}

uint32_t bvxi_collapse_undo(bvxi_collapse *c, uint32_t v)
{
    uint32_t next;

    /* What it went into may be gone itself: that came later. */
    while (bvxi_collapse_is_gone(c, c->undo[v].stayed)) v = c->undo[v].stayed;

    /* The last one of those that touch it; their order rises, so that this ends. */
    while ((next = latest_around(c, c->undo[v].stayed)) != v) v = next;
    undo_one(c, v);
    return v;
}

void bvxi_collapse_undo_since(bvxi_collapse *c, uint32_t order)
{
    for (uint32_t v = 0; v < c->mesh.vertices; v++)
        while (bvxi_collapse_is_gone(c, v) && c->undo[v].order >= order) bvxi_collapse_undo(c, v);
}
