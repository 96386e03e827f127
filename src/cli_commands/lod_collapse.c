/* lod_collapse.c - bitvox lod, --method collapse: levels of any mesh, or of a grid's surface, by
 * bvx_build_levels. */
#include "cli_commands/collapse_run.h"
#include "cli_commands/lod_chain.h"

#include <inttypes.h>
#include <string.h>

typedef struct lod_collapse {
    cli_collapse_run run; /* the first, as cli_write_collapse needs it */
    bvx_levels_report report;
} lod_collapse;

#define OF_SOLID                                                                                       \
    "--solid --resolution --sign --sharp --no-sharp --shell --outer-hull --least-cavity --least-part " \
    "--keep-largest"

static const cli_rule solid_rules[] = {
    {.when = CLI_OF_MESH,
     .given = "--level --range --label --below --shape --sample-type --big-endian --skip --voxel-size",
     .message = "%o is for volumes; %i is a mesh"},
    {.given = "--lock-border --keep-vertices",
     .beside = "--solid --resolution --sign --sharp --no-sharp --shell --outer-hull --least-cavity",
     .message = "%o keeps vertices of the mesh, and %b measures a new surface"},
    {.when = CLI_OF_MESH,
     .given = "--lock-border --keep-vertices",
     .beside = "--least-part --keep-largest",
     .message = "%o keeps vertices of the mesh, and %b measures a new surface"},
    {.when = CLI_OF_MESH,
     .given = "--attributes",
     .beside = OF_SOLID,
     .message = "%o weighs attributes of the mesh, and the surface that %b measures has none"},
    {.when = CLI_OF_MESH,
     .given = "--carry",
     .lacking = OF_SOLID,
     .message =
         "%o is for --solid, --method edge-ratio and coverage; levels of the mesh as it is have what it has"},
    {.also = cli_sharp_rules},
    {.given = "--outer-hull",
     .beside = "--least-cavity",
     .message = "%o fills every cavity; %b has no use beside it"},
    {0}};

static void take_levels_options(const cli_run *run, lod_collapse *l, bvx_levels_options *b)
{
    const cli_lod_options *const own = run->own;
    const cli_options *const o = run->options;

    *b = own->levels;
    b->struct_size = sizeof *b;
    b->targets = cli_targets(run, &l->run);
    if (cli_given(run, "--attributes")) b->collapse.attribute_weight = cli_or_none(o->attributes);
    b->collapse.lock_border = o->lock_border;
    b->collapse.topology = o->topology;
    b->collapse.vertices = o->keep_vertices ? BVX_VERTICES_KEPT : BVX_VERTICES_PLACED;
    b->report = &l->report;
    b->reports = l->run.level;
    if (l->run.kind == CLI_GRID) return;
    if (o->resolution.count != 0) b->fit.resolution = (int32_t)o->resolution.value[0];
    b->sign = o->sign;
    b->sharp = cli_sharp(o);
    if (cli_given(run, "--shell")) b->shell = cli_or_none(o->shell);
    b->parts = cli_parts(run);
    if (own->outer_hull) b->parts.least_cavity = UINT64_MAX;
}

static void tell_made_ready(const bvx_levels_report *r, cli_made *made)
{
    const struct {
        uint64_t count;
        const char *one, *many;
    } row[] = {{r->collapsed, "triangle of equal corners dropped", "triangles of equal corners dropped"},
               {r->doubles, "copy of a triangle dropped", "copies of triangles dropped"},
               {r->turned, "flipped triangle turned", "flipped triangles turned"},
               {r->split, "vertex split where fans meet", "vertices split where fans meet"},
               {r->parted, "edge of several sheets parted", "edges of several sheets parted"},
               {r->cut, "edge cut", "edges cut"}};
    const char *before = "made ready: ";

    for (size_t i = 0; i < sizeof row / sizeof row[0]; i++) {
        if (row[i].count == 0) continue;
        cli_tell(made, "%s%" PRIu64 " %s", before, row[i].count,
                 row[i].count == 1 ? row[i].one : row[i].many);
        before = ", ";
    }
    if (*before == ',') cli_tell(made, "\n");
}

static void tell_lod_head(const cli_run *run, const lod_collapse *l, cli_made *made)
{
    const cli_collapse_run *const c = &l->run;
    const bvx_repair_report *const r = &l->report.repair;
    const bvx_lattice *const b = &r->lattice;

    cli_tell_input(run, c->input.triangle_count, &c->before, c->diagonal, made);
    if (!l->report.solid) {
        cli_tell(made, "levels from %s, %" PRIu64 " piece%s, in %.1f ms\n",
                 c->kind == CLI_GRID ? "the grid's surface" : "the mesh as it is", c->before.components,
                 c->before.components == 1 ? "" : "s", c->seconds * 1e3);
        tell_made_ready(&l->report, made);
        if (!cli_is_sound(&c->before))
            cli_tell(made, "the input is no solid, and neither are its levels; --solid makes closed ones\n");
        cli_tell(made, "\n");
        return;
    }

    cli_tell(made, "levels from its measured surface, as %s asks, in %.1f ms\n", cli_given_of(run, OF_SOLID),
             c->seconds * 1e3);
    cli_tell(made,
             "measured: %" PRId32 " x %" PRId32 " x %" PRId32 " voxels, inside by %s; %" PRIu64
             " triangles, %" PRIu64 " piece%s\n",
             b->dims[0], b->dims[1], b->dims[2], cli_fill_names[r->sign], c->surface.triangles,
             c->surface.components, c->surface.components == 1 ? "" : "s");
    if (r->holes != 0) cli_tell(made, "holes closed: %" PRIu64 "\n", r->holes);
    if (r->shelled_triangles != 0)
        cli_tell(made, "made into shells: %" PRIu64 " triangles that enclose nothing\n",
                 r->shelled_triangles);
    if (r->thin_voxels != 0)
        cli_tell(made, "thin walls %s: %" PRIu64 " voxels at walls below 1.5 voxels\n",
                 r->thin_kept ? "kept"
                              : "left as the voxels have them, since keeping them would make handles",
                 r->thin_voxels);
    if (r->crumbs != 0)
        cli_tell(made, "dropped: %" PRIu64 " crumb%s that no piece of the input stands for\n", r->crumbs,
                 r->crumbs == 1 ? "" : "s");
    if (r->parts_dropped != 0) cli_tell(made, "dropped: %" PRIu64 " parts\n", r->parts_dropped);
    if (r->cavities_dropped != 0) cli_tell(made, "filled: %" PRIu64 " cavities\n", r->cavities_dropped);
    cli_tell(made, "\n");
}

static int make_collapse(cli_run *run, void *work, cli_made *made)
{
    lod_collapse *const l = work;
    made->untitled = 1;
    made->write = cli_write_collapse;
    CLI_TRY(cli_input_kind(run, run->options->input[0], &l->run.kind));

    const cli_options *const o = run->options;
    CLI_TRY(cli_check_rules(run, solid_rules, l->run.kind == CLI_GRID ? CLI_OF_GRID : CLI_OF_MESH, NULL));
    /* The row allows what the other methods take, which is more. */
    if (o->resolution.count != 0 && o->resolution.value[0] > 1 << 24)
        return cli_usage(run, "--resolution %" PRId64 " is more than the %d that a surface is measured with",
                         o->resolution.value[0], 1 << 24);

    CLI_TRY(cli_check_collapse(run, &l->run));
    CLI_TRY(cli_open_collapse(run, &l->run));
    cli_collapse_run *const c = &l->run;
    bvx_levels_options b;

    take_levels_options(run, l, &b);
    cli_stage_begin(run, "level 0");
    bvx_status const status = bvx_build_levels(run->context, &c->view, &b, (uint64_t)c->count, c->mesh);
    c->seconds = cli_stage_end(run);
    CLI_TRY(cli_check_call(run, status, cli_first_name(run)));

    c->before = l->report.before;
    c->surface = l->report.solid ? l->report.repair.after : l->report.before;
    c->surface.triangles = l->report.triangles;
    c->solid = l->report.solid;
    if (l->report.solid) {
        run->report.lattice = l->report.repair.lattice;
        run->report.has_lattice = 1;
    }
    return cli_finish_collapse(run, &l->run);
}

static void tell_collapse(const cli_run *run, const void *work, cli_made *made)
{
    const lod_collapse *const l = work;
    tell_lod_head(run, l, made);
    cli_tell_collapse(run, &l->run, made);

    cli_text *const t = &made->members;

    cli_text_add(t, ", \"levels\": {\"method\": \"collapse\", \"solid\": %s",
                 l->report.solid ? "true" : "false");
    cli_json_count(t, "input_triangles", l->run.input.triangle_count);
    cli_json_count(t, "input_components", l->report.before.components);
    cli_json_value(t, "input_volume", l->report.before.volume);
    cli_json_count(t, "input_border_edges", l->report.before.boundary_edges);
    cli_json_count(t, "collapsed", l->report.collapsed);
    cli_json_count(t, "doubles", l->report.doubles);
    cli_json_count(t, "turned", l->report.turned);
    cli_json_count(t, "split", l->report.split);
    cli_json_count(t, "parted", l->report.parted);
    cli_json_count(t, "cut", l->report.cut);
    cli_json_count(t, "crumbs", l->report.crumbs);
    cli_json_count(t, "resolution", (uint64_t)l->report.resolution);
    cli_json_count(t, "planned_resolution", (uint64_t)l->report.planned_resolution);
    cli_json_count(t, "surface_triangles", l->report.triangles);
    cli_json_count(t, "surface_components", l->run.surface.components);
    cli_json_value(t, "diagonal", l->run.diagonal);
    cli_json_value(t, "milliseconds", l->run.seconds * 1e3);
    cli_text_add(t, "}");
    if (l->report.solid) cli_report_repair(t, &l->report.repair, 0);
}

const cli_job cli_lod_collapse = {
    .size = sizeof(lod_collapse), .make = make_collapse, .tell = tell_collapse, .owns = cli_collapse_owns};
