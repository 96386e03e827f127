/* sheet_lanes.h - four places that a sheet is seen from: triangles and edges that are added to the sums of all. Not installed.
 *
 * What sheet.c does for one place, in the same order of operations; for sheet_four.c. */
#ifndef BVXI_SHEET_LANES_H
#define BVXI_SHEET_LANES_H

#include "voxelize/sheet.h"
#include "core/angle.h"

#if BVXI_HAVE_AVX2
#include <immintrin.h>

typedef __m256d four;

typedef struct four_point {
    four v[3], length;
} four_point;

typedef struct four_sum {
    four at[3];
    four re, im, rounds; /* as in sheet.c */
    four turns, error;
    four gradient[3], edge_gradient[3], rest, bend, edge_bend;
    const int64_t (*place)[3];
    bvxi_sheet_look *look; /* of each lane */
    double near, reach, edge_rest;
    int32_t factors;
    int alone;            /* 1: each lane opens parts for itself, the others stand still */
    four active, counted; /* alone: those that do not; their factors */
} four_sum;

#define FOUR(x) _mm256_set1_pd(x)
#define FOUR_LESS(x, y) _mm256_cmp_pd(x, y, _CMP_LT_OQ)
#define FOUR_LESS_EQUAL(x, y) _mm256_cmp_pd(x, y, _CMP_LE_OQ)
#define FOUR_CHOOSE(mask, yes, no) _mm256_blendv_pd(no, yes, mask)
#define FOUR_BITS(mask) ((uint32_t)_mm256_movemask_pd(mask))

BVXI_AVX2 static inline four four_dot(const four a[3], const four b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

BVXI_AVX2 static inline void four_cross(const four a[3], const four b[3], four n[3])
{
    n[0] = a[1] * b[2] - a[2] * b[1];
    n[1] = a[2] * b[0] - a[0] * b[2];
    n[2] = a[0] * b[1] - a[1] * b[0];
}

BVXI_AVX2 static inline four four_size(four x)
{
    return _mm256_andnot_pd(FOUR(-0.0), x);
}

BVXI_AVX2 static inline void see_four(const bvxi_sheet *s, uint64_t i, const four_sum *sum, four_point *p)
{
    const double *const q = bvxi_sheet_point(s, i);
    for (int a = 0; a < 3; a++) p->v[a] = FOUR(q[a]) - sum->at[a];
    p->length = _mm256_sqrt_pd(four_dot(p->v, p->v));
}

BVXI_AVX2 static void lane_of_point(const four_point *p, int32_t lane, bvxi_seen_point *to)
{
    double x[4][4];
    for (int a = 0; a < 3; a++) _mm256_storeu_pd(x[a], p->v[a]);
    _mm256_storeu_pd(x[3], p->length);
    for (int a = 0; a < 3; a++) to->v[a] = x[a][lane];
    to->length = x[3][lane];
}

BVXI_AVX2 static inline void turn_four(four_sum *sum, four re, four im, four up)
{
    four const zero = _mm256_setzero_pd(), one = FOUR(1.0);
    four x = sum->re * re - sum->im * im, y = sum->re * im + sum->im * re;
    four const half = _mm256_and_pd(_mm256_cmp_pd(im, zero, _CMP_EQ_OQ), FOUR_LESS(re, zero));
    if (BVXI_UNLIKELY(FOUR_BITS(half) != 0)) {
        four const hair = FOUR(1e-30) * re * sum->re;
        y = FOUR_CHOOSE(half, y + FOUR_CHOOSE(up, zero - hair, hair), y);
    }
    four more = _mm256_and_pd(up, _mm256_and_pd(FOUR_LESS_EQUAL(zero, sum->im), FOUR_LESS(y, zero)));
    four less = _mm256_andnot_pd(up, _mm256_and_pd(FOUR_LESS(sum->im, zero), FOUR_LESS_EQUAL(zero, y)));
    four full = FOUR_LESS(zero, one);
    int any = ++sum->factors == 8;
    if (sum->alone) {
        more = _mm256_and_pd(more, sum->active);
        less = _mm256_and_pd(less, sum->active);
        x = FOUR_CHOOSE(sum->active, x, sum->re);
        y = FOUR_CHOOSE(sum->active, y, sum->im);
        sum->counted += _mm256_and_pd(sum->active, one);
        full = _mm256_cmp_pd(sum->counted, FOUR(8.0), _CMP_EQ_OQ);
        any = FOUR_BITS(full) != 0;
        sum->counted = _mm256_andnot_pd(full, sum->counted);
    }
    sum->rounds += _mm256_and_pd(more, one) - _mm256_and_pd(less, one);
    if (any) {
        four const most = _mm256_max_pd(four_size(x), four_size(y)), some = _mm256_and_pd(full, FOUR_LESS(zero, most));
        sum->factors = 0;
        x = FOUR_CHOOSE(some, x / most, x);
        y = FOUR_CHOOSE(some, y / most, y);
    }
    sum->re = x;
    sum->im = y;
}

/* As keep_near_triangle of sheet.c. */
BVXI_AVX2 static inline void keep_near_of_four(const bvxi_sheet_node *n, const four_point *const p[3], four det, const four_sum *sum)
{
    double const limit = n->radius + sum->reach;
    four r[3], u[3], w[3], normal[3], most;
    double numbers[4][4];
    uint32_t lanes;
    for (int a = 0; a < 3; a++) r[a] = FOUR(n->centre[a]) - sum->at[a];
    lanes = FOUR_BITS(FOUR_LESS_EQUAL(four_dot(r, r), FOUR(limit * limit)));
    if (lanes == 0) return;
    for (int a = 0; a < 3; a++) {
        u[a] = p[1]->v[a] - p[0]->v[a];
        w[a] = p[2]->v[a] - p[0]->v[a];
    }
    four_cross(u, w, normal);
    most = FOUR(sum->reach * sum->reach) * four_dot(normal, normal) * FOUR(1 + 1e-6) + FOUR(1e-20);
    lanes &= FOUR_BITS(FOUR_LESS_EQUAL(det * det, most));
    if (lanes == 0) return;
    for (int a = 0; a < 3; a++) _mm256_storeu_pd(numbers[a], normal[a]);
    _mm256_storeu_pd(numbers[3], det);
    for (; lanes != 0; lanes &= lanes - 1) {
        int32_t const lane = bvxi_lowest(lanes);
        bvxi_sheet_look *const look = &sum->look[lane];
        if (look->triangles < BVXI_LOOK_TRIANGLES) {
            bvxi_near_triangle *const t = &look->triangle[look->triangles];
            for (int i = 0; i < 3; i++) {
                lane_of_point(p[i], lane, &t->p[i]);
                t->n[i] = numbers[i][lane];
            }
            t->det = numbers[3][lane];
        }
        if (look->triangles <= BVXI_LOOK_TRIANGLES) look->triangles++;
    }
}

/* Lanes whose place lies in the triangle's plane, or nearly. */
BVXI_AVX2 static four touch_lanes(const bvxi_sheet *s, const uint64_t corner[3], const four_point *const q[3], uint32_t lanes,
                                  const four_sum *sum, four *det, four *den, four up)
{
    double dets[4], dens[4], ups[4];
    const int32_t *fixed[3];
    for (int k = 0; k < 3; k++) fixed[k] = s->xyz + 3 * (uint64_t)s->holes->vertex[corner[k]];
    _mm256_storeu_pd(dets, *det);
    _mm256_storeu_pd(dens, *den);
    _mm256_storeu_pd(ups, _mm256_and_pd(up, FOUR(1.0)));
    for (; lanes != 0; lanes &= lanes - 1) {
        int32_t const lane = bvxi_lowest(lanes);
        bvxi_seen_point p;
        double v[3][3];
        for (int k = 0; k < 3; k++) {
            lane_of_point(q[k], lane, &p);
            memcpy(v[k], p.v, sizeof v[k]);
        }
        ups[lane] = bvxi_touching_angle(fixed, sum->place[lane], (const double(*)[3])v, dets[lane], &dens[lane], &dets[lane]);
    }
    *det = _mm256_loadu_pd(dets);
    *den = _mm256_loadu_pd(dens);
    return FOUR_LESS(_mm256_setzero_pd(), _mm256_loadu_pd(ups));
}

BVXI_AVX2 static inline void add_triangle_to_four(const bvxi_sheet *s, const uint64_t corner[3], const four_point *const q[3], four_sum *sum)
{
    const four *const a = q[0]->v, *const b = q[1]->v, *const c = q[2]->v;
    four const la = q[0]->length, lb = q[1]->length, lc = q[2]->length, most = FOUR(1e-10) * la * lb * lc;
    four det = a[0] * (b[1] * c[2] - b[2] * c[1]) + a[1] * (b[2] * c[0] - b[0] * c[2]) + a[2] * (b[0] * c[1] - b[1] * c[0]);
    four den = la * lb * lc + four_dot(a, b) * lc + four_dot(b, c) * la + four_dot(c, a) * lb;
    four up = FOUR_LESS(_mm256_setzero_pd(), det);
    uint32_t touching;
    if (sum->reach > 0) keep_near_of_four(&s->node[corner[1]], q, det, sum);
    touching = FOUR_BITS(_mm256_and_pd(FOUR_LESS_EQUAL(four_size(det), most), FOUR_LESS_EQUAL(den, most)));
    if (BVXI_UNLIKELY(touching != 0)) up = touch_lanes(s, corner, q, touching, sum, &det, &den, up);
    turn_four(sum, den, det, up);
}

BVXI_AVX2 static void keep_edge_of_four(const four_point *pa, const four_point *pb, const four c[3], four ab, uint32_t lanes, const four_sum *sum)
{
    double numbers[4][4];
    for (int a = 0; a < 3; a++) _mm256_storeu_pd(numbers[a], c[a]);
    _mm256_storeu_pd(numbers[3], ab);
    for (; lanes != 0; lanes &= lanes - 1) {
        int32_t const lane = bvxi_lowest(lanes);
        bvxi_near_edge *const e = &sum->look[lane].edge[sum->look[lane].edges++];
        lane_of_point(pa, lane, &e->a);
        lane_of_point(pb, lane, &e->b);
        for (int a = 0; a < 3; a++) e->n[a] = numbers[a][lane];
        e->ab = numbers[3][lane];
    }
}

/* As add_sheet_edge of sheet.c. */
BVXI_AVX2 static inline void add_edge_to_four(const four_point *pa, const four_point *pb, four_sum *sum)
{
    const four *const a = pa->v, *const b = pb->v;
    four const zero = _mm256_setzero_pd(), reach = FOUR(sum->reach), la = pa->length, lb = pb->length;
    four const u[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]}, uu = four_dot(u, u), length = _mm256_sqrt_pd(uu), ab = four_dot(a, b);
    four c[3], cc, d = FOUR(0.5) * (la + lb - length) - reach, rest, is_near, too_near, factor, top, bottom;
    uint32_t close, lanes = 0;
    if (_mm256_cvtsd_f64(uu) == 0) return; /* in one lane as in all */
    four_cross(a, b, c);
    cc = four_dot(c, c);
    close = FOUR_BITS(FOUR_LESS(d, reach + reach));
    if (close != 0) {
        four const at_b = FOUR_LESS_EQUAL(four_dot(b, u), zero), at_a = FOUR_LESS_EQUAL(zero, four_dot(a, u));
        four const exact = FOUR_CHOOSE(at_a, la, FOUR_CHOOSE(at_b, lb, _mm256_sqrt_pd(cc) / length)) - reach;
        d = FOUR_CHOOSE(FOUR_LESS(d, reach + reach), exact, d);
    }
    too_near = FOUR_LESS_EQUAL(d, FOUR(1e-3 * sum->reach));
    rest = FOUR_CHOOSE(too_near, FOUR(BVXI_SHEET_NO_BOUND), FOUR(sum->reach * sum->reach) * length / (FOUR(4 * BVXI_PI) * (d * d * d)));
    is_near = FOUR_LESS(FOUR(sum->edge_rest), rest);
    if (FOUR_BITS(is_near) != 0) {
        double room[4];
        for (int32_t l = 0; l < 4; l++) room[l] = sum->look[l].edges < BVXI_LOOK_EDGES ? 1.0 : 0.0;
        is_near = _mm256_and_pd(is_near, FOUR_LESS(zero, _mm256_loadu_pd(room)));
        lanes = FOUR_BITS(is_near);
        keep_edge_of_four(pa, pb, c, ab, lanes, sum);
    }
    sum->edge_bend += _mm256_and_pd(is_near, rest);
    sum->bend += _mm256_andnot_pd(is_near, rest);
    top = FOUR_CHOOSE(FOUR_LESS_EQUAL(zero, ab), la + lb, (la + lb) * (la * lb - ab));
    bottom = FOUR(4 * BVXI_PI) * la * lb * FOUR_CHOOSE(FOUR_LESS_EQUAL(zero, ab), la * lb + ab, cc);
    factor = _mm256_andnot_pd(too_near, top / bottom);
    for (int k = 0; k < 3; k++) {
        four const g = factor * c[k];
        sum->gradient[k] += _mm256_andnot_pd(is_near, g);
        if (lanes != 0) sum->edge_gradient[k] += _mm256_and_pd(is_near, g);
    }
}
#endif

#endif
