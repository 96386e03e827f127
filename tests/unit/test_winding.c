/* test_winding.c - the rule winding against the sum of all triangles' angles, voxel by voxel; bricks against
 * single centres; and what may not change it. */
#include "solid_support.h"
#include "tools/fill_oracle.h"
#include "winding/turns.h"
#include "winding/holes.h"

static const int32_t shapes[][3] = {{65, 9, 8},  {9, 66, 7},  {7, 8, 130},  {1, 12, 12},
                                    {12, 1, 11}, {13, 12, 1}, {20, 18, 22}, {34, 33, 35}};
enum { SHAPES = sizeof shapes / sizeof shapes[0] };

typedef struct wind_counts {
    uint64_t asked, inside, halfway; /* halfway: 1/4 .. 3/4 from a whole number */
} wind_counts;

/* Inside is where the triangles' angles sum to more than a half; centres in triangles or within 1e-7 of a
 * half may be either. every: of so many centres one is asked. halves: as in test_vote.c. */
static void assert_is_sum_of_angles(const bvx_lattice *l, const bvx_window *window, int halves, int32_t every,
                                    wind_counts *counts)
{
    int64_t *const q = snapped(l);
    bvx_solid_report r;
    bvx_grid g = solid_by(ctx, l, window, BVX_FILL_WINDING, &r);
    double scale[3];
    char text[120];
    int32_t left = 1;

    for (int a = 0; a < 3; a++) scale[a] = l->spacing[a] / (1 << l->fraction_bits);
    for (int32_t z = 0; z < g.size[2]; z++)
        for (int32_t y = 0; y < g.size[1]; y++)
            for (int32_t x = 0; x < g.words_per_row * 64; x++) {
                int64_t const c[3] = {oracle_centre(g.low[0] + x, l->fraction_bits),
                                      oracle_centre(g.low[1] + y, l->fraction_bits),
                                      oracle_centre(g.low[2] + z, l->fraction_bits)};
                double turns;
                int clear;
                if (x >= g.size[0]) {
                    TEST_ASSERT_EQUAL_INT(0, bvx_grid_get(&g, x, y, z));
                    continue;
                }
                if (--left > 0) continue;
                left = every == 1 ? 1 : 1 + maker_below(&seed, 2 * every);
                turns = fill_turns_at(q, mesh.t, mesh.triangles, c, halves ? fill_moved : fill_unmoved, scale,
                                      &clear);
                counts->asked++;
                counts->inside += fabs(turns) > 0.5;
                counts->halfway += fabs(turns - floor(turns + 0.5)) > 0.25;
                if ((!clear && !halves) || fabs(fabs(turns) - 0.5) < (halves ? 0.01 : 1e-7)) continue;
                if ((fabs(turns) > 0.5) == bvx_grid_get(&g, x, y, z)) continue;
                snprintf(text, sizeof text, "voxel (%d, %d, %d) of a %d x %d x %d window is %d (%g turns)",
                         (int)x, (int)y, (int)z, (int)g.size[0], (int)g.size[1], (int)g.size[2],
                         bvx_grid_get(&g, x, y, z), turns);
                TEST_FAIL_MESSAGE(text);
            }
    bvx_grid_free(ctx, &g);
    free(q);
}

static void make_stars(int32_t count, const bvx_lattice *l, int32_t steps, int32_t rings, int32_t remove)
{
    for (int32_t n = 0; n < count; n++) {
        double centre[3], radius[3];
        int32_t around;
        for (int a = 0; a < 3; a++) {
            centre[a] = maker_step(maker_between(&seed, 0.3 * l->dims[a], 0.7 * l->dims[a], 1000), steps);
            radius[a] = 0.2 * l->dims[a] + maker_below(&seed, l->dims[a] / 3 + 1);
        }
        around = rings + maker_below(&seed, 4);
        maker_star(&mesh, &seed, centre, radius, 0.4, around, rings + 1 + maker_below(&seed, 5), steps);
    }
    for (int32_t i = 0; i < remove; i++)
        maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
}

/* Triangles whose first corner lies near one of some places. */
static void cut_holes(int32_t count, double size)
{
    for (int32_t n = 0; n < count; n++) {
        const double *const at = mesh.p + 3 * (size_t)maker_below(&seed, (int32_t)mesh.vertices);
        double const place[3] = {at[0], at[1], at[2]};
        for (size_t i = mesh.triangles; i-- > 0;) {
            const double *const p = mesh.p + 3 * (size_t)mesh.t[3 * i];
            if (fabs(p[0] - place[0]) < size && fabs(p[1] - place[1]) < size && fabs(p[2] - place[2]) < size)
                maker_remove(&mesh, i);
        }
    }
}

/* Bodies, some inside out, in each other or twice there, with triangles missing. */
static void make_bodies(int32_t trial, const bvx_lattice *l)
{
    size_t first;

    maker_clear(&mesh);
    make_stars(1 + trial % 3, l, trial % 4 == 0 ? 2 : 65536, 4, 0);
    if (trial % 2) maker_flip(&mesh, 0, mesh.triangles / 2);
    if (trial % 5 == 1) /* all of it twice */
        for (size_t i = 0, n = mesh.triangles; i < n; i++) maker_duplicate(&mesh, i);
    first = mesh.triangles;
    for (size_t i = 0; i < first / 10; i++)
        maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
}

static void test_bodies_with_holes(void)
{
    wind_counts counts = {0, 0, 0};

    for (int32_t trial = 0; trial < (quick ? 2 : 40); trial++) {
        bvx_lattice l = lattice_of(shapes[trial % SHAPES][0], shapes[trial % SHAPES][1],
                                   shapes[trial % SHAPES][2]);
        make_bodies(trial, &l);
        assert_is_sum_of_angles(&l, NULL, 0, trial % SHAPES == 7 ? 8 : 1, &counts);
        for (size_t i = 0; i < mesh.vertices; i++) mesh.p[3 * i + (size_t)(trial % 3)] *= 2.75;
        l.spacing[trial % 3] = 2.75;
        assert_is_sum_of_angles(&l, NULL, 0, 2, &counts);
    }
    TEST_ASSERT_TRUE(counts.inside > 1000 && counts.halfway > 1000 && counts.inside < counts.asked);
}

/* Many little triangles, a few holes of dozens of edges: near and far parts, bricks of all sizes. */
static void test_fine_bodies_with_wide_holes(void)
{
    wind_counts counts = {0, 0, 0};

    for (int32_t trial = 0; trial < (quick ? 1 : 5); trial++) {
        bvx_lattice const l = lattice_of(90, 70 + trial, 80);
        maker_clear(&mesh);
        make_stars(1 + trial % 2, &l, 65536, 24, 0);
        cut_holes(3, 6 + 2 * trial);
        if (trial % 3 == 2) maker_flip(&mesh, 0, mesh.triangles);
        assert_is_sum_of_angles(&l, NULL, 0, 64, &counts);
    }
    TEST_ASSERT_TRUE(counts.inside > 200 && counts.halfway > 10);
}

static void test_triangles_that_have_nothing_to_do_with_each_other(void)
{
    wind_counts counts = {0, 0, 0};

    for (int s = 0; s < SHAPES; s++)
        for (int32_t kind = 0; kind < KINDS; kind++)
            for (int32_t trial = 0; trial < (quick ? 1 : 3); trial++) {
                bvx_lattice const l = lattice_of(shapes[s][0], shapes[s][1], shapes[s][2]);
                make_random(kind, 5 << trial, l.dims, kind == HUGE ? 16 : 12);
                assert_is_sum_of_angles(&l, NULL, 0, s == 7 ? 8 : 1, &counts);
            }
    TEST_ASSERT_TRUE(counts.inside > 100 && counts.halfway > 100);
}

/* Corners on centres and on voxels' corners: which side of a triangle a
 * centre in it lies on is as everywhere. */
static void test_triangles_through_centres(void)
{
    wind_counts counts = {0, 0, 0};

    for (int32_t trial = 0; trial < (quick ? 25 : 400); trial++) {
        bvx_lattice const l = lattice_of(9, 8, 10);
        maker_clear(&mesh);
        make_stars(1 + trial % 3, &l, 2, 3, 4 + trial % 10);
        assert_is_sum_of_angles(&l, NULL, 1, 1, &counts);
    }
    TEST_ASSERT_TRUE(counts.halfway > (quick ? 50 : 1000));
}

/* Without its lid a box has half a turn in the lid's plane exactly, which
 * is outside; a lid on that leaves a slit is no half. */
static void test_open_box_by_hand(void)
{
    for (int side = 0; side < 2; side++) {
        bvx_lattice const l = lattice_of(40, 24, 36);
        double const low[3] = {4, 4, side ? 4 : 4.5}, high[3] = {36, 20, side ? 30.5 : 31};
        bvx_solid_report r;
        bvx_grid g, whole;
        maker_clear(&mesh);
        maker_box(&mesh, low, high);
        whole = solid_of(&l, BVX_FILL_NONZERO);
        if (side) mesh.triangles -= 2; /* z = 30.5 */
        else { /* z = 4.5: the two before */ maker_remove(&mesh, 9);
            maker_remove(&mesh, 8);
        }
        g = solid_by(ctx, &l, NULL, BVX_FILL_WINDING, &r);
        for (int32_t z = 0; z < 36; z++)
            for (int32_t y = 0; y < 24; y++)
                for (int32_t x = 0; x < 40; x++) {
                    int const in_plane = z == (side ? 30 : 4);
                    int const in = x >= 4 && x < 36 && y >= 4 && y < 20 && z >= 4 && z <= 30;
                    TEST_ASSERT_EQUAL_INT(in && !in_plane, bvx_grid_get(&g, x, y, z));
                    if (!in_plane) TEST_ASSERT_EQUAL_INT(in, bvx_grid_get(&whole, x, y, z));
                }
        bvx_grid_free(ctx, &whole);
        bvx_grid_free(ctx, &g);
    }
}

/* ---- Closed meshes ---- */

static void test_closed_meshes_are_nonzero(void)
{
    for (int32_t trial = 0; trial < (quick ? 5 : 200); trial++) {
        int32_t const *const n = shapes[trial % SHAPES];
        bvx_lattice const l = lattice_of(n[0], n[1], n[2]);
        bvx_solid_report r, s;
        bvx_grid a, b;
        maker_clear(&mesh);
        make_stars(1 + trial % 4, &l, trial % 3 == 0 ? 1 : trial % 3 == 1 ? 2 : 65536, 4, 0);
        if (trial % 2) maker_flip(&mesh, 0, mesh.triangles);
        if (trial % 5 == 0) /* closed, though four triangles meet at each edge */
            for (size_t i = 0, m = mesh.triangles; i < m; i++) maker_duplicate(&mesh, i);
        if (trial % 7 == 0) /* corners of their own */
            for (size_t i = 0, m = mesh.triangles; i < m; i += 3) {
                uint32_t *const t = mesh.t + 3 * i;
                t[1] = maker_vertex(&mesh, mesh.p[3 * (size_t)t[1]], mesh.p[3 * (size_t)t[1] + 1],
                                    mesh.p[3 * (size_t)t[1] + 2]);
            }
        a = solid_by(ctx, &l, NULL, BVX_FILL_NONZERO, &r);
        b = solid_by(ctx, &l, NULL, BVX_FILL_WINDING, &s);
        assert_same_bits(&a, &b, "closed");
        TEST_ASSERT_EQUAL_INT32(BVX_FILL_WINDING, s.fill);
        s.fill = r.fill;
        TEST_ASSERT_EQUAL_MEMORY(&r, &s, sizeof r);
        bvx_grid_free(ctx, &b);
        bvx_grid_free(ctx, &a);
    }
}

/* A hole far from everything that is looked at changes the way, not the bits. */
static void test_a_far_hole_leaves_the_rest_as_it_is(void)
{
    for (int32_t trial = 0; trial < (quick ? 2 : 30); trial++) {
        bvx_lattice const l = lattice_of(70, 40, 36);
        bvx_solid_report r, s;
        bvx_grid a, b;
        maker_clear(&mesh);
        make_stars(1, &l, 65536, 5, 0);
        if (trial % 2) maker_flip(&mesh, 0, mesh.triangles);
        make_stars(2, &l, 65536, 5, 0);
        a = solid_by(ctx, &l, NULL, BVX_FILL_NONZERO, &r);
        maker_triangle(&mesh, maker_vertex(&mesh, 400, 500, 20), maker_vertex(&mesh, 403, 501, 21),
                       maker_vertex(&mesh, 402, 504, 20));
        b = solid_by(ctx, &l, NULL, BVX_FILL_WINDING, &s);
        assert_same_bits(&a, &b, "far hole");
        TEST_ASSERT_EQUAL_UINT64(r.crossings, s.crossings);
        TEST_ASSERT_EQUAL_UINT64(0, s.unbalanced_rows);
        bvx_grid_free(ctx, &b);
        bvx_grid_free(ctx, &a);
    }
}

/* ---- Four places at once ---- */

/* Angles have the same digits one by one and four at once, also at places
 * in the sheet; and so have the answers. */
static void test_four_angles_are_those_of_each(void)
{
    int32_t asked = 0;

    for (int trial = 0; trial < 20; trial++) {
        bvx_lattice const l = lattice_of(24, 22, 20);
        bvx_mesh_view view;
        bvxi_snapped snap;
        bvxi_holes holes;
        bvxi_sheet sheet;
        maker_clear(&mesh);
        make_stars(1 + trial % 3, &l, 65536, 10, 0);
        cut_holes(1 + trial % 4, 2 + trial % 7);
        view = maker_view(&mesh);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_snap(ctx, "test", &view, &l, &snap));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_holes_open(ctx, &view, &snap, 0, &holes));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_sheet_open(ctx, &holes, &snap, &l, &sheet));
        for (int n = 0; n < 200 && holes.loops > 0; n++, asked++) {
            static const double near[3] = {1e-3, 1e-2, 1e-6};
            int32_t const want_clear = n / 3 % 2;
            bvxi_sheet_answer answer[4];
            int64_t p[4][3];
            double turns[4];
            for (int i = 0; i < 4; i++)
                for (int a = 0; a < 3; a++)
                    p[i][a] =
                        n % 5 == 0
                            ? snap.xyz[3 * (size_t)holes.vertex[maker_below(&seed, (int32_t)holes.points)] +
                                       (size_t)a]
                            : maker_below(&seed, l.dims[a] << l.fraction_bits);
            bvxi_sheet_angles_four(&sheet, (const int64_t(*)[3])p, near[n % 3], turns);
            bvxi_sheet_turns_four(&sheet, (const int64_t(*)[3])p, want_clear, answer);
            for (int i = 0; i < 4; i++) {
                double const alone = bvxi_sheet_angle(&sheet, p[i], near[n % 3]);
                bvxi_sheet_answer const told = bvxi_sheet_turns(&sheet, p[i], want_clear);
                TEST_ASSERT_EQUAL_INT(0, memcmp(&alone, &turns[i], sizeof alone));
                TEST_ASSERT_EQUAL_INT32(told.whole, answer[i].whole);
                TEST_ASSERT_EQUAL_INT32(told.tie, answer[i].tie);
                if (want_clear) TEST_ASSERT_EQUAL_INT32(told.clear, answer[i].clear);
            }
        }
        bvxi_sheet_close(ctx, &sheet);
        bvxi_holes_close(ctx, &holes);
        bvxi_snap_free(ctx, &snap);
    }
    TEST_ASSERT_TRUE(asked >= 2000);
}

/* ---- Bricks ---- */

/* All centres of a block have what they say by themselves. */
static void assert_block_is_its_centres(const bvx_lattice *l, int is_signed)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvxi_snapped snap;
    bvxi_holes holes;
    bvxi_sheet sheet;
    bvxi_turns_block *const b = maker_grow(NULL, sizeof *b);
    int64_t const step = (int64_t)1 << l->fraction_bits;

    memset(b, 0, sizeof *b);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_snap(ctx, "test", &view, l, &snap));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_holes_open(ctx, &view, &snap, !is_signed, &holes));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_sheet_open(ctx, &holes, &snap, l, &sheet));
    b->sheet = &sheet;
    b->ties = maker_below(&seed, 2);
    b->want_clear = maker_below(&seed, 2);
    b->all_open = maker_below(&seed, 2);
    for (int a = 0; a < 3; a++) {
        b->low[a] = maker_below(&seed, l->dims[a]);
        b->size[a] = l->dims[a] - b->low[a] < BVXI_TURNS_SIDE ? l->dims[a] - b->low[a] : BVXI_TURNS_SIDE;
    }
    for (uint32_t i = 0; i < BVXI_TURNS_ROWS; i++)
        b->open[i] = b->all_open ? UINT32_MAX : (uint32_t)maker_random(&seed);
    bvxi_sheet_block(b);
    for (int32_t z = 0; z < b->size[2]; z++)
        for (int32_t y = 0; y < b->size[1]; y++)
            for (int32_t x = 0; x < b->size[0]; x++) {
                int64_t const p[3] = {(b->low[0] + x) * step + step / 2, (b->low[1] + y) * step + step / 2,
                                      (b->low[2] + z) * step + step / 2};
                uint32_t const row = bvxi_turns_row(y, z);
                int32_t const turns = b->turns[row * BVXI_TURNS_SIDE + (uint32_t)x];
                bvxi_sheet_answer a;
                if ((b->open[row] >> x & 1) == 0) continue;
                a = bvxi_sheet_turns(&sheet, p, b->want_clear);
                TEST_ASSERT_EQUAL_INT32(2 * a.whole + (b->ties ? a.tie : 0), turns);
                if (turns != 0) TEST_ASSERT_EQUAL_INT32(1, b->dirty);
                if (b->want_clear) TEST_ASSERT_EQUAL_INT32(a.clear, b->clear[row] >> x & 1);
            }
    bvxi_sheet_close(ctx, &sheet);
    bvxi_holes_close(ctx, &holes);
    bvxi_snap_free(ctx, &snap);
    free(b);
}

static void test_bricks_say_what_their_centres_say(void)
{
    for (int32_t trial = 0; trial < (quick ? 6 : 400); trial++) {
        bvx_lattice l = lattice_of(60, 50, 55);
        maker_clear(&mesh);
        if (trial % 4 == 0)
            make_random(trial / 4 % KINDS == HUGE ? MIXED : trial / 4 % KINDS, 3 + trial % 20, l.dims, 12);
        else if (trial % 4 == 1) make_bodies(trial, &l);
        else {
            make_stars(1, &l, trial % 8 == 2 ? 2 : 65536, 8 + trial % 12, 0);
            cut_holes(1 + trial % 5, 3 + trial % 11);
        }
        if (trial % 3 == 0) {
            l.spacing[trial / 3 % 3] = 3.5;
            for (size_t i = 0; i < mesh.vertices; i++) mesh.p[3 * i + (size_t)(trial / 3 % 3)] *= 3.5;
        }
        assert_block_is_its_centres(&l, trial % 2);
    }
}

/* ---- What may not matter ---- */

static void test_windows_are_cut_out_of_the_whole(void)
{
    for (int32_t trial = 0; trial < (quick ? 2 : 30); trial++) {
        bvx_lattice const l = lattice_of(75, 40, 38);
        bvx_grid whole;
        if (trial % 2) make_bodies(trial, &l);
        else make_random(trial % KINDS, 40, l.dims, 16);
        whole = solid_of(&l, BVX_FILL_WINDING);
        for (int32_t n = 0; n < 8; n++) {
            bvx_window w;
            bvx_grid part;
            for (int a = 0; a < 3; a++) {
                w.size[a] = n == 0 ? 1 : 1 + maker_below(&seed, l.dims[a]);
                w.low[a] = maker_below(&seed, l.dims[a] - w.size[a] + 1);
            }
            part = solid_by(ctx, &l, &w, BVX_FILL_WINDING, NULL);
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

static void test_order_and_all_turned_round_change_nothing(void)
{
    for (int32_t trial = 0; trial < (quick ? 2 : 60); trial++) {
        bvx_lattice const l = lattice_of(40, 30, 34);
        bvx_grid a, b;
        make_bodies(trial, &l);
        a = solid_of(&l, BVX_FILL_WINDING);
        maker_shuffle_triangles(&mesh, &seed);
        maker_shuffle_vertices(&mesh, &seed);
        for (size_t i = 0, n = mesh.triangles; i < n; i += 3) { /* corners of their own at the same places */
            uint32_t *const t = mesh.t + 3 * i;
            t[1] = maker_vertex(&mesh, mesh.p[3 * (size_t)t[1]], mesh.p[3 * (size_t)t[1] + 1],
                                mesh.p[3 * (size_t)t[1] + 2]);
        }
        b = solid_of(&l, BVX_FILL_WINDING);
        assert_same_bits(&a, &b, "order");
        bvx_grid_free(ctx, &b);
        maker_flip(&mesh, 0, mesh.triangles);
        b = solid_of(&l, BVX_FILL_WINDING);
        assert_same_bits(&a, &b, "turned round");
        bvx_grid_free(ctx, &b);
        bvx_grid_free(ctx, &a);
    }
}

/* x, y, z become y, z, x: other rows, other crossings, the same angles. */
static void test_turned_axes_change_nothing(void)
{
    for (int32_t trial = 0; trial < (quick ? 2 : 30); trial++) {
        bvx_lattice const l = lattice_of(40, 33, 36), turned = lattice_of(33, 36, 40);
        bvx_grid a, b;
        make_bodies(4 * trial + 1, &l);
        a = solid_of(&l, BVX_FILL_WINDING);
        for (size_t i = 0; i < mesh.vertices; i++) {
            double const x = mesh.p[3 * i];
            mesh.p[3 * i] = mesh.p[3 * i + 1];
            mesh.p[3 * i + 1] = mesh.p[3 * i + 2];
            mesh.p[3 * i + 2] = x;
        }
        b = solid_of(&turned, BVX_FILL_WINDING);
        for (int32_t z = 0; z < 36; z++)
            for (int32_t y = 0; y < 33; y++)
                for (int32_t x = 0; x < 40; x++)
                    TEST_ASSERT_EQUAL_INT(bvx_grid_get(&a, x, y, z), bvx_grid_get(&b, y, z, x));
        bvx_grid_free(ctx, &b);
        bvx_grid_free(ctx, &a);
    }
}

static void test_threads_and_code_paths_change_nothing(void)
{
    static const int32_t threads[] = {1, 2, 3, 8};

    for (int32_t trial = 0; trial < (quick ? 1 : 4); trial++) {
        bvx_lattice const l = lattice_of(150, 60, 70);
        bvx_grid first;
        bvx_solid_report r, s;
        if (trial == 1) make_random(MIXED, 60, l.dims, 16);
        else make_bodies(trial, &l);
        first = solid_by(ctx, &l, NULL, BVX_FILL_WINDING, &r);
        for (int i = 0; i < 8; i++) {
            bvx_context *const c = suite_context(threads[i % 4], i < 4 ? BVX_CPU_BEST : BVX_CPU_PORTABLE);
            bvx_grid g = solid_by(c, &l, NULL, BVX_FILL_WINDING, &s);
            assert_same_bits(&first, &g, "threads");
            TEST_ASSERT_EQUAL_MEMORY(&r, &s, sizeof r);
            bvx_grid_free(c, &g);
            bvx_context_destroy(c);
        }
        bvx_grid_free(ctx, &first);
    }
}

static void test_unbalanced_rows_are_those_of_signed_sums(void)
{
    bvx_lattice const l = lattice_of(24, 24, 24);
    double const low[3] = {4, 4, 4}, high[3] = {20, 20, 20};
    bvx_solid_report r;
    bvx_grid g;

    maker_clear(&mesh);
    maker_box(&mesh, low, high);
    for (size_t i = 0; i < mesh.triangles; i++) { /* without the wall x = 20 */
        double least = 20;
        for (int k = 0; k < 3; k++)
            if (mesh.p[3 * (size_t)mesh.t[3 * i + (size_t)k]] < least)
                least = mesh.p[3 * (size_t)mesh.t[3 * i + (size_t)k]];
        if (least == 20) maker_remove(&mesh, i--);
    }
    TEST_ASSERT_EQUAL_size_t(10, mesh.triangles);
    g = solid_by(ctx, &l, NULL, BVX_FILL_WINDING, &r);
    TEST_ASSERT_EQUAL_UINT64(16 * 16, r.unbalanced_rows);
    TEST_ASSERT_EQUAL_UINT64(16 * 16, r.crossings);
    TEST_ASSERT_EQUAL_UINT64(16 * 16 * 16, set_voxels(&g));
    bvx_grid_free(ctx, &g);
}

/* ---- Ratios ---- */

static void test_ratios_are_where_the_angle_is_a_half(void)
{
    static const int32_t rules[2] = {BVX_FILL_WINDING, BVX_FILL_VOTE};
    uint64_t told = 0;

    for (int32_t trial = 0; trial < (quick ? 1 : 16); trial++) {
        bvx_lattice const l = lattice_of(40, 38, 36);
        bvx_mesh_view view;
        bvxi_holes holes;
        bvxi_winding *w;
        bvxi_winding_edge edge;
        bvx_grid g, surface = {0};
        int64_t *q;
        double scale[3];
        maker_clear(&mesh);
        make_stars(1, &l, 65536, 12, 0);
        if (trial == 0) {
            view = maker_view(&mesh);
            TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                    bvxi_holes_open_rule(ctx, "test", &view, &l, BVX_FILL_WINDING, &holes));
            TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                    bvxi_winding_open(ctx, "test", &view, &l, BVX_FILL_WINDING, &holes, &w));
            TEST_ASSERT_NULL(w);
            bvxi_holes_close(ctx, &holes);
            bvxi_winding_close(ctx, w);
        }
        cut_holes(2, 8);
        view = maker_view(&mesh);
        q = snapped(&l);
        for (int a = 0; a < 3; a++) scale[a] = l.spacing[a] / (1 << l.fraction_bits);
        TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                bvxi_holes_open_rule(ctx, "test", &view, &l, rules[trial % 2], &holes));
        TEST_ASSERT_EQUAL_INT32(BVX_OK,
                                bvxi_winding_open(ctx, "test", &view, &l, rules[trial % 2], &holes, &w));
        TEST_ASSERT_NOT_NULL(w);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(ctx, &view, &l, NULL, &surface));
        g = solid_of(&l, rules[trial % 2]);
        for (int32_t z = 0; z < 35; z++)
            for (int32_t y = 0; y < 37; y++)
                for (int32_t x = 0; x < 39; x++)
                    for (int axis = 0; axis < 3; axis++) {
                        int32_t const v[3] = {x, y, z};
                        int32_t const n[3] = {x + (axis == 0), y + (axis == 1), z + (axis == 2)};
                        int64_t c[3];
                        double from, to, t;
                        int clear, also_clear;
                        if (bvx_grid_get(&g, x, y, z) == bvx_grid_get(&g, n[0], n[1], n[2])) continue;
                        if (bvx_grid_get(&surface, x, y, z) || bvx_grid_get(&surface, n[0], n[1], n[2]))
                            continue;
                        for (int a = 0; a < 3; a++) c[a] = oracle_centre(v[a], l.fraction_bits);
                        from = fabs(fill_turns_at(q, mesh.t, mesh.triangles, c, fill_unmoved, scale, &clear));
                        c[axis] += INT64_C(1) << l.fraction_bits;
                        to = fabs(
                            fill_turns_at(q, mesh.t, mesh.triangles, c, fill_unmoved, scale, &also_clear));
                        memcpy(edge.v, v, sizeof edge.v);
                        edge.axis = axis;
                        bvxi_winding_ratios(w, 1, &edge, &t);
                        TEST_ASSERT_TRUE(t > 0 && t < 1);
                        if (trial % 2 && (from > 0.5) == (to > 0.5)) { /* rows decided */
                            TEST_ASSERT_TRUE(t == 0.5 || t == 0.001 || t == 0.999);
                            continue;
                        }
                        TEST_ASSERT_DOUBLE_WITHIN(1e-3, 0.5, from + t * (to - from));
                        if (trial % 2 == 0) TEST_ASSERT_EQUAL_INT(from > 0.5, bvx_grid_get(&g, x, y, z));
                        told++;
                    }
        bvx_grid_free(ctx, &g);
        bvx_grid_free(ctx, &surface);
        bvxi_winding_close(ctx, w);
        bvxi_holes_close(ctx, &holes);
        free(q);
    }
    TEST_ASSERT_TRUE(told > 300);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_four_angles_are_those_of_each);
    RUN_TEST(test_bodies_with_holes);
    RUN_TEST(test_fine_bodies_with_wide_holes);
    RUN_TEST(test_triangles_that_have_nothing_to_do_with_each_other);
    RUN_TEST(test_triangles_through_centres);
    RUN_TEST(test_open_box_by_hand);
    RUN_TEST(test_closed_meshes_are_nonzero);
    RUN_TEST(test_a_far_hole_leaves_the_rest_as_it_is);
    RUN_TEST(test_bricks_say_what_their_centres_say);
    RUN_TEST(test_windows_are_cut_out_of_the_whole);
    RUN_TEST(test_order_and_all_turned_round_change_nothing);
    RUN_TEST(test_turned_axes_change_nothing);
    RUN_TEST(test_threads_and_code_paths_change_nothing);
    RUN_TEST(test_unbalanced_rows_are_those_of_signed_sums);
    RUN_TEST(test_ratios_are_where_the_angle_is_a_half);
    return UNITY_END();
}
