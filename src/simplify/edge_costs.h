/* edge_costs.h - where an edge would collapse to, and what that costs. Only simplify/ includes this. Not installed. */
#ifndef BVXI_EDGE_COSTS_H
#define BVXI_EDGE_COSTS_H

#include "simplify/collapse_state.h"

/* A d + b: half the gradient at d. */
static inline void bvxi_half_gradient(const bvxi_quadric *q, const double d[3], double g[3])
{
    g[0] = q->a[0] * d[0] + q->a[1] * d[1] + q->a[2] * d[2] + q->b[0];
    g[1] = q->a[1] * d[0] + q->a[3] * d[1] + q->a[4] * d[2] + q->b[1];
    g[2] = q->a[2] * d[0] + q->a[4] * d[1] + q->a[5] * d[2] + q->b[2];
}

static inline double bvxi_quadric_at(const bvxi_quadric *q, const double d[3])
{
    double g[3], value;
    bvxi_half_gradient(q, d, g);
    value = (g[0] + q->b[0]) * d[0] + (g[1] + q->b[1]) * d[1] + (g[2] + q->b[2]) * d[2] + q->c;
    return value > 0 ? value : 0;
}

/* The sum of both vertices' quadrics about u; offset leads from u to v. */
BVXI_VECTOR_INLINE void bvxi_quadrics_join(const bvxi_quadric *u, const bvxi_quadric *v,
                                           const double offset[3], bvxi_quadric *q)
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

/* Of the trace: a pivot within rounding is a direction that no plane fixes. */
#define SOLVE_LEAST 1e-13

/* Solve A d = -b by elimination; 0: A is singular within rounding. A is symmetric and not negative, so each pivot
 * bounds its row, and none need be chosen. Where no plane fixes a direction the caller takes an end of the edge,
 * which lies on the surface. NaN fails the comparison too. */
static inline int bvxi_quadric_solve(const double a[6], const double b[3], double d[3])
{
    double const least = (a[0] + a[3] + a[5]) * SOLVE_LEAST;
    double const by_x = 1 / a[0], to_y = a[1] * by_x, to_z = a[2] * by_x;
    double const y = a[3] - to_y * a[1], yz = a[4] - to_y * a[2], by_y = 1 / y, y_to_z = yz * by_y;
    double const z = (a[5] - to_z * a[2]) - y_to_z * yz, right_y = to_y * b[0] - b[1];
    if (!((a[0] > least) & (y > least) & (z > least))) return 0;
    d[2] = ((to_z * b[0] - b[2]) - y_to_z * right_y) / z;
    d[1] = right_y * by_y - y_to_z * d[2];
    d[0] = ((0 - b[0] * by_x) - to_y * d[1]) - to_z * d[2];
    return 1;
}

/* 1: further at d from the planes, by the mean square over their area, than so many mean edges of a mesh of so many
 * triangles. Both sides are multiplied by that count and the trace, so that nothing is divided by an area of 0. */
static inline int bvxi_quadric_is_far(const bvxi_collapse *c, const bvxi_quadric *q, const double d[3],
                                      uint64_t triangles, double edges)
{
    return bvxi_quadric_at(q, d) * (double)triangles >
           edges * edges * EDGE_SQUARE * c->area * (q->a[0] + q->a[3] + q->a[5]);
}

/* How an edge would collapse. */
typedef struct bvxi_edge_planned {
    int32_t edge;     /* corner opposite to it, with u next and v previous */
    uint32_t u, v;    /* the vertex that stays, and the one that goes */
    int32_t still;    /* 1: u stays where it is */
    int32_t pinches;  /* 1: two lines meet in u from then on */
    bvxi_quadric q;   /* of both, about u */
    bvxi_quadric all; /* and what their attributes cost */
    double offset[3]; /* from u to v */
    double d[3];      /* the new position from u, in units of 1 / scale */
    double cost;
} bvxi_edge_planned;

/* Plan the collapse of the edge opposite to a corner; 0: its ends may meet nowhere. */
int bvxi_edge_plan(const bvxi_collapse *c, int32_t edge, bvxi_edge_planned *plan);
/* Put what edges from corners of u to the next vertices, w, cost beside them; COLLAPSE_NEVER where they may not. */
void bvxi_edges_evaluate(bvxi_collapse *c, uint32_t u, const uint32_t *w, const int32_t *from, int32_t count);
/* The same for all edges of u; stale: of those to stale vertices of higher index. */
void bvxi_edges_around(bvxi_collapse *c, uint32_t u, int stale);
/* 1: the triangles of the star keep their sides, and their shapes, when their vertex moves to p. */
int bvxi_edge_judge_shapes(const bvxi_collapse *c, const bvxi_edge_planned *plan, const collapse_star *star,
                           const double *p, int needles);
/* Find the cheapest edge of a vertex, by the costs beside them. */
void bvxi_edge_find_least(bvxi_collapse *c, uint32_t v);
/* Move the vertex that stays to p, with the quadric of both. */
void bvxi_edge_settle(bvxi_collapse *c, const bvxi_edge_planned *plan, const double *p);

/* Of the edge from a corner to the next one, which both of its triangles have. */
static inline void bvxi_edge_put_cost(bvxi_corners *m, int32_t from, float cost)
{
    int32_t const back = bvxi_corner_turn_left(m, bvxi_corner_next(from));
    m->triangle[(uint32_t)from >> 2].cost[from & 3] = cost;
    m->triangle[(uint32_t)back >> 2].cost[back & 3] = cost;
}

static inline float bvxi_edge_cost(const bvxi_corners *m, int32_t from)
{
    return m->triangle[(uint32_t)from >> 2].cost[from & 3];
}

#endif
