/* fill_table.c - voxelize --compare-fills: what each rule would set, where
 * the rules differ, and what all of them lose. */
#include "cli_commands/commands.h"

#include <inttypes.h>
#include <string.h>

static void tell_table(cli_text *t, const bvx_fill_comparison *c)
{
    cli_text_add(t, "  rules       %12s\n", "voxels");
    for (int32_t i = BVX_FILL_PARITY; i <= BVX_FILL_REGIONS; i++)
        cli_text_add(t, "    %-9s %12" PRIu64 "%s\n", cli_fill_names[i], c->set[i],
                     i == BVX_FILL_FLOOD && c->flood_leaked ? "  (the flood came in: not compared)" : "");
    cli_text_add(t, "  they differ on %" PRIu64 " voxels beside the %" PRIu64 " of the surface\n",
                 c->disagreeing, c->surface_voxels);
    if (c->lost_voxels == 0) cli_text_add(t, "  no walls are lost\n");
    else
        cli_text_add(t,
                     "  walls thinner than a voxel are lost in %" PRIu64 " places, %" PRIu64
                     " voxels of the surface\n",
                     c->lost_places, c->lost_voxels);
}

static void report_table(cli_text *t, const bvx_fill_comparison *c)
{
    cli_text_add(t, ", \"fills\": {\"set\": {");
    for (int32_t i = BVX_FILL_PARITY; i <= BVX_FILL_REGIONS; i++)
        cli_text_add(t, "%s\"%s\": %" PRIu64, i == BVX_FILL_PARITY ? "" : ", ", cli_fill_names[i], c->set[i]);
    cli_text_add(t, "}");
    cli_json_count(t, "surface_voxels", c->surface_voxels);
    cli_json_count(t, "disagreeing", c->disagreeing);
    cli_json_count(t, "lost_voxels", c->lost_voxels);
    cli_json_count(t, "lost_places", c->lost_places);
    cli_json_truth(t, "flood_leaked", c->flood_leaked);
    cli_text_add(t, "}");
}

int cli_compare_fills(cli_run *run, const bvx_mesh_view *mesh, const bvx_lattice *lattice,
                      bvx_fill_comparison *comparison)
{
    bvx_compare_fills_options o;
    bvx_status status;

    bvx_compare_fills_options_init(&o, sizeof o);
    o.close_gaps = run->options->close_gaps;
    memset(comparison, 0, sizeof *comparison);
    cli_stage_begin(run, "compare fills");
    status = bvx_compare_fills(run->context, mesh, lattice, &o, comparison);
    return cli_stage_check(run, status, cli_input_name(run->options->input[0]));
}

void cli_tell_fills(const bvx_fill_comparison *comparison, cli_made *made)
{
    tell_table(&made->text, comparison);
    report_table(&made->members, comparison);
}
