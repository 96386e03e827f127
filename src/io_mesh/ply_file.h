/* ply_file.h - a PLY file while it is read: what its header says, and its rows, taken alike from text and
 * from bytes. Not installed. */
#ifndef BVXI_PLY_FILE_H
#define BVXI_PLY_FILE_H

#include "io_mesh/mesh_formats.h"

/* ---- What the header of a PLY file says about the bytes after it ---- */

enum { PLY_ASCII = 1, PLY_LITTLE = 2, PLY_BIG = 3 };
enum { PLY_NONE = 0, PLY_I8, PLY_U8, PLY_I16, PLY_U16, PLY_I32, PLY_U32, PLY_F32, PLY_F64 };
enum { PLY_OTHER = 0, PLY_VERTEX = 1, PLY_FACE = 2, PLY_STRIPS = 3 };
enum {
    PLY_ROLE_NONE = -1,
    PLY_ROLE_X = 0,
    PLY_ROLE_Y = 1,
    PLY_ROLE_Z = 2,
    PLY_ROLE_RED = 3,
    PLY_ROLE_GREEN = 4,
    PLY_ROLE_BLUE = 5,
    PLY_ROLE_ALPHA = 6,
    PLY_ROLE_U = 7,
    PLY_ROLE_V = 8,
    PLY_ROLE_CORNERS = 9,
    PLY_ROLE_UVS = 10,
    PLY_ROLE_STRIP = 11
};

typedef struct ply_property {
    int8_t type;       /* of the value or of each item */
    int8_t count_type; /* PLY_NONE, or that of a list's length */
    int8_t role;       /* what the reader wants it for */
    int8_t set;        /* which of several names for the role it has: those of one set belong together */
} ply_property;

typedef struct ply_element {
    uint64_t count;       /* rows */
    uint64_t least_bytes; /* the fewest that a row can take */
    uint32_t first, end;  /* its properties */
    int32_t kind;         /* PLY_OTHER to PLY_STRIPS */
    /* properties that are lists: without any, each row takes least_bytes in a binary file */
    int32_t lists;
    const char *name; /* in the file */
    size_t name_size;
    const char *rows; /* where its rows begin; known when reading has come there */
} ply_element;

typedef struct ply_header {
    int32_t encoding;
    int32_t points; /* set before reading: vertices alone are wanted, faces may be missing */
    uint32_t element_count, property_count;
    uint64_t name_count;      /* of elements and properties together: what each array has room for */
    ply_element *elements;    /* scratch */
    ply_property *properties; /* scratch */
    ply_element *vertex, *face, *strips; /* NULL when there is none */
    int32_t colours, alpha;              /* 1: the vertices have them */
    int32_t uvs;           /* 1: the vertices have texture coordinates, 2: the faces' corners have */
    int32_t position_type; /* BVX_F32 when x, y and z are floats, else BVX_F64 */
    const char *data;      /* the first byte after the header */
} ply_header;

/* Read the header and hold it against the size of the file: counts that the bytes after it cannot hold are
 * refused. The header's arrays are freed by bvxi_ply_header_free, also after a failure. */
bvx_status bvxi_ply_header_read(bvxi_source *source, ply_header *header);

/* Bytes of a value in a binary file. */
static inline size_t ply_type_size(int32_t type)
{
    static const uint8_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[type];
}

/* ---- The rows of a PLY file as they are read, by text or bytes alike ---- */

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
