/* test_refine.c - octrees against the uniform surface and a plain flood around it. */
#include "refine_oracle.h"
#include "suite.h"

#include <stdio.h>

void setUp(void)
{
    suite_open(1);
}

void tearDown(void)
{
    suite_close();
}

static void base_of(int32_t nx, int32_t ny, int32_t nz, double spacing, bvx_lattice *base)
{
    const double origin[3] = {0, 0, 0}, s[3] = {spacing, spacing, spacing};
    const int32_t dims[3] = {nx, ny, nz};
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, s, dims, base));
}

static bvx_octree *refined(bvx_context *c, const bvx_mesh_view *view, const bvx_lattice *base, int32_t levels,
                           int32_t start)
{
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_octree *tree = NULL;

    o.levels = levels != 0 ? levels : BVX_NONE;
    o.start_level = start < 0 ? 0 : start != 0 ? start : BVX_NONE;
    bvx_status const status = bvx_refine(c, view, base, &o, &tree);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(c));
    return tree;
}

/* ---- a tree against the uniform grid ---- */

static void assert_last_level(bvx_context *c, const bvx_octree *tree, const uniform *u)
{
    bvx_grid grid[3] = {{0}, {0}, {0}};

    for (int s = 0; s < 3; s++)
        TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                bvx_octree_expand(c, tree, bvx_octree_levels(tree), 1 << s, NULL, &grid[s]));
    for (int32_t z = 0; z < u->lattice.dims[2]; z++)
        for (int32_t y = 0; y < u->lattice.dims[1]; y++)
            for (int32_t x = 0; x < u->lattice.dims[0]; x++) {
                int state = 0;
                for (int s = 0; s < 3; s++) state |= bvx_grid_get(&grid[s], x, y, z) << s;
                if (state != u->state[uniform_at(u, x, y, z)]) {
                    char text[100];
                    snprintf(text, sizeof text, "voxel %d %d %d is %d, not %d", x, y, z, state,
                             u->state[uniform_at(u, x, y, z)]);
                    TEST_FAIL_MESSAGE(text);
                }
            }
    for (int s = 0; s < 3; s++) bvx_grid_free(c, &grid[s]);
}

/* A leaf of a coarse level is of one state all over; a voxel that is split
 * there has a surface voxel in it. Counts agree. */
static void assert_coarse_level(bvx_context *c, const bvx_octree *tree, const uniform *u, int32_t level)
{
    int32_t const side = 1 << (bvx_octree_levels(tree) - level);
    bvx_octree_level counts[26];
    uint64_t surface = 0;
    bvx_grid grid[3] = {{0}, {0}, {0}};

    for (int s = 0; s < 3; s++)
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_expand(c, tree, level, 1 << s, NULL, &grid[s]));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_count(c, tree, counts, 26));
    for (int32_t z = 0; z < grid[0].size[2]; z++)
        for (int32_t y = 0; y < grid[0].size[1]; y++)
            for (int32_t x = 0; x < grid[0].size[0]; x++) {
                int seen = 0, state = 0;
                for (int32_t k = 0; k < side; k++)
                    for (int32_t j = 0; j < side; j++)
                        for (int32_t i = 0; i < side; i++)
                            seen |= u->state[uniform_at(u, x * side + i, y * side + j, z * side + k)];
                for (int s = 0; s < 3; s++) state |= bvx_grid_get(&grid[s], x, y, z) << s;
                TEST_ASSERT_EQUAL_INT((seen & BVX_STATE_SURFACE) != 0 ? BVX_STATE_SURFACE : seen, state);
                surface += state == BVX_STATE_SURFACE;
            }
    TEST_ASSERT_EQUAL_UINT64(surface, counts[level].split + counts[level].surface);
    for (int s = 0; s < 3; s++) bvx_grid_free(c, &grid[s]);
}

/* Every leaf covers voxels of its state, each voxel has one leaf, and looking one up finds it. */
static void assert_leaves(bvx_context *c, const bvx_octree *tree, const uniform *u)
{
    bvx_octree_level counts[26];
    uint64_t count = 0, again = 0, covered = 0, by_counts = 0;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_leaves(c, tree, 7, NULL, 0, &count));
    bvx_octree_leaf *const leaves = maker_grow(NULL, (size_t)count * sizeof *leaves);
    int32_t *const low = maker_grow(NULL, (size_t)count * 12);
    bvx_octree_leaf *const found = maker_grow(NULL, (size_t)count * sizeof *found);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_octree_leaves(c, tree, 7, leaves, count - 1, &again));
    TEST_ASSERT_EQUAL_UINT64(count, again);
    again = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_leaves(c, tree, 7, leaves, count, &again));
    TEST_ASSERT_EQUAL_UINT64(count, again);
    for (uint64_t n = 0; n < count; n++) {
        int32_t const side = 1 << (bvx_octree_levels(tree) - leaves[n].level);
        for (int a = 0; a < 3; a++) low[3 * n + (uint64_t)a] = leaves[n].ijk[a] * side;
        for (int32_t k = 0; k < side; k++)
            for (int32_t j = 0; j < side; j++)
                for (int32_t i = 0; i < side; i++)
                    TEST_ASSERT_EQUAL_UINT8(
                        leaves[n].state,
                        u->state[uniform_at(u, low[3 * n] + i, low[3 * n + 1] + j, low[3 * n + 2] + k)]);
        covered += (uint64_t)side * (uint64_t)side * (uint64_t)side;
    }
    TEST_ASSERT_EQUAL_UINT64(u->count, covered);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_at(c, tree, low, count, found));
    TEST_ASSERT_EQUAL_MEMORY(leaves, found, (size_t)count * sizeof *found);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_count(c, tree, counts, 26));
    for (int32_t l = 0; l <= bvx_octree_levels(tree); l++)
        by_counts += counts[l].surface + counts[l].inside + counts[l].outside;
    TEST_ASSERT_EQUAL_UINT64(count, by_counts);
    free(leaves);
    free(low);
    free(found);
}

static void assert_window(bvx_context *c, const bvx_octree *tree, const uniform *u, uint64_t *seed)
{
    bvx_window w;
    bvx_grid grid = {0};

    for (int a = 0; a < 3; a++) {
        w.low[a] = maker_below(seed, u->lattice.dims[a]);
        w.size[a] = 1 + maker_below(seed, u->lattice.dims[a] - w.low[a]);
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_expand(c, tree, bvx_octree_levels(tree), 0, &w, &grid));
    for (int32_t z = 0; z < w.size[2]; z++)
        for (int32_t y = 0; y < w.size[1]; y++)
            for (int32_t x = 0; x < w.size[0]; x++)
                TEST_ASSERT_EQUAL_INT(u->state[uniform_at(u, w.low[0] + x, w.low[1] + y, w.low[2] + z)] !=
                                          BVX_STATE_OUTSIDE,
                                      bvx_grid_get(&grid, x, y, z));
    bvx_grid_free(c, &grid);
}

/* Two trees expand to the same bits. */
static void assert_same_tree(bvx_context *c, const bvx_octree *a, const bvx_octree *b)
{
    for (int32_t level = 0; level <= bvx_octree_levels(a); level++)
        for (int s = 0; s < 3; s++) {
            bvx_grid g = {0}, h = {0};
            uint64_t first = 1, second = 2;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_expand(c, a, level, 1 << s, NULL, &g));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_expand(c, b, level, 1 << s, NULL, &h));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(c, &g, &first));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(c, &h, &second));
            TEST_ASSERT_EQUAL_HEX64(first, second);
            bvx_grid_free(c, &g);
            bvx_grid_free(c, &h);
        }
}

/* All of it; and the same tree for every start level. */
static void check_refined(bvx_context *c, const maker_mesh *m, const bvx_lattice *base, int32_t levels,
                          size_t inside[1])
{
    bvx_mesh_view const view = maker_view(m);
    uint64_t seed = 5;
    uniform u;
    bvx_lattice lattice;
    bvx_octree *const tree = refined(c, &view, base, levels, -1);

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_lattice(c, tree, levels, &lattice));
    uniform_make(c, &view, &lattice, &u);
    assert_last_level(c, tree, &u);
    for (int32_t l = 0; l <= levels; l++) assert_coarse_level(c, tree, &u, l);
    assert_leaves(c, tree, &u);
    for (int n = 0; n < 5; n++) assert_window(c, tree, &u, &seed);
    for (int32_t start = 0; start <= levels; start++) {
        bvx_octree *const other = refined(c, &view, base, levels, start);
        assert_same_tree(c, tree, other);
        bvx_octree_free(c, other);
    }
    bvx_octree_free(c, tree);
    *inside = uniform_count(&u, BVX_STATE_INSIDE);
    uniform_free(&u);
}

/* ---- meshes ---- */

static void star_mesh(maker_mesh *m, uint64_t *seed, double side, double jitter)
{
    const double centre[3] = {side / 2, side / 2, side / 2};
    const double radius[3] = {side * 0.45, side * 0.4, side * 0.35};
    maker_star(m, seed, centre, radius, jitter, 9, 12, 1024);
}

static void soup_mesh(maker_mesh *m, uint64_t *seed, double side, int32_t count)
{
    const double low[3] = {-side / 5, -side / 5, -side / 5}, high[3] = {side * 1.2, side * 1.2, side * 1.2};
    maker_soup(m, seed, count, low, high, 1024);
    maker_needles(m, seed, count / 2, low, high, 1024);
    maker_degenerate(m, seed, count / 2, low, high, 1024);
}

static void test_random_meshes_at_every_base_and_depth(void)
{
    uint64_t seed = 11;

    for (int32_t base_side = 2; base_side <= 16; base_side += base_side < 5 ? 1 : 4)
        for (int32_t levels = 0; levels <= 5; levels++) {
            maker_mesh m = {0};
            bvx_lattice base;
            size_t inside;
            if (base_side << levels > 64) continue;
            base_of(base_side, base_side, base_side, 1, &base);
            star_mesh(&m, &seed, base_side, 0.1);
            check_refined(ctx, &m, &base, levels, &inside);
            if (base_side << levels >= 16) TEST_ASSERT_GREATER_THAN(0, inside);
            soup_mesh(&m, &seed, base_side, 4);
            check_refined(ctx, &m, &base, levels, &inside);
            maker_free(&m);
        }
}

static void test_any_shape_of_base(void)
{
    static const int32_t dims[][3] = {{1, 1, 1}, {1, 9, 3}, {70, 2, 3}, {3, 1, 65}, {2, 33, 1}, {128, 1, 1}};
    uint64_t seed = 3;

    for (size_t i = 0; i < sizeof dims / sizeof *dims; i++)
        for (int32_t levels = 0; levels <= 3; levels++) {
            maker_mesh m = {0};
            bvx_lattice base;
            size_t inside;
            double low[3], high[3];
            base_of(dims[i][0], dims[i][1], dims[i][2], 0.75, &base);
            for (int a = 0; a < 3; a++) {
                low[a] = 0.75 * 0.1 * dims[i][a];
                high[a] = 0.75 * 0.9 * dims[i][a];
            }
            maker_box(&m, low, high);
            maker_soup(&m, &seed, 5, low, high, 1024);
            check_refined(ctx, &m, &base, levels, &inside);
            maker_free(&m);
        }
}

static void test_threads_change_nothing(void)
{
    uint64_t seed = 17;
    maker_mesh m = {0};
    bvx_lattice base;
    size_t inside;

    base_of(5, 5, 5, 1, &base);
    star_mesh(&m, &seed, 5, 0.1);
    soup_mesh(&m, &seed, 5, 6);
    for (int32_t threads = 1; threads <= 8; threads += threads < 3 ? 1 : 5) {
        bvx_context *const c = suite_context(threads, BVX_CPU_BEST);
        check_refined(c, &m, &base, 4, &inside);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(c));
        bvx_context_destroy(c);
    }
    maker_free(&m);
}

static void box_shell(maker_mesh *m, double low, double high)
{
    const double l[3] = {low, low, low}, h[3] = {high, high, high};
    maker_box(m, l, h);
}

/* A shell within a shell within a shell: a flood fills them all. */
static void test_nested_shells_and_components(void)
{
    maker_mesh m = {0};
    bvx_lattice base;
    size_t inside;

    base_of(4, 4, 4, 1, &base);
    box_shell(&m, 0.3, 3.7);
    box_shell(&m, 0.9, 3.1);
    maker_flip(&m, 12, 24);
    box_shell(&m, 1.6, 2.4);
    check_refined(ctx, &m, &base, 4, &inside);
    TEST_ASSERT_GREATER_THAN(45 * 45 * 45, inside + 6 * 50 * 50 + 6 * 40 * 40 + 6 * 20 * 20);
    maker_clear(&m);
    box_shell(&m, 0.1, 0.9);
    box_shell(&m, 2.2, 3.95);
    check_refined(ctx, &m, &base, 4, &inside);
    TEST_ASSERT_GREATER_THAN(20 * 20 * 20, inside);
    maker_free(&m);
}

/* Walls with a hole as wide as w [Units: base voxels] in one of them. */
static void box_with_hole(maker_mesh *m, double low, double high, double w)
{
    double const c = (low + high) / 2, a = c - w / 2, b = c + w / 2;
    uint32_t outer[4], inner[4];

    box_shell(m, low, high);
    m->triangles -= 2; /* the side at z = high */
    for (uint32_t i = 0; i < 4; i++) {
        outer[i] = maker_vertex(m, i == 1 || i == 2 ? high : low, i > 1 ? high : low, high);
        inner[i] = maker_vertex(m, i == 1 || i == 2 ? b : a, i > 1 ? b : a, high);
    }
    for (uint32_t i = 0; i < 4; i++)
        maker_quad(m, outer[i], outer[(i + 1) % 4], inner[(i + 1) % 4], inner[i], 0);
}

/* A hole of a quarter of a base voxel lets a flood through from the level
 * where it holds a whole voxel of air. */
static void test_a_passage_that_opens_at_level_three(void)
{
    for (int32_t levels = 0; levels <= 5; levels++) {
        maker_mesh m = {0};
        bvx_lattice base;
        size_t inside;
        base_of(4, 4, 4, 1, &base);
        box_with_hole(&m, 0.35, 3.6, 0.3);
        maker_shift(&m, 0, 0.04, 0.03, 0);
        check_refined(ctx, &m, &base, levels, &inside);
        if (levels < 3) TEST_ASSERT_GREATER_OR_EQUAL(levels == 0 ? 0 : 1, inside);
        else TEST_ASSERT_EQUAL_size_t(0, inside);
        maker_free(&m);
    }
}

/* Many open sheets within a base voxel, and a maze between them. */
static void test_many_sheets_in_one_voxel(void)
{
    maker_mesh m = {0};
    bvx_lattice base;
    size_t inside;

    base_of(2, 2, 2, 1, &base);
    for (int32_t i = 0; i < 7; i++) {
        double const z = 0.11 + 0.26 * i, gap = i % 2 ? 0.2 : 0;
        uint32_t const a = maker_vertex(&m, 0.05 + gap, 0.02, z), b = maker_vertex(&m, 1.75 + gap, 0.02, z);
        uint32_t const c = maker_vertex(&m, 1.75 + gap, 1.98, z), d = maker_vertex(&m, 0.05 + gap, 1.98, z);
        maker_quad(&m, a, b, c, d, i & 1);
    }
    box_shell(&m, 0.03, 1.97);
    m.triangles -= 2; /* open above, and the sheets leave a way around them */
    check_refined(ctx, &m, &base, 5, &inside);
    maker_free(&m);
}

static void test_a_mesh_on_voxel_planes_and_one_off_the_lattice(void)
{
    maker_mesh m = {0};
    bvx_lattice base;
    size_t inside;

    base_of(4, 4, 4, 1, &base);
    box_shell(&m, 1, 3);
    check_refined(ctx, &m, &base, 3, &inside);
    TEST_ASSERT_EQUAL_size_t(14 * 14 * 14, inside);
    maker_shift(&m, 0, 40, 0, 0);
    check_refined(ctx, &m, &base, 3, &inside);
    TEST_ASSERT_EQUAL_size_t(0, inside);
    maker_clear(&m);
    box_shell(&m, -1, 5); /* the whole lattice lies within: beyond it is outside all the same */
    check_refined(ctx, &m, &base, 2, &inside);
    TEST_ASSERT_EQUAL_size_t(0, inside);
    maker_free(&m);
}

/* ---- looking up ---- */

static void test_points_find_their_leaf(void)
{
    maker_mesh m = {0};
    bvx_lattice base;
    bvx_octree_leaf leaf[4];
    const double points[12] = {2, 2, 2, 0.1, 0.1, 0.1, -0.01, 2, 2, 1.0, 2, 2};

    base_of(4, 4, 4, 1, &base);
    box_shell(&m, 1.01, 2.99);
    bvx_mesh_view const view = maker_view(&m);
    bvx_octree *const tree = refined(ctx, &view, &base, 3, -1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_find(ctx, tree, points, 4, leaf));
    TEST_ASSERT_EQUAL_UINT8(BVX_STATE_INSIDE, leaf[0].state);
    TEST_ASSERT_EQUAL_UINT8(BVX_STATE_OUTSIDE, leaf[1].state);
    TEST_ASSERT_EQUAL_UINT8(0, leaf[1].level);
    TEST_ASSERT_EQUAL_UINT8(BVX_STATE_OUTSIDE, leaf[2].state);
    TEST_ASSERT_EQUAL_UINT8(255, leaf[2].level);
    TEST_ASSERT_EQUAL_UINT8(BVX_STATE_SURFACE, leaf[3].state);
    TEST_ASSERT_EQUAL_UINT8(3, leaf[3].level);
    TEST_ASSERT_EQUAL_INT32(8, leaf[3].ijk[0]);
    TEST_ASSERT_EQUAL_INT32(16, leaf[3].ijk[1]);
    bvx_octree_free(ctx, tree);
    maker_free(&m);
}

/* ---- refusals ---- */

static void test_refusals(void)
{
    maker_mesh m = {0};
    bvx_lattice base;
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_octree *tree = NULL;
    bvx_octree_level counts[3];
    bvx_octree_leaf leaf;
    bvx_grid grid = {0};
    bvx_mesh_view empty = {0};
    int32_t const beyond[3] = {0, 16, 0};
    double const nowhere[3] = {0, 0.0 / (double)(empty.vertex_count + 0), 0};
    uint64_t count;

    base_of(4, 4, 4, 1, &base);
    box_shell(&m, 1, 3);
    bvx_mesh_view const view = maker_view(&m);
    TEST_ASSERT_EQUAL_INT32(0, o.levels);
    empty.position_type = BVX_F64;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_refine(ctx, &empty, &base, &o, &tree));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine(NULL, &view, &base, &o, &tree));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine(ctx, NULL, &base, &o, &tree));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine(ctx, &view, NULL, &o, &tree));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine(ctx, &view, &base, &o, NULL));
    o.levels = -2;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine(ctx, &view, &base, &o, &tree));
    o.levels = 24;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_refine(ctx, &view, &base, &o, &tree));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "23 levels fit"));
    o.levels = 2;
    o.start_level = 3;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine(ctx, &view, &base, &o, &tree));
    o.start_level = -2;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine(ctx, &view, &base, &o, &tree));
    base.dims[0] = base.dims[1] = base.dims[2] = 2048;
    o.start_level = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_refine(ctx, &view, &base, &o, &tree));
    TEST_ASSERT_NULL(tree);
    base_of(4, 4, 4, 1, &base);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_refine(ctx, &view, &base, &o, &tree));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_refine(ctx, &view, &base, &o, &tree)); /* in the stead of the first */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_octree_count(ctx, tree, counts, 2));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_octree_at(ctx, tree, beyond, 1, &leaf));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "voxel 0"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_octree_find(ctx, tree, nowhere, 1, &leaf));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_octree_expand(ctx, tree, 3, 0, NULL, &grid));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_octree_expand(ctx, tree, 2, 8, NULL, &grid));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_octree_leaves(ctx, tree, 8, NULL, 0, &count));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_octree_leaves(ctx, NULL, 0, NULL, 0, &count));
    TEST_ASSERT_EQUAL_INT32(-1, bvx_octree_levels(NULL));
    bvx_octree_free(ctx, tree);
    bvx_octree_free(ctx, NULL);
    maker_free(&m);
}

/* The levels that a refusal names are those that fit. */
static void test_a_limit_names_the_levels_that_fit(void)
{
    uint64_t seed = 23;
    maker_mesh m = {0};
    bvx_lattice base;
    bvx_context *free_context;

    base_of(4, 4, 4, 1, &base);
    star_mesh(&m, &seed, 4, 0.1);
    bvx_mesh_view const view = maker_view(&m);
    free_context = suite_context(1, BVX_CPU_BEST);
    bvx_octree_free(free_context, refined(free_context, &view, &base, 7, -1));
    uint64_t const peak = bvx_memory_peak(free_context);
    bvx_context_destroy(free_context);
    for (int n = 1; n <= 60; n++) {
        bvx_context_options co = {.struct_size = sizeof co};
        bvx_context *c = NULL;
        bvx_refine_options o = {.struct_size = sizeof o};
        bvx_octree *tree = NULL;
        co.threads = 1;
        co.memory_limit = peak * (uint64_t)n * (uint64_t)n / 3600;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&co, &c));
        o.levels = 7;
        bvx_status status = bvx_refine(c, &view, &base, &o, &tree);
        if (status != BVX_OK) {
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_BUDGET, status);
            const char *const fits = strstr(bvx_last_message(c), "levels = ");
            if (fits != NULL) {
                o.levels = fits[9] != '0' ? fits[9] - '0' : BVX_NONE;
                TEST_ASSERT_LESS_THAN(7, o.levels);
                TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_refine(c, &view, &base, &o, &tree),
                                                bvx_last_message(c));
            }
        }
        bvx_octree_free(c, tree);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(c));
        bvx_context_destroy(c);
    }
    maker_free(&m);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_random_meshes_at_every_base_and_depth);
    RUN_TEST(test_any_shape_of_base);
    RUN_TEST(test_threads_change_nothing);
    RUN_TEST(test_nested_shells_and_components);
    RUN_TEST(test_a_passage_that_opens_at_level_three);
    RUN_TEST(test_many_sheets_in_one_voxel);
    RUN_TEST(test_a_mesh_on_voxel_planes_and_one_off_the_lattice);
    RUN_TEST(test_points_find_their_leaf);
    RUN_TEST(test_refusals);
    RUN_TEST(test_a_limit_names_the_levels_that_fit);
    return UNITY_END();
}
