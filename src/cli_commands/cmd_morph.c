/* cmd_morph.c - bitvox morph: voxels grown, shrunk, smoothed and hollowed, and the distances between them. */
#include "cli_commands/commands.h"
#include "cli_args/rows.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct morph_options {
    bvx_morph_options change;
    bvx_hollow_options hollow;
    bvx_distance_options distance;
    int32_t neighbourhood; /* index into cli_neighbours */
    int32_t action;        /* DILATE .. */
    int32_t drain_side;    /* 0 to 5: x-low, x-high, y-low ... */
    int32_t value_type;    /* of distances, BVX_F32 or BVX_F64 */
} morph_options;

static void start_morph(void *options)
{
    morph_options *const o = options;
    o->change = (bvx_morph_options){.struct_size = sizeof o->change, .steps = 1};
    o->hollow = (bvx_hollow_options){.struct_size = sizeof o->hollow};
    o->distance = (bvx_distance_options){.struct_size = sizeof o->distance};
    o->drain_side = 4;
    o->value_type = BVX_F32;
}

#define OWN(name) CLI_OWN(morph_options, name)

static const char *const side_names[] = {BVX_SIDE_LIST(CLI_NAME_OF) NULL};
static const char *const distance_names[] = {BVX_DISTANCE_LIST(CLI_NAME_OF) NULL};
static const char *const beyond_names[] = {BVX_BEYOND_LIST(CLI_NAME_OF) NULL};

static const cli_argument morph_rows[] = {
    {.also = cli_takes_output},
    {.also = cli_takes_lattice},
    WHOLE("--padding", "N", SHARED(padding), 0, 65536,
          "empty voxels added on every side [0; dilate: what it reaches]"),
    {.also = cli_takes_fill_of_solids},
    {.also = cli_takes_reduction},
    {.also = cli_takes_sharp},
    {.also = cli_takes_file_of_a_mesh},
    CHOICE("--neighbourhood", "N", OWN(neighbourhood), cli_connectivity_names, 0,
           "6: voxels across faces; 18: and edges; 26: and corners [6]"),
    WHOLE("--steps", "N", OWN(change.steps), 1, 65536, "how many times the neighbourhood is applied [1]"),
    FROM_TO("--radius", "R", OWN(change.radius), 0, 1e300,
            "a ball in place of the neighbourhood, in the lattice's unit"),
    FROM_TO("--thickness", "T", OWN(hollow.thickness), 0, 1e300,
            "hollow: of the shell, in the lattice's unit"),
    FROM_TO("--drain", "R", OWN(hollow.drain_radius), 0, 1e300,
            "hollow: radius of a round hole through the shell [none]"),
    CHOICE("--drain-side", "SIDE", OWN(drain_side), side_names, 0,
           "where the hole comes from: x-low, x-high, y-low, y-high, z-low or\n"
           "z-high [z-low]"),
    CHOICE("--side", "NAME", OWN(distance.side), distance_names, BVX_DISTANCE_OUTSIDE,
           "distance. outside: of each centre to the nearest set one; inside: to\n"
           "the nearest empty one; signed: the first less the second [outside]"),
    CHOICE("--beyond", "WHAT", OWN(distance.beyond), beyond_names, 0,
           "what lies beyond the grid: empty or set voxels; distance: or nothing\n"
           "[empty; distance: nothing]"),
    CHOICE("--value-type", "TYPE", OWN(value_type), cli_value_type_names, BVX_F32,
           "distance: f32 or f64 [f32]"),
    {.also = cli_takes_all},
    {0}};

typedef enum morph_action { DILATE, ERODE, OPEN, CLOSE, HOLLOW, DISTANCE, ACTIONS } morph_action;
static const char *const action_names[ACTIONS + 1] = {BVX_MORPH_LIST(CLI_NAME_OF) "hollow", "distance", NULL};

typedef struct morph_job {
    morph_action action;
    cli_input in;
    uint64_t before; /* set voxels of the input */
    int roomy;       /* its lattice was given room for all that is added */
    bvx_grid out;
    bvx_hollow_report hollow;
    bvx_field field;   /* of a mesh whose walls move */
    bvx_field apart;   /* distances of voxels; its arrays are malloc's */
    bvx_grid hole;     /* that is drilled into it */
    cli_voxels voxels; /* the output */
} morph_job;

/* ---- what is requested ---- */

static const char *action_at(const void *user, int i)
{
    (void)user;
    return action_names[i];
}

enum {
    GROWS = 1 << CLI_FIRST_FACT,
    HOLLOWS = 2 << CLI_FIRST_FACT,
    MEASURES = 4 << CLI_FIRST_FACT,
    IS_THICK = 8 << CLI_FIRST_FACT,       /* --thickness above 0 */
    DRAINS = 16 << CLI_FIRST_FACT,        /* --drain above 0 */
    NOTHING_BEYOND = 32 << CLI_FIRST_FACT /* --beyond nothing */
};

/* The word is the action's name. */
static const cli_rule action_rules[] = {
    {.unless = GROWS, .given = "--neighbourhood --steps --radius", .message = "morph %w has no use for %o"},
    {.unless = HOLLOWS, .given = "--thickness --drain --drain-side", .message = "morph %w has no use for %o"},
    {.unless = MEASURES, .given = "--side --value-type", .message = "morph %w has no use for %o"},
    {.given = "--radius",
     .beside = "--neighbourhood --steps",
     .message = "%o replaces --neighbourhood and --steps"},
    {.when = HOLLOWS, .unless = IS_THICK, .message = "morph hollow needs --thickness, above 0"},
    {.unless = DRAINS, .given = "--drain-side", .message = "%o needs --drain"},
    {.when = NOTHING_BEYOND,
     .unless = MEASURES,
     .given = "--beyond",
     .message = "--beyond nothing is for distances"},
    {.when = MEASURES,
     .unless = CLI_TO_DISTANCES,
     .message = "%f: distances are written as .npy, .nrrd, .vti, .vdb or .nvdb"},
    {.unless = MEASURES, .also = cli_to_voxels_rules},
    {.when = MEASURES,
     .given = "--triangles --error --error-kind --sharp --no-sharp",
     .message = "morph %w has no use for %o"},
    {0}};

/* The word is the input's name. */
static const cli_rule input_rules[] = {
    {.when = CLI_OF_GRID, .also = cli_grid_rules},
    {.when = CLI_OF_GRID, .given = "--sharp --no-sharp", .message = "%o is for meshes; %w is a grid"},
    {.also = cli_lattice_rules},
    {.also = cli_fill_rules},
    {0}};

/* ---- the voxels ---- */

static int make_room(cli_run *run, morph_job *job)
{
    const morph_options *const own = run->own;
    cli_options *const o = run->options;
    bvx_lattice l;

    if (job->action != DILATE || cli_given(run, "--padding") || o->origin.given) return CLI_DONE;
    bvx_mesh_view const view = cli_view(&job->in.mesh);
    CLI_TRY(cli_check_call(run, cli_make_lattice(run, &view, &l), cli_input_name(job->in.path)));
    double const least = l.spacing[0] < l.spacing[1] ? l.spacing[0] : l.spacing[1];
    double voxels = cli_given(run, "--radius")
                        ? ceil(own->change.radius / (l.spacing[2] < least ? l.spacing[2] : least))
                        : (double)own->change.steps;
    /* A surface needs an empty voxel around it. */
    voxels += CLI_HOLDS(run, CLI_TO_MESH);
    o->padding = voxels < 65536.0 ? (int32_t)voxels : 65536;
    job->roomy = voxels <= 65536.0;
    return CLI_DONE;
}

static int open_morph(cli_run *run, morph_job *job, cli_made *made)
{
    const morph_options *const own = run->own;
    const char *const path = run->options->input[1];
    int kind;
    job->action = (morph_action)own->action;
    uint32_t facts = job->action == HOLLOW ? HOLLOWS : job->action == DISTANCE ? MEASURES : GROWS;
    if (own->hollow.thickness > 0.0) facts |= IS_THICK;
    if (own->hollow.drain_radius > 0.0) facts |= DRAINS;
    if (own->distance.beyond == BVX_BEYOND_NOTHING) facts |= NOTHING_BEYOND;
    CLI_TRY(cli_check_rules(run, action_rules, facts, action_names[job->action]));
    CLI_TRY(cli_input_kind(run, path, &kind));
    if (kind != CLI_GRID && CLI_HOLDS(run, CLI_TO_MESH) && !cli_given(run, "--padding") &&
        !run->options->origin.given)
        run->options->padding = 1; /* the surface ends where the mesh does, also at the lattice's sides */
    CLI_TRY(cli_check_rules(run, input_rules, kind == CLI_GRID ? CLI_OF_GRID : 0, cli_input_name(path)));
    CLI_TRY(cli_open_voxels(run));
    CLI_TRY(cli_read_input(run, run->options->input[1], &job->in));
    if (job->in.kind == CLI_MESH) {
        CLI_TRY(make_room(run, job));
        CLI_TRY(cli_fill_input(run, &job->in));
    }
    made->placed = job->in.kind == CLI_MESH || job->in.placed;
    bvx_grid_count(run->context, &job->in.grid, &job->before);
    return CLI_DONE;
}

/* ---- walls at their distance from a mesh ---- */

/* The voxels that a drill takes on its way into a hollow. The hollow by distances from the mesh lies a
 * little deeper than that by distances from empty voxels, so the drill goes deeper too. */
static bvx_status drill_hole(cli_run *run, morph_job *job, bvx_grid *hole)
{
    const morph_options *const own = run->own;
    const double *const h = job->in.grid.lattice.spacing;
    double const most = fmax(h[0], fmax(h[1], h[2]));
    bvx_hollow_options d = own->hollow;

    d.drain_side = 1 << own->drain_side;
    d.beyond = own->distance.beyond == BVX_BEYOND_SET;
    for (int deep = 1; deep >= 0; deep--) {
        /* Deeper first, and as deep as requested where nothing lies so deep. */
        d.thickness = own->hollow.thickness + deep * 1.75 * most;
        d.drain_radius = 0.0;
        d.report = NULL;
        /* Made twice, without and with the hole: what only the first one has is the hole. */
        CLI_TRY(bvx_grid_hollow(run->context, &job->in.grid, &d, &job->out));
        d.drain_radius = own->hollow.drain_radius;
        d.report = &job->hollow;
        CLI_TRY(bvx_grid_hollow(run->context, &job->in.grid, &d, hole));
        if (job->hollow.hollowed != 0) break;
    }
    return bvx_grid_combine(run->context, &job->out, hole, BVX_BOOLEAN_DIFFERENCE, hole);
}

static bvx_status move_walls(cli_run *run, morph_job *job)
{
    const morph_options *const own = run->own;
    double const far = job->action == HOLLOW ? own->hollow.thickness : own->change.radius;
    job->voxels.offset = job->action == DILATE ? far : -far;
    CLI_TRY(cli_measure_source(run, &job->in.mesh, &job->in.grid, far, &job->field));
    if (job->action == HOLLOW && own->hollow.drain_radius > 0.0) CLI_TRY(drill_hole(run, job, &job->hole));
    CLI_TRY(bvx_grid_create(run->context, &job->in.grid.lattice, NULL, &job->out));

    /* Grown, shrunk and hollowed by the distance to the mesh itself, not to the centres of voxels. */
    const bvx_field *const f = &job->field;
    const float *const distances = f->distances;
    const int32_t *const n = f->band.size;
    uint64_t value = 0;

    job->hollow.hollowed = job->hollow.drained = 0;
    for (int32_t z = 0; z < n[2]; z++)
        for (int32_t y = 0; y < n[1]; y++)
            for (int32_t x = 0; x < n[0]; x++) {
                int const solid = bvx_grid_get(&job->in.grid, x, y, z);
                /* Values stand in the order of the band's voxels, so one counter follows them. */
                double const d = bvx_grid_get(&f->band, x, y, z) ? fabs((double)distances[value++])
                                                                 : (double)INFINITY;
                /* A voxel without a distance lies farther than any that is requested. */
                int const kept = job->action == DILATE  ? solid || d <= own->change.radius
                                 : job->action == ERODE ? solid && d > own->change.radius
                                                        : solid && d <= own->hollow.thickness;
                int const drilled = kept && job->hole.words != NULL && bvx_grid_get(&job->hole, x, y, z);
                bvx_grid_set(&job->out, x, y, z, kept && !drilled);
                job->hollow.hollowed += solid && !kept;
                job->hollow.drained += (uint64_t)drilled;
            }

    job->voxels.field = &job->field;
    if (job->hole.words == NULL || job->hollow.drained == 0) return BVX_OK;
    cli_drill *const drill = &job->voxels.drill;
    drill->hole = &job->hole;
    drill->axis = own->drain_side / 2;
    drill->radius = own->hollow.drain_radius;
    memcpy(drill->at, job->hollow.drain, sizeof drill->at);
    return BVX_OK;
}

static void tell_changed(const cli_run *run, const void *work, cli_made *made)
{
    const morph_job *const job = work;
    const morph_options *const own = run->own;
    cli_text *const t = &made->members;

    cli_tell(made, "  %-10s  from %" PRIu64 " voxels\n", action_names[job->action], job->before);
    cli_text_add(t, ", \"morph\": {\"action\": \"%s\"", action_names[job->action]);
    cli_json_count(t, "before", job->before);
    cli_json_count(t, "after", made->set);
    if (job->action == HOLLOW) {
        const bvx_hollow_report *const h = &job->hollow;
        cli_tell(made, "  hollow      %" PRIu64 " voxels\n", h->hollowed);
        if (h->drained != 0)
            cli_tell(made, "  drain hole  %" PRIu64 " voxels, to %.9g, %.9g, %.9g\n", h->drained, h->drain[0],
                     h->drain[1], h->drain[2]);
        cli_json_count(t, "hollowed", h->hollowed);
        cli_json_count(t, "drained", h->drained);
        if (h->drained != 0) cli_json_triple(t, "drain", h->drain);
        if (h->hollowed == 0)
            cli_advise(made, BVX_WARN_UNMET, "nothing is deeper than %.9g, so nothing was hollowed out",
                       own->hollow.thickness);
    }
    cli_text_add(t, "}");
    if (job->action == DILATE && !job->roomy && cli_touches_side(&job->out) &&
        !cli_touches_side(&job->in.grid))
        cli_advise(
            made, BVX_WARN_ENDS,
            "what was added reaches the grid's sides and ends there; a --padding of the grid's makes room");
    if (made->set == 0) cli_advise(made, BVX_WARN_EMPTY, "the result is empty");
}

static bvx_status change_voxels(cli_run *run, morph_job *job, uint64_t *set)
{
    const morph_options *const own = run->own;
    int const hollows = job->action == HOLLOW, beyond = own->distance.beyond == BVX_BEYOND_SET;
    int const by_radius = (job->action == DILATE || job->action == ERODE) && cli_given(run, "--radius");

    /* The surface of a mesh can keep walls that move by a distance. */
    if (CLI_HOLDS(run, CLI_TO_MESH) && job->in.kind == CLI_MESH && (hollows || by_radius)) {
        CLI_TRY(move_walls(run, job));
    } else if (hollows) {
        bvx_hollow_options h = own->hollow;
        h.drain_side = 1 << own->drain_side;
        h.beyond = beyond;
        h.report = &job->hollow;
        CLI_TRY(bvx_grid_hollow(run->context, &job->in.grid, &h, &job->out));
    } else {
        bvx_morph_options m = own->change;
        m.neighbourhood = cli_given(run, "--radius") ? BVX_BALL : cli_neighbours[own->neighbourhood];
        m.beyond = beyond;
        CLI_TRY(bvx_grid_morph(run->context, &job->in.grid, (int32_t)job->action, &m, &job->out));
    }
    return bvx_grid_count(run->context, &job->out, set);
}

static int make_changed(cli_run *run, void *work, cli_made *made)
{
    morph_job *const job = work;

    CLI_TRY(open_morph(run, job, made));
    cli_stage_begin(run, action_names[job->action]);
    bvx_status const status = change_voxels(run, job, &made->set);
    CLI_TRY(cli_stage_check(run, status, cli_input_name(job->in.path)));

    job->voxels.name = job->in.path;
    job->voxels.grid = &job->out;
    job->voxels.source = job->in.kind == CLI_MESH ? &job->in.mesh : NULL;
    job->voxels.solid = &job->in.grid;
    made->voxels = &job->voxels;
    return CLI_DONE;
}

/* ---- distances ---- */

/* Every voxel has a value: a field whose band is the whole window; its rows are the caller's to free. */
static bvx_status measure(cli_run *run, const bvx_grid *grid, bvx_field *field)
{
    bvx_window const window = {{grid->low[0], grid->low[1], grid->low[2]},
                               {grid->size[0], grid->size[1], grid->size[2]}};
    size_t const rows = (size_t)grid->size[1] * (size_t)grid->size[2];
    size_t const size = field->value_type == BVX_F64 ? 8 : 4;

    CLI_TRY(bvx_grid_create(run->context, &grid->lattice, &window, &field->band));
    /* A field finds its values by rows: where every voxel has one the counts are known. */
    field->row_values = malloc((rows + 1) * sizeof *field->row_values);
    if (field->row_values == NULL) return BVX_ERR_MEMORY;
    for (size_t row = 0; row <= rows; row++) field->row_values[row] = (uint64_t)row * (uint64_t)grid->size[0];
    for (int32_t z = 0; z < grid->size[2]; z++)
        for (int32_t y = 0; y < grid->size[1]; y++)
            for (int32_t x = 0; x < grid->size[0]; x++) bvx_grid_set(&field->band, x, y, z, 1);
    field->value_count = field->row_values[rows];
    /* By malloc and not by the context, which has no call for arrays of its callers. */
    field->distances = field->value_count < SIZE_MAX / size ? malloc((size_t)field->value_count * size)
                                                            : NULL;
    if (field->distances == NULL) return BVX_ERR_MEMORY;
    cli_note_peak(run, field->value_count * size);
    return bvx_grid_distance(run->context, grid, &((const morph_options *)run->own)->distance,
                             field->value_type, field->distances, field->value_count);
}

static double value_at(const bvx_field *f, uint64_t i)
{
    return f->value_type == BVX_F64 ? ((const double *)f->distances)[i]
                                    : (double)((const float *)f->distances)[i];
}

static void tell_distances(const cli_run *run, const void *work, cli_made *made)
{
    const morph_job *const job = work;
    const morph_options *const own = run->own;
    const bvx_field *const f = &job->apart;
    static const char *const sides[] = {BVX_DISTANCE_LIST(CLI_NAME_OF)};
    cli_text *const t = &made->members;
    double least = value_at(f, 0), greatest = least;

    for (uint64_t i = 1; i < f->value_count; i++) {
        double const v = value_at(f, i);
        if (v < least) least = v;
        if (v > greatest) greatest = v;
    }
    cli_tell(made, "  distances   %s, %.9g to %.9g\n", sides[own->distance.side], least, greatest);
    cli_text_add(t, ", \"morph\": {\"action\": \"distance\", \"side\": \"%s\"", sides[own->distance.side]);
    cli_json_value(t, "least", least);
    cli_json_value(t, "greatest", greatest);
    cli_text_add(t, "}");
    /* Infinity less itself is NaN, which differs from 0. */
    if (least - least != 0.0 || greatest - greatest != 0.0)
        cli_advise(made, BVX_WARN_EMPTY, "%s: some distances are infinite, since there is no %s voxel",
                   cli_input_name(job->in.path), made->set == 0 ? "set" : "empty");
}

static int make_distances(cli_run *run, void *work, cli_made *made)
{
    const morph_options *const own = run->own;
    morph_job *const job = work;
    bvx_field *const field = &job->apart;

    CLI_TRY(open_morph(run, job, made));
    field->value_type = own->value_type;
    field->half_width = (double)INFINITY;
    field->sign = BVX_FILL_NONE;
    cli_stage_begin(run, "distance");
    bvx_status const status = measure(run, &job->in.grid, field);
    cli_stage_end(run);
    /* Without these arrays nothing was measured, and the library has no message about it. */
    if (field->row_values == NULL || field->distances == NULL)
        return cli_fail(run, "no memory for %" PRIu64 " distances", field->value_count);
    CLI_TRY(cli_check_call(run, status, cli_input_name(job->in.path)));

    made->field = field;
    made->set = job->before;
    return CLI_DONE;
}

static const cli_owned morph_owns[] = {CLI_OWNS(BYTES, morph_job, apart.distances),
                                       CLI_OWNS(BYTES, morph_job, apart.row_values),
                                       CLI_OWNS(GRID, morph_job, apart.band),
                                       CLI_OWNS(VOXELS, morph_job, voxels),
                                       CLI_OWNS(GRID, morph_job, hole),
                                       CLI_OWNS(FIELD, morph_job, field),
                                       CLI_OWNS(GRID, morph_job, out),
                                       CLI_OWNS(INPUT, morph_job, in),
                                       {0}};

static const cli_job changed_voxels = {
    .size = sizeof(morph_job), .make = make_changed, .tell = tell_changed, .owns = morph_owns};
static const cli_job voxel_distances = {
    .size = sizeof(morph_job), .make = make_distances, .tell = tell_distances, .owns = morph_owns};

static int choose_morph(cli_run *run, const cli_job **job)
{
    morph_options *const own = run->own;
    const char *const word = run->options->input[0], *const near = cli_nearest(word, action_at, NULL);
    for (own->action = 0; own->action < ACTIONS && strcmp(word, action_names[own->action]) != 0;)
        own->action++;
    if (own->action == ACTIONS && near != NULL)
        return cli_usage(run, "unknown action '%s'; did you mean '%s'?", word, near);
    if (own->action == ACTIONS)
        return cli_usage(run,
                         "unknown action '%s'; it is one of dilate, erode, open, close, hollow and distance, "
                         "before the input",
                         word);
    *job = own->action == DISTANCE ? &voxel_distances : &changed_voxels;
    return CLI_DONE;
}

const cli_command cli_morph = {
    .name = "morph",
    .bit = CLI_MORPH,
    .least_inputs = 2,
    .most_inputs = 2,
    .usage = "dilate|erode|open|close|hollow|distance IN -o OUT [options]",
    .does = "voxels grown, shrunk, hollowed; distances",
    .details =
        "Reads a grid (" CLI_GRIDS "), or a mesh (" CLI_MESHES_READ ", also .gz)\n"
        "that it voxelizes first. dilate grows it by neighbours or by a ball, erode shrinks it, open (erode, "
        "then\n"
        "dilate) takes away what is thin, close (dilate, then erode) fills gaps; hollow leaves a shell and "
        "can\n"
        "bore a drain hole through it; distance writes each centre's distance to the nearest set voxel, or\n"
        "empty one (.npy .nrrd .vti). Radii and thicknesses are in the lattice's unit. Where OUT is a mesh\n"
        "(" CLI_MESHES_WRITTEN
        ") it is their surface: of a mesh with its own outside kept, walls of hollow and\n"
        "of --radius at their distance from it, and half way between set and empty voxels elsewhere.",
    .example =
        "bitvox morph close fixtures/knot.ply -o closed.bvx --resolution 96 --radius 0.1\n"
        "bitvox morph hollow fixtures/knot.ply -o shell.bvx --resolution 96 --thickness 0.15 --drain 0.15\n"
        "bitvox morph distance fixtures/knot.ply -o distance.vti --resolution 64 --side signed",
    .most = "--resolution --spacing --fill --triangles --neighbourhood --steps --radius "
            "--thickness --drain --threads --memory-limit --json",
    .rows = morph_rows,
    .start = start_morph,
    .own = sizeof(morph_options),
    .choose = choose_morph};
