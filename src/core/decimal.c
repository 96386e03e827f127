/* decimal.c - decimal text to binary numbers, correctly rounded for any number of digits, and binary numbers
 * to their shortest text. Both in integers: no locale, no heap, the same on every machine.
 *
 * Reading and printing share the powers of ten of decimal.h. Each has its sources at its own heading
 * below. */
#include "core/decimal.h"

/* ---- Decimal text to binary numbers, correctly rounded, for any number of digits, without a locale or a
 * heap ---- */

/* Sources: Clinger. How to Read Floating Point Numbers Accurately. 1990 (exact operands and one rounding);
 * Lemire. Number Parsing at a Gigabyte per Second. 2021 (64 x 128 bit product).
 * Few digits and a small exponent are one multiplication or division. Else the first 19 digits times a
 * 128-bit power of ten are rounded, and where the known error of that could change the result, big integers
 * compare the text with the middle of two neighbours. They take 770 digits: a middle of two doubles has at
 * most 767, so that of further ones it only counts whether they are all zero.
 * Guarantee: to nearest, ties to even, overflow to infinity. */

enum { DECIMAL_BIG_DIGITS = 770 };

static const double decimal_exact_powers[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                              1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                              1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

/* One operation on doubles rounds once, unless the compiler keeps them in wider registers. */
#if (defined(__FLT_EVAL_METHOD__) && (__FLT_EVAL_METHOD__ < 0 || __FLT_EVAL_METHOD__ > 1)) || \
    (defined(_M_IX86_FP) && _M_IX86_FP < 2)
enum { DECIMAL_ROUNDS_ONCE = 0 };
#else
enum { DECIMAL_ROUNDS_ONCE = 1 };
#endif

/* ---- reading ---- */

typedef struct decimal_scan {
    const char *digits, *end; /* the digits with their point */
    uint64_t w;               /* the first 19 significant digits at most */
    int64_t exponent;         /* of w */
    int32_t truncated;        /* digits follow those of w */
    int32_t negative;
} decimal_scan;

static unsigned decimal_digit(char c)
{
    return (unsigned)(unsigned char)c - '0'; /* 10 or more: not a digit */
}

static const char *decimal_scan_exponent(const char *text, const char *end, int64_t *exponent)
{
    const char *p = text + 1;
    int negative = 0;
    int64_t x = 0;

    /* Without a digit after it the e is no exponent: the number ends before it. */
    if (p < end && (*p == '+' || *p == '-')) negative = *p++ == '-';
    if (p == end || decimal_digit(*p) > 9) return text;
    /* More digits are passed over: the number is 0 or infinite anyway. */
    for (; p < end && decimal_digit(*p) <= 9; p++)
        if (x < INT64_C(100000000000000000)) x = x * 10 + (int64_t)decimal_digit(*p);
    *exponent += negative ? -x : x;
    return p;
}

/* More digits than 64 bits hold: keep the first 19 significant ones. count is of all digits. */
static void decimal_keep_19(decimal_scan *s, int64_t count)
{
    const char *p = s->digits;

    for (; p < s->end && (*p == '0' || *p == '.'); p++) count -= *p == '0';
    if (count <= 19) return;
    s->w = 0;
    for (int32_t n = 0; n < 19; p++)
        if (*p != '.') {
            s->w = s->w * 10 + decimal_digit(*p);
            n++;
        }
    s->exponent += count - 19;
    s->truncated = 1;
}

/* Where the number ends; NULL when there are no digits. */
static const char *decimal_scan_number(const char *p, const char *end, decimal_scan *s)
{
    uint64_t w = 0;
    unsigned d;

    /* May overflow where there are many digits; then the first ones are taken anew. */
    s->digits = p;
    for (; p < end && (d = decimal_digit(*p)) <= 9; p++) w = w * 10 + d;
    int64_t count = p - s->digits;
    s->exponent = 0;
    if (p < end && *p == '.') {
        const char *const fraction = ++p;
        for (; p < end && (d = decimal_digit(*p)) <= 9; p++) w = w * 10 + d;
        s->exponent = fraction - p;
        count += p - fraction;
    }
    if (count == 0) return NULL;
    s->end = p;
    s->w = w;
    s->truncated = 0;
    if (p < end && (*p == 'e' || *p == 'E')) p = decimal_scan_exponent(p, end, &s->exponent);
    if (BVXI_UNLIKELY(count > 19)) decimal_keep_19(s, count);
    return p;
}

/* w * 10^k rounded, w not 0. Where the tables cannot decide, the result is that of a number just below. */
static uint64_t decimal_scale(uint64_t w, int32_t k, const decimal_kind *kind, int *sure)
{
    decimal_power const ten = decimal_power_of_ten(k);
    int32_t const up = decimal_leading_zeros(w);
    int32_t e = ten.exponent - up + 128;
    uint64_t p[3];
    int sticky;

    decimal_mul_wide(ten.high, ten.low, w << up, p);
    /* The product's highest bit is at the top, or one below. */
    if (p[2] >> 63 == 0) {
        p[2] = p[2] << 1 | p[1] >> 63;
        p[1] = p[1] << 1 | p[0] >> 63;
        p[0] <<= 1;
        e--;
    }
    if (ten.exact) sticky = (p[1] | p[0]) != 0;
    else { /* short by less than 3 w, twice that after the shift: below 7 in p[1] with p[0]'s carry */
        sticky = 1;
        if (p[1] > UINT64_MAX - 2 * DECIMAL_ERROR - 1) *sure = 0;
    }

    /* Bits of the number next to (top + a bit more when sticky) times 2^e, top's highest bit set; ties to
     * even. */
    uint64_t const top = p[2];
    /* Where the number's last bit lies: by its own size, or the least that the type has. */
    int32_t const natural = e + 64 - kind->precision;
    int32_t const q = natural > kind->low_exponent ? natural : kind->low_exponent;
    int32_t const cut = q - e;

    if (q > kind->high_exponent) return decimal_infinity(kind);
    if (cut > 64) return 0; /* below half of the smallest */
    uint64_t c = cut == 64 ? 0 : top >> cut;
    uint64_t const half = UINT64_C(1) << (cut - 1);
    uint64_t const rest = cut == 64 ? top : top & ((half << 1) - 1);
    c += rest > half || (rest == half && (sticky || (c & 1)));
    c += (uint64_t)(q - kind->low_exponent) << (kind->precision - 1);
    return c < decimal_infinity(kind) ? c : decimal_infinity(kind);
}

/* The number lies between the one of these bits and the next: compare it with their middle. */
static BVXI_COLD uint64_t decimal_decide(const decimal_scan *s, uint64_t bits, const decimal_kind *kind)
{
    decimal_big d, middle;
    uint64_t c;
    int32_t q, used = 0, more = 0, order;
    int64_t exponent = s->exponent;

    decimal_take_apart(bits, kind, &c, &q);
    if (!s->truncated) {
        decimal_big_set(&d, s->w);
    } else {
        int64_t rest = 0; /* significant digits not taken */
        decimal_big_set(&d, 0);
        for (const char *p = s->digits; p < s->end; p++) {
            if (*p == '.' || (*p == '0' && used == 0)) continue;
            /* As many digits as could decide; of further ones only whether they are zero. */
            if (used < DECIMAL_BIG_DIGITS) {
                decimal_big_mul_add(&d, 10, decimal_digit(*p));
                used++;
            } else {
                more |= *p != '0';
                rest++;
            }
        }
        exponent += rest - (used + rest - 19); /* w's exponent counts all but 19 digits */
        /* A last digit above 0 stands for all that follow. */
        if (more) {
            decimal_big_mul_add(&d, 10, 1);
            exponent--;
        }
    }
    /* The middle of two neighbours: one bit more, at half the exponent. */
    decimal_big_set(&middle, 2 * c + 1);
    order = decimal_big_compare(&d, (int32_t)exponent, &middle, q - 1);
    return bits + (uint64_t)(order > 0 || (order == 0 && (bits & 1)));
}

static uint64_t decimal_to_bits(const decimal_scan *s, const decimal_kind *kind)
{
    int sure = 1;
    if (s->w == 0 || s->exponent < DECIMAL_LEAST) return 0; /* w < 10^19, so below 10^-345 */
    if (s->exponent > 310) return decimal_infinity(kind);
    uint64_t const bits = decimal_scale(s->w, (int32_t)s->exponent, kind, &sure);
    /* Between w and w + 1: where both round alike, the digits that follow decide nothing. */
    if (BVXI_UNLIKELY(s->truncated) && decimal_scale(s->w + 1, (int32_t)s->exponent, kind, &sure) != bits)
        sure = 0;
    return BVXI_LIKELY(sure) || bits == decimal_infinity(kind) ? bits : decimal_decide(s, bits, kind);
}

/* Length of word at text, in any case of letters; 0 when it is not there. */
static size_t decimal_word(const char *text, const char *end, const char *word)
{
    size_t n = 0;
    for (; word[n] != 0; n++)
        if (text + n >= end || (text[n] | 32) != word[n]) return 0;
    return n;
}

/* Sign and digits; 1 when they are a number with bits still to be found, 0
 * when *bits has them (or *used is 0). */
static int decimal_begin(const char *text, const char *end, const decimal_kind *kind, decimal_scan *s,
                         uint64_t *bits, size_t *used)
{
    const char *p = text, *stop;

    *used = 0;
    s->negative = p < end && *p == '-';
    if (p < end && (*p == '-' || *p == '+')) p++;
    stop = decimal_scan_number(p, end, s);
    if (BVXI_LIKELY(stop != NULL)) {
        *used = (size_t)(stop - text);
        return 1;
    }
    size_t n;
    *bits = decimal_infinity(kind);
    if ((n = decimal_word(p, end, "infinity")) == 0 && (n = decimal_word(p, end, "inf")) == 0) {
        *bits += UINT64_C(1) << (kind->precision - 2);
        n = decimal_word(p, end, "nan");
    }
    if (n != 0) *used = n + (size_t)(p - text);
    return 0;
}

/* 1 when *value is s, from exact operands by one rounding. */
static int decimal_short(const decimal_scan *s, double *value)
{
    /* Both operands exact and one rounding: the result is right by definition. */
    if (!DECIMAL_ROUNDS_ONCE || s->truncated) return 0;
    if (s->w > UINT64_C(1) << 53 || s->exponent < -22 || s->exponent > 22) return 0;
    double const w = (double)(int64_t)s->w;
    *value = s->exponent < 0 ? w / decimal_exact_powers[-s->exponent] : w * decimal_exact_powers[s->exponent];
    return 1;
}

size_t bvxi_parse_double(const char *text, const char *end, double *value)
{
    decimal_scan s;
    uint64_t bits;
    size_t used;

    if (decimal_begin(text, end, &decimal_f64, &s, &bits, &used)) {
        double v;
        if (decimal_short(&s, &v)) {
            *value = s.negative ? -v : v;
            return used;
        }
        bits = decimal_to_bits(&s, &decimal_f64);
    }
    if (used == 0) return 0;
    bits |= (uint64_t)(unsigned)s.negative << 63;
    memcpy(value, &bits, sizeof *value);
    return used;
}

size_t bvxi_parse_float(const char *text, const char *end, float *value)
{
    decimal_scan s;
    uint64_t bits;
    size_t used;

    if (decimal_begin(text, end, &decimal_f32, &s, &bits, &used)) {
        double v;
        if (decimal_short(&s, &v)) { /* between 1e-22 and 1e38: a normal float, unless 0 */
            memcpy(&bits, &v, sizeof bits);
            if ((bits & 0x1fffffffu) != 0x10000000u) { /* rounding twice differs from once only at a tie */
                *value = s.negative ? -(float)v : (float)v;
                return used;
            }
        }
        bits = decimal_to_bits(&s, &decimal_f32);
    }
    if (used == 0) return 0;
    uint32_t bits32 = (uint32_t)bits | (uint32_t)s.negative << 31;
    memcpy(value, &bits32, sizeof *value);
    return used;
}

/* ---- Binary numbers to the shortest decimal text, without a locale or a heap ---- */

/* Source: Giulietti. The Schubfach way to render doubles. 2020.
 * With 10^k the largest power of ten not above the distance of two neighbours, the interval that rounds to a
 * number holds a multiple of 10^k, and at most one of 10^(k+1). All comparisons are between values scaled to
 * about 60 bits and rounded to odd, which keeps their order exact; the scaling is by a 128-bit power of ten,
 * and by big integers where that cannot decide.
 * Guarantee: the text reads back to the same bits, no shorter one does, and of those as short it is the
 * closest. */

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
