/* test_vox.c - MagicaVoxel files: written ones taken apart, hand-made ones of other makers, windows,
 * damage. */
#include "packed_support.h"

/* ---- files put together chunk by chunk ---- */

typedef struct vox_file {
    uint8_t bytes[2000];
    size_t size;
} vox_file;

static void add(vox_file *f, const void *bytes, size_t n)
{
    memcpy(f->bytes + f->size, bytes, n);
    f->size += n;
}

static void add_u32(vox_file *f, uint32_t v)
{
    put_u32(f->bytes + f->size, v, 0);
    f->size += 4;
}

static void start(vox_file *f, uint32_t version)
{
    f->size = 0;
    add(f, "VOX ", 4);
    add_u32(f, version);
    add(f, "MAIN\0\0\0\0\0\0\0\0", 12);
}

static void add_chunk(vox_file *f, const char *name, const void *content, uint32_t n, uint32_t children)
{
    add(f, name, 4);
    add_u32(f, n);
    add_u32(f, children);
    add(f, content, n);
}

static void add_size(vox_file *f, uint32_t x, uint32_t y, uint32_t z)
{
    uint8_t sides[12];
    put_u32(sides, x, 0);
    put_u32(sides + 4, y, 0);
    put_u32(sides + 8, z, 0);
    add_chunk(f, "SIZE", sides, 12, 0);
}

/* voxels: x, y, z, colour of each. */
static void add_voxels(vox_file *f, const char *voxels, uint32_t count)
{
    add(f, "XYZI", 4);
    add_u32(f, 4 + 4 * count);
    add_u32(f, 0);
    add_u32(f, count);
    add(f, voxels, 4 * (size_t)count);
}

/* MAIN holds all that was added. */
static void finish(vox_file *f)
{
    put_u32(f->bytes + 16, (uint32_t)f->size - 20, 0);
}

static void check_vox_refused(vox_file *f, bvx_status status, const char *words)
{
    finish(f);
    check_packed_refused(f->bytes, f->size, BVX_FORMAT_VOX, status, words);
}

/* ---- writing ---- */

static void check_file(int32_t nx, int32_t ny, int32_t nz, int kind)
{
    bvx_lattice const l = lattice_of(nx, ny, nz, 5, 0.5, 3, 2);
    bvx_grid g, back;
    bvx_buffer b = {0};
    uint32_t n = 0;

    grid_of(&g, &l, NULL, kind, 3);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_VOX, &b),
                                    bvx_last_message(ctx));
    uint8_t *const want = malloc(60 + 4 * (size_t)(nx * ny * nz));
    memcpy(want, "VOX \x96\0\0\0MAIN\0\0\0\0\0\0\0\0SIZE\14\0\0\0\0\0\0\0", 32);
    put_u32(want + 32, (uint32_t)nx, 0);
    put_u32(want + 36, (uint32_t)ny, 0);
    put_u32(want + 40, (uint32_t)nz, 0);
    memcpy(want + 44, "XYZI\0\0\0\0\0\0\0\0", 12);
    for (int32_t z = 0; z < nz; z++)
        for (int32_t y = 0; y < ny; y++)
            for (int32_t x = 0; x < nx; x++)
                if (bvx_grid_get(&g, x, y, z)) {
                    uint8_t const voxel[4] = {(uint8_t)x, (uint8_t)y, (uint8_t)z, 1};
                    memcpy(want + 60 + 4 * (size_t)n++, voxel, 4);
                }
    put_u32(want + 16, 40 + 4 * n, 0);
    put_u32(want + 48, 4 + 4 * n, 0);
    put_u32(want + 56, n, 0);
    TEST_ASSERT_EQUAL_UINT64(60 + 4 * n, b.size);
    TEST_ASSERT_EQUAL_MEMORY(want, b.bytes, (size_t)b.size);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_packed(b.bytes, (size_t)b.size, BVX_FORMAT_VOX, NULL, &back),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_MEMORY(g.words, back.words, 8 * grid_words(&g));
    for (int a = 0; a < 3; a++) {
        TEST_ASSERT_EQUAL_INT32(g.size[a], back.lattice.dims[a]);
        TEST_ASSERT_TRUE(back.lattice.origin[a] == 0.0 && back.lattice.spacing[a] == 1.0);
    }
    check_windows(&b, BVX_FORMAT_VOX, &back, 8);
    check_own_words(&g, &b, BVX_FORMAT_VOX);
    bvx_grid_free(ctx, &back);
    free(want);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

static void test_vox_of_many_shapes(void)
{
    static const int32_t sides[] = {1, 2, 63, 64, 65, 127, 129, 255, 256};
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++)
        for (int kind = 0; kind < KINDS; kind++) {
            check_file(sides[i], 3, 2, kind);
            check_file(2, sides[i], 3, kind);
            check_file(3, 2, sides[i], kind);
        }
}

static void test_vox_of_a_window(void)
{
    bvx_lattice const l = lattice_of(1000, 1000, 1000, 5, 0.5, 3, 2);
    bvx_window const w = window_of(700, 3, 999, 256, 1, 1);
    bvx_grid g, back;
    bvx_buffer b = {0};

    grid_of(&g, &l, &w, KIND_NOISE, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_VOX, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_packed(b.bytes, (size_t)b.size, BVX_FORMAT_VOX, NULL, &back));
    TEST_ASSERT_EQUAL_MEMORY(g.words, back.words, 8 * grid_words(&g));
    TEST_ASSERT_EQUAL_INT32(0, back.low[0]);
    bvx_grid_free(ctx, &back);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

static void test_vox_refuses_to_write(void)
{
    static const char *const words[3] = {"257 voxels along x", "257 voxels along y", "257 voxels along z"};

    for (int a = 0; a < 3; a++) {
        bvx_lattice const l = lattice_of(a == 0 ? 257 : 1, a == 1 ? 257 : 1, a == 2 ? 257 : 1, 0, 1, 1, 1);
        bvx_grid g;
        bvx_buffer b = {0};
        grid_of(&g, &l, NULL, KIND_EMPTY, 1);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_grid(ctx, &g, BVX_FORMAT_VOX, &b));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), words[a]));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx),
                                    "holds 256 a side: write windows of the grid, or take another format"));
        TEST_ASSERT_NULL(b.bytes);
        bvx_grid_free(ctx, &g);
    }
}

static void test_vox_limits_and_cancel(void)
{
    bvx_lattice const l = lattice_of(70, 30, 20, 0, 1, 1, 1);
    bvx_grid g;
    bvx_buffer b = {0};

    grid_of(&g, &l, NULL, KIND_NOISE, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_VOX, &b));
    check_memory_limits(&g, &b, BVX_FORMAT_VOX);
    TEST_ASSERT_EQUAL_INT(1, check_cancelled_reading(&b, BVX_FORMAT_VOX));
    TEST_ASSERT_EQUAL_INT(1, check_cancelled_writing(&g, BVX_FORMAT_VOX));
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

/* ---- files of other makers ---- */

static void check_three(vox_file *f)
{
    bvx_grid g;

    finish(f);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_packed(f->bytes, f->size, BVX_FORMAT_VOX, NULL, &g),
                                    bvx_last_message(ctx));
    TEST_ASSERT_TRUE(g.size[0] == 4 && g.size[1] == 5 && g.size[2] == 6);
    for (int32_t z = 0; z < 6; z++)
        for (int32_t y = 0; y < 5; y++)
            for (int32_t x = 0; x < 4; x++)
                TEST_ASSERT_EQUAL_INT((x == 0 && y == 0 && z == 0) || (x == 3 && y == 4 && z == 5) ||
                                          (x == 1 && y == 2 && z == 3),
                                      bvx_grid_get(&g, x, y, z));
    bvx_grid_free(ctx, &g);
}

static const char three[] = "\0\0\0\1"
                            "\3\4\5\377"
                            "\1\2\3\0";

static void test_vox_files_of_others(void)
{
    vox_file f;
    uint8_t palette[1024];

    memset(palette, 7, sizeof palette);
    start(&f, 150); /* as MagicaVoxel wrote them first */
    add_chunk(&f, "PACK", "\1\0\0\0", 4, 0);
    add_size(&f, 4, 5, 6);
    add_voxels(&f, three, 3);
    add_chunk(&f, "RGBA", palette, 1024, 0);
    check_three(&f);
    start(&f, 200); /* with a scene: a model has a place and a turn there, which are not looked at */
    add_size(&f, 4, 5, 6);
    add_voxels(&f, three, 3);
    add_chunk(&f, "nTRN", "\0\0\0\0\0\0\0\0\1\0\0\0\377\377\377\377\0\0\0\0\1\0\0\0\0\0\0\0", 28, 0);
    add_chunk(&f, "nGRP", "\1\0\0\0\0\0\0\0\1\0\0\0\2\0\0\0", 16, 0);
    add_chunk(&f, "LAYR", "", 0, 0);
    add_chunk(&f, "rOBJ", "XYZI", 4, 0);
    check_three(&f);
    start(&f, 150); /* chunks within chunks that nobody knows are passed whole; the same voxel twice */
    add_chunk(&f, "zzzz", "abc", 3, 16);
    add_chunk(&f, "SIZE", "\0\0\0\0", 4, 0);
    add_size(&f, 4, 5, 6);
    add_voxels(&f,
               "\0\0\0\1"
               "\3\4\5\377"
               "\1\2\3\0"
               "\0\0\0\2",
               4);
    check_three(&f);
    start(&f, 150); /* MAIN with content of its own */
    put_u32(f.bytes + 12, 5, 0);
    add(&f, "hello", 5);
    add_size(&f, 4, 5, 6);
    add_voxels(&f, three, 3);
    put_u32(f.bytes + 16, (uint32_t)f.size - 25, 0);
    bvx_grid g;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_packed(f.bytes, f.size, BVX_FORMAT_VOX, NULL, &g),
                                    bvx_last_message(ctx));
    bvx_grid_free(ctx, &g);
}

static void test_vox_refuses(void)
{
    vox_file f;
    bvx_status const format = BVX_ERR_FORMAT;

    start(&f, 150);
    f.bytes[3] = 'x';
    check_vox_refused(&f, format, "does not begin with \"VOX \"");
    start(&f, 151);
    check_vox_refused(&f, BVX_ERR_UNSUPPORTED, "version 151; 150 and 200 can be read");
    start(&f, 150);
    check_vox_refused(&f, format, "without a model");
    f.bytes[8] = 'm';
    check_vox_refused(&f, format, "byte 8: the first chunk is not MAIN");
    start(&f, 150);
    add_size(&f, 4, 5, 6);
    check_vox_refused(&f, format, "without a model");
    add_voxels(&f, three, 3);
    add_size(&f, 4, 5, 6);
    add_voxels(&f, three, 3);
    check_vox_refused(&f, BVX_ERR_UNSUPPORTED, "the file has 2 models; save each in a file of its own");
    add_size(&f, 4, 5, 6);
    add_voxels(&f, three, 3);
    check_vox_refused(&f, BVX_ERR_UNSUPPORTED, "3 models");
    start(&f, 150);
    add_voxels(&f, three, 3);
    check_vox_refused(&f, format, "byte 20: XYZI before any SIZE");
    start(&f, 150);
    add_chunk(&f, "PACK", "\2\0\0\0", 4, 0);
    add_size(&f, 4, 5, 6);
    add_voxels(&f, three, 3);
    check_vox_refused(&f, format, "PACK says 2 models, the file has 1");
    put_u32(f.bytes + 32, 0, 0);
    check_vox_refused(&f, format, "PACK says 0 models");
    start(&f, 150);
    add_chunk(&f, "PACK", "\2\0\0\0\0", 5, 0);
    check_vox_refused(&f, format, "PACK has 5 bytes");
    start(&f, 150);
    add_chunk(&f, "SIZE", "\2\0\0\0\2\0\0\0\2\0\0\0\0", 13, 0);
    check_vox_refused(&f, format, "byte 20: SIZE has 13 bytes");
    start(&f, 150);
    add_size(&f, 4, 5, 6);
    add_voxels(&f, three, 3);
    finish(&f);
    f.bytes[f.size] = 0;
    check_packed_refused(f.bytes, f.size + 1, BVX_FORMAT_VOX, format,
                         "byte 12: MAIN holds 52 bytes, the file has 53");
    f.size++;
    check_vox_refused(&f, format, "the file ends in a chunk's head");
    for (int a = 0; a < 3; a++) {
        static const char *const words[3] = {"voxel 1 has x = 3, SIZE says 3",
                                             "voxel 1 has y = 4, SIZE says 4",
                                             "voxel 1 has z = 5, SIZE says 5"};
        start(&f, 150);
        add_size(&f, a == 0 ? 3 : 4, a == 1 ? 4 : 5, a == 2 ? 5 : 6);
        add_voxels(&f, three, 3);
        check_vox_refused(&f, format, words[a]);
    }
}

/* Every number of the file replaced: an error or a grid of at most 2 MiB. */
static void test_vox_numbers_replaced(void)
{
    static const uint32_t numbers[] = {0, 1, 0xffffffffu, 0x80000000u, 0x7fffffffu, 256, 257, 3, 15};
    vox_file f;

    start(&f, 150);
    add_chunk(&f, "PACK", "\1\0\0\0", 4, 0);
    add_size(&f, 4, 5, 6);
    add_voxels(&f, three, 3);
    finish(&f);
    for (size_t at = 0; at + 4 <= f.size; at++)
        for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
            vox_file bad = f;
            bvx_grid g;
            put_u32(bad.bytes + at, numbers[k], 0);
            bvx_memory_reset_peak(ctx);
            bvx_status const status = read_packed(bad.bytes, bad.size, BVX_FORMAT_VOX, NULL, &g);
            TEST_ASSERT_TRUE(bvx_memory_peak(ctx) <= 256 * 256 * 32);
            TEST_ASSERT_TRUE(status == BVX_OK || status == BVX_ERR_FORMAT || status == BVX_ERR_UNSUPPORTED);
            if (at == 48 && numbers[k] == 256) TEST_ASSERT_TRUE(status == BVX_OK && g.size[0] == 256);
            if (at == 48 && numbers[k] == 257) TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, status);
            bvx_grid_free(ctx, &g);
        }
}

static void test_vox_cut(void)
{
    bvx_lattice const l = lattice_of(20, 6, 7, 0, 1, 1, 1);
    bvx_grid g;
    bvx_buffer b = {0};

    grid_of(&g, &l, NULL, KIND_SPARSE, 4);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_VOX, &b));
    check_every_cut(&b, BVX_FORMAT_VOX);
    for (size_t n = 20; n < b.size; n++) { /* and with MAIN saying that nothing is missing */
        bvx_grid back;
        put_u32(b.bytes + 16, (uint32_t)n - 20, 0);
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, read_packed(b.bytes, n, BVX_FORMAT_VOX, NULL, &back));
    }
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_vox_of_many_shapes);
    RUN_TEST(test_vox_of_a_window);
    RUN_TEST(test_vox_refuses_to_write);
    RUN_TEST(test_vox_limits_and_cancel);
    RUN_TEST(test_vox_files_of_others);
    RUN_TEST(test_vox_refuses);
    RUN_TEST(test_vox_numbers_replaced);
    RUN_TEST(test_vox_cut);
    return UNITY_END();
}
