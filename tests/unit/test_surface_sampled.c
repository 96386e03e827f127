/* test_surface_sampled.c - the sampled surface against all points of the subdivision, one by one; its
 * connectedness; the report; and the lists of attached triangles of all three definitions. */
#include "surface_voxels_support.h"

static void test_small_triangles_mark_their_points(void)
{
    check_small_triangles(SAMPLED, quick ? 150 : 1200);
}

static void test_meshes_and_windows_are_the_oracles(void)
{
    check_meshes(SAMPLED, quick ? 24 : 240);
}

static void test_order_types_and_strides_change_nothing(void)
{
    check_views(SAMPLED);
}

static void test_contexts_and_windows_agree(void)
{
    check_contexts(SAMPLED);
}

static void test_workers_share_the_triangles(void)
{
    check_workers(SAMPLED);
}

/* A triangle with corners at the ends of the fixed point, about a window. */
static void test_huge_triangles(void)
{
    for (int32_t n = 0; n < (quick ? 2 : 12); n++) {
        bvx_lattice l = lattice_of(1000, 1000, 1000);
        bvx_window const w = {{400, 300, 500}, {70, 40, 30}};
        maker_clear(&mesh);
        for (int i = 0; i < 3; i++) {
            uint32_t v[3];
            for (int c = 0; c < 3; c++)
                v[c] = maker_vertex(&mesh, 435 + maker_below(&seed, 2000) - 1000,
                                    320 + maker_below(&seed, 2000) - 1000,
                                    515 + maker_below(&seed, 2000) - 1000);
            maker_triangle(&mesh, v[0], v[1], v[2]);
        }
        assert_surface(ctx, &l, &w, SAMPLED, "huge");
    }
}

/* ---- Connectedness ---- */

static uint64_t components26(const bvx_grid *g)
{
    int32_t const nx = g->size[0], ny = g->size[1], nz = g->size[2];
    size_t const n = (size_t)nx * (size_t)ny * (size_t)nz;
    int32_t *const stack = maker_grow(NULL, n * sizeof *stack);
    uint8_t *const seen = maker_grow(NULL, n);
    uint64_t count = 0;

    memset(seen, 0, n);
    for (size_t start = 0; start < n; start++) {
        size_t depth = 0;
        if (seen[start] ||
            !bvx_grid_get(g, (int32_t)start % nx, (int32_t)start / nx % ny, (int32_t)start / nx / ny))
            continue;
        count++;
        stack[depth++] = (int32_t)start;
        seen[start] = 1;
        while (depth > 0) {
            int32_t const at = stack[--depth], x = at % nx, y = at / nx % ny, z = at / nx / ny;
            for (int d = 0; d < 27; d++) {
                int32_t const u = x + d % 3 - 1, v = y + d / 3 % 3 - 1, w = z + d / 9 - 1;
                size_t const next = ((size_t)w * (size_t)ny + (size_t)v) * (size_t)nx + (size_t)u;
                if (u < 0 || v < 0 || w < 0 || u >= nx || v >= ny || w >= nz || seen[next] ||
                    !bvx_grid_get(g, u, v, w))
                    continue;
                seen[next] = 1;
                stack[depth++] = (int32_t)next;
            }
        }
    }
    free(stack);
    free(seen);
    return count;
}

static void test_connected_meshes_are_26_connected(void)
{
    for (int32_t trial = 0; trial < (quick ? 6 : 60); trial++) {
        int32_t const n[3] = {20 + maker_below(&seed, 60), 20 + maker_below(&seed, 30),
                              20 + maker_below(&seed, 30)};
        bvx_lattice const l = lattice_of(n[0], n[1], n[2]);
        bvx_grid g;
        maker_clear(&mesh);
        if (trial % 3 != 0) {
            double const centre[3] = {n[0] * 0.5, n[1] * 0.5, n[2] * 0.5};
            double const radius[3] = {n[0] * 0.45, n[1] * 0.45, n[2] * 0.45};
            maker_star(&mesh, &seed, centre, radius, 0.5, 3 + maker_below(&seed, 20),
                       3 + maker_below(&seed, 20), trial % 3 == 1 ? 65536 : 2);
        } else { /* a strip of long triangles */
            uint32_t v[3];
            for (int c = 0; c < 3; c++)
                v[c] = maker_vertex(&mesh, maker_below(&seed, n[0]), maker_below(&seed, n[1]),
                                    maker_below(&seed, n[2]));
            for (int i = 0; i < 12; i++) {
                maker_triangle(&mesh, v[0], v[1], v[2]);
                v[i % 3] = maker_vertex(&mesh, maker_below(&seed, n[0]), maker_below(&seed, n[1]),
                                        maker_below(&seed, n[2]));
            }
        }
        g = surface_of(&l, SAMPLED);
        TEST_ASSERT_EQUAL_UINT64(1, components26(&g));
        bvx_grid_free(ctx, &g);
    }
}

/* ---- The report ---- */

static void test_counts_what_it_did(void)
{
    for (int32_t trial = 0; trial < 30; trial++) {
        bvx_lattice const l = lattice_of(80, 20, 20);
        bvx_context *const c = surface_context(trial);
        bvx_window const w = random_window(&l);
        bvx_surface_report report = {7, 7, 7, {0, 0, 0, 0}};
        bvx_surface_options o = {.struct_size = sizeof o};
        bvx_mesh_view view;
        bvx_grid g = {0};
        int64_t *q;
        uint64_t triangles = 0, samples = 0, parts = 0;
        make_scan(200, l.dims, 16);
        q = snapped(&l);
        for (size_t t = 0; t < mesh.triangles; t++) {
            touch_oracle const tri = triangle_oracle(q, t, &l);
            int64_t const k = touch_parts(&tri);
            int inside = 1;
            for (int a = 0; a < 3; a++) {
                int64_t const at = touch_floor(tri.p[0][a], INT64_C(1) << tri.f) - w.low[a];
                inside &= at >= 0 && at < w.size[a];
            }
            if (!inside) continue;
            triangles++;
            parts += (uint64_t)k;
            samples += (uint64_t)((k + 1) * (k + 2) / 2);
        }
        free(q);
        view = maker_view(&mesh);
        o.mode = SAMPLED;
        o.window = w;
        o.report = &report;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(c, &view, &l, &o, &g));
        TEST_ASSERT_EQUAL_UINT64(triangles, report.triangles);
        TEST_ASSERT_EQUAL_UINT64(samples, report.samples);
        TEST_ASSERT_EQUAL_UINT64(parts, report.parts);
        bvx_grid_free(c, &g);
        o.mode = trial % 2; /* others count nothing */
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(c, &view, &l, &o, &g));
        TEST_ASSERT_EQUAL_UINT64(0, report.triangles + report.samples + report.parts);
        bvx_grid_free(c, &g);
        bvx_context_destroy(c);
    }
}

/* ---- Attached triangles ---- */

/* The lists are, voxel by voxel in the order of the bits, the triangles
 * that the oracle has touch it, ascending. */
static void assert_attached(bvx_context *c, const bvx_lattice *l, const bvx_window *w, int32_t mode)
{
    size_t const voxels = (size_t)w->size[0] * (size_t)w->size[1] * (size_t)w->size[2];
    uint8_t *const marks = maker_grow(NULL, mesh.triangles * voxels + 1);
    bvx_mesh_view const view = maker_view(&mesh);
    int64_t *const q = snapped(l);
    bvx_attached attached = {0};
    bvx_surface_options o = {.struct_size = sizeof o};
    bvx_grid g = {0};
    uint64_t rank = 0, at = 0;

    memset(marks, 0, mesh.triangles * voxels + 1);
    for (size_t t = 0; t < mesh.triangles; t++) {
        touch_oracle const tri = triangle_oracle(q, t, l);
        touch_mark(&tri, mode, w, marks + t * voxels);
    }
    o.mode = mode;
    o.window = *w;
    o.attached = &attached;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_voxelize_surface(c, &view, l, &o, &g), bvx_last_message(c));
    TEST_ASSERT_EQUAL_UINT64(set_voxels(&g), attached.voxel_count);
    for (size_t i = 0; i < voxels; i++) {
        int32_t const x = (int32_t)(i % (size_t)w->size[0]);
        int32_t const y = (int32_t)(i / (size_t)w->size[0] % (size_t)w->size[1]);
        int32_t const z = (int32_t)(i / (size_t)w->size[0] / (size_t)w->size[1]);
        uint64_t const before = at;
        for (uint32_t t = 0; t < mesh.triangles; t++) {
            if (!marks[t * voxels + i]) continue;
            if (at == before) TEST_ASSERT_EQUAL_UINT64(at, attached.offsets[rank]);
            TEST_ASSERT_TRUE(at < attached.triangle_count);
            TEST_ASSERT_EQUAL_UINT32(t, attached.triangles[at]);
            at++;
        }
        TEST_ASSERT_EQUAL_INT(at > before, bvx_grid_get(&g, x, y, z));
        rank += at > before;
    }
    TEST_ASSERT_EQUAL_UINT64(rank, attached.voxel_count);
    TEST_ASSERT_EQUAL_UINT64(at, attached.triangle_count);
    TEST_ASSERT_EQUAL_UINT64(at, attached.offsets[rank]);
    bvx_attached_free(c, &attached);
    TEST_ASSERT_NULL(attached.offsets);
    bvx_grid_free(c, &g);
    free(marks);
    free(q);
}

static void test_attached_triangles_are_those_that_touch(void)
{
    static const int32_t shapes[][3] = {{20, 12, 13}, {130, 5, 4}, {66, 9, 1}, {1, 20, 20}, {2, 1, 60}};

    for (int32_t trial = 0; trial < (quick ? 15 : 120); trial++) {
        const int32_t *const s = shapes[trial % 5];
        bvx_lattice const l = lattice_of(s[0], s[1], s[2]);
        bvx_context *const c = surface_context(trial / 5);
        bvx_window whole = window_of(&l, NULL), part = random_window(&l);
        if (trial % 2 == 0) make_scan(80, s, trial % 4 == 0 ? 16 : 1);
        else make_random(trial / 2 % KINDS == HUGE ? MIXED : trial / 2 % KINDS, 24, s, l.fraction_bits);
        for (int32_t mode = 0; mode < MODES; mode++) {
            assert_attached(c, &l, &whole, mode);
            assert_attached(c, &l, &part, mode);
        }
        TEST_ASSERT_EQUAL_UINT64(0, bvx_memory_used(c));
        bvx_context_destroy(c);
    }
}

/* An empty surface has an offset and no list. */
static void test_nothing_is_attached_to_nothing(void)
{
    bvx_lattice const l = lattice_of(9, 9, 9);
    double const low[3] = {20, 20, 20}, high[3] = {30, 30, 30};

    for (int i = 0; i < SURFACE_CONTEXTS; i++) {
        bvx_context *const c = surface_context(i);
        for (int32_t mode = 0; mode < MODES; mode++) {
            bvx_attached attached = {0};
            bvx_surface_options o = {.struct_size = sizeof o};
            bvx_mesh_view view;
            bvx_grid g = {0};
            maker_clear(&mesh);
            maker_box(&mesh, low, high);
            view = maker_view(&mesh);
            o.mode = mode;
            o.attached = &attached;
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_voxelize_surface(c, &view, &l, &o, &g));
            TEST_ASSERT_EQUAL_UINT64(0, set_voxels(&g));
            TEST_ASSERT_EQUAL_UINT64(0, attached.voxel_count + attached.triangle_count);
            TEST_ASSERT_NOT_NULL(attached.offsets);
            TEST_ASSERT_EQUAL_UINT64(0, attached.offsets[0]);
            bvx_attached_free(c, &attached);
            bvx_attached_free(c, &attached); /* twice does no harm */
            bvx_grid_free(c, &g);
        }
        bvx_context_destroy(c);
    }
    bvx_attached_free(NULL, NULL);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_small_triangles_mark_their_points);
    RUN_TEST(test_meshes_and_windows_are_the_oracles);
    RUN_TEST(test_order_types_and_strides_change_nothing);
    RUN_TEST(test_contexts_and_windows_agree);
    RUN_TEST(test_workers_share_the_triangles);
    RUN_TEST(test_huge_triangles);
    RUN_TEST(test_connected_meshes_are_26_connected);
    RUN_TEST(test_counts_what_it_did);
    RUN_TEST(test_attached_triangles_are_those_that_touch);
    RUN_TEST(test_nothing_is_attached_to_nothing);
    return UNITY_END();
}
