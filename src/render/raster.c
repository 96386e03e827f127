/* raster.c - convex polygons into samples with a depth each, triangles sorted into bands of rows, and
 * triangles clipped against a box.
 *
 * Guarantee: edges are walked in integers, so polygons that share an edge leave no gap and take no sample
 * twice; bands do not show. Sources at the headings below. */
#include "render/raster.h"
#include "lattice/lattice.h"
#include "mesh/facet.h"

/* ---- A convex polygon row by row, with a depth buffer ---- */

/* Idea: each edge walks down its rows and leaves the first sample at or right of it; between the two edges of
 * a row lies the span. The walk is exact: quotient and remainder of one division, then additions
 * (Bresenham). */

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

/* Let the edge from a down to b (a above b) take part in the spans of rows [begin, end), which it crosses. */
static void raster_edge(raster_span *span, int32_t first, int32_t begin, int32_t end, const int32_t a[2],
                        const int32_t b[2], int32_t bits)
{
    int64_t const dx = (int64_t)b[0] - a[0], dy = (int64_t)b[1] - a[1];
    int64_t const half = INT64_C(1) << (bits - 1), unit = dy * ((int64_t)1 << bits);
    int64_t const y = ((int64_t)begin * 2 + 1) * half;
    /* first sample at or right of it: floor(n / unit) */
    int64_t const n = (a[0] - half) * dy + dx * (y - a[1]) + unit - 1;
    int64_t x = bvxi_floor_div(n, unit), rest = n - x * unit;
    int64_t step = 0, step_rest = 0;

    /* A single row needs no step, and most edges are that short. */
    if (end - begin > 1) {
        step = bvxi_floor_div(dx, dy);
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

    /* The box first: most triangles of a fine mesh lie between two rows or two columns of samples. */
    for (int32_t k = 1; k < count; k++)
        for (int32_t a = 0; a < 2; a++) {
            low[a] = corner[k][a] < low[a] ? corner[k][a] : low[a];
            high[a] = corner[k][a] > high[a] ? corner[k][a] : high[a];
        }
    int32_t begin = bvxi_centres_below(low[1], bits);
    int32_t end = bvxi_centres_below(high[1], bits);
    begin = begin < rows.begin ? rows.begin : begin;
    end = end > rows.end ? rows.end : end;
    if (begin >= end || bvxi_centres_below(low[0], bits) >= bvxi_centres_below(high[0], bits)) return;
    for (int32_t row = 0; row < end - begin; row++) {
        span.left[row] = INT32_MAX;
        span.right[row] = INT32_MIN;
    }
    for (int32_t k = 0; k < count; k++) {
        const int32_t *a = corner[k], *b = corner[k + 1 == count ? 0 : k + 1];
        if (a[1] > b[1]) {
            const int32_t *const other = a;
            a = b;
            b = other;
        }
        int32_t from = bvxi_centres_below(a[1], bits);
        int32_t to = bvxi_centres_below(b[1], bits);
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

/* ---- Triangles sorted into bands by counting ---- */

/* Pieces of triangles count how many reach each band, prefix sums give each piece its places, and the pieces
 * fill them in. A band has its triangles in ascending order, so the result depends on no thread. */

enum { BINS_GRAIN = 16384 /* triangles a piece, at least */, BINS_PIECES = 64 };

typedef struct bins_work {
    bvxi_triangle_bins *bins;
    uint64_t triangle_count;
    int32_t pieces;
    bvxi_bands_fn *reach;
    const void *user;
    uint64_t *place; /* of each piece and band: first a count, then where its next triangle goes */
} bins_work;

static void walk_bins_piece(const bins_work *w, int32_t index, int fill)
{
    uint64_t *const place = w->place + (size_t)index * (size_t)w->bins->bands;
    uint64_t begin, end;
    int32_t first, last;
    bvxi_piece(w->triangle_count, w->pieces, index, &begin, &end);
    for (uint64_t t = begin; t < end; t++) {
        if (!w->reach(w->user, (uint32_t)t, &first, &last)) continue;
        for (int32_t b = first; b <= last; b++) {
            if (fill) w->bins->triangle[place[b]] = (uint32_t)t;
            place[b]++;
        }
    }
}

static void count_bins_piece(void *user, int32_t index)
{
    walk_bins_piece(user, index, 0);
}

static void fill_bins_piece(void *user, int32_t index)
{
    walk_bins_piece(user, index, 1);
}

bvx_status bvxi_triangle_bins_open(bvx_context *ctx, uint64_t triangle_count, int32_t bands,
                                   bvxi_bands_fn *reach, const void *user, bvxi_triangle_bins *bins)
{
    bins_work w = {bins, triangle_count, bvxi_piece_count(triangle_count, BINS_GRAIN), reach, user, NULL};
    w.pieces = w.pieces < BINS_PIECES ? w.pieces : BINS_PIECES;
    uint64_t const places = (uint64_t)w.pieces * (uint64_t)bands;
    bins->bands = bands;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, ((uint64_t)bands + 1) * 8, "the picture's bands", &bins->begin));
    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, places * 8, "the picture's bands", &w.place));
    BVXI_TRY(bvxi_each(ctx, "render", 0.1, 0.15, w.pieces, count_bins_piece, &w));
    uint64_t sum = 0;

    /* Bands outermost, so that in each of them the pieces stand in their order. */
    for (int32_t b = 0; b < w.bins->bands; b++) {
        w.bins->begin[b] = sum;
        for (int32_t p = 0; p < w.pieces; p++) {
            uint64_t *const place = &w.place[(size_t)p * (size_t)w.bins->bands + (size_t)b];
            uint64_t const n = *place;
            *place = sum;
            sum += n;
        }
    }
    w.bins->begin[w.bins->bands] = sum;
    w.bins->total = sum;

    BVXI_TRY(bvxi_alloc(ctx, BVXI_SCRATCH, bins->total * 4, "the picture's triangles", &bins->triangle));
    BVXI_TRY(bvxi_each(ctx, "render", 0.15, 0.2, w.pieces, fill_bins_piece, &w));
    bvxi_drop(ctx, w.place);
    return BVX_OK;
}

/* ---- A triangle clipped against a box, plane after plane ---- */

/* Source: Sutherland, Hodgman. Reentrant Polygon Clipping. 1974.
 * A point where an edge crosses a plane is computed from the edge's lesser end (by x, then y, then z),
 * whichever way the polygon goes round, and lies on the plane exactly. Both triangles of an edge are clipped
 * by the same planes in the same order, so they keep the same piece of it. */

/* What lies on one side of a plane; sign 1: at or above it, -1: at or below. */
static int32_t cut_by_plane(const double (*in)[3], int32_t n, int axis, double plane, double sign,
                            double (*out)[3])
{
    int32_t count = 0;
    /* Points on the plane count as inside, so a triangle that only touches it keeps its corner. */
    for (int32_t i = 0; i < n; i++) {
        const double *const p = in[i], *const q = in[i + 1 == n ? 0 : i + 1];
        double const here = sign * (p[axis] - plane), there = sign * (q[axis] - plane);
        if (here >= 0.0) memcpy(out[count++], p, 3 * sizeof *p);
        if ((here < 0.0 && there > 0.0) || (here > 0.0 && there < 0.0)) {
            const double *const from = bvxi_corner_before(q, p) ? q : p, *const to = from == p ? q : p;
            double const share = (plane - from[axis]) / (to[axis] - from[axis]);
            for (int k = 0; k < 3; k++) out[count][k] = from[k] + share * (to[k] - from[k]);
            out[count++][axis] = plane;
        }
    }
    return count < 3 ? 0 : count;
}

int32_t bvxi_cut_triangle(const bvxi_cut *cut, const double triangle[3][3], double corner[BVXI_CUT_MOST][3])
{
    double other[BVXI_CUT_MOST][3];
    double(*from)[3] = corner, (*to)[3] = other;
    int32_t n = 3;

    memcpy(corner, triangle, 3 * sizeof *corner);

    /* Two arrays take turns; a plane that cuts nothing off is skipped: most triangles stay in place. */
    for (int a = 0; a < 3; a++)
        for (int high = 0; high < 2 && n > 0; high++) {
            double const plane = high ? cut->high[a] : cut->low[a], sign = high ? -1.0 : 1.0;
            double(*const last)[3] = from;
            int32_t inside = 0;
            for (int32_t i = 0; i < n; i++) inside += sign * (from[i][a] - plane) >= 0.0;
            if (inside == n) continue;
            n = cut_by_plane((const double(*)[3])from, n, a, plane, sign, to);
            from = to;
            to = last;
        }
    if (n > 0 && from != corner) memcpy(corner, from, (size_t)n * sizeof *corner);
    return n;
}
