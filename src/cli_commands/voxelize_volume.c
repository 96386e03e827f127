/* voxelize_volume.c - voxelize of a volume: to a grid, to the surface of a
 * level, or to a surface for each label. */
#include "cli_commands/commands.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct volume_job {
    cli_volume volume;
    bvx_volume_report report;
    bvx_label *labels;
    uint64_t label_count;
    bvx_grid grid;
} volume_job;

/* ---- what is requested ---- */

/* A volume has its own lattice, and voxels already. */
static const cli_rule volume_rules[] = {
    {.given = "--resolution --spacing --origin --padding --mode --fill --close-gaps --add-shell "
              "--check-thin --base --second --up --half-width --sign --vectors --value-type "
              "--sharp --no-sharp",
     .message = "%o is for meshes; %i is a volume"},
    {.given = "--minimum --body", .message = "%o is for clouds of points; %i is a volume"},
    {0}};

enum {
    HAS_NUMBER = 1 << CLI_FIRST_FACT, /* %d */
    HAS_NUMBERS = 2 << CLI_FIRST_FACT /* two */
};

static const cli_rule output_rules[] = {
    {.unless = CLI_TO_MESH | CLI_TO_GRID,
     .message = "%f: the name ends neither in a grid format that can be written (" CLI_GRIDS_WRITTEN
                ") nor in a mesh format (" CLI_MESHES_WRITTEN ")"},
    {.also = cli_reduction_rules},
    {.unless = CLI_TO_MESH,
     .given = "--all-labels",
     .message = "%o writes a mesh for each label: %f needs %d in the name of a mesh"},
    {.unless = HAS_NUMBER,
     .given = "--all-labels",
     .message = "%o writes a mesh for each label: %f needs %d in the name of a mesh"},
    {.when = HAS_NUMBER, .lacking = "--all-labels", .message = "%f: %d is for --all-labels"},
    {.when = HAS_NUMBERS, .message = "%f: the name has two %d"},
    {0}};

static int check_volume(cli_run *run, bvx_window *window)
{
    const char *const out = run->options->output;
    uint32_t const facts = (cli_has_number(out) ? HAS_NUMBER : 0u) |
                           (cli_has_two_numbers(out) ? HAS_NUMBERS : 0u);

    CLI_TRY(cli_check_rules(run, volume_rules, CLI_OF_VOLUME, NULL));
    CLI_TRY(cli_window_option(run, window));
    CLI_TRY(cli_check_rules(run, output_rules, facts, NULL));
    return cli_check_selection(run, run->options->input[0]);
}

static void tell_samples(cli_text *lines, const bvx_volume_report *r)
{
    cli_text_add(lines, "  samples     %.9g to %.9g", r->least, r->greatest);
    if (r->nan + r->infinite != 0)
        cli_text_add(lines, ", %" PRIu64 " NaN, %" PRIu64 " infinite", r->nan, r->infinite);
    cli_text_add(lines, "\n");
}

/* ---- parts ---- */

/* kept may be the grid itself. */
static bvx_status keep_chosen(cli_run *run, volume_job *j, const bvx_grid *grid, bvx_grid *kept)
{
    bvx_status status;

    if (!CLI_HOLDS(run, CLI_KEEPS_PARTS)) return BVX_OK;
    status = cli_keep_parts(run, grid, kept);
    return status == BVX_OK ? bvx_grid_count(run->context, kept, &j->report.inside) : status;
}

/* A copy of the samples in which those of dropped parts are as one that is outside,
 * so that the surface of what is kept stays where its samples put it. Parts have no
 * face in common, so no edge of the lattice leads from one into another. */
static int copy_without(cli_run *run, const bvx_volume_view *view, const bvx_grid *all, const bvx_grid *kept,
                        bvx_volume_view *copy, void **samples)
{
    size_t const size = (size_t)cli_sample_bytes(view->sample_type);
    uint64_t const count = (uint64_t)view->size[0] * (uint64_t)view->size[1] * (uint64_t)view->size[2];
    int64_t stride[3];
    const char *outside = NULL;
    char *to = count <= SIZE_MAX / size ? malloc((size_t)count * size) : NULL;

    *samples = to;
    if (to == NULL) return cli_fail(run, "no memory for a copy of %" PRIu64 " samples", count);
    cli_volume_strides(view, stride);

    /* Two parts at least, so some sample lies between them. */
    for (int pass = 0; pass < 2; pass++)
        for (int32_t z = 0; z < view->size[2]; z++)
            for (int32_t y = 0; y < view->size[1]; y++) {
                const char *from = (const char *)view->samples + z * stride[2] + y * stride[1];
                for (int32_t x = 0; x < view->size[0]; x++, from += stride[0]) {
                    int const was = bvx_grid_get(all, x, y, z);
                    if (pass == 0 && !was && outside == NULL) outside = from;
                    if (pass == 0) continue;
                    memcpy(to, was && !bvx_grid_get(kept, x, y, z) && outside != NULL ? outside : from, size);
                    to += size;
                }
            }
    *copy = *view;
    copy->samples = *samples;
    /* Zeros stand for samples without gaps, as the copy has them. */
    memset(copy->strides, 0, sizeof copy->strides);
    return CLI_DONE;
}

/* ---- a grid ---- */

static int make_volume_grid(cli_run *run, volume_job *j, cli_made *made)
{
    bvx_status status;
    int const result = cli_check_grid_format(run, run->options->output, &j->volume.view.lattice,
                                             j->volume.view.size);

    if (result != CLI_DONE) return result;
    cli_stage_begin(run, "threshold");
    status = cli_select_voxels(run, &j->volume, &j->report, &j->grid);
    cli_stage_end(run);
    if (status == BVX_OK) status = keep_chosen(run, j, &j->grid, &j->grid);
    CLI_TRY(cli_check_call(run, status, cli_input_name(run->options->input[0])));

    made->grid = &j->grid;
    made->set = j->report.inside;
    made->placed = j->volume.placed;
    cli_tell_volume(&j->volume, &j->report, &made->members, &made->warnings);
    tell_samples(&made->head, &j->report);
    if (j->report.inside == 0)
        cli_advise(made, BVX_WARN_EMPTY, "the result is empty: the range holds no sample");
    return CLI_DONE;
}

/* ---- meshes ---- */

static bvx_status make_level_mesh(cli_run *run, volume_job *j, const bvx_volume_view *view, bvx_mesh *mesh)
{
    bvx_scalar_options const o = {.struct_size = sizeof o,
                                  .level = run->options->level,
                                  .below = run->options->below,
                                  .report = &j->report};

    return bvx_extract_scalar(run->context, view, &o, mesh);
}

/* Reduce, check and write a mesh as output number n, under the path that the report keeps. */
static int put_mesh(cli_run *run, bvx_mesh *mesh, int n, const char *path, cli_reduction *reduction)
{
    CLI_TRY(cli_reduce(run, mesh, reduction));
    CLI_TRY(cli_check_mesh(run, mesh, n, path, "check"));
    return cli_write_mesh_as(run, mesh, n, path);
}

void cli_tell_mesh_of(const cli_run *run, int n, const char *title, cli_made *made)
{
    const bvx_certificate *const c = &run->report.mesh[n].certificate;

    /* A part with a cavity has two surfaces: parts are counted where some are dropped. */
    cli_tell(made, "  %s: %" PRIu64 " triangles, %s, volume %.6g, %" PRIu64 " surface%s\n", title,
             c->triangles, cli_is_sound(c) ? "closed, manifold" : "NOT closed", c->volume, c->components,
             c->components == 1 ? "" : "s");
}

static int make_kept_level_mesh(cli_run *run, volume_job *j, bvx_status *status, bvx_mesh *mesh)
{
    bvx_grid all = {0}, kept = {0};
    bvx_volume_view view = j->volume.view;
    void *samples = NULL;
    int result = CLI_DONE;

    *status = cli_select_voxels(run, &j->volume, &j->report, &all);
    if (*status == BVX_OK) *status = keep_chosen(run, j, &all, &kept);
    if (*status == BVX_OK && run->report.parts.dropped != 0)
        result = copy_without(run, &j->volume.view, &all, &kept, &view, &samples);
    if (*status == BVX_OK && result == CLI_DONE &&
        (j->report.inside != 0 || run->report.parts.dropped == 0)) {
        bvx_volume_report const whole = j->report;
        *status = make_level_mesh(run, j, &view, mesh);
        j->report = whole; /* of the file's samples, not of the copy's */
    }
    free(samples);
    bvx_grid_free(run->context, &kept);
    bvx_grid_free(run->context, &all);
    return result;
}

static int make_surface_of_volume(cli_run *run, volume_job *j, bvx_mesh *mesh)
{
    bvx_status status = BVX_OK;
    bvx_grid grid = {0};
    int result = CLI_DONE;

    cli_stage_begin(run, "surface");
    if (cli_given(run, "--level") && CLI_HOLDS(run, CLI_KEEPS_PARTS)) {
        result = make_kept_level_mesh(run, j, &status, mesh);
    } else if (cli_given(run, "--level")) {
        status = make_level_mesh(run, j, &j->volume.view, mesh);
    } else {
        status = cli_select_voxels(run, &j->volume, &j->report, &grid);
        if (status == BVX_OK) status = keep_chosen(run, j, &grid, &grid);
        if (status == BVX_OK) status = bvx_extract_surface(run->context, &grid, NULL, mesh);
    }
    cli_stage_end(run);
    bvx_grid_free(run->context, &grid);
    if (result != CLI_DONE || status == BVX_OK) return result;
    return cli_fail_status(run, status, cli_input_name(run->options->input[0]));
}

static int make_volume_mesh(cli_run *run, volume_job *j, cli_made *made)
{
    const char *const in = cli_input_name(run->options->input[0]);
    cli_reduction reduction = {0};
    bvx_mesh mesh = {0};
    int result = make_surface_of_volume(run, j, &mesh);

    if (result != CLI_DONE) return result;
    if (mesh.triangle_count == 0 && run->report.parts.dropped != 0)
        return cli_fail(run, "%s: each of the %" PRIu64 " parts has fewer voxels than --least-part", in,
                        run->report.parts.dropped);
    if (mesh.triangle_count == 0)
        return cli_fail(run,
                        "%s: the range holds no sample (they go from %.9g to %.9g), so there is no "
                        "surface",
                        in, j->report.least, j->report.greatest);
    result = put_mesh(run, &mesh, 0, run->options->output, &reduction);
    bvx_mesh_free(run->context, &mesh);
    if (result != CLI_DONE) return result;

    cli_note_voxels(run, &j->volume.view.lattice, j->report.inside);
    cli_tell_volume(&j->volume, &j->report, &made->members, &made->warnings);
    tell_samples(&made->head, &j->report);
    cli_tell_parts(run, &made->text);
    cli_tell_reduction(&reduction, made);
    cli_tell_mesh_of(run, 0, run->report.mesh[0].path, made);
    return CLI_DONE;
}

/* ---- labels ---- */

static int list_labels(cli_run *run, volume_job *j)
{
    const char *const in = cli_input_name(run->options->input[0]);
    uint64_t count = 0;
    bvx_status status;

    cli_stage_begin(run, "labels");
    /* Counted first: a volume of other samples has millions of values. */
    status = bvx_list_labels(run->context, &j->volume.view, NULL, 0, &count);
    if (status == BVX_OK && count != 0 && count <= CLI_MAX_OUTPUTS) {
        j->labels = calloc((size_t)count, sizeof *j->labels);
        if (j->labels == NULL) return cli_fail(run, "no memory for %" PRIu64 " labels", count);
        status = bvx_list_labels(run->context, &j->volume.view, j->labels, count, &j->label_count);
    }
    CLI_TRY(cli_stage_check(run, status, in));
    if (count == 0) return cli_fail(run, "%s: all samples are 0, so there are no labels", in);
    if (count > CLI_MAX_OUTPUTS)
        return cli_fail(run,
                        "%s: %" PRIu64 " labels, more than the %d files of one run; take --label or --range",
                        in, count, CLI_MAX_OUTPUTS);
    return CLI_DONE;
}

static int make_label_mesh(cli_run *run, volume_job *j, int n)
{
    int64_t const value = j->labels[n].value;
    char *const path = cli_numbered_path(run->options->output, value); /* the report keeps it */
    cli_reduction reduction = {0};
    bvx_mesh mesh = {0};
    bvx_grid grid = {0};
    bvx_volume_view view;
    bvx_volume_report report;
    bvx_status status;
    int result;

    if (path == NULL) return cli_fail(run, "no memory for a file's name");
    if (value < 0 && j->volume.view.sample_type == BVX_SAMPLE_U64)
        return cli_fail(run, "%s: labels of 2^63 and more are not written",
                        cli_input_name(run->options->input[0]));
    result = cli_open_output(run, path);
    if (result != CLI_DONE) return result;
    /* The label's box: beyond it there is none of it, so the surface is that of the whole. */
    cli_part_of_volume(&j->volume.view, j->labels[n].low, j->labels[n].size, &view);
    cli_stage_begin(run, "surface");
    status = bvx_threshold_whole(run->context, &view, value, value, &report, &grid);
    if (status == BVX_OK && CLI_HOLDS(run, CLI_KEEPS_PARTS)) status = cli_keep_parts(run, &grid, &grid);
    if (status == BVX_OK) status = bvx_extract_surface(run->context, &grid, NULL, &mesh);
    cli_stage_end(run);
    bvx_grid_free(run->context, &grid);
    result = status == BVX_OK ? put_mesh(run, &mesh, n, path, &reduction)
                              : cli_fail_status(run, status, path);
    bvx_mesh_free(run->context, &mesh);
    return result;
}

static void tell_labels(const volume_job *j, cli_made *made)
{
    cli_text *const t = &made->members;

    cli_text_add(t, ", \"labels\": [");
    for (uint64_t i = 0; i < j->label_count; i++) {
        cli_text_add(t, "%s{\"value\": %" PRId64, i == 0 ? "" : ", ", j->labels[i].value);
        cli_json_count(t, "voxels", j->labels[i].voxels);
        cli_text_add(t, "}");
    }
    cli_text_add(t, "]");
}

static int make_label_meshes(cli_run *run, volume_job *j, cli_made *made)
{
    int status = list_labels(run, j);

    for (uint64_t i = 0; i < j->label_count && status == CLI_DONE; i++) {
        status = make_label_mesh(run, j, (int)i);
        if (status == CLI_DONE && cli_interrupted()) status = cli_fail_interrupted(run);
        j->report.inside += j->labels[i].voxels;
    }
    if (status != CLI_DONE) return status;

    cli_note_voxels(run, &j->volume.view.lattice, j->report.inside);
    tell_labels(j, made);
    made->untitled = 1;
    cli_tell(made, "%s: %" PRIu64 " labels\n", cli_input_name(run->options->input[0]), j->label_count);
    cli_tell_parts(run, &made->text);
    for (uint64_t i = 0; i < j->label_count; i++)
        cli_tell_mesh_of(run, (int)i, run->report.mesh[i].path, made);
    return CLI_DONE;
}

static int keep_meshes(cli_run *run, void *work)
{
    (void)work;
    return cli_keep_outputs(run);
}

static int make_volume(cli_run *run, void *work, cli_made *made)
{
    const cli_voxelize_options *const own = run->own;
    const char *const output = run->options->output;
    int const all = own->all_labels, kind = cli_kind_of_format(bvx_format_of_name(output));
    volume_job *const j = work;
    bvx_window window;

    CLI_TRY(check_volume(run, &window));
    if (kind == CLI_GRID) CLI_TRY(cli_open_grid_output(run, output));
    if (kind == CLI_MESH && !all) CLI_TRY(cli_open_output(run, output));
    CLI_TRY(cli_read_volume(run, run->options->input[0], &window, &j->volume));
    if (kind == CLI_GRID) return make_volume_grid(run, j, made);

    made->write = keep_meshes;
    return all ? make_label_meshes(run, j, made) : make_volume_mesh(run, j, made);
}

static const cli_owned volume_owns[] = {CLI_OWNS(GRID, volume_job, grid),
                                        CLI_OWNS(BYTES, volume_job, labels),
                                        CLI_OWNS(VOLUME, volume_job, volume),
                                        {0}};

const cli_job cli_voxelize_volume = {.size = sizeof(volume_job), .make = make_volume, .owns = volume_owns};
