/* nearest_leaf_body.h - frames of eight triangles at a time: the longest edge, and the foot of the altitude
 * on it. Included by nearest_build.c once for each level of core/simd.h, with the same bits in each. */

BVXI_SIMD_CODE static inline floats8 BVXI_SIMD(near_inverse)(floats8 x)
{
    return eight_keep(eight_less(eight_all(NEAR_LEAST), x), eight_div(eight_all(1.0f), x));
}

/* Of the edges l, m and n, or their like, the one that is the longest. */
BVXI_SIMD_CODE static inline void BVXI_SIMD(near_third)(eight_mask at_b, eight_mask at_c, const floats8 a[3],
                                                        const floats8 b[3], const floats8 c[3],
                                                        floats8 chosen[3])
{
    for (int axis = 0; axis < 3; axis++)
        chosen[axis] = eight_choose(at_c, c[axis], eight_choose(at_b, b[axis], a[axis]));
}

BVXI_SIMD_CODE static void BVXI_SIMD(frame_near_leaf)(const float corner[9][BVXI_NEAR_WIDTH],
                                                      const float low[3], bvxi_near_leaf *leaf)
{
    floats8 const zero = eight_all(0.0f);
    floats8 const a[3] = {eight_load(corner[0]), eight_load(corner[1]), eight_load(corner[2])};
    floats8 const b[3] = {eight_load(corner[3]), eight_load(corner[4]), eight_load(corner[5])};
    floats8 const c[3] = {eight_load(corner[6]), eight_load(corner[7]), eight_load(corner[8])};
    floats8 l[3], m[3], n[3], o[3], u[3], v[3];
    floats8 e1[3], e2[3], e3[3], w[3], p[3], g[3], h[3], foot[3];

    /* The longest edge begins at o and runs along u; v goes from o to the corner across. */
    eight_minus(b, a, l);
    eight_minus(c, b, m);
    eight_minus(a, c, n);
    floats8 const l2 = eight_dot(l, l), m2 = eight_dot(m, m), n2 = eight_dot(n, n);
    eight_mask const at_b = eight_less(l2, m2), at_c = eight_less(eight_max(m2, l2), n2);
    BVXI_SIMD(near_third)(at_b, at_c, a, b, c, o);
    BVXI_SIMD(near_third)(at_b, at_c, l, m, n, u);
    BVXI_SIMD(near_third)(at_b, at_c, n, l, m, v);
    for (int i = 0; i < 3; i++) v[i] = eight_sub(zero, v[i]);

    /* Along the edge. */
    floats8 const length = eight_sqrt(eight_dot(u, u)), inverse = BVXI_SIMD(near_inverse)(length);
    for (int i = 0; i < 3; i++) e1[i] = eight_mul(u[i], inverse);
    e1[0] = eight_choose(eight_less(eight_all(NEAR_LEAST), length), e1[0], eight_all(1.0f));
    floats8 const along = eight_dot(v, e1);

    /* Across it, made orthogonal twice: what remains is the height. */
    eight_without(v, along, e1, w);
    floats8 const again = eight_dot(w, e1);
    eight_without(w, again, e1, p);
    floats8 const height = eight_sqrt(eight_dot(p, p));

    /* A trace of a direction across e1, so that there is one where the height is 0. */
    floats8 const trace = eight_add(eight_mul(length, eight_all(NEAR_TRACE)), eight_all(0x1p-60f));
    eight_mask const steep = eight_less(eight_all(0.5f), eight_mul(e1[0], e1[0]));
    g[0] = eight_sub(p[0], eight_mul(trace, eight_keep(steep, e1[2])));
    g[1] = eight_add(p[1], eight_mul(trace, eight_drop(steep, e1[2])));
    g[2] = eight_add(p[2], eight_mul(trace, eight_choose(steep, e1[0], eight_sub(zero, e1[1]))));
    floats8 const slant = eight_dot(g, e1);
    eight_without(g, slant, e1, h);
    floats8 const shrink = BVXI_SIMD(near_inverse)(eight_sqrt(eight_dot(h, h)));
    for (int i = 0; i < 3; i++) h[i] = eight_mul(h[i], shrink);
    floats8 const lean = eight_dot(h, e1);
    eight_without(h, lean, e1, e2);
    eight_cross(e1, e2, e3);

    /* The foot of the altitude, inside of the edge. */
    floats8 const before = eight_min(eight_max(along, zero), length), after = eight_sub(length, before);
    eight_along(o, before, e1, foot);
    for (int i = 0; i < 3; i++) foot[i] = eight_add(eight_all(low[i]), foot[i]);

    /* Rows become columns: the numbers of a triangle lie side by side. The
     * last of 16 makes way for the triangle's index. */
    floats8 const first[8] = {foot[0], foot[1], foot[2], e1[0], e1[1], e1[2], e2[0], e2[1]};
    floats8 const second[8] = {e2[2], e3[0], e3[1], e3[2], before, after, height, zero};
    eight_columns(first, leaf->frame, sizeof leaf->frame[0]);
    eight_columns(second, (char *)leaf->frame + sizeof(float) * 8, sizeof leaf->frame[0]);

    for (int i = 0; i < 3; i++) {
        eight_store(leaf->low[i], eight_min(eight_min(a[i], b[i]), c[i]));
        eight_store(leaf->high[i], eight_max(eight_max(a[i], b[i]), c[i]));
    }
}

/* The box of a leaf, and corners relative to it. */
BVXI_SIMD_CODE static void BVXI_SIMD(bound_near_leaf)(const bvxi_nearest *n,
                                                      const double corner[9][BVXI_NEAR_WIDTH], near_box *box,
                                                      float local[9][BVXI_NEAR_WIDTH])
{
    doubles4 const scale = four_all(n->scale), box_scale = four_all(n->box_scale);

    for (int a = 0; a < 3; a++) {
        doubles4 const middle = four_all(n->middle[a]);
        double at[3][BVXI_NEAR_WIDTH], least[4], most[4];
        doubles4 low = four_all(HUGE_VAL), high = four_all(-HUGE_VAL);

        /* Moved and scaled in doubles first, so that floats' digits go to the surroundings. */
        for (int v = 0; v < 3; v++)
            for (int k = 0; k < BVXI_NEAR_WIDTH; k += 4) {
                doubles4 const p = four_load(corner[3 * v + a] + k);
                doubles4 const x = four_mul(four_sub(four_mul(p, scale), middle), box_scale);
                four_store(at[v] + k, x);
                low = four_choose(four_less(x, low), x, low);
                high = four_max(x, high);
            }
        four_store(least, low);
        four_store(most, high);
        for (int k = 1; k < 4; k++) {
            least[0] = least[k] < least[0] ? least[k] : least[0];
            most[0] = most[k] > most[0] ? most[k] : most[0];
        }
        box->low[a] = bvxi_float_below(least[0]);
        box->high[a] = bvxi_float_above(most[0]);

        /* Corners relative to the leaf's box, whose rounded corner is exact: so roundings are small. */
        double const from = (double)box->low[a];
        for (int v = 0; v < 3; v++)
            for (int k = 0; k < BVXI_NEAR_WIDTH; k++) local[3 * v + a][k] = (float)(at[v][k] - from);
    }
}
