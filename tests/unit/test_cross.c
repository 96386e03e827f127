/* test_cross.c - signs of orient.h against whole numbers, crossing triangles against the points that they
 * have in common.
 *
 * The oracle of triangles finds all corners of the common part (corners of one in the other, edges through
 * faces, edges across edges) as fractions, and looks whether one is outside what is shared. That part is
 * convex, and so is a shared corner or edge, so there is such a corner or none. It knows no planes' sides and
 * no projections. */
#include "mesh/cross.h"
#include "tools/crossing_oracle.h"
#include "tools/mesh_maker.h"
#include "unity.h"

static uint64_t seed;

void setUp(void)
{
    seed = 20;
}

void tearDown(void)
{
}

/* ---- Signs ---- */

/* Sign of det(a - d, b - d, c - d) in whole numbers: the volume (b - a) x
 * (c - a) . (d - a) has the other one. */
static int whole_sign(int64_t q[4][3])
{
    return -crossing_volume(q[0], q[1], q[2], q[3]);
}

static void to_doubles(int64_t q[4][3], double p[4][3])
{
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) p[i][k] = (double)q[i][k];
}

/* All orders of the points, with and without the filter. */
static void expect_sign(int expected, double p[4][3])
{
    static const int order[6][4] = {{0, 1, 2, 3}, {1, 2, 0, 3}, {1, 0, 2, 3},
                                    {3, 0, 1, 2}, {0, 3, 2, 1}, {2, 3, 0, 1}};
    static const int sign[6] = {1, 1, -1, -1, -1, 1};

    for (int i = 0; i < 6; i++) {
        const double *const a = p[order[i][0]];
        const double *const b = p[order[i][1]];
        const double *const c = p[order[i][2]];
        const double *const d = p[order[i][3]];
        TEST_ASSERT_EQUAL_INT(expected * sign[i], bvxi_orient(a, b, c, d));
        TEST_ASSERT_EQUAL_INT(expected * sign[i], bvxi_orient_exact(a, b, c, d));
    }
}

static void test_orient_says_which_side(void)
{
    double p[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25, 0.25, -1}};

    expect_sign(1, p); /* below a triangle that is seen from above */
    p[3][2] = 1;
    expect_sign(-1, p);
    p[3][2] = 0;
    expect_sign(0, p);
    TEST_ASSERT_EQUAL_INT(1, bvxi_orient_flat(p[0], p[1], p[2], 2));
    TEST_ASSERT_EQUAL_INT(-1, bvxi_orient_flat(p[1], p[0], p[2], 2));
    TEST_ASSERT_EQUAL_INT(0, bvxi_orient_flat(p[0], p[1], p[2], 0));
}

/* d is a point near the plane of a, b, c, rounded to a whole number: the naive sign is often wrong there. */
static void test_orient_is_exact_near_planes(void)
{
    int wrong = 0;

    for (int n = 0; n < 20000; n++) {
        int32_t const digits = 5 + maker_below(&seed, 47);
        int64_t const size = INT64_C(1) << digits;
        int64_t q[4][3];
        double p[4][3], u[3][3], naive;
        double const s = maker_between(&seed, 0, 1, 16), t = maker_between(&seed, 0, 1, 16);
        for (int i = 0; i < 3; i++) /* multiples of 16: many points are on the plane exactly */
            for (int k = 0; k < 3; k++)
                q[i][k] = ((int64_t)(maker_random(&seed) % (uint64_t)size) - size / 2) / 16 * 16 + n % 2;
        for (int k = 0; k < 3; k++)
            q[3][k] = q[0][k] + (int64_t)(s * (double)(q[1][k] - q[0][k])) +
                      (int64_t)(t * (double)(q[2][k] - q[0][k]));
        to_doubles(q, p);
        expect_sign(whole_sign(q), p);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) u[i][k] = p[i][k] - p[3][k];
        naive = u[0][0] * (u[1][1] * u[2][2] - u[1][2] * u[2][1]) +
                u[0][1] * (u[1][2] * u[2][0] - u[1][0] * u[2][2]) +
                u[0][2] * (u[1][0] * u[2][1] - u[1][1] * u[2][0]);
        wrong += (naive > 0) - (naive < 0) != whole_sign(q);
        for (int axis = 0; axis < 3; axis++) {
            int const flat = crossing_area(q[0], q[1], q[2], axis);
            TEST_ASSERT_EQUAL_INT(flat, bvxi_orient_flat(p[0], p[1], p[2], axis));
            TEST_ASSERT_EQUAL_INT(flat, bvxi_orient_flat_exact(p[0], p[1], p[2], axis));
            TEST_ASSERT_EQUAL_INT(-flat, bvxi_orient_flat_exact(p[0], p[2], p[1], axis));
            TEST_ASSERT_EQUAL_INT(crossing_area(q[0], q[1], q[3], axis),
                                  bvxi_orient_flat(p[0], p[1], p[3], axis));
        }
    }
    TEST_ASSERT_GREATER_THAN_INT(1000, wrong);
}

static double times_power(double x, int power)
{
    for (; power > 0; power--) x *= 2.0;
    for (; power < 0; power++) x *= 0.5;
    return x;
}

/* With d at the origin each row and each column may be multiplied by a
 * power of two of its own, as far as doubles go. */
static void test_orient_is_exact_for_all_exponents(void)
{
    for (int n = 0; n < 20000; n++) {
        int64_t q[4][3] = {{0}};
        double p[4][3] = {{0}};
        int row[3], column[3];
        for (int i = 0; i < 3; i++) {
            row[i] = maker_below(&seed, 1000) - 500;
            column[i] = maker_below(&seed, 1000) - 500;
            for (int k = 0; k < 3; k++)
                q[i][k] = maker_below(&seed, 5) == 0 ? 0 : maker_below(&seed, 2001) - 1000;
        }
        if (n % 3 == 0) /* one plane, or nearly */
            for (int k = 0; k < 3; k++) q[2][k] = 3 * q[0][k] - 2 * q[1][k] + (n % 2 == 0 && k == 0);
        for (int i = 0; i < 3; i++)
            for (int k = 0; k < 3; k++) p[i][k] = times_power((double)q[i][k], row[i] + column[k]);
        expect_sign(whole_sign(q), p);
        for (int axis = 0; axis < 3; axis++)
            TEST_ASSERT_EQUAL_INT(crossing_area(q[0], q[1], q[3], axis),
                                  bvxi_orient_flat(p[0], p[1], p[3], axis));
    }
}

static void test_orient_at_the_ends_of_doubles(void)
{
    double const most = 1.7976931348623157e308, least = times_power(1.0, -1074);
    double p[4][3] = {{most, -most, most}, {-most, most, -most}, {-most, -most, most}, {most, most, least}};
    /* least is next to nothing, and no sign turns on it */
    int64_t q[4][3] = {{2, -2, 2}, {-2, 2, -2}, {-2, -2, 2}, {2, 2, 0}};
    expect_sign(whole_sign(q), p);
    for (int i = 0; i < 4; i++)
        for (int k = 0; k < 3; k++) p[i][k] = (double)q[i][k] * least;
    expect_sign(whole_sign(q), p);

    /* One step of the smallest doubles off a plane through the largest. */
    for (int k = 0; k < 3; k++) {
        p[0][k] = k == 0 ? most : 0.0;
        p[1][k] = k == 1 ? most : 0.0;
        p[2][k] = k == 2 ? 0.0 : -most;
        p[3][k] = k == 2 ? -least : 0.0;
    }
    expect_sign(1, p);
    p[3][2] = least;
    expect_sign(-1, p);
    p[3][2] = -0.0;
    expect_sign(0, p);

    /* A product that vanishes, and then meets a large factor. */
    double const tiny = times_power(1.0, -600), large = times_power(1.0, 1000);
    double const v[4][3] = {{tiny, 0, 0}, {0, tiny, 0}, {0, 0, large}, {0, 0, 0}};
    memcpy(p, v, sizeof p);
    expect_sign(1, p);
}

/* ---- Triangles: the oracle ---- */

/* x / w, y / w, z / w with w > 0 */
typedef struct point {
    int64_t x[3], w;
} point;

static void cross_product(const int64_t a[3], const int64_t b[3], int64_t n[3])
{
    for (int k = 0; k < 3; k++) n[k] = a[(k + 1) % 3] * b[(k + 2) % 3] - a[(k + 2) % 3] * b[(k + 1) % 3];
}

static int64_t dot(const int64_t a[3], const int64_t b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static void minus(const int64_t a[3], const int64_t b[3], int64_t r[3])
{
    for (int k = 0; k < 3; k++) r[k] = a[k] - b[k];
}

static int is_zero(const int64_t a[3])
{
    return a[0] == 0 && a[1] == 0 && a[2] == 0;
}

/* w * (p - a) */
static void from(const point *p, const int64_t a[3], int64_t r[3])
{
    for (int k = 0; k < 3; k++) r[k] = p->x[k] - p->w * a[k];
}

static int on_segment(const point *p, const int64_t a[3], const int64_t b[3])
{
    int64_t along[3], to[3], n[3], part;
    minus(b, a, along);
    from(p, a, to);
    cross_product(along, to, n);
    part = dot(along, to); /* w times the part of the length's square */
    return is_zero(n) && (is_zero(along) ? is_zero(to) : part >= 0 && part <= p->w * dot(along, along));
}

static void normal_of(const int64_t *const t[3], int64_t n[3])
{
    int64_t u[3], v[3];
    minus(t[1], t[0], u);
    minus(t[2], t[0], v);
    cross_product(u, v, n);
}

static int in_triangle(const point *p, const int64_t *const t[3])
{
    int64_t n[3], to[3], edge[3], m[3];

    normal_of(t, n);
    if (is_zero(n))
        return on_segment(p, t[0], t[1]) || on_segment(p, t[1], t[2]) || on_segment(p, t[2], t[0]);
    from(p, t[0], to);
    if (dot(n, to) != 0) return 0;
    for (int i = 0; i < 3; i++) {
        minus(t[(i + 1) % 3], t[i], edge);
        from(p, t[i], to);
        cross_product(edge, to, m);
        if (dot(m, n) < 0) return 0;
    }
    return 1;
}

/* a + (b - a) * over / under */
static point along(const int64_t a[3], const int64_t b[3], int64_t over, int64_t under)
{
    point p;

    if (under < 0) {
        under = -under;
        over = -over;
    }
    for (int k = 0; k < 3; k++) p.x[k] = a[k] * under + (b[k] - a[k]) * over;
    p.w = under;
    return p;
}

static int is_shared(const point *p, const int64_t *const s[3], const int64_t *const t[3])
{
    const int64_t *common[9];
    int count = 0;

    for (int i = 0; i < 3; i++)
        for (int k = 0; k < 3; k++)
            if (s[i] == t[k]) common[count++] = s[i];
    for (int i = 0; i < count; i++)
        for (int k = 0; k < count; k++)
            if (on_segment(p, common[i], common[k])) return 1;
    return 0;
}

static int oracle_tries(const point *p, const int64_t *const s[3], const int64_t *const t[3])
{
    return in_triangle(p, s) && in_triangle(p, t) && !is_shared(p, s, t);
}

static int oracle_one_way(const int64_t *const s[3], const int64_t *const t[3])
{
    int64_t n[3], edge[3], other[3], between[3], m[3], k[3];
    point p;

    normal_of(t, n);
    for (int i = 0; i < 3; i++) {
        const int64_t *const a = s[i], *const b = s[(i + 1) % 3];
        p = along(a, b, 0, 1);
        if (oracle_tries(&p, s, t)) return 1;
        minus(b, a, edge);
        minus(t[0], a, between);
        if (dot(n, edge) != 0) {
            p = along(a, b, dot(n, between), dot(n, edge));
            if (oracle_tries(&p, s, t)) return 1;
        }
        /* where lines of edges meet; one that is skew gives a point that is not in t */
        for (int j = 0; j < 3; j++) {
            minus(t[(j + 1) % 3], t[j], other);
            minus(t[j], a, between);
            cross_product(edge, other, m);
            if (is_zero(m)) continue;
            cross_product(between, other, k);
            p = along(a, b, dot(k, m), dot(m, m));
            if (oracle_tries(&p, s, t)) return 1;
        }
    }
    return 0;
}

static int oracle_cross(const int64_t *const s[3], const int64_t *const t[3])
{
    int64_t n[3];
    int same = 1;
    for (int i = 0; i < 3; i++) same = same && (s[i] == t[0] || s[i] == t[1] || s[i] == t[2]);
    for (int i = 0; i < 3; i++) same = same && (t[i] == s[0] || t[i] == s[1] || t[i] == s[2]);
    normal_of(s, n);
    /* what is common reaches inside the triangle's edges, none of its corners does */
    if (same) return !is_zero(n);
    return oracle_one_way(s, t) || oracle_one_way(t, s);
}

/* ---- Triangles: the tests ---- */

typedef struct places {
    int64_t whole[6][3];
    double real[6][3];
} places;

static int cross_of(const places *p, const int s[3], const int t[3], int orders)
{
    static const int order[6][3] = {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {2, 1, 0}, {1, 0, 2}, {0, 2, 1}};
    const int64_t *const ws[3] = {p->whole[s[0]], p->whole[s[1]], p->whole[s[2]]};
    const int64_t *const wt[3] = {p->whole[t[0]], p->whole[t[1]], p->whole[t[2]]};
    int const expected = oracle_cross(ws, wt);

    for (int i = 0; i < orders; i++)
        for (int k = 0; k < orders; k++) {
            const double *const a[3] = {p->real[s[order[i][0]]], p->real[s[order[i][1]]],
                                        p->real[s[order[i][2]]]};
            const double *const b[3] = {p->real[t[order[k][0]]], p->real[t[order[k][1]]],
                                        p->real[t[order[k][2]]]};
            if (bvxi_triangles_cross(a, b) != expected || bvxi_triangles_cross(b, a) != expected ||
                bvxi_triangles_cross_exact(a, b) != expected) {
                char text[400];
                snprintf(
                    text, sizeof text,
                    "expected %d of %d %d %d and %d %d %d among %g %g %g, %g %g %g, %g %g %g, %g %g %g, %g %g %g, %g %g %g",
                    expected, s[0], s[1], s[2], t[0], t[1], t[2], p->real[0][0], p->real[0][1], p->real[0][2],
                    p->real[1][0], p->real[1][1], p->real[1][2], p->real[2][0], p->real[2][1], p->real[2][2],
                    p->real[3][0], p->real[3][1], p->real[3][2], p->real[4][0], p->real[4][1], p->real[4][2],
                    p->real[5][0], p->real[5][1], p->real[5][2]);
                TEST_FAIL_MESSAGE(text);
            }
        }
    return expected;
}

/* Different corners have different positions; range 2: -1, 0 and 1. flat: all in one plane, or on one
 * line. */
static void scatter(places *p, int range, int flat)
{
    for (int i = 0; i < 6; i++) {
        int again;
        do {
            again = 0;
            for (int k = 0; k < 3; k++) p->whole[i][k] = maker_below(&seed, 2 * range - 1) - range + 1;
            if (flat > 0) p->whole[i][2] = p->whole[i][0] - 2 * p->whole[i][1];
            if (flat > 1) p->whole[i][1] = 3 - p->whole[i][0];
            if (flat > 1) p->whole[i][2] = 2 * p->whole[i][0];
            for (int k = 0; k < i; k++)
                again = again || memcmp(p->whole[i], p->whole[k], sizeof p->whole[i]) == 0;
        } while (again);
        for (int k = 0; k < 3; k++) p->real[i][k] = (double)p->whole[i][k];
    }
}

static void try_many(int range, int flat, int count)
{
    static const int s[3] = {0, 1, 2};
    static const int t[][3] = {{3, 4, 5}, {0, 3, 4}, {0, 1, 3}, {0, 1, 2}, {0, 0, 3},
                               {3, 3, 3}, {0, 0, 0}, {0, 1, 1}, {3, 3, 4}, {4, 2, 5}};
    static const int again[3] = {0, 0, 1};
    int met[10] = {0};
    places p;

    for (int n = 0; n < count; n++) {
        scatter(&p, range, flat);
        for (int i = 0; i < 10; i++) met[i] += cross_of(&p, s, t[i], n % 8 == 0 ? 6 : 2);
        cross_of(&p, again, t[n % 10], 6);
    }
    TEST_ASSERT_TRUE(met[0] > 0 && met[0] < count);
    TEST_ASSERT_TRUE(met[1] > 0 && met[1] < count);
    TEST_ASSERT_TRUE(met[2] > 0 && met[2] < count);
    TEST_ASSERT_EQUAL_INT(0, met[6] + met[7]); /* a shared corner or edge only */
}

static void test_cross_matches_the_common_part(void)
{
    try_many(2, 0, 600);
    try_many(3, 0, 600);
    try_many(6, 0, 600);
}

static void test_cross_in_a_plane_and_on_a_line(void)
{
    try_many(3, 1, 600);
    try_many(6, 1, 600);
    try_many(6, 2, 300);
}

/* Whole numbers of 50 digits: the last corner lies on or next to an edge or the face of the first
 * triangle. */
static void test_cross_next_to_touching(void)
{
    int met = 0, count = 20000;

    for (int n = 0; n < count; n++) {
        int64_t q[6][3];
        double p[6][3];
        int const common = maker_below(&seed, 2);
        int32_t const half = maker_below(&seed, 2) * 512, off = maker_below(&seed, 3) - 1;
        for (int i = 0; i < 6; i++)
            for (int k = 0; k < 3; k++) q[i][k] = (int64_t)(maker_random(&seed) >> 14) / 1024 * 1024;
        /* a part of one, so on an edge, or half of that and half of the third corner */
        for (int k = 0; k < 3; k++) {
            int64_t const edge = q[0][k] / 1024 * 700 + q[1][k] / 1024 * 324;
            q[5][k] = edge * (1024 - half) / 1024 + q[2][k] / 1024 * half;
            if (k == 1) q[5][k] += off;
        }
        for (int i = 0; i < 6; i++)
            for (int k = 0; k < 3; k++) p[i][k] = (double)q[i][k];
        const int64_t *const s[3] = {q[0], q[1], q[2]}, *const t[3] = {common ? q[2] : q[3], q[4], q[5]};
        const double *const a[3] = {p[0], p[1], p[2]}, *const b[3] = {common ? p[2] : p[3], p[4], p[5]};
        int const expected = crossing_pair(s, t);
        TEST_ASSERT_EQUAL_INT(expected, bvxi_triangles_cross(a, b));
        TEST_ASSERT_EQUAL_INT(expected, bvxi_triangles_cross(b, a));
        met += expected;
    }
    TEST_ASSERT_TRUE(met > count / 10 && met < count * 9 / 10);
}

static void test_cross_by_hand(void)
{
    double const p[8][3] = {{0, 0, 0}, {4, 0, 0}, {0, 4, 0}, {1, 1, 0},
                            {1, 1, 5}, {9, 9, 5}, {4, 4, 0}, {2, 2, 0}};
    const double *const floor[3] = {p[0], p[1], p[2]};
    const double *const on_face[3] = {p[3], p[4], p[5]}, *const beside[3] = {p[1], p[6], p[2]};
    const double *const folded[3] = {p[0], p[3], p[1]}, *const on_edge[3] = {p[7], p[4], p[5]};
    const double *const wall[3] = {p[0], p[4], p[1]}, *const pierced[3] = {p[0], p[4], p[5]};

    TEST_ASSERT_EQUAL_INT(1, bvxi_triangles_cross(floor, on_face)); /* a corner on the face */
    TEST_ASSERT_EQUAL_INT(1, bvxi_triangles_cross(floor, on_edge)); /* a corner on an edge */
    TEST_ASSERT_EQUAL_INT(0, bvxi_triangles_cross(floor, beside));  /* neighbours in a plane */
    TEST_ASSERT_EQUAL_INT(1, bvxi_triangles_cross(floor, folded));  /* a fold that lies flat */
    TEST_ASSERT_EQUAL_INT(0, bvxi_triangles_cross(floor, wall));    /* neighbours at an angle */
    TEST_ASSERT_EQUAL_INT(0, bvxi_triangles_cross(floor, pierced)); /* a corner only */
    TEST_ASSERT_EQUAL_INT(1, bvxi_triangles_cross(floor, floor));
    TEST_ASSERT_EQUAL_INT(1, bvxi_has_area(floor));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_orient_says_which_side);
    RUN_TEST(test_orient_is_exact_near_planes);
    RUN_TEST(test_orient_is_exact_for_all_exponents);
    RUN_TEST(test_orient_at_the_ends_of_doubles);
    RUN_TEST(test_cross_by_hand);
    RUN_TEST(test_cross_matches_the_common_part);
    RUN_TEST(test_cross_in_a_plane_and_on_a_line);
    RUN_TEST(test_cross_next_to_touching);
    return UNITY_END();
}
