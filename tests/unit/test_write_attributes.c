/* test_write_attributes.c - what a game asset has, written to binary glTF: normals, two texture coordinates, colours, a primitive a
 * material, materials and images of another file, levels that share them; whole steps in place of floats; turned axes. GLB_FILES: a
 * folder that gets the files, for a validator. */
#include "glb_support.h"

#include "mesh/mesh.h"

#include <math.h>

enum {
    WITH_NORMALS = 8,
    WITH_SECOND_UVS = 16,
    WITH_MATERIALS = 32,
    WITH_ASSETS = 64,
    COMBINATIONS = 128,
    USED_MATERIALS = 4 /* indices 0 to 3; the assets have three, so the last stands for the default */
};

static float normals[VERTICES * 3], second_uvs[VERTICES * 2];
static uint32_t materials[TRIANGLES];

/* A PNG of one grey pixel. */
static const uint8_t png[67] = {
    0x89, 0x50, 0x4E, 0x47, 0x0D, 0x0A, 0x1A, 0x0A, 0x00, 0x00, 0x00, 0x0D, 0x49, 0x48, 0x44, 0x52, 0x00,
    0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01, 0x08, 0x00, 0x00, 0x00, 0x00, 0x3A, 0x7E, 0x9B, 0x55, 0x00,
    0x00, 0x00, 0x0A, 0x49, 0x44, 0x41, 0x54, 0x78, 0x9C, 0x63, 0x68, 0x00, 0x00, 0x00, 0x82, 0x00, 0x81,
    0x77, 0xCD, 0x72, 0xB6, 0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4E, 0x44, 0xAE, 0x42, 0x60, 0x82};

static bvxi_asset_image const images[2] = {
    {"\"mimeType\":\"image/png\"", png, sizeof png},
    {"\"name\":\"roof {]\",\"mimeType\":\"image/png\"", png, sizeof png},
};

static struct bvx_assets const assets = {
    .block_bytes = sizeof(struct bvx_assets),
    .materials =
        "[ {\"name\":\"wall\",\"pbrMetallicRoughness\":{\"baseColorTexture\":{\"index\":1}},\"doubleSided\":true}, "
        "{\"name\":\"roof\",\"extensions\":{\"KHR_materials_unlit\":{}}},\n{\"name\":\"door\"} ]",
    .textures = "[{\"source\":0,\"sampler\":0},{\"source\":1}]",
    .samplers = "[{\"wrapS\":33071}]",
    .extensions_used = "[ \"KHR_materials_unlit\" ]",
    .material_count = 3,
    .image_count = 2,
    .images = images};

static float unit_random(uint64_t *state)
{
    return (float)(next_random(state) >> 40) * (1.0f / (float)(1 << 24));
}

/* A mesh of small numbers with these attributes; every second vertex stands where the one before it does, as at a seam. */
static bvx_mesh asset_mesh(int32_t type, int with, uint64_t seed)
{
    bvx_mesh m = random_mesh(type, with & (WITH_COLOURS | WITH_UVS | WITH_CORNER_UVS), seed);
    uint64_t state = seed + 3;

    for (int v = 0; v < VERTICES; v++) {
        double n[3], length = 0.0;
        for (int a = 0; a < 3; a++) {
            int const i = v % 2 ? 3 * (v - 1) + a : 3 * v + a;
            float const own = unit_random(&state) * (a == 1 ? 7.0f : 3.0f) - 1.0f;
            xyz32[3 * v + a] = v % 2 ? xyz32[i] : own;
            xyz64[3 * v + a] = v % 2 ? xyz64[i] : (double)own * 1.1;
            n[a] = (double)unit_random(&state) - 0.5;
            length += n[a] * n[a];
        }
        for (int a = 0; a < 3; a++) normals[3 * v + a] = (float)(n[a] / sqrt(length));
        second_uvs[2 * v] = unit_random(&state);
        second_uvs[2 * v + 1] = unit_random(&state) * (seed % 2 ? 1.0f : 2.0f);
    }
    for (int i = 0; i < UVS * 2; i++) uvs[i] = unit_random(&state) * (seed % 3 == 0 ? 2.0f : 1.0f);
    for (int t = 0; t < TRIANGLES; t++) materials[t] = (uint32_t)(next_random(&state) % USED_MATERIALS);
    if (with & WITH_NORMALS) m.normals = normals;
    if (with & WITH_SECOND_UVS) m.uvs2 = second_uvs;
    if (with & WITH_MATERIALS) m.materials = materials;
    if (with & WITH_ASSETS) m.assets = (bvx_assets *)&assets;
    return m;
}

static void keep_file(const glb_file *f, const char *name, int number)
{
    const char *const folder = getenv("GLB_FILES");
    char path[512];
    FILE *file;

    if (folder == NULL) return;
    snprintf(path, sizeof path, "%s/%s_%d.glb", folder, name, number);
    file = fopen(path, "wb");
    TEST_ASSERT_NOT_NULL_MESSAGE(file, path);
    fwrite(f->bytes.bytes, 1, (size_t)f->bytes.size, file);
    fclose(file);
}

/* ---- numbers as a reader gets them ---- */

static double component(const glb_array *a, uint32_t i, uint32_t c)
{
    const uint8_t *const at = a->at + (size_t)i * a->stride;
    double const u16 = (double)(at[2 * c] | at[2 * c + 1] << 8),
                 i8 = at[c] < 128 ? at[c] : (double)at[c] - 256.0;

    if (a->component == 5126) return (double)take_f32(at + 4 * c);
    if (a->component == 5123) return a->normalized ? u16 / 65535.0 : u16;
    TEST_ASSERT_EQUAL_UINT32(5120, a->component);
    return i8 / 127.0;
}

/* Scale and translation of a node. */
static double node_scale(const glb_file *f, int i)
{
    const char *const scale = json_member(json_item(json_member(f->json, "nodes"), i), "scale");

    if (scale == NULL) return 1.0;
    TEST_ASSERT_TRUE(json_number_in(scale, 0) == json_number_in(scale, 1) &&
                     json_number_in(scale, 0) == json_number_in(scale, 2));
    return json_number_in(scale, 0);
}

/* One corner of the mesh against the vertex of the file that it became. */
static void check_corner(const bvx_mesh *m, const glb_file *f, int level, uint64_t corner, uint32_t v)
{
    glb_array const at = take_array_of(f, level, "POSITION"), normal = take_array_of(f, level, "NORMAL"),
                    uv = take_array_of(f, level, "TEXCOORD_0"), uv2 = take_array_of(f, level, "TEXCOORD_1"),
                    colour = take_array_of(f, level, "COLOR_0");
    size_t const from = m->triangles[corner];
    double const scale = node_scale(f, level), fine = at.component == 5126 ? 1e-6 : 1.0;
    double world[3], centre[3];

    world_of(m, from, world);
    node_translation(f, level, centre);
    for (uint32_t a = 0; a < 3; a++) {
        TEST_ASSERT_DOUBLE_WITHIN(fine == 1.0 ? scale * 0.5001 : fine, world[a],
                                  component(&at, v, a) * scale + centre[a]);
        if (m->normals == NULL) continue;
        if (fine != 1.0) TEST_ASSERT_TRUE(component(&normal, v, a) == (double)m->normals[3 * from + a]);
        else
            TEST_ASSERT_DOUBLE_WITHIN(0.5001 / 127, (double)m->normals[3 * from + a],
                                      component(&normal, v, a));
    }

    /* v is turned over, rounded to a float or to 16 bits. */
    if (m->uvs != NULL) {
        const float *const want = uv_of(m, corner / 3, (int)(corner % 3));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, (double)want[0], component(&uv, v, 0));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.0 - (double)want[1], component(&uv, v, 1));
    }
    if (m->uvs2 != NULL) {
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, (double)m->uvs2[2 * from], component(&uv2, v, 0));
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, 1.0 - (double)m->uvs2[2 * from + 1], component(&uv2, v, 1));
    }
    if (m->colours != NULL)
        TEST_ASSERT_DOUBLE_WITHIN(1e-9, m->colours[4 * from + 3] / 255.0, component(&colour, v, 3));
}

/* Primitives of a level: the triangles of each material in the order of the mesh, over the same vertices. */
static void check_level(const bvx_mesh *m, const glb_file *f, int level, uint32_t known)
{
    const char *const attributes = json_member(primitive_of(f, level, 0), "attributes");
    uint32_t seen = 0, count = 0;

    while (primitive_of(f, level, (int)count) != NULL) count++;
    for (uint32_t g = 0, p = 0; g <= known; g++) {
        uint32_t n = 0;
        glb_array index = {0};
        for (uint64_t t = 0; t < m->triangle_count; t++) {
            uint32_t const of = m->materials == NULL || m->materials[t] > known ? known : m->materials[t];
            if (of != g) continue;
            if (n == 0) {
                const char *const primitive = primitive_of(f, level, (int)p);
                const char *const material = json_member(primitive, "material");
                const char *const own = json_member(primitive, "attributes");
                TEST_ASSERT_EQUAL_MEMORY(attributes, own, (size_t)(json_end(own) - own));
                if (g < known) TEST_ASSERT_EQUAL_UINT32(g, (uint32_t)atoi(material));
                else TEST_ASSERT_TRUE((material != NULL) == (known == 0 && m->colours != NULL));
                index = take_array_in(f, level, (int)p++, NULL);
            }
            for (uint32_t k = 0; k < 3; k++)
                check_corner(m, f, level, t * 3 + k, index_at(&index, n * 3 + k));
            n++;
        }
        TEST_ASSERT_EQUAL_UINT32(n * 3, index.count);
        seen += index.count;
        if (g == known) TEST_ASSERT_EQUAL_UINT32(p, count);
    }
    TEST_ASSERT_EQUAL_UINT64(m->triangle_count * 3, seen);
}

static void check_text(const char *at, const char *want)
{
    TEST_ASSERT_NOT_NULL(at);
    if (strncmp(at, want, strlen(want)) != 0) TEST_ASSERT_EQUAL_STRING(want, at);
}

/* Texts and images as the assets have them. */
static void check_assets(const glb_file *f)
{
    const char *const json = strstr(f->json,
                                    assets.materials); /* with spaces, which json_member does not know */

    TEST_ASSERT_NOT_NULL(json);
    TEST_ASSERT_EQUAL_MEMORY("\"materials\":", json - 12, 12);
    json_member(f->json, "asset");
    check_text(strstr(f->json, "\"textures\":") + 11, assets.textures);
    check_text(strstr(f->json, "\"samplers\":") + 11, assets.samplers);
    for (int i = 0; i < 2; i++) {
        const char *const image = strstr(f->json, images[i].members) + strlen(images[i].members);
        const char *const views = strstr(f->json, "\"bufferViews\":") + 14;
        const char *view;
        TEST_ASSERT_EQUAL_MEMORY(",\"bufferView\":", image, 14);
        view = json_item(views, atoi(image + 14));
        TEST_ASSERT_EQUAL_UINT32(sizeof png, json_count(view, "byteLength"));
        TEST_ASSERT_EQUAL_UINT32(0, json_count(view, "byteOffset") % 4);
        TEST_ASSERT_NULL(json_member(view, "target"));
        TEST_ASSERT_EQUAL_MEMORY(png, f->binary + json_count(view, "byteOffset"), sizeof png);
        TEST_ASSERT_NULL(json_item(views, atoi(image + 14) + 2 - i));
    }
}

/* json_member and json_item read JSON without spaces or brackets in strings: a copy without the materials and images will do. */
static glb_file without_texts(const glb_file *f)
{
    glb_file copy = *f;
    char *from, *to;

    copy.json = malloc(strlen(f->json) + 1);
    strcpy(copy.json, f->json);
    for (int i = 0; i < 2; i++) {
        from = strstr(copy.json, i == 0 ? "\"materials\":[ {" : "\"images\":[");
        if (from == NULL) continue;
        to = strstr(from, i == 0 ? "\"images\":[" : "\"buffers\":[");
        memmove(from, to, strlen(to) + 1);
    }
    return copy;
}

/* ---- tests ---- */

static void test_write_glb_has_every_combination_of_attributes(void)
{
    for (int with = 0; with < COMBINATIONS; with++) {
        int32_t const type = with % 3 == 0 ? BVX_F64 : BVX_F32;
        if ((with & WITH_UVS) && (with & WITH_CORNER_UVS)) continue;
        for (int32_t quantize = 0; quantize < 2; quantize++) {
            bvx_write_options const o = {.struct_size = sizeof o, .quantize = quantize};
            bvx_mesh const m = asset_mesh(type, with, (uint64_t)with);
            glb_file f = write_glb_with(&m, &o), plain = without_texts(&f);
            /* A validator wants texture coordinates for textures. */
            if (m.uvs != NULL || m.materials == NULL) keep_file(&f, quantize ? "quantized" : "floats", with);
            /* Second ones alone stand for both, as glTF wants it. */
            TEST_ASSERT_EQUAL_INT(m.uvs != NULL || m.uvs2 != NULL,
                                  take_array(&plain, "TEXCOORD_0").count != 0);
            if (m.uvs == NULL)
                TEST_ASSERT_TRUE(take_array(&plain, "TEXCOORD_0").at == take_array(&plain, "TEXCOORD_1").at);
            TEST_ASSERT_EQUAL_INT(m.uvs2 != NULL, take_array(&plain, "TEXCOORD_1").count != 0);
            TEST_ASSERT_EQUAL_INT(m.colours != NULL, take_array(&plain, "COLOR_0").count != 0);
            check_level(&m, &plain, 0, m.assets != NULL ? 3 : 0);
            if (m.assets != NULL) check_assets(&f);
            else
                TEST_ASSERT_EQUAL_INT(m.colours != NULL,
                                      strstr(f.json, "\"materials\":[{\"pbrMetallicRoughness\"") != NULL);
            free(plain.json);
            free_file(&f);
        }
    }
}

static void test_write_glb_names_its_extensions(void)
{
    static const char *const wants[4] = {
        "\"extensionsUsed\":[\"KHR_materials_unlit\" ],\"scene\"",
        "\"extensionsUsed\":[\"KHR_mesh_quantization\",\"KHR_materials_unlit\" ],\"extensionsRequired\":[\"KHR_mesh_quantization\"],",
        "\"extensionsUsed\":[\"MSFT_lod\",\"KHR_materials_unlit\" ],\"scene\"",
        "\"extensionsUsed\":[\"MSFT_lod\",\"KHR_mesh_quantization\",\"KHR_materials_unlit\" ],\"extensionsRequired\":["};
    bvx_mesh const m = asset_mesh(BVX_F32, WITH_MATERIALS | WITH_ASSETS, 1);
    bvx_mesh two[2] = {m, m};
    struct bvx_assets own = assets;

    for (uint64_t i = 0; i < 4; i++) {
        bvx_write_options const o = {.struct_size = sizeof o, .quantize = (int32_t)(i & 1)};
        bvx_buffer b = {0};
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, two, 1 + i / 2, &o, BVX_FORMAT_GLB, &b));
        glb_file f = take_file(b);
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(f.json, wants[i]), f.json);
        free_file(&f);
    }

    /* A name stands once, empty lists do not stand at all. */
    own.extensions_used = "[\"MSFT_lod\"]";
    own.samplers = " [ ] ";
    own.textures = NULL;
    two[0].assets = two[1].assets = &own;
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, two, 2, NULL, BVX_FORMAT_GLB, &b));
    glb_file f = take_file(b);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(f.json, "\"extensionsUsed\":[\"MSFT_lod\"],\"scene\""), f.json);
    TEST_ASSERT_NULL(strstr(f.json, "samplers"));
    TEST_ASSERT_NULL(strstr(f.json, "textures"));
    free_file(&f);
    own.extensions_used = "[]";
    f = write_glb(&two[0]);
    TEST_ASSERT_NULL(strstr(f.json, "extensionsUsed"));
    free_file(&f);
}

/* An image without bytes has its members alone. */
static void test_write_glb_of_an_image_that_is_not_there(void)
{
    static const bvxi_asset_image some[3] = {
        {"\"uri\":\"gone.png\"", NULL, 0}, {NULL, png, sizeof png}, {"\"name\":\"a\"", png, sizeof png}};
    struct bvx_assets own = assets;
    bvx_mesh m = asset_mesh(BVX_F32, 0, 1);

    own.image_count = 3;
    own.images = some;
    m.assets = &own;
    glb_file f = write_glb(&m);
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(f.json,
               "\"images\":[{\"uri\":\"gone.png\"},{\"bufferView\":3},{\"name\":\"a\",\"bufferView\":4}],"),
        f.json);
    TEST_ASSERT_EQUAL_UINT32(f.binary_size - 68 + sizeof png,
                             json_count(json_item(strstr(f.json, "\"buffers\":") + 10, 0), "byteLength"));
    free_file(&f);
}

/* Materials and images once for all levels: of the source, or of the first level that has some. */
static void test_write_levels_share_materials_and_images(void)
{
    for (int way = 0; way < 4; way++) {
        bvx_mesh const source = asset_mesh(BVX_F32, WITH_ASSETS, 5);
        bvx_mesh m = asset_mesh(
            BVX_F32, way == 3 ? WITH_CORNER_UVS : WITH_MATERIALS | WITH_CORNER_UVS | WITH_NORMALS, 5);
        bvx_mesh three[3] = {m, m, m};
        bvx_write_options const o = {
            .struct_size = sizeof o, .source = way == 0 || way == 3 ? &source : NULL, .quantize = way % 2};
        bvx_buffer b = {0};

        three[1].triangle_count = TRIANGLES / 2;
        three[2].triangle_count = TRIANGLES / 5;
        if (way == 1) three[1].assets = (bvx_assets *)&assets;
        if (way == 2) three[0].assets = three[2].assets = (bvx_assets *)&assets;
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_mesh(ctx, three, 3, &o, BVX_FORMAT_GLB, &b),
                                        bvx_last_message(ctx));
        glb_file f = take_file(b), plain = without_texts(&f);
        keep_file(&f, "levels", way);
        check_assets(&f);
        TEST_ASSERT_NULL(strstr(strstr(f.json, "\"materials\":") + 1, "\"materials\":"));
        for (int l = 0; l < 3; l++) check_level(&three[l], &plain, l, 3);
        free(plain.json);
        free_file(&f);
    }
}

/* Vertices of equal positions stay at equal positions, whatever the level. */
static void test_quantized_positions_of_seams_are_equal(void)
{
    bvx_mesh const m = asset_mesh(BVX_F64, WITH_UVS | WITH_NORMALS, 8);
    bvx_mesh two[2] = {m, m};
    bvx_write_options const o = {.struct_size = sizeof o, .quantize = 1};
    bvx_buffer b = {0};

    two[0].frame[0] = two[1].frame[0] = 1e6;
    two[1].triangle_count = 40; /* smaller bounds */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, two, 2, &o, BVX_FORMAT_GLB, &b));
    glb_file f = take_file(b);
    glb_array const fine = take_array_of(&f, 0, "POSITION"), coarse = take_array_of(&f, 1, "POSITION");
    TEST_ASSERT_EQUAL_UINT32(8, fine.stride);
    for (uint32_t v = 0; v < VERTICES; v++) {
        TEST_ASSERT_EQUAL_MEMORY(fine.at + 8 * v, coarse.at + 8 * v, 8);
        TEST_ASSERT_EQUAL_MEMORY(fine.at + 8 * (v - v % 2), fine.at + 8 * v, 8);
    }
    TEST_ASSERT_TRUE(node_scale(&f, 0) == node_scale(&f, 1));
    /* The longest side takes all steps. */
    TEST_ASSERT_TRUE(json_number_in(fine.min, 1) == 0.0 && json_number_in(fine.max, 1) == 65535.0);
    free_file(&f);
}

/* A point, a mesh beyond floats, and one whose triangles are smaller than a step. */
static void test_quantized_meshes_at_the_limits(void)
{
    double p[9] = {5, 5, 5, 5, 5, 5, 5, 5, 5};
    uint32_t t[3] = {0, 1, 2};
    bvx_write_options o = {.struct_size = sizeof o, .quantize = 1, .rounding = BVX_ROUNDING_ALLOW};
    bvx_write_report r;
    bvx_buffer b = {0};
    bvx_mesh m = {0}, two[2];

    m.positions = p;
    m.triangles = t;
    m.vertex_count = 3;
    m.triangle_count = 1;
    m.position_type = BVX_F64;
    glb_file f = write_glb_with(&m, &o);
    TEST_ASSERT_TRUE(node_scale(&f, 0) == 1.0);
    free_file(&f);

    p[0] = 1e300;
    p[4] = -1.7e308;
    p[7] = 1.7e308;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_mesh(ctx, &m, 1, &o, BVX_FORMAT_GLB, &b));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "too large for steps"));

    double const small[9] = {0, 0, 0, 1, 0, 0, 0, 1, 0}, far[9] = {1e7, 0, 0, 1e7 + 1, 0, 0, 1e7, 1, 0};
    double q[9];
    memcpy(p, small, sizeof p);
    memcpy(q, far, sizeof q);
    two[0] = two[1] = m;
    two[1].positions = q;
    o.rounding = BVX_ROUNDING_REFUSE;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_mesh(ctx, two, 2, &o, BVX_FORMAT_GLB, &b));
    TEST_ASSERT_NOT_NULL_MESSAGE(
        strstr(bvx_last_message(ctx), "level 0: the format's quantized positions move vertices"),
        bvx_last_message(ctx));
    o.reports = &r;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, &o, BVX_FORMAT_GLB, NULL));
    o.reports = NULL;
    TEST_ASSERT_TRUE(r.fits && r.merged == 0 && r.largest_move <= 1.0 / 65535);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_write_mesh(ctx, &m, 1, &o, BVX_FORMAT_PLY, &b));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "options.quantize is for GLB"));
    TEST_ASSERT_TRUE(b.bytes == NULL && bvx_memory_used(ctx) == 0);
}

static void test_turns_are_exact_and_undone(void)
{
    static const int32_t formats[] = {BVX_FORMAT_STL, BVX_FORMAT_OBJ, BVX_FORMAT_PLY, BVX_FORMAT_OFF};

    for (int i = 0; i < 4; i++)
        for (int32_t type = BVX_F32; type <= BVX_F64; type++) {
            bvx_write_options o = {
                .struct_size = sizeof o, .turn = BVX_TURN_Z_TO_Y, .rounding = BVX_ROUNDING_ALLOW};
            bvx_mesh m = asset_mesh(type, 0, 9);
            bvx_mesh back = {0};
            bvx_buffer b = {0}, plain = write_rounded(&m, formats[i]);
            m.frame[1] = type == BVX_F64 ? 8.0 : 0.0;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, &o, formats[i], &b));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_mesh(ctx, b.bytes, b.size, formats[i], NULL, &back));
            for (uint32_t k = 0; k < 30; k++) {
                double p[3], q[3];
                world_of(&m, m.triangles[k], p);
                world_of(&back, back.triangles[k], q);
                for (int a = 0; a < 3; a++) {
                    double const want = a == 0 ? p[0] : a == 1 ? p[2] : -p[1];
                    TEST_ASSERT_DOUBLE_WITHIN(1e-6, want, q[a]);
                }
            }

            /* The turned mesh, turned back, is the file of the mesh. */
            bvx_buffer again = {0};
            o.turn = BVX_TURN_Y_TO_Z;
            m.frame[1] = 0.0;
            bvx_buffer_free(ctx, &b);
            if (formats[i] != BVX_FORMAT_STL && type == BVX_F64) {
                bvx_mesh_free(ctx, &back);
                o.turn = BVX_TURN_Z_TO_Y;
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, &o, formats[i], &b));
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_mesh(ctx, b.bytes, b.size, formats[i], NULL, &back));
                o.turn = BVX_TURN_Y_TO_Z;
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &back, 1, &o, formats[i], &again));
                TEST_ASSERT_EQUAL_UINT64(plain.size, again.size);
                TEST_ASSERT_EQUAL_MEMORY(plain.bytes, again.bytes, (size_t)plain.size);
                bvx_buffer_free(ctx, &b);
                bvx_buffer_free(ctx, &again);
            }
            bvx_mesh_free(ctx, &back);
            bvx_buffer_free(ctx, &plain);
        }
}

/* Normals turn too, and the certificate is of the turned mesh. */
static void test_turns_take_normals_and_certificates_along(void)
{
    bvx_mesh const m = asset_mesh(BVX_F32, WITH_NORMALS, 4);
    bvx_write_options o = {.struct_size = sizeof o, .turn = BVX_TURN_Y_TO_Z};
    bvx_write_report plain, turned;
    glb_file f = write_glb_with(&m, &o);
    glb_array const at = take_array(&f, "POSITION"), normal = take_array(&f, "NORMAL");

    for (uint32_t v = 0; v < VERTICES; v++)
        for (uint32_t a = 0; a < 3; a++) {
            float const sign = a == 1 ? -1.0f : 1.0f;
            size_t const from = 3 * (size_t)v + (a == 1 ? 2 : a == 2 ? 1 : 0);
            TEST_ASSERT_TRUE(take_f32(at.at + 12 * v + 4 * a) == sign * xyz32[from]);
            TEST_ASSERT_TRUE(take_f32(normal.at + 12 * v + 4 * a) == sign * normals[from]);
        }
    free_file(&f);

    bvx_write_options as_it_is = {.struct_size = sizeof as_it_is, .reports = &plain};
    o.reports = &turned;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, &as_it_is, BVX_FORMAT_GLB, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, &o, BVX_FORMAT_GLB, NULL));
    o.reports = NULL;
    TEST_ASSERT_TRUE(turned.file.box.low[2] == plain.file.box.low[1] &&
                     turned.file.box.low[1] == -plain.file.box.high[2]);
    o.turn = 3;
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_mesh(ctx, &m, 1, &o, BVX_FORMAT_GLB, &b));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "turn 3 is unknown"));
}

/* OBJ, PLY and GLB have the mesh's own normals; of other lengths they become 1, none at all 0, 0, 1. */
static void test_own_normals_are_written(void)
{
    static const float odd[4][3] = {{0, 3, 4}, {0, 0, 0}, {1e-30f, 0, 0}, {0, (float)INFINITY, 0}};
    static const float want[4][3] = {{0, 0.6f, 0.8f}, {0, 0, 1}, {1, 0, 0}, {0, 0, 1}};
    bvx_mesh const m = asset_mesh(BVX_F32, WITH_NORMALS, 6);
    bvx_write_options const o = {.struct_size = sizeof o, .normals = 1};
    bvx_buffer b = {0};

    memcpy(normals, odd, sizeof odd);
    glb_file f = write_glb(&m);
    glb_array const normal = take_array(&f, "NORMAL");
    for (uint32_t v = 0; v < 8; v++)
        for (uint32_t a = 0; a < 3; a++)
            TEST_ASSERT_TRUE(take_f32(normal.at + 12 * v + 4 * a) ==
                             (v < 4 ? want[v][a] : normals[3 * v + a]));
    free_file(&f);

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, &o, BVX_FORMAT_OBJ, &b));
    TEST_ASSERT_NOT_NULL(strstr((char *)b.bytes, "\nvn 0 0.6 0.8\nvn 0 0 1\nvn 1 0 0\nvn 0 0 1\nvn "));
    bvx_buffer_free(ctx, &b);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, &o, BVX_FORMAT_PLY, &b));
    const uint8_t *const rows = (uint8_t *)strstr((char *)b.bytes, "end_header\n") + 11;
    for (uint32_t k = 0; k < 3; k++)
        TEST_ASSERT_TRUE(take_f32(rows + 7 * 24 + 12 + 4 * k) == normals[21 + k]);
    bvx_buffer_free(ctx, &b);
}

static void test_second_texture_coordinates_must_be_finite(void)
{
    bvx_mesh const m = asset_mesh(BVX_F32, WITH_SECOND_UVS, 6);
    second_uvs[7] = (float)INFINITY;
    check_not_written(&m, BVX_FORMAT_GLB, BVX_ERR_RANGE, "second texture coordinate 3 is not finite");
}

static void test_write_attributes_workers(void)
{
    bvx_mesh m = make_strip(9999);
    m.materials = malloc((size_t)m.triangle_count * 4);
    for (uint32_t t = 0; t < m.triangle_count; t++) m.materials[t] = t * 7 % 5;
    m.uvs2 = m.uvs;
    m.assets = (bvx_assets *)&assets;
    check_workers_change_nothing(&m, BVX_FORMAT_GLB);
    free(m.materials);
    free_strip(&m);
}

/* One number, the same on every machine. */
static void test_write_attributes_golden(void)
{
    bvx_mesh const m = asset_mesh(BVX_F32, COMBINATIONS - 1 - WITH_UVS, 1);
    bvx_write_options const o = {.struct_size = sizeof o, .quantize = 1};
    glb_file f = write_glb_with(&m, &o);
    TEST_ASSERT_EQUAL_HEX64(UINT64_C(0x318E24CBF98F7C46), bvx_hash(f.bytes.bytes, (size_t)f.bytes.size, 0));
    free_file(&f);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_write_glb_has_every_combination_of_attributes);
    RUN_TEST(test_write_glb_names_its_extensions);
    RUN_TEST(test_write_glb_of_an_image_that_is_not_there);
    RUN_TEST(test_write_levels_share_materials_and_images);
    RUN_TEST(test_quantized_positions_of_seams_are_equal);
    RUN_TEST(test_quantized_meshes_at_the_limits);
    RUN_TEST(test_turns_are_exact_and_undone);
    RUN_TEST(test_turns_take_normals_and_certificates_along);
    RUN_TEST(test_own_normals_are_written);
    RUN_TEST(test_second_texture_coordinates_must_be_finite);
    RUN_TEST(test_write_attributes_workers);
    RUN_TEST(test_write_attributes_golden);
    return UNITY_END();
}
