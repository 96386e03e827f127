/* lod_collapse.c - bitvox lod, --method collapse: levels of any mesh by bvx_build_levels, and why they were
 * made from what. */
#include "cli_commands/collapse_run.h"
#include "cli_commands/lod_chain.h"

#include <inttypes.h>
#include <string.h>

typedef struct lod_collapse {
    cli_collapse_run run; /* the first, as cli_write_collapse needs it */
    bvx_levels_report report;
} lod_collapse;

/* ---- Options ---- */

#define OF_MEASURED                                                                                   \
    "--resolution --sign --least-part --keep-largest --least-cavity --outer-hull --sharp --no-sharp " \
    "--shell"

/* Facts of the line. */
enum {
    FROM_MESH = 1 << CLI_FIRST_FACT,     /* --source mesh */
    FROM_MEASURED = 2 << CLI_FIRST_FACT, /* --source measured */
    LEAVES_OPEN = 4 << CLI_FIRST_FACT    /* --open keep, --open cut */
};

/* The word is the name of --open. */
static const cli_rule measured_rules[] = {
    {.given = "--level --range --label --below --shape --sample-type --big-endian --skip --voxel-size",
     .message = "%o is for volumes; %i is a mesh"},
    {.when = FROM_MESH,
     .given = OF_MEASURED,
     .message = "%o is for a measured surface, and --source mesh measures none"},
    {.when = LEAVES_OPEN,
     .given = OF_MEASURED,
     .message = "--open %w keeps borders, and a measured surface (%o) has none"},
    {.when = LEAVES_OPEN | FROM_MEASURED,
     .message = "--open %w keeps borders, and a measured surface (--source measured) has none"},
    {.also = cli_sharp_rules},
    {.given = "--outer-hull",
     .beside = "--least-cavity",
     .message = "%o fills every cavity; %b has no use beside it"},
    {0}};

static int check_measured_options(cli_run *run)
{
    const cli_lod_options *const own = run->own;
    const cli_options *const o = run->options;
    uint32_t const facts = (own->levels.source == BVX_LEVELS_MESH ? FROM_MESH : 0u) |
                           (own->levels.source == BVX_LEVELS_MEASURED ? FROM_MEASURED : 0u) |
                           (o->open != BVX_OPEN_SHELL ? LEAVES_OPEN : 0u);

    CLI_TRY(cli_check_rules(run, measured_rules, facts, o->open == BVX_OPEN_KEEP ? "keep" : "cut"));
    /* The row allows what the other methods take, which is more. */
    if (o->resolution.count != 0 && o->resolution.value[0] > 1 << 24)
        return cli_usage(run, "--resolution %" PRId64 " is more than the %d that a surface is measured with",
                         o->resolution.value[0], 1 << 24);
    return CLI_DONE;
}

static void take_levels_options(const cli_run *run, lod_collapse *l, bvx_levels_options *b)
{
    const cli_lod_options *const own = run->own;
    const cli_options *const o = run->options;

    *b = own->levels;
    if (l->run.by_error) b->target_errors = l->run.error;
    else b->target_triangles = l->run.target;
    b->error_kind = o->error_kind;
    if (cli_given(run, "--even")) b->even = o->even;
    b->colour_weight = o->colour_weight;
    b->measure_samples = cli_collapse_samples(run, &l->run);
    b->strict = o->strict;
    b->open = o->open;

    /* Of the measured surface; a mesh that is taken as it is does without. */
    if (o->resolution.count != 0) b->resolution = (int32_t)o->resolution.value[0];
    b->sign = o->sign;
    if (o->sharp || o->no_sharp) b->sharp = o->sharp;
    if (cli_given(run, "--shell")) b->shell = o->shell;
    b->least_part = (uint64_t)o->least_part;
    b->keep_largest = (uint64_t)o->keep_largest;
    b->least_cavity = (uint64_t)o->least_cavity;
    b->report = &l->report;
    b->reports = l->run.level;
}

/* ---- Levels ---- */

/* Borders that were to be kept, and why they are not. */
static void warn_of_sheets(const cli_run *run, const lod_collapse *l, cli_made *made)
{
    const bvx_levels_report *const r = &l->report;
    const double *const a = r->refused_edge[0], *const b = r->refused_edge[1];

    /* Shells have no borders to lose. */
    if (run->options->open == BVX_OPEN_SHELL || r->refused_edges == 0) return;
    /* Cut as requested, or not kept as requested: the second needs a remedy. */
    if (run->options->open == BVX_OPEN_CUT)
        cli_advise(
            made, "%" PRIu64 " edge%s of three triangles and more, or whose triangles cannot agree, %s cut",
            r->refused_edges, r->refused_edges == 1 ? "" : "s", r->refused_edges == 1 ? "was" : "were");
    else
        cli_advise(made,
                   "sheets became shells: %" PRIu64
                   " edge%s three triangles or more, or some that cannot agree, the "
                   "first from (%.6g, %.6g, %.6g) to (%.6g, %.6g, %.6g); --open cut cuts there",
                   r->refused_edges, r->refused_edges == 1 ? " has" : "s have", a[0], a[1], a[2], b[0], b[1],
                   b[2]);
}

static void warn_of_lowered(const lod_collapse *l, cli_made *made)
{
    /* Two ways in which a limit costs detail: the mesh could not be taken, or not be measured so finely. */
    if (l->report.reason == BVX_MEASURED_MEMORY)
        cli_advise(
            made,
            "the mesh itself exceeds the memory limit: its surface was measured with %" PRId32
            " voxels along the longest axis, and finer detail is lost; a larger --memory-limit keeps it",
            l->report.resolution);
    else if (l->report.resolution < l->report.planned_resolution)
        cli_advise(made,
                   "the memory limit lowered the resolution from %" PRId32 " to %" PRId32
                   " voxels along the longest axis; a larger "
                   "--memory-limit keeps more detail",
                   l->report.planned_resolution, l->report.resolution);
}

static int is_measured(const lod_collapse *l)
{
    return l->report.source == BVX_LEVELS_MEASURED;
}

static int build_levels(cli_run *run, lod_collapse *l)
{
    cli_collapse_run *const c = &l->run;
    bvx_levels_options b;
    bvx_status status;

    take_levels_options(run, l, &b);
    cli_stage_begin(run, "level 0");
    status = bvx_build_levels(run->context, &c->view, &b, (uint64_t)c->count, c->mesh);
    c->seconds = cli_stage_end(run);
    CLI_TRY(cli_check_call(run, status, cli_input_name(run->options->input[0])));

    c->before = l->report.before;
    c->surface = is_measured(l) ? l->report.repair.after : l->report.before;
    c->surface.triangles = l->report.triangles;
    /* the solid's are not in its surface */
    c->surface.components -= l->report.crumbs - l->report.repair.crumbs;
    c->crumbs = l->report.crumbs;
    c->chosen = is_measured(l) && cli_changed_as_asked(&l->report.repair);
    c->source = is_measured(l) ? "measured" : "mesh";
    if (is_measured(l)) {
        run->report.lattice = l->report.repair.lattice;
        run->report.has_lattice = 1;
    }
    return cli_interrupted() ? cli_fail_interrupted(run) : CLI_DONE;
}

/* ---- What is reported ---- */

/* Why the surface was measured. */
static const char *reason_of(const cli_run *run, const lod_collapse *l)
{
    const cli_lod_options *const own = run->own;
    static const char *const reason[] = {"",
                                         "as options ask",
                                         "since it is open",
                                         "since it is not manifold",
                                         "since some of its triangles are flipped",
                                         "since it has triangles without area",
                                         "since it is a scan much finer than its levels",
                                         "since it and its levels cross themselves",
                                         "since the mesh itself exceeds the memory limit"};

    return own->levels.source == BVX_LEVELS_MEASURED ? "as --source asks" : reason[l->report.reason];
}

static void tell_lod_head(const cli_run *run, const lod_collapse *l, cli_made *made)
{
    const cli_collapse_run *const c = &l->run;
    const bvx_repair_report *const r = &l->report.repair;
    const bvx_lattice *const b = &r->lattice;

    /* Nothing was measured: one line says what the levels come from. */
    cli_tell_input(run, c->input.triangle_count, &c->before, c->diagonal, made);
    if (!is_measured(l)) {
        cli_tell(made, "levels from the mesh itself, %" PRIu64 " piece%s, in %.1f ms\n\n",
                 c->before.components, c->before.components == 1 ? "" : "s", c->seconds * 1e3);
        return;
    }

    cli_tell(made, "levels from its measured surface, %s, in %.1f ms\n", reason_of(run, l), c->seconds * 1e3);
    cli_tell(made,
             "measured: %" PRId32 " x %" PRId32 " x %" PRId32 " voxels, inside by %s; %" PRIu64
             " triangles, %" PRIu64 " piece%s\n",
             b->dims[0], b->dims[1], b->dims[2], cli_sign_names[r->sign], c->surface.triangles,
             c->surface.components, c->surface.components == 1 ? "" : "s");
    /* Rows for what measuring changed stand only where it changed something. */
    if (r->holes != 0)
        cli_tell(made, "holes closed: %" PRIu64 ", the longest %.3g around\n", r->holes, r->longest_hole);
    if (r->shelled)
        cli_tell(made, "made into shells: %" PRIu64 " triangles that enclose nothing\n",
                 r->shelled_triangles);
    if (r->thin_voxels != 0)
        cli_tell(
            made, "thin walls %s: %" PRIu64 " voxels at walls below 1.5 voxels, of %" PRIu64 " component%s\n",
            r->thin_kept ? "kept" : "left as the voxels have them, since keeping them would make handles",
            r->thin_voxels, r->thin_components, r->thin_components == 1 ? "" : "s");
    if (l->report.crossings != 0)
        cli_tell(made, "crossings: %" PRIu64 " pairs of the input's triangles\n", l->report.crossings);
    if (c->crumbs != 0)
        cli_tell(made, "dropped: %" PRIu64 " crumb%s that no piece of the input stands for\n", c->crumbs,
                 c->crumbs == 1 ? "" : "s");
    if (r->parts_dropped != 0)
        cli_tell(made, "dropped: %" PRIu64 " of %" PRIu64 " parts\n", r->parts_dropped,
                 r->parts_dropped + r->parts_kept);
    if (r->cavities_dropped != 0)
        cli_tell(made, "filled: %" PRIu64 " of %" PRIu64 " cavities\n", r->cavities_dropped,
                 r->cavities_dropped + r->cavities_kept);
    cli_tell(made, "\n");
}

static void report_levels(const cli_run *run, const lod_collapse *l, cli_made *made)
{
    cli_text *const t = &made->members;

    cli_text_add(t, ", \"levels\": {\"method\": \"collapse\", \"source\": \"%s\", \"reason\": \"%s\"",
                 l->run.source, is_measured(l) ? reason_of(run, l) : "");
    /* The input, what was found wrong with it, and what the levels were made from. */
    cli_json_count(t, "input_triangles", l->run.input.triangle_count);
    cli_json_count(t, "input_components", l->report.before.components);
    cli_json_value(t, "input_volume", l->report.before.volume);
    cli_json_count(t, "input_crossings", l->report.crossings);
    cli_json_count(t, "input_border_edges", l->report.before.boundary_edges);
    cli_json_count(t, "doubles", l->report.doubles);
    cli_json_count(t, "turned", l->report.turned);
    cli_text_add(t, ", \"nested\": %s", l->report.nested ? "true" : "false");
    cli_json_count(t, "refused_edges", l->report.refused_edges);
    cli_json_count(t, "crumbs", l->report.crumbs);
    cli_json_count(t, "resolution", (uint64_t)l->report.resolution);
    cli_json_count(t, "planned_resolution", (uint64_t)l->report.planned_resolution);
    cli_json_count(t, "surface_triangles", l->report.triangles);
    cli_json_count(t, "surface_components", l->run.surface.components);
    cli_json_value(t, "diagonal", l->run.diagonal);
    cli_json_value(t, "milliseconds", l->run.seconds * 1e3);
    cli_text_add(t, "}");
    if (is_measured(l)) cli_report_repair(t, &l->report.repair, 0);
}

static void warn_of_unused(const cli_run *run, const lod_collapse *l, cli_made *made)
{
    const char *const unused = cli_given_of(run, "--sharp --no-sharp --shell");

    if (unused != NULL && !is_measured(l))
        cli_advise(made,
                   "%s had no use: the levels were made from the mesh itself; --source measured measures its "
                   "surface",
                   unused);
}

/* Bodies that are turned, or that lie in each other: the mesh itself is what levels were made from. */
static void warn_of_facing(const lod_collapse *l, cli_made *made)
{
    const cli_collapse_run *const c = &l->run;
    int const is_body = c->before.closed && c->before.oriented;

    if (is_measured(l)) {
        /* Where one volume says it, the other need not. */
        if (!is_body)
            cli_advise_thickened(&l->report.repair, "the measured surface", "take a higher --resolution",
                                 made);
        return;
    }
    if (is_body && l->report.turned != 0)
        cli_advise(made, "the input is inside out: its %" PRIu64 " triangles were turned", l->report.turned);
    else if (is_body && c->before.volume < 0)
        cli_advise(made, "the input is inside out, and so are its levels");
    if (l->report.nested)
        cli_advise(made, "bodies lie in others and face as they do, so that what lies in both counts twice; "
                         "--source measured makes one body of them");
}

static int make_collapse(cli_run *run, void *work, cli_made *made)
{
    lod_collapse *const l = work;
    int status = check_measured_options(run);

    /* The first line describes the input; the file's name is in it. */
    made->untitled = 1;
    if (status == CLI_DONE) status = cli_check_collapse(run, &l->run);
    if (status == CLI_DONE) status = cli_open_collapse(run, &l->run);
    if (status == CLI_DONE) status = build_levels(run, l);
    if (status == CLI_DONE) status = cli_finish_collapse(run, &l->run);
    made->write = cli_write_collapse;
    return status;
}

static void tell_collapse(const cli_run *run, const void *work, cli_made *made)
{
    const lod_collapse *const l = work;

    tell_lod_head(run, l, made);
    cli_tell_collapse(run, &l->run, made);
    warn_of_unused(run, l, made);
    warn_of_facing(l, made);
    warn_of_sheets(run, l, made);
    warn_of_lowered(l, made);
    report_levels(run, l, made);
}

static void free_collapse(cli_run *run, void *work)
{
    cli_free_collapse(run, &((lod_collapse *)work)->run);
}

const cli_job cli_lod_collapse = {
    .size = sizeof(lod_collapse), .make = make_collapse, .tell = tell_collapse, .free = free_collapse};
