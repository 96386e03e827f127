/* test_nearest.c - closest points at centres of voxels: every triangle
 * looked at, for meshes, lattices and widths of all kinds. */
#include "nearest/nearest.h"
#include "nearest/closest.h"
#include "mesh/view.h"
#include "tools/mesh_maker.h"
#include "suite.h"

#include <math.h>

static maker_mesh m;
static float *floats;
static uint64_t seed;

void setUp(void)
{
    suite_open(1);
    seed = 11;
    maker_clear(&m);
}

void tearDown(void)
{
    maker_free(&m);
    free(floats);
    floats = NULL;
    suite_close();
}

/* ---- What is asked, and all that comes back ---- */

typedef struct asked {
    bvx_mesh_view view;
    bvx_lattice lattice;
    bvx_window window; /* all zero: the whole */
    double width;      /* or infinity */
    int32_t value_type;
} asked;

typedef struct answer {
    bvx_grid band;
    uint64_t *first, count;
    void *vectors, *distances;
    uint32_t *triangles;
    uint8_t *features;
    size_t size; /* of a number */
} answer;

static void *room(uint64_t bytes)
{
    void *const p = malloc((size_t)bytes + 1);
    TEST_ASSERT_NOT_NULL(p);
    memset(p, 0x77, (size_t)bytes + 1);
    return p;
}

static void free_answer(bvx_context *c, answer *a)
{
    bvx_grid_free(c, &a->band);
    free(a->first);
    free(a->vectors);
    free(a->distances);
    free(a->triangles);
    free(a->features);
}

/* Number of each row's first set voxel. */
static void count_rows(const bvx_grid *g, uint64_t *first)
{
    uint64_t n = 0;
    for (uint64_t r = 0; r < bvxi_grid_rows(g); r++) {
        first[r] = n;
        for (int32_t k = 0; k < g->words_per_row; k++)
            n += bvxi_popcount(g->words[r * (uint64_t)g->words_per_row + (uint64_t)k]);
    }
    first[bvxi_grid_rows(g)] = n;
}

static void fill(bvx_context *c, const bvxi_nearest *nearest, int32_t value_type, answer *a)
{
    bvxi_sparse v = {.where = a->band, .first = a->first};

    a->count = a->first[bvxi_grid_rows(&a->band)];
    a->size = value_type == BVX_F32 ? 4 : 8;
    a->vectors = room(a->count * 3 * a->size);
    a->distances = room(a->count * a->size);
    a->triangles = room(a->count * 4);
    a->features = room(a->count);
    v.count = a->count;
    v.value_type = value_type;
    v.vectors = a->vectors;
    v.distances = a->distances;
    v.triangles = a->triangles;
    v.features = a->features;
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            bvxi_nearest_fill(bvxi_call_of(c, NULL, "test", 0, 1), nearest, HUGE_VAL, &v));
    TEST_ASSERT_EQUAL_UINT8(0x77, ((uint8_t *)a->distances)[a->count * a->size]);
    TEST_ASSERT_EQUAL_UINT8(0x77, a->features[a->count]);
}

static void ask(bvx_context *c, const asked *q, answer *a)
{
    bvxi_nearest *nearest = NULL;

    memset(a, 0, sizeof *a);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(
        BVX_OK, bvxi_nearest_open(bvxi_call_of(c, "test", "test", 0, 1), &q->view, &q->lattice, &nearest),
        bvx_last_message(c));
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            bvx_grid_create(c, &q->lattice, q->window.size[0] ? &q->window : NULL, &a->band));
    a->first = room((bvxi_grid_rows(&a->band) + 1) * 8);
    if (q->width < HUGE_VAL) {
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_nearest_band(bvxi_call_of(c, NULL, "test", 0, 1), nearest,
                                                          q->width, &a->band, a->first));
    } else {
        for (uint64_t r = 0; r < bvxi_grid_rows(&a->band); r++)
            bvxi_set_run(a->band.words + r * (uint64_t)a->band.words_per_row, 0, a->band.size[0]);
        count_rows(&a->band, a->first);
    }
    fill(c, nearest, q->value_type, a);
    bvxi_nearest_close(c, nearest);
}

/* ---- The oracle ---- */

typedef struct oracle {
    double (*t)[3][3];
    double scale;
    uint64_t count;
} oracle;

static oracle oracle_of(const bvx_mesh_view *v)
{
    oracle o = {NULL, 0.0, v->triangle_count};
    double low[3], high[3];

    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvxi_view_bounds(ctx, "test", v, low, high));
    o.scale = bvxi_unit_scale(low, high);
    o.t = room(v->triangle_count * sizeof *o.t);
    for (uint64_t i = 0; i < v->triangle_count; i++) {
        uint32_t c[3];
        TEST_ASSERT_TRUE(bvxi_view_triangle(v, i, c));
        for (int k = 0; k < 3; k++) {
            bvxi_view_position(v, c[k], o.t[i][k]);
            for (int a = 0; a < 3; a++) o.t[i][k][a] *= o.scale;
        }
    }
    return o;
}

/* The least (distance squared, triangle index) over all triangles. */
static uint32_t oracle_at(const oracle *o, const double p[3], double q[3], double *d2)
{
    uint32_t best = 0;

    *d2 = HUGE_VAL;
    for (uint64_t i = 0; i < o->count; i++) {
        double r[3];
        double const d = bvxi_closest_on_triangle(p, (const double(*)[3])o->t[i], r);
        if (d >= *d2) continue;
        *d2 = d;
        best = (uint32_t)i;
        memcpy(q, r, sizeof r);
    }
    return best;
}

static double number_of(const answer *a, const void *array, uint64_t i)
{
    return a->size == 4 ? (double)((const float *)array)[i] : ((const double *)array)[i];
}

/* All centres, or one in `step`. */
static void expect_answer(const asked *q, const answer *a, int32_t step)
{
    oracle const o = oracle_of(&q->view);
    uint64_t n = 0, seen = 0;

    for (int32_t z = 0; z < a->band.size[2]; z++)
        for (int32_t y = 0; y < a->band.size[1]; y++) {
            uint64_t const row = (uint64_t)z * (uint64_t)a->band.size[1] + (uint64_t)y;
            TEST_ASSERT_EQUAL_UINT64(n, a->first[row]);
            for (int32_t x = 0; x < a->band.size[0]; x++) {
                int const set = bvx_grid_get(&a->band, x, y, z);
                int32_t const at[3] = {a->band.low[0] + x, a->band.low[1] + y, a->band.low[2] + z};
                bvx_closest_point place;
                double p[3], closest[3], d2, t[3][3];
                if (seen++ % (uint64_t)step != 0) {
                    n += (uint64_t)set;
                    continue;
                }
                for (int k = 0; k < 3; k++)
                    p[k] = (q->lattice.origin[k] + ((double)at[k] + 0.5) * q->lattice.spacing[k]) * o.scale;
                uint32_t const best = oracle_at(&o, p, closest, &d2);
                double const d = sqrt(d2) / o.scale;
                TEST_ASSERT_EQUAL_INT(d <= q->width, set);
                if (!set) continue;
                TEST_ASSERT_EQUAL_UINT32(best, a->triangles[n]);
                TEST_ASSERT_TRUE((a->size == 4 ? (double)(float)d : d) == number_of(a, a->distances, n));
                for (int k = 0; k < 3; k++) {
                    double const v = (closest[k] - p[k]) / o.scale + 0.0;
                    double const got = number_of(a, a->vectors, 3 * n + (uint64_t)k);
                    TEST_ASSERT_TRUE((a->size == 4 ? (double)(float)v : v) == got);
                    TEST_ASSERT_FALSE(got == 0.0 && 1.0 / got < 0.0); /* one zero of two */
                }
                memcpy(t, o.t[best], sizeof t);
                bvxi_closest_place(p, (const double(*)[3])t, closest, &place);
                TEST_ASSERT_EQUAL_INT(place.feature, a->features[n]);
                n++;
            }
        }
    TEST_ASSERT_EQUAL_UINT64(n, a->count);
    free(o.t);
}

static void expect_same(const answer *a, const answer *b)
{
    TEST_ASSERT_EQUAL_UINT64(a->count, b->count);
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->band.words, b->band.words, (size_t)bvxi_grid_words(&a->band) * 8));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->first, b->first, (size_t)(bvxi_grid_rows(&a->band) + 1) * 8));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->vectors, b->vectors, (size_t)a->count * 3 * a->size));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->distances, b->distances, (size_t)a->count * a->size));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->triangles, b->triangles, (size_t)a->count * 4));
    TEST_ASSERT_EQUAL_INT(0, memcmp(a->features, b->features, (size_t)a->count));
}

/* Against the oracle, and the same bytes in every way of getting them. */
static void expect_everywhere(const asked *q, int32_t step)
{
    static const int32_t threads[4] = {2, 8, 1, 2};
    static const int32_t cpu[4] = {BVX_CPU_BEST, BVX_CPU_BEST, BVX_CPU_PORTABLE, BVX_CPU_PORTABLE};
    answer a, b;

    ask(ctx, q, &a);
    expect_answer(q, &a, step);
    for (int i = 0; i < 4; i++) {
        bvx_context *const other = suite_context(threads[i], cpu[i]);
        ask(other, q, &b);
        expect_same(&a, &b);
        free_answer(other, &b);
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(other));
        bvx_context_destroy(other);
    }
    free_answer(ctx, &a);
}

/* ---- Meshes ---- */

enum { KINDS = 7 };

static void make_mesh(int kind)
{
    static const double low[3] = {2, 3, 4};
    static const double high[3] = {19, 15, 17};
    static const double centre[3] = {11, 9, 10};
    static const double radius[3] = {8, 6, 7};

    maker_clear(&m);
    if (kind == 0) maker_soup(&m, &seed, 50, low, high, 1000);
    if (kind == 1) maker_needles(&m, &seed, 50, low, high, 65536);
    if (kind == 2) maker_degenerate(&m, &seed, 60, low, high, 1);
    if (kind == 3) maker_star(&m, &seed, centre, radius, 0.2, 15, 20, 64);
    if (kind == 4) maker_box(&m, low, high);
    if (kind == 5) maker_soup(&m, &seed, 80, low, high, 1); /* many ties */
    if (kind == 6) maker_soup(&m, &seed, 1, low, high, 3);
    /* one of area */
    if (kind == 2) maker_triangle(&m, 0, maker_vertex(&m, 9.5, 7.25, 8), maker_vertex(&m, 3, 12, 9));
}

static bvx_mesh_view view_as(int32_t type)
{
    bvx_mesh_view v = maker_view(&m);

    if (type == BVX_F64) return v;
    free(floats);
    floats = room(m.vertices * 12);
    for (size_t i = 0; i < 3 * m.vertices; i++) floats[i] = (float)m.p[i];
    v.positions = floats;
    v.position_type = BVX_F32;
    return v;
}

static bvx_lattice lattice_of(const double origin[3], const double spacing[3], int32_t nx, int32_t ny,
                              int32_t nz)
{
    int32_t const dims[3] = {nx, ny, nz};
    bvx_lattice l;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_make(ctx, origin, spacing, dims, &l));
    return l;
}

static asked question(bvx_mesh_view view, bvx_lattice lattice, double width)
{
    asked q;
    memset(&q, 0, sizeof q);
    q.view = view;
    q.lattice = lattice;
    q.width = width;
    q.value_type = BVX_F64;
    return q;
}

/* ---- Tests ---- */

static void test_nearest_band_equals_every_triangle(void)
{
    static const double origin[3] = {-2, 0, 1}, spacing[3] = {1, 1, 1};

    for (int kind = 0; kind < KINDS; kind++)
        for (int32_t type = BVX_F32; type <= BVX_F64; type++) {
            make_mesh(kind);
            asked q = question(view_as(type), lattice_of(origin, spacing, 26, 21, 23),
                               kind == 4 ? 3.0 : 2.75);
            q.value_type = type;
            expect_everywhere(&q, 3);
        }
}

static void test_nearest_everywhere_equals_every_triangle(void)
{
    static const double origin[3] = {-3, -2.5, 0}, spacing[3] = {1, 1, 1};
    for (int kind = 0; kind < KINDS; kind++) {
        make_mesh(kind);
        asked const q = question(view_as(BVX_F32), lattice_of(origin, spacing, 67, 19, 21), HUGE_VAL);
        expect_everywhere(&q, 7);
    }
}

static void test_nearest_equals_every_triangle_with_stretched_voxels(void)
{
    static const double origin[3] = {-1, 1.5, 2};
    static const double spacing[4][3] = {{0.25, 1, 2.5}, {3, 0.5, 0.5}, {0.7, 0.9, 1.3}, {16, 0.125, 4}};

    for (int i = 0; i < 4; i++) {
        make_mesh(i % 2 ? 3 : 0);
        asked q = question(view_as(BVX_F64),
                           lattice_of(origin, spacing[i], (int32_t)(22 / spacing[i][0]) + 1, 20,
                                      (int32_t)(20 / spacing[i][2]) + 1),
                           1.5 * (i == 3 ? 4 : spacing[i][2]));
        expect_everywhere(&q, 5);
        q.width = HUGE_VAL;
        expect_everywhere(&q, 11);
    }
}

/* Metres of a map, voxels of centimetres; and a mesh that is small beside where it lies. */
static void test_nearest_equals_every_triangle_far_from_the_origin(void)
{
    static const double shift[2][3] = {{500000, 5400000, 300}, {4e6, -3e6, 2e6}};
    static const double spacing[2][3] = {{1, 1, 1}, {0.01, 0.01, 0.01}};

    for (int i = 0; i < 2; i++)
        for (int kind = 0; kind < 4; kind++) {
            make_mesh(kind);
            for (size_t k = 0; k < 3 * m.vertices; k++) m.p[k] = m.p[k] * spacing[i][0] + shift[i][k % 3];
            double const origin[3] = {shift[i][0], shift[i][1], shift[i][2]};
            asked const q = question(view_as(BVX_F64), lattice_of(origin, spacing[i], 22, 18, 20),
                                     2 * spacing[i][0]);
            expect_everywhere(&q, 5);
        }
}

/* Units from the smallest to the largest; lattices far off, much larger and much smaller than the mesh. */
static void test_nearest_equals_every_triangle_in_any_unit(void)
{
    static const double unit[4] = {1e-300, 1e-30, 1e30, 1e290};

    for (int i = 0; i < 4; i++) {
        make_mesh(i);
        for (size_t k = 0; k < 3 * m.vertices; k++) m.p[k] *= unit[i];
        double const origin[3] = {0, 0, 0}, spacing[3] = {unit[i], unit[i], unit[i]};
        asked const q = question(view_as(BVX_F64), lattice_of(origin, spacing, 22, 18, 20), 2.5 * unit[i]);
        expect_everywhere(&q, 7);
    }
}

static void test_nearest_equals_every_triangle_from_lattices_far_off_or_of_another_size(void)
{
    static const double origin[5][3] = {
        {900, 20, 5}, {-1e6, 1e6, 1e6}, {9, 9, 9}, {-4000, -4000, -4000}, {1e12, 0, 0}};
    static const double size[5] = {1, 1, 1.0 / 1024, 512, 1e9};

    for (int i = 0; i < 5; i++) {
        double const spacing[3] = {size[i], size[i], size[i]};
        make_mesh(i == 2 ? 3 : 0);
        asked q = question(view_as(BVX_F64), lattice_of(origin[i], spacing, 17, 16, 15), HUGE_VAL);
        expect_everywhere(&q, 7);
        q.width = 1.25 * size[i];
        expect_everywhere(&q, 7);
    }
}

/* A window is a piece of the whole, wherever it begins. */
static void test_nearest_in_a_window_has_the_values_of_the_whole(void)
{
    static const double origin[3] = {0, 1, 2}, spacing[3] = {0.25, 0.25, 0.25};
    static const bvx_window window[3] = {
        {{1, 2, 3}, {70, 40, 30}}, {{63, 0, 17}, {5, 50, 1}}, {{30, 20, 5}, {1, 1, 1}}};

    make_mesh(3);
    for (int i = 0; i < 3; i++) {
        asked q = question(view_as(BVX_F32), lattice_of(origin, spacing, 80, 60, 60), 0.8);
        q.window = window[i];
        expect_everywhere(&q, 13);
    }
}

/* A width that is some centre's very distance: that centre is in the band,
 * and not with the next smaller width. */
static void test_nearest_band_is_closed(void)
{
    static const double origin[3] = {-2, 0, 1}, spacing[3] = {1, 1, 1};

    make_mesh(3);
    asked q = question(view_as(BVX_F32), lattice_of(origin, spacing, 26, 21, 23), HUGE_VAL);
    answer all, a;
    ask(ctx, &q, &all);
    for (int i = 0; i < 40; i++) {
        uint64_t const n = (uint64_t)maker_below(&seed, (int32_t)all.count);
        double const d = ((double *)all.distances)[n];
        uint64_t at_most = 0, below = 0;
        if (d == 0.0) continue;
        for (uint64_t k = 0; k < all.count; k++) {
            at_most += ((double *)all.distances)[k] <= d;
            below += ((double *)all.distances)[k] < d;
        }
        q.width = d;
        ask(ctx, &q, &a);
        TEST_ASSERT_EQUAL_UINT64(at_most, a.count);
        free_answer(ctx, &a);
        q.width = d * (1.0 - 0x1p-53);
        ask(ctx, &q, &a);
        TEST_ASSERT_EQUAL_UINT64(below, a.count);
        free_answer(ctx, &a);
    }
    free_answer(ctx, &all);
}

/* What a band remembers changes nothing: other sets of the same window, and other windows. */
static void test_nearest_fills_what_was_not_in_the_band(void)
{
    static const double origin[3] = {-2, 0, 1}, spacing[3] = {0.5, 0.5, 0.5};
    static const bvx_window part = {{3, 1, 2}, {40, 30, 31}};
    bvx_context *const other = suite_context(2, BVX_CPU_BEST);
    bvxi_nearest *nearest = NULL, *fresh = NULL;
    bvx_grid band = {0};

    make_mesh(3);
    asked q = question(view_as(BVX_F32), lattice_of(origin, spacing, 50, 40, 46), HUGE_VAL);
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK, bvxi_nearest_open(bvxi_call_of(other, "test", "test", 0, 1), &q.view, &q.lattice, &nearest));
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK, bvxi_nearest_open(bvxi_call_of(ctx, "test", "test", 0, 1), &q.view, &q.lattice, &fresh));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(other, &q.lattice, NULL, &band));
    uint64_t *const first = room((bvxi_grid_rows(&band) + 1) * 8);
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK, bvxi_nearest_band(bvxi_call_of(other, NULL, "test", 0, 1), nearest, 1.0, &band, first));
    for (int i = 0; i < 4; i++) {
        answer a, b;
        memset(&a, 0, sizeof a);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &q.lattice, i == 3 ? &part : NULL, &a.band));
        for (int32_t z = 0; z < a.band.size[2]; z++)
            for (int32_t y = 0; y < a.band.size[1]; y++)
                for (int32_t x = 0; x < a.band.size[0]; x++)
                    bvx_grid_set(&a.band, x, y, z,
                                 i == 2 ? bvx_grid_get(&band, x, y, z) == 0
                                        : maker_below(&seed, i == 0 ? 2 : 30) == 0);
        a.first = room((bvxi_grid_rows(&a.band) + 1) * 8);
        count_rows(&a.band, a.first);
        b = a;
        b.first = a.first;
        fill(other, nearest, BVX_F32, &a);
        fill(ctx, fresh, BVX_F32, &b);
        expect_same(&a, &b);
        memset(&b.band, 0, sizeof b.band);
        b.first = NULL;
        free_answer(ctx, &b);
        free_answer(ctx, &a);
    }
    free(first);
    bvx_grid_free(other, &band);
    bvxi_nearest_close(ctx, fresh);
    bvxi_nearest_close(other, nearest);
    TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(other));
    bvx_context_destroy(other);
}

/* Values that are not requested, and guesses that are right, hold for some centres, for few, for none. */
static void test_nearest_fills_single_arrays(void)
{
    static const double origin[3] = {-2, 0, 1}, spacing[3] = {1, 1, 1}, guess[4] = {2.0, 0.9, 0.05, 0.0};
    bvxi_nearest *nearest = NULL;

    make_mesh(0);
    asked q = question(view_as(BVX_F32), lattice_of(origin, spacing, 26, 21, 23), 2.0);
    q.value_type = BVX_F32;
    answer a;
    ask(ctx, &q, &a);
    TEST_ASSERT_EQUAL_INT32(
        BVX_OK, bvxi_nearest_open(bvxi_call_of(ctx, "test", "test", 0, 1), &q.view, &q.lattice, &nearest));
    for (int i = 0; i < 4; i++) {
        uint64_t const bytes = a.count * (i == 0 ? 12 : i == 3 ? 1 : 4);
        void *const got = room(bytes);
        bvxi_sparse v = {.where = a.band, .first = a.first, .count = a.count, .value_type = BVX_F32};
        if (i == 0) v.vectors = got;
        if (i == 1) v.distances = got;
        if (i == 2) v.triangles = got;
        if (i == 3) v.features = got;
        TEST_ASSERT_EQUAL_INT32(
            BVX_OK, bvxi_nearest_fill(bvxi_call_of(ctx, NULL, "test", 0, 1), nearest, guess[i], &v));
        TEST_ASSERT_EQUAL_INT(0, memcmp(got,
                                        i == 0   ? a.vectors
                                        : i == 1 ? a.distances
                                        : i == 2 ? (void *)a.triangles
                                                 : a.features,
                                        (size_t)bytes));
        free(got);
    }
    bvxi_nearest_close(ctx, nearest);
    free_answer(ctx, &a);
}

/* ---- Many triangles ---- */

/* A sphere of 2 n (n - 1) triangles around a centre of the lattice, from
 * where all are equally far but for rounding. */
static void make_sphere(int32_t n, double x, double y, double z, double r)
{
    double const pi = 3.14159265358979323846;

    for (int32_t i = 0; i <= n; i++)
        for (int32_t j = 0; j < n; j++) {
            double const a = pi * i / n, b = 2 * pi * j / n;
            maker_vertex(&m, x + r * sin(a) * cos(b), y + r * sin(a) * sin(b), z + r * cos(a));
        }
    for (int32_t i = 0; i < n; i++)
        for (int32_t j = 0; j < n; j++) {
            uint32_t const a = (uint32_t)(i * n + j), b = (uint32_t)(i * n + (j + 1) % n);
            if (i > 0) maker_triangle(&m, a, a + (uint32_t)n, b);
            if (i < n - 1) maker_triangle(&m, b, a + (uint32_t)n, b + (uint32_t)n);
        }
}

/* Lists and candidates that do not hold all. */
static void test_nearest_holds_where_lists_overflow(void)
{
    static const double origin[3] = {-6, -6, -6}, spacing[3] = {1, 1, 1};
    static const bvx_window middle = {{4, 4, 4}, {5, 5, 5}};

    make_sphere(90, 0.5, 0.5, 0.5, 5);
    asked q = question(view_as(BVX_F64), lattice_of(origin, spacing, 13, 13, 13), HUGE_VAL);
    q.window = middle;
    expect_everywhere(&q, 1);
    q.width = 5.0;
    expect_everywhere(&q, 1);
}

/* Thousands of triangles that share a corner or lie upon each other: the least number wins. */
static void test_nearest_takes_the_lowest_of_equal_triangles(void)
{
    static const double origin[3] = {-3, -3, -3}, spacing[3] = {1, 1, 1};

    for (int32_t i = 0; i < 3000; i++) {
        double const a = 6.283185307179586 * i / 3000, b = 6.283185307179586 * (i + 1) / 3000;
        uint32_t const top = maker_vertex(&m, 0.5, 0.5, 0.5);
        uint32_t const u = maker_vertex(&m, 4 * cos(a), 4 * sin(a), -3);
        maker_triangle(&m, top, u, maker_vertex(&m, 4 * cos(b), 4 * sin(b), -3));
    }
    for (int32_t i = 0; i < 2000; i++) maker_triangle(&m, 0, 1, 2);
    asked const q = question(view_as(BVX_F32), lattice_of(origin, spacing, 8, 8, 8), HUGE_VAL);
    expect_everywhere(&q, 3);
}

/* One triangle far away must not cost the others their places in the tree: without care this takes
 * minutes. */
static void test_nearest_stays_fast_beside_a_triangle_far_away(void)
{
    static const double origin[3] = {-2, 0, 1}, spacing[3] = {0.5, 0.5, 0.5};
    static const double centre[3] = {11, 9, 10}, radius[3] = {8, 6, 7};
    maker_star(&m, &seed, centre, radius, 0.1, 30, 41, 1024);
    uint32_t const a = maker_vertex(&m, 1e9, 1e9, 1e9), b = maker_vertex(&m, 1e9, 1e9, 2e9);
    maker_triangle(&m, a, b, maker_vertex(&m, 2e9, 1e9, 1e9));
    asked const q = question(view_as(BVX_F64), lattice_of(origin, spacing, 52, 42, 46), 1.5);
    expect_everywhere(&q, 29);
}

/* Nearly all triangles in one cell of the tree's curve. */
static void test_nearest_holds_with_most_triangles_in_one_cell(void)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {0.015625, 0.015625, 0.015625};
    static const bvx_window window = {{60, 61, 62}, {7, 6, 5}};

    make_sphere(60, 1, 1, 1, 0.03);
    uint32_t const a = maker_vertex(&m, 60, 61, 62), b = maker_vertex(&m, 61, 61, 61);
    maker_triangle(&m, a, b, maker_vertex(&m, 62, 59, 61));
    asked q = question(view_as(BVX_F64), lattice_of(origin, spacing, 4096, 4096, 4096), 0.04);
    q.window = window;
    expect_everywhere(&q, 1);
}

/* Triangles much larger than voxels, over the whole lattice. */
static void test_nearest_holds_for_triangles_larger_than_voxels(void)
{
    static const double origin[3] = {0, 0, 0};
    static const double spacing[3] = {1, 1, 1};
    static const double low[3] = {20, 20, 20};
    static const double high[3] = {235, 230, 225};
    static const bvx_window corner = {{10, 12, 14}, {40, 20, 20}};

    maker_box(&m, low, high);
    asked q = question(view_as(BVX_F32), lattice_of(origin, spacing, 256, 256, 256), 3.0);
    q.window = corner;
    expect_everywhere(&q, 3);
}

/* ---- Refusals ---- */

static void test_nearest_refuses_bad_meshes_and_lattices(void)
{
    static const double origin[3] = {0, 0, 0}, spacing[3] = {1, 1, 1};
    bvx_lattice const l = lattice_of(origin, spacing, 8, 8, 8);
    bvxi_nearest *nearest = (bvxi_nearest *)&seed;

    make_mesh(0);
    bvx_mesh_view v = maker_view(&m);
    v.triangle_count = 0;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY,
                            bvxi_nearest_open(bvxi_call_of(ctx, "f", "test", 0, 1), &v, &l, &nearest));
    TEST_ASSERT_NULL(nearest);
    v = maker_view(&m);
    m.t[7] = 4000;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE,
                            bvxi_nearest_open(bvxi_call_of(ctx, "f", "test", 0, 1), &v, &l, &nearest));
    m.t[7] = 0;
    m.p[10] = HUGE_VAL;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE,
                            bvxi_nearest_open(bvxi_call_of(ctx, "f", "test", 0, 1), &v, &l, &nearest));
    for (size_t i = 0; i < 3 * m.vertices; i++) m.p[i] = (double)(i / 3); /* all on one line */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_EMPTY,
                            bvxi_nearest_open(bvxi_call_of(ctx, "f", "test", 0, 1), &v, &l, &nearest));
    TEST_ASSERT_EQUAL_STRING("f: no triangle has an area", bvx_last_message(ctx));
    bvx_lattice wide = l;
    make_mesh(0);
    v = maker_view(&m);
    wide.spacing[1] = 0x1p1021; /* 2^1024 is no double */
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE,
                            bvxi_nearest_open(bvxi_call_of(ctx, "f", "test", 0, 1), &v, &wide, &nearest));
    TEST_ASSERT_EQUAL_STRING("f: the lattice's last voxel has no finite place along y",
                             bvx_last_message(ctx));
    wide.origin[1] = -0x1p1022;
    wide.spacing[1] = 0x1p1020;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE,
                            bvxi_nearest_open(bvxi_call_of(ctx, "f", "test", 0, 1), &v, &wide, &nearest));
    TEST_ASSERT_NOT_NULL(strstr(bvx_last_message(ctx), "along y lattice and mesh reach from"));
    v.index_type = 9;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT,
                            bvxi_nearest_open(bvxi_call_of(ctx, "f", "test", 0, 1), &v, &l, &nearest));
    TEST_ASSERT_NULL(nearest);
}

int main(void)
{
    int const brief = getenv("BVX_QUICK") != NULL; /* on emulated machines */

    UNITY_BEGIN();
    RUN_TEST(test_nearest_band_equals_every_triangle);
    if (!brief) RUN_TEST(test_nearest_everywhere_equals_every_triangle);
    RUN_TEST(test_nearest_equals_every_triangle_with_stretched_voxels);
    RUN_TEST(test_nearest_equals_every_triangle_far_from_the_origin);
    if (!brief) RUN_TEST(test_nearest_equals_every_triangle_in_any_unit);
    RUN_TEST(test_nearest_equals_every_triangle_from_lattices_far_off_or_of_another_size);
    RUN_TEST(test_nearest_in_a_window_has_the_values_of_the_whole);
    RUN_TEST(test_nearest_band_is_closed);
    RUN_TEST(test_nearest_fills_what_was_not_in_the_band);
    RUN_TEST(test_nearest_fills_single_arrays);
    if (!brief) RUN_TEST(test_nearest_holds_where_lists_overflow);
    RUN_TEST(test_nearest_takes_the_lowest_of_equal_triangles);
    RUN_TEST(test_nearest_stays_fast_beside_a_triangle_far_away);
    if (!brief) RUN_TEST(test_nearest_holds_with_most_triangles_in_one_cell);
    RUN_TEST(test_nearest_holds_for_triangles_larger_than_voxels);
    RUN_TEST(test_nearest_refuses_bad_meshes_and_lattices);
    return UNITY_END();
}
