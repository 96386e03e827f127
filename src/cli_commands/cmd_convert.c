/* cmd_convert.c - bitvox convert: from one format to another, and what is lost on the way. */
#include "cli_commands/commands.h"

#include <inttypes.h>
#include <string.h>

static const cli_rule convert_rules[] = {
    {.when = CLI_OF_MESH,
     .given = "--window --expand --states",
     .message = "%o is for grids and octrees; %i is a mesh"},
    {.unless = CLI_TO_MESH, .given = "--normals", .message = "%o is for meshes; %f would hold voxels"},
    {.also = cli_mesh_file_rules},
    {0}};

static int check_convert_options(cli_run *run, int *kind, cli_tree *t)
{
    const cli_options *const o = run->options;
    int32_t const format = bvx_format_of_name(o->output);
    int const to = format == BVX_FORMAT_VTU ? CLI_TREE : cli_kind_of_format(format);
    int status = cli_input_kind(run, o->input[0], kind);

    if (status != CLI_DONE) return status;
    if (format == BVX_FORMAT_PNG)
        return cli_usage(run, "%s would be a picture: 'bitvox render' makes them", o->output);
    if (to == 0)
        return cli_usage(run, "%s: the name ends in no format that is written (%s)", o->output,
                         *kind == CLI_MESH ? CLI_MESHES_WRITTEN : CLI_GRIDS ", .vtu of octrees");
    if (to == CLI_TREE && cli_input_format(run, o->input[0]) != BVX_FORMAT_BVX)
        return cli_usage(run,
                         "%s is not an octree, and %s would be its leaves: 'bitvox refine' makes octrees",
                         cli_input_name(o->input[0]), o->output);
    if (*kind == CLI_MESH && to == CLI_GRID)
        return cli_usage(run, "%s is a mesh and %s would be a grid: 'bitvox voxelize' makes a grid of a mesh",
                         cli_input_name(o->input[0]), o->output);
    status = cli_check_rules(run, convert_rules, *kind == CLI_MESH ? CLI_OF_MESH : CLI_OF_GRID, NULL);
    return status == CLI_DONE ? cli_window_option(run, &t->window) : status;
}

static int convert_mesh(cli_run *run)
{
    const char *const out = run->options->output;
    bvx_mesh mesh = {0};
    int result = cli_open_output(run, out);

    if (result == CLI_DONE) result = cli_read_mesh(run, run->options->input[0], &mesh);
    if (result == CLI_DONE) result = cli_write_mesh(run, &mesh);
    if (result == CLI_DONE) {
        cli_warn_of_lost(run, out, &mesh);
        cli_say(run, "%s -> %s\n  triangles   %" PRIu64 " of %" PRIu64 " vertices\n",
                cli_input_name(run->options->input[0]), out, mesh.triangle_count, mesh.vertex_count);
    }
    bvx_mesh_free(run->context, &mesh);
    return result;
}

static int write_tree(cli_run *run, cli_input *in, cli_tree *t)
{
    int status = cli_take_tree(run, in->tree, t);

    in->tree = NULL;
    if (status == CLI_DONE) status = cli_check_tree_output(run, t);
    if (status == CLI_DONE && t->kind == 0 && run->options->window.count != 0)
        status = cli_usage(run, "--window of an octree is for grids; %s would be none", run->options->output);
    if (status == CLI_DONE) status = cli_write_tree(run, t);
    if (status != CLI_DONE) return status;
    cli_say(run, "%s -> %s\n\n", cli_input_name(in->path), run->options->output);
    cli_say_levels(run, t);
    cli_say_tree_output(run, t);
    cli_report_tree(run, t);
    return CLI_DONE;
}

static int write_grid(cli_run *run, const cli_input *in)
{
    const bvx_grid *const grid = &in->grid;
    const char *const out = run->options->output;
    cli_voxels voxels = {.name = in->path, .grid = grid};
    int status = CLI_DONE;

    if (bvx_format_of_name(out) == BVX_FORMAT_VTU || cli_given(run, "--expand") || cli_given(run, "--states"))
        return cli_usage(run, "--expand, --states and .vtu are for octrees; %s is a grid",
                         cli_input_name(in->path));
    status = cli_write_voxels(run, &voxels);
    cli_free_voxels(run, &voxels);
    if (status != CLI_DONE) return status;
    run->report.lattice = grid->lattice;
    run->report.has_lattice = run->report.has_set = 1;
    bvx_grid_count(run->context, grid, &run->report.set);
    cli_say(run, "%s -> %s\n", cli_input_name(in->path), out);
    cli_say_grid(run, grid, run->report.set, in->placed);
    cli_tell_voxels(run, &voxels);
    return CLI_DONE;
}

static int convert_voxels(cli_run *run, cli_tree *t)
{
    const char *const out = run->options->output;
    cli_input in;
    int status = bvx_format_of_name(out) == BVX_FORMAT_VTU ? cli_open_output(run, out) : cli_open_voxels(run);

    memset(&in, 0, sizeof in);
    if (status == CLI_DONE) status = cli_read_grid_or_tree(run, run->options->input[0], &t->window, &in);
    if (status == CLI_DONE) status = in.kind == CLI_TREE ? write_tree(run, &in, t) : write_grid(run, &in);
    cli_free_input(run, &in);
    return status;
}

static int run_convert(cli_run *run)
{
    cli_tree t;
    int kind, status;
    memset(&t, 0, sizeof t);
    status = check_convert_options(run, &kind, &t);
    if (status == CLI_DONE) status = kind == CLI_MESH ? convert_mesh(run) : convert_voxels(run, &t);
    cli_free_tree(run, &t);
    return status;
}

const cli_command cli_convert = {
    "convert",
    CLI_CONVERT,
    1,
    1,
    "IN -o OUT [options]",
    "a mesh, a grid or an octree in another format",
    "Meshes: reads " CLI_MESHES_READ ", also with .gz, and writes " CLI_MESHES_WRITTEN ".\n"
    "Grids: reads " CLI_GRIDS ", also with .gz, and writes the same, or\n"
    "their surface half way between set and empty voxels as a mesh.\n"
    "Octrees: reads .bvx and writes .vtu, .bvx, and with --expand grids of one level.\n"
    "What the new format cannot hold (colours, texture coordinates, a lattice around a window) is said\n"
    "in a warning. .npy and .vox hold no lattice: it goes to OUT.json beside them, and is looked for there.",
    "bitvox convert fixtures/knot.ply -o knot.glb\n"
    "bitvox convert fixtures/knot.ply fixtures/terrain.ply --output-dir packed --format ply",
    run_convert};
