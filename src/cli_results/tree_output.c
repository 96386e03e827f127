/* tree_output.c - an octree in, and out: as a tree, as the voxels of one level, or as a mesh. */
#include "cli_results/results.h"

#include <string.h>

int cli_check_tree_output(cli_run *run, cli_tree *t)
{
    const char *const path = run->options->output;
    int32_t const format = bvx_format_of_name(path);
    int const expand = cli_given(run, "--expand");

    t->kind = format == BVX_FORMAT_BVX && !expand ? 0 : cli_kind_of_format(format);
    if (t->kind == 0 && format != BVX_FORMAT_VTU && format != BVX_FORMAT_BVX)
        return cli_usage(
            run,
            "%s: the name does not end in a format that octrees can be written to (.bvx .vtu, .npy .binvox "
            ".vox .nrrd .vti, " CLI_MESHES_WRITTEN ")",
            path);
    if (expand && t->kind != CLI_GRID)
        return cli_usage(run, "--expand is only for grids; %s is not a grid", path);
    if (cli_given(run, "--states") && t->kind == 0 && format == BVX_FORMAT_BVX)
        return cli_usage(
            run, "--states chooses voxels; %s holds the whole octree: take --expand, or another format",
            path);
    return CLI_DONE;
}

int cli_open_tree_output(cli_run *run, const cli_tree *t)
{
    return t->kind == CLI_GRID ? cli_open_grid_output(run, run->options->output)
                               : cli_open_output(run, run->options->output);
}

int cli_take_tree(cli_run *run, bvx_octree *tree, cli_tree *t)
{
    t->tree = tree;
    /* Owned from here on, whatever fails below. */
    t->levels = bvx_octree_levels(tree);
    const char *const in = cli_first_name(run);
    CLI_TRY(cli_check_call(run, bvx_octree_lattice(run->context, tree, 0, &t->base), in));
    CLI_TRY(cli_check_call(run, bvx_octree_lattice(run->context, tree, t->levels, &run->report.lattice), in));
    CLI_TRY(cli_check_call(run, bvx_octree_count(run->context, tree, t->level, CLI_TREE_LEVELS + 1), in));
    run->report.has_lattice = 1;
    return CLI_DONE;
}

int cli_write_tree(cli_run *run, void *tree)
{
    cli_tree *const t = tree;
    if (t->kind == CLI_GRID) {
        CLI_TRY(cli_expand_tree(run, t->tree, &t->window, run->options->output, &t->grid));
        bvx_grid_count(run->context, &t->grid, &run->report.set);
        run->report.has_set = 1;
        return cli_write_grid(run, &t->grid);
    }
    if (t->kind == CLI_MESH) {
        CLI_TRY(CLI_STAGE(run, "surface",
                          bvx_extract_octree(run->context, t->tree, run->options->states, NULL, &t->surface),
                          run->options->output));
        CLI_TRY(t->surface.triangle_count != 0
                    ? CLI_DONE
                    : cli_fail(run, "%s: no voxel has these states", run->options->output));
    }

    const char *const path = run->options->output;
    bvx_buffer file = {0};
    if (t->kind == CLI_MESH) return cli_write_mesh(run, &t->surface);
    cli_stage_begin(run, "write");
    int result = cli_write_buffer(
        run, 0,
        bvx_write_octree(run->context, t->tree, run->options->states, bvx_format_of_name(path), &file), &file,
        path);
    if (result == CLI_DONE) result = cli_keep_outputs(run);
    cli_stage_end(run);
    return result;
}

void cli_free_tree(cli_run *run, cli_tree *t)
{
    bvx_mesh_free(run->context, &t->surface);
    bvx_grid_free(run->context, &t->grid);
    bvx_octree_free(run->context, t->tree);
    memset(t, 0, sizeof *t);
}
