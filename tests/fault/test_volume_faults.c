/* test_volume_faults.c - volumes: thresholds, surfaces of levels, labels and readers with every allocation
 * failing once, cancelled at every progress call, under every memory limit and in arenas of every size. */
#include "fault/rows.h"
#include "tools/mesh_maker.h"

#include <stdio.h>

enum { VOLUME_X = 70, VOLUME_Y = 60, VOLUME_Z = 41, VOLUME_SAMPLES = VOLUME_X * VOLUME_Y * VOLUME_Z };

/* ---- Inputs, made once ---- */

static float floats[VOLUME_SAMPLES];
static int16_t whole[VOLUME_SAMPLES];
static bvx_volume_view float_view, whole_view;
static char *text_file, *packed_file; /* NRRD: ascii; "gzip" of big-endian samples */
static size_t text_size, packed_size;

static int make_volumes(void **state)
{
    static const double origin[3] = {1, 2, 3}, spacing[3] = {1, 1, 2};
    static const int32_t dims[3] = {VOLUME_X, VOLUME_Y, VOLUME_Z};
    bvx_context_options const o = default_options();
    bvx_context *const ctx = context_with(&o);
    uint64_t seed = 5;

    (void)state;
    for (int i = 0; i < VOLUME_SAMPLES; i++) {
        whole[i] = (int16_t)(maker_below(&seed, 400) - 100);
        floats[i] = (float)whole[i];
    }
    memset(&float_view, 0, sizeof float_view);
    assert_int_equal(bvx_lattice_make(ctx, origin, spacing, dims, &float_view.lattice), BVX_OK);
    memcpy(float_view.size, dims, sizeof dims);
    float_view.samples = floats;
    float_view.sample_type = BVX_SAMPLE_F32;
    whole_view = float_view;
    whole_view.samples = whole;
    whole_view.sample_type = BVX_SAMPLE_I16;
    bvx_context_destroy(ctx);
    text_file = malloc(8 * VOLUME_SAMPLES + 256);
    packed_file = malloc(2 * VOLUME_SAMPLES + 256);
    assert_non_null(text_file);
    assert_non_null(packed_file);
    text_size = (size_t)sprintf(text_file,
                                "NRRD0004\ntype: int16\ndimension: 3\nsizes: 70 60 41\nencoding: ascii\n\n");
    packed_size = (size_t)sprintf(
        packed_file, "NRRD0004\ntype: int16\ndimension: 3\nsizes: 70 60 41\nencoding: gzip\nendian: big\n\n");
    for (int i = 0; i < VOLUME_SAMPLES; i++) {
        text_size += (size_t)sprintf(text_file + text_size, "%d ", whole[i]);
        packed_file[packed_size++] = (char)((uint16_t)whole[i] >> 8);
        packed_file[packed_size++] = (char)((uint16_t)whole[i] & 255);
    }
    return 0;
}

static int free_volumes(void **state)
{
    (void)state;
    free(text_file);
    free(packed_file);
    return 0;
}

/* ---- Operations: each frees what it got and leaves its mark ---- */

static bvx_status do_threshold(void *user, bvx_context *ctx)
{
    bvx_volume_report report;
    bvx_grid grid = {0};
    bvx_status status;

    (void)user;
    status = bvx_threshold(ctx, &float_view, 50, 200, &report, &grid);
    left_behind |= status != BVX_OK && grid.words != NULL;
    if (status == BVX_OK)
        mark = bvx_hash(grid.words, (size_t)grid.word_capacity * 8, bvx_hash(&report, sizeof report, 0));
    bvx_grid_free(ctx, &grid);
    return status;
}

static bvx_status do_threshold_whole(void *user, bvx_context *ctx)
{
    bvx_grid grid = {0};
    bvx_status status;

    (void)user;
    status = bvx_threshold_whole(ctx, &whole_view, 1, 200, NULL, &grid);
    left_behind |= status != BVX_OK && grid.words != NULL;
    if (status == BVX_OK) mark = bvx_hash(grid.words, (size_t)grid.word_capacity * 8, 0);
    bvx_grid_free(ctx, &grid);
    return status;
}

static bvx_status do_scalar(void *user, bvx_context *ctx)
{
    bvx_scalar_options o = {.struct_size = sizeof o};
    bvx_volume_report report;
    bvx_mesh mesh = {0};
    bvx_status status;

    (void)user;
    o.level = 280;
    o.keys = 1;
    o.report = &report;
    status = bvx_extract_scalar(ctx, &float_view, &o, &mesh);
    left_behind |= status != BVX_OK && mesh.positions != NULL;
    if (status == BVX_OK) status = bvx_mesh_hash(ctx, &mesh, &mark);
    bvx_mesh_free(ctx, &mesh);
    return status;
}

static bvx_status do_labels(void *user, bvx_context *ctx)
{
    static bvx_label labels[512];
    uint64_t count = 0;
    bvx_status status;
    (void)user;
    status = bvx_list_labels(ctx, &whole_view, labels, 512, &count);
    if (status == BVX_OK) mark = bvx_hash(labels, (size_t)count * sizeof *labels, count);
    return status;
}

static uint64_t fewer;

static bvx_status do_surfaces(void *user, bvx_context *ctx)
{
    bvx_complex complex_ = {0};
    bvx_mesh mesh = {0};
    bvx_volume_view part = whole_view;
    uint64_t hash = 0;
    bvx_status status;

    (void)user;
    for (int a = 0; a < 3; a++) part.size[a] = 8;
    part.strides[0] = 2;
    part.strides[1] = 2 * VOLUME_X;
    part.strides[2] = 2 * VOLUME_X * VOLUME_Y;
    bvx_labels_options const o = {.struct_size = sizeof o, .triangles = fewer, .open = fewer != 0};
    status = bvx_label_surfaces(ctx, &part, &o, &complex_);
    left_behind |= status != BVX_OK && complex_.mesh.positions != NULL;
    if (status == BVX_OK) status = bvx_label_mesh(ctx, &complex_, 1, &mesh);
    left_behind |= status != BVX_OK && mesh.positions != NULL;
    if (status == BVX_OK) status = bvx_mesh_hash(ctx, &mesh, &mark);
    if (status == BVX_OK) status = bvx_mesh_hash(ctx, &complex_.mesh, &hash);
    mark ^= hash;
    bvx_mesh_free(ctx, &mesh);
    bvx_complex_free(ctx, &complex_);
    return status;
}

static bvx_status do_fewer(void *user, bvx_context *ctx)
{
    fewer = 64;
    bvx_status const status = do_surfaces(user, ctx);
    fewer = 0;
    return status;
}

static int32_t unpack_nothing(void *user, const void *packed, uint64_t packed_bytes, void *plain,
                              uint64_t plain_bytes)
{
    (void)user;
    if (packed_bytes != plain_bytes) return 1;
    memcpy(plain, packed, (size_t)plain_bytes);
    return 0;
}

static bvx_status read_one(bvx_context *ctx, const char *bytes, size_t size)
{
    bvx_read_volume_options o = {.struct_size = sizeof o};
    bvx_volume volume = {0};
    bvx_status status;

    o.inflate = unpack_nothing;
    status = bvx_read_volume(ctx, bytes, size, BVX_FORMAT_NRRD, &o, &volume);
    left_behind |= status != BVX_OK && volume.view.samples != NULL;
    if (status == BVX_OK) mark = bvx_hash(volume.view.samples, (size_t)volume.bytes, 0);
    if (status == BVX_OK) assert_memory_equal(volume.view.samples, whole, sizeof whole);
    bvx_volume_free(ctx, &volume);
    return status;
}

static bvx_status do_text(void *user, bvx_context *ctx)
{
    (void)user;
    return read_one(ctx, text_file, text_size);
}

static bvx_status do_packed(void *user, bvx_context *ctx)
{
    (void)user;
    return read_one(ctx, packed_file, packed_size);
}

static fault_row operations[] = {
    {"threshold", do_threshold, 1, 1, 0},
    {"threshold of integers", do_threshold_whole, 1, 1, 0},
    {"surface", do_scalar, 1, 1, 0},
    {"labels", do_labels, 1, 1, 0},
    {"surfaces of labels", do_surfaces, 1, 1, 0},
    {"surfaces of labels, fewer triangles", do_fewer, 1, 1, 0},
    {"text", do_text, 1, 1, 0},
    {"packed", do_packed, 1, 1, 0},
};

/* ---- Tests ---- */

static void test_every_allocation_of_volumes_fails_once(void **state)
{
    (void)state;
    fail_every_allocation(FAULT_ROWS(operations));
}

static void test_volumes_cancel_at_every_progress_call(void **state)
{
    (void)state;
    cancel_at_every_call(FAULT_ROWS(operations));
}

static void test_volumes_under_every_memory_limit(void **state)
{
    (void)state;
    limit_memory(FAULT_ROWS(operations), 40);
}

static void test_volumes_live_in_an_arena(void **state)
{
    (void)state;
    live_in_arenas(FAULT_ROWS(operations), 1 << 23, 20);
}

/* What a caller's function for packed data does wrong, after it has written a part of them. */
typedef struct bad_unpacker {
    int calls, fail_at;
    int32_t result;
} bad_unpacker;

static int32_t unpack_at_times(void *user, const void *packed, uint64_t packed_bytes, void *plain,
                               uint64_t plain_bytes)
{
    bad_unpacker *const u = user;
    if (++u->calls != u->fail_at) return unpack_nothing(NULL, packed, packed_bytes, plain, plain_bytes);
    memset(plain, 0x77, (size_t)plain_bytes / 2);
    return u->result;
}

static bvx_status pack_grid(bvx_context *ctx, const bvx_read_volume_options *o, uint64_t *hash)
{
    bvx_volume volume = {0};
    bvx_grid grid = {0};
    bvx_status status = bvx_read_volume(ctx, packed_file, packed_size, BVX_FORMAT_NRRD, o, &volume);

    if (status == BVX_OK) status = bvx_threshold(ctx, &volume.view, 50, 200, NULL, &grid);
    if (status == BVX_OK) assert_int_equal(bvx_grid_hash(ctx, &grid, hash), BVX_OK);
    else assert_null(volume.view.samples);
    bvx_grid_free(ctx, &grid);
    bvx_volume_free(ctx, &volume);
    return status;
}

/* The caller's function fails in its first, second, third call: each time that read fails, with a message and
 * nothing held, and the same context reads the same volume before and after. */
static void test_an_unpacker_that_fails_at_every_call(void **state)
{
    static const int32_t results[] = {1, -1, INT32_MAX, INT32_MIN};

    (void)state;
    for (int at = 1; at <= 3; at++)
        for (size_t r = 0; r < sizeof results / sizeof results[0]; r++) {
            fault_heap heap = {0};
            bvx_context_options const base = default_options(), o = fault_options(&base, &heap);
            bvx_context *const ctx = context_with(&o);
            bad_unpacker u = {0, 0, 0};
            bvx_read_volume_options options = {.struct_size = sizeof options};
            uint64_t want = 0;
            options.inflate = unpack_at_times;
            options.inflate_user = &u;
            u.fail_at = at;
            u.result = results[r];
            for (int i = 1; i <= 4; i++) {
                uint64_t hash = 0;
                assert_null(
                    fault_after(ctx, pack_grid(ctx, &options, &hash), i == at ? BVX_ERR_FORMAT : BVX_OK));
                if (i == at) continue;
                if (want == 0) want = hash;
                assert_true(hash != 0 && hash == want);
            }
            assert_int_equal(u.calls, 4);
            bvx_context_destroy(ctx);
            assert_null(fault_end(&heap));
        }
}

/* Names of data files ask for no memory, and a head cut off anywhere gives none or those of a shorter
 * head. */
static void test_data_names_of_a_head_that_is_cut_off(void **state)
{
    static const char head[] =
        "NRRD0004\ntype: int16\ndimension: 3\nsizes: 2 2 93\nencoding: raw\nendian: big\n"
        "data file: slice.%03d.raw 1 93 1\n";
    fault_heap heap = {0};
    bvx_context_options const base = default_options(), o = fault_options(&base, &heap);
    bvx_context *const ctx = context_with(&o);
    uint64_t const before = heap.asked;
    int good = 0;

    (void)state;
    for (size_t n = 0; n < sizeof head; n++)
        for (uint64_t room = 0; room <= 14; room++) {
            char name[16];
            /* of exact size, so that a sanitizer sees a read beyond the end */
            char *const copy = malloc(n + 1);
            uint64_t count = 777;
            bvx_status status;
            assert_non_null(copy);
            memcpy(copy, head, n);
            memset(name, 0x55, sizeof name);
            status = bvx_volume_data_name(ctx, copy, n, 41, name, room, &count);
            free(copy);
            if (n == sizeof head - 1) assert_int_equal(status, room < 14 ? BVX_ERR_CAPACITY : BVX_OK);
            if (status == BVX_OK) assert_string_equal(name, "slice.042.raw");
            else assert_int_not_equal(strlen(bvx_last_message(ctx)), 0);
            if (status == BVX_OK) good++;
            for (size_t i = room; i < sizeof name; i++) assert_int_equal(name[i], 0x55);
        }
    assert_true(good > 0);
    assert_int_equal(heap.asked, before);
    bvx_context_destroy(ctx);
    assert_null(fault_end(&heap));
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_volumes_fails_once),
        cmocka_unit_test(test_volumes_cancel_at_every_progress_call),
        cmocka_unit_test(test_volumes_under_every_memory_limit),
        cmocka_unit_test(test_volumes_live_in_an_arena),
        cmocka_unit_test(test_an_unpacker_that_fails_at_every_call),
        cmocka_unit_test(test_data_names_of_a_head_that_is_cut_off),
    };
    return cmocka_run_group_tests(tests, make_volumes, free_volumes);
}
