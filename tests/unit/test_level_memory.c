/* test_level_memory.c - bvx_build_levels takes what the header states, and
 * lowers the lattice that it plans where a memory limit asks for it. */
#include "levels_support.h"

static bvx_levels_report found;
static float corners[9 * 100000];

/* What the header states, for one thread; beside 1: with what crossings take that collapses make. */
static double stated_bytes(uint64_t triangles, uint64_t grid_bytes, int beside)
{
    double const n = (double)triangles, s = (double)found.triangles, g = (double)grid_bytes;
    double const measuring = 200 * n + 45 * s + 5 * g, collapsing = 12 * n + 170 * s;
    double const most = !found.solid             ? (beside ? 205 : 165) * n
                        : measuring > collapsing ? measuring
                                                 : collapsing;
    return most + 36 * (double)found.before.boundary_edges + 400e3 + (found.triangles > 20000 ? 1.3e6 : 0);
}

static void make_star(int32_t rings, int32_t segments)
{
    static const double centre[3] = {1, 2, 3}, radius[3] = {4, 3, 2};
    maker_clear(&mesh);
    maker_star(&mesh, &seed, centre, radius, 0, rings, segments, 1 << 20);
}

/* Holes here and there, or all beyond a plane gone. */
static void open_star(int half)
{
    size_t kept = 0;
    for (size_t t = 0; t < mesh.triangles; t++) {
        if (half ? mesh.p[3 * mesh.t[3 * t]] < 2 : t % 100 < 10) continue;
        memmove(mesh.t + 3 * kept++, mesh.t + 3 * t, 3 * sizeof *mesh.t);
    }
    mesh.triangles = kept;
}

static bvx_levels_options options_at(int32_t resolution)
{
    static const uint64_t target = 500;
    bvx_levels_options o = {.struct_size = sizeof o};
    o.targets.triangles = &target;
    o.fit.resolution = resolution;
    o.report = &found;
    return o;
}

/* The share of what is stated that a call takes. */
static double share_of_stated(const char *name, const bvx_mesh_view *view, const bvx_levels_options *o,
                              int beside)
{
    uint64_t before;
    double share;

    drop_levels();
    before = bvx_memory_used(ctx);
    bvx_memory_reset_peak(ctx);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, bvx_build_levels(ctx, view, o, 1, level), bvx_last_message(ctx));
    share = (double)(bvx_memory_peak(ctx) - before) /
            stated_bytes(view->triangle_count,
                         !found.solid ? 0 : 8 * bvx_grid_bound(&found.repair.lattice, NULL), beside);
    snprintf(where, sizeof where, "%s at %d: %.3f of what is stated, for %d triangles and %d of the surface",
             name, (int)o->fit.resolution, share, (int)view->triangle_count, (int)found.triangles);
    TEST_ASSERT_TRUE_MESSAGE(share <= 1, where);
    return share;
}

/* On the finer lattices, which take most of the time, some of the ways; BITVOX_LARGE=1: all. */
static int is_tried(int resolution, int way)
{
    if (getenv("BITVOX_LARGE") != NULL || resolution == 64) return 1;
    return resolution == 128 ? way == 2 : way == 1 || way == 4;
}

static void test_memory_is_as_the_header_says(void)
{
    static const int32_t resolutions[3] = {64, 128, 256};
    static const char *const name[5] = {"small", "large", "with holes", "half", "with sharp edges"};
    double largest = 0;

    for (int r = 0; r < (quick ? 1 : 3); r++)
        for (int way = 0; way < 5; way++) {
            bvx_levels_options o = options_at(resolutions[r]);
            bvx_mesh_view view;
            double share;

            if (!is_tried(resolutions[r], way)) continue;
            if (way == 0) make_star(40, 40);
            else make_star(200, 200);
            if (way == 2 || way == 3) open_star(way == 3);
            if (way == 4) o.sharp = BVX_SHARP_ALWAYS;
            view = maker_view(&mesh);
            share = share_of_stated(name[way], &view, &o, 0);
            if (share > largest) largest = share;
        }
    TEST_ASSERT_TRUE_MESSAGE(largest > (quick ? 0.6 : 0.85), "what is stated is far from what is taken");
}

/* Floats without indices: three vertices a triangle. */
static void test_memory_of_triangles_without_indices(void)
{
    bvx_levels_options const o = options_at(64);
    bvx_mesh_view view = {.position_type = BVX_F32};

    make_star(200, 200);
    TEST_ASSERT_TRUE(9 * mesh.triangles <= sizeof corners / sizeof *corners);
    for (size_t i = 0; i < 9 * mesh.triangles; i++) corners[i] = (float)mesh.p[3 * mesh.t[i / 3] + i % 3];
    view.positions = corners;
    view.vertex_count = 3 * mesh.triangles;
    view.triangle_count = mesh.triangles;
    TEST_ASSERT_TRUE_MESSAGE(share_of_stated("without indices", &view, &o, 0) > 0.6, where);
}

static void test_memory_of_meshes_as_they_are(void)
{
    bvx_levels_options o = options_at(0);
    bvx_mesh_view view;

    make_star(200, 200);
    view = maker_view(&mesh);
    TEST_ASSERT_TRUE_MESSAGE(share_of_stated("as it is", &view, &o, 0) > 0.8, where);
    TEST_ASSERT_EQUAL_INT32(0, found.solid);
    open_star(0);
    view = maker_view(&mesh);
    TEST_ASSERT_TRUE_MESSAGE(share_of_stated("open", &view, &o, 1) > 0.8, where);
    TEST_ASSERT_EQUAL_INT32(0, found.solid);
}

/* ---- Limits ---- */

static bvx_context *limited; /* that of the last call that succeeded */

static bvx_status build_within(uint64_t limit, const bvx_levels_options *o, bvx_mesh *made, uint64_t *peak)
{
    bvx_mesh_view const view = maker_view(&mesh);
    bvx_context_options c = {.struct_size = sizeof c};
    bvx_status status;

    c.threads = 1;
    c.memory_limit = limit;
    memset(&found, 0, sizeof found);
    TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_context_create(&c, &limited));
    status = bvx_build_levels(limited, &view, o, 1, made);
    snprintf(where, sizeof where, "limit %d: %s", (int)limit,
             status != BVX_OK ? bvx_last_message(limited) : "done");
    *peak = bvx_memory_peak(limited);
    if (status == BVX_OK) return status;
    TEST_ASSERT_NULL_MESSAGE(made->positions, where);
    TEST_ASSERT_EQUAL_UINT64_MESSAGE(0, bvx_memory_used(limited), where);
    bvx_context_destroy(limited);
    return status;
}

static void end_within(bvx_mesh *made)
{
    bvx_mesh_free(limited, made);
    bvx_context_destroy(limited);
}

static void test_limits_lower_the_lattice(void)
{
    bvx_levels_options o = options_at(0);
    int32_t planned, before;
    uint64_t peak, all;
    bvx_mesh made = {0};
    make_star(60, 60);
    o.solid = 1;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, build_within(0, &o, &made, &all), where);
    end_within(&made);
    planned = found.planned_resolution;
    TEST_ASSERT_TRUE(planned >= 256 && found.resolution == planned);

    before = planned;
    for (uint64_t limit = all; limit > all / 40; limit = limit / 5 * 2) {
        bvx_levels_options same = options_at(0);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, build_within(limit, &o, &made, &peak), where);
        TEST_ASSERT_EQUAL_INT32_MESSAGE(planned, found.planned_resolution, where);
        TEST_ASSERT_TRUE_MESSAGE(peak <= limit && found.resolution <= before && found.resolution >= 32,
                                 where);
        TEST_ASSERT_TRUE_MESSAGE((limit == all) == (found.resolution == planned), where);
        before = found.resolution;

        /* What comes of it is what the resolution gives that the report names. */
        same.solid = 1;
        same.fit.resolution = found.resolution;
        bvx_mesh_free(ctx, &level[0]);
        {
            bvx_mesh_view const view = maker_view(&mesh);
            TEST_ASSERT_EQUAL_INT32(BVX_OK, bvx_build_levels(ctx, &view, &same, 1, &level[0]));
        }
        assert_same_bytes(&level[0], &made);
        end_within(&made);
        TEST_ASSERT_TRUE(found.resolution == same.fit.resolution &&
                         found.planned_resolution == same.fit.resolution);
    }
    TEST_ASSERT_TRUE(before < planned / 3);
}

/* A resolution that was requested is not lowered, and where nothing fits the call says so. */
static void test_limits_that_cannot_be_kept(void)
{
    bvx_levels_options o = options_at(200);
    bvx_mesh made = {0};
    uint64_t peak;

    make_star(60, 60);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_ERR_BUDGET, build_within(8000000, &o, &made, &peak), where);
    o.fit.resolution = 0;
    o.solid = 1;
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_ERR_BUDGET, build_within(400000, &o, &made, &peak), where);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(where, "limit"), where);
}

/* ---- Meshes as they are ---- */

/* The number after a message's semicolon. */
static uint64_t named_limit(void)
{
    const char *at = strstr(where, "; ");
    TEST_ASSERT_NOT_NULL_MESSAGE(at, where);
    return strtoull(at + 2, NULL, 10);
}

/* A limit that is too small is refused with one that is not, nor twice too large. */
static void assert_named_limit_suffices(const bvx_levels_options *o)
{
    bvx_mesh made = {0};
    uint64_t peak, named;

    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_ERR_BUDGET, build_within(200000, o, &made, &peak), where);
    TEST_ASSERT_NOT_NULL_MESSAGE(strstr(where, "memory limit of 200000 bytes is too small for"), where);
    named = named_limit();
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, build_within(named, o, &made, &peak), where);
    end_within(&made);
    TEST_ASSERT_EQUAL_INT32(0, found.solid);
    snprintf(where + strlen(where), sizeof where - strlen(where), ", of which %d were taken", (int)peak);
    TEST_ASSERT_TRUE_MESSAGE(peak <= named && peak > named / 2, where);
}

static void test_limits_name_what_suffices(void)
{
    static const double error = 0.01;
    bvx_levels_options o = options_at(0);

    make_star(60, 60);
    assert_named_limit_suffices(&o);
    o.targets.samples = 1000;
    assert_named_limit_suffices(&o);
    o.targets.triangles = NULL;
    o.targets.errors = &error;
    assert_named_limit_suffices(&o);
    o = options_at(0);
    open_star(0);
    assert_named_limit_suffices(&o);
}

/* A mesh too large for the limit is not measured in its place: its levels or none. */
static void test_what_is_too_large_is_refused(void)
{
    bvx_levels_options const o = options_at(0);
    bvx_mesh made = {0};
    uint64_t peak, all;

    make_star(200, 200);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, build_within(0, &o, &made, &all), where);
    end_within(&made);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_OK, build_within(all, &o, &made, &peak), where);
    end_within(&made);
    TEST_ASSERT_EQUAL_INT32(0, found.solid);
    TEST_ASSERT_EQUAL_INT32_MESSAGE(BVX_ERR_BUDGET, build_within(all / 100 * 85, &o, &made, &peak), where);
}

int main(void)
{
    UNITY_BEGIN();
    RUN_TEST(test_memory_is_as_the_header_says);
    RUN_TEST(test_memory_of_triangles_without_indices);
    RUN_TEST(test_memory_of_meshes_as_they_are);
    RUN_TEST(test_limits_lower_the_lattice);
    RUN_TEST(test_limits_that_cannot_be_kept);
    RUN_TEST(test_limits_name_what_suffices);
    RUN_TEST(test_what_is_too_large_is_refused);
    return UNITY_END();
}
