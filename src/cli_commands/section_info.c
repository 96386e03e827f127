/* section_info.c - what 'info' says of contours of sections. */
#include "cli_commands/commands.h"

#include <inttypes.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { LABELS_SAID = 16 }; /* more are counted; the report has all */

typedef struct label_facts {
    int32_t label;
    uint64_t loops, points;
} label_facts;

typedef struct section_facts {
    cli_box box;
    double first, last, step, even; /* positions, mean distance, greatest deviation from it */
    uint64_t empty;                 /* sections without a loop */
    label_facts *label;
    uint64_t labels;
} section_facts;

static int compare_labels(const void *a, const void *b)
{
    int32_t const x = ((const label_facts *)a)->label, y = ((const label_facts *)b)->label;
    return (x > y) - (x < y);
}

/* Files may name sections in any order. */
static int measure_positions(cli_run *run, const bvx_sections *s, section_facts *f)
{
    uint64_t const n = s->section_count;
    double *const sorted = malloc((size_t)n * sizeof *sorted + 1);
    uint8_t *const seen = calloc((size_t)n + 1, 1);
    int const good = sorted != NULL && seen != NULL;

    if (good) {
        memcpy(sorted, s->positions, (size_t)n * sizeof *sorted);
        qsort(sorted, (size_t)n, sizeof *sorted, cli_compare_doubles);
        f->first = n != 0 ? sorted[0] : 0.0;
        f->last = n != 0 ? sorted[n - 1] : 0.0;
        f->step = n > 1 ? (f->last - f->first) / (double)(n - 1) : 0.0;
        for (uint64_t i = 1; i < n; i++) f->even = fmax(f->even, fabs(sorted[i] - sorted[i - 1] - f->step));
        for (uint64_t i = 0; i < s->loop_count; i++) seen[s->loops[i].section] = 1;
        for (uint64_t i = 0; i < n; i++) f->empty += !seen[i];
    }
    free(seen);
    free(sorted);
    return good ? CLI_DONE : cli_fail(run, "no memory for the positions of %" PRIu64 " sections", n);
}

static int count_labels(cli_run *run, const bvx_sections *s, section_facts *f)
{
    uint64_t kept = 0;

    f->label = calloc((size_t)s->loop_count + 1, sizeof *f->label);
    if (f->label == NULL)
        return cli_fail(run, "no memory for the labels of %" PRIu64 " loops", s->loop_count);
    for (uint64_t i = 0; i < s->loop_count; i++) {
        f->label[i].label = s->loops[i].label;
        f->label[i].loops = 1;
        f->label[i].points = s->loops[i].point_count;
    }
    qsort(f->label, (size_t)s->loop_count, sizeof *f->label, compare_labels);
    for (uint64_t i = 1; i < s->loop_count; i++) {
        if (f->label[i].label != f->label[kept].label) {
            f->label[++kept] = f->label[i];
            continue;
        }
        f->label[kept].loops++;
        f->label[kept].points += f->label[i].points;
    }
    f->labels = s->loop_count != 0 ? kept + 1 : 0;
    return CLI_DONE;
}

void cli_tell_box(cli_made *made, const double low[3], const double high[3])
{
    for (int a = 0; a < 3; a++)
        cli_tell(made, "  %c           %.9g .. %.9g (%.9g)\n", "xyz"[a], low[a], high[a], high[a] - low[a]);
}

static void tell_facts_of_sections(const bvx_sections *s, const section_facts *f, cli_made *made)
{
    const double *const n = s->normal;

    cli_tell(made, "  sections    %" PRIu64, s->section_count);
    if (f->empty != 0) cli_tell(made, ", %" PRIu64 " of them empty", f->empty);
    cli_tell(made, "\n  loops       %" PRIu64 " of %" PRIu64 " points\n", s->loop_count, s->point_count);
    cli_tell(made, "  labels      %" PRIu64, f->labels);
    for (uint64_t i = 0; i < f->labels && i < LABELS_SAID; i++)
        cli_tell(made, "%s %" PRId32 " (%" PRIu64 " loop%s)", i == 0 ? ":" : ",", f->label[i].label,
                 f->label[i].loops, f->label[i].loops == 1 ? "" : "s");
    cli_tell(made, "%s\n", f->labels > LABELS_SAID ? ", ..." : "");
    /* Adding 0 turns -0 into 0, which reads better. */
    cli_tell(made, "  planes      across %.9g, %.9g, %.9g, from %.9g to %.9g\n", n[0] + 0.0, n[1] + 0.0,
             n[2] + 0.0, f->first, f->last);
    if (s->section_count > 1)
        cli_tell(made, "  distance    %.9g from plane to plane%s\n", f->step,
                 f->even > 1e-6 * f->step ? " in the mean" : "");
    cli_tell_box(made, f->box.low, f->box.high);
}

int cli_tell_sections(cli_run *run, const char *path, cli_made *made)
{
    bvx_sections sections = {0};
    section_facts f = {0};
    int status = cli_read_sections(run, path, &sections);

    if (status == CLI_DONE) status = measure_positions(run, &sections, &f);
    if (status == CLI_DONE) status = count_labels(run, &sections, &f);
    if (status == CLI_DONE) {
        cli_box_of_points(sections.points, BVX_F64, sections.point_count, &f.box);
        tell_facts_of_sections(&sections, &f, made);

        cli_text *const t = &made->members;

        cli_text_add(t, ", \"contours\": {\"path\": ");
        cli_json_string(t, path);
        cli_json_count(t, "sections", sections.section_count);
        cli_json_count(t, "empty_sections", f.empty);
        cli_json_count(t, "loops", sections.loop_count);
        cli_json_count(t, "points", sections.point_count);
        cli_json_triple(t, "normal", sections.normal);
        cli_json_value(t, "first_position", f.first);
        cli_json_value(t, "last_position", f.last);
        cli_json_value(t, "mean_distance", f.step);
        cli_json_triple(t, "low", f.box.low);
        cli_json_triple(t, "high", f.box.high);
        cli_text_add(t, ", \"labels\": [");
        for (uint64_t i = 0; i < f.labels; i++)
            cli_text_add(t, "%s{\"label\": %" PRId32 ", \"loops\": %" PRIu64 ", \"points\": %" PRIu64 "}",
                         i == 0 ? "" : ", ", f.label[i].label, f.label[i].loops, f.label[i].points);
        cli_text_add(t, "]}");
    }
    free(f.label);
    bvx_sections_free(run->context, &sections);
    return status;
}
