/* test_flood.c - the rule flood against floods voxel by voxel; closing gaps against cubes tried one by one;
 * cavities are filled to their walls; what a flood cannot do is refused. */
#include "fill_support.h"

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
                if (s >= 0 && (x == 0 || y == 0 || z == 0 || x == n[0] - 1 || y == n[1] - 1 || z == n[2] - 1))
                    touched[s] = 1;
            }
    for (size_t i = 0; i < count; i++) outside[i] = label[i] >= 0 && touched[label[i]];
    free(touched);
    free(label);
    return outside;
}

/* An empty voxel stays open when some empty cube of gap + 1 voxels a side
 * holds it; beyond the lattice all is empty. */
static uint8_t *open_for_cubes(const uint8_t *open, const int32_t n[3], int32_t gap)
{
    uint8_t *const stays = maker_grow(NULL, (size_t)n[0] * (size_t)n[1] * (size_t)n[2]);

    memset(stays, 0, (size_t)n[0] * (size_t)n[1] * (size_t)n[2]);
    for (int32_t z = -gap; z < n[2]; z++) {
        if (z < 0 && z + gap >= n[2] - 1) continue; /* the next one covers the same */
        for (int32_t y = -gap; y < n[1]; y++) {
            if (y < 0 && y + gap >= n[1] - 1) continue;
            for (int32_t x = -gap; x < n[0]; x++)
                for (int pass = 0, empty = 1; pass < 2 && empty; pass++)
                    for (int32_t w = z < 0 ? 0 : z; w <= z + gap && w < n[2]; w++)
                        for (int32_t v = y < 0 ? 0 : y; v <= y + gap && v < n[1]; v++)
                            for (int32_t u = x < 0 ? 0 : x; u <= x + gap && u < n[0]; u++) {
                                if (pass == 0) empty &= open[fill_place(n, u, v, w)];
                                else stays[fill_place(n, u, v, w)] = 1;
                            }
        }
    }
    return stays;
}

/* Voxels of walls that vote outside and are fewer steps, through others of their kind, from what was filled
 * against the vote than from what the flood reached or the lattice's end. */
static uint8_t *rim_of(const fill_scene *s, const uint8_t *wide, const uint8_t *held)
{
    int32_t const *const n = s->n;
    uint8_t *const walls = maker_grow(NULL, s->count);
    uint8_t *const outer = maker_grow(NULL, s->count);
    uint8_t *const inner = maker_grow(NULL, s->count);
    int32_t *to_outer, *to_inner;

    memset(walls, 0, s->count);
    memset(outer, 0, s->count);
    memset(inner, 0, s->count);
    for (size_t i = 0; i < s->count; i++) walls[i] = !wide[i] && !held[i] && !s->in[i];
    for (int32_t z = 0; z < n[2]; z++)
        for (int32_t y = 0; y < n[1]; y++)
            for (int32_t x = 0; x < n[0]; x++)
                for (int32_t d = 0; d < 27; d++) {
                    int32_t const u[3] = {x + d % 3 - 1, y + d / 3 % 3 - 1, z + d / 9 - 1};
                    size_t const i = fill_place(n, x, y, z);
                    if (u[0] < 0 || u[1] < 0 || u[2] < 0 || u[0] >= n[0] || u[1] >= n[1] || u[2] >= n[2]) {
                        outer[i] = 1;
                    } else {
                        size_t const at = fill_place(n, u[0], u[1], u[2]);
                        if (wide[at] && !held[at]) outer[i] = 1;
                        if (held[at] && !s->in[at]) inner[i] = 1;
                    }
                }
    to_outer = fill_steps(walls, outer, n);
    to_inner = fill_steps(walls, inner, n);
    for (size_t i = 0; i < s->count; i++) walls[i] = to_inner[i] < to_outer[i];
    free(to_inner);
    free(to_outer);
    free(inner);
    free(outer);
    return walls;
}

typedef struct flood_counts {
    uint64_t held, rim, refused, leaks; /* voxels, voxels, floods, voxels */
} flood_counts;

static void assert_flood_is_oracle(const bvx_lattice *l, const fill_scene *s, int32_t gaps,
                                   flood_counts *seen)
{
    int32_t const *const n = s->n;
    uint8_t *const wide = open_for_cubes(s->open, n, gaps);
    uint8_t *const near = reach(s->open, n);
    uint8_t *const far = reach(wide, n);
    uint8_t *const held = maker_grow(NULL, s->count), *rim;
    uint64_t all = 0, leaks = 0;
    bvx_solid_report r;
    bvx_grid g;
    bvx_status const status = fill_lattice(l, BVX_FILL_FLOOD, gaps, &g, &r);

    for (size_t i = 0; i < s->count; i++) {
        held[i] = (s->open[i] && !near[i]) || (wide[i] && !far[i]);
        all += held[i];
        leaks += wide[i] && far[i] && s->sure[i] && s->in[i];
    }
    rim = rim_of(s, wide, held);
    if (all == 0 && leaks != 0) {
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, status);
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "close gaps of more than"));
        TEST_ASSERT_NULL(g.words);
        seen->refused++;
    } else if (status != BVX_OK) {
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, status);
        TEST_ASSERT_EQUAL_UINT64(0, all);
        TEST_ASSERT_FALSE(s->one_way);
    } else {
        if (s->one_way) TEST_ASSERT_EQUAL_UINT64(leaks, r.leaks);
        else TEST_ASSERT_TRUE(r.leaks >= leaks);
        for (int32_t z = 0; z < n[2]; z++)
            for (int32_t y = 0; y < n[1]; y++)
                for (int32_t x = 0; x < n[0]; x++) {
                    size_t const i = fill_place(n, x, y, z);
                    TEST_ASSERT_EQUAL_INT(held[i] || (!wide[i] && s->in[i]) || rim[i],
                                          bvx_grid_get(&g, x, y, z));
                    seen->rim += rim[i];
                }
        seen->held += all;
        seen->leaks += leaks;
    }
    bvx_grid_free(ctx, &g);
    free(rim);
    free(held);
    free(far);
    free(near);
    free(wide);
}

static void test_bodies_and_soups(void)
{
    flood_counts seen = {0, 0, 0, 0};

    for (int32_t trial = 0; trial < (quick ? 12 : 60); trial++) {
        bvx_lattice const l = lattice_of(shapes[trial % SHAPES][0], shapes[trial % SHAPES][1],
                                         shapes[trial % SHAPES][2]);
        fill_scene s;
        if (trial % 6 == 5) make_random(trial % KINDS, 30, l.dims, 16);
        else make_bodies(trial, &l);
        s = open_scene(&l);
        for (int32_t gaps = 0; gaps < 6; gaps += 1 + trial % 2) assert_flood_is_oracle(&l, &s, gaps, &seen);
        close_scene(&s);
    }
    TEST_ASSERT_TRUE(seen.held > 1000 && seen.rim > 100 && seen.refused > 0 && seen.leaks > 100);
}

/* Wide gaps, so that rows of several words move by more than a word. */
static void test_gaps_wider_than_a_word(void)
{
    bvx_lattice const l = lattice_of(190, 3, 4);
    flood_counts seen = {0, 0, 0, 0};
    fill_scene s;

    maker_clear(&mesh);
    make_random(TINY, 3, l.dims, 16);
    s = open_scene(&l);
    for (int32_t gaps = 60; gaps < 140; gaps += quick ? 17 : 3) assert_flood_is_oracle(&l, &s, gaps, &seen);
    close_scene(&s);
}

/* A box with a cavity: regions keep it, flood fills it to its walls, also behind a wall thinner than a
 * voxel. */
static void test_cavities(void)
{
    bvx_lattice const l = lattice_of(30, 30, 30);
    double const low[3] = {3, 3, 3}, high[3] = {27, 27, 27}, centre[3] = {15, 15, 15}, radius[3] = {8, 8, 8};
    double const inner_low[3] = {3.125, 8, 8}, inner_high[3] = {20, 20, 20};

    for (int thin = 0; thin < 2; thin++) {
        bvx_solid_report r;
        bvx_grid flood, regions, parity;
        maker_clear(&mesh);
        maker_box(&mesh, low, high);
        if (thin) maker_box(&mesh, inner_low, inner_high);
        else maker_star(&mesh, &seed, centre, radius, 0.1, 8, 12, 65536);
        parity = solid_of(&l, BVX_FILL_PARITY);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_lattice(&l, BVX_FILL_REGIONS, 0, &regions, &r));
        assert_same_bits(&parity, &regions, "regions");
        TEST_ASSERT_EQUAL_UINT64(3, r.regions);
        TEST_ASSERT_EQUAL_UINT64(0, r.mixed_regions);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_lattice(&l, BVX_FILL_FLOOD, 0, &flood, &r));
        TEST_ASSERT_EQUAL_UINT64(0, r.leaks);
        TEST_ASSERT_EQUAL_INT(0, bvx_grid_get(&parity, 15, 15, 15));
        for (int32_t z = 0; z < 30; z++)
            for (int32_t y = 0; y < 30; y++)
                for (int32_t x = 0; x < 30; x++) {
                    int const in = x >= 3 && x < 27 && y >= 3 && y < 27 && z >= 3 && z < 27;
                    TEST_ASSERT_EQUAL_INT(in, bvx_grid_get(&flood, x, y, z));
                }
        bvx_grid_free(ctx, &flood);
        bvx_grid_free(ctx, &regions);
        bvx_grid_free(ctx, &parity);
    }
}

/* Closed meshes whose outside the flood reaches everywhere: flood is parity. */
static void test_closed_meshes_are_their_parity(void)
{
    for (int32_t trial = 0; trial < (quick ? 6 : 40); trial++) {
        bvx_lattice const l = lattice_of(70, 40, 41);
        double const centre[3] = {35, 20, 20.5}, radius[3] = {26, 14, 15};
        bvx_grid parity, flood;
        bvx_solid_report r;
        maker_clear(&mesh);
        maker_star(&mesh, &seed, centre, radius, 0.3, 4 + trial % 5, 9, trial % 3 == 0 ? 2 : 65536);
        parity = solid_of(&l, BVX_FILL_PARITY);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_lattice(&l, BVX_FILL_FLOOD, 0, &flood, &r));
        assert_same_bits(&parity, &flood, "flood");
        TEST_ASSERT_EQUAL_UINT64(0, r.leaks);
        bvx_grid_free(ctx, &flood);
        bvx_grid_free(ctx, &parity);
    }
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
    /* the lid's squares over 9..12 by 9..12; their neighbours keep 5 - 2 open */
    for (size_t i = mesh.triangles; i-- > 0;) {
        double m[3] = {0, 0, 0};
        for (int k = 0; k < 9; k++)
            m[k % 3] += mesh.p[3 * (size_t)mesh.t[3 * i + (size_t)(k / 3)] + (size_t)(k % 3)] / 3;
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
        o = (bvx_voxelize_options){.struct_size = sizeof o};
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
        o = (bvx_voxelize_options){.struct_size = sizeof o};
        switch (i) {
        case 0: o.close_gaps = 1; break;
        case 1:
            o.fill = BVX_FILL_FLOOD;
            o.close_gaps = -1;
            break;
        case 2:
            o.fill = BVX_FILL_FLOOD;
            o.close_gaps = 65536;
            break;
        case 3: o.add_shell = 2; break;
        case 4: o.add_shell = -1; break;
        case 5: o.up = BVX_UP_Y; break;
        case 6:
            o.fill = BVX_FILL_BELOW;
            o.up = 3;
            break;
        case 7:
            o.fill = BVX_FILL_BELOW;
            o.has_base = 1;
            o.base = (double)NAN;
            break;
        case 8: o.has_base = 1; break;
        case 9: o.second = &view; break;
        case 10:
            o.fill = BVX_FILL_BELOW;
            o.add_shell = 1;
            break;
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
            bvx_context *const c = suite_context(threads[i], BVX_CPU_BEST);
            bvx_mesh_view const view = maker_view(&mesh);
            bvx_voxelize_options o = {.struct_size = sizeof o};
            bvx_grid g = {0};
            bvx_status now;
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

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_bodies_and_soups);
    RUN_TEST(test_gaps_wider_than_a_word);
    RUN_TEST(test_cavities);
    RUN_TEST(test_closed_meshes_are_their_parity);
    RUN_TEST(test_hole_in_a_lid);
    RUN_TEST(test_refusals);
    RUN_TEST(test_threads_change_nothing);
    return UNITY_END();
}
