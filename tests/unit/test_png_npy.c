/* test_png_npy.c - pictures and grids as files, taken apart by slow and plain readers. */
#include "core/core.h"
#include "read_support.h"

/* ---- NPY ---- */

static void check_npy(int nx, int ny, int nz, uint64_t seed)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t const dims[3] = {nx, ny, nz};
    uint64_t state = seed;
    bvx_lattice lattice;
    bvx_grid g = {0};
    bvx_buffer b = {0};
    char dict[100];

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &lattice, NULL, &g));
    for (int z = 0; z < nz; z++)
        for (int y = 0; y < ny; y++)
            for (int x = 0; x < nx; x++) bvx_grid_set(&g, x, y, z, next_random(&state) % 3 == 0);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_NPY, &b));
    TEST_ASSERT_EQUAL_MEMORY("\x93NUMPY\1\0", b.bytes, 8);
    size_t const header = 10 + (size_t)b.bytes[8] + 256 * (size_t)b.bytes[9];
    TEST_ASSERT_EQUAL_UINT64(0, header % 64);
    int const n = sprintf(dict, "{'descr': '|b1', 'fortran_order': True, 'shape': (%d, %d, %d), }", nx, ny,
                          nz);
    TEST_ASSERT_EQUAL_MEMORY(dict, b.bytes + 10, (size_t)n);
    for (size_t i = 10 + (size_t)n; i + 1 < header; i++) TEST_ASSERT_EQUAL_UINT8(' ', b.bytes[i]);
    TEST_ASSERT_EQUAL_UINT8('\n', b.bytes[header - 1]);
    TEST_ASSERT_EQUAL_UINT64(header + (size_t)(nx * ny * nz), b.size);
    const uint8_t *p = b.bytes + header;
    for (int z = 0; z < nz; z++)
        for (int y = 0; y < ny; y++)
            for (int x = 0; x < nx; x++) TEST_ASSERT_EQUAL_UINT8(bvx_grid_get(&g, x, y, z), *p++);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

static void test_write_npy(void)
{
    static const int sides[] = {1, 2, 7, 8, 9, 63, 64, 65, 127, 128, 129};
    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++) {
        check_npy(sides[i], 3, 2, 1 + i);
        check_npy(2, sides[i], 3, 21 + i);
        check_npy(1, 1, sides[i], 41 + i);
    }
}

static void test_write_grid_refuses(void)
{
    static const int32_t formats[] = {BVX_FORMAT_NPY,  BVX_FORMAT_BINVOX, BVX_FORMAT_VOX,
                                      BVX_FORMAT_NRRD, BVX_FORMAT_VTI,    BVX_FORMAT_BVX};
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {1, 1, 1};
    uint64_t word = 1;
    uint8_t byte;
    bvx_grid good = {0}, g;
    bvx_buffer b = {0}, full = {&byte, 1, 0};

    good.words = &word;
    good.word_capacity = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &good.lattice));
    good.size[0] = good.size[1] = good.size[2] = good.words_per_row = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_write_grid(ctx, &good, BVX_FORMAT_STL, &b));
    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++) {
        g = good;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_grid(ctx, NULL, formats[i], &b));
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_grid(ctx, &g, formats[i], NULL));
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_grid(ctx, &g, formats[i], &full));
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_grid(NULL, &g, formats[i], &b));
        g.words_per_row = 2;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_grid(ctx, &g, formats[i], &b));
        g = good;
        g.size[2] = 0;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_grid(ctx, &g, formats[i], &b));
        g = good;
        g.lattice.spacing[1] = 0;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_grid(ctx, &g, formats[i], &b));
        g = good;
        g.word_capacity = 0;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_write_grid(ctx, &g, formats[i], &b));
        g.words = NULL;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_grid(ctx, &g, formats[i], &b));
        TEST_ASSERT_NULL(b.bytes);
    }
}

/* The size is found before a byte is written: words that are said to be there are not looked at. */
static void test_write_grid_too_large(void)
{
    static const int32_t formats[] = {BVX_FORMAT_NPY, BVX_FORMAT_NRRD, BVX_FORMAT_VTI};
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    uint64_t word = 1;

    for (size_t i = 0; i < sizeof formats / sizeof formats[0]; i++)
        for (int32_t bits = 20; bits <= 25; bits += 5) { /* 2^60 bytes, 2^75 */
            int32_t const dims[3] = {1 << bits, 1 << bits, 1 << bits};
            bvx_grid g = {0};
            bvx_buffer b = {0};
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &g.lattice));
            g.words = &word;
            g.word_capacity = UINT64_MAX;
            memcpy(g.size, dims, sizeof g.size);
            g.words_per_row = 1 << (bits - 6);
            TEST_ASSERT_EQUAL_INT32(bits == 20 ? BVX_ERR_BUDGET : BVX_ERR_RANGE,
                                    bvx_write_grid(ctx, &g, formats[i], &b));
            TEST_ASSERT_NULL(b.bytes);
        }
}

/* ---- PNG ---- */

static uint32_t load_big(const uint8_t *p)
{
    return (uint32_t)p[0] << 24 | (uint32_t)p[1] << 16 | (uint32_t)p[2] << 8 | (uint32_t)p[3];
}

static uint32_t slow_crc(const uint8_t *p, size_t n)
{
    uint32_t c = 0xffffffffu;
    for (size_t i = 0; i < n; i++) {
        c ^= p[i];
        for (int bit = 0; bit < 8; bit++) c = c & 1 ? c >> 1 ^ 0xedb88320u : c >> 1;
    }
    return ~c;
}

/* The chunk of a type at p; returns its data and where the next one is. */
static const uint8_t *take_chunk(const uint8_t **p, const char *type, size_t *size)
{
    const uint8_t *const data = *p + 8;
    *size = load_big(*p);
    TEST_ASSERT_EQUAL_MEMORY(type, *p + 4, 4);
    TEST_ASSERT_EQUAL_HEX32(slow_crc(*p + 4, *size + 4), load_big(data + *size));
    *p = data + *size + 4;
    return data;
}

static void check_png(int width, int height)
{
    size_t const row = (size_t)width * 3, raw_size = (size_t)height * (row + 1);
    uint8_t *const pixels = malloc(row * (size_t)height), *const raw = malloc(raw_size);
    uint64_t state = (uint64_t)width * 1000 + (uint64_t)height;
    bvx_image image = {pixels, width, height};
    bvx_buffer b = {0};
    size_t size, n = 0;
    uint32_t a = 1, c = 0;
    for (size_t i = 0; i < row * (size_t)height; i++) pixels[i] = (uint8_t)(next_random(&state) & 0xff);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_png(ctx, &image, &b), bvx_last_message(ctx));

    const uint8_t *p = b.bytes + 8, *data;
    TEST_ASSERT_EQUAL_MEMORY("\x89PNG\r\n\x1a\n", b.bytes, 8);
    data = take_chunk(&p, "IHDR", &size);
    TEST_ASSERT_EQUAL_UINT64(13, size);
    TEST_ASSERT_EQUAL_UINT32((uint32_t)width, load_big(data));
    TEST_ASSERT_EQUAL_UINT32((uint32_t)height, load_big(data + 4));
    TEST_ASSERT_EQUAL_MEMORY("\x08\x02\0\0\0", data + 8, 5);
    data = take_chunk(&p, "IDAT", &size);
    TEST_ASSERT_TRUE((data[0] & 15) == 8 && (data[0] * 256 + data[1]) % 31 == 0 && (data[1] & 32) == 0);
    const uint8_t *d = data + 2;
    for (int last = 0; !last;) { /* stored blocks */
        size_t const length = (size_t)d[1] + 256 * (size_t)d[2];
        TEST_ASSERT_TRUE(d[0] <= 1 && (d[1] ^ d[3]) == 255 && (d[2] ^ d[4]) == 255 && n + length <= raw_size);
        last = d[0];
        memcpy(raw + n, d + 5, length);
        n += length;
        d += 5 + length;
    }
    TEST_ASSERT_EQUAL_UINT64(raw_size, n);
    for (size_t i = 0; i < n; i++) {
        a = (a + raw[i]) % 65521;
        c = (c + a) % 65521;
    }
    TEST_ASSERT_EQUAL_HEX32(c << 16 | a, load_big(d));
    TEST_ASSERT_TRUE(d + 4 == data + size);
    take_chunk(&p, "IEND", &size);
    TEST_ASSERT_EQUAL_UINT64(0, size);
    TEST_ASSERT_TRUE(p == b.bytes + b.size);
    for (int y = 0; y < height; y++) {
        TEST_ASSERT_EQUAL_UINT8(0, raw[(size_t)y * (row + 1)]);
        TEST_ASSERT_EQUAL_MEMORY(pixels + (size_t)y * row, raw + (size_t)y * (row + 1) + 1, row);
    }
    bvx_buffer_free(ctx, &b);
    free(pixels);
    free(raw);
}

static void test_write_png(void)
{
    check_png(1, 1);
    check_png(3, 5);
    check_png(100, 80);
    check_png(21844, 1); /* one byte filter and 65,532: below one block */
    check_png(1311, 50); /* 50 * 3934: several blocks, rows across their borders */
    check_png(21845, 2); /* a row of 65,536 */
    check_png(4369, 10); /* 10 * 13,108 = 131,080: two blocks and 10 bytes */
    check_png(1, 65535 / 4 * 4 + 3);
    check_png(4368, 5);  /* 5 * 13,105 = 65,525 */
    check_png(1456, 15); /* 15 * 4,369 = 65,535: a block to the last byte */
    check_png(1456, 30); /* two of them */
}

static void test_write_png_bytes(void) /* one pixel, as other programs read it */
{
    static const uint8_t want[] = {0x89, 0x50, 0x4e, 0x47, 0x0d, 0x0a, 0x1a, 0x0a, 0x00, 0x00, 0x00, 0x0d,
                                   0x49, 0x48, 0x44, 0x52, 0x00, 0x00, 0x00, 0x01, 0x00, 0x00, 0x00, 0x01,
                                   0x08, 0x02, 0x00, 0x00, 0x00, 0x90, 0x77, 0x53, 0xde, 0x00, 0x00, 0x00,
                                   0x0f, 0x49, 0x44, 0x41, 0x54, 0x78, 0x01, 0x01, 0x04, 0x00, 0xfb, 0xff,
                                   0x00, 0x0a, 0x14, 0x1e, 0x00, 0x68, 0x00, 0x3d, 0xe8, 0x0c, 0xbb, 0x83,
                                   0x00, 0x00, 0x00, 0x00, 0x49, 0x45, 0x4e, 0x44, 0xae, 0x42, 0x60, 0x82};
    uint8_t pixel[3] = {10, 20, 30};
    bvx_image const image = {pixel, 1, 1};
    bvx_buffer b = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_png(ctx, &image, &b));
    TEST_ASSERT_EQUAL_UINT64(sizeof want, b.size);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(want, b.bytes, sizeof want);
    bvx_buffer_free(ctx, &b);
}

static void test_write_png_refuses(void)
{
    uint8_t pixel[3] = {1, 2, 3};
    bvx_image image = {pixel, 1, 1};
    bvx_buffer b = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_png(NULL, &image, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_png(ctx, NULL, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_png(ctx, &image, NULL));
    image.width = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_png(ctx, &image, &b));
    image.width = 1;
    image.height = -1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_png(ctx, &image, &b));
    image.width = image.height = INT32_MAX;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_write_png(ctx, &image, &b));
    image.width = image.height = 16384; /* within the format, beyond this context's memory */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_BUDGET, bvx_write_png(ctx, &image, &b));
    image.pixels = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_png(ctx, &image, &b));
    TEST_ASSERT_NULL(b.bytes);
}

static void test_image_free(void)
{
    bvx_image image = {NULL, 5, 4};

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_alloc(ctx, BVXI_RESULT, 60, "pixels", &image.pixels));
    TEST_ASSERT_EQUAL_UINT64(60, bvx_memory_used(ctx));
    bvx_image_free(ctx, &image);
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(ctx));
    image.width = 4;
    bvx_image_free(ctx, &image);
    TEST_ASSERT_TRUE(image.width == 0 && image.height == 0);
    bvx_image_free(NULL, &image);
    bvx_image_free(ctx, NULL);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_write_npy);
    RUN_TEST(test_write_grid_refuses);
    RUN_TEST(test_write_grid_too_large);
    RUN_TEST(test_write_png);
    RUN_TEST(test_write_png_bytes);
    RUN_TEST(test_write_png_refuses);
    RUN_TEST(test_image_free);
    return UNITY_END();
}
