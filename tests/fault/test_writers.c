/* test_writers.c - every mesh writer, with normals and levels of detail too: every allocation failing once,
 * cancelled at every progress call, under every memory limit, and in an arena: meshes with colours and
 * texture coordinates. After each failure the buffer is empty, nothing is held, and the same context does the
 * work. */
#include "fault/context.h"

#include "mesh/mesh.h"

enum { SIDE = 70, VERTICES = SIDE * SIDE, TRIANGLES = (SIDE - 1) * (SIDE - 1) * 2 };

static double xyz[VERTICES * 3];
static uint32_t triangles[TRIANGLES * 3], uv_triangles[TRIANGLES * 3];
static uint8_t colours[VERTICES * 4];
static float uvs[VERTICES * 2], normals[VERTICES * 3];
static uint32_t materials[TRIANGLES];
static bvx_mesh sheet;

/* What a glTF file had beside meshes. */
static bvxi_asset_image const image = {"\"mimeType\":\"image/png\"", colours, 1001};
static struct bvx_assets const assets = {.block_bytes = sizeof assets,
                                         .materials = "[{},{}]",
                                         .textures = "[{\"source\":0}]",
                                         .material_count = 2,
                                         .image_count = 1,
                                         .images = &image};

/* A sheet in doubles, large enough for several pieces a file, with a seam along its diagonal. */
static int make_sheet(void **state)
{
    size_t n = 0;

    (void)state;
    for (uint32_t v = 0; v < VERTICES; v++) {
        uint32_t const i = v % SIDE, j = v / SIDE;
        xyz[3 * v] = i * 0.1;
        xyz[3 * v + 1] = j * 0.1;
        xyz[3 * v + 2] = 1.0 / (i + j + 1);
        uvs[2 * v] = (float)i / SIDE;
        uvs[2 * v + 1] = (float)j / SIDE;
        normals[3 * v + 2] = 1.0f;
        for (uint32_t c = 0; c < 4; c++) colours[4 * v + c] = (uint8_t)(v * (c + 3) & 255);
        if (i + 1 == SIDE || j + 1 == SIDE) continue;
        uint32_t const corners[6] = {v, v + 1, v + SIDE, v + SIDE, v + 1, v + SIDE + 1};
        for (int k = 0; k < 6; k++, n++) {
            triangles[n] = corners[k];
            uv_triangles[n] = i == j && k < 3 ? VERTICES - 1 - corners[k] : corners[k];
        }
    }
    for (uint32_t t = 0; t < TRIANGLES; t++) materials[t] = t % 3;
    sheet.positions = xyz;
    sheet.triangles = triangles;
    sheet.colours = colours;
    sheet.uvs = uvs;
    sheet.uv_triangles = uv_triangles;
    sheet.uv_count = VERTICES;
    sheet.vertex_count = sheet.vertex_capacity = VERTICES;
    sheet.triangle_count = sheet.triangle_capacity = TRIANGLES;
    sheet.position_type = BVX_F64;
    return 0;
}

typedef struct writer {
    const char *name;
    int32_t format;
    uint64_t allocations; /* at least */
    int32_t normals;
    uint64_t levels; /* 0: one mesh */
    int check;       /* what the file would hold, in doubles far from the origin */
    int asset;       /* normals, second texture coordinates, materials; quantized and turned */
} writer;

static const writer writers[] = {
    {"STL", BVX_FORMAT_STL, 1, 0, 0, 0, 0},
    {"OBJ", BVX_FORMAT_OBJ, 1, 0, 0, 0, 0},
    {"PLY", BVX_FORMAT_PLY, 1, 0, 0, 0, 0},
    {"OFF", BVX_FORMAT_OFF, 1, 0, 0, 0, 0},
    {"GLB", BVX_FORMAT_GLB, 11, 0, 0, 0, 0},
    {"3MF", BVX_FORMAT_3MF, 1, 0, 0, 0, 0},
    {"OBJ with normals", BVX_FORMAT_OBJ, 2, 1, 0, 0, 0},
    {"PLY with normals", BVX_FORMAT_PLY, 2, 1, 0, 0, 0},
    {"levels", BVX_FORMAT_GLB, 19, 0, 2, 0, 0},
    {"a check of STL", BVX_FORMAT_STL, 10, 0, 0, 1, 0},
    {"an asset", BVX_FORMAT_GLB, 12, 0, 1, 0, 1},
    {"levels of an asset", BVX_FORMAT_GLB, 20, 0, 2, 0, 1},
    {"a turned OBJ", BVX_FORMAT_OBJ, 3, 1, 0, 0, 1},
    {"a check of an asset", BVX_FORMAT_GLB, 6, 0, 0, 1, 1},
};
enum { WRITERS = sizeof writers / sizeof writers[0] };

/* One writer, and what its file must hash to once a first run has set it. */
typedef struct writing {
    const writer *of;
    uint64_t hash;
    int left_behind, other;
} writing;

static bvx_write_options const asset_options = {
    .struct_size = sizeof asset_options, .turn = BVX_TURN_Y_TO_Z, .quantize = 1};

/* The report's bytes stand for a file. */
static bvx_status check_as(const writer *w, bvx_context *ctx, bvx_buffer *file)
{
    bvx_write_options o = {.struct_size = sizeof o};
    bvx_mesh far = sheet;
    bvx_write_report report;
    bvx_status status;
    far.frame[0] = 1e6;
    if (w->asset) o = asset_options;
    o.reports = &report;
    status = bvx_write_mesh(ctx, &far, 1, &o, w->format, NULL);
    if (status != BVX_OK) return status;
    return bvx_write_mesh(ctx, &sheet, 1, NULL, report.fits ? BVX_FORMAT_PLY : w->format, file);
}

static bvx_status write_as(const writer *w, bvx_context *ctx, bvx_buffer *file)
{
    bvx_mesh levels[2] = {sheet, sheet};
    bvx_write_options o = {.struct_size = sizeof o};

    if (w->check) return check_as(w, ctx, file);
    for (int l = 0; l < 2 && w->asset; l++) {
        if (l == 0) levels[l].normals = normals;
        levels[l].uvs2 = uvs;
        levels[l].materials = materials;
        levels[l].assets = (bvx_assets *)&assets;
    }
    if (w->levels != 0)
        return bvx_write_mesh(ctx, levels, w->levels, w->asset ? &asset_options : NULL, w->format, file);
    if (!w->normals) return bvx_write_mesh(ctx, &sheet, 1, NULL, w->format, file);
    o.normals = 1;
    if (w->asset) o.turn = BVX_TURN_Z_TO_Y;
    return bvx_write_mesh(ctx, levels, 1, &o, w->format, file);
}

static bvx_status run_writing(void *user, bvx_context *ctx)
{
    writing *const w = user;
    bvx_buffer file = {0};
    bvx_status const status = write_as(w->of, ctx, &file);

    if (status == BVX_OK) {
        uint64_t const hash = bvx_hash(file.bytes, (size_t)file.size, 0);
        if (w->hash == 0) w->hash = hash;
        w->other |= hash != w->hash;
        bvx_buffer_free(ctx, &file);
    } else w->left_behind |= file.bytes != NULL || file.size != 0 || file.capacity != 0;
    return status;
}

static writing start(int i, const bvx_context_options *o)
{
    writing w = {NULL, 0, 0, 0};
    bvx_context *const ctx = context_with(o);
    w.of = &writers[i];
    assert_int_equal(run_writing(&w, ctx), BVX_OK);
    bvx_context_destroy(ctx);
    return w;
}

static void assert_writing(const writing *w, const char *wrong)
{
    if (wrong != NULL) fail_msg("%s: %s", w->of->name, wrong);
    if (w->left_behind) fail_msg("%s: a failed call left something in its buffer", w->of->name);
    if (w->other) fail_msg("%s: another file than usual", w->of->name);
}

static void test_every_allocation_of_writers_fails_once(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2)
        for (int i = 0; i < WRITERS; i++) {
            bvx_context_options o = default_options();
            uint64_t allocations = 0;
            o.threads = threads;
            writing w = start(i, &o);
            assert_writing(&w, fault_every_allocation(run_writing, &w, &o, &allocations));
            assert_true(allocations >= writers[i].allocations);
        }
}

static void test_cancel_writers_at_every_progress_call(void **state)
{
    (void)state;
    for (int i = 0; i < WRITERS; i++) {
        bvx_context_options o = default_options();
        uint64_t calls = 0;
        o.threads = 1;
        writing w = start(i, &o);
        assert_writing(&w, fault_every_cancel(run_writing, &w, &o, &calls));
        assert_true(calls >= 5);
    }
}

static void test_writers_under_every_memory_limit(void **state)
{
    bvx_context_options o = default_options();
    (void)state;
    o.threads = 1;
    for (int i = 0; i < WRITERS; i++) {
        writing w = start(i, &o);
        assert_writing(&w, fault_every_limit(run_writing, &w, &o, 100));
    }
}

static void test_writers_live_in_an_arena(void **state)
{
    enum { STEPS = 40 };
    size_t const most = (size_t)4 << 20;
    unsigned char *const memory = malloc(most);
    (void)state;
    assert_non_null(memory);
    for (int i = 0; i < WRITERS; i++) {
        bvx_context_options o = default_options();
        int good = 0;
        o.threads = 1;
        writing w = start(i, &o);
        o.arena.memory = memory;
        for (size_t n = 1; n <= STEPS; n++) {
            bvx_context *ctx;
            bvx_status first;
            o.arena.size = most / STEPS * n;
            ctx = context_with(&o);
            first = run_writing(&w, ctx);
            assert_true(first == BVX_OK || first == BVX_ERR_MEMORY);
            assert_int_equal(run_writing(&w, ctx), first);
            assert_int_equal(bvx_memory_used(ctx), 0);
            bvx_context_destroy(ctx);
            good += first == BVX_OK;
            if (n == STEPS) assert_int_equal(first, BVX_OK);
        }
        assert_true(good > 0 && good < STEPS);
        assert_writing(&w, NULL);
    }
    free(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_writers_fails_once),
        cmocka_unit_test(test_cancel_writers_at_every_progress_call),
        cmocka_unit_test(test_writers_under_every_memory_limit),
        cmocka_unit_test(test_writers_live_in_an_arena),
    };
    return cmocka_run_group_tests(tests, make_sheet, NULL);
}
