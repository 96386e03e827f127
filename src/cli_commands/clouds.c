/* clouds.c - voxels of a cloud of points, for bitvox voxelize. */
#include "cli_commands/commands.h"

#include <inttypes.h>

const cli_rule cli_cloud_rules[] = {
    {.when = CLI_OF_CLOUD,
     .given =
         "--mode --fill --add-shell --check-edges --check-thin --compare-fills --half-width --sign --vectors "
         "--value-type --sharp --no-sharp",
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

void cli_tell_cloud(const cli_run *run, const bvx_points_report *r, cli_made *made)
{
    const cli_voxelize_options *const own = run->own;
    cli_text *const lines = &made->text, *const t = &made->members;

    cli_text_add(lines, "  points      %" PRIu64, r->inside);
    if (r->outside != 0) cli_text_add(lines, ", and %" PRIu64 " outside", r->outside);
    cli_text_add(lines, "\n  occupied    %" PRIu64 "\n", r->occupied);
    if (own->cloud.body) cli_text_add(lines, "  filled      %" PRIu64 "\n", r->filled);

    cli_text_add(t, ", \"cloud\": {\"inside\": %" PRIu64, r->inside);
    cli_json_count(t, "outside", r->outside);
    cli_json_count(t, "occupied", r->occupied);
    cli_json_count(t, "filled", r->filled);
    cli_json_count(t, "pockets", r->pockets);
    cli_text_add(t, "}");

    if (made->set == 0) cli_advise(made, "the result is empty: no voxel holds so many points");
    else if (own->cloud.body && r->pockets == 0)
        cli_advise(
            made,
            "the body has no inside: the flood comes in everywhere; try --close-gaps of more than %" PRId32
            ", or larger voxels",
            run->options->close_gaps);
}

bvx_status cli_make_cloud(const cli_run *run, const bvx_mesh_view *points, const bvx_lattice *lattice,
                          const bvx_window *window, bvx_points_report *report, bvx_grid *grid)
{
    const cli_voxelize_options *const own = run->own;
    const cli_options *const o = run->options;
    bvx_points_options p = own->cloud;

    p.close_gaps = o->close_gaps;
    p.window = *window;
    p.report = report;
    return bvx_voxelize_points(run->context, points, lattice, &p, grid);
}
