/* test_sharp_parts.c - the pieces that sharp features are made of: loops of
 * cells, the place of an apex, triangles apart. */
#include "surface/cells.h"
#include "surface/sharp.h"
#include "tools/cell_tables.h"
#include "unit/field_surface_support.h"

static void test_loops_are_those_of_the_tables(void)
{
    for (int32_t rule = 0; rule < 2; rule++)
        for (uint32_t n = 0; n < BVXI_CELL_CASES; n++) {
            uint32_t const corners = 3u * bvxi_cell_triangle_count[rule][n];
            uint32_t numbers[BVXI_CELL_ROW] = {0}, used = 0, triangles = 0;
            bvxi_cell_loops l;
            for (uint32_t i = 0; i < corners; i++) numbers[i] = 100u + bvxi_cell_triangle_vertex[rule][n][i];
            bvxi_trace_cell(rule, n, numbers, &l);
            TEST_ASSERT_EQUAL_INT32(bvxi_cell_loop_count[rule][n], l.count);
            for (int32_t i = 0; i < l.count; i++) {
                TEST_ASSERT_EQUAL_UINT32(triangles, l.loop[i].first);
                triangles += l.loop[i].triangles;
                TEST_ASSERT_EQUAL_UINT32((uint32_t)l.loop[i].corners, l.loop[i].triangles + 2);
                for (int32_t k = 0; k < l.loop[i].corners; k++) {
                    uint8_t const e = l.loop[i].edge[k], f = l.loop[i].edge[(k + 1) % l.loop[i].corners];
                    int32_t const face = bvxi_face_of_edges(e, f), axis = face >> 1;
                    TEST_ASSERT_EQUAL_UINT32(100u + e, l.loop[i].vertex[k]);
                    TEST_ASSERT_EQUAL_UINT32(0, used >> e & 1);
                    used |= 1u << e;
                    /* edges of a face run across its axis */
                    TEST_ASSERT_TRUE(e / 4 != axis && f / 4 != axis);
                }
            }
            TEST_ASSERT_EQUAL_UINT32(corners, 3 * triangles);
        }
}

static void test_faces_that_are_cut_twice(void)
{
    int count = 0;

    for (int32_t face = 0; face < 6; face++)
        for (uint32_t n = 0; n < 256; n++) {
            int32_t cut = 0;
            for (uint8_t e = 0; e < 12; e++) {
                int32_t const first = e % 4 % 2, second = e % 4 / 2, axis = e / 4;
                int32_t const low = axis == 0   ? 2 * first + 4 * second
                                    : axis == 1 ? first + 4 * second
                                                : first + 2 * second;
                int32_t const high = low + (1 << axis), side = face & 1, a = face >> 1;
                if ((low >> a & 1) != side || (high >> a & 1) != side) continue;
                cut += (n >> low & 1) != (n >> high & 1);
            }
            TEST_ASSERT_EQUAL_INT(cut == 4, bvxi_face_is_cut_twice(n, face));
            count += cut == 4;
        }
    TEST_ASSERT_EQUAL_INT(6 * 32, count);
}

static double plane_sum(const bvxi_apex_plane *p, int32_t count, const double x[3])
{
    double sum = 0;
    for (int32_t i = 0; i < count; i++) {
        double const d = p[i].n[0] * x[0] + p[i].n[1] * x[1] + p[i].n[2] * x[2] - p[i].d;
        sum += d * d;
    }
    return sum;
}

static void random_unit(double n[3])
{
    double length = 0;

    while (!(length > 0.01)) {
        length = 0;
        for (int k = 0; k < 3; k++) {
            n[k] = maker_between(&seed, -1, 1, 1 << 20);
            length += n[k] * n[k];
        }
    }
    for (int k = 0; k < 3; k++) n[k] /= sqrt(length);
}

static void test_apex_of_a_corner_an_edge_and_a_plane(void)
{
    double const half[3] = {0.5, 0.5, 0.5}, middle[3] = {0.1, 0.2, -0.1};
    bvxi_apex_plane const p[3] = {{{1, 0, 0}, 0.3}, {{0, 0.6, 0.8}, -0.1}, {{0, 0.8, -0.6}, 0.2}};
    double x[3];

    bvxi_apex(p, 3, middle, half, x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, plane_sum(p, 3, x));
    bvxi_apex(p, 2, middle, half, x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0, plane_sum(p, 2, x));
    /* along the edge it stays */
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.8 * 0.2 + 0.6 * 0.1, 0.8 * x[1] - 0.6 * x[2]);
    bvxi_apex(p, 1, middle, half, x);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.3, x[0]);
    TEST_ASSERT_TRUE(x[1] == middle[1] && x[2] == middle[2]);
    bvxi_apex(p, 0, middle, half, x);
    TEST_ASSERT_TRUE(x[0] == middle[0] && x[1] == middle[1] && x[2] == middle[2]);
}

/* trace^3 / determinant of the planes' sum of n n': below 50 no eigenvalue is small enough to be left out. */
static int planes_fix_a_place(const bvxi_apex_plane *p, int32_t count)
{
    double a[3][3] = {{0}}, trace, det;

    for (int32_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++)
            for (int l = 0; l < 3; l++) a[k][l] += p[i].n[k] * p[i].n[l];
    trace = a[0][0] + a[1][1] + a[2][2];
    det = a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) -
          a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
          a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
    return det > trace * trace * trace / 50;
}

/* In the box, and where it lies strictly inside and the planes fix a place, no step makes the sum less. */
static void test_apex_is_the_least_place(void)
{
    int inside = 0, outside = 0;

    for (int n = 0; n < 40000; n++) {
        double const half[3] = {0.5, 0.4, 0.3};
        bvxi_apex_plane p[6];
        double middle[3], x[3];
        int32_t const count = 3 + maker_below(&seed, 4);
        int free_of_walls = 1;
        for (int k = 0; k < 3; k++) middle[k] = maker_between(&seed, -half[k], half[k], 1000);
        for (int32_t i = 0; i < count; i++) {
            random_unit(p[i].n);
            p[i].d = maker_between(&seed, -0.5, 0.5, 1000);
        }
        bvxi_apex(p, count, middle, half, x);
        for (int k = 0; k < 3; k++) {
            TEST_ASSERT_TRUE(x[k] >= -half[k] && x[k] <= half[k]);
            free_of_walls &= x[k] > -half[k] && x[k] < half[k];
        }
        outside += !free_of_walls;
        if (!free_of_walls || !planes_fix_a_place(p, count)) continue;
        inside++;
        for (int k = 0; k < 3; k++)
            for (int s = -1; s <= 1; s += 2) {
                double y[3] = {x[0], x[1], x[2]};
                y[k] += s * 0.001;
                TEST_ASSERT_TRUE(plane_sum(p, count, y) > plane_sum(p, count, x));
            }
    }
    TEST_ASSERT_TRUE(inside > 1000 && outside > 1000);
}

static void test_triangles_apart_is_never_wrong(void)
{
    int apart = 0, missed = 0, together = 0;

    for (int n = 0; n < 100000; n++) {
        double t[2][3][3];
        int64_t q[2][3][3];
        const int64_t *corner[2][3];
        int crosses, said;
        int32_t const steps = maker_below(&seed, 2) ? 4 : 1 << 20;
        for (int i = 0; i < 2; i++)
            for (int k = 0; k < 3; k++) {
                for (int a = 0; a < 3; a++) {
                    t[i][k][a] = maker_between(&seed, 1, 3, steps);
                    q[i][k][a] = (int64_t)(t[i][k][a] * 1048576.0);
                }
                corner[i][k] = q[i][k];
            }
        if (crossing_axis(corner[0]) < 0 || crossing_axis(corner[1]) < 0) continue;
        crosses = crossing_pair(corner[0], corner[1]);
        said = bvxi_triangles_apart((const double(*)[3])t[0], (const double(*)[3])t[1]);
        TEST_ASSERT_FALSE(said && crosses);
        apart += said;
        together += crosses;
        missed += !said && !crosses;
    }
    TEST_ASSERT_TRUE(apart > 10000 && together > 10000 && missed < 100);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_loops_are_those_of_the_tables);
    RUN_TEST(test_faces_that_are_cut_twice);
    RUN_TEST(test_apex_of_a_corner_an_edge_and_a_plane);
    RUN_TEST(test_apex_is_the_least_place);
    RUN_TEST(test_triangles_apart_is_never_wrong);
    return UNITY_END();
}
