/* test_render_faults.c - pictures of cut, coloured and lined meshes, of cut grids, of differences and of
 * slices: every allocation failing once, cancelled at every progress call, under every memory limit. After
 * each failure there is no picture, nothing is held, and the same context does the work. */
#include "fault/context.h"
#include "tools/mesh_maker.h"

/* ---- Inputs, made once ---- */

static maker_mesh star;
static bvx_mesh_view view;
static uint8_t *colours;
static bvx_grid solid, shifted;
static bvx_context *maker;

static int make_inputs(void **state)
{
    static const double centre[3] = {17, 16, 15}, radius[3] = {14, 13, 12};
    uint64_t seed = 20;
    bvx_context_options o = default_options();
    bvx_lattice lattice;

    (void)state;
    o.threads = 1;
    maker = context_with(&o);
    maker_star(&star, &seed, centre, radius, 0.3, 9, 15, 65536);
    view = maker_view(&star);
    colours = malloc((size_t)view.vertex_count * 4);
    assert_non_null(colours);
    for (size_t i = 0; i < (size_t)view.vertex_count * 4; i++) colours[i] = (uint8_t)(i * 37);
    view.colours = colours;
    assert_int_equal(bvx_lattice_fit(maker, &view, 70, &lattice), BVX_OK);
    assert_int_equal(bvx_voxelize_solid(maker, &view, &lattice, NULL, &solid), BVX_OK);
    assert_int_equal(bvx_grid_create(maker, &lattice, NULL, &shifted), BVX_OK);
    for (int32_t z = 0; z < solid.size[2]; z++)
        for (int32_t y = 0; y < solid.size[1]; y++)
            for (int32_t x = 2; x < solid.size[0]; x++)
                if (bvx_grid_get(&solid, x - 2, y, z)) bvx_grid_set(&shifted, x, y, z, 1);
    return 0;
}

static int free_inputs(void **state)
{
    (void)state;
    bvx_grid_free(maker, &shifted);
    bvx_grid_free(maker, &solid);
    bvx_context_destroy(maker);
    free(colours);
    maker_free(&star);
    return 0;
}

/* ---- Pictures ---- */

static uint64_t mark;   /* a hash of what the last good run made */
static int left_behind; /* a failed call left something in its result */

static bvx_render_options cut_options(void)
{
    bvx_render_options o;

    bvx_render_options_init(&o, sizeof o);
    o.width = 40;
    o.height = 50;
    o.samples = 1;
    o.smooth = o.wireframe = 1;
    o.cut_high[0] = 20;
    o.cut_low[2] = 9.1;
    return o;
}

static bvx_status end_with_image(bvx_context *ctx, bvx_status status, bvx_image *image)
{
    if (status != BVX_OK) {
        left_behind |= image->pixels != NULL || image->width != 0 || image->height != 0;
        return status;
    }
    bvx_buffer file = {0};
    mark = bvx_hash(image->pixels, (size_t)image->width * (size_t)image->height * 3, 0);
    status = bvx_write_png(ctx, image, &file);
    if (status != BVX_OK) left_behind |= file.bytes != NULL;
    bvx_buffer_free(ctx, &file);
    bvx_image_free(ctx, image);
    return status;
}

static bvx_status render_mesh(void *user, bvx_context *ctx)
{
    bvx_render_options const o = cut_options();
    bvx_image image = {0};
    (void)user;
    return end_with_image(ctx, bvx_render_mesh(ctx, &view, &o, &image), &image);
}

static bvx_status render_grid(void *user, bvx_context *ctx)
{
    bvx_render_options const o = cut_options();
    bvx_image image = {0};
    (void)user;
    return end_with_image(ctx, bvx_render_grid(ctx, &solid, &o, &image), &image);
}

static bvx_status render_difference(void *user, bvx_context *ctx)
{
    bvx_render_options const o = cut_options();
    bvx_image image = {0};
    (void)user;
    return end_with_image(ctx, bvx_render_difference(ctx, &solid, &shifted, &o, &image), &image);
}

static bvx_status render_slices(void *user, bvx_context *ctx)
{
    bvx_render_options const o = cut_options();
    bvx_image image = {0};
    (void)user;
    return end_with_image(ctx, bvx_render_slices(ctx, &solid, 1, 6, &o, &image), &image);
}

static const struct {
    const char *name;
    fault_operation_fn *run;
} pictures[] = {{"mesh", render_mesh},
                {"grid", render_grid},
                {"difference", render_difference},
                {"slices", render_slices}};
enum { PICTURES = sizeof pictures / sizeof pictures[0] };

typedef struct trial {
    fault_operation_fn *run;
    uint64_t want;
} trial;

static bvx_status run_trial(void *user, bvx_context *ctx)
{
    const trial *const t = user;
    bvx_status const status = t->run(NULL, ctx);
    if (status == BVX_OK && mark != t->want) left_behind = 2;
    return status;
}

static trial trial_of(int i)
{
    trial t = {NULL, 0};
    t.run = pictures[i].run;
    left_behind = 0;
    assert_int_equal(t.run(NULL, maker), BVX_OK);
    t.want = mark;
    return t;
}

static void assert_well(int i, const char *wrong)
{
    if (wrong != NULL) fail_msg("%s: %s", pictures[i].name, wrong);
    if (left_behind == 1) fail_msg("%s: a failed call left something in its picture", pictures[i].name);
    if (left_behind != 0) fail_msg("%s: another picture than usual", pictures[i].name);
}

/* ---- Tests ---- */

static void test_every_allocation_of_a_picture_fails_once(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2)
        for (int i = 0; i < PICTURES; i++) {
            bvx_context_options o = default_options();
            trial t = trial_of(i);
            uint64_t allocations = 0;
            o.threads = threads;
            assert_well(i, fault_every_allocation(run_trial, &t, &o, &allocations));
            assert_true(allocations >= 2);
        }
}

static void test_cancel_at_every_progress_call_of_a_picture(void **state)
{
    (void)state;
    for (int32_t threads = 1; threads <= 3; threads += 2)
        for (int i = 0; i < PICTURES; i++) {
            bvx_context_options o = default_options();
            trial t = trial_of(i);
            uint64_t calls = 0;
            o.threads = threads;
            assert_well(i, fault_every_cancel(run_trial, &t, &o, &calls));
            assert_true(calls >= 2);
        }
}

/* Limits from 1 byte to what the picture needs. */
static void test_every_memory_limit_of_a_picture(void **state)
{
    bvx_context_options o = default_options();
    (void)state;
    o.threads = 1;
    for (int i = 0; i < PICTURES; i++) {
        trial t = trial_of(i);
        assert_well(i, fault_every_limit(run_trial, &t, &o, 60));
    }
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(test_every_allocation_of_a_picture_fails_once),
        cmocka_unit_test(test_cancel_at_every_progress_call_of_a_picture),
        cmocka_unit_test(test_every_memory_limit_of_a_picture),
    };
    return cmocka_run_group_tests(tests, make_inputs, free_inputs);
}
