/* cmd_refine.c - bitvox refine: voxels of several sizes, the small ones at the surface alone. */
#include "cli/cli.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

enum { REFINE_BASE = 8, REFINE_LEVELS = 6, REFINE_MOST_LEVELS = 25, REFINE_OUTER_SIDE = 256 };

#define REFINE_GRID_BYTES (UINT64_C(1) << 30) /* most bytes of a grid without --memory-limit */

typedef struct refine_job {
    bvx_mesh mesh;
    bvx_lattice base;
    bvx_octree *tree;
    bvx_octree_level level[REFINE_MOST_LEVELS + 1];
    int32_t levels;
    int kind;               /* of the output: CLI_MESH, CLI_GRID, or 0 for a tree */
    bvx_window window;      /* of the last level */
    bvx_grid grid;
    bvx_mesh surface;       /* for a mesh out */
    double seconds;
} refine_job;

/* ---- what is asked for ---- */

static int check_output_name(cli_run *run, refine_job *job)
{
    const char *const path = run->options.output;
    int32_t const format = bvx_format_of_name(path);
    job->kind = cli_kind_of_format(format);
    if (cli_is_packed(path) || (job->kind == 0 && format != BVX_FORMAT_VTU))
        return cli_usage(run, "%s: the name ends in no format that refine writes (.vtu, .npy .binvox .vox .nrrd .vti .bvx, .ply .obj .stl "
                         ".off .glb)", path);
    if (run->options.leaves && job->kind != CLI_MESH) return cli_usage(run, "--leaves makes a mesh; %s would be none", path);
    if (cli_given(run, "--cut") && !run->options.leaves) return cli_usage(run, "--cut needs --leaves");
    return CLI_DONE;
}

static int check_refine_options(cli_run *run, refine_job *job)
{
    const cli_options *const o = &run->options;
    int kind, status = check_output_name(run, job);
    if (status == CLI_DONE) status = cli_input_kind(run, o->input[0], &kind);
    if (status != CLI_DONE) return status;
    if (kind == CLI_GRID) return cli_usage(run, "%s is a grid; refine takes a mesh", cli_input_name(o->input[0]));
    job->levels = cli_given(run, "--levels") ? o->depth : REFINE_LEVELS;
    if (cli_given(run, "--expand") && job->kind != CLI_GRID) return cli_usage(run, "--expand is for grids; %s would be none", o->output);
    if (cli_given(run, "--expand") && o->expand > job->levels)
        return cli_usage(run, "--expand %" PRId32 " is beyond the last level, %" PRId32, o->expand, job->levels);
    if (cli_given(run, "--outer-levels") && o->window.count == 0) return cli_usage(run, "--outer-levels needs --window");
    if (o->outer_levels > job->levels)
        return cli_usage(run, "--outer-levels %" PRId32 " is beyond the last level, %" PRId32, o->outer_levels, job->levels);
    return cli_window_option(run, &job->window);
}

/* ---- the tree ---- */

/* A window grows to whole voxels of the level that is kept around it: by default they are at least half as large as itself, and
 * not more than REFINE_OUTER_SIDE along the lattice. */
static int32_t choose_outer_levels(const cli_run *run, const refine_job *job, int32_t base)
{
    int32_t level = 0, longest = 0;
    if (cli_given(run, "--outer-levels")) return run->options.outer_levels;
    for (int a = 0; a < 3; a++) longest = job->window.size[a] > longest ? job->window.size[a] : longest;
    if (longest == 0) return 0;
    while (level < job->levels && (INT64_C(2) << (job->levels - level - 1)) >= longest &&
           ((int64_t)base << (level + 1)) <= REFINE_OUTER_SIDE)
        level++;
    return level;
}

static int make_tree(cli_run *run, refine_job *job)
{
    const cli_options *const o = &run->options;
    const char *const path = cli_input_name(o->input[0]);
    int32_t const base = o->base_voxels != 0 ? o->base_voxels : REFINE_BASE;
    bvx_refine_options r;
    bvx_mesh_view view;
    bvx_status status;
    bvx_mesh_view_of(&job->mesh, &view);
    bvx_refine_options_init(&r, sizeof r);
    r.levels = job->levels;
    r.window = job->window;
    r.outer_levels = choose_outer_levels(run, job, base);
    r.tolerance = o->tolerance;
    status = bvx_lattice_fit(run->context, &view, base, &job->base);
    if (status != BVX_OK) return cli_fail_status(run, status, path);
    cli_stage_begin(run, "refine");
    status = bvx_refine(run->context, &view, &job->base, &r, &job->tree);
    job->seconds = cli_stage_end(run);
    if (status == BVX_OK) status = bvx_octree_lattice(run->context, job->tree, job->levels, &run->report.lattice);
    if (status == BVX_OK) status = bvx_octree_count(run->context, job->tree, job->level, REFINE_MOST_LEVELS + 1);
    if (status != BVX_OK) return cli_fail_status(run, status, path);
    run->report.has_lattice = 1;
    return CLI_DONE;
}

/* ---- out ---- */

/* The window of the last level, in voxels of another. */
static void window_at(const refine_job *job, int32_t level, bvx_window *w)
{
    int32_t const shift = job->levels - level;
    *w = job->window;
    for (int a = 0; a < 3 && job->window.size[0] != 0; a++) {
        int64_t const end = (int64_t)job->window.low[a] + job->window.size[a];
        w->low[a] = job->window.low[a] >> shift;
        w->size[a] = (int32_t)((end + (INT64_C(1) << shift) - 1) >> shift) - w->low[a];
    }
}

static int write_expanded(cli_run *run, refine_job *job)
{
    const cli_options *const o = &run->options;
    int32_t const level = cli_given(run, "--expand") ? o->expand : job->levels;
    bvx_lattice lattice;
    bvx_window window;
    bvx_status status = bvx_octree_lattice(run->context, job->tree, level, &lattice);
    uint64_t words;
    int result;
    if (status != BVX_OK) return cli_fail_status(run, status, o->output);
    window_at(job, level, &window);
    words = bvx_grid_bound(&lattice, &window);
    if (o->memory_limit == 0 && words > REFINE_GRID_BYTES / 8)
        return cli_fail(run, "%s: the grid of level %" PRId32 " would take %" PRIu64 " MiB: take .vtu, a lower --expand or a --window, or allow it "
                        "by --memory-limit", o->output, level, words >> 17);
    result = cli_check_grid_format(run, o->output, &lattice, window.size[0] != 0 ? window.size : lattice.dims);
    if (result != CLI_DONE) return result;
    cli_stage_begin(run, "expand");
    status = bvx_octree_expand(run->context, job->tree, level, o->states, &window, &job->grid);
    cli_stage_end(run);
    if (status != BVX_OK) return cli_fail_status(run, status, o->output);
    bvx_grid_count(run->context, &job->grid, &run->report.set);
    run->report.has_set = 1;
    return cli_write_grid(run, &job->grid);
}

/* The closed surface of the last level, in doubles where floats are too coarse. */
static int make_surface_mesh(cli_run *run, refine_job *job)
{
    bvx_extract_options e;
    bvx_status status;
    bvx_extract_options_init(&e, sizeof e);
    cli_stage_begin(run, "surface");
    status = bvx_extract_octree(run->context, job->tree, run->options.states, &e, &job->surface);
    if (status == BVX_ERR_RANGE) {
        e.position_type = BVX_F64;
        status = bvx_extract_octree(run->context, job->tree, run->options.states, &e, &job->surface);
    }
    cli_stage_end(run);
    if (status != BVX_OK) return cli_fail_status(run, status, run->options.output);
    return job->surface.triangle_count != 0 ? CLI_DONE : cli_fail(run, "%s: no voxel has these states", run->options.output);
}

/* The tree itself, or the mesh that was made of it. */
static int write_tree(cli_run *run, const refine_job *job)
{
    const char *const path = run->options.output;
    bvx_buffer file = {0};
    bvx_status status;
    int result;
    cli_stage_begin(run, "write");
    if (job->kind == CLI_MESH) status = bvx_write_mesh(run->context, &job->surface, bvx_format_of_name(path), &file);
    else status = bvx_write_octree(run->context, job->tree, run->options.states, BVX_FORMAT_VTU, &file);
    result = status == BVX_OK ? cli_write_output(run, 0, &file) : cli_fail_status(run, status, path);
    if (result == CLI_DONE) result = cli_keep_outputs(run);
    cli_stage_end(run);
    bvx_buffer_free(run->context, &file);
    return result;
}

static int write_result(cli_run *run, refine_job *job)
{
    int status = CLI_DONE;
    if (job->kind == CLI_GRID) return write_expanded(run, job);
    if (job->kind == CLI_MESH)
        status = run->options.leaves ? cli_make_leaf_mesh(run, job->tree, &job->surface) : make_surface_mesh(run, job);
    return status == CLI_DONE ? write_tree(run, job) : status;
}

/* ---- what is told ---- */

static bvx_octree_level sum_of(const refine_job *job)
{
    bvx_octree_level sum;
    memset(&sum, 0, sizeof sum);
    for (int32_t i = 0; i <= job->levels; i++) {
        sum.voxels += job->level[i].voxels;
        sum.split += job->level[i].split;
        sum.surface += job->level[i].surface;
        sum.inside += job->level[i].inside;
        sum.outside += job->level[i].outside;
        sum.bytes += job->level[i].bytes;
    }
    return sum;
}

static double uniform_voxels(const bvx_lattice *l)
{
    return (double)l->dims[0] * l->dims[1] * l->dims[2];
}

static void say_row(cli_run *run, const char *name, const char *dims, const bvx_octree_level *l)
{
    cli_say(run, "%5s  %-17s %12" PRIu64 " %12" PRIu64 " %12" PRIu64 " %12" PRIu64 " %12" PRIu64 " %12" PRIu64 "\n", name, dims, l->voxels,
            l->split, l->surface, l->inside, l->outside, l->bytes);
}

static void say_tree(cli_run *run, const refine_job *job)
{
    const bvx_octree_level sum = sum_of(job);
    const bvx_lattice *const last = &run->report.lattice;
    uint64_t const leaves = sum.voxels - sum.split;
    double const uniform = uniform_voxels(last);
    cli_say(run, "%s: %" PRIu64 " triangles, refined in %.1f ms\n\n", cli_input_name(run->options.input[0]), job->mesh.triangle_count,
            job->seconds * 1e3);
    cli_say(run, "level  %-17s %12s %12s %12s %12s %12s %12s\n", "voxels a side", "voxels", "split", "surface", "inside", "outside", "bytes");
    for (int32_t i = 0; i <= job->levels; i++) {
        char name[16], dims[48];
        int32_t const shift = job->levels - i;
        snprintf(name, sizeof name, "%" PRId32, i);
        snprintf(dims, sizeof dims, "%" PRId32 "x%" PRId32 "x%" PRId32, last->dims[0] >> shift, last->dims[1] >> shift, last->dims[2] >> shift);
        say_row(run, name, dims, &job->level[i]);
    }
    say_row(run, "all", "", &sum);
    cli_say(run, "\n%" PRIu64 " leaves in place of %.0f voxels of one size, %.3g %%; %.3g bytes a leaf\n", leaves, uniform,
            100.0 * (double)leaves / uniform, (double)sum.bytes / (double)leaves);
    cli_say(run, "written: %s", run->options.output);
    if (job->kind == CLI_GRID) {
        const int32_t *const n = job->grid.size;
        cli_say(run, ", %" PRId32 " x %" PRId32 " x %" PRId32 " voxels, %" PRIu64 " set", n[0], n[1], n[2], run->report.set);
    }
    if (job->kind == CLI_MESH)
        cli_say(run, ", %" PRIu64 " triangles of %" PRIu64 " vertices", job->surface.triangle_count, job->surface.vertex_count);
    cli_say(run, "\n");
}

static void report_level(cli_text *t, const bvx_octree_level *l)
{
    cli_json_count(t, "voxels", l->voxels);
    cli_json_count(t, "split", l->split);
    cli_json_count(t, "surface", l->surface);
    cli_json_count(t, "inside", l->inside);
    cli_json_count(t, "outside", l->outside);
    cli_json_count(t, "bytes", l->bytes);
}

static void report_tree(cli_run *run, const refine_job *job)
{
    cli_text *const t = &run->report.more;
    const bvx_octree_level sum = sum_of(job);
    cli_text_add(t, ", \"octree\": {\"levels\": %" PRId32, job->levels);
    cli_json_ints(t, "base", job->base.dims);
    cli_json_count(t, "leaves", sum.voxels - sum.split);
    cli_json_value(t, "uniform_voxels", uniform_voxels(&run->report.lattice));
    report_level(t, &sum);
    cli_json_value(t, "milliseconds", job->seconds * 1e3);
    cli_text_add(t, ", \"level\": [");
    for (int32_t i = 0; i <= job->levels; i++) {
        cli_text_add(t, "%s{\"level\": %" PRId32, i == 0 ? "" : ", ", i);
        report_level(t, &job->level[i]);
        cli_text_add(t, "}");
    }
    cli_text_add(t, "]");
    if (job->kind == CLI_MESH) cli_json_count(t, "triangles", job->surface.triangle_count);
    cli_text_add(t, "}");
}

static int run_refine(cli_run *run)
{
    refine_job job;
    int status;
    memset(&job, 0, sizeof job);
    status = check_refine_options(run, &job);
    if (status == CLI_DONE)
        status = job.kind == CLI_GRID ? cli_open_grid_output(run, run->options.output) : cli_open_output(run, run->options.output);
    if (status == CLI_DONE) status = cli_read_mesh(run, run->options.input[0], &job.mesh);
    if (status == CLI_DONE) status = make_tree(run, &job);
    if (status == CLI_DONE) status = write_result(run, &job);
    if (status == CLI_DONE) {
        say_tree(run, &job);
        report_tree(run, &job);
    }
    if (run->options.leaves) cli_free_leaf_mesh(&job.surface);
    else bvx_mesh_free(run->context, &job.surface);
    bvx_grid_free(run->context, &job.grid);
    bvx_octree_free(run->context, job.tree);
    bvx_mesh_free(run->context, &job.mesh);
    return status;
}

const cli_command cli_refine = {
    "refine", CLI_REFINE, 1, 1, "IN -o OUT [options]", "voxels of several sizes, small ones at the surface alone",
    "Reads a mesh (.stl .obj .ply .off, also with .gz), lays --base voxels over it and halves those that\n"
    "triangles touch --levels times; what a flood from outside cannot reach is inside. Writes the leaves\n"
    "with their level and state as .vtu (for ParaView), the voxels of one level as a grid (.npy .binvox\n"
    ".vox .nrrd .vti .bvx), or the last level's surface as a closed mesh (.ply .obj .stl .off .glb; with\n"
    "--leaves the leaves as boxes), and a table of what each level holds. With --window only a part is fine.",
    "bitvox refine fixtures/knot.ply -o knot.vtu --base 8 --levels 4\n"
    "bitvox refine fixtures/knot.ply -o boxes.ply --levels 4 --leaves --cut z=0", run_refine};
