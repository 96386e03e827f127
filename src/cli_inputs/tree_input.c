/* tree_input.c - a level of an octree as a grid. */
#include "cli_inputs/inputs.h"

#include <inttypes.h>

#define TREE_GRID_BYTES (UINT64_C(1) << 30) /* most bytes of a grid without --memory-limit */

int cli_check_tree_level(cli_run *run, int32_t levels)
{
    if (run->options->expand <= levels) return CLI_DONE;
    return cli_usage(run, "--expand %" PRId32 " is beyond the last level, %" PRId32, run->options->expand,
                     levels);
}

/* A window of the last level, in voxels of one so many levels above. */
static void window_at(const bvx_window *finest, int32_t shift, bvx_window *w)
{
    *w = *finest;
    for (int a = 0; a < 3 && finest->size[0] != 0; a++) {
        /* Outwards: a coarse voxel belongs to the window that it overlaps. */
        int64_t const end = (int64_t)finest->low[a] + finest->size[a];
        w->low[a] = finest->low[a] >> shift;
        w->size[a] = (int32_t)((end + (INT64_C(1) << shift) - 1) >> shift) - w->low[a];
    }
}

int cli_expand_tree(cli_run *run, const bvx_octree *tree, const bvx_window *finest, const char *path,
                    bvx_grid *grid)
{
    const cli_options *const o = run->options;
    int32_t const levels = bvx_octree_levels(tree), level = cli_given(run, "--expand") ? o->expand : levels;
    bvx_lattice lattice;
    bvx_window window;
    bvx_status status;
    uint64_t words;

    CLI_TRY(cli_check_tree_level(run, levels));
    CLI_TRY(cli_check_call(run, bvx_octree_lattice(run->context, tree, level, &lattice), path));
    window_at(finest, levels - level, &window);
    words = bvx_grid_bound(&lattice, &window);
    /* An octree is small where its grid is not, so the size is refused unless a limit allows it. */
    if (o->general.memory_limit == 0 && words > TREE_GRID_BYTES / 8)
        return cli_fail(run,
                        "%s: the grid of level %" PRId32 " would take %" PRIu64
                        " MiB: take a lower --expand or a --window, or allow it by "
                        "--memory-limit",
                        path, level, words >> 17);
    /* Refused before the time that it takes, not after. */
    if (o->output != NULL && cli_kind_of_format(bvx_format_of_name(o->output)) == CLI_GRID) {
        CLI_TRY(cli_check_grid_format(run, o->output, &lattice,
                                      window.size[0] != 0 ? window.size : lattice.dims));
    }
    cli_stage_begin(run, "expand");
    status = bvx_octree_expand(run->context, tree, level, o->states, &window, grid);
    return cli_stage_check(run, status, path);
}
