/* collapse.c - fewer triangles at the least distance from the original: the cheapest edge goes first.
 *
 * Source: Garland, Heckbert. Surface Simplification Using Quadric Error Metrics. 1997; line quadrics after
 * Liu, Rahimzadeh, Zordan. Controlling Quadric Error Simplification with Line Quadrics. 2025.
 *
 * A vertex's quadric sums its triangles' squared distances to planes by area, and a small share of the
 * squared distance to the line along its normal, which keeps triangles even where planes leave a vertex free.
 * An edge's vertex goes where the sum of both ends' quadrics is least. After each halving the mesh is packed,
 * and the boxes and the queue are made anew, so that memory is walked in the order of space and edges that
 * were refused come back.
 *
 * Colours of vertices add a quadric of their own where they have a weight (colours.c).
 *
 * At borders planes are added that stand on the triangle along each border edge, so that borders keep their
 * place and corners.
 *
 * Guarantee: every state is closed where the mesh given was, edge- and vertex-manifold, oriented and, where
 * the mesh given was, without crossing triangles; sequential, doubles with + - x / sqrt alone: the same mesh
 * everywhere. */
#include "simplify/room.h"
#include "bits/sort.h"
#include "mesh/mesh.h"
#include "mesh/view.h"
#include "simplify/collapse_state.h"

#include <math.h>

/* How much later a refused edge is tried again. */
enum { COLLAPSE_LATER = 2 * BVXI_QUEUE_OCTAVE };

/* A vertex may lie so many mean edges from the planes that it stands for: up to 0.6 in levels that look like
 * what they were made from, 0.7 to 2.4 where parts that are thinner than the triangles are long crumple. */
#define CRUMPLED (2.0 / 3.0)
/* Of mean edge's square to a triangle's area, where all sides are equal. */
#define EDGE_SQUARE 2.309401076758503

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
static void join_quadrics(const bvxi_corner_vertex *u, const bvxi_corner_vertex *v, const double offset[3],
                          quadric *q)
{
    quadric other;
    double g[3];

    for (int i = 0; i < 6; i++) {
        other.a[i] = v->a[i];
        q->a[i] = u->a[i] + other.a[i];
    }

    /* About u the other one has b - A offset, and c - 2 b' offset + offset' A offset. */
    for (int i = 0; i < 3; i++) other.b[i] = -v->b[i];
    half_gradient(&other, offset, g);
    for (int i = 0; i < 3; i++) q->b[i] = u->b[i] - g[i];
    q->c = u->c + v->c;
    for (int i = 0; i < 3; i++) q->c += offset[i] * (g[i] + other.b[i]);
}

static void swap_values(double *a, double *b)
{
    double const was = *a;

    *a = *b;
    *b = was;
}

/* Solve A step = -g by elimination with the largest remaining diagonal first, which keeps small eigenvalues
 * apart from rounding; 0: A is singular within it. Rows are exchanged by name, so that nothing is indexed. */
static int solve_least(const double a[6], const double g[3], double step[3])
{
    double const least = (a[0] + a[3] + a[5]) * 1e-13;
    int const first = a[3] > a[0] ? a[5] > a[3] ? 2 : 1 : a[5] > a[0] ? 2 : 0;
    double xx = a[0], xy = a[1], xz = a[2], yy = a[3], yz = a[4], zz = a[5];
    double x = -g[0], y = -g[1], z = -g[2], to_y, to_z, zy;
    int exchanged;

    /* The largest diagonal becomes the first pivot. A is symmetric and not negative, so each pivot bounds its
     * row, and the rows need no pivoting of their own. */
    if (first == 1) {
        swap_values(&xx, &yy);
        swap_values(&xz, &yz);
        swap_values(&x, &y);
    } else if (first == 2) {
        swap_values(&xx, &zz);
        swap_values(&xy, &yz);
        swap_values(&x, &z);
    }

    /* A pivot within rounding of the trace is a direction that no plane fixes: then the caller takes an end
     * of the edge, which lies on the surface. NaN fails the comparison too. */
    if (!(xx > least)) return 0;
    to_y = xy / xx;
    to_z = xz / xx;
    yy -= to_y * xy;
    zz -= to_z * xz;
    exchanged = zz > yy;
    if (exchanged) {
        swap_values(&xy, &xz);
        swap_values(&to_y, &to_z);
        swap_values(&yy, &zz);
        swap_values(&y, &z);
    }
    if (!(yy > least)) return 0;

    y -= to_y * x;
    z -= to_z * x;
    zy = yz - to_z * xy;
    yz -= to_y * xz;
    to_z = zy / yy;
    zz -= to_z * yz;
    if (!(zz > least)) return 0;

    /* Back from the last unknown to the first, then the exchanges are undone. */
    z = (z - to_z * y) / zz;
    y = (y - yz * z) / yy;
    x = (x - xy * y - xz * z) / xx;
    if (exchanged) swap_values(&y, &z);
    step[0] = first == 0 ? x : first == 1 ? y : z;
    step[1] = first == 1 ? x : y;
    step[2] = first == 2 ? x : z;
    return 1;
}

/* Where the quadric is least, within reach of the middle; 0: planes do not fix a position there. */
static int least_point(const quadric *q, const double middle[3], double reach, double d[3])
{
    double g[3], step[3];

    half_gradient(q, middle, g);
    if (!solve_least(q->a, g, step)) return 0;

    /* Nearly parallel planes meet far away, exactly but uselessly: a vertex there would be a spike. */
    if (!(step[0] * step[0] + step[1] * step[1] + step[2] * step[2] <= reach)) return 0;
    for (int k = 0; k < 3; k++) d[k] = middle[k] + step[k];
    return 1;
}

static void offset_between(const bvxi_collapse *c, uint32_t u, uint32_t v, double offset[3])
{
    for (int k = 0; k < 3; k++) offset[k] = (c->mesh.at[v].p[k] - c->mesh.at[u].p[k]) * c->scale;
}

/* What both ends' colours cost about u, added to their quadric. */
static void add_colour_cost(const bvxi_collapse *c, uint32_t u, uint32_t v, quadric *q)
{
    bvxi_colour_quadric both;
    double offset[3];

    offset_between(c, u, v, offset);
    bvxi_colours_join(&c->colour[u], &c->colour[v], offset, &both);
    bvxi_colours_add(&both, q->a, q->b, &q->c);
}

/* The cost of an edge whose ends' quadric is q, at an offset from u. */
static double cost_at(const bvxi_collapse *c, uint32_t u, uint32_t v, const quadric *q, const double d[3])
{
    quadric all = *q;

    if (c->colour != NULL) add_colour_cost(c, u, v, &all);
    return quadric_at(&all, d);
}

/* Where an edge's ends would meet, as an offset from u, and what it costs. q becomes both ends' quadric about
 * u, of planes only. */
static double meeting_point(const bvxi_collapse *c, uint32_t u, uint32_t v, quadric *q, double d[3])
{
    double offset[3], middle[3], length = 0, at_u, at_v;
    const quadric *cost = q;
    quadric all;

    offset_between(c, u, v, offset);
    for (int k = 0; k < 3; k++) {
        middle[k] = 0.5 * offset[k];
        length += offset[k] * offset[k];
    }

    /* Everything is about u, near the edge: the same sums about the origin would cancel most of their
     * digits. */
    join_quadrics(&c->mesh.at[u], &c->mesh.at[v], offset, q);
    if (c->colour != NULL) {
        all = *q;
        add_colour_cost(c, u, v, &all);
        cost = &all;
    }
    if (least_point(cost, middle, 4 * length, d)) return quadric_at(cost, d);

    /* Where the planes leave it open: the better end, which stays on the surface. */
    at_u = cost->c;
    at_v = quadric_at(cost, offset);
    for (int k = 0; k < 3; k++) d[k] = at_v < at_u ? offset[k] : 0;
    return at_v < at_u ? at_v : at_u;
}

void bvxi_collapse_put(bvxi_collapse *c, int32_t corner)
{
    uint32_t const u = bvxi_corner_vertex_of(&c->mesh, bvxi_corner_next(corner));
    uint32_t const v = bvxi_corner_vertex_of(&c->mesh, bvxi_corner_previous(corner));
    bvxi_queue_entry entry;
    quadric q;
    double d[3];

    /* Cells of a parallel pass share their locked vertices with other workers, so these must stay as they
     * are. */
    if (c->locked != NULL && (c->locked[u] | c->locked[v]) != 0) return;

    /* The stamp is the sum of both versions: when either vertex changes, the entry no longer matches and is
     * dropped when it is met, so that nothing has to be found and removed in the queue. */
    entry.corner = corner;
    entry.stamp = c->version[u] + c->version[v];
    entry.bucket = bvxi_queue_bucket(meeting_point(c, u, v, &q, d));
    if (entry.bucket <= c->dearest) bvxi_queue_put(&c->queue, &entry);
}

int32_t bvxi_collapse_bucket(const bvxi_collapse *c, int32_t corner)
{
    uint32_t const u = bvxi_corner_vertex_of(&c->mesh, bvxi_corner_next(corner));
    uint32_t const v = bvxi_corner_vertex_of(&c->mesh, bvxi_corner_previous(corner));
    quadric q;
    double d[3];

    return bvxi_queue_bucket(meeting_point(c, u, v, &q, d));
}

/* ---- Collapsing ---- */

/* Take a triangle out from between its two other edges, which become one; corner is opposite to the
 * collapsing edge. */
static void drop_triangle(bvxi_collapse *c, int32_t corner)
{
    bvxi_corners *const m = &c->mesh;

    /* Neighbours are joined first: they are found through the triangle that goes. */
    bvxi_corners_join(m, bvxi_corner_opposite(m, bvxi_corner_next(corner)),
                      bvxi_corner_opposite(m, bvxi_corner_previous(corner)));
    m->triangle[corner >> 2].vertex[0] = BVXI_VERTEX_NONE;

    /* Triangles of the ghost vertex close borders. They are not of the mesh, so neither counted nor in the
     * boxes. */
    if (bvxi_corner_is_ghost(m, corner)) return;
    m->left--;
    bvxi_box_tree_remove(&c->boxes, corner >> 2);
}

/* Both ends' quadric, moved to the new position. */
static void settle_vertex(bvxi_collapse *c, const bvxi_star *star, const quadric *q)
{
    bvxi_corner_vertex *const at = &c->mesh.at[star->u];
    double d[3], g[3];

    if (c->colour != NULL) {
        bvxi_colour_quadric both;

        offset_between(c, star->u, star->v, d);
        bvxi_colours_join(&c->colour[star->u], &c->colour[star->v], d, &both);
        for (int k = 0; k < 3; k++) d[k] = (star->p[k] - at->p[k]) * c->scale;
        bvxi_colours_move(&both, d);
        c->colour[star->u] = both;
    }

    /* The quadric is kept about its own vertex, so it moves with it: A stays, b becomes half the gradient
     * there. */
    for (int k = 0; k < 3; k++) {
        d[k] = (star->p[k] - at->p[k]) * c->scale;
        at->p[k] = star->p[k];
    }
    half_gradient(q, d, g);
    for (int i = 0; i < 6; i++) at->a[i] = q->a[i];
    for (int i = 0; i < 3; i++) at->b[i] = g[i];
    at->c = quadric_at(q, d);
}

static void apply_star(bvxi_collapse *c, const bvxi_star *star, const quadric *q)
{
    bvxi_corners *const m = &c->mesh;
    uint32_t const u = star->u, v = star->v;
    int32_t const across = bvxi_corner_opposite(m, star->edge);

    /* Before anything is joined: the quadric's move needs the positions of both ends as they were. */
    settle_vertex(c, star, q);

    /* A version that neither end has had, or a stale entry of v could match the new vertex. */
    c->version[u] = (c->version[u] > c->version[v] ? c->version[u] : c->version[v]) + 1;
    drop_triangle(c, star->edge);
    drop_triangle(c, across);

    /* The star was judged with these boxes and facings, so what is stored is what was tested. */
    for (int32_t i = 0; i < star->count; i++) {
        m->triangle[star->corner[i] >> 2].vertex[star->corner[i] & 3] = u;
        if (i != star->ghost) m->facing[star->link[i]] = star->facing[i];
        if (!bvxi_corner_is_ghost(m, star->corner[i]))
            bvxi_box_tree_move(&c->boxes, star->corner[i] >> 2, &star->box[i], &star->faces[i]);
    }
    m->facing[u] = star->own_facing;

    /* The edge from the new vertex to each of its neighbours has another cost now. */
    for (int32_t i = 0; i < star->count; i++)
        if (i != star->ghost) bvxi_collapse_put(c, bvxi_corner_previous(star->corner[i]));
}

static int is_within(const bvxi_collapse *c, const double p[3])
{
    bvxi_box const at = bvxi_box_at(&c->boxes, p);
    int within = 1;

    for (int k = 0; k < 3; k++) within &= (at.low[k] >= c->bounds.low[k]) & (at.low[k] <= c->bounds.high[k]);
    return within;
}

/* Judge the star with its new vertex at an offset from u. */
static int judge_at(bvxi_collapse *c, const double d[3])
{
    bvxi_star *const star = &c->star;

    /* Rounded to the output's type before it is judged: the guarantee is of the positions that the caller
     * gets. */
    for (int k = 0; k < 3; k++)
        star->p[k] = bvxi_collapse_rounded(c, c->mesh.at[star->u].p[k] + d[k] / c->scale);
    if (c->locked != NULL && !is_within(c, star->p)) return BVXI_STAR_LINK;
    return bvxi_star_judge(&c->mesh, &c->boxes, star);
}

/* Where the best point is not safe, the ends and the middle may be, at no more than twice the cost. */
static int judge_elsewhere(bvxi_collapse *c, const quadric *q, int32_t bucket)
{
    const double *const from = c->mesh.at[c->star.u].p, *const to = c->mesh.at[c->star.v].p;

    for (int i = 0; i < 3; i++) {
        double d[3];

        for (int k = 0; k < 3; k++) d[k] = 0.5 * i * (to[k] - from[k]) * c->scale;
        if (bvxi_queue_bucket(cost_at(c, c->star.u, c->star.v, q, d)) <= bucket + BVXI_QUEUE_OCTAVE &&
            judge_at(c, d) == BVXI_STAR_SAFE)
            return BVXI_STAR_SAFE;
    }
    return BVXI_STAR_CROSSES;
}

/* 1 when the new vertex of the star would be further from its planes, by the mean square over their area,
 * than triangles of the mesh can show as it is now. Cells are far from that. */
static int is_crumpled(const bvxi_collapse *c, const quadric *q)
{
    double const trace = q->a[0] + q->a[3] + q->a[5];
    double d[3];

    if (c->locked != NULL) return 0;
    for (int k = 0; k < 3; k++) d[k] = (c->star.p[k] - c->mesh.at[c->star.u].p[k]) * c->scale;

    /* Both sides are multiplied by the count of triangles and the trace, so that nothing is divided by an
     * area of 0. */
    return quadric_at(q, d) * (double)c->mesh.left > CRUMPLED * CRUMPLED * EDGE_SQUARE * c->area * trace;
}

/* Collapse an edge where that is safe, else put it back among those that cost four times as much. */
void bvxi_collapse_try(bvxi_collapse *c, bvxi_queue_entry *entry)
{
    const bvxi_corners *const m = &c->mesh;
    uint32_t u, v;
    quadric q;
    int verdict = BVXI_STAR_LINK;

    /* Entries are never removed from the queue; what an earlier collapse took or changed is skipped here. */
    if (bvxi_corner_gone(m, entry->corner)) return;
    u = bvxi_corner_vertex_of(m, bvxi_corner_next(entry->corner));
    v = bvxi_corner_vertex_of(m, bvxi_corner_previous(entry->corner));
    if (entry->stamp != c->version[u] + c->version[v]) return;

    if (bvxi_star_gather(m, entry->corner, &c->star)) {
        double d[3];

        /* What was refused once may leave needles: thin plates cannot do without. */
        c->star.needles = bvxi_queue_bucket(meeting_point(c, u, v, &q, d)) < entry->bucket;
        verdict = judge_at(c, d);
        if (verdict != BVXI_STAR_SAFE && judge_elsewhere(c, &q, entry->bucket) == BVXI_STAR_SAFE)
            verdict = BVXI_STAR_SAFE;
        if (verdict == BVXI_STAR_SAFE && is_crumpled(c, &q)) verdict = BVXI_STAR_CRUMPLES;
    }
    if (verdict == BVXI_STAR_SAFE) {
        c->counts.collapsed++;
        apply_star(c, &c->star, &q);
        return;
    }

    c->counts.link += verdict == BVXI_STAR_LINK;
    c->counts.turned += verdict == BVXI_STAR_TURNS;
    c->counts.needle += verdict == BVXI_STAR_NEEDLE;
    c->counts.crossed += verdict == BVXI_STAR_CROSSES;
    c->counts.crumpled += verdict == BVXI_STAR_CRUMPLES;

    /* A refused edge may be safe after its neighbours have gone, so it comes back later, until it costs more
     * than any that the target needs. */
    entry->bucket += COLLAPSE_LATER;
    if (entry->bucket <= c->dearest) bvxi_queue_put(&c->queue, entry);
}
