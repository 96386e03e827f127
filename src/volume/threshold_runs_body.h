/* threshold_runs_body.h - runs of floats in range or not, eight at a time, with their extremes. Included by
 * threshold.c once for each level of core/simd.h, with the same bits in each. */

/* What range_run_f32 does, for the whole words of a row without gaps: bits by the signs of comparisons,
 * extremes and whether there is anything but finite numbers on the way. Extremes ignore NaN in either
 * operand's place, as such blocks are counted anew. */
BVXI_SIMD_CODE static int32_t BVXI_SIMD(range_words_f32)(const bvxi_range *r, bvxi_range_tally *t,
                                                         const uint8_t *p, int32_t n, uint64_t *words)
{
    floats8 const low = eight_all(r->low.f), high = eight_all(r->high.f), zero = eight_all(0.0f);
    floats8 least = eight_all(3.4028234663852886e38f), greatest = eight_all(-3.4028234663852886e38f);
    float lanes[16];
    uint64_t inside = 0;
    int any = 0;

    for (int32_t k = 0; k < n; k++, p += 256) {
        eight_mask finite = eight_equal(zero, zero);
        floats8 small = least, large = greatest;
        uint64_t w = 0;

        for (int32_t i = 0; i < 8; i++) {
            floats8 const v = eight_load_bytes(p + 32 * i);
            eight_mask const in = eight_and(eight_less_equal(low, v), eight_less_equal(v, high));

            w |= (uint64_t)eight_bits(in) << 8 * i;
            if (t == NULL) continue;
            finite = eight_and(finite, eight_equal(eight_sub(v, v), zero));
            small = eight_min(v, small);
            large = eight_max(v, large);
        }

        words[k] = w;
        if (t == NULL) continue;
        inside += bvxi_popcount(w);
        if (eight_bits(finite) != 255) {
            count_each(p, BVX_SAMPLE_F32, 64, t);
            continue;
        }
        least = small;
        greatest = large;
        any = 1;
    }

    if (t == NULL) return n;
    t->inside += inside;
    eight_store(lanes, least);
    eight_store(lanes + 8, greatest);
    for (int32_t l = 1; l < 8; l++) {
        lanes[0] = lanes[l] < lanes[0] ? lanes[l] : lanes[0];
        lanes[8] = lanes[8 + l] > lanes[8] ? lanes[8 + l] : lanes[8];
    }
    if (any) count_each((const uint8_t *)lanes, BVX_SAMPLE_F32, 1, t);
    if (any) count_each((const uint8_t *)(lanes + 8), BVX_SAMPLE_F32, 1, t);
    return n;
}

BVXI_SIMD_CODE static void BVXI_SIMD(range_rows_f32)(const void *rule, void *tally, const uint8_t *p,
                                                     int64_t stride, int32_t n, uint64_t *words)
{
    const bvxi_range *const r = rule;
    int32_t const whole = stride == 4 && !r->empty ? BVXI_SIMD(range_words_f32)(r, tally, p, n >> 6, words)
                                                   : 0;
    if (64 * whole < n)
        BVXI_SIMD(range_run_f32)(rule, tally, p + (size_t)whole * 256, stride, n - 64 * whole, words + whole);
}
