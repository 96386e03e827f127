/* glb_json.c - the description of a GLB file: where its arrays lie, what they are, and how the mesh stands in the world.
 *
 * Source: Khronos. glTF 2.0 Specification (ISO/IEC 12113:2022).
 * The upper node turns z up into glTF's y up, (x, y, z) to (x, z, -y), as a matrix of zeros and ones: a quaternion would have
 * rounded roots in it. The lower one carries the centre, in the world's own axes. Bounds are given as the doubles that the
 * floats are, so that they hold whether a reader rounds them or not. */
#include "io/glb.h"

typedef struct glb_kind {
    const char *attribute; /* NULL: indices */
    const char *type;
    int32_t component, normalized;
} glb_kind;

enum { GLB_FLOAT = 5126, GLB_U16 = 5123, GLB_U32 = 5125, GLB_VERTEX_TARGET = 34962, GLB_INDEX_TARGET = 34963 };

static const glb_kind glb_kinds[BVXI_GLB_ARRAYS] = {
    {"POSITION", "VEC3", GLB_FLOAT, 0}, {"NORMAL", "VEC3", GLB_FLOAT, 0}, {"COLOR_0", "VEC4", GLB_U16, 1},
    {"TEXCOORD_0", "VEC2", GLB_FLOAT, 0}, {NULL, "SCALAR", 0, 0},
};

void bvxi_glb_layout(bvxi_glb *glb)
{
    static const uint64_t size[BVXI_GLB_ARRAYS] = {12, 12, 8, 8, 0};
    uint64_t at = 0;
    memcpy(glb->size, size, sizeof glb->size);
    glb->size[BVXI_GLB_INDEX] = glb->vertices <= UINT16_MAX ? 2 : 4; /* 65535 itself is no index in glTF */
    glb->count[BVXI_GLB_POSITION] = glb->count[BVXI_GLB_NORMAL] = glb->vertices;
    glb->count[BVXI_GLB_COLOUR] = glb->mesh->colours != NULL ? glb->vertices : 0;
    glb->count[BVXI_GLB_UV] = glb->mesh->uvs != NULL ? glb->vertices : 0;
    glb->count[BVXI_GLB_INDEX] = glb->mesh->triangle_count * 3; /* last: all before it are multiples of 4 bytes */
    for (int i = 0; i < BVXI_GLB_ARRAYS; i++) {
        glb->at[i] = at;
        at += glb->count[i] * glb->size[i];
    }
    glb->binary = at;
}

bvx_status bvxi_glb_check_size(bvx_context *ctx, uint64_t size)
{
    if (size <= UINT32_MAX) return BVX_OK;
    return bvxi_fail(ctx, BVX_ERR_RANGE, "GLB: the file would take %u bytes or more, the format's limit is 2^32 - 1; take PLY",
                     size);
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

static void json_three(bvxi_output *out, const char *name, const double value[3])
{
    char text[32];
    json_name(out, name);
    for (int a = 0; a < 3; a++) {
        bvxi_output_text(out, a == 0 ? "[" : ",");
        bvxi_output_add(out, text, (size_t)bvxi_print_double(value[a], text));
    }
    bvxi_output_text(out, "]");
}

/* ---- parts of the description ---- */

static void glb_put_nodes(const bvxi_glb *glb, bvxi_output *out)
{
    bvxi_output_text(out, "\"scene\":0,\"scenes\":[{\"nodes\":[0]}],\"nodes\":["
                          "{\"children\":[1],\"matrix\":[1,0,0,0,0,0,-1,0,0,1,0,0,0,0,0,1]},{\"mesh\":0,");
    json_three(out, "translation", glb->centre);
    bvxi_output_text(out, "}],");
}

/* Arrays that the mesh lacks have no number. */
static void glb_put_mesh(const bvxi_glb *glb, bvxi_output *out)
{
    uint64_t number = 0;
    bvxi_output_text(out, "\"meshes\":[{\"primitives\":[{\"attributes\":{");
    for (int i = 0; i < BVXI_GLB_ARRAYS; i++) {
        if (glb->count[i] == 0) continue;
        if (i == BVXI_GLB_INDEX) bvxi_output_text(out, "},");
        else if (number > 0) bvxi_output_text(out, ",");
        json_whole(out, i == BVXI_GLB_INDEX ? "indices" : glb_kinds[i].attribute, number++);
    }
    bvxi_output_text(out, ",\"material\":0,\"mode\":4}]}],\"materials\":[{\"pbrMetallicRoughness\":"
                          "{\"metallicFactor\":0,\"roughnessFactor\":1},\"doubleSided\":true}],");
}

static void glb_put_views(const bvxi_glb *glb, bvxi_output *out)
{
    bvxi_output_text(out, "\"buffers\":[{");
    json_whole(out, "byteLength", glb->binary);
    bvxi_output_text(out, "}],\"bufferViews\":[");
    for (int i = 0; i < BVXI_GLB_ARRAYS; i++) {
        if (glb->count[i] == 0) continue;
        bvxi_output_text(out, i > 0 ? ",{\"buffer\":0," : "{\"buffer\":0,");
        json_whole(out, "byteOffset", glb->at[i]);
        bvxi_output_text(out, ",");
        json_whole(out, "byteLength", glb->count[i] * glb->size[i]);
        bvxi_output_text(out, ",");
        json_whole(out, "target", i == BVXI_GLB_INDEX ? GLB_INDEX_TARGET : GLB_VERTEX_TARGET);
        bvxi_output_text(out, "}");
    }
    bvxi_output_text(out, "],");
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

static void glb_put_accessors(const bvxi_glb *glb, bvxi_output *out)
{
    uint64_t number = 0;
    bvxi_output_text(out, "\"accessors\":[");
    for (int i = 0; i < BVXI_GLB_ARRAYS; i++) {
        const glb_kind *const kind = &glb_kinds[i];
        int32_t const index = glb->size[BVXI_GLB_INDEX] == 2 ? GLB_U16 : GLB_U32;
        if (glb->count[i] == 0) continue;
        bvxi_output_text(out, number > 0 ? ",{" : "{");
        json_whole(out, "bufferView", number++);
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
    bvxi_output_text(out, "]");
}

void bvxi_glb_put_json(const bvxi_glb *glb, bvxi_output *out)
{
    bvxi_output_text(out, "{\"asset\":{\"version\":\"2.0\",\"generator\":\"bitvox\"},");
    glb_put_nodes(glb, out);
    glb_put_mesh(glb, out);
    glb_put_views(glb, out);
    glb_put_accessors(glb, out);
    bvxi_output_text(out, "}");
}
