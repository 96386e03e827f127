/* test_field_dense.c - fields as arrays: what is in the band, and what stands beyond it. */
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

static float *dense_of(bvx_context *c, const bvx_field *f, int32_t vectors)
{
    const int32_t *const n = f->band.size;
    float *const values = maker_grow(NULL, (size_t)n[0] * (size_t)n[1] * (size_t)n[2] * 12);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_field_dense(c, f, vectors, values), bvx_last_message(c));
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
                d = dense_of(ctx, &f, 0);
                v = dense_of(ctx, &f, 1);
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

static void test_threads_change_nothing(void)
{
    static const int32_t ways[][2] = {{1, BVX_CPU_PORTABLE}, {2, BVX_CPU_BEST}, {8, BVX_CPU_BEST}};
    bvx_lattice const l = lattice_with(0, 0, 0, 1, 0.5, 1, 70, 40, 30);
    size_t const bytes = 70 * 40 * 30 * 4;
    bvx_field f;
    float *d, *v;

    add_bodies(&l, 3);
    f = field_of(&l, 1.5, BVX_FILL_PARITY);
    d = dense_of(ctx, &f, 0);
    v = dense_of(ctx, &f, 1);
    for (int w = 0; w < 3; w++) {
        bvx_context *const other = suite_context(ways[w][0], ways[w][1]);
        float *const d2 = dense_of(other, &f, 0);
        float *const v2 = dense_of(other, &f, 1);
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
    bvx_field f, bad;
    static float values[8 * 8 * 8 * 3];

    maker_box(&mesh, low, high);
    f = field_by(ctx, &l, &o);
#define REFUSED(status, word, ...)                                                                \
    do {                                                                                          \
        TEST_ASSERT_EQUAL_INT32(status, bvx_field_dense(ctx, __VA_ARGS__));                       \
        TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), word), bvx_last_message(ctx)); \
    } while (0)
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_field_dense(NULL, &f, 0, values));
    REFUSED(BVX_ERR_ARGUMENT, "field", NULL, 0, values);
    REFUSED(BVX_ERR_ARGUMENT, "values", &f, 0, NULL);
    REFUSED(BVX_ERR_ARGUMENT, "vectors is 2", &f, 2, values);
#define BROKEN(change, status, word)            \
    do {                                        \
        bad = f;                                \
        change;                                 \
        REFUSED(status, word, &bad, 0, values); \
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
    REFUSED(BVX_ERR_ARGUMENT, "no vectors", &bad, 1, values);
    bvx_field_free(ctx, &f);
    f = field_by(ctx, &away, &o);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_field_dense(ctx, &f, 0, values));
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
    d = dense_of(ctx, &f, 0);
    TEST_ASSERT_TRUE(d[20 * 20 * 20 - 1] > 3.4e38f);
    TEST_ASSERT_TRUE(d[0] < 0);
    free(d);
    bvx_field_free(ctx, &f);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_constant);
    RUN_TEST(test_threads_change_nothing);
    RUN_TEST(test_refusals);
    RUN_TEST(test_numbers_beyond_floats_are_infinite);
    return UNITY_END();
}
