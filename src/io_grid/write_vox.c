/* write_vox.c - a grid to MagicaVoxel's .vox: one model of at most 256 voxels a side.
 *
 * Source: https://github.com/ephtracy/voxel-model, file format 150. Chunks of a name, the bytes of their
 * content and of their children: MAIN around SIZE (three sides) and XYZI (a count, then x, y, z and a colour
 * number for each voxel). z is up there too. There is no place for a lattice. All voxels have colour 1, white
 * in the palette that holds when none is written. */
#include "io/formats.h"
#include "io_grid/grid_formats.h"

enum {
    VOX_MAX_SIDE = 256,
    VOX_VERSION = 150,
    VOX_COLOUR = 1,
    VOX_CHUNK = 12,
    VOX_START = 8,
    VOX_SIZE_BYTES = 12
};

/* The head of a chunk; returns where its content goes. */
static uint8_t *vox_put_chunk(uint8_t *p, const char *name, uint64_t content, uint64_t children)
{
    memcpy(p, name, 4);
    bvxi_store_u32(p + 4, (uint32_t)content);
    bvxi_store_u32(p + 8, (uint32_t)children);
    return p + VOX_CHUNK;
}

static void vox_put_voxels(const bvx_grid *grid, uint8_t *p)
{
    const uint64_t *word = grid->words;

    /* Each set bit once, lowest first; the last operation clears it. */
    for (int32_t z = 0; z < grid->size[2]; z++)
        for (int32_t y = 0; y < grid->size[1]; y++)
            for (int32_t k = 0; k < grid->words_per_row; k++)
                for (uint64_t w = *word++; w != 0; w &= w - 1, p += 4) {
                    p[0] = (uint8_t)(k * 64 + bvxi_lowest(w));
                    p[1] = (uint8_t)y;
                    p[2] = (uint8_t)z;
                    p[3] = VOX_COLOUR;
                }
}

bvx_status bvxi_write_vox(bvx_context *ctx, const bvx_grid *grid, bvx_buffer *file)
{
    static const char axis_name[3][2] = {"x", "y", "z"};
    uint64_t count = 0;
    bvx_buffer made = {0};
    uint8_t *p;

    for (int32_t a = 0; a < 3; a++)
        if (grid->size[a] > VOX_MAX_SIDE)
            return bvxi_fail_for(
                ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                "VOX: %d voxels along %s; the format holds %d a side: write windows of the grid, "
                "or take another format",
                (int64_t)grid->size[a], axis_name[a], (int64_t)VOX_MAX_SIDE);
    BVXI_TRY(bvxi_progress(ctx, "write", 0.0));
    BVXI_TRY(bvx_grid_count(ctx, grid, &count)); /* at most 2^24 */

    /* A chunk's head has the bytes of what follows, so they are summed up first. */
    uint64_t const voxels = 4 + 4 * count, children = 2 * VOX_CHUNK + VOX_SIZE_BYTES + voxels;
    BVXI_TRY(bvxi_make_buffer(ctx, VOX_START + VOX_CHUNK + children, "the VOX file", &made));
    p = made.bytes;
    memcpy(p, "VOX ", 4);
    bvxi_store_u32(p + 4, VOX_VERSION);
    p = vox_put_chunk(p + VOX_START, "MAIN", 0, children);
    p = vox_put_chunk(p, "SIZE", VOX_SIZE_BYTES, 0);
    for (int32_t a = 0; a < 3; a++, p += 4) bvxi_store_u32(p, (uint32_t)grid->size[a]);
    p = vox_put_chunk(p, "XYZI", voxels, 0);
    bvxi_store_u32(p, (uint32_t)count);
    vox_put_voxels(grid, p + 4);
    *file = made;
    return BVX_OK;
}
