/* sheet_four.c - the solid angle of the sheet over a mesh's holes, from four places at once.
 *
 * The sums of sheet.c in four lanes. Parts are opened where one of the four asks for it, so each is as near as by itself; neighbours
 * ask for nearly the same. Where digits count, lanes that do not ask for it stand still meanwhile. What is rare (a place in a triangle's plane, near edges and triangles to be listed) is done lane by lane.
 * Guarantee: that of sheet.c. Without vectors its own functions are asked four times. */
#include "voxelize/sheet_lanes.h"

#if BVXI_HAVE_AVX2

/* ---- Lanes together ---- */

/* As add_far_part of sheet.c, where it is far from all. */
BVXI_AVX2 static inline int add_far_to_four(const bvxi_sheet_node *n, four_sum *sum)
{
    four const r[3] = {FOUR(n->centre[0]) - sum->at[0], FOUR(n->centre[1]) - sum->at[1], FOUR(n->centre[2]) - sum->at[2]}, d2 = four_dot(r, r);
    double const least = n->radius > 2 * sum->reach ? 2 * n->radius : n->radius + 2 * sum->reach, part = n->area * n->radius / (2 * BVXI_PI);
    four rest, bend, factor, flux, d, gap, cube;
    if (FOUR_BITS(FOUR_LESS_EQUAL(d2, FOUR(least * least))) != 0) return 0;
    d = _mm256_sqrt_pd(d2);
    gap = d - FOUR(n->radius);
    cube = gap * gap * gap;
    if (FOUR_BITS(FOUR_LESS(FOUR(sum->near) * cube, FOUR(part))) != 0) return 0;
    if (sum->reach > 0) {
        four const left = gap - FOUR(sum->reach), left3 = left * left * left;
        rest = FOUR(part) / left3;
        bend = FOUR(3 * sum->reach * sum->reach * n->area / (4 * BVXI_PI)) / (left3 * left);
        if (FOUR_BITS(FOUR_LESS(FOUR(sum->near), rest + bend)) != 0) return 0;
        sum->rest += rest;
        sum->bend += bend;
    }
    factor = FOUR(1 / (4 * BVXI_PI)) / (d2 * d);
    flux = r[0] * FOUR(n->normal[0]) + r[1] * FOUR(n->normal[1]) + r[2] * FOUR(n->normal[2]);
    sum->error += FOUR(part) / cube;
    sum->turns += flux * factor;
    if (sum->reach > 0) {
        four const along = FOUR(3.0) * flux / d2;
        for (int k = 0; k < 3; k++) sum->gradient[k] += (along * r[k] - FOUR(n->normal[k])) * factor;
    }
    return 1;
}

/* As add_loop of sheet.c. */
BVXI_AVX2 static void add_loop_to_four(const bvxi_sheet *s, uint64_t begin, uint64_t last, four_sum *sum)
{
    int const edges = sum->reach > 0;
    uint64_t i = begin, end[40];
    four_point a, seen[40];
    int32_t count = 1;
    end[0] = last;
    see_four(s, begin, sum, &a);
    see_four(s, last, sum, &seen[0]);
    if (edges) add_edge_to_four(&seen[0], &a, sum);
    while (count > 0) {
        uint64_t const j = end[count - 1], m = i + (j - i) / 2, corner[3] = {i, m, j};
        const four_point *const b = &seen[count - 1];
        const four_point *const three[3] = {&a, &seen[count], b};
        if (j - i < 2 || (j - i > 2 && (i != begin || j != last) && add_far_to_four(&s->node[m], sum))) {
            if (edges) add_edge_to_four(&a, b, sum);
            a = *b;
            i = j;
            count--;
            continue;
        }
        end[count] = m;
        see_four(s, m, sum, &seen[count]);
        add_triangle_to_four(s, corner, three, sum);
        count++;
    }
}

BVXI_AVX2 static inline void begin_four(const bvxi_sheet *s, const int64_t p[4][3], double near, four_sum *sum)
{
    for (int a = 0; a < 3; a++)
        sum->at[a] = _mm256_setr_pd((double)p[0][a], (double)p[1][a], (double)p[2][a], (double)p[3][a]) * FOUR(s->scale[a]);
    for (int a = 0; a < 3; a++) sum->gradient[a] = sum->edge_gradient[a] = _mm256_setzero_pd();
    sum->im = sum->rounds = sum->turns = sum->rest = sum->bend = sum->edge_bend = sum->counted = _mm256_setzero_pd();
    sum->re = FOUR(1.0);
    sum->active = FOUR_LESS(_mm256_setzero_pd(), sum->re);
    sum->error = FOUR(BVXI_SHEET_ROUNDING);
    sum->factors = sum->alone = 0;
    sum->place = p;
    sum->near = near;
}

/* The product's angle is half the solid angle. */
BVXI_AVX2 static inline void end_four(four_sum *sum)
{
    double re[4], im[4], turns[4];
    _mm256_storeu_pd(re, sum->re);
    _mm256_storeu_pd(im, sum->im);
    for (int l = 0; l < 4; l++) turns[l] = (im[l] < 0 ? -bvxi_angle(re[l], -im[l]) : bvxi_angle(re[l], im[l])) / (2 * BVXI_PI);
    sum->turns += _mm256_loadu_pd(turns) + sum->rounds;
}

BVXI_AVX2 static void add_sheet_to_four(const bvxi_sheet *s, const int64_t p[4][3], double near, four_sum *sum)
{
    bvxi_sheet_walk w;
    uint64_t i, j;
    begin_four(s, p, near, sum);
    w.count = 0;
    if (s->holes->loops > 0) bvxi_sheet_push(&w, 0, s->holes->loops);
    while (bvxi_sheet_take(&w, &i, &j)) {
        uint64_t const m = i + (j - i) / 2;
        if (add_far_to_four(bvxi_sheet_group(s, i, j), sum)) continue;
        if (j - i < 2) {
            add_loop_to_four(s, bvxi_loop_begin(s->holes, s->order[i]), s->holes->loop_end[s->order[i]] - 1, sum);
            continue;
        }
        bvxi_sheet_push(&w, m, j);
        bvxi_sheet_push(&w, i, m);
    }
    end_four(sum);
}

/* ---- Each lane for itself ---- */

/* Of the active lanes those that are far from the part, which then counts as a whole there; in the digits of add_far_part. */
BVXI_AVX2 static inline four add_far_alone(const bvxi_sheet_node *n, four active, four_sum *sum)
{
    four const r[3] = {FOUR(n->centre[0]) - sum->at[0], FOUR(n->centre[1]) - sum->at[1], FOUR(n->centre[2]) - sum->at[2]}, d2 = four_dot(r, r);
    double const least = 2 * n->radius;
    four far = _mm256_and_pd(active, FOUR_LESS(FOUR(least * least), d2)), d, gap, factor, flux;
    if (FOUR_BITS(far) == 0) return far;
    d = _mm256_sqrt_pd(d2);
    gap = d - FOUR(n->radius);
    far = _mm256_and_pd(far, FOUR_LESS_EQUAL(FOUR(n->area * n->radius), FOUR(sum->near * (2 * BVXI_PI)) * (gap * gap * gap)));
    if (FOUR_BITS(far) == 0) return far;
    factor = FOUR(1.0) / (FOUR(4 * BVXI_PI) * d2 * d);
    flux = r[0] * FOUR(n->normal[0]) + r[1] * FOUR(n->normal[1]) + r[2] * FOUR(n->normal[2]);
    sum->turns += _mm256_and_pd(far, flux * factor);
    return far;
}

/* Lanes stand still up to the point until: parts are met from left to right. */
BVXI_AVX2 static void add_loop_alone(const bvxi_sheet *s, uint64_t begin, uint64_t last, four active, four_sum *sum)
{
    four until = FOUR_CHOOSE(active, _mm256_setzero_pd(), FOUR(0x1p60));
    uint64_t i = begin, end[40];
    four_point a, seen[40];
    int32_t count = 1;
    end[0] = last;
    see_four(s, begin, sum, &a);
    see_four(s, last, sum, &seen[0]);
    while (count > 0) {
        uint64_t const j = end[count - 1], m = i + (j - i) / 2, corner[3] = {i, m, j};
        const four_point *const b = &seen[count - 1];
        const four_point *const three[3] = {&a, &seen[count], b};
        four open = FOUR_LESS_EQUAL(until, FOUR((double)i));
        if (j - i > 2 && (i != begin || j != last)) {
            four const far = add_far_alone(&s->node[m], open, sum);
            until = FOUR_CHOOSE(far, FOUR((double)j), until);
            open = _mm256_andnot_pd(far, open);
        }
        if (j - i < 2 || FOUR_BITS(open) == 0) {
            a = *b;
            i = j;
            count--;
            continue;
        }
        end[count] = m;
        see_four(s, m, sum, &seen[count]);
        sum->active = open;
        add_triangle_to_four(s, corner, three, sum);
        count++;
    }
}

BVXI_AVX2 static void angles_four_avx2(const bvxi_sheet *s, const int64_t p[4][3], double near, double turns[4])
{
    four until = _mm256_setzero_pd();
    bvxi_sheet_walk w;
    four_sum sum;
    uint64_t i, j;
    begin_four(s, p, near, &sum);
    sum.look = NULL;
    sum.reach = 0;
    sum.alone = 1;
    w.count = 0;
    if (s->holes->loops > 0) bvxi_sheet_push(&w, 0, s->holes->loops);
    while (bvxi_sheet_take(&w, &i, &j)) {
        uint64_t const m = i + (j - i) / 2;
        four open = FOUR_LESS_EQUAL(until, FOUR((double)i));
        four const far = add_far_alone(bvxi_sheet_group(s, i, j), open, &sum);
        until = FOUR_CHOOSE(far, FOUR((double)j), until);
        open = _mm256_andnot_pd(far, open);
        if (FOUR_BITS(open) == 0) continue;
        if (j - i < 2) {
            add_loop_alone(s, bvxi_loop_begin(s->holes, s->order[i]), s->holes->loop_end[s->order[i]] - 1, open, &sum);
            continue;
        }
        bvxi_sheet_push(&w, m, j);
        bvxi_sheet_push(&w, i, m);
    }
    end_four(&sum);
    _mm256_storeu_pd(turns, sum.turns);
}

/* ---- Questions ---- */

BVXI_AVX2 static void around_four_avx2(const bvxi_sheet *s, const int64_t p[4][3], double reach, double near, double edge_rest,
                                       bvxi_sheet_look look[4])
{
    double numbers[10][4];
    four_sum sum;
    for (int l = 0; l < 4; l++) look[l].edges = look[l].triangles = 0;
    sum.look = look;
    sum.reach = reach;
    sum.edge_rest = edge_rest;
    add_sheet_to_four(s, p, near, &sum);
    for (int a = 0; a < 3; a++) _mm256_storeu_pd(numbers[a], sum.gradient[a]);
    for (int a = 0; a < 3; a++) _mm256_storeu_pd(numbers[3 + a], sum.edge_gradient[a]);
    _mm256_storeu_pd(numbers[6], sum.turns);
    _mm256_storeu_pd(numbers[7], sum.rest);
    _mm256_storeu_pd(numbers[8], sum.bend);
    _mm256_storeu_pd(numbers[9], sum.edge_bend);
    for (int l = 0; l < 4; l++) {
        for (int a = 0; a < 3; a++) look[l].gradient[a] = numbers[a][l];
        for (int a = 0; a < 3; a++) look[l].edge_gradient[a] = numbers[3 + a][l];
        look[l].turns = numbers[6][l];
        look[l].rest = BVXI_SHEET_ROUNDING + numbers[7][l];
        look[l].bend = numbers[8][l];
        look[l].edge_bend = numbers[9][l];
    }
}

/* Four places that are not told with the first parts are asked one by one. */
BVXI_AVX2 static void turns_four_avx2(const bvxi_sheet *s, const int64_t p[4][3], int32_t want_clear, bvxi_sheet_answer answer[4])
{
    double turns[4], error[4];
    four_sum sum;
    sum.look = NULL;
    sum.reach = 0;
    add_sheet_to_four(s, p, bvxi_sheet_near[0], &sum);
    _mm256_storeu_pd(turns, sum.turns);
    _mm256_storeu_pd(error, sum.error);
    for (int l = 0; l < 4; l++)
        if (!bvxi_sheet_conclude(turns[l], error[l], want_clear, &answer[l])) answer[l] = bvxi_sheet_turns(s, p[l], want_clear);
}
#endif

void bvxi_sheet_angles_four(const bvxi_sheet *s, const int64_t p[4][3], double near, double turns[4])
{
#if BVXI_HAVE_AVX2
    if (s->fast) {
        angles_four_avx2(s, p, near, turns);
        return;
    }
#endif
    for (int l = 0; l < 4; l++) turns[l] = bvxi_sheet_angle(s, p[l], near);
}

void bvxi_sheet_around_four(const bvxi_sheet *s, const int64_t p[4][3], double reach, double near, double edge_rest, bvxi_sheet_look look[4])
{
#if BVXI_HAVE_AVX2
    if (s->fast) {
        around_four_avx2(s, p, reach, near, edge_rest, look);
        return;
    }
#endif
    for (int l = 0; l < 4; l++) bvxi_sheet_around(s, p[l], reach, near, edge_rest, &look[l]);
}

void bvxi_sheet_turns_four(const bvxi_sheet *s, const int64_t p[4][3], int32_t want_clear, bvxi_sheet_answer answer[4])
{
#if BVXI_HAVE_AVX2
    if (s->fast) {
        turns_four_avx2(s, p, want_clear, answer);
        return;
    }
#endif
    for (int l = 0; l < 4; l++) answer[l] = bvxi_sheet_turns(s, p[l], want_clear);
}
