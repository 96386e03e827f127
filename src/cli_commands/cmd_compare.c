/* cmd_compare.c - bitvox compare: what two grids or two meshes have in common.
 *
 * That they differ is an answer and no failure: the exit status tells only whether they could be compared. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

typedef struct compare_options {
    int64_t seed; /* of the random points; 0: not given */
} compare_options;

#define OWN(name) CLI_OWN(compare_options, name)

static const cli_argument compare_rows[] = {
    {.also = cli_takes_samples},
    LONG("--seed", "N", OWN(seed), 0, 4294967295.0, "another seed, other points [1]"),
    {.also = cli_takes_all},
    {0}};

static void tell_only(cli_made *made, const char *name, uint64_t voxels, uint64_t count, uint64_t largest)
{
    char text[96];
    if (count == 0) snprintf(text, sizeof text, "none");
    else if (count == 1) snprintf(text, sizeof text, "in one piece");
    else snprintf(text, sizeof text, "in %" PRIu64 " pieces, the largest of %" PRIu64, count, largest);
    if (voxels == 0) cli_tell(made, "  only in %s   none\n", name);
    else cli_tell(made, "  only in %s   %" PRIu64 " voxels, %s\n", name, voxels, text);
}

static void tell_grid_difference(const cli_run *run, const bvx_grid *g, const bvx_grid_difference *d,
                                 cli_made *made)
{
    double const either = (double)d->both + (double)d->only_a + (double)d->only_b;
    double low[3], high[3];

    cli_tell(made, "A  %s: %" PRIu64 " voxels\nB  %s: %" PRIu64 " voxels\n", cli_first_name(run), d->set_a,
             cli_input_name(run->options->input[1]), d->set_b);
    cli_tell(made, "  dims        %" PRId32 " x %" PRId32 " x %" PRId32 "\n", g->size[0], g->size[1],
             g->size[2]);
    cli_tell(made, "  both        %" PRIu64 " voxels", d->both);
    if (either > 0.0) cli_tell(made, ", %.6g %% of what either has", 100.0 * (double)d->both / either);
    cli_tell(made, "\n");
    tell_only(made, "A", d->only_a, d->components_only_a, d->largest_only_a);
    tell_only(made, "B", d->only_b, d->components_only_b, d->largest_only_b);
    if (d->only_a + d->only_b == 0) {
        cli_tell(made, "  the same\n");
        return;
    }
    for (int a = 0; a < 3; a++) {
        low[a] = g->lattice.origin[a] + ((double)g->low[a] + d->low[a]) * g->lattice.spacing[a];
        high[a] = low[a] + d->size[a] * g->lattice.spacing[a];
    }
    cli_tell(made,
             "  box         of what differs: %" PRId32 " x %" PRId32 " x %" PRId32 " voxels from %" PRId32
             ",%" PRId32 ",%" PRId32 ",\n"
             "              %.9g, %.9g, %.9g to %.9g, %.9g, %.9g\n",
             d->size[0], d->size[1], d->size[2], d->low[0], d->low[1], d->low[2], low[0], low[1], low[2],
             high[0], high[1], high[2]);
}

int cli_compare_grids(cli_run *run, const cli_input *a, const cli_input *b, bvx_grid_difference *d)
{
    char about[512], more[600] = "";
    bvx_status const status = bvx_grid_compare(run->context, &a->grid, &b->grid, d);
    if (status == BVX_OK) return CLI_DONE;
    snprintf(about, sizeof about, "%s and %s", cli_input_name(a->path), cli_input_name(b->path));
    /* Lattices that differ because a side-car is missing are the usual mistake. */
    if (status != BVX_ERR_LATTICE || a->placed == b->placed) return cli_fail_status(run, status, about);
    snprintf(more, sizeof more, "%s (%s has no side-car, so it starts at 0 and its voxels have sides of 1)",
             about, cli_input_name(a->placed ? b->path : a->path));
    return cli_fail_status(run, status, more);
}

static int compare_grids(cli_run *run, const cli_input in[2], cli_made *made)
{
    bvx_grid_difference d;
    cli_stage_begin(run, "compare");
    int const status = cli_compare_grids(run, &in[0], &in[1], &d);
    cli_stage_end(run);
    if (status != CLI_DONE) return status;
    run->report.lattice = in[0].grid.lattice;
    run->report.has_lattice = 1;

    cli_text *const t = &made->members;

    cli_text_add(t, ", \"difference\": {\"same\": %s, \"paths\": [",
                 d.only_a + d.only_b == 0 ? "true" : "false");
    cli_json_string(t, run->options->input[0]);
    cli_text_add(t, ", ");
    cli_json_string(t, run->options->input[1]);
    cli_text_add(t, "]");
    cli_json_count(t, "set_a", d.set_a);
    cli_json_count(t, "set_b", d.set_b);
    cli_json_count(t, "both", d.both);
    cli_json_count(t, "only_a", d.only_a);
    cli_json_count(t, "only_b", d.only_b);
    cli_json_count(t, "components_only_a", d.components_only_a);
    cli_json_count(t, "components_only_b", d.components_only_b);
    cli_json_count(t, "largest_only_a", d.largest_only_a);
    cli_json_count(t, "largest_only_b", d.largest_only_b);
    cli_json_ints(t, "low", d.low);
    cli_json_ints(t, "size", d.size);
    cli_text_add(t, "}");

    tell_grid_difference(run, &in[0].grid, &d, made);
    return CLI_DONE;
}

static int check_mesh(cli_run *run, const cli_input *in)
{
    cli_mesh_entry *const entry = &run->report.mesh[run->report.meshes];
    bvx_mesh_view const view = cli_view(&in->mesh);
    cli_stage_begin(run, "check %s", run->report.meshes == 0 ? "A" : "B");
    /* formats differ in what vertices they repeat */
    CLI_TRY(cli_stage_check(run, bvx_mesh_check(run->context, &view, 1, &entry->certificate),
                            cli_input_name(in->path)));
    entry->path = in->path;
    entry->colours = in->mesh.colours != NULL;
    entry->uvs = in->mesh.uvs != NULL;
    run->report.meshes++;
    return CLI_DONE;
}

static void tell_mesh(cli_made *made, const char *name, const cli_mesh_entry *m)
{
    const bvx_certificate *const c = &m->certificate;
    cli_tell(made, "%s  %s\n", name, cli_input_name(m->path));
    cli_tell(made, "  triangles   %" PRIu64 " of %" PRIu64 " vertices, %" PRIu64 " components\n",
             c->triangles, c->vertices, c->components);
    cli_tell(made, "  surface     %s, %s, %s\n", c->closed ? "closed" : "not closed",
             c->edge_manifold && c->vertex_manifold ? "manifold" : "not manifold",
             c->oriented ? "oriented" : "not oriented");
    /* The sum of an open mesh's triangles is no volume: it changes when the mesh is moved. */
    cli_tell(made, "  volume      %.9g%s\n  area        %.9g\n", c->volume,
             c->closed ? "" : " (of an open mesh: depends on its position)", c->area);
}

static void tell_way(cli_made *made, const char *way, double mean, double most, double diagonal)
{
    double const part = diagonal > 0.0 ? 100.0 / diagonal : 0.0;
    cli_tell(made, "  %-10s %11.4g %8.4f%% %13.4g %8.4f%%\n", way, mean, mean * part, most, most * part);
}

static int compare_meshes(cli_run *run, const cli_input in[2], cli_made *made)
{
    const compare_options *const own = run->own;
    uint64_t const samples = cli_samples(run);
    uint64_t const seed = cli_given(run, "--seed") ? (uint64_t)own->seed : CLI_SEED;
    bvx_distance_report d;

    CLI_TRY(check_mesh(run, &in[0]));
    CLI_TRY(check_mesh(run, &in[1]));
    if (samples != 0) {
        bvx_mesh_view const a = cli_view(&in[0].mesh), b = cli_view(&in[1].mesh);
        cli_stage_begin(run, "distance");
        bvx_status const measured = bvx_mesh_distance(run->context, &a, &b, samples, seed, &d);
        cli_stage_end(run);
        if (measured != BVX_OK) return cli_fail_status(run, measured, NULL);
    }
    double const diagonal = cli_diagonal(run->report.mesh[0].certificate.box.low,
                                         run->report.mesh[0].certificate.box.high);
    tell_mesh(made, "A", &run->report.mesh[0]);
    tell_mesh(made, "B", &run->report.mesh[1]);
    if (samples == 0) return CLI_DONE;
    cli_tell(made,
             "distances in the meshes' unit and in %% of A's diagonal, %.6g, from %" PRIu64
             " random points on each mesh, seed %" PRIu64 "\n",
             diagonal, d.samples, d.seed);
    cli_tell(made, "  %22s%24s\n", "mean", "max");
    /* Two ways, since a point of A may be near B while B has parts far from A. */
    tell_way(made, "A to B", d.mean_a_to_b, d.max_a_to_b, diagonal);
    tell_way(made, "B to A", d.mean_b_to_a, d.max_b_to_a, diagonal);
    tell_way(made, "both ways", d.mean, d.max, diagonal);

    cli_text *const t = &made->members;

    cli_text_add(t, ", \"distance\": {\"samples\": %" PRIu64, d.samples);
    cli_json_count(t, "seed", d.seed);
    cli_json_value(t, "mean", d.mean);
    cli_json_value(t, "max", d.max);
    cli_json_value(t, "mean_a_to_b", d.mean_a_to_b);
    cli_json_value(t, "max_a_to_b", d.max_a_to_b);
    cli_json_value(t, "mean_b_to_a", d.mean_b_to_a);
    cli_json_value(t, "max_b_to_a", d.max_b_to_a);
    cli_json_value(t, "normal_a_to_b", d.normal_a_to_b);
    cli_json_value(t, "normal_b_to_a", d.normal_b_to_a);
    cli_json_value(t, "diagonal", diagonal);
    cli_text_add(t, "}");
    return CLI_DONE;
}

static int make_compare(cli_run *run, void *work, cli_made *made)
{
    const cli_options *const o = run->options;
    cli_input *const in = work;
    int kind[2];

    made->untitled = 1;
    for (int i = 0; i < 2; i++) CLI_TRY(cli_input_kind(run, o->input[i], &kind[i]));
    /* A mesh has no voxels and a grid no points to measure from; which should change is the user's choice. */
    if (kind[0] != kind[1])
        return cli_usage(
            run, "a mesh and a grid have nothing to compare: voxelize the mesh on the grid's lattice, "
                 "or make a mesh of the grid with 'bitvox lod'");
    if (kind[0] == CLI_MESH && o->samples == 0 && cli_given(run, "--seed"))
        return cli_usage(run, "--seed has no use with --samples 0");
    if (kind[0] != CLI_MESH && o->samples >= 0)
        return cli_usage(run, "--samples is for meshes; grids are compared voxel by voxel");
    if (kind[0] != CLI_MESH && cli_given(run, "--seed"))
        return cli_usage(run, "--seed is for meshes; grids are compared voxel by voxel");
    for (int i = 0; i < 2; i++) CLI_TRY(cli_read_input(run, o->input[i], &in[i]));
    return in[0].kind == CLI_MESH ? compare_meshes(run, in, made) : compare_grids(run, in, made);
}

static const cli_owned compare_owns[] = {{CLI_OWNS_INPUT, 2, 0, sizeof(cli_input)}, {0}};

const cli_command cli_compare = {
    .name = "compare",
    .bit = CLI_COMPARE,
    .least_inputs = 2,
    .most_inputs = 2,
    .usage = "A B [options]",
    .does = "what two grids or two meshes have in common, and how far apart they are",
    .details =
        "Grids of one lattice: voxels of both and of only one, in how many pieces and where.\n"
        "Meshes: counts, volumes, whether they are closed, manifold and oriented, and the distances from\n"
        "random points on each to the other. The exit status is 0 whether they differ or not;\n"
        "--json reports it to programs.",
    .example = "bitvox convert fixtures/knot.ply -o knot.stl\n"
               "bitvox compare fixtures/knot.ply knot.stl",
    .rows = compare_rows,
    .own = sizeof(compare_options),
    .job = {.size = sizeof(cli_input[2]), .make = make_compare, .owns = compare_owns}};
