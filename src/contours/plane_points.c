/* plane_points.c - the points of one plane placed on it and snapped, and its loops directed: the inside is
 * on the left of all. */
#include "contours/section.h"

#include "lattice/wide.h"

#include <math.h>

bvx_status bvxi_plane_place(bvxi_stack *s, bvxi_plane *p, double low[2], double high[2])
{
    for (uint32_t i = 0; i < p->point_count; i++) {
        const double *const at = s->given->points + 3 * (uint64_t)p->given[i];
        p->uv[i][0] = bvxi_along_axis(s->axis[0], at);
        p->uv[i][1] = bvxi_along_axis(s->axis[1], at);
        for (int k = 0; k < 2; k++) {
            double const c = p->uv[i][k];
            /* Infinite or undefined: such a place is on no grid. */
            if (c - c != 0.0)
                return s->fixed
                           ? BVX_ERR_RANGE
                           : bvxi_fail_for(s->ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                           "%s: point %i is too far out", s->function, (uint64_t)p->given[i]);
            if (c < low[k]) low[k] = c;
            if (c > high[k]) high[k] = c;
        }
    }
    return BVX_OK;
}

int32_t bvxi_snap_steps(const bvxi_stack *s, int k, double along)
{
    return (int32_t)floor((along - s->origin[k]) / s->step[k] * (double)(1 << (s->fine - 1)));
}

void bvxi_plane_snap(const bvxi_stack *s, bvxi_plane *p)
{
    for (uint32_t i = 0; i < p->point_count; i++)
        for (int k = 0; k < 2; k++) {
            /* Points are odd: between the grid's lines, which are even, so that none lies on a line. */
            int32_t const top = (s->size[k] << s->fine) - 1;
            int32_t const steps = s->nudge == NULL ? 0 : s->nudge[p->given[i]][k];
            int32_t const q = 2 * (bvxi_snap_steps(s, k, p->uv[i][k]) + steps) + 1;
            p->q[i][k] = q < 1 ? 1 : q > top ? top : q;
        }
}

/* Twice the area, exactly, as a sign. */
static int turn_of(const bvxi_plane *p, const bvxi_contour *c)
{
    bvxi_wide sum = bvxi_wide_mul(0, 0);
    const int32_t *const o = p->q[c->first];
    for (uint32_t i = c->first + 1; i + 1 < c->first + c->count; i++) {
        int64_t const ax = (int64_t)p->q[i][0] - o[0], ay = (int64_t)p->q[i][1] - o[1];
        int64_t const bx = (int64_t)p->q[i + 1][0] - o[0], by = (int64_t)p->q[i + 1][1] - o[1];
        sum = bvxi_wide_add(sum, bvxi_wide_add(bvxi_wide_mul(ax, by), bvxi_wide_mul(-ay, bx)));
    }
    return bvxi_wide_sign(sum);
}

int bvxi_loop_contains(const bvxi_plane *p, const bvxi_contour *c, const int32_t *at)
{
    int odd = 0;
    for (uint32_t i = c->first; i < c->first + c->count; i++) {
        const int32_t *const a = p->q[i], *const b = p->q[p->next[i]];
        /* Half open, so that a place level with a point counts it once. */
        if ((a[1] <= at[1]) == (b[1] <= at[1])) continue;
        int64_t const s = ((int64_t)b[0] - a[0]) * ((int64_t)at[1] - a[1]) -
                          ((int64_t)at[0] - a[0]) * ((int64_t)b[1] - a[1]);
        odd ^= (s > 0) == (b[1] > a[1]);
    }
    return odd;
}

static void reverse_loop(bvxi_plane *p, const bvxi_contour *c)
{
    for (uint32_t i = c->first, j = c->first + c->count - 1; i < j; i++, j--) {
        uint32_t const given = p->given[i];
        int32_t q[2];
        double uv[2];
        memcpy(q, p->q[i], sizeof q);
        memcpy(uv, p->uv[i], sizeof uv);
        p->given[i] = p->given[j];
        memcpy(p->q[i], p->q[j], sizeof q);
        memcpy(p->uv[i], p->uv[j], sizeof uv);
        p->given[j] = given;
        memcpy(p->q[j], q, sizeof q);
        memcpy(p->uv[j], uv, sizeof uv);
    }
}

uint32_t bvxi_contour_of(const bvxi_plane *p, uint32_t point)
{
    uint32_t low = 0, high = p->contour_count;
    while (high - low > 1) {
        uint32_t const middle = low + (high - low) / 2;
        if (p->contour[middle].first <= point) low = middle;
        else high = middle;
    }
    return low;
}

void bvxi_loop_box(const bvxi_plane *p, const bvxi_contour *c, int32_t box[4])
{
    for (int k = 0; k < 2; k++) box[k] = box[k + 2] = p->q[c->first][k];
    for (uint32_t i = c->first; i < c->first + c->count; i++)
        for (int k = 0; k < 2; k++) {
            if (p->q[i][k] < box[k]) box[k] = p->q[i][k];
            if (p->q[i][k] > box[k + 2]) box[k + 2] = p->q[i][k];
        }
}

/* The boxes of loops keep most pairs from being looked at. */
bvx_status bvxi_plane_direct(bvxi_stack *s, bvxi_plane *p, int32_t (*box)[4])
{
    for (uint32_t i = 0; i < p->contour_count; i++) bvxi_loop_box(p, &p->contour[i], box[i]);
    for (uint32_t i = 0; i < p->contour_count; i++) {
        bvxi_contour *const c = &p->contour[i];
        const int32_t *const at = p->q[c->first];
        int const turn = turn_of(p, c);

        /* A hole lies in an odd number of others; since no two meet, one point of it decides. */
        c->hole = 0;
        for (uint32_t j = 0; j < p->contour_count; j++)
            if (j != i && at[0] >= box[j][0] && at[0] <= box[j][2] && at[1] >= box[j][1] &&
                at[1] <= box[j][3])
                c->hole ^= bvxi_loop_contains(p, &p->contour[j], at);
        if (turn == 0)
            return s->fixed ? BVX_ERR_FORMAT
                            : bvxi_fail_for(s->ctx, BVX_ERR_FORMAT, BVX_REASON_LOOP_FLAT,
                                            "%s: loop %i of section %u encloses no area", s->function,
                                            (uint64_t)c->given, (uint64_t)p->section);
        if ((turn > 0) == (c->hole != 0)) reverse_loop(p, c);
    }
    return BVX_OK;
}
