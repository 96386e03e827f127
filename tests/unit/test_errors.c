/* test_errors.c - bvx_last_error: status, reason, function, index and
 * values of failures, which nobody has to read out of messages. */
#include "suite.h"

#include "bitvox_io.h"

#include <math.h>
#include <string.h>

static const bvx_error *error;

void setUp(void)
{
    suite_open(0);
    error = bvx_last_error(ctx);
}

void tearDown(void)
{
    suite_close();
}

static void failed(bvx_status expected, bvx_status status, int32_t reason, const char *function)
{
    error = bvx_last_error(ctx);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected, status, bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32(status, error->status);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(reason, error->reason, error->message);
    TEST_ASSERT_EQUAL_STRING(function, error->function);
    TEST_ASSERT_EQUAL_STRING(bvx_last_message(ctx), error->message);
}

static void test_reasons_have_their_numbers_and_texts(void)
{
    static const int32_t numbers[] = {
#define NUMBER(name, value, text) value,
        BVX_REASON_LIST(NUMBER)
#undef NUMBER
    };
    static const char *const texts[] = {
#define TEXT(name, value, text) text,
        BVX_REASON_LIST(TEXT)
#undef TEXT
    };

    TEST_ASSERT_EQUAL_INT(BVX_REASON_COUNT, sizeof numbers / sizeof numbers[0]);
    for (int32_t i = 0; i < BVX_REASON_COUNT; i++) {
        TEST_ASSERT_EQUAL_INT32(i, numbers[i]);
        for (int32_t k = 0; k < i; k++) TEST_ASSERT_TRUE(strcmp(texts[i], texts[k]) != 0);
    }
}

static void test_before_any_failure(void)
{
    TEST_ASSERT_EQUAL_INT32(BVX_OK, error->status);
    TEST_ASSERT_EQUAL_INT32(BVX_REASON_NONE, error->reason);
    TEST_ASSERT_EQUAL_INT64(-1, error->index);
    TEST_ASSERT_EQUAL_INT32(0, error->value_count);
    TEST_ASSERT_EQUAL_STRING("", error->function);
    TEST_ASSERT_EQUAL_STRING("", error->message);
    TEST_ASSERT_EQUAL_STRING("", error->text);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_last_error(NULL)->status);
    TEST_ASSERT_EQUAL_INT32(BVX_REASON_NULL, bvx_last_error(NULL)->reason);
    TEST_ASSERT_EQUAL_STRING(bvx_last_message(NULL), bvx_last_error(NULL)->message);
}

/* ---- meshes ---- */

static double corner[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
static uint32_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};

static bvx_mesh_view tetrahedron(void)
{
    bvx_mesh_view view = {0};

    view.positions = corner;
    view.indices = triangles;
    view.vertex_count = view.triangle_count = 4;
    view.position_type = BVX_F64;
    view.index_type = BVX_U32;
    return view;
}

static void test_the_element_that_is_wrong(void)
{
    bvx_mesh_view const view = tetrahedron();
    bvx_lattice lattice;

    corner[3][1] = HUGE_VAL;
    failed(BVX_ERR_RANGE, bvx_lattice_fit(ctx, &view, 8, &lattice), BVX_REASON_NOT_FINITE, "bvx_lattice_fit");
    TEST_ASSERT_EQUAL_INT64(3, error->index);
    TEST_ASSERT_EQUAL_INT32(2, error->value_count);
    TEST_ASSERT_EQUAL_DOUBLE(3.0, error->value[0]);
    TEST_ASSERT_TRUE(error->value[1] > 1e308);
    TEST_ASSERT_EQUAL_STRING("vertex 3 has y = inf, which is not finite", error->text);
    corner[3][1] = 0;

    triangles[2][0] = 17;
    failed(BVX_ERR_RANGE, bvx_lattice_fit(ctx, &view, 8, &lattice), BVX_REASON_INDEX, "bvx_lattice_fit");
    TEST_ASSERT_EQUAL_INT64(2, error->index);
    TEST_ASSERT_EQUAL_INT32(3, error->value_count);
    TEST_ASSERT_EQUAL_DOUBLE(17.0, error->value[1]);
    TEST_ASSERT_EQUAL_DOUBLE(4.0, error->value[2]);
    triangles[2][0] = 1;

    /* The next failure names no element: nothing is left of this one. */
    failed(BVX_ERR_ARGUMENT, bvx_lattice_fit(ctx, NULL, 8, &lattice), BVX_REASON_NULL, "bvx_lattice_fit");
    TEST_ASSERT_EQUAL_INT64(-1, error->index);
    TEST_ASSERT_EQUAL_INT32(0, error->value_count);
    TEST_ASSERT_EQUAL_STRING("mesh is NULL", error->text);

    /* A success leaves it. */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, &view, 8, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_REASON_NULL, bvx_last_error(ctx)->reason);
}

/* The function is the one that was called, whichever of its works failed;
 * the message names which of two meshes. */
static void test_the_function_that_was_called(void)
{
    bvx_mesh_view const good = tetrahedron();
    bvx_mesh_view bad = good;
    bvx_mesh mesh = {0};
    bvx_levels_options o = {.struct_size = sizeof o};

    bad.position_type = 9;
    failed(BVX_ERR_ARGUMENT, bvx_boolean(ctx, &good, &bad, BVX_BOOLEAN_UNION, NULL, &mesh), BVX_REASON_CHOICE,
           "bvx_boolean");
    TEST_ASSERT_EQUAL_STRING_LEN("mesh b: ", error->text, 8);
    o.sign = BVX_FILL_NORMAL;
    o.solid = 1;
    failed(BVX_ERR_ARGUMENT, bvx_build_levels(ctx, &good, &o, 1, &mesh), BVX_REASON_CHOICE,
           "bvx_build_levels");
    /* reports no progress */
    failed(BVX_ERR_ARGUMENT, bvx_lattice_make(ctx, NULL, NULL, NULL, NULL), BVX_REASON_NULL,
           "bvx_lattice_make");
}

/* ---- statuses that say it all ---- */

static int32_t stop(void *user, const char *stage, double fraction)
{
    (void)user, (void)stage, (void)fraction;
    return 1;
}

static bvx_status make_again(const bvx_context_options *o, bvx_grid *grid)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {64, 64, 64};
    bvx_mesh mesh = {0};
    bvx_lattice lattice;
    bvx_status status;

    bvx_context_destroy(ctx);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(o, &ctx));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    status = bvx_grid_create(ctx, &lattice, NULL, grid);
    if (status == BVX_OK) {
        bvx_grid_set(grid, 5, 5, 5, 1);
        status = bvx_extract_surface(ctx, grid, NULL, &mesh);
    }
    bvx_mesh_free(ctx, &mesh);
    return status;
}

static void *no_alloc(void *user, size_t size, size_t align)
{
    static uint64_t room[4096 * 8]; /* for the context */

    (void)size;
    if ((*(int *)user)++ != 0) return NULL;
    return (unsigned char *)room + (align - (uintptr_t)room % align) % align;
}

static void no_free(void *user, void *block, size_t size, size_t align)
{
    (void)user, (void)block, (void)size, (void)align;
}

static void test_memory_capacity_and_the_callback(void)
{
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_grid grid = {0};
    uint64_t words[8];
    int calls = 0;

    o.memory_limit = 4096;
    failed(BVX_ERR_BUDGET, make_again(&o, &grid), BVX_REASON_BUDGET, "bvx_grid_create");
    TEST_ASSERT_TRUE(error->value_count >= 3 && error->value[0] == 32768.0); /* the bytes wanted */

    o.memory_limit = 0;
    o.threads = 1;
    o.allocator.alloc = no_alloc;
    o.allocator.free = no_free;
    o.allocator.user = &calls;
    failed(BVX_ERR_MEMORY, make_again(&o, &grid), BVX_REASON_MEMORY, "bvx_grid_create");

    o = (bvx_context_options){.struct_size = sizeof o};
    grid.words = words;
    grid.word_capacity = 8;
    failed(BVX_ERR_CAPACITY, make_again(&o, &grid), BVX_REASON_CAPACITY, "bvx_grid_create");

    memset(&grid, 0, sizeof grid);
    o.progress.call = stop;
    failed(BVX_CANCELLED, make_again(&o, &grid), BVX_REASON_CANCELLED, "bvx_extract_surface");
    bvx_grid_free(ctx, &grid);
}

/* ---- what the program asks about ---- */

static void test_positions_that_are_too_coarse(void)
{
    static const double spacing[3] = {0.01, 0.01, 0.01};
    static const int32_t dims[3] = {8, 8, 8};
    double origin[3] = {5e6, 0, 0};
    float samples[512] = {0};
    bvx_volume_view volume = {0};
    bvx_scalar_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = {0};

    samples[100] = 1;
    volume.samples = samples;
    volume.sample_type = BVX_SAMPLE_F32;
    memcpy(volume.size, dims, sizeof dims);
    o.level = 0.5;
    o.position_type = BVX_F32;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &volume.lattice));
    failed(BVX_ERR_RANGE, bvx_extract_scalar(ctx, &volume, &o, &mesh), BVX_REASON_FLOATS_COARSE,
           "bvx_extract_scalar");
    TEST_ASSERT_EQUAL_DOUBLE(0.5, error->value[1]); /* the step of floats there */

    volume.lattice.origin[0] = 1e13;
    o.position_type = BVX_POSITION_AUTO;
    failed(BVX_ERR_RANGE, bvx_extract_scalar(ctx, &volume, &o, &mesh), BVX_REASON_DOUBLES_COARSE,
           "bvx_extract_scalar");
}

static void test_levels_by_their_numbers(void)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {8, 8, 8};
    int32_t const resolutions[3] = {8, 4, 9};
    bvx_mesh level[3] = {{0}};
    bvx_grid grid = {0};
    bvx_lattice lattice;
    bvx_lod_options o = {.struct_size = sizeof o};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, NULL, &grid));
    bvx_grid_set(&grid, 4, 4, 4, 1);
    o.resolutions = resolutions;
    failed(BVX_ERR_RANGE, bvx_build_lods(ctx, &grid, &o, 3, level), BVX_REASON_INDEX, "bvx_build_lods");
    TEST_ASSERT_EQUAL_INT64(2, error->index);
    o.resolutions = &resolutions[2];
    o.first_level = 7; /* one level a call */
    failed(BVX_ERR_RANGE, bvx_build_lods(ctx, &grid, &o, 1, level), BVX_REASON_INDEX, "bvx_build_lods");
    TEST_ASSERT_EQUAL_INT64(7, error->index);
    TEST_ASSERT_EQUAL_STRING_LEN("level 7 asks", error->text, 12);
    bvx_grid_free(ctx, &grid);
}

static void test_choices_and_reserved_fields(void)
{
    bvx_mesh_view const view = tetrahedron();
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_surface_options s = {.struct_size = sizeof s};
    bvx_lattice lattice;
    bvx_grid grid = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, &view, 8, &lattice));
    o.fill = 99;
    failed(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &view, &lattice, &o, &grid), BVX_REASON_CHOICE,
           "bvx_voxelize_solid");
    TEST_ASSERT_EQUAL_DOUBLE(99.0, error->value[0]);
    o.fill = BVX_FILL_PARITY;
    s.reserved = 1;
    failed(BVX_ERR_ARGUMENT, bvx_voxelize_surface(ctx, &view, &lattice, &s, &grid), BVX_REASON_RESERVED,
           "bvx_voxelize_surface");
    TEST_ASSERT_EQUAL_STRING("reserved must be 0", error->text);
    o.struct_size = 2;
    failed(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &view, &lattice, &o, &grid), BVX_REASON_OPTIONS,
           "bvx_voxelize_solid");
}

/* What neither status nor range says by itself. */
static void test_counts_and_bytes(void)
{
    bvx_grid grid = {0};
    bvx_mesh mesh = {0};
    bvx_image image = {0};
    bvx_buffer file = {0};
    bvx_render_options r = {.struct_size = sizeof r};
    bvx_lattice lattice;
    int32_t const dims[3] = {1, 1, 1};
    double const low[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};

    failed(BVX_ERR_ARGUMENT, bvx_write_mesh(ctx, &mesh, 0, NULL, BVX_FORMAT_GLB, &file), BVX_REASON_RANGE,
           "bvx_write_mesh");
    failed(BVX_ERR_RANGE, bvx_write_mesh(ctx, &mesh, UINT64_MAX, NULL, BVX_FORMAT_GLB, &file),
           BVX_REASON_TOO_MANY, "bvx_write_mesh");

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, low, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, NULL, &grid));
    bvx_grid_set(&grid, 0, 0, 0, 1);
    r.cut.sides = 64;
    failed(BVX_ERR_ARGUMENT, bvx_render_grid(ctx, &grid, &r, &image), BVX_REASON_RANGE, "bvx_render_grid");
    bvx_grid_free(ctx, &grid);
}

static void build_contours(double *points, uint32_t count, int32_t second_label, bvx_status expected,
                           int32_t reason, int64_t index)
{
    double positions[2] = {0, 1};
    bvx_section_loop loops[2] = {{0, count, 0, 1, 0}, {count, count, 1, second_label, 0}};
    bvx_sections s = {0};
    bvx_mesh mesh = {0};

    s.points = points;
    s.loops = loops;
    s.positions = positions;
    s.point_count = 2 * count;
    s.loop_count = s.section_count = 2;
    s.normal[2] = 1;
    failed(expected, bvx_build_sections(ctx, &s, NULL, &mesh), reason, "bvx_build_sections");
    TEST_ASSERT_EQUAL_INT64(index, error->index);
}

static void test_contours(void)
{
    double square[24] = {0, 0, 0, 4, 0, 0, 4, 4, 0, 0, 4, 0, 0, 0, 1, 4, 0, 1, 4, 4, 1, 0, 4, 1};
    double bow[24] = {0, 0, 0, 4, 0, 0, 4, 4, 0, 0, 4, 0, 0, 0, 1, 4, 4, 1, 4, 0, 1, 0, 4, 1};
    double two[24] = {0, 0, 0, 4, 0, 0, 4, 4, 0, 0, 4, 0, 0, 0, 1, 4, 4, 1, 4, 4, 1, 0, 0, 1};

    build_contours(square, 4, 2, BVX_ERR_ARGUMENT, BVX_REASON_SEVERAL_BODIES, -1);
    build_contours(bow, 4, 1, BVX_ERR_FORMAT, BVX_REASON_LOOPS_MEET, 1);
    build_contours(two, 4, 1, BVX_ERR_EMPTY, BVX_REASON_LOOP_FLAT, 1);
}

static void test_packed_samples(void)
{
    static const char head[] =
        "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 2 2 2\nencoding: gzip\n\nxxxxxxxx";
    bvx_volume volume = {0};

    failed(BVX_ERR_UNSUPPORTED, bvx_read_volume(ctx, head, sizeof head - 1, BVX_FORMAT_NRRD, NULL, &volume),
           BVX_REASON_COMPRESSED, "bvx_read_volume");
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_reasons_have_their_numbers_and_texts);
    RUN_TEST(test_before_any_failure);
    RUN_TEST(test_the_element_that_is_wrong);
    RUN_TEST(test_the_function_that_was_called);
    RUN_TEST(test_memory_capacity_and_the_callback);
    RUN_TEST(test_positions_that_are_too_coarse);
    RUN_TEST(test_levels_by_their_numbers);
    RUN_TEST(test_choices_and_reserved_fields);
    RUN_TEST(test_counts_and_bytes);
    RUN_TEST(test_contours);
    RUN_TEST(test_packed_samples);
    return UNITY_END();
}
