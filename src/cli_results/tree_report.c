/* tree_report.c - what is reported of an octree: a table of its levels, and the same for programs. */
#include "cli_results/results.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static bvx_octree_level sum_of(const cli_tree *t)
{
    bvx_octree_level sum = {0};
    for (int32_t i = 0; i <= t->levels; i++) {
        sum.voxels += t->level[i].voxels;
        sum.split += t->level[i].split;
        sum.surface += t->level[i].surface;
        sum.inside += t->level[i].inside;
        sum.outside += t->level[i].outside;
        sum.bytes += t->level[i].bytes;
    }
    return sum;
}

static double uniform_voxels(const bvx_lattice *l)
{
    return (double)l->dims[0] * l->dims[1] * l->dims[2];
}

static void tell_row(cli_made *made, const char *name, const char *dims, const bvx_octree_level *l)
{
    cli_tell(made,
             "%5s  %-17s %12" PRIu64 " %12" PRIu64 " %12" PRIu64 " %12" PRIu64 " %12" PRIu64 " %12" PRIu64
             "\n",
             name, dims, l->voxels, l->split, l->surface, l->inside, l->outside, l->bytes);
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

void cli_tell_levels(const cli_run *run, const cli_tree *t, cli_made *made)
{
    const bvx_octree_level sum = sum_of(t);
    const bvx_lattice *const last = &run->report.lattice;
    uint64_t const leaves = sum.voxels - sum.split;
    double const uniform = uniform_voxels(last);

    cli_tell(made, "level  %-17s %12s %12s %12s %12s %12s %12s\n", "voxels a side", "voxels", "split",
             "surface", "inside", "outside", "bytes");
    for (int32_t i = 0; i <= t->levels; i++) {
        char name[16], dims[48];
        int32_t const shift = t->levels - i;
        snprintf(name, sizeof name, "%" PRId32, i);
        snprintf(dims, sizeof dims, "%" PRId32 "x%" PRId32 "x%" PRId32, last->dims[0] >> shift,
                 last->dims[1] >> shift, last->dims[2] >> shift);
        tell_row(made, name, dims, &t->level[i]);
    }
    tell_row(made, "all", "", &sum);
    cli_tell(made, "\n%" PRIu64 " leaves in place of %.0f voxels of one size, %.3g %%; %.3g bytes a leaf\n",
             leaves, uniform, 100.0 * (double)leaves / uniform, (double)sum.bytes / (double)leaves);
    cli_text *const text = &made->members;

    cli_text_add(text, ", \"octree\": {\"levels\": %" PRId32, t->levels);
    cli_json_ints(text, "base", t->base.dims);
    cli_json_count(text, "leaves", sum.voxels - sum.split);
    cli_json_value(text, "uniform_voxels", uniform_voxels(&run->report.lattice));
    report_level(text, &sum);
    if (t->triangles != 0) cli_json_value(text, "milliseconds", t->seconds * 1e3);
    cli_text_add(text, ", \"level\": [");
    for (int32_t i = 0; i <= t->levels; i++) {
        cli_text_add(text, "%s{\"level\": %" PRId32, i == 0 ? "" : ", ", i);
        report_level(text, &t->level[i]);
        cli_text_add(text, "}");
    }
    cli_text_add(text, "]");
    if (t->kind == CLI_MESH) cli_json_count(text, "triangles", t->surface.triangle_count);
    cli_text_add(text, "}");
}

void cli_tell_tree_output(const cli_run *run, const cli_tree *t, cli_made *made)
{
    cli_tell(made, "written: %s", cli_output_name(run, run->options->output));
    if (t->kind == CLI_GRID) {
        const int32_t *const n = t->grid.size;
        cli_tell(made, ", %" PRId32 " x %" PRId32 " x %" PRId32 " voxels, %" PRIu64 " set", n[0], n[1], n[2],
                 run->report.set);
    }
    if (t->kind == CLI_MESH)
        cli_tell(made, ", %" PRIu64 " triangles of %" PRIu64 " vertices", t->surface.triangle_count,
                 t->surface.vertex_count);
    cli_tell(made, "\n");
}
