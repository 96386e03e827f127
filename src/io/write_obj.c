/* write_obj.c - a mesh to Wavefront OBJ.
 *
 * Numbers are the shortest decimals that read back to the same floats, or doubles where the mesh has doubles or a frame.
 * Colours follow the coordinates as fractions of 1, without alpha, which the format does not know. */
#include "io/file_parts.h"
#include "io/formats.h"

/* Three places, rounded up: programs that cut off and programs that round get the same byte back. */
static uint8_t *obj_put_colour(uint8_t *at, uint8_t value)
{
    uint32_t const thousandths = ((uint32_t)value * 1000 + 254) / 255;
    *at++ = ' ';
    if (thousandths == 0 || thousandths == 1000) return bvxi_put_number(at, thousandths / 1000);
    *at++ = '0';
    *at++ = '.';
    *at++ = (uint8_t)('0' + thousandths / 100);
    if (thousandths % 100 != 0) *at++ = (uint8_t)('0' + thousandths / 10 % 10);
    if (thousandths % 10 != 0) *at++ = (uint8_t)('0' + thousandths % 10);
    return at;
}

static uint8_t *obj_put_vertices(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvx_mesh *const mesh = user;
    int const f32 = bvxi_writes_f32(mesh);
    double p[3];
    for (uint64_t v = begin; v < end; v++) {
        *at++ = 'v';
        bvxi_world_position(mesh, v, p);
        for (int a = 0; a < 3; a++) {
            *at++ = ' ';
            at = f32 ? bvxi_put_float(at, (float)p[a]) : bvxi_put_double(at, p[a]);
        }
        if (mesh->colours != NULL)
            for (size_t c = 0; c < 3; c++) at = obj_put_colour(at, mesh->colours[(size_t)v * 4 + c]);
        *at++ = '\n';
    }
    return at;
}

static uint8_t *obj_put_uvs(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvx_mesh *const mesh = user;
    for (uint64_t i = begin; i < end; i++) {
        *at++ = 'v';
        *at++ = 't';
        for (size_t a = 0; a < 2; a++) at = bvxi_put_float(bvxi_put_char(at, ' '), mesh->uvs[(size_t)i * 2 + a]);
        *at++ = '\n';
    }
    return at;
}

static uint8_t *obj_put_faces(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvx_mesh *const mesh = user;
    const uint32_t *const uv = mesh->uv_triangles != NULL ? mesh->uv_triangles : mesh->triangles;
    for (uint64_t t = begin; t < end; t++) {
        *at++ = 'f';
        for (size_t i = (size_t)t * 3; i < (size_t)t * 3 + 3; i++) {
            at = bvxi_put_number(bvxi_put_char(at, ' '), (uint64_t)mesh->triangles[i] + 1);
            if (mesh->uvs != NULL) at = bvxi_put_number(bvxi_put_char(at, '/'), (uint64_t)uv[i] + 1);
        }
        *at++ = '\n';
    }
    return at;
}

bvx_status bvxi_write_obj(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file)
{
    static const char title[] = "# OBJ written by bitvox\n";
    uint64_t const number = bvxi_writes_f32(mesh) ? BVXI_FLOAT_MOST : BVXI_DOUBLE_MOST;
    bvxi_file_part part[3] = {{0, 0, obj_put_vertices}, {0, 0, obj_put_uvs}, {0, 0, obj_put_faces}};
    part[0].count = mesh->vertex_count;
    part[0].most = 2 + 3 * (1 + number) + (mesh->colours != NULL ? 3 * 6 : 0);
    part[1].count = bvxi_written_uvs(mesh);
    part[1].most = 3 + 2 * (1 + BVXI_FLOAT_MOST);
    part[2].count = mesh->triangle_count;
    part[2].most = 2 + 3 * (1 + bvxi_digits(mesh->vertex_count));
    if (mesh->uvs != NULL) part[2].most += 3 * (1 + bvxi_digits(part[1].count));
    BVXI_TRY(bvxi_make_file(ctx, "the OBJ file", 0.0, sizeof title - 1, part, 3, mesh, file));
    memcpy(file->bytes, title, sizeof title - 1);
    return BVX_OK;
}
