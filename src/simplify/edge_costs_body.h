/* edge_costs_body.h - four edges of a vertex at once, and four triangles. Included by edge_costs.c once for each level of
 * core/simd.h. */

/* What edges from u cost whose ends may move anywhere, as bvxi_edge_plan finds. */
BVXI_SIMD_CODE static void BVXI_SIMD(costs_of_four)(const bvxi_corner_vertex *u,
                                                    const bvxi_corner_vertex *const *v, double scale,
                                                    double cost[4])
{
    doubles4 const two = four_all(2.0), zero = four_all(0.0);
    const double *const at[4] = {(const double *)(const void *)v[0], (const double *)(const void *)v[1],
                                 (const double *)(const void *)v[2], (const double *)(const void *)v[3]};
    double const c_of[4] = {v[0]->q.c, v[1]->q.c, v[2]->q.c, v[3]->q.c};
    doubles4 at_v[12], offset[3], way[3], a[6], b[3], d[3], c, by[2];

    /* Positions, then the quadrics' A and b: all of a vertex are doubles. */
    for (int i = 0; i < 12; i += 4) four_columns_f64(at[0] + i, at[1] + i, at[2] + i, at[3] + i, at_v + i);
    for (int i = 0; i < 3; i++) offset[i] = four_mul(four_sub(at_v[i], four_all(u->p[i])), four_all(scale));
    {
        const doubles4 *const q = at_v + 3;
        doubles4 const row[3][3] = {{q[0], q[1], q[2]}, {q[1], q[3], q[4]}, {q[2], q[4], q[5]}};

        for (int i = 0; i < 3; i++) way[i] = four_dot(row[i], offset);
    }

    /* Both quadrics about u. */
    c = four_add(four_all(u->q.c), four_load(c_of));
    for (int i = 0; i < 6; i++) a[i] = four_add(four_all(u->q.a[i]), at_v[3 + i]);
    for (int i = 0; i < 3; i++) {
        b[i] = four_add(four_all(u->q.b[i]), four_sub(at_v[9 + i], way[i]));
        c = four_add(c, four_mul(offset[i], four_sub(way[i], four_mul(two, at_v[9 + i]))));
    }

    /* As bvxi_quadric_solve. */
    by[0] = four_div(four_all(1.0), a[0]);
    doubles4 const to_y = four_mul(a[1], by[0]), to_z = four_mul(a[2], by[0]);
    doubles4 const y = four_sub(a[3], four_mul(to_y, a[1])), yz = four_sub(a[4], four_mul(to_y, a[2]));
    by[1] = four_div(four_all(1.0), y);
    doubles4 const y_to_z = four_mul(yz, by[1]);
    doubles4 const z = four_sub(four_sub(a[5], four_mul(to_z, a[2])), four_mul(y_to_z, yz));
    doubles4 const least = four_mul(four_add(four_add(a[0], a[3]), a[5]), four_all(SOLVE_LEAST));
    doubles4 const right_y = four_sub(four_mul(to_y, b[0]), b[1]);
    doubles4 const right_z = four_sub(four_sub(four_mul(to_z, b[0]), b[2]), four_mul(y_to_z, right_y));
    d[2] = four_div(right_z, z);
    d[1] = four_sub(four_mul(right_y, by[1]), four_mul(y_to_z, d[2]));
    d[0] = four_sub(four_sub(four_sub(zero, four_mul(b[0], by[0])), four_mul(to_y, d[1])),
                    four_mul(to_z, d[2]));

    /* Near the edge, or at the better end. */
    for (int i = 0; i < 3; i++) way[i] = four_sub(d[i], four_mul(four_all(0.5), offset[i]));
    four_mask const solved = four_and(
        four_and(four_less(least, a[0]), four_less(least, y)),
        four_and(four_less(least, z),
                 four_less_equal(four_dot(way, way), four_mul(four_all(4.0), four_dot(offset, offset)))));
    doubles4 best = four_add(c, four_dot(b, d));
    if (BVXI_UNLIKELY(four_bits(solved) != 15)) {
        doubles4 const row[3][3] = {{a[0], a[1], a[2]}, {a[1], a[3], a[4]}, {a[2], a[4], a[5]}};
        doubles4 other = c, at_u_end = four_max(c, zero);

        for (int i = 0; i < 3; i++)
            other = four_add(other,
                             four_mul(four_add(four_dot(row[i], offset), four_mul(two, b[i])), offset[i]));
        other = four_max(other, zero);
        best = four_choose(solved, best, four_choose(four_less(other, at_u_end), other, at_u_end));
    }
    four_store(cost, four_max(best, zero));
}

/* 1: triangles from four vertices to edges keep their sides, and their shapes, when these move to p. */
BVXI_SIMD_CODE static int BVXI_SIMD(judge_four)(const double *const *from, const double *const *a,
                                                const double *const *b, const double *p, int needles)
{
    doubles4 at_from[4], at_a[4], at_b[4], u[3], v[3], w[3], n[3], before[3];
    doubles4 const at_p[3] = {four_all(p[0]), four_all(p[1]), four_all(p[2])};

    four_columns_f64(from[0], from[1], from[2], from[3], at_from);
    four_columns_f64(a[0], a[1], a[2], a[3], at_a);
    four_columns_f64(b[0], b[1], b[2], b[3], at_b);
    four_minus(at_a, at_from, u);
    four_minus(at_b, at_from, v);
    four_cross(u, v, before);
    doubles4 const sides_before = four_add(four_dot(u, u), four_dot(v, v));
    four_minus(at_a, at_p, u);
    four_minus(at_b, at_p, v);
    four_minus(at_b, at_a, w);
    four_cross(u, v, n);
    doubles4 const side = four_dot(w, w), sides = four_add(four_add(four_dot(u, u), four_dot(v, v)), side);
    doubles4 const square = four_dot(n, n), square_before = four_dot(before, before);
    doubles4 const cosine = four_dot(n, before), zero = four_all(0.0);

    /* No area, or NaN: nothing below could judge its side. */
    if (four_bits(four_less(zero, square)) != 15) return 0;

    /* What had no area has no side to keep. */
    doubles4 const most = four_mul(four_mul(four_all(SIDE_COSINE * SIDE_COSINE), square), square_before);
    four_mask const kept = four_and(four_less(zero, cosine), four_less(most, four_mul(cosine, cosine)));
    if (four_bits(four_or(kept, four_less_equal(square_before, zero))) != 15) return 0;

    /* A needle may stay one where the collapse makes it no thinner. */
    doubles4 const sides2 = four_mul(sides, sides);
    four_mask const shaped = four_less_equal(four_mul(four_all(NEEDLE_SHAPE * NEEDLE_SHAPE), sides2), square);
    if (BVXI_LIKELY(needles || four_bits(shaped) == 15)) return 1;
    doubles4 const all_before = four_add(sides_before, side);
    return four_bits(four_or(shaped, four_less(four_mul(square_before, sides2),
                                               four_mul(square, four_mul(all_before, all_before))))) == 15;
}
