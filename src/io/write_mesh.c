/* write_mesh.c - a mesh to the bytes of a file: the checks around the writers, and what they share. */
#include "io/formats.h"
#include "mesh/view.h"

bvx_status bvxi_make_buffer(bvx_context *ctx, uint64_t size, const char *what, bvx_buffer *file)
{
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, size, what, &file->bytes));
    file->size = file->capacity = size;
    return BVX_OK;
}

/* All positions in the world must be finite, also with the frame added. */
static bvx_status check_written_positions(bvx_context *ctx, const char *function, const bvx_mesh *mesh)
{
    double p[3];
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        bvxi_world_position(mesh, v, p);
        for (int a = 0; a < 3; a++)
            if (!(p[a] - p[a] == 0.0))
                return bvxi_fail(ctx, BVX_ERR_RANGE, "%s: vertex %u is not finite when mesh.frame is added", function,
                                 v);
    }
    return BVX_OK;
}

static bvx_status check_written_mesh(bvx_context *ctx, const char *function, const bvx_mesh *mesh)
{
    bvx_mesh_view view;
    double low[3], high[3];
    if (mesh->triangle_count != 0 && mesh->triangles == NULL)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: mesh.triangles is NULL", function);
    if (mesh->position_type != BVX_F32 && mesh->position_type != BVX_F64 && mesh->vertex_count != 0)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: mesh.position_type is %d, not BVX_F32 (1) or BVX_F64 (2)",
                         function, (int64_t)mesh->position_type);
    bvx_mesh_view_of(mesh, &view);
    BVXI_TRY(bvxi_view_check(ctx, function, &view));
    BVXI_TRY(bvxi_view_bounds(ctx, function, &view, low, high));
    return check_written_positions(ctx, function, mesh);
}

bvx_status bvx_write_mesh(bvx_context *context, const bvx_mesh *mesh, int32_t format, bvx_buffer *file)
{
    static const char *const function = "bvx_write_mesh";
    bvx_buffer made = {0};
    bvx_status status;
    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (mesh == NULL) return bvxi_fail_null(context, function, "mesh");
    if (file == NULL) return bvxi_fail_null(context, function, "file");
    if (file->bytes != NULL)
        return bvxi_fail(context, BVX_ERR_ARGUMENT, "%s: file holds bytes already; free or zero it first", function);
    if (format != BVX_FORMAT_STL && format != BVX_FORMAT_OBJ && format != BVX_FORMAT_PLY)
        return bvxi_fail(context, BVX_ERR_UNSUPPORTED, "%s: format %d holds no mesh; take STL, OBJ or PLY", function,
                         (int64_t)format);
    BVXI_TRY(check_written_mesh(context, function, mesh));
    switch (format) {
    case BVX_FORMAT_STL: status = bvxi_write_stl(context, mesh, &made); break;
    case BVX_FORMAT_OBJ: status = bvxi_write_obj(context, mesh, &made); break;
    default: status = bvxi_write_ply(context, mesh, &made); break;
    }
    if (status == BVX_OK) *file = made;
    return status;
}
