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

#if BVXI_HAVE_AVX2
#include <immintrin.h>
#endif

/* ---- Eight children against a cell ---- */

static inline float near_larger(float x, float y)
{
    return x > y ? x : y;
}

/* Bit k is set when child k may matter; distance2 becomes the squares of the distances from the origin. */
static uint32_t near_children(const bvxi_near_node *node, const bvxi_near_cell *cell,
                              float distance2[BVXI_NEAR_WIDTH])
{
    uint32_t mask = 0;

    for (int k = 0; k < BVXI_NEAR_WIDTH; k++) {
        float worst = 0.0f, gap = 0.0f, middle = 0.0f;
        for (int a = 0; a < 3; a++) {
            float const low = node->low[a][k] - cell->origin[a], high = node->high[a][k] - cell->origin[a];
            float const f = cell->first[a], l = cell->last[a];
            float const left = near_larger(near_larger(low - f, f - high), 0.0f);
            float const right = near_larger(near_larger(low - l, l - high), 0.0f);
            float const out = near_larger(near_larger(low - l, f - high), 0.0f);
            float const from = near_larger(near_larger(low, -high), 0.0f);
            worst += near_larger(cell->first_bound[a] - left * left, cell->last_bound[a] - right * right);
            gap += out * out;
            middle += from * from;
        }
        distance2[k] = middle;
        mask |= (uint32_t)(worst >= 0.0f && gap <= cell->limit2) << k;
    }
    return mask;
}

static inline float near_magnitude(float x)
{
    return x < 0.0f ? -x : x;
}

/* The error of distances to a leaf's triangles: in proportion to where its far corner is, and to where the
 * centres are; and a float's half unit of the feet's places. */
static inline float near_error(float far_corner, const bvxi_near_cell *cell)
{
    float reach = far_corner;
    for (int a = 0; a < 3; a++)
        reach += near_larger(near_magnitude(cell->first[a]), near_magnitude(cell->last[a]));
    return reach * BVXI_NEAR_ERROR + 0x1p-23f + cell->rounding; /* the origin lies within [-1, 1] */
}

/* Shift a node's leaves. *far_corner becomes the largest of the listed: sums of
 * their boxes' largest coordinates. Returns the listed leaf whose point is
 * nearest to the middle of the cell, if it is nearer than what is known, or -1. */
static int32_t shift_near_leaves(const bvxi_near_node *node, const bvxi_near_cell *cell, uint32_t listed,
                                 bvxi_near_block *b, float *far_corner)
{
    float best = cell->point_distance2;
    int32_t nearest = -1;

    for (int k = 0; k < BVXI_NEAR_WIDTH; k++) {
        float corner = 0.0f, d = 0.0f;
        for (int a = 0; a < 3; a++) {
            float const low = node->low[a][k] - cell->origin[a];
            float const high = node->high[a][k] - cell->origin[a];
            float const point = low + node->point[a][k];
            float const from = point - (cell->first[a] + cell->last[a]) * 0.5f;
            b->low[a][k] = low;
            b->high[a][k] = high;
            b->point[a][k] = point;
            corner += near_larger(-low, high) + (high - low);
            d += from * from;
        }
        if ((listed >> k & 1) == 0) continue;
        *far_corner = near_larger(corner, *far_corner);
        if (d < best) nearest = k;
        best = d < best ? d : best;
    }
    return nearest;
}

#if BVXI_HAVE_AVX2
BVXI_AVX2 static inline uint32_t near_children_avx2(const bvxi_near_node *node, const bvxi_near_cell *cell,
                                                    float distance2[BVXI_NEAR_WIDTH])
{
    __m256 const zero = _mm256_setzero_ps();
    __m256 worst = zero, gap = zero, middle = zero;

    for (int a = 0; a < 3; a++) {
        __m256 const origin = _mm256_broadcast_ss(&cell->origin[a]);
        __m256 const f = _mm256_broadcast_ss(&cell->first[a]);
        __m256 const l = _mm256_broadcast_ss(&cell->last[a]);
        __m256 const low = _mm256_loadu_ps(node->low[a]) - origin;
        __m256 const high = _mm256_loadu_ps(node->high[a]) - origin;
        __m256 const low_out = low - l, high_out = f - high;
        __m256 const left = _mm256_max_ps(_mm256_max_ps(low - f, high_out), zero);
        __m256 const right = _mm256_max_ps(_mm256_max_ps(low_out, l - high), zero);
        __m256 const out = _mm256_max_ps(_mm256_max_ps(low_out, high_out), zero);
        __m256 const from = _mm256_max_ps(_mm256_max_ps(low, zero - high), zero);
        worst += _mm256_max_ps(_mm256_broadcast_ss(&cell->first_bound[a]) - left * left,
                               _mm256_broadcast_ss(&cell->last_bound[a]) - right * right);
        gap += out * out;
        middle += from * from;
    }
    _mm256_storeu_ps(distance2, middle);
    return (uint32_t)_mm256_movemask_ps(
        _mm256_and_ps(_mm256_cmp_ps(worst, zero, _CMP_GE_OQ),
                      _mm256_cmp_ps(gap, _mm256_broadcast_ss(&cell->limit2), _CMP_LE_OQ)));
}

BVXI_AVX2 static inline float near_least_8(__m256 x)
{
    __m128 y = _mm_min_ps(_mm256_castps256_ps128(x), _mm256_extractf128_ps(x, 1));
    y = _mm_min_ps(y, _mm_movehl_ps(y, y));
    return _mm_cvtss_f32(_mm_min_ss(y, _mm_shuffle_ps(y, y, 1)));
}

BVXI_AVX2 static inline int32_t shift_near_leaves_avx2(const bvxi_near_node *node, const bvxi_near_cell *cell,
                                                       uint32_t listed, bvxi_near_block *b, float *far_corner)
{
    __m256i const bit = _mm256_setr_epi32(1, 2, 4, 8, 16, 32, 64, 128);
    __m256 const is_listed = _mm256_castsi256_ps(
        _mm256_cmpeq_epi32(_mm256_and_si256(_mm256_set1_epi32((int)listed), bit), bit));
    __m256 corner = _mm256_setzero_ps(), d = corner;
    float least;

    for (int a = 0; a < 3; a++) {
        __m256 const origin = _mm256_broadcast_ss(&cell->origin[a]);
        __m256 const middle = _mm256_set1_ps((cell->first[a] + cell->last[a]) * 0.5f);
        __m256 const low = _mm256_loadu_ps(node->low[a]) - origin;
        __m256 const high = _mm256_loadu_ps(node->high[a]) - origin;
        __m256 const point = low + _mm256_loadu_ps(node->point[a]), from = point - middle;
        _mm256_storeu_ps(b->low[a], low);
        _mm256_storeu_ps(b->high[a], high);
        _mm256_storeu_ps(b->point[a], point);
        corner += _mm256_max_ps(_mm256_setzero_ps() - low, high) + (high - low);
        d += from * from;
    }
    least = -near_least_8(_mm256_setzero_ps() - _mm256_and_ps(is_listed, corner));
    *far_corner = least > *far_corner ? least : *far_corner;
    d = _mm256_blendv_ps(_mm256_set1_ps(0x1p126f), d, is_listed);
    least = near_least_8(d);
    if (!(least < cell->point_distance2)) return -1;
    return bvxi_lowest((uint32_t)_mm256_movemask_ps(_mm256_cmp_ps(d, _mm256_set1_ps(least), _CMP_EQ_OQ)));
}
#endif

/* ---- Bounds ---- */

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
        cell->first_bound[a] = left * left * more + add;
        cell->last_bound[a] = right * right * more + add;
        cell->point_distance2 += middle * middle;
    }
}

static void set_near_cell(const bvxi_nearest *n, const bvxi_near_question *q, bvxi_near_cell *cell)
{
    double const limit = q->limit * (1.0 + 0x1p-20) + 2.0 * n->rounding;
    double error = q->point_error;

    for (int a = 0; a < 3; a++) {
        cell->origin[a] = (float)((q->first[a] + q->last[a]) * 0.5);
        double const origin = (double)cell->origin[a], point = q->point[a] - origin;
        cell->first[a] = (float)(q->first[a] - origin);
        cell->last[a] = (float)(q->last[a] - origin);
        cell->point[a] = (float)point;
        error += 0x1p-22 * ((point < 0.0 ? -point : point) + (q->last[a] - q->first[a]) +
                            (double)near_magnitude(cell->last[a]));
    }
    cell->rounding = (float)n->rounding;
    cell->point_error = (float)error;
    /* boxes that there are not lie at 2^62 */
    cell->limit2 = limit < 0x1p60 ? (float)(limit * limit * (1.0 + 0x1p-20)) : 0x1p121f;
    bound_near_cell(cell);
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
        for (; i > bottom && cell->stack[i - 1].distance2 < distance2[k]; i--)
            cell->stack[i] = cell->stack[i - 1];
        cell->stack[i].distance2 = distance2[k];
        cell->stack[i].level = level;
        cell->stack[i].node = first + k;
    }
}

#if BVXI_HAVE_AVX2
#define NEAR_CELL_PATH(fast, plain, vectors) ((fast) ? vectors : plain)
#else
#define NEAR_CELL_PATH(fast, plain, vectors) ((void)(fast), plain)
#endif

BVXI_VECTOR_INLINE void begin_near_search(const bvxi_nearest *n, const bvxi_near_start *start, int fast,
                                          bvxi_near_cell *cell)
{
    float distance2[BVXI_NEAR_WIDTH];

    cell->open = 0;
    if (start == NULL || start->count < 0) {
        cell->stack[0].distance2 = 0.0f;
        cell->stack[0].level = n->level_count - 1;
        cell->stack[0].node = 0;
        cell->open = 1;
        return;
    }
    for (int32_t i = 0; i < start->count; i += BVXI_NEAR_WIDTH) {
        const bvxi_near_node *const box = &start->box[i / BVXI_NEAR_WIDTH];
        uint32_t mask = NEAR_CELL_PATH(fast, near_children(box, cell, distance2),
                                       near_children_avx2(box, cell, distance2));
        for (; mask != 0; mask &= mask - 1) {
            int32_t const k = bvxi_lowest(mask);
            cell->stack[cell->open].distance2 = distance2[k];
            cell->stack[cell->open].level = 0;
            cell->stack[cell->open++].node = start->node[i + k];
        }
    }
}

/* What the boxes of a node's children say goes to the start's. */
static void start_near_children(const bvxi_near_node *node, uint32_t mask, bvxi_near_start *start)
{
    for (; mask != 0; mask &= mask - 1) {
        int32_t const k = bvxi_lowest(mask);
        int32_t const i = start->count / BVXI_NEAR_WIDTH;
        int32_t const slot = start->count % BVXI_NEAR_WIDTH;
        for (int a = 0; a < 3; a++) {
            start->box[i].low[a][slot] = node->low[a][k];
            start->box[i].high[a][slot] = node->high[a][k];
        }
        start->node[start->count++] = node->first + (uint32_t)k;
    }
}

BVXI_VECTOR_INLINE void start_near_cell(const bvxi_nearest *n, bvxi_near_cell *cell, int fast,
                                        bvxi_near_start *start)
{
    start->count = n->level_count == 1 ? -1 : 0;
    begin_near_search(n, NULL, fast, cell);
    while (cell->open > 0 && start->count >= 0) {
        bvxi_near_visit const visit = cell->stack[--cell->open];
        const bvxi_near_node *const node = &n->level[visit.level][visit.node];
        float distance2[BVXI_NEAR_WIDTH];
        uint32_t const mask = NEAR_CELL_PATH(fast, near_children(node, cell, distance2),
                                             near_children_avx2(node, cell, distance2));
        if (visit.level > 1) push_near_children(cell, visit.level - 1, node->first, mask, distance2);
        else if (start->count <= (BVXI_NEAR_STARTS - 1) * BVXI_NEAR_WIDTH)
            start_near_children(node, mask, start);
        else start->count = -1;
    }
    for (int32_t k = start->count; k > 0 && k % BVXI_NEAR_WIDTH != 0; k++)
        for (int a = 0; a < 3; a++)
            start->box[k / BVXI_NEAR_WIDTH].low[a][k % BVXI_NEAR_WIDTH] =
                start->box[k / BVXI_NEAR_WIDTH].high[a][k % BVXI_NEAR_WIDTH] = 0x1p62f;
}

BVXI_VECTOR_INLINE int32_t list_near_cell(const bvxi_nearest *n, bvxi_near_cell *cell, int fast,
                                          bvxi_near_list *list)
{
    float far_corner = 0.0f;

    list->count = 0;
    while (cell->open > 0 && list->count < BVXI_NEAR_BLOCKS) {
        bvxi_near_visit const visit = cell->stack[--cell->open];
        const bvxi_near_node *const node = &n->level[visit.level][visit.node];
        bvxi_near_block *const block = &list->block[list->count];
        float distance2[BVXI_NEAR_WIDTH];
        uint32_t const mask = NEAR_CELL_PATH(fast, near_children(node, cell, distance2),
                                             near_children_avx2(node, cell, distance2));
        if (mask == 0) continue;
        if (visit.level > 0) {
            push_near_children(cell, visit.level - 1, node->first, mask, distance2);
            continue;
        }
        int32_t const nearest = NEAR_CELL_PATH(fast, shift_near_leaves(node, cell, mask, block, &far_corner),
                                               shift_near_leaves_avx2(node, cell, mask, block, &far_corner));
        block->first = node->first;
        block->listed = mask;
        list->count++;
        if (nearest < 0) continue;
        for (int a = 0; a < 3; a++) cell->point[a] = block->point[a][nearest];
        cell->point_error = near_error(far_corner, cell);
        bound_near_cell(cell);
    }
    list->error = near_error(far_corner, cell);
    return cell->open == 0;
}

/* ---- Which path ---- */

#if BVXI_HAVE_AVX2
BVXI_AVX2 static int32_t list_near_cell_avx2(const bvxi_nearest *n, bvxi_near_cell *cell,
                                             bvxi_near_list *list)
{
    return list_near_cell(n, cell, 1, list);
}

BVXI_AVX2 static void start_near_cell_avx2(const bvxi_nearest *n, bvxi_near_cell *cell,
                                           bvxi_near_start *start)
{
    start_near_cell(n, cell, 1, start);
}

BVXI_AVX2 static void begin_near_search_avx2(const bvxi_nearest *n, const bvxi_near_start *start,
                                             bvxi_near_cell *cell)
{
    begin_near_search(n, start, 1, cell);
}
#endif

void bvxi_near_cell_begin(const bvxi_nearest *n, const bvxi_near_question *q, const bvxi_near_start *start,
                          int32_t fast, bvxi_near_cell *cell)
{
    set_near_cell(n, q, cell);
    NEAR_CELL_PATH(fast, begin_near_search(n, start, 0, cell), begin_near_search_avx2(n, start, cell));
}

void bvxi_near_cell_start(const bvxi_nearest *n, bvxi_near_cell *cell, int32_t fast, bvxi_near_start *start)
{
    NEAR_CELL_PATH(fast, start_near_cell(n, cell, 0, start), start_near_cell_avx2(n, cell, start));
}

int32_t bvxi_near_cell_list(const bvxi_nearest *n, bvxi_near_cell *cell, int32_t fast, bvxi_near_list *list)
{
    return NEAR_CELL_PATH(fast, list_near_cell(n, cell, 0, list), list_near_cell_avx2(n, cell, list));
}
