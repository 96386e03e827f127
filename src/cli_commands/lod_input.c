/* lod_input.c - what a chain of levels is made from: the solid of a mesh, at a resolution that suits its
 * levels, or a grid as it is, whose own surface then stands for the mesh. */
#include "cli_commands/lod_chain.h"

#include <string.h>

/* Samples along the longest axis. A small grid gives smaller levels than usual, as none can be finer. */
int32_t cli_level_resolution(const cli_run *run, const cli_chain *c, int level)
{
    const cli_lod_options *const own = run->own;
    int32_t const finest = c->kind == CLI_GRID && c->resolution < 64 ? c->resolution : 64;
    int32_t const usual = finest >> level;
    return own->resolutions.count != 0 ? (int32_t)own->resolutions.value[level] : usual > 0 ? usual : 1;
}

static int choose_resolution(cli_run *run, cli_chain *c)
{
    const cli_options *const options = run->options;
    const cli_lod_options *const own = run->own;
    int32_t resolutions[CLI_MAX_LEVELS], limited;
    uint64_t targets[CLI_MAX_LEVELS];
    bvx_lod_options o = own->samples;

    o.struct_size = sizeof o;
    if (options->resolution.count != 0) {
        c->resolution = (int32_t)options->resolution.value[0];
        c->chosen = "given";
        return CLI_DONE;
    }

    if (c->by_triangles) o.target_triangles = targets;
    else o.resolutions = resolutions;
    for (int i = 0; i < c->asked; i++) {
        if (c->by_triangles) targets[i] = (uint64_t)options->triangles.value[i];
        else resolutions[i] = cli_level_resolution(run, c, i);
    }

    CLI_TRY(cli_check_call(run,
                           bvx_plan_lods(run->context, &c->view, &o, (uint64_t)c->asked, options->padding,
                                         &c->resolution, &limited),
                           cli_first_name(run)));
    c->chosen = limited ? "what memory allows" : "8 x the finest level";
    return CLI_DONE;
}

static int count_solid(cli_run *run, const cli_chain *c)
{
    bvx_grid_count(run->context, &c->solid, &run->report.set);
    run->report.has_set = 1;
    if (run->report.set != 0) return CLI_DONE;
    return cli_fail(run,
                    c->kind == CLI_GRID
                        ? "%s: the grid is empty; there is nothing to make levels from"
                        : "%s: no voxel's centre lies inside the mesh; --method collapse makes levels of its "
                          "surface",
                    cli_first_name(run));
}

static int open_mesh(cli_run *run, cli_chain *c)
{
    CLI_TRY(cli_read_mesh(run, run->options->input[0], &c->input));
    CLI_TRY(cli_check_carry(run, &c->input));
    c->input_triangles = c->input.triangle_count;
    bvx_mesh_view_of(&c->input, &c->view);

    const char *const path = cli_first_name(run);
    bvx_voxelize_options v = {.struct_size = sizeof v};

    CLI_TRY(CLI_STAGE(run, "check input", bvx_mesh_check(run->context, &c->view, 1, &c->certificate), path));
    c->diagonal = cli_diagonal(c->certificate.box.low, c->certificate.box.high);
    CLI_TRY(choose_resolution(run, c));
    cli_stage_begin(run, "voxelize");
    bvx_lattice_options const fit = {
        .struct_size = sizeof fit, .resolution = c->resolution, .padding = run->options->padding};
    CLI_TRY(
        cli_check_call(run, bvx_lattice_fit_with(run->context, &c->view, &fit, &run->report.lattice), path));
    run->report.has_lattice = 1;
    cli_take_fill(run, &v);
    v.report = &c->solid_report;
    bvx_status const status = bvx_voxelize_solid(run->context, &c->view, &run->report.lattice, &v, &c->solid);
    c->solid_seconds = cli_stage_end(run);
    CLI_TRY(cli_check_call(run, status, path));
    return count_solid(run, c);
}

/* The surface of all voxels; only its count where nothing is measured. */
static bvx_status surface_of_solid(cli_run *run, cli_chain *c)
{
    uint64_t vertices;
    if (run->options->samples == 0)
        return bvx_extract_count(run->context, &c->solid, NULL, &vertices, &c->input_triangles);
    bvx_status const status = bvx_extract_surface(run->context, &c->solid, NULL, &c->input);
    c->input_triangles = c->input.triangle_count;
    return status;
}

int cli_open_chain(cli_run *run, cli_chain *c)
{
    if (c->kind != CLI_GRID) return open_mesh(run, c);

    const char *const path = run->options->input[0];
    double low[3], high[3];
    int placed;

    /* The lattice may be assumed: levels of it are as good, in units of voxels. */
    CLI_TRY(cli_read_grid(run, path, NULL, &c->solid, &placed));
    run->report.lattice = c->solid.lattice;
    run->report.has_lattice = 1;
    /* The diagonal of the window stands for that of a mesh: distances are told in percent of it. */
    for (int a = 0; a < 3; a++) {
        c->resolution = c->solid.size[a] > c->resolution ? c->solid.size[a] : c->resolution;
        low[a] = c->solid.low[a] * c->solid.lattice.spacing[a];
        high[a] = low[a] + c->solid.size[a] * c->solid.lattice.spacing[a];
    }
    c->diagonal = cli_diagonal(low, high);
    CLI_TRY(count_solid(run, c));
    CLI_TRY(CLI_STAGE(run, "surface", surface_of_solid(run, c), cli_input_name(path)));
    bvx_mesh_view_of(&c->input, &c->view);
    return CLI_DONE;
}
