/* sheet_lanes_body.h - places that a sheet is seen from, one a lane: triangles and edges that are added to the
 * sums of all.
 *
 * Included by sheet.c once for each level of core/simd.h: the same order of operations gives the same digits.
 * What is rare (a place in a triangle's plane, near edges and triangles to be listed) is done lane by lane. */

typedef struct four_point {
    doubles4 v[3], length;
} four_point;

/* What a question gathers. Near angles are a product of complex numbers and its turns, far ones a sum. */
typedef struct four_sum {
    doubles4 at[3];
    doubles4 re, im, rounds; /* of the angle of half a turn a turn */
    doubles4 turns, error;
    doubles4 gradient[3], edge_gradient[3], rest, bend, edge_bend;
    const int64_t (*place)[3];
    bvxi_sheet_look *look; /* of each lane: gets near edges and triangles */
    double near;           /* parts are opened until their error is below */
    double reach;          /* 0: the place only, no gradients and bounds are gathered */
    double edge_rest;
    int32_t factors;
    int alone;        /* 1: each lane opens parts for itself, the others stand still */
    four_mask active; /* alone: those that do not */
    doubles4 counted; /* alone: their factors */
} four_sum;

/* An angle before it is turned by: its numerator, denominator, side. */
typedef struct four_angle {
    doubles4 det, den;
    four_mask up;
} four_angle;

BVXI_SIMD_CODE static inline void BVXI_SIMD(see_four)(const bvxi_sheet *s, uint64_t i, const four_sum *sum,
                                                      four_point *p)
{
    const double *const q = bvxi_sheet_point(s, i);
    p->v[0] = four_sub(four_all(q[0]), sum->at[0]);
    p->v[1] = four_sub(four_all(q[1]), sum->at[1]);
    p->v[2] = four_sub(four_all(q[2]), sum->at[2]);
    p->length = four_sqrt(four_dot(p->v, p->v));
}

BVXI_SIMD_CODE static void BVXI_SIMD(lane_of_point)(const four_point *p, int32_t lane, bvxi_seen_point *to)
{
    /* Stored first, as lanes cannot be read one by one. */
    double x[4][sheet_lanes];
    for (int a = 0; a < 3; a++) four_store(x[a], p->v[a]);
    four_store(x[3], p->length);
    for (int a = 0; a < 3; a++) to->v[a] = x[a][lane];
    to->length = x[3][lane];
}

/* Add the angle of (re, im), which lies between -pi and pi; up: it counts as positive, also where im is 0. */
BVXI_SIMD_CODE static inline void BVXI_SIMD(turn_four)(four_sum *sum, doubles4 re, doubles4 im, four_mask up)
{
    doubles4 const zero = four_all(0.0), one = four_all(1.0);
    /* The product of two complex numbers adds their angles. */
    doubles4 x = four_sub(four_mul(sum->re, re), four_mul(sum->im, im));
    doubles4 y = four_add(four_mul(sum->re, im), four_mul(sum->im, re));

    /* Half a turn: a hair less, so that the sign does not get lost. */
    four_mask const half = four_and(four_equal(im, zero), four_less(re, zero));
    if (BVXI_UNLIKELY(four_bits(half) != 0)) {
        doubles4 const hair = four_mul(four_mul(four_all(1e-30), re), sum->re);
        y = four_choose(half, four_add(y, four_choose(up, four_sub(zero, hair), hair)), y);
    }

    /* The sign of the imaginary part changes where the sum passes half a turn. */
    four_mask more = four_and(up, four_and(four_less_equal(zero, sum->im), four_less(y, zero)));
    four_mask less = four_but(four_and(four_less(sum->im, zero), four_less_equal(zero, y)), up);
    four_mask full = four_less(zero, one);
    int any = ++sum->factors == 8;
    /* Lanes that stand still keep their product, their rounds and their count. */
    if (sum->alone) {
        more = four_and(more, sum->active);
        less = four_and(less, sum->active);
        x = four_choose(sum->active, x, sum->re);
        y = four_choose(sum->active, y, sum->im);
        sum->counted = four_add(sum->counted, four_keep(sum->active, one));
        full = four_equal(sum->counted, four_all(8.0));
        any = four_bits(full) != 0;
        sum->counted = four_drop(full, sum->counted);
    }
    sum->rounds = four_add(sum->rounds, four_sub(four_keep(more, one), four_keep(less, one)));

    /* A factor is the cube of a distance. */
    if (any) {
        doubles4 const most = four_max(four_size(x), four_size(y));
        four_mask const some = four_and(full, four_less(zero, most));

        sum->factors = 0;
        x = four_choose(some, four_div(x, most), x);
        y = four_choose(some, four_div(y, most), y);
    }
    sum->re = x;
    sum->im = y;
}

/* The triangle of node n goes to the looks of the lanes that it may lie within reach of. */
BVXI_SIMD_CODE static inline void BVXI_SIMD(keep_near_of_four)(const bvxi_sheet_node *n,
                                                               const four_point *const p[3], doubles4 det,
                                                               const four_sum *sum)
{
    double const limit = n->radius + sum->reach;
    doubles4 const r[3] = {four_sub(four_all(n->centre[0]), sum->at[0]),
                           four_sub(four_all(n->centre[1]), sum->at[1]),
                           four_sub(four_all(n->centre[2]), sum->at[2])};
    doubles4 u[3], w[3], normal[3];
    double numbers[4][sheet_lanes];
    /* The ball first: most triangles are near no lane. */
    uint32_t lanes = four_bits(four_less_equal(four_dot(r, r), four_all(limit * limit)));

    if (lanes == 0) return;
    four_minus(p[1]->v, p[0]->v, u);
    four_minus(p[2]->v, p[0]->v, w);
    four_cross(u, w, normal);
    doubles4 const square = four_mul(four_all(sum->reach * sum->reach), four_dot(normal, normal));
    doubles4 const most = four_add(four_mul(square, four_all(1 + 1e-6)), four_all(1e-20));
    lanes &= four_bits(four_less_equal(four_mul(det, det), most));
    if (lanes == 0) return;

    /* The few lanes that are left are written one after the other. */
    for (int a = 0; a < 3; a++) four_store(numbers[a], normal[a]);
    four_store(numbers[3], det);
    for (; lanes != 0; lanes &= lanes - 1) {
        int32_t const lane = bvxi_lowest(lanes);
        bvxi_sheet_look *const look = &sum->look[lane];

        if (look->triangles < BVXI_LOOK_TRIANGLES) {
            bvxi_near_triangle *const t = &look->triangle[look->triangles];
            for (int i = 0; i < 3; i++) {
                BVXI_SIMD(lane_of_point)(p[i], lane, &t->p[i]);
                t->n[i] = numbers[i][lane];
            }
            t->det = numbers[3][lane];
        }
        if (look->triangles <= BVXI_LOOK_TRIANGLES) look->triangles++;
    }
}

/* Lanes whose place lies in the triangle's plane, or nearly. */
BVXI_SIMD_CODE static void BVXI_SIMD(touch_lanes)(const bvxi_sheet *s, const uint64_t corner[3],
                                                  const four_point *const q[3], uint32_t lanes,
                                                  const four_sum *sum, four_angle *angle)
{
    double dets[sheet_lanes], dens[sheet_lanes], ups[sheet_lanes];
    const int32_t *fixed[3];

    /* Near the plane, between the edges, rounding may choose the wrong side: integers decide. */
    for (int k = 0; k < 3; k++) fixed[k] = s->xyz + 3 * (uint64_t)s->holes->vertex[corner[k]];
    four_store(dets, angle->det);
    four_store(dens, angle->den);
    four_store(ups, four_keep(angle->up, four_all(1.0)));
    for (; lanes != 0; lanes &= lanes - 1) {
        int32_t const lane = bvxi_lowest(lanes);
        bvxi_seen_point p;
        double v[3][3];

        for (int k = 0; k < 3; k++) {
            BVXI_SIMD(lane_of_point)(q[k], lane, &p);
            memcpy(v[k], p.v, sizeof v[k]);
        }
        ups[lane] = bvxi_touching_angle(fixed, sum->place[lane], (const double(*)[3])v, dets[lane],
                                        &dens[lane], &dets[lane]);
    }
    angle->det = four_load(dets);
    angle->den = four_load(dens);
    angle->up = four_less(four_all(0.0), four_load(ups));
}

/* Half the solid angle of a triangle (its tan is det / den: Van Oosterom, Strackee), positive on the side away
 * from its normal. */
BVXI_SIMD_CODE static inline void BVXI_SIMD(add_triangle_to_four)(const bvxi_sheet *s,
                                                                  const uint64_t corner[3],
                                                                  const four_point *const q[3], four_sum *sum)
{
    const doubles4 *const a = q[0]->v, *const b = q[1]->v, *const c = q[2]->v;
    doubles4 const la = q[0]->length, lb = q[1]->length, lc = q[2]->length;
    doubles4 const most = four_mul(four_mul(four_mul(four_all(1e-10), la), lb), lc);
    doubles4 n[3];

    four_cross(b, c, n);
    doubles4 det = four_dot(a, n);
    doubles4 const den_ab = four_add(four_mul(four_mul(la, lb), lc), four_mul(four_dot(a, b), lc));
    doubles4 den = four_add(four_add(den_ab, four_mul(four_dot(b, c), la)), four_mul(four_dot(c, a), lb));
    four_mask up = four_less(four_all(0.0), det);

    if (sum->reach > 0) BVXI_SIMD(keep_near_of_four)(&s->node[corner[1]], q, det, sum);
    uint32_t const touching = four_bits(
        four_and(four_less_equal(four_size(det), most), four_less_equal(den, most)));
    if (BVXI_UNLIKELY(touching != 0)) {
        four_angle angle = {det, den, up};
        BVXI_SIMD(touch_lanes)(s, corner, q, touching, sum, &angle);
        det = angle.det;
        den = angle.den;
        up = angle.up;
    }
    BVXI_SIMD(turn_four)(sum, den, det, up);
}

BVXI_SIMD_CODE static void BVXI_SIMD(keep_edge_of_four)(const four_point *pa, const four_point *pb,
                                                        const doubles4 c[3], doubles4 ab, uint32_t lanes,
                                                        const four_sum *sum)
{
    double numbers[4][sheet_lanes];

    for (int a = 0; a < 3; a++) four_store(numbers[a], c[a]);
    four_store(numbers[3], ab);
    for (; lanes != 0; lanes &= lanes - 1) {
        int32_t const lane = bvxi_lowest(lanes);
        bvxi_near_edge *const e = &sum->look[lane].edge[sum->look[lane].edges++];

        BVXI_SIMD(lane_of_point)(pa, lane, &e->a);
        BVXI_SIMD(lane_of_point)(pb, lane, &e->b);
        for (int a = 0; a < 3; a++) e->n[a] = numbers[a][lane];
        e->ab = numbers[3][lane];
    }
}

/* The segment from a to b is part of the edge of what was opened. */
BVXI_SIMD_CODE static inline void BVXI_SIMD(add_edge_to_four)(const four_point *pa, const four_point *pb,
                                                              four_sum *sum)
{
    const doubles4 *const a = pa->v, *const b = pb->v;
    doubles4 const zero = four_all(0.0), reach = four_all(sum->reach), twice = four_add(reach, reach);
    doubles4 const la = pa->length, lb = pb->length;
    doubles4 u[3], c[3];
    uint32_t lanes = 0;

    four_minus(b, a, u);
    doubles4 const uu = four_dot(u, u), length = four_sqrt(uu), ab = four_dot(a, b);
    if (four_first(uu) == 0) return; /* in one lane as in all */
    four_cross(a, b, c);
    doubles4 const cc = four_dot(c, c);

    /* How far off it is: a bound where that will do, else exactly. */
    doubles4 d = four_sub(four_mul(four_all(0.5), four_sub(four_add(la, lb), length)), reach);
    four_mask const close = four_less(d, twice);
    if (four_bits(close) != 0) {
        four_mask const at_b = four_less_equal(four_dot(b, u), zero);
        four_mask const at_a = four_less_equal(zero, four_dot(a, u));
        doubles4 const off = four_choose(at_a, la, four_choose(at_b, lb, four_div(four_sqrt(cc), length)));
        d = four_choose(close, four_sub(off, reach), d);
    }
    four_mask const too_near = four_less_equal(d, four_all(1e-3 * sum->reach));
    doubles4 const cube = four_mul(four_mul(d, d), d);
    doubles4 const bent = four_div(four_mul(four_all(sum->reach * sum->reach), length),
                                   four_mul(four_all(4 * BVXI_PI), cube));
    doubles4 const rest = four_choose(too_near, four_all(BVXI_SHEET_NO_BOUND), bent);

    /* Edges that bend the angle most are listed, to be followed exactly; the others count into the bound. */
    four_mask is_near = four_less(four_all(sum->edge_rest), rest);
    if (four_bits(is_near) != 0) {
        double room[sheet_lanes];
        for (int32_t l = 0; l < sheet_lanes; l++) room[l] = sum->look[l].edges < BVXI_LOOK_EDGES ? 1.0 : 0.0;
        is_near = four_and(is_near, four_less(zero, four_load(room)));
        lanes = four_bits(is_near);
        BVXI_SIMD(keep_edge_of_four)(pa, pb, c, ab, lanes, sum);
    }
    sum->edge_bend = four_add(sum->edge_bend, four_keep(is_near, rest));
    sum->bend = four_add(sum->bend, four_drop(is_near, rest));

    /* The field of the edge, without cancelling where a and b point away from each other. */
    four_mask const acute = four_less_equal(zero, ab);
    doubles4 const both = four_add(la, lb), product = four_mul(la, lb);
    doubles4 const top = four_choose(acute, both, four_mul(both, four_sub(product, ab)));
    doubles4 const below = four_choose(acute, four_add(product, ab), cc);
    doubles4 const bottom = four_mul(four_mul(four_mul(four_all(4 * BVXI_PI), la), lb), below);
    doubles4 const factor = four_drop(too_near, four_div(top, bottom));
    for (int k = 0; k < 3; k++) {
        doubles4 const g = four_mul(factor, c[k]);
        sum->gradient[k] = four_add(sum->gradient[k], four_drop(is_near, g));
        if (lanes != 0) sum->edge_gradient[k] = four_add(sum->edge_gradient[k], four_keep(is_near, g));
    }
}
