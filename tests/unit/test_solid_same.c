/* test_solid_same.c - what may not change a solid: place, order, windows,
 * threads, code paths, the amount of work. */
#include "solid_support.h"

#if defined(__SSE2__)
#include <xmmintrin.h>
#endif

/* ---- What may not matter ---- */

static void test_shift_by_whole_voxels_shifts_the_bits(void)
{
    for (int32_t trial = 0; trial < trial_count(6, 20, 40); trial++) {
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
                    TEST_ASSERT_EQUAL_INT(bvx_grid_get(&a, x, y, z),
                                          bvx_grid_get(&b, x + by[0], y + by[1], z + by[2]));
        bvx_grid_free(ctx, &a);
        bvx_grid_free(ctx, &b);
    }
}

static void test_order_and_orientation_change_nothing(void)
{
    for (int32_t trial = 0; trial < trial_count(8, 30, 60); trial++) {
        bvx_lattice const l = lattice_of(66, 14, 15);
        int32_t const fill = BVX_FILL_PARITY + trial % 2;
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

    for (int32_t trial = 0; trial < trial_count(6, 20, 40); trial++) {
        bvx_lattice const l = lattice_of(130, 19, 17);
        for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_NONZERO; fill++) {
            bvx_solid_report r;
            bvx_grid whole;
            if (fill == BVX_FILL_PARITY) make_random(trial % KINDS, 150, l.dims, 16);
            whole = solid_by(ctx, &l, NULL, fill, &r);
            unbalanced[fill - BVX_FILL_PARITY] += r.unbalanced_rows;
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
                            if (bvx_grid_get(&part, x, y, z) !=
                                bvx_grid_get(&whole, x + w.low[0], y + w.low[1], z + w.low[2]))
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
    static const int32_t threads[5] = {1, 2, 3, 5, 8};

    for (int32_t fill = BVX_FILL_PARITY; fill <= BVX_FILL_NONZERO; fill++) {
        bvx_solid_report r, s;
        bvx_grid a = solid_by(ctx, l, NULL, fill, &r);
        for (int32_t n = 0; n < 7; n++) {
            bvx_context *const c = suite_context(threads[n % 5], n < 5 ? BVX_CPU_BEST : BVX_CPU_PORTABLE);
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
        /* enough for many chunks */
        int32_t const cheap = kind == NEEDLES || kind == DEGENERATE || kind == TINY;
        make_random(kind, (cheap ? 9000 : 200) / (long_run ? 1 : 4), l.dims, 16);
        assert_all_contexts_agree(&l);
    }
}

/* Games set the processor to flush denormal numbers to zero: the same bits for all normal inputs. */
static void test_flushing_denormals_changes_nothing(void)
{
#if defined(__SSE2__)
    unsigned const before = _mm_getcsr();
    for (int32_t kind = 0; kind < KINDS; kind++) {
        bvx_lattice const l = lattice_of(129, 20, 17);
        bvx_mesh m[2];
        bvx_grid g[2];
        make_random(kind, 200, l.dims, 16);
        memset(m, 0, sizeof m);
        for (unsigned flush = 0; flush < 2; flush++) {
            _mm_setcsr(flush ? before | 0x8040u : before); /* flush to zero, denormals are zero */
            g[flush] = solid_of(&l, kind % 2);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_extract_surface(ctx, &g[flush], NULL, &m[flush]));
            _mm_setcsr(before);
        }
        assert_same_bits(&g[0], &g[1], "denormals");
        TEST_ASSERT_EQUAL_UINT64(m[0].vertex_count, m[1].vertex_count);
        TEST_ASSERT_EQUAL_INT(0, memcmp(m[0].positions, m[1].positions, (size_t)m[0].vertex_count * 12));
        for (int i = 0; i < 2; i++) {
            bvx_mesh_free(ctx, &m[i]);
            bvx_grid_free(ctx, &g[i]);
        }
    }
#else
    TEST_IGNORE_MESSAGE("this processor has no such setting");
#endif
}

/* ---- Volume of work: more than one round's buffers hold ---- */

static void test_rounds_of_small_triangles(void)
{
    bvx_lattice const l = lattice_of(40, 33, 34);

    maker_clear(&mesh);
    /* About four crossings each: a few times 8192. */
    for (int32_t i = 0; i < trial_count(3000, 6000, 12000); i++) {
        double const x = maker_below(&seed, 40), y = maker_below(&seed, 33), z = maker_below(&seed, 34);
        double const u = maker_between(&seed, 3.5, 3.99, 65536), v = maker_between(&seed, 1.5, 1.99, 65536);
        uint32_t const a = maker_vertex(&mesh, x, y, z);
        uint32_t const b = maker_vertex(&mesh, x + 3, y + u, z);
        uint32_t const c = maker_vertex(&mesh, x - 2, y, z + v);
        maker_triangle(&mesh, a, i % 2 ? b : c, i % 2 ? c : b);
    }
    assert_both_rules(&l);
}

static void test_rounds_of_large_triangles(void)
{
    bvx_lattice const l = lattice_of(40, 35, 36);
    make_random(SOUP, long_run ? 4000 : 600, l.dims, 16);
    assert_both_rules(&l);
    make_random(SOUP, long_run ? 1500 : 600, l.dims, 16);
    assert_all_contexts_agree(&l);
}

/* Small and middle ones by turns, so that one batch holds both and the buffers fill from both. */
static void test_rounds_of_mixed_triangles(void)
{
    bvx_lattice const l = lattice_of(40, 60, 60);

    for (int32_t large = 4; large <= 20; large += 8) {
        maker_clear(&mesh);
        for (int32_t i = 0; i < 2000; i++) {
            double const x = maker_below(&seed, 40);
            double const y = maker_below(&seed, 60 - large);
            double const z = maker_below(&seed, 60 - large);
            double const u = (i % 2 ? 3.5 : large) + maker_below(&seed, 100) / 256.0;
            double const v = (i % 2 ? 1.5 : large) + maker_below(&seed, 100) / 256.0;
            uint32_t const a = maker_vertex(&mesh, x, y, z);
            uint32_t const b = maker_vertex(&mesh, x + 3, y + u, z);
            uint32_t const c = maker_vertex(&mesh, x - 2, y, z + v);
            maker_triangle(&mesh, a, i % 3 ? b : c, i % 3 ? c : b);
        }
        assert_both_rules(&l);
    }
}

static void test_rounds_of_many_chunks(void)
{
    bvx_lattice const l = lattice_of(128, 120, 120);
    double const centre[3] = {64, 60, 60}, radius[3] = {60, 59, 58}, inner[3] = {40, 39, 38};

    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, radius, 0.02,
               quick      ? 60
               : long_run ? 300
                          : 180,
               quick      ? 100
               : long_run ? 460
                          : 280,
               65536);
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

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_shift_by_whole_voxels_shifts_the_bits);
    RUN_TEST(test_order_and_orientation_change_nothing);
    RUN_TEST(test_windows_are_cut_out_of_the_whole);
    RUN_TEST(test_threads_and_code_paths_agree);
    RUN_TEST(test_flushing_denormals_changes_nothing);
    RUN_TEST(test_rounds_of_small_triangles);
    RUN_TEST(test_rounds_of_large_triangles);
    RUN_TEST(test_rounds_of_mixed_triangles);
    RUN_TEST(test_rounds_of_many_chunks);
    RUN_TEST(test_more_rows_than_a_block_holds);
    return UNITY_END();
}
