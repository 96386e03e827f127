/* dense_file_support.h - what the tests of grid files share: grids of random bits, files in blocks of their
 * exact size, and the checks that hold after every call. */
#ifndef TEST_DENSE_FILE_SUPPORT_H
#define TEST_DENSE_FILE_SUPPORT_H

#include "read_support.h"

#include <stdarg.h>

static inline bvx_grid random_grid(const double origin[3], const double spacing[3], const int32_t dims[3],
                                   const bvx_window *window, uint64_t seed)
{
    bvx_grid g = {0};
    bvx_lattice l;

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_grid_create(ctx, &l, window, &g), bvx_last_message(ctx));
    for (int32_t z = 0; z < g.size[2]; z++)
        for (int32_t y = 0; y < g.size[1]; y++)
            for (int32_t x = 0; x < g.size[0]; x++) bvx_grid_set(&g, x, y, z, next_random(&seed) % 3 == 0);
    return g;
}

/* Bits beyond the rows are 0, and the struct says what a grid of the library says. */
static inline void check_valid_grid(const bvx_grid *g)
{
    bvx_window w;

    memcpy(w.low, g->low, sizeof w.low);
    memcpy(w.size, g->size, sizeof w.size);
    TEST_ASSERT_EQUAL_INT32((g->size[0] + 63) / 64, g->words_per_row);
    TEST_ASSERT_TRUE(bvx_grid_bound(&g->lattice, &w) != 0 &&
                     g->word_capacity >= bvx_grid_bound(&g->lattice, &w));
    if ((g->size[0] & 63) != 0)
        for (size_t r = 0; r < (size_t)g->size[1] * (size_t)g->size[2]; r++)
            TEST_ASSERT_EQUAL_HEX64(0, g->words[(r + 1) * (size_t)g->words_per_row - 1] >> (g->size[0] & 63));
}

/* Read from a block that ends where the file ends; on failure the struct is as it was and nothing is kept. */
static inline bvx_status read_grid_file(const void *bytes, size_t size, int32_t format,
                                        const bvx_window *window, bvx_grid *g)
{
    static const bvx_grid empty = {0};
    uint64_t const used = bvx_memory_used(ctx);
    char *const copy = malloc(size + 1);

    memset(g, 0, sizeof *g);
    memcpy(copy + 1, bytes, size); /* an odd address */
    bvx_status const status = bvx_read_grid(ctx, copy + 1, size, format, window, g);
    free(copy);
    if (status == BVX_OK) {
        check_valid_grid(g);
        TEST_ASSERT_TRUE(g->owned == 1 && bvx_memory_used(ctx) == used + g->word_capacity * 8);
    } else {
        TEST_ASSERT_EQUAL_MEMORY(&empty, g, sizeof empty);
        TEST_ASSERT_EQUAL_UINT64(used, bvx_memory_used(ctx));
        TEST_ASSERT_TRUE(strlen(bvx_last_message(ctx)) > 10 && strchr(bvx_last_message(ctx), '\n') == NULL);
    }
    return status;
}

static inline void read_good_grid(const void *bytes, size_t size, int32_t format, const bvx_window *window,
                                  bvx_grid *g)
{
    bvx_status const status = read_grid_file(bytes, size, format, window, g);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(ctx));
}

static inline void check_grid_refused(const void *bytes, size_t size, int32_t format, bvx_status status,
                                      const char *words)
{
    bvx_grid g;
    bvx_status const got = read_grid_file(bytes, size, format, NULL, &g);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(status, got, got == BVX_OK ? words : bvx_last_message(ctx));
    if (strstr(bvx_last_message(ctx), words) == NULL)
        TEST_ASSERT_EQUAL_STRING_MESSAGE(words, bvx_last_message(ctx), "the message lacks these words");
}

/* The lattice of a file: origin and spacing bit for bit, the whole of it. */
static inline void check_file_box(const bvx_grid *g, double x, double y, double z, double sx, double sy,
                                  double sz, int32_t nx, int32_t ny, int32_t nz)
{
    double const want[6] = {x, y, z, sx, sy, sz};
    int32_t const dims[3] = {nx, ny, nz};

    for (int a = 0; a < 3; a++) {
        TEST_ASSERT_TRUE_MESSAGE(want[a] == g->lattice.origin[a], "origin");
        TEST_ASSERT_TRUE_MESSAGE(want[a + 3] == g->lattice.spacing[a], "spacing");
        TEST_ASSERT_EQUAL_INT32(dims[a], g->lattice.dims[a]);
        TEST_ASSERT_EQUAL_INT32(dims[a], g->size[a]);
        TEST_ASSERT_EQUAL_INT32(0, g->low[a]);
    }
}

/* Voxels of part of the file, counted from its first one. */
static inline void check_same_bits(const bvx_grid *want, const bvx_grid *got, const int32_t low[3])
{
    for (int32_t z = 0; z < got->size[2]; z++)
        for (int32_t y = 0; y < got->size[1]; y++)
            for (int32_t x = 0; x < got->size[0]; x++)
                TEST_ASSERT_EQUAL_INT(bvx_grid_get(want, x + low[0], y + low[1], z + low[2]),
                                      bvx_grid_get(got, x, y, z));
}

/* Read random windows of a file: each is the whole's, cropped. */
static inline void check_windows(const void *bytes, size_t size, int32_t format, const bvx_grid *whole,
                                 uint64_t seed)
{
    for (int i = 0; i < 12; i++) {
        bvx_window w;
        bvx_grid g;
        for (int a = 0; a < 3; a++) {
            w.size[a] = 1 + (int32_t)(next_random(&seed) >> 16) % whole->size[a];
            w.size[a] = w.size[a] < 1 ? 1 : w.size[a];
            w.low[a] = (int32_t)((next_random(&seed) >> 16) % (uint64_t)(whole->size[a] - w.size[a] + 1));
        }
        read_good_grid(bytes, size, format, &w, &g);
        TEST_ASSERT_EQUAL_INT32_ARRAY(w.low, g.low, 3);
        TEST_ASSERT_EQUAL_INT32_ARRAY(w.size, g.size, 3);
        TEST_ASSERT_EQUAL_MEMORY(&whole->lattice, &g.lattice, sizeof g.lattice);
        check_same_bits(whole, &g, w.low);
        bvx_grid_free(ctx, &g);
    }
}

/* Write and read back: the same bits; the lattice is the window's box, bit for bit. Then windows of it, more
 * threads, the caller's own words. keeps: 1 when the format keeps the lattice. */
static inline void check_grid_round(int32_t format, const bvx_grid *g, int keeps)
{
    static const int32_t zero[3] = {0, 0, 0};
    bvx_buffer b = {0};
    bvx_grid got;

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_grid(ctx, g, format, &b), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(b.size, b.capacity);
    read_good_grid(b.bytes, (size_t)b.size, format, NULL, &got);
    check_file_box(&got, keeps ? g->lattice.origin[0] + g->low[0] * g->lattice.spacing[0] : 0,
                   keeps ? g->lattice.origin[1] + g->low[1] * g->lattice.spacing[1] : 0,
                   keeps ? g->lattice.origin[2] + g->low[2] * g->lattice.spacing[2] : 0,
                   keeps ? g->lattice.spacing[0] : 1, keeps ? g->lattice.spacing[1] : 1,
                   keeps ? g->lattice.spacing[2] : 1, g->size[0], g->size[1], g->size[2]);
    check_same_bits(g, &got, zero);
    check_windows(b.bytes, (size_t)b.size, format, &got, 99);
    size_t const words = (size_t)got.words_per_row * (size_t)got.size[1] * (size_t)got.size[2];
    bvx_grid own = {0};
    own.words = malloc(words * 8);
    memset(own.words, 0xa5, words * 8);
    own.word_capacity = words;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_read_grid(ctx, b.bytes, b.size, format, NULL, &own),
                                    bvx_last_message(ctx));
    TEST_ASSERT_TRUE(own.owned == 0 && memcmp(own.words, got.words, words * 8) == 0);
    TEST_ASSERT_EQUAL_MEMORY(&got.lattice, &own.lattice, sizeof own.lattice);
    own.word_capacity = words - 1;
    bvx_grid const before = own;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_read_grid(ctx, b.bytes, b.size, format, NULL, &own));
    TEST_ASSERT_EQUAL_MEMORY(&before, &own, sizeof own);
    free(own.words);
    bvx_grid_free(ctx, &got);
    bvx_buffer_free(ctx, &b);
}

/* Sides about the ends of words, stretched voxels, windows that do not begin at 0. */
static inline void check_grid_rounds(int32_t format, int keeps)
{
    static const int32_t sides[][3] = {{1, 1, 1},   {63, 5, 3},  {64, 3, 7},  {65, 4, 2},
                                       {127, 2, 3}, {128, 1, 5}, {129, 3, 1}, {7, 67, 5},
                                       {3, 2, 130}, {600, 3, 2}, {2, 3, 700}};
    static const double origin[3] = {0.1, -17.3, 1e6 / 3}, spacing[3] = {0.3, 1.0 / 3, 7e-3};

    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++) {
        bvx_grid g = random_grid(origin, spacing, sides[i], NULL, 7 + i);
        check_grid_round(format, &g, keeps);
        bvx_grid_free(ctx, &g);
    }
    static const int32_t dims[3] = {150, 40, 30};
    static const bvx_window window = {{61, 3, 11}, {70, 9, 5}};
    bvx_grid g = random_grid(origin, spacing, dims, &window, 5);
    check_grid_round(format, &g, keeps);
    bvx_grid_free(ctx, &g);
}

/* The same bits from one thread, several, and the portable code. */
static inline void check_same_everywhere(const void *bytes, size_t size, int32_t format, const bvx_grid *want)
{
    static const int32_t zero[3] = {0, 0, 0};
    bvx_context *const plain = ctx;

    for (int32_t threads = 1; threads <= 4; threads++)
        for (int32_t cpu = BVX_CPU_BEST; cpu <= BVX_CPU_PORTABLE; cpu++) {
            bvx_context_options o = {.struct_size = sizeof o};
            bvx_grid g;
            o.threads = threads;
            o.cpu = cpu;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
            read_good_grid(bytes, size, format, NULL, &g);
            check_same_bits(want, &g, zero);
            bvx_grid_free(ctx, &g);
            bvx_context_destroy(ctx);
        }
    ctx = plain;
}

/* Damaged files: an error or a grid, and memory of at most eight times the file. */
static inline bvx_status read_damaged(const void *bytes, size_t size, int32_t format)
{
    bvx_grid g;

    bvx_memory_reset_peak(ctx);
    uint64_t const before = bvx_memory_used(ctx);
    bvx_status const status = read_grid_file(bytes, size, format, NULL, &g);
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - before <= 8 * size + 64);
    TEST_ASSERT_TRUE(status == BVX_OK || status == BVX_ERR_FORMAT || status == BVX_ERR_RANGE ||
                     status == BVX_ERR_UNSUPPORTED);
    bvx_grid_free(ctx, &g);
    return status;
}

/* Cut at every byte: refused, but for the last `spare` bytes, which say nothing. */
static inline void check_every_cut(const void *bytes, size_t size, int32_t format, size_t spare)
{
    for (size_t n = 0; n < size; n++) {
        bvx_status const status = read_damaged(bytes, n, format);
        if (n + spare < size) TEST_ASSERT_TRUE_MESSAGE(status != BVX_OK, "a file cut short was read");
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_damaged(bytes, size, format));
}

/* Every run of digits within the first `head` bytes replaced in turn;
 * returns how many files were read all the same. */
static inline int check_every_number(const void *bytes, size_t size, size_t head, int32_t format)
{
    static const char *const with[] = {
        "0", "1", "-1", "2147483648", "4294967295", "18446744073709551616", "1e400", "nan", ""};
    const char *const text = bytes;
    int good = 0;

    for (size_t i = 0; i < head;) {
        size_t n = 0;
        while (i + n < head && text[i + n] >= '0' && text[i + n] <= '9') n++;
        for (size_t k = 0; n > 0 && k < sizeof with / sizeof with[0]; k++) {
            size_t const length = strlen(with[k]);
            char *const changed = malloc(size + 24);
            memcpy(changed, text, i);
            memcpy(changed + i, with[k], length);
            memcpy(changed + i + length, text + i + n, size - i - n);
            good += read_damaged(changed, size - n + length, format) == BVX_OK;
            free(changed);
        }
        i += n + 1;
    }
    return good;
}

/* Bytes of the file changed at random. */
static inline void check_random_damage(const void *bytes, size_t size, int32_t format, int times)
{
    uint64_t state = 12345;
    char *const changed = malloc(size);

    for (int i = 0; i < times; i++) {
        memcpy(changed, bytes, size);
        for (uint64_t k = next_random(&state) % 4 + 1; k > 0; k--)
            changed[(next_random(&state) >> 16) % size] = (char)(next_random(&state) >> 24 & 0xff);
        read_damaged(changed, size, format);
    }
    free(changed);
}

/* A file put together by hand. */
typedef struct hand_file {
    uint8_t bytes[8192];
    size_t size;
} hand_file;

static inline void hand_text(hand_file *f, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    f->size += (size_t)vsnprintf((char *)f->bytes + f->size, sizeof f->bytes - f->size, format, args);
    va_end(args);
    TEST_ASSERT_TRUE(f->size < sizeof f->bytes);
}

/* A number of `size` bytes whose bits are given. */
static inline void hand_number(hand_file *f, uint64_t bits, int size, int big)
{
    for (int i = 0; i < size; i++)
        f->bytes[f->size++] = (uint8_t)(bits >> 8 * (big ? size - 1 - i : i) & 0xff);
    TEST_ASSERT_TRUE(f->size < sizeof f->bytes);
}

#endif
