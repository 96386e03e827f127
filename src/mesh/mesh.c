/* mesh.c - the mesh struct: arrays made for a result or taken from the caller, freed, viewed, hashed; the
 * area of a mesh, and its parts that are joined through vertices.
 *
 * Guarantee: a result's arrays are reused where they suffice, and what a caller brought is never freed. */
#include "mesh/mesh.h"
#include "mesh/facet.h"
#include "mesh/view.h"
#include "mesh/topology.h"
#include "core/hash.h"

/* ---- The plain mesh struct: opened for a result, freed, viewed, hashed ---- */

static uint64_t mesh_position_bytes(int32_t type)
{
    return type == BVX_F64 ? 24 : 12;
}

int bvxi_mesh_has_attributes(const bvx_mesh *mesh)
{
    return mesh->colours != NULL || mesh->uvs != NULL || mesh->uv_triangles != NULL ||
           mesh->normals != NULL || mesh->uvs2 != NULL || mesh->materials != NULL || mesh->assets != NULL;
}

/* Arrays of the caller's: they must be there and suffice. */
static bvx_status take_arrays(bvx_context *ctx, const char *function, int32_t position_type, int32_t keys,
                              uint64_t vertex_count, uint64_t triangle_count, const bvx_mesh *mesh)
{
    if (mesh->positions == NULL || mesh->triangles == NULL || mesh->position_type != position_type)
        return bvxi_fail_for(
            ctx, BVX_ERR_ARGUMENT, BVX_REASON_NOT_EMPTY,
            "%s: a mesh that brings arrays needs both positions of the requested type and triangles",
            function);
    if (keys && (mesh->vertex_keys == NULL || mesh->triangle_keys == NULL))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CONTRADICTION,
                             "%s: keys are requested and the given mesh has no arrays for them", function);
    /* they would hold another surface's */
    if (!keys && (mesh->vertex_keys != NULL || mesh->triangle_keys != NULL))
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NOT_EMPTY,
                             "%s: the mesh brings arrays for keys; ask for keys or leave them NULL",
                             function);
    if (bvxi_mesh_has_attributes(mesh)) /* and these too */
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NOT_EMPTY,
                             "%s: the mesh brings attributes such as colours or texture coordinates; leave "
                             "them NULL",
                             function);

    /* Checked last, so that a message about room means that all else is right. */
    if (mesh->vertex_capacity < vertex_count || mesh->triangle_capacity < triangle_count)
        return bvxi_fail(ctx, BVX_ERR_CAPACITY,
                         "%s: the surface has %u vertices and %u triangles, the arrays hold %u and %u",
                         function, vertex_count, triangle_count, mesh->vertex_capacity,
                         mesh->triangle_capacity);
    return BVX_OK;
}

static bvx_status make_arrays(bvx_context *ctx, int32_t keys, bvx_mesh *mesh)
{
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, mesh->vertex_count * mesh_position_bytes(mesh->position_type),
                        "the positions", &mesh->positions));
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, mesh->triangle_count * 12, "the triangles", &mesh->triangles));
    if (!keys) return BVX_OK;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, mesh->vertex_count * 8, "the vertex keys", &mesh->vertex_keys));
    return bvxi_alloc(ctx, BVXI_RESULT, mesh->triangle_count * 8, "the triangle keys", &mesh->triangle_keys);
}

bvx_status bvxi_mesh_open(bvx_context *ctx, const char *function, int32_t position_type, int32_t keys,
                          uint64_t vertex_count, uint64_t triangle_count, bvx_mesh *mesh)
{
    bvx_mesh made = {.owned = 1, .position_type = position_type};
    int const suits = mesh->positions != NULL && mesh->triangles != NULL &&
                      mesh->position_type == position_type && (mesh->vertex_keys != NULL) == (keys != 0) &&
                      (mesh->triangle_keys != NULL) == (keys != 0) && !bvxi_mesh_has_attributes(mesh) &&
                      mesh->vertex_capacity >= vertex_count && mesh->triangle_capacity >= triangle_count;

    /* Arrays of the library's that do not suit are freed at once, so that both need not live together. */
    if (mesh->owned == 1 && !suits) bvx_mesh_free(ctx, mesh);
    if (mesh->positions != NULL || mesh->triangles != NULL) {
        BVXI_TRY(take_arrays(ctx, function, position_type, keys, vertex_count, triangle_count, mesh));
        mesh->vertex_count = vertex_count;
        mesh->triangle_count = triangle_count;
        memset(mesh->frame, 0, sizeof mesh->frame);
        return BVX_OK;
    }

    /* New arrays go to a mesh of their own: after a failure the caller's is as it was. */
    made.vertex_count = made.vertex_capacity = vertex_count;
    made.triangle_count = made.triangle_capacity = triangle_count;
    bvx_status const status = make_arrays(ctx, keys, &made);
    if (status != BVX_OK) {
        bvx_mesh_free(ctx, &made);
        return status;
    }
    *mesh = made;
    return BVX_OK;
}

bvx_status bvxi_mesh_made(bvx_context *ctx, bvx_status status, int mine, bvx_mesh *mesh)
{
    if (status == BVX_OK) return BVX_OK;
    if (mine) bvx_mesh_free(ctx, mesh);
    else mesh->vertex_count = mesh->triangle_count = 0;
    return status;
}

void bvxi_mesh_release(bvx_context *ctx, bvx_mesh *mesh, uint32_t arrays)
{
    uint64_t const vertices = mesh->vertex_capacity, triangles = mesh->triangle_capacity;
    uint64_t const position = mesh_position_bytes(mesh->position_type);

    struct {
        uint32_t array;
        void *block;
        uint64_t count, bytes;
    } const owned[] = {
        {BVXI_MESH_ASSETS, mesh->assets, 1, bvxi_assets_bytes(mesh->assets)},
        {BVXI_MESH_MATERIALS, mesh->materials, triangles, 4},
        {BVXI_MESH_UVS2, mesh->uvs2, vertices, 8},
        {BVXI_MESH_NORMALS, mesh->normals, vertices, 12},
        {BVXI_MESH_UV_TRIANGLES, mesh->uv_triangles, triangles, 12},
        {BVXI_MESH_UVS, mesh->uvs, mesh->uv_count, 8},
        {BVXI_MESH_COLOURS, mesh->colours, vertices, 4},
        {BVXI_MESH_KEYS, mesh->triangle_keys, triangles, 8},
        {BVXI_MESH_KEYS, mesh->vertex_keys, vertices, 8},
        {BVXI_MESH_TRIANGLES, mesh->triangles, triangles, 12},
        {BVXI_MESH_POSITIONS, mesh->positions, vertices, position},
    };

    for (size_t i = 0; i < sizeof owned / sizeof owned[0]; i++)
        if ((arrays & owned[i].array) != 0) bvxi_free(ctx, owned[i].block, owned[i].count * owned[i].bytes);

    if ((arrays & BVXI_MESH_ASSETS) != 0) mesh->assets = NULL;
    if ((arrays & BVXI_MESH_MATERIALS) != 0) mesh->materials = NULL;
    if ((arrays & BVXI_MESH_UVS2) != 0) mesh->uvs2 = NULL;
    if ((arrays & BVXI_MESH_NORMALS) != 0) mesh->normals = NULL;
    if ((arrays & BVXI_MESH_UV_TRIANGLES) != 0) mesh->uv_triangles = NULL;
    if ((arrays & BVXI_MESH_UVS) != 0) mesh->uvs = NULL;
    if ((arrays & BVXI_MESH_COLOURS) != 0) mesh->colours = NULL;
    if ((arrays & BVXI_MESH_KEYS) != 0) mesh->triangle_keys = mesh->vertex_keys = NULL;
    if ((arrays & BVXI_MESH_TRIANGLES) != 0) mesh->triangles = NULL;
    if ((arrays & BVXI_MESH_POSITIONS) != 0) mesh->positions = NULL;
}

void bvx_mesh_free(bvx_context *context, bvx_mesh *mesh)
{
    if (context == NULL || mesh == NULL) return;
    if (mesh->owned) bvxi_mesh_release(context, mesh, BVXI_MESH_ALL);
    memset(mesh, 0, sizeof *mesh);
}

void bvx_mesh_view_of(const bvx_mesh *mesh, bvx_mesh_view *view)
{
    if (view == NULL) return;
    memset(view, 0, sizeof *view);
    if (mesh == NULL) return;
    view->positions = mesh->positions;
    view->indices = mesh->triangles;
    view->vertex_count = mesh->vertex_count;
    view->triangle_count = mesh->triangle_count;
    /* an empty struct is a valid view */
    view->position_type = mesh->position_type == BVX_F64 ? BVX_F64 : BVX_F32;
    view->index_type = BVX_U32;
    view->colours = mesh->colours;
    view->normals = mesh->normals;
    view->uvs = mesh->uvs;
    view->uv_indices = mesh->uv_triangles;
    view->uv_count = mesh->uv_triangles != NULL ? mesh->uv_count : 0;
    view->uvs2 = mesh->uvs2;
    view->materials = mesh->materials;
}

bvx_status bvxi_mesh_check_reserved(bvx_context *ctx, const char *function, const bvx_mesh *mesh)
{
    for (uint64_t i = 0; i < 2; i++)
        if (mesh->reserved[i] != 0)
            return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_RESERVED,
                                 "%s: mesh.reserved[%u] must be 0", function, i);
    return BVX_OK;
}

static bvx_status run_mesh_hash(bvx_context *context, const bvx_mesh *mesh, uint64_t *hash)
{
    static const char *const function = "bvx_mesh_hash";
    bvxi_hash h;
    int32_t type[2] = {0, 0};
    if (mesh == NULL) return bvxi_fail_null(context, function, "mesh");
    if (hash == NULL) return bvxi_fail_null(context, function, "hash");
    int const empty = mesh->vertex_count == 0 && mesh->triangle_count == 0;

    BVXI_TRY(bvxi_mesh_check_reserved(context, function, mesh));
    if (mesh->position_type != BVX_F32 && mesh->position_type != BVX_F64 &&
        !(empty && mesh->position_type == 0))
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: mesh.position_type is %d, not BVX_F32 (1) or BVX_F64 (2)", function,
                             (int64_t)mesh->position_type);
    if (mesh->vertex_count > UINT32_MAX || mesh->triangle_count > INT32_MAX)
        return bvxi_fail_for(context, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: the mesh has %u vertices and %u triangles, limits are 2^32 and 2^31",
                             function, mesh->vertex_count, mesh->triangle_count);
    if (mesh->vertex_count != 0 && mesh->positions == NULL)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                             "%s: mesh.positions is NULL with a vertex_count of %u", function,
                             mesh->vertex_count);
    if (mesh->triangle_count != 0 && mesh->triangles == NULL)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                             "%s: mesh.triangles is NULL with a triangle_count of %u", function,
                             mesh->triangle_count);
    type[0] = mesh->position_type;

    bvxi_hash_start(&h, 0);
    bvxi_hash_i32(&h, type, 2);
    bvxi_hash_u64(&h, &mesh->vertex_count, 1);
    bvxi_hash_u64(&h, &mesh->triangle_count, 1);
    bvxi_hash_f64(&h, mesh->frame, 3);
    bvxi_hash_start(&h, bvxi_hash_end(&h));
    if (mesh->position_type == BVX_F64) bvxi_hash_f64(&h, mesh->positions, (size_t)mesh->vertex_count * 3);
    else bvxi_hash_f32(&h, mesh->positions, (size_t)mesh->vertex_count * 3);
    bvxi_hash_start(&h, bvxi_hash_end(&h));
    bvxi_hash_u32(&h, mesh->triangles, (size_t)mesh->triangle_count * 3);
    *hash = bvxi_hash_end(&h);
    return BVX_OK;
}

bvx_status bvx_mesh_hash(bvx_context *context, const bvx_mesh *mesh, uint64_t *hash)
{
    return BVXI_CALL(context, run_mesh_hash(context, mesh, hash));
}

/* ---- The area of a mesh's triangles: sums of doubles in the triangles' order, the same everywhere ---- */

double bvxi_view_area(const bvx_mesh_view *view)
{
    double sum = 0;
    for (uint64_t t = 0; t < view->triangle_count; t++) {
        double p[3][3], n[3];
        bvxi_view_corners(view, t, p);
        sum += 0.5 * bvxi_facet_normal((const double(*)[3])p, n);
    }
    return sum;
}

/* ---- The parts of a mesh that hang together through vertices ---- */

void bvxi_pieces(const bvx_mesh_view *view, const uint32_t *representative, uint32_t *piece)
{
    uint32_t c[3];
    for (uint64_t v = 0; v < view->vertex_count; v++) piece[v] = representative[v];
    /* The least vertex of a part is its root, so the answer does not depend on the order of triangles. */
    for (uint64_t t = 0; t < view->triangle_count; t++) {
        bvxi_view_triangle(view, t, c);
        bvxi_join(piece, c[0], c[1]);
        bvxi_join(piece, c[0], c[2]);
    }
    for (uint64_t v = 0; v < view->vertex_count; v++) piece[v] = bvxi_root(piece, (uint32_t)v);
}
