/* test_regions.c - the rule regions against floods and votes voxel by voxel; what a hole joins, what a hole
 * narrower than a voxel does not; and what may not matter. */
#include "fill_support.h"
#include "fill/fills.h"

typedef struct region_counts {
    uint64_t mixed, unknown, outvoted; /* regions that have both, that have none; voxels that changed sides */
} region_counts;

/* Exact where triangles run one way; else a region may hold sure centres that the oracle does not know. */
static void assert_regions_are_oracle(const bvx_lattice *l, region_counts *seen)
{
    fill_scene s = open_scene(l);
    int32_t const *const n = s.n;
    int32_t *const label = maker_grow(NULL, s.count * sizeof *label);
    int32_t const regions = fill_label(s.open, n, 6, label);
    uint8_t *const sides = maker_grow(NULL, (size_t)regions + 1); /* 1 inside, 2 outside */
    /* 1 some are set, 2 some are not, 4 one changed sides */
    uint8_t *const set = maker_grow(NULL, (size_t)regions + 1);
    uint64_t mixed_regions = 0, mixed_voxels = 0;
    bvx_solid_report r;
    bvx_grid g;

    memset(sides, 0, (size_t)regions + 1);
    memset(set, 0, (size_t)regions + 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_lattice(l, BVX_FILL_REGIONS, 0, &g, &r));
    TEST_ASSERT_EQUAL_UINT64((uint64_t)regions, r.regions);
    for (size_t i = 0; i < s.count; i++)
        if (s.open[i] && s.sure[i]) sides[label[i]] |= s.in[i] ? 1 : 2;
    for (int32_t z = 0; z < n[2]; z++)
        for (int32_t y = 0; y < n[1]; y++)
            for (int32_t x = 0; x < n[0]; x++) {
                size_t const i = fill_place(n, x, y, z);
                int const got = bvx_grid_get(&g, x, y, z);
                if (!s.open[i]) {
                    TEST_ASSERT_EQUAL_INT(s.in[i], got);
                    continue;
                }
                set[label[i]] |= (uint8_t)((got ? 1 : 2) | (got != s.in[i] ? 4 : 0));
                mixed_voxels += sides[label[i]] % 3 == 0;
                seen->outvoted += got != s.in[i];
            }
    for (int32_t k = 0; k < regions; k++) {
        mixed_regions += sides[k] % 3 == 0;
        seen->mixed += sides[k] == 3;
        seen->unknown += s.one_way && sides[k] == 0;
        /* own votes */
        if (sides[k] == 3 || (s.one_way && sides[k] == 0)) TEST_ASSERT_EQUAL_INT(0, set[k] & 4);
        else if (s.one_way) TEST_ASSERT_EQUAL_INT(sides[k], set[k] & 3); /* one side as a whole */
        else if (set[k] & 4)
            TEST_ASSERT_TRUE((set[k] & 3) != 3 && (sides[k] == 0 || sides[k] == (set[k] & 3)));
    }
    if (s.one_way) {
        TEST_ASSERT_EQUAL_UINT64(mixed_regions, r.mixed_regions);
        TEST_ASSERT_EQUAL_UINT64(mixed_voxels, r.mixed_voxels);
    }
    bvx_grid_free(ctx, &g);
    free(set);
    free(sides);
    free(label);
    close_scene(&s);
}

static bvx_status vote_over(const bvx_mesh_view *view, const bvx_lattice *l, int clear, bvx_grid *vote,
                            bvx_grid *sure)
{
    bvx_solid_report unused = {0};
    bvxi_solid_job job;
    bvx_status const status = bvxi_solid_open(ctx, "test", view, l, &job);

    if (status != BVX_OK) return status;
    return bvxi_vote(bvxi_solid_step(ctx, &job, 0, 1), &job, clear, vote, sure->words, &unused);
}

/* The set of sure centres itself, off the surface. */
static void test_sure_centres_are_known_one_by_one(void)
{
    uint64_t by_angle = 0, unsure = 0;

    for (int32_t trial = 0; trial < (quick ? 6 : 24); trial++) {
        bvx_lattice const l = lattice_of(shapes[trial % SHAPES][0], shapes[trial % SHAPES][1],
                                         shapes[trial % SHAPES][2]);
        double const centre[3] = {0.5 * l.dims[0], 0.5 * l.dims[1], 0.5 * l.dims[2]};
        double const radius[3] = {0.4 * l.dims[0], 0.4 * l.dims[1], 0.4 * l.dims[2]};
        bvx_mesh_view view;
        bvx_grid sure = {0}, vote = {0};
        fill_scene s;
        maker_clear(&mesh);
        maker_star(&mesh, &seed, centre, radius, 0.2, 5, 7, 65536);
        for (int32_t i = 0; i < 4 + trial; i++)
            maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
        view = maker_view(&mesh);
        s = open_scene(&l);
        TEST_ASSERT_TRUE(s.one_way);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, NULL, &vote));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, NULL, &sure));
        for (int clear = 0; clear < 2; clear++) {
            int64_t *const q = snapped(&l);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, BVXI_SCOPE(ctx, vote_over(&view, &l, clear, &vote, &sure)));
            assert_same_bits(&s.vote, &vote, "vote");
            for (int32_t z = 0; z < s.n[2]; z++)
                for (int32_t y = 0; y < s.n[1]; y++)
                    for (int32_t x = 0; x < s.n[0]; x++) {
                        size_t const i = fill_place(s.n, x, y, z);
                        int64_t const c[3] = {oracle_centre(x, l.fraction_bits),
                                              oracle_centre(y, l.fraction_bits),
                                              oracle_centre(z, l.fraction_bits)};
                        int const by_rows = s.open[i] ? is_sure_centre(&l, q, c, 0) : 0;
                        if (!s.open[i]) continue;
                        TEST_ASSERT_EQUAL_INT(clear ? s.sure[i] : by_rows, bvx_grid_get(&sure, x, y, z));
                        by_angle += s.sure[i] && !by_rows;
                        unsure += !s.sure[i];
                    }
            free(q);
        }
        bvx_grid_free(ctx, &sure);
        bvx_grid_free(ctx, &vote);
        close_scene(&s);
    }
    TEST_ASSERT_TRUE(by_angle > 1000 && unsure > 1000);
}

static void test_bodies_and_soups(void)
{
    region_counts seen = {0, 0, 0};

    for (int32_t trial = 0; trial < (quick ? 12 : 60); trial++) {
        bvx_lattice const l = lattice_of(shapes[trial % SHAPES][0], shapes[trial % SHAPES][1],
                                         shapes[trial % SHAPES][2]);
        if (trial % 6 == 5) make_random(trial % KINDS, 30, l.dims, 16);
        else make_bodies(trial, &l);
        assert_regions_are_oracle(&l, &seen);
    }
    TEST_ASSERT_TRUE(seen.mixed > (quick ? 0 : 5) && (quick || seen.unknown > 0));
}

/* Little triangles cut out of large ones: rows through them do not balance, and no path leads through. */
static void pierce(size_t triangle, double size)
{
    uint32_t v[3], w[3];
    double m[3] = {0, 0, 0}, far = 0, part;

    for (int k = 0; k < 3; k++) v[k] = mesh.t[3 * triangle + (size_t)k];
    for (int i = 0; i < 9; i++) m[i % 3] += mesh.p[3 * (size_t)v[i / 3] + (size_t)(i % 3)] / 3;
    for (int i = 0; i < 9; i++) {
        double const d = fabs(mesh.p[3 * (size_t)v[i / 3] + (size_t)(i % 3)] - m[i % 3]);
        far = d > far ? d : far;
    }
    part = size < 0.5 * far ? size / far : 0.5;
    for (int k = 0; k < 3; k++) {
        const double *const p = &mesh.p[3 * (size_t)v[k]];
        w[k] = maker_vertex(&mesh, m[0] + part * (p[0] - m[0]), m[1] + part * (p[1] - m[1]),
                            m[2] + part * (p[2] - m[2]));
    }
    for (int k = 0; k < 3; k++) maker_quad(&mesh, v[k], v[(k + 1) % 3], w[(k + 1) % 3], w[k], 0);
    maker_remove(&mesh, triangle);
}

/* Rows through holes of half a voxel are wrong on one side of them; regions are those of the closed mesh off
 * the surface. (On it a centre in a hole may lie on either side of what is gone.) */
static void test_holes_narrower_than_a_voxel(void)
{
    region_counts seen = {0, 0, 0};
    uint64_t unbalanced = 0;

    for (int32_t trial = 0; trial < (quick ? 6 : 24); trial++) {
        bvx_lattice const l = lattice_of(44, 40, 41);
        double const centre[3] = {22, 20, 20.5};
        double const radius[3] = {16, 14, 15};
        double const low[3] = {1.5, 2.25, 3};
        double const high[3] = {42.25, 37, 38.5};
        bvx_grid closed, regions, surface;
        bvx_solid_report r;
        maker_clear(&mesh);
        if (trial % 2) maker_box(&mesh, low, high); /* the star is a cavity then */
        maker_star(&mesh, &seed, centre, radius, 0.25, 4, 7, 65536);
        closed = solid_of(&l, BVX_FILL_PARITY);
        for (size_t i = mesh.triangles; i-- > 0;) pierce(i, 0.25);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_lattice(&l, BVX_FILL_REGIONS, 0, &regions, &r));
        surface = surface_of(&l);
        for (int32_t z = 0; z < 41; z++)
            for (int32_t y = 0; y < 40; y++)
                for (int32_t x = 0; x < 44; x++)
                    if (!bvx_grid_get(&surface, x, y, z))
                        TEST_ASSERT_EQUAL_INT(bvx_grid_get(&closed, x, y, z),
                                              bvx_grid_get(&regions, x, y, z));
        TEST_ASSERT_EQUAL_UINT64(trial % 2 ? 3 : 2, r.regions);
        TEST_ASSERT_EQUAL_UINT64(0, r.mixed_regions);
        unbalanced += r.unbalanced_rows;
        if (trial < 2) assert_regions_are_oracle(&l, &seen);
        bvx_grid_free(ctx, &surface);
        bvx_grid_free(ctx, &regions);
        bvx_grid_free(ctx, &closed);
    }
    TEST_ASSERT_TRUE(unbalanced > 10);
}

/* A box without one of its sides, square to each axis in turn, at both ends: no row along that axis balances,
 * still the box comes out whole, and the one region that is left is reported. */
static void test_side_missing_square_to_an_axis(void)
{
    bvx_lattice const l = lattice_of(24, 22, 23);
    double const low[3] = {4, 3, 4}, high[3] = {20, 19, 20};

    for (int side = 0; side < 6; side++) {
        bvx_solid_report r;
        bvx_grid g, closed;
        bvx_grid shell = {0};
        maker_clear(&mesh);
        maker_box(&mesh, low, high);
        closed = solid_of(&l, BVX_FILL_PARITY);
        for (size_t i = mesh.triangles; i-- > 0;) {
            double m = 0;
            for (int k = 0; k < 3; k++)
                m += mesh.p[3 * (size_t)mesh.t[3 * i + (size_t)k] + (size_t)(side / 2)] / 3;
            if (fabs(m - (side % 2 ? high : low)[side / 2]) < 1e-9) maker_remove(&mesh, i);
        }
        TEST_ASSERT_EQUAL_UINT64(10, mesh.triangles);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_lattice(&l, BVX_FILL_REGIONS, 0, &g, &r));
        assert_same_bits(&closed, &g, "box");
        TEST_ASSERT_EQUAL_UINT64(16 * 16, r.unbalanced_rows);
        TEST_ASSERT_EQUAL_UINT64(1, r.regions);
        TEST_ASSERT_EQUAL_UINT64(1, r.mixed_regions);
        bvx_mesh_view const view = maker_view(&mesh);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(ctx, &view, &l, NULL, &shell));
        TEST_ASSERT_EQUAL_UINT64(24 * 22 * 23 - set_voxels(&shell), r.mixed_voxels);
        bvx_grid_free(ctx, &shell);
        bvx_grid_free(ctx, &g);
        bvx_grid_free(ctx, &closed);
    }
}

/* Half of a cube's sides twice, so that they cancel: no row balances, and
 * its middle sees half of all directions. */
static void test_region_without_a_sure_centre(void)
{
    bvx_lattice const l = lattice_of(5, 5, 5);
    double const low[3] = {1.25, 1.25, 1.25}, high[3] = {3.75, 3.75, 3.75};
    bvx_solid_report r;
    bvx_grid g, vote;

    maker_box(&mesh, low, high);
    for (size_t i = 0, n = mesh.triangles; i < n; i++)
        for (int a = 0; a < 3; a++) {
            double m = 0;
            for (int k = 0; k < 3; k++) m += mesh.p[3 * (size_t)mesh.t[3 * i + (size_t)k] + (size_t)a] / 3;
            if (fabs(m - 1.25) < 1e-9) maker_duplicate(&mesh, i);
        }
    TEST_ASSERT_EQUAL_UINT64(18, mesh.triangles);
    vote = solid_of(&l, BVX_FILL_VOTE);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_lattice(&l, BVX_FILL_REGIONS, 0, &g, &r));
    assert_same_bits(&vote, &g, "own vote");
    TEST_ASSERT_EQUAL_UINT64(2, r.regions);
    TEST_ASSERT_EQUAL_UINT64(1, r.mixed_regions);
    TEST_ASSERT_EQUAL_UINT64(1, r.mixed_voxels);
    bvx_grid_free(ctx, &g);
    bvx_grid_free(ctx, &vote);
}

/* Shells one in another: solid, cavity, solid. Regions are their parity, each counted. */
static void test_nested_shells_keep_their_cavities(void)
{
    for (int32_t trial = 0; trial < (quick ? 4 : 20); trial++) {
        bvx_lattice const l = lattice_of(66, 40, 41);
        int32_t const shells = 1 + trial % 4;
        bvx_grid parity, regions;
        bvx_solid_report r;
        maker_clear(&mesh);
        for (int32_t k = 0; k < shells; k++) {
            double const centre[3] = {33, 20, 20.5}, radius[3] = {30 - 7 * k, 18 - 4.5 * k, 18.5 - 4.5 * k};
            maker_star(&mesh, &seed, centre, radius, 0.02, 8, 13, trial % 2 ? 2 : 65536);
        }
        for (int32_t k = 0; k < trial; k++) {
            size_t const i = (size_t)maker_below(&seed, (int32_t)mesh.triangles);
            maker_flip(&mesh, i, i + 1);
        }
        parity = solid_of(&l, BVX_FILL_PARITY);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_lattice(&l, BVX_FILL_REGIONS, 0, &regions, &r));
        assert_same_bits(&parity, &regions, "regions");
        TEST_ASSERT_EQUAL_UINT64((uint64_t)shells + 1, r.regions);
        TEST_ASSERT_EQUAL_UINT64(0, r.mixed_regions);
        for (int32_t k = 0; k < shells; k++) /* half way between two shells along x */
            TEST_ASSERT_EQUAL_INT(k % 2 == 0,
                                  bvx_grid_get(&regions, 33 + 27 - 7 * k - (k == 3 ? 2 : 0), 20, 20));
        bvx_grid_free(ctx, &regions);
        bvx_grid_free(ctx, &parity);
    }
}

/* Bodies that leave the lattice: a region at its end is decided by what lies beyond as well. */
static void test_bodies_across_the_lattice_end(void)
{
    for (int32_t trial = 0; trial < (quick ? 6 : 48); trial++) {
        bvx_lattice const l = lattice_of(shapes[trial % SHAPES][0], shapes[trial % SHAPES][1],
                                         shapes[trial % SHAPES][2]);
        bvx_grid parity, vote, regions;
        bvx_solid_report r;
        maker_clear(&mesh);
        for (int32_t k = 0; k < 1 + trial % 3; k++) {
            double centre[3], radius[3];
            for (int a = 0; a < 3; a++) {
                centre[a] = maker_between(&seed, 0, l.dims[a], 16);
                radius[a] = 0.3 * l.dims[a] + maker_below(&seed, l.dims[a] + 1);
            }
            maker_star(&mesh, &seed, centre, radius, 0.4, 6, 9, trial % 2 ? 2 : 65536);
        }
        parity = solid_of(&l, BVX_FILL_PARITY);
        vote = solid_of(&l, BVX_FILL_VOTE);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_lattice(&l, BVX_FILL_REGIONS, 0, &regions, &r));
        assert_same_bits(&parity, &vote, "vote");
        assert_same_bits(&parity, &regions, "regions");
        TEST_ASSERT_EQUAL_UINT64(0, r.mixed_regions);
        bvx_grid_free(ctx, &regions);
        bvx_grid_free(ctx, &vote);
        bvx_grid_free(ctx, &parity);
    }
}

static void test_bad_inputs(void)
{
    bvx_lattice const l = lattice_of(10, 10, 10);
    double const low[3] = {2, 2, 2}, high[3] = {7, 7, 7};
    bvx_window const part = {{1, 0, 0}, {9, 10, 10}};
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_mesh_view view;
    bvx_grid g = {0};
    uint32_t kept;

    maker_box(&mesh, low, high);
    view = maker_view(&mesh);
    o.fill = BVX_FILL_REGIONS;
    o.window = part;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &view, &l, &o, &g));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "regions needs the whole lattice"));
    memset(&o.window, 0, sizeof o.window);
    o.close_gaps = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &view, &l, &o, &g));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "close_gaps requires the rule flood"));
    o.close_gaps = 0;
    view.triangle_count = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY, bvx_voxelize_solid(ctx, &view, &l, &o, &g));
    view = maker_view(&mesh);
    kept = mesh.t[7];
    mesh.t[7] = 8;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_voxelize_solid(ctx, &view, &l, &o, &g));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "triangle 2"));
    mesh.t[7] = kept;
    mesh.p[4] = (double)INFINITY;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_voxelize_solid(ctx, &view, &l, &o, &g));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "vertex 1"));
    TEST_ASSERT_NULL(g.words);
}

static void test_threads_and_code_paths_change_nothing(void)
{
    static const int32_t threads[] = {1, 2, 8};

    for (int32_t trial = 0; trial < (quick ? 3 : 6); trial++) {
        bvx_lattice const l = lattice_of(140, 33, 30);
        bvx_grid first;
        bvx_solid_report r, s;
        make_bodies(trial, &l);
        if (trial == 4) make_random(MIXED, 40, l.dims, 16);
        first = solid_by(ctx, &l, NULL, BVX_FILL_REGIONS, &r);
        for (int i = 0; i < 6; i++) {
            bvx_context *const c = suite_context(threads[i % 3], i < 3 ? BVX_CPU_BEST : BVX_CPU_PORTABLE);
            bvx_grid g = solid_by(c, &l, NULL, BVX_FILL_REGIONS, &s);
            assert_same_bits(&first, &g, "threads");
            TEST_ASSERT_EQUAL_MEMORY(&r, &s, sizeof r);
            bvx_grid_free(c, &g);
            bvx_context_destroy(c);
        }
        bvx_grid_free(ctx, &first);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_sure_centres_are_known_one_by_one);
    RUN_TEST(test_bodies_and_soups);
    RUN_TEST(test_holes_narrower_than_a_voxel);
    RUN_TEST(test_side_missing_square_to_an_axis);
    RUN_TEST(test_region_without_a_sure_centre);
    RUN_TEST(test_nested_shells_keep_their_cavities);
    RUN_TEST(test_bodies_across_the_lattice_end);
    RUN_TEST(test_bad_inputs);
    RUN_TEST(test_threads_and_code_paths_change_nothing);
    return UNITY_END();
}
