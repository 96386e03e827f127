/* cmd_lod.c - bitvox lod: a chain of closed meshes, with a table of what each level costs and how near it stays.
 *
 * The solid is made once (lod_input.c); each level is one call of bvx_build_lods, timed alone. Everything is written at the
 * end, so a failure leaves no part of a chain. */
#include "cli/lod_chain.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_SAMPLES = 20000, DISTANCE_SEED = 1 };

/* ---- what is asked for ---- */

char *cli_numbered_path(const char *pattern, int64_t number)
{
    size_t const room = strlen(pattern) + 32;
    const char *const place = strstr(pattern, "%d");
    char *const path = malloc(room);
    if (path == NULL) return NULL;
    if (place == NULL) snprintf(path, room, "%s", pattern);
    else snprintf(path, room, "%.*s%" PRId64 "%s", (int)(place - pattern), pattern, number, place + 2);
    return path;
}

/* Options that speak of voxelizing, or of what only meshes have. */
static int refuse_for_grid(cli_run *run)
{
    static const char *const option[] = {"--resolution", "--padding", "--fill", "--close-gaps", "--carry"};
    for (size_t i = 0; i < sizeof option / sizeof option[0]; i++)
        if (cli_given(run, option[i]))
            return cli_usage(run, "%s is for meshes; %s is a grid", option[i], cli_input_name(run->options.input[0]));
    return CLI_DONE;
}

static int check_lod_options(cli_run *run, cli_chain *c)
{
    const cli_options *const o = &run->options;
    int32_t const format = bvx_format_of_name(o->output);
    const char *const place = strstr(o->output, "%d");
    int const status = cli_input_kind(run, o->input[0], &c->kind);
    if (status != CLI_DONE) return status;
    if (cli_kind_of_format(format) != CLI_MESH || cli_is_packed(o->output))
        return cli_usage(run, "%s: the name ends in no mesh format that is written (.ply .obj .stl .off .glb)", o->output);
    if (c->kind == CLI_GRID && refuse_for_grid(run) != CLI_DONE) return CLI_USAGE;
    if (cli_check_fill(run) != CLI_DONE) return CLI_USAGE;
    if (o->carry && format == BVX_FORMAT_STL)
        return cli_usage(run, "%s: .stl holds neither colours nor texture coordinates; take .ply, .obj or .glb for --carry", o->output);
    if (o->levels.count != 0 && o->triangles.count != 0) return cli_usage(run, "--levels and --triangles exclude each other");
    if (o->edge_samples != 0 && o->method == BVX_LOD_COVERAGE)
        return cli_usage(run, "--edge-samples needs --method edge-ratio");
    if (o->collapse != 0.0 && o->triangles.count == 0) return cli_usage(run, "--collapse needs --triangles");
    c->by_triangles = o->triangles.count != 0;
    c->count = c->by_triangles ? o->triangles.count : o->levels.count != 0 ? o->levels.count : 3;
    if (place == NULL && c->count > 1)
        return cli_usage(run, "%s: %d levels need %%d in the name, for the number of each", o->output, c->count);
    if (place != NULL && strstr(place + 2, "%d") != NULL) return cli_usage(run, "%s: %%d stands twice in the name", o->output);
    for (int i = 0; i < o->levels.count && o->resolution.count != 0; i++)
        if (o->levels.value[i] > o->resolution.value[0])
            return cli_usage(run, "--resolution %" PRId64 " is below level %" PRId64 "; it must be at least the finest level",
                             o->resolution.value[0], o->levels.value[i]);
    return CLI_DONE;
}

/* ---- the levels ---- */

static int make_level(cli_run *run, cli_chain *c, int i)
{
    const cli_options *const o = &run->options;
    cli_mesh_entry *const entry = &run->report.mesh[i];
    int32_t const resolution = c->by_triangles ? 0 : cli_level_resolution(run, c, i);
    uint64_t const target = c->by_triangles ? (uint64_t)o->triangles.value[i] : 0;
    bvx_mesh_view view;
    bvx_lod_options l;
    bvx_status status;
    bvx_lod_options_init(&l, sizeof l);
    if (o->method != 0) l.method = o->method;
    if (o->threshold != 0.0) l.threshold = o->threshold;
    l.edge_samples = o->edge_samples;
    l.collapse = o->collapse;
    if (c->by_triangles) l.target_triangles = &target;
    else l.resolutions = &resolution;
    l.source_triangles = c->input_triangles;
    l.reports = &c->lod[i];
    cli_stage_begin(run, "level %d", i);
    status = bvx_build_lods(run->context, &c->solid, &l, 1, &c->mesh[i]);
    if (status == BVX_ERR_RANGE && strstr(bvx_last_message(run->context), "take f64") != NULL) { /* far from the origin */
        l.position_type = BVX_F64;
        status = bvx_build_lods(run->context, &c->solid, &l, 1, &c->mesh[i]);
    }
    entry->milliseconds = cli_stage_end(run) * 1e3;
    if (status != BVX_OK) {
        char about[32];
        snprintf(about, sizeof about, "level %d", i);
        return cli_fail_status(run, status, about);
    }
    if (o->carry) {
        cli_stage_begin(run, "carry %d", i);
        status = bvx_mesh_carry(run->context, &c->input, &c->mesh[i]);
        cli_stage_end(run);
        if (status != BVX_OK) return cli_fail_status(run, status, c->path[i]);
    }
    entry->colours = c->mesh[i].colours != NULL;
    entry->uvs = c->mesh[i].uvs != NULL;
    bvx_mesh_view_of(&c->mesh[i], &view);
    cli_stage_begin(run, "check %d", i);
    status = bvx_mesh_check(run->context, &view, 0, &entry->certificate);
    cli_stage_end(run);
    if (status != BVX_OK) return cli_fail_status(run, status, c->path[i]);
    entry->path = c->path[i];
    entry->lod = &c->lod[i];
    entry->rate = (double)c->mesh[i].triangle_count / (double)c->input_triangles;
    run->report.meshes = i + 1;
    if (c->lod[i].exceeds_source)
        cli_warn(run, "level %d has more triangles than the input: %" PRIu64 " beside %" PRIu64, i, c->mesh[i].triangle_count,
                 c->input_triangles);
    return cli_interrupted() ? cli_fail_interrupted(run) : CLI_DONE;
}

static int measure_level(cli_run *run, cli_chain *c, int i)
{
    uint64_t const samples = run->options.samples < 0 ? DEFAULT_SAMPLES : (uint64_t)run->options.samples;
    bvx_mesh_view view;
    bvx_status status;
    if (samples == 0) return CLI_DONE;
    bvx_mesh_view_of(&c->mesh[i], &view);
    cli_stage_begin(run, "distance %d", i);
    status = bvx_mesh_distance(run->context, &view, &c->view, samples, DISTANCE_SEED, &c->distance[i]);
    cli_stage_end(run);
    if (status != BVX_OK) return cli_fail_status(run, status, c->path[i]);
    run->report.mesh[i].distance = &c->distance[i];
    return CLI_DONE;
}

void cli_warn_of_lost(cli_run *run, const char *path, const bvx_mesh *mesh)
{
    int32_t const format = bvx_format_of_name(path);
    int const colours = mesh->colours != NULL && format == BVX_FORMAT_STL;
    int const uvs = mesh->uvs != NULL && (format == BVX_FORMAT_STL || format == BVX_FORMAT_OFF);
    if (!colours && !uvs) return;
    cli_warn(run, "%s: .%s cannot hold %s%s%s, which are lost", path, cli_format_name(format), colours ? "colours" : "",
             colours && uvs ? " and " : "", uvs ? "texture coordinates" : "");
}

static int write_level(cli_run *run, cli_chain *c, int i)
{
    bvx_buffer file = {0};
    bvx_status const status = bvx_write_mesh(run->context, &c->mesh[i], bvx_format_of_name(c->path[i]), &file);
    int result = status == BVX_OK ? cli_write_output(run, i, &file) : cli_fail_status(run, status, c->path[i]);
    bvx_buffer_free(run->context, &file);
    return result;
}

/* ---- the table ---- */

static const char *yes_or_not(const bvx_certificate *c)
{
    return c->closed && c->edge_manifold && c->vertex_manifold && c->oriented ? "yes" : "NO";
}

static void say_head(cli_run *run, const cli_chain *c)
{
    const bvx_certificate *const in = &c->certificate;
    const bvx_lattice *const l = &run->report.lattice;
    if (c->kind == CLI_GRID) {
        const int32_t *const n = c->solid.size;
        cli_say(run, "%s: %" PRId32 " x %" PRId32 " x %" PRId32 " voxels, %" PRIu64 " set; their surface has %" PRIu64 " triangles; diagonal %.6g\n\n",
                cli_input_name(run->options.input[0]), n[0], n[1], n[2], run->report.set, c->input_triangles, c->diagonal);
        return;
    }
    cli_say(run, "%s: %" PRIu64 " triangles, %s, %s, %s; diagonal %.6g\n", cli_input_name(run->options.input[0]), c->input.triangle_count,
            in->closed ? "closed" : "not closed", in->edge_manifold && in->vertex_manifold ? "manifold" : "not manifold",
            in->oriented ? "oriented" : "not oriented", c->diagonal);
    cli_say(run, "solid: %" PRId32 " x %" PRId32 " x %" PRId32 " voxels (resolution %" PRId32 ", %s), %" PRIu64 " set, %.1f ms\n\n", l->dims[0],
            l->dims[1], l->dims[2], c->resolution, c->chosen, run->report.set, c->solid_seconds * 1e3);
}

static void say_levels(cli_run *run, const cli_chain *c)
{
    cli_say(run, "level  resolution      ratio  triangles  simplification rate        ms  closed, manifold, oriented\n");
    for (int i = 0; i < c->count; i++) {
        const bvx_lod_report *const l = &c->lod[i];
        const cli_mesh_entry *const m = &run->report.mesh[i];
        char size[48];
        snprintf(size, sizeof size, "%" PRId32 "x%" PRId32 "x%" PRId32, l->resolution[0], l->resolution[1], l->resolution[2]);
        cli_say(run, "%5d  %-14s %6.2f %10" PRIu64 " %19.2f%% %9.2f  %s\n", i, size, l->ratio[0], m->certificate.triangles,
                m->rate * 100.0, m->milliseconds, yes_or_not(&m->certificate));
    }
}

static void say_distance(cli_run *run, double d, double diagonal)
{
    double const part = d / diagonal;
    if (diagonal > 0.0 && diagonal - diagonal == 0.0 && part - part == 0.0) cli_say(run, "  %9.3g %6.3f%%", d, 100.0 * part);
    else cli_say(run, "  %9.3g %7s", d, "-");
}

static void say_distances(cli_run *run, const cli_chain *c)
{
    if (run->report.mesh[0].distance == NULL) return;
    cli_say(run, "\ndistances %sin the %s's unit and in %% of its diagonal, from %" PRIu64 " random points on each mesh, seed %d\n",
            c->kind == CLI_GRID ? "to the voxels' surface, " : "", c->kind == CLI_GRID ? "grid" : "mesh", c->distance[0].samples,
            DISTANCE_SEED);
    cli_say(run, "%43s%38s\nlevel%19s%19s%19s%19s\n", "level to input", "input to level", "mean", "max", "mean", "max");
    for (int i = 0; i < c->count; i++) {
        const bvx_distance_report *const d = &c->distance[i];
        cli_say(run, "%5d", i);
        say_distance(run, d->mean_a_to_b, c->diagonal);
        say_distance(run, d->max_a_to_b, c->diagonal);
        say_distance(run, d->mean_b_to_a, c->diagonal);
        say_distance(run, d->max_b_to_a, c->diagonal);
        cli_say(run, "\n");
    }
}

static int make_chain(cli_run *run, cli_chain *c)
{
    int status = cli_open_chain(run, c);
    for (int i = 0; i < c->count && status == CLI_DONE; i++) status = make_level(run, c, i);
    for (int i = 0; i < c->count && status == CLI_DONE; i++) status = measure_level(run, c, i);
    if (status == CLI_DONE) cli_stage_begin(run, "write");
    for (int i = 0; i < c->count && status == CLI_DONE; i++) status = write_level(run, c, i);
    if (status == CLI_DONE) status = cli_keep_outputs(run);
    if (status != CLI_DONE) return status;
    cli_stage_end(run);
    if (run->options.carry) cli_warn_of_lost(run, c->path[0], &c->mesh[0]);
    say_head(run, c);
    say_levels(run, c);
    say_distances(run, c);
    cli_say(run, "\n");
    for (int i = 0; i < c->count; i++) cli_say(run, "%s%s", i == 0 ? "written: " : ", ", c->path[i]);
    cli_say(run, "\n");
    return CLI_DONE;
}

static int open_level_outputs(cli_run *run, cli_chain *c)
{
    for (int i = 0; i < c->count; i++) {
        int status;
        c->path[i] = cli_numbered_path(run->options.output, i);
        if (c->path[i] == NULL) return cli_fail(run, "no memory for a file's name");
        status = cli_open_output(run, c->path[i]);
        if (status != CLI_DONE) return status;
    }
    return CLI_DONE;
}

static int run_lod(cli_run *run)
{
    static cli_chain c; /* zeroed; the report points into it until the program ends */
    int status = check_lod_options(run, &c);
    if (status == CLI_DONE) status = open_level_outputs(run, &c);
    if (status == CLI_DONE) status = make_chain(run, &c);
    for (int i = 0; i < c.count; i++) bvx_mesh_free(run->context, &c.mesh[i]);
    bvx_grid_free(run->context, &c.solid);
    bvx_mesh_free(run->context, &c.input);
    return status;
}

const cli_command cli_lod = {
    "lod", CLI_LOD, 1, 1, "IN -o OUT_%d.EXT [options]", "a chain of closed meshes of several sizes from one mesh, grid or volume",
    "Reads a mesh (.stl .obj .ply .off, also with .gz) and voxelizes it once, or reads a grid (.npy .binvox\n"
    ".vox .nrrd .vti .bvx) or with --level, --range or --label a volume, and writes one closed, manifold mesh a level (.ply .obj .stl .off .glb; %d\n"
    "becomes 0, 1, 2 ...), with a table of size, time and distance.",
    "bitvox lod fixtures/knot.ply -o knot_%d.ply --levels 64,32,16\n"
    "bitvox lod fixtures/waves.nhdr -o waves_%d.ply --level 120 --levels 24,12", run_lod};
