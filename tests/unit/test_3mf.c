/* test_3mf.c - 3MF in and out: bodies with their matrices, units, mirrors, packed and not; the same mesh back; and
 * what strangers send: bombs, cycles, names outside, types of documents, damage at every byte. */
#include "read_support.h"
#include "tools/mesh_maker.h"

#include <math.h>

enum { MF = BVX_FORMAT_3MF };

static uint8_t zip[6000000];
static size_t zip_size;

/* Tetrahedra with corners at 0 and at 1 along each axis. */
#define MESH                                                                                     \
    "<mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1\" y=\"0\" z=\"0\"/>"         \
    "<vertex x=\"0\" y=\"1\" z=\"0\"/><vertex x=\"0\" y=\"0\" z=\"1e0\"/></vertices><triangles>" \
    "<triangle v1=\"0\" v2=\"2\" v3=\"1\"/><triangle v1=\"0\" v2=\"1\" v3=\"3\"/>"               \
    "<triangle v1=\"1\" v2=\"2\" v3=\"3\"/><triangle v1=\"2\" v2=\"0\" v3=\"3\"/></triangles></mesh>"
#define MODEL(unit, objects, items)                                                                   \
    "<?xml version=\"1.0\"?><model unit=\"" unit "\"><resources>" objects "</resources><build>" items \
    "</build></model>"
#define BODY "<object id=\"4\">" MESH "</object>"

static uint32_t sum_of(const uint8_t *p, size_t n)
{
    uint32_t c = UINT32_MAX;
    for (size_t i = 0; i < n; i++) {
        c ^= p[i];
        for (int k = 0; k < 8; k++) c = c >> 1 ^ (c & 1 ? UINT32_C(0xedb88320) : 0);
    }
    return c ^ UINT32_MAX;
}

static void put(uint32_t value, int bytes)
{
    for (int i = 0; i < bytes; i++) zip[zip_size++] = (uint8_t)(value >> 8 * i & 255);
}

static void put_bytes(const void *bytes, size_t n)
{
    memcpy(zip + zip_size, bytes, n);
    zip_size += n;
}

/* A container of these parts; packed: as a block of deflate that packs nothing. plain: the size that is stated, or 0. */
static void make_parts(int parts, const char *const *name, const char *const *text, int packed,
                       uint32_t plain)
{
    uint32_t at[4], directory = 0;

    zip_size = 0;
    for (int i = 0; i < 2 * parts; i++) {
        int const k = i % parts, local = i < parts;
        size_t const n = strlen(text[k]), held = n + (packed ? 5 : 0);

        TEST_ASSERT_TRUE(zip_size + n + 200 < sizeof zip && (n < 65536 || !packed));
        if (local) at[k] = (uint32_t)zip_size;
        else if (k == 0) directory = (uint32_t)zip_size;
        put(local ? 0x04034b50 : 0x02014b50, 4);
        put(20, local ? 2 : 4), put(0, 2), put(packed ? 8 : 0, 2), put(0, 4);
        put(sum_of((const uint8_t *)text[k], n), 4), put((uint32_t)held, 4);
        put(plain ? plain : (uint32_t)n, 4), put((uint32_t)strlen(name[k]), 2), put(0, local ? 2 : 12);
        if (!local) put(at[k], 4);
        put_bytes(name[k], strlen(name[k]));
        if (!local) continue;
        if (packed) put(1, 1), put((uint32_t)n, 2), put(~(uint32_t)n & 0xffff, 2);
        put_bytes(text[k], n);
    }
    put(0x06054b50, 4), put(0, 4), put((uint32_t)parts, 2), put((uint32_t)parts, 2);
    put((uint32_t)zip_size - 12 - directory, 4), put(directory, 4), put(0, 2);
}

static void make_zip(const char *name, const char *text, int packed, uint32_t plain)
{
    make_parts(1, &name, &text, packed, plain);
}

static void make_model(const char *text)
{
    make_zip("3D/3dmodel.model", text, 0, 0);
}

static bvx_mesh read_model(const char *text)
{
    bvx_mesh m;
    make_model(text);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(zip, zip_size, MF, &m), bvx_last_message(ctx));
    return m;
}

static void refuse_model(const char *text, bvx_status status, const char *words)
{
    make_model(text);
    check_refused(zip, zip_size, MF, status, words);
}

static bvx_certificate certificate_of(const bvx_mesh *m)
{
    bvx_mesh_view view;
    bvx_certificate c;
    bvx_mesh_view_of(m, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 0, &c));
    return c;
}

/* ---- What is read ---- */

static void test_3mf_items_stand_where_their_matrices_say(void)
{
    bvx_mesh m = read_model(
        MODEL("centimeter", BODY,
              "<item objectid=\"4\"/><item objectid=\"4\" transform=\"2 0 0 0 2 0 0 0 2 5 6 7\"/>"
              "<item objectid=\"4\" transform=\"1 0 0 0 1 0 0 0 -1 0 0 -3\"/>"));
    bvx_certificate const c = certificate_of(&m);
    TEST_ASSERT_EQUAL_UINT64(12, m.triangle_count);
    TEST_ASSERT_EQUAL_UINT64(3, c.components);
    TEST_ASSERT_TRUE(c.closed && c.oriented);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, (1 + 8 + 1) * 1000.0 / 6, c.volume); /* a mirror is outside out too */
    TEST_ASSERT_DOUBLE_WITHIN(0, 70, c.box.high[0]);
    TEST_ASSERT_DOUBLE_WITHIN(0, -40, c.box.low[2]);
    bvx_mesh_free(ctx, &m);
}

static void test_3mf_components_of_components(void)
{
    bvx_mesh m = read_model(MODEL(
        "inch",
        BODY "<object id=\"2\"><components><component objectid=\"4\" transform=\"1 0 0 0 1 0 0 0 1 10 0 0\"/>"
             "<component objectid=\"4\"/></components></object>"
             "<object id=\"9\"><components><component objectid=\"2\" transform=\"0 1 0 -1 0 0 0 0 1 0 0 0\"/>"
             "</components></object>",
        "<item objectid=\"9\" transform=\"1 0 0 0 1 0 0 0 1 0 0 1\"/>"));
    bvx_certificate const c = certificate_of(&m);
    TEST_ASSERT_EQUAL_UINT64(8, m.triangle_count);
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 11 * 25.4, c.box.high[1]); /* turned to y, then lifted */
    TEST_ASSERT_DOUBLE_WITHIN(1e-9, 25.4, c.box.low[2]);
    bvx_mesh_free(ctx, &m);
}

/* A bvx_inflate_fn for gzip whose only block packs nothing. */
static int32_t unpack_nothing(void *user, const void *packed, uint64_t size, void *plain, uint64_t plain_size)
{
    const uint8_t *const p = packed;
    uint32_t foot[2];

    ++*(int *)user;
    TEST_ASSERT_TRUE(size >= 23 && p[0] == 0x1f && p[1] == 0x8b && p[2] == 8 && p[3] == 0);
    if (size != plain_size + 23) return 1;
    memcpy(plain, p + 15, (size_t)plain_size);
    foot[0] = sum_of(plain, (size_t)plain_size);
    foot[1] = (uint32_t)plain_size;
    for (int i = 0; i < 8; i++)
        if (p[size - 8 + (uint64_t)i] != (foot[i / 4] >> 8 * (i % 4) & 255)) return 1;
    return 0;
}

static void test_3mf_is_unpacked_by_the_caller(void)
{
    static const char text[] = MODEL("millimeter", BODY, "<item objectid=\"4\"/>");
    int calls = 0;
    bvx_read_options const o = {.struct_size = sizeof o, .inflate = unpack_nothing, .inflate_user = &calls};
    bvx_mesh m = {0};

    make_zip("3D/3dmodel.model", text, 1, 0);
    check_refused(zip, zip_size, MF, BVX_ERR_UNSUPPORTED, "inflate");
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_read_mesh(ctx, zip, zip_size, MF, &o, &m),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT(1, calls);
    TEST_ASSERT_EQUAL_UINT64(4, m.triangle_count);
    bvx_mesh_free(ctx, &m);
    zip[60]++; /* within the text */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, bvx_read_mesh(ctx, zip, zip_size, MF, &o, &m));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "damaged"));
    /* A bomb is refused before it is unpacked. */
    make_zip("3D/3dmodel.model", text, 1, 128 * (uint32_t)zip_size + 1);
    check_refused(zip, zip_size, MF, BVX_ERR_RANGE, "128 times");
}

#define COLOURS                                                                                               \
    "<basematerials id=\"7\"><base name=\"PLA\" displaycolor=\"#FF0000\"/><base displaycolor=\"#00ff0080\"/>" \
    "</basematerials><m:colorgroup id=\"8\"><m:color color=\"#0000FF\"/></m:colorgroup>"
#define LABELLED(id, of, rest)                                                                               \
    "<object id=\"" id "\" " of                                                                              \
    "><mesh><vertices><vertex x=\"0\" y=\"0\" z=\"0\"/><vertex x=\"1000\" y=\"0\" "                          \
    "z=\"0\"/><vertex x=\"0\" y=\"1\" z=\"0\"/></vertices><triangles><triangle v1=\"0\" v2=\"1\" v3=\"2\"/>" \
    "<triangle v1=\"0\" v2=\"2\" v3=\"1\" " rest "/></triangles></mesh></object>"

static void labels_of(const char *resources, const char *items, uint32_t *lost, bvx_mesh *m)
{
    bvx_read_report report = {0};
    bvx_read_options const o = {.struct_size = sizeof o, .report = &report};
    char text[4000];

    snprintf(text, sizeof text, "<model unit=\"micron\"><resources>%s</resources><build>%s</build></model>",
             resources, items);
    make_model(text);
    memset(m, 0, sizeof *m);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_read_mesh(ctx, zip, zip_size, MF, &o, m),
                                    bvx_last_message(ctx));
    TEST_ASSERT_DOUBLE_WITHIN(0, 1, ((const double *)m->positions)[3]);
    *lost = report.lost;
}

static void test_3mf_materials_and_colours_are_labels(void)
{
    static const uint32_t wanted[] = {1, 0, 3, 2};
    bvx_buffer glb = {0};
    uint32_t lost;
    bvx_mesh m;

    labels_of(COLOURS LABELLED("1", "pid=\"7\" pindex=\"1\"", "p1=\"0\"")
                  LABELLED("2", "", "pid=\"8\" p1=\"0\""),
              "<item objectid=\"1\"/><item objectid=\"2\"/>", &lost, &m);
    TEST_ASSERT_EQUAL_UINT32(0, lost);
    TEST_ASSERT_EQUAL_UINT64(4, m.triangle_count);
    TEST_ASSERT_EQUAL_UINT32_ARRAY(wanted, m.materials, 4);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, NULL, BVX_FORMAT_GLB, &glb));
    bvx_mesh_free(ctx, &m);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_read_mesh(ctx, glb.bytes, glb.size, BVX_FORMAT_GLB, NULL, &m),
                                    bvx_last_message(ctx));
    TEST_ASSERT_NOT_NULL(strstr((const char *)glb.bytes + 20,
                                "{\"name\":\"PLA\",\"pbrMetallicRoughness\":"
                                "{\"metallicFactor\":0,\"baseColorFactor\":[1,0,0,1]"));
    bvx_mesh_free(ctx, &m);
    bvx_buffer_free(ctx, &glb);
}

static void test_3mf_reports_colours_that_no_label_holds(void)
{
    uint32_t lost;
    bvx_mesh m;

    /* A gradient has the label of its first corner, texture coordinates have none. */
    labels_of(COLOURS LABELLED("1", "", "pid=\"7\" p1=\"1\" p2=\"0\" p3=\"1\""), "<item objectid=\"1\"/>",
              &lost, &m);
    TEST_ASSERT_EQUAL_UINT32(BVX_LOST_ATTRIBUTES, lost);
    TEST_ASSERT_EQUAL_UINT32(1, m.materials[1]);
    bvx_mesh_free(ctx, &m);
    labels_of(LABELLED("1", "", "pid=\"9\" p1=\"1\""), "<item objectid=\"1\"/>", &lost, &m);
    TEST_ASSERT_EQUAL_UINT32(BVX_LOST_ATTRIBUTES, lost);
    TEST_ASSERT_NULL(m.materials);
    bvx_mesh_free(ctx, &m);
}

/* As slicers save their projects. */
static void test_3mf_objects_of_other_parts(void)
{
    static const char *const names[2] = {"3D/3dmodel.model", "3D/Objects/a.model"};
    const char *texts[2] = {
        "<model requiredextensions=\"p\"><resources><object id=\"1\"><components><component p:path=\"/3D/Objects/a.model\" "
        "objectid=\"4\" transform=\"3 0 0 0 1 0 0 0 1 0 0 0\"/></components></object></resources><build>"
        "<item objectid=\"1\"/></build></model>",
        MODEL("millimeter", BODY, "<item objectid=\"4\"/>")};
    bvx_mesh m;

    make_parts(2, names, texts, 0, 0);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(zip, zip_size, MF, &m), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(4, m.triangle_count);
    TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.5, certificate_of(&m).volume);
    bvx_mesh_free(ctx, &m);
    make_parts(1, names, texts, 0, 0);
    check_refused(zip, zip_size, MF, BVX_ERR_FORMAT, "not there");

    /* Names of one size and another; of two models with one name the first counts. */
    static const char *const more[4] = {"3D/3dmodel.model", "3D/Objects/b.model", "3D/Objects/a.model",
                                        "3D/Objects/a.model"};
    const char *const more_texts[4] = {texts[0], "<model/>", texts[1], "<model/>"};
    make_parts(4, more, more_texts, 0, 0);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_file(zip, zip_size, MF, &m), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(4, m.triangle_count);
    bvx_mesh_free(ctx, &m);
}

/* ---- What strangers send ---- */

static void test_3mf_refuses_what_is_no_model(void)
{
#define PART(transform) MODEL("millimeter", BODY, "<item objectid=\"4\" transform=\"" transform "\"/>")
    refuse_model(MODEL("millimeter", BODY, ""), BVX_ERR_EMPTY, "no item");
    refuse_model(MODEL("cubit", BODY, ""), BVX_ERR_FORMAT, "unit");
    refuse_model(MODEL("millimeter", BODY, "<item objectid=\"5\"/>"), BVX_ERR_FORMAT,
                 "not before this place");
    refuse_model(PART("1 0 0 0 1 0 0 0 nan 0 0 0"), BVX_ERR_RANGE, "not finite");
    refuse_model(PART("1 0 0 0 1 0 0 0 1 0 0"), BVX_ERR_FORMAT, "a number");
    refuse_model(PART("1 0 0 0 1 0 0 0 1 0 0 0 0"), BVX_ERR_FORMAT, "the end of the value");
    refuse_model(PART("1e308 0 0 0 1 0 0 0 1 1e308 0 0"), BVX_ERR_RANGE, "vertex 1");
    refuse_model(MODEL("millimeter",
                       "<object id=\"1\"><mesh><vertices/><triangles><triangle v1=\"0\" v2=\"0\" v3=\"0\"/>"
                       "</triangles></mesh></object>",
                       ""),
                 BVX_ERR_RANGE, "out of range");
    /* An object in itself, and two in each other. */
    refuse_model(MODEL("millimeter",
                       "<object id=\"1\"><components><component objectid=\"1\"/></components></object>", ""),
                 BVX_ERR_FORMAT, "not before this place");
    refuse_model(MODEL("millimeter\" requiredextensions=\"p b", BODY, "<item objectid=\"4\"/>"),
                 BVX_ERR_UNSUPPORTED, "extension");
    refuse_model("<model><build><item objectid=\"4\"/></build></model>", BVX_ERR_FORMAT, "not before");
    refuse_model("<!DOCTYPE m [<!ENTITY a \"aa\">]>" MODEL("millimeter", BODY, "<item objectid=\"4\"/>"),
                 BVX_ERR_FORMAT, "elements and comments only");
    refuse_model("<model><resources>", BVX_ERR_FORMAT, "closing tag");
}

/* Each object twice the one before: 2^60 bodies of a file of 10 KiB; and as many of nothing. */
static void test_3mf_repeats_only_what_its_size_allows(void)
{
    for (int empty = 0; empty < 2; empty++) {
        char text[12000];
        size_t n = (size_t)snprintf(text, sizeof text, "<model><resources>%s",
                                    empty ? "<object id=\"4\"><mesh/></object>" : BODY);
        for (int i = 5; i < 64; i++)
            n += (size_t)snprintf(text + n, sizeof text - n,
                                  "<object id=\"%d\"><components><component objectid=\"%d\"/><component "
                                  "objectid=\"%d\"/></components></object>",
                                  i, i - 1, i - 1);
        snprintf(text + n, sizeof text - n, "</resources><build><item objectid=\"63\"/></build></model>");
        refuse_model(text, empty ? BVX_ERR_EMPTY : BVX_ERR_RANGE, empty ? "no item" : "repeated");
    }
}

/* As many objects as are taken, each item but the last one naming the first: a search through all of them would
 * be seen by who waits. */
static void test_3mf_items_find_their_objects_among_many(void)
{
    enum { OBJECTS = 16383, ITEMS = 90000 };
    static char text[2800000];
    bvx_mesh m;
    size_t n = (size_t)snprintf(text, sizeof text, "<model><resources>");

    for (int i = 0; i < OBJECTS; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "<object id=\"%d\"/>", 20000 - i);
    n += (size_t)snprintf(text + n, sizeof text - n, BODY "</resources><build>");
    for (int i = 0; i < ITEMS; i++)
        n += (size_t)snprintf(text + n, sizeof text - n, "<item objectid=\"20000\"/>");
    TEST_ASSERT_TRUE(n < sizeof text - 100);
    snprintf(text + n, sizeof text - n, "<item objectid=\"4\"/></build></model>");
    m = read_model(text);
    TEST_ASSERT_EQUAL_UINT64(4, m.triangle_count);
    bvx_mesh_free(ctx, &m);
}

static void test_3mf_components_nest_without_end(void)
{
    char text[12000];
    bvx_mesh m;
    size_t n = (size_t)snprintf(text, sizeof text, "<model><resources>%s", BODY);

    for (int i = 5; i < 80; i++)
        n += (size_t)snprintf(
            text + n, sizeof text - n,
            "<object id=\"%d\"><components><component objectid=\"%d\"/></components></object>", i, i - 1);
    snprintf(text + n, sizeof text - n, "</resources><build><item objectid=\"79\"/></build></model>");
    m = read_model(text);
    TEST_ASSERT_EQUAL_UINT64(4, m.triangle_count);
    bvx_mesh_free(ctx, &m);
}

static void test_3mf_refuses_damaged_containers(void)
{
    static const char text[] = MODEL("millimeter", BODY, "<item objectid=\"4\"/>");

    make_zip("/3D/3dmodel.model", text, 0, 0);
    check_refused(zip, zip_size, MF, BVX_ERR_FORMAT, "outside");
    make_zip("a/../../x", text, 0, 0);
    check_refused(zip, zip_size, MF, BVX_ERR_FORMAT, "outside");
    make_zip("3D/other.model", text, 0, 0);
    check_refused(zip, zip_size, MF, BVX_ERR_FORMAT, "no part");
    make_zip("3D/3dmodel.model", text, 0, 7);
    check_refused(zip, zip_size, MF, BVX_ERR_FORMAT, "two sizes");
    make_zip("3D/3dmodel.model", text, 0, 0);
    zip[8] = zip[zip_size - 22 - 46 - 16 + 8] = 1; /* encrypted */
    check_refused(zip, zip_size, MF, BVX_ERR_UNSUPPORTED, "encrypted");
    make_model(text);
    zip[100] ^= 1;
    check_refused(zip, zip_size, MF, BVX_ERR_FORMAT, "damaged");
    make_model(text);
    TEST_ASSERT_EQUAL_INT(1, check_every_prefix(zip, zip_size, MF, 4));
    for (size_t i = 0; i < zip_size; i++) {
        bvx_mesh m;
        uint8_t const was = zip[i];
        zip[i] = (uint8_t)(was ^ 0xff);
        if (read_file(zip, zip_size, MF, &m) == BVX_OK) bvx_mesh_free(ctx, &m);
        zip[i] = was;
    }
}

/* ---- What is written ---- */

static void test_3mf_written_is_the_same_mesh(void)
{
    double const centre[3] = {1.1, -2.3, 1e5}, radius[3] = {3, 2, 1};
    uint64_t seed = 3;
    maker_mesh made = {0};

    maker_star(&made, &seed, centre, radius, 0.2, 9, 11, 1 << 20);
    for (int f32 = 0; f32 < 2; f32++) {
        bvx_mesh m = {.positions = made.p, .triangles = made.t, .vertex_count = made.vertices};
        bvx_mesh back = {0};
        bvx_buffer file = {0}, again = {0};
        float narrow[3 * 200];

        TEST_ASSERT_TRUE(made.vertices <= 200);
        for (size_t i = 0; i < 3 * made.vertices; i++) narrow[i] = (float)made.p[i];
        if (f32) m.positions = narrow;
        m.triangle_count = made.triangles;
        m.position_type = f32 ? BVX_F32 : BVX_F64;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, NULL, MF, &file));
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_read_mesh(ctx, file.bytes, file.size, MF, NULL, &back),
                                        bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_UINT64(made.vertices, back.vertex_count);
        TEST_ASSERT_EQUAL_MEMORY(made.t, back.triangles, made.triangles * 12);
        for (size_t i = 0; i < 3 * made.vertices; i++) {
            double const p = ((const double *)back.positions)[i];
            TEST_ASSERT_TRUE(f32 ? (float)p == narrow[i] : p == made.p[i]);
        }
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_mesh(ctx, &m, 1, NULL, MF, &again));
        TEST_ASSERT_EQUAL_UINT64(file.size, again.size);
        TEST_ASSERT_EQUAL_MEMORY(file.bytes, again.bytes, (size_t)file.size);
        bvx_mesh_free(ctx, &back);
        bvx_buffer_free(ctx, &file);
        bvx_buffer_free(ctx, &again);
    }
    maker_free(&made);
}

static bvx_status read_and_write(void *user, bvx_context *context)
{
    bvx_mesh m = {0};
    bvx_buffer file = {0};
    bvx_status status = bvx_read_mesh(context, zip, zip_size, MF, NULL, &m);

    (void)user;
    if (status == BVX_OK) status = bvx_write_mesh(context, &m, 1, NULL, MF, &file);
    bvx_mesh_free(context, &m);
    bvx_buffer_free(context, &file);
    return status;
}

static void test_3mf_when_memory_fails_or_it_is_cancelled(void)
{
    bvx_context_options const one_thread = suite_options(1, 0);
    uint64_t allocations = 0, calls = 0;

    make_model(MODEL("millimeter", BODY, "<item objectid=\"4\"/>"));
    TEST_ASSERT_NULL(fault_every_allocation(read_and_write, NULL, &one_thread, &allocations));
    TEST_ASSERT_TRUE(allocations >= 7);
    TEST_ASSERT_NULL(fault_every_cancel(read_and_write, NULL, &one_thread, &calls));
    TEST_ASSERT_TRUE(calls >= 2);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_3mf_items_stand_where_their_matrices_say);
    RUN_TEST(test_3mf_components_of_components);
    RUN_TEST(test_3mf_is_unpacked_by_the_caller);
    RUN_TEST(test_3mf_materials_and_colours_are_labels);
    RUN_TEST(test_3mf_reports_colours_that_no_label_holds);
    RUN_TEST(test_3mf_objects_of_other_parts);
    RUN_TEST(test_3mf_refuses_what_is_no_model);
    RUN_TEST(test_3mf_repeats_only_what_its_size_allows);
    RUN_TEST(test_3mf_items_find_their_objects_among_many);
    RUN_TEST(test_3mf_components_nest_without_end);
    RUN_TEST(test_3mf_refuses_damaged_containers);
    RUN_TEST(test_3mf_written_is_the_same_mesh);
    RUN_TEST(test_3mf_when_memory_fails_or_it_is_cancelled);
    return UNITY_END();
}
