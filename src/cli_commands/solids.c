/* solids.c - the rules that fill a mesh: their options, and what is reported of a solid. */
#include "cli_commands/commands.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

void cli_take_fill(const cli_run *run, bvx_voxelize_options *v)
{
    const cli_options *const o = run->options;
    v->fill = o->fill;
    v->close_gaps = o->fill == BVX_FILL_FLOOD ? o->close_gaps : 0;
    v->add_shell = o->add_shell;
}

static void thin_box(const bvx_lattice *l, const bvx_solid_report *r, double box[6])
{
    for (int a = 0; a < 3; a++) {
        box[a] = l->origin[a] + (double)r->thin_box[0][a] * l->spacing[a];
        box[a + 3] = l->origin[a] + ((double)r->thin_box[1][a] + 1.0) * l->spacing[a];
    }
}

void cli_json_losses(cli_text *t, const bvx_lattice *lattice, const bvx_solid_report *r)
{
    double box[6];

    thin_box(lattice, r, box);
    /* Volumes that are not known are left out, since 0 would be one. */
    cli_json_value(t, "volume", r->volume);
    if (r->mesh_volume != 0) cli_json_value(t, "mesh_volume", r->mesh_volume);
    if (r->crossing_volume != 0) cli_json_value(t, "crossing_volume", r->crossing_volume);
    cli_json_count(t, "volume_resolution", (uint64_t)r->volume_resolution);
    cli_json_truth(t, "thin_checked", r->thin_checked);
    cli_json_count(t, "thin_voxels", r->thin_voxels);
    cli_json_count(t, "thin_resolution", (uint64_t)r->thin_resolution);
    if (r->thin_voxels != 0) cli_json_box(t, "thin_box", box, box + 3);
}

int cli_fill_on(cli_run *run, const bvx_lattice *lattice, cli_input *in)
{
    bvx_solid_report report = {0};
    bvx_voxelize_options v = {.struct_size = sizeof v};

    cli_take_fill(run, &v);
    v.report = &report;
    bvx_mesh_view const view = cli_view(&in->mesh);
    bvx_status status = bvx_voxelize_solid(run->context, &view, lattice, &v, &in->grid);
    /* Only morph measures from the mesh afterwards; for the others its memory is free from here on. */
    if (run->command->bit != CLI_MORPH || !CLI_HOLDS(run, CLI_TO_MESH))
        bvx_mesh_free(run->context, &in->mesh);
    return cli_check_call(run, status, cli_input_name(in->path));
}

int cli_fill_input(cli_run *run, cli_input *in)
{
    bvx_lattice lattice;
    bvx_mesh_view const view = cli_view(&in->mesh);
    cli_stage_begin(run, "voxelize");
    bvx_status const status = cli_make_lattice(run, &view, &lattice);
    if (status != BVX_OK) return cli_fail_status(run, status, cli_input_name(in->path));
    CLI_TRY(cli_check_far(run, in->path, &view, &lattice));
    int const result = cli_fill_on(run, &lattice, in);
    cli_stage_end(run);
    return result;
}

/* In the order of BVX_FILL_REASON_... */
const char *const cli_fill_reasons[] = {"asked", "sound", "nested", "overlap", "open", "unorientable"};

void cli_tell_fill(cli_text *t, const bvx_solid_report *r)
{
    static const char *const why[] = {"",
                                      ": closed, nothing lies inside twice",
                                      ": closed shells lie in others and do not cross",
                                      ": closed shells cross",
                                      ": open edges",
                                      ": triangles that cannot be oriented"};
    cli_text_add(t, "  fill        %s%s", cli_fill_names[r->fill], why[r->fill_reason]);
    if (r->turned != 0)
        cli_text_add(t, "; %" PRIu64 " triangle%s reversed", r->turned, r->turned == 1 ? "" : "s");
    cli_text_add(t, "\n");
}

static double voxel_volume(const bvx_lattice *l)
{
    return l->spacing[0] * l->spacing[1] * l->spacing[2];
}

void cli_report_solid(const cli_run *run, cli_text *t, const bvx_lattice *lattice, const bvx_solid_report *r)
{
    const cli_options *const o = run->options;
    double const voxel = voxel_volume(lattice);

    cli_text_add(t, ", \"solid\": {\"fill\": \"%s\", \"reason\": \"%s\"", cli_fill_names[r->fill],
                 cli_fill_reasons[r->fill_reason]);
    cli_json_count(t, "turned", r->turned);
    cli_json_count(t, "crossings", r->crossings);
    cli_json_count(t, "unbalanced_rows", r->unbalanced_rows);
    /* Members that only some rules have: a program must not take 0 for a count. */
    if (o->fill == BVX_FILL_FLOOD) cli_json_count(t, "leaks", r->leaks);
    if (o->fill == BVX_FILL_REGIONS) {
        cli_json_count(t, "regions", r->regions);
        cli_json_count(t, "mixed_regions", r->mixed_regions);
        cli_json_count(t, "mixed_voxels", r->mixed_voxels);
    }
    if (cli_given(run, "--second")) {
        cli_json_count(t, "cut_voxels", r->cut_voxels);
        cli_json_count(t, "fill_voxels", r->fill_voxels);
        cli_json_value(t, "cut_volume", (double)r->cut_voxels * voxel);
        cli_json_value(t, "fill_volume", (double)r->fill_voxels * voxel);
    }
    cli_json_losses(t, lattice, r);
    cli_text_add(t, "}");
}

void cli_tell_solid(const cli_run *run, const bvx_grid *grid, const bvx_solid_report *r, cli_made *made)
{
    const cli_options *const o = run->options;
    double const voxel = voxel_volume(&grid->lattice);

    cli_tell_fill(&made->text, r);
    if (o->fill == BVX_FILL_REGIONS) cli_text_add(&made->text, "  regions     %" PRIu64 "\n", r->regions);
    if (cli_given(run, "--second"))
        cli_text_add(
            &made->text,
            "  cut         %" PRIu64 " voxels, volume %.9g\n  fill        %" PRIu64 " voxels, volume %.9g\n",
            r->cut_voxels, (double)r->cut_voxels * voxel, r->fill_voxels, (double)r->fill_voxels * voxel);
    if (r->thin_checked)
        cli_text_add(&made->text,
                     "  thin        %" PRIu64
                     " voxels at walls below 1.5 voxels that are lost or have gaps\n",
                     r->thin_voxels);
    cli_report_solid(run, &made->members, &grid->lattice, r);
}
