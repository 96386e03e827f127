/* test_write_levels.c - levels of detail in one binary glTF file: nodes and what hangs on them, arrays of
 * each level beside those of a file of its own, and what is refused. */
#include "glb_support.h"

static bvx_mesh level[3];
static uint32_t corners[300];

/* An octahedron with an odd count of 16-bit indices; a strip with colours and texture coordinates; one with
 * seams and without colours. All are far from the origin. */
static void make_levels(void)
{
    level[0] = octahedron(BVX_F64);
    level[0].triangle_count = 7;
    level[0].frame[0] = 500000.25;
    level[0].frame[1] = -4649776.5;
    for (int i = 1; i < 3; i++) {
        level[i] = make_strip(i == 1 ? 6 : 5);
        memcpy(level[i].frame, level[0].frame, sizeof level[i].frame);
    }
    for (uint32_t i = 0; i < 9; i++) corners[i] = (level[2].triangles[i] + i % 2) % 5;
    level[2].uv_triangles = corners;
    free(level[2].colours);
    level[2].colours = NULL;
}

static void free_levels(void)
{
    free_strip(&level[1]);
    free_strip(&level[2]);
}

static bvx_buffer write_levels(const bvx_mesh *levels, uint64_t count)
{
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_mesh(ctx, levels, count, NULL, BVX_FORMAT_GLB, &b),
                                    bvx_last_message(ctx));
    TEST_ASSERT_TRUE(b.size > 0 && b.size <= b.capacity);
    return b;
}

static void check_text(const char *at, const char *want)
{
    TEST_ASSERT_NOT_NULL(at);
    if (strncmp(at, want, strlen(want)) != 0) TEST_ASSERT_EQUAL_STRING(want, at);
}

static void test_write_levels_description(void)
{
    make_levels();
    glb_file f = take_file(write_levels(level, 3));
    const char *const nodes = json_member(f.json, "nodes");
    const char *const scene = json_item(json_member(f.json, "scenes"), 0);

    check_text(json_member(f.json, "extensionsUsed"), "[\"MSFT_lod\"],");
    TEST_ASSERT_NULL(json_member(f.json, "extensionsRequired"));
    TEST_ASSERT_EQUAL_INT('0', *json_member(f.json, "scene"));
    check_text(json_member(scene, "nodes"), "[0]}");
    for (int i = 0; i < 3; i++) {
        static const char *const names[3] = {"\"level_0\"", "\"level_1\"", "\"level_2\""};
        const char *const node = json_item(nodes, i);
        check_text(json_member(node, "name"), names[i]);
        TEST_ASSERT_EQUAL_INT(i, atoi(json_member(node, "mesh")));
        TEST_ASSERT_EQUAL_INT(i == 0, json_member(node, "extensions") != NULL);
        TEST_ASSERT_EQUAL_INT(i == 0, json_member(node, "extras") != NULL);
        TEST_ASSERT_NULL(json_member(node, "children"));
    }
    TEST_ASSERT_NULL(json_item(nodes, 3));
    TEST_ASSERT_NULL(json_item(json_member(f.json, "meshes"), 3));
    check_text(json_member(json_member(json_item(nodes, 0), "extensions"), "MSFT_lod"), "{\"ids\":[1,2]}");
    /* of the colours of one of them, for all */
    TEST_ASSERT_NULL(json_item(json_member(f.json, "materials"), 1));
    for (int i = 0; i < 3; i++) TEST_ASSERT_EQUAL_INT('0', *json_member(primitive_of(&f, i, 0), "material"));

    /* 7, 4 and 3 triangles */
    const char *const coverage = json_member(json_member(json_item(nodes, 0), "extras"),
                                             "MSFT_screencoverage");
    TEST_ASSERT_TRUE(json_number_in(coverage, 0) == 4.0 / 7 && json_number_in(coverage, 1) == 3.0 / 7);
    TEST_ASSERT_TRUE(json_number_in(coverage, 2) == 0);
    TEST_ASSERT_NULL(json_item(coverage, 3));

    const char *const last = json_member(json_item(json_member(f.json, "buffers"), 0), "byteLength");
    glb_array const index = take_array_of(&f, 2, NULL);
    TEST_ASSERT_EQUAL_UINT32((uint32_t)(index.at - f.binary) + 2 * index.count,
                             (uint32_t)strtoul(last, NULL, 10));
    free_file(&f);
    free_levels();
}

/* Levels in another order than that of their sizes: hints do not grow. */
static void test_write_levels_coverage_never_grows(void)
{
    static const uint64_t triangles_of[5] = {4, 8, 2, 3, 1};
    static const double want[5] = {1, 0.5, 0.5, 0.25, 0};
    bvx_mesh many[5];

    for (int i = 0; i < 5; i++) {
        many[i] = octahedron(BVX_F32);
        many[i].triangle_count = triangles_of[i];
    }
    glb_file f = take_file(write_levels(many, 5));
    const char *const extras = json_member(json_item(json_member(f.json, "nodes"), 0), "extras");
    for (int i = 0; i < 5; i++)
        TEST_ASSERT_TRUE(json_number_in(json_member(extras, "MSFT_screencoverage"), i) == want[i]);
    free_file(&f);
}

/* One place for all: the middle of the bounds of all levels. */
static void test_write_levels_stand_where_they_are(void)
{
    double low[3], high[3], p[3];
    make_levels();
    for (int l = 0; l < 3; l++)
        for (uint64_t i = 0; i < level[l].triangle_count * 3; i++) {
            world_of(&level[l], level[l].triangles[i], p);
            for (int a = 0; a < 3; a++) {
                if ((l == 0 && i == 0) || p[a] < low[a]) low[a] = p[a];
                if ((l == 0 && i == 0) || p[a] > high[a]) high[a] = p[a];
            }
        }

    glb_file f = take_file(write_levels(level, 3));
    for (int l = 0; l < 3; l++) {
        glb_array const at = take_array_of(&f, l, "POSITION"), index = take_array_of(&f, l, NULL);
        double centre[3];
        node_translation(&f, l, centre);
        for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(centre[a] == low[a] * 0.5 + high[a] * 0.5);
        for (uint32_t i = 0; i < index.count; i++) {
            world_of(&level[l], level[l].triangles[i], p);
            for (uint32_t a = 0; a < 3; a++) {
                float const local = take_f32(at.at + 12 * (size_t)index_at(&index, i) + 4 * a);
                TEST_ASSERT_DOUBLE_WITHIN(1e-6, p[a], centre[a] + (double)local);
            }
        }
    }
    free_file(&f);
    free_levels();
}

/* All but the positions, which have another centre, are what a file of the level's own has. */
static void test_write_levels_have_the_arrays_of_single_files(void)
{
    static const char *const names[] = {"NORMAL", "COLOR_0", "TEXCOORD_0", NULL};

    make_levels();
    glb_file f = take_file(write_levels(level, 3));
    for (int l = 0; l < 3; l++) {
        glb_file own = write_glb(&level[l]);
        TEST_ASSERT_EQUAL_UINT32(take_array(&own, "POSITION").count, take_array_of(&f, l, "POSITION").count);
        for (int i = 0; i < 4; i++) {
            glb_array const a = take_array_of(&f, l, names[i]), b = take_array(&own, names[i]);
            TEST_ASSERT_TRUE(a.count == b.count && a.component == b.component &&
                             a.components == b.components);
            if (b.count != 0)
                TEST_ASSERT_EQUAL_MEMORY(b.at, a.at, b.count * b.components * (b.component == 5123 ? 2 : 4));
        }
        TEST_ASSERT_EQUAL_INT(l == 1, take_array_of(&f, l, "COLOR_0").count != 0);
        TEST_ASSERT_EQUAL_INT(l != 0, take_array_of(&f, l, "TEXCOORD_0").count != 0);
        free_file(&own);
    }
    free_file(&f);
    free_levels();
}

static void test_write_levels_of_one_is_the_mesh(void)
{
    make_levels();
    for (int l = 0; l < 3; l++) {
        bvx_buffer one = write_levels(&level[l], 1), plain = write_file(&level[l], BVX_FORMAT_GLB);
        TEST_ASSERT_EQUAL_UINT64(plain.size, one.size);
        TEST_ASSERT_EQUAL_MEMORY(plain.bytes, one.bytes, (size_t)plain.size);
        bvx_buffer_free(ctx, &one);
        bvx_buffer_free(ctx, &plain);
    }
    free_levels();
}

static void test_write_levels_workers(void)
{
    bvx_mesh big[2] = {make_strip(9999), make_strip(3001)};
    bvx_context *const plain = ctx;
    bvx_buffer one = write_levels(big, 2);

    for (int way = 0; way < 2; way++) {
        bvx_context_options o = {.struct_size = sizeof o};
        o.threads = 3;
        if (way == 1) o.parallel.call = run_backwards;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
        bvx_buffer other = write_levels(big, 2);
        TEST_ASSERT_EQUAL_UINT64(one.size, other.size);
        TEST_ASSERT_EQUAL_MEMORY(one.bytes, other.bytes, (size_t)one.size);
        bvx_buffer_free(ctx, &other);
        bvx_context_destroy(ctx);
        ctx = plain;
    }
    bvx_buffer_free(ctx, &one);
    free_strip(&big[0]);
    free_strip(&big[1]);
}

/* One number, the same on every machine. */
static void test_write_levels_golden(void)
{
    make_levels();
    bvx_buffer b = write_levels(level, 3);
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x2F7FDFAEF95DBF95), bvx_hash(b.bytes, (size_t)b.size, 0));
    bvx_buffer_free(ctx, &b);
    free_levels();
}

static void check_no_levels(const bvx_mesh *levels, uint64_t count, int32_t format, bvx_status status,
                            const char *words)
{
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(status, bvx_write_mesh(ctx, levels, count, NULL, format, &b), words);
    TEST_ASSERT_TRUE(b.bytes == NULL && b.size == 0 && b.capacity == 0);
    if (strstr(bvx_last_message(ctx), words) == NULL) TEST_ASSERT_EQUAL_STRING(words, bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
}

static void test_write_levels_refuses(void)
{
    static const int32_t others[] = {BVX_FORMAT_STL, BVX_FORMAT_OBJ, BVX_FORMAT_PLY, BVX_FORMAT_OFF};
    bvx_buffer none = {0};
    uint8_t byte = 0;
    bvx_buffer full = {&byte, 1, 0};
    make_levels();
    for (size_t i = 0; i < sizeof others / sizeof others[0]; i++)
        check_no_levels(level, 3, others[i], BVX_ERR_UNSUPPORTED, "write one file a level");
    check_no_levels(level, 3, BVX_FORMAT_PNG, BVX_ERR_UNSUPPORTED, "holds no mesh");
    check_no_levels(level, 3, 99, BVX_ERR_UNSUPPORTED, "mesh");
    check_no_levels(NULL, 3, BVX_FORMAT_GLB, BVX_ERR_ARGUMENT, "levels is NULL");
    check_no_levels(level, 0, BVX_FORMAT_GLB, BVX_ERR_ARGUMENT, "level_count is 0");
    check_no_levels(level, 65537, BVX_FORMAT_GLB, BVX_ERR_RANGE, "level_count is 65537");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(ctx, level, 3, NULL, BVX_FORMAT_GLB, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(NULL, level, 3, NULL, BVX_FORMAT_GLB, &none));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(ctx, level, 3, NULL, BVX_FORMAT_GLB, &full));
    TEST_ASSERT_TRUE(full.bytes == &byte && full.size == 1);

    /* damage of one level names it */
    uint32_t const kept = level[2].triangles[4];
    level[2].triangles[4] = 5;
    check_no_levels(level, 3, BVX_FORMAT_GLB, BVX_ERR_RANGE, "bvx_write_mesh: level 2: ");
    level[2].triangles[4] = kept;
    level[1].triangle_count = 0;
    check_no_levels(level, 3, BVX_FORMAT_GLB, BVX_ERR_EMPTY, "bvx_write_mesh: level 1: ");
    level[1].triangle_count = 4;
    level[2].position_type = 9;
    check_no_levels(level, 3, BVX_FORMAT_GLB, BVX_ERR_ARGUMENT, "level 2: mesh.position_type is 9");
    level[2].position_type = BVX_F32;
    free_levels();
}

/* Each level would fit by itself; together they are too far apart for floats. */
static void test_write_levels_refuses_what_floats_cannot_hold(void)
{
    static const double at[3] = {0, -1e39, 1e39};
    double p[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0};
    uint32_t t[3] = {0, 1, 2};
    bvx_mesh far[3] = {{0}, {0}, {0}};

    for (int i = 0; i < 3; i++) {
        far[i].positions = p;
        far[i].triangles = t;
        far[i].vertex_count = 3;
        far[i].triangle_count = 1;
        far[i].position_type = BVX_F64;
        far[i].frame[1] = at[i];
        bvx_buffer b = write_file(&far[i], BVX_FORMAT_GLB);
        bvx_buffer_free(ctx, &b);
    }
    check_no_levels(far, 3, BVX_FORMAT_GLB, BVX_ERR_RANGE, "GLB: level 1: vertex 0 is");
    check_no_levels(far, 2, BVX_FORMAT_GLB, BVX_ERR_RANGE, "GLB: level 0: vertex 0 is");
}

/* Meshes that are no levels: all nodes in the scene, names escaped, a material each in linear light. */
static void test_write_levels_by_names(void)
{
    static const char *const names[3] = {"left \"lung\"", "\\\n", "\xce\xb1"};
    static const char *const texts[3] = {"\"left \\u0022lung\\u0022\"", "\"\\u005c\\u000a\"", "\"\xce\xb1\""};
    static const uint8_t shades[12] = {255, 0, 0, 255, 0, 188, 0, 51, 1, 2, 3, 255};
    bvx_write_options o = {.struct_size = sizeof o, .names = names, .colours = shades};
    bvx_buffer b = {0};

    make_levels();
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, level, 3, &o, BVX_FORMAT_GLB, &b));
    glb_file f = take_file(b);
    const char *const nodes = json_member(f.json, "nodes"), *const materials = json_member(f.json,
                                                                                           "materials");
    check_text(json_member(json_item(json_member(f.json, "scenes"), 0), "nodes"), "[0,1,2]}");
    TEST_ASSERT_NULL(json_member(f.json, "extensionsUsed"));
    for (int i = 0; i < 3; i++) {
        check_text(json_member(json_item(nodes, i), "name"), texts[i]);
        check_text(json_member(json_item(json_member(f.json, "meshes"), i), "name"), texts[i]);
        check_text(json_member(json_item(materials, i), "name"), texts[i]);
        TEST_ASSERT_NULL(json_member(json_item(nodes, i), "extensions"));
        TEST_ASSERT_EQUAL_INT(i, atoi(json_member(json_item(nodes, i), "mesh")));
        TEST_ASSERT_EQUAL_INT(i, atoi(json_member(primitive_of(&f, i, 0), "material")));
        TEST_ASSERT_EQUAL_INT(i == 1, json_member(json_item(materials, i), "alphaMode") != NULL);
    }
    const char *const factor = json_member(json_member(json_item(materials, 1), "pbrMetallicRoughness"),
                                           "baseColorFactor");
    TEST_ASSERT_TRUE(json_number_in(factor, 0) == 0);
    TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.5029, json_number_in(factor, 1));
    TEST_ASSERT_TRUE(json_number_in(factor, 3) == 0.2);
    free_file(&f);
    free_levels();
}

static void test_write_levels_names_are_for_glb(void)
{
    static const char *const names[1] = {"one"};
    bvx_write_options const o = {.struct_size = sizeof o, .names = names};
    bvx_mesh const m = octahedron(BVX_F32);
    bvx_buffer b = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_write_mesh(ctx, &m, 1, &o, BVX_FORMAT_PLY, &b));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "options.names is for GLB"));
    TEST_ASSERT_NULL(b.bytes);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_write_levels_description);
    RUN_TEST(test_write_levels_by_names);
    RUN_TEST(test_write_levels_names_are_for_glb);
    RUN_TEST(test_write_levels_coverage_never_grows);
    RUN_TEST(test_write_levels_stand_where_they_are);
    RUN_TEST(test_write_levels_have_the_arrays_of_single_files);
    RUN_TEST(test_write_levels_of_one_is_the_mesh);
    RUN_TEST(test_write_levels_workers);
    RUN_TEST(test_write_levels_golden);
    RUN_TEST(test_write_levels_refuses);
    RUN_TEST(test_write_levels_refuses_what_floats_cannot_hold);
    return UNITY_END();
}
