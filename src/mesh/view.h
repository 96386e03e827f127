/* view.h - reading a caller's mesh: any position and index type, any stride, any alignment. bvxi_view_check
 * comes first; the getters then trust types, strides and counts. Not installed. */
#ifndef BVXI_VIEW_H
#define BVXI_VIEW_H

#include "core/core.h"
#include "core/vec3.h"

/* The shape of the struct, not what the arrays hold: NULL, type numbers, strides, counts, reserved fields.
 * BVX_ERR_ARGUMENT or BVX_ERR_RANGE with the field's name. A mesh without triangles passes. */
bvx_status bvxi_view_check(bvx_context *ctx, const char *function, const bvx_mesh_view *view);
/* Texture coordinates of their own indices, of a view that is checked. */
bvx_status bvxi_view_check_uvs(bvx_context *ctx, const char *function, const bvx_mesh_view *view);

/* Bounds of the vertices that triangles use, -0 given as 0; checks all indices and all coordinates on its
 * way. BVX_ERR_EMPTY without triangles, BVX_ERR_RANGE for an index beyond the vertices (names the triangle)
 * or else for a coordinate that is not finite (names the vertex; unused vertices must be finite too). Needs
 * no memory. */
bvx_status bvxi_view_bounds(bvx_context *ctx, const char *function, const bvx_mesh_view *view, double low[3],
                            double high[3]);

/* Of three positions in this order times scale, -0 as 0. A power of two for the mesh's size (bvxi_unit_scale) gives the
 * same hash in any unit. */
uint64_t bvxi_corners_hash(const double corner[3][3], double scale);

/* mesh.c: of all triangles. Trusts the indices. */
double bvxi_view_area(const bvx_mesh_view *view);
/* Bounds of the vertices that triangles use, of a view with triangles. Trusts the indices. */
void bvxi_view_used_bounds(const bvx_mesh_view *view, double low[3], double high[3]);
/* Bounds of all vertices, used or not, and the first one at each side (low x, high x, low y ...). Returns 0 when there
 * is none, or one is not finite. */
int bvxi_view_outer_bounds(const bvx_mesh_view *view, double low[3], double high[3], uint32_t at[6]);

/* Refuse a result whose positions or triangles lie in the arrays of a
 * checked view: the view is read after the result is begun. */
bvx_status bvxi_view_apart(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                           const bvx_mesh *result);

/* The view's vertices only, checked as bvxi_view_check does. */
bvx_status bvxi_view_take_points(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                                 bvx_mesh_view *points);

/* Bounds of all vertices, -0 given as 0; triangles are not looked at. BVX_ERR_EMPTY without vertices,
 * BVX_ERR_RANGE for a coordinate that is not finite (names the vertex). */
bvx_status bvxi_view_point_bounds(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                                  double low[3], double high[3]);

/* The refusal of a triangle that bvxi_view_triangle did not accept, and of a vertex that is not finite. */
BVXI_COLD bvx_status bvxi_view_fail_index(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                                          uint64_t t);
BVXI_COLD bvx_status bvxi_view_fail_finite(bvx_context *ctx, const char *function, const bvx_mesh_view *view,
                                           uint64_t vertex);

/* Bytes from vertex to vertex and from triangle to triangle. */
static inline size_t bvxi_view_position_stride(const bvx_mesh_view *v)
{
    return v->position_stride != 0 ? v->position_stride : v->position_type == BVX_F32 ? 12u : 24u;
}

static inline size_t bvxi_view_index_stride(const bvx_mesh_view *v)
{
    return v->index_stride != 0 ? v->index_stride : (size_t)6 << (v->index_type - BVX_U16);
}

static inline const unsigned char *bvxi_view_position_at(const bvx_mesh_view *v, uint64_t vertex)
{
    return (const unsigned char *)v->positions + (size_t)vertex * bvxi_view_position_stride(v);
}

static inline const unsigned char *bvxi_view_index_at(const bvx_mesh_view *v, uint64_t t)
{
    return (const unsigned char *)v->indices + (size_t)t * bvxi_view_index_stride(v);
}

/* The type of positions as bvxi_view_position gives them: those of a transform are doubles. */
static inline uint32_t bvxi_view_type(const bvx_mesh_view *v)
{
    return v->transform != NULL ? BVX_F64 : v->position_type;
}

/* 1 when vertices are three floats, or triangles three uint32_t, with
 * nothing between them (of any alignment). */
static inline int bvxi_view_packed_f32(const bvx_mesh_view *v)
{
    return bvxi_view_type(v) == BVX_F32 && bvxi_view_position_stride(v) == 12;
}

static inline int bvxi_view_packed_u32(const bvx_mesh_view *v)
{
    return v->indices != NULL && v->index_type == BVX_U32 && bvxi_view_index_stride(v) == 12;
}

/* Corners of triangle t as the caller gave them; u64 indices are not cut short. */
static inline void bvxi_view_raw_triangle(const bvx_mesh_view *v, uint64_t t, uint64_t corner[3])
{
    /* Copied, not cast: the caller's array may have any alignment. */
    if (v->indices == NULL) {
        corner[0] = 3 * t;
        corner[1] = 3 * t + 1;
        corner[2] = 3 * t + 2;
    } else if (v->index_type == BVX_U32) {
        uint32_t c[3];
        memcpy(c, bvxi_view_index_at(v, t), sizeof c);
        corner[0] = c[0];
        corner[1] = c[1];
        corner[2] = c[2];
    } else if (v->index_type == BVX_U16) {
        uint16_t c[3];
        memcpy(c, bvxi_view_index_at(v, t), sizeof c);
        corner[0] = c[0];
        corner[1] = c[1];
        corner[2] = c[2];
    } else {
        memcpy(corner, bvxi_view_index_at(v, t), 3 * sizeof corner[0]);
    }
}

/* The corner after c in its triangle, where each three in a row are one's. */
static inline uint32_t bvxi_corner_after(uint32_t c)
{
    return c % 3 == 2 ? c - 2 : c + 1;
}

/* Corners of triangle t; 0 when one of them is no vertex (corner is then unspecified). */
static inline int bvxi_view_triangle(const bvx_mesh_view *v, uint64_t t, uint32_t corner[3])
{
    uint64_t c[3];
    bvxi_view_raw_triangle(v, t, c);
    corner[0] = (uint32_t)c[0];
    corner[1] = (uint32_t)c[1];
    corner[2] = (uint32_t)c[2];
    /* A bitwise and: all three are compared without a jump, as they are right nearly always. */
    return (c[0] < v->vertex_count) & (c[1] < v->vertex_count) & (c[2] < v->vertex_count);
}

/* The one evaluation that the header states. */
static inline void bvxi_view_move(const double m[12], double p[3])
{
    double const x = p[0], y = p[1], z = p[2];
    for (int a = 0; a < 3; a++, m += 4) p[a] = ((m[0] * x + m[1] * y) + m[2] * z) + m[3];
}

/* Position of a vertex below vertex_count. */
static inline void bvxi_view_position(const bvx_mesh_view *v, uint64_t vertex, double p[3])
{
    if (v->position_type == BVX_F32) {
        float f[3];
        memcpy(f, bvxi_view_position_at(v, vertex), sizeof f);
        p[0] = (double)f[0];
        p[1] = (double)f[1];
        p[2] = (double)f[2];
    } else {
        memcpy(p, bvxi_view_position_at(v, vertex), 3 * sizeof p[0]);
    }
    if (BVXI_UNLIKELY(v->transform != NULL)) bvxi_view_move(v->transform, p);
}

/* Corners of triangle t, whose indices have been checked. */
static inline void bvxi_view_corners(const bvx_mesh_view *v, uint64_t t, double p[3][3])
{
    uint32_t c[3];
    bvxi_view_triangle(v, t, c);
    for (int k = 0; k < 3; k++) bvxi_view_position(v, c[k], p[k]);
}

/* The same times a power of two that brings them about to the size of 1, so that products of lengths neither
 * vanish nor overflow. */
static inline void bvxi_view_scaled(const bvx_mesh_view *v, uint64_t t, double scale, double p[3][3])
{
    bvxi_view_corners(v, t, p);
    for (int k = 0; k < 9; k++) p[k / 3][k % 3] *= scale;
}

/* 1 when none of the three is an infinity or not a number. */
static inline int bvxi_view_finite(const double p[3])
{
    return (p[0] - p[0]) + (p[1] - p[1]) + (p[2] - p[2]) == 0.0;
}

/* ---- A mesh without what is not finite ---- */

/* Drop vertices that are not finite and the triangles that use them, in the mesh's
 * own arrays; dropped counts the triangles. BVX_ERR_ARGUMENT, BVX_ERR_RANGE (an
 * index, with its triangle), BVX_ERR_MEMORY, BVX_ERR_BUDGET: the mesh is unchanged. */
bvx_status bvxi_mesh_drop_nonfinite(bvx_context *ctx, const char *function, bvx_mesh *mesh,
                                    uint64_t *dropped);

/* ---- A power of two that keeps products of coordinates within doubles ---- */

/* The power of two that brings the largest coordinate of a box into [0.5,
 * 1), or as near as 1000 doublings come. Multiplying by it is exact, so it
 * changes no result but those that would overflow or vanish on the way. */
static inline double bvxi_unit_scale(const double low[3], const double high[3])
{
    double largest = 0.0, s = 1.0;
    for (int a = 0; a < 3; a++) {
        largest = high[a] > largest ? high[a] : largest;
        largest = -low[a] > largest ? -low[a] : largest;
    }
    for (int i = 0; i < 1000 && largest * s >= 1.0; i++) s *= 0.5;
    for (int i = 0; i < 1000 && largest > 0.0 && largest * s < 0.5; i++) s *= 2.0;
    return s;
}

#endif
