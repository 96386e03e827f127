/* cmd_refine.c - bitvox refine: voxels of several sizes, the small ones at the surface only. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <string.h>

typedef struct refine_options {
    bvx_refine_options tree;
    int32_t base_voxels; /* --base; 0: not given */
    int32_t depth;       /* --halvings */
} refine_options;

#define OWN(name) CLI_OWN(refine_options, name)

static const char *const auto_names[] = {"auto", NULL};

static const cli_argument refine_rows[] = {
    {.also = cli_takes_output},
    LIST("--window", "A,B,C,D,E,F", SHARED(window), 0, LARGEST_SIDE, 6, 6,
         "halve voxels to the last level only in A..D-1, B..E-1, C..F-1 of it"),
    LIST("--resolution", "N", SHARED(resolution), 1, LARGEST_SIDE, 1, 1,
         "voxels of the last level along the longest axis, at least, in place\n"
         "of --base [--base x 2^--halvings]"),
    WHOLE("--base", "N", OWN(base_voxels), 1, LARGEST_SIDE,
          "voxels along the longest axis before any is halved [8]"),
    WHOLE_OR("--halvings", "L|auto", OWN(depth), 0, 25, auto_names, -1,
             "how many times voxels are halved [6]; auto: with --resolution, until\n"
             "the base has at most 256 voxels a side [auto with --resolution]"),
    WHOLE("--outer-levels", "L", OWN(tree.outer_levels), 0, 25,
          "with --window: how many times beyond it [0]"),
    BETWEEN("--adaptive", "T", OWN(tree.tolerance), 0, 1e300,
            "a voxel whose triangles lie within T of one plane is not halved,\n"
            "in the mesh's unit [off]"),
    {.also = cli_takes_states},
    {.also = cli_takes_expand},
    {.also = cli_takes_file_of_a_mesh},
    {.also = cli_takes_all},
    {0}};

enum { REFINE_BASE = 8, REFINE_LEVELS = 6, REFINE_AUTO = -1 };

enum { CHOOSES_LEVELS = 1 << CLI_FIRST_FACT }; /* --halvings auto */

/* An octree has been refined: what the options for that would ask is decided. */
static const cli_rule tree_rules[] = {{.given = "--resolution --base --halvings --outer-levels --adaptive",
                                       .message = "%o is for meshes; %i is not a mesh"},
                                      {0}};

static const cli_rule mesh_rules[] = {
    {.given = "--resolution", .beside = "--base", .message = "%o and %b contradict each other"},
    {.when = CHOOSES_LEVELS, .lacking = "--resolution", .message = "--halvings auto needs --resolution"},
    {.given = "--outer-levels", .lacking = "--window", .message = "%o needs --window"},
    {0}};

/* The number of the last level, REFINE_AUTO when it is to be chosen. */
static int32_t levels_asked_for(const cli_run *run)
{
    const refine_options *const own = run->own;
    if (cli_given(run, "--halvings")) return own->depth;
    return run->options->resolution.count != 0 ? REFINE_AUTO : REFINE_LEVELS;
}

static int check_refine_options(cli_run *run, cli_tree *t, int *kind)
{
    const char *const path = run->options->input[0];
    CLI_TRY(cli_check_tree_output(run, t));
    CLI_TRY(cli_input_kind(run, path, kind));
    if (*kind == CLI_GRID && cli_input_format(run, path) != BVX_FORMAT_BVX)
        return cli_usage(run, "%s is a grid; refine takes a mesh or an octree", cli_input_name(path));
    if (*kind == CLI_GRID && run->options->window.count != 0 && t->kind != CLI_GRID)
        return cli_usage(run, "--window of an octree is only for grids; %s is not a grid",
                         run->options->output);
    if (*kind != CLI_MESH) {
        CLI_TRY(cli_check_rules(run, tree_rules, 0, NULL));
        return cli_window_option(run, &t->window);
    }

    const refine_options *const own = run->own;
    int32_t const levels = levels_asked_for(run);
    CLI_TRY(cli_check_rules(run, mesh_rules, levels == REFINE_AUTO ? CHOOSES_LEVELS : 0, NULL));
    if (levels != REFINE_AUTO && own->tree.outer_levels > levels)
        return cli_usage(run, "--outer-levels %" PRId32 " is beyond the last level, %" PRId32,
                         own->tree.outer_levels, levels);
    if (levels != REFINE_AUTO) CLI_TRY(cli_check_tree_level(run, levels));
    return cli_window_option(run, &t->window);
}

static bvx_status refine_mesh(cli_run *run, const bvx_mesh *mesh, cli_tree *t, bvx_octree **tree)
{
    const refine_options *const own = run->own;
    const cli_options *const o = run->options;
    int32_t const levels = levels_asked_for(run);
    int64_t const finest = o->resolution.count != 0 ? o->resolution.value[0] : 0;
    int32_t base = own->base_voxels != 0 ? own->base_voxels : REFINE_BASE;
    bvx_mesh_view const view = cli_view(mesh);
    bvx_refine_options r = own->tree;

    r.struct_size = sizeof r;
    r.window = t->window;
    if (levels == REFINE_AUTO) {
        CLI_TRY(bvx_refine_choose(run->context, &view, (int32_t)finest, &r, &t->base));
    } else {
        r.levels = levels != 0 ? levels : BVX_NONE;
        /* Rounded up, so that the last level has at least as many voxels. */
        if (finest != 0) base = (int32_t)((finest + (INT64_C(1) << levels) - 1) >> levels);
        CLI_TRY(bvx_lattice_fit(run->context, &view, base, &t->base));
    }
    return bvx_refine(run->context, &view, &t->base, &r, tree);
}

static int make_refine(cli_run *run, void *work, cli_made *made)
{
    cli_tree *const t = work;
    int kind;
    made->write = cli_write_tree;
    made->untitled = 1;
    CLI_TRY(check_refine_options(run, t, &kind));
    CLI_TRY(cli_open_tree_output(run, t));

    bvx_mesh mesh = {0};
    if (kind == CLI_GRID) {
        const char *const path = run->options->input[0];
        cli_input in;
        int status = cli_read_grid_or_tree(run, path, NULL, &in);
        if (status == CLI_DONE && in.kind != CLI_TREE)
            status = cli_usage(run, "%s is a grid; refine takes a mesh or an octree", cli_input_name(path));
        if (status == CLI_DONE) {
            status = cli_take_tree(run, in.tree, t);
            in.tree = NULL;
        }
        cli_free_input(run, &in);
        return status;
    }
    bvx_octree *tree = NULL;
    CLI_TRY(cli_read_mesh(run, run->options->input[0], &mesh));
    cli_stage_begin(run, "refine");
    bvx_status const status = refine_mesh(run, &mesh, t, &tree);
    t->seconds = cli_stage_end(run);
    /* Not 0, which is how the report knows that a mesh was refined. */
    t->triangles = mesh.triangle_count;
    int const result = status == BVX_OK ? cli_take_tree(run, tree, t)
                                        : cli_fail_status(run, status, cli_first_name(run));
    bvx_mesh_free(run->context, &mesh);
    return result;
}

static void tell_refine(const cli_run *run, const void *work, cli_made *made)
{
    const cli_tree *const t = work;
    const char *const path = cli_first_name(run);
    if (t->triangles == 0) cli_tell(made, "%s\n\n", path);
    else
        cli_tell(made, "%s: %" PRIu64 " triangles, refined in %.1f ms\n\n", path, t->triangles,
                 t->seconds * 1e3);
    cli_tell_levels(run, t, made);
    cli_tell_tree_output(run, t, made);
}

static const cli_owned refine_owns[] = {{CLI_OWNS_TREE, 1, 0, 0}, {0}};

const cli_command cli_refine = {
    .name = "refine",
    .bit = CLI_REFINE,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "IN -o OUT [options]",
    .does = "voxels of several sizes, small ones only at the surface",
    .details =
        "Reads a mesh (" CLI_MESHES_READ ", also with .gz), lays --base voxels over it and halves those\n"
        "that triangles touch --halvings times; what a flood from outside cannot reach is inside. Writes the "
        "octree\n"
        "(.bvx, which is an input too), its leaves with their level and state (.vtu, for ParaView), the "
        "voxels\n"
        "of one level as a grid (.npy .binvox .vox .nrrd .vti, with --expand .bvx), or the last level's "
        "surface\n"
        "as a closed mesh (" CLI_MESHES_WRITTEN "), and a table of what\n"
        "each level holds. With --window only a part is fine, with --adaptive only what is not flat.",
    .example = "bitvox refine fixtures/knot.ply -o knot.vtu --base 8 --halvings 4\n"
               "bitvox refine fixtures/knot.ply -o knot.bvx --resolution 300",
    .most = "--resolution --base --halvings --outer-levels --adaptive --states --expand "
            "--window --threads --memory-limit --json",
    .rows = refine_rows,
    .own = sizeof(refine_options),
    .job = {.size = sizeof(cli_tree), .make = make_refine, .tell = tell_refine, .owns = refine_owns}};
