/* cmd_voxelize.c - bitvox voxelize: the solid of a mesh as a grid. */
#include "cli/cli.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { DEFAULT_RESOLUTION = 256 };

static int check_voxelize_options(cli_run *run)
{
    const cli_options *const o = &run->options;
    int32_t const format = bvx_format_of_name(o->output);
    size_t const n = strlen(o->output);
    if (format != BVX_FORMAT_NPY || (n > 3 && strcmp(o->output + n - 3, ".gz") == 0))
        return cli_usage(run, "%s: the name ends in no grid format that is written (.npy)", o->output);
    if (o->resolution.count != 0 && o->spacing != 0.0) return cli_usage(run, "--resolution and --spacing exclude each other");
    if (o->origin.given && o->spacing == 0.0) return cli_usage(run, "--origin needs --spacing");
    if (o->origin.given && o->padding != 0) return cli_usage(run, "--origin and --padding exclude each other");
    for (int a = 0; a < 3 && o->window.count != 0; a++)
        if (o->window.value[a] >= o->window.value[a + 3])
            return cli_usage(run, "--window is empty: it ends at %" PRId64 ", not behind %" PRId64, o->window.value[a + 3],
                             o->window.value[a]);
    return CLI_DONE;
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

static void say_grid(cli_run *run, const bvx_grid *g, uint64_t set, const bvx_solid_report *report)
{
    const bvx_lattice *const l = &g->lattice;
    double const all = (double)g->size[0] * g->size[1] * g->size[2];
    cli_say(run, "%s -> %s\n", run->options.input[0], run->options.output);
    cli_say(run, "  dims        %" PRId32 " x %" PRId32 " x %" PRId32 "\n", g->size[0], g->size[1], g->size[2]);
    cli_say(run, "  voxels      %" PRIu64 " set, %.3g %% of all\n", set, 100.0 * (double)set / all);
    cli_say(run, "  spacing     %.9g, %.9g, %.9g\n", l->spacing[0], l->spacing[1], l->spacing[2]);
    cli_say(run, "  origin      %.9g, %.9g, %.9g\n", l->origin[0] + g->low[0] * l->spacing[0],
            l->origin[1] + g->low[1] * l->spacing[1], l->origin[2] + g->low[2] * l->spacing[2]);
    if (report->unbalanced_rows != 0)
        cli_warn(run, "%" PRIu64 " of %" PRIu64 " rows do not balance: the mesh has holes or flipped triangles there; %" PRIu64
                 " crossings were dropped",
                 report->unbalanced_rows, (uint64_t)l->dims[1] * (uint64_t)l->dims[2], report->dropped);
    if (set == 0) cli_warn(run, "no voxel is set: no centre lies inside the mesh");
}

static int voxelize_mesh(cli_run *run, const bvx_mesh *mesh, bvx_grid *grid, bvx_buffer *file)
{
    const cli_options *const o = &run->options;
    bvx_solid_report report;
    bvx_voxelize_options v;
    bvx_mesh_view view;
    bvx_status status;
    double start = cli_seconds();
    int result;
    memset(&report, 0, sizeof report);
    bvx_mesh_view_of(mesh, &view);
    bvx_voxelize_options_init(&v, sizeof v);
    v.fill = o->fill;
    v.report = &report;
    for (int a = 0; a < 3 && o->window.count != 0; a++) {
        v.window.low[a] = (int32_t)o->window.value[a];
        v.window.size[a] = (int32_t)(o->window.value[a + 3] - o->window.value[a]);
    }
    status = make_lattice(run, &view, &run->report.lattice);
    if (status != BVX_OK) return cli_fail_status(run, status, o->input[0]);
    run->report.has_lattice = 1;
    status = bvx_voxelize_solid(run->context, &view, &run->report.lattice, &v, grid);
    cli_stage(run, start, "voxelize");
    if (status != BVX_OK) return cli_fail_status(run, status, o->input[0]);
    bvx_grid_count(run->context, grid, &run->report.set);
    run->report.has_set = 1;
    start = cli_seconds();
    status = bvx_write_grid(run->context, grid, BVX_FORMAT_NPY, file);
    if (status != BVX_OK) return cli_fail_status(run, status, o->output);
    result = cli_write_output(run, 0, file);
    if (result == CLI_DONE) result = cli_keep_outputs(run);
    cli_stage(run, start, "write");
    if (result == CLI_DONE) say_grid(run, grid, run->report.set, &report);
    return result;
}

static int run_voxelize(cli_run *run)
{
    bvx_mesh mesh = {0};
    bvx_grid grid = {0};
    bvx_buffer file = {0};
    int status = check_voxelize_options(run);
    if (status == CLI_DONE) status = cli_open_output(run, run->options.output);
    if (status == CLI_DONE) status = cli_read_mesh(run, run->options.input[0], &mesh);
    if (status == CLI_DONE) status = voxelize_mesh(run, &mesh, &grid, &file);
    bvx_buffer_free(run->context, &file);
    bvx_grid_free(run->context, &grid);
    bvx_mesh_free(run->context, &mesh);
    return status;
}

const cli_command cli_voxelize = {
    "voxelize", CLI_VOXELIZE, 1, "IN -o OUT.npy [options]", "the solid of a mesh as a grid of voxels",
    "Reads a mesh (.stl .obj .ply, also with .gz) and writes the voxels whose centres lie inside it:\n"
    "NumPy's .npy, bool, axes x, y, z.",
    "bitvox voxelize fixtures/knot.ply -o knot.npy --resolution 128", run_voxelize};
