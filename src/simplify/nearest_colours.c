/* nearest_colours.c - colours for a surface measured from a mesh: those of
 * the mesh's nearest points, blended by their weights. */
#include "mesh/view.h"
#include "simplify/room.h"

enum { NEAREST_BLOCK = 256 };

static void blend_nearest(const bvx_mesh_view *mesh, const bvx_closest_point *at, uint8_t *to)
{
    uint32_t corner[3];

    bvxi_view_triangle(mesh, at->triangle, corner);
    for (int i = 0; i < 4; i++) {
        double sum = 0.5;

        for (int k = 0; k < 3; k++) sum += at->weight[k] * mesh->colours[4 * (size_t)corner[k] + (size_t)i];
        to[i] = (uint8_t)(sum >= 255.0 ? 255 : (int32_t)sum);
    }
}

static bvx_status blend_all(bvx_context *ctx, const bvx_closest *closest, const bvx_mesh_view *mesh,
                            const bvx_mesh_view *surface, uint8_t *colours)
{
    bvx_closest_point found[NEAREST_BLOCK];
    double p[3 * NEAREST_BLOCK];

    for (uint64_t first = 0; first < surface->vertex_count; first += NEAREST_BLOCK) {
        uint64_t const left = surface->vertex_count - first;
        uint64_t const count = left < NEAREST_BLOCK ? left : NEAREST_BLOCK;

        for (uint64_t i = 0; i < count; i++) bvxi_view_position(surface, first + i, p + 3 * i);
        BVXI_TRY(bvx_closest_find(ctx, closest, p, count, found));
        for (uint64_t i = 0; i < count; i++) blend_nearest(mesh, &found[i], colours + 4 * (first + i));
    }
    return BVX_OK;
}

bvx_status bvxi_nearest_colours(bvx_context *ctx, const bvx_mesh_view *mesh, const bvx_mesh_view *surface,
                                uint8_t *colours)
{
    bvx_closest *closest = NULL;
    bvx_status status;

    BVXI_TRY(bvx_closest_create(ctx, mesh, &closest));
    status = blend_all(ctx, closest, mesh, surface, colours);
    bvx_closest_free(ctx, closest);
    return status;
}
