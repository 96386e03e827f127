/* voxelize_volume.c - voxelize of a volume: to a grid, or to the surface of a level or of chosen voxels. */
#include "cli_commands/commands.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

typedef struct volume_job {
    cli_volume volume;
    bvx_volume_report report;
    bvx_grid grid, kept; /* kept: its parts that stay, where a level's surface is made */
    void *samples;       /* a copy, less the parts that go */
    bvx_mesh mesh;
    cli_reduction reduction;
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

static const cli_rule output_rules[] = {
    {.unless = CLI_TO_MESH | CLI_TO_GRID,
     .message = "%f: the name ends neither in a grid format that can be written (" CLI_GRIDS_WRITTEN
                ") nor in a mesh format (" CLI_MESHES_WRITTEN ")"},
    {.also = cli_reduction_rules},
    {0}};

/* ---- parts ---- */

/* kept may be the grid itself. */
static bvx_status keep_chosen(cli_run *run, volume_job *j, bvx_grid *kept)
{
    if (!CLI_HOLDS(run, CLI_KEEPS_PARTS)) return BVX_OK;
    CLI_TRY(cli_keep_parts(run, &j->grid, kept));
    return bvx_grid_count(run->context, kept, &j->report.inside);
}

static bvx_status select_chosen(cli_run *run, volume_job *j, bvx_grid *kept)
{
    CLI_TRY(cli_select_voxels(run, &j->volume, &j->report, &j->grid));
    return keep_chosen(run, j, kept);
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

/* ---- meshes ---- */

static bvx_status make_level_mesh(cli_run *run, volume_job *j, const bvx_volume_view *view, bvx_mesh *mesh)
{
    bvx_scalar_options const o = {.struct_size = sizeof o,
                                  .level = run->options->level,
                                  .below = run->options->below,
                                  .report = &j->report};
    return bvx_extract_scalar(run->context, view, &o, mesh);
}

static int make_kept_level_mesh(cli_run *run, volume_job *j, bvx_status *status)
{
    bvx_volume_view view = j->volume.view;

    *status = select_chosen(run, j, &j->kept);
    if (*status != BVX_OK) return CLI_DONE;
    if (run->report.parts.dropped != 0) {
        CLI_TRY(copy_without(run, &j->volume.view, &j->grid, &j->kept, &view, &j->samples));
        if (j->report.inside == 0) return CLI_DONE;
    }
    bvx_volume_report const whole = j->report;
    *status = make_level_mesh(run, j, &view, &j->mesh);
    j->report = whole; /* of the file's samples, not of the copy's */
    return CLI_DONE;
}

static int make_volume_mesh(cli_run *run, volume_job *j, cli_made *made)
{
    const char *const in = cli_first_name(run);

    bvx_status status = BVX_OK;
    int result = CLI_DONE;

    cli_stage_begin(run, "surface");
    if (cli_given(run, "--level") && CLI_HOLDS(run, CLI_KEEPS_PARTS)) {
        result = make_kept_level_mesh(run, j, &status);
    } else if (cli_given(run, "--level")) {
        status = make_level_mesh(run, j, &j->volume.view, &j->mesh);
    } else {
        status = select_chosen(run, j, &j->grid);
        if (status == BVX_OK) status = bvx_extract_surface(run->context, &j->grid, NULL, &j->mesh);
    }
    cli_stage_end(run);
    CLI_TRY(result);
    if (status != BVX_OK) return cli_fail_status(run, status, in);
    if (j->mesh.triangle_count == 0 && run->report.parts.dropped != 0)
        return cli_fail(run, "%s: each of the %" PRIu64 " parts has fewer voxels than --least-part", in,
                        run->report.parts.dropped);
    if (j->mesh.triangle_count == 0)
        return cli_fail(run,
                        "%s: the range holds no sample (they go from %.9g to %.9g), so there is no "
                        "surface",
                        in, j->report.least, j->report.greatest);
    made->mesh = &j->mesh;
    CLI_TRY(cli_reduce(run, &j->mesh, &j->reduction));
    return cli_check_mesh(run, &j->mesh, 0, run->options->output, "check");
}

static int make_volume(cli_run *run, void *work, cli_made *made)
{
    const char *const output = run->options->output;
    int const mesh = CLI_HOLDS(run, CLI_TO_MESH);
    volume_job *const j = work;
    bvx_window window;

    CLI_TRY(cli_check_rules(run, volume_rules, CLI_OF_VOLUME, NULL));
    CLI_TRY(cli_window_option(run, &window));
    CLI_TRY(cli_check_rules(run, output_rules, 0, NULL));
    CLI_TRY(cli_check_selection(run, run->options->input[0]));

    CLI_TRY(mesh ? cli_open_output(run, output) : cli_open_grid_output(run, output));
    CLI_TRY(cli_read_volume(run, run->options->input[0], &window, &j->volume));
    if (mesh) return make_volume_mesh(run, j, made);

    CLI_TRY(cli_check_grid_format(run, output, &j->volume.view.lattice));
    cli_stage_begin(run, "threshold");
    bvx_status status = cli_select_voxels(run, &j->volume, &j->report, &j->grid);
    cli_stage_end(run);
    if (status == BVX_OK) status = keep_chosen(run, j, &j->grid);
    CLI_TRY(cli_check_call(run, status, cli_first_name(run)));
    made->grid = &j->grid;
    made->set = j->report.inside;
    made->placed = j->volume.placed;
    if (j->report.inside == 0)
        cli_advise(made, BVX_WARN_EMPTY, "the result is empty: the range holds no sample");
    return CLI_DONE;
}

static void tell_volume(const cli_run *run, const void *work, cli_made *made)
{
    const volume_job *const j = work;

    cli_tell_volume(made->run, &j->volume, &j->report, &made->members);

    cli_text_add(&made->head, "  samples     %.9g to %.9g", j->report.least, j->report.greatest);
    if (j->report.nan + j->report.infinite != 0)
        cli_text_add(&made->head, ", %" PRIu64 " NaN, %" PRIu64 " infinite", j->report.nan,
                     j->report.infinite);
    cli_text_add(&made->head, "\n");

    if (made->mesh == NULL) return;
    cli_tell_parts(run, &made->text);
    cli_tell_reduction(&j->reduction, made);
    cli_tell_mesh_of(run, 0, run->report.mesh[0].path, made);
}

static const cli_owned volume_owns[] = {
    CLI_OWNS(MESH, volume_job, mesh),     CLI_OWNS(GRID, volume_job, kept),
    CLI_OWNS(GRID, volume_job, grid),     CLI_OWNS(BYTES, volume_job, samples),
    CLI_OWNS(VOLUME, volume_job, volume), {0}};

const cli_job cli_voxelize_volume = {
    .size = sizeof(volume_job), .make = make_volume, .tell = tell_volume, .owns = volume_owns};
