/* test_voxel_normal.c - normals from the voxels around, against a walk over the ball voxel by voxel. */
#include "render_support.h"

#include "render/raster.h"

static int is_set(const bvx_grid *g, const bvx_grid *also, int32_t x, int32_t y, int32_t z)
{
    if (x < 0 || y < 0 || z < 0 || x >= g->size[0] || y >= g->size[1] || z >= g->size[2]) return 0;
    return bvx_grid_get(g, x, y, z) || bvx_grid_get(also, x, y, z);
}

static void test_voxel_normal_sums_the_ball(void)
{
    static const int32_t widths[5] = {1, 7, 64, 65, 133};
    static const double spacing[3] = {1, 0.5, 0.25};

    random_state = 1;
    for (int w = 0; w < 5; w++)
        for (int two = 0; two < 2; two++) {
            bvx_grid g = grid_of(widths[w], 9, 8, spacing), h = grid_of(widths[w], 9, 8, spacing);
            scatter(&g, 30);
            scatter(&h, 30);
            for (int32_t z = 0; z < 8; z++)
                for (int32_t y = 0; y < 9; y++)
                    for (int32_t x = 0; x < widths[w]; x++) {
                        double sum[3] = {0, 0, 0}, n[3];
                        for (int32_t c = -3; c <= 3; c++)
                            for (int32_t b = -3; b <= 3; b++)
                                for (int32_t a = -3; a <= 3; a++)
                                    if (a * a + b * b + c * c <= 13 &&
                                        is_set(&g, two ? &h : &g, x + a, y + b, z + c)) {
                                        sum[0] -= a;
                                        sum[1] -= b;
                                        sum[2] -= c;
                                    }
                        bvxi_voxel_normal(&g, two ? h.words : g.words, spacing, x, y, z, n);
                        for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(n[a] == sum[a] * spacing[a]);
                    }
            bvx_grid_free(ctx, &h);
            bvx_grid_free(ctx, &g);
        }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_voxel_normal_sums_the_ball);
    return UNITY_END();
}
