/* cmd_lod.c - bitvox lod: a chain of closed meshes, with a table of what each level costs and how near it stays.
 *
 * The mesh is voxelized once; each level is one call of bvx_build_lods, timed alone. Everything is written at the end,
 * so a failure leaves no part of a chain. */
#include "cli/cli.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { DEFAULT_SAMPLES = 20000, DISTANCE_SEED = 1, RATIO_WANTED = 8 };

#define GRID_BYTES_DEFAULT (UINT64_C(1) << 30) /* most bytes of the grid without --memory-limit */

typedef struct lod_chain {
    bvx_mesh input;
    bvx_mesh_view view;
    bvx_certificate certificate; /* of the input */
    double diagonal;
    bvx_grid solid;
    bvx_solid_report solid_report;
    double solid_seconds;
    int32_t resolution;          /* of the solid */
    const char *chosen;          /* how */
    int by_triangles, count;
    bvx_mesh mesh[CLI_MAX_LEVELS];
    char *path[CLI_MAX_LEVELS];
    bvx_lod_report lod[CLI_MAX_LEVELS];
    bvx_distance_report distance[CLI_MAX_LEVELS];
} lod_chain;

/* ---- what is asked for ---- */

/* The pattern with its %d replaced. */
static char *level_path(const char *pattern, int level)
{
    size_t const room = strlen(pattern) + 16;
    const char *const place = strstr(pattern, "%d");
    char *const path = malloc(room);
    if (path == NULL) return NULL;
    if (place == NULL) snprintf(path, room, "%s", pattern);
    else snprintf(path, room, "%.*s%d%s", (int)(place - pattern), pattern, level, place + 2);
    return path;
}

static int check_lod_options(cli_run *run, lod_chain *c)
{
    const cli_options *const o = &run->options;
    int32_t const format = bvx_format_of_name(o->output);
    const char *const place = strstr(o->output, "%d");
    size_t const n = strlen(o->output);
    if ((format != BVX_FORMAT_STL && format != BVX_FORMAT_OBJ && format != BVX_FORMAT_PLY) ||
        (n > 3 && strcmp(o->output + n - 3, ".gz") == 0))
        return cli_usage(run, "%s: the name ends in no mesh format that is written (.ply .stl .obj)", o->output);
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

static int32_t level_resolution(const cli_run *run, int level)
{
    static const int32_t usual[3] = {64, 32, 16};
    return run->options.levels.count != 0 ? (int32_t)run->options.levels.value[level] : usual[level];
}

/* ---- the solid ---- */

/* Samples along the longest axis of the finest level. For a count of triangles: marching cubes makes about three for
 * each square of the surface as large as a sample. */
static double finest_level(const cli_run *run, const lod_chain *c)
{
    double finest = 1.0, longest = 0.0;
    if (c->by_triangles && !(c->certificate.area > 0.0)) return finest;
    if (!c->by_triangles) {
        for (int i = 0; i < c->count; i++) finest = level_resolution(run, i) > finest ? level_resolution(run, i) : finest;
        return finest;
    }
    for (int a = 0; a < 3; a++)
        longest = c->certificate.high[a] - c->certificate.low[a] > longest ? c->certificate.high[a] - c->certificate.low[a] : longest;
    for (int i = 0; i < c->count; i++) {
        double const more = run->options.collapse != 0.0 ? run->options.collapse : 1.0; /* before edges collapse */
        double const squares = (double)run->options.triangles.value[i] * more / 3.0;
        double const r = sqrt(squares * longest * longest / c->certificate.area);
        finest = r > finest ? r : finest;
    }
    return floor(finest + 0.5);
}

static bvx_status fit(cli_run *run, const lod_chain *c, int32_t resolution, bvx_lattice *lattice)
{
    bvx_lattice_options o;
    bvx_lattice_options_init(&o, sizeof o);
    o.resolution = resolution;
    o.padding = run->options.padding;
    return bvx_lattice_fit_with(run->context, &c->view, &o, lattice);
}

/* Bytes that the solid may take: half of what the limit leaves beside the mesh and its snapped copy; the other half is
 * for rows in work, for the levels and for checking them. */
static uint64_t room_for_solid(const cli_run *run, const lod_chain *c)
{
    uint64_t const beside = bvx_memory_used(run->context) + 16 * c->view.vertex_count + 4 * c->view.triangle_count;
    if (run->context_limit == 0) return GRID_BYTES_DEFAULT;
    return run->context_limit > beside ? (run->context_limit - beside) / 2 : 0;
}

/* The resolution of the solid: given, or RATIO_WANTED times the finest level where memory allows, else what it allows,
 * and never below the finest level. */
static int choose_resolution(cli_run *run, lod_chain *c)
{
    double const finest = finest_level(run, c), wanted = finest * RATIO_WANTED;
    uint64_t const room = room_for_solid(run, c);
    int32_t low, high; /* low is taken in any case */
    if (run->options.resolution.count != 0) {
        c->resolution = (int32_t)run->options.resolution.value[0];
        c->chosen = "given";
        return CLI_DONE;
    }
    low = finest < 33554432.0 ? (int32_t)finest : 33554432;
    high = wanted < 33554432.0 ? (int32_t)wanted : 33554432;
    c->chosen = "8 x the finest level";
    for (int32_t try = high; low < high; try = low + (high - low + 1) / 2) {
        bvx_lattice lattice;
        bvx_status const status = fit(run, c, try, &lattice);
        uint64_t const words = status == BVX_OK ? bvx_grid_bound(&lattice, NULL) : UINT64_MAX;
        if (status != BVX_OK && status != BVX_ERR_RANGE) return cli_fail_status(run, status, run->options.input[0]);
        if (words <= room / 8) {
            low = try;
        } else {
            high = try - 1;
            c->chosen = "what memory allows";
        }
    }
    c->resolution = low;
    return CLI_DONE;
}

static int make_solid(cli_run *run, lod_chain *c)
{
    const char *const path = run->options.input[0];
    bvx_voxelize_options v;
    double start = cli_seconds();
    bvx_status status = bvx_mesh_check(run->context, &c->view, 1, &c->certificate); /* the solid asks for places, not for numbers */
    cli_stage(run, start, "check input");
    if (status != BVX_OK) return cli_fail_status(run, status, path);
    for (int a = 0; a < 3; a++) {
        double const side = c->certificate.high[a] - c->certificate.low[a];
        c->diagonal += side * side;
    }
    c->diagonal = sqrt(c->diagonal);
    if (choose_resolution(run, c) != CLI_DONE) return CLI_FAILED;
    start = cli_seconds();
    status = fit(run, c, c->resolution, &run->report.lattice);
    if (status != BVX_OK) return cli_fail_status(run, status, path);
    run->report.has_lattice = 1;
    bvx_voxelize_options_init(&v, sizeof v);
    v.fill = run->options.fill;
    v.report = &c->solid_report;
    status = bvx_voxelize_solid(run->context, &c->view, &run->report.lattice, &v, &c->solid);
    c->solid_seconds = cli_seconds() - start;
    cli_stage(run, start, "voxelize");
    if (status != BVX_OK) return cli_fail_status(run, status, path);
    bvx_grid_count(run->context, &c->solid, &run->report.set);
    run->report.has_set = 1;
    if (run->report.set == 0) return cli_fail(run, "%s: no voxel's centre lies inside the mesh; nothing is left to make levels of", path);
    if (c->solid_report.unbalanced_rows != 0)
        cli_warn(run, "%" PRIu64 " rows do not balance: the mesh has holes or flipped triangles there", c->solid_report.unbalanced_rows);
    return CLI_DONE;
}

/* ---- the levels ---- */

static int make_level(cli_run *run, lod_chain *c, int i)
{
    const cli_options *const o = &run->options;
    cli_mesh_entry *const entry = &run->report.mesh[i];
    int32_t const resolution = c->by_triangles ? 0 : level_resolution(run, i);
    uint64_t const target = c->by_triangles ? (uint64_t)o->triangles.value[i] : 0;
    bvx_mesh_view view;
    bvx_lod_options l;
    bvx_status status;
    double start;
    bvx_lod_options_init(&l, sizeof l);
    if (o->method != 0) l.method = o->method;
    if (o->threshold != 0.0) l.threshold = o->threshold;
    l.edge_samples = o->edge_samples;
    l.collapse = o->collapse;
    if (c->by_triangles) l.target_triangles = &target;
    else l.resolutions = &resolution;
    l.source_triangles = c->input.triangle_count;
    l.reports = &c->lod[i];
    start = cli_seconds();
    status = bvx_build_lods(run->context, &c->solid, &l, 1, &c->mesh[i]);
    if (status == BVX_ERR_RANGE && strstr(bvx_last_message(run->context), "take f64") != NULL) { /* far from the origin */
        l.position_type = BVX_F64;
        status = bvx_build_lods(run->context, &c->solid, &l, 1, &c->mesh[i]);
    }
    entry->milliseconds = (cli_seconds() - start) * 1e3;
    cli_stage(run, start, "level %d", i);
    if (status != BVX_OK) {
        char about[32];
        snprintf(about, sizeof about, "level %d", i);
        return cli_fail_status(run, status, about);
    }
    bvx_mesh_view_of(&c->mesh[i], &view);
    start = cli_seconds();
    status = bvx_mesh_check(run->context, &view, 0, &entry->certificate);
    cli_stage(run, start, "check %d", i);
    if (status != BVX_OK) return cli_fail_status(run, status, c->path[i]);
    entry->path = c->path[i];
    entry->lod = &c->lod[i];
    entry->rate = (double)c->mesh[i].triangle_count / (double)c->input.triangle_count;
    run->report.meshes = i + 1;
    if (c->lod[i].exceeds_source)
        cli_warn(run, "level %d has more triangles than the input: %" PRIu64 " beside %" PRIu64, i, c->mesh[i].triangle_count,
                 c->input.triangle_count);
    return cli_interrupted() ? cli_fail_interrupted(run) : CLI_DONE;
}

static int measure_level(cli_run *run, lod_chain *c, int i)
{
    uint64_t const samples = run->options.samples < 0 ? DEFAULT_SAMPLES : (uint64_t)run->options.samples;
    double const start = cli_seconds();
    bvx_mesh_view view;
    bvx_status status;
    if (samples == 0) return CLI_DONE;
    bvx_mesh_view_of(&c->mesh[i], &view);
    status = bvx_mesh_distance(run->context, &view, &c->view, samples, DISTANCE_SEED, &c->distance[i]);
    cli_stage(run, start, "distance %d", i);
    if (status != BVX_OK) return cli_fail_status(run, status, c->path[i]);
    run->report.mesh[i].distance = &c->distance[i];
    return CLI_DONE;
}

static int write_level(cli_run *run, lod_chain *c, int i)
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

static void say_head(cli_run *run, const lod_chain *c)
{
    const bvx_certificate *const in = &c->certificate;
    const bvx_lattice *const l = &run->report.lattice;
    cli_say(run, "%s: %" PRIu64 " triangles, %s, %s, %s; diagonal %.6g\n", run->options.input[0], c->input.triangle_count,
            in->closed ? "closed" : "not closed", in->edge_manifold && in->vertex_manifold ? "manifold" : "not manifold",
            in->oriented ? "oriented" : "not oriented", c->diagonal);
    cli_say(run, "solid: %" PRId32 " x %" PRId32 " x %" PRId32 " voxels (resolution %" PRId32 ", %s), %" PRIu64 " set, %.1f ms\n\n", l->dims[0],
            l->dims[1], l->dims[2], c->resolution, c->chosen, run->report.set, c->solid_seconds * 1e3);
}

static void say_levels(cli_run *run, const lod_chain *c)
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
    cli_say(run, "  %9.3g %6.3f%%", d, diagonal > 0.0 ? 100.0 * d / diagonal : 0.0);
}

static void say_distances(cli_run *run, const lod_chain *c)
{
    if (run->report.mesh[0].distance == NULL) return;
    cli_say(run, "\ndistances in the mesh's unit and in %% of its diagonal, from %" PRIu64 " random points on each mesh, seed %d\n",
            c->distance[0].samples, DISTANCE_SEED);
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

static int make_chain(cli_run *run, lod_chain *c)
{
    int status = cli_read_mesh(run, run->options.input[0], &c->input);
    double start;
    if (status != CLI_DONE) return status;
    bvx_mesh_view_of(&c->input, &c->view);
    status = make_solid(run, c);
    for (int i = 0; i < c->count && status == CLI_DONE; i++) status = make_level(run, c, i);
    for (int i = 0; i < c->count && status == CLI_DONE; i++) status = measure_level(run, c, i);
    start = cli_seconds();
    for (int i = 0; i < c->count && status == CLI_DONE; i++) status = write_level(run, c, i);
    if (status == CLI_DONE) status = cli_keep_outputs(run);
    cli_stage(run, start, "write");
    if (status != CLI_DONE) return status;
    say_head(run, c);
    say_levels(run, c);
    say_distances(run, c);
    cli_say(run, "\n");
    for (int i = 0; i < c->count; i++) cli_say(run, "%s%s", i == 0 ? "written: " : ", ", c->path[i]);
    cli_say(run, "\n");
    return CLI_DONE;
}

static int open_level_outputs(cli_run *run, lod_chain *c)
{
    for (int i = 0; i < c->count; i++) {
        int status;
        c->path[i] = level_path(run->options.output, i);
        if (c->path[i] == NULL) return cli_fail(run, "no memory for a file's name");
        status = cli_open_output(run, c->path[i]);
        if (status != CLI_DONE) return status;
    }
    return CLI_DONE;
}

static int run_lod(cli_run *run)
{
    static lod_chain c; /* zeroed; the report points into it until the program ends */
    int status = check_lod_options(run, &c);
    if (status == CLI_DONE) status = open_level_outputs(run, &c);
    if (status == CLI_DONE) status = make_chain(run, &c);
    for (int i = 0; i < c.count; i++) bvx_mesh_free(run->context, &c.mesh[i]);
    bvx_grid_free(run->context, &c.solid);
    bvx_mesh_free(run->context, &c.input);
    return status;
}

const cli_command cli_lod = {
    "lod", CLI_LOD, 1, "IN -o OUT_%d.EXT [options]", "a chain of closed meshes of several sizes from one mesh",
    "Reads a mesh (.stl .obj .ply, also with .gz), voxelizes it once and writes one closed, manifold\n"
    "mesh a level (.ply .stl .obj; %d becomes 0, 1, 2 ...), with a table of size, time and distance.",
    "bitvox lod fixtures/knot.ply -o knot_%d.ply --levels 64,32,16", run_lod};
