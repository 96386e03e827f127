/* clouds.c - voxels of a cloud of points, for bitvox voxelize. */
#include "cli_commands/commands.h"

#include <inttypes.h>
#include <string.h>

const cli_rule cli_cloud_rules[] = {
    {.when = CLI_OF_CLOUD,
     .given =
         "--mode --fill --add-shell --check-edges --check-thin --compare-fills --half-width --sign --vectors "
         "--value-type",
     .message = "%o is for meshes; %i is a cloud of points"},
    {.when = CLI_OF_MESH, .given = "--minimum --body", .message = "%o is for clouds of points; %i is a mesh"},
    {.when = CLI_OF_VOLUME,
     .given = "--minimum --body",
     .message = "%o is for clouds of points; %i is a volume"},
    {.when = CLI_OF_CLOUD, .given = "--close-gaps", .lacking = "--body", .message = "%o needs --body"},
    {.when = CLI_OF_CLOUD,
     .given = "--body",
     .beside = "--window",
     .message = "%o needs the whole lattice, no %b"},
    {0}};

static void tell_cloud(cli_run *run, const bvx_points_report *r)
{
    cli_text *const t = &run->report.more;

    cli_say(run, "  points      %" PRIu64, r->inside);
    if (r->outside != 0) cli_say(run, ", and %" PRIu64 " outside", r->outside);
    cli_say(run, "\n  occupied    %" PRIu64 "\n", r->occupied);
    if (run->options->body) cli_say(run, "  filled      %" PRIu64 "\n", r->filled);
    cli_text_add(t, ", \"cloud\": {\"inside\": %" PRIu64, r->inside);
    cli_json_count(t, "outside", r->outside);
    cli_json_count(t, "occupied", r->occupied);
    cli_json_count(t, "filled", r->filled);
    cli_json_count(t, "pockets", r->pockets);
    cli_text_add(t, "}");
}

static int make_cloud_voxels(cli_run *run, const bvx_mesh_view *points, const bvx_window *window,
                             bvx_points_report *report, bvx_grid *grid)
{
    const cli_options *const o = run->options;
    bvx_lattice *const l = &run->report.lattice;
    bvx_points_options p;
    bvx_status status = cli_make_cloud_lattice(run, points, l);
    int result;

    if (status != BVX_OK) return cli_fail_status(run, status, cli_input_name(o->input[0]));
    run->report.has_lattice = 1;
    result = window->size[0] == 0 ? cli_check_far(run, cli_input_name(o->input[0]), points, 1, l) : CLI_DONE;
    if (result != CLI_DONE) return result;
    result = cli_check_grid_format(run, o->output, l, window->size[0] != 0 ? window->size : l->dims);
    if (result != CLI_DONE) return result;
    bvx_points_options_init(&p, sizeof p);
    if (o->minimum != 0) p.minimum = o->minimum;
    p.body = o->body;
    p.close_gaps = o->close_gaps;
    p.window = *window;
    p.report = report;
    status = bvx_voxelize_points(run->context, points, l, &p, grid);
    if (status == BVX_OK && cli_keeps_parts(run)) status = cli_keep_parts(run, grid, grid);
    if (status == BVX_OK) status = bvx_grid_count(run->context, grid, &run->report.set);
    if (status != BVX_OK) return cli_fail_status(run, status, cli_input_name(o->input[0]));
    run->report.has_set = 1;
    return CLI_DONE;
}

int cli_voxelize_cloud(cli_run *run, const bvx_mesh_view *points, const bvx_window *window)
{
    bvx_points_report report;
    bvx_grid grid;
    int status;

    memset(&report, 0, sizeof report);
    memset(&grid, 0, sizeof grid);
    cli_stage_begin(run, "voxelize");
    status = make_cloud_voxels(run, points, window, &report, &grid);
    if (status == CLI_DONE) cli_stage_end(run);
    if (status == CLI_DONE) status = cli_write_grid(run, &grid);
    if (status == CLI_DONE) {
        cli_say(run, "%s -> %s\n", cli_input_name(run->options->input[0]), run->options->output);
        cli_say_grid(run, &grid, run->report.set, 1);
        tell_cloud(run, &report);
        if (run->report.set == 0) cli_warn(run, "no voxel is set: none holds so many points");
        else if (run->options->body && report.pockets == 0)
            cli_warn(
                run,
                "the body has no inside: the flood comes in everywhere; try --close-gaps of more than %" PRId32
                ", or larger voxels",
                run->options->close_gaps);
    }
    bvx_grid_free(run->context, &grid);
    return status;
}
