/* test_queries.c - nearest points, carried colours, rays, samples and comparisons with every allocation
 * failing once, cancelled at every progress call, under every memory limit and in arenas of every size. */
#include "fault/rows.h"
#include "mesh/mesh.h"
#include "tools/mesh_maker.h"

enum { QUERIES = 600 };

/* ---- Inputs, made once ---- */

static maker_mesh star;
static bvx_mesh_view star_view;
static bvx_mesh source; /* with colours and texture coordinates */
static bvx_grid solid, other, slice;
static double points[3 * QUERIES], rays[6 * QUERIES];
static bvx_context *maker; /* what made them */

static int make_inputs(void **state)
{
    static const double centre[3] = {17, 16, 15}, radius[3] = {14, 13, 12};
    uint64_t seed = 81;
    bvx_context_options o = default_options();
    bvx_lattice lattice;

    (void)state;
    o.threads = 1;
    maker = context_with(&o);
    maker_star(&star, &seed, centre, radius, 0.3, 9, 15, 65536);
    star_view = maker_view(&star);
    assert_int_equal(bvx_lattice_fit(maker, &star_view, 70, &lattice), BVX_OK);
    assert_int_equal(bvx_grid_create(maker, &lattice, NULL, &solid), BVX_OK);
    assert_int_equal(bvx_grid_create(maker, &lattice, NULL, &other), BVX_OK);
    for (int32_t z = 0; z < lattice.dims[2]; z++)
        for (int32_t y = 0; y < lattice.dims[1]; y++)
            for (int32_t x = 0; x < lattice.dims[0]; x++) {
                bvx_grid_set(&solid, x, y, z, maker_below(&seed, 20) == 0);
                bvx_grid_set(&other, x, y, z, maker_below(&seed, 20) == 0);
            }
    bvx_window const one = {{0, 0, 30}, {lattice.dims[0], lattice.dims[1], 1}};
    assert_int_equal(bvx_grid_crop(maker, &solid, &one, &slice), BVX_OK);
    for (int i = 0; i < 3 * QUERIES; i++) points[i] = maker_between(&seed, 0, 32, 1000);
    for (int i = 0; i < 6 * QUERIES; i++)
        rays[i] = maker_between(&seed, -5, 35, 1000) - (i % 6 > 2 ? 15.0005 : 0.0);
    assert_int_equal(bvxi_mesh_open(maker, "test", BVX_F64, 0, star.vertices, star.triangles, &source),
                     BVX_OK);
    memcpy(source.positions, star.p, star.vertices * 24);
    memcpy(source.triangles, star.t, star.triangles * 12);
    source.uv_count = source.vertex_capacity;
    source.uvs = get(maker, BVXI_RESULT, source.uv_count * 8);
    source.colours = get(maker, BVXI_RESULT, source.vertex_capacity * 4);
    for (uint64_t i = 0; i < source.uv_count * 2; i++) source.uvs[i] = (float)maker_below(&seed, 100);
    for (uint64_t i = 0; i < source.vertex_capacity * 4; i++)
        source.colours[i] = (uint8_t)maker_below(&seed, 256);
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    bvx_mesh_free(maker, &source);
    bvx_grid_free(maker, &solid);
    bvx_grid_free(maker, &other);
    bvx_grid_free(maker, &slice);
    assert_int_equal(bvx_memory_used(maker), 0);
    bvx_context_destroy(maker);
    maker_free(&star);
    return 0;
}

/* ---- Queries: each frees what it got, leaves its mark, and says on failure whether its results are empty  */

static bvx_status find(void *user, bvx_context *ctx)
{
    static bvx_closest_point found[QUERIES];
    static int64_t turns[QUERIES];
    static bvx_mesh_hit hits[8 * QUERIES];
    static uint64_t offsets[QUERIES + 1];
    bvx_closest *closest = NULL;
    bvx_status status;

    (void)user;
    memset(found, 0, sizeof found);
    status = bvx_closest_create(ctx, &star_view, &closest);
    left_behind |= status != BVX_OK && closest != NULL;
    if (status == BVX_OK) status = bvx_closest_find(ctx, closest, points, QUERIES, found);
    if (status == BVX_OK) status = bvx_closest_winding(ctx, closest, points, QUERIES, turns);
    if (status == BVX_OK) status = bvx_closest_cast(ctx, closest, rays, QUERIES, 1e9, hits);
    if (status == BVX_OK)
        status = bvx_closest_crossings(ctx, closest, rays, QUERIES, 1e9, offsets, hits, 8 * QUERIES);
    if (status == BVX_OK) mark = bvx_hash(found, sizeof found, bvx_hash(turns, sizeof turns, 0));
    bvx_closest_free(ctx, closest);
    return status;
}

static bvx_status links(void *user, bvx_context *ctx)
{
    static float values[4096 * 18];
    bvx_closest *closest = NULL;
    uint64_t count;

    (void)user;
    bvx_status status = bvx_grid_count(ctx, &slice, &count);
    assert_true(status != BVX_OK || count <= 4096);
    if (status == BVX_OK) status = bvx_closest_create(ctx, &star_view, &closest);
    if (status == BVX_OK) status = bvx_closest_links(ctx, closest, &slice, 18, values);
    if (status == BVX_OK) mark = bvx_hash(values, count * 18 * sizeof *values, 0);
    bvx_closest_free(ctx, closest);
    return status;
}

static bvx_status carry(void *user, bvx_context *ctx)
{
    bvx_mesh target = {0}, before;
    bvx_status status;

    (void)user;
    status = bvxi_mesh_open(ctx, "test", BVX_F64, 0, QUERIES, 0, &target);
    if (status != BVX_OK) return status;
    memcpy(target.positions, points, sizeof points);
    before = target;
    status = bvx_mesh_carry(ctx, &source, &target);
    if (status == BVX_OK) mark = bvx_hash(target.colours, QUERIES * 4, bvx_hash(target.uvs, QUERIES * 8, 0));
    else left_behind |= memcmp(&before, &target, sizeof before) != 0;
    bvx_mesh_free(ctx, &target);
    return status;
}

static bvx_status label(void *user, bvx_context *ctx)
{
    static uint8_t labels[1 << 19], palette[1024];
    bvx_buffer file = {0}, back = {0};
    bvx_status status;

    (void)user;
    assert_true((uint64_t)solid.size[0] * (uint64_t)solid.size[1] * (uint64_t)solid.size[2] <= sizeof labels);
    status = bvx_label_voxels(ctx, &source, &solid, labels, palette);
    if (status == BVX_OK) status = bvx_write_labels(ctx, &solid, labels, palette, BVX_FORMAT_VOX, &file);
    if (status == BVX_OK)
        status = bvx_read_labels(ctx, file.bytes, file.size, BVX_FORMAT_VOX, &back, palette);
    if (status == BVX_OK)
        mark = bvx_hash(back.bytes, (size_t)back.size, bvx_hash(palette, sizeof palette, 0));
    bvx_buffer_free(ctx, &file);
    bvx_buffer_free(ctx, &back);
    return status;
}

static bvx_status cast(void *user, bvx_context *ctx)
{
    static bvx_ray_hit hits[QUERIES];
    bvx_status status;
    (void)user;
    status = bvx_grid_cast(ctx, &solid, rays, QUERIES, 1e9, hits);
    if (status == BVX_OK) mark = bvx_hash(hits, sizeof hits, 0);
    return status;
}

static bvx_status cast_by_handle(void *user, bvx_context *ctx)
{
    static bvx_ray_hit hits[QUERIES];
    bvx_window const part = {{solid.low[0], solid.low[1], solid.low[2]}, {1, 1, 1}};
    bvx_rays *caster = NULL;
    bvx_status status;

    (void)user;
    status = bvx_rays_create(ctx, &solid, &caster);
    left_behind |= status != BVX_OK && caster != NULL;
    if (status == BVX_OK) status = bvx_rays_update(ctx, caster, &solid, &part);
    if (status == BVX_OK) status = bvx_rays_cast(ctx, caster, rays, QUERIES, 1e9, hits);
    if (status == BVX_OK) mark = bvx_hash(hits, sizeof hits, 0);
    bvx_rays_free(ctx, caster);
    return status;
}

static bvx_status sample(void *user, bvx_context *ctx)
{
    static double values[4 * QUERIES];
    bvx_status status;
    (void)user;
    status = bvx_grid_sample(ctx, &solid, points, QUERIES, values, values + QUERIES);
    if (status == BVX_OK) mark = bvx_hash(values, sizeof values, 0);
    return status;
}

static bvx_status compare(void *user, bvx_context *ctx)
{
    static const bvx_grid_difference empty = {0};
    bvx_grid_difference d;
    bvx_status status;

    (void)user;
    memset(&d, 0x55, sizeof d);
    status = bvx_grid_compare(ctx, &solid, &other, &d);
    if (status == BVX_OK) mark = bvx_hash(&d, sizeof d, 0);
    else left_behind |= memcmp(&d, &empty, sizeof d) != 0;
    return status;
}

static fault_row queries[] = {
    {"find", find, 1, 1, 0},           {"carry", carry, 1, 1, 0}, {"cast", cast, 1, 1, 0},
    {"rays", cast_by_handle, 1, 1, 0}, {"label", label, 1, 1, 0}, {"sample", sample, 0, 1, 0},
    {"compare", compare, 1, 1, 0},     {"links", links, 1, 1, 0},
};

/* ---- Tests ---- */

static void test_every_allocation_of_queries_fails_once(void **state)
{
    (void)state;
    fail_every_allocation(FAULT_ROWS(queries));
}

static void test_queries_cancel_at_every_progress_call(void **state)
{
    (void)state;
    cancel_at_every_call(FAULT_ROWS(queries));
}

static void test_queries_under_every_memory_limit(void **state)
{
    (void)state;
    limit_memory(FAULT_ROWS(queries), 60);
}

static void test_queries_live_in_an_arena(void **state)
{
    (void)state;
    live_in_arenas(FAULT_ROWS(queries), 1 << 22, 40);
}

/* Results that live on while others come and go do not hold the arena's scratch. */
static void test_a_tree_lives_beside_other_work(void **state)
{
    size_t const most = (size_t)1 << 20;
    unsigned char *const memory = malloc(most);
    bvx_context_options o = default_options();
    bvx_context *ctx;
    bvx_closest *closest = NULL;
    static bvx_closest_point found[QUERIES];
    static int64_t turns[QUERIES];

    (void)state;
    assert_non_null(memory);
    o.arena.memory = memory;
    o.arena.size = most;
    o.threads = 1;
    ctx = context_with(&o);
    assert_int_equal(bvx_closest_create(ctx, &star_view, &closest), BVX_OK);
    for (int round = 0; round < 50; round++) assert_int_equal(carry(NULL, ctx), BVX_OK);
    for (int round = 0; round < 50; round++) assert_int_equal(compare(NULL, ctx), BVX_OK);
    begin_row(&queries[0]);
    memset(found, 0, sizeof found);
    assert_int_equal(bvx_closest_find(ctx, closest, points, QUERIES, found), BVX_OK);
    assert_int_equal(bvx_closest_winding(ctx, closest, points, QUERIES, turns), BVX_OK);
    assert_true(bvx_hash(found, sizeof found, bvx_hash(turns, sizeof turns, 0)) == queries[0].want);
    bvx_closest_free(ctx, closest);
    assert_int_equal(bvx_memory_used(ctx), 0);
    bvx_context_destroy(ctx);
    free(memory);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_queries_fails_once),
        cmocka_unit_test(test_queries_cancel_at_every_progress_call),
        cmocka_unit_test(test_queries_under_every_memory_limit),
        cmocka_unit_test(test_queries_live_in_an_arena),
        cmocka_unit_test(test_a_tree_lives_beside_other_work),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
