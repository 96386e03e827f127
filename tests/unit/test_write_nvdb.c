/* test_write_nvdb.c - grids and fields as NanoVDB's files: each voxel is looked up from the root on by offsets from the
 * format's description. The files were compared once with NanoVDB's readers of versions 32.4 and 32.9 and, value by
 * value, with what nanovdb_convert of OpenVDB 10 makes of our .vdb. */
#include "dense_file_support.h"

#include <float.h>

static const uint8_t *grid_block; /* what stands after the head of the file */
static uint64_t block_size;
static int bytes; /* of a number; 1: a mask */

static const uint8_t *block_at(uint64_t offset, uint64_t size)
{
    TEST_ASSERT_TRUE_MESSAGE(size <= block_size && offset <= block_size - size, "beyond the grid");
    return grid_block + offset;
}

static uint64_t number_at(uint64_t offset, int size)
{
    const uint8_t *const p = block_at(offset, (uint64_t)size);
    uint64_t v = 0;

    for (int i = size; i-- > 0;) v = v << 8 | p[i];
    return v;
}

static double double_at(uint64_t offset)
{
    uint64_t const bits = number_at(offset, 8);
    double v;

    memcpy(&v, &bits, sizeof v);
    return v;
}

static double float_at(uint64_t offset)
{
    uint32_t const bits = (uint32_t)number_at(offset, 4);
    float v;

    memcpy(&v, &bits, sizeof v);
    return (double)v;
}

static double value_at(uint64_t offset)
{
    return bytes == 1 ? (double)number_at(offset, 1) : bytes == 4 ? float_at(offset) : double_at(offset);
}

static int bit_at(uint64_t offset, int i)
{
    return number_at(offset + (uint64_t)i / 8, 1) >> i % 8 & 1;
}

/* A node begins with the least corner of its voxels and is aligned. */
static void expect_node(uint64_t node, int side, const int32_t at[3])
{
    TEST_ASSERT_EQUAL_UINT64(0, node % 32);
    for (int a = 0; a < 3; a++)
        TEST_ASSERT_EQUAL_UINT64(at[a] / side * side, number_at(node + 4 * (uint64_t)a, 4));
}

static int index_in(const int32_t at[3], int side, int of)
{
    return (at[0] / of % side * side + at[1] / of % side) * side + at[2] / of % side;
}

static uint64_t first_leaf;
static uint32_t leaf_total;

/* The value of a voxel, and whether it is active. */
static double voxel_value(const int32_t at[3], int *active)
{
    uint64_t const tree = 672, root = tree + number_at(tree + 24, 8), tiles = root + (bytes == 8 ? 96 : 64);
    uint64_t const key = (uint64_t)(at[0] >> 12) << 42 | (uint64_t)(at[1] >> 12) << 21 |
                         (uint64_t)(at[2] >> 12);
    uint64_t node = 0;

    *active = 0;
    for (uint64_t i = 0; i < number_at(root + 24, 4) && node == 0; i++)
        if (number_at(tiles + 32 * i, 8) == key) node = root + number_at(tiles + 32 * i + 8, 8);
    if (node == 0) return value_at(root + (bytes == 8 ? 32 : 28));
    for (int level = 2; level > 0; level--) {
        int const side = level == 2 ? 32 : 16, below = level == 2 ? 128 : 8, i = index_in(at, side, below);
        uint64_t const mask = (uint64_t)side * (uint64_t)side * (uint64_t)side / 8;
        uint64_t const table = node + (level == 2 ? 8256 : 1088) + 8 * (uint64_t)i;

        expect_node(node, side * below, at);
        if (!bit_at(node + 32 + mask, i)) {
            *active = bit_at(node + 32, i);
            return value_at(table);
        }
        node += number_at(table, 8);
    }
    int const i = index_in(at, 8, 1);
    uint64_t const size = bytes == 1 ? 96 : bytes == 4 ? 96 + 2048 : 128 + 4096;

    expect_node(node, 8, at);
    TEST_ASSERT_TRUE(node >= first_leaf && (node - first_leaf) % size == 0 &&
                     (node - first_leaf) / size < leaf_total);
    *active = bit_at(node + 16, i);
    return bytes == 1 ? *active : value_at(node + size - (uint64_t)(bytes * (512 - i)));
}

/* Head, map, boxes and counts. */
static void take_head(const bvx_buffer *file, const char *name, int type, int class, const bvx_grid *g)
{
    uint64_t const head = 16 + 176 + strlen(name) + 1;
    int32_t low[3] = {INT32_MAX, INT32_MAX, INT32_MAX}, high[3] = {INT32_MIN, INT32_MIN, INT32_MIN};
    uint64_t voxels;

    TEST_ASSERT_TRUE(file->size > head + 736);
    TEST_ASSERT_EQUAL_MEMORY("NanoVDB0\0\x10\0\x04\1\0\0\0", file->bytes, 16);
    TEST_ASSERT_EQUAL_STRING(name, (const char *)file->bytes + 192);
    grid_block = file->bytes + head;
    block_size = file->size - head;
    TEST_ASSERT_EQUAL_MEMORY("NanoVDB0\xff\xff\xff\xff\xff\xff\xff\xff\0\x10\0\x04\x20", grid_block, 21);
    TEST_ASSERT_EQUAL_UINT64(block_size, number_at(32, 8));
    TEST_ASSERT_EQUAL_STRING(name, (const char *)grid_block + 40);
    TEST_ASSERT_EQUAL_UINT64(class, number_at(632, 4));
    TEST_ASSERT_EQUAL_UINT64(type, number_at(636, 4));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, g, &voxels));
    TEST_ASSERT_EQUAL_UINT64(voxels, number_at(672 + 56, 8));
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->size[0]; x++) {
                int32_t const at[3] = {x, y, z};

                for (int a = 0; a < 3 && bvx_grid_get(g, x, y, z); a++) {
                    low[a] = at[a] < low[a] ? at[a] : low[a];
                    high[a] = at[a] > high[a] ? at[a] : high[a];
                }
            }
    for (uint64_t a = 0; a < 3; a++) {
        double const s = g->lattice.spacing[a], first = g->lattice.origin[a] + g->low[a] * s + 0.5 * s;

        TEST_ASSERT_TRUE(double_at(296 + 88 + 32 * a) == s && double_at(296 + 232 + 8 * a) == first);
        TEST_ASSERT_TRUE(double_at(296 + 160 + 32 * a) == 1 / s && double_at(608 + 8 * a) == s);
        TEST_ASSERT_TRUE(float_at(296 + 16 * a) == (double)(float)s &&
                         float_at(296 + 72 + 4 * a) == (double)(float)first);
        TEST_ASSERT_EQUAL_INT32(low[a], (int32_t)(uint32_t)number_at(736 + 4 * a, 4));
        TEST_ASSERT_EQUAL_INT32(high[a], (int32_t)(uint32_t)number_at(748 + 4 * a, 4));
        TEST_ASSERT_TRUE(double_at(560 + 8 * a) == (voxels > 0 ? first + low[a] * s : DBL_MAX));
    }
    /* The file's head says it again. */
    TEST_ASSERT_EQUAL_MEMORY(grid_block + 560, file->bytes + 56, 48);
    TEST_ASSERT_EQUAL_MEMORY(grid_block + 736, file->bytes + 104, 24);
    TEST_ASSERT_EQUAL_MEMORY(grid_block + 672 + 32, file->bytes + 156, 12);
    first_leaf = 672 + number_at(672, 8);
    leaf_total = (uint32_t)number_at(672 + 32, 4);
    bytes = type == 8 ? 1 : type == 1 ? 4 : 8;
    TEST_ASSERT_EQUAL_UINT64(block_size, first_leaf + leaf_total * (uint64_t)(bytes == 1   ? 96
                                                                              : bytes == 4 ? 2144
                                                                                           : 4224));
}

/* A box of the grid's that is all set, so that it has tiles of both sizes; random bits around it. */
static void check_grid(const int32_t dims[3], const bvx_window *window, uint64_t seed, int full)
{
    static const double origin[3] = {-1.5, 2.25, 100}, spacing[3] = {0.5, 0.25, 3};
    bvx_grid g = random_grid(origin, spacing, dims, window, seed);
    bvx_buffer file = {0};
    int32_t at[3];

    if (full < 0) memset(g.words, 0, (size_t)g.word_capacity * 8);
    for (int z = 0; full > 0 && z < g.size[2]; z++)
        for (int y = 0; y < g.size[1]; y++)
            for (int x = 0; x < g.size[0]; x++)
                bvx_grid_set(&g, x, y, z,
                             full > 1 ||
                                 (x > 6 && y < 133 && z < 17 && bvx_grid_get(&g, x, y, z) + x % 50 > 9));
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_NVDB, &file),
                                    bvx_last_message(ctx));
    take_head(&file, "solid", 8, 6, &g);
    for (at[2] = 0; at[2] < g.size[2] + 9; at[2]++)
        for (at[1] = 0; at[1] < g.size[1] + 9; at[1]++)
            for (at[0] = 0; at[0] < g.size[0] + 9; at[0]++) {
                int active;
                int const set = at[0] < g.size[0] && at[1] < g.size[1] && at[2] < g.size[2] &&
                                bvx_grid_get(&g, at[0], at[1], at[2]);

                TEST_ASSERT_TRUE(voxel_value(at, &active) == set && active == set);
            }
    bvx_buffer_free(ctx, &file);
    bvx_grid_free(ctx, &g);
}

static void test_write_nvdb_holds_the_voxels(void)
{
    static const int32_t small[3] = {9, 8, 7}, high[3] = {70, 20, 140}, one[3] = {1, 1, 1};
    static const int32_t block[3] = {136, 136, 130}, wide[3] = {4100, 2, 1};
    static const bvx_window window = {{3, 1, 5}, {64, 17, 21}};

    check_grid(one, NULL, 1, 2);
    check_grid(small, NULL, 2, 0);
    check_grid(small, NULL, 2, -1);
    check_grid(high, NULL, 4, 1);
    check_grid(high, &window, 5, 0);
    check_grid(block, NULL, 6, 2);
    check_grid(wide, NULL, 7, 0);
}

static void check_field(int32_t type, double half_width)
{
    static const double p[8][3] = {{0, 0, 0}, {9, 0, 0}, {0, 9, 0}, {9, 9, 0},
                                   {0, 0, 9}, {9, 0, 9}, {0, 9, 9}, {9, 9, 9}};
    static const uint32_t box[12][3] = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                                        {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
    static const double origin[3] = {-1, -1.5, -1}, spacing[3] = {0.25, 0.3, 0.25};
    static const int32_t dims[3] = {45, 41, 44};
    bvx_mesh const m = {.positions = (void *)(uintptr_t)p,
                        .triangles = (void *)(uintptr_t)box,
                        .vertex_count = 8,
                        .triangle_count = 12,
                        .position_type = BVX_F64};
    bvx_field_options const o = {.struct_size = sizeof o, .half_width = half_width, .value_type = type};
    bvx_mesh_view view;
    bvx_lattice lattice;
    bvx_field f = {0};
    bvx_buffer file = {0};
    uint64_t next = 0;
    int32_t at[3];

    bvx_mesh_view_of(&m, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_measure_field(ctx, &view, &lattice, &o, &f));
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_field(ctx, &f, 0, BVX_FORMAT_NVDB, &file),
                                    bvx_last_message(ctx));
    take_head(&file, "distance", type == BVX_F32 ? 1 : 2, 1, &f.band);
    double const background = value_at(736 + (bytes == 8 ? 32 : 28));
    TEST_ASSERT_TRUE(background > 0.7 && background < 40);
    for (at[2] = 0; at[2] < dims[2]; at[2]++)
        for (at[1] = 0; at[1] < dims[1]; at[1]++)
            for (at[0] = 0; at[0] < dims[0]; at[0]++) {
                int const has = bvx_grid_get(&f.band, at[0], at[1], at[2]);
                double const far = bvx_grid_get(&f.inside, at[0], at[1], at[2]) ? 0.0 - background
                                                                                : background;
                double const value = !has              ? far
                                     : type == BVX_F32 ? (double)((float *)f.distances)[next]
                                                       : ((double *)f.distances)[next];
                int active;

                next += (uint64_t)has;
                TEST_ASSERT_TRUE(voxel_value(at, &active) == value);
                TEST_ASSERT_EQUAL_INT(has, active);
            }
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_write_field(ctx, &f, 1, BVX_FORMAT_NVDB, &file));
    bvx_buffer_free(ctx, &file);
    bvx_field_free(ctx, &f);
}

static void test_write_nvdb_holds_the_distances(void)
{
    check_field(BVX_F32, 0);
    check_field(BVX_F64, 4);
    check_field(BVX_F32, HUGE_VAL);
}

static bvx_grid fault_grid;

static bvx_status write_once(void *user, bvx_context *context)
{
    bvx_buffer file = {0};
    bvx_status const status = bvx_write_grid(context, &fault_grid, BVX_FORMAT_NVDB, &file);

    (void)user;
    bvx_buffer_free(context, &file);
    return status;
}

static void test_write_nvdb_when_memory_fails_or_it_is_cancelled(void)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    static const int32_t dims[3] = {20, 20, 20};
    bvx_context_options const one_thread = suite_options(1, 0);
    uint64_t allocations = 0, calls = 0;

    fault_grid = random_grid(origin, spacing, dims, NULL, 1);
    TEST_ASSERT_NULL(fault_every_allocation(write_once, NULL, &one_thread, &allocations));
    TEST_ASSERT_TRUE(allocations >= 2);
    TEST_ASSERT_NULL(fault_every_cancel(write_once, NULL, &one_thread, &calls));
    TEST_ASSERT_TRUE(calls >= 2);
    bvx_grid_free(ctx, &fault_grid);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_write_nvdb_holds_the_voxels);
    RUN_TEST(test_write_nvdb_holds_the_distances);
    RUN_TEST(test_write_nvdb_when_memory_fails_or_it_is_cancelled);
    return UNITY_END();
}
