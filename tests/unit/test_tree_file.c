/* test_tree_file.c - octrees as .bvx files: against a plain walk of the layout, read back, damaged in every
 * byte, and with damage whose checksums are right. */
#include "refine_oracle.h"
#include "suite.h"

static maker_mesh mesh;

enum { HEAD = 128, LEVEL = 24 };

void setUp(void)
{
    suite_open(1);
}

void tearDown(void)
{
    maker_free(&mesh);
    suite_close();
}

/* ---- trees ---- */

enum { WHOLE, WINDOW, TOLERANCE, TWO_SHELLS, BASE_ALONE, FAR_WINDOW, KINDS };

static bvx_octree *tree_of(int kind, int32_t levels)
{
    static const double origin[3] = {1, -2, 3};
    static const double spacing[3] = {0.5, 0.25, 1};
    static const double centre[3] = {3, -1, 5};
    static const double radius[3] = {1.7, 0.8, 1.6};
    static const int32_t dims[3] = {9, 7, 5};
    bvx_lattice base;
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_octree *tree = NULL;
    uint64_t seed = 3;

    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, radius, 0.05, 7, 9, 1024);
    if (kind == TWO_SHELLS) {
        const double inner[3] = {0.8, 0.3, 0.7};
        maker_star(&mesh, &seed, centre, inner, 0.05, 5, 7, 1024);
    }
    bvx_mesh_view const view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &base));
    o.levels = kind == BASE_ALONE ? BVX_NONE : levels;
    if (kind == TOLERANCE) o.tolerance = 0.05;
    if (kind == WINDOW || kind == FAR_WINDOW)
        for (int a = 0; a < 3; a++) {
            o.window.low[a] = kind == FAR_WINDOW ? 0 : 2 << levels;
            o.window.size[a] = kind == FAR_WINDOW ? 1 : 3;
        }
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_refine(ctx, &view, &base, &o, &tree), bvx_last_message(ctx));
    return tree;
}

static bvx_buffer file_of(const bvx_octree *tree)
{
    bvx_buffer b = {0};
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_write_octree(ctx, tree, 0, BVX_FORMAT_BVX, &b),
                                    bvx_last_message(ctx));
    return b;
}

static bvx_octree_leaf *leaves_of(const bvx_octree *tree, uint64_t *count)
{
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_leaves(ctx, tree, 7, NULL, 0, count));
    bvx_octree_leaf *const leaves = maker_grow(NULL, (size_t)*count * sizeof *leaves);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_leaves(ctx, tree, 7, leaves, *count, count));
    return leaves;
}

/* ---- a plain walk of the layout ---- */

static uint64_t get_bytes(const uint8_t *p, int n)
{
    uint64_t v = 0;
    for (int i = n; i-- > 0;) v = v << 8 | p[i];
    return v;
}

static void put_bytes(uint8_t *p, uint64_t v, int n)
{
    for (int i = 0; i < n; i++) p[i] = (uint8_t)(v >> 8 * i & 0xff);
}

static size_t level_size(const uint8_t *p)
{
    return LEVEL + (size_t)get_bytes(p + 16, 8) * 8 * (get_bytes(p + 12, 4) == 2 ? 3 : 2);
}

static const uint8_t *level_at(const uint8_t *file, int32_t level)
{
    const uint8_t *p = file + HEAD;
    while (level-- > 0) p += level_size(p);
    return p;
}

/* Bit of one of a level's arrays: bytes hold eight voxels, the lowest first. */
static int bit_at(const uint8_t *level, int array, size_t bit)
{
    size_t const n = (size_t)get_bytes(level + 16, 8) * 8;
    if (array == 2 && get_bytes(level + 12, 4) < 2)
        return get_bytes(level + 12, 4) == 1 ? bit_at(level, 0, bit) : 0;
    return level[LEVEL + (size_t)array * n + bit / 8] >> bit % 8 & 1;
}

static void walk_voxel(const uint8_t *file, int32_t level, size_t bit, const int32_t v[3],
                       const bvx_octree_leaf *leaves, uint64_t *n)
{
    const uint8_t *const p = level_at(file, level);

    if (bit_at(p, 2, bit)) {
        size_t octet = 0;
        for (size_t i = 0; i < bit; i++) octet += (size_t)bit_at(p, 2, i);
        for (int c = 0; c < 8; c++) {
            int32_t const child[3] = {2 * v[0] + (c & 1), 2 * v[1] + (c >> 1 & 1), 2 * v[2] + (c >> 2)};
            walk_voxel(file, level + 1, 8 * octet + (size_t)c, child, leaves, n);
        }
        return;
    }
    const bvx_octree_leaf *const leaf = &leaves[(*n)++];
    TEST_ASSERT_EQUAL_INT32(level, leaf->level);
    TEST_ASSERT_EQUAL_INT32_ARRAY(v, leaf->ijk, 3);
    TEST_ASSERT_EQUAL_INT32(bit_at(p, 0, bit)   ? BVX_STATE_SURFACE
                            : bit_at(p, 1, bit) ? BVX_STATE_OUTSIDE
                                                : BVX_STATE_INSIDE,
                            leaf->state);
}

static void test_files_hold_the_leaves(void)
{
    static const uint8_t magic[8] = {0x89, 0x42, 0x56, 0x4f, 0x0d, 0x0a, 0x1a, 0x0a};

    for (int kind = 0; kind < KINDS; kind++) {
        bvx_octree *const tree = tree_of(kind, 2);
        bvx_buffer b = file_of(tree);
        uint64_t count, n = 0;
        bvx_octree_leaf *const leaves = leaves_of(tree, &count);
        TEST_ASSERT_EQUAL_MEMORY(magic, b.bytes, 8);
        TEST_ASSERT_EQUAL_HEX64(bvx_hash(b.bytes, 120, 0), get_bytes(b.bytes + 120, 8));
        TEST_ASSERT_EQUAL_UINT64(9, get_bytes(b.bytes + 64, 4));
        TEST_ASSERT_EQUAL_UINT64(bvx_octree_levels(tree), get_bytes(b.bytes + 80, 4));
        for (int32_t z = 0; z < 5; z++)
            for (int32_t y = 0; y < 7; y++)
                for (int32_t x = 0; x < 9; x++) {
                    int32_t const v[3] = {x, y, z};
                    walk_voxel(b.bytes, 0, (size_t)(z * 7 + y) * 64 + (size_t)x, v, leaves, &n);
                }
        TEST_ASSERT_EQUAL_UINT64(count, n);
        TEST_ASSERT_EQUAL_UINT64(b.size,
                                 (uint64_t)(level_at(b.bytes, bvx_octree_levels(tree) + 1) - b.bytes));
        free(leaves);
        bvx_buffer_free(ctx, &b);
        bvx_octree_free(ctx, tree);
    }
}

/* ---- back again ---- */

static void assert_same_tree(const bvx_octree *a, const bvx_octree *b)
{
    uint64_t first, second;
    bvx_octree_level counts[2][26];
    bvx_lattice lattice[2];
    int32_t const levels = bvx_octree_levels(a);

    TEST_ASSERT_EQUAL_INT32(levels, bvx_octree_levels(b));
    for (int32_t l = 0; l <= levels; l++) {
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_lattice(ctx, a, l, &lattice[0]));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_lattice(ctx, b, l, &lattice[1]));
        TEST_ASSERT_EQUAL_MEMORY(&lattice[0], &lattice[1], sizeof lattice[0]);
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_count(ctx, a, counts[0], 26));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_count(ctx, b, counts[1], 26));
    TEST_ASSERT_EQUAL_MEMORY(counts[0], counts[1], (size_t)(levels + 1) * sizeof counts[0][0]);
    bvx_octree_leaf *const l = leaves_of(a, &first), *const m = leaves_of(b, &second);
    TEST_ASSERT_EQUAL_UINT64(first, second);
    TEST_ASSERT_EQUAL_MEMORY(l, m, (size_t)first * sizeof *l);
    free(l);
    free(m);
}

static void test_trees_come_back(void)
{
    for (int kind = 0; kind < KINDS; kind++)
        for (int32_t levels = 0; levels <= 5; levels++) {
            bvx_octree *const tree = tree_of(kind, levels);
            bvx_octree *back = NULL;
            bvx_buffer b = file_of(tree);
            TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_read_octree(ctx, b.bytes, b.size, &back),
                                            bvx_last_message(ctx));
            assert_same_tree(tree, back);
            bvx_buffer again = file_of(back);
            TEST_ASSERT_EQUAL_UINT64(b.size, again.size);
            TEST_ASSERT_EQUAL_MEMORY(b.bytes, again.bytes, (size_t)b.size);
            bvx_buffer_free(ctx, &again);
            bvx_buffer_free(ctx, &b);
            bvx_octree_free(ctx, back);
            bvx_octree_free(ctx, tree);
        }
}

static void test_threads_do_not_show(void)
{
    bvx_octree *const tree = tree_of(TOLERANCE, 4);
    bvx_octree *back = NULL;
    bvx_buffer b = file_of(tree), other = {0};
    bvx_context_options o = {.struct_size = sizeof o};
    bvx_context *many;

    o.threads = 4;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &many));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_octree(many, tree, 0, BVX_FORMAT_BVX, &other));
    TEST_ASSERT_EQUAL_UINT64(b.size, other.size);
    TEST_ASSERT_EQUAL_MEMORY(b.bytes, other.bytes, (size_t)b.size);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_read_octree(many, b.bytes, b.size, &back));
    assert_same_tree(tree, back);
    bvx_octree_free(many, back);
    bvx_buffer_free(many, &other);
    bvx_buffer_free(ctx, &b);
    bvx_octree_free(ctx, tree);
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(many));
    bvx_context_destroy(many);
}

/* ---- damage ---- */

/* Read from a block of exactly this size: an error with words, nothing allocated, or a tree. */
static bvx_octree *read_exact(const uint8_t *bytes, size_t size)
{
    uint8_t *const exact = maker_grow(NULL, size > 0 ? size : 1);
    bvx_octree *tree = NULL;
    uint64_t const used = bvx_memory_used(ctx);

    memcpy(exact, bytes, size);
    bvx_memory_reset_peak(ctx);
    bvx_status const status = bvx_read_octree(ctx, exact, size, &tree);
    free(exact);
    TEST_ASSERT_EQUAL_INT(status == BVX_OK, tree != NULL);
    if (status == BVX_OK) return tree;
    TEST_ASSERT_TRUE(status == BVX_ERR_FORMAT || status == BVX_ERR_UNSUPPORTED);
    TEST_ASSERT_TRUE(strlen(bvx_last_message(ctx)) > 10);
    TEST_ASSERT_NULL(strchr(bvx_last_message(ctx), '\n'));
    TEST_ASSERT_EQUAL_UINT64(used, bvx_memory_peak(ctx));
    return NULL;
}

static void test_every_cut_and_every_bit(void)
{
    static const int kinds[3] = {WHOLE, TOLERANCE, FAR_WINDOW};

    for (int k = 0; k < 3; k++) {
        bvx_octree *const tree = tree_of(kinds[k], 2);
        bvx_buffer b = file_of(tree);
        uint8_t *const longer = maker_grow(NULL, (size_t)b.size + 8);
        for (size_t n = 0; n < b.size; n++) TEST_ASSERT_NULL(read_exact(b.bytes, n));
        for (size_t n = 0; n < b.size; n++)
            for (int bit = 0; bit < 8; bit++) {
                b.bytes[n] ^= (uint8_t)(1 << bit);
                TEST_ASSERT_NULL(read_exact(b.bytes, (size_t)b.size));
                b.bytes[n] ^= (uint8_t)(1 << bit);
            }
        memcpy(longer, b.bytes, (size_t)b.size);
        memset(longer + b.size, 0, 8);
        for (size_t n = 1; n <= 8; n++) TEST_ASSERT_NULL(read_exact(longer, (size_t)b.size + n));
        free(longer);
        bvx_buffer_free(ctx, &b);
        bvx_octree_free(ctx, tree);
    }
}

/* Right checksums, as far as the levels can be followed. */
static void seal(uint8_t *file, size_t size)
{
    size_t at = HEAD;

    put_bytes(file + 120, bvx_hash(file, 120, 0), 8);
    while (size - at >= LEVEL) {
        uint64_t const words = get_bytes(file + at + 16, 8);
        if (words > (size - at) / 16 || level_size(file + at) > size - at) return;
        put_bytes(file + at, bvx_hash(file + at + 8, level_size(file + at) - 8, bvx_hash(file + 16, 104, 0)),
                  8);
        at += level_size(file + at);
    }
}

/* Whatever a tree says, asking it is safe. */
static void use_tree(const bvx_octree *tree, const uint8_t *bytes, size_t size)
{
    const double ray[6] = {0, -3, 2, 0.9, 0.4, 0.7};
    bvx_buffer b = file_of(tree);
    uint64_t count;
    bvx_octree_hit hit;
    bvx_grid grid = {0};

    TEST_ASSERT_EQUAL_UINT64(size, b.size);
    TEST_ASSERT_EQUAL_MEMORY(bytes, b.bytes, size);
    bvx_buffer_free(ctx, &b);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_leaves(ctx, tree, 7, NULL, 0, &count));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_cast(ctx, tree, 0, ray, 1, 100, &hit));
    bvx_status const status = bvx_octree_expand(
        ctx, tree, bvx_octree_levels(tree) < 3 ? bvx_octree_levels(tree) : 3, 5, NULL, &grid);
    /* a coarser level's lattice */
    TEST_ASSERT_TRUE(status == BVX_OK || status == BVX_ERR_RANGE || status == BVX_ERR_ARGUMENT);
    bvx_grid_free(ctx, &grid);
}

static void test_sealed_damage(void)
{
    static const int kinds[3] = {WHOLE, TOLERANCE, BASE_ALONE};
    int read = 0, refused = 0;

    for (int k = 0; k < 3; k++) {
        bvx_octree *const tree = tree_of(kinds[k], 2);
        bvx_buffer b = file_of(tree);
        uint8_t *const work = maker_grow(NULL, (size_t)b.size);
        for (size_t n = 0; n < b.size; n++)
            for (int bit = 0; bit < 8; bit++) {
                memcpy(work, b.bytes, (size_t)b.size);
                work[n] ^= (uint8_t)(1 << bit);
                seal(work, (size_t)b.size);
                bvx_octree *const other = read_exact(work, (size_t)b.size);
                read += other != NULL;
                refused += other == NULL;
                if (other != NULL) use_tree(other, work, (size_t)b.size);
                bvx_octree_free(ctx, other);
            }
        free(work);
        bvx_buffer_free(ctx, &b);
        bvx_octree_free(ctx, tree);
    }
    TEST_ASSERT_GREATER_THAN(1000, read); /* origins, spacings, outside voxels that are reported inside */
    TEST_ASSERT_GREATER_THAN(1000, refused);
}

/* ---- refusals ---- */

/* One number of a file changed, with right checksums. */
static void refuse_number(size_t at, uint64_t value, int n, const char *words)
{
    bvx_octree *const tree = tree_of(TOLERANCE, 2);
    bvx_buffer b = file_of(tree);

    put_bytes(b.bytes + at, value, n);
    seal(b.bytes, (size_t)b.size);
    TEST_ASSERT_NULL(read_exact(b.bytes, (size_t)b.size));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), words), bvx_last_message(ctx));
    bvx_buffer_free(ctx, &b);
    bvx_octree_free(ctx, tree);
}

static void test_what_is_wrong_is_told(void)
{
    refuse_number(4, 0, 1, "took the file for text");
    refuse_number(8, 2, 4, "version 2");
    refuse_number(8, 0, 4, "no version 0");
    refuse_number(12, 127, 4, "a head of 127");
    refuse_number(16, UINT64_C(0x7ff0000000000000), 8, "origin");
    refuse_number(40, 0, 8, "spacing");
    refuse_number(64, 0, 4, "base of 0 voxels along x");
    refuse_number(68, 1 << 24, 4, "along y");
    refuse_number(72, 0xffffffff, 4, "along z");
    refuse_number(64, UINT64_C(0x0010000000100000), 8, "fewer than 2^31"); /* 2^20 x 2^20 x 5 */
    refuse_number(64, 1 << 23, 4, "fraction bits");
    refuse_number(76, 17, 4, "fraction bits");
    refuse_number(80, 26, 4, "level 26 is the last");
    refuse_number(80, 1, 4, "cannot be split");
    refuse_number(90, 1, 1, "byte 90: a reserved byte");
    refuse_number(64, 70, 4, "level 0 has 35 words, its base 70");
    refuse_number(HEAD + 8, 1, 4, "level 1 stands where 0 belongs");
    refuse_number(HEAD + 12, 3, 4, "split in way 3");
    refuse_number(HEAD + 16, UINT64_MAX, 8, "ends before");
    refuse_number(HEAD + 16, UINT64_C(1) << 60, 8, "ends before");
    refuse_number(HEAD + LEVEL + 2, 1, 1, "bits past its voxels");
}

static void test_refusals(void)
{
    bvx_octree *const tree = tree_of(WHOLE, 1);
    bvx_octree *back = NULL;
    bvx_buffer b = {0}, grid_file = {0};
    bvx_grid grid = {0}, no_grid = {0};

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvx_write_octree(ctx, tree, BVX_STATE_INSIDE, BVX_FORMAT_BVX, &b));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "the whole tree"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_UNSUPPORTED, bvx_write_octree(ctx, tree, 0, BVX_FORMAT_NPY, &b));
    b = file_of(tree);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_octree(NULL, b.bytes, b.size, &back));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_octree(ctx, NULL, b.size, &back));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_read_octree(ctx, b.bytes, b.size, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, bvx_read_octree(ctx, b.bytes, 0, &back));
    TEST_ASSERT_NULL(back);

    /* grids and trees have one ending, and are distinguished */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT,
                            bvx_read_grid(ctx, b.bytes, b.size, BVX_FORMAT_BVX, NULL, &no_grid));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "bvx_read_octree"));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_expand(ctx, tree, 1, 0, NULL, &grid));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_write_grid(ctx, &grid, BVX_FORMAT_BVX, &grid_file));
    back = NULL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_FORMAT, bvx_read_octree(ctx, grid_file.bytes, grid_file.size, &back));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "bvx_read_grid"));
    bvx_grid_free(ctx, &grid);
    bvx_buffer_free(ctx, &grid_file);
    bvx_buffer_free(ctx, &b);
    bvx_octree_free(ctx, tree);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_files_hold_the_leaves);
    RUN_TEST(test_trees_come_back);
    RUN_TEST(test_threads_do_not_show);
    RUN_TEST(test_every_cut_and_every_bit);
    RUN_TEST(test_sealed_damage);
    RUN_TEST(test_what_is_wrong_is_told);
    RUN_TEST(test_refusals);
    return UNITY_END();
}
