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
    return bvxi_oblique_rows(o, rest_row);
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
        sum += weight * (p->raster == NULL ? rest_of(o, -0.25 * o->longest, smooth)
                                           : bvxi_oblique_raster_at(p, p->rest, at));
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
