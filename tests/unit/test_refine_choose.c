/* test_refine_choose.c - the base and the levels that are chosen for a finest resolution. */
#include "refine_oracle.h"

#include "refine/refine.h"
#include "suite.h"

static maker_mesh mesh;

void setUp(void)
{
    suite_open(1);
}

void tearDown(void)
{
    maker_free(&mesh);
    suite_close();
}

static bvx_mesh_view star_of(int rings, int sectors)
{
    const double centre[3] = {3, -2, 5}, radius[3] = {4, 3, 3.5};
    uint64_t seed = 5;
    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, radius, 0.05, rings, sectors, 1024);
    return maker_view(&mesh);
}

static int32_t levels_for(const bvx_mesh_view *view, int32_t resolution, bvx_refine_options *o,
                          bvx_lattice *base)
{
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_refine_choose(ctx, view, resolution, o, base),
                                    bvx_last_message(ctx));
    return o->levels != BVX_NONE ? o->levels : 0;
}

/* ---- what is promised ---- */

static void test_the_last_level_has_the_resolution(void)
{
    bvx_mesh_view const view = star_of(12, 16);
    static const int32_t resolutions[] = {1,   2,   3,    5,    7,    16,    17,      64,       100,     101,
                                          511, 512, 1000, 4096, 5000, 65536, 1000003, 33554431, 33554432};

    for (size_t i = 0; i < sizeof resolutions / sizeof resolutions[0]; i++)
        for (int kind = 0; kind < 3; kind++) {
            bvx_refine_options o = {.struct_size = sizeof o};
            bvx_lattice base, same;
            if (kind == 1) o.tolerance = 0.1;
            for (int a = 0; a < 3 && kind == 2; a++) o.window.size[a] = 1 + resolutions[i] / 128;
            int32_t const levels = levels_for(&view, resolutions[i], &o, &base);
            int32_t const n = base.dims[0];
            TEST_ASSERT_TRUE(levels >= 0 && levels <= 25);
            TEST_ASSERT_TRUE(((int64_t)n << levels) >= resolutions[i]);
            /* no base voxel more than that takes */
            TEST_ASSERT_TRUE(((int64_t)(n - 1) << levels) < resolutions[i]);
            TEST_ASSERT_TRUE(((int64_t)n << levels) <= 33554432);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_lattice_fit(ctx, &view, n, &same));
            TEST_ASSERT_EQUAL_MEMORY(&same, &base, sizeof base);
            if (kind == 1 && resolutions[i] >= 8) TEST_ASSERT_TRUE(n >= 8 && n <= 15);
        }
}

static void test_a_chosen_pair_refines(void)
{
    bvx_mesh_view const view = star_of(12, 16);

    for (int32_t resolution = 1; resolution <= 100; resolution += 9) {
        bvx_refine_options o = {.struct_size = sizeof o};
        bvx_lattice base, last;
        bvx_octree *tree = NULL;
        uniform u;
        uint64_t inside = 0, surface = 0;
        bvx_octree_level level[26];
        int32_t const levels = levels_for(&view, resolution, &o, &base);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_refine(ctx, &view, &base, &o, &tree));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_lattice(ctx, tree, levels, &last));
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_octree_count(ctx, tree, level, 26));
        uniform_make(ctx, &view, &last, &u);
        for (int32_t l = 0; l <= levels; l++) {
            surface += level[l].surface;
            inside += level[l].inside << 3 * (levels - l);
        }
        TEST_ASSERT_EQUAL_UINT64(uniform_count(&u, BVX_STATE_SURFACE), surface);
        TEST_ASSERT_EQUAL_UINT64(uniform_count(&u, BVX_STATE_INSIDE), inside);
        uniform_free(&u);
        bvx_octree_free(ctx, tree);
    }
}

/* Deep lattices do not get bases of their own size, shallow ones need no
 * levels above the last two, windows want little base. */
static void test_bases_grow_slower_than_resolutions(void)
{
    bvx_mesh_view const view = star_of(30, 60);
    int64_t before = 0;

    for (int32_t resolution = 16; resolution <= 65536; resolution *= 2) {
        bvx_refine_options o = {.struct_size = sizeof o};
        bvx_lattice base, part;
        levels_for(&view, resolution, &o, &base);
        TEST_ASSERT_TRUE(base.dims[0] >= before && base.dims[0] <= 1024);
        if (resolution >= 4096) TEST_ASSERT_TRUE(base.dims[0] <= resolution / 4);
        before = base.dims[0];
        for (int a = 0; a < 3; a++) o.window.size[a] = resolution / 16;
        levels_for(&view, resolution, &o, &part);
        TEST_ASSERT_TRUE(part.dims[0] <= 128 && part.dims[0] >= 4);
    }
}

static void test_threads_do_not_show(void)
{
    bvx_mesh_view const view = star_of(100, 100);

    for (int32_t resolution = 8; resolution <= 8192; resolution *= 4) {
        bvx_refine_options one, many;
        bvx_lattice first, second;
        bvx_context_options co = {.struct_size = sizeof co};
        bvx_context *other;
        one = (bvx_refine_options){.struct_size = sizeof one};
        many = (bvx_refine_options){.struct_size = sizeof many};
        co.threads = 3;
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&co, &other));
        levels_for(&view, resolution, &one, &first);
        TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_refine_choose(other, &view, resolution, &many, &second));
        TEST_ASSERT_EQUAL_INT32(one.levels, many.levels);
        TEST_ASSERT_EQUAL_MEMORY(&first, &second, sizeof first);
        bvx_context_destroy(other);
    }
}

/* ---- refusals ---- */

static void refuse(const bvx_mesh_view *view, int32_t resolution, bvx_refine_options *o, bvx_lattice *base,
                   bvx_status status, const char *words)
{
    TEST_ASSERT_EQUAL_INT32(status, bvx_refine_choose(ctx, view, resolution, o, base));
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(bvx_last_message(ctx), words), bvx_last_message(ctx));
}

static void test_refusals(void)
{
    bvx_mesh_view const view = star_of(5, 8);
    bvx_mesh_view none = view;
    bvx_refine_options o = {.struct_size = sizeof o};
    bvx_lattice base, before;

    memset(&base, 7, sizeof base);
    before = base;
    TEST_ASSERT_EQUAL_INT32(BVX_ERR_ARGUMENT, bvx_refine_choose(NULL, &view, 8, &o, &base));
    refuse(&view, 8, NULL, &base, BVX_ERR_ARGUMENT, "options");
    refuse(&view, 8, &o, NULL, BVX_ERR_ARGUMENT, "base");
    refuse(NULL, 8, &o, &base, BVX_ERR_ARGUMENT, "mesh");
    refuse(&view, 0, &o, &base, BVX_ERR_ARGUMENT, "resolution 0");
    refuse(&view, 33554433, &o, &base, BVX_ERR_RANGE, "33554432");
    none.triangle_count = 0;
    refuse(&none, 8, &o, &base, BVX_ERR_EMPTY, "triangle");
    o.tolerance = -1;
    refuse(&view, 8, &o, &base, BVX_ERR_ARGUMENT, "tolerance");
    o.tolerance = 0;
    o.window.size[1] = 5;
    refuse(&view, 8, &o, &base, BVX_ERR_ARGUMENT, "window");
    o.window.size[1] = 0;
    o.struct_size = sizeof o.struct_size;
    refuse(&view, 8, &o, &base, BVX_ERR_ARGUMENT, "levels");
    TEST_ASSERT_EQUAL_MEMORY(&before, &base, sizeof base);
    TEST_ASSERT_EQUAL_INT32(0, o.levels);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_the_last_level_has_the_resolution);
    RUN_TEST(test_a_chosen_pair_refines);
    RUN_TEST(test_bases_grow_slower_than_resolutions);
    RUN_TEST(test_threads_do_not_show);
    RUN_TEST(test_refusals);
    return UNITY_END();
}
