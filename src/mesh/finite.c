/* finite.c - a mesh without the triangles that have a corner at infinity or at what is not a number.
 *
 * Vertices that are not finite go, whether a triangle uses them or not, and with them every triangle that
 * does. What remains moves up within its arrays, so the order of vertices and triangles stays, and keys and
 * attributes stay with what they belong to.
 * Memory: 4 bytes a vertex, where there is something to drop. Cost: O(vertices + triangles). */
#include "mesh/view.h"
#include "mesh/mesh.h"

#define FINITE_GONE UINT32_MAX /* beyond the number of any vertex */

static int finite_vertex(const bvx_mesh *mesh, uint64_t vertex)
{
    size_t const at = (size_t)vertex * 3;
    if (mesh->position_type == BVX_F32) {
        const float *const p = (const float *)mesh->positions + at;
        return p[0] * 0.0f + p[1] * 0.0f + p[2] * 0.0f == 0.0f;
    }
    return bvxi_view_finite((const double *)mesh->positions + at);
}

static void finite_move(void *array, size_t size, uint64_t from, uint64_t to)
{
    unsigned char *const bytes = array;
    if (array != NULL) memcpy(bytes + (size_t)to * size, bytes + (size_t)from * size, size);
}

/* Vertices move up; number: where each one went. */
static void finite_pack_vertices(bvx_mesh *mesh, uint32_t *number)
{
    void *const uvs = mesh->uv_triangles == NULL ? mesh->uvs : NULL; /* those of vertices */
    uint64_t kept = 0;

    /* A vertex moves up only over ones that are gone, so it never lands on one that is still needed. */
    for (uint64_t v = 0; v < mesh->vertex_count; v++) {
        number[v] = FINITE_GONE;
        if (!finite_vertex(mesh, v)) continue;
        number[v] = (uint32_t)kept;
        if (kept != v) {
            finite_move(mesh->positions, mesh->position_type == BVX_F32 ? 12 : 24, v, kept);
            finite_move(mesh->vertex_keys, 8, v, kept);
            finite_move(mesh->colours, 4, v, kept);
            finite_move(mesh->normals, 12, v, kept);
            finite_move(uvs, 8, v, kept);
            finite_move(mesh->uvs2, 8, v, kept);
        }
        kept++;
    }
    mesh->vertex_count = kept;
}

bvx_status bvxi_mesh_drop_nonfinite(bvx_context *ctx, const char *function, bvx_mesh *mesh, uint64_t *dropped)
{
    uint64_t const vertices = mesh->vertex_count, triangles = mesh->triangle_count;
    uint64_t bad = 0;
    uint32_t *number;
    bvx_mesh_view view;

    *dropped = 0;
    bvx_mesh_view_of(mesh, &view);
    BVXI_TRY(bvxi_view_check(ctx, function, &view));

    /* A mesh without such vertices is left as it is, without memory for numbers. */
    while (bad < vertices && finite_vertex(mesh, bad)) bad++;
    if (bad == vertices) return BVX_OK;

    /* Nothing is moved before all numbers are known to be good, so a refused mesh is whole. */
    for (uint64_t t = 0; t < triangles; t++) {
        const uint32_t *const corner = mesh->triangles + (size_t)t * 3;
        if (corner[0] >= vertices || corner[1] >= vertices || corner[2] >= vertices)
            return bvxi_view_fail_index(ctx, function, &view, t);
    }

    BVXI_TRY(BVXI_ARRAY(ctx, vertices, "the numbers of vertices", number));
    finite_pack_vertices(mesh, number);
    uint64_t kept = 0;

    for (uint64_t t = 0; t < mesh->triangle_count; t++) {
        const uint32_t *const corner = mesh->triangles + (size_t)t * 3;
        uint32_t const now[3] = {number[corner[0]], number[corner[1]], number[corner[2]]};
        if (now[0] == FINITE_GONE || now[1] == FINITE_GONE || now[2] == FINITE_GONE) continue;
        memcpy(mesh->triangles + (size_t)kept * 3, now, sizeof now);
        if (kept != t) {
            finite_move(mesh->triangle_keys, 8, t, kept);
            finite_move(mesh->uv_triangles, 12, t, kept);
            finite_move(mesh->materials, 4, t, kept);
        }
        kept++;
    }
    mesh->triangle_count = kept;

    bvxi_drop(ctx, number);
    *dropped = triangles - mesh->triangle_count;
    return BVX_OK;
}

static bvx_status run_drop_nonfinite(bvx_context *context, bvx_mesh *mesh, uint64_t *dropped)
{
    static const char *const function = "bvx_mesh_drop_nonfinite";
    if (mesh == NULL) return bvxi_fail_null(context, function, "mesh");
    if (dropped == NULL) return bvxi_fail_null(context, function, "dropped");
    BVXI_TRY(bvxi_mesh_check_reserved(context, function, mesh));
    if (mesh->vertex_count == 0 && mesh->triangle_count == 0) { /* of any type, like a zeroed struct */
        *dropped = 0;
        return BVX_OK;
    }
    if (mesh->position_type != BVX_F32 && mesh->position_type != BVX_F64)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: mesh.position_type is %d, not BVX_F32 (1) or BVX_F64 (2)", function,
                             (int64_t)mesh->position_type);
    if (mesh->triangle_count != 0 && mesh->triangles == NULL)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                             "%s: mesh.triangles is NULL with a triangle_count of %u", function,
                             mesh->triangle_count);
    return bvxi_mesh_drop_nonfinite(context, function, mesh, dropped);
}

bvx_status bvx_mesh_drop_nonfinite(bvx_context *context, bvx_mesh *mesh, uint64_t *dropped)
{
    return BVXI_CALL(context, run_drop_nonfinite(context, mesh, dropped));
}
