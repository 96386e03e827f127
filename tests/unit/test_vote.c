/* test_vote.c - the rule vote against parities along each axis and solid
 * angles, voxel by voxel; and what may not change it. */
#include "solid_support.h"
#include "grid/turned_rows.h"
#include "tools/fill_oracle.h"
#include "solid/solid.h"

static const int32_t shapes[][3] = {{65, 9, 8},  {9, 66, 7},  {7, 8, 130}, {1, 12, 12},
                                    {12, 1, 11}, {13, 12, 1}, {20, 18, 22}};
enum { SHAPES = sizeof shapes / sizeof shapes[0] };

/* Sure centres have the parity that all axes have; others the nearest whole number of turns, where it is
 * clear. Only for meshes whose triangles run in one direction along shared edges. halves: corners lie half
 * voxels apart, so that it can be told on which side of a triangle a moved centre is that lies on it. */
static void assert_vote_is_oracle(const bvx_lattice *l, const bvx_window *window, int halves,
                                  uint64_t *unsure)
{
    int64_t *const q = snapped(l);
    bvx_solid_report r;
    bvx_grid g = solid_by(ctx, l, window, BVX_FILL_VOTE, &r);
    double scale[3];
    char text[120];

    for (int a = 0; a < 3; a++) scale[a] = l->spacing[a] / (1 << l->fraction_bits);
    for (int32_t z = 0; z < g.size[2]; z++)
        for (int32_t y = 0; y < g.size[1]; y++)
            for (int32_t x = 0; x < g.words_per_row * 64; x++) {
                int64_t const c[3] = {oracle_centre(g.low[0] + x, l->fraction_bits),
                                      oracle_centre(g.low[1] + y, l->fraction_bits),
                                      oracle_centre(g.low[2] + z, l->fraction_bits)};
                int balanced[3], parity[3], want, clear = 1;
                if (x >= g.size[0]) {
                    TEST_ASSERT_EQUAL_INT(0, bvx_grid_get(&g, x, y, z));
                    continue;
                }
                for (int a = 0; a < 3; a++)
                    parity[a] = fill_parity_at(q, mesh.t, mesh.triangles, c, a, &balanced[a]);
                want = parity[0];
                if (!(balanced[0] && balanced[1] && balanced[2] && parity[0] == parity[1] &&
                      parity[1] == parity[2])) {
                    double const turns = fill_turns_at(q, mesh.t, mesh.triangles, c,
                                                       halves ? fill_moved : fill_unmoved, scale, &clear);
                    double const whole = floor(turns + 0.5);
                    want = ((int64_t)whole & 1) != 0;
                    clear = (clear || halves) && fabs(turns - whole) < 0.5 - (halves ? 0.01 : 1e-6);
                    ++*unsure;
                }
                if (!clear || want == bvx_grid_get(&g, x, y, z)) continue;
                snprintf(text, sizeof text, "voxel (%d, %d, %d) of a %d x %d x %d window is %d (%g turns)",
                         (int)x, (int)y, (int)z, (int)g.size[0], (int)g.size[1], (int)g.size[2], !want,
                         fill_turns_at(q, mesh.t, mesh.triangles, c, halves ? fill_moved : fill_unmoved,
                                       scale, &clear));
                TEST_FAIL_MESSAGE(text);
            }
    bvx_grid_free(ctx, &g);
    free(q);
}

static void make_stars(int32_t count, const bvx_lattice *l, int32_t steps, int32_t remove)
{
    for (int32_t n = 0; n < count; n++) {
        double centre[3], radius[3];
        for (int a = 0; a < 3; a++) {
            centre[a] = maker_step(maker_between(&seed, 0.2 * l->dims[a], 0.8 * l->dims[a], 1000), steps);
            radius[a] = 0.2 * l->dims[a] + maker_below(&seed, l->dims[a] / 3 + 1);
        }
        maker_star(&mesh, &seed, centre, radius, 0.5, 4 + maker_below(&seed, 4), 5 + maker_below(&seed, 5),
                   steps);
    }
    for (int32_t i = 0; i < remove; i++)
        maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
}

/* Rows along each axis as they come, and which of them do not balance. */
static void assert_axes_are_oracle(const bvx_lattice *l, const bvx_window *window)
{
    int64_t *const q = snapped(l);
    bvx_mesh_view const view = maker_view(&mesh);

    for (int axis = 0; axis < 3; axis++) {
        bvx_solid_report r = {0};
        bvx_grid g = {0}, turned;
        bvxi_solid_job job;
        uint64_t odd = 0, words;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, l, window, &g));
        bvxi_turn_shape(&g, axis, &turned);
        words = bvxi_grid_words(&turned);
        turned.words = axis == 0 ? g.words : maker_grow(NULL, (size_t)words * 8);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_solid_open(ctx, "test", &view, l, &job));
        job.keep_odd = 1;
        job.odd_rows = maker_grow(NULL, (size_t)bvxi_grid_rows(&turned));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_solid_fill(bvxi_solid_step(ctx, &job, 0, 1), &job, &turned, axis,
                                                        BVX_FILL_PARITY, &r));
        if (axis != 0) TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_turn_back(ctx, &turned, axis, 1, &g, NULL));
        for (int32_t z = 0; z < g.size[2]; z++)
            for (int32_t y = 0; y < g.size[1]; y++)
                for (int32_t x = 0; x < g.words_per_row * 64; x++) {
                    int32_t const at[3] = {x, y, z};
                    int64_t const c[3] = {oracle_centre(g.low[0] + x, l->fraction_bits),
                                          oracle_centre(g.low[1] + y, l->fraction_bits),
                                          oracle_centre(g.low[2] + z, l->fraction_bits)};
                    size_t const row = (size_t)at[fill_axes[axis][2]] * (size_t)turned.size[1] +
                                       (size_t)at[fill_axes[axis][1]];
                    int balanced = 1;
                    int const want = x < g.size[0]
                                         ? fill_parity_at(q, mesh.t, mesh.triangles, c, axis, &balanced)
                                         : 0;
                    TEST_ASSERT_EQUAL_INT(want, bvx_grid_get(&g, x, y, z));
                    if (x >= g.size[0]) continue;
                    TEST_ASSERT_EQUAL_INT(!balanced, job.odd_rows[row]);
                    odd += !balanced && at[axis] == 0;
                }
        TEST_ASSERT_EQUAL_UINT64(odd, r.unbalanced_rows);
        free(job.odd_rows);
        if (axis != 0) free(turned.words);
        bvxi_solid_close(ctx, &job);
        bvx_grid_free(ctx, &g);
    }
    free(q);
}

static void test_rows_along_each_axis(void)
{
    for (int s = 0; s < SHAPES; s++)
        for (int32_t kind = 0; kind < KINDS; kind++)
            for (int32_t trial = 0; trial < (quick ? 2 : 6); trial++) {
                bvx_lattice const l = lattice_of(shapes[s][0], shapes[s][1], shapes[s][2]);
                bvx_window w;
                for (int a = 0; a < 3; a++) {
                    w.size[a] = 1 + maker_below(&seed, l.dims[a]);
                    w.low[a] = maker_below(&seed, l.dims[a] - w.size[a] + 1);
                }
                make_random(kind, kind == ALIGNED ? 20 : 6, l.dims, 16);
                assert_axes_are_oracle(&l, trial % 2 ? &w : NULL);
            }
}

/* Every corner on a centre: rows that meet planes, edges and corners, along all axes. */
static void test_rows_through_corners(void)
{
    for (int32_t trial = 0; trial < (quick ? 12 : 300); trial++) {
        bvx_lattice const l = lattice_of(6, 5, 7);
        double const low[3] = {-0.5, -0.5, -0.5}, high[3] = {6.5, 5.5, 7.5};
        maker_clear(&mesh);
        maker_soup(&mesh, &seed, 15, low, high, 1);
        assert_axes_are_oracle(&l, NULL);
    }
}

static int runs_one_way(const bvx_lattice *l)
{
    int64_t *const q = snapped(l);
    int const one_way = fill_runs_one_way(q, mesh.t, mesh.triangles);
    free(q);
    return one_way;
}

/* Sheets on which centres lie, and centres that are inside several bodies at once. */
static void test_sheets_through_centres(void)
{
    uint64_t unsure = 0;

    for (int32_t trial = 0; trial < (quick ? 20 : 500); trial++) {
        bvx_lattice const l = lattice_of(9, 8, 10);
        maker_clear(&mesh);
        for (int32_t n = 0; n <= trial % 5; n++) {
            double const centre[3] = {4.5, 4.5, 4.5}, radius[3] = {5 - 0.5 * n, 4, 4 + 0.5 * n};
            maker_star(&mesh, &seed, centre, radius, 0.2, 4, 5, trial % 2 ? 2 : 65536);
        }
        for (int32_t i = 0; i < 6 + trial % 30 && mesh.triangles > 9; i++)
            maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
        if (runs_one_way(&l)) assert_vote_is_oracle(&l, NULL, trial % 2, &unsure);
    }
    TEST_ASSERT_TRUE(unsure > 5000);
}

static void test_triangles_that_have_nothing_to_do_with_each_other(void)
{
    uint64_t unsure = 0;

    for (int s = 0; s < SHAPES; s++)
        for (int32_t kind = 0; kind < KINDS; kind++)
            for (int32_t trial = 0; trial < (quick ? 1 : 2); trial++) {
                bvx_lattice const l = lattice_of(shapes[s][0], shapes[s][1], shapes[s][2]);
                make_random(kind, 3 << trial, l.dims, kind == HUGE ? 16 : 12);
                assert_vote_is_oracle(&l, NULL, 0, &unsure);
            }
    TEST_ASSERT_TRUE(unsure > 1000);
}

static void test_bodies_with_holes(void)
{
    uint64_t unsure = 0;

    for (int32_t trial = 0; trial < (quick ? 3 : 30); trial++) {
        bvx_lattice l = lattice_of(shapes[trial % SHAPES][0], shapes[trial % SHAPES][1],
                                   shapes[trial % SHAPES][2]);
        maker_clear(&mesh);
        make_stars(1 + trial % 3, &l, trial % 4 == 0 ? 2 : 65536, 1 << trial % 6);
        assert_vote_is_oracle(&l, NULL, 0, &unsure);
        for (size_t i = 0; i < mesh.vertices; i++) /* stretched voxels see other angles */
            mesh.p[3 * i + (size_t)(trial % 3)] *= 2.75;
        l.spacing[trial % 3] = 2.75;
        assert_vote_is_oracle(&l, NULL, 0, &unsure);
    }
    TEST_ASSERT_TRUE(unsure > 1000);
}

/* A box without its lid: the sheet is flat, and moves up or down nowhere
 * near as far as rows along z are wrong. */
static void test_open_box_by_hand(void)
{
    bvx_lattice const l = lattice_of(24, 24, 24);
    double const low[3] = {4, 4, 4}, high[3] = {20, 20, 20};
    bvx_solid_report r;
    bvx_grid g;

    maker_box(&mesh, low, high);
    mesh.triangles -= 2; /* the lid, z = 20 */
    g = solid_by(ctx, &l, NULL, BVX_FILL_VOTE, &r);
    TEST_ASSERT_EQUAL_UINT64(16 * 16, r.unbalanced_rows);
    for (int32_t z = 0; z < 24; z++)
        for (int32_t y = 0; y < 24; y++)
            for (int32_t x = 0; x < 24; x++)
                TEST_ASSERT_EQUAL_INT(x >= 4 && x < 20 && y >= 4 && y < 20 && z >= 4 && z < 20,
                                      bvx_grid_get(&g, x, y, z));
    bvx_grid_free(ctx, &g);
    g = solid_by(ctx, &l, NULL, BVX_FILL_REGIONS, &r);
    TEST_ASSERT_EQUAL_UINT64(16 * 16 * 16, set_voxels(&g));
    TEST_ASSERT_EQUAL_UINT64(1, r.regions);
    TEST_ASSERT_EQUAL_UINT64(1, r.mixed_regions);
    bvx_grid_free(ctx, &g);
}

/* ---- Closed meshes ---- */

static void assert_parity_vote_and_regions_agree(const bvx_lattice *l)
{
    bvx_solid_report r;
    bvx_grid parity = solid_of(l, BVX_FILL_PARITY), vote = solid_by(ctx, l, NULL, BVX_FILL_VOTE, &r), regions;

    assert_same_bits(&parity, &vote, "vote");
    TEST_ASSERT_EQUAL_UINT64(0, r.unbalanced_rows);
    bvx_grid_free(ctx, &vote);
    regions = solid_by(ctx, l, NULL, BVX_FILL_REGIONS, &r);
    assert_same_bits(&parity, &regions, "regions");
    TEST_ASSERT_EQUAL_UINT64(0, r.mixed_regions);
    bvx_grid_free(ctx, &regions);
    bvx_grid_free(ctx, &parity);
}

static void test_closed_meshes_are_their_parity(void)
{
    for (int32_t trial = 0; trial < (quick ? 6 : 200); trial++) {
        int32_t const *const n = shapes[trial % SHAPES];
        bvx_lattice const l = lattice_of(n[0], n[1], n[2]);
        maker_clear(&mesh);
        /* on planes, on centres, anywhere */
        make_stars(1 + trial % 4, &l, trial % 3 == 0 ? 1 : trial % 3 == 1 ? 2 : 65536, 0);
        if (trial % 5 == 0) maker_flip(&mesh, 0, mesh.triangles / 2);
        assert_parity_vote_and_regions_agree(&l);
    }
}

static void test_sets_of_cubes_on_planes_and_on_centres(void)
{
    for (int32_t trial = 0; trial < (quick ? 4 : 60); trial++) {
        int32_t const n[3] = {1 + maker_below(&seed, 20), 1 + maker_below(&seed, 20),
                              1 + maker_below(&seed, 20)};
        double const at[3] = {trial % 2 ? 0.5 : 0, trial % 3 == 1 ? 0.5 : 0, trial % 4 > 1 ? 0.5 : 0};
        bvx_lattice const l = lattice_of(n[0] + 1, n[1] + 1, n[2] + 1);
        size_t const count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
        uint8_t *const solid = maker_grow(NULL, count);
        for (size_t i = 0; i < count; i++) solid[i] = maker_below(&seed, 3) != 0;
        solid[0] = 1;
        maker_clear(&mesh);
        maker_cubes(&mesh, &seed, solid, n, at);
        assert_parity_vote_and_regions_agree(&l);
        free(solid);
    }
}

/* ---- What may not matter ---- */

static void test_windows_are_cut_out_of_the_whole(void)
{
    for (int32_t trial = 0; trial < (quick ? 3 : 40); trial++) {
        bvx_lattice const l = lattice_of(75, 20, 18);
        bvx_grid whole;
        maker_clear(&mesh);
        if (trial % 2) make_stars(2, &l, 65536, 20);
        else make_random(trial % KINDS, 40, l.dims, 16);
        whole = solid_of(&l, BVX_FILL_VOTE);
        for (int32_t n = 0; n < 8; n++) {
            bvx_window w;
            bvx_grid part;
            for (int a = 0; a < 3; a++) {
                w.size[a] = n == 0 ? 1 : 1 + maker_below(&seed, l.dims[a]);
                w.low[a] = maker_below(&seed, l.dims[a] - w.size[a] + 1);
            }
            part = solid_by(ctx, &l, &w, BVX_FILL_VOTE, NULL);
            for (int32_t z = 0; z < w.size[2]; z++)
                for (int32_t y = 0; y < w.size[1]; y++)
                    for (int32_t x = 0; x < w.size[0]; x++)
                        TEST_ASSERT_EQUAL_INT(bvx_grid_get(&whole, w.low[0] + x, w.low[1] + y, w.low[2] + z),
                                              bvx_grid_get(&part, x, y, z));
            bvx_grid_free(ctx, &part);
        }
        bvx_grid_free(ctx, &whole);
    }
}

static void test_order_and_orientation_change_nothing(void)
{
    for (int32_t trial = 0; trial < (quick ? 4 : 60); trial++) {
        bvx_lattice const l = lattice_of(40, 30, 34);
        bvx_grid a, b;
        maker_clear(&mesh);
        make_stars(2, &l, 65536, 3 + trial);
        a = solid_of(&l, BVX_FILL_VOTE);
        maker_shuffle_triangles(&mesh, &seed);
        maker_shuffle_vertices(&mesh, &seed);
        for (size_t i = 0, n = mesh.triangles; i < n; i += 3) { /* corners of their own at the same places */
            uint32_t *const t = mesh.t + 3 * i;
            t[1] = maker_vertex(&mesh, mesh.p[3 * (size_t)t[1]], mesh.p[3 * (size_t)t[1] + 1],
                                mesh.p[3 * (size_t)t[1] + 2]);
        }
        b = solid_of(&l, BVX_FILL_VOTE);
        assert_same_bits(&a, &b, "order");
        bvx_grid_free(ctx, &b);
        for (size_t i = 0; i < mesh.triangles; i++) maker_flip(&mesh, i, i + 1);
        b = solid_of(&l, BVX_FILL_VOTE);
        assert_same_bits(&a, &b, "orientation");
        bvx_grid_free(ctx, &b);
        bvx_grid_free(ctx, &a);
    }
}

static void test_threads_and_code_paths_change_nothing(void)
{
    static const int32_t threads[] = {1, 2, 3, 8};

    for (int32_t trial = 0; trial < (quick ? 3 : 8); trial++) {
        bvx_lattice const l = lattice_of(140, 30, 33);
        bvx_grid first;
        bvx_solid_report r, s;
        maker_clear(&mesh);
        make_stars(4, &l, 65536, trial * 5);
        if (trial == 1) make_random(MIXED, 60, l.dims, 16);
        first = solid_by(ctx, &l, NULL, BVX_FILL_VOTE, &r);
        for (int i = 0; i < 8; i++) {
            bvx_context *const c = suite_context(threads[i % 4], i < 4 ? BVX_CPU_BEST : BVX_CPU_PORTABLE);
            bvx_grid g = solid_by(c, &l, NULL, BVX_FILL_VOTE, &s);
            assert_same_bits(&first, &g, "threads");
            TEST_ASSERT_EQUAL_MEMORY(&r, &s, sizeof r);
            bvx_grid_free(c, &g);
            bvx_context_destroy(c);
        }
        bvx_grid_free(ctx, &first);
    }
}

/* ---- Counts ---- */

static void test_report_sums_three_axes(void)
{
    bvx_lattice const l = lattice_of(10, 10, 10);
    double const low[3] = {2, 3, 4}, high[3] = {6, 5, 7};
    bvx_solid_report r;
    bvx_grid g;

    maker_box(&mesh, low, high);
    g = solid_by(ctx, &l, NULL, BVX_FILL_VOTE, &r);
    TEST_ASSERT_EQUAL_UINT64(2 * (2 * 3 + 4 * 3 + 4 * 2), r.crossings);
    TEST_ASSERT_EQUAL_UINT64(4 * 2 * 3, set_voxels(&g));
    bvx_grid_free(ctx, &g);
}

static void test_shell_on_request(void)
{
    bvx_lattice const l = lattice_of(12, 11, 10);
    double const low[3] = {2.25, 3, 4}, high[3] = {6, 5.75, 7};
    bvx_voxelize_options o;
    bvx_solid_report r;
    bvx_mesh_view view;
    bvx_grid g = {0}, plain, shell = {0};

    maker_box(&mesh, low, high);
    maker_flip(&mesh, 0, 1); /* three flipped edges; without triangle 3 three open ones */
    maker_remove(&mesh, 3);
    view = maker_view(&mesh);
    for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_REGIONS; fill++) {
        if (fill == BVX_FILL_FLOOD) continue; /* would leak */
        o = (bvx_voxelize_options){.struct_size = sizeof o};
        o.fill = fill;
        o.report = &r;
        o.add_shell = 1;
        memset(&g, 0, sizeof g);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &l, &o, &g));
        plain = solid_of(&l, fill);
        memset(&shell, 0, sizeof shell);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(ctx, &view, &l, NULL, &shell));
        for (int32_t z = 0; z < 10; z++)
            for (int32_t y = 0; y < 11; y++)
                for (int32_t x = 0; x < 12; x++)
                    TEST_ASSERT_EQUAL_INT(bvx_grid_get(&plain, x, y, z) | bvx_grid_get(&shell, x, y, z),
                                          bvx_grid_get(&g, x, y, z));
        bvx_grid_free(ctx, &shell);
        bvx_grid_free(ctx, &plain);
        bvx_grid_free(ctx, &g);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_rows_along_each_axis);
    RUN_TEST(test_rows_through_corners);
    RUN_TEST(test_sheets_through_centres);
    RUN_TEST(test_triangles_that_have_nothing_to_do_with_each_other);
    RUN_TEST(test_bodies_with_holes);
    RUN_TEST(test_open_box_by_hand);
    RUN_TEST(test_closed_meshes_are_their_parity);
    RUN_TEST(test_sets_of_cubes_on_planes_and_on_centres);
    RUN_TEST(test_windows_are_cut_out_of_the_whole);
    RUN_TEST(test_order_and_orientation_change_nothing);
    RUN_TEST(test_threads_and_code_paths_change_nothing);
    RUN_TEST(test_report_sums_three_axes);
    RUN_TEST(test_shell_on_request);
    return UNITY_END();
}
