/* oblique_field.c - a number at every place: inside above 0, on each plane its signed distance to the
 * contours.
 *
 * Source: Franke, Nielson. Smooth interpolation of large sets of scattered data. 1980 (Shepard's weights that
 * end at a distance), with a plane in place of a point: its value is that of the foot point, its weight the
 * third power of what the inverse distance to it is more than the inverse reach. The third power makes the
 * gradient on a plane that of its own values and of nothing else.
 *
 * The smooth number (oblique_smooth.c) comes near to the planes' distances; what is left of them is spread by
 * the weights to the nearest planes' surroundings. Far from its contours a plane only asks for the right
 * sign.
 *
 * Beyond the contours' box the way to it is taken off: the body ends in a dome. */
#include "oblique/oblique.h"

#include <math.h>

/* A raster a plane, two cells wide and bilinear in between. Between planes the body follows a curve through the
 * contours' points: over each segment a cubic with the circle's slopes at its ends, flat at corners, and only where
 * it leaves the chord by some hundredths of a cell. Signs next to contours are computed, not taken from the raster. */

#define BULGE_CORNER 0.7  /* cosine of the turn from which on a point is a corner */
#define BULGE_FULL   0.03 /* cells: so far a bulge counts; from twice as far on it does not */

/* ---- the curve through a contour's points ---- */

static uint32_t point_before(const bvxi_plane *p, uint32_t i)
{
    if (i > 0 && p->next[i - 1] == i) return i - 1;
    /* The first of its loop: the last one is at the end of the loop's points. */
    return i + p->contour[bvxi_contour_of(p, i)].count - 1;
}

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
    uint32_t const end = p->next[i];
    const double *const a = p->uv[i], *const b = p->uv[end];
    const double *const before = p->uv[point_before(p, i)], *const after = p->uv[p->next[end]];
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

/* The segment nearest to a place, among those of the group that a search for it has ended in. */
static uint32_t nearest_of_group(const bvxi_plane *p, uint32_t group, const double at[2])
{
    uint32_t nearest = 0;
    double least = 1e300;
    for (uint32_t n = group; n < group + BVXI_SEGMENT_GROUP && n < p->segment_count; n++) {
        uint32_t const i = p->segment == NULL ? n : p->segment[n];
        double const square = bvxi_segment_square(p->uv[i], p->uv[p->next[i]], at);
        if (square < least) {
            least = square;
            nearest = i;
        }
    }
    return nearest;
}

double bvxi_oblique_curved(const bvxi_oblique *o, uint32_t plane, const double uv[2], uint32_t *hint)
{
    const bvxi_plane *const p = &o->plane[plane].plane;
    double const d = bvxi_plane_distance(p, uv[0], uv[1], hint);
    uint32_t const i = nearest_of_group(p, *hint, uv);
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

static bvx_status oblique_rows(const bvxi_oblique *o, bvxi_row_fn *row)
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
    return oblique_rows(o, raster_row);
}

/* What a raster of a plane has at a place's foot point. */
static double raster_at(const bvxi_oblique_plane *p, const float *raster, const double at[3])
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
    {
        double const low = row[0] + t[0] * ((double)row[1] - row[0]);
        double const high = row[p->raster_size[0]] +
                            t[0] * ((double)row[p->raster_size[0] + 1] - row[p->raster_size[0]]);
        return low + t[1] * (high - low);
    }
}

/* The distance of a place's foot point on a plane. */
static double oblique_distance(const bvxi_oblique *o, uint32_t plane, const double at[3])
{
    const bvxi_oblique_plane *const p = &o->plane[plane];
    return p->raster == NULL ? -0.25 * o->longest : raster_at(p, p->raster, at);
}

int bvxi_oblique_side(const bvxi_oblique *o, uint32_t plane, const double at[3])
{
    double const near = oblique_distance(o, plane, at);
    /* a bilinear cell of distances is off by less than its diagonal */
    if (bvxi_absolute(near) > 1.5 * BVXI_RASTER_STEP) return near > 0.0 ? 1 : -1;
    return bvxi_oblique_exact(o, plane, at) > 0.0 ? 1 : -1;
}

/* ---- the number ---- */

#define REST_FAR   2.0 /* nodes: distances beyond only have to be beyond */
#define REST_REACH 3.0 /* nodes */

/* From a distance and the smooth number: nothing left where both are far on one side. */
static double rest_of(const bvxi_oblique *o, double distance, double smooth)
{
    double const sign = distance < 0.0 ? -1.0 : 1.0;
    double const far = REST_FAR / o->smooth.scale;
    double const d = sign * distance, s = sign * smooth;
    double const low = d > far ? far : d, high = d > far ? far + 4.0 * (d - far) : d;
    return sign * (s < low ? low - s : s > high ? high - s : 0.0);
}

static void rest_row(const bvxi_oblique *o, const bvxi_oblique_plane *p, int32_t row)
{
    for (int32_t i = 0; i < p->raster_size[0]; i++) {
        int64_t const n = (int64_t)row * p->raster_size[0] + i;
        double const u = p->raster_low[0] + BVXI_RASTER_STEP * i,
                     v = p->raster_low[1] + BVXI_RASTER_STEP * row;
        double at[3];
        for (int k = 0; k < 3; k++)
            at[k] = p->offset * p->normal[k] + (u * p->axis[0][k] + v * p->axis[1][k]);
        p->rest[n] = (float)rest_of(o, p->raster[n], bvxi_smooth_at(&o->smooth, at));
    }
}

bvx_status bvxi_oblique_rest(bvxi_oblique *o)
{
    o->reach = REST_REACH / o->smooth.scale;
    for (uint32_t i = 0; i < o->plane_count; i++) {
        bvxi_oblique_plane *const p = &o->plane[i];
        if (p->raster == NULL) continue;
        BVXI_TRY(BVXI_ARRAY(o->ctx, (uint64_t)p->raster_size[0] * (uint64_t)p->raster_size[1],
                            "the distances on planes", p->rest));
    }
    return oblique_rows(o, rest_row);
}

static double beyond_box(const double low[3], const double high[3], const double at[3])
{
    double sum = 0.0;
    for (int k = 0; k < 3; k++) {
        double const below = low[k] - at[k], above = at[k] - high[k];
        double const off = below > 0.0 ? below : above > 0.0 ? above : 0.0;
        sum += off * off;
    }
    return sum > 0.0 ? sqrt(sum) : 0.0;
}

static double near_number(const bvxi_oblique *o, const double at[3], const uint32_t *plane, uint32_t count)
{
    double const smooth = bvxi_smooth_at(&o->smooth, at), beyond = 1.0 / o->reach;
    double sum = 0.0, weights = beyond * beyond * beyond;

    for (uint32_t n = 0; n < count; n++) {
        const bvxi_oblique_plane *const p = &o->plane[plane == NULL ? n : plane[n]];
        double const h = bvxi_absolute(bvxi_oblique_height(p, at));
        if (h >= o->reach) continue;
        /* Inverse distance, less what it is at the reach, so that it ends there without a step; cubed, as the
         * nearer plane should decide. */
        double weight = 1.0 / (h + BVXI_OBLIQUE_NEAR) - beyond;
        weight *= weight * weight;
        sum += weight *
               (p->raster == NULL ? rest_of(o, -0.25 * o->longest, smooth) : raster_at(p, p->rest, at));
        weights += weight;
    }
    return smooth + sum / weights - beyond_box(o->low, o->high, at);
}

double bvxi_oblique_number_among(const bvxi_oblique *o, const double at[3], const uint32_t *plane,
                                 uint32_t count)
{
    double near[3];
    if (bvxi_oblique_is_near(o, at)) return near_number(o, at, plane, count);
    /* Farther away it falls by the way to where it ends, which no other body's surroundings do. */
    for (int k = 0; k < 3; k++) {
        near[k] = at[k] < o->near_low[k] ? o->near_low[k] : at[k];
        near[k] = near[k] > o->near_high[k] ? o->near_high[k] : near[k];
    }
    return near_number(o, near, plane, count) - beyond_box(o->near_low, o->near_high, at);
}

double bvxi_oblique_number(const bvxi_oblique *o, const double at[3])
{
    return bvxi_oblique_number_among(o, at, NULL, o->plane_count);
}
