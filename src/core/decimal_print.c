/* decimal_print.c - binary numbers to the shortest decimal text, without a locale or a heap.
 *
 * Source: Giulietti. The Schubfach way to render doubles. 2020.
 * With 10^k the largest power of ten not above the distance of two neighbours, the interval that rounds to a
 * number holds a multiple of 10^k, and at most one of 10^(k+1). All comparisons are between values scaled to
 * about 60 bits and rounded to odd, which keeps their order exact; the scaling is by a 128-bit power of ten,
 * and by big integers where that cannot decide.
 * Guarantee: the text reads back to the same bits, no shorter one does, and of those as short it is the
 * closest. */
#include "core/core.h"
#include "core/decimal.h"

/* c * 2^q / 10^k rounded down, its last bit set when that was not exact; the result has at most 60 bits. */
static uint64_t decimal_scale_odd(uint64_t c, int32_t q, int32_t k)
{
    decimal_power const ten = decimal_power_of_ten(-k);
    int32_t const cut = -(q + ten.exponent) - 64; /* 60..64, as 10^k <= 2^q < 10^(k+1) up to a quarter */
    uint64_t const mask = cut == 64 ? UINT64_MAX : (UINT64_C(1) << cut) - 1;
    uint64_t p[3], r;

    decimal_mul_wide(ten.high, ten.low, c, p);
    r = cut == 64 ? p[2] : p[2] << (64 - cut) | p[1] >> cut;
    if (ten.exact) return r | ((p[1] & mask) != 0 || p[0] != 0);
    if ((p[1] & mask) == mask && p[0] > UINT64_MAX - DECIMAL_ERROR * c) { /* perhaps r + 1 */
        decimal_big next, value;
        decimal_big_set(&next, r + 1);
        decimal_big_set(&value, c);
        int32_t const order = decimal_big_compare(&next, k, &value, q);
        if (order <= 0) return order == 0 ? r + 1 : (r + 1) | 1;
    }
    return r | 1;
}

/* The shortest digits * 10^k between the middles to c's neighbours, the closest of them. c is not 0. */
static uint64_t decimal_shortest(uint64_t c, int32_t q, const decimal_kind *kind, int32_t *exponent)
{
    /* The neighbour below the first number of an exponent is nearer than the one above. */
    int const uneven = c == UINT64_C(1) << (kind->precision - 1) && q != kind->low_exponent;
    int32_t const k = uneven ? decimal_log10_of_less(q) : decimal_log10_of_two(q);
    uint64_t const odd = c & 1; /* the middles themselves round to c only when it is even */
    uint64_t const low = decimal_scale_odd(4 * c - (uneven ? 1 : 2), q, k) + odd;
    uint64_t const here = decimal_scale_odd(4 * c, q, k);
    uint64_t const high = decimal_scale_odd(4 * c + 2, q, k) - odd;
    uint64_t const s = here / 4;

    *exponent = k;
    if (s >= 10) {
        uint64_t const t = s / 10;
        int const down = low <= 40 * t, up = 40 * t + 40 <= high;
        if (down != up) {
            *exponent = k + 1;
            return t + (uint64_t)up;
        }
    }
    int const down = low <= 4 * s, up = 4 * s + 4 <= high;
    if (down != up) return s + (uint64_t)up;
    return s + (here > 4 * s + 2 || (here == 4 * s + 2 && (s & 1)));
}

static size_t decimal_put_digits(uint64_t v, char *text)
{
    char reversed[20];
    size_t n = 0;
    for (; n == 0 || v != 0; v /= 10) reversed[n++] = (char)('0' + v % 10);
    for (size_t i = 0; i < n; i++) text[i] = reversed[n - 1 - i];
    return n;
}

/* digits * 10^exponent with a point where it is readable: from 0.000001 up to 21 places before the point. */
static size_t decimal_put(uint64_t digits, int32_t exponent, char *text)
{
    char d[20];

    for (; digits % 10 == 0; digits /= 10) exponent++;
    size_t const n = decimal_put_digits(digits, d);
    int32_t const point = (int32_t)n + exponent;
    char *t = text;
    if (point > 0 && point <= 21) {
        size_t const whole = (size_t)point < n ? (size_t)point : n;
        memcpy(t, d, whole);
        t += whole;
        for (int32_t i = 0; i < exponent; i++) *t++ = '0';
        if (whole < n) *t++ = '.';
        memcpy(t, d + whole, n - whole);
        return (size_t)(t - text) + n - whole;
    }
    if (point > -6 && point <= 0) {
        *t++ = '0';
        *t++ = '.';
        for (int32_t i = point; i < 0; i++) *t++ = '0';
        memcpy(t, d, n);
        return (size_t)(t - text) + n;
    }
    *t++ = d[0];
    if (n > 1) *t++ = '.';
    memcpy(t, d + 1, n - 1);
    t += n - 1;
    *t++ = 'e';
    if (point < 1) *t++ = '-';
    return (size_t)(t - text) + decimal_put_digits((uint64_t)(point < 1 ? 1 - point : point - 1), t);
}

static int32_t decimal_print(uint64_t bits, int negative, const decimal_kind *kind, char *text)
{
    size_t n = 0;

    if (bits > decimal_infinity(kind)) {
        memcpy(text, "nan", 4);
        return 3;
    }
    if (negative) text[n++] = '-';
    if (bits == decimal_infinity(kind)) {
        memcpy(text + n, "inf", 3);
        n += 3;
    } else if (bits == 0) {
        text[n++] = '0';
    } else {
        uint64_t c;
        int32_t q, exponent;
        decimal_take_apart(bits, kind, &c, &q);
        uint64_t const digits = decimal_shortest(c, q, kind, &exponent);
        n += decimal_put(digits, exponent, text + n);
    }
    text[n] = 0;
    return (int32_t)n;
}

int32_t bvxi_print_double(double value, char *text)
{
    uint64_t bits;
    memcpy(&bits, &value, sizeof bits);
    return decimal_print(bits & (UINT64_MAX >> 1), (int)(bits >> 63), &decimal_f64, text);
}

int32_t bvxi_print_float(float value, char *text)
{
    uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    return decimal_print(bits & (UINT32_MAX >> 1), (int)(bits >> 31), &decimal_f32, text);
}
