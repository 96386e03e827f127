/* nearest_order_body.h - the places of eight triangles on the curve: the middles of their boxes, which no order of
 * corners changes; no number counts as 0. Included by nearest_order.c once for each level of core/simd.h, with the
 * same bits in each. */

BVXI_SIMD_CODE static void BVXI_SIMD(key_some)(const bvxi_curve *curve,
                                               const double corner[9][BVXI_CURVE_LANES],
                                               uint64_t key[BVXI_CURVE_LANES])
{
    doubles4 const scale = four_all(curve->scale), units = four_all(curve->units), none = four_all(0.0);
    doubles4 const most = four_all((double)((1 << curve->bits) - 1));
    uint64_t sum[BVXI_CURVE_LANES] = {0};

    for (int a = 0; a < 3; a++) {
        doubles4 const centre = four_all(curve->centre[a]);
        double at[BVXI_CURVE_LANES];

        for (int i = 0; i < BVXI_CURVE_LANES; i += 4) {
            doubles4 const p = four_load(corner[a] + i), q = four_load(corner[a + 3] + i);
            doubles4 const r = four_load(corner[a + 6] + i), first = four_choose(four_less(p, q), p, q);
            doubles4 const low = four_choose(four_less(r, first), r, first);
            doubles4 const high = four_max(r, four_max(p, q));
            doubles4 const x = four_mul(four_sub(four_mul(low, scale), centre), units);
            doubles4 const y = four_mul(four_sub(four_mul(high, scale), centre), units);
            doubles4 const middle = four_add(four_mul(four_add(x, y), four_all(0.25)), four_all(0.5));
            doubles4 const place = four_mul(middle, most);
            doubles4 const cut = four_choose(four_less(most, place), most, place);
            four_store(at + i, four_keep(four_less(none, cut), cut));
        }
        for (int i = 0; i < BVXI_CURVE_LANES; i++) sum[i] |= bvxi_curve_spread((uint64_t)(int32_t)at[i]) << a;
    }
    memcpy(key, sum, sizeof sum);
}
