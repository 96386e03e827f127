/* sheet_four_body.h - the sums over a sheet from several places at once, one a lane, which move through it together.
 * Included by sheet.c once for each level of core/simd.h, after sheet_lanes_body.h.
 *
 * Parts are opened where one of the lanes requires it, so each is as near as by itself; neighbours require nearly the
 * same. Where digits count each goes alone: lanes that do not require a part to be opened stand still meanwhile.
 * Which of both it is each copy knows when it is compiled. */

/* 1 when the lanes that are far do not do: none is, or not all of those that go together. */
BVXI_SIMD_CODE static inline int BVXI_SIMD(opens_part)(four_mask far, int alone)
{
    uint32_t const bits = four_bits(far);
    return alone ? bits == 0 : bits != (1u << sheet_lanes) - 1;
}

/* Of the active lanes those that are far from a part, which then counts as a whole there. */
BVXI_SIMD_CODE BVXI_VECTOR_INLINE four_mask BVXI_SIMD(add_far_part)(const bvxi_sheet_node *n,
                                                                    four_mask active, int alone,
                                                                    four_sum *sum)
{
    /* At least twice the radius away, and far from all places within reach. */
    double const least = n->radius > 2 * sum->reach ? 2 * n->radius : n->radius + 2 * sum->reach;
    double const part = n->area * n->radius;
    four_mask const none = four_but(active, active);
    doubles4 const r[3] = {four_sub(four_all(n->centre[0]), sum->at[0]),
                           four_sub(four_all(n->centre[1]), sum->at[1]),
                           four_sub(four_all(n->centre[2]), sum->at[2])};
    doubles4 const d2 = four_dot(r, r);

    four_mask far = four_and(active, four_less(four_all(least * least), d2));
    if (BVXI_SIMD(opens_part)(far, alone)) return none;
    doubles4 const d = four_sqrt(d2), gap = four_sub(d, four_all(n->radius));
    doubles4 const cube = four_mul(four_mul(gap, gap), gap);
    far = four_and(far, four_less_equal(four_all(part), four_mul(four_all(sum->near * (2 * BVXI_PI)), cube)));
    if (BVXI_SIMD(opens_part)(far, alone)) return none;

    doubles4 const off = four_all(part / (2 * BVXI_PI));
    /* Its error within reach, and what the dipole bends. */
    if (sum->reach > 0) {
        doubles4 const left = four_sub(gap, four_all(sum->reach));
        doubles4 const left3 = four_mul(four_mul(left, left), left);
        doubles4 const rest = four_div(off, left3);
        doubles4 const most = four_all(3 * sum->reach * sum->reach * n->area / (4 * BVXI_PI));
        doubles4 const bend = four_div(most, four_mul(left3, left));
        far = four_and(far, four_less_equal(four_add(rest, bend), four_all(sum->near)));
        if (BVXI_SIMD(opens_part)(far, alone)) return none;
        sum->rest = four_add(sum->rest, four_keep(far, rest));
        sum->bend = four_add(sum->bend, four_keep(far, bend));
    }

    /* As a dipole: its flux is that of the summed normals at the ball's centre. */
    doubles4 const normal[3] = {four_all(n->normal[0]), four_all(n->normal[1]), four_all(n->normal[2])};
    doubles4 const factor = four_div(four_all(1.0), four_mul(four_mul(four_all(4 * BVXI_PI), d2), d));
    doubles4 const flux = four_dot(r, normal);
    sum->error = four_add(sum->error, four_keep(far, four_div(off, cube)));
    sum->turns = four_add(sum->turns, four_keep(far, four_mul(flux, factor)));
    if (sum->reach > 0) {
        doubles4 const along = four_div(four_mul(four_all(3.0), flux), d2);
        for (int k = 0; k < 3; k++) {
            doubles4 const way = four_sub(four_mul(along, r[k]), normal[k]);
            sum->gradient[k] = four_add(sum->gradient[k], four_keep(far, four_mul(way, factor)));
        }
    }
    return far;
}

/* From left to right: the part in hand begins at point i, seen as a, and ends at the stack's top. */
BVXI_SIMD_CODE BVXI_VECTOR_INLINE void BVXI_SIMD(add_loop)(const bvxi_sheet *s, uint64_t begin, uint64_t last,
                                                           four_mask active, int alone, four_sum *sum)
{
    int const edges = sum->reach > 0;
    doubles4 until = four_all(0.0); /* alone: where the part ends that a lane took as a whole */
    uint64_t i = begin, end[40];    /* halved each time */
    four_point a, seen[40];
    int32_t count = 1;

    /* The stack holds ends only: what lies to the left of the part in hand is done. */
    end[0] = last;
    BVXI_SIMD(see_four)(s, begin, sum, &a);
    BVXI_SIMD(see_four)(s, last, sum, &seen[0]);
    if (edges) BVXI_SIMD(add_edge_to_four)(&seen[0], &a, sum);
    while (count > 0) {
        uint64_t const j = end[count - 1], m = i + (j - i) / 2, corner[3] = {i, m, j};
        const four_point *const b = &seen[count - 1];
        const four_point *const three[3] = {&a, &seen[count], b};
        four_mask open = active;
        if (alone) open = four_and(active, four_less_equal(until, four_all((double)i)));

        /* The whole loop is never a far part here, as its group was looked at before. */
        if (j - i > 2 && (i != begin || j != last)) {
            four_mask const far = BVXI_SIMD(add_far_part)(&s->node[m], open, alone, sum);
            if (alone) until = four_choose(far, four_all((double)j), until);
            open = four_but(open, far);
        }
        /* A part is taken whole where it is one edge, or far; else it is a triangle and two parts. */
        if (j - i < 2 || four_bits(open) == 0) {
            /* of a far part this is the way of the rest's edge, its own is in its dipole */
            if (edges) BVXI_SIMD(add_edge_to_four)(&a, b, sum);
            a = *b;
            i = j;
            count--;
            continue;
        }
        end[count] = m;
        BVXI_SIMD(see_four)(s, m, sum, &seen[count]);
        if (alone) sum->active = open; /* only these take the triangle */
        BVXI_SIMD(add_triangle_to_four)(s, corner, three, sum);
        count++;
    }
}

BVXI_SIMD_CODE static inline void BVXI_SIMD(begin_sum)(const bvxi_sheet *s, const int64_t (*p)[3],
                                                       double near, int alone, four_sum *sum)
{
    doubles4 const zero = four_all(0.0);

    /* Rows become columns: a lane is a place, a vector one coordinate of all of them. */
    for (int a = 0; a < 3; a++) {
        double at[sheet_lanes];
        for (int l = 0; l < sheet_lanes; l++) at[l] = (double)p[l][a];
        sum->at[a] = four_mul(four_load(at), four_all(s->scale[a]));
        sum->gradient[a] = sum->edge_gradient[a] = zero;
    }
    sum->im = sum->rounds = sum->turns = sum->rest = sum->bend = sum->edge_bend = sum->counted = zero;
    sum->re = four_all(1.0);
    sum->active = four_less(zero, sum->re);
    sum->error = four_all(BVXI_SHEET_ROUNDING);
    sum->factors = 0;
    sum->alone = alone;
    sum->place = p;
    sum->near = near;
}

/* The product's angle is half the solid angle: 2 pi of it is a turn of 4 pi. */
BVXI_SIMD_CODE static inline void BVXI_SIMD(end_sum)(four_sum *sum)
{
    double re[sheet_lanes], im[sheet_lanes], turns[sheet_lanes];
    four_store(re, sum->re);
    four_store(im, sum->im);
    /* The angle needs a branch and a polynomial, so it is taken lane by lane, once. */
    for (int l = 0; l < sheet_lanes; l++)
        turns[l] = (im[l] < 0 ? -bvxi_angle(re[l], -im[l]) : bvxi_angle(re[l], im[l])) / (2 * BVXI_PI);
    sum->turns = four_add(sum->turns, four_add(four_load(turns), sum->rounds));
}

BVXI_SIMD_CODE BVXI_VECTOR_INLINE void BVXI_SIMD(add_sheet)(const bvxi_sheet *s, const int64_t (*p)[3],
                                                            double near, int alone, four_sum *sum)
{
    doubles4 until = four_all(0.0);
    bvxi_sheet_walk w;
    uint64_t i, j;

    BVXI_SIMD(begin_sum)(s, p, near, alone, sum);
    four_mask const all = sum->active;
    w.count = 0;
    /* Groups of loops from the whole down, from left to right; a far group is one dipole. */
    if (s->holes->loops > 0) bvxi_sheet_push(&w, 0, s->holes->loops);
    while (bvxi_sheet_take(&w, &i, &j)) {
        uint64_t const m = i + (j - i) / 2;
        four_mask open = all;
        if (alone) open = four_less_equal(until, four_all((double)i));
        four_mask const far = BVXI_SIMD(add_far_part)(bvxi_sheet_group(s, i, j), open, alone, sum);

        if (alone) until = four_choose(far, four_all((double)j), until);
        open = four_but(open, far);
        if (four_bits(open) == 0) continue;
        if (j - i < 2) {
            BVXI_SIMD(add_loop)
            (s, bvxi_loop_begin(s->holes, s->order[i]), s->holes->loop_end[s->order[i]] - 1, open, alone,
             sum);
            continue;
        }
        bvxi_sheet_push(&w, m, j);
        bvxi_sheet_push(&w, i, m);
    }
    BVXI_SIMD(end_sum)(sum);
}

/* All triangles of these cells, one by one: nothing of them is far. */
BVXI_SIMD_CODE BVXI_VECTOR_INLINE void BVXI_SIMD(add_cells)(const bvxi_sheet *s, const int64_t (*p)[3],
                                                            const uint32_t *cells, uint64_t count,
                                                            four_sum *sum)
{
    const uint32_t *const all = s->tree->corner;

    BVXI_SIMD(begin_sum)(s, p, -1, 0, sum);
    for (uint64_t i = 0; i < count; i++) {
        int const single = cells[i] >= s->tree->cells;
        const bvxi_sheet_cell *const c = &s->tree->cell[single ? 0 : cells[i]];
        uint64_t const first = single ? cells[i] - s->tree->cells : c->first;
        for (uint64_t t = first; t < (single ? first + 1 : c->end); t++) {
            uint64_t const corner[3] = {all[3 * t], all[3 * t + 1], all[3 * t + 2]};
            four_point seen[3];
            const four_point *const three[3] = {&seen[0], &seen[1], &seen[2]};
            for (int k = 0; k < 3; k++) BVXI_SIMD(see_four)(s, corner[k], sum, &seen[k]);
            for (int k = 0; k < 3 && sum->reach > 0; k++)
                BVXI_SIMD(add_edge_to_four)(&seen[k], &seen[(k + 1) % 3], sum);
            BVXI_SIMD(add_triangle_to_four)(s, corner, three, sum);
        }
    }
    BVXI_SIMD(end_sum)(sum);
}

/* ---- Questions ---- */

BVXI_SIMD_CODE static void BVXI_SIMD(cells_angles)(const bvxi_sheet *s, const int64_t (*p)[3],
                                                   const uint32_t *cells, uint64_t count, double *turns)
{
    four_sum sum;
    sum.look = NULL;
    sum.reach = 0;
    BVXI_SIMD(add_cells)(s, p, cells, count, &sum);
    four_store(turns, sum.turns);
}

BVXI_SIMD_CODE static void BVXI_SIMD(angles)(const bvxi_sheet *s, const int64_t (*p)[3], double near,
                                             int alone, double *turns, double *error)
{
    four_sum sum;
    sum.look = NULL;
    sum.reach = 0;
    if (alone) BVXI_SIMD(add_sheet)(s, p, near, 1, &sum);
    else BVXI_SIMD(add_sheet)(s, p, near, 0, &sum);
    four_store(turns, sum.turns);
    four_store(error, sum.error);
}

/* Edges and triangles are listed as they are met; everything else is stored at the end. */
BVXI_SIMD_CODE static inline void BVXI_SIMD(begin_looks)(double reach, double edge_rest,
                                                         bvxi_sheet_look *look, four_sum *sum)
{
    for (int l = 0; l < sheet_lanes; l++) look[l].edges = look[l].triangles = 0;
    sum->look = look;
    sum->reach = reach;
    sum->edge_rest = edge_rest;
}

BVXI_SIMD_CODE static inline void BVXI_SIMD(end_looks)(const four_sum *sum)
{
    double numbers[10][sheet_lanes];

    for (int a = 0; a < 3; a++) four_store(numbers[a], sum->gradient[a]);
    for (int a = 0; a < 3; a++) four_store(numbers[3 + a], sum->edge_gradient[a]);
    four_store(numbers[6], sum->turns);
    four_store(numbers[7], sum->rest);
    four_store(numbers[8], sum->bend);
    four_store(numbers[9], sum->edge_bend);
    for (int l = 0; l < sheet_lanes; l++) {
        bvxi_sheet_look *const look = &sum->look[l];
        for (int a = 0; a < 3; a++) look->gradient[a] = numbers[a][l];
        for (int a = 0; a < 3; a++) look->edge_gradient[a] = numbers[3 + a][l];
        look->turns = numbers[6][l];
        look->rest = BVXI_SHEET_ROUNDING + numbers[7][l];
        look->bend = numbers[8][l];
        look->edge_bend = numbers[9][l];
    }
}

BVXI_SIMD_CODE static void BVXI_SIMD(around)(const bvxi_sheet *s, const int64_t (*p)[3], double reach,
                                             double near, double edge_rest, bvxi_sheet_look *look)
{
    four_sum sum;
    BVXI_SIMD(begin_looks)(reach, edge_rest, look, &sum);
    BVXI_SIMD(add_sheet)(s, p, near, 0, &sum);
    BVXI_SIMD(end_looks)(&sum);
}
