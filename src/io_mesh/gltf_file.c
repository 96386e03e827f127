/* gltf_file.c - a glTF file opened: its container, its version and extensions, the lists of its description.
 *
 * Source: Khronos Group. glTF 2.0 Specification (ISO/IEC 12113:2022), chapters 3 and 4. Text and GLB are known
 * by their first bytes, whatever the file is called. An extension that a file requires is refused by its
 * name, unless nothing of the mesh depends on it. */
#include "io_mesh/gltf.h"

enum {
    GLTF_MAGIC = 0x46546c67,
    GLTF_CHUNK_JSON = 0x4e4f534a,
    GLTF_CHUNK_BIN = 0x004e4942,
    GLTF_HEAD = 12,
    GLTF_CHUNK_HEAD = 8
};

static const struct {
    const char *member, *one;
} gltf_lists[BVXI_GLTF_LISTS] = {
    [BVXI_GLTF_BUFFER] = {"buffers", "buffer"},
    [BVXI_GLTF_VIEW] = {"bufferViews", "bufferView"},
    [BVXI_GLTF_ACCESSOR] = {"accessors", "accessor"},
    [BVXI_GLTF_IMAGE] = {"images", "image"},
    [BVXI_GLTF_MATERIAL] = {"materials", "material"},
    [BVXI_GLTF_MESH] = {"meshes", "mesh"},
    [BVXI_GLTF_NODE] = {"nodes", "node"},
    [BVXI_GLTF_SCENE] = {"scenes", "scene"},
};

/* ---- messages and numbers ---- */

bvx_status bvxi_gltf_fail(const bvxi_gltf *f, int list, uint64_t i, const char *what)
{
    return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "%s %u: %s", gltf_lists[list].one, i, what);
}

bvx_status bvxi_gltf_item(const bvxi_gltf *f, int list, uint64_t i, const char *by, uint32_t *value)
{
    if (i >= f->list_count[list])
        return BVXI_FILE_FAIL_FOR(f->source, BVX_ERR_RANGE, BVX_REASON_INDEX, "%s names %s %u; there are %u",
                                  by, gltf_lists[list].one, i, (uint64_t)f->list_count[list]);
    *value = f->list[list][i];
    return BVX_OK;
}

bvx_status bvxi_gltf_whole(const bvxi_gltf *f, int list, uint64_t i, uint32_t object, const char *name,
                           uint64_t fallback, uint64_t *whole)
{
    uint32_t const value = bvxi_json_member(&f->json, object, name);
    double const v = bvxi_json_number(&f->json, value);

    *whole = fallback;
    if (value == BVXI_JSON_NONE && fallback != BVXI_GLTF_MUST) return BVX_OK;
    if (value == BVXI_JSON_NONE)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "%s %u has no %s", gltf_lists[list].one, i, name);
    if (bvxi_json_kind(&f->json, value) != BVXI_JSON_NUMBER || !(v >= 0.0 && v < 9007199254740992.0) ||
        v != (double)(uint64_t)v)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "%s %u: %s is not a whole number from 0 to 2^53",
                              gltf_lists[list].one, i, name);
    *whole = (uint64_t)v;
    return BVX_OK;
}

bvx_status bvxi_gltf_index(const bvxi_gltf *f, int list, uint64_t i, uint32_t object, const char *name,
                           int into, uint32_t *index)
{
    uint64_t whole;

    *index = BVXI_JSON_NONE;
    if (bvxi_json_member(&f->json, object, name) == BVXI_JSON_NONE) return BVX_OK;
    BVXI_TRY(bvxi_gltf_whole(f, list, i, object, name, 0, &whole));
    if (whole >= f->list_count[into])
        return BVXI_FILE_FAIL_FOR(f->source, BVX_ERR_RANGE, BVX_REASON_INDEX,
                                  "%s %u: %s is %u; there are %u %s", gltf_lists[list].one, i, name, whole,
                                  (uint64_t)f->list_count[into], gltf_lists[into].member);
    *index = (uint32_t)whole;
    return BVX_OK;
}

/* ---- container ---- */

/* The chunks of a GLB: the first is the description, the next may be the bytes of buffer 0. */
static bvx_status gltf_take_chunks(bvxi_gltf *f, const char **text, uint64_t *size)
{
    bvxi_source *const s = f->source;
    const uint8_t *const b = (const uint8_t *)s->begin;
    uint64_t const there = (uint64_t)(s->end - s->begin);
    uint64_t at = GLTF_HEAD, length;

    s->format = "GLB";
    if (there < GLTF_HEAD + GLTF_CHUNK_HEAD)
        return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT, "the file ends at byte %u, in its head", there);
    if (bvxi_load_u32(b + 4, 0) == 1)
        return BVXI_FILE_FAIL(s, BVX_ERR_UNSUPPORTED,
                              "the file is glTF 1.0, which is not read; convert it to glTF 2.0");
    if (bvxi_load_u32(b + 4, 0) != 2)
        return BVXI_FILE_FAIL(s, BVX_ERR_UNSUPPORTED, "the container's version is %u, not 2",
                              (uint64_t)bvxi_load_u32(b + 4, 0));
    length = bvxi_load_u32(b + 8, 0);
    if (length > there)
        return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT, "the file has %u bytes, its head says %u", there, length);

    for (int i = 0; at + GLTF_CHUNK_HEAD <= length; i++) {
        uint64_t const bytes = bvxi_load_u32(b + at, 0), kind = bvxi_load_u32(b + at + 4, 0);

        if (bytes > length - at - GLTF_CHUNK_HEAD)
            return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT, "byte %u: a chunk of %u bytes ends beyond the file", at,
                                  bytes);
        at += GLTF_CHUNK_HEAD;
        if (i == 0 && kind != GLTF_CHUNK_JSON)
            return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT, "byte %u: the first chunk is not JSON", at - 4);
        if (i == 0) {
            *text = s->begin + at;
            *size = bytes;
        } else if (kind == GLTF_CHUNK_BIN && f->chunk == NULL) {
            f->chunk = b + at;
            f->chunk_size = bytes;
        }
        at += bytes;
    }

    /* Some writers fill up with zeros where the format wants spaces. */
    while (*size > 0 && (*text)[*size - 1] == 0) --*size;
    return BVX_OK;
}

/* ---- version and extensions ---- */

static bvx_status gltf_check_version(const bvxi_gltf *f)
{
    const bvxi_json *const j = &f->json;
    uint32_t const asset = bvxi_json_member(j, 0, "asset");
    uint32_t const version = bvxi_json_member(j, asset, "version");
    uint32_t const least = bvxi_json_member(j, asset, "minVersion");
    char text[64] = "";
    uint32_t size = 0;

    /* The first version kept its lists as objects, and may say nothing of itself. */
    if (bvxi_json_kind(j, version) == BVXI_JSON_TEXT && j->value[version].size < sizeof text)
        size = bvxi_json_plain(j, version, text);
    if ((size >= 2 && memcmp(text, "1.", 2) == 0) ||
        bvxi_json_kind(j, bvxi_json_member(j, 0, "meshes")) == BVXI_JSON_OBJECT)
        return BVXI_FILE_FAIL(f->source, BVX_ERR_UNSUPPORTED,
                              "the file is glTF 1.0, which is not read; convert it to glTF 2.0");
    if (size < 2 || memcmp(text, "2.", 2) != 0)
        return BVXI_FILE_FAIL(f->source, size == 0 ? BVX_ERR_FORMAT : BVX_ERR_UNSUPPORTED,
                              "asset.version is not 2.0");
    if (least != BVXI_JSON_NONE && !bvxi_json_is(j, least, "2.0"))
        return BVXI_FILE_FAIL(f->source, BVX_ERR_UNSUPPORTED,
                              "asset.minVersion is not 2.0, which is what is read");
    return BVX_OK;
}

/* 1 when no vertex and no triangle depends on an extension; those of materials and textures are passed on. */
static int gltf_knows_extension(const char *name)
{
    static const char *const known[] = {
        "KHR_mesh_quantization", "KHR_texture_transform", "KHR_texture_basisu", "EXT_texture_webp",
        "EXT_texture_avif",      "MSFT_texture_dds",      "KHR_lights_punctual"};
    static const char materials[] = "KHR_materials_";

    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++)
        if (bvxi_text_length(name) == bvxi_text_length(known[i]) &&
            memcmp(name, known[i], bvxi_text_length(name)) == 0)
            return 1;
    return bvxi_text_length(name) > sizeof materials - 1 &&
           memcmp(name, materials, sizeof materials - 1) == 0;
}

static bvx_status gltf_check_extensions(const bvxi_gltf *f)
{
    static const char *const packed[] = {"KHR_draco_mesh_compression", "EXT_meshopt_compression",
                                         "KHR_meshopt_compression"};
    const bvxi_json *const j = &f->json;
    uint32_t const list = bvxi_json_member(j, 0, "extensionsRequired");
    uint32_t const count = bvxi_json_kind(j, list) == BVXI_JSON_ARRAY ? bvxi_json_count(j, list) : 0;
    uint32_t value = list + 1;

    for (uint32_t i = 0; i < count; i++, value = j->value[value].next) {
        char name[96] = "";

        if (bvxi_json_kind(j, value) == BVXI_JSON_TEXT && j->value[value].size < sizeof name)
            (void)bvxi_json_plain(j, value, name);
        for (char *c = name; *c != 0; c++)
            if ((unsigned char)*c < ' ') *c = '?'; /* a message is one line */
        for (size_t k = 0; k < sizeof packed / sizeof packed[0]; k++)
            if (bvxi_json_is(j, value, packed[k]))
                return BVXI_FILE_FAIL(f->source, BVX_ERR_UNSUPPORTED,
                                      "its meshes are compressed by %s, which is not read; export the file "
                                      "without mesh compression",
                                      packed[k]);
        if (!gltf_knows_extension(name))
            return BVXI_FILE_FAIL(f->source, BVX_ERR_UNSUPPORTED,
                                  "the file requires the extension '%s', which is not known", name);
    }
    return BVX_OK;
}

/* ---- lists ---- */

bvx_status bvxi_gltf_open(bvxi_gltf *f)
{
    bvxi_source *const s = f->source;
    const char *text = bvxi_skip_mark(s->begin, s->end);
    uint64_t size = (uint64_t)(s->end - text);

    f->bytes = (uint64_t)(s->end - s->begin);
    if (f->bytes >= 4 && bvxi_load_u32((const uint8_t *)s->begin, 0) == GLTF_MAGIC)
        BVXI_TRY(gltf_take_chunks(f, &text, &size));
    BVXI_TRY(bvxi_json_read(s, text, size, &f->json));
    if (bvxi_json_kind(&f->json, 0) != BVXI_JSON_OBJECT)
        return BVXI_FILE_FAIL(s, BVX_ERR_FORMAT, "the JSON is not an object");
    BVXI_TRY(gltf_check_version(f));
    BVXI_TRY(gltf_check_extensions(f));
    const bvxi_json *const j = &f->json;

    for (int k = 0; k < BVXI_GLTF_LISTS; k++) {
        uint32_t const array = bvxi_json_member(j, 0, gltf_lists[k].member);
        uint32_t const count = bvxi_json_count(j, array);
        uint32_t value = array + 1;

        if (array == BVXI_JSON_NONE) continue;
        if (bvxi_json_kind(j, array) != BVXI_JSON_ARRAY)
            return BVXI_FILE_FAIL(f->source, BVX_ERR_FORMAT, "%s is not an array", gltf_lists[k].member);
        BVXI_TRY(bvxi_alloc(f->source->ctx, BVXI_SCRATCH, (uint64_t)count * 4, "the lists of a glTF file",
                            &f->list[k]));
        for (uint32_t i = 0; i < count; i++, value = j->value[value].next) {
            f->list[k][i] = value;
            if (bvxi_json_kind(j, value) != BVXI_JSON_OBJECT)
                return bvxi_gltf_fail(f, k, i, "it is not an object");
        }
        f->list_count[k] = count;
    }
    BVXI_TRY(BVXI_ZEROS(f->source->ctx, (uint64_t)f->list_count[BVXI_GLTF_BUFFER], "the buffers", f->buffer));
    return BVXI_ZEROS(f->source->ctx, (uint64_t)f->list_count[BVXI_GLTF_IMAGE], "the images", f->image);
}
