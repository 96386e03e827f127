/* write_ply.c - a mesh to binary little-endian PLY: floats, or doubles where the mesh has doubles or a frame. */
#include "io/formats.h"

enum { PLY_WRITTEN_FACE = 13 }; /* the number 3 and three corners */

static void ply_put_header(const bvx_mesh *mesh, int f32, bvxi_output *out)
{
    static const char *const axes[3] = {" x\n", " y\n", " z\n"};
    bvxi_output_text(out, "ply\nformat binary_little_endian 1.0\ncomment written by bitvox\nelement vertex ");
    bvxi_output_number(out, mesh->vertex_count);
    bvxi_output_text(out, "\n");
    for (int a = 0; a < 3; a++) {
        bvxi_output_text(out, f32 ? "property float" : "property double");
        bvxi_output_text(out, axes[a]);
    }
    bvxi_output_text(out, "element face ");
    bvxi_output_number(out, mesh->triangle_count);
    bvxi_output_text(out, mesh->vertex_count > INT32_MAX ? "\nproperty list uchar uint vertex_indices\nend_header\n"
                                                         : "\nproperty list uchar int vertex_indices\nend_header\n");
}

static uint8_t *ply_put_vertices(const bvx_mesh *mesh, int f32, uint8_t *p)
{
    double world[3];
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        bvxi_world_position(mesh, v, world);
        for (int a = 0; a < 3; a++, p += f32 ? 4 : 8) {
            if (f32) bvxi_store_f32(p, (float)world[a]);
            else bvxi_store_f64(p, world[a]);
        }
    }
    return p;
}

static void ply_put_faces(const bvx_mesh *mesh, uint8_t *p)
{
    for (uint64_t t = 0; t < mesh->triangle_count; t++, p += PLY_WRITTEN_FACE) {
        p[0] = 3;
        for (size_t k = 0; k < 3; k++) bvxi_store_u32(p + 1 + 4 * k, mesh->triangles[(size_t)t * 3 + k]);
    }
}

bvx_status bvxi_write_ply(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file)
{
    int const f32 = bvxi_writes_f32(mesh);
    uint64_t const body = mesh->vertex_count * (f32 ? 12 : 24) + mesh->triangle_count * PLY_WRITTEN_FACE;
    bvxi_output out = {0};
    ply_put_header(mesh, f32, &out);
    BVXI_TRY(bvxi_make_buffer(ctx, out.size + body, "the PLY file", file));
    out.bytes = file->bytes;
    out.size = 0;
    ply_put_header(mesh, f32, &out);
    ply_put_faces(mesh, ply_put_vertices(mesh, f32, file->bytes + out.size));
    return BVX_OK;
}
