/* transform_columns.c - distances along a column in whole numbers: the lower envelope of parabolas, or where
 * all is near a search.
 *
 * Source: Meijster, Roerdink, Hesselink. A General Algorithm for Computing Distance Transforms in Linear
 * Time. 2000; Felzenszwalb, Huttenlocher. Distance Transforms of Sampled Functions. 2012.
 *
 * Parabola u is g[u] + (y - u)^2. For i < u parabola i is at least as good up to y = floor(((g[u] + u^2) -
 * (g[i] + i^2)) / (2 (u - i))). That quotient is taken by a product with 1 / (2 (u - i)): the numerator is a
 * whole number below 2^51, half of one is added, so the true value is at least 1 / (4 (u - i)) from any whole
 * number, and two roundings of 2^-53 do not cross it. Exact.
 *
 * Where every square of the columns is small, the least is searched for outwards, 16 columns at once: in y +-
 * k for k below its root. A search that would go beyond SEARCH_STEPS is dropped for the envelope; both give
 * the same numbers. */
#include "morphology/transform.h"

enum { SEARCH_STEPS = 8 };

/* ---- the search ---- */

BVXI_VECTOR_INLINE uint32_t most_of_lanes(const uint32_t *BVXI_RESTRICT lanes)
{
    uint32_t most = 0;
    for (int32_t i = 0; i < BVXI_LANES; i++) most = lanes[i] > most ? lanes[i] : most;
    return most;
}

BVXI_VECTOR_INLINE void take_lesser(uint32_t *BVXI_RESTRICT best, const uint32_t *BVXI_RESTRICT other,
                                    uint32_t step)
{
    for (int32_t i = 0; i < BVXI_LANES; i++) {
        uint32_t const v = other[i] + step;
        best[i] = v < best[i] ? v : best[i];
    }
}

/* 0: some least one lies too far. */
BVXI_VECTOR_INLINE int search_columns(const bvxi_columns *c)
{
    const uint32_t *const in = c->in;
    uint32_t *const out = c->out;

    for (int32_t y = 0; y < c->n; y++) {
        uint32_t best[BVXI_LANES], most;
        /* The own square is where the search begins: only what is nearer can lessen it. */
        memcpy(best, in + (size_t)y * BVXI_LANES, sizeof best);
        most = most_of_lanes(best);
        for (int32_t k = 1; (uint32_t)(k * k) < most; k++) {
            /* Too far for a search to pay: the envelope begins anew. */
            if (k > SEARCH_STEPS) return 0;
            if (y >= k) take_lesser(best, in + (size_t)(y - k) * BVXI_LANES, (uint32_t)(k * k));
            if (y + k < c->n) take_lesser(best, in + (size_t)(y + k) * BVXI_LANES, (uint32_t)(k * k));
            most = most_of_lanes(best);
        }
        memcpy(out + (size_t)y * BVXI_LANES, best, sizeof best);
    }
    return 1;
}

#if BVXI_HAVE_AVX2
BVXI_AVX2 static int search_columns_avx2(const bvxi_columns *c)
{
    return search_columns(c);
}
#endif

static int try_search(const bvxi_columns *c)
{
    /* The search reads all rows, and does not know where the least came from. */
    if (c->from != NULL || c->place_count != c->n) return 0;
#if BVXI_HAVE_AVX2
    if (c->cpu == BVX_CPU_AVX2) return search_columns_avx2(c);
#endif
    return search_columns(c);
}

/* ---- the envelope ---- */

/* The parabolas of one column that are least somewhere: site[i] from
 * start[i] on. Returns the last one's number. */
static inline int32_t build_envelope(const bvxi_columns *c, const uint32_t *in)
{
    double *const height = c->height, *const start = c->start;
    int32_t *const site = c->site;
    double const end = (double)(c->n - 1);
    int32_t top = -1;

    /* Parabolas that a later one covers wholly are taken off the stack. */
    for (int32_t j = 0; j < c->place_count; j++) {
        int32_t const u = c->places[j];
        double const h = (double)in[(size_t)u * BVXI_LANES] + (double)u * (double)u;
        double first = 0.0;
        while (top >= 0) {
            /* The half keeps the product away from whole numbers: see above. */
            double const last = (h - height[top] + 0.5) * c->inverse[u - site[top]];
            if (last >= start[top]) { /* the one before is least up to floor(last) */
                first = last < end ? (double)((int32_t)last + 1) : (double)c->n;
                break;
            }
            top--;
        }
        /* Least only beyond the column's end. */
        if (first > end) continue;
        top++;
        height[top] = h;
        start[top] = first;
        site[top] = u;
    }
    return top;
}

static inline void read_envelope(const bvxi_columns *c, const uint32_t *in, int32_t top, uint32_t *out,
                                 int32_t *from)
{
    /* Each parabola from its start to the next one's. */
    for (int32_t i = 0; i <= top; i++) {
        int32_t const u = c->site[i], end = i < top ? (int32_t)c->start[i + 1] : c->n;
        uint32_t const g = in[(size_t)u * BVXI_LANES];
        for (int32_t y = (int32_t)c->start[i]; y < end; y++) {
            uint32_t const d = (uint32_t)(y < u ? u - y : y - u);
            out[(size_t)y * BVXI_LANES] = g + d * d;
        }
        /* Targets in a loop of their own, so that the first one stays a vector. */
        for (int32_t y = (int32_t)c->start[i]; y < end && from != NULL; y++) from[(size_t)y * BVXI_LANES] = u;
    }
}

void bvxi_whole_columns(const bvxi_columns *columns)
{
    const uint32_t *const in = columns->in;
    uint32_t *const out = columns->out;
    if (try_search(columns)) return;
    for (int32_t lane = 0; lane < BVXI_LANES; lane++) {
        int32_t const top = build_envelope(columns, in + lane);
        read_envelope(columns, in + lane, top, out + lane,
                      columns->from != NULL ? columns->from + lane : NULL);
    }
}
