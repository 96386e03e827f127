/* test_write_glb.c - meshes written to binary glTF, taken apart (glb_support.h):
 * chunks, description, arrays, and what a viewer would make of them. */
#include "glb_support.h"

#include "io_mesh/glb.h"

#include <math.h>

/* ---- tests ---- */

static void check_positions(const bvx_mesh *m)
{
    glb_file f = write_glb(m);
    glb_array const positions = take_array(&f, "POSITION"), index = take_array(&f, NULL);
    int const plain = m->position_type == BVX_F32 && m->frame[0] == 0.0;
    double centre[3], low[3], high[3], p[3];
    float least[3], most[3];

    node_translation(&f, 0, centre);
    TEST_ASSERT_NULL(json_item(json_member(f.json, "nodes"), 1));
    world_of(m, m->triangles[0], low);
    world_of(m, m->triangles[0], high);
    for (size_t i = 0; i < m->triangle_count * 3; i++) {
        world_of(m, m->triangles[i], p);
        for (int a = 0; a < 3; a++) {
            if (p[a] < low[a]) low[a] = p[a];
            if (p[a] > high[a]) high[a] = p[a];
        }
    }
    /* 32-bit floats in the world are written as they are. */
    for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(centre[a] == (plain ? 0.0 : low[a] * 0.5 + high[a] * 0.5));
    TEST_ASSERT_EQUAL_UINT64(m->vertex_count, positions.count);
    TEST_ASSERT_EQUAL_UINT32(5126, positions.component);
    TEST_ASSERT_EQUAL_UINT32(3, positions.components);
    for (uint32_t v = 0; v < positions.count; v++) {
        world_of(m, v, p);
        for (uint32_t a = 0; a < 3; a++) {
            float const f32 = take_f32(positions.at + 12 * (size_t)v + 4 * a);
            float const want = (float)(p[a] - centre[a]);
            TEST_ASSERT_EQUAL_MEMORY(&want, &f32, 4);
            if (v == 0 || f32 < least[a]) least[a] = f32;
            if (v == 0 || f32 > most[a]) most[a] = f32;
        }
    }
    for (int a = 0; a < 3; a++) {
        TEST_ASSERT_TRUE(json_number_in(positions.min, a) == (double)least[a]);
        TEST_ASSERT_TRUE(json_number_in(positions.max, a) == (double)most[a]);
    }
    TEST_ASSERT_EQUAL_UINT64(m->triangle_count * 3, index.count);
    for (uint32_t i = 0; i < index.count; i++) TEST_ASSERT_EQUAL_UINT32(m->triangles[i], index_at(&index, i));
    free_file(&f);
}

static void test_write_glb_positions(void)
{
    for (int32_t type = BVX_F32; type <= BVX_F64; type++) {
        bvx_mesh m = octahedron(type);
        check_positions(&m);
        m.frame[0] = 500000.1;
        m.frame[1] = -4649776.3;
        check_positions(&m);
        m.triangle_count = 3; /* an odd count of 16-bit indices; vertex 5 is unused */
        check_positions(&m);
    }
}

static void test_write_glb_description(void)
{
    bvx_mesh m = octahedron(BVX_F32);
    glb_file f = write_glb(&m);
    const char *const primitive = primitive_of(&f, 0, 0);

    TEST_ASSERT_EQUAL_INT(
        0, strncmp("{\"version\":\"2.0\",\"generator\":\"bitvox\"}", json_member(f.json, "asset"), 38));
    TEST_ASSERT_EQUAL_INT('0', *json_member(f.json, "scene"));
    TEST_ASSERT_NULL(json_member(f.json, "materials"));
    TEST_ASSERT_NULL(json_member(f.json, "extensionsUsed"));
    TEST_ASSERT_EQUAL_INT('4', *json_member(primitive, "mode"));
    TEST_ASSERT_NULL(json_member(primitive, "material"));
    TEST_ASSERT_TRUE(strtoul(json_member(json_item(json_member(f.json, "buffers"), 0), "byteLength"), NULL,
                             10) == 6 * 24 + 48);
    TEST_ASSERT_NULL(json_item(json_member(f.json, "buffers"), 1));
    TEST_ASSERT_NULL(json_item(json_member(f.json, "accessors"), 3));
    TEST_ASSERT_EQUAL_UINT32(0, take_array(&f, "COLOR_0").count);
    TEST_ASSERT_EQUAL_UINT32(0, take_array(&f, "TEXCOORD_0").count);
    free_file(&f);
}

/* The default is a metal: colours need a material that shows them. */
static void test_write_glb_material_of_colours(void)
{
    static uint8_t six[24];
    bvx_mesh m = octahedron(BVX_F32);
    m.colours = six;
    glb_file f = write_glb(&m);
    const char *const material = json_item(json_member(f.json, "materials"), 0);
    const char *const surface = json_member(material, "pbrMetallicRoughness");

    TEST_ASSERT_NULL(json_member(material, "doubleSided"));
    TEST_ASSERT_EQUAL_INT('0', *json_member(surface, "metallicFactor"));
    TEST_ASSERT_EQUAL_INT('1', *json_member(surface, "roughnessFactor"));
    TEST_ASSERT_EQUAL_INT('0', *json_member(primitive_of(&f, 0, 0), "material"));
    TEST_ASSERT_NULL(json_item(json_member(f.json, "materials"), 1));
    free_file(&f);
}

/* The padding of both chunks: descriptions and indices of every length. */
static void test_write_glb_padding(void)
{
    int json_padding = 0, binary_padding = 0;

    for (int i = 0; i < 64; i++) {
        bvx_mesh m = octahedron(BVX_F64);
        m.triangle_count = (uint64_t)(i % 8 + 1);
        m.frame[2] = (double)(UINT64_C(1) << i);
        glb_file f = write_glb(&m);
        glb_array const index = take_array(&f, NULL);
        const uint8_t *const end = index.at + 2 * (size_t)index.count;
        const char *const buffer = json_item(json_member(f.json, "buffers"), 0);
        uint32_t const length = (uint32_t)strtoul(json_member(buffer, "byteLength"), NULL, 10);
        TEST_ASSERT_EQUAL_UINT32(length, (uint32_t)(end - f.binary));
        TEST_ASSERT_TRUE(f.binary_size - length < 4);
        for (uint32_t k = length; k < f.binary_size; k++) TEST_ASSERT_EQUAL_UINT8(0, f.binary[k]);
        json_padding |= 1 << (strlen(f.json) - (size_t)(strrchr(f.json, '}') + 1 - f.json));
        binary_padding |= 1 << (f.binary_size - length);
        free_file(&f);
    }
    TEST_ASSERT_EQUAL_INT(15, json_padding);
    TEST_ASSERT_EQUAL_INT(5, binary_padding);
}

/* The slow way: for each vertex all triangles. */
static void check_normals(const bvx_mesh *m)
{
    glb_file f = write_glb(m);
    glb_array const normals = take_array(&f, "NORMAL");

    TEST_ASSERT_EQUAL_UINT64(m->vertex_count, normals.count);
    for (uint32_t v = 0; v < normals.count; v++) {
        double sum[3] = {0, 0, 0}, length2 = 0, dot = 0, size;
        for (uint64_t t = 0; t < m->triangle_count; t++) {
            double p[3][3];
            for (int k = 0; k < 3; k++) corner_of(m, t, k, p[k]);
            for (int k = 0; k < 3; k++)
                for (int a = 0; m->triangles[3 * t + (uint64_t)k] == v && a < 3; a++) {
                    int const b = (a + 1) % 3, c = (a + 2) % 3;
                    sum[a] += (p[1][b] - p[0][b]) * (p[2][c] - p[0][c]) -
                              (p[1][c] - p[0][c]) * (p[2][b] - p[0][b]);
                }
        }
        size = sqrt(sum[0] * sum[0] + sum[1] * sum[1] + sum[2] * sum[2]);
        for (uint32_t a = 0; a < 3; a++) {
            double const n = (double)take_f32(normals.at + 12 * (size_t)v + 4 * a);
            length2 += n * n;
            dot += n * (size > 0 ? sum[a] / size : a == 2);
        }
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, sqrt(length2));
        TEST_ASSERT_DOUBLE_WITHIN(1e-6, 1.0, dot);
    }
    free_file(&f);
}

static void test_write_glb_normals(void)
{
    bvx_mesh m = octahedron(BVX_F64);
    glb_file f = write_glb(&m);
    glb_array const normals = take_array(&f, "NORMAL");

    TEST_ASSERT_TRUE(take_f32(normals.at + 4) == 0 && take_f32(normals.at) > 0.5f); /* by symmetry in y */
    TEST_ASSERT_TRUE(take_f32(normals.at + 4 * 12 + 8) == 1 && take_f32(normals.at + 5 * 12 + 8) == -1);
    free_file(&f);
    check_normals(&m);
    m.triangle_count = 4;
    check_normals(&m); /* vertex 5 has no triangle */
    m.triangles[0] = m.triangles[1];
    check_normals(&m); /* and one triangle no area */
    uint64_t state = 99;
    m = random_mesh(BVX_F64, 0, 1);
    for (int i = 0; i < VERTICES * 3; i++) xyz64[i] = (double)(next_random(&state) >> 40) * 1e-3;
    check_normals(&m);
}

/* Areas far outside of what a float or the square of a double holds still give directions. */
static void test_write_glb_normals_of_any_size(void)
{
    static const double sizes[] = {1e-150, 1e-80, 1e-30, 1, 1e30, 3e38};
    double p[9];
    uint32_t t[3] = {0, 1, 2};
    bvx_mesh m = {0};

    m.positions = p;
    m.triangles = t;
    m.vertex_count = 3;
    m.triangle_count = 1;
    m.position_type = BVX_F64;
    for (size_t i = 0; i < sizeof sizes / sizeof sizes[0]; i++) {
        double const s = sizes[i], corner[9] = {0, 0, 0, 0, s, 0, 0, 0, s};
        memcpy(p, corner, sizeof p);
        glb_file f = take_file(write_rounded(&m, BVX_FORMAT_GLB));
        glb_array const normals = take_array(&f, "NORMAL");
        for (uint32_t v = 0; v < 3; v++) {
            TEST_ASSERT_TRUE(take_f32(normals.at + 12 * v) == 1.0f);
            TEST_ASSERT_TRUE(take_f32(normals.at + 12 * v + 4) == 0.0f &&
                             take_f32(normals.at + 12 * v + 8) == 0.0f);
        }
        free_file(&f);
    }
}

static void test_write_glb_colours(void)
{
    static float p[256 * 3];
    static uint8_t c[256 * 4];
    uint32_t t[3] = {0, 1, 2};
    bvx_mesh m = {0};

    for (int i = 0; i < 256; i++)
        for (int k = 0; k < 4; k++)
            c[4 * i + k] = (uint8_t)(k == 0 ? i : k == 1 ? 255 - i : k == 2 ? i ^ 85 : i);
    m.positions = p;
    m.triangles = t;
    m.vertex_count = 256;
    m.triangle_count = 1;
    m.position_type = BVX_F32;
    m.colours = c;
    glb_file f = write_glb(&m);
    glb_array const a = take_array(&f, "COLOR_0");
    const char *const accessor = strstr(
        f.json, "\"componentType\":5123,\"normalized\":true,\"count\":256,\"type\":\"VEC4\"");
    TEST_ASSERT_NOT_NULL(accessor);
    TEST_ASSERT_EQUAL_UINT32(5123, a.component);
    TEST_ASSERT_EQUAL_UINT32(4, a.components);
    TEST_ASSERT_EQUAL_UINT32(256, a.count);
    for (int i = 0; i < 1024; i++) {
        double const x = c[i] / 255.0, linear = x <= 0.04045 ? x / 12.92 : pow((x + 0.055) / 1.055, 2.4);
        double const want = floor(65535.0 * (i % 4 == 3 ? x : linear) + 0.5);
        TEST_ASSERT_EQUAL_INT((int)want, a.at[2 * i] | a.at[2 * i + 1] << 8);
    }
    free_file(&f);
}

static void test_write_glb_texture_coordinates_of_vertices(void)
{
    bvx_mesh m = octahedron(BVX_F32);
    float uv[16] = {0, 0, 1, 0, 0.25f, 0.75f, -2, 3, 1e-20f, 1e-20f, 7, 1, 9, 9};

    m.uvs = uv;
    m.uv_count = 8; /* a capacity beyond the vertices */
    glb_file f = write_glb(&m);
    glb_array const a = take_array(&f, "TEXCOORD_0");
    TEST_ASSERT_EQUAL_UINT32(6, a.count);
    TEST_ASSERT_EQUAL_UINT32(5126, a.component);
    TEST_ASSERT_EQUAL_UINT32(2, a.components);
    for (size_t v = 0; v < 6; v++) {
        TEST_ASSERT_TRUE(take_f32(a.at + 8 * v) == uv[2 * v]);
        TEST_ASSERT_TRUE(take_f32(a.at + 8 * v + 4) == 1.0f - uv[2 * v + 1]);
    }
    free_file(&f);
}

/* Every corner keeps its position, colour, normal and texture coordinate;
 * no vertex is there twice; vertices are in the order of their first use. */
static void test_write_glb_splits_at_seams(void)
{
    for (uint64_t seed = 1; seed < 10; seed++) {
        bvx_mesh m = random_mesh(BVX_F64, WITH_COLOURS | WITH_CORNER_UVS, seed);
        uint64_t state = seed + 5;
        uint32_t used = 0, pairs = 0;
        for (int i = 0; i < VERTICES * 3; i++) xyz64[i] = (double)(next_random(&state) >> 40) * 1e-3;
        for (int i = 0; i < UVS * 2; i++) uvs[i] = (float)(next_random(&state) >> 40) * 0.001f;
        for (int i = 0; i < TRIANGLES * 3; i++) { /* few texture coordinates a vertex, some the same */
            if (i >= 900) triangles[i] = (uint32_t)(next_random(&state) % 40);
            uv_triangles[i] = seed % 2 ? triangles[i]
                                       : (triangles[i] + (uint32_t)(next_random(&state) % 3)) % UVS;
        }
        for (int i = 0; i < TRIANGLES * 3; i++) {
            int k = 0;
            while (k < i && (triangles[k] != triangles[i] || uv_triangles[k] != uv_triangles[i])) k++;
            pairs += k == i;
        }
        glb_file f = write_glb(&m);
        m.uvs = NULL;
        m.uv_triangles = NULL;
        m.uv_count = 0;
        glb_file whole = write_glb(&m); /* without seams: vertices are those of the mesh */
        glb_array const at = take_array(&f, "POSITION");
        glb_array const normal = take_array(&f, "NORMAL");
        glb_array const colour = take_array(&f, "COLOR_0");
        glb_array const uv = take_array(&f, "TEXCOORD_0"), index = take_array(&f, NULL);
        glb_array const at0 = take_array(&whole, "POSITION"), normal0 = take_array(&whole, "NORMAL"),
                        colour0 = take_array(&whole, "COLOR_0");
        TEST_ASSERT_EQUAL_UINT32(pairs, at.count);
        TEST_ASSERT_TRUE(normal.count == pairs && colour.count == pairs && uv.count == pairs);
        TEST_ASSERT_EQUAL_UINT32(VERTICES, at0.count);
        for (uint32_t i = 0; i < TRIANGLES * 3; i++) {
            size_t const v = index_at(&index, i), v0 = triangles[i];
            TEST_ASSERT_TRUE(v <= used);
            used += v == used;
            TEST_ASSERT_EQUAL_MEMORY(at0.at + 12 * v0, at.at + 12 * v, 12);
            TEST_ASSERT_EQUAL_MEMORY(normal0.at + 12 * v0, normal.at + 12 * v, 12);
            TEST_ASSERT_EQUAL_MEMORY(colour0.at + 8 * v0, colour.at + 8 * v, 8);
            TEST_ASSERT_TRUE(take_f32(uv.at + 8 * v) == uvs[2 * uv_triangles[i]]);
            TEST_ASSERT_TRUE(take_f32(uv.at + 8 * v + 4) ==
                             (float)(1.0 - (double)uvs[2 * uv_triangles[i] + 1]));
        }
        TEST_ASSERT_EQUAL_UINT32(pairs, used);
        free_file(&f);
        free_file(&whole);
    }
}

static void test_write_glb_index_size(void)
{
    for (uint32_t vertices = 65534; vertices <= 65537; vertices++) {
        bvx_mesh m = make_strip(vertices);
        glb_file f = write_glb(&m);
        glb_array const index = take_array(&f, NULL);
        uint32_t most = 0;
        TEST_ASSERT_EQUAL_UINT32(vertices <= 65535 ? 5123 : 5125, index.component);
        for (uint32_t i = 0; i < index.count; i++) {
            TEST_ASSERT_EQUAL_UINT32(m.triangles[i], index_at(&index, i));
            if (m.triangles[i] > most) most = m.triangles[i];
        }
        TEST_ASSERT_EQUAL_UINT32(vertices - 1, most);
        free_file(&f);
        free_strip(&m);
    }
}

static void test_write_glb_workers(void)
{
    bvx_mesh m = make_strip(9999);
    uint32_t *const corners = malloc((size_t)m.triangle_count * 12);

    for (size_t i = 0; i < m.triangle_count * 3; i++)
        corners[i] = (m.triangles[i] + (uint32_t)(i % 2)) % 9999;
    check_workers_change_nothing(&m, BVX_FORMAT_GLB);
    m.uv_triangles = corners;
    check_workers_change_nothing(&m, BVX_FORMAT_GLB);
    free(corners);
    free_strip(&m);
}

/* One number, the same on every machine. */
static void test_write_glb_golden(void)
{
    bvx_mesh m = make_strip(1000);
    bvx_buffer b = write_file(&m, BVX_FORMAT_GLB);
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x188F645711105CF5), bvx_hash(b.bytes, (size_t)b.size, 0));
    bvx_buffer_free(ctx, &b);
    free_strip(&m);
}

static void test_write_glb_refuses_what_floats_cannot_hold(void)
{
    double p[9] = {-2, 0, 0, 2, 0, 0, 0, 3.4028235677973366e38, -1}; /* twice what fits, once halved */
    uint32_t t[3] = {0, 1, 2};
    bvx_mesh m = {0};

    m.positions = p;
    m.triangles = t;
    m.vertex_count = 3;
    m.triangle_count = 1;
    m.position_type = BVX_F64;
    glb_file f = write_glb(&m);
    glb_array const positions = take_array(&f, "POSITION");
    TEST_ASSERT_TRUE(take_f32(positions.at + 28) == -take_f32(positions.at + 4));
    free_file(&f);
    p[1] = -p[7];
    check_not_written(&m, BVX_FORMAT_GLB, BVX_ERR_RANGE, "vertex 0");
    p[1] = 1.7e308;
    p[7] = 1.7e308;
    check_not_written(&m, BVX_FORMAT_GLB, BVX_ERR_RANGE, "vertex 0");
}

/* Counts too large to try are put to the plan of the file. */
static void test_write_glb_refuses_files_beyond_the_format(void)
{
    static uint8_t some_colours[4];
    static float some_uvs[2];
    bvx_mesh m = {0};
    bvxi_file_frame const frame = {{0.0, 0.0, 0.0}, 0.0};
    bvxi_glb glb = {0};

    glb.mesh = &m;
    glb.frame = &frame;
    m.triangle_count = 200000000;
    glb.vertices = 78000000;
    bvxi_glb_layout(&glb, 0);
    TEST_ASSERT_TRUE(glb.end == UINT64_C(78000000) * 24 + UINT64_C(200000000) * 12);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_glb_check_size(ctx, glb.end, 1));
    m.colours = some_colours;
    bvxi_glb_layout(&glb, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvxi_glb_check_size(ctx, glb.end, 1));
    m.colours = NULL;
    m.uvs = some_uvs;
    bvxi_glb_layout(&glb, 0);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvxi_glb_check_size(ctx, glb.end, 1));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "4896000000 bytes"));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "take PLY"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvxi_glb_check_size(ctx, glb.end, 2));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "one file a level"));
    bvxi_glb_layout(&glb, 1000); /* behind another level */
    TEST_ASSERT_TRUE(glb.at[0] == 1000 && glb.end == UINT64_C(4896001000));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_glb_check_size(ctx, UINT32_MAX, 1));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvxi_glb_check_size(ctx, (uint64_t)UINT32_MAX + 1, 1));
    m.triangle_count = INT32_MAX;
    glb.vertices = UINT32_MAX;
    bvxi_glb_layout(&glb, 0);
    TEST_ASSERT_TRUE(glb.end == UINT64_C(4294967295) * 32 + UINT64_C(2147483647) * 12);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_write_glb_positions);
    RUN_TEST(test_write_glb_description);
    RUN_TEST(test_write_glb_material_of_colours);
    RUN_TEST(test_write_glb_padding);
    RUN_TEST(test_write_glb_normals);
    RUN_TEST(test_write_glb_normals_of_any_size);
    RUN_TEST(test_write_glb_colours);
    RUN_TEST(test_write_glb_texture_coordinates_of_vertices);
    RUN_TEST(test_write_glb_splits_at_seams);
    RUN_TEST(test_write_glb_index_size);
    RUN_TEST(test_write_glb_workers);
    RUN_TEST(test_write_glb_golden);
    RUN_TEST(test_write_glb_refuses_what_floats_cannot_hold);
    RUN_TEST(test_write_glb_refuses_files_beyond_the_format);
    return UNITY_END();
}
