/* report.c - messages for people, and one JSON object for programs. */
#include "cli/cli.h"

#include <inttypes.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- messages ---- */

static void print_error(cli_run *run)
{
    for (char *p = run->report.error_message; *p != 0; p++) /* one line, whatever a file's name holds */
        if ((unsigned char)*p < 32 || *p == 127) *p = '?';
    cli_clear_bar(run);
    fflush(stdout);
    fprintf(stderr, "bitvox: %s\n", run->report.error_message);
}

static void keep_error(cli_run *run, const char *code, const char *format, va_list args)
{
    snprintf(run->report.error_code, sizeof run->report.error_code, "%s", code);
    vsnprintf(run->report.error_message, sizeof run->report.error_message, format, args);
    print_error(run);
}

int cli_fail(cli_run *run, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    keep_error(run, "FILE", format, args);
    va_end(args);
    return CLI_FAILED;
}

int cli_usage(cli_run *run, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    keep_error(run, "USAGE", format, args);
    va_end(args);
    return CLI_USAGE;
}

static const char *status_name(bvx_status status)
{
    switch (status) {
#define NAME_OF_STATUS(name, value, text) \
    case name: return #name;
        BVX_STATUS_LIST(NAME_OF_STATUS)
#undef NAME_OF_STATUS
    default: return "UNKNOWN";
    }
}

/* Messages of the library begin with the function's name, which helps its callers and nobody here. */
static const char *without_function(const char *message)
{
    const char *const colon = strstr(message, ": ");
    return strncmp(message, "bvx_", 4) == 0 && colon != NULL ? colon + 2 : message;
}

int cli_fail_interrupted(cli_run *run)
{
    snprintf(run->report.error_code, sizeof run->report.error_code, "BVX_CANCELLED");
    snprintf(run->report.error_message, sizeof run->report.error_message, "interrupted; nothing was written");
    print_error(run);
    return CLI_INTERRUPTED;
}

int cli_fail_status(cli_run *run, bvx_status status, const char *about)
{
    const char *message = run->context != NULL ? without_function(bvx_last_message(run->context)) : "";
    if (strncmp(message, "level 0", 7) == 0) /* the library is asked for one level at a time; about tells which */
        message += message[7] == ',' || message[7] == ' ' ? 8 + (message[7] == ',') : 0;
    if (status == BVX_CANCELLED) return cli_fail_interrupted(run);
    snprintf(run->report.error_code, sizeof run->report.error_code, "%s", status_name(status));
    snprintf(run->report.error_message, sizeof run->report.error_message, "%s%s%s", about != NULL ? about : "",
             about != NULL ? ": " : "", message[0] != 0 ? message : bvx_status_text(status));
    print_error(run);
    return CLI_FAILED;
}

void cli_warn(cli_run *run, const char *format, ...)
{
    char text[512];
    va_list args;
    va_start(args, format);
    vsnprintf(text, sizeof text, format, args);
    va_end(args);
    cli_clear_bar(run);
    fflush(stdout);
    if (!run->options.quiet) fprintf(stderr, "bitvox: warning: %s\n", text);
    if (run->report.warnings < CLI_MAX_WARNINGS) {
        char *const copy = malloc(strlen(text) + 1);
        if (copy == NULL) return;
        memcpy(copy, text, strlen(text) + 1);
        run->report.warning[run->report.warnings++] = copy;
    }
}

void cli_say(cli_run *run, const char *format, ...)
{
    va_list args;
    if (run->options.quiet || run->options.json) return;
    cli_clear_bar(run);
    va_start(args, format);
    vprintf(format, args);
    va_end(args);
}

void cli_stage(cli_run *run, double start, const char *format, ...)
{
    va_list args;
    if (run->report.stages == CLI_MAX_STAGES) return;
    va_start(args, format);
    vsnprintf(run->report.stage[run->report.stages].name, sizeof run->report.stage[0].name, format, args);
    va_end(args);
    run->report.stage[run->report.stages++].seconds = cli_seconds() - start;
}

void cli_report_free(cli_report *report)
{
    for (int i = 0; i < report->warnings; i++) free(report->warning[i]);
    report->warnings = 0;
}

/* ---- JSON ---- */

/* Length of the UTF-8 sequence at p, 0 when there is none. */
static int utf8_length(const unsigned char *p)
{
    int const n = p[0] < 0x80 ? 1 : p[0] >= 0xc2 && p[0] < 0xe0 ? 2 : p[0] >= 0xe0 && p[0] < 0xf0 ? 3 :
                  p[0] >= 0xf0 && p[0] < 0xf5 ? 4 : 0;
    for (int i = 1; i < n; i++)
        if ((p[i] & 0xc0) != 0x80) return 0;
    if ((p[0] == 0xe0 && p[1] < 0xa0) || (p[0] == 0xed && p[1] > 0x9f)) return 0; /* overlong, surrogates */
    if ((p[0] == 0xf0 && p[1] < 0x90) || (p[0] == 0xf4 && p[1] > 0x8f)) return 0; /* overlong, beyond Unicode */
    return n;
}

static void json_text(const char *text)
{
    const unsigned char *p = (const unsigned char *)text;
    putchar('"');
    while (*p != 0) {
        int const n = utf8_length(p);
        if (n == 0) printf("\\ufffd"); /* file names may be any bytes */
        else if (*p == '"' || *p == '\\') printf("\\%c", *p);
        else if (*p < 32 || *p == 127) printf("\\u%04x", *p);
        else printf("%.*s", n, (const char *)p);
        p += n == 0 ? 1 : n;
    }
    putchar('"');
}

/* The shortest of three that reads back. */
static void json_number(double v)
{
    char text[40];
    if (v - v != 0.0) {
        printf("null");
        return;
    }
    for (int digits = 15; digits <= 17; digits++) {
        snprintf(text, sizeof text, "%.*g", digits, v);
        if (strtod(text, NULL) == v) break;
    }
    printf("%s", text);
}

static void json_key(const char *key, int first)
{
    printf("%s\"%s\": ", first ? "" : ", ", key);
}

static void json_count(const char *key, uint64_t v)
{
    json_key(key, 0);
    printf("%" PRIu64, v);
}

static void json_value(const char *key, double v)
{
    json_key(key, 0);
    json_number(v);
}

static void json_truth(const char *key, int v)
{
    json_key(key, 0);
    printf("%s", v ? "true" : "false");
}

static void json_triple(const char *key, const double v[3])
{
    json_key(key, 0);
    for (int a = 0; a < 3; a++) {
        printf(a == 0 ? "[" : ", ");
        json_number(v[a]);
    }
    printf("]");
}

static void json_ints(const char *key, const int32_t v[3])
{
    json_key(key, 0);
    printf("[%" PRId32 ", %" PRId32 ", %" PRId32 "]", v[0], v[1], v[2]);
}

static void json_certificate(const bvx_certificate *c)
{
    json_count("vertices", c->vertices);
    json_count("triangles", c->triangles);
    json_truth("closed", c->closed);
    json_truth("manifold", c->edge_manifold && c->vertex_manifold);
    json_truth("oriented", c->oriented);
    json_count("components", c->components);
    json_value("volume", c->volume);
    json_value("area", c->area);
    json_key("euler", 0);
    printf("%" PRId64, c->euler);
    json_triple("low", c->low);
    json_triple("high", c->high);
    json_count("edges", c->edges);
    json_count("unused_vertices", c->unused_vertices);
    json_count("collapsed", c->collapsed);
    json_count("degenerate", c->degenerate);
    json_count("duplicates", c->duplicates);
    json_count("boundary_edges", c->boundary_edges);
    json_count("nonmanifold_edges", c->nonmanifold_edges);
    json_count("flipped_edges", c->flipped_edges);
    json_count("nonmanifold_vertices", c->nonmanifold_vertices);
}

static void json_distance(const bvx_distance_report *d)
{
    json_value("mean_distance", d->mean);
    json_value("max_distance", d->max);
    json_key("distance", 0);
    printf("{\"samples\": %" PRIu64, d->samples);
    json_count("seed", d->seed);
    json_value("mean_to_input", d->mean_a_to_b);
    json_value("max_to_input", d->max_a_to_b);
    json_value("mean_from_input", d->mean_b_to_a);
    json_value("max_from_input", d->max_b_to_a);
    json_value("normal_to_input", d->normal_a_to_b);
    json_value("normal_from_input", d->normal_b_to_a);
    printf("}");
}

static void json_mesh(const cli_mesh_entry *m)
{
    printf("{\"path\": ");
    json_text(m->path);
    json_certificate(&m->certificate);
    if (m->lod != NULL) {
        json_ints("resolution", m->lod->resolution);
        json_triple("ratio", m->lod->ratio);
        json_value("simplification_rate", m->rate);
        json_truth("exceeds_input", m->lod->exceeds_source);
        json_value("milliseconds", m->milliseconds);
    }
    if (m->distance != NULL) json_distance(m->distance);
    if (m->welded != NULL) {
        printf(", \"welded\": {\"weld\": true");
        json_certificate(m->welded);
        printf("}");
    }
    printf("}");
}

int cli_report_print(const cli_run *run, int status)
{
    const cli_report *const r = &run->report;
    printf("{\"status\": \"%s\"", status == CLI_DONE ? "done" : status == CLI_INTERRUPTED ? "interrupted" : "failed");
    if (run->command != NULL) printf(", \"command\": \"%s\"", run->command->name);
    if (r->has_lattice) {
        printf(", \"lattice\": {\"fraction_bits\": %" PRId32, r->lattice.fraction_bits);
        json_triple("origin", r->lattice.origin);
        json_triple("spacing", r->lattice.spacing);
        json_ints("dims", r->lattice.dims);
        printf("}");
    }
    if (r->has_set) json_count("set", r->set);
    printf(", \"stages\": [");
    for (int i = 0; i < r->stages; i++) {
        printf("%s{\"name\": ", i == 0 ? "" : ", ");
        json_text(r->stage[i].name);
        json_value("seconds", r->stage[i].seconds);
        printf("}");
    }
    printf("], \"meshes\": [");
    for (int i = 0; i < r->meshes; i++) {
        printf("%s", i == 0 ? "" : ", ");
        json_mesh(&r->mesh[i]);
    }
    printf("], \"warnings\": [");
    for (int i = 0; i < r->warnings; i++) {
        printf("%s", i == 0 ? "" : ", ");
        json_text(r->warning[i]);
    }
    printf("]");
    json_count("peak_bytes", r->peak_bytes);
    if (status != CLI_DONE) {
        printf(", \"error\": {\"code\": ");
        json_text(r->error_code);
        printf(", \"message\": ");
        json_text(r->error_message);
        printf("}");
    }
    printf("}\n");
    return fflush(stdout) == 0 && !ferror(stdout);
}
