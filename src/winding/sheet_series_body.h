/* sheet_series_body.h - what four far parts of a sheet do, a part a lane. Included by sheet_series.c once for each level
 * of core/simd.h. */

/* Derivatives of 1 / |r| up to a degree: n r^2 D[i] = -(2n - 1) sum i_a r_a D[i less a] - (n - 1) sum i_a
 * (i_a - 1) D[i less a twice]; and those with x twice, y twice and z twice more than any sum up to 0. */
BVXI_SIMD_CODE static inline void BVXI_SIMD(series_derivatives)(const bvxi_series_table *t,
                                                                const doubles4 r[3], doubles4 *d)
{
    doubles4 const inverse = four_div(four_all(1), four_dot(r, r));
    int const xx = t->sum[1][1], yy = t->sum[2][2];
    int i = 1;

    d[0] = four_sqrt(inverse);
    for (int n = 1; n <= BVXI_SERIES_ORDER; n++) {
        doubles4 const once = four_div(four_mul(four_all(-(2 * n - 1)), inverse), four_all(n));
        doubles4 const twice = four_div(four_mul(four_all(-(n - 1)), inverse), four_all(n));
        for (; i < t->end[n]; i++) {
            const uint8_t *const p = t->power[i], *const less = t->less[i];
            doubles4 first = four_all(0), second = first;
            /* The sum of the second derivatives is 0, so z twice follows from x twice and y twice. */
            if (p[2] >= 2) { /* both are before it */
                const uint8_t *const sum = t->sum[t->less[less[2]][2]];
                d[i] = four_sub(four_sub(four_all(0), d[sum[xx]]), d[sum[yy]]);
                continue;
            }
            for (int a = 0; a < 3; a++) {
                if (p[a] == 0) continue;
                first = four_add(first, four_mul(four_mul(four_all(p[a]), r[a]), d[less[a]]));
                if (p[a] == 1) continue;
                second = four_add(second, four_mul(four_all(p[a] * (p[a] - 1)), d[t->less[less[a]][a]]));
            }
            d[i] = four_add(four_mul(once, first), four_mul(twice, second));
        }
    }
}

BVXI_SIMD_CODE static void BVXI_SIMD(series_add)(const bvxi_series_table *t, const bvxi_series_parts *parts,
                                                 int32_t locals, double *c)
{
    doubles4 r[3], m[BVXI_SERIES_TERMS], d[BVXI_SERIES_TERMS];

    for (int a = 0; a < 3; a++) r[a] = four_load(parts->way[a]);
    for (int i = 0; i < BVXI_SERIES_TERMS; i += 4)
        four_columns_f64(parts->moment[0] + i, parts->moment[1] + i, parts->moment[2] + i,
                         parts->moment[3] + i, m + i);
    BVXI_SIMD(series_derivatives)(t, r, d);
    for (int k = 0; k < locals; k++) {
        /* The terms of moments and of the local series go together up to the order. */
        int const degree = series_degree(t, k), end = t->end[BVXI_SERIES_ORDER - degree];
        const uint8_t *const at = t->sum[k];
        doubles4 sum = four_all(0);
        double one[4];
        for (int i = 1; i < end; i++) sum = four_add(sum, four_mul(m[i], d[at[i]]));
        sum = four_div(four_mul(sum, four_all((degree & 1) != 0 ? 1 : -1)), four_all(4 * BVXI_PI));
        four_store(one, sum);
        for (int32_t lane = 0; lane < parts->count; lane++) c[k] += one[lane];
    }
}
