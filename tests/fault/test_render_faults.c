/* test_render_faults.c - pictures of cut, coloured and lined meshes, of cut grids, of differences and of
 * slices: every allocation failing once, cancelled at every progress call, under every memory limit. After
 * each failure there is no picture, nothing is held, and the same context does the work. */
#include "fault/rows.h"
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

static bvx_render_options cut_options(void)
{
    bvx_render_options o = {.struct_size = sizeof o};

    o.width = 40;
    o.height = 50;
    o.samples = 1;
    o.smooth = o.wireframe = 1;
    o.cut.sides = BVX_OPEN_X_HIGH | BVX_OPEN_Z_LOW;
    o.cut.high[0] = 20;
    o.cut.low[2] = 9.1;
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

static fault_row pictures[] = {
    {"mesh", render_mesh, 2, 2, 0},
    {"grid", render_grid, 2, 2, 0},
    {"difference", render_difference, 2, 2, 0},
};

/* ---- Tests ---- */

static void test_every_allocation_of_a_picture_fails_once(void **state)
{
    (void)state;
    fail_every_allocation(FAULT_ROWS(pictures));
}

static void test_cancel_at_every_progress_call_of_a_picture(void **state)
{
    (void)state;
    cancel_at_every_call(FAULT_ROWS(pictures));
}

/* Limits from 1 byte to what the picture needs. */
static void test_every_memory_limit_of_a_picture(void **state)
{
    (void)state;
    limit_memory(FAULT_ROWS(pictures), 60);
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
