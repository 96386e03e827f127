/* write_stl.c - a mesh to binary STL, with the normals of its facets.
 *
 * Coordinates become floats; a normal is that of the rounded corners, computed in doubles, and zero for a triangle
 * without area. The header does not begin with the word solid, which some readers take for ASCII. */
#include "io/formats.h"

#include <math.h>

enum { STL_WRITTEN_HEADER = 80, STL_WRITTEN_TRIANGLE = 50 };

/* The least double that rounds to an infinite float: (2 - 2^-24) * 2^127. */
static const double stl_float_limit = 3.4028235677973366e38;

static void stl_facet_normal(const float c[3][3], float normal[3])
{
    double u[3], v[3], n[3], length;
    for (int a = 0; a < 3; a++) {
        u[a] = (double)c[1][a] - (double)c[0][a];
        v[a] = (double)c[2][a] - (double)c[0][a];
    }
    for (int a = 0; a < 3; a++) n[a] = u[(a + 1) % 3] * v[(a + 2) % 3] - u[(a + 2) % 3] * v[(a + 1) % 3];
    length = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int a = 0; a < 3; a++) normal[a] = length > 0 ? (float)(n[a] / length) : 0.0f;
}

static void stl_put_triangle(const bvx_mesh *mesh, uint64_t t, uint8_t *p)
{
    float corner[3][3], normal[3];
    double world[3];
    for (int k = 0; k < 3; k++) {
        bvxi_world_position(mesh, mesh->triangles[(size_t)t * 3 + (size_t)k], world);
        for (int a = 0; a < 3; a++) corner[k][a] = (float)world[a];
    }
    stl_facet_normal((const float(*)[3])corner, normal);
    for (int a = 0; a < 3; a++) bvxi_store_f32(p + 4 * a, normal[a]);
    for (int k = 0; k < 3; k++)
        for (int a = 0; a < 3; a++) bvxi_store_f32(p + 12 + 12 * k + 4 * a, corner[k][a]);
    bvxi_store_u16(p + 48, 0);
}

static bvx_status stl_check_floats(bvx_context *ctx, const bvx_mesh *mesh)
{
    double p[3];
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        bvxi_world_position(mesh, v, p);
        for (int a = 0; a < 3; a++)
            if (p[a] >= stl_float_limit || p[a] <= -stl_float_limit)
                return bvxi_fail(ctx, BVX_ERR_RANGE, "STL: vertex %u has the coordinate %g, too large for the format's "
                                 "32-bit floats; take PLY or OBJ", v, p[a]);
    }
    return BVX_OK;
}

bvx_status bvxi_write_stl(bvx_context *ctx, const bvx_mesh *mesh, bvx_buffer *file)
{
    static const char title[] = "binary STL written by bitvox";
    uint64_t const count = mesh->triangle_count;
    BVXI_TRY(stl_check_floats(ctx, mesh));
    BVXI_TRY(bvxi_make_buffer(ctx, STL_WRITTEN_HEADER + 4 + count * STL_WRITTEN_TRIANGLE, "the STL file", file));
    memset(file->bytes, 0, STL_WRITTEN_HEADER);
    memcpy(file->bytes, title, sizeof title - 1);
    bvxi_store_u32(file->bytes + STL_WRITTEN_HEADER, (uint32_t)count);
    for (uint64_t t = 0; t < count; t++)
        stl_put_triangle(mesh, t, file->bytes + STL_WRITTEN_HEADER + 4 + t * STL_WRITTEN_TRIANGLE);
    return BVX_OK;
}
