/* test_dense_files.c - the readers and writers of .npy, .nrrd, .vti and the lattice's side-car with every
 * allocation failing once and cancelled at every progress call. After each failure the grid is as it was and
 * nothing is held, and the same context does the work with the usual result. */
#include "fault/context.h"

/* A file's bytes or the grid to be written, and what the result must hash to once a first run has set it. */
typedef struct dense_case {
    const bvx_grid *grid;
    const void *bytes;
    uint64_t size;
    int32_t format;
    uint64_t hash;
    int other; /* another result than usual */
} dense_case;

static uint64_t words[9 * 7 * 2];
static bvx_grid grid;

/* 70 x 9 x 7 voxels, some of them set, over words of our own. */
static int make_grid(void **state)
{
    static const double origin[3] = {1, 2, 3}, spacing[3] = {0.5, 1, 2};
    static const int32_t dims[3] = {70, 9, 7};
    bvx_context_options const o = default_options();
    bvx_context *const ctx = context_with(&o);

    (void)state;
    grid.words = words;
    grid.word_capacity = sizeof words / sizeof words[0];
    assert_int_equal(bvx_lattice_make(ctx, origin, spacing, dims, &grid.lattice), BVX_OK);
    assert_int_equal(bvx_grid_create(ctx, &grid.lattice, NULL, &grid), BVX_OK);
    for (int32_t i = 0; i < 70 * 9 * 7; i += 3) bvx_grid_set(&grid, i % 70, i / 70 % 9, i / 630, 1);
    bvx_context_destroy(ctx);
    return 0;
}

static void note_result(dense_case *c, uint64_t hash)
{
    if (c->hash == 0) c->hash = hash;
    c->other |= hash != c->hash;
}

static bvx_status write_dense(void *user, bvx_context *ctx)
{
    static const bvx_buffer empty = {0};
    dense_case *const c = user;
    bvx_buffer b = {0};
    bvx_status const status = c->format == 0 ? bvx_write_lattice(ctx, c->grid, &b)
                                             : bvx_write_grid(ctx, c->grid, c->format, &b);

    if (status != BVX_OK) assert_memory_equal(&b, &empty, sizeof b);
    else note_result(c, bvx_hash(b.bytes, (size_t)b.size, 0));
    bvx_buffer_free(ctx, &b);
    return status;
}

static bvx_status read_dense(void *user, bvx_context *ctx)
{
    static const bvx_grid empty = {0};
    dense_case *const c = user;
    bvx_grid g = {0};
    bvx_status const status = bvx_read_grid(ctx, c->bytes, c->size, c->format, NULL, &g);

    if (status != BVX_OK) {
        assert_memory_equal(&g, &empty, sizeof g);
    } else {
        uint64_t hash;
        assert_int_equal(bvx_grid_hash(ctx, &g, &hash), BVX_OK);
        note_result(c, hash);
    }
    bvx_grid_free(ctx, &g);
    return status;
}

static void check_everything(fault_operation_fn *operation, dense_case *c, uint64_t wanted)
{
    uint64_t allocations = 0, calls = 0;
    const char *wrong = fault_every_allocation(operation, c, NULL, &allocations);

    if (wrong == NULL) wrong = fault_every_cancel(operation, c, NULL, &calls);
    if (wrong != NULL) fail_msg("%s", wrong);
    if (c->other) fail_msg("format %d: another result than usual", (int)c->format);
    assert_true(c->hash != 0);
    assert_int_equal(allocations, wanted);
    assert_true(calls > 0 || c->format == 0);
}

static void test_write_dense_files(void **state)
{
    static const int32_t formats[] = {0, BVX_FORMAT_NPY, BVX_FORMAT_NRRD, BVX_FORMAT_VTI};
    (void)state;
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        dense_case c = {&grid, NULL, 0, 0, 0, 0};
        c.format = formats[i];
        check_everything(write_dense, &c, 1);
    }
}

static void test_read_dense_files(void **state)
{
    static const int32_t formats[] = {BVX_FORMAT_NPY, BVX_FORMAT_NRRD, BVX_FORMAT_VTI};
    bvx_context_options const o = default_options();
    bvx_context *const ctx = context_with(&o);

    (void)state;
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        bvx_buffer b = {0};
        dense_case c = {NULL, NULL, 0, 0, 0, 0};
        assert_int_equal(bvx_write_grid(ctx, &grid, formats[i], &b), BVX_OK);
        c.bytes = b.bytes;
        c.size = b.size;
        c.format = formats[i];
        check_everything(read_dense, &c, 1);
        bvx_buffer_free(ctx, &b);
    }
    bvx_context_destroy(ctx);
}

static void test_read_text_and_base64(void **state)
{
    static const char nrrd[] =
        "NRRD0004\ntype: int\ndimension: 3\nsizes: 3 1 2\nencoding: ascii\n\n1 0 1 0 1 0\n";
    static const char vti[] =
        "<VTKFile type=\"ImageData\" version=\"0.1\" byte_order=\"LittleEndian\"><ImageData WholeExtent=\"0 3 0 2 0 2\">"
        "<Piece Extent=\"0 3 0 2 0 2\"><CellData><DataArray type=\"UInt8\" format=\"binary\">"
        "DAAAAAEAAQAAAQABAAEBAA==</DataArray></CellData></Piece></ImageData></VTKFile>";
    dense_case text = {NULL, nrrd, sizeof nrrd - 1, BVX_FORMAT_NRRD, 0, 0};
    dense_case base64 = {NULL, vti, sizeof vti - 1, BVX_FORMAT_VTI, 0, 0};

    (void)state;
    check_everything(read_dense, &text, 1);
    check_everything(read_dense, &base64, 2); /* the decoded samples, and the grid */
}

int main(void)
{
    static const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_write_dense_files),
        cmocka_unit_test(test_read_dense_files),
        cmocka_unit_test(test_read_text_and_base64),
    };
    return cmocka_run_group_tests(tests, make_grid, NULL);
}
