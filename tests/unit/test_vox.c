/* test_vox.c - MagicaVoxel files: written ones taken apart, hand-made ones of other makers, windows,
 * damage. */
#include "packed_support.h"

#include <inttypes.h>
#include <stdio.h>

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

static uint32_t get_u32(const uint8_t *p)
{
    return (uint32_t)p[0] | (uint32_t)p[1] << 8 | (uint32_t)p[2] << 16 | (uint32_t)p[3] << 24;
}

/* Models of 256 a side in a scene: read back alike, and by an oracle that takes each model's place from its node. */
static void test_vox_of_more_than_256_a_side(void)
{
    static const int32_t sides[][3] = {{257, 2, 3}, {3, 600, 2}, {2, 1, 257}, {520, 258, 3}, {300, 257, 260}};

    for (size_t i = 0; i < sizeof sides / sizeof sides[0]; i++)
        for (int kind = 0; kind < KINDS; kind++) {
            bvx_lattice const l = lattice_of(sides[i][0], sides[i][1], sides[i][2], 5, 0.5, 3, 2);
            bvx_grid g, back;
            bvx_buffer b = {0};
            uint64_t set = 0, count = 0;
            int64_t place[64][3];
            int places = 0, model = 0;

            if (i == 4 && kind != KIND_NOISE) continue;
            grid_of(&g, &l, NULL, kind, 3);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_VOX, &b));
            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK,
                                            read_packed(b.bytes, (size_t)b.size, BVX_FORMAT_VOX, NULL, &back),
                                            bvx_last_message(ctx));
            TEST_ASSERT_EQUAL_MEMORY(g.size, back.size, sizeof g.size);
            TEST_ASSERT_EQUAL_MEMORY(g.words, back.words, 8 * grid_words(&g));
            for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(back.lattice.origin[a] == 0.0);
            if (i < 4) check_windows(&b, BVX_FORMAT_VOX, &back, 8);

            /* Places of nodes first, which come last in the file; that of the whole scene has no model. */
            for (int pass = 0; pass < 2; pass++)
                for (const uint8_t *p = b.bytes + 20; p < b.bytes + b.size; p += 12 + get_u32(p + 4)) {
                    if (pass == 0 && memcmp(p, "nTRN", 4) == 0 && get_u32(p + 12) != 0) {
                        char text[64] = "";
                        memcpy(text, p + 12 + 38, get_u32(p + 12 + 34));
                        TEST_ASSERT_EQUAL_INT(3, sscanf(text, "%" SCNd64 " %" SCNd64 " %" SCNd64,
                                                        &place[places][0], &place[places][1],
                                                        &place[places][2]));
                        places++;
                    }
                    if (pass == 0 || memcmp(p, "XYZI", 4) != 0) continue;
                    const uint8_t *const size = p - 12;
                    for (uint32_t n = 0; n < get_u32(p + 12); n++) {
                        const uint8_t *const v = p + 16 + 4 * n;
                        int32_t at[3];
                        for (int a = 0; a < 3; a++)
                            at[a] = (int32_t)place[model][a] - (int32_t)(get_u32(size + 4 * a) / 2) + v[a];
                        TEST_ASSERT_TRUE(bvx_grid_get(&g, at[0], at[1], at[2]));
                        count++;
                    }
                    model++;
                }
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &g, &set));
            TEST_ASSERT_EQUAL_UINT64(set, count);
            TEST_ASSERT_EQUAL_INT(places, model);
            bvx_grid_free(ctx, &back);
            bvx_buffer_free(ctx, &b);
            bvx_grid_free(ctx, &g);
        }
}

static void test_vox_refuses_to_write(void)
{
    static const char *const words[2] = {"are more than 2^20 models of 256 a side",
                                         "write windows of the grid"};
    bvx_lattice const l = lattice_of(1 << 25, 256 * 9, 1, 0, 1, 1, 1);
    bvx_grid g = {.lattice = l, .size = {1 << 25, 256 * 9, 1}, .words_per_row = 1 << 19};
    uint64_t word = 0;
    bvx_buffer b = {0};

    /* Refused before a word is looked at. */
    g.words = &word;
    g.word_capacity = bvx_grid_bound(&l, NULL);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_write_grid(ctx, &g, BVX_FORMAT_VOX, &b));
    for (int i = 0; i < 2; i++) TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), words[i]));
    TEST_ASSERT_NULL(b.bytes);
}

/* ---- scenes ---- */

static void add_text(vox_file *f, const char *text)
{
    add_u32(f, (uint32_t)strlen(text));
    add(f, text, strlen(text));
}

/* A node that places another; turn or place may be NULL. */
static void add_place(vox_file *f, uint32_t number, uint32_t child, const char *turn, const char *place)
{
    size_t const head = f->size;

    add(f, "nTRN\0\0\0\0\0\0\0\0", 12);
    add_u32(f, number);
    add_u32(f, 1); /* a pair that is passed */
    add_text(f, "_name");
    add_text(f, "part");
    add_u32(f, child);
    add_u32(f, UINT32_MAX);
    add_u32(f, 0);
    add_u32(f, 1);
    add_u32(f, (uint32_t)(turn != NULL) + (uint32_t)(place != NULL));
    if (turn != NULL) add_text(f, "_r"), add_text(f, turn);
    if (place != NULL) add_text(f, "_t"), add_text(f, place);
    put_u32(f->bytes + head + 4, (uint32_t)(f->size - head - 12), 0);
}

static void add_group(vox_file *f, uint32_t number, uint32_t first, uint32_t second)
{
    uint32_t const words[5] = {number, 0, 2, first, second};
    add(f, "nGRP\24\0\0\0\0\0\0\0", 12);
    for (int i = 0; i < 5; i++) add_u32(f, words[i]);
}

static void add_shape(vox_file *f, uint32_t number, uint32_t model)
{
    uint32_t const words[5] = {number, 0, 1, model, 0};
    add(f, "nSHP\24\0\0\0\0\0\0\0", 12);
    for (int i = 0; i < 5; i++) add_u32(f, words[i]);
}

/* A row of three along x, and a voxel; group 1 holds both, the row turned to run down z. */
static void start_scene(vox_file *f, int sizes_first, const char *turn, const char *place)
{
    start(f, 200);
    add_size(f, 3, 1, 1);
    if (sizes_first) add_size(f, 1, 1, 1);
    add_voxels(f, "\0\0\0\1\2\0\0\1", 2);
    if (!sizes_first) add_size(f, 1, 1, 1);
    add_voxels(f, "\0\0\0\1", 1);
    add_place(f, 0, 1, NULL, "0 0 5");
    add_group(f, 1, 2, 4);
    add_place(f, 2, 3, turn, place);
    add_shape(f, 3, 0);
    add_place(f, 4, 5, NULL, NULL);
    add_shape(f, 5, 1);
}

static void test_vox_scenes(void)
{
    /* Where the ends of the row are, from the scene's low corner, and its box. */
    static const struct {
        const char *turn, *place;
        int32_t size[3], end[2][3], origin[3];
    } cases[] = {
        {NULL, "4 0 0", {6, 1, 1}, {{3, 0, 0}, {5, 0, 0}}, {0, 0, 5}},
        {"4", "-4 -1 0", {6, 2, 1}, {{0, 0, 0}, {2, 0, 0}}, {-5, -1, 5}},
        /* rows: x from y, y from z, z from x: the row runs up */
        {"9", "1 0 0", {2, 1, 3}, {{1, 0, 0}, {1, 0, 2}}, {0, 0, 4}},
        /* the same, z reversed: a voxel's middle is half of one from its corner */
        {"73", "1 0 1", {2, 1, 3}, {{1, 0, 2}, {1, 0, 0}}, {0, 0, 4}},
    };
    vox_file f;
    bvx_grid g;
    uint64_t count;

    /* Each also with the sides of both models before their voxels. */
    for (size_t i = 0; i < 2 * sizeof cases / sizeof cases[0]; i++) {
        size_t const n = i / 2;

        start_scene(&f, i % 2 == 1, cases[n].turn, cases[n].place);
        finish(&f);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, read_packed(f.bytes, f.size, BVX_FORMAT_VOX, NULL, &g),
                                        bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_INT32_ARRAY(cases[n].size, g.size, 3);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &g, &count));
        TEST_ASSERT_EQUAL_UINT64(3, count);
        for (int end = 0; end < 2; end++)
            TEST_ASSERT_TRUE(
                bvx_grid_get(&g, cases[n].end[end][0], cases[n].end[end][1], cases[n].end[end][2]));
        for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(g.lattice.origin[a] == cases[n].origin[a]);
        bvx_grid_free(ctx, &g);
    }
}

static void test_vox_scenes_refused(void)
{
    static const struct {
        const char *turn, *place, *words;
    } cases[] = {
        {"5", "0 0 0", "its place or turn is none"},    {"3", NULL, "its place or turn is none"},
        {"x", NULL, "its place or turn is none"},       {NULL, "1 2", "its place or turn is none"},
        {NULL, "1 2 nan", "its place or turn is none"}, {NULL, "1 2 3e9", "its place or turn is none"},
        {NULL, "900000000 0 0", "models lie far apart"}};
    vox_file f;

    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        start_scene(&f, 0, cases[i].turn, cases[i].place);
        check_vox_refused(&f, i < 6 ? BVX_ERR_FORMAT : BVX_ERR_UNSUPPORTED, cases[i].words);
    }
    /* A node with two parents, and one in itself; a child and a model that are not there. */
    for (uint32_t child = 0; child < 7; child++) {
        start_scene(&f, 0, NULL, NULL);
        f.size -= 32; /* the last shape */
        add_shape(&f, 5, child == 6 ? 2 : 1);
        if (child == 6) check_vox_refused(&f, BVX_ERR_FORMAT, "a shape without a model");
        start_scene(&f, 0, NULL, NULL);
        for (size_t at = 0; at + 12 < f.size; at++)
            if (memcmp(f.bytes + at, "nGRP", 4) == 0)
                put_u32(f.bytes + at + 12 + 16, child < 4 ? child : 99, 0);
        if (child < 4 ? child < 3 : child == 4)
            check_vox_refused(&f, BVX_ERR_FORMAT, "is not there, or has a parent already");
    }
    /* Cut at every byte of the scene: refused, or the models that are still there. */
    start_scene(&f, 0, "9", "1 0 0");
    for (size_t size = 100; size < f.size; size++) {
        vox_file cut = f;
        bvx_grid g = {0};
        cut.size = size;
        finish(&cut);
        bvx_status const status = read_packed(cut.bytes, cut.size, BVX_FORMAT_VOX, NULL, &g);
        TEST_ASSERT_TRUE(status == BVX_ERR_FORMAT || status == BVX_ERR_UNSUPPORTED);
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
    check_vox_refused(&f, BVX_ERR_UNSUPPORTED,
                      "the file has 2 models and no scene that places them; save each in a file of its own");
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
    RUN_TEST(test_vox_of_more_than_256_a_side);
    RUN_TEST(test_vox_scenes);
    RUN_TEST(test_vox_scenes_refused);
    RUN_TEST(test_vox_refuses_to_write);
    RUN_TEST(test_vox_limits_and_cancel);
    RUN_TEST(test_vox_files_of_others);
    RUN_TEST(test_vox_refuses);
    RUN_TEST(test_vox_numbers_replaced);
    RUN_TEST(test_vox_cut);
    return UNITY_END();
}
