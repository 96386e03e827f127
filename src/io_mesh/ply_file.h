/* ply_file.h - the rows of a PLY file as they are read, by text or bytes alike. Not installed. */
#ifndef BVXI_PLY_FILE_H
#define BVXI_PLY_FILE_H

#include "io_mesh/read_polygons.h"
#include "io_mesh/ply_header.h"

typedef struct ply_file {
    bvxi_source *source;
    const ply_header *header;
    bvx_mesh *mesh;
    const char *p; /* reading is here */
    uint64_t vertex_count;
    uint64_t triangle_count; /* found so far; those beyond the mesh's room are only counted */
    uint64_t room;
    /* corners with texture coordinates so far; those beyond the mesh's uv_count are only counted */
    uint64_t uv_count;
    uint64_t polygon_count; /* found so far */
    bvxi_polygon_fan *fans; /* of all polygons, or NULL while they are only counted */
    uint64_t fan_room;
    int32_t big;            /* byte order of a binary file */
    int32_t uvs_at_corners; /* 1: texture coordinates of faces are wanted */
    uint64_t corners;       /* of this row's face or strip so far */
    uint64_t uv_numbers;    /* of this row so far */
    uint32_t last[2];       /* a fan's first corner and the one before, a strip's last two */
} ply_file;

/* Read all rows of an element; reading goes on after it. */
bvx_status bvxi_ply_take_binary(ply_file *f, const ply_element *e);
bvx_status bvxi_ply_take_text(ply_file *f, const ply_element *e);

/* ---- failures: each says where, by the line of a text or the byte of a binary file ---- */

BVXI_COLD bvx_status bvxi_ply_fail_end(const ply_file *f, const ply_element *e, uint64_t row);
BVXI_COLD bvx_status bvxi_ply_fail_finite(const ply_file *f, const char *at, uint64_t row, int32_t role);
BVXI_COLD bvx_status bvxi_ply_fail_corner(const ply_file *f, const char *name, const char *at, uint64_t row,
                                          int64_t corner);
BVXI_COLD bvx_status bvxi_ply_fail_length(const ply_file *f, const ply_element *e, uint64_t row,
                                          int64_t count);

/* ---- what values mean ---- */

/* A row begins, and its list of corners or texture coordinates is there. */
static inline void bvxi_ply_begin_row(ply_file *f)
{
    f->corners = 0;
    f->uv_numbers = 0;
}
bvx_status bvxi_ply_end_row(ply_file *f, const ply_element *e, uint64_t row);

/* A number of a vertex, or of a list of texture coordinates, that stands at a place. */
bvx_status bvxi_ply_put(ply_file *f, const ply_property *property, const char *at, uint64_t row,
                        double value);

/* The fewest items of a list: a face has three corners or more. */
static inline int64_t bvxi_ply_least_length(const ply_property *property)
{
    return property->role == PLY_ROLE_CORNERS ? 3 : 0;
}

static inline void bvxi_ply_add_triangle(ply_file *f, uint32_t a, uint32_t b, uint32_t c)
{
    if (f->triangle_count < f->room) {
        uint32_t *const t = f->mesh->triangles + (size_t)f->triangle_count * 3;
        t[0] = a;
        t[1] = b;
        t[2] = c;
    }
    f->triangle_count++;
}

/* One more corner of a face: from the third on, each closes a triangle of the fan. */
static inline void bvxi_ply_add_corner(ply_file *f, uint32_t corner)
{
    if (f->corners == 0) f->last[0] = corner;
    if (f->corners >= 2) bvxi_ply_add_triangle(f, f->last[0], f->last[1], corner);
    f->last[1] = corner;
    f->corners++;
}

/* One more number of a strip: -1 begins the next, every other triangle stands the other way round. Triangles
 * with two equal corners only lead from one strip to another. */
static inline void bvxi_ply_add_strip_corner(ply_file *f, int64_t number)
{
    uint32_t const a = f->last[0], b = f->last[1], c = (uint32_t)number;

    if (number < 0) {
        f->corners = 0;
        return;
    }
    if (f->corners >= 2 && a != b && b != c && c != a) {
        if (f->corners % 2 == 0) bvxi_ply_add_triangle(f, a, b, c);
        else bvxi_ply_add_triangle(f, b, a, c);
    }
    f->last[0] = b;
    f->last[1] = c;
    f->corners++;
}

/* A corner of a face or strip in the list at a place. */
static inline bvx_status bvxi_ply_take_corner(ply_file *f, const ply_property *property, const char *at,
                                              uint64_t row, int64_t corner)
{
    int const is_strip = property->role == PLY_ROLE_STRIP;
    if ((corner < 0 || (uint64_t)corner >= f->vertex_count) && !(is_strip && corner == -1))
        return bvxi_ply_fail_corner(f, is_strip ? "strip" : "face", at, row, corner);
    if (is_strip) bvxi_ply_add_strip_corner(f, corner);
    else bvxi_ply_add_corner(f, (uint32_t)corner);
    return BVX_OK;
}

#endif
