/* test_field_signs.c - the sign rules of distance fields against solids,
 * shapes whose inside is known, and each other. */
#include "field_support.h"

/* Exact doubles keep outlines of the wedge on the fixed-point lattice. */
static const double wedge[7][2] = {{1, 1}, {19, 1}, {19, 2}, {5, 4}, {19, 13}, {17, 14}, {1, 5}};
static const uint32_t wedge_cut[5][3] = {{0, 1, 2}, {0, 2, 3}, {0, 3, 6}, {3, 4, 5}, {3, 5, 6}};

static void add_star(const bvx_lattice *l, double jitter)
{
    double centre[3], radius[3];
    for (int a = 0; a < 3; a++) {
        double const side = l->dims[a] * l->spacing[a];
        centre[a] = l->origin[a] + maker_between(&seed, 0.4 * side, 0.6 * side, 4096);
        radius[a] = maker_between(&seed, 0.2 * side, 0.4 * side, 4096);
    }
    maker_star(&mesh, &seed, centre, radius, jitter, 4 + maker_below(&seed, 4), 5 + maker_below(&seed, 5),
               65536);
}

static bvx_grid solid_of(const bvx_lattice *l, int32_t fill)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_voxelize_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};
    o.fill = fill;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_voxelize_solid(ctx, &view, l, &o, &g), bvx_last_message(ctx));
    return g;
}

/* Distances are negative where the field is inside, and nowhere else (-0 counts as negative). */
static void assert_signs_agree(const bvx_field *f)
{
    for (int32_t z = 0; z < f->band.size[2]; z++)
        for (int32_t y = 0; y < f->band.size[1]; y++)
            for (int32_t x = 0; x < f->band.size[0]; x++) {
                uint64_t const n = bvx_field_value(f, x, y, z);
                if (n == UINT64_MAX) continue;
                TEST_ASSERT_EQUAL_INT(f->inside.words != NULL && bvx_grid_get(&f->inside, x, y, z),
                                      signbit(number_at(f, f->distances, n)) != 0);
            }
}

/* ---- solids ---- */

static void assert_is_solid(const bvx_lattice *l, int32_t sign, int32_t fill)
{
    bvx_field f = field_of(l, 1.5, sign);
    bvx_grid solid = solid_of(l, fill);
    TEST_ASSERT_TRUE(same_bits(&solid, &f.inside));
    assert_signs_agree(&f);
    bvx_grid_free(ctx, &solid);
    bvx_field_free(ctx, &f);
}

static void test_exact_vote_and_winding_are_the_solids(void)
{
    for (int trial = 0; trial < (quick ? 3 : 12); trial++) {
        bvx_lattice const l = lattice_with(0.5, -1, 0, 1, trial & 1 ? 0.5 : 1, trial & 2 ? 2 : 1, 70, 20, 18);
        maker_clear(&mesh);
        add_star(&l, 0.4);
        if (trial & 1) add_star(&l, 0.4);
        for (int i = 0; i < trial / 4; i++)
            maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles));
        if (trial / 4 == 2) maker_flip(&mesh, 3, 9);
        assert_is_solid(&l, BVX_FILL_PARITY, BVX_FILL_PARITY);
        assert_is_solid(&l, BVX_FILL_VOTE, BVX_FILL_VOTE);
        assert_is_solid(&l, BVX_FILL_WINDING, BVX_FILL_WINDING);
    }
}

static void test_auto_looks_at_the_mesh(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 20, 20, 20);

    static const struct {
        int holes, flips, apart;
        int32_t sign;
    } want[] = {{0, 0, 0, BVX_FILL_PARITY},  {0, 0, 1, BVX_FILL_PARITY}, {1, 0, 1, BVX_FILL_WINDING},
                {1, 0, 0, BVX_FILL_WINDING}, {0, 1, 0, BVX_FILL_PARITY}, {1, 1, 1, BVX_FILL_WINDING}};
    for (size_t i = 0; i < sizeof want / sizeof want[0]; i++) {
        bvx_field f;
        maker_clear(&mesh);
        add_star(&l, 0.2);
        if (want[i].holes) maker_remove(&mesh, 11);
        if (want[i].flips) maker_flip(&mesh, 3, 4);
        if (want[i].apart) take_apart();
        f = field_of(&l, 2, BVX_FILL_AUTO);
        TEST_ASSERT_EQUAL_INT32(want[i].sign, f.sign);
        bvx_field_free(ctx, &f);
    }
}

static void test_no_sign(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 20, 20, 20);
    bvx_field f;

    add_star(&l, 0.2);
    f = field_of(&l, 2, BVX_FILL_NONE);
    TEST_ASSERT_NULL(f.inside.words);
    TEST_ASSERT_EQUAL_INT32(BVX_FILL_NONE, f.sign);
    assert_signs_agree(&f);
    bvx_field_free(ctx, &f);
}

/* ---- shapes ---- */

typedef int shape_fn(const double p[3]); /* 1 inside, 0 outside, -1 too near to tell */

static int near_zero(double v)
{
    return fabs(v) < 1e-3;
}

static int in_box(const double p[3])
{
    static const double low[3] = {3.25, 2.75, 4.125}, high[3] = {15.5, 16, 11.875};
    int inside = 1;
    for (int a = 0; a < 3; a++) {
        if (near_zero(p[a] - low[a]) || near_zero(p[a] - high[a])) return -1;
        inside &= p[a] > low[a] && p[a] < high[a];
    }
    return inside;
}

static int in_hollow_box(const double p[3])
{
    static const double low[3] = {6, 6, 6}, high[3] = {12, 13, 10};
    int const outer = in_box(p);
    int inner = 1;

    for (int a = 0; a < 3; a++) {
        if (near_zero(p[a] - low[a]) || near_zero(p[a] - high[a])) return -1;
        inner &= p[a] > low[a] && p[a] < high[a];
    }
    return outer == -1 ? -1 : outer && !inner;
}

static int in_wedge(const double p[3])
{
    int inside = 0;

    if (near_zero(p[2] - 4) || near_zero(p[2] - 14)) return -1;
    for (int i = 0; i < 7; i++) {
        const double *const a = wedge[i], *const b = wedge[(i + 1) % 7];
        double const along = ((p[0] - a[0]) * (b[0] - a[0]) + (p[1] - a[1]) * (b[1] - a[1])) /
                             ((b[0] - a[0]) * (b[0] - a[0]) + (b[1] - a[1]) * (b[1] - a[1]));
        double const t = along < 0 ? 0 : along > 1 ? 1 : along;
        double const x = a[0] + t * (b[0] - a[0]) - p[0], y = a[1] + t * (b[1] - a[1]) - p[1];
        if (near_zero(x * x + y * y)) return -1;
        if ((a[1] > p[1]) != (b[1] > p[1]) && p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0]))
            inside = !inside;
    }
    return inside && p[2] > 4 && p[2] < 14;
}

static int in_sphere(const double p[3])
{
    static const double centre[3] = {10, 9.5, 9};
    double const v[3] = {p[0] - centre[0], p[1] - centre[1], p[2] - centre[2]}, d = sqrt(dot3(v, v)) - 7;
    return d < 0.01 && d > -0.1 ? -1 : d < 0; /* facets cut off at most 7 (1 - cos(pi / 40) cos(pi / 60)) */
}

static int in_torus(const double p[3])
{
    double const ring = sqrt((p[0] - 10) * (p[0] - 10) + (p[1] - 10) * (p[1] - 10)) - 6;
    double const d = sqrt(ring * ring + (p[2] - 9) * (p[2] - 9) / 1.44) - 2.5;
    return fabs(d) < 0.1 ? -1 : d < 0;
}

static void make_shape(int shape)
{
    static const double low[3] = {3.25, 2.75, 4.125};
    static const double high[3] = {15.5, 16, 11.875};
    static const double inner_low[3] = {6, 6, 6};
    static const double inner_high[3] = {12, 13, 10};
    static const double sphere[3] = {10, 9.5, 9}, torus[3] = {10, 10, 9};

    maker_clear(&mesh);
    if (shape <= 1) maker_box(&mesh, low, high);
    if (shape == 1) {
        size_t const first = mesh.triangles;
        maker_box(&mesh, inner_low, inner_high);
        maker_flip(&mesh, first, mesh.triangles);
    }
    if (shape == 2) add_prism(wedge, 7, wedge_cut, 5, 4, 14);
    if (shape == 3) add_sphere(sphere, 7, 40, 60);
    if (shape == 4) add_torus(torus, 6, 2.5, 1.2, 80, 50);
}

static uint64_t wrong_signs(const bvx_field *f, shape_fn *shape)
{
    uint64_t wrong = 0;

    for (int32_t z = 0; z < f->inside.size[2]; z++)
        for (int32_t y = 0; y < f->inside.size[1]; y++)
            for (int32_t x = 0; x < f->inside.size[0]; x++) {
                double c[3];
                int want;
                centre_of(&f->inside, x, y, z, c);
                want = shape(c);
                wrong += want >= 0 && want != bvx_grid_get(&f->inside, x, y, z);
            }
    return wrong;
}

static void test_shapes_that_are_known(void)
{
    static shape_fn *const shapes[] = {in_box, in_hollow_box, in_wedge, in_sphere, in_torus};
    static const int32_t rules[] = {BVX_FILL_PARITY, BVX_FILL_WINDING, BVX_FILL_VOTE};
    static const double widths[] = {0.9, 3, HUGE_VAL};
    bvx_lattice const fine[2] = {lattice_with(0, 0, 0, 0.5, 0.5, 0.5, 40, 40, 36),
                                 lattice_with(-0.25, 0.125, 0, 1, 0.5, 0.75, 21, 40, 24)};

    for (int shape = 0; shape < 5; shape++)
        for (int i = 0; i < 2; i++)
            for (int apart = 0; apart < 2; apart++) {
                make_shape(shape);
                if (apart) take_apart();
                for (int r = 0; r < 3; r++)
                    for (int w = 0; w < (quick ? 1 : 3); w++) {
                        bvx_field f = field_of(&fine[i], widths[w], rules[r]);
                        char text[100];
                        snprintf(text, sizeof text, "shape %d, rule %d, width %g", shape, (int)rules[r],
                                 widths[w]);
                        TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, wrong_signs(&f, shapes[shape]), text);
                        TEST_ASSERT_TRUE_MESSAGE(set_in(&f.inside) > 1000, text);
                        assert_signs_agree(&f);
                        bvx_field_free(ctx, &f);
                    }
            }
}

/* Faces that lie on centres: the centres count as moved, as in solids;
 * those on edges and corners are left out. */
static void test_faces_on_centres(void)
{
    static const double low[3] = {2.5, 3.5, 1.5}, high[3] = {9.5, 8.5, 7.5};
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 12, 12, 10);
    bvx_grid solid;

    maker_box(&mesh, low, high);
    solid = solid_of(&l, BVX_FILL_PARITY);
    bvx_field f = field_of(&l, 1.5, BVX_FILL_NORMAL);
    for (int32_t z = 0; z < 10; z++)
        for (int32_t y = 0; y < 12; y++)
            for (int32_t x = 0; x < 12; x++) {
                int const sides = (x == 2 || x == 9) + (y == 3 || y == 8) + (z == 1 || z == 7);
                if (sides > 1) continue;
                TEST_ASSERT_EQUAL_INT(bvx_grid_get(&solid, x, y, z), bvx_grid_get(&f.inside, x, y, z));
            }
    assert_signs_agree(&f);
    bvx_field_free(ctx, &f);
    bvx_grid_free(ctx, &solid);
}

/* ---- the paper's rule and its weakness ---- */

/* A blade with a sharp edge at x = 4: in front of it both triangles at the edge are equally close, and the
 * plane of either has centres behind it that are outside. */
static void test_normals_are_wrong_at_a_sharp_edge(void)
{
    static const double blade[3][2] = {{4, 8}, {16, 7}, {16, 9}};
    static const uint32_t cut[1][3] = {{0, 1, 2}};
    bvx_lattice const l = lattice_with(0, 0, 0, 0.5, 0.5, 0.5, 40, 32, 24);
    bvx_field normal;
    uint64_t wrong = 0;

    add_prism(blade, 3, cut, 1, 2, 10);
    normal = field_of(&l, 4, BVX_FILL_NORMAL);
    for (int32_t z = 4; z < 20; z++)
        for (int32_t y = 0; y < 32; y++)
            for (int32_t x = 0; x < 8; x++) /* before the edge: all outside */
                wrong += (uint64_t)bvx_grid_get(&normal.inside, x, y, z);
    TEST_ASSERT_TRUE_MESSAGE(wrong > 100, "the plane of the closest triangle was right everywhere");
    bvx_field_free(ctx, &normal);
}

static void test_normals_are_right_where_faces_are_closest(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 0.5, 0.5, 0.5, 40, 40, 36);
    bvx_field f;

    make_shape(0);
    f = field_of(&l, HUGE_VAL, BVX_FILL_NORMAL);
    for (int32_t z = 0; z < 36; z++)
        for (int32_t y = 0; y < 40; y++)
            for (int32_t x = 0; x < 40; x++) {
                double c[3];
                centre_of(&f.band, x, y, z, c);
                /* an inner diagonal is an edge too */
                if (in_box(c) < 0 || f.features[bvx_field_value(&f, x, y, z)] > 3) continue;
                if (f.features[bvx_field_value(&f, x, y, z)] == 0)
                    TEST_ASSERT_EQUAL_INT(in_box(c), bvx_grid_get(&f.inside, x, y, z));
            }
    bvx_field_free(ctx, &f);
}

/* ---- beyond the band ---- */

/* The definition, voxel by voxel: what is next to the known of one side
 * alone takes it, of both sides is outside. */
static void slow_fronts(const bvx_field *f, uint8_t *side) /* 0 not known, 1 outside, 2 inside */
{
    const int32_t *const n = f->band.size;
    size_t const all = (size_t)n[0] * (size_t)n[1] * (size_t)n[2];
    size_t const step[3] = {1, (size_t)n[0], (size_t)n[0] * (size_t)n[1]};
    uint8_t *const next = maker_grow(NULL, all);

    for (size_t i = 0; i < all; i++) {
        int32_t const x = (int32_t)(i % step[1]);
        int32_t const y = (int32_t)(i / step[1] % (size_t)n[1]);
        int32_t const z = (int32_t)(i / step[2]);
        side[i] = !bvx_grid_get(&f->band, x, y, z) ? 0 : bvx_grid_get(&f->inside, x, y, z) ? 2 : 1;
    }
    for (int changed = 1; changed;) {
        changed = 0;
        memcpy(next, side, all);
        for (size_t i = 0; i < all; i++) {
            int32_t const at[3] = {(int32_t)(i % step[1]), (int32_t)(i / step[1] % (size_t)n[1]),
                                   (int32_t)(i / step[2])};
            int seen = 0;
            if (side[i] != 0) continue;
            for (int a = 0; a < 3; a++) {
                if (at[a] > 0) seen |= side[i - step[a]];
                if (at[a] + 1 < n[a]) seen |= side[i + step[a]];
            }
            if (seen == 0) continue;
            next[i] = seen == 2 ? 2 : 1;
            changed = 1;
        }
        memcpy(side, next, all);
    }
    free(next);
}

static void assert_fronts(const bvx_field *f)
{
    uint8_t *const side = maker_grow(NULL, (size_t)f->band.size[0] * (size_t)f->band.size[1] *
                                               (size_t)f->band.size[2]);
    size_t i = 0;

    slow_fronts(f, side);
    for (int32_t z = 0; z < f->band.size[2]; z++)
        for (int32_t y = 0; y < f->band.size[1]; y++)
            for (int32_t x = 0; x < f->band.words_per_row * 64; x++) {
                if (x >= f->band.size[0]) TEST_ASSERT_EQUAL_INT(0, bvx_grid_get(&f->inside, x, y, z));
                else TEST_ASSERT_EQUAL_INT(side[i++] == 2, bvx_grid_get(&f->inside, x, y, z));
            }
    free(side);
}

static void test_fronts_meet_in_holes(void)
{
    static const int32_t shapes[][3] = {{40, 30, 28},  {65, 20, 21}, {64, 18, 18},
                                        {129, 12, 14}, {3, 40, 40},  {40, 2, 40}};

    for (int trial = 0; trial < (quick ? 4 : 18); trial++) {
        const int32_t *const n = shapes[trial % 6];
        bvx_lattice const l = lattice_with(0, 0, 0, 1, trial & 1 ? 1 : 0.75, 1, n[0], n[1], n[2]);
        bvx_field f;
        maker_clear(&mesh);
        add_star(&l, 0.3);
        if (trial % 3 != 0) /* a large hole */
            for (int i = 0; i < trial; i++)
                maker_remove(&mesh, (size_t)maker_below(&seed, (int32_t)mesh.triangles / 2));
        f = field_of(&l, trial % 3 == 2 ? 1.75 : 1, BVX_FILL_NORMAL);
        assert_fronts(&f);
        bvx_field_free(ctx, &f);
    }
}

/* Bands thinner than a voxel hold the signs of one that is wide enough. */
static void test_thin_bands_have_the_signs_of_wide_ones(void)
{
    static const double widths[] = {1e-9, 0.3, 0.99};

    for (int shape = 0; shape < 5; shape++) {
        bvx_lattice const l = lattice_with(0, 0, 0, 0.5, 0.75, 1, 40, 26, 18);
        bvx_field wide;
        make_shape(shape);
        wide = field_of(&l, 1, BVX_FILL_NORMAL);
        for (int w = 0; w < 3; w++) {
            bvx_field f = field_of(&l, widths[w], BVX_FILL_NORMAL);
            TEST_ASSERT_TRUE(same_bits(&wide.inside, &f.inside));
            assert_signs_agree(&f);
            bvx_field_free(ctx, &f);
        }
        bvx_field_free(ctx, &wide);
    }
}

/* A box without its lid: what lies over the opening is nearer to the walls' inner sides. */
static void test_an_open_box(void)
{
    static const double low[3] = {4, 4, 4}, high[3] = {28, 28, 28};
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 32, 32, 40);
    bvx_field f;

    maker_box(&mesh, low, high);
    for (size_t i = 0; i < mesh.triangles;) {
        const uint32_t *const t = mesh.t + 3 * i;
        if (mesh.p[3 * t[0] + 2] + mesh.p[3 * t[1] + 2] + mesh.p[3 * t[2] + 2] == 3 * 28)
            maker_remove(&mesh, i);
        else i++;
    }
    f = field_of(&l, 2, BVX_FILL_NORMAL);
    TEST_ASSERT_EQUAL_INT(1, bvx_grid_get(&f.inside, 16, 16, 10));
    TEST_ASSERT_EQUAL_INT(1, bvx_grid_get(&f.inside, 16, 16, 16));
    TEST_ASSERT_EQUAL_INT(0, bvx_grid_get(&f.inside, 16, 16, 1));
    TEST_ASSERT_EQUAL_INT(0, bvx_grid_get(&f.inside, 1, 16, 39));
    TEST_ASSERT_EQUAL_INT(0, bvx_grid_get(&f.inside, 0, 0, 0));
    assert_fronts(&f);
    bvx_field_free(ctx, &f);
}

static void test_a_lattice_without_any_band(void)
{
    static const double low[3] = {-100, -100, -100};
    static const double high[3] = {100, 100, 100};
    static const double far_low[3] = {300, 0, 0};
    static const double far_high[3] = {310, 10, 10};
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 67, 9, 8);

    for (int inside = 0; inside < 2; inside++)
        for (int32_t sign = BVX_FILL_PARITY; sign < BVX_FILL_NONE; sign++)
            if (BVX_FILLS_OF_FIELD >> sign & 1)
                for (int window = 0; window < 2; window++) {
                    bvx_field_options o = field_options(2, sign);
                    bvx_field f;
                    maker_clear(&mesh);
                    maker_box(&mesh, inside ? low : far_low, inside ? high : far_high);
                    if (window)
                        for (int a = 0; a < 3; a++) {
                            o.window.low[a] = 2;
                            o.window.size[a] = 5;
                        }
                    f = field_by(ctx, &l, &o);
                    TEST_ASSERT_EQUAL_UINT64(0, f.value_count);
                    TEST_ASSERT_EQUAL_UINT64(!inside ? 0 : window ? 125 : 67 * 9 * 8, set_in(&f.inside));
                    bvx_field_free(ctx, &f);
                }
}

/* ---- odd meshes ---- */

static void test_odd_meshes_have_signs_too(void)
{
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 20, 19, 18);
    static const double low[3] = {2, 2, 2}, high[3] = {17, 16, 15};

    for (int trial = 0; trial < (quick ? 3 : 12); trial++)
        for (int32_t sign = BVX_FILL_AUTO; sign <= BVX_FILL_NONE; sign++)
            if (BVX_FILLS_OF_FIELD >> sign & 1) {
                bvx_field f;
                maker_clear(&mesh);
                maker_soup(&mesh, &seed, 1 + trial, low, high, 65536);
                maker_degenerate(&mesh, &seed, trial, low, high, 65536);
                f = field_of(&l, 1.5, sign);
                assert_signs_agree(&f);
                bvx_field_free(ctx, &f);
            }
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_exact_vote_and_winding_are_the_solids);
    RUN_TEST(test_auto_looks_at_the_mesh);
    RUN_TEST(test_no_sign);
    RUN_TEST(test_shapes_that_are_known);
    RUN_TEST(test_faces_on_centres);
    RUN_TEST(test_normals_are_wrong_at_a_sharp_edge);
    RUN_TEST(test_normals_are_right_where_faces_are_closest);
    RUN_TEST(test_fronts_meet_in_holes);
    RUN_TEST(test_thin_bands_have_the_signs_of_wide_ones);
    RUN_TEST(test_an_open_box);
    RUN_TEST(test_a_lattice_without_any_band);
    RUN_TEST(test_odd_meshes_have_signs_too);
    return UNITY_END();
}
