/* oblique_raster.c - signed distances on each plane: a raster a plane, two cells wide and bilinear in
 * between.
 *
 * Signs next to contours are not taken from it but computed. */
#include "section/oblique.h"

static void raster_row(const bvxi_oblique *o, const bvxi_oblique_plane *p, int32_t row)
{
    uint32_t const plane = (uint32_t)(p - o->plane);
    uint32_t hint = 0;

    for (int32_t i = 0; i < p->raster_size[0]; i++) {
        double const uv[2] = {p->raster_low[0] + BVXI_RASTER_STEP * i,
                              p->raster_low[1] + BVXI_RASTER_STEP * row};
        double const d = bvxi_plane_distance(&p->plane, uv[0], uv[1], &hint);
        p->raster[(int64_t)row * p->raster_size[0] + i] = (float)(bvxi_oblique_encloses(o, plane, uv) ? d
                                                                                                      : -d);
    }
}

const bvxi_oblique_plane *bvxi_oblique_plane_of_row(const bvxi_oblique *o, int32_t *row)
{
    const bvxi_oblique_plane *p = o->plane;

    for (; p->raster == NULL || *row >= p->raster_size[1]; p++)
        if (p->raster != NULL) *row -= p->raster_size[1];
    return p;
}

static void raster_piece(void *user, int32_t index, int32_t worker)
{
    const bvxi_oblique *const o = user;
    int32_t row = index;
    const bvxi_oblique_plane *const p = bvxi_oblique_plane_of_row(o, &row);

    (void)worker;
    raster_row(o, p, row);
}

bvx_status bvxi_oblique_raster(bvxi_oblique *o)
{
    uint64_t rows = 0;

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
            for (int k = 0; k < 2; k++) {
                low[k] = uv[k] < low[k] ? uv[k] : low[k];
                high[k] = uv[k] > high[k] ? uv[k] : high[k];
            }
        }
        for (int k = 0; k < 2; k++) {
            p->raster_low[k] = low[k];
            size[k] = (int32_t)((high[k] - low[k]) / BVXI_RASTER_STEP) + 2;
        }
        BVXI_TRY(bvxi_alloc(o->ctx, BVXI_SCRATCH, (uint64_t)size[0] * (uint64_t)size[1] * 4,
                            "the distances on planes", &p->raster));
        memcpy(p->raster_size, size, sizeof size);
        rows += (uint64_t)size[1];
    }

    /* All rows of all planes are one list, so that threads share planes of any size evenly. */
    if (rows > INT32_MAX)
        return bvxi_fail_for(o->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY, "%s: too many planes and cells",
                             o->function);
    return bvxi_parallel(o->ctx, "sections", 0.0, 1.0, (int32_t)rows, raster_piece, o);
}

double bvxi_oblique_raster_at(const bvxi_oblique_plane *p, const float *raster, const double at[3])
{
    double uv[2], t[2];
    int32_t i[2];
    const float *row;

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
    row = raster + (int64_t)i[1] * p->raster_size[0] + i[0];
    {
        double const low = row[0] + t[0] * ((double)row[1] - row[0]);
        double const high = row[p->raster_size[0]] +
                            t[0] * ((double)row[p->raster_size[0] + 1] - row[p->raster_size[0]]);
        return low + t[1] * (high - low);
    }
}

double bvxi_oblique_distance(const bvxi_oblique *o, uint32_t plane, const double at[3])
{
    const bvxi_oblique_plane *const p = &o->plane[plane];

    return p->raster == NULL ? -0.25 * o->longest : bvxi_oblique_raster_at(p, p->raster, at);
}

int bvxi_oblique_side(const bvxi_oblique *o, uint32_t plane, const double at[3])
{
    double const near = bvxi_oblique_distance(o, plane, at);

    /* a bilinear cell of distances is off by less than its diagonal */
    if (bvxi_absolute(near) > 1.5 * BVXI_RASTER_STEP) return near > 0.0 ? 1 : -1;
    return bvxi_oblique_exact(o, plane, at) > 0.0 ? 1 : -1;
}
