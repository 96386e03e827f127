/* report.c - the run as one JSON object for programs. */
#include "cli_shell/shell.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>

static void report_certificate(cli_text *t, const bvx_certificate *c)
{
    cli_json_count(t, "vertices", c->vertices);
    cli_json_count(t, "triangles", c->triangles);
    cli_json_truth(t, "closed", c->closed);
    cli_json_truth(t, "manifold", c->edge_manifold && c->vertex_manifold);
    cli_json_truth(t, "oriented", c->oriented);
    cli_json_count(t, "components", c->components);
    cli_json_value(t, "volume", c->volume);
    cli_json_value(t, "area", c->area);
    cli_json_key(t, "euler", 0);
    cli_text_add(t, "%" PRId64, c->euler);
    cli_json_triple(t, "low", c->box.low);
    cli_json_triple(t, "high", c->box.high);
    cli_json_count(t, "edges", c->edges);
    cli_json_count(t, "unused_vertices", c->unused_vertices);
    cli_json_count(t, "collapsed", c->collapsed);
    cli_json_count(t, "degenerate", c->degenerate);
    cli_json_count(t, "duplicates", c->duplicates);
    cli_json_count(t, "boundary_edges", c->boundary_edges);
    cli_json_count(t, "nonmanifold_edges", c->nonmanifold_edges);
    cli_json_count(t, "flipped_edges", c->flipped_edges);
    cli_json_count(t, "nonmanifold_vertices", c->nonmanifold_vertices);
}

static void report_distance(cli_text *t, const bvx_distance_report *d)
{
    cli_json_value(t, "mean_distance", d->mean);
    cli_json_value(t, "max_distance", d->max);
    cli_json_key(t, "distance", 0);
    cli_text_add(t, "{\"samples\": %" PRIu64, d->samples);
    cli_json_count(t, "seed", d->seed);
    cli_json_value(t, "mean_to_input", d->mean_a_to_b);
    cli_json_value(t, "max_to_input", d->max_a_to_b);
    cli_json_value(t, "mean_from_input", d->mean_b_to_a);
    cli_json_value(t, "max_from_input", d->max_b_to_a);
    cli_json_value(t, "normal_to_input", d->normal_a_to_b);
    cli_json_value(t, "normal_from_input", d->normal_b_to_a);
    cli_text_add(t, "}");
}

static void report_mesh(const cli_run *run, cli_text *t, const cli_mesh_entry *m)
{
    cli_text_add(t, "{\"path\": ");
    cli_json_string(t, cli_output_name(run, m->path));
    if (m->lod != NULL || m->level != NULL) cli_json_count(t, "level", (uint64_t)m->number);
    report_certificate(t, &m->certificate);
    cli_json_truth(t, "colours", m->colours);
    cli_json_truth(t, "texture_coordinates", m->uvs);
    if (m->has_crossings) cli_json_count(t, "crossings", m->crossings);
    if (m->lod != NULL) {
        cli_json_ints(t, "resolution", m->lod->resolution);
        cli_json_triple(t, "ratio", m->lod->ratio);
        cli_json_value(t, "simplification_rate", m->rate);
        cli_json_truth(t, "exceeds_input", m->rate > 1.0);
        cli_json_value(t, "milliseconds", m->milliseconds);
    }
    if (m->level != NULL) {
        const bvx_level_report *const l = m->level; /* What was requested is null where nobody asked. */

        if (l->target_error > 0.0) cli_text_add(t, ", \"target\": null");
        else cli_json_count(t, "target", l->target);
        cli_json_value(t, "target_error", l->target_error > 0.0 ? l->target_error : HUGE_VAL);
        cli_json_truth(t, "met", l->met);
        cli_json_count(t, "crossings", l->crossings);
        cli_json_value(t, "least_angle", l->least_angle);
        cli_json_count(t, "refused", l->refused);
        cli_json_count(t, "handles_cut", l->handles_cut);
        cli_json_count(t, "holes_filled", l->holes_filled);
        cli_json_value(t, "longest_closed", l->longest_closed);
        cli_json_value(t, "simplification_rate", m->rate);
        cli_json_truth(t, "solid", m->solid);
    }
    if (m->distance != NULL) report_distance(t, m->distance);
    else if (m->level != NULL)
        cli_text_add(t, ", \"mean_distance\": null, \"max_distance\": null, \"distance\": null");
    if (m->welded != NULL) {
        cli_text_add(t, ", \"welded\": {\"weld\": true");
        report_certificate(t, m->welded);
        cli_text_add(t, "}");
    }
    cli_text_add(t, "}");
}

static void report_parts(const cli_report *report, cli_text *t)
{
    const bvx_keep_report *const p = &report->parts;
    if (!report->has_parts) return;
    cli_text_add(t, ", \"parts\": {\"kept\": %" PRIu64, p->kept);
    cli_json_count(t, "dropped", p->dropped);
    cli_json_count(t, "voxels_kept", p->voxels_kept);
    cli_json_count(t, "voxels_dropped", p->voxels_dropped);
    cli_text_add(t, "}");
}

static void report_warning(cli_text *t, const cli_warning *w)
{
    cli_text_add(t, "{\"code\": \"%s\", \"message\": ", w->code);
    cli_json_string(t, w->text);
    cli_text_add(t, ", \"values\": [");
    for (int i = 0; i < w->values; i++) cli_text_add(t, "%s%.9g", i == 0 ? "" : ", ", w->value[i]);
    cli_text_add(t, "]");
    if (w->placed) cli_json_box(t, "place", w->low, w->high);
    else cli_text_add(t, ", \"place\": null");
    cli_text_add(t, "}");
}

void cli_report_text(const cli_run *run, int status, cli_text *t)
{
    const cli_report *const r = &run->report;

    cli_text_add(t, "{\"status\": \"%s\"",
                 status == CLI_DONE          ? "done"
                 : status == CLI_INTERRUPTED ? "interrupted"
                                             : "failed");
    if (run->name != NULL) cli_text_add(t, ", \"command\": \"%s\"", run->name);
    if (r->has_lattice) {
        cli_text_add(t, ", \"lattice\": {\"fraction_bits\": %" PRId32, r->lattice.fraction_bits);
        cli_json_triple(t, "origin", r->lattice.origin);
        cli_json_triple(t, "spacing", r->lattice.spacing);
        cli_json_ints(t, "dims", r->lattice.dims);
        cli_text_add(t, "}");
    }
    if (r->has_set) cli_json_count(t, "set", r->set);
    report_parts(r, t);
    if (r->nonfinite != 0) cli_json_count(t, "nonfinite_triangles", r->nonfinite);
    cli_text_add(t, ", \"stages\": [");
    for (int i = 0; i < r->stages; i++) {
        cli_text_add(t, "%s{\"name\": ", i == 0 ? "" : ", ");
        cli_json_string(t, r->stage[i].name);
        cli_json_value(t, "seconds", r->stage[i].seconds);
        cli_text_add(t, "}");
    }
    cli_text_add(t, "], \"meshes\": [");
    for (int i = 0; i < r->meshes; i++) {
        cli_text_add(t, "%s", i == 0 ? "" : ", ");
        report_mesh(run, t, &r->mesh[i]);
    }
    cli_text_add(t, "], \"warnings\": [");
    for (int i = 0; i < r->warnings; i++) {
        cli_text_add(t, "%s", i == 0 ? "" : ", ");
        report_warning(t, &r->warning[i]);
    }
    cli_text_add(t, "]");
    if (r->more.size != 0) cli_text_add(t, "%s", r->more.bytes);
    cli_json_count(t, "peak_bytes", r->peak_bytes);
    if (status != CLI_DONE) {
        cli_text_add(t, ", \"error\": {\"code\": ");
        cli_json_string(t, r->error_code);
        cli_text_add(t, ", \"message\": ");
        cli_json_string(t, r->error_message);
        cli_text_add(t, "}");
    }
    cli_text_add(t, "}\n");
}

int cli_report_print(cli_run *run, int status)
{
    FILE *const to = run->standard_taken ? stderr : stdout;
    cli_text text = {NULL, 0, 0, 0};
    if (run->report.batch.size != 0) text = run->report.batch;
    else cli_report_text(run, status, &text);
    int good = !text.failed && fwrite(text.bytes, 1, text.size, to) == text.size;
    good &= fflush(to) == 0 && !ferror(to);
    cli_text_free(&text);
    return good;
}
