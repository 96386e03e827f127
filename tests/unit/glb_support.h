/* glb_support.h - a small reader of binary glTF for the tests of its writer: chunks, description, arrays. */
#ifndef TEST_GLB_SUPPORT_H
#define TEST_GLB_SUPPORT_H

#include "write_support.h"

/* ---- a reader of JSON without spaces, just enough ---- */

static inline const char *json_end(const char *p)
{
    int depth = 0;

    for (;; p++) {
        TEST_ASSERT_TRUE(*p != 0);
        if (*p == '"') {
            p = strchr(p + 1, '"');
            TEST_ASSERT_NOT_NULL(p);
        } else if (*p == '{' || *p == '[') depth++;
        else if (*p == '}' || *p == ']') {
            if (depth == 0) return p;
            if (--depth == 0) return p + 1;
        } else if (*p == ',' && depth == 0) return p;
    }
}

/* The value of a member; NULL when the object has none of that name. */
static inline const char *json_member(const char *p, const char *name)
{
    size_t const n = strlen(name);

    TEST_ASSERT_EQUAL_INT('{', *p);
    for (p++; *p == '"'; p = *p == ',' ? p + 1 : p) {
        if (strncmp(p + 1, name, n) == 0 && p[1 + n] == '"') return p + n + 3;
        p = strchr(p + 1, '"');
        TEST_ASSERT_EQUAL_INT(':', p[1]);
        p = json_end(p + 2);
    }
    return NULL;
}

/* Element i of an array; NULL after the last. */
static inline const char *json_item(const char *p, int i)
{
    TEST_ASSERT_EQUAL_INT('[', *p);
    for (p++; i > 0; i--) {
        p = json_end(p);
        if (*p++ != ',') return NULL;
    }
    return p;
}

static inline double json_number_in(const char *array, int i)
{
    return strtod(json_item(array, i), NULL);
}

/* ---- a file taken apart ---- */

typedef struct glb_file {
    bvx_buffer bytes;
    char *json; /* of the first chunk, with a zero at its end */
    const uint8_t *binary;
    uint32_t binary_size;
} glb_file;

typedef struct glb_array {
    const uint8_t *at;
    uint32_t count, component, components;
    uint32_t stride; /* bytes from element to element */
    int normalized;
    const char *min, *max;
} glb_array;

static inline uint32_t take_u32(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

static inline float take_f32(const uint8_t *p)
{
    uint32_t const bits = take_u32(p);
    float v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

static inline glb_file take_file(bvx_buffer bytes)
{
    glb_file f;
    const uint8_t *const p = bytes.bytes;
    uint32_t json;

    f.bytes = bytes;
    TEST_ASSERT_TRUE(bytes.size >= 28 && bytes.size % 4 == 0);
    TEST_ASSERT_EQUAL_MEMORY("glTF", p, 4);
    TEST_ASSERT_EQUAL_UINT32(2, take_u32(p + 4));
    TEST_ASSERT_EQUAL_UINT64(bytes.size, take_u32(p + 8));
    json = take_u32(p + 12);
    TEST_ASSERT_EQUAL_MEMORY("JSON", p + 16, 4);
    TEST_ASSERT_EQUAL_UINT32(0, json % 4);
    f.json = calloc(json + 1, 1);
    memcpy(f.json, p + 20, json);
    for (uint32_t end = json; f.json[end - 1] != '}'; end--) { /* padded with up to three spaces */
        TEST_ASSERT_EQUAL_INT(' ', f.json[end - 1]);
        TEST_ASSERT_TRUE(json - end < 3);
    }
    f.binary_size = take_u32(p + 20 + json);
    TEST_ASSERT_EQUAL_MEMORY("BIN", p + 24 + json, 4);
    TEST_ASSERT_EQUAL_UINT64(bytes.size, (uint64_t)28 + json + f.binary_size);
    TEST_ASSERT_EQUAL_UINT32(0, f.binary_size % 4);
    f.binary = p + 28 + json;
    return f;
}

static inline void free_file(glb_file *f)
{
    free(f->json);
    bvx_buffer_free(ctx, &f->bytes);
}

static inline glb_file write_glb(const bvx_mesh *m)
{
    return take_file(write_file(m, BVX_FORMAT_GLB));
}

static inline glb_file write_glb_with(const bvx_mesh *m, const bvx_write_options *o)
{
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_mesh(ctx, m, 1, o, BVX_FORMAT_GLB, &b),
                                    bvx_last_message(ctx));
    return take_file(b);
}

/* Where node i stands; 0, 0, 0 without a translation. */
static inline void node_translation(const glb_file *f, int i, double centre[3])
{
    const char *const node = json_item(json_member(f->json, "nodes"), i);
    const char *const at = json_member(node, "translation");

    TEST_ASSERT_EQUAL_INT(i, atoi(json_member(node, "mesh")));
    TEST_ASSERT_NULL(json_member(node, "matrix"));
    TEST_ASSERT_NULL(json_member(node, "rotation"));
    for (int a = 0; a < 3; a++) centre[a] = at != NULL ? json_number_in(at, a) : 0.0;
}

static inline const char *primitive_of(const glb_file *f, int mesh, int primitive)
{
    return json_item(json_member(json_item(json_member(f->json, "meshes"), mesh), "primitives"), primitive);
}

static inline uint32_t json_count(const char *object, const char *name)
{
    const char *const number = json_member(object, name);
    return number != NULL ? (uint32_t)strtoul(number, NULL, 10) : 0;
}

/* Accessor of an attribute of a mesh, or of a primitive's indices (name NULL),
 * checked against its buffer view and the chunk. count 0: none. */
static inline glb_array take_array_in(const glb_file *f, int mesh, int number_of_primitive, const char *name)
{
    const char *const primitive = primitive_of(f, mesh, number_of_primitive);
    const char *const number = name == NULL ? json_member(primitive, "indices")
                                            : json_member(json_member(primitive, "attributes"), name);
    const char *accessor, *view, *type;
    glb_array a = {0};
    uint32_t offset, length, component_size, begin;

    if (number == NULL) return a;
    accessor = json_item(json_member(f->json, "accessors"), atoi(number));
    view = json_item(json_member(f->json, "bufferViews"), atoi(json_member(accessor, "bufferView")));
    a.count = (uint32_t)strtoul(json_member(accessor, "count"), NULL, 10);
    a.component = (uint32_t)atoi(json_member(accessor, "componentType"));
    a.min = json_member(accessor, "min");
    a.max = json_member(accessor, "max");
    type = json_member(accessor, "type");
    a.components = strncmp(type, "\"SCALAR\"", 8) == 0 ? 1 : (uint32_t)atoi(type + 4);
    a.normalized = json_member(accessor, "normalized") != NULL;
    component_size = a.component == 5120 ? 1 : a.component == 5123 ? 2 : 4;
    a.stride = json_count(view, "byteStride");
    if (a.stride == 0) a.stride = a.components * component_size;
    else TEST_ASSERT_TRUE(a.stride % 4 == 0 && a.stride >= a.components * component_size);
    begin = json_count(accessor, "byteOffset");
    offset = (uint32_t)strtoul(json_member(view, "byteOffset"), NULL, 10);
    length = (uint32_t)strtoul(json_member(view, "byteLength"), NULL, 10);
    TEST_ASSERT_EQUAL_INT(0, atoi(json_member(view, "buffer")));
    TEST_ASSERT_EQUAL_INT(name == NULL ? 34963 : 34962, atoi(json_member(view, "target")));
    TEST_ASSERT_EQUAL_UINT32(0, offset % 4);
    TEST_ASSERT_EQUAL_UINT32(0, begin % component_size);
    TEST_ASSERT_TRUE(begin + a.count * a.stride <= length);
    if (name != NULL) TEST_ASSERT_TRUE(begin == 0 && a.count * a.stride == length);
    TEST_ASSERT_TRUE(offset + length <= f->binary_size);
    a.at = f->binary + offset + begin;
    return a;
}

static inline glb_array take_array_of(const glb_file *f, int mesh, const char *name)
{
    return take_array_in(f, mesh, 0, name);
}

static inline glb_array take_array(const glb_file *f, const char *name)
{
    return take_array_of(f, 0, name);
}

static inline uint32_t index_at(const glb_array *a, uint32_t i)
{
    if (a->component == 5125) return take_u32(a->at + 4 * (size_t)i);
    TEST_ASSERT_EQUAL_UINT32(5123, a->component);
    return (uint32_t)a->at[2 * (size_t)i] | (uint32_t)a->at[2 * (size_t)i + 1] << 8;
}

static inline void world_of(const bvx_mesh *m, size_t v, double p[3])
{
    for (size_t a = 0; a < 3; a++)
        p[a] = (m->position_type == BVX_F32 ? (double)((float *)m->positions)[3 * v + a]
                                            : ((double *)m->positions)[3 * v + a]) +
               m->frame[a];
}

/* An octahedron, off the origin. */
static inline bvx_mesh octahedron(int32_t type)
{
    static const double at[6][3] = {{4, 0, 0}, {-2, 0, 0}, {1, 2.5, 0}, {1, -2.5, 0}, {1, 0, 7}, {1, 0, -1}};
    static const uint32_t faces[24] = {0, 2, 4, 2, 1, 4, 1, 3, 4, 3, 0, 4,
                                       2, 0, 5, 1, 2, 5, 3, 1, 5, 0, 3, 5};
    static double p64[18];
    static float p32[18];
    static uint32_t t[24];
    bvx_mesh m = {0};

    for (int i = 0; i < 18; i++) p32[i] = (float)(p64[i] = at[i / 3][i % 3] * 1.1 + 0.3);
    memcpy(t, faces, sizeof t);
    m.positions = type == BVX_F32 ? (void *)p32 : (void *)p64;
    m.triangles = t;
    m.vertex_count = 6;
    m.triangle_count = 8;
    m.position_type = type;
    return m;
}

#endif
