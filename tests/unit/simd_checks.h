/* simd_checks.h - one round of checks of core/simd.h at a level. Included by test_simd.c once for each. */

/* Every lane of a vector or mask against an expression of x, y and z in lane i. */
#define EXPECT_FOURS(vector, expression)                                         \
    do {                                                                         \
        double got_[4];                                                          \
        four_store(got_, vector);                                                \
        for (int i = 0; i < 4; i++) expect_same((expression), got_[i], #vector); \
    } while (0)
#define EXPECT_FOUR_BITS(mask, expression)                                  \
    do {                                                                    \
        uint32_t wanted_ = 0;                                               \
        for (int i = 0; i < 4; i++) wanted_ |= (uint32_t)(expression) << i; \
        TEST_ASSERT_EQUAL_HEX32_MESSAGE(wanted_, four_bits(mask), #mask);   \
    } while (0)
#define EXPECT_EIGHTS(vector, expression)                                                               \
    do {                                                                                                \
        float got_[8];                                                                                  \
        eight_store(got_, vector);                                                                      \
        for (int i = 0; i < 8; i++) expect_same((double)(float)(expression), (double)got_[i], #vector); \
    } while (0)
#define EXPECT_EIGHT_BITS(mask, expression)                                 \
    do {                                                                    \
        uint32_t wanted_ = 0;                                               \
        for (int i = 0; i < 8; i++) wanted_ |= (uint32_t)(expression) << i; \
        TEST_ASSERT_EQUAL_HEX32_MESSAGE(wanted_, eight_bits(mask), #mask);  \
    } while (0)

BVXI_SIMD_CODE static void BVXI_SIMD(check_doubles)(void)
{
    double x[4], y[4], z[4];

    for (int i = 0; i < 4; i++) {
        x[i] = any_number();
        y[i] = maker_random(&seed) % 4 == 0 ? x[i] : any_number();
        z[i] = any_number();
    }
    doubles4 const a = four_load(x), b = four_load(y), c = four_load(z);
    four_mask const less = four_less(a, b), equal = four_equal(a, b), low = four_less_equal(c, a);

    EXPECT_FOURS(four_all(x[2]), i < 4 ? x[2] : 0.0);
    expect_same(x[0], four_first(a), "four_first");
    EXPECT_FOURS(four_add(a, b), x[i] + y[i]);
    EXPECT_FOURS(four_sub(a, b), x[i] - y[i]);
    EXPECT_FOURS(four_mul(a, b), x[i] * y[i]);
    EXPECT_FOURS(four_div(a, b), x[i] / y[i]);
    EXPECT_FOURS(four_max(a, b), x[i] > y[i] ? x[i] : y[i]);
    EXPECT_FOURS(four_sqrt(four_size(a)), sqrt(fabs(x[i])));
    EXPECT_FOURS(four_size(a), fabs(x[i]));

    EXPECT_FOUR_BITS(less, x[i] < y[i]);
    EXPECT_FOUR_BITS(equal, x[i] == y[i]);
    EXPECT_FOUR_BITS(low, z[i] <= x[i]);
    EXPECT_FOUR_BITS(four_and(less, low), x[i] < y[i] && z[i] <= x[i]);
    EXPECT_FOUR_BITS(four_or(less, low), x[i] < y[i] || z[i] <= x[i]);
    EXPECT_FOUR_BITS(four_but(low, less), z[i] <= x[i] && !(x[i] < y[i]));
    EXPECT_FOUR_BITS(four_choose_mask(less, equal, low), x[i] < y[i] ? x[i] == y[i] : z[i] <= x[i]);
    EXPECT_FOURS(four_choose(less, a, c), x[i] < y[i] ? x[i] : z[i]);
    EXPECT_FOURS(four_keep(less, c), x[i] < y[i] ? z[i] : 0.0);
    EXPECT_FOURS(four_drop(less, c), x[i] < y[i] ? 0.0 : z[i]);
}

BVXI_SIMD_CODE static void BVXI_SIMD(check_floats)(void)
{
    float x[8], y[8], z[8], least[8];
    uint8_t bytes[33];
    uint32_t const set = (uint32_t)(maker_random(&seed) % 256);

    for (int i = 0; i < 8; i++) {
        x[i] = any_float();
        y[i] = maker_random(&seed) % 4 == 0 ? x[i] : any_float();
        z[i] = any_float();
    }
    memcpy(bytes + 1, x, sizeof x);
    memcpy(least, z, sizeof least);
    floats8 const a = eight_load(x), b = eight_load(y), c = eight_load(z);
    eight_mask const less = eight_less(a, b), low = eight_less_equal(c, a);

    EXPECT_EIGHTS(eight_load_bytes(bytes + 1), x[i]);
    EXPECT_EIGHTS(eight_load_two(x + 1, z + 3), i < 4 ? x[i + 1] : z[i - 1]);
    EXPECT_EIGHTS(eight_all(x[5]), i < 8 ? x[5] : 0.0f);
    EXPECT_EIGHTS(eight_add(a, b), x[i] + y[i]);
    EXPECT_EIGHTS(eight_sub(a, b), x[i] - y[i]);
    EXPECT_EIGHTS(eight_mul(a, b), x[i] * y[i]);
    EXPECT_EIGHTS(eight_div(a, b), x[i] / y[i]);
    EXPECT_EIGHTS(eight_min(a, b), x[i] < y[i] ? x[i] : y[i]);
    EXPECT_EIGHTS(eight_max(a, b), x[i] > y[i] ? x[i] : y[i]);
    EXPECT_EIGHTS(eight_sqrt(eight_mul(a, a)), sqrt((double)(float)(x[i] * x[i])));

    EXPECT_EIGHTS(eight_size(a), fabs((double)x[i]));
    for (int half = 4; half > 0; half /= 2)
        for (int i = 0; i < half; i++) least[i] = least[i] < least[i + half] ? least[i] : least[i + half];
    expect_same((double)least[0], (double)eight_least(c), "eight_least");

    EXPECT_EIGHT_BITS(less, x[i] < y[i]);
    EXPECT_EIGHT_BITS(eight_lanes(set), set >> i & 1);
    EXPECT_EIGHT_BITS(eight_equal(a, b), x[i] == y[i]);
    EXPECT_EIGHT_BITS(low, z[i] <= x[i]);
    EXPECT_EIGHT_BITS(eight_and(less, low), x[i] < y[i] && z[i] <= x[i]);
    EXPECT_EIGHT_BITS(eight_or(less, low), x[i] < y[i] || z[i] <= x[i]);
    EXPECT_EIGHTS(eight_choose(less, a, c), x[i] < y[i] ? x[i] : z[i]);
    EXPECT_EIGHTS(eight_keep(less, c), x[i] < y[i] ? z[i] : 0.0f);
    EXPECT_EIGHTS(eight_drop(less, c), x[i] < y[i] ? 0.0f : z[i]);
}

BVXI_SIMD_CODE static void BVXI_SIMD(check_columns)(void)
{
    float f[8][8], turned[8][8];
    double d[4][4];
    floats8 rows[8];
    doubles4 from_floats[4], from_doubles[4];

    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 8; k++) f[i][k] = (float)(10 * i + k);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 4; k++) d[i][k] = 0.5 + 10 * i + k;

    for (int i = 0; i < 8; i++) rows[i] = eight_load(f[i]);
    eight_columns(rows, turned, sizeof turned[0]);
    for (int i = 0; i < 8; i++)
        for (int k = 0; k < 8; k++) TEST_ASSERT_EQUAL_FLOAT(f[k][i], turned[i][k]);

    four_columns_f32(f[0], f[1], f[2], f[3], from_floats);
    four_columns_f64(d[0], d[1], d[2], d[3], from_doubles);
    for (int k = 0; k < 4; k++) {
        EXPECT_FOURS(from_floats[k], (double)f[i][k]);
        EXPECT_FOURS(from_doubles[k], d[i][k]);
    }
}

/* Bytes of 32 lanes, and words of eight rows of them. */
BVXI_SIMD_CODE static void BVXI_SIMD(check_bytes)(void)
{
    uint8_t x[8][32], got[4][32];
    uint64_t words[32], turned[32];
    bytes32 row[8], half[8];

    for (int r = 0; r < 8; r++) {
        for (int i = 0; i < 32; i++) x[r][i] = (uint8_t)(maker_random(&seed) >> 20);
        x[r][r] = x[0][r];
        row[r] = bytes_load(x[r]);
    }
    bytes32 const made[4] = {bytes_add(row[0], row[1]), bytes_sub(row[2], row[3]),
                             bytes_or(bytes_and(row[4], row[5]), bytes_all(x[6][7])),
                             bytes_at_most(row[7], row[0])};

    /* What lies in a vector is seen by its words: of eight rows alike. */
    for (int k = 0; k < 4; k++) {
        for (int r = 0; r < 8; r++) half[r] = made[k];
        bytes_words(half, words);
        for (int i = 0; i < 32; i++) got[k][i] = (uint8_t)words[i];
        for (int i = 0; i < 32; i++)
            TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x0101010101010101) * got[k][i], words[i]);
    }
    bytes_words(row, turned);
    for (int i = 0; i < 32; i++) {
        TEST_ASSERT_EQUAL_HEX8(x[0][i] + x[1][i], got[0][i]);
        TEST_ASSERT_EQUAL_HEX8(x[2][i] - x[3][i], got[1][i]);
        TEST_ASSERT_EQUAL_HEX8((x[4][i] & x[5][i]) | x[6][7], got[2][i]);
        TEST_ASSERT_EQUAL_HEX8(x[7][i] <= x[0][i] ? 255 : 0, got[3][i]);
        for (int r = 0; r < 8; r++) TEST_ASSERT_EQUAL_HEX8(x[r][i], (uint8_t)(turned[i] >> 8 * r));
    }
}
