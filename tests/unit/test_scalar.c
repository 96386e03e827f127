/* test_scalar.c - surfaces of levels: vertices held against the plain formula edge by edge, triangles against
 * those of the bits' surface, and everything against the certificate; windows, threads, paths. */
#include "volume_support.h"

static const int x_first[3] = {0, 1, 2}, z_first[3] = {2, 1, 0};

static bvx_scalar_options level_options(double level)
{
    bvx_scalar_options o = {.struct_size = sizeof o};
    o.level = level;
    o.position_type = BVX_F64;
    return o;
}

/* NaN beyond the window. */
static double value_at(const test_volume *t, const int32_t at[3])
{
    for (int a = 0; a < 3; a++)
        if (at[a] < 0 || at[a] >= t->view.size[a]) return NAN;
    return t->value[value_index(t, at[0], at[1], at[2])];
}

static int inside(double v, const bvx_scalar_options *o)
{
    return isfinite(v) && (o->below ? v <= o->level : v >= o->level);
}

/* Every crossing edge in order of (z, y, axis, x) has its vertex where the straight line says. */
static void check_vertices(const test_volume *t, const bvx_scalar_options *o, const bvx_mesh *m)
{
    const bvx_lattice *const l = &t->view.lattice;
    uint64_t n = 0;

    for (int32_t z = -1; z < t->view.size[2]; z++)
        for (int32_t y = -1; y < t->view.size[1]; y++)
            for (int axis = 0; axis < 3; axis++)
                for (int32_t x = -1; x < t->view.size[0]; x++) {
                    int32_t const low[3] = {x, y, z};
                    int32_t high[3] = {x, y, z};
                    double a, b, ratio = 0.5;
                    high[axis]++;
                    a = value_at(t, low);
                    b = value_at(t, high);
                    if (inside(a, o) == inside(b, o)) continue;
                    if (isfinite(a) && isfinite(b)) ratio = (o->level / 2 - a / 2) / (b / 2 - a / 2);
                    if (ratio < 1.0 / 128) ratio = 1.0 / 128;
                    if (ratio > 127.0 / 128) ratio = 127.0 / 128;
                    if (ratio != ratio) ratio = 0.5;
                    TEST_ASSERT_TRUE(n < m->vertex_count);
                    for (int d = 0; d < 3; d++) {
                        double const place = l->origin[d] + ((double)(t->view.low[d] + low[d]) + 0.5 +
                                                             (d == axis ? ratio : 0.0)) *
                                                                l->spacing[d];
                        if (m->position_type == BVX_F64)
                            TEST_ASSERT_EQUAL_MEMORY(&place, (const double *)m->positions + 3 * n + d,
                                                     sizeof place);
                        else
                            TEST_ASSERT_EQUAL_FLOAT((float)place,
                                                    ((const float *)m->positions)[3 * n + (uint64_t)d]);
                    }
                    n++;
                }
    TEST_ASSERT_EQUAL_UINT64(n, m->vertex_count);
}

static bvx_certificate certify(const bvx_mesh *m)
{
    bvx_certificate c;
    bvx_mesh_view view;

    bvx_mesh_view_of(m, &view);
    /* equal positions are one: there are none */
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_check(ctx, &view, 1, &c));
    if (m->triangle_count == 0) return c;
    TEST_ASSERT_TRUE(c.closed && c.edge_manifold && c.vertex_manifold && c.oriented);
    TEST_ASSERT_EQUAL_UINT64(m->vertex_count, c.vertices);
    TEST_ASSERT_EQUAL_UINT64(0, c.collapsed + c.degenerate + c.duplicates);
    return c;
}

/* Vertices, triangles and certificate of both types of positions; returns the certificate of f64. */
static bvx_certificate check_scalar(const test_volume *t, const bvx_scalar_options *options)
{
    bvx_scalar_options o = *options;
    bvx_extract_options e = {.struct_size = sizeof e};
    bvx_mesh m = {0}, bits = {0}, floats = {0};
    bvx_grid g = {0};
    bvx_volume_report r, counted;
    bvx_certificate c;

    o.report = &r;
    e.face_rule = o.face_rule;
    e.position_type = BVX_F64;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_extract_scalar(ctx, &t->view, &o, &m), bvx_last_message(ctx));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_threshold(ctx, &t->view, o.below ? -INFINITY : o.level,
                                                  o.below ? o.level : INFINITY, &counted, &g));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_surface(ctx, &g, &e, &bits));
    TEST_ASSERT_EQUAL_MEMORY(&counted, &r, sizeof r);
    TEST_ASSERT_EQUAL_UINT64(bits.vertex_count, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(bits.triangle_count, m.triangle_count);
    if (m.triangle_count != 0)
        TEST_ASSERT_EQUAL_MEMORY(bits.triangles, m.triangles, (size_t)m.triangle_count * 12);
    check_vertices(t, &o, &m);
    c = certify(&m);
    o.position_type = BVX_F32;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_scalar(ctx, &t->view, &o, &floats));
    check_vertices(t, &o, &floats);
    certify(&floats);
    bvx_mesh_free(ctx, &floats);
    bvx_mesh_free(ctx, &bits);
    bvx_mesh_free(ctx, &m);
    bvx_grid_free(ctx, &g);
    return c;
}

static void test_scalar_noise_of_every_type(void)
{
    static const int32_t size[3] = {67, 9, 6};

    for (int32_t type = BVX_SAMPLE_U8; type <= BVX_SAMPLE_F64; type++)
        for (int rule = 0; rule < 2; rule++) {
            bvx_scalar_options o = level_options(50);
            test_volume t;
            o.face_rule = rule;
            o.below = (type + rule) % 2;
            make_volume(&t, type, size, rule, type % 2 == 0 ? x_first : z_first, type, rule);
            fill_noise(&t, 1, 100); /* many samples equal the level */
            check_scalar(&t, &o);
            o.level = 50.25;
            check_scalar(&t, &o);
            free_volume(&t);
        }
}

/* Values at the level itself, signed zeros, and noise of few values, where most cut edges end at the
 * level. */
static void test_scalar_values_at_the_level(void)
{
    static const int32_t size[3] = {66, 8, 8};

    for (int below = 0; below < 2; below++) {
        bvx_scalar_options o = level_options(0);
        test_volume t;
        o.below = below;
        make_volume(&t, BVX_SAMPLE_F32, size, 0, x_first, 2, 4);
        fill_noise(&t, -1, 1);
        for (int32_t x = 0; x < 66; x += 3)
            if (t.value[value_index(&t, x, 3, 3)] == 0.0) set_value(&t, x, 3, 3, -0.0);
        check_scalar(&t, &o);
        free_volume(&t);
    }
}

static void test_scalar_nan_and_infinity_are_outside(void)
{
    static const int32_t size[3] = {65, 9, 9};
    double const odd[4] = {NAN, INFINITY, -INFINITY, 1e308};

    for (int i = 0; i < 4; i++) {
        bvx_scalar_options o = level_options(i == 3 ? -1e308 : 0);
        test_volume t;
        o.below = i & 1;
        make_volume(&t, i < 2 ? BVX_SAMPLE_F32 : BVX_SAMPLE_F64, size, 0, x_first, 0, 0);
        fill_noise(&t, -20, 20);
        for (int n = 0; n < 900; n++)
            set_value(&t, (int32_t)maker_below(&seed, 65), (int32_t)maker_below(&seed, 9),
                      (int32_t)maker_below(&seed, 9),
                      n % 5 == 4 && i >= 2 ? -1.7e308 : odd[i >= 2 ? n % 4 : n % 3]);
        check_scalar(&t, &o);
        free_volume(&t);
    }
}

typedef double field_fn(double x, double y, double z);

static double ball(double x, double y, double z)
{
    return 1.0 - sqrt(x * x + y * y + z * z);
}

static double ring(double x, double y, double z)
{
    double const r = sqrt(x * x + y * y) - 0.9;
    return 0.4 - sqrt(r * r + z * z);
}

static double gyroid(double x, double y, double z)
{
    return sin(5 * x) * cos(5 * y) + sin(5 * y) * cos(5 * z) + sin(5 * z) * cos(5 * x);
}

static bvx_certificate check_field(field_fn *field, int32_t n)
{
    bvx_scalar_options const o = level_options(0);
    int32_t const size[3] = {n, n, n};
    bvx_certificate c;
    test_volume t;

    make_volume(&t, BVX_SAMPLE_F64, size, 0, x_first, 0, 0);
    for (int a = 0; a < 3; a++) {
        t.view.lattice.origin[a] = -1.5;
        t.view.lattice.spacing[a] = 3.0 / n;
    }
    for (int32_t z = 0; z < n; z++)
        for (int32_t y = 0; y < n; y++)
            for (int32_t x = 0; x < n; x++)
                set_value(
                    &t, x, y, z,
                    field(-1.5 + (x + 0.5) * 3 / n, -1.5 + (y + 0.5) * 3 / n, -1.5 + (z + 0.5) * 3 / n));
    c = check_scalar(&t, &o);
    free_volume(&t);
    return c;
}

static void test_scalar_of_known_shapes(void)
{
    int const brief = getenv("BVX_QUICK") != NULL;
    int32_t const n = brief ? 30 : 60;
    double const pi = 3.14159265358979;
    bvx_certificate c = check_field(ball, n);

    TEST_ASSERT_EQUAL_INT64(2, c.euler);
    TEST_ASSERT_DOUBLE_WITHIN(brief ? 0.03 : 0.008, 4 * pi / 3, c.volume);
    TEST_ASSERT_DOUBLE_WITHIN(brief ? 0.1 : 0.03, 4 * pi, c.area);
    c = check_field(ring, n);
    TEST_ASSERT_EQUAL_INT64(0, c.euler);
    TEST_ASSERT_EQUAL_UINT64(1, c.components);
    TEST_ASSERT_DOUBLE_WITHIN(brief ? 0.05 : 0.02, 2 * pi * pi * 0.9 * 0.16, c.volume);
    c = check_field(gyroid, n); /* cut by the sides, which close it; half of the box is inside */
    TEST_ASSERT_DOUBLE_WITHIN(0.6, 13.5, c.volume);
}

/* A body that the sides cut ends on them. */
static void test_scalar_full_volume_is_its_box(void)
{
    static const int32_t size[3] = {70, 3, 4};
    bvx_scalar_options const o = level_options(1);
    bvx_certificate c;
    test_volume t;

    make_volume(&t, BVX_SAMPLE_U8, size, 0, x_first, 0, 0);
    fill_noise(&t, 1, 9);
    c = check_scalar(&t, &o);
    TEST_ASSERT_EQUAL_DOUBLE(-3.25, c.box.low[0]);
    TEST_ASSERT_EQUAL_DOUBLE(-3.25 + 70 * 0.5, c.box.high[0]);
    TEST_ASSERT_EQUAL_DOUBLE(10.5 + 3 * 0.75, c.box.high[1]);
    TEST_ASSERT_EQUAL_DOUBLE(4 * 1.25, c.box.high[2]);
    free_volume(&t);
}

/* ---- windows, threads, paths ---- */

static bvx_volume_view window_of(const test_volume *t, const int32_t low[3], const int32_t size[3])
{
    bvx_volume_view v = t->view;
    int64_t at = 0;

    for (int a = 0; a < 3; a++) {
        v.low[a] += low[a];
        v.size[a] = size[a];
        at += low[a] * t->view.strides[a];
    }
    v.samples = (const uint8_t *)t->view.samples + at;
    return v;
}

/* Windows of step samples that overlap by one layer, open where they meet. */
static void check_windows(const test_volume *t, const int32_t step[3], int32_t type)
{
    bvx_scalar_options o = level_options(50);
    bvx_mesh whole = {0}, merged = {0}, part[64];
    uint64_t parts = 0;

    o.keys = 1;
    o.position_type = type;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_scalar(ctx, &t->view, &o, &whole));
    for (int32_t z = 0; z < t->view.size[2] - 1; z += step[2])
        for (int32_t y = 0; y < t->view.size[1] - 1; y += step[1])
            for (int32_t x = 0; x < t->view.size[0] - 1; x += step[0]) {
                int32_t const low[3] = {x, y, z};
                int32_t size[3];
                bvx_volume_view v;
                o.open_sides = 0;
                for (int a = 0; a < 3; a++) {
                    int const last = low[a] + step[a] + 1 >= t->view.size[a];
                    size[a] = last ? t->view.size[a] - low[a] : step[a] + 1;
                    if (low[a] > 0) o.open_sides |= 1 << 2 * a;
                    if (!last) o.open_sides |= 2 << 2 * a;
                }
                v = window_of(t, low, size);
                TEST_ASSERT_TRUE(parts < 64);
                memset(&part[parts], 0, sizeof part[parts]);
                TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_scalar(ctx, &v, &o, &part[parts++]));
            }
    TEST_ASSERT_TRUE(parts > 1);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_merge(ctx, part, parts, &merged));
    TEST_ASSERT_EQUAL_UINT64(whole.vertex_count, merged.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(whole.triangle_count, merged.triangle_count);
    TEST_ASSERT_EQUAL_MEMORY(whole.positions, merged.positions,
                             (size_t)whole.vertex_count * (type == BVX_F32 ? 12 : 24));
    TEST_ASSERT_EQUAL_MEMORY(whole.triangles, merged.triangles, (size_t)whole.triangle_count * 12);
    TEST_ASSERT_EQUAL_MEMORY(whole.vertex_keys, merged.vertex_keys, (size_t)whole.vertex_count * 8);
    while (parts > 0) bvx_mesh_free(ctx, &part[--parts]);
    bvx_mesh_free(ctx, &merged);
    bvx_mesh_free(ctx, &whole);
}

static void test_scalar_windows_merge_to_the_whole(void)
{
    static const int32_t size[3] = {100, 17, 13}, steps[3][3] = {{64, 16, 12}, {37, 5, 4}, {99, 3, 3}};
    test_volume t;

    make_volume(&t, BVX_SAMPLE_F32, size, 1, x_first, 0, 0);
    fill_noise(&t, 0, 100);
    for (int n = 0; n < 300; n++)
        set_value(&t, (int32_t)maker_below(&seed, 100), (int32_t)maker_below(&seed, 17),
                  (int32_t)maker_below(&seed, 13), n % 2 ? NAN : INFINITY);
    for (int i = 0; i < 3; i++) check_windows(&t, steps[i], i == 1 ? BVX_F32 : BVX_F64);
    free_volume(&t);
}

static uint64_t hash_of(const test_volume *t, int32_t threads, int32_t cpu)
{
    bvx_scalar_options const o = level_options(50);
    bvx_mesh m = {0};
    uint64_t hash;

    open_again(threads, cpu);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_scalar(ctx, &t->view, &o, &m));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_mesh_hash(ctx, &m, &hash));
    bvx_mesh_free(ctx, &m);
    return hash;
}

static void test_scalar_is_the_same_on_all_paths_and_threads(void)
{
    static const int32_t size[3] = {130, 40, 30};

    for (int i = 0; i < 3; i++) {
        test_volume t;
        uint64_t hash;
        make_volume(&t,
                    i == 0   ? BVX_SAMPLE_F32
                    : i == 1 ? BVX_SAMPLE_U16
                             : BVX_SAMPLE_F64,
                    size, 0, i == 2 ? z_first : x_first, i, 0);
        fill_noise(&t, 0, 100);
        hash = hash_of(&t, 1, BVX_CPU_PORTABLE);
        TEST_ASSERT_EQUAL_HEX64(hash, hash_of(&t, 1, BVX_CPU_BEST));
        TEST_ASSERT_EQUAL_HEX64(hash, hash_of(&t, 2, BVX_CPU_BEST));
        TEST_ASSERT_EQUAL_HEX64(hash, hash_of(&t, 5, BVX_CPU_PORTABLE));
        free_volume(&t);
    }
}

static void test_scalar_local_frame_and_open_sides(void)
{
    static const int32_t size[3] = {40, 5, 5};
    bvx_scalar_options o = level_options(50);
    bvx_mesh world = {0}, local = {0};
    test_volume t;

    make_volume(&t, BVX_SAMPLE_U8, size, 1, x_first, 0, 0);
    fill_noise(&t, 0, 100);
    o.open_sides = 63;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_scalar(ctx, &t.view, &o, &world));
    o.local_frame = 1;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_scalar(ctx, &t.view, &o, &local));
    TEST_ASSERT_EQUAL_UINT64(world.vertex_count, local.vertex_count);
    TEST_ASSERT_EQUAL_DOUBLE(t.view.lattice.origin[1], local.frame[1]);
    for (uint64_t i = 0; i < 3 * world.vertex_count; i++)
        TEST_ASSERT_DOUBLE_WITHIN(1e-12, ((double *)world.positions)[i],
                                  ((double *)local.positions)[i] + local.frame[i % 3]);
    bvx_mesh_free(ctx, &local);
    bvx_mesh_free(ctx, &world);
    free_volume(&t);
}

static void test_scalar_refusals(void)
{
    static const int32_t size[3] = {5, 5, 5};
    bvx_scalar_options good, o;
    bvx_mesh m = {0};
    test_volume t;

    make_volume(&t, BVX_SAMPLE_F32, size, 0, x_first, 0, 0);
    good = level_options(0);
#define REFUSED(field, value, status)                                          \
    o = good;                                                                  \
    o.field = value;                                                           \
    TEST_ASSERT_EQUAL_INT32(status, bvx_extract_scalar(ctx, &t.view, &o, &m)); \
    TEST_ASSERT_NULL(m.positions)
    REFUSED(level, NAN, BVX_ERR_ARGUMENT);
    REFUSED(below, 2, BVX_ERR_ARGUMENT);
    REFUSED(face_rule, 2, BVX_ERR_ARGUMENT);
    REFUSED(position_type, 3, BVX_ERR_ARGUMENT);
    REFUSED(open_sides, 64, BVX_ERR_ARGUMENT);
    REFUSED(keys, 2, BVX_ERR_ARGUMENT);
    REFUSED(local_frame, -1, BVX_ERR_ARGUMENT);
    REFUSED(reserved[1], 1, BVX_ERR_ARGUMENT);
    REFUSED(struct_size, 3, BVX_ERR_ARGUMENT);
#undef REFUSED
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_scalar(ctx, NULL, &good, &m));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_scalar(ctx, &t.view, &good, NULL));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_extract_scalar(NULL, &t.view, &good, &m));
    t.view.lattice.origin[0] = 1e9;
    good.position_type = BVX_F32;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_extract_scalar(ctx, &t.view, &good, &m));
    t.view.lattice.origin[0] = 1e18;
    good.position_type = BVX_F64;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_extract_scalar(ctx, &t.view, &good, &m));
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_RANGE, bvx_extract_scalar(ctx, &t.view, NULL, &m));
    free_volume(&t);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_scalar_noise_of_every_type);
    RUN_TEST(test_scalar_values_at_the_level);
    RUN_TEST(test_scalar_nan_and_infinity_are_outside);
    RUN_TEST(test_scalar_of_known_shapes);
    RUN_TEST(test_scalar_full_volume_is_its_box);
    RUN_TEST(test_scalar_windows_merge_to_the_whole);
    RUN_TEST(test_scalar_is_the_same_on_all_paths_and_threads);
    RUN_TEST(test_scalar_local_frame_and_open_sides);
    RUN_TEST(test_scalar_refusals);
    return UNITY_END();
}
