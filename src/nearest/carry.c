/* carry.c - colours and texture coordinates from one mesh to the vertices of another.
 *
 * Each vertex of the target looks up the source's nearest point (closest_query.c) and blends what the corners
 * of that triangle have by its barycentric weights, in doubles. Colours are rounded to the nearest whole
 * number, halves upwards; texture coordinates once, to floats. A vertex on a corner of the source takes its
 * values unchanged. Both frames count: the target's positions are moved by their difference. Vertices do not
 * depend on each other, so threads never show. New arrays replace old ones when all of it is done. */
#include "nearest/closest.h"
#include "mesh/mesh.h"
#include "mesh/view.h"

enum { CARRY_GRAIN = 64 /* least vertices a piece */ };

typedef struct carry_work {
    const bvx_mesh *source;
    bvx_mesh_view from, to; /* views of source and target */
    double shift[3];        /* adds to the target's positions to reach the source's frame */
    bvx_closest closest;
    uint8_t *colours; /* new, or NULL */
    float *uvs;       /* new, or NULL */
} carry_work;

/* ---- One vertex ---- */

/* Numbers into the source's uvs of a triangle's corners. */
static void corner_uvs(const bvx_mesh *source, uint64_t triangle, uint32_t number[3])
{
    const uint32_t *const from = source->uv_triangles != NULL ? source->uv_triangles : source->triangles;
    /* Texture coordinates may have triangles of their own, where seams part them. */
    memcpy(number, from + 3 * (size_t)triangle, 3 * sizeof *number);
}

static void carry_piece(void *user, uint64_t begin, uint64_t end)
{
    const carry_work *const w = user;
    bvx_closest_point at;
    uint32_t hint = 0;

    /* Vertices as they come: those of a mesh that was extracted follow each other in space. */
    for (uint64_t i = begin; i < end; i++) {
        double p[3];
        bvxi_view_position(&w->to, i, p);

        /* Both meshes may carry a frame of their own. */
        for (int a = 0; a < 3; a++) p[a] += w->shift[a];
        bvxi_closest_ask(&w->closest, p, &hint, &at);
        if (w->colours != NULL) {
            const uint8_t *c[3];
            uint32_t corner[3];
            bvxi_view_triangle(&w->from, at.triangle, corner);
            for (int k = 0; k < 3; k++) c[k] = w->source->colours + 4 * (size_t)corner[k];
            for (int j = 0; j < 4; j++) {
                double const up = at.weight[0] * c[0][j] + at.weight[1] * c[1][j] + at.weight[2] * c[2][j] +
                                  0.5;
                /* Weights may sum up to a hair more than 1. */
                w->colours[4 * i + (uint64_t)j] = (uint8_t)(up >= 255.0 ? 255 : (int32_t)up);
            }
        }
        if (w->uvs != NULL) {
            const float *c[3];
            uint32_t number[3];
            corner_uvs(w->source, at.triangle, number);
            for (int k = 0; k < 3; k++) c[k] = w->source->uvs + 2 * (size_t)number[k];
            for (int j = 0; j < 2; j++)
                w->uvs[2 * i + (uint64_t)j] = (float)(at.weight[0] * (double)c[0][j] +
                                                      at.weight[1] * (double)c[1][j] +
                                                      at.weight[2] * (double)c[2][j]);
        }
    }
}

/* ---- Checks ---- */

bvx_status bvxi_check_carried_mesh(bvx_context *ctx, const char *function, const bvx_mesh *mesh)
{
    if (mesh->position_type != BVX_F32 && mesh->position_type != BVX_F64)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: mesh.position_type is %d, not BVX_F32 (1) or BVX_F64 (2)", function,
                             (int64_t)mesh->position_type);
    if (mesh->triangles == NULL && mesh->triangle_count != 0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                             "%s: mesh.triangles is NULL with a triangle_count of %u", function,
                             mesh->triangle_count);
    if (!bvxi_view_finite(mesh->frame))
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE, "%s: mesh.frame is not finite",
                             function);
    return bvxi_mesh_check_reserved(ctx, function, mesh);
}

/* All texture coordinates that triangles use are there and finite. Triangles hold vertices by now. */
static bvx_status check_source_uvs(bvx_context *ctx, const char *function, const bvx_mesh *source)
{
    if (source->uvs == NULL && source->uv_triangles != NULL)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                             "%s: mesh.uv_triangles is given and mesh.uvs is NULL", function);

    /* Only what triangles use is checked: other values are never read. */
    if (source->uvs == NULL) return BVX_OK;
    for (uint64_t t = 0; t < source->triangle_count; t++) {
        uint32_t number[3];
        corner_uvs(source, t, number);
        for (int k = 0; k < 3; k++) {
            if (number[k] >= source->uv_count)
                return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                     "%s: triangle %i has texture coordinate number %u, but there are %u",
                                     function, t, (uint64_t)number[k], source->uv_count);
            const float *const uv = source->uvs + 2 * (size_t)number[k];
            if ((uv[0] - uv[0]) + (uv[1] - uv[1]) != 0.0f)
                return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                                     "%s: texture coordinate %i is not finite", function,
                                     (uint64_t)number[k]);
        }
    }
    return BVX_OK;
}

/* Also fills w->to and w->shift. */
static bvx_status check_target(bvx_context *ctx, const char *function, const bvx_mesh *target, carry_work *w)
{
    BVXI_TRY(bvxi_check_carried_mesh(ctx, function, target));
    if (target->owned == 0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CAPACITY,
                             "%s: its arrays are not the library's own, so it cannot be given others",
                             function);
    if (target->vertex_count > target->vertex_capacity)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT, "%s: mesh.vertex_count is %u with a vertex_capacity of %u",
                         function, target->vertex_count, target->vertex_capacity);
    if (target->vertex_capacity > UINT64_MAX / 24) /* the bytes of an array are a number */
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_TOO_MANY,
                             "%s: mesh.vertex_capacity is %u, more than any memory holds", function,
                             target->vertex_capacity);

    /* Whole numbers are in order; now what they point to. */
    bvx_mesh_view_of(target, &w->to);
    BVXI_TRY(bvxi_view_check(ctx, function, &w->to));
    for (int a = 0; a < 3; a++) w->shift[a] = target->frame[a] - w->source->frame[a];
    for (uint64_t i = 0; i < target->vertex_count; i++) {
        double p[3];
        bvxi_view_position(&w->to, i, p);

        /* The shift itself may leave a double's range, so both are checked. */
        if (!bvxi_view_finite(p)) return bvxi_view_fail_finite(ctx, function, &w->to, i);
        for (int a = 0; a < 3; a++) p[a] += w->shift[a];
        if (!bvxi_view_finite(p))
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_FAR,
                                 "%s: vertex %i is beyond a double's range in the source's frame", function,
                                 i);
    }
    return BVX_OK;
}

/* ---- The whole ---- */

/* New arrays for what the source has; vertices that the capacity leaves unused are zero. */
static bvx_status make_carried_arrays(bvx_context *ctx, const bvx_mesh *target, carry_work *w)
{
    uint64_t const capacity = target->vertex_capacity;
    if (w->source->colours != NULL)
        BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_RESULT, capacity * 4, "the carried colours", &w->colours));
    if (w->source->uvs != NULL)
        BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_RESULT, capacity * 8, "the carried texture coordinates", &w->uvs));
    return BVX_OK;
}

/* With the search tree built: carry, or leave the target as it was. */
static bvx_status carry_with_tree(bvx_context *ctx, const char *of_source, carry_work *w, bvx_mesh *target)
{
    BVXI_TRY(check_source_uvs(ctx, of_source, w->source));

    /* New arrays are filled before old ones go: a failure leaves the target as it was. */
    bvx_status status = make_carried_arrays(ctx, target, w);
    if (status == BVX_OK)
        status = BVXI_SHARE(ctx, 0.3, 1.0,
                            bvxi_for(ctx, "carry", target->vertex_count, CARRY_GRAIN, carry_piece, w));
    if (status == BVX_OK) {
        if (w->colours != NULL) {
            bvxi_mesh_release(ctx, target, BVXI_MESH_COLOURS);
            target->colours = w->colours;
        }
        /* A coordinate a vertex: triangles of their own are not needed any more. */
        if (w->uvs != NULL) {
            bvxi_mesh_release(ctx, target, BVXI_MESH_UV_TRIANGLES | BVXI_MESH_UVS);
            target->uvs = w->uvs;
            target->uv_count = target->vertex_capacity;
        }
    } else {
        bvxi_free(ctx, w->uvs, target->vertex_capacity * 8);
        bvxi_free(ctx, w->colours, target->vertex_capacity * 4);
    }
    return status;
}

static bvx_status run_mesh_carry(bvx_context *context, const bvx_mesh *source, bvx_mesh *target)
{
    static const char *const function = "bvx_mesh_carry", *const of_source = "bvx_mesh_carry, source";
    carry_work w = {0};
    if (source == NULL) return bvxi_fail_null(context, function, "source");
    if (target == NULL) return bvxi_fail_null(context, function, "target");
    if (source == target)
        return bvxi_fail_for(context, BVX_ERR_ARGUMENT, BVX_REASON_OVERLAP,
                             "%s: source and target are one mesh", function);

    w.source = source;
    BVXI_TRY(bvxi_check_carried_mesh(context, of_source, source));
    bvx_mesh_view_of(source, &w.from);
    BVXI_TRY(check_target(context, "bvx_mesh_carry, target", target, &w));
    if (source->colours == NULL && source->uvs == NULL && source->uv_triangles == NULL) return BVX_OK;

    BVXI_TRY(bvxi_closest_open(bvxi_call_of(context, of_source, "carry", 0.0, 0.3), &w.from, &w.closest));
    bvx_status const status = carry_with_tree(context, of_source, &w, target);
    bvxi_closest_shut(context, &w.closest);
    return status;
}

bvx_status bvx_mesh_carry(bvx_context *context, const bvx_mesh *source, bvx_mesh *target)
{
    return BVXI_CALL(context, run_mesh_carry(context, source, target));
}
