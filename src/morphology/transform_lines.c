/* transform_lines.c - distances along one line of voxels, from which transform.c makes those in space: along
 * a row of bits to the nearest target, then along columns by the lower envelope of parabolas.
 *
 * Guarantee: exact. Integers decide for cubic voxels; for others the crossings of parabolas are decided
 * without rounding. Sources: Meijster, Roerdink, Hesselink. 2000; see transform.c. */
#include "morphology/transform.h"

/* ---- Distances along a row of bits to the nearest target, 16 voxels at a time ---- */

/* A table says for each byte how far its bits are from its own set bits; what lies beyond the byte comes in
 * through the nearest target on either side. These are carried from 16 columns to the next, so that each word
 * of a row is looked at a few times, however far targets lie apart. Exact. */

enum { ROW_NONE = 1 << 28 /* further than any target */, BYTE_NONE = 127 };

void bvxi_row_distances_start(bvxi_row_distances *table)
{
    for (int32_t b = 0; b < 256; b++)
        for (int32_t i = 0; i < 8; i++) {
            /* The farthest first, so that the nearest stays. */
            table->near[b][i] = BYTE_NONE;
            for (int32_t d = 7; d >= 0; d--)
                if ((i >= d && (b >> (i - d) & 1)) || (i + d < 8 && (b >> (i + d) & 1)))
                    table->near[b][i] = (uint8_t)d;
        }
}

static inline uint64_t target_word(const bvxi_target_row *row, int32_t k)
{
    uint64_t const w = row->words[k] ^ row->flip;
    return k + 1 == bvxi_row_words(row->size) ? w & bvxi_tail_mask(row->size) : w;
}

/* The first target at x or behind it, x a multiple of 16; -1: none. */
static int32_t first_target(const bvxi_target_row *row, int32_t x)
{
    int32_t const words = bvxi_row_words(row->size);
    int32_t k = x >> 6;
    if (k >= words) return -1;
    uint64_t w = target_word(row, k) & ~UINT64_C(0) << (x & 63);
    while (w == 0) {
        if (++k == words) return -1;
        w = target_word(row, k);
    }
    return k * BVXI_WORD_BITS + bvxi_lowest(w);
}

static inline uint32_t sixteen_targets(const bvxi_target_row *row, int32_t x)
{
    return (uint32_t)(target_word(row, x >> 6) >> (x & 63)) & 0xffffu;
}

void bvxi_row_carry_start(bvxi_row_carry *carry, const bvxi_target_row *row)
{
    carry->left = -1;
    carry->right = first_target(row, BVXI_LANES);
}

void bvxi_row_carry_next(bvxi_row_carry *carry, const bvxi_target_row *row, int32_t x)
{
    /* What was under the lanes before is on the left now. */
    uint32_t const before = sixteen_targets(row, x - BVXI_LANES);
    if (before != 0) carry->left = x - BVXI_LANES + bvxi_highest(before);
    if (carry->right >= 0 && carry->right < x + BVXI_LANES) carry->right = first_target(row, x + BVXI_LANES);
}

/* Eight voxels from x on: left and right are the nearest targets beyond them. */
BVXI_VECTOR_INLINE void byte_steps(const uint8_t *BVXI_RESTRICT near, int32_t left, int32_t right,
                                   int32_t *BVXI_RESTRICT steps)
{
    for (int32_t i = 0; i < 8; i++) {
        int32_t const a = left + i, b = right - i, c = near[i] == BYTE_NONE ? ROW_NONE : near[i];
        int32_t const d = a < b ? a : b;
        steps[i] = c < d ? c : d;
    }
}

int bvxi_row_steps(const bvxi_row_distances *table, const bvxi_row_carry *carry, const bvxi_target_row *row,
                   int32_t x, int32_t reach, int32_t steps[BVXI_LANES], int32_t *places)
{
    uint32_t const bits = sixteen_targets(row, x);
    uint32_t const low = bits & 255u, high = bits >> 8;
    int32_t const left = carry->left < 0 ? ROW_NONE : x - carry->left;
    int32_t const right = carry->right < 0 ? ROW_NONE : carry->right - x;
    if (bits == 0 && left > reach && right - (BVXI_LANES - 1) > reach) return 0;
    /* Each byte sees the other one's nearest target, or the one beyond it. */
    byte_steps(table->near[low], left, high != 0 ? 8 + bvxi_lowest(high) : right, steps);
    byte_steps(table->near[high], low != 0 ? 8 - bvxi_highest(low) : left + 8, right - 8, steps + 8);
    if (places == NULL) return 1;

    /* The nearest target of each voxel by its place: from the left, then from the right; the left one stays where
     * both are as far. */
    int32_t last = carry->left, next = carry->right;
    for (int32_t i = 0; i < BVXI_LANES; i++) {
        if (bits >> i & 1) last = x + i;
        places[i] = last;
    }
    for (int32_t i = BVXI_LANES - 1; i >= 0; i--) {
        if (bits >> i & 1) next = x + i;
        if (places[i] < 0 || (next >= 0 && next - (x + i) < x + i - places[i])) places[i] = next;
    }
    return 1;
}

/* ---- Distances along a column in whole numbers: the lower envelope of parabolas, or where all is near a
 * search ---- */

/* Source: Meijster, Roerdink, Hesselink. A General Algorithm for Computing Distance Transforms in Linear
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

enum { SEARCH_STEPS = 8 };

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

/* Parabolas of a column that are least somewhere: site[i] from start[i] on. Returns the last index. */
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
    /* The search reads all rows, and does not know where the least came from. */
    if (columns->from == NULL && columns->place_count == columns->n &&
        BVXI_PATH(columns->cpu == BVX_CPU_AVX2, search_columns(columns), search_columns_avx2(columns)))
        return;
    for (int32_t lane = 0; lane < BVXI_LANES; lane++) {
        int32_t const top = build_envelope(columns, in + lane);
        read_envelope(columns, in + lane, top, out + lane,
                      columns->from != NULL ? columns->from + lane : NULL);
    }
}

/* ---- Distances along a column in doubles: the lower envelope of parabolas whose crossings are decided
 * exactly ---- */

/* As in transform_lines.c, for g[u] + w (y - u)^2 with real g and w. Up to which place one parabola is at
 * least as good as a later one is first taken in doubles, to within 2^-20; where that lies nearer to a whole
 * number, g[i] - g[u] is compared with w ((y - u)^2 - (y - i)^2) without any rounding: both sides as sums of
 * two doubles (Dekker. A Floating-Point Technique for Extending the Available Precision. 1971; Knuth's sum).
 * So the place that is least in real numbers is found, the lower one of equal ones, and its value is rounded
 * once for the product and once for the sum: nothing depends on where a window begins. */

#define REAL_NEAR (1.0 / 1048576.0) /* the crossings' error is below 2^-23 for places below 2^26 */

/* At y parabola i, of value a at i, is at least as good as u, of value b at u. */
static int as_good(double a, double b, double weight, int32_t i, int32_t u, int32_t y)
{
    /* (y - u)^2 - (y - i)^2, a whole number below 2^53: no rounding. */
    double const steps = (double)((int64_t)(u - i) * ((int64_t)u + i - 2 * (int64_t)y));
    /* a - b as high and low, exactly: low is what rounding took off both numbers. */
    double const dh = a - b, back = dh - a, dl = (a - (dh - back)) - (b + back);
    /* The same of weight * steps, both far from overflow and underflow. The upper 26 bits of each factor:
     * products of halves are exact. */
    double const cw = weight * 134217729.0, cs = steps * 134217729.0; /* 2^27 + 1 */
    double const wh = cw - (cw - weight), sh = cs - (cs - steps), wl = weight - wh, sl = steps - sh;
    double const ph = weight * steps, pl = ((wh * sh - ph) + wh * sl + wl * sh) + wl * sl;
    return dh != ph ? dh < ph : dl <= pl;
}

/* The last place where a parabola on the stack is at least as good as u,
 * near about; at least first, where it is. */
static int32_t last_good(double a, double b, double weight, int32_t i, int32_t u, double about, int32_t first)
{
    int32_t y = (int32_t)about;
    /* Only near a whole number may doubles be wrong; there the exact test decides. */
    if (about - (double)y < REAL_NEAR) {
        if (y > first && !as_good(a, b, weight, i, u, y)) y--;
    } else if ((double)(y + 1) - about < REAL_NEAR) {
        if (as_good(a, b, weight, i, u, y + 1)) y++;
    }
    return y < first ? first : y;
}

static int32_t build_real_envelope(const bvxi_columns *c, const double *in)
{
    double *const height = c->height, *const start = c->start;
    double const unit = 1.0 / c->weight;
    int32_t *const site = c->site;
    int32_t top = -1;

    for (int32_t j = 0; j < c->place_count; j++) {
        int32_t const u = c->places[j];
        double const b = in[(size_t)u * BVXI_LANES];
        int32_t first = 0;
        while (top >= 0) {
            int32_t const i = site[top];
            double const a = height[top];
            double const about = ((b - a) * unit + (double)(u - i) * (double)((int64_t)u + i)) *
                                 c->inverse[u - i];
            /* Surely above the last start, or so near that the exact test has to say. */
            if (about > start[top] + REAL_NEAR ||
                (about >= start[top] - REAL_NEAR && as_good(a, b, c->weight, i, u, (int32_t)start[top]))) {
                first = about >= (double)c->n
                            ? c->n
                            : last_good(a, b, c->weight, i, u, about, (int32_t)start[top]) + 1;
                break;
            }
            top--;
        }
        if (first >= c->n) continue;
        top++;
        height[top] = b;
        start[top] = (double)first;
        site[top] = u;
    }
    return top;
}

void bvxi_real_columns(const bvxi_columns *columns)
{
    const double *const in = columns->in;
    double *const out = columns->out;
    for (int32_t lane = 0; lane < BVXI_LANES; lane++) {
        int32_t const top = build_real_envelope(columns, in + lane);
        for (int32_t i = 0; i <= top; i++) {
            int32_t const u = columns->site[i], end = i < top ? (int32_t)columns->start[i + 1] : columns->n;
            for (int32_t y = (int32_t)columns->start[i]; y < end; y++) {
                /* One product and one sum: the same rounding wherever the window begins. */
                double const d = (double)(y - u);
                size_t const at = (size_t)y * BVXI_LANES + (size_t)lane;
                out[at] = columns->height[i] + columns->weight * (d * d);
                if (columns->from != NULL) columns->from[at] = u;
            }
        }
    }
}
