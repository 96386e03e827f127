/* closest_query.c - nearest points of a mesh for many points, with the place in their triangle.
 *
 * The search (closest.c) gives the least (squared distance, triangle index) of bvxi_closest_on_triangle over
 * all triangles, whatever its tree and hint, so neither pieces nor threads show. The feature is read off the
 * point found: a corner when it has that corner's coordinates, an edge when it is what that edge's own
 * formula gives for the asked point, the face otherwise. The feature decides the weights: a corner has weight
 * 1 and the others 0, on an edge the two are 1 - s and s, on the face they are the parts of the squared area
 * that the evaluation divided by. So none is negative.
 *
 * All is computed in units of a power of two in which the mesh lies within [-1, 1]; going there and back is
 * exact but for numbers below a double's normal range. A point more than 2^300 of these units away would
 * overflow when squared: it is moved towards the origin by a power of two. As far out as 2^54 units the mesh
 * is less than a rounding in the point, all triangles may tie, and the answer is the one of least number: the
 * distance is right, the position is some point of the mesh. A distance above the largest double is
 * infinity. */
#include "nearest/closest.h"
#include "bits/sort.h"
#include "core/vec3.h"
#include "mesh/mesh.h"
#include "mesh/view.h"

#include <math.h>

enum {
    QUERY_GRAIN = 64,        /* least points a piece, so that the hint has something to warm */
    QUERY_BITS = 16,         /* of the curve along each axis */
    QUERY_TOGETHER = 1 << 16 /* points that are put in order together */
};

/* ---- The place in the triangle ---- */

/* Is q the nearest point to p inside the edge from a to b, as point_triangle.c has it? *s: its share of b. */
static int is_on_query_edge(const double p[3], const double a[3], const double b[3], const double q[3],
                            double *s)
{
    double u[3], along = 0.0, length2 = 0.0;
    /* The same operations in the same order as the evaluation, so that equal means equal bits. */
    for (int k = 0; k < 3; k++) {
        u[k] = b[k] - a[k];
        along += u[k] * (p[k] - a[k]);
        length2 += u[k] * u[k];
    }
    /* Ends belong to corners, which were looked at before. */
    if (!(along > 0.0) || along >= length2) return 0;
    *s = along / length2;
    return a[0] + *s * u[0] == q[0] && a[1] + *s * u[1] == q[1] && a[2] + *s * u[2] == q[2];
}

void bvxi_closest_place(const double p[3], const double t[3][3], const double q[3], bvx_closest_point *found)
{
    static const int32_t edge[4][3] = {{0, 1, 1}, {1, 2, 2}, {0, 2, 3}, {2, 0, 3}}; /* from, to, feature */
    double s;

    memset(found->weight, 0, sizeof found->weight);

    /* Corners first: at a corner the formulas of both edges would agree as well. */
    for (int32_t k = 0; k < 3; k++) {
        if (q[0] != t[k][0] || q[1] != t[k][1] || q[2] != t[k][2]) continue;
        found->weight[k] = 1.0;
        found->feature = 4 + k;
        return;
    }

    /* The third edge is asked both ways, as the evaluation may have gone either. */
    for (int32_t e = 0; e < 4; e++) {
        if (!is_on_query_edge(p, t[edge[e][0]], t[edge[e][1]], q, &s)) continue;
        found->weight[edge[e][0]] = 1.0 - s;
        found->weight[edge[e][1]] = s;
        found->feature = edge[e][2];
        return;
    }

    /* The projection of p, which lies inside: va, vb and vc are above 0 there. */
    double ab[3], ac[3], ap[3], n[3], nb[3], nc[3];

    for (int k = 0; k < 3; k++) {
        ab[k] = t[1][k] - t[0][k];
        ac[k] = t[2][k] - t[0][k];
        ap[k] = p[k] - t[0][k];
    }

    /* Weights are the areas of the parts that the projection cuts the triangle into. */
    bvxi_vec_cross(ab, ac, n);
    bvxi_vec_cross(ap, ac, nb);
    bvxi_vec_cross(ab, ap, nc);
    double const area2 = bvxi_vec_dot(n, n), vb = bvxi_vec_dot(nb, n), vc = bvxi_vec_dot(nc, n);
    found->weight[0] = (area2 - vb - vc) / area2;
    found->weight[1] = vb / area2;
    found->weight[2] = vc / area2;
    found->feature = 0;
}

/* ---- One point ---- */

/* The power of two for a point: the tree's, or less where the point is too far away to be squared. */
static double query_scale(const bvxi_closest_tree *tree, const double point[3])
{
    double largest = 0.0, s = tree->scale;
    /* The farthest axis decides, on either side of the origin. */
    for (int a = 0; a < 3; a++) {
        largest = point[a] > largest ? point[a] : largest;
        largest = -point[a] > largest ? -point[a] : largest;
    }
    while (largest * s > 0x1p300) s *= 0.5; /* Squares stay finite; a power of two changes no digit. */
    return s;
}

void bvxi_closest_ask(const bvx_closest *closest, const double point[3], uint32_t *hint,
                      bvx_closest_point *found)
{
    const bvxi_closest_tree *const tree = &closest->tree;
    double const s = query_scale(tree, point);
    double const p[3] = {point[0] * s, point[1] * s, point[2] * s};
    bvxi_closest nearest;
    double t[3][3];

    /* The last answer is a hint: of neighbouring points the nearest triangles are neighbours. */
    bvxi_closest_find(tree, p, *hint, &nearest);
    bvxi_closest_corners(tree, nearest.place, t);
    for (int a = 0; a < 3; a++) found->position[a] = nearest.point[a] / tree->scale;
    found->distance = sqrt(nearest.distance2) / s;
    found->triangle = nearest.triangle;
    bvxi_closest_place(p, (const double(*)[3])t, nearest.point, found);
    *hint = nearest.place;
}

double bvxi_closest_bound(const bvx_closest *closest, const double *const point[3], uint32_t hint)
{
    double t[3][3], q[3], bound = 0.0;

    bvxi_closest_corners(&closest->tree, hint, t);
    /* The distance from what is convex is largest at a corner. */
    for (int k = 0; k < 3; k++) {
        double const s = query_scale(&closest->tree, point[k]);
        double const p[3] = {point[k][0] * s, point[k][1] * s, point[k][2] * s};
        double const d = sqrt(bvxi_closest_on_triangle(p, (const double(*)[3])t, q)) / s;
        bound = d > bound ? d : bound;
    }
    return bound;
}

/* ---- Made ready and released ---- */

bvx_status bvxi_closest_open(bvxi_call call, const bvx_mesh_view *mesh, bvx_closest *closest)
{
    double low[3], high[3];
    BVXI_TRY(bvxi_view_check(call.ctx, call.function, mesh));
    BVXI_TRY(bvxi_view_bounds(call.ctx, call.function, mesh, low, high));
    return bvxi_closest_build(call, mesh, low, high, bvxi_unit_scale(low, high), &closest->tree);
}

void bvxi_closest_shut(bvx_context *ctx, bvx_closest *closest)
{
    bvxi_closest_free(ctx, &closest->tree);
}

static bvx_status run_closest_create(bvx_context *context, const bvx_mesh_view *mesh, bvx_closest **closest)
{
    static const char *const function = "bvx_closest_create";
    bvx_closest *made = NULL;
    if (closest == NULL) return bvxi_fail_null(context, function, "closest");
    *closest = NULL;
    /* What has been taken since the mark is given to the object when all went well. */
    uint64_t const mark = bvxi_scratch_begin(context);
    BVXI_TRY(bvxi_alloc(context, BVXI_SCRATCH, sizeof *made, "the search tree's head", &made));
    BVXI_TRY(bvxi_closest_open(bvxi_call_of(context, function, "search tree", 0.0, 1.0), mesh, made));
    bvxi_scratch_adopt(context, mark);
    *closest = made;
    return BVX_OK;
}

bvx_status bvx_closest_create(bvx_context *context, const bvx_mesh_view *mesh, bvx_closest **closest)
{
    return BVXI_CALL(context, run_closest_create(context, mesh, closest));
}

void bvx_closest_free(bvx_context *context, bvx_closest *closest)
{
    if (context == NULL || closest == NULL) return;
    bvxi_closest_shut(context, closest);
    bvxi_free(context, closest, sizeof *closest);
}

/* ---- Many points ---- */

/* Points are taken in the order of a curve through space: the answer to one is a good hint for the next, and
 * what it read is at hand. Results stand in the order that was requested. */
typedef struct closest_query {
    const bvx_closest *closest;
    const double *points;
    bvx_closest_point *found;
    uint64_t count;
    uint64_t *keys;  /* of points, then used up */
    uint32_t *order; /* of points, or NULL: as they come */
    double low[3], scale[3];
} closest_query;

static void find_closest_piece(void *user, uint64_t begin, uint64_t end)
{
    const closest_query *const q = user;
    uint32_t hint = 0;
    /* The hint is the piece's own: threads share nothing that is written. */
    for (uint64_t i = begin; i < end; i++) {
        uint64_t const point = q->order == NULL ? i : q->order[i];
        bvxi_closest_ask(q->closest, q->points + 3 * point, &hint, &q->found[point]);
    }
}

/* Up to QUERY_TOGETHER points, whose search is the share from `from` to `to` of the work. */
static bvx_status find_closest_batch(bvx_context *ctx, closest_query *q, double from, double to)
{
    if (q->order != NULL) {
        /* Cells of the points' own box; a box beyond the largest double is one cell. */
        double const most = (double)((1 << QUERY_BITS) - 1);

        for (int a = 0; a < 3; a++) {
            double low = q->points[a], high = low;
            for (uint64_t i = 1; i < q->count; i++) {
                double const x = q->points[3 * i + (uint64_t)a];
                low = x < low ? x : low;
                high = x > high ? x : high;
            }
            q->low[a] = low;

            /* Flat boxes have no cells along that axis, and boxes beyond a double's range one. */
            q->scale[a] = high - low > 0x1p-960 && high - low < 0x1p960 ? most / (high - low) : 0.0;
        }

        for (uint64_t i = 0; i < q->count; i++) {
            uint64_t key = 0;
            for (int a = 0; a < 3; a++) {
                double const x = q->scale[a] > 0.0
                                     ? (q->points[3 * i + (uint64_t)a] - q->low[a]) * q->scale[a]
                                     : 0.0;
                key |= bvxi_curve_spread((uint64_t)(x < most ? x : most)) << a;
            }
            q->keys[i] = key;
            q->order[i] = (uint32_t)i;
        }

        BVXI_TRY(bvxi_radix_sort(ctx, q->keys, q->order, q->count));
    }
    return BVXI_SHARE(ctx, from, to,
                      bvxi_for(ctx, "nearest points", q->count, QUERY_GRAIN, find_closest_piece, q));
}

static bvx_status run_closest_find(bvx_context *context, const bvx_closest *closest, const double *points,
                                   uint64_t count, bvx_closest_point *found)
{
    static const char *const function = "bvx_closest_find";
    closest_query q = {.closest = closest, .points = points, .found = found, .count = count};
    if (closest == NULL) return bvxi_fail_null(context, function, "closest");
    if (found == NULL && count != 0) return bvxi_fail_null(context, function, "found");
    BVXI_TRY(bvxi_check_points(context, function, points, count, sizeof *found));
    uint64_t const most = count < QUERY_TOGETHER ? count : QUERY_TOGETHER;
    /* A few points are not worth an order; none is work that says so. */
    if (count <= QUERY_GRAIN) return find_closest_batch(context, &q, 0.0, 1.0);
    BVXI_TRY(BVXI_ARRAY(context, most, "the points' keys", q.keys));
    BVXI_TRY(BVXI_ARRAY(context, most, "the points' order", q.order));
    /* Batches bound the memory of keys, whatever the number of points. */
    for (uint64_t begin = 0; begin < count; begin += QUERY_TOGETHER) {
        closest_query batch = q;
        batch.points += 3 * begin;
        batch.found += begin;
        batch.count = count - begin < QUERY_TOGETHER ? count - begin : QUERY_TOGETHER;
        BVXI_TRY(find_closest_batch(context, &batch, (double)begin / (double)count,
                                    (double)(begin + batch.count) / (double)count));
    }
    return BVX_OK;
}

bvx_status bvx_closest_find(bvx_context *context, const bvx_closest *closest, const double *points,
                            uint64_t count, bvx_closest_point *found)
{
    return BVXI_CALL(context, run_closest_find(context, closest, points, count, found));
}
