/* test_decimal.c - decimal numbers against exact whole numbers, and against
 * the C library where it is trusted. */
#include "core/core.h"
#include "core/decimal.h"

#include "comma_locale.h"
#include "unity.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

void setUp(void)
{
}
void tearDown(void)
{
}

static uint64_t decimal_test_state;

static uint64_t decimal_test_random(void)
{
    decimal_test_state ^= decimal_test_state << 13;
    decimal_test_state ^= decimal_test_state >> 7;
    decimal_test_state ^= decimal_test_state << 17;
    return decimal_test_state;
}

static uint64_t bits_of(double v)
{
    uint64_t b;
    memcpy(&b, &v, sizeof b);
    return b;
}

static double double_of(uint64_t b)
{
    double v;
    memcpy(&v, &b, sizeof v);
    return v;
}

static uint32_t float_bits_of(float v)
{
    uint32_t b;
    memcpy(&b, &v, sizeof b);
    return b;
}

static float float_of(uint32_t b)
{
    float v;
    memcpy(&v, &b, sizeof v);
    return v;
}

/* Parse all of text, from a block of just its size, so that a sanitizer sees a read beyond the end. */
static double parse_all(const char *text)
{
    size_t const n = strlen(text);
    char *const copy = malloc(n + 1);
    double v = -1;
    memcpy(copy + 1, text, n);
    TEST_ASSERT_EQUAL_size_t_MESSAGE(n, bvxi_parse_double(copy + 1, copy + 1 + n, &v), text);
    free(copy);
    return v;
}

static float parse_all_float(const char *text)
{
    size_t const n = strlen(text);
    float v = -1;
    TEST_ASSERT_EQUAL_size_t_MESSAGE(n, bvxi_parse_float(text, text + n, &v), text);
    return v;
}

/* ---- tables ---- */

static void test_power_of_ten_is_within_its_bound(void)
{
    for (int32_t k = DECIMAL_LEAST; k <= DECIMAL_MOST; k++) {
        decimal_power const p = decimal_power_of_ten(k);
        TEST_ASSERT_EQUAL_UINT64(1, p.high >> 63);
        for (int more = 0; more <= 1; more++) {
            uint64_t const low = p.low + (more ? DECIMAL_ERROR : 0);
            uint64_t const high = p.high + (low < p.low);
            decimal_big ten, approximate;
            decimal_big_set(&ten, 1);
            approximate.count = 4;
            approximate.limb[0] = (uint32_t)low;
            approximate.limb[1] = (uint32_t)(low >> 32);
            approximate.limb[2] = (uint32_t)high;
            approximate.limb[3] = (uint32_t)(high >> 32);
            int32_t const order = decimal_big_compare(&ten, k, &approximate, p.exponent);
            TEST_ASSERT_EQUAL_INT32(more ? -1 : p.exact ? 0 : 1, order);
        }
    }
}

static void test_logarithms_are_exact(void)
{
    for (int32_t q = -1080; q <= 1000; q++) { /* 10^n <= 2^q < 10^(n+1), and for 3/4 of it */
        for (int less = 0; less <= 1; less++) {
            int32_t const n = less ? decimal_log10_of_less(q) : decimal_log10_of_two(q);
            for (int next = 0; next <= 1; next++) {
                decimal_big ten, two;
                decimal_big_set(&ten, 1);
                decimal_big_set(&two, less ? 3 : 1);
                int32_t const order = decimal_big_compare(&ten, n + next, &two, less ? q - 2 : q);
                TEST_ASSERT_TRUE(next ? order > 0 : order <= 0);
            }
        }
    }
}

/* ---- reading ---- */

static void test_parse_known_numbers(void)
{
    static const struct {
        const char *text;
        uint64_t bits;
    } known[] = {
        {"0", 0},
        {"0000000000000000000000000", 0},
        {"0.0000000000000000000000000", 0},
        {"-0", UINT64_C(0x8000000000000000)},
        {"0e999999999999999999999", 0},
        {"0.000e-5", 0},
        {"1", UINT64_C(0x3ff0000000000000)},
        {"+1", UINT64_C(0x3ff0000000000000)},
        {"-1.", UINT64_C(0xbff0000000000000)},
        {".5", UINT64_C(0x3fe0000000000000)},
        {"5E-1", UINT64_C(0x3fe0000000000000)},
        {"000000000000000000000000000000000.5", UINT64_C(0x3fe0000000000000)},
        {"0.1", UINT64_C(0x3fb999999999999a)},
        {"0.3", UINT64_C(0x3fd3333333333333)},
        {"123456789012345678901234567890", UINT64_C(0x45f8ee90ff6c373e)},
        {"9007199254740993", UINT64_C(0x4340000000000000)}, /* 2^53 + 1: a tie to the even one below */
        {"9007199254740993.0000000000000000000000000001", UINT64_C(0x4340000000000001)},
        {"9007199254740995", UINT64_C(0x4340000000000002)}, /* a tie to the even one above */
        {"9007199254740994.9999999999999999999999999999", UINT64_C(0x4340000000000001)},
        {"1e23", UINT64_C(0x44b52d02c7e14af6)},
        {"8.5e22", UINT64_C(0x44b1ffdbf6b2b2eb)},
        {"1.7976931348623157e308", UINT64_C(0x7fefffffffffffff)},
        {"1.7976931348623158e308", UINT64_C(0x7fefffffffffffff)},
        {"1.7976931348623159e308", UINT64_C(0x7ff0000000000000)},
        {"1e309", UINT64_C(0x7ff0000000000000)},
        {"-1e99999999999999999999", UINT64_C(0xfff0000000000000)},
        {"2.2250738585072014e-308", UINT64_C(0x0010000000000000)},
        {"2.2250738585072011e-308", UINT64_C(0x000fffffffffffff)}, /* hung some other readers once */
        {"2.225073858507201136057409796709131975934819546351645648023426109724822222021076945516529523908135087914149"
         "15891303962110687008643869459464552765720740782062174337998814106326732925355228688137214901298112245145188"
         "98490572223072852551331557550159143974763979834118019993239622824787e-308",
         UINT64_C(0x000fffffffffffff)},
        {"5e-324", 1},
        {"4.9406564584124654e-324", 1},
        {"2.4703282292062328e-324", 1},
        {"2.4703282292062327e-324", 0},
        {"7.4109846876186981626485318930233e-324", 1},
        {"7.4109846876186981626485318930234e-324", 2},
        {"1e-324", 0},
        {"-1e-999999999999", UINT64_C(0x8000000000000000)},
        {"6.631236871469758276785396630275243e-4", UINT64_C(0x3f45baaf4655fd5c)},
        {"3.2378839133029012895883524125015321748630994e-8", UINT64_C(0x3e61621d1fb55988)},
        {"inf", UINT64_C(0x7ff0000000000000)},
        {"-INFINITY", UINT64_C(0xfff0000000000000)},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        TEST_ASSERT_EQUAL_HEX64_MESSAGE(known[i].bits, bits_of(parse_all(known[i].text)), known[i].text);
    TEST_ASSERT_TRUE(isnan(parse_all("NaN")));
    TEST_ASSERT_TRUE(isnan(parse_all_float("-nan")));
}

static void test_parse_known_floats(void)
{
    static const struct {
        const char *text;
        uint32_t bits;
    } known[] = {
        {"0.1", 0x3dcccccdu},
        {"-0", 0x80000000u},
        {"16777217", 0x4b800000u},
        {"16777219", 0x4b800002u},
        {"16777217.000000000000000000000000000001", 0x4b800001u},
        {"16777216.999999999999999999999", 0x4b800000u},
        {"3.4028235e38", 0x7f7fffffu},
        {"3.40282356e38", 0x7f7fffffu},
        {"3.4028235677973367e38", 0x7f800000u},
        {"3.4028235677973366e38", 0x7f7fffffu},
        {"1.1754944e-38", 0x00800000u},
        {"1.17549431e-38", 0x00800000u},
        {"1.1754942e-38", 0x007fffffu},
        {"1e-45", 1},
        {"7.006492321624085e-46", 0},
        {"7.0064923216240853e-46", 0},
        {"7.0064923216240854e-46", 1},
        {"1e-46", 0},
        {"1e-300", 0},
        {"1e300", 0x7f800000u},
        {"-1e39", 0xff800000u},
        {"1.00000017881393432617187499", 0x3f800001u},
        {"1.00000017881393432617187500", 0x3f800002u},
        {"1.00000017881393432617187501", 0x3f800002u},
        {"inf", 0x7f800000u},
    };
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        TEST_ASSERT_EQUAL_HEX32_MESSAGE(known[i].bits, float_bits_of(parse_all_float(known[i].text)),
                                        known[i].text);
}

static void test_parse_takes_only_the_number(void)
{
    static const struct {
        const char *text;
        size_t used;
        double value;
    } cases[] = {
        {"", 0, 7},    {"+", 0, 7},       {"-", 0, 7},     {".", 0, 7},     {"-.", 0, 7},      {"e5", 0, 7},
        {".e5", 0, 7}, {"--1", 0, 7},     {" 1", 0, 7},    {"x", 0, 7},     {"in", 0, 7},      {"na", 0, 7},
        {"1e", 1, 1},  {"1e+", 1, 1},     {"1e-x", 1, 1},  {"1.e1", 4, 10}, {"1.5.5", 3, 1.5}, {"0x10", 1, 0},
        {"1,5", 1, 1}, {"1e5e5", 3, 1e5}, {"2/3/4", 1, 2}, {"1d5", 1, 1},   {"1 2", 1, 1},
    };
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        double v = 7;
        float f = 7;
        const char *const t = cases[i].text;
        TEST_ASSERT_EQUAL_size_t_MESSAGE(cases[i].used, bvxi_parse_double(t, t + strlen(t), &v), t);
        TEST_ASSERT_EQUAL_HEX64_MESSAGE(bits_of(cases[i].value), bits_of(v), t);
        TEST_ASSERT_EQUAL_size_t_MESSAGE(cases[i].used, bvxi_parse_float(t, t + strlen(t), &f), t);
        TEST_ASSERT_TRUE_MESSAGE(f == (float)cases[i].value, t);
    }
    const char *const digits = "12345";
    double v = 0;
    /* the end counts, not what follows */
    TEST_ASSERT_EQUAL_size_t(2, bvxi_parse_double(digits, digits + 2, &v));
}

static void test_parse_stops_at_every_end(void)
{
    const char *const text = "-123.4567890123456789012345678e-12";

    for (size_t n = 0; n <= strlen(text); n++) {
        char cut[64], *const exact = malloc(n > 0 ? n : 1);
        double got = 0;
        memcpy(cut, text, n);
        cut[n] = 0;
        memcpy(exact, text, n);
        size_t const used = bvxi_parse_double(exact, exact + n, &got);
        char *end;
        double const want = strtod(cut, &end);
        TEST_ASSERT_EQUAL_size_t((size_t)(end - cut), used);
        TEST_ASSERT_EQUAL_HEX64(bits_of(want), bits_of(got));
        free(exact);
    }
}

/* c * 2^q in decimal, exactly: digits and a power of ten. Returns the number of digits. */
static size_t exact_decimal(uint64_t c, int32_t q, char *text, int32_t *exponent)
{
    uint32_t nines[140]; /* base 10^9, lowest first: 2^1030 and 5^1075 * 2^54 fit */
    size_t count = 0, n = 0;

    for (; c != 0; c /= 1000000000u) nines[count++] = (uint32_t)(c % 1000000000u);
    *exponent = q < 0 ? q : 0;
    for (int32_t i = 0; i < (q < 0 ? -q : q); i++) {
        uint64_t carry = 0;
        for (size_t k = 0; k < count; k++) {
            carry += (uint64_t)nines[k] * (q < 0 ? 5 : 2);
            nines[k] = (uint32_t)(carry % 1000000000u);
            carry /= 1000000000u;
        }
        if (carry != 0) nines[count++] = (uint32_t)carry;
    }
    n = (size_t)sprintf(text, "%u", (unsigned)nines[count - 1]);
    for (size_t k = count - 1; k-- > 0;) n += (size_t)sprintf(text + n, "%09u", (unsigned)nines[k]);
    return n;
}

/* The middle between a number and the next, and what lies just beside it; seen is the reader under test. */
static void check_middle(uint64_t bits, const decimal_kind *kind, uint64_t (*seen)(const char *))
{
    char text[1400];
    uint64_t c;
    int32_t q, exponent;

    decimal_take_apart(bits, kind, &c, &q);
    size_t const n = exact_decimal(2 * c + 1, q - 1, text, &exponent);
    char *const tail = &text[n];
    sprintf(tail, "e%d", (int)exponent);
    TEST_ASSERT_EQUAL_HEX64_MESSAGE(bits + (bits & 1), seen(text), text);
    sprintf(tail, "000000000000000000000000000000000000000000000000001e%d", (int)exponent - 51);
    TEST_ASSERT_EQUAL_HEX64_MESSAGE(bits + 1, seen(text), text);
    size_t last = n - 1;
    for (; text[last] == '0'; last--) text[last] = '9';
    text[last]--;
    sprintf(tail, "99999999999999999999e%d", (int)exponent - 20);
    TEST_ASSERT_EQUAL_HEX64_MESSAGE(bits, seen(text), text);
}

static uint64_t seen_double(const char *text)
{
    return bits_of(parse_all(text));
}

static uint64_t seen_float(const char *text)
{
    return float_bits_of(parse_all_float(text));
}

static void test_parse_middles_of_neighbours(void)
{
    decimal_test_state = 11;
    check_middle(0, &decimal_f64, seen_double); /* half of the smallest */
    check_middle(1, &decimal_f64, seen_double);
    check_middle(UINT64_C(0x000fffffffffffff), &decimal_f64, seen_double); /* denormal against normal */
    check_middle(UINT64_C(0x001fffffffffffff), &decimal_f64, seen_double);
    check_middle(UINT64_C(0x7fefffffffffffff), &decimal_f64, seen_double); /* largest against infinity */
    check_middle(0, &decimal_f32, seen_float);
    check_middle(0x007fffffu, &decimal_f32, seen_float);
    check_middle(0x7f7fffffu, &decimal_f32, seen_float);
    for (int i = 0; i < 300; i++) {
        check_middle(decimal_test_random() % UINT64_C(0x7ff0000000000000), &decimal_f64, seen_double);
        check_middle(decimal_test_random() % UINT64_C(0x0020000000000000), &decimal_f64, seen_double);
        check_middle(decimal_test_random() % 0x7f800000u, &decimal_f32, seen_float);
        check_middle(decimal_test_random() % 0x01000000u, &decimal_f32, seen_float);
    }
}

static void test_parse_any_number_of_digits(void)
{
    size_t const n = 100000;
    char *const text = malloc(n + 100);

    text[0] = '1'; /* 1000...0e-100000 */
    memset(text + 1, '0', n);
    strcpy(text + 1 + n, "e-100000");
    TEST_ASSERT_EQUAL_HEX64(bits_of(1.0), bits_of(parse_all(text)));
    text[0] = '0'; /* 0.000...0123e100003 */
    text[1] = '.';
    memset(text + 2, '0', n);
    strcpy(text + 2 + n, "123e100003");
    TEST_ASSERT_EQUAL_HEX64(bits_of(123.0), bits_of(parse_all(text)));
    strcpy(text, "9007199254740993."); /* a tie but for the very last digit */
    memset(text + 17, '0', n);
    strcpy(text + 17 + n, "1");
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x4340000000000001), bits_of(parse_all(text)));
    text[17 + n] = '0';
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x4340000000000000), bits_of(parse_all(text)));
    memset(text, '9', n);
    strcpy(text + n, "e-99999");
    TEST_ASSERT_EQUAL_HEX64(bits_of(10.0), bits_of(parse_all(text)));
    memset(text, '1', 400);
    text[400] = 0;
    TEST_ASSERT_TRUE(isinf(parse_all(text)));
    free(text);
}

static void test_parse_agrees_with_the_library(void)
{
    char text[64];

    decimal_test_state = 12;
    for (int i = 0; i < 60000; i++) {
        uint64_t const r = decimal_test_random();
        int const digits = 1 + (int)(decimal_test_random() % 24);
        double const v = double_of(r);
        if (i % 3 == 0 && isfinite(v)) sprintf(text, "%.*e", digits, v);
        else if (i % 3 == 1)
            sprintf(text, "%.*f", digits % 12, (double)(int64_t)r / 9007199254740992.0 / 100.0);
        else
            sprintf(text, "%llue%d", (unsigned long long)(r >> digits * 2),
                    (int)(decimal_test_random() % 80) - 40);
        TEST_ASSERT_EQUAL_HEX64_MESSAGE(bits_of(strtod(text, NULL)), bits_of(parse_all(text)), text);
        TEST_ASSERT_EQUAL_HEX32_MESSAGE(float_bits_of(strtof(text, NULL)),
                                        float_bits_of(parse_all_float(text)), text);
    }
}

/* ---- printing ---- */

static void test_print_forms(void)
{
    static const struct {
        double value;
        const char *text;
    } known[] = {
        {0, "0"},
        {-0.0, "-0"},
        {1, "1"},
        {-1, "-1"},
        {0.1, "0.1"},
        {0.3, "0.3"},
        {100, "100"},
        {123456, "123456"},
        {1.5, "1.5"},
        {-1234.5678, "-1234.5678"},
        {0.000001, "0.000001"},
        {0.00000123, "0.00000123"},
        {1e-7, "1e-7"},
        {1.5e-10, "1.5e-10"},
        {1e20, "100000000000000000000"},
        {1e21, "1e21"},
        {1.25e21, "1.25e21"},
        {1e23, "1e23"},
        {123456789012345680.0, "123456789012345680"},
        {9007199254740993.0, "9007199254740992"},
        {5e-324, "5e-324"},
        {1.7976931348623157e308, "1.7976931348623157e308"},
        {2.2250738585072014e-308, "2.2250738585072014e-308"},
        {2.2250738585072011e-308, "2.225073858507201e-308"},
        {9.5367431640625e-07, "9.5367431640625e-7"},
        {4.35, "4.35"},
        {2e-44, "2e-44"},
        {1.0 / 3, "0.3333333333333333"},
        {HUGE_VAL, "inf"},
        {-HUGE_VAL, "-inf"},
        /* ties to even */
        {1125899906842624.25, "1125899906842624.2"},
        {1125899906842624.75, "1125899906842624.8"},
        {9.007199254740991e22, "9.00719925474099e22"},
        {6.666666666666666e-7, "6.666666666666666e-7"},
    };
    static const struct {
        float value;
        const char *text;
    } floats[] = {
        {0.1f, "0.1"},
        {16777216.0f, "16777216"},
        {3.4028235e38f, "3.4028235e38"},
        {1e-45f, "1e-45"},
        {-0.0f, "-0"},
        {1.17549435e-38f, "1.1754944e-38"},
        {0.3f, "0.3"},
        {33554432.0f, "33554432"},
        {8388608.5f, "8388608"},
        {1.0f / 3, "0.33333334"},
    };
    char text[32];
    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        TEST_ASSERT_EQUAL_INT32((int32_t)strlen(known[i].text), bvxi_print_double(known[i].value, text));
        TEST_ASSERT_EQUAL_STRING(known[i].text, text);
    }
    for (size_t i = 0; i < sizeof floats / sizeof floats[0]; i++) {
        TEST_ASSERT_EQUAL_INT32((int32_t)strlen(floats[i].text), bvxi_print_float(floats[i].value, text));
        TEST_ASSERT_EQUAL_STRING(floats[i].text, text);
    }
    TEST_ASSERT_EQUAL_INT32(3, bvxi_print_double(double_of(UINT64_C(0xfff8000000000000)), text));
    TEST_ASSERT_EQUAL_STRING("nan", text);
}

static int significant_digits(const char *text)
{
    int n = 0, zeros = 0;
    for (; *text != 0 && *text != 'e'; text++) {
        if (*text == '.' || *text == '-' || (*text == '0' && n == 0)) continue;
        zeros = *text == '0' ? zeros + 1 : 0;
        n++;
    }
    return n - zeros;
}

/* Reads back, and no shorter text does. */
static void check_print_double(double v)
{
    char text[32], other[64];
    int32_t const n = bvxi_print_double(v, text);

    TEST_ASSERT_TRUE(n < 27 && text[n] == 0);
    TEST_ASSERT_EQUAL_HEX64_MESSAGE(bits_of(v), bits_of(strtod(text, NULL)), text);
    TEST_ASSERT_EQUAL_HEX64_MESSAGE(bits_of(v), bits_of(parse_all(text)), text);
    int const digits = significant_digits(text);
    if (digits == 0) return;
    if (digits > 1) {
        sprintf(other, "%.*e", digits - 2, v);
        TEST_ASSERT_TRUE_MESSAGE(bits_of(strtod(other, NULL)) != bits_of(v), text);
    }
}

static void check_print_float(float v)
{
    char text[32], other[64];
    int32_t const n = bvxi_print_float(v, text);

    TEST_ASSERT_TRUE(n < 27 && text[n] == 0);
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(float_bits_of(v), float_bits_of(strtof(text, NULL)), text);
    TEST_ASSERT_EQUAL_HEX32_MESSAGE(float_bits_of(v), float_bits_of(parse_all_float(text)), text);
    int const digits = significant_digits(text);
    TEST_ASSERT_TRUE_MESSAGE(digits <= 9, text);
    if (digits < 2) return;
    sprintf(other, "%.*e", digits - 2, (double)v);
    TEST_ASSERT_TRUE_MESSAGE(float_bits_of(strtof(other, NULL)) != float_bits_of(v), text);
}

/* The printed digits are those of exact_decimal of the number, cut at their
 * length and rounded to the nearest. */
static void check_print_is_closest(uint64_t bits, const decimal_kind *kind, const char *text)
{
    char exact[1400];
    char digits[24], *d = digits;
    uint64_t c;
    int32_t q, exponent;

    decimal_take_apart(bits, kind, &c, &q);
    size_t const n = exact_decimal(c, q, exact, &exponent);
    for (const char *p = text; *p != 0 && *p != 'e'; p++)
        if (*p != '.' && *p != '-' && !(*p == '0' && d == digits)) *d++ = *p;
    while (d > digits && d[-1] == '0') d--; /* zeros of a whole number */
    size_t const k = (size_t)(d - digits);
    *d = 0;
    if (k >= n) return; /* all digits of the number are there */
    /* |10^(n-k) * digits - exact| must not be above half a unit of the last digit: compare the first k
     * digits */
    int const rest = exact[k] > '5' ? 1 : exact[k] < '5' ? -1 : (int)(strspn(exact + k + 1, "0") < n - k - 1);
    char below[32];
    memcpy(below, exact, k);
    below[k] = 0;
    int const same = strcmp(below, digits) == 0;
    /* the interval is uneven: the closest may lie outside */
    if (c == UINT64_C(1) << (kind->precision - 1)) return;
    if (rest < 0) TEST_ASSERT_TRUE_MESSAGE(same, text);
    if (rest > 0) TEST_ASSERT_TRUE_MESSAGE(!same, text);
}

static void test_print_is_short_and_closest(void)
{
    char text[32];

    decimal_test_state = 13;
    for (int i = 0; i < 30000; i++) {
        uint64_t const r = decimal_test_random();
        if (isfinite(double_of(r))) check_print_double(double_of(r));
        check_print_double((double)(int64_t)(r >> 20) / 1e6);
        check_print_double((double)(r >> 11));
        if (isfinite(float_of((uint32_t)r))) check_print_float(float_of((uint32_t)r));
        if (i % 100 == 0 && isfinite(double_of(r)) && (r << 1) != 0) {
            bvxi_print_double(double_of(r), text);
            check_print_is_closest(r & (UINT64_MAX >> 1), &decimal_f64, text);
        }
        if (i % 20 == 0 && isfinite(float_of((uint32_t)r)) && (uint32_t)(r << 1) != 0) {
            bvxi_print_float(float_of((uint32_t)r), text);
            check_print_is_closest((uint32_t)r & 0x7fffffffu, &decimal_f32, text);
        }
    }
    for (int e = 0; e < 0x7ff; e++) /* powers of two, whose interval is uneven, and their neighbours */
        for (uint64_t step = 0; step <= 2; step++)
            if (e > 0 || step > 0) check_print_double(double_of(((uint64_t)e << 52) + step - 1));
    for (int e = 1; e < 0xff; e++)
        for (int step = -1; step <= 1; step++) check_print_float(float_of((uint32_t)((e << 23) + step)));
    for (uint64_t b = 1; b < 2000; b++) check_print_double(double_of(b));
    for (uint32_t b = 1; b < 2000; b++) check_print_float(float_of(b));
}

/* ---- locale ---- */

static void test_a_locale_with_comma_changes_nothing(void)
{
    static const char point[] = "0.5", other[] = "0,5";
    char text[32];
    double v = 0;

    if (!set_comma_locale()) TEST_IGNORE_MESSAGE("no locale with a comma on this machine");
    size_t const used = bvxi_parse_double(point, point + 3, &v);
    size_t const comma = bvxi_parse_double(other, other + 3, &v);
    bvxi_print_double(0.5, text);
    setlocale(LC_ALL, "C");
    TEST_ASSERT_EQUAL_size_t(3, used);
    TEST_ASSERT_EQUAL_size_t(1, comma);
    TEST_ASSERT_EQUAL_STRING("0.5", text);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_power_of_ten_is_within_its_bound);
    RUN_TEST(test_logarithms_are_exact);
    RUN_TEST(test_parse_known_numbers);
    RUN_TEST(test_parse_known_floats);
    RUN_TEST(test_parse_takes_only_the_number);
    RUN_TEST(test_parse_stops_at_every_end);
    RUN_TEST(test_parse_middles_of_neighbours);
    RUN_TEST(test_parse_any_number_of_digits);
    RUN_TEST(test_parse_agrees_with_the_library);
    RUN_TEST(test_print_forms);
    RUN_TEST(test_print_is_short_and_closest);
    RUN_TEST(test_a_locale_with_comma_changes_nothing);
    return UNITY_END();
}
