/* glb_json.c - the description of a GLB file: where its arrays lie, what they are, how meshes stand in the
 * world, and the materials that a file had.
 *
 * Sources: Khronos. glTF 2.0 Specification (ISO/IEC 12113:2022). Khronos. KHR_mesh_quantization. Microsoft.
 * MSFT_lod, a vendor extension. Each level has a node, which holds its mesh; all have the same translation and
 * scale: some readers of MSFT_lod swap nodes, others only their meshes. Bounds are given as the doubles that
 * the floats are, so that they hold whether a reader rounds them or not. Texts of materials, textures,
 * samplers and images are those of the file that they came from. */
#include "io_mesh/glb.h"

#define LOD_EXTENSION      "MSFT_lod"
#define QUANTIZE_EXTENSION "KHR_mesh_quantization"

enum { GLB_VERTEX_TARGET = 34962, GLB_INDEX_TARGET = 34963 };

/* ---- where arrays lie ---- */

static const bvxi_glb_kind glb_floats[BVXI_GLB_ARRAYS] = {
    {"POSITION", "VEC3", BVXI_GLB_FLOAT, 0, 12, 0},  {"NORMAL", "VEC3", BVXI_GLB_FLOAT, 0, 12, 0},
    {"COLOR_0", "VEC4", BVXI_GLB_U16, 1, 8, 0},      {"TEXCOORD_0", "VEC2", BVXI_GLB_FLOAT, 0, 8, 0},
    {"TEXCOORD_1", "VEC2", BVXI_GLB_FLOAT, 0, 8, 0}, {NULL, "SCALAR", BVXI_GLB_U32, 0, 4, 0},
};

/* Elements begin at multiples of four bytes. */
static const bvxi_glb_kind glb_quantized[BVXI_GLB_UV] = {
    {"POSITION", "VEC3", BVXI_GLB_U16, 0, 8, 1},
    {"NORMAL", "VEC3", BVXI_GLB_I8, 1, 4, 1},
    {"COLOR_0", "VEC4", BVXI_GLB_U16, 1, 8, 0},
};

static void glb_quantize_uv(bvxi_glb_kind *kind)
{
    kind->component = BVXI_GLB_U16;
    kind->normalized = 1;
    kind->size = 4;
}

void bvxi_glb_layout(bvxi_glb *glb, uint64_t begin)
{
    const bvx_mesh *const mesh = glb->mesh;
    uint64_t at = begin;

    memcpy(glb->kind, glb_floats, sizeof glb_floats);
    if (glb->frame->step > 0.0) {
        memcpy(glb->kind, glb_quantized, sizeof glb_quantized);
        if (glb->uv_unit) glb_quantize_uv(&glb->kind[BVXI_GLB_UV]);
        if (glb->uv2_unit) glb_quantize_uv(&glb->kind[BVXI_GLB_UV2]);
    }
    if (glb->vertices <= UINT16_MAX) { /* 65535 itself is no index in glTF */
        glb->kind[BVXI_GLB_INDEX].component = BVXI_GLB_U16;
        glb->kind[BVXI_GLB_INDEX].size = 2;
    }

    /* Arrays lie one after the other; those that the mesh lacks have a count of 0 and take no byte. */
    glb->count[BVXI_GLB_POSITION] = glb->count[BVXI_GLB_NORMAL] = glb->vertices;
    glb->count[BVXI_GLB_COLOUR] = mesh->colours != NULL ? glb->vertices : 0;
    glb->count[BVXI_GLB_UV] = mesh->uvs != NULL ? glb->vertices : 0;
    glb->count[BVXI_GLB_UV2] = mesh->uvs2 != NULL ? glb->vertices : 0;
    glb->count[BVXI_GLB_INDEX] = mesh->triangle_count * 3;
    for (int i = 0; i < BVXI_GLB_ARRAYS; i++) {
        glb->at[i] = at;
        at += glb->count[i] * glb->kind[i].size;
    }
    glb->end = at;
}

bvx_status bvxi_glb_check_size(bvx_context *ctx, uint64_t size, uint64_t levels)
{
    if (size <= UINT32_MAX) return BVX_OK;
    return bvxi_fail_for(ctx, BVX_ERR_RANGE, BVX_REASON_TOO_MANY,
                         "GLB: the file would take %u bytes or more, the format's limit is 2^32 - 1; %s",
                         size, levels > 1 ? "write one file a level" : "take PLY");
}

/* ---- texts of other files ---- */

/* An array without its brackets; 0: it is empty, or there is none. */
static size_t json_inner(const char *array, const char **inner)
{
    size_t n = array != NULL ? bvxi_text_length(array) : 0, first = 0;
    while (first < n && array[first] != '[') first++;
    while (n > first && array[n - 1] != ']') n--;
    for (first++; first < n && (array[first] == ' ' || (array[first] >= '\t' && array[first] <= '\r'));)
        first++;
    if (first + 1 >= n) return 0;
    *inner = array + first;
    return n - 1 - first;
}

static int json_names(const char *array, const char *name)
{
    size_t const n = array != NULL ? bvxi_text_length(array) : 0, length = bvxi_text_length(name);
    for (size_t i = 0; i + length + 2 <= n; i++)
        if (array[i] == '"' && array[i + 1 + length] == '"' && memcmp(array + i + 1, name, length) == 0)
            return 1;
    return 0;
}

static void json_copy(bvxi_output *out, const char *name, const char *array)
{
    const char *inner;
    if (json_inner(array, &inner) == 0) return; /* glTF has no empty arrays */
    bvxi_output_print(out, "\"%s\":%s,", name, array);
}

/* ---- parts of the description ---- */

static void glb_put_extensions(const bvxi_glb_file *file, bvxi_output *out)
{
    const char *const others = file->assets != NULL ? file->assets->extensions_used : NULL;
    const char *own[2] = {NULL, NULL}, *inner, *between = "";
    size_t const inner_size = json_inner(others, &inner);

    /* MSFT_lod is used, not required: a reader that does not know it shows the finest level. */
    if (file->levels > 1 && file->names == NULL && !json_names(others, LOD_EXTENSION)) own[0] = LOD_EXTENSION;
    if (file->frame.step > 0.0 && !json_names(others, QUANTIZE_EXTENSION)) own[1] = QUANTIZE_EXTENSION;
    if (own[0] == NULL && own[1] == NULL && inner_size == 0) return;

    bvxi_output_print(out, "\"extensionsUsed\":[");
    for (int i = 0; i < 2; i++) {
        if (own[i] == NULL) continue;
        bvxi_output_print(out, "%s\"%s\"", between, own[i]);
        between = ",";
    }
    if (inner_size != 0) {
        bvxi_output_print(out, between);
        bvxi_output_add(out, inner, inner_size);
    }
    bvxi_output_print(out, "],");
    if (file->frame.step > 0.0)
        bvxi_output_print(out, "\"extensionsRequired\":[\"" QUANTIZE_EXTENSION "\"],");
}

/* Of levels only the first node is in the scene: a viewer that does not know MSFT_lod shows the finest one.
 * Named meshes are no levels: all are in the scene. */
static void glb_put_nodes(const bvxi_glb_file *file, bvxi_output *out)
{
    bvxi_output_print(out, "\"scene\":0,\"scenes\":[{\"nodes\":[0");
    for (uint64_t i = 1; file->names != NULL && i < file->levels; i++) bvxi_output_print(out, ",%u", i);
    bvxi_output_print(out, "]}],\"nodes\":[");
    for (uint64_t i = 0; i < file->levels; i++) {
        bvxi_output_print(out, i > 0 ? ",{" : "{");
        if (file->names != NULL) bvxi_output_print(out, "\"name\":%q,", file->names[i]);
        else if (file->levels > 1) bvxi_output_print(out, "\"name\":\"level_%u\",", i);
        bvxi_output_print(out, "\"mesh\":%u", i);

        double const scale[3] = {file->frame.step, file->frame.step, file->frame.step};

        if (file->frame.origin[0] != 0.0 || file->frame.origin[1] != 0.0 || file->frame.origin[2] != 0.0)
            bvxi_output_print(out, ",\"translation\":[%v]", file->frame.origin, ",");
        if (file->frame.step > 0.0) bvxi_output_print(out, ",\"scale\":[%v]", scale, ",");

        if (i == 0 && file->names == NULL && file->levels > 1) {
            /* The nodes of the coarser levels, with hints for the part of the screen below which each level
             * gives way to the next: there the next one has as many triangles on a pixel as the first has
             * when it fills the screen. The last level is never removed. */
            double const finest = (double)file->level[0].mesh->triangle_count;
            double coverage = 1.0;

            for (uint64_t k = 1; k < file->levels; k++)
                bvxi_output_print(out, k == 1 ? ",\"extensions\":{\"" LOD_EXTENSION "\":{\"ids\":[%u" : ",%u",
                                  k);

            /* The first hint is for the finest level itself, so there is one for each level and the last is 0. */
            bvxi_output_print(out, "]}},\"extras\":{\"MSFT_screencoverage\":[");
            for (uint64_t j = 1; j < file->levels; j++) {
                double const share = (double)file->level[j].mesh->triangle_count / finest;
                if (share < coverage)
                    coverage = share; /* hints never grow, whatever the order of the levels is */
                bvxi_output_print(out, "%g,", coverage);
            }
            bvxi_output_print(out, "0]}");
        }
        bvxi_output_print(out, "}");
    }
    bvxi_output_print(out, "],");
}

/* Groups of triangles with a material; the last one is that of the default. */
static int glb_has_group(const bvxi_glb *glb, uint64_t group)
{
    return glb->group[group + 1] > glb->group[group];
}

/* One primitive a material; all share the level's vertices. */
static void glb_put_mesh(const bvxi_glb_file *file, uint64_t level, uint64_t *number, bvxi_output *out)
{
    const bvxi_glb *const glb = &file->level[level];
    uint64_t const first = *number;
    int put = 0;

    for (int i = 0; i < BVXI_GLB_INDEX; i++) *number += glb->count[i] != 0;
    bvxi_output_print(out, "{");
    if (file->names != NULL) bvxi_output_print(out, "\"name\":%q,", file->names[level]);
    bvxi_output_print(out, "\"primitives\":[");
    for (uint64_t g = 0; g <= file->materials; g++) {
        if (!glb_has_group(glb, g)) continue;
        bvxi_output_print(out, put++ != 0 ? ",{\"attributes\":{" : "{\"attributes\":{");
        uint64_t array = first;
        for (int i = 0; i < BVXI_GLB_INDEX; i++) {
            if (glb->count[i] == 0) continue;
            if (i > 0) bvxi_output_print(out, ",");
            /* glTF has no second texture coordinates without first ones: they stand for both. */
            if (i == BVXI_GLB_UV2 && glb->count[BVXI_GLB_UV] == 0)
                bvxi_output_print(out, "\"%s\":%u,", glb->kind[BVXI_GLB_UV].attribute, array);
            bvxi_output_print(out, "\"%s\":%u", glb->kind[i].attribute, array++);
        }
        bvxi_output_print(out, "},\"indices\":%u", (*number)++);
        if (g < file->materials || file->matte || file->colours != NULL)
            bvxi_output_print(out, ",\"material\":%u", file->colours != NULL ? level : g);
        bvxi_output_print(out, ",\"mode\":4}");
    }
    bvxi_output_print(out, "]}");
}

/* What the file's materials need. Views of images follow those of all levels. */
static void glb_put_assets(const bvxi_glb_file *file, uint64_t view, bvxi_output *out)
{
    const bvx_assets *const assets = file->assets;

    if (file->colours != NULL) {
        bvxi_output_print(out, "\"materials\":[");
        for (uint64_t i = 0; i < file->levels; i++) {
            const uint8_t *const colour = file->colours + 4 * i;
            double rgb[3];
            for (int c = 0; c < 3; c++) rgb[c] = (double)glb_linear_light[colour[c]] / UINT16_MAX;
            bvxi_output_print(out, "%s{\"name\":%q%s", i > 0 ? "," : "", file->names[i],
                              colour[3] < 255 ? ",\"alphaMode\":\"BLEND\"" : "");
            bvxi_output_print(out,
                              ",\"pbrMetallicRoughness\":{\"baseColorFactor\":[%v,%g],"
                              "\"metallicFactor\":0,\"roughnessFactor\":1}}",
                              rgb, ",", (double)colour[3] / UINT8_MAX);
        }
        bvxi_output_print(out, "],");
    }
    if (file->matte)
        bvxi_output_print(out, "\"materials\":[{\"pbrMetallicRoughness\":"
                               "{\"metallicFactor\":0,\"roughnessFactor\":1}}],");
    if (assets == NULL) return;
    json_copy(out, "materials", assets->materials);
    json_copy(out, "textures", assets->textures);
    json_copy(out, "samplers", assets->samplers);
    if (assets->image_count == 0) return;

    bvxi_output_print(out, "\"images\":[");
    for (uint64_t i = 0; i < assets->image_count; i++) {
        const char *const members = assets->images[i].members != NULL ? assets->images[i].members : "";
        bvxi_output_print(out, "%s{%s", i > 0 ? "," : "", members);
        if (assets->images[i].size > 0)
            bvxi_output_print(out, "%s\"bufferView\":%u", *members != 0 ? "," : "", view++);
        bvxi_output_print(out, "}");
    }
    bvxi_output_print(out, "],");
}

static void glb_put_view(uint64_t at, uint64_t size, bvxi_output *out)
{
    bvxi_output_print(out, "%s{\"buffer\":0,\"byteOffset\":%u,\"byteLength\":%u", at > 0 ? "," : "", at,
                      size);
}

static void glb_put_level_views(const bvxi_glb *glb, bvxi_output *out)
{
    for (int i = 0; i < BVXI_GLB_ARRAYS; i++) {
        uint64_t const size = glb->kind[i].size;
        if (glb->count[i] == 0) continue;
        glb_put_view(glb->at[i], glb->count[i] * size, out);
        if (glb->kind[i].padded) bvxi_output_print(out, ",\"byteStride\":%u", size);
        bvxi_output_print(out, ",\"target\":%u}",
                          (uint64_t)(i == BVXI_GLB_INDEX ? GLB_INDEX_TARGET : GLB_VERTEX_TARGET));
    }
}

/* An accessor but for its end; a part of an array begins at a byte of its view. */
static void glb_put_accessor(const bvxi_glb_kind *kind, uint64_t view, uint64_t offset, uint64_t count,
                             bvxi_output *out)
{
    bvxi_output_print(out, "%s{\"bufferView\":%u", view > 0 ? "," : "", view);
    if (offset > 0) bvxi_output_print(out, ",\"byteOffset\":%u", offset);
    bvxi_output_print(out, ",\"componentType\":%u%s,\"count\":%u,\"type\":\"%s\"", (uint64_t)kind->component,
                      kind->normalized ? ",\"normalized\":true" : "", count, kind->type);
}

/* view: the next one of the file */
static void glb_put_accessors(const bvxi_glb_file *file, const bvxi_glb *glb, uint64_t *view,
                              bvxi_output *out)
{
    const bvxi_glb_kind *const index = &glb->kind[BVXI_GLB_INDEX];

    for (int i = 0; i < BVXI_GLB_INDEX; i++) {
        if (glb->count[i] == 0) continue;
        glb_put_accessor(&glb->kind[i], (*view)++, 0, glb->count[i], out);
        if (i == BVXI_GLB_POSITION) {
            double low[3], high[3];

            for (int a = 0; a < 3; a++) {
                low[a] = (double)glb->low[a];
                high[a] = (double)glb->high[a];
            }
            bvxi_output_print(out, ",\"min\":[%v],\"max\":[%v]", low, ",", high, ",");
        }
        bvxi_output_print(out, "}");
    }

    for (uint64_t g = 0; g <= file->materials; g++) {
        uint64_t const begin = glb->group[g] * 3, end = glb->group[g + 1] * 3;
        if (!glb_has_group(glb, g)) continue;
        glb_put_accessor(index, *view, begin * index->size, end - begin, out);
        bvxi_output_print(out, "}");
    }
    (*view)++;
}

void bvxi_glb_put_json(const bvxi_glb_file *file, bvxi_output *out)
{
    uint64_t views = 0, view = 0;

    for (uint64_t l = 0; l < file->levels; l++)
        for (int i = 0; i < BVXI_GLB_ARRAYS; i++) views += file->level[l].count[i] != 0;

    bvxi_output_print(out, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"bitvox\"},");
    glb_put_extensions(file, out);
    glb_put_nodes(file, out);

    uint64_t number = 0;
    bvxi_output_print(out, "\"meshes\":[");
    for (uint64_t level = 0; level < file->levels; level++) {
        if (level > 0) bvxi_output_print(out, ",");
        glb_put_mesh(file, level, &number, out);
    }
    bvxi_output_print(out, "],");

    glb_put_assets(file, views, out);

    bvxi_output_print(out, "\"buffers\":[{\"byteLength\":%u}],", file->end);

    uint64_t at = bvxi_glb_padded(file->level[file->levels - 1].end);

    bvxi_output_print(out, "\"bufferViews\":[");
    for (uint64_t l = 0; l < file->levels; l++) glb_put_level_views(&file->level[l], out);
    for (uint64_t i = 0; i < bvxi_glb_images(file); i++) {
        uint64_t const size = file->assets->images[i].size;
        if (size == 0) continue;
        glb_put_view(at, size, out);
        bvxi_output_print(out, "}");
        at = bvxi_glb_padded(at + size);
    }
    bvxi_output_print(out, "],");

    bvxi_output_print(out, "\"accessors\":[");
    for (uint64_t l = 0; l < file->levels; l++) glb_put_accessors(file, &file->level[l], &view, out);
    bvxi_output_print(out, "]}");
}

void bvxi_level_name(const char *before, uint64_t level, char *text)
{
    bvxi_output out = {.bytes = (uint8_t *)text};
    bvxi_output_print(&out, "%s: level %u", before, level);
    bvxi_output_add(&out, "", 1);
}
