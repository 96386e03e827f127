/* test_section_mend.c - loops that touch or cross are mended: what comes
 * out of known ones, areas of random ones against a count of lines, stacks
 * that need nothing are as ever, and what was refused is refused without. */
#define SECTION_MEND 1
#include "section_support.h"

#include <math.h>

/* ---- help ---- */

static int has_vertex(double x, double y, double z)
{
    const double *const p = mesh.positions;

    for (uint64_t i = 0; i < mesh.vertex_count; i++)
        if (p[3 * i] == x && p[3 * i + 1] == y && p[3 * i + 2] == z) return 1;
    return 0;
}

/* Points as x, y, x, y...; NAN ends a loop, and a second one the list. */
static void two_sections(const double *xy)
{
    stack_clear(&stack);
    for (int k = 0; k < 2; k++) {
        uint32_t const s = stack_section(&stack, k);
        for (const double *p = xy; p[0] == p[0]; p++) {
            stack_loop(&stack, s);
            for (; p[0] == p[0]; p += 2) stack_point(&stack, p[0], p[1]);
        }
    }
}

static void assert_mended(const double *xy, double area, uint64_t loops, uint64_t holes, uint64_t mended)
{
    two_sections(xy);
    o.mend = 0;
    TEST_ASSERT_TRUE(build() != BVX_OK);
    o.mend = 1;
    build_good();
    TEST_ASSERT_TRUE(fabs(certificate.volume - area) < 1e-4 * area);
    TEST_ASSERT_EQUAL_UINT64(2 * loops, report.loops);
    TEST_ASSERT_EQUAL_UINT64(2 * holes, report.holes);
    TEST_ASSERT_EQUAL_UINT64(2 * mended, report.mended_loops);
}

/* ---- known ones ---- */

#define END NAN

static void test_a_keyhole(void)
{
    static const double xy[] = {0, 0, 4, 0, 4, 4, 0, 4, 0, 2, 1, 2,   1,
                                3, 3, 3, 3, 1, 1, 1, 1, 2, 0, 2, END, END};

    assert_mended(xy, 12, 2, 1, 1);
    TEST_ASSERT_TRUE(has_vertex(1, 2, 0) && has_vertex(0, 2, 1)); /* the slit's ends lie on borders */
}

static void test_a_bow_tie(void)
{
    static const double xy[] = {0, 0, 4, 4, 4, 0, 0, 4, END, END};

    assert_mended(xy, 8, 2, 0, 1);
    TEST_ASSERT_TRUE(has_vertex(2, 2, 0));
}

static void test_loops_that_share_a_point(void)
{
    static const double xy[] = {0, 0, 2, 0, 2, 2, 0, 2, END, 2, 2, 4, 2, 4, 4, 2, 4, END, END};

    assert_mended(xy, 8, 2, 0, 2);
}

static void test_loops_that_share_a_border(void)
{
    static const double whole[] = {0, 0, 2, 0, 2, 2, 0, 2, END, 2, 0, 4, 0, 4, 2, 2, 2, END, END};
    static const double in_part[] = {0, 0, 2, 0, 2, 2, 0, 2, END, 2, 0.5, 4, 0.5, 4, 3, 2, 3, END, END};

    assert_mended(whole, 8, 1, 0, 2);
    assert_mended(in_part, 9, 1, 0, 2);
    TEST_ASSERT_TRUE(has_vertex(2, 0.5, 0) && has_vertex(2, 2, 1));
}

static void test_a_point_on_a_side(void)
{
    static const double outside[] = {0, 0, 4, 0, 4, 4, 0, 4, END, 4, 2, 6, 1, 6, 3, END, END};
    static const double inside[] = {0, 0, 4, 0, 4, 4, 0, 4, END, 0, 2, 2, 1, 2, 3, END, END};

    assert_mended(outside, 18, 2, 0, 2);
    assert_mended(inside, 14, 2, 1, 2);
}

static void test_a_hole_in_a_corner(void)
{
    static const double xy[] = {0, 0, 4, 0, 4, 4, 0, 4, END, 0, 0, 2, 1, 1, 2, END, END};

    assert_mended(xy, 14.5, 2, 1, 2);
}

/* Inside is what an odd number of loops enclose: not what both do. */
static void test_loops_that_overlap(void)
{
    static const double xy[] = {0, 0, 2, 0, 2, 2, 0, 2, END, 1, 1, 4, 1, 4, 3, 1, 3, END, END};

    assert_mended(xy, 8, 2, 0, 2);
}

static void test_a_loop_that_is_there_twice(void)
{
    static const double xy[] = {0, 0, 4, 0, 4,   4, 0, 4, END, 0, 0, 0,   4,
                                4, 4, 4, 0, END, 1, 1, 3, 1,   2, 2, END, END};

    assert_mended(xy, 1, 1, 0, 2);
}

static void test_spikes_and_lines(void)
{
    static const double spike[] = {0, 0, 4, 0, 4, 2, 6, 2, 4, 2, 4, 4, 0, 4, END, END};
    static const double line[] = {0, 0,   4, 0, 4, 4, 0, 4, END, 7, 7,   8,
                                  8, END, 5, 5, 6, 6, 7, 6, 6,   6, END, END};

    assert_mended(spike, 16, 1, 0, 1);
    assert_mended(line, 16, 1, 0, 2);
}

static void test_four_leaves_at_one_point(void)
{
    static const double xy[] = {2, 2, 4, 1, 4, 3, 2, 2, 3, 4, 1, 4,   2,
                                2, 0, 3, 0, 1, 2, 2, 1, 0, 3, 0, END, END};

    assert_mended(xy, 8, 4, 0, 1);
}

/* Only what is between its first and last section is left of a body whose loops cancel. */
static void test_nothing_is_left(void)
{
    static const double xy[] = {0, 0, 4, 0, 4, 4, 0, 4, END, 0, 0, 4, 0, 4, 4, 0, 4, END, END};

    two_sections(xy);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, build());
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "nothing remains of the loops"));
    stack.s.loop_count = 2;
    stack.loop[0].point_count = stack.loop[1].point_count = 2;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, build());
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "no loop has three different points"));
}

/* ---- stacks that need nothing ---- */

static void test_good_stacks_keep_their_bytes(void)
{
    uint64_t seed = 9, same = 0;

    for (int i = 0; i < 60; i++) {
        uint64_t hash[2] = {0, 0};
        bvx_status status = BVX_OK;
        stack_random(&stack, &seed);
        o.slabs.grid[0] = o.slabs.grid[1] = i % 2 == 0 ? 0 : 5 + maker_below(&seed, 30);
        for (o.mend = 0; o.mend < 2 && status == BVX_OK; o.mend++) {
            status = build();
            if (status == BVX_OK) TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &mesh, &hash[o.mend]));
        }
        if (status != BVX_OK) continue; /* loops that cross */
        TEST_ASSERT_EQUAL_UINT64(0, report.mended_loops);
        TEST_ASSERT_EQUAL_HEX64(hash[0], hash[1]);
        same++;
    }
    TEST_ASSERT_TRUE(same > 50);
}

/* ---- random ones, against a count of lines ---- */

static int compare_numbers(const void *a, const void *b)
{
    double const x = *(const double *)a, y = *(const double *)b;

    return (x > y) - (x < y);
}

enum { ORACLE_MOST = 4000 };

/* The ends of segment i of the first section's loops. */
static void segment_of(uint64_t i, const double **a, const double **b)
{
    for (uint64_t l = 0; l < stack.s.loop_count; l++) {
        const bvx_section_loop *const loop = &stack.loop[l];
        if (i < loop->first_point || i >= loop->first_point + loop->point_count) continue;
        *a = stack.point + 3 * i;
        *b = stack.point + 3 * (i + 1 == loop->first_point + loop->point_count ? loop->first_point : i + 1);
    }
}

/* Between the heights of points and crossings what is inside is trapezoids:
 * their middle lines times their heights. */
static double odd_area(uint64_t points)
{
    static double height[ORACLE_MOST], at[ORACLE_MOST];
    double area = 0;
    size_t heights = 0;

    for (uint64_t i = 0; i < points; i++) {
        const double *a = NULL, *b = NULL;
        segment_of(i, &a, &b);
        height[heights++] = a[1];
        for (uint64_t j = 0; j < i; j++) {
            const double *c = NULL, *d = NULL;
            double det, t, u;
            segment_of(j, &c, &d);
            det = (b[0] - a[0]) * (d[1] - c[1]) - (b[1] - a[1]) * (d[0] - c[0]);
            if (det == 0) continue;
            t = ((c[0] - a[0]) * (d[1] - c[1]) - (c[1] - a[1]) * (d[0] - c[0])) / det;
            u = ((c[0] - a[0]) * (b[1] - a[1]) - (c[1] - a[1]) * (b[0] - a[0])) / det;
            if (t > 0 && t < 1 && u > 0 && u < 1) height[heights++] = a[1] + t * (b[1] - a[1]);
            TEST_ASSERT_TRUE(heights + 2 < ORACLE_MOST);
        }
    }
    qsort(height, heights, sizeof *height, compare_numbers);
    for (size_t k = 0; k + 1 < heights; k++) {
        double const y = 0.5 * (height[k] + height[k + 1]);
        size_t n = 0;
        for (uint64_t i = 0; i < points; i++) {
            const double *a = NULL, *b = NULL;
            segment_of(i, &a, &b);
            if ((a[1] < y) != (b[1] < y)) at[n++] = a[0] + (y - a[1]) / (b[1] - a[1]) * (b[0] - a[0]);
        }
        qsort(at, n, sizeof *at, compare_numbers);
        for (size_t i = 0; i + 1 < n; i += 2) area += (at[i + 1] - at[i]) * (height[k + 1] - height[k]);
    }
    return area;
}

/* Up to three loops through random points, on whole numbers every second
 * time: these meet in points, on sides and along borders. */
static uint64_t random_loops(uint64_t *seed, int whole)
{
    int const loops = 1 + maker_below(seed, 3), points = 3 + maker_below(seed, 12);
    double xy[3 * 14][2];
    uint64_t first = 0;

    for (int i = 0; i < loops * points; i++)
        for (int k = 0; k < 2; k++)
            xy[i][k] = whole ? maker_below(seed, 7) : maker_between(seed, 0.0, 7.0, 100000);
    stack_clear(&stack);
    for (int k = 0; k < 2; k++) {
        uint32_t const s = stack_section(&stack, k);
        for (int l = 0; l < loops; l++) {
            stack_loop(&stack, s);
            for (int i = 0; i < points; i++)
                stack_point(&stack, xy[l * points + i][0], xy[l * points + i][1]);
        }
        if (k == 0) first = stack.s.point_count;
    }
    return first;
}

static void test_random_loops_keep_what_is_inside(void)
{
    uint64_t seed = 21, mended = 0, refused = 0, empty = 0, cancelled = 0;
    int const all = quick ? 60 : getenv("BITVOX_LARGE") != NULL ? 1500 : 600;

    for (int i = 0; i < all; i++) {
        uint64_t const points = random_loops(&seed, i & 1);
        double const area = odd_area(points);
        bvx_status const status = build();
        if (status == BVX_ERR_EMPTY) empty++;
        else if (status == BVX_ERR_FORMAT) refused++;
        else {
            build_good();
            mended += report.mended_loops != 0;
            cancelled += report.points < stack.s.point_count;
            /* sections alike: what is between them is a prism, but where
             * the grid's cells are too coarse for the contours */
            TEST_ASSERT_TRUE(fabs(report.prismoid_volume - area) < 1e-5 * (1.0 + area));
        }
    }
    if (all < 600) return;
    TEST_ASSERT_TRUE(mended * 15 > (uint64_t)all * 13 && refused * 100 <= (uint64_t)all);
    TEST_ASSERT_TRUE(cancelled > 1 && empty * 40 < (uint64_t)all);
}

/* The second plane turned by a hair, so that both cross beyond all loops. */
static void turn_second_section(void)
{
    static double normals[6] = {0, 0, 1, -0.02, 0, 1};

    for (uint64_t l = 0; l < stack.s.loop_count; l++)
        for (uint64_t p = 0; p < stack.loop[l].point_count && stack.loop[l].section == 1; p++) {
            double *const at = stack.point + 3 * (stack.loop[l].first_point + p);
            at[2] += 0.02 * at[0];
        }
    stack.s.normals = normals;
    stack.position[1] /= sqrt(1.0 + 0.02 * 0.02);
}

static void test_planes_of_any_direction(void)
{
    static const double touching[] = {0, 0, 2, 0, 2, 2, 0, 2, NAN, 2, 2, 4, 2, 4, 4, 2, 4, END, END};
    uint64_t seed = 5, mended = 0, refused = 0;
    int const all = quick ? 6 : 20;

    two_sections(touching);
    turn_second_section();
    o.cells = 8;
    o.mend = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, build());
    TEST_ASSERT_EQUAL_INT32(BVX_REASON_LOOPS_MEET, bvx_last_error(ctx)->reason);
    o.mend = 1;
    build_good();
    TEST_ASSERT_EQUAL_UINT64(4, report.mended_loops);
    TEST_ASSERT_TRUE(has_vertex(0, 0, 0) && has_vertex(2, 2, 0) && has_vertex(4, 4, 1.08));

    for (int i = 0; i < all; i++) {
        (void)random_loops(&seed, i & 1);
        turn_second_section();
        if (build() == BVX_OK) {
            build_good();
            mended += report.mended_loops != 0;
        } else {
            refused += bvx_last_error(ctx)->status != BVX_ERR_EMPTY;
        }
    }
    stack.s.normals = NULL;
    TEST_ASSERT_TRUE(mended * 10 > (uint64_t)all * 8 && refused * 20 <= (uint64_t)all);
}

/* One loop of many points: thousands of crossings, on whole numbers dozens of segments through one point. */
static void test_large_tangles(void)
{
    static const int32_t sizes[4] = {80, 120, 160, 200};
    int const all = quick ? 4 : getenv("BITVOX_LARGE") != NULL ? 40 : 12; /* each size and side */
    uint64_t seed = 77, refused = 0;

    for (int i = 0; i < all; i++) {
        int32_t const points = sizes[i % 4], side = i / 4 % 3 == 0 ? 0 : i / 4 % 3 == 1 ? 8 : 41;
        bvx_status status;

        stack_clear(&stack);
        for (int k = 0; k < 2; k++) {
            uint64_t same = seed + (uint64_t)i;
            uint32_t const s = stack_section(&stack, k);
            stack_loop(&stack, s);
            for (int32_t n = 0; n < points; n++) {
                double const x = side != 0 ? maker_below(&same, side)
                                           : maker_between(&same, 0.0, 7.0, 100000);
                double const y = side != 0 ? maker_below(&same, side)
                                           : maker_between(&same, 0.0, 7.0, 100000);
                stack_point(&stack, x, y);
            }
        }
        status = build();
        TEST_ASSERT_TRUE(status == BVX_OK || status == BVX_ERR_FORMAT);
        refused += status != BVX_OK;
        if (status == BVX_OK) build_good();
    }
    /* Caps of thousands of corners with holes on hair lines are what is not cut always. */
    TEST_ASSERT_TRUE(refused * 4 <= (uint64_t)all);
}

static void test_threads_change_nothing(void)
{
    uint64_t seed = 4, hash[2] = {0, 0};

    for (int i = 0; i < 10; i++) {
        (void)random_loops(&seed, i & 1);
        for (int32_t k = 0; k < 2; k++) {
            bvx_context *const first = ctx;
            bvx_context_options c = {.struct_size = sizeof c};
            c.threads = 1 + 3 * k;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &ctx));
            hash[k] = 0;
            if (build() == BVX_OK) TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &mesh, &hash[k]));
            bvx_mesh_free(ctx, &mesh);
            bvx_context_destroy(ctx);
            ctx = first;
        }
        TEST_ASSERT_EQUAL_HEX64(hash[0], hash[1]);
    }
}

static void test_mend_is_yes_or_no(void)
{
    static const double xy[] = {0, 0, 4, 0, 4, 4, 0, 4, END, END};

    two_sections(xy);
    o.mend = 2;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, build());
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "mend is 2"));
}

/* A tangle of some hundred points on a raster, in two sections. */
static void crowded_tangle(uint64_t seed)
{
    int const most = 2 + maker_below(&seed, 3);
    int raster = 8;

    if (maker_below(&seed, 2) == 0) raster = maker_below(&seed, 2) != 0 ? 64 : 1000;
    stack_clear(&stack);
    for (int k = 0; k < 2; k++) {
        uint32_t const section = stack_section(&stack, k);
        int const loops = 1 + maker_below(&seed, most);
        for (int l = 0; l < loops; l++) {
            int const points = 20 + maker_below(&seed, 80);
            stack_loop(&stack, section);
            for (int p = 0; p < points; p++) {
                double const x = maker_between(&seed, 0, 4, raster), y = maker_between(&seed, 0, 4, raster);
                stack_point(&stack, x, y);
            }
        }
    }
    o.slabs.grid[0] = o.slabs.grid[1] = 2 + maker_below(&seed, 20);
    o.slabs.depth = maker_below(&seed, 6);
    if (o.slabs.depth == 0) o.slabs.depth = BVX_NONE;
}

/* Tangles whose mended loops lie so close that the mesh would not be manifold: it is looked at, and not handed out. */
static void test_what_mending_leaves_torn_is_refused(void)
{
    static const uint64_t seed[] = {UINT64_C(15846870007357310575), UINT64_C(13315834234385289623)};

    for (size_t i = 0; i < sizeof seed / sizeof *seed; i++) {
        crowded_tangle(seed[i]);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, build());
        if (strstr(bvx_last_message(ctx), "the mended loops run too near to each other") == NULL)
            TEST_FAIL_MESSAGE(bvx_last_message(ctx));
        TEST_ASSERT_NULL(mesh.positions);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_keyhole);
    RUN_TEST(test_a_bow_tie);
    RUN_TEST(test_loops_that_share_a_point);
    RUN_TEST(test_loops_that_share_a_border);
    RUN_TEST(test_a_point_on_a_side);
    RUN_TEST(test_a_hole_in_a_corner);
    RUN_TEST(test_loops_that_overlap);
    RUN_TEST(test_a_loop_that_is_there_twice);
    RUN_TEST(test_spikes_and_lines);
    RUN_TEST(test_four_leaves_at_one_point);
    RUN_TEST(test_nothing_is_left);
    RUN_TEST(test_good_stacks_keep_their_bytes);
    RUN_TEST(test_random_loops_keep_what_is_inside);
    RUN_TEST(test_planes_of_any_direction);
    RUN_TEST(test_large_tangles);
    RUN_TEST(test_threads_change_nothing);
    RUN_TEST(test_what_mending_leaves_torn_is_refused);
    RUN_TEST(test_mend_is_yes_or_no);
    return UNITY_END();
}
