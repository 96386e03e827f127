/* test_transform.c - a view with a transform gives what a mesh of doubles does whose vertices were multiplied before. */
#include "suite.h"
#include "tools/mesh_maker.h"

#include <math.h>

static maker_mesh mesh;
static float plain[4096][4]; /* floats, a number apart */
static double moved[4096][3];
static bvx_mesh_view by_transform, by_hand;
static const double turn[12] = {0.8, -0.6, 0.1, 3.25, 0.6, 0.8, -0.3, 1e3, 0.2, 0.1, 0.9, -7.5};

void setUp(void)
{
    static const double centre[3] = {1, 2, 3}, radius[3] = {5, 4, 6};
    uint64_t seed = 11;

    suite_open(1);
    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, radius, 0.3, 9, 14, 1024);
    /* Two bodies with a common vertex, and a hole: fans are split, lids are made. */
    maker_tetrahedron(&mesh, 0, maker_vertex(&mesh, 9, 9, 9), maker_vertex(&mesh, 9, 8, 9),
                      maker_vertex(&mesh, 8, 9, 9));
    maker_remove(&mesh, 40);
    by_transform = by_hand = maker_view(&mesh);
    TEST_ASSERT_LESS_THAN(4096, mesh.vertices);
    for (uint64_t v = 0; v < mesh.vertices; v++) {
        for (int a = 0; a < 3; a++) plain[v][a] = (float)mesh.p[3 * v + (uint64_t)a];
        for (int a = 0; a < 3; a++)
            moved[v][a] = ((turn[4 * a] * plain[v][0] + turn[4 * a + 1] * plain[v][1]) +
                           turn[4 * a + 2] * plain[v][2]) +
                          turn[4 * a + 3];
    }
    by_transform.positions = plain;
    by_transform.position_type = BVX_F32;
    by_transform.position_stride = sizeof plain[0];
    by_transform.transform = turn;
    by_hand.positions = moved;
    by_hand.position_type = BVX_F64;
    by_hand.position_stride = 0;
}

void tearDown(void)
{
    maker_free(&mesh);
    suite_close();
}

static uint64_t hash_of(bvx_mesh *m)
{
    uint64_t hash = 0;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, m, &hash));
    bvx_mesh_free(ctx, m);
    return hash;
}

static void test_checks_and_lattices(void)
{
    bvx_certificate c[2];
    bvx_lattice l[2];

    for (int i = 0; i < 2; i++) {
        const bvx_mesh_view *const view = i == 0 ? &by_transform : &by_hand;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, view, 1, &c[i]));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, view, 40, &l[i]));
    }
    TEST_ASSERT_EQUAL_MEMORY(&c[1], &c[0], sizeof c[0]);
    TEST_ASSERT_EQUAL_MEMORY(&l[1], &l[0], sizeof l[0]);
}

static void test_solids_of_all_rules(void)
{
    static const int32_t fills[] = {BVX_FILL_AUTO, BVX_FILL_PARITY, BVX_FILL_NONZERO, BVX_FILL_VOTE,
                                    BVX_FILL_WINDING};

    for (size_t f = 0; f < sizeof fills / sizeof fills[0]; f++) {
        bvx_voxelize_options const o = {.struct_size = sizeof o, .fill = fills[f]};
        bvx_lattice lattice;
        bvx_grid solid = {0};
        uint64_t hash[2];

        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, &by_hand, 40, &lattice));
        for (int i = 0; i < 2; i++) {
            TEST_ASSERT_EQUAL_INT32(
                BVX_OK, bvx_voxelize_solid(ctx, i == 0 ? &by_transform : &by_hand, &lattice, &o, &solid));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(ctx, &solid, &hash[i]));
        }
        TEST_ASSERT_EQUAL_HEX64(hash[1], hash[0]);
        bvx_grid_free(ctx, &solid);
    }
}

static void test_levels_and_repairs(void)
{
    static const uint64_t target[2] = {120, 60};
    bvx_simplify_options const s = {.struct_size = sizeof s, .targets = {.triangles = target}};
    bvx_repair_options const r = {.struct_size = sizeof r, .fit = {.resolution = 40}};
    uint64_t hash[2][3];

    for (int i = 0; i < 2; i++) {
        const bvx_mesh_view *const view = i == 0 ? &by_transform : &by_hand;
        bvx_mesh levels[2] = {{0}}, repaired = {0};
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_simplify(ctx, view, &s, 2, levels),
                                        bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_INT32(BVX_F64, levels[0].position_type);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_repair(ctx, view, &r, &repaired), bvx_last_message(ctx));
        hash[i][0] = hash_of(&levels[0]);
        hash[i][1] = hash_of(&levels[1]);
        hash[i][2] = hash_of(&repaired);
    }
    TEST_ASSERT_EQUAL_HEX64_ARRAY(hash[1], hash[0], 3);
}

static void test_closest_points(void)
{
    static const double points[6] = {0, 1000, 0, 8, 1003, -4};
    bvx_closest_point found[2][2];

    memset(found, 0, sizeof found);
    for (int i = 0; i < 2; i++) {
        bvx_closest *closest = NULL;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_create(ctx, i == 0 ? &by_transform : &by_hand, &closest));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_closest_find(ctx, closest, points, 2, found[i]));
        bvx_closest_free(ctx, closest);
    }
    TEST_ASSERT_EQUAL_MEMORY(found[1], found[0], sizeof found[0]);
}

static void test_a_transform_that_is_not_finite(void)
{
    double bad[12];
    bvx_certificate c;

    memcpy(bad, turn, sizeof bad);
    bad[3] = HUGE_VAL;
    by_transform.transform = bad;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_mesh_check(ctx, &by_transform, 0, &c));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_checks_and_lattices);
    RUN_TEST(test_solids_of_all_rules);
    RUN_TEST(test_levels_and_repairs);
    RUN_TEST(test_closest_points);
    RUN_TEST(test_a_transform_that_is_not_finite);
    return UNITY_END();
}
