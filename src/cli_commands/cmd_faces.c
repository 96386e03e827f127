/* cmd_faces.c - bitvox faces: the voxels themselves as a mesh, for programs that show meshes only. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <string.h>

#define OWN(name) CLI_OWN(bvx_faces_options, name)

static const cli_argument faces_rows[] = {
    {.also = cli_takes_output},
    {.also = cli_takes_lattice},
    {.also = cli_takes_padding},
    {.also = cli_takes_fill_of_solids},
    {.also = cli_takes_volumes},
    FLAG("--merge", OWN(merged), "faces of one plane become few rectangles"),
    {.also = cli_takes_file_of_a_mesh},
    {.also = cli_takes_kept_parts},
    {.also = cli_takes_all},
    {0}};

static int check_faces_options(cli_run *run)
{
    static const cli_rule rules[] = {{.also = cli_to_mesh_rules},
                                     {.when = CLI_OF_GRID, .also = cli_grid_rules},
                                     {.also = cli_lattice_rules},
                                     {.also = cli_fill_rules},
                                     {0}};
    const char *const path = run->options->input[0];
    int kind;
    CLI_TRY(cli_input_kind(run, path, &kind));
    return cli_check_rules(run, rules, kind == CLI_GRID ? CLI_OF_GRID : 0, cli_input_name(path));
}

static int extract_mesh(cli_run *run, const cli_input *in, bvx_mesh *mesh)
{
    bvx_faces_options *const own = run->own;
    uint64_t set = 0;
    bvx_grid_count(run->context, &in->grid, &set);
    cli_note_voxels(run, &in->grid.lattice, set);
    if (set == 0) return cli_fail(run, "%s: the grid is empty and has no faces", cli_input_name(in->path));
    own->struct_size = sizeof *own;
    cli_stage_begin(run, "faces");
    bvx_status const status = bvx_extract_faces(run->context, &in->grid, own, mesh);
    run->report.mesh[0].milliseconds = cli_stage_end(run) * 1e3;
    CLI_TRY(cli_check_call(run, status, cli_input_name(in->path)));
    return cli_check_mesh(run, mesh, 0, run->options->output, "check");
}

typedef struct faces_job {
    cli_input in;
    bvx_mesh mesh;
} faces_job;

static int make_faces(cli_run *run, void *work, cli_made *made)
{
    faces_job *const job = work;
    made->mesh = &job->mesh;
    CLI_TRY(check_faces_options(run));
    CLI_TRY(cli_open_output(run, run->options->output));
    CLI_TRY(cli_read_input(run, run->options->input[0], &job->in));
    if (job->in.kind == CLI_MESH) CLI_TRY(cli_fill_input(run, &job->in));
    return extract_mesh(run, &job->in, &job->mesh);
}

static void tell_faces(const cli_run *run, const void *work, cli_made *made)
{
    const bvx_faces_options *const own = run->own;
    const bvx_certificate *const c = &run->report.mesh[0].certificate;
    /* Two triangles a face: their count says how many faces or rectangles there are. */
    (void)work;
    cli_tell(made, "  voxels      %" PRIu64 " set\n  %s  %" PRIu64 "\n", run->report.set,
             own->merged ? "rectangles" : "faces     ", c->triangles / 2);
    cli_tell(made, "  triangles   %" PRIu64 " of %" PRIu64 " vertices\n  volume      %.9g\n", c->triangles,
             c->vertices, c->volume);
}

static const cli_owned faces_owns[] = {CLI_OWNS(MESH, faces_job, mesh), CLI_OWNS(INPUT, faces_job, in), {0}};

const cli_command cli_faces = {
    .name = "faces",
    .bit = CLI_FACES,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "IN -o OUT [options]",
    .does = "the sides of voxels as a mesh",
    .details =
        "Reads a grid (" CLI_GRIDS "), or a mesh (" CLI_MESHES_READ ", also .gz)\n"
        "that it voxelizes first, and writes each side between a set voxel and an empty one as two triangles "
        "(.ply\n"
        ".obj .stl .off .glb). The mesh is closed and has the voxels' volume; 'bitvox lod' makes smoother "
        "ones.\n"
        "With --merge there are far fewer triangles, which cover the same but whose edges do not pair up.",
    .example = "bitvox faces fixtures/knot.ply -o blocks.ply --resolution 48 --merge",
    .most = "--resolution --spacing --fill --level --range --label --merge --keep-largest "
            "--format --threads --memory-limit --json",
    .rows = faces_rows,
    .own = sizeof(bvx_faces_options),
    .job = {.size = sizeof(faces_job), .make = make_faces, .tell = tell_faces, .owns = faces_owns}};
