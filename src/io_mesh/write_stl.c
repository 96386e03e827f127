/* write_stl.c - a mesh to binary STL, with the normals of its facets.
 *
 * Coordinates become floats; a normal is that of the rounded corners, computed in doubles, and zero for a
 * triangle without area. The header does not begin with the word solid, which some readers take for ASCII. */
#include "io/file_parts.h"
#include "io_mesh/mesh_formats.h"

#include <math.h>

enum { STL_WRITTEN_HEADER = 80, STL_WRITTEN_TRIANGLE = 50 };

static void stl_facet_normal(const float c[3][3], float normal[3])
{
    double u[3], v[3], n[3], length;

    /* In doubles of the rounded corners: the normal is that of the triangle that readers get. */
    for (int a = 0; a < 3; a++) {
        u[a] = (double)c[1][a] - (double)c[0][a];
        v[a] = (double)c[2][a] - (double)c[0][a];
    }
    for (int a = 0; a < 3; a++) n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
    length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    /* A triangle without area has no direction; zero is what readers expect then. */
    for (int a = 0; a < 3; a++) normal[a] = length > 0 ? (float)(n[a] / length) : 0.0f;
}

static void stl_corner(const bvx_mesh *mesh, int f32, size_t vertex, float corner[3])
{
    double world[3];
    if (f32) {
        memcpy(corner, (const uint8_t *)mesh->positions + 12 * vertex, 12);
        return;
    }
    bvxi_world_position(mesh, vertex, world);
    for (int a = 0; a < 3; a++) corner[a] = (float)world[a];
}

static void stl_put_triangle(const bvx_mesh *mesh, int f32, uint64_t t, uint8_t *p)
{
    float corner[3][3], normal[3];
    for (size_t k = 0; k < 3; k++) stl_corner(mesh, f32, mesh->triangles[(size_t)t * 3 + k], corner[k]);
    /* Normal, three corners, and two bytes of attributes, which are 0. */
    stl_facet_normal((const float(*)[3])corner, normal);
    for (int a = 0; a < 3; a++) bvxi_store_f32(p + 4 * a, normal[a]);
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) bvxi_store_f32(p + 12 + 12 * k + 4 * a, corner[k][a]);
    bvxi_store_u16(p + 48, 0);
}

static bvx_status stl_check_floats(bvx_context *ctx, const bvx_mesh *mesh)
{
    double p[3];

    /* Floats as they are need no check; others are compared once with the frame added. */
    if (bvxi_writes_f32(mesh)) return BVX_OK;
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        bvxi_world_position(mesh, v, p);
        for (int a = 0; a < 3; a++)
            if (p[a] >= BVXI_FLOAT_LIMIT || p[a] <= -BVXI_FLOAT_LIMIT)
                return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                     "STL: vertex %i has the coordinate %g, too large for the format's "
                                     "32-bit floats; take PLY or OBJ",
                                     v, p[a]);
    }
    return BVX_OK;
}

static uint8_t *stl_put_triangles(const void *user, uint64_t begin, uint64_t end, uint8_t *at)
{
    int const f32 = bvxi_writes_f32(user);
    for (uint64_t t = begin; t < end; t++, at += STL_WRITTEN_TRIANGLE) stl_put_triangle(user, f32, t, at);
    return at;
}

bvx_status bvxi_write_stl(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file)
{
    static const char title[] = "binary STL written by bitvox";
    bvxi_file_part const part = {
        .count = mesh->triangle_count, .most = STL_WRITTEN_TRIANGLE, .put = stl_put_triangles, .user = mesh};

    BVXI_TRY(stl_check_floats(ctx, mesh));
    /* Checked before memory is made: the message names a vertex rather than a broken file. */
    BVXI_TRY(bvxi_make_file(ctx, "the STL file", 0.0, STL_WRITTEN_HEADER + 4, &part, 1, file));
    memset(file->bytes, 0, STL_WRITTEN_HEADER);
    memcpy(file->bytes, title, sizeof title - 1);
    bvxi_store_u32(file->bytes + STL_WRITTEN_HEADER, (uint32_t)mesh->triangle_count);
    return BVX_OK;
}
