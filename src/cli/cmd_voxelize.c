/* cmd_voxelize.c - bitvox voxelize: the solid of a mesh as a grid. */
#include "cli/cli.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { DEFAULT_RESOLUTION = 256 };

static int check_voxelize_options(cli_run *run, bvx_window *window)
{
    const cli_options *const o = &run->options;
    int const status = cli_check_grid_name(run, o->output);
    if (status != CLI_DONE) return status;
    if (o->resolution.count != 0 && o->spacing != 0.0) return cli_usage(run, "--resolution and --spacing exclude each other");
    if (o->origin.given && o->spacing == 0.0) return cli_usage(run, "--origin needs --spacing");
    if (o->origin.given && o->padding != 0) return cli_usage(run, "--origin and --padding exclude each other");
    return cli_window_option(run, window);
}

/* From a given corner up to the mesh's high end. */
static bvx_status lattice_from_origin(cli_run *run, const bvx_mesh_view *view, bvx_lattice *lattice)
{
    const cli_options *const o = &run->options;
    bvx_lattice_options fit;
    double spacing[3] = {o->spacing, o->spacing, o->spacing};
    int32_t dims[3];
    bvx_status status;
    bvx_lattice_options_init(&fit, sizeof fit);
    memcpy(fit.spacing, spacing, sizeof spacing);
    status = bvx_lattice_fit_with(run->context, view, &fit, lattice); /* its far end covers the mesh */
    if (status != BVX_OK) return status;
    for (int a = 0; a < 3; a++) {
        double const far_end = lattice->origin[a] + lattice->dims[a] * lattice->spacing[a];
        double const n = -floor((o->origin.value[a] - far_end) / o->spacing);
        dims[a] = n < 1.0 ? 1 : n > 2147483647.0 ? INT32_MAX : (int32_t)n;
    }
    return bvx_lattice_make(run->context, o->origin.value, spacing, dims, lattice);
}

static bvx_status make_lattice(cli_run *run, const bvx_mesh_view *view, bvx_lattice *lattice)
{
    const cli_options *const o = &run->options;
    bvx_lattice_options fit;
    if (o->origin.given) return lattice_from_origin(run, view, lattice);
    bvx_lattice_options_init(&fit, sizeof fit);
    fit.padding = o->padding;
    if (o->spacing != 0.0)
        for (int a = 0; a < 3; a++) fit.spacing[a] = o->spacing;
    else if (o->resolution.count == 3)
        for (int a = 0; a < 3; a++) fit.axis_resolution[a] = (int32_t)o->resolution.value[a];
    else fit.resolution = o->resolution.count == 1 ? (int32_t)o->resolution.value[0] : DEFAULT_RESOLUTION;
    return bvx_lattice_fit_with(run->context, view, &fit, lattice);
}

static void say_solid(cli_run *run, const bvx_grid *g, const bvx_solid_report *report)
{
    const bvx_lattice *const l = &g->lattice;
    cli_say(run, "%s -> %s\n", cli_input_name(run->options.input[0]), run->options.output);
    cli_say_grid(run, g, run->report.set, 1);
    if (report->unbalanced_rows != 0)
        cli_warn(run, "%" PRIu64 " of %" PRIu64 " rows do not balance: the mesh has holes or flipped triangles there; %" PRIu64
                 " crossings were dropped",
                 report->unbalanced_rows, (uint64_t)l->dims[1] * (uint64_t)l->dims[2], report->dropped);
    if (run->report.set == 0) cli_warn(run, "no voxel is set: no centre lies inside the mesh");
}

/* The lattice, and whether the output can hold it. */
static int choose_lattice(cli_run *run, const bvx_mesh_view *view, const bvx_window *window)
{
    bvx_lattice *const l = &run->report.lattice;
    bvx_status const status = make_lattice(run, view, l);
    if (status != BVX_OK) return cli_fail_status(run, status, cli_input_name(run->options.input[0]));
    run->report.has_lattice = 1;
    return cli_check_grid_format(run, run->options.output, l, window->size[0] != 0 ? window->size : l->dims);
}

static int voxelize_mesh(cli_run *run, const bvx_mesh *mesh, const bvx_window *window, bvx_grid *grid)
{
    bvx_solid_report report;
    bvx_voxelize_options v;
    bvx_mesh_view view;
    bvx_status status;
    int result;
    memset(&report, 0, sizeof report);
    bvx_mesh_view_of(mesh, &view);
    bvx_voxelize_options_init(&v, sizeof v);
    v.fill = run->options.fill;
    v.report = &report;
    v.window = *window;
    cli_stage_begin(run, "voxelize");
    result = choose_lattice(run, &view, window);
    if (result != CLI_DONE) return result;
    status = bvx_voxelize_solid(run->context, &view, &run->report.lattice, &v, grid);
    cli_stage_end(run);
    if (status != BVX_OK) return cli_fail_status(run, status, cli_input_name(run->options.input[0]));
    bvx_grid_count(run->context, grid, &run->report.set);
    run->report.has_set = 1;
    result = cli_write_grid(run, grid);
    if (result == CLI_DONE) say_solid(run, grid, &report);
    return result;
}

static int run_voxelize(cli_run *run)
{
    bvx_mesh mesh = {0};
    bvx_grid grid = {0};
    bvx_window window;
    int kind, status = check_voxelize_options(run, &window);
    if (status == CLI_DONE) status = cli_input_kind(run, run->options.input[0], &kind);
    if (status == CLI_DONE && kind == CLI_GRID)
        return cli_usage(run, "%s is a grid already: 'bitvox convert' writes it in another format", cli_input_name(run->options.input[0]));
    if (status == CLI_DONE) status = cli_open_grid_output(run, run->options.output);
    if (status == CLI_DONE) status = cli_read_mesh(run, run->options.input[0], &mesh);
    if (status == CLI_DONE) status = voxelize_mesh(run, &mesh, &window, &grid);
    bvx_grid_free(run->context, &grid);
    bvx_mesh_free(run->context, &mesh);
    return status;
}

const cli_command cli_voxelize = {
    "voxelize", CLI_VOXELIZE, 1, 1, "IN -o OUT [options]", "the solid of a mesh as a grid of voxels",
    "Reads a mesh (.stl .obj .ply .off, also with .gz) and writes the voxels whose centres lie inside it:\n"
    ".npy (NumPy, bool, axes x, y, z), .binvox, .vox (at most 256 a side), .nrrd, .vti or .bvx. .npy and\n"
    ".vox hold no lattice: it goes to OUT.json beside them.",
    "bitvox voxelize fixtures/knot.ply -o knot.npy --resolution 128", run_voxelize};
