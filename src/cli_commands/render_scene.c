/* render_scene.c - what a picture shows is read, voxelized where requested, and drawn. */
#include "cli_commands/render_scene.h"

#include <string.h>

enum { COMPARED_RESOLUTION = 256 };

static bvx_status fit_lattice(cli_run *run, const cli_input *in, int count, int32_t resolution,
                              bvx_lattice *lattice)
{
    cli_box box, other;
    bvx_lattice_options fit = {.struct_size = sizeof fit};
    cli_mesh_box(&in[0].mesh, &box);
    cli_mesh_box(&in[count - 1].mesh, &other);
    cli_join_boxes(&box, &other);
    fit.resolution = resolution;
    return cli_fit_box(run->context, &box, &fit, lattice);
}

static int voxelize_scene(cli_run *run, cli_scene *s, int count)
{
    const cli_render_options *const own = run->own;
    int32_t const resolution = own->voxels != 0 ? own->voxels : COMPARED_RESOLUTION;
    bvx_lattice lattice;
    int status = CLI_DONE;

    cli_stage_begin(run, "voxelize");
    bvx_status const fitted = fit_lattice(run, s->input, count, resolution, &lattice);
    if (fitted != BVX_OK) return cli_fail_status(run, fitted, cli_input_name(s->input[0].path));
    for (int i = 0; i < count && status == CLI_DONE; i++) {
        status = cli_fill_on(run, &lattice, &s->input[i]);
        s->input[i].kind = CLI_GRID;
        s->input[i].placed = 1;
    }
    cli_stage_end(run);
    return status;
}

int cli_open_scene(cli_run *run, int first, cli_scene *s)
{
    const cli_render_options *const own = run->own;
    const cli_options *const o = run->options;
    int const count = own->difference ? 2 : 1;
    int status = CLI_DONE;

    memset(s, 0, sizeof *s);
    s->compared = own->difference;
    for (int i = 0; i < count && status == CLI_DONE; i++)
        status = cli_read_input(run, o->input[first + i], &s->input[i]);
    if (status == CLI_DONE && s->input[0].kind == CLI_MESH && (own->voxels != 0 || own->difference))
        status = voxelize_scene(run, s, count);
    if (status != CLI_DONE || !own->difference) return status;
    cli_stage_begin(run, "compare");
    status = cli_compare_grids(run, &s->input[0], &s->input[1], &s->difference);
    cli_stage_end(run);
    return status;
}

void cli_free_scene(cli_run *run, cli_scene *s)
{
    for (int i = 0; i < 2; i++) cli_free_input(run, &s->input[i]);
}

/* What lies on the eye's side of each plane goes; the higher side where the plane looks at neither. */
static void take_cut(const cli_run *run, bvx_render_options *r)
{
    const cli_planes *const cut = &run->options->cut;
    const double *const direction = r->camera.direction;
    for (int a = 0; a < 3; a++) {
        if (!cut->given[a]) continue;
        r->cut.sides |= (direction[a] < 0.0 ? BVX_OPEN_X_LOW : BVX_OPEN_X_HIGH) << 2 * a;
        (direction[a] < 0.0 ? r->cut.low : r->cut.high)[a] = cut->value[a];
    }
}

int cli_draw_scene(cli_run *run, const cli_scene *s, int32_t width, int32_t height, bvx_image *image)
{
    const cli_render_options *const own = run->own;
    bvx_render_options r = own->picture;
    bvx_mesh_view view;
    bvx_status status;

    r.width = width;
    r.height = height;
    if (own->from.given) memcpy(r.camera.direction, own->from.value, sizeof r.camera.direction);
    if (own->up.given) memcpy(r.camera.up, own->up.value, sizeof r.camera.up);
    take_cut(run, &r);
    if (s->compared) {
        status = bvx_render_difference(run->context, &s->input[0].grid, &s->input[1].grid, &r, image);
    } else if (s->input[0].kind == CLI_GRID) {
        status = own->slices.count != 0 ? bvx_render_slices(run->context, &s->input[0].grid, own->slices.axis,
                                                            own->slices.count, &r, image)
                                        : bvx_render_grid(run->context, &s->input[0].grid, &r, image);
    } else {
        bvx_mesh_view_of(&s->input[0].mesh, &view);
        status = bvx_render_mesh(run->context, &view, &r, image);
    }
    return cli_check_call(run, status, cli_input_name(s->input[0].path));
}
