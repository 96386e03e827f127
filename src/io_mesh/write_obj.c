/* write_obj.c - a mesh to Wavefront OBJ.
 *
 * Numbers are the shortest decimals that read back to the same floats, or doubles where the mesh has doubles
 * or a frame. Colours follow the coordinates as fractions of 1, without alpha, which the format does not
 * know. Normals, where requested, are one a vertex, with its index. */
#include "io/file_parts.h"
#include "io_mesh/mesh_formats.h"
#include "mesh/facet.h"

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
    const bvx_mesh *const mesh = ((const bvxi_written *)user)->mesh;
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
    const bvx_mesh *const mesh = ((const bvxi_written *)user)->mesh;

    for (uint64_t i = begin; i < end; i++) {
        *at++ = 'v';
        *at++ = 't';
        for (size_t a = 0; a < 2; a++)
            at = bvxi_put_float(bvxi_put_char(at, ' '), mesh->uvs[(size_t)i * 2 + a]);
        *at++ = '\n';
    }
    return at;
}

static uint8_t *obj_put_normals(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_written *const what = user;
    float n[3];

    for (uint64_t v = begin; v < end; v++) {
        *at++ = 'v';
        *at++ = 'n';
        bvxi_unit_normal(what->normal + (size_t)v * 3, n);
        for (int a = 0; a < 3; a++) at = bvxi_put_float(bvxi_put_char(at, ' '), n[a]);
        *at++ = '\n';
    }
    return at;
}

/* A corner is v, v/vt, v//vn or v/vt/vn. */
static uint8_t *obj_put_faces(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_written *const what = user;
    const bvx_mesh *const mesh = what->mesh;
    const uint32_t *const uv = mesh->uv_triangles != NULL ? mesh->uv_triangles : mesh->triangles;

    for (uint64_t t = begin; t < end; t++) {
        *at++ = 'f';
        for (size_t i = (size_t)t * 3; i < (size_t)t * 3 + 3; i++) {
            at = bvxi_put_number(bvxi_put_char(at, ' '), (uint64_t)mesh->triangles[i] + 1);
            if (mesh->uvs != NULL) at = bvxi_put_number(bvxi_put_char(at, '/'), (uint64_t)uv[i] + 1);
            if (what->normal == NULL) continue;
            if (mesh->uvs == NULL) *at++ = '/';
            at = bvxi_put_number(bvxi_put_char(at, '/'), (uint64_t)mesh->triangles[i] + 1);
        }
        *at++ = '\n';
    }
    return at;
}

bvx_status bvxi_write_obj(bvx_context *ctx, const bvxi_written *what, bvx_buffer *file)
{
    static const char title[] = "# OBJ written by bitvox\n";
    const bvx_mesh *const mesh = what->mesh;
    uint64_t const number = bvxi_writes_f32(mesh) ? BVXI_FLOAT_MOST : BVXI_DOUBLE_MOST;
    uint64_t const vertex_digits = bvxi_digits(mesh->vertex_count);
    double const from = what->normal != NULL ? BVXI_NORMALS_SHARE : 0.0;
    bvxi_file_part part[4] = {{.put = obj_put_vertices, .user = what},
                              {.put = obj_put_uvs, .user = what},
                              {.put = obj_put_normals, .user = what},
                              {.put = obj_put_faces, .user = what}};

    part[0].count = mesh->vertex_count;
    part[0].most = 2 + 3 * (1 + number) + (mesh->colours != NULL ? 3 * 6 : 0);
    part[1].count = bvxi_written_uvs(mesh);
    part[1].most = 3 + 2 * (1 + BVXI_FLOAT_MOST);
    part[2].count = what->normal != NULL ? mesh->vertex_count : 0;
    part[2].most = 3 + 3 * (1 + BVXI_FLOAT_MOST);
    part[3].count = mesh->triangle_count;
    part[3].most = 2 + 3 * (1 + vertex_digits);
    if (mesh->uvs != NULL) part[3].most += 3 * (1 + bvxi_digits(part[1].count));
    if (what->normal != NULL) part[3].most += 3 * (2 + vertex_digits); /* two slashes without a texture */

    BVXI_TRY(bvxi_make_file(ctx, "the OBJ file", from, sizeof title - 1, part, 4, file));
    memcpy(file->bytes, title, sizeof title - 1);
    return BVX_OK;
}
