/* test_hash_floods.c - triangles and edges whose hashes were made to collide: the answers are those of any others, and a
 * tree, which is one allocation more, takes the table's place. */
#include "core/key_tree.h"
#include "mesh/topology.h"
#include "tools/fault.h"
#include "winding/holes.h"
#include "suite.h"

#include <stdlib.h>

enum { VERTICES = 24000, TRIANGLES = 12000 };

static uint32_t triangle[2 * TRIANGLES][3], identity[VERTICES], corner[2 * TRIANGLES][3];
static int32_t place[2 * TRIANGLES * 3][3];
static float nowhere[2 * TRIANGLES * 3][3];

typedef struct flood_case {
    bvx_mesh_view view;
    bvxi_snapped snapped;
    uint64_t found;
} flood_case;

void setUp(void)
{
    suite_open(0);
}

void tearDown(void)
{
    suite_close();
}

static flood_case case_of(uint64_t vertices, uint64_t triangles)
{
    flood_case c;

    memset(&c, 0, sizeof c);
    c.view.positions = nowhere;
    c.view.vertex_count = vertices;
    c.view.indices = triangle;
    c.view.triangle_count = triangles;
    c.view.index_type = BVX_U32;
    c.snapped.xyz = &place[0][0];
    c.snapped.vertex_count = vertices;
    return c;
}

typedef struct flood_call {
    fault_operation_fn *run;
    flood_case *of;
} flood_call;

/* As a public call does it, whose end takes back the scratch of what failed. */
static bvx_status run_as_call(void *user, bvx_context *context)
{
    const flood_call *const c = user;
    return BVXI_CALL(context, c->run(c->of, context));
}

/* Allocations of an operation, each of which may fail. */
static uint64_t allocations_of(fault_operation_fn *run, flood_case *c)
{
    flood_call call = {run, c};
    uint64_t allocations = 0;
    TEST_ASSERT_NULL(fault_every_allocation(run_as_call, &call, NULL, &allocations));
    return allocations;
}

/* ---- triangles ---- */

static uint64_t hash_of_triangle(uint32_t a, uint32_t b, uint32_t c)
{
    uint64_t h = ((uint64_t)a << 32 | b) * UINT64_C(0x9e3779b97f4a7c15);
    h = (h ^ h >> 32 ^ c) * UINT64_C(0xbf58476d1ce4e5b9);
    return (h ^ h >> 29) * UINT64_C(0x94d049bb133111eb) >> 33;
}

static bvx_status drop(void *user, bvx_context *context)
{
    flood_case *const c = user;
    return bvxi_drop_duplicates(context, &c->view, identity, &corner[0][0], &c->found);
}

/* The first triangles of all whose hashes are below a limit, and all of them again with their corners
 * turned. */
static void make_triangles(uint64_t limit)
{
    uint32_t const c = 2999;
    uint32_t n = 0;

    for (uint32_t a = 0; n < TRIANGLES; a++) {
        TEST_ASSERT_TRUE(a + 1 < c);
        for (uint32_t b = a + 1; b < c && n < TRIANGLES; b++) {
            if (hash_of_triangle(a, b, c) > limit) continue;
            triangle[n][0] = triangle[TRIANGLES + n][1] = a;
            triangle[n][1] = triangle[TRIANGLES + n][2] = b;
            triangle[n][2] = triangle[TRIANGLES + n][0] = c;
            n++;
        }
    }
}

static void test_triangles_made_against_the_hash(void)
{
    flood_case c = case_of(3000, 2 * TRIANGLES);

    for (uint32_t v = 0; v < VERTICES; v++) identity[v] = v;
    for (int flood = 0; flood < 2; flood++) {
        make_triangles(flood ? UINT64_C(0x7fffffff) / 320 : UINT64_MAX);
        TEST_ASSERT_EQUAL_UINT64(flood ? 2 : 1, allocations_of(drop, &c));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, drop(&c, ctx));
        TEST_ASSERT_EQUAL_UINT64(TRIANGLES, c.found);
        TEST_ASSERT_EQUAL_MEMORY(triangle, corner, sizeof corner / 2);
    }
}

/* ---- edges ---- */

static int by_value(const void *a, const void *b)
{
    uint64_t const x = *(const uint64_t *)a, y = *(const uint64_t *)b;
    return (x > y) - (x < y);
}

static bvx_status open_edges(void *user, bvx_context *context)
{
    flood_case *const c = user;
    uint64_t *edges = NULL, count = 0;
    bvx_status const status = bvxi_open_edges(context, &c->view, &c->snapped, 0, &edges, &count);

    if (status != BVX_OK) return status;
    c->found = 0;
    qsort(edges, (size_t)count, sizeof *edges, by_value);
    c->found = bvx_hash(edges, (size_t)count * sizeof *edges, count);
    bvxi_free(context, edges, count * 8);
    return BVX_OK;
}

/* Triangles of 200 corners with two each of those whose edges to it have
 * hashes that end in 0 bits but for some. */
static uint64_t make_edges(uint64_t bits)
{
    uint32_t n = 0, last = 0;

    for (uint32_t a = 0; a < 200; a++)
        for (uint32_t b = 200; b < VERTICES; b++) {
            uint64_t const h = ((uint64_t)a << 32 | b) * UINT64_C(0x9e3779b97f4a7c15);
            if (((h ^ h >> 32) & 65535 & bits) != 0) continue;
            if (last == 0) {
                last = b;
                continue;
            }
            if (n == TRIANGLES) return n;
            triangle[n][0] = a;
            triangle[n][1] = last;
            triangle[n++][2] = b;
            last = 0;
        }
    return n;
}

/* Some of the triangles have another one that runs the other way; what the
 * rest leaves open is all their edges. */
static void test_edges_made_against_the_hash(void)
{
    uint64_t plain = 0;

    for (int flood = 0; flood < 2; flood++) {
        uint64_t const n = make_edges(flood ? 0xff00 : 0), closed = n / 3;
        flood_case c = case_of(VERTICES, n + closed);
        uint64_t *const want = malloc(sizeof *want * (size_t)(3 * (n - closed))), count = 0;
        TEST_ASSERT_TRUE(want != NULL && n > 4000);
        for (uint64_t t = 0; t < closed; t++) {
            triangle[n + t][0] = triangle[t][1];
            triangle[n + t][1] = triangle[t][0];
            triangle[n + t][2] = triangle[t][2];
        }
        for (uint64_t t = closed; t < n; t++)
            for (int k = 0; k < 3; k++)
                want[count++] = (uint64_t)triangle[t][k] << 32 | triangle[t][(k + 1) % 3];
        qsort(want, (size_t)count, sizeof *want, by_value);
        /* On a parabola: no two edges lie on a line, where they would cancel. */
        for (uint32_t v = 0; v < VERTICES; v++) {
            place[v][0] = (int32_t)v;
            place[v][1] = (int32_t)(v * v);
            place[v][2] = 0;
        }
        uint64_t const allocations = allocations_of(open_edges, &c);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, open_edges(&c, ctx));
        TEST_ASSERT_EQUAL_HEX64(bvx_hash(want, (size_t)count * sizeof *want, count), c.found);
        if (!flood) plain = allocations;
        else TEST_ASSERT_TRUE(allocations > plain);
        free(want);
    }
}

/* ---- places ---- */

/* Triangles with corners of their own, each with one that runs the other way at the same places, which a tree finds
 * from the start. */
static void test_corners_of_their_own_meet_by_places(void)
{
    flood_case c = case_of(6 * TRIANGLES, 2 * TRIANGLES);

    for (uint32_t t = 0; t < 2 * TRIANGLES; t++)
        for (uint32_t k = 0; k < 3; k++) triangle[t][k] = t < TRIANGLES ? 3 * t + k : 3 * t + (2 - k);
    for (uint32_t v = 0; v < 6 * TRIANGLES; v++) {
        memset(place[v], 0, sizeof place[v]);
        place[v][0] = (int32_t)(v % (3 * TRIANGLES));
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, open_edges(&c, ctx));
    TEST_ASSERT_EQUAL_HEX64(bvx_hash(NULL, 0, 0), c.found);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_triangles_made_against_the_hash);
    RUN_TEST(test_edges_made_against_the_hash);
    RUN_TEST(test_corners_of_their_own_meet_by_places);
    return UNITY_END();
}
