/* test_polygon.c - polygons cut into triangles, against whole-number oracles.
 *
 * Polygons have whole coordinates in a plane that is laid into space by whole vectors, so areas and senses
 * are known without rounding. A cut is right when it has count - 2 triangles, none turned over, their areas
 * sum up to the polygon's, each side of the polygon belongs to one triangle and every other edge to two that
 * run along it in opposite directions. */
#include "mesh/polygon.h"
#include "tools/fault.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#include <stdint.h>
#include <stdlib.h>

enum { MOST = 1 << 20 };

typedef struct flat {
    int64_t (*p)[2];
    uint32_t n;
} flat;

static bvxi_polygon work;
static flat shape, other;
static double (*space)[3];
static uint32_t *cut, *cut_again;
static uint64_t seed;

void setUp(void)
{
    suite_open(1);
    memset(&work, 0, sizeof work);
    work.ctx = ctx;
    shape.p = malloc(MOST * sizeof *shape.p);
    other.p = malloc(MOST * sizeof *other.p);
    space = malloc(MOST * sizeof *space);
    cut = malloc(MOST * 12);
    cut_again = malloc(MOST * 12);
    shape.n = other.n = 0;
    seed = 20;
}

void tearDown(void)
{
    bvxi_drop(ctx, work.block);
    free(shape.p);
    free(other.p);
    free(space);
    free(cut);
    free(cut_again);
    suite_close();
}

/* ---- oracles ---- */

static void add(flat *s, int64_t x, int64_t y)
{
    TEST_ASSERT_TRUE(s->n < MOST);
    s->p[s->n][0] = x;
    s->p[s->n++][1] = y;
}

static int64_t twice_area(const int64_t *a, const int64_t *b, const int64_t *c)
{
    return (a[0] - c[0]) * (b[1] - c[1]) - (a[1] - c[1]) * (b[0] - c[0]);
}

static int64_t twice_area_of(const flat *s)
{
    int64_t sum = 0;
    for (uint32_t i = 1; i + 1 < s->n; i++) sum += twice_area(s->p[0], s->p[i], s->p[i + 1]);
    return sum;
}

static int same_place(const int64_t *a, const int64_t *b)
{
    return a[0] == b[0] && a[1] == b[1];
}

static int on_segment(const int64_t *a, const int64_t *b, const int64_t *p)
{
    return twice_area(a, b, p) == 0 && (p[0] - a[0]) * (p[0] - b[0]) <= 0 &&
           (p[1] - a[1]) * (p[1] - b[1]) <= 0;
}

static int sign_of(int64_t v)
{
    return (v > 0) - (v < 0);
}

static int segments_meet(const int64_t *a, const int64_t *b, const int64_t *c, const int64_t *d)
{
    if (on_segment(a, b, c) || on_segment(a, b, d) || on_segment(c, d, a) || on_segment(c, d, b)) return 1;
    return sign_of(twice_area(a, b, c)) * sign_of(twice_area(a, b, d)) < 0 &&
           sign_of(twice_area(c, d, a)) * sign_of(twice_area(c, d, b)) < 0;
}

static int is_simple(const flat *s)
{
    for (uint32_t i = 0; i < s->n; i++) {
        const int64_t *const a = s->p[i], *const b = s->p[(i + 1) % s->n];
        if (same_place(a, b)) return 0;
        if (on_segment(a, b, s->p[(i + 2) % s->n])) return 0;
        if (on_segment(b, s->p[(i + 2) % s->n], a)) return 0;
        for (uint32_t k = i + 2; k < s->n && (k + 1) % s->n != i; k++)
            if (segments_meet(a, b, s->p[k], s->p[(k + 1) % s->n])) return 0;
    }
    return 1;
}

static int compare_edges(const void *a, const void *b)
{
    uint64_t const x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

/* Directed edges: each side of the polygon once, all others in pairs. */
static int edges_match(uint32_t n, const uint32_t *t)
{
    uint64_t const edges = (uint64_t)(n - 2) * 3;
    uint64_t *const e = malloc((size_t)edges * 8), *const back = malloc((size_t)edges * 8);
    uint64_t inner = 0, sides = 0, inner_back = 0;
    int good = 1;

    for (uint64_t i = 0; i < edges; i++) {
        uint64_t const a = t[i], b = t[i % 3 == 2 ? i - 2 : i + 1];
        if (b == (a + 1) % n) sides++;
        else e[inner++] = a << 32 | b;
        if (b != (a + 1) % n) back[inner_back++] = b << 32 | a;
    }
    qsort(e, (size_t)inner, 8, compare_edges);
    qsort(back, (size_t)inner, 8, compare_edges);
    for (uint64_t i = 0; i < inner; i++) good &= e[i] == back[i] && (i == 0 || e[i] != e[i - 1]);
    free(e);
    free(back);
    return good && sides == n;
}

static void check_numbers(uint32_t n, const uint32_t *t)
{
    for (uint64_t i = 0; i < (uint64_t)(n - 2) * 3; i++) TEST_ASSERT_TRUE(t[i] < n);
}

/* No turn against the polygon's sense. */
static int is_convex(const flat *s)
{
    int const sense = sign_of(twice_area_of(s));
    for (uint32_t i = 0; i < s->n; i++)
        if (sign_of(twice_area(s->p[i], s->p[(i + 1) % s->n], s->p[(i + 2) % s->n])) * sense < 0) return 0;
    return 1;
}

/* Of a simple polygon no triangle is without area, but for fans of convex ones that have straight corners. */
static void check_cut(const flat *s, const uint32_t *t, int simple)
{
    int64_t const whole = twice_area_of(s);
    int const strict = simple && !is_convex(s);
    int64_t sum = 0;

    check_numbers(s->n, t);
    for (uint32_t i = 0; i < s->n - 2; i++) {
        int64_t const area = twice_area(s->p[t[3 * i]], s->p[t[3 * i + 1]], s->p[t[3 * i + 2]]);
        TEST_ASSERT_TRUE_MESSAGE(whole > 0 ? area >= strict : area <= -strict, "a triangle is turned over");
        sum += area;
    }
    TEST_ASSERT_EQUAL_INT64(whole, sum);
    TEST_ASSERT_TRUE_MESSAGE(edges_match(s->n, t), "edges do not match");
}

/* ---- planes ---- */

static const double planes[][3][3] = {
    {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},        {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}},
    {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}},        {{0, 0, 5}, {0, 1, 0}, {1, 0, 0}},
    {{7, -3, 2}, {1, 2, 3}, {3, 1, -2}},      {{-100, 1, 7}, {1, 0, 1}, {0, 1, 1}},
    {{1, 1, 1}, {2, 0, -2}, {0, 3, -3}},      {{1e6, 1e6, 1e6}, {5, 0, 1}, {-1, 7, 1}},
    {{0, 0, 0}, {1, 0, 1000}, {0, 1, -1000}},
};
enum { PLANES = sizeof planes / sizeof planes[0] };

static void lay_into_space(const flat *s, const double plane[3][3], double scale)
{
    for (uint32_t i = 0; i < s->n; i++)
        for (int a = 0; a < 3; a++)
            space[i][a] = (plane[0][a] + (double)s->p[i][0] * plane[1][a] +
                           (double)s->p[i][1] * plane[2][a]) *
                          scale;
}

static void cut_space(uint32_t n, uint32_t *t)
{
    memset(t, 0xff, (size_t)(n - 2) * 12);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_polygon_cut(&work, (const double(*)[3])space, n, t));
}

static void reverse(flat *s)
{
    for (uint32_t i = 0, k = s->n - 1; i < k; i++, k--)
        for (int a = 0; a < 2; a++) {
            int64_t const v = s->p[i][a];
            s->p[i][a] = s->p[k][a];
            s->p[k][a] = v;
        }
}

/* From another start, with some corners repeated up to three times. */
static void make_other(const flat *s, uint32_t start, int repeats)
{
    other.n = 0;
    for (uint32_t i = 0; i < s->n; i++) {
        const int64_t *const p = s->p[(i + start) % s->n];
        add(&other, p[0], p[1]);
        for (int k = 0; repeats && k < 3 && maker_below(&seed, 4) == 0; k++) add(&other, p[0], p[1]);
    }
}

/* Every way to look at a simple polygon. */
static void check_polygon(const flat *s, int simple)
{
    static const double scales[] = {0x1p960, 0x1p-1060, 0x1p3, 0x1p-300};
    uint32_t const plane = (uint32_t)maker_below(&seed, PLANES);

    lay_into_space(s, planes[plane], 1);
    cut_space(s->n, cut);
    check_cut(s, cut, simple);
    lay_into_space(s, planes[plane], scales[maker_below(&seed, 4)]);
    cut_space(s->n, cut_again);
    TEST_ASSERT_EQUAL_INT(0, memcmp(cut, cut_again, (size_t)(s->n - 2) * 12));
    for (int repeats = 0; repeats < 2; repeats++) {
        make_other(s, (uint32_t)maker_below(&seed, (int32_t)s->n), repeats);
        if (maker_below(&seed, 2) == 0) reverse(&other);
        lay_into_space(&other, planes[maker_below(&seed, PLANES)], 1);
        cut_space(other.n, cut);
        check_cut(&other, cut, simple && !repeats);
    }
}

/* ---- makers of simple polygons ---- */

/* Corners on rays in growing order around the origin. */
static void make_star(uint32_t n, int32_t reach)
{
    int64_t const side = (int64_t)n * 4; /* the rays go through a square of this half side */

    shape.n = 0;
    for (uint32_t i = 0; i < n; i++) {
        int64_t const k = (int64_t)i * 8 * side / n + maker_below(&seed, 32), along = k % (2 * side) - side;
        int64_t const r = 1 + maker_below(&seed, reach);
        switch (k / (2 * side)) {
        case 0: add(&shape, side * r, along * r); break;
        case 1: add(&shape, -along * r, side * r); break;
        case 2: add(&shape, -side * r, -along * r); break;
        default: add(&shape, along * r, -side * r); break;
        }
    }
}

static void make_comb(uint32_t teeth, int32_t height)
{
    shape.n = 0;
    add(&shape, 2 * (int64_t)teeth, -1);
    for (uint32_t i = teeth; i > 0; i--) {
        add(&shape, 2 * (int64_t)i, 0);
        add(&shape, 2 * (int64_t)i - 1, 1 + maker_below(&seed, height));
    }
    add(&shape, 0, 0);
    add(&shape, 0, -1);
}

static void make_spiral(uint32_t arms)
{
    static const int64_t steps[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    int64_t x = 0, y = 0;

    shape.n = 0;
    for (uint32_t i = 0; i < arms; i++) {
        add(&shape, x, y);
        x += steps[i % 4][0] * 4 * (i / 2 + 1);
        y += steps[i % 4][1] * 4 * (i / 2 + 1);
    }
    for (uint32_t i = arms; i-- > 1;) { /* back along the left side, one away */
        const int64_t *const in = steps[(i + 3) % 4], *const out = steps[i % 4];
        add(&shape, shape.p[i][0] - in[1] - out[1], shape.p[i][1] + in[0] + out[0]);
    }
    add(&shape, 1, 1);
    reverse(&shape);
}

/* The border of a random tree of cells, a corner at each of its steps. */
static void make_polyomino(int32_t size, int32_t cells)
{
    static const int32_t steps[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
    int32_t const w = 2 * size + 3;
    uint8_t *const full = calloc((size_t)(w * w), 1);

#define CELL(x, y) full[(y)*w + (x)]
    int32_t x = 1, y = 1, direction = 0;
    CELL(1, 1) = 1;
    int32_t *const have = calloc((size_t)cells, 8), n = 1;
    have[0] = have[1] = 1;
    for (int32_t tries = 0; tries < cells * 50 && n < cells; tries++) {
        int32_t const from = maker_below(&seed, n);
        int32_t const d = maker_below(&seed, 4);
        int32_t const cx = have[2 * from];
        int32_t const cy = have[2 * from + 1];
        int32_t const nx = cx + 2 * steps[d][0], ny = cy + 2 * steps[d][1];
        if (nx < 1 || ny < 1 || nx > 2 * size || ny > 2 * size || CELL(nx, ny)) continue;
        CELL(nx, ny) = CELL(cx + steps[d][0], cy + steps[d][1]) = 1;
        have[2 * n] = nx;
        have[2 * n++ + 1] = ny;
    }
    shape.n = 0;
    do { /* the border with the cells on the left, from corner to corner */
        add(&shape, x, y);
        x += steps[direction][0];
        y += steps[direction][1];
        /* cells round (x, y), left of the ways out */
        int32_t const left[4][2] = {{0, 0}, {-1, 0}, {-1, -1}, {0, -1}};
        int32_t const turn = (direction + 1) % 4;
        int const ahead_left = CELL(x + left[direction][0], y + left[direction][1]);
        int const ahead_right = CELL(x + left[(direction + 3) % 4][0], y + left[(direction + 3) % 4][1]);
        if (!ahead_left) direction = turn;
        else if (ahead_right) direction = (direction + 3) % 4;
    } while (x != 1 || y != 1);
#undef CELL
    free(have);
    free(full);
}

/* Random corners; crossings are taken out by turning parts round. 0 when that did not end. */
static int make_uncrossed(uint32_t n, int32_t size)
{
    shape.n = 0;
    for (uint32_t i = 0; i < n; i++) add(&shape, maker_below(&seed, size), maker_below(&seed, size));
    for (int pass = 0; pass < 300; pass++) {
        int turned = 0;
        for (uint32_t i = 0; i < n; i++)
            for (uint32_t k = i + 2; k < n && (k + 1) % n != i; k++) {
                flat part = {shape.p + i + 1, k - i};
                if (!segments_meet(shape.p[i], shape.p[i + 1], shape.p[k], shape.p[(k + 1) % n])) continue;
                reverse(&part);
                turned = 1;
            }
        if (!turned) break;
    }
    return is_simple(&shape);
}

/* ---- simple polygons ---- */

static void test_cut_convex_polygons_are_fans(void)
{
    static const int64_t square[][2] = {{0, 0}, {4, 0}, {4, 4}, {0, 4}};
    static const int64_t straight[][2] = {{0, 0}, {1, 0}, {4, 0}, {4, 4}, {2, 4}, {2, 4}, {0, 4}, {0, 1}};

    for (int turned = 0; turned < 2; turned++)
        for (uint32_t plane = 0; plane < PLANES; plane++)
            for (int which = 0; which < 2; which++) {
                shape.n = 0;
                for (uint32_t i = 0; i < (which ? 8 : 4); i++)
                    add(&shape, which ? straight[i][0] : square[i][0], which ? straight[i][1] : square[i][1]);
                if (turned) reverse(&shape);
                lay_into_space(&shape, planes[plane], 1);
                cut_space(shape.n, cut);
                check_cut(&shape, cut, 1);
                for (uint32_t i = 0; i + 2 < shape.n; i++) {
                    uint32_t const want[3] = {0, i + 1, i + 2};
                    TEST_ASSERT_EQUAL_UINT32_ARRAY(want, cut + 3 * i, 3);
                }
            }
    TEST_ASSERT_TRUE(work.block_size > 0); /* the second took the long way */
}

/* A dart is cut from its inner corner, wherever it starts. */
static void test_cut_dart(void)
{
    static const int64_t dart[4][2] = {{0, 0}, {4, 2}, {0, 4}, {1, 2}};
    for (uint32_t start = 0; start < 4; start++) {
        shape.n = 0;
        for (uint32_t i = 0; i < 4; i++) add(&shape, dart[(i + start) % 4][0], dart[(i + start) % 4][1]);
        check_polygon(&shape, 1);
    }
}

/* All polygons of up to six of the nine points of a grid, and samples of seven to nine. */
static void test_cut_every_small_polygon(void)
{
    uint32_t simple = 0, all = 0;

    for (uint32_t n = 3; n <= 9; n++) {
        uint32_t total = 1;
        for (uint32_t i = 0; i < n && n <= 6; i++) total *= 9;
        if (n > 6) total = 60000;
        for (uint32_t code = 0; code < total; code++) {
            uint32_t used = 0, rest = code;
            shape.n = 0;
            for (uint32_t i = 0; i < n; i++) {
                uint32_t at = rest % 9;
                rest /= 9;
                if (n > 6) do
                        at = (uint32_t)maker_below(&seed, 9);
                    while (used >> at & 1);
                used |= 1u << at;
                add(&shape, at % 3, at / 3);
            }
            all++;
            lay_into_space(&shape, planes[all % PLANES], 1);
            cut_space(n, cut);
            if (is_simple(&shape)) {
                simple++;
                check_cut(&shape, cut, 1);
            } else {
                check_numbers(n, cut);
            }
        }
    }
    TEST_ASSERT_TRUE(simple > 8000);
}

static void test_cut_random_polygons(void)
{
    uint32_t uncrossed = 0;

    for (int round = 0; round < 300; round++) {
        make_star(8 + (uint32_t)maker_below(&seed, 60), round % 2 == 0 ? 3 : 100);
        check_polygon(&shape, 1);
        make_comb(2 + (uint32_t)maker_below(&seed, 40), round % 2 == 0 ? 2 : 50);
        check_polygon(&shape, 1);
        make_spiral(3 + (uint32_t)maker_below(&seed, 50));
        check_polygon(&shape, 1);
        make_polyomino(2 + maker_below(&seed, 8), 2 + maker_below(&seed, 40));
        TEST_ASSERT_TRUE(is_simple(&shape));
        check_polygon(&shape, 1);
        if (!make_uncrossed(5 + (uint32_t)maker_below(&seed, 30), round % 3 == 0 ? 8 : 1000)) continue;
        check_polygon(&shape, 1);
        uncrossed++;
    }
    TEST_ASSERT_TRUE(uncrossed > 150);
}

static void test_cut_large_polygons(void)
{
    make_comb(50000, 1000);
    check_polygon(&shape, 1);
    make_spiral(50000);
    check_polygon(&shape, 1);
    make_star(100000, 1);
    check_polygon(&shape, 1);
    make_star(30000, 100);
    check_polygon(&shape, 1);
    make_polyomino(150, 20000);
    TEST_ASSERT_TRUE(shape.n > 50000);
    check_polygon(&shape, 1);
}

/* Corners that are nearly on one line, a last bit apart, far from the
 * origin: floating-point turns would be wrong. */
static void test_cut_nearly_straight_polygons(void)
{
    for (int round = 0; round < 2000; round++) {
        int64_t const far = (INT64_C(1) << 51) + maker_below(&seed, 1000);
        uint32_t const n = 5 + (uint32_t)maker_below(&seed, 20);
        int64_t x = 0;
        shape.n = 0;
        for (uint32_t i = 0; i < n; i++) { /* a line y = x with steps of one aside, closed far above */
            x += 1 + maker_below(&seed, 3);
            add(&shape, far + x * 1000, far + x * 1000 + maker_below(&seed, 3));
        }
        add(&shape, far + 1000, far + x * 1000 + 3);
        for (int turned = 0; turned < 2; turned++) {
            for (uint32_t i = 0; i < shape.n; i++) {
                space[i][0] = (double)shape.p[i][0];
                space[i][1] = (double)shape.p[i][1];
                space[i][2] = (double)(round % 3) * (space[i][0] - (double)far);
            }
            cut_space(shape.n, cut);
            for (uint32_t i = 0; i < shape.n; i++) { /* areas of such numbers do not fit */
                other.p[i][0] = shape.p[i][0] - far;
                other.p[i][1] = shape.p[i][1] - far;
            }
            other.n = shape.n;
            check_cut(&other, cut, 1);
            reverse(&shape);
        }
    }
}

static void test_cut_floats_and_extremes(void)
{
    static const double sizes[] = {1e300, 1e-300, 1e308, 5e-324, 1e-160, 1e160, 0.1, 3e38, 1e-45};
    static const int64_t letter[][2] = {{0, 0}, {1, 0}, {1, 1}, {2, 1}, {2, 0}, {3, 0},
                                        {3, 3}, {2, 3}, {2, 2}, {1, 2}, {1, 3}, {0, 3}};

    shape.n = 0;
    for (size_t i = 0; i < sizeof letter / sizeof letter[0]; i++) add(&shape, letter[i][0], letter[i][1]);
    for (size_t k = 0; k < sizeof sizes / sizeof sizes[0]; k++) {
        double const unit = k == 2 ? 1e307 : sizes[k];
        for (uint32_t i = 0; i < shape.n; i++) {
            space[i][0] = (double)shape.p[i][0] * unit;
            space[i][1] = (double)shape.p[i][1] * unit;
            space[i][2] = k % 2 == 0 ? unit : space[i][0];
        }
        cut_space(shape.n, cut);
        check_cut(&shape, cut, 1);
    }
    for (uint32_t i = 0; i < shape.n; i++) { /* singles */
        space[i][0] = (double)((float)shape.p[i][0] * 0.1f);
        space[i][1] = (double)((float)shape.p[i][1] * 0.7f);
        space[i][2] = (double)(-0.3f);
    }
    cut_space(shape.n, cut);
    check_cut(&shape, cut, 1);
    for (uint32_t i = 0; i < shape.n; i++) /* beyond what is promised: numbers all the same */
        for (int a = 0; a < 3; a++) space[i][a] = (i + (uint32_t)a) % 2 == 0 ? 1e300 : 1e-300 * (double)i;
    cut_space(shape.n, cut);
    check_numbers(shape.n, cut);
}

/* A polygon whose projection along one axis is a line goes along another,
 * also when rounding hides its normal. */
static void test_cut_upright_needle(void)
{
    static const int64_t needle[][2] = {{0, 0}, {10, 1}, {20, 1}, {30, 0}, {20, 2}, {10, 2}};

    shape.n = 0;
    for (size_t i = 0; i < 6; i++) add(&shape, needle[i][0], needle[i][1]);
    for (int turned = 0; turned < 2; turned++) {
        for (uint32_t i = 0; i < 6; i++) {
            space[i][0] = 1e15 + (double)shape.p[i][0];
            space[i][1] = 1e15 + (double)(3 * shape.p[i][0]);
            space[i][2] = (double)shape.p[i][1] * 0x1p-60;
        }
        cut_space(6, cut);
        check_cut(&shape, cut, 1);
        reverse(&shape);
    }
}

/* A square with a warp is cut by its projection along the greatest normal component. */
static void test_cut_by_projection(void)
{
    static const double warped[6][3] = {{0, 0, 0}, {4, 0, 1}, {4, 4, 0}, {2, 1, 3}, {1, 1, 0.5}, {0, 4, 1}};
    static const int64_t seen[6][2] = {{0, 0}, {4, 0}, {4, 4}, {2, 1}, {1, 1}, {0, 4}};
    shape.n = 0;
    for (uint32_t i = 0; i < 6; i++) add(&shape, seen[i][0], seen[i][1]);
    memcpy(space, warped, sizeof warped);
    cut_space(6, cut);
    check_cut(&shape, cut, 1);
}

/* ---- polygons that are not simple ---- */

/* Holes in a row, joined to the rim and to each other by bridges that are walked both ways. */
static void test_cut_polygons_with_bridges(void)
{
    for (int64_t holes = 1; holes <= 120; holes += holes < 8 ? 1 : 28)
        for (int turned = 0; turned < 2; turned++) {
            shape.n = 0;
            add(&shape, 0, 0);
            add(&shape, 4 * holes + 1, 0);
            add(&shape, 4 * holes + 1, 6);
            add(&shape, 0, 6);
            add(&shape, 0, 3);
            for (int64_t i = 0; i < holes; i++) {
                add(&shape, 4 * i + 1, 3);
                add(&shape, 4 * i + 2, 4);
                add(&shape, 4 * i + 3, 3);
            }
            for (int64_t i = holes; i-- > 0;) {
                if (i + 1 < holes) add(&shape, 4 * i + 3, 3);
                add(&shape, 4 * i + 2, 2);
                add(&shape, 4 * i + 1, 3);
            }
            add(&shape, 0, 3);
            if (turned) reverse(&shape);
            check_polygon(&shape, 0);
        }
}

/* Two squares that touch in a corner, and a square with a thorn. */
static void test_cut_polygons_that_touch(void)
{
    static const int64_t touching[][2] = {{0, 0}, {1, 0}, {1, 1}, {2, 1}, {2, 2}, {1, 2}, {1, 1}, {0, 1}};
    static const int64_t thorn[][2] = {{0, 0}, {4, 0}, {4, 2}, {6, 2}, {4, 2},
                                       {4, 4}, {0, 4}, {0, 2}, {2, 2}, {0, 2}};

    shape.n = 0;
    for (size_t i = 0; i < 8; i++) add(&shape, touching[i][0], touching[i][1]);
    check_polygon(&shape, 0);
    shape.n = 0;
    for (size_t i = 0; i < 10; i++) add(&shape, thorn[i][0], thorn[i][1]);
    check_polygon(&shape, 0);
}

static void test_cut_takes_anything(void)
{
    static const double places[][3] = {{0, 0, 0},       {1, 0, 0}, {0, 1, 0},    {1, 1, 1},
                                       {-0.0, -0.0, 0}, {2, 2, 2}, {1e300, 0, 1}};

    for (int round = 0; round < 20000; round++) {
        uint32_t const n = 3 + (uint32_t)maker_below(&seed, round % 100 == 0 ? 500 : 12);
        int const few = round % 3;
        for (uint32_t i = 0; i < n; i++)
            for (int a = 0; a < 3; a++)
                space[i][a] = few == 0   ? places[maker_below(&seed, 7)][a]
                              : few == 1 ? (double)maker_below(&seed, 3)
                                         : maker_between(&seed, -1, 1, 1 << 20);
        if (few == 0)
            for (uint32_t i = 0; i < n; i++) memcpy(space[i], places[maker_below(&seed, 7)], sizeof space[i]);
        cut_space(n, cut);
        check_numbers(n, cut);
        TEST_ASSERT_TRUE(edges_match(n, cut));
    }
    for (uint32_t n = 3; n < 9; n++) { /* one place, two places, one line */
        for (int kind = 0; kind < 4; kind++) {
            for (uint32_t i = 0; i < n; i++)
                for (int a = 0; a < 3; a++)
                    space[i][a] = kind == 0   ? 7
                                  : kind == 1 ? (double)(i % 2)
                                  : kind == 2 ? (double)i
                                              : (double)(i / 2 % 2);
            cut_space(n, cut);
            check_numbers(n, cut);
            TEST_ASSERT_TRUE(edges_match(n, cut));
        }
    }
}

/* A million corners at random, at two places, and a star of a million
 * crossing edges: an end comes in bounded time. */
static void test_cut_large_and_not_simple(void)
{
    for (int kind = 0; kind < 4; kind++) {
        for (uint32_t i = 0; i < MOST; i++) {
            space[i][0] = kind == 0   ? maker_between(&seed, 0, 1, 1 << 30)
                          : kind == 1 ? (double)(i % 2)
                                      : (double)(i % 1021);
            space[i][1] = kind == 0   ? maker_between(&seed, 0, 1, 1 << 30)
                          : kind == 3 ? (double)(i % 3)
                                      : (double)(i % 1019);
            space[i][2] = kind == 1 ? (double)(i % 2) : 0;
        }
        cut_space(MOST, cut);
        check_numbers(MOST, cut);
    }
}

/* ---- the exact turn ---- */

enum { DIGITS = 70 };

/* Add or take away a * b * 2^shift in whole numbers. */
static void add_product(uint32_t *sum, int64_t a, int64_t b, int shift)
{
    int const minus = (a < 0) != (b < 0);
    uint64_t const x = (uint64_t)(a < 0 ? -a : a), y = (uint64_t)(b < 0 ? -b : b);

    for (int i = 0; i < 64; i++) { /* bit by bit: slow and plain */
        if (!(x >> i & 1)) continue;
        uint64_t const at = (uint64_t)(shift + i);
        uint32_t part[4] = {0};
        for (uint64_t k = 0; k < 64; k++)
            if (y >> k & 1) part[(at % 32 + k) / 32] |= (uint32_t)1 << (at + k) % 32;
        int64_t carry = 0;
        for (uint64_t d = at / 32, j = 0; d < DIGITS; d++, j++) {
            int64_t const v = (int64_t)sum[d] + (minus ? -1 : 1) * (int64_t)(j < 4 ? part[j] : 0) + carry;
            sum[d] = (uint32_t)(uint64_t)v;
            carry = v < 0 ? -1 : v >> 32;
        }
    }
}

static void test_side_exact(void)
{
    uint32_t zero = 0;

    for (int round = 0; round < 60000; round++) {
        int64_t m[3][2];
        int e[3][2];
        double p[3][2];
        int const wide = round % 3;
        for (int i = 0; i < 3; i++)
            for (int a = 0; a < 2; a++) {
                m[i][a] = (int64_t)(maker_random(&seed) >>
                                    (11 + maker_below(&seed, round % 2 == 0 ? 8 : 53)));
                if (maker_below(&seed, 2) == 0) m[i][a] = -m[i][a];
                e[i][a] = wide == 0 ? 0 : wide == 1 ? maker_below(&seed, 60) : maker_below(&seed, 946);
            }
        if (round % 5 < 2) { /* on a line, or next to it */
            e[0][0] = e[0][1] = e[1][0] = e[1][1] = e[2][0] = e[2][1] = wide == 2 ? 946 : 0;
            for (int a = 0; a < 2; a++) {
                m[0][a] >>= 4;
                m[1][a] >>= 6;
                m[2][a] = m[0][a] + 5 * (m[1][a] - m[0][a]);
                if (round % 5 == 0) m[2][a] += maker_below(&seed, 3) - 1;
            }
        }
        for (int i = 0; i < 3; i++)
            for (int a = 0; a < 2; a++) {
                double scale = 0x1p-500;
                for (int k = 0; k < e[i][a]; k++) scale *= 2;
                p[i][a] = (double)m[i][a] * scale;
            }
        uint32_t sum[DIGITS] = {0};
        for (int i = 0; i < 3; i++) {
            int const k = (i + 1) % 3;
            add_product(sum, m[i][0], m[k][1], e[i][0] + e[k][1]);
            add_product(sum, -m[i][1], m[k][0], e[i][1] + e[k][0]);
        }
        int want = sum[DIGITS - 1] >> 31 ? -1 : 0;
        for (int i = 0; i < DIGITS && want == 0; i++) want = sum[i] != 0;
        zero += want == 0;
        TEST_ASSERT_EQUAL_INT32(want, bvxi_side_exact(p[0], p[1], p[2]));
        double const sign = bvxi_side_quick(p[0][0], p[0][1], p[1][0], p[1][1], p[2][0], p[2][1]);
        TEST_ASSERT_TRUE(sign == 0 || (sign > 0 ? 1 : -1) == want);
    }
    TEST_ASSERT_TRUE(zero > 5000);
}

/* ---- what a caller sees ---- */

static int32_t stop_at(void *user, const char *stage, double fraction)
{
    int *const left = user;
    (void)stage;
    TEST_ASSERT_TRUE(fraction >= 0 && fraction <= 1);
    return --*left < 0;
}

static bvx_status cut_with(uint64_t limit, int *stop, uint64_t *peak)
{
    bvx_context_options o = {.struct_size = sizeof o};
    bvxi_polygon own = {0};
    bvx_status status;

    o.threads = 1;
    o.memory_limit = limit;
    o.progress.call = stop != NULL ? stop_at : NULL;
    o.progress.user = stop;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &own.ctx));
    status = bvxi_polygon_cut(&own, (const double(*)[3])space, shape.n, cut);
    bvxi_drop(own.ctx, own.block);
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(own.ctx));
    *peak = bvx_memory_peak(own.ctx);
    bvx_context_destroy(own.ctx);
    return status;
}

static void test_cut_cancels_and_keeps_to_its_memory(void)
{
    uint64_t peak, limit;
    int stops = 0;

    for (int crossing = 0; crossing < 2; crossing++) {
        make_comb(33000, 1000);
        if (crossing) shape.p[100][1] = -500;
        lay_into_space(&shape, planes[4], 1);
        stops = 0;
        for (bvx_status status = BVX_CANCELLED; status == BVX_CANCELLED; stops += 1 + stops / 4) {
            int left = stops;
            status = cut_with(0, &left, &peak);
            TEST_ASSERT_TRUE(status == BVX_OK || status == BVX_CANCELLED);
        }
        TEST_ASSERT_TRUE(stops > 15);
    }
    make_comb(1000, 50);
    lay_into_space(&shape, planes[4], 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, cut_with(0, NULL, &peak));
    TEST_ASSERT_TRUE(peak <= shape.n * UINT64_C(110));
    limit = peak;
    for (uint64_t less = 1; less < limit; less += limit / 20)
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_BUDGET, cut_with(limit - less, NULL, &peak));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, cut_with(limit, NULL, &peak));
}

/* One polygon is swept, the next is not simple and goes on with the same scratch. */
static bvx_status cut_some(void *user, bvx_context *own_ctx)
{
    static const double bow[4][3] = {{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}};
    bvxi_polygon own = {0};
    bvx_status status;

    (void)user;
    own.ctx = own_ctx;
    status = bvxi_polygon_cut(&own, bow, 4, cut);
    if (status == BVX_OK) status = bvxi_polygon_cut(&own, (const double(*)[3])space, shape.n, cut);
    if (status == BVX_OK) status = bvxi_polygon_cut(&own, bow, 4, cut);
    bvxi_drop(own.ctx, own.block);
    return status;
}

static void test_cut_every_allocation_may_fail(void)
{
    uint64_t allocations = 0;
    make_comb(20, 5);
    lay_into_space(&shape, planes[4], 1);
    TEST_ASSERT_NULL(fault_every_allocation(cut_some, NULL, NULL, &allocations));
    TEST_ASSERT_TRUE(allocations >= 4);
}

static void test_cut_golden(void)
{
    uint64_t hash = 0;

    for (uint32_t n = 8; n < 200; n += 3) {
        make_star(n, 50);
        lay_into_space(&shape, planes[n % PLANES], 1);
        cut_space(shape.n, cut);
        for (uint32_t i = 0; i < 3 * (shape.n - 2); i++) {
            uint8_t const bytes[4] = {(uint8_t)(cut[i] & 255), (uint8_t)(cut[i] >> 8), 0, 0};
            hash = bvx_hash(bytes, 4, hash);
        }
    }
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x018749D32EF58290), hash);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_cut_convex_polygons_are_fans);
    RUN_TEST(test_cut_dart);
    RUN_TEST(test_cut_every_small_polygon);
    RUN_TEST(test_cut_random_polygons);
    RUN_TEST(test_cut_large_polygons);
    RUN_TEST(test_cut_nearly_straight_polygons);
    RUN_TEST(test_cut_floats_and_extremes);
    RUN_TEST(test_cut_upright_needle);
    RUN_TEST(test_cut_by_projection);
    RUN_TEST(test_cut_polygons_with_bridges);
    RUN_TEST(test_cut_polygons_that_touch);
    RUN_TEST(test_cut_takes_anything);
    RUN_TEST(test_cut_large_and_not_simple);
    RUN_TEST(test_side_exact);
    RUN_TEST(test_cut_cancels_and_keeps_to_its_memory);
    RUN_TEST(test_cut_every_allocation_may_fail);
    RUN_TEST(test_cut_golden);
    return UNITY_END();
}
