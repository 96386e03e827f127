/* cmd_fill.c - bitvox fill: what lies inside a surface of voxels, from seeds that are given or found. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct fill_options {
    cli_list seeds;   /* three numbers each */
    const char *mesh; /* the file that the surface came from */
} fill_options;

#define OWN(name) CLI_OWN(fill_options, name)

static const cli_argument fill_rows[] = {
    {.also = cli_takes_output},
    {.also = cli_takes_add_shell},
    {.also = cli_takes_reduction},
    {.also = cli_takes_file_of_a_mesh},
    LIST("--seed", "X,Y,Z", OWN(seeds), 0, LARGEST_SIDE, 3, 63,
         "empty voxels to fill from, counted from the grid's first one, three\n"
         "numbers each [one in every pocket]"),
    FILE_NAME("--mesh", "MESH", OWN(mesh),
              "the mesh that the surface came from: pockets outside of it stay empty"),
    {.also = cli_takes_connectivity},
    {.also = cli_takes_all},
    {0}};

enum { FILL_SEEDS = 1024, FILL_SEEDS_SAID = 8 };

typedef struct fill_job {
    cli_input in;
    bvx_mesh mesh;
    bvx_mesh_view view;
    bvx_seed search; /* the search for one seed, where none was given */
    int32_t *seeds;  /* three numbers each */
    uint64_t count;
    int given;        /* by --seed */
    uint64_t filled;  /* voxels */
    int reaches_side; /* of the window */
    bvx_grid out;
    cli_voxels voxels; /* the output */
} fill_job;

static int check_fill_options(cli_run *run, int *kind)
{
    const fill_options *const own = run->own;
    const cli_options *const o = run->options;
    const char *const path = cli_first_name(run);
    int mesh, status = cli_input_kind(run, o->input[0], kind);

    if (status != CLI_DONE) return status;
    if (*kind == CLI_MESH)
        return cli_usage(
            run,
            "%s is a mesh; 'bitvox voxelize --mode conservative' makes its surface, or a --fill its solid",
            path);
    if (own->seeds.count % 3 != 0)
        return cli_usage(run, "--seed takes three numbers a seed, like 8,8,8 or 8,8,8,40,40,40");
    if (own->mesh != NULL && own->seeds.count != 0)
        return cli_usage(run, "--mesh says which pockets lie inside; it has no use with --seed");
    if (own->mesh != NULL) CLI_TRY(cli_input_kind(run, own->mesh, &mesh));
    if (own->mesh != NULL && mesh != CLI_MESH)
        return cli_usage(run, "--mesh takes a mesh; %s is a grid", own->mesh);
    return cli_check_voxel_name(run);
}

static int make_room_for_seeds(cli_run *run, fill_job *job, uint64_t count)
{
    free(job->seeds);
    job->seeds = count < SIZE_MAX / 12 ? malloc((size_t)count * 12 + 1) : NULL;
    return job->seeds != NULL ? CLI_DONE : cli_fail(run, "no memory for %" PRIu64 " seeds", count);
}

static int find_seeds(cli_run *run, fill_job *job)
{
    const fill_options *const own = run->own;
    const bvx_mesh_view *const mesh = own->mesh != NULL ? &job->view : NULL;
    const char *const path = cli_input_name(job->in.path);
    uint64_t room = FILL_SEEDS;

    CLI_TRY(make_room_for_seeds(run, job, room));
    cli_stage_begin(run, "seeds");
    bvx_status status = bvx_find_seed(run->context, &job->in.grid, mesh, 0, &job->search);
    if (status == BVX_OK)
        status = bvx_find_pockets(run->context, &job->in.grid, mesh, job->seeds, room, &job->count);
    if (status == BVX_ERR_CAPACITY) {
        room = job->count;
        CLI_TRY(make_room_for_seeds(run, job, room));
        status = bvx_find_pockets(run->context, &job->in.grid, mesh, job->seeds, room, &job->count);
    }
    CLI_TRY(cli_stage_check(run, status, path));
    if (job->count != 0) return CLI_DONE;
    return cli_fail(
        run,
        "%s: these voxels enclose no pocket: they are empty, or have gaps (thin and conservative surfaces "
        "of closed "
        "meshes have none); --seed fills from where it says",
        path);
}

static void add_voxel(cli_text *t, const int32_t v[3])
{
    cli_text_add(t, "[%" PRId32 ", %" PRId32 ", %" PRId32 "]", v[0], v[1], v[2]);
}

static void tell_fill(const cli_run *run, const void *work, cli_made *made)
{
    const fill_job *const job = work;
    const bvx_seed *const s = &job->search;
    cli_text *const t = &made->members;

    (void)run;
    cli_tell(made, "  %s%" PRIu64 "\n", job->given ? "seeds       " : "pockets     ", job->count);
    for (uint64_t i = 0; i < job->count && i < FILL_SEEDS_SAID; i++)
        cli_tell(made, "              %" PRId32 ",%" PRId32 ",%" PRId32 "\n", job->seeds[3 * i],
                 job->seeds[3 * i + 1], job->seeds[3 * i + 2]);
    if (job->count > FILL_SEEDS_SAID) cli_tell(made, "              and more\n");
    cli_tell(made, "  filled      %" PRIu64 "\n", job->filled);

    cli_text_add(t, ", \"fill\": {\"filled\": %" PRIu64, job->filled);
    cli_json_truth(t, "reaches_side", job->reaches_side);
    cli_json_count(t, job->given ? "given" : "pockets", job->count);
    cli_text_add(t, ", \"seeds\": [");
    for (uint64_t i = 0; i < job->count; i++) {
        if (i != 0) cli_text_add(t, ", ");
        add_voxel(t, job->seeds + 3 * i);
    }
    cli_text_add(t, "]");
    if (!job->given) {
        cli_tell(made, "  search      %s", s->found ? "" : "no seed");
        if (s->found)
            cli_tell(made, "%" PRId32 ",%" PRId32 ",%" PRId32, s->voxel[0], s->voxel[1], s->voxel[2]);
        cli_tell(made, " after %" PRIu64 ", %" PRIu64 ", %" PRIu64 " lines along x, y, z%s\n", s->scans[0],
                 s->scans[1], s->scans[2], s->verified ? ", inside the mesh" : "");
        cli_text_add(t, ", \"search\": {\"voxel\": ");
        if (s->found) add_voxel(t, s->voxel);
        else cli_text_add(t, "null");
        cli_json_truth(t, "verified", s->verified);
        cli_json_count(t, "i", s->scans[0]);
        cli_json_count(t, "j", s->scans[1]);
        cli_json_count(t, "k", s->scans[2]);
        cli_json_count(t, "starts", s->starts);
        cli_json_count(t, "refused", s->refused);
        cli_text_add(t, "}");
    }
    cli_text_add(t, "}");

    if (job->reaches_side)
        cli_advise(made, BVX_WARN_ENDS,
                   "%s: the fill reaches the window's sides: these voxels do not hold it",
                   cli_input_name(job->in.path));
}

static int make_fill(cli_run *run, void *work, cli_made *made)
{
    const fill_options *const own = run->own;
    fill_job *const job = work;
    int kind;

    CLI_TRY(check_fill_options(run, &kind));
    CLI_TRY(cli_open_voxels(run));
    CLI_TRY(cli_read_input(run, run->options->input[0], &job->in));
    if (own->mesh != NULL) CLI_TRY(cli_read_mesh(run, own->mesh, &job->mesh));
    bvx_mesh_view_of(&job->mesh, &job->view);
    job->given = own->seeds.count != 0;
    if (job->given) {
        job->count = (uint64_t)own->seeds.count / 3;
        CLI_TRY(make_room_for_seeds(run, job, job->count));
        for (int i = 0; i < own->seeds.count; i++) job->seeds[i] = (int32_t)own->seeds.value[i];
    } else CLI_TRY(find_seeds(run, job));

    const bvx_grid *const walls = &job->in.grid;
    cli_stage_begin(run, "fill");
    bvx_status status = bvx_grid_fill(run->context, walls, job->seeds, job->count,
                                      cli_neighbours[run->options->connectivity], &job->out);
    if (status == BVX_OK) status = bvx_grid_count(run->context, &job->out, &job->filled);
    CLI_TRY(cli_stage_check(run, status, cli_input_name(job->in.path)));
    /* Before the shell joins, which may lie at a side by itself. */
    job->reaches_side = cli_touches_side(&job->out);
    size_t const words = (size_t)walls->words_per_row * (size_t)walls->size[1] * (size_t)walls->size[2];
    for (size_t i = 0; i < words && run->options->add_shell; i++) job->out.words[i] |= walls->words[i];

    job->voxels.name = job->in.path;
    job->voxels.grid = &job->out;
    made->voxels = &job->voxels;
    made->placed = job->in.placed;
    bvx_grid_count(run->context, &job->out, &made->set);
    return CLI_DONE;
}

static const cli_owned fill_owns[] = {CLI_OWNS(VOXELS, fill_job, voxels), CLI_OWNS(BYTES, fill_job, seeds),
                                      CLI_OWNS(GRID, fill_job, out),      CLI_OWNS(MESH, fill_job, mesh),
                                      CLI_OWNS(INPUT, fill_job, in),      {0}};

const cli_command cli_fill = {
    .name = "fill",
    .bit = CLI_FILL,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "GRID -o OUT [options]",
    .does = "what lies inside a surface of voxels, from seeds",
    .details =
        "Reads a grid (" CLI_GRIDS ") whose set voxels are walls, finds the pockets that they\n"
        "close, or takes the voxels of --seed, and writes all that is connected with these through empty\n"
        "voxels. With --mesh only pockets that lie inside the mesh are filled, so that hollows stay empty.\n"
        "It also reports what a search for one seed took: lines scanned along x, y and z. Where OUT is a "
        "mesh\n"
        "(" CLI_MESHES_WRITTEN ") it is the surface half way between set and empty voxels.",
    .example = "bitvox voxelize fixtures/knot.ply -o shell.bvx --mode thin --resolution 64\n"
               "bitvox fill shell.bvx -o inner.bvx --mesh fixtures/knot.ply",
    .most = "--add-shell --seed --mesh --connectivity --triangles --error --format --threads "
            "--memory-limit --json --quiet",
    .rows = fill_rows,
    .own = sizeof(fill_options),
    .job = {.size = sizeof(fill_job), .make = make_fill, .tell = tell_fill, .owns = fill_owns}};
