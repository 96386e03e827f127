/* raster.c - a convex polygon row by row, with a depth buffer.
 *
 * Idea: each edge walks down its rows and leaves the first sample at or right of it; between the two edges of
 * a row lies the span. The walk is exact: quotient and remainder of one division, then additions
 * (Bresenham). */
#include "render/raster.h"

#include "lattice/lattice.h"

typedef struct raster_span {
    /* samples [left, right) of each row from the first */
    int32_t left[BVXI_RASTER_BAND], right[BVXI_RASTER_BAND];
} raster_span;

int32_t bvxi_raster_fraction_bits(int32_t side)
{
    int32_t bits = 20;
    /* More bits than that would leave 30 bits a coordinate, and products of two must fit 64. */
    while (bits > 0 && (int64_t)side << bits > INT64_C(1) << 29) bits--;
    return bits;
}

void bvxi_raster_clear(const bvxi_raster *raster, bvxi_raster_rows rows)
{
    size_t const begin = (size_t)rows.begin * (size_t)raster->width;
    size_t const end = (size_t)rows.end * (size_t)raster->width;
    memset(raster->id + begin, 0, (end - begin) * sizeof *raster->id);
    for (size_t i = begin; i < end; i++) raster->depth[i] = BVXI_RASTER_FAR;
}

static int64_t raster_floor_div(int64_t n, int64_t d)
{
    int64_t const q = n / d;
    return q - (n % d < 0);
}

/* Let the edge from a down to b (a above b) take part in the spans of rows [begin, end), which it crosses. */
static void raster_edge(raster_span *span, int32_t first, int32_t begin, int32_t end, const int32_t a[2],
                        const int32_t b[2], int32_t bits)
{
    int64_t const dx = (int64_t)b[0] - a[0], dy = (int64_t)b[1] - a[1];
    int64_t const half = INT64_C(1) << (bits - 1), unit = dy * ((int64_t)1 << bits);
    int64_t const y = ((int64_t)begin * 2 + 1) * half;
    /* first sample at or right of it: floor(n / unit) */
    int64_t const n = (a[0] - half) * dy + dx * (y - a[1]) + unit - 1;
    int64_t x = raster_floor_div(n, unit), rest = n - x * unit;
    int64_t step = 0, step_rest = 0;

    /* A single row needs no step, and most edges are that short. */
    if (end - begin > 1) {
        step = raster_floor_div(dx, dy);
        step_rest = (dx - step * dy) * ((int64_t)1 << bits);
    }

    /* Quotient and remainder move on together: exact on every row, without another division. */
    for (int32_t row = begin - first; row < end - first; row++) {
        if (x < span->left[row]) span->left[row] = (int32_t)x;
        if (x > span->right[row]) span->right[row] = (int32_t)x;
        x += step;
        rest += step_rest;
        if (rest >= unit) {
            rest -= unit;
            x++;
        }
    }
}

static void raster_fill(const bvxi_raster *r, int32_t row, int32_t left, int32_t right,
                        const bvxi_raster_plane *p, uint32_t id)
{
    size_t const at = (size_t)row * (size_t)r->width;

    /* The value at the middle of the row; samples differ by the slope along x. */
    double const z = p->z + p->dy * (row + 0.5 - p->y);

    for (int32_t x = left; x < right; x++) {
        double const exact = z + p->dx * (x + 0.5 - p->x);
        float const d = (float)(exact < p->low ? p->low : exact > p->high ? p->high : exact);
        /* The nearest wins; of equals the first drawn, whose order is that of the triangles. */
        if (d > r->depth[at + (size_t)x]) {
            r->depth[at + (size_t)x] = d;
            r->id[at + (size_t)x] = id;
        }
    }
}

void bvxi_raster_polygon(const bvxi_raster *raster, bvxi_raster_rows rows, const int32_t (*corner)[2],
                         int32_t count, const bvxi_raster_plane *plane, uint32_t id)
{
    int32_t const bits = raster->fraction_bits;
    int32_t low[2] = {corner[0][0], corner[0][1]}, high[2] = {corner[0][0], corner[0][1]};
    raster_span span;
    int32_t begin, end;

    /* The box first: most triangles of a fine mesh lie between two rows or two columns of samples. */
    for (int32_t k = 1; k < count; k++)
        for (int32_t a = 0; a < 2; a++) {
            low[a] = corner[k][a] < low[a] ? corner[k][a] : low[a];
            high[a] = corner[k][a] > high[a] ? corner[k][a] : high[a];
        }
    begin = bvxi_centres_below(low[1], bits);
    end = bvxi_centres_below(high[1], bits);
    begin = begin < rows.begin ? rows.begin : begin;
    end = end > rows.end ? rows.end : end;
    /* between samples */
    if (begin >= end || bvxi_centres_below(low[0], bits) >= bvxi_centres_below(high[0], bits)) return;
    for (int32_t row = 0; row < end - begin; row++) {
        span.left[row] = INT32_MAX;
        span.right[row] = INT32_MIN;
    }
    /* Each edge that crosses rows of the band narrows or widens the spans of these rows. */
    for (int32_t k = 0; k < count; k++) {
        const int32_t *a = corner[k], *b = corner[k + 1 == count ? 0 : k + 1];
        int32_t from, to;
        if (a[1] > b[1]) {
            const int32_t *const other = a;
            a = b;
            b = other;
        }
        from = bvxi_centres_below(a[1], bits);
        to = bvxi_centres_below(b[1], bits);
        from = from < begin ? begin : from;
        to = to > end ? end : to;
        if (from < to) raster_edge(&span, begin, from, to, a, b, bits);
    }
    for (int32_t row = 0; row < end - begin; row++) {
        int32_t const left = span.left[row] < 0 ? 0 : span.left[row];
        int32_t const right = span.right[row] > raster->width ? raster->width : span.right[row];
        if (left < right) raster_fill(raster, begin + row, left, right, plane, id);
    }
}
