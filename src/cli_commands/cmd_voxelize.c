/* cmd_voxelize.c - bitvox voxelize: the solid or the surface of a mesh as a grid, or the distances to it. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <math.h>
#include <string.h>

enum { FIELD_HALF_WIDTH = 3, FIELD_MOST_PADDING = 16 };

static void start_voxelize(void *options)
{
    cli_voxelize_options *const o = options;
    o->solid = (bvx_voxelize_options){.struct_size = sizeof o->solid};
    o->cloud = (bvx_points_options){.struct_size = sizeof o->cloud};
    o->field = (bvx_field_options){.struct_size = sizeof o->field, .half_width = FIELD_HALF_WIDTH};
}

#define OWN(name) CLI_OWN(cli_voxelize_options, name)

static const char *const check_thin_names[] = {BVX_CHECK_LIST(CLI_NAME_OF) NULL};
static const char *const up_names[] = {BVX_UP_LIST(CLI_NAME_OF) NULL};

static const cli_argument voxelize_rows[] = {
    {.also = cli_takes_output},
    {.also = cli_takes_output_dir},
    {.also = cli_takes_lattice},
    LIST("--window", "A,B,C,D,E,F", SHARED(window), 0, LARGEST_SIDE, 6, 6,
         "only voxels A..D-1, B..E-1, C..F-1 of the lattice"),
    WHOLE("--padding", "N", SHARED(padding), 0, 65536,
          "empty voxels added on every side [0; --mode field: the half-width, at most 16]"),
    CHOICE("--mode", "MODE", OWN(mode), cli_mode_names, CLI_MODE_SOLID,
           "solid: what lies inside; conservative: all voxels that the surface\n"
           "touches; thin: those that keep a flood through faces out; sampled:\n"
           "those of points less than a voxel apart; field: distances from the\n"
           "voxels' centres to the surface, negative inside [solid]"),
    FROM_TO("--half-width", "W", OWN(field.half_width), 0, 1e9,
            "with --mode field: how far from the surface centres have a distance,\n"
            "in voxels; 0: all have one [3]"),
    CHOICE("--sign", "RULE", SHARED(sign), cli_sign_names, BVX_FILL_AUTO,
           "with --mode field, what is inside: auto, parity, nonzero, vote, winding\n"
           "as by --fill; normal: the side of the closest triangle; none [auto]"),
    FLAG("--vectors", SHARED(vectors), "with --mode field: vectors to the closest points, not distances"),
    CHOICE("--value-type", "TYPE", OWN(field.value_type), cli_value_type_names, BVX_F32,
           "with --mode field: f32 or f64 [f32]"),
    {.also = cli_takes_fill},
    WHOLE("--close-gaps", "N", SHARED(close_gaps), 0, 65535,
          "with --fill flood, or --body: gaps of up to N voxels hold the flood [0]"),
    WHOLE("--minimum", "N", OWN(cloud.minimum), 1, 2147483647.0,
          "of a cloud: points that a voxel needs to be set [1]"),
    FLAG("--body", OWN(cloud.body), "of a cloud: set what a flood from outside cannot reach too"),
    {.also = cli_takes_add_shell},
    CHOICE("--check-thin", "WHEN", OWN(solid.check_thin), check_thin_names, BVX_CHECK_AUTO,
           "look for walls too thin for the voxels, for a warning with their position.\n"
           "auto: in whole lattices; always; never [auto]"),
    NUMBER("--base", "H", OWN(solid.base),
           "with --fill below: the height that columns stand on [the lattice's\n"
           "low end]"),
    FILE_NAME("--second", "MESH", OWN(second),
              "with --fill below: what lies between IN and this terrain; reports cut\n"
              "and fill"),
    CHOICE("--up", "AXIS", OWN(solid.up), up_names, BVX_UP_Z, "with --fill below: x, y or z [z]"),
    FLAG("--segments", OWN(segments),
         "of a mesh with materials or colours, to .nrrd: voxels are labels of the\n"
         "nearest ones, with their colours, as .vox has them without it"),
    {.also = cli_takes_selection},
    {.also = cli_takes_below},
    {.also = cli_takes_raw},
    {.also = cli_takes_reduction},
    {.also = cli_takes_sharp},
    {.also = cli_takes_output_origin},
    {.also = cli_takes_quantize},
    {.also = cli_takes_kept_parts},
    {.also = cli_takes_all},
    {0}};

typedef struct voxel_job {
    bvx_mesh mesh, second; /* second: --second */
    bvx_mesh_view view, second_view;
    cli_box box; /* what the lattice must hold */
    int boxed;   /* the lattice is fitted to the box, not to the mesh */
    bvx_window window;
    bvx_grid grid;
    bvx_field field;   /* of --mode field */
    int cloud;         /* 1: mesh holds points only */
    cli_voxels voxels; /* the output, but of fields */
} voxel_job;

/* ---- what is requested ---- */

enum {
    SETS_SOLID = 1 << CLI_FIRST_FACT, /* --mode */
    SETS_FIELD = 2 << CLI_FIRST_FACT,
    LOOKS_FOR_THIN = 4 << CLI_FIRST_FACT, /* --check-thin always */
    TO_SEGMENTS = 8 << CLI_FIRST_FACT     /* .nrrd or .vox */
};

static const cli_rule cloud_rules[] = {
    {.when = CLI_OF_CLOUD,
     .given = "--mode --fill --add-shell --check-thin --half-width --sign --vectors "
              "--value-type --sharp --no-sharp --segments",
     .message = "%o is for meshes; %i is a cloud of points"},
    {.when = CLI_OF_MESH, .given = "--minimum --body", .message = "%o is for clouds of points; %i is a mesh"},
    {.when = CLI_OF_CLOUD, .given = "--close-gaps", .lacking = "--body", .message = "%o needs --body"},
    {.when = CLI_OF_CLOUD,
     .given = "--body",
     .beside = "--window",
     .message = "%o needs the whole lattice, no %b"},
    {0}};

static const cli_rule fill_rules[] = {
    {.unless = CLI_FILLS_BELOW, .given = "--base --second --up", .message = "%o needs --fill below"},
    {.unless = CLI_FILLS_FLOOD,
     .given = "--close-gaps",
     .lacking = "--body",
     .message = "%o needs --fill flood, or --body for clouds"},
    {.also = cli_fill_rules},
    {.when = CLI_FILLS_BELOW | LOOKS_FOR_THIN,
     .given = "--check-thin",
     .message = "%o has no use with --fill below: it is for bodies"},
    {0}};

/* The word is the mode's name. */
static const cli_rule mesh_rules[] = {
    {.also = cli_to_voxels_rules},
    {.also = cli_lattice_rules},
    {.unless = SETS_SOLID,
     .given = "--fill --close-gaps --add-shell --check-thin --base --second --up "
              "--sharp --no-sharp",
     .message = "%o is for solids; --mode %w has no use for it"},
    {.unless = SETS_FIELD,
     .given = "--half-width --sign --vectors --value-type",
     .message = "%o is for fields; --mode %w has no use for it"},
    {.when = SETS_FIELD | CLI_KEEPS_PARTS,
     .message = "--keep-largest and --least-part are for voxels; --mode field has no use for them"},
    {.when = SETS_FIELD,
     .unless = CLI_TO_DISTANCES,
     .message = "%f: fields are written as .npy, .nrrd, .vti, .vdb or .nvdb"},
    {.when = SETS_FIELD,
     .given = "--segments",
     .message = "%o is for voxels; --mode field has no use for it"},
    {.unless = TO_SEGMENTS, .given = "--segments", .message = "%f: labels are written as .nrrd or .vox"},
    {.also = fill_rules},
    {.when = CLI_OF_CLOUD, .also = cloud_rules},
    {.when = CLI_OF_GRID,
     .message =
         "%i is a grid already: 'bitvox convert' writes it in another format; --level, --range or --label "
         "choose voxels of a volume"},
    {0}};

/* ---- the lattice ---- */

static int choose_lattice(cli_run *run, voxel_job *job)
{
    const cli_voxelize_options *const own = run->own;
    const cli_options *const o = run->options;
    bvx_lattice *const l = &run->report.lattice;
    int const based = cli_given(run, "--base");
    int const up = own->solid.up == BVX_UP_Z ? 2 : own->solid.up - BVX_UP_X;
    bvx_lattice unused;

    if (!job->cloud && (own->second != NULL || based)) {
        /* Refuses what has no box. */
        CLI_TRY(
            cli_check_call(run, bvx_lattice_fit(run->context, &job->view, 1, &unused), cli_first_name(run)));
        cli_mesh_box(&job->mesh, &job->box);
        if (own->second != NULL) {
            cli_box other;
            CLI_TRY(cli_check_call(run, bvx_lattice_fit(run->context, &job->second_view, 1, &unused),
                                   own->second));
            cli_mesh_box(&job->second, &other);
            cli_join_boxes(&job->box, &other);
        }
        if (based && own->solid.base < job->box.low[up]) job->box.low[up] = own->solid.base;
        job->boxed = 1;
    }
    bvx_mesh_view const corners = cli_corners_of_box(&job->box);
    const bvx_mesh_view *const around = job->boxed && !job->cloud ? &corners : &job->view;
    CLI_TRY(cli_check_call(run, cli_make_lattice(run, around, l), cli_first_name(run)));
    run->report.has_lattice = 1;
    /* With a window only its own voxels take memory. */
    if (job->window.size[0] == 0) CLI_TRY(cli_check_far(run, o->input[0], &job->view, l));
    if (CLI_HOLDS(run, CLI_TO_MESH)) return CLI_DONE;
    return cli_check_grid_format(run, o->output, l);
}

/* ---- voxels ---- */

static void tell_surface(const cli_run *run, const bvx_surface_report *r, cli_made *made)
{
    const cli_voxelize_options *const own = run->own;
    cli_text *const t = &made->members;
    const char *const mode = cli_mode_names[own->mode];
    double const mean = r->triangles != 0 ? (double)r->parts / (double)r->triangles : 0.0;

    cli_text_add(&made->text, "  surface     %s\n", mode);
    cli_text_add(t, ", \"surface\": {\"mode\": \"%s\"", mode);
    if (own->mode == CLI_MODE_SAMPLED) {
        cli_text_add(&made->text,
                     "  samples     %" PRIu64 " of %" PRIu64
                     " triangles, mean subdivision coefficient %.3f\n",
                     r->samples, r->triangles, mean);
        cli_json_count(t, "triangles", r->triangles);
        cli_json_count(t, "samples", r->samples);
        cli_json_value(t, "mean_subdivision", mean);
    }
    cli_text_add(t, "}");
}

static void tell_cloud(const cli_run *run, const bvx_points_report *r, cli_made *made)
{
    const cli_voxelize_options *const own = run->own;
    cli_text *const lines = &made->text, *const t = &made->members;

    cli_text_add(lines, "  points      %" PRIu64, r->inside);
    if (r->outside != 0) cli_text_add(lines, ", and %" PRIu64 " outside", r->outside);
    cli_text_add(lines, "\n  occupied    %" PRIu64 "\n", r->occupied);
    if (own->cloud.body) cli_text_add(lines, "  filled      %" PRIu64 "\n", r->filled);

    cli_text_add(t, ", \"cloud\": {\"inside\": %" PRIu64, r->inside);
    cli_json_count(t, "outside", r->outside);
    cli_json_count(t, "occupied", r->occupied);
    cli_json_count(t, "filled", r->filled);
    cli_json_count(t, "pockets", r->pockets);
    cli_text_add(t, "}");

    if (made->set == 0)
        cli_advise(made, BVX_WARN_EMPTY, "the result is empty: no voxel holds so many points");
    else if (own->cloud.body && r->pockets == 0)
        cli_advise(
            made, BVX_WARN_EMPTY,
            "the body has no inside: the flood comes in everywhere; try --close-gaps of more than %" PRId32
            ", or larger voxels",
            run->options->close_gaps);
}

/* ---- --mode field ---- */

static bvx_status make_field(const cli_run *run, voxel_job *job, cli_made *made)
{
    const cli_voxelize_options *const own = run->own;
    bvx_field *const field = &job->field;
    bvx_field_options o = own->field;
    uint64_t inside = 0;

    if (o.half_width == 0.0) o.half_width = (double)INFINITY;
    o.sign = run->options->sign;
    o.no_vectors = !run->options->vectors;
    o.window = job->window;
    CLI_TRY(bvx_measure_field(run->context, &job->view, &run->report.lattice, &o, field));
    if (field->inside.words != NULL) CLI_TRY(bvx_grid_count(run->context, &field->inside, &inside));

    made->field = field;
    made->set = field->value_count;

    cli_text *const t = &made->members;

    cli_text_add(&made->text, "  field       %s within %.9g\n  sign        %s",
                 run->options->vectors ? "vectors" : "distances", field->half_width,
                 cli_fill_names[field->sign]);
    if (field->sign != BVX_FILL_NONE) cli_text_add(&made->text, ", %" PRIu64 " centres inside", inside);
    cli_text_add(&made->text, "\n");

    cli_text_add(t, ", \"field\": {\"sign\": \"%s\"", cli_fill_names[field->sign]);
    cli_json_value(t, "half_width", field->half_width);
    cli_json_count(t, "values", field->value_count);
    cli_json_count(t, "inside", inside);
    cli_json_truth(t, "vectors", run->options->vectors);
    cli_text_add(t, ", \"value_type\": \"f%d\"}", field->value_type == BVX_F64 ? 64 : 32);
    if (field->value_count == 0)
        cli_advise(made, BVX_WARN_EMPTY, "no voxel's centre is within %.9g of the mesh", field->half_width);
    return BVX_OK;
}

/* ---- the result ---- */

typedef struct voxel_reports {
    bvx_solid_report solid;
    bvx_surface_report surface;
    bvx_points_report cloud;
} voxel_reports;

static bvx_status make_voxels(cli_run *run, voxel_job *job, voxel_reports *reports, cli_made *made)
{
    const cli_voxelize_options *const own = run->own;
    if (job->cloud) {
        bvx_points_options p = own->cloud;
        p.close_gaps = run->options->close_gaps;
        p.window = job->window;
        p.report = &reports->cloud;
        return bvx_voxelize_points(run->context, &job->view, &run->report.lattice, &p, &job->grid);
    }
    if (own->mode == CLI_MODE_FIELD) return make_field(run, job, made);
    if (own->mode == CLI_MODE_SOLID) {
        bvx_voxelize_options v = own->solid;
        cli_take_fill(run, &v);
        v.report = &reports->solid;
        v.window = job->window;
        v.has_base = cli_given(run, "--base");
        if (own->second != NULL) v.second = &job->second_view;
        return bvx_voxelize_solid(run->context, &job->view, &run->report.lattice, &v, &job->grid);
    }
    /* The modes of the program begin with the solid, those of the library do not. */
    bvx_surface_options s = {.struct_size = sizeof s,
                             .mode = own->mode - CLI_MODE_CONSERVATIVE + BVX_SURFACE_CONSERVATIVE,
                             .window = job->window,
                             .report = &reports->surface};
    return bvx_voxelize_surface(run->context, &job->view, &run->report.lattice, &s, &job->grid);
}

static bvx_status keep_voxels(cli_run *run, voxel_job *job, cli_made *made)
{
    if (CLI_HOLDS(run, CLI_KEEPS_PARTS)) CLI_TRY(cli_keep_parts(run, &job->grid, &job->grid));
    return bvx_grid_count(run->context, &job->grid, &made->set);
}

static int make_all(cli_run *run, voxel_job *job, cli_made *made)
{
    const cli_voxelize_options *const own = run->own;
    const cli_options *const o = run->options;
    voxel_reports reports = {0};

    cli_stage_begin(run, "voxelize");
    CLI_TRY(choose_lattice(run, job));
    bvx_status status = make_voxels(run, job, &reports, made);
    cli_take_warnings(run, (const char *const[]){NULL, NULL, NULL});
    cli_stage_end(run);
    if (status == BVX_OK && made->field == NULL) status = keep_voxels(run, job, made);
    CLI_TRY(cli_check_call(run, status, cli_first_name(run)));
    if (made->field != NULL) return CLI_DONE;

    int const solid = !job->cloud && own->mode == CLI_MODE_SOLID;

    if (job->cloud) tell_cloud(run, &reports.cloud, made);
    else if (solid) cli_tell_solid(run, &job->grid, &reports.solid, made);
    else tell_surface(run, &reports.surface, made);

    if (made->set == 0 && !job->cloud)
        cli_advise(made, BVX_WARN_EMPTY, "the result is empty: %s",
                   solid ? "the mesh contains no voxel's centre"
                         : "the surface meets no voxel of the "
                           "window");
    job->voxels.name = o->input[0];
    job->voxels.grid = job->voxels.solid = &job->grid;
    /* Only the plain solid of one mesh has the mesh as its surface. */
    if (!job->cloud && own->mode == CLI_MODE_SOLID && !o->add_shell && own->second == NULL)
        job->voxels.source = &job->mesh;
    made->voxels = &job->voxels;
    if (!job->cloud && (own->segments || (bvx_format_of_name(o->output) == BVX_FORMAT_VOX &&
                                          (job->mesh.colours != NULL || job->mesh.materials != NULL))))
        job->voxels.labels_of = &job->mesh;
    return CLI_DONE;
}

static int make_voxelize(cli_run *run, void *work, cli_made *made)
{
    const cli_voxelize_options *const own = run->own;
    cli_options *const o = run->options;
    voxel_job *const job = work;
    uint32_t facts = CLI_OF_CLOUD;
    int kind = CLI_MESH;

    /* By the input's name; of a cloud in .ply it is known once it is read. */
    if (cli_input_format(run, o->input[0]) != BVX_FORMAT_XYZ) {
        CLI_TRY(cli_input_kind(run, o->input[0], &kind));
        facts = kind == CLI_GRID ? CLI_OF_GRID : 0;
    }
    int32_t const format = bvx_format_of_name(o->output);
    if (own->mode == CLI_MODE_SOLID) facts |= SETS_SOLID;
    if (own->mode == CLI_MODE_FIELD) facts |= SETS_FIELD;
    if (format == BVX_FORMAT_NRRD || format == BVX_FORMAT_VOX) facts |= TO_SEGMENTS;
    if (own->solid.check_thin == BVX_CHECK_ALWAYS) facts |= LOOKS_FOR_THIN;
    CLI_TRY(cli_check_rules(run, mesh_rules, facts, cli_mode_names[own->mode]));
    /* Standard input can be read once, and IN may be it. */
    if (own->second != NULL && strcmp(own->second, "-") == 0)
        return cli_usage(run, "--second takes a file with a name, not standard input");
    if (own->second != NULL) CLI_TRY(cli_input_kind(run, own->second, &kind));
    if (own->second != NULL && kind == CLI_GRID)
        return cli_usage(run, "--second takes a mesh; %s is a grid", own->second);
    CLI_TRY(cli_window_option(run, &job->window));

    int const chosen = cli_given(run, "--padding") || o->origin.given;
    if (!chosen && own->mode == CLI_MODE_FIELD) {
        /* The band reaches so far beyond the mesh. Who asks for a wide one wants distances inside, not a
         * lattice many times as large; a field without an end takes the usual room. */
        double const width = own->field.half_width;
        o->padding = width > 0.0 ? (int32_t)ceil(fmin(width, FIELD_MOST_PADDING)) : FIELD_HALF_WIDTH;
    } else if (!chosen && CLI_HOLDS(run, CLI_TO_MESH) && o->fill != BVX_FILL_BELOW) {
        /* The surface of a solid ends where the mesh does, also at the lattice's sides. */
        o->padding = 1;
    }
    CLI_TRY(cli_open_voxels(run));

    CLI_TRY(cli_read_mesh_or_cloud(run, o->input[0], &job->mesh, &job->cloud));
    /* Only now it is known whether a .ply file holds a cloud. */
    CLI_TRY(cli_check_rules(run, cloud_rules, job->cloud ? CLI_OF_CLOUD : CLI_OF_MESH, NULL));
    if (own->second != NULL) CLI_TRY(cli_read_mesh(run, own->second, &job->second));
    bvx_mesh_view_of(&job->mesh, &job->view);
    bvx_mesh_view_of(&job->second, &job->second_view);

    return make_all(run, job, made);
}

static const cli_owned voxelize_owns[] = {
    CLI_OWNS(VOXELS, voxel_job, voxels), CLI_OWNS(FIELD, voxel_job, field), CLI_OWNS(GRID, voxel_job, grid),
    CLI_OWNS(MESH, voxel_job, second),   CLI_OWNS(MESH, voxel_job, mesh),   {0}};

static const cli_job mesh_job = {.size = sizeof(voxel_job), .make = make_voxelize, .owns = voxelize_owns};

static int choose_voxelize(cli_run *run, const cli_job **job)
{
    *job = cli_is_volume(run, run->options->input[0]) ? &cli_voxelize_volume : &mesh_job;
    return CLI_DONE;
}

const cli_command cli_voxelize = {
    .name = "voxelize",
    .bit = CLI_VOXELIZE,
    .least_inputs = 1,
    .most_inputs = 1,
    .usage = "IN -o OUT [options]",
    .does = "a mesh, a cloud of points or a volume as a grid of voxels",
    .details =
        "Reads a mesh (" CLI_MESHES_READ ", also with .gz) and writes the voxels whose centres lie\n"
        "inside, or with --mode those of its surface: .npy (NumPy, bool, axes x, y, z), .binvox, .vox,\n"
        ".nrrd, .vti, .bvx, .vdb (OpenVDB) or .nvdb. .npy and .vox hold no lattice: it goes to OUT.json beside them.\n"
        "--mode field writes the distances from the centres to the mesh: .npy, .nrrd, .vti, .vdb, .nvdb, f32 or f64.\n"
        "Where OUT is a mesh it is the voxels' closed surface: of a solid with its vertices on the mesh, of\n"
        "other modes half way between set and empty voxels.\n"
        "Which voxels are inside a mesh with holes is a matter of the rule: --fill.\n"
        "Of a volume (.nrrd .nhdr .npy .vti .raw) --level, --range or --label choose the voxels. Where OUT "
        "is a\n"
        "mesh (" CLI_MESHES_WRITTEN
        ") it becomes their closed surface: of --level by the values between the\n"
        "samples, else at the middle between set and empty ones, and edges collapse with --triangles or\n"
        "--error; 'bitvox labels' writes one a label. Samples that are NaN or infinite are outside, and counted.\n\n"
        "Of a cloud of points (.xyz, or .ply without faces) the voxels that hold points are set, with "
        "--body\n"
        "also what lies behind them.",
    .example = "bitvox voxelize fixtures/knot.ply -o knot.npy --resolution 128\n"
               "bitvox voxelize fixtures/knot.ply -o shell.vti --mode thin\n"
               "bitvox voxelize fixtures/knot.ply -o distance.vti --mode field --resolution 64\n"
               "bitvox voxelize fixtures/waves.nhdr -o waves.ply --level 120 --triangles 2000\n"
               "bitvox voxelize fixtures/ball.xyz -o ball.bvx --spacing 0.1 --body --close-gaps 1",
    .most = "--output-dir --resolution --spacing --mode --fill --level --range --label "
            "--keep-largest --threads --memory-limit --json",
    .rows = voxelize_rows,
    .start = start_voxelize,
    .own = sizeof(cli_voxelize_options),
    .choose = choose_voxelize};
