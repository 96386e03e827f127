/* test_read_gltf.c - glTF 2.0 read: made files of every kind of array, scene and damage, and well-known files where
 * they are there. */
#include "read_support.h"

#include <math.h>

/* ---- made files: JSON with ' for ", and the bytes of the first buffer ---- */

enum { FILE_ROOM = 1 << 21 };

static uint8_t bin[8192];
static size_t bin_size;
static uint8_t file[FILE_ROOM];
static char json[FILE_ROOM];

static size_t add_bytes(const void *bytes, size_t n)
{
    size_t const at = bin_size;
    memcpy(bin + at, bytes, n);
    bin_size = (at + n + 3) / 4 * 4;
    return at;
}

static size_t add_floats(const float *v, size_t n)
{
    size_t const at = bin_size;
    for (size_t i = 0; i < n; i++) put_f32(bin + at + 4 * i, v[i], 0);
    bin_size += 4 * n;
    return at;
}

static size_t add_shorts(const int *v, size_t n)
{
    uint8_t b[256];
    for (size_t i = 0; i < n; i++) {
        b[2 * i] = (uint8_t)(v[i] & 255);
        b[2 * i + 1] = (uint8_t)(v[i] >> 8 & 255);
    }
    return add_bytes(b, 2 * n);
}

static size_t set_json(const char *text)
{
    size_t n = 0;
    for (; text[n] != 0; n++) json[n] = text[n] == '\'' ? '"' : text[n];
    json[n] = 0;
    return n;
}

/* A GLB of json and bin; returns its size. */
static size_t make_glb(const char *text)
{
    size_t n = set_json(text), size;

    while (n % 4 != 0) json[n++] = ' ';
    size = 12 + 8 + n + (bin_size > 0 ? 8 + bin_size : 0);
    put_u32(file, 0x46546c67, 0);
    put_u32(file + 4, 2, 0);
    put_u32(file + 8, (uint32_t)size, 0);
    put_u32(file + 12, (uint32_t)n, 0);
    put_u32(file + 16, 0x4e4f534a, 0);
    memcpy(file + 20, json, n);
    if (bin_size > 0) {
        put_u32(file + 20 + n, (uint32_t)bin_size, 0);
        put_u32(file + 24 + n, 0x004e4942, 0);
        memcpy(file + 28 + n, bin, bin_size);
    }
    return size;
}

static bvx_mesh read_glb(const char *text)
{
    bvx_mesh m;
    bvx_status const status = read_file(file, make_glb(text), BVX_FORMAT_GLB, &m);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(ctx));
    return m;
}

static void refuse_glb(const char *text, bvx_status status, const char *words)
{
    check_refused(file, make_glb(text), BVX_FORMAT_GLB, status, words);
}

/* Four corners of a square. */
static const float square[12] = {0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0};
static const int two_triangles[6] = {0, 1, 2, 0, 2, 3};

#define HEAD     "{'asset':{'version':'2.0'},"
#define ONE_NODE "'nodes':[{'mesh':0}],"
#define QUAD                                                                      \
    "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}],"      \
    "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'}," \
    "{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'}],"
#define VIEWS  "'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':12}],"
#define BUFFER "'buffers':[{'byteLength':60}]}"

static void begin_quad(void)
{
    bin_size = 0;
    add_floats(square, 12);
    add_shorts(two_triangles, 6);
}

static const float *at(const bvx_mesh *m, uint64_t v)
{
    TEST_ASSERT_EQUAL_INT32(BVX_F32, m->position_type);
    return (const float *)m->positions + 3 * v;
}

static void expect_at(const bvx_mesh *m, uint64_t v, double x, double y, double z)
{
    char text[120];
    const float *const p = at(m, v);
    snprintf(text, sizeof text, "vertex %d is %.9g %.9g %.9g", (int)v, (double)p[0], (double)p[1],
             (double)p[2]);
    TEST_ASSERT_TRUE_MESSAGE(p[0] == (float)x && p[1] == (float)y && p[2] == (float)z, text);
}

static void expect_triangle(const bvx_mesh *m, uint64_t t, uint32_t a, uint32_t b, uint32_t c)
{
    uint32_t const want[3] = {a, b, c};
    TEST_ASSERT_EQUAL_UINT32_ARRAY(want, m->triangles + 3 * t, 3);
}

/* ---- plain ---- */

static void test_a_square(void)
{
    bvx_mesh m;

    begin_quad();
    m = read_glb(HEAD ONE_NODE QUAD VIEWS BUFFER);
    TEST_ASSERT_EQUAL_UINT64(4, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(2, m.triangle_count);
    expect_at(&m, 1, 2, 0, 0);
    expect_at(&m, 2, 2, 1, 0);
    expect_triangle(&m, 0, 0, 1, 2);
    expect_triangle(&m, 1, 0, 2, 3);
    TEST_ASSERT_TRUE(m.normals == NULL && m.uvs == NULL && m.uvs2 == NULL && m.colours == NULL);
    TEST_ASSERT_TRUE(m.materials == NULL && m.assets == NULL);
    bvx_mesh_free(ctx, &m);
}

static void test_the_default_scene_is_drawn(void)
{
    bvx_mesh m;

    begin_quad();
    m = read_glb(HEAD "'scene':1,'scenes':[{'nodes':[0]},{'nodes':[1]}],"
                      "'nodes':[{'mesh':0},{'mesh':0,'translation':[1,0,0]},{'mesh':0}]," QUAD VIEWS BUFFER);
    TEST_ASSERT_EQUAL_UINT64(4, m.vertex_count);
    expect_at(&m, 1, 3, 0, 0);
    bvx_mesh_free(ctx, &m);
    m = read_glb(HEAD
                 "'scenes':[{'nodes':[0,2]}],'nodes':[{'mesh':0},{'mesh':0},{'mesh':0}]," QUAD VIEWS BUFFER);
    TEST_ASSERT_EQUAL_UINT64(8, m.vertex_count);
    bvx_mesh_free(ctx, &m);
    refuse_glb(HEAD "'scenes':[{}]," ONE_NODE QUAD VIEWS BUFFER, BVX_ERR_EMPTY, "no triangles");
    refuse_glb(HEAD "'scene':3,'scenes':[{}]," ONE_NODE QUAD VIEWS BUFFER, BVX_ERR_RANGE,
               "names scene 3; there are 1");
}

static void test_indices_of_every_type(void)
{
    static const uint8_t bytes[8] = {0, 1, 2, 0, 2, 3, 0, 0};
    static const char *const forms[] = {"5121", "5123", "5125"};

    for (int k = 0; k < 3; k++) {
        char text[2000];
        bvx_mesh m;
        uint8_t words[24];
        bin_size = 0;
        add_floats(square, 12);
        for (int i = 0; i < 6; i++) put_u32(words + 4 * i, (uint32_t)two_triangles[i], 0);
        if (k == 0) add_bytes(bytes, 6);
        if (k == 1) add_shorts(two_triangles, 6);
        if (k == 2) add_bytes(words, 24);
        snprintf(text, sizeof text,
                 HEAD ONE_NODE "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}],"
                               "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"
                               "{'bufferView':1,'componentType':%s,'count':6,'type':'SCALAR'}],"
                               "'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,"
                               "'byteLength':%d}],'buffers':[{'byteLength':%d}]}",
                 forms[k], 6 << k, 48 + (6 << k));
        m = read_glb(text);
        expect_triangle(&m, 1, 0, 2, 3);
        bvx_mesh_free(ctx, &m);
    }
}

static void expect_mode(int mode, int indexed, const uint32_t *want, uint64_t count)
{
    static const float five[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0};
    static const int order[5] = {0, 1, 2, 3, 4};
    char text[2000];
    bvx_mesh m;

    bin_size = 0;
    add_floats(five, 15);
    add_shorts(order, 5);
    snprintf(text, sizeof text,
             HEAD ONE_NODE "'meshes':[{'primitives':[{'mode':%d,'attributes':{'POSITION':0}%s}]}],"
                           "'accessors':[{'bufferView':0,'componentType':5126,'count':5,'type':'VEC3'},"
                           "{'bufferView':1,'componentType':5123,'count':5,'type':'SCALAR'}],"
                           "'bufferViews':[{'buffer':0,'byteLength':60},{'buffer':0,'byteOffset':60,"
                           "'byteLength':10}],'buffers':[{'byteLength':70}]}",
             mode, indexed ? ",'indices':1" : "");
    m = read_glb(text);
    TEST_ASSERT_EQUAL_UINT64(count, m.triangle_count);
    TEST_ASSERT_EQUAL_UINT32_ARRAY(want, m.triangles, 3 * count);
    bvx_mesh_free(ctx, &m);
}

static void test_strips_and_fans(void)
{
    static const uint32_t strip[9] = {0, 1, 2, 1, 3, 2, 2, 3, 4}, fan[9] = {1, 2, 0, 2, 3, 0, 3, 4, 0};

    for (int indexed = 0; indexed < 2; indexed++) {
        expect_mode(5, indexed, strip, 3);
        expect_mode(6, indexed, fan, 3);
    }
}

/* Three vertices without indices, the stride and offsets of interleaved arrays. */
static void test_strides_and_offsets(void)
{
    static const float rows[3 * 8] = {0, 0, 0, 0, 0, 1, 0.25f, 0.5f, 1, 0, 0, 0,
                                      0, 1, 1, 0, 0, 1, 0,     0,    0, 1, 0, 1};
    bvx_mesh m;

    bin_size = 0;
    add_bytes("????", 4);
    add_floats(rows, 24);
    m = read_glb(HEAD ONE_NODE
                 "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'NORMAL':1,'TEXCOORD_0':2}}]}],"
                 "'accessors':[{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
                 "{'bufferView':0,'byteOffset':12,'componentType':5126,'count':3,'type':'VEC3'},"
                 "{'bufferView':0,'byteOffset':24,'componentType':5126,'count':3,'type':'VEC2'}],"
                 "'bufferViews':[{'buffer':0,'byteOffset':4,'byteStride':32,'byteLength':96}],"
                 "'buffers':[{'byteLength':100}]}");
    expect_at(&m, 2, 0, 1, 0);
    TEST_ASSERT_TRUE(m.uvs[0] == 0.25f && m.uvs[1] == 0.5f && m.uvs[4] == 0.0f && m.uvs[5] == 0.0f);
    TEST_ASSERT_TRUE(m.normals[0] == 0.0f && m.normals[1] == 0.0f && m.normals[2] == 1.0f);
    expect_triangle(&m, 0, 0, 1, 2);
    bvx_mesh_free(ctx, &m);
}

/* ---- sparse and quantized ---- */

static void test_sparse_elements_replace_others(void)
{
    static const float lifted[6] = {5, 6, 7, -1, -2, -3};
    static const uint8_t which[2] = {1, 3};
    bvx_mesh m;

    begin_quad();
    add_bytes(which, 2);
    add_floats(lifted, 6);
    m = read_glb(
        HEAD ONE_NODE
        "'meshes':[{'primitives':[{'attributes':{'POSITION':0},'indices':1}]}],"
        "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3','sparse':{'count':2,"
        "'indices':{'bufferView':2,'componentType':5121},'values':{'bufferView':3}}},"
        "{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'}],"
        "'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':12},"
        "{'buffer':0,'byteOffset':60,'byteLength':2},{'buffer':0,'byteOffset':64,'byteLength':24}],"
        "'buffers':[{'byteLength':88}]}");
    expect_at(&m, 0, 0, 0, 0);
    expect_at(&m, 1, 5, 6, 7);
    expect_at(&m, 2, 2, 1, 0);
    expect_at(&m, 3, -1, -2, -3);
    bvx_mesh_free(ctx, &m);
}

#define SPARSE_ALONE(count, index)                                                                          \
    HEAD ONE_NODE "'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}],"                              \
                  "'accessors':[{'componentType':5126,'count':" count ",'type':'VEC3','sparse':{'count':1," \
                  "'indices':{'bufferView':0,'componentType':5123},'values':{'bufferView':1}}}],"           \
                  "'bufferViews':[{'buffer':0,'byteLength':" index                                          \
                  "},{'buffer':0,'byteOffset':4,'byteLength':12}],"                                         \
                  "'buffers':[{'byteLength':16}]}"

static void test_an_accessor_without_bytes_is_zero(void)
{
    static const int two[1] = {2}, three[1] = {3};
    static const float lifted[3] = {1, 2, 3};
    bvx_mesh m;

    bin_size = 0;
    add_shorts(two, 1);
    add_floats(lifted, 3);
    m = read_glb(SPARSE_ALONE("3", "2"));
    expect_at(&m, 1, 0, 0, 0);
    expect_at(&m, 2, 1, 2, 3);
    bvx_mesh_free(ctx, &m);
    refuse_glb(SPARSE_ALONE("3", "1"), BVX_ERR_FORMAT, "beyond bufferView 0");
    refuse_glb(SPARSE_ALONE("300000000", "2"), BVX_ERR_RANGE, "more often than is read");
    refuse_glb(SPARSE_ALONE("9000000000000000", "2"), BVX_ERR_RANGE, "limits are");
    refuse_glb(SPARSE_ALONE("90000000000000000", "2"), BVX_ERR_FORMAT, "count is not a whole number");
    bin_size = 0;
    add_shorts(three, 1);
    add_floats(lifted, 3);
    refuse_glb(SPARSE_ALONE("3", "2"), BVX_ERR_RANGE, "a sparse index is 3; there are 3");
}

/* One triangle whose positions are integers of a type: the third corner's first two coordinates are asked. */
static void expect_integers(int type, int normalized, const void *bytes, size_t n, double x, double y)
{
    char text[2000];
    bvx_mesh m;

    bin_size = 0;
    add_bytes(bytes, n);
    snprintf(text, sizeof text,
             HEAD ONE_NODE
             "'extensionsRequired':['KHR_mesh_quantization'],"
             "'meshes':[{'primitives':[{'attributes':{'POSITION':0}}]}],"
             "'accessors':[{'bufferView':0,'componentType':%d,'normalized':%s,'count':3,'type':'VEC3'}],"
             "'bufferViews':[{'buffer':0,'byteStride':%d,'byteLength':%d}],'buffers':[{'byteLength':%d}]}",
             type, normalized ? "true" : "false", (int)n / 3, (int)n, (int)n);
    m = read_glb(text);
    expect_at(&m, 2, x, y, 0);
    bvx_mesh_free(ctx, &m);
}

static void test_quantized_positions(void)
{
    static const uint8_t b[12] = {0, 0, 0, 9, 1, 0, 0, 9, 0x81, 0x80, 0, 9};
    uint8_t s[24] = {0};

    s[8] = 1;
    s[16] = 0x01; /* 0x8001, 0x8000 */
    s[17] = s[19] = 0x80;
    expect_integers(5120, 0, b, 12, -127, -128);
    expect_integers(5120, 1, b, 12, -1, -1);
    expect_integers(5121, 0, b, 12, 129, 128);
    expect_integers(5121, 1, b, 12, 129.0 / 255.0, 128.0 / 255.0);
    expect_integers(5122, 0, s, 24, -32767, -32768);
    expect_integers(5122, 1, s, 24, -1, -1);
    expect_integers(5123, 0, s, 24, 32769, 32768);
    expect_integers(5123, 1, s, 24, 32769.0 / 65535.0, 32768.0 / 65535.0);
}

static void test_quantized_normals_and_uvs(void)
{
    static const uint8_t normals[12] = {0, 0, 127, 0, 0, 0, 127, 0, 0, 0, 127, 0};
    static const uint8_t bytes[12] = {0, 255, 0, 0, 51, 0, 0, 0, 255, 255, 0, 0};
    static const int shorts[6] = {0, 65535, 13107, 0, -2, 3};
    static const float three[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    bvx_mesh m;

    bin_size = 0;
    add_floats(three, 9);
    add_bytes(normals, 12);
    add_bytes(bytes, 12);
    add_shorts(shorts, 6);
    m = read_glb(
        HEAD ONE_NODE
        "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'NORMAL':1,'TEXCOORD_0':2,'TEXCOORD_1':3}}]}],"
        "'accessors':[{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
        "{'bufferView':1,'componentType':5120,'normalized':true,'count':3,'type':'VEC3'},"
        "{'bufferView':2,'componentType':5121,'normalized':true,'count':3,'type':'VEC2'},"
        "{'bufferView':3,'componentType':5122,'count':3,'type':'VEC2'}],"
        "'bufferViews':[{'buffer':0,'byteLength':36},{'buffer':0,'byteOffset':36,'byteStride':4,'byteLength':12},"
        "{'buffer':0,'byteOffset':48,'byteStride':4,'byteLength':12},{'buffer':0,'byteOffset':60,'byteLength':12}],"
        "'buffers':[{'byteLength':72}]}");
    TEST_ASSERT_TRUE(m.normals[2] == 1.0f && m.normals[0] == 0.0f && m.normals[1] == 0.0f);
    TEST_ASSERT_TRUE(m.uvs[0] == 0.0f && m.uvs[1] == 0.0f && m.uvs[2] == 0.2f && m.uvs[5] == 0.0f);
    TEST_ASSERT_TRUE(m.uvs2[1] == 2.0f && m.uvs2[2] == 13107.0f && m.uvs2[4] == -2.0f && m.uvs2[5] == -2.0f);
    bvx_mesh_free(ctx, &m);
}

/* ---- attributes ---- */

/* Linear light of the file, bytes of sRGB in the mesh. */
static void test_colours(void)
{
    static const float rgb[9] = {0, 1, 0.21586f, 2, -1, 0, 0.5f, 0.5f, 0.5f};
    static const int rgba[12] = {65535, 0, 13909, 65535, 20, 0, 0, 0, 0, 0, 0, 32768};
    static const float three[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    static const uint8_t want_rgb[12] = {0, 255, 128, 255, 255, 0, 0, 255, 188, 188, 188, 255};
    static const uint8_t want_rgba[12] = {255, 0, 127, 255, 1, 0, 0, 0, 0, 0, 0, 128};
    bvx_mesh m;

    for (int four = 0; four < 2; four++) {
        char text[2000];
        bin_size = 0;
        add_floats(three, 9);
        if (four) add_shorts(rgba, 12);
        else add_floats(rgb, 9);
        snprintf(text, sizeof text,
                 HEAD ONE_NODE
                 "'meshes':[{'primitives':[{'attributes':{'POSITION':0,'COLOR_0':1}}]}],"
                 "'accessors':[{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
                 "{'bufferView':1,'componentType':%s,'normalized':true,'count':3,'type':'VEC%s'}],"
                 "'bufferViews':[{'buffer':0,'byteLength':36},{'buffer':0,'byteOffset':36,'byteLength':%d}],"
                 "'buffers':[{'byteLength':%d}]}",
                 four ? "5123" : "5126", four ? "4" : "3", four ? 24 : 36, four ? 60 : 72);
        m = read_glb(text);
        TEST_ASSERT_EQUAL_UINT8_ARRAY(four ? want_rgba : want_rgb, m.colours, 12);
        bvx_mesh_free(ctx, &m);
    }
}

#define TWO_PRIMITIVES(second)                                                                      \
    HEAD ONE_NODE                                                                                   \
        "'materials':[{},{'name':'b'}],'meshes':[{'primitives':[{'attributes':{'POSITION':0,"       \
        "'NORMAL':2,'TEXCOORD_0':3,'COLOR_0':4},'indices':1,'material':1}," second "]}],"           \
        "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"               \
        "{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'},"                          \
        "{'bufferView':2,'componentType':5126,'count':4,'type':'VEC3'},"                            \
        "{'bufferView':2,'componentType':5126,'count':4,'type':'VEC2'},"                            \
        "{'bufferView':2,'componentType':5126,'count':4,'type':'VEC3'}],"                           \
        "'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':48,'byteLength':12}," \
        "{'buffer':0,'byteOffset':60,'byteLength':48}],'buffers':[{'byteLength':108}]}"

static void begin_two(void)
{
    static const float up[12] = {1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0};

    begin_quad();
    add_floats(up, 12);
}

/* What only one primitive has is made up for the other: computed normals, uv 0, white. */
static void test_attributes_of_one_primitive_only(void)
{
    bvx_mesh m;

    begin_two();
    m = read_glb(TWO_PRIMITIVES("{'attributes':{'POSITION':0},'indices':1}"));
    TEST_ASSERT_EQUAL_UINT64(8, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(4, m.triangle_count);
    TEST_ASSERT_TRUE(m.normals[0] == 1.0f && m.normals[3 * 7] == 0.0f && m.normals[3 * 7 + 2] == 1.0f);
    TEST_ASSERT_TRUE(m.uvs[0] == 1.0f && m.uvs[2 * 7] == 0.0f && m.uvs[2 * 7 + 1] == 0.0f);
    TEST_ASSERT_TRUE(m.colours[1] == 0 && m.colours[4 * 7] == 255 && m.colours[4 * 7 + 1] == 255);
    TEST_ASSERT_TRUE(m.materials[0] == 1 && m.materials[1] == 1 && m.materials[2] == 2 &&
                     m.materials[3] == 2);
    TEST_ASSERT_EQUAL_UINT64(2, m.assets->material_count);
    TEST_ASSERT_EQUAL_STRING("[{},{\"name\":\"b\"}]", m.assets->materials);
    expect_triangle(&m, 3, 4, 6, 7);
    bvx_mesh_free(ctx, &m);
}

static void test_primitives_of_the_same_accessors_share_vertices(void)
{
    bvx_mesh m;

    begin_two();
    m = read_glb(
        TWO_PRIMITIVES("{'attributes':{'POSITION':0,'NORMAL':2,'TEXCOORD_0':3,'COLOR_0':4},'material':0,"
                       "'mode':5},{'attributes':{'POSITION':0,'NORMAL':2,'TEXCOORD_0':3,'COLOR_0':4},"
                       "'indices':1}"));
    TEST_ASSERT_EQUAL_UINT64(4, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(6, m.triangle_count);
    expect_triangle(&m, 2, 0, 1, 2);
    expect_triangle(&m, 3, 1, 3, 2);
    expect_triangle(&m, 5, 0, 2, 3);
    TEST_ASSERT_TRUE(m.materials[2] == 0 && m.materials[5] == 2);
    bvx_mesh_free(ctx, &m);
}

/* ---- the scene ---- */

static void test_transforms_of_parents_first(void)
{
    bvx_mesh m;

    begin_quad();
    /* x to y to -x by a quarter turn about z, then twice as large, then moved. */
    m = read_glb(HEAD "'nodes':[{'mesh':0,'rotation':[0,0,2,2]},{'children':[0],'translation':[10,20,30],"
                      "'scale':[2,2,2]}]," QUAD VIEWS BUFFER);
    expect_at(&m, 1, 10, 24, 30);
    expect_at(&m, 2, 8, 24, 30);
    expect_triangle(&m, 0, 0, 1, 2);
    bvx_mesh_free(ctx, &m);
    m = read_glb(HEAD
                 "'nodes':[{'mesh':0,'matrix':[0,0,1,0, 0,1,0,0, 1,0,0,0, 5,6,7,1]}]," QUAD VIEWS BUFFER);
    expect_at(&m, 1, 5, 6, 9); /* x and z change places: a mirror */
    expect_triangle(&m, 0, 0, 2, 1);
    bvx_mesh_free(ctx, &m);
}

static void test_a_mirror_turns_triangles_and_keeps_normals(void)
{
    static const float rows[3 * 6] = {0, 0, 0, 0, 0, 2, 1, 0, 0, 0, 0, 2, 0, 1, 0, 0, 0, 2};
    bvx_mesh m;

    bin_size = 0;
    add_floats(rows, 18);
    m = read_glb(
        HEAD "'nodes':[{'mesh':0,'scale':[-3,1,1]}],'meshes':[{'primitives':[{'attributes':{'POSITION':0,"
             "'NORMAL':1}}]}],'accessors':[{'bufferView':0,'componentType':5126,'count':3,'type':'VEC3'},"
             "{'bufferView':0,'byteOffset':12,'componentType':5126,'count':3,'type':'VEC3'}],"
             "'bufferViews':[{'buffer':0,'byteStride':24,'byteLength':72}],'buffers':[{'byteLength':72}]}");
    expect_at(&m, 1, -3, 0, 0);
    expect_triangle(&m, 0, 0, 2, 1);
    TEST_ASSERT_TRUE(m.normals[0] == 0.0f && m.normals[1] == 0.0f && m.normals[2] == 1.0f);
    bvx_mesh_free(ctx, &m);
}

/* Positions that nodes put far away are doubles, others floats. */
static void test_doubles_for_what_is_far_away(void)
{
    bvx_mesh m;

    begin_quad();
    m = read_glb(HEAD "'nodes':[{'mesh':0,'translation':[600000.1,0,0]}]," QUAD VIEWS BUFFER);
    TEST_ASSERT_EQUAL_INT32(BVX_F64, m.position_type);
    TEST_ASSERT_TRUE(((double *)m.positions)[3] == 600000.1 + 2.0);
    bvx_mesh_free(ctx, &m);
    m = read_glb(HEAD "'nodes':[{'mesh':0,'translation':[30,0,0]}]," QUAD VIEWS BUFFER);
    TEST_ASSERT_EQUAL_INT32(BVX_F32, m.position_type);
    bvx_mesh_free(ctx, &m);
}

static void test_nodes_that_are_no_tree(void)
{
    size_t n;

    begin_quad();
    refuse_glb(HEAD "'nodes':[{'mesh':0},{'children':[2]},{'children':[1]}]," QUAD VIEWS BUFFER,
               BVX_ERR_FORMAT, "node 1: it lies in a cycle");
    refuse_glb(HEAD "'nodes':[{'mesh':0,'children':[0]}]," QUAD VIEWS BUFFER, BVX_ERR_FORMAT, "cycle");
    refuse_glb(HEAD "'nodes':[{'mesh':0},{'children':[0]},{'children':[0]}]," QUAD VIEWS BUFFER,
               BVX_ERR_FORMAT, "node 0 is a child of node 1 and of node 2");
    refuse_glb(HEAD "'nodes':[{'mesh':0},{'children':[0,0]}]," QUAD VIEWS BUFFER, BVX_ERR_FORMAT,
               "a node has one parent");
    refuse_glb(HEAD "'nodes':[{'mesh':0},{'children':[7]}]," QUAD VIEWS BUFFER, BVX_ERR_FORMAT,
               "node 1: it names a node");
    refuse_glb(HEAD "'nodes':[{'mesh':0},{'children':[-1]}]," QUAD VIEWS BUFFER, BVX_ERR_FORMAT,
               "node 1: it names a node");
    refuse_glb(HEAD "'scenes':[{'nodes':[0]}],'nodes':[{'mesh':0},{'children':[0]}]," QUAD VIEWS BUFFER,
               BVX_ERR_FORMAT, "scene 0 lists node 0, which is a child of node 1");
    refuse_glb(HEAD "'nodes':[{'mesh':0,'matrix':[1,0]}]," QUAD VIEWS BUFFER, BVX_ERR_FORMAT,
               "matrix is not 16 numbers");
    refuse_glb(HEAD "'nodes':[{'mesh':0,'scale':[1,1e999,1]}]," QUAD VIEWS BUFFER, BVX_ERR_FORMAT,
               "no finite number");
    refuse_glb(HEAD "'nodes':[{'mesh':4}]," QUAD VIEWS BUFFER, BVX_ERR_RANGE,
               "mesh is 4; there are 1 meshes");

    /* A chain of nodes takes no stack, and ends somewhere. */
    n = (size_t)snprintf(json, sizeof json, HEAD "'nodes':[");
    for (int i = 1; i < 1500; i++) n += (size_t)snprintf(json + n, sizeof json - n, "{'children':[%d]},", i);
    snprintf(json + n, sizeof json - n, "{'mesh':0}]," QUAD VIEWS BUFFER);
    refuse_glb(json, BVX_ERR_UNSUPPORTED, "lies below 1000 others");
}

/* ---- arrays that do not fit ---- */

static void test_arrays_beyond_their_bytes(void)
{
    begin_quad();
    refuse_glb(HEAD ONE_NODE QUAD "'bufferViews':[{'buffer':0,'byteLength':47},{'buffer':0,'byteOffset':48,"
                                  "'byteLength':12}]," BUFFER,
               BVX_ERR_FORMAT, "accessor 0: 4 elements");
    refuse_glb(HEAD ONE_NODE QUAD "'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':52,"
                                  "'byteLength':12}]," BUFFER,
               BVX_ERR_FORMAT, "bufferView 1: bytes 52 to 64");
    refuse_glb(HEAD ONE_NODE QUAD "'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,"
                                  "'byteOffset':9007199254740991,'byteLength':12}]," BUFFER,
               BVX_ERR_FORMAT, "bufferView 1");
    refuse_glb(HEAD ONE_NODE QUAD "'bufferViews':[{'buffer':0,'byteLength':48},{'buffer':0,'byteOffset':47,"
                                  "'byteLength':12}]," BUFFER,
               BVX_ERR_FORMAT, "accessor 1: its elements do not begin");
    refuse_glb(HEAD ONE_NODE QUAD "'bufferViews':[{'buffer':0,'byteStride':8,'byteLength':48},{'buffer':0,"
                                  "'byteOffset':48,'byteLength':12}]," BUFFER,
               BVX_ERR_FORMAT, "longer than their stride");
    refuse_glb(HEAD ONE_NODE QUAD "'bufferViews':[{'buffer':0,'byteStride':13,'byteLength':48},{'buffer':0,"
                                  "'byteOffset':48,'byteLength':12}]," BUFFER,
               BVX_ERR_FORMAT, "byteStride is not");
    refuse_glb(HEAD ONE_NODE QUAD VIEWS "'buffers':[{'byteLength':61}]}", BVX_ERR_FORMAT,
               "byteLength is 61, there are 60");
    refuse_glb(HEAD ONE_NODE QUAD VIEWS "'buffers':[{}]}", BVX_ERR_FORMAT, "buffer 0 has no byteLength");
    refuse_glb(HEAD ONE_NODE QUAD "'buffers':[{'byteLength':60}]}", BVX_ERR_RANGE,
               "bufferView is 0; there are 0");
    bin[48] = 4; /* the first index */
    refuse_glb(HEAD ONE_NODE QUAD VIEWS BUFFER, BVX_ERR_RANGE, "index 0 is 4; there are 4 vertices");
    put_f32(bin, NAN, 0);
    refuse_glb(HEAD ONE_NODE QUAD VIEWS BUFFER, BVX_ERR_RANGE,
               "vertex 0 has a coordinate that is not finite");
}

/* A mesh of a primitive, with accessor 0 as the text says. */
static void refuse_accessor(const char *primitive, const char *accessor, bvx_status status, const char *words)
{
    char text[2000];

    begin_quad();
    snprintf(text, sizeof text,
             HEAD ONE_NODE "'meshes':[{'primitives':[%s]}],'accessors':[{'bufferView':0,%s},"
                           "{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'}]," VIEWS BUFFER,
             primitive, accessor);
    refuse_glb(text, status, words);
}

static void test_accessors_of_the_wrong_kind(void)
{
    static const char plain[] = "{'attributes':{'POSITION':0},'indices':1}";
    static const char good[] = "'componentType':5126,'count':4,'type':'VEC3'";

    refuse_accessor(plain, "'componentType':5126,'count':4,'type':'VEC2'", BVX_ERR_FORMAT, "is no POSITION");
    refuse_accessor(plain, "'componentType':5126,'count':4,'type':'MAT4'", BVX_ERR_FORMAT, "its type is not");
    refuse_accessor(plain, "'componentType':5124,'count':4,'type':'VEC3'", BVX_ERR_FORMAT,
                    "componentType 5124 is unknown");
    refuse_accessor(plain, "'componentType':5125,'count':4,'type':'VEC3'", BVX_ERR_FORMAT, "is no POSITION");
    refuse_accessor(plain, "'componentType':5126,'count':0,'type':'VEC3'", BVX_ERR_FORMAT, "its count is 0");
    refuse_accessor(plain, "'componentType':5126,'count':4294967297,'type':'VEC3'", BVX_ERR_FORMAT,
                    "beyond bufferView");
    refuse_accessor(plain, "'componentType':5126,'count':1.5,'type':'VEC3'", BVX_ERR_FORMAT,
                    "count is not a whole");
    refuse_accessor(plain, "'componentType':5126,'type':'VEC3'", BVX_ERR_FORMAT, "has no count");
    refuse_accessor("{'attributes':{'POSITION':0},'indices':0}", good, BVX_ERR_FORMAT,
                    "indices are unsigned");
    refuse_accessor("{'attributes':{'POSITION':0,'NORMAL':1}}", good, BVX_ERR_FORMAT, "is no NORMAL");
    refuse_accessor("{'attributes':{'POSITION':7}}", good, BVX_ERR_RANGE,
                    "POSITION is 7; there are 2 accessors");
    refuse_accessor("{'attributes':{'POSITION':0}}", good, BVX_ERR_FORMAT, "4 corners are not triangles");
    refuse_accessor("{'attributes':{'POSITION':0},'material':0}", good, BVX_ERR_RANGE,
                    "there are 0 materials");
    refuse_accessor("{'attributes':{'POSITION':0},'mode':7}", good, BVX_ERR_FORMAT, "mode of a primitive");
    refuse_accessor("{'attributes':{'POSITION':0},'mode':1}", good, BVX_ERR_EMPTY, "no triangles");
    refuse_accessor("{'attributes':{}}", good, BVX_ERR_EMPTY, "no triangles");
    refuse_accessor("7", good, BVX_ERR_FORMAT, "a primitive is not an object");
    refuse_accessor(
        "{'attributes':{'POSITION':2},'extensions':{'KHR_draco_mesh_compression':{}},'mode':5}",
        "'componentType':5126,'count':4,'type':'VEC3'},{'componentType':5123,'count':6,'type':'SCALAR'},"
        "{'componentType':5126,'count':4,'type':'VEC3'",
        BVX_ERR_UNSUPPORTED, "compressed by KHR_draco_mesh_compression");
}

/* Few bytes that nodes repeat into gigabytes. */
static void test_repetition_is_limited(void)
{
    size_t n;
    bvx_mesh m;

    begin_quad();
    n = (size_t)snprintf(json, sizeof json, HEAD "'nodes':[");
    for (int i = 0; i < 500; i++)
        n += (size_t)snprintf(json + n, sizeof json - n, "%s{'mesh':0}", i > 0 ? "," : "");
    snprintf(json + n, sizeof json - n, "]," QUAD VIEWS BUFFER);
    m = read_glb(json);
    TEST_ASSERT_EQUAL_UINT64(1000, m.triangle_count);
    expect_triangle(&m, 999, 4 * 499, 4 * 499 + 2, 4 * 499 + 3);
    bvx_mesh_free(ctx, &m);
}

/* ---- refused by name ---- */

static void test_versions_and_extensions(void)
{
    begin_quad();
    refuse_glb("{'asset':{'version':'1.0'},'meshes':{}}", BVX_ERR_UNSUPPORTED, "glTF 1.0");
    refuse_glb("{'meshes':{'a':{}}}", BVX_ERR_UNSUPPORTED, "glTF 1.0");
    refuse_glb("{'asset':{'version':'3.0'}}", BVX_ERR_UNSUPPORTED, "asset.version is not 2.0");
    refuse_glb("{'asset':{'version':'2.0','minVersion':'2.1'}}", BVX_ERR_UNSUPPORTED, "minVersion");
    refuse_glb("{}", BVX_ERR_FORMAT, "asset.version");
    refuse_glb("[]", BVX_ERR_FORMAT, "not an object");
    refuse_glb(HEAD "'extensionsRequired':['KHR_draco_mesh_compression']}", BVX_ERR_UNSUPPORTED,
               "compressed by KHR_draco_mesh_compression");
    refuse_glb(HEAD "'extensionsRequired':['EXT_meshopt_compression']}", BVX_ERR_UNSUPPORTED,
               "compressed by EXT_meshopt_compression");
    refuse_glb(HEAD "'extensionsRequired':['KHR_materials_unlit','EXT_mesh_gpu_instancing']}",
               BVX_ERR_UNSUPPORTED, "requires the extension 'EXT_mesh_gpu_instancing'");
    refuse_glb(HEAD "'extensionsRequired':['a\\nb']}", BVX_ERR_UNSUPPORTED, "'a?b'");
    refuse_glb(HEAD ONE_NODE QUAD
               "'bufferViews':[{'buffer':0,'byteLength':48,'extensions':{'EXT_meshopt_compression':{}}},"
               "{'buffer':0,'byteOffset':48,'byteLength':12}]," BUFFER,
               BVX_ERR_UNSUPPORTED, "bufferView 0 is compressed by EXT_meshopt_compression");
    put_u32(file + 4, 1, 0);
    check_refused(file, 100, BVX_FORMAT_GLB, BVX_ERR_UNSUPPORTED, "glTF 1.0");
    put_u32(file + 4, 7, 0);
    check_refused(file, 100, BVX_FORMAT_GLB, BVX_ERR_UNSUPPORTED, "version is 7");
}

/* ---- JSON ---- */

static void refuse_text(const char *text, const char *words)
{
    size_t const n = set_json(text);
    check_refused(json, n, BVX_FORMAT_GLTF, BVX_ERR_FORMAT, words);
}

static void test_what_is_not_json(void)
{
    static const char *const bad[] = {"{",
                                      "{'a'",
                                      "{'a':",
                                      "{'a':1",
                                      "{'a':1,",
                                      "{'a':1,}",
                                      "{,}",
                                      "{'a' 1}",
                                      "{a:1}",
                                      "[1,]",
                                      "[1 2]",
                                      "[1}",
                                      "{'a':1]",
                                      "tru",
                                      "nul",
                                      "+1",
                                      ".5",
                                      "-",
                                      "1.",
                                      "1e",
                                      "1e+",
                                      "01",
                                      "0x1",
                                      "NaN",
                                      "'",
                                      "'a",
                                      "'\\",
                                      "'\\x'",
                                      "'\\u12'",
                                      "'\\u12g4'",
                                      "'\n'",
                                      "'\xff'",
                                      "'\xc0\x80'",
                                      "'\xed\xa0\x80'",
                                      "'\xf4\x90\x80\x80'",
                                      "'\xe2\x82'",
                                      "{} {}",
                                      "[]]",
                                      "//",
                                      "{'a':'b''c'}",
                                      " ",
                                      "{1:2}"};

    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) refuse_text(bad[i], "JSON");
    check_refused("{\"a\":\"\0\"}", 9, BVX_FORMAT_GLTF, BVX_ERR_FORMAT, "byte 6");
}

/* A million brackets are refused at the first one that is too deep, in little memory. */
static void test_deep_json(void)
{
    char *const text = malloc(1000000);

    memset(text, '[', 1000000);
    check_refused(text, 1000000, BVX_FORMAT_GLTF, BVX_ERR_FORMAT, "byte 64: more than 64 arrays");
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) < 1000);
    for (int i = 0; i < 1000000; i++) text[i] = "{\"a\":"[i % 5];
    check_refused(text, 1000000, BVX_FORMAT_GLTF, BVX_ERR_FORMAT, "byte 320: more than 64 arrays");
    free(text);
}

/* The same names and texts, written with escapes. */
static void test_json_with_escapes(void)
{
    bvx_mesh m;

    begin_quad();
    m = read_glb(
        "\t{'\\u0061sset':{'version':'\\u0032.0','generator':'\\ud83d\\ude00 \\\\ \\/ \\b\\f\\n\\r\\t \\ud800 \xe2\x82\xac'},"
        "'extras':{'a':[null,true,false,-1.5e-3,0,{}]},'m\\u0061terials':[{'name':'\\u00e9'}]," ONE_NODE QUAD
            VIEWS BUFFER "\n");
    TEST_ASSERT_EQUAL_STRING("[{\"name\":\"\\u00e9\"}]", m.assets->materials);
    bvx_mesh_free(ctx, &m);
}

static void test_cut_files(void)
{
    size_t n;

    begin_quad();
    TEST_ASSERT_EQUAL_INT(
        1, check_every_prefix(file, make_glb(HEAD ONE_NODE QUAD VIEWS BUFFER), BVX_FORMAT_GLB, 2));
    n = make_glb(HEAD ONE_NODE QUAD VIEWS BUFFER);
    check_every_limit(file, n, BVX_FORMAT_GLB);
    TEST_ASSERT_TRUE(check_every_cancel(file, n, BVX_FORMAT_GLB) > 0);
    n = set_json(HEAD ONE_NODE QUAD VIEWS
                 "'buffers':[{'byteLength':60,'uri':'data:application/octet-stream;base64,"
                 "AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAQAAAgD8AAAAAAAAAAAAAgD8AAAAAAAABAAIAAAACAAMA'}]}");
    TEST_ASSERT_EQUAL_INT(1, check_every_prefix(json, n, BVX_FORMAT_GLTF, 2));
}

/* ---- files beside ---- */

typedef struct folder {
    char asked[8][64];
    int asks, opened, closed;
} folder;

static int32_t open_in(void *user, const char *name, bvx_file_bytes *found)
{
    folder *const f = user;

    snprintf(f->asked[f->asks++], sizeof f->asked[0], "%s", name);
    if (strcmp(name, "sub/a b.bin") == 0) {
        found->bytes = bin;
        found->size = 60;
    } else if (strcmp(name, "i.png") == 0) {
        found->bytes = "\x89PNG....";
        found->size = 8;
    } else return 1;
    found->handle = f;
    f->opened++;
    return 0;
}

static void close_in(void *user, bvx_file_bytes *found)
{
    folder *const f = user;
    TEST_ASSERT_EQUAL_PTR(f, found->handle);
    f->closed++;
}

static bvx_status read_beside(const char *text, folder *f, bvx_read_report *report, bvx_mesh *m)
{
    size_t const n = set_json(text);
    bvx_read_options o = {.struct_size = sizeof o};
    bvx_status status;

    memset(f, 0, sizeof *f);
    memset(m, 0, sizeof *m);
    memset(report, 0, sizeof *report);
    o.open_file = open_in;
    o.close_file = close_in;
    o.user = f;
    o.report = report;
    status = bvx_read_mesh(ctx, json, n, BVX_FORMAT_GLTF, &o, m);
    TEST_ASSERT_EQUAL_INT(f->opened, f->closed);
    return status;
}

#define BESIDE(uri) HEAD ONE_NODE QUAD VIEWS "'buffers':[{'byteLength':60,'uri':'" uri "'}]"

static void test_buffers_in_files(void)
{
    static const char *const bad[] = {BESIDE("/etc/passwd") "}",
                                      BESIDE("../a.bin") "}",
                                      BESIDE("a/../../b.bin") "}",
                                      BESIDE("%2e%2e/a.bin") "}",
                                      BESIDE("http://a/b.bin") "}",
                                      BESIDE("file:a.bin") "}",
                                      BESIDE("C:\\\\a.bin") "}",
                                      BESIDE("..\\\\a.bin") "}",
                                      BESIDE("a%00.bin") "}",
                                      BESIDE("a%zz.bin") "}",
                                      BESIDE("a%2") "}",
                                      BESIDE("a/..") "}",
                                      BESIDE("") "}",
                                      BESIDE("%2fetc/x") "}",
                                      BESIDE("a\\u0000b") "}"};
    bvx_read_report report;
    folder f;
    bvx_mesh m;

    begin_quad();
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_beside(BESIDE("sub\\/a%20b.bin") "}", &f, &report, &m),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT(1, f.opened);
    TEST_ASSERT_EQUAL_UINT32(0, report.lost);
    expect_at(&m, 2, 2, 1, 0);
    bvx_mesh_free(ctx, &m);

    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_ERR_FORMAT, read_beside(bad[i], &f, &report, &m), bad[i]);
        TEST_ASSERT_EQUAL_INT_MESSAGE(0, f.asks, bad[i]);
    }
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, read_beside(BESIDE("none.bin") "}", &f, &report, &m));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "there is no file 'none.bin'"));
    TEST_ASSERT_EQUAL_INT(1, f.asks);
    refuse_text(BESIDE("sub/a b.bin") "}", "there is no file 'sub/a b.bin'"); /* nothing opens it */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, read_beside(BESIDE("i.png") "}", &f, &report, &m));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "byteLength is 60, there are 8"));
}

static void test_data_uris(void)
{
    static const char *const bad[] = {"data:,abc",
                                      "data:application/gltf-buffer;base64",
                                      "data:text/plain;base64,AAA",
                                      "data:text/plain;base64,A!AA",
                                      "data:text/plain;base64,AAAA====A",
                                      "data:;base64,AAAAA",
                                      "data:a;base64,%41AAA"};
    char text[2000];
    bvx_read_report report;
    folder f;
    bvx_mesh m;

    begin_quad();
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        snprintf(text, sizeof text, HEAD ONE_NODE QUAD VIEWS "'buffers':[{'byteLength':1,'uri':'%s'}]}",
                 bad[i]);
        refuse_text(text, i < 2 ? "a data URI without" : "not base64");
    }
    /* Escaped and with white space, it is the same. */
    TEST_ASSERT_EQUAL_INT32_MESSAGE(
        BVX_OK,
        read_beside(
            BESIDE(
                "data:application\\/octet-stream;base64,AAAAAAAAAAAAAAAAAAAAQAAAAAAAAAAAAAAAQAAAgD8AAAAA\\n"
                "AAAAAAAAgD8AAAAAAAABAAIAAAACAAMA") "}",
            &f, &report, &m),
        bvx_last_message(ctx));
    expect_at(&m, 3, 0, 1, 0);
    bvx_mesh_free(ctx, &m);
}

/* Images of a view, a data URI, a file and none: their bytes, their members, what is lost. */
static void test_assets(void)
{
    static const char wanted[] =
        "[{\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":0,\"extensions\":"
        "{\"KHR_texture_transform\":{\"scale\":[2,2]}}}},\"extensions\":{\"KHR_materials_unlit\":{}}}]";
    bvx_read_report report;
    const bvxi_asset_image *image;
    folder f;
    bvx_mesh m;

    begin_quad();
    TEST_ASSERT_EQUAL_INT32_MESSAGE(
        BVX_OK,
        read_beside(
            BESIDE(
                "sub/a b.bin") ",'extensionsUsed':['KHR_lights_punctual','KHR_texture_transform','KHR_materials_unlit'],"
                               "'extensionsRequired':['KHR_texture_transform'],"
                               "'materials':[{'pbrMetallicRoughness':{'baseColorTexture':{'index':0,'extensions':"
                               "{'KHR_texture_transform':{'scale':[2,2]}}}},'extensions':{'KHR_materials_unlit':{}}}],"
                               "'textures':[{'source':1,'sampler':0}],'samplers':[{'wrapS':33071}],"
                               "'images':[{'bufferView':1,'mimeType':'image/x','name':'v'},{'name':'d','uri':'data:image/jpeg;base64,/9j/'},"
                               "{'uri':'i.png'},{'uri':'gone.png','name':'g'},{'uri':'http://x/y.png'}]}",
            &f, &report, &m),
        bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT32(BVX_LOST_IMAGES, report.lost);
    TEST_ASSERT_EQUAL_INT(2, f.opened);
    TEST_ASSERT_EQUAL_STRING(wanted, m.assets->materials);
    TEST_ASSERT_EQUAL_STRING("[{\"source\":1,\"sampler\":0}]", m.assets->textures);
    TEST_ASSERT_EQUAL_STRING("[{\"wrapS\":33071}]", m.assets->samplers);
    TEST_ASSERT_EQUAL_STRING("[\"KHR_texture_transform\",\"KHR_materials_unlit\"]",
                             m.assets->extensions_used);
    TEST_ASSERT_EQUAL_UINT64(5, m.assets->image_count);
    image = m.assets->images;
    TEST_ASSERT_EQUAL_STRING("\"mimeType\":\"image/x\",\"name\":\"v\"", image[0].members);
    TEST_ASSERT_EQUAL_UINT64(12, image[0].size);
    TEST_ASSERT_EQUAL_MEMORY(bin + 48, image[0].bytes, 12);
    TEST_ASSERT_EQUAL_STRING("\"name\":\"d\",\"mimeType\":\"image/jpeg\"", image[1].members);
    TEST_ASSERT_EQUAL_MEMORY("\xff\xd8\xff", image[1].bytes, 3);
    TEST_ASSERT_EQUAL_STRING("\"mimeType\":\"image/png\"", image[2].members);
    TEST_ASSERT_EQUAL_UINT64(8, image[2].size);
    TEST_ASSERT_EQUAL_STRING("\"uri\":\"gone.png\",\"name\":\"g\"", image[3].members);
    TEST_ASSERT_EQUAL_UINT64(0, image[3].size);
    TEST_ASSERT_EQUAL_STRING("\"uri\":\"http://x/y.png\"", image[4].members);
    bvx_mesh_free(ctx, &m);
}

static void test_losses(void)
{
    bvx_read_report report;
    folder f;
    bvx_mesh m;

    begin_quad();
    TEST_ASSERT_EQUAL_INT32_MESSAGE(
        BVX_OK,
        read_beside(
            HEAD
            "'nodes':[{'mesh':0,'skin':0}],'animations':[{}],'meshes':[{'primitives':["
            "{'attributes':{'POSITION':0,'TANGENT':0,'JOINTS_0':0,'_MINE':0},'indices':1,'targets':[{}]},"
            "{'attributes':{'POSITION':0},'mode':0}]}],"
            "'accessors':[{'bufferView':0,'componentType':5126,'count':4,'type':'VEC3'},"
            "{'bufferView':1,'componentType':5123,'count':6,'type':'SCALAR'}]," VIEWS
            "'buffers':[{'byteLength':60,'uri':'sub/a b.bin'}]}",
            &f, &report, &m),
        bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT32(BVX_LOST_SKINS | BVX_LOST_MORPHS | BVX_LOST_ANIMATIONS | BVX_LOST_POINTS |
                                 BVX_LOST_ATTRIBUTES,
                             report.lost);
    bvx_mesh_free(ctx, &m);
}

/* Triangles with a corner nowhere go, with all that vertices and triangles have. */
static void test_drop_nonfinite(void)
{
    bvx_read_options o = {.struct_size = sizeof o};
    bvx_read_report report = {0};
    bvx_mesh m = {0};
    size_t n;

    begin_two();
    put_f32(bin + 12, INFINITY, 0);
    n = make_glb(TWO_PRIMITIVES("{'attributes':{'POSITION':0,'TEXCOORD_1':3},'indices':1,'material':0}"));
    o.drop_nonfinite = 1;
    o.report = &report;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_read_mesh(ctx, file, n, BVX_FORMAT_GLB, &o, &m),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(2, report.dropped);
    TEST_ASSERT_EQUAL_UINT64(6, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(2, m.triangle_count);
    TEST_ASSERT_TRUE(m.materials[0] == 1 && m.materials[1] == 0);
    TEST_ASSERT_TRUE(m.normals[0] == 1.0f && m.normals[9] == 0.0f && m.uvs2[0] == 0.0f && m.uvs2[6] == 1.0f);
    TEST_ASSERT_EQUAL_STRING("[{},{\"name\":\"b\"}]", m.assets->materials);
    bvx_mesh_free(ctx, &m);
}

static void test_options_are_checked(void)
{
    bvx_read_options o = {.struct_size = sizeof o};
    bvx_mesh m = {0};
    size_t n;

    begin_quad();
    n = make_glb(HEAD ONE_NODE QUAD VIEWS BUFFER);
    o.open_file = open_in;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_mesh(ctx, file, n, BVX_FORMAT_GLB, &o, &m));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "open_file and close_file"));
    TEST_ASSERT_EQUAL_INT32(BVX_REASON_CONTRADICTION, bvx_last_error(ctx)->reason);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_mesh(ctx, file, n, BVX_FORMAT_GLTF, NULL, &m)); /* by content */
    bvx_mesh_free(ctx, &m);
}

/* ---- what the writer makes, and well-known files ---- */

static void test_what_is_written_comes_back(void)
{
    static float positions[9] = {1, 2, 3, 4, 5, 6.5f, 7, 8, 10};
    static uint32_t triangle[3] = {0, 1, 2};
    static uint8_t colours[12] = {0, 1, 2, 3, 100, 128, 200, 255, 254, 255, 17, 9};
    static float uvs[6] = {0, 0.5f, 1, -3, 2, 7};
    bvx_mesh m = {0}, back;
    bvx_buffer b = {0};

    m.positions = positions;
    m.triangles = triangle;
    m.colours = colours;
    m.uvs = uvs;
    m.vertex_count = m.vertex_capacity = m.uv_count = 3;
    m.triangle_count = m.triangle_capacity = 1;
    m.position_type = BVX_F32;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, NULL, BVX_FORMAT_GLB, &b));
    memcpy(file, b.bytes, b.size);
    uint64_t const size = b.size;
    bvx_buffer_free(ctx, &b);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(file, size, BVX_FORMAT_GLB, &back),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32(BVX_F32, back.position_type);
    for (int v = 0; v < 3; v++) TEST_ASSERT_TRUE(((float *)back.positions)[3 * v] == positions[3 * v]);
    TEST_ASSERT_EQUAL_MEMORY(colours, back.colours, sizeof colours);
    TEST_ASSERT_EQUAL_MEMORY(uvs, back.uvs, sizeof uvs);
    TEST_ASSERT_EQUAL_MEMORY(triangle, back.triangles, sizeof triangle);
    bvx_mesh_free(ctx, &back);
}

/* Counts by pygltflib 1.16 and trimesh 5.2. */
static void test_known_files(void)
{
    static const struct {
        const char *name;
        bvx_status status;
        uint64_t triangles, vertices, materials, images;
    } known[] = {
        {"DamagedHelmet.glb", BVX_OK, 15452, 14556, 1, 5},
        {"ShapeCollection.glb", BVX_OK, 3542, 7176, 0, 0},
        {"TwoCubes.glb", BVX_OK, 24, 48, 2, 0},
        {"BoxVertexColors.glb", BVX_OK, 12, 24, 1, 0},
        {"chr_knight.glb", BVX_OK, 1460, 4380, 1, 1},
        {"Box-embedded.gltf", BVX_OK, 12, 24, 1, 0},
        {"BoxMeshopt.glb", BVX_ERR_UNSUPPORTED, 0, 0, 0, 0},
        {"pirate.glb", BVX_ERR_UNSUPPORTED, 0, 0, 0, 0},
        {"BoxDraco.gltf", BVX_ERR_UNSUPPORTED, 0, 0, 0, 0},
        {"DenseSphere.glb", BVX_ERR_UNSUPPORTED, 0, 0, 0, 0},
    };

    for (size_t i = 0; i < sizeof known / sizeof known[0]; i++) {
        char name[120];
        static uint8_t bytes[1 << 22];
        size_t n;
        FILE *f;
        bvx_mesh m = {0};

        snprintf(name, sizeof name, "../shared/gltf/%s", known[i].name);
        f = fopen(name, "rb");
        if (f == NULL) TEST_IGNORE_MESSAGE("there is no ../shared/gltf");
        n = fread(bytes, 1, sizeof bytes, f);
        fclose(f);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(
            known[i].status,
            bvx_read_mesh(ctx, bytes, n, strstr(name, ".glb") != NULL ? BVX_FORMAT_GLB : BVX_FORMAT_GLTF,
                          NULL, &m),
            known[i].name);
        TEST_ASSERT_EQUAL_UINT64(known[i].triangles, m.triangle_count);
        TEST_ASSERT_EQUAL_UINT64(known[i].vertices, m.vertex_count);
        TEST_ASSERT_EQUAL_UINT64(known[i].materials, m.assets != NULL ? m.assets->material_count : 0);
        TEST_ASSERT_EQUAL_UINT64(known[i].images, m.assets != NULL ? m.assets->image_count : 0);
        if (m.assets == NULL && known[i].status != BVX_OK)
            TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "_compression"));
        bvx_mesh_free(ctx, &m);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_square);
    RUN_TEST(test_the_default_scene_is_drawn);
    RUN_TEST(test_indices_of_every_type);
    RUN_TEST(test_strips_and_fans);
    RUN_TEST(test_strides_and_offsets);
    RUN_TEST(test_sparse_elements_replace_others);
    RUN_TEST(test_an_accessor_without_bytes_is_zero);
    RUN_TEST(test_quantized_positions);
    RUN_TEST(test_quantized_normals_and_uvs);
    RUN_TEST(test_colours);
    RUN_TEST(test_attributes_of_one_primitive_only);
    RUN_TEST(test_primitives_of_the_same_accessors_share_vertices);
    RUN_TEST(test_transforms_of_parents_first);
    RUN_TEST(test_a_mirror_turns_triangles_and_keeps_normals);
    RUN_TEST(test_doubles_for_what_is_far_away);
    RUN_TEST(test_nodes_that_are_no_tree);
    RUN_TEST(test_arrays_beyond_their_bytes);
    RUN_TEST(test_accessors_of_the_wrong_kind);
    RUN_TEST(test_repetition_is_limited);
    RUN_TEST(test_versions_and_extensions);
    RUN_TEST(test_what_is_not_json);
    RUN_TEST(test_deep_json);
    RUN_TEST(test_json_with_escapes);
    RUN_TEST(test_cut_files);
    RUN_TEST(test_buffers_in_files);
    RUN_TEST(test_data_uris);
    RUN_TEST(test_assets);
    RUN_TEST(test_losses);
    RUN_TEST(test_drop_nonfinite);
    RUN_TEST(test_options_are_checked);
    RUN_TEST(test_what_is_written_comes_back);
    RUN_TEST(test_known_files);
    return UNITY_END();
}
