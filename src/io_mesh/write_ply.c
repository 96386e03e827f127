/* write_ply.c - a mesh to binary little-endian PLY: floats, or doubles where the mesh has doubles or a frame.
 *
 * Normals, where requested, are the floats nx ny nz of vertices, after the coordinates as readers expect
 * them. Colours are the properties red green blue alpha of vertices, texture coordinates s t of vertices, or
 * the list texcoord of faces (two numbers a corner) where the corners have their own. */
#include "io/file_parts.h"
#include "io_mesh/mesh_formats.h"
#include "mesh/facet.h"

/* how many there are and the numbers: three, six */
enum { PLY_WRITTEN_FACE = 13, PLY_WRITTEN_TEXCOORD = 25 };

static void ply_put_property(const char *type, const char *const *names, int count, bvxi_output *out)
{
    for (int i = 0; i < count; i++) {
        bvxi_output_text(out, "property ");
        bvxi_output_text(out, type);
        bvxi_output_text(out, " ");
        bvxi_output_text(out, names[i]);
        bvxi_output_text(out, "\n");
    }
}

static void ply_put_header(const bvxi_written *what, bvxi_output *out)
{
    const bvx_mesh *const mesh = what->mesh;
    static const char *const axes[] = {"x", "y", "z"}, *const normal[] = {"nx", "ny", "nz"};
    static const char *const colours[] = {"red", "green", "blue", "alpha"};
    static const char *const uvs[] = {"s", "t"};
    static const char *const corners[] = {"vertex_indices"};
    static const char *const texcoord[] = {"texcoord"};

    /* Properties stand in the order in which ply_put_vertices and ply_put_faces write the values. */
    bvxi_output_text(out, "ply\nformat binary_little_endian 1.0\ncomment written by bitvox\nelement vertex ");
    bvxi_output_number(out, mesh->vertex_count);
    bvxi_output_text(out, "\n");
    ply_put_property(bvxi_writes_f32(mesh) ? "float" : "double", axes, 3, out);
    if (what->normal != NULL) ply_put_property("float", normal, 3, out);
    if (mesh->colours != NULL) ply_put_property("uchar", colours, 4, out);
    if (mesh->uvs != NULL && mesh->uv_triangles == NULL) ply_put_property("float", uvs, 2, out);
    bvxi_output_text(out, "element face ");
    bvxi_output_number(out, mesh->triangle_count);
    bvxi_output_text(out, "\n");
    /* Many readers know only the type int; uint is there for meshes that need it. */
    ply_put_property(mesh->vertex_count > INT32_MAX ? "list uchar uint" : "list uchar int", corners, 1, out);
    if (mesh->uv_triangles != NULL) ply_put_property("list uchar float", texcoord, 1, out);
    bvxi_output_text(out, "end_header\n");
}

static uint8_t *ply_put_vertices(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvxi_written *const what = user;
    const bvx_mesh *const mesh = what->mesh;
    int const f32 = bvxi_writes_f32(mesh), uvs = mesh->uvs != NULL && mesh->uv_triangles == NULL;
    double world[3];
    float normal[3];

    for (uint64_t v = begin; v < end; v++) {
        /* The order of values in a row is that of the properties in the header. */
        bvxi_world_position(mesh, v, world);
        for (int a = 0; a < 3; a++, at += f32 ? 4 : 8) {
            if (f32) bvxi_store_f32(at, (float)world[a]);
            else bvxi_store_f64(at, world[a]);
        }

        /* The sum becomes a unit vector here, so no array of floats is kept beside it. */
        if (what->normal != NULL) {
            bvxi_unit_normal(what->normal + (size_t)v * 3, normal);
            for (int a = 0; a < 3; a++, at += 4) bvxi_store_f32(at, normal[a]);
        }
        if (mesh->colours != NULL) {
            memcpy(at, mesh->colours + (size_t)v * 4, 4);
            at += 4;
        }
        if (uvs) {
            bvxi_store_f32(at, mesh->uvs[(size_t)v * 2]);
            bvxi_store_f32(at + 4, mesh->uvs[(size_t)v * 2 + 1]);
            at += 8;
        }
    }
    return at;
}

static uint8_t *ply_put_faces(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    const bvx_mesh *const mesh = ((const bvxi_written *)user)->mesh;

    for (uint64_t t = begin; t < end; t++) {
        *at++ = 3;
        for (size_t k = 0; k < 3; k++, at += 4) bvxi_store_u32(at, mesh->triangles[(size_t)t * 3 + k]);
        if (mesh->uv_triangles == NULL) continue;
        /* A list of six numbers: the texture coordinates of three corners. */
        *at++ = 6;
        for (size_t k = 0; k < 3; k++, at += 8) {
            const float *const uv = mesh->uvs + (size_t)mesh->uv_triangles[(size_t)t * 3 + k] * 2;
            bvxi_store_f32(at, uv[0]);
            bvxi_store_f32(at + 4, uv[1]);
        }
    }
    return at;
}

bvx_status bvxi_write_ply(bvx_context *ctx, const bvxi_written *what, bvx_buffer *file)
{
    const bvx_mesh *const mesh = what->mesh;
    double const from = what->normal != NULL ? BVXI_NORMALS_SHARE : 0.0;
    bvxi_file_part part[2] = {{.put = ply_put_vertices, .user = what}, {.put = ply_put_faces, .user = what}};
    bvxi_output head = {0};

    ply_put_header(what, &head);
    /* All rows have one size, so nothing has to be pushed together afterwards. */
    part[0].count = mesh->vertex_count;
    part[0].most = bvxi_writes_f32(mesh) ? 12 : 24;
    if (what->normal != NULL) part[0].most += 12;
    if (mesh->colours != NULL) part[0].most += 4;
    if (mesh->uvs != NULL && mesh->uv_triangles == NULL) part[0].most += 8;
    part[1].count = mesh->triangle_count;
    part[1].most = PLY_WRITTEN_FACE + (mesh->uv_triangles != NULL ? PLY_WRITTEN_TEXCOORD : 0);
    BVXI_TRY(bvxi_make_file(ctx, "the PLY file", from, head.size, part, 2, file));

    /* The head is made twice, to learn its size and to write it: so it needs no memory of its own. */
    head.bytes = file->bytes;
    head.size = 0;
    ply_put_header(what, &head);
    return BVX_OK;
}
