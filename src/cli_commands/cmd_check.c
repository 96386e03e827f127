/* cmd_check.c - bitvox check: whether a mesh can be made: sound, walls, gaps, cavities, islands of its layers.
 *
 * What is wrong is an answer that scripts ask for: after it was told, the run ends as a failure. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define OWN(name) CLI_OWN(bvx_inspect_options, name)

static const char *const up_names[] = {BVX_UP_LIST(CLI_NAME_OF) NULL};

static const cli_argument check_rows[] = {
    {.also = cli_takes_output},
    FROM_TO("--walls", "T", OWN(walls), 0, 1e300,
            "walls thinner than T, in the mesh's unit, are faults [none is]"),
    FROM_TO("--gaps", "T", OWN(gaps), 0, 1e300, "gaps narrower than T are faults [none is]"),
    FROM_TO("--density", "D", OWN(density), 1e-300, 1e300, "mass of a unit of volume [1]"),
    CHOICE("--up", "AXIS", OWN(up), up_names, BVX_UP_Z, "towards which layers are built: x, y or z [z]"),
    WHOLE(
        "--resolution", "N", OWN(fit.resolution), 1, 16777216,
        "voxels along the longest axis: cavities, layers, and how far rays through\nwalls start apart [256]"),
    WHOLE("--most", "N", OWN(most), 1, 1048576, "places of each kind that are listed [8]"),
    {.also = cli_takes_all},
    {0}};

typedef struct check_job {
    cli_input in;
    bvx_inspect_report report;
    bvx_finding *finding;
    double *thickness;
    uint8_t *colours;
    bvx_mesh painted; /* the input's arrays, with these colours */
} check_job;

/* By BVX_NEEDS_... */
static const char *const check_needs[] = {
    "sound",
    "open edges",
    "edges of three triangles and more, or parts that touch at a vertex",
    "neighbours of opposite orientation",
    "triangles without area, or there twice",
    "inside out, or a part within another that is not its cavity",
    "triangles that cross"};
static const char *const finding_names[BVX_FINDING_COUNT] = {BVX_FINDING_LIST(CLI_NAME_OF)};
static const char *const finding_lines[BVX_FINDING_COUNT] = {"thin walls", "gaps", "cavities", "islands"};
static const char *const finding_sizes[BVX_FINDING_COUNT] = {"thickness", "width", "volume", "area"};

/* ---- Colours ---- */

static int paint_mesh(cli_run *run, check_job *job)
{
    const bvx_inspect_options *const own = run->own;
    uint64_t const n = job->in.mesh.vertex_count;
    /* Without a limit the thinnest twentieth of the surface shows. */
    double const limit = own->walls > 0.0 ? own->walls : job->report.thickness[1];

    job->colours = malloc((size_t)n * 4 + 1);
    if (job->colours == NULL) return cli_fail(run, "no memory for the colours of %" PRIu64 " vertices", n);
    /* Red below the limit, then from yellow to grey at twice as much. */
    for (uint64_t v = 0; v < n; v++) {
        static const double thin[3] = {215, 25, 28}, near[3] = {255, 215, 80}, thick[3] = {200, 205, 210};
        double const part = job->thickness[v] / limit;
        uint8_t *const c = job->colours + 4 * v;
        double const share = part < 2.0 ? part - 1.0 : 1.0;

        for (int k = 0; k < 3; k++)
            c[k] = (uint8_t)(part < 1.0 ? thin[k] : near[k] + share * (thick[k] - near[k]) + 0.5);
        c[3] = 255;
    }
    job->painted = job->in.mesh;
    job->painted.colours = job->colours;
    job->painted.owned = 0;
    return CLI_DONE;
}

/* ---- The job ---- */

static uint64_t count_faults(const check_job *job)
{
    uint64_t const *const found = job->report.found;
    return (job->report.needs != BVX_NEEDS_NOTHING) + found[BVX_FINDING_WALL] + found[BVX_FINDING_GAP] +
           found[BVX_FINDING_CAVITY];
}

/* Islands are no faults: a support carries them. */
static int judge_check(cli_run *run, void *work)
{
    const check_job *const job = work;
    const bvx_inspect_report *const r = &job->report;
    cli_text t = {0};

    if (count_faults(job) == 0) return CLI_DONE;
    if (r->needs != BVX_NEEDS_NOTHING) cli_text_add(&t, ", not sound: %s", check_needs[r->needs]);
    for (int kind = 0; kind <= BVX_FINDING_CAVITY; kind++)
        if (r->found[kind] != 0) cli_text_add(&t, ", %s: %" PRIu64, finding_lines[kind], r->found[kind]);
    int const status = cli_fail(run, "%s: %s", cli_first_name(run), t.bytes != NULL ? t.bytes + 2 : "");
    cli_text_free(&t);
    snprintf(run->report.error_code, sizeof run->report.error_code, "CHECK");
    return status;
}

static int make_check(cli_run *run, void *work, cli_made *made)
{
    check_job *const job = work;
    bvx_inspect_options *const o = run->own;
    const char *const out = run->options->output;
    int32_t const format = out != NULL ? bvx_format_of_name(out) : 0;
    int kind;

    made->untitled = 1;
    made->judge = judge_check;
    CLI_TRY(cli_input_kind(run, run->options->input[0], &kind));
    if (kind != CLI_MESH)
        return cli_usage(
            run, "check is for meshes; %s is a grid: 'bitvox components' lists its parts and cavities",
            cli_first_name(run));
    if (out != NULL && (!CLI_HOLDS(run, CLI_TO_MESH) || format == BVX_FORMAT_STL || format == BVX_FORMAT_3MF))
        return cli_usage(run, "%s: this format has no colours; take .ply, .obj, .off or .glb", out);
    if (out != NULL) CLI_TRY(cli_open_output(run, out));
    CLI_TRY(cli_read_mesh(run, run->options->input[0], &job->in.mesh));
    job->in.kind = CLI_MESH;

    o->struct_size = sizeof *o;
    if (o->most == 0) o->most = 8;
    job->finding = calloc((size_t)BVX_FINDING_COUNT * (size_t)o->most + 1, sizeof *job->finding);
    if (out != NULL) job->thickness = malloc((size_t)job->in.mesh.vertex_count * sizeof *job->thickness + 1);
    if (job->finding == NULL || (out != NULL && job->thickness == NULL))
        return cli_fail(run, "no memory for what is found");
    o->findings = job->finding;
    o->thickness = job->thickness;

    bvx_mesh_view const view = cli_view(&job->in.mesh);
    CLI_TRY(
        CLI_STAGE(run, "inspect", bvx_inspect(run->context, &view, o, &job->report), cli_first_name(run)));
    run->report.lattice = job->report.lattice;
    run->report.has_lattice = 1;
    run->report.mesh[0].path = run->options->input[0];
    run->report.mesh[0].certificate = job->report.certificate;
    run->report.mesh[0].crossings = job->report.crossings;
    run->report.mesh[0].has_crossings = 1;
    run->report.meshes = 1;
    if (out == NULL) return CLI_DONE;
    CLI_TRY(paint_mesh(run, job));
    made->mesh = &job->painted;
    return CLI_DONE;
}

/* ---- What is told ---- */

static void tell_least(cli_made *made, const char *what, double least, const double ends[2][3])
{
    if (!(least < HUGE_VAL)) cli_tell(made, "  %-11s none measured\n", what);
    else
        cli_tell(made, "  %-11s %.6g at the least, from %.6g, %.6g, %.6g to %.6g, %.6g, %.6g\n", what, least,
                 ends[0][0], ends[0][1], ends[0][2], ends[1][0], ends[1][1], ends[1][2]);
}

static void tell_findings(const bvx_inspect_options *own, const check_job *job, int kind, cli_made *made)
{
    uint64_t const found = job->report.found[kind], most = (uint64_t)own->most;
    const bvx_finding *const f = job->finding + (uint64_t)kind * most;
    double const limit = kind == BVX_FINDING_WALL ? own->walls : own->gaps;

    if (kind <= BVX_FINDING_GAP && limit == 0.0) return;
    cli_tell(made, "  %-11s %" PRIu64, finding_lines[kind], found);
    if (kind <= BVX_FINDING_GAP) cli_tell(made, " below %.6g", limit);
    if (kind == BVX_FINDING_WALL)
        cli_tell(made, ", %.6g of the surface's %.6g", job->report.thin_area, job->report.certificate.area);
    if (kind == BVX_FINDING_CAVITY && found != 0)
        cli_tell(made, ", volume %.6g in all", job->report.cavity_volume);
    cli_tell(made, "\n");
    for (uint64_t i = 0; i < found && i < most; i++)
        cli_tell(made, "              %s %.6g at %.6g, %.6g, %.6g\n", finding_sizes[kind], f[i].size,
                 f[i].position[0], f[i].position[1], f[i].position[2]);
    if (found > most) cli_tell(made, "              and %" PRIu64 " more\n", found - most);
}

static void report_check(const bvx_inspect_options *own, const check_job *job, cli_text *t)
{
    const bvx_inspect_report *const r = &job->report;

    cli_text_add(t, ", \"check\": {\"sound\": %s, \"needs\": \"%s\"",
                 r->needs == BVX_NEEDS_NOTHING ? "true" : "false",
                 r->needs == BVX_NEEDS_NOTHING ? "nothing" : check_needs[r->needs]);
    cli_json_count(t, "faults", count_faults(job));
    cli_json_count(t, "crossings", r->crossings);
    cli_json_value(t, "volume", r->volume);
    cli_json_value(t, "volume_error", r->volume_error);
    cli_json_value(t, "mass", r->mass);
    cli_json_value(t, "least_thickness", r->least_thickness);
    cli_json_key(t, "thickness", 0);
    for (int k = 0; k < 4; k++) {
        cli_text_add(t, k == 0 ? "[" : ", ");
        cli_json_number(t, r->thickness[k]);
    }
    cli_text_add(t, "]");
    cli_json_value(t, "thin_area", r->thin_area);
    cli_json_value(t, "least_gap", r->least_gap);
    cli_json_value(t, "cavity_volume", r->cavity_volume);
    for (int kind = 0; kind < BVX_FINDING_COUNT; kind++) {
        uint64_t const most = (uint64_t)own->most;
        cli_text_add(t, ", \"%s\": {\"count\": %" PRIu64 ", \"places\": [", finding_names[kind],
                     r->found[kind]);
        for (uint64_t i = 0; i < r->found[kind] && i < most; i++) {
            const bvx_finding *const f = &job->finding[(uint64_t)kind * most + i];
            cli_text_add(t, "%s{\"%s\": ", i == 0 ? "" : ", ", finding_sizes[kind]);
            cli_json_number(t, f->size);
            cli_json_triple(t, "position", f->position);
            cli_json_triple(t, "low", f->low);
            cli_json_triple(t, "high", f->high);
            cli_json_count(t, "voxels", f->voxels);
            cli_text_add(t, "}");
        }
        cli_text_add(t, "]}");
    }
    cli_text_add(t, "}");
}

static void tell_check(const cli_run *run, const void *work, cli_made *made)
{
    const check_job *const job = work;
    const bvx_inspect_options *const own = run->own;
    const bvx_inspect_report *const r = &job->report;

    cli_tell(made, "%s: %s\n", cli_first_name(run),
             count_faults(job) == 0 ? "no fault found" : "faults found");
    cli_tell(made, "  sound       %s%s\n", r->needs == BVX_NEEDS_NOTHING ? "yes" : "no: ",
             r->needs == BVX_NEEDS_NOTHING ? "" : check_needs[r->needs]);
    cli_tell(made, "  crossings   %" PRIu64 " pairs of triangles\n", r->crossings);
    cli_tell(made, "  encloses    %.10g, at most %.3g off\n  mass        %.10g\n", r->volume, r->volume_error,
             r->mass);
    tell_least(made, "thickness", r->least_thickness, r->thin_ends);
    if (r->least_thickness < HUGE_VAL)
        cli_tell(made, "              1, 5, 50, 95 %% of the surface are below %.4g, %.4g, %.4g, %.4g\n",
                 r->thickness[0], r->thickness[1], r->thickness[2], r->thickness[3]);
    tell_least(made, "gap", r->least_gap, r->gap_ends);
    for (int kind = 0; kind < BVX_FINDING_COUNT; kind++) tell_findings(own, job, kind, made);
    report_check(own, job, &made->members);
}

static const cli_owned check_owns[] = {CLI_OWNS(INPUT, check_job, in),
                                       CLI_OWNS(BYTES, check_job, finding),
                                       CLI_OWNS(BYTES, check_job, thickness),
                                       CLI_OWNS(BYTES, check_job, colours),
                                       {0}};

const cli_command cli_check = {
    .name = "check",
    .bit = CLI_CHECK,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "IN [-o OUT] [options]",
    .does = "whether a mesh can be made: sound, thin walls, gaps, cavities, islands",
    .details =
        "Reads a mesh (" CLI_MESHES_READ ", also with .gz) and reports whether it is sound (closed,\n"
        "manifold, oriented, outwards, free of crossings), its volume and mass, how thick its walls and how\n"
        "narrow its gaps are, cavities that trap resin or powder, and islands: parts of a layer with nothing\n"
        "below. -o writes the mesh with the colours of its walls (.ply .obj .off .glb): red below --walls, or where\n"
        "the thinnest 5 % are. The exit status is 1 where it is not sound, has a cavity, or walls or gaps\n"
        "below these.",
    .example = "bitvox check fixtures/knot.ply --walls 0.4 --density 1.24\n"
               "bitvox check fixtures/knot.ply --resolution 128 -o walls.ply",
    .most = "--walls --gaps --density --up --resolution --most --format --threads --memory-limit --json",
    .rows = check_rows,
    .own = sizeof(bvx_inspect_options),
    .job = {.size = sizeof(check_job), .make = make_check, .tell = tell_check, .owns = check_owns}};
