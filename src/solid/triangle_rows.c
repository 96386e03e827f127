/* triangle_rows.c - the rows that one larger triangle covers, and where a row crosses its plane.
 *
 * Each slice is solved for its span of rows by floor and ceiling divisions of the edge functions in 64-bit
 * integers, so that a needle costs its own length and not its box. For a crossing the sign of a 128-bit sum
 * decides; no rounding takes part.
 * Guarantee: exact for every triangle that the lattice can hold (bit budgets in lattice.h and
 * covered_rows.h). */
#include "solid/solid.h"

int32_t bvxi_cross_exact(const bvxi_triangle *t, int32_t fraction_bits, int32_t j, int32_t k)
{
    int32_t least = t->p[0][0], most = t->p[0][0];

    for (int32_t i = 1; i < 3; i++) {
        if (t->p[i][0] < least) least = t->p[i][0];
        if (t->p[i][0] > most) most = t->p[i][0];
    }

    /* The displaced row meets the plane inside the triangle, so the crossing lies between its ends along x; a
     * centre at the far end is beyond then, as the plane falls off from there to where the row is. */
    int32_t low = bvxi_centres_below(least, fraction_bits);
    int32_t high = bvxi_centres_below(most, fraction_bits);
    while (low < high) {
        int32_t const middle = low + (high - low) / 2;
        if (bvxi_beyond_plane(t, fraction_bits, middle, j, k)) high = middle;
        else low = middle + 1;
    }
    return low;
}

/* Rows of the triangle's box, from the cells of its corners, cut to the rows requested. */
static int box_rows(const uint32_t *cell, const uint32_t corner[3], bvxi_rows asked, bvxi_rows *r)
{
    int32_t y[3], z[3];

    for (int32_t i = 0; i < 3; i++) {
        y[i] = (int32_t)(cell[corner[i]] & 0xffff);
        z[i] = (int32_t)(cell[corner[i]] >> 16);
    }
    r->j0 = bvxi_least_of_three(y[0], y[1], y[2]);
    r->j1 = bvxi_most_of_three(y[0], y[1], y[2]);
    r->k0 = bvxi_least_of_three(z[0], z[1], z[2]);
    r->k1 = bvxi_most_of_three(z[0], z[1], z[2]);

    if (r->j0 < asked.j0) r->j0 = asked.j0;
    if (r->j1 > asked.j1) r->j1 = asked.j1;
    if (r->k0 < asked.k0) r->k0 = asked.k0;
    if (r->k1 > asked.k1) r->k1 = asked.k1;
    return r->j0 < r->j1 && r->k0 < r->k1;
}

void bvxi_cover_spans(const bvxi_solid_job *job, bvxi_rows rows, uint32_t triangle, bvxi_crossing_fn *take,
                      void *sink)
{
    const int32_t *const xyz = job->snapped.xyz, *p[3];
    int32_t const f = job->fraction_bits;
    int64_t const step = (int64_t)1 << f, half = step >> 1;
    double extent[3];
    uint32_t corner[3];
    bvxi_triangle t;
    bvxi_divider d;
    bvxi_rows r;

    bvxi_view_triangle(job->view, triangle, corner);
    if (!box_rows(job->snapped.cell, corner, rows, &r)) return;
    for (int32_t i = 0; i < 3; i++) p[i] = xyz + 3 * (size_t)corner[i];
    /* Without area, seen along the row: no row crosses it. */
    if (!bvxi_triangle_setup(p[0], p[1], p[2], &t)) return;
    bvxi_triangle_walk(&t, job->snapped.axis);
    for (int32_t a = 1; a < 3; a++)
        extent[a] = (double)((int64_t)bvxi_most_of_three(p[0][a], p[1][a], p[2][a]) -
                             bvxi_least_of_three(p[0][a], p[1][a], p[2][a]));
    bvxi_divider_setup(&t, f, extent[1], extent[2], &d);
    for (int32_t k = r.k0; k < r.k1; k++) {
        int64_t const y0 = (job->block.y0 + r.j0) * step + half, z = (job->block.z0 + k) * step + half;
        int64_t first = 0, last = (int64_t)r.j1 - r.j0 - 1;
        bvxi_cover_span(&t, y0, z, step, &first, &last);
        for (int64_t n = first; n <= last; n++) {
            int32_t const j = r.j0 + (int32_t)n;
            int32_t const i = bvxi_cross(&t, &d, f, (double)(y0 + n * step), (double)z, job->block.y0 + j,
                                         job->block.z0 + k);
            take(sink, (uint32_t)k << 16 | (uint32_t)j, (int32_t)((uint32_t)i << 1 | (uint32_t)t.leaving));
        }
    }
}
