/* cmd_voxelize.c - bitvox voxelize: the solid or the surface of a mesh as a grid, or the distances to it. */
#include "cli_commands/commands.h"

#include <inttypes.h>
#include <string.h>

/* What the voxels are made from. */
typedef struct voxel_job {
    bvx_mesh mesh, second; /* second: --second */
    bvx_mesh_view view, second_view;
    cli_box box; /* what the lattice must hold */
    int boxed;   /* the lattice is fitted to the box, not to the mesh */
    bvx_window window;
    bvx_grid grid;
    int cloud; /* 1: mesh holds points alone */
} voxel_job;

/* ---- what is asked for ---- */

static int check_mode(cli_run *run)
{
    static const char *const of_solids[] = {"--fill",        "--close-gaps", "--add-shell",
                                            "--check-edges", "--check-thin", "--compare-fills",
                                            "--base",        "--second",     "--up"};
    int32_t const mode = run->options->mode;
    for (size_t i = 0; i < sizeof of_solids / sizeof of_solids[0] && mode != CLI_MODE_SOLID; i++)
        if (cli_given(run, of_solids[i]))
            return cli_usage(run, "%s is for solids; --mode %s has no use for it", of_solids[i],
                             cli_mode_names[mode]);
    return CLI_DONE;
}

static int check_second(cli_run *run)
{
    const char *const second = run->options->second;
    int kind, status;
    if (second == NULL) return CLI_DONE;
    if (strcmp(second, "-") == 0)
        return cli_usage(run, "--second takes a file with a name, not standard input");
    status = cli_input_kind(run, second, &kind);
    if (status == CLI_DONE && kind == CLI_GRID)
        return cli_usage(run, "--second takes a mesh; %s is a grid", second);
    return status;
}

/* A volume has its own lattice. */
static int check_volume(cli_run *run, bvx_window *window)
{
    static const char *const of_meshes[] = {
        "--resolution", "--spacing",   "--origin",      "--padding",    "--mode",          "--fill",
        "--close-gaps", "--add-shell", "--check-edges", "--check-thin", "--compare-fills", "--base",
        "--second",     "--up",        "--half-width",  "--sign",       "--vectors",       "--value-type"};

    for (size_t i = 0; i < sizeof of_meshes / sizeof of_meshes[0]; i++)
        if (cli_given(run, of_meshes[i]))
            return cli_usage(run, "%s is for meshes; %s is a volume", of_meshes[i],
                             cli_input_name(run->options->input[0]));
    if (cli_check_cloud_options(run, "a volume") != CLI_DONE) return CLI_USAGE;
    return cli_window_option(run, window);
}

static int check_voxelize_options(cli_run *run, bvx_window *window)
{
    const char *const input = run->options->input[0];
    int const cloud = cli_input_format(run, input) == BVX_FORMAT_XYZ;
    int kind = 0, status = cloud ? CLI_DONE : cli_input_kind(run, input, &kind);

    if (status == CLI_DONE && kind == CLI_GRID && cli_is_volume(run, input)) return check_volume(run, window);
    if (status == CLI_DONE) status = cli_check_grid_name(run, run->options->output);
    if (status == CLI_DONE)
        status = cli_refuse_reduction(run, "is for a mesh made of a volume; the result is a grid");
    if (status == CLI_DONE) status = cli_check_lattice(run);
    if (status == CLI_DONE) status = check_mode(run);
    if (status == CLI_DONE) status = cli_check_field(run);
    if (status == CLI_DONE) status = cli_check_fill(run);
    if (status == CLI_DONE) status = check_second(run);
    if (status == CLI_DONE) status = cli_window_option(run, window);
    if (status == CLI_DONE && cloud) return cli_check_cloud(run, 1);
    if (status == CLI_DONE && kind == CLI_GRID)
        return cli_usage(
            run,
            "%s is a grid already: 'bitvox convert' writes it in another format; --level, --range or --label choose "
            "voxels of a volume",
            cli_input_name(input));
    return status;
}

/* ---- the lattice ---- */

/* The lattice holds both terrains, and goes down to the base. */
static int choose_box(cli_run *run, voxel_job *job)
{
    const cli_options *const o = run->options;
    int const based = cli_given(run, "--base"), up = o->up_axis != 0 ? o->up_axis - 1 : 2;
    bvx_lattice unused;
    bvx_status status = BVX_OK;

    if (o->second == NULL && !based) return CLI_DONE;
    status = bvx_lattice_fit(run->context, &job->view, 1, &unused); /* refuses what has no box */
    if (status != BVX_OK) return cli_fail_status(run, status, cli_input_name(o->input[0]));
    cli_mesh_box(&job->mesh, &job->box);
    if (o->second != NULL) {
        cli_box other;
        status = bvx_lattice_fit(run->context, &job->second_view, 1, &unused);
        if (status != BVX_OK) return cli_fail_status(run, status, o->second);
        cli_mesh_box(&job->second, &other);
        cli_join_boxes(&job->box, &other);
    }
    if (based && o->base < job->box.low[up]) job->box.low[up] = o->base;
    job->boxed = 1;
    return CLI_DONE;
}

/* The lattice, and whether the output can hold it. */
static int choose_lattice(cli_run *run, voxel_job *job)
{
    bvx_lattice *const l = &run->report.lattice;
    int const result = choose_box(run, job);
    bvx_status status;

    if (result != CLI_DONE) return result;
    status = job->boxed ? cli_make_box_lattice(run, &job->box, l) : cli_make_lattice(run, &job->view, l);
    if (status != BVX_OK) return cli_fail_status(run, status, cli_input_name(run->options->input[0]));
    run->report.has_lattice = 1;
    if (job->window.size[0] == 0 && cli_check_far(run, run->options->input[0], &job->view, 0, l) != CLI_DONE)
        return CLI_FAILED;
    return cli_check_grid_format(run, run->options->output, l,
                                 job->window.size[0] != 0 ? job->window.size : l->dims);
}

/* ---- voxels ---- */

static bvx_status make_surface(cli_run *run, voxel_job *job, bvx_surface_report *report)
{
    bvx_surface_options s;
    bvx_surface_options_init(&s, sizeof s);
    s.mode = run->options->mode - CLI_MODE_CONSERVATIVE + BVX_SURFACE_CONSERVATIVE;
    s.window = job->window;
    s.report = report;
    return bvx_voxelize_surface(run->context, &job->view, &run->report.lattice, &s, &job->grid);
}

static bvx_status make_solid_voxels(cli_run *run, voxel_job *job, bvx_solid_report *report)
{
    bvx_voxelize_options v;
    bvx_voxelize_options_init(&v, sizeof v);
    cli_take_fill(run, &v);
    v.report = report;
    v.window = job->window;
    if (run->options->second != NULL) v.second = &job->second_view;
    return bvx_voxelize_solid(run->context, &job->view, &run->report.lattice, &v, &job->grid);
}

static void say_surface(cli_run *run, const bvx_surface_report *r)
{
    cli_text *const t = &run->report.more;
    const char *const mode = cli_mode_names[run->options->mode];
    double const mean = r->triangles != 0 ? (double)r->parts / (double)r->triangles : 0.0;

    cli_say(run, "  surface     %s\n", mode);
    cli_text_add(t, ", \"surface\": {\"mode\": \"%s\"", mode);
    if (run->options->mode == CLI_MODE_SAMPLED) {
        cli_say(run,
                "  samples     %" PRIu64 " of %" PRIu64 " triangles, mean subdivision coefficient %.3f\n",
                r->samples, r->triangles, mean);
        cli_json_count(t, "triangles", r->triangles);
        cli_json_count(t, "samples", r->samples);
        cli_json_value(t, "mean_subdivision", mean);
    }
    cli_text_add(t, "}");
}

static int voxelize_mesh(cli_run *run, voxel_job *job)
{
    int const solid = run->options->mode == CLI_MODE_SOLID;
    bvx_solid_report report;
    bvx_surface_report surface;
    bvx_fill_comparison fills;
    bvx_status status;
    int result;

    memset(&report, 0, sizeof report);
    memset(&surface, 0, sizeof surface);
    cli_stage_begin(run, "voxelize");
    result = choose_lattice(run, job);
    if (result != CLI_DONE) return result;
    if (run->options->mode == CLI_MODE_FIELD) return cli_voxelize_field(run, &job->view, &job->window);
    status = solid ? make_solid_voxels(run, job, &report) : make_surface(run, job, &surface);
    cli_stage_end(run);
    if (status == BVX_OK && cli_keeps_parts(run)) status = cli_keep_parts(run, &job->grid, &job->grid);
    if (status != BVX_OK) return cli_fail_status(run, status, cli_input_name(run->options->input[0]));
    bvx_grid_count(run->context, &job->grid, &run->report.set);
    run->report.has_set = 1;
    result = run->options->compare_fills ? cli_compare_fills(run, &job->view, &run->report.lattice, &fills)
                                         : CLI_DONE;
    if (result == CLI_DONE) result = cli_write_grid(run, &job->grid);
    if (result != CLI_DONE) return result;
    cli_say(run, "%s -> %s\n", cli_input_name(run->options->input[0]), run->options->output);
    cli_say_grid(run, &job->grid, run->report.set, 1);
    if (solid) {
        cli_say_solid(run, &job->grid.lattice, &report);
        cli_report_solid(run, &job->grid.lattice, &report);
        if (run->options->compare_fills) cli_tell_fills(run, &fills);
        cli_warn_of_solid(run, &job->grid, &report);
    } else {
        say_surface(run, &surface);
    }
    if (run->report.set == 0)
        cli_warn(run, solid ? "no voxel is set: no centre lies inside the mesh"
                            : "no voxel is set: the surface meets none of the window's");
    return CLI_DONE;
}

static int read_meshes(cli_run *run, voxel_job *job)
{
    const cli_options *const o = run->options;
    int status = cli_read_mesh_or_cloud(run, o->input[0], &job->mesh, &job->cloud);

    if (status == CLI_DONE) status = cli_check_cloud(run, job->cloud);
    if (status == CLI_DONE && o->second != NULL) status = cli_read_mesh(run, o->second, &job->second);
    if (status != CLI_DONE) return status;
    bvx_mesh_view_of(&job->mesh, &job->view);
    bvx_mesh_view_of(&job->second, &job->second_view);
    return CLI_DONE;
}

static int run_voxelize(cli_run *run)
{
    voxel_job job;
    int status;

    memset(&job, 0, sizeof job);
    status = check_voxelize_options(run, &job.window);
    if (status == CLI_DONE && cli_is_volume(run, run->options->input[0]))
        return cli_voxelize_volume(run, &job.window);
    if (status == CLI_DONE) status = cli_open_grid_output(run, run->options->output);
    if (status == CLI_DONE) status = read_meshes(run, &job);
    if (status == CLI_DONE)
        status = job.cloud ? cli_voxelize_cloud(run, &job.view, &job.window) : voxelize_mesh(run, &job);
    bvx_grid_free(run->context, &job.grid);
    bvx_mesh_free(run->context, &job.second);
    bvx_mesh_free(run->context, &job.mesh);
    return status;
}

const cli_command cli_voxelize = {
    "voxelize",
    CLI_VOXELIZE,
    1,
    1,
    "IN -o OUT [options]",
    "a mesh, a cloud of points or a volume as a grid of voxels",
    "Reads a mesh (" CLI_MESHES_READ ", also with .gz) and writes the voxels whose centres lie inside it,\n"
    "or with --mode those of its surface: .npy (NumPy, bool, axes x, y, z), .binvox, .vox (at most 256 a\n"
    "side), .nrrd, .vti or .bvx. .npy and .vox hold no lattice: it goes to OUT.json beside them.\n"
    "--mode field writes the distances from the centres to the mesh: .npy, .nrrd or .vti, f32 or f64.\n"
    "Which voxels are inside a mesh with holes is a matter of the rule: --fill, --compare-fills.\n"
    "Of a volume (.nrrd .nhdr .npy .vti .raw) --level, --range or --label choose the voxels. Where OUT is a\n"
    "mesh (" CLI_MESHES_WRITTEN ") it becomes their closed surface: of --level by the values between the\n"
    "samples, else at the middle between set and empty ones; --all-labels writes one a label, and edges\n"
    "collapse with --triangles or --error. Samples that are NaN or infinite are outside, and counted.\n\n"
    "Of a cloud of points (.xyz, or .ply without faces) the voxels that hold points are set, with --body\n"
    "also what lies behind them.",
    "bitvox voxelize fixtures/knot.ply -o knot.npy --resolution 128\n"
    "bitvox voxelize fixtures/knot.ply -o shell.vti --mode thin\n"
    "bitvox voxelize fixtures/knot.ply -o distance.vti --mode field --resolution 64\n"
    "bitvox voxelize fixtures/waves.nhdr -o waves.ply --level 120 --triangles 2000\n"
    "bitvox voxelize fixtures/labels.npy -o part_%d.stl --all-labels\n"
    "bitvox voxelize fixtures/ball.xyz -o ball.bvx --spacing 0.1 --body --close-gaps 1",
    run_voxelize};
