/* test_bvx.c - our own grid files: against a plain writer of the layout, in parts, in windows, damaged in
 * every byte, and with damage whose checksums are right. */
#include "packed_support.h"

#include <math.h>

enum { HEAD = 128, SLICE = 24 };

/* ---- a plain writer: one voxel, one byte at a time ---- */

static void put_bytes(uint8_t *p, uint64_t v, int n)
{
    for (int i = 0; i < n; i++) p[i] = (uint8_t)(v >> 8 * i & 0xff);
}

static uint64_t get_bytes(const uint8_t *p, int n)
{
    uint64_t v = 0;
    for (int i = n; i-- > 0;) v = v << 8 | p[i];
    return v;
}

static void put_double(uint8_t *p, double v)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    put_bytes(p, bits, 8);
}

static void plain_head(uint8_t *p, const bvx_lattice *l, const int32_t low[3], const int32_t size[3])
{
    memset(p, 0, HEAD);
    memcpy(p,
           "\x89"
           "BVX\r\n\x1a\n",
           8);
    put_bytes(p + 8, 1, 4);
    put_bytes(p + 12, 128, 4);
    for (int a = 0; a < 3; a++) {
        put_double(p + 16 + 8 * a, l->origin[a]);
        put_double(p + 40 + 8 * a, l->spacing[a]);
        put_bytes(p + 64 + 4 * a, (uint64_t)l->dims[a], 4);
    }
    put_bytes(p + 76, (uint64_t)l->fraction_bits, 4);
    put_bytes(p + 80, (uint64_t)low[0], 4);
    put_bytes(p + 84, (uint64_t)low[1], 4);
    put_bytes(p + 88, (uint64_t)size[0], 4);
    put_bytes(p + 92, (uint64_t)size[1], 4);
    put_bytes(p + 96, (uint64_t)low[2], 4);
    put_bytes(p + 100, (uint64_t)size[2], 4);
    put_bytes(p + 120, bvx_hash(p, 120, 0), 8);
}

static size_t plain_length(uint8_t *p, uint64_t v)
{
    size_t n = 0;
    do {
        p[n++] = (uint8_t)(v % 128 + (v >= 128 ? 128 : 0));
        v /= 128;
    } while (v != 0);
    return n;
}

/* The frame of a file: the seed of its slices. */
static uint64_t frame_of(const uint8_t *head)
{
    return bvx_hash(head + 16, 80, 0);
}

static void seal_slice(uint8_t *p, uint64_t frame)
{
    put_bytes(p, bvx_hash(p + 8, 16 + (size_t)get_bytes(p + 16, 8), frame), 8);
}

static size_t plain_slice(uint8_t *p, const bvx_grid *g, int32_t k, uint64_t frame)
{
    size_t const raw = (size_t)g->words_per_row * 8 * (size_t)g->size[1];
    uint8_t *const runs = malloc(2 * (size_t)g->size[0] * (size_t)g->size[1] + 16);
    size_t n = 0;
    uint64_t length = 0;
    int value = 0;

    for (int32_t y = 0; y < g->size[1]; y++)
        for (int32_t x = 0; x < g->size[0]; x++) {
            if (bvx_grid_get(g, x, y, k) != value) {
                n += plain_length(runs + n, length);
                length = 0;
                value = !value;
            }
            length++;
        }
    n += plain_length(runs + n, length);
    put_bytes(p + 8, (uint64_t)(g->low[2] + k), 4);
    put_bytes(p + 12, n < raw, 4);
    put_bytes(p + 16, n < raw ? n : raw, 8);
    if (n < raw) {
        memcpy(p + SLICE, runs, n);
    } else {
        n = raw;
        memset(p + SLICE, 0, raw);
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->size[0]; x++)
                if (bvx_grid_get(g, x, y, k))
                    p[SLICE + (size_t)y * (size_t)g->words_per_row * 8 + (size_t)x / 8] |=
                        (uint8_t)(1 << x % 8);
    }
    seal_slice(p, frame);
    free(runs);
    return SLICE + n;
}

static bvx_buffer plain_file(const bvx_grid *g)
{
    bvx_buffer b = {0};
    b.bytes = malloc(HEAD + (size_t)g->size[2] * (SLICE + (size_t)g->words_per_row * 8 * (size_t)g->size[1]));
    plain_head(b.bytes, &g->lattice, g->low, g->size);
    b.size = HEAD;
    for (int32_t k = 0; k < g->size[2]; k++) b.size += plain_slice(b.bytes + b.size, g, k, frame_of(b.bytes));
    return b;
}

/* ---- whole files ---- */

static void check_file(const bvx_lattice *lattice, const bvx_window *window, int kind)
{
    bvx_grid g, back;
    bvx_buffer b = {0};

    grid_of(&g, lattice, window, kind, (uint64_t)lattice->dims[0] + 31);
    bvx_buffer plain = plain_file(&g);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_BVX, &b));
    TEST_ASSERT_EQUAL_UINT64(plain.size, b.size);
    TEST_ASSERT_EQUAL_MEMORY(plain.bytes, b.bytes, (size_t)b.size);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_packed(b.bytes, (size_t)b.size, BVX_FORMAT_BVX, NULL, &back),
                                    bvx_last_message(ctx));
    check_same_grid(&g, &back);
    bvx_grid_free(ctx, &back);
    check_windows(&b, BVX_FORMAT_BVX, &g, 12);
    free(plain.bytes);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

static void test_bvx_of_many_shapes(void)
{
    static const int32_t sides[] = {1, 2, 63, 64, 65, 127, 128, 129, 200};

    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++)
        for (int kind = 0; kind < KINDS; kind++) {
            bvx_lattice const a = lattice_of(sides[i], 5, 3, -1.5, 0.1, 1.0 / 3, 7e-5);
            bvx_lattice const b = lattice_of(3, sides[i], 2, 1e9, 2, 2, 2);
            bvx_lattice const c = lattice_of(2, 1, sides[i], 0, 1, 1e-300, 1e300);
            check_file(&a, NULL, kind);
            check_file(&b, NULL, kind);
            check_file(&c, NULL, kind);
        }
}

static void test_bvx_of_windows(void)
{
    bvx_lattice const l = lattice_of(150, 90, 40, 3.25, 0.5, 0.25, 1.75);
    uint64_t state = 99;
    for (int i = 0; i < 60; i++) {
        bvx_window const w = random_window(l.dims, &state);
        check_file(&l, &w, i % KINDS);
    }
}

/* A small file written by hand: other makers can hold theirs against it. */
static void test_bvx_bytes(void)
{
    static const uint8_t slices[] = {0x77, 0x65, 0xeb, 0xb6, 0x68, 0xe2, 0xce, 0xa1, 4,    0, 0, 0, 1,
                                     0,    0,    0,    3,    0,    0,    0,    0,    0,    0, 0, 0, 2,
                                     4,    0xa3, 0xb6, 0x80, 0x4e, 0x3b, 0xb0, 0xbf, 0x20, 5, 0, 0, 0,
                                     1,    0,    0,    0,    1,    0,    0,    0,    0,    0, 0, 0, 6};
    static const uint8_t check[] = {0xbd, 0x44, 0x25, 0x3c, 0x86, 0xf7, 0xe9, 0xd4}; /* of the head */
    bvx_lattice const l = lattice_of(3, 2, 9, 1, 1, 1, 1);
    bvx_window const w = window_of(0, 0, 4, 3, 2, 2);
    uint8_t file[HEAD + sizeof slices];
    bvx_grid g;
    bvx_buffer b = {0};

    plain_head(file, &l, w.low, w.size);
    memcpy(file + HEAD, slices, sizeof slices);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(check, file + 120, 8);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_packed(file, sizeof file, BVX_FORMAT_BVX, NULL, &g),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_HEX64(3, g.words[0]);
    TEST_ASSERT_EQUAL_HEX64(0, g.words[1] | g.words[2] | g.words[3]);
    TEST_ASSERT_EQUAL_INT32(4, g.low[2]);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_BVX, &b));
    TEST_ASSERT_EQUAL_UINT64(sizeof file, b.size);
    TEST_ASSERT_EQUAL_HEX8_ARRAY(file, b.bytes, sizeof file);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

static void test_bvx_workers_words_limits_and_cancel(void)
{
    bvx_lattice const l = lattice_of(300, 100, 60, 1, 1, 2, 3);
    bvx_grid g;
    bvx_buffer b = {0};

    for (int kind = KIND_NOISE; kind < KINDS; kind++) {
        grid_of(&g, &l, NULL, kind, 5);
        check_workers(&g, BVX_FORMAT_BVX);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_BVX, &b));
        check_own_words(&g, &b, BVX_FORMAT_BVX);
        check_memory_limits(&g, &b, BVX_FORMAT_BVX);
        TEST_ASSERT_TRUE(check_cancelled_reading(&b, BVX_FORMAT_BVX) >= 4);
        TEST_ASSERT_TRUE(check_cancelled_writing(&g, BVX_FORMAT_BVX) >= 4);
        bvx_buffer_free(ctx, &b);
        bvx_grid_free(ctx, &g);
    }
}

/* Bits past a row's end, which no grid of ours has, do not reach the file. */
static void test_bvx_ignores_padding(void)
{
    for (int kind = KIND_NOISE; kind <= KIND_SPARSE; kind++) { /* words, runs */
        bvx_lattice const l = lattice_of(70, 4, 3, 0, 1, 1, 1);
        bvx_grid g;
        bvx_buffer clean = {0}, b = {0};
        grid_of(&g, &l, NULL, kind, 8);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_BVX, &clean));
        for (size_t i = 1; i < grid_words(&g); i += 2) g.words[i] |= ~UINT64_C(0) << 6;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_BVX, &b));
        TEST_ASSERT_EQUAL_UINT64(clean.size, b.size);
        TEST_ASSERT_EQUAL_MEMORY(clean.bytes, b.bytes, (size_t)b.size);
        bvx_buffer_free(ctx, &b);
        bvx_buffer_free(ctx, &clean);
        bvx_grid_free(ctx, &g);
    }
}

/* ---- in parts ---- */

static void test_bvx_in_parts(void)
{
    bvx_lattice const l = lattice_of(100, 40, 50, 2, 1, 2, 3);
    uint64_t state = 17;

    for (int i = 0; i < 40; i++) {
        bvx_window const w = random_window(l.dims, &state);
        bvx_grid g, part;
        bvx_buffer whole = {0}, b = {0};
        grid_of(&g, &l, &w, i % KINDS, (uint64_t)i);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_BVX, &whole));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_head(ctx, &l, &w, &b));
        TEST_ASSERT_EQUAL_UINT64(HEAD, b.size);
        TEST_ASSERT_EQUAL_MEMORY(whole.bytes, b.bytes, HEAD);
        uint64_t at = b.size;
        for (int32_t z = 0; z < w.size[2];) {
            bvx_window v = w;
            v.low[2] += z;
            v.size[2] = 1 + (int32_t)((next_random(&state) >> 20) % (uint64_t)(w.size[2] - z));
            memset(&part, 0, sizeof part);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, &v, &part));
            memcpy(part.words, g.words + (size_t)z * (size_t)g.words_per_row * (size_t)g.size[1],
                   8 * grid_words(&part));
            bvx_buffer_free(ctx, &b);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_slices(ctx, &part, &b));
            TEST_ASSERT_TRUE(at + b.size <= whole.size);
            TEST_ASSERT_EQUAL_MEMORY(whole.bytes + at, b.bytes, (size_t)b.size);
            at += b.size;
            z += v.size[2];
            bvx_grid_free(ctx, &part);
        }
        TEST_ASSERT_EQUAL_UINT64(whole.size, at);
        bvx_buffer_free(ctx, &b);
        bvx_buffer_free(ctx, &whole);
        bvx_grid_free(ctx, &g);
    }
}

static void test_bvx_parts_refuse(void)
{
    bvx_lattice l = lattice_of(10, 4, 5, 2, 1, 2, 3), bad = l;
    bvx_window const outside = window_of(0, 0, 3, 10, 4, 3);
    bvx_grid g, none;
    bvx_buffer b = {0}, whole = {0};
    memset(&none, 0, sizeof none);
    grid_of(&g, &l, NULL, KIND_NOISE, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_head(NULL, &l, NULL, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_head(ctx, NULL, NULL, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_head(ctx, &l, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_head(ctx, &l, &outside, &b));
    bad.spacing[1] = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_head(ctx, &bad, NULL, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_slices(NULL, &g, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_slices(ctx, NULL, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_slices(ctx, &none, &b));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_slices(ctx, &g, NULL));
    TEST_ASSERT_NULL(b.bytes);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_head(ctx, &l, NULL, &whole));
    TEST_ASSERT_TRUE(whole.capacity > 0);
    {
        bvx_buffer foreign = {whole.bytes, 1, 0};

        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_head(ctx, &l, NULL, &foreign));
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_slices(ctx, &g, &foreign));
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_grid(ctx, &g, BVX_FORMAT_BVX, &foreign));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "file brings bytes"));
    }
    bvx_buffer_free(ctx, &whole);
    bvx_grid_free(ctx, &g);
}

/* ---- damage ---- */

static void make_small(bvx_grid *g, bvx_buffer *b)
{
    bvx_lattice const l = lattice_of(70, 6, 7, 2, 1, 2, 3);
    bvx_window const w = window_of(1, 2, 3, 66, 4, 4);
    grid_of(g, &l, &w, KIND_SPARSE, 3);
    for (int32_t y = 0; y < 4; y++) /* one slice as words */
        for (int32_t x = 0; x < 66; x++) bvx_grid_set(g, x, y, 2, (x * 7 + y * 3) % 5 % 2);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, g, BVX_FORMAT_BVX, b));
}

/* Where slice k stands. */
static uint8_t *slice_at(const bvx_buffer *b, int k)
{
    uint8_t *p = b->bytes + HEAD;
    for (; k > 0; k--) p += SLICE + get_bytes(p + 16, 8);
    return p;
}

static void test_bvx_notices_every_byte(void)
{
    bvx_grid g, back;
    bvx_buffer b = {0};

    make_small(&g, &b);
    TEST_ASSERT_EQUAL_UINT8(1, slice_at(&b, 1)[12]);
    TEST_ASSERT_EQUAL_UINT8(0, slice_at(&b, 2)[12]);
    check_every_cut(&b, BVX_FORMAT_BVX);
    for (size_t i = 0; i < b.size; i++)
        for (int change = 1; change < 256; change += change < 128 && i >= HEAD ? change : 1) {
            b.bytes[i] ^= (uint8_t)change;
            bvx_status const status = read_packed(b.bytes, (size_t)b.size, BVX_FORMAT_BVX, NULL, &back);
            TEST_ASSERT_TRUE(status == BVX_ERR_FORMAT || (i >= 8 && i < 12 && status == BVX_ERR_UNSUPPORTED));
            b.bytes[i] ^= (uint8_t)change;
        }
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

static void test_bvx_messages(void)
{
    bvx_grid g;
    bvx_buffer b = {0};

    make_small(&g, &b);
    size_t const n = (size_t)b.size;
    uint8_t *const longer = malloc(n + 1);
    memcpy(longer, b.bytes, n);
    longer[n] = 0;
    check_packed_refused(longer, n + 1, BVX_FORMAT_BVX, BVX_ERR_FORMAT, "1 bytes after the last slice");
    check_packed_refused("BVX file", 8, BVX_FORMAT_BVX, BVX_ERR_FORMAT, "does not begin as .bvx files do");
    memcpy(longer + 4, "\n\x1a\n\1\0\0\0", 7); /* \r\n became \n */
    check_packed_refused(longer, n, BVX_FORMAT_BVX, BVX_ERR_FORMAT, "a transfer took the file for text");
    memcpy(longer, b.bytes, n);
    longer[8] = 3;
    check_packed_refused(longer, n, BVX_FORMAT_BVX, BVX_ERR_UNSUPPORTED,
                         "of version 3, this library reads version 1");
    memcpy(longer, b.bytes, n);
    longer[20] ^= 1;
    check_packed_refused(longer, n, BVX_FORMAT_BVX, BVX_ERR_FORMAT, "the head is damaged");
    memcpy(longer, b.bytes, n);
    longer[slice_at(&b, 3) - b.bytes + SLICE] ^= 1;
    longer[slice_at(&b, 2) - b.bytes + SLICE + 9] ^= 64;
    /* the first one */
    check_packed_refused(longer, n, BVX_FORMAT_BVX, BVX_ERR_FORMAT, "slice z 5: the slice is damaged");
    free(longer);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

/* Numbers of the head replaced, with a right checksum: never more memory than the file can ask for. */
static void test_bvx_head_replaced(void)
{
    static const uint64_t numbers[] = {0, 1, 0xffffffffu, 0x80000000u, 0x7fffffffu, 1 << 25, 3, 67};
    static const int at[] = {12, 64, 68, 72, 76, 80, 84, 88, 92, 96, 100, 104, 108, 116};
    bvx_grid g, back;
    bvx_buffer b = {0};
    int read = 0;

    make_small(&g, &b);
    uint8_t *const file = malloc((size_t)b.size);
    for (size_t i = 0; i < sizeof at / sizeof at[0]; i++)
        for (size_t k = 0; k < sizeof numbers / sizeof numbers[0]; k++) {
            memcpy(file, b.bytes, (size_t)b.size);
            if (get_bytes(file + at[i], 4) == numbers[k]) continue;
            put_bytes(file + at[i], numbers[k], 4);
            put_bytes(file + 120, bvx_hash(file, 120, 0), 8);
            for (int s = 0; s < 4; s++) seal_slice(file + (slice_at(&b, s) - b.bytes), frame_of(file));
            bvx_memory_reset_peak(ctx);
            bvx_status const status = read_packed(file, (size_t)b.size, BVX_FORMAT_BVX, NULL, &back);
            TEST_ASSERT_TRUE(bvx_memory_peak(ctx) - bvx_memory_used(ctx) <= 4 * b.size);
            /* a lattice that is as good as the one before; reserved fields are all 0 */
            if (status == BVX_OK) {
                TEST_ASSERT_TRUE(at[i] < 88 || at[i] == 96);
                read++;
            } else {
                TEST_ASSERT_TRUE(status == BVX_ERR_FORMAT || status == BVX_ERR_RANGE);
            }
            bvx_grid_free(ctx, &back);
        }
    TEST_ASSERT_TRUE(read > 5);
    for (int i = 0; i < 6; i++) { /* doubles that are none */
        static const double bad[] = {0.0, -1.0, HUGE_VAL, -HUGE_VAL};
        for (int k = 0; k < 4; k++) {
            if (i < 3 && k < 2) continue; /* any finite origin is good */
            memcpy(file, b.bytes, (size_t)b.size);
            put_double(file + 16 + 8 * i, bad[k]);
            put_bytes(file + 120, bvx_hash(file, 120, 0), 8);
            bvx_status const status = read_packed(file, (size_t)b.size, BVX_FORMAT_BVX, NULL, &back);
            TEST_ASSERT_TRUE(status == BVX_ERR_FORMAT || status == BVX_ERR_RANGE);
        }
    }
    free(file);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

/* A file of one slice with these bytes, all checksums right. */
static size_t one_slice(uint8_t *file, const bvx_lattice *l, uint32_t z, uint32_t encoding, const void *bytes,
                        size_t n)
{
    static const int32_t low[3] = {0, 0, 0};

    plain_head(file, l, low, l->dims);
    put_bytes(file + HEAD + 8, z, 4);
    put_bytes(file + HEAD + 12, encoding, 4);
    put_bytes(file + HEAD + 16, n, 8);
    memcpy(file + HEAD + SLICE, bytes, n);
    seal_slice(file + HEAD, frame_of(file));
    return HEAD + SLICE + n;
}

static void check_slice(int32_t nx, int32_t ny, uint32_t z, uint32_t encoding, const void *bytes, size_t n,
                        const char *words)
{
    bvx_lattice const l = lattice_of(nx, ny, 1, 0, 1, 1, 1);
    uint8_t file[HEAD + SLICE + 128];
    bvx_grid g;
    size_t const size = one_slice(file, &l, z, encoding, bytes, n);

    if (words != NULL) {
        check_packed_refused(file, size, BVX_FORMAT_BVX, BVX_ERR_FORMAT, words);
        return;
    }
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_packed(file, size, BVX_FORMAT_BVX, NULL, &g),
                                    bvx_last_message(ctx));
    bvx_grid_free(ctx, &g);
}

static void test_bvx_slices_with_right_checksums(void)
{
    static const char run[] = "a length of a run", total[] = "do not add up", z[] = "in place of z 0";

    check_slice(4, 3, 0, 1, "\14", 1, NULL);
    check_slice(4, 3, 0, 1, "\0\14", 2, NULL);
    check_slice(4, 3, 0, 1, "\5\3\4", 3, NULL);
    check_slice(4, 3, 0, 1, "\1\1\1\1\1\1\1\1\1\1\1\1", 12, NULL);
    check_slice(300, 1, 0, 1, "\xac\2", 2, NULL);
    check_slice(2, 1, 0, 1, "\0\1\1", 3, NULL); /* a reader takes runs that are no shorter than words too */
    check_slice(4, 3, 0, 1, "\13", 1, total);
    check_slice(4, 3, 0, 1, "\15", 1, total);
    check_slice(4, 3, 0, 1, "\5\3\5", 3, total);
    check_slice(4, 3, 0, 1, "\5\3\4\1", 4, total);
    check_slice(4, 3, 0, 1, "\0", 1, total);
    check_slice(4, 3, 0, 1, "", 0, "cannot hold 1 slices");
    check_slice(4, 3, 0, 1, "\14\0", 2, run);   /* nothing behind the end */
    check_slice(4, 3, 0, 1, "\0\0\14", 3, run); /* 0 in the middle */
    check_slice(4, 3, 0, 1, "\214\0", 2, run);  /* longer than it needs to be */
    check_slice(300, 1, 0, 1, "\xac", 1, run);  /* cut */
    check_slice(300, 1, 0, 1, "\xac\x82\x80\x80\x80\x80\x80\x80", 8, run);
    check_slice(300, 1, 0, 1, "\xac\x82\x80\x80\x80\x80\x80\x80\1", 9, run); /* 9 bytes */
    check_slice(300, 1, 0, 1, "\xff\xff\xff\xff\xff\xff\xff\x7f", 8, total); /* 2^56 - 1 */
    check_slice(4, 1, 0, 0, "\17\0\0\0\0\0\0\0", 8, NULL);
    check_slice(4, 1, 0, 0, "\37\0\0\0\0\0\0\0", 8, "past the end of a row");
    check_slice(4, 1, 0, 0, "\0\0\0\0\0\0\0\x80", 8, "past the end of a row");
    check_slice(4, 2, 0, 0, "\1\0\0\0\0\0\0\0\1\0\1\0\0\0\0\0", 16, "past the end of a row");
    check_slice(4, 2, 0, 0, "\1\0\0\0\0\0\0\0", 8, "its words are 16");
    check_slice(4, 2, 0, 0, "\1\0\0\0\0\0\0\0\1\0\0\0\0\0\0\0\0", 17, "its words are 16");
    check_slice(4, 3, 0, 2, "\14", 1, "encoding 2");
    check_slice(4, 3, 1, 1, "\14", 1, z);
    check_slice(4, 3, 0xffffffffu, 1, "\14", 1, z);
}

/* Slices in another order, of another lattice or another window are not this file's. */
static void test_bvx_mixed_parts(void)
{
    bvx_lattice const l = lattice_of(10, 4, 6, 2, 1, 2, 3), shifted = lattice_of(10, 4, 6, 3, 1, 2, 3);
    bvx_window const w = window_of(2, 1, 1, 5, 2, 2);
    bvx_window const parts[5] = {{{2, 1, 1}, {5, 2, 2}},
                                 {{3, 1, 1}, {5, 2, 2}},
                                 {{2, 1, 2}, {5, 2, 2}},
                                 {{2, 1, 1}, {5, 2, 1}},
                                 {{2, 0, 1}, {5, 3, 2}}};
    static const char *const words[6] = {NULL,
                                         "of another lattice or window",
                                         "slice z 2 in place of z 1",
                                         "cannot hold 2 slices",
                                         "of another lattice or window",
                                         "of another lattice or window"};

    for (int i = 0; i < 6; i++) {
        bvx_grid g, back;
        bvx_buffer head = {0}, b = {0};
        uint8_t file[1000];
        grid_of(&g, i < 5 ? &l : &shifted, &parts[i < 5 ? i : 0], KIND_EMPTY, 1);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_head(ctx, &l, &w, &head));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_slices(ctx, &g, &b));
        memcpy(file, head.bytes, HEAD);
        memcpy(file + HEAD, b.bytes, (size_t)b.size);
        size_t const size = HEAD + (size_t)b.size;
        bvx_buffer_free(ctx, &head);
        bvx_buffer_free(ctx, &b);
        bvx_grid_free(ctx, &g);
        if (words[i] != NULL) {
            check_packed_refused(file, size, BVX_FORMAT_BVX, BVX_ERR_FORMAT, words[i]);
        } else {
            TEST_ASSERT_EQUAL_INT32(BVX_OK, read_packed(file, size, BVX_FORMAT_BVX, NULL, &back));
            bvx_grid_free(ctx, &back);
        }
    }
}

/* A file of some 160 bytes that stands for 2^50 voxels: refused as a whole, at once; a window of it is
 * read. */
static void test_bvx_huge_slice(void)
{
    bvx_lattice const l = lattice_of(1 << 25, 1 << 25, 1, 0, 1, 1, 1);
    uint8_t file[HEAD + SLICE + 24];
    uint8_t runs[24];
    bvx_grid g;
    size_t n = plain_length(runs, ((uint64_t)1 << 49) + 100); /* empty, set, empty */

    n += plain_length(runs + n, ((uint64_t)1 << 25) + 7);
    n += plain_length(runs + n, ((uint64_t)1 << 49) - 107 - ((uint64_t)1 << 25));
    size_t const size = one_slice(file, &l, 0, 1, runs, n);
    check_packed_refused(file, size, BVX_FORMAT_BVX, BVX_ERR_BUDGET, "grid");
    bvx_window const w = window_of(90, (1 << 24) - 1, 0, 70, 4, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, read_packed(file, size, BVX_FORMAT_BVX, &w, &g));
    for (int32_t y = 0; y < 4; y++)
        for (int32_t x = 0; x < 70; x++)
            TEST_ASSERT_EQUAL_INT(y == 1 ? x >= 10 : y == 2 && x < 17, bvx_grid_get(&g, x, y, 0));
    bvx_grid_free(ctx, &g);
    size_t const half = one_slice(file, &l, 0, 1, runs, 8); /* these bytes cannot stand for the slice */
    check_packed_refused(file, half, BVX_FORMAT_BVX, BVX_ERR_FORMAT, "do not add up");
}

/* Runs over rows, in windows of every place. */
static void test_bvx_runs_in_every_window(void)
{
    bvx_lattice const l = lattice_of(9, 5, 1, 0, 1, 1, 1);
    uint8_t file[HEAD + SLICE + 16];

    for (int begin = 0; begin < 45; begin += 4)
        for (int end = begin + 1; end <= 45; end += 3) {
            uint8_t const runs[3] = {(uint8_t)begin, (uint8_t)(end - begin), (uint8_t)(45 - end)};
            size_t const size = one_slice(file, &l, 0, 1, runs, end < 45 ? 3 : 2);
            for (int32_t x = 0; x < 9; x += 2)
                for (int32_t y = 0; y < 5; y++)
                    for (int32_t ny = 1; ny <= 5 - y; ny++) {
                        bvx_window const w = window_of(x, y, 0, 9 - x < 4 ? 9 - x : 4, ny, 1);
                        bvx_grid g;
                        TEST_ASSERT_EQUAL_INT32(BVX_OK, read_packed(file, size, BVX_FORMAT_BVX, &w, &g));
                        for (int32_t j = 0; j < ny; j++)
                            for (int32_t i = 0; i < w.size[0]; i++) {
                                int const bit = (y + j) * 9 + x + i;
                                TEST_ASSERT_EQUAL_INT(bit >= begin && bit < end, bvx_grid_get(&g, i, j, 0));
                            }
                        bvx_grid_free(ctx, &g);
                    }
        }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_bvx_of_many_shapes);
    RUN_TEST(test_bvx_of_windows);
    RUN_TEST(test_bvx_bytes);
    RUN_TEST(test_bvx_workers_words_limits_and_cancel);
    RUN_TEST(test_bvx_ignores_padding);
    RUN_TEST(test_bvx_in_parts);
    RUN_TEST(test_bvx_parts_refuse);
    RUN_TEST(test_bvx_notices_every_byte);
    RUN_TEST(test_bvx_messages);
    RUN_TEST(test_bvx_head_replaced);
    RUN_TEST(test_bvx_slices_with_right_checksums);
    RUN_TEST(test_bvx_mixed_parts);
    RUN_TEST(test_bvx_huge_slice);
    RUN_TEST(test_bvx_runs_in_every_window);
    return UNITY_END();
}
