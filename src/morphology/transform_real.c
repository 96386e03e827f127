/* transform_real.c - distances along a column in doubles: the lower envelope of parabolas whose crossings are
 * decided exactly.
 *
 * As in transform_columns.c, for g[u] + w (y - u)^2 with real g and w. Up to which place one parabola is at
 * least as good as a later one is first taken in doubles, to within 2^-20; where that lies nearer to a whole
 * number, g[i] - g[u] is compared with w ((y - u)^2 - (y - i)^2) without any rounding: both sides as sums of
 * two doubles (Dekker. A Floating-Point Technique for Extending the Available Precision. 1971; Knuth's sum).
 * So the place that is least in real numbers is found, the lower one of equal ones, and its value is rounded
 * once for the product and once for the sum: nothing depends on where a window begins. */
#include "morphology/transform.h"

#define REAL_NEAR (1.0 / 1048576.0) /* the crossings' error is below 2^-23 for places below 2^26 */

/* a * b as high + low, exactly; both far from overflow and underflow. */
static void split_product(double a, double b, double *high, double *low)
{
    /* The upper 26 bits of each factor: products of halves are exact. */
    double const ca = a * 134217729.0, cb = b * 134217729.0; /* 2^27 + 1 */
    double const ah = ca - (ca - a), bh = cb - (cb - b), al = a - ah, bl = b - bh;
    *high = a * b;
    *low = ((ah * bh - *high) + ah * bl + al * bh) + al * bl;
}

/* a - b as high + low, exactly. */
static void split_difference(double a, double b, double *high, double *low)
{
    double const d = a - b, back = d - a;
    /* What rounding took off both numbers. */
    *high = d;
    *low = (a - (d - back)) - (b + back);
}

/* At y parabola i, of value a at i, is at least as good as u, of value b at u. */
static int as_good(double a, double b, double weight, int32_t i, int32_t u, int32_t y)
{
    /* (y - u)^2 - (y - i)^2, a whole number below 2^53: no rounding. */
    double const steps = (double)((int64_t)(u - i) * ((int64_t)u + i - 2 * (int64_t)y));
    double dh, dl, ph, pl;
    split_difference(a, b, &dh, &dl);
    split_product(weight, steps, &ph, &pl);
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
        /* As with whole numbers, but a start near a crossing is decided exactly. */
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
        /* Least only beyond the column's end. */
        if (first >= c->n) continue;
        top++;
        height[top] = b;
        start[top] = (double)first;
        site[top] = u;
    }
    return top;
}

static void read_real_envelope(const bvxi_columns *c, int32_t top, double *out, int32_t *from)
{
    for (int32_t i = 0; i <= top; i++) {
        int32_t const u = c->site[i], end = i < top ? (int32_t)c->start[i + 1] : c->n;
        for (int32_t y = (int32_t)c->start[i]; y < end; y++) {
            /* One product and one sum: the same rounding wherever the window begins. */
            double const d = (double)(y - u);
            out[(size_t)y * BVXI_LANES] = c->height[i] + c->weight * (d * d);
            if (from != NULL) from[(size_t)y * BVXI_LANES] = u;
        }
    }
}

void bvxi_real_columns(const bvxi_columns *columns)
{
    const double *const in = columns->in;
    double *const out = columns->out;
    for (int32_t lane = 0; lane < BVXI_LANES; lane++) {
        int32_t const top = build_real_envelope(columns, in + lane);
        read_real_envelope(columns, top, out + lane, columns->from != NULL ? columns->from + lane : NULL);
    }
}
