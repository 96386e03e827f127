/* test_section_crossings.c - do triangles of bodies from sections cross? All pairs of small random stacks, in whole numbers. */
#include "tools/crossing_oracle.h"
#include "tools/section_maker.h"
#include "unity.h"

#include <stdio.h>

static bvx_context *ctx;
static section_maker stack;

void setUp(void)
{
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(NULL, &ctx));
}

void tearDown(void)
{
    uint64_t const used = bvx_memory_used(ctx);
    bvx_context_destroy(ctx);
    TEST_ASSERT_EQUAL_UINT64(0, used);
}
static void test_x(void)
{
    for (int way = 0; way < 3; way++)
    for (int fineness = 0; fineness < 4; fineness++) {
        uint64_t seed = 21, bad = 0, badkept = 0, good = 0, pairs = 0, kept = 0, tri = 0;
        while (good < 60) {
            bvx_sections_options o;
            bvx_sections_report r;
            bvx_mesh mesh = {0};
            const char *wrong;
            stack_random(&stack, &seed);
            for (uint64_t i = 0; i < 3 * stack.s.point_count; i++) stack.point[i] += 4.0;
            for (uint64_t i = 0; i < stack.s.section_count; i++) stack.position[i] += 4.0;
            bvx_sections_options_init(&o, sizeof o);
            o.report = &r;
            o.crossings = way;
            int g = fineness == 0 ? 3 : fineness == 1 ? 6 : fineness == 2 ? 12 : 24;
            o.grid[0] = o.grid[1] = g + maker_below(&seed, g);
            o.caps = maker_below(&seed, 2);
            o.layers = 1 + maker_below(&seed, 2);
            if (bvx_build_sections(ctx, &stack.s, &o, &mesh) != BVX_OK) continue;
            if (mesh.triangle_count > 5000) { bvx_mesh_free(ctx, &mesh); continue; }
            uint64_t n = crossing_count(&mesh, 4503599627370496.0, &wrong);
            if (wrong) printf("%s\n", wrong);
            good++;
            tri += mesh.triangle_count;
            pairs += n;
            bad += n != 0;
            if (r.unkept_edges + r.unkept_loops == 0) { kept++; badkept += n != 0; }
            bvx_mesh_free(ctx, &mesh);
        }
        printf("way %d fine %d: %d stacks %d triangles, %d with crossings (%d pairs); of %d kept %d\n", way, fineness, (int)good, (int)tri, (int)bad, (int)pairs, (int)kept, (int)badkept);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_x);
    return UNITY_END();
}
