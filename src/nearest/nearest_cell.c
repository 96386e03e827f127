/* nearest_cell.c - the leaves that may hold the nearest point of some centre of a cell.
 *
 * Depth first from the root, nearer boxes first. With a known point p of the mesh a box I is out when every
 * point c of the cell is nearer to p: |c - p|^2 < dist(c, I)^2. Both sides are sums over the axes, and so is
 * the largest difference over a box of points; along an axis (c - p)^2 - dist(c, I)^2 is convex (its slope, 2
 * (c' - p) with c' the place of c moved into I, never falls), so it is largest at one of the two ends.
 * Nothing but ends is computed, and no better test of a box against one point is possible.
 * Guarantee: what is left out cannot win. The compared squares have a relative slack of 2^-12, far above a
 * float's rounding, and an absolute one that covers what the evaluation in doubles may err. */
#include "nearest/nearest_brick.h"
#include "core/simd.h"

/* ---- Bounds ---- */

static inline float near_larger(float x, float y)
{
    return x > y ? x : y;
}

static inline float near_magnitude(float x)
{
    return x < 0.0f ? -x : x;
}

/* The error of distances to a leaf's triangles: shares of its far corner and the centres, and rounding. */
static inline float near_error(float far_corner, const bvxi_near_cell *cell)
{
    float reach = far_corner;
    for (int a = 0; a < 3; a++)
        reach += near_larger(near_magnitude(cell->first[a]), near_magnitude(cell->last[a]));
    return reach * BVXI_NEAR_ERROR + 0x1p-23f + cell->rounding; /* the origin lies within [-1, 1] */
}

/* The slack: (x + t)^2 <= x^2 (1 + s) + t^2 (1 + 1 / s) for x, t, s > 0. */
static void bound_near_cell(bvxi_near_cell *cell)
{
    float const t = cell->rounding + cell->point_error;
    float const more = 1.0f + BVXI_NEAR_SLACK, add = t * t * ((1.0f + 1.0f / BVXI_NEAR_SLACK) / 3.0f);
    cell->point_distance2 = 0.0f;
    for (int a = 0; a < 3; a++) {
        float const left = cell->point[a] - cell->first[a];
        float const right = cell->point[a] - cell->last[a];
        float const middle = (left + right) * 0.5f;
        /* A third of what is added falls to each axis: the bounds of three are summed. */
        cell->first_bound[a] = left * left * more + add;
        cell->last_bound[a] = right * right * more + add;
        cell->point_distance2 += middle * middle;
    }
}

float bvxi_near_cell_reach2(const bvxi_near_cell *cell)
{
    float reach2 = 0.0f;
    for (int a = 0; a < 3; a++) reach2 += near_larger(cell->first_bound[a], cell->last_bound[a]);
    return reach2 < cell->limit2 ? reach2 : cell->limit2;
}

/* ---- The search ---- */

/* Children of a node on the stack, the nearest on top. */
static void push_near_children(bvxi_near_cell *cell, int32_t level, uint32_t first, uint32_t mask,
                               const float distance2[BVXI_NEAR_WIDTH])
{
    int32_t const bottom = cell->open;
    for (; mask != 0; mask &= mask - 1) {
        uint32_t const k = (uint32_t)bvxi_lowest(mask);
        int32_t i = cell->open++;
        /* Insertion: they are eight at most. The nearest comes first since it narrows the bound soonest. */
        for (; i > bottom && cell->stack[i - 1].distance2 < distance2[k]; i--)
            cell->stack[i] = cell->stack[i - 1];
        cell->stack[i].distance2 = distance2[k];
        cell->stack[i].level = level;
        cell->stack[i].node = first + k;
    }
}

/* What the boxes of a node's children say goes to the start's. */
static void start_near_children(const bvxi_near_node *node, uint32_t mask, bvxi_near_start *start)
{
    for (; mask != 0; mask &= mask - 1) {
        int32_t const k = bvxi_lowest(mask);
        int32_t const i = start->count / BVXI_NEAR_WIDTH;
        int32_t const slot = start->count % BVXI_NEAR_WIDTH;
        /* Side by side as in a node, so that a start is tested like one. */
        for (int a = 0; a < 3; a++) {
            start->box[i].low[a][slot] = node->low[a][k];
            start->box[i].high[a][slot] = node->high[a][k];
        }
        start->node[start->count++] = node->first + (uint32_t)k;
    }
}

#define BVXI_SIMD_LEVEL _base
#include "nearest/nearest_cell_body.h"
#undef BVXI_SIMD_LEVEL

#if BVXI_HAVE_AVX2
#define BVXI_SIMD_LEVEL _avx2
#include "nearest/nearest_cell_body.h"
#undef BVXI_SIMD_LEVEL
#endif

void bvxi_near_cell_begin(const bvxi_nearest *n, const bvxi_near_question *q, const bvxi_near_start *start,
                          int32_t fast, bvxi_near_cell *cell)
{
    double const limit = q->limit * (1.0 + 0x1p-20) + 2.0 * n->rounding;
    double error = q->point_error;

    for (int a = 0; a < 3; a++) {
        /* From the cell's middle all coordinates are small, and floats hold them well. */
        cell->origin[a] = (float)((q->first[a] + q->last[a]) * 0.5);
        double const origin = (double)cell->origin[a], point = q->point[a] - origin;
        cell->first[a] = (float)(q->first[a] - origin);
        cell->last[a] = (float)(q->last[a] - origin);
        cell->point[a] = (float)point;

        /* Four roundings to floats, each of half a unit of its number. */
        error += 0x1p-22 * ((point < 0.0 ? -point : point) + (q->last[a] - q->first[a]) +
                            (double)near_magnitude(cell->last[a]));
    }
    cell->rounding = (float)n->rounding;
    cell->point_error = (float)error;
    /* boxes that there are not lie at 2^62 */
    cell->limit2 = limit < 0x1p60 ? (float)(limit * limit * (1.0 + 0x1p-20)) : 0x1p121f;
    bound_near_cell(cell);

    BVXI_PATH(fast, begin_near_search_base(n, start, cell), begin_near_search_avx2(n, start, cell));
}

void bvxi_near_cell_start(const bvxi_nearest *n, bvxi_near_cell *cell, int32_t fast, bvxi_near_start *start)
{
    BVXI_PATH(fast, start_near_cell_base(n, cell, start), start_near_cell_avx2(n, cell, start));
}

int32_t bvxi_near_cell_list(const bvxi_nearest *n, bvxi_near_cell *cell, int32_t fast, bvxi_near_list *list)
{
    return BVXI_PATH(fast, list_near_cell_base(n, cell, list), list_near_cell_avx2(n, cell, list));
}
