/* settle_level.c - vertices of a level move to where its triangles lie nearest to the mesh.
 *
 * Source: Hoppe, DeRose, Duchamp, McDonald, Stuetzle. Mesh Optimization. 1993 (vertices by squared distances of
 * points of the mesh); Hunter, Lange. A Tutorial on MM Algorithms. 2004 (one step for all of them at once).
 *
 * Planes meet outside of what curves: quadrics leave vertices where the triangles between them lie too far in, or
 * out. Some of the mesh's triangles ask the level's triangles around the vertex that they went into; each vertex
 * takes the step that its part of them asks for. What turns or flattens a triangle goes back, and what crosses,
 * when the level is judged. */
#include "core/vec3.h"
#include "mesh/view.h"
#include "simplify/edge_costs.h"

/* Of the way to what is enclosed. */
#define SETTLE_INWARD 0.8
/* Cosine's square: all that is round goes to one edge there, and may turn to that. */
#define SETTLE_UPRIGHT 0.01
/* Of a vertex's sum of squares along all axes: how it is held where no distance asks for a step. */
#define SETTLE_HELD 0.03

enum {
    SETTLE_WANTED = 8, /* triangles of the mesh for each vertex, */
    SETTLE_LEAST = 5,  /* and fewer tell too little */
    SETTLE_LOOKS = 4,  /* around vertices, until none is nearer */
    SETTLE_HALVES = 4,
    SETTLE_MOST = 1 << 18,  /* of them in all */
    SETTLE_BATCH = 1 << 11, /* are asked at once */
    SETTLE_GRAIN = 1 << 8,  /* of a task */
};

/* What one triangle of the mesh asks for: weights of the corners of one of the level's, and a way along its normal. */
typedef struct settle_asked {
    int32_t triangle;
    double share[3], n[3], way;
} settle_asked;

/* Its corners, and the point of it that is nearest. */
typedef struct settle_near {
    double corner[3][3], q[3], square;
} settle_near;

typedef struct settle_level {
    const bvxi_collapse *c;
    settle_asked *asked;
    uint64_t first, count, step; /* of the batch */
} settle_level;

/* Look for nearer triangles around a vertex; returns the corner nearest to the point of the one that was found. */
static uint32_t look_near(const bvxi_collapse *c, uint32_t u, const double p[3], settle_asked *a,
                          settle_near *near)
{
    const bvxi_corners *const m = &c->mesh;
    uint32_t best = BVXI_VERTEX_NONE;
    double least = 0;
    int32_t at = c->any[u];

    do {
        const uint32_t *const v = m->triangle[at >> 2].vertex;
        double t[3][3], q[3], square;

        if (!bvxi_corner_is_ghost(m, at)) {
            for (int k = 0; k < 3; k++) memcpy(t[k], m->at[v[k]].p, sizeof t[k]);
            square = bvxi_closest_on_triangle(p, (const double(*)[3])t, q);
            if (a->triangle < 0 || square < near->square) {
                a->triangle = at >> 2;
                near->square = square;
                memcpy(near->q, q, sizeof q);
                memcpy(near->corner, t, sizeof t);
            }
        }
        at = bvxi_corner_turn_left(m, at);
    } while (at != c->any[u]);

    for (int k = 0; k < 3 && a->triangle >= 0; k++) {
        double const square = bvxi_vec_distance2(near->corner[k], p);

        if (best == BVXI_VERTEX_NONE || square < least) {
            least = square;
            best = m->triangle[a->triangle].vertex[k];
        }
    }
    return best;
}

static void settle_piece(void *user, int32_t piece)
{
    const settle_level *const l = user;
    uint64_t begin, end;
    bvxi_piece(l->count, bvxi_piece_count(l->count, SETTLE_GRAIN), piece, &begin, &end);
    for (uint64_t i = begin; i < end; i++) {
        const bvxi_collapse *const c = l->c;
        settle_asked *const a = &l->asked[i];
        uint64_t const t = (l->first + i) * l->step;
        const uint32_t *const v = c->origin + 3 * t;
        uint32_t u = BVXI_VERTEX_NONE, next = bvxi_collapse_now(c, v[t % 3]);
        settle_near near = {.square = 0};
        double p[3][3], middle[3], own[3], square;

        for (int k = 0; k < 3; k++) bvxi_view_position(c->view, c->first_source[v[k]], p[k]);
        for (int k = 0; k < 3; k++) middle[k] = (p[0][k] + p[1][k] + p[2][k]) / 3;
        a->triangle = -1;
        for (int look = 0; look < SETTLE_LOOKS && next != u; look++) {
            u = next;
            next = look_near(c, u, middle, a, &near);
        }
        bvxi_area_normal(p[0], p[1], p[2], own);
        bvxi_area_normal(near.corner[0], near.corner[1], near.corner[2], a->n);
        square = bvxi_vec_dot(a->n, a->n);

        /* A triangle without an area, or that faces the other way, asks for nothing. */
        if (!(square > 0) || !(bvxi_vec_dot(own, a->n) > 0)) a->triangle = -1;
        a->way = 0;
        for (int k = 0; k < 3 && a->triangle >= 0; k++) {
            double part[3];

            bvxi_area_normal(near.q, near.corner[(k + 1) % 3], near.corner[(k + 2) % 3], part);
            a->share[k] = bvxi_vec_length(own) * bvxi_vec_dot(part, a->n) / square;
            if (!(a->share[k] > 0)) a->share[k] = 0;
            a->n[k] /= sqrt(square);
            a->way += a->n[k] * (middle[k] - near.q[k]);
        }
    }
}

static void move_vertex(bvxi_collapse *c, uint32_t v, const double p[3])
{
    double way[3];
    for (int k = 0; k < 3; k++) way[k] = (p[k] - c->mesh.at[v].p[k]) * c->scale;
    if (c->attributes.row != NULL) bvxi_attributes_move(c, c->attributes.row[c->any[v]], way, NULL, 0);
    bvxi_collapse_move_quadric(c, v, p);
}

void bvxi_collapse_unsettle(bvxi_collapse *c, uint32_t v)
{
    const double *const from = c->undo[v].p;
    double p[3];
    for (int k = 0; k < 3; k++) p[k] = bvxi_collapse_rounded(c, 0.5 * (c->mesh.at[v].p[k] + from[k]));
    c->settled[v] = c->settled[v] < SETTLE_HALVES ? c->settled[v] + 1 : 0;
    move_vertex(c, v, c->settled[v] != 0 ? p : from);
}

static void settle_at(bvxi_collapse *c, uint32_t v, const double at[3])
{
    double p[3];
    for (int k = 0; k < 3; k++) p[k] = bvxi_collapse_rounded(c, at[k]);
    /* Where it was waits where a vertex that is gone has what undoes that. */
    memcpy(c->undo[v].p, c->mesh.at[v].p, sizeof p);
    c->settled[v] = c->fresh[v] = 1;
    move_vertex(c, v, p);
}

static void settle_vertex(bvxi_collapse *c, uint32_t v, bvxi_quadric *q)
{
    double const held = SETTLE_HELD * (q->a[0] + q->a[3] + q->a[5]);
    double d[3];
    q->a[0] += held;
    q->a[3] += held;
    q->a[5] += held;
    if (!bvxi_quadric_solve(q->a, q->b, d)) return;
    for (int k = 0; k < 3; k++) d[k] += c->mesh.at[v].p[k];
    settle_at(c, v, d);
}

/* 1: a triangle has other corners than before, which turn it or take its area. */
static int is_turned(const bvxi_collapse *c, const uint32_t *v)
{
    const double *p[3], *before[3];
    double n[3], n_before[3], cosine, squares;

    if ((c->settled[v[0]] | c->settled[v[1]] | c->settled[v[2]]) == 0) return 0;
    for (int k = 0; k < 3; k++) {
        p[k] = c->mesh.at[v[k]].p;
        before[k] = c->settled[v[k]] ? c->undo[v[k]].p : p[k];
    }
    bvxi_area_normal(p[0], p[1], p[2], n);
    bvxi_area_normal(before[0], before[1], before[2], n_before);
    cosine = bvxi_vec_dot(n, n_before);
    squares = bvxi_vec_dot(n, n) * bvxi_vec_dot(n_before, n_before);
    return !(cosine > 0 && cosine * cosine > (c->options.enclosed != NULL ? SETTLE_UPRIGHT : 0.5) * squares);
}

/* Each vertex where its part of what is asked says. */
static bvx_status settle_nearest(bvxi_collapse *c)
{
    const bvxi_corners *const m = &c->mesh;
    uint64_t const most = SETTLE_WANTED * c->alive < SETTLE_MOST ? SETTLE_WANTED * c->alive : SETTLE_MOST;
    uint64_t const step = (c->first_triangles + most - 1) / most;
    bvxi_quadric *sum;

    /* Borders of open meshes keep their attributes where these have a say. */
    if (c->options.sheets || c->options.farthest || c->options.given.vertices == BVX_VERTICES_KEPT ||
        (c->attributes.channels > 0 && c->options.given.attribute_weight > 0 && m->ghosts != 0) ||
        c->first_triangles < step * SETTLE_LEAST * c->alive)
        return BVX_OK;
    BVXI_TRY(bvxi_alloc_zero(c->ctx, BVXI_SCRATCH, m->vertices * sizeof *sum, "the vertices' steps", &sum));

    /* Every corner's part of what is asked, in the order of the mesh. Shares add up to one, so that their
     * steps together are no further from what is asked than before. */
    uint64_t const total = (c->first_triangles + step - 1) / step;
    settle_level l = {.c = c, .step = step};

    BVXI_TRY(bvxi_alloc(c->ctx, BVXI_SCRATCH, SETTLE_BATCH * sizeof *l.asked, "what is asked", &l.asked));
    for (; l.first < total; l.first += l.count) {
        l.count = total - l.first < SETTLE_BATCH ? total - l.first : SETTLE_BATCH;
        bvxi_tasks(c->ctx, bvxi_piece_count(l.count, SETTLE_GRAIN), settle_piece, &l);
        for (const settle_asked *a = l.asked; a < l.asked + l.count; a++)
            for (int k = 0; k < 3 && a->triangle >= 0; k++) {
                bvxi_quadric *const q = &sum[c->mesh.triangle[a->triangle].vertex[k]];
                int index = 0;

                for (int i = 0; i < 3; i++) {
                    for (int j = i; j < 3; j++) q->a[index++] += a->share[k] * a->n[i] * a->n[j];
                    q->b[i] -= a->share[k] * a->way * a->n[i];
                }
            }
    }

    for (uint32_t v = 0; v < m->vertices; v++)
        if (!bvxi_collapse_is_gone(c, v) && c->kind[v] == 0) settle_vertex(c, v, &sum[v]);
    return BVX_OK;
}

bvx_status bvxi_collapse_settle(bvxi_collapse *c)
{
    const bvxi_corners *const m = &c->mesh;
    int turned = 1;

    if (c->options.enclosed != NULL) {
        /* Towards what the level encloses: what leaves it goes back by halves, when the level is judged. */
        uint32_t hint = 0;

        for (uint32_t v = 0; v < c->mesh.vertices; v++) {
            const double *const p = c->mesh.at[v].p;
            bvx_closest_point found;
            double to[3];

            if (bvxi_collapse_is_gone(c, v)) continue;
            bvxi_closest_ask(&c->options.enclosed->closest, p, &hint, &found);
            for (int k = 0; k < 3; k++) to[k] = p[k] + SETTLE_INWARD * (found.position[k] - p[k]);
            settle_at(c, v, to);
        }
    } else BVXI_TRY(BVXI_SCOPE(c->ctx, settle_nearest(c)));
    while (turned) {
        turned = 0;
        for (uint64_t t = 0; t < m->triangles; t++) {
            const uint32_t *const v = m->triangle[t].vertex;

            if (bvxi_triangle_gone(&m->triangle[t]) || !is_turned(c, v)) continue;
            for (int k = 0; k < 3; k++)
                if (c->settled[v[k]]) bvxi_collapse_unsettle(c, v[k]);
            turned = 1;
        }
    }
    return BVX_OK;
}
