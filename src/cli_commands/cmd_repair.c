/* cmd_repair.c - bitvox repair: a closed, manifold, oriented mesh from any. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { REPAIR_SAMPLES = 100000 }; /* of --measure */

typedef struct repair_options {
    bvx_repair_options library;
    int32_t measure;
} repair_options;

#define OWN(name) CLI_OWN(repair_options, name)

static const char *const thin_names[] = {BVX_THIN_LIST(CLI_NAME_OF) NULL};

static const cli_argument repair_rows[] = {
    {.also = cli_takes_output},
    {.also = cli_takes_output_dir},
    LIST("--resolution", "N", SHARED(resolution), 1, 16777216.0, 1, 1, "voxels along the longest axis [256]"),
    {.also = cli_takes_reduction},
    {.also = cli_takes_sign},
    {.also = cli_takes_interpolation},
    {.also = cli_takes_sharp},
    CHOICE("--thin", "WHAT", OWN(library.thin), thin_names, BVX_THIN_KEEP,
           "walls of bodies too thin for the voxels. keep: whole, about as thick as\n"
           "they are; shell: pieces without a voxel become shells, other walls are\n"
           "lost where no centre lies in them, with a warning; drop: lost [keep]"),
    {.also = cli_takes_shells},
    {.also = cli_takes_keep_largest},
    FLAG("--if-needed", OWN(library.if_needed),
         "copy a mesh that needs nothing, with its attributes; to the same format the\n"
         "file itself"),
    FLAG("--measure", OWN(measure), "report distances between input and result"),
    {.also = cli_takes_normals},
    {.also = cli_takes_file_of_a_mesh},
    {.also = cli_takes_carry},
    {.also = cli_takes_all},
    {0}};

static const char *const need_names[] = {"nothing", "lids",       "manifold",  "turns",
                                         "area",    "outside-in", "uncrossing"};

void cli_report_repair(cli_text *t, const bvx_repair_report *r, int measured)
{
    cli_text_add(t, ", \"repair\": {\"sign\": \"%s\"", cli_fill_names[r->sign]);
    cli_json_count(t, "holes", r->holes);
    cli_json_count(t, "boundary_edges", r->before.boundary_edges);
    cli_json_count(t, "flipped_edges", r->before.flipped_edges);
    cli_json_count(t, "turned", r->turned);
    cli_json_count(t, "nonmanifold_edges", r->before.nonmanifold_edges);
    cli_json_count(t, "duplicates", r->before.duplicates);
    cli_json_count(t, "degenerate", r->before.degenerate + r->before.collapsed);
    cli_json_count(t, "components_before", r->before.components);
    cli_json_count(t, "parts_dropped", r->parts_dropped);
    cli_json_count(t, "crumbs", r->crumbs);
    cli_json_count(t, "cavities_dropped", r->cavities_dropped);
    cli_json_count(t, "thin_voxels", r->thin_voxels);
    cli_json_count(t, "thin_resolution", (uint64_t)r->thin_resolution);
    cli_json_truth(t, "thin_kept", r->thin_kept);
    cli_json_count(t, "shelled_triangles", r->shelled_triangles);
    cli_text_add(t, ", \"needs\": \"%s\"", need_names[r->needs]);
    cli_json_truth(t, "copied", r->copied);
    cli_json_truth(t, "sharp", r->sharp);
    cli_json_value(t, "volume_before", r->before.volume);
    cli_json_value(t, "volume_after", r->after.volume);
    if (r->crossing_volume != 0) cli_json_value(t, "crossing_volume", r->crossing_volume);
    if (measured) {
        cli_json_value(t, "mean_input_to_output", r->distance.mean_a_to_b);
        cli_json_value(t, "max_input_to_output", r->distance.max_a_to_b);
        cli_json_value(t, "mean_output_to_input", r->distance.mean_b_to_a);
        cli_json_value(t, "max_output_to_input", r->distance.max_b_to_a);
    }
    cli_text_add(t, "}");
}

static void tell_repaired(const cli_run *run, const bvx_repair_report *r, const cli_reduction *reduction,
                          cli_made *made)
{
    const repair_options *const own = run->own;
    const bvx_lattice *const l = &r->lattice;

    if (!r->copied)
        cli_tell(made, "  lattice     %d x %d x %d, inside by %s%s\n", (int)l->dims[0], (int)l->dims[1],
                 (int)l->dims[2], cli_fill_names[r->sign], r->sharp ? ", sharp edges kept" : "");
    if (r->shelled_triangles != 0)
        cli_tell(made, "  shells      %" PRIu64 " triangles enclose nothing and became shells\n",
                 r->shelled_triangles);
    if (r->crumbs != 0)
        cli_tell(made, "  crumbs      %" PRIu64 " small parts and pockets that are not in the mesh\n",
                 r->crumbs);
    if (r->thin_voxels != 0)
        cli_tell(made, "  thin        %" PRIu64 " voxels at walls below 1.5 voxels%s\n", r->thin_voxels,
                 r->thin_kept ? ": kept" : "");
    if (r->parts_dropped != 0) cli_tell(made, "  dropped     %" PRIu64 " parts\n", r->parts_dropped);
    if (r->cavities_dropped != 0) cli_tell(made, "  filled      %" PRIu64 " cavities\n", r->cavities_dropped);
    cli_tell_reduction(reduction, made);
    cli_tell_result(&r->after, made);
    if (!own->measure) return;
    cli_tell(made, "  distance    input to result %.3g (largest %.3g), result to input %.3g (%.3g)\n",
             r->distance.mean_a_to_b, r->distance.max_a_to_b, r->distance.mean_b_to_a,
             r->distance.max_b_to_a);
}

/* Edges of the result collapse; what was measured of it is measured again. */
static int reduce_repaired(cli_run *run, const bvx_mesh *source, bvx_mesh *repaired,
                           bvx_repair_report *report, cli_reduction *reduction)
{
    const repair_options *const own = run->own;
    int const result = cli_reduce(run, repaired, reduction);

    if (result != CLI_DONE || !reduction->done) return result;
    report->after = reduction->level.certificate;
    if (!own->measure) return CLI_DONE;

    bvx_mesh_view const from = cli_view(source), to = cli_view(repaired);
    cli_stage_begin(run, "distance");
    bvx_status status = bvx_mesh_distance(run->context, &from, &to, report->distance.samples,
                                          report->distance.seed, &report->distance);
    cli_stage_end(run);
    return cli_check_call(run, status, cli_first_name(run));
}

typedef struct repair_job {
    bvx_mesh source, repaired;
    bvx_repair_report report;
    cli_reduction reduction;
} repair_job;

/* The report's certificate becomes that of the file. A copy is the input itself, which has its attributes. */
static int write_repaired(cli_run *run, void *work)
{
    repair_job *const job = work;
    const cli_options *const o = run->options;
    int const copied = job->report.copied && !job->reduction.done;
    /* The file that is written would say nothing else than the input. */
    if (copied && strcmp(o->input[0], "-") != 0 && run->report.nonfinite == 0 &&
        cli_input_format(run, o->input[0]) == bvx_format_of_name(o->output) &&
        cli_turn_of(run) == BVX_TURN_NONE &&
        cli_given_of(run, "--normals --output-origin --quantize") == NULL) {
        cli_bytes b = {NULL, 0, 0, 0};
        int result = cli_read_file(run, o->input[0], &b);
        bvx_buffer const file = {.bytes = b.bytes, .size = b.size};
        if (result == CLI_DONE) result = cli_write_output(run, 0, &file);
        if (result == CLI_DONE) result = cli_keep_outputs(run);
        if (result == CLI_DONE) run->report.kept = run->report.had;
        free(b.bytes);
        return result;
    }
    run->source = &job->source;
    int result = cli_write_mesh(run, copied ? &job->source : &job->repaired);
    job->report.after = run->report.mesh[0].certificate;
    return result;
}

static int make_repair(cli_run *run, void *work, cli_made *made)
{
    const repair_options *const own = run->own;
    repair_job *const job = work;
    bvx_repair_report *const r = &job->report;
    cli_mesh_entry *const entry = &run->report.mesh[0];

    static const cli_rule rules[] = {{.also = cli_to_mesh_rules},
                                     {.also = cli_reduction_rules},
                                     {.also = cli_sharp_rules},
                                     {.also = cli_mesh_file_rules},
                                     {0}};

    CLI_TRY(cli_check_rules(run, rules, 0, NULL));

    /* Opened before the mesh is read: a folder that cannot be written costs no time. */
    CLI_TRY(cli_open_output(run, run->options->output));
    CLI_TRY(cli_read_mesh(run, run->options->input[0], &job->source));
    CLI_TRY(cli_check_carry(run, &job->source));

    const cli_options *const c = run->options;
    bvx_repair_options o = own->library;
    o.struct_size = sizeof o;
    if (c->resolution.count != 0) o.fit.resolution = (int32_t)c->resolution.value[0];
    o.sign = c->sign;
    o.placing.interpolation = c->interpolation;
    o.placing.sharp = cli_sharp(c);
    if (cli_given(run, "--shell")) o.shell = cli_or_none(c->shell);
    o.parts = cli_parts(run);
    if (own->measure) o.samples = REPAIR_SAMPLES;
    o.report = r;
    bvx_mesh_view const view = cli_view(&job->source);
    CLI_TRY(
        CLI_STAGE(run, "repair", bvx_repair(run->context, &view, &o, &job->repaired), cli_first_name(run)));
    CLI_TRY(reduce_repaired(run, &job->source, &job->repaired, r, &job->reduction));
    CLI_TRY(cli_carry(run, &job->source, &job->repaired, "carry", cli_first_name(run)));

    run->report.lattice = r->lattice;
    run->report.has_lattice = !r->copied;
    entry->path = run->options->output;
    entry->certificate = r->after;
    if (own->measure) entry->distance = &r->distance;
    run->report.meshes = 1;
    made->write = write_repaired;
    return CLI_DONE;
}

static void tell_repair(const cli_run *run, const void *work, cli_made *made)
{
    const repair_options *const own = run->own;
    const repair_job *const job = work;
    cli_report_repair(&made->members, &job->report, own->measure);
    const bvx_repair_report *const r = &job->report;
    const bvx_certificate *const c = &r->before;
    cli_tell(made, "  found       %s%s%s; %" PRIu64 " components, volume %.6g\n",
             c->closed ? "closed" : "open",
             c->edge_manifold && c->vertex_manifold ? ", manifold" : ", not manifold",
             c->oriented ? ", oriented" : ", not oriented", c->components, c->volume);
    if (r->needs == BVX_NEEDS_NOTHING)
        cli_tell(made, "  needs       nothing: it does not cross itself%s\n",
                 r->copied ? "; copied" : " (--if-needed copies it)");
    if (r->crossings != 0) cli_tell(made, "  crossings   %" PRIu64 " pairs of triangles\n", r->crossings);
    if (r->holes != 0 && c->boundary_edges == 0)
        cli_tell(made, "  holes       %" PRIu64 " where junctions part\n", r->holes);
    else if (r->holes != 0)
        cli_tell(made, "  holes       %" PRIu64 ", %" PRIu64 " open edges\n", r->holes, c->boundary_edges);
    if (c->flipped_edges != 0)
        cli_tell(made,
                 "  flipped     %" PRIu64 " edges between triangles of opposite sides; %" PRIu64
                 " triangles reversed\n",
                 c->flipped_edges, r->turned);
    if (c->nonmanifold_edges != 0)
        cli_tell(made, "  junctions   %" PRIu64 " edges of three triangles or more\n", c->nonmanifold_edges);
    if (c->duplicates + c->degenerate + c->collapsed != 0)
        cli_tell(made, "  useless     %" PRIu64 " duplicate, %" PRIu64 " without area\n", c->duplicates,
                 c->degenerate + c->collapsed);
    tell_repaired(run, r, &job->reduction, made);
}

static const cli_owned repair_owns[] = {
    CLI_OWNS(MESH, repair_job, repaired), CLI_OWNS(MESH, repair_job, source), {0}};

const cli_command cli_repair = {
    .name = "repair",
    .bit = CLI_REPAIR,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "IN -o OUT [options]",
    .does = "a closed, manifold, oriented mesh from any",
    .details =
        "Reads a mesh (" CLI_MESHES_READ ", also with .gz) with whatever is wrong with it - holes,\n"
        "gaps, overlaps, flipped, doubled or crossing triangles, corners that are NaN or infinite (left out) -\n"
        "and writes one that is closed, manifold, oriented and does not cross itself (" CLI_MESHES_WRITTEN
        ").\n"
        "Details below a voxel are lost; what encloses nothing, like a single sheet, becomes a shell; walls thinner\n"
        "than voxels are kept. With --triangles or --error the result's edges then collapse.",
    .example = "bitvox repair fixtures/knot.ply -o closed.ply --resolution 128 --triangles 8000 --measure",
    .most = "--output-dir --resolution --triangles --error --sign --sharp --shell --keep-largest "
            "--if-needed --threads --memory-limit --json",
    .rows = repair_rows,
    .own = sizeof(repair_options),
    .job = {.size = sizeof(repair_job), .make = make_repair, .tell = tell_repair, .owns = repair_owns}};
