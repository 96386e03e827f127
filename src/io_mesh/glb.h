/* glb.h - what the files that write a GLB share: vertices repeated along seams of textures, arrays of a
 * mesh, triangles by material, colours as linear light, which glTF wants. Not installed. */
#ifndef BVXI_GLB_H
#define BVXI_GLB_H

#include "io_mesh/mesh_formats.h"

#include <stdint.h>

/* ---- What the files that make a GLB share ---- */

/* Vertices repeated, so that each has one texture coordinate. */
typedef struct bvxi_seams {
    uint32_t *triangles;   /* vertices as written [Size: triangle_count * 3] */
    uint32_t *vertex, *uv; /* of the mesh, for each as written [Size: count] */
    uint64_t count;
} bvxi_seams;

/* Indices come last: all before them are multiples of four bytes. */
enum {
    BVXI_GLB_POSITION,
    BVXI_GLB_NORMAL,
    BVXI_GLB_COLOUR,
    BVXI_GLB_UV,
    BVXI_GLB_UV2,
    BVXI_GLB_INDEX,
    BVXI_GLB_ARRAYS
};

enum { BVXI_GLB_I8 = 5120, BVXI_GLB_U16 = 5123, BVXI_GLB_U32 = 5125, BVXI_GLB_FLOAT = 5126 };

/* What the elements of an array are. */
typedef struct bvxi_glb_kind {
    const char *attribute; /* NULL: indices */
    const char *type;
    int32_t component, normalized;
    uint64_t size; /* bytes of an element, with padding */
    int32_t padded;
} bvxi_glb_kind;

/* One mesh of a file and where its arrays lie. */
typedef struct bvxi_glb {
    const bvx_mesh *mesh;
    const bvxi_file_frame *frame; /* that positions are relative to */
    double *normal;               /* sums of bvxi_add_normals, where the mesh has no normals */
    bvxi_seams seams;             /* zero: vertices are those of the mesh */
    uint32_t *order;              /* triangles by material; NULL: as they are */
    uint64_t *group; /* where those of each material begin in it and all of them end [Size: materials + 2] */
    int uv_unit, uv2_unit; /* 1: all texture coordinates are in 0..1 */
    float low[3], high[3]; /* of the positions as written */
    uint64_t vertices;     /* as written */
    bvxi_glb_kind kind[BVXI_GLB_ARRAYS];
    uint64_t count[BVXI_GLB_ARRAYS]; /* elements of each array, 0 where the mesh has none */
    uint64_t at[BVXI_GLB_ARRAYS];    /* place in the binary chunk */
    uint64_t end;                    /* of the last array */
} bvxi_glb;

/* What a file holds: levels of detail, the finest first; a mesh alone is the case of one. */
typedef struct bvxi_glb_file {
    bvxi_glb *level;
    uint64_t levels;
    bvxi_file_frame frame;
    const bvx_assets *assets; /* NULL: none */
    uint64_t materials;       /* of the assets; triangles of others have the default */
    int matte;                /* colours alone: the default would be a metal, so one is written */
    const char *const *names; /* of meshes that are no levels, or NULL */
    const uint8_t *colours;   /* of their materials, or NULL [Size: levels * 4] */
    uint64_t end;             /* of the binary chunk, without padding */
} bvxi_glb_file;

/* Chunks and levels begin at multiples of four bytes. */
static inline uint64_t bvxi_glb_padded(uint64_t size)
{
    return (size + 3) / 4 * 4;
}

static inline uint64_t bvxi_glb_images(const bvxi_glb_file *file)
{
    return file->assets != NULL ? file->assets->image_count : 0;
}

/* Fill kind, count, at and end from all else; the arrays begin at a place of the binary chunk. */
void bvxi_glb_layout(bvxi_glb *glb, uint64_t begin);
/* BVX_ERR_RANGE when a file of that many bytes would be larger than the format allows. */
bvx_status bvxi_glb_check_size(bvx_context *ctx, uint64_t size, uint64_t levels);
/* All but the description of a file whose sizes are known; returns the description's place. */
uint8_t *bvxi_glb_put_head(uint64_t json, uint64_t end, bvx_buffer *file);
/* The description of the file, without padding. */
void bvxi_glb_put_json(const bvxi_glb_file *file, bvxi_output *out);

/* ---- Colours as glTF wants them at vertices: linear light ---- */

/* Entry v is 65535 * f(v / 255) rounded, f the sRGB curve of IEC 61966-2-1: x / 12.92 up to 0.04045, ((x +
 * 0.055) / 1.055)^2.4 above. 16 bits, since 8 would make one of many dark tones. The test of the writer
 * computes the table anew. */

static const uint16_t glb_linear_light[256] = {
    0,     20,    40,    60,    80,    99,    119,   139,   159,   179,   199,   219,   241,   264,   288,
    313,   340,   367,   396,   427,   458,   491,   526,   562,   599,   637,   677,   718,   761,   805,
    851,   898,   947,   997,   1048,  1101,  1156,  1212,  1270,  1330,  1391,  1453,  1517,  1583,  1651,
    1720,  1790,  1863,  1937,  2013,  2090,  2170,  2250,  2333,  2418,  2504,  2592,  2681,  2773,  2866,
    2961,  3058,  3157,  3258,  3360,  3464,  3570,  3678,  3788,  3900,  4014,  4129,  4247,  4366,  4488,
    4611,  4736,  4864,  4993,  5124,  5257,  5392,  5530,  5669,  5810,  5953,  6099,  6246,  6395,  6547,
    6700,  6856,  7014,  7174,  7335,  7500,  7666,  7834,  8004,  8177,  8352,  8528,  8708,  8889,  9072,
    9258,  9445,  9635,  9828,  10022, 10219, 10417, 10619, 10822, 11028, 11235, 11446, 11658, 11873, 12090,
    12309, 12530, 12754, 12980, 13209, 13440, 13673, 13909, 14146, 14387, 14629, 14874, 15122, 15371, 15623,
    15878, 16135, 16394, 16656, 16920, 17187, 17456, 17727, 18001, 18277, 18556, 18837, 19121, 19407, 19696,
    19987, 20281, 20577, 20876, 21177, 21481, 21787, 22096, 22407, 22721, 23038, 23357, 23678, 24002, 24329,
    24658, 24990, 25325, 25662, 26001, 26344, 26688, 27036, 27386, 27739, 28094, 28452, 28813, 29176, 29542,
    29911, 30282, 30656, 31033, 31412, 31794, 32179, 32567, 32957, 33350, 33745, 34143, 34544, 34948, 35355,
    35764, 36176, 36591, 37008, 37429, 37852, 38278, 38706, 39138, 39572, 40009, 40449, 40891, 41337, 41785,
    42236, 42690, 43147, 43606, 44069, 44534, 45002, 45473, 45947, 46423, 46903, 47385, 47871, 48359, 48850,
    49344, 49841, 50341, 50844, 51349, 51858, 52369, 52884, 53401, 53921, 54445, 54971, 55500, 56032, 56567,
    57105, 57646, 58190, 58737, 59287, 59840, 60396, 60955, 61517, 62082, 62650, 63221, 63795, 64372, 64952,
    65535};

/* The byte whose linear light is nearest: that table, searched by halves. */
static inline uint8_t glb_colour_byte(double light)
{
    double const wanted = light > 0.0 ? light < 1.0 ? light * 65535.0 : 65535.0 : 0.0;
    int low = 0, high = 255;

    while (high - low > 1) {
        int const middle = (low + high) / 2;
        if ((double)glb_linear_light[middle] <= wanted) low = middle;
        else high = middle;
    }
    return (uint8_t)(wanted - (double)glb_linear_light[low] <= (double)glb_linear_light[high] - wanted
                         ? low
                         : high);
}

#endif
