/* write_obj.c - a mesh to Wavefront OBJ.
 *
 * Coordinates are the shortest decimals that read back to the same floats, or doubles where the mesh has doubles or a
 * frame. The text is made twice: to count it, and to write it into memory of exactly that size. */
#include "io/formats.h"

static void obj_put_vertices(const bvx_mesh *mesh, bvxi_output *out)
{
    char text[3 * 32 + 4];
    double p[3];
    int const f32 = bvxi_writes_f32(mesh);
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        size_t n = 1;
        text[0] = 'v';
        bvxi_world_position(mesh, v, p);
        for (int a = 0; a < 3; a++) {
            text[n++] = ' ';
            n += (size_t)(f32 ? bvxi_print_float((float)p[a], text + n) : bvxi_print_double(p[a], text + n));
        }
        text[n++] = '\n';
        bvxi_output_add(out, text, n);
    }
}

static void obj_put_faces(const bvx_mesh *mesh, bvxi_output *out)
{
    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        bvxi_output_add(out, "f", 1);
        for (size_t k = 0; k < 3; k++) {
            bvxi_output_add(out, " ", 1);
            bvxi_output_number(out, (uint64_t)mesh->triangles[(size_t)t * 3 + k] + 1);
        }
        bvxi_output_add(out, "\n", 1);
    }
}

static void obj_put(const bvx_mesh *mesh, bvxi_output *out)
{
    bvxi_output_text(out, "# OBJ written by bitvox\n");
    obj_put_vertices(mesh, out);
    obj_put_faces(mesh, out);
}

bvx_status bvxi_write_obj(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file)
{
    bvxi_output out = {0};
    obj_put(mesh, &out);
    BVXI_TRY(bvxi_make_buffer(ctx, out.size, "the OBJ file", file));
    out.bytes = file->bytes;
    out.size = 0;
    obj_put(mesh, &out);
    return BVX_OK;
}
