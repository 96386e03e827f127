/* test_surface_voxels.c - the conservative surface against separating axes,
 * voxel by voxel; what a call refuses. */
#include "surface_voxels_support.h"

static void test_small_triangles_touch_what_no_axis_separates(void)
{
    check_small_triangles(CONSERVATIVE, quick ? 150 : 1200);
}

static void test_meshes_and_windows_are_the_oracles(void)
{
    check_meshes(CONSERVATIVE, quick ? 24 : 360);
}

static void test_order_types_and_strides_change_nothing(void)
{
    check_views(CONSERVATIVE);
}

static void test_contexts_and_windows_agree(void)
{
    check_contexts(CONSERVATIVE);
}

static void test_workers_share_the_triangles(void)
{
    check_workers(CONSERVATIVE);
}

/* Triangles of up to 2^31 steps whose planes pass near a window: two corners anywhere, the third one such
 * that some point of the window lies near the plane. */
static void make_far(int32_t count, const bvx_window *w, int32_t f)
{
    double const most = (double)((1 << 30) - 1) / (1 << f);

    maker_clear(&mesh);
    for (int32_t i = 0; i < count; i++) {
        uint32_t v[3];
        double p[3][3];
        for (int a = 0; a < 3; a++) {
            double const target = w->low[a] + maker_between(&seed, 0, w->size[a], 1 << f);
            double const reach = i % 3 == 0 ? most : i % 3 == 1 ? 40 : most / 50;
            for (int c = 0; c < 2; c++)
                p[c][a] = maker_between(&seed, target - reach / 2, target + reach / 2,
                                        i % 2 == 0 ? 1 << f : 1);
            p[2][a] = i % 5 == 0 ? 2 * target - p[0][a] : 3 * target - p[0][a] - p[1][a];
            for (int c = 0; c < 3; c++) p[c][a] = p[c][a] > most ? most : p[c][a] < -most ? -most : p[c][a];
        }
        if (i % 7 == 0) p[0][i % 3] = p[1][i % 3] = p[2][i % 3]; /* along an axis plane */
        for (int c = 0; c < 3; c++) v[c] = maker_vertex(&mesh, p[c][0], p[c][1], p[c][2]);
        maker_triangle(&mesh, v[0], v[1], v[2]);
    }
}

static void test_huge_triangles_in_small_windows(void)
{
    static const int32_t sides[] = {8192, 5000, 1 << 14, 1 << 17, 1 << 20, 1 << 25, 9, 300};

    surface_set = surface_clear = 0;
    for (int32_t n = 0; n < (quick ? 16 : 240); n++) {
        int32_t const side = sides[n % 8];
        bvx_lattice const l = lattice_of(side, side < 8192 ? side : side / 2, side);
        bvx_context *const c = surface_context(n / 8);
        bvx_window w;
        for (int a = 0; a < 3; a++) {
            w.size[a] = a == 0 && side > 70 && n % 3 == 0 ? 70 : 9;
            w.low[a] = l.dims[a] == w.size[a] ? 0 : maker_below(&seed, l.dims[a] - w.size[a] + 1);
            if (n % 5 == 1) w.low[a] = l.dims[a] - w.size[a]; /* the far corner */
        }
        make_far(6, &w, l.fraction_bits);
        assert_surface(c, &l, &w, CONSERVATIVE, "huge");
        assert_surface(c, &l, &w, THIN, "huge, thin");
        bvx_context_destroy(c);
    }
    /* it was about something */
    TEST_ASSERT_TRUE(surface_set > surface_clear / 20 && surface_clear > surface_set);
}

/* The bit budgets at their ends: corners at the extremes of the fixed point. */
static void test_extreme_corners(void)
{
    static const int32_t sides[] = {8192, 1 << 14, 1 << 25};

    for (int32_t n = 0; n < (quick ? 30 : 300); n++) {
        int32_t const side = sides[n % 3];
        bvx_lattice const l = lattice_of(side, side, side);
        double const most = (double)((1 << 30) - 1) / (1 << l.fraction_bits);
        bvx_context *const c = surface_context(n / 3);
        bvx_window w;
        uint32_t v[3];
        maker_clear(&mesh);
        for (int i = 0; i < 3; i++) {
            double p[3];
            for (int a = 0; a < 3; a++)
                p[a] = maker_below(&seed, 3) == 0 ? maker_below(&seed, side)
                       : maker_below(&seed, 2)    ? most
                                                  : -most;
            v[i] = maker_vertex(&mesh, p[0], p[1], p[2]);
        }
        maker_triangle(&mesh, v[0], v[1], v[2]);
        for (int a = 0; a < 3; a++) {
            w.size[a] = 8;
            w.low[a] = n % 2 == 0 ? 0 : side - 8;
        }
        assert_surface(c, &l, &w, CONSERVATIVE, "extreme");
        assert_surface(c, &l, &w, THIN, "extreme, thin");
        bvx_context_destroy(c);
    }
}

/* Slivers whose projection along x has an area of one half step: from row to row
 * their planes leap by so many voxels that doubles say nothing of them. Seen along
 * x a corner lies (n + 1, n) steps from the first one, another (n + 2, n + 1). */
static void test_planes_too_steep_for_doubles(void)
{
    for (int32_t n = 0; n < (quick ? 8 : 40); n++) {
        bvx_lattice const l = lattice_of(8192, 40, 40);
        bvx_context *const c = surface_context(n);
        int32_t const long_steps = 1 + maker_below(&seed, n % 2 == 0 ? 1 << 19 : 1 << 10);
        int32_t const reach = 1 + maker_below(&seed, 1 << 29);
        bvx_window w = {{0, 12, 15}, {70, 13, 11}};
        int32_t p[3][3];
        uint32_t v[3];
        w.low[0] = 128 * maker_below(&seed, 60);
        for (int a = 0; a < 3; a++) p[0][a] = (w.low[a] + 1) * 65536 + maker_below(&seed, 8 * 65536);
        p[1][0] = p[0][0] + reach;
        p[1][1] = p[0][1] + long_steps + 1;
        p[1][2] = p[0][2] + long_steps;
        p[2][0] = p[0][0] - reach / (1 + n % 3);
        p[2][1] = p[0][1] + long_steps + 2;
        p[2][2] = p[0][2] + long_steps + 1;
        if (p[1][0] > (1 << 30) - 1) p[1][0] = (1 << 30) - 1;
        maker_clear(&mesh);
        for (int i = 0; i < 3; i++)
            v[i] = maker_vertex(&mesh, p[i][0] / 65536.0, p[i][1] / 65536.0, p[i][2] / 65536.0);
        if (n % 4 < 2) maker_triangle(&mesh, v[0], v[1], v[2]);
        else maker_triangle(&mesh, v[0], v[2], v[1]);
        assert_surface(c, &l, &w, CONSERVATIVE, "steep");
        bvx_context_destroy(c);
    }
}

/* Triangles over more rows than a triangle keeps the bounds of. */
static void test_triangles_over_very_many_rows(void)
{
    for (int32_t n = 0; n < (quick ? 3 : 10); n++) {
        bvx_lattice const l = lattice_of(9, 700, 4);
        bvx_context *const c = surface_context(n);
        maker_clear(&mesh);
        for (int32_t i = 0; i < 3; i++) {
            uint32_t v[3];
            for (int k = 0; k < 3; k++)
                v[k] = maker_vertex(&mesh, maker_between(&seed, -2, 11, 65536),
                                    maker_between(&seed, -20, 720, 65536),
                                    maker_between(&seed, -1, 5, 65536));
            maker_triangle(&mesh, v[0], v[1], v[2]);
        }
        assert_surface(c, &l, NULL, CONSERVATIVE, "many rows");
        bvx_context_destroy(c);
    }
}

/* ---- Known places ---- */

static void test_a_box_on_lattice_planes_touches_both_sides(void)
{
    bvx_lattice const l = lattice_of(8, 8, 8);
    double const low[3] = {2, 2, 2}, high[3] = {5, 5, 5};
    bvx_grid g;

    maker_box(&mesh, low, high);
    g = surface_of(&l, CONSERVATIVE);
    for (int32_t z = 0; z < 8; z++)
        for (int32_t y = 0; y < 8; y++)
            for (int32_t x = 0; x < 8; x++) {
                int const inside = x >= 1 && x <= 5 && y >= 1 && y <= 5 && z >= 1 && z <= 5;
                int const core = x == 3 && y == 3 && z == 3;
                TEST_ASSERT_EQUAL_INT(inside && !core, bvx_grid_get(&g, x, y, z));
            }
    TEST_ASSERT_EQUAL_UINT64(124, set_voxels(&g));
    bvx_grid_free(ctx, &g);
}

static void test_thin_lies_in_conservative(void)
{
    for (int32_t trial = 0; trial < (quick ? 4 : 24); trial++) {
        bvx_lattice const l = lattice_of(70, 30, 25);
        bvx_grid thin, all;
        size_t words;
        if (trial % 2 == 0) make_scan(1500, l.dims, trial % 4 == 0 ? 16 : 1);
        else make_random(trial / 2 % KINDS == HUGE ? MIXED : trial / 2 % KINDS, 80, l.dims, 16);
        thin = surface_of(&l, THIN);
        all = surface_of(&l, CONSERVATIVE);
        words = (size_t)all.words_per_row * 30 * 25;
        for (size_t i = 0; i < words; i++) TEST_ASSERT_EQUAL_UINT64(0, thin.words[i] & ~all.words[i]);
        bvx_grid_free(ctx, &thin);
        bvx_grid_free(ctx, &all);
    }
}

/* ---- Refusals ---- */

static void assert_refused(const bvx_mesh_view *view, const bvx_lattice *l, const bvx_surface_options *o,
                           bvx_status want, const char *word)
{
    bvx_grid g = {0};
    TEST_ASSERT_EQUAL_INT32(want, bvx_voxelize_surface(ctx, view, l, o, &g));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx));
    TEST_ASSERT_NULL(g.words);
}

static void test_refuses_what_it_cannot_do(void)
{
    bvx_lattice l = lattice_of(8, 8, 8);
    double const low[3] = {2, 2, 2}, high[3] = {5, 5, 5};
    bvx_surface_options o;
    bvx_attached attached = {0};
    bvx_mesh_view view;
    uint32_t lone = 0;

    maker_box(&mesh, low, high);
    view = maker_view(&mesh);
    for (int32_t mode = -1; mode <= 3; mode += 4) {
        o = (bvx_surface_options){.struct_size = sizeof o};
        o.mode = mode;
        assert_refused(&view, &l, &o, BVX_ERR_ARGUMENT, "mode");
    }
    o = (bvx_surface_options){.struct_size = sizeof o};
    o.reserved = 1;
    assert_refused(&view, &l, &o, BVX_ERR_ARGUMENT, "reserved");
    o = (bvx_surface_options){.struct_size = sizeof o};
    o.window.size[0] = 9;
    o.window.size[1] = o.window.size[2] = 1;
    assert_refused(&view, &l, &o, BVX_ERR_RANGE, "window");
    o = (bvx_surface_options){.struct_size = sizeof o};
    o.attached = &attached;
    attached.triangles = &lone;
    assert_refused(&view, &l, &o, BVX_ERR_ARGUMENT, "attached");
    o = (bvx_surface_options){.struct_size = sizeof o};
    for (int32_t mode = 0; mode < MODES; mode++) {
        o.mode = mode;
        view = maker_view(&mesh);
        view.triangle_count = 0;
        assert_refused(&view, &l, &o, BVX_ERR_EMPTY, "triangles");
        view = maker_view(&mesh);
        view.vertex_count = 7;
        assert_refused(&view, &l, &o, BVX_ERR_RANGE, "triangle ");
        view = maker_view(&mesh);
        mesh.p[4] = 20000;
        assert_refused(&view, &l, &o, BVX_ERR_RANGE, "vertex 1 ");
        mesh.p[4] = NAN;
        assert_refused(&view, &l, &o, BVX_ERR_RANGE, "vertex 1 ");
        mesh.p[4] = 2;
    }
    assert_refused(NULL, &l, NULL, BVX_ERR_ARGUMENT, "NULL");
    assert_refused(&view, NULL, NULL, BVX_ERR_ARGUMENT, "NULL");
    l.fraction_bits = 3;
    assert_refused(&view, &l, NULL, BVX_ERR_ARGUMENT, "fraction bits");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_surface(ctx, &view, &l, NULL, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_surface(NULL, &view, &l, NULL, NULL));
}

/* The caller's words are filled; too few are refused. */
static void test_fills_the_callers_words(void)
{
    bvx_lattice const l = lattice_of(70, 8, 8);
    double const low[3] = {2, 2, 2}, high[3] = {66, 5, 5};
    uint64_t words[128];
    bvx_surface_options o;
    bvx_mesh_view view;
    bvx_grid g, own;

    maker_box(&mesh, low, high);
    view = maker_view(&mesh);
    for (int32_t mode = 0; mode < MODES; mode++) {
        own = surface_of(&l, mode);
        memset(words, 0xff, sizeof words);
        memset(&g, 0, sizeof g);
        g.words = words;
        g.word_capacity = 127;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, bvx_voxelize_surface(ctx, &view, &l, NULL, &g));
        g.word_capacity = 128;
        o = (bvx_surface_options){.struct_size = sizeof o};
        o.mode = mode;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(ctx, &view, &l, &o, &g));
        TEST_ASSERT_EQUAL_PTR(words, g.words);
        assert_same_bits(&own, &g, "the caller's words");
        bvx_grid_free(ctx, &own);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_small_triangles_touch_what_no_axis_separates);
    RUN_TEST(test_meshes_and_windows_are_the_oracles);
    RUN_TEST(test_order_types_and_strides_change_nothing);
    RUN_TEST(test_contexts_and_windows_agree);
    RUN_TEST(test_workers_share_the_triangles);
    RUN_TEST(test_huge_triangles_in_small_windows);
    RUN_TEST(test_extreme_corners);
    RUN_TEST(test_planes_too_steep_for_doubles);
    RUN_TEST(test_triangles_over_very_many_rows);
    RUN_TEST(test_a_box_on_lattice_planes_touches_both_sides);
    RUN_TEST(test_thin_lies_in_conservative);
    RUN_TEST(test_refuses_what_it_cannot_do);
    RUN_TEST(test_fills_the_callers_words);
    return UNITY_END();
}
