/* cmd_boolean.c - bitvox boolean: what two bodies are together, have in common, or have only.
 *
 * Two meshes that become a mesh keep their surfaces (bvx_boolean). Whenever a grid comes in or goes out the
 * bits are what there is: a mesh is then voxelized, on the grid's own lattice or on one around both
 * meshes. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

typedef struct boolean_options {
    bvx_boolean_options meshes;
    int32_t resample; /* grids of other lattices are sampled */
} boolean_options;

#define OWN(name) CLI_OWN(boolean_options, name)

#define FILL_OF_BOOLEAN(name, value, text) (BVX_FILLS_OF_BOOLEAN >> (value)&1) != 0 ? text : "",
#define THIN_OF_BOOLEAN(name, value, text) (value) == BVX_THIN_SHELL ? "" : text,
static const char *const boolean_fill_names[] = {BVX_FILL_LIST(FILL_OF_BOOLEAN) NULL};
static const char *const boolean_thin_names[] = {BVX_THIN_LIST(THIN_OF_BOOLEAN) NULL};

static const cli_argument boolean_rows[] = {
    {.also = cli_takes_output},
    LIST("--resolution", "N", SHARED(resolution), 1, 16777216.0, 1, 1,
         "voxels along the longest axis of both meshes together [256]"),
    {.also = cli_takes_spacing},
    CHOICE("--fill", "RULE", SHARED(fill), boolean_fill_names, BVX_FILL_AUTO,
           "what is inside a mesh. auto: what suits it; parity: nested shells are\n"
           "cavities; nonzero: overlapping and inverted shells are one solid; vote,\n"
           "winding: for meshes with holes [auto]"),
    FLAG("--resample", OWN(resample),
         "bring a grid of another lattice to that of A, by its values at the\n"
         "voxels' centres"),
    {.also = cli_takes_reduction},
    {.also = cli_takes_interpolation},
    {.also = cli_takes_sharp},
    CHOICE("--thin", "WHAT", OWN(meshes.thin), boolean_thin_names, BVX_THIN_KEEP,
           "walls of the meshes too thin for the voxels. keep: whole, about as thick\n"
           "as they are; drop: lost where no centre lies in them, with a warning [keep]"),
    {.also = cli_takes_least_part},
    {.also = cli_takes_keep_largest},
    {.also = cli_takes_file_of_a_mesh},
    {.also = cli_takes_all},
    {0}};

typedef struct boolean_run {
    int32_t operation; /* BVX_BOOLEAN_... */
    int kind;          /* of the output */
    cli_input in[2];   /* A and B */
    uint64_t voxels[2];
    bvx_grid grid;
    bvx_mesh mesh;
    int by_mesh; /* the mesh was made by bvx_boolean */
    bvx_boolean_report report;
    bvx_solid_report solid[2]; /* of the inputs that are meshes */
    int is_mesh[2];
    cli_reduction reduction;
} boolean_run;

static const char *const operation_names[] = {BVX_BOOLEAN_LIST(CLI_NAME_OF) NULL};

enum {
    HAS_GRID = 1 << CLI_FIRST_FACT, /* among the inputs */
    HAS_GRIDS = 2 << CLI_FIRST_FACT /* both inputs */
};

static const cli_rule boolean_rules[] = {
    {.unless = CLI_TO_MESH | CLI_TO_GRID,
     .message = "%f: the name does not end in a format that can be written (" CLI_MESHES_WRITTEN
                ", " CLI_GRIDS_WRITTEN ")%a"},
    {.when = HAS_GRID,
     .given = "--resolution --spacing",
     .message = "%o is for two meshes; a grid brings its own lattice"},
    {.when = HAS_GRID,
     .given = "--interpolation --sharp --no-sharp --least-part --keep-largest --thin",
     .message = "%o is for two meshes that become a mesh"},
    {.when = CLI_TO_GRID,
     .given = "--interpolation --sharp --no-sharp --least-part --keep-largest --thin",
     .message = "%o is for two meshes that become a mesh"},
    {.when = HAS_GRIDS, .given = "--fill", .message = "%o is for meshes"},
    {.unless = HAS_GRIDS, .given = "--resample", .message = "%o is for two grids"},
    {.also = cli_reduction_rules},
    {.also = cli_lattice_rules},
    {.also = cli_sharp_rules},
    {0}};

static int fail_boolean(cli_run *run, const boolean_run *b, bvx_status status)
{
    char about[600];
    snprintf(about, sizeof about, "%s and %s%s", cli_input_name(b->in[0].path), cli_input_name(b->in[1].path),
             status == BVX_ERR_LATTICE ? " (--resample brings B to the lattice of A)" : "");
    return cli_fail_status(run, status, about);
}

/* ---- Meshes ---- */

/* A lattice around what can be left, as bvx_boolean fits it, with an empty voxel on every side. */
static bvx_status fit_boolean_lattice(cli_run *run, const boolean_run *b, bvx_lattice *lattice)
{
    cli_box box[2], fit;

    for (int i = 0; i < 2; i++) cli_mesh_box(&b->in[i].mesh, &box[i]);
    /* What can be left lies in the first box of a difference, in both of an intersection. */
    fit = box[0];
    if (b->operation == BVX_BOOLEAN_UNION || b->operation == BVX_BOOLEAN_XOR) cli_join_boxes(&fit, &box[1]);
    for (int a = 0; a < 3 && b->operation == BVX_BOOLEAN_INTERSECTION; a++) {
        if (box[1].low[a] > fit.low[a]) fit.low[a] = box[1].low[a];
        if (box[1].high[a] < fit.high[a]) fit.high[a] = box[1].high[a];
    }
    /* Boxes that do not meet: any lattice will do for an empty result. */
    for (int a = 0; a < 3 && b->operation == BVX_BOOLEAN_INTERSECTION; a++)
        if (!(fit.low[a] < fit.high[a])) fit = box[0];
    /* The surface of the result must close within the lattice. */
    run->options->padding = 1;
    bvx_mesh_view const corners = cli_corners_of_box(&fit);
    CLI_TRY(cli_make_lattice(run, &corners, lattice));

    /* A mesh that sticks out far needs fewer fraction bits for its vertices to fit. */
    double farthest = 0.0;
    for (int i = 0; i < 2; i++)
        for (int a = 0; a < 3; a++) {
            farthest = fmax(farthest, (lattice->origin[a] - box[i].low[a]) / lattice->spacing[a]);
            farthest = fmax(farthest, (box[i].high[a] - lattice->origin[a]) / lattice->spacing[a]);
        }
    /* A snapped coordinate stays below 2^29. */
    while (lattice->fraction_bits > 4 && ldexp(farthest, lattice->fraction_bits) > 536870912.0)
        lattice->fraction_bits--;
    return BVX_OK;
}

static int combine_meshes(cli_run *run, boolean_run *b)
{
    const boolean_options *const own = run->own;
    bvx_boolean_options o = own->meshes;
    bvx_mesh_view view[2];
    bvx_lattice lattice;

    o.struct_size = sizeof o;
    o.fit.lattice = &lattice;
    o.fill = run->options->fill;
    o.placing.interpolation = run->options->interpolation;
    o.placing.sharp = cli_sharp(run->options);
    o.parts = cli_parts(run);
    o.report = &b->report;
    for (int i = 0; i < 2; i++) bvx_mesh_view_of(&b->in[i].mesh, &view[i]);
    cli_stage_begin(run, "boolean");
    bvx_status status = fit_boolean_lattice(run, b, &lattice);
    if (status == BVX_OK) status = bvx_boolean(run->context, &view[0], &view[1], b->operation, &o, &b->mesh);
    cli_stage_end(run);
    if (status != BVX_OK) return fail_boolean(run, b, status);
    cli_take_warnings(
        run, (const char *const[]){NULL, cli_input_name(b->in[0].path), cli_input_name(b->in[1].path)});
    b->solid[0] = b->report.solid_a;
    b->solid[1] = b->report.solid_b;
    b->voxels[0] = b->report.voxels_a;
    b->voxels[1] = b->report.voxels_b;
    cli_note_voxels(run, &lattice, b->report.voxels);
    return CLI_DONE;
}

/* ---- Grids ---- */

static bvx_status combine_operands(cli_run *run, boolean_run *b, uint64_t *set)
{
    const boolean_options *const own = run->own;
    bvx_grid *const grid[2] = {&b->in[0].grid, &b->in[1].grid};
    int const with = b->in[0].kind == CLI_GRID ? 0 : 1;
    bvx_grid there = {0};
    bvx_window window = {{0, 0, 0}, {0, 0, 0}};
    bvx_lattice lattice = grid[with]->lattice;

    /* Operands that are meshes become grids, on the lattice of the one that is a grid: that cannot be moved without
     * loss, so the mesh comes to it. */
    if (b->in[with].kind == CLI_GRID) {
        memcpy(window.low, grid[with]->low, sizeof window.low);
        memcpy(window.size, grid[with]->size, sizeof window.size);
    } else CLI_TRY(fit_boolean_lattice(run, b, &lattice));
    for (int i = 0; i < 2; i++) {
        if (b->in[i].kind != CLI_MESH) continue;
        /* No cli_take_fill: boolean takes the rule alone, none of its companions. */
        bvx_voxelize_options v = {
            .struct_size = sizeof v, .fill = run->options->fill, .window = window, .report = &b->solid[i]};
        bvx_mesh_view const view = cli_view(&b->in[i].mesh);
        bvx_status const status = bvx_voxelize_solid(run->context, &view, &lattice, &v, grid[i]);
        cli_take_warnings(run, (const char *const[]){cli_input_name(b->in[i].path), NULL, NULL});
        CLI_TRY(status);
    }

    /* The window of A, since what lies outside it is in no result. */
    if (own->resample) {
        memcpy(window.low, grid[0]->low, sizeof window.low);
        memcpy(window.size, grid[0]->size, sizeof window.size);
        CLI_TRY(bvx_grid_resample(run->context, grid[1], &grid[0]->lattice, &window, &there));
        bvx_grid_free(run->context, grid[1]);
        *grid[1] = there;
    }
    for (int i = 0; i < 2; i++) CLI_TRY(bvx_grid_count(run->context, grid[i], &b->voxels[i]));
    CLI_TRY(bvx_grid_combine(run->context, grid[0], grid[1], b->operation, &b->grid));
    CLI_TRY(bvx_grid_count(run->context, &b->grid, set));
    return b->kind == CLI_MESH ? bvx_extract_surface(run->context, &b->grid, NULL, &b->mesh) : BVX_OK;
}

static int write_boolean(cli_run *run, void *work)
{
    boolean_run *const b = work;

    if (b->kind == CLI_GRID) {
        CLI_TRY(cli_check_grid_format(run, run->options->output, &b->grid.lattice));
        return cli_write_grid(run, &b->grid);
    }
    /* An empty grid is an answer; a mesh without triangles is a file that few readers take. */
    if (b->mesh.triangle_count == 0)
        return cli_fail(run, "%s and %s: nothing remains after %s, so there is no mesh to write",
                        cli_input_name(b->in[0].path), cli_input_name(b->in[1].path),
                        operation_names[b->operation]);

    CLI_TRY(cli_reduce(run, &b->mesh, &b->reduction));
    CLI_TRY(cli_check_mesh(run, &b->mesh, 0, run->options->output, "check"));
    return cli_write_mesh(run, &b->mesh);
}

/* Walls of an input too thin for the voxels that are in the result all the same. */
static int is_thin_kept(const boolean_run *b, int i)
{
    return b->by_mesh && (b->report.thin_kept & (i == 0 ? BVX_KEPT_A : BVX_KEPT_B)) != 0;
}

static void tell_boolean(const cli_run *run, const void *work, cli_made *made)
{
    const boolean_run *const b = work;
    cli_text *const t = &made->members;
    const int32_t *const n = run->report.lattice.dims;

    cli_text_add(t, ", \"boolean\": {\"operation\": \"%s\"", operation_names[b->operation]);
    cli_json_count(t, "voxels_a", b->voxels[0]);
    cli_json_count(t, "voxels_b", b->voxels[1]);
    cli_json_count(t, "voxels", run->report.set);
    cli_json_truth(t, "surfaces_kept", b->by_mesh);
    for (int i = 0; i < 2; i++) {
        const bvx_solid_report *const r = &b->solid[i];
        if (!b->is_mesh[i]) continue;
        cli_text_add(t, ", \"%s\": {\"fill\": \"%s\", \"reason\": \"%s\"", i == 0 ? "a" : "b",
                     cli_fill_names[r->fill], cli_fill_reasons[r->fill_reason]);
        cli_json_count(t, "turned", r->turned);
        cli_json_count(t, "unbalanced_rows", r->unbalanced_rows);
        cli_json_losses(t, &run->report.lattice, r);
        cli_json_truth(t, "thin_kept", is_thin_kept(b, i));
        cli_text_add(t, "}");
    }
    if (b->by_mesh) {
        cli_json_truth(t, "sharp", b->report.sharp);
        cli_json_count(t, "crumbs", b->report.crumbs);
        cli_json_count(t, "parts_dropped", b->report.parts_dropped);
    }
    cli_text_add(t, "}");
    cli_tell(made, "%s of %s and %s -> %s\n", operation_names[b->operation], cli_input_name(b->in[0].path),
             cli_input_name(b->in[1].path), run->options->output);
    cli_tell(made, "  lattice     %d x %d x %d\n", (int)n[0], (int)n[1], (int)n[2]);
    cli_tell(made, "  voxels      %" PRIu64 " and %" PRIu64 " give %" PRIu64 "\n", b->voxels[0], b->voxels[1],
             run->report.set);
    if (b->report.crumbs != 0)
        cli_tell(made, "  crumbs      %" PRIu64 " small parts and pockets that are not in the meshes\n",
                 b->report.crumbs);
    if (b->report.parts_dropped != 0)
        cli_tell(made, "  dropped     %" PRIu64 " parts\n", b->report.parts_dropped);
    for (int i = 0; i < 2; i++)
        if (b->is_mesh[i]) cli_tell_fill(&made->text, &b->solid[i]);
    for (int i = 0; i < 2; i++)
        if (is_thin_kept(b, i))
            cli_tell(made, "  thin        %" PRIu64 " voxels at walls of %s below 1.5 voxels: kept\n",
                     b->solid[i].thin_voxels, i == 0 ? "A" : "B");
    if (b->kind != CLI_MESH) return;
    cli_tell_reduction(&b->reduction, made);
    cli_tell_result(&run->report.mesh[0].certificate, made);
}

static int make_boolean(cli_run *run, void *work, cli_made *made)
{
    boolean_run *const b = work;
    const char *const output = run->options->output, *const word = run->options->input[0];
    int kind[2], grids;

    made->write = write_boolean;
    made->untitled = 1;
    for (b->operation = 0; b->operation < 4 && strcmp(word, operation_names[b->operation]) != 0;)
        b->operation++;
    if (b->operation == 4)
        return cli_usage(run, "unknown operation '%s'; it is one of union, intersection, difference and xor",
                         word);
    for (int i = 0; i < 2; i++) {
        CLI_TRY(cli_input_kind(run, run->options->input[1 + i], &kind[i]));
        b->is_mesh[i] = kind[i] == CLI_MESH;
    }
    grids = (kind[0] == CLI_GRID) + (kind[1] == CLI_GRID);
    b->kind = cli_kind_of_format(bvx_format_of_name(output));
    CLI_TRY(cli_check_rules(run, boolean_rules, (grids != 0 ? HAS_GRID : 0u) | (grids == 2 ? HAS_GRIDS : 0u),
                            NULL));
    b->by_mesh = grids == 0 && b->kind == CLI_MESH;
    CLI_TRY(b->kind == CLI_GRID ? cli_open_grid_output(run, output) : cli_open_output(run, output));
    for (int i = 0; i < 2; i++) CLI_TRY(cli_read_input(run, run->options->input[1 + i], &b->in[i]));
    if (b->by_mesh) return combine_meshes(run, b);

    uint64_t set = 0;
    cli_stage_begin(run, "boolean");
    bvx_status const status = combine_operands(run, b, &set);
    cli_stage_end(run);
    if (status != BVX_OK) return fail_boolean(run, b, status);
    cli_note_voxels(run, &b->grid.lattice, set);
    return CLI_DONE;
}

static const cli_owned boolean_owns[] = {CLI_OWNS(MESH, boolean_run, mesh),
                                         CLI_OWNS(GRID, boolean_run, grid),
                                         CLI_OWNS_ALL(INPUT, boolean_run, in),
                                         {0}};

const cli_command cli_boolean = {
    .name = "boolean",
    .bit = CLI_BOOLEAN,
    .least_inputs = 3,
    .most_inputs = 3,
    .usage = "OPERATION A B -o OUT [options]",
    .does = "union, intersection, difference or xor of two bodies",
    .details = "OPERATION is union, intersection, difference (A without B) or xor. Two meshes\n"
               "(" CLI_MESHES_READ ", also with .gz) become a closed, manifold, oriented mesh\n"
               "that does not cross itself (" CLI_MESHES_WRITTEN "),\n"
               "its vertices on their surfaces, whatever is wrong with how they meet; walls thinner than\n"
               "voxels are kept. With --triangles or --error the edges of the result collapse. Grids\n"
               "(" CLI_GRIDS ") of one lattice are combined bit by bit; beside a grid a mesh is\n"
               "voxelized on its lattice. The result is a mesh or a grid, as the ending of OUT says.",
    .example =
        "bitvox faces fixtures/knot.ply -o blocks.ply --resolution 12\n"
        "bitvox boolean difference blocks.ply fixtures/knot.ply -o mould.ply --resolution 128 --sharp\n"
        "bitvox boolean union fixtures/knot.ply blocks.ply -o both.bvx",
    .most = "--resolution --spacing --fill --resample --triangles --error --sharp --thin "
            "--keep-largest --threads --memory-limit --json",
    .rows = boolean_rows,
    .own = sizeof(boolean_options),
    .job = {.size = sizeof(boolean_run), .make = make_boolean, .tell = tell_boolean, .owns = boolean_owns}};
