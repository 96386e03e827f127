/* test_section_parts.c - what bodies from sections stand on: inside tests of
 * grid points and of corners of subdivided cells against a count of exact
 * crossings, distances against all segments, rings, loops that touch, caps. */
#include "layers/trace.h"
#include "tools/section_maker.h"
#include "suite.h"

#include <math.h>

static section_maker made;
static bvx_sections_options o;
static bvxi_stack stack;

void setUp(void)
{
    suite_open(0);
    /* As the library takes them: rooms of it are called here. */
    o = (bvx_sections_options){
        .struct_size = sizeof o, .slabs = {.depth = 5}, .position_type = BVX_F64, .label = BVX_LABEL_ZERO};
    stack_clear(&made);
}

void tearDown(void)
{
    suite_close();
}

/* An odd number of segments to the right of a place that is moved by (e_u, e_v),
 * e_u >> e_v > 0. Its numbers are even, those of points odd, so no height of a
 * point is met; a place on a segment lies to the right of it once it is moved. */
static int oracle_inside(const bvxi_plane *p, int32_t u, int32_t v)
{
    int odd = 0;

    for (uint32_t i = 0; i < p->point_count; i++) {
        const int32_t *const a = p->q[i], *const b = p->q[p->next[i]];
        int64_t dx, dy, s;
        if ((a[1] < v) == (b[1] < v)) continue;
        dx = (int64_t)b[0] - a[0];
        dy = (int64_t)b[1] - a[1];
        s = dx * ((int64_t)v - a[1]) - dy * ((int64_t)u - a[0]);
        odd ^= dy > 0 ? s > 0 : s < 0;
    }
    return odd;
}

/* Stacks leave their scratch to the call around them. */
static void close_stack(void)
{
    (void)bvxi_scratch_end(ctx, 0, BVX_OK);
    memset(&stack, 0, sizeof stack);
}

static int open_random(uint64_t *seed, int round_to)
{
    stack_random(&made, seed);
    if (round_to != 0)
        for (uint64_t i = 0; i < made.s.point_count; i++)
            for (uint64_t k = 0; k < 2; k++)
                made.point[3 * i + k] = floor(made.point[3 * i + k] * round_to + 0.5) / round_to;
    o.slabs.grid[0] = 2 + maker_below(seed, 40);
    o.slabs.grid[1] = 2 + maker_below(seed, 90);
    o.slabs.depth = maker_below(seed, 9);
    o.label = 1;
    if (bvxi_stack_open(ctx, "test", &made.s, &o, &stack) == BVX_OK) return 1;
    return 0;
}

/* Its scratch stays when it fails, as a public call ends then. */
static int plane_is_simple(bvxi_plane *p)
{
    uint64_t const mark = bvxi_scratch_begin(ctx);
    return bvxi_scratch_end(ctx, mark, bvxi_plane_check_simple(&stack, p)) == BVX_OK;
}

static void test_grid_points_against_exact_crossings(void)
{
    uint64_t seed = 5, tested = 0, inside = 0;

    for (int i = 0; i < 300; i++) {
        if (open_random(&seed, i % 3 == 0 ? 16 : 0))
            for (uint32_t k = 0; k < stack.plane_count; k++)
                for (int32_t y = 0; y <= stack.size[1]; y++)
                    for (int32_t x = 0; x <= stack.size[0]; x++, tested++) {
                        int const is = bvxi_grid_bit(&stack, &stack.plane[k], x, y);
                        inside += (uint64_t)is;
                        if (is != oracle_inside(&stack.plane[k], x << stack.fine, y << stack.fine))
                            TEST_FAIL_MESSAGE("a grid point is on the other side");
                    }
        close_stack();
    }
    TEST_ASSERT_TRUE(tested > 300000 && inside > tested / 20);
}

/* Lines that go exactly through contour segments' meetings with other lines: fixed point is set by hand. */
static void test_segments_through_grid_points(void)
{
    /* slopes of 1 and -1 over even places */
    static const int32_t corner[4][2] = {{3, 1}, {13, 11}, {9, 15}, {1, 7}};
    uint64_t hits = 0;

    stack_loop(&made, stack_section(&made, 0.0));
    stack_loop(&made, stack_section(&made, 1.0));
    for (uint32_t k = 0; k < 2; k++) {
        made.loop[k].first_point = 4 * k;
        for (int i = 0; i < 4; i++) {
            memcpy(made.point + 3 * made.s.point_count, (double[3]){corner[i][0], corner[i][1], k}, 24);
            made.s.point_count++;
        }
        made.loop[k].point_count = 4;
    }
    o.slabs.grid[0] = o.slabs.grid[1] = 8;
    o.label = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_stack_open(ctx, "test", &made.s, &o, &stack));
    for (int32_t scale = 0; scale < 3; scale++) {
        bvxi_plane *const p = &stack.plane[0];
        bvxi_plane fresh = *p;
        bvxi_line_cut cuts[200];
        bvxi_arc arcs[200], loose_arcs[200];
        bvxi_ring_arc ring_arcs[200];
        uint32_t cells[200], asking[200], loose_cells[200], order[2][200], start[9];
        bvxi_arc_scratch const scratch = {loose_arcs, loose_cells, {order[0], order[1]}, start};
        uint64_t bits[9 * 2], cut_count, arc_count;
        memset(bits, 0, sizeof bits);
        for (int i = 0; i < 4; i++) /* grid lines are even */
            for (int a = 0; a < 2; a++)
                p->q[i][a] = (int32_t)((uint32_t)corner[i][a] << (stack.fine - 1)) + 1;
        fresh.arc = arcs;
        fresh.ring_arc = ring_arcs;
        fresh.arc_cell = cells;
        fresh.asking = asking;
        fresh.cut = cuts;
        fresh.cut_room = 200;
        fresh.arc_count = fresh.cut_count = fresh.asking_count = 0;
        fresh.inside = bits;
        for (int i = 0; i < 4; i++) /* even and odd places of the diagonals against the lines */
            p->q[i][0] += 2 * scale;
        bvxi_plane_count_cuts(&stack, &fresh, &cut_count, &arc_count);
        TEST_ASSERT_TRUE(cut_count <= 200);
        bvxi_plane_cut(&stack, &fresh, &scratch);
        TEST_ASSERT_EQUAL_UINT64(cut_count, fresh.cut_count);
        TEST_ASSERT_EQUAL_UINT64(arc_count, fresh.arc_count);
        for (int32_t y = 0; y <= 8; y++)
            for (int32_t x = 0; x <= 8; x++) {
                fresh.inside = bits;
                TEST_ASSERT_EQUAL_INT(oracle_inside(p, x << stack.fine, y << stack.fine),
                                      bvxi_grid_bit(&stack, &fresh, x, y));
                for (int i = 0; i < 4; i++) {
                    const int32_t *const a = p->q[i], *const b = p->q[p->next[i]];
                    int64_t const s = ((int64_t)b[0] - a[0]) * (((int64_t)y << stack.fine) - a[1]) -
                                      ((int64_t)b[1] - a[1]) * (((int64_t)x << stack.fine) - a[0]);
                    hits += s == 0;
                }
            }
    }
    close_stack();
    TEST_ASSERT_TRUE(hits > 10); /* the ties did occur */
}

static void test_corners_of_cells_against_exact_crossings(void)
{
    uint64_t seed = 6, tested = 0, deepest = 0;

    for (int i = 0; i < 200; i++) {
        bvxi_slab *slabs = NULL;
        if (open_random(&seed, i % 3 == 0 ? 16 : 0)) {
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_slabs_make(&stack, &slabs));
            for (uint32_t n = 0; n < stack.slab_count; n++) {
                const bvxi_slab *const b = &slabs[n];
                for (uint32_t l = 0; l < b->leaf_count; l++)
                    for (int k = 0; k < 2; k++)
                        for (int c = 0; c < 4; c++, tested++) {
                            const bvxi_leaf *const leaf = &b->leaf[l];
                            int32_t const u = leaf->low[0] + (c & 1) * leaf->size;
                            int32_t const v = leaf->low[1] + (c >> 1) * leaf->size;
                            if ((leaf->inside[k] >> c & 1) != oracle_inside(b->plane[k], u, v))
                                TEST_FAIL_MESSAGE("a corner is on the other side");
                            deepest += leaf->size == 1 << (stack.fine - 8);
                        }
            }
        }
        close_stack();
    }
    TEST_ASSERT_TRUE(tested > 100000 && deepest > 100);
}

static double oracle_distance(const bvxi_plane *p, double u, double v)
{
    double best = 1e300;

    for (uint32_t i = 0; i < p->point_count; i++) {
        const double *const a = p->uv[i], *const b = p->uv[p->next[i]];
        double const x = b[0] - a[0], y = b[1] - a[1];
        double t = ((u - a[0]) * x + (v - a[1]) * y) / (x * x + y * y);
        t = t < 0 ? 0 : t > 1 ? 1 : t;
        double const ex = u - (a[0] + t * x), ey = v - (a[1] + t * y), d = sqrt(ex * ex + ey * ey);
        if (d < best) best = d;
    }
    return best;
}

static void test_distances_against_all_segments(void)
{
    uint64_t seed = 7;
    int n = 0;

    while (n < 60) {
        if (open_random(&seed, 0)) {
            uint32_t hint = BVXI_NONE;
            for (int j = 0; j < 200; j++) {
                double const u = maker_between(&seed, -2, 5, 10000), v = maker_between(&seed, -2, 5, 10000);
                double const d = bvxi_plane_distance(&stack.plane[0], u, v, &hint);
                TEST_ASSERT_DOUBLE_WITHIN(1e-12, oracle_distance(&stack.plane[0], u, v), d);
                for (int k = 0; k < 3; k++) { /* bit by bit the same from wherever it begins */
                    uint32_t other = (uint32_t)maker_below(&seed, (int32_t)stack.plane[0].point_count);
                    TEST_ASSERT_TRUE(bvxi_plane_distance(&stack.plane[0], u, v, &other) == d);
                }
            }
            n++;
        }
        close_stack();
    }
}

/* In the ring, positions of points and cuts run along the loops; cuts of
 * one line on one segment are one vertex. */
static void test_rings_run_along_the_loops(void)
{
    uint64_t seed = 8, cuts = 0;

    for (int i = 0; i < 100; i++) {
        bvxi_slab *slabs = NULL;
        if (open_random(&seed, 0)) {
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_slabs_make(&stack, &slabs));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_rings_make(&stack));
            for (uint32_t k = 0; k < stack.plane_count; k++) {
                const bvxi_plane *const p = &stack.plane[k];
                if (p->contour_count == 0) continue;
                TEST_ASSERT_TRUE(p->ring_count >= p->point_count + p->grid_cut_count &&
                                 p->ring_count <= p->point_count + p->cut_count);
                for (uint32_t c = 0; c < p->cut_count; c++, cuts++) {
                    uint32_t const from = p->ring[p->cut[c].segment];
                    uint32_t const end = p->cut[c].segment + 1 < p->point_count
                                             ? p->ring[p->cut[c].segment + 1]
                                             : p->ring_count;
                    TEST_ASSERT_TRUE(p->cut[c].ring > from && p->cut[c].ring < end);
                }
                for (uint32_t c = 0; c < p->point_count; c++) { /* places along a segment grow */
                    const double *const a = made.point + 3 * p->given[c];
                    const double *const b = made.point + 3 * p->given[p->next[c]];
                    uint32_t const end = c + 1 < p->point_count ? p->ring[c + 1] : p->ring_count;
                    double last = 0.0;
                    for (uint32_t r = p->ring[c] + 1; r < end; r++) {
                        const double *const at = stack.mesh.position + 3 * (uint64_t)(p->vertex + r);
                        double const along = (at[0] - a[0]) * (b[0] - a[0]) + (at[1] - a[1]) * (b[1] - a[1]);
                        TEST_ASSERT_TRUE(along > last);
                        last = along;
                    }
                }
            }
        }
        close_stack();
    }
    TEST_ASSERT_TRUE(cuts > 10000);
}

/* Every pair of segments, exactly. */
static int64_t side_of(const int32_t *a, const int32_t *b, const int32_t *c)
{
    return ((int64_t)b[0] - a[0]) * ((int64_t)c[1] - a[1]) - ((int64_t)b[1] - a[1]) * ((int64_t)c[0] - a[0]);
}

static int sign_of(int64_t v)
{
    return (v > 0) - (v < 0);
}

static int oracle_is_simple(const bvxi_plane *p)
{
    for (uint32_t i = 0; i < p->point_count; i++)
        for (uint32_t j = 0; j < i; j++) {
            const int32_t *const a = p->q[i];
            const int32_t *const b = p->q[p->next[i]];
            const int32_t *const c = p->q[j];
            const int32_t *const d = p->q[p->next[j]];
            if (p->next[i] == j || p->next[j] == i) {
                const int32_t *const m = p->next[i] == j ? b : a;
                const int32_t *const x = p->next[i] == j ? a : b;
                const int32_t *const y = p->next[i] == j ? d : c;
                if (side_of(m, x, y) == 0 && ((int64_t)x[0] - m[0]) * ((int64_t)y[0] - m[0]) +
                                                     ((int64_t)x[1] - m[1]) * ((int64_t)y[1] - m[1]) >
                                                 0)
                    return 0;
            } else if (sign_of(side_of(a, b, c)) * sign_of(side_of(a, b, d)) <= 0 &&
                       sign_of(side_of(c, d, a)) * sign_of(side_of(c, d, b)) <= 0) {
                int32_t const left = (a[0] < b[0] ? a[0] : b[0]), right = (a[0] > b[0] ? a[0] : b[0]);
                int32_t const low = (a[1] < b[1] ? a[1] : b[1]), high = (a[1] > b[1] ? a[1] : b[1]);
                if ((c[0] < left && d[0] < left) || (c[0] > right && d[0] > right) ||
                    (c[1] < low && d[1] < low) || (c[1] > high && d[1] > high))
                    continue;
                return 0;
            }
        }
    return 1;
}

/* Small polygons on few places, of which many touch themselves. */
static void test_simple_loops_against_all_pairs(void)
{
    uint64_t seed = 9, simple = 0, crossed = 0;

    for (int i = 0; i < 20000; i++) {
        int const n = 3 + maker_below(&seed, 5);
        bvxi_plane p;
        bvxi_contour c;
        int32_t q[8][2];
        uint32_t next[8], given[8];
        int repeated = 0;
        memset(&stack, 0, sizeof stack);
        memset(&p, 0, sizeof p);
        memset(&c, 0, sizeof c);
        stack.ctx = ctx;
        stack.function = "test";
        stack.given = &made.s;
        made.loop[0].first_point = 0;
        c.count = (uint32_t)n;
        for (int k = 0; k < n; k++) {
            q[k][0] = 2 * maker_below(&seed, 6) + 1;
            q[k][1] = 2 * maker_below(&seed, 6) + 1;
            next[k] = (uint32_t)((k + 1) % n);
            given[k] = (uint32_t)k;
        }
        for (int k = 0; k < n; k++) repeated |= q[k][0] == q[(k + 1) % n][0] && q[k][1] == q[(k + 1) % n][1];
        if (repeated) continue;
        p.q = q;
        p.next = next;
        p.given = given;
        p.contour = &c;
        p.point_count = (uint32_t)n;
        p.contour_count = 1;
        bvxi_segment_box sorted[8], active[8];
        int const expected = oracle_is_simple(&p), is = plane_is_simple(&p);
        TEST_ASSERT_EQUAL_INT(expected, is);
        TEST_ASSERT_EQUAL_INT(expected, bvxi_plane_is_simple(&p, sorted, active));
        simple += (uint64_t)is;
        crossed += (uint64_t)!is;
    }
    TEST_ASSERT_TRUE(simple > 1000 && crossed > 1000);
}

/* Points that fall on each other, and an order that insertion would be slow at, are left to the full
 * check. */
static void test_quick_check_leaves_what_it_is_not_sure_of(void)
{
    enum { TEETH = 700 };
    static int32_t q[2 * TEETH + 2][2];
    static uint32_t next[2 * TEETH + 2];
    static bvxi_segment_box sorted[2 * TEETH + 2], active[2 * TEETH + 2];
    bvxi_plane p;
    memset(&p, 0, sizeof p);
    p.q = q;
    p.next = next;
    for (int pass = 0; pass < 3; pass++) {
        uint32_t n = 0;
        if (pass == 1) { /* a far corner makes one bucket of all teeth, whose order falls */
            q[n][0] = 1 << 28;
            q[n++][1] = 4 * TEETH + 9;
        }
        for (int32_t i = 0; i < TEETH; i++) {
            int32_t const left = pass == 1 ? 2 * (TEETH - i) + 1 : 2 * i + 1;
            q[n][0] = left;
            q[n++][1] = 4 * i + 1;
            q[n][0] = left + (pass == 1 ? 100001 : 1);
            q[n++][1] = 4 * i + 3;
        }
        if (pass != 1) {
            q[n][0] = 1;
            q[n++][1] = 4 * TEETH + 9;
        }
        if (pass == 2) memcpy(q[7], q[6], sizeof q[7]);
        for (uint32_t i = 0; i < n; i++) next[i] = i + 1 == n ? 0 : i + 1;
        p.point_count = n;
        TEST_ASSERT_EQUAL_INT(pass == 0, bvxi_plane_is_simple(&p, sorted, active));
    }
}

/* What is left of a loop when points that follow each other at one place
 * count as one; less than three points are there and back, or nothing at all. */
static int oracle_is_simple_at_places(const bvxi_plane *p)
{
    int32_t q[8][2];
    uint32_t next[8];
    bvxi_plane left = *p;

    left.q = q;
    left.next = next;
    left.point_count = 0;
    for (uint32_t i = 0; i < p->point_count; i++)
        if (memcmp(p->q[i], p->q[p->next[i]], sizeof q[0]) != 0)
            memcpy(q[left.point_count++], p->q[i], sizeof q[0]);
    for (uint32_t i = 0; i < left.point_count; i++) next[i] = i + 1 == left.point_count ? 0 : i + 1;
    return left.point_count == 0 || (left.point_count > 2 && oracle_is_simple(&left));
}

/* On fewer places, with points that fall on each other, and loops of two points. */
static void test_loops_with_points_at_one_place(void)
{
    uint64_t seed = 10, simple = 0, crossed = 0;

    for (int i = 0; i < 20000; i++) {
        int const n = 2 + maker_below(&seed, 6);
        bvxi_plane p;
        bvxi_contour c;
        bvxi_segment_box sorted[8], active[8];
        int32_t q[8][2];
        uint32_t next[8], given[8];
        int repeated = 0, expected;
        memset(&stack, 0, sizeof stack);
        memset(&p, 0, sizeof p);
        memset(&c, 0, sizeof c);
        stack.ctx = ctx;
        stack.function = "test";
        stack.given = &made.s;
        made.loop[0].first_point = 0;
        c.count = (uint32_t)n;
        for (int k = 0; k < n; k++) {
            q[k][0] = 2 * maker_below(&seed, 3) + 1;
            q[k][1] = 2 * maker_below(&seed, 3) + 1;
            if (k > 0 && maker_below(&seed, 3) == 0) memcpy(q[k], q[k - 1], sizeof q[k]);
            next[k] = (uint32_t)((k + 1) % n);
            given[k] = (uint32_t)k;
        }
        p.q = q;
        p.next = next;
        p.given = given;
        p.contour = &c;
        p.point_count = (uint32_t)n;
        p.contour_count = 1;
        for (int k = 0; k < n; k++) repeated |= memcmp(q[k], q[next[k]], sizeof q[k]) == 0;
        expected = oracle_is_simple_at_places(&p);
        TEST_ASSERT_EQUAL_INT(expected, plane_is_simple(&p));
        TEST_ASSERT_EQUAL_INT(expected && !repeated, bvxi_plane_is_simple(&p, sorted, active));
        simple += (uint64_t)expected;
        crossed += (uint64_t)!expected;
    }
    TEST_ASSERT_TRUE(simple > 1000 && crossed > 1000);
}

/* Lines moved by (e_u, e_v), e_u >> e_v > 0, as numbers 4096 times as large
 * let them be: nothing meets then, and the way to a crossing decides. */
static void test_order_of_crossings_with_lines_that_moved(void)
{
    enum { LARGE = 4096, SIDE = 21 };
    static int64_t const moved[2] = {64, 1};
    uint64_t seed = 11, ties = 0, tried = 0;
    for (int i = 0; i < 200000; i++) {
        int32_t q[2][2], line[2];
        uint32_t next[2] = {1, 0};
        int64_t d[2], way[2];
        int between = 1;
        bvxi_plane p;
        memset(&p, 0, sizeof p);
        p.q = q;
        p.next = next;
        for (int k = 0; k < 2; k++) {
            q[0][k] = maker_below(&seed, SIDE);
            q[1][k] = maker_below(&seed, SIDE);
            line[k] = maker_below(&seed, SIDE);
            d[k] = (int64_t)q[1][k] - q[0][k];
            way[k] = ((int64_t)line[k] - q[0][k]) * LARGE + moved[k];
            between &= (q[0][k] < line[k]) == (line[k] < q[1][k]) && line[k] != q[0][k] && line[k] != q[1][k];
        }
        if (between) {
            int64_t const u = way[0] * d[1], v = way[1] * d[0];
            TEST_ASSERT_EQUAL_INT((u < 0 ? -u : u) < (v < 0 ? -v : v),
                                  bvxi_x_first(q[0], q[1], line[0], line[1]));
            tried++;
        }
        for (int k = 0; k < 2; k++) {
            bvxi_line_cut cut;
            int64_t const beyond = (way[k] * d[1 - k] - way[1 - k] * d[k]) * (d[k] < 0 ? -1 : 1);
            memset(&cut, 0, sizeof cut);
            cut.axis = k;
            cut.line = line[k];
            /* no crossing, or along the other line */
            if (d[k] == 0 || (d[1 - k] == 0 && q[0][1 - k] == line[1 - k])) continue;
            TEST_ASSERT_EQUAL_INT(beyond > 0, bvxi_cut_beyond(&p, &cut, line[1 - k]));
            ties += ((int64_t)line[k] - q[0][k]) * d[1 - k] == ((int64_t)line[1 - k] - q[0][1 - k]) * d[k];
        }
    }
    TEST_ASSERT_TRUE(tried > 10000 && ties > 1000);
}

static int side_of_cut(const bvxi_plane *p, uint32_t cut, uint32_t key)
{
    int32_t const low[2] = {(int32_t)((key & 0xffff) << stack.fine), (int32_t)((key >> 16) << stack.fine)};
    return bvxi_side_of(&p->cut[cut], low);
}

/* Arcs of a cell are found, in the order of the cells; those cells ask for
 * subdivision that are crossed twice on a side or hold a loop. */
static void test_arcs_by_cell(void)
{
    uint64_t seed = 10, asking = 0;

    for (int i = 0; i < 25; i++) {
        if (open_random(&seed, 0))
            for (uint32_t k = 0; k < stack.plane_count; k++) {
                const bvxi_plane *const p = &stack.plane[k];
                uint32_t found = 0, asked = 0;
                for (int32_t y = 0; y < stack.size[1]; y++)
                    for (int32_t x = 0; x < stack.size[0]; x++) {
                        uint32_t const key = bvxi_cell_key(x, y);
                        uint32_t count, ends[4] = {0, 0, 0, 0};
                        uint32_t const first = bvxi_plane_arcs_in(p, key, &count);
                        int asks = 0;
                        TEST_ASSERT_TRUE(count == 0 || first == found);
                        for (uint32_t a = first; a < first + count; a++) {
                            const bvxi_ring_arc *const r = &p->ring_arc[a];
                            TEST_ASSERT_EQUAL_UINT32(key, p->arc_cell[a]);
                            if (p->arc[a].from == BVXI_NONE) {
                                asks = 1;
                                continue;
                            }
                            TEST_ASSERT_EQUAL_INT(side_of_cut(p, p->arc[a].from, key), r->from_side);
                            TEST_ASSERT_EQUAL_INT(side_of_cut(p, p->arc[a].to, key), r->to_side);
                            asks |= ends[r->from_side]++ != 0;
                            asks |= ends[r->to_side]++ != 0;
                        }
                        found += count;
                        if (asks) TEST_ASSERT_TRUE(asked < p->asking_count && p->asking[asked++] == key);
                    }
                TEST_ASSERT_EQUAL_UINT32(p->arc_count, found);
                TEST_ASSERT_EQUAL_UINT32(p->asking_count, asked);
                asking += asked;
            }
        close_stack();
    }
    TEST_ASSERT_TRUE(asking > 100);
}

/* The same vertices and triangles in the same order, whether plain cells are treated apart from others or not. */
static void test_plain_cells_are_what_tracing_gives(void)
{
    uint64_t seed = 11, triangles = 0;

    for (int i = 0; i < 25; i++) {
        bvxi_slab *slabs = NULL;
        if (open_random(&seed, i % 3 == 0 ? 16 : 0)) {
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_slabs_make(&stack, &slabs));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_rings_make(&stack));
            for (uint32_t n = 0; n < stack.slab_count; n++) {
                bvxi_section_mesh m[2];
                for (int k = 0; k < 2; k++) {
                    bvxi_stack view = stack;
                    bvxi_slab_work w;
                    memset(&view.mesh, 0, sizeof view.mesh);
                    view.ring_position = stack.mesh.position;
                    view.ring_vertices = (uint32_t)stack.mesh.vertex_count;
                    TEST_ASSERT_EQUAL_INT32(
                        BVX_OK, bvxi_slab_work_open(
                                    &w, &view, (uint32_t)((stack.size[0] + 1) * (stack.size[1] + 1)), 64));
                    w.only_traced = k;
                    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_slab_fill(&w, &slabs[n]));
                    m[k] = view.mesh;
                }
                TEST_ASSERT_EQUAL_UINT64(m[1].vertex_count, m[0].vertex_count);
                TEST_ASSERT_EQUAL_UINT64(m[1].triangle_count, m[0].triangle_count);
                TEST_ASSERT_TRUE(m[0].vertex_count == 0 ||
                                 memcmp(m[0].position, m[1].position, (size_t)m[0].vertex_count * 24) == 0);
                TEST_ASSERT_TRUE(m[0].triangle_count == 0 ||
                                 memcmp(m[0].triangle, m[1].triangle, (size_t)m[0].triangle_count * 12) == 0);
                triangles += m[0].triangle_count;
                for (int k = 0; k < 2; k++) {
                    bvxi_free(ctx, m[k].triangle, m[k].triangle_room * 12);
                    bvxi_free(ctx, m[k].position, m[k].vertex_room * 24);
                }
            }
        }
        close_stack();
    }
    TEST_ASSERT_TRUE(triangles > 5000);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_grid_points_against_exact_crossings);
    RUN_TEST(test_segments_through_grid_points);
    RUN_TEST(test_corners_of_cells_against_exact_crossings);
    RUN_TEST(test_distances_against_all_segments);
    RUN_TEST(test_rings_run_along_the_loops);
    RUN_TEST(test_simple_loops_against_all_pairs);
    RUN_TEST(test_quick_check_leaves_what_it_is_not_sure_of);
    RUN_TEST(test_loops_with_points_at_one_place);
    RUN_TEST(test_order_of_crossings_with_lines_that_moved);
    RUN_TEST(test_arcs_by_cell);
    RUN_TEST(test_plain_cells_are_what_tracing_gives);
    return UNITY_END();
}
