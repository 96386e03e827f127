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

static int extract_mesh(cli_run *run, const cli_input *in, const bvx_grid *of, int number, bvx_mesh *mesh)
{
    bvx_faces_options *const own = run->own;
    own->struct_size = sizeof *own;
    own->of = of;
    cli_stage_begin(run, "faces");
    bvx_status const status = bvx_extract_faces(run->context, &in->grid, own, mesh);
    run->report.mesh[number].milliseconds = cli_stage_end(run) * 1e3;
    CLI_TRY(cli_check_call(run, status, cli_input_name(in->path)));
    return cli_check_mesh(run, mesh, number, run->options->output, "check");
}

enum { COLOURS = 256, COLOUR_ROOM = 8 };

/* Of voxels with colours a mesh for each of those that is to be seen. */
typedef struct faces_job {
    cli_input in;
    bvx_grid of; /* the voxels of one colour */
    bvx_mesh mesh[COLOURS];
    int count;
    char name[COLOURS][COLOUR_ROOM]; /* #rrggbb */
    const char *names[COLOURS];
    uint8_t colours[COLOURS * 4];
} faces_job;

static int write_colours(cli_run *run, void *work)
{
    faces_job *const j = work;
    char *const out = (char *)(uintptr_t)run->options->output, *const path[2] = {out, out};
    run->names = j->names;
    run->colours = j->colours;
    return cli_write_levels(run, j->mesh, j->count, path);
}

static int make_faces(cli_run *run, void *work, cli_made *made)
{
    faces_job *const job = work;
    uint64_t set = 0;

    made->mesh = job->mesh;
    CLI_TRY(check_faces_options(run));
    CLI_TRY(cli_open_output(run, run->options->output));
    CLI_TRY(cli_read_input(run, run->options->input[0], &job->in));
    if (job->in.kind == CLI_MESH) CLI_TRY(cli_fill_input(run, &job->in));
    bvx_grid_count(run->context, &job->in.grid, &set);
    cli_note_voxels(run, &job->in.grid.lattice, set);
    if (set == 0)
        return cli_fail(run, "%s: the grid is empty and has no faces", cli_input_name(job->in.path));
    if (job->in.labels.bytes == NULL) return extract_mesh(run, &job->in, NULL, 0, job->mesh);
    made->write = write_colours;

    /* One mesh a colour. A colour that lies inside everywhere has no face. */
    const bvx_grid *const g = &job->in.grid;
    bvx_volume_view const labels = {.samples = job->in.labels.bytes,
                                    .sample_type = BVX_SAMPLE_U8,
                                    .low = {g->low[0], g->low[1], g->low[2]},
                                    .size = {g->size[0], g->size[1], g->size[2]},
                                    .lattice = g->lattice};

    for (int i = 1; i < COLOURS; i++) {
        const uint8_t *const colour = job->in.palette + 4 * i;
        bvx_volume_report found;

        CLI_TRY(cli_check_call(run, bvx_threshold_whole(run->context, &labels, i, i, &found, &job->of),
                               cli_input_name(job->in.path)));
        if (found.inside == 0) continue;
        CLI_TRY(extract_mesh(run, &job->in, &job->of, job->count, &job->mesh[job->count]));
        if (job->mesh[job->count].triangle_count == 0) continue;
        memcpy(job->colours + 4 * job->count, colour, 4);
        snprintf(job->name[job->count], COLOUR_ROOM, "#%02x%02x%02x", colour[0], colour[1], colour[2]);
        job->names[job->count] = job->name[job->count];
        job->count++;
    }
    return CLI_DONE;
}

static void tell_faces(const cli_run *run, const void *work, cli_made *made)
{
    const bvx_faces_options *const own = run->own;
    const faces_job *const job = work;
    bvx_certificate sum = run->report.mesh[0].certificate, *const c = &sum;

    for (int i = 1; i < job->count; i++) {
        const bvx_certificate *const more = &run->report.mesh[i].certificate;
        sum.triangles += more->triangles;
        sum.vertices += more->vertices;
    }
    /* Two triangles a face: their count says how many faces or rectangles there are. */
    cli_tell(made, "  voxels      %" PRIu64 " set\n  %s  %" PRIu64 "\n", run->report.set,
             own->merged ? "rectangles" : "faces     ", c->triangles / 2);
    cli_tell(made, "  triangles   %" PRIu64 " of %" PRIu64 " vertices\n", c->triangles, c->vertices);
    if (job->count == 0) cli_tell(made, "  volume      %.9g\n", c->volume);
    else cli_tell(made, "  colours     %d\n", job->count);
}

static void free_faces(cli_run *run, void *work)
{
    faces_job *const job = work;
    for (int i = 0; i < COLOURS; i++) bvx_mesh_free(run->context, &job->mesh[i]);
}

static const cli_owned faces_owns[] = {CLI_OWNS(GRID, faces_job, of), CLI_OWNS(INPUT, faces_job, in), {0}};

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
        "ones.\nOf a .vox with colours a .glb has a node and a material for each.\n"
        "With --merge there are far fewer triangles, which cover the same but whose edges do not pair up.",
    .example = "bitvox faces fixtures/knot.ply -o blocks.ply --resolution 48 --merge",
    .most = "--resolution --spacing --fill --level --range --label --merge --keep-largest "
            "--format --threads --memory-limit --json",
    .rows = faces_rows,
    .own = sizeof(bvx_faces_options),
    .job = {.size = sizeof(faces_job),
            .make = make_faces,
            .tell = tell_faces,
            .owns = faces_owns,
            .free = free_faces}};
