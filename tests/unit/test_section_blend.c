/* test_section_blend.c - the cubic blend: what it is between four values, held against the textbook's form; and
 * bodies made with it: contour points kept, straight sides straight, a ball nearer than by straight lines, sound
 * whatever the sections are. */
#include "layers/section_field.h"
#include "section_support.h"

#include <math.h>

static uint64_t blend_seed;

/* ---- four values ---- */

static double between(double low, double high)
{
    return maker_between(&blend_seed, low, high, 1 << 20);
}

/* The slope at a section, as Fritsch and Butland have it, from the neighbours' positions and values; at an end
 * by three points. Written apart from the library's: positions, not widths. */
static double textbook_slope(const double x[], const double y[], int n, int i)
{
    double const left = i > 0 ? (y[i] - y[i - 1]) / (x[i] - x[i - 1]) : 0.0;
    double const right = i + 1 < n ? (y[i + 1] - y[i]) / (x[i + 1] - x[i]) : 0.0;
    double a, b, edge, slope;

    if (n == 2) return i == 0 ? right : left;
    if (i > 0 && i + 1 < n) {
        a = x[i] - x[i - 1];
        b = x[i + 1] - x[i];
        return left * right <= 0.0 ? 0.0 : 3.0 * (a + b) / ((2.0 * b + a) / left + (b + 2.0 * a) / right);
    }
    edge = i == 0 ? right : left;
    a = i == 0 ? x[1] - x[0] : x[i] - x[i - 1];
    b = i == 0 ? x[2] - x[1] : x[i - 1] - x[i - 2];
    slope = i == 0 ? (y[2] - y[1]) / b : (y[i - 1] - y[i - 2]) / b;
    double const found = ((2.0 * a + b) * edge - a * slope) / (a + b);
    if (found * edge <= 0.0) return 0.0;
    return edge * slope < 0.0 && fabs(found) > 3.0 * fabs(edge) ? 3.0 * edge : found;
}

static double textbook(const double x[], const double y[], int n, int i, double t)
{
    double const h = x[i + 1] - x[i], s = 1.0 - t;

    return (1.0 + 2.0 * t) * s * s * y[i] + t * s * s * h * textbook_slope(x, y, n, i) +
           t * t * (3.0 - 2.0 * t) * y[i + 1] - t * t * s * h * textbook_slope(x, y, n, i + 1);
}

static void test_value_is_the_textbooks(void)
{
    blend_seed = 5;
    for (int round = 0; round < 4000; round++) {
        int const below = round & 1, above = round >> 1 & 1, n = 2 + below + above;
        double const widths[3] = {between(0.1, 3.0), between(0.1, 3.0), between(0.1, 3.0)};
        bvxi_blend const b = {widths[1], below ? widths[0] : 0.0, above ? widths[2] : 0.0};
        double value[BVXI_BLEND_SECTIONS], x[4], y[4];
        int count = 0;

        for (int i = 0; i < BVXI_BLEND_SECTIONS; i++) value[i] = between(-2.0, 2.0);
        if (below) {
            x[count] = -widths[0];
            y[count++] = value[BVXI_BLEND_FAR_BELOW];
        }
        x[count] = 0.0;
        y[count++] = value[BVXI_BLEND_BELOW];
        x[count] = widths[1];
        y[count++] = value[BVXI_BLEND_ABOVE];
        if (above) {
            x[count] = widths[1] + widths[2];
            y[count++] = value[BVXI_BLEND_FAR_ABOVE];
        }
        for (int i = 0; i <= 16; i++)
            TEST_ASSERT_DOUBLE_WITHIN(1e-12, textbook(x, y, n, below, i / 16.0),
                                      bvxi_blend_value(&b, value, i / 16.0));
    }
}

static void test_value_is_exact_on_sections_and_monotone_between(void)
{
    blend_seed = 6;
    for (int round = 0; round < 4000; round++) {
        bvxi_blend const b = {between(0.1, 3.0), between(0.1, 3.0), between(0.1, 3.0)};
        double value[BVXI_BLEND_SECTIONS], last, rise;

        for (int i = 0; i < BVXI_BLEND_SECTIONS; i++) value[i] = between(-2.0, 2.0);
        TEST_ASSERT_TRUE(bvxi_blend_value(&b, value, 0.0) == value[BVXI_BLEND_BELOW]);
        TEST_ASSERT_TRUE(bvxi_blend_value(&b, value, 1.0) == value[BVXI_BLEND_ABOVE]);
        rise = value[BVXI_BLEND_ABOVE] > value[BVXI_BLEND_BELOW] ? 1.0 : -1.0;
        last = value[BVXI_BLEND_BELOW];
        for (int i = 1; i <= 64; i++) {
            double const now = bvxi_blend_value(&b, value, i / 64.0);
            TEST_ASSERT_TRUE(rise * (now - last) > -1e-14);
            last = now;
        }
    }
}

static void test_zero_is_where_the_value_is(void)
{
    blend_seed = 7;
    for (int round = 0; round < 20000; round++) {
        double const tiny = round % 5 == 0 ? 1e-9 : 1.0;
        bvxi_blend const b = {between(0.1, 3.0), round & 1 ? between(0.01, 9.0) : 0.0,
                              round & 2 ? between(0.01, 9.0) : 0.0};
        double const sign = round & 4 ? 1.0 : -1.0;
        double value[BVXI_BLEND_SECTIONS], t;

        value[BVXI_BLEND_BELOW] = sign * tiny * between(0.001, 2.0);
        value[BVXI_BLEND_ABOVE] = -sign * between(0.001, 2.0);
        value[BVXI_BLEND_FAR_BELOW] = between(-2.0, 2.0);
        value[BVXI_BLEND_FAR_ABOVE] = between(-2.0, 2.0);
        t = bvxi_blend_zero(&b, value);
        TEST_ASSERT_TRUE(t >= 0.0 && t <= 1.0);
        TEST_ASSERT_TRUE(sign * bvxi_blend_value(&b, value, t - 1e-9) >= -1e-14);
        TEST_ASSERT_TRUE(sign * bvxi_blend_value(&b, value, t + 1e-9) <= 1e-14);
    }
}

/* ---- bodies ---- */

static uint64_t body_hash(void)
{
    uint64_t mark = 0;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &mesh, &mark));
    return mark;
}

static uint64_t crossing_pairs(void)
{
    uint64_t count = 0;
    bvx_mesh_view view;

    bvx_mesh_view_of(&mesh, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_crossings(ctx, &view, &count, NULL, 0));
    return count;
}

/* Sections of a ball of radius 5; uneven: every second one moved. */
static void make_ball(int count, double uneven)
{
    stack_clear(&stack);
    for (int i = 0; i < count; i++) {
        double const z = -4.0 + 8.0 * i / (count - 1) + (i & 1 ? uneven : 0.0), r = sqrt(25.0 - z * z);
        stack_round(&stack, stack_section(&stack, z), 0, 0, r, r, 180, 0, 0, 0);
    }
}

/* How far the vertices lie off the ball, in the mean, away from the flat ends. */
static double ball_error(void)
{
    const double *const p = mesh.positions;
    double sum = 0.0;
    uint64_t n = 0;

    for (uint64_t i = 0; i < mesh.vertex_count; i++) {
        const double *const v = p + 3 * i;
        double const r = sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
        if (v[2] < -3.9 || v[2] > 3.9) continue;
        sum += fabs(r - 5.0);
        n++;
    }
    return sum / (double)n;
}

/* The paper's way is straight from section to section. */
static void test_ball_is_nearer(void)
{
    for (int uneven = 0; uneven < 2; uneven++) {
        make_ball(9, 0.3 * uneven);
        o.spacing = 0.2;
        o.slabs.crossings = BVX_CROSSINGS_PAPER;
        build_good();
        double const straight = ball_error();
        o.slabs.crossings = BVX_CROSSINGS_EXACT;
        build_good();
        assert_points_kept();
        TEST_ASSERT_EQUAL_UINT64(0, crossing_pairs());
        TEST_ASSERT_TRUE(ball_error() < 0.5 * straight);
    }
}

/* A box with one leaning side: signed distances are linear from section to section there, and stay so. */
static void test_straight_sides_stay_straight(void)
{
    static const double position[] = {0, 1, 1.5, 4, 5};

    for (size_t i = 0; i < sizeof position / sizeof *position; i++) {
        stack_loop(&stack, stack_section(&stack, position[i]));
        stack_point(&stack, 0, 0);
        stack_point(&stack, 20 + position[i], 0);
        stack_point(&stack, 20 + position[i], 20);
        stack_point(&stack, 0, 20);
    }
    o.slabs.grid[0] = 83;
    o.slabs.grid[1] = 40;
    build_good();
    assert_points_kept();
    for (uint64_t i = 0; i < mesh.vertex_count; i++) {
        const double *const v = (const double *)mesh.positions + 3 * i;
        if (v[0] > 20.001 && v[1] > 6 && v[1] < 14 && v[2] > 0.001 && v[2] < 4.999)
            TEST_ASSERT_DOUBLE_WITHIN(6e-4, 20 + v[2], v[0]); /* kept so far off corners of cells */
    }
}

/* Cubic from five sections on, and straight in the paper's way and by marching cubes. */
static void test_the_number_of_sections_decides(void)
{
    for (int sections = 3; sections <= 7; sections++)
        for (int32_t crossings = BVX_CROSSINGS_EXACT; crossings <= BVX_CROSSINGS_CLASSIC; crossings++) {
            bvx_sections_options taken = {.struct_size = sizeof taken, .label = BVX_LABEL_ZERO};
            bvxi_stack s;

            uint64_t const mark = bvxi_scratch_begin(ctx);
            make_ball(sections, 0.0);
            taken.slabs.crossings = crossings;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_stack_open(ctx, "test", &stack.s, &taken, &s));
            TEST_ASSERT_EQUAL_INT(sections >= 5 && crossings == BVX_CROSSINGS_EXACT, s.cubic);
            (void)bvxi_scratch_end(ctx, mark, BVX_OK);
        }
}

static void test_turning_a_stack_over_turns_the_body(void)
{
    double first;

    make_ball(6, 0.25);
    build_good();
    first = certificate.volume;
    for (uint64_t i = 0; i < stack.s.section_count; i++) stack.position[i] = -stack.position[i];
    for (uint64_t i = 0; i < stack.s.point_count; i++) stack.point[3 * i + 2] = -stack.point[3 * i + 2];
    build_good();
    TEST_ASSERT_DOUBLE_WITHIN(1e-9 * first, first, certificate.volume);
}

/* A wall that leans by more than its thickness keeps no window and crosses nothing. */
static void test_walls_keep_no_windows(void)
{
    for (int k = 0; k < 6; k++) {
        uint32_t const s = stack_section(&stack, k);
        stack_round(&stack, s, 0.1 * k * k, 0, 4, 4, 64, 0, 0, 0);
        stack_round(&stack, s, 0.1 * k * k, 0, 3.7, 3.7, 64, 0, 0, 0);
    }
    build_good();
    TEST_ASSERT_EQUAL_INT64(0, certificate.euler);
    TEST_ASSERT_EQUAL_UINT64(0, report.joined_slabs + crossing_pairs());
    assert_points_kept();
}

/* Levels that a cubic blend would make cross are blended linearly, and at once where these cross too. */
static void test_thin_walls_do_not_cross(void)
{
    stack_clear(&stack);
    for (int k = 0; k < 5; k++) {
        uint32_t const s = stack_section(&stack, 0.5 * k);
        stack_round(&stack, s, 0.4 * k, 0.3 * (k & 1), 2, 2, 24, 0, 0, 0);
        stack_round(&stack, s, 0.4 * k, 0.3 * (k & 1), 1.98, 1.98, 24, 0, 0, 0);
    }
    o.slabs.grid[0] = 7;
    o.slabs.grid[1] = 5;
    build_good();
    assert_points_kept();
    TEST_ASSERT_EQUAL_UINT64(0, crossing_pairs());
}

static void test_random_stacks_are_sound(void)
{
    uint64_t seed = 99;

    for (int round = 0; round < 300; round++) {
        uint64_t one;
        stack_random(&stack, &seed);
        o.caps = round % 2 == 0 ? BVX_CAPS_FLAT : BVX_CAPS_TAPER;
        o.slabs.crossings = round % 5 == 4 ? BVX_CROSSINGS_PAPER : BVX_CROSSINGS_EXACT;
        o.slabs.depth = round % 3 == 0 ? BVX_NONE : 5;
        if (build() == BVX_ERR_FORMAT || build() == BVX_ERR_EMPTY) continue;
        build_good();
        if (o.slabs.crossings == BVX_CROSSINGS_EXACT) assert_points_kept();
        one = body_hash();
        build_good();
        TEST_ASSERT_EQUAL_HEX64(one, body_hash());
    }
}

static void test_threads_change_nothing(void)
{
    bvx_context *const first = ctx;
    bvx_context_options c = {.struct_size = sizeof c};
    uint64_t one;

    make_ball(40, 0.02);
    o.slabs.grid[0] = o.slabs.grid[1] = 300;
    build_good();
    one = body_hash();
    bvx_mesh_free(ctx, &mesh);
    c.threads = 4;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &ctx));
    build_good();
    TEST_ASSERT_EQUAL_HEX64(one, body_hash());
    bvx_mesh_free(ctx, &mesh);
    bvx_context_destroy(ctx);
    ctx = first;
}

static void test_few_cells_are_refused(void)
{
    make_ball(3, 0.0);
    o.cells = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, build());
    o.cells = 0;
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_value_is_the_textbooks);
    RUN_TEST(test_value_is_exact_on_sections_and_monotone_between);
    RUN_TEST(test_zero_is_where_the_value_is);
    RUN_TEST(test_ball_is_nearer);
    RUN_TEST(test_straight_sides_stay_straight);
    RUN_TEST(test_the_number_of_sections_decides);
    RUN_TEST(test_turning_a_stack_over_turns_the_body);
    RUN_TEST(test_walls_keep_no_windows);
    RUN_TEST(test_thin_walls_do_not_cross);
    RUN_TEST(test_random_stacks_are_sound);
    RUN_TEST(test_threads_change_nothing);
    RUN_TEST(test_few_cells_are_refused);
    return UNITY_END();
}
