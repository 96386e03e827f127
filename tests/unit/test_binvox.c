/* test_binvox.c - .binvox files: against a plain writer, files of other makers, windows, damage. */
#include "bits/runs.h"
#include "bits/bits.h"
#include "packed_support.h"

static bvx_lattice cubes(int32_t nx, int32_t ny, int32_t nz, double origin, double spacing)
{
    return lattice_of(nx, ny, nz, origin, spacing, spacing, spacing);
}

/* ---- a plain writer: a voxel at a time, y fastest, then z, then x ---- */

static bvx_buffer plain_file(const bvx_grid *g, const char *header)
{
    size_t const voxels = (size_t)g->size[0] * (size_t)g->size[1] * (size_t)g->size[2];
    bvx_buffer b = {0};
    int value = -1, count = 0;

    b.bytes = malloc(strlen(header) + 2 * voxels);
    b.size = strlen(header);
    memcpy(b.bytes, header, (size_t)b.size);
    for (int32_t x = 0; x < g->size[0]; x++)
        for (int32_t z = 0; z < g->size[2]; z++)
            for (int32_t y = 0; y < g->size[1]; y++) {
                if (bvx_grid_get(g, x, y, z) != value || count == 255) {
                    value = bvx_grid_get(g, x, y, z);
                    b.bytes[b.size++] = (uint8_t)value;
                    b.size++;
                    count = 0;
                }
                b.bytes[b.size - 1] = (uint8_t)++count;
            }
    return b;
}

static void check_file(const bvx_lattice *lattice, const bvx_window *window, int kind, int windows)
{
    bvx_grid g, back;
    bvx_buffer b = {0};
    char header[300];

    grid_of(&g, lattice, window, kind, (uint64_t)lattice->dims[1] + 7);
    int32_t longest = g.size[0] > g.size[1] ? g.size[0] : g.size[1];
    if (g.size[2] > longest) longest = g.size[2];
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_BINVOX, &b),
                                    bvx_last_message(ctx));

    /* spacing 1/4, low corner at multiples of 1/8: short decimals, the same in any printing */
    sprintf(header, "#binvox 1\ndim %d %d %d\ntranslate %g %g %g\nscale %g\ndata\n", (int)g.size[0],
            (int)g.size[1], (int)g.size[2], lattice->origin[0] + g.low[0] * 0.25,
            lattice->origin[1] + g.low[1] * 0.25, lattice->origin[2] + g.low[2] * 0.25, longest * 0.25);
    bvx_buffer plain = plain_file(&g, header);
    TEST_ASSERT_EQUAL_UINT64(plain.size, b.size);
    TEST_ASSERT_EQUAL_MEMORY(plain.bytes, b.bytes, (size_t)b.size);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(
        BVX_OK, read_packed(b.bytes, (size_t)b.size, BVX_FORMAT_BINVOX, NULL, &back), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_MEMORY(g.words, back.words, 8 * grid_words(&g));
    for (int a = 0; a < 3; a++) {
        TEST_ASSERT_EQUAL_INT32(g.size[a], back.lattice.dims[a]);
        TEST_ASSERT_EQUAL_INT32(0, back.low[a]);
        TEST_ASSERT_TRUE(back.lattice.spacing[a] == 0.25);
        TEST_ASSERT_TRUE(back.lattice.origin[a] == lattice->origin[a] + g.low[a] * 0.25);
    }
    check_windows(&b, BVX_FORMAT_BINVOX, &back, windows);
    bvx_grid_free(ctx, &back);
    free(plain.bytes);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

static void test_binvox_of_many_shapes(void)
{
    static const int32_t sides[] = {1, 2, 63, 64, 65, 127, 128, 129, 300};

    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++)
        for (int kind = 0; kind < KINDS; kind++) {
            bvx_lattice const a = cubes(sides[i], 5, 3, -1.5, 0.25);
            bvx_lattice const b = cubes(3, sides[i], 2, 8, 0.25);
            bvx_lattice const c = cubes(2, 1, sides[i], 0, 0.25);
            check_file(&a, NULL, kind, 6);
            check_file(&b, NULL, kind, 6);
            check_file(&c, NULL, kind, 6);
        }
}

static void test_binvox_of_windows(void)
{
    bvx_lattice const l = cubes(200, 140, 40, 3.25, 0.25);
    uint64_t state = 5;
    for (int i = 0; i < 40; i++) {
        bvx_window const w = random_window(l.dims, &state);
        check_file(&l, &w, i % KINDS, 10);
    }
}

static void test_binvox_workers_words_limits_and_cancel(void)
{
    bvx_lattice const l = cubes(330, 31, 20, 1, 0.5);

    for (int kind = KIND_EMPTY; kind < KINDS; kind++) {
        bvx_grid g;
        bvx_buffer b = {0};
        grid_of(&g, &l, NULL, kind, 5);
        check_workers(&g, BVX_FORMAT_BINVOX);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_BINVOX, &b));
        check_own_words(&g, &b, BVX_FORMAT_BINVOX);
        check_memory_limits(&g, &b, BVX_FORMAT_BINVOX);
        TEST_ASSERT_TRUE(check_cancelled_reading(&b, BVX_FORMAT_BINVOX) >= 2);
        TEST_ASSERT_TRUE(check_cancelled_writing(&g, BVX_FORMAT_BINVOX) >= 4);
        bvx_buffer_free(ctx, &b);
        bvx_grid_free(ctx, &g);
    }
}

/* ---- the lattice ---- */

static double stepped(double v, int steps)
{
    uint64_t bits;
    memcpy(&bits, &v, sizeof bits);
    bits += (uint64_t)(int64_t)steps;
    memcpy(&v, &bits, sizeof v);
    return v;
}

/* The same spacing comes back wherever any number divided by the side gives it; else its neighbour does. */
static void test_binvox_spacing_comes_back(void)
{
    uint64_t state = 77;
    int same = 0, near = 0;

    for (int i = 0; i < 3000; i++) {
        int32_t const n = 1 + (int32_t)((next_random(&state) >> 20) % 700);
        double const mantissa = 1.0 + (double)(next_random(&state) >> 12) / 4503599627370496.0;
        double const spacing = i < 1000 ? 0.1 * (1 + i % 37) : i % 2 ? mantissa * 1e-3 : mantissa * 1e200;
        double const origin = mantissa * (i - 1500);
        bvx_lattice const l = cubes(1, 1, n, origin, spacing);
        bvx_grid g, back;
        bvx_buffer b = {0};
        grid_of(&g, &l, NULL, KIND_EMPTY, 1);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_BINVOX, &b));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, read_packed(b.bytes, (size_t)b.size, BVX_FORMAT_BINVOX, NULL, &back));
        for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(back.lattice.origin[a] == l.origin[a]);
        if (back.lattice.spacing[0] == spacing) {
            same++;
        } else {
            for (int k = -16; k <= 16; k++) TEST_ASSERT_TRUE(stepped(spacing * n, k) / n != spacing);
            TEST_ASSERT_TRUE(back.lattice.spacing[0] == stepped(spacing, 1) ||
                             back.lattice.spacing[0] == stepped(spacing, -1));
            near++;
        }
        bvx_grid_free(ctx, &back);
        bvx_buffer_free(ctx, &b);
        bvx_grid_free(ctx, &g);
    }
    TEST_ASSERT_TRUE(same > 2000 && near > 100);
}

static void test_binvox_refuses_to_write(void)
{
    bvx_lattice const flat = lattice_of(4, 5, 6, 0, 0.5, 0.5, 0.25);
    bvx_lattice const large = cubes(300, 2, 2, 0, 1e306);
    bvx_lattice const far_off = cubes(20, 2, 2, 1.7e308, 1e307);
    bvx_window const end = window_of(19, 0, 0, 1, 2, 2);
    bvx_grid g;
    bvx_buffer b = {0};

    grid_of(&g, &flat, NULL, KIND_FULL, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_write_grid(ctx, &g, BVX_FORMAT_BINVOX, &b));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "the spacing is 0.5, 0.5, 0.25"));
    bvx_grid_free(ctx, &g);
    grid_of(&g, &large, NULL, KIND_FULL, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_grid(ctx, &g, BVX_FORMAT_BINVOX, &b));
    bvx_grid_free(ctx, &g);
    grid_of(&g, &far_off, &end, KIND_FULL, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_grid(ctx, &g, BVX_FORMAT_BINVOX, &b));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "no finite place along x"));
    bvx_grid_free(ctx, &g);
    TEST_ASSERT_NULL(b.bytes);
}

/* ---- files of other makers ---- */

static size_t file_of(uint8_t *file, const char *header, const char *pairs, size_t n)
{
    size_t const h = strlen(header);
    memcpy(file, header, h);
    memcpy(file + h, pairs, n);
    return h + n;
}

static void check_read(const char *header, const char *pairs, size_t n, double ox, double oy, double oz,
                       double spacing, const char *voxels)
{
    uint8_t file[600];
    bvx_grid g;
    size_t const size = file_of(file, header, pairs, n);

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_packed(file, size, BVX_FORMAT_BINVOX, NULL, &g),
                                    bvx_last_message(ctx));
    TEST_ASSERT_TRUE(g.lattice.origin[0] == ox && g.lattice.origin[1] == oy && g.lattice.origin[2] == oz);
    for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(g.lattice.spacing[a] == spacing);
    for (int32_t z = 0; z < g.size[2]; z++) /* voxels: rows along x, then y, then z */
        for (int32_t y = 0; y < g.size[1]; y++)
            for (int32_t x = 0; x < g.size[0]; x++)
                TEST_ASSERT_EQUAL_INT(*voxels++ == '1', bvx_grid_get(&g, x, y, z));
    TEST_ASSERT_EQUAL_INT(0, *voxels);
    bvx_grid_free(ctx, &g);
}

static void test_binvox_files_of_others(void)
{
    /* voxels 0 and 1 are (0,0,0) and (0,1,0), number 2 is (0,0,1), number 4 is (1,0,0) */
    check_read("#binvox 1\ndim 2 2 2\ntranslate -0.5 1.25 3\nscale 7\ndata\n", "\1\1\0\7", 4, -0.5, 1.25, 3,
               3.5, "10000000");
    check_read("#binvox 1\ndim 2 2 2\ntranslate 0 0 0\nscale 1\ndata\n", "\0\1\1\1\0\6", 6, 0, 0, 0, 0.5,
               "00100000");
    check_read("#binvox 1\ndim 2 2 2\ntranslate 0 0 0\nscale 1\ndata\n", "\0\2\1\1\0\5", 6, 0, 0, 0, 0.5,
               "00001000");
    check_read("#binvox 1\ndim 2 2 2\ntranslate 0 0 0\nscale 1\ndata\n", "\0\4\1\1\0\3", 6, 0, 0, 0, 0.5,
               "01000000");

    /* unequal sides are x y z; the longest one has the scale */
    check_read("#binvox 1\ndim 1 2 3\ndata\n", "\1\1\0\1\1\2\0\2", 8, 0, 0, 0, 1.0 / 3, "101100");
    check_read("#binvox 1\ndim 3 1 2\ndata\n", "\0\2\1\1\0\3", 6, 0, 0, 0, 1.0 / 3, "010000");

    /* lines in any order, comments, words that nobody knows, blanks, ends of lines of both kinds */
    check_read(
        "#binvox 1\r\n# generated in `trimesh`\r\n\r\nscale 2\r\n  dim  2\t1 1 \r\ncolour red\r\ntranslate 1e1 -2.5E-1 +3\r\ndata\r\n",
        "\1\2", 2, 10, -0.25, 3, 1, "11");

    /* version 2: any number is set */
    check_read("#binvox 2\ndim 3 1 1\ntranslate 0 0 0\nscale 3\ndata\n", "\7\1\0\1\377\1", 6, 0, 0, 0, 1,
               "101");

    /* runs in pieces, counts of 0 */
    check_read("#binvox 1\ndim 3 1 1\nscale 3\ndata\n", "\1\0\1\1\1\1\0\0\0\1\1\0", 12, 0, 0, 0, 1, "110");

    /* bytes that look like the ends of lines */
    check_read("#binvox 2\ndim 10 1 2\nscale 10\ndata\n", "\12\12\15\12", 4, 0, 0, 0, 1,
               "11111111111111111111");
}

static void check_header_refused(const char *header, bvx_status status, const char *words)
{
    uint8_t file[300];
    size_t const size = file_of(file, header, "\1\2", 2);
    check_packed_refused(file, size, BVX_FORMAT_BINVOX, status, words);
}

static void test_binvox_refuses_headers(void)
{
    bvx_status const format = BVX_ERR_FORMAT;

    check_header_refused("#binvos 1\ndim 2 1 1\ndata\n", format, "does not begin with #binvox");
    check_header_refused("#binvox1\ndim 2 1 1\ndata\n", format, "does not begin with #binvox");
    check_header_refused("#binvox\ndim 2 1 1\ndata\n", format, "line 1: #binvox wants a version");
    check_header_refused("#binvox 1.5\ndim 2 1 1\ndata\n", format, "#binvox wants a version");
    check_header_refused("#binvox 3\ndim 2 1 1\ndata\n", BVX_ERR_UNSUPPORTED,
                         "version 3; 1 and 2 can be read");
    check_header_refused("#binvox 1\ndim 2 1\ndata\n", format, "line 2: dim wants three whole numbers");
    check_header_refused("#binvox 1\n\ndim 2 1 1 1\ndata\n", format, "line 3: dim wants");
    check_header_refused("#binvox 1\ndim 2 -1 1\ndata\n", format, "dim wants");
    check_header_refused("#binvox 1\ndim 2 1.0 1\ndata\n", format, "dim wants");
    check_header_refused("#binvox 1\ndim 18446744073709551618 1 1\ndata\n", format, "dim wants");
    check_header_refused("#binvox 1\ndim 2 1 1\ndim 2 1 1\ndata\n", format, "line 3: dim comes twice");
    check_header_refused("#binvox 1\ndim 2 0 1\ndata\n", format, "no voxels along y");
    check_header_refused("#binvox 1\ndim 0 0 0\ndata\n", format, "no voxels along x");
    check_header_refused("#binvox 1\ndim 4294967295 1 1\ndata\n", BVX_ERR_RANGE, "4294967295 voxels along x");
    check_header_refused("#binvox 1\ndim 2 1 1\ntranslate 1 2\ndata\n", format,
                         "line 3: translate wants three");
    check_header_refused("#binvox 1\ndim 2 1 1\ntranslate 1 2 nan\ndata\n", format,
                         "the origin is not finite along z");
    check_header_refused("#binvox 1\ndim 2 1 1\nscale x\ndata\n", format, "scale wants one number");
    check_header_refused("#binvox 1\ndim 2 1 1\nscale 0\ndata\n", format, "the spacing along x is 0");
    check_header_refused("#binvox 1\ndim 2 1 1\nscale -1\ndata\n", format, "the spacing along x is -0.5");
    check_header_refused("#binvox 1\ndim 2 1 1\nscale 1e999\ndata\n", format, "the spacing");
    check_header_refused("#binvox 1\ndim 2 1 1\ndata x\n", format, "something follows data");
    check_header_refused("#binvox 1\nscale 1\ndata\n", format,
                         "line 3: data comes, but no line has said dim");
    check_header_refused("#binvox 1\ndim 2 1 1\n", format, "the file ends before the line that says data");
    check_header_refused("#binvox 1\ndim 2 1 1\ndata", format,
                         "the file ends before the line that says data");
}

static void test_binvox_refuses_pairs(void)
{
    static const char header[] = "#binvox 1\ndim 2 3 4\ntranslate 0 0 0\nscale 1\ndata\n";

    static const struct {
        const char *pairs;
        size_t n;
        const char *words;
    } bad[] = {{"\1\27", 2, "the runs end before the 2 x 3 x 4 voxels do"},
               {"\1\31", 2, "more runs than the 2 x 3 x 4"},
               {"\1\30\0\1", 4, "more runs"},
               {"\1\30\0", 3, "more runs"},
               {"\1\14\1\13\0", 5, "the runs end before"},
               {"", 0, "the runs end before"},
               {"\1", 1, "the runs end before"},
               {"\1\377", 2, "more runs"}};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        uint8_t file[200];
        size_t const size = file_of(file, header, bad[i].pairs, bad[i].n);
        check_packed_refused(file, size, BVX_FORMAT_BINVOX, BVX_ERR_FORMAT, bad[i].words);
    }
}

/* The header's sides replaced: a small file never asks for much. */
static void test_binvox_sides_replaced(void)
{
    static const char *const numbers[] = {
        "0", "1", "-1", "2147483648", "4294967295", "33554432", "18446744073709551615"};

    for (int a = 0; a < 27 * 7; a++) {
        char header[200];
        uint8_t file[300];
        bvx_grid g;
        sprintf(header, "#binvox 1\ndim %s %s %s\ndata\n", a % 3 == 0 ? numbers[a / 27] : "5",
                a / 3 % 3 == 0 ? numbers[a / 27] : "4", a / 9 % 3 == 0 ? numbers[a / 27] : "6");
        size_t const size = file_of(file, header, "\1\144\0\24", 4);
        bvx_memory_reset_peak(ctx);
        bvx_status const status = read_packed(file, size, BVX_FORMAT_BINVOX, NULL, &g);
        TEST_ASSERT_TRUE(bvx_memory_peak(ctx) <= 4096);
        int const plain = a % 3 != 0 && a / 3 % 3 != 0 && a / 9 % 3 != 0;
        if (plain) TEST_ASSERT_EQUAL_INT32(BVX_OK, status);
        else TEST_ASSERT_TRUE(status == BVX_ERR_FORMAT || status == BVX_ERR_RANGE);
        bvx_grid_free(ctx, &g);
    }
}

static void test_binvox_cut(void)
{
    bvx_lattice const l = cubes(20, 6, 7, 0.1, 0.3);
    bvx_grid g;
    bvx_buffer b = {0};

    grid_of(&g, &l, NULL, KIND_SPARSE, 4);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_BINVOX, &b));
    check_every_cut(&b, BVX_FORMAT_BINVOX);
    bvx_buffer_free(ctx, &b);
    bvx_grid_free(ctx, &g);
}

/* ---- what the writer and the reader turn and count with ---- */

static void test_transpose_turns_a_block(void)
{
    uint64_t state = 3, block[64], turned[64];

    for (int round = 0; round < 50; round++) {
        for (int i = 0; i < 64; i++)
            block[i] = round < 40 ? next_random(&state) : round % 2 ? UINT64_C(1) << (i + round) % 64 : 0;
        memcpy(turned, block, sizeof turned);
        bvxi_transpose_64(turned);
        for (int i = 0; i < 64; i++)
            for (int k = 0; k < 64; k++)
                TEST_ASSERT_EQUAL_INT((int)(block[i] >> k & 1), (int)(turned[k] >> i & 1));
        bvxi_transpose_64(turned);
        TEST_ASSERT_EQUAL_HEX64_ARRAY(block, turned, 64);
    }
}

static void test_runs_of_rows(void)
{
    uint64_t state = 11, words[12];

    for (int round = 0; round < 20000; round++) {
        int32_t const bits = 1 + (int32_t)((next_random(&state) >> 20) % 190), row_words = (bits + 63) / 64;
        int32_t const rows = 1 + (int32_t)((next_random(&state) >> 20) % 4);
        bvxi_runs runs;
        int value = 0;
        int32_t at = 0;
        for (int i = 0; i < 12; i++) {
            uint64_t const r = next_random(&state);
            words[i] = r >> 60 < 4    ? 0
                       : r >> 60 < 8  ? ~UINT64_C(0)
                       : r >> 60 < 10 ? r
                                      : next_random(&state) & next_random(&state) & r;
        }
        bvxi_runs_start(&runs, words, (uint64_t)rows, bits);
        while (at < bits * rows) {
            uint64_t const length = bvxi_runs_next(&runs);
            TEST_ASSERT_TRUE(length <= (uint64_t)(bits * rows - at) && (length > 0 || at == 0));
            /* the bit behind the run is another */
            for (uint64_t i = 0; i <= length && at + (int32_t)i < bits * rows; i++) {
                int32_t const bit = at + (int32_t)i, x = bit % bits;
                int const got = (int)(words[bit / bits * row_words + x / 64] >> x % 64 & 1);
                TEST_ASSERT_EQUAL_INT(i < length ? value : !value, got);
            }
            at += (int32_t)length;
            value = !value;
        }
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_transpose_turns_a_block);
    RUN_TEST(test_runs_of_rows);
    RUN_TEST(test_binvox_of_many_shapes);
    RUN_TEST(test_binvox_of_windows);
    RUN_TEST(test_binvox_workers_words_limits_and_cancel);
    RUN_TEST(test_binvox_spacing_comes_back);
    RUN_TEST(test_binvox_refuses_to_write);
    RUN_TEST(test_binvox_files_of_others);
    RUN_TEST(test_binvox_refuses_headers);
    RUN_TEST(test_binvox_refuses_pairs);
    RUN_TEST(test_binvox_sides_replaced);
    RUN_TEST(test_binvox_cut);
    return UNITY_END();
}
