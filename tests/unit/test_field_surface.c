/* test_field_surface.c - bvx_extract_field_surface against marching cubes
 * cell by cell with the paper's formula written out; known shapes. */
#include "surface/field_surface.h"
#include "tools/surface_oracle.h"
#include "unit/field_surface_support.h"

/* ---- the oracle ---- */

/* The number of the value at a centre of the window, by counting all before it; -1: none. */
static int64_t oracle_value(int32_t x, int32_t y, int32_t z)
{
    int64_t n = 0;
    if (!oracle_voxel(&field.band, x, y, z)) return -1;
    for (int32_t k = 0; k <= z; k++)
        for (int32_t j = 0; j < (k == z ? y + 1 : field.band.size[1]); j++)
            for (int32_t i = 0; i < (k == z && j == y ? x : field.band.size[0]); i++)
                n += bvx_grid_get(&field.band, i, j, k);
    return n;
}

static double oracle_read(const void *values, int64_t n)
{
    return field.value_type == BVX_F32 ? (double)((const float *)values)[n] : ((const double *)values)[n];
}

static double oracle_dot(const double a[3], const double b[3])
{
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

/* The paper's lambda with the right sign, its special cases by the contract; V = 0, W along the axis. by: 0
 * vector, 1 distances or a clamp, 2 the middle, -1 too near to a limit to tell. */
static double oracle_lambda(int32_t interpolation, double const w[3], const double a[3], const double b[3],
                            double da, double db, int high_inside, int *by)
{
    double const ab[3] = {b[0] - a[0], b[1] - a[1], b[2] - a[2]};
    double const ww = oracle_dot(w, w);
    double const abab = oracle_dot(ab, ab);
    double const wab = oracle_dot(w, ab);
    double const wa = oracle_dot(w, a);
    double const below = ww * abab - wab * wab, above = oracle_dot(ab, a) * wab - abab * wa;
    double lambda = -above / below;
    int parallel = 0;

    *by = 0;
    if (interpolation == BVX_EDGE_MIDDLE) {
        *by = 2;
        return 0.5;
    }
    if (interpolation != BVX_EDGE_SCALAR) {
        if (abab == 0) lambda = wa / ww;
        else if (abab < 1e-9 * ww ||
                 below < 1e-6 * ww * abab) { /* limits lie near; along the edge it is plain */
            if (ab[0] * ab[0] * ab[1] * ab[1] + ab[1] * ab[1] * ab[2] * ab[2] +
                        ab[2] * ab[2] * ab[0] * ab[0] !=
                    0 ||
                below != 0 || abab < 1e-9 * ww)
                *by = -1;
            parallel = 1;
        }
        if (*by == -1) return 0;
        if (!parallel && (fabs(lambda) < 1e-9 || fabs(lambda - 1) < 1e-9)) *by = -1;
        if (!parallel && lambda >= 0 && lambda <= 1) return lambda;
        if (interpolation == BVX_EDGE_PAPER) {
            if (*by == 0) *by = 1;
            return parallel ? high_inside : lambda < 0 ? 0 : 1;
        }
    }
    if (*by == 0) *by = da + db > 0 ? 1 : 2;
    return da + db > 0 ? da / (da + db) : 0.5;
}

/* Place vertex v of the oracle's surface; what placed it. */
static int oracle_place(oracle_surface *s, uint64_t v, int32_t interpolation, int local)
{
    const bvx_grid *const g = &field.inside;
    int32_t const axis = s->edge[v][3];
    int32_t const at[3] = {s->edge[v][0] - g->low[0], s->edge[v][1] - g->low[1], s->edge[v][2] - g->low[2]};
    int32_t const next[3] = {at[0] + (axis == 0), at[1] + (axis == 1), at[2] + (axis == 2)};
    int64_t const low = oracle_value(at[0], at[1], at[2]), high = oracle_value(next[0], next[1], next[2]);
    double w[3] = {0, 0, 0}, a[3], b[3], t = 0.5, da = 0, db = 0;
    int by = 2;

    w[axis] = g->lattice.spacing[axis];
    if (low >= 0 && high >= 0) {
        for (int k = 0; k < 3; k++) {
            a[k] = oracle_read(field.vectors, 3 * low + k);
            b[k] = w[k] + oracle_read(field.vectors, 3 * high + k);
        }
        da = fabs(oracle_read(field.distances, low));
        db = fabs(oracle_read(field.distances, high));
        t = oracle_lambda(interpolation, w, a, b, da, db, oracle_voxel(g, next[0], next[1], next[2]), &by);
    }
    t = t < 1.0 / 128 ? 1.0 / 128 : t > 127.0 / 128 ? 127.0 / 128 : t;
    for (int k = 0; k < 3; k++) {
        double const origin = local ? 0.0 : g->lattice.origin[k];
        s->positions[3 * v + (uint64_t)k] = origin + (s->edge[v][k] + 0.5 + (k == axis ? t : 0)) *
                                                         g->lattice.spacing[k];
    }
    return by;
}

static void assert_is_oracle(const bvx_field_surface_options *given, uint64_t seen[3])
{
    bvx_field_surface_options o = *given;
    bvx_field_surface_report report;
    bvx_extract_options e = {.struct_size = sizeof e};
    uint64_t count[3] = {0, 0, 0}, unsure = 0;
    oracle_surface s;
    bvx_mesh m;

    o.report = &report;
    e.face_rule = o.placing.face_rule;
    e.local_frame = o.placing.local_frame;
    m = surface_of(ctx, NULL, &o);
    s = oracle_extract(&field.inside, &e);
    TEST_ASSERT_EQUAL_UINT64(s.vertices, m.vertex_count);
    TEST_ASSERT_EQUAL_UINT64(s.triangle_count, m.triangle_count);
    if (s.triangle_count != 0)
        TEST_ASSERT_EQUAL_INT(0, memcmp(s.triangles, m.triangles, (size_t)s.triangle_count * 12));
    for (uint64_t v = 0; v < s.vertices; v++) {
        int const by = oracle_place(&s, v, o.placing.interpolation, o.placing.local_frame);
        unsure += by < 0;
        if (by < 0) continue;
        count[by]++;
        for (uint64_t a = 0; a < 3; a++) {
            if (o.placing.position_type == BVX_F64)
                TEST_ASSERT_DOUBLE_WITHIN(1e-8, s.positions[3 * v + a],
                                          ((const double *)m.positions)[3 * v + a]);
            else
                TEST_ASSERT_DOUBLE_WITHIN(1e-5, s.positions[3 * v + a],
                                          (double)((const float *)m.positions)[3 * v + a]);
        }
    }
    TEST_ASSERT_EQUAL_UINT64(s.vertices, report.edges);
    TEST_ASSERT_TRUE(report.scalar >= count[1] && report.scalar <= count[1] + unsure);
    TEST_ASSERT_TRUE(report.middle >= count[2] && report.middle <= count[2] + unsure);
    for (int a = 0; a < 3; a++) {
        TEST_ASSERT_TRUE(m.frame[a] == (o.placing.local_frame ? field.inside.lattice.origin[a] : 0.0));
        seen[a] += count[a];
    }
    bvx_mesh_free(ctx, &m);
    oracle_surface_free(&s);
}

static void test_surface_is_the_oracles(void)
{
    uint64_t seen[3] = {0, 0, 0};

    for (int n = 0; n < (quick ? 40 : 400); n++) {
        bvx_lattice const l = random_lattice();
        bvx_field_surface_options o = surface_options(0);
        o.placing.interpolation = BVX_EDGE_VECTOR + maker_below(&seed, 4);
        o.placing.face_rule = maker_below(&seed, 2);
        o.placing.position_type = maker_below(&seed, 2) ? BVX_F32 : BVX_F64;
        o.placing.local_frame = maker_below(&seed, 2);
        field_maker_free(ctx, &field);
        field_maker_noise(ctx, &seed, &l, 2 + maker_below(&seed, 13), 12 + maker_below(&seed, 5), 1, 0,
                          maker_below(&seed, 2) ? BVX_F32 : BVX_F64, &field);
        assert_is_oracle(&o, seen);
    }
    for (int a = 0; a < 3; a++) TEST_ASSERT_TRUE(seen[a] > (quick ? 100 : 1000));
}

/* Rows of several words, so that numbers are carried from word to word. */
static void test_surface_is_the_oracles_on_long_rows(void)
{
    double const origin[3] = {-70, 2, 2}, spacing[3] = {1, 1, 1};
    uint64_t seen[3] = {0, 0, 0};
    static int32_t const lengths[] = {63, 64, 65, 127, 128, 129, 200};

    for (size_t n = 0; n < sizeof lengths / sizeof *lengths; n++) {
        bvx_lattice const l = lattice_at(origin, spacing, lengths[n], 3, 2);
        bvx_field_surface_options o = surface_options(0);
        o.placing.position_type = BVX_F64;
        field_maker_free(ctx, &field);
        field_maker_noise(ctx, &seed, &l, 8, 14, 1, 0, BVX_F32, &field);
        assert_is_oracle(&o, seen);
    }
    TEST_ASSERT_TRUE(seen[0] > 100 && seen[1] > 100 && seen[2] > 100);
}

static void test_noise_never_crosses(void)
{
    uint64_t triangles = 0;
    int const trials = trial_count(50, 500, 2000);

    for (int n = 0; n < trials; n++) {
        bvx_lattice const l = random_lattice();
        bvx_field_surface_options o = surface_options(0);
        bvx_mesh m;
        o.placing.interpolation = maker_below(&seed, 5);
        o.placing.face_rule = maker_below(&seed, 2);
        o.placing.position_type = maker_below(&seed, 2) ? BVX_F32 : BVX_F64;
        field_maker_free(ctx, &field);
        field_maker_noise(ctx, &seed, &l, 2 + maker_below(&seed, 13), 12 + maker_below(&seed, 5), 2, 0,
                          BVX_F32, &field);
        m = surface_of(ctx, NULL, &o);
        assert_certificate(&m);
        triangles += m.triangle_count;
        bvx_mesh_free(ctx, &m);
    }
    printf("noise: %d surfaces of %lu triangles: none crosses\n", trials, (unsigned long)triangles);
}

/* Numbers that are none. */
static void test_numbers_that_are_none_do_no_harm(void)
{
    for (int n = 0; n < (quick ? 20 : 200); n++) {
        bvx_lattice const l = random_lattice();
        bvx_field_surface_options o = surface_options(maker_below(&seed, 2));
        bvx_mesh m;
        field_maker_free(ctx, &field);
        field_maker_noise(ctx, &seed, &l, 8, 15, 1, 0, BVX_F64, &field);
        for (uint64_t i = 0; i < 3 * field.value_count; i++) {
            static double const odd[] = {NAN, INFINITY, -INFINITY, 1e308, -1e308, 0.0, 1e-320};
            int32_t const k = maker_below(&seed, 14);
            if (k < 7) ((double *)field.vectors)[i] = odd[k];
            if (k < 7 && i < field.value_count) ((double *)field.distances)[i] = odd[k];
        }
        o.placing.interpolation = BVX_EDGE_VECTOR + maker_below(&seed, 4);
        o.placing.position_type = BVX_F64;
        m = surface_of(ctx, NULL, &o);
        assert_certificate(&m);
        bvx_mesh_free(ctx, &m);
    }
}

/* ---- shapes ---- */

/* A box along the lattice: flat faces come out where they are, by vectors and by distances. */
static void test_faces_of_a_box_are_exact(void)
{
    double const origin[3] = {2, 2, 2};
    double const spacing[3] = {0.5, 0.25, 1};
    double const low[3] = {3.6, 3.4, 3.8};
    double const high[3] = {7.1, 6.9, 8.3};
    bvx_lattice const l = lattice_at(origin, spacing, 14, 24, 8);
    bvx_field_surface_options o = surface_options(0);
    bvx_mesh m;
    const double *p;
    int on[3] = {0, 0, 0};

    maker_box(&mesh, low, high);
    field_maker_measure(ctx, &mesh, &l, INFINITY, BVX_F64, &field);
    o.placing.position_type = BVX_F64;
    m = surface_of(ctx, NULL, &o);
    assert_certificate(&m);
    p = m.positions;
    for (uint64_t v = 0; v < m.vertex_count; v++, p += 3)
        for (int a = 0; a < 3; a++) /* the middle of a face, where neither end is nearer to another face */
            if (fabs(p[(a + 1) % 3] - 5.3) < 0.8 && fabs(p[(a + 2) % 3] - 5.3) < 0.8) {
                double const d = fabs(p[a] - low[a]) < fabs(p[a] - high[a]) ? p[a] - low[a] : p[a] - high[a];
                TEST_ASSERT_DOUBLE_WITHIN(1e-12, 0.0, d);
                on[a]++;
            }
    TEST_ASSERT_TRUE(on[0] > 0 && on[1] > 0 && on[2] > 0);
    bvx_mesh_free(ctx, &m);
}

/* A window of a lattice holds the whole's vertices on edges between its own centres. */
static void test_a_window_has_the_same_cuts(void)
{
    double const origin[3] = {2, 2, 2};
    double const spacing[3] = {0.5, 0.5, 0.5};
    double const centre[3] = {5, 5, 5};
    double const radius[3] = {2, 2.2, 1.9};
    bvx_lattice const l = lattice_at(origin, spacing, 12, 12, 12);
    bvx_window const w = {{3, 2, 4}, {6, 7, 5}};
    bvx_field_surface_options o = surface_options(0);
    bvx_field whole;
    bvx_mesh all, part;
    uint64_t found = 0;

    maker_star(&mesh, &seed, centre, radius, 0.1, 6, 9, 65536);
    field_maker_measure(ctx, &mesh, &l, INFINITY, BVX_F64, &field);
    o.placing.position_type = BVX_F64;
    all = surface_of(ctx, NULL, &o);
    whole = field;
    memset(&field, 0, sizeof field);
    field.sign = BVX_FILL_PARITY;
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, &w, &field.inside));
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_grid_create(ctx, &l, &w, &field.band));
    for (int32_t z = 0; z < w.size[2]; z++)
        for (int32_t y = 0; y < w.size[1]; y++)
            for (int32_t x = 0; x < w.size[0]; x++) {
                bvx_grid_set(&field.inside, x, y, z,
                             bvx_grid_get(&whole.inside, x + w.low[0], y + w.low[1], z + w.low[2]));
                bvx_grid_set(&field.band, x, y, z, 1);
            }
    field_maker_open(&field, BVX_F64);
    for (int32_t z = 0, n = 0; z < w.size[2]; z++)
        for (int32_t y = 0; y < w.size[1]; y++)
            for (int32_t x = 0; x < w.size[0]; x++, n++) {
                size_t const from = ((size_t)(z + w.low[2]) * 12 + (size_t)(y + w.low[1])) * 12 +
                                    (size_t)(x + w.low[0]);
                field_maker_put(&field, (uint64_t)n, (const double *)whole.vectors + 3 * from,
                                ((const double *)whole.distances)[from], 0);
            }
    part = surface_of(ctx, NULL, &o);
    assert_certificate(&part);
    for (uint64_t v = 0; v < part.vertex_count; v++) {
        const double *const p = (const double *)part.positions + 3 * v;
        int inner = 1;
        for (int a = 0; a < 3; a++) {
            double const at = (p[a] - 2) / 0.5 - 0.5 - w.low[a];
            inner &= at >= 0 && at <= w.size[a] - 1;
        }
        if (!inner) continue;
        for (uint64_t u = 0; u < all.vertex_count; u++)
            if (memcmp(p, (const double *)all.positions + 3 * u, 24) == 0) {
                found++;
                inner = 0;
            }
        TEST_ASSERT_EQUAL_INT(0, inner);
    }
    TEST_ASSERT_TRUE(found > 20);
    bvx_mesh_free(ctx, &all);
    bvx_mesh_free(ctx, &part);
    field_maker_free(ctx, &whole);
}

/* ---- the entry for other rooms ---- */

static double value_length(int64_t n)
{
    const double *const v = (const double *)field.vectors + 3 * n;
    return sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
}

static void place_missing(const void *user, int32_t count, const bvxi_missing_edge *edge, double *ratio)
{
    (void)user;
    TEST_ASSERT_TRUE(count > 0 && count <= BVXI_MISSING_MOST);
    for (int32_t e = 0; e < count; e++) {
        int32_t const axis = edge[e].axis, i = edge[e].at[0], j = edge[e].at[1], k = edge[e].at[2];
        int64_t const low = oracle_value(i, j, k);
        int64_t const high = oracle_value(i + (axis == 0), j + (axis == 1), k + (axis == 2));
        TEST_ASSERT_TRUE(low < 0 || high < 0 || value_length(low) + value_length(high) > 1);
        TEST_ASSERT_TRUE(oracle_voxel(&field.inside, i, j, k) !=
                         oracle_voxel(&field.inside, i + (axis == 0), j + (axis == 1), k + (axis == 2)));
        ratio[e] = 0.25;
    }
}

static void test_edges_without_values_are_asked_for(void)
{
    double const origin[3] = {2, 2, 2}, spacing[3] = {1, 1, 1};
    bvx_lattice const l = lattice_at(origin, spacing, 7, 6, 5);
    bvx_field_surface_options o = surface_options(0);
    bvx_field_surface_report report;
    bvxi_cut_rule v = {0};
    bvxi_sparse values;
    uint64_t quarters = 0;
    bvx_mesh m = {0};

    field_maker_noise(ctx, &seed, &l, 8, 8, 1, 0, BVX_F64, &field);
    o.report = &report;
    o.placing.position_type = BVX_F64;
    values = bvxi_sparse_of_field(&field);
    values.distances = NULL; /* the vectors' lengths */
    v.values = &values;
    v.missing = place_missing;
    TEST_ASSERT_EQUAL_INT32(BVX_OK,
                            BVXI_SCOPE(ctx, bvxi_field_surface(ctx, "test", &field.inside, &v, &o, &m)));
    assert_certificate(&m);
    for (uint64_t i = 0; i < 3 * m.vertex_count; i++) {
        double const at = ((const double *)m.positions)[i] - 2.5;
        quarters += at - floor(at) == 0.25;
    }
    TEST_ASSERT_TRUE(report.lids > 20 && quarters == report.lids && report.middle == 0);
    bvx_mesh_free(ctx, &m);
}

/* ---- the same everywhere ---- */

static void test_threads_and_code_paths_do_not_show(void)
{
    double const origin[3] = {2, 2, 2}, spacing[3] = {0.1, 0.2, 0.15};
    bvx_lattice const l = lattice_at(origin, spacing, 130, 40, 30);
    bvx_field_surface_options o = surface_options(0);
    bvx_mesh first;

    field_maker_noise(ctx, &seed, &l, 8, 15, 1, 0, BVX_F32, &field);
    first = surface_of(ctx, NULL, &o);
    for (int32_t threads = 1; threads <= 8; threads += 3)
        for (int32_t cpu = BVX_CPU_PORTABLE; cpu >= 0; cpu -= BVX_CPU_PORTABLE) {
            bvx_context *const other = suite_context(threads, cpu);
            bvx_mesh m = surface_of(other, NULL, &o);
            assert_same_surface(&first, &m);
            bvx_mesh_free(other, &m);
            bvx_context_destroy(other);
        }
    bvx_mesh_free(ctx, &first);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_surface_is_the_oracles);
    RUN_TEST(test_surface_is_the_oracles_on_long_rows);
    RUN_TEST(test_noise_never_crosses);
    RUN_TEST(test_numbers_that_are_none_do_no_harm);
    RUN_TEST(test_faces_of_a_box_are_exact);
    RUN_TEST(test_a_window_has_the_same_cuts);
    RUN_TEST(test_edges_without_values_are_asked_for);
    RUN_TEST(test_threads_and_code_paths_do_not_show);
    return UNITY_END();
}
