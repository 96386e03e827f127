/* level_tables.c - what is told of levels: the input, a table of what each level is, a table of how near it
 * stays. */
#include "cli_results/results.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

uint64_t cli_samples(const cli_run *run)
{
    return run->options->samples < 0 ? 20000 : (uint64_t)run->options->samples;
}

int cli_is_sound(const bvx_certificate *c)
{
    return c->closed && c->edge_manifold && c->vertex_manifold && c->oriented;
}

int64_t cli_count_handles(const bvx_certificate *c)
{
    return (int64_t)c->components - c->euler / 2;
}

void cli_tell_result(const bvx_certificate *c, cli_made *made)
{
    cli_tell(made,
             "  result      %" PRIu64 " triangles of %" PRIu64 " vertices%s%s%s; %" PRIu64
             " components, volume %.6g\n",
             c->triangles, c->vertices, c->closed ? ", closed" : ", OPEN",
             c->edge_manifold && c->vertex_manifold ? ", manifold" : ", NOT MANIFOLD",
             c->oriented ? ", oriented" : ", NOT ORIENTED", c->components, c->volume);
}

void cli_tell_mesh_of(const cli_run *run, int n, const char *title, cli_made *made)
{
    const bvx_certificate *const c = &run->report.mesh[n].certificate;
    /* A part with a cavity has two surfaces: parts are counted where some are dropped. */
    cli_tell(made, "  %s: %" PRIu64 " triangles, %s, volume %.6g, %" PRIu64 " surface%s\n", title,
             c->triangles, cli_is_sound(c) ? "closed, manifold" : "NOT closed", c->volume, c->components,
             c->components == 1 ? "" : "s");
}

void cli_tell_input(const cli_run *run, uint64_t triangles, const bvx_certificate *in, double diagonal,
                    cli_made *made)
{
    cli_tell(made, "%s: %" PRIu64 " triangles, %s, %s, %s; diagonal %.6g\n", cli_first_name(run), triangles,
             in->closed ? "closed" : "not closed",
             in->edge_manifold && in->vertex_manifold ? "manifold" : "not manifold",
             in->oriented ? "oriented" : "not oriented", diagonal);
}

static int is_length(double diagonal)
{
    return diagonal > 0.0 && diagonal - diagonal == 0.0;
}

static void add_words(char *text, size_t room, const char *words, uint64_t count, const char *from)
{
    size_t const used = strlen(text);
    if (count != 0)
        snprintf(text + used, room - used, "%s%" PRIu64 " %s%s", used == 0 ? "" : ", ", count, words, from);
    else snprintf(text + used, room - used, "%s%s%s", used == 0 ? "" : ", ", words, from);
}

void cli_tell_collapsed(const cli_run *run, int count, double diagonal, const bvx_certificate *in,
                        cli_made *made)
{
    cli_tell(made, "level  triangles  requested    share  smallest angle  pieces  target   closed, manifold, "
                   "oriented, no crossings\n");
    for (int i = 0; i < count; i++) {
        const cli_mesh_entry *const m = &run->report.mesh[i];
        const bvx_level_report *const l = m->level;
        char target[32], sound[160];

        if (l->target_error > 0.0 && is_length(diagonal))
            snprintf(target, sizeof target, "%.4g%%", 100.0 * l->target_error / diagonal);
        else if (l->target_error > 0.0) snprintf(target, sizeof target, "%.4g", l->target_error);
        else snprintf(target, sizeof target, "%" PRIu64, l->target);

        /* What a level is not, and whether it has that from the input. */
        size_t const room = sizeof sound;
        const bvx_certificate *const c = &l->certificate;
        sound[0] = '\0';
        if (!c->closed)
            add_words(sound, room, "border edges", c->boundary_edges,
                      in->closed ? " (cut)" : " (of the input)");
        if (!c->edge_manifold || !c->vertex_manifold) add_words(sound, room, "not manifold", 0, "");
        if (!c->oriented) add_words(sound, room, "not oriented", 0, "");
        if (l->crossings != 0) add_words(sound, room, "crossings", l->crossings, " (of the input)");
        if (sound[0] == '\0') add_words(sound, room, "yes", 0, "");
        cli_tell(made, "%5d %10" PRIu64 " %10s %7.2f%% %10.2f deg %7" PRIu64 "  %-7s  %s\n", i,
                 m->certificate.triangles, target, m->rate * 100.0, l->least_angle, m->certificate.components,
                 l->met ? "met" : "NOT MET", sound);
        if (l->handles_cut + l->holes_filled != 0)
            cli_tell(made, "      %" PRIu64 " handle%s cut, %" PRIu64 " hole%s filled, up to %.3g around\n",
                     l->handles_cut, l->handles_cut == 1 ? "" : "s", l->holes_filled,
                     l->holes_filled == 1 ? "" : "s", l->longest_closed);
    }
}

static void tell_distance(cli_made *made, double d, double diagonal, int decimals)
{
    double const part = d / diagonal;
    /* No percentage of a point, or of what doubles do not hold. */
    if (is_length(diagonal) && part - part == 0.0)
        cli_tell(made, "  %9.3g %*.*f%%", d, 3 + decimals, decimals, 100.0 * part);
    else cli_tell(made, "  %9.3g %*s", d, 4 + decimals, "-");
}

void cli_tell_distances(const cli_run *run, int count, double diagonal, int decimals, const char *to,
                        const char *unit_of, cli_made *made)
{
    int const one = 16 + decimals;

    if (run->report.mesh[0].distance == NULL) return;
    cli_tell(made,
             "\ndistances %sin the %s's unit and in %% of its diagonal, from %" PRIu64
             " random points on each mesh, seed %d\n",
             to, unit_of, run->report.mesh[0].distance->samples, CLI_SEED);
    cli_tell(made, "%*s%*s\n", 5 + 2 * one, "level to input", 2 * one, "input to level");
    cli_tell(made, "level%*s%*s%*s%*s\n", one, "mean", one, "max", one, "mean", one, "max");
    for (int i = 0; i < count; i++) {
        const bvx_distance_report *const d = run->report.mesh[i].distance;
        cli_tell(made, "%5d", run->report.mesh[i].number);
        tell_distance(made, d->mean_a_to_b, diagonal, decimals);
        tell_distance(made, d->max_a_to_b, diagonal, decimals);
        tell_distance(made, d->mean_b_to_a, diagonal, decimals);
        tell_distance(made, d->max_b_to_a, diagonal, decimals);
        cli_tell(made, "\n");
    }
}

void cli_tell_written(const cli_run *run, int count, cli_made *made)
{
    const cli_mesh_entry *const m = run->report.mesh;
    cli_tell(made, "\n");
    for (int i = 0; i < count; i++) /* Levels in one file are one name. */
        if (i == 0 || strcmp(m[i].path, m[i - 1].path) != 0)
            cli_tell(made, "%s%s", i == 0 ? "written: " : ", ", cli_output_name(run, m[i].path));
    cli_tell(made, "\n");
}
