/* distance2d.c - distances on a section's plane: from a place to the nearest segment of its contours.
 *
 * Groups of four segments, in the order of the loops, are the leaves of a binary heap of boxes: a loop's order keeps near things
 * together, so nothing is sorted. A search goes up from the segment that was nearest to the last place, and
 * leaves out boxes that lie no nearer. The result is the least of the same squares whatever the start. */
#include "section/section.h"

#include <math.h>

enum { DISTANCE_GROUP = 4, DISTANCE_STACK = 64 };

static void box_of_group(const bvxi_plane *p, uint32_t leaf, double box[4])
{
    uint32_t const first = leaf * DISTANCE_GROUP;
    box[0] = box[1] = 1e300;
    box[2] = box[3] = -1e300;
    for (uint32_t i = first; i < first + DISTANCE_GROUP && i < p->point_count; i++)
        for (int end = 0; end < 2; end++) {
            const double *const c = p->uv[end ? p->next[i] : i];
            for (int k = 0; k < 2; k++) {
                if (c[k] < box[k]) box[k] = c[k];
                if (c[k] > box[k + 2]) box[k + 2] = c[k];
            }
        }
}

bvx_status bvxi_plane_tree(bvxi_stack *stack, bvxi_plane *p)
{
    uint32_t const groups = (p->point_count + DISTANCE_GROUP - 1) / DISTANCE_GROUP;
    p->leaf_count = 1;
    while (p->leaf_count < groups) p->leaf_count *= 2;
    BVXI_TRY(bvxi_alloc(stack->ctx, BVXI_SCRATCH, (uint64_t)p->leaf_count * 2 * sizeof *p->box, "the boxes of contours", &p->box));
    for (uint32_t i = 0; i < p->leaf_count; i++) box_of_group(p, i, p->box[p->leaf_count + i]);
    for (uint32_t i = p->leaf_count; i-- > 1;)
        for (int k = 0; k < 2; k++) {
            const double *const a = p->box[2 * i], *const b = p->box[2 * i + 1];
            p->box[i][k] = a[k] < b[k] ? a[k] : b[k];
            p->box[i][k + 2] = a[k + 2] > b[k + 2] ? a[k + 2] : b[k + 2];
        }
    return BVX_OK;
}

static inline double box_square(const double box[4], double u, double v)
{
    double const x = u < box[0] ? box[0] - u : u > box[2] ? u - box[2] : 0.0;
    double const y = v < box[1] ? box[1] - v : v > box[3] ? v - box[3] : 0.0;
    return x * x + y * y;
}

static inline double segment_square(const bvxi_plane *p, uint32_t i, double u, double v)
{
    const double *const a = p->uv[i], *const b = p->uv[p->next[i]];
    double const dx = b[0] - a[0], dy = b[1] - a[1], x = u - a[0], y = v - a[1];
    double const along = x * dx + y * dy, length = dx * dx + dy * dy;
    double t = 0.0, ex, ey;
    if (along > 0.0) t = along < length ? along / length : 1.0;
    ex = x - t * dx;
    ey = y - t * dy;
    return ex * ex + ey * ey;
}

/* The least square in a group of segments, where it is less than best. */
static double nearest_in_group(const bvxi_plane *p, uint32_t leaf, double u, double v, double best, uint32_t *hint)
{
    uint32_t const first = leaf * DISTANCE_GROUP;
    for (uint32_t i = first; i < first + DISTANCE_GROUP && i < p->point_count; i++) {
        double const d = segment_square(p, i, u, v);
        if (d < best) {
            best = d;
            *hint = i;
        }
    }
    return best;
}

/* The same for all segments below a box. */
static double nearest_below(const bvxi_plane *p, uint32_t node, double u, double v, double best, uint32_t *hint)
{
    uint32_t stack[DISTANCE_STACK], top = 0;
    double far[DISTANCE_STACK];
    for (;;) {
        if (node >= p->leaf_count) {
            best = nearest_in_group(p, node - p->leaf_count, u, v, best, hint);
        } else {
            double const a = box_square(p->box[2 * node], u, v), b = box_square(p->box[2 * node + 1], u, v);
            uint32_t const near = a <= b ? 2 * node : 2 * node + 1;
            double const nearer = a <= b ? a : b, farther = a <= b ? b : a;
            if (farther < best) {
                far[top] = farther;
                stack[top++] = near ^ 1;
            }
            if (nearer < best) {
                node = near;
                continue;
            }
        }
        while (top > 0 && far[top - 1] >= best) top--;
        if (top == 0) return best;
        node = stack[--top];
    }
}

/* From the group of the hint upwards: at each step the box beside is looked into when it may hold something nearer. */
double bvxi_plane_distance(const bvxi_plane *p, double u, double v, uint32_t *hint)
{
    uint32_t node;
    double best;
    if (*hint >= p->point_count) *hint = 0;
    node = p->leaf_count + *hint / DISTANCE_GROUP;
    best = nearest_in_group(p, node - p->leaf_count, u, v, 1e300, hint);
    for (; node > 1; node >>= 1)
        if (box_square(p->box[node ^ 1], u, v) < best) best = nearest_below(p, node ^ 1, u, v, best, hint);
    return sqrt(best);
}

/* From the top; boxes as near as the nearest segment are looked into too, since one with a lower number may be there. */
double bvxi_plane_nearest(const bvxi_plane *p, double u, double v, uint32_t *segment)
{
    uint32_t stack[DISTANCE_STACK], top = 0;
    double best = 1e300;
    *segment = BVXI_NONE;
    stack[top++] = 1;
    while (top > 0) {
        uint32_t const node = stack[--top];
        if (box_square(p->box[node], u, v) > best) continue;
        if (node < p->leaf_count) {
            int const low = box_square(p->box[2 * node], u, v) <= box_square(p->box[2 * node + 1], u, v);
            stack[top++] = low ? 2 * node + 1 : 2 * node;
            stack[top++] = low ? 2 * node : 2 * node + 1;
            continue;
        }
        for (uint32_t i = (node - p->leaf_count) * DISTANCE_GROUP, n = 0; n < DISTANCE_GROUP && i < p->point_count; n++, i++) {
            double const d = segment_square(p, i, u, v);
            if (d < best || (d == best && i < *segment)) {
                best = d;
                *segment = i;
            }
        }
    }
    return sqrt(best);
}

/* An odd number of segments to the right; the place is snapped to odd numbers as the contours are, so one on a contour falls on
 * some side. */
int bvxi_plane_inside(const bvxi_stack *stack, const bvxi_plane *p, double u, double v)
{
    double const unit = (double)(1 << stack->fine);
    double const x = (u - stack->origin[0]) / stack->step[0] * unit, y = (v - stack->origin[1]) / stack->step[1] * unit;
    int64_t const qx = (int64_t)floor(x), qy = (int64_t)floor(y * 0.5) * 2;
    int odd = 0;
    for (uint32_t i = 0; i < p->point_count; i++) {
        const int32_t *const a = p->q[i], *const b = p->q[p->next[i]];
        int64_t s;
        if ((a[1] < qy) == (b[1] < qy)) continue;
        s = (b[0] - (int64_t)a[0]) * (qy - a[1]) - (qx - a[0]) * (b[1] - (int64_t)a[1]);
        odd ^= (s > 0) == (b[1] > a[1]);
    }
    return odd;
}
