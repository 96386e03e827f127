/* test_write_vdb.c - grids and fields as OpenVDB's files, taken apart by a plain reader of version 224 that was written
 * from the format's description. What it reads was compared with OpenVDB 10 once. */
#include "dense_file_support.h"

enum { NODES = 4096 * 8 };

static const uint8_t *at, *end;
static int bytes; /* of a number */

static const uint8_t *take(size_t n)
{
    TEST_ASSERT_TRUE_MESSAGE((size_t)(end - at) >= n, "the file is too short");
    at += n;
    return at - n;
}

static uint64_t take_number(int n)
{
    const uint8_t *const p = take((size_t)n);
    uint64_t v = 0;
    for (int i = n; i-- > 0;) v = v << 8 | p[i];
    return v;
}

static double take_value(void)
{
    uint64_t const bits = take_number(bytes);
    uint32_t const low = (uint32_t)bits;
    double v;
    float f;

    memcpy(&v, &bits, sizeof v);
    memcpy(&f, &low, sizeof f);
    return bytes == 1 ? (double)bits : bytes == 4 ? (double)f : v;
}

static void expect_text(const char *text)
{
    size_t const n = strlen(text);
    TEST_ASSERT_EQUAL_UINT64(n, take_number(4));
    TEST_ASSERT_TRUE(memcmp(text, take(n), n) == 0);
}

static double take_double(void)
{
    uint64_t const bits = take_number(8);
    double v;
    memcpy(&v, &bits, sizeof v);
    return v;
}

static int bit_of(const uint8_t *mask, int i)
{
    return mask[i / 8] >> i % 8 & 1;
}

/* What stands at each voxel of the window; voxels beyond it must be outside. */
typedef struct tree {
    const int32_t *size;
    double *value;
    uint8_t *active;
    double background;
} tree;

static void put_voxels(const tree *t, int x, int y, int z, int side, double value, int active)
{
    int const last[3] = {x + side < t->size[0] ? x + side : t->size[0],
                         y + side < t->size[1] ? y + side : t->size[1],
                         z + side < t->size[2] ? z + side : t->size[2]};

    if (last[0] < x + side || last[1] < y + side || last[2] < z + side)
        TEST_ASSERT_TRUE(!active && value == t->background);
    for (int k = z; k < last[2]; k++)
        for (int j = y; j < last[1]; j++)
            for (int i = x; i < last[0]; i++) {
                size_t const to = ((size_t)k * (size_t)t->size[1] + (size_t)j) * (size_t)t->size[0] +
                                  (size_t)i;

                t->value[to] = value;
                t->active[to] = (uint8_t)active;
            }
}

/* Values by the mask of active ones: the others are the background, or its negative where a mask selects. */
static void take_values(double *value, int count, const uint8_t *active, double background)
{
    uint64_t const kind = take_number(1);
    const uint8_t *selected = NULL;

    TEST_ASSERT_TRUE(kind == 0 || kind == 3);
    if (kind == 3) selected = take((size_t)count / 8);
    for (int i = 0; i < count; i++)
        value[i] = bit_of(active, i)                          ? take_value()
                   : selected != NULL && !bit_of(selected, i) ? 0.0 - background
                                                              : background;
}

static void take_leaf(const tree *t, int x, int y, int z, const uint8_t *topology)
{
    const uint8_t *const active = take(64), *bits;
    double value[512];

    TEST_ASSERT_EQUAL_MEMORY(topology, active, 64);
    if (bytes == 1) {
        TEST_ASSERT_EQUAL_UINT64(x, take_number(4));
        TEST_ASSERT_EQUAL_UINT64(y, take_number(4));
        TEST_ASSERT_EQUAL_UINT64(z, take_number(4));
        bits = take(64);
        for (int i = 0; i < 512; i++) value[i] = bit_of(bits, i);
    } else {
        take_values(value, 512, active, t->background);
    }
    for (int i = 0; i < 512; i++)
        put_voxels(t, x + i / 64, y + i / 8 % 8, z + i % 8, 1, value[i], bit_of(active, i));
}

static struct {
    int x, y, z;
    const uint8_t *topology;
} leaves[NODES];
static int leaf_count;

/* Tiles go to the voxels, leaves to the list. */
static void take_node(const tree *t, int level, int x, int y, int z)
{
    int const log = level == 2 ? 5 : 4, count = 1 << 3 * log, side = level == 2 ? 128 : 8;
    const uint8_t *const below = take((size_t)count / 8), *const active = take((size_t)count / 8);
    double *const value = malloc((size_t)count * sizeof *value);

    take_values(value, count, active, t->background);
    for (int i = 0; i < count; i++) {
        int const p[3] = {x + (i >> 2 * log) * side, y + (i >> log) % (1 << log) * side,
                          z + i % (1 << log) * side};

        if (!bit_of(below, i)) {
            put_voxels(t, p[0], p[1], p[2], side, value[i], bit_of(active, i));
        } else if (level == 2) {
            take_node(t, 1, p[0], p[1], p[2]);
        } else {
            TEST_ASSERT_TRUE(leaf_count < NODES);
            leaves[leaf_count].x = p[0];
            leaves[leaf_count].y = p[1];
            leaves[leaf_count].z = p[2];
            leaves[leaf_count++].topology = take(64);
        }
    }
    free(value);
}

static void take_file(const bvx_buffer *file, const char *name, const char *type, int classed,
                      const bvx_grid *g, tree *t)
{
    static const uint8_t head[] = {0x20, 'B', 'D', 'V', 0, 0, 0, 0, 224, 0, 0, 0, 9, 0, 0, 0, 0, 0, 0, 0, 1};
    uint64_t places[3];

    at = file->bytes;
    end = at + file->size;
    TEST_ASSERT_EQUAL_MEMORY(head, take(sizeof head), sizeof head);
    take(36);
    TEST_ASSERT_EQUAL_UINT64(0, take_number(4));
    TEST_ASSERT_EQUAL_UINT64(1, take_number(4));
    expect_text(name);
    expect_text(type);
    expect_text("");
    for (int i = 0; i < 3; i++) places[i] = take_number(8);
    TEST_ASSERT_EQUAL_UINT64(at - file->bytes, places[0]);
    TEST_ASSERT_EQUAL_UINT64(2, take_number(4));
    TEST_ASSERT_EQUAL_UINT64(1 + classed, take_number(4));
    expect_text("name"), expect_text("string"), expect_text(name);
    if (classed) expect_text("class"), expect_text("string"), expect_text("level set");
    expect_text("ScaleTranslateMap");
    for (int a = 0; a < 3; a++)
        TEST_ASSERT_TRUE(take_double() == g->lattice.origin[a] + g->low[a] * g->lattice.spacing[a] +
                                              0.5 * g->lattice.spacing[a]);
    for (int a = 0; a < 6; a++) TEST_ASSERT_TRUE(take_double() == g->lattice.spacing[a % 3]);
    take(72);
    TEST_ASSERT_EQUAL_UINT64(1, take_number(4));
    t->background = take_value();
    TEST_ASSERT_EQUAL_UINT64(0, take_number(4));
    leaf_count = 0;
    for (uint64_t left = take_number(4); left > 0; left--) {
        int const x = (int)take_number(4), y = (int)take_number(4), z = (int)take_number(4);
        take_node(t, 2, x, y, z);
    }
    TEST_ASSERT_EQUAL_UINT64(at - file->bytes, places[1]);
    for (int i = 0; i < leaf_count; i++)
        take_leaf(t, leaves[i].x, leaves[i].y, leaves[i].z, leaves[i].topology);
    TEST_ASSERT_EQUAL_UINT64(at - file->bytes, places[2]);
    TEST_ASSERT_TRUE(at == end);
}

static tree new_tree(const bvx_grid *g)
{
    size_t const n = (size_t)g->size[0] * (size_t)g->size[1] * (size_t)g->size[2];
    tree const t = {g->size, calloc(n, sizeof(double)), calloc(n, 1), 0.0};

    TEST_ASSERT_TRUE(t.value != NULL && t.active != NULL);
    return t;
}

static void free_tree(tree *t)
{
    free(t->value);
    free(t->active);
}

/* A box of the grid's that is all set, so that it has tiles of both sizes; random bits around it. */
static void check_grid(const int32_t dims[3], const bvx_window *window, uint64_t seed, int full)
{
    static const double origin[3] = {-1.5, 2.25, 100}, spacing[3] = {0.5, 0.25, 3};
    bvx_grid g = random_grid(origin, spacing, dims, window, seed);
    tree t = new_tree(&g);
    bvx_buffer file = {0};
    size_t i = 0;

    for (int z = 0; full && z < g.size[2]; z++)
        for (int y = 0; y < g.size[1]; y++)
            for (int x = 0; x < g.size[0]; x++)
                bvx_grid_set(&g, x, y, z,
                             full > 1 ||
                                 (x > 6 && y < 133 && z < 17 && bvx_grid_get(&g, x, y, z) + x % 50 > 9));
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_VDB, &file),
                                    bvx_last_message(ctx));
    bytes = 1;
    take_file(&file, "solid", "Tree_bool_5_4_3", 0, &g, &t);
    for (int z = 0; z < g.size[2]; z++)
        for (int y = 0; y < g.size[1]; y++)
            for (int x = 0; x < g.size[0]; x++, i++) {
                TEST_ASSERT_EQUAL_UINT8(bvx_grid_get(&g, x, y, z), t.active[i]);
                TEST_ASSERT_TRUE(t.value[i] == t.active[i]);
            }
    free_tree(&t);
    bvx_buffer_free(ctx, &file);
    bvx_grid_free(ctx, &g);
}

static void test_write_vdb_holds_the_voxels(void)
{
    static const int32_t small[3] = {9, 8, 7}, long_one[3] = {300, 3, 9}, high[3] = {70, 20, 140},
                         one[3] = {1, 1, 1};
    static const int32_t block[3] = {136, 136, 130}, wide[3] = {4100, 2, 1};
    static const bvx_window window = {{3, 1, 5}, {64, 17, 21}};

    check_grid(one, NULL, 1, 0);
    check_grid(small, NULL, 2, 0);
    check_grid(long_one, NULL, 3, 1);
    check_grid(high, NULL, 4, 1);
    check_grid(high, &window, 5, 0);
    check_grid(block, NULL, 6, 2);
    check_grid(wide, NULL, 7, 0);
}

static void test_write_vdb_of_an_empty_grid(void)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 2, 1};
    static const int32_t dims[3] = {20, 20, 20};
    bvx_grid g = random_grid(origin, spacing, dims, NULL, 1);
    tree t = new_tree(&g);
    bvx_buffer file = {0};

    memset(g.words, 0, (size_t)g.word_capacity * 8);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &g, BVX_FORMAT_VDB, &file));
    bytes = 1;
    take_file(&file, "solid", "Tree_bool_5_4_3", 0, &g, &t);
    TEST_ASSERT_EQUAL_INT(0, leaf_count);
    free_tree(&t);
    bvx_buffer_free(ctx, &file);
    bvx_grid_free(ctx, &g);
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
    size_t i = 0;
    tree t;

    bvx_mesh_view_of(&m, &view);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_measure_field(ctx, &view, &lattice, &o, &f));
    t = new_tree(&f.band);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_field(ctx, &f, 0, BVX_FORMAT_VDB, &file),
                                    bvx_last_message(ctx));
    bytes = type == BVX_F32 ? 4 : 8;
    take_file(&file, "distance", type == BVX_F32 ? "Tree_float_5_4_3" : "Tree_double_5_4_3", 1, &f.band, &t);
    for (int z = 0; z < dims[2]; z++)
        for (int y = 0; y < dims[1]; y++)
            for (int x = 0; x < dims[0]; x++, i++) {
                int const has = bvx_grid_get(&f.band, x, y, z);
                double const far = bvx_grid_get(&f.inside, x, y, z) ? 0.0 - t.background : t.background;
                double const value = !has              ? far
                                     : type == BVX_F32 ? (double)((float *)f.distances)[next]
                                                       : ((double *)f.distances)[next];

                next += (uint64_t)has;
                TEST_ASSERT_EQUAL_INT(has, t.active[i]);
                TEST_ASSERT_TRUE(value == t.value[i]);
            }
    TEST_ASSERT_TRUE(t.background > 0.7 && t.background < 40);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_write_field(ctx, &f, 1, BVX_FORMAT_VDB, &file));
    free_tree(&t);
    bvx_buffer_free(ctx, &file);
    bvx_field_free(ctx, &f);
}

static void test_write_vdb_holds_the_distances(void)
{
    check_field(BVX_F64, 4);
    if (quick) return;
    check_field(BVX_F32, 0);
    check_field(BVX_F32, HUGE_VAL);
}

static bvx_grid fault_grid;

static bvx_status write_once(void *user, bvx_context *context)
{
    bvx_buffer file = {0};
    bvx_status const status = bvx_write_grid(context, &fault_grid, BVX_FORMAT_VDB, &file);

    (void)user;
    bvx_buffer_free(context, &file);
    return status;
}

static void test_write_vdb_when_memory_fails_or_it_is_cancelled(void)
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
    RUN_TEST(test_write_vdb_holds_the_voxels);
    RUN_TEST(test_write_vdb_of_an_empty_grid);
    RUN_TEST(test_write_vdb_holds_the_distances);
    RUN_TEST(test_write_vdb_when_memory_fails_or_it_is_cancelled);
    return UNITY_END();
}
