/* kept_parts.c - --keep-largest and --least-part: which parts of voxels
 * stay, wherever a grid is made or read. */
#include "cli_inputs/inputs.h"

#include <inttypes.h>
#include <string.h>

/* Of a mesh, lod takes them for the surface that it measures. */
static int keeps_measured_parts(const cli_run *run)
{
    return run->command->bit == CLI_LOD &&
           cli_kind_of_input(cli_input_format(run, run->options->input[0])) == CLI_MESH;
}

uint64_t cli_least_part(const cli_run *run)
{
    int64_t const least = run->options->least_part;
    return least > 0 && !keeps_measured_parts(run) ? (uint64_t)least : 0;
}

uint64_t cli_keep_largest(const cli_run *run)
{
    return keeps_measured_parts(run) ? 0 : (uint64_t)run->options->keep_largest;
}

int cli_check_parts(cli_run *run)
{
    const char *const name = run->options->keep_largest != 0 ? "--keep-largest" : "--least-part";
    if (!CLI_HOLDS(run, CLI_KEEPS_PARTS) ||
        (run->command->bit & (CLI_LOD | CLI_FACES | CLI_RENDER | CLI_CONVERT)) == 0)
        return CLI_DONE;
    /* Commands that take meshes and grids alike: one mesh among the inputs is refused, since its parts are
     * none of voxels. */
    for (int i = 0; i < run->options->inputs; i++)
        if (cli_kind_of_input(cli_input_format(run, run->options->input[i])) == CLI_MESH)
            return cli_usage(run, "%s is for grids and volumes; %s is a mesh", name,
                             cli_input_name(run->options->input[i]));
    return CLI_DONE;
}

bvx_status cli_keep_parts(cli_run *run, const bvx_grid *grid, bvx_grid *kept)
{
    int const own = !run->progress.named; /* else it is a part of the caller's stage */
    bvx_keep_report report = {0};

    bvx_keep_options o = {.struct_size = sizeof o,
                          .largest = cli_keep_largest(run),
                          .at_least = cli_least_part(run),
                          .report = &report};
    if (own) cli_stage_begin(run, "keep");
    bvx_status const status = bvx_grid_keep(run->context, grid, &o, kept);
    if (own) cli_stage_end(run);
    if (status != BVX_OK) return status;

    run->report.parts.kept += report.kept;
    run->report.parts.dropped += report.dropped;
    run->report.parts.voxels_kept += report.voxels_kept;
    run->report.parts.voxels_dropped += report.voxels_dropped;
    run->report.has_parts = 1;
    return BVX_OK;
}

void cli_tell_parts(const cli_run *run, cli_text *text)
{
    const bvx_keep_report *const p = &run->report.parts;
    if (!run->report.has_parts) return;
    cli_text_add(text, "  kept        %" PRIu64 " of %" PRIu64 " parts; %" PRIu64 " voxels went\n", p->kept,
                 p->kept + p->dropped, p->voxels_dropped);
}
