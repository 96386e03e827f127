/* sheet_four_body.h - the sums of sheet.c from four places at once, which move through the sheet together
 * while they can. Included by sheet_four.c once for each level of core/simd.h, after sheet_lanes_body.h.
 * Same bits as sheet.c. */

/* ---- Lanes together ---- */

BVXI_SIMD_CODE static inline void BVXI_SIMD(from_centre)(const bvxi_sheet_node *n, const four_sum *sum,
                                                         doubles4 r[3])
{
    r[0] = four_sub(four_all(n->centre[0]), sum->at[0]);
    r[1] = four_sub(four_all(n->centre[1]), sum->at[1]);
    r[2] = four_sub(four_all(n->centre[2]), sum->at[2]);
}

BVXI_SIMD_CODE static inline doubles4 BVXI_SIMD(flux_of)(const bvxi_sheet_node *n, const doubles4 r[3])
{
    doubles4 const normal[3] = {four_all(n->normal[0]), four_all(n->normal[1]), four_all(n->normal[2])};
    return four_dot(r, normal);
}

/* As add_far_part of sheet.c, where it is far from all. */
BVXI_SIMD_CODE static inline int BVXI_SIMD(add_far_to_four)(const bvxi_sheet_node *n, four_sum *sum)
{
    double const least = n->radius > 2 * sum->reach ? 2 * n->radius : n->radius + 2 * sum->reach;
    double const part = n->area * n->radius / (2 * BVXI_PI);
    doubles4 r[3];

    BVXI_SIMD(from_centre)(n, sum, r);
    doubles4 const d2 = four_dot(r, r);
    /* One lane that is near opens the part for all: each is then as exact as by itself. */
    if (four_bits(four_less_equal(d2, four_all(least * least))) != 0) return 0;
    doubles4 const d = four_sqrt(d2);
    doubles4 const gap = four_sub(d, four_all(n->radius));
    doubles4 const cube = four_mul(four_mul(gap, gap), gap);
    if (four_bits(four_less(four_mul(four_all(sum->near), cube), four_all(part))) != 0) return 0;

    /* Its error within reach, and what the dipole bends. */
    if (sum->reach > 0) {
        doubles4 const left = four_sub(gap, four_all(sum->reach));
        doubles4 const left3 = four_mul(four_mul(left, left), left);
        doubles4 const rest = four_div(four_all(part), left3);
        doubles4 const most = four_all(3 * sum->reach * sum->reach * n->area / (4 * BVXI_PI));
        doubles4 const bend = four_div(most, four_mul(left3, left));
        if (four_bits(four_less(four_all(sum->near), four_add(rest, bend))) != 0) return 0;
        sum->rest = four_add(sum->rest, rest);
        sum->bend = four_add(sum->bend, bend);
    }

    /* As in add_far_part: a dipole in all four lanes. */
    doubles4 const factor = four_div(four_all(1 / (4 * BVXI_PI)), four_mul(d2, d));
    doubles4 const flux = BVXI_SIMD(flux_of)(n, r);
    sum->error = four_add(sum->error, four_div(four_all(part), cube));
    sum->turns = four_add(sum->turns, four_mul(flux, factor));
    if (sum->reach > 0) {
        doubles4 const along = four_div(four_mul(four_all(3.0), flux), d2);
        for (int k = 0; k < 3; k++) {
            doubles4 const way = four_sub(four_mul(along, r[k]), four_all(n->normal[k]));
            sum->gradient[k] = four_add(sum->gradient[k], four_mul(way, factor));
        }
    }
    return 1;
}

/* As add_loop of sheet.c. */
BVXI_SIMD_CODE static void BVXI_SIMD(add_loop_to_four)(const bvxi_sheet *s, uint64_t begin, uint64_t last,
                                                       four_sum *sum)
{
    int const edges = sum->reach > 0;
    uint64_t i = begin, end[40];
    four_point a, seen[40];
    int32_t count = 1;

    end[0] = last;
    BVXI_SIMD(see_four)(s, begin, sum, &a);
    BVXI_SIMD(see_four)(s, last, sum, &seen[0]);
    if (edges) BVXI_SIMD(add_edge_to_four)(&seen[0], &a, sum);

    while (count > 0) {
        uint64_t const j = end[count - 1], m = i + (j - i) / 2, corner[3] = {i, m, j};
        const four_point *const b = &seen[count - 1];
        const four_point *const three[3] = {&a, &seen[count], b};

        if (j - i < 2 ||
            (j - i > 2 && (i != begin || j != last) && BVXI_SIMD(add_far_to_four)(&s->node[m], sum))) {
            if (edges) BVXI_SIMD(add_edge_to_four)(&a, b, sum);
            a = *b;
            i = j;
            count--;
            continue;
        }
        end[count] = m;
        BVXI_SIMD(see_four)(s, m, sum, &seen[count]);
        BVXI_SIMD(add_triangle_to_four)(s, corner, three, sum);
        count++;
    }
}

BVXI_SIMD_CODE static inline void BVXI_SIMD(begin_four)(const bvxi_sheet *s, const int64_t p[4][3],
                                                        double near, four_sum *sum)
{
    doubles4 const zero = four_all(0.0);

    /* Rows become columns: a lane is a place, a vector one coordinate of all four. */
    for (int a = 0; a < 3; a++) {
        double const at[4] = {(double)p[0][a], (double)p[1][a], (double)p[2][a], (double)p[3][a]};
        sum->at[a] = four_mul(four_load(at), four_all(s->scale[a]));
        sum->gradient[a] = sum->edge_gradient[a] = zero;
    }
    sum->im = sum->rounds = sum->turns = sum->rest = sum->bend = sum->edge_bend = sum->counted = zero;
    sum->re = four_all(1.0);
    sum->active = four_less(zero, sum->re);
    sum->error = four_all(BVXI_SHEET_ROUNDING);
    sum->factors = sum->alone = 0;
    sum->place = p;
    sum->near = near;
}

/* The product's angle is half the solid angle. */
BVXI_SIMD_CODE static inline void BVXI_SIMD(end_four)(four_sum *sum)
{
    double re[4], im[4], turns[4];

    four_store(re, sum->re);
    four_store(im, sum->im);
    /* The angle needs a branch and a polynomial, so it is taken lane by lane, once. */
    for (int l = 0; l < 4; l++)
        turns[l] = (im[l] < 0 ? -bvxi_angle(re[l], -im[l]) : bvxi_angle(re[l], im[l])) / (2 * BVXI_PI);
    sum->turns = four_add(sum->turns, four_add(four_load(turns), sum->rounds));
}

BVXI_SIMD_CODE static void BVXI_SIMD(add_sheet_to_four)(const bvxi_sheet *s, const int64_t p[4][3],
                                                        double near, four_sum *sum)
{
    bvxi_sheet_walk w;
    uint64_t i, j;

    BVXI_SIMD(begin_four)(s, p, near, sum);
    w.count = 0;
    if (s->holes->loops > 0) bvxi_sheet_push(&w, 0, s->holes->loops);
    while (bvxi_sheet_take(&w, &i, &j)) {
        uint64_t const m = i + (j - i) / 2;

        /* Where all four are far, the group is done; else its halves, from left to right. */
        if (BVXI_SIMD(add_far_to_four)(bvxi_sheet_group(s, i, j), sum)) continue;
        if (j - i < 2) {
            BVXI_SIMD(add_loop_to_four)
            (s, bvxi_loop_begin(s->holes, s->order[i]), s->holes->loop_end[s->order[i]] - 1, sum);
            continue;
        }
        bvxi_sheet_push(&w, m, j);
        bvxi_sheet_push(&w, i, m);
    }
    BVXI_SIMD(end_four)(sum);
}

/* ---- Each lane for itself ---- */

/* Of the active lanes those that are far from the part, which then counts
 * as a whole there; in the digits of add_far_part. */
BVXI_SIMD_CODE static inline four_mask BVXI_SIMD(add_far_alone)(const bvxi_sheet_node *n, four_mask active,
                                                                four_sum *sum)
{
    double const least = 2 * n->radius;
    doubles4 r[3];

    BVXI_SIMD(from_centre)(n, sum, r);
    doubles4 const d2 = four_dot(r, r);
    /* Each lane as it would decide alone: its digits must be those of the single place. */
    four_mask far = four_and(active, four_less(four_all(least * least), d2));
    if (four_bits(far) == 0) return far;

    doubles4 const d = four_sqrt(d2);
    doubles4 const gap = four_sub(d, four_all(n->radius));
    doubles4 const cube = four_mul(four_mul(gap, gap), gap);
    doubles4 const most = four_mul(four_all(sum->near * (2 * BVXI_PI)), cube);
    far = four_and(far, four_less_equal(four_all(n->area * n->radius), most));
    if (four_bits(far) == 0) return far;

    doubles4 const factor = four_div(four_all(1.0), four_mul(four_mul(four_all(4 * BVXI_PI), d2), d));
    sum->turns = four_add(sum->turns, four_keep(far, four_mul(BVXI_SIMD(flux_of)(n, r), factor)));
    return far;
}

/* Lanes stand still up to the point until: parts are met from left to right. */
BVXI_SIMD_CODE static void BVXI_SIMD(add_loop_alone)(const bvxi_sheet *s, uint64_t begin, uint64_t last,
                                                     four_mask active, four_sum *sum)
{
    /* A lane that has taken a part as a whole stands still until the walk has passed that part. */
    doubles4 until = four_choose(active, four_all(0.0), four_all(0x1p60));
    uint64_t i = begin, end[40];
    four_point a, seen[40];
    int32_t count = 1;

    end[0] = last;
    BVXI_SIMD(see_four)(s, begin, sum, &a);
    BVXI_SIMD(see_four)(s, last, sum, &seen[0]);
    while (count > 0) {
        uint64_t const j = end[count - 1], m = i + (j - i) / 2, corner[3] = {i, m, j};
        const four_point *const b = &seen[count - 1];
        const four_point *const three[3] = {&a, &seen[count], b};
        four_mask open = four_less_equal(until, four_all((double)i));

        /* The whole loop is never a far part here, as its group was looked at before. */
        if (j - i > 2 && (i != begin || j != last)) {
            four_mask const far = BVXI_SIMD(add_far_alone)(&s->node[m], open, sum);
            until = four_choose(far, four_all((double)j), until);
            open = four_but(open, far);
        }
        if (j - i < 2 || four_bits(open) == 0) {
            a = *b;
            i = j;
            count--;
            continue;
        }
        end[count] = m;
        BVXI_SIMD(see_four)(s, m, sum, &seen[count]);
        /* Only the lanes that are open take the triangle. */
        sum->active = open;
        BVXI_SIMD(add_triangle_to_four)(s, corner, three, sum);
        count++;
    }
}

BVXI_SIMD_CODE static void BVXI_SIMD(angles_four)(const bvxi_sheet *s, const int64_t p[4][3], double near,
                                                  double turns[4])
{
    doubles4 until = four_all(0.0);
    bvxi_sheet_walk w;
    four_sum sum;
    uint64_t i, j;

    BVXI_SIMD(begin_four)(s, p, near, &sum);
    sum.look = NULL;
    sum.reach = 0;
    sum.alone = 1;
    w.count = 0;
    if (s->holes->loops > 0) bvxi_sheet_push(&w, 0, s->holes->loops);
    while (bvxi_sheet_take(&w, &i, &j)) {
        uint64_t const m = i + (j - i) / 2;
        /* Loops before a lane's point were part of a group that it took as a whole. */
        four_mask open = four_less_equal(until, four_all((double)i));
        four_mask const far = BVXI_SIMD(add_far_alone)(bvxi_sheet_group(s, i, j), open, &sum);

        until = four_choose(far, four_all((double)j), until);
        open = four_but(open, far);
        if (four_bits(open) == 0) continue;
        if (j - i < 2) {
            BVXI_SIMD(add_loop_alone)
            (s, bvxi_loop_begin(s->holes, s->order[i]), s->holes->loop_end[s->order[i]] - 1, open, &sum);
            continue;
        }
        bvxi_sheet_push(&w, m, j);
        bvxi_sheet_push(&w, i, m);
    }
    BVXI_SIMD(end_four)(&sum);
    four_store(turns, sum.turns);
}

/* ---- Questions ---- */

BVXI_SIMD_CODE static void BVXI_SIMD(around_four)(const bvxi_sheet *s, const int64_t p[4][3], double reach,
                                                  double near, double edge_rest, bvxi_sheet_look look[4])
{
    double numbers[10][4];
    four_sum sum;

    /* Edges and triangles are listed as they are met; everything else is stored at the end. */
    for (int l = 0; l < 4; l++) look[l].edges = look[l].triangles = 0;
    sum.look = look;
    sum.reach = reach;
    sum.edge_rest = edge_rest;
    BVXI_SIMD(add_sheet_to_four)(s, p, near, &sum);

    for (int a = 0; a < 3; a++) four_store(numbers[a], sum.gradient[a]);
    for (int a = 0; a < 3; a++) four_store(numbers[3 + a], sum.edge_gradient[a]);
    four_store(numbers[6], sum.turns);
    four_store(numbers[7], sum.rest);
    four_store(numbers[8], sum.bend);
    four_store(numbers[9], sum.edge_bend);
    /* Vectors become the four answers. */
    for (int l = 0; l < 4; l++) {
        for (int a = 0; a < 3; a++) look[l].gradient[a] = numbers[a][l];
        for (int a = 0; a < 3; a++) look[l].edge_gradient[a] = numbers[3 + a][l];
        look[l].turns = numbers[6][l];
        look[l].rest = BVXI_SHEET_ROUNDING + numbers[7][l];
        look[l].bend = numbers[8][l];
        look[l].edge_bend = numbers[9][l];
    }
}

/* Four places that are not told with the first parts are evaluated one by one. */
BVXI_SIMD_CODE static void BVXI_SIMD(turns_four)(const bvxi_sheet *s, const int64_t p[4][3],
                                                 int32_t want_clear, bvxi_sheet_answer answer[4])
{
    double turns[4], error[4];
    four_sum sum;

    sum.look = NULL;
    sum.reach = 0;
    BVXI_SIMD(add_sheet_to_four)(s, p, bvxi_sheet_near[0], &sum);
    four_store(turns, sum.turns);
    four_store(error, sum.error);
    /* What is in doubt is evaluated again by itself, with more parts opened. */
    for (int l = 0; l < 4; l++)
        if (!bvxi_sheet_conclude(turns[l], error[l], want_clear, &answer[l]))
            answer[l] = bvxi_sheet_turns(s, p[l], want_clear);
}
