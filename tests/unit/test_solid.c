/* test_solid.c - bvx_voxelize_solid against an oracle in whole numbers: every bit, every row, both rules. */
#include "tools/fault.h"
#include "tools/solid_oracle.h"

#include "unity.h"

static bvx_context *ctx;      /* one thread, the best code there is, blocks between guards */
static fault_heap heap;
static maker_mesh mesh;
static uint64_t seed;
static int quick;             /* on emulated machines: fewer trials */
static int as_floats;         /* hand the mesh over as packed floats */

static bvx_context *context_with(int32_t threads, int32_t cpu)
{
    bvx_context_options o;
    bvx_context *c = NULL;
    bvx_context_options_init(&o, sizeof o);
    o.threads = threads;
    o.cpu = cpu;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &c));
    return c;
}

void setUp(void)
{
    bvx_context_options o;
    seed = UINT64_C(0x5eed5011d);
    quick = getenv("BVX_QUICK") != NULL;
    as_floats = 0;
    bvx_context_options_init(&o, sizeof o);
    o = fault_options(&o, &heap);
    o.threads = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&o, &ctx));
}

void tearDown(void)
{
    uint64_t const held = bvx_memory_used(ctx);
    const char *wrong;
    maker_free(&mesh);
    bvx_context_destroy(ctx);
    wrong = fault_end(&heap);
    TEST_ASSERT_NULL_MESSAGE(wrong, wrong);
    TEST_ASSERT_EQUAL_UINT64(0, held);
}

static bvx_lattice lattice_of(int32_t x, int32_t y, int32_t z)
{
    double const origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t const dims[3] = {x, y, z};
    bvx_lattice l;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    return l;
}

static bvx_status fill_with(bvx_context *c, const bvx_mesh_view *view, const bvx_lattice *l, const bvx_window *window,
                            int32_t fill, bvx_grid *grid, bvx_solid_report *report)
{
    bvx_voxelize_options o;
    bvx_voxelize_options_init(&o, sizeof o);
    o.fill = fill;
    o.report = report;
    if (window != NULL) o.window = *window;
    return bvx_voxelize_solid(c, view, l, &o, grid);
}

/* The mesh as doubles, or as packed floats in an array that the caller frees. */
static bvx_mesh_view mesh_view(float **floats)
{
    bvx_mesh_view view = maker_view(&mesh);
    *floats = NULL;
    if (as_floats) {
        *floats = maker_grow(NULL, (mesh.vertices + 1) * 3 * sizeof **floats);
        for (size_t i = 0; i < 3 * mesh.vertices; i++) (*floats)[i] = (float)mesh.p[i];
        view.positions = *floats;
        view.position_type = BVX_F32;
    }
    return view;
}

static bvx_grid solid_by(bvx_context *c, const bvx_lattice *l, const bvx_window *window, int32_t fill, bvx_solid_report *report)
{
    float *floats;
    bvx_mesh_view const view = mesh_view(&floats);
    bvx_grid grid = {0};
    bvx_status const status = fill_with(c, &view, l, window, fill, &grid, report);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, status, bvx_last_message(c));
    free(floats);
    return grid;
}

static bvx_grid solid_of(const bvx_lattice *l, int32_t fill)
{
    return solid_by(ctx, l, NULL, fill, NULL);
}

static uint64_t set_voxels(const bvx_grid *g)
{
    uint64_t n;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_count(ctx, g, &n));
    return n;
}

static void assert_same_bits(const bvx_grid *a, const bvx_grid *b, const char *what)
{
    size_t const words = (size_t)a->words_per_row * (size_t)a->size[1] * (size_t)a->size[2];
    TEST_ASSERT_EQUAL_MEMORY_MESSAGE(a->size, b->size, sizeof a->size, what);
    TEST_ASSERT_EQUAL_INT_MESSAGE(0, memcmp(a->words, b->words, words * 8), what);
}

static int64_t *snapped(const bvx_lattice *l)
{
    int64_t *const q = maker_grow(NULL, (mesh.vertices + 1) * 3 * sizeof *q);
    for (size_t i = 0; i < 3 * mesh.vertices; i++)
        q[i] = oracle_snap(mesh.p[i], l->origin[i % 3], l->spacing[i % 3], l->fraction_bits);
    return q;
}

/* The window's bits and counts are the oracle's; what lies beyond a row's end is zero. */
static void assert_is_oracle(const bvx_lattice *l, const bvx_window *window, int32_t fill)
{
    int64_t *const q = snapped(l);
    oracle_solid o = oracle_make(l, window, q, mesh.t, mesh.triangles, fill);
    bvx_solid_report r;
    bvx_grid g = solid_by(ctx, l, window, fill, &r);
    char text[120];
    TEST_ASSERT_EQUAL_MEMORY(o.window.low, g.low, sizeof g.low);
    TEST_ASSERT_EQUAL_MEMORY(o.window.size, g.size, sizeof g.size);
    for (int32_t z = 0; z < g.size[2]; z++)
        for (int32_t y = 0; y < g.size[1]; y++) {
            size_t const row = (size_t)z * (size_t)g.size[1] + (size_t)y;
            for (int32_t x = 0; x < g.words_per_row * 64; x++) {
                int const want = x < g.size[0] ? o.voxel[row * (size_t)g.size[0] + (size_t)x] : 0;
                if (bvx_grid_get(&g, x, y, z) == want) continue;
                snprintf(text, sizeof text, "voxel (%d, %d, %d) of a %d x %d x %d window is %d under rule %d", (int)x, (int)y,
                         (int)z, (int)g.size[0], (int)g.size[1], (int)g.size[2], !want, (int)fill);
                TEST_FAIL_MESSAGE(text);
            }
        }
    TEST_ASSERT_EQUAL_UINT64(o.crossings, r.crossings);
    TEST_ASSERT_EQUAL_UINT64(o.unbalanced_rows, r.unbalanced_rows);
    TEST_ASSERT_EQUAL_UINT64(o.dropped, r.dropped);
    TEST_ASSERT_TRUE(o.covering <= r.triangles_used);
    TEST_ASSERT_TRUE(r.triangles_used <= o.boxes * (uint64_t)((g.size[1] + 65534) / 65535) * (uint64_t)((g.size[2] + 65534) / 65535));
    bvx_grid_free(ctx, &g);
    oracle_free(&o);
    free(q);
}

static void assert_both_rules(const bvx_lattice *l)
{
    assert_is_oracle(l, NULL, BVX_FILL_PARITY);
    assert_is_oracle(l, NULL, BVX_FILL_NONZERO);
}

/* ---- By hand ---- */

static void test_box_on_voxel_planes_fills_its_voxels(void)
{
    for (int32_t at = -2; at <= 6; at++) {
        bvx_lattice const l = lattice_of(6, 7, 8);
        double const low[3] = {at, at, at}, high[3] = {at + 4, at + 4, at + 4};
        for (int32_t fill = 0; fill < 2; fill++) {
            uint64_t expected = 1;
            bvx_grid g;
            maker_clear(&mesh);
            maker_box(&mesh, low, high);
            g = solid_of(&l, fill);
            for (int a = 0; a < 3; a++) {
                int32_t const from = at < 0 ? 0 : at, to = at + 4 > l.dims[a] ? l.dims[a] : at + 4;
                expected *= from < to ? (uint64_t)(to - from) : 0;
            }
            TEST_ASSERT_EQUAL_UINT64(expected, set_voxels(&g));
            if (at == 0) TEST_ASSERT_EQUAL_UINT64(64, set_voxels(&g));
            for (int32_t z = 0; z < 8; z++)
                for (int32_t y = 0; y < 7; y++)
                    for (int32_t x = 0; x < 6; x++)
                        TEST_ASSERT_EQUAL_INT(x >= at && x < at + 4 && y >= at && y < at + 4 && z >= at && z < at + 4,
                                              bvx_grid_get(&g, x, y, z));
            bvx_grid_free(ctx, &g);
        }
    }
}

/* Faces through the centres: a centre on the low face is inside, on the high face outside, as all centres move up. */
static void test_box_on_centres_is_half_open(void)
{
    bvx_lattice const l = lattice_of(70, 6, 6);
    double const low[3] = {1.5, 2.5, 0.5}, high[3] = {66.5, 4.5, 3.5};
    maker_box(&mesh, low, high);
    for (int32_t fill = 0; fill < 2; fill++) {
        bvx_grid g = solid_of(&l, fill);
        for (int32_t z = 0; z < 6; z++)
            for (int32_t y = 0; y < 6; y++)
                for (int32_t x = 0; x < 70; x++)
                    TEST_ASSERT_EQUAL_INT(x >= 1 && x < 66 && y >= 2 && y < 4 && z >= 0 && z < 3, bvx_grid_get(&g, x, y, z));
        bvx_grid_free(ctx, &g);
    }
}

static void test_report_by_hand(void)
{
    bvx_lattice const l = lattice_of(10, 10, 10);
    double const low[3] = {2, 3, 4}, high[3] = {6, 5, 7};
    bvx_solid_report r;
    bvx_grid g;
    maker_box(&mesh, low, high);
    g = solid_by(ctx, &l, NULL, BVX_FILL_PARITY, &r);
    TEST_ASSERT_EQUAL_UINT64(4, r.triangles_used); /* the two faces across x */
    TEST_ASSERT_EQUAL_UINT64(2 * 2 * 3, r.crossings);
    TEST_ASSERT_EQUAL_UINT64(0, r.unbalanced_rows);
    TEST_ASSERT_EQUAL_UINT64(0, r.dropped);
    for (int i = 0; i < 4; i++) TEST_ASSERT_EQUAL_UINT64(0, r.reserved[i]);
    TEST_ASSERT_EQUAL_UINT64(4 * 2 * 3, set_voxels(&g));
    bvx_grid_free(ctx, &g);
    maker_remove(&mesh, 3); /* one triangle of the face at x = 6 */
    maker_remove(&mesh, 2);
    for (int32_t fill = 0; fill < 2; fill++) {
        g = solid_by(ctx, &l, NULL, fill, &r);
        TEST_ASSERT_EQUAL_UINT64(2 * 3, r.crossings);
        TEST_ASSERT_EQUAL_UINT64(2 * 3, r.unbalanced_rows);
        TEST_ASSERT_EQUAL_UINT64(2 * 3, r.dropped);
        TEST_ASSERT_EQUAL_UINT64(0, set_voxels(&g)); /* nothing leaks through the hole */
        bvx_grid_free(ctx, &g);
    }
}

static void wall(double x, double size, int leaving)
{
    uint32_t const a = maker_vertex(&mesh, x, 0, 0), b = maker_vertex(&mesh, x, size, 0), c = maker_vertex(&mesh, x, 0, size);
    if (leaving) maker_triangle(&mesh, a, b, c);
    else maker_triangle(&mesh, a, c, b);
}

/* One row, crossed where and how the text says: '<' enters, '>' leaves, before the voxel of its column. */
static void assert_row(const char *crossings, int32_t fill, const char *voxels, uint64_t dropped)
{
    bvx_lattice const l = lattice_of((int32_t)strlen(voxels), 1, 1);
    bvx_solid_report r;
    bvx_grid g;
    char seen[80] = "";
    maker_clear(&mesh);
    for (int32_t i = 0; crossings[i] != 0; i++) {
        if (crossings[i] == '<' || crossings[i] == 'X') wall(i, 4, 0);
        if (crossings[i] == '>' || crossings[i] == 'X') wall(i, 4, 1);
    }
    g = solid_by(ctx, &l, NULL, fill, &r);
    for (int32_t x = 0; voxels[x] != 0; x++) seen[x] = bvx_grid_get(&g, x, 0, 0) ? '#' : '.';
    TEST_ASSERT_EQUAL_STRING(voxels, seen);
    TEST_ASSERT_EQUAL_UINT64(dropped, r.dropped);
    TEST_ASSERT_EQUAL_UINT64(dropped != 0, r.unbalanced_rows);
    bvx_grid_free(ctx, &g);
}

static void test_rows_by_hand(void)
{
    assert_row(" <  > ", BVX_FILL_PARITY, ".###...", 0);
    assert_row(" <  > ", BVX_FILL_NONZERO, ".###...", 0);
    assert_row(" >  < ", BVX_FILL_NONZERO, ".###...", 0);      /* turned inside out */
    assert_row("< <  >  >", BVX_FILL_PARITY, "##...###..", 0); /* a cavity */
    assert_row("< <  >  >", BVX_FILL_NONZERO, "########..", 0);
    assert_row("< >  >  <", BVX_FILL_NONZERO, "##...###..", 0);
    assert_row("X  X", BVX_FILL_NONZERO, "......", 0);
    assert_row("X  X", BVX_FILL_PARITY, "......", 0);
    /* a crossing too many */
    assert_row(" < >   > ", BVX_FILL_PARITY, ".##......", 1);
    assert_row(" <   > > ", BVX_FILL_PARITY, ".....##..", 1);
    assert_row(" <  >  > ", BVX_FILL_PARITY, ".###.....", 1); /* equal: the later goes */
    assert_row(" <  >  > ", BVX_FILL_NONZERO, ".###.....", 1);
    assert_row(" > <  > ", BVX_FILL_NONZERO, "...###..", 1);
    assert_row(" <  > < ", BVX_FILL_NONZERO, ".###....", 1);
    assert_row(" <  <  > ", BVX_FILL_NONZERO, "....###..", 1);
    assert_row(" <<  >  ", BVX_FILL_NONZERO, "..###...", 1);
    assert_row(" >> < ", BVX_FILL_NONZERO, "..##..", 0 + 1);
    assert_row(" > ", BVX_FILL_NONZERO, "....", 1);
    assert_row(" < ", BVX_FILL_PARITY, "....", 1);
    assert_row(" <<< ", BVX_FILL_NONZERO, ".....", 3);
    assert_row("<>  X  >", BVX_FILL_NONZERO, "#.......", 1); /* entering stands before leaving in one voxel */
}

/* ---- Random meshes ---- */

enum { SOUP, NEEDLES, DEGENERATE, ALIGNED, HUGE, TINY, MIXED, KINDS };

static void make_random(int32_t kind, int32_t count, const int32_t n[3], int32_t fraction_bits)
{
    int32_t const steps = 1 << fraction_bits;
    double low[3], high[3];
    for (int a = 0; a < 3; a++) {
        low[a] = -2;
        high[a] = n[a] + 2;
    }
    maker_clear(&mesh);
    switch (kind) {
    case SOUP: maker_soup(&mesh, &seed, count, low, high, steps); break;
    case NEEDLES: maker_needles(&mesh, &seed, count, low, high, steps); break;
    case DEGENERATE: maker_degenerate(&mesh, &seed, count, low, high, steps); break;
    case ALIGNED: maker_soup(&mesh, &seed, count, low, high, 2); break; /* corners and centres of voxels */
    case HUGE:
        for (int a = 0; a < 3; a++) {
            high[a] = (double)((1 << 30) - 1) / steps;
            low[a] = -high[a];
        }
        maker_soup(&mesh, &seed, count / 2 + 1, low, high, steps);
        maker_needles(&mesh, &seed, count / 8 + 1, low, high, 1); /* may leave the range */
        for (size_t i = 0; i < 3 * mesh.vertices; i++)
            mesh.p[i] = mesh.p[i] > high[0] ? high[0] : mesh.p[i] < low[0] ? low[0] : mesh.p[i];
        break;
    case TINY:
        for (int32_t i = 0; i < count; i++) {
            double near_low[3], near_high[3];
            for (int a = 0; a < 3; a++) {
                near_low[a] = maker_below(&seed, n[a]) + (maker_below(&seed, 2) ? 0.5 : 0.0);
                near_high[a] = near_low[a] + 4.0 / steps;
                near_low[a] -= 4.0 / steps;
            }
            maker_soup(&mesh, &seed, 3, near_low, near_high, steps);
        }
        break;
    default:
        maker_soup(&mesh, &seed, count / 4 + 1, low, high, steps);
        maker_needles(&mesh, &seed, count / 4 + 1, low, high, steps);
        maker_soup(&mesh, &seed, count / 4 + 1, low, high, 2);
        maker_degenerate(&mesh, &seed, count / 4 + 1, low, high, 2);
    }
}

static void test_random_meshes_at_all_widths(void)
{
    static const int32_t widths[] = {1, 2, 63, 64, 65, 127, 128, 129};
    for (size_t w = 0; w < sizeof widths / sizeof widths[0]; w++)
        for (int32_t kind = 0; kind < KINDS; kind++)
            for (int32_t trial = 0; trial < (quick ? 1 : 4); trial++) {
                bvx_lattice const l = lattice_of(widths[w], 5 + 3 * trial, 9 - trial);
                make_random(kind, 10 << trial, l.dims, 16);
                assert_both_rules(&l);
            }
}

static void test_random_meshes_on_flat_lattices(void)
{
    static const int32_t sizes[][3] = {{1, 1, 1}, {1, 70, 1}, {1, 1, 70}, {1, 33, 35}, {70, 1, 1}, {66, 40, 1}, {66, 1, 40}, {2, 2, 2},
                                       {1, 130, 2}, {3, 1, 200}};
    for (size_t s = 0; s < sizeof sizes / sizeof sizes[0]; s++)
        for (int32_t kind = 0; kind < KINDS; kind++) {
            bvx_lattice const l = lattice_of(sizes[s][0], sizes[s][1], sizes[s][2]);
            make_random(kind, quick ? 20 : 120, l.dims, 16);
            assert_both_rules(&l);
        }
}

/* Every number of fraction bits, also fewer than the lattice would have. */
static void test_random_meshes_with_all_fraction_bits(void)
{
    for (int32_t f = 4; f <= 16; f++)
        for (int32_t kind = 0; kind < KINDS; kind++) {
            bvx_lattice l = lattice_of(67, 13, 11);
            l.fraction_bits = f;
            make_random(kind, quick ? 20 : 80, l.dims, f);
            assert_both_rules(&l);
        }
}

/* Long axes have few fraction bits; windows keep it small. */
static void test_long_lattices_through_windows(void)
{
    static const int32_t lengths[4] = {8193, 100000, 1 << 24, 1 << 25};
    for (int i = 0; i < 4; i++)
        for (int axis = 0; axis < 3; axis++)
            for (int32_t trial = 0; trial < 3; trial++) {
                int32_t dims[3] = {66, 9, 8};
                bvx_window w = {{0, 0, 0}, {66, 9, 8}};
                bvx_lattice l;
                dims[axis] = lengths[i];
                l = lattice_of(dims[0], dims[1], dims[2]);
                TEST_ASSERT_TRUE(l.fraction_bits < 16);
                w.low[axis] = trial == 0 ? 0 : trial == 1 ? lengths[i] - w.size[axis] : lengths[i] / 2 - 3;
                make_random(trial == 2 ? HUGE : MIXED, 100, w.size, l.fraction_bits);
                if (trial != 2) maker_shift(&mesh, 0, w.low[0], w.low[1], w.low[2]);
                assert_is_oracle(&l, &w, BVX_FILL_PARITY);
                assert_is_oracle(&l, &w, BVX_FILL_NONZERO);
            }
}

/* Vertices at the very ends of the fixed point: the budgets of edge functions, normals and planes. */
static void test_extreme_triangles(void)
{
    double const most = (double)((1 << 30) - 1) / 65536;
    bvx_lattice l;
    for (int32_t trial = 0; trial < (quick ? 60 : 600); trial++) {
        l = lattice_of(65, 6, 7);
        maker_clear(&mesh);
        for (int32_t t = 0; t < 12; t++) {
            uint32_t v[3];
            for (int k = 0; k < 3; k++) {
                double p[3];
                for (int a = 0; a < 3; a++) {
                    int32_t const pick = maker_below(&seed, 8);
                    p[a] = pick < 3 ? most : pick < 6 ? -most : maker_between(&seed, 0, l.dims[a], pick == 6 ? 2 : 65536);
                    if (pick < 6 && maker_below(&seed, 3) == 0) p[a] -= p[a] > 0 ? maker_below(&seed, 9) / 65536.0 : -maker_below(&seed, 9) / 65536.0;
                }
                v[k] = maker_vertex(&mesh, p[0], p[1], p[2]);
            }
            maker_triangle(&mesh, v[0], v[1], v[2]);
        }
        assert_both_rules(&l);
    }
}

/* Planes that pass within a few steps, or exactly, through centres of long rows: where doubles cannot decide. */
static void test_planes_through_centres(void)
{
    for (int32_t trial = 0; trial < (quick ? 40 : 400); trial++) {
        int32_t const n[3] = {129, 17, 17};
        bvx_lattice const l = lattice_of(n[0], n[1], n[2]);
        maker_clear(&mesh);
        for (int32_t t = 0; t < 8; t++) {
            int32_t const scale = 1 << maker_below(&seed, trial % 2 ? 12 : 5);
            double c[3], u[3], w[3];
            uint32_t a, b, d;
            for (int i = 0; i < 3; i++) {
                c[i] = maker_below(&seed, n[i]) + 0.5; /* a centre, and two whole steps in the plane: many centres on it */
                u[i] = maker_below(&seed, 7) - 3;
                w[i] = maker_below(&seed, 7) - 3;
            }
            a = maker_vertex(&mesh, c[0] - u[0] * scale, c[1] - u[1] * scale, c[2] - u[2] * scale);
            b = maker_vertex(&mesh, c[0] + (u[0] - w[0]) * scale, c[1] + (u[1] - w[1]) * scale, c[2] + (u[2] - w[2]) * scale);
            for (int i = 0; i < 3; i++) c[i] += w[i] * scale + (maker_below(&seed, 3) == 0 ? maker_below(&seed, 3) - 1 : 0) / 65536.0;
            d = maker_vertex(&mesh, c[0], c[1], c[2]);
            maker_triangle(&mesh, a, b, d);
        }
        for (size_t i = 0; i < 3 * mesh.vertices; i++) TEST_ASSERT_TRUE(fabs(mesh.p[i]) < 16384);
        assert_both_rules(&l);
    }
}

/* A triangle with corners a, v and -(a + m v) about a centre: the centre has weights 1 : m : 1, so one step of a's x
 * moves the crossing by 1 / (m + 2) steps. That is where divisions in doubles are trusted, or are not. */
static void test_crossings_a_hair_from_a_centre(void)
{
    for (int32_t trial = 0; trial < (quick ? 1000 : 8000); trial++) {
        bvx_lattice const l = trial % 2 ? lattice_of(70, 3, 2) : lattice_of(66, 1 + maker_below(&seed, 12), 12);
        maker_clear(&mesh);
        for (int32_t t = 0; t < 3; t++) {
            int32_t const m = 1 + maker_below(&seed, 1 << (1 + maker_below(&seed, 20)));
            int32_t const yz = maker_below(&seed, 28), across = maker_below(&seed, 28);
            double p[3][3];
            int fits = 1;
            for (int i = 0; i < 3; i++) {
                double const centre = (maker_below(&seed, l.dims[i]) + 0.5) * 65536;
                int32_t const range = 1 << (i == 0 ? across : yz);
                double const a = maker_below(&seed, 2 * range + 1) - range;
                double const v = maker_below(&seed, 2 * (range / m) + 3) - (range / m + 1);
                p[0][i] = centre + a + (i == 0 ? maker_below(&seed, 3) - 1 : 0);
                p[1][i] = centre + v;
                p[2][i] = centre - a - m * v;
                for (int k = 0; k < 3; k++) fits &= fabs(p[k][i]) < (1 << 30);
            }
            if (!fits) continue;
            maker_triangle(&mesh, maker_vertex(&mesh, p[0][0] / 65536, p[0][1] / 65536, p[0][2] / 65536),
                           maker_vertex(&mesh, p[1][0] / 65536, p[1][1] / 65536, p[1][2] / 65536),
                           maker_vertex(&mesh, p[2][0] / 65536, p[2][1] / 65536, p[2][2] / 65536));
        }
        wall(1, 400, 1); /* an opposite crossing, so that rows of one are filled */
        if (mesh.triangles > 1) assert_is_oracle(&l, NULL, BVX_FILL_PARITY);
    }
}

/* c and d with a d - b c = 1, for a and b without a common factor: by Euclid's steps. */
static void other_side(int64_t a, int64_t b, int64_t *c, int64_t *d)
{
    int64_t r0 = a, r1 = b, s0 = 1, s1 = 0, t0 = 0, t1 = 1; /* r = s a + t b */
    while (r1 != 0) {
        int64_t const n = r0 / r1;
        int64_t const r = r0 - n * r1, s = s0 - n * s1, t = t0 - n * t1;
        r0 = r1;
        r1 = r;
        s0 = s1;
        s1 = s;
        t0 = t1;
        t1 = t;
    }
    *d = r0 < 0 ? -s0 : s0;
    *c = r0 < 0 ? t0 : -t0;
}

/* The last digit: weights e of the corners at a centre are coprime, and x coordinates are solved so that the plane passes
 * the centre at -1, 0 or 1 parts of the weights' sum. */
static void test_crossings_as_near_to_a_centre_as_can_be(void)
{
    int64_t tried = 0;
    for (int32_t trial = 0; trial < (quick ? 1500 : 15000); trial++) {
        bvx_lattice const l = lattice_of(70, 3, 2);
        int32_t const range = 1 << (2 + maker_below(&seed, 14)), off = maker_below(&seed, 3) - 1;
        int64_t y[3], z[3], x[3], e[3], c, d, rest, sum;
        int positive = 0;
        double p[3][3];
        for (int i = 0; i < 3; i++) {
            y[i] = maker_below(&seed, 2 * range + 1) - range;
            z[i] = maker_below(&seed, 2 * range + 1) - range;
        }
        for (int i = 0; i < 3; i++) e[i] = y[(i + 1) % 3] * z[(i + 2) % 3] - y[(i + 2) % 3] * z[(i + 1) % 3];
        for (int i = 0; i < 3; i++) positive += e[i] > 0;
        if (positive != 0 && positive != 3) continue; /* the centre is outside */
        if (e[1] == 0 || e[2] == 0) continue;
        sum = e[1];
        for (int64_t h = e[2]; h != 0;) {
            int64_t const r = sum % h;
            sum = h;
            h = r;
        }
        if (sum != 1 && sum != -1) continue;
        other_side(e[1], e[2], &c, &d);
        x[0] = maker_below(&seed, 1 << (5 + maker_below(&seed, 23)));
        rest = off - e[0] * x[0]; /* e1 x1 + e2 x2 is to be this */
        x[1] = d % e[2] * (rest % e[2]) % e[2];
        x[2] = (rest - e[1] * x[1]) / e[2];
        TEST_ASSERT_EQUAL_INT64(off, e[0] * x[0] + e[1] * x[1] + e[2] * x[2]);
        if (x[1] > 1 << 29 || x[1] < -(1 << 29) || x[2] > 1 << 29 || x[2] < -(1 << 29)) continue;
        for (int i = 0; i < 3; i++) {
            p[i][0] = ((trial % 70 + 0.5) * 65536 + (double)x[i]) / 65536;
            p[i][1] = (1.5 * 65536 + (double)y[i]) / 65536;
            p[i][2] = (0.5 * 65536 + (double)z[i]) / 65536;
        }
        maker_clear(&mesh);
        for (int i = 0; i < 3; i++) maker_vertex(&mesh, p[i][0], p[i][1], p[i][2]);
        maker_triangle(&mesh, 0, 1, 2);
        wall(-5, 400, 0);
        assert_is_oracle(&l, NULL, BVX_FILL_PARITY);
        tried++;
    }
    TEST_ASSERT_TRUE(tried > (quick ? 50 : 500));
}

/* Long edges that pass a centre as near as whole numbers can, or through it: the edge function there is -1, 0 or 1. */
static void test_edges_a_hair_from_a_centre(void)
{
    int64_t tried = 0;
    for (int32_t trial = 0; trial < (quick ? 1000 : 8000); trial++) {
        bvx_lattice const l = trial % 3 == 0 ? lattice_of(3, 1, 1) : trial % 3 == 1 ? lattice_of(3, 2, 3) : lattice_of(3, 9, 9);
        int32_t const range = 1 << (4 + maker_below(&seed, 25)), off = maker_below(&seed, 3) - 1;
        double const y = (maker_below(&seed, l.dims[1]) + 0.5) * 65536, z = (maker_below(&seed, l.dims[2]) + 0.5) * 65536;
        int64_t a = maker_below(&seed, 2 * range + 1) - range, b = maker_below(&seed, 2 * range + 1) - range, c, d, g = a, h = b;
        double p[3][3];
        int fits = 1;
        while (h != 0) {
            int64_t const rest = g % h;
            g = h;
            h = rest;
        }
        if (g == 0) continue;
        a /= g;
        b /= g;
        other_side(a, b, &c, &d);
        TEST_ASSERT_EQUAL_INT64(1, a * d - b * c);
        p[0][0] = p[1][0] = p[2][0] = 65536 + maker_below(&seed, 65536);
        p[0][1] = y + (double)a;
        p[0][2] = z + (double)b;
        p[1][1] = y - (double)(a * (1 + trial % 2)) + (double)(off * c);
        p[1][2] = z - (double)(b * (1 + trial % 2)) + (double)(off * d);
        p[2][1] = y + maker_below(&seed, 2 * range + 1) - range;
        p[2][2] = z + maker_below(&seed, 2 * range + 1) - range;
        for (int k = 0; k < 9; k++) fits &= fabs(p[k / 3][k % 3]) < (1 << 30);
        if (!fits) continue;
        maker_clear(&mesh);
        for (int k = 0; k < 3; k++) maker_vertex(&mesh, p[k][0] / 65536, p[k][1] / 65536, p[k][2] / 65536);
        maker_triangle(&mesh, 0, 1, 2);
        wall(0, 400, 0);
        assert_is_oracle(&l, NULL, BVX_FILL_PARITY);
        tried++;
    }
    TEST_ASSERT_TRUE(tried > 500);
}

/* Origins, spacings and positions that are no round numbers. */
static void test_snapping_of_arbitrary_coordinates(void)
{
    for (int32_t trial = 0; trial < (quick ? 20 : 150); trial++) {
        int32_t const dims[3] = {60 + maker_below(&seed, 10), 12, 14};
        double origin[3], spacing[3], low[3], high[3];
        bvx_lattice l;
        for (int a = 0; a < 3; a++) {
            origin[a] = maker_between(&seed, -1e6, 1e6, 997);
            spacing[a] = maker_between(&seed, 0.01, 7, 991) * (trial % 5 == 0 ? 1e-9 : 1);
            low[a] = origin[a] - 3 * spacing[a];
            high[a] = origin[a] + (dims[a] + 3) * spacing[a];
        }
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
        maker_clear(&mesh);
        for (int32_t t = 0; t < 80; t++) {
            double p[9];
            for (int i = 0; i < 9; i++) p[i] = low[i % 3] + (high[i % 3] - low[i % 3]) * ((double)maker_below(&seed, 1 << 30) / (1 << 30));
            maker_triangle(&mesh, maker_vertex(&mesh, p[0], p[1], p[2]), maker_vertex(&mesh, p[3], p[4], p[5]),
                           maker_vertex(&mesh, p[6], p[7], p[8]));
        }
        as_floats = trial % 2 && trial % 5;
        for (size_t i = 0; i < 3 * mesh.vertices && as_floats; i++) mesh.p[i] = (double)(float)mesh.p[i];
        assert_both_rules(&l);
    }
}

/* ---- Closed solids ---- */

/* A union of cubes at whole places is its own voxelization, whatever the diagonals of its faces. */
static void test_sets_of_cubes_are_their_own_solids(void)
{
    static const int32_t widths[] = {1, 63, 64, 65, 128};
    for (size_t w = 0; w < sizeof widths / sizeof widths[0]; w++)
        for (int32_t chance = 1; chance <= 3; chance++) {
            int32_t const n[3] = {widths[w], 9, 7};
            double const at[3] = {0, 0, 0};
            bvx_lattice const l = lattice_of(n[0], n[1], n[2]);
            size_t const count = (size_t)n[0] * 63;
            uint8_t *const solid = maker_grow(NULL, count);
            for (size_t i = 0; i < count; i++) solid[i] = maker_below(&seed, 4) < chance;
            maker_clear(&mesh);
            maker_cubes(&mesh, &seed, solid, n, at);
            for (int32_t fill = 0; fill < 2; fill++) {
                bvx_solid_report r;
                bvx_grid g = solid_by(ctx, &l, NULL, fill, &r);
                for (int32_t z = 0; z < n[2]; z++)
                    for (int32_t y = 0; y < n[1]; y++)
                        for (int32_t x = 0; x < n[0]; x++)
                            TEST_ASSERT_EQUAL_INT(maker_solid_at(solid, n, x, y, z), bvx_grid_get(&g, x, y, z));
                TEST_ASSERT_EQUAL_UINT64(0, r.unbalanced_rows);
                bvx_grid_free(ctx, &g);
            }
            assert_both_rules(&l);
            free(solid);
        }
}

static void star_at(double x, double y, double z, double radius, double jitter, int32_t steps)
{
    double const centre[3] = {x, y, z}, radii[3] = {radius, radius, radius};
    maker_star(&mesh, &seed, centre, radii, jitter, 7, 11, steps);
}

static void test_closed_solids_balance(void)
{
    for (int32_t trial = 0; trial < (quick ? 6 : 40); trial++) {
        bvx_lattice const l = lattice_of(70, 30, 30);
        int32_t const steps = trial % 3 == 0 ? 2 : trial % 3 == 1 ? 16 : 65536;
        maker_clear(&mesh);
        star_at(30, 15, 15, 13, 0.5, steps);
        if (trial % 2) star_at(33, 14, 16, 5, 0.5, steps);                                        /* nested or overlapping */
        if (trial % 4 > 1) maker_flip(&mesh, 0, mesh.triangles / (size_t)(1 + trial % 2)); /* whole shells inverted */
        if (trial % 5 == 0)
            for (size_t i = 0, n = mesh.triangles; i < n; i++) { /* every triangle twice, back to back */
                maker_duplicate(&mesh, i);
                maker_flip(&mesh, mesh.triangles - 1, mesh.triangles);
            }
        for (int32_t fill = 0; fill < 2; fill++) {
            bvx_solid_report r;
            bvx_grid g = solid_by(ctx, &l, NULL, fill, &r);
            TEST_ASSERT_EQUAL_UINT64(0, r.unbalanced_rows);
            bvx_grid_free(ctx, &g);
        }
        assert_both_rules(&l);
    }
}

static void test_spoiled_solids(void)
{
    for (int32_t trial = 0; trial < (quick ? 6 : 60); trial++) {
        bvx_lattice const l = lattice_of(50 + trial, 24, 26);
        maker_clear(&mesh);
        star_at(25, 12, 12, 11, 0.4, trial % 2 ? 2 : 65536);
        star_at(28, 12, 13, 6, 0.4, 4);
        for (int32_t i = 0; i < 1 + trial % 20; i++) {
            size_t const at = (size_t)maker_below(&seed, (int32_t)mesh.triangles);
            switch (maker_below(&seed, 3)) {
            case 0: maker_remove(&mesh, at); break;
            case 1: maker_flip(&mesh, at, at + 1); break;
            default: maker_duplicate(&mesh, at);
            }
        }
        assert_both_rules(&l);
    }
}

/* Space cut into tetrahedra, dealt out to four solids: none of them shares a voxel with another, none is left out. */
static void test_solids_that_share_faces_share_no_voxels(void)
{
    enum { N = 4, SOLIDS = 4 };
    static const int corner_orders[6][3] = {{1, 2, 4}, {2, 1, 4}, {1, 4, 2}, {4, 1, 2}, {2, 4, 1}, {4, 2, 1}};
    for (int32_t trial = 0; trial < (quick ? 4 : 30); trial++) {
        int32_t const steps = trial % 3 == 0 ? 2 : trial % 3 == 1 ? 8 : 65536;
        double const cell = 6, jitter = trial % 3 == 0 ? 1.5 : 1.0;
        int32_t const side = N * (int32_t)cell;
        bvx_lattice const l = lattice_of(side + 45, side + 2, side + 1);
        maker_mesh all = {0}, part[SOLIDS];
        bvx_grid g[SOLIDS];
        memset(part, 0, sizeof part);
        for (int32_t z = 0; z <= N; z++)
            for (int32_t y = 0; y <= N; y++)
                for (int32_t x = 0; x <= N; x++) {
                    int32_t const at[3] = {x, y, z};
                    double p[3];
                    for (int a = 0; a < 3; a++) {
                        p[a] = cell * at[a];
                        for (int b = 0; b < 3 && p[a] >= 0; b++)
                            if (at[b] == 0 || at[b] == N) goto fixed; /* the outer box stays */
                        p[a] += maker_between(&seed, -jitter, jitter, steps);
                    fixed:;
                    }
                    maker_vertex(&all, p[0], p[1], p[2]);
                }
        for (int s = 0; s < SOLIDS; s++)
            for (size_t i = 0; i < all.vertices; i++) maker_vertex(&part[s], all.p[3 * i], all.p[3 * i + 1], all.p[3 * i + 2]);
        for (int32_t z = 0; z < N; z++)
            for (int32_t y = 0; y < N; y++)
                for (int32_t x = 0; x < N; x++)
                    for (int o = 0; o < 6; o++) { /* from corner 0 to corner 7 along the axes in this order */
                        uint32_t const step[5] = {0, 1, N + 1, 0, (N + 1) * (N + 1)};
                        uint32_t v[4];
                        v[0] = (uint32_t)((z * (N + 1) + y) * (N + 1) + x);
                        for (int i = 0; i < 3; i++) v[i + 1] = v[i] + step[corner_orders[o][i]];
                        maker_tetrahedron(&part[maker_below(&seed, SOLIDS)], v[0], v[1], v[2], v[3]);
                    }
        for (int s = 0; s < SOLIDS; s++) {
            maker_mesh const kept = mesh;
            mesh = part[s];
            g[s] = solid_of(&l, trial % 2);
            mesh = kept;
        }
        for (int32_t z = 0; z < l.dims[2]; z++)
            for (int32_t y = 0; y < l.dims[1]; y++)
                for (int32_t x = 0; x < l.dims[0]; x++) {
                    int claims = 0;
                    for (int s = 0; s < SOLIDS; s++) claims += bvx_grid_get(&g[s], x, y, z);
                    TEST_ASSERT_EQUAL_INT(x < side && y < side && z < side, claims);
                }
        for (int s = 0; s < SOLIDS; s++) {
            bvx_grid_free(ctx, &g[s]);
            maker_free(&part[s]);
        }
        maker_free(&all);
    }
}

/* ---- What may not matter ---- */

static void test_shift_by_whole_voxels_shifts_the_bits(void)
{
    for (int32_t trial = 0; trial < (quick ? 6 : 40); trial++) {
        int32_t const by[3] = {maker_below(&seed, 70), maker_below(&seed, 5), maker_below(&seed, 5)};
        bvx_lattice const l = lattice_of(140, 20, 18);
        bvx_grid a, b;
        int32_t const n[3] = {60, 15, 13};
        make_random(trial % KINDS == HUGE ? MIXED : trial % KINDS, 60, n, 16);
        maker_shift(&mesh, 0, 3, 0, 0);
        a = solid_of(&l, trial % 2);
        maker_shift(&mesh, 0, by[0], by[1], by[2]);
        b = solid_of(&l, trial % 2);
        for (int32_t z = 0; z + by[2] < l.dims[2]; z++)
            for (int32_t y = 0; y + by[1] < l.dims[1]; y++)
                for (int32_t x = 0; x + by[0] < l.dims[0]; x++)
                    TEST_ASSERT_EQUAL_INT(bvx_grid_get(&a, x, y, z), bvx_grid_get(&b, x + by[0], y + by[1], z + by[2]));
        bvx_grid_free(ctx, &a);
        bvx_grid_free(ctx, &b);
    }
}

static void test_order_and_orientation_change_nothing(void)
{
    for (int32_t trial = 0; trial < (quick ? 8 : 60); trial++) {
        bvx_lattice const l = lattice_of(66, 14, 15);
        int32_t const fill = trial % 2;
        bvx_solid_report r, s;
        bvx_grid a, b;
        make_random(trial % KINDS, 100, l.dims, 16);
        a = solid_by(ctx, &l, NULL, fill, &r);
        maker_shuffle_triangles(&mesh, &seed);
        maker_shuffle_vertices(&mesh, &seed);
        b = solid_by(ctx, &l, NULL, fill, &s);
        assert_same_bits(&a, &b, "order");
        TEST_ASSERT_EQUAL_MEMORY(&r, &s, sizeof r);
        bvx_grid_free(ctx, &b);
        if (fill == BVX_FILL_PARITY)
            for (size_t i = 0; i < mesh.triangles; i++)
                if (maker_below(&seed, 2)) maker_flip(&mesh, i, i + 1);
        if (fill == BVX_FILL_PARITY) {
            b = solid_by(ctx, &l, NULL, fill, &s);
            assert_same_bits(&a, &b, "orientation");
            TEST_ASSERT_EQUAL_MEMORY(&r, &s, sizeof r);
            bvx_grid_free(ctx, &b);
        }
        bvx_grid_free(ctx, &a);
    }
}

/* Every window is a piece cut out of the whole. */
static void test_windows_are_cut_out_of_the_whole(void)
{
    uint64_t unbalanced[2] = {0, 0};
    for (int32_t trial = 0; trial < (quick ? 6 : 40); trial++) {
        bvx_lattice const l = lattice_of(130, 19, 17);
        for (int32_t fill = 0; fill < 2; fill++) {
            bvx_solid_report r;
            bvx_grid whole;
            if (fill == 0) make_random(trial % KINDS, 150, l.dims, 16);
            whole = solid_by(ctx, &l, NULL, fill, &r);
            unbalanced[fill] += r.unbalanced_rows;
            for (int32_t n = 0; n < 12; n++) {
                bvx_window w;
                bvx_grid part;
                for (int a = 0; a < 3; a++) {
                    int32_t const most = l.dims[a];
                    w.size[a] = n == 0 ? 1 : n == 1 ? most : 1 + maker_below(&seed, most);
                    w.low[a] = maker_below(&seed, most - w.size[a] + 1);
                }
                part = solid_by(ctx, &l, &w, fill, NULL);
                for (int32_t z = 0; z < w.size[2]; z++)
                    for (int32_t y = 0; y < w.size[1]; y++)
                        for (int32_t x = 0; x < w.size[0]; x++)
                            if (bvx_grid_get(&part, x, y, z) != bvx_grid_get(&whole, x + w.low[0], y + w.low[1], z + w.low[2]))
                                TEST_FAIL_MESSAGE("a window's voxel differs from the whole's");
                bvx_grid_free(ctx, &part);
            }
            bvx_grid_free(ctx, &whole);
        }
    }
    TEST_ASSERT_TRUE(unbalanced[0] > 100 && unbalanced[1] > 100);
}

/* 1 to 8 threads, portable code and the fastest: bits and counts. */
static void assert_all_contexts_agree(const bvx_lattice *l)
{
    for (int32_t fill = 0; fill < 2; fill++) {
        bvx_solid_report r, s;
        bvx_grid a = solid_by(ctx, l, NULL, fill, &r);
        for (int32_t n = 1; n <= 10; n++) {
            bvx_context *const c = context_with(n <= 8 ? n : n - 8, n <= 8 ? BVX_CPU_BEST : BVX_CPU_PORTABLE);
            bvx_grid b = solid_by(c, l, NULL, fill, &s);
            assert_same_bits(&a, &b, "threads or code path");
            TEST_ASSERT_EQUAL_MEMORY(&r, &s, sizeof r);
            bvx_grid_free(c, &b);
            bvx_context_destroy(c);
        }
        bvx_grid_free(ctx, &a);
    }
}

static void test_threads_and_code_paths_agree(void)
{
    for (int32_t kind = 0; kind < KINDS; kind++) {
        bvx_lattice const l = lattice_of(129, 40, 37);
        int32_t const cheap = kind == NEEDLES || kind == DEGENERATE || kind == TINY; /* enough for many chunks */
        make_random(kind, (cheap ? 20000 : 300) / (quick ? 4 : 1), l.dims, 16);
        assert_all_contexts_agree(&l);
    }
}

/* ---- Volume of work: more than one round's buffers hold ---- */

static void test_rounds_of_small_triangles(void)
{
    bvx_lattice const l = lattice_of(40, 33, 34);
    maker_clear(&mesh);
    for (int32_t i = 0; i < (quick ? 3000 : 12000); i++) { /* about four crossings each: many times 8192 */
        double const x = maker_below(&seed, 40), y = maker_below(&seed, 33), z = maker_below(&seed, 34);
        double const u = maker_between(&seed, 3.5, 3.99, 65536), v = maker_between(&seed, 1.5, 1.99, 65536);
        uint32_t const a = maker_vertex(&mesh, x, y, z), b = maker_vertex(&mesh, x + 3, y + u, z), c = maker_vertex(&mesh, x - 2, y, z + v);
        maker_triangle(&mesh, a, i % 2 ? b : c, i % 2 ? c : b);
    }
    assert_both_rules(&l);
}

static void test_rounds_of_large_triangles(void)
{
    bvx_lattice const l = lattice_of(40, 35, 36);
    make_random(SOUP, quick ? 1500 : 4000, l.dims, 16);
    assert_both_rules(&l);
    make_random(SOUP, 1500, l.dims, 16);
    assert_all_contexts_agree(&l);
}

static void test_rounds_of_many_chunks(void)
{
    bvx_lattice const l = lattice_of(128, 120, 120);
    double const centre[3] = {64, 60, 60}, radius[3] = {60, 59, 58}, inner[3] = {40, 39, 38};
    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, radius, 0.02, quick ? 60 : 300, quick ? 100 : 460, 65536);
    maker_star(&mesh, &seed, centre, inner, 0.02, quick ? 12 : 60, quick ? 20 : 91, 65536);
    assert_both_rules(&l);
    maker_remove(&mesh, mesh.triangles / 2);
    maker_remove(&mesh, mesh.triangles / 3);
    assert_all_contexts_agree(&l);
}

/* More rows along an axis than a block has. */
static void test_more_rows_than_a_block_holds(void)
{
    for (int axis = 1; axis < 3; axis++) {
        int32_t dims[3] = {3, 1, 1};
        bvx_lattice l;
        dims[axis] = 140000;
        l = lattice_of(dims[0], dims[1], dims[2]);
        make_random(SOUP, 40, dims, l.fraction_bits);
        assert_both_rules(&l);
    }
}

/* ---- Views ---- */

static void test_all_kinds_of_view_give_the_same_bits(void)
{
    bvx_lattice const l = lattice_of(65, 12, 13);
    bvx_grid want, got;
    size_t const most = 400;
    unsigned char *const positions = maker_grow(NULL, most * 3 * 64 + 64), *const indices = maker_grow(NULL, most * 64 + 64);
    make_random(SOUP, 60, l.dims, 8); /* exact in floats too */
    want = solid_of(&l, BVX_FILL_PARITY);
    for (int32_t variant = 0; variant < 2 * 4 * 3 * 3; variant++) {
        int const f32 = variant % 2, index = variant / 2 % 4, stride = variant / 8 % 3, offset = variant / 24 % 3;
        size_t const point = f32 ? 12 : 24, three = index == 0 ? 0 : (size_t)3 << index;
        size_t const point_stride = point + (stride == 0 ? 0 : stride == 1 ? 4 : 13);
        size_t const three_stride = three + (stride == 0 ? 0 : stride == 1 ? 8 : 7);
        bvx_mesh_view v = maker_view(&mesh);
        unsigned char *const p0 = positions + offset, *const t0 = indices + 2 * offset + (offset == 2);
        size_t const vertices = index == 0 ? 3 * mesh.triangles : mesh.vertices;
        memset(positions, 0xA7, most * 3 * 64 + 64);
        memset(indices, 0xA7, most * 64 + 64);
        for (size_t i = 0; i < vertices; i++)
            for (size_t a = 0; a < 3; a++) {
                double const d = mesh.p[3 * (index == 0 ? mesh.t[i] : i) + a];
                float const f = (float)d;
                if (f32) memcpy(p0 + i * point_stride + 4 * a, &f, 4);
                else memcpy(p0 + i * point_stride + 8 * a, &d, 8);
            }
        for (size_t i = 0; i < mesh.triangles && index != 0; i++)
            for (size_t c = 0; c < 3; c++) {
                uint32_t const n = mesh.t[3 * i + c];
                uint16_t const n16 = (uint16_t)n;
                uint64_t const n64 = n;
                unsigned char *const to = t0 + i * three_stride;
                if (index == BVX_U16) memcpy(to + 2 * c, &n16, 2);
                else if (index == BVX_U32) memcpy(to + 4 * c, &n, 4);
                else memcpy(to + 8 * c, &n64, 8);
            }
        v.positions = p0;
        v.position_type = f32 ? BVX_F32 : BVX_F64;
        v.position_stride = stride == 0 ? 0 : (uint32_t)point_stride;
        v.vertex_count = vertices;
        v.indices = index == 0 ? NULL : t0;
        v.index_type = (uint32_t)index;
        v.index_stride = stride == 0 || index == 0 ? 0 : (uint32_t)three_stride;
        memset(&got, 0, sizeof got);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, fill_with(ctx, &v, &l, NULL, BVX_FILL_PARITY, &got, NULL), bvx_last_message(ctx));
        assert_same_bits(&want, &got, "view");
        bvx_grid_free(ctx, &got);
    }
    bvx_grid_free(ctx, &want);
    free(positions);
    free(indices);
}

/* ---- Refusals ---- */

static bvx_grid untouched; /* stays empty */

static void assert_refused(const bvx_lattice *l, const bvx_window *window, bvx_status status, const char *text)
{
    float *floats;
    bvx_mesh_view const view = mesh_view(&floats);
    bvx_grid const empty = {0};
    uint64_t const held = bvx_memory_used(ctx);
    for (int32_t fill = 0; fill < 2; fill++) {
        bvx_solid_report report;
        TEST_ASSERT_EQUAL_INT32(status, fill_with(ctx, &view, l, window, fill, &untouched, &report));
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), text), bvx_last_message(ctx));
        TEST_ASSERT_NULL(strchr(bvx_last_message(ctx), '\n'));
        TEST_ASSERT_EQUAL_MEMORY(&empty, &untouched, sizeof empty);
        TEST_ASSERT_EQUAL_UINT64(held, bvx_memory_used(ctx));
    }
    free(floats);
}

static void test_bad_vertices_are_named_only_when_used(void)
{
    bvx_lattice const l = lattice_of(65, 12, 13);
    double const bad[5] = {nan(""), HUGE_VAL, -HUGE_VAL, 1e30, -16400};
    static const size_t places[6] = {0, 63, 64, 130, 179, 199};
    for (int32_t trial = 0; trial < 2 * 6 * 3 * 5; trial++) {
        size_t const at = places[trial / 2 % 6];
        int const a = trial / 12 % 3, i = trial / 36;
        char name[60];
        bvx_grid want, got;
        make_random(SOUP, 60, l.dims, 8); /* exact in floats too */
        for (int n = 0; n < 20; n++) maker_vertex(&mesh, 1, 2, 3); /* used by none */
        if (at < 180) mesh.t[at] = (uint32_t)(at + 1) % 180;
        as_floats = trial % 2;
        want = solid_of(&l, BVX_FILL_PARITY);
        mesh.p[3 * at + (size_t)a] = bad[i];
        got = solid_of(&l, BVX_FILL_PARITY);
        assert_same_bits(&want, &got, "an unused vertex");
        bvx_grid_free(ctx, &got);
        bvx_grid_free(ctx, &want);
        mesh.t[3 * 41 + 1] = (uint32_t)at;
        mesh.t[3 * 57 + 2] = (uint32_t)at;
        snprintf(name, sizeof name, "vertex %lu ", (unsigned long)at);
        assert_refused(&l, NULL, BVX_ERR_RANGE, name);
        assert_refused(&l, NULL, BVX_ERR_RANGE, i < 3 ? "triangle 41)" : "fraction bits");
        assert_refused(&l, NULL, BVX_ERR_RANGE, i < 3 ? "not finite" : "16384"); /* says what would fit */
    }
}

/* |q| < 2^30: the last coordinates that fit, and the first that do not. */
static void test_ends_of_the_fixed_point(void)
{
    bvx_lattice const l = lattice_of(8, 8, 8);
    double const most = 16384.0 - 1.0 / 65536;
    for (int a = 0; a < 3; a++)
        for (int sign = -1; sign <= 1; sign += 2) {
            double const low[3] = {1, 1, 1}, high[3] = {6, 6, 6};
            maker_clear(&mesh);
            maker_box(&mesh, low, high);
            mesh.p[a] = sign * most;
            assert_both_rules(&l);
            mesh.p[a] = sign * 16384.0;
            assert_refused(&l, NULL, BVX_ERR_RANGE, "vertex 0");
            mesh.p[a] = sign * (16384.0 - 0.25 / 65536); /* rounds to 2^30 */
            assert_refused(&l, NULL, BVX_ERR_RANGE, "vertex 0");
        }
}

static void test_bad_indices_name_the_triangle(void)
{
    static const uint32_t bad[3] = {180, 181, UINT32_MAX};
    bvx_lattice const l = lattice_of(65, 12, 13);
    make_random(SOUP, 60, l.dims, 16);
    TEST_ASSERT_EQUAL_UINT64(180, mesh.vertices);
    for (size_t c = 0; c < 3; c++)
        for (int i = 0; i < 3; i++) {
            uint32_t const kept = mesh.t[3 * 37 + c];
            mesh.t[3 * 37 + c] = bad[i];
            assert_refused(&l, NULL, BVX_ERR_RANGE, "triangle 37");
            mesh.t[3 * 37 + c] = kept;
        }
    {
        uint64_t wide[180]; /* indices of 64 bits are not cut short */
        bvx_mesh_view v = maker_view(&mesh);
        for (int i = 0; i < 180; i++) wide[i] = mesh.t[i];
        wide[3 * 20 + 2] += UINT64_C(1) << 32;
        v.indices = wide;
        v.index_type = BVX_U64;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, fill_with(ctx, &v, &l, NULL, BVX_FILL_PARITY, &untouched, NULL));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "triangle 20"));
    }
    make_random(SOUP, 30000, l.dims, 16); /* of several, one is named, and the same whatever the threads */
    for (size_t t = 29999; t > 400; t -= 997) mesh.t[3 * t] = UINT32_MAX;
    assert_refused(&l, NULL, BVX_ERR_RANGE, "vertex number 4294967295");
    {
        bvx_mesh_view const v = maker_view(&mesh);
        for (int32_t threads = 2; threads <= 4; threads++) {
            bvx_context *const c = context_with(threads, BVX_CPU_BEST);
            TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, fill_with(c, &v, &l, NULL, BVX_FILL_NONZERO, &untouched, NULL));
            TEST_ASSERT_EQUAL_STRING(bvx_last_message(ctx), bvx_last_message(c));
            bvx_context_destroy(c);
        }
    }
}

static void test_refusals_of_arguments(void)
{
    bvx_lattice l = lattice_of(10, 12, 13);
    bvx_window const outside[5] = {{{0, 0, 0}, {11, 12, 13}}, {{-1, 0, 0}, {5, 5, 5}}, {{0, 0, 9}, {1, 1, 5}}, {{0, 3, 0}, {1, 0, 1}},
                                   {{INT32_MAX, 0, 0}, {INT32_MAX, 1, 1}}};
    bvx_mesh_view v;
    bvx_voxelize_options o;
    bvx_voxelize_options_init(&o, sizeof o);
    make_random(SOUP, 10, l.dims, 16);
    v = maker_view(&mesh);
    for (int i = 0; i < 5; i++) assert_refused(&l, &outside[i], BVX_ERR_RANGE, "window");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(NULL, &v, &l, NULL, &untouched));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, NULL, &l, NULL, &untouched));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &v, NULL, NULL, &untouched));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &v, &l, NULL, NULL));
    o.fill = 2;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &v, &l, &o, &untouched));
    o.fill = -1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &v, &l, &o, &untouched));
    o.fill = 0;
    o.reserved = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &v, &l, &o, &untouched));
    o.reserved = 0;
    o.struct_size = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_voxelize_solid(ctx, &v, &l, &o, &untouched));
    l.spacing[1] = 0;
    assert_refused(&l, NULL, BVX_ERR_ARGUMENT, "spacing");
    l.spacing[1] = 1;
    l.fraction_bits = 17;
    assert_refused(&l, NULL, BVX_ERR_ARGUMENT, "fraction");
    l.fraction_bits = 16;
    l.dims[2] = 0;
    assert_refused(&l, NULL, BVX_ERR_RANGE, "voxels");
    l.dims[2] = 13;
    mesh.triangles = 0;
    assert_refused(&l, NULL, BVX_ERR_EMPTY, "no triangles");
    l = lattice_of(1 << 25, 1 << 25, 1 << 25);
    make_random(SOUP, 10, outside[1].size, 4);
    assert_refused(&l, NULL, BVX_ERR_RANGE, "64 bits");
}

/* ---- Arrays of the caller's ---- */

static void test_callers_array_is_filled_in_place(void)
{
    bvx_lattice const l = lattice_of(70, 5, 6);
    bvx_window const w = {{3, 1, 2}, {66, 3, 4}};
    uint64_t words[40];
    bvx_mesh_view v;
    make_random(SOUP, 60, l.dims, 16);
    v = maker_view(&mesh);
    for (int32_t fill = 0; fill < 2; fill++) {
        bvx_grid want = solid_by(ctx, &l, &w, fill, NULL), g = {0};
        memset(words, 0xEE, sizeof words);
        g.words = words + 1;
        g.word_capacity = 23;
        TEST_ASSERT_EQUAL_INT32(BVX_ERR_CAPACITY, fill_with(ctx, &v, &l, &w, fill, &g, NULL));
        TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "24 words"));
        for (int i = 0; i < 40; i++) TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xEEEEEEEEEEEEEEEE), words[i]);
        for (uint64_t capacity = 24; capacity <= 38; capacity += 14) {
            memset(words, 0xEE, sizeof words);
            memset(&g, 0, sizeof g);
            g.words = words + 1;
            g.word_capacity = capacity;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, fill_with(ctx, &v, &l, &w, fill, &g, NULL));
            TEST_ASSERT_EQUAL_PTR(words + 1, g.words);
            TEST_ASSERT_EQUAL_UINT64(capacity, g.word_capacity);
            TEST_ASSERT_EQUAL_INT32(0, g.owned);
            assert_same_bits(&want, &g, "the caller's array");
            TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xEEEEEEEEEEEEEEEE), words[0]);
            for (int i = 25; i < 40; i++) TEST_ASSERT_EQUAL_HEX64(UINT64_C(0xEEEEEEEEEEEEEEEE), words[i]);
        }
        bvx_grid_free(ctx, &want);
    }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_box_on_voxel_planes_fills_its_voxels);
    RUN_TEST(test_box_on_centres_is_half_open);
    RUN_TEST(test_report_by_hand);
    RUN_TEST(test_rows_by_hand);
    RUN_TEST(test_random_meshes_at_all_widths);
    RUN_TEST(test_random_meshes_on_flat_lattices);
    RUN_TEST(test_random_meshes_with_all_fraction_bits);
    RUN_TEST(test_long_lattices_through_windows);
    RUN_TEST(test_extreme_triangles);
    RUN_TEST(test_planes_through_centres);
    RUN_TEST(test_crossings_a_hair_from_a_centre);
    RUN_TEST(test_crossings_as_near_to_a_centre_as_can_be);
    RUN_TEST(test_edges_a_hair_from_a_centre);
    RUN_TEST(test_snapping_of_arbitrary_coordinates);
    RUN_TEST(test_sets_of_cubes_are_their_own_solids);
    RUN_TEST(test_closed_solids_balance);
    RUN_TEST(test_spoiled_solids);
    RUN_TEST(test_solids_that_share_faces_share_no_voxels);
    RUN_TEST(test_shift_by_whole_voxels_shifts_the_bits);
    RUN_TEST(test_order_and_orientation_change_nothing);
    RUN_TEST(test_windows_are_cut_out_of_the_whole);
    RUN_TEST(test_threads_and_code_paths_agree);
    RUN_TEST(test_rounds_of_small_triangles);
    RUN_TEST(test_rounds_of_large_triangles);
    RUN_TEST(test_rounds_of_many_chunks);
    RUN_TEST(test_more_rows_than_a_block_holds);
    RUN_TEST(test_all_kinds_of_view_give_the_same_bits);
    RUN_TEST(test_bad_vertices_are_named_only_when_used);
    RUN_TEST(test_ends_of_the_fixed_point);
    RUN_TEST(test_bad_indices_name_the_triangle);
    RUN_TEST(test_refusals_of_arguments);
    RUN_TEST(test_callers_array_is_filled_in_place);
    return UNITY_END();
}
