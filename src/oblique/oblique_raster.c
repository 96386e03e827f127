/* oblique_raster.c - signed distances on each plane: a raster a plane, two cells wide and bilinear in
 * between.
 *
 * Contours of curved bodies are chords. Between the planes the body follows a curve through their points
 * instead: over each segment a cubic with the circle's slopes at its ends, flat at corners. Only where it
 * leaves the chord by some hundredths of a cell, less than cells show; what bulges farther is left straight,
 * as the contour has it. On the planes, and for signs, contours are what they are.
 *
 * Signs next to contours are not taken from the raster but computed. */
#include "oblique/oblique.h"

#include <math.h>

#define BULGE_CORNER 0.7  /* cosine of the turn from which on a point is a corner */
#define BULGE_FULL   0.03 /* cells: so far a bulge counts; from twice as far on it does not */

/* ---- the curve through a contour's points ---- */

/* The curve's slope against a segment where it meets the one beside it; 0: there is a corner. */
static int bulge_slope(const double segment[2], const double beside[2], double *slope)
{
    double const own = sqrt(segment[0] * segment[0] + segment[1] * segment[1]);
    double const other = sqrt(beside[0] * beside[0] + beside[1] * beside[1]);
    double const dot = segment[0] * beside[0] + segment[1] * beside[1];
    double const cross = segment[0] * beside[1] - segment[1] * beside[0];
    if (!(dot > BULGE_CORNER * own * other)) return 0;
    /* The tangent of half the turn, as on a circle with equal segments. The longer of two takes less. */
    *slope = cross / (own * other + dot) * (2.0 * (own < other ? own : other) / (own + other));
    return 1;
}

/* How far the curve lies to the left of a segment, beside a place. */
static double bulge_beside(const bvxi_plane *p, uint32_t i, const double at[2])
{
    /* The point before the first of its loop is the last of the loop's points. */
    uint32_t const end = p->next[i], start = i > 0 && p->next[i - 1] == i
                                                 ? i - 1
                                                 : i + p->contour[bvxi_contour_of(p, i)].count - 1;
    const double *const a = p->uv[i], *const b = p->uv[end];
    const double *const before = p->uv[start], *const after = p->uv[p->next[end]];
    double const segment[2] = {b[0] - a[0], b[1] - a[1]};
    double const last[2] = {a[0] - before[0], a[1] - before[1]}, next[2] = {after[0] - b[0], after[1] - b[1]};
    double const square = segment[0] * segment[0] + segment[1] * segment[1];
    double const t = ((at[0] - a[0]) * segment[0] + (at[1] - a[1]) * segment[1]) / square;
    double length = sqrt(square), from, to, most;

    if (!(t > 0.0 && t < 1.0)) return 0.0;
    if (!bulge_slope(segment, last, &from) || !bulge_slope(segment, next, &to)) return 0.0;

    /* On the plane the contour itself decides, and a groove would run along it if the curve were far off. */
    most = 0.125 * length * (bvxi_absolute(from) + bvxi_absolute(to));
    if (!(most < 2.0 * BULGE_FULL)) return 0.0;
    if (most > BULGE_FULL) length *= 2.0 - most / BULGE_FULL;
    return length * (t * (1.0 - t)) * (from * (1.0 - t) - to * t);
}

double bvxi_oblique_curved(const bvxi_oblique *o, uint32_t plane, const double uv[2], uint32_t *hint)
{
    const bvxi_plane *const p = &o->plane[plane].plane;
    double const d = bvxi_plane_distance(p, uv[0], uv[1], hint);
    uint32_t i = 0;
    double least = 1e300;

    /* The nearest segment is in the group that the search has ended in. */
    for (uint32_t n = *hint; n < *hint + BVXI_SEGMENT_GROUP && n < p->segment_count; n++) {
        uint32_t const k = p->segment == NULL ? n : p->segment[n];
        double const square = bvxi_segment_square(p->uv[k], p->uv[p->next[k]], uv);
        if (square >= least) continue;
        least = square;
        i = k;
    }
    const double *const a = p->uv[i], *const b = p->uv[p->next[i]];
    int const inside = bvxi_oblique_encloses(o, plane, uv);
    int const left = (b[0] - a[0]) * (uv[1] - a[1]) - (b[1] - a[1]) * (uv[0] - a[0]) > 0.0;
    double const bulge = bulge_beside(p, i, uv);
    /* A curve to the left is nearer to what lies there: inside it is less deep, outside less far. */
    return (inside ? d : -d) + (left == inside ? -bulge : bulge);
}

/* ---- rasters ---- */

static void raster_row(const bvxi_oblique *o, const bvxi_oblique_plane *p, int32_t row)
{
    uint32_t const plane = (uint32_t)(p - o->plane);
    uint32_t hint = 0;
    for (int32_t i = 0; i < p->raster_size[0]; i++) {
        double const uv[2] = {p->raster_low[0] + BVXI_RASTER_STEP * i,
                              p->raster_low[1] + BVXI_RASTER_STEP * row};
        p->raster[(int64_t)row * p->raster_size[0] + i] = (float)bvxi_oblique_curved(o, plane, uv, &hint);
    }
}

typedef struct rows_job {
    const bvxi_oblique *o;
    bvxi_row_fn *row;
} rows_job;

static void rows_piece(void *user, int32_t row)
{
    const rows_job *const job = user;
    const bvxi_oblique_plane *p = job->o->plane;
    for (; p->raster == NULL || row >= p->raster_size[1]; p++)
        if (p->raster != NULL) row -= p->raster_size[1];
    job->row(job->o, p, row);
}

bvx_status bvxi_oblique_rows(const bvxi_oblique *o, bvxi_row_fn *row)
{
    rows_job job = {o, row};
    uint64_t rows = 0;
    for (uint32_t i = 0; i < o->plane_count; i++)
        if (o->plane[i].raster != NULL) rows += (uint64_t)o->plane[i].raster_size[1];
    if (rows > INT32_MAX)
        return bvxi_fail_for(o->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY, "%s: too many planes and cells",
                             o->function);
    return bvxi_each(o->ctx, "sections", 0.0, 1.0, (int32_t)rows, rows_piece, &job);
}

bvx_status bvxi_oblique_raster(bvxi_oblique *o)
{
    for (uint32_t i = 0; i < o->plane_count; i++) {
        bvxi_oblique_plane *const p = &o->plane[i];
        double low[2] = {1e300, 1e300}, high[2] = {-1e300, -1e300};
        int32_t size[2];

        if (p->plane.contour_count == 0) continue;
        /* what the plane has of the box where the number is made, from the box's corners */
        for (int corner = 0; corner < 8; corner++) {
            double const at[3] = {(corner & 1 ? o->near_high : o->near_low)[0],
                                  (corner & 2 ? o->near_high : o->near_low)[1],
                                  (corner & 4 ? o->near_high : o->near_low)[2]};
            double uv[2];
            bvxi_oblique_uv(p, at, uv);
            bvxi_widen(low, high, uv, 2);
        }
        for (int k = 0; k < 2; k++) {
            p->raster_low[k] = low[k];
            size[k] = (int32_t)((high[k] - low[k]) / BVXI_RASTER_STEP) + 2;
        }
        BVXI_TRY(
            BVXI_ARRAY(o->ctx, (uint64_t)size[0] * (uint64_t)size[1], "the distances on planes", p->raster));
        memcpy(p->raster_size, size, sizeof size);
    }
    return bvxi_oblique_rows(o, raster_row);
}

double bvxi_oblique_raster_at(const bvxi_oblique_plane *p, const float *raster, const double at[3])
{
    double uv[2], t[2];
    int32_t i[2];

    bvxi_oblique_uv(p, at, uv);
    for (int k = 0; k < 2; k++) {
        double x = (uv[k] - p->raster_low[k]) * (1.0 / BVXI_RASTER_STEP);
        /* Places just beyond the raster take its border. */
        double const most = p->raster_size[k] - 1;
        x = x < 0.0 ? 0.0 : x > most ? most : x;
        i[k] = (int32_t)x;
        if (i[k] > p->raster_size[k] - 2) i[k] = p->raster_size[k] - 2;
        t[k] = x - i[k];
    }
    const float *const row = raster + (int64_t)i[1] * p->raster_size[0] + i[0];
    const float *const next = row + p->raster_size[0];
    double const low = row[0] + t[0] * ((double)row[1] - row[0]);
    double const high = next[0] + t[0] * ((double)next[1] - next[0]);
    return low + t[1] * (high - low);
}
