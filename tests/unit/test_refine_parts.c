/* test_refine_parts.c - octrees that are finer in a window, or that stay coarse where the surface is flat. */
#include "refine_oracle.h"
#include "suite.h"

void setUp(void)
{
    suite_open(1);
}

void tearDown(void)
{
    suite_close();
}

static void base_of(int32_t n, bvx_lattice *base)
{
    const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    const int32_t dims[3] = {n, n, n};
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, base));
}

static bvx_octree *tree_of(const bvx_mesh_view *view, const bvx_lattice *base, const bvx_refine_options *o)
{
    bvx_octree *tree = NULL;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_refine(ctx, view, base, o, &tree), bvx_last_message(ctx));
    return tree;
}

static bvx_octree_leaf *leaves_of(const bvx_octree *tree, uint64_t *count)
{
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_leaves(ctx, tree, 7, NULL, 0, count));
    bvx_octree_leaf *const leaves = maker_grow(NULL, (size_t)*count * sizeof *leaves);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_leaves(ctx, tree, 7, leaves, *count, count));
    return leaves;
}

/* The uniform surface, and inside by parity in place of a flood. */
static void uniform_by_rows(const bvx_mesh_view *view, const bvx_lattice *lattice, uniform *u)
{
    bvx_grid solid = {0};

    uniform_make(ctx, view, lattice, u);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, view, lattice, NULL, &solid));
    for (int32_t z = 0; z < lattice->dims[2]; z++)
        for (int32_t y = 0; y < lattice->dims[1]; y++)
            for (int32_t x = 0; x < lattice->dims[0]; x++) {
                uint8_t *const s = &u->state[uniform_at(u, x, y, z)];
                if (*s != BVX_STATE_SURFACE)
                    *s = bvx_grid_get(&solid, x, y, z) ? BVX_STATE_INSIDE : BVX_STATE_OUTSIDE;
            }
    bvx_grid_free(ctx, &solid);
}

/* States that a leaf's voxels have. */
static int seen_in_leaf(const uniform *u, const bvx_octree_leaf *leaf, int32_t levels)
{
    int32_t const side = 1 << (levels - leaf->level);
    int seen = 0;
    for (int32_t k = 0; k < side; k++)
        for (int32_t j = 0; j < side; j++)
            for (int32_t i = 0; i < side; i++)
                seen |= u->state[uniform_at(u, leaf->ijk[0] * side + i, leaf->ijk[1] * side + j,
                                            leaf->ijk[2] * side + k)];
    return seen;
}

/* ---- a window ---- */

/* Does a leaf reach into the window? */
static int in_window(const bvx_octree_leaf *leaf, int32_t levels, const bvx_window *w)
{
    int32_t const side = 1 << (levels - leaf->level);
    for (int a = 0; a < 3; a++)
        if ((leaf->ijk[a] + 1) * side <= w->low[a] || leaf->ijk[a] * side >= w->low[a] + w->size[a]) return 0;
    return 1;
}

static void check_window(const maker_mesh *m, int32_t base_side, int32_t levels, uint64_t *seed,
                         uint64_t *inside)
{
    bvx_mesh_view const view = maker_view(m);
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_lattice base, lattice;
    uniform u = {{{0}, {0}, {0}, 0}, NULL, 0};

    base_of(base_side, &base);
    o.levels = levels != 0 ? levels : BVX_NONE;
    for (o.outer_levels = 0; o.outer_levels <= levels; o.outer_levels++) {
        uint64_t count;
        for (int a = 0; a < 3; a++) {
            o.window.low[a] = maker_below(seed, base_side << levels);
            o.window.size[a] = 1 + maker_below(seed, (base_side << levels) - o.window.low[a]);
        }
        bvx_octree *const tree = tree_of(&view, &base, &o);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_lattice(ctx, tree, levels, &lattice));
        if (u.state == NULL) uniform_by_rows(&view, &lattice, &u);
        bvx_octree_leaf *const leaf = leaves_of(tree, &count);
        uint64_t covered = 0;
        for (uint64_t n = 0; n < count; n++) {
            int const seen = seen_in_leaf(&u, &leaf[n], levels);
            if (leaf[n].level < levels && leaf[n].state == BVX_STATE_SURFACE) {
                TEST_ASSERT_TRUE((seen & BVX_STATE_SURFACE) != 0);
                TEST_ASSERT_FALSE(in_window(&leaf[n], levels, &o.window));
                TEST_ASSERT_TRUE(leaf[n].level >= o.outer_levels);
            } else {
                TEST_ASSERT_EQUAL_INT(leaf[n].state, seen);
            }
            if (leaf[n].level > o.outer_levels) { /* halved no further than the window asks for */
                bvx_octree_leaf parent = leaf[n];
                parent.level--;
                for (int a = 0; a < 3; a++) parent.ijk[a] /= 2;
                TEST_ASSERT_TRUE(in_window(&parent, levels, &o.window));
            }
            *inside += leaf[n].state == BVX_STATE_INSIDE;
            covered += (uint64_t)1 << 3 * (levels - leaf[n].level);
        }
        TEST_ASSERT_EQUAL_UINT64(u.count, covered);
        free(leaf);
        /* the same from every start level */
        for (o.start_level = BVX_NONE; o.start_level <= levels; o.start_level++) {
            uint64_t again;
            bvx_octree *const other = tree_of(&view, &base, &o);
            bvx_octree_leaf *const first = leaves_of(tree, &count), *const second = leaves_of(other, &again);
            TEST_ASSERT_EQUAL_UINT64(count, again);
            TEST_ASSERT_EQUAL_MEMORY(first, second, (size_t)count * sizeof *first);
            free(first);
            free(second);
            bvx_octree_free(ctx, other);
        }
        o.start_level = 0;
        bvx_octree_free(ctx, tree);
    }
    uniform_free(&u);
}

static void test_a_window_is_as_the_whole_there(void)
{
    uint64_t seed = 41, inside = 0;

    for (int32_t levels = 1; levels <= 4; levels++)
        for (int32_t side = 2; side <= 5; side++) {
            maker_mesh m = {0};
            double const c = side / 2.0;
            const double centre[3] = {c, c, c};
            const double radius[3] = {c * 0.9, c * 0.8, c * 0.85};
            const double small[3] = {c * 0.3, c * 0.3, c * 0.3};
            maker_star(&m, &seed, centre, radius, 0.08, 7, 10, 1024);
            maker_star(&m, &seed, centre, small, 0.05, 4, 5, 1024); /* a cavity: rows leave it empty */
            if (side << levels <= 48) check_window(&m, side, levels, &seed, &inside);
            maker_free(&m);
        }
    TEST_ASSERT_GREATER_THAN(100, inside);
}

/* Voxels of the last level in the window, in some states, are those of another grid. */
static void assert_window_holds(const bvx_octree *tree, int32_t states, const bvx_window *window,
                                const bvx_grid *want)
{
    bvx_grid expanded = {0};
    uint64_t first, second;
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            bvx_octree_expand(ctx, tree, bvx_octree_levels(tree), states, window, &expanded));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(ctx, want, &first));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_hash(ctx, &expanded, &second));
    TEST_ASSERT_EQUAL_HEX64(first, second);
    bvx_grid_free(ctx, &expanded);
}

/* A small window of a lattice that no grid could hold. */
static void test_a_window_of_a_deep_lattice(void)
{
    maker_mesh m = {0};
    bvx_lattice base, lattice;
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_surface_options so = {.struct_size = sizeof so};
    bvx_voxelize_options vo = {.struct_size = sizeof vo};
    bvx_grid surface = {0}, solid = {0};
    uint64_t set = 0, all = 0, seed = 9;
    const double centre[3] = {4, 4, 4}, radius[3] = {3.5, 3.5, 3.5};

    base_of(8, &base);
    maker_star(&m, &seed, centre, radius, 0.05, 20, 20, 1024);
    bvx_mesh_view const view = maker_view(&m);
    o.levels = 13; /* 65536 */
    for (int a = 0; a < 3; a++) {
        o.window.low[a] = (int32_t)(m.p[3 * 77 + a] * 8192) - 50; /* about a vertex */
        o.window.size[a] = 100;
    }
    so.window = vo.window = o.window;
    for (o.outer_levels = 0; o.outer_levels <= 4; o.outer_levels += 4) {
        bvx_octree *const tree = tree_of(&view, &base, &o);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_lattice(ctx, tree, 13, &lattice));
        TEST_ASSERT_EQUAL_INT32(65536, lattice.dims[0]);
        if (o.outer_levels == 0) {
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(ctx, &view, &lattice, &so, &surface));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &surface, &set));
            TEST_ASSERT_GREATER_THAN(5000, set);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &lattice, &vo, &solid));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, &solid, &all));
            TEST_ASSERT_GREATER_THAN(5000, all);
        }
        assert_window_holds(tree, BVX_STATE_SURFACE, &o.window, &surface);
        /* from here on: the solid without its surface */
        for (int32_t z = 0; z < 100 && o.outer_levels == 0; z++)
            for (int32_t y = 0; y < 100; y++)
                for (int32_t i = 0; i < solid.words_per_row; i++) {
                    size_t const at = ((size_t)z * 100 + (size_t)y) * (size_t)solid.words_per_row + (size_t)i;
                    solid.words[at] &= ~surface.words[at];
                }
        assert_window_holds(tree, BVX_STATE_INSIDE, &o.window, &solid);
        bvx_octree_free(ctx, tree);
    }
    bvx_grid_free(ctx, &solid);
    bvx_grid_free(ctx, &surface);
    maker_free(&m);
}

/* ---- a tolerance ---- */

/* All corners of the triangles that touch a leaf's voxels lie about the plane of the largest one. */
static void assert_leaf_is_flat(const maker_mesh *m, const bvx_grid *surface, const bvx_attached *attached,
                                const uint32_t *rank, const bvx_octree_leaf *leaf, int32_t levels,
                                double tolerance)
{
    int32_t const side = 1 << (levels - leaf->level), nx = surface->size[0], ny = surface->size[1];
    const double *best[3] = {NULL, NULL, NULL};
    double best_area = -1, n[3] = {0, 0, 0};

    for (int pass = 0; pass < 2; pass++)
        for (int32_t v = 0; v < side * side * side; v++) {
            int32_t const x = leaf->ijk[0] * side + v % side;
            int32_t const y = leaf->ijk[1] * side + v / side % side;
            int32_t const z = leaf->ijk[2] * side + v / side / side;
            if (!bvx_grid_get(surface, x, y, z)) continue;
            uint32_t const r = rank[((size_t)z * (size_t)ny + (size_t)y) * (size_t)nx + (size_t)x];
            for (uint64_t i = attached->offsets[r]; i < attached->offsets[r + 1]; i++) {
                const uint32_t *const t = m->t + 3 * (size_t)attached->triangles[i];
                const double *const p[3] = {m->p + 3 * (size_t)t[0], m->p + 3 * (size_t)t[1],
                                            m->p + 3 * (size_t)t[2]};
                if (pass == 0) {
                    double c[3];
                    for (int a = 0; a < 3; a++) {
                        int const b = (a + 1) % 3, d = (a + 2) % 3;
                        c[a] = (p[1][b] - p[0][b]) * (p[2][d] - p[0][d]) -
                               (p[1][d] - p[0][d]) * (p[2][b] - p[0][b]);
                    }
                    double const area = c[0] * c[0] + c[1] * c[1] + c[2] * c[2];
                    if (area <= best_area) continue;
                    best_area = area;
                    memcpy(best, p, sizeof best);
                    memcpy(n, c, sizeof n);
                } else {
                    for (int c = 0; c < 3; c++) {
                        double d = 0;
                        for (int a = 0; a < 3; a++) d += (p[c][a] - best[0][a]) * n[a];
                        TEST_ASSERT_TRUE(d * d <=
                                         tolerance * tolerance * best_area * 1.01 + 1e-9 * best_area);
                    }
                }
            }
        }
    TEST_ASSERT_TRUE(best_area > 0);
}

static uint64_t check_tolerance(const maker_mesh *m, int32_t side, int32_t levels, double tolerance)
{
    bvx_mesh_view const view = maker_view(m);
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_lattice base, lattice;
    bvx_surface_options so = {.struct_size = sizeof so};
    bvx_attached attached = {0};
    bvx_grid surface = {0};
    uint64_t count, covered = 0, flat = 0;
    uint32_t r = 0;
    uniform u;

    base_of(side, &base);
    o.levels = levels != 0 ? levels : BVX_NONE;
    o.tolerance = tolerance;
    bvx_octree *const tree = tree_of(&view, &base, &o);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_lattice(ctx, tree, levels, &lattice));
    uniform_make(ctx, &view, &lattice, &u);
    so.attached = &attached;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(ctx, &view, &lattice, &so, &surface));
    uint32_t *const rank = maker_grow(NULL, u.count * sizeof *rank);
    for (size_t i = 0; i < u.count; i++) {
        rank[i] = r;
        r += u.state[i] == BVX_STATE_SURFACE;
    }
    bvx_octree_leaf *const leaf = leaves_of(tree, &count);
    for (uint64_t n = 0; n < count; n++) {
        int const seen = seen_in_leaf(&u, &leaf[n], levels);
        TEST_ASSERT_EQUAL_INT(leaf[n].state == BVX_STATE_SURFACE, (seen & BVX_STATE_SURFACE) != 0);
        covered += (uint64_t)1 << 3 * (levels - leaf[n].level);
        if (leaf[n].state == BVX_STATE_SURFACE && leaf[n].level < levels) {
            flat++;
            assert_leaf_is_flat(m, &surface, &attached, rank, &leaf[n], levels, tolerance);
        } else if (leaf[n].state == BVX_STATE_OUTSIDE) {
            /* walls are thicker, so the flood reaches no further */
            TEST_ASSERT_EQUAL_INT(BVX_STATE_OUTSIDE, seen);
        }
    }
    TEST_ASSERT_EQUAL_UINT64(u.count, covered);
    free(leaf);
    free(rank);
    bvx_attached_free(ctx, &attached);
    bvx_grid_free(ctx, &surface);
    bvx_octree_free(ctx, tree);
    uniform_free(&u);
    return flat;
}

static void test_flat_voxels_stay_whole(void)
{
    uint64_t seed = 77;
    maker_mesh m = {0};
    const double low[3] = {0.3, 0.4, 0.6};
    const double high[3] = {3.3, 3.6, 3.2};
    const double centre[3] = {2, 2, 2};
    const double radius[3] = {1.8, 1.7, 1.6};

    maker_box(&m, low, high);
    TEST_ASSERT_GREATER_THAN(50, check_tolerance(&m, 4, 4, 1e-6)); /* faces, away from edges */
    /* every touched base voxel is flat then */
    TEST_ASSERT_EQUAL_UINT64(56, check_tolerance(&m, 4, 3, 100));
    maker_clear(&m);
    maker_star(&m, &seed, centre, radius, 0.0, 20, 30, 1024);
    uint64_t const few = check_tolerance(&m, 4, 4, 0.004), more = check_tolerance(&m, 4, 4, 0.05);
    TEST_ASSERT_GREATER_THAN(0, more);
    TEST_ASSERT_GREATER_THAN(0, few);
    maker_free(&m);
}

/* ---- the closed surface, block by block ---- */

static void check_extracted(const bvx_octree *tree, int32_t states, int32_t keys)
{
    bvx_extract_options o = {.struct_size = sizeof o};
    bvx_mesh whole = {0}, blocks = {0};
    bvx_grid grid = {0};
    uint64_t first, second;

    o.position_type = BVX_F64;
    o.keys = keys;
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            bvx_octree_expand(ctx, tree, bvx_octree_levels(tree), states, NULL, &grid));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_surface(ctx, &grid, &o, &whole));
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_extract_octree(ctx, tree, states, &o, &blocks),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(whole.triangle_count, blocks.triangle_count);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &whole, &first));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &blocks, &second));
    TEST_ASSERT_EQUAL_HEX64(first, second);
    TEST_ASSERT_EQUAL_INT(keys, blocks.vertex_keys != NULL);
    if (keys)
        TEST_ASSERT_EQUAL_MEMORY(whole.triangle_keys, blocks.triangle_keys, (size_t)whole.triangle_count * 8);
    bvx_mesh_free(ctx, &whole);
    bvx_mesh_free(ctx, &blocks);
    bvx_grid_free(ctx, &grid);
}

static void test_blocks_make_the_whole_surface(void)
{
    static const int32_t sides[4][3] = {{3, 3, 3}, {33, 5, 2}, {2, 5, 40}, {1, 1, 1}};
    uint64_t seed = 55;

    for (int i = 0; i < 4; i++)
        for (int32_t levels = 0; levels <= 5 - (i == 1 || i == 2); levels++) {
            maker_mesh m = {0};
            const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
            double centre[3], radius[3];
            bvx_lattice base;
            bvx_refine_options o = {.struct_size = sizeof o};
            for (int a = 0; a < 3; a++) {
                centre[a] = sides[i][a] / 2.0;
                radius[a] = sides[i][a] * 0.52; /* beyond the sides here and there */
            }
            maker_star(&m, &seed, centre, radius, 0.1, 9, 9, 1024);
            bvx_mesh_view const view = maker_view(&m);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, sides[i], &base));
            o.levels = levels != 0 ? levels : BVX_NONE;
            bvx_octree *const tree = tree_of(&view, &base, &o);
            check_extracted(tree, 0, 1);
            check_extracted(tree, BVX_STATE_OUTSIDE, 0);
            bvx_octree_free(ctx, tree);
            /* states by rows: inside reaches the lattice's sides */
            o.window.size[0] = o.window.size[1] = o.window.size[2] = 1;
            bvx_octree *const rows = tree_of(&view, &base, &o);
            check_extracted(rows, BVX_STATE_INSIDE, 0);
            bvx_octree_free(ctx, rows);
            maker_free(&m);
        }
}

static void test_an_empty_surface(void)
{
    maker_mesh m = {0};
    const double low[3] = {40, 1, 1}, high[3] = {43, 3, 3};
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_lattice base;
    bvx_mesh mesh = {0};
    bvx_extract_options e = {.struct_size = sizeof e};

    base_of(4, &base);
    maker_box(&m, low, high);
    bvx_mesh_view const view = maker_view(&m);
    bvx_octree *const tree = tree_of(&view, &base, &o);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_extract_octree(ctx, tree, 0, NULL, &mesh),
                                    bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_UINT64(0, mesh.triangle_count);
    bvx_mesh_free(ctx, &mesh);
    e.open_sides = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_octree(ctx, tree, 0, &e, &mesh));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_octree(ctx, tree, 8, NULL, &mesh));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_octree(ctx, NULL, 0, NULL, &mesh));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_octree(ctx, tree, 0, NULL, NULL));
    bvx_octree_free(ctx, tree);
    maker_free(&m);
}

static void test_refusals(void)
{
    maker_mesh m = {0};
    const double low[3] = {1, 1, 1}, high[3] = {3, 3, 3};
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_lattice base;
    bvx_octree *tree = NULL;

    base_of(4, &base);
    maker_box(&m, low, high);
    bvx_mesh_view const view = maker_view(&m);
    o.levels = 3;
    o.outer_levels = 4;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine(ctx, &view, &base, &o, &tree));
    o.outer_levels = -1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine(ctx, &view, &base, &o, &tree));
    o.outer_levels = 1;
    o.window.low[0] = 30;
    o.window.size[0] = 4;
    o.window.size[1] = o.window.size[2] = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_refine(ctx, &view, &base, &o, &tree));
    o.window.low[0] = 0;
    o.tolerance = -1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine(ctx, &view, &base, &o, &tree));
    o.tolerance = 1;
    o.start_level = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine(ctx, &view, &base, &o, &tree));
    o.start_level = 0;
    o.reserved = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine(ctx, &view, &base, &o, &tree));
    TEST_ASSERT_NULL(tree);
    maker_free(&m);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_a_window_is_as_the_whole_there);
    RUN_TEST(test_a_window_of_a_deep_lattice);
    RUN_TEST(test_flat_voxels_stay_whole);
    RUN_TEST(test_blocks_make_the_whole_surface);
    RUN_TEST(test_an_empty_surface);
    RUN_TEST(test_refusals);
    return UNITY_END();
}
