/* threshold_columns_body.h - bytes of up to 64 columns to words of rows, for volumes whose fastest axis is
 * not x. Included by threshold.c once for each level of core/simd.h, with the same bits in each. */

/* v lies in the range just when v - low, modulo 256, is at most high - low: of signed bytes too. */
typedef struct BVXI_SIMD(column_range) {
    bytes32 low, width;
} BVXI_SIMD(column_range);

BVXI_SIMD_CODE BVXI_VECTOR_INLINE bytes32 BVXI_SIMD(column_flags)(const uint8_t *p,
                                                                  const BVXI_SIMD(column_range) * r,
                                                                  bytes32 bit)
{
    return bytes_and(bytes_at_most(bytes_sub(bytes_load(p), r->low), r->width), bit);
}

/* 64 bytes of each column. */
BVXI_SIMD_CODE static void BVXI_SIMD(column_square)(const BVXI_SIMD(column_range) * r, const uint8_t *p,
                                                    int64_t stride, int32_t columns, int64_t ahead,
                                                    uint64_t *rows)
{
    bytes32 first[8], second[8];

    for (int32_t g = 0; g < 8; g++) {
        bytes32 bit = bytes_all(1);

        first[g] = second[g] = bytes_all(0);
        for (int32_t c = 8 * g; c < 8 * g + 8 && c < columns; c++, p += (ptrdiff_t)stride) {
            first[g] = bytes_or(first[g], BVXI_SIMD(column_flags)(p, r, bit));
            second[g] = bytes_or(second[g], BVXI_SIMD(column_flags)(p + 32, r, bit));
            bit = bytes_add(bit, bit);
            if (ahead != 0) BVXI_PREFETCH(p + (ptrdiff_t)ahead);
        }
    }
    bytes_words(first, rows);
    bytes_words(second, rows + 32);
}

BVXI_SIMD_CODE static void BVXI_SIMD(range_columns)(const void *rule, const uint8_t *p, int64_t stride,
                                                    int32_t columns, int32_t n, int64_t ahead, uint64_t *rows)
{
    const bvxi_range *const range = rule;
    uint8_t few[64 * COLUMN_BYTES];
    uint64_t square[COLUMN_BYTES];
    BVXI_SIMD(column_range) r;

    if (range->empty) {
        memset(rows, 0, (size_t)n * sizeof rows[0]);
        return;
    }
    /* The low byte of a signed end is that of the unsigned one, whichever member of the union it is. */
    r.low = bytes_all((uint8_t)range->low.u);
    r.width = bytes_all((uint8_t)(range->high.u - range->low.u));

    if (n >= COLUMN_BYTES) {
        int32_t i = 0;

        for (; i + COLUMN_BYTES <= n; i += COLUMN_BYTES)
            BVXI_SIMD(column_square)(&r, p + i, stride, columns, ahead, rows + i);
        /* The last 64 once more where fewer remain: what was done before is done again. */
        if (i < n) BVXI_SIMD(column_square)
        (&r, p + n - COLUMN_BYTES, stride, columns, ahead, rows + n - COLUMN_BYTES);
        return;
    }
    /* Short columns are brought together first. */
    memset(few, 0, sizeof few);
    for (int32_t c = 0; c < columns; c++)
        memcpy(few + COLUMN_BYTES * c, p + (ptrdiff_t)(stride * c), (size_t)n);
    BVXI_SIMD(column_square)(&r, few, COLUMN_BYTES, columns, 0, square);
    memcpy(rows, square, (size_t)n * sizeof rows[0]);
}
