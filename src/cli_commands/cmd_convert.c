/* cmd_convert.c - bitvox convert: from one format to another, and what is lost on the way. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <string.h>

static const cli_argument convert_rows[] = {
    {.also = cli_takes_output},
    {.also = cli_takes_output_dir},
    LIST("--window", "A,B,C,D,E,F", SHARED(window), 0, LARGEST_SIDE, 6, 6,
         "only voxels A..D-1, B..E-1, C..F-1 of a grid's file, or of the last\n"
         "level of an octree"),
    {.also = cli_takes_volumes},
    {.also = cli_takes_trees},
    {.also = cli_takes_normals},
    {.also = cli_takes_file_of_a_mesh},
    {.also = cli_takes_kept_parts},
    {.also = cli_takes_all},
    {0}};

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

    CLI_TRY(cli_input_kind(run, o->input[0], kind));
    if (format == BVX_FORMAT_PNG)
        return cli_usage(run, "%s would be a picture: 'bitvox render' makes them", o->output);
    if (to == 0)
        return cli_usage(run, "%s: the name does not end in a format that can be written (%s)%s", o->output,
                         *kind == CLI_MESH ? CLI_MESHES_WRITTEN : CLI_GRIDS_WRITTEN ", .vtu of octrees",
                         cli_way_around(o->output, 1));
    if (to == CLI_TREE && cli_input_format(run, o->input[0]) != BVX_FORMAT_BVX)
        return cli_usage(run,
                         "%s is not an octree, and %s would be its leaves: 'bitvox refine' makes octrees",
                         cli_first_name(run), o->output);
    if (*kind == CLI_MESH && to == CLI_GRID)
        return cli_usage(run, "%s is a mesh and %s would be a grid: 'bitvox voxelize' makes a grid of a mesh",
                         cli_first_name(run), o->output);
    CLI_TRY(cli_check_rules(run, convert_rules, *kind == CLI_MESH ? CLI_OF_MESH : CLI_OF_GRID, NULL));
    return cli_window_option(run, &t->window);
}

typedef struct convert_job {
    cli_tree tree; /* the first, as cli_write_tree needs it */
    cli_input in;
    cli_voxels voxels;
} convert_job;

static int make_convert(cli_run *run, void *work, cli_made *made)
{
    convert_job *const job = work;
    const char *const out = run->options->output;
    int kind;
    CLI_TRY(check_convert_options(run, &kind, &job->tree));
    if (kind == CLI_MESH) {
        CLI_TRY(cli_open_output(run, out));
        made->mesh = &job->in.mesh;
        return cli_read_mesh(run, run->options->input[0], &job->in.mesh);
    }
    CLI_TRY(bvx_format_of_name(out) == BVX_FORMAT_VTU ? cli_open_output(run, out) : cli_open_voxels(run));
    CLI_TRY(cli_read_grid_or_tree(run, run->options->input[0], &job->tree.window, &job->in));
    if (job->in.kind == CLI_TREE) {
        bvx_octree *const tree = job->in.tree;
        made->write = cli_write_tree;
        /* cli_take_tree owns it, also where it failed. */
        job->in.tree = NULL;
        CLI_TRY(cli_take_tree(run, tree, &job->tree));
        CLI_TRY(cli_check_tree_output(run, &job->tree));
        if (job->tree.kind != 0 || run->options->window.count == 0) return CLI_DONE;
        return cli_usage(run, "--window of an octree is only for grids; %s is not a grid", out);
    }

    /* A .bvx holds a grid or an octree: only here is it known to be a grid. */
    if (bvx_format_of_name(out) == BVX_FORMAT_VTU || cli_given(run, "--expand") || cli_given(run, "--states"))
        return cli_usage(run, "--expand, --states and .vtu are for octrees; %s is a grid",
                         cli_input_name(job->in.path));
    job->voxels.name = job->in.path;
    job->voxels.grid = &job->in.grid;
    made->voxels = &job->voxels;
    made->placed = job->in.placed;
    bvx_grid_count(run->context, &job->in.grid, &made->set);
    return CLI_DONE;
}

static void tell_convert(const cli_run *run, const void *work, cli_made *made)
{
    const convert_job *const job = work;
    const bvx_mesh *const mesh = made->mesh;
    if (job->tree.tree != NULL) {
        cli_tell(made, "\n");
        cli_tell_levels(run, &job->tree, made);
        cli_tell_tree_output(run, &job->tree, made);
    }
    if (mesh == NULL) return;
    cli_tell(made, "  triangles   %" PRIu64 " of %" PRIu64 " vertices\n", mesh->triangle_count,
             mesh->vertex_count);
}

static const cli_owned convert_owns[] = {CLI_OWNS(VOXELS, convert_job, voxels),
                                         CLI_OWNS(TREE, convert_job, tree),
                                         CLI_OWNS(INPUT, convert_job, in),
                                         {0}};

const cli_command cli_convert = {
    .name = "convert",
    .bit = CLI_CONVERT,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "IN -o OUT [options]",
    .does = "a mesh, a grid or an octree in another format",
    .details =
        "Meshes: reads " CLI_MESHES_READ ", also with .gz, and writes " CLI_MESHES_WRITTEN ".\n"
        "Grids: reads " CLI_GRIDS ", also with .gz, and writes the same, .vdb, .nvdb or\n"
        "their surface half way between set and empty voxels as a mesh.\n"
        "Octrees: reads .bvx and writes .vtu, .bvx, and with --expand grids of one level.\n"
        "What the new format cannot hold (colours, texture coordinates, a lattice around a window) is reported\n"
        "in a warning. .npy and .vox hold no lattice: it goes to OUT.json beside them, and is looked for "
        "there.",
    .example = "bitvox convert fixtures/knot.ply -o knot.glb\n"
               "bitvox convert fixtures/knot.ply fixtures/terrain.ply --output-dir packed --format ply",
    .most = "--output-dir --window --level --range --label --shape --sample-type --voxel-size "
            "--normals --up --format --json",
    .rows = convert_rows,
    .job = {.size = sizeof(convert_job), .make = make_convert, .tell = tell_convert, .owns = convert_owns}};
