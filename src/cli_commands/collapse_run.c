/* collapse_run.c - a chain of levels that edges collapse to: targets by options, distances, files.
 *
 * The library makes the whole chain in one call, which is the stage "level 0"; distances are measured
 * afterwards, one stage a level. */
#include "cli_commands/collapse_run.h"

#include <stdio.h>
#include <string.h>

enum {
    USUAL_LEVELS = 4,
    LEAST_USUAL = 20,   /* triangles of a level that nobody requested */
    LEAST_TRIANGLES = 4 /* of any closed mesh */
};

static const cli_rule collapse_rules[] = {
    {.also = cli_to_mesh_rules},
    {.also = cli_reduction_rules},
    {.given = "--triangles --error", .beside = "--count", .message = "%o and %b exclude each other"},
    {.also = cli_mesh_file_rules},
    {0}};

int cli_check_collapse(cli_run *run, cli_collapse_run *c)
{
    const cli_options *const o = run->options;
    int const ways = (o->triangles.count != 0) + (o->errors.count != 0) + (o->count != 0);
    CLI_TRY(cli_check_rules(run, collapse_rules, 0, NULL));
    c->by_error = o->errors.count != 0;
    c->count = ways == 0 ? c->usual_count : o->triangles.count + o->errors.count + o->count;
    return cli_check_level_names(run, c->count);
}

/* 1/2, 1/4 ... as long as that leaves a mesh that is worth a file; one in any case. */
static int usual_count(uint64_t triangles)
{
    int count = 1;
    while (count < USUAL_LEVELS && triangles >> (count + 1) >= LEAST_USUAL) count++;
    return count;
}

int cli_open_collapse(cli_run *run, cli_collapse_run *c)
{
    int const known = c->count != 0;
    cli_box box;

    CLI_TRY(known ? cli_open_levels(run, c->count, c->path) : CLI_DONE);
    if (c->kind == CLI_GRID) {
        bvx_grid grid = {0};
        int placed;
        CLI_TRY(cli_read_grid(run, run->options->input[0], NULL, &grid, &placed));
        run->report.lattice = grid.lattice;
        run->report.has_lattice = 1;
        cli_stage_begin(run, "surface");
        bvx_status const status = bvx_extract_surface(run->context, &grid, NULL, &c->input);
        bvx_grid_free(run->context, &grid);
        CLI_TRY(cli_stage_check(run, status, cli_first_name(run)));
        if (c->input.triangle_count == 0)
            return cli_fail(run, "%s: the grid is empty; there is nothing to make levels from",
                            cli_first_name(run));
    } else CLI_TRY(cli_read_mesh(run, run->options->input[0], &c->input));
    CLI_TRY(cli_check_carry(run, &c->input));

    bvx_mesh_view_of(&c->input, &c->view);
    cli_mesh_box(&c->input, &box);
    c->diagonal = cli_diagonal(box.low, box.high);
    /* A point, or a mesh beyond all doubles. */
    if (c->by_error && !(c->diagonal > 0.0 && c->diagonal - c->diagonal == 0.0))
        return cli_fail(run, "%s: a diagonal of %g leaves nothing to measure --error by", cli_first_name(run),
                        c->diagonal);

    if (!known) c->count = usual_count(c->input.triangle_count);
    const cli_options *const o = run->options;
    for (int i = 0; i < c->count; i++) {
        /* Shifted by at most 63, which C defines. */
        uint64_t const halved = i < 63 ? c->input.triangle_count >> (i + 1) : 0;
        if (c->by_error)
            c->error[i] = o->errors.value[i] * (o->errors.percent[i] ? c->diagonal / 100.0 : 1.0);
        else if (o->triangles.count != 0) c->target[i] = (uint64_t)o->triangles.value[i];
        else c->target[i] = halved > LEAST_TRIANGLES ? halved : LEAST_TRIANGLES;
    }
    return known ? CLI_DONE : cli_open_levels(run, c->count, c->path);
}

bvx_targets cli_targets(const cli_run *run, const cli_collapse_run *c)
{
    const cli_options *const o = run->options;
    bvx_targets t = {.error_kind = o->error_kind, .strict = o->strict};
    /* Counts or distances, never both: rules have seen to that. A level by its error is measured while it is
     * looked for, so that the distances told are those that decided. */
    if (c->by_error) {
        t.errors = c->error;
        t.samples = cli_samples(run);
    } else {
        t.triangles = c->target;
    }
    if (cli_given(run, "--even")) t.even = cli_or_none(o->even);
    return t;
}

/* The library measures from the input to the level, the report from the level to the input. */
static void turn_distance(const bvx_distance_report *from, bvx_distance_report *to)
{
    *to = *from;
    to->mean_a_to_b = from->mean_b_to_a;
    to->max_a_to_b = from->max_b_to_a;
    to->normal_a_to_b = from->normal_b_to_a;
    to->mean_b_to_a = from->mean_a_to_b;
    to->max_b_to_a = from->max_a_to_b;
    to->normal_b_to_a = from->normal_a_to_b;
}

static int measure_level(cli_run *run, cli_collapse_run *c, int i)
{
    uint64_t const samples = cli_samples(run);
    bvx_distance_report d;

    if (c->level[i].measured) {
        turn_distance(&c->level[i].distance, &c->distance[i]);
    } else {
        if (samples == 0) return CLI_DONE;
        bvx_mesh_view const view = cli_view(&c->mesh[i]);
        cli_stage_begin(run, "distance %d", i);
        CLI_TRY(cli_stage_check(run, bvx_mesh_distance(run->context, &c->view, &view, samples, CLI_SEED, &d),
                                c->path[i]));
        turn_distance(&d, &c->distance[i]);
    }
    run->report.mesh[i].distance = &c->distance[i];
    return CLI_DONE;
}

int cli_finish_collapse(cli_run *run, cli_collapse_run *c)
{
    int status = CLI_DONE;
    for (int i = 0; i < c->count && status == CLI_DONE; i++) {
        char stage[32];
        snprintf(stage, sizeof stage, "carry %d", i);
        status = cli_carry(run, &c->input, &c->mesh[i], stage, c->path[i]);
        if (status == CLI_DONE) {
            cli_mesh_entry *const entry = &run->report.mesh[i];
            entry->path = c->path[i];
            entry->number = i;
            entry->certificate = c->level[i].certificate;
            entry->level = &c->level[i];
            entry->solid = c->solid;
            entry->colours = c->mesh[i].colours != NULL;
            entry->uvs = c->mesh[i].uvs != NULL;
            entry->rate = (double)c->mesh[i].triangle_count / (double)c->input.triangle_count;
            run->report.meshes = i + 1;
        }
    }
    for (int i = 0; i < c->count && status == CLI_DONE; i++) status = measure_level(run, c, i);
    return status;
}

int cli_write_collapse(cli_run *run, void *work)
{
    cli_collapse_run *const c = work; /* the first member of the job */
    run->source = &c->input;
    return cli_write_levels(run, c->mesh, c->count, c->path);
}

void cli_tell_collapse(const cli_run *run, const cli_collapse_run *c, cli_made *made)
{
    cli_tell_collapsed(run, c->count, c->diagonal, &c->before, made);
    cli_tell_distances(run, c->count, c->diagonal, 4, "", "mesh", made);
    cli_tell_written(run, c->count, made);
}

const cli_owned cli_collapse_owns[] = {
    CLI_OWNS_ALL(MESH, cli_collapse_run, mesh), CLI_OWNS(MESH, cli_collapse_run, input), {0}};
