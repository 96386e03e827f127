/* cmd_components.c - bitvox components: the connected parts of a grid, told
 * in a table, kept or dropped. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct components_options {
    cli_list seeds;       /* three numbers each */
    int64_t keep_largest; /* so many parts */
    int64_t at_least;     /* voxels */
    int32_t fill_cavities;
} components_options;

#define OWN(name) CLI_OWN(components_options, name)

static const cli_argument components_rows[] = {
    {.also = cli_takes_output},
    {.also = cli_takes_reduction},
    {.also = cli_takes_file_of_a_mesh},
    LIST("--seed", "X,Y,Z", OWN(seeds), 0, LARGEST_SIDE, 3, 63,
         "keep parts that hold one of these voxels, counted from the grid's\n"
         "first one, three numbers each [all]"),
    LONG("--keep-largest", "N", OWN(keep_largest), 1, 1e15,
         "keep so many of the largest parts, of those that remain by other rules [all]"),
    LONG("--at-least", "N", OWN(at_least), 0, 1e15, "keep parts of so many voxels or more [0]"),
    FLAG("--fill-cavities", OWN(fill_cavities), "fill the empty parts that are closed in through faces"),
    {.also = cli_takes_connectivity},
    {.also = cli_takes_all},
    {0}};

enum { PARTS_SAID = 12, PARTS_REPORTED = 1000 };

typedef struct components_job {
    cli_input in;
    int32_t connectivity;
    int32_t *seeds;
    bvx_keep_report kept;
    uint64_t filled;
    bvx_component *parts; /* of what remains; the largest first once they were reported */
    uint64_t count, set;  /* of parts, of voxels */
    bvx_topology topology;
    cli_voxels voxels; /* the output */
} components_job;

/* ---- what is kept ---- */

static int keep_components(cli_run *run, components_job *job)
{
    const components_options *const own = run->own;
    const cli_list *const list = &own->seeds;

    bvx_keep_options k = {.struct_size = sizeof k,
                          .connectivity = job->connectivity,
                          .largest = (uint64_t)own->keep_largest,
                          .at_least = (uint64_t)own->at_least,
                          .report = &job->kept};
    job->seeds = calloc((size_t)list->count + 1, sizeof *job->seeds);
    if (job->seeds == NULL) return cli_fail(run, "no memory for seeds");
    for (int i = 0; i < list->count; i++) job->seeds[i] = (int32_t)list->value[i];
    if (list->count != 0) k.seeds = job->seeds;
    k.seed_count = (uint64_t)list->count / 3;
    cli_stage_begin(run, "keep");
    bvx_status status = bvx_grid_keep(run->context, &job->in.grid, &k, &job->in.grid);
    if (status == BVX_OK && own->fill_cavities)
        status = bvx_grid_fill_cavities(run->context, &job->in.grid, 6, 0, &job->in.grid, &job->filled);
    return cli_stage_check(run, status, cli_input_name(job->in.path));
}

/* ---- what is reported of the rest ---- */

static int by_size(const void *a, const void *b)
{
    const bvx_component *const p = a, *const q = b;
    if (p->voxels != q->voxels) return p->voxels > q->voxels ? -1 : 1;
    return p->first < q->first ? -1 : 1;
}

/* Without memory for the list the parts are counted, and the list is not there. */
static bvx_status look_at_components(cli_run *run, components_job *job)
{
    const bvx_grid *const g = &job->in.grid;

    /* Counted first: how many parts there are cannot be bounded by anything useful. */
    CLI_TRY(bvx_grid_components(run->context, g, job->connectivity, NULL, 0, &job->count));
    if (job->count < SIZE_MAX / sizeof *job->parts)
        job->parts = malloc(((size_t)job->count + 1) * sizeof *job->parts);
    if (job->parts == NULL) return BVX_OK;
    CLI_TRY(bvx_grid_components(run->context, g, job->connectivity, job->parts, job->count, &job->count));
    /* The Euler number is counted for 6 and 26 only. */
    if (job->connectivity != 18)
        CLI_TRY(bvx_grid_topology(run->context, g, job->connectivity, &job->topology));
    return bvx_grid_count(run->context, g, &job->set);
}

static void first_of(const bvx_grid *g, const bvx_component *p, int32_t v[3])
{
    uint64_t const nx = (uint64_t)g->size[0], ny = (uint64_t)g->size[1];
    v[0] = (int32_t)(p->first % nx);
    v[1] = (int32_t)(p->first / nx % ny);
    v[2] = (int32_t)(p->first / nx / ny);
}

static void tell_parts(const cli_run *run, const components_job *job, cli_made *made)
{
    const components_options *const own = run->own;
    const bvx_grid *const g = &job->in.grid;

    if (job->kept.dropped != 0)
        cli_tell(made, "  kept        %" PRIu64 " of %" PRIu64 " parts; %" PRIu64 " voxels went\n",
                 job->kept.kept, job->kept.kept + job->kept.dropped, job->kept.voxels_dropped);
    if (own->fill_cavities) cli_tell(made, "  filled      %" PRIu64 " voxels of cavities\n", job->filled);
    cli_tell(made, "  parts       %" PRIu64 ", connectivity %" PRId32 "\n", job->count, job->connectivity);
    if (job->connectivity != 18)
        cli_tell(made, "  topology    %" PRIu64 " cavities, %" PRId64 " tunnels, Euler number %" PRId64 "\n",
                 job->topology.cavities, job->topology.tunnels, job->topology.euler);
    if (job->count != 0)
        cli_tell(made, "  %8s %14s %9s   %-18s %s\n", "part", "voxels", "share", "first voxel", "box");
    for (uint64_t i = 0; i < job->count && i < PARTS_SAID; i++) {
        const bvx_component *const p = &job->parts[i];
        char first[48];
        int32_t v[3];
        first_of(g, p, v);
        snprintf(first, sizeof first, "%" PRId32 ",%" PRId32 ",%" PRId32, v[0], v[1], v[2]);
        cli_tell(made,
                 "  %8" PRIu64 " %14" PRIu64 " %8.3f%%   %-18s %" PRId32 " x %" PRId32 " x %" PRId32
                 " from %" PRId32 ",%" PRId32 ",%" PRId32 "\n",
                 p->reserved, p->voxels, 100.0 * (double)p->voxels / (double)job->set, first, p->size[0],
                 p->size[1], p->size[2], p->low[0], p->low[1], p->low[2]);
    }
    if (job->count > PARTS_SAID) cli_tell(made, "           and %" PRIu64 " more\n", job->count - PARTS_SAID);
}

static int make_components(cli_run *run, void *work, cli_made *made)
{
    const components_options *const own = run->own;
    components_job *const job = work;
    const char *const output = run->options->output;
    int kind;

    job->connectivity = cli_neighbours[run->options->connectivity];
    CLI_TRY(cli_input_kind(run, run->options->input[0], &kind));
    if (kind == CLI_MESH)
        return cli_usage(run,
                         "%s is a mesh; 'bitvox info' counts its parts, 'bitvox voxelize' makes a grid of it",
                         cli_first_name(run));
    if (own->seeds.count % 3 != 0)
        return cli_usage(run, "--seed takes three numbers a seed, like 8,8,8 or 8,8,8,40,40,40");
    if (output != NULL) CLI_TRY(cli_check_voxel_name(run));
    if (output != NULL) CLI_TRY(cli_open_voxels(run));
    CLI_TRY(cli_read_input(run, run->options->input[0], &job->in));
    /* Refused before parts are looked for, which takes longer. */
    if (output != NULL && !CLI_HOLDS(run, CLI_TO_MESH))
        CLI_TRY(cli_check_grid_format(run, output, &job->in.grid.lattice));
    CLI_TRY(keep_components(run, job));

    /* Numbers are by the first voxel. */
    cli_stage_begin(run, "components");
    bvx_status const status = look_at_components(run, job);
    if (status == BVX_OK && job->parts == NULL)
        return cli_fail(run, "no memory for a list of %" PRIu64 " parts", job->count);
    CLI_TRY(cli_stage_check(run, status, cli_input_name(job->in.path)));
    for (uint64_t i = 0; i < job->count; i++) job->parts[i].reserved = i + 1;
    qsort(job->parts, (size_t)job->count, sizeof *job->parts, by_size);

    job->voxels.name = run->options->input[0];
    job->voxels.grid = made->shown = &job->in.grid;
    if (output != NULL) made->voxels = &job->voxels;
    made->set = job->set;
    made->placed = job->in.placed;
    return CLI_DONE;
}

static void tell_components(const cli_run *run, const void *work, cli_made *made)
{
    const components_job *const job = work;
    cli_text *const t = &made->members;

    tell_parts(run, job, made);
    cli_text_add(t, ", \"components\": {\"connectivity\": %" PRId32, job->connectivity);
    cli_json_count(t, "count", job->count);
    cli_json_count(t, "dropped", job->kept.dropped);
    cli_json_count(t, "voxels_dropped", job->kept.voxels_dropped);
    cli_json_count(t, "filled", job->filled);
    /* Set voxels by 26 go with empty ones by 6, or the other way round; 18 has no such partner. */
    if (job->connectivity != 18) {
        cli_json_count(t, "cavities", job->topology.cavities);
        cli_text_add(t, ", \"tunnels\": %" PRId64 ", \"euler\": %" PRId64, job->topology.tunnels,
                     job->topology.euler);
    }
    cli_text_add(t, ", \"parts\": [");
    /* The largest ones: a noisy grid has millions of parts, and nobody reads a report of them. */
    for (uint64_t i = 0; i < job->count && i < PARTS_REPORTED; i++) {
        const bvx_component *const p = &job->parts[i];
        int32_t v[3];
        first_of(&job->in.grid, p, v);
        cli_text_add(t, "%s{\"number\": %" PRIu64, i != 0 ? ", " : "", p->reserved);
        cli_json_count(t, "voxels", p->voxels);
        cli_json_ints(t, "first", v);
        cli_json_ints(t, "low", p->low);
        cli_json_ints(t, "size", p->size);
        cli_text_add(t, "}");
    }
    cli_text_add(t, "]}");
}

static const cli_owned components_owns[] = {CLI_OWNS(VOXELS, components_job, voxels),
                                            CLI_OWNS(BYTES, components_job, parts),
                                            CLI_OWNS(BYTES, components_job, seeds),
                                            CLI_OWNS(INPUT, components_job, in),
                                            {0}};

const cli_command cli_components = {
    .name = "components",
    .bit = CLI_COMPONENTS,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "GRID [-o OUT] [options]",
    .does = "the connected parts of a grid: listed, kept or dropped",
    .details =
        "Reads a grid (" CLI_GRIDS "), drops the parts that --keep-largest, --at-least and\n"
        "--seed do not keep, fills cavities on request, and reports what remains: the largest parts with\n"
        "their sizes and boxes, cavities, tunnels and the Euler number. Parts are numbered by their first\n"
        "voxel in the order z, y, x. -o writes the grid, or\n"
        "where OUT is a mesh (" CLI_MESHES_WRITTEN ") the surface half way between set and empty voxels.",
    .example = "bitvox voxelize fixtures/knot.ply -o knot.bvx --resolution 64\n"
               "bitvox components knot.bvx -o part.bvx --keep-largest 1 --fill-cavities",
    .most = "--seed --keep-largest --at-least --fill-cavities --connectivity --triangles "
            "--error --format --threads --memory-limit --json",
    .rows = components_rows,
    .own = sizeof(components_options),
    .job = {.size = sizeof(components_job),
            .make = make_components,
            .tell = tell_components,
            .owns = components_owns}};
