/* grid_output.c - a grid, or a field, as one file, or as two where its format keeps no lattice: all or nothing. */
#include "cli_results/results.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

int cli_open_grid_output(cli_run *run, const char *path)
{
    int status = cli_open_output(run, path);
    if (status != CLI_DONE || !cli_needs_sidecar(bvx_format_of_name(path))) return status;
    char *const name = cli_sidecar_name(path);
    status = name != NULL ? cli_open_output(run, name) : cli_fail(run, "no memory for a file's name");
    free(name);
    return status;
}

int cli_write_buffer(cli_run *run, int number, bvx_status status, bvx_buffer *file, const char *path)
{
    int const result = status == BVX_OK ? cli_write_output(run, number, file)
                                        : cli_fail_status(run, status, path);
    bvx_buffer_free(run->context, file);
    return result;
}

/* The file of voxels on this grid, and its side-car where its format needs one, within the stage that the
 * caller began: written and kept, where a call of the library made it. Frees it. */
static int finish_voxels(cli_run *run, bvx_status status, bvx_buffer *file, const bvx_grid *grid)
{
    const char *const path = run->options->output;
    int32_t const format = bvx_format_of_name(path), *const d = grid->lattice.dims;
    int result = cli_write_buffer(run, 0, status, file, path);
    if (result == CLI_DONE && cli_needs_sidecar(format)) {
        status = bvx_write_lattice(run->context, grid, file);
        result = cli_write_buffer(run, 1, status, file, path);
    }
    if (result == CLI_DONE) result = cli_keep_outputs(run);
    cli_stage_end(run);
    /* Formats of other programs know a box of voxels and nothing around it. */
    if (result == CLI_DONE && !cli_needs_sidecar(format) && format != BVX_FORMAT_BVX &&
        memcmp(grid->size, d, sizeof grid->size) != 0)
        cli_warn(run, BVX_WARN_LOST,
                 "%s holds only these voxels: that they are a part of a lattice of %" PRId32 " x %" PRId32
                 " x %" PRId32 " is lost",
                 path, d[0], d[1], d[2]);
    return result;
}

int cli_write_grid(cli_run *run, const bvx_grid *grid)
{
    bvx_buffer file = {0};
    cli_stage_begin(run, "write");
    return finish_voxels(run,
                         bvx_write_grid(run->context, grid, bvx_format_of_name(run->options->output), &file),
                         &file, grid);
}

int cli_write_segments(cli_run *run, const bvx_grid *grid, const bvx_mesh *mesh)
{
    uint8_t palette[1024], *const labels = malloc((size_t)grid->size[0] * (size_t)grid->size[1] *
                                                  (size_t)grid->size[2]);
    bvx_buffer file = {0};

    if (labels == NULL) return cli_fail(run, "no memory for the labels of the voxels");
    int result = CLI_STAGE(run, "labels", bvx_label_voxels(run->context, mesh, grid, labels, palette),
                           cli_first_name(run));
    cli_take_warnings(run, (const char *const[]){NULL, NULL, NULL});
    if (result == CLI_DONE) {
        cli_stage_begin(run, "write");
        result = finish_voxels(run,
                               bvx_write_labels(run->context, grid, labels, palette,
                                                bvx_format_of_name(run->options->output), &file),
                               &file, grid);
    }
    free(labels);
    return result;
}

int cli_write_field(cli_run *run, const bvx_field *field)
{
    int32_t const format = bvx_format_of_name(run->options->output);
    bvx_buffer file = {0};
    cli_stage_begin(run, "write");
    return finish_voxels(run, bvx_write_field(run->context, field, run->options->vectors, format, &file),
                         &file, &field->band);
}

void cli_tell_grid(const cli_run *run, cli_text *text, const bvx_grid *g, uint64_t set, int placed)
{
    const bvx_lattice *const l = &g->lattice;
    double const all = (double)g->size[0] * g->size[1] * g->size[2];
    double corner[3];

    cli_grid_corner(g, 0.0, corner);
    cli_text_add(text, "  dims        %" PRId32 " x %" PRId32 " x %" PRId32 "\n", g->size[0], g->size[1],
                 g->size[2]);
    if (memcmp(g->size, l->dims, sizeof g->size) != 0)
        cli_text_add(text,
                     "  window      from %" PRId32 ",%" PRId32 ",%" PRId32 " of a lattice of %" PRId32
                     " x %" PRId32 " x %" PRId32 "\n",
                     g->low[0], g->low[1], g->low[2], l->dims[0], l->dims[1], l->dims[2]);
    cli_text_add(text, "  voxels      %" PRIu64 " set, %.3g %% of all\n", set, 100.0 * (double)set / all);
    cli_text_add(text, "  spacing     %.9g, %.9g, %.9g%s\n", l->spacing[0], l->spacing[1], l->spacing[2],
                 placed ? "" : " (assumed: no side-car says it)");
    cli_text_add(text, "  origin      %.9g, %.9g, %.9g%s\n", corner[0], corner[1], corner[2],
                 placed ? "" : " (assumed: no side-car says it)");
    cli_tell_parts(run, text);
}

void cli_grid_corner(const bvx_grid *grid, double part, double corner[3])
{
    for (int a = 0; a < 3; a++)
        corner[a] = grid->lattice.origin[a] + ((double)grid->low[a] + part) * grid->lattice.spacing[a];
}

int cli_touches_side(const bvx_grid *g)
{
    for (int32_t z = 0; z < g->size[2]; z++)
        for (int32_t y = 0; y < g->size[1]; y++) {
            /* Whole rows lie in four of the sides; of the others only their ends. */
            int const side = z == 0 || y == 0 || z == g->size[2] - 1 || y == g->size[1] - 1;
            for (int32_t k = 0; k < g->words_per_row && side; k++)
                if (g->words[((size_t)z * (size_t)g->size[1] + (size_t)y) * (size_t)g->words_per_row +
                             (size_t)k] != 0)
                    return 1;
            if (bvx_grid_get(g, 0, y, z) || bvx_grid_get(g, g->size[0] - 1, y, z)) return 1;
        }
    return 0;
}
