/* cmd_hull.c - bitvox hull: what of a mesh can be reached from outside, as closed meshes. */
#include "cli_commands/collapse_run.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <stdio.h>

typedef struct hull_run {
    cli_collapse_run run;
    bvx_hull_report report;
} hull_run;

static const cli_argument hull_rows[] = {
    {.also = cli_takes_output},
    {.also = cli_takes_output_dir},
    LIST("--resolution", "N", SHARED(resolution), 1, 16777216.0, 1, 1, "voxels along the longest axis [256]"),
    WHOLE("--close-gaps", "N", SHARED(close_gaps), 0, 65535,
          "openings of up to N voxels are closed, larger ones stay [those that no\n"
          "empty voxel leads through]"),
    ERRORS("--enclose", "D", SHARED(enclose), 1,
           "go around every triangle, touching none and nowhere further than D from\n"
           "the mesh, in its unit or with % of its diagonal: for collisions"),
    LIST("--triangles", "A,B,C", SHARED(triangles), 1, 4294967295.0, 1, CLI_MAX_LEVELS,
         "maximum number of triangles, of each level where there are several [all]"),
    {.also = cli_takes_errors},
    WHOLE("--count", "N", SHARED(count), 1, CLI_MAX_LEVELS,
          "levels of all, 1/2, 1/4 ... of the hull's triangles [1]"),
    {.also = cli_takes_interpolation},
    {.also = cli_takes_sharp},
    FROM_TO("--shell", "T", SHARED(shell), 0, 1e6,
            "thickness in voxels, from 1.5, of walls that no centre lies in, with\n"
            "outside on both sides; 0: they are lost [2]"),
    {.also = cli_takes_kept_parts},
    {.also = cli_takes_normals},
    {.also = cli_takes_file_of_a_mesh},
    {.also = cli_takes_carry},
    {.also = cli_takes_all},
    {0}};

static int make_levels(cli_run *run, hull_run *h)
{
    const cli_options *const o = run->options;
    cli_collapse_run *const c = &h->run;
    bvx_hull_options b = {.struct_size = sizeof b, .close_gaps = o->close_gaps};

    b.targets = cli_targets(run, c);
    /* Without a target the first level is the hull itself. */
    if (!cli_reduces(run)) b.targets.triangles = NULL;
    if (o->resolution.count != 0) b.fit.resolution = (int32_t)o->resolution.value[0];
    b.placing.interpolation = o->interpolation;
    b.placing.sharp = cli_sharp(o);
    b.parts = cli_parts(run);
    if (o->enclose.count != 0)
        b.enclose = o->enclose.value[0] * (o->enclose.percent[0] ? c->diagonal / 100.0 : 1.0);
    if (cli_given(run, "--shell")) b.shell = cli_or_none(o->shell);
    b.report = &h->report;
    b.reports = c->level;

    cli_stage_begin(run, "hull");
    bvx_status status = bvx_hull(run->context, &c->view, &b, (uint64_t)c->count, c->mesh);
    c->seconds = cli_stage_end(run);
    CLI_TRY(cli_check_call(run, status, cli_first_name(run)));

    run->report.lattice = h->report.lattice;
    run->report.has_lattice = 1;
    c->solid = 1;
    c->before = c->surface = c->level[0].certificate;
    /* Distances are from the hull: those of the input would be to its inner walls too. */
    for (int i = 0; i < c->count; i++) c->level[i].measured = 0;
    return CLI_DONE;
}

static int make_hull(cli_run *run, void *work, cli_made *made)
{
    static const cli_rule rules[] = {
        {.also = cli_sharp_rules},
        {.given = "--resolution --close-gaps --shell --keep-largest --sharp --no-sharp --interpolation",
         .beside = "--enclose",
         .message = "--enclose follows from the mesh alone: leave out %o"},
        {0}};
    hull_run *const h = work;
    int kind;

    made->write = cli_write_collapse;
    made->untitled = 1;
    CLI_TRY(cli_input_kind(run, run->options->input[0], &kind));
    if (kind != CLI_MESH)
        return cli_usage(run, "hull is for meshes; %s is a grid: 'bitvox morph' closes and fills it",
                         cli_first_name(run));
    h->run.usual_count = 1;
    run->options->samples = 0;
    CLI_TRY(cli_check_rules(run, rules, 0, NULL));
    CLI_TRY(cli_check_collapse(run, &h->run));
    CLI_TRY(cli_open_collapse(run, &h->run));
    CLI_TRY(make_levels(run, h));
    return cli_finish_collapse(run, &h->run);
}

static void tell_hull(const cli_run *run, const void *work, cli_made *made)
{
    const hull_run *const h = work;
    const bvx_hull_report *const r = &h->report;
    cli_text *const t = &made->members;

    cli_tell(made, "%s: %" PRIu64 " triangles, of which the hull lies on %" PRIu64 ", in %.1f ms\n",
             cli_first_name(run), h->run.input.triangle_count, r->outer_triangles, h->run.seconds * 1e3);
    cli_tell(made, "hull: %" PRId32 " x %" PRId32 " x %" PRId32 " voxels, %" PRIu64 " triangles\n",
             r->lattice.dims[0], r->lattice.dims[1], r->lattice.dims[2], r->triangles);
    if (r->lids != 0) cli_tell(made, "openings closed: %" PRIu64 " crossings of lattice edges\n", r->lids);
    if (r->shelled_triangles != 0)
        cli_tell(made, "made into shells: %" PRIu64 " triangles with outside on both sides\n",
                 r->shelled_triangles);
    if (r->parts_dropped != 0) cli_tell(made, "dropped: %" PRIu64 " parts\n", r->parts_dropped);
    cli_tell(made, "\n");
    cli_tell_collapse(run, &h->run, made);

    cli_text_add(t, ", \"hull\": {\"outer_triangles\": %" PRIu64, r->outer_triangles);
    cli_json_count(t, "input_triangles", h->run.input.triangle_count);
    cli_json_count(t, "surface_triangles", r->triangles);
    cli_json_count(t, "shelled_triangles", r->shelled_triangles);
    cli_json_count(t, "lids", r->lids);
    cli_json_count(t, "parts_dropped", r->parts_dropped);
    cli_json_value(t, "milliseconds", h->run.seconds * 1e3);
    cli_text_add(t, "}");
}

const cli_command cli_hull = {
    .name = "hull",
    .bit = CLI_HULL,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "IN -o OUT [options]",
    .does = "what of a mesh can be reached from outside, closed: inner walls and parts go",
    .details =
        "Reads a mesh (" CLI_MESHES_READ ", also with .gz) with walls doubled, welded through\n"
        "holes, flipped, or with loose parts inside, and writes what can be reached from outside: closed,\n"
        "manifold, oriented, without crossings (" CLI_MESHES_WRITTEN "), on the outer of two walls.\n"
        "With --triangles, --error or --count its edges collapse; several make a chain: %d in the name\n"
        "becomes 0, 1, 2 ..., or one .glb holds all.",
    .example = "bitvox hull fixtures/knot.ply -o hull.ply --resolution 128 --triangles 8000",
    .most = "--output-dir --resolution --close-gaps --triangles --error --count --sharp --keep-largest "
            "--carry --threads --memory-limit --json",
    .rows = hull_rows,
    .job = {.size = sizeof(hull_run), .make = make_hull, .tell = tell_hull, .owns = cli_collapse_owns}};
