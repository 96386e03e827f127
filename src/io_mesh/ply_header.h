/* ply_header.h - what the header of a PLY file says about the bytes after it. Not installed. */
#ifndef BVXI_PLY_HEADER_H
#define BVXI_PLY_HEADER_H

#include "io_mesh/mesh_formats.h"

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
void bvxi_ply_header_free(bvx_context *ctx, ply_header *header);

/* Bytes of a value in a binary file. */
static inline size_t ply_type_size(int32_t type)
{
    static const uint8_t sizes[] = {0, 1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[type];
}

#endif
