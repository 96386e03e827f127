/* orient.c - the signs of orient.h in whole numbers.
 *
 * A determinant is linear in each of its columns, so the coordinates along each axis may have a unit of their
 * own: the lowest binary digit that any of them has. In these units they are whole numbers, their differences
 * too, and the sign of a sum of products of differences is that of what is added less that of what is
 * subtracted, both kept as numbers without a sign, of as many limbs as their range needs.
 *
 * Bits: a finite double is a multiple of 2^-1074 below 2^1024, so it has at most 2098 binary digits, a
 * difference 2099 (66 limbs of 32), a product of three 6297, and six of them 6300 (3 * 66 + 1 limbs). */
#include "mesh/orient.h"

enum { ORIENT_LIMBS = 66, ORIENT_SUM_LIMBS = 3 * ORIENT_LIMBS + 1 };

/* mantissa * 2^exponent; odd, or 0 */
typedef struct orient_double {
    int64_t mantissa;
    int32_t exponent;
} orient_double;

/* What the points have along an axis: differences to the last point, as whole numbers of one unit. */
typedef struct orient_axis {
    orient_double value[4];
    int32_t low, bits; /* of the unit 2^low the values have at most so many binary digits */
} orient_axis;

typedef struct orient_number {
    int32_t sign;                /* 1 or -1; of 0 either */
    int32_t count;               /* of limbs */
    uint32_t limb[ORIENT_LIMBS]; /* lowest first */
} orient_number;

/* ---- Taking doubles apart ---- */

static orient_double orient_take_apart(double x)
{
    orient_double r = {0, 0};
    uint64_t bits, m;

    memcpy(&bits, &x, sizeof bits);

    /* The hidden leading digit belongs to all but subnormal numbers. */
    int32_t const field = (int32_t)(bits >> 52 & 2047);
    m = bits & ((UINT64_C(1) << 52) - 1);
    if (field != 0) m |= UINT64_C(1) << 52;
    if (m == 0) return r;

    /* A subnormal number (field 0) has the exponent of field 1, without the leading digit. The lowest digit that is
     * set is exact as a double, and its index the exponent. */
    double const lowest = (double)(int64_t)(m & (0 - m));
    uint64_t digits;
    memcpy(&digits, &lowest, sizeof digits);
    int32_t const zeros = (int32_t)(digits >> 52) - 1023;
    r.mantissa = (int64_t)(m >> zeros);
    if (bits >> 63 != 0) r.mantissa = -r.mantissa;
    r.exponent = (field != 0 ? field : 1) - 1075 + zeros;
    return r;
}

static void orient_open_axis(const double *const points[], int count, int k, orient_axis *axis)
{
    int32_t low = INT32_MAX, high = INT32_MIN;
    /* The unit of the axis is the lowest digit of any value; the bits reach from there to the highest. */
    for (int i = 0; i < count; i++) {
        orient_double const v = axis->value[i] = orient_take_apart(points[i][k]);
        /* Digits of a mantissa, which is below 2^53. */
        double const size = (double)(v.mantissa < 0 ? -v.mantissa : v.mantissa);
        uint64_t bits;
        memcpy(&bits, &size, sizeof bits);
        int32_t const top = v.exponent + (int32_t)(bits >> 52) - 1022;
        if (v.mantissa == 0) continue;
        low = v.exponent < low ? v.exponent : low;
        high = top > high ? top : high;
    }
    axis->low = low <= high ? low : 0;
    axis->bits = low <= high ? high - low : 0;
}

/* Write the size of a value into zeroed limbs. */
static void orient_place(const orient_double *v, int32_t low, uint32_t *limb)
{
    uint64_t const m = (uint64_t)(v->mantissa < 0 ? -v->mantissa : v->mantissa);
    int32_t const shift = v->exponent - low, first = shift / 32, part = shift % 32;
    if (m == 0) return;
    /* 53 digits, moved by less than 32, lie in at most three limbs, only where digits reach. */
    limb[first] = (uint32_t)(m << part);
    if (m << part >> 32 != 0) limb[first + 1] = (uint32_t)(m << part >> 32);
    if (part != 0 && m >> (64 - part) != 0) limb[first + 2] = (uint32_t)(m >> (64 - part));
}

/* -1, 0 or 1 as a is less than, equal to or greater than b. */
static int orient_compare(const uint32_t *a, const uint32_t *b, int32_t count)
{
    for (int32_t i = count; i-- > 0;)
        if (a[i] != b[i]) return a[i] > b[i] ? 1 : -1;
    return 0;
}

/* Values of equal sign are subtracted, the smaller from the larger, others added. */
static void orient_difference(const orient_axis *axis, int i, int last, orient_number *r)
{
    const orient_double *const a = &axis->value[i], *const b = &axis->value[last];
    int const add = (a->mantissa < 0) != (b->mantissa < 0);
    uint32_t first[ORIENT_LIMBS], second[ORIENT_LIMBS];
    const uint32_t *larger = first, *smaller = second;
    uint64_t carry = 0;

    r->count = axis->bits / 32 + 1; /* one digit more than the values have */
    memset(first, 0, (size_t)r->count * sizeof *first);
    memset(second, 0, (size_t)r->count * sizeof *second);
    orient_place(a, axis->low, first);
    orient_place(b, axis->low, second);

    /* The sign is that of a - b, before sizes are compared. */
    r->sign = a->mantissa < 0 || (a->mantissa == 0 && b->mantissa > 0) ? -1 : 1;
    if (!add && orient_compare(first, second, r->count) < 0) {
        larger = second;
        smaller = first;
        r->sign = b->mantissa < 0 ? 1 : -1;
    }

    /* A borrow is what the upper half holds after going below 0: all ones. */
    for (int32_t k = 0; k < r->count; k++) {
        carry = add ? carry + larger[k] + smaller[k] : (uint64_t)larger[k] - smaller[k] - carry;
        r->limb[k] = (uint32_t)carry;
        carry = add ? carry >> 32 : carry >> 63;
    }
}

/* sum += a * b, of limbs; sum holds the result. */
static void orient_add_product(uint32_t *sum, const uint32_t *a, int32_t a_count, const uint32_t *b,
                               int32_t b_count)
{
    for (int32_t i = 0; i < a_count; i++) {
        uint64_t carry = 0;

        /* Many limbs are 0 where few digits are set. */
        if (a[i] == 0) continue;
        for (int32_t k = 0; k < b_count; k++) { /* at most (2^32 - 1)^2 + 2 (2^32 - 1) = 2^64 - 1 */
            carry += (uint64_t)a[i] * b[k] + sum[i + k];
            sum[i + k] = (uint32_t)carry;
            carry >>= 32;
        }

        /* The carry may run on over limbs that are already set. */
        for (int32_t k = i + b_count; carry != 0; k++) {
            carry += sum[k];
            sum[k] = (uint32_t)carry;
            carry >>= 32;
        }
    }
}

/* What is added and what is subtracted. */
typedef struct orient_sums {
    uint32_t plus[ORIENT_SUM_LIMBS], minus[ORIENT_SUM_LIMBS];
    int32_t count; /* limbs in use */
} orient_sums;

static void orient_sums_open(orient_sums *s, int32_t count)
{
    s->count = count;
    memset(s->plus, 0, (size_t)count * sizeof *s->plus);
    memset(s->minus, 0, (size_t)count * sizeof *s->minus);
}

/* Add sign * a * b * c; c may be NULL, which stands for 1. */
static void orient_sums_add(orient_sums *s, int32_t sign, const orient_number *a, const orient_number *b,
                            const orient_number *c)
{
    static const uint32_t one[1] = {1};
    uint32_t two[2 * ORIENT_LIMBS];
    int32_t const count = a->count + b->count;
    memset(two, 0, (size_t)count * sizeof *two);
    orient_add_product(two, a->limb, a->count, b->limb, b->count);
    sign *= a->sign * b->sign * (c != NULL ? c->sign : 1);
    orient_add_product(sign > 0 ? s->plus : s->minus, c != NULL ? c->limb : one, c != NULL ? c->count : 1,
                       two, count);
}

/* ---- Signs ---- */

int bvxi_orient_exact(const double a[3], const double b[3], const double c[3], const double d[3])
{
    const double *const points[4] = {a, b, c, d};
    orient_axis axis;
    orient_number from_d[3][3]; /* of each axis, of each point */
    orient_sums sums;

    /* Facets along the axes are common, and need no digits. */
    for (int k = 0; k < 3; k++)
        if (a[k] == d[k] && b[k] == d[k] && c[k] == d[k]) return 0;

    for (int k = 0; k < 3; k++) {
        orient_open_axis(points, 4, k, &axis);
        for (int i = 0; i < 3; i++) orient_difference(&axis, i, 3, &from_d[k][i]);
    }
    orient_sums_open(&sums, from_d[0][0].count + from_d[1][0].count + from_d[2][0].count + 1);
    for (int i = 0; i < 3; i++) {
        int const k = (i + 1) % 3, l = (i + 2) % 3;
        orient_sums_add(&sums, 1, &from_d[0][i], &from_d[1][k], &from_d[2][l]);
        orient_sums_add(&sums, -1, &from_d[0][i], &from_d[1][l], &from_d[2][k]);
    }
    return orient_compare(sums.plus, sums.minus, sums.count);
}

int bvxi_orient_flat_exact(const double a[3], const double b[3], const double c[3], int axis)
{
    const double *const points[3] = {a, b, c};
    orient_axis along;
    orient_number d[2][2];
    orient_sums sums;

    /* The two axes that remain, the next one first, so that left stays left: two vectors and two products. */
    for (int k = 0; k < 2; k++) {
        orient_open_axis(points, 3, (axis + 1 + k) % 3, &along);
        for (int i = 0; i < 2; i++) orient_difference(&along, i, 2, &d[k][i]);
    }
    orient_sums_open(&sums, d[0][0].count + d[1][0].count + 1);
    orient_sums_add(&sums, 1, &d[0][0], &d[1][1], NULL);
    orient_sums_add(&sums, -1, &d[1][0], &d[0][1], NULL);
    return orient_compare(sums.plus, sums.minus, sums.count);
}
