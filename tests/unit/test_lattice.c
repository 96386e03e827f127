/* test_lattice.c - lattices fitted and made, their refusals, 128-bit sums and fixed-point rounding. */
#include "lattice/lattice.h"
#include "tools/exact.h"
#include "tools/mesh_maker.h"

#include <float.h>
#include <math.h>

#include "suite.h"

static maker_mesh mesh;
static uint64_t seed;

void setUp(void)
{
    suite_open(0);
    seed = 20240607;
}

void tearDown(void)
{
    maker_free(&mesh);
    suite_close();
}

static bvx_lattice_options fit_options(void)
{
    bvx_lattice_options o = {.struct_size = sizeof o};
    return o;
}

static void triangle_over(const double low[3], const double high[3])
{
    maker_clear(&mesh);
    maker_triangle(&mesh, maker_vertex(&mesh, low[0], low[1], high[2]),
                   maker_vertex(&mesh, high[0], low[1], low[2]),
                   maker_vertex(&mesh, low[0], high[1], low[2]));
}

static bvx_status fit(const bvx_lattice_options *o, bvx_lattice *l)
{
    bvx_mesh_view const view = maker_view(&mesh);
    return bvx_lattice_fit_with(ctx, &view, o, l);
}

static int32_t plain_fraction_bits(int64_t n) /* min(16, 29 - ceil(log2 n)) */
{
    int32_t log2 = 0;
    while (((int64_t)1 << log2) < n) log2++;
    return 29 - log2 < 16 ? 29 - log2 : 16;
}

static int32_t greatest(const int32_t dims[3])
{
    int32_t n = dims[0] > dims[1] ? dims[0] : dims[1];
    return n > dims[2] ? n : dims[2];
}

/* n voxels cover an extent, and one less would not (but for what divisions round: 2^-40 of the extent). */
static void assert_least_cover(double extent, double spacing, int32_t n)
{
    double const slack = ldexp(extent, -39);
    TEST_ASSERT_TRUE(n >= 1);
    TEST_ASSERT_TRUE(n * spacing >= extent - slack);
    TEST_ASSERT_TRUE(n == 1 || (n - 1) * spacing < extent + slack);
}

#define ASSERT_REFUSED(status, call, text)                                                        \
    do {                                                                                          \
        bvx_lattice const before = lattice;                                                       \
        TEST_ASSERT_EQUAL_INT32(status, call);                                                    \
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), text), bvx_last_message(ctx)); \
        TEST_ASSERT_EQUAL_MEMORY(&before, &lattice, sizeof lattice);                              \
    } while (0)

static bvx_lattice lattice; /* stays as it was when a call fails */

/* ---- Fitting ---- */

static void test_fit_by_resolution_by_hand(void)
{
    double const low[3] = {-1, 10, 0.5}, high[3] = {7, 14.5, 2.5};
    bvx_mesh_view view;

    triangle_over(low, high);
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, &view, 16, &lattice));
    TEST_ASSERT_EQUAL_MEMORY(low, lattice.origin, sizeof low);
    for (int a = 0; a < 3; a++) TEST_ASSERT_EQUAL_DOUBLE(0.5, lattice.spacing[a]);
    TEST_ASSERT_EQUAL_INT32(16, lattice.dims[0]);
    TEST_ASSERT_EQUAL_INT32(9, lattice.dims[1]);
    TEST_ASSERT_EQUAL_INT32(4, lattice.dims[2]);
    TEST_ASSERT_EQUAL_INT32(16, lattice.fraction_bits);
}

static void test_fit_by_resolution_covers_with_the_least_count(void)
{
    for (int trial = 0; trial < 4000; trial++) {
        int32_t const resolution = 1 + maker_below(&seed, trial % 2 ? 40 : 5000);
        double low[3], high[3], longest = 0;
        bvx_mesh_view view;
        for (int a = 0; a < 3; a++) {
            low[a] = maker_between(&seed, -100, 100, 977);
            high[a] = low[a] + maker_between(&seed, 0, trial % 3 ? 60 : 1, trial % 5 ? 31 : 1);
            longest = high[a] - low[a] > longest ? high[a] - low[a] : longest;
        }
        if (!(longest > 0)) continue;
        triangle_over(low, high);
        view = maker_view(&mesh);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, &view, resolution, &lattice));
        TEST_ASSERT_EQUAL_INT32(resolution, greatest(lattice.dims));
        TEST_ASSERT_EQUAL_INT32(plain_fraction_bits(resolution), lattice.fraction_bits);
        for (int a = 0; a < 3; a++) {
            TEST_ASSERT_TRUE(lattice.spacing[a] == longest / resolution);
            TEST_ASSERT_TRUE(lattice.origin[a] == low[a]);
            assert_least_cover(high[a] - low[a], lattice.spacing[a], lattice.dims[a]);
        }
    }
}

/* A box whose sides are whole multiples of the spacing costs no layer more, whatever the division rounds
 * to. */
static void test_fit_whole_multiples_cost_no_extra_layer(void)
{
    for (int32_t n = 1; n <= 300; n++)
        for (int32_t part = 1; part <= 9; part++) {
            double const unit = 0.1 * part;
            double const low[3] = {0, 0, 0};
            double const high[3] = {unit * n, unit * (n / 2 + 1), unit};
            bvx_lattice_options o = fit_options();
            triangle_over(low, high);
            o.resolution = n;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, fit(&o, &lattice));
            TEST_ASSERT_EQUAL_INT32(n, lattice.dims[0]);
            if (n / 2 + 1 <= n) TEST_ASSERT_EQUAL_INT32(n / 2 + 1, lattice.dims[1]);
            TEST_ASSERT_EQUAL_INT32(1, lattice.dims[2]);
            o = fit_options();
            for (int a = 0; a < 3; a++) o.spacing[a] = unit;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, fit(&o, &lattice));
            TEST_ASSERT_EQUAL_INT32(n, lattice.dims[0]);
            TEST_ASSERT_EQUAL_INT32(n / 2 + 1, lattice.dims[1]);
        }
}

static void test_fit_per_axis(void)
{
    double const low[3] = {-3, 0, 5}, high[3] = {7, 30, 5};
    bvx_lattice_options o = fit_options();

    triangle_over(low, high);
    o.axis_resolution[0] = 4;
    o.axis_resolution[1] = 600;
    o.axis_resolution[2] = 3;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, fit(&o, &lattice));
    TEST_ASSERT_EQUAL_MEMORY(o.axis_resolution, lattice.dims, sizeof lattice.dims);
    TEST_ASSERT_EQUAL_DOUBLE(2.5, lattice.spacing[0]);
    TEST_ASSERT_EQUAL_DOUBLE(0.05, lattice.spacing[1]);
    TEST_ASSERT_TRUE(lattice.spacing[2] > 0); /* flat along z: any spacing covers it */
    TEST_ASSERT_EQUAL_MEMORY(low, lattice.origin, sizeof low);
}

static void test_fit_by_spacing(void)
{
    for (int trial = 0; trial < 2000; trial++) {
        double low[3], high[3];
        bvx_lattice_options o = fit_options();
        for (int a = 0; a < 3; a++) {
            low[a] = maker_between(&seed, -1000, 1000, 64);
            high[a] = low[a] + maker_between(&seed, 0, 50, trial % 2 ? 64 : 977);
            o.spacing[a] = maker_between(&seed, 0.0625, 3, trial % 3 ? 64 : 1000);
        }
        triangle_over(low, high);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, fit(&o, &lattice));
        for (int a = 0; a < 3; a++) {
            TEST_ASSERT_TRUE(lattice.spacing[a] == o.spacing[a]);
            TEST_ASSERT_TRUE(lattice.origin[a] == low[a]);
            assert_least_cover(high[a] - low[a], o.spacing[a], lattice.dims[a]);
        }
        TEST_ASSERT_EQUAL_INT32(plain_fraction_bits(greatest(lattice.dims)), lattice.fraction_bits);
    }
}

static void test_fit_padding_adds_voxels_on_every_side(void)
{
    double const low[3] = {1, 2, 3}, high[3] = {9, 6, 4};
    static const int32_t paddings[4] = {0, 1, 3, 65536};

    for (int i = 0; i < 4; i++) {
        bvx_lattice_options o = fit_options();
        triangle_over(low, high);
        o.resolution = 32;
        o.padding = paddings[i];
        TEST_ASSERT_EQUAL_INT32(BVX_OK, fit(&o, &lattice));
        for (int a = 0; a < 3; a++) {
            TEST_ASSERT_TRUE(lattice.spacing[a] == 0.25);
            TEST_ASSERT_TRUE(lattice.origin[a] == low[a] - 0.25 * paddings[i]);
            TEST_ASSERT_EQUAL_INT32((int32_t)((high[a] - low[a]) * 4) + 2 * paddings[i], lattice.dims[a]);
        }
        TEST_ASSERT_EQUAL_INT32(plain_fraction_bits(greatest(lattice.dims)), lattice.fraction_bits);
    }
}

/* Vertices that no triangle uses do not count. */
static void test_fit_looks_at_used_vertices_only(void)
{
    double const low[3] = {0, 0, 0}, high[3] = {4, 4, 4};
    bvx_mesh_view view;

    triangle_over(low, high);
    maker_vertex(&mesh, 1000, -1000, 77);
    view = maker_view(&mesh);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, &view, 8, &lattice));
    TEST_ASSERT_EQUAL_MEMORY(low, lattice.origin, sizeof low);
    for (int a = 0; a < 3; a++) TEST_ASSERT_EQUAL_INT32(8, lattice.dims[a]);
}

static void test_fit_refuses_contradicting_options(void)
{
    double const low[3] = {0, 0, 0}, high[3] = {4, 4, 4};
    bvx_lattice_options o = fit_options();
    bvx_mesh_view view;

    triangle_over(low, high);
    view = maker_view(&mesh);
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(&o, &lattice), "exactly one");
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(NULL, &lattice), "exactly one");
    o.resolution = 4;
    o.spacing[1] = 1;
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(&o, &lattice), "exactly one");
    o.spacing[1] = 0;
    o.axis_resolution[2] = 1;
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(&o, &lattice), "exactly one");
    o.resolution = 0; /* now the other two axes are missing */
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(&o, &lattice), "resolution 0");
    o = fit_options();
    o.spacing[0] = 1;
    o.spacing[2] = 1;
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(&o, &lattice), "spacing 0");
    o.spacing[1] = -1;
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(&o, &lattice), "spacing -1");
    o.spacing[1] = HUGE_VAL;
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(&o, &lattice), "spacing inf");
    o.spacing[1] = nan("");
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(&o, &lattice), "spacing nan");
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, bvx_lattice_fit(ctx, &view, 0, &lattice), "resolution 0");
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, bvx_lattice_fit(ctx, &view, -5, &lattice), "resolution -5");
    ASSERT_REFUSED(BVX_ERR_RANGE, bvx_lattice_fit(ctx, &view, (1 << 25) + 1, &lattice), "33554433");
    o = fit_options();
    o.resolution = 4;
    o.padding = -1;
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(&o, &lattice), "padding is -1");
    o.padding = 65537;
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(&o, &lattice), "padding is 65537");
    o.padding = 1;
    o.resolution = 1 << 25;
    ASSERT_REFUSED(BVX_ERR_RANGE, fit(&o, &lattice), "voxels");
    o = fit_options();
    o.resolution = 4;
    o.reserved = 7;
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(&o, &lattice), "reserved");
    o.reserved = 0;
    o.struct_size = 3;
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, fit(&o, &lattice), "size");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_lattice_fit(NULL, &view, 4, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_lattice_fit_with(NULL, &view, &o, &lattice));
    ASSERT_REFUSED(BVX_ERR_ARGUMENT, bvx_lattice_fit(ctx, NULL, 4, &lattice), "mesh");
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_lattice_fit(ctx, &view, 4, NULL));
}

/* Any box gives what a mesh with these bounds gives, however its side is requested. */
static void test_a_box_is_fitted_like_a_mesh(void)
{
    static const double boxes[][2][3] = {{{0, 0, 0}, {4, 2, 1}},
                                         {{-3.7, 1e5, 0.1}, {9.2, 1.00001e5, 0.3}},
                                         {{5, 5, 5}, {5, 5, 6}},
                                         {{-1e-3, -2e-3, 7}, {1e-3, 2e-3, 7}},
                                         {{1.0 / 3, -1e6, 1e-9}, {2.0 / 3, 1e6, 1e9}}};
    bvx_lattice by_mesh, by_box;

    for (size_t i = 0; i < sizeof boxes / sizeof boxes[0]; i++)
        for (int how = 0; how < 6; how++) {
            bvx_mesh_view const corners = {
                .positions = boxes[i], .vertex_count = 2, .position_type = BVX_F64};
            bvx_lattice_options o = fit_options();
            bvx_status status;

            if (how % 3 == 0) o.resolution = 37;
            else if (how % 3 == 1)
                o.axis_resolution[0] = 3, o.axis_resolution[1] = 40, o.axis_resolution[2] = 7;
            else o.spacing[0] = 1, o.spacing[1] = 1e3, o.spacing[2] = 1e4;
            o.padding = how / 3 * 5;
            triangle_over(boxes[i][0], boxes[i][1]);
            status = fit(&o, &by_mesh);
            TEST_ASSERT_EQUAL_INT32_MESSAGE(status, bvx_lattice_fit_with(ctx, &corners, &o, &by_box),
                                            bvx_last_message(ctx));
            TEST_ASSERT_EQUAL_INT32(BVX_OK, status);
            TEST_ASSERT_EQUAL_MEMORY(&by_mesh, &by_box, sizeof by_box);
        }
}

static void test_fit_refuses_what_has_no_bounds(void)
{
    double const low[3] = {0, 0, 0}, high[3] = {4, 4, 4};
    bvx_lattice_options o = fit_options();

    o.resolution = 10;
    maker_clear(&mesh);
    ASSERT_REFUSED(BVX_ERR_EMPTY, fit(&o, &lattice), "no points");
    maker_vertex(&mesh, 1, 2, 3);
    ASSERT_REFUSED(BVX_ERR_EMPTY, fit(&o, &lattice), "one point");
    triangle_over(low, high);
    mesh.p[3 * 1 + 1] = nan("");
    ASSERT_REFUSED(BVX_ERR_RANGE, fit(&o, &lattice), "vertex 1");
    mesh.p[3 * 1 + 1] = -HUGE_VAL;
    ASSERT_REFUSED(BVX_ERR_RANGE, fit(&o, &lattice), "vertex 1");
    triangle_over(low, high);
    mesh.t[2] = 3;
    ASSERT_REFUSED(BVX_ERR_RANGE, fit(&o, &lattice), "triangle 0");
    triangle_over(low, high);
    mesh.p[0] = -DBL_MAX;
    mesh.p[3] = DBL_MAX;
    ASSERT_REFUSED(BVX_ERR_RANGE, fit(&o, &lattice), "too large");
    triangle_over(low, low);
    ASSERT_REFUSED(BVX_ERR_EMPTY, fit(&o, &lattice), "one point");
    triangle_over(low, high); /* a spacing that asks for too many voxels */
    o = fit_options();
    o.spacing[0] = o.spacing[1] = 1;
    o.spacing[2] = 4.0 / ((1 << 25) + 1);
    ASSERT_REFUSED(BVX_ERR_RANGE, fit(&o, &lattice), "33554433");
    o.spacing[2] = 4.0 / (1 << 25);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, fit(&o, &lattice));
    TEST_ASSERT_EQUAL_INT32(1 << 25, lattice.dims[2]);
    TEST_ASSERT_EQUAL_INT32(4, lattice.fraction_bits);
    o.spacing[2] = DBL_MIN * DBL_EPSILON; /* the division overflows */
    ASSERT_REFUSED(BVX_ERR_RANGE, fit(&o, &lattice), "voxels");
    o = fit_options(); /* a side that its resolution divides to 0 */
    triangle_over(low, low);
    mesh.p[0] = 5e-324;
    o.resolution = 256;
    ASSERT_REFUSED(BVX_ERR_RANGE, fit(&o, &lattice), "extent of 5e-324 is too small");
    o = fit_options();
    o.spacing[0] = o.spacing[1] = 1;
    triangle_over(low, low); /* a single point is no trouble for a spacing */
    o.spacing[2] = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, fit(&o, &lattice));
    for (int a = 0; a < 3; a++) TEST_ASSERT_EQUAL_INT32(1, lattice.dims[a]);
}

static void test_check_refuses_more_fraction_bits_than_fit(void)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};

    for (int a = 0; a < 3; a++) {
        int32_t dims[3] = {1, 1, 1};
        dims[a] = 1 << 20;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
        TEST_ASSERT_EQUAL_INT32(9, lattice.fraction_bits);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_lattice_check(ctx, "test", &lattice));
        lattice.fraction_bits = 10;
        ASSERT_REFUSED(BVX_ERR_RANGE, bvxi_lattice_check(ctx, "test", &lattice), "not 10");
    }
}

/* ---- Making ---- */

static void test_make_gives_the_fraction_bits_that_fit(void)
{
    double const origin[3] = {1, -2, 3}, spacing[3] = {0.5, 1, 2};

    for (int32_t log2 = 0; log2 <= 25; log2++)
        for (int32_t off = -1; off <= 1; off++) {
            int32_t const n = (1 << log2) + off;
            if (n < 1 || n > 1 << 25) continue;
            for (int a = 0; a < 3; a++) {
                int32_t dims[3] = {1, 1, 1};
                dims[a] = n;
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
                TEST_ASSERT_EQUAL_INT32(plain_fraction_bits(n), lattice.fraction_bits);
                TEST_ASSERT_TRUE((int64_t)n << lattice.fraction_bits <= INT64_C(1) << 29);
                TEST_ASSERT_EQUAL_MEMORY(origin, lattice.origin, sizeof origin);
                TEST_ASSERT_EQUAL_MEMORY(spacing, lattice.spacing, sizeof spacing);
                TEST_ASSERT_EQUAL_MEMORY(dims, lattice.dims, sizeof dims);
            }
        }
}

static void test_make_refuses_what_is_no_lattice(void)
{
    double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    int32_t dims[3] = {4, 5, 6};

    for (int a = 0; a < 3; a++) {
        static const char *const name[3] = {"x", "y", "z"};
        double const bad[2] = {nan(""), -HUGE_VAL};
        for (int i = 0; i < 2; i++) {
            origin[a] = bad[i];
            ASSERT_REFUSED(BVX_ERR_RANGE, bvx_lattice_make(ctx, origin, spacing, dims, &lattice), name[a]);
            origin[a] = 0;
        }
        {
            double const bad_spacing[4] = {0, -1, nan(""), HUGE_VAL};
            for (int i = 0; i < 4; i++) {
                spacing[a] = bad_spacing[i];
                ASSERT_REFUSED(BVX_ERR_ARGUMENT, bvx_lattice_make(ctx, origin, spacing, dims, &lattice),
                               name[a]);
                spacing[a] = 1;
            }
        }
        {
            static const int32_t bad_dims[5] = {0, -1, INT32_MIN, (1 << 25) + 1, INT32_MAX};
            int32_t const good = dims[a];
            for (int i = 0; i < 5; i++) {
                dims[a] = bad_dims[i];
                ASSERT_REFUSED(BVX_ERR_RANGE, bvx_lattice_make(ctx, origin, spacing, dims, &lattice),
                               name[a]);
                dims[a] = good;
            }
        }
    }
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_lattice_make(NULL, origin, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_lattice_make(ctx, NULL, spacing, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_lattice_make(ctx, origin, NULL, dims, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_lattice_make(ctx, origin, spacing, NULL, &lattice));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_lattice_make(ctx, origin, spacing, dims, NULL));
}

static void test_lattices_are_equal_in_all_fields(void)
{
    double const origin[3] = {0, 1, 2}, spacing[3] = {1, 2, 3};
    int32_t const dims[3] = {4, 5, 6};
    bvx_lattice other;

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &lattice));
    other = lattice;
    TEST_ASSERT_TRUE(bvxi_lattice_equal(&lattice, &other));
    other.origin[0] = -0.0;
    TEST_ASSERT_TRUE(bvxi_lattice_equal(&lattice, &other));
    for (int a = 0; a < 3; a++) {
        other = lattice;
        other.origin[a] += 1;
        TEST_ASSERT_FALSE(bvxi_lattice_equal(&lattice, &other));
        other = lattice;
        other.spacing[a] *= 2;
        TEST_ASSERT_FALSE(bvxi_lattice_equal(&lattice, &other));
        other = lattice;
        other.dims[a]++;
        TEST_ASSERT_FALSE(bvxi_lattice_equal(&lattice, &other));
    }
    other = lattice;
    other.fraction_bits--;
    TEST_ASSERT_FALSE(bvxi_lattice_equal(&lattice, &other));
}

/* ---- 128 bits ---- */

static const int64_t wide_values[] = {0,
                                      1,
                                      -1,
                                      2,
                                      -2,
                                      255,
                                      -256,
                                      INT32_MAX,
                                      INT32_MIN,
                                      UINT32_MAX,
                                      -INT64_C(4294967295),
                                      INT64_C(4294967296),
                                      -INT64_C(4294967296),
                                      INT64_C(0x7fffffff00000000),
                                      -INT64_C(0x7fffffff00000000),
                                      INT64_MAX,
                                      -INT64_MAX,
                                      INT64_MIN};
enum { WIDE_VALUES = sizeof wide_values / sizeof wide_values[0] };

static int64_t wide_value(int n) /* the list, then random ones of random length */
{
    if (n < WIDE_VALUES) return wide_values[n];
    return (int64_t)maker_random(&seed) >> maker_below(&seed, 63);
}

/* The 128 lowest bits of an exact number. */
static bvxi_limbs limbs_of(exact_number e)
{
    bvxi_limbs l;
    l.low = e.digit[0] | (uint64_t)e.digit[1] << 32;
    l.high = e.digit[2] | (uint64_t)e.digit[3] << 32;
    return l;
}

static void test_limbs_multiply_add_and_sign(void)
{
    enum { N = WIDE_VALUES + 40 };
    int64_t v[N];
    for (int i = 0; i < N; i++) v[i] = wide_value(i);
    for (int i = 0; i < N; i++)
        for (int k = 0; k < N; k++) {
            exact_number const product = exact_mul(exact_of(v[i]), exact_of(v[k]));
            exact_number const other = exact_mul(exact_of(v[(i + 7) % N]), exact_of(v[(k + 3) % N]));
            bvxi_limbs const p = bvxi_limbs_mul(v[i], v[k]), want = limbs_of(product);
            bvxi_limbs const sum = bvxi_limbs_add(p, limbs_of(other));
            bvxi_limbs const want_sum = limbs_of(exact_add(product, other));
            bvxi_limbs const zero = bvxi_limbs_add(p, bvxi_limbs_negate(p));
            TEST_ASSERT_EQUAL_HEX64(want.low, p.low);
            TEST_ASSERT_EQUAL_HEX64(want.high, p.high);
            TEST_ASSERT_EQUAL_HEX64(want_sum.low, sum.low);
            TEST_ASSERT_EQUAL_HEX64(want_sum.high, sum.high);
            TEST_ASSERT_EQUAL_INT32(exact_sign(product), bvxi_limbs_sign(p));
            TEST_ASSERT_EQUAL_HEX64(0, zero.low | zero.high);
            TEST_ASSERT_EQUAL_INT32(exact_sign(product), bvxi_wide_sign(bvxi_wide_mul(v[i], v[k])));
        }
}

/* Plane at a centre, at the ends of its budget: normals below 2^63, differences below 2^31, three terms. */
static void test_wide_sums_of_three_at_the_ends_of_the_budget(void)
{
    static const int64_t normals[5] = {INT64_MAX, -INT64_MAX, 0, 1, -1};
    static const int64_t differences[7] = {INT64_C(2147483647), -INT64_C(2147483647), 0, 1, -1,
                                           2147483646,          -2147483646};
    int n[6];

    for (n[0] = 0; n[0] < 5; n[0]++)
        for (n[1] = 0; n[1] < 5; n[1]++)
            for (n[2] = 0; n[2] < 5; n[2]++)
                for (n[3] = 0; n[3] < 7; n[3]++)
                    for (n[4] = 0; n[4] < 7; n[4]++)
                        for (n[5] = 0; n[5] < 7; n[5]++) {
                            int64_t const a = normals[n[0]], b = normals[n[1]], c = normals[n[2]];
                            int64_t const x = differences[n[3]], y = differences[n[4]], z = differences[n[5]];
                            int const want = exact_sign(
                                exact_add(exact_add(exact_mul(exact_of(a), exact_of(x)),
                                                    exact_mul(exact_of(b), exact_of(y))),
                                          exact_mul(exact_of(c), exact_of(z))));
                            bvxi_wide const w = bvxi_wide_add(
                                bvxi_wide_add(bvxi_wide_mul(a, x), bvxi_wide_mul(b, y)), bvxi_wide_mul(c, z));
                            bvxi_limbs const l = bvxi_limbs_add(
                                bvxi_limbs_add(bvxi_limbs_mul(a, x), bvxi_limbs_mul(b, y)),
                                bvxi_limbs_mul(c, z));
                            if (want != bvxi_wide_sign(w) || want != bvxi_limbs_sign(l) ||
                                want != exact_sign_of_sum(x, a, y, b, z, c))
                                TEST_FAIL_MESSAGE("a sum of three products has the wrong sign");
                        }
}

/* a = b (c q + s) + t with 0 <= s < c and 0 <= t < b: floor(a / (b c)) is
 * q. Divisors of more than 53 bits round in a double. */
static void test_wide_floor_division_finds_the_multiple_below(void)
{
    for (int trial = 0; trial < 200000; trial++) {
        int32_t const n = 4 + trial % 13;
        int64_t const limit = (int64_t)1 << (trial % 2 ? 32 : 40), c = (int64_t)1 << n;
        int64_t const b = 1 + (int64_t)(maker_random(&seed) >> (2 + maker_below(&seed, 62)));
        int64_t q = (int64_t)(maker_random(&seed) % (uint64_t)(2 * limit - 1)) - (limit - 1);
        int64_t s, t, got;
        if (trial % 3 == 0) q = q % 9;
        s = trial % 5 == 0 ? 0 : trial % 5 == 1 ? c - 1 : maker_below(&seed, 1 << n);
        t = trial % 7 < 2 ? 0 : trial % 7 == 3 ? b - 1 : (int64_t)(maker_random(&seed) % (uint64_t)b);
        got = bvxi_wide_floor_div_scaled(bvxi_wide_add(bvxi_wide_mul(b, c * q + s), bvxi_wide_mul(t, 1)), b,
                                         c, limit);
        if (got != q) TEST_FAIL_MESSAGE("not the floor of a division of 128 bits");
    }
    for (int64_t k = 2; k < 1000; k++) { /* beyond the limits */
        int64_t const limit = (int64_t)1 << 32, b = INT64_MAX / k;
        TEST_ASSERT_EQUAL_INT64(limit,
                                bvxi_wide_floor_div_scaled(bvxi_wide_mul(b, 16 * (limit + k)), b, 16, limit));
        TEST_ASSERT_EQUAL_INT64(
            -limit, bvxi_wide_floor_div_scaled(bvxi_wide_mul(b, -16 * (limit + k)), b, 16, limit));
    }
}

/* ---- Fixed point ---- */

static void test_round_half_up_is_floor_of_value_plus_half(void)
{
    static const double ends[] = {0,
                                  0.5,
                                  -0.5,
                                  0.25,
                                  -0.25,
                                  0.75,
                                  -0.75,
                                  1,
                                  -1,
                                  1.5,
                                  -1.5,
                                  2.5,
                                  -2.5,
                                  1073741823.0,
                                  -1073741823.0,
                                  1073741823.25,
                                  1073741822.5,
                                  -1073741822.5,
                                  -1073741823.25,
                                  -1073741823.5,
                                  0.49999999999999994,
                                  -0.49999999999999994,
                                  4503599627370497.0 / 8388608.0,
                                  1e-300,
                                  -1e-300};

    for (size_t i = 0; i < sizeof ends / sizeof ends[0]; i++)
        TEST_ASSERT_EQUAL_INT32((int32_t)floor(ends[i] + 0.5), bvxi_round_half_up(ends[i]));
    for (int i = 0; i < 200000; i++) {
        double const v = maker_between(&seed, i % 2 ? -8 : -1073741823, i % 2 ? 8 : 1073741823,
                                       i % 3 ? 2 : 1024);
        if (floor(v + 0.5) != bvxi_round_half_up(v))
            TEST_FAIL_MESSAGE("rounded otherwise than floor(v + 1/2)");
    }
}

static void test_floor_shift_rounds_down(void)
{
    static const int32_t ends[] = {0,     1,     -1,     2,      -2,    INT32_MAX, INT32_MIN, INT32_MIN + 1,
                                   65535, 65536, -65535, -65536, -65537};
    for (int32_t shift = 0; shift < 31; shift++)
        for (size_t i = 0; i < sizeof ends / sizeof ends[0] + 1000; i++) {
            int32_t const v = i < sizeof ends / sizeof ends[0] ? ends[i]
                                                               : (int32_t)(maker_random(&seed) >> 32);
            TEST_ASSERT_EQUAL_INT32((int32_t)floor(v / (double)(1 << shift)), bvxi_floor_shift(v, shift));
        }
}

/* The least i whose centre, i voxels and a half, is not below q. */
static void test_centres_below_counts_them(void)
{
    for (int32_t f = 4; f <= 16; f++) {
        int64_t const step = INT64_C(1) << f, half = step / 2;
        for (int i = 0; i < 4000; i++) {
            int64_t const near_centre = (int64_t)(maker_below(&seed, 2000) - 1000) * step + half +
                                        maker_below(&seed, 5) - 2;
            int64_t const anywhere = (int64_t)(maker_random(&seed) >> 33) - (INT64_C(1) << 30);
            int64_t const q = i == 0   ? (INT64_C(1) << 30) - 1
                              : i == 1 ? 1 - (INT64_C(1) << 30)
                              : i % 2  ? near_centre
                                       : anywhere;
            int32_t const n = bvxi_centres_below((int32_t)q, f);
            TEST_ASSERT_TRUE(n * step + half >= q);
            TEST_ASSERT_TRUE((n - 1) * step + half < q);
        }
    }
}

static void test_fraction_bits_formula(void)
{
    for (int32_t n = 1; n <= 1 << 25; n = n < 70000 ? n + 1 : n + 977)
        TEST_ASSERT_EQUAL_INT32(plain_fraction_bits(n), bvxi_fraction_bits(n));
    TEST_ASSERT_EQUAL_INT32(4, bvxi_fraction_bits(1 << 25));
    TEST_ASSERT_EQUAL_INT32(16, bvxi_fraction_bits(1 << 13));
    TEST_ASSERT_EQUAL_INT32(15, bvxi_fraction_bits((1 << 13) + 1));
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_fit_by_resolution_by_hand);
    RUN_TEST(test_fit_by_resolution_covers_with_the_least_count);
    RUN_TEST(test_fit_whole_multiples_cost_no_extra_layer);
    RUN_TEST(test_fit_per_axis);
    RUN_TEST(test_fit_by_spacing);
    RUN_TEST(test_fit_padding_adds_voxels_on_every_side);
    RUN_TEST(test_fit_looks_at_used_vertices_only);
    RUN_TEST(test_fit_refuses_contradicting_options);
    RUN_TEST(test_a_box_is_fitted_like_a_mesh);
    RUN_TEST(test_fit_refuses_what_has_no_bounds);
    RUN_TEST(test_make_gives_the_fraction_bits_that_fit);
    RUN_TEST(test_make_refuses_what_is_no_lattice);
    RUN_TEST(test_lattices_are_equal_in_all_fields);
    RUN_TEST(test_limbs_multiply_add_and_sign);
    RUN_TEST(test_wide_sums_of_three_at_the_ends_of_the_budget);
    RUN_TEST(test_wide_floor_division_finds_the_multiple_below);
    RUN_TEST(test_round_half_up_is_floor_of_value_plus_half);
    RUN_TEST(test_floor_shift_rounds_down);
    RUN_TEST(test_centres_below_counts_them);
    RUN_TEST(test_fraction_bits_formula);
    RUN_TEST(test_check_refuses_more_fraction_bits_than_fit);
    return UNITY_END();
}
