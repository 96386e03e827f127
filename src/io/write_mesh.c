/* write_mesh.c - a mesh to the bytes of a file: the checks around the writers, and what they share. */
#include "io/formats.h"
#include "mesh/mesh.h"
#include "mesh/view.h"

bvx_status bvxi_make_buffer(bvx_context *ctx, uint64_t size, const char *what, bvx_buffer *file)
{
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, size, what, &file->bytes));
    file->size = file->capacity = size;
    return BVX_OK;
}

/* All positions are finite; they must be so with the frame added. */
static bvx_status check_written_positions(bvx_context *ctx, const char *function, const bvx_mesh *mesh)
{
    double p[3];
    if (mesh->frame[0] == 0.0 && mesh->frame[1] == 0.0 && mesh->frame[2] == 0.0) return BVX_OK;
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        bvxi_world_position(mesh, v, p);
        for (int a = 0; a < 3; a++)
            if (!(p[a] - p[a] == 0.0))
                return bvxi_fail(ctx, BVX_ERR_RANGE, "%s: vertex %u is not finite when mesh.frame is added", function,
                                 v);
    }
    return BVX_OK;
}

static bvx_status check_written_uvs(bvx_context *ctx, const char *function, const bvx_mesh *mesh)
{
    if (mesh->uvs == NULL) {
        if (mesh->uv_triangles != NULL || mesh->uv_count != 0)
            return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: mesh.uvs is NULL beside %s", function,
                             mesh->uv_triangles != NULL ? "uv_triangles" : "a uv_count above 0");
        return BVX_OK;
    }
    if (mesh->uv_count > UINT32_MAX)
        return bvxi_fail(ctx, BVX_ERR_RANGE, "%s: mesh.uv_count is %u, the limit is below 2^32", function, mesh->uv_count);
    if (mesh->uv_triangles == NULL && mesh->uv_count < mesh->vertex_count)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: mesh.uv_count is %u for %u vertices, and uv_triangles is NULL",
                         function, mesh->uv_count, mesh->vertex_count);
    if (mesh->uv_triangles != NULL)
        for (size_t i = 0; i < (size_t)mesh->triangle_count * 3; i++)
            if (mesh->uv_triangles[i] >= mesh->uv_count)
                return bvxi_fail(ctx, BVX_ERR_RANGE, "%s: triangle %u has texture coordinate number %u, there are %u",
                                 function, (uint64_t)(i / 3), (uint64_t)mesh->uv_triangles[i], mesh->uv_count);
    for (size_t i = 0; i < (size_t)bvxi_written_uvs(mesh) * 2; i++)
        if (!(mesh->uvs[i] - mesh->uvs[i] == 0.0f))
            return bvxi_fail(ctx, BVX_ERR_RANGE, "%s: texture coordinate %u is not finite", function, (uint64_t)(i / 2));
    return BVX_OK;
}

static bvx_status check_written_mesh(bvx_context *ctx, const char *function, const bvx_mesh *mesh)
{
    bvx_mesh_view view;
    double low[3], high[3];
    BVXI_TRY(bvxi_mesh_check_reserved(ctx, function, mesh));
    if (mesh->triangle_count != 0 && mesh->triangles == NULL)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: mesh.triangles is NULL", function);
    if (mesh->position_type != BVX_F32 && mesh->position_type != BVX_F64 && mesh->vertex_count != 0)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: mesh.position_type is %d, not BVX_F32 (1) or BVX_F64 (2)",
                         function, (int64_t)mesh->position_type);
    bvx_mesh_view_of(mesh, &view);
    BVXI_TRY(bvxi_view_check(ctx, function, &view));
    BVXI_TRY(bvxi_view_bounds(ctx, function, &view, low, high));
    BVXI_TRY(check_written_positions(ctx, function, mesh));
    return check_written_uvs(ctx, function, mesh);
}

bvx_status bvx_write_mesh(bvx_context *context, const bvx_mesh *mesh, int32_t format, bvx_buffer *file)
{
    static const char *const function = "bvx_write_mesh";
    bvx_status (*write)(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file);
    bvx_buffer made = {0};
    if (context == NULL) return BVX_ERR_ARGUMENT;
    if (mesh == NULL) return bvxi_fail_null(context, function, "mesh");
    if (file == NULL) return bvxi_fail_null(context, function, "file");
    if (file->bytes != NULL)
        return bvxi_fail(context, BVX_ERR_ARGUMENT, "%s: file holds bytes already; free or zero it first", function);
    switch (format) {
    case BVX_FORMAT_STL: write = bvxi_write_stl; break;
    case BVX_FORMAT_OBJ: write = bvxi_write_obj; break;
    case BVX_FORMAT_PLY: write = bvxi_write_ply; break;
    case BVX_FORMAT_OFF: write = bvxi_write_off; break;
    case BVX_FORMAT_GLB: write = bvxi_write_glb; break;
    default:
        return bvxi_fail(context, BVX_ERR_UNSUPPORTED, "%s: format %d holds no mesh; take STL, OBJ, PLY, OFF or GLB",
                         function, (int64_t)format);
    }
    BVXI_TRY(check_written_mesh(context, function, mesh));
    BVXI_TRY(write(context, mesh, &made));
    *file = made;
    return BVX_OK;
}
