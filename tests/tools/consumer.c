/* consumer.c - the smallest program of another project that shows the library linked: a tetrahedron's voxels,
 * counted. packaging.sh and test_install.sh build it outside this tree. */
#include <bitvox.h>
#include <stdio.h>
int main(void)
{
    static const float xyz[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    static const uint32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
    bvx_mesh_view view = {xyz, triangles, 4, 4, BVX_F32, 0, BVX_U32, 0, NULL, 0};
    bvx_context *ctx;
    bvx_lattice lattice;
    bvx_grid solid = {0};
    uint64_t set = 0;

    if (bvx_context_create(NULL, &ctx) != BVX_OK) return 1;
    if (bvx_lattice_fit(ctx, &view, 64, &lattice) != BVX_OK ||
        bvx_voxelize_solid(ctx, &view, &lattice, NULL, &solid) != BVX_OK)
        return 1;
    bvx_grid_count(ctx, &solid, &set);
    printf("%u\n", (unsigned)set);
    bvx_grid_free(ctx, &solid);
    bvx_context_destroy(ctx);
    return 0;
}
