/* test_flood.c - the rules flood and regions against floods voxel by voxel; closing gaps against cubes tried one by one;
 * what a flood cannot do is refused. */
#include "solid_support.h"
#include "tools/fill_oracle.h"

static bvx_status fill_lattice(const bvx_lattice *l, int32_t fill, int32_t gaps, bvx_grid *g, bvx_solid_report *r)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_voxelize_options o;
    bvx_voxelize_options_init(&o, sizeof o);
    o.fill = fill;
    o.close_gaps = gaps;
    o.report = r;
    memset(g, 0, sizeof *g);
    return bvx_voxelize_solid(ctx, &view, l, &o, g);
}

static bvx_grid surface_of(const bvx_lattice *l)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_grid g = {0};
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(ctx, &view, l, NULL, &g));
    return g;
}

/* Parities agree and balance along all axes. */
static uint8_t *sure_centres(const bvx_lattice *l)
{
    int64_t *const q = snapped(l);
    int32_t const *const n = l->dims;
    uint8_t *const sure = maker_grow(NULL, (size_t)n[0] * (size_t)n[1] * (size_t)n[2]);
    for (int32_t z = 0; z < n[2]; z++)
        for (int32_t y = 0; y < n[1]; y++)
            for (int32_t x = 0; x < n[0]; x++) {
                int64_t const c[3] = {oracle_centre(x, l->fraction_bits), oracle_centre(y, l->fraction_bits), oracle_centre(z, l->fraction_bits)};
                int b[3], p[3];
                for (int a = 0; a < 3; a++) p[a] = fill_parity_at(q, mesh.t, mesh.triangles, c, a, &b[a]);
                sure[fill_place(n, x, y, z)] = (uint8_t)(b[0] && b[1] && b[2] && p[0] == p[1] && p[1] == p[2]);
            }
    free(q);
    return sure;
}

/* Spaces that touch a side of the lattice are reached. */
static uint8_t *reach(const uint8_t *open, const int32_t n[3])
{
    size_t const count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    int32_t *const label = maker_grow(NULL, count * sizeof *label);
    uint8_t *const outside = maker_grow(NULL, count);
    int32_t const spaces = fill_label(open, n, 6, label);
    uint8_t *const touched = maker_grow(NULL, (size_t)spaces + 1);
    memset(touched, 0, (size_t)spaces + 1);
    for (int32_t z = 0; z < n[2]; z++)
        for (int32_t y = 0; y < n[1]; y++)
            for (int32_t x = 0; x < n[0]; x++) {
                int32_t const s = label[fill_place(n, x, y, z)];
                if (s >= 0 && (x == 0 || y == 0 || z == 0 || x == n[0] - 1 || y == n[1] - 1 || z == n[2] - 1)) touched[s] = 1;
            }
    for (size_t i = 0; i < count; i++) outside[i] = label[i] >= 0 && touched[label[i]];
    free(touched);
    free(label);
    return outside;
}

/* An empty voxel stays open when some empty cube of gap + 1 voxels a side holds it; beyond the lattice all is empty. */
static uint8_t *open_for_cubes(const uint8_t *open, const int32_t n[3], int32_t gap)
{
    uint8_t *const stays = maker_grow(NULL, (size_t)n[0] * (size_t)n[1] * (size_t)n[2]);
    memset(stays, 0, (size_t)n[0] * (size_t)n[1] * (size_t)n[2]);
    for (int32_t z = -gap; z < n[2]; z++)
        for (int32_t y = -gap; y < n[1]; y++)
            for (int32_t x = -gap; x < n[0]; x++)
                for (int pass = 0, empty = 1; pass < 2 && empty; pass++)
                    for (int32_t w = z < 0 ? 0 : z; w <= z + gap && w < n[2]; w++)
                        for (int32_t v = y < 0 ? 0 : y; v <= y + gap && v < n[1]; v++)
                            for (int32_t u = x < 0 ? 0 : x; u <= x + gap && u < n[0]; u++) {
                                if (pass == 0) empty &= open[fill_place(n, u, v, w)];
                                else stays[fill_place(n, u, v, w)] = 1;
                            }
    return stays;
}

/* Returns 1 when the flood found an inside. */
static int assert_flood_is_oracle(const bvx_lattice *l, int32_t gaps)
{
    int32_t const *const n = l->dims;
    size_t const count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    bvx_grid surface = surface_of(l), vote = solid_of(l, BVX_FILL_VOTE), g;
    uint8_t *const open = fill_bytes(&surface, 1), *const in = fill_bytes(&vote, 0), *const sure = sure_centres(l);
    uint8_t *const wide = open_for_cubes(open, n, gaps), *const near = reach(open, n), *const far = reach(wide, n);
    uint64_t held = 0, leaks = 0, closed = 0;
    bvx_solid_report r;
    bvx_status const status = fill_lattice(l, BVX_FILL_FLOOD, gaps, &g, &r);
    for (size_t i = 0; i < count; i++) {
        held += (open[i] && !near[i]) || (wide[i] && !far[i]);
        leaks += wide[i] && far[i] && sure[i] && in[i];
        closed += open[i] && !wide[i];
    }
    if (held == 0 && leaks != 0) {
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, status);
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "close gaps of more than"));
        TEST_ASSERT_NULL(g.words);
    } else if (status != BVX_OK) {
        /* centres that are clear by their solid angle count as leaks too */
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, status);
        TEST_ASSERT_EQUAL_UINT64(0, held);
    } else {
        TEST_ASSERT_TRUE(r.leaks >= leaks);
        TEST_ASSERT_EQUAL_UINT64(closed, r.closed_voxels);
        TEST_ASSERT_EQUAL_UINT64(set_voxels(&surface), r.surface_voxels);
        for (int32_t z = 0; z < n[2]; z++)
            for (int32_t y = 0; y < n[1]; y++)
                for (int32_t x = 0; x < n[0]; x++) {
                    size_t const i = fill_place(n, x, y, z);
                    int const want = (open[i] && !near[i]) || (wide[i] ? !far[i] : in[i]);
                    TEST_ASSERT_EQUAL_INT(want, bvx_grid_get(&g, x, y, z));
                }
    }
    bvx_grid_free(ctx, &g);
    bvx_grid_free(ctx, &vote);
    bvx_grid_free(ctx, &surface);
    free(far);
    free(near);
    free(wide);
    free(sure);
    free(in);
    free(open);
    return status == BVX_OK && held > 0;
}

static void assert_regions_are_oracle(const bvx_lattice *l)
{
    int32_t const *const n = l->dims;
    size_t const count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    bvx_grid surface = surface_of(l), vote = solid_of(l, BVX_FILL_VOTE), g;
    uint8_t *const open = fill_bytes(&surface, 1), *const in = fill_bytes(&vote, 0), *const sure = sure_centres(l);
    int32_t *const label = maker_grow(NULL, count * sizeof *label);
    int32_t const regions = fill_label(open, n, 6, label);
    uint8_t *const sides = maker_grow(NULL, (size_t)regions + 1);
    bvx_solid_report r;
    memset(sides, 0, (size_t)regions + 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_lattice(l, BVX_FILL_REGIONS, 0, &g, &r));
    TEST_ASSERT_EQUAL_UINT64((uint64_t)regions, r.regions);
    for (size_t i = 0; i < count; i++)
        if (open[i] && sure[i]) sides[label[i]] |= in[i] ? 1 : 2;
    for (int32_t z = 0; z < n[2]; z++)
        for (int32_t y = 0; y < n[1]; y++)
            for (int32_t x = 0; x < n[0]; x++) {
                size_t const i = fill_place(n, x, y, z);
                int const got = bvx_grid_get(&g, x, y, z);
                if (!open[i]) TEST_ASSERT_EQUAL_INT(in[i], got);
                else if (sides[label[i]] == 3) TEST_ASSERT_EQUAL_INT(in[i], got); /* mixed for certain */
                else if (got != in[i]) TEST_ASSERT_EQUAL_INT(sides[label[i]], got ? 1 : 2); /* outvoted */
            }
    bvx_grid_free(ctx, &g);
    bvx_grid_free(ctx, &vote);
    bvx_grid_free(ctx, &surface);
    free(sides);
    free(label);
    free(sure);
    free(in);
    free(open);
}

static void make_bodies(int32_t trial, const bvx_lattice *l)
{
    maker_clear(&mesh);
    for (int32_t n = 0; n <= trial % 3; n++) {
        double centre[3], radius[3];
        for (int a = 0; a < 3; a++) {
            centre[a] = maker_between(&seed, 0.3 * l->dims[a], 0.7 * l->dims[a], 16);
            radius[a] = 0.15 * l->dims[a] + maker_below(&seed, l->dims[a] / 4 + 1);
        }
        maker_star(&mesh, &seed, centre, radius, 0.3, 6, 9, 65536);
    }
    for (int32_t i = 0; i < trial % 5; i++) maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
}

static const int32_t shapes[][3] = {{70, 14, 13}, {20, 22, 21}, {13, 66, 12}, {12, 14, 65}, {12, 1, 12}, {64, 10, 10}};
enum { SHAPES = sizeof shapes / sizeof shapes[0] };

static void test_bodies_and_soups(void)
{
    int32_t found = 0;
    for (int32_t trial = 0; trial < (quick ? 12 : 60); trial++) {
        bvx_lattice const l = lattice_of(shapes[trial % SHAPES][0], shapes[trial % SHAPES][1], shapes[trial % SHAPES][2]);
        if (trial % 6 == 5) make_random(trial % KINDS, 30, l.dims, 16);
        else make_bodies(trial, &l);
        assert_regions_are_oracle(&l);
        for (int32_t gaps = 0; gaps < 6; gaps += 1 + trial % 2) found += assert_flood_is_oracle(&l, gaps);
    }
    TEST_ASSERT_TRUE(found > 20);
}

/* Wide gaps, so that rows of several words move by more than a word. */
static void test_gaps_wider_than_a_word(void)
{
    bvx_lattice const l = lattice_of(190, 3, 4);
    maker_clear(&mesh);
    make_random(TINY, 3, l.dims, 16);
    for (int32_t gaps = 60; gaps < 140; gaps += quick ? 17 : 3) assert_flood_is_oracle(&l, gaps);
}

/* A box with a round cavity: flood fills it, regions keep it. */
static void test_cavities(void)
{
    bvx_lattice const l = lattice_of(30, 30, 30);
    double const low[3] = {3, 3, 3}, high[3] = {27, 27, 27}, centre[3] = {15, 15, 15}, radius[3] = {8, 8, 8};
    bvx_solid_report r;
    bvx_grid flood, regions, parity;
    maker_box(&mesh, low, high);
    maker_star(&mesh, &seed, centre, radius, 0.1, 8, 12, 65536);
    parity = solid_of(&l, BVX_FILL_PARITY);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_lattice(&l, BVX_FILL_REGIONS, 0, &regions, &r));
    assert_same_bits(&parity, &regions, "regions");
    TEST_ASSERT_EQUAL_UINT64(3, r.regions);
    TEST_ASSERT_EQUAL_UINT64(0, r.mixed_regions);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_lattice(&l, BVX_FILL_FLOOD, 0, &flood, &r));
    TEST_ASSERT_EQUAL_UINT64(0, r.leaks);
    TEST_ASSERT_EQUAL_INT(1, bvx_grid_get(&flood, 15, 15, 15));
    TEST_ASSERT_EQUAL_INT(0, bvx_grid_get(&parity, 15, 15, 15));
    TEST_ASSERT_TRUE(set_voxels(&flood) > set_voxels(&parity) + 700);
    bvx_grid_free(ctx, &flood);
    bvx_grid_free(ctx, &regions);
    bvx_grid_free(ctx, &parity);
}

/* A box whose lid has a square hole of 3 voxels: the flood goes through until gaps of 3 are closed. */
static void test_hole_in_a_lid(void)
{
    bvx_lattice const l = lattice_of(20, 20, 20);
    uint8_t solid[8 * 8 * 8];
    int32_t const n[3] = {8, 8, 8};
    double const at[3] = {6, 6, 6};
    bvx_solid_report r;
    bvx_grid g;
    memset(solid, 1, sizeof solid);
    maker_cubes(&mesh, &seed, solid, n, at);
    for (size_t i = mesh.triangles; i-- > 0;) { /* the lid's squares over 9..12 by 9..12; their neighbours keep 5 - 2 open */
        double m[3] = {0, 0, 0};
        for (int k = 0; k < 9; k++) m[k % 3] += mesh.p[3 * (size_t)mesh.t[3 * i + (size_t)(k / 3)] + (size_t)(k % 3)] / 3;
        if (m[2] == 14 && m[0] > 8 && m[0] < 13 && m[1] > 8 && m[1] < 13) maker_remove(&mesh, i);
    }
    for (int32_t gaps = 0; gaps < 6; gaps++) {
        bvx_status const status = fill_lattice(&l, BVX_FILL_FLOOD, gaps, &g, &r);
        if (gaps < 3) { /* closed boxes on planes touch both neighbours: 5 voxels wide becomes 3 */
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, status);
            TEST_ASSERT_NULL(g.words);
        } else {
            TEST_ASSERT_EQUAL_INT32(BVX_OK, status);
            TEST_ASSERT_EQUAL_UINT64(512, set_voxels(&g));
            TEST_ASSERT_EQUAL_UINT64(0, r.leaks);
        }
        bvx_grid_free(ctx, &g);
    }
}

static void test_refusals(void)
{
    bvx_lattice const l = lattice_of(10, 10, 10);
    double const low[3] = {2, 2, 2}, high[3] = {7, 7, 7};
    bvx_window const part = {{0, 0, 0}, {10, 10, 9}}, whole = {{0, 0, 0}, {10, 10, 10}};
    bvx_voxelize_options o;
    bvx_mesh_view view;
    bvx_grid g = {0};
    maker_box(&mesh, low, high);
    view = maker_view(&mesh);
    for (int32_t fill = BVX_FILL_FLOOD; fill <= BVX_FILL_REGIONS; fill++) {
        bvx_voxelize_options_init(&o, sizeof o);
        o.fill = fill;
        o.window = part;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &view, &l, &o, &g));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "whole lattice"));
        TEST_ASSERT_NULL(g.words);
        o.window = whole;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_solid(ctx, &view, &l, &o, &g));
        bvx_grid_free(ctx, &g);
    }
    for (int i = 0; i < 12; i++) {
        bvx_voxelize_options_init(&o, sizeof o);
        switch (i) {
        case 0: o.close_gaps = 1; break;
        case 1: o.fill = BVX_FILL_FLOOD; o.close_gaps = -1; break;
        case 2: o.fill = BVX_FILL_FLOOD; o.close_gaps = 65536; break;
        case 3: o.add_shell = 2; break;
        case 4: o.check_edges = -1; break;
        case 5: o.axis = 1; break;
        case 6: o.fill = BVX_FILL_BELOW; o.axis = 3; break;
        case 7: o.fill = BVX_FILL_BELOW; o.base = (double)NAN; break;
        case 8: o.base = 1; break;
        case 9: o.second = &view; break;
        case 10: o.fill = BVX_FILL_BELOW; o.add_shell = 1; break;
        default: o.fill = BVX_FILL_REGIONS; o.close_gaps = 2;
        }
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &view, &l, &o, &g));
        TEST_ASSERT_NULL(g.words);
    }
}

static void test_threads_change_nothing(void)
{
    static const int32_t threads[] = {1, 2, 3, 8};
    for (int32_t trial = 0; trial < (quick ? 4 : 20); trial++) {
        bvx_lattice const l = lattice_of(80, 70, 60);
        bvx_grid first = {0};
        bvx_solid_report r, s;
        bvx_status status = BVX_OK;
        make_bodies(trial, &l);
        for (int i = 0; i < 4; i++) {
            bvx_context *const c = context_with(threads[i], BVX_CPU_BEST);
            bvx_mesh_view const view = maker_view(&mesh);
            bvx_voxelize_options o;
            bvx_grid g = {0};
            bvx_status now;
            bvx_voxelize_options_init(&o, sizeof o);
            o.fill = trial % 2 ? BVX_FILL_FLOOD : BVX_FILL_REGIONS;
            o.close_gaps = trial % 2 ? trial % 7 : 0;
            o.report = i == 0 ? &r : &s;
            now = bvx_voxelize_solid(c, &view, &l, &o, &g);
            if (i == 0) {
                first = g;
                status = now;
                g.owned = 0;
            } else if (now == BVX_OK) {
                assert_same_bits(&first, &g, "threads");
                TEST_ASSERT_EQUAL_MEMORY(&r, &s, sizeof r);
            }
            TEST_ASSERT_EQUAL_INT32(status, now);
            bvx_grid_free(c, &g);
            if (i == 3) bvx_grid_free(c, &first); /* the same heap made it */
            bvx_context_destroy(c);
        }
    }
}

/* ---- Comparing the rules ---- */

static void test_comparison_by_brute_force(void)
{
    uint64_t disputed = 0, lost_all = 0;
    for (int32_t trial = 0; trial < (quick ? 6 : 30); trial++) {
        bvx_lattice const l = lattice_of(shapes[trial % SHAPES][0], shapes[trial % SHAPES][1], shapes[trial % SHAPES][2]);
        int32_t const *const n = l.dims;
        size_t const count = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
        bvx_compare_fills_options o;
        bvx_fill_comparison c;
        bvx_grid rule[5] = {{0}}, surface, differ = {0}, lost = {0};
        bvx_mesh_view view;
        uint8_t *open;
        int32_t *label;
        int32_t places;
        uint64_t disagreeing = 0, lost_voxels = 0;
        bvx_status flooded = BVX_OK;
        make_bodies(trial, &l);
        if (trial % 2) wall(0.3 * n[0], 0.8 * n[1], 1); /* an open sheet: lost in parts */
        view = maker_view(&mesh);
        for (int32_t fill = 0; fill < 5; fill++) {
            bvx_solid_report r;
            bvx_status const status = fill_lattice(&l, fill, fill == BVX_FILL_FLOOD ? trial % 3 : 0, &rule[fill], &r);
            if (fill == BVX_FILL_FLOOD) flooded = status;
            else TEST_ASSERT_EQUAL_INT32(BVX_OK, status);
        }
        surface = surface_of(&l);
        bvx_compare_fills_options_init(&o, sizeof o);
        o.close_gaps = trial % 3;
        o.disagreeing = &differ;
        o.lost = &lost;
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_compare_fills(ctx, &view, &l, &o, &c), bvx_last_message(ctx));
        TEST_ASSERT_EQUAL_INT32(flooded != BVX_OK, c.flood_leaked);
        for (int32_t fill = 0; fill < 5; fill++)
            if (rule[fill].words != NULL) TEST_ASSERT_EQUAL_UINT64(set_voxels(&rule[fill]), c.set[fill]);
        TEST_ASSERT_EQUAL_UINT64(set_voxels(&surface), c.surface_voxels);
        for (int32_t z = 0; z < n[2]; z++)
            for (int32_t y = 0; y < n[1]; y++)
                for (int32_t x = 0; x < n[0]; x++) {
                    int any = 0, all = 1, near = 0, want;
                    for (int32_t fill = 0; fill < 5; fill++) {
                        if (rule[fill].words == NULL) continue;
                        any |= bvx_grid_get(&rule[fill], x, y, z);
                        all &= bvx_grid_get(&rule[fill], x, y, z);
                    }
                    want = any && !all && !bvx_grid_get(&surface, x, y, z);
                    disagreeing += (uint64_t)want;
                    TEST_ASSERT_EQUAL_INT(want, bvx_grid_get(&differ, x, y, z));
                    for (int32_t d = 0; d < 27; d++) {
                        int32_t const u = x + d % 3 - 1, v = y + d / 3 % 3 - 1, w = z + d / 9 - 1;
                        if (u < 0 || v < 0 || w < 0 || u >= n[0] || v >= n[1] || w >= n[2]) continue;
                        near |= bvx_grid_get(&rule[BVX_FILL_VOTE], u, v, w);
                    }
                    want = bvx_grid_get(&surface, x, y, z) && !near;
                    lost_voxels += (uint64_t)want;
                    TEST_ASSERT_EQUAL_INT(want, bvx_grid_get(&lost, x, y, z));
                }
        TEST_ASSERT_EQUAL_UINT64(disagreeing, c.disagreeing);
        TEST_ASSERT_EQUAL_UINT64(lost_voxels, c.lost_voxels);
        open = fill_bytes(&lost, 0);
        label = maker_grow(NULL, count * sizeof *label);
        places = fill_label(open, n, 6, label);
        TEST_ASSERT_EQUAL_UINT64((uint64_t)places, c.lost_places);
        disputed += disagreeing;
        lost_all += lost_voxels;
        free(label);
        free(open);
        for (int32_t fill = 0; fill < 5; fill++) bvx_grid_free(ctx, &rule[fill]);
        bvx_grid_free(ctx, &surface);
        bvx_grid_free(ctx, &differ);
        bvx_grid_free(ctx, &lost);
    }
    TEST_ASSERT_TRUE(disputed > 0 && lost_all > 0);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_bodies_and_soups);
    RUN_TEST(test_gaps_wider_than_a_word);
    RUN_TEST(test_cavities);
    RUN_TEST(test_hole_in_a_lid);
    RUN_TEST(test_refusals);
    RUN_TEST(test_threads_change_nothing);
    RUN_TEST(test_comparison_by_brute_force);
    return UNITY_END();
}
