/* glb_json.c - the description of a GLB file: where its arrays lie, what they are, how meshes stand in the
 * world.
 *
 * Sources: Khronos. glTF 2.0 Specification (ISO/IEC 12113:2022). Microsoft. MSFT_lod, a vendor extension of
 * it. A node turns z up into glTF's y up, (x, y, z) to (x, z, -y), as a matrix of zeros and ones: a
 * quaternion would have rounded roots in it. For one mesh a second node below it carries the centre, in the
 * world's own axes. Levels of detail have one node each, which holds the mesh itself, and all have the same
 * matrix: some readers of the extension swap nodes, others only their meshes. Bounds are given as the doubles
 * that the floats are, so that they hold whether a reader rounds them or not. */
#include "io_mesh/glb.h"

typedef struct glb_kind {
    const char *attribute; /* NULL: indices */
    const char *type;
    int32_t component, normalized;
} glb_kind;

enum {
    GLB_FLOAT = 5126,
    GLB_U16 = 5123,
    GLB_U32 = 5125,
    GLB_VERTEX_TARGET = 34962,
    GLB_INDEX_TARGET = 34963
};

static const glb_kind glb_kinds[BVXI_GLB_ARRAYS] = {
    {"POSITION", "VEC3", GLB_FLOAT, 0},   {"NORMAL", "VEC3", GLB_FLOAT, 0}, {"COLOR_0", "VEC4", GLB_U16, 1},
    {"TEXCOORD_0", "VEC2", GLB_FLOAT, 0}, {NULL, "SCALAR", 0, 0},
};

void bvxi_glb_layout(bvxi_glb *glb, uint64_t begin)
{
    static const uint64_t size[BVXI_GLB_ARRAYS] = {12, 12, 8, 8, 0};
    uint64_t at = begin;

    /* Arrays lie one after the other; those that the mesh lacks have a count of 0 and take no byte. */
    memcpy(glb->size, size, sizeof glb->size);
    glb->size[BVXI_GLB_INDEX] = glb->vertices <= UINT16_MAX ? 2 : 4; /* 65535 itself is no index in glTF */
    glb->count[BVXI_GLB_POSITION] = glb->count[BVXI_GLB_NORMAL] = glb->vertices;
    glb->count[BVXI_GLB_COLOUR] = glb->mesh->colours != NULL ? glb->vertices : 0;
    glb->count[BVXI_GLB_UV] = glb->mesh->uvs != NULL ? glb->vertices : 0;
    /* last: all before it are multiples of 4 bytes */
    glb->count[BVXI_GLB_INDEX] = glb->mesh->triangle_count * 3;
    for (int i = 0; i < BVXI_GLB_ARRAYS; i++) {
        glb->at[i] = at;
        at += glb->count[i] * glb->size[i];
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

/* ---- pieces of JSON ---- */

static void json_name(bvxi_output *out, const char *name)
{
    bvxi_output_text(out, "\"");
    bvxi_output_text(out, name);
    bvxi_output_text(out, "\":");
}

static void json_whole(bvxi_output *out, const char *name, uint64_t value)
{
    json_name(out, name);
    bvxi_output_number(out, value);
}

static void json_double(bvxi_output *out, double value)
{
    char text[32];
    bvxi_output_add(out, text, (size_t)bvxi_print_double(value, text));
}

static void json_three(bvxi_output *out, const char *name, const double value[3])
{
    json_name(out, name);
    for (int a = 0; a < 3; a++) {
        bvxi_output_text(out, a == 0 ? "[" : ",");
        json_double(out, value[a]);
    }
    bvxi_output_text(out, "]");
}

/* ---- parts of the description ---- */

/* Only the first node is in the scene: a viewer that does not know the extension shows the finest level. */
static void glb_put_scene(bvxi_output *out)
{
    bvxi_output_text(out, "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":[");
}

static void glb_put_nodes(const bvxi_glb *glb, bvxi_output *out)
{
    glb_put_scene(out);
    bvxi_output_text(out, "{\"children\":[1],\"matrix\":[1,0,0,0,0,0,-1,0,0,1,0,0,0,0,0,1]},{\"mesh\":0,");
    json_three(out, "translation", glb->centre);
    bvxi_output_text(out, "}],");
}

/* Hints for the part of the screen below which each level gives way to the next: there the next one has as
 * many triangles on a pixel as the first has when it fills the screen. The last level is never removed. */
static void glb_put_coverage(const bvxi_glb_file *file, bvxi_output *out)
{
    double const finest = (double)file->level[0].mesh->triangle_count;
    double coverage = 1.0;

    /* The first hint is for the finest level itself, so there is one for each level and the last is 0. */
    bvxi_output_text(out, ",\"extras\":{\"MSFT_screencoverage\":[");
    for (uint64_t i = 1; i < file->levels; i++) {
        double const share = (double)file->level[i].mesh->triangle_count / finest;
        if (share < coverage) coverage = share; /* hints never grow, whatever the order of the levels is */
        json_double(out, coverage);
        bvxi_output_text(out, ",");
    }
    bvxi_output_text(out, "0]}");
}

static void glb_put_level_nodes(const bvxi_glb_file *file, bvxi_output *out)
{
    const double *const centre = file->level[0].centre;
    /* A matrix holds its translation in the axes of the parent: the centre is turned like everything else. */
    double const turned[3] = {centre[0], centre[2], 0.0 - centre[1]};

    /* The extension is used, not required: a reader that does not know it shows the finest level. */
    bvxi_output_text(out, "\"extensionsUsed\":[\"MSFT_lod\"],");
    glb_put_scene(out);
    for (uint64_t i = 0; i < file->levels; i++) {
        bvxi_output_text(out, i > 0 ? "},{\"name\":\"level_" : "{\"name\":\"level_");
        bvxi_output_number(out, i);
        bvxi_output_text(out, "\",");
        json_whole(out, "mesh", i);
        bvxi_output_text(out, ",\"matrix\":[1,0,0,0,0,0,-1,0,0,1,0,0");
        for (int a = 0; a < 3; a++) {
            bvxi_output_text(out, ",");
            json_double(out, turned[a]);
        }
        bvxi_output_text(out, ",1]");
        if (i > 0) continue;

        /* The finest level names the others. */
        bvxi_output_text(out, ",\"extensions\":{\"MSFT_lod\":{\"ids\":[");
        for (uint64_t k = 1; k < file->levels; k++) {
            if (k > 1) bvxi_output_text(out, ",");
            bvxi_output_number(out, k);
        }
        bvxi_output_text(out, "]}}");
        glb_put_coverage(file, out);
    }
    bvxi_output_text(out, "}],");
}

/* Arrays that a mesh lacks have no number. */
static void glb_put_meshes(const bvxi_glb_file *file, bvxi_output *out)
{
    uint64_t number = 0;

    bvxi_output_text(out, "\"meshes\":[");
    for (uint64_t level = 0; level < file->levels; level++) {
        if (level > 0) bvxi_output_text(out, ",");
        bvxi_output_text(out, "{\"primitives\":[{\"attributes\":{");
        for (int i = 0; i < BVXI_GLB_ARRAYS; i++) {
            if (file->level[level].count[i] == 0) continue;
            if (i == BVXI_GLB_INDEX) bvxi_output_text(out, "},");
            else if (i > 0) bvxi_output_text(out, ",");
            json_whole(out, i == BVXI_GLB_INDEX ? "indices" : glb_kinds[i].attribute, number++);
        }
        bvxi_output_text(out, ",\"material\":0,\"mode\":4}]}");
    }
    bvxi_output_text(out, "],\"materials\":[{\"pbrMetallicRoughness\":"
                          "{\"metallicFactor\":0,\"roughnessFactor\":1},\"doubleSided\":true}],");
}

static void glb_put_views(const bvxi_glb *glb, bvxi_output *out)
{
    for (int i = 0; i < BVXI_GLB_ARRAYS; i++) {
        /* Views and accessors are numbered alike, so both leave out the arrays that are not there. */
        if (glb->count[i] == 0) continue;
        bvxi_output_text(out, glb->at[i] > 0 ? ",{\"buffer\":0," : "{\"buffer\":0,");
        json_whole(out, "byteOffset", glb->at[i]);
        bvxi_output_text(out, ",");
        json_whole(out, "byteLength", glb->count[i] * glb->size[i]);
        bvxi_output_text(out, ",");
        json_whole(out, "target", i == BVXI_GLB_INDEX ? GLB_INDEX_TARGET : GLB_VERTEX_TARGET);
        bvxi_output_text(out, "}");
    }
}

static void glb_put_bounds(const bvxi_glb *glb, bvxi_output *out)
{
    double low[3], high[3];

    for (int a = 0; a < 3; a++) {
        low[a] = (double)glb->low[a];
        high[a] = (double)glb->high[a];
    }
    bvxi_output_text(out, ",");
    json_three(out, "min", low);
    bvxi_output_text(out, ",");
    json_three(out, "max", high);
}

/* number: of the next accessor in the file, and of its view */
static void glb_put_accessors(const bvxi_glb *glb, uint64_t *number, bvxi_output *out)
{
    for (int i = 0; i < BVXI_GLB_ARRAYS; i++) {
        const glb_kind *const kind = &glb_kinds[i];

        /* Indices have the one type that depends on the mesh. */
        int32_t const index = glb->size[BVXI_GLB_INDEX] == 2 ? GLB_U16 : GLB_U32;
        if (glb->count[i] == 0) continue;
        bvxi_output_text(out, *number > 0 ? ",{" : "{");
        json_whole(out, "bufferView", (*number)++);
        bvxi_output_text(out, ",");
        json_whole(out, "componentType", (uint64_t)(i == BVXI_GLB_INDEX ? index : kind->component));
        if (kind->normalized) bvxi_output_text(out, ",\"normalized\":true");
        bvxi_output_text(out, ",");
        json_whole(out, "count", glb->count[i]);
        bvxi_output_text(out, ",\"type\":\"");
        bvxi_output_text(out, kind->type);
        bvxi_output_text(out, "\"");
        if (i == BVXI_GLB_POSITION) glb_put_bounds(glb, out);
        bvxi_output_text(out, "}");
    }
}

void bvxi_glb_put_json(const bvxi_glb_file *file, bvxi_output *out)
{
    uint64_t number = 0;

    bvxi_output_text(out, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"bitvox\"},");
    if (file->levels > 1) glb_put_level_nodes(file, out);
    else glb_put_nodes(&file->level[0], out);
    glb_put_meshes(file, out);

    /* All levels share one buffer, which ends where the last one does. */
    bvxi_output_text(out, "\"buffers\":[{");
    json_whole(out, "byteLength", file->level[file->levels - 1].end);
    bvxi_output_text(out, "}],\"bufferViews\":[");
    for (uint64_t i = 0; i < file->levels; i++) glb_put_views(&file->level[i], out);

    bvxi_output_text(out, "],\"accessors\":[");
    for (uint64_t i = 0; i < file->levels; i++) glb_put_accessors(&file->level[i], &number, out);
    bvxi_output_text(out, "]}");
}

void bvxi_level_name(const char *before, uint64_t level, char *text)
{
    bvxi_output out = {0};
    out.bytes = (uint8_t *)text;
    bvxi_output_text(&out, before);
    bvxi_output_text(&out, ": level ");
    bvxi_output_number(&out, level);
    bvxi_output_add(&out, "", 1);
}
