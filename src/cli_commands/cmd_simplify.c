/* cmd_simplify.c - bitvox simplify: fewer triangles for a mesh as it is. */
#include "cli_commands/collapse_run.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <string.h>

static const cli_argument simplify_rows[] = {
    {.also = cli_takes_output},
    {.also = cli_takes_output_dir},
    LIST("--triangles", "A,B,C", SHARED(triangles), 1, 4294967295.0, 1, CLI_MAX_LEVELS,
         "maximum number of triangles, of each level where there are several [half]"),
    {.also = cli_takes_errors},
    WHOLE("--count", "N", SHARED(count), 1, CLI_MAX_LEVELS,
          "levels of 1/2, 1/4, 1/8 ... of the triangles [1]"),
    {.also = cli_takes_collapse},
    {.also = cli_takes_normals},
    {.also = cli_takes_file_of_a_mesh},
    {.also = cli_takes_samples},
    {.also = cli_takes_all},
    {0}};

static int make_simplify(cli_run *run, void *work, cli_made *made)
{
    cli_collapse_run *const c = work;
    int kind;

    made->write = cli_write_collapse;
    made->untitled = 1;
    CLI_TRY(cli_input_kind(run, run->options->input[0], &kind));
    if (kind != CLI_MESH)
        return cli_usage(run, "simplify is for meshes; %s is a grid: 'bitvox lod' makes meshes of it",
                         cli_first_name(run));
    c->usual_count = 1;
    CLI_TRY(cli_check_collapse(run, c));
    CLI_TRY(cli_open_collapse(run, c));
    const char *const in = cli_first_name(run);
    /* Vertices at equal positions count as one: files repeat them where colours or normals change. */
    CLI_TRY(CLI_STAGE(run, "check input", bvx_mesh_check(run->context, &c->view, 1, &c->before), in));
    const cli_options *const o = run->options;

    bvx_simplify_options s = {.struct_size = sizeof s, .targets = cli_targets(run, c)};
    if (cli_given(run, "--attributes")) s.collapse.attribute_weight = cli_or_none(o->attributes);
    s.collapse.lock_border = o->lock_border;
    s.collapse.topology = o->topology;
    s.collapse.vertices = o->keep_vertices ? BVX_VERTICES_KEPT : BVX_VERTICES_PLACED;
    s.reports = c->level;

    cli_stage_begin(run, "level 0");
    bvx_status const status = bvx_mesh_simplify(run->context, &c->view, &s, (uint64_t)c->count, c->mesh);
    c->seconds = cli_stage_end(run);
    CLI_TRY(cli_check_call(run, status, cli_first_name(run)));
    return cli_finish_collapse(run, c);
}

static void tell_simplify(const cli_run *run, const void *work, cli_made *made)
{
    const cli_collapse_run *const c = work;
    cli_tell_input(run, c->input.triangle_count, &c->before, c->diagonal, made);
    cli_tell(made, "%" PRIu64 " piece%s, volume %.6g; edges collapsed in %.1f ms\n\n", c->before.components,
             c->before.components == 1 ? "" : "s", c->before.volume, c->seconds * 1e3);
    cli_tell_collapse(run, work, made);
}

const cli_command cli_simplify = {
    .name = "simplify",
    .bit = CLI_SIMPLIFY,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "IN -o OUT [options]",
    .does = "fewer triangles for a mesh as it is, by count or by error",
    .details =
        "Reads a mesh (" CLI_MESHES_READ ", also with .gz), collapses the edges that cost least, and\n"
        "writes a mesh of half of its triangles, of --triangles, or as few as --error allows\n"
        "(" CLI_MESHES_WRITTEN "). The mesh is taken as it is: parts, holes, borders and sides stay, and no\n"
        "collapse joins what is apart, turns a triangle, makes two cross or crumples thin parts. Texture\n"
        "coordinates, normals, colours and materials follow, and their seams and borders stay. A target below\n"
        "what that allows gives the smallest mesh that keeps it, marked NOT MET. Several targets make a chain:\n"
        "%d in the name becomes 0, 1, 2 ..., or one .glb holds all.\n",
    .example = "bitvox simplify fixtures/knot.ply -o small.ply --triangles 4000\n"
               "bitvox simplify fixtures/knot.ply -o knot_%d.obj --error 0.02%,0.1%",
    .most = "--output-dir --triangles --error --error-kind --count --strict --attributes "
            "--lock-border --keep-vertices --threads --memory-limit --json",
    .rows = simplify_rows,
    .job = {.size = sizeof(cli_collapse_run),
            .make = make_simplify,
            .tell = tell_simplify,
            .owns = cli_collapse_owns}};
