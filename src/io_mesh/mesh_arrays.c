/* mesh_arrays.c - the arrays of a mesh that is read, made in exact sizes; colours and texture coordinates
 * that not all of the mesh has are dropped again. */
#include "io_mesh/mesh_formats.h"

bvx_status bvxi_make_positions(bvx_context *ctx, bvx_mesh *mesh, int32_t type, uint64_t count)
{
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, count * (type == BVX_F64 ? 24 : 12), "the vertices of the file",
                        &mesh->positions));
    mesh->position_type = type;
    mesh->vertex_count = mesh->vertex_capacity = count;
    mesh->owned = 1;
    return BVX_OK;
}

bvx_status bvxi_make_triangles(bvx_context *ctx, bvx_mesh *mesh, uint64_t count)
{
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, count * 12, "the triangles of the file", &mesh->triangles));
    mesh->triangle_count = mesh->triangle_capacity = count;
    mesh->owned = 1;
    return BVX_OK;
}

bvx_status bvxi_make_array(bvx_context *ctx, bvx_mesh *mesh, uint32_t array)
{
    struct {
        uint32_t array;
        void *block; /* where its address goes */
        uint64_t count, bytes;
        const char *what;
    } const made[] = {
        {BVXI_MESH_COLOURS, &mesh->colours, mesh->vertex_capacity, 4, "the colours of the file"},
        {BVXI_MESH_UV_TRIANGLES, &mesh->uv_triangles, mesh->triangle_capacity, 12,
         "the texture numbers of the file"},
        {BVXI_MESH_NORMALS, &mesh->normals, mesh->vertex_capacity, 12, "the normals of the file"},
        {BVXI_MESH_UVS2, &mesh->uvs2, mesh->vertex_capacity, 8, "the second texture coordinates of the file"},
        {BVXI_MESH_MATERIALS, &mesh->materials, mesh->triangle_capacity, 4,
         "the material indices of the file"},
    };
    size_t i = 0;

    while (made[i].array != array) i++;
    return bvxi_alloc(ctx, BVXI_RESULT, made[i].count * made[i].bytes, made[i].what, made[i].block);
}

bvx_status bvxi_make_uvs(bvx_context *ctx, bvx_mesh *mesh, uint64_t count)
{
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, count * 8, "the texture coordinates of the file", &mesh->uvs));
    mesh->uv_count = count;
    return BVX_OK;
}

void bvxi_drop_uvs(bvx_context *ctx, bvx_mesh *mesh)
{
    bvxi_mesh_release(ctx, mesh, BVXI_MESH_UV_TRIANGLES | BVXI_MESH_UVS);
    mesh->uv_count = 0;
}

int bvxi_mesh_is_empty(const bvx_mesh *m)
{
    return m->positions == NULL && m->triangles == NULL && m->vertex_keys == NULL &&
           m->triangle_keys == NULL && !bvxi_mesh_has_attributes(m);
}
