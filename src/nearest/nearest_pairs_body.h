/* nearest_pairs_body.h - four pairs of a point and a triangle evaluated at a time. Included by
 * nearest_pairs.c once for each level of core/simd.h, with the same bits in each. */

BVXI_SIMD_CODE static inline void BVXI_SIMD(load_near_four)(const double (*from)[BVXI_NEAR_PAIRS], int32_t i,
                                                            doubles4 to[3])
{
    to[0] = four_load(from[0] + i);
    to[1] = four_load(from[1] + i);
    to[2] = four_load(from[2] + i);
}

/* Evaluate pairs i to i + 3; returns the bits of those that need point_triangle.c. */
BVXI_SIMD_CODE static inline uint32_t BVXI_SIMD(evaluate_near_four)(bvxi_near_pairs *pairs, int32_t i)
{
    doubles4 p[3], a[3], b[3], c[3], q[3], distance2;

    BVXI_SIMD(load_near_four)((const double(*)[BVXI_NEAR_PAIRS])pairs->point, i, p);
    BVXI_SIMD(load_near_four)((const double(*)[BVXI_NEAR_PAIRS])pairs->corner, i, a);
    BVXI_SIMD(load_near_four)((const double(*)[BVXI_NEAR_PAIRS])pairs->corner + 3, i, b);
    BVXI_SIMD(load_near_four)((const double(*)[BVXI_NEAR_PAIRS])pairs->corner + 6, i, c);
    uint32_t const done = BVXI_SIMD(bvxi_closest_on_four)(p, a, b, c, q, &distance2);

    for (int k = 0; k < 3; k++) four_store(pairs->closest[k] + i, q[k]);
    four_store(pairs->distance2 + i, distance2);
    return 15u ^ done;
}

/* Elements after the last pair are filled with it. */
BVXI_SIMD_CODE static void BVXI_SIMD(evaluate_near_fours)(bvxi_near_pairs *p)
{
    for (int32_t i = p->count; i > 0 && i % 4 != 0; i++) {
        for (int a = 0; a < 3; a++) p->point[a][i] = p->point[a][p->count - 1];
        for (int v = 0; v < 9; v++) p->corner[v][i] = p->corner[v][p->count - 1];
    }
    for (int32_t i = 0; i < p->count; i += 4) {
        uint32_t left = BVXI_SIMD(evaluate_near_four)(p, i);
        for (; left != 0; left &= left - 1) evaluate_near_pair(p, i + bvxi_lowest(left));
    }
}
