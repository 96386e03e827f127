/* test_winding_loose.c - meshes whose triangles hang loose, so that each is a hole of its own: the rules
 * against the sum of all triangles' angles, bricks against single centres, bounds of what is summed in
 * cells. */
#include "solid_support.h"
#include "tools/fill_oracle.h"
#include "winding/turns.h"

typedef struct loose_sheet {
    bvxi_snapped snap;
    bvxi_holes holes;
    bvxi_sheet sheet;
} loose_sheet;

/* Each triangle gets corners of its own, moved a little; in steps of the fixed point, or of half a voxel. */
static void tear(double most, int32_t steps)
{
    for (size_t i = 0, n = 3 * mesh.triangles; i < n; i++) {
        double p[3];
        for (int a = 0; a < 3; a++)
            p[a] = maker_step(mesh.p[3 * (size_t)mesh.t[i] + (size_t)a] +
                                  most * (maker_below(&seed, 2001) - 1000) / 1000.0,
                              steps);
        mesh.t[i] = maker_vertex(&mesh, p[0], p[1], p[2]);
    }
}

/* A ball, or two in each other, the inner turned; or triangles anywhere. */
static void make_loose(int32_t trial, const bvx_lattice *l)
{
    int32_t const steps = trial % 5 == 4 ? 2 : 65536;
    double centre[3], radius[3];

    maker_clear(&mesh);
    if (trial % 7 == 6) {
        make_random(trial % 2 ? SOUP : MIXED, 400, l->dims, 12);
        return;
    }
    for (int32_t ball = 0; ball <= trial % 2; ball++) {
        for (int a = 0; a < 3; a++) {
            centre[a] = 0.5 * l->dims[a] + maker_below(&seed, 3);
            radius[a] = (0.45 - 0.2 * ball) * l->dims[a];
        }
        if (ball == 1) maker_flip(&mesh, 0, mesh.triangles);
        maker_star(&mesh, &seed, centre, radius, 0.1, 14 + trial % 9, 17, 65536);
    }
    tear(trial % 3 == 2 ? 2 : 0.25, steps);
    if (trial % 4 == 3) maker_flip(&mesh, 0, mesh.triangles / 3);
}

static void stretch(bvx_lattice *l, int axis)
{
    l->spacing[axis] = 2.75;
    for (size_t i = 0; i < mesh.vertices; i++) mesh.p[3 * i + (size_t)axis] *= 2.75;
}

static void open_loose(const bvx_lattice *l, int is_signed, loose_sheet *s)
{
    bvx_mesh_view const view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_snap(ctx, "test", &view, l, &s->snap));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_holes_open(ctx, &view, &s->snap, !is_signed, &s->holes));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_sheet_open(ctx, &s->holes, &s->snap, l, &s->sheet));
    TEST_ASSERT_NOT_NULL(s->sheet.tree);
}

static void close_loose(loose_sheet *s)
{
    bvxi_sheet_close(ctx, &s->sheet);
    bvxi_holes_close(ctx, &s->holes);
    bvxi_snap_free(ctx, &s->snap);
}

/* Centres in triangles, or within 1e-7 of a half, may be either. */
static void test_sums_of_all_angles(void)
{
    uint64_t asked = 0, inside = 0, halfway = 0;

    for (int32_t trial = quick ? 2 : 0; trial < (quick ? 3 : 7); trial++) {
        bvx_lattice l = lattice_of(34 + trial, 40, 36);
        int64_t *q;
        double scale[3];
        bvx_grid g;
        make_loose(trial, &l);
        if (trial % 3 == 1) stretch(&l, trial % 2);
        q = snapped(&l);
        for (int a = 0; a < 3; a++) scale[a] = l.spacing[a] / (1 << l.fraction_bits);
        g = solid_by(ctx, &l, NULL, BVX_FILL_WINDING, NULL);
        for (int32_t n = 0; n < (quick ? 600 : 1500); n++) {
            int32_t const v[3] = {maker_below(&seed, l.dims[0]), maker_below(&seed, l.dims[1]),
                                  maker_below(&seed, l.dims[2])};
            int64_t c[3];
            double turns;
            int clear;
            for (int a = 0; a < 3; a++) c[a] = oracle_centre(v[a], l.fraction_bits);
            turns = fabs(fill_turns_at(q, mesh.t, mesh.triangles, c, fill_unmoved, scale, &clear));
            asked++;
            inside += turns > 0.5;
            halfway += fabs(turns - floor(turns + 0.5)) > 0.25;
            if (clear && fabs(turns - 0.5) > 1e-7)
                TEST_ASSERT_EQUAL_INT(turns > 0.5, bvx_grid_get(&g, v[0], v[1], v[2]));
        }
        bvx_grid_free(ctx, &g);
        free(q);
    }
    TEST_ASSERT_TRUE(inside > (quick ? 20 : 100) && halfway > 50 && inside < asked);
}

static void assert_block_is_its_centres(const bvx_lattice *l, int is_signed)
{
    loose_sheet s;
    bvxi_turns_block *const b = maker_grow(NULL, sizeof *b);
    int64_t const step = (int64_t)1 << l->fraction_bits;

    memset(b, 0, sizeof *b);
    open_loose(l, is_signed, &s);
    b->sheet = &s.sheet;
    b->pending = maker_grow(NULL, s.sheet.tree->pendings * BVXI_TURNS_LEVELS * 4);
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
                if ((b->open[row] >> x & 1) == 0 || maker_below(&seed, 64) != 0) continue;
                a = bvxi_sheet_turns(&s.sheet, p, b->want_clear);
                TEST_ASSERT_EQUAL_INT(2 * a.whole + (b->ties ? a.tie : 0), turns);
                if (turns != 0) TEST_ASSERT_EQUAL_INT(1, b->dirty);
                if (b->want_clear) TEST_ASSERT_EQUAL_INT(a.clear, b->clear[row] >> x & 1);
            }
    close_loose(&s);
    free(b->pending);
    free(b);
}

static void test_bricks_say_what_their_centres_say(void)
{
    for (int32_t trial = 0; trial < (quick ? 1 : 7); trial++) {
        bvx_lattice l = lattice_of(60, 50, 55);
        make_loose(trial, &l);
        if (trial % 3 == 0) stretch(&l, trial / 3 % 3);
        assert_block_is_its_centres(&l, trial % 2);
    }
}

/* Places in the sheet, near it and far off; cells taken as wholes from near on and from far off only. */
static void test_cells_keep_their_bounds(void)
{
    double const q[4] = {0.8, 0.45, 0.2, 0.02};
    int32_t used[4] = {0, 0, 0, 0};

    for (int32_t trial = 0; trial < (quick ? 1 : 7); trial++) {
        bvx_lattice l = lattice_of(44, 50, 39);
        loose_sheet s;
        make_loose(trial, &l);
        if (trial % 3 == 0) stretch(&l, 2);
        open_loose(&l, 1, &s);
        for (int32_t n = 0; n < 40; n++) {
            int32_t const reach = n % 3 == 0 ? 1000 : 60;
            int64_t p[3];
            double exact;
            for (int a = 0; a < 3; a++)
                p[a] = oracle_centre(maker_below(&seed, reach) - reach / 8, l.fraction_bits);
            exact = bvxi_sheet_angle(&s.sheet, p, -1);
            for (int i = 0; i < 4; i++) {
                double error;
                double const turns = bvxi_sheet_tree_angle(&s.sheet, p, q[i], &error);
                TEST_ASSERT_TRUE(fabs(turns - exact) <= error + 2e-8);
                used[i] += error > 0 && error < 0.1;
            }
        }
        close_loose(&s);
    }
    for (int i = 1; i < 4; i++) TEST_ASSERT_TRUE(used[i] > 10);
}

/* A ball whose triangles shrink to their middles by a part. */
static void make_cracked(const bvx_lattice *l, double part)
{
    double centre[3], radius[3];

    maker_clear(&mesh);
    for (int a = 0; a < 3; a++) {
        centre[a] = 0.5 * l->dims[a];
        radius[a] = 0.4 * l->dims[a];
    }
    maker_star(&mesh, &seed, centre, radius, 0.1, 16, 21, 65536);
    for (size_t t = 0, n = mesh.triangles; t < n; t++) {
        double p[3][3];
        for (int i = 0; i < 9; i++)
            p[i / 3][i % 3] = mesh.p[3 * (size_t)mesh.t[3 * t + (size_t)(i / 3)] + (size_t)(i % 3)];
        for (size_t k = 0; k < 3; k++) {
            double q[3];
            for (int a = 0; a < 3; a++)
                q[a] = maker_step(p[k][a] + part * ((p[0][a] + p[1][a] + p[2][a]) / 3 - p[k][a]), 65536);
            mesh.t[3 * t + k] = maker_vertex(&mesh, q[0], q[1], q[2]);
        }
    }
}

/* How often each directed edge is there: its corners' numbers, times 1 or -1, in a sum that order does not
 * change. */
static uint64_t sum_of_edges(const bvxi_holes *h)
{
    uint64_t sum = 0, begin = 0;

    for (uint64_t k = 0; k < h->loops; begin = h->loop_end[k++])
        for (uint64_t i = begin; i < h->loop_end[k]; i++) {
            uint64_t const a = h->vertex[i], b = h->vertex[i + 1 < h->loop_end[k] ? i + 1 : begin];
            uint64_t x = (a < b ? a << 32 | b : b << 32 | a) * UINT64_C(0x9e3779b97f4a7c15);
            x = (x ^ x >> 29) * UINT64_C(0xbf58476d1ce4e5b9);
            sum += a < b ? x : 0 - x;
        }
    return sum;
}

/* Strips along cracks have the holes' border and little area, and turns are the same. */
static void test_cracks_are_strips(void)
{
    for (int32_t trial = 0; trial < (quick ? 2 : 6); trial++) {
        bvx_lattice l = lattice_of(60, 50, 55);
        loose_sheet s;
        make_cracked(&l, trial % 2 == 0 ? 0.03 : 0.1);
        open_loose(&l, trial < 3, &s);
        TEST_ASSERT_TRUE(s.sheet.strips.loops > 0 && s.sheet.holes == &s.sheet.strips);
        TEST_ASSERT_TRUE(sum_of_edges(&s.holes) == sum_of_edges(s.sheet.holes));
        TEST_ASSERT_TRUE(bvxi_sheet_group(&s.sheet, 0, s.sheet.holes->loops)->area < 9000 * 0.25);

        close_loose(&s);
        assert_block_is_its_centres(&l, trial % 2);
    }
}

/* Windows hold what the whole has; so do other threads and code paths. */
static void test_windows_threads_and_code_paths_change_nothing(void)
{
    static const int32_t rules[3] = {BVX_FILL_WINDING, BVX_FILL_VOTE, BVX_FILL_WINDING};

    for (int32_t trial = 0; trial < (quick ? 1 : 3); trial++) {
        bvx_lattice const l = lattice_of(75, 40, 38);
        bvx_window w;
        bvx_grid whole, part;
        make_loose(trial, &l);
        whole = solid_of(&l, rules[trial % 3]);
        for (int32_t i = 0; i < 4; i++) {
            bvx_context *const c = suite_context(1 + i, i < 2 ? BVX_CPU_BEST : BVX_CPU_PORTABLE);
            part = solid_by(c, &l, NULL, rules[trial % 3], NULL);
            assert_same_bits(&whole, &part, "threads");
            bvx_grid_free(c, &part);
            bvx_context_destroy(c);
        }
        for (int a = 0; a < 3; a++) {
            w.size[a] = 1 + maker_below(&seed, l.dims[a]);
            w.low[a] = maker_below(&seed, l.dims[a] - w.size[a] + 1);
        }
        part = solid_by(ctx, &l, &w, rules[trial % 3], NULL);
        for (int32_t z = 0; z < w.size[2]; z++)
            for (int32_t y = 0; y < w.size[1]; y++)
                for (int32_t x = 0; x < w.size[0]; x++)
                    TEST_ASSERT_EQUAL_INT(bvx_grid_get(&whole, w.low[0] + x, w.low[1] + y, w.low[2] + z),
                                          bvx_grid_get(&part, x, y, z));
        bvx_grid_free(ctx, &part);
        bvx_grid_free(ctx, &whole);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_sums_of_all_angles);
    RUN_TEST(test_bricks_say_what_their_centres_say);
    RUN_TEST(test_cells_keep_their_bounds);
    RUN_TEST(test_cracks_are_strips);
    RUN_TEST(test_windows_threads_and_code_paths_change_nothing);
    return UNITY_END();
}
