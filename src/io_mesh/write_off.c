/* write_off.c - a mesh to OFF, or COFF where its vertices have colours: red, green, blue, alpha from 0 to
 * 255.
 *
 * Coordinates are the shortest decimals that read back to the same floats, or doubles where the mesh has
 * doubles or a frame. Texture coordinates are left out: few programs read those of STOFF, and corners cannot
 * have their own. */
#include "io/file_parts.h"
#include "io_mesh/mesh_formats.h"

static uint8_t *off_put_vertices(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvx_mesh *const mesh = user;
    int const f32 = bvxi_writes_f32(mesh);
    double p[3];

    for (uint64_t v = begin; v < end; v++) {
        bvxi_world_position(mesh, v, p);
        for (int a = 0; a < 3; a++) {
            if (a > 0) *at++ = ' ';
            at = f32 ? bvxi_put_float(at, (float)p[a]) : bvxi_put_double(at, p[a]);
        }
        if (mesh->colours != NULL)
            for (size_t c = 0; c < 4; c++)
                at = bvxi_put_number(bvxi_put_char(at, ' '), mesh->colours[(size_t)v * 4 + c]);
        *at++ = '\n';
    }
    return at;
}

static uint8_t *off_put_faces(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvx_mesh *const mesh = user;
    for (uint64_t t = begin; t < end; t++) {
        *at++ = '3';
        for (size_t k = 0; k < 3; k++)
            at = bvxi_put_number(bvxi_put_char(at, ' '), mesh->triangles[(size_t)t * 3 + k]);
        *at++ = '\n';
    }
    return at;
}

static void off_put_head(const bvx_mesh *mesh, bvxi_output *out)
{
    bvxi_output_text(out, mesh->colours != NULL ? "COFF\n" : "OFF\n");
    bvxi_output_number(out, mesh->vertex_count);
    bvxi_output_text(out, " ");
    bvxi_output_number(out, mesh->triangle_count);
    bvxi_output_text(out, " 0\n");
}

bvx_status bvxi_write_off(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file)
{
    uint64_t const number = bvxi_writes_f32(mesh) ? BVXI_FLOAT_MOST : BVXI_DOUBLE_MOST;
    bvxi_file_part part[2] = {{.put = off_put_vertices, .user = mesh}, {.put = off_put_faces, .user = mesh}};
    bvxi_output head = {0};

    off_put_head(mesh, &head);
    part[0].count = mesh->vertex_count;
    part[0].most = 3 * (number + 1) + (mesh->colours != NULL ? 4 * 4 : 0);
    part[1].count = mesh->triangle_count;
    part[1].most = 2 + 3 * (1 + bvxi_digits(mesh->vertex_count - 1));
    BVXI_TRY(bvxi_make_file(ctx, "the OFF file", 0.0, head.size, part, 2, file));
    head.bytes = file->bytes;
    head.size = 0;
    off_put_head(mesh, &head);
    return BVX_OK;
}
