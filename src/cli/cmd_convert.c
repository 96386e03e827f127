/* cmd_convert.c - bitvox convert: from one format to another, and what is lost on the way. */
#include "cli/cli.h"

#include <inttypes.h>
#include <string.h>

static int refuse_other_kind(cli_run *run, int from)
{
    const char *const in = cli_input_name(run->options.input[0]), *const out = run->options.output;
    if (from == CLI_MESH)
        return cli_usage(run, "%s is a mesh and %s would be a grid: 'bitvox voxelize' makes a grid of a mesh", in, out);
    return cli_usage(run, "%s is a grid and %s would be a mesh: 'bitvox lod --levels N' makes meshes of a grid", in, out);
}

static int check_convert_options(cli_run *run, int *kind, bvx_window *window)
{
    const cli_options *const o = &run->options;
    int32_t const format = bvx_format_of_name(o->output);
    int const to = cli_kind_of_format(format);
    int status = cli_input_kind(run, o->input[0], kind);
    if (status != CLI_DONE) return status;
    if (format == BVX_FORMAT_PNG) return cli_usage(run, "%s would be a picture: 'bitvox render' makes them", o->output);
    if (to == 0 || cli_is_packed(o->output))
        return cli_usage(run, "%s: the name ends in no format that is written (%s)", o->output,
                         *kind == CLI_MESH ? ".ply .obj .stl .off .glb" : ".npy .binvox .vox .nrrd .vti .bvx");
    if (*kind != to) return refuse_other_kind(run, *kind);
    if (*kind == CLI_MESH && o->window.count != 0) return cli_usage(run, "--window is for grids; %s is a mesh", cli_input_name(o->input[0]));
    return cli_window_option(run, window);
}

static int convert_mesh(cli_run *run)
{
    const char *const out = run->options.output;
    int32_t const format = bvx_format_of_name(out);
    bvx_buffer file = {0};
    bvx_mesh mesh = {0};
    bvx_status status;
    int result = cli_open_output(run, out);
    if (result == CLI_DONE) result = cli_read_mesh(run, run->options.input[0], &mesh);
    if (result == CLI_DONE) {
        cli_stage_begin(run, "write");
        status = bvx_write_mesh(run->context, &mesh, format, &file);
        result = status == BVX_OK ? cli_write_output(run, 0, &file) : cli_fail_status(run, status, out);
        if (result == CLI_DONE) result = cli_keep_outputs(run);
        cli_stage_end(run);
    }
    if (result == CLI_DONE) {
        cli_warn_of_lost(run, out, &mesh);
        cli_say(run, "%s -> %s\n  triangles   %" PRIu64 " of %" PRIu64 " vertices\n", cli_input_name(run->options.input[0]), out,
                mesh.triangle_count, mesh.vertex_count);
    }
    bvx_buffer_free(run->context, &file);
    bvx_mesh_free(run->context, &mesh);
    return result;
}

static int convert_grid(cli_run *run, const bvx_window *window)
{
    const char *const in = run->options.input[0], *const out = run->options.output;
    bvx_grid grid = {0};
    int placed, result = cli_open_grid_output(run, out);
    if (result == CLI_DONE) result = cli_read_grid(run, in, window, &grid, &placed);
    if (result == CLI_DONE) result = cli_check_grid_format(run, out, &grid.lattice, grid.size);
    if (result == CLI_DONE) result = cli_write_grid(run, &grid);
    if (result == CLI_DONE) {
        run->report.lattice = grid.lattice;
        run->report.has_lattice = run->report.has_set = 1;
        bvx_grid_count(run->context, &grid, &run->report.set);
        cli_say(run, "%s -> %s\n", cli_input_name(in), out);
        cli_say_grid(run, &grid, run->report.set, placed);
    }
    bvx_grid_free(run->context, &grid);
    return result;
}

static int run_convert(cli_run *run)
{
    bvx_window window;
    int kind, status = check_convert_options(run, &kind, &window);
    if (status != CLI_DONE) return status;
    return kind == CLI_MESH ? convert_mesh(run) : convert_grid(run, &window);
}

const cli_command cli_convert = {
    "convert", CLI_CONVERT, 1, 1, "IN -o OUT [options]", "a mesh or a grid in another format",
    "Meshes: reads .stl .obj .ply .off, also with .gz, and writes .ply .obj .stl .off .glb.\n"
    "Grids: reads .npy .binvox .vox .nrrd .vti .bvx, also with .gz, and writes the same.\n"
    "What the new format cannot hold (colours, texture coordinates, a lattice around a window) is told\n"
    "in a warning. .npy and .vox hold no lattice: it goes to OUT.json beside them, and is looked for there.",
    "bitvox convert fixtures/knot.ply -o knot.glb", run_convert};
