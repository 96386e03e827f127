/* test_write_kept.c - levels that use a glTF file's own vertices become that file with other triangles: skins, morph
 * targets, nodes and all bytes of the buffer stay. GLB_FILES: a folder that gets the files, for a validator. */
#include "read_support.h"

enum { SIDE = 12, VERTICES = (SIDE + 1) * (SIDE + 1), FILE_ROOM = 1 << 17 };

static uint8_t bin[FILE_ROOM], file[2 * FILE_ROOM];
static char json[FILE_ROOM / 4];
static size_t bin_size, json_size, views;

/* ---- a file of two primitives of one grid, with skins and targets, and of one below a node that mirrors ---- */

static void put_json(const char *text)
{
    for (; *text != 0; text++) json[json_size++] = *text == '\'' ? '"' : *text;
}

static void put_view(size_t bytes)
{
    char text[96];

    snprintf(text, sizeof text, "%s{'buffer':0,'byteOffset':%u,'byteLength':%u}", views++ > 0 ? "," : "",
             (unsigned)bin_size, (unsigned)bytes);
    put_json(text);
    bin_size = (bin_size + bytes + 3) / 4 * 4;
}

static void put_floats(int components, int kind)
{
    for (int i = 0; i < VERTICES; i++)
        for (int c = 0; c < components; c++) {
            double const x = i % (SIDE + 1), y = i / (SIDE + 1) % (SIDE + 1);
            double const position[3] = {x, y, 0.02 * x * y};
            double const value = kind == 0   ? position[c]
                                 : kind == 1 ? (c == 0   ? y / SIDE
                                                : c == 1 ? 1 - y / SIDE
                                                         : 0)
                                             : 0.25 * (c + 1);

            put_f32(bin + bin_size + 4 * (i * components + c), (float)value, 0);
        }
    put_view((size_t)(4 * VERTICES * components));
}

/* Rows from a to b of the grid. */
static void put_indices(int a, int b)
{
    size_t n = 0;

    for (int y = a; y < b; y++)
        for (int x = 0; x < SIDE; x++) {
            int const v = y * (SIDE + 1) + x, of[6] = {v, v + 1, v + SIDE + 2, v, v + SIDE + 2, v + SIDE + 1};

            for (int k = 0; k < 6; k++, n += 2) {
                bin[bin_size + n] = (uint8_t)(of[k] & 255);
                bin[bin_size + n + 1] = (uint8_t)(of[k] >> 8);
            }
        }
    put_view(n);
}

/* twice: the second node has the mesh of the first. Returns the file's size. */
static size_t make_file(int twice)
{
    bin_size = json_size = views = 0;
    memset(bin, 0, sizeof bin);
    put_json(
        "{'asset':{'version':'2.0'},'scene':0,'scenes':[{'nodes':[0,1,3]}],'extras':{'of':['us']},"
        "'nodes':[{'mesh':0,'skin':0,'name':'body'},{'children':[2],'name':'root'},{'translation':[0,1,0]},");
    put_json(twice ? "{'mesh':0,'scale':[-1,1,1]}]," : "{'mesh':1,'scale':[-1,1,1]}],");
    put_json(
        "'skins':[{'joints':[1,2]}],'materials':[{'name':'red'},{'name':'blue'}],"
        "'animations':[{'channels':[{'sampler':0,'target':{'node':2,'path':'translation'}}],"
        "'samplers':[{'input':6,'output':7}]}],"
        "'meshes':[{'weights':[0.5],'primitives':[{'attributes':{'POSITION':0,'JOINTS_0':1,'WEIGHTS_0':2},"
        "'targets':[{'POSITION':3}],'indices':4,'material':0},{'attributes':{'POSITION':0,'JOINTS_0':1,"
        "'WEIGHTS_0':2},'targets':[{'POSITION':3}],'indices':5,'material':1}]},"
        "{'name':'mirrored','primitives':[{'attributes':{'POSITION':8},'indices':9}]}],'bufferViews':[");
    put_floats(3, 0);
    for (int i = 0; i < VERTICES; i++)
        bin[bin_size + 4 * (size_t)i + 1] = i / (SIDE + 1) % (SIDE + 1) != SIDE; /* joints with a weight */
    put_view(4 * VERTICES);
    put_floats(4, 1);
    put_floats(3, 2);
    put_indices(0, SIDE / 2);
    put_indices(SIDE / 2, SIDE);
    put_f32(bin + bin_size + 4, 1, 0);
    put_view(8);
    put_f32(bin + bin_size + 12, 1, 0);
    put_view(24);
    put_floats(3, 0);
    put_indices(0, SIDE);
    put_json(
        "],'accessors':["
        "{'bufferView':0,'componentType':5126,'count':169,'type':'VEC3','min':[0,0,0],'max':[12,12,2.88]},"
        "{'bufferView':1,'componentType':5121,'count':169,'type':'VEC4'},"
        "{'bufferView':2,'componentType':5126,'count':169,'type':'VEC4'},"
        "{'bufferView':3,'componentType':5126,'count':169,'type':'VEC3','min':[0.25,0.5,0.75],'max':[0.25,0.5,0.75]},"
        "{'bufferView':4,'componentType':5123,'count':432,'type':'SCALAR'},"
        "{'bufferView':5,'componentType':5123,'count':432,'type':'SCALAR'},"
        "{'bufferView':6,'componentType':5126,'count':2,'type':'SCALAR','min':[0],'max':[1]},"
        "{'bufferView':7,'componentType':5126,'count':2,'type':'VEC3'},"
        "{'bufferView':8,'componentType':5126,'count':169,'type':'VEC3','min':[0,0,0],'max':[12,12,2.88]},"
        "{'bufferView':9,'componentType':5123,'count':864,'type':'SCALAR'}],'buffers':[{'byteLength':");
    snprintf(json + json_size, 32, "%u}]}", (unsigned)bin_size);
    json_size += strlen(json + json_size);
    while (json_size % 4 != 0) json[json_size++] = ' ';

    put_u32(file, 0x46546c67, 0);
    put_u32(file + 4, 2, 0);
    put_u32(file + 8, (uint32_t)(28 + json_size + bin_size), 0);
    put_u32(file + 12, (uint32_t)json_size, 0);
    put_u32(file + 16, 0x4e4f534a, 0);
    memcpy(file + 20, json, json_size);
    put_u32(file + 20 + json_size, (uint32_t)bin_size, 0);
    put_u32(file + 24 + json_size, 0x004e4942, 0);
    memcpy(file + 28 + json_size, bin, bin_size);
    return 28 + json_size + bin_size;
}

static bvx_mesh read_it(int twice, int keep, uint32_t lost)
{
    bvx_read_report report;
    bvx_read_options o = {.struct_size = sizeof o};
    bvx_mesh m = {0};

    o.keep_file = keep;
    o.report = &report;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(
        BVX_OK, bvx_read_mesh(ctx, file, make_file(twice), BVX_FORMAT_GLB, &o, &m), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT32(lost, report.lost);
    return m;
}

static bvx_mesh level_of(const bvx_mesh *m, uint64_t target)
{
    bvx_simplify_options o = {.struct_size = sizeof o};
    bvx_mesh_view view;
    bvx_mesh level = {0};

    o.targets.triangles = &target;
    o.collapse.vertices = BVX_VERTICES_KEPT;
    bvx_mesh_view_of(m, &view);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_simplify(ctx, &view, &o, 1, &level),
                                    bvx_last_message(ctx));
    return level;
}

static bvx_status write_it(const bvx_mesh *level, const bvx_mesh *source, const char *name, bvx_buffer *made)
{
    const char *const folder = getenv("GLB_FILES");
    bvx_write_options o = {.struct_size = sizeof o};
    char path[512];
    FILE *to;

    o.source = source;
    memset(made, 0, sizeof *made);
    BVXI_TRY(bvx_write_mesh(ctx, level, 1, &o, BVX_FORMAT_GLB, made));
    if (folder == NULL) return BVX_OK;
    snprintf(path, sizeof path, "%s/%s.glb", folder, name);
    to = fopen(path, "wb");
    TEST_ASSERT_NOT_NULL_MESSAGE(to, path);
    fwrite(made->bytes, 1, (size_t)made->size, to);
    fclose(to);
    return BVX_OK;
}

/* 1: the file's description has this text, with ' for ". */
static int has_text(const bvx_buffer *made, const char *text)
{
    size_t const n = strlen(text);

    for (uint64_t i = 20; i + n <= made->size; i++) {
        size_t k = 0;
        while (k < n && made->bytes[i + k] == (text[k] == '\'' ? '"' : text[k])) k++;
        if (k == n) return 1;
    }
    return 0;
}

static void assert_buffer_stays(const bvx_buffer *made)
{
    const uint8_t *const p = made->bytes + 12;
    uint32_t const size = (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16;

    TEST_ASSERT_EQUAL_MEMORY(bin, made->bytes + 20 + size + 8, bin_size);
}

/* All triangles of the level with their materials, and more without area. */
static void assert_triangles(const bvx_buffer *made, const bvx_mesh *level, const bvx_mesh *source,
                             uint64_t more)
{
    bvx_mesh back = {0};

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK,
                                    bvx_read_mesh(ctx, made->bytes, made->size, BVX_FORMAT_GLB, NULL, &back),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(source->vertex_count, back.vertex_count);
    TEST_ASSERT_EQUAL_MEMORY(source->positions, back.positions, (size_t)source->vertex_count * 12);
    TEST_ASSERT_EQUAL_UINT64(level->triangle_count + more, back.triangle_count);
    for (uint64_t t = 0; t < level->triangle_count; t++) {
        uint64_t i = 0;

        while (i < back.triangle_count &&
               (memcmp(back.triangles + 3 * i, level->triangles + 3 * t, 12) != 0 ||
                back.materials[i] != level->materials[t]))
            i++;
        TEST_ASSERT_TRUE_MESSAGE(i < back.triangle_count, "a triangle is not there");
    }
    bvx_mesh_free(ctx, &back);
}

static void test_a_level_is_the_file_with_other_triangles(void)
{
    bvx_mesh m = read_it(0, 1, 0);
    bvx_mesh level = level_of(&m, 300);
    bvx_buffer made;

    TEST_ASSERT_TRUE(level.triangle_count <= 300 && level.vertex_count == 2 * VERTICES);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, write_it(&level, &m, "kept", &made), bvx_last_message(ctx));
    assert_buffer_stays(&made);
    assert_triangles(&made, &level, &m, 0);
    TEST_ASSERT_TRUE(has_text(&made, "'skins':[{'joints':[1,2]}]"));
    TEST_ASSERT_TRUE(
        has_text(&made, "'nodes':[{'mesh':0,'skin':0,'name':'body'},{'children':[2],'name':'root'},"));
    TEST_ASSERT_TRUE(
        has_text(&made, "'attributes':{'POSITION':0,'JOINTS_0':1,'WEIGHTS_0':2},'targets':[{'POSITION':3}]"));
    TEST_ASSERT_TRUE(has_text(&made, "'extras':{'of':['us']}") && has_text(&made, "'weights':[0.5]"));

    bvx_buffer_free(ctx, &made);
    bvx_mesh_free(ctx, &level);
    bvx_mesh_free(ctx, &m);
}

/* A primitive that has lost all triangles has one without area; triangles of two meshes are refused. */
static void test_triangles_go_back_to_their_primitives(void)
{
    bvx_mesh m = read_it(0, 1, 0), level = m;
    uint32_t triangles[6] = {0, 1, SIDE + 2, SIDE + 1, 0, SIDE + 2}, materials[2] = {1, 1};
    bvx_buffer made;

    level.triangles = triangles;
    level.materials = materials;
    level.triangle_count = level.triangle_capacity = 2;
    level.assets = NULL;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, write_it(&level, &m, "kept_some", &made), bvx_last_message(ctx));
    assert_buffer_stays(&made);
    assert_triangles(&made, &level, &m, 2);
    bvx_buffer_free(ctx, &made);

    triangles[4] = VERTICES;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, write_it(&level, &m, "", &made));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "triangle 1 has vertices of two primitives"));
    TEST_ASSERT_NULL(made.bytes);
    bvx_mesh_free(ctx, &m);
}

/* What cannot be kept, or is not wanted, is said as before, and the level is a mesh alone. */
static void test_what_is_not_kept_is_lost(void)
{
    uint32_t const all = BVX_LOST_SKINS | BVX_LOST_MORPHS | BVX_LOST_ANIMATIONS;

    for (int twice = 0; twice < 2; twice++) {
        bvx_mesh m = read_it(twice, twice, all);
        bvx_mesh level = level_of(&m, 300);
        bvx_buffer made;

        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, write_it(&level, &m, twice ? "twice" : "lost", &made),
                                        bvx_last_message(ctx));
        TEST_ASSERT_FALSE(has_text(&made, "'skins'"));
        bvx_buffer_free(ctx, &made);
        bvx_mesh_free(ctx, &level);
        bvx_mesh_free(ctx, &m);
    }
}

/* Two vertices that are equal but for what is not read stay two. */
static void test_kept_vertices_are_not_joined(void)
{
    static float positions[2 * 3 * VERTICES];
    static uint32_t triangles[6 * SIDE * SIDE];
    uint64_t target = 100, n = 0;
    bvx_simplify_options o = {.struct_size = sizeof o};
    bvx_mesh level = {0};

    for (int i = 0; i < 2 * VERTICES; i++) {
        positions[3 * i] = (float)(i % (SIDE + 1));
        positions[3 * i + 1] = (float)(i / (SIDE + 1) % (SIDE + 1));
    }
    for (int y = 0; y < SIDE; y++)
        for (int x = 0; x < SIDE; x++) {
            /* The upper half has vertices of its own in the middle. */
            uint32_t const v = (uint32_t)(y * (SIDE + 1) + x + (y < SIDE / 2 ? 0 : VERTICES));
            uint32_t const of[6] = {v, v + 1, v + SIDE + 2, v, v + SIDE + 2, v + SIDE + 1};

            for (int k = 0; k < 6; k++) triangles[n++] = of[k];
        }
    o.targets.triangles = &target;
    o.collapse.vertices = BVX_VERTICES_KEPT;
    bvx_mesh_view const view = bvx_mesh_view_packed(positions, 2 * VERTICES, triangles, n / 3);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_mesh_simplify(ctx, &view, &o, 1, &level),
                                    bvx_last_message(ctx));
    for (uint64_t t = 0; t < level.triangle_count; t++)
        for (int k = 1; k < 3; k++)
            TEST_ASSERT_TRUE((level.triangles[3 * t] < VERTICES) ==
                             (level.triangles[3 * t + (uint64_t)k] < VERTICES));
    bvx_mesh_free(ctx, &level);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_level_is_the_file_with_other_triangles);
    RUN_TEST(test_triangles_go_back_to_their_primitives);
    RUN_TEST(test_what_is_not_kept_is_lost);
    RUN_TEST(test_kept_vertices_are_not_joined);
    return UNITY_END();
}
