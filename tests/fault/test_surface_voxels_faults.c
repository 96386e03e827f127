/* test_surface_voxels_faults.c - surface voxels, their attached triangles
 * and voxel faces with every allocation failing once, cancelled at every
 * progress call, under every memory limit and in arenas of every size. */
#include "fault/rows.h"
#include "tools/mesh_maker.h"

static maker_mesh star;
static bvx_mesh_view star_view;
static bvx_lattice lattice;
static bvx_grid solid;     /* what faces are made of */
static bvx_context *maker; /* what made them */

static int make_inputs(void **state)
{
    static const double centre[3] = {17, 16, 15}, radius[3] = {14, 13, 12};
    uint64_t seed = 82;
    bvx_context_options o = default_options();

    (void)state;
    o.threads = 1;
    maker = context_with(&o);
    maker_star(&star, &seed, centre, radius, 0.3, 60, 80, 65536);
    star_view = maker_view(&star);
    assert_int_equal(bvx_lattice_fit(maker, &star_view, 70, &lattice), BVX_OK);
    assert_int_equal(bvx_voxelize_solid(maker, &star_view, &lattice, NULL, &solid), BVX_OK);
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    bvx_grid_free(maker, &solid);
    assert_int_equal(bvx_memory_used(maker), 0);
    bvx_context_destroy(maker);
    maker_free(&star);
    return 0;
}

/* ---- Calls: each frees what it got, leaves its mark, and says on failure whether its results are empty - */

static bvx_status surface(bvx_context *ctx, int32_t mode, int attach)
{
    static const bvx_surface_report untouched = {5, 5, 5, {5, 5, 5, 5}};
    bvx_surface_report report = untouched;
    bvx_attached attached = {0};
    bvx_surface_options o = {.struct_size = sizeof o};
    bvx_grid grid = {0};
    bvx_status status;

    o.mode = mode;
    o.report = &report;
    o.attached = attach ? &attached : NULL;
    status = bvx_voxelize_surface(ctx, &star_view, &lattice, &o, &grid);
    if (status != BVX_OK) {
        left_behind |= grid.words != NULL || attached.offsets != NULL || attached.triangles != NULL;
        left_behind |= memcmp(&report, &untouched, sizeof report) != 0;
        return status;
    }
    assert_int_equal(bvx_grid_hash(ctx, &grid, &mark), BVX_OK);
    if (attach)
        mark = bvx_hash(attached.triangles, attached.triangle_count * 4,
                        bvx_hash(attached.offsets, (attached.voxel_count + 1) * 8, mark));
    bvx_attached_free(ctx, &attached);
    bvx_grid_free(ctx, &grid);
    return status;
}

static bvx_status conservative(void *user, bvx_context *ctx)
{
    (void)user;
    return surface(ctx, BVX_SURFACE_CONSERVATIVE, 0);
}

static bvx_status conservative_attached(void *user, bvx_context *ctx)
{
    (void)user;
    return surface(ctx, BVX_SURFACE_CONSERVATIVE, 1);
}

static bvx_status thin_attached(void *user, bvx_context *ctx)
{
    (void)user;
    return surface(ctx, BVX_SURFACE_THIN, 1);
}

static bvx_status sampled_attached(void *user, bvx_context *ctx)
{
    (void)user;
    return surface(ctx, BVX_SURFACE_SAMPLED, 1);
}

static bvx_status faces_of(bvx_context *ctx, int32_t merged)
{
    bvx_faces_options o = {.struct_size = sizeof o};
    bvx_mesh mesh = {0};
    bvx_status status;

    o.merged = merged;
    status = bvx_extract_faces(ctx, &solid, &o, &mesh);
    if (status != BVX_OK) {
        left_behind |= mesh.positions != NULL || mesh.vertex_count != 0 || mesh.triangle_count != 0;
        return status;
    }
    assert_int_equal(bvx_mesh_hash(ctx, &mesh, &mark), BVX_OK);
    bvx_mesh_free(ctx, &mesh);
    return status;
}

static bvx_status faces(void *user, bvx_context *ctx)
{
    (void)user;
    return faces_of(ctx, 0);
}

static bvx_status faces_merged(void *user, bvx_context *ctx)
{
    (void)user;
    return faces_of(ctx, 1);
}

static fault_row calls[] = {
    {"conservative", conservative, 2, 1, 0},
    {"conservative, attached", conservative_attached, 2, 1, 0},
    {"thin, attached", thin_attached, 2, 1, 0},
    {"sampled, attached", sampled_attached, 2, 1, 0},
    {"faces", faces, 2, 1, 0},
    {"faces, merged", faces_merged, 2, 1, 0},
};

/* ---- Tests ---- */

static void test_every_allocation_fails_once(void **state)
{
    (void)state;
    fail_every_allocation(FAULT_ROWS(calls));
}

static void test_cancel_at_every_progress_call(void **state)
{
    (void)state;
    cancel_at_every_call(FAULT_ROWS(calls));
}

static void test_under_every_memory_limit(void **state)
{
    (void)state;
    limit_memory(FAULT_ROWS(calls), 40);
}

static void test_in_an_arena(void **state)
{
    (void)state;
    live_in_arenas(FAULT_ROWS(calls), 1 << 23, 30);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_fails_once),
        cmocka_unit_test(test_cancel_at_every_progress_call),
        cmocka_unit_test(test_under_every_memory_limit),
        cmocka_unit_test(test_in_an_arena),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
