/* distance2d.c - distances on a section's plane: from a place to the nearest segment of its contours.
 *
 * Groups of four segments, in the order of the loops, are the leaves of a binary heap of boxes: a loop's
 * order keeps near things together, so nothing is sorted. A search goes up from the segment that was nearest
 * to the last place, and leaves out boxes that lie farther off by more than all rounding: the result is the
 * least of the same squares whatever the start.
 */
#include "contours/section.h"

#include <math.h>

enum { DISTANCE_STACK = 64 };

#define DISTANCE_ROUNDING 4e-12

static inline uint32_t segment_at(const bvxi_plane *p, uint32_t i)
{
    return p->segment == NULL ? i : p->segment[i];
}

static void fill_group(bvxi_plane *p, uint32_t leaf, double box[4])
{
    uint32_t const first = leaf * BVXI_SEGMENT_GROUP;

    /* A leaf without segments keeps a box that no place is near. */
    box[0] = box[1] = 1e300;
    box[2] = box[3] = -1e300;
    if (first >= p->segment_count) return;
    for (uint32_t n = 0; n < BVXI_SEGMENT_GROUP; n++) {
        uint32_t const i = segment_at(p, first + n < p->segment_count ? first + n : first);
        const double *const a = p->uv[i], *const b = p->uv[p->next[i]];
        bvxi_segment_group *const g = &p->group[leaf];
        g->u[n] = a[0];
        g->v[n] = a[1];
        g->du[n] = b[0] - a[0];
        g->dv[n] = b[1] - a[1];
        g->square[n] = g->du[n] * g->du[n] + g->dv[n] * g->dv[n];
        bvxi_widen(box, box + 2, a, 2);
        bvxi_widen(box, box + 2, b, 2);
    }
}

bvx_status bvxi_plane_open_tree(bvx_context *ctx, bvxi_plane *p, uint32_t segments)
{
    uint64_t const groups = ((uint64_t)segments + BVXI_SEGMENT_GROUP - 1) / BVXI_SEGMENT_GROUP;
    for (p->leaf_count = 1; p->leaf_count < groups;) p->leaf_count *= 2;
    BVXI_TRY(BVXI_ARRAY(ctx, groups, "the segments of contours", p->group));
    return BVXI_ARRAY(ctx, 2 * (uint64_t)p->leaf_count, "the boxes of contours", p->box);
}

void bvxi_plane_tree(bvxi_plane *p)
{
    if (p->segment == NULL) p->segment_count = p->point_count;
    for (uint32_t i = 0; i < p->leaf_count; i++) fill_group(p, i, p->box[p->leaf_count + i]);
    /* Boxes from the leaves up: node i has 2 i and 2 i + 1 below it. */
    for (uint32_t i = p->leaf_count; i-- > 1;)
        for (int k = 0; k < 2; k++) {
            const double *const a = p->box[2 * i], *const b = p->box[2 * i + 1];
            p->box[i][k] = a[k] < b[k] ? a[k] : b[k];
            p->box[i][k + 2] = a[k + 2] > b[k + 2] ? a[k + 2] : b[k + 2];
        }

    /* What rounding may take off a distance, by the extent of all contours. */
    p->slack = 0.0;
    for (int k = 0; k < 2 && p->segment_count != 0; k++)
        p->slack += (p->box[1][k + 2] - p->box[1][k]) * (p->box[1][k + 2] - p->box[1][k]);
    p->slack *= DISTANCE_ROUNDING * DISTANCE_ROUNDING;
}

/* Boxes from this square on hold nothing nearer, rounding included: a share of d and one of the extent. */
static inline double farthest_box(const bvxi_plane *p, double best)
{
    return best * (1.0 + 1e-6) + p->slack;
}

static inline double box_square(const double box[4], double u, double v)
{
    double const left = box[0] - u, right = u - box[2], low = box[1] - v, high = v - box[3];
    double const side = left > right ? left : right, level = low > high ? low : high;
    double const x = side > 0.0 ? side : 0.0, y = level > 0.0 ? level : 0.0;
    return x * x + y * y;
}

static inline void squares_of_group(const bvxi_segment_group *g, double u, double v,
                                    double d[BVXI_SEGMENT_GROUP])
{
    for (int i = 0; i < BVXI_SEGMENT_GROUP; i++) {
        double const x = u - g->u[i], y = v - g->v[i];
        double const along = x * g->du[i] + y * g->dv[i];
        double const share = along / (g->square[i] > 0.0 ? g->square[i] : 1.0);
        double const most = along < g->square[i] ? share : 1.0, t = along > 0.0 ? most : 0.0;
        double const ex = x - t * g->du[i], ey = y - t * g->dv[i];
        d[i] = ex * ex + ey * ey;
    }
}

/* The least square in a group, where it is less than best. All four are computed before any is looked at. */
static inline double nearest_in_group(const bvxi_plane *p, uint32_t leaf, double u, double v, double best,
                                      uint32_t *hint)
{
    double d[BVXI_SEGMENT_GROUP], least;
    squares_of_group(&p->group[leaf], u, v, d);
    least = d[0] < d[1] ? d[0] : d[1];
    if (d[2] < least) least = d[2];
    if (d[3] < least) least = d[3];
    if (!(least < best)) return best;
    *hint = leaf * BVXI_SEGMENT_GROUP; /* the group is all that a search begins with */
    return least;
}

static double nearest_below(const bvxi_plane *p, uint32_t node, double u, double v, double best,
                            uint32_t *hint)
{
    uint32_t stack[DISTANCE_STACK], top = 0;
    double far[DISTANCE_STACK], limit = farthest_box(p, best);

    for (;;) {
        if (node >= p->leaf_count) {
            best = nearest_in_group(p, node - p->leaf_count, u, v, best, hint);
            limit = farthest_box(p, best);
        } else {
            double const a = box_square(p->box[2 * node], u, v), b = box_square(p->box[2 * node + 1], u, v);
            uint32_t const near = a <= b ? 2 * node : 2 * node + 1;
            double const nearer = a <= b ? a : b, farther = a <= b ? b : a;
            if (farther < limit) {
                far[top] = farther;
                stack[top++] = near ^ 1;
            }
            if (nearer < limit) {
                node = near;
                continue;
            }
        }
        while (top > 0 && far[top - 1] >= limit) top--;
        if (top == 0) return best;
        node = stack[--top];
    }
}

/* From the group of the hint upwards: at each step the box beside is looked
 * into when it may hold something nearer. */
double bvxi_plane_distance(const bvxi_plane *p, double u, double v, uint32_t *hint)
{
    /* A hint of another plane may lie beyond this one's segments. */
    if (*hint >= p->segment_count) *hint = 0;
    uint32_t node = p->leaf_count + *hint / BVXI_SEGMENT_GROUP;
    double best = nearest_in_group(p, node - p->leaf_count, u, v, 1e300, hint);
    for (; node > 1; node >>= 1)
        if (box_square(p->box[node ^ 1], u, v) < farthest_box(p, best))
            best = nearest_below(p, node ^ 1, u, v, best, hint);
    return sqrt(best);
}

/* From the top; boxes as near as the nearest segment are looked into too: a lower number may be there. */
double bvxi_plane_nearest(const bvxi_plane *p, double u, double v, uint32_t *segment)
{
    uint32_t stack[DISTANCE_STACK], top = 0;
    double best = 1e300;

    *segment = BVXI_NONE;
    stack[top++] = 1;
    while (top > 0) {
        uint32_t const node = stack[--top], first = (node - p->leaf_count) * BVXI_SEGMENT_GROUP;
        double d[BVXI_SEGMENT_GROUP];
        /* What lies farther than the best so far is left out, rounding included. */
        if (box_square(p->box[node], u, v) >= farthest_box(p, best)) continue;
        if (node < p->leaf_count) {
            int const low = box_square(p->box[2 * node], u, v) <= box_square(p->box[2 * node + 1], u, v);
            stack[top++] = low ? 2 * node + 1 : 2 * node;
            stack[top++] = low ? 2 * node : 2 * node + 1;
            continue;
        }
        squares_of_group(&p->group[node - p->leaf_count], u, v, d);
        for (uint32_t i = 0; i < BVXI_SEGMENT_GROUP && first + i < p->segment_count; i++)
            if (d[i] < best || (d[i] == best && segment_at(p, first + i) < *segment)) {
                best = d[i];
                *segment = segment_at(p, first + i);
            }
    }
    return sqrt(best);
}

/* An odd number of segments to the right; the place is snapped as the contours are, so it has a side. */
int bvxi_plane_inside(const bvxi_stack *stack, const bvxi_plane *p, double u, double v)
{
    double const unit = (double)(1 << stack->fine);
    double const x = (u - stack->origin[0]) / stack->step[0] * unit;
    double const y = (v - stack->origin[1]) / stack->step[1] * unit;
    int64_t const qx = (int64_t)floor(x), qy = (int64_t)floor(y * 0.5) * 2;
    int odd = p->turned;

    for (uint32_t n = 0; n < p->segment_count; n++) {
        uint32_t const i = segment_at(p, n);
        const int32_t *const a = p->q[i], *const b = p->q[p->next[i]];
        if ((a[1] < qy) == (b[1] < qy)) continue;
        int64_t const s = (b[0] - (int64_t)a[0]) * (qy - a[1]) - (qx - a[0]) * (b[1] - (int64_t)a[1]);
        odd ^= (s > 0) == (b[1] > a[1]);
    }
    return odd;
}

/* An odd number of segments to the right, of those whose boxes reach there. Neighbours share ends. */
int bvxi_plane_encloses(const bvxi_plane *p, double u, double v)
{
    uint32_t stack[DISTANCE_STACK], top = 0;
    int odd = p->turned;

    stack[top++] = 1;
    while (top > 0) {
        uint32_t const node = stack[--top], first = (node - p->leaf_count) * BVXI_SEGMENT_GROUP;
        const double *const box = p->box[node];

        if (!(box[1] <= v && v <= box[3] && u <= box[2])) continue;
        if (node < p->leaf_count) {
            stack[top++] = 2 * node;
            stack[top++] = 2 * node + 1;
            continue;
        }

        for (uint32_t n = first; n < first + BVXI_SEGMENT_GROUP && n < p->segment_count; n++) {
            uint32_t const i = segment_at(p, n);
            const double *const a = p->uv[i], *const b = p->uv[p->next[i]];
            if ((a[1] < v) == (b[1] < v)) continue;
            double const side = (b[0] - a[0]) * (v - a[1]) - (u - a[0]) * (b[1] - a[1]);
            odd ^= (side > 0.0) == (b[1] > a[1]);
        }
    }
    return odd;
}
