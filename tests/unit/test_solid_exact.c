/* test_solid_exact.c - bvx_voxelize_solid against an oracle in whole
 * numbers: every bit, every row, both rules. */
#include "solid_support.h"

/* ---- Random meshes ---- */

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
    static const int32_t sizes[][3] = {{1, 1, 1},   {1, 70, 1},  {1, 1, 70}, {1, 33, 35}, {70, 1, 1},
                                       {66, 40, 1}, {66, 1, 40}, {2, 2, 2},  {1, 130, 2}, {3, 1, 200}};

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
                    p[a] = pick < 3   ? most
                           : pick < 6 ? -most
                                      : maker_between(&seed, 0, l.dims[a], pick == 6 ? 2 : 65536);
                    if (pick < 6 && maker_below(&seed, 3) == 0)
                        p[a] -= p[a] > 0 ? maker_below(&seed, 9) / 65536.0 : -maker_below(&seed, 9) / 65536.0;
                }
                v[k] = maker_vertex(&mesh, p[0], p[1], p[2]);
            }
            maker_triangle(&mesh, v[0], v[1], v[2]);
        }
        assert_both_rules(&l);
    }
}

/* Planes that pass within a few steps, or exactly, through centres of long rows: where doubles cannot
 * decide. */
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
                /* a centre, and two whole steps in the plane: many centres on it */
                c[i] = maker_below(&seed, n[i]) + 0.5;
                u[i] = maker_below(&seed, 7) - 3;
                w[i] = maker_below(&seed, 7) - 3;
            }
            a = maker_vertex(&mesh, c[0] - u[0] * scale, c[1] - u[1] * scale, c[2] - u[2] * scale);
            b = maker_vertex(&mesh, c[0] + (u[0] - w[0]) * scale, c[1] + (u[1] - w[1]) * scale,
                             c[2] + (u[2] - w[2]) * scale);
            for (int i = 0; i < 3; i++)
                c[i] += w[i] * scale + (maker_below(&seed, 3) == 0 ? maker_below(&seed, 3) - 1 : 0) / 65536.0;
            d = maker_vertex(&mesh, c[0], c[1], c[2]);
            maker_triangle(&mesh, a, b, d);
        }
        for (size_t i = 0; i < 3 * mesh.vertices; i++) TEST_ASSERT_TRUE(fabs(mesh.p[i]) < 16384);
        assert_both_rules(&l);
    }
}

/* A triangle with corners a, v and -(a + m v) about a centre: the centre
 * has weights 1 : m : 1, so one step of a's x moves the crossing by 1 / (m
 * + 2) steps. That is where divisions in doubles are trusted, or are not. */
static void test_crossings_a_hair_from_a_centre(void)
{
    for (int32_t trial = 0; trial < (quick ? 1000 : 8000); trial++) {
        bvx_lattice const l = trial % 2 ? lattice_of(70, 3, 2)
                                        : lattice_of(66, 1 + maker_below(&seed, 12), 12);
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

/* The last digit: weights e of the corners at a centre are coprime, and x coordinates are solved so that the
 * plane passes the centre at -1, 0 or 1 parts of the weights' sum. */
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

/* Long edges that pass a centre as near as whole numbers can, or through
 * it: the edge function there is -1, 0 or 1. */
static void test_edges_a_hair_from_a_centre(void)
{
    int64_t tried = 0;

    for (int32_t trial = 0; trial < (quick ? 1000 : 8000); trial++) {
        bvx_lattice const l = trial % 3 == 0   ? lattice_of(3, 1, 1)
                              : trial % 3 == 1 ? lattice_of(3, 2, 3)
                                               : lattice_of(3, 9, 9);
        int32_t const range = 1 << (4 + maker_below(&seed, 25)), off = maker_below(&seed, 3) - 1;
        double const y = (maker_below(&seed, l.dims[1]) + 0.5) * 65536;
        double const z = (maker_below(&seed, l.dims[2]) + 0.5) * 65536;
        int64_t a = maker_below(&seed, 2 * range + 1) - range;
        int64_t b = maker_below(&seed, 2 * range + 1) - range;
        int64_t c, d;
        int64_t g = a;
        int64_t h = b;
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
            for (int i = 0; i < 9; i++)
                p[i] = low[i % 3] +
                       (high[i % 3] - low[i % 3]) * ((double)maker_below(&seed, 1 << 30) / (1 << 30));
            maker_triangle(&mesh, maker_vertex(&mesh, p[0], p[1], p[2]),
                           maker_vertex(&mesh, p[3], p[4], p[5]), maker_vertex(&mesh, p[6], p[7], p[8]));
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
            for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_NONZERO; fill++) {
                bvx_solid_report r;
                bvx_grid g = solid_by(ctx, &l, NULL, fill, &r);
                for (int32_t z = 0; z < n[2]; z++)
                    for (int32_t y = 0; y < n[1]; y++)
                        for (int32_t x = 0; x < n[0]; x++)
                            TEST_ASSERT_EQUAL_INT(maker_solid_at(solid, n, x, y, z),
                                                  bvx_grid_get(&g, x, y, z));
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
        /* nested or overlapping */
        if (trial % 2) star_at(33, 14, 16, 5, 0.5, steps);
        /* whole shells inverted */
        if (trial % 4 > 1) maker_flip(&mesh, 0, mesh.triangles / (size_t)(1 + trial % 2));
        if (trial % 5 == 0)
            for (size_t i = 0, n = mesh.triangles; i < n; i++) { /* every triangle twice, back to back */
                maker_duplicate(&mesh, i);
                maker_flip(&mesh, mesh.triangles - 1, mesh.triangles);
            }
        for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_NONZERO; fill++) {
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

/* Space cut into tetrahedra, dealt out to four solids: none of them shares
 * a voxel with another, none is left out. */
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
            for (size_t i = 0; i < all.vertices; i++)
                maker_vertex(&part[s], all.p[3 * i], all.p[3 * i + 1], all.p[3 * i + 2]);
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

int main(void)
{
    UNITY_BEGIN();
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
    return UNITY_END();
}
