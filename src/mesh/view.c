/* view.c - is a caller's mesh well formed, and where does it lie.
 *
 * Bounds are those of the vertices that triangles use. Gathering three vertices a triangle is slow, so meshes
 * with packed 32-bit indices go another way: bounds of all vertices, in the order of memory, and with
 * them the number of one vertex that touches each of the six sides. When the indices mention all six, these
 * are the bounds of the used vertices too. When one is missing (unused vertices stick out) the plain loop,
 * which is the specification, decides. */
#include "core/hash.h"
#include "mesh/view.h"

#include <math.h>

bvx_status bvxi_view_fail_index(bvx_context *ctx, const char *function, const bvx_mesh_view *view, uint64_t t)
{
    uint64_t c[3];
    int k = 0;
    bvxi_view_raw_triangle(view, t, c);
    /* The message names the first corner that is out of range. */
    while (k < 2 && c[k] < view->vertex_count) k++;
    return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_INDEX,
                         "%s: triangle %i has vertex index %u, but there are %u vertices", function, t, c[k],
                         view->vertex_count);
}

bvx_status bvxi_view_fail_finite(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                                 uint64_t vertex)
{
    static const char *const axis_name[3] = {"x", "y", "z"};
    double p[3];
    int k = 0;
    bvxi_view_position(view, vertex, p);
    while (k < 2 && p[k] - p[k] == 0.0) k++;
    return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NOT_FINITE,
                         "%s: vertex %i has %s = %g, which is not finite", function, vertex, axis_name[k],
                         p[k]);
}

static bvx_status check_view_indices(bvx_context *ctx, const char *function, const bvx_mesh_view *v)
{
    if (v->triangle_count > INT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: mesh.triangle_count is %u, the limit is below 2^31", function,
                             v->triangle_count);

    /* Without indices the vertices are the corners, three a triangle. */
    if (v->indices == NULL) {
        if (3 * v->triangle_count > v->vertex_count)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_NULL,
                                 "%s: mesh.indices is NULL, so %u triangles need %u vertices, not %u",
                                 function, v->triangle_count, 3 * v->triangle_count, v->vertex_count);
        return BVX_OK;
    }
    if (v->index_type < BVX_U16 || v->index_type > BVX_U64)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: mesh.index_type is %u, not BVX_U16 (1), BVX_U32 (2) or BVX_U64 (3)",
                             function, (uint64_t)v->index_type);
    /* The types are 2, 4 and 8 bytes wide, in this order. */
    if (v->index_stride != 0 && v->index_stride < (uint32_t)6 << (v->index_type - BVX_U16))
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT,
                         "%s: mesh.index_stride is %u, less than the %u bytes of a triangle", function,
                         (uint64_t)v->index_stride, (uint64_t)6 << (v->index_type - BVX_U16));
    if (v->triangle_count * bvxi_view_index_stride(v) > SIZE_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: mesh.triangle_count is %u, more than memory can hold", function,
                             v->triangle_count);
    return BVX_OK;
}

bvx_status bvxi_view_check(bvx_context *ctx, const char *function, const bvx_mesh_view *view)
{
    if (view == NULL) return bvxi_fail_null(ctx, function, "mesh");
    if (view->reserved != 0) return bvxi_fail_reserved(ctx, function, "mesh.");

    uint32_t const least = view->position_type == BVX_F32 ? 12 : 24;

    /* Sizes and strides before counts: the product below is computed with them. */
    if (view->position_type != BVX_F32 && view->position_type != BVX_F64)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_CHOICE,
                             "%s: mesh.position_type is %u, not BVX_F32 (1) or BVX_F64 (2)", function,
                             (uint64_t)view->position_type);
    if (view->position_stride != 0 && view->position_stride < least)
        return bvxi_fail(ctx, BVX_ERR_ARGUMENT,
                         "%s: mesh.position_stride is %u, less than the %u bytes of a vertex", function,
                         (uint64_t)view->position_stride, (uint64_t)least);
    if (view->vertex_count > UINT32_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: mesh.vertex_count is %u, the limit is below 2^32", function,
                             view->vertex_count);
    if (view->positions == NULL && view->vertex_count != 0)
        return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_NULL,
                             "%s: mesh.positions is NULL with a vertex_count of %u", function,
                             view->vertex_count);
    /* On machines of 32 bits the product may be more than any array holds. */
    if (view->vertex_count * bvxi_view_position_stride(view) > SIZE_MAX)
        return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                             "%s: mesh.vertex_count is %u, more than memory can hold", function,
                             view->vertex_count);
    return check_view_indices(ctx, function, view);
}

bvx_status bvxi_view_check_uvs(bvx_context *ctx, const char *function, const bvx_mesh_view *view)
{
    if (view->uvs == NULL || view->uv_indices == NULL) return BVX_OK;
    for (uint64_t i = 0; i < 3 * view->triangle_count; i++)
        if (view->uv_indices[i] >= view->uv_count)
            return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                 "%s: triangle %i has uv index %u, but there are %u uvs", function, i / 3,
                                 (uint64_t)view->uv_indices[i], view->uv_count);
    return BVX_OK;
}

/* ---- plain loops: the specification ---- */

static bvx_status check_every_position(bvx_context *ctx, const char *function, const bvx_mesh_view *v)
{
    double p[3];
    for (uint64_t i = 0; i < v->vertex_count; i++) {
        bvxi_view_position(v, i, p);
        if (!bvxi_view_finite(p)) return bvxi_view_fail_finite(ctx, function, v, i);
    }
    return BVX_OK;
}

/* ---- all vertices in the order of memory, and packed 32-bit indices ---- */

enum {
    VIEW_INDEX_BLOCK = 3072, /* numbers looked through while they are in the nearest cache */
    VIEW_VERTEX_BLOCK = 1024,
    VIEW_LANES = 24
};

/* Each number in a lane of its own, so that compilers make vectors of them. Returns 1 when one is not a number. */
BVXI_VECTOR_INLINE int32_t widen_lanes(const unsigned char *at, int lanes, float low[VIEW_LANES],
                                       float high[VIEW_LANES])
{
    int32_t bad = 0;

    for (int j = 0; j < lanes; j++) {
        float f;
        memcpy(&f, at + 4 * j, sizeof f);
        bad |= f != f;
        low[j] = f < low[j] ? f : low[j];
        high[j] = f > high[j] ? f : high[j];
    }
    return bad;
}

/* Bounds of n vertices and of what side holds, the low and the high one. Returns 0 when one is not a number. */
static int bounds_of_some(const unsigned char *at, size_t n, float side[2][3])
{
    float low[VIEW_LANES], high[VIEW_LANES];
    size_t i = 0;
    int32_t bad = 0;

    for (int j = 0; j < VIEW_LANES; j++) low[j] = side[0][j % 3], high[j] = side[1][j % 3];
    for (; i + VIEW_LANES <= 3 * n; i += VIEW_LANES) bad |= widen_lanes(at + 4 * i, VIEW_LANES, low, high);
    bad |= widen_lanes(at + 4 * i, (int)(3 * n - i), low, high);
    for (int j = 0; j < VIEW_LANES; j++) {
        side[0][j % 3] = low[j] < side[0][j % 3] ? low[j] : side[0][j % 3];
        side[1][j % 3] = high[j] > side[1][j % 3] ? high[j] : side[1][j % 3];
    }
    return !bad;
}

/* The same of all vertices, of any type. */
static int bounds_of_doubles(const bvx_mesh_view *v, double low[3], double high[3], uint32_t at[6])
{
    double p[3];

    for (int a = 0; a < 3; a++) low[a] = HUGE_VAL, high[a] = -HUGE_VAL;
    for (uint64_t i = 0; i < v->vertex_count; i++) {
        bvxi_view_position(v, i, p);
        for (int a = 0; a < 3; a++) {
            if (p[a] != p[a]) return 0;
            if (p[a] < low[a]) low[a] = p[a] + 0.0, at[2 * a] = (uint32_t)i;
            if (p[a] > high[a]) high[a] = p[a] + 0.0, at[2 * a + 1] = (uint32_t)i;
        }
    }
    return bvxi_view_finite(low) && bvxi_view_finite(high);
}

int bvxi_view_outer_bounds(const bvx_mesh_view *v, double low[3], double high[3], uint32_t at[6])
{
    const unsigned char *const p = v->positions;
    float side[2][3], f;

    if (v->vertex_count == 0) return 0;
    if (!bvxi_view_packed_f32(v)) return bounds_of_doubles(v, low, high, at);
    memcpy(side[0], p, sizeof side[0]);
    memcpy(side[1], p, sizeof side[1]);
    memset(at, 0, 6 * sizeof *at);
    for (uint64_t i = 0; i < v->vertex_count; i += VIEW_VERTEX_BLOCK) {
        uint64_t const left = v->vertex_count - i;
        float now[2][3];

        memcpy(now, side, sizeof now);
        if (!bounds_of_some(p + 12 * (size_t)i, left < VIEW_VERTEX_BLOCK ? (size_t)left : VIEW_VERTEX_BLOCK,
                            now))
            return 0;
        for (int k = 0; k < 6; k++)
            if (now[k & 1][k / 2] != side[k & 1][k / 2]) at[k] = (uint32_t)i;
        memcpy(side, now, sizeof side);
    }
    /* From the block that has it to the vertex. */
    for (int k = 0; k < 6; k++)
        for (;; at[k]++) {
            memcpy(&f, p + 12 * (size_t)at[k] + 4 * (size_t)(k / 2), sizeof f);
            if (f == side[k & 1][k / 2]) break;
        }
    for (int a = 0; a < 3; a++) {
        low[a] = (double)side[0][a] + 0.0;
        high[a] = (double)side[1][a] + 0.0;
    }
    return bvxi_view_finite(low) && bvxi_view_finite(high);
}

/* Whether one of n packed numbers is value. */
static int indices_mention(const unsigned char *at, size_t n, uint32_t value)
{
    uint32_t hit = 0, c;
    for (size_t i = 0; i < n; i++) {
        memcpy(&c, at + 4 * i, sizeof c);
        hit |= c == value;
    }
    return hit != 0;
}

/* All triangles: *within is whether every index is a vertex, the result whether all wanted are used. */
static int triangles_mention(const bvx_mesh_view *v, uint32_t want[6], int *within)
{
    const unsigned char *const p = v->indices;
    int missing = 6;

    *within = 1;
    for (uint64_t first = 0; first < 3 * v->triangle_count && *within; first += VIEW_INDEX_BLOCK) {
        uint64_t const left = 3 * v->triangle_count - first;
        size_t const n = left < VIEW_INDEX_BLOCK ? (size_t)left : VIEW_INDEX_BLOCK;
        const unsigned char *const at = p + 4 * (size_t)first;

        uint32_t const last = (uint32_t)(v->vertex_count - 1);
        uint32_t beyond = 0, c;
        for (size_t i = 0; i < n; i++) {
            memcpy(&c, at + 4 * i, sizeof c);
            beyond |= c > last;
        }
        *within = beyond == 0;

        /* From the end, so that a vertex that was found can give its place to the last one. */
        for (int k = missing - 1; k >= 0; k--)
            if (indices_mention(at, n, want[k])) want[k] = want[--missing];
    }
    return missing == 0;
}

/* 1 when low and high are now known; 0 when the plain loops must decide, and name what is not finite. */
static int bounds_packed(const bvx_mesh_view *v, double low[3], double high[3])
{
    uint32_t want[6];
    int within;
    return bvxi_view_packed_u32(v) && bvxi_view_outer_bounds(v, low, high, want) &&
           triangles_mention(v, want, &within) && within;
}

void bvxi_view_used_bounds(const bvx_mesh_view *v, double low[3], double high[3])
{
    double p[3][3];

    /* Of a few triangles over many vertices only these are looked at. */
    if (v->vertex_count / 3 <= v->triangle_count && bounds_packed(v, low, high)) return;
    /* The first corner's vertex starts both bounds; there is a triangle, as the caller has checked. */
    for (uint64_t t = 0; t < v->triangle_count; t++) {
        bvxi_view_corners(v, t, p);
        for (int k = 0; k < 3 && t == 0; k++) low[k] = high[k] = p[0][k];
        for (int k = 0; k < 3; k++) bvxi_widen(low, high, p[k], 3);
    }
}

bvx_status bvxi_view_bounds(bvx_context *ctx, const char *function, const bvx_mesh_view *view, double low[3],
                            double high[3])
{
    double lo[3], hi[3];

    if (view->triangle_count == 0)
        return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: the mesh has no triangles", function);
    /* The fast way answers only where it is certain; else the specification decides and reports. */
    if (!bounds_packed(view, lo, hi)) {
        uint32_t c[3];
        for (uint64_t t = 0; t < view->triangle_count; t++)
            if (!bvxi_view_triangle(view, t, c)) return bvxi_view_fail_index(ctx, function, view, t);
        BVXI_TRY(check_every_position(ctx, function, view));
        bvxi_view_used_bounds(view, lo, hi);
    }
    for (int a = 0; a < 3; a++) {
        low[a] = lo[a] + 0.0; /* turns -0 into 0, so that the order of vertices does not show */
        high[a] = hi[a] + 0.0;
    }
    return BVX_OK;
}

bvx_status bvxi_view_take_points(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                                 bvx_mesh_view *points)
{
    if (view == NULL) return bvxi_fail_null(ctx, function, "points");
    /* Triangles of the caller's are left out, and with them what could be wrong about indices. */
    *points = *view;
    points->indices = NULL;
    points->triangle_count = 0;
    points->index_type = points->index_stride = 0;
    return bvxi_view_check(ctx, function, points);
}

bvx_status bvxi_view_point_bounds(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                                  double low[3], double high[3])
{
    uint32_t at[6];

    if (view->vertex_count == 0) return bvxi_fail(ctx, BVX_ERR_EMPTY, "%s: there are no points", function);
    return bvxi_view_outer_bounds(view, low, high, at) ? BVX_OK : check_every_position(ctx, function, view);
}

/* Bytes from an array's first number to behind its last one. */
static uint64_t view_bytes(uint64_t count, uint64_t stride, uint64_t last)
{
    int ok = 1;
    uint64_t const bytes = count == 0 ? 0 : bvxi_add(bvxi_mul(count - 1, stride, &ok), last, &ok);
    return ok ? bytes : UINT64_MAX;
}

bvx_status bvxi_view_apart(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                           const bvx_mesh *result)
{
    uint64_t const position = result->position_type == BVX_F64 ? 24 : 12;
    uint64_t const to_bytes[2] = {view_bytes(result->vertex_capacity, position, position),
                                  view_bytes(result->triangle_capacity, 12, 12)};
    uint64_t const from_bytes[2] = {view_bytes(view->vertex_count, bvxi_view_position_stride(view),
                                               view->position_type == BVX_F64 ? 24 : 12),
                                    view->indices == NULL
                                        ? 0
                                        : view_bytes(view->triangle_count, bvxi_view_index_stride(view),
                                                     (uint64_t)6 << (view->index_type - BVX_U16))};
    const void *const to[2] = {result->positions, result->triangles};
    const void *const from[2] = {view->positions, view->indices};

    for (int32_t i = 0; i < 2; i++)
        for (int32_t k = 0; k < 2; k++)
            if (bvxi_overlap(to[i], to_bytes[i], from[k], from_bytes[k]))
                return bvxi_fail_for(ctx, BVX_ERR_ARGUMENT, BVX_REASON_OVERLAP,
                                     "%s: the result's %s lie in the mesh's own arrays; it needs others",
                                     function, i == 0 ? "positions" : "triangles");
    return BVX_OK;
}

uint64_t bvxi_corners_hash(const double corner[3][3], double scale)
{
    bvxi_hash hash;
    double p[9];
    /* By places, not by indices: the hash is the same for any numbering of the vertices. */
    bvxi_hash_start(&hash, 0);
    for (int k = 0; k < 9; k++) p[k] = corner[k / 3][k % 3] * scale + 0.0; /* -0 is 0 */
    bvxi_hash_f64(&hash, p, 9);
    return bvxi_hash_end(&hash);
}
