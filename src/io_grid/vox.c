/* vox.c - MagicaVoxel's .vox of one model, to grids and from them.
 *
 * Source: https://github.com/ephtracy/voxel-model, file format and its extension. */
#include "io_grid/grid_formats.h"

/* ---- Read ---- */

/* Versions 150 and 200. Chunks lie one after the other in MAIN; those for models are PACK (how many there are), SIZE and XYZI. All others (colours,
 * materials, the nodes of a scene) are passed, as are a model's place and turn in a scene. Everything is
 * checked before there is a grid; a grid is at most 2 MiB. */

enum { VOX_HEAD = 12, VOX_BEGIN = 8, VOX_LONGEST_SIDE = 256 };

typedef struct vox_model {
    const uint8_t *size;   /* content of the first SIZE chunk */
    const uint8_t *voxels; /* of the first XYZI chunk, after its count */
    uint64_t count;
    uint64_t sizes, models; /* SIZE and XYZI chunks */
    uint64_t said;          /* by PACK; 0: nothing was said */
} vox_model;

static bvx_status vox_take_chunk(const bvxi_grid_source *source, const uint8_t *chunk, uint32_t n,
                                 vox_model *model)
{
    const uint8_t *const content = chunk + VOX_HEAD;

    /* Of several models the first is kept and all are counted: more than one is refused with their number. */
    if (memcmp(chunk, "PACK", 4) == 0) {
        if (n != 4)
            return BVXI_BYTE_FAIL(source, chunk, BVX_ERR_FORMAT, "PACK has %u bytes, not 4", (uint64_t)n);
        model->said = bvxi_load_u32(content, 0);
        if (model->said == 0) return BVXI_BYTE_FAIL(source, content, BVX_ERR_FORMAT, "PACK says 0 models");
    } else if (memcmp(chunk, "SIZE", 4) == 0) {
        if (n != 12)
            return BVXI_BYTE_FAIL(source, chunk, BVX_ERR_FORMAT, "SIZE has %u bytes, not 12", (uint64_t)n);
        if (model->sizes++ == 0) model->size = content;
    } else if (memcmp(chunk, "XYZI", 4) == 0) {
        uint64_t const count = n < 4 ? 0 : bvxi_load_u32(content, 0);
        /* The chunk's length and the count inside it must say the same. */
        if (n < 4 || n - 4 != 4 * count)
            return BVXI_BYTE_FAIL(source, chunk, BVX_ERR_FORMAT, "XYZI has %u bytes; its %u voxels take %u",
                                  (uint64_t)n, count, 4 + 4 * count);
        if (model->sizes == 0) return BVXI_BYTE_FAIL(source, chunk, BVX_ERR_FORMAT, "XYZI before any SIZE");
        if (model->models++ == 0) {
            model->count = count;
            model->voxels = content + 4;
        }
    }
    return BVX_OK;
}

static bvx_status vox_walk(const bvxi_grid_source *source, const uint8_t *p, vox_model *model)
{
    while (p != source->end) {
        uint64_t const left = (uint64_t)(source->end - p);
        if (left < VOX_HEAD)
            return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte %u: the file ends in a chunk's head",
                                  bvxi_grid_byte(source, p) + left);
        uint32_t const content = bvxi_load_u32(p + 4, 0), children = bvxi_load_u32(p + 8, 0);
        /* Added in 64 bits, as two lengths of 32 bits can be more than 32 hold. */
        if ((uint64_t)content + children > left - VOX_HEAD)
            return BVXI_BYTE_FAIL(source, p, BVX_ERR_FORMAT, "a chunk of %u bytes, %u are left",
                                  (uint64_t)content + children, left - VOX_HEAD);
        BVXI_TRY(vox_take_chunk(source, p, content, model));
        p += VOX_HEAD + (size_t)content + (size_t)children;
    }
    return BVX_OK;
}

static bvx_status vox_check_start(const bvxi_grid_source *source)
{
    const uint8_t *const p = source->begin;
    uint64_t const size = (uint64_t)(source->end - p);

    if (size < VOX_BEGIN || memcmp(p, "VOX ", 4) != 0)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT,
                              "byte 0: the file does not begin with \"VOX \" and a version");
    uint32_t const version = bvxi_load_u32(p + 4, 0);
    if (version != 150 && version != 200)
        return BVXI_FILE_FAIL(source, BVX_ERR_UNSUPPORTED, "byte 4: version %u; 150 and 200 can be read",
                              (uint64_t)version);
    if (size < VOX_BEGIN + VOX_HEAD)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte %u: the file ends before its MAIN chunk", size);
    if (memcmp(p + VOX_BEGIN, "MAIN", 4) != 0)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte 8: the first chunk is not MAIN");

    uint64_t const content = bvxi_load_u32(p + VOX_BEGIN + 4, 0);
    uint64_t const children = bvxi_load_u32(p + VOX_BEGIN + 8, 0);
    if (content + children != size - VOX_BEGIN - VOX_HEAD)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "byte 12: MAIN holds %u bytes, the file has %u",
                              content + children, size - VOX_BEGIN - VOX_HEAD);
    return BVX_OK;
}

static bvx_status vox_check_model(const bvxi_grid_source *source, const vox_model *model, uint64_t dims[3])
{
    if (model->models > 1 || model->sizes > 1)
        return BVXI_FILE_FAIL(source, BVX_ERR_UNSUPPORTED,
                              "the file has %u models; save each in a file of its own",
                              model->models > model->sizes ? model->models : model->sizes);
    if (model->models == 0)
        return BVXI_BYTE_FAIL(source, source->end, BVX_ERR_FORMAT,
                              "the file ends without a model (SIZE and XYZI)");
    if (model->said > 1)
        return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT, "PACK says %u models, the file has 1", model->said);

    /* Coordinates are single bytes, so no side is longer than 256. */
    for (int32_t a = 0; a < 3; a++) {
        dims[a] = bvxi_load_u32(model->size + 4 * a, 0);
        if (dims[a] < 1 || dims[a] > VOX_LONGEST_SIDE)
            return BVXI_FILE_FAIL(source, BVX_ERR_FORMAT,
                                  "byte %u: SIZE says %u voxels along %s; 1 to %u are possible",
                                  bvxi_grid_byte(source, model->size) + 4 * (uint64_t)a, dims[a],
                                  bvxi_axis_name[a], (uint64_t)VOX_LONGEST_SIDE);
    }
    /* Every voxel is checked before there is a grid, so setting them needs no check. */
    for (uint64_t i = 0; i < model->count; i++)
        for (int32_t a = 0; a < 3; a++) {
            const uint8_t *const at = model->voxels + 4 * i + (uint64_t)a;
            if (*at >= dims[a])
                return BVXI_BYTE_FAIL(source, at, BVX_ERR_FORMAT, "voxel %u has %s = %u, SIZE says %u", i,
                                      bvxi_axis_name[a], (uint64_t)*at, dims[a]);
        }
    return BVX_OK;
}

bvx_status bvxi_read_vox(const bvxi_grid_source *source, bvx_grid *grid)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    vox_model model = {0};
    uint64_t dims[3];
    bvx_lattice box;
    bvx_window whole, part;

    /* The children of MAIN begin after its own content, which is empty in all known files. */
    BVXI_TRY(vox_check_start(source));
    BVXI_TRY(vox_walk(source,
                      source->begin + VOX_BEGIN + VOX_HEAD + bvxi_load_u32(source->begin + VOX_BEGIN + 4, 0),
                      &model));
    BVXI_TRY(vox_check_model(source, &model, dims));
    BVXI_TRY(bvxi_progress(source->ctx, "read", 0.0));
    /* A model has no place of its own: it begins at the origin with voxels of side 1. */
    BVXI_TRY(bvxi_file_box(source, origin, spacing, dims, &box));
    memset(whole.low, 0, sizeof whole.low);
    memcpy(whole.size, box.dims, sizeof whole.size);
    BVXI_TRY(bvxi_open_file_grid(source, &box, &whole, &part, grid));
    for (uint64_t i = 0; i < model.count; i++) {
        const uint8_t *const p = model.voxels + 4 * i;
        bvxi_set_file_run(grid, &part, p[0], (int64_t)p[0] + 1, p[1], p[2]);
    }
    return BVX_OK;
}

/* ---- Written ---- */

/* Version 150, at most 256 voxels a side. Chunks of a name, the bytes of their
 * content and of their children: MAIN around SIZE (three sides) and XYZI (a count, then x, y, z and a colour
 * number for each voxel). z is up there too. There is no place for a lattice. All voxels have colour 1, white
 * in the palette that holds when none is written. */

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
    uint64_t count = 0;
    bvx_buffer made = {0};

    for (int32_t a = 0; a < 3; a++)
        if (grid->size[a] > VOX_MAX_SIDE)
            return bvxi_fail_for(
                ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                "VOX: %d voxels along %s; the format holds %d a side: write windows of the grid, "
                "or take another format",
                (int64_t)grid->size[a], bvxi_axis_name[a], (int64_t)VOX_MAX_SIDE);
    BVXI_TRY(bvxi_progress(ctx, "write", 0.0));
    BVXI_TRY(bvx_grid_count(ctx, grid, &count)); /* at most 2^24 */

    /* A chunk's head has the bytes of what follows, so they are summed up first. */
    uint64_t const voxels = 4 + 4 * count, children = 2 * VOX_CHUNK + VOX_SIZE_BYTES + voxels;
    BVXI_TRY(bvxi_make_buffer(ctx, VOX_START + VOX_CHUNK + children, "the VOX file", &made));
    uint8_t *p = made.bytes;
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
