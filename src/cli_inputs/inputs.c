/* inputs.c - any input by its ending: a mesh, a grid, an octree, of which a level becomes a grid, or
 * contours. */
#include "cli_inputs/inputs.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { READS_PARTS = CLI_LOD | CLI_FACES | CLI_RENDER | CLI_CONVERT }; /* components chooses by itself */

#define TREE_GRID_BYTES (UINT64_C(1) << 30) /* most bytes of a grid without --memory-limit */

/* ---- grids ---- */

/* Colours of a .vox that was read: a palette, or other numbers than those that bitvox writes. */
static int has_vox_colours(const cli_bytes *b)
{
    const unsigned char *const p = b->bytes;
    size_t n;
    for (size_t at = 20; at + 12 <= b->size; at += 12 + n) {
        n = p[at + 4] | (size_t)p[at + 5] << 8 | (size_t)p[at + 6] << 16 | (size_t)p[at + 7] << 24;
        if (memcmp(p + at, "RGBA", 4) == 0) return 1;
        for (size_t i = 19; i < 12 + n && memcmp(p + at, "XYZI", 4) == 0; i += 4)
            if (p[at + i] != 1) return 1;
    }
    return 0;
}

static int parse_grid(cli_run *run, cli_bytes *b, const bvx_window *window, cli_input *in)
{
    int32_t const format = cli_input_format(run, in->path);
    bvx_status read;

    /* A tree's fourth byte differs from a grid's. */
    static const unsigned char tree[4] = {0x89, 'B', 'V', 'O'};
    in->kind = (format == BVX_FORMAT_BVX && b->size >= sizeof tree &&
                memcmp(b->bytes, tree, sizeof tree) == 0)
                   ? CLI_TREE
                   : CLI_GRID;
    in->placed = 1;
    cli_stage_begin(run, "parse");
    if (in->kind == CLI_TREE) read = bvx_read_octree(run->context, b->bytes, b->size, &in->tree);
    else read = bvx_read_grid(run->context, b->bytes, b->size, format, window, &in->grid);
    cli_end_parse(run, b->size);
    /* Packed samples become a grid by way of their volume, as a reader of grids has nothing to unpack them. */
    if (read == BVX_ERR_UNSUPPORTED && (format == BVX_FORMAT_NRRD || format == BVX_FORMAT_VTI) &&
        bvx_last_error(run->context)->reason == BVX_REASON_COMPRESSED) {
        bvx_volume_report report;

        cli_volume v = {.file = *b};
        memset(b, 0, sizeof *b);
        int status = cli_take_volume(run, in->path, window, &v);
        if (status == CLI_DONE)
            status = cli_check_call(run, cli_select_voxels(run, &v, &report, &in->grid),
                                    cli_input_name(in->path));
        cli_free_volume(run, &v);
        return status;
    }
    int const coloured = read == BVX_OK && format == BVX_FORMAT_VOX && run->options->output != NULL &&
                         has_vox_colours(b);
    if (coloured && run->command->bit == CLI_FACES && CLI_HOLDS(run, CLI_TO_GLB))
        read = bvx_read_labels(run->context, b->bytes, b->size, format, &in->labels, in->palette);
    else if (coloured)
        cli_warn(run, BVX_WARN_LOST, "%s: the colours of its voxels are not kept", cli_input_name(in->path));
    return cli_check_call(run, read, cli_input_name(in->path));
}

int cli_read_grid_or_tree(cli_run *run, const char *path, const bvx_window *window, cli_input *in)
{
    cli_bytes b = {NULL, 0, 0, 0};

    memset(in, 0, sizeof *in);
    in->path = path;
    if (cli_is_volume(run, path)) {
        bvx_volume_report report;
        cli_volume v;
        int status = cli_read_volume(run, path, window, &v);

        in->kind = CLI_GRID;
        in->placed = v.placed;
        if (status == CLI_DONE) {
            cli_stage_begin(run, "threshold");
            bvx_status selected = cli_select_voxels(run, &v, &report, &in->grid);
            cli_stage_end(run);
            if (selected == BVX_OK && CLI_HOLDS(run, CLI_KEEPS_PARTS))
                selected = cli_keep_parts(run, &in->grid, &in->grid);
            if (selected != BVX_OK) status = cli_fail_status(run, selected, cli_input_name(path));
            else cli_tell_volume(run, &v, &report, &run->report.more);
            cli_say_warnings(run);
        }
        cli_free_volume(run, &v);
        return status;
    }
    int status = cli_open_input(run, path, &b);
    if (status == CLI_DONE) status = parse_grid(run, &b, window, in);
    if (status == CLI_DONE && (run->command->bit & READS_PARTS) != 0 && CLI_HOLDS(run, CLI_KEEPS_PARTS))
        status = in->kind == CLI_TREE
                     ? cli_usage(run, "--keep-largest and --least-part are for grids; %s is an octree",
                                 cli_input_name(path))
                     : cli_check_call(run, cli_keep_parts(run, &in->grid, &in->grid), cli_input_name(path));
    free(b.bytes);
    if (status == CLI_DONE && cli_needs_sidecar(cli_input_format(run, path)))
        status = cli_read_sidecar(run, path, &in->grid, &in->placed);
    return status;
}

/* ---- octrees ---- */

int cli_check_tree_level(cli_run *run, int32_t levels)
{
    if (run->options->expand <= levels) return CLI_DONE;
    return cli_usage(run, "--expand %" PRId32 " is beyond the last level, %" PRId32, run->options->expand,
                     levels);
}

int cli_expand_tree(cli_run *run, const bvx_octree *tree, const bvx_window *finest, const char *path,
                    bvx_grid *grid)
{
    const cli_options *const o = run->options;
    int32_t const levels = bvx_octree_levels(tree), level = cli_given(run, "--expand") ? o->expand : levels;
    bvx_lattice lattice;
    bvx_window window;

    CLI_TRY(cli_check_tree_level(run, levels));
    CLI_TRY(cli_check_call(run, bvx_octree_lattice(run->context, tree, level, &lattice), path));
    int32_t const shift = levels - level;
    window = *finest;
    for (int a = 0; a < 3 && finest->size[0] != 0; a++) {
        /* Outwards: a coarse voxel belongs to the window that it overlaps. */
        int64_t const end = (int64_t)finest->low[a] + finest->size[a];
        window.low[a] = finest->low[a] >> shift;
        window.size[a] = (int32_t)((end + (INT64_C(1) << shift) - 1) >> shift) - window.low[a];
    }
    uint64_t words = bvx_grid_bound(&lattice, &window);
    /* An octree is small where its grid is not, so the size is refused unless a limit allows it. */
    if (o->general.memory_limit == 0 && words > TREE_GRID_BYTES / 8)
        return cli_fail(run,
                        "%s: the grid of level %" PRId32 " would take %" PRIu64
                        " MiB: take a lower --expand or a --window, or allow it by "
                        "--memory-limit",
                        path, level, words >> 17);
    if (o->output != NULL && cli_kind_of_format(bvx_format_of_name(o->output)) == CLI_GRID) {
        CLI_TRY(cli_check_grid_format(run, o->output, &lattice));
    }
    return CLI_STAGE(run, "expand", bvx_octree_expand(run->context, tree, level, o->states, &window, grid),
                     path);
}

/* The word is the input's name. */
static const cli_rule tree_rules[] = {
    {.when = CLI_OF_GRID, .given = "--expand --states", .message = "%o is for octrees; %w is a grid"},
    {.when = CLI_OF_MESH, .given = "--expand --states", .message = "%o is for octrees; %w is a mesh"},
    {0}};

static int read_expanded(cli_run *run, const char *path, const bvx_window *window, cli_input *in)
{
    static const bvx_window all = {{0, 0, 0}, {0, 0, 0}};
    int status = cli_read_grid_or_tree(run, path, window, in);

    if (status == CLI_DONE && in->kind == CLI_TREE)
        status = cli_expand_tree(run, in->tree, window != NULL ? window : &all, cli_input_name(path),
                                 &in->grid);
    else if (status == CLI_DONE) status = cli_check_rules(run, tree_rules, CLI_OF_GRID, cli_input_name(path));
    bvx_octree_free(run->context, in->tree);
    in->tree = NULL;
    in->kind = CLI_GRID;
    return status;
}

int cli_read_grid(cli_run *run, const char *path, const bvx_window *window, bvx_grid *grid, int *placed)
{
    cli_input in;
    int const status = read_expanded(run, path, window, &in);
    *grid = in.grid;
    *placed = in.placed;
    return status;
}

int cli_read_input(cli_run *run, const char *path, cli_input *input)
{
    memset(input, 0, sizeof *input);
    input->path = path;
    CLI_TRY(cli_input_kind(run, path, &input->kind));
    if (input->kind == CLI_GRID) return read_expanded(run, path, NULL, input);
    CLI_TRY(cli_check_rules(run, tree_rules, CLI_OF_MESH, cli_input_name(path)));
    return cli_read_mesh(run, path, &input->mesh);
}

void cli_free_input(cli_run *run, cli_input *input)
{
    bvx_mesh_free(run->context, &input->mesh);
    bvx_grid_free(run->context, &input->grid);
    bvx_buffer_free(run->context, &input->labels);
    bvx_octree_free(run->context, input->tree);
    input->tree = NULL;
}

/* ---- contours ---- */

int cli_read_sections(cli_run *run, const char *path, bvx_sections *sections)
{
    cli_bytes b = {NULL, 0, 0, 0};
    int status = cli_open_input(run, path, &b);

    if (status == CLI_DONE) {
        bvx_read_sections_options o = {.struct_size = sizeof o};
        uint64_t flipped = 0;
        o.close_gap = run->options->close_gap;
        o.flipped = &flipped;
        cli_stage_begin(run, "parse");
        bvx_status read = bvx_read_sections(run->context, b.bytes, b.size, cli_input_format(run, path), &o,
                                            sections);
        cli_end_parse(run, b.size);
        status = cli_check_call(run, read, cli_input_name(path));
        if (status == CLI_DONE && flipped != 0)
            cli_warn(run, BVX_WARN_READ,
                     "%s: D has the other sign on all planes, A x + B y + C z = D; the points were taken",
                     cli_input_name(path));
    }
    free(b.bytes);
    return status;
}
