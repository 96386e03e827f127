/* cmd_lod.c - bitvox lod: a chain of closed meshes, with a table of what each level costs and how near it
 * stays.
 *
 * The solid is made once (lod_input.c); each level is one call of bvx_build_lods, timed only. Everything is
 * written at the end, so a failure leaves no part of a chain. A level that keeps nothing, or cannot have so few
 * triangles, is warned of and has no file; only where that is so of all levels is it a failure. */
#include "cli_commands/lod_chain.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define OWN(name) CLI_OWN(cli_lod_options, name)

enum { METHOD_OF = 1 }; /* 0: not given */

static const char *const method_names[] = {BVX_LOD_LIST(CLI_NAME_OF) "collapse", NULL};

static const cli_argument lod_rows[] = {
    {.also = cli_takes_output},
    {.also = cli_takes_output_dir},
    LIST("--resolution", "N", SHARED(resolution), 1, LARGEST_SIDE, 1, 1,
         "voxels along the longest axis, of --solid or for --levels [collapse: as the\n"
         "finest level needs; else 8 x the finest level, less where memory is short]"),
    {.also = cli_takes_padding},
    LIST("--triangles", "A,B,C", SHARED(triangles), 1, 4294967295.0, 1, CLI_MAX_LEVELS,
         "maximum number of triangles of each level; one of which samples keep\n"
         "nothing is left out with a warning"),
    {.also = cli_takes_errors},
    WHOLE("--count", "N", SHARED(count), 1, CLI_MAX_LEVELS,
          "levels of 1/2, 1/4, 1/8 ... of the triangles [4, or as many as leave\n"
          "20 triangles]"),
    {.also = cli_takes_collapse},
    FLAG("--solid", OWN(levels.solid),
         "levels of the surface that repair measures: closed, manifold, oriented,\n"
         "without crossings; so with --resolution, --sign, --sharp, --no-sharp,\n"
         "--shell, --outer-hull, --least-part, --keep-largest, --least-cavity"),
    FLAG("--sharp", SHARED(sharp), "of a solid: put vertices on sharp edges and corners"),
    FLAG("--no-sharp", SHARED(no_sharp),
         "do not put vertices there [where many of the mesh's edges are sharp]"),
    FLAG("--outer-hull", OWN(outer_hull), "inner shells and cavities are dropped"),
    CHOICE("--method", "NAME", OWN(method), method_names, METHOD_OF,
           "collapse: edges of the mesh, or of a grid's surface, collapse; edge-ratio,\n"
           "coverage: samples of a solid [collapse; edge-ratio for grids and volumes\n"
           "without --triangles and --error, and with --levels, --threshold,\n"
           "--edge-samples, --collapse, --fill, --close-gaps, --padding]"),
    LIST("--levels", "A,B,C", OWN(resolutions), 1, LARGEST_SIDE, 1, CLI_MAX_LEVELS,
         "edge-ratio, coverage: samples along the longest axis of each level; one\n"
         "that keeps nothing of the solid is left out with a warning [64,32,16]"),
    BETWEEN("--threshold", "T", OWN(samples.sampling.threshold), 0, 1,
            "a sample above it is inside, 0 < T < 1 [0.5]"),
    WHOLE("--edge-samples", "N", OWN(samples.sampling.edge_samples), 1, 65536,
          "steps along an edge, with --method edge-ratio [the ratio, rounded up]"),
    FROM_TO("--collapse", "F", OWN(samples.collapse), 1, 64,
            "edge-ratio, coverage with --triangles: make up to F times as many, then\n"
            "collapse the cheapest edges; 2 to 4 comes much nearer to the mesh [off]"),
    {.also = cli_takes_fill_of_solids},
    {.also = cli_takes_volumes},
    {.also = cli_takes_sign},
    {.also = cli_takes_shells},
    {.also = cli_takes_normals},
    {.also = cli_takes_file_of_a_mesh},
    {.also = cli_takes_carry},
    {.also = cli_takes_samples},
    {.also = cli_takes_keep_largest},
    {.also = cli_takes_all},
    {0}};

/* ---- what is requested ---- */

/* Options of the methods that sample a solid, and of the one that collapses edges. */
#define OF_SOLID "--levels --threshold --edge-samples --collapse --fill --close-gaps --padding"
#define OF_COLLAPSE                                                                            \
    "--error --error-kind --count --strict --even --attributes --lock-border --keep-vertices " \
    "--topology --solid --sharp --no-sharp --outer-hull --least-cavity --shell --sign"

enum {
    COLLAPSES = 1 << CLI_FIRST_FACT,
    COVERS = 2 << CLI_FIRST_FACT /* --method coverage */
};

static const cli_rule method_rules[] = {
    {.when = COLLAPSES | CLI_OF_GRID,
     .given = "--resolution --solid --sharp --no-sharp --outer-hull --least-cavity --shell --sign",
     .message = "%o measures a mesh; %i is a grid, whose surface is closed and manifold"},
    {.when = COLLAPSES,
     .given = OF_SOLID,
     .message = "%o is for --method edge-ratio and coverage; collapse takes --triangles, --error or --count"},
    {.unless = COLLAPSES,
     .given = OF_COLLAPSE,
     .beside = OF_SOLID,
     .message = "%o is for --method collapse, and %b for edge-ratio and coverage; leave one of them out"},
    /* Of a grid's parts it says which stay; of a mesh it is for the measured surface. */
    {.unless = COLLAPSES | CLI_OF_GRID,
     .given = "--least-part --keep-largest",
     .beside = OF_SOLID,
     .message = "%o is for --method collapse, and %b for edge-ratio and coverage; leave one of them out"},
    {.unless = COLLAPSES | CLI_OF_GRID,
     .given = "--least-part --keep-largest",
     .message = "%o is for --method collapse, or for grids and volumes"},
    {.when = COVERS, .given = OF_COLLAPSE, .message = "%o is for --method collapse, not for coverage"},
    {.unless = COLLAPSES, .given = OF_COLLAPSE, .message = "%o is for --method collapse, not for edge-ratio"},
    {0}};

static const cli_rule solid_rules[] = {
    {.also = cli_to_mesh_rules},
    {.when = CLI_OF_GRID, .also = cli_grid_rules},
    {.also = cli_fill_rules},
    {.also = cli_mesh_file_rules},
    {.given = "--levels", .beside = "--triangles", .message = "%o and %b exclude each other"},
    {.when = COVERS, .given = "--edge-samples", .message = "%o needs --method edge-ratio"},
    {.given = "--collapse", .lacking = "--triangles", .message = "%o needs --triangles"},
    {0}};

static uint32_t facts_of_method(const cli_run *run, int kind, int collapses)
{
    const cli_lod_options *const own = run->own;
    return (kind == CLI_GRID ? CLI_OF_GRID : 0u) | (collapses ? COLLAPSES : 0u) |
           (own->method == METHOD_OF + BVX_LOD_COVERAGE ? COVERS : 0u);
}

/* ---- the levels ---- */

/* Samples coarser than what they see break it. The solid's walls are reported with the solid. */
static void warn_of_broken_level(const cli_run *run, const cli_chain *c, int i, cli_made *made)
{
    const bvx_certificate *const level = &run->report.mesh[i].certificate;
    int const number = run->report.mesh[i].number;
    double const volume = c->solid_report.volume, off = level->volume - volume;

    if (run->report.mesh[i].rate > 1.0)
        cli_advise(made, BVX_WARN_UNMET,
                   "level %d has more triangles than the input: %" PRIu64 " beside %" PRIu64, number,
                   c->mesh[i].triangle_count, c->input_triangles);
    if (c->kind != CLI_MESH) return;
    if (level->components > c->certificate.components)
        cli_advise(made, BVX_WARN_PARTS,
                   "level %d has %" PRIu64 " parts, the mesh %" PRIu64
                   ": what is thinner than its samples broke; take more samples, or "
                   "--method collapse",
                   number, level->components, c->certificate.components);
    else if (off > 0.05 * volume || -off > 0.05 * volume)
        cli_advise(
            made, BVX_WARN_VOLUME,
            "level %d has a volume of %.6g, the solid of %.6g: take more samples, or --method collapse",
            number, level->volume, volume);
}

/* A level that cannot be takes no other with it: its file is left out, and whoever asked is told. */
static int leave_out(cli_run *run, cli_chain *c, bvx_status status, int number, cli_made *made)
{
    const char *const advice = status == BVX_ERR_EMPTY ? ""
                                                       : "; take more triangles for it, or --method collapse";
    int const i = c->count, others = c->asked - 1 - number;
    char *const path = c->path[i];
    int const own_file = cli_has_number(run->options->output);

    if (i == 0 && others == 0)
        return cli_fail_advised(
            run, status, NULL,
            status == BVX_ERR_EMPTY && number != 0 ? "; no level before it keeps anything either" : advice);
    cli_advise(made, BVX_WARN_UNMET, "%s%s; %s%s", bvx_last_error(run->context)->text, advice, path,
               own_file ? " is not written" : " is written without it");
    if (own_file) {
        cli_forget_output(run, i);
        free(path);
    }
    memmove(&c->path[i], &c->path[i + 1], (size_t)others * sizeof c->path[0]);
    return CLI_DONE;
}

static int make_level(cli_run *run, cli_chain *c, int number, cli_made *made)
{
    int const i = c->count;
    cli_mesh_entry *const entry = &run->report.mesh[i];
    char stage[32];

    cli_stage_begin(run, "level %d", number);

    const cli_lod_options *const own = run->own;
    int32_t const resolution = c->by_triangles ? 0 : cli_level_resolution(run, c, number);
    uint64_t const target = c->by_triangles ? (uint64_t)run->options->triangles.value[number] : 0;
    bvx_lod_options l = own->samples;
    l.struct_size = sizeof l;
    if (own->method != 0) l.sampling.method = own->method - METHOD_OF;
    if (c->by_triangles) l.target_triangles = &target;
    else l.resolutions = &resolution;
    l.reports = &c->lod[c->count];
    /* One level a call, each a stage of its own; messages name it by its own number. */
    l.first_level = number;
    bvx_status const status = bvx_build_lods(run->context, &c->solid, &l, 1, &c->mesh[c->count]);

    entry->milliseconds = cli_stage_end(run) * 1e3;
    /* Why a level is not there: it keeps nothing, or its target is below what any resolution gives. */
    if (status == BVX_ERR_EMPTY ||
        (status == BVX_ERR_RANGE && bvx_last_error(run->context)->reason == BVX_REASON_TARGET))
        return leave_out(run, c, status, number, made);
    if (status != BVX_OK) {
        char about[32];
        snprintf(about, sizeof about, "level %d", number);
        return cli_fail_status(run, status, bvx_last_error(run->context)->index == number ? NULL : about);
    }
    snprintf(stage, sizeof stage, "carry %d", number);
    CLI_TRY(cli_carry(run, &c->input, &c->mesh[i], stage, c->path[i]));
    entry->number = number;
    entry->colours = c->mesh[i].colours != NULL;
    entry->uvs = c->mesh[i].uvs != NULL;
    snprintf(stage, sizeof stage, "check %d", number);
    CLI_TRY(cli_check_mesh(run, &c->mesh[i], i, c->path[i], stage));
    entry->lod = &c->lod[i];
    entry->rate = (double)c->mesh[i].triangle_count / (double)c->input_triangles;
    c->count++;
    return CLI_DONE;
}

/* ---- the table ---- */

static void tell_chain_head(const cli_run *run, const cli_chain *c, cli_made *made)
{
    const bvx_lattice *const l = &run->report.lattice;

    if (c->kind == CLI_GRID) {
        const int32_t *const n = c->solid.size;
        cli_tell(made,
                 "%s: %" PRId32 " x %" PRId32 " x %" PRId32 " voxels, %" PRIu64
                 " set; their surface has %" PRIu64 " triangles; diagonal %.6g\n\n",
                 cli_first_name(run), n[0], n[1], n[2], run->report.set, c->input_triangles, c->diagonal);
        return;
    }
    cli_tell_input(run, c->input.triangle_count, &c->certificate, c->diagonal, made);
    cli_tell(made,
             "solid: %" PRId32 " x %" PRId32 " x %" PRId32 " voxels (resolution %" PRId32 ", %s), %" PRIu64
             " set by %s, %.1f ms\n\n",
             l->dims[0], l->dims[1], l->dims[2], c->resolution, c->chosen, run->report.set,
             cli_fill_names[c->solid_report.fill], c->solid_seconds * 1e3);
    cli_report_solid(run, &made->members, l, &c->solid_report);
}

static int write_chain(cli_run *run, void *work)
{
    const cli_chain *const c = work;
    run->source = &c->input;
    return cli_write_levels(run, c->mesh, c->count, c->path);
}

static int make_chain(cli_run *run, void *work, cli_made *made)
{
    const cli_lod_options *const own = run->own;
    const cli_options *const o = run->options;
    cli_chain *const c = work;

    made->untitled = 1;
    made->write = write_chain;
    CLI_TRY(cli_input_kind(run, o->input[0], &c->kind));
    CLI_TRY(cli_check_rules(run, solid_rules, facts_of_method(run, c->kind, 0), cli_first_name(run)));
    c->by_triangles = o->triangles.count != 0;
    c->asked = c->by_triangles               ? o->triangles.count
               : own->resolutions.count != 0 ? own->resolutions.count
                                             : 3;
    CLI_TRY(cli_check_level_names(run, c->asked));
    /* A level has no more samples than the solid has voxels to sample. */
    for (int i = 0; i < own->resolutions.count && o->resolution.count != 0; i++)
        if (own->resolutions.value[i] > o->resolution.value[0])
            return cli_usage(run,
                             "--resolution %" PRId64 " is below level %" PRId64
                             "; it must be at least the finest level",
                             o->resolution.value[0], own->resolutions.value[i]);
    /* Known before the first stage, so that the bar knows how many rounds follow. */
    run->progress.rounds = c->asked;
    CLI_TRY(cli_open_levels(run, c->asked, c->path));
    CLI_TRY(cli_open_chain(run, c));
    for (int i = 0; i < c->asked; i++) CLI_TRY(make_level(run, c, i, made));

    uint64_t const samples = cli_samples(run);
    for (int i = 0; i < c->count && samples != 0; i++) {
        bvx_mesh_view const view = cli_view(&c->mesh[i]);
        cli_stage_begin(run, "distance %d", run->report.mesh[i].number);
        CLI_TRY(cli_stage_check(
            run, bvx_mesh_distance(run->context, &view, &c->view, samples, CLI_SEED, &c->distance[i]),
            c->path[i]));
        /* The report has a pointer to it, which the job keeps until the report is written. */
        run->report.mesh[i].distance = &c->distance[i];
    }
    return CLI_DONE;
}

static void tell_chain(const cli_run *run, const void *work, cli_made *made)
{
    const cli_chain *const c = work;
    int const grid = c->kind == CLI_GRID;
    for (int i = 0; i < c->count; i++) warn_of_broken_level(run, c, i, made);
    tell_chain_head(run, c, made);
    cli_tell(made,
             "level  resolution      ratio  triangles  simplification rate        ms  closed, manifold, "
             "oriented\n");
    for (int i = 0; i < c->count; i++) {
        const bvx_lod_report *const l = &c->lod[i];
        const cli_mesh_entry *const m = &run->report.mesh[i];
        char size[48];
        snprintf(size, sizeof size, "%" PRId32 "x%" PRId32 "x%" PRId32, l->resolution[0], l->resolution[1],
                 l->resolution[2]);
        cli_tell(made, "%5d  %-14s %6.2f %10" PRIu64 " %19.2f%% %9.2f  %s\n", m->number, size, l->ratio[0],
                 m->certificate.triangles, m->rate * 100.0, m->milliseconds,
                 cli_is_sound(&m->certificate) ? "yes" : "NO");
    }

    cli_tell_distances(run, c->count, c->diagonal, 3, grid ? "to the voxels' surface, " : "",
                       grid ? "grid" : "mesh", made);
    cli_tell_written(run, c->count, made);
}

static const cli_owned chain_owns[] = {CLI_OWNS_ALL(MESH, cli_chain, mesh),
                                       CLI_OWNS(GRID, cli_chain, solid),
                                       CLI_OWNS(MESH, cli_chain, input),
                                       {0}};

static const cli_job chain_job = {
    .size = sizeof(cli_chain), .make = make_chain, .tell = tell_chain, .owns = chain_owns};

static int choose_lod(cli_run *run, const cli_job **job)
{
    const cli_lod_options *const own = run->own;
    int kind, collapses;
    CLI_TRY(cli_input_kind(run, run->options->input[0], &kind));
    /* A mesh collapses unless something asks for samples of a solid, a grid's surface where a target says so. */
    collapses = own->method == CLI_METHOD_COLLAPSE ||
                (own->method == 0 && cli_given_of(run, OF_SOLID) == NULL &&
                 (kind == CLI_MESH || cli_given_of(run, "--triangles --error") != NULL));
    *job = collapses ? &cli_lod_collapse : &chain_job;
    return cli_check_rules(run, method_rules, facts_of_method(run, kind, collapses), NULL);
}

const cli_command cli_lod = {
    .name = "lod",
    .bit = CLI_LOD,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "IN -o OUT_%d.EXT [options]",
    .does = "a chain of meshes of several sizes from one mesh, grid or volume",
    .details =
        "Reads any mesh (" CLI_MESHES_READ ", also with .gz) and writes meshes of 1/2, 1/4 ...\n"
        "of its triangles, of --triangles, or as few as --error allows (" CLI_MESHES_WRITTEN "; %d becomes\n"
        "0, 1, 2 ...), with a table of size, soundness and distance. Edges of the mesh as it is collapse: its\n"
        "parts, holes, borders and sides stay, and no level has a new fault. Texture coordinates, normals,\n"
        "colours and materials follow, and their seams and borders stay. --solid makes closed, manifold levels\n"
        "that cross nowhere of whatever goes in. A target below what keeps a level free of new faults gives the\n"
        "smallest level that is, marked NOT MET.\n"
        "Of grids (" CLI_GRIDS "), and volumes with --level, --range or --label,\n"
        "the surface collapses to --triangles or --error. Without these, and meshes with --levels, are sampled:\n"
        "--method edge-ratio or coverage.\n"
        "One .glb without %d holds all levels. glTF has no living extension for levels: they are nodes, and the\n"
        "vendor's MSFT_lod, which few readers use, says that they are one thing; other readers show the finest.",
    .example = "bitvox lod fixtures/knot.ply -o knot_%d.ply --triangles 9600,2400,600\n"
               "bitvox lod fixtures/knot.ply -o knot.glb --error 0.02%,0.1%,0.5%\n"
               "bitvox lod fixtures/knot.ply -o knot_%d.ply --levels 64,32,16\n"
               "bitvox lod fixtures/knot.ply fixtures/terrain.ply --output-dir levels --count 2\n"
               "bitvox lod fixtures/waves.nhdr -o waves_%d.ply --level 120 --levels 24,12",
    .most = "--output-dir --resolution --triangles --error --count --strict --solid --method "
            "--level --threads --memory-limit --json",
    .rows = lod_rows,
    .own = sizeof(cli_lod_options),
    .choose = choose_lod};
