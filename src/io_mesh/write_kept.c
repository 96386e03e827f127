/* write_kept.c - a level that uses the vertices of a glTF file: the file itself, with other triangles.
 *
 * Nodes, skins, animations, morph targets, all attributes and whatever else the file has stay as they are, byte for
 * byte. Each primitive gets its triangles back, by their vertices, as indices that follow the file's buffer. */
#include "io_mesh/glb.h"

enum { KEPT_HEAD = 20, KEPT_CHUNK = 8, KEPT_TRIANGLE = 12 };

int bvxi_glb_keeps(const bvx_mesh *level, const bvx_write_options *options)
{
    const bvx_mesh *const source = options->source;
    if (source == NULL || source->assets == NULL || source->assets->document == NULL) return 0;
    if (options->turn != BVX_TURN_NONE || options->quantize || options->names != NULL) return 0;
    if (level->vertex_count != source->vertex_count || level->position_type != source->position_type)
        return 0;
    for (int a = 0; a < 3; a++)
        if (level->frame[a] != 0.0) return 0;
    return memcmp(level->positions, source->positions, (size_t)source->vertex_count * 12) == 0;
}

/* Count triangles of each part in begin[part + 1], or put them to their places: then begin is where they end. */
static bvx_status take_triangles(bvx_context *ctx, const bvx_assets *assets, const bvx_mesh *level,
                                 uint64_t *begin, uint8_t *to)
{
    for (uint64_t t = 0; t < level->triangle_count; t++) {
        const uint32_t *const v = level->triangles + 3 * t;
        uint64_t part;

        /* The part that a triangle is of: by its vertices, then by its material, where parts share them. */
        const bvxi_asset_part *const parts = assets->parts;
        uint64_t low = 0, high = assets->part_count;

        while (high - low > 1) {
            uint64_t const middle = low + (high - low) / 2;
            if (parts[middle].base <= v[0]) low = middle;
            else high = middle;
        }
        for (part = low; level->materials != NULL && parts[part].material != level->materials[t]; --part)
            if (part == 0 || parts[part - 1].base != parts[low].base) break;
        for (int k = 0; k < 3; k++)
            if (v[k] < parts[low].base || v[k] - parts[low].base >= parts[low].vertices)
                return bvxi_fail(ctx, BVX_ERR_UNSUPPORTED,
                                 "GLB: triangle %u has vertices of two primitives of options.source", t);
        if (to == NULL) {
            begin[part + 1]++;
            continue;
        }
        for (int k = 0; k < 3; k++)
            bvxi_store_u32(to + KEPT_TRIANGLE * begin[part] + 4 * k,
                           v[assets->parts[part].flips && k > 0 ? 3 - k : k] -
                               (uint32_t)assets->parts[part].base);
        begin[part]++;
    }
    return BVX_OK;
}

/* The file's own description, with a larger buffer and its arrays continued. */
static void put_document(const bvx_assets *assets, const uint64_t *begin, uint64_t index_at, bvxi_output *out)
{
    uint64_t const bytes = begin[assets->part_count] * KEPT_TRIANGLE;

    bvxi_output_print(out, "%s,\"buffers\":[{\"byteLength\":%u}],\"bufferViews\":", assets->document,
                      index_at + bytes);
    bvxi_output_add(out, assets->views, bvxi_text_length(assets->views) - 1);
    bvxi_output_print(
        out, ",{\"buffer\":0,\"target\":34963,\"byteOffset\":%u,\"byteLength\":%u}],\"accessors\":", index_at,
        bytes);
    bvxi_output_add(out, assets->accessors, bvxi_text_length(assets->accessors) - 1);
    for (uint64_t i = 0; i < assets->part_count; i++)
        bvxi_output_print(
            out,
            ",{\"bufferView\":%u,\"byteOffset\":%u,\"componentType\":5125,\"count\":%u,\"type\":\"SCALAR\"}",
            (uint64_t)assets->view_count, begin[i] * KEPT_TRIANGLE, (begin[i + 1] - begin[i]) * 3);
    bvxi_output_print(out, "]}");
}

bvx_status bvxi_write_kept(bvx_context *ctx, const bvx_mesh *level, const bvx_assets *assets,
                           bvx_buffer *file)
{
    uint64_t const index_at = bvxi_glb_padded(assets->buffer_size);
    bvxi_output json = {0};
    uint64_t *begin, head, bytes;

    BVXI_TRY(bvxi_alloc_zero(ctx, BVXI_SCRATCH, (assets->part_count + 1) * 8, "the parts' ends", &begin));
    BVXI_TRY(take_triangles(ctx, assets, level, begin, NULL));
    /* A primitive must have some: one that has lost all gets one without area. */
    for (uint64_t i = 0; i < assets->part_count; i++)
        begin[i + 1] = begin[i] + (begin[i + 1] > 0 ? begin[i + 1] : 1);
    put_document(assets, begin, index_at, &json);
    head = KEPT_HEAD + bvxi_glb_padded(json.size) + KEPT_CHUNK;
    bytes = index_at + begin[assets->part_count] * KEPT_TRIANGLE;
    BVXI_TRY(bvxi_glb_check_size(ctx, head + bytes, 1));
    BVXI_TRY(bvxi_progress(ctx, "write", 0.5));
    BVXI_TRY(bvxi_make_buffer(ctx, head + bytes, "the GLB file", file));
    file->size = head + bytes;
    memset(file->bytes, 0, (size_t)file->size);
    json.bytes = bvxi_glb_put_head(json.size, bytes, file);
    json.size = 0;
    put_document(assets, begin, index_at, &json);
    memcpy(file->bytes + head, assets->buffer, (size_t)assets->buffer_size);
    return take_triangles(ctx, assets, level, begin, file->bytes + head + index_at);
}
