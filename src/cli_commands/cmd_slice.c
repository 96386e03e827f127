/* cmd_slice.c - bitvox slice: the contours of a mesh or grid on parallel planes. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <string.h>

typedef struct slice_options {
    int32_t up_axis; /* 1 to 3; 0: not given */
    double spacing;  /* of planes */
} slice_options;

#define OWN(name) CLI_OWN(slice_options, name)

static const cli_argument slice_rows[] = {
    {.also = cli_takes_output},
    CHOICE("--axis", "AXIS", OWN(up_axis), cli_axis_names, 1, "planes lie across x, y or z [z]"),
    BETWEEN("--spacing", "S", OWN(spacing), 0, 1e300,
            "from plane to plane; the first lies half of it above the low end"),
    {.also = cli_takes_all},
    {0}};

typedef struct slice_job {
    cli_input in;
    bvx_sections sections;
} slice_job;

static int write_contours(cli_run *run, void *work)
{
    const slice_job *const job = work;
    const char *const path = run->options->output;
    bvx_buffer file = {0};
    cli_stage_begin(run, "write");
    bvx_status status = bvx_write_sections(run->context, &job->sections, bvx_format_of_name(path), &file);
    int result = cli_write_buffer(run, 0, status, &file, path);
    if (result == CLI_DONE) result = cli_keep_outputs(run);
    cli_stage_end(run);
    return result;
}

static int make_slice(cli_run *run, void *work, cli_made *made)
{
    const slice_options *const own = run->own;
    const cli_options *const o = run->options;
    int32_t const format = bvx_format_of_name(o->output);
    slice_job *const job = work;
    int kind;

    made->write = write_contours;
    CLI_TRY(cli_input_kind(run, o->input[0], &kind));
    if (format != BVX_FORMAT_CSL && format != BVX_FORMAT_CSV)
        return cli_usage(
            run,
            "%s: the name does not end in a contour format that can be written (" CLI_CONTOURS_WRITTEN ")",
            o->output);
    if (!cli_given(run, "--spacing")) return cli_usage(run, "--spacing is needed");
    /* Its columns are x and y of a section at a height z. */
    if (format == BVX_FORMAT_CSV && own->up_axis != 0 && own->up_axis != 3)
        return cli_usage(run, "%s: .csv holds planes across z only; take .csl", o->output);
    CLI_TRY(cli_open_output(run, o->output));
    CLI_TRY(cli_read_input(run, o->input[0], &job->in));

    /* Contours are doubles: a surface in floats would round them twice. */
    bvx_extract_options e = {.struct_size = sizeof e, .position_type = BVX_F64};
    if (job->in.kind != CLI_MESH)
        CLI_TRY(CLI_STAGE(run, "surface", bvx_extract_surface(run->context, &job->in.grid, &e, &job->in.mesh),
                          cli_input_name(job->in.path)));

    int const axis = own->up_axis != 0 ? own->up_axis - 1 : 2;
    bvx_slice_options s = {.struct_size = sizeof s};
    for (int k = 0; k < 3; k++) s.normal[k] = k == axis;
    s.spacing = own->spacing;
    bvx_mesh_view const view = cli_view(&job->in.mesh);
    return CLI_STAGE(run, "slice", bvx_slice_mesh(run->context, &view, &s, &job->sections),
                     cli_first_name(run));
}

static void tell_slice(const cli_run *run, const void *work, cli_made *made)
{
    const bvx_sections *const s = &((const slice_job *)work)->sections;
    (void)run;
    cli_tell(made, "  %" PRIu64 " planes, %" PRIu64 " loops, %" PRIu64 " points\n", s->section_count,
             s->loop_count, s->point_count);
    cli_text_add(&made->members, ", \"slice\": {\"planes\": %" PRIu64, s->section_count);
    cli_json_count(&made->members, "loops", s->loop_count);
    cli_json_count(&made->members, "points", s->point_count);
    cli_text_add(&made->members, "}");
}

static const cli_owned slice_owns[] = {
    CLI_OWNS(SECTIONS, slice_job, sections), CLI_OWNS(INPUT, slice_job, in), {0}};

const cli_command cli_slice = {
    .name = "slice",
    .bit = CLI_SLICE,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "IN -o OUT --spacing S [options]",
    .does = "the contours of a mesh or grid on parallel planes",
    .details =
        "Reads a closed mesh (" CLI_MESHES_READ ") or a grid (" CLI_GRIDS "),\n"
        "also with .gz, and writes where planes meet its surface, exactly: .csl or .csv (planes across z).\n"
        "'bitvox sections' makes a body of the contours again, unless the mesh crosses itself, which\n"
        "'bitvox repair' mends first, as it closes holes and turns flipped triangles.",
    .example = "bitvox slice fixtures/knot.ply -o knot.csl --spacing 0.1\n"
               "bitvox slice fixtures/knot.ply -o across.csl --axis x --spacing 0.2",
    .rows = slice_rows,
    .own = sizeof(slice_options),
    .job = {.size = sizeof(slice_job), .make = make_slice, .tell = tell_slice, .owns = slice_owns}};
