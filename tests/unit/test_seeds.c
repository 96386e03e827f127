/* test_seeds.c - seeds inside surfaces, pockets, and fills from them against floods voxel by voxel. */
#include "solid_support.h"
#include "tools/fill_oracle.h"

static bvx_grid grid_of(int32_t x, int32_t y, int32_t z)
{
    bvx_lattice const l = lattice_of(x, y, z);
    bvx_grid g = {0};
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, NULL, &g));
    return g;
}

static void scatter(bvx_grid *g, int32_t one_in)
{
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++)
            for (int32_t x = 0; x < g->size[0]; x++)
                bvx_grid_set(g, x, y, z, maker_below(&seed, one_in) == 0);
}

/* The six walls of a box. */
static void set_walls(bvx_grid *g, const int32_t low[3], const int32_t high[3])
{
    for (int32_t z = low[2]; z <= high[2]; z++)
        for (int32_t y = low[1]; y <= high[1]; y++)
            for (int32_t x = low[0]; x <= high[0]; x++)
                if (x == low[0] || y == low[1] || z == low[2] || x == high[0] || y == high[1] || z == high[2])
                    bvx_grid_set(g, x, y, z, 1);
}

static bvx_grid surface_by(const bvx_lattice *l, const bvx_window *window, int32_t mode)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_surface_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};

    o.mode = mode;
    if (window != NULL) o.window = *window;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(ctx, &view, l, &o, &g));
    return g;
}

static int hidden(const bvx_grid *g, const int32_t v[3])
{
    for (int d = 0; d < 6; d++) {
        int32_t p[3] = {v[0], v[1], v[2]};
        int met = 0;
        for (p[d / 2] += d % 2 ? 1 : -1; p[d / 2] >= 0 && p[d / 2] < g->size[d / 2] && !met;
             p[d / 2] += d % 2 ? 1 : -1)
            met = bvx_grid_get(g, p[0], p[1], p[2]);
        if (!met) return 0;
    }
    return !bvx_grid_get(g, v[0], v[1], v[2]);
}

/* ---- Filling ---- */

static void test_fills_are_floods(void)
{
    static const int32_t sizes[][3] = {{70, 9, 8},  {64, 7, 9}, {1, 20, 20},
                                       {20, 1, 21}, {65, 8, 1}, {128, 5, 5}};
    static const int32_t connectivity[3] = {6, 18, 26};

    for (int32_t trial = 0; trial < (quick ? 30 : 200); trial++) {
        int32_t const *const n = sizes[trial % 6];
        size_t const count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
        bvx_grid walls = grid_of(n[0], n[1], n[2]), filled = {0};
        int32_t seeds[3 * 5], *const label = maker_grow(NULL, count * sizeof *label);
        uint64_t n_seeds = 0;
        uint8_t *open, *wanted;
        int32_t spaces;
        scatter(&walls, trial % 3 == 0 ? 2 : trial % 3 == 1 ? 3 : 8);
        if (trial % 7 == 0) /* mostly walls, for the diagonal neighbours */
            for (int32_t z = 0; z < n[2]; z++)
                for (int32_t y = 0; y < n[1]; y++)
                    for (int32_t x = 0; x < n[0]; x++)
                        bvx_grid_set(&walls, x, y, z, maker_below(&seed, 3) != 0);
        open = fill_bytes(&walls, 1);
        for (int i = 0; i < 20 && n_seeds < (uint64_t)(trial % 6); i++) {
            int32_t const v[3] = {maker_below(&seed, n[0]), maker_below(&seed, n[1]),
                                  maker_below(&seed, n[2])};
            if (open[fill_place(n, v[0], v[1], v[2])]) memcpy(seeds + 3 * n_seeds++, v, sizeof v);
        }
        spaces = fill_label(open, n, connectivity[trial % 3], label);
        wanted = maker_grow(NULL, (size_t)spaces + 1);
        memset(wanted, 0, (size_t)spaces + 1);
        for (uint64_t i = 0; i < n_seeds; i++)
            wanted[label[fill_place(n, seeds[3 * i], seeds[3 * i + 1], seeds[3 * i + 2])]] = 1;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_fill(ctx, &walls, n_seeds != 0 ? seeds : NULL, n_seeds,
                                                      connectivity[trial % 3], &filled));
        for (int32_t z = 0; z < n[2]; z++)
            for (int32_t y = 0; y < n[1]; y++)
                for (int32_t x = 0; x < filled.words_per_row * 64; x++) {
                    size_t const i = x < n[0] ? fill_place(n, x, y, z) : 0;
                    TEST_ASSERT_EQUAL_INT(x < n[0] && label[i] >= 0 && wanted[label[i]],
                                          bvx_grid_get(&filled, x, y, z));
                }
        free(wanted);
        free(open);
        free(label);
        bvx_grid_free(ctx, &filled);
        bvx_grid_free(ctx, &walls);
    }
}

static void test_fill_refusals(void)
{
    bvx_grid walls = grid_of(10, 10, 10), filled = {0}, same;
    int32_t seeds[6] = {1, 2, 3, 4, 5, 6};

    bvx_grid_set(&walls, 4, 5, 6, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_fill(ctx, &walls, seeds, 2, 6, &filled));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "seed 1"));
    seeds[3] = 10;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_fill(ctx, &walls, seeds, 2, 6, &filled));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "outside"));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_fill(ctx, &walls, seeds, 1, 8, &filled));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_fill(ctx, &walls, NULL, 1, 6, &filled));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_fill(ctx, NULL, seeds, 1, 6, &filled));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_fill(ctx, &walls, seeds, 1, 6, NULL));
    same = walls;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_grid_fill(ctx, &walls, seeds, 1, 6, &same));
    TEST_ASSERT_NULL(filled.words);
    bvx_grid_free(ctx, &walls);
}

/* ---- Seeds ---- */

/* One box around the middle: one scan along each axis, as in the paper's table. */
static void test_seed_in_a_box(void)
{
    int32_t const low[3] = {5, 3, 4}, high[3] = {40, 20, 21};
    bvx_grid g = grid_of(70, 30, 30);
    bvx_seed s;

    set_walls(&g, low, high);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_seed(ctx, &g, NULL, 0, &s));
    TEST_ASSERT_EQUAL_INT32(1, s.found);
    TEST_ASSERT_EQUAL_INT32(0, s.verified);
    TEST_ASSERT_EQUAL_INT32(6, s.voxel[0]);
    TEST_ASSERT_TRUE(hidden(&g, s.voxel));
    for (int a = 0; a < 3; a++) TEST_ASSERT_EQUAL_UINT64(1, s.scans[a]);
    TEST_ASSERT_EQUAL_UINT64(1, s.starts);
    bvx_grid_free(ctx, &g);
}

/* The middle row goes through the bay of a U: the way leads along y into an arm. */
static void test_seed_beside_a_bay(void)
{
    int32_t const left[2][3] = {{2, 2, 2}, {30, 10, 12}};
    int32_t const right[2][3] = {{2, 20, 2}, {30, 28, 12}};
    int32_t const back[2][3] = {{24, 2, 2}, {30, 28, 12}};
    bvx_grid g = grid_of(40, 32, 16);
    bvx_seed s;

    set_walls(&g, left[0], left[1]);
    set_walls(&g, right[0], right[1]);
    set_walls(&g, back[0], back[1]);
    bvx_grid_set(&g, 3, 15, 7, 1); /* a post before the bay */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_seed(ctx, &g, NULL, 0, &s));
    TEST_ASSERT_EQUAL_INT32(1, s.found);
    TEST_ASSERT_TRUE(hidden(&g, s.voxel));
    TEST_ASSERT_TRUE(s.scans[0] + s.scans[1] + s.scans[2] > 3);
    bvx_grid_free(ctx, &g);
}

/* What the printed algorithm never ends on: no gap at all, one voxel, nothing. */
static void test_searches_that_end_with_nothing(void)
{
    bvx_grid g = grid_of(20, 9, 8);
    bvx_seed s;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_seed(ctx, &g, NULL, 0, &s));
    TEST_ASSERT_EQUAL_INT32(0, s.found);
    TEST_ASSERT_EQUAL_UINT64(0, s.starts);
    bvx_grid_set(&g, 3, 3, 3, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_seed(ctx, &g, NULL, 0, &s));
    TEST_ASSERT_EQUAL_INT32(0, s.found);
    for (int32_t z = 0; z < 8; z++)
        for (int32_t y = 0; y < 9; y++)
            for (int32_t x = 2; x < 19; x++) bvx_grid_set(&g, x, y, z, 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_seed(ctx, &g, NULL, 0, &s));
    TEST_ASSERT_EQUAL_INT32(0, s.found);
    TEST_ASSERT_EQUAL_UINT64(1 + 9 * 8, s.starts);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_seed(ctx, &g, NULL, 10, &s));
    TEST_ASSERT_EQUAL_UINT64(10, s.scans[0] + s.scans[1] + s.scans[2]);
    bvx_grid_free(ctx, &g);
}

/* Any scatter: what is found is hidden; and whenever a gap of a row begins
 * with a hidden voxel something is found. */
static void test_search_is_complete(void)
{
    for (int32_t trial = 0; trial < (quick ? 60 : 500); trial++) {
        bvx_grid g = grid_of(1 + maker_below(&seed, 70), 1 + maker_below(&seed, 7),
                             1 + maker_below(&seed, 7));
        int any = 0;
        bvx_seed s;
        scatter(&g, 2 + maker_below(&seed, 60));
        for (int32_t z = 0; z < g.size[2]; z++)
            for (int32_t y = 0; y < g.size[1]; y++)
                for (int32_t x = 1; x < g.size[0]; x++) {
                    int32_t const v[3] = {x, y, z};
                    any |= bvx_grid_get(&g, x - 1, y, z) && hidden(&g, v);
                }
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_seed(ctx, &g, NULL, 0, &s));
        TEST_ASSERT_EQUAL_INT32(any, s.found);
        if (s.found) TEST_ASSERT_TRUE(hidden(&g, s.voxel));
        bvx_grid_free(ctx, &g);
    }
}

/* A bottle: a thick shell whose inside is joined to the outside by a narrow neck. Its hollow is hidden in six
 * directions for most voxels, but not inside the mesh; the shell's own inside is. */
static void test_bottle_is_not_taken_for_full(void)
{
    static const double outer[3] = {18, 18, 18}, centre[3] = {24, 24, 24}, inner[3] = {12, 12, 12};
    bvx_lattice const l = lattice_of(48, 48, 48);
    bvx_mesh_view view;
    bvx_grid surface;
    bvx_seed s;

    maker_star(&mesh, &seed, centre, outer, 0, 8, 12, 65536);
    maker_star(&mesh, &seed, centre, inner, 0, 8, 12, 65536);
    view = maker_view(&mesh);
    surface = surface_by(&l, NULL, BVX_SURFACE_CONSERVATIVE);
    for (int32_t z = 0; z < 48; z++) { /* the middle row sees the hollow first */
        bvx_grid_set(&surface, 24, 0, z, 0);
    }
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_seed(ctx, &surface, &view, 0, &s));
    TEST_ASSERT_EQUAL_INT32(1, s.found);
    TEST_ASSERT_EQUAL_INT32(1, s.verified);
    {
        bvx_grid vote = solid_of(&l, BVX_FILL_VOTE);
        TEST_ASSERT_EQUAL_INT(1, bvx_grid_get(&vote, s.voxel[0], s.voxel[1], s.voxel[2]));
        bvx_grid_free(ctx, &vote);
    }
    bvx_grid_free(ctx, &surface);

    /* only the hollow's wall is there: its inside is hidden, but the mesh has it outside */
    {
        bvx_grid hollow = grid_of(48, 48, 48);
        int32_t const low[3] = {18, 18, 18}, high[3] = {30, 30, 30};
        set_walls(&hollow, low, high);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_seed(ctx, &hollow, &view, 0, &s));
        TEST_ASSERT_EQUAL_INT32(0, s.found);
        TEST_ASSERT_TRUE(s.refused > 0);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_seed(ctx, &hollow, NULL, 0, &s));
        TEST_ASSERT_EQUAL_INT32(1, s.found);
        bvx_grid_free(ctx, &hollow);
    }
}

/* ---- Pockets, and the whole way: surface, seeds, fill ---- */

static void test_pockets_of_scatters(void)
{
    for (int32_t trial = 0; trial < (quick ? 30 : 150); trial++) {
        bvx_grid g = grid_of(1 + maker_below(&seed, 70), 1 + maker_below(&seed, 9),
                             1 + maker_below(&seed, 9));
        int32_t const *const n = g.size;
        size_t const count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
        int32_t *const label = maker_grow(NULL, count * sizeof *label);
        int32_t *const want = maker_grow(NULL, (count + 1) * 3 * sizeof *want);
        int32_t *const got = maker_grow(NULL, (count + 1) * 3 * sizeof *got);
        uint64_t expected = 0, found = 77;
        uint8_t *open, *side;
        int32_t spaces, next = 0;
        scatter(&g, 2);
        open = fill_bytes(&g, 1);
        spaces = fill_label(open, n, 6, label);
        side = maker_grow(NULL, (size_t)spaces + 1);
        memset(side, 0, (size_t)spaces + 1);
        for (int pass = 0; pass < 2; pass++)
            for (int32_t z = 0; z < n[2]; z++)
                for (int32_t y = 0; y < n[1]; y++)
                    for (int32_t x = 0; x < n[0]; x++) {
                        int32_t const s = label[fill_place(n, x, y, z)];
                        if (pass == 0 && s >= 0 &&
                            (x == 0 || y == 0 || z == 0 || x == n[0] - 1 || y == n[1] - 1 || z == n[2] - 1))
                            side[s] = 1;
                        if (pass == 1 && s == next) {
                            next++;
                            if (side[s]) continue;
                            want[3 * expected] = x;
                            want[3 * expected + 1] = y;
                            want[3 * expected++ + 2] = z;
                        }
                    }
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_pockets(ctx, &g, NULL, NULL, 0, &found));
        TEST_ASSERT_EQUAL_UINT64(expected, found);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_pockets(ctx, &g, NULL, got, expected, &found));
        if (expected > 0) {
            TEST_ASSERT_EQUAL_MEMORY(want, got, (size_t)expected * 12);
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY,
                                    bvx_find_pockets(ctx, &g, NULL, got, expected - 1, &found));
            TEST_ASSERT_EQUAL_UINT64(expected, found);
        }
        free(side);
        free(open);
        free(got);
        free(want);
        free(label);
        bvx_grid_free(ctx, &g);
    }
}

/* Closed bodies, one within another and side by side: the fill from all
 * pockets is parity off the surface. Also in a window. */
static void test_every_pocket_filled_is_the_inside(void)
{
    for (int32_t trial = 0; trial < (quick ? 6 : 30); trial++) {
        bvx_lattice const l = lattice_of(80, 60, 60);
        bvx_window const w = {{9, 8, 7}, {66, 47, 48}};
        int32_t seeds[3 * 400];
        uint64_t pockets = 0;
        bvx_mesh_view view;
        bvx_grid surface, parity, filled = {0};
        bvx_seed s;
        maker_clear(&mesh);
        for (int32_t n = 0; n < 4; n++) {
            double centre[3] = {30, 30, 30}, radius[3] = {24 - 7 * n, 24 - 7 * n, 24 - 7 * n};
            if (n == 3) centre[0] = 65;
            maker_star(&mesh, &seed, centre, radius, 0.1, 8, 12, 65536);
        }
        view = maker_view(&mesh);
        surface = surface_by(&l, trial % 2 ? &w : NULL, BVX_SURFACE_CONSERVATIVE);
        parity = solid_by(ctx, &l, trial % 2 ? &w : NULL, BVX_FILL_PARITY, NULL);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_pockets(ctx, &surface, &view, seeds, 400, &pockets));
        TEST_ASSERT_TRUE(pockets >= 2);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_fill(ctx, &surface, seeds, pockets, 6, &filled));
        for (int32_t z = 0; z < surface.size[2]; z++)
            for (int32_t y = 0; y < surface.size[1]; y++)
                for (int32_t x = 0; x < surface.size[0]; x++)
                    TEST_ASSERT_EQUAL_INT(!bvx_grid_get(&surface, x, y, z) && bvx_grid_get(&parity, x, y, z),
                                          bvx_grid_get(&filled, x, y, z));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_find_seed(ctx, &surface, &view, 0, &s));
        TEST_ASSERT_EQUAL_INT32(1, s.verified);
        TEST_ASSERT_EQUAL_INT(1, bvx_grid_get(&filled, s.voxel[0], s.voxel[1], s.voxel[2]));
        bvx_grid_free(ctx, &filled);
        bvx_grid_free(ctx, &parity);
        bvx_grid_free(ctx, &surface);
    }
}

static void test_seed_refusals(void)
{
    bvx_grid g = grid_of(4, 4, 4), none = {0};
    bvx_mesh_view view = {0};
    bvx_seed s;
    uint64_t n;

    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_find_seed(ctx, &none, NULL, 0, &s));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_find_seed(ctx, &g, NULL, 0, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_find_seed(NULL, &g, NULL, 0, &s));
    TEST_ASSERT_TRUE(bvx_find_seed(ctx, &g, &view, 0, &s) != BVX_OK);
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_find_pockets(ctx, &g, NULL, NULL, 0, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_find_pockets(ctx, &none, NULL, NULL, 0, &n));
    bvx_grid_free(ctx, &g);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_fills_are_floods);
    RUN_TEST(test_fill_refusals);
    RUN_TEST(test_seed_in_a_box);
    RUN_TEST(test_seed_beside_a_bay);
    RUN_TEST(test_searches_that_end_with_nothing);
    RUN_TEST(test_search_is_complete);
    RUN_TEST(test_bottle_is_not_taken_for_full);
    RUN_TEST(test_pockets_of_scatters);
    RUN_TEST(test_every_pocket_filled_is_the_inside);
    RUN_TEST(test_seed_refusals);
    return UNITY_END();
}
