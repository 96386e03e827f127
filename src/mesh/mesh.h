/* mesh.h - meshes made to receive a result, and the sort of keys that carry a number. Not installed. */
#ifndef BVXI_MESH_H
#define BVXI_MESH_H

#include "core/core.h"

/* Give a mesh arrays for the counts: the caller's own where it brings them (positions of the type requested,
 * triangles, and keys when keys is 1) and they suffice, new ones otherwise. The counts are set, the frame is
 * zero. BVX_ERR_ARGUMENT, BVX_ERR_CAPACITY, BVX_ERR_MEMORY, BVX_ERR_BUDGET; *mesh is then unchanged. */
bvx_status bvxi_mesh_open(bvx_context *ctx, const char *function, int32_t position_type, int32_t keys,
                          uint64_t vertex_count, uint64_t triangle_count, bvx_mesh *mesh);

/* How a mesh was filled after bvxi_mesh_open; mine: its arrays were made there, so after a failure they are freed,
 * while those of the caller are only emptied. */
bvx_status bvxi_mesh_made(bvx_context *ctx, bvx_status status, int mine, bvx_mesh *mesh);

/* A vertex of a mesh that was opened with positions of that type. */
static inline void bvxi_put_position(const bvx_mesh *mesh, int32_t type, uint64_t vertex, double x, double y,
                                     double z)
{
    if (type == BVX_F32) {
        float *const p = (float *)mesh->positions + 3 * vertex;
        p[0] = (float)x;
        p[1] = (float)y;
        p[2] = (float)z;
    } else {
        double *const p = (double *)mesh->positions + 3 * vertex;
        p[0] = x;
        p[1] = y;
        p[2] = z;
    }
}

/* Frees arrays of a mesh that owns them, and sets them to NULL; the counts stay. */
enum {
    BVXI_MESH_POSITIONS = 1,
    BVXI_MESH_TRIANGLES = 2,
    BVXI_MESH_KEYS = 4,
    BVXI_MESH_COLOURS = 8,
    BVXI_MESH_UVS = 16,
    BVXI_MESH_UV_TRIANGLES = 32,
    BVXI_MESH_NORMALS = 64,
    BVXI_MESH_UVS2 = 128,
    BVXI_MESH_MATERIALS = 256,
    BVXI_MESH_ASSETS = 512,
    BVXI_MESH_ALL = 1023
};
void bvxi_mesh_release(bvx_context *ctx, bvx_mesh *mesh, uint32_t arrays);

int bvxi_mesh_has_attributes(const bvx_mesh *mesh);

/* Materials, textures and images of a glTF file: one block, in which all pointers lead. The texts are JSON
 * arrays as the file has them, or NULL; an image's bytes are its own, whatever its bufferView or uri was. */
typedef struct bvxi_asset_image {
    const char
        *members; /* the members of its JSON object without uri and bufferView, such as "mimeType":"..." */
    const uint8_t *bytes;
    uint64_t size;
} bvxi_asset_image;

/* A primitive with triangles: its vertices in the mesh. Those that share vertices follow each other. */
typedef struct bvxi_asset_part {
    uint64_t base, vertices;
    uint32_t material;
    int32_t flips; /* 1: its triangles are turned in the mesh */
} bvxi_asset_part;

struct bvx_assets {
    uint64_t block_bytes; /* of all of it, this struct included */
    const char *materials, *textures, *samplers;
    const char *extensions_used; /* JSON array of those that materials and textures use */
    const uint8_t *base_colours; /* red, green, blue, alpha of materials, as sRGB; NULL: none are known */
    uint64_t material_count, image_count, textured; /* materials with a texture of their colour */
    const bvxi_asset_image *images;
    /* The whole file, where it is kept: its JSON without buffers, views and accessors, whose items are beside it, and
     * with the indices of parts that are to come as the last accessors. */
    const char *document, *views, *accessors;
    const uint8_t *buffer;
    const bvxi_asset_part *parts;
    uint64_t buffer_size, view_count, part_count;
};

static inline uint64_t bvxi_assets_bytes(const bvx_assets *assets)
{
    return assets != NULL ? assets->block_bytes : 0;
}

/* Refuse a mesh whose reserved fields are not zero. */
bvx_status bvxi_mesh_check_reserved(bvx_context *ctx, const char *function, const bvx_mesh *mesh);

/* ---- Sort 64-bit keys that carry a 32-bit number each ---- */

/* Sort keys and numbers by key, ascending; equal keys keep their order. Bytes that all keys share cost
 * nothing. count is below 2^32. Scratch: 12 bytes an element. */
bvx_status bvxi_radix_sort(bvx_context *ctx, uint64_t *keys, uint32_t *numbers, uint64_t count);

#endif
