/* polygon_side.c - on which side of a line a point lies, without any rounding.
 *
 * Source: Dekker. A floating-point technique for extending the available precision. 1971 (products without
 * error).
 *         Shewchuk. Adaptive precision floating-point arithmetic and fast robust geometric predicates. 1997.
 *
 * Where the differences of coordinates are exact, as on whole numbers, two products with their errors are
 * compared. Otherwise the determinant is written as six products of coordinates, and their twelve parts are
 * summed without error.
 * Guarantee: the right sign for coordinates below 2^500 that are multiples of 2^-500: sums and products stay
 * below 2^1023, and every error is a multiple of 2^-1000. Only + - * of doubles rounded to nearest; no
 * contraction. */
#include "mesh/polygon.h"

enum { SIDE_TERMS = 12 };

/* high + low = a + b, high the rounded sum. */
static void side_sum(double a, double b, double *high, double *low)
{
    /* What rounding took off the sum, exactly: Knuth's order of operations works for any two sizes. */
    double const sum = a + b, part = sum - a;
    *low = (a - (sum - part)) + (b - part);
    *high = sum;
}

/* a = high + low, 26 bits each at most. */
static void side_split(double a, double *high, double *low)
{
    double const c = 134217729.0 * a; /* 2^27 + 1 */
    *high = c - (c - a);
    *low = a - *high;
}

static void side_product(double a, double b, double *high, double *low)
{
    double a1, a0, b1, b0;
    double const product = a * b;
    side_split(a, &a1, &a0);
    side_split(b, &b1, &b0);

    /* The product's error as the sum of the halves' products, each of which is exact. */
    *low = a0 * b0 - (((product - a1 * b1) - a0 * b1) - a1 * b0);
    *high = product;
}

/* Add one number to an expansion: parts that do not overlap, from small to large. */
static void side_grow(double *parts, int count, double value)
{
    for (int i = 0; i < count; i++) side_sum(value, parts[i], &value, &parts[i]);
    parts[count] = value;
}

static int32_t side_of_products(const double a[2], const double b[2], const double c[2])
{
    /* The determinant written out in coordinates, which are exact where differences are not. */
    const double factors[6][2] = {{a[0], b[1]},  {-a[1], b[0]}, {b[0], c[1]},
                                  {-b[1], c[0]}, {c[0], a[1]},  {-c[1], a[0]}};
    double parts[SIDE_TERMS] = {0};
    int n = 0;

    for (size_t i = 0; i < 6; i++, n += 2) {
        double high, low;
        side_product(factors[i][0], factors[i][1], &high, &low);
        side_grow(parts, n, low);
        side_grow(parts, n + 1, high);
    }
    /* Parts do not overlap, so the largest one that is not 0 has the sign of the sum. */
    while (n > 0 && parts[n - 1] == 0.0) n--;
    return n == 0 ? 0 : parts[n - 1] > 0.0 ? 1 : -1;
}

int32_t bvxi_side_exact(const double a[2], const double b[2], const double c[2])
{
    double ac[2], bc[2], rest[4], left, left_low, right, right_low;

    /* Exact differences need two products only; that is the case for whole numbers of usual size. */
    for (size_t k = 0; k < 2; k++) {
        side_sum(a[k], -c[k], &ac[k], &rest[k]);
        side_sum(b[k], -c[k], &bc[k], &rest[k + 2]);
    }
    if (rest[0] != 0.0 || rest[1] != 0.0 || rest[2] != 0.0 || rest[3] != 0.0)
        return side_of_products(a, b, c);
    /* rounding keeps order, so the errors decide only between equals */
    side_product(ac[0], bc[1], &left, &left_low);
    side_product(ac[1], bc[0], &right, &right_low);
    if (left != right) return left > right ? 1 : -1;
    return left_low > right_low ? 1 : left_low < right_low ? -1 : 0;
}
