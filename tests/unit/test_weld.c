/* test_weld.c - which vertices share a position, against comparing all pairs. */
#include "core/key_tree.h"
#include "mesh/topology.h"
#include "tools/fault.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#include <stdlib.h>

enum { MOST = 600 };

static double positions[MOST][3];
static float floats[MOST][3];
static uint32_t representative[MOST];

void setUp(void)
{
    suite_open(0);
}

void tearDown(void)
{
    suite_close();
}

static bvx_mesh_view view_of(uint64_t n, uint32_t type)
{
    bvx_mesh_view v;

    memset(&v, 0, sizeof v);
    for (uint64_t i = 0; i < n; i++)
        for (int a = 0; a < 3; a++) floats[i][a] = (float)positions[i][a];
    v.positions = type == BVX_F32 ? (const void *)floats : (const void *)positions;
    v.vertex_count = n;
    v.position_type = type;
    return v;
}

static void expect_weld(uint64_t n, uint32_t type)
{
    bvx_mesh_view const v = view_of(n, type);
    uint64_t different = 0, want_different = 0;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_weld(ctx, &v, representative, &different));
    for (uint64_t i = 0; i < n; i++) {
        uint64_t k = 0;
        while (positions[k][0] != positions[i][0] || positions[k][1] != positions[i][1] ||
               positions[k][2] != positions[i][2])
            k++;
        TEST_ASSERT_EQUAL_UINT32(k, representative[i]);
        want_different += k == i;
    }
    TEST_ASSERT_EQUAL_UINT64(want_different, different);
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
}

static void test_weld_finds_the_least_vertex_at_each_position(void)
{
    uint64_t seed = 3;

    for (int round = 0; round < 60; round++) {
        int32_t const sides = 1 + maker_below(&seed, 9);
        uint64_t const n = round < 4 ? (uint64_t)round : (uint64_t)maker_below(&seed, MOST);
        for (uint64_t i = 0; i < n; i++)
            for (int a = 0; a < 3; a++) { /* minus zero now and then */
                double const x = (double)(maker_below(&seed, sides) - sides / 2) * 0.25;
                positions[i][a] = x == 0.0 && maker_below(&seed, 2) ? -0.0 : x;
            }
        expect_weld(n, BVX_F32);
        expect_weld(n, BVX_F64);
    }
}

/* Positions that differ in their last bit alone stay apart. */
static void test_weld_joins_nothing_that_differs(void)
{
    double x = 1.0;

    for (int i = 0; i < MOST; i++) {
        positions[i][0] = x;
        positions[i][1] = 1.0 - x;
        positions[i][2] = 5e-324 * i;
        x += 1.1102230246251565e-16 * 2;
    }
    expect_weld(MOST, BVX_F64);
    TEST_ASSERT_EQUAL_UINT32(MOST - 1, representative[MOST - 1]);
}

static bvx_status weld_some(void *user, bvx_context *context)
{
    bvx_mesh_view const v = view_of(MOST, BVX_F64);
    uint64_t different;
    (void)user;
    return bvxi_weld(context, &v, representative, &different);
}

static void test_every_allocation_may_fail(void)
{
    uint64_t allocations = 0;
    TEST_ASSERT_NULL(fault_every_allocation(weld_some, NULL, NULL, &allocations));
    TEST_ASSERT_EQUAL_UINT64(1, allocations);
}

static int32_t stop_at_once(void *user, const char *stage, double fraction)
{
    TEST_ASSERT_EQUAL_STRING("weld", stage);
    TEST_ASSERT_TRUE(fraction >= 0.0 && fraction <= 1.0);
    ++*(int *)user;
    return 1;
}

static void test_many_vertices_can_be_cancelled(void)
{
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_context *asking;
    bvx_mesh_view v;
    uint64_t different;
    int asked = 0;

    o.progress.call = stop_at_once;
    o.progress.user = &asked;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &asking));
    memset(&v, 0, sizeof v);
    v.vertex_count = (1 << 20) + 5;
    v.position_type = BVX_F32;
    v.positions = calloc((size_t)v.vertex_count, 12);
    uint32_t *const numbers = malloc((size_t)v.vertex_count * 4);
    TEST_ASSERT_TRUE(v.positions != NULL && numbers != NULL);
    TEST_ASSERT_EQUAL_INT32(BVX_CANCELLED, bvxi_weld(asking, &v, numbers, &different));
    TEST_ASSERT_EQUAL_INT(1, asked);
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(asking));
    free(numbers);
    free((void *)(uintptr_t)v.positions);
    bvx_context_destroy(asking);
}

/* ---- keys made to collide ---- */

enum { FLOOD = 100000 };

static double (*flood)[3];
static uint32_t *flood_numbers;

static uint64_t inverse_of(uint64_t odd)
{
    uint64_t x = odd;
    for (int i = 0; i < 6; i++) x *= 2 - odd * x;
    return x;
}

/* Positions 0, 0, z whose hashes are in the same few thousand of 2^31: the hash of weld.c run backwards. */
static void make_flood(void)
{
    uint64_t const last = inverse_of(UINT64_C(0xbf58476d1ce4e5b9));
    uint64_t const first = inverse_of(UINT64_C(0x9e3779b97f4a7c15));
    uint64_t n = 0;

    for (uint64_t i = 0; n < FLOOD; i++) {
        uint64_t const mixed = (UINT64_C(5) << 33 | i) * last;
        uint64_t const plain = (mixed ^ mixed >> 29 ^ mixed >> 58) * first;
        double z;
        memcpy(&z, &plain, sizeof z);
        if (!(z > -1e100 && z < 1e100) || (z < 1e-100 && z > -1e-100)) continue;
        flood[n][0] = flood[n][1] = 0.0;
        flood[n++][2] = z;
    }
}

static bvx_status weld_flood(void *user, bvx_context *context)
{
    bvx_mesh_view v;
    uint64_t different;
    memset(&v, 0, sizeof v);
    v.positions = flood;
    v.vertex_count = *(const uint64_t *)user;
    v.position_type = BVX_F64;
    return bvxi_weld(context, &v, flood_numbers, &different);
}

/* The table gives up, which is the second allocation; each vertex comes
 * twice. Searched to its end the table would take 10^10 steps. */
static void test_positions_made_against_the_hash(void)
{
    uint64_t allocations = 0, count = FLOOD;

    flood = malloc(sizeof *flood * FLOOD);
    flood_numbers = malloc(sizeof *flood_numbers * FLOOD);
    TEST_ASSERT_TRUE(flood != NULL && flood_numbers != NULL);
    make_flood();
    memcpy(flood + FLOOD / 2, flood, sizeof *flood * FLOOD / 2);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, weld_flood(&count, ctx));
    for (uint64_t i = 0; i < FLOOD; i++) TEST_ASSERT_EQUAL_UINT64(i % (FLOOD / 2), flood_numbers[i]);
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
    TEST_ASSERT_NULL(fault_every_allocation(weld_flood, &count, NULL, &allocations));
    TEST_ASSERT_EQUAL_UINT64(2, allocations);
    free(flood);
    free(flood_numbers);
}

/* ---- the tree itself ---- */

typedef struct keyed {
    uint32_t key[3];
} keyed;

static void key_of(const void *user, uint64_t number, uint32_t key[BVXI_KEY_WORDS])
{
    memcpy(key, ((const keyed *)user)[number].key, 12);
}

/* Keys that share ever longer beginnings lie deepest: no search looks at
 * more nodes than a key of three words has bits, and one. */
static void test_no_key_lies_deep(void)
{
    static keyed k[4000];
    bvxi_key_tree tree;
    uint64_t seed = 5;

    memset(k, 0, sizeof k);
    for (int i = 0; i < 4000; i++) {
        if (i < 96) k[i].key[i / 32] = UINT32_C(1) << i % 32; /* nested beginnings of zeros */
        else k[i].key[2] = (uint32_t)maker_below(&seed, 1 << 15) << 16;
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_key_tree_open(ctx, &tree, key_of, k, 2000));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_key_tree_grow(ctx, &tree, 4000));
    for (uint64_t i = 0; i < 4000; i++) {
        uint64_t const before = tree.steps;
        uint64_t least = 0;
        while (memcmp(&k[least], &k[i], sizeof k[i]) != 0) least++;
        TEST_ASSERT_EQUAL_UINT64(least, bvxi_key_tree_find(&tree, i));
        TEST_ASSERT_TRUE(tree.steps - before <= 97);
    }
    bvxi_key_tree_close(ctx, &tree);
    bvxi_key_tree_close(ctx, &tree);
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_weld_finds_the_least_vertex_at_each_position);
    RUN_TEST(test_weld_joins_nothing_that_differs);
    RUN_TEST(test_every_allocation_may_fail);
    RUN_TEST(test_many_vertices_can_be_cancelled);
    RUN_TEST(test_positions_made_against_the_hash);
    RUN_TEST(test_no_key_lies_deep);
    return UNITY_END();
}
