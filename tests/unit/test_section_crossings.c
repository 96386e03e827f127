/* test_section_crossings.c - do triangles of bodies from sections cross?
 * All pairs of small random stacks, in whole numbers. */
#include "tools/crossing_oracle.h"
#include "tools/section_maker.h"
#include "suite.h"

#include <stdlib.h>

static section_maker stack;
static bvx_sections_report report;

void setUp(void)
{
    suite_open(0);
}

void tearDown(void)
{
    suite_close();
}

/* A random stack with coordinates in [1, 16), on a grid of random size; 0
 * when its loops cross or the body is large. */
static int random_body(uint64_t *seed, int32_t crossings, int32_t caps, int cells, bvx_mesh *mesh)
{
    bvx_sections_options o = {.struct_size = sizeof o};

    stack_random(&stack, seed);
    for (uint64_t i = 0; i < 3 * stack.s.point_count; i++) stack.point[i] += 4.0;
    for (uint64_t i = 0; i < stack.s.section_count; i++) stack.position[i] += 4.0;
    o.report = &report;
    o.slabs.crossings = crossings;
    o.caps = caps;
    o.slabs.grid[0] = cells + maker_below(seed, cells);
    o.slabs.grid[1] = cells + maker_below(seed, cells);
    if (bvx_build_sections(ctx, &stack.s, &o, mesh) != BVX_OK) return 0;
    if (mesh->triangle_count < 6000) return 1;
    bvx_mesh_free(ctx, mesh);
    return 0;
}

static uint64_t count_crossings(const bvx_mesh *mesh)
{
    const char *wrong;
    uint64_t const n = crossing_count(mesh, 4503599627370496.0, &wrong);
    if (wrong != NULL) TEST_FAIL_MESSAGE(wrong);
    return n;
}

/* Where all is kept, no pair of triangles crosses in nearly all bodies. */
static void test_triangles_do_not_cross_where_all_is_kept(void)
{
    static const int cells[] = {3, 6, 12, 24};
    int const rounds = quick ? 2 : 40;
    uint64_t seed = 21, kept = 0, unkept = 0, crossed[2] = {0, 0};

    for (int i = 0; i < 4; i++)
        for (int n = 0; n < rounds;) {
            bvx_mesh mesh = {0};
            if (!random_body(&seed, BVX_CROSSINGS_EXACT, i & 1 ? BVX_CAPS_TAPER : BVX_CAPS_FLAT, cells[i],
                             &mesh))
                continue;
            n++;
            if (report.unkept_edges + report.unkept_loops != 0) {
                unkept++;
                crossed[0] += count_crossings(&mesh) != 0;
            } else {
                kept++;
                crossed[1] += count_crossings(&mesh) != 0;
            }
            bvx_mesh_free(ctx, &mesh);
        }
    /* the cases did occur */
    if (rounds == 40) TEST_ASSERT_TRUE(kept > 80 && unkept > 20 && crossed[0] > 10);
    TEST_ASSERT_TRUE(crossed[1] * 30 <= kept);
}

/* Marching cubes alone: tapered, so that no flat cap of points in line is in the way. */
static void test_triangles_of_the_classic_way_do_not_cross(void)
{
    int const rounds = quick ? 2 : 40;
    uint64_t seed = 9;

    for (int n = 0; n < rounds;) {
        bvx_mesh mesh = {0};
        if (!random_body(&seed, BVX_CROSSINGS_CLASSIC, BVX_CAPS_TAPER, 8, &mesh)) continue;
        n++;
        TEST_ASSERT_EQUAL_UINT64(0, count_crossings(&mesh));
        bvx_mesh_free(ctx, &mesh);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_triangles_do_not_cross_where_all_is_kept);
    RUN_TEST(test_triangles_of_the_classic_way_do_not_cross);
    return UNITY_END();
}
