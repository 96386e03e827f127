/* cmd_faces.c - bitvox faces: the voxels themselves as a mesh, for programs that show meshes only. */
#include "cli_commands/commands.h"

#include <inttypes.h>
#include <string.h>

static int check_faces_options(cli_run *run)
{
    static const cli_rule rules[] = {{.also = cli_to_mesh_rules},
                                     {.when = CLI_OF_GRID, .also = cli_grid_rules},
                                     {.also = cli_lattice_rules},
                                     {.also = cli_fill_rules},
                                     {0}};
    const char *const path = run->options->input[0];
    int kind, status = cli_input_kind(run, path, &kind);

    return status == CLI_DONE
               ? cli_check_rules(run, rules, kind == CLI_GRID ? CLI_OF_GRID : 0, cli_input_name(path))
               : status;
}

static bvx_status extract(cli_run *run, const bvx_grid *grid, bvx_mesh *mesh)
{
    bvx_faces_options f;
    bvx_faces_options_init(&f, sizeof f);
    f.position_type = BVX_POSITION_AUTO;
    f.merged = run->options->merge;
    return bvx_extract_faces(run->context, grid, &f, mesh);
}

static int make_faces(cli_run *run, const cli_input *in, bvx_mesh *mesh)
{
    cli_mesh_entry *const entry = &run->report.mesh[0];
    bvx_mesh_view view;
    bvx_status status;

    bvx_grid_count(run->context, &in->grid, &run->report.set);
    run->report.lattice = in->grid.lattice;
    run->report.has_lattice = run->report.has_set = 1;
    if (run->report.set == 0)
        return cli_fail(run, "%s: no voxel is set; there are no faces", cli_input_name(in->path));
    cli_stage_begin(run, "faces");
    status = extract(run, &in->grid, mesh);
    entry->milliseconds = cli_stage_end(run) * 1e3;
    if (status != BVX_OK) return cli_fail_status(run, status, cli_input_name(in->path));
    cli_stage_begin(run, "check");
    bvx_mesh_view_of(mesh, &view);
    status = bvx_mesh_check(run->context, &view, 0, &entry->certificate);
    cli_stage_end(run);
    if (status != BVX_OK) return cli_fail_status(run, status, run->options->output);
    entry->path = run->options->output;
    run->report.meshes = 1;
    return CLI_DONE;
}

static void say_faces(cli_run *run, const cli_input *in)
{
    const bvx_certificate *const c = &run->report.mesh[0].certificate;
    cli_say(run, "%s -> %s\n", cli_input_name(in->path), run->options->output);
    cli_say(run, "  voxels      %" PRIu64 " set\n  %s  %" PRIu64 "\n", run->report.set,
            run->options->merge ? "rectangles" : "faces     ", c->triangles / 2);
    cli_say(run, "  triangles   %" PRIu64 " of %" PRIu64 " vertices\n  volume      %.9g\n", c->triangles,
            c->vertices, c->volume);
}

static int run_faces(cli_run *run)
{
    cli_input in;
    bvx_mesh mesh = {0};
    int status = check_faces_options(run);

    memset(&in, 0, sizeof in);
    if (status == CLI_DONE) status = cli_open_output(run, run->options->output);
    if (status == CLI_DONE) status = cli_read_input(run, run->options->input[0], &in);
    if (status == CLI_DONE && in.kind == CLI_MESH) status = cli_fill_input(run, &in);
    if (status == CLI_DONE) status = make_faces(run, &in, &mesh);
    if (status == CLI_DONE) status = cli_write_mesh(run, &mesh);
    if (status == CLI_DONE) say_faces(run, &in);
    bvx_mesh_free(run->context, &mesh);
    cli_free_input(run, &in);
    return status;
}

const cli_command cli_faces = {
    "faces",
    CLI_FACES,
    1,
    1,
    "IN -o OUT [options]",
    "the sides of voxels as a mesh",
    "Reads a grid (" CLI_GRIDS "), or a mesh (" CLI_MESHES_READ ", also with .gz) that\n"
    "it voxelizes first, and writes each side between a set voxel and an empty one as two triangles (.ply\n"
    ".obj .stl .off .glb). The mesh is closed and has the voxels' volume; 'bitvox lod' makes smoother ones.\n"
    "With --merge there are far fewer triangles, which cover the same but whose edges do not pair up.",
    "bitvox faces fixtures/knot.ply -o blocks.ply --resolution 48 --merge",
    run_faces};
