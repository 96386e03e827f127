/* test_read_memory.c - the files that make readers take most, held to what
 * bitvox.h says: a multiple of the file's bytes. */
#include "bitvox_io.h"
#include "tools/read_limits.h"

#include "suite.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { FILE_ROOM = 1 << 20, CORNERS = 30000 };

static char *file;
static size_t size;

void setUp(void)
{
    suite_open(1);
    file = malloc(FILE_ROOM);
    TEST_ASSERT_NOT_NULL(file);
    size = 0;
}

void tearDown(void)
{
    free(file);
    suite_close();
}

/* ---- files ---- */

static void put(const void *bytes, size_t n)
{
    TEST_ASSERT_TRUE(n <= FILE_ROOM - size);
    memcpy(file + size, bytes, n);
    size += n;
}

static void put_text(const char *text)
{
    put(text, strlen(text));
}

/* count times the words of a text, one after the other. */
static void put_many(uint32_t count, const char *const *text, uint32_t texts)
{
    for (uint32_t i = 0; i < count; i++) put_text(text[i % texts]);
}

static void put_number(const char *form, uint32_t number)
{
    char text[200];
    TEST_ASSERT_TRUE(snprintf(text, sizeof text, form, (unsigned)number) < (int)sizeof text);
    put_text(text);
}

static void put_u32(uint32_t v)
{
    uint8_t const b[4] = {(uint8_t)(v & 255), (uint8_t)(v >> 8 & 255), (uint8_t)(v >> 16 & 255),
                          (uint8_t)(v >> 24)};
    put(b, 4);
}

/* ---- what they take ---- */

enum { MESH, POINTS, SECTIONS, VOLUME };

/* The most may be no more than the header says, and where this is the worst
 * file known, no less than a half: it shall say what is so. */
static void check_memory(int kind, int32_t format, int32_t multiple, int worst, bvx_status expected)
{
    bvx_mesh m = {0};
    bvx_volume v = {0};
    bvx_sections s;
    bvx_status status;
    char words[160];

    memset(&s, 0, sizeof s);
    bvx_memory_reset_peak(ctx);
    status = kind == MESH     ? bvx_read_mesh(ctx, file, size, format, NULL, &m)
             : kind == POINTS ? bvx_read_points(ctx, file, size, format, &m)
             : kind == VOLUME ? bvx_read_volume(ctx, file, size, format, NULL, &v)
                              : bvx_read_sections(ctx, file, size, format, NULL, &s);
    uint64_t const peak = bvx_memory_peak(ctx);
    snprintf(words, sizeof words, "format %d: %u bytes take %u: %.1f times, %s", (int)format, (unsigned)size,
             (unsigned)peak, (double)peak / (double)size, bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32_MESSAGE(expected, status, words);
    TEST_ASSERT_TRUE_MESSAGE(peak <= read_limit(multiple, size), words);
    if (worst) TEST_ASSERT_TRUE_MESSAGE(2 * peak >= (uint64_t)multiple * size, words);
    bvx_sections_free(ctx, &s);
    bvx_volume_free(ctx, &v);
    bvx_mesh_free(ctx, &m);
    size = 0;
}

static void test_stl_takes_at_most(void)
{
    put_text("facet outer loop\n"); /* all arrays have just grown */
    for (uint32_t i = 0; i < 4400; i++) {
        put_number("vertex %u", i % 10);
        put_number(" %u", i / 10 % 10);
        put_number(" %u\n", i / 100);
    }
    put_text("endloop endfacet");
    check_memory(MESH, BVX_FORMAT_STL, READ_STL, 1, BVX_OK);
    for (uint32_t i = 0; i < 80; i++) put("x", 1);
    put_u32(5000);
    for (uint32_t i = 0; i < 5000; i++) { /* no vertex twice */
        put("\0\0\0\0\0\0\0\0\0\0\0\0", 12);
        for (uint32_t k = 0; k < 9; k++) put_u32(0x3f800000u + 9 * i + k);
        put("\0\0", 2);
    }
    check_memory(MESH, BVX_FORMAT_STL, READ_STL, 0, BVX_OK);
}

/* Corners of two bytes: the largest polygon is cut in room of its own. */
static void test_obj_and_off_take_at_most(void)
{
    static const char *const from_one[] = {" 1", " 3", " 2", " 4", " 5"};
    static const char *const from_none[] = {" 0", " 2", " 1", " 3", " 4"};

    put_text("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nv 2 1 0\nf");
    put_many(CORNERS, from_one, 5);
    check_memory(MESH, BVX_FORMAT_OBJ, READ_OBJ, 1, BVX_OK);
    put_text("vt 0\nvt 1\n");
    for (uint32_t i = 0; i < 5000; i++) put_text("v 1 2 3 1 1 1\n");
    for (uint32_t i = 0; i < 5000; i++) put_text("f 1/1 2 3/2 4\n");
    check_memory(MESH, BVX_FORMAT_OBJ, READ_OBJ, 0, BVX_OK);
    put_number("OFF 5 1 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n2 1 0\n%u", CORNERS);
    put_many(CORNERS, from_none, 5);
    check_memory(MESH, BVX_FORMAT_OFF, READ_OFF, 1, BVX_OK);
}

/* Corners of one byte. */
static void test_ply_takes_at_most(void)
{
    static const char vertices[] =
        "ply\nformat binary_little_endian 1.0\nelement vertex 5\nproperty char x\nproperty char y\nproperty char z\n";
    static const char places[] = "\0\0\0\1\0\0\0\1\0\1\1\0\2\1\0";

    put_text(vertices);
    put_text("element face 1\nproperty list uint uchar vertex_indices\nend_header\n");
    put(places, 15);
    put_u32(CORNERS);
    for (uint32_t i = 0; i < CORNERS; i++) put(&"\0\2\1\3\4"[i % 5], 1);
    check_memory(MESH, BVX_FORMAT_PLY, READ_PLY, 1, BVX_OK);
    put_text(vertices);
    put_text("element tristrips 1\nproperty list uint uchar vertex_indices\nend_header\n");
    put(places, 15);
    put_u32(CORNERS);
    for (uint32_t i = 0; i < CORNERS; i++) put(&"\0\2\1\3\4"[i % 5], 1);
    check_memory(MESH, BVX_FORMAT_PLY, READ_PLY, 0, BVX_OK);
}

static void test_points_take_at_most(void)
{
    static const char *const point[] = {"1 2 3\n"}, *const newline[] = {"\n"};

    put_many(CORNERS, point, 1);
    check_memory(POINTS, BVX_FORMAT_XYZ, READ_POINTS, 0, BVX_OK);
    put_number(
        "ply\nformat binary_little_endian 1.0\nelement vertex %u\nproperty char x\nproperty char y\nproperty char z\nend_header\n",
        CORNERS);
    for (uint32_t i = 0; i < CORNERS; i++) put("\1\2\3", 3);
    check_memory(POINTS, BVX_FORMAT_PLY, READ_POINTS, 0, BVX_OK);
    put_text("ply\n"); /* lines of a header that name nothing take nothing */
    put_many(CORNERS, newline, 1);
    put_text("end_header\n");
    check_memory(POINTS, BVX_FORMAT_PLY, READ_POINTS, 0, BVX_ERR_FORMAT);
}

static void test_sections_take_at_most(void)
{
    static const char *const corner[] = {" 0", " 1", " 2"}, *const loop[] = {"1 0 0\n"};

    for (uint32_t corners = 20000; corners < 40000; corners += 1500) {
        put_number("CSLC\n1 1\n1 3 1 0 0 1 0\n0 0 0 1 0 0 0 1 0\n%u 1", corners);
        put_many(corners, corner, 3);
        check_memory(SECTIONS, BVX_FORMAT_CSL, READ_SECTIONS, 0, BVX_OK);
    }
    put_text("CSLC\n1 1\n1 3 20000 0 0 1 0\n0 0 0 1 0 0 0 1 0\n");
    put_many(20000, loop, 1);
    check_memory(SECTIONS, BVX_FORMAT_CSL, READ_SECTIONS, 0, BVX_OK);
    put_text("loop,section,x,y,position\n");
    for (uint32_t i = 0; i < 2000; i++) put_number(",%x,0,0,0\n", i);
    check_memory(SECTIONS, BVX_FORMAT_CSV, READ_SECTIONS, 0, BVX_OK);
}

/* Text of one digit and a space, to doubles. */
static void test_volumes_take_at_most(void)
{
    static const char *const sample[] = {"0 ", "1 "};
    put_text("NRRD0004\ntype: double\ndimension: 3\nsizes: 30 20 50\nencoding: ascii\n\n");
    put_many(30000, sample, 2);
    check_memory(VOLUME, BVX_FORMAT_NRRD, READ_VOLUME, 1, BVX_OK);
}

/* Samples in base64 are decoded beside the grid, which stands in words of the caller's. */
static void test_grids_take_at_most(void)
{
    static const char *const three[] = {"AAAA"};
    static uint64_t words[4096];
    bvx_grid g = {0};

    put_text(
        "<VTKFile type=\"ImageData\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt32\">"
        "<ImageData WholeExtent=\"0 64 0 64 0 64\" Origin=\"0 0 0\" Spacing=\"1 1 1\"><Piece Extent=\"0 64 0 64 0 64\"><CellData>"
        /* 262144 samples follow their count */
        "<DataArray type=\"UInt8\" Name=\"a\" format=\"binary\">AAAE");
    put_many(87381, three, 1);
    put_text("AAA=</DataArray></CellData></Piece></ImageData></VTKFile>");
    g.words = words;
    g.word_capacity = 4096;
    bvx_memory_reset_peak(ctx);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_read_grid(ctx, file, size, BVX_FORMAT_VTI, NULL, &g),
                                    bvx_last_message(ctx));
    TEST_ASSERT_TRUE(bvx_memory_peak(ctx) <= read_limit(READ_GRID, size));
    TEST_ASSERT_TRUE(2 * bvx_memory_peak(ctx) >= READ_GRID * size);
}

static void test_octrees_take_at_most(void)
{
    static const float positions[12] = {0.2f, 0.3f, 0.4f, 14.7f, 0.5f, 0.6f, 1, 14.2f, 0.7f, 2, 2, 14.4f};
    static const uint32_t triangles[12] = {0, 2, 1, 0, 1, 3, 1, 2, 3, 2, 0, 3};
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {15, 15, 15};
    bvx_mesh_view view = {0};
    bvx_lattice base;
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_octree *tree = NULL, *back = NULL;
    bvx_buffer b = {0};

    view.positions = positions;
    view.indices = triangles;
    view.vertex_count = view.triangle_count = 4;
    view.position_type = BVX_F32;
    view.index_type = BVX_U32;
    o.levels = 5;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &base));
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_refine(ctx, &view, &base, &o, &tree), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_octree(ctx, tree, 0, BVX_FORMAT_BVX, &b));
    bvx_octree_free(ctx, tree);
    uint64_t const before = bvx_memory_used(ctx);
    bvx_memory_reset_peak(ctx);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_octree(ctx, b.bytes, b.size, &back));
    uint64_t const took = bvx_memory_peak(ctx) - before;
    TEST_ASSERT_TRUE(b.size > 4 * READ_TABLES && took <= read_limit(READ_OCTREE, b.size) &&
                     2 * took >= READ_OCTREE * b.size);
    bvx_octree_free(ctx, back);
    bvx_buffer_free(ctx, &b);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_stl_takes_at_most);
    RUN_TEST(test_obj_and_off_take_at_most);
    RUN_TEST(test_ply_takes_at_most);
    RUN_TEST(test_points_take_at_most);
    RUN_TEST(test_sections_take_at_most);
    RUN_TEST(test_volumes_take_at_most);
    RUN_TEST(test_grids_take_at_most);
    RUN_TEST(test_octrees_take_at_most);
    return UNITY_END();
}
