/* point_triangle_body.h - closest points on four triangles at a time; it finds the lanes where it is surely
 * what point_triangle.c gives and leaves the others to that. Included by point_triangle_four.h once for each
 * level of core/simd.h. */

/* The closest points q to p on the triangles a b c, and the squares of their distances. Returns the bits of
 * the lanes that hold what point_triangle.c gives, but for the sign of zeros in q; the others (needles, and
 * where rounding leaves no region) are left to it. */
BVXI_SIMD_CODE static inline uint32_t BVXI_SIMD(bvxi_closest_on_four)(const doubles4 p[3],
                                                                      const doubles4 a[3],
                                                                      const doubles4 b[3],
                                                                      const doubles4 c[3], doubles4 q[3],
                                                                      doubles4 *distance2)
{
    doubles4 const zero = four_all(0.0);
    doubles4 ab[3], ac[3], bc[3], ap[3], bp[3];
    doubles4 n[3], nb[3], nc[3];

    four_minus(b, a, ab);
    four_minus(c, a, ac);
    four_minus(c, b, bc);
    four_minus(p, a, ap);
    four_minus(p, b, bp);
    four_cross(ab, ac, n);
    four_cross(ap, ac, nb);
    four_cross(ab, ap, nc);

    /* What the cases require, in the words of point_triangle.c. */
    doubles4 const ab2 = four_dot(ab, ab), ac2 = four_dot(ac, ac), bc2 = four_dot(bc, bc);
    doubles4 const abac = four_dot(ab, ac), area2 = four_dot(n, n);
    doubles4 const d1 = four_dot(ab, ap), d2 = four_dot(ac, ap);
    doubles4 const d3 = four_sub(d1, ab2);
    doubles4 const d4 = four_sub(d2, abac);
    doubles4 const d5 = four_sub(d1, abac);
    doubles4 const d6 = four_sub(d2, ac2);
    doubles4 const vb = four_dot(nb, n), vc = four_dot(nc, n), va = four_sub(four_sub(area2, vb), vc);
    doubles4 const longest2 = four_max(four_max(ab2, ac2), bc2);
    four_mask const wide = four_less(four_mul(four_mul(longest2, longest2), four_all(0x1p-40)), area2);

    /* The cases in their order; each mask is used only where none before it is set. */
    four_mask const at_a = four_and(four_less_equal(d1, zero), four_less_equal(d2, zero));
    four_mask const at_b = four_and(four_less_equal(zero, d3), four_less_equal(d4, d3));
    four_mask const at_c = four_and(four_less_equal(zero, d6), four_less_equal(d5, d6));
    four_mask const on_ab = four_and(four_less_equal(vc, zero),
                                     four_and(four_less_equal(zero, d1), four_less_equal(d3, zero)));
    four_mask const on_ac = four_and(four_less_equal(vb, zero),
                                     four_and(four_less_equal(zero, d2), four_less_equal(d6, zero)));
    four_mask const on_bc = four_and(four_less_equal(va, zero),
                                     four_and(four_less_equal(d3, d4), four_less_equal(d6, d5)));
    four_mask const over = four_and(four_less(zero, va), four_and(four_less(zero, vb), four_less(zero, vc)));
    four_mask const corner = four_or(at_a, four_or(at_b, at_c)), edge = four_or(on_ab, four_or(on_ac, on_bc));

    /* An edge: from its first corner along it, its ends as they are. bc is the one that begins at b. */
    doubles4 const along = four_choose(on_ab, d1, four_choose(on_ac, d2, four_dot(bc, bp)));
    doubles4 const length2 = four_choose(on_ab, ab2, four_choose(on_ac, ac2, bc2));
    four_mask const first_b = four_but(edge, four_or(on_ab, on_ac));
    four_mask const begins = four_less_equal(along, zero), ends = four_less_equal(length2, along);

    /* One division serves the edges and, with that of t, the face. */
    doubles4 const s = four_div(four_choose(edge, along, vb), four_choose(edge, length2, area2));
    doubles4 const t = four_drop(edge, four_div(vc, area2));

    /* What ends up in a corner: a, else b, else c. */
    four_mask const snap = four_or(corner, four_and(edge, four_or(begins, ends)));
    four_mask const to_a = four_choose_mask(corner, at_a, four_but(begins, first_b));
    four_mask const to_b = four_choose_mask(corner, at_b,
                                            four_choose_mask(first_b, begins, four_and(on_ab, ends)));

    doubles4 away[3];
    for (int k = 0; k < 3; k++) {
        doubles4 const edge_way = four_choose(on_ab, ab[k], four_choose(on_ac, ac[k], bc[k]));
        doubles4 const way = four_choose(edge, edge_way, ab[k]), from = four_choose(first_b, b[k], a[k]);
        doubles4 const inside = four_add(four_add(from, four_mul(s, way)), four_mul(t, ac[k]));
        doubles4 const at_corner = four_choose(to_a, a[k], four_choose(to_b, b[k], c[k]));

        q[k] = four_choose(snap, at_corner, inside);
        away[k] = four_sub(p[k], q[k]);
    }
    *distance2 = four_dot(away, away);

    return four_bits(four_and(wide, four_or(four_or(corner, edge), over)));
}
