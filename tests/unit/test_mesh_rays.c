/* test_mesh_rays.c - rays against a mesh, all triangles one by one in whole numbers beside them; winding numbers
 * against the voxels of the solid, whose centres lie on edges and corners. */
#include "bitvox_io.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>
#include <stdlib.h>

static maker_mesh m;
static uint64_t seed;
static bvx_closest *closest;

void setUp(void)
{
    suite_open(0);
    seed = 11;
    closest = NULL;
    maker_clear(&m);
}

void tearDown(void)
{
    bvx_closest_free(ctx, closest);
    maker_free(&m);
    suite_close();
}

static void open_mesh(void)
{
    bvx_mesh_view const v = maker_view(&m);

    bvx_closest_free(ctx, closest);
    closest = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, &v, &closest));
}

/* ---- Every triangle, in whole numbers ---- */

/* The sign of det(d, a - o, b - o), o moved by the tie rule. */
static int side_of(const int64_t o[3], const int64_t d[3], const int64_t *a, const int64_t *b)
{
    int64_t u[3], v[3], sum = 0;

    for (int k = 0; k < 3; k++) {
        u[k] = a[k] - o[k];
        v[k] = b[k] - o[k];
    }
    for (int k = 0; k < 3; k++) {
        int const l = (k + 1) % 3, n = (k + 2) % 3;
        sum += d[k] * (u[l] * v[n] - u[n] * v[l]);
    }
    for (int k = 0; k < 3 && sum == 0; k++) {
        int const l = (k + 1) % 3, n = (k + 2) % 3;
        sum = d[l] * (b[n] - a[n]) - d[n] * (b[l] - a[l]);
    }
    return (sum > 0) - (sum < 0);
}

/* 1 or -1: the line meets the triangle from before or behind; *n: normal times the way from the origin, and times the
 * direction. */
static int meets(const int64_t o[3], const int64_t d[3], const int64_t t[3][3], int64_t n[2])
{
    int const first = side_of(o, d, t[0], t[1]);

    n[0] = n[1] = 0;
    for (int k = 0; k < 3; k++) {
        int const l = (k + 1) % 3, j = (k + 2) % 3;
        int64_t const normal = (t[1][l] - t[0][l]) * (t[2][j] - t[0][j]) -
                               (t[1][j] - t[0][j]) * (t[2][l] - t[0][l]);
        n[0] += normal * (t[0][k] - o[k]);
        n[1] += normal * d[k];
    }
    return first != 0 && side_of(o, d, t[1], t[2]) == first && side_of(o, d, t[2], t[0]) == first ? -first
                                                                                                  : 0;
}

static void corners_of(size_t triangle, int64_t t[3][3])
{
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) t[k][a] = (int64_t)m.p[3 * m.t[3 * triangle + (size_t)k] + (size_t)a];
}

enum { RAYS = 400, HITS = 64 };

static void test_rays_meet_what_whole_numbers_say(void)
{
    static const double low[3] = {-7, -6, -5}, high[3] = {7, 6, 5};
    static double rays[6 * RAYS];
    static bvx_mesh_hit nearest[RAYS], all[RAYS * HITS];
    static uint64_t offsets[RAYS + 1];
    int met = 0, through_edges = 0;

    for (int kind = 0; kind < 3; kind++) {
        maker_clear(&m);
        if (kind == 0) maker_soup(&m, &seed, 60, low, high, 1);
        if (kind == 1) maker_box(&m, low, high);
        if (kind == 2) maker_degenerate(&m, &seed, 60, low, high, 1);
        open_mesh();
        for (int i = 0; i < RAYS; i++) {
            for (int k = 0; k < 6; k++) rays[6 * i + k] = (double)(maker_below(&seed, 19) - 9);
            if (i % 3 == 0) rays[6 * i + 3] = rays[6 * i + 4] = 0;
            if (rays[6 * i + 3] == 0 && rays[6 * i + 4] == 0 && rays[6 * i + 5] == 0) rays[6 * i + 5] = 1;
        }
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_cast(ctx, closest, rays, RAYS, HUGE_VAL, nearest));
        TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                bvx_closest_crossings(ctx, closest, rays, RAYS, HUGE_VAL, offsets, NULL, 0));
        TEST_ASSERT_TRUE(offsets[RAYS] <= RAYS * HITS);
        if (offsets[RAYS] > 0)
            TEST_ASSERT_EQUAL_INT32(
                BVX_ERR_CAPACITY,
                bvx_closest_crossings(ctx, closest, rays, RAYS, HUGE_VAL, offsets, all, offsets[RAYS] - 1));
        TEST_ASSERT_EQUAL_INT32(
            BVX_OK, bvx_closest_crossings(ctx, closest, rays, RAYS, HUGE_VAL, offsets, all, RAYS * HITS));

        for (int i = 0; i < RAYS; i++) {
            const bvx_mesh_hit *const hit = all + offsets[i];
            uint64_t const count = offsets[i + 1] - offsets[i];
            uint64_t found = 0;
            int64_t o[3], d[3], t[3][3], n[2];

            for (int k = 0; k < 3; k++) {
                o[k] = (int64_t)rays[6 * i + k];
                d[k] = (int64_t)rays[6 * i + 3 + k];
            }
            for (size_t j = 0; j < m.triangles; j++) {
                uint64_t at = 0;
                int side;

                corners_of(j, t);
                side = meets(o, d, (const int64_t(*)[3])t, n);
                if (side == 0 || (n[0] != 0 && (n[0] > 0) != (n[1] > 0))) continue;
                found++;
                while (at < count && hit[at].triangle != j) at++;
                TEST_ASSERT_TRUE(at < count);
                TEST_ASSERT_EQUAL_INT32(side, hit[at].side);
                TEST_ASSERT_DOUBLE_WITHIN(1e-12, (double)n[0] / (double)n[1], hit[at].t);
                for (int a = 0; a < 3; a++) {
                    double blend = 0;

                    for (int k = 0; k < 3; k++) blend += hit[at].weight[k] * (double)t[k][a];
                    TEST_ASSERT_DOUBLE_WITHIN(1e-12, (double)o[a] + hit[at].t * (double)d[a],
                                              hit[at].position[a]);
                    TEST_ASSERT_DOUBLE_WITHIN(1e-12, hit[at].position[a], blend);
                    through_edges += hit[at].weight[a] == 0;
                }
            }
            TEST_ASSERT_EQUAL_UINT64(found, count);
            for (uint64_t k = 1; k < count; k++) TEST_ASSERT_TRUE(hit[k - 1].t <= hit[k].t);
            if (kind == 1) TEST_ASSERT_TRUE(count <= 2);
            TEST_ASSERT_EQUAL_INT(count > 0, nearest[i].side != 0);
            if (count > 0) TEST_ASSERT_EQUAL_MEMORY(hit, &nearest[i], sizeof *hit);
            met += count > 0;
        }
    }
    TEST_ASSERT_TRUE(met > 250 && through_edges > 60);
}

/* A limit ends a ray; what lies at it is met. */
static void test_hits_reach_to_t_max(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {4, 4, 4}, ray[6] = {1, 2, -3, 0, 0, 0.5};
    bvx_mesh_hit hit;

    maker_box(&m, low, high);
    open_mesh();
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_cast(ctx, closest, ray, 1, 6, &hit));
    TEST_ASSERT_TRUE(hit.side == 1 && hit.t == 6 && hit.position[2] == 0);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_cast(ctx, closest, ray, 1, 5.9, &hit));
    TEST_ASSERT_TRUE(hit.side == 0 && hit.t == 0);
}

static void test_rays_that_are_none_are_refused(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {1, 1, 1};
    double ray[6] = {0, 0, 0, 0, 0, 0};
    bvx_mesh_hit hit;
    int64_t turns;

    maker_box(&m, low, high);
    open_mesh();
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_cast(ctx, closest, ray, 1, 1, &hit));
    ray[3] = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_cast(ctx, closest, ray, 1, -1, &hit));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_cast(ctx, closest, ray, 1, 1, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_cast(ctx, NULL, ray, 1, 1, &hit));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_crossings(ctx, closest, ray, 1, 1, NULL, &hit, 1));
    ray[0] = 1e290;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_closest_cast(ctx, closest, ray, 1, 1, &hit));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_winding(ctx, closest, ray, 1, &turns));
    TEST_ASSERT_EQUAL_INT64(0, turns);
    ray[0] = HUGE_VAL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_closest_winding(ctx, closest, ray, 1, &turns));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_winding(ctx, closest, ray, 1, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_winding(ctx, closest, NULL, 0, NULL));
}

/* ---- Winding numbers ---- */

/* The mesh's corners are half integers, so that centres lie on corners, edges and faces. */
static void expect_turns(int32_t fill)
{
    static double points[16 * 16 * 16 * 3];
    static int64_t turns[16 * 16 * 16];
    bvx_mesh_view const v = maker_view(&m);
    bvx_voxelize_options o = {.struct_size = sizeof o, .fill = fill};
    bvx_lattice lattice;
    bvx_grid grid = {0};
    int32_t const dims[3] = {16, 16, 16};
    double const origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};

    open_mesh();
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &v, &lattice, &o, &grid));
    for (int i = 0; i < 16 * 16 * 16; i++) {
        points[3 * i] = i % 16 + 0.5;
        points[3 * i + 1] = i / 16 % 16 + 0.5;
        points[3 * i + 2] = i / 256 + 0.5;
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_winding(ctx, closest, points, 16 * 16 * 16, turns));
    for (int i = 0; i < 16 * 16 * 16; i++)
        TEST_ASSERT_EQUAL_INT(bvx_grid_get(&grid, i % 16, i / 16 % 16, i / 256), turns[i] != 0);
    bvx_grid_free(ctx, &grid);
}

static void test_winding_numbers_are_the_voxels_of_the_solid(void)
{
    static const double low[3] = {2.5, 3.5, 4.5}, high[3] = {9.5, 8.5, 12.5}, centre[3] = {8, 8, 8},
                        radius[3] = {6, 5, 6};

    maker_box(&m, low, high);
    expect_turns(BVX_FILL_PARITY);
    for (int round = 0; round < 6; round++) {
        maker_clear(&m);
        maker_star(&m, &seed, centre, radius, 0.3, 7, 10, 2);
        expect_turns(BVX_FILL_NONZERO);
    }
}

/* Two boxes, one in the other, both outwards: 2 in the inner one. */
static void test_turns_are_counted(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {8, 8, 8}, inner[3] = {2, 2, 2}, outer[3] = {6, 6, 6};
    static const double points[9] = {1, 1, 1, 3, 3, 3, 9, 1, 1};
    int64_t turns[3];

    maker_box(&m, low, high);
    maker_box(&m, inner, outer);
    open_mesh();
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_winding(ctx, closest, points, 3, turns));
    TEST_ASSERT_EQUAL_INT64(1, turns[0]);
    TEST_ASSERT_EQUAL_INT64(2, turns[1]);
    TEST_ASSERT_EQUAL_INT64(0, turns[2]);
}

/* ---- Links ---- */

enum { LINKED = 16 * 16 * 16 };

/* Those of voxels outside a star, one by one; a neighbour inside is behind the surface. */
static void test_links_are_the_hits_of_rays_to_neighbours(void)
{
    static const double centre[3] = {8, 8, 8}, radius[3] = {6, 5, 6}, origin[3] = {0, 0, 0},
                        spacing[3] = {1, 1, 0.5};
    static const int32_t dims[3] = {16, 16, 32};
    bvx_window const window = {{1, 0, 8}, {15, 16, 16}};
    static float values[LINKED * 26];
    bvx_voxelize_options o = {.struct_size = sizeof o, .window = window};
    bvx_lattice lattice;
    bvx_grid solid = {0}, grid = {0};

    maker_star(&m, &seed, centre, radius, 0.3, 7, 10, 2);
    open_mesh();
    bvx_mesh_view const v = maker_view(&m);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &v, &lattice, &o, &solid));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_complement(ctx, &solid, &grid));
    for (int farthest = 1; farthest <= 3; farthest++) {
        int const links = farthest == 1 ? 6 : farthest == 2 ? 18 : 26;
        const float *value = values;
        int behind = 0, met = 0;

        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_links(ctx, closest, &grid, links, values));
        for (int i = 0; i < 15 * 16 * 16; i++) {
            int const at[3] = {i % 15, i / 15 % 16, i / 240};
            if (!bvx_grid_get(&grid, at[0], at[1], at[2])) continue;
            for (int n = 0; n < 27; n++) {
                int const way[3] = {n % 3 - 1, n / 3 % 3 - 1, n / 9 - 1};
                double const ray[6] = {at[0] + 1.5, at[1] + 0.5, (at[2] + 8.5) * 0.5,
                                       way[0],      way[1],      way[2] * 0.5};
                int const to[3] = {at[0] + way[0], at[1] + way[1], at[2] + way[2]};
                bvx_mesh_hit hit;

                if (n == 13 || abs(way[0]) + abs(way[1]) + abs(way[2]) > farthest) continue;
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_cast(ctx, closest, ray, 1, 1, &hit));
                TEST_ASSERT_TRUE(*value == (hit.side != 0 ? (float)hit.t : -1.0F));
                met += hit.side != 0;
                if (to[0] >= 0 && to[0] < 15 && to[1] >= 0 && to[1] < 16 && to[2] >= 0 && to[2] < 16 &&
                    bvx_grid_get(&solid, to[0], to[1], to[2])) {
                    TEST_ASSERT_TRUE(*value >= 0.0F && *value <= 1.0F);
                    behind++;
                }
                value++;
            }
        }
        TEST_ASSERT_TRUE(behind > 100 * farthest && met >= behind);
    }
    bvx_grid_free(ctx, &solid);
    bvx_grid_free(ctx, &grid);
}

static void test_links_that_are_none_are_refused(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {1.75, 2, 2}, spacing[3] = {1, 1, 1},
                        far[3] = {1e290, 0, 0};
    static const int32_t dims[3] = {3, 2, 2};
    float values[6];
    bvx_lattice lattice;
    bvx_grid grid = {0};

    maker_box(&m, low, high);
    open_mesh();
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, low, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, NULL, &grid));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_links(ctx, closest, &grid, 6, NULL));
    bvx_grid_set(&grid, 2, 0, 0, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_links(ctx, closest, &grid, 6, values));
    for (int n = 0; n < 6; n++) TEST_ASSERT_TRUE(values[n] == (n == 2 ? 0.75F : -1.0F));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_links(ctx, closest, &grid, -7, values));
    TEST_ASSERT_EQUAL_STRING("bvx_closest_links: a voxel has 6, 18 or 26 links, not -7",
                             bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_links(ctx, closest, &grid, 6, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_links(ctx, NULL, &grid, 6, values));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_closest_links(ctx, closest, NULL, 6, values));
    for (int a = 0; a < 3; a++) grid.lattice.origin[a] = far[a];
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_closest_links(ctx, closest, &grid, 6, values));
    bvx_grid_free(ctx, &grid);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_rays_meet_what_whole_numbers_say);
    RUN_TEST(test_hits_reach_to_t_max);
    RUN_TEST(test_rays_that_are_none_are_refused);
    RUN_TEST(test_winding_numbers_are_the_voxels_of_the_solid);
    RUN_TEST(test_turns_are_counted);
    RUN_TEST(test_links_are_the_hits_of_rays_to_neighbours);
    RUN_TEST(test_links_that_are_none_are_refused);
    return UNITY_END();
}
