/* test_field_dense.c - fields as arrays: what is in the band, what stands
 * beyond it, and how far propagated distances are off. */
#include "field_support.h"

static void add_bodies(const bvx_lattice *l, int count)
{
    for (int i = 0; i < count; i++) {
        double centre[3], radius[3];
        for (int a = 0; a < 3; a++) {
            double const side = l->dims[a] * l->spacing[a];
            centre[a] = l->origin[a] + maker_between(&seed, 0.2 * side, 0.8 * side, 4096);
            radius[a] = maker_between(&seed, 0.1 * side, 0.3 * side, 4096);
        }
        maker_star(&mesh, &seed, centre, radius, 0.4, 5 + maker_below(&seed, 4), 7 + maker_below(&seed, 5),
                   65536);
    }
}

static float *dense_of(bvx_context *c, const bvx_field *f, int32_t far_rule, int32_t vectors)
{
    bvx_mesh_view const view = maker_view(&mesh);
    const int32_t *const n = f->band.size;
    float *const values = maker_grow(NULL, (size_t)n[0] * (size_t)n[1] * (size_t)n[2] * 12);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_field_dense(c, f, &view, far_rule, vectors, values),
                                    bvx_last_message(c));
    return values;
}

static int inside_at(const bvx_field *f, int32_t x, int32_t y, int32_t z)
{
    return f->inside.words != NULL && bvx_grid_get(&f->inside, x, y, z);
}

static void test_constant(void)
{
    static const int32_t shapes[][3] = {{20, 18, 16}, {65, 7, 6}, {64, 5, 9}, {130, 3, 3}};

    for (int s = 0; s < 4; s++)
        for (int type = BVX_F32; type <= BVX_F64; type++)
            for (int32_t sign = BVX_FILL_PARITY; sign <= BVX_FILL_NONE;
                 sign += BVX_FILL_NONE - BVX_FILL_PARITY) {
                bvx_lattice const l = lattice_with(1, 2, 3, 1, 0.5, 0.75, shapes[s][0], shapes[s][1],
                                                   shapes[s][2]);
                bvx_field_options o = field_options(1.25, sign);
                bvx_field f;
                float *d, *v;
                size_t i = 0;
                maker_clear(&mesh);
                add_bodies(&l, 1);
                o.value_type = type;
                f = field_by(ctx, &l, &o);
                d = dense_of(ctx, &f, BVX_FAR_CONSTANT, 0);
                v = dense_of(ctx, &f, BVX_FAR_CONSTANT, 1);
                for (int32_t z = 0; z < l.dims[2]; z++)
                    for (int32_t y = 0; y < l.dims[1]; y++)
                        for (int32_t x = 0; x < l.dims[0]; x++, i++) {
                            uint64_t const n = bvx_field_value(&f, x, y, z);
                            float const away = (float)(inside_at(&f, x, y, z) ? -f.half_width : f.half_width);
                            TEST_ASSERT_EQUAL_FLOAT(
                                n == UINT64_MAX ? away : (float)number_at(&f, f.distances, n), d[i]);
                            TEST_ASSERT_EQUAL_INT(inside_at(&f, x, y, z), signbit(d[i]) != 0);
                            for (uint64_t a = 0; a < 3; a++)
                                TEST_ASSERT_EQUAL_FLOAT(
                                    n == UINT64_MAX ? 0.0f : (float)number_at(&f, f.vectors, 3 * n + a),
                                    v[3 * i + a]);
                        }
                free(d);
                free(v);
                bvx_field_free(ctx, &f);
            }
}

/* Propagated distances are never below the exact ones, agree with their
 * vectors, and are off by no more than this. */
static void assert_propagated(const bvx_lattice *l, double half_width, double most_off, double mean_off)
{
    bvx_field f = field_of(l, half_width, BVX_FILL_PARITY), all = field_of(l, HUGE_VAL, BVX_FILL_PARITY);
    float *const d = dense_of(ctx, &f, BVX_FAR_PROPAGATED, 0);
    float *const v = dense_of(ctx, &f, BVX_FAR_PROPAGATED, 1);
    float *const exact = dense_of(ctx, &all, BVX_FAR_CONSTANT, 0);
    size_t const count = (size_t)l->dims[0] * (size_t)l->dims[1] * (size_t)l->dims[2];
    double worst = 0, sum = 0;
    size_t other = 0;

    for (size_t i = 0; i < count; i++) {
        double const vector[3] = {(double)v[3 * i], (double)v[3 * i + 1], (double)v[3 * i + 2]};
        double const off = fabs((double)d[i]) - fabs((double)exact[i]);
        double const share = exact[i] != 0.0f ? off / fabs((double)exact[i]) : off;
        TEST_ASSERT_EQUAL_INT(signbit(exact[i]) != 0, signbit(d[i]) != 0);
        TEST_ASSERT_TRUE(off >= 0);
        TEST_ASSERT_DOUBLE_WITHIN(1e-5, fabs((double)d[i]), sqrt(dot3(vector, vector)));
        worst = share > worst ? share : worst;
        sum += share;
        other += off > 0;
    }
    printf(
        "%d x %d x %d, band %g: propagated distances up to %.3g %% off, %.3g %% on average, %.3g %% of centres off at all\n",
        (int)l->dims[0], (int)l->dims[1], (int)l->dims[2], half_width, 100 * worst, 100 * sum / (double)count,
        100 * (double)other / (double)count);
    TEST_ASSERT_TRUE(worst <= most_off);
    TEST_ASSERT_TRUE(sum / (double)count <= mean_off);
    free(d);
    free(v);
    free(exact);
    bvx_field_free(ctx, &f);
    bvx_field_free(ctx, &all);
}

static void test_propagated_is_an_upper_bound(void)
{
    static const double torus[3] = {16, 16, 14};

    for (int trial = 0; trial < (quick ? 1 : 6); trial++) {
        bvx_lattice const l = lattice_with(0, 0, 0, trial & 1 ? 0.5 : 1, 1, trial & 2 ? 2 : 1, 48, 40, 36);
        maker_clear(&mesh);
        add_bodies(&l, 1 + trial % 3);
        assert_propagated(&l, trial % 2 ? 1 : 3, 0.25, 0.002);
    }
    maker_clear(&mesh);
    add_torus(torus, 9, 4, 1, 60, 40);
    {
        bvx_lattice const l = lattice_with(0, 0, 0, 0.5, 0.5, 0.5, 64, 64, 56);
        assert_propagated(&l, 3, 0.1, 0.002);
        assert_propagated(&l, 1, 0.25, 0.004);
    }
}

static void test_propagated_by_hand(void)
{
    static const double low[3] = {1, 1, 1}, high[3] = {2, 3, 3};
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 70, 4, 4);
    bvx_field f;
    float *d, *v;

    maker_box(&mesh, low, high);
    f = field_of(&l, 1, BVX_FILL_PARITY);
    d = dense_of(ctx, &f, BVX_FAR_PROPAGATED, 0);
    v = dense_of(ctx, &f, BVX_FAR_PROPAGATED, 1);
    for (size_t x = 2; x < 70; x++) {
        TEST_ASSERT_EQUAL_FLOAT((float)x - 1.5f, d[(1 * 4 + 1) * 70 + x]);
        TEST_ASSERT_EQUAL_FLOAT(1.5f - (float)x, v[3 * ((1 * 4 + 1) * 70 + x)]);
        TEST_ASSERT_EQUAL_FLOAT(0.0f, v[3 * ((1 * 4 + 1) * 70 + x) + 1]);
    }
    free(d);
    free(v);
    bvx_field_free(ctx, &f);
}

static void test_threads_change_nothing(void)
{
    static const int32_t ways[][2] = {{1, BVX_CPU_PORTABLE}, {2, BVX_CPU_BEST}, {8, BVX_CPU_BEST}};
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 0.5, 1, 70, 40, 30);
    size_t const bytes = 70 * 40 * 30 * 4;
    bvx_field f;
    float *d, *v;

    add_bodies(&l, 3);
    f = field_of(&l, 1.5, BVX_FILL_PARITY);
    d = dense_of(ctx, &f, BVX_FAR_PROPAGATED, 0);
    v = dense_of(ctx, &f, BVX_FAR_PROPAGATED, 1);
    for (int w = 0; w < 3; w++) {
        bvx_context *const other = suite_context(ways[w][0], ways[w][1]);
        float *const d2 = dense_of(other, &f, BVX_FAR_PROPAGATED, 0);
        float *const v2 = dense_of(other, &f, BVX_FAR_PROPAGATED, 1);
        TEST_ASSERT_EQUAL_INT(0, memcmp(d, d2, bytes));
        TEST_ASSERT_EQUAL_INT(0, memcmp(v, v2, 3 * bytes));
        free(d2);
        free(v2);
        bvx_context_destroy(other);
    }
    free(d);
    free(v);
    bvx_field_free(ctx, &f);
}

static void test_refusals(void)
{
    static const double low[3] = {2, 2, 2}, high[3] = {6, 6, 6};
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 1, 1, 8, 8, 8);
    bvx_lattice const away = lattice_with(100, 0, 0, 1, 1, 1, 8, 8, 8);
    bvx_field_options o = field_options(1, BVX_FILL_PARITY);
    bvx_mesh_view view, small;
    bvx_field f, bad;
    static float values[8 * 8 * 8 * 3];

    maker_box(&mesh, low, high);
    view = maker_view(&mesh);
    f = field_by(ctx, &l, &o);
#define REFUSED(status, word, ...)                                                                \
    do {                                                                                          \
        TEST_ASSERT_EQUAL_INT32(status, bvx_field_dense(ctx, __VA_ARGS__));                       \
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx)); \
    } while (0)
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_field_dense(NULL, &f, &view, 0, 0, values));
    REFUSED(BVX_ERR_ARGUMENT, "field", NULL, &view, 0, 0, values);
    REFUSED(BVX_ERR_ARGUMENT, "values", &f, &view, 0, 0, NULL);
    REFUSED(BVX_ERR_ARGUMENT, "far_rule is 2", &f, &view, 2, 0, values);
    REFUSED(BVX_ERR_ARGUMENT, "vectors is 2", &f, &view, 0, 2, values);
    REFUSED(BVX_ERR_ARGUMENT, "mesh", &f, NULL, BVX_FAR_PROPAGATED, 0, values);
    small = view;
    small.triangle_count = 1;
    REFUSED(BVX_ERR_ARGUMENT, "but the mesh has 1", &f, &small, BVX_FAR_PROPAGATED, 0, values);
#define BROKEN(change, status, word)                      \
    do {                                                  \
        bad = f;                                          \
        change;                                           \
        REFUSED(status, word, &bad, &view, 0, 0, values); \
    } while (0)
    BROKEN(bad.reserved[2] = 1, BVX_ERR_ARGUMENT, "reserved[2]");
    BROKEN(bad.row_values = NULL, BVX_ERR_ARGUMENT, "no row_values");
    BROKEN(bad.distances = NULL, BVX_ERR_ARGUMENT, "no distances");
    BROKEN(bad.value_type = 3, BVX_ERR_ARGUMENT, "value_type is 3");
    BROKEN(bad.sign = 0, BVX_ERR_ARGUMENT, "sign is 0");
    BROKEN(bad.half_width = 0, BVX_ERR_ARGUMENT, "half_width");
    BROKEN(bad.value_count++, BVX_ERR_ARGUMENT, "value_count");
    BROKEN(bad.inside.words = NULL, BVX_ERR_ARGUMENT, "inside has no words");
    BROKEN((bad.inside.lattice.origin[0] += 1), BVX_ERR_LATTICE, "one lattice");
    BROKEN(bad.band.words = NULL, BVX_ERR_ARGUMENT, "no words");
    BROKEN(f.row_values[9]++, BVX_ERR_ARGUMENT, "row_values[9]");
    f.row_values[9]--;
    bad = f;
    bad.vectors = NULL;
    REFUSED(BVX_ERR_ARGUMENT, "no vectors", &bad, &view, 0, 1, values);
    bad = f;
    bad.triangles = NULL;
    REFUSED(BVX_ERR_ARGUMENT, "features 1", &bad, &view, BVX_FAR_PROPAGATED, 0, values);
    bvx_field_free(ctx, &f);
    f = field_by(ctx, &away, &o);
    REFUSED(BVX_ERR_EMPTY, "no value", &f, &view, BVX_FAR_PROPAGATED, 0, values);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_field_dense(ctx, &f, NULL, BVX_FAR_CONSTANT, 0, values));
    TEST_ASSERT_EQUAL_FLOAT(1.0f, values[511]);
    bvx_field_free(ctx, &f);
#undef BROKEN
#undef REFUSED
}

static void test_numbers_beyond_floats_are_infinite(void)
{
    static const double low[3] = {0, 0, 0}, high[3] = {1e39, 1e39, 1e39};
    bvx_lattice const l = lattice_with(0, 0, 0, 1e38, 1e38, 1e38, 20, 20, 20);
    bvx_field_options o = field_options(HUGE_VAL, BVX_FILL_PARITY);
    bvx_field f;
    float *d;

    maker_box(&mesh, low, high);
    o.value_type = BVX_F64;
    f = field_by(ctx, &l, &o);
    d = dense_of(ctx, &f, BVX_FAR_CONSTANT, 0);
    TEST_ASSERT_TRUE(d[20 * 20 * 20 - 1] > 3.4e38f);
    TEST_ASSERT_TRUE(d[0] < 0);
    free(d);
    bvx_field_free(ctx, &f);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_constant);
    RUN_TEST(test_propagated_is_an_upper_bound);
    RUN_TEST(test_propagated_by_hand);
    RUN_TEST(test_threads_change_nothing);
    RUN_TEST(test_refusals);
    RUN_TEST(test_numbers_beyond_floats_are_infinite);
    return UNITY_END();
}
