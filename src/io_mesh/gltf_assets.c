/* gltf_assets.c - materials, textures and images of a glTF file, kept beside the mesh as one block.
 *
 * Texts are those of the file: nothing in them is looked at but the names of extensions. An image's bytes are
 * its own, wherever they stood; one whose file was not found has none and keeps its uri. The block is laid out
 * twice by the same steps, to count and to fill. */
#include "io_mesh/glb.h"
#include "io_mesh/gltf.h"

enum { GLTF_EXTENSIONS = 256, GLTF_IMAGE_REPEATS = 4 };

/* The bytes of an image; none where its file was not found. */
static bvx_status gltf_take_image(bvxi_gltf *f, uint32_t i)
{
    bvxi_gltf_bytes *const image = &f->image[i];
    uint32_t const value = f->list[BVXI_GLTF_IMAGE][i];
    uint32_t const uri = bvxi_json_member(&f->json, value, "uri");
    uint64_t stride, at;
    uint32_t view;

    BVXI_TRY(bvxi_gltf_index(f, BVXI_GLTF_IMAGE, i, value, "bufferView", BVXI_GLTF_VIEW, &view));
    if (view != BVXI_JSON_NONE) return bvxi_gltf_view(f, view, &image->bytes, &image->size, &stride, &at);
    if (bvxi_json_kind(&f->json, uri) == BVXI_JSON_TEXT) BVXI_TRY(bvxi_gltf_uri(f, uri, image));
    if (image->bytes == NULL) f->lost |= BVX_LOST_IMAGES;
    return BVX_OK;
}

static const char *gltf_image_type(const bvxi_gltf_bytes *image)
{
    static const struct {
        const char *type;
        uint32_t at, size;
        const char *bytes;
    } known[] = {{"image/png", 0, 4, "\x89PNG"},
                 {"image/jpeg", 0, 3, "\xff\xd8\xff"},
                 {"image/webp", 8, 4, "WEBP"},
                 {"image/ktx2", 1, 6, "KTX 20"}};

    for (size_t k = 0; k < sizeof known / sizeof known[0]; k++)
        if (image->size >= known[k].at + known[k].size &&
            memcmp(image->bytes + known[k].at, known[k].bytes, known[k].size) == 0)
            return known[k].type;
    return NULL;
}

static void gltf_put_raw(const bvxi_json *j, uint32_t value, bvxi_output *out)
{
    bvxi_output_add(out, j->text + j->value[value].at, j->value[value].size);
}

/* Where the next byte goes; NULL while bytes are counted. */
static const char *gltf_put_place(const bvxi_output *out)
{
    return out->bytes != NULL ? (const char *)out->bytes + out->size : NULL;
}

/* An array of the file as it is; NULL when there is none. */
static const char *gltf_put_array(const bvxi_json *j, const char *member, bvxi_output *out)
{
    uint32_t const array = bvxi_json_member(j, 0, member);
    const char *const text = gltf_put_place(out);
    if (bvxi_json_kind(j, array) != BVXI_JSON_ARRAY) return NULL;
    gltf_put_raw(j, array, out);
    bvxi_output_add(out, "", 1);
    return text;
}

/* The members of an object but those of two names. Returns what parts them from further ones. */
static const char *gltf_put_others(const bvxi_json *j, uint32_t object, const char *without, const char *nor,
                                   bvxi_output *out)
{
    const char *before = "";

    for (uint32_t k = object + 1; k < j->value[object].next; k = j->value[k + 1].next) {
        if (bvxi_json_is(j, k, without) || bvxi_json_is(j, k, nor)) continue;
        bvxi_output_print(out, before);
        gltf_put_raw(j, k, out);
        bvxi_output_print(out, ":");
        gltf_put_raw(j, k + 1, out);
        before = ",";
    }
    return before;
}

/* ---- extensions ---- */

/* Mark those of the list that the value of a member holds under the name "extensions", at any depth. */
static void gltf_mark_extensions(const bvxi_json *j, const char *member, uint32_t list, uint32_t count,
                                 uint8_t *used)
{
    uint32_t const value = bvxi_json_member(j, 0, member);

    for (uint32_t i = value; value != BVXI_JSON_NONE && i + 1 < j->value[value].next; i++) {
        if (!bvxi_json_is(j, i, "extensions") || bvxi_json_kind(j, i + 1) != BVXI_JSON_OBJECT) continue;
        for (uint32_t k = i + 2; k < j->value[i + 1].next; k = j->value[k + 1].next) {
            uint32_t name = list + 1;
            for (uint32_t n = 0; n < count; n++, name = j->value[name].next)
                if (j->value[name].size == j->value[k].size &&
                    memcmp(j->text + j->value[name].at, j->text + j->value[k].at, j->value[k].size) == 0)
                    used[n] = 1;
        }
    }
}

/* Those of the file's extensionsUsed that materials, textures or samplers have. */
static const char *gltf_put_extensions(const bvxi_json *j, bvxi_output *out)
{
    uint32_t const list = bvxi_json_member(j, 0, "extensionsUsed");
    uint32_t const all = bvxi_json_kind(j, list) == BVXI_JSON_ARRAY ? bvxi_json_count(j, list) : 0;
    uint32_t const count = all < GLTF_EXTENSIONS ? all : GLTF_EXTENSIONS;
    const char *const text = gltf_put_place(out);
    uint8_t used[GLTF_EXTENSIONS] = {0};
    uint32_t name = list + 1;
    int some = 0;

    gltf_mark_extensions(j, "materials", list, count, used);
    gltf_mark_extensions(j, "textures", list, count, used);
    gltf_mark_extensions(j, "samplers", list, count, used);
    for (uint32_t n = 0; n < count; n++, name = j->value[name].next) {
        if (!used[n]) continue;
        bvxi_output_print(out, some ? "," : "[");
        gltf_put_raw(j, name, out);
        some = 1;
    }
    if (!some) return NULL;
    bvxi_output_print(out, "]");
    bvxi_output_add(out, "", 1);
    return text;
}

/* ---- the file kept ---- */

/* A mesh whose parts have new indices: one accessor each after those of the file. */
static void gltf_put_mesh(const bvxi_gltf *f, uint32_t mesh, bvxi_output *out)
{
    const bvxi_json *const j = &f->json;
    uint32_t const list = bvxi_json_member(j, mesh, "primitives"), count = bvxi_json_count(j, list);
    uint32_t value = list + 1;

    bvxi_output_print(out, "{");
    bvxi_output_print(out, "%s\"primitives\":[", gltf_put_others(j, mesh, "primitives", "primitives", out));
    for (uint32_t i = 0; i < count; i++, value = j->value[value].next) {
        bvxi_output_print(out, i > 0 ? "," : "");
        if (f->part_of[value] == BVXI_JSON_NONE) {
            gltf_put_raw(j, value, out);
            continue;
        }
        bvxi_output_print(out, "{");
        bvxi_output_print(out, "%s\"indices\":%u}", gltf_put_others(j, value, "indices", "mode", out),
                          (uint64_t)f->list_count[BVXI_GLTF_ACCESSOR] + f->part_of[value]);
    }
    bvxi_output_print(out, "]}");
}

/* All but the arrays that a level continues, which are put beside. */
static void gltf_put_file(const bvxi_gltf *f, bvx_assets *assets, bvxi_output *out)
{
    static const char *const without[] = {"meshes", "buffers", "bufferViews", "accessors"};
    const bvxi_json *const j = &f->json;

    if (f->parts == 0) return;
    assets->document = gltf_put_place(out);
    bvxi_output_print(out, "{\"meshes\":[");
    for (uint32_t i = 0; i < f->list_count[BVXI_GLTF_MESH]; i++) {
        bvxi_output_print(out, i > 0 ? "," : "");
        gltf_put_mesh(f, f->list[BVXI_GLTF_MESH][i], out);
    }
    bvxi_output_print(out, "]");
    for (uint32_t k = 1; k < j->value[0].next; k = j->value[k + 1].next) {
        int left_out = 0;
        for (int i = 0; i < 4; i++) left_out |= bvxi_json_is(j, k, without[i]);
        if (left_out) continue;
        bvxi_output_print(out, ",");
        bvxi_output_add(out, j->text + j->value[k].at,
                        (size_t)(j->value[k + 1].at + j->value[k + 1].size - j->value[k].at));
    }
    bvxi_output_add(out, "", 1);
    assets->views = gltf_put_array(j, "bufferViews", out);
    assets->accessors = gltf_put_array(j, "accessors", out);
    assets->buffer = (const uint8_t *)gltf_put_place(out);
    assets->buffer_size = f->buffer[0].size;
    bvxi_output_add(out, f->buffer[0].bytes, (size_t)f->buffer[0].size);
}

static void gltf_lay_out(const bvxi_gltf *f, bvx_assets *assets, bvxi_asset_image *images, bvxi_output *out)
{
    assets->materials = gltf_put_array(&f->json, "materials", out);
    assets->textures = gltf_put_array(&f->json, "textures", out);
    assets->samplers = gltf_put_array(&f->json, "samplers", out);
    assets->extensions_used = gltf_put_extensions(&f->json, out);
    for (uint32_t i = 0; i < f->list_count[BVXI_GLTF_IMAGE]; i++) {
        const bvxi_gltf_bytes *const from = &f->image[i];
        uint32_t const value = f->list[BVXI_GLTF_IMAGE][i];
        bvxi_asset_image image = {.members = gltf_put_place(out), .size = from->size};

        /* An image but what says where it was. A type that the file does not say is known by the bytes. */
        const char *const type = gltf_image_type(from);
        const char *const before = gltf_put_others(&f->json, value, "bufferView",
                                                   from->bytes != NULL ? "uri" : "bufferView", out);
        if (type != NULL && bvxi_json_member(&f->json, value, "mimeType") == BVXI_JSON_NONE)
            bvxi_output_print(out, "%s\"mimeType\":\"%s\"", before, type);
        bvxi_output_add(out, "", 1);
        image.bytes = (const uint8_t *)gltf_put_place(out);
        if (image.size > 0) bvxi_output_add(out, from->bytes, (size_t)image.size);
        if (images != NULL) images[i] = image;
    }

    /* What each material is coloured, without its texture: white where nothing is said. */
    const uint8_t *const to = (const uint8_t *)gltf_put_place(out);

    assets->textured = 0;
    for (uint32_t i = 0; i < f->list_count[BVXI_GLTF_MATERIAL]; i++) {
        uint32_t const look = bvxi_json_member(&f->json, f->list[BVXI_GLTF_MATERIAL][i],
                                               "pbrMetallicRoughness");
        uint32_t const base = bvxi_json_member(&f->json, look, "baseColorFactor");
        uint8_t colour[4] = {255, 255, 255, 255};

        assets->textured += bvxi_json_member(&f->json, look, "baseColorTexture") != BVXI_JSON_NONE;
        for (uint32_t k = 0, at = base + 1; k < 4 && k < bvxi_json_count(&f->json, base); k++) {
            double const light = bvxi_json_number(&f->json, at);
            colour[k] = k < 3 ? glb_colour_byte(light) : bvxi_colour_byte(light);
            at = f->json.value[at].next;
        }
        bvxi_output_add(out, colour, 4);
    }
    assets->base_colours = to;

    gltf_put_file(f, assets, out);
}

bvx_status bvxi_gltf_assets(bvxi_gltf *f, bvx_mesh *mesh)
{
    bvx_context *const ctx = f->source->ctx;
    uint64_t const image_bytes = (uint64_t)f->list_count[BVXI_GLTF_IMAGE] * sizeof(bvxi_asset_image);
    uint64_t const held = f->bytes;
    uint64_t bytes = 0, part_bytes;
    bvx_assets assets = {0};
    bvxi_output out = {0};

    if (f->list_count[BVXI_GLTF_MATERIAL] == 0 && f->parts == 0) return BVX_OK;

    /* Images may share a bufferView, and so be far larger together than their file. */
    for (uint32_t i = 0; i < f->list_count[BVXI_GLTF_IMAGE]; i++) {
        BVXI_TRY(gltf_take_image(f, i));
        bytes += f->image[i].size;
        if (bytes > GLTF_IMAGE_REPEATS * f->bytes)
            return BVXI_FILE_FAIL_FOR(f->source, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                                      "its images have more than %d times the bytes of the file",
                                      (int64_t)GLTF_IMAGE_REPEATS);
    }
    /* An image in a file of its own would not be where the kept one says. */
    if (f->bytes != held) f->parts = 0;
    if (f->parts > 0) f->lost &= BVX_LOST_IMAGES;
    part_bytes = f->parts * sizeof *f->part;
    gltf_lay_out(f, &assets, NULL, &out);

    assets.block_bytes = sizeof assets + part_bytes + image_bytes + out.size;
    BVXI_TRY(bvxi_alloc(ctx, BVXI_RESULT, assets.block_bytes, "materials and images", &mesh->assets));
    mesh->assets->block_bytes = assets.block_bytes; /* by which it is freed */
    bvxi_asset_part *const parts = (bvxi_asset_part *)(void *)(mesh->assets + 1);
    bvxi_asset_image *const images = (bvxi_asset_image *)(void *)(parts + f->parts);
    out.bytes = (uint8_t *)(images + f->list_count[BVXI_GLTF_IMAGE]);
    out.size = 0;
    gltf_lay_out(f, &assets, images, &out);
    assets.material_count = f->list_count[BVXI_GLTF_MATERIAL];
    assets.image_count = f->list_count[BVXI_GLTF_IMAGE];
    assets.images = images;
    if (f->parts > 0) memcpy(parts, f->part, (size_t)part_bytes);
    assets.parts = parts;
    assets.part_count = f->parts;
    assets.view_count = f->list_count[BVXI_GLTF_VIEW];
    *mesh->assets = assets;
    return BVX_OK;
}
