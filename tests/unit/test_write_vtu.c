/* test_write_vtu.c - octrees as VTK unstructured grids, taken apart again. */
#include "io/bytes.h"
#include "tools/mesh_maker.h"

#include "suite.h"

static bvx_octree *tree;

void setUp(void)
{
    static const double origin[3] = {-3.5, 10, 1.0 / 3}, spacing[3] = {1, 0.5, 3};
    static const int32_t dims[3] = {4, 3, 5};
    double low[3], high[3];
    bvx_lattice base;
    bvx_refine_options o = {.struct_size = sizeof o};
    maker_mesh m = {0};

    suite_open(0);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &base));
    for (int a = 0; a < 3; a++) {
        low[a] = origin[a] + 0.3 * spacing[a];
        high[a] = origin[a] + (dims[a] - 0.4) * spacing[a];
    }
    maker_box(&m, low, high);
    bvx_mesh_view const view = maker_view(&m);
    o.levels = 3;
    tree = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_refine(ctx, &view, &base, &o, &tree));
    maker_free(&m);
}

void tearDown(void)
{
    bvx_octree_free(ctx, tree);
    suite_close();
}

/* The number behind a text in the file's head. */
static uint64_t number_after(const char *head, const char *text)
{
    const char *const at = strstr(head, text);
    TEST_ASSERT_NOT_NULL(at);
    return (uint64_t)strtoull(at + strlen(text), NULL, 10);
}

/* The array at the offset that stands behind a name; its size must be as told. */
static const uint8_t *array_of(const char *head, const uint8_t *data, const char *name, uint64_t size)
{
    const char *const at = strstr(head, name);
    TEST_ASSERT_NOT_NULL(at);
    const uint8_t *const array = data + number_after(at, "offset=\"");
    TEST_ASSERT_EQUAL_UINT64(size, bvxi_load_u64(array, 0));
    return array + 8;
}

static void test_each_leaf_has_its_corners(void)
{
    static const char mark[] = "<AppendedData encoding=\"raw\">\n    _";
    bvx_buffer file = {0};
    bvx_lattice lattice;
    uint64_t count = 0, cells, points;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_octree(ctx, tree, 0, BVX_FORMAT_VTU, &file));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_leaves(ctx, tree, 0, NULL, 0, &count));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_lattice(ctx, tree, 3, &lattice));
    bvx_octree_leaf *const leaf = maker_grow(NULL, (size_t)count * sizeof *leaf);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_leaves(ctx, tree, 0, leaf, count, &count));
    char *const head = maker_grow(NULL, (size_t)file.size + 1);
    memcpy(head, file.bytes, (size_t)file.size);
    head[file.size] = 0;
    const char *const raw = strstr(head, mark);
    TEST_ASSERT_NOT_NULL(raw);
    const uint8_t *const data = file.bytes + (raw - head) + sizeof mark - 1;
    cells = number_after(head, "NumberOfCells=\"");
    points = number_after(head, "NumberOfPoints=\"");
    TEST_ASSERT_EQUAL_UINT64(count, cells);
    const uint8_t *const at = array_of(head, data, "<Points>", 24 * points);
    const uint8_t *const corners = array_of(head, data, "\"connectivity\"", 32 * cells);
    const uint8_t *const offsets = array_of(head, data, "\"offsets\"", 4 * cells);
    const uint8_t *const types = array_of(head, data, "\"types\"", cells);
    const uint8_t *const levels = array_of(head, data, "Name=\"level\"", cells);
    const uint8_t *const states = array_of(head, data, "Name=\"state\"", cells);
    for (uint64_t n = 0; n < cells; n++) {
        int32_t const side = 1 << (3 - leaf[n].level);
        TEST_ASSERT_EQUAL_UINT8(leaf[n].level, levels[n]);
        TEST_ASSERT_EQUAL_UINT8(leaf[n].state, states[n]);
        TEST_ASSERT_EQUAL_UINT8(11, types[n]);
        TEST_ASSERT_EQUAL_UINT32(8 * n + 8, bvxi_load_u32(offsets + 4 * n, 0));
        for (int c = 0; c < 8; c++) {
            uint32_t const p = bvxi_load_u32(corners + 32 * n + 4 * c, 0);
            TEST_ASSERT_LESS_THAN(points, p);
            for (int a = 0; a < 3; a++) {
                double const want = lattice.origin[a] +
                                    (double)((leaf[n].ijk[a] + (c >> a & 1)) * side) * lattice.spacing[a];
                TEST_ASSERT_EQUAL_MEMORY(&want, &(double){bvxi_load_f64(at + 24 * (size_t)p + 8 * a, 0)},
                                         sizeof want);
            }
        }
    }
    /* sorted: no two equal */
    for (uint64_t p = 1; p < points; p++)
        TEST_ASSERT_NOT_EQUAL(0, memcmp(at + 24 * p, at + 24 * (p - 1), 24));
    TEST_ASSERT_EQUAL_STRING("\n  </AppendedData>\n</VTKFile>\n",
                             head + ((const uint8_t *)states + cells - file.bytes));
    bvx_buffer_free(ctx, &file);
    free(head);
    free(leaf);
}

static void test_refusals(void)
{
    bvx_buffer file = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_octree(NULL, tree, 0, BVX_FORMAT_VTU, &file));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_octree(ctx, NULL, 0, BVX_FORMAT_VTU, &file));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_octree(ctx, tree, 0, BVX_FORMAT_VTU, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_write_octree(ctx, tree, 9, BVX_FORMAT_VTU, &file));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_write_octree(ctx, tree, 0, BVX_FORMAT_VTI, &file));
    TEST_ASSERT_EQUAL_INT32(BVX_FORMAT_VTU, bvx_format_of_name("a.VTU"));
    TEST_ASSERT_NULL(file.bytes);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_octree(ctx, tree, BVX_STATE_OUTSIDE, BVX_FORMAT_VTU, &file));
    /* its bytes are made anew */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_octree(ctx, tree, 0, BVX_FORMAT_VTU, &file));
    bvx_buffer_free(ctx, &file);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_each_leaf_has_its_corners);
    RUN_TEST(test_refusals);
    return UNITY_END();
}
